//! One hole of a sector in a box of quadrilaterals, and how finely all around it is divided.

use std::f64::consts::PI;

use super::chart::{FIRST_LAYER, GROWTH, LARGEST, LAYERS, Ring};
use super::division::{Grading, reversed};
use crate::gear::{HolePattern, Vector};
use crate::root_finding::bisect;

// Measured over the patterns and thin ligaments of the tests of `sector`, whose sharpest corner is 31.9 degrees: constants of which
// nothing else is said move it by less than a tenth of a degree when halved or doubled, and are chosen for the levels' promise.

/// The size along a spoke at the hole, in half widths of the hole: a layer is as deep as its elements are long.
const SIZE_AT_HOLE: f64 = 0.25;
/// The least number of elements along each of the four arcs of a hole, at the standard level: 11 degrees each.
const ELEMENTS_PER_ARC: f64 = 8.0;
/// The least number of elements along the side of a hole next to a neck as wide as half of the hole, at the standard level. The length over which a neck bends
/// goes with the root of its width times that of the hole, and so does the size along it.
const ELEMENTS_PER_NECK: f64 = 7.0;
/// Where a hole's surroundings are narrower than this, in half widths of the hole, its box takes them in. Half of it would give
/// the sharpest corner three degrees for a twentieth more elements; twice as much takes one.
const NARROW: f64 = 0.7;
/// How far the box stays off the hole where its surroundings are narrow, in half widths of the hole. Half as much again takes the
/// sharpest corner to 25.0 degrees, half of it costs a twentieth more elements.
const CLOSE: f64 = 0.4;
/// The largest element on the outer side of the box, in those of the interface circle: the allowed loss of an uneven division. Half of it costs a quarter more
/// elements.
const LARGEST_ON_ARC: f64 = 1.2;
/// The gap, in half widths of the hole, at which the nodes of a side stand halfway between opposite the hole's and even. A third
/// less takes the sharpest corner to 26.4 degrees, more of it changes nothing.
const OPPOSITE: f64 = 0.15;

/// The hole of a sector and its box, in the chart.
#[derive(Debug)]
pub(super) struct HoleBox {
    interface_radius: f64,
    circle_radius: f64,
    radius: f64,
    pub(super) half_pitch: f64,
    /// The coordinate of the middle of the hole.
    middle: f64,
    /// The half widths of the hole along the radius and along the angle.
    half: (f64, f64),
    /// The box: from `inner` to `outer`, and `beta` to either side.
    pub(super) inner: f64,
    pub(super) outer: f64,
    pub(super) beta: f64,
    /// The angles φ around the hole of the spokes to the corners, counter-clockwise from the clockwise outer corner.
    pub(super) splits: [f64; 4],
}

/// The divisions of a holed sector.
#[derive(Debug)]
pub(super) struct HolePlan {
    /// The sides of the box along the angle at its outer and inner radius, and along the radius.
    pub(super) outer: Vec<f64>,
    pub(super) inner: Vec<f64>,
    pub(super) side: Vec<f64>,
    pub(super) outer_spoke: Vec<f64>,
    pub(super) inner_spoke: Vec<f64>,
    /// Distances beside the box: to the line below, to the line above, and to the side of the sector at π/N. The first two with the line that they end on.
    pub(super) below: Option<(Vec<f64>, f64)>,
    pub(super) above: Option<(Vec<f64>, f64)>,
    pub(super) beside: Option<Vec<f64>>,
}

