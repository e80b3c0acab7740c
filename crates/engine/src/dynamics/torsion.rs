//! Gear bodies that turn in themselves: torsion along the radius, with the inertia where it is.
//!
//! In a ring of thickness t the torque M and the angle θ at the circular frequency ω obey
//!
//! dθ/dr = M/(2π G t r³), dM/dr = −ω² 2π ρ t r³ θ,
//!
//! with M the torque from outside.

use std::f64::consts::PI;

use super::bodies::BodyMode;

/// Steps of the classical Runge-Kutta method in a ring.
const STEPS: u32 = 16;

/// The step of the search for frequencies, over that of a shear wave whose length is 2π depths of the body, and the most of them.
const SEARCH: f64 = 0.02;
const MOST_STEPS: f64 = 5000.0;

/// A ring in which nothing changes with the radius. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    /// Where it begins and ends.
    pub radii: [f64; 2],
    /// How thick it is, along the axis and all around in the mean.
    pub thickness: f64,
    /// How many times as far as a ring of this thickness it twists.
    pub softer: f64,
}

impl Ring {
    /// The angle between its edges over the torque, times the shear modulus, in 1/m³.
    pub fn twist(&self) -> f64 {
        let [inner, outer] = self.radii;
        self.softer * (inner.powi(-2) - outer.powi(-2)) / (4.0 * PI * self.thickness)
    }

    /// Its part within `radius`.
    pub fn within(&self, radius: f64) -> Option<Self> {
        let [inner, outer] = self.radii;
        (inner < radius).then(|| Self {
            radii: [inner, outer.min(radius)],
            ..*self
        })
    }

    /// The polar inertia over the density, in m⁵.
    fn polar_moment(&self) -> f64 {
        let [inner, outer] = self.radii;
        PI / 2.0 * self.thickness * (outer.powi(4) - inner.powi(4))
    }
}

/// A gear body, from the bore outwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotor {
    /// Its rings, each of which begins where the last one ends.
    pub rings: Vec<Ring>,
    /// G in Pa.
    pub shear_modulus: f64,
    /// In kg/m³.
    pub density: f64,
    /// The polar inertia in kg m² that turns with the outer edge, which carries the teeth.
    pub outer: f64,
}

impl Rotor {
    /// The polar inertia of its rings in kg m².
    pub fn inertia_of_rings(&self) -> f64 {
        self.density * self.rings.iter().map(Ring::polar_moment).sum::<f64>()
    }

    /// The state at the outer edge with the bore held, at the circular frequency `omega`, for a torque of 1 at the bore.
    fn outer_edge(&self, omega: f64) -> Edge {
        let square = omega * omega;
        let mut state = [0.0, 1.0, 0.0, 0.0];
        for ring in &self.rings {
            let [inner, outer] = ring.radii;
            let step = (outer - inner) / f64::from(STEPS);
            let rate = |r: f64, [angle, torque, _, _]: [f64; 4]| {
                let solid = 2.0 * PI * ring.thickness * r.powi(3);
                let inertia = self.density * solid;
                [
                    ring.softer * torque / (self.shear_modulus * solid),
                    -square * inertia * angle,
                    inertia * angle * angle,
                    inertia * angle,
                ]
            };
            for i in 0..STEPS {
                let r = inner + step * f64::from(i);
                let on = |by: f64, k: [f64; 4]| [0, 1, 2, 3].map(|j| state[j] + by * step * k[j]);
                let first = rate(r, state);
                let second = rate(r + step / 2.0, on(0.5, first));
                let third = rate(r + step / 2.0, on(0.5, second));
                let fourth = rate(r + step, on(1.0, third));
                let mean =
                    [0, 1, 2, 3].map(|j| first[j] + 2.0 * (second[j] + third[j]) + fourth[j]);
                state = on(1.0 / 6.0, mean);
            }
        }
        let [angle, torque, mass, turn] = state;
        Edge {
            angle,
            torque: torque - square * self.outer * angle,
            mass: mass + self.outer * angle * angle,
            turn: turn + self.outer * angle,
        }
    }

