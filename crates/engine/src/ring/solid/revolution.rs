//! Bodies of revolution, order by order: rims, webs and hubs without holes.
//!
//! In polar components times e^{inφ}, ∂_φ becomes i n and the derivative along the axis of a turning frame d/dz − i τ n: one small
//! problem in the radius for each order n, Hermitian, whose unknowns stand circle by circle, component by component, function by
//! function.

use faer::traits::ComplexField;
use faer::{Mat, c64};
use nalgebra::SMatrix;

use crate::fem::FemError;
use crate::fem::axial::{AxialBasis, AxialMatrices};
use crate::fem::dense::{Cholesky, mirror_lower, subtract_product};
use crate::fem::prism::{COMPONENTS, Law3};
use crate::gear::Material;
use crate::quadrature::{gauss_legendre, parabola};

/// The size of the elements at both circles of a layer, by the length r/n in which an order fades; quadratic elements of it
/// err by less than a thousandth.
const SIZE_BY_FADING: f64 = 0.5;
/// The size of the elements at both circles by the width of the narrowest piece of the layer: where it is held, or meets one of another
/// width, fields about the corners fade within a part of that width, whatever their order.
const SIZE_BY_WIDTH: f64 = 0.5;
/// The largest size of elements in which stresses are recovered, by their radius: at the corners of quadratic elements the shear of a torque, which falls
/// with the square of the radius, errs by the square of half of that. Stiffnesses, which err by its fourth power, need none so small.
const RECOVERED_BY_RADIUS: f64 = 0.12;
/// The growth of elements away from both circles.
const GROWTH: f64 = 0.4;
/// The least number of elements in the depth of a layer.
const LEAST_ELEMENTS: f64 = 3.0;
/// The least number in a layer that goes to the axis, where fields rise with powers of the radius.
const LEAST_TO_AXIS: f64 = 6.0;

/// A layer: a ring whose section in the plane of the axis is a rectangle.
#[derive(Debug, Clone)]
pub struct Revolution<'a> {
    /// Its material.
    pub material: &'a Material,
    /// τ: the turn of its frame per length, in radians a meter.
    pub twist: f64,
    /// The functions along the axis.
    pub axial: &'a AxialBasis,
    /// The inner and the outer radius.
    pub radii: [f64; 2],
}

/// A layer on both of its circles.
#[derive(Debug, Clone)]
pub struct Ports {
    /// The stiffness on (inner, outer).
    pub stiffness: Mat<c64>,
    /// The unknowns of one circle.
    pub size: usize,
}

/// Motion of the circles of a layer in one order.
#[derive(Debug, Clone)]
pub struct Circles {
    /// Radii from the inner to the outer circle: corners and middles of elements.
    radii: Vec<f64>,
    /// The amplitudes on each.
    moved: Vec<Mat<c64>>,
}

impl Circles {
    /// The amplitudes on the inner circle.
    pub fn inner(&self) -> &Mat<c64> {
        &self.moved[0]
    }

    /// The amplitudes at `radius`.
    pub fn at(&self, radius: f64) -> Mat<c64> {
        let last = self.radii.len() - 3;
        let above = self.radii.partition_point(|r| *r <= radius);
        let first = (above.max(1) - 1).min(last) / 2 * 2;
        let shares = parabola([0, 1, 2].map(|i| self.radii[first + i]), radius);
        let mut sum = Mat::zeros(self.moved[0].nrows(), 1);
        for (share, moved) in shares.into_iter().zip(&self.moved[first..]) {
            sum += moved * faer::Scale(c64::new(share, 0.0));
        }
        sum
    }
}

type Radial = SMatrix<f64, 9, 9>;
type RadialStrains = SMatrix<f64, 6, 9>;

