//! Methods along the faces: both whole gears in three dimensions, contact along moving lines; at every position, or over one mesh period with the first-order
//! effect of holes added.

use std::sync::Arc;

use faer::Mat;

use super::case::{Case, FaceHoles, Faces};
use super::curve::{FaceLoad, LeadCorrection};
use super::face_stress::FaceStressModel;
use super::first_order::with_holes;
use super::found::{Found, Kept};
use super::plan::{Pass, Sweep};
use super::setup::Solved;
use super::spun_pair::{LoadsInside, PairState};
use super::stress::{GearStresses, PositionPeaks};
use super::under_load::curves;
use super::warning::warn_of_corner;
use super::{Analysis, AnalysisError};
use crate::assembly::{FaceCompliance, FaceComplianceSpec, Parts};
use crate::contact::face::drawn::DrawnFaces;
use crate::contact::face::even::{STRIPS, face_load_factor};
use crate::contact::face::{FaceContact, FaceModel, FlankCompliance};
use crate::contact::positions::PositionsError;
use crate::contact::{MeshContact, PairLoads};
use crate::gear::{Member, PairDeviations};
use crate::run::Run;

/// Part of the load from which a tip corner is warned of: one of many slices touches nearly always.
const WARNED_OF: f64 = 0.005;

/// Computes `case` along its faces at the grid level of `pass`; its teeth have these `deviations`, and its gears these `loads` inside them.
pub(super) fn solve(
    (case, asked, holes): (&Case, &Faces, FaceHoles),
    (deviations, loads): (&PairDeviations, [Option<LoadsInside>; 2]),
    pass: &Pass,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Analysis, AnalysisError> {
    let faces = &asked.at(pass.level);
    let yields = yields(faces, parts, run)?;
    let unknowns = yields.iter().map(|of| of.degrees_of_freedom()).sum();
    let stress = pass
        .stress
        .then(|| FaceStressModel::new((faces, loads), &yields, parts, run));
    let stress = stress.transpose()?;
    let pair = OfFaces::new((case, faces, deviations), &yields, parts, run);
    let find = |load: f64, sweep: &Sweep| {
        let found = match holes {
            FaceHoles::FirstOrder => pair.projected(load, sweep),
            FaceHoles::Whole => pair.whole(load, sweep),
        };
        with_stress(found?, stress.as_ref(), run)
    };
    curves((case, pass), unknowns, run, |under| {
        let load = under.load;
        let found = find(load, &pass.curve)?;
        let (mut parts, between) = under.parts(&found, &[], |sweep, _| find(load, sweep))?;
        for member in Member::BOTH {
            let shares = found.kept.iter();
            let shares = shares.map(|kept| kept.contact.corner_shares[member.index()]);
            let largest = shares.fold(0.0, f64::max);
            if largest > WARNED_OF {
                warn_of_corner(under.warnings, member, largest);
            }
        }
        parts.stresses = stress.as_ref().map(|_| {
            let peaks = |kept: &[FacePosition]| -> Vec<PositionPeaks> {
                kept.iter().filter_map(|kept| kept.peaks).collect()
            };
            let between = (between.positions.as_slice(), &*peaks(&between.kept));
            GearStresses::of_positions(&peaks(&found.kept), between)
        });
        let solved = match holes {
            FaceHoles::FirstOrder => &pair.round,
            FaceHoles::Whole => &pair.whole,
        };
        if holes == FaceHoles::FirstOrder {
            under.check(&found, |positions| {
                let exact = pair.whole.contacts(load, positions, run)?.into_iter();
                Ok(exact.map(|each| each.mesh.transmission_error).collect())
            })?;
        }
        let deltas = found.contacts.iter();
        let deltas = deltas.map(|contact| contact.transmission_error);
        let farthest = deltas.fold(f64::NEG_INFINITY, f64::max);
        let even = solved.even_lead(load, &pass.evened, farthest, run)?;
        let mut face = face_load(case, asked, &found.kept);
        face.cure = even.map(|lead| LeadCorrection::of(lead, face.face_load_factor));
        parts.face = Some(face);
        Ok(parts)
    })
}

/// Stored part of a contact along faces.
#[derive(Clone)]
struct FacePosition {
    contact: FaceContact,
    /// The largest stresses under it, where they are asked for.
    peaks: Option<PositionPeaks>,
}

impl Kept for FacePosition {
    fn watched(&self) -> Vec<f64> {
        let peaks = self.peaks.as_ref();
        peaks.map(PositionPeaks::watched).unwrap_or_default()
    }
}

/// The results `found`, with the largest stresses by their model.
fn with_stress(
    mut found: Found<FaceContact>,
    stress: Option<&FaceStressModel<'_>>,
    run: &Run,
) -> Result<Found<FacePosition>, AnalysisError> {
    let contacts = std::mem::take(&mut found.kept);
    let peaks = stress
        .map(|model| model.under(&contacts, run))
        .transpose()?;
    let each = contacts.into_iter().enumerate();
    let kept = each.map(|(i, contact)| FacePosition {
        contact,
        peaks: peaks.as_ref().map(|peaks| peaks[i]),
    });
    Ok(found.keeping(kept.collect()))
}

/// The models of a pair along its faces.
struct OfFaces<'a> {
    case: &'a Case,
    run: &'a Run,
    /// Both gears as drawn.
    whole: FaceModel,
    /// Both gears, axisymmetric.
    round: FaceModel,
    /// Gears that are not rotationally symmetric.
    uneven: Vec<Member>,
    /// Where flanks are unlike: what the first-order method solves them on.
    on_drawn: Option<OnDrawn<'a>>,
}

