//! Pairs that depart from two plain gears in one way each, in the plane and along faces.

use std::f64::consts::PI;

use meshwright_engine::analysis::Case;
use meshwright_engine::assembly::FaceResolution;
use meshwright_engine::gear::{
    Alignment, Eccentricity, FaceEnds, GearData, GearPair, Helix, LeadModification,
    ModificationData, ReliefData, ReliefShape, ReliefStart, SolidGear, SolidPair, SpurGear,
    TablePlaces, TipEdge,
};
use meshwright_engine::grid::GridLevel;

use super::{along_faces, case, gear};

/// Output torques in N m.
pub(crate) const TORQUES: [f64; 6] = [0.0, 1e-2, 0.1, 1.0, 10.0, 100.0];

/// How a pair departs from two plain gears.
#[derive(Clone, Copy)]
pub(crate) struct Departure {
    pub(crate) name: &'static str,
    pub(crate) driving: fn(&mut GearData),
    pub(crate) driven: fn(&mut GearData),
    pub(crate) leads: fn() -> [Vec<LeadModification>; 2],
    pub(crate) alignment: Alignment,
}

const STRAIGHT: Alignment = Alignment {
    axial_offset: 0.0,
    in_plane: 0.0,
    out_of_plane: 0.0,
};

impl Departure {
    /// Of the gears alone, on straight leads and parallel axes.
    fn of_gears(name: &'static str, driving: fn(&mut GearData), driven: fn(&mut GearData)) -> Self {
        Self {
            name,
            driving,
            driven,
            leads: no_leads,
            alignment: STRAIGHT,
        }
    }
}

fn plain(_: &mut GearData) {}

fn no_leads() -> [Vec<LeadModification>; 2] {
    Default::default()
}

/// Of the profile of either gear, which the plane sees too.
pub(crate) fn of_profiles() -> Vec<Departure> {
    let of = Departure::of_gears;
    vec![
        of("nothing", plain, plain),
        of("pitch of the driving gear", pitch, plain),
        of("pitch of both", pitch, pitch),
        of("profile slopes", profile_slopes, profile_slopes),
        of("eccentricity", eccentricity, eccentricity),
        of("tip relief", tip_relief, tip_relief),
        of("root relief", plain, root_relief),
        of("crowning", crowning, plain),
        of("a slope that adds at the tip", slope, plain),
        of("a table", table, plain),
    ]
}

/// Of the other gear, or of one gear alone, and of both tip edges.
pub(crate) fn of_either_gear() -> Vec<Departure> {
    let of = Departure::of_gears;
    vec![
        of("broken tip edges", broken_edges, broken_edges),
        of("pitch of the driven gear", plain, pitch),
        of("tip relief of the driving gear", tip_relief, plain),
        of("tip relief of the driven gear", plain, tip_relief),
        of("root relief of the driving gear", root_relief, plain),
        of("crowning of the driven gear", plain, crowning),
        of("a slope of the driven gear", plain, slope),
        of("a table of the driven gear", plain, table),
    ]
}

/// Along the faces.
pub(crate) fn of_leads() -> Vec<Departure> {
    let of = |name, driving, leads, alignment| Departure {
        name,
        driving,
        driven: plain,
        leads,
        alignment,
    };
    let askew = Alignment {
        axial_offset: 2e-3,
        in_plane: 30e-6,
        out_of_plane: -20e-6,
    };
    let crowned = || {
        [
            vec![LeadModification::Crowning { amount: 12e-6 }],
            Vec::new(),
        ]
    };
    let end_relief = || {
        let relief = |amount, length, ends| LeadModification::EndRelief {
            amount,
            length,
            ends,
        };
        [
            vec![relief(15e-6, 5e-3, FaceEnds::Minus)],
            vec![relief(8e-6, 14e-3, FaceEnds::Plus)],
        ]
    };
    let tabled = || {
        let table = LeadModification::Table {
            places: vec![-9e-3, -1e-3, 4e-3, 8e-3],
            removed: vec![0.0, 9e-6, 3e-6, 12e-6],
        };
        [Vec::new(), vec![table]]
    };
    let sloped = || [vec![LeadModification::Slope { amount: -20e-6 }], Vec::new()];
    vec![
        of("lead slopes of teeth", lead_slopes, no_leads, STRAIGHT),
        of("lead crowning", plain, crowned, STRAIGHT),
        of("end relief", plain, end_relief, STRAIGHT),
        of("a lead table", plain, tabled, STRAIGHT),
        of("a lead slope", plain, sloped, STRAIGHT),
        of("misalignment", plain, no_leads, askew),
        of("misalignment and pitch", pitch, no_leads, askew),
    ]
}