impl HoleBox {
    /// The hole of `holes` in its box, which stays between the lines `floor` and `ceiling`.
    pub(super) fn new(ring: &Ring, holes: &HolePattern, (floor, ceiling): (f64, f64)) -> Self {
        let (r, r_h) = (holes.circle_radius, holes.radius);
        let half_pitch = PI / f64::from(holes.count);
        // In the chart the hole reaches from ln(R − r) to ln(R + r), and asin(r/R) to either side.
        let (low, high) = (
            (holes.inner_reach() / ring.interface_radius).ln(),
            (holes.outer_reach() / ring.interface_radius).ln(),
        );
        let half = ((high - low) / 2.0, (r_h / r).asin());
        // Each gap with the half width of the hole beside it: to the line below, to the line above, to the side.
        let gaps = [
            (low - floor, half.0),
            (ceiling - high, half.0),
            (half_pitch - half.1, half.1),
        ];
        let [to_floor, to_ceiling, to_side] = gaps.map(|(gap, half)| gap <= NARROW * half);
        // Next to a narrow gap the box stays close around the hole, so that its corners are not far out of square. A hole
        // that is small among the elements around it has a box of some of them.
        let close = CLOSE * half.1;
        let free = gaps
            .iter()
            .fold(f64::INFINITY, |least, (gap, _)| least.min(*gap));
        let wide = if to_floor || to_ceiling || to_side {
            close
        } else {
            close.max(0.5 * ELEMENTS_PER_ARC * LARGEST_ON_ARC * ring.arc_size - half.1)
        };
        let margin = |gap: f64| wide.min(0.5 * gap).min(0.5 * free.max(2.0 * close));
        let [below, above, beside] = gaps.map(|(gap, _)| margin(gap));
        let mut hole = Self {
            interface_radius: ring.interface_radius,
            circle_radius: r,
            radius: r_h,
            half_pitch,
            middle: f64::midpoint(low, high),
            half,
            // Exactly the boundary where the box reaches it.
            inner: if to_floor { floor } else { low - below },
            outer: if to_ceiling { ceiling } else { high + above },
            beta: if to_side { half_pitch } else { half.1 + beside },
            splits: [0.0; 4],
        };
        let (outer, inner) = (hole.towards(hole.outer), hole.towards(hole.inner));
        hole.splits = [-outer, outer, inner, 2.0 * PI - inner];
        hole
    }

    /// The point of the hole at the angle `phi` around its center.
    pub(super) fn point(&self, phi: f64) -> Vector {
        let Self {
            circle_radius: r,
            radius: r_h,
            ..
        } = *self;
        let (x, y) = (r + r_h * phi.cos(), r_h * phi.sin());
        Vector::new((x.hypot(y) / self.interface_radius).ln(), y.atan2(x))
    }

    /// The angle φ in (0, π) whose point is seen from the middle in the direction of the box's corner at `x` and +β.
    fn towards(&self, x: f64) -> f64 {
        let target = self.beta.atan2(x - self.middle);
        bisect(0.0, PI, |phi| {
            let p = self.point(phi);
            p.y.atan2(p.x - self.middle) < target
        })
    }

    /// The angles φ of the lattice points between spoke `i` and the next.
    pub(super) fn arc(&self, i: usize, points: usize) -> Vec<f64> {
        let from = self.splits[i];
        let to = if i == 3 {
            self.splits[0] + 2.0 * PI
        } else {
            self.splits[i + 1]
        };
        let last = (points - 1) as f64;
        (0..points)
            .map(|k| from + (to - from) * k as f64 / last)
            .collect()
    }

    /// The division of side `i` of the box, from `from` to `to` along it, into `count` elements.
    ///
    /// Where the hole comes close the nodes stand opposite to those of the hole, so that thin elements stay upright;
    /// otherwise they are evenly spread.
    fn opposite(&self, i: usize, count: usize, gap: f64) -> Vec<f64> {
        let phis = self.arc(i, 2 * count + 1);
        // Along the angle at the outer and inner sides, along the radius at the others.
        let along_angle = i.is_multiple_of(2);
        let along = |p: Vector| if along_angle { p.y } else { p.x };
        let (nearest, half) = if along_angle {
            (0.0, self.half.0)
        } else {
            (self.middle, self.half.1)
        };
        let (from, to) = match i {
            0 => (-self.beta, self.beta),
            1 => (self.outer, self.inner),
            2 => (self.beta, -self.beta),
            _ => (self.inner, self.outer),
        };
        let positions: Vec<f64> = phis
            .iter()
            .map(|phi| along(self.point(*phi)) - nearest)
            .collect();
        let share = 1.0 / (1.0 + gap / (OPPOSITE * half));
        let last = 2 * count;
        (0..=last)
            .map(|k| {
                let even = k as f64 / last as f64;
                let d = positions[k];
                let (end, target) = if (d < 0.0) == (from < to) {
                    (positions[0], from - nearest)
                } else {
                    (positions[last], to - nearest)
                };
                let stretched = d * (1.0 + (target / end - 1.0) * (d / end).powi(2));
                let close = (stretched + nearest - from) / (to - from);
                share * close + (1.0 - share) * even
            })
            .collect()
    }

