//! Grid of a blank: one sector of a pattern, or the whole.

use std::f64::consts::TAU;

use super::sector::Sector;
use super::{BlankGrid, GridError, GridLevel};
use crate::gear::{BlankRegion, HolePattern};

/// The least number of elements on the interface circle per tooth at the standard level.
pub const ELEMENTS_PER_TOOTH: f64 = 4.0;

impl BlankGrid {
    /// Divides the blank `region` inside `interface_radius`, under `tooth_count` teeth with `elements_per_tooth` elements on the
    /// interface circle for each at the standard level. `face_width` is the thickness beside the web.
    ///
    /// A blank without holes is divided by one pitch, a pattern of round holes by the sector of one hole; any other, and one
    /// whose web ends across the holes or close to them, as a whole. The frame is that of hole 0 of a pattern, so that patterns
    /// of any phase share their grid, and of the gear otherwise: turned by [`BlankRegion::phase`].
    ///
    /// # Errors
    ///
    /// [`GridError`] if the ring has no width, if the holes leave no material around them, or if an element is distorted.
    pub fn of_region(
        region: &BlankRegion,
        face_width: f64,
        interface_radius: f64,
        tooth_count: u32,
        elements_per_tooth: f64,
        level: GridLevel,
    ) -> Result<Self, GridError> {
        let pattern = region.pattern();
        if region.holes.is_empty() || pattern.is_some() {
            let sector = Sector::new(
                region.bore_radius,
                interface_radius,
                pattern.as_ref(),
                tooth_count,
                elements_per_tooth,
                level,
            )?;
            if let Some(sector) = sector.with_web(region.web_in(face_width), face_width) {
                return sector.divide();
            }
        }
        let elements = elements_per_tooth * f64::from(tooth_count.max(1));
        let region = settled(region.turned(-region.phase()));
        Self::whole(&region, face_width, interface_radius, elements, level)
    }

    /// Divides one sector of the ring between `bore_radius` and `interface_radius`, on which `tooth_count` teeth stand,
    /// with `elements_per_tooth` elements on the interface circle for each at the standard level.
    ///
    /// The phase of the holes is left to the caller.
    ///
    /// # Errors
    ///
    /// [`GridError`] if the ring has no width, if the holes leave no material around them, or if an element is
    /// distorted.
    pub fn new(
        bore_radius: f64,
        interface_radius: f64,
        holes: Option<&HolePattern>,
        tooth_count: u32,
        elements_per_tooth: f64,
        level: GridLevel,
    ) -> Result<Self, GridError> {
        let sector = Sector::new(
            bore_radius,
            interface_radius,
            holes,
            tooth_count,
            elements_per_tooth,
            level,
        )?;
        sector.divide()
    }
}

/// The same region with the angles of its holes rounded, from 0 to 2π: so that a blank turned by a whole turn, which leaves it the same
/// but for the last bits, has the same triangles.
fn settled(mut region: BlankRegion) -> BlankRegion {
    const STEP: f64 = 1e-11;
    // Hole 0 is at 0, or the last bits before.
    const BEFORE: f64 = 1e-6;
    for hole in &mut region.holes {
        let within = (hole.angle + BEFORE).rem_euclid(TAU) - BEFORE;
        hole.angle = (within / STEP).round() * STEP;
    }
    region
}
