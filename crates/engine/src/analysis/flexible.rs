//! The flexible method: both whole gears as finite elements, contact at every position (section 2 of the paper).

use super::between::{Sample, Sections};
use super::case::Place;
use super::curve_parts::CurveParts;
use super::evidence::Evidence;
use super::pair_contacts::ModeledPair;
use super::plan::{Pass, Sweep};
use super::setup::Setup;
use super::stress::{GearStresses, PositionPeaks, StressModel};
use super::warning::{warn_of_tips, warnings};
use super::{Analysis, AnalysisError};
use crate::contact::positions::{contacts as contacts_at, contacts_keeping};
use crate::contact::{ContactCells, ContactSolution, MeshContact, PairModel};

/// Computes the case of `setup` by the flexible method.
pub(super) fn solve(setup: Setup<'_>, plan: &Pass) -> Result<Analysis, AnalysisError> {
    let case = setup.case;
    let pair = ModeledPair::new(setup, plan.told.blanks)?;
    let mut evidence = Evidence::new(pair.degrees_of_freedom);
    let mut warnings = warnings(case);
    let stress = plan.stress.then(|| StressModel::new(&setup)).transpose()?;
    let stress = stress.as_ref().map(|model| model.loaded(setup.run));
    let stress = stress.transpose()?;
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let solved: Solved<PositionPeaks> = match &stress {
            None => solved_once(&pair, load, &plan.told)?,
            Some(stress) => {
                let peaks = |cells: &ContactCells<'_>, solution: &ContactSolution| {
                    stress.peaks(cells, solution)
                };
                solved(&setup, &pair.model, load, &plan.told, peaks)?
            }
        };
        evidence.gather(&solved.contacts, load);
        warn_of_tips(&mut warnings, &solved.contacts);
        let sections = sections(&pair, load, &plan.told, &solved, &mut evidence)?;
        let parts = CurveParts {
            stresses: (plan.stress).then(|| GearStresses::of_positions(&solved.kept)),
            ..CurveParts::of_contacts(case, &solved.contacts, solved.stiffness, sections)
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

/// The curve through what was `solved` under one load, and through what is solved further between its positions.
fn sections<T>(
    pair: &ModeledPair<'_>,
    load: f64,
    told: &Sweep,
    solved_at_first: &Solved<T>,
    evidence: &mut Evidence,
) -> Result<Sections, AnalysisError> {
    let Setup { case, run, .. } = pair.setup;
    let after = case.curves_repeat_after();
    let samples = solved_at_first.samples(&case.places_after(&told.positions, case.span()));
    told.sections((case, after), samples, run, |sweep| {
        let further: Solved<()> = solved_once(pair, load, sweep)?;
        evidence.gather(&further.contacts, load);
        Ok(further.samples(&case.places_after(&sweep.positions, after)))
    })
}

impl<T> Solved<T> {
    /// What the `contacts` of `sweep` under `load` tell, with what was `kept` of them; `deltas` are those under another load.
    fn of(
        contacts: Vec<MeshContact>,
        kept: Vec<T>,
        (load, sweep): (f64, &Sweep),
        deltas: impl Fn(f64) -> Result<Vec<f64>, AnalysisError>,
    ) -> Result<Self, AnalysisError> {
        let of_contacts = || contacts.iter().map(|contact| contact.stiffness).collect();
        let stiffness = sweep.stiffness(load, of_contacts, deltas)?;
        Ok(Self {
            contacts,
            kept,
            stiffness,
        })
    }

    /// What is known at the `places` that they tell of.
    fn samples(&self, places: &[Place]) -> Vec<Sample> {
        let at = |place: &Place| self.contacts[place.contact].transmission_error;
        let deltas: Vec<f64> = places.iter().map(at).collect();
        let stiffness = places.iter().map(|place| self.stiffness[place.contact]);
        let stiffness: Vec<f64> = stiffness.collect();
        Sample::of(places, &self.contacts, &deltas, &stiffness)
    }
}

/// Solves `sweep` under one load and keeps nothing beside its contacts. Those of a drawn pair are asked for once: all members of a population are made
/// to one drawing, and no two of them alike.
fn solved_once<T>(
    pair: &ModeledPair<'_>,
    load: f64,
    sweep: &Sweep,
) -> Result<Solved<T>, AnalysisError> {
    let Setup {
        case,
        deviations,
        run,
        ..
    } = pair.setup;
    let at = |load: f64| -> Result<Vec<MeshContact>, AnalysisError> {
        if case.pair.is_as_drawn() {
            return Ok(pair.contacts(load, &sweep.positions)?.to_vec());
        }
        let made = pair.model.made(deviations);
        Ok(contacts_at(made, load, &sweep.positions, run)?)
    };
    Solved::of(at(load)?, Vec::new(), (load, sweep), |load| {
        let deltas = at(load)?.into_iter();
        Ok(deltas.map(|contact| contact.transmission_error).collect())
    })
}

/// Solves `sweep` under one load and keeps of each contact what `keep` takes.
pub(super) fn solved<T: Send>(
    setup: &Setup<'_>,
    model: &PairModel,
    load: f64,
    sweep: &Sweep,
    keep: impl Fn(&ContactCells<'_>, &ContactSolution) -> T + Sync,
) -> Result<Solved<T>, AnalysisError> {
    let made = model.made(setup.deviations);
    let middle = contacts_keeping(made, load, &sweep.positions, setup.run, keep)?;
    let (contacts, kept): (Vec<MeshContact>, Vec<T>) = middle.into_iter().unzip();
    Solved::of(contacts, kept, (load, sweep), |load| {
        let contacts = contacts_at(made, load, &sweep.positions, setup.run)?.into_iter();
        Ok(contacts.map(|contact| contact.transmission_error).collect())
    })
}

#[cfg(test)]
mod tests {
    use crate::analysis::case::tests::plain;
    use crate::analysis::{Model, SectionHoles, analyze};
    use crate::contact::facing::tests::undercut_pair;
    use crate::grid::GridLevel;
    use crate::library::Library;
    use crate::run::Run;

    #[test]
    fn the_corner_of_an_undercut_flank_takes_up_load_before_its_path_of_contact_begins() {
        let case = |grid| {
            let mut case = plain(
                undercut_pair(),
                Model::Section(SectionHoles::Whole),
                8.0,
                40,
            );
            case.resolution.grid = grid;
            case
        };
        let solved =
            |grid| analyze(&case(grid), &Library::default(), &Run::unattended()).expect("solves");
        let [coarse, standard] = [GridLevel::Coarse, GridLevel::Standard].map(solved);
        let [curve, coarse] = [&standard, &coarse].map(|solved| &solved.curves[0]);
        let entering = curve.load_shares.iter().find(|pair| pair.pair_offset == 1);
        let share = &entering.expect("the next pair carries too").share;
        // By its path of contact the next pair takes up load at the mesh position 0.59; at 0.45 it carries a quarter on its corner, at which pressure has no limit.
        assert!(share[18] > 0.2 && share[18] < 0.3, "{}", share[18]);
        assert_eq!(curve.peak_contact_pressure[18], None);
        let largest = curve.transmission_error.iter().copied().fold(0.0, f64::max);
        // The levels differ as they do elsewhere.
        for (one, other) in curve
            .transmission_error
            .iter()
            .zip(&coarse.transmission_error)
        {
            assert!((one - other).abs() < 1e-2 * largest);
        }
    }
}