/// Rotationally symmetric gears as drawn, on whose slices teeth that deviate are solved.
struct OnDrawn<'a> {
    model: FaceModel,
    store: Arc<DrawnFaces>,
    deviations: &'a PairDeviations,
}

impl<'a> OfFaces<'a> {
    fn new(
        (case, faces, deviations): (&'a Case, &Faces, &'a PairDeviations),
        yields: &[Arc<FaceCompliance>; 2],
        parts: &dyn Parts,
        run: &'a Run,
    ) -> Self {
        let round = yields.each_ref().map(|of| Arc::new(of.round_average()));
        let uneven = |member: &Member| yields[member.index()].repeats_after() > 1;
        Self {
            case,
            run,
            whole: face_model(faces, yields).deviating(deviations.clone()),
            round: face_model(faces, &round).deviating(deviations.clone()),
            uneven: Member::BOTH.into_iter().filter(uneven).collect(),
            on_drawn: case.is_solved_as_drawn().then(|| OnDrawn {
                model: face_model(faces, &round).deviating(PairDeviations::NONE),
                store: parts.drawn_faces(&faces.drawn_contacts()),
                deviations,
            }),
        }
    }

    /// By a contact of the whole gears at every position.
    fn whole(&self, load: f64, sweep: &Sweep) -> Result<Found<FaceContact>, AnalysisError> {
        let solved = self.solved(load, sweep, |load| {
            self.whole.contacts(load, &sweep.positions, self.run)
        })?;
        let (contacts, faces, stiffness) = solved;
        let task = (self.case, sweep);
        Ok(Found::of_contacts(task, contacts, &stiffness).keeping(faces))
    }

