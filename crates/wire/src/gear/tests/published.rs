//! Pairs that other people published, typed in as they stand, with the right values of their sources.

use serde_json::{Value, json};

use crate::testing::{and, fault, first_fault, parse, put, with};
use crate::warning::WarningCode;
use crate::{Code, Validation, validate};

/// A gear with the blank that the rows of the table have.
fn gear(tooth_count: u32, module: f64, face_width: f64, bore: f64, more: &Value) -> Value {
    let gear = json!({
        "tooth_count": tooth_count, "module_mm": module, "face_width_mm": face_width, "blank": { "bore_radius_mm": bore },
    });
    and(gear, more)
}

fn pair(method: &str, center_distance: f64, torque: f64, gears: [Value; 2]) -> Value {
    let [driving, driven] = gears;
    json!({
        "method": method,
        "pair": { "center_distance_mm": center_distance, "driving": driving, "driven": driven },
        "output_torques_n_m": [torque],
    })
}

fn taken(document: &Value) -> Validation {
    let submission = parse(document);
    validate(&submission.unwrap_or_else(|problem| panic!("{document}: {problem:?}")))
}

fn codes(validation: &Validation) -> Vec<WarningCode> {
    let warnings = validation.warnings.iter();
    warnings.map(|warning| warning.code).collect()
}

fn near(value: f64, printed: f64, half_digit: f64) {
    assert!((value - printed).abs() <= half_digit, "{value} {printed}");
}

/// The handbook's pair of KHK, freecad.gears #231.
fn khk(center_distance: f64, thickness: &Value) -> Value {
    let pinion = json!({ "profile_shift": 0.09809, "tip_diameter_mm": 48.153 });
    let wheel = json!({ "tip_diameter_mm": 213.842 });
    let mut document = pair(
        "three_dimensional",
        center_distance,
        500.0,
        [
            gear(12, 3.0, 40.0, 8.0, &and(pinion, thickness)),
            gear(60, 3.0, 40.0, 20.0, &and(wheel, thickness)),
        ],
    );
    document["pair"]["helix_angle_deg"] = json!(30);
    document
}

#[test]
fn pairs_that_jam_by_their_last_printed_digits_have_no_backlash_and_the_contact_ratio_of_their_source()
 {
    let helical = {
        let mut document = pair(
            "three_dimensional",
            165.644,
            500.0,
            [
                gear(20, 4.0, 40.0, 20.0, &json!({})),
                gear(60, 4.0, 40.0, 40.0, &json!({})),
            ],
        );
        document["pair"]["helix_angle_deg"] = json!(15);
        document
    };
    let fzg = pair(
        "flexible",
        91.5,
        453.0,
        [
            gear(
                16,
                4.5,
                14.0,
                15.0,
                &json!({ "profile_shift": 0.1817, "tip_diameter_mm": 82.46 }),
            ),
            gear(
                24,
                4.5,
                14.0,
                20.0,
                &json!({ "profile_shift": 0.1715, "tip_diameter_mm": 118.36 }),
            ),
        ],
    );
    for (document, contact_ratio, half_digit) in [
        (khk(125.0, &json!({})), 1.29381, 6e-6),
        (helical, 1.5924, 6e-5),
        (fzg, 1.4375, 6e-5),
    ] {
        let validation = taken(&document);
        near(validation.pair.contact_ratio, contact_ratio, half_digit);
        assert_eq!(validation.pair.backlash_mm, 0.0);
        assert_eq!(validation.pair.least_backlash_mm, 0.0);
        assert!(codes(&validation).contains(&WarningCode::ZeroBacklash));
    }
    let working = taken(&khk(125.0, &json!({})))
        .pair
        .working_pressure_angle_deg;
    near(working, 23.1126, 6e-5);
}

