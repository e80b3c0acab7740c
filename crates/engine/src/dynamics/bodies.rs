//! Gear bodies that vibrate, on the spring of their mesh.
//!
//! A body turns by θ at its bore and moves beside that by its natural modes q_i, with the bore held. With modal masses of 1, the inertia J of all that
//! turns, the displacement φ_i of mode i at the mesh along the line of action, and its part λ_i = ∫ r u_t dm in a turn,
//!
//! J θ'' + Σ λ_i q_i'' = M,  λ_i θ'' + q_i'' + 2 ζ ω_i q_i' + ω_i² q_i = φ_i F,
//!
//! where the teeth move by r_b θ + Σ φ_i q_i. The table of force has Σ φ_i²/ω_i² in it, by which the modes yield to a force that stands still; the
//! teeth alone yield by so much less. The table knows no shafts and no supports ([`Mount`]): they add springs, and motions of the whole body.

use std::f64::consts::PI;

use nalgebra::{Cholesky, Complex, DMatrix, DVector, SymmetricEigen};

use super::mount::Mount;

/// The part of the largest natural frequency squared below which a motion is one without springs: both gears turning as one, or a body along its
/// axis.
const RIGID: f64 = 1e-12;

/// The part of the largest displacement of the teeth in a mode below which they stand still in it.
const FAINT: f64 = 1e-3;

/// The part of the largest displacement of the teeth, or of a damping, below which it is rounding.
const IDLE: f64 = 1e-9;

/// A natural mode of a body whose bore is held, with a modal mass of 1 kg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyMode {
    /// ω in rad/s.
    pub frequency: f64,
    /// φ in kg^(−1/2), positive where the teeth move with a turn of the bore.
    pub at_mesh: f64,
    /// λ in m kg^(1/2), by the same sign.
    pub turn: f64,
}

/// A gear body on its bore.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// The polar inertia in kg m² of all that turns with the gear, its own among it.
    pub inertia: f64,
    /// The base radius in m.
    pub base_radius: f64,
    /// Its modes.
    pub modes: Vec<BodyMode>,
    /// How its hub is carried.
    pub mount: Mount,
}

impl Body {
    /// The displacement over the force by which its modes yield, in m/N.
    pub fn compliance(&self) -> f64 {
        let each = self.modes.iter();
        each.map(|mode| (mode.at_mesh / mode.frequency).powi(2))
            .sum()
    }
}

/// Damping of two bodies and their mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// c of the mesh in N s/m, between the teeth.
    pub mesh: f64,
    /// ζ of the modes of the bodies, and of the bodies on their shafts and supports.
    pub bodies: f64,
}

/// Two bodies on the spring of their mesh, by their common modes p_j with modal masses of 1: p'' + D p' + Ω² p = Z f, under a force f on the teeth
/// beside that of the spring. The teeth come nearer by Z·p, the hubs by H·p, by their turns alone. Motions without springs are left out: no force between the
/// gears excites them.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupled {
    /// Ω in rad/s, rising.
    pub frequencies: Vec<f64>,
    /// D, symmetric.
    damping: DMatrix<f64>,
    /// Z in kg^(−1/2).
    pub(super) teeth: Vec<f64>,
    /// H in kg^(−1/2).
    pub(super) hubs: Vec<f64>,
    /// The stiffness of the spring in N/m.
    pub(super) stiffness: f64,
    /// Ω in rad/s of motions on supports that leave the teeth where they are and that damping does not reach: nothing excites them.
    idle: Vec<f64>,
}

