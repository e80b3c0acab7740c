//! The blocks of a tooth sector: how its boundary is divided, and how they are filled.

use std::f64::consts::FRAC_PI_2;

use super::block::{Edge, GridBuilder};
use super::division::{Grading, reversed, uniform};
use super::root_curve::RootCurve;
use super::{Grid, GridLevel};
use crate::gear::{SpurGear, TipEdge, Vector, radial};

// Sizes are chosen for the accuracy of the levels ([`GridLevel`]): none of them moves the sharpest corner by a tenth of a degree when it is a third smaller or
// half as large again. The shape of the blocks is chosen for that corner, which is 30.8 degrees over all teeth of the tests' sweep.

/// The element size along the loaded flank at its tip corner, in modules, at the standard level: where contact cells of a few
/// micrometers end.
pub(super) const SIZE_AT_TIP: f64 = 0.005;
/// The growth of that size per distance from the tip corner: two neighbors differ by a seventh.
const GROWTH_FROM_TIP: f64 = 0.15;
/// The element size on both sides of where a broken edge leaves the flank, in modules: the edge bends less than a sharp corner.
const SIZE_AT_EDGE: f64 = 0.01;
/// The last part of the turn of a rounding that is left out, in radians: 30 degrees, the corner of the blocks there.
const TURN_LEFT_OUT: f64 = std::f64::consts::FRAC_PI_6;
/// The part of the half angle at the beginning of a chamfer that is left at the end of its grid.
const LEAST_LAND: f64 = 0.25;
/// The largest size along the flank, in modules: two to three elements to the width of a usual contact.
pub(super) const SIZE_ON_FLANK: f64 = 0.06;
/// The growth of the layers across the tooth at its tip, inward from the loaded flank.
const GROWTH_ACROSS: f64 = 0.36;
/// The largest size across the tooth at its tip, as a part of its thickness there: seven layers carry its bending.
const SIZE_ACROSS: f64 = 0.14;
/// The size along the fillet and the root land, in modules: half the radius of a usual fillet.
const SIZE_ON_FILLET: f64 = 0.18;
/// The size of the first layer below the fillet, in modules.
const SIZE_BELOW_FILLET: f64 = 0.1;
/// The growth of sizes away from the flank's lower end, and down from the fillet.
const GROWTH_AT_ROOT: f64 = 0.3;
/// The part of the fillet's turn that belongs to the tooth; the rest belongs to the rim. It leaves a third of the straight angle
/// to each of the three blocks that meet there. A third less takes the sharpest corner to 21.7 degrees.
const PART_OF_FILLET: f64 = 0.25;
/// How much faster than linear the division across the tooth goes over from that of the tip to that of the neck: near the tip
/// sizes along the flank grow as fast. From 0.4 to 0.9 the sharpest corner is the same.
const BLEND: f64 = 0.6;
/// Slope of the line from the fillet's dividing point to the interface circle, in right angles: it halves the straight angle beside the tooth there. The
/// sharpest corner is the same from 0.46 to 0.83, and 17.4 degrees upright.
const CORE_STEEPNESS: f64 = 0.69;
/// The part of the interface circle that the core takes at least where the circle is deep. A third less gives the sharpest corner
/// two degrees, half as much again takes three.
const LEAST_CORE: f64 = 0.36;
/// The part that it takes at most. Anything from 0.66 on does; a third less takes the sharpest corner to 18.0 degrees.
const LARGEST_CORE: f64 = 0.8;
/// The depth of a rim, in modules, at which the nodes on the interface circle stand halfway between below those of the fillet
/// and even. The sharpest corner is the same from 0.2 to 0.45.
const DEEP_RIM: f64 = 0.3;

/// The size of the first layer across the tooth under a flank that carries polynomials, in modules: the highest of them reach no deeper.
const FIRST_OF_PRISM: f64 = 0.2;

