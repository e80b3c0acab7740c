//! The elastic constants that the formulas need, and the plane state they are used in.

use super::quantity::{NotPositive, positive};

/// What is assumed across the face width.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaneState {
    /// No stress along the axis: a narrow gear. The moduli are E and nu themselves.
    Stress,
    /// No strain along the axis: a wide gear. E becomes E/(1 - nu^2) and nu becomes nu/(1 - nu); G stays.
    Strain,
}

/// An isotropic, linearly elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    young_modulus: f64,
    poisson_ratio: f64,
}

/// A pair of elastic constants that no material of a gear has.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// Young's modulus is not a positive number.
    #[error(transparent)]
    NotPositive(#[from] NotPositive),
    /// Poisson's ratio lies outside [0, 0.5).
    #[error("Poisson's ratio has to lie in [0, 0.5), not at {0}")]
    PoissonRatio(f64),
}

impl Material {
    /// A material with `young_modulus` in Pa.
    ///
    /// # Errors
    ///
    /// [`MaterialError`] if the modulus is not positive or `poisson_ratio` is not in [0, 0.5).
    pub fn new(young_modulus: f64, poisson_ratio: f64) -> Result<Self, MaterialError> {
        positive("Young's modulus", young_modulus)?;
        if !(0.0..0.5).contains(&poisson_ratio) {
            return Err(MaterialError::PoissonRatio(poisson_ratio));
        }
        Ok(Self {
            young_modulus,
            poisson_ratio,
        })
    }

    /// Young's modulus E, in Pa.
    pub fn young_modulus(&self) -> f64 {
        self.young_modulus
    }

    /// Poisson's ratio nu.
    pub fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    /// The shear modulus G = E/(2(1 + nu)), in Pa; the same in both plane states.
    pub fn shear_modulus(&self) -> f64 {
        self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// The modulus E' of a plane problem: E in plane stress, E/(1 - nu^2) in plane strain, in Pa.
    pub fn plane_modulus(&self, plane: PlaneState) -> f64 {
        match plane {
            PlaneState::Stress => self.young_modulus,
            PlaneState::Strain => self.young_modulus / (1.0 - self.poisson_ratio.powi(2)),
        }
    }

    /// The ratio nu' of a plane problem: nu in plane stress, nu/(1 - nu) in plane strain.
    pub fn plane_poisson_ratio(&self, plane: PlaneState) -> f64 {
        match plane {
            PlaneState::Stress => self.poisson_ratio,
            PlaneState::Strain => self.poisson_ratio / (1.0 - self.poisson_ratio),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shear_modulus_is_the_same_in_both_plane_states() {
        // G = E'/(2(1 + nu')) in either state; only rounding is allowed for.
        let steel = Material::new(210e9, 0.3).expect("steel is a material");
        for plane in [PlaneState::Stress, PlaneState::Strain] {
            let g = steel.plane_modulus(plane) / (2.0 * (1.0 + steel.plane_poisson_ratio(plane)));
            assert!((g / steel.shear_modulus() - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn constants_that_no_material_has_are_refused_with_their_value() {
        assert_eq!(
            Material::new(210e9, 0.5),
            Err(MaterialError::PoissonRatio(0.5))
        );
        assert!(matches!(
            Material::new(210e9, f64::NAN),
            Err(MaterialError::PoissonRatio(_))
        ));
        assert!(matches!(
            Material::new(-1.0, 0.3),
            Err(MaterialError::NotPositive(NotPositive { value: -1.0, .. }))
        ));
        assert!(Material::new(f64::INFINITY, 0.3).is_err());
    }
}
