//! Where flanks stand, and how two of them meet.
//!
//! - [`placement`]: both gears turned to a mesh position, and what one flank sees of the other.
//! - [`facing`]: where two flanks that face each other are nearest, and at which lag they touch.
//! - `meeting`: how they push where they meet.

pub mod facing;
pub(crate) mod meeting;
pub mod placement;
