//! Reading of a submission, its defaults, and its refusals.

mod chance;
mod cost;
mod refusals;
mod running;
mod schema;
mod three_dimensions;

use meshwright_engine::analysis::warnings;
use serde_json::{Value, json};

use super::*;
use crate::examples;
use crate::testing::{echo, example, parse, put};
use crate::warning::{WarningCode, WarningDocument};

/// Every needed field and nothing else.
pub(super) fn least() -> Value {
    json!({
        "method": "flexible",
        "pair": {
            "center_distance_mm": 100.5,
            "driving": { "tooth_count": 50, "module_mm": 2, "face_width_mm": 20, "blank": { "bore_radius_mm": 15 } },
            "driven": { "tooth_count": 50, "module_mm": 2, "face_width_mm": 20, "blank": { "bore_radius_mm": 15 } }
        },
        "output_torques_n_m": [115]
    })
}

pub(super) fn case_2() -> Value {
    example("test-case-2")
}

#[test]
fn the_least_submission_is_echoed_with_every_default() {
    let submission = parse(&least()).expect("valid");
    let echo = echo(&submission);
    // The defaults are API.md's: ISO 53 rack, steel, 40 positions; the standard pair repeats every mesh period.
    for gear in ["driving", "driven"] {
        assert_eq!(
            echo["pair"][gear],
            json!({
                "tooth_count": 50, "module_mm": 2.0, "pressure_angle_deg": 20.0, "profile_shift": 0.0,
                "addendum_mm": 2.0, "tip_diameter_mm": null, "dedendum_mm": 2.5, "rack_tip_radius_mm": 0.76,
                "tooth_thickness_deviation_um": 0.0, "thinned_by": "hob", "tip_rounding_mm": null, "tip_chamfer_mm": null,
                "face_width_mm": 20.0, "tip_relief": null, "profile_modifications": [], "lead_modifications": [],
                "tooth_deviations": null,
                "material": { "youngs_modulus_gpa": 210.0, "poisson_ratio": 0.3, "density_kg_m3": 7850.0, "yield_strength_mpa": null, "expansion_per_k": 11.5e-6, "tensile_strength_mpa": null },
                "blank": { "bore_radius_mm": 15.0, "holes": null, "web": null, "hub": null }
            })
        );
    }
    assert_eq!(
        echo["resolution"],
        json!({
            "positions_per_mesh_period": 40, "span_mesh_periods": 1, "grid": "standard", "blank_positions": 16,
            "interface_radius_mm": null, "contact_solver": "active_set", "stiffness": "tangent",
            "load_distribution": { "tooth": "weber_banaschek", "body": "sainsot", "plane_state": "stress" },
            "error_estimate": false, "face_order": 8, "face_slices": 40
        })
    );
    assert_eq!(
        (&echo["tags"], &echo["driving_speed_rpm"]),
        (&json!([]), &Value::Null)
    );
}

#[test]
fn an_echo_is_its_own_echo() {
    for example in examples().iter().filter(|example| example.valid) {
        let submission = Submission::parse(example.json.as_bytes()).expect("valid");
        let again =
            Submission::parse(submission.canonical_json().as_bytes()).expect("an echo is valid");
        assert_eq!(again, submission, "{}", example.name);
        assert_eq!(again.input_hash(), submission.input_hash());
    }
}

#[test]
fn the_hash_knows_what_decides_the_result_and_no_tags() {
    let hash = |pointer: &str, value: Value| {
        let mut document = least();
        put(&mut document, pointer, value);
        parse(&document).expect("valid").input_hash()
    };
    let plain = parse(&least()).expect("valid").input_hash();
    assert_eq!(plain.len(), 64);
    assert_eq!(hash("/tags", json!(["tuesday"])), plain);
    assert_eq!(
        hash("/resolution", json!({ "span_mesh_periods": 1 })),
        plain,
        "the default, said"
    );
    assert_ne!(hash("/output_torques_n_m", json!([116])), plain);
    assert_ne!(hash("/resolution", json!({ "grid": "fine" })), plain);
}

