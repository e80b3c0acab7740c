//! The methods that see the faces: both whole gears in three dimensions, contact along moving lines; at every position, or over one mesh
//! period with what holes change added at first order.

use super::case::FaceHoles;
use std::sync::Arc;

use faer::Mat;

use super::between::{Sample, Sections};
use super::case::{Faces, Place};
use super::curve::{FaceLoad, LeadCure};
use super::curve_parts::CurveParts;
use super::evidence::Evidence;
use super::face_stress::FaceStressModel;
use super::first_order::{OnRound, with_holes};
use super::plan::{Pass, Sweep};
use super::warning::{warn_of_corner, warn_of_projection, warn_of_tips, warnings};
use super::{Analysis, AnalysisError, Case};
use crate::assembly::{FaceYield, FaceYieldSpec, Parts};
use crate::contact::MeshContact;
use crate::contact::face::even::{EvenLead, STRIPS, face_load_factor};
use crate::contact::face::{FaceContact, FaceModel, FlankYield};
use crate::gear::Member;
use crate::run::Run;

/// A tip corner is told of from this part of the load: one of many slices touches nearly always.
const TOLD: f64 = 0.005;

/// Computes `case` along its faces at the grid level of `plan`.
pub(super) fn solve(
    (case, asked, holes): (&Case, &Faces, FaceHoles),
    plan: &Pass,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let faces = &asked.at(plan.level);
    let yields = yields(faces, parts, run)?;
    let degrees_of_freedom = yields.iter().map(|of| of.degrees_of_freedom()).sum();
    let mut evidence = Evidence::new(degrees_of_freedom);
    let mut warnings = warnings(case);
    let mut curves = Vec::with_capacity(case.output_torques.len());
    let pair = OfFaces::new((case, faces), plan, &yields, run);
    let stress = plan
        .stress
        .then(|| FaceStressModel::new(faces, &yields, parts, run));
    let stress = stress.transpose()?;
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let solved = match holes {
            FaceHoles::FirstOrder => {
                let solved = pair.projected(load, &plan.told)?;
                pair.checked(load, solved)?
            }
            FaceHoles::Whole => pair.whole(load, &plan.told)?,
        };
        let is_projected = holes == FaceHoles::FirstOrder;
        let after = if is_projected {
            case.contacts_repeat_after()
        } else {
            case.curves_repeat_after()
        };
        let samples = solved.samples(&case.places_after(
            &plan.told.positions,
            if is_projected { after } else { case.span() },
        ));
        let sections = plan.told.sections((case, after), samples, run, |sweep| {
            let further = if is_projected {
                pair.projected(load, sweep)?
            } else {
                pair.whole(load, sweep)?
            };
            evidence.gather(&further.meshes(), load);
            Ok(further.samples(&case.places_after(&sweep.positions, after)))
        })?;
        evidence.gather(&solved.meshes(), load);
        warn_of_tips(&mut warnings, &solved.meshes());
        for member in Member::BOTH {
            let shares = solved.contacts.iter();
            let shares = shares.map(|contact| contact.corner_shares[member.index()]);
            let largest = shares.fold(0.0, f64::max);
            if largest > TOLD {
                warn_of_corner(&mut warnings, member, largest);
            }
        }
        let stresses = stress
            .as_ref()
            .map(|model| model.under(&solved.contacts, run));
        let stresses = stresses.transpose()?;
        let error = solved.error;
        let even = pair.even_lead(load, &solved)?;
        let mut parts = solved.into_parts(case, asked, sections);
        parts.stresses = stresses;
        if let Some(face) = &mut parts.face {
            face.cure = even.map(|lead| LeadCure::of(lead, face.face_load_factor));
        }
        let curve = parts.into_curve(case, output_torque);
        if let Some(error) = error {
            let known = evidence.projection_error.unwrap_or(0.0);
            evidence.projection_error = Some(error.max(known));
            warn_of_projection(&mut warnings, error, &curve.transmission_error_statistics);
        }
        curves.push(curve);
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings,
    })
}

