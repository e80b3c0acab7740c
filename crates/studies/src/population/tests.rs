//! Drawing of members, refusals, and results.

use meshwright_engine::gear::{SpurGear, ToothDeviations};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_wire::solve;
use meshwright_wire::submission::Submission;
use meshwright_wire::warning::GearName;
use meshwright_wire::{Code, Problem, Results, Status};
use serde_json::{Value, json};

use super::*;
use crate::population_results::*;
use crate::table::{RowState, Summary};
use crate::testing::{self, STUB, and, faults, refused};
use crate::{Design, Study};

fn base() -> Value {
    let gear = json!({
        "tooth_count": 20, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 8.0 }
    });
    json!({
        "method": "load_distribution",
        "pair": { "center_distance_mm": 40.2, "driving": gear, "driven": gear },
        "output_torques_n_m": [50.0]
    })
}

fn document(population: Value) -> Value {
    json!({ "base": base(), "population": population })
}

fn study(population: Value) -> Study {
    testing::study(&document(population)).expect("a population")
}

fn refusal(document: &Value) -> Vec<(String, Code, Option<f64>)> {
    faults(testing::study(document).expect_err("refused"))
}

fn distance() -> Value {
    json!({ "path": "/pair/center_distance_mm", "kind": "normal", "mean": 40.2, "standard_deviation": 0.02, "low": 40.15, "high": 40.25 })
}

fn teeth(design: &Design, gear: Member) -> ToothDeviations {
    let submission = design.submission.as_ref().expect("it can be built");
    let pair = &submission.case().pair;
    match gear {
        Member::Driving => pair.driving().deviations().clone(),
        Member::Driven => pair.driven().deviations().clone(),
    }
}

#[test]
fn a_member_is_known_by_its_number_alone_and_says_what_it_changes() {
    let asked = json!({ "size": 1000, "seed": 7, "vary": [distance()],
        "accuracy": { "driving": { "iso_1328_class": 6 }, "driven": { "iso_1328_class": 8, "capability": 1.33 } } });
    let (whole, again) = (study(asked.clone()), study(asked));
    assert_eq!(whole.total(), 1000);
    for row in [999, 3, 0] {
        assert_eq!(whole.design(row), again.design(row));
        let design = whole.design(row).unwrap();
        assert_eq!(design.label, format!("member {row}"));
        let changed: Vec<&String> = design.changes.keys().collect();
        assert_eq!(
            changed,
            ["/pair/center_distance_mm"],
            "not hundreds of teeth"
        );
        let submission = design.submission.as_ref().expect("it can be built");
        assert_eq!(submission.case().pair.period(), 20, "a revolution");
        assert_eq!(whole.submission_of(row), Some(submission.canonical_json()));
    }
    assert_eq!(whole.design(1000), None);
    assert_eq!(whole.submission_of(1000), None);
    let other = study(json!({ "size": 1000, "seed": 8, "vary": [distance()] }));
    assert_ne!(
        whole.design(5).unwrap().changes,
        other.design(5).unwrap().changes
    );
}

#[test]
fn every_gear_of_a_batch_stands_in_two_pairs_and_all_others_are_made_once() {
    let whole = study(json!({ "size": 64, "vary": [distance()],
        "accuracy": { "driving": { "iso_1328_class": 6 }, "driven": { "iso_1328_class": 6 } } }));
    let designs: Vec<Design> = (0..64).map(|row| whole.design(row).unwrap()).collect();
    for gear in GEARS {
        for (i, one) in designs.iter().enumerate() {
            for (j, other) in designs.iter().enumerate().skip(i + 1) {
                let pair = i % 2 == 0 && j == i + 1;
                let shared = pair && (i / 2 % 2 == 0) == (gear == Member::Driving);
                assert_eq!(
                    teeth(one, gear) == teeth(other, gear),
                    shared,
                    "{i} {j} {gear}"
                );
                assert_ne!(one.changes, other.changes);
            }
        }
    }
    // Where nothing else differs, nothing is made twice.
    let alone = study(json!({ "size": 64, "accuracy": { "driven": { "iso_1328_class": 6 } } }));
    let designs: Vec<ToothDeviations> = (0..64)
        .map(|row| teeth(&alone.design(row).unwrap(), Member::Driven))
        .collect();
    for (i, one) in designs.iter().enumerate() {
        assert!(!designs[i + 1..].contains(one));
    }
}

#[test]
fn the_population_of_the_guide_is_one() {
    let example = include_str!("../../../../api/examples/population-class-6.json");
    let whole = Study::parse(example.as_bytes(), &Run::unattended()).expect("a population");
    let guide = include_str!("../../../../docs/how-good-will-they-be.md");
    let block = guide
        .split("```json\n\"population\": ")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    let told: Value = serde_json::from_str(block.expect("a block")).expect("JSON");
    let mut own: Value = serde_json::from_str(example).expect("JSON");
    own["population"]
        .as_object_mut()
        .unwrap()
        .remove("sampling");
    assert_eq!(own["population"], told);
    assert!(whole.design(255).unwrap().submission.is_ok());
}

