//! Stops, threads, and gears that are out of the ordinary but can be made.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use meshwright_engine::analysis::{Analysis, AnalysisError, Case, Curve, Method, analyze};
use meshwright_engine::gear::{GearData, GearPair, SpurGear};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

use crate::support::{case, gear, holed, model_by, paper_case, relieved, solve};

#[test]
fn a_run_that_is_told_to_stop_solves_hardly_a_position_more() {
    let (pair, torque) = paper_case(2);
    for method in [
        Method::Flexible,
        Method::Decomposition,
        Method::ProjectedDecomposition,
    ] {
        let mut case = case(pair.clone(), &[torque]);
        case.model = model_by(method, &case.model);
        let stop = Arc::new(AtomicBool::new(false));
        let seen = Arc::new(AtomicU64::new(0));
        let (flag, count) = (stop.clone(), seen.clone());
        let run = Run::new(stop, move |done, total| {
            assert!(done <= total, "no more than was announced");
            count.fetch_add(1, Ordering::SeqCst);
            if done >= 10 {
                flag.store(true, Ordering::SeqCst);
            }
        });
        let answer = analyze(&case, &Library::default(), &run);
        assert!(
            matches!(answer, Err(AnalysisError::Stopped(_))),
            "{method:?}: {answer:?}"
        );
        // Each thread ends the position that it is at.
        let threads = rayon::current_num_threads() as u64;
        let seen = seen.load(Ordering::SeqCst);
        assert!(seen <= 10 + threads, "{method:?}: {seen} positions");
    }
}

#[test]
fn a_run_that_is_stopped_before_it_begins_computes_nothing() {
    let (pair, torque) = paper_case(3);
    let run = Run::new(Arc::new(AtomicBool::new(true)), |_, _| {
        panic!("nothing was reached")
    });
    let answer = analyze(&case(pair, &[torque]), &Library::default(), &run);
    assert!(matches!(answer, Err(AnalysisError::Stopped(_))));
}

#[test]
fn results_do_not_depend_on_the_number_of_threads_nor_on_the_run() {
    let (pair, torque) = paper_case(2);
    for method in [
        Method::Flexible,
        Method::Decomposition,
        Method::ProjectedDecomposition,
    ] {
        let mut case = case(pair.clone(), &[torque, 20.0]);
        case.model = model_by(method, &case.model);
        let on = |threads: usize| -> Analysis {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| analyze(&case, &Library::default(), &Run::unattended()))
                .expect("an answer")
        };
        let one = on(1);
        assert_eq!(one, on(2), "{method:?}");
        assert_eq!(one, on(1), "{method:?}");
        assert_eq!(one, on(5), "{method:?}");
    }
}

/// Solves `case` at the coarse level over at most two mesh periods, and says what is wrong with the answer, if anything is.
fn trouble(case: &Case) -> Option<String> {
    let mut case = case.clone();
    case.resolution.grid = GridLevel::Coarse;
    case.resolution.positions_per_mesh_period = 10;
    case.resolution.span_mesh_periods = Some(2);
    let start = Instant::now();
    let answer = analyze(&case, &Library::default(), &Run::unattended());
    let seconds = start.elapsed().as_secs_f64();
    let analysis = match answer {
        Ok(analysis) => analysis,
        Err(error) => return Some(format!("{error}")),
    };
    for curve in &analysis.curves {
        println!(
            "   T {}: mean {:.4e} m, k {:.3e} N/m, peak {:.2e} Pa, {seconds:.2} s",
            curve.output_torque,
            curve.transmission_error_statistics.mean,
            curve.mesh_stiffness_tangent_statistics.mean,
            curve
                .peak_contact_pressure
                .iter()
                .flatten()
                .copied()
                .fold(0.0, f64::max),
        );
        let sound = |value: &f64| value.is_finite() && *value > 0.0;
        if !curve.transmission_error.iter().all(sound)
            || !curve.mesh_stiffness_tangent.iter().all(sound)
        {
            return Some(format!(
                "a value is not positive: {:?}",
                curve.transmission_error_statistics
            ));
        }
        for i in 0..curve.mesh_position.len() {
            let carried: f64 = curve.load_shares.iter().map(|share| share.share[i]).sum();
            if (carried - 1.0).abs() > 1e-9 {
                return Some(format!("shares add up to {carried}"));
            }
        }
    }
    None
}