/// The models of a pair along its faces.
struct OfFaces<'a> {
    case: &'a Case,
    plan: &'a Pass,
    run: &'a Run,
    /// Both gears as drawn.
    whole: FaceModel,
    /// Both gears, alike all around.
    round: FaceModel,
    /// Those that are not.
    uneven: Vec<Member>,
}

/// What was found under one load.
struct Solved {
    /// At every position, or at the repeating ones.
    contacts: Vec<FaceContact>,
    /// At every position.
    transmission_error: Vec<f64>,
    stiffness: Vec<f64>,
    /// The largest difference to an exact solution, of those that were looked at.
    error: Option<f64>,
}

impl<'a> OfFaces<'a> {
    fn new(
        (case, faces): (&'a Case, &Faces),
        plan: &'a Pass,
        yields: &[Arc<FaceYield>; 2],
        run: &'a Run,
    ) -> Self {
        let round = yields.each_ref().map(|of| Arc::new(of.round_average()));
        let uneven = |member: &Member| yields[member.index()].repeats_after() > 1;
        Self {
            case,
            plan,
            run,
            whole: face_model(faces, yields),
            round: face_model(faces, &round),
            uneven: Member::BOTH.into_iter().filter(uneven).collect(),
        }
    }

    /// By a contact of the whole gears at every position.
    fn whole(&self, load: f64, sweep: &Sweep) -> Result<Solved, AnalysisError> {
        let (contacts, stiffness) = self.contacts(&self.whole, load, sweep)?;
        let each = contacts.iter();
        Ok(Solved {
            transmission_error: each.map(|each| each.mesh.transmission_error).collect(),
            contacts,
            stiffness,
            error: None,
        })
    }

    /// By the contacts of gears that are alike all around, and what holes change of them at first order.
    fn projected(&self, load: f64, sweep: &Sweep) -> Result<Solved, AnalysisError> {
        let (contacts, stiffness) = self.contacts(&self.round, load, sweep)?;
        let loads: Vec<_> = contacts.iter().map(|each| self.round.loads(each)).collect();
        let yielded = |model: &FaceModel, at: usize, periods: i64| {
            let of = self.uneven.iter();
            of.map(|&member| model.yielded(member, &loads[at], periods))
                .fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]])
        };
        let round: Vec<OnRound> = (0..contacts.len())
            .map(|at| OnRound {
                transmission_error: contacts[at].mesh.transmission_error,
                stiffness: stiffness[at],
                yielded: yielded(&self.round, at, 0),
            })
            .collect();
        let found = with_holes(&self.case.places(&sweep.positions), &round, |place| {
            yielded(&self.whole, place.contact, place.later)
        });
        Ok(Solved {
            error: None,
            contacts,
            transmission_error: found.transmission_error,
            stiffness: found.stiffness,
        })
    }

    /// What was `solved` by projection, held against exact solutions.
    fn checked(&self, load: f64, solved: Solved) -> Result<Solved, AnalysisError> {
        let round = solved.contacts.iter().map(|each| each.mesh.stiffness);
        let round: Vec<f64> = round.collect();
        let places = self.plan.checks.places(self.case, &round);
        let all = self.case.mesh_positions();
        let positions: Vec<f64> = places.iter().map(|&place| all[place]).collect();
        let exact = self.whole.contacts(load, &positions, self.run)?;
        let apart = places.iter().zip(&exact).map(|(&place, exact)| {
            (solved.transmission_error[place] - exact.mesh.transmission_error).abs()
        });
        Ok(Solved {
            error: Some(apart.fold(0.0, f64::max)),
            ..solved
        })
    }

    /// The lead that evens the load on the pair that was `solved` for, where it is looked for.
    fn even_lead(&self, load: f64, solved: &Solved) -> Result<Option<EvenLead>, AnalysisError> {
        let model = if self.case.method().is_projected() {
            &self.round
        } else {
            &self.whole
        };
        let deltas = solved.contacts.iter();
        let deltas = deltas.map(|contact| contact.mesh.transmission_error);
        let farthest = deltas.fold(f64::NEG_INFINITY, f64::max);
        Ok(model.even_lead(load, &self.plan.evened, farthest, self.run)?)
    }

    /// The contacts of `model` of which the curves tell, and its stiffness there.
    fn contacts(
        &self,
        model: &FaceModel,
        load: f64,
        sweep: &Sweep,
    ) -> Result<(Vec<FaceContact>, Vec<f64>), AnalysisError> {
        let at = |load: f64| model.contacts(load, &sweep.positions, self.run);
        let contacts = at(load)?;
        let of_contacts = || contacts.iter().map(|each| each.mesh.stiffness).collect();
        let stiffness = sweep.stiffness(load, of_contacts, |load| {
            let contacts = at(load)?.into_iter();
            Ok(contacts.map(|each| each.mesh.transmission_error).collect())
        })?;
        Ok((contacts, stiffness))
    }
}

