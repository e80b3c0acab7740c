//! The flexible method: both whole gears as finite elements, contact at every position (section 2 of the paper).

use super::curve_parts::CurveParts;
use super::found::Found;
use super::pair_contacts::ModeledPair;
use super::plan::{Pass, Sweep};
use super::setup::Setup;
use super::stress::{GearStresses, StressModel};
use super::under_load::curves;
use super::{Analysis, AnalysisError};
use crate::contact::{ContactCells, ContactSolution};

/// Computes the case of `setup` by the flexible method.
pub(super) fn solve(setup: Setup<'_>, pass: &Pass) -> Result<Analysis, AnalysisError> {
    let (case, run, sweep) = (setup.case, setup.run, &pass.curve);
    let pair = ModeledPair::new(setup, sweep.blanks)?;
    let stress = pass.stress.then(|| StressModel::new(&setup)).transpose()?;
    let stress = stress.as_ref().map(|model| model.loaded(run));
    let stress = stress.transpose()?;
    let find = |load: f64, sweep: &Sweep| match &stress {
        None => Ok::<_, AnalysisError>(pair.found(load, sweep)?.keeping(Vec::new())),
        Some(stress) => {
            let peaks = |cells: &ContactCells<'_>, solution: &ContactSolution| {
                stress.peaks(cells, solution)
            };
            let (contacts, peaks, stiffness) = setup.solved(&pair.model, load, sweep, peaks)?;
            Ok(Found::of_contacts((case, sweep), contacts, &stiffness).keeping(peaks))
        }
    };
    curves((case, pass), pair.degrees_of_freedom, run, |under| {
        let load = under.load;
        let found = find(load, sweep)?;
        let (parts, between) = under.parts(&found, &[], |further, _| find(load, further))?;
        let stresses = || {
            let between = (between.positions.as_slice(), between.kept.as_slice());
            GearStresses::of_positions(&found.kept, between)
        };
        Ok(CurveParts {
            stresses: pass.stress.then(stresses),
            ..parts
        })
    })
}

#[cfg(test)]
mod tests {
    use crate::analysis::case::tests::plain;
    use crate::analysis::{Model, SectionHoles, analyze};
    use crate::grid::GridLevel;
    use crate::library::Library;
    use crate::run::Run;
    use crate::touch::gap_profile::tests::undercut_pair;

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
