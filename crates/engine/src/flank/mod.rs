//! Compliance of the loaded flank of one tooth: a smooth part from the finite elements, and in closed form the parts that no grid resolves.
//!
//! - [`table`]: the smooth part of a transverse section, interpolated between the nodes of the flank,
//! - [`half_plane`]: the logarithm under cells, and Hertz's contact,
//! - `corner`: the wedge at a sharp tip,
//! - `polynomials`: the smooth part along a face, as polynomials of roll length,
//! - `half_space`: the compliance between lines along a face,
//! - `images`: what a half space becomes between both ends of a face,
//! - `ends`: the difference of a flank from that at its tip, and of a narrow face.

pub(crate) mod corner;
pub(crate) mod ends;
pub(crate) mod half_plane;
pub(crate) mod half_space;
pub(crate) mod images;
pub(crate) mod polynomials;
pub(crate) mod table;