/// The pair of `driving` and `driven` with a backlash, or its refusal.
fn meshed(driving: GearData, driven: GearData, center_distance: f64) -> GearPair {
    let gear = |data: GearData| {
        SpurGear::new(data.clone()).unwrap_or_else(|error| panic!("{error}: {data:?}"))
    };
    GearPair::new(gear(driving), gear(driven), center_distance)
        .unwrap_or_else(|error| panic!("{error}"))
}

#[test]
#[ignore = "./test all"]
fn gears_that_are_odd_but_can_be_made_are_solved() {
    let shifted = |z: u32, shift: f64| GearData {
        profile_shift: shift,
        ..gear(z, 6e-3)
    };
    let wide = |width: f64| GearData {
        face_width: width,
        ..relieved(gear(50, 15e-3))
    };
    let with_holes = |count, circle, radius| holed(gear(50, 10e-3), count, circle, radius, 0.3);
    let standard = |data: GearData| meshed(gear(50, 10e-3), data, 100.5e-3);
    // Ligaments of half a millimeter: between the holes, to the root circle at 47.5 mm, to the bore at 10 mm, all three.
    let thin = [
        ("between holes", with_holes(20, 35e-3, 5.225e-3)),
        ("under the root", with_holes(6, 40e-3, 7e-3)),
        ("around the bore", with_holes(6, 17.5e-3, 7e-3)),
        ("on all sides", with_holes(5, 28.75e-3, 16.6e-3)),
    ];
    let mut cases = vec![
        (
            "Z 18/18".to_owned(),
            meshed(gear(18, 6e-3), gear(18, 6e-3), 36.3e-3),
            vec![10.0],
        ),
        (
            "Z 19/20".to_owned(),
            meshed(gear(19, 6e-3), gear(20, 6e-3), 39.3e-3),
            vec![10.0],
        ),
        (
            "Z 17/17, x 0.05".to_owned(),
            meshed(shifted(17, 0.05), shifted(17, 0.05), 34.5e-3),
            vec![10.0],
        ),
        (
            "Z 20/40, x 0.4/-0.2".to_owned(),
            meshed(shifted(20, 0.4), shifted(40, -0.2), 60.6e-3),
            vec![10.0],
        ),
        (
            "Z 20/30, x 0.6/0.5".to_owned(),
            meshed(shifted(20, 0.6), shifted(30, 0.5), 52.1e-3),
            vec![10.0],
        ),
        (
            "widths 20/12".to_owned(),
            meshed(wide(20e-3), wide(12e-3), 100.5e-3),
            vec![115.0],
        ),
        (
            "widths 10/30".to_owned(),
            meshed(wide(10e-3), wide(30e-3), 100.5e-3),
            vec![115.0],
        ),
        (
            "zero backlash".to_owned(),
            meshed(gear(50, 15e-3), gear(50, 15e-3), 100e-3),
            vec![115.0],
        ),
        (
            // It deflects within the quarter of a module beyond which a result contradicts its own evidence.
            "0.01 N m and 3 kN m".to_owned(),
            meshed(wide(20e-3), wide(20e-3), 100.5e-3),
            vec![0.01, 3e3],
        ),
        (
            "one hole".to_owned(),
            standard(with_holes(1, 28e-3, 12e-3)),
            vec![115.0],
        ),
        (
            "two holes".to_owned(),
            standard(with_holes(2, 28e-3, 12e-3)),
            vec![115.0],
        ),
        (
            "three holes".to_owned(),
            standard(with_holes(3, 28e-3, 12e-3)),
            vec![115.0],
        ),
        (
            "seven holes".to_owned(),
            standard(with_holes(7, 32e-3, 9e-3)),
            vec![115.0],
        ),
        (
            "sixty holes".to_owned(),
            standard(with_holes(60, 38e-3, 1.5e-3)),
            vec![115.0],
        ),
        (
            "one small hole".to_owned(),
            standard(with_holes(1, 28e-3, 0.5e-3)),
            vec![115.0],
        ),
    ];
    for (name, data) in thin {
        cases.push((
            format!("half a millimeter {name}"),
            standard(data),
            vec![115.0],
        ));
    }
    let mut troubles = Vec::new();
    for (name, pair, torques) in cases {
        println!(
            "{name}: contact ratio {:.3}, backlash {:.1e} m",
            pair.contact_ratio(),
            pair.backlash()
        );
        if let Some(trouble) = trouble(&case(pair, &torques)) {
            println!("   {trouble}");
            troubles.push(format!("{name}: {trouble}"));
        }
    }
    assert!(troubles.is_empty(), "{}", troubles.join("\n"));
}