#[test]
fn members_follow_their_laws() {
    for sampling in ["sobol", "random"] {
        let whole = study(json!({ "size": 4096, "sampling": sampling, "vary": [
            distance(),
            { "path": "/pair/driven/tooth_thickness_deviation_um", "kind": "uniform", "low": -60, "high": -20 },
            { "path": "/output_torques_n_m/0", "kind": "triangular", "low": 40, "mode": 50, "high": 70 },
            { "path": "/resolution/positions_per_mesh_period", "kind": "uniform", "low": 10, "high": 12 },
        ] }));
        let population = whole.population().unwrap();
        let values: Vec<Vec<f64>> = (0..4096).map(|member| population.values(member)).collect();
        let mean = |i: usize, f: &dyn Fn(f64) -> f64| {
            values.iter().map(|values| f(values[i])).sum::<f64>() / 4096.0
        };
        // Cut at 2.5 standard deviations the variance is 1 - 2 x 2.5 phi(2.5)/(2 Phi(2.5) - 1) = 0.911257 of the full one.
        assert!((mean(0, &|x| x) - 40.2).abs() < 1.5e-3);
        let variance = mean(0, &|x| (x - 40.2).powi(2));
        assert!(
            (variance / (0.02_f64.powi(2) * 0.911_257) - 1.0).abs() < 0.1,
            "{variance}"
        );
        assert!(
            values
                .iter()
                .all(|values| (40.15..=40.25).contains(&values[0]))
        );
        assert!((mean(1, &|x| x) + 40.0).abs() < 1.0);
        assert!((mean(2, &|x| x) - 160.0 / 3.0).abs() < 0.6);
        // A field of whole numbers takes the nearest: the ends half as often.
        let often = |count: f64| mean(3, &|x| f64::from(u8::from(x == count)));
        for (count, share) in [(10.0, 0.25), (11.0, 0.5), (12.0, 0.25)] {
            assert!(
                (often(count) - share).abs() < 0.04,
                "{count}: {}",
                often(count)
            );
        }
        assert!(whole.design(11).unwrap().submission.is_ok());
    }
}

#[test]
fn what_cannot_be_drawn_is_refused_with_its_place_and_the_nearest() {
    let vary = |law: Value| document(json!({ "size": 10, "vary": [law] }));
    let field = |path: &str| vary(json!({ "path": path, "kind": "uniform", "low": 1, "high": 2 }));
    let path = "/population/vary/0/path";
    let of_distance = |law: Value| vary(and(json!({ "path": "/pair/center_distance_mm" }), &law));
    let drawn = json!({ "size": 10, "accuracy": { "driving": { "iso_1328_class": 6 } } });
    let eccentric = json!({ "eccentricity": { "amount_um": 3 } });
    let measured = [("/base/pair/driving/tooth_deviations", eccentric)];
    for (document, place, code, nearest) in refused! {
        testing::with(document(drawn), &measured) => "/population/accuracy/driving", ConflictingFields;
        document(json!({ "size": 10 })) => "/population/vary", MissingField;
        document(json!({ "vary": [distance()] })) => "/population/size", MissingField;
        document(json!({ "size": 1, "vary": [distance()] })) => "/population/size", OutOfRange, 2.0;
        document(json!({ "size": 1_000_000, "vary": [distance()] })) => "/population/size", OutOfRange, 100_000.0;
        document(json!({ "size": 10, "vary": [distance()], "sampling": "halton" })) => "/population/sampling", WrongType;
        document(json!({ "size": 10, "vary": [distance(), distance()] })) => "/population/vary/1/path", OutOfRange;
        document(json!({ "size": 10, "accuracy": { "driven": { "iso_1328_class": 12 } } }))
            => "/population/accuracy/driven/iso_1328_class", OutOfRange, 11.0;
        document(json!({ "size": 10, "accuracy": {} })) => "/population/vary", MissingField;
        field("/pair/driven/blank/hole/radius_mm") => path, UnknownField;
        field("/method") => path, WrongType;
        field("/pair/driven") => path, WrongType;
        field("/output_torques_n_m/3") => path, UnknownField;
        // There is no relief, and one has more than an amount.
        field("/pair/driven/tip_relief/amount_um") => path, MissingField;
        // No number in the middle of the law would be taken.
        vary(json!({ "path": "/pair/driven/material/poisson_ratio", "kind": "uniform", "low": 1, "high": 3 }))
            => path, OutOfRange, 0.49;
        of_distance(json!({ "kind": "uniform", "low": 41, "high": 40 })) => "/population/vary/0/high", OutOfRange;
        of_distance(json!({ "kind": "normal", "mean": 41, "standard_deviation": 1, "low": 39, "high": 40 }))
            => "/population/vary/0/mean", OutOfRange, 40.0;
        of_distance(json!({ "kind": "triangular", "low": 39, "mode": 38, "high": 40 })) => "/population/vary/0/mode", OutOfRange, 39.0;
        of_distance(json!({ "kind": "normal", "mean": 41, "standard_deviation": 0 }))
            => "/population/vary/0/standard_deviation", OutOfRange, 1e-12;
        of_distance(json!({ "kind": "lognormal" })) => "/population/vary/0/kind", WrongType;
        of_distance(json!({ "kind": "uniform", "low": 40, "high": 41, "mean": 40 })) => "/population/vary/0/mean", UnknownField;
    } {
        assert_eq!(
            refusal(&document),
            [(place.to_owned(), code, nearest)],
            "{document}"
        );
    }
    let mut both = document(json!({ "size": 10, "vary": [distance()] }));
    both["designs"] = json!([{ "label": "a" }]);
    assert_eq!(refusal(&both)[0].0, "/population");
    let drawn = document(
        json!({ "size": 10, "accuracy": { "driving": { "iso_1328_class": 6 } },
        "vary": [{ "path": "/pair/driving/tooth_deviations/eccentricity/amount_um", "kind": "uniform", "low": 1, "high": 2 }] }),
    );
    assert_eq!(refusal(&drawn)[0].1, Code::ConflictingFields);
}

