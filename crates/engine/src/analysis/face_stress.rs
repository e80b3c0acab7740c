//! The largest stresses at the roots of the teeth along their faces and at the edges of the holes across the web, position by position.

use std::f64::consts::TAU;
use std::sync::Arc;

use rayon::prelude::*;

use super::AnalysisError;
use super::blank_modes::of_modes;
use super::case::Faces;
use super::spun_pair::LoadsInside;
use super::stress::{GearPeaks, PeakStress, PositionPeaks, REACH, RootStress, largest, teeth_away};
use crate::assembly::{FaceCompliance, FaceComplianceSpec, FaceHoles, FaceRoots, PartError, Parts};
use crate::contact::face::FaceContact;
use crate::fem::surface::SurfaceStress;
use crate::gear::{Member, SolidPair};
use crate::run::Run;
use crate::vibration::rotation::PulledEdges;

/// Both gears of a pair, to be asked for the stresses at their roots and holes under a contact.
pub(super) struct FaceStressModel<'a> {
    pair: &'a SolidPair,
    yields: &'a [Arc<FaceCompliance>; 2],
    gears: [StressedFace; 2],
}

struct StressedFace {
    roots: Arc<FaceRoots>,
    /// `None` without holes.
    holes: Option<Arc<FaceHoles>>,
    /// How both move without load; empty at rest.
    resting: [Vec<Vec<f64>>; 2],
}

impl<'a> FaceStressModel<'a> {
    /// Stresses of the pair of `faces`, with the compliances `yields` and the `loads` inside its gears.
    pub(super) fn new(
        (faces, loads): (&'a Faces, [Option<LoadsInside>; 2]),
        yields: &'a [Arc<FaceCompliance>; 2],
        parts: &dyn Parts,
        run: &Run,
    ) -> Result<Self, AnalysisError> {
        let of = |member: Member| {
            let gear = faces.pair.gear(member);
            let spec = FaceComplianceSpec::new(gear, faces.resolution);
            let edges = match loads[member.index()] {
                Some(LoadsInside { support, amounts }) => {
                    let edges = PulledEdges::of(gear, support, amounts, run);
                    edges.map_err(|error| of_modes(error, member))?
                }
                None => PulledEdges::default(),
            };
            let made = || {
                let roots = parts.face_roots(&spec.stack(), run)?;
                let holes = parts.face_holes(&spec, run)?;
                let of_holes = holes.as_ref().map(|holes| holes.resting(&edges));
                Ok(StressedFace {
                    resting: [roots.resting(&edges), of_holes.unwrap_or_default()],
                    roots,
                    holes,
                })
            };
            let made = made().map_err(|error: PartError| error.of(member))?;
            Ok::<StressedFace, AnalysisError>(made)
        };
        let (driving, driven) = rayon::join(|| of(Member::Driving), || of(Member::Driven));
        Ok(Self {
            pair: &faces.pair,
            yields,
            gears: [driving?, driven?],
        })
    }

    /// The largest stresses of both gears under each of `contacts`.
    pub(super) fn under(
        &self,
        contacts: &[FaceContact],
        run: &Run,
    ) -> Result<Vec<PositionPeaks>, AnalysisError> {
        let each = contacts.par_iter().map(|contact| {
            run.check()?;
            Ok(Member::BOTH.map(|member| self.peaks(member, contact)))
        });
        each.collect()
    }

    fn peaks(&self, member: Member, contact: &FaceContact) -> GearPeaks {
        let g = member.index();
        let StressedFace {
            roots,
            holes,
            resting: [of_roots, of_holes],
        } = &self.gears[g];
        let loads: Vec<_> = contact
            .pressing(self.pair, member)
            .map(|(tooth, pressing)| roots.forces(tooth, pressing))
            .collect();
        let answer = roots.under(Some(&self.yields[g]), &loads);
        let answer = answer.beside(of_roots);
        let z = roots.tooth_count();
        let away = |tooth| teeth_away(tooth, loads.iter().map(|load| load.tooth()), z);
        let at = |tooth: usize, of: &SurfaceStress, stress: f64| PeakStress {
            stress,
            angle: TAU * tooth as f64 / z as f64 + of.angle,
            radius: of.place.norm(),
            z: Some(of.z),
        };
        let hole = holes.as_ref().map(|holes| {
            let answer = holes.under(&self.yields[g], &loads).beside(of_holes);
            let stresses = answer.stresses();
            largest(stresses.iter().map(|of| at(0, of, of.von_mises())))
        });
        let reached = (0..z).filter(|tooth| away(*tooth) <= REACH);
        let roots = reached.flat_map(|tooth| {
            let stresses = answer.stresses(tooth).into_iter();
            stresses.map(move |of| RootStress {
                peak: at(tooth, &of, of.von_mises()),
                principal: of.principal,
                // Where it is stretched more than pressed.
                in_mesh: of.edge == 0 && away(tooth) <= 1 && of.principal[0] > -of.principal[1],
            })
        });
        GearPeaks::of(&roots.collect::<Vec<_>>(), hole)
    }
}
