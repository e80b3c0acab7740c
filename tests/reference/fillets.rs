//! The largest tension along the fillets of S1 against CalculiX.

use std::f64::consts::TAU;

use meshwright_engine::grid::GridLevel;
use serde_json::Value;

use crate::reference;
use crate::support::{standard_pair, stressed, stresses};

#[test]
fn tension_along_the_fillets_is_that_of_calculix() {
    // Asked for are 3 %; CalculiX moves by 0.3 % where its grid along the fillet is halved.
    let document = reference("calculix-fillet.json");
    let curve = stressed(standard_pair(true), 115.0, 16, GridLevel::Standard);
    for position in document["positions"].as_array().expect("positions") {
        let eta = position["mesh_position"].as_f64().expect("a position");
        let place = (eta * 16.0).round() as usize;
        assert!((curve.mesh_position[place] - eta).abs() < 1e-12);
        let fillets = position["loads"][0]["fillets"].as_array().expect("fillets");
        for (gear, name) in stresses(&curve).iter().zip(["driving", "driven"]) {
            let of_gear = fillets.iter().filter(|fillet| fillet["gear"] == name);
            let number = |fillet: &Value, key: &str| fillet[key].as_f64().expect("a number");
            let (stress, angle) = of_gear
                .map(|fillet| {
                    (
                        number(fillet, "largest_principal_mpa"),
                        number(fillet, "largest_principal_at_angle_deg"),
                    )
                })
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .expect("a fillet");
            let found = gear.root[place];
            let off = found.stress / (1e6 * stress) - 1.0;
            // The place within its tooth; nodes stand 0.1 degrees apart.
            let pitch = TAU / 50.0;
            let within = (found.angle + pitch / 2.0).rem_euclid(pitch) - pitch / 2.0;
            println!(
                "{eta} {name}: {:.2} MPa at {:.3} degrees, CalculiX {stress} at {angle}: {off:+.4}",
                found.stress / 1e6,
                within.to_degrees()
            );
            assert!(off.abs() < 0.03, "{eta} {name}");
            assert!((within.to_degrees() - angle).abs() < 0.3, "{eta} {name}");
        }
    }
}
