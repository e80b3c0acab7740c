//! Fields of three dimensions, their refusals in the plane, and results of a pair along its faces.

use meshwright_engine::gear::FaceEnds;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use serde_json::{Value, json};

use super::least;
use crate::contact_pattern::{PatternCurveDocument, PatternFlank, PatternPressure};
use crate::results::FaceDocument;
use crate::solve::contact_pattern;
use crate::testing::{fault, faults, filled_in, parse, refused, with};
use crate::{Code, ContactPatternDocument, Results, Submission, solve};

/// A straight pair that three dimensions take.
fn solid() -> Value {
    with(least(), &[("/method", json!("three_dimensional"))])
}

/// Values, and where they are put.
type Changes<'a> = Vec<(&'a str, Value)>;

#[test]
fn planes_refuse_what_they_do_not_know_and_three_dimensions_take_it() {
    let web =
        json!({ "inner_radius_mm": 20, "outer_radius_mm": 42, "thickness_mm": 6, "offset_mm": 2 });
    let hub = json!({ "outer_radius_mm": 20, "width_mm": 24 });
    let slopes = json!({ "lead_slope_um": vec![3.0; 50] });
    let crowned = json!([{ "kind": "crowning", "amount_um": 5 }]);
    for ((pointer, value), told_at, code, nearest) in refused! {
        ("/pair/helix_angle_deg", json!(10)) => "/pair/helix_angle_deg", NeedsThreeDimensions;
        ("/pair/axial_offset_mm", json!(-1)) => "/pair/axial_offset_mm", NeedsThreeDimensions, 0.0;
        ("/pair/misalignment_um", json!({ "out_of_plane_um": 5 })) => "/pair/misalignment_um", NeedsThreeDimensions;
        ("/pair/driving/lead_modifications", crowned) => "/pair/driving/lead_modifications", NeedsThreeDimensions;
        ("/pair/driven/tooth_deviations", slopes) => "/pair/driven/tooth_deviations/lead_slope_um", NeedsThreeDimensions;
        ("/pair/driven/blank/web", web) => "/pair/driven/blank/web/offset_mm", NeedsThreeDimensions, 0.0;
        ("/pair/driving/blank/hub", hub) => "/pair/driving/blank/hub", NeedsThreeDimensions;
    } {
        for method in [
            "flexible",
            "decomposition",
            "projected_decomposition",
            "load_distribution",
        ] {
            let document = with(
                least(),
                &[(pointer, value.clone()), ("/method", json!(method))],
            );
            let problem = parse(&document).expect_err(pointer);
            assert_eq!(faults(problem), [(told_at.to_owned(), code, nearest)]);
        }
        let mut changes = vec![(pointer, value)];
        if pointer.contains("helix") {
            changes.push(("/pair/center_distance_mm", json!(102.0)));
        }
        for method in ["three_dimensional", "three_dimensional_projected"] {
            changes.push(("/method", json!(method)));
            let taken = parse(&with(least(), &changes));
            assert!(taken.is_ok(), "{method}, {pointer}: {taken:?}");
        }
    }
}

#[test]
fn a_transverse_contact_ratio_below_one_is_taken_where_teeth_overlap_along_the_face() {
    // 50/50 teeth of module 2 with an addendum of 0.4 modules: about 0.7 transverse, and 1.09 of overlap at a width of 20 mm.
    let changes = |width: f64| -> Changes<'_> {
        vec![
            ("/pair/helix_angle_deg", json!(20)),
            ("/pair/center_distance_mm", json!(106.42)),
            ("/pair/driving/addendum_mm", json!(0.8)),
            ("/pair/driven/addendum_mm", json!(0.8)),
            ("/pair/driving/face_width_mm", json!(width)),
        ]
    };
    let submission = parse(&with(solid(), &changes(20.0))).expect("the total is above one");
    assert!(submission.case().pair.contact_ratio() < 0.8);
    let narrow = with(solid(), &changes(3.0));
    fault(
        &narrow,
        "/pair/center_distance_mm",
        Code::ContactRatioBelowOne,
    );
}

