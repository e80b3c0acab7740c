//! The methods against each other and against what the paper says of them.

mod cases;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Barrier};

use cases::{
    along_faces, case, faces_of, gear, helical, holed, model_by, pair, relieved, study_design,
    test_case,
};
use meshwright_engine::analysis::{
    Analysis, AnalysisError, Case, ContactSolver, Curve, Method, Warning, analyze, pair_model,
};
use meshwright_engine::assembly::{Blanks, FaceResolution, MakeAll, Modeling, PairSpec};
use meshwright_engine::contact::positions::{contacts, contacts_keeping};
use meshwright_engine::contact::{ContactError, FlankLoad, MeshContact, PositionError, WarmStart};
use meshwright_engine::gear::{
    Alignment, GearData, GearPair, Material, Member, Rack, SolidPair, SpurGear, TipEdge, Web,
};
use meshwright_engine::library::Library;
use meshwright_engine::run::{Run, Stopped};
use meshwright_engine::substructures::Imposed;

fn solve(case: &Case, method: Method) -> Analysis {
    let case = Case {
        model: model_by(method, &case.model),
        ..case.clone()
    };
    analyze(&case, &Library::default(), &Run::unattended())
        .expect("the paper's cases have solutions")
}

fn curve(case: &Case, method: Method) -> Curve {
    solve(case, method).curves.remove(0)
}

/// Relative differences of mean, rms and peak-to-peak of δ, and of the mean of k.
fn differences(curve: &Curve, reference: &Curve) -> [f64; 4] {
    let ratio = |a: f64, b: f64| (a / b - 1.0).abs();
    let (a, b) = (
        curve.transmission_error_statistics,
        reference.transmission_error_statistics,
    );
    let k = |curve: &Curve| curve.mesh_stiffness_tangent_statistics.mean;
    [
        ratio(a.mean, b.mean),
        ratio(a.rms, b.rms),
        ratio(a.peak_to_peak, b.peak_to_peak),
        ratio(k(curve), k(reference)),
    ]
}

fn amplitude(curve: &Curve, label: &str) -> f64 {
    let spectrum = curve
        .spectrum
        .as_ref()
        .expect("whole periods have a spectrum");
    spectrum
        .line(label)
        .unwrap_or_else(|| panic!("{label} has a line"))
        .transmission_error
}

#[test]
#[ignore = "./test all"]
fn decomposition_and_projection_follow_the_flexible_method_on_the_three_test_cases() {
    // The paper's own decomposition is up to 0.5 % off in the mean, 12 % in rms, 8.4 % in p-p and 5 % in mean stiffness.
    for (number, case) in [(1, test_case(1)), (2, test_case(2)), (3, test_case(3))] {
        let flexible = curve(&case, Method::Flexible);
        let decomposed = differences(&curve(&case, Method::Decomposition), &flexible);
        for (difference, bound) in decomposed.into_iter().zip([0.015, 0.16, 0.16, 0.05]) {
            assert!(
                difference < bound,
                "decomposition, case {number}: {decomposed:?}"
            );
        }
        let projected_curve = curve(&case, Method::ProjectedDecomposition);
        let projected = differences(&projected_curve, &flexible);
        for (difference, bound) in projected.into_iter().zip([0.003, 0.02, 0.02, 0.003]) {
            assert!(
                difference < bound,
                "projected, case {number}: {projected:?}"
            );
        }
        let pairs = projected_curve
            .transmission_error
            .iter()
            .zip(&flexible.transmission_error);
        let farthest = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // What a term of the first order leaves where holes move the load from one pair to the next.
        assert!(farthest < 0.12e-6, "projected, case {number}: {farthest} m");
    }
}

