//! Memory that submissions ask for: whatever way one comes in, none is accepted that may not take as much as it is estimated to.

use meshwright_wire::Submission;
use serde_json::{Value, json};

use crate::bench::{Asked, Bench};
use crate::generated::Chance;

/// Memory that one job may take, in MB: what a usual pair takes at most, and more.
const LIMITS_MB: [u64; 2] = [400, 500];

/// Openings of a blank between two radii, of one of all kinds, and in some cases a web, as fields of the blank.
fn openings(chance: &mut Chance, bore: f64, root: f64) -> Value {
    let room = root - bore;
    let circle = bore + 0.5 * room;
    let radius = 0.2 * room;
    let most = (std::f64::consts::PI * circle / (radius + 1.0)) as usize;
    let count = 2 + chance.below(most.min(60) - 1);
    let mut blank = match chance.below(5) {
        0 => {
            json!({ "holes": { "count": count, "circle_radius_mm": circle, "radius_mm": radius } })
        }
        1 => {
            let slot = json!({ "width_mm": radius, "angle_deg": 180.0 / count as f64 });
            json!({ "holes": { "count": count, "circle_radius_mm": circle, "slot": slot } })
        }
        2 => json!({ "spokes": {
            "count": 2 + chance.below(10), "width_mm": 2.0, "fillet_radius_mm": 1.0,
            "inner_radius_mm": bore + 0.2 * room, "outer_radius_mm": bore + 0.8 * room,
        } }),
        3 => {
            // Small ones, of as many sides as there may be.
            let count = 1 + chance.below(60);
            let radius = f64::min(0.4 * room, 2.0 * circle / count as f64);
            let sides = (980 / count).min(200);
            let opening = |number: usize| -> Value {
                let side = |side: usize| {
                    let angles = [number as f64 / count as f64, -(side as f64) / sides as f64];
                    let [at, around] = angles.map(|turn| std::f64::consts::TAU * turn);
                    let end = [
                        circle * at.cos() + radius * around.cos(),
                        circle * at.sin() + radius * around.sin(),
                    ];
                    json!({ "line_to": end })
                };
                (0..sides).map(side).collect()
            };
            json!({ "outline": (0..count).map(opening).collect::<Vec<_>>() })
        }
        _ => json!({}),
    };
    if chance.one_in(3) {
        blank["web"] = json!({
            "inner_radius_mm": bore + 0.1 * room, "outer_radius_mm": bore + 0.9 * room, "thickness_mm": 4,
        });
    }
    blank
}

/// A pair by one of the methods, in two of three cases of a size that takes much.
fn random(chance: &mut Chance) -> Value {
    let methods: Vec<&str> = meshwright_wire::methods().collect();
    let method = methods[chance.below(methods.len())];
    let along_faces = method.starts_with("three_dimensional");
    let is_large = !chance.one_in(3);
    let most_teeth = if is_large { 250 } else { 100 };
    let module = 2.0;
    let mut gear = |bore: f64| {
        let teeth = 24 + chance.below(most_teeth - 24);
        let root = 0.5 * module * (teeth as f64 - 2.5);
        let mut gear = json!({
            "tooth_count": teeth, "module_mm": module, "face_width_mm": 8 + chance.below(30),
        });
        gear["blank"] = match root - bore > 16.0 {
            true => openings(chance, bore, root),
            false => json!({}),
        };
        gear["blank"]["bore_radius_mm"] = json!(bore);
        (teeth, gear)
    };
    let (first, driving) = gear(8.0);
    let (second, driven) = gear(10.0);
    let helix: f64 = if along_faces {
        chance.between(0.0, 25.0)
    } else {
        0.0
    };
    let reference = 0.5 * module * (first + second) as f64 / helix.to_radians().cos();
    let torques: Vec<usize> = (0..=chance.below(3)).map(|i| 50 + 40 * i).collect();
    let mut document = json!({
        "method": method,
        "pair": { "center_distance_mm": reference + 0.3, "driving": driving, "driven": driven },
        "output_torques_n_m": torques,
        "resolution": { "positions_per_mesh_period": 8 + chance.below(60) },
    });
    if !chance.one_in(4) {
        document["resolution"]["span_mesh_periods"] = json!(1);
    }
    if method != "load_distribution" && chance.one_in(6) {
        document["force_table"] = json!({ "loads": 4 + chance.below(56) });
    }
    let resolution = &mut document["resolution"];
    if method != "load_distribution" {
        resolution["grid"] = json!(["coarse", "standard", "fine"][chance.below(3)]);
        resolution["error_estimate"] = json!(chance.one_in(2));
        document["stress"] = json!(is_large && chance.one_in(2));
    }
    if along_faces {
        document["pair"]["helix_angle_deg"] = json!(helix);
        document["resolution"]["face_order"] = json!(4 + 2 * chance.below(5));
        document["resolution"]["face_slices"] = json!(20 + chance.below(180));
    }
    document
}

