//! Check of a computation against the limit of memory.

use std::collections::VecDeque;
use std::sync::Mutex;

use meshwright_engine::analysis::{Case, Method, Resolution};
use meshwright_engine::assembly::FaceResolution;
use meshwright_engine::gear::{HoleShape, Member, SolidGear, SpurGear};
use meshwright_engine::grid::GridLevel;

use super::problem::{Code, Problem};
use super::submission::Submission;

/// Plane pairs of at most so many teeth together and so many positions times torques take no more than [`USUAL_MB`]. Their grid is the
/// standard one or a coarser one, without an error estimate. Their rims are not thin, and their holes are round or slots.
const USUAL_TEETH: u32 = 120;
const USUAL_POSITIONS: u64 = 20_000;

/// The material between the root circle and holes, web or bore that makes a usual rim, in modules: then the interface circle lies a module
/// below the root circle. On a thinner rim it carries more orders, up to four times as many, and memory goes with their square.
const USUAL_RIM: f64 = 2.0;

/// Memory of a usual pair, in MB.
const USUAL_MB: u64 = 400;

/// True if counting alone shows that `submission` takes at most `limit_mb` of memory, in MB. It takes a fraction of a millisecond; for all others
/// [`memory_above`] decides.
pub fn memory_is_within(submission: &Submission, limit_mb: u64) -> bool {
    limit_mb >= USUAL_MB && is_usual(submission)
}

/// The memory that `submission` is estimated to take, in MB, if that is more than `limit_mb`.
///
/// The estimate divides the gears into elements, which takes up to a second: no thread that answers requests makes it. A usual pair is let through
/// without.
pub fn memory_above(submission: &Submission, limit_mb: u64) -> Option<u64> {
    if memory_is_within(submission, limit_mb) {
        return None;
    }
    let needed_mb = estimated_mb(submission);
    (needed_mb > limit_mb).then_some(needed_mb)
}

/// True for a plane pair of at most `most_teeth` together, on the standard grid or a coarser one, without an error estimate, with round holes or slots: the
/// kind whose cost is known by counting.
pub fn is_plain(case: &Case, most_teeth: u32) -> bool {
    let gears = Member::BOTH.map(|member| case.pair.gear(member));
    let has_contours = |gear: &SpurGear| {
        let mut holes = gear.data().blank.holes.iter();
        holes.any(|hole| matches!(hole.shape, HoleShape::Contour(_)))
    };
    case.faces().is_none()
        && gears.map(SpurGear::tooth_count).iter().sum::<u32>() <= most_teeth
        && !gears.into_iter().any(has_contours)
        && case.resolution.grid != GridLevel::Fine
        && !case.resolution.error_estimate
}

fn is_usual(submission: &Submission) -> bool {
    let case = submission.case();
    let gears = Member::BOTH.map(|member| case.pair.gear(member));
    is_plain(case, USUAL_TEETH)
        && gears.into_iter().all(has_usual_rim)
        && case.resolution.interface_radii == [None; 2]
        && submission.positions_total() <= USUAL_POSITIONS
}

/// True if the gear is no shaft, and its rim is not thin.
fn has_usual_rim(gear: &SpurGear) -> bool {
    let blank = &gear.data().blank;
    let web = blank.web_in(gear.face_width());
    let reach = blank.outer_reach().unwrap_or(blank.bore_radius);
    let reach = reach.max(web.map_or(0.0, |web| web.outer_radius));
    blank.shaft().is_none() && gear.root_radius() - reach >= USUAL_RIM * gear.data().rack.module
}

