//! Memory that submissions ask for: whatever way one comes in, none is accepted that may not take as much as it is estimated to.

use meshwright_wire::Submission;
use serde_json::{Value, json};

use crate::bench::{Asked, Bench, Said};
use crate::generated::Chance;

/// Memory that one job may take, in MB.
const LIMIT_MB: u64 = 500;

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
            "blank": { "bore_radius_mm": bore },
        });
        let room = root - bore;
        if room > 16.0 && chance.one_in(2) {
            let radius = 0.2 * room;
            let circle = bore + 0.5 * room;
            let most = (std::f64::consts::PI * circle / (radius + 1.0)) as usize;
            let count = 2 + chance.below(most.min(60) - 1);
            gear["blank"]["holes"] =
                json!({ "count": count, "circle_radius_mm": circle, "radius_mm": radius });
        }
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
        "resolution": { "positions_per_mesh_period": 8 + chance.below(60), "span_mesh_periods": 1 },
    });
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
            return code(&send("/v1/jobs/batch", &batch).await.1["items"][0]["problem"]);
        }
        3 => {
            study["designs"] = json!([{ "label": "a", "changes": { "/output_torques_n_m": [77] } }])
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
async fn nothing_is_accepted_whose_estimate_is_above_the_limit_of_a_job() {
    let adjust = |config: &mut meshwright::config::Config| {
        config.job_memory_mb = LIMIT_MB;
        config.memory_mb = Some(4000);
        config.queue_limit = 100_000;
    };
    let quick = std::sync::Arc::new(|_: &_, _: &_| Ok(crate::bench::results()));
    let bench = Bench::start(adjust, quick).await;
    let mut chance = Chance(20_261_126);
    let (mut accepted, mut refused, mut unbuildable) = (0, 0, 0);
    let mut number = 0;
    while accepted + refused < 1000 {
        let document = random(&mut chance);
        let Ok(submission) = Submission::parse(document.to_string().as_bytes()) else {
            unbuildable += 1;
            assert!(unbuildable < 2000, "chance makes too few that can be built");
            continue;
        };
        let needed_mb = meshwright_wire::validate(&submission).estimate.memory_mb;
        let is_too_large = needed_mb > LIMIT_MB;
        number += 1;
        let refusal = refusal(&bench, number % 6, &document).await;
        match refusal.as_deref() {
            Some("too_large") if is_too_large => refused += 1,
            None if !is_too_large => accepted += 1,
            other => panic!(
                "way {}: {other:?} at {needed_mb} MB\n{document}",
                number % 6
            ),
        }
    }
    println!("{accepted} accepted, {refused} refused, {unbuildable} that cannot be built");
    assert!(accepted > 200 && refused > 200);
}
