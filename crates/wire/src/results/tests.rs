//! The document by hand-made curves: units, lengths, size, and the same bytes for the same numbers.

use std::f64::consts::TAU;

use meshwright_engine::analysis::RotationSpeed;
use meshwright_engine::analysis::blank_modes::{Met, MetMode};
use meshwright_engine::analysis::curve::{BlankFit, BlankSample, DecompositionParts, LoadShare};
use meshwright_engine::analysis::hole_phase::{AtTurn, HolePhase};
use meshwright_engine::analysis::largest_where::LargestPressure;
use meshwright_engine::analysis::pressures::CurvePressures;
use meshwright_engine::analysis::single_flank::SingleFlank;
use meshwright_engine::analysis::spectrum::Spectrum;
use meshwright_engine::analysis::stress::{GearStresses, PeakStress};
use meshwright_engine::analysis::{
    Case, Curve, ErrorEstimate, Evidence, SamplingError, Statistics, Warning,
};
use meshwright_engine::contact::PeakPlace;
use meshwright_engine::gear::Member;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_engine::vibration::campbell::{Crossing, Wave};
use meshwright_engine::vibration::{Direction, Mode};
use serde_json::{Value, json};

use super::*;
use crate::testing::{STUB, and, example, parse, with};
use crate::units::significant;
use crate::warning::WarningCode;
use crate::{examples, solve};

fn submission(name: &str, speed: Option<f64>) -> Submission {
    let turned = with(example(name), &[("/driving_speed_rpm", json!(speed))]);
    parse(&turned).expect("valid")
}

/// Statistics about a mean, with digits down to the last bit.
fn statistics(mean: f64, swing: f64) -> Statistics {
    Statistics {
        mean,
        rms: swing / 2_f64.sqrt(),
        peak_to_peak: 2.1 * swing,
        smallest: mean - swing,
        smallest_at: 1.0 / 3.0,
        largest: mean + 1.1 * swing,
        largest_at: 0.7,
    }
}

