//! A shaft of one piece with its gear: solid to the axis, and held by forces on its section at both ends.
//!
//! Held at zero are the mean displacement of the section at each end, ∫ u dA, and its tilt, ∫ r u_z dA about each axis in it; and of the mean
//! rotation, ∫ r u_t dA/∫ r² dA, that of the ends through which the torque enters, in the mean over these. Forces that do work on such means
//! alone are even over the section; moments rise along it as bending leaves them, and the torque with the radius as torsion does. Order 0 has
//! the shift along the axis and the rotation, order 1 the other shifts and the tilts; all other orders meet the shape of the body alone.

use faer::{Mat, c64};

use super::revolution::{Revolution, add_block, last_of};
use crate::fem::FemError;
use crate::fem::dense::Cholesky;
use crate::gear::FaceEnds;
use crate::quadrature::gauss_legendre;

/// The part of a body of one piece with its shaft that is inside the radius of the shaft.
#[derive(Debug, Clone)]
pub(crate) struct SolidShaft<'a> {
    /// The shaft as a layer whose inner radius is 0.
    pub body: Revolution<'a>,
    /// The ends of it through which the torque enters, half of it each where it is both.
    pub torque_at: FaceEnds,
}

/// A mean over the section at one end or at both, which is held.
struct Held {
    /// Weight of each component.
    components: [c64; 3],
    /// The power of the radius by which it weighs them.
    power: i32,
    /// Weight of each function along the axis.
    along: Vec<f64>,
}

impl SolidShaft<'_> {
    /// The stiffness of `order`, 0 or more, on the circle around it.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`].
    pub(crate) fn on_outer(&self, order: i64) -> Result<Mat<c64>, FemError> {
        let size = self.body.size();
        let matrices = self.body.axial.matrices();
        let held = self.held(order);
        // The circle so far, and the forces of the held means.
        let kept = size + held.len();
        let mut carried: Option<Mat<c64>> = None;
        for ends in self.body.elements(order).windows(2) {
            let ends = [ends[0], ends[1]];
            let mut k = Mat::<c64>::zeros(2 * size + kept, 2 * size + kept);
            add_block(&mut k, 0, &self.body.element(order, ends, &matrices));
            for (row, held) in held.iter().enumerate() {
                for (at, value) in held.of_element(ends).into_iter().enumerate() {
                    k[(3 * size + row, at)] = value;
                    k[(at, 3 * size + row)] = value.conj();
                }
            }
            let joined = match &carried {
                None => self.around_axis(order, &k),
                Some(below) => {
                    let place = |i: usize| if i < size { i } else { 2 * size + i };
                    for j in 0..kept {
                        for i in 0..kept {
                            k[(place(i), place(j))] += below[(i, j)];
                        }
                    }
                    k
                }
            };
            carried = Some(last_of(&joined, kept)?);
        }
        let whole = carried.unwrap_or_else(|| Mat::zeros(kept, kept));
        let stiffness = whole.submatrix(0, 0, size, size).to_owned();
        if held.is_empty() {
            return Ok(stiffness);
        }
        // The held means move under their own forces, which are such that the means stay zero.
        let yields = -whole
            .submatrix(size, size, held.len(), held.len())
            .to_owned();
        let factor = Cholesky::new(yields).ok_or(FemError::NotPositiveDefinite {
            part: "a shaft",
            unknowns: held.len(),
        })?;
        let mut half = whole.submatrix(size, 0, held.len(), size).to_owned();
        factor.half_solve_in_place(half.as_mut());
        Ok(stiffness + half.adjoint() * &half)
    }

    /// Held means of `order`.
    fn held(&self, order: i64) -> Vec<Held> {
        let [none, one, i] = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(re, im)| c64::new(re, im));
        let [minus, plus] = self.body.axial.heights().map(|z| self.body.axial.values(z));
        let mean = |components: [c64; 3], power: i32, shares: [f64; 2]| Held {
            components,
            power,
            along: minus
                .iter()
                .zip(&plus)
                .map(|(f, g)| shares[0] * f + shares[1] * g)
                .collect(),
        };
        // Both ends together and against each other: two different stiffnesses of a thin disc.
        let both = |components: [c64; 3], power: i32| {
            [[1.0, 1.0], [-1.0, 1.0]].map(|shares| mean(components, power, shares))
        };
        match order {
            0 => {
                let shares = match self.torque_at {
                    FaceEnds::Both => [0.5, 0.5],
                    FaceEnds::Minus => [1.0, 0.0],
                    FaceEnds::Plus => [0.0, 1.0],
                };
                let mut held = vec![mean([none, one, none], 1, shares)];
                held.extend(both([none, none, one], 0));
                held
            }
            // A shift along x is u_r = cos φ, u_t = −sin φ: 1 and i.
            1 => [both([one, -i, none], 0), both([none, none, one], 1)]
                .into_iter()
                .flatten()
                .collect(),
            _ => Vec::new(),
        }
    }

    /// `k` of the innermost element, on the possible motions of its circles where the first is the axis: points of it move as one.
    fn around_axis(&self, order: i64, k: &Mat<c64>) -> Mat<c64> {
        let (size, functions) = (self.body.size(), self.body.axial.len());
        let [one, i] = [(1.0, 0.0), (0.0, 1.0)].map(|(re, im)| c64::new(re, im));
        let moves: &[(usize, c64)] = match order {
            0 => &[(2, one)],
            1 => &[(0, one), (1, i)],
            _ => &[],
        };
        let free = if moves.is_empty() { 0 } else { functions };
        let others = k.nrows() - size;
        let mut onto = Mat::<c64>::zeros(k.nrows(), free + others);
        for (component, value) in moves {
            for p in 0..functions {
                onto[(component * functions + p, p)] = *value;
            }
        }
        for j in 0..others {
            onto[(size + j, free + j)] = one;
        }
        onto.adjoint() * k * &onto
    }
}

