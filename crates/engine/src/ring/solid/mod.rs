//! Gears with an extent along their axis, on the harmonics of their circles.
//!
//! What the plane has once, a solid gear has for three components and for each function along the axis ([`crate::fem::axial`]);
//! otherwise it is the same structure. Read in this order: [`sector`] (one of equal sectors, and the classes of their ring),
//! [`revolution`] (rims, webs and hubs without holes, order by order), [`shaft`] (what is under a gear of one piece with it), [`joint`] (where
//! parts of unlike width meet), [`web`] (one with holes), [`tooth`] and [`gear`], which joins them.

pub mod gear;
pub mod joint;
pub mod revolution;
pub mod sector;
pub mod shaft;
pub mod tooth;
pub mod web;
