//! The grid of one tooth and the rim under it.

use std::f64::consts::FRAC_PI_2;

use super::block::{Edge, GridBuilder};
use super::division::{Grading, reversed, uniform};
use super::{Grid, GridError, GridLevel, checked};
use crate::gear::rack::Trochoid;
use crate::gear::{SpurGear, Vector, radial};

// Sizes are chosen for what the levels promise ([`GridLevel`]): none of them moves the sharpest corner by a tenth of a degree when
// it is a third smaller or half as large again. The shape of the blocks is chosen for that corner, which is 30.8 degrees over all
// teeth of the sweep below.

/// The element size along the loaded flank at its tip corner, in modules, at the standard level: where contact cells of a few
/// micrometers end.
const SIZE_AT_TIP: f64 = 0.005;
/// The growth of that size per distance from the tip corner: two neighbors differ by a seventh.
const GROWTH_FROM_TIP: f64 = 0.15;
/// The largest size along the flank, in modules: two to three elements to the width of a usual contact.
const SIZE_ON_FLANK: f64 = 0.06;
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
/// How steep the line from the fillet's dividing point to the interface circle stands, in right angles: it halves what the tooth
/// leaves of the straight angle there. The sharpest corner is the same from 0.46 to 0.83, and 17.4 degrees upright.
const CORE_STEEPNESS: f64 = 0.69;
/// The part of the interface circle that the core takes at least where the circle is deep. A third less gives the sharpest corner
/// two degrees, half as much again takes three.
const LEAST_CORE: f64 = 0.36;
/// The part that it takes at most. Anything from 0.66 on does; a third less takes the sharpest corner to 18.0 degrees.
const LARGEST_CORE: f64 = 0.8;
/// The depth of a rim, in modules, at which the nodes on the interface circle stand halfway between below those of the fillet
/// and even. The sharpest corner is the same from 0.2 to 0.45.
const DEEP_RIM: f64 = 0.3;

/// The grid of tooth 0 and its part of the rim, from the interface circle outward, in the frame of its gear: the
/// centerline is the x axis, the loaded flank lies on the side of positive y.
///
/// The blocks, seen with the tip on the right: the tooth itself, from the tip circle down to a point on either fillet;
/// the core below it; and the rim under the fillet and the root land on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct ToothGrid {
    /// The elements.
    pub grid: Grid,
    /// The nodes of the loaded flank, corners and midsides, from the form point to the tip corner.
    pub flank_nodes: Vec<u32>,
    /// The roll length of each of these, on the exact involute.
    pub flank_roll_lengths: Vec<f64>,
    /// The nodes of the fillet on the loaded side and of the root land after it, corners and midsides, from the form point to
    /// the side at π/Z: a free edge, in tension while the flank is loaded.
    pub fillet_nodes: Vec<u32>,
    /// The nodes on the interface circle, corners and midsides, from −π/Z to π/Z.
    pub arc_nodes: Vec<u32>,
    /// The polar angle of each of these.
    pub arc_angles: Vec<f64>,
    /// The nodes on the sides at −π/Z and at π/Z, from the interface circle, which is left out, to the root circle; equal
    /// radii on both sides.
    pub side_nodes: (Vec<u32>, Vec<u32>),
}

impl ToothGrid {
    /// Divides tooth 0 of `gear` and the rim under it, out from `interface_radius`.
    ///
    /// # Errors
    ///
    /// [`GridError`] if the interface circle is not below the root circle, or if the tooth is so shaped that an element
    /// is distorted.
    pub fn new(
        gear: &SpurGear,
        interface_radius: f64,
        level: GridLevel,
    ) -> Result<Self, GridError> {
        let root_radius = gear.root_radius();
        if !(interface_radius > 0.0 && interface_radius < root_radius) {
            return Err(GridError::InterfaceOutsideRim {
                interface_radius,
                root_radius,
            });
        }
        let plan = Plan::new(gear, interface_radius, level);
        let tooth = plan.build();
        Ok(Self {
            grid: checked(tooth.grid)?,
            ..tooth
        })
    }
}

/// The boundary of one half of the sector from the form point down: fillet, then root land, by length.
struct RootCurve {
    fillet: Trochoid,
    /// Values of γ at equal steps, and the length of the fillet up to each.
    table: Vec<(f64, f64)>,
    root_radius: f64,
    land_angle: f64,
    half_pitch: f64,
}

