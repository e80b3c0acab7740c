//! What must hold of every pair that can be drawn, tried on pairs drawn at random.
//!
//! [`drawn`] draws the pairs, [`seen`] lists those on which a defect was once seen, [`truths`] says what must hold of them all. Each
//! property is tried on a dozen pairs in the daily tests, on three dozen more in `./test all`, and on two thousand by
//! `./test --test properties at_length -- --ignored --nocapture`, which prints the worst figures of each: docs/validity.md has them.

mod between;
#[path = "../cases/mod.rs"]
mod cases;
mod drawn;
mod long_periods;
mod seen;
mod truths;

use drawn::DrawnPair;
use meshwright_engine::gear::{Member, SpurGear};
use meshwright_engine::library::Library;
use truths::{TRUTHS, Truth};

/// Pairs of the daily form; other seeds than those of the longer ones would do as well.
const DAILY: std::ops::Range<u64> = 0..6;

/// Pairs of `./test all`, and those of them that workshops make.
const SHORT: std::ops::Range<u64> = 6..24;
const AS_MADE: std::ops::Range<u64> = 6..16;

/// Pairs of the long form, and as many as workshops make them.
const LONG: std::ops::Range<u64> = 0..1000;

/// The memory of the library of one pair, which every property shares: its parts are computed once.
const LIBRARY: usize = 512 << 20;

/// Figures of one property over all pairs.
#[derive(Default)]
struct Tally {
    tried: u32,
    refused: u32,
    worst: (f64, String),
    broken: Vec<String>,
}

impl Tally {
    fn add(&mut self, truth: &Truth, name: &str, pair: &DrawnPair, library: &Library) {
        match (truth.figure)(pair, library) {
            Ok(None) => {}
            Ok(Some(figure)) => {
                self.tried += 1;
                if figure.is_nan() || figure > truth.bound {
                    self.broken.push(format!("{name}: {figure:.2e}"));
                }
                if figure > self.worst.0 || figure.is_nan() {
                    self.worst = (figure, name.to_owned());
                }
            }
            Err(error) if is_in_fillet(pair, &error) => self.refused += 1,
            Err(error) => self.broken.push(format!("{name}: {error}")),
        }
    }
}

/// Tries every property on each of `pairs` and prints the worst figure of each; panics where one does not hold, or was tried on no pair.
fn hold(pairs: impl Iterator<Item = (String, DrawnPair)>) {
    let mut tallies: Vec<Tally> = TRUTHS.iter().map(|_| Tally::default()).collect();
    for (name, pair) in pairs {
        let library = Library::with_capacity(LIBRARY);
        for (truth, tally) in TRUTHS.iter().zip(&mut tallies) {
            tally.add(truth, &name, &pair, &library);
        }
    }
    let mut faults = Vec::new();
    for (truth, tally) in TRUTHS.iter().zip(tallies) {
        let Tally {
            tried,
            refused,
            worst,
            broken,
        } = tally;
        println!(
            "{}: {tried} pairs, worst {:.2e} of {:.2e} allowed ({})",
            truth.name, worst.0, truth.bound, worst.1
        );
        if !broken.is_empty() {
            let broken = broken.join("\n");
            faults.push(format!(
                "{}, at most {:.1e}:\n{broken}",
                truth.name, truth.bound
            ));
        }
        if tried == 0 {
            faults.push(format!("{} was tried on no pair", truth.name));
        }
        if refused > 2 + tried / 25 {
            faults.push(format!("{}: {refused} pairs refused", truth.name));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
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

#[test]
fn every_property_holds_of_pairs_on_which_a_defect_was_seen() {
    let seen = seen::pairs().into_iter();
    hold(seen.map(|(name, pair)| (name.to_owned(), pair)));
}

#[test]
fn every_property_holds_of_pairs_drawn_at_random() {
    hold(drawn(DAILY).chain(as_made(DAILY)));
}

#[test]
#[ignore = "./test all"]
fn every_property_holds_of_more_pairs_drawn_at_random() {
    hold(drawn(SHORT).chain(as_made(AS_MADE)));
}

#[test]
#[ignore = "two thousand pairs take hours"]
fn every_property_holds_of_pairs_drawn_at_random_at_length() {
    hold(drawn(LONG).chain(as_made(LONG)));
}