/// The fields on which an estimate of memory depends. Flank modifications, tooth deviations and the position of the gears are not among them, so that all
/// members of most populations have one estimate.
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
            gears: Member::BOTH.map(|member| case.pair.gear(member).with_unmodified_flanks()),
            faces: case.faces().map(|faces| {
                let gears = Member::BOTH.map(|member| faces.pair.gear(member).with_plain_flanks());
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

/// Number of estimates that are kept.
const KEPT: usize = 8;

/// The memory that `submission` is estimated to take, in MB.
fn estimated_mb(submission: &Submission) -> u64 {
    let case = submission.case();
    let estimate = || {
        let estimate = submission.estimate();
        estimate.memory.div_ceil(1_000_000)
    };
    if submission.forces().is_some() || submission.modes().is_some() {
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

/// The estimated memory of `submission` in MB; for a usual pair the bound for all of them.
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
    use std::f64::consts::TAU;

    use meshwright_engine::analysis;
    use serde_json::{Value, json};

    use super::*;
    use crate::testing::parse;

    /// A pair with as many teeth as a usual one may have, on the standard grid.
    fn largest_usual(holes: u32, positions: u32) -> Submission {
        let gear = json!({
            "tooth_count": USUAL_TEETH / 2, "module_mm": 2.0, "face_width_mm": 20.0,
            "blank": {
                "bore_radius_mm": 16.0,
                "holes": { "count": holes, "circle_radius_mm": 51.0, "radius_mm": 2.0 },
            },
        });
        let document = json!({
            "method": "flexible",
            "pair": { "center_distance_mm": 120.5, "driving": gear, "driven": gear },
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

    /// A gear with so many openings of so many sides each, on a circle.
    fn outlined(teeth: u32, (openings, sides): (u32, u32), (circle, radius): (f64, f64)) -> Value {
        let opening = |number: u32| -> Value {
            let side = |side: u32| {
                let at = TAU * f64::from(number) / f64::from(openings);
                // Clockwise.
                let around = -TAU * f64::from(side) / f64::from(sides);
                json!({ "line_to": [circle * at.cos() + radius * around.cos(), circle * at.sin() + radius * around.sin()] })
            };
            (0..sides).map(side).collect()
        };
        let outline: Vec<Value> = (0..openings).map(opening).collect();
        json!({
            "tooth_count": teeth, "module_mm": 2.0, "face_width_mm": 20.0,
            "blank": { "bore_radius_mm": 10.0, "outline": outline },
        })
    }

    #[test]
    fn a_plane_pair_with_outlines_and_many_positions_is_told_its_estimate() {
        let document = json!({
            "method": "projected_decomposition",
            "pair": {
                "center_distance_mm": 200.5,
                "driving": outlined(97, (7, 140), (52.25, 18.76)),
                "driven": outlined(103, (61, 16), (55.25, 2.276)),
            },
            "output_torques_n_m": [100.0],
            "resolution": { "positions_per_mesh_period": 20 },
        });
        let submission = parse(&document).expect("valid");
        let memory = analysis::estimate(submission.case(), None).memory;
        assert!(memory > 500_000_000, "{memory}");
        assert_eq!(
            memory_above(&submission, 500),
            Some(memory.div_ceil(1_000_000))
        );
    }

    #[test]
    fn members_of_a_population_are_told_the_estimate_of_each_other_which_is_that_of_each() {
        for (method, teeth) in [("three_dimensional_projected", 30), ("flexible", 110)] {
            let gear = json!({ "tooth_count": teeth, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 8.0 } });
            let mut document = json!({
                "method": method,
                "pair": { "center_distance_mm": 0.0, "driving": gear, "driven": gear },
                "output_torques_n_m": [50.0],
                "resolution": { "positions_per_mesh_period": 8, "span_mesh_periods": 1 },
            });
            let mut asked = None;
            let (mut slowest, mut anew) = (std::time::Duration::ZERO, std::time::Duration::ZERO);
            for member in 0..50 {
                let amount = 0.1 * f64::from(member + 1);
                let pair = &mut document["pair"];
                pair["center_distance_mm"] = json!(2.0 * f64::from(teeth) + 0.2 + 1e-3 * amount);
                pair["driving"]["tooth_deviations"] =
                    json!({ "eccentricity": { "amount_um": amount } });
                pair["driven"]["tip_relief"] = json!({ "amount_um": amount, "shape": "linear", "start": { "radial_length_mm": 1.5 } });
                let submission = parse(&document).expect("valid");
                let own = Asked::of(submission.case());
                assert!(asked.is_none_or(|before| before == own), "{method}");
                asked = Some(own);
                let start = std::time::Instant::now();
                let estimate = estimated_mb(&submission);
                if member > 0 {
                    slowest = slowest.max(start.elapsed());
                }
                let start = std::time::Instant::now();
                let own = analysis::estimate(submission.case(), None).memory;
                anew = anew.max(start.elapsed());
                assert_eq!(estimate, own.div_ceil(1_000_000));
            }
            println!(
                "{method}: an estimate that is known takes {slowest:?} at most, one that is not {anew:?}"
            );
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