/// How large the elements of a tooth are at the standard level, in modules, and how many there are at least.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    /// Along the loaded flank at its tip corner, and at a broken edge.
    at_tip: f64,
    at_edge: f64,
    /// The largest along the flank.
    on_flank: f64,
    /// Of the first layer across the tooth at its tip.
    first_across: f64,
    /// The largest across the tooth there, as a part of its thickness.
    across: f64,
    /// How many such layers there are at least.
    least_across: f64,
    /// Of the first layer across the tooth at its neck; infinite where all are equal there.
    first_at_neck: f64,
    /// Along the fillet and the root land.
    on_fillet: f64,
    /// Of the first layer below the fillet.
    below_fillet: f64,
    /// The least number of elements along the flank, across the tooth, along the root, and below it.
    least: [usize; 4],
}

impl Sizes {
    /// Sizes of a section by itself, whose flank resolves all of its compliance but the logarithm of contacts.
    pub(super) const OF_SECTION: Self = Self {
        at_tip: SIZE_AT_TIP,
        at_edge: SIZE_AT_EDGE,
        on_flank: SIZE_ON_FLANK,
        first_across: SIZE_AT_TIP,
        across: SIZE_ACROSS,
        least_across: 16.0,
        first_at_neck: f64::INFINITY,
        on_fillet: SIZE_ON_FILLET,
        below_fillet: SIZE_BELOW_FILLET,
        least: [8, 8, 4, 6],
    };

    /// Sizes of a section that carries polynomials along the axis, from whose flank the half space is taken off: even ones do.
    pub(super) const OF_PRISM: Self = Self {
        at_tip: f64::INFINITY,
        at_edge: f64::INFINITY,
        on_flank: 0.17,
        first_across: FIRST_OF_PRISM,
        across: 0.25,
        least_across: 0.0,
        first_at_neck: FIRST_OF_PRISM,
        on_fillet: 0.5,
        below_fillet: 0.25,
        least: [8, 6, 4, 4],
    };

    /// Sizes of such a section whose fillets give the stress along them, to 1.5 %. Bending of the tooth needs layers across it more than the fillet needs small
    /// elements. At the neck they are equal: where they grew from the loaded flank on, the other fillet had 4 to 6 % beside its largest stress.
    pub(super) const OF_STRESSED_PRISM: Self = Self {
        first_at_neck: f64::INFINITY,
        on_fillet: SIZE_ON_FILLET,
        below_fillet: SIZE_BELOW_FILLET,
        least: [8, 8, 4, 4],
        ..Self::OF_PRISM
    };
}

/// The grid of tooth 0 and its part of the rim, from the interface circle outward, in the frame of its gear: the
/// centerline is the x axis, the loaded flank lies on the side of positive y.
///
/// The blocks, seen with the tip on the right: the tooth itself, from the tip circle down to a point on either fillet;
/// the core below it; and the rim under the fillet and the root land on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct ToothGrid {
    /// The elements.
    pub grid: Grid,
    /// The nodes of the loaded flank, corners and midsides, from the form point to the tip corner, and on a broken edge beyond the flank.
    pub flank_nodes: Vec<u32>,
    /// The roll length of each of these on the exact involute, or at their radius beyond it.
    pub flank_roll_lengths: Vec<f64>,
    /// The nodes of the fillet on the loaded side and of the root land after it, corners and midsides, from the form point to
    /// the side at π/Z: a free edge, in tension while the flank is loaded.
    pub fillet_nodes: Vec<u32>,
    /// Nodes on the unloaded side: the mirror images, in the same order.
    pub back_fillet_nodes: Vec<u32>,
    /// The nodes on the interface circle, corners and midsides, from −π/Z to π/Z.
    pub arc_nodes: Vec<u32>,
    /// The polar angle of each of these.
    pub arc_angles: Vec<f64>,
    /// The nodes on the sides at −π/Z and at π/Z, from the interface circle, which is left out, to the root circle; equal
    /// radii on both sides.
    pub side_nodes: (Vec<u32>, Vec<u32>),
}