#[test]
fn a_shaft_takes_its_torque_at_both_ends_in_the_plane_and_at_any_in_three_dimensions() {
    let cut = |torque_at: &str, method: &str| {
        let blank = json!({ "shaft": { "radius_mm": 20, "torque_at": torque_at } });
        let changes = [("/pair/driving/blank", blank), ("/method", json!(method))];
        with(least(), &changes)
    };
    assert!(parse(&cut("both", "flexible")).is_ok());
    for torque_at in ["minus", "plus"] {
        let place = "/pair/driving/blank/shaft/torque_at";
        fault(
            &cut(torque_at, "flexible"),
            place,
            Code::NeedsThreeDimensions,
        );
    }
    for (torque_at, told) in [
        ("both", FaceEnds::Both),
        ("minus", FaceEnds::Minus),
        ("plus", FaceEnds::Plus),
    ] {
        let submission = parse(&cut(torque_at, "three_dimensional")).expect("it is told");
        let blank = &submission.case().pair.driving().data().blank;
        assert_eq!(blank.shaft(), Some(told));
    }
}

#[test]
fn what_is_said_to_be_nothing_is_nothing() {
    let nothing = [
        ("/pair/helix_angle_deg", json!(0)),
        ("/pair/axial_offset_mm", json!(0)),
        ("/pair/misalignment_um", json!({ "in_plane_um": 0 })),
        ("/pair/driving/lead_modifications", json!([])),
    ];
    assert!(parse(&with(least(), &nothing)).is_ok());
}

#[test]
fn what_three_dimensions_do_not_tell_is_refused_with_its_place() {
    let solver = json!({ "contact_solver": "augmented_lagrangian" });
    let document = with(solid(), &[("/resolution", solver)]);
    let place = "/resolution/contact_solver";
    fault(&document, place, Code::NotInThreeDimensions);
}

#[test]
fn each_fault_along_the_axis_is_told_with_a_value_that_would_do() {
    let web = |offset: f64| json!({ "inner_radius_mm": 20, "outer_radius_mm": 42, "thickness_mm": 6, "offset_mm": offset });
    let thick_web = json!({ "inner_radius_mm": 20, "outer_radius_mm": 42, "thickness_mm": 25 });
    let hub = |width: f64, outer: f64| json!({ "outer_radius_mm": outer, "width_mm": width });
    let relief =
        |length: f64| json!([{ "kind": "end_relief", "amount_um": 5, "length_mm": length }]);
    let table = json!([{ "kind": "table", "z_mm": [0, 0], "removed_um": [0, 1] }]);
    let holed = |circle: f64, radius: f64| -> Changes<'_> {
        let holes = json!({ "count": 3, "circle_radius_mm": circle, "radius_mm": radius });
        vec![
            ("/pair/driven/blank/web", web(0.0)),
            ("/pair/driven/blank/holes", holes),
        ]
    };
    // The fillets of so few teeth, shifted inward, would meet.
    let undercut = vec![
        ("/pair/driving/profile_shift", json!(-1.8)),
        ("/pair/helix_angle_deg", json!(20)),
        ("/pair/driving/tooth_count", json!(10)),
        ("/pair/center_distance_mm", json!(64.5)),
        ("/pair/driving/blank/bore_radius_mm", json!(4)),
    ];
    let near_roots = json!({ "count": 7, "circle_radius_mm": 38.0, "radius_mm": 8.8 });
    let narrow_hub = vec![
        ("/pair/driven/blank/web", web(0.0)),
        ("/pair/driven/blank/hub", hub(5.0, 20.0)),
    ];
    for (changes, told_at, code, _) in refused! {
        vec![("/pair/axial_offset_mm", json!(19))] => "/pair/axial_offset_mm", FacesDoNotOverlap;
        vec![("/pair/axial_offset_mm", json!(-40))] => "/pair/axial_offset_mm", FacesDoNotOverlap;
        vec![("/pair/driven/blank/web", web(9.0))] => "/pair/driven/blank/web/offset_mm", WebBeyondFace;
        vec![("/pair/driven/blank/web", thick_web)] => "/pair/driven/blank/web/thickness_mm", WebBeyondFace;
        narrow_hub => "/pair/driven/blank/hub/width_mm", HubDoesNotFit;
        vec![("/pair/driven/blank/hub", hub(24.0, 60.0))] => "/pair/driven/blank/hub/outer_radius_mm", HubDoesNotFit;
        holed(24.0, 5.0) => "/pair/driven/blank/holes/circle_radius_mm", HoleAcrossEdge;
        holed(39.0, 5.0) => "/pair/driven/blank/holes/circle_radius_mm", HoleAcrossEdge;
        holed(31.0, 12.0) => "/pair/driven/blank/holes/radius_mm", HoleAcrossEdge;
        vec![("/pair/driven/blank/holes", near_roots)] => "/pair/driven/blank/holes/radius_mm", TooLarge;
        vec![("/pair/driven/lead_modifications", relief(11.0))]
            => "/pair/driven/lead_modifications/0/length_mm", OutOfRange;
        vec![("/pair/driven/lead_modifications", table)] => "/pair/driven/lead_modifications/0/z_mm", TableDoesNotRise;
        vec![("/pair/helix_angle_deg", json!(46))] => "/pair/helix_angle_deg", OutOfRange;
        undercut => "/pair/driving/profile_shift", Undercut;
    } {
        let document = with(solid(), &changes);
        let Some(nearest) = fault(&document, told_at, code).nearest else {
            assert_eq!(code, Code::TableDoesNotRise);
            continue;
        };
        let cured = with(document, &[(told_at, json!(nearest))]);
        let left = parse(&cured).err().map(|problem| problem.errors);
        let left = left.unwrap_or_default();
        assert!(
            left.iter().all(|error| error.pointer != told_at),
            "{left:?}"
        );
    }
    let plain = ("/pair/driven/blank", json!({ "bore_radius_mm": 15 }));
    assert!(parse(&with(solid(), &[plain])).is_ok());
}

