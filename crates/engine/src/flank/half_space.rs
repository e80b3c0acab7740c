//! Compliance of a half space between lines along a flank, and at the ends of one: the singular part of a tooth's compliance under its own load.

use std::f64::consts::{FRAC_PI_2, PI};

use faer::Mat;

use super::ends::{FlankEnds, Lines};
use super::polynomials::projecting;
use crate::fem::axial::AxialBasis;
use crate::gear::{Material, SolidGear};
use crate::quadrature::{gauss_legendre, legendre};

/// Points between two distances along the axis over which asinh of them, in the distance of the lines, changes by [`STRETCH`] at most.
const POINTS: usize = 16;
const STRETCH: f64 = 3.0;

/// Points a piece beyond the degree of its functions, over which images beyond the ends of the face are summed.
const BEYOND: usize = 14;

/// The half space's compliance between lines along the flank, (1 − ν²)/(π E) ∫∫ f_p f_q / distance.
pub(crate) struct HalfSpace {
    /// ∫ f_p(z) f_q(z − Δ) dz over Δ.
    products: Vec<Products>,
    /// Places and weights between two distances, of −1 … 1.
    rule: Vec<(f64, f64)>,
    scale: f64,
    base_radius: f64,
    ends: FlankEnds,
    /// ∫ f_p dz.
    even: Vec<f64>,
    /// Heights over the face, denser towards its ends, and the weighed functions there, a row each.
    heights: Vec<f64>,
    weighed: Mat<f64>,
}

/// ∫ f_p(z) f_q(z − Δ) dz between two distances Δ, where it is a polynomial: so much of each Legendre polynomial.
struct Products {
    ends: [f64; 2],
    shares: Vec<Mat<f64>>,
}

impl HalfSpace {
    pub(crate) fn new(gear: &SolidGear, axial: &AxialBasis) -> Self {
        let section = gear.section();
        let Material {
            youngs_modulus: e,
            poisson_ratio: nu,
            ..
        } = *section.material();
        // Heights at even angles of a circle over each piece.
        let count = axial.degree() + BEYOND;
        let rule = gauss_legendre(count);
        let pieces = axial.breaks().windows(2).map(|ends| [ends[0], ends[1]]);
        let places: Vec<(f64, f64)> = pieces
            .flat_map(|[from, to]| {
                rule.iter().map(move |(x, w)| {
                    let (middle, half) = (f64::midpoint(from, to), 0.5 * (to - from));
                    let angle = FRAC_PI_2 * x;
                    (
                        middle + half * angle.sin(),
                        FRAC_PI_2 * w * half * angle.cos(),
                    )
                })
            })
            .collect();
        let mut weighed = Mat::zeros(places.len(), axial.len());
        for (i, &(z, w)) in places.iter().enumerate() {
            for (p, f) in axial.values(z).into_iter().enumerate() {
                weighed[(i, p)] = w * f;
            }
        }
        Self {
            heights: places.into_iter().map(|(z, _)| z).collect(),
            weighed,
            products: Products::all(axial),
            rule: gauss_legendre(POINTS),
            scale: (1.0 - nu * nu) / (PI * e),
            base_radius: section.base_radius(),
            ends: FlankEnds::new(gear),
            even: axial.even(),
        }
    }

    /// Between the displacement at roll length `s` and the load at `loaded`, another one; with the ends of the flank.
    fn between(&self, s: f64, loaded: f64) -> Mat<f64> {
        let mut sum = self.along(self.ends.direct(s, loaded), self.scale);
        let (lines, factor) = self.ends.beyond_tip(s, loaded);
        sum += self.along(lines, factor);
        sum += self.beyond_face(s, loaded);
        let of_plate = self.ends.of_plate(s, loaded);
        for (q, g) in self.even.iter().enumerate() {
            for (p, f) in self.even.iter().enumerate() {
                sum[(p, q)] += of_plate * f * g;
            }
        }
        sum
    }