    /// Results from the contacts of rotationally symmetric gears, and the first-order effect of holes on them.
    fn projected(&self, load: f64, sweep: &Sweep) -> Result<Found<FaceContact>, AnalysisError> {
        let positions = &sweep.positions;
        let (contacts, faces, stiffness) =
            self.solved(load, sweep, |load| match &self.on_drawn {
                Some(drawn) => drawn.contacts(load, positions, self.run),
                None => self.round.contacts(load, positions, self.run),
            })?;
        let loads: Vec<_> = faces.iter().map(|each| self.round.loads(each)).collect();
        let yielded = |model: &FaceModel, loads: &[PairLoads], periods: i64| {
            let of = self.uneven.iter();
            of.map(|&member| model.yielded(member, loads, periods))
                .fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]])
        };
        let found = with_holes(
            (self.case, sweep),
            (contacts, &stiffness),
            loads,
            |loads| yielded(&self.round, loads, 0),
            |loads, place| yielded(&self.whole, loads, place.later),
        );
        Ok(found.keeping(faces))
    }

    /// The contacts `at` a load at the positions of `sweep`, their slices, and the stiffness there.
    fn solved(
        &self,
        load: f64,
        sweep: &Sweep,
        at: impl Fn(f64) -> Result<Vec<FaceContact>, PositionsError>,
    ) -> Result<Solved<FaceContact>, AnalysisError> {
        let meshes = |faces: &[FaceContact]| -> Vec<MeshContact> {
            faces.iter().map(|contact| contact.mesh.clone()).collect()
        };
        let faces = at(load)?;
        let contacts = meshes(&faces);
        let stiffness = sweep.stiffness(load, &contacts, |load| Ok(meshes(&at(load)?)))?;
        Ok((contacts, faces, stiffness))
    }
}

impl OnDrawn<'_> {
    fn contacts(
        &self,
        load: f64,
        positions: &[f64],
        run: &Run,
    ) -> Result<Vec<FaceContact>, PositionsError> {
        let made = (&*self.store, self.deviations);
        self.model.contacts_on_drawn(made, load, positions, run)
    }
}

/// Compliance of the flanks of both gears.
pub(super) fn yields(
    faces: &Faces,
    parts: &dyn Parts,
    run: &Run,
) -> Result<[Arc<FaceCompliance>; 2], AnalysisError> {
    let of = |member: Member| {
        let spec = FaceComplianceSpec::new(faces.pair.gear(member), faces.resolution);
        let made = parts.face_compliance(&spec, run);
        made.map_err(|error| error.of(member))
    };
    let (driving, driven) = rayon::join(|| of(Member::Driving), || of(Member::Driven));
    Ok([driving?, driven?])
}

/// The pair whose flanks yield as `yields`.
pub(super) fn face_model(faces: &Faces, yields: &[Arc<FaceCompliance>; 2]) -> FaceModel {
    let [one, other] = yields.each_ref().map(|of| of.coupled());
    let yields = yields
        .each_ref()
        .map(|of| Arc::clone(of) as Arc<dyn FlankCompliance>);
    FaceModel::new(faces.pair.clone(), yields, faces.slices, one.min(other))
}

/// The pair of `case` along its `faces`, whose flanks yield as `yields`, as it runs.
pub(super) fn running_model(
    (case, faces): (&Case, &Faces),
    yields: &[Arc<FaceCompliance>; 2],
    parts: &dyn Parts,
    run: &Run,
) -> Result<FaceModel, AnalysisError> {
    let model = face_model(faces, yields);
    Ok(
        match PairState::of(case, case.resolution.grid, parts, run)? {
            Some(state) => model.deviating(state.deviations),
            None => model,
        },
    )
}

impl FlankCompliance for FaceCompliance {
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
fn face_load(case: &Case, faces: &Faces, kept: &[FacePosition]) -> FaceLoad {
    let (width, count) = (faces.pair.common_face_width(), faces.slices);
    let strip = width / count as f64;
    let contacts = kept.iter().map(|kept| &kept.contact);
    let rows: Vec<Vec<f64>> = contacts
        .clone()
        .map(|contact| {
            let loads = contact.strips(width, count).into_iter();
            loads.map(|load| load / strip).collect()
        })
        .collect();
    let strips: Vec<Vec<f64>> = contacts
        .clone()
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
        load_centroid: case.repeated(contacts.map(FaceContact::load_centroid)),
    }
}

/// The mean of `rows`, entry by entry.
fn mean_row(rows: &[Vec<f64>]) -> Vec<f64> {
    let entries = rows.first().map_or(0, Vec::len);
    let mean = |i: usize| rows.iter().map(|row| row[i]).sum::<f64>() / rows.len() as f64;
    (0..entries).map(mean).collect()
}