#[test]
fn a_helical_pair_has_the_sections_of_the_standard() {
    let document = with(
        solid(),
        &[
            ("/pair/helix_angle_deg", json!(20)),
            ("/pair/center_distance_mm", json!(107.0)),
            ("/pair/driving/profile_shift", json!(0.2)),
            ("/pair/driven/tip_diameter_mm", json!(110.4)),
        ],
    );
    let submission = parse(&document).expect("a pair that meshes");
    let pair = &submission.case().pair;
    let cos = 20_f64.to_radians().cos();
    let (driving, driven) = (pair.driving(), pair.driven());
    assert!((driving.reference_radius() - 50e-3 / cos).abs() < 1e-15);
    // r_a = r + h_a + x m_n: the shift is in normal modules.
    assert!((driving.tip_radius() - (50e-3 / cos + 2e-3 + 0.4e-3)).abs() < 1e-15);
    assert!((driven.tip_radius() - 55.2e-3).abs() < 1e-15);
    let faces = submission.case().faces().expect("along its faces");
    assert_eq!(
        faces
            .pair
            .gear(meshwright_engine::gear::Member::Driving)
            .twist()
            .signum(),
        1.0
    );
}

#[test]
#[ignore = "./test all"]
fn forces_and_run_ups_are_told_along_faces_too() {
    let dynamics = json!({ "driving_speed_rpm": { "from": 0, "to": 30_000, "count": 5 } });
    let document = with(
        filled_in("helical-pair"),
        &[
            ("/output_torques_n_m", json!([100])),
            ("/resolution/positions_per_mesh_period", json!(8)),
            ("/resolution/face_order", json!(4)),
            ("/force_table", json!({ "loads": 6 })),
            ("/dynamics", dynamics),
        ],
    );
    for method in ["three_dimensional", "three_dimensional_projected"] {
        let document = with(document.clone(), &[("/method", json!(method))]);
        let submission = parse(&document).expect("valid");
        assert_eq!(submission.positions_total(), 8 + 16 * 6);
        let pair = &submission.case().pair;
        let results = solved(&submission);
        let table = results.force_table.as_ref().expect("asked for");
        let rows = &table.transmission_error_um;
        assert_eq!((rows.len(), rows[0].len()), (6, 16));
        assert_eq!(table.mesh_stiffness_tangent_n_per_m.len(), 6);
        assert!((0..16).all(|i| rows[5][i] > rows[4][i]));
        let dynamics = results.curves[0].dynamics.as_ref().expect("asked for");
        let up = dynamics.up.as_ref().expect("asked for");
        assert_eq!(up.dynamic_load_factor.len(), 5);
        // The hub turns with its gear.
        let gears = [&results.pair.driving, &results.pair.driven];
        let [j_1, j_2] = gears.map(|gear| gear.polar_inertia_kg_m2);
        let [r_1, r_2] = [pair.driving(), pair.driven()].map(|gear| gear.base_radius());
        let mass = 1.0 / (r_1 * r_1 / j_1 + r_2 * r_2 / j_2);
        let told = dynamics.equivalent_mass_kg;
        assert!((told / mass - 1.0).abs() < 1e-8, "{told} {mass}");
        assert!(submission.forces().is_some());
    }
}