/// An analysis whose curves are a mean and two cosines, with digits down to the last bit as a real one has.
fn analysis(case: &Case) -> Analysis {
    let positions = case.positions();
    let eta: Vec<f64> = (0..positions)
        .map(|i| i as f64 / f64::from(case.resolution.positions_per_mesh_period))
        .collect();
    let wave = |mean: f64, swing: f64| -> Vec<f64> {
        let swung = |&eta: &f64| mean + swing * ((TAU * eta).cos() + (TAU * eta / 7.0).sin() / 3.0);
        eta.iter().map(swung).collect()
    };
    let curve = |&torque: &f64| {
        let (delta, k) = (wave(14.118e-6, 0.4e-6), wave(2.19e8, 2.4e7));
        let load = case.pair.load(torque);
        Curve {
            face: None,
            running: None,
            single_flank: SingleFlank {
                tooth_to_tooth: 0.9e-6,
                long_wave: Some(0.3e-6),
                short_wave: Some(0.8e-6),
                mesh_harmonics_rms: Some(0.1e-6),
            },
            output_torque: torque,
            load,
            points: Vec::new(),
            peak_pressures_between: Vec::new(),
            mesh_stiffness_secant: delta.iter().map(|delta| load / delta).collect(),
            driving_torque: wave(torque, 0.01 * torque),
            pairs_in_contact: vec![2; positions],
            peak_contact_pressure: wave(600e6, 50e6).into_iter().map(Some).collect(),
            pressures: CurvePressures {
                largest: Some(LargestPressure {
                    pressure: 650e6,
                    mesh_position: 2.75,
                    // On the reference circles: 50 sin 20 mm.
                    place: PeakPlace {
                        pair: 3,
                        roll_lengths: [50e-3 * 20_f64.to_radians().sin(); 2],
                        z: Some(-1e-3),
                        half_width: 0.1e-3,
                    },
                }),
                smooth: Some(640e6),
                unbounded_share: 0.125,
                at_pitch_point: Some(600e6),
            },
            load_shares: (-1..=2)
                .map(|pair_offset| LoadShare {
                    pair_offset,
                    share: wave(0.25, 0.1),
                })
                .collect(),
            transmission_error_statistics: statistics(14.118e-6, 0.4e-6),
            mesh_stiffness_tangent_statistics: statistics(2.19e8, 2.4e7),
            sampling_error: SamplingError {
                mean: 0.0,
                peak_to_peak: 0.0,
            },
            mesh_wave: None,
            spectrum: case.covers_whole_periods().then(|| {
                Spectrum::of_samples(&case.pair, case.span(), &delta, &k, case.driving_speed)
            }),
            decomposition: Some(DecompositionParts {
                rigid_blank_transmission_error: delta.clone(),
                blanks: vec![BlankFit {
                    member: Member::Driven,
                    interface_radius: 45.5e-3,
                    mean: 2e-6,
                    amplitude: 0.1e-6,
                    phase: 1.0,
                    higher: vec![(0.05e-6, 0.5)],
                    samples: vec![BlankSample {
                        mesh_position: 0.25,
                        rotation: 2.05e-6,
                    }],
                }],
            }),
            stresses: Some([
                GearStresses {
                    root: peaks(&[100e6, 140e6]),
                    root_tension: peaks(&[100e6, 150e6]),
                    root_compression: peaks(&[-160e6, -120e6]),
                    holes: Vec::new(),
                    between: Vec::new(),
                },
                GearStresses {
                    root: peaks(&[120e6, 110e6]),
                    root_tension: peaks(&[120e6, 110e6]),
                    root_compression: peaks(&[-130e6, -140e6]),
                    holes: peaks(&[30e6, 31e6]),
                    between: Vec::new(),
                },
            ]),
            mesh_position: eta.clone(),
            transmission_error: delta,
            mesh_stiffness_tangent: k,
        }
    };
    Analysis {
        curves: case.output_torques.iter().map(curve).collect(),
        evidence: Evidence {
            degrees_of_freedom: 1000,
            equilibrium_residual: 1e-13,
            complementarity_residual: 1e-15,
            largest_penetration: 1e-18,
            contact_iterations: 7,
            projection_error: Some(2e-9),
            decomposition_error: Some(3e-9),
            error_estimate: Some(ErrorEstimate {
                mean: 1e-9,
                peak_to_peak: 2e-9,
                mean_stiffness: 1e5,
            }),
        },
        hole_phase: Some(HolePhase {
            output_torque: 115.0,
            order: 10,
            turn_of_driving: TAU / 16.0,
            amplitude: 4e-10,
            amplitude_now: 418e-9,
            other_flanks_turn: TAU / 32.0,
            over_turn: vec![AtTurn {
                turn: TAU / 64.0,
                amplitude: 0.5e-6,
                peak_to_peak: 4e-6,
            }],
        }),
        warnings: vec![Warning::TipCornerContact {
            member: Member::Driven,
            largest_share: 0.125,
        }],
    }
}

/// The document of hand-made curves.
fn written(submission: &Submission) -> String {
    let results = Results::of(submission, &analysis(submission.case()), None);
    results.to_json().expect("finite")
}

/// Stresses at half a turn.
fn peaks(stresses: &[f64]) -> Vec<PeakStress> {
    let peak = |&stress: &f64| PeakStress {
        stress,
        angle: TAU / 2.0,
        radius: 22e-3,
        z: Some(-2e-3),
    };
    stresses.iter().map(peak).collect()
}