/// The stiffness of one element in an order, on amplitudes of which the tangential ones are counted in parts of i: real but for the turn of its frame.
///
/// With the radial strains b_r and the strains b_z that a slope along the axis makes, both real, and D the law, the unknowns (a, p) and (b, q) have
///
/// ```text
/// b_rᵀ D b_r δ_pq + b_rᵀ D b_z (C_pq − iθ δ_pq) + b_zᵀ D b_r (C_qp + iθ δ_pq) + b_zᵀ D b_z (D_pq + θ² δ_pq + iθ (C_pq − C_qp)),   θ = n τ
/// ```
struct RadialElement<'a> {
    /// b_rᵀ D b_r + θ² b_zᵀ D b_z.
    plain: Radial,
    /// b_rᵀ D b_z.
    mixed: Radial,
    /// b_zᵀ D b_z.
    slopes: Radial,
    /// θ.
    turn: f64,
    axial: &'a AxialMatrices,
}

impl RadialElement<'_> {
    /// The real parts of the lower triangle.
    fn real(&self) -> Mat<f64> {
        self.lower(|a, b| {
            let mixed = [self.mixed[(a, b)], self.mixed[(b, a)]];
            [self.plain[(a, b)], mixed[0], mixed[1], self.slopes[(a, b)]]
        })
    }

    /// The imaginary parts of the lower triangle.
    fn imaginary(&self) -> Mat<f64> {
        self.lower(|a, b| {
            let same = self.turn * (self.mixed[(b, a)] - self.mixed[(a, b)]);
            let between = self.turn * self.slopes[(a, b)];
            [same, between, -between, 0.0]
        })
    }

    /// The lower triangle of a matrix with so much of I, C, Cᵀ and D between two components of nodes.
    fn lower(&self, shares: impl Fn(usize, usize) -> [f64; 4]) -> Mat<f64> {
        let functions = self.axial.same.nrows();
        let mut lower = Mat::zeros(9 * functions, 9 * functions);
        for (b, q) in (0..9).flat_map(|b| (0..functions).map(move |q| (b, q))) {
            let column = lower.col_as_slice_mut(b * functions + q);
            for (a, to) in column.chunks_exact_mut(functions).enumerate().skip(b) {
                self.axial.fill(shares(a, b), q, to);
            }
        }
        lower
    }
}

/// The factor i of the tangential amplitude among the `functions` of each component, and 1 of the others.
fn in_parts(unknown: usize, functions: usize) -> c64 {
    match unknown / functions % COMPONENTS {
        1 => c64::new(0.0, 1.0),
        _ => c64::new(1.0, 0.0),
    }
}

