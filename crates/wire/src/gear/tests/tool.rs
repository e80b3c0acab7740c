//! Where the tool stands that cuts the root: by the thickness, by the root circle, or as it is said.

use serde_json::{Value, json};

use crate::testing::{and, fault, parse, put};
use crate::{Code, Validation, validate};

fn taken(document: &Value) -> Validation {
    let submission = parse(document);
    validate(&submission.unwrap_or_else(|problem| panic!("{document}: {problem:?}")))
}

fn near(value: f64, expected: f64, apart: f64) {
    assert!((value - expected).abs() <= apart, "{value} {expected}");
}

/// The pair of a public listing of STplus: 51/52 of module 1 in plastics, with its thickness deviations A_sn and `more` in both gears.
fn listed(more: &Value) -> Value {
    let gear = |teeth: u32, x: f64, tip: f64, dedendum: f64, thinner: f64| {
        let gear = json!({
            "tooth_count": teeth, "module_mm": 1, "face_width_mm": 15, "blank": { "bore_radius_mm": 10 }, "profile_shift": x, "tip_diameter_mm": tip,
            "dedendum_mm": dedendum, "rack_tip_radius_mm": 0.2, "tooth_thickness_deviation_normal_um": thinner,
        });
        and(gear, more)
    };
    json!({
        "method": "flexible",
        "pair": {
            "center_distance_mm": 52,
            "driving": gear(51, 0.2034, 52.894, 1.1, -295.835),
            "driven": gear(52, 0.3143, 54.022, 1.25, -220.275),
        },
        "output_torques_n_m": [9.804],
    })
}

/// Root, form and tip diameter of both gears.
fn diameters(validation: &Validation) -> [[f64; 3]; 2] {
    [&validation.pair.driving, &validation.pair.driven].map(|gear| {
        [
            2.0 * gear.root_radius_mm,
            gear.form_diameter_mm,
            2.0 * gear.tip_radius_mm,
        ]
    })
}

#[test]
fn a_hob_cuts_thinner_teeth_deeper_as_the_listing_prints_it() {
    let hobbed = taken(&listed(&json!({})));
    let printed = [[48.394, 49.081, 52.894], [49.523, 50.158, 54.022]];
    for (found, printed) in diameters(&hobbed).iter().zip(printed) {
        for (found, printed) in found.iter().zip(printed) {
            // x to four decimals of a millimeter and A_sn to a tenth of a micrometer leave 2 um of a form diameter.
            near(*found, printed, 2e-3);
        }
    }
    // x_E = x + A_sn/(2 m tan 20 degrees).
    let tan = 20_f64.to_radians().tan();
    for (gear, x_e) in [
        (&hobbed.pair.driving, 0.2034 - 0.295_835 / (2.0 * tan)),
        (&hobbed.pair.driven, 0.3143 - 0.220_275 / (2.0 * tan)),
    ] {
        near(gear.generating_profile_shift, x_e, 1e-12);
    }
    // Ground thinner, the root stays where the nominal shift has it: r − h_f + x m.
    let ground = taken(&listed(&json!({ "thinned_by": "flank_grinding" })));
    let [driving, driven] = diameters(&ground);
    near(driving[0], 51.0 - 2.2 + 2.0 * 0.2034, 1e-9);
    near(driven[0], 52.0 - 2.5 + 2.0 * 0.3143, 1e-9);
    near(ground.pair.driving.generating_profile_shift, 0.2034, 1e-12);
    // Flanks are the same either way.
    near(ground.pair.backlash_mm, hobbed.pair.backlash_mm, 1e-12);
    near(
        ground.pair.driving.tip_thickness_mm,
        hobbed.pair.driving.tip_thickness_mm,
        1e-12,
    );
}

#[test]
fn every_way_to_say_the_thickness_means_the_same_root() {
    let helix = 20_f64.to_radians();
    let gear = |z: u32, more: &Value| {
        let gear = json!({ "tooth_count": z, "module_mm": 2, "face_width_mm": 20, "profile_shift": 0.2, "blank": { "bore_radius_mm": 10 } });
        and(gear, more)
    };
    let pair = |more: &Value| {
        let document = json!({
            "method": "three_dimensional",
            "pair": { "center_distance_mm": 80.5, "driving": gear(25, more), "driven": gear(50, &json!({})), "helix_angle_deg": 20 },
            "output_torques_n_m": [50],
        });
        taken(&document).pair.driving
    };
    // A_sn = -70 um is A_st = A_sn/cos 20 degrees, and W_k less by 70 um cos 20 degrees (the pressure angle).
    let by_normal = pair(&json!({ "tooth_thickness_deviation_normal_um": -70 }));
    let by_transverse = pair(&json!({ "tooth_thickness_deviation_um": -70.0 / helix.cos() }));
    let alpha = 20_f64.to_radians();
    let transverse = (alpha.tan() / helix.cos()).atan();
    let involute = transverse.tan() - transverse;
    let span = 2.0 * alpha.cos() * (std::f64::consts::PI * 2.5 + 25.0 * involute)
        + 2.0 * 0.2 * 2.0 * alpha.sin()
        - 0.07 * alpha.cos();
    let by_span = pair(&json!({ "span_measurement": { "teeth": 3, "length_mm": span } }));
    let x_e = 0.2 - 0.07 / (4.0 * alpha.tan());
    for gear in [&by_normal, &by_transverse, &by_span] {
        near(gear.generating_profile_shift, x_e, 1e-9);
        let reference = 25.0 / helix.cos();
        near(gear.root_radius_mm, reference - 2.5 + 2.0 * x_e, 1e-9);
        near(gear.tip_radius_mm, reference + 2.0 + 2.0 * 0.2, 1e-9);
    }
}

