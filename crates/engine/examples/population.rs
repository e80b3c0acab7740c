//! A population: pairs made to one drawing, each tooth with its own errors.
//! `cargo run -p meshwright-engine --example population -- 1000 10 6`: so many pairs, positions a mesh period, and the accuracy class
//! (ISO 1328-1:2013) of both gears.
//!
//! Gears with 50 teeth, ten holes in the driven one, under 115 N m over a revolution of 50 mesh periods.

use std::time::Instant;

use meshwright_engine::analysis::pair_model;
use meshwright_engine::contact::positions::contacts;
use meshwright_engine::gear::{Member, Normals, PairDeviations, Tolerances};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

#[path = "../tests/cases/mod.rs"]
mod cases;

/// The process capability that the tolerances are worth.
const CAPABILITY: f64 = 1.33;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let numbers: Result<Vec<u64>, _> = std::env::args().skip(1).map(|each| each.parse()).collect();
    let (count, per_period, class) = match numbers?.as_slice() {
        [count, per_period, class] => (*count, *per_period, *class as u32),
        _ => (1000, 10, 6),
    };
    let run = Run::unattended();

    // What all of them share: the drawing, and its model.
    let case = cases::test_case(2);
    let model = pair_model(&case, &Library::default(), &run)?;
    let load = case.pair.load(115.0);
    let revolution = u64::from(case.pair.driven().tooth_count());
    let positions: Vec<f64> = (0..revolution * per_period)
        .map(|i| i as f64 / per_period as f64)
        .collect();

    // What each of them is: teeth drawn within the tolerances.
    let tolerances = Member::BOTH.map(|member| Tolerances::of(case.pair.gear(member), class));
    let member = |seed: u64| {
        let teeth = Member::BOTH.map(|member| {
            let mut normals = Normals::new(seed, member.index() as u64);
            let teeth = case.pair.gear(member).tooth_count();
            tolerances[member.index()].draw(teeth, CAPABILITY, &mut normals)
        });
        PairDeviations::new(&case.pair, teeth.each_ref())
    };

    let started = Instant::now();
    let (mut peaks, mut iterations) = (Vec::new(), 0);
    for seed in 0..count {
        let deviations = member(seed)?;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for contact in contacts(model.deviating(&deviations), load, &positions, &run)? {
            let delta = contact.transmission_error;
            (low, high) = (low.min(delta), high.max(delta));
            iterations += u64::from(contact.iterations);
        }
        peaks.push(high - low);
    }
    let seconds = started.elapsed().as_secs_f64();

    peaks.sort_by(f64::total_cmp);
    let percentile = |part: f64| 1e6 * peaks[((peaks.len() - 1) as f64 * part) as usize];
    println!(
        "peak-to-peak of {count} pairs of class {class}: {:.3} um at p5, {:.3} at p50, {:.3} at p95",
        percentile(0.05),
        percentile(0.5),
        percentile(0.95)
    );
    let solved = (count as usize * positions.len()) as f64;
    println!(
        "{seconds:.2} s on {} threads: {:.1} us of one for a position, with {:.2} linear systems each; {:.1} MB known of the drawn pair",
        rayon::current_num_threads(),
        1e6 * seconds * rayon::current_num_threads() as f64 / solved,
        iterations as f64 / solved,
        1e-6 * (model.drawn.bytes() + model.compliances.bytes()) as f64,
    );
    Ok(())
}
