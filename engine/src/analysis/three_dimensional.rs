//! The method that sees the faces: both whole gears in three dimensions, contact along moving lines at every position.

use std::sync::Arc;

use faer::Mat;

use super::case::{Faces, StiffnessRule};
use super::curve::FaceLoad;
use super::curve_parts::CurveParts;
use super::evidence::Evidence;
use super::warning::{warn_of_corner, warn_of_tips, warnings};
use super::{Analysis, AnalysisError, Case};
use crate::assembly::{FaceResolution, FaceYield, FaceYieldSpec, Parts};
use crate::contact::MeshContact;
use crate::contact::face::{FaceContact, FaceModel, FlankYield};
use crate::gear::Member;
use crate::grid::GridLevel;
use crate::ring::teeth::FARTHEST_COUPLED;
use crate::run::Run;

/// The strips over which the face load factor is taken.
const STRIPS: usize = 10;

/// A tip corner is told of from this part of the load: one of many slices touches nearly always.
const TOLD: f64 = 0.005;

/// Computes `case` along its faces; at another grid `level` than its own with other polynomials across them, which tell the error.
pub(super) fn solve(
    case: &Case,
    level: GridLevel,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let Some(faces) = &case.faces else {
        return Err(AnalysisError::Discretization {
            member: Member::Driving,
            reason: "nothing is said of its extent along the axis".to_owned(),
        });
    };
    let (model, degrees_of_freedom) = model((case, faces), level, parts, run)?;
    let positions = case.mesh_positions();
    let mut evidence = Evidence::new(degrees_of_freedom);
    let mut warnings = warnings(case);
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let contacts = model.contacts(load, &positions, run)?;
        let stiffness = match case.resolution.stiffness {
            StiffnessRule::Tangent => contacts
                .iter()
                .map(|contact| contact.mesh.stiffness)
                .collect(),
            StiffnessRule::TorqueStep { fraction } => {
                let at = |factor: f64| model.contacts(load * factor, &positions, run);
                let (low, high) = (at(1.0 - fraction)?, at(1.0 + fraction)?);
                let rises = low
                    .iter()
                    .zip(&high)
                    .map(|(low, high)| high.mesh.transmission_error - low.mesh.transmission_error);
                rises.map(|rise| 2.0 * fraction * load / rise).collect()
            }
        };
        let meshes: Vec<MeshContact> = contacts
            .iter()
            .map(|contact| contact.mesh.clone())
            .collect();
        evidence.gather(&meshes, load);
        warn_of_tips(&mut warnings, &meshes);
        for member in Member::BOTH {
            let shares = contacts
                .iter()
                .map(|contact| contact.corner_shares[member.index()]);
            let largest = shares.fold(0.0, f64::max);
            if largest > TOLD {
                warn_of_corner(&mut warnings, member, largest);
            }
        }
        let parts = CurveParts {
            face: Some(face_load(faces, &contacts)),
            ..CurveParts::of_contacts(case, &meshes, stiffness)
        };
        curves.push(parts.into_curve(case, output_torque));
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings,
    })
}

/// The pair ready for contact, and its unknowns before condensation.
fn model(
    (case, faces): (&Case, &Faces),
    level: GridLevel,
    parts: &dyn Parts,
    run: &Run,
) -> Result<(FaceModel, u64), AnalysisError> {
    let finer = if level == case.resolution.grid { 0 } else { 2 };
    let resolution = FaceResolution {
        face_order: faces.resolution.face_order + finer,
        ..faces.resolution
    };
    let of = |member: Member| {
        let spec = FaceYieldSpec::new(faces.pair.gear(member), resolution);
        let made = parts.face_yield(&spec, run);
        made.map_err(|error| error.of(member))
    };
    let (driving, driven) = rayon::join(|| of(Member::Driving), || of(Member::Driven));
    let (driving, driven) = (driving?, driven?);
    let degrees_of_freedom = driving.degrees_of_freedom() + driven.degrees_of_freedom();
    let yields: [Arc<dyn FlankYield>; 2] = [driving, driven];
    let model = FaceModel::new(faces.pair.clone(), yields, faces.slices, FARTHEST_COUPLED);
    Ok((model, degrees_of_freedom))
}

impl FlankYield for FaceYield {
    fn basis_len(&self) -> usize {
        self.basis_len()
    }

    fn basis(&self, roll_length: f64, z: f64, row: &mut [f64]) {
        self.basis(roll_length, z, row);
    }

    fn smooth(&self, teeth: &[usize]) -> Mat<f64> {
        self.smooth(teeth)
    }
}

/// The load along the face in `contacts` at equally spaced positions.
fn face_load(faces: &Faces, contacts: &[FaceContact]) -> FaceLoad {
    let (width, count) = (faces.pair.common_face_width(), faces.slices);
    let strip = width / count as f64;
    let rows: Vec<Vec<f64>> = contacts
        .iter()
        .map(|contact| {
            let loads = contact.strips(width, count).into_iter();
            loads.map(|load| load / strip).collect()
        })
        .collect();
    let strips: Vec<Vec<f64>> = contacts
        .iter()
        .map(|contact| contact.strips(width, STRIPS))
        .collect();
    let strips = mean_row(&strips);
    let largest = strips.iter().copied().fold(0.0, f64::max);
    let all: f64 = strips.iter().sum();
    FaceLoad {
        heights: (0..count)
            .map(|i| (i as f64 + 0.5) * strip - 0.5 * width)
            .collect(),
        load: if faces.at_each_position {
            rows
        } else {
            vec![mean_row(&rows)]
        },
        face_load_factor: largest * STRIPS as f64 / all,
        load_centroid: contacts.iter().map(FaceContact::load_centroid).collect(),
    }
}

/// The mean of `rows`, entry by entry.
fn mean_row(rows: &[Vec<f64>]) -> Vec<f64> {
    let entries = rows.first().map_or(0, Vec::len);
    let mean = |i: usize| rows.iter().map(|row| row[i]).sum::<f64>() / rows.len() as f64;
    (0..entries).map(mean).collect()
}