#[test]
fn what_the_last_digits_do_not_explain_is_refused_with_a_distance_that_is_no_tenth_of_a_micrometer_too_large()
 {
    // 50/50 of module 2: 2 sin 20° (0.5 + 0.2) um = 0.479 um of backlash, 0.7 um of the distance.
    let at = |center_distance: f64| {
        let gear = gear(50, 2.0, 20.0, 15.0, &json!({}));
        pair("flexible", center_distance, 115.0, [gear.clone(), gear])
    };
    let validation = taken(&at(99.999_31));
    let warning = &validation.warnings[0];
    assert!(
        warning.code == WarningCode::ZeroBacklash && warning.detail.contains("0.47 um"),
        "{warning:?}"
    );
    let error = first_fault(&at(99.999_29));
    assert_eq!(
        (error.code, error.nearest),
        (Code::NegativeBacklash, Some(100.0))
    );
    // At 125 mm the pair of KHK lacks 0.9 nm of backlash: by the closed form it fits from 125.000001 mm on.
    let error = first_fault(&khk(124.99, &json!({})));
    let nearest = error.nearest.expect("a distance");
    assert_eq!(nearest, 125.0001, "{error:?}");
    assert!(error.detail.contains("125.0001 mm"), "{}", error.detail);
}

/// A pair of 12 teeth to an inch, one gear typed to fewer decimals.
fn inches(module: f64, more: &Value) -> Value {
    pair(
        "flexible",
        57.15,
        20.0,
        [
            gear(18, module, 20.0, 5.0, more),
            gear(36, 2.116_67, 20.0, 8.0, &json!({})),
        ],
    )
}

#[test]
fn a_module_that_differs_in_printed_digits_only_is_that_with_more_of_them() {
    let validation = taken(&inches(2.1167, &json!({})));
    // π 2.11667 cos 20°.
    near(validation.pair.base_pitch_mm, 6.248_688, 6e-7);
    let taken_over = &validation.warnings[0];
    assert_eq!(taken_over.code, WarningCode::PrintedDigits);
    assert_eq!(taken_over.value, Some(2.116_67));
    assert!(
        taken_over.detail.contains("2.1167 mm") && taken_over.detail.contains("2.11667 mm"),
        "{}",
        taken_over.detail
    );
    let angle = json!({ "pressure_angle_deg": 20.000_000_1 });
    let validation = taken(&inches(2.116_67, &angle));
    assert_eq!(validation.warnings[0].code, WarningCode::PrintedDigits);
}

#[test]
fn numbers_that_differ_are_told_with_the_digits_that_differ() {
    let error = first_fault(&inches(2.1168, &json!({})));
    assert_eq!(error.code, Code::ModuleMismatch);
    assert!(
        error.detail.contains("2.1168 mm") && error.detail.contains("2.11667 mm"),
        "{}",
        error.detail
    );
}

#[test]
fn gears_of_many_teeth_and_of_steep_flanks_are_taken() {
    // ROSS's turbine gear.
    let module = 3.353_658_536_585_365_7;
    let steep = json!({ "pressure_angle_deg": 22.5 });
    let turbine = pair(
        "flexible",
        588.567_073_170_731_6,
        1000.0,
        [
            gear(23, module, 200.0, 25.0, &steep),
            gear(328, module, 200.0, 100.0, &steep),
        ],
    );
    near(taken(&turbine).pair.contact_ratio, 1.6376, 6e-5);
    let stub = json!({ "pressure_angle_deg": 35, "addendum_mm": 3.2, "dedendum_mm": 4.0, "rack_tip_radius_mm": 0.4 });
    let gear = gear(25, 4.0, 30.0, 20.0, &stub);
    let steep = pair("flexible", 100.0, 300.0, [gear.clone(), gear]);
    // 2 (sqrt(53.2² − r_b²) − 50 sin 35°)/(π 4 cos 35°), r_b = 50 cos 35°.
    near(taken(&steep).pair.contact_ratio, 1.0245, 6e-5);
}

