//! What several tests share beside the cases: answers, pairs under load, stresses.

#![allow(
    dead_code,
    reason = "these tests and those in `tests/reference` use some of it each"
)]

#[path = "../cases/mod.rs"]
mod cases;

use std::sync::OnceLock;

use meshwright_engine::analysis::stress::GearStresses;
use meshwright_engine::analysis::{Analysis, Case, Curve, analyze};
use meshwright_engine::gear::GearPair;
use meshwright_engine::grid::GridLevel;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

pub(crate) use cases::*;

/// A small pair for whole grids: 18/18 at 36.3 mm, bore 6 mm, three holes in the driven gear, out of line with its teeth.
pub(crate) fn small_pair() -> GearPair {
    let data = gear(18, 6e-3);
    pair(data.clone(), holed(data, 3, 10.5e-3, 2e-3, 0.21), 36.3e-3)
}

/// The teeth and blanks that the tests share.
pub(crate) fn library() -> &'static Library {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    LIBRARY.get_or_init(Library::default)
}

/// The answer to `case`.
pub(crate) fn solve(case: &Case) -> Analysis {
    analyze(case, library(), &Run::unattended())
        .unwrap_or_else(|error| panic!("{error} {:?}", std::error::Error::source(&error)))
}

/// The roll length on the driving gear at which the pair that passes the pitch point at mesh position `n` touches.
pub(crate) fn roll_length(pair: &GearPair, eta: f64, n: i64) -> f64 {
    pair.pitch_roll_length() + (eta - n as f64) * pair.base_pitch()
}

/// How far a roll length lies outside the path of contact A-E; zero inside.
pub(crate) fn beyond_path(pair: &GearPair, roll_length: f64) -> f64 {
    let (s_a, s_e) = pair.path_of_contact();
    (s_a - roll_length).max(roll_length - s_e).max(0.0)
}

/// The curve of `pair` under `torque` with its stresses, at `positions` over one mesh period.
pub(crate) fn stressed(pair: GearPair, torque: f64, positions: u32, level: GridLevel) -> Curve {
    let mut case = case(pair, &[torque]);
    case.stress = true;
    case.resolution.grid = level;
    case.resolution.span_mesh_periods = Some(1);
    case.resolution.positions_per_mesh_period = positions;
    solve(&case).curves.remove(0)
}

/// Those that the case asked for.
pub(crate) fn stresses(curve: &Curve) -> &[GearStresses; 2] {
    curve.stresses.as_ref().expect("asked for")
}
