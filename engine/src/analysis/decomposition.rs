//! The decomposition of the paper (section 3), and its projected form.
//!
//! Both start from "rigid blank" (paper: wh): every holed gear is rigid inside R_w, so that the contact repeats each mesh
//! period and is solved over one. They differ in what the holed blanks (paper: gb) add to it.

use std::f64::consts::PI;
use std::sync::Arc;

use super::case::{Case, StiffnessRule};
use super::curve::{BlankFit, BlankSample, DecompositionParts, Evidence, LoadShare};
use super::flexible::{self, Blanks, Solved};
use super::library::{Library, interface_radius};
use super::{Analysis, AnalysisError, CurveParts, Settings, mesh_positions, warnings};
use crate::contact::{ContactCells, ContactSolution, MeshContact, PairLoads, PairModel};
use crate::gear::{Member, teeth_on};
use crate::grid::GridLevel;
use crate::run::Run;

/// The torque step to either side, over the torque, with which the paper's route differentiates.
const TORQUE_STEP: f64 = 0.01;

/// Contact solutions that the decomposition of `case` needs.
pub(super) fn expected_positions(case: &Case) -> u64 {
    let samples = 2 * u64::from(case.resolution.blank_positions) * holed(case).len() as u64;
    3 * case.output_torques.len() as u64
        * (u64::from(case.resolution.positions_per_mesh_period) + samples)
}

fn holed(case: &Case) -> Vec<Member> {
    Member::BOTH
        .into_iter()
        .filter(|&member| case.pair.gear(member).holes().is_some())
        .collect()
}

/// One holed gear of the decomposition: the model in which its blank is flexible and the other holed one is not.
struct HoledBlank {
    member: Member,
    model: PairModel,
    interface_radius: f64,
}

/// Eqs. 9 to 15: δ = δ_wh + Σ over holed gears of A + B cos(N θ + phase), fitted to samples of the holed blank's rotation.
pub(super) fn decompose(
    case: &Case,
    settings: Settings,
    library: &Library,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let (rigid, mut degrees_of_freedom) =
        flexible::model(case, Blanks::HoledRigid, settings, library, run)?;
    let mut blanks = Vec::new();
    for member in holed(case) {
        let (model, unknowns) =
            flexible::model(case, Blanks::OnlyHoledOf(member), settings, library, run)?;
        degrees_of_freedom = degrees_of_freedom.max(unknowns);
        let interface_radius = interface_radius(case, member);
        blanks.push(HoledBlank {
            member,
            model,
            interface_radius,
        });
    }
    let mut evidence = Evidence::new(degrees_of_freedom);
    let mut warnings = warnings(case);
    let step = match case.resolution.stiffness {
        StiffnessRule::Tangent => TORQUE_STEP,
        StiffnessRule::TorqueStep { fraction } => fraction,
    };
    let base = RigidBlank {
        case,
        model: &rigid,
        level: settings.level,
        library,
        run,
    };
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let at = |load: f64| Terms::at(&base, &blanks, load);
        let (middle, low, high) = (
            at(load)?,
            at(load * (1.0 - step))?,
            at(load * (1.0 + step))?,
        );
        flexible::gather(&mut evidence, &middle.contacts, load);
        flexible::warn_of_tips(&mut warnings, &middle.contacts);
        let (below, above) = (low.transmission_error(case), high.transmission_error(case));
        let parts = CurveParts {
            transmission_error: middle.transmission_error(case),
            stiffness: below
                .iter()
                .zip(&above)
                .map(|(below, above)| 2.0 * step * load / (above - below))
                .collect(),
            decomposition: Some(DecompositionParts {
                rigid_blank_transmission_error: repeated(
                    case,
                    middle
                        .contacts
                        .iter()
                        .map(|contact| contact.transmission_error),
                ),
                blanks: middle.fits,
            }),
            ..repeated_contacts(case, &middle.contacts)
        };
        curves.push(parts.into_curve(case, output_torque, mesh_positions(case)));
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings,
    })
}

/// The pair with its holed blanks rigid (paper: wh), whose contacts all hole patterns on the same teeth share.
struct RigidBlank<'a> {
    case: &'a Case,
    model: &'a PairModel,
    level: GridLevel,
    library: &'a Library,
    run: &'a Run,
}