#[test]
fn gears_at_the_bounds_of_teeth_and_of_pressure_angles_are_taken_and_one_beyond_is_refused() {
    let toothed = |z: u32, alpha: f64, [x, addendum, dedendum]: [f64; 3]| {
        json!({
            "tooth_count": z, "module_mm": 1, "pressure_angle_deg": alpha, "profile_shift": x, "addendum_mm": addendum, "dedendum_mm": dedendum,
            "rack_tip_radius_mm": 0.05, "face_width_mm": 10, "blank": { "bore_radius_mm": 0.06 * f64::from(z) },
        })
    };
    let meshing = |teeth: [u32; 2], alpha: f64, profiles: [[f64; 3]; 2]| {
        let [one, other] = [0, 1].map(|i| toothed(teeth[i], alpha, profiles[i]));
        pair(
            "flexible",
            f64::from(teeth[0] + teeth[1]) / 2.0,
            1.0,
            [one, other],
        )
    };
    let full = [0.0, 1.0, 1.25];
    let four = |z: u32| meshing([z, 60], 30.0, [[0.5, 0.75, 1.05], [-0.5, 1.0, 1.05]]);
    let steep = |alpha: f64| meshing([200, 400], alpha, [[0.0, 0.86, 0.905]; 2]);
    // The contact ratio without undercut: (sqrt(r_a1² − r_b1²) + sqrt(r_a2² − r_b2²) − a sin α)/(π cos α).
    let unlost = |teeth: [f64; 2], alpha: f64, addendum: f64| {
        let alpha = alpha.to_radians();
        let reach = teeth.map(|z| {
            let (r, r_b) = (0.5 * z, 0.5 * z * alpha.cos());
            ((r + addendum).powi(2) - r_b * r_b).sqrt()
        });
        let a = 0.5 * (teeth[0] + teeth[1]);
        (reach[0] + reach[1] - a * alpha.sin()) / (std::f64::consts::PI * alpha.cos())
    };
    // Four teeth are always undercut: an own sampling of the trochoid, to four digits.
    let few = taken(&four(4));
    assert!(codes(&few).contains(&WarningCode::UndercutShortensPath));
    assert!(few.pair.contact_ratio > 1.0 && few.pair.contact_ratio < 1.05);
    for (document, teeth, alpha, addendum) in [
        (
            meshing([1000, 1000], 20.0, [full; 2]),
            [1000.0, 1000.0],
            20.0,
            1.0,
        ),
        (
            meshing([30, 1000], 20.0, [full; 2]),
            [30.0, 1000.0],
            20.0,
            1.0,
        ),
        (steep(40.0), [200.0, 400.0], 40.0, 0.86),
        (
            meshing([200, 200], 10.0, [full; 2]),
            [200.0, 200.0],
            10.0,
            1.0,
        ),
    ] {
        near(
            taken(&document).pair.contact_ratio,
            unlost(teeth, alpha, addendum),
            1e-9,
        );
    }
    for (document, pointer, nearest) in [
        (four(3), "/pair/driving/tooth_count", 4.0),
        (
            meshing([1001, 1000], 20.0, [full; 2]),
            "/pair/driving/tooth_count",
            1000.0,
        ),
        (steep(40.1), "/pair/driving/pressure_angle_deg", 40.0),
        (
            meshing([200, 200], 9.9, [full; 2]),
            "/pair/driving/pressure_angle_deg",
            10.0,
        ),
    ] {
        let error = first_fault(&document);
        assert_eq!(
            (&*error.pointer, error.code, error.nearest),
            (pointer, Code::OutOfRange, Some(nearest))
        );
    }
}

#[test]
fn a_rack_that_comes_to_a_point_is_told_the_dedendum_that_does_not() {
    let steep = json!({ "pressure_angle_deg": 38 });
    let gear = gear(25, 4.0, 30.0, 20.0, &steep);
    let document = pair("flexible", 100.0, 300.0, [gear.clone(), gear]);
    let error = fault(&document, "/pair/driving/dedendum_mm", Code::OutOfRange);
    // (π/4 m − 0.05 m (1 − sin α)/cos α)/tan α.
    let nearest = error.nearest.expect("a dedendum");
    near(nearest, 3.8962, 1e-4);
}

#[test]
fn a_ligament_is_judged_in_modules() {
    let small = |scale: f64| {
        let holes =
            json!({ "count": 6, "circle_radius_mm": 4.5 * scale, "radius_mm": 2.1 * scale });
        let wheel = json!({ "blank": { "bore_radius_mm": 1.5 * scale, "holes": holes } });
        let (module, width) = (0.2 * scale, 2.0 * scale);
        pair(
            "flexible",
            10.05 * scale,
            0.01 * scale.powi(3),
            [
                gear(20, module, width, 0.6 * scale, &json!({})),
                gear(80, module, width, 1.5 * scale, &wheel),
            ],
        )
    };
    let [one, ten] = [1.0, 10.0].map(|scale| taken(&small(scale)));
    assert_eq!(codes(&one), codes(&ten));
    let ligaments = [one, ten].map(|validation| validation.pair.driven.least_ligament_mm);
    near(
        10.0 * ligaments[0].expect("holes"),
        ligaments[1].expect("holes"),
        1e-12,
    );
    for scale in [1.0, 10.0] {
        let mut thin = small(scale);
        put(
            &mut thin,
            "/pair/driven/blank/holes/radius_mm",
            json!(2.24 * scale),
        );
        let error = first_fault(&thin);
        assert_eq!(error.code, Code::HolesOverlap);
        // Five digits, inward.
        near(
            error.nearest.expect("a radius"),
            2.225 * scale,
            1.1e-4 * scale,
        );
        assert!(error.detail.contains("0.25 modules"), "{}", error.detail);
    }
}