/// The boundary of the sector as points on the doubled lattice, all of the half with the loaded flank.
pub(super) struct Plan<'a> {
    gear: &'a SpurGear,
    interface_radius: f64,
    /// Places from the fillet's dividing point up to the form point and on to the tip corner, and their distance from the first.
    side: Vec<(Vector, f64)>,
    /// The number of leading entries of `side` below the form point.
    below_form: usize,
    roll_lengths: Vec<f64>,
    /// The radius and the half angle at which the side ends: those of the tip land, or somewhat below it.
    tip: (f64, f64),
    /// The fractions across the tooth, from the unloaded flank, at its neck and at the tip.
    across_neck: Vec<f64>,
    across_tip: Vec<f64>,
    /// From the dividing point to the side of the sector.
    root: Vec<Vector>,
    /// The polar angles on the interface circle under the core, from the centerline, and under the fillet.
    core_angle: f64,
    fillet_angles: Vec<f64>,
    /// The fractions of the depth, from the interface circle, at the dividing point and at the side of the sector.
    depth_at_core: Vec<f64>,
    depth_at_side: Vec<f64>,
}

impl<'a> Plan<'a> {
    pub(super) fn new(
        gear: &'a SpurGear,
        interface_radius: f64,
        sizes: &Sizes,
        level: GridLevel,
    ) -> Self {
        let of = sizes;
        let m = gear.data().rack.module;
        let curve = RootCurve::new(gear);
        let (gamma_0, gamma_1) = curve.fillet.ends();
        let division = curve.length_at(gamma_0 + PART_OF_FILLET * (gamma_1 - gamma_0));

        // The flank, by the distance from the tip corner, or from the broken edge.
        let flank = gear.flank();
        let edge = edge(gear, of, level);
        let (a_form, a_tip) = (
            flank.arc_length(gear.form_roll_length()),
            flank.arc_length(gear.tip_form_roll_length()),
        );
        let length = a_tip - a_form;
        let finest = if edge.is_empty() {
            of.at_tip
        } else {
            of.at_edge
        };
        let sizes = Grading {
            length,
            first: finest * m,
            last: f64::INFINITY,
            growth: GROWTH_FROM_TIP,
            largest: of.on_flank * m,
        };
        let [on_flank, across_least, ..] = of.least;
        let fractions = reversed(&sizes.divide(sizes.count_at(on_flank, level)));
        let last = fractions.len() - 1;
        let roll_lengths: Vec<f64> = (0..=last)
            .map(|i| match i {
                0 => gear.form_roll_length(),
                i if i == last => gear.tip_form_roll_length(),
                i => flank.roll_length_at_arc(a_form + length * fractions[i]),
            })
            .collect();

        // The tooth's part of the fillet, whose sizes go on from the flank's.
        let below = Grading {
            length: division,
            first: sizes.size(length),
            last: f64::INFINITY,
            growth: GROWTH_AT_ROOT,
            largest: of.on_fillet * m,
        };
        let below_fractions = reversed(&below.divide(below.count_at(2, level)));
        let below_form = below_fractions.len() - 1;
        let fillet = below_fractions.iter().take(below_form).map(|f| {
            let s = division * f;
            (curve.point(division - s), s)
        });
        let side = fillet
            .chain(
                roll_lengths
                    .iter()
                    .zip(&fractions)
                    .map(|(s, f)| (flank.point(*s), division + length * f)),
            )
            .chain(
                edge.iter()
                    .map(|(point, beyond)| (*point, division + length + beyond)),
            )
            .collect::<Vec<_>>();
        let (tip, thickness) = match edge.last() {
            None => {
                let r_a = gear.tip_radius();
                ((r_a, flank.half_angle(r_a)), gear.tip_thickness())
            }
            Some((end, _)) => {
                let (radius, half_angle) = (end.norm(), end.y.atan2(end.x));
                ((radius, half_angle), 2.0 * radius * half_angle)
            }
        };
        let beyond = edge
            .iter()
            .map(|(point, _)| flank.roll_length(point.norm()));
        let roll_lengths: Vec<f64> = roll_lengths.into_iter().chain(beyond).collect();

        // Across the tip, from the loaded flank inward.
        let across = Grading {
            length: thickness,
            last: f64::INFINITY,
            first: (of.first_across * m).min(thickness / of.least_across),
            growth: GROWTH_ACROSS,
            largest: of.across * thickness,
        };
        let across_count = across.count_at(across_least, level);
        let across_tip = reversed(&across.divide(across_count));
        let across_neck = if of.first_at_neck.is_finite() {
            let neck = Grading {
                length: 2.0 * side[0].0.y,
                first: of.first_at_neck * m,
                largest: f64::INFINITY,
                ..across
            };
            reversed(&neck.divide(across_count))
        } else {
            uniform(across_count)
        };

        let (root, depth) = Self::rim(gear, &curve, division, interface_radius, (of, level));
        let corner = side[0].0;
        let (core_angle, fillet_angles) = interface_angles(gear, corner, &root, interface_radius);
        let [depth_at_core, depth_at_side] = {
            let foot = interface_radius * radial(core_angle);
            let lengths = [
                (corner - foot).norm(),
                gear.root_radius() - interface_radius,
            ];
            lengths.map(|length| {
                let layers = Grading {
                    length,
                    first: (of.below_fillet * m).min(length),
                    last: f64::INFINITY,
                    growth: GROWTH_AT_ROOT,
                    largest: length,
                };
                reversed(&layers.divide(depth))
            })
        };
        Self {
            gear,
            interface_radius,
            side,
            below_form,
            roll_lengths,
            tip,
            across_neck,
            across_tip,
            root,
            core_angle,
            fillet_angles,
            depth_at_core,
            depth_at_side,
        }
    }