impl Revolution<'_> {
    /// The unknowns of one circle.
    pub fn size(&self) -> usize {
        COMPONENTS * self.axial.len()
    }

    /// The stiffness of `order` on the outer circle, with `below` under the inner one: the stiffness that carries it there, or `None` where it is held.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`].
    pub fn on_outer(&self, order: i64, below: Option<&Mat<c64>>) -> Result<Mat<c64>, FemError> {
        let matrices = self.axial.matrices();
        if self.twist != 0.0 {
            let of = |ends| self.element(order, ends, &matrices);
            return self.stacked(order, below.cloned(), of);
        }
        // A still frame is its own image in each plane through the axis, and so is all below.
        let functions = self.axial.len();
        let parts = |i: usize, j: usize| in_parts(i, functions) * in_parts(j, functions).conj();
        let below = below.map(|below| {
            Mat::from_fn(below.nrows(), below.ncols(), |i, j| {
                (below[(i, j)] * parts(j, i)).re
            })
        });
        let of = |ends| self.radial_element(order, ends, &matrices).real();
        let real = self.stacked(order, below, of)?;
        Ok(Mat::from_fn(real.nrows(), real.ncols(), |i, j| {
            parts(i, j) * real[(i, j)]
        }))
    }

    /// The stiffness of `order` on the outer circle with `below` under the inner one, of elements that are made between two radii.
    fn stacked<T: ComplexField>(
        &self,
        order: i64,
        below: Option<Mat<T>>,
        element: impl Fn([f64; 2]) -> Mat<T>,
    ) -> Result<Mat<T>, FemError> {
        let size = self.size();
        let mut carried = below;
        for ends in self.elements(order).windows(2) {
            let mut k = element([ends[0], ends[1]]);
            carried = Some(match &carried {
                Some(below) => {
                    add_block(&mut k, 0, below);
                    last_of(&k, size)?
                }
                None => last_of(
                    &k.submatrix(size, size, 2 * size, 2 * size).to_owned(),
                    size,
                )?,
            });
        }
        Ok(carried.unwrap_or_else(|| Mat::zeros(size, size)))
    }

    /// The stiffness of `order` on both circles.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`].
    pub fn on_both(&self, order: i64) -> Result<Ports, FemError> {
        let size = self.size();
        let matrices = self.axial.matrices();
        let mut ports: Option<Mat<c64>> = None;
        for ends in self.elements(order).windows(2) {
            let element = self.element(order, [ends[0], ends[1]], &matrices);
            // Unknowns (inner circle, outer circle so far, middle, next): the middle ones go.
            let joined = match ports {
                None => in_order(&element, &[1, 0, 2], size),
                Some(ports) => {
                    let mut k = Mat::<c64>::zeros(4 * size, 4 * size);
                    add_block(&mut k, 0, &ports);
                    add_block(&mut k, size, &element);
                    in_order(&k, &[1, 2, 0, 3], size)
                }
            };
            ports = Some(last_of(&joined, 2 * size)?);
        }
        Ok(Ports {
            stiffness: ports.unwrap_or_else(|| Mat::zeros(2 * size, 2 * size)),
            size,
        })
    }

    /// How its circles move in `order`, by elements small enough to tell stresses, where the outer one moves by `outer`: with `below` under the inner one as in [`Revolution::on_outer`],
    /// and `forces` that act there.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`].
    pub fn inside(
        &self,
        order: i64,
        (below, forces): (Option<&Mat<c64>>, Option<Mat<c64>>),
        outer: &Mat<c64>,
    ) -> Result<Circles, FemError> {
        let (size, matrices) = (self.size(), self.axial.matrices());
        let division = self.division(order, self.at_corners(), RECOVERED_BY_RADIUS);
        let none = || Mat::<c64>::zeros(size, 1);
        let mut force = forces.unwrap_or_else(none);
        let mut carried = below.cloned();
        let mut elements = Vec::new();
        for ends in division.windows(2) {
            let mut k = self.element(order, [ends[0], ends[1]], &matrices);
            // Held unknowns do not move.
            let held = if carried.is_some() { 0 } else { size };
            if let Some(below) = &carried {
                add_block(&mut k, 0, below);
            }
            let free = 2 * size - held;
            let inner = k.submatrix(held, held, free, free).to_owned();
            let factor = Cholesky::new(inner).ok_or(FemError::NotPositiveDefinite {
                part: "a ring",
                unknowns: free,
            })?;
            let mut follows = -k.submatrix(held, 2 * size, free, size).to_owned();
            factor.solve_in_place(follows.as_mut());
            let mut moved = Mat::<c64>::zeros(free, 1);
            if held == 0 {
                moved.subrows_mut(0, size).copy_from(&force);
                factor.solve_in_place(moved.as_mut());
            }
            let back = k.submatrix(2 * size, held, size, free);
            carried = Some(k.submatrix(2 * size, 2 * size, size, size) + back * &follows);
            force = -(back * &moved);
            elements.push((follows, moved));
        }
        let mut circles = vec![outer.clone()];
        for (follows, moved) in elements.into_iter().rev() {
            let inner = follows * &circles[circles.len() - 1] + moved;
            let first = inner.nrows() - size;
            circles.push(inner.subrows(first, size).to_owned());
            circles.push(match first {
                0 => none(),
                _ => inner.subrows(0, size).to_owned(),
            });
        }
        circles.reverse();
        Ok(Circles {
            radii: with_middles(&division),
            moved: circles,
        })
    }

    /// The radii of circles, corners and middles of elements in turn, that tell the field of `order`, and its stresses, but for that about its
    /// corners.
    pub fn circles(&self, order: i64) -> Vec<f64> {
        with_middles(&self.division(order, f64::INFINITY, RECOVERED_BY_RADIUS))
    }

    /// The radii of its elements for `order`.
    pub(super) fn elements(&self, order: i64) -> Vec<f64> {
        self.division(order, self.at_corners(), f64::INFINITY)
    }

    /// The largest size of elements about its corners.
    fn at_corners(&self) -> f64 {
        let pieces = self.axial.breaks().windows(2);
        let narrowest = pieces.fold(f64::INFINITY, |least, ends| least.min(ends[1] - ends[0]));
        SIZE_BY_WIDTH * narrowest
    }

    /// The radii of elements that are small at both circles, where `order` fades, and no larger there than `at_corners`; nowhere larger than
    /// `by_radius` times their radius.
    fn division(&self, order: i64, at_corners: f64, by_radius: f64) -> Vec<f64> {
        let [inner, outer] = self.radii;
        let depth = outer - inner;
        let fading = |radius: f64| {
            let by_order = SIZE_BY_FADING * radius / (1.0 + order.unsigned_abs() as f64);
            by_order.min(at_corners)
        };
        let least = if inner == 0.0 {
            LEAST_TO_AXIS
        } else {
            LEAST_ELEMENTS
        };
        let largest = depth / least;
        let size = |r: f64| {
            // About the axis only fields from outside decay.
            let from_inner = match inner {
                0.0 => f64::INFINITY,
                _ => fading(inner) + GROWTH * (r - inner),
            };
            let from_outer = fading(outer) + GROWTH * (outer - r);
            from_inner.min(from_outer).min(largest).min(by_radius * r)
        };
        // The number of elements up to each of many radii, and radii at equal parts of it.
        const STEPS: usize = 512;
        let radius = |i: usize| inner + depth * i as f64 / STEPS as f64;
        let mut counts = vec![0.0];
        for i in 0..STEPS {
            let step = radius(i + 1) - radius(i);
            counts.push(counts[i] + step / size(f64::midpoint(radius(i), radius(i + 1))));
        }
        // A value that is a whole number within rounding is that number, so that similar layers have as many.
        let count = (counts[STEPS] - 1e-9).ceil().max(least) as usize;
        let mut radii: Vec<f64> = (0..=count)
            .map(|k| {
                let wanted = counts[STEPS] * k as f64 / count as f64;
                let i = counts.partition_point(|c| *c < wanted).clamp(1, STEPS);
                let part = (wanted - counts[i - 1]) / (counts[i] - counts[i - 1]);
                radius(i - 1) + part * (radius(i) - radius(i - 1))
            })
            .collect();
        (radii[0], radii[count]) = (inner, outer);
        radii
    }

    /// The stiffness of one element on its inner circle, its middle and its outer circle.
    pub(super) fn element(&self, order: i64, ends: [f64; 2], axial: &AxialMatrices) -> Mat<c64> {
        let element = self.radial_element(order, ends, axial);
        let real = element.real();
        let imaginary = (self.twist != 0.0).then(|| element.imaginary());
        let functions = self.axial.len();
        let mut k = Mat::<c64>::zeros(real.nrows(), real.ncols());
        for j in 0..k.ncols() {
            let of_column = in_parts(j, functions).conj();
            for i in j..k.nrows() {
                let imaginary = imaginary.as_ref().map_or(0.0, |of| of[(i, j)]);
                k[(i, j)] = c64::new(real[(i, j)], imaginary) * in_parts(i, functions) * of_column;
            }
        }
        mirror_lower(&mut k);
        k
    }

    /// The stiffness of one element.
    fn radial_element<'a>(
        &self,
        order: i64,
        [from, to]: [f64; 2],
        axial: &'a AxialMatrices,
    ) -> RadialElement<'a> {
        let law = Law3::new(self.material);
        let n = order as f64;
        let [mut plain, mut mixed, mut slopes] = [Radial::zeros(); 3];
        let (middle, half) = (f64::midpoint(from, to), (to - from) / 2.0);
        for (x, w) in gauss_legendre(4) {
            let radius = middle + half * x;
            let weight = std::f64::consts::TAU * radius * w * half;
            let values = [x * (x - 1.0) / 2.0, 1.0 - x * x, x * (x + 1.0) / 2.0];
            let by_radius = [(x - 0.5) / half, -2.0 * x / half, (x + 0.5) / half];
            let (mut radial, mut along) = (RadialStrains::zeros(), RadialStrains::zeros());
            for (node, (value, by_radius)) in values.into_iter().zip(by_radius).enumerate() {
                let [r, t, z] = [3 * node, 3 * node + 1, 3 * node + 2];
                let around = n * value / radius;
                // Shears of the tangential direction are counted in parts of i too.
                radial[(0, r)] = by_radius;
                radial[(1, r)] = value / radius;
                radial[(1, t)] = -around;
                radial[(3, t)] = by_radius - value / radius;
                radial[(3, r)] = around;
                radial[(4, z)] = by_radius;
                radial[(5, z)] = around;
                along[(2, z)] = value;
                along[(4, r)] = value;
                along[(5, t)] = value;
            }
            let stressed = |strains: &RadialStrains| {
                let mut stresses = RadialStrains::zeros();
                for column in 0..9 {
                    let stress = law.stress(std::array::from_fn(|k| strains[(k, column)]));
                    for (k, stress) in stress.into_iter().enumerate() {
                        stresses[(k, column)] = stress * weight;
                    }
                }
                stresses
            };
            let by_slopes = stressed(&along);
            plain += radial.transpose() * stressed(&radial);
            mixed += radial.transpose() * by_slopes;
            slopes += along.transpose() * by_slopes;
        }
        let turn = n * self.twist;
        RadialElement {
            plain: plain + slopes * (turn * turn),
            mixed,
            slopes,
            turn,
            axial,
        }
    }
}

