//! The flexible method: both whole gears as finite elements, contact at every position (section 2 of the paper).

use super::case::StiffnessRule;
use super::curve_parts::CurveParts;
use super::evidence::Evidence;
use super::setup::Setup;
use super::stress::{GearStresses, PositionPeaks, StressModel};
use super::warning::{warn_of_tips, warnings};
use super::{Analysis, AnalysisError};
use crate::assembly::Blanks;
use crate::contact::positions::{contacts, contacts_keeping};
use crate::contact::{ContactCells, ContactSolution, MeshContact, PairModel};

/// Computes the case of `setup` by the flexible method.
pub(super) fn solve(setup: Setup<'_>) -> Result<Analysis, AnalysisError> {
    let case = setup.case;
    let (model, degrees_of_freedom) = setup.model(Blanks::Flexible)?;
    let positions = case.mesh_positions();
    let mut evidence = Evidence::new(degrees_of_freedom);
    let mut warnings = warnings(case);
    let stress = case.stress.then(|| StressModel::new(&setup)).transpose()?;
    let stress = stress.as_ref().map(|model| model.loaded(setup.run));
    let stress = stress.transpose()?;
    let peaks = |cells: &ContactCells<'_>, solution: &ContactSolution| {
        stress.as_ref().map(|pair| pair.peaks(cells, solution))
    };
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let solved = solved(&setup, &model, load, &positions, peaks)?;
        evidence.gather(&solved.contacts, load);
        warn_of_tips(&mut warnings, &solved.contacts);
        let peaks: Option<Vec<PositionPeaks>> = solved.kept.into_iter().collect();
        let parts = CurveParts {
            stresses: peaks.map(|peaks| GearStresses::of_positions(&peaks)),
            ..CurveParts::of_contacts(case, &solved.contacts, solved.stiffness)
        };
        curves.push(parts.into_curve(case, output_torque));
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings,
    })
}

/// The solved positions of one torque.
pub(super) struct Solved<T> {
    /// The contact at each.
    pub(super) contacts: Vec<MeshContact>,
    /// What was kept of each beside.
    pub(super) kept: Vec<T>,
    /// The tangent stiffness by the rule of the case.
    pub(super) stiffness: Vec<f64>,
}

/// Solves the positions of one torque and keeps of each what `keep` takes.
pub(super) fn solved<T: Send>(
    setup: &Setup<'_>,
    model: &PairModel,
    load: f64,
    positions: &[f64],
    keep: impl Fn(&ContactCells<'_>, &ContactSolution) -> T + Sync,
) -> Result<Solved<T>, AnalysisError> {
    let made = model.made(setup.deviations);
    let middle = contacts_keeping(made, load, positions, setup.run, keep)?;
    let (contacts, kept): (Vec<MeshContact>, Vec<T>) = middle.into_iter().unzip();
    let stiffness = match setup.case.resolution.stiffness {
        StiffnessRule::Tangent => contacts.iter().map(|contact| contact.stiffness).collect(),
        StiffnessRule::TorqueStep { fraction } => stepped(setup, model, load, fraction, positions)?,
    };
    Ok(Solved {
        contacts,
        kept,
        stiffness,
    })
}

/// The tangent stiffness by a central difference: δ at loads smaller and larger by `fraction`.
fn stepped(
    setup: &Setup<'_>,
    model: &PairModel,
    load: f64,
    fraction: f64,
    positions: &[f64],
) -> Result<Vec<f64>, AnalysisError> {
    let made = model.made(setup.deviations);
    let at = |factor: f64| contacts(made, load * factor, positions, setup.run);
    let (low, high) = (at(1.0 - fraction)?, at(1.0 + fraction)?);
    let rise = |(low, high): (&MeshContact, &MeshContact)| {
        high.transmission_error - low.transmission_error
    };
    let rises = low.iter().zip(&high).map(rise);
    Ok(rises.map(|rise| 2.0 * fraction * load / rise).collect())
}