    /// The fillet below the dividing point with the root land, and the number of layers under it.
    fn rim(
        gear: &SpurGear,
        curve: &RootCurve,
        division: f64,
        interface_radius: f64,
        (of, level): (&Sizes, GridLevel),
    ) -> (Vec<Vector>, usize) {
        let m = gear.data().rack.module;
        let length = curve.length() - division;
        let count = level.count((length / (of.on_fillet * m)).max(of.least[2] as f64));
        let root = uniform(count)
            .into_iter()
            .map(|f| curve.point(division + length * f))
            .collect::<Vec<_>>();
        let corner = curve.point(division).norm();
        let depth = f64::midpoint(corner, gear.root_radius()) - interface_radius;
        let layers = Grading {
            length: depth,
            first: of.below_fillet * m,
            last: f64::INFINITY,
            growth: GROWTH_AT_ROOT,
            largest: depth,
        };
        (root, layers.count_at(of.least[3], level))
    }

    pub(super) fn build(&self) -> ToothGrid {
        let Self {
            gear,
            interface_radius: r_w,
            ..
        } = *self;
        let mut builder = GridBuilder::default();
        let beta = gear.pitch_angle() / 2.0;
        let r_f = gear.root_radius();

        // The two flanks, loaded and unloaded: mirror images.
        let loaded: Vec<Vector> = self.side.iter().map(|(p, _)| *p).collect();
        let last = loaded.len() - 1;
        let [upper, lower] = [1.0, -1.0].map(|sign| {
            let points: Vec<_> = loaded
                .iter()
                .map(|p| Vector::new(p.x, sign * p.y))
                .collect();
            let from = builder.node(points[0]);
            let to = builder.node(points[last]);
            builder.curve(from, to, &points)
        });
        let (r_a, psi_a) = self.tip;
        let tip: Vec<_> = self
            .across_tip
            .iter()
            .map(|w| r_a * radial(psi_a * (2.0 * w - 1.0)))
            .collect();
        let tip_edge = builder.curve(lower[last], upper[last], &tip);
        let across_neck = &self.across_neck;
        let neck = builder.straight(lower[0], upper[0], across_neck);
        self.fill_tooth(
            &mut builder,
            &lower,
            &tip_edge,
            &upper,
            &neck,
            &tip,
            across_neck,
        );

        // The interface circle.
        let arc = |angles: Vec<f64>| -> Vec<(Vector, f64)> {
            angles.into_iter().map(|a| (r_w * radial(a), a)).collect()
        };
        let core = arc(across_neck
            .iter()
            .map(|w| self.core_angle * (2.0 * w - 1.0))
            .collect());
        let right = arc(self.fillet_angles.iter().rev().map(|a| -a).collect());
        let left = arc(self.fillet_angles.clone());
        let points = |arc: &[(Vector, f64)]| arc.iter().map(|(p, _)| *p).collect::<Vec<_>>();
        let [n_0, n_1, n_2, n_3] = [-beta, -self.core_angle, self.core_angle, beta]
            .map(|angle| builder.node(r_w * radial(angle)));
        let right_arc = builder.curve(n_0, n_1, &points(&right));
        let core_arc = builder.curve(n_1, n_2, &points(&core));
        let left_arc = builder.curve(n_2, n_3, &points(&left));

        // The rim.
        let radii: Vec<f64> = self
            .depth_at_side
            .iter()
            .map(|f| r_w + (r_f - r_w) * f)
            .collect();
        let [right_root, left_root] = [-beta, beta].map(|angle| builder.node(r_f * radial(angle)));
        let side = |builder: &mut GridBuilder, from, to, angle| {
            let points: Vec<_> = radii.iter().map(|r| *r * radial(angle)).collect();
            builder.curve(from, to, &points)
        };
        let right_side = side(&mut builder, n_0, right_root, -beta);
        let left_side = side(&mut builder, n_3, left_root, beta);
        let right_core = builder.straight(n_1, lower[0], &self.depth_at_core);
        let left_core = builder.straight(n_2, upper[0], &self.depth_at_core);
        let left_curve = builder.curve(upper[0], left_root, &self.root);
        let mirrored: Vec<_> = self
            .root
            .iter()
            .rev()
            .map(|p| Vector::new(p.x, -p.y))
            .collect();
        let right_curve = builder.curve(right_root, lower[0], &mirrored);
        builder.block(&right_core, &neck, &left_core, &core_arc);
        builder.block(&left_core, &left_curve, &left_side, &left_arc);
        builder.block(&right_side, &right_curve, &right_core, &right_arc);

        let join = |parts: [&Edge; 3]| {
            let [a, b, c] = parts;
            [&a[..], &b[1..], &c[1..]].concat()
        };
        let angles = [&right[..], &core[1..], &left[1..]].concat();
        ToothGrid {
            flank_nodes: upper[self.below_form..].to_vec(),
            flank_roll_lengths: self.roll_lengths.clone(),
            fillet_nodes: upper[..=self.below_form]
                .iter()
                .rev()
                .chain(&left_curve[1..])
                .copied()
                .collect(),
            back_fillet_nodes: lower[..=self.below_form]
                .iter()
                .rev()
                .chain(right_curve.iter().rev().skip(1))
                .copied()
                .collect(),
            arc_nodes: join([&right_arc, &core_arc, &left_arc]),
            arc_angles: angles.into_iter().map(|(_, angle)| angle).collect(),
            side_nodes: (right_side[1..].to_vec(), left_side[1..].to_vec()),
            grid: builder.finish(|p| p),
        }
    }