#[test]
fn the_document_speaks_the_units_of_its_names() {
    let submission = submission("test-case-2", Some(600.0));
    let text = written(&submission);
    let document: Value = serde_json::from_str(&text).expect("JSON");
    let curve = &document["curves"][0];
    let near = |pointer: &str, expected: f64| {
        let value = document
            .pointer(pointer)
            .and_then(Value::as_f64)
            .expect(pointer);
        assert!(
            (value - expected).abs() <= 1e-9 * expected.abs(),
            "{pointer}: {value} {expected}"
        );
    };
    // The first sample is the mean and the whole swing; F = T/r_b2 with r_b2 = 50 cos 20 mm.
    near("/curves/0/transmission_error_um/0", 14.518);
    near("/curves/0/mesh_stiffness_tangent_n_per_m/0", 2.43e8);
    near("/curves/0/peak_contact_pressure_mpa/0", 650.0);
    let r_b2 = 0.05 * 20_f64.to_radians().cos();
    near("/curves/0/load_n", 115.0 / r_b2);
    near("/curves/0/driven_angle_deg/40", 7.2);
    near("/curves/0/decomposition/blanks/0/interface_radius_mm", 45.5);
    near(
        "/curves/0/decomposition/blanks/0/phase_deg",
        1_f64.to_degrees(),
    );
    near(
        "/evidence/error_estimate/transmission_error_peak_to_peak_um",
        2e-3,
    );
    near("/evidence/decomposition_error_um", 3e-3);
    near("/hole_phase/turn_of_driving_deg", 22.5);
    near("/hole_phase/other_flanks_turn_deg", 11.25);
    near("/hole_phase/amplitude_um", 4e-4);
    near("/hole_phase/amplitude_now_um", 0.418);
    near("/hole_phase/over_turn/turn_of_driving_deg/0", 5.625);
    near("/hole_phase/over_turn/amplitude_um/0", 0.5);
    near("/hole_phase/over_turn/peak_to_peak_um/0", 4.0);
    near("/curves/0/stress/driving/root_mpa/1", 140.0);
    near("/curves/0/stress/driven/hole_angle_deg/0", 180.0);
    near("/curves/0/stress/driven/hole_z_mm/0", -2.0);
    near("/curves/0/statistics/stress/driving/root_mpa", 140.0);
    let pressure = "/curves/0/statistics/peak_contact_pressure_mpa";
    near(&format!("{pressure}/largest"), 650.0);
    near("/curves/0/smooth_contact_pressure_mpa", 640.0);
    near("/curves/0/pitch_point_pressure_mpa", 600.0);
    near("/curves/0/pressure_unbounded_share", 0.125);
    for (name, expected) in [
        ("mesh_position", 2.75),
        ("pair_offset", 1.0),
        ("driving_diameter_mm", 100.0),
        ("driven_diameter_mm", 100.0),
        ("z_mm", -1.0),
    ] {
        near(&format!("{pressure}/largest_where/{name}"), expected);
    }
    let stands = &curve["statistics"]["stress"]["driving"]["largest_where"];
    assert_eq!(stands["root_mpa"]["mesh_position"], json!(0.025));
    assert_eq!(stands["root_compression_mpa"]["mesh_position"], json!(0.0));
    assert_eq!(stands["root_mpa"]["driving_diameter_mm"], json!(44.0));
    assert_eq!(stands["root_mpa"].get("driven_diameter_mm"), None);
    assert_eq!(stands.get("hole_mpa"), None);
    let of_hole = &curve["statistics"]["stress"]["driven"]["largest_where"]["hole_mpa"];
    assert_eq!(of_hole.get("pair_offset"), None);
    near("/curves/0/statistics/stress/driven/hole_mpa", 31.0);
    near("/curves/0/stress/driving/root_compression_mpa/0", -160.0);
    for (name, expected) in [("tension", 150.0), ("compression", -160.0)] {
        near(
            &format!("/curves/0/statistics/stress/driving/root_{name}_mpa"),
            expected,
        );
    }
    for without_holes in [
        "/stress/driving/hole_mpa",
        "/statistics/stress/driving/hole_mpa",
    ] {
        assert_eq!(curve.pointer(without_holes), None);
    }
    near("/evidence/largest_penetration_um", 1e-12);
    near("/warnings/0/value", 12.5);
    // 600 rpm are 10 Hz; 50 teeth mesh at 500 Hz; the order counts turns of the driven gear, here 10 Hz too.
    near("/frequencies/mesh_hz", 500.0);
    near("/frequencies/period_hz", 100.0);
    let order = curve["spectrum"]["order"][0].as_f64().expect("a number");
    near("/curves/0/spectrum/frequency_hz/0", 10.0 * order);
    assert_eq!(curve["decomposition"]["blanks"][0]["gear"], "driven");
    assert_eq!(document["evidence"]["input_hash"], submission.input_hash());
    assert_eq!(document["evidence"]["resolution"]["grid"], "standard");
    assert_eq!(curve["statistics"]["partial"], false);
    assert!(!text.contains("null"));
}

