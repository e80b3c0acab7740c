//! The projected decomposition: round blanks over one mesh period, plus the exact first-order term of the holes.

use std::sync::Arc;

use super::curve::DecompositionParts;
use super::curve_parts::CurveParts;
use super::first_order::with_holes;
use super::pair_contacts::ModeledPair;
use super::plan::{Pass, Sweep};
use super::setup::Setup;
use super::under_load::curves;
use super::{Analysis, AnalysisError};
use crate::assembly::Blanks;
use crate::contact::positions::contacts;
use crate::contact::{ContactCells, ContactSolution, PairLoads, PairModel, add_yielded};
use crate::gear::Member;

/// The exact first-order term of the holes, sidebands included ([`super::first_order`]).
///
/// H_0 is the mean of H over the teeth: its contact repeats each mesh period and is solved over one. About the rigid blank (H_0 of wh) the same term is exact
/// too, but its remainder grows with the square of the blank's whole compliance instead of its fluctuation: the peak-to-peak of cases 1 and 3 is then 8 % off.
pub(super) fn solve(setup: Setup<'_>, pass: &Pass) -> Result<Analysis, AnalysisError> {
    let Setup { case, run, .. } = setup;
    let rigid = ModeledPair::new(setup, Blanks::HoledRigid)?;
    let (whole, unknowns) = setup.model(pass.curve.blanks)?;
    let holed = case.holed();
    let round = round_average(&whole, &holed);
    let unknowns = rigid.degrees_of_freedom.max(unknowns);
    curves((case, pass), unknowns, run, |under| {
        let load = under.load;
        let of_rigid = rigid.contacts(load, &pass.rigid.positions)?;
        let find = |sweep: &Sweep| {
            let keep = |cells: &ContactCells<'_>, solution: &ContactSolution| {
                cells.loads(&[&solution.forces, &solution.load_derivative])
            };
            let (contacts, loads, stiffness) = setup.solved(&round, load, sweep, keep)?;
            let found = with_holes(
                (case, sweep),
                (contacts, &stiffness),
                loads,
                // It is the same under every tooth.
                |pairs| yielded(&round, &holed, pairs, 0),
                |pairs, place| yielded(&whole, &holed, pairs, place.position.floor() as i64),
            );
            Ok(found.keeping(Vec::<()>::new()))
        };
        let found = find(&pass.curve)?;
        let (parts, _) = under.parts(&found, &[], |sweep, _| find(sweep))?;
        under.check(&found, |positions| {
            let exact =
                contacts(whole.deviating(setup.deviations), load, positions, run)?.into_iter();
            Ok(exact.map(|contact| contact.transmission_error).collect())
        })?;
        let of_rigid = of_rigid.iter().map(|contact| contact.transmission_error);
        Ok(CurveParts {
            decomposition: Some(DecompositionParts {
                rigid_blank_transmission_error: case.repeated(of_rigid),
                blanks: Vec::new(),
            }),
            ..parts
        })
    })
}

/// The model whose `holed` blanks are axisymmetric.
pub(super) fn round_average(whole: &PairModel, holed: &[Member]) -> PairModel {
    whole.with_couplings(|member, coupling| {
        if holed.contains(&member) {
            Arc::new(coupling.round_average())
        } else {
            Arc::clone(coupling)
        }
    })
}

/// qᵀ X p and qᵀ X q of `members` for the loads of `pairs` in the mesh period `period`: displacement by their blanks.
pub(super) fn yielded(
    model: &PairModel,
    members: &[Member],
    pairs: &[PairLoads],
    period: i64,
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for &member in members {
        add_yielded(&mut sums, member.index(), pairs, |a, b| {
            model.coupling(member, period, [a, b])
        });
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::case::tests::plain;
    use crate::analysis::{Case, Model, SectionHoles};
    use crate::assembly::MakeAll;
    use crate::contact::{MeshPhase, WarmStart};
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{GearPair, HolePattern, PairDeviations, SpurGear};
    use crate::grid::GridLevel;
    use crate::run::Run;

    /// Holes in both gears, without relief, on coarse grids.
    fn holed_pair() -> Case {
        let mut data = paper_gear(50);
        data.blank.holes = HolePattern {
            count: 8,
            circle_radius: 34e-3,
            radius: 8e-3,
            phase: 0.02,
        }
        .holes();
        let gear = SpurGear::new(data).expect("a gear that can be made");
        let pair = GearPair::new(gear.clone(), gear, 100.5e-3).expect("a pair that meshes");
        plain(pair, Model::Section(SectionHoles::FirstOrder), 115.0, 8)
    }

    #[test]
    fn the_projected_term_is_the_derivative_of_the_transmission_error_to_the_holes() {
        // δ(H_0 + e ΔH) at e = ±1e-4: the central difference leaves its cubic term, and the changes of the active set.
        let case = holed_pair();
        let run = Run::unattended();
        let as_drawn = PairDeviations::NONE;
        let setup = Setup::new((&case, &as_drawn), GridLevel::Coarse, 4, &MakeAll, &run);
        let (whole, _) = setup.model(Blanks::Flexible).expect("a model");
        let members = case.holed();
        let round = round_average(&whole, &members);
        let load = case.pair.load(115.0);
        let mixed = |share: f64| {
            round.with_couplings(|member, coupling| {
                Arc::new(coupling.mixed(&whole.gears[member.index()].coupling, share))
            })
        };
        let step = 1e-4;
        let (below, above) = (mixed(-step), mixed(step));
        for eta in [0.05, 0.3, 0.55, 0.9] {
            let at = |model: &PairModel| {
                model
                    .as_drawn()
                    .contact(eta, load, &mut WarmStart::default())
                    .expect("a contact")
                    .transmission_error
            };
            let mut phase =
                MeshPhase::new(round.as_drawn(), eta, load).expect("flanks that face each other");
            let loads = |cells: &ContactCells<'_>, solution: &ContactSolution| {
                cells.loads(&[&solution.forces, &solution.load_derivative])
            };
            let (_, loads) = phase
                .contact(0, &mut WarmStart::default(), loads)
                .expect("a contact");
            let delta =
                yielded(&whole, &members, &loads, 0)[0] - yielded(&round, &members, &loads, 0)[0];
            let difference = (at(&above) - at(&below)) / (2.0 * step);
            assert!(
                (delta - difference).abs() < 1e-5 * difference.abs().max(1e-7),
                "{eta}: {delta} {difference}"
            );
        }
    }
}
