//! The local deformation of a flank: the half plane under cells of uniform pressure, and under Hertz's.

use std::f64::consts::PI;

use faer::Mat;

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

/// Local compliance of one gear near a load on its flank, beyond the part that is smooth on the scale of its tooth.
///
/// The plane model spreads a load over the gear's whole face width at once. Where the mating gear is narrower, the load is pressed in over the common width
/// only, and spreads on its way inward: the compression between the flank and the tooth's centerline is that of a body of the common width; deeper parts have
/// the compliance of the gear's own width (Weber's approach, with his depth to the centerline). That is a lower bound of the wider gear's compliance, and makes
/// Hertz's pressure depend on the common width alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearField {
    /// c of the gear's own width.
    own: f64,
    /// Addition by the common width.
    added: f64,
    /// The length, one module, over which logarithms are taken; the flank table takes the same.
    scale: f64,
    /// The distance ℓ within which it is added: a load that acts on a point presses it as deep as Weber's approach to the centerline.
    reach: f64,
}

impl NearField {
    /// Half plane of `gear` about the roll length `s`, pressed over the width `common_width`.
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

    /// The second antiderivative of max(0, ln(ℓ/|x|)).
    fn twice_added(&self, x: f64) -> f64 {
        let (x, reach) = (x.abs(), self.reach);
        if x == 0.0 {
            0.0
        } else if x < reach {
            x * x * (0.5 * (reach / x).ln() + 0.75)
        } else {
            reach * (x - 0.25 * reach)
        }
    }
}

/// The entries of a compliance that are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Entries {
    /// All of them.
    All,
    /// The diagonal and below it, of a compliance between the same stretches.
    Lower,
}

impl Entries {
    /// The first row asked for of column `j`.
    pub(crate) fn first(self, j: usize) -> usize {
        if self == Self::Lower { j } else { 0 }
    }
}

/// Additions by `fields` to the mean displacement of each of `stretches` from a unit force spread over each of the stretches `loaded`: ends along the flank,
/// the first of them nearer to the root.
pub(crate) fn near_compliance(
    fields: &[NearField],
    stretches: &[[f64; 2]],
    loaded: &[[f64; 2]],
    entries: Entries,
) -> Mat<f64> {
    // The logarithm is that of all bodies.
    let own: f64 = fields.iter().map(|field| field.own).sum();
    let of_scale: f64 = fields
        .iter()
        .map(|field| field.own * field.scale.ln())
        .sum();
    let mut compliance = means(stretches, loaded, entries, twice_logarithm);
    for (j, other) in loaded.iter().enumerate() {
        for (i, one) in stretches.iter().enumerate().skip(entries.first(j)) {
            let mean = far_logarithm(*one, *other).unwrap_or(compliance[(i, j)]);
            compliance[(i, j)] = of_scale - own * mean;
        }
    }
    for field in fields.iter().filter(|field| field.added != 0.0) {
        let means = means(stretches, loaded, entries, |x| field.twice_added(x));
        for (j, other) in loaded.iter().enumerate() {
            for (i, one) in stretches.iter().enumerate().skip(entries.first(j)) {
                // Far away nothing is left but the rounding of the differences.
                if apart(*one, *other) < field.reach {
                    compliance[(i, j)] += field.added * means[(i, j)];
                }
            }
        }
    }
    compliance
}

/// Φ(z) = z²/2 ln|z| − 3z²/4, whose second derivative is the logarithm.
fn twice_logarithm(z: f64) -> f64 {
    if z == 0.0 {
        0.0
    } else {
        z * z / 2.0 * z.abs().ln() - 0.75 * z * z
    }
}

/// The mean of ln|x − t| over x and t in two stretches far from each other, where the differences of Φ lose their digits and the series
/// ln z − (w² + w'²)/(24 z²) does not.
fn far_logarithm(one: [f64; 2], other: [f64; 2]) -> Option<f64> {
    let [width, other_width] = [one, other].map(|[from, to]| to - from);
    let distance = 0.5 * ((one[0] - other[0]) + (one[1] - other[1]));
    let squares = width * width + other_width * other_width;
    (distance.abs() > 50.0 * (width + other_width))
        .then(|| distance.abs().ln() - squares / (24.0 * distance * distance))
}