#[test]
#[ignore = "./test all"]
fn three_hundred_teeth_on_either_side_are_solved() {
    let data = gear(300, 60e-3);
    let pair = meshed(data.clone(), data, 600.5e-3);
    let trouble = trouble(&case(pair, &[2000.0]));
    assert!(trouble.is_none(), "{trouble:?}");
}

#[test]
#[ignore = "./test all"]
fn the_fewest_and_the_most_teeth_are_solved() {
    let most = meshed(gear(30, 12e-3), gear(1000, 200e-3), 1030.5e-3);
    // Four teeth leave a contact ratio of 1.0017, by the wheel's long addendum.
    let few = |tooth_count, shift: f64, addendum: f64, bore: f64| {
        let mut data = gear(tooth_count, bore);
        data.profile_shift = shift;
        data.rack.pressure_angle = 30_f64.to_radians();
        (data.rack.addendum, data.rack.dedendum, data.rack.tip_radius) = (addendum, 2.1e-3, 0.1e-3);
        data
    };
    let few = meshed(
        few(4, 0.5, 1.5e-3, 0.3e-3),
        few(60, -0.5, 2e-3, 8e-3),
        64e-3,
    );
    for (pair, torque) in [(most, 2000.0), (few, 20.0)] {
        let trouble = trouble(&case(pair, &[torque]));
        assert!(trouble.is_none(), "{trouble:?}");
    }
}

#[test]
fn contact_is_as_wide_as_the_narrower_gear() {
    // Half the width on both gears under half the load is the same plane problem.
    let of = |widths: [f64; 2], torque: f64| {
        let [one, other] = widths.map(|width| GearData {
            face_width: width,
            ..gear(50, 15e-3)
        });
        solve(&case(meshed(one, other, 100.5e-3), &[torque]))
            .curves
            .remove(0)
    };
    let (whole, half) = (of([20e-3; 2], 115.0), of([10e-3; 2], 57.5));
    for (a, b) in whole
        .transmission_error
        .iter()
        .zip(&half.transmission_error)
    {
        assert!((a / b - 1.0).abs() < 1e-9);
    }
    // A wider partner is stiffer, but not twice.
    let wider = of([10e-3, 20e-3], 57.5);
    assert!(wider.transmission_error_statistics.mean < half.transmission_error_statistics.mean);
    assert!(
        wider.transmission_error_statistics.mean > half.transmission_error_statistics.mean / 2.0
    );
    // Hertz: the flanks touch on the narrower width, whatever lies beside it.
    let pressure = |curve: &Curve| curve.peak_contact_pressure[0].expect("no corner carries");
    let ratio = pressure(&wider) / pressure(&half);
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
}
