//! Finite-element grids of tooth sectors and holed blanks.
//!
//! Teeth and equal round holes are divided into 8-node quadrilaterals in structured blocks, any other blank into 6-node triangles. Read in this order:
//! [`level`] (resolution), [`element`] (the two elements), [`planar`] (a grid and its quality), [`tooth`] and [`blank`] (the two sectors a gear is assembled
//! from), [`ring_grid`] (by a sector or not), [`whole`] (a blank without symmetry).

pub mod blank;
mod block;
mod chart;
mod division;
pub mod element;
mod frame;
mod hole_box;
pub mod level;
mod outline;
mod outlines;
pub mod planar;
mod polar;
pub mod ring_grid;
mod root_curve;
mod sector;
mod sizes;
pub mod tooth;
mod tooth_plan;
mod triangles;
pub mod whole;

pub use blank::BlankGrid;
pub use element::{Element, ElementKind};
pub use level::GridLevel;
pub use planar::{Grid, GridQuality};
pub use tooth_plan::ToothGrid;

/// The smallest corner angle of a usable grid, in radians (15 degrees).
pub const LEAST_ANGLE: f64 = std::f64::consts::PI / 12.0;

/// Why a sector cannot be divided into elements. Lengths are in meters, angles in radians.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GridError {
    /// The interface circle does not run below the teeth.
    #[error(
        "the interface radius {interface_radius} m must lie between zero and the root radius {root_radius} m"
    )]
    InterfaceOutsideRim {
        /// The interface radius asked for.
        interface_radius: f64,
        /// The root radius of the gear.
        root_radius: f64,
    },
    /// The interface circle does not run outside the bore.
    #[error(
        "the interface radius {interface_radius} m must be larger than the bore radius {bore_radius} m"
    )]
    InterfaceInsideBore {
        /// The interface radius asked for.
        interface_radius: f64,
        /// The bore radius.
        bore_radius: f64,
    },
    /// A web reaches beyond the interface circle, where teeth stand that are as thick as the face is wide.
    #[error(
        "the web reaches out to {web_radius} m, beyond the interface radius {interface_radius} m"
    )]
    WebAboveInterface {
        /// Where the web ends.
        web_radius: f64,
        /// The interface radius.
        interface_radius: f64,
    },
    /// A hole reaches its neighbor, the bore or the interface circle.
    #[error(
        "the holes leave {beside} m between them, {above} m below the interface circle and {below} m around the bore"
    )]
    NoLigament {
        /// The material between neighboring holes.
        beside: f64,
        /// The material between a hole and the interface circle.
        above: f64,
        /// The material between a hole and the bore.
        below: f64,
    },
    /// The sector is shaped such that some element is folded or too slender at a corner.
    #[error(
        "an element is distorted: least Jacobian ratio {smallest_jacobian}, corner angles from {smallest_angle} rad to {largest_angle} rad"
    )]
    Distorted {
        /// The least ratio of Jacobian determinants within an element; not positive where one is folded.
        smallest_jacobian: f64,
        /// The smallest corner angle.
        smallest_angle: f64,
        /// The largest corner angle.
        largest_angle: f64,
    },
}

/// Passes a grid whose elements are all usable.
fn checked(grid: Grid) -> Result<Grid, GridError> {
    let GridQuality {
        smallest_jacobian,
        smallest_angle,
        largest_angle,
    } = grid.quality();
    // Written so that a coordinate that is not a number is refused as well.
    if smallest_jacobian > 0.0 && smallest_angle >= LEAST_ANGLE {
        Ok(grid)
    } else {
        Err(GridError::Distorted {
            smallest_jacobian,
            smallest_angle,
            largest_angle,
        })
    }
}