    /// The block between the flanks: across the tooth the division goes over from the graded one at the tip to equal
    /// parts at the neck, and the tip circle's bulge fades.
    #[expect(
        clippy::too_many_arguments,
        reason = "four edges and the divisions of two of them"
    )]
    fn fill_tooth(
        &self,
        builder: &mut GridBuilder,
        lower: &[u32],
        tip_edge: &[u32],
        upper: &[u32],
        neck: &[u32],
        tip: &[Vector],
        across_neck: &[f64],
    ) {
        let whole = self.side.last().map_or(1.0, |(_, length)| *length);
        let tip_x = tip[0].x;
        builder.fill(lower, tip_edge, upper, neck, |i, j| {
            let (point, length) = self.side[i];
            let from_tip = 1.0 - length / whole;
            // Somewhat faster than linear near the tip, where the sizes along the flank grow fast.
            let blend = from_tip * ((1.0 + BLEND) - BLEND * from_tip);
            let w = (1.0 - blend) * (tip[j].y / tip[tip.len() - 1].y + 1.0) / 2.0
                + blend * across_neck[j];
            let bulge = (tip[j].x - tip_x) * length / whole;
            Vector::new(point.x + bulge, point.y * (2.0 * w - 1.0))
        });
    }
}

/// The nodes on the broken edge of `gear` beyond its flank, each with its distance along the edge; none on a sharp one.
///
/// A rounding ends in the tip circle without a corner, which no block of quadrilaterals can have: it is left [`TURN_LEFT_OUT`] before
/// that, where the mate cannot press, and the tooth ends in a circle there. So does a chamfer where hardly any land is left.
fn edge(gear: &SpurGear, of: &Sizes, level: GridLevel) -> Vec<(Vector, f64)> {
    if gear.edge_point(0.0).is_none() {
        return Vec::new();
    }
    let at = |t: f64| gear.edge_point(t).unwrap_or_default();
    let half_angle = |t: f64| at(t).y.atan2(at(t).x);
    let (whole, top) = match gear.data().tip_edge {
        TipEdge::Sharp => return Vec::new(),
        TipEdge::Rounded(radius) => {
            // Half of the chord is ρ sin of half of the turn.
            let turn = 2.0 * ((at(0.0) - at(1.0)).norm() / (2.0 * radius)).asin();
            (radius * turn, (TURN_LEFT_OUT / turn).min(0.5))
        }
        TipEdge::Chamfered(_) => {
            let thin = LEAST_LAND * half_angle(1.0);
            let parts = (0..=10).map(|i| 0.05 * f64::from(i));
            let top = parts.clone().find(|t| half_angle(*t) >= thin);
            ((at(0.0) - at(1.0)).norm(), top.unwrap_or(0.5))
        }
    };
    let length = (1.0 - top) * whole;
    let m = gear.data().rack.module;
    let sizes = Grading {
        length,
        first: of.at_edge * m,
        last: f64::INFINITY,
        growth: GROWTH_FROM_TIP,
        largest: of.on_flank * m,
    };
    let fractions = sizes.divide(sizes.count_at(2, level));
    let nodes = fractions.into_iter().skip(1);
    nodes
        .map(|f| (at(1.0 - f * (1.0 - top)), f * length))
        .collect()
}

