//! Gears on the harmonics of a circle: N equal sectors joined into a ring, and rings into a whole gear.
//!
//! Read in this order: [`harmonics`] (the unknowns of an interface circle), [`cyclic`] (N equal sectors joined into a ring on them), [`tooth`], [`teeth`] (the
//! ring of them), [`blank`] and `shaft` (their support), and [`body`], which joins them into the compliance of a whole gear. The inside: [`motion`] (of the
//! interface circle under loads), [`teeth_recovery`] and [`blank::BlankRecovery`]; under loads inside [`teeth_loads`] and [`blank::BlankLoads`]. A blank by
//! itself: [`annulus`]. The same with an extent along the axis: [`solid`]. Beside them: [`axes`] and `modes`.

pub mod annulus;
pub mod axes;
pub mod blank;
pub mod body;
pub mod cyclic;
pub mod harmonics;
mod modes;
pub mod motion;
pub(crate) mod shaft;
pub mod solid;
pub mod teeth;
pub mod teeth_loads;
pub mod teeth_recovery;
pub mod tooth;
