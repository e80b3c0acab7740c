//! The local deformation of a flank: the half plane under cells of uniform pressure, and under Hertz's.

use std::f64::consts::PI;

use crate::gear::SpurGear;

/// The factor c = 2/(π E' b) of the logarithm in the compliance of a half plane: u = −c F ln|x| + constant.
///
/// E' is Young's modulus in plane stress, E/(1 − ν²) in plane strain.
pub fn logarithm_factor(plane_modulus: f64, thickness: f64) -> f64 {
    2.0 / (PI * plane_modulus * thickness)
}

/// The half-width a of the contact of two cylinders under `load`, and its peak pressure.
///
/// With the sum c_1 + c_2 of the logarithm `factors` of both bodies over the face `width` on which they touch,
/// a² = 2 F ρ (c_1 + c_2), and p_0 = 2F/(π a b) = a/(π b ρ (c_1 + c_2)) (Hertz). Both vanish with the load.
pub fn hertz(load: f64, radius: f64, factors: f64, width: f64) -> (f64, f64) {
    let a = (2.0 * load * radius * factors).sqrt();
    (a, a / (PI * width * radius * factors))
}

/// How one gear gives way near a load on its flank, beyond what is smooth on the scale of its tooth.
///
/// The plane model spreads a load over the gear's whole face width at once. Where the mating gear is narrower, the load is pressed in
/// over the common width only, and spreads on its way inward: the compression between the flank and the tooth's centerline is that of a body of
/// the common width, what lies deeper yields as the gear's own width has it (Weber's approach, with his depth to the centerline). That is
/// a lower bound of the wider gear's compliance, and makes Hertz's pressure depend on the common width alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearField {
    /// c of the gear's own width.
    own: f64,
    /// What the common width adds to it.
    added: f64,
    /// The length, one module, over which logarithms are taken; the flank table takes the same.
    scale: f64,
    /// The distance ℓ within which it is added: a load that acts on a point presses it as deep as Weber's approach to the centerline.
    reach: f64,
}

impl NearField {
    /// That of `gear` about the roll length `s`, pressed over the width `common_width`.
    pub fn new(gear: &SpurGear, s: f64, common_width: f64) -> Self {
        let (e, nu) = (
            gear.material().youngs_modulus,
            gear.material().poisson_ratio,
        );
        let own = logarithm_factor(e, gear.face_width());
        // From the flank along its normal to the centerline of the tooth: t = s − r_b tan(s/r_b − ψ_b).
        let depth = s - gear.base_radius() * (-gear.flank().tangent_angle(s)).tan();
        // Weber: u = c F (ln(2 t/a) − ν/2); a kernel −c ln(x/ℓ) under Hertz's pressure gives c F (ln(2 ℓ/a) + 1/2).
        let reach = depth * (-0.5 * (1.0 + nu)).exp();
        Self {
            own,
            added: logarithm_factor(e, common_width) - own,
            scale: gear.data().rack.module,
            reach,
        }
    }

    /// The mean of max(0, ln(ℓ/|x|)) over two cells of width `w` for each distance of their middles, `first` and every w from there: the
    /// second differences of its second antiderivative.
    fn mean_added(&self, first: f64, w: f64, count: usize) -> impl Iterator<Item = f64> {
        let reach = self.reach;
        let twice = move |x: f64| {
            let x = x.abs();
            if x == 0.0 {
                0.0
            } else if x < reach {
                x * x * (0.5 * (reach / x).ln() + 0.75)
            } else {
                reach * (x - 0.25 * reach)
            }
        };
        let differences = second_differences(twice, first, w, count);
        // Far away nothing is left but the rounding of the differences.
        differences.map(move |(x, difference)| {
            if x.abs() - w >= reach {
                0.0
            } else {
                difference / (w * w)
            }
        })
    }
}

/// What a unit force spread over a stretch of `width` adds by `fields` to the mean displacement of each of `count` such stretches
/// in a row: those whose middles are `first`, `first + width` and so on away.
pub fn in_row(fields: &[NearField], first: f64, width: f64, count: usize) -> Vec<f64> {
    // The logarithm is that of all bodies.
    let own: f64 = fields.iter().map(|field| field.own).sum();
    let of_width = fields
        .iter()
        .map(|field| field.own * (width / field.scale).ln())
        .sum::<f64>();
    let mut row: Vec<f64> = mean_logarithms(first / width, count)
        .map(|logarithm| -own * logarithm - of_width)
        .collect();
    for field in fields.iter().filter(|field| field.added != 0.0) {
        for (compliance, mean) in row.iter_mut().zip(field.mean_added(first, width, count)) {
            *compliance += field.added * mean;
        }
    }
    row
}

