//! Whether a computation would take more memory than it may.

use meshwright_engine::analysis;
use meshwright_engine::gear::Member;
use meshwright_engine::grid::GridLevel;

use super::problem::{Code, Problem};
use super::submission::Submission;

/// Pairs of so many teeth together, on the standard grid or a coarser one, take no more than [`USUAL_MB`], whatever else
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
    let usual = teeth <= USUAL_TEETH && case.resolution.grid != GridLevel::Fine;
    if usual && limit_mb >= USUAL_MB {
        return None;
    }
    let needed_mb = analysis::estimate(case).memory.div_ceil(1_000_000);
    (needed_mb > limit_mb).then_some(needed_mb)
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
