//! What a case will cost, known before it is computed.

use super::case::{Case, Method};
use super::expected_positions;
use crate::assembly::blank::blank_grid;
use crate::assembly::interface::{harmonics, interface_radius, orders_of_blank};
use crate::gear::{Member, gcd};
use crate::grid::ToothGrid;

/// Seconds of one core for the first contact solution at a fraction of the mesh period, for each further one there, for a
/// node of a factorized grid, and for a multiplication and addition of dense linear algebra; measured on a 2.6 GHz server
/// core, good to a factor of two.
const SECONDS: [f64; 4] = [0.2e-3, 0.05e-3, 6e-6, 0.05e-9];

/// Patterns of force that a tooth exerts on the interface circle, about.
const PATTERNS: f64 = 18.0;

/// Memory that any case takes, in bytes.
const BASE_MEMORY: f64 = 60e6;

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
    let [per_first, per_further, per_node, per_operation] = SECONDS;
    let solutions = expected_positions(case);
    // Only the flexible method solves a fraction of the mesh period more than once.
    let further = match case.method {
        Method::Flexible => solutions - solutions / u64::from(case.span()).max(1),
        _ => 0,
    };
    let mut seconds = per_first * (solutions - further) as f64 + per_further * further as f64;
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
        let radius = interface_radius(gear, case.resolution.interface_radii[member.index()]);
        let (Ok(tooth), Ok(blank)) = (
            ToothGrid::new(gear, radius, level),
            blank_grid(gear, radius, level),
        ) else {
            continue;
        };
        let (teeth, sectors) = (u64::from(gear.tooth_count()), u64::from(blank.sector_count));
        let tooth_nodes = (tooth.grid.nodes.len() - tooth.side_nodes.0.len() - 1) as u64;
        let blank_nodes = blank.own_nodes() as u64;
        degrees_of_freedom += 2 * (teeth * tooth_nodes + sectors * blank_nodes);

        let orders = orders_of_blank(gear, radius, level);
        let (all, met) = (
            harmonics(gear, radius, level).unknowns() as f64,
            orders.unknowns() as f64,
        );
        // The gear repeats itself so many times, and keeps the rows of the teeth of one period.
        let repeats = f64::from(gcd(gear.tooth_count(), blank.sector_count));
        let rows = teeth as f64 / repeats;
        memory += 8.0 * (4.0 * all * all + 2.0 * met * rows.min(32.0) * PATTERNS)
            + 3e3 * (tooth_nodes + blank_nodes) as f64;
        let factorization = met * met * met / (6.0 * repeats * repeats);
        let answers = rows * PATTERNS * met * (met / (2.0 * repeats) + 5.0 * PATTERNS);
        seconds += per_node * (tooth_nodes + blank_nodes) as f64
            + per_operation * (factorization + answers);
    }
    Estimate {
        degrees_of_freedom,
        memory: memory as u64,
        seconds,
        positions,
    }
}