/// The means over each two stretches of the function of the distance whose second antiderivative is `twice`.
fn means(
    stretches: &[[f64; 2]],
    loaded: &[[f64; 2]],
    entries: Entries,
    twice: impl Fn(f64) -> f64,
) -> Mat<f64> {
    // Neighbors share their ends.
    let (rows, row) = ends(stretches);
    let (columns, column) = ends(loaded);
    let mut between = Mat::zeros(rows.len(), columns.len());
    for (j, there) in columns.iter().enumerate() {
        // The entries on the diagonal need one above it.
        for (i, here) in rows
            .iter()
            .enumerate()
            .skip(entries.first(j).saturating_sub(1))
        {
            between[(i, j)] = twice(here - there);
        }
    }
    let mut means = Mat::zeros(stretches.len(), loaded.len());
    let width = |[from, to]: [f64; 2]| to - from;
    for (j, &[c, d]) in column.iter().enumerate() {
        for (i, &[a, b]) in row.iter().enumerate().skip(entries.first(j)) {
            let sum = between[(b, c)] - between[(b, d)] - between[(a, c)] + between[(a, d)];
            means[(i, j)] = sum / (width(stretches[i]) * width(loaded[j]));
        }
    }
    means
}

/// The ends of `stretches`, each once where they follow each other, and where those of each stand.
fn ends(stretches: &[[f64; 2]]) -> (Vec<f64>, Vec<[usize; 2]>) {
    let mut ends = Vec::with_capacity(stretches.len() + 1);
    let places = stretches.iter().map(|&[from, to]| {
        if ends.last() != Some(&from) {
            ends.push(from);
        }
        ends.push(to);
        [ends.len() - 2, ends.len() - 1]
    });
    let places = places.collect();
    (ends, places)
}

/// How far two stretches lie apart, nothing where they overlap.
fn apart(one: [f64; 2], other: [f64; 2]) -> f64 {
    (one[0] - other[1]).max(other[0] - one[1]).max(0.0)
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

    fn row(first: f64, width: f64, count: usize) -> Vec<[f64; 2]> {
        let end = |i: usize| first + (i as f64 - 0.5) * width;
        (0..count).map(|i| [end(i), end(i + 1)]).collect()
    }

    #[test]
    fn the_mean_logarithm_is_that_of_a_fine_sum() {
        let here = [[-0.5, 0.5]];
        for first in [0.0, 0.25, -2.2, 5.0, 99.0] {
            let means = means(&row(first, 1.0, 4), &here, Entries::All, twice_logarithm);
            for i in 0..4 {
                let (sum, mean) = (double_mean(first + i as f64, f64::ln), means[(i, 0)]);
                // The midpoint rule leaves a third of a step beside the logarithm's pole.
                assert!((sum - mean).abs() < 4e-6, "{first} + {i}: {sum}");
            }
        }
    }

    #[test]
    fn stretches_of_other_widths_are_the_means_of_their_parts() {
        let parts = row(0.5, 1.0, 6);
        let whole = [[0.0, 2.0], [2.0, 3.0], [3.0, 6.0]];
        let fine = means(&parts, &parts, Entries::All, twice_logarithm);
        let coarse = means(&whole, &whole, Entries::All, twice_logarithm);
        let within = |[from, to]: [f64; 2]| from as usize..to as usize;
        for (i, one) in whole.iter().enumerate() {
            for (j, other) in whole.iter().enumerate() {
                let entries = within(*one).flat_map(|a| within(*other).map(move |b| (a, b)));
                let entries: Vec<f64> = entries.map(|place| fine[place]).collect();
                let mean = entries.iter().sum::<f64>() / entries.len() as f64;
                assert!((mean - coarse[(i, j)]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn the_series_for_far_cells_continues_the_differences() {
        let here = [-0.5, 0.5];
        let exact = |z: f64| z.ln() - 1.0 / (12.0 * z * z) - 1.0 / (60.0 * z.powi(4));
        for distance in [60.0, 100.0, 101.0, 300.0] {
            let there = [distance - 0.5, distance + 0.5];
            let near = means(&[there], &[here], Entries::All, twice_logarithm)[(0, 0)];
            let mean = far_logarithm(there, here).unwrap_or(near);
            // The term of the fourth order is left out: 1.7e-10 at 100.
            assert!((mean - exact(distance)).abs() < 1e-9, "{distance}: {mean}");
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
        let means = means(
            &row(0.0, width, 8),
            &row(0.0, width, 1),
            Entries::All,
            |x| field.twice_added(x),
        );
        for distance in 0..8 {
            let mean = means[(distance as usize, 0)];
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