/// A row with results in which the peak-to-peak value is this, or one without.
fn row(design: &Design, range: Option<f64>) -> RowState {
    let failed = || Problem::new(Code::NotConverged, "");
    let outcome = range.ok_or_else(failed).and_then(|range| {
        let mut results = Results::read(STUB).expect("a results document");
        results.pair.contact_ratio = 1.5;
        results.curves.truncate(1);
        let curve = &mut results.curves[0];
        curve.output_torque_n_m = 50.0;
        let values = &mut curve.statistics.transmission_error_um.whole;
        (values.mean, values.rms, values.peak_to_peak) = (1.0, 0.0, range);
        curve.statistics.mesh_stiffness_tangent_n_per_m = values.clone();
        Summary::of(&results)
    });
    RowState::computed(design.label.clone(), design.changes.clone(), outcome)
}

fn results_of(study: &Study, range: impl Fn(&Design) -> Option<f64>) -> Value {
    let mut sample = PopulationSample::new(study, 0..60).expect("a population");
    for member in 0..study.total() {
        let design = study.design(member).unwrap();
        sample.add(member as u32, &row(&design, range(&design)));
    }
    serde_json::to_value(sample.results(None, Status::Successful)).unwrap()
}

fn quantity<'a>(results: &'a Value, name: &str) -> &'a Value {
    let mut quantities = results["quantities"].as_array().unwrap().iter();
    quantities
        .find(|quantity| quantity["name"] == name)
        .expect(name)
}

const RANGE: &str = "transmission_error_um.peak_to_peak";

fn moved(design: &Design) -> f64 {
    (design.changes["/pair/center_distance_mm"].as_f64().unwrap() - 40.2) / 0.02
}

/// The part of a result that comes from the teeth of a gear: the deviation of one of them.
fn stands_out(design: &Design, gear: Member) -> f64 {
    1e6 * teeth(design, gear).profile_slope[3]
}

#[test]
fn numbers_are_those_of_their_definitions() {
    let whole = study(json!({ "size": 1003, "vary": [distance()], "sampling": "random" }));
    // One member in a hundred fails.
    let range = |design: &Design| {
        let failed = design.label.ends_with("77");
        (!failed).then(|| 3.0 + moved(design))
    };
    let results = results_of(&whole, range);
    let mut values: Vec<f64> = (0..1003)
        .filter_map(|row| range(&whole.design(row).unwrap()))
        .collect();
    let n = values.len() as f64;
    assert_eq!(
        (
            results["size"].as_u64(),
            results["done"].as_u64(),
            results["failed"].as_u64()
        ),
        (Some(1003), Some(1003), Some(10))
    );
    let found = quantity(&results, RANGE);
    assert_eq!(
        (found["output_torque_n_m"].as_f64(), found["count"].as_u64()),
        (Some(50.0), Some(993))
    );
    // Percentiles are of the members computed; beside them stands how many were not, and why.
    assert_eq!(found["failed_share"].as_f64(), Some(10.0 / 1003.0));
    assert_eq!(results["refusals"][0]["code"], "not_converged");
    assert_eq!(results["refusals"][0]["count"], 10);
    let mean = values.iter().sum::<f64>() / n;
    let close = |found: &Value, expected: f64| {
        let found = found.as_f64().unwrap();
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    };
    close(&found["mean"], mean);
    close(
        &found["standard_deviation"],
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt(),
    );
    values.sort_by(f64::total_cmp);
    close(&found["smallest"], values[0]);
    close(&found["largest"], values[992]);
    // 992 steps lie between 993 members: the quarter of all is the value at place 248.
    assert_eq!(found["percentiles"][2]["percent"], 25.0);
    close(&found["percentiles"][2]["value"], values[248]);
    let (low, high) = (
        &found["percentiles"][2]["low"],
        &found["percentiles"][2]["high"],
    );
    assert!(low.as_f64().unwrap() < values[248] && values[248] < high.as_f64().unwrap());
    let counts: Vec<u64> = found["histogram"]["counts"]
        .as_array()
        .unwrap()
        .iter()
        .map(|count| count.as_u64().unwrap())
        .collect();
    assert_eq!(counts.iter().sum::<u64>(), 993);
    // Nothing else varies, and nothing makes the contact ratio vary.
    let influences = found["influences"].as_array().unwrap();
    assert_eq!(influences.len(), 1);
    assert!(
        influences[0]["path"] == "/pair/center_distance_mm"
            && influences[0]["share"].as_f64().unwrap() > 0.98
    );
    assert_eq!(quantity(&results, "contact_ratio")["influences"], json!([]));
    assert_eq!(
        quantity(&results, "contact_ratio")["output_torque_n_m"],
        Value::Null
    );
    let extreme = &found["members"]["largest"];
    let design = whole.design(extreme.as_u64().unwrap() as usize).unwrap();
    close(&found["largest"], range(&design).unwrap());
}