#[test]
fn an_edge_that_is_hardly_broken_changes_hardly_anything() {
    // Below a fiftieth of a module, here 40 µm, a broken edge is sharp to the grid, though not to the contact.
    let delta = |edge: TipEdge| {
        let mut data = relieved(gear(50, 15e-3));
        data.tip_edge = edge;
        let mut case = case(pair(data.clone(), data, 100.5e-3), &[115.0]);
        case.resolution.positions_per_mesh_period = 8;
        curve(&case, Method::Flexible).transmission_error
    };
    let sharp = delta(TipEdge::Sharp);
    assert_eq!(delta(TipEdge::Rounded(0.0)), sharp);
    for broken in [TipEdge::Rounded, TipEdge::Chamfered] {
        let [hardly, below, above] = [1e-6, 39e-6, 41e-6].map(|amount| delta(broken(amount)));
        for (one, other) in [(&hardly, &sharp), (&above, &below)] {
            for (one, other) in one.iter().zip(other) {
                let off = one / other - 1.0;
                assert!(off.abs() < 5e-4, "{off}");
            }
        }
    }
}

#[test]
fn the_augmented_lagrangian_obeys_a_stop_within_a_position() {
    let mut case = test_case(2);
    case.resolution.contact_solver = ContactSolver::AugmentedLagrangian {
        penalty: None,
        gap_tolerance: 1e-12,
    };
    let stop = Arc::new(AtomicBool::new(false));
    let run = Run::new(stop.clone(), |_, _| ());
    let model = pair_model(&case, &MakeAll, &run).expect("a model");
    stop.store(true, Ordering::Relaxed);
    let refused = model
        .as_drawn()
        .contact(0.1, 2000.0, &mut WarmStart::default());
    assert_eq!(
        refused,
        Err(PositionError::Contact(ContactError::Stopped(Stopped)))
    );
}

/// δ_whole − δ_wh at the samples of the holed blank of `member`, and how far its hub turns, R_b θ_gb, under what is imposed of the
/// displacement of its circle.
fn blank_rotations(case: &Case, member: Member, imposed: Imposed) -> Vec<[f64; 2]> {
    let (library, run) = (Library::default(), Run::unattended());
    let modeling = Modeling {
        level: case.resolution.grid,
        interface_radii: case.resolution.interface_radii,
        farthest: 4,
        solver: case.resolution.contact_solver,
    };
    let gear = case.pair.gear(member);
    let load = case.pair.load(case.output_torques[0]);
    let period = f64::from(gear.tooth_count()) / f64::from(gear.hole_repeats());
    let positions: Vec<f64> = (0..16).map(|j| f64::from(j) * period / 16.0).collect();
    let spec = |blanks| PairSpec::new(&case.pair, blanks, &modeling);
    let rigid = spec(Blanks::HoledRigid).model(&library, &run);
    let rigid =
        contacts(rigid.expect("a model").0.as_drawn(), load, &positions, &run).expect("solutions");
    let spec = spec(Blanks::OnlyHoledOf(member));
    let (model, _) = spec.model(&library, &run).expect("a model");
    let cut = spec.cut(member, &library, &run).expect("a gear");
    let motion = cut.motion(&run).expect("definite").expect("flexible");
    let annulus = cut.annulus(imposed).expect("definite").expect("flexible");
    let whole = contacts_keeping(
        model.as_drawn(),
        load,
        &positions,
        &run,
        |cells, solution| cells.flank_loads(member, &solution.forces),
    );
    let whole = whole.expect("solutions");
    let rotation = |((whole, loads), rigid): (&(MeshContact, Vec<FlankLoad>), &MeshContact)| {
        let beyond = whole.transmission_error - rigid.transmission_error;
        let mut circle = motion.under(&cut.modal_loads(loads));
        annulus.turn(&mut circle, beyond / gear.base_radius());
        let turned = annulus.hub_rotation(&circle, -cut.moment(loads));
        [beyond, gear.base_radius() * turned]
    };
    whole.iter().zip(&rigid).map(rotation).collect()
}

/// A, B cos(phase) and −B sin(phase) of eq. 13 through `values`, which are evenly spaced over a hole period.
fn fitted(values: &[f64]) -> [f64; 3] {
    let count = values.len() as f64;
    let part = |wave: fn(f64) -> f64| -> f64 {
        let angle = |j: usize| std::f64::consts::TAU * j as f64 / count;
        let terms = values.iter().enumerate();
        terms
            .map(|(j, value)| 2.0 / count * value * wave(angle(j)))
            .sum()
    };
    [part(|_| 0.5), part(f64::cos), part(f64::sin)]
}