/// The mean of ln|x − t| over x and t in two stretches of unit width, for each distance z of their middles: `first`, `first + 1` and so
/// on.
///
/// The second differences of Φ(z) = z²/2 ln|z| − 3z²/4, whose second derivative is the logarithm.
pub fn mean_logarithms(first: f64, count: usize) -> impl Iterator<Item = f64> {
    let phi = |z: f64| {
        if z == 0.0 {
            0.0
        } else {
            z * z / 2.0 * z.abs().ln() - 0.75 * z * z
        }
    };
    second_differences(phi, first, 1.0, count).map(|(z, difference)| {
        // Far away the second difference loses its digits; its series ln z − 1/(12 z²) does not.
        if z.abs() > 100.0 {
            z.abs().ln() - 1.0 / (12.0 * z * z)
        } else {
            difference
        }
    })
}

/// f(x + h) − 2 f(x) + f(x − h) at `count` places x, `first` and every `step` h from there, each with its place.
fn second_differences(
    f: impl Fn(f64) -> f64,
    first: f64,
    step: f64,
    count: usize,
) -> impl Iterator<Item = (f64, f64)> {
    let at = move |i: usize| first + i as f64 * step;
    let (mut before, mut here) = (f(first - step), f(first));
    (0..count).map(move |i| {
        let after = f(at(i + 1));
        let difference = after - 2.0 * here + before;
        (before, here) = (here, after);
        (at(i), difference)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;

    /// The mean of `f` of the distance over pairs of points of two stretches of unit width, their middles `z` apart: distances
    /// z + t are as many as 1 − |t|.
    fn double_mean(z: f64, f: impl Fn(f64) -> f64) -> f64 {
        let n = 400_000;
        let step = 2.0 / f64::from(n);
        let at = |i: i32| (f64::from(i) + 0.5) * step - 1.0;
        (0..n)
            .map(|i| step * (1.0 - at(i).abs()) * f((z + at(i)).abs()))
            .sum()
    }

    #[test]
    fn the_mean_logarithm_is_that_of_a_fine_sum() {
        for first in [0.0, 0.25, -2.2, 5.0, 99.0] {
            for (i, mean) in mean_logarithms(first, 4).enumerate() {
                let sum = double_mean(first + i as f64, f64::ln);
                // The midpoint rule leaves a third of a step beside the logarithm's pole.
                assert!((sum - mean).abs() < 4e-6, "{first} + {i}: {sum}");
            }
        }
    }

    #[test]
    fn the_series_for_far_cells_continues_the_second_difference() {
        let exact = |z: f64| z.ln() - 1.0 / (12.0 * z * z) - 1.0 / (60.0 * z.powi(4));
        for distance in [60.0, 100.0, 101.0, 300.0] {
            let mean = mean_logarithms(distance, 1).next().expect("one");
            // The term of the fourth order is left out: 1.7e-10 at 100.
            assert!((mean - exact(distance)).abs() < 2e-10);
        }
    }

    fn near_field(own: f64, common: f64) -> NearField {
        let mut data = paper_gear(50);
        data.face_width = own;
        let gear = SpurGear::new(data).expect("the standard gear");
        NearField::new(&gear, 17.8187e-3, common)
    }

    #[test]
    fn a_narrower_partner_adds_the_compression_down_to_the_centerline_and_nothing_beyond() {
        let field = near_field(40e-3, 20e-3);
        // From the flank along its normal to the centerline of the tooth, which is the x axis.
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        let (point, normal) = (
            gear.flank().point(17.8187e-3),
            gear.flank().normal(17.8187e-3),
        );
        let depth = point.y / normal.y;
        assert!((field.reach / (depth * (-0.65_f64).exp()) - 1.0).abs() < 1e-12);
        assert!((field.added / field.own - 1.0).abs() < 1e-14);
        let width = 0.25e-3;
        for (distance, mean) in (0..8).zip(field.mean_added(0.0, width, 8)) {
            let sum = double_mean(f64::from(distance), |x| {
                (field.reach / (x * width)).ln().max(0.0)
            });
            assert!((sum - mean).abs() < 4e-6, "{distance}: {sum} {mean}");
        }
        assert_eq!(near_field(20e-3, 20e-3).added, 0.0);
    }

    #[test]
    fn hertz_at_the_pitch_point_of_the_standard_pair() {
        // Plane stress: half-width 115.0 µm and 677 MPa at T = 115 N m; both radii are 17.8187 mm.
        let factor = 2.0 * logarithm_factor(210e9, 20e-3);
        let (a, p) = hertz(2447.61, 17.8187e-3 / 2.0, factor, 20e-3);
        assert!((a - 115.0e-6).abs() < 0.06e-6, "{a}");
        assert!((p - 677e6).abs() < 0.6e6, "{p}");
    }
}