#[test]
fn influences_are_those_that_the_result_was_made_of() {
    for sampling in ["sobol", "random"] {
        let whole = study(
            json!({ "size": 2048, "sampling": sampling, "vary": [distance()],
            "accuracy": { "driving": { "iso_1328_class": 5 }, "driven": { "iso_1328_class": 7 } } }),
        );
        // Class 7 is twice as wide as class 5: its variance is four times as large.
        let sigma = 4.84 / 3.0;
        let range = |design: &Design| {
            Some(
                sigma * 2.0 * moved(design)
                    + stands_out(design, Member::Driving)
                    + stands_out(design, Member::Driven),
            )
        };
        let results = results_of(&whole, range);
        let parts = [4.0 * 0.911_257, 1.0, 4.0];
        let all: f64 = parts.iter().sum();
        let influences = &quantity(&results, RANGE)["influences"];
        for (i, (name, word)) in [
            ("path", "/pair/center_distance_mm"),
            ("accuracy", "driving"),
            ("accuracy", "driven"),
        ]
        .into_iter()
        .enumerate()
        {
            let found = &influences[i];
            assert_eq!(found[name], word);
            let number = |name: &str| found[name].as_f64().unwrap();
            let expected = parts[i] / all;
            assert!(
                (number("share") - expected).abs() < 0.1,
                "{sampling}: {found} {expected}"
            );
            assert!(
                number("low") - 0.02 <= expected && expected <= number("high") + 0.02,
                "{sampling}: {found} {expected}"
            );
        }
    }
}

#[test]
fn gears_beyond_the_total_pitch_tolerance_are_counted() {
    // At a tenth of the capability the single pitches are ten times as wide as the class: nearly all are beyond; at ten times, none.
    for (capability, least, most) in [(0.1, 0.95, 1.0), (10.0, 0.0, 0.0)] {
        let asked = |vary: Value| json!({ "size": 40, "vary": vary, "accuracy": { "driven": { "iso_1328_class": 6, "capability": capability, "inspected": false } } });
        // A varied face of the same gear is measured by its own tolerances, and F_pT does not depend on it.
        let face = json!([{ "path": "/pair/driven/face_width_mm", "kind": "uniform", "low": 19, "high": 21 }]);
        let beyond = [json!([]), face].map(|vary| {
            let results = results_of(&study(asked(vary)), |_| Some(1.0));
            results["beyond_total_pitch_tolerance"].clone()
        });
        assert_eq!(beyond[0]["driving"], Value::Null);
        for beyond in beyond {
            let share = beyond["driven"].as_f64().unwrap();
            assert!((least..=most).contains(&share), "{capability}: {share}");
        }
    }
}