#[test]
fn all_lists_of_a_curve_have_one_entry_a_position() {
    let submission = submission("standard-pair", None);
    let text = written(&submission);
    let document: Value = serde_json::from_str(&text).expect("JSON");
    let curves = document["curves"].as_array().expect("curves");
    assert_eq!(curves.len(), 2);
    for curve in curves {
        for (name, list) in curve.as_object().expect("a curve") {
            if let Some(list) = list.as_array().filter(|_| name != "load_shares") {
                assert_eq!(list.len(), 40, "{name}");
            }
        }
        for share in curve["load_shares"].as_array().expect("shares") {
            assert_eq!(share["share"].as_array().expect("a list").len(), 40);
        }
        assert_eq!(
            curve["spectrum"]["order"].as_array().expect("a list").len(),
            20
        );
    }
    assert!(document.get("frequencies").is_none());
}

#[test]
fn the_results_of_case_3_stay_below_a_megabyte_and_a_half() {
    let submission = submission("test-case-3", Some(1000.0));
    let text = written(&submission);
    assert!(text.len() < 1_500_000, "{} bytes", text.len());
}

#[test]
fn the_same_numbers_give_the_same_bytes_and_a_number_that_is_not_finite_gives_none() {
    let submission = submission("test-case-2", None);
    let mut analysis = analysis(submission.case());
    let write = |analysis: &Analysis| Results::of(&submission, analysis, None).to_json();
    assert_eq!(write(&analysis), write(&analysis));
    analysis.curves[0].mesh_stiffness_secant[3] = f64::INFINITY;
    assert_eq!(
        write(&analysis).expect_err("not finite").code,
        Code::InternalError
    );
}

#[test]
fn an_interface_radius_that_is_left_to_one_gear_s_default_has_results() {
    let mut document = example("test-case-2");
    for radii in [
        serde_json::json!({ "driving": null }),
        serde_json::json!({ "driving": null, "driven": 44.5 }),
        serde_json::json!({ "driving": null, "driven": null }),
        serde_json::json!({}),
    ] {
        document["resolution"]["interface_radius_mm"] = radii;
        let submission = parse(&document).expect("valid");
        let written: Value = serde_json::from_str(&written(&submission)).expect("JSON");
        let radii = &written["evidence"]["resolution"]["interface_radius_mm"];
        assert!(radii.get("driving").is_none(), "{radii}");
    }
}

/// Reads a document, writes it again, and holds it to its own bytes.
fn reads_back(text: &str) -> Results {
    let read = Results::read(text).expect("a results document");
    assert_eq!(read.to_json().expect("finite"), text);
    read
}

#[test]
fn the_results_of_every_example_read_back_to_the_same_bytes() {
    let mut read = 0;
    for example in examples() {
        let mut document: Value = serde_json::from_str(example.json).expect("JSON");
        document["driving_speed_rpm"] = json!(600.0);
        // Documents that are no submissions are studies.
        if let Ok(submission) = parse(&document) {
            reads_back(&written(&submission));
            read += 1;
        }
    }
    assert!(read > 20, "{read}");
}

#[test]
fn computed_results_read_back_with_all_that_they_may_have() {
    let computed = |name: &str, change: Value| {
        let submission = parse(&and(example(name), &change)).expect("valid");
        let results = solve(&submission, &Library::default(), &Run::unattended());
        let results = results.expect("results");
        reads_back(&results.to_json().expect("finite"))
    };
    let few = json!({ "grid": "coarse", "positions_per_mesh_period": 8 });
    let plane = json!({ "method": "flexible", "stress": true, "resolution": few, "output_torques_n_m": [115, 0] });
    let curve = &computed("test-case-2", plane).curves[0];
    assert!(curve.stress.is_some() && curve.spectrum.is_some());
    let parts = json!({ "method": "decomposition", "resolution": few });
    assert!(
        computed("test-case-2", parts).curves[0]
            .decomposition
            .is_some()
    );
    let faces = json!({ "output_torques_n_m": [200],
        "resolution": { "positions_per_mesh_period": 8, "face_order": 4, "face_slices": 10 } });
    assert!(computed("helical-pair", faces).curves[0].face.is_some());
    let speeds = computed("run-up", json!({ "resolution": few }));
    assert!(speeds.curves[0].dynamics.is_some() && speeds.force_table.is_some());
}