impl RigidBlank<'_> {
    fn contacts(
        &self,
        load: f64,
        positions: &[f64],
    ) -> Result<Arc<Vec<MeshContact>>, AnalysisError> {
        let mut solved = false;
        let solve = || {
            solved = true;
            flexible::contacts(self.model, load, positions, self.run)
        };
        let contacts = self
            .library
            .rigid_blank_contacts(self.case, self.level, load, positions, solve)?;
        if !solved {
            self.run.reached(positions.len() as u64)?;
        }
        Ok(contacts)
    }
}

/// The terms of eq. 15 at one load.
struct Terms {
    contacts: Arc<Vec<MeshContact>>,
    fits: Vec<BlankFit>,
}

impl Terms {
    fn at(base: &RigidBlank<'_>, blanks: &[HoledBlank], load: f64) -> Result<Self, AnalysisError> {
        let contacts = base.contacts(load, &one_mesh_period(base.case))?;
        let fits = blanks
            .iter()
            .map(|blank| blank.fit(base, load))
            .collect::<Result<_, _>>()?;
        Ok(Self { contacts, fits })
    }

    fn transmission_error(&self, case: &Case) -> Vec<f64> {
        let mut sum = repeated(
            case,
            self.contacts
                .iter()
                .map(|contact| contact.transmission_error),
        );
        for fit in &self.fits {
            let gear = case.pair.gear(fit.member);
            let n = gear.holes().map_or(0.0, |holes| f64::from(holes.count));
            for (delta, eta) in sum.iter_mut().zip(mesh_positions(case)) {
                // Eq. (13) has 2πθ and N; with θ in radians, a period of 2π/N is cos(Nθ).
                *delta +=
                    fit.mean + fit.amplitude * (n * eta * gear.pitch_angle() + fit.phase).cos();
            }
        }
        sum
    }
}

impl HoledBlank {
    /// Samples R_b θ_gb, the rotation of the hub that the holed blank adds (eqs. 11, 12 and 14), over one hole period, and
    /// fits eq. 13 to it.
    ///
    /// The interface displacement of the whole solution, less R_w times the rotation that wh has there, is imposed on the
    /// annulus, whose hub carries F R_b. Eq. 12 eliminates the inner unknowns only, so that all of the interface moves as
    /// it does in the whole solution: then the annulus is in the very state that it has there, and its hub turns by
    /// R_b θ_gb = δ_whole − δ_wh without a further solve. (With the tangential part imposed and the radial direction left
    /// free of traction the annulus is softer than in its gear: the rms of case 1 then falls 43 % short, where the paper
    /// has 8.5 %.)
    fn fit(&self, base: &RigidBlank<'_>, load: f64) -> Result<BlankFit, AnalysisError> {
        let gear = base.case.pair.gear(self.member);
        let count = base.case.resolution.blank_positions;
        let holes = gear.holes().map_or(1, |holes| holes.count);
        let period = f64::from(gear.tooth_count()) / f64::from(holes);
        let positions: Vec<f64> = (0..count)
            .map(|j| f64::from(j) * period / f64::from(count))
            .collect();
        let whole = flexible::contacts(&self.model, load, &positions, base.run)?;
        let without = base.contacts(load, &positions)?;
        let samples: Vec<BlankSample> = positions
            .iter()
            .zip(whole.iter().zip(without.iter()))
            .map(|(&mesh_position, (whole, without))| BlankSample {
                mesh_position,
                rotation: whole.transmission_error - without.transmission_error,
            })
            .collect();
        let (mut mean, mut cosine, mut sine) = (0.0, 0.0, 0.0);
        for (j, sample) in samples.iter().enumerate() {
            let (sin, cos) = (2.0 * PI * j as f64 / f64::from(count)).sin_cos();
            mean += sample.rotation / f64::from(count);
            cosine += 2.0 * sample.rotation * cos / f64::from(count);
            sine += 2.0 * sample.rotation * sin / f64::from(count);
        }
        let (amplitude, phase) = (cosine.hypot(sine), (-sine).atan2(cosine));
        Ok(BlankFit {
            member: self.member,
            interface_radius: self.interface_radius,
            mean,
            amplitude,
            phase,
            samples,
        })
    }
}