impl RootCurve {
    fn new(gear: &SpurGear) -> Self {
        const STEPS: usize = 400;
        let fillet = gear.fillet();
        let (gamma_0, gamma_1) = fillet.ends();
        let mut table = vec![(gamma_0, 0.0)];
        let (mut last, mut length) = (fillet.point(gamma_0), 0.0);
        for i in 1..=STEPS {
            let gamma = gamma_0 + (gamma_1 - gamma_0) * i as f64 / STEPS as f64;
            let point = fillet.point(gamma);
            length += (point - last).norm();
            table.push((gamma, length));
            last = point;
        }
        let half_pitch = gear.pitch_angle() / 2.0;
        Self {
            fillet,
            table,
            root_radius: gear.root_radius(),
            // Where the rack's tip land vanishes, rounding must not let the fillet pass the side.
            land_angle: last.y.atan2(last.x).min(half_pitch),
            half_pitch,
        }
    }

    fn fillet_length(&self) -> f64 {
        self.table.last().map_or(0.0, |(_, length)| *length)
    }

    fn length(&self) -> f64 {
        self.fillet_length() + self.root_radius * (self.half_pitch - self.land_angle)
    }

    /// The length of the fillet down to γ = `gamma`.
    fn length_at(&self, gamma: f64) -> f64 {
        let i = self
            .table
            .partition_point(|(g, _)| *g < gamma)
            .clamp(1, self.table.len() - 1);
        let ((g_0, s_0), (g_1, s_1)) = (self.table[i - 1], self.table[i]);
        s_0 + (s_1 - s_0) * (gamma - g_0) / (g_1 - g_0)
    }

    /// The point at `length` from the form point, on the true curve.
    fn point(&self, length: f64) -> Vector {
        let past = length - self.fillet_length();
        if past >= 0.0 {
            let angle = (self.land_angle + past / self.root_radius).min(self.half_pitch);
            return self.root_radius * radial(angle);
        }
        let i = self
            .table
            .partition_point(|(_, s)| *s < length)
            .clamp(1, self.table.len() - 1);
        let ((g_0, s_0), (g_1, s_1)) = (self.table[i - 1], self.table[i]);
        self.fillet
            .point(g_0 + (g_1 - g_0) * (length - s_0) / (s_1 - s_0))
    }
}

