//! δ over the load, from no load on, of pairs that depart from two plain gears in one way each; in the plane and along faces.
//!
//! A contact that closes further under more load yields more: δ rises. Its limit as the load vanishes is where rigid flanks touch first, wherever on
//! them that is.

mod cases;

use cases::departures::{Departure, gears, in_the_plane, of_gears, of_leads, of_profiles};
use meshwright_engine::analysis::{Case, analyze};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

/// What the least of them deflects at most: 0.36 N on a line of 3.5 N/(mm µm), a quarter of what tooth pairs have, that spreads along an opening of 1.5 µm/mm:
/// F = c δ²/(2 σ).
const DEFLECTED: f64 = 0.55e-6;

/// An output torque in N m under which flanks yield by picometers: δ is rounded by a part of that. Cells and slices no longer resolve it.
const LIGHTEST: f64 = 1e-6;

/// Looks at the curves of `case`, and says where δ does not rise with the load, from no load on.
fn rises_from_its_limit(mut case: Case, what: &str, wrong: &mut Vec<String>) {
    case.output_torques.insert(1, LIGHTEST);
    let analysis = match analyze(&case, &Library::default(), &Run::unattended()) {
        Ok(analysis) => analysis,
        Err(error) => return wrong.push(format!("{what}: {error}")),
    };
    for (i, eta) in analysis.curves[0].mesh_position.iter().enumerate() {
        let curves = analysis.curves.iter();
        let mut deltas: Vec<f64> = curves.map(|curve| curve.transmission_error[i]).collect();
        if (deltas.remove(1) - deltas[0]).abs() > DEFLECTED {
            wrong.push(format!("{what} at {eta}, under the lightest load"));
        }
        let rises: Vec<f64> = deltas.windows(2).map(|two| two[1] - two[0]).collect();
        if rises.iter().any(|rise| *rise <= 0.0) || rises[0] > DEFLECTED {
            wrong.push(format!("{what} at {eta}: {deltas:?}"));
        }
    }
}

#[test]
fn in_the_plane_delta_rises_with_the_load_from_where_rigid_flanks_touch() {
    let mut wrong = Vec::new();
    for departure in of_profiles() {
        let case = in_the_plane(gears(departure), 50.2e-3);
        rises_from_its_limit(case, departure.name, &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A pair along its faces, with this helix angle in radians.
fn along_faces(departure: Departure, beta: f64) -> Case {
    let distance = 50e-3 / f64::cos(beta) + 0.2e-3;
    of_gears(gears(departure), departure, beta, distance)
}

#[test]
fn along_faces_delta_of_a_few_pairs_rises_with_light_loads_from_where_rigid_flanks_touch() {
    let mut wrong = Vec::new();
    for (name, beta) in [
        ("pitch of both", 0.0),
        ("pitch of both", 0.3),
        ("crowning", 0.3),
    ] {
        let departure = of_profiles().into_iter().find(|each| each.name == name);
        let mut case = along_faces(departure.expect("a departure of this name"), beta);
        case.output_torques = vec![0.0, 1e-2, 1.0];
        case.resolution.span_mesh_periods = Some(1);
        rises_from_its_limit(case, name, &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
#[ignore = "./test all"]
fn along_faces_delta_rises_with_the_load_from_where_rigid_flanks_touch() {
    let mut wrong = Vec::new();
    for departure in of_profiles().into_iter().chain(of_leads()) {
        for beta in [0.0, 0.3] {
            let what = format!("{}, {beta}", departure.name);
            rises_from_its_limit(along_faces(departure, beta), &what, &mut wrong);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