#[test]
#[ignore = "./test all"]
fn the_projection_tells_what_the_whole_solution_does_and_how_far_it_is_off() {
    let pattern = json!({ "count": 6, "circle_radius_mm": 42, "radius_mm": 6 });
    let document = with(
        filled_in("helical-pair"),
        &[
            ("/method", json!("three_dimensional_projected")),
            ("/pair/driven/blank/holes", pattern),
            ("/output_torques_n_m", json!([100])),
            ("/resolution/positions_per_mesh_period", json!(8)),
            ("/resolution/span_mesh_periods", json!(10)),
            ("/resolution/face_order", json!(4)),
            ("/face_load", json!("positions")),
        ],
    );
    let whole = with(document.clone(), &[("/method", json!("three_dimensional"))]);
    let [projected, whole] =
        [document, whole].map(|document| solved(&parse(&document).expect("valid")));
    let names = |results: &Results, place: &str| -> Vec<String> {
        let value = serde_json::to_value(results).expect("JSON");
        let object = value.pointer(place).and_then(Value::as_object);
        object.expect("an object").keys().cloned().collect()
    };
    for place in ["", "/pair", "/curves/0", "/curves/0/face"] {
        assert_eq!(names(&projected, place), names(&whole, place), "{place}");
    }
    for results in [&projected, &whole] {
        let (curve, face) = (&results.curves[0], face_of(results, 0));
        assert_eq!(curve.transmission_error_um.len(), 80);
        assert_eq!(
            (face.load_n_per_mm.len(), face.load_centroid_mm.len()),
            (80, 80)
        );
    }
    assert_eq!(projected.method, "three_dimensional_projected");
    let error = projected.evidence.projection_error_um;
    assert!(error.expect("it is told") < 0.1, "{error:?}");
    let unseen = projected.evidence.does_not_see.join("; ");
    assert!(unseen.contains("beyond first order"), "{unseen}");
}

#[test]
fn results_tell_the_load_along_the_face() {
    let document = with(
        filled_in("helical-pair"),
        &[
            ("/output_torques_n_m", json!([100, 0])),
            ("/resolution/positions_per_mesh_period", json!(8)),
            ("/resolution/face_order", json!(4)),
            ("/face_load", json!("positions")),
        ],
    );
    let results = solved(&parse(&document).expect("valid"));
    let (curve, face) = (&results.curves[0], face_of(&results, 0));
    assert_eq!((face.load_n_per_mm.len(), face.z_mm.len()), (8, 40));
    let strip = 20.0 / 40.0;
    for row in &face.load_n_per_mm {
        let load = row.iter().sum::<f64>() * strip;
        assert!((load / curve.load_n - 1.0).abs() < 1e-6);
    }
    let factor = face.face_load_factor;
    assert!(factor > 1.0 && factor < 10.0, "{factor}");
    assert_eq!(face.load_centroid_mm.len(), 8);
    assert_eq!(
        results.curves[1].face, None,
        "no load, no load along the face"
    );
    let pair = &results.pair;
    let near = |told: Option<f64>, expected: f64, within: f64| {
        assert!(
            (told.expect("along faces") - expected).abs() < within,
            "{told:?} {expected}"
        );
    };
    let overlap = pair.overlap_ratio.expect("along faces");
    near(pair.total_contact_ratio, pair.contact_ratio + overlap, 1e-8);
    near(pair.helix_angle_base_deg, 18.7472, 1e-4);
    near(pair.transverse_module_mm, 2.12836, 1e-5);
    near(pair.transverse_pressure_angle_deg, 21.1728, 1e-4);
    let unseen = results.evidence.does_not_see.join("; ");
    assert!(!unseen.contains("the model is plane"), "{unseen}");
}

fn solved(submission: &Submission) -> Results {
    solve(submission, &Library::default(), &Run::unattended()).expect("solves")
}

fn face_of(results: &Results, curve: usize) -> &FaceDocument {
    results.curves[curve].face.as_ref().expect("along faces")
}

