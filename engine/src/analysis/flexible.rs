//! The flexible method: both whole gears as finite elements, contact at every position (section 2 of the paper).

use rayon::prelude::*;

use super::case::{Case, StiffnessRule};
use super::curve::{Evidence, LoadShare, Warning};
use super::library::{GearParts, Library, interface_radius};
use super::{AnalysisError, Settings, cells_per_patch};
use crate::contact::{
    ContactCells, ContactSolution, GearModel, MeshContact, PairModel, PositionError, Stage,
    WarmStart,
};
use crate::gear::Member;
use crate::run::Run;

/// Stages that one thread solves in a row, each starting from the last; fixed, so that results do not depend on threads.
const CHUNK: usize = 5;

/// Fractions of the mesh period that differ by less are one: far above their rounding, far below any step.
const SAME_FRACTION: f64 = 1e-9;

/// Which blanks take part in a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Blanks {
    /// Both, as drawn.
    Flexible,
    /// Those without holes; holed ones are rigid inside R_w (paper: wh).
    HoledRigid,
    /// As [`Blanks::HoledRigid`], but the holed blank of one gear takes part.
    OnlyHoledOf(Member),
}

/// The model of `case`, and its unknowns before condensation.
pub(super) fn model(
    case: &Case,
    blanks: Blanks,
    settings: Settings,
    library: &Library,
    run: &Run,
) -> Result<(PairModel, u64), AnalysisError> {
    let Settings { level, farthest } = settings;
    let gears = Member::BOTH.map(|member| {
        let gear = case.pair.gear(member);
        GearParts {
            gear,
            member,
            interface_radius: interface_radius(case, member),
            with_blank: gear.holes().is_none()
                || blanks == Blanks::Flexible
                || blanks == Blanks::OnlyHoledOf(member),
        }
    });
    library.prepare(&gears, settings, run)?;
    let build = |of: GearParts<'_>| -> Result<(GearModel, u64), AnalysisError> {
        let (gear, member, radius) = (of.gear, of.member, of.interface_radius);
        let teeth = library.teeth(gear, member, radius, level, run)?;
        if of.with_blank {
            let whole = library.gear(gear, member, radius, level, farthest, run)?;
            Ok((
                GearModel {
                    flank: teeth.flank.clone(),
                    coupling: whole.coupling.clone(),
                },
                whole.degrees_of_freedom,
            ))
        } else {
            Ok((
                GearModel {
                    flank: teeth.flank.clone(),
                    coupling: teeth.on_rigid_blank.clone(),
                },
                teeth.degrees_of_freedom,
            ))
        }
    };
    let (driving, driven) = rayon::join(|| build(gears[0]), || build(gears[1]));
    let ((driving, dof_1), (driven, dof_2)) = (driving?, driven?);
    let model = PairModel {
        pair: case.pair.clone(),
        gears: [driving, driven],
        cells_per_patch: cells_per_patch(level),
        solver: case.resolution.contact_solver,
    };
    Ok((model, dof_1 + dof_2))
}

/// The contact at each of `positions` under `load`, in parallel.
///
/// # Errors
///
/// A position that has no solution, or [`AnalysisError::Stopped`].
pub(super) fn contacts(
    model: &PairModel,
    load: f64,
    positions: &[f64],
    run: &Run,
) -> Result<Vec<MeshContact>, AnalysisError> {
    contacts_keeping(model, load, positions, run, |_, _| ())
        .map(|contacts| contacts.into_iter().map(|(contact, ())| contact).collect())
}

/// As [`contacts`], with what `keep` takes of each.
fn contacts_keeping<T: Send>(
    model: &PairModel,
    load: f64,
    positions: &[f64],
    run: &Run,
    keep: impl Fn(&ContactCells<'_>, &ContactSolution) -> T + Sync,
) -> Result<Vec<(MeshContact, T)>, AnalysisError> {
    let stages = stages(positions, model.pair.is_concentric());
    let solved: Result<Vec<Vec<_>>, AnalysisError> = stages
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut contacts = Vec::new();
            let mut first = WarmStart::default();
            for (fraction, places) in chunk {
                // Each stage starts from the one before it, and each further period of a stage from the last period.
                let first_eta = positions[places[0]];
                // Where no gear is eccentric, whole periods make no difference to the flanks.
                let home = if model.pair.is_concentric() {
                    0.0
                } else {
                    first_eta.floor()
                };
                let mut stage = Stage::new(model, fraction + home, load)
                    .map_err(|error| at_position(error, first_eta))?;
                let mut warm = first.clone();
                for &place in places {
                    let eta = positions[place];
                    let contact = stage
                        .contact((eta - fraction).round() as i64, &mut warm, &keep)
                        .map_err(|error| at_position(error, eta))?;
                    contacts.push((place, contact));
                    run.reached(1)?;
                    if place == places[0] {
                        first = warm.clone();
                    }
                }
            }
            Ok(contacts)
        })
        .collect();
    let mut contacts: Vec<_> = solved?.into_iter().flatten().collect();
    contacts.sort_unstable_by_key(|&(place, _)| place);
    Ok(contacts.into_iter().map(|(_, contact)| contact).collect())
}