/// The boundary of the sector as points on the doubled lattice, all of the half with the loaded flank.
struct Plan<'a> {
    gear: &'a SpurGear,
    interface_radius: f64,
    /// From the fillet's dividing point up to the form point and on to the tip corner, and the length from the first.
    side: Vec<(Vector, f64)>,
    /// The number of leading entries of `side` below the form point.
    below_form: usize,
    roll_lengths: Vec<f64>,
    /// The fractions across the tooth, from the unloaded flank, at the tip.
    across_tip: Vec<f64>,
    across_count: usize,
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
    fn new(gear: &'a SpurGear, interface_radius: f64, level: GridLevel) -> Self {
        let m = gear.data().rack.module;
        let curve = RootCurve::new(gear);
        let (gamma_0, gamma_1) = curve.fillet.ends();
        let division = curve.length_at(gamma_0 + PART_OF_FILLET * (gamma_1 - gamma_0));

        // The flank, by the distance from the tip corner.
        let flank = gear.flank();
        let (a_form, a_tip) = (
            flank.arc_length(gear.form_roll_length()),
            flank.arc_length(gear.tip_roll_length()),
        );
        let length = a_tip - a_form;
        let sizes = Grading {
            length,
            first: SIZE_AT_TIP * m,
            last: f64::INFINITY,
            growth: GROWTH_FROM_TIP,
            largest: SIZE_ON_FLANK * m,
        };
        let fractions = reversed(&sizes.divide(sizes.count_at(8, level)));
        let last = fractions.len() - 1;
        let roll_lengths: Vec<f64> = (0..=last)
            .map(|i| match i {
                0 => gear.form_roll_length(),
                i if i == last => gear.tip_roll_length(),
                i => flank.roll_length_at_arc(a_form + length * fractions[i]),
            })
            .collect();

        // The tooth's part of the fillet, whose sizes go on from the flank's.
        let below = Grading {
            length: division,
            first: sizes.size(length),
            last: f64::INFINITY,
            growth: GROWTH_AT_ROOT,
            largest: SIZE_ON_FILLET * m,
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
            .collect::<Vec<_>>();

        // Across the tip, from the loaded flank inward.
        let thickness = gear.tip_thickness();
        let across = Grading {
            length: thickness,
            last: f64::INFINITY,
            first: (SIZE_AT_TIP * m).min(thickness / 16.0),
            growth: GROWTH_ACROSS,
            largest: SIZE_ACROSS * thickness,
        };
        let across_count = across.count_at(8, level);
        let across_tip = reversed(&across.divide(across_count));

        let (root, depth) = Self::rim(gear, &curve, division, interface_radius, level);
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
                    first: (SIZE_BELOW_FILLET * m).min(length),
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
            across_tip,
            across_count,
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
        level: GridLevel,
    ) -> (Vec<Vector>, usize) {
        let m = gear.data().rack.module;
        let length = curve.length() - division;
        let count = level.count((length / (SIZE_ON_FILLET * m)).max(4.0));
        let root = uniform(count)
            .into_iter()
            .map(|f| curve.point(division + length * f))
            .collect::<Vec<_>>();
        let corner = curve.point(division).norm();
        let depth = f64::midpoint(corner, gear.root_radius()) - interface_radius;
        let layers = Grading {
            length: depth,
            first: SIZE_BELOW_FILLET * m,
            last: f64::INFINITY,
            growth: GROWTH_AT_ROOT,
            largest: depth,
        };
        (root, layers.count_at(6, level))
    }

    fn build(&self) -> ToothGrid {
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
        let psi_a = gear.flank().half_angle(gear.tip_radius());
        let tip: Vec<_> = self
            .across_tip
            .iter()
            .map(|w| gear.tip_radius() * radial(psi_a * (2.0 * w - 1.0)))
            .collect();
        let tip_edge = builder.curve(lower[last], upper[last], &tip);
        let across_root = uniform(self.across_count);
        let neck = builder.straight(lower[0], upper[0], &across_root);
        self.fill_tooth(
            &mut builder,
            &lower,
            &tip_edge,
            &upper,
            &neck,
            &tip,
            &across_root,
        );

        // The interface circle.
        let arc = |angles: Vec<f64>| -> Vec<(Vector, f64)> {
            angles.into_iter().map(|a| (r_w * radial(a), a)).collect()
        };
        let core = arc(across_root
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
        across_root: &[f64],
    ) {
        let whole = self.side.last().map_or(1.0, |(_, length)| *length);
        let tip_x = tip[0].x;
        builder.fill(lower, tip_edge, upper, neck, |i, j| {
            let (point, length) = self.side[i];
            let from_tip = 1.0 - length / whole;
            // Somewhat faster than linear near the tip, where the sizes along the flank grow fast.
            let blend = from_tip * ((1.0 + BLEND) - BLEND * from_tip);
            let w = (1.0 - blend) * (tip[j].y / tip[tip.len() - 1].y + 1.0) / 2.0
                + blend * across_root[j];
            let bulge = (tip[j].x - tip_x) * length / whole;
            Vector::new(point.x + bulge, point.y * (2.0 * w - 1.0))
        });
    }
}

/// The half angle of the core on the interface circle, and the angles under the fillet from there to π/Z.
fn interface_angles(
    gear: &SpurGear,
    corner: Vector,
    root: &[Vector],
    interface_radius: f64,
) -> (f64, Vec<f64>) {
    let beta = gear.pitch_angle() / 2.0;
    // A line from the dividing point that halves what the tooth leaves of the straight angle there would reach the
    // interface circle at this angle; the bounds leave room for core and rim where the circle is deep.
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

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::gear::spur::tests::paper_gear;

    const LEVELS: [GridLevel; 3] = [GridLevel::Coarse, GridLevel::Standard, GridLevel::Fine];

    fn gear(tooth_count: u32, profile_shift: f64) -> Option<SpurGear> {
        let mut data = paper_gear(tooth_count);
        data.profile_shift = profile_shift;
        data.blank.bore_radius = 1e-3;
        SpurGear::new(data).ok()
    }

    /// Teeth of all counts, shifts and racks that can be made, with interface circles from close to deep, in modules.
    fn sweep() -> Vec<(SpurGear, f64)> {
        let mut gears = Vec::new();
        for z in [17, 18, 20, 25, 29, 50, 85, 150, 300] {
            for x in [-0.3, 0.0, 0.5, 0.9, 1.2] {
                gears.extend(gear(z, x));
            }
        }
        // Unusual racks: tall, short, pointed, sharp, and with the largest rounding.
        for z in [25, 50, 120] {
            for (alpha, addendum, dedendum, tip_radius) in [
                (20.0, 2.6e-3, 3.2e-3, 0.5e-3),
                (20.0, 1.2e-3, 1.6e-3, 0.4e-3),
                (20.0, 2e-3, 2.5e-3, 0.0),
                (20.0, 2e-3, 2.5e-3, 0.94e-3),
                (20.0, 2.75e-3, 2.5e-3, 0.76e-3),
                (14.5, 2e-3, 2.314e-3, 0.4e-3),
                (25.0, 2e-3, 2.5e-3, 0.5e-3),
                (28.0, 1.6e-3, 2.0e-3, 0.6e-3),
            ] {
                let mut data = paper_gear(z);
                data.blank.bore_radius = 1e-3;
                data.rack.pressure_angle = f64::to_radians(alpha);
                (data.rack.addendum, data.rack.dedendum, data.rack.tip_radius) =
                    (addendum, dedendum, tip_radius);
                gears.extend(SpurGear::new(data.clone()).ok());
                data.rack.tip_radius = data.rack.largest_tip_radius();
                gears.extend(SpurGear::new(data).ok());
            }
        }
        gears
            .into_iter()
            .flat_map(|gear| [0.1, 0.25, 0.5, 1.0, 1.5, 3.0].map(|depth| (gear.clone(), depth)))
            .collect()
    }

    fn divided(gear: &SpurGear, depth: f64, level: GridLevel) -> ToothGrid {
        let r_w = gear.root_radius() - depth * gear.data().rack.module;
        ToothGrid::new(gear, r_w, level).unwrap_or_else(|error| {
            panic!(
                "{:?} with {} teeth, {depth} modules deep at {level:?}: {error}",
                gear.data().rack,
                gear.tooth_count()
            )
        })
    }

    #[test]
    fn teeth_of_all_shapes_keep_angles_above_twenty_five_degrees() {
        let cases = sweep();
        assert!(cases.len() > 300);
        for (gear, depth) in cases {
            for level in LEVELS {
                let tooth = divided(&gear, depth, level);
                let quality = tooth.grid.quality();
                let (low, high) = (
                    quality.smallest_angle.to_degrees(),
                    quality.largest_angle.to_degrees(),
                );
                assert!(low > 25.0 && high < 155.0);
            }
        }
    }

    #[test]
    fn a_tooth_sector_has_the_area_of_the_profile() {
        for (gear, depth) in sweep() {
            let r_w = gear.root_radius() - depth * gear.data().rack.module;
            let ring = gear.mass() / (gear.data().material.density * gear.face_width());
            let bore = gear.bore_radius();
            let area = (ring + PI * (bore * bore - r_w * r_w)) / f64::from(gear.tooth_count());
            let grid = divided(&gear, depth, GridLevel::Standard).grid;
            // Parabolas through the fillet, and where its curvature jumps to that of the root circle.
            assert!(
                (grid.area() / area - 1.0).abs() < 2e-4,
                "{} of {area}",
                grid.area()
            );
        }
    }

    #[test]
    fn each_level_halves_every_element() {
        for (gear, depth) in sweep().into_iter().step_by(5) {
            let [coarse, standard, fine] = LEVELS.map(|level| divided(&gear, depth, level));
            let count = |tooth: &ToothGrid| tooth.grid.elements.len();
            assert_eq!(
                (4 * count(&coarse), 4 * count(&standard)),
                (count(&standard), count(&fine))
            );
            for (i, s) in coarse.flank_roll_lengths.iter().enumerate().step_by(2) {
                assert!(
                    (s - standard.flank_roll_lengths[2 * i]).abs() < 1e-3 * gear.data().rack.module
                );
            }
        }
    }

    #[test]
    fn flank_nodes_lie_on_the_involute_from_the_form_point_to_the_tip_in_growing_elements() {
        for (gear, depth) in sweep() {
            let tooth = divided(&gear, depth, GridLevel::Standard);
            let (flank, m) = (gear.flank(), gear.data().rack.module);
            let s = &tooth.flank_roll_lengths;
            assert_eq!(
                (s[0], s[s.len() - 1]),
                (gear.form_roll_length(), gear.tip_roll_length())
            );
            assert_eq!((s.len(), s.len() % 2), (tooth.flank_nodes.len(), 1));
            for (node, s) in tooth.flank_nodes.iter().zip(s) {
                assert_eq!(tooth.grid.nodes[*node as usize], flank.point(*s));
            }
            let sizes: Vec<_> = s
                .windows(3)
                .step_by(2)
                .map(|s| (flank.arc_length(s[2]) - flank.arc_length(s[0])) / m)
                .collect();
            assert!(
                sizes
                    .windows(2)
                    .all(|h| h[1] < h[0] * (1.0 + 1e-9) && h[0] < 1.3 * h[1])
            );
            // Sizes are the asked for ones but for the rounding of an even count.
            assert!(sizes[sizes.len() - 1] < 1.25 * SIZE_AT_TIP && sizes[0] < 1.15 * SIZE_ON_FLANK);
        }
    }

    #[test]
    fn the_interface_circle_and_the_sides_are_in_order_and_alike() {
        for (gear, depth) in sweep() {
            let tooth = divided(&gear, depth, GridLevel::Standard);
            let r_w = gear.root_radius() - depth * gear.data().rack.module;
            let point = |node: &u32| tooth.grid.nodes[*node as usize];
            let half = gear.pitch_angle() / 2.0;
            let angles = &tooth.arc_angles;
            assert!(
                (angles[0] + half).abs() < 1e-15 && (angles[angles.len() - 1] - half).abs() < 1e-15
            );
            assert!(
                angles.windows(2).all(|a| a[0] < a[1]) && angles.len() == tooth.arc_nodes.len()
            );
            for (node, angle) in tooth.arc_nodes.iter().zip(angles) {
                assert!((point(node) - r_w * radial(*angle)).norm() < 1e-15);
            }
            let (right, left) = &tooth.side_nodes;
            assert_eq!(right.len(), left.len());
            for (a, b) in right.iter().zip(left) {
                let (a, b) = (point(a), point(b));
                assert_eq!((a.x, a.y), (b.x, -b.y), "mirror images");
                assert!((b.y.atan2(b.x) - half).abs() < 1e-14);
            }
            let radii: Vec<_> = left.iter().map(|n| point(n).norm()).collect();
            assert!(radii[0] > r_w && radii.windows(2).all(|r| r[0] < r[1]));
            assert!((radii[radii.len() - 1] - gear.root_radius()).abs() < 1e-15);
        }
    }

    #[test]
    fn the_fillet_and_the_root_land_are_followed_by_every_node_on_the_boundary() {
        let gear = gear(50, 0.0).expect("the standard gear");
        let curve = RootCurve::new(&gear);
        let (gamma_0, gamma_1) = gear.fillet().ends();
        for i in 0..=100 {
            let point = curve.point(curve.length() * f64::from(i) / 100.0);
            // The nearest of many points of the true curve.
            let nearest = (0..=20_000)
                .map(|k| gamma_0 + (gamma_1 - gamma_0) * f64::from(k) / 20_000.0)
                .map(|gamma| (gear.fillet().point(gamma) - point).norm())
                .fold((point.norm() - gear.root_radius()).abs(), f64::min);
            assert!(nearest < 1e-7, "the samples stand 1e-7 m apart");
        }
    }

    #[test]
    fn an_interface_circle_through_the_teeth_is_refused() {
        let gear = gear(50, 0.0).expect("the standard gear");
        for r_w in [0.0, 47.5e-3, 50e-3, f64::NAN] {
            assert!(matches!(
                ToothGrid::new(&gear, r_w, GridLevel::Standard),
                Err(GridError::InterfaceOutsideRim { .. })
            ));
        }
    }
}
