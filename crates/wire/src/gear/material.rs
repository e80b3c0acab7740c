//! An elastic material: by its numbers, or by a name that says those that are not given.

use meshwright_engine::gear::Material;

use crate::declare::{Choice as _, ObjectReader, absent, document, number, word};
use crate::materials::{MaterialEntry, MaterialName};
use crate::units::{from_gpa, from_mpa};

document! {
    /// An isotropic elastic material. Default: steel. Numbers that are given beside a name hold in place of those of the name.
    pub struct MaterialDocument as "Material", "Material" {
        /// The material by its name: its numbers, from `GET /v1/materials`, stand for those that are not given here.
        name: Option<MaterialName> =
            absent(word("Material by name"), "the numbers alone").left_out(),
        /// Young's modulus E of teeth and blank.
        pub(crate) youngs_modulus_gpa: f64 =
            number("Young's modulus", "GPa", 0.1, 1_000.0)
                .or(210.0)
                .by_another(|material| Some(named(material)?.youngs_modulus_gpa)),
        /// Poisson's ratio of teeth and blank.
        poisson_ratio: f64 = number("Poisson's ratio", "1", 0.0, 0.49)
            .or(0.3)
            .by_another(|material| Some(named(material)?.poisson_ratio)),
        /// The density, for mass and inertia only.
        density_kg_m3: f64 = number("Density", "kg/m3", 10.0, 25_000.0)
            .or(7850.0)
            .by_another(|material| Some(named(material)?.density_kg_m3)),
        /// The yield strength of the flanks. There is a warning of contact pressures beyond 1.67 times it (Tresca, line contact).
        yield_strength_mpa: Option<f64> = absent(
            number("Yield strength", "MPa", 0.1, 10_000.0)
                .by_another(|material| Some(named(material)?.yield_strength_mpa)),
            "that of the name; without a name a warning beyond 2 % of Young's modulus where that is above 60 GPa, and beyond 4 % below",
        ),
        /// The thermal expansion for each kelvin, for gears that run warm.
        pub(crate) expansion_per_k: f64 = number("Thermal expansion", "1/K", 0.0, 1e-3)
            .or(11.5e-6)
            .by_another(|material| Some(named(material)?.expansion_per_k)),
        /// The tensile strength. A gear that its rotation and its press fit stretch beyond it is refused.
        pub(crate) tensile_strength_mpa: Option<f64> = absent(
            number("Tensile strength", "MPa", 0.1, 10_000.0),
            "gears at speed are not compared with it",
        ),
    }
}

/// The entry of the name that a material bears.
fn named(material: &ObjectReader<'_>) -> Option<&'static MaterialEntry> {
    let name = MaterialName::of_word(material.text(MaterialDocument::name.name)?)?;
    Some(MaterialEntry::of_name(name))
}

impl MaterialDocument {
    /// The same without its name, whose numbers are filled in.
    pub(crate) fn unnamed(self) -> Self {
        Self { name: None, ..self }
    }

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