impl Solved {
    fn meshes(&self) -> Vec<MeshContact> {
        let each = self.contacts.iter();
        each.map(|contact| contact.mesh.clone()).collect()
    }

    /// What is known at the `places` that they tell of.
    fn samples(&self, places: &[Place]) -> Vec<Sample> {
        // δ and k are known at each of them, or alike at all that a contact tells of.
        let at = |of: &[f64]| -> Vec<f64> {
            let each = places.iter().enumerate();
            let own = of.len() == places.len();
            each.map(|(i, place)| of[if own { i } else { place.contact }])
                .collect()
        };
        let (delta, stiffness) = (at(&self.transmission_error), at(&self.stiffness));
        Sample::of(places, &self.meshes(), &delta, &stiffness)
    }

    fn into_parts(self, case: &Case, faces: &Faces, sections: Sections) -> CurveParts {
        let meshes = self.meshes();
        let face = Some(face_load(case, faces, &self.contacts));
        let told = if meshes.len() == case.positions() {
            CurveParts::of_contacts(case, &meshes, Vec::new(), sections)
        } else {
            CurveParts::of_repeating(case, &meshes, sections)
        };
        CurveParts {
            transmission_error: self.transmission_error,
            stiffness: self.stiffness,
            face,
            ..told
        }
    }
}

/// What the flanks of both gears yield.
pub(super) fn yields(
    faces: &Faces,
    parts: &dyn Parts,
    run: &Run,
) -> Result<[Arc<FaceYield>; 2], AnalysisError> {
    let of = |member: Member| {
        let spec = FaceYieldSpec::new(faces.pair.gear(member), faces.resolution);
        let made = parts.face_yield(&spec, run);
        made.map_err(|error| error.of(member))
    };
    let (driving, driven) = rayon::join(|| of(Member::Driving), || of(Member::Driven));
    Ok([driving?, driven?])
}

/// The pair whose flanks yield as `yields`.
pub(super) fn face_model(faces: &Faces, yields: &[Arc<FaceYield>; 2]) -> FaceModel {
    let [one, other] = yields.each_ref().map(|of| of.coupled());
    let yields = yields
        .each_ref()
        .map(|of| Arc::clone(of) as Arc<dyn FlankYield>);
    FaceModel::new(faces.pair.clone(), yields, faces.slices, one.min(other))
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

    fn repeats_after(&self) -> usize {
        self.repeats_after()
    }

    fn at_ends(&self, point: (f64, f64), loaded: (f64, f64), along: f64) -> f64 {
        self.at_ends(point, loaded, along)
    }
}

/// The load along the face in `contacts` at the positions of `case`, or at those after which it repeats.
fn face_load(case: &Case, faces: &Faces, contacts: &[FaceContact]) -> FaceLoad {
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
    FaceLoad {
        heights: (0..count)
            .map(|i| (i as f64 + 0.5) * strip - 0.5 * width)
            .collect(),
        load: if faces.at_each_position {
            case.repeated(rows.into_iter())
        } else {
            vec![mean_row(&rows)]
        },
        face_load_factor: face_load_factor(&mean_row(&strips)),
        cure: None,
        load_centroid: case.repeated(contacts.iter().map(FaceContact::load_centroid)),
    }
}

/// The mean of `rows`, entry by entry.
fn mean_row(rows: &[Vec<f64>]) -> Vec<f64> {
    let entries = rows.first().map_or(0, Vec::len);
    let mean = |i: usize| rows.iter().map(|row| row[i]).sum::<f64>() / rows.len() as f64;
    (0..entries).map(mean).collect()
}
