//! The projected decomposition: round blanks over one mesh period, plus the exact first-order term of the holes.

use std::sync::Arc;

use super::between::Sample;
use super::curve::{Curve, DecompositionParts};
use super::curve_parts::CurveParts;
use super::evidence::Evidence;
use super::first_order::{OnRound, WithHoles, with_holes};
use super::flexible::{self, Solved};
use super::pair_contacts::ModeledPair;
use super::plan::{Pass, Sweep};
use super::setup::Setup;
use super::warning::{warn_of_projection, warn_of_tips, warnings};
use super::{Analysis, AnalysisError, Case};
use crate::assembly::Blanks;
use crate::contact::positions::contacts;
use crate::contact::{ContactCells, ContactSolution, MeshContact, PairLoads, PairModel};
use crate::gear::{Member, teeth_on};

/// The models of a pair whose holed blanks are expanded about round ones.
struct Expansion<'a> {
    plan: &'a Pass,
    rigid: ModeledPair<'a>,
    /// The gears with holes.
    holed: Vec<Member>,
    /// Both gears as drawn.
    whole: PairModel,
    /// Both gears, the holed ones made alike all around.
    round: PairModel,
}

/// The exact first-order term of the holes, sidebands included ([`super::first_order`]).
///
/// H_0 is the mean of H over the teeth: the contact that it has repeats each mesh period and is solved over one. About the
/// rigid blank (H_0 of wh) the same term is exact too, but what it leaves out grows with the square of the blank's whole
/// compliance instead of its fluctuation: the peak-to-peak of cases 1 and 3 is then 8 % off.
pub(super) fn solve(setup: Setup<'_>, plan: &Pass) -> Result<Analysis, AnalysisError> {
    let case = setup.case;
    let rigid = ModeledPair::new(setup, Blanks::HoledRigid)?;
    let (whole, unknowns) = setup.model(plan.told.blanks)?;
    let mut evidence = Evidence::new(rigid.degrees_of_freedom.max(unknowns));
    let mut warnings = warnings(case);
    let holed = case.holed();
    let expansion = Expansion {
        plan,
        rigid,
        round: round_average(&whole, &holed),
        holed,
        whole,
    };
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let Projected {
            curve,
            contacts,
            error,
        } = expansion.curve(output_torque, &mut evidence)?;
        evidence.gather(&contacts, curve.load);
        let known = evidence.projection_error.unwrap_or(0.0);
        evidence.projection_error = Some(error.max(known));
        warn_of_tips(&mut warnings, &contacts);
        warn_of_projection(&mut warnings, error, &curve.transmission_error_statistics);
        curves.push(curve);
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings,
    })
}

/// What is found at some positions under one load.
struct Found {
    /// The contacts on round blanks.
    contacts: Vec<MeshContact>,
    round: Vec<OnRound>,
    /// δ and k at all places that they tell of.
    with_holes: WithHoles,
}

impl Found {
    /// What is known at the places in the curve of `case` that the positions of `sweep` tell of.
    fn samples(&self, case: &Case, sweep: &Sweep) -> Vec<Sample> {
        let WithHoles {
            transmission_error,
            stiffness,
        } = &self.with_holes;
        let places = case.places(&sweep.positions);
        Sample::of(&places, &self.contacts, transmission_error, stiffness)
    }
}

/// The curve at one torque.
struct Projected {
    curve: Curve,
    /// The contacts on round blanks behind it.
    contacts: Vec<MeshContact>,
    /// The largest difference to an exact solution, in meters.
    error: f64,
}