/// Positions by their fraction of the mesh period, rising, with the places of those that have it; each by itself if they are not
/// `together`.
fn stages(positions: &[f64], together: bool) -> Vec<(f64, Vec<usize>)> {
    let fraction = |place: usize| positions[place] - positions[place].floor();
    let mut places: Vec<usize> = (0..positions.len()).collect();
    places.sort_by(|&a, &b| fraction(a).total_cmp(&fraction(b)));
    let mut stages: Vec<(f64, Vec<usize>)> = Vec::new();
    for place in places {
        match stages.last_mut() {
            Some((known, places)) if together && fraction(place) - *known < SAME_FRACTION => {
                places.push(place);
            }
            _ => stages.push((fraction(place), vec![place])),
        }
    }
    for (_, places) in &mut stages {
        places.sort_unstable();
    }
    stages
}

fn at_position(error: PositionError, mesh_position: f64) -> AnalysisError {
    match error {
        PositionError::NoContact => AnalysisError::NoContact { mesh_position },
        PositionError::TooFarApart { apart, coupled } => AnalysisError::TooFarApart {
            mesh_position,
            apart,
            coupled,
        },
        PositionError::Contact(crate::contact::ContactError::NotConverged {
            iterations,
            gap,
            ..
        }) => AnalysisError::NotConverged {
            mesh_position,
            residual: gap,
            iterations,
        },
        PositionError::Contact(error) => AnalysisError::ContactFailed {
            mesh_position,
            error,
        },
    }
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
    case: &Case,
    model: &PairModel,
    load: f64,
    positions: &[f64],
    run: &Run,
    keep: impl Fn(&ContactCells<'_>, &ContactSolution) -> T + Sync,
) -> Result<Solved<T>, AnalysisError> {
    let middle = contacts_keeping(model, load, positions, run, keep)?;
    let (contacts, kept): (Vec<MeshContact>, Vec<T>) = middle.into_iter().unzip();
    let stiffness = match case.resolution.stiffness {
        StiffnessRule::Tangent => contacts.iter().map(|contact| contact.stiffness).collect(),
        StiffnessRule::TorqueStep { fraction } => {
            let at = |factor: f64| self::contacts(model, load * factor, positions, run);
            let (low, high) = (at(1.0 - fraction)?, at(1.0 + fraction)?);
            let pairs = low.iter().zip(&high);
            pairs
                .map(|(low, high)| {
                    2.0 * fraction * load / (high.transmission_error - low.transmission_error)
                })
                .collect()
        }
    };
    Ok(Solved {
        contacts,
        kept,
        stiffness,
    })
}

/// Shares of the load by pair offset n − floor(η), for the offsets that ever carry load.
pub(super) fn load_shares(positions: &[f64], contacts: &[MeshContact]) -> Vec<LoadShare> {
    let mut shares: Vec<LoadShare> = Vec::new();
    for (i, (eta, contact)) in positions.iter().zip(contacts).enumerate() {
        for pair in contact.pairs.iter().filter(|pair| pair.share > 0.0) {
            let pair_offset = (pair.pair - eta.floor() as i64) as i32;
            let place = shares
                .iter()
                .position(|share| share.pair_offset == pair_offset)
                .unwrap_or_else(|| {
                    shares.push(LoadShare {
                        pair_offset,
                        share: vec![0.0; positions.len()],
                    });
                    shares.len() - 1
                });
            shares[place].share[i] = pair.share;
        }
    }
    shares.sort_by_key(|share| share.pair_offset);
    shares
}

/// Gathers the evidence of solved positions into `evidence`.
pub(super) fn gather(evidence: &mut Evidence, contacts: &[MeshContact], load: f64) {
    let largest = contacts
        .iter()
        .map(|contact| contact.transmission_error.abs())
        .fold(f64::MIN_POSITIVE, f64::max);
    for contact in contacts {
        evidence.equilibrium_residual = evidence.equilibrium_residual.max(contact.equilibrium);
        evidence.complementarity_residual = evidence
            .complementarity_residual
            .max(contact.complementarity / (load * largest));
        evidence.largest_penetration = evidence.largest_penetration.max(contact.penetration);
        evidence.contact_iterations += u64::from(contact.iterations);
    }
}

/// Warns of tips that touch off the path of contact, and of contact that reaches a fillet.
pub(super) fn warn_of_tips(warnings: &mut Vec<Warning>, contacts: &[MeshContact]) {
    for member in Member::BOTH {
        let mut pairs = contacts.iter().flat_map(|contact| &contact.pairs);
        let warning = Warning::ContactReachesFillet { member };
        if pairs.any(|pair| pair.fillet == Some(member)) && !warnings.contains(&warning) {
            warnings.push(warning);
        }
        let shares = contacts
            .iter()
            .flat_map(|contact| &contact.pairs)
            .filter(|pair| pair.tip_corner == Some(member))
            .map(|pair| pair.share);
        let largest_share = shares.fold(0.0, f64::max);
        if largest_share == 0.0 {
            continue;
        }
        let known = warnings.iter_mut().find_map(|warning| match warning {
            Warning::TipCornerContact {
                member: known,
                largest_share,
            } if *known == member => Some(largest_share),
            _ => None,
        });
        match known {
            Some(known) => *known = known.max(largest_share),
            None => warnings.push(Warning::TipCornerContact {
                member,
                largest_share,
            }),
        }
    }
}
