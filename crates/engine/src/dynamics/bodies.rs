//! Gear bodies that vibrate, on the spring of their mesh.
//!
//! A body turns by θ at its bore and moves beside that by its natural modes q_i, with the bore held. With modal masses of 1, the inertia J of all that
//! turns, the displacement φ_i of mode i at the mesh along the line of action, and its part λ_i = ∫ r u_t dm in a turn,
//!
//! J θ'' + Σ λ_i q_i'' = M,  λ_i θ'' + q_i'' + 2 ζ ω_i q_i' + ω_i² q_i = φ_i F,
//!
//! where the teeth move by r_b θ + Σ φ_i q_i. The table of force has Σ φ_i²/ω_i² in it, by which the modes yield to a force that stands still; the
//! teeth alone yield by so much less. The table knows no shafts and no supports ([`Mount`]): they add springs, and motions of the whole body.
//!
//! Other modes have n nodal diameters, and no part in a turn. The body turns by Ω, while the mesh stands still in space. There the two modes of one frequency
//! ([`BodyWave`]) have the coordinates P_1, which the mesh moves, and P_2, a quarter of a wave beside it:
//!
//! P_1'' + 2 ζ ω P_1' + 2 m P_2' + (ω² − m²) P_1 + 2 ζ ω n Ω P_2 = φ F,
//! P_2'' + 2 ζ ω P_2' − 2 m P_1' + (ω² − m²) P_2 − 2 ζ ω n Ω P_1 = 0,
//!
//! with m = (n − c) Ω. Their free motions are waves of the frequencies ω ± m. In the frame of the body these are the modes with Coriolis forces, to first order
//! in Ω/ω: of the terms with Ω² those are kept that make the waves of a rigid translation, c = n = 1, exact. Without a turn P_2 is at rest.

use std::f64::consts::PI;

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

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

/// Natural modes of a body whose bore is held, with modal masses of 1 kg and without a part in a turn: a cosine and a sine of one frequency, or one mode without
/// nodal diameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyWave {
    /// ω in rad/s, of the body at rest.
    pub frequency: f64,
    /// φ in kg^(−1/2): the displacement of the teeth along the line of action where it is largest around the gear.
    pub at_mesh: f64,
    /// n.
    pub diameters: u32,
    /// n − c.
    pub split: f64,
}

impl BodyWave {
    /// The number of its coordinates.
    fn count(&self) -> usize {
        if self.diameters == 0 { 1 } else { 2 }
    }
}

/// A gear body on its bore.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// The polar inertia in kg m² of all that turns with the gear, its own among it.
    pub inertia: f64,
    /// The base radius in m.
    pub base_radius: f64,
    /// The modes in which it turns in itself.
    pub modes: Vec<BodyMode>,
    /// Its other modes.
    pub waves: Vec<BodyWave>,
    /// How its hub is carried.
    pub mount: Mount,
}

impl Body {
    /// The displacement over the force by which its modes yield, in m/N.
    pub fn compliance(&self) -> f64 {
        self.each_mode()
            .map(|(frequency, at_mesh)| (at_mesh / frequency).powi(2))
            .sum()
    }

    /// Takes in those of `waves` by which it yields by `least` in m/N. Of more than `most` modes in all those by which it yields most stay, and the first in which
    /// it turns in itself.
    pub fn add_waves(&mut self, waves: &[BodyWave], (least, most): (f64, usize)) {
        let yielded = |frequency: f64, at_mesh: f64| (at_mesh / frequency).powi(2);
        let yields = |wave: &&BodyWave| yielded(wave.frequency, wave.at_mesh) >= least;
        self.waves = waves.iter().filter(yields).copied().collect();
        if self.waves.is_empty() {
            return;
        }
        let first = self.modes.first().copied();
        let beside = self.each_mode().skip(usize::from(first.is_some()));
        let mut all: Vec<f64> = beside.map(|(omega, phi)| yielded(omega, phi)).collect();
        all.sort_by(|one, other| other.total_cmp(one));
        let room = most.saturating_sub(usize::from(first.is_some()));
        if all.len() <= room {
            return;
        }
        // Those that yield as much as the first one that has no room go with it.
        let beyond = all[room];
        self.waves
            .retain(|wave| yielded(wave.frequency, wave.at_mesh) > beyond);
        self.modes.retain(|mode| {
            first.as_ref() == Some(mode) || yielded(mode.frequency, mode.at_mesh) > beyond
        });
    }

    /// ω and φ of each of its modes.
    fn each_mode(&self) -> impl Iterator<Item = (f64, f64)> {
        let modes = self.modes.iter();
        let waves = self.waves.iter();
        modes
            .map(|mode| (mode.frequency, mode.at_mesh))
            .chain(waves.map(|wave| (wave.frequency, wave.at_mesh)))
    }

    /// True if it is one mass that turns, and nothing else.
    pub(super) fn is_one_mass(&self) -> bool {
        self.modes.is_empty() && self.waves.is_empty() && !self.mount.is_elastic()
    }

    /// ω of the highest of its modes, 0 without any.
    pub(super) fn highest(&self) -> f64 {
        self.each_mode().map(|(omega, _)| omega).fold(0.0, f64::max)
    }

    /// Leaves out its modes from the circular frequency `limit` on.
    pub(super) fn keep_below(&mut self, limit: f64) {
        self.modes.retain(|mode| mode.frequency < limit);
        self.waves.retain(|wave| wave.frequency < limit);
    }