#[test]
fn the_annulus_turns_as_its_gear_does_where_all_of_its_circle_is_moved_and_otherwise_where_it_is_radially_free()
 {
    // How much more the mean, and how much less rms and peak-to-peak are than by the flexible method, in percent, with the radial
    // direction free: docs/differences.md.
    for (number, free_is_off) in [
        (1, [2.7, 42.8, 32.5]),
        (2, [0.6, 24.0, 22.2]),
        (3, [0.5, 16.4, 12.9]),
    ] {
        let case = test_case(number);
        let flexible = curve(&case, Method::Flexible);
        let parts = curve(&case, Method::Decomposition).decomposition;
        let parts = parts.expect("the parts of the decomposition");
        let mut delta = parts.rigid_blank_transmission_error.clone();
        for fit in &parts.blanks {
            let whole = blank_rotations(&case, fit.member, Imposed::Whole);
            for (sample, [beyond, turned]) in fit.samples.iter().zip(whole) {
                assert_eq!(sample.rotation, turned, "what ships");
                assert!(
                    (turned - beyond).abs() < 1e-9 * fit.mean,
                    "case {number}, {}: {turned} of {beyond}",
                    fit.member
                );
            }
            let free = blank_rotations(&case, fit.member, Imposed::Tangential);
            let free: Vec<f64> = free.iter().map(|[_, turned]| *turned).collect();
            let [mean, cosine, sine] = fitted(&free);
            println!(
                "case {number}, {}: A {:+.4}, B {:+.4} with the radial direction free",
                fit.member,
                mean / fit.mean - 1.0,
                cosine.hypot(sine) / fit.amplitude - 1.0
            );
            let gear = case.pair.gear(fit.member);
            let n = f64::from(gear.hole_repeats()) * gear.pitch_angle();
            for (delta, eta) in delta.iter_mut().zip(&flexible.mesh_position) {
                *delta += mean + cosine * (n * eta).cos() + sine * (n * eta).sin();
            }
        }
        let of = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let square = values
                .iter()
                .map(|value| (value - mean).powi(2))
                .sum::<f64>();
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            [mean, (square / values.len() as f64).sqrt(), high - low]
        };
        let (free, exact) = (of(&delta), of(&flexible.transmission_error));
        let off = [0, 1, 2].map(|i| 100.0 * (free[i] / exact[i] - 1.0).abs());
        println!("case {number}: {off:?} percent");
        for (off, expected) in off.into_iter().zip(free_is_off) {
            assert!((off - expected).abs() < 0.3, "case {number}");
        }
    }
}

#[test]
fn without_holes_decomposition_and_projection_are_the_flexible_method() {
    let case = study_design(None, &[115.0]);
    let flexible = curve(&case, Method::Flexible);
    for method in [Method::Decomposition, Method::ProjectedDecomposition] {
        assert_eq!(
            curve(&case, method).transmission_error,
            flexible.transmission_error
        );
    }
}

#[test]
fn sidebands_appear_where_the_paper_says() {
    // Over a revolution of gear 2: lines of case 2 stand on multiples of 10 only; the fitted decomposition has H_50 ± 10 in
    // k, by its torque step, and not in δ.
    let mut case = test_case(2);
    case.resolution.span_mesh_periods = Some(50);
    for method in [
        Method::Flexible,
        Method::ProjectedDecomposition,
        Method::Decomposition,
    ] {
        let curve = curve(&case, method);
        let mean = curve.transmission_error_statistics.mean;
        let spectrum = curve.spectrum.as_ref().expect("a whole revolution");
        assert_eq!(spectrum.order[0], 1.0);
        for (order, line) in spectrum.order.iter().zip(&spectrum.transmission_error) {
            assert!(
                order % 10.0 == 0.0 || line / mean < 1e-9,
                "{method:?}: order {order} has {line}"
            );
        }
        for label in ["H_Z2-N", "H_Z2+N"] {
            let named = spectrum.line(label).expect("a sideband");
            if method == Method::Decomposition {
                // Between positions the curve follows its events, which is no sum: a hundred-thousandth of the mean is left.
                assert!(
                    named.transmission_error / mean < 1e-5,
                    "δ is a sum of a mesh part and a hole part: {label} {:e}",
                    named.transmission_error / mean
                );
                assert!(
                    named.mesh_stiffness_tangent / curve.mesh_stiffness_tangent_statistics.mean
                        > 1e-4
                );
            } else {
                assert!(
                    named.transmission_error > 5e-9,
                    "{method:?}: {label} {}",
                    named.transmission_error
                );
            }
        }
    }
}