#[test]
fn gears_that_an_inspector_rejects_are_drawn_again_and_told() {
    let asked = |inspected: bool| {
        let gear = json!({ "iso_1328_class": 6, "capability": 0.8, "inspected": inspected });
        study(json!({ "size": 200, "accuracy": { "driven": gear } }))
    };
    let results = results_of(&asked(true), |_| Some(1.0));
    assert_eq!(results["beyond_total_pitch_tolerance"]["driven"], 0.0);
    assert_eq!(results["rejected_by_inspection"]["driving"], Value::Null);
    let rejected = results["rejected_by_inspection"]["driven"]
        .as_f64()
        .unwrap();
    let as_made = results_of(&asked(false), |_| Some(1.0));
    assert_eq!(as_made["rejected_by_inspection"]["driven"], Value::Null);
    assert!(
        as_made["beyond_total_pitch_tolerance"]["driven"]
            .as_f64()
            .unwrap()
            > 0.02
    );
    // The same share by looking at gears that nobody has looked at.
    let inspection = |design: &Design| {
        let gear = driven_of(design);
        Inspection::of(gear, 6).largest_part(gear.deviations())
    };
    let more = study(json!({ "size": 2000, "seed": 9, "accuracy": {
        "driven": { "iso_1328_class": 6, "capability": 0.8, "inspected": false } } }));
    let beyond = (0..2000).filter(|row| inspection(&more.design(*row).unwrap()) > 1.0);
    let expected = beyond.count() as f64 / 2000.0;
    // Four standard errors of 200 gears that passed.
    assert!((rejected - expected).abs() < 0.13, "{rejected} {expected}");
    let (inspected, as_made) = (asked(true), asked(false));
    for row in 0..200 {
        let designs = [&inspected, &as_made].map(|study| study.design(row).unwrap());
        // Deviations are told in tenths of a nanometer, so that a pitch may seem beyond by as much.
        assert!(inspection(&designs[0]) < 1.0 + 1e-4);
        let passes = inspection(&designs[1]) < 1.0 - 1e-4;
        assert!(
            !passes || designs[0] == designs[1],
            "what passes at once is taken"
        );
    }
}

/// The driven gear of a design that can be made.
fn driven_of(design: &Design) -> &SpurGear {
    let submission = design.submission.as_ref().unwrap();
    submission.case().pair.driven()
}

#[test]
fn uninspected_members_are_those_of_earlier_versions() {
    let gear = |class: u32| json!({ "iso_1328_class": class, "inspected": false });
    let mut base = testing::example("standard-pair");
    base["method"] = json!("load_distribution");
    let population =
        json!({ "size": 8, "seed": 7, "accuracy": { "driving": gear(6), "driven": gear(8) } });
    let whole = testing::study(&json!({ "base": base, "population": population })).unwrap();
    let told = testing::echo(whole.design(5).unwrap().submission.as_ref().unwrap());
    let teeth = &told["pair"]["driven"]["tooth_deviations"];
    // By version 0.4.0.
    assert_eq!(teeth["pitch_single_um"][0], 4.5995);
    assert_eq!(teeth["pitch_single_um"][1], -4.1209);
    assert_eq!(teeth["profile_slope_um"][49], 3.5585);
    assert_eq!(
        teeth["eccentricity"],
        json!({ "amount_um": 2.5801, "phase_deg": 92.5506 })
    );
}

#[test]
fn shares_of_inspected_gears_are_those_that_the_result_was_made_of() {
    // At this capability most gears are rejected, so that the teeth of a gear are no longer independent of each other.
    let accuracy = |class: u32| json!({ "iso_1328_class": class, "capability": 0.6 });
    let asked = |vary: Value| json!({ "size": 2048, "vary": vary, "accuracy": { "driving": accuracy(5), "driven": accuracy(6) } });
    let whole = study(asked(json!([distance()])));
    let total = |design: &Design| {
        let gear = driven_of(design);
        1e6 * Inspection::of(gear, 6).total_pitch_deviation(gear.deviations())
    };
    // The passed part of the driven gear as a whole, of the driving one in one tooth, and the distance.
    let parts = |design: &Design| {
        [
            3.0 * moved(design),
            stands_out(design, Member::Driving),
            total(design),
        ]
    };
    let designs: Vec<Design> = (0..2048).map(|row| whole.design(row).unwrap()).collect();
    let all: Vec<[f64; 3]> = designs.iter().map(parts).collect();
    let variance = |part: usize| {
        let values: Vec<f64> = all.iter().map(|parts| parts[part]).collect();
        crate::sample::standard_deviation(&values).unwrap().powi(2)
    };
    let variances = [0, 1, 2].map(variance);
    let sum: f64 = variances.iter().sum();
    let results = results_of(&whole, |design| Some(parts(design).iter().sum()));
    assert!(
        results["rejected_by_inspection"]["driven"]
            .as_f64()
            .unwrap()
            > 0.5
    );
    let influences = quantity(&results, RANGE)["influences"]
        .as_array()
        .unwrap()
        .clone();
    assert_eq!(influences.len(), 3);
    for (found, variance) in influences.iter().zip(variances) {
        let number = |name: &str| found[name].as_f64().unwrap();
        let expected = variance / sum;
        assert!(
            (number("share") - expected).abs() < 0.1,
            "{found} {expected}"
        );
        assert!(
            number("low") - 0.02 <= expected && expected <= number("high") + 0.02,
            "{found} {expected}"
        );
    }
    // Where the face of a gear varies, so do its tolerances, and two members need not get one gear: its share is not told.
    let face =
        json!([{ "path": "/pair/driven/face_width_mm", "kind": "uniform", "low": 19, "high": 21 }]);
    let mut short = asked(face);
    short["size"] = json!(64);
    let results = results_of(&study(short), |design| {
        Some(stands_out(design, Member::Driving))
    });
    let influences = quantity(&results, RANGE)["influences"].as_array().unwrap();
    let told: Vec<&Value> = influences
        .iter()
        .filter_map(|one| one.get("accuracy"))
        .collect();
    assert_eq!(told, ["driving"]);
}

