//! Material of a gear, and its constants in a plane state.

/// An isotropic, linearly elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus E in pascals.
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
    /// The density in kg/m³.
    pub density: f64,
    /// The yield strength σ_y in pascals, where it is known.
    pub yield_strength: Option<f64>,
}

/// Assumption of a plane problem across the face width.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PlaneState {
    /// No stress across the face width: a narrow gear.
    Stress,
    /// No strain across the face width: a wide gear.
    Strain,
}

impl Material {
    /// The steel of the paper's gears.
    pub const STEEL: Self = Self {
        youngs_modulus: 210e9,
        poisson_ratio: 0.3,
        density: 7850.0,
        yield_strength: None,
    };

    /// The largest pressure in pascals of a contact along a line under which the material stays elastic: 1.67 times its yield strength (Tresca's shear, which
    /// is largest 0.78 half-widths below the surface; Johnson, Contact Mechanics, 6.1). Where that is not known, 2 % of E for metals and 4 % for softer
    /// materials, about where hardened steel yields and where plastics bend their curve.
    pub fn elastic_contact_pressure(&self) -> f64 {
        const LINE_CONTACT: f64 = 1.67;
        const METAL_FROM: f64 = 60e9;
        let usual = if self.youngs_modulus > METAL_FROM {
            0.02
        } else {
            0.04
        };
        self.yield_strength
            .map_or(usual * self.youngs_modulus, |strength| {
                LINE_CONTACT * strength
            })
    }

    /// The shear modulus G = E/(2(1 + ν)) in pascals, the same in both plane states.
    pub fn shear_modulus(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// The modulus E' of a plane problem in pascals: E in plane stress, E/(1 − ν²) in plane strain.
    pub fn plane_modulus(&self, plane: PlaneState) -> f64 {
        match plane {
            PlaneState::Stress => self.youngs_modulus,
            PlaneState::Strain => self.youngs_modulus / (1.0 - self.poisson_ratio.powi(2)),
        }
    }

    /// The ratio ν' of a plane problem: ν in plane stress, ν/(1 − ν) in plane strain.
    pub fn plane_poisson_ratio(&self, plane: PlaneState) -> f64 {
        match plane {
            PlaneState::Stress => self.poisson_ratio,
            PlaneState::Strain => self.poisson_ratio / (1.0 - self.poisson_ratio),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    #[test]
    fn the_shear_modulus_is_the_same_in_both_plane_states() {
        // G = E'/(2(1 + ν')) in either state; only rounding is allowed for.
        for plane in [PlaneState::Stress, PlaneState::Strain] {
            let g = Material::STEEL.plane_modulus(plane)
                / (2.0 * (1.0 + Material::STEEL.plane_poisson_ratio(plane)));
            assert!((g / Material::STEEL.shear_modulus() - 1.0).abs() < 1e-14);
        }
    }
}
