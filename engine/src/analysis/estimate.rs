//! What a case will cost, known before it is computed.

use super::case::{Case, Method};
use super::expected_positions;
use super::library::{blank_grid, harmonics, interface_radius};
use crate::gear::Member;
use crate::grid::ToothGrid;

/// Seconds of one core for a contact solution at the standard level, for a node of a factorized grid, and for a
/// multiplication and addition of dense linear algebra; measured on a 2.5 GHz server core, good to a factor of two.
const SECONDS: (f64, f64, f64) = (0.3e-3, 8e-6, 0.08e-9);

/// Loading modes of a tooth, about.
const MODES: f64 = 24.0;

/// Memory that any case takes, in bytes.
const BASE_MEMORY: f64 = 30e6;

/// What a case will cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Unknowns of both gears before condensation.
    pub degrees_of_freedom: u64,
    /// Memory in bytes.
    pub memory: u64,
    /// Time on one core in seconds, nothing cached.
    pub seconds: f64,
    /// Positions times torques.
    pub positions: u64,
}

/// Estimates what `case` will cost; the grids are laid, nothing is solved. A gear whose grid fails counts as nothing.
pub fn estimate(case: &Case) -> Estimate {
    let positions = (case.positions() * case.output_torques.len()) as u64;
    let (per_contact, per_node, per_operation) = SECONDS;
    let mut seconds = per_contact * expected_positions(case) as f64;
    let (mut degrees_of_freedom, mut memory) = (0, BASE_MEMORY);
    if case.method == Method::LoadDistribution {
        return Estimate {
            degrees_of_freedom,
            memory: memory as u64,
            seconds: seconds / 10.0,
            positions,
        };
    }
    let level = case.resolution.grid;
    for member in Member::BOTH {
        let gear = case.pair.gear(member);
        let radius = interface_radius(case, member);
        let (Ok(tooth), Ok(blank)) = (
            ToothGrid::new(gear, radius, level),
            blank_grid(gear, gear.holes(), radius, level),
        ) else {
            continue;
        };
        let (teeth, sectors) = (u64::from(gear.tooth_count()), u64::from(blank.sector_count));
        let tooth_nodes = (tooth.grid.nodes.len() - tooth.side_nodes.0.len() - 1) as u64;
        let blank_nodes = (blank.grid.nodes.len() - blank.side_nodes.0.len() - 2) as u64;
        degrees_of_freedom += 2 * (teeth * tooth_nodes + sectors * blank_nodes);

        let unknowns = harmonics(gear, radius, level).unknowns() as f64;
        let modes = MODES * teeth as f64;
        memory += 8.0 * (4.0 * unknowns * unknowns + 2.0 * unknowns * modes)
            + 3e3 * (tooth_nodes + blank_nodes) as f64;
        seconds += per_node * (tooth_nodes + blank_nodes) as f64
            + per_operation * unknowns * unknowns * (unknowns / 3.0 + modes);
    }
    Estimate {
        degrees_of_freedom,
        memory: memory as u64,
        seconds,
        positions,
    }
}
