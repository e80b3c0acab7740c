//! Gears on the harmonics of a circle: N equal sectors joined into a ring, and rings into a whole gear.
//!
//! Read in this order: [`harmonics`] (the unknowns of an interface circle), [`cyclic`] (N equal sectors joined into a ring on them), [`tooth`], [`teeth`] (the
//! ring of them), [`blank`] and `shaft` (their support), [`plain`] (both joined, without holes), [`motion`] (of the interface circle under loads, with holes), and
//! [`body`] (how the teeth of a whole gear move each other). The inside: [`teeth_recovery`] and [`blank::BlankRecovery`]; under loads inside [`teeth_loads`] and [`blank::BlankLoads`]. A blank by
//! itself: [`annulus`]. The same with an extent along the axis: [`solid`]. Beside them: [`axes`] and `modes`.

pub(crate) mod annulus;
pub(crate) mod axes;
pub(crate) mod blank;
pub(crate) mod body;
pub(crate) mod cyclic;
pub(crate) mod harmonics;
mod modes;
pub(crate) mod motion;
pub(crate) mod plain;
pub(crate) mod shaft;
pub(crate) mod solid;
pub(crate) mod teeth;
pub(crate) mod teeth_loads;
pub(crate) mod teeth_recovery;
pub(crate) mod tooth;