#[test]
fn a_population_of_which_no_member_can_be_is_refused_with_the_reason() {
    let refused = |document: &Value| testing::study(document).expect_err("refused").errors;
    // As made, 29 and 85 teeth come back together after 2465 mesh periods.
    let mut made = testing::example("test-case-3");
    made["pair"]["center_distance_mm"] = json!(114.5);
    let population = json!({ "size": 50, "accuracy": { "driven": { "iso_1328_class": 6 }, "driving": { "iso_1328_class": 6 } } });
    let errors = refused(&json!({ "base": made, "population": population }));
    assert_eq!(
        (&*errors[0].pointer, errors[0].code),
        ("/population/window", Code::TooLarge)
    );
    assert!(
        errors[0].detail.contains("None of 50 members") && errors[0].detail.contains("2465"),
        "{:?}",
        errors[0]
    );
    let mut short = made.clone();
    short["resolution"]["span_mesh_periods"] = json!(29);
    assert!(testing::study(&json!({ "base": short, "population": population })).is_ok());
    let search = |base: &Value| {
        json!({ "base": base, "search": {
        "variables": [{ "path": "/pair/driving/tip_relief/amount_um", "low": 1, "high": 10 }],
        "minimize": [{ "quantity": "transmission_error_um.peak_to_peak", "percent": 50 }],
        "population": population, "evaluations": 10 } })
    };
    let mut relieved = made.clone();
    relieved["pair"]["driving"]["tip_relief"] =
        json!({ "amount_um": 5, "start": { "radial_length_mm": 0.8 } });
    let errors = refused(&search(&relieved));
    assert_eq!(
        (&*errors[0].pointer, errors[0].code),
        ("/search/population/window", Code::TooLarge)
    );
    relieved["resolution"]["span_mesh_periods"] = json!(29);
    assert_eq!(testing::study(&search(&relieved)).err(), None);
    // Fewer than one gear in a hundred of this capability would pass.
    let gear = json!({ "iso_1328_class": 6, "capability": 0.3 });
    let errors = refused(&document(
        json!({ "size": 10, "accuracy": { "driven": gear } }),
    ));
    assert_eq!(errors[0].pointer, "/population/accuracy/driven/capability");
    assert!(errors[0].nearest.unwrap() > 0.3 && errors[0].nearest.unwrap() < 1.0);
}

#[test]
fn torques_are_looked_at_some_at_a_time() {
    let whole = study(json!({ "size": 20, "vary": [distance()] }));
    let mut sample = PopulationSample::new(&whole, 1..3).expect("a population");
    for member in 0..20 {
        let design = whole.design(member).unwrap();
        sample.add(member as u32, &row(&design, Some(1.0)));
    }
    // There is one torque, and it belongs to the look before.
    assert!(sample.has_all_torques());
    let results = serde_json::to_value(sample.results(None, Status::Running)).unwrap();
    assert_eq!(results["quantities"], json!([]));
    assert!(PopulationSample::torques_at_once(&whole) > 60);
}

#[test]
fn lead_slopes_are_drawn_where_the_method_sees_the_faces_and_leave_the_other_teeth_as_they_are() {
    let base = |method: &str, helix: f64| {
        let mut base = base();
        base["method"] = json!(method);
        base["pair"]["helix_angle_deg"] = json!(helix);
        base["pair"]["center_distance_mm"] = json!(40.2 / helix.to_radians().cos());
        base
    };
    let members = |base: Value| {
        let population = json!({ "size": 200, "seed": 3, "accuracy": {
            "driving": { "iso_1328_class": 6 }, "driven": { "iso_1328_class": 8, "capability": 1.33 } } });
        testing::study(&json!({ "base": base, "population": population })).expect("a population")
    };
    let plane = members(base("load_distribution", 0.0));
    let solid = members(base("three_dimensional", 0.0));
    for row in [0, 1, 7, 199] {
        let (plane, solid) = (plane.design(row).unwrap(), solid.design(row).unwrap());
        for gear in GEARS {
            let (plane, mut solid) = (teeth(&plane, gear), teeth(&solid, gear));
            assert!(plane.lead_slope.is_empty());
            assert_eq!(solid.lead_slope.len(), 20);
            assert_ne!(solid.lead_slope, solid.profile_slope);
            solid.lead_slope.clear();
            assert_eq!(plane, solid);
        }
    }
    // f_HbT = 0.05 sqrt(d) + 0.35 sqrt(b) + 4 in class 5, d that of the transverse section, b 20 mm; of f_HaT m_n is the normal module.
    for helix in [0.0, 25.0, -25.0] {
        let members = members(base("three_dimensional", helix));
        let mut slopes = [(); 2].map(|()| Vec::new());
        let mut profiles = [(); 2].map(|()| Vec::new());
        for row in 0..200 {
            let design = members.design(row).unwrap();
            for gear in GEARS {
                let teeth = teeth(&design, gear);
                slopes[gear as usize].extend(teeth.lead_slope);
                profiles[gear as usize].extend(teeth.profile_slope);
            }
        }
        let d = 40.0 / helix.to_radians().cos();
        let of_class_5 = [
            0.05 * d.sqrt() + 0.35 * 20_f64.sqrt() + 4.0,
            0.4 * 2.0 + 0.001 * d + 4.0,
        ];
        for (drawn, tolerance) in [slopes, profiles].into_iter().zip(of_class_5) {
            for (drawn, (steps, capability)) in drawn.iter().zip([(0.5, 1.0), (1.5, 1.33)]) {
                let sigma = 1e-6 * tolerance * 2_f64.powf(steps) / (3.0 * capability);
                let squares: f64 = drawn.iter().map(|slope| slope * slope).sum();
                let found = (squares / drawn.len() as f64).sqrt();
                // 4000 numbers tell a deviation within 1.1 %, some of them twice.
                assert!(
                    (found / sigma - 1.0).abs() < 0.05,
                    "{helix}: {found} {sigma}"
                );
            }
        }
    }
}