/// A pair of `teeth` on either side, of module 1 mm and 40 degrees, so wide.
fn wide(teeth: u32, face_width_mm: f64) -> Value {
    let gear = json!({ "tooth_count": teeth, "module_mm": 1.0, "face_width_mm": face_width_mm,
                       "blank": { "bore_radius_mm": f64::from(teeth) / 6.0 } });
    // The reference distance z m/cos β, and a little.
    let reference = f64::from(teeth) / 40_f64.to_radians().cos();
    json!({
        "method": "three_dimensional",
        "pair": { "center_distance_mm": reference + 0.1, "helix_angle_deg": 40.0, "driving": gear, "driven": gear },
        "output_torques_n_m": [0.01, 50.0],
        "resolution": { "positions_per_mesh_period": 8, "span_mesh_periods": 1, "face_order": 4 },
    })
}

#[test]
#[ignore = "./test all"]
fn faces_over_which_more_than_sixteen_pairs_of_teeth_mesh_are_computed_as_narrower_ones_are() {
    let stiffness = |face_width_mm: f64| {
        let results = solved(&parse(&wide(60, face_width_mm)).expect("valid"));
        let told = &results.curves[1];
        let pairs = told.pairs_in_contact.iter().copied().max();
        let stiffness = told.statistics.mesh_stiffness_tangent_n_per_m.mean;
        (pairs.expect("positions"), stiffness / face_width_mm)
    };
    let [narrow, middle, broad] = [60.0, 80.0, 100.0].map(stiffness);
    assert!(
        narrow.0 < 17 && middle.0 > 17 && broad.0 > 20,
        "{narrow:?} {middle:?} {broad:?}"
    );
    // Both ends of a face are more compliant, whatever its width: the load of a millimeter is proportional to one over the width, within a percent.
    let share = (1.0 / 60.0 - 1.0 / 80.0) / (1.0 / 60.0 - 1.0 / 100.0);
    let between = narrow.1 + share * (broad.1 - narrow.1);
    assert!(
        (middle.1 / between - 1.0).abs() < 0.01,
        "{narrow:?} {middle:?} {broad:?}"
    );
}

#[test]
fn a_face_that_winds_around_its_gear_is_refused_before_it_is_computed_with_the_width_that_would_do()
{
    let of_face = fault(
        &wide(20, 100.0),
        "/pair/driving/face_width_mm",
        Code::OutOfRange,
    );
    let nearest = of_face.nearest.expect("a width");
    assert!(of_face.detail.contains("20 teeth"), "{}", of_face.detail);
    assert!(parse(&wide(20, nearest)).is_ok());
    assert!(parse(&wide(20, nearest + 0.1)).is_err());
}

/// A helical pair of few teeth and slices, with no web in the way of a mirror.
fn pattern_pair(changes: &[(&str, Value)]) -> Submission {
    let gear = |teeth: u32| {
        json!({ "tooth_count": teeth, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 10.0 },
                "tip_rounding_mm": 0.2 })
    };
    let document = json!({
        "method": "three_dimensional",
        "pair": { "center_distance_mm": 58.8, "helix_angle_deg": 20.0, "driving": gear(25), "driven": gear(30) },
        "output_torques_n_m": [100.0],
        "resolution": { "positions_per_mesh_period": 8, "face_order": 4, "face_slices": 20 },
    });
    parse(&with(document, changes)).expect("valid")
}

fn pattern(submission: &Submission) -> ContactPatternDocument {
    let torques = &submission.case().output_torques;
    let found = contact_pattern(submission, torques, &Library::default(), &Run::unattended());
    ContactPatternDocument::of(&found.expect("a pattern"))
}