#[test]
fn two_equal_hole_patterns_make_one_family_of_lines() {
    let curve = curve(&test_case(1), Method::Flexible);
    let spectrum = curve.spectrum.expect("whole periods");
    assert_eq!(spectrum.line("H_N").map(|line| line.order), Some(8.0));
    assert!(spectrum.line("H_N1").is_none() && spectrum.line("H_N2").is_none());
    // gcd(50, 8) = 2: the lines of both gears together stand on multiples of 2.
    let mean = curve.transmission_error_statistics.mean;
    let off = spectrum
        .order
        .iter()
        .zip(&spectrum.transmission_error)
        .filter(|(order, _)| *order % 2.0 > 1e-9);
    assert!(off.map(|(_, line)| line / mean).fold(0.0, f64::max) < 1e-9);
}

#[test]
#[ignore = "./test all"]
fn the_claims_of_section_5_hold_on_the_computed_study() {
    let design = |holes| solve(&study_design(holes, &[20.0, 115.0]), Method::Flexible).curves;
    let standard = design(None);
    let (r34_8, r30_8, r27_8) = (
        design(Some((8, 34e-3, 8.385e-3))),
        design(Some((8, 30e-3, 8.385e-3))),
        design(Some((8, 27e-3, 8.385e-3))),
    );
    let (r34_10, r30_6) = (
        design(Some((10, 34e-3, 7.5e-3))),
        design(Some((6, 30e-3, 9.683e-3))),
    );
    let (low, high) = (0, 1);
    for torque in [low, high] {
        // H_N grows with the radius of the holes; more holes on the same circle lower the fluctuation of δ.
        assert!(amplitude(&r27_8[torque], "H_N") < amplitude(&r30_8[torque], "H_N"));
        assert!(amplitude(&r30_8[torque], "H_N") < amplitude(&r34_8[torque], "H_N"));
        for design in [&r34_8, &r30_8, &r27_8, &r34_10, &r30_6] {
            let k = |curves: &[Curve]| curves[torque].mesh_stiffness_tangent_statistics;
            assert!(
                k(design).mean < k(&standard).mean,
                "holes lower the mean stiffness"
            );
            assert!(
                (k(design).peak_to_peak / k(&standard).peak_to_peak - 1.0).abs() > 0.01,
                "and change its fluctuation"
            );
        }
    }
    for design in [&r34_8, &r30_8, &r27_8, &r34_10, &r30_6] {
        assert!(
            amplitude(&design[low], "H_N") < amplitude(&design[high], "H_N"),
            "H_N grows with the torque"
        );
    }
    let rms = |curve: &Curve| curve.transmission_error_statistics.rms;
    assert!(rms(&r34_10[high]) < rms(&r34_8[high]) && rms(&r30_8[high]) < rms(&r30_6[high]));
    let peak_to_peak = |curve: &Curve| curve.transmission_error_statistics.peak_to_peak;
    assert!(
        peak_to_peak(&standard[low]) > peak_to_peak(&standard[high]),
        "the relief suits 115 N m, not 20"
    );
}

