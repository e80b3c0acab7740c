//! An elastic material.

use meshwright_engine::gear::Material;
use serde::Serialize;

use crate::wire::quantity;
use crate::wire::schema::{self, documented};
use crate::wire::tree::ObjectReader;
use crate::wire::units::from_gpa;

/// An elastic material.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MaterialDocument {
    pub(in crate::wire) youngs_modulus_gpa: f64,
    poisson_ratio: f64,
    density_kg_m3: f64,
}

documented!(
    MaterialDocument,
    "Material",
    [],
    schema::object(
        "Material",
        "An isotropic elastic material. Default: steel.",
        vec![
            schema::number(&quantity::YOUNGS_MODULUS),
            schema::number(&quantity::POISSON_RATIO),
            schema::number(&quantity::DENSITY),
        ]
    )
);

impl MaterialDocument {
    pub(super) const STEEL: Self = Self {
        youngs_modulus_gpa: 210.0,
        poisson_ratio: 0.3,
        density_kg_m3: 7850.0,
    };

    pub(super) fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let youngs_modulus_gpa = reader.number(&quantity::YOUNGS_MODULUS, None);
        let poisson_ratio = reader.number(&quantity::POISSON_RATIO, None);
        let density_kg_m3 = reader.number(&quantity::DENSITY, None);
        reader.finish();
        Some(Self {
            youngs_modulus_gpa: youngs_modulus_gpa?,
            poisson_ratio: poisson_ratio?,
            density_kg_m3: density_kg_m3?,
        })
    }
    pub(super) fn data(&self) -> Material {
        Material {
            youngs_modulus: from_gpa(self.youngs_modulus_gpa),
            poisson_ratio: self.poisson_ratio,
            density: self.density_kg_m3,
        }
    }
}