/// δ = δ_0 + qᵀ ΔH p and 1/k = 1/k_0 + qᵀ ΔH q with ΔH = H − H_0: the exact first-order term of the holes, sidebands
/// included, with the contact forces p and their derivative q = dp/dF of a blank that is alike all around.
///
/// H_0 is the mean of H over the teeth: the contact that it has repeats each mesh period and is solved over one. About the
/// rigid blank (H_0 of wh) the same term is exact too, but what it leaves out grows with the square of the blank's whole
/// compliance instead of its fluctuation: the peak-to-peak of cases 1 and 3 is then 8 % off.
pub(super) fn project(
    case: &Case,
    settings: Settings,
    library: &Library,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let (rigid, mut degrees_of_freedom) =
        flexible::model(case, Blanks::HoledRigid, settings, library, run)?;
    let (whole, unknowns) = flexible::model(case, Blanks::Flexible, settings, library, run)?;
    let round = round_average(&whole, case);
    let members = rounded(&round, &whole);
    degrees_of_freedom = degrees_of_freedom.max(unknowns);
    let mut evidence = Evidence::new(degrees_of_freedom);
    let mut warnings = warnings(case);
    let positions = mesh_positions(case);
    let period = one_mesh_period(case);
    let base = RigidBlank {
        case,
        model: &rigid,
        level: settings.level,
        library,
        run,
    };
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let without = base.contacts(load, &period)?;
        let keep = |cells: &ContactCells<'_>, solution: &ContactSolution| {
            cells.loads(&[&solution.forces, &solution.load_derivative])
        };
        let Solved {
            contacts,
            kept: loads,
            stiffness,
        } = flexible::solved(case, &round, load, &period, run, keep)?;
        flexible::gather(&mut evidence, &contacts, load);
        flexible::warn_of_tips(&mut warnings, &contacts);
        // What round blanks yield is the same in every period.
        let before: Vec<(f64, f64)> = loads
            .iter()
            .map(|pairs| yielded(&round, &members, pairs, 0))
            .collect();
        let (mut transmission_error, mut tangent) = (Vec::new(), Vec::new());
        for i in 0..positions.len() {
            let at = i % period.len();
            let after = yielded(&whole, &members, &loads[at], (i / period.len()) as i64);
            let (delta, compliance) = (after.0 - before[at].0, after.1 - before[at].1);
            transmission_error.push(contacts[at].transmission_error + delta);
            tangent.push(1.0 / (1.0 / stiffness[at] + compliance));
        }
        let parts = CurveParts {
            transmission_error,
            stiffness: tangent,
            decomposition: Some(DecompositionParts {
                rigid_blank_transmission_error: repeated(
                    case,
                    without.iter().map(|contact| contact.transmission_error),
                ),
                blanks: Vec::new(),
            }),
            ..repeated_contacts(case, &contacts)
        };
        curves.push(parts.into_curve(case, output_torque, positions.clone()));
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings,
    })
}

/// The model whose holed blanks are alike all around.
fn round_average(whole: &PairModel, case: &Case) -> PairModel {
    let mut round = whole.clone();
    for member in holed(case) {
        let gear = &mut round.gears[member.index()];
        gear.coupling = Arc::new(gear.coupling.round_average());
    }
    round
}

/// The members whose holed blanks `round` has made alike all around.
fn rounded(round: &PairModel, whole: &PairModel) -> Vec<Member> {
    let is_rounded = |member: &Member| {
        let g = member.index();
        !Arc::ptr_eq(&round.gears[g].coupling, &whole.gears[g].coupling)
    };
    Member::BOTH.into_iter().filter(is_rounded).collect()
}

/// qᵀ X p and qᵀ X q of `members` for the loads of `pairs` in the mesh period `period`: what their blanks yield.
fn yielded(model: &PairModel, members: &[Member], pairs: &[PairLoads], period: i64) -> (f64, f64) {
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
    (forces, derivatives)
}

/// The positions of one mesh period.
pub(super) fn one_mesh_period(case: &Case) -> Vec<f64> {
    let count = case.resolution.positions_per_mesh_period;
    (0..count)
        .map(|i| f64::from(i) / f64::from(count))
        .collect()
}