impl Coupled {
    /// The driving and the driven body on teeth of this `stiffness` in N/m, without the compliance of the bodies' modes.
    ///
    /// Nothing where a body has less inertia than its modes move.
    pub fn new(bodies: &[Body; 2], stiffness: f64, damping: Damping) -> Option<Self> {
        let of_body = |body: &Body| 1 + body.modes.len() + body.mount.motions();
        let count = of_body(&bodies[0]) + of_body(&bodies[1]);
        let mut mass = DMatrix::<f64>::identity(count, count);
        let mut spring = DMatrix::<f64>::zeros(count, count);
        let mut damper = DMatrix::<f64>::zeros(count, count);
        let mut teeth = DVector::<f64>::zeros(count);
        let mut hubs = DVector::<f64>::zeros(count);
        let mut place = 2;
        for (body, (turn, sign)) in bodies.iter().zip([(0, 1.0), (1, -1.0)]) {
            mass[(turn, turn)] = body.inertia;
            teeth[turn] = sign * body.base_radius;
            hubs[turn] = teeth[turn];
            for mode in &body.modes {
                mass[(turn, place)] = mode.turn;
                mass[(place, turn)] = mode.turn;
                spring[(place, place)] = mode.frequency.powi(2);
                damper[(place, place)] = 2.0 * damping.bodies * mode.frequency;
                teeth[place] = sign * mode.at_mesh;
                place += 1;
            }
            if body.mount.is_elastic() {
                // The driven gear turns against z.
                let own = body.mount.matrices(body.inertia, sign, damping.bodies);
                let at = |i: usize| if i == 0 { turn } else { place + i - 1 };
                for (sum, own) in [&mut mass, &mut spring, &mut damper].into_iter().zip(&own) {
                    for i in 0..own.nrows() {
                        for j in 0..own.ncols() {
                            sum[(at(i), at(j))] = own[(i, j)];
                        }
                    }
                }
                if let Some(support) = &body.mount.support {
                    for approach in support.at_mesh {
                        teeth[place] = approach;
                        place += 1;
                    }
                }
            }
        }
        spring += stiffness * &teeth * teeth.transpose();
        damper += damping.mesh * &teeth * teeth.transpose();
        // With M = L Lᵀ the modes are those of L⁻¹ K L⁻ᵀ.
        let factor = Cholesky::new(mass)?.l();
        let half = factor.solve_lower_triangular(&spring)?;
        let whole = factor.solve_lower_triangular(&half.transpose())?;
        let eigen = SymmetricEigen::new(0.5 * (&whole + whole.transpose()));
        let shapes = factor
            .transpose()
            .solve_upper_triangular(&eigen.eigenvectors)?;
        let largest = eigen.eigenvalues.max();
        let mut order: Vec<usize> = (0..count)
            .filter(|&j| eigen.eigenvalues[j] > RIGID * largest)
            .collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let mut idle = Vec::new();
        if bodies.iter().any(|body| body.mount.support.is_some()) {
            let moved = (shapes.transpose() * &teeth).abs();
            let most = moved.max();
            let damped = shapes.transpose() * &damper * &shapes;
            let is_alone = |j: usize| {
                let beside = (0..count).filter(|i| *i != j).map(|i| damped[(i, j)].abs());
                beside.fold(0.0, f64::max) <= IDLE * damped[(j, j)]
            };
            order.retain(|&j| {
                let is_idle = moved[j] <= IDLE * most && is_alone(j);
                if is_idle {
                    idle.push(eigen.eigenvalues[j].sqrt());
                }
                !is_idle
            });
        }
        let shapes = shapes.select_columns(&order);
        let along = |vector: &DVector<f64>| (shapes.transpose() * vector).as_slice().to_vec();
        Some(Self {
            frequencies: order.iter().map(|&j| eigen.eigenvalues[j].sqrt()).collect(),
            damping: shapes.transpose() * damper * &shapes,
            teeth: along(&teeth),
            hubs: along(&hubs),
            stiffness,
            idle,
        })
    }

    /// The number of modes.
    pub fn count(&self) -> usize {
        self.frequencies.len()
    }

    /// The circular frequency at which the teeth move in their modes, in the mean over them.
    pub(super) fn at_teeth(&self) -> f64 {
        let both = || self.teeth.iter().zip(&self.frequencies);
        let all: f64 = both().map(|(z, omega)| (z * omega).powi(2)).sum();
        (all / both().map(|(z, _)| z * z).sum::<f64>()).sqrt()
    }

    /// The time in s in which the mode that decays most slowly falls by a factor e.
    pub(super) fn decay(&self) -> f64 {
        2.0 / self.damping.diagonal().min()
    }

    /// How large p and p' are where the approach of the teeth is as large as `u`.
    pub(super) fn scales(&self, u: f64) -> Vec<f64> {
        let most = self.teeth.iter().fold(0.0_f64, |most, z| most.max(z.abs()));
        let displacement = |z: &f64| u / z.abs().max(FAINT * most);
        let displacements = self.teeth.iter().map(displacement);
        let both = displacements.clone().zip(&self.frequencies);
        let velocities = both.map(|(p, omega)| p * omega);
        displacements.chain(velocities).collect()
    }

    /// The natural frequencies in Hz that the mesh excites: those of modes in which the teeth move.
    pub(super) fn excited_frequencies(&self) -> Vec<f64> {
        let most = self.teeth.iter().fold(0.0_f64, |most, z| most.max(z.abs()));
        let modes = self.frequencies.iter().zip(&self.teeth);
        let excited = modes.filter(|(_, z)| z.abs() > FAINT * most);
        excited.map(|(omega, _)| omega / (2.0 * PI)).collect()
    }