    /// That of the images beyond both ends of the face.
    fn beyond_face(&self, s: f64, loaded: f64) -> Mat<f64> {
        let size = self.heights.len();
        let between = Mat::from_fn(size, size, |i, j| {
            let [z, from] = [i, j].map(|i| self.heights[i]);
            self.scale * self.ends.beyond_face((s, z), (loaded, from))
        });
        self.weighed.transpose() * (between * &self.weighed)
    }

    /// `factor` times ∫∫ f_p f_q / distance between two lines.
    ///
    /// The distance is κ √((Δ − Δ_0)² + ε²), and Δ = Δ_0 + ε sinh v makes dΔ/distance = dv/κ.
    fn along(&self, lines: Lines, factor: f64) -> Mat<f64> {
        let Lines {
            stretch: kappa,
            nearest,
            reach,
        } = lines;
        let m = self.products[0].shares[0].nrows();
        let mut sum = Mat::zeros(m, m);
        for Products { ends, shares } in &self.products {
            let [from, to] = ends.map(|end| ((end - nearest) / reach).asinh());
            let stretches = ((to - from) / STRETCH).ceil();
            let half = 0.5 * (to - from) / stretches;
            let mut integrals = vec![0.0; shares.len()];
            for stretch in 0..stretches as usize {
                for (x, w) in &self.rule {
                    let v = from + half * ((2 * stretch + 1) as f64 + x);
                    let apart = nearest + reach * v.sinh();
                    let t = (2.0 * apart - ends[0] - ends[1]) / (ends[1] - ends[0]);
                    let values = legendre_values(t, shares.len() - 1);
                    for (integral, value) in integrals.iter_mut().zip(values) {
                        *integral += half * w / kappa * value;
                    }
                }
            }
            for (share, integral) in shares.iter().zip(integrals) {
                sum += share * faer::Scale(factor * integral);
            }
        }
        sum
    }

    /// Its nearest of products of the polynomials [`up_the_flank`] and functions along the axis, over the flank between the squares of two roll
    /// lengths.
    pub(crate) fn over_flank(&self, squares: [f64; 2], degree: usize) -> Mat<f64> {
        self.nearest(squares, degree, |s, loaded| self.between(s, loaded))
    }

    /// The same for the part `between` two lines, symmetric, with a logarithm of their distance.
    ///
    /// The logarithm of the distance d becomes smooth by d = L u³.
    fn nearest(
        &self,
        squares: [f64; 2],
        degree: usize,
        between: impl Fn(f64, f64) -> Mat<f64>,
    ) -> Mat<f64> {
        let length = (squares[1] - squares[0]) / (2.0 * self.base_radius);
        let m = self.products[0].shares[0].nrows();
        let count = degree + 1;
        let mut whole = Mat::<f64>::zeros(count * m, count * m);
        let (distances, middles) = (gauss_legendre(count + 9), gauss_legendre(count + 4));
        for (x, w) in &distances {
            let u = 0.5 * (1.0 + x);
            let apart = length * u.powi(3);
            let weight = 1.5 * w * length * u * u;
            for (y, v) in &middles {
                let half = 0.5 * (length - apart);
                let arcs = [0.5, -0.5].map(|side| 0.5 * length + half * y + side * apart);
                let [s, loaded] =
                    arcs.map(|arc| (squares[0] + 2.0 * self.base_radius * arc).sqrt());
                let near = between(s, loaded);
                let [at, of] = [s, loaded].map(|s| projecting(squares, s, degree));
                for a in 0..count {
                    for b in 0..count {
                        let share = weight * v * half * at[a] * of[b] / (length * length);
                        for q in 0..m {
                            for p in 0..m {
                                let moved = share * near[(p, q)];
                                whole[(a * m + p, b * m + q)] += moved;
                                // Exchanged lines exchange the functions.
                                whole[(b * m + q, a * m + p)] += moved;
                            }
                        }
                    }
                }
            }
        }
        whole
    }
}