/// The lists of a curve over positions, those of shares, stresses and faces too.
fn lists(curve: &Value) -> Vec<&Vec<Value>> {
    let stresses = ["driving", "driven"].map(|gear| &curve["stress"][gear]);
    let objects = [curve, &curve["decomposition"]].into_iter().chain(stresses);
    let objects = objects.chain(curve["load_shares"].as_array().into_iter().flatten());
    let members = objects.filter_map(Value::as_object).flatten();
    let members = members.filter(|(name, _)| !["load_shares", "blanks"].contains(&name.as_str()));
    let own = members.filter_map(|(_, list)| list.as_array());
    own.chain(curve["face"]["load_centroid_mm"].as_array())
        .collect()
}

#[test]
fn points_between_positions_make_the_lists_reach_the_extremes_of_the_statistics() {
    let few = json!({ "grid": "coarse", "positions_per_mesh_period": 8 });
    let document = and(
        example("test-case-2"),
        &json!({ "method": "flexible", "stress": true, "resolution": few, "output_torques_n_m": [115, 0] }),
    );
    // No corner carries, so that the largest pressure has a limit.
    let mut document = document;
    for gear in ["driving", "driven"] {
        let start = json!({ "radial_length_mm": 1.75 });
        document["pair"][gear]["tip_relief"] =
            json!({ "amount_um": 40, "shape": "parabolic", "start": start });
    }
    let submission = parse(&document).expect("valid");
    let results = solve(&submission, &Library::default(), &Run::unattended()).expect("results");
    let plain: Value = serde_json::from_str(&results.to_json().expect("finite")).expect("JSON");
    let merged = results.with_points().expect("of this version");
    let merged: Value = serde_json::from_str(&merged.to_json().expect("finite")).expect("JSON");
    let numbers = |list: &Value| -> Vec<f64> {
        let items = list.as_array().expect("a list").iter();
        items.filter_map(Value::as_f64).collect()
    };
    let extremes = |list: &Value| {
        let [low, high] = [f64::min, f64::max].map(|wider| numbers(list).into_iter().reduce(wider));
        (low.expect("some"), high.expect("some"))
    };
    for (curve, plain) in merged["curves"]
        .as_array()
        .expect("curves")
        .iter()
        .zip(plain["curves"].as_array().expect("curves"))
    {
        let positions = numbers(&curve["mesh_position"]);
        assert!(positions.len() > numbers(&plain["mesh_position"]).len() && positions.is_sorted());
        assert!(
            lists(curve)
                .iter()
                .all(|list| list.len() == positions.len())
        );
        assert!(curve.get("between").is_none());
        for name in ["transmission_error_um", "mesh_stiffness_tangent_n_per_m"] {
            let (low, high) = extremes(&curve[name]);
            let told = &curve["statistics"][name];
            for (found, told) in [(low, &told["smallest"]), (high, &told["largest"])] {
                // To the last digit that is told; what is zero but for rounding has none.
                let told = told.as_f64().expect("a number");
                assert!(
                    found == told || (found - told).abs() < 1e-15,
                    "{name}: {found} {told}"
                );
            }
            assert_eq!(
                json!(significant(high - low, 10)),
                told["peak_to_peak"],
                "{name}"
            );
        }
        for i in 0..positions.len() {
            let shares = curve["load_shares"].as_array().expect("shares").iter();
            let sum: f64 = shares.map(|share| numbers(&share["share"])[i]).sum();
            assert!((sum - 1.0).abs() < 1e-8, "{sum}");
        }
    }
    let loaded = &merged["curves"][0];
    let largest = &loaded["statistics"]["peak_contact_pressure_mpa"]["largest"];
    assert_eq!(
        &json!(extremes(&loaded["peak_contact_pressure_mpa"]).1),
        largest
    );
    for gear in ["driving", "driven"] {
        let largest = &loaded["statistics"]["stress"][gear]["root_mpa"];
        assert_eq!(
            &json!(extremes(&loaded["stress"][gear]["root_mpa"]).1),
            largest
        );
    }
    // Where a pair takes up the load k is told from both sides.
    let positions = numbers(&loaded["mesh_position"]);
    let (k, pairs) = (
        numbers(&loaded["mesh_stiffness_tangent_n_per_m"]),
        numbers(&loaded["pairs_in_contact"]),
    );
    let twice: Vec<usize> = (1..positions.len())
        .filter(|&i| positions[i] == positions[i - 1])
        .collect();
    assert!(
        twice.len() >= 2 * 5,
        "two events in each of five mesh periods"
    );
    assert!(twice.iter().all(|&i| {
        (k[i] > 1.02 * k[i - 1] && pairs[i] > pairs[i - 1])
            || (k[i] < k[i - 1] / 1.02 && pairs[i] < pairs[i - 1])
    }));
    // A part of a period ends in a point, at which the pairs have other offsets than at the last position.
    let few = json!({ "positions_per_mesh_period": 8, "span_mesh_periods": 1 });
    let part = json!({ "method": "load_distribution", "resolution": few });
    let part = parse(&and(example("test-case-2"), &part)).expect("valid");
    let results = solve(&part, &Library::default(), &Run::unattended()).expect("results");
    let curve = results
        .with_points()
        .expect("of this version")
        .curves
        .remove(0);
    let places = curve.mesh_position.iter();
    let last = places
        .clone()
        .position(|eta| *eta == 0.875)
        .expect("solved");
    let end = places.clone().position(|eta| *eta == 1.0).expect("the end");
    let share = |offset: i32, i: usize| {
        let mut shares = curve.load_shares.iter();
        let share = shares.find(|share| share.pair_offset == offset);
        share.map_or(0.0, |share| share.share[i])
    };
    assert!(share(1, last) > 0.0);
    for offset in -1..=1 {
        assert!(
            (share(offset, end) - share(offset + 1, last)).abs() < 1e-9,
            "{offset}"
        );
    }
    // Results of earlier versions kept none.
    let earlier = Results::read(STUB).expect("a results document");
    assert!(earlier.with_points().is_none());
}