    /// The amplitude at the hubs over that of the static curve, at the circular frequency `omega`, of a mesh with a constant stiffness.
    pub fn gain(&self, omega: f64) -> f64 {
        let count = self.count();
        let dynamic = DMatrix::from_fn(count, count, |i, j| {
            let spring = if i == j {
                self.frequencies[i].powi(2) - omega * omega
            } else {
                0.0
            };
            Complex::new(spring, omega * self.damping[(i, j)])
        });
        let force = DVector::from_fn(count, |i, _| {
            Complex::new(self.stiffness * self.teeth[i], 0.0)
        });
        let moved = dynamic.lu().solve(&force);
        moved.map_or(f64::INFINITY, |moved| {
            let hubs = moved.iter().zip(&self.hubs);
            hubs.map(|(p, h)| p * *h).sum::<Complex<f64>>().norm()
        })
    }

    /// The matrix of p' and p'' over p and p', row by row.
    pub(super) fn rate(&self) -> DMatrix<f64> {
        let count = self.count();
        let mut rate = DMatrix::zeros(2 * count, 2 * count);
        for i in 0..count {
            rate[(i, count + i)] = 1.0;
            rate[(count + i, i)] = -self.frequencies[i].powi(2);
            for j in 0..count {
                rate[(count + i, count + j)] = -self.damping[(i, j)];
            }
        }
        rate
    }

    /// The natural frequencies in Hz, rising.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        let all = self.frequencies.iter().chain(&self.idle);
        let mut all: Vec<f64> = all.map(|omega| omega / (2.0 * PI)).collect();
        all.sort_by(f64::total_cmp);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NO_DAMPING: Damping = Damping {
        mesh: 0.0,
        bodies: 0.0,
    };

    /// A hub, a rim and the spring between them.
    pub(in crate::dynamics) fn hub_and_rim(hub: f64, rim: f64, spring: f64, radius: f64) -> Body {
        // With the hub held the rim moves by 1/√I for a modal mass of 1.
        Body {
            inertia: hub + rim,
            base_radius: radius,
            modes: vec![BodyMode {
                frequency: (spring / rim).sqrt(),
                at_mesh: radius / rim.sqrt(),
                turn: rim.sqrt(),
            }],
            mount: Mount::NONE,
        }
    }

    #[test]
    fn two_inertias_a_gear_vibrate_as_their_matrix_says() {
        // Hubs J, rims I, webs c, teeth k between rims alike on both sides: λ² J I − λ (J (c + 2 k r²) + I c) + 2 k r² c = 0 where both sides move against
        // each other, and λ = c (J + I)/(J I) where the teeth stand still.
        let (hub, rim, web, r, teeth) = (2e-4, 5e-4, 3e5, 0.04, 2e8);
        let body = hub_and_rim(hub, rim, web, r);
        assert!((body.compliance() * web / (r * r) - 1.0).abs() < 1e-14);
        let coupled = Coupled::new(&[body.clone(), body], teeth, NO_DAMPING).expect("bodies");
        let m = 2.0 * teeth * r * r;
        let (b, d) = (hub * (web + m) + rim * web, m * web);
        let root = (b * b - 4.0 * hub * rim * d).sqrt();
        let mut expected = [(b - root), (b + root), 2.0 * web * (hub + rim)]
            .map(|twice| (twice / (2.0 * hub * rim)).sqrt());
        expected.sort_by(f64::total_cmp);
        for (found, expected) in coupled.frequencies.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
        assert_eq!(coupled.count(), 3);
    }

    #[test]
    fn hubs_answer_a_static_curve_as_springs_and_masses_in_a_row() {
        // A rim on a web against a wall of infinite inertia: hub and rim alone, at the frequency ω. By hand: the teeth press with f = k (w − z), the rim
        // moves by z, −ω² J θ = M, web c between.
        let (hub, rim, web, r, teeth) = (2e-4, 5e-4, 3e5, 0.04, 2e8);
        let wall = Body {
            inertia: 1e12,
            base_radius: r,
            modes: Vec::new(),
            mount: Mount::NONE,
        };
        let body = hub_and_rim(hub, rim, web, r);
        let coupled = Coupled::new(&[body, wall], teeth, NO_DAMPING).expect("bodies");
        for omega in [1.0, 1e4, 3e4, 9e4] {
            let square = omega * omega;
            // Rows of hub and rim: c − ω² J, −c; −c, c − ω² I + k r²; force k r w on the rim.
            let (a, b) = (web - square * hub, web - square * rim + teeth * r * r);
            let expected = r * (teeth * r * web / (a * b - web * web)).abs();
            let found = coupled.gain(omega);
            assert!(
                (found / expected - 1.0).abs() < 1e-6,
                "{omega}: {found} {expected}"
            );
        }
    }

    #[test]
    fn a_body_without_the_inertia_of_its_modes_is_none() {
        let mut body = hub_and_rim(2e-4, 5e-4, 3e5, 0.04);
        body.inertia = 4e-4;
        let other = hub_and_rim(2e-4, 5e-4, 3e5, 0.04);
        assert_eq!(Coupled::new(&[body, other], 2e8, NO_DAMPING), None);
    }
}
