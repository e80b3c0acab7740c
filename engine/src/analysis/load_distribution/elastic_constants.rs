//! The elastic constants that the formulas need, and what a plane state makes of them.

use crate::analysis::PlaneState;

use super::quantity::{NotPositive, positive};

/// The elastic constants of an isotropic, linearly elastic material.
///
/// In a plane problem they enter as E' and ν': E and ν in plane stress (a narrow gear), E/(1 - ν²) and ν/(1 -
/// ν) in plane strain (a wide one). G is the same in both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticConstants {
    young_modulus: f64,
    poisson_ratio: f64,
}

/// A pair of elastic constants that no material of a gear has.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ElasticConstantsError {
    /// Young's modulus is not a positive number.
    #[error(transparent)]
    NotPositive(#[from] NotPositive),
    /// Poisson's ratio lies outside [0, 0.5).
    #[error("Poisson's ratio has to lie in [0, 0.5), not at {0}")]
    PoissonRatio(f64),
}

impl ElasticConstants {
    /// A material with `young_modulus` in Pa.
    ///
    /// # Errors
    ///
    /// [`ElasticConstantsError`] if the modulus is not positive or `poisson_ratio` is not in [0, 0.5).
    pub fn new(young_modulus: f64, poisson_ratio: f64) -> Result<Self, ElasticConstantsError> {
        positive("Young's modulus", young_modulus)?;
        if !(0.0..0.5).contains(&poisson_ratio) {
            return Err(ElasticConstantsError::PoissonRatio(poisson_ratio));
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

    /// Poisson's ratio ν.
    pub fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    /// The shear modulus G = E/(2(1 + ν)), in Pa; the same in both plane states.
    pub fn shear_modulus(&self) -> f64 {
        self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// The modulus E' of a plane problem: E in plane stress, E/(1 - ν²) in plane strain, in Pa.
    pub fn plane_modulus(&self, plane: PlaneState) -> f64 {
        match plane {
            PlaneState::Stress => self.young_modulus,
            PlaneState::Strain => self.young_modulus / (1.0 - self.poisson_ratio.powi(2)),
        }
    }

    /// The ratio ν' of a plane problem: ν in plane stress, ν/(1 - ν) in plane strain.
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
        // G = E'/(2(1 + ν')) in either state; only rounding is allowed for.
        let steel = ElasticConstants::new(210e9, 0.3).expect("steel is a material");
        for plane in [PlaneState::Stress, PlaneState::Strain] {
            let g = steel.plane_modulus(plane) / (2.0 * (1.0 + steel.plane_poisson_ratio(plane)));
            assert!((g / steel.shear_modulus() - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn constants_that_no_material_has_are_refused_with_their_value() {
        assert_eq!(
            ElasticConstants::new(210e9, 0.5),
            Err(ElasticConstantsError::PoissonRatio(0.5))
        );
        assert!(matches!(
            ElasticConstants::new(210e9, f64::NAN),
            Err(ElasticConstantsError::PoissonRatio(_))
        ));
        assert!(matches!(
            ElasticConstants::new(-1.0, 0.3),
            Err(ElasticConstantsError::NotPositive(NotPositive {
                value: -1.0,
                ..
            }))
        ));
        assert!(ElasticConstants::new(f64::INFINITY, 0.3).is_err());
    }
}