/// Schur complement of `k`, of which the lower triangle is read, on its last `kept` unknowns, the others free.
pub(crate) fn last_of<T: ComplexField>(k: &Mat<T>, kept: usize) -> Result<Mat<T>, FemError> {
    let free = k.nrows() - kept;
    let factor = Cholesky::new(k.submatrix(0, 0, free, free).to_owned()).ok_or(
        FemError::NotPositiveDefinite {
            part: "a ring",
            unknowns: free,
        },
    )?;
    let mut half = k.submatrix(free, 0, kept, free).adjoint().to_owned();
    factor.half_solve_in_place(half.as_mut());
    let mut last = k.submatrix(free, free, kept, kept).to_owned();
    subtract_product(&mut last, half.as_ref());
    Ok(last)
}

/// Adds `block` to `k` from the unknown `first` on.
pub(crate) fn add_block<T: ComplexField>(k: &mut Mat<T>, first: usize, block: &Mat<T>) {
    let size = block.nrows();
    let mut at = k.submatrix_mut(first, first, size, size);
    at += block;
}

/// Radii with the middle between each two.
fn with_middles(radii: &[f64]) -> Vec<f64> {
    let mut all = vec![radii[0]];
    for ends in radii.windows(2) {
        all.extend([f64::midpoint(ends[0], ends[1]), ends[1]]);
    }
    all
}