    /// The modes in which it turns in itself with the bore held, of teeth that press at `radius` from the axis: those up to the circular frequency
    /// `highest`, the lowest whatever its frequency, and `most` of them.
    pub fn modes(&self, radius: f64, highest: f64, most: usize) -> Vec<BodyMode> {
        let waves = (self.shear_modulus / self.density).sqrt();
        let edges = self.rings.first().zip(self.rings.last());
        let depth = edges.map_or(0.0, |(first, last)| last.radii[1] - first.radii[0]);
        let step = SEARCH * waves / depth;
        let mut modes = Vec::new();
        let mut low = 0.0;
        let mut before = self.outer_edge(low).torque;
        while modes.len() < most && (modes.is_empty() || low < highest) && low < MOST_STEPS * step {
            let high = low + step;
            let after = self.outer_edge(high).torque;
            if before * after < 0.0 {
                let frequency = crate::root_finding::bisect(low, high, |omega| {
                    self.outer_edge(omega).torque * before > 0.0
                });
                if modes.is_empty() || frequency <= highest {
                    let edge = self.outer_edge(frequency);
                    let scale = edge.angle.signum() / edge.mass.sqrt();
                    modes.push(BodyMode {
                        frequency,
                        at_mesh: radius * scale * edge.angle,
                        turn: scale * edge.turn,
                    });
                }
            }
            (low, before) = (high, after);
        }
        modes
    }
}

/// The outer edge of a rotor that vibrates.
#[derive(Debug, Clone, Copy)]
struct Edge {
    /// Its angle.
    angle: f64,
    /// The torque that has to act on it from outside.
    torque: f64,
    /// ∫ θ² dJ.
    mass: f64,
    /// ∫ θ dJ.
    turn: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steel(rings: Vec<Ring>, outer: f64) -> Rotor {
        Rotor {
            rings,
            shear_modulus: 80e9,
            density: 7850.0,
            outer,
        }
    }

    #[test]
    fn a_disc_that_is_held_vibrates_at_the_zeros_of_a_bessel_function() {
        // θ = J_1(κr)/r in a disc down to a small bore: the outer edge is free of torque where J_2(κ r_o) = 0, with ω = κ √(G/ρ).
        let ring = |from: f64, to: f64| Ring {
            radii: [from, to],
            thickness: 0.01,
            softer: 1.0,
        };
        let rings = [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 0.03, 0.06, 0.1];
        let rings = rings.windows(2).map(|ends| ring(ends[0], ends[1]));
        let rotor = steel(rings.collect(), 0.0);
        let wave = (rotor.shear_modulus / rotor.density).sqrt() / 0.1;
        // The lowest is the turn about a bore that hardly holds it.
        let modes = rotor.modes(0.1, 12.0 * wave, 9);
        let found: Vec<f64> = modes
            .iter()
            .skip(1)
            .map(|mode| mode.frequency / wave)
            .collect();
        for (found, expected) in found.iter().zip([5.1356, 8.4172, 11.6198]) {
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
        }
        assert_eq!(found.len(), 3);
    }

    #[test]
    fn all_modes_yield_what_the_body_yields_to_a_torque_and_turn_with_its_inertia() {
        // Twist of a ring: (1/r_i² − 1/r_o²)/(4π G t). The remainder of the first 12 modes falls with the cube of their number.
        let rings = [(22e-3, 43e-3, 2e-3), (43e-3, 47e-3, 20e-3)];
        let twist: f64 = rings
            .iter()
            .map(|(inner, outer, thickness): &(f64, f64, f64)| {
                (inner.powi(-2) - outer.powi(-2)) / (4.0 * PI * 80e9 * thickness)
            })
            .sum();
        let rings = rings.map(|(inner, outer, thickness)| Ring {
            radii: [inner, outer],
            thickness,
            softer: 1.0,
        });
        let rotor = steel(rings.to_vec(), 2e-4);
        let modes = rotor.modes(47e-3, f64::INFINITY, 12);
        assert_eq!(modes.len(), 12);
        let yields: f64 = modes
            .iter()
            .map(|mode| (mode.at_mesh / mode.frequency).powi(2))
            .sum();
        assert!(
            (yields / (47e-3 * 47e-3 * twist) - 1.0).abs() < 1e-3,
            "{yields}"
        );
        let inertia = rotor.inertia_of_rings() + rotor.outer;
        let turned: f64 = modes.iter().map(|mode| mode.turn * mode.turn).sum();
        // The highest modes are integrated to 1e-4.
        assert!((turned / inertia - 1.0).abs() < 0.01, "{turned} {inertia}");
        // The first alone is the rim on its web, nearly: ω² = 1/(twist · J), J of rim, teeth and a part of the web.
        let rim = rotor.rings[1].polar_moment() * rotor.density + rotor.outer;
        let first = modes[0].frequency.powi(2) * twist * rim;
        assert!((0.9..1.0).contains(&first), "{first}");
    }
}
