//! The blank of a gear, from the bore to the interface circle.

use super::PartError;
use super::interface::orders_of_blank;
use crate::fem::recovery::Functional;
use crate::gear::SpurGear;
use crate::grid::ring_grid::ELEMENTS_PER_TOOTH;
use crate::grid::{BlankGrid, GridError, GridLevel};
use crate::ring::blank::{BlankLoad, BlankLoads, BlankRecovery, BlankSubstructure, Hold};
use crate::ring::cyclic::Harmonics;
use crate::run::Run;

/// Elements of the blank along the interface circle for each tooth, at most: a rim so thin that it would want more is
/// refused or warned of.
const MOST_ELEMENTS_PER_TOOTH: f64 = 10.0;

/// Elements along the interface circle of a holed blank, at least.
const ELEMENTS_AROUND_HOLES: f64 = 400.0;

/// Specification of a blank.
#[derive(Debug, Clone, PartialEq)]
pub struct BlankSpec {
    gear: SpurGear,
    interface_radius: f64,
    level: GridLevel,
}

impl BlankSpec {
    /// The blank of `gear` inside `interface_radius`, with hole 0 at the angle 0: a blank is turned when it is joined.
    pub fn new(gear: &SpurGear, interface_radius: f64, level: GridLevel) -> Self {
        Self {
            gear: gear.with_holes_unturned().with_plain_flanks(),
            interface_radius,
            level,
        }
    }

    /// The same blank without holes.
    pub fn solid(&self) -> Self {
        Self {
            gear: self.gear.without_holes(),
            ..self.clone()
        }
    }

    /// The orders that find it unlike a solid blank.
    pub fn orders(&self) -> Harmonics {
        orders_of_blank(&self.gear, self.interface_radius, self.level)
    }

    /// Its grid, or that of one of its equal sectors.
    ///
    /// # Errors
    ///
    /// [`GridError`].
    pub fn grid(&self) -> Result<BlankGrid, GridError> {
        blank_grid(&self.gear, self.interface_radius, self.level)
    }

    /// Makes it, on this thread alone.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn make(&self, run: &Run) -> Result<BlankSubstructure, PartError> {
        run.check()?;
        Ok(self.make_with(&self.grid()?, &[], run)?.0)
    }

    /// Makes it from its `grid`, with the values of the functionals `asked` of its sector 0.
    pub(super) fn make_with(
        &self,
        grid: &BlankGrid,
        asked: &[Functional],
        run: &Run,
    ) -> Result<(BlankSubstructure, BlankRecovery), PartError> {
        let hold = self.gear.data().blank.core.into();
        let (blank, recovery, _) = self.make_loaded(grid, hold, asked, &[], run)?;
        Ok((blank, recovery))
    }

    /// Makes it of its `grid`, its bore held as `hold` says, with the functionals `asked` of its sector 0 and under the `loads` inside it.
    pub(super) fn make_loaded(
        &self,
        grid: &BlankGrid,
        hold: Hold,
        asked: &[Functional],
        loads: &[BlankLoad],
        run: &Run,
    ) -> Result<(BlankSubstructure, BlankRecovery, BlankLoads), PartError> {
        let plate = (self.gear.material(), self.gear.face_width());
        let made = (hold, plate, self.orders());
        let radius = self.interface_radius;
        Ok(BlankSubstructure::loaded(
            grid, radius, made, asked, loads, run,
        )?)
    }

    /// The gear, as far as its blank goes.
    pub(super) fn gear(&self) -> &SpurGear {
        &self.gear
    }
}

/// The grid of the blank of `gear`, or of one of its equal sectors, fine enough on the interface circle for the orders that it carries.
///
/// # Errors
///
/// [`GridError`] if the holes leave no room for elements.
pub fn blank_grid(
    gear: &SpurGear,
    interface_radius: f64,
    level: GridLevel,
) -> Result<BlankGrid, GridError> {
    let z = f64::from(gear.tooth_count());
    let orders = |level| orders_of_blank(gear, interface_radius, level).largest as f64 / z;
    // Seven nodes, three and a half elements, for two wavelengths of the highest order.
    let of_orders = 1.75 * orders(GridLevel::Standard);
    // The coarse level has half of them, and needs five nodes: with four and fewer an order is mistaken for a low one, which makes a
    // solid blank softer than a holed one, whose highest orders are solved apart.
    let of_coarse = match level {
        GridLevel::Coarse => 2.0 * (1.25 * orders(level)).ceil(),
        GridLevel::Standard | GridLevel::Fine => 0.0,
    };
    // Holes are as large as their gear and not as its teeth.
    let least = if gear.holes().is_empty() {
        ELEMENTS_PER_TOOTH
    } else {
        ELEMENTS_PER_TOOTH.min(ELEMENTS_AROUND_HOLES / z)
    };
    let region = &gear.data().blank;
    if let Some(web) = region.web_in(gear.face_width())
        && web.outer_radius > interface_radius
    {
        return Err(GridError::WebAboveInterface {
            web_radius: web.outer_radius,
            interface_radius,
        });
    }
    BlankGrid::of_region(
        region,
        gear.face_width(),
        interface_radius,
        gear.tooth_count(),
        of_orders
            .clamp(least, MOST_ELEMENTS_PER_TOOTH)
            .max(of_coarse),
        level,
    )
}
