//! Gear bodies that turn in themselves: torsion along the radius, with the inertia where it is.
//!
//! In a ring of thickness t the torque M and the angle θ at the circular frequency ω obey
//!
//! dθ/dr = M/(2π G t r³), dM/dr = −ω² 2π ρ t r³ θ,
//!
//! with M what acts from outside. At the bore M = −ω² J of what turns with it.

use std::f64::consts::PI;

/// Steps of the classical Runge-Kutta method in a ring.
const STEPS: u32 = 16;

/// By what the frequency grows from look to look, and how many times the one at which the search begins it may become.
const SEARCH: (f64, f64) = (1.005, 20.0);

/// A ring in which nothing changes with the radius. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    /// Where it begins and ends.
    pub radii: [f64; 2],
    /// How thick it is, along the axis and all around in the mean.
    pub thickness: f64,
}

impl Ring {
    /// The polar inertia over the density, in m⁵.
    fn polar_moment(&self) -> f64 {
        let [inner, outer] = self.radii;
        PI / 2.0 * self.thickness * (outer.powi(4) - inner.powi(4))
    }

    /// The angle between its edges over the torque, times the shear modulus, in 1/m³.
    fn twist(&self) -> f64 {
        let [inner, outer] = self.radii;
        (inner.powi(-2) - outer.powi(-2)) / (4.0 * PI * self.thickness)
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
    /// The polar inertia in kg m² of what turns with the inner edge.
    pub inner: f64,
    /// The polar inertia in kg m² of what turns with the outer edge, which carries the teeth.
    pub outer: f64,
}

impl Rotor {
    /// The polar inertia of its rings in kg m².
    pub fn inertia_of_rings(&self) -> f64 {
        self.density * self.rings.iter().map(Ring::polar_moment).sum::<f64>()
    }

    /// The angle of the outer edge against a held bore, over the torque, in rad/(N m).
    fn twist(&self) -> f64 {
        self.rings.iter().map(Ring::twist).sum::<f64>() / self.shear_modulus
    }

    /// The angle of the outer edge over the torque on it, in rad/(N m), at the circular frequency `omega`.
    fn receptance(&self, omega: f64) -> f64 {
        let square = omega * omega;
        let mut state = [1.0, -square * self.inner];
        for ring in &self.rings {
            let [inner, outer] = ring.radii;
            let step = (outer - inner) / f64::from(STEPS);
            let rate = |r: f64, [angle, torque]: [f64; 2]| {
                let solid = 2.0 * PI * ring.thickness * r.powi(3);
                [
                    torque / (self.shear_modulus * solid),
                    -square * self.density * solid * angle,
                ]
            };
            for i in 0..STEPS {
                let r = inner + step * f64::from(i);
                let on = |by: f64, k: [f64; 2]| [0, 1].map(|j| state[j] + by * step * k[j]);
                let first = rate(r, state);
                let second = rate(r + step / 2.0, on(0.5, first));
                let third = rate(r + step / 2.0, on(0.5, second));
                let fourth = rate(r + step, on(1.0, third));
                let mean = [0, 1].map(|j| first[j] + 2.0 * (second[j] + third[j]) + fourth[j]);
                state = on(1.0 / 6.0, mean);
            }
        }
        let [angle, torque] = state;
        angle / (torque - square * self.outer * angle)
    }
}

/// Two gear bodies on the spring of their mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupled {
    /// The driving and the driven one.
    pub rotors: [Rotor; 2],
    /// Their base radii in m.
    pub radii: [f64; 2],
    /// The stiffness of the mesh in N/m with both bores held, the twist of the bodies included.
    pub stiffness: f64,
}

