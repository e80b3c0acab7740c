//! All teeth of a gear, down to the interface circle.

use std::sync::Arc;

use super::PartError;
use super::interface::harmonics;
use crate::flank::table::FlankTable;
use crate::gear::{SpurGear, TipEdge};
use crate::grid::{GridError, GridLevel, ToothGrid};
use crate::ring::body::Coupling;
use crate::ring::teeth::{FARTHEST_COUPLED, TeethRing};
use crate::ring::tooth::ToothSubstructure;
use crate::run::Run;

/// A broken edge smaller than this, in modules, is a sharp one to the grid, whose elements there are half as large.
const LEAST_EDGE: f64 = 0.02;

/// Specification of the teeth of a gear.
#[derive(Debug, Clone, PartialEq)]
pub struct TeethSpec {
    gear: SpurGear,
    interface_radius: f64,
    level: GridLevel,
}

/// All teeth of a gear, down to the interface circle.
#[derive(Debug)]
pub struct Teeth {
    /// The flank of each.
    pub flank: Arc<FlankTable>,
    /// Their ring.
    pub ring: TeethRing,
    /// Teeth with the interface circle held.
    pub on_rigid_blank: Arc<Coupling>,
    /// Unknowns before condensation.
    pub degrees_of_freedom: u64,
}

impl TeethSpec {
    /// The teeth of `gear` down to `interface_radius`. Nothing inside that circle counts, and no modification or
    /// deviation: they are gaps and hardly change how a tooth bends. Nor does a broken edge smaller than elements are.
    pub fn new(gear: &SpurGear, interface_radius: f64, level: GridLevel) -> Self {
        let teeth = gear.without_blank();
        let broken = match gear.data().tip_edge {
            TipEdge::Sharp => 0.0,
            TipEdge::Rounded(amount) | TipEdge::Chamfered(amount) => amount,
        };
        Self {
            gear: if broken < LEAST_EDGE * gear.data().rack.module {
                teeth.with_plain_flanks()
            } else {
                teeth.with_unmodified_flanks()
            },
            interface_radius,
            level,
        }
    }

    /// The gear, as far as its teeth go.
    pub(super) fn gear(&self) -> &SpurGear {
        &self.gear
    }

    /// The grid of one of them.
    ///
    /// # Errors
    ///
    /// [`GridError`].
    pub fn grid(&self) -> Result<ToothGrid, GridError> {
        ToothGrid::new(&self.gear, self.interface_radius, self.level)
    }

    /// Makes them, on this thread alone.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn make(&self, run: &Run) -> Result<Teeth, PartError> {
        let Self {
            gear,
            interface_radius,
            level,
        } = self;
        run.check()?;
        let grid = self.grid()?;
        run.check()?;
        let tooth = ToothSubstructure::new(gear, &grid)?;
        run.check()?;
        let ring = TeethRing::new(&tooth, harmonics(gear, *interface_radius, *level), run)?;
        // Nodes of the interface circle belong to the teeth; the blank's follow them.
        let degrees_of_freedom = 2 * u64::from(gear.tooth_count()) * (tooth.own_nodes() as u64);
        Ok(Teeth {
            flank: Arc::new(FlankTable::new(&tooth, gear)),
            on_rigid_blank: Arc::new(Coupling::on_rigid_blank(&ring, FARTHEST_COUPLED)),
            ring,
            degrees_of_freedom,
        })
    }
}
