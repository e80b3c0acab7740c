//! Gears with an extent along their axis, on the harmonics of their circles.
//!
//! A solid gear has three components, and each function along the axis ([`crate::fem::axial`]), where the plane has one value; otherwise it is the same
//! structure. Read in this order: [`sector`] (one of equal sectors, and the classes of their ring), [`revolution`] (rims, webs and hubs without holes, order by
//! order), [`shaft`] (the part under a gear of one piece with it), [`joint`] (parts of unlike width), [`web`] (one with holes), [`tooth`] and [`gear`], which
//! joins them.

pub(crate) mod gear;
pub(crate) mod joint;
pub(crate) mod revolution;
pub(crate) mod sector;
pub(crate) mod shaft;
pub(crate) mod tooth;
pub(crate) mod web;