#[test]
fn hunting_teeth_on_uneven_blanks_are_computed_where_the_holes_superpose() {
    let hunting = |method: &str| {
        let holes = |count, circle, radius| json!({ "count": count, "circle_radius_mm": circle, "radius_mm": radius });
        let blank = |bore, holes| json!({ "blank": { "bore_radius_mm": bore, "holes": holes } });
        pair(
            method,
            159.2,
            50.0,
            [
                gear(41, 2.0, 20.0, 10.0, &blank(10, holes(7, 25, 5))),
                gear(118, 2.0, 20.0, 20.0, &blank(20, holes(8, 60, 15))),
            ],
        )
    };
    // 41 and 118/2 share no factor.
    let validation = taken(&hunting("projected_decomposition"));
    assert_eq!(validation.pair.period_mesh_periods, 2419);
    taken(&hunting("three_dimensional_projected"));
    let error = first_fault(&hunting("flexible"));
    assert_eq!(error.code, Code::TooLarge);
    let span = ("/resolution", json!({ "span_mesh_periods": 500 }));
    taken(&with(hunting("flexible"), &[span]));
    // Positions times torques, at the bound and just beyond it.
    let sized = |span: u32, torques: &Value| {
        let resolution = json!({ "positions_per_mesh_period": 100, "span_mesh_periods": span });
        let changes = [
            ("/resolution", resolution),
            ("/output_torques_n_m", torques.clone()),
        ];
        parse(&with(hunting("projected_decomposition"), &changes))
    };
    for (span, torques) in [(2000, json!([50])), (1000, json!([50, 60]))] {
        assert!(sized(span, &torques).is_ok(), "{span}");
        let beyond = sized(span + 1, &torques)
            .expect_err("too many")
            .errors
            .remove(0);
        assert_eq!(beyond.code, Code::TooLarge);
        assert!(
            beyond.detail.contains("200000") || beyond.detail.contains("200,000"),
            "{}",
            beyond.detail
        );
    }
    // Teeth that deviate do not repeat with the mesh period.
    let mut deviating = hunting("projected_decomposition");
    let eccentric = json!({ "eccentricity": { "amount_um": 5 } });
    put(&mut deviating, "/pair/driving/tooth_deviations", eccentric);
    assert_eq!(
        parse(&deviating).expect_err("too many").errors[0].code,
        Code::TooLarge
    );
}

#[test]
fn the_backlash_of_a_helical_pair_is_normal_and_its_transverse_one_stands_beside_it() {
    let thinner = json!({ "tooth_thickness_deviation_um": -69.282 });
    let pair = taken(&khk(125.0001, &thinner)).pair;
    // Two teeth that are 69.282 um cos 30° = 60 um thinner in the normal section: 2 x 60 um cos 20°, and the part of the center distance.
    near(pair.backlash_mm, 0.11283, 6e-6);
    near(pair.backlash_line_of_action_mm, 0.12782, 6e-6);
    // j_wt of ISO 21771 stands at the working pitch circle, under the 23.1126 degrees of the handbook: over their cosine.
    near(
        pair.backlash_transverse_mm,
        0.12782 / 23.1126_f64.to_radians().cos(),
        8e-6,
    );
    near(pair.least_backlash_mm, pair.backlash_mm, 0.0);
    // s_an = s_at cos β_a, tan β_a = tan β d_a/d.
    let tip = &pair.driving;
    let beta = (30_f64.to_radians().tan() * tip.tip_radius_mm / tip.reference_radius_mm).atan();
    near(
        tip.tip_thickness_mm,
        tip.tip_thickness_transverse_mm * beta.cos(),
        1e-12,
    );
    assert!(tip.tip_thickness_mm < 0.85 * tip.tip_thickness_transverse_mm);
    // The same thickness as A_sn.
    let normal = json!({ "tooth_thickness_deviation_normal_um": -60.0 });
    let said = taken(&khk(125.0001, &normal)).pair;
    near(said.backlash_mm, pair.backlash_mm, 1e-6);
}

