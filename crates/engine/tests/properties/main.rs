//! What must hold of every pair that can be drawn, tried on pairs drawn at random.
//!
//! [`drawn`] draws the pairs, [`seen`] lists those on which a defect was once seen, [`truths`] says what must hold of them all. Each
//! property is tried on a few dozen pairs in the test command, and on two thousand by `./test --test properties -- --ignored --nocapture`,
//! which prints the worst figures of each: docs/validity.md has them.

mod between;
#[path = "../cases/mod.rs"]
mod cases;
mod drawn;
mod seen;
mod truths;

use drawn::DrawnPair;
use meshwright_engine::gear::{Member, SpurGear};
use truths::{TRUTHS, Truth};

/// Pairs of the short form; other seeds than those of the long one would do as well.
const SHORT: std::ops::Range<u64> = 0..24;

/// Pairs of the short form as workshops make them.
const AS_MADE: std::ops::Range<u64> = 0..16;

/// Pairs of the long form, and as many as workshops make them.
const LONG: std::ops::Range<u64> = 0..1000;

/// Tries `truth` on `pairs` and tells of its worst; panics where it does not hold.
fn hold(truth: &Truth, pairs: impl Iterator<Item = (String, DrawnPair)>) {
    let mut worst = (0.0_f64, String::new());
    let (mut tried, mut refused, mut broken) = (0, 0, Vec::new());
    for (name, pair) in pairs {
        match (truth.figure)(&pair) {
            Ok(None) => {}
            Ok(Some(figure)) => {
                tried += 1;
                if figure.is_nan() || figure > truth.bound {
                    broken.push(format!("{name}: {figure:.2e}"));
                }
                if figure > worst.0 || figure.is_nan() {
                    worst = (figure, name);
                }
            }
            Err(error) if is_in_fillet(&pair, &error) => refused += 1,
            Err(error) => broken.push(format!("{name}: {error}")),
        }
    }
    println!(
        "{}: {tried} pairs, worst {:.2e} of {:.2e} allowed ({})",
        truth.name, worst.0, truth.bound, worst.1
    );
    assert!(
        broken.is_empty(),
        "{}, at most {:.1e}:\n{}",
        truth.name,
        truth.bound,
        broken.join("\n")
    );
    assert!(tried > 0, "{} was tried on no pair", truth.name);
    assert!(
        refused <= 2 + tried / 25,
        "{}: {refused} pairs refused",
        truth.name
    );
}

/// Tells whether `error` is that of a tip pressed into the fillet of an undercut gear, where contact is not followed: such a pair has no result.
fn is_in_fillet(drawn: &DrawnPair, error: &str) -> bool {
    let mut gears = Member::BOTH
        .map(|member| drawn.pair.gear(member))
        .into_iter();
    error.contains("flanks penetrate each other") && gears.any(SpurGear::is_undercut)
}

fn drawn(seeds: std::ops::Range<u64>) -> impl Iterator<Item = (String, DrawnPair)> {
    seeds.map(|seed| (format!("seed {seed}"), DrawnPair::of(seed)))
}

fn as_made(seeds: std::ops::Range<u64>) -> impl Iterator<Item = (String, DrawnPair)> {
    seeds.map(|seed| (format!("as made, seed {seed}"), DrawnPair::as_made(seed)))
}

fn named(name: &str) -> &'static Truth {
    TRUTHS
        .iter()
        .find(|truth| truth.name == name)
        .unwrap_or_else(|| panic!("{name} is a truth"))
}

macro_rules! forms {
    ($($name:ident)*) => {
        $(
            #[test]
            fn $name() {
                let seen = seen::pairs().into_iter();
                let seen = seen.map(|(name, pair)| (name.to_owned(), pair));
                let drawn = drawn(SHORT).chain(as_made(AS_MADE));
                hold(named(stringify!($name)), seen.chain(drawn));
            }
        )*

        /// The same on many more pairs.
        mod at_length {
            use super::*;

            $(
                #[test]
                #[ignore = "all of them take hours"]
                fn $name() {
                    hold(named(stringify!($name)), drawn(LONG).chain(as_made(LONG)));
                }
            )*
        }

        #[test]
        fn every_truth_has_its_forms() {
            let names = [$(stringify!($name)),*];
            assert!(TRUTHS.iter().all(|truth| names.contains(&truth.name)));
        }
    };
}

forms! {
    no_flank_penetrates
    the_pair_that_touches_first_carries
    all_lengths_times_s_and_the_torque_times_s_cubed_make_delta_times_s
    all_moduli_and_the_torque_times_c_leave_delta
    driver_and_driven_swapped_are_mirror_images
    holes_turned_by_their_pitch_are_the_same_holes
    a_blank_turned_by_one_tooth_moves_the_curve_by_one_mesh_period
    delta_grows_with_the_torque
    the_curve_has_no_jump
    a_lone_contact_is_hertz
    both_contact_solvers_agree
    halving_every_element_changes_little
}