#[test]
fn members_of_other_thickness_keep_the_root_of_the_drawn_gear_unless_asked() {
    let thinner = json!({ "path": "/pair/driven/tooth_thickness_deviation_um", "kind": "uniform", "low": -60, "high": -20 });
    let shift = json!({ "path": "/pair/driving/profile_shift", "kind": "uniform", "low": -0.01, "high": 0.01 });
    let roots = |more: Value| {
        let mut population = json!({ "size": 16, "vary": [thinner, shift] });
        for (name, value) in more.as_object().expect("fields") {
            population[name] = value.clone();
        }
        let whole = study(population);
        let roots = (0..16).map(|row| {
            let submission = whole.design(row).unwrap().submission.expect("valid");
            let pair = &submission.case().pair;
            let of = |gear: &SpurGear| gear.generating_shift_length() / gear.data().rack.module;
            let thickness = pair.driven().data().thickness_deviation;
            (of(pair.driving()), of(pair.driven()), thickness)
        });
        roots.collect::<Vec<_>>()
    };
    let module = 2e-3;
    let tan = 20_f64.to_radians().tan();
    let kept = roots(json!({}));
    // The middle of the law is 40 um thinner; the driving gear follows its own profile shift.
    let drawn = -40e-6 / (2.0 * module * tan);
    assert!(
        kept.iter()
            .all(|(_, driven, _)| (driven - drawn).abs() < 1e-9),
        "{kept:?}"
    );
    assert!(
        kept.windows(2)
            .any(|pair| pair[0].0 != pair[1].0 && pair[0].2 != pair[1].2)
    );
    for (_, driven, thickness) in roots(json!({ "generating_profile_shift": "by_thickness" })) {
        assert!((driven - thickness / (2.0 * module * tan)).abs() < 1e-9);
    }
}

/// A pair of 20 and 21 teeth, whose teeth come together again after 420 mesh periods.
fn hunting() -> Value {
    let mut base = base();
    base["pair"]["driven"]["tooth_count"] = json!(21);
    base["pair"]["center_distance_mm"] = json!(41.2);
    base["resolution"] = json!({ "positions_per_mesh_period": 8 });
    base
}

fn of_class_6(mut more: Value) -> Value {
    more["size"] = json!(6);
    more["accuracy"] =
        json!({ "driving": { "iso_1328_class": 6 }, "driven": { "iso_1328_class": 6 } });
    more
}

