//! An elastic material.

use meshwright_engine::gear::Material;

use crate::declare::{absent, document, number};
use crate::units::{from_gpa, from_mpa};

document! {
    /// An isotropic elastic material. Default: steel.
    pub struct MaterialDocument as "Material", "Material" {
        /// Young's modulus E of teeth and blank.
        pub(crate) youngs_modulus_gpa: f64 =
            number("Young's modulus", "GPa", 0.1, 1_000.0).or(210.0),
        /// Poisson's ratio of teeth and blank.
        poisson_ratio: f64 = number("Poisson's ratio", "1", 0.0, 0.49).or(0.3),
        /// The density, for mass and inertia only.
        density_kg_m3: f64 = number("Density", "kg/m3", 10.0, 25_000.0).or(7850.0),
        /// The yield strength of the flanks. There is a warning of contact pressures beyond 1.67 times it (Tresca, line contact).
        yield_strength_mpa: Option<f64> = absent(
            number("Yield strength", "MPa", 0.1, 10_000.0),
            "a warning beyond 2 % of Young's modulus where that is above 60 GPa, and beyond 4 % below",
        ),
    }
}

impl MaterialDocument {
    /// The material of the engine.
    pub(super) fn data(&self) -> Material {
        Material {
            youngs_modulus: from_gpa(self.youngs_modulus_gpa),
            poisson_ratio: self.poisson_ratio,
            density: self.density_kg_m3,
            yield_strength: self.yield_strength_mpa.map(from_mpa),
        }
    }
}