#[test]
fn the_load_distribution_sees_no_holes_and_says_so() {
    let (holed, solid) = (
        study_design(Some((8, 34e-3, 8.385e-3)), &[115.0]),
        study_design(None, &[115.0]),
    );
    let holed = solve(&holed, Method::LoadDistribution);
    let mut solid = solve(&solid, Method::LoadDistribution);
    assert!(holed.warnings.contains(&Warning::HolesNotSeen));
    assert_eq!(
        holed.curves[0].transmission_error[..40],
        solid.curves[0].transmission_error[..]
    );
    // One body for each pair: p-p far above the 0.93 µm of the finite elements.
    let curve = solid.curves.remove(0);
    assert!(curve.transmission_error_statistics.peak_to_peak > 2e-6);
    let worst = curve.load_shares.iter().fold(vec![0.0; 40], |sum, share| {
        sum.iter().zip(&share.share).map(|(a, b)| a + b).collect()
    });
    assert!(
        worst.iter().all(|sum: &f64| (sum - 1.0).abs() < 1e-12),
        "the shares of all pairs are the load"
    );
}

/// Large holes in a polymer gear that drives a steel one: what one gear gives way around its holes is far from small beside the other.
fn large_holes_in_a_soft_gear() -> Case {
    let rack = Rack {
        module: 3e-3,
        pressure_angle: 22.5_f64.to_radians(),
        addendum: 3.57e-3,
        dedendum: 4.32e-3,
        tip_radius: 0.6e-3,
        protuberance: None,
    };
    let polymer = Material {
        youngs_modulus: 3e9,
        poisson_ratio: 0.38,
        density: 1400.0,
        yield_strength: None,
    };
    let soft = GearData {
        rack,
        profile_shift: 0.7,
        face_width: 58e-3,
        material: polymer,
        ..gear(45, 19.6e-3)
    };
    let stiff = GearData {
        rack,
        face_width: 37e-3,
        ..gear(45, 9.5e-3)
    };
    let driving = SpurGear::new(holed(soft, 5, 42.2e-3, 18.3e-3, 0.3)).expect("a gear");
    let driven = SpurGear::new(holed(stiff, 10, 48.9e-3, 7.8e-3, 1.2)).expect("a gear");
    let mut case = case(
        GearPair::new(driving, driven, 137.4e-3).expect("meshes"),
        &[0.5, 5.0],
    );
    case.resolution.positions_per_mesh_period = 20;
    case
}