#[test]
fn the_choices_of_the_resolution_reach_the_engine() {
    use meshwright_engine::analysis::{
        BodyFormula, ContactSolver, Model, PlaneState, StiffnessRule, ToothFormula,
    };
    let mut document = least();
    document["method"] = json!("load_distribution");
    document["driving_speed_rpm"] = json!(600);
    document["resolution"] = json!({
        "contact_solver": { "augmented_lagrangian": { "penalty_n_per_m": 1e10, "gap_tolerance_um": 0.01 } },
        "stiffness": { "torque_step_percent": 1.0 },
        "load_distribution": { "tooth": "iso_6336", "body": "half_plane", "plane_state": "strain" },
        "span_mesh_periods": 3
    });
    let submission = parse(&document).expect("valid");
    let case = submission.case();
    let ContactSolver::AugmentedLagrangian {
        penalty,
        gap_tolerance,
    } = case.resolution.contact_solver
    else {
        panic!("the solver")
    };
    assert_eq!((penalty, gap_tolerance), (Some(1e10), 1e-8));
    assert_eq!(
        case.resolution.stiffness,
        StiffnessRule::TorqueStep { fraction: 0.01 }
    );
    let Model::Formulas(formulas) = case.model else {
        panic!("the model")
    };
    assert_eq!(
        (formulas.tooth, formulas.body, formulas.plane_state),
        (
            ToothFormula::Iso6336,
            BodyFormula::HalfPlane,
            PlaneState::Strain
        )
    );
    assert_eq!(
        (case.driving_speed, case.span()),
        (Some(RotationSpeed(10.0)), 3)
    );
    let echo = echo(&submission);
    for choice in ["contact_solver", "stiffness", "load_distribution"] {
        assert_eq!(echo["resolution"][choice], document["resolution"][choice]);
    }
}

#[test]
fn undercut_gears_are_computed_with_the_path_of_contact_that_is_left() {
    // Public examples of gears; contact ratios by the swept rounding of the rack, and the roll length in mm that the path loses where it does.
    for (teeth, module, tip_radius, center_distance, ratio, lost) in [
        ([17, 43], 1.0, 0.38, 30.0, 1.6211, None),
        (
            [16, 64],
            0.396_875,
            0.150_812_5,
            15.875,
            1.6452,
            Some(0.00175),
        ),
        ([10, 80], 1.0, 0.38, 45.0, 1.0927, Some(1.49)),
        ([17, 22], 4.0, 1.0, 78.0, 1.5477, None),
    ] {
        let gear = |tooth_count: u32| {
            json!({ "tooth_count": tooth_count, "module_mm": module, "face_width_mm": 5.0 * module, "rack_tip_radius_mm": tip_radius,
                    "blank": { "bore_radius_mm": 0.15 * module * f64::from(tooth_count) } })
        };
        let document = json!({
            "method": "flexible",
            "pair": { "center_distance_mm": center_distance, "driving": gear(teeth[0]), "driven": gear(teeth[1]) },
            "output_torques_n_m": [0.05],
        });
        let submission = parse(&document).expect("computed");
        let case = submission.case();
        let found = case.pair.contact_ratio();
        assert!((found - ratio).abs() < 6e-5, "{teeth:?}: {found}");
        let told = warnings(case)
            .iter()
            .map(WarningDocument::of)
            .find(|told| told.code == WarningCode::UndercutShortensPath);
        let value = told.as_ref().and_then(|told| told.value);
        assert_eq!(value.is_some(), lost.is_some(), "{teeth:?}: {value:?}");
        if let (Some(value), Some(lost)) = (value, lost) {
            assert!((value / lost - 1.0).abs() < 5e-3, "{teeth:?}: {value}");
        }
    }
}