impl Products {
    /// Terms of `axial` at all distances at which its functions overlap.
    fn all(axial: &AxialBasis) -> Vec<Self> {
        let breaks = axial.breaks();
        let apart = breaks
            .iter()
            .flat_map(|one| breaks.iter().map(move |other| one - other));
        let mut kinks: Vec<f64> = apart.collect();
        kinks.sort_by(f64::total_cmp);
        let [from, to] = axial.heights();
        let no_length = 1e-9 * (to - from);
        kinks.dedup_by(|one, other| (*one - *other).abs() < no_length);
        kinks
            .windows(2)
            .map(|ends| Self::between(axial, [ends[0], ends[1]]))
            .collect()
    }

    fn between(axial: &AxialBasis, ends: [f64; 2]) -> Self {
        let (m, degree) = (axial.len(), 2 * axial.degree() + 1);
        let mut shares = vec![Mat::zeros(m, m); degree + 1];
        let half = 0.5 * (ends[1] - ends[0]);
        for (t, w) in gauss_legendre(degree + 1) {
            let product = product(axial, ends[0] + half * (1.0 + t));
            for (k, value) in legendre_values(t, degree).into_iter().enumerate() {
                let share = (k as f64 + 0.5) * w * value;
                shares[k] += &product * faer::Scale(share);
            }
        }
        Self { ends, shares }
    }
}

/// The Legendre polynomials up to `degree` at `t`.
fn legendre_values(t: f64, degree: usize) -> Vec<f64> {
    let (mut values, mut slopes) = (vec![0.0; degree + 1], vec![0.0; degree + 1]);
    legendre(t, &mut values, &mut slopes);
    values
}