#[test]
fn the_force_table_of_a_helical_pair_tells_its_backlash_along_the_transverse_line_of_action() {
    let gear = |tooth_count: u32| json!({ "tooth_count": tooth_count, "module_mm": 2, "face_width_mm": 10, "blank": { "bore_radius_mm": 10 } });
    // 20/40 at 30 degrees; beyond a distance of 60/cos 30 degrees there is backlash.
    let document = json!({
        "method": "three_dimensional",
        "pair": { "center_distance_mm": 69.4, "helix_angle_deg": 30, "driving": gear(20), "driven": gear(40) },
        "output_torques_n_m": [20],
        "resolution": { "positions_per_mesh_period": 8, "face_order": 4, "face_slices": 10 },
        "force_table": { "loads": 4 },
    });
    let submission = parse(&document).expect("valid");
    let results = solve(&submission, &Library::default(), &Run::unattended()).expect("results");
    let transverse = 1e3 * results.pair.backlash_line_of_action_mm;
    assert!(transverse > 1.1e3 * results.pair.backlash_mm && transverse > 50.0);
    let table = results.force_table.expect("asked for");
    assert!(table.backlash_um.len() >= 8);
    // Unmodified teeth have it at every position.
    for backlash in table.backlash_um {
        assert!(
            (backlash / transverse - 1.0).abs() < 1e-6,
            "{backlash} {transverse}"
        );
    }
}

