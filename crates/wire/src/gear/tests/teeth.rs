//! Teeth: tip circles and edges, thickness, modifications and deviations.

use meshwright_engine::gear::{ModificationData, TablePlaces, TipEdge};
use serde_json::{Value, json};

use super::{data_of, fault, faults, near, with};
use crate::Code;
use crate::testing::{and, parse, refused};

#[test]
fn a_tip_diameter_says_the_addendum() {
    // 104 mm on 50 teeth of module 2 is an addendum of a module; a shift of -0.1 makes it 2.2 mm.
    near(
        data_of(&json!({ "tip_diameter_mm": 104.0 })).rack.addendum,
        2e-3,
    );
    let shifted = json!({ "tip_diameter_mm": 104.0, "profile_shift": -0.1, "addendum_mm": null });
    near(data_of(&shifted).rack.addendum, 2.2e-3);
    let both = json!({ "tip_diameter_mm": 104.0, "addendum_mm": 2.0 });
    fault(&both, "tip_diameter_mm", Code::ConflictingFields);
}

#[test]
fn a_tip_diameter_has_the_bounds_of_the_addendum_and_answers_in_its_own_words() {
    let low = fault(
        &json!({ "tip_diameter_mm": 99.0 }),
        "tip_diameter_mm",
        Code::OutOfRange,
    );
    assert_eq!(low.nearest, Some(100.8), "0.2 modules of addendum: {low:?}");
    let pointed = fault(
        &json!({ "tip_diameter_mm": 107.9 }),
        "tip_diameter_mm",
        Code::PointedTip,
    );
    let nearest = pointed.nearest.expect("a diameter that leaves a tip");
    assert!((105.0..107.9).contains(&nearest), "{pointed:?}");
    // The gear can be made; at this center distance its long teeth reach below the flanks of the other.
    let left = faults(&json!({ "tip_diameter_mm": nearest }));
    assert_eq!(left[0].code, Code::Interference, "{left:?}");
}

#[test]
fn thickness_and_edges_reach_the_engine_in_meters() {
    let thin = data_of(&json!({ "tooth_thickness_deviation_um": -60.0 }));
    assert_eq!(thin.thickness_deviation, -60e-6);
    let edge = |fields: Value| data_of(&fields).tip_edge;
    assert_eq!(
        edge(json!({ "tip_rounding_mm": 0.2 })),
        TipEdge::Rounded(0.2e-3)
    );
    assert_eq!(
        edge(json!({ "tip_chamfer_mm": 0.3 })),
        TipEdge::Chamfered(0.3e-3)
    );
    for sharp in [
        json!({}),
        json!({ "tip_rounding_mm": 0 }),
        json!({ "tip_chamfer_mm": null }),
    ] {
        assert_eq!(edge(sharp), TipEdge::Sharp);
    }
    let both = json!({ "tip_rounding_mm": 0.2, "tip_chamfer_mm": 0.2 });
    fault(&both, "tip_chamfer_mm", Code::ConflictingFields);
}

#[test]
fn teeth_and_edges_that_do_not_fit_are_answered_with_those_that_do() {
    for (fields, place, code, _) in refused! {
        json!({ "tooth_thickness_deviation_um": 900, "thinned_by": "flank_grinding" }) => "tooth_thickness_deviation_um", TeethTooThick;
        json!({ "tooth_thickness_deviation_um": -1100 }) => "tooth_thickness_deviation_um", OutOfRange;
        json!({ "tip_rounding_mm": 3.0 }) => "tip_rounding_mm", TipEdgeTooLarge;
        json!({ "tip_chamfer_mm": 3.0 }) => "tip_chamfer_mm", TipEdgeTooLarge;
        json!({ "tip_chamfer_mm": 0.01 }) => "tip_chamfer_mm", OutOfRange;
    } {
        let found = faults(&fields);
        assert_eq!(
            (&*found[0].pointer, found[0].code),
            (&*format!("/pair/driving/{place}"), code),
            "{found:?}"
        );
        assert!(found[0].nearest.is_some(), "{found:?}");
    }
}