/// The half angle of the core on the interface circle, and the angles under the fillet from there to π/Z.
fn interface_angles(
    gear: &SpurGear,
    corner: Vector,
    root: &[Vector],
    interface_radius: f64,
) -> (f64, Vec<f64>) {
    let beta = gear.pitch_angle() / 2.0;
    // A line from the dividing point that halves the straight angle beside the tooth would reach the interface circle at this angle; the bounds leave room for
    // core and rim where the circle is deep.
    let drop = corner.x - interface_radius;
    let steep = (FRAC_PI_2 * CORE_STEEPNESS).tan();
    let aim = (corner.y - drop / steep) / interface_radius;
    let core_angle = aim.clamp(LEAST_CORE * beta, LARGEST_CORE * beta);

    // Close under the root land the nodes stand below those of the fillet, so that thin layers stay upright; under a deep
    // rim they are evenly spread.
    let depth = (gear.root_radius() - interface_radius) / gear.data().rack.module;
    let share = 1.0 / (1.0 + (depth / DEEP_RIM).powi(2));
    let last = root.len() - 1;
    let reach = |p: &Vector| beta - p.y.atan2(p.x);
    let (whole, target) = (reach(&corner), beta - core_angle);
    let angles = root
        .iter()
        .enumerate()
        .map(|(i, point)| {
            let even = target * (1.0 - i as f64 / last as f64);
            let d = reach(point);
            // Equal to d near the side of the sector, and to the target at the core.
            let below = d * (1.0 + (target / whole - 1.0) * d / whole);
            beta - (share * below + (1.0 - share) * even)
        })
        .collect();
    (core_angle, angles)
}