/// ∫ f_p(z) f_q(z − `apart`) dz.
fn product(axial: &AxialBasis, apart: f64) -> Mat<f64> {
    let [from, to] = axial.heights();
    let [low, high] = [from.max(from + apart), to.min(to + apart)];
    let breaks = axial.breaks().iter();
    let mut cuts: Vec<f64> = breaks.flat_map(|z| [*z, z + apart]).collect();
    cuts.retain(|z| (low..=high).contains(z));
    cuts.sort_by(f64::total_cmp);
    let rule = gauss_legendre(axial.degree() + 1);
    let mut sum = Mat::zeros(axial.len(), axial.len());
    for ends in cuts.windows(2) {
        let half = 0.5 * (ends[1] - ends[0]);
        for (x, w) in &rule {
            let z = ends[0] + half * (1.0 + x);
            let (f, g) = (axial.values(z), axial.values(z - apart));
            for (q, g) in g.iter().enumerate() {
                for (p, f) in f.iter().enumerate() {
                    sum[(p, q)] += half * w * f * g;
                }
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flank::corner::tip_softness;
    use crate::gear::Helix;
    use crate::gear::spur::tests::paper_gear;

    /// κ where lines lean by `slope`.
    fn slope_of(slope: f64, cos: f64) -> f64 {
        slope.hypot(1.0 / cos)
    }

    /// Factor of the level of two lines for their distance over κ.
    fn lean_of(slope: f64, cos: f64) -> f64 {
        1.0 / cos / slope_of(slope, cos).powi(2)
    }

    fn gear(beta: f64) -> SolidGear {
        let mut data = paper_gear(30);
        data.blank.bore_radius = 10e-3;
        SolidGear::new(data, Helix::right(beta), 0.0, None).expect("can be made")
    }

    #[test]
    fn lines_yield_to_each_other_by_their_distances() {
        // Summed over enough points that those of two lines are near each other nowhere.
        let gear = gear(0.4);
        for axial in [
            AxialBasis::new(&[-10e-3, 10e-3], 8),
            AxialBasis::new(&[-10e-3, -3e-3, 2e-3, 10e-3], 4),
        ] {
            let space = HalfSpace::new(&gear, &axial);
            for [s, loaded] in [[9e-3, 8.4e-3], [7e-3, 10e-3], [10e-3, 7e-3]] {
                let section = gear.section();
                let (r_b, tip) = (section.base_radius(), section.tip_roll_length());
                let (tau, cos) = (gear.twist(), gear.base_helix_angle().cos());
                let level = (s * s - loaded * loaded) / (2.0 * r_b);
                let slope = tau * f64::midpoint(s, loaded);
                // Beyond the tip: along it and away from it, of the flank unrolled there.
                let lean = (tau * tip * cos).atan();
                let away = (2.0 * tip * tip - s * s - loaded * loaded) / (2.0 * r_b) * lean.cos();
                let softness = tip_softness(section);
                // The difference of a plate from plane strain, ν = 0.3.
                let (b, d) = (20e-3_f64 * 3.0 / 14.56, (level * lean_of(slope, cos)).abs());
                let plate = -0.18 / (PI * 210e9 * 20e-3)
                    * slope_of(slope, cos).recip()
                    * (((b + b.hypot(d)) / 2e-3).ln() - (b.hypot(d) - d) / b);
                let rule: Vec<(f64, Vec<f64>)> = axial
                    .rule(500)
                    .into_iter()
                    .map(|(z, w)| (z, axial.values(z).iter().map(|f| w * f).collect()))
                    .collect();
                let mut sum = Mat::<f64>::zeros(axial.len(), axial.len());
                for (z, f) in &rule {
                    for (y, g) in &rule {
                        let across = level - slope * (z - y);
                        let distance = across.hypot((z - y) / cos);
                        let along = (z - y) / (cos * lean.cos()) - level * lean.sin();
                        let image = away.hypot(along).hypot(0.02 * 2e-3);
                        let beyond = space.ends.beyond_face((s, *z), (loaded, *y));
                        let inverse = 1.0 / distance + softness / image + beyond;
                        let of_both = space.scale * inverse + plate;
                        for (q, g) in g.iter().enumerate() {
                            for (p, f) in f.iter().enumerate() {
                                sum[(p, q)] += of_both * f * g;
                            }
                        }
                    }
                }
                let apart = (space.between(s, loaded) - &sum).norm_max();
                assert!(
                    apart < 1e-5 * sum.norm_max(),
                    "{s} {loaded}: {apart:e} of {:e}, {}",
                    sum.norm_max(),
                    axial.len()
                );
            }
        }
    }

    #[test]
    fn a_flank_under_an_even_pressure_sinks_in_the_mean_as_a_rectangle() {
        // ∫∫ 1/distance over two points of a rectangle, in closed form.
        let gear = gear(0.0);
        let section = gear.section();
        let squares = [section.form_roll_length(), section.tip_roll_length()].map(|s| s * s);
        let axial = AxialBasis::new(&[-10e-3, 10e-3], 8);
        let space = HalfSpace::new(&gear, &axial);
        let (a, b) = (
            (squares[1] - squares[0]) / (2.0 * section.base_radius()),
            20e-3_f64,
        );
        let logarithms = 3.0 * a * b * (a * (b / a).asinh() + b * (a / b).asinh());
        let whole = 2.0 / 3.0 * (logarithms + a.powi(3) + b.powi(3) - a.hypot(b).powi(3));
        let expected = space.scale * whole / (a * a * b);
        let found = space.nearest(squares, 6, |s, loaded| {
            space.along(space.ends.direct(s, loaded), space.scale)
        });
        assert!(
            (found[(0, 0)] / expected - 1.0).abs() < 1e-6,
            "{} {expected}",
            found[(0, 0)]
        );
        let mutual = (&found - found.transpose()).norm_max();
        assert!(mutual < 1e-12 * found.norm_max(), "{mutual:e}");
    }
}