#[test]
fn modifications_follow_the_short_form_in_the_order_of_the_document() {
    let start = json!({ "radial_length_mm": 1.0 });
    let data = data_of(&json!({
        "tip_relief": { "amount_um": 5.0, "start": start },
        "profile_modifications": [
            { "kind": "root_relief", "amount_um": 6.0, "shape": "parabolic", "start": { "roll_length_from_form_mm": 1.5 } },
            { "kind": "crowning", "amount_um": -3.0 },
            { "kind": "slope", "amount_um": 4.0 },
            { "kind": "table", "roll_length_mm": [14.0, 16, 20], "removed_um": [3, 0, -1.5] },
            { "kind": "table", "diameter_mm": [97.0, 103.0], "removed_um": [0, 2] },
            { "kind": "tip_relief", "amount_um": 7.0, "start": start }
        ]
    }));
    let words: Vec<_> = data
        .modifications
        .iter()
        .map(|modification| match modification {
            ModificationData::TipRelief(relief) => format!("tip {:e}", relief.amount),
            ModificationData::RootRelief(relief) => format!("root {:e}", relief.amount),
            ModificationData::Crowning { amount } => format!("crowning {amount:e}"),
            ModificationData::Slope { amount } => format!("slope {amount:e}"),
            ModificationData::Table { places, removed } => match places {
                TablePlaces::RollLengths(places) => format!("lengths {places:?} {removed:?}"),
                TablePlaces::Diameters(places) => format!("diameters {places:?} {removed:?}"),
            },
        })
        .collect();
    assert_eq!(
        words,
        [
            "tip 5e-6",
            "root 6e-6",
            "crowning -3e-6",
            "slope 4e-6",
            "lengths [0.014, 0.016, 0.02] [3e-6, 0.0, -1.5e-6]",
            "diameters [0.097, 0.103] [0.0, 2e-6]",
            "tip 7e-6",
        ]
    );
}

#[test]
fn a_relief_off_the_flank_is_told_where_it_stands_with_a_start_that_would_do() {
    // The flank of this gear reaches from 48.3135 mm to 52 mm.
    let listed = |kind: &str, start: Value| {
        json!({ "profile_modifications": [
            { "kind": "crowning", "amount_um": 1 },
            { "kind": kind, "amount_um": 5, "start": start }
        ] })
    };
    for (kind, name, value) in [
        ("tip_relief", "radial_length_mm", 3.8),
        ("tip_relief", "radial_length_mm", 0.001),
        ("tip_relief", "roll_length_from_tip_mm", 15.0),
        ("root_relief", "radial_length_mm", 3.8),
        ("root_relief", "radial_length_mm", 0.001),
        ("root_relief", "roll_length_from_form_mm", 15.0),
        ("root_relief", "roll_length_from_form_mm", 0.001),
        ("root_relief", "diameter_mm", 96.6),
        ("root_relief", "diameter_mm", 104.1),
        ("root_relief", "roll_angle_deg", 1.0),
    ] {
        let place = format!("profile_modifications/1/start/{name}");
        let found = fault(
            &listed(kind, json!({ name: value })),
            &place,
            Code::ReliefTooLong,
        );
        let nearest = found.nearest.expect("a start that would do");
        data_of(&listed(kind, json!({ name: nearest })));
    }
}

#[test]
fn a_table_is_told_its_first_entry_that_does_not_rise_and_how_many_values_it_needs() {
    let modified = |modifications: Value| json!({ "profile_modifications": modifications });
    let of = |fields: Value| modified(json!([and(json!({ "kind": "table" }), &fields)]));
    let table = |places: Value, removed: Value| {
        of(json!({ "roll_length_mm": places, "removed_um": removed }))
    };
    let diameters = |places: Value| of(json!({ "diameter_mm": places, "removed_um": [0, 0] }));
    let many: Vec<u32> = (0..1001).collect();
    let both =
        json!({ "diameter_mm": [98, 100], "roll_length_mm": [15, 16], "removed_um": [0, 0] });
    let seventeen = vec![json!({ "kind": "slope", "amount_um": 1 }); 17];
    for (fields, place, code, nearest) in refused! {
        // A unit in the fifth digit.
        table(json!([14, 15, 15, 16]), json!([0, 0, 0, 0])) => "/0/roll_length_mm/2", TableDoesNotRise, 15.001;
        table(json!([14, 15, 16]), json!([0, 1])) => "/0/removed_um", WrongLength, 3.0;
        table(json!([14]), json!([0])) => "/0/roll_length_mm", WrongLength, 2.0;
        table(json!(many), json!([0, 1])) => "/0/roll_length_mm", TooLarge, 1000.0;
        // The base circle of 100 cos 20 mm.
        diameters(json!([90, 100])) => "/0/diameter_mm/0", OutOfRange, 93.97;
        of(both) => "/0/diameter_mm", ConflictingFields;
        of(json!({ "removed_um": [0, 0] })) => "/0", MissingField;
        modified(json!([{ "kind": "helix" }])) => "/0/kind", WrongType;
        modified(json!(seventeen)) => "", TooLarge, 16.0;
    } {
        let found = fault(&fields, &format!("profile_modifications{place}"), code);
        assert_eq!(found.nearest, nearest, "{found:?}");
    }
    let falling = faults(&table(json!([14, 15, 15, 13]), json!([0, 0, 0, 0])));
    let together: Vec<_> = falling.iter().map(|fault| fault.nearest).collect();
    assert_eq!(together, [Some(15.001), Some(15.002)], "{falling:?}");
}