/// A KISSsoft report of a planet stage, its tip diameters left out.
fn nrel() -> Value {
    let steel = json!({ "youngs_modulus_gpa": 206, "poisson_ratio": 0.3, "density_kg_m3": 7830 });
    let shifted = |x: f64| json!({ "profile_shift": x, "material": steel });
    pair(
        "flexible",
        863.0,
        298_141.5,
        [
            gear(19, 45.0, 491.0, 200.0, &shifted(0.617)),
            gear(17, 45.0, 491.0, 180.0, &shifted(0.8021)),
        ],
    )
}

#[test]
fn tips_that_nobody_shortened_are_told_with_the_diameters_that_programs_give_them() {
    let validation = taken(&nrel());
    near(validation.pair.contact_ratio, 1.387, 6e-4);
    for gear in [&validation.pair.driving, &validation.pair.driven] {
        near(gear.tip_clearance_mm, 0.009 * 45.0, 0.02);
    }
    let told: Vec<_> = validation
        .warnings
        .iter()
        .filter(|warning| warning.code == WarningCode::SmallTipClearance)
        .collect();
    assert_eq!(told.len(), 2);
    let mut shortened = nrel();
    for (pointer, diameter) in &told[0].changes {
        put(&mut shortened, pointer, json!(diameter));
    }
    // The report prints 978.808 and 905.470; x to four decimals of 45 mm leaves 9 um of a diameter.
    near(
        told[0].changes["/pair/driving/tip_diameter_mm"],
        978.808,
        9e-3,
    );
    near(
        told[0].changes["/pair/driven/tip_diameter_mm"],
        905.470,
        9e-3,
    );
    let validation = taken(&shortened);
    near(validation.pair.contact_ratio, 1.1148, 2e-4);
    assert!(!codes(&validation).contains(&WarningCode::SmallTipClearance));
    // The racks' own clearance of a quarter of a module.
    near(validation.pair.driving.tip_clearance_mm, 11.25, 1e-3);
}

#[test]
fn a_negative_number_of_teeth_is_answered_as_the_internal_gear_that_it_is() {
    let mut document = nrel();
    put(&mut document, "/pair/driven/tooth_count", json!(-93));
    let error = fault(&document, "/pair/driven/tooth_count", Code::OutOfRange);
    assert!(
        error.detail.contains("internal gears are not computed"),
        "{}",
        error.detail
    );
}

#[test]
fn the_wrong_tip_diameter_of_a_helical_gear_is_told_at_its_own_field() {
    let mut document = khk(125.0, &json!({}));
    put(&mut document, "/pair/driving/tip_diameter_mm", json!(1.0));
    let error = fault(&document, "/pair/driving/tip_diameter_mm", Code::OutOfRange);
    // 0.2 modules of addendum on 36 mm/cos 30° and two shifts.
    let least = 36.0 / 30_f64.to_radians().cos() + 2.0 * 3.0 * (0.09809 + 0.2);
    near(error.nearest.expect("a diameter"), least, 1e-2);
    assert!(
        error.detail.starts_with("1 mm is outside"),
        "{}",
        error.detail
    );
}