/// The flanks of both gears with their pressures, NaN where there is no limit.
fn flanks<'a>(
    pattern: &'a ContactPatternDocument,
    curve: &PatternCurveDocument,
) -> [(&'a PatternFlank, Vec<Vec<f64>>); 2] {
    let map = |pressure: &PatternPressure| {
        let rows = pressure.pressure_mpa.iter();
        rows.map(|row| unlimited(&row.0)).collect()
    };
    [
        (&pattern.driving, map(&curve.driving)),
        (&pattern.driven, map(&curve.driven)),
    ]
}

fn unlimited(pressures: &[Option<f64>]) -> Vec<f64> {
    pressures
        .iter()
        .map(|each| each.unwrap_or(f64::NAN))
        .collect()
}

#[test]
fn a_contact_pattern_tells_every_line_and_the_largest_pressure_of_all() {
    let torques = json!([100, 30]);
    let submission = pattern_pair(&[("/output_torques_n_m", torques)]);
    let pattern = pattern(&submission);
    let z = &pattern.z_mm;
    assert!((z[0] + 9.75).abs() < 1e-9 && z.len() == 40);
    let results = solved(&submission);
    assert_eq!(pattern.curves.len(), 2);
    for (curve, solved) in pattern.curves.iter().zip(&results.curves) {
        assert_eq!(curve.output_torque_n_m, solved.output_torque_n_m);
        assert_eq!(curve.positions.len(), 8);
        let peaks = unlimited(&solved.peak_contact_pressure_mpa);
        let load = solved.load_n;
        let mut largest: f64 = 0.0;
        for (i, position) in curve.positions.iter().enumerate() {
            assert!((position.mesh_position - solved.mesh_position[i]).abs() < 1e-9);
            let (mut carried, mut peak) = (0.0, 0.0_f64);
            for line in &position.lines {
                let (z, loads) = (&line.z_mm, &line.load_n_per_mm);
                for (flank, diameters, teeth) in [
                    (&pattern.driving, &line.driving_diameter_mm, 25.0),
                    (&pattern.driven, &line.driven_diameter_mm, 30.0),
                ] {
                    assert_eq!(diameters.len(), z.len());
                    let ends = flank.form_diameter_mm..=flank.tip_diameter_mm + 1e-9;
                    assert!(diameters.iter().all(|d| ends.contains(d)));
                    assert!(flank.tip_diameter_mm > 2.0 * teeth);
                }
                let each = loads.iter().zip(&line.length_mm);
                carried += each.map(|(load, length)| load * length).sum::<f64>();
                peak = line
                    .pressure_mpa
                    .iter()
                    .flatten()
                    .copied()
                    .fold(peak, f64::max);
            }
            assert!((carried / load - 1.0).abs() < 0.02, "{carried} {load}");
            assert!((peak / peaks[i] - 1.0).abs() < 1e-4, "{peak} {}", peaks[i]);
            largest = largest.max(peak);
        }
        let told = curve.largest_pressure_mpa;
        assert!((told / largest - 1.0).abs() < 1e-4, "{told} {largest}");
        for (_, map) in flanks(&pattern, curve) {
            assert_eq!((map.len(), map[0].len()), (32, 40));
            let touched = map.iter().flatten().filter(|p| **p > 0.0).count();
            // A light load does not reach all of the flank, which begins where no mate comes.
            assert!(touched > 32 * 40 / 2, "{touched}");
            for strip in 0..40 {
                let column: Vec<bool> = map.iter().map(|row| row[strip] > 0.0).collect();
                let edges = column.windows(2).filter(|pair| pair[0] != pair[1]).count();
                assert!(edges <= 2, "strip {strip}: positions leave no stripes");
            }
        }
    }
}

#[test]
fn the_pattern_of_the_other_hand_under_the_other_lead_is_the_mirror_image() {
    for (helix, slope) in [(20.0, 12.0), (20.0, -12.0), (12.0, 6.0)] {
        let distance = 55.0 / f64::to_radians(helix).cos() + 0.3;
        let of = |hand: f64| {
            let ends = [0.0, slope].map(|end| if hand > 0.0 { end } else { slope - end });
            let lead = json!([{ "kind": "table", "z_mm": [-10, 10], "removed_um": ends }]);
            pattern_pair(&[
                ("/pair/helix_angle_deg", json!(hand * helix)),
                ("/pair/center_distance_mm", json!(distance)),
                ("/pair/driven/lead_modifications", lead),
            ])
        };
        let [one, other] = [1.0, -1.0].map(|hand| pattern(&of(hand)));
        let [one, other] = [&one, &other].map(|pattern| flanks(pattern, &pattern.curves[0]));
        for ((_, one), (_, other)) in one.into_iter().zip(other) {
            let most = one.iter().flatten().copied().fold(0.0, f64::max);
            let mut halves = [0.0; 2];
            for (row, mirrored) in one.iter().zip(&other) {
                for (strip, pressure) in row.iter().enumerate() {
                    let apart = (pressure - mirrored[39 - strip]).abs();
                    assert!(apart < 1e-3 * most, "{pressure} {apart}");
                    halves[strip / 20] += pressure;
                }
            }
            // Material removed at the +z end moves the load to the other.
            assert!((halves[0] - halves[1]) * slope > 0.0, "{halves:?} {slope}");
        }
    }
}

#[test]
fn the_pattern_of_a_misaligned_pair_stands_where_its_face_is_closed() {
    for (slope, closed) in [(12.0, 0), (-12.0, 1)] {
        let askew = json!({ "out_of_plane_um": slope });
        let pattern = pattern(&pattern_pair(&[("/pair/misalignment_um", askew)]));
        for (_, map) in flanks(&pattern, &pattern.curves[0]) {
            let mut halves = [0.0; 2];
            for row in map {
                for (strip, pressure) in row.into_iter().enumerate() {
                    halves[strip / 20] += pressure;
                }
            }
            assert!(
                halves[closed] > 1.1 * halves[1 - closed],
                "{slope}: {halves:?}"
            );
        }
    }
}

#[test]
fn a_pattern_over_several_periods_tells_a_bounded_number_of_positions_and_the_largest_of_all() {
    let slopes: Vec<f64> = (0..30)
        .map(|tooth| if tooth == 7 { 9.0 } else { 0.0 })
        .collect();
    let of = |span: u32| {
        pattern_pair(&[
            (
                "/pair/driven/tooth_deviations",
                json!({ "lead_slope_um": slopes }),
            ),
            ("/resolution/span_mesh_periods", json!(span)),
            ("/resolution/positions_per_mesh_period", json!(8)),
        ])
    };
    let [short, long] = [1, 30].map(|span| pattern(&of(span)));
    let positions = |pattern: &ContactPatternDocument| pattern.curves[0].positions.len();
    assert_eq!((positions(&short), positions(&long)), (8, 120));
    let sum = |pattern: &ContactPatternDocument, half: usize| -> f64 {
        let [_, (_, map)] = flanks(pattern, &pattern.curves[0]);
        map.iter()
            .flat_map(|row| &row[20 * half..20 * (half + 1)])
            .sum()
    };
    // Tooth 7 comes into the mesh in the long span alone, and presses at the end that is left to it.
    assert!(sum(&long, 0) > 1.02 * sum(&short, 0));
}

#[test]
#[ignore = "./test all"]
fn pressure_at_a_sharp_edge_is_null_in_the_pattern_and_in_the_curve() {
    let sharp = [
        "/pair/driving/tip_rounding_mm",
        "/pair/driven/tip_rounding_mm",
    ];
    let sharp = sharp.map(|pointer| (pointer, Value::Null)).to_vec();
    for (changes, is_sharp) in [(Vec::new(), false), (sharp, true)] {
        let submission = pattern_pair(&changes);
        let results = solved(&submission);
        let peaks = &results.curves[0].peak_contact_pressure_mpa;
        assert_eq!(peaks.contains(&None), is_sharp, "{peaks:?}");
        let pattern = pattern(&submission);
        let curve = &pattern.curves[0];
        for (_, map) in flanks(&pattern, curve) {
            let has_none = |band: &usize| map[*band].iter().any(|pressure| pressure.is_nan());
            let bands: Vec<usize> = (0..32).filter(has_none).collect();
            assert_eq!(bands.contains(&31), is_sharp, "at its own tip: {bands:?}");
            let at_root = bands.iter().any(|band| *band < 16);
            assert_eq!(
                at_root, is_sharp,
                "where the edge of its mate digs: {bands:?}"
            );
        }
        assert!(curve.largest_pressure_mpa > 100.0);
    }
}

#[test]
fn a_plane_method_has_no_pattern_and_says_which_has() {
    let submission = parse(&least()).expect("valid");
    let problem = contact_pattern(
        &submission,
        &[50.0],
        &Library::default(),
        &Run::unattended(),
    );
    let problem = problem.expect_err("no faces");
    assert_eq!(problem.code, Code::NotFound);
    assert!(
        problem.detail.contains("three_dimensional"),
        "{}",
        problem.detail
    );
}

/// K_Hbeta of each curve, and the lead modification that would lower it.
fn cures(submission: &Submission) -> Vec<(f64, [f64; 3])> {
    let results = solved(submission);
    let faces = (0..results.curves.len()).map(|curve| face_of(&results, curve));
    let told = faces.map(|face| {
        let cure = face.cure.as_ref().expect("a cure");
        let of_cure = [cure.lead_slope_um, cure.crowning_um, cure.face_load_factor];
        (face.face_load_factor, of_cure)
    });
    told.collect()
}

/// A pattern pair with this on its driving leads.
fn with_leads<'a>(changes: &[(&'a str, Value)], leads: Vec<Value>) -> Vec<(&'a str, Value)> {
    let mut changes = changes.to_vec();
    changes.push(("/pair/driving/lead_modifications", json!(leads)));
    changes
}