/// Single deviations that rise by `step` on every even tooth and fall on every odd one.
fn alternating(step: f64) -> Vec<f64> {
    (0..50)
        .map(|i| if i % 2 == 0 { step } else { -step })
        .collect()
}

#[test]
fn deviations_reach_the_engine_and_single_ones_sum_up_from_the_last_tooth() {
    let slopes: Vec<u32> = (0..50).collect();
    let data = data_of(&json!({ "tooth_deviations": {
        "pitch_single_um": alternating(4.0), "profile_slope_um": slopes,
        "eccentricity": { "amount_um": 12.0, "phase_deg": 90.0 }
    } }));
    let deviations = &data.deviations;
    let pitch: Vec<_> = deviations
        .cumulative_pitch
        .iter()
        .map(|f| f * 1e6)
        .collect();
    assert_eq!(
        pitch,
        (0..50)
            .map(|i| if i % 2 == 0 { 4.0 } else { 0.0 })
            .collect::<Vec<_>>()
    );
    near(deviations.profile_slope[7], 7e-6);
    let eccentricity = deviations.eccentricity.expect("eccentric");
    near(eccentricity.amount, 12e-6);
    near(eccentricity.direction, std::f64::consts::FRAC_PI_2);
    let given =
        data_of(&json!({ "tooth_deviations": { "pitch_cumulative_um": alternating(4.0) } }));
    near(given.deviations.cumulative_pitch[1], -4e-6);
    assert!(
        data_of(&json!({ "tooth_deviations": {} }))
            .deviations
            .is_none()
    );
}

#[test]
fn other_flanks_stand_where_a_list_of_their_own_says() {
    let given = data_of(
        &json!({ "tooth_deviations": { "other_flank_pitch_cumulative_um": alternating(4.0) } }),
    );
    near(given.deviations.other_cumulative_pitch[1], -4e-6);
    assert!(given.deviations.cumulative_pitch.is_empty());
    let short = json!({ "tooth_deviations": { "other_flank_pitch_cumulative_um": [1.0] } });
    let place = "tooth_deviations/other_flank_pitch_cumulative_um";
    fault(&short, place, Code::WrongLength);
    let far =
        json!({ "tooth_deviations": { "other_flank_pitch_cumulative_um": alternating(600.0) } });
    fault(&far, &format!("{place}/0"), Code::OutOfRange);
}

#[test]
fn deviations_need_one_number_a_tooth_and_single_ones_have_to_close() {
    let single = |values: &[f64]| json!({ "tooth_deviations": { "pitch_single_um": values } });
    let place = "tooth_deviations/pitch_single_um";
    let short = fault(&single(&[1.0, -1.0]), place, Code::WrongLength);
    assert_eq!(short.nearest, Some(50.0));
    assert!(short.detail.contains("50 are needed"), "{}", short.detail);
    let mut open = alternating(4.0);
    open[3] += 0.5;
    let open = fault(&single(&open), place, Code::PitchDoesNotClose);
    assert!(
        open.detail.contains("sums to 0.5 um") && open.detail.contains("0.01 um less in each"),
        "{}",
        open.detail
    );
    let mut closes = alternating(4.0);
    closes[3] += 0.01;
    data_of(&single(&closes));
    let both = json!({ "tooth_deviations": { "pitch_single_um": [], "pitch_cumulative_um": [] } });
    fault(&both, place, Code::ConflictingFields);
    // A quarter of a module.
    let far = fault(
        &single(&alternating(600.0)),
        &format!("{place}/0"),
        Code::OutOfRange,
    );
    assert_eq!(far.nearest, Some(500.0));
    let eccentric = json!({ "tooth_deviations": { "eccentricity": { "amount_um": 700 } } });
    fault(
        &eccentric,
        "tooth_deviations/eccentricity/amount_um",
        Code::OutOfRange,
    );
}