/// What holds over one mesh period, over the whole span.
pub(super) fn repeated<T: Clone>(case: &Case, period: impl Iterator<Item = T> + Clone) -> Vec<T> {
    period.cycle().take(case.positions()).collect()
}

/// Everything of the curve but δ and k, from contacts that repeat each mesh period.
fn repeated_contacts(case: &Case, contacts: &[MeshContact]) -> CurveParts {
    let shares = flexible::load_shares(&one_mesh_period(case), contacts);
    CurveParts {
        transmission_error: Vec::new(),
        stiffness: Vec::new(),
        pairs_in_contact: repeated(case, contacts.iter().map(MeshContact::loaded_pairs)),
        peak_contact_pressure: repeated(case, contacts.iter().map(|contact| contact.peak_pressure)),
        load_shares: shares
            .into_iter()
            .map(|LoadShare { pair_offset, share }| LoadShare {
                pair_offset,
                share: repeated(case, share.iter().copied()),
            })
            .collect(),
        decomposition: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::{
        BodyFormula, ContactSolver, Formulas, Method, PlaneState, Resolution, ToothFormula,
    };
    use crate::contact::{Stage, WarmStart};
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{GearPair, HolePattern, SpurGear};

    /// Holes in both gears, without relief, on coarse grids.
    fn holed_pair() -> Case {
        let mut data = paper_gear(50);
        data.blank.holes = Some(HolePattern {
            count: 8,
            circle_radius: 34e-3,
            radius: 8e-3,
            phase: 0.02,
        });
        let gear = SpurGear::new(data).expect("a gear that can be made");
        Case {
            pair: GearPair::new(gear.clone(), gear, 100.5e-3).expect("a pair that meshes"),
            method: Method::ProjectedDecomposition,
            output_torques: vec![115.0],
            resolution: Resolution {
                positions_per_mesh_period: 8,
                span_mesh_periods: None,
                grid: GridLevel::Coarse,
                contact_solver: ContactSolver::ActiveSet,
                stiffness: StiffnessRule::Tangent,
                blank_positions: 16,
                interface_radius: None,
                formulas: Formulas {
                    tooth: ToothFormula::WeberBanaschek,
                    body: BodyFormula::Sainsot,
                    plane_state: PlaneState::Stress,
                },
                error_estimate: false,
            },
            driving_speed: None,
        }
    }

    #[test]
    fn the_projected_term_is_the_derivative_of_the_transmission_error_to_the_holes() {
        // δ(H_0 + e ΔH) at e = ±1e-4: the central difference leaves its cubic term, and the changes of the active set.
        let case = holed_pair();
        let (whole, _) = flexible::model(
            &case,
            Blanks::Flexible,
            Settings {
                level: GridLevel::Coarse,
                farthest: 4,
            },
            &Library::default(),
            &Run::unattended(),
        )
        .expect("a model");
        let round = round_average(&whole, &case);
        let load = case.pair.load(115.0);
        let mixed = |share: f64| {
            let mut model = round.clone();
            for (gear, other) in model.gears.iter_mut().zip(&whole.gears) {
                gear.coupling = Arc::new(gear.coupling.mixed(&other.coupling, share));
            }
            model
        };
        let step = 1e-4;
        let (below, above) = (mixed(-step), mixed(step));
        for eta in [0.05, 0.3, 0.55, 0.9] {
            let at = |model: &PairModel| {
                model
                    .contact(eta, load, &mut WarmStart::default())
                    .expect("a contact")
                    .transmission_error
            };
            let mut stage = Stage::new(&round, eta, load).expect("flanks that face each other");
            let loads = |cells: &ContactCells<'_>, solution: &ContactSolution| {
                cells.loads(&[&solution.forces, &solution.load_derivative])
            };
            let (_, loads) = stage
                .contact(0, &mut WarmStart::default(), loads)
                .expect("a contact");
            let members = rounded(&round, &whole);
            let delta =
                yielded(&whole, &members, &loads, 0).0 - yielded(&round, &members, &loads, 0).0;
            let difference = (at(&above) - at(&below)) / (2.0 * step);
            assert!(
                (delta - difference).abs() < 1e-5 * difference.abs().max(1e-7),
                "{eta}: {delta} {difference}"
            );
        }
    }
}