    /// The number of its coordinates.
    fn count(&self) -> usize {
        let waves: usize = self.waves.iter().map(BodyWave::count).sum();
        1 + self.modes.len() + waves + self.mount.motions()
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
    /// What rotation adds.
    turning: Option<Turning>,
    /// Ω in rad/s of motions on supports that leave the teeth where they are and that damping does not reach: nothing excites them.
    idle: Vec<f64>,
}

/// Forces on the common modes that rotation adds, while the driving gear turns by 1 rad/s.
#[derive(Debug, Clone, PartialEq)]
struct Turning {
    /// Over velocities, in proportion to the speed.
    gyroscopic: DMatrix<f64>,
    /// Over displacements, in proportion to the speed: damping that turns with the bodies.
    circulatory: DMatrix<f64>,
    /// Over displacements, in proportion to the square of the speed.
    softening: DMatrix<f64>,
}

impl Coupled {
    /// The driving and the driven body on teeth of this `stiffness` in N/m, without the compliance of the bodies' modes.
    ///
    /// Nothing where a body has less inertia than its modes move.
    pub fn new(bodies: &[Body; 2], stiffness: f64, damping: Damping) -> Option<Self> {
        let count = bodies[0].count() + bodies[1].count();
        let mut mass = DMatrix::<f64>::identity(count, count);
        let mut spring = DMatrix::<f64>::zeros(count, count);
        let mut damper = DMatrix::<f64>::zeros(count, count);
        let mut teeth = DVector::<f64>::zeros(count);
        let mut hubs = DVector::<f64>::zeros(count);
        let mut turning = Turning {
            gyroscopic: DMatrix::zeros(count, count),
            circulatory: DMatrix::zeros(count, count),
            softening: DMatrix::zeros(count, count),
        };
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
            // Teeth of both gears have the same speed on their pitch circles.
            let turns = bodies[0].base_radius / body.base_radius;
            for wave in &body.waves {
                let [first, second] = [place, place + 1];
                teeth[first] = sign * wave.at_mesh;
                for i in first..first + wave.count() {
                    spring[(i, i)] = wave.frequency.powi(2);
                    damper[(i, i)] = 2.0 * damping.bodies * wave.frequency;
                }
                if wave.count() == 2 {
                    let split = wave.split * turns;
                    let carried =
                        2.0 * damping.bodies * wave.frequency * f64::from(wave.diameters) * turns;
                    turning.gyroscopic[(first, second)] = 2.0 * split;
                    turning.gyroscopic[(second, first)] = -2.0 * split;
                    turning.circulatory[(first, second)] = carried;
                    turning.circulatory[(second, first)] = -carried;
                    turning.softening[(first, first)] = -split * split;
                    turning.softening[(second, second)] = -split * split;
                }
                place += wave.count();
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
            let beside = &damper + turning.gyroscopic.abs() + turning.circulatory.abs();
            let damped = shapes.transpose() * beside * &shapes;
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
        let between = |matrix: DMatrix<f64>| shapes.transpose() * matrix * &shapes;
        let has_waves = bodies.iter().any(|body| !body.waves.is_empty());
        Some(Self {
            frequencies: order.iter().map(|&j| eigen.eigenvalues[j].sqrt()).collect(),
            damping: between(damper),
            teeth: along(&teeth),
            hubs: along(&hubs),
            stiffness,
            turning: has_waves.then(|| Turning {
                gyroscopic: between(turning.gyroscopic),
                circulatory: between(turning.circulatory),
                softening: between(turning.softening),
            }),
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

    /// True if its free motions depend on the speed.
    pub(super) fn depends_on_speed(&self) -> bool {
        self.turning.is_some()
    }

    /// The matrix of p' and p'' over p and p', while the driving gear turns by `turn` rad/s.
    pub(super) fn rate(&self, turn: f64) -> DMatrix<f64> {
        let count = self.count();
        let mut velocities = self.damping.clone();
        let squares = self.frequencies.iter().map(|omega| omega * omega);
        let mut displacements = DMatrix::from_diagonal(&DVector::from_iterator(count, squares));
        if let Some(turning) = &self.turning {
            velocities += turn * &turning.gyroscopic;
            displacements += turn * &turning.circulatory + turn * turn * &turning.softening;
        }
        let mut rate = DMatrix::zeros(2 * count, 2 * count);
        for i in 0..count {
            rate[(i, count + i)] = 1.0;
            for j in 0..count {
                rate[(count + i, j)] = -displacements[(i, j)];
                rate[(count + i, count + j)] = -velocities[(i, j)];
            }
        }
        rate
    }

    /// The natural frequencies in Hz, rising, of bodies at rest. Equal ones of waves that the mesh does not move stand once.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        let all = self.frequencies.iter().chain(&self.idle);
        let mut all: Vec<f64> = all.map(|omega| omega / (2.0 * PI)).collect();
        all.sort_by(f64::total_cmp);
        if self.depends_on_speed() {
            all.dedup_by(|next, one| *next - *one < IDLE * *one);
        }
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
            waves: Vec::new(),
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
            waves: Vec::new(),
            mount: Mount::NONE,
        };
        let body = hub_and_rim(hub, rim, web, r);
        let coupled = Coupled::new(&[body, wall], teeth, NO_DAMPING).expect("bodies");
        for omega in [1.0, 1e4, 3e4, 9e4] {
            let square = omega * omega;
            // Rows of hub and rim: c − ω² J, −c; −c, c − ω² I + k r²; force k r w on the rim.
            let (a, b) = (web - square * hub, web - square * rim + teeth * r * r);
            let expected = r * (teeth * r * web / (a * b - web * web)).abs();
            let found = coupled.gain(omega, 0.0);
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