#[test]
fn documents_of_other_versions_are_read_and_what_they_do_not_tell_is_never_written() {
    let mut document: Value = serde_json::from_str(STUB).expect("JSON");
    document["later"] = json!({ "of": "a later version" });
    let known = document["curves"][0]["spectrum"]["named"][0].clone();
    let mut unknown = known.clone();
    unknown["kind"] = json!("of_a_later_version");
    document["curves"][0]["spectrum"]["named"] = json!([unknown, known]);
    document["warnings"] = json!([{ "code": "of_a_later_version", "detail": "" },
        { "code": "zero_backlash", "detail": "" }]);
    let read = Results::read(&document.to_string()).expect("a later one");
    assert_eq!(
        (read.warnings.len(), read.warnings[0].code),
        (1, WarningCode::ZeroBacklash)
    );
    assert_eq!(
        read.curves[0]
            .spectrum
            .as_ref()
            .map(|spectrum| spectrum.named.len()),
        Some(1)
    );
    assert!(read.to_json().is_ok());

    // As version 0.3.0 wrote it.
    for curve in document["curves"].as_array_mut().expect("curves") {
        curve
            .as_object_mut()
            .expect("a curve")
            .remove("driving_torque_n_m");
    }
    for gear in ["driving", "driven"] {
        let gear = document["pair"][gear].as_object_mut().expect("a gear");
        gear.retain(|name, _| !name.ends_with("_diameter_mm"));
    }
    let path = document["pair"]["path_of_contact"]
        .as_object_mut()
        .expect("a path");
    for point in ["a", "b", "c", "d", "e"] {
        let told = path.remove(&format!("point_{point}")).expect("told");
        path.insert(point.to_owned(), told);
    }
    let read = Results::read(&document.to_string()).expect("an earlier one");
    assert!(read.curves[0].driving_torque_n_m.is_empty());
    assert_eq!(read.pair.path_of_contact.point_b.mesh_position, -0.2);
    assert!(read.pair.driving.form_diameter_mm.is_nan());
    assert!(read.to_json().is_err());
}

#[test]
fn modes_stand_in_the_results_and_a_warning_names_their_crossings_within_the_speeds_asked() {
    let mode = Mode {
        frequency: 4000.0,
        is_double: true,
        direction: Direction::OutOfPlane,
        nodal_diameters: 2,
        nodal_circles: 0,
        coriolis: 0.0,
        residual: 0.0,
        shape: Vec::new(),
    };
    let met = |wave, turns: f64| Met {
        crossing: Crossing {
            multiple: 1,
            wave,
            turns,
        },
        driving_speed: RotationSpeed(turns),
    };
    // 50 teeth: 4000/(50 + 2) and 4000/(50 - 2) turns a second.
    let found = MetMode {
        mode,
        met: vec![
            met(Wave::Backward, 4000.0 / 52.0),
            met(Wave::Forward, 4000.0 / 48.0),
        ],
    };
    let told = |dynamics: Value| {
        let asked = [("/modes", json!({})), ("/dynamics", dynamics)];
        let submission = parse(&with(example("test-case-2"), &asked)).expect("valid");
        let results = Results::of(&submission, &analysis(submission.case()), None);
        let results = results.with_modes(&submission, &[Vec::new(), vec![found.clone()]]);
        let text = results.to_json().expect("finite");
        serde_json::from_str::<Value>(&text).expect("JSON")
    };
    let range = json!({ "driving_speed_rpm": { "from": 0, "to": 6000 } });
    let document = told(range);
    let mode = &document["modes"]["driven"][0];
    assert_eq!(mode["direction"], "out_of_plane");
    assert_eq!(mode["wave_split"], 2.0);
    assert_eq!(mode["crossings"][1]["driving_speed_rpm"], 5000.0);
    assert_eq!(mode["crossings"][1]["label"], "H_Z2");
    assert_eq!(mode["crossings"][1]["wave"], "forward");
    let warnings = document["warnings"].as_array().expect("a list");
    let warning = warnings
        .iter()
        .find(|warning| warning["code"] == "modes_met");
    let warning = warning.expect("the mesh meets a mode");
    assert_eq!(warning["gear"], "driven");
    let detail = warning["detail"].as_str().expect("words");
    for words in [
        "H_Z2 at 4615 1/min",
        "H_Z2 at 5000 1/min",
        "4000 Hz",
        "n = 2",
        "out of the plane",
    ] {
        assert!(detail.contains(words), "{detail}");
    }
    let unseen = document["evidence"]["does_not_see"].to_string();
    assert!(unseen.contains("in the natural modes"), "{unseen}");
    // Without a range of speeds nothing is warned of.
    let anywhere = told(Value::Null);
    assert!(!anywhere["warnings"].to_string().contains("modes_met"));
}
