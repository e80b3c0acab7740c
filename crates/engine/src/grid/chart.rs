//! The ring of a blank in its chart (ln(r/R_w), θ), and the sizes of its elements there.
//!
//! In the chart a sector is a rectangle and a round hole is nearly round. It keeps angles, so that a grid with good angles there has them in
//! the plane.

use super::GridLevel;

// Sizes, chosen for the accuracy of the levels ([`GridLevel`]); none of them moves the sharpest corner of the tests' patterns by a tenth of a degree when
// halved or doubled.

/// The depth of the first layer under the interface circle, in element lengths along it: the highest orders fall within it.
pub(super) const FIRST_LAYER: f64 = 0.5;
/// The growth of sizes away from the interface circle and away from a hole. Half of it costs a quarter more elements.
pub(super) const GROWTH: f64 = 0.35;
/// The largest size along the radius, as a part of the radius: a plain ring has its closed form to 2e-9 with it.
pub(super) const LARGEST: f64 = 0.12;
/// The least number of layers between a hole and the next edge, at the standard level: enough for bending.
pub(super) const LAYERS: usize = 6;
/// Lines nearer than this, in the chart, are one: no thickness can be told between them.
const ON_LINE: f64 = 1e-6;

/// The ring in its chart: from `bore` < 0 to 0 at the interface circle.
#[derive(Debug)]
pub(super) struct Ring {
    pub(super) interface_radius: f64,
    pub(super) bore: f64,
    /// The element size on the interface circle.
    pub(super) arc_size: f64,
    /// As many of them stand under a tooth.
    pub(super) elements_per_tooth: f64,
    pub(super) level: GridLevel,
    /// The web: its ends in the chart, where they lie within the ring, and its thickness as a part of the face width.
    pub(super) web: Option<RingWeb>,
}

/// A web in the chart of its ring.
#[derive(Debug, Clone, Copy)]
pub(super) struct RingWeb {
    pub(super) ends: [f64; 2],
    pub(super) part: f64,
}

impl Ring {
    /// The lines of equal radius between which the thickness is one, from the bore to the interface circle.
    pub(super) fn lines(&self) -> Vec<f64> {
        let ends = self.web.iter().flat_map(|web| web.ends);
        let inner = ends.filter(|x| *x > self.bore + ON_LINE && *x < -ON_LINE);
        std::iter::once(self.bore)
            .chain(inner)
            .chain([0.0])
            .collect()
    }

    /// The thickness between the lines `low` and `high`, as a part of the face width.
    pub(super) fn thickness(&self, low: f64, high: f64) -> f64 {
        let middle = f64::midpoint(low, high);
        let in_web = |web: &RingWeb| middle > web.ends[0] && middle < web.ends[1];
        self.web.filter(in_web).map_or(1.0, |web| web.part)
    }
}
