//! Measured traces of single flanks: ghost orders, and the same gear said in two ways.

mod cases;

use std::f64::consts::TAU;

use cases::{along_faces, case, gear, helical, model_by, pair, relieved};
use meshwright_engine::analysis::{Case, Curve, Method, analyze};
use meshwright_engine::assembly::FaceResolution;
use meshwright_engine::gear::{
    Alignment, DeviationsError, GearData, GearPair, Member, ModificationData, Normals,
    PairDeviations, SolidPair, SpurGear, TablePlaces, Tolerances, ToothDeviations, ToothLeads,
    ToothProfiles,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

fn curve(case: &Case) -> Curve {
    let analysis = analyze(case, &Library::default(), &Run::unattended());
    analysis.expect("solves").curves.remove(0)
}

/// 23 teeth on 31.
fn drawn() -> [GearData; 2] {
    [relieved(gear(23, 8e-3)), relieved(gear(31, 10e-3))]
}

fn meshing([driving, driven]: [GearData; 2]) -> GearPair {
    pair(driving, driven, 54.4e-3)
}

/// Entries from the base circle to beyond the tip circle of `gear`.
fn roll_lengths(gear: &GearData, count: usize) -> Vec<f64> {
    let gear = SpurGear::new(gear.clone()).expect("can be made");
    let end = 1.1 * gear.tip_roll_length();
    (0..=count).map(|i| end * i as f64 / count as f64).collect()
}

/// Traces that remove `of` (tooth, roll length).
fn profiles(gear: &GearData, count: usize, of: impl Fn(usize, f64) -> f64) -> ToothProfiles {
    let places = roll_lengths(gear, count);
    let row = |tooth: usize| places.iter().map(|s| of(tooth, *s)).collect();
    ToothProfiles {
        removed: (0..gear.tooth_count as usize).map(row).collect(),
        places: TablePlaces::RollLengths(places),
    }
}

#[test]
fn waves_around_all_flanks_are_a_ghost_order_of_their_amplitude() {
    const AMPLITUDE: f64 = 0.2e-6;
    // On an involute of the radius r_b the roll length s is touched s/r_b later, of a driven gear earlier. Rigid flanks that
    // follow A sin(n φ) over the angle φ at which they touch make δ = A sin(n φ), however many pairs touch.
    for (member, waves) in [(Member::Driven, 43_u32), (Member::Driving, 37)] {
        let mut gears = drawn().map(|data| GearData {
            modifications: Vec::new(),
            ..data
        });
        let data = &mut gears[member.index()];
        let z = f64::from(data.tooth_count);
        let r_b = SpurGear::new(data.clone())
            .expect("can be made")
            .base_radius();
        let traces = profiles(data, 800, |tooth, s| {
            let angle = TAU * tooth as f64 / z - s / r_b;
            AMPLITUDE * (f64::from(waves) * angle).sin()
        });
        data.deviations.profiles = Some(traces);
        // The statement is of the first order: inclined flanks touch beside the line of action, and a tip corner that a wave leaves behind stays in touch
        // beyond its end. At 1 um other lines have 3 % of the amplitude.
        for (method, allowed) in [(Method::Flexible, 0.01), (Method::LoadDistribution, 0.01)] {
            let mut case = case(meshing(gears.clone()), &[0.0]);
            case.model = model_by(method, &case.model);
            let found = curve(&case);
            let spectrum = found.spectrum.expect("whole periods");
            // Orders are those of a revolution of the driven gear.
            let order = match member {
                Member::Driven => f64::from(waves),
                Member::Driving => f64::from(waves) * 31.0 / 23.0,
            };
            let amplitudes = || spectrum.order.iter().zip(&spectrum.transmission_error);
            let ghost = amplitudes().find(|(each, _)| (*each - order).abs() < 1e-6);
            let ghost = ghost.expect("a line").1;
            assert!(
                (ghost / AMPLITUDE - 1.0).abs() < 0.01,
                "{member} {method:?}: {ghost}"
            );
            let rest = amplitudes().filter(|(each, _)| (*each - order).abs() > 1e-6);
            let rest = rest.map(|(_, amplitude)| *amplitude).fold(0.0, f64::max);
            assert!(rest < allowed * AMPLITUDE, "{member} {method:?}: {rest}");
        }
    }
}

/// The same gears with teeth drawn by class 7, and with their slopes written out as traces.
fn drawn_and_written_out() -> [[GearData; 2]; 2] {
    let mut by_class = drawn();
    for (data, seed) in by_class.iter_mut().zip(0..) {
        let gear = SpurGear::new(data.clone()).expect("can be made");
        let mut normals = Normals::new(5, seed);
        data.deviations = Tolerances::of(&gear, 7).draw(gear.tooth_count(), 1.33, &mut normals);
    }
    let written_out = by_class.clone().map(|mut data| {
        let gear = SpurGear::new(data.clone()).expect("can be made");
        let [from, to] = [gear.form_roll_length(), gear.tip_roll_length()];
        let slopes = std::mem::take(&mut data.deviations.profile_slope);
        data.deviations.profiles = Some(profiles(&data, 40, |tooth, s| {
            -slopes[tooth] * (s - from) / (to - from)
        }));
        data
    });
    [by_class, written_out]
}

#[test]
fn slopes_written_out_as_traces_are_the_same_gear() {
    let [by_class, written_out] = drawn_and_written_out().map(meshing);
    for method in [Method::Flexible, Method::LoadDistribution] {
        let curves = [&by_class, &written_out].map(|pair| {
            let mut case = case(pair.clone(), &[0.0, 40.0]);
            case.model = model_by(method, &case.model);
            case.resolution.grid = GridLevel::Coarse;
            case.resolution.positions_per_mesh_period = 8;
            case.resolution.span_mesh_periods = Some(12);
            let analysis = analyze(&case, &Library::default(), &Run::unattended());
            analysis.expect("solves").curves
        });
        for (one, other) in curves[0].iter().zip(&curves[1]) {
            let deltas = one.transmission_error.iter().zip(&other.transmission_error);
            for (one, other) in deltas {
                assert!(
                    (one - other).abs() < 1e-9 * 1e-5,
                    "{method:?}: {one} {other}"
                );
            }
        }
    }
}

#[test]
fn traces_add_to_the_modifications_of_the_gear() {
    // A crowning beside the relief: for all teeth at once, and tooth by tooth.
    let crowned = |s: f64| 6e-6 * ((s - 9e-3) / 5e-3).powi(2);
    let gears = drawn();
    let [mut at_once, mut by_tooth] = [gears.clone(), gears.clone()];
    let places = roll_lengths(&gears[1], 60);
    at_once[1].modifications.push(ModificationData::Table {
        removed: places.iter().map(|s| crowned(*s)).collect(),
        places: TablePlaces::RollLengths(places),
    });
    by_tooth[1].deviations.profiles = Some(profiles(&gears[1], 60, |_, s| crowned(s)));
    let of = |gears| {
        let mut case = case(meshing(gears), &[30.0]);
        case.resolution.grid = GridLevel::Coarse;
        case.resolution.positions_per_mesh_period = 16;
        case.resolution.span_mesh_periods = Some(1);
        curve(&case).transmission_error
    };
    let [plain, at_once, by_tooth] = [gears, at_once, by_tooth].map(of);
    for ((plain, one), other) in plain.iter().zip(&at_once).zip(&by_tooth) {
        // Cells end at the kinks of a modification and pass over those of a trace.
        assert!((one - other).abs() < 20e-9, "{one} {other}");
        assert!((one - plain).abs() > 50e-9, "{one} {plain}");
    }
}

#[test]
fn lead_traces_that_slope_are_lead_slopes() {
    let slope = |tooth: usize| 1e-6 * (tooth % 5) as f64;
    let [driving, driven] = drawn();
    let width = driven.face_width;
    let of = |deviations: ToothDeviations| {
        let gears = [
            driving.clone(),
            GearData {
                deviations,
                ..driven.clone()
            },
        ];
        let gears = gears.map(|data| helical(data, 0.0, 0.0));
        let pair = SolidPair::new(
            gears,
            [Vec::new(), Vec::new()],
            54.4e-3,
            Alignment::default(),
        );
        let mut case = along_faces(
            pair.expect("meshes"),
            (FaceResolution::STANDARD, 10),
            &[0.0],
        );
        case.resolution.positions_per_mesh_period = 8;
        curve(&case).transmission_error
    };
    let slopes = of(ToothDeviations {
        lead_slope: (0..31).map(slope).collect(),
        ..ToothDeviations::default()
    });
    let leads = |removed: &dyn Fn(usize) -> Vec<f64>| ToothDeviations {
        leads: Some(ToothLeads {
            heights: vec![-0.5 * width, 0.5 * width],
            removed: (0..31).map(removed).collect(),
        }),
        ..ToothDeviations::default()
    };
    let traced = of(leads(&|tooth| vec![0.0, slope(tooth)]));
    for (one, other) in slopes.iter().zip(&traced) {
        assert!((one - other).abs() < 1e-14, "{one} {other}");
    }
    // Alike all along the face of every tooth it is a turn of the gear.
    let [none, shifted] = [0.0, 3e-6].map(|by| of(leads(&|_| vec![by; 2])));
    for (one, other) in none.iter().zip(&shifted) {
        assert!((other - one - 3e-6).abs() < 1e-12, "{one} {other}");
    }
}

#[test]
fn traces_have_a_row_for_each_tooth_and_an_entry_for_each_place() {
    let pair = meshing(drawn());
    let of = |places: Vec<f64>, removed: Vec<Vec<f64>>| {
        let traced = ToothDeviations {
            profiles: Some(ToothProfiles {
                places: TablePlaces::RollLengths(places),
                removed,
            }),
            ..ToothDeviations::default()
        };
        PairDeviations::new(&pair, [&ToothDeviations::default(), &traced])
    };
    let fits = |found: Result<PairDeviations, DeviationsError>| found.is_ok();
    assert!(fits(of(vec![5e-3, 9e-3], vec![vec![1e-6, 0.0]; 31])));
    assert!(!fits(of(vec![5e-3, 9e-3], vec![vec![1e-6, 0.0]; 30])));
    assert!(!fits(of(vec![5e-3, 9e-3], vec![vec![1e-6]; 31])));
    assert!(!fits(of(vec![9e-3, 5e-3], vec![vec![1e-6, 0.0]; 31])));
    assert!(!fits(of(vec![9e-3], vec![vec![1e-6]; 31])));
}