#[test]
fn traces_reach_the_engine_and_their_wrong_lengths_orders_and_amounts_are_told() {
    let row = |value: f64| json!([0.0, value, 0.5]);
    let rows = |count: usize| -> Value { (0..count).map(|i| row(i as f64)).collect() };
    let profiles = |places: Value, removed: Value| json!({ "tooth_deviations": { "profiles": { "roll_length_mm": places, "removed_um": removed } } });
    let places = json!([12.0, 16.0, 22.0]);
    let data = data_of(&profiles(places.clone(), rows(50)));
    let traces = data.deviations.profiles.as_ref().expect("traces");
    near(traces.removed[7][1], 7e-6);
    near(traces.places.values()[2], 22e-3);
    assert!(!data.deviations.are_teeth_equal());
    let by_diameter = json!({ "tooth_deviations": { "profiles": { "diameter_mm": [97, 100, 103], "removed_um": rows(50) } } });
    let data = data_of(&by_diameter);
    near(
        data.deviations.profiles.expect("traces").places.values()[1],
        0.1,
    );
    let at = "tooth_deviations/profiles";
    let short = fault(
        &profiles(places.clone(), rows(49)),
        &format!("{at}/removed_um"),
        Code::WrongLength,
    );
    assert_eq!(short.nearest, Some(50.0));
    assert!(short.detail.contains("49 rows"), "{}", short.detail);
    let mut uneven = rows(50);
    uneven[3] = json!([0.0, 1.0]);
    let uneven = fault(
        &profiles(places.clone(), uneven),
        &format!("{at}/removed_um/3"),
        Code::WrongLength,
    );
    assert_eq!(uneven.nearest, Some(3.0));
    let falls = fault(
        &profiles(json!([12.0, 22.0, 16.0]), rows(50)),
        &format!("{at}/roll_length_mm/2"),
        Code::TableDoesNotRise,
    );
    assert!(falls.nearest.expect("the least") > 22.0);
    let mut far = rows(50);
    far[4][2] = json!(-600.0);
    let far = fault(
        &profiles(places.clone(), far),
        &format!("{at}/removed_um/4/2"),
        Code::OutOfRange,
    );
    assert_eq!(far.nearest, Some(-500.0));
    let both = json!({ "tooth_deviations": { "profiles": { "roll_length_mm": [12, 16, 22], "diameter_mm": [97, 100, 103], "removed_um": rows(50) } } });
    assert!(!faults(&both).is_empty());
    let inside = json!({ "tooth_deviations": { "profiles": { "diameter_mm": [90, 100, 103], "removed_um": rows(50) } } });
    fault(&inside, &format!("{at}/diameter_mm/0"), Code::OutOfRange);
}

#[test]
fn lead_traces_have_a_row_for_each_tooth_and_rise() {
    let leads = |z: Value, count: usize| {
        let removed: Value = (0..count).map(|_| json!([0.0, 1.0])).collect();
        json!({ "tooth_deviations": { "leads": { "z_mm": z, "removed_um": removed } } })
    };
    let along_faces = |leads: &Value| {
        let mut document = with(leads);
        document["method"] = json!("three_dimensional");
        parse(&document)
    };
    let submission = along_faces(&leads(json!([-10, 10]), 50)).expect("valid");
    let data = submission.case().pair.driving().data().clone();
    let traces = data.deviations.leads.expect("traces");
    near(traces.heights[1], 10e-3);
    near(traces.removed[49][1], 1e-6);
    for (wrong, place, code) in [
        (leads(json!([-10, 10]), 51), "removed_um", Code::WrongLength),
        (
            leads(json!([10, -10]), 50),
            "z_mm/1",
            Code::TableDoesNotRise,
        ),
        (leads(json!([10]), 50), "z_mm", Code::WrongLength),
    ] {
        let problem = along_faces(&wrong).expect_err(place);
        let error = &problem.errors[0];
        let pointer = format!("/pair/driving/tooth_deviations/leads/{place}");
        assert_eq!((&error.pointer, error.code), (&pointer, code));
    }
}

#[test]
fn lists_and_numbers_that_are_wrong_are_told_together() {
    let found = faults(&json!({
        "tooth_deviations": { "profile_slope_um": [1.0] },
        "profile_modifications": [{ "kind": "table", "diameter_mm": [98, 98], "removed_um": [0] }],
        "tip_rounding_mm": 3.0
    }));
    let codes: Vec<_> = found.iter().map(|fault| fault.code).collect();
    assert_eq!(
        codes,
        [
            Code::WrongLength,
            Code::TableDoesNotRise,
            Code::WrongLength,
            Code::TipEdgeTooLarge
        ]
    );
}

#[test]
fn deviations_that_stand_out_take_the_backlash() {
    // The pair has 0.348 mm of it at 100.5 mm; at 100 mm none is left for any deviation.
    let mut document =
        with(&json!({ "tooth_deviations": { "eccentricity": { "amount_um": 10 } } }));
    document["pair"]["center_distance_mm"] = json!(100.0);
    let problem = parse(&document).expect_err("jams");
    let [error] = problem.errors.as_slice() else {
        panic!("{problem:?}")
    };
    assert_eq!(
        (&*error.pointer, error.code),
        ("/pair/center_distance_mm", Code::NegativeBacklash)
    );
    assert!(error.detail.contains("deviations"), "{}", error.detail);
    document["pair"]["center_distance_mm"] = json!(error.nearest);
    assert!(parse(&document).is_ok());
}