/// Every third tooth stands out, and others back.
fn pitch(data: &mut GearData) {
    let arc = |i: u32| 1e-6 * [12.0, 0.0, -5.0][i as usize % 3];
    data.deviations.cumulative_pitch = (0..data.tooth_count).map(arc).collect();
}

fn profile_slopes(data: &mut GearData) {
    let amount = |i: u32| 1e-6 * (f64::from(i * 5 % 7) - 3.0) * 3.0;
    data.deviations.profile_slope = (0..data.tooth_count).map(amount).collect();
}

fn lead_slopes(data: &mut GearData) {
    let amount = |i: u32| 1e-6 * (f64::from(i * 5 % 7) - 3.0) * 4.0;
    data.deviations.lead_slope = (0..data.tooth_count).map(amount).collect();
}

fn eccentricity(data: &mut GearData) {
    data.deviations.eccentricity = Some(Eccentricity {
        amount: 15e-6,
        direction: 0.7,
    });
}

fn tip_relief(data: &mut GearData) {
    data.modifications = vec![ModificationData::TipRelief(ReliefData {
        amount: 15e-6,
        shape: ReliefShape::Linear,
        start: ReliefStart::RadialLength(0.5 * data.rack.module),
    })];
}

fn root_relief(data: &mut GearData) {
    data.modifications = vec![ModificationData::RootRelief(ReliefData {
        amount: 12e-6,
        shape: ReliefShape::Parabolic,
        start: ReliefStart::RadialLength(0.5 * data.rack.module),
    })];
}

fn crowning(data: &mut GearData) {
    data.modifications = vec![ModificationData::Crowning { amount: 10e-6 }];
}

fn slope(data: &mut GearData) {
    data.modifications = vec![ModificationData::Slope { amount: -10e-6 }];
}

fn broken_edges(data: &mut GearData) {
    data.tip_edge = TipEdge::Chamfered(0.2 * data.rack.module);
}

/// Material away from both ends and in the middle.
fn table(data: &mut GearData) {
    let plain = SpurGear::new(data.clone()).expect("a plain gear");
    let (from, to) = (plain.form_roll_length(), plain.tip_roll_length());
    let place = |part: f64| from + part * (to - from);
    data.modifications = vec![ModificationData::Table {
        places: TablePlaces::RollLengths([0.1, 0.35, 0.5, 0.7, 0.9].map(place).to_vec()),
        removed: vec![6e-6, 0.0, 4e-6, 0.0, 9e-6],
    }];
}

pub(crate) fn gears(departure: Departure) -> [GearData; 2] {
    let mut gears = [gear(20, 8e-3), gear(30, 10e-3)];
    (departure.driving)(&mut gears[0]);
    (departure.driven)(&mut gears[1]);
    gears
}

pub(crate) fn in_the_plane(gears: [GearData; 2], distance: f64) -> Case {
    let [driving, driven] = gears.map(|data| SpurGear::new(data).expect("a gear"));
    let pair = GearPair::new(driving, driven, distance).expect("meshes");
    looked_at(case(pair, &TORQUES))
}

pub(crate) fn of_gears(
    gears: [GearData; 2],
    departure: Departure,
    beta: f64,
    distance: f64,
) -> Case {
    let [driving, driven] = gears;
    let made = |data, beta| SolidGear::new(data, Helix::right(beta), 0.0, None).expect("a gear");
    let gears = [made(driving, beta), made(driven, -beta)];
    let pair = SolidPair::new(gears, (departure.leads)(), distance, departure.alignment);
    let resolution = FaceResolution {
        face_order: 4,
        web_order: 2,
        web_harmonics: 6,
        sections: GridLevel::Standard,
    };
    looked_at(along_faces(
        pair.expect("meshes"),
        (resolution, 20),
        &TORQUES,
    ))
}

/// At a few positions of which none is where pairs come or go by symmetry.
fn looked_at(mut case: Case) -> Case {
    case.resolution.grid = GridLevel::Coarse;
    case.resolution.positions_per_mesh_period = 7;
    case.resolution.first_position = 0.02 / PI;
    case.resolution.span_mesh_periods = Some(3);
    case
}