/// What the service says of a submission that comes in by one way: none if it is accepted, or the code of its problem.
async fn refusal(bench: &Bench, way: usize, submission: &Value) -> Option<String> {
    let send = async |path: &str, document: &Value| {
        let answer = bench.post(path, document).answer().await;
        (answer.status().as_u16(), answer.document().await)
    };
    let code = |problem: &Value| problem["code"].as_str().map(str::to_owned);
    let mut study = json!({ "base": submission });
    match way {
        0 => return code(&send("/v1/jobs", submission).await.1),
        1 => return code(&send("/v1/preview", submission).await.1),
        2 => {
            let batch = json!({ "submissions": [submission] });
            return code(&send("/v1/jobs/batch", &batch).await.1);
        }
        3 => {
            study["designs"] = json!([{ "label": "a", "changes": { "/output_torques_n_m/0": 77 } }])
        }
        4 => {
            let vary = json!([{ "path": "/output_torques_n_m/0", "kind": "uniform", "low": 50, "high": 60 }]);
            study["population"] = json!({ "size": 2, "seed": 3, "vary": vary });
        }
        _ => {
            study["search"] = json!({
                "variables": [{ "path": "/output_torques_n_m/0", "low": 50, "high": 60 }],
                "minimize": [{ "quantity": "transmission_error_um.peak_to_peak" }],
                "evaluations": 10, "seed": 3,
            });
        }
    }
    let (status, taken) = send("/v1/studies", &study).await;
    assert_eq!(status, 202, "{taken}");
    let path = format!("/v1/studies/{}/results", taken["id"].as_str().unwrap());
    let table = bench.document(&path).await;
    assert!(
        table["rows"][0].is_object(),
        "a row stands when its study is taken"
    );
    code(&table["rows"][0]["problem"])
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn nothing_is_accepted_whose_estimate_is_above_the_limit_of_a_job() {
    try_at_the_limit(150).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "the estimates of a thousand pairs take minutes"]
async fn nothing_is_accepted_whose_estimate_is_above_the_limit_of_a_job_at_length() {
    try_at_the_limit(1000).await;
}

/// Submits `count` submissions drawn at random in each way that there is, a sixth of them each, at two limits.
async fn try_at_the_limit(count: usize) {
    let limited = async |limit_mb: u64| {
        let adjust = |config: &mut meshwright::config::Config| {
            config.job_memory_mb = limit_mb;
            config.memory_mb = Some(4000);
            config.queue_limit = 100_000;
            config.preview_positions = 1_000_000;
        };
        let quick = std::sync::Arc::new(|_: &_, _: &_| Ok(crate::bench::results()));
        Bench::start(adjust, quick).await
    };
    let benches = [limited(LIMITS_MB[0]).await, limited(LIMITS_MB[1]).await];
    let mut chance = Chance(20_261_126);
    let (mut accepted, mut refused, mut unbuildable) = (0, 0, 0);
    let mut number = 0;
    while accepted + refused < count {
        let document = random(&mut chance);
        let Ok(submission) = Submission::parse(document.to_string().as_bytes()) else {
            unbuildable += 1;
            assert!(
                unbuildable < 2 * count,
                "chance makes too few that can be built"
            );
            continue;
        };
        let needed_mb = meshwright_wire::validate(&submission).estimate.memory_mb;
        number += 1;
        let which = number / 6 % 2;
        let is_too_large = needed_mb > LIMITS_MB[which];
        let refusal = refusal(&benches[which], number % 6, &document).await;
        match refusal.as_deref() {
            Some("too_large") if is_too_large => refused += 1,
            None if !is_too_large => accepted += 1,
            other => panic!(
                "way {}: {other:?} at {needed_mb} MB of {}\n{document}",
                number % 6,
                LIMITS_MB[which]
            ),
        }
    }
    println!("{accepted} accepted, {refused} refused, {unbuildable} that cannot be built");
    assert!(accepted > count / 5 && refused > count / 5);
}