#[test]
fn members_are_computed_over_windows_of_their_own() {
    let window = json!({ "window": { "mesh_periods": 32, "places": 2 } });
    let document = json!({ "base": hunting(), "population": of_class_6(window) });
    let whole = testing::study(&document).expect("a population");
    let windows: Vec<Vec<u32>> = (0..6)
        .map(|row| {
            let submission = whole.design(row).unwrap().submission.expect("valid");
            let again = Submission::parse(submission.canonical_json().as_bytes());
            assert_eq!(again.expect("valid").case(), submission.case());
            assert_eq!(submission.case().span(), 32);
            submission.case().windows.clone()
        })
        .collect();
    assert!(windows.iter().all(|starts| starts.len() == 2));
    assert!(
        windows.windows(2).all(|two| two[0] != two[1]),
        "{windows:?}"
    );

    let design = whole.design(0).unwrap();
    let submission = design.submission.expect("valid");
    let library = Library::with_capacity(1 << 20);
    let results = solve(&submission, &library, &Run::unattended()).expect("computed");
    let curve = &results.curves[0];
    assert!(curve.spectrum.is_none() && curve.statistics.partial);
    assert_eq!(curve.mesh_position.len(), 2 * 32 * 8);
    let orders = curve.mesh_orders_um.clone().expect("estimated");
    assert_eq!(orders.len(), 4);
    let statistics = &curve.statistics.transmission_error_um;
    assert_eq!(statistics.long_wave, None);
    // The rms of harmonics is that of all of them, of which four are reported.
    let four = orders
        .iter()
        .map(|each| each * each / 2.0)
        .sum::<f64>()
        .sqrt();
    let all = statistics.mesh_harmonics_rms.expect("estimated");
    assert!(four <= all && four > 0.8 * all, "{four} {all}");

    let summary = Summary::of(&results).expect("finite");
    let state = RowState::computed(design.label, design.changes, Ok(summary));
    let row = crate::table::TableRow::new(GearName::Driven, state.clone(), false);
    // A document has ten digits.
    let told = significant(orders[0], 10);
    assert_eq!(row.curves[0].mesh_order_um, Some(told));
    assert_eq!(row.curves[0].hole_order_um, None);
    let mut sample = PopulationSample::new(&whole, 0..60).expect("a population");
    sample.add(0, &state);
    let results = serde_json::to_value(sample.results(None, Status::Running)).unwrap();
    assert_eq!(
        (&results["done"], &results["partial"]),
        (&json!(1), &json!(1))
    );
    assert_eq!(quantity(&results, "mesh_order_um")["mean"], json!(told));
    let names: Vec<&Value> = results["quantities"]
        .as_array()
        .unwrap()
        .iter()
        .map(|each| &each["name"])
        .collect();
    assert!(!names.contains(&&json!("transmission_error_um.long_wave")));
}

#[test]
fn windows_as_long_as_the_true_period_are_the_true_period() {
    let window = json!({ "window": { "mesh_periods": 210, "places": 2 } });
    let whole = testing::study(&json!({ "base": hunting(), "population": of_class_6(window) }));
    let submission = whole.expect("a population").design(3).unwrap().submission;
    let submission = submission.expect("valid");
    assert!(submission.case().windows.is_empty() && submission.case().covers_whole_periods());
}

#[test]
fn members_with_too_many_positions_are_refused_at_their_window_with_the_longest_that_would_do() {
    // 20 and 21 teeth come together again after 420 mesh periods; 20,000 positions are taken.
    let mut base = hunting();
    base["resolution"]["positions_per_mesh_period"] = json!(100);
    for (more, place, nearest) in [
        (json!({}), "/population/window", 200.0),
        (
            json!({ "window": { "mesh_periods": 150, "places": 2 } }),
            "/population/window/mesh_periods",
            100.0,
        ),
    ] {
        let document = json!({ "base": base, "population": of_class_6(more) });
        let refused = refusal(&document);
        assert_eq!(refused, [(place.to_owned(), Code::TooLarge, Some(nearest))]);
    }
    base["resolution"]["span_mesh_periods"] = json!(420);
    let refused = refusal(&json!({ "base": base, "population": of_class_6(json!({})) }));
    assert!(refused[0].0.starts_with("/base/resolution/"), "{refused:?}");
}

#[test]
fn a_window_is_refused_beside_a_span_and_for_goals_that_it_does_not_tell() {
    let window = json!({ "window": { "mesh_periods": 32 } });
    let mut spanned = hunting();
    spanned["resolution"]["span_mesh_periods"] = json!(32);
    let refused = refusal(&json!({ "base": spanned, "population": of_class_6(window.clone()) }));
    assert_eq!(refused[0].0, "/population/window");
    assert_eq!(refused[0].1, Code::ConflictingFields);

    let mut relieved = hunting();
    relieved["pair"]["driving"]["tip_relief"] =
        json!({ "amount_um": 5, "start": { "radial_length_mm": 0.8 } });
    let search = |quantity: &str| {
        testing::study(&json!({ "base": relieved, "search": {
            "variables": [{ "path": "/pair/driving/tip_relief/amount_um", "low": 1, "high": 10 }],
            "minimize": [{ "quantity": quantity, "percent": 95 }],
            "population": of_class_6(window.clone()), "evaluations": 10 } }))
    };
    for told in [
        "mesh_order_um",
        "transmission_error_um.mesh_harmonics_rms",
        "transmission_error_um.tooth_to_tooth",
    ] {
        assert_eq!(search(told).err(), None, "{told}");
    }
    for untold in [
        "transmission_error_um.long_wave",
        "transmission_error_um.short_wave",
    ] {
        let problem = search(untold).expect_err(untold);
        let error = &problem.errors[0];
        assert_eq!(error.code, Code::QuantityNotTold);
        assert!(
            error.detail.contains("windows of 32 mesh periods"),
            "{}",
            error.detail
        );
    }
}
