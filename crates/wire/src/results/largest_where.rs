//! Where the largest value of a curve stands.

use meshwright_engine::analysis::Curve;
use meshwright_engine::analysis::largest_where::LargestWhere;
use meshwright_engine::gear::GearPair;

use crate::declare::document;
use crate::units::{significant, to_mm, to_mpa};

document! {
    /// Where the largest value of a curve stands: a pressure on both flanks, a stress in its own gear.
    pub struct WhereDocument as LargestWhere, "Place of a largest value"
    answer of (stands: &LargestWhere) with {
        let diameters = stands
            .diameters
            .map(|diameter| diameter.map(|diameter| significant(to_mm(diameter), 7)));
    } {
        /// The mesh position.
        mesh_position: f64 = stands.mesh_position,
        /// The pair on whose tooth it stands: 0 for the pair that passed the pitch point last, 1 for the next, -1 for the one before; absent at the edge
        /// of a hole.
        pair_offset?: i32 = stands.pair_offset,
        /// The diameter on the driving gear, in mm; absent for a stress in the driven one.
        driving_diameter_mm?: f64 = diameters[0],
        /// The diameter on the driven gear, in mm; absent for a stress in the driving one.
        driven_diameter_mm?: f64 = diameters[1],
        /// The height, in mm from the middle of the common face, of a stress from that of the gear's own face; absent in the plane.
        z_mm?: f64 = stands.z.map(to_mm),
    }
}

document! {
    /// The largest contact pressure over the span.
    pub struct PressureStatistics as PressureStatistics, "Statistics of the contact pressure"
    answer of (pair: &GearPair, curve: &Curve) with {
        let largest = curve.pressures.largest.map(|largest| to_mpa(largest.pressure));
    } {
        /// The largest pressure, in MPa, between the positions too; absent where a sharp corner carries somewhere, at which it has no limit.
        largest?: f64 = if curve.load == 0.0 { Some(0.0) } else { largest },
        /// Where it stands; absent without a largest pressure, and at the torque 0.
        largest_where?: WhereDocument = curve
            .pressures
            .largest
            .map(|largest| WhereDocument::of(&largest.stands(pair))),
    }
}