#[test]
fn a_typed_root_diameter_stays_as_it_is_and_the_result_says_its_generating_shift() {
    let typed = |more: Value| {
        let mut document = listed(&more);
        for (gear, diameter) in [("driving", 48.394), ("driven", 49.523)] {
            let gear = &mut document["pair"][gear];
            gear.as_object_mut().expect("a gear").remove("dedendum_mm");
            gear["root_diameter_mm"] = json!(diameter);
        }
        taken(&document)
    };
    for more in [json!({}), json!({ "thinned_by": "flank_grinding" })] {
        let found = diameters(&typed(more));
        near(found[0][0], 48.394, 1e-9);
        near(found[1][0], 49.523, 1e-9);
    }
    let hobbed = typed(json!({}));
    near(hobbed.pair.driving.generating_profile_shift, -0.203, 1e-4);
    near(hobbed.pair.driving.form_diameter_mm, 49.081, 1e-3);
    // Both are one statement.
    let mut both = listed(&json!({}));
    put(&mut both, "/pair/driving/root_diameter_mm", json!(48.394));
    assert_eq!(
        parse(&both).expect_err("twice").errors[0].code,
        Code::ConflictingFields
    );
    // Its bounds are those of the dedendum: half a module at least, at x_E = -0.203.
    let mut shallow = listed(&json!({}));
    let driving = &mut shallow["pair"]["driving"];
    driving
        .as_object_mut()
        .expect("a gear")
        .remove("dedendum_mm");
    driving["root_diameter_mm"] = json!(50.5);
    let error = fault(&shallow, "/pair/driving/root_diameter_mm", Code::OutOfRange);
    near(error.nearest.expect("a diameter"), 51.0 - 2.0 * 0.703, 1e-3);
}

#[test]
fn a_generating_shift_that_is_said_holds_whatever_the_thickness() {
    let said = taken(&listed(&json!({ "generating_profile_shift": -0.1 })));
    near(said.pair.driving.generating_profile_shift, -0.1, 1e-12);
    near(said.pair.driving.root_radius_mm, 25.5 - 1.1 - 0.1, 1e-9);
    let hobbed = taken(&listed(&json!({})));
    near(said.pair.backlash_mm, hobbed.pair.backlash_mm, 1e-12);
}

#[test]
fn the_grinding_stock_of_a_hob_with_a_protuberance_does_not_move_it() {
    // Its flank stands back by the stock: it leaves the teeth thicker by that where it stands at x_E already.
    let hob =
        json!({ "protuberance": { "amount_um": 60, "height_mm": 0.7, "grinding_stock_um": 40 } });
    let plain = taken(&listed(&json!({})));
    let ground = taken(&listed(&hob));
    near(
        ground.pair.driving.generating_profile_shift,
        plain.pair.driving.generating_profile_shift,
        1e-15,
    );
    near(
        ground.pair.driving.root_radius_mm,
        plain.pair.driving.root_radius_mm,
        1e-12,
    );
}

#[test]
fn teeth_that_are_cut_away_by_a_deep_hob_name_what_raises_it() {
    let pinion = |more: Value| {
        let gear = json!({ "tooth_count": 6, "module_mm": 2, "face_width_mm": 20, "profile_shift": -0.1, "blank": { "bore_radius_mm": 1 } });
        let wheel = json!({ "tooth_count": 40, "module_mm": 2, "face_width_mm": 20, "blank": { "bore_radius_mm": 10 } });
        json!({
            "method": "flexible",
            "pair": { "center_distance_mm": 46, "driving": and(gear, &more), "driven": wheel },
            "output_torques_n_m": [5],
        })
    };
    let by_deviation = json!({ "tooth_thickness_deviation_normal_um": -900 });
    let error = fault(
        &pinion(by_deviation),
        "/pair/driving/profile_shift",
        Code::Undercut,
    );
    // The rack's straight depth of 1 module (0.38 of tip rounding) less z sin²α/2, and the deeper stand of the hob: 0.9 mm/(4 mm tan 20 degrees).
    let (sin, tan) = (20_f64.to_radians().sin(), 20_f64.to_radians().tan());
    let smallest = 1.25 - 0.38 * (1.0 - sin) - 3.0 * sin * sin + 0.9 / (4.0 * tan);
    near(error.nearest.expect("a shift"), smallest, 1e-3);
}

#[test]
fn a_published_gear_with_a_shift_beyond_two_modules_is_taken() {
    // A low-loss gear: its transverse contact ratio is 0.9346, and the overlap carries it.
    let gear = |teeth: u32, x: f64, tip: f64| {
        json!({
            "tooth_count": teeth, "module_mm": 1.75, "face_width_mm": 21.2418, "blank": { "bore_radius_mm": 15 }, "profile_shift": x, "tip_diameter_mm": tip,
            "rack_tip_radius_mm": 0.4375,
        })
    };
    let document = json!({
        "method": "three_dimensional",
        "pair": { "center_distance_mm": 91.5, "driving": gear(38, 1.6915, 76.23), "driven": gear(57, 2.0003, 111.734), "helix_angle_deg": 15 },
        "output_torques_n_m": [300],
    });
    near(taken(&document).pair.contact_ratio, 0.9346, 6e-5);
}
