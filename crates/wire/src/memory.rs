//! Whether a computation would take more memory than it may.

use std::collections::VecDeque;
use std::sync::Mutex;

use meshwright_engine::analysis::{self, Case, Method, Resolution};
use meshwright_engine::assembly::FaceResolution;
use meshwright_engine::gear::{Member, SolidGear, SpurGear};
use meshwright_engine::grid::GridLevel;

use super::problem::{Code, Problem};
use super::submission::Submission;

/// Plane pairs of so many teeth together, on the standard grid or a coarser one without an error estimate, take no more than
/// [`USUAL_MB`], whatever else is asked.
const USUAL_TEETH: u32 = 200;

/// Memory of a usual pair, in MB.
const USUAL_MB: u64 = 400;

/// The memory that `submission` is estimated to take, in MB, if that is more than `limit_mb`.
///
/// The estimate divides the gears into elements, which takes milliseconds; a usual pair is let through without.
pub fn memory_above(submission: &Submission, limit_mb: u64) -> Option<u64> {
    let case = submission.case();
    let teeth: u32 = Member::BOTH
        .into_iter()
        .map(|member| case.pair.gear(member).tooth_count())
        .sum();
    let usual = case.faces().is_none()
        && teeth <= USUAL_TEETH
        && case.resolution.grid != GridLevel::Fine
        && !case.resolution.error_estimate;
    if usual && limit_mb >= USUAL_MB {
        return None;
    }
    let needed_mb = estimated_mb(submission);
    (needed_mb > limit_mb).then_some(needed_mb)
}

/// What an estimate of memory depends on: not on what teeth deviate by, nor on how gears stand to each other, so that all members of a
/// population have one.
#[derive(Debug, PartialEq)]
struct Asked {
    gears: [SpurGear; 2],
    faces: Option<([SolidGear; 2], FaceResolution, usize)>,
    method: Method,
    resolution: Resolution,
    positions: usize,
    torques: usize,
    loaded: usize,
    stress: bool,
}

impl Asked {
    fn of(case: &Case) -> Self {
        let loaded = case.output_torques.iter().filter(|torque| **torque != 0.0);
        Self {
            gears: Member::BOTH.map(|member| case.pair.gear(member).as_drawn()),
            faces: case.faces().map(|faces| {
                let gears = Member::BOTH.map(|member| faces.pair.gear(member).as_drawn());
                (gears, faces.resolution, faces.slices)
            }),
            method: case.method(),
            resolution: case.resolution,
            positions: case.positions(),
            torques: case.output_torques.len(),
            loaded: loaded.count(),
            stress: case.stress,
        }
    }
}

/// The estimates that were made last.
static LAST: Mutex<VecDeque<(Asked, u64)>> = Mutex::new(VecDeque::new());

/// So many of them are kept.
const KEPT: usize = 8;

/// The memory that `submission` is estimated to take, in MB.
fn estimated_mb(submission: &Submission) -> u64 {
    let case = submission.case();
    let estimate = || {
        let estimate = analysis::estimate(case, submission.forces());
        estimate.memory.div_ceil(1_000_000)
    };
    if submission.forces().is_some() {
        return estimate();
    }
    let asked = Asked::of(case);
    let last = || LAST.lock().expect("nothing panics with this lock");
    if let Some((_, needed_mb)) = last().iter().find(|(other, _)| *other == asked) {
        return *needed_mb;
    }
    let needed_mb = estimate();
    let mut last = last();
    last.truncate(KEPT - 1);
    last.push_front((asked, needed_mb));
    needed_mb
}

/// The memory that `submission` is estimated to take, in MB: of a usual pair what all of them stay below.
pub fn memory_of(submission: &Submission) -> u64 {
    memory_above(submission, USUAL_MB).unwrap_or(USUAL_MB)
}

/// That a computation would take too much memory.
pub fn too_much_memory(needed_mb: u64, limit_mb: u64) -> Problem {
    Problem::new(
        Code::TooLarge,
        format!(
            "The computation needs about {needed_mb} MB; one may take {limit_mb} MB here. A coarser grid or fewer teeth take less."
        ),
    )
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::testing::parse;

    /// A pair with as many teeth as a usual one may have, on the standard grid.
    fn largest_usual(holes: u32, positions: u32) -> Submission {
        let gear = json!({
            "tooth_count": USUAL_TEETH / 2, "module_mm": 2.0, "face_width_mm": 20.0,
            "blank": {
                "bore_radius_mm": 16.0,
                "holes": { "count": holes, "circle_radius_mm": 70.0, "radius_mm": 2.0 },
            },
        });
        let document = json!({
            "method": "flexible",
            "pair": { "center_distance_mm": 200.5, "driving": gear, "driven": gear },
            "output_torques_n_m": [200.0],
            "resolution": { "positions_per_mesh_period": positions },
        });
        parse(&document).expect("valid")
    }

    #[test]
    fn no_usual_pair_takes_more_than_is_said() {
        for (holes, positions) in [(4, 40), (7, 40), (20, 40), (60, 40), (60, 200), (59, 20)] {
            let memory = analysis::estimate(largest_usual(holes, positions).case(), None).memory;
            assert!(memory <= USUAL_MB * 1_000_000, "{holes} holes: {memory}");
        }
    }

    #[test]
    fn members_of_a_population_are_told_the_estimate_of_each_other_which_is_that_of_each() {
        let gear = json!({ "tooth_count": 30, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 8.0 } });
        let mut document = json!({
            "method": "three_dimensional_projected",
            "pair": { "center_distance_mm": 60.2, "driving": gear, "driven": gear },
            "output_torques_n_m": [50.0],
            "resolution": { "positions_per_mesh_period": 8, "span_mesh_periods": 1 },
        });
        let mut slowest = std::time::Duration::ZERO;
        for member in 0..200 {
            document["pair"]["center_distance_mm"] = json!(60.2 + 1e-4 * f64::from(member));
            let run_out = json!({ "eccentricity": { "amount_um": 0.1 * f64::from(member + 1) } });
            document["pair"]["driving"]["tooth_deviations"] = run_out;
            let submission = parse(&document).expect("valid");
            let start = std::time::Instant::now();
            let told = estimated_mb(&submission);
            if member > 0 {
                slowest = slowest.max(start.elapsed());
            }
            let own = analysis::estimate(submission.case(), None).memory;
            assert_eq!(told, own.div_ceil(1_000_000));
        }
        println!("an estimate that is known takes {slowest:?} at most");
    }

    #[test]
    fn a_limit_below_the_estimate_is_told_with_both() {
        let submission = largest_usual(20, 40);
        let needed = memory_above(&submission, 1).expect("more than one MB");
        assert_eq!(memory_above(&submission, needed), None);
        let problem = too_much_memory(needed, 1);
        assert_eq!(problem.code, Code::TooLarge);
        assert!(problem.detail.contains(&format!("{needed} MB")));
    }
}