impl Coupled {
    /// Their lowest natural frequency in Hz; `None` where what turns with a bore has less than no inertia, or the bodies are softer than the mesh is
    /// with them.
    pub fn natural_frequency(&self) -> Option<f64> {
        let both = || self.rotors.iter().zip(self.radii);
        if self.rotors.iter().any(|rotor| rotor.inner < 0.0) {
            return None;
        }
        let twist: f64 = both().map(|(rotor, r)| r * r * rotor.twist()).sum();
        let teeth = 1.0 / self.stiffness - twist;
        if teeth <= 0.0 {
            return None;
        }
        // It rises with the frequency, from below 0 to where a body resonates by itself.
        let closes = |omega: f64| {
            let bodies: f64 = both()
                .map(|(rotor, r)| r * r * rotor.receptance(omega))
                .sum();
            bodies + teeth
        };
        let inertia = |rotor: &Rotor| rotor.inner + rotor.inertia_of_rings() + rotor.outer;
        let masses: f64 = both().map(|(rotor, r)| r * r / inertia(rotor)).sum();
        // All inertia at the bores.
        let least = 0.5 * (self.stiffness * masses).sqrt();
        let (by, most) = SEARCH;
        let mut low = least;
        while closes(low * by) < 0.0 {
            low *= by;
            if low > most * least {
                return None;
            }
        }
        let found = crate::root_finding::bisect(low, low * by, |omega| closes(omega) < 0.0);
        Some(found / (2.0 * PI))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steel(rings: Vec<Ring>, inner: f64, outer: f64) -> Rotor {
        Rotor {
            rings,
            shear_modulus: 80e9,
            density: 7850.0,
            inner,
            outer,
        }
    }

    #[test]
    fn two_masses_a_side_on_springs_without_mass_vibrate_as_their_matrix_says() {
        // Bodies without density: hubs J, rims I, webs c, a mesh k; alike on both sides the mode is antisymmetric, with half of the mesh spring each:
        // the lowest λ of (J I) λ² − (J (c + 2 k r²) + I c) λ + 2 k r² c = 0.
        let (hub, rim, r, mesh) = (2e-4, 5e-4, 0.04, 2e8);
        let ring = Ring {
            radii: [0.02, 0.04],
            thickness: 1e-3,
        };
        let rotor = Rotor {
            density: 0.0,
            ..steel(vec![ring], hub, rim)
        };
        let c = 1.0 / rotor.twist();
        let stiffness = 1.0 / (1.0 / mesh + 2.0 * r * r / c);
        let m = 2.0 * mesh * r * r;
        let (b, d) = (hub * (c + m) + rim * c, m * c);
        let expected = ((b - (b * b - 4.0 * hub * rim * d).sqrt()) / (2.0 * hub * rim)).sqrt();
        let coupled = Coupled {
            rotors: [rotor.clone(), rotor],
            radii: [r; 2],
            stiffness,
        };
        let found = coupled.natural_frequency().expect("springs and masses");
        let expected = expected / (2.0 * PI);
        // The integration along the radius leaves 6e-8.
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }

    #[test]
    fn a_ring_that_is_held_rings_at_the_zeros_of_bessel_functions() {
        // θ = J_1(κr)/r in a disc down to a small bore: the outer edge stands still where J_1(κ r_o) = 0, at κ r_o = 3.8317, and is free of torque
        // where J_2(κ r_o) = 0, at 5.1356, with ω = κ √(G/ρ).
        let rotor = steel(
            vec![
                Ring {
                    radii: [1e-4, 5e-3],
                    thickness: 0.01,
                },
                Ring {
                    radii: [5e-3, 0.1],
                    thickness: 0.01,
                },
            ],
            0.0,
            0.0,
        );
        let wave = (rotor.shear_modulus / rotor.density).sqrt() / 0.1;
        let [before, after] = [0.999, 1.001].map(|by| rotor.receptance(3.8317 * by * wave));
        assert!(before < 0.0 && after > 0.0 || before > 0.0 && after < 0.0);
        assert!(before.abs().max(after.abs()) < 1e-9);
        let [before, after] = [0.999, 1.001].map(|by| 1.0 / rotor.receptance(5.1356 * by * wave));
        assert!(before * after < 0.0);
    }

    #[test]
    fn what_is_heavy_at_the_bore_leaves_the_mesh_and_the_bodies_in_series() {
        // Rims of little mass between great ones: √(k/m_e).
        let ring = Ring {
            radii: [0.02, 0.04],
            thickness: 0.02,
        };
        let rotor = steel(vec![ring], 1.0, 0.0);
        let coupled = Coupled {
            rotors: [rotor.clone(), rotor.clone()],
            radii: [0.045; 2],
            stiffness: 2e8,
        };
        let mass = (1.0 + rotor.inertia_of_rings()) / (2.0 * 0.045 * 0.045);
        let expected = (2e8 / mass).sqrt() / (2.0 * PI);
        let found = coupled.natural_frequency().expect("springs and masses");
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    }
}
