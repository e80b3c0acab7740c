//! Forces that press flanks, on the nodes of a grid and on the functions over a flank.

use super::flank_fit::squares;
use crate::contact::face::NormalForce;
use crate::fem::axial::AxialBasis;
use crate::flank::polynomials::{OWN_DEGREE, up_the_flank};
use crate::gear::{Involute, Vector};
use crate::quadrature::parabola;

/// A flank that can be pressed: nodes in the section, functions across the face.
#[derive(Debug)]
pub(super) struct PressedFlank {
    pub(super) axial: AxialBasis,
    pub(super) flank: Involute,
    pub(super) roll_lengths: Vec<f64>,
}

/// Loads on the flank of one tooth, on its nodes and on the functions over it.
#[derive(Debug, Clone)]
pub struct FlankForces {
    pub(super) tooth: usize,
    /// Node by node, function by function.
    pub(super) nodal: Vec<f64>,
    pub(super) smooth: Vec<f64>,
    /// Where it acts: in the section, and how high.
    pub(super) places: Vec<(Vector, f64)>,
}

impl FlankForces {
    /// The loaded tooth.
    pub fn tooth(&self) -> usize {
        self.tooth
    }
}

impl PressedFlank {
    /// Loads on the flank of `tooth` from these forces.
    pub(super) fn forces(
        &self,
        tooth: usize,
        pressing: impl IntoIterator<Item = NormalForce>,
    ) -> FlankForces {
        let (m, last) = (self.axial.len(), self.roll_lengths.len() - 1);
        let mut forces = FlankForces {
            tooth,
            nodal: vec![0.0; m * self.roll_lengths.len()],
            smooth: vec![0.0; m * (OWN_DEGREE + 1)],
            places: Vec::new(),
        };
        let squares = squares(&self.roll_lengths);
        for NormalForce {
            roll_length,
            z,
            force,
        } in pressing
        {
            let s = roll_length.clamp(self.roll_lengths[0], self.roll_lengths[last]);
            forces.places.push((self.flank.point(s), z));
            let across = self.axial.values(z);
            let add = |to: &mut [f64], first: usize, share: f64| {
                for (to, across) in to[first * m..].iter_mut().zip(&across) {
                    *to += force * share * across;
                }
            };
            let after = self.roll_lengths.partition_point(|roll| *roll <= s);
            let first = 2 * ((after.max(1) - 1) / 2).min(last / 2 - 1);
            let shares = parabola([0, 1, 2].map(|i| self.roll_lengths[first + i]), s);
            for (i, share) in shares.into_iter().enumerate() {
                add(&mut forces.nodal, first + i, share);
            }
            let (up, _) = up_the_flank(squares, s, OWN_DEGREE);
            for (a, up) in up.into_iter().enumerate() {
                add(&mut forces.smooth, a, up);
            }
        }
        forces
    }
}