/// `k` with its blocks of `size` unknowns in another order.
fn in_order(k: &Mat<c64>, order: &[usize], size: usize) -> Mat<c64> {
    let place = |i: usize| order[i / size] * size + i % size;
    Mat::from_fn(k.nrows(), k.ncols(), |i, j| k[(place(i), place(j))])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(twist: f64, axial: &AxialBasis) -> Revolution<'_> {
        Revolution {
            material: &Material::STEEL,
            twist,
            axial,
            radii: [33e-3, 38e-3],
        }
    }

    #[test]
    fn rigid_motions_need_no_force() {
        let axial = AxialBasis::new(&[-10e-3, 10e-3], 8);
        let m = axial.len();
        for twist in [0.0, 8.55] {
            let i = c64::new(0.0, 1.0);
            let [one, none] = [1.0, 0.0].map(|x| c64::new(x, 0.0));
            // Order, and its amplitudes (radial, tangential, axial) at (r, z), of a shift along x, one along the axis, a turn about
            // the axis, and one about y: (z, 0, −x).
            type Motion = fn(f64, f64) -> [f64; 3];
            let motions: [(i64, Motion); 4] = [
                (1, |_, _| [0.5, 0.5, 0.0]),
                (0, |_, _| [0.0, 0.0, 1.0]),
                (0, |r, _| [0.0, r * 1e2, 0.0]),
                (1, |r, z| [50.0 * z, 50.0 * z, -50.0 * r]),
            ];
            for (order, of) in motions {
                let ports = ring(twist, &axial).on_both(order).expect("definite");
                let mut u = Mat::<c64>::zeros(6 * m, 1);
                for (circle, r) in [33e-3, 38e-3].into_iter().enumerate() {
                    for (z, w) in axial.rule(30) {
                        let turn = c64::new(0.0, order as f64 * twist * z).exp() * w;
                        let [radial, tangential, along] = of(r, z);
                        // Of e_x: u_r = cos φ, u_t = −sin φ.
                        let tangential = if order == 0 { one } else { i } * tangential;
                        for (p, f) in axial.values(z).into_iter().enumerate() {
                            for (c, u_c) in [one * radial, tangential, one * along]
                                .into_iter()
                                .enumerate()
                            {
                                u[((3 * circle + c) * m + p, 0)] += turn * u_c * f;
                            }
                        }
                    }
                }
                let force = &ports.stiffness * &u;
                let scale = ports.stiffness.norm_max() * u.norm_max();
                assert!(
                    force.norm_max() < 1e-9 * scale,
                    "order {order}, twist {twist}"
                );
                assert_ne!(u[(m, 0)] + u[(0, 0)] + u[(2 * m, 0)], none);
            }
        }
    }

    #[test]
    fn layers_one_upon_the_other_are_one_layer() {
        let axial = AxialBasis::new(&[-10e-3, -5e-3, 10e-3], 4);
        for order in [0, 1, 5, -5, 40] {
            let layer = |radii| Revolution {
                radii,
                ..ring(8.55, &axial)
            };
            let whole = layer([15e-3, 38e-3])
                .on_outer(order, None)
                .expect("definite");
            let below = layer([15e-3, 33e-3])
                .on_outer(order, None)
                .expect("definite");
            let above = ring(8.55, &axial);
            let stacked = above.on_outer(order, Some(&below)).expect("definite");
            // The elements are others, which an even pull hardly notices.
            let yields = |k: &Mat<c64>| {
                let mut load = Mat::<c64>::zeros(k.nrows(), 1);
                for (z, w) in axial.rule(30) {
                    for (p, f) in axial.values(z).into_iter().enumerate() {
                        load[(p, 0)] += c64::new(w * f, 0.0);
                    }
                }
                let mut half = load;
                Cholesky::new(k.clone())
                    .expect("definite")
                    .half_solve_in_place(half.as_mut());
                (half.adjoint() * &half)[(0, 0)].re
            };
            assert!(
                (yields(&whole) / yields(&stacked) - 1.0).abs() < 2e-4,
                "{order}"
            );
            let mut ports = above.on_both(order).expect("definite");
            add_block(&mut ports.stiffness, 0, &below);
            let joined = last_of(&ports.stiffness, ports.size).expect("definite");
            assert!((&joined - &stacked).norm_max() < 1e-9 * whole.norm_max());
        }
    }

    #[test]
    fn similar_layers_have_as_many_elements() {
        for radii in [[8e-3, 10e-3], [16e-3, 17e-3], [16e-3, 36e-3]] {
            for order in [0, 1, 4] {
                let counts = (1..400).map(|i| {
                    let scale = 0.013 * f64::from(i);
                    let axial = AxialBasis::new(&[-1.5e-3, 1.5e-3].map(|z| scale * z), 4);
                    let layer = Revolution {
                        radii: radii.map(|radius| scale * radius),
                        ..ring(0.0, &axial)
                    };
                    layer.elements(order).len()
                });
                let counts: Vec<usize> = counts.collect();
                assert!(
                    counts.iter().all(|count| *count == counts[0]),
                    "{order} {radii:?}"
                );
            }
        }
    }

    #[test]
    fn a_thin_plate_bends_as_one_of_many_layers_and_its_elements_do_not_hang_on_roundings() {
        let axial = AxialBasis::new(&[-1.5e-3, 1.5e-3], 4);
        let layer = |radii| Revolution {
            radii,
            ..ring(0.0, &axial)
        };
        // A pull along the axis, even over the width, on the outer circle.
        let yields = |k: &Mat<c64>| {
            let mut half = Mat::<c64>::zeros(k.nrows(), 1);
            for (p, even) in axial.even().into_iter().enumerate() {
                half[(2 * axial.len() + p, 0)] = c64::new(even, 0.0);
            }
            let factor = Cholesky::new(k.clone()).expect("definite");
            factor.half_solve_in_place(half.as_mut());
            (half.adjoint() * &half)[(0, 0)].re
        };
        for order in [0, 1, 4] {
            let whole = |scale: f64| layer([scale * 16e-3, scale * 36e-3]).on_outer(order, None);
            let one = yields(&whole(1.0).expect("definite"));
            let mut stacked = None;
            for i in 0..20 {
                let radii = [16e-3 + 1e-3 * f64::from(i), 17e-3 + 1e-3 * f64::from(i)];
                let next = layer(radii).on_outer(order, stacked.as_ref());
                stacked = Some(next.expect("definite"));
            }
            let many = yields(&stacked.expect("layers"));
            assert!((one / many - 1.0).abs() < 5e-3, "{order}: {one} {many}");
            for rounding in [-1e-15, 1e-15, 1e-12, -1e-12] {
                let other = yields(&whole(1.0 + rounding).expect("definite"));
                assert!((other / one - 1.0).abs() < 1e-8, "{order}: {one} {other}");
            }
        }
    }

    #[test]
    fn a_ring_is_as_stiff_in_a_turning_frame_as_in_a_still_one() {
        // A radial pull of order n, even over the width, on the outer circle of a ring whose inner circle is held.
        let axial = AxialBasis::new(&[-10e-3, 10e-3], 14);
        for order in [2, 10, 20] {
            let yields = |twist: f64| {
                let k = ring(twist, &axial).on_outer(order, None).expect("definite");
                let mut load = Mat::<c64>::zeros(k.nrows(), 1);
                for (z, w) in axial.rule(30) {
                    let turn = c64::new(0.0, order as f64 * twist * z).exp() * w;
                    for (p, f) in axial.values(z).into_iter().enumerate() {
                        load[(p, 0)] += turn * f;
                    }
                }
                let mut half = load;
                Cholesky::new(k)
                    .expect("definite")
                    .half_solve_in_place(half.as_mut());
                (half.adjoint() * &half)[(0, 0)].re
            };
            let (still, turning) = (yields(0.0), yields(8.55));
            assert!(
                (turning / still - 1.0).abs() < 1e-4,
                "{order}: {still} {turning}"
            );
        }
    }
}
