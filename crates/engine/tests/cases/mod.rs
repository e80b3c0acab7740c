//! Gears, pairs and cases of the paper, with what it leaves open settled as the README says.

#![allow(dead_code, reason = "each test and benchmark uses some of these")]

pub(crate) mod departures;

use std::sync::Arc;

use meshwright_engine::analysis::stress::GearStresses;
use meshwright_engine::analysis::{
    BodyFormula, Case, ContactSolver, Curve, FaceHoles, Faces, Formulas, Method, Model, PlaneState,
    Resolution, SectionHoles, StiffnessRule, ToothFormula, analyze,
};
use meshwright_engine::assembly::{FaceCompliance, FaceResolution};
use meshwright_engine::contact::face::{FaceModel, FlankCompliance, SLICES};
use meshwright_engine::contact::{MeshContact, PairModel, PositionError, WarmStart};
use meshwright_engine::gear::{
    Alignment, FaceEnds, GearData, GearPair, Helix, HolePattern, LeadModification, Member,
    ModificationData, PairDeviations, ReliefData, ReliefShape, ReliefStart, SolidGear, SolidPair,
    SpurGear,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_engine::substructures::FARTHEST_COUPLED;

/// The gears of the paper and of CalculiX but for their tooth counts and blanks: m 2 mm, α 20°, b 20 mm.
pub(crate) fn gear(tooth_count: u32, bore_radius: f64) -> GearData {
    GearData::plain(tooth_count, 2e-3, bore_radius)
}

/// The relief of the paper: 5 µm, linear, from 1.75 mm below the tip circle.
pub(crate) fn relieved(data: GearData) -> GearData {
    GearData {
        modifications: vec![ModificationData::TipRelief(ReliefData {
            amount: 5e-6,
            shape: ReliefShape::Linear,
            start: ReliefStart::RadialLength(1.75e-3),
        })],
        ..data
    }
}

/// `data` with holes.
pub(crate) fn holed(
    mut data: GearData,
    count: u32,
    circle_radius: f64,
    radius: f64,
    phase: f64,
) -> GearData {
    data.blank.holes = HolePattern {
        count,
        circle_radius,
        radius,
        phase,
    }
    .holes();
    data
}

/// The pair of two drawings.
pub(crate) fn pair(driving: GearData, driven: GearData, center_distance: f64) -> GearPair {
    let gear = |data| SpurGear::new(data).expect("the drawing of a test can be made");
    GearPair::new(gear(driving), gear(driven), center_distance).expect("the pair of a test meshes")
}

/// The standard pair: 50/50 at 100.5 mm with a bore of 15 mm, with or without the relief of the paper.
pub(crate) fn standard_pair(with_relief: bool) -> GearPair {
    let data = gear(50, 15e-3);
    let data = if with_relief { relieved(data) } else { data };
    pair(data.clone(), data, 100.5e-3)
}

/// Test case `number` of the paper with the values of the README where the paper gives none, and its output torque.
pub(crate) fn paper_case(number: u32) -> (GearPair, f64) {
    let blank = |z, bore| relieved(gear(z, bore));
    match number {
        1 => {
            let data = holed(blank(50, 16e-3), 8, 31.5e-3, 10e-3, 0.0);
            (pair(data.clone(), data, 100.5e-3), 115.0)
        }
        2 => {
            let driven = holed(blank(50, 16e-3), 10, 34e-3, 7.5e-3, 0.0);
            (pair(blank(50, 16e-3), driven, 100.5e-3), 115.0)
        }
        3 => {
            let driven = holed(blank(85, 12e-3), 6, 56e-3, 17.5e-3, 0.0);
            (pair(blank(29, 10e-3), driven, 114.5e-3), 160.0)
        }
        _ => unreachable!("the paper has three test cases"),
    }
}

/// The model of a pair beside what its teeth deviate by.
pub(crate) struct Made {
    pub(crate) pair: GearPair,
    pub(crate) model: PairModel,
    pub(crate) deviations: PairDeviations,
}

impl Made {
    /// `model`, that of `pair`, with what this deviates by.
    pub(crate) fn new(pair: GearPair, model: PairModel) -> Self {
        Self {
            deviations: pair.deviations(),
            pair,
            model,
        }
    }

    /// Such a pair with other deviations.
    pub(crate) fn of(model: &PairModel, pair: &GearPair, deviations: PairDeviations) -> Self {
        Self {
            pair: pair.clone(),
            model: model.clone(),
            deviations,
        }
    }

    /// From a cold start.
    pub(crate) fn contact(&self, eta: f64, load: f64) -> Result<MeshContact, PositionError> {
        let made = self.model.deviating(&self.deviations);
        made.contact(eta, load, &mut WarmStart::default())
    }
}

/// The flexible method at the standard level, 40 positions a mesh period over the true period, exact active set and
/// tangent.
pub(crate) fn case(pair: GearPair, output_torques: &[f64]) -> Case {
    Case {
        pair,
        model: Model::Section(SectionHoles::Whole),
        output_torques: output_torques.to_vec(),
        resolution: Resolution {
            positions_per_mesh_period: 40,
            first_position: 0.0,
            span_mesh_periods: None,
            grid: GridLevel::Standard,
            contact_solver: ContactSolver::ActiveSet,
            stiffness: StiffnessRule::Tangent,
            blank_positions: 16,
            interface_radii: [None; 2],
            error_estimate: false,
        },
        windows: Vec::new(),
        stress: false,
        driving_speed: None,
        running: None,
    }
}

/// The gear of a drawing whose teeth stand at an angle, positive right-handed, with its web so far from the middle of its face.
pub(crate) fn helical(data: GearData, beta: f64, web_offset: f64) -> SolidGear {
    SolidGear::new(data, Helix::right(beta), web_offset, None)
        .expect("the drawing of a test can be made")
}

/// The pair along its faces.
pub(crate) fn along_faces(
    pair: SolidPair,
    (resolution, slices): (FaceResolution, usize),
    output_torques: &[f64],
) -> Case {
    let section = pair.section().clone();
    let faces = Faces {
        pair,
        resolution,
        slices,
        at_each_position: false,
        cure: false,
    };
    Case {
        model: Model::Faces(Box::new(faces), FaceHoles::Whole),
        ..case(section, output_torques)
    }
}

/// How both gears of `pair` yield along their faces.
pub(crate) fn face_yields(
    pair: &SolidPair,
    resolution: FaceResolution,
) -> [Arc<dyn FlankCompliance>; 2] {
    Member::BOTH.map(|member| {
        let made = FaceCompliance::of(pair.gear(member), resolution, &Run::unattended());
        Arc::new(made.expect("can be condensed")) as Arc<dyn FlankCompliance>
    })
}

/// The contact along `faces`, asked position by position.
pub(crate) fn face_model(faces: &Faces) -> FaceModel {
    let yields = face_yields(&faces.pair, faces.resolution);
    FaceModel::new(faces.pair.clone(), yields, faces.slices, FARTHEST_COUPLED)
}

/// The pair of `case` along its faces, to change.
pub(crate) fn faces_of(case: &mut Case) -> &mut Faces {
    match &mut case.model {
        Model::Faces(faces, _) => faces,
        Model::Section(_) | Model::Formulas(_) => panic!("nothing is said of the faces"),
    }
}

/// What a case with the model `known` is modeled by to be computed by `method`; formulas are those that the service presets.
pub(crate) fn model_by(method: Method, known: &Model) -> Model {
    let along_faces = |holes| match known {
        Model::Faces(faces, _) => Model::Faces(faces.clone(), holes),
        Model::Section(_) | Model::Formulas(_) => panic!("nothing is said of the faces"),
    };
    match method {
        Method::Flexible => Model::Section(SectionHoles::Whole),
        Method::Decomposition => Model::Section(SectionHoles::Fitted),
        Method::ProjectedDecomposition => Model::Section(SectionHoles::FirstOrder),
        Method::ThreeDimensional => along_faces(FaceHoles::Whole),
        Method::ThreeDimensionalProjected => along_faces(FaceHoles::FirstOrder),
        Method::LoadDistribution => Model::Formulas(Formulas {
            tooth: ToothFormula::WeberBanaschek,
            body: BodyFormula::Sainsot,
            plane_state: PlaneState::Stress,
        }),
    }
}

/// Test case `number` of the paper by the flexible method.
pub(crate) fn test_case(number: u32) -> Case {
    let (pair, output_torque) = paper_case(number);
    case(pair, &[output_torque])
}

/// A design of section 5: the standard pair with holes (N, R, r) in its driven gear.
pub(crate) fn study_design(holes: Option<(u32, f64, f64)>, output_torques: &[f64]) -> Case {
    let solid = relieved(gear(50, 15e-3));
    let driven = holes.map_or(solid.clone(), |(count, circle_radius, radius)| {
        holed(solid.clone(), count, circle_radius, radius, 0.0)
    });
    case(pair(solid, driven, 100.5e-3), output_torques)
}

/// Numbers in [0, 1) that look drawn.
pub(crate) fn drawn(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The root mean square of what stands in `values`, one mesh period, above the tenth harmonic.
pub(crate) fn above_the_tenth_harmonic(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mut rest = values.to_vec();
    for harmonic in 0..=10 {
        let angle = |i: usize| 2.0 * std::f64::consts::PI * (harmonic * i) as f64 / count;
        let part = if harmonic == 0 { 1.0 } else { 2.0 } / count;
        let each = || values.iter().enumerate();
        let cosine: f64 = each().map(|(i, value)| value * angle(i).cos()).sum();
        let sine: f64 = each().map(|(i, value)| value * angle(i).sin()).sum();
        for (i, rest) in rest.iter_mut().enumerate() {
            *rest -= part * (cosine * angle(i).cos() + sine * angle(i).sin());
        }
    }
    (rest.iter().map(|value| value * value).sum::<f64>() / count).sqrt()
}

/// A helical pair drawn at random and its output torque: 10 to 30 degrees, tip reliefs of both shapes, crowned and sloped leads.
pub(crate) fn helical_pair(seed: u64) -> (SolidPair, f64) {
    helical_pair_with(seed, |_, _| ())
}

/// The same with a `change` of the data of each gear.
pub(crate) fn helical_pair_with(
    seed: u64,
    change: impl Fn(Member, &mut GearData),
) -> (SolidPair, f64) {
    let mut draw = drawn(seed + 1);
    let mut between = |low: f64, high: f64| low + (high - low) * draw();
    let beta = between(10.0, 30.0).to_radians();
    let width = between(12e-3, 28e-3);
    let gears = Member::BOTH.map(|member| {
        let beta = [beta, -beta][member.index()];
        let mut data = gear(between(19.0, 60.0) as u32, 8e-3);
        data.face_width = width;
        data.modifications = vec![ModificationData::TipRelief(ReliefData {
            amount: between(3e-6, 15e-6),
            shape: if between(0.0, 1.0) < 0.5 {
                ReliefShape::Linear
            } else {
                ReliefShape::Parabolic
            },
            start: ReliefStart::RadialLength(between(0.6e-3, 1.4e-3)),
        })];
        change(member, &mut data);
        helical(data, beta, 0.0)
    });
    let leads = [
        vec![LeadModification::Crowning {
            amount: between(2e-6, 8e-6),
        }],
        vec![LeadModification::Slope {
            amount: between(-8e-6, 8e-6),
        }],
    ];
    let [one, other] = gears
        .each_ref()
        .map(|gear| gear.section().reference_radius());
    let pair = SolidPair::new(gears, leads, one + other + 0.1e-3, Alignment::default());
    let pair = pair.expect("meshes");
    let torque = width * between(50e3, 200e3) / pair.section().load(1.0);
    (pair, torque)
}

/// The curve of `case`, with the stresses of both gears.
pub(crate) fn stressed(case: &Case) -> (Curve, [GearStresses; 2]) {
    let asked = Case {
        stress: true,
        ..case.clone()
    };
    let analysis = analyze(&asked, &Library::default(), &Run::unattended());
    let curve = analysis.expect("solves").curves.remove(0);
    let stresses = curve.stresses.clone().expect("were asked for");
    (curve, stresses)
}

/// A gear on its image, in six positions of one mesh period.
pub(crate) fn alike(data: GearData, beta: f64, relieved: Option<FaceEnds>, torque: f64) -> Case {
    let gears = [beta, -beta].map(|beta| helical(data.clone(), beta, 0.0));
    let a = 2.0 * gears[0].section().reference_radius() + 0.5e-3;
    // All along the face.
    let relief = relieved.map(|ends| LeadModification::EndRelief {
        amount: 25e-6,
        length: data.face_width,
        ends,
    });
    let leads = [Vec::new(), relief.into_iter().collect()];
    let pair = SolidPair::new(gears, leads, a, Alignment::default()).expect("meshes");
    let mut case = along_faces(pair, (FaceResolution::DRAFT, SLICES), &[torque]);
    case.resolution.positions_per_mesh_period = 6;
    case.resolution.span_mesh_periods = Some(1);
    case
}