#[test]
#[ignore = "./test all"]
fn the_lead_that_is_told_lowers_the_face_load_factor_to_what_is_told() {
    let askew = |out_of_plane: f64| {
        (
            "/pair/misalignment_um",
            json!({ "in_plane_um": 3, "out_of_plane_um": out_of_plane }),
        )
    };
    let web = json!({ "bore_radius_mm": 8, "web": { "inner_radius_mm": 12, "outer_radius_mm": 25, "thickness_mm": 5, "offset_mm": -7 } });
    let torque = |torques: Value| ("/output_torques_n_m", torques);
    let hand = ("/pair/helix_angle_deg", json!(-20));
    let holes = json!({ "count": 5, "circle_radius_mm": 17, "radius_mm": 3 });
    let crowned = vec![json!({ "kind": "crowning", "amount_um": 12 })];
    let several = vec![
        torque(json!([60])),
        askew(10.0),
        ("/pair/driven/blank/holes", holes),
        ("/resolution/positions_per_mesh_period", json!(8)),
    ];
    let cases: Vec<(Changes<'_>, Vec<Value>)> = vec![
        (vec![torque(json!([100, 25])), askew(12.0)], Vec::new()),
        (vec![askew(-12.0), hand.clone()], Vec::new()),
        (vec![askew(25.0)], crowned.clone()),
        (vec![("/pair/driven/blank", web), hand], Vec::new()),
        (several, Vec::new()),
        (vec![torque(json!([100]))], crowned),
    ];
    for (changes, leads) in cases {
        let submission = pattern_pair(&with_leads(&changes, leads.clone()));
        let torques = submission.case().output_torques.clone();
        for ((before, [slope, crowning, told]), torque) in
            cures(&submission).into_iter().zip(torques)
        {
            let applied = |slope: f64, crowning: f64| {
                let mut leads = leads.clone();
                leads.push(json!({ "kind": "slope", "amount_um": slope }));
                leads.push(json!({ "kind": "crowning", "amount_um": crowning }));
                let mut changes = with_leads(&changes, leads);
                changes.push(("/output_torques_n_m", json!([torque])));
                cures(&pattern_pair(&changes))[0]
            };
            let (after, [_, _, further]) = applied(slope, crowning);
            println!("{torque}: {before} {after} {told} by {slope} {crowning}, then {further}");
            assert!((after / told - 1.0).abs() < 0.02, "{after}, told {told}");
            assert!(told < 1.12 && after < before, "{before} {after}");
            assert!(further > 0.98 * after, "nothing is left to gain: {further}");
            for (more, crowned) in [(3.0, 0.0), (-3.0, 0.0)] {
                let (beside, _) = applied(slope + more, crowning + crowned);
                assert!(beside > 0.99 * after, "{more} {crowned}: {beside} {after}");
            }
        }
    }
}

#[test]
#[ignore = "./test all"]
fn a_lead_slope_cures_the_misalignment_of_the_same_gap() {
    // out_of_plane_um opens by cos(alpha_wt) of it along the line of action, over the same face.
    for amount in [15.0, -15.0] {
        let askew = json!({ "out_of_plane_um": amount });
        let submission = pattern_pair(&[("/pair/misalignment_um", askew)]);
        let [straight, skew] = [pattern_pair(&[]), submission].map(|pair| {
            let alpha = pair.case().pair.working_pressure_angle();
            (cures(&pair)[0], alpha)
        });
        let ((_, [own, _, least]), _) = straight;
        let ((_, [slope, _, told]), alpha) = skew;
        assert!(
            (slope - own + amount * alpha.cos()).abs() < 0.5,
            "{slope} {own}"
        );
        assert!((told / least - 1.0).abs() < 0.01, "{told} {least}");
    }
}
