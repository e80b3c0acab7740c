//! Whether a computation would take more memory than it may.

use meshwright_engine::analysis;
use meshwright_engine::gear::Member;
use meshwright_engine::grid::GridLevel;

use super::problem::{Code, Problem};
use super::submission::Submission;

/// Plane pairs of so many teeth together, on the standard grid or a coarser one, take no more than [`USUAL_MB`], whatever else
/// is asked.
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
    let usual =
        case.faces.is_none() && teeth <= USUAL_TEETH && case.resolution.grid != GridLevel::Fine;
    if usual && limit_mb >= USUAL_MB {
        return None;
    }
    let needed_mb = analysis::estimate(case, submission.forces())
        .memory
        .div_ceil(1_000_000);
    (needed_mb > limit_mb).then_some(needed_mb)
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
    use crate::wire::testing::parse;

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
    fn a_limit_below_the_estimate_is_told_with_both() {
        let submission = largest_usual(20, 40);
        let needed = memory_above(&submission, 1).expect("more than one MB");
        assert_eq!(memory_above(&submission, needed), None);
        let problem = too_much_memory(needed, 1);
        assert_eq!(problem.code, Code::TooLarge);
        assert!(problem.detail.contains(&format!("{needed} MB")));
    }
}