impl Held {
    /// Weights of the unknowns of an element, whose circles are its ends and its middle.
    fn of_element(&self, [from, to]: [f64; 2]) -> Vec<c64> {
        let (middle, half) = (f64::midpoint(from, to), (to - from) / 2.0);
        let mut shares = [0.0; 3];
        for (x, w) in gauss_legendre(4) {
            let radius = middle + half * x;
            let weight = w * half * radius.powi(self.power + 1);
            let values = [x * (x - 1.0) / 2.0, 1.0 - x * x, x * (x + 1.0) / 2.0];
            for (share, value) in shares.iter_mut().zip(values) {
                *share += weight * value;
            }
        }
        let mut taken = Vec::with_capacity(9 * self.along.len());
        for share in shares {
            for component in self.components {
                taken.extend(self.along.iter().map(|along| component * (share * along)));
            }
        }
        taken
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::axial::AxialBasis;
    use crate::gear::Material;

    const RADIUS: f64 = 15e-3;

    fn shear_modulus() -> f64 {
        Material::STEEL.youngs_modulus / 2.6
    }

    fn stiffness(axial: &AxialBasis, order: i64, torque_at: FaceEnds) -> Mat<c64> {
        let body = Revolution {
            material: &Material::STEEL,
            twist: 0.0,
            axial,
            radii: [0.0, RADIUS],
        };
        let shaft = SolidShaft { body, torque_at };
        shaft.on_outer(order).expect("definite")
    }

    /// How the circle moves, on its functions, under a torque of 1 N m, even over the width.
    fn turned(stiffness: Mat<c64>, axial: &AxialBasis, radius: f64) -> Vec<f64> {
        let m = axial.len();
        let [low, high] = axial.heights();
        let mut moved = Mat::<c64>::zeros(3 * m, 1);
        for (p, even) in axial.even().into_iter().enumerate() {
            moved[(m + p, 0)] = c64::new(even / (radius * (high - low)), 0.0);
        }
        let factor = Cholesky::new(stiffness).expect("definite");
        factor.solve_in_place(moved.as_mut());
        assert!((0..m).all(|p| moved[(p, 0)].norm() + moved[(2 * m + p, 0)].norm() < 1e-16));
        (0..m).map(|p| moved[(m + p, 0)].re / radius).collect()
    }

    #[test]
    fn a_shaft_twists_by_saint_venants_law_towards_the_ends_that_take_its_torque() {
        // With the torque T even on its surface and κ = T/(G J b), J = π R⁴/2, the torque at z grows from an end without one as T (z − z_0)/b, and
        // u_t = r (ψ_0 + κ r²/8 − κ (z − z_0)²/2) with z_0 the end without torque, or the middle between two with half of it each. The mean
        // rotation, ∫ r u_t dA/∫ r² dA, is none where the torque enters: ψ_0 = κ l²/2 − κ R²/12 with l from z_0 to there.
        for (width, degree) in [(1e-3, 4), (20e-3, 8), (150e-3, 8)] {
            let half = width / 2.0;
            let axial = AxialBasis::new(&[-half, half], degree);
            let moment = std::f64::consts::PI * RADIUS.powi(4) / 2.0;
            let kappa = 1.0 / (shear_modulus() * moment * width);
            for (torque_at, from, length) in [
                (FaceEnds::Both, 0.0, half),
                (FaceEnds::Minus, half, width),
                (FaceEnds::Plus, -half, width),
            ] {
                let turned = turned(stiffness(&axial, 0, torque_at), &axial, RADIUS);
                let offset = kappa * (length * length / 2.0 + RADIUS.powi(2) / 24.0);
                for z in [-half, -0.4 * half, 0.0, 0.7 * half, half] {
                    let found: f64 = axial
                        .values(z)
                        .iter()
                        .zip(&turned)
                        .map(|(f, u)| f * u)
                        .sum();
                    let expected = offset - kappa * (z - from).powi(2) / 2.0;
                    assert!(
                        (found - expected).abs() < 3e-5 * offset,
                        "{width} {torque_at:?} {z}: {found:e} {expected:e}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_thin_blank_turns_around_its_shaft_by_the_closed_form_of_the_plane() {
        // φ(r) = T/(4 π G b) (4/(3 R²) − 1/r²) against the mean rotation of the section, to 1e-4.
        let (width, outer) = (0.05e-3, 47.5e-3_f64);
        let axial = AxialBasis::new(&[-width / 2.0, width / 2.0], 3);
        let ring = Revolution {
            material: &Material::STEEL,
            twist: 0.0,
            axial: &axial,
            radii: [RADIUS, outer],
        };
        let inverse = 4.0 / (3.0 * RADIUS.powi(2)) - 1.0 / outer.powi(2);
        let expected = inverse / (4.0 * std::f64::consts::PI * shear_modulus() * width);
        for torque_at in [FaceEnds::Both, FaceEnds::Minus, FaceEnds::Plus] {
            let shaft = stiffness(&axial, 0, torque_at);
            let whole = ring.on_outer(0, Some(&shaft)).expect("definite");
            let turned = turned(whole, &axial, outer);
            let at_middle: f64 = axial
                .values(0.0)
                .iter()
                .zip(&turned)
                .map(|(f, u)| f * u)
                .sum();
            assert!(
                (at_middle / expected - 1.0).abs() < 1e-4,
                "{torque_at:?}: {at_middle:e} {expected:e}"
            );
        }
    }

    #[test]
    fn a_shaft_holds_as_well_in_a_turning_frame_as_in_a_still_one_however_thin_and_long() {
        // Even pulls in each direction, and a torque.
        for (width, degree, twist) in [(16e-3, 14, 9.0), (0.01e-3, 4, 9.0), (0.6, 14, 0.3)] {
            let half = width / 2.0;
            let axial = AxialBasis::new(&[-half, half], degree);
            let m = axial.len();
            for order in 0..4 {
                let yields = |twist: f64| {
                    let body = Revolution {
                        material: &Material::STEEL,
                        twist,
                        axial: &axial,
                        radii: [0.0, RADIUS],
                    };
                    let torque_at = FaceEnds::Plus;
                    let stiffness = SolidShaft { body, torque_at }.on_outer(order);
                    let mut load = Mat::<c64>::zeros(3 * m, 3);
                    for (z, w) in axial.rule(30) {
                        let turn = c64::new(0.0, order as f64 * twist * z).exp() * w;
                        for (p, f) in axial.values(z).into_iter().enumerate() {
                            (0..3).for_each(|c| load[(c * m + p, c)] += turn * f);
                        }
                    }
                    let factor = Cholesky::new(stiffness.expect("definite")).expect("definite");
                    factor.half_solve_in_place(load.as_mut());
                    [0, 1, 2].map(|c| load.col(c).norm_l2().powi(2))
                };
                for (still, turning) in yields(0.0).into_iter().zip(yields(twist)) {
                    let off = turning / still - 1.0;
                    assert!(off.abs() < 1e-4, "{width} {order}: {still:e} {turning:e}");
                }
            }
        }
    }

    #[test]
    fn a_shaft_that_takes_its_torque_at_one_end_is_the_image_of_one_that_does_at_the_other() {
        let axial = AxialBasis::new(&[-8e-3, 8e-3], 6);
        let m = axial.len();
        for order in 0..4 {
            let [minus, plus] =
                [FaceEnds::Minus, FaceEnds::Plus].map(|ends| stiffness(&axial, order, ends));
            // Functions are even and odd in turn, and the component along the axis changes its sign.
            let sign = |i: usize| {
                if (i / m / 2 + i % m).is_multiple_of(2) {
                    1.0
                } else {
                    -1.0
                }
            };
            let image = Mat::from_fn(3 * m, 3 * m, |i, j| plus[(i, j)] * (sign(i) * sign(j)));
            assert!(
                (&minus - image).norm_max() < 1e-9 * minus.norm_max(),
                "{order}"
            );
        }
    }
}