impl Expansion<'_> {
    fn curve(
        &self,
        output_torque: f64,
        evidence: &mut Evidence,
    ) -> Result<Projected, AnalysisError> {
        let case = self.rigid.setup.case;
        let load = case.pair.load(output_torque);
        let rigid = self.rigid.contacts(load, &self.plan.rigid.positions)?;
        let told = &self.plan.told;
        let found = self.found(load, told)?;
        let run = self.rigid.setup.run;
        let sections = told.sections(
            (case, case.contacts_repeat_after()),
            found.samples(case, told),
            run,
            |sweep| {
                let further = self.found(load, sweep)?;
                evidence.gather(&further.contacts, load);
                Ok(further.samples(case, sweep))
            },
        )?;
        let Found {
            contacts,
            round,
            with_holes,
        } = found;
        let error = self.error(load, &round, &with_holes.transmission_error)?;
        let of_rigid_blank = rigid.iter().map(|contact| contact.transmission_error);
        let parts = CurveParts {
            transmission_error: with_holes.transmission_error,
            stiffness: with_holes.stiffness,
            decomposition: Some(DecompositionParts {
                rigid_blank_transmission_error: case.repeated(of_rigid_blank),
                blanks: Vec::new(),
            }),
            ..CurveParts::of_repeating(case, &contacts, sections)
        };
        Ok(Projected {
            curve: parts.into_curve(case, output_torque),
            contacts,
            error,
        })
    }

    /// The contacts of `sweep` on round blanks under `load`, and what holes make of them.
    fn found(&self, load: f64, sweep: &Sweep) -> Result<Found, AnalysisError> {
        let setup = &self.rigid.setup;
        let keep = |cells: &ContactCells<'_>, solution: &ContactSolution| {
            cells.loads(&[&solution.forces, &solution.load_derivative])
        };
        let Solved {
            contacts,
            kept: loads,
            stiffness,
        } = flexible::solved(setup, &self.round, load, sweep, keep)?;
        let round: Vec<OnRound> = contacts
            .iter()
            .zip(&stiffness)
            .zip(&loads)
            .map(|((contact, &stiffness), pairs)| OnRound {
                transmission_error: contact.transmission_error,
                stiffness,
                // It is the same under every tooth.
                yielded: yielded(&self.round, &self.holed, pairs, 0),
            })
            .collect();
        let places = setup.case.places(&sweep.positions);
        let with_holes = with_holes(&places, &round, |place| {
            let period = place.position.floor() as i64;
            yielded(&self.whole, &self.holed, &loads[place.contact], period)
        });
        Ok(Found {
            contacts,
            round,
            with_holes,
        })
    }

    /// The largest difference between the projected `transmission_error` and the exact one at the positions that are checked, of what is
    /// known on `round` blanks.
    fn error(
        &self,
        load: f64,
        round: &[OnRound],
        transmission_error: &[f64],
    ) -> Result<f64, AnalysisError> {
        let Setup { case, run, .. } = self.rigid.setup;
        let stiffness: Vec<f64> = round.iter().map(|each| each.stiffness).collect();
        let places = self.plan.checks.places(case, &stiffness);
        let positions = case.mesh_positions();
        let positions: Vec<f64> = places.iter().map(|&place| positions[place]).collect();
        let made = self.whole.made(self.rigid.setup.deviations);
        let exact = contacts(made, load, &positions, run)?;
        Ok(places
            .iter()
            .zip(&exact)
            .map(|(&place, exact)| (transmission_error[place] - exact.transmission_error).abs())
            .fold(0.0, f64::max))
    }
}

/// The model whose `holed` blanks are alike all around.
fn round_average(whole: &PairModel, holed: &[Member]) -> PairModel {
    whole.with_couplings(|member, coupling| {
        if holed.contains(&member) {
            Arc::new(coupling.round_average())
        } else {
            Arc::clone(coupling)
        }
    })
}

/// qᵀ X p and qᵀ X q of `members` for the loads of `pairs` in the mesh period `period`: what their blanks yield.
fn yielded(model: &PairModel, members: &[Member], pairs: &[PairLoads], period: i64) -> [f64; 2] {
    let (mut forces, mut derivatives) = (0.0, 0.0);
    for &member in members {
        let g = member.index();
        for a in pairs {
            let tooth = model.pair.tooth(member, period + a.pair);
            let q = a.loads[g].col(1).transpose();
            for b in pairs {
                let offset = teeth_on(member, b.pair - a.pair);
                let (x, transposed) = model.gears[g].coupling.block(tooth, offset);
                let moved = if transposed {
                    x.transpose() * &b.loads[g]
                } else {
                    x * &b.loads[g]
                };
                forces += q * moved.col(0);
                derivatives += q * moved.col(1);
            }
        }
    }
    [forces, derivatives]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::case::tests::plain;
    use crate::analysis::{Model, SectionHoles};
    use crate::assembly::MakeAll;
    use crate::contact::{Stage, WarmStart};
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
            let mut stage =
                Stage::new(round.as_drawn(), eta, load).expect("flanks that face each other");
            let loads = |cells: &ContactCells<'_>, solution: &ContactSolution| {
                cells.loads(&[&solution.forces, &solution.load_derivative])
            };
            let (_, loads) = stage
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