    /// The divisions of the sector around the box, between the lines `floor` and `ceiling`.
    pub(super) fn plan(&self, ring: &Ring, (floor, ceiling): (f64, f64)) -> HolePlan {
        let Self {
            inner, outer, beta, ..
        } = *self;
        let size = ring.arc_size;
        let (low, high) = (self.middle - self.half.0, self.middle + self.half.0);
        let (below, above, beside) = (low - inner, outer - high, beta - self.half.1);

        // Where the division of the outer side is uneven, its largest element decides.
        let even = (2.0 * beta / size).max(ELEMENTS_PER_ARC);
        let largest = self
            .opposite(0, even.ceil() as usize, above)
            .windows(3)
            .step_by(2)
            .map(|f| 2.0 * beta * (f[2] - f[0]))
            .fold(0.0, f64::max);
        let outer_standard = even * (largest / (LARGEST_ON_ARC * size)).max(1.0);
        let outer_count = ring.level.count(outer_standard);
        let inner_count = ring
            .level
            .count((outer_standard / 3.0).max(ELEMENTS_PER_ARC));
        let neck = self.half.1 / (2.0 * (self.half_pitch - self.half.1));
        let side_count = ring.level.count(
            ((outer - inner) / (2.0 * size))
                .max(ELEMENTS_PER_ARC)
                .max(ELEMENTS_PER_NECK * neck.sqrt()),
        );

        // A line of the web needs no finer layers than the hole.
        let first_layer = if ceiling == 0.0 {
            FIRST_LAYER * size
        } else {
            LARGEST
        };
        // Spokes: finer towards the interface circle where the box reaches it.
        let to_interface = outer == 0.0;
        let spoke = |length: f64| Grading {
            length,
            first: if to_interface {
                (FIRST_LAYER * size).min(length)
            } else {
                length
            },
            last: (SIZE_AT_HOLE * self.half.1).min(length),
            growth: GROWTH,
            largest: length,
        };
        let away = |length: f64| Grading {
            first: length,
            ..spoke(length)
        };
        let thick = away(below).count().max(away(beside).count());
        let standard_layers = spoke(above).count().max(thick).max(LAYERS as f64);
        let layers = ring.level.count(standard_layers);
        let corner = Vector::new(outer, beta);
        let outer_length = (corner - self.point(self.splits[1])).norm();
        let inner_length = (Vector::new(inner, beta) - self.point(self.splits[2])).norm();
        // The size of the layer next to the side of the box, at the standard level.
        let layer = |margin: f64| away(margin).size(0.0) * away(margin).count() / standard_layers;

        let strip = |length: f64, first: f64, last: f64, largest: f64| {
            let sizes = Grading {
                length,
                first,
                last,
                growth: GROWTH,
                largest,
            };
            sizes.divide(sizes.count_at(2, ring.level))
        };
        HolePlan {
            outer: self.opposite(0, outer_count, above),
            inner: self.opposite(2, inner_count, below),
            side: reversed(&self.opposite(1, side_count, beside)),
            outer_spoke: reversed(&spoke(outer_length).divide(layers)),
            inner_spoke: reversed(&away(inner_length).divide(layers)),
            below: (inner > floor).then(|| {
                let strip = strip(inner - floor, layer(below), f64::INFINITY, LARGEST);
                (reversed(&strip), floor)
            }),
            above: (outer < ceiling).then(|| {
                let strip = strip(ceiling - outer, first_layer, layer(above), LARGEST);
                (reversed(&strip), ceiling)
            }),
            beside: (beta < self.half_pitch)
                .then(|| strip(self.half_pitch - beta, layer(beside), f64::INFINITY, size)),
        }
    }
}