#[test]
fn a_thickness_may_be_said_by_a_span_or_by_balls_and_at_most_once() {
    let straight = |more: &Value| {
        let gears = [
            gear(25, 2.0, 20.0, 10.0, more),
            gear(50, 2.0, 20.0, 16.0, &json!({})),
        ];
        pair("flexible", 75.0, 50.0, gears)
    };
    // 50 um thinner by the transverse arc: W_k 50 um cos 20° less than that of the tables, 7.730467 m over 3 teeth.
    let deviation = taken(&straight(&json!({ "tooth_thickness_deviation_um": -50.0 }))).pair;
    near(
        deviation.backlash_mm,
        0.05 * 20_f64.to_radians().cos(),
        1e-9,
    );
    let length = 2.0 * 7.730_467 - 0.05 * 20_f64.to_radians().cos();
    let span = json!({ "span_measurement": { "teeth": 3, "length_mm": length } });
    let by_span = taken(&straight(&span)).pair;
    near(by_span.backlash_mm, deviation.backlash_mm, 2e-6);
    let both = and(span, &json!({ "tooth_thickness_deviation_um": -50.0 }));
    let error = first_fault(&straight(&both));
    assert_eq!(error.code, Code::ConflictingFields);
    // Over balls of 3.5 mm (DIN 3960): d_b/cos α_K cos(90°/z) + D, inv α_K = inv α + D/(z m cos α) − e/(z m), with spaces 50 um wider.
    let inv = |angle: f64| angle.tan() - angle;
    let (alpha, z, m, ball) = (20_f64.to_radians(), 25.0, 2.0, 3.5);
    let space = std::f64::consts::PI * m / 2.0 + 0.05;
    let wanted = inv(alpha) + ball / (z * m * alpha.cos()) - space / (z * m);
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        *(if inv(middle) < wanted {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    let over = z * m * alpha.cos() / low.cos() * (90.0 / z).to_radians().cos() + ball;
    let balls = json!({ "ball_measurement": { "ball_diameter_mm": ball, "over_balls_mm": over } });
    let by_balls = taken(&straight(&balls)).pair;
    near(by_balls.backlash_mm, deviation.backlash_mm, 1e-9);
    // A span over a tooth more or less is refused with the length that the rack gives.
    let wrong = json!({ "span_measurement": { "teeth": 4, "length_mm": length } });
    let error = fault(
        &straight(&wrong),
        "/pair/driving/span_measurement/length_mm",
        Code::OutOfRange,
    );
    assert!(
        error
            .detail
            .contains("Teeth as the rack cuts them have 21.36"),
        "{}",
        error.detail
    );
    // Balls of 7 mm on the same teeth touch at a roll length of 13.76 mm; the tip is at 13.31 mm.
    let large = json!({ "ball_measurement": { "ball_diameter_mm": 7.0, "over_balls_mm": 65.19 } });
    let error = first_fault(&straight(&large));
    assert_eq!(
        error.pointer,
        "/pair/driving/ball_measurement/ball_diameter_mm"
    );
}

#[test]
fn tips_that_stand_nearer_than_the_racks_leave_them_are_told_though_they_are_far_from_the_roots() {
    // A handbook's pair (KHK): 12/24 of module 3, whose tips it shortens: h_a1 = (1 + y - x_2) m, and its contact ratio is 1.202 with d_a of 44.840 and 79.400.
    let typed = |tips: [Value; 2]| {
        let [pinion, wheel] = tips;
        let document = pair(
            "flexible",
            56.4999,
            20.0,
            [
                gear(
                    12,
                    3.0,
                    20.0,
                    5.0,
                    &and(json!({ "profile_shift": 0.6 }), &pinion),
                ),
                gear(
                    24,
                    3.0,
                    20.0,
                    10.0,
                    &and(json!({ "profile_shift": 0.36 }), &wheel),
                ),
            ],
        );
        taken(&document)
    };
    let whole = typed([json!({}), json!({})]);
    near(whole.pair.contact_ratio, 1.348, 6e-4);
    near(whole.pair.driving.tip_clearance_mm, 0.123 * 3.0, 2e-3);
    let mut told = whole.warnings.iter();
    let told = told.find(|warning| warning.code == WarningCode::SmallTipClearance);
    let told = told.expect("nobody shortened the tips");
    near(told.changes["/pair/driving/tip_diameter_mm"], 44.840, 2e-3);
    near(told.changes["/pair/driven/tip_diameter_mm"], 79.400, 2e-3);
    let diameter = |d: f64| json!({ "tip_diameter_mm": d });
    let shortened = typed([diameter(44.840), diameter(79.400)]);
    near(shortened.pair.contact_ratio, 1.202, 6e-4);
    assert!(!codes(&shortened).contains(&WarningCode::SmallTipClearance));
    // Racks that leave a tenth of a module themselves lose nothing.
    let tight = |x: f64| {
        let fields = json!({ "profile_shift": x, "dedendum_mm": 3.3, "rack_tip_radius_mm": 0.6 });
        gear(24, 3.0, 20.0, 10.0, &fields)
    };
    let exact = taken(&pair("flexible", 72.02, 20.0, [tight(0.0), tight(0.0)]));
    assert!(!codes(&exact).contains(&WarningCode::SmallTipClearance));
}
