//! The material law: stress from strain.

use crate::gear::Material;

/// An isotropic law in the plane: σ_x = d ε_x + c ε_y, σ_y = c ε_x + d ε_y, τ = g γ, in Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Law {
    /// d: of the strain along.
    pub along: f64,
    /// c: of the strain across.
    pub across: f64,
    /// g: of the shear.
    pub shear: f64,
}

impl Law {
    /// Plane stress: E/(1 − ν²) [[1, ν, 0], [ν, 1, 0], [0, 0, (1 − ν)/2]].
    pub(crate) fn plane_stress(material: &Material) -> Self {
        let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
        let along = e / (1.0 - nu * nu);
        Self {
            along,
            across: along * nu,
            shear: e / (2.0 * (1.0 + nu)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_in_plane_stress_is_as_stiff_as_young_says_and_grows_thinner_as_poisson_says() {
        let material = Material::STEEL;
        let law = Law::plane_stress(&material);
        let (along, across) = (1e-3, -0.3e-3);
        assert!((law.along * along + law.across * across - 210e6).abs() < 1e-6);
        assert!((law.across * along + law.along * across).abs() < 1e-6);
        // Pure shear is tension and pressure under 45 degrees: d − c = 2 g.
        assert!((law.along - law.across - 2.0 * law.shear).abs() < 1e-4);
    }
}