#[test]
fn the_projection_says_how_far_off_it_is() {
    let case = large_holes_in_a_soft_gear();
    let (exact, projected) = (
        solve(&case, Method::Flexible),
        solve(&case, Method::ProjectedDecomposition),
    );
    let furthest = |i: usize| {
        let curves = [&exact, &projected].map(|analysis| &analysis.curves[i].transmission_error);
        let differences = curves[0].iter().zip(curves[1]);
        differences.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let furthest = furthest(0).max(furthest(1));
    let told = projected.evidence.projection_error.expect("it projects");
    println!("told {told:.2e} of {furthest:.2e} m");
    // It looks at some of the positions, and finds most of what there is and never more (the contact solver starts elsewhere there:
    // rounding).
    assert!(told > 0.5 * furthest && told < 1.0001 * furthest);
    let doubtful = |analysis: &Analysis| {
        let warnings = analysis.warnings.iter();
        warnings
            .filter(|warning| matches!(warning, Warning::ProjectionDoubtful { .. }))
            .count()
    };
    assert_eq!((doubtful(&projected), doubtful(&exact)), (1, 0));
    assert_eq!(exact.evidence.projection_error, None);
    for number in [1, 2, 3] {
        let of_paper = solve(&test_case(number), Method::ProjectedDecomposition);
        assert_eq!(doubtful(&of_paper), 0, "case {number}");
    }
}

#[test]
fn the_decomposition_says_how_far_off_it_is() {
    // Holes whose rim is as high as a tooth, and small ones far from the teeth: there the rigid blank shares the load otherwise than a solid one.
    for holes in [(10, 40e-3, 5e-3), (10, 26e-3, 2e-3)] {
        let mut case = study_design(Some(holes), &[115.0]);
        case.resolution.positions_per_mesh_period = 20;
        let exact = curve(&case, Method::Flexible);
        let decomposed = solve(&case, Method::Decomposition);
        let found = &decomposed.curves[0];
        let pairs = exact
            .transmission_error
            .iter()
            .zip(&found.transmission_error);
        let furthest = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let told = decomposed
            .evidence
            .decomposition_error
            .expect("it is fitted");
        let part = told / found.transmission_error_statistics.peak_to_peak;
        println!("told {told:.2e} of {furthest:.2e} m, {part:.3} of the peak-to-peak");
        // It is met at 16 places of a hole pitch, at other fractions of the mesh period than the curve.
        assert!(told > 0.6 * furthest && told < 1.5 * furthest);
        let mut warnings = decomposed.warnings.iter();
        let is_doubtful =
            warnings.any(|warning| matches!(warning, Warning::DecompositionDoubtful { .. }));
        assert_eq!(is_doubtful, part > 0.05);
    }
}

#[test]
fn a_library_provides_what_is_made_without_one() {
    for case in designs_by_methods() {
        let made = analyze(&case, &MakeAll, &Run::unattended()).expect("a design of the study");
        assert!(
            made == solve_from(&Library::default(), &case),
            "{:?}",
            case.method()
        );
    }
}

#[test]
fn what_designs_share_changes_no_digit() {
    // The second design finds teeth and rigid-blank contacts of the first in the library.
    let library = Library::default();
    let run = Run::unattended();
    let [first, second] =
        [(8, 34e-3, 8.385e-3), (10, 30e-3, 7e-3)].map(|holes| study_design(Some(holes), &[115.0]));
    for method in [
        Method::Decomposition,
        Method::ProjectedDecomposition,
        Method::Flexible,
    ] {
        let with = |case: &Case| Case {
            model: model_by(method, &case.model),
            ..case.clone()
        };
        analyze(&with(&first), &library, &run).expect("a design of the study");
        let shared = analyze(&with(&second), &library, &run).expect("a design of the study");
        assert_eq!(shared, solve(&second, method), "{method:?}");
    }
}

/// Two designs on the same teeth, by a method that takes from every shelf and by the reference.
fn designs_by_methods() -> Vec<Case> {
    let designs = [(8, 34e-3, 8.385e-3), (10, 30e-3, 7e-3)];
    let cases = designs.map(|holes| study_design(Some(holes), &[115.0, 20.0]));
    let methods = [Method::Flexible, Method::Decomposition];
    let with = |case: &Case, method| Case {
        model: model_by(method, &case.model),
        ..case.clone()
    };
    cases
        .iter()
        .flat_map(|case| methods.map(|method| with(case, method)))
        .collect()
}

/// A helical pair with holes in the web of one gear, coarsely resolved.
fn along_its_faces() -> Case {
    let beta = 20_f64.to_radians();
    let gears = [
        helical(gear(40, 20e-3), beta, 0.0),
        helical(holed(gear(40, 20e-3), 4, 29e-3, 4e-3, 0.0), -beta, 0.0),
    ];
    let center_distance = 2.0 * gears[0].section().reference_radius();
    let leads = [Vec::new(), Vec::new()];
    let solid = SolidPair::new(gears, leads, center_distance, Alignment::default());
    let mut case = along_faces(solid.expect("meshes"), COARSE, &[100.0]);
    case.resolution.positions_per_mesh_period = 4;
    case.resolution.span_mesh_periods = Some(1);
    case
}

/// Polynomials and slices that are quick.
const COARSE: (FaceResolution, usize) = (
    FaceResolution {
        face_order: 4,
        ..FaceResolution::DRAFT
    },
    10,
);

/// The same by a few positions of its true period of ten mesh periods, with holes at `radius` that matter, or without any.
fn along_its_faces_in_turn(hole_circle: Option<f64>) -> Case {
    let mut case = along_its_faces();
    let faces = faces_of(&mut case);
    let solid = |beta: f64, holes: Option<f64>| {
        let mut data = gear(40, 20e-3);
        data.blank.web = Some(Web {
            inner_radius: 20e-3,
            outer_radius: 35e-3,
            thickness: 8e-3,
        });
        let data = match holes {
            Some(circle) => holed(data, 4, circle, 5e-3, 0.1),
            None => data,
        };
        helical(data, beta, 2e-3)
    };
    let beta = 20_f64.to_radians();
    let gears = [solid(beta, None), solid(-beta, hole_circle)];
    let center_distance = 2.0 * gears[0].section().reference_radius();
    let leads = [Vec::new(), Vec::new()];
    faces.pair =
        SolidPair::new(gears, leads, center_distance, Alignment::default()).expect("meshes");
    case.pair = faces.pair.section().clone();
    case.resolution.span_mesh_periods = Some(10);
    case
}

#[test]
fn a_case_of_another_pair_than_its_faces_is_refused() {
    let mut case = along_its_faces_in_turn(None);
    case.pair = pair(gear(23, 8e-3), gear(31, 10e-3), 54.4e-3);
    let refused = analyze(&case, &Library::default(), &Run::unattended());
    assert!(matches!(refused, Err(AnalysisError::SectionDiffers)));
}

#[test]
#[ignore = "./test all"]
fn along_faces_the_projection_is_the_whole_solution_without_holes_and_near_it_with_them() {
    for holes in [None, Some(28e-3)] {
        let case = along_its_faces_in_turn(holes);
        let library = Library::default();
        let by = |method| {
            let case = Case {
                model: model_by(method, &case.model),
                ..case.clone()
            };
            solve_from(&library, &case)
        };
        let whole = by(Method::ThreeDimensional);
        let projected = by(Method::ThreeDimensionalProjected);
        let found = differences(&projected.curves[0], &whole.curves[0]);
        let largest = |of: fn(&Curve) -> &Vec<f64>| {
            let [one, other] = [&projected, &whole].map(|by| of(&by.curves[0]));
            let each = one.iter().zip(other);
            each.map(|(one, other)| (one - other).abs())
                .fold(0.0, f64::max)
        };
        let delta = largest(|curve| &curve.transmission_error);
        let stiffness = largest(|curve| &curve.mesh_stiffness_tangent);
        let statistics = &whole.curves[0].transmission_error_statistics;
        let mean = whole.curves[0].mesh_stiffness_tangent_statistics.mean;
        println!("{found:?} {delta:e} {statistics:?} {:e}", stiffness / mean);
        println!("{:?} {:?}", projected.evidence, whole.evidence);
        let error = projected.evidence.projection_error.expect("it is told");
        if holes.is_none() {
            assert!(
                delta < 1e-12 && stiffness < 1e-6 * mean,
                "{delta:e} {stiffness:e}"
            );
            assert_eq!(error, 0.0);
        } else {
            let swing = statistics.peak_to_peak;
            assert!(swing > 0.3e-6, "holes that matter");
            assert!(
                delta < 0.01 * swing && stiffness < 2e-3 * mean,
                "{delta:e} {stiffness:e}"
            );
            // It looks at some of the positions, as the whole solution does.
            assert!(
                error < 1.0001 * delta && error > 0.3 * delta,
                "{error:e} of {delta:e}"
            );
        }
        // One mesh period of four positions instead of ten. The whole solution starts each further one from the balance before it, so that they take few.
        let iterations = |by: &Analysis| by.evidence.contact_iterations;
        assert!(iterations(&projected) < iterations(&whole));
        let face = |by: &Analysis| by.curves[0].face.clone().expect("along the faces");
        let (one, other) = (face(&projected), face(&whole));
        assert_eq!(one.load_centroid.len(), other.load_centroid.len());
        assert_eq!(one.heights, other.heights);
        assert!((one.face_load_factor / other.face_load_factor - 1.0).abs() < 1e-3);
    }
}

#[test]
#[ignore = "./test all"]
fn along_faces_a_moved_hole_costs_one_web() {
    let library = Library::default();
    let uses = |name: &str| {
        let usage = library
            .usage()
            .into_iter()
            .find(|(shelf, _)| *shelf == name);
        usage
            .map(|(_, usage)| (usage.misses, usage.hits))
            .expect("a shelf")
    };
    let solve = |circle: f64| {
        let mut case = along_its_faces_in_turn(Some(circle));
        case.model = model_by(Method::ThreeDimensionalProjected, &case.model);
        solve_from(&library, &case)
    };
    let one = solve(28e-3);
    assert_eq!((uses("faces"), uses("yields")), ((2, 0), (2, 0)));
    // Holes here need as many orders: they stand farther from the edge of the web.
    let other = solve(27.6e-3);
    // Of teeth, rims and plain webs nothing is made anew, of the gear without holes nothing at all.
    assert_eq!((uses("faces"), uses("yields")), ((2, 1), (3, 1)));
    assert_ne!(
        one.curves[0].transmission_error,
        other.curves[0].transmission_error
    );
}

fn solve_from(library: &Library, case: &Case) -> Analysis {
    analyze(case, library, &Run::unattended()).expect("a design of the study")
}

/// A library with room for everything.
const ROOMY: usize = 1 << 30;

/// The size of a library in which the gears of `cases` find half the room that they want, so that they drive each other out.
fn too_little_for(cases: &[Case]) -> usize {
    let library = Library::with_capacity(ROOMY);
    for case in cases {
        solve_from(&library, case);
    }
    let gears = library
        .usage()
        .into_iter()
        .find_map(|(shelf, usage)| (shelf == "gears").then_some(usage))
        .expect("gears have a shelf");
    // Theirs is an eighth of the whole.
    assert_eq!(gears.capacity, ROOMY / 8);
    gears.bytes / 2 * 8
}

#[test]
#[ignore = "./test all"]
fn a_library_changes_no_digit_whether_it_is_cold_warm_too_small_or_absent() {
    let mut cases = designs_by_methods();
    cases.push(Case {
        stress: true,
        ..along_its_faces()
    });
    let cold: Vec<_> = cases
        .iter()
        .map(|case| solve_from(&Library::default(), case))
        .collect();
    for capacity in [0, too_little_for(&cases), ROOMY] {
        let library = Library::with_capacity(capacity);
        // Once cold, once with what the first time left.
        for (case, cold) in cases.iter().zip(&cold).chain(cases.iter().zip(&cold)) {
            assert!(
                solve_from(&library, case) == *cold,
                "{:?} from {capacity} bytes: {:?}",
                case.method(),
                library.usage()
            );
        }
        for (shelf, usage) in library.usage() {
            assert!(usage.bytes <= usage.capacity, "{shelf}: {usage:?}");
            if capacity == 0 {
                assert!(
                    usage.hits == 0 && usage.evictions == usage.misses,
                    "{shelf}: {usage:?}"
                );
            }
            if capacity == ROOMY {
                let computed_once = usage.misses == usage.entries as u64;
                assert!(computed_once && usage.evictions == 0, "{shelf}: {usage:?}");
            }
        }
        let evictions: u64 = library
            .usage()
            .iter()
            .map(|(_, usage)| usage.evictions)
            .sum();
        assert_eq!(evictions > 0, capacity < ROOMY, "{:?}", library.usage());
    }
}

#[test]
#[ignore = "./test all"]
fn jobs_at_once_on_one_library_get_the_results_that_each_gets_alone() {
    let cases = designs_by_methods();
    let alone: Vec<_> = cases
        .iter()
        .map(|case| solve_from(&Library::default(), case))
        .collect();
    // Once with room for everything, so that they find each other's parts; once with so little that they drive them out.
    for capacity in [ROOMY, too_little_for(&cases)] {
        let library = Library::with_capacity(capacity);
        let start = Barrier::new(cases.len());
        // As in the service, each job has threads of its own.
        let solve_together = |case: &Case| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(2)
                .build()
                .expect("a pool");
            start.wait();
            pool.install(|| solve_from(&library, case))
        };
        let together: Vec<_> = std::thread::scope(|scope| {
            let jobs: Vec<_> = cases
                .iter()
                .map(|case| scope.spawn(|| solve_together(case)))
                .collect();
            jobs.into_iter()
                .map(|job| job.join().expect("no job panics"))
                .collect()
        });
        for ((case, together), alone) in cases.iter().zip(&together).zip(&alone) {
            assert!(together == alone, "{:?} in {capacity} bytes", case.method());
        }
    }
}
