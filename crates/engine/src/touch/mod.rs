//! Where flanks stand, and how two of them meet.
//!
//! - [`placement`]: both gears turned to a mesh position, and the gap of one flank to the other.
//! - [`facing`]: places where two flanks that face each other are nearest, and the lag at which they touch.
//! - `meeting`: forces where they meet.

pub(crate) mod gap_profile;
pub(crate) mod meeting;
pub(crate) mod placement;
