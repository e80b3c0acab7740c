//! Studies whose designs are the members of a population: drawn, computed, and told of as they come.

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::bench::{Asked, Bench, problem};

/// Members of a small pair by the quick method: a varied field, and teeth of both gears.
fn members(size: u32, sampling: &str) -> Value {
    let gear = json!({ "tooth_count": 20, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 8.0 } });
    json!({
        "keep": "statistics",
        "base": {
            "method": "load_distribution",
            "pair": { "center_distance_mm": 40.2, "driving": gear, "driven": gear },
            "output_torques_n_m": [50.0, 20.0],
            // A revolution would tell more, and take longer.
            "resolution": { "positions_per_mesh_period": 8, "span_mesh_periods": 1 },
        },
        "population": {
            "size": size, "seed": 3, "sampling": sampling,
            "vary": [
                { "path": "/pair/center_distance_mm", "kind": "normal", "mean": 40.2, "standard_deviation": 0.02, "low": 40.1, "high": 40.3 },
                { "path": "/pair/driving/tooth_thickness_deviation_um", "kind": "uniform", "low": -60, "high": -20 },
            ],
            "accuracy": { "driving": { "iso_1328_class": 6 }, "driven": { "iso_1328_class": 7 } },
        },
    })
}

async fn begun(bench: &Bench, study: &Value) -> String {
    let response = bench.post("/v1/studies", study).answer().await;
    assert_eq!(response.status(), StatusCode::ACCEPTED);
    let location = response.headers()["location"].to_str().unwrap().to_owned();
    // Whoever asks learns at once what it will take, and by the words of POST /v1/validate.
    let taken: Value = response.json().await.expect("JSON");
    let validated = bench.post("/v1/validate", study).document().await;
    assert_eq!(taken["estimate"], validated["estimate"]);
    location
}

fn quantity<'a>(results: &'a Value, name: &str, torque: Option<f64>) -> &'a Value {
    let mut quantities = results["quantities"].as_array().unwrap().iter();
    let is = |quantity: &&Value| {
        quantity["name"] == name && quantity["output_torque_n_m"].as_f64() == torque
    };
    quantities
        .find(is)
        .unwrap_or_else(|| panic!("{name} in {results}"))
}

/// So many members has a population that is computed.
const MEMBERS: u32 = 48;

const RANGE: &str = "transmission_error_um.peak_to_peak";

/// The values of the table at the torque of this number, sorted.
fn in_table(table: &Value, curve: usize) -> Vec<f64> {
    let rows = table["rows"].as_array().unwrap().iter();
    let value = |row: &Value| {
        row["curves"][curve]["statistics"]["transmission_error_um"]["peak_to_peak"].as_f64()
    };
    let mut values: Vec<f64> = rows.filter_map(value).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn is_close(found: &Value, expected: f64) {
    let found = found.as_f64().unwrap();
    assert!(
        (found - expected).abs() <= 1e-9 * expected.abs(),
        "{found} {expected}"
    );
}

#[tokio::test]
async fn a_population_comes_to_what_its_table_says_whenever_it_is_asked() {
    for sampling in ["sobol", "random"] {
        let mut bench = Bench::real().await;
        let path = begun(&bench, &members(MEMBERS, sampling)).await;
        let ended = bench.ended(&path).await;
        assert_eq!(
            (ended["status"].as_str(), ended["successful"].as_u64()),
            (Some("successful"), Some(u64::from(MEMBERS)))
        );
        let table = bench.job(&format!("{path}/results")).await;
        let results = bench.job(&format!("{path}/results/population")).await;
        assert_eq!(
            (
                results["size"].as_u64(),
                results["done"].as_u64(),
                results["failed"].as_u64()
            ),
            (Some(u64::from(MEMBERS)), Some(u64::from(MEMBERS)), Some(0))
        );
        for (curve, torque) in [50.0, 20.0].into_iter().enumerate() {
            let values = in_table(&table, curve);
            let found = quantity(&results, RANGE, Some(torque));
            // As numpy has them: over n, and linear between neighbors.
            let count = f64::from(MEMBERS);
            assert_eq!(values.len(), MEMBERS as usize);
            let mean = values.iter().sum::<f64>() / count;
            let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
            is_close(&found["mean"], mean);
            is_close(&found["standard_deviation"], (squares / count).sqrt());
            is_close(&found["smallest"], values[0]);
            is_close(&found["largest"], values[values.len() - 1]);
            for percentile in found["percentiles"].as_array().unwrap() {
                let place = percentile["percent"].as_f64().unwrap() / 100.0 * (count - 1.0);
                let (below, part) = (place.floor() as usize, place.fract());
                let expected = values[below] + part * (values[below + 1] - values[below]);
                is_close(&percentile["value"], expected);
            }
            let (edges, counts) = (&found["histogram"]["edges"], &found["histogram"]["counts"]);
            let (edges, counts) = (edges.as_array().unwrap(), counts.as_array().unwrap());
            for (i, count) in counts.iter().enumerate() {
                let [from, to] = [i, i + 1].map(|i| edges[i].as_f64().unwrap());
                let inside =
                    |value: &&f64| **value >= from && (**value < to || i + 1 == counts.len());
                assert_eq!(
                    count.as_u64(),
                    Some(values.iter().filter(inside).count() as u64)
                );
            }
            let influences = found["influences"].as_array().unwrap();
            assert_eq!(influences.len(), 4);
            assert_eq!(influences[2]["accuracy"], "driving");
        }
        assert!(results["beyond_total_pitch_tolerance"]["driven"].is_number());

        // A new process tells the same, to the last digit.
        let before = bench
            .get(&format!("{path}/results/population"))
            .answer()
            .await;
        let tag = before.headers()["etag"].clone();
        let text = before.whole_text().await;
        bench.shut_down().await;
        bench.start_again().await;
        let after = bench.get(&format!("{path}/results/population"));
        assert_eq!(after.whole_text().await, text);
        let known = bench.get(&format!("{path}/results/population"));
        let known = known.header("if-none-match", tag).answer().await;
        assert_eq!(known.status(), StatusCode::NOT_MODIFIED);
    }
}

#[tokio::test]
async fn a_design_of_a_study_is_given_as_the_submission_that_its_job_computes() {
    let (bench, _engine) = Bench::steered().await;
    let path = begun(&bench, &members(8, "sobol")).await;
    let table = bench.job(&format!("{path}/results")).await;
    for (row, line) in table["rows"].as_array().unwrap().iter().enumerate() {
        let design = bench.job(&format!("{path}/designs/{row}")).await;
        let job = bench
            .job(&format!("/v1/jobs/{}", line["job"].as_str().unwrap()))
            .await;
        assert_eq!(design, job["submission"]);
        let pair = &design["pair"];
        assert_eq!(
            pair["driving"]["tooth_deviations"]["pitch_single_um"]
                .as_array()
                .unwrap()
                .len(),
            20
        );
        assert_eq!(
            pair["center_distance_mm"],
            line["changes"]["/pair/center_distance_mm"]
        );
        assert_eq!(line["label"], format!("member {row}"));
    }
    for row in ["8", "-1", "first"] {
        let asked = bench.get(&format!("{path}/designs/{row}"));
        problem(asked, 404, "not_found").await;
    }
    // One that cannot be built is given as it was put together.
    let gear = &members(8, "sobol")["base"];
    let study = json!({ "base": gear, "designs": [{ "label": "apart", "changes": { "/pair/center_distance_mm": 60 } }] });
    let path = begun(&bench, &study).await;
    let design = bench.job(&format!("{path}/designs/0")).await;
    assert_eq!(design["pair"]["center_distance_mm"], 60);
    let asked = bench.get(&format!("{path}/results/population"));
    problem(asked, 404, "not_found").await;
}

#[tokio::test]
async fn a_population_tells_what_is_there_while_it_runs_and_after_it_was_cancelled() {
    let (bench, mut engine) = Bench::steered().await;
    let path = begun(&bench, &members(40, "random")).await;
    let nothing = bench.job(&format!("{path}/results/population")).await;
    assert_eq!(
        (
            nothing["done"].as_u64(),
            nothing["quantities"].as_array().map(Vec::len)
        ),
        (Some(0), Some(0))
    );
    for _ in 0..3 {
        engine.next().await.finish();
    }
    let _fourth = engine.next().await;
    let largest_count = |results: &Value| {
        let quantities = results["quantities"].as_array().unwrap();
        quantities
            .iter()
            .map(|quantity| quantity["count"].as_u64().unwrap())
            .max()
    };
    // The third one is counted a moment after its engine has done.
    let some = loop {
        let some = bench.job(&format!("{path}/results/population")).await;
        if some["done"] == 3 {
            break some;
        }
        tokio::task::yield_now().await;
    };
    assert_eq!(
        (
            some["status"].as_str(),
            some["done"].as_u64(),
            largest_count(&some)
        ),
        (Some("running"), Some(3), Some(3))
    );
    let cancelled = bench.cancel(&path).answer().await;
    assert_eq!(cancelled.status(), StatusCode::ACCEPTED);
    let kept = bench.job(&format!("{path}/results/population")).await;
    assert_eq!(
        (kept["status"].as_str(), largest_count(&kept)),
        (Some("dismissed"), Some(3))
    );
}

#[tokio::test]
async fn a_population_that_cannot_be_drawn_is_refused_with_its_place() {
    let (bench, _engine) = Bench::steered().await;
    let mut study = members(40, "random");
    study["population"]["vary"][0]["mean"] = json!(41);
    let response = bench.post("/v1/studies", &study).answer().await;
    let refused = problem(response, 422, "out_of_range").await;
    assert_eq!(refused["errors"][0]["pointer"], "/population/vary/0/mean");
    assert_eq!(refused["errors"][0]["nearest"], 40.3);
}

#[tokio::test]
async fn a_study_a_population_and_a_search_are_checked_and_answered_with_their_cost() {
    let (bench, mut engine) = Bench::steered().await;
    let check = async |document: &Value| bench.post("/v1/validate", document).document().await;
    let of_base = check(&members(8, "sobol")["base"]).await;
    let of_members = check(&members(300, "sobol")).await;
    assert_eq!(
        (&of_members["valid"], &of_members["total"]),
        (&json!(true), &json!(300))
    );
    // 2 torques, 8 positions in a mesh period: as of the base, and of all members together.
    let design = &of_members["estimate"]["design"];
    assert_eq!(
        (&design["positions"], &of_base["estimate"]["positions"]),
        (&json!(16), &json!(16))
    );
    assert_eq!(of_members["estimate"]["positions"], 300 * 16);
    let seconds = |estimate: &Value| estimate["seconds"].as_f64().unwrap();
    let all = seconds(&of_members["estimate"]);
    assert!(
        all > 0.0 && all <= 300.0 * seconds(design) * (1.0 + 1e-12),
        "{all}"
    );

    let base = &members(8, "sobol")["base"];
    let axes = json!({ "base": base, "axes": [{ "path": "/output_torques_n_m/0", "values": [10, 20, 30] }] });
    assert_eq!(check(&axes).await["total"], 3);
    let search = json!({ "base": base, "search": {
        "variables": [{ "path": "/pair/center_distance_mm", "low": 40.1, "high": 40.3 }],
        "minimize": [{ "quantity": "transmission_error_um.peak_to_peak" }], "evaluations": 20, "seed": 1 } });
    let checked = check(&search).await;
    assert!(checked["total"].as_u64().unwrap() >= 20, "{checked}");
    assert_eq!(checked["estimate"]["design"]["positions"], 16);
    // What a study would be refused for it is refused for here, at the same place.
    let mut wrong = members(40, "random");
    wrong["population"]["vary"][0]["mean"] = json!(41);
    let refused = problem(bench.post("/v1/validate", &wrong), 422, "out_of_range").await;
    assert_eq!(refused["errors"][0]["pointer"], "/population/vary/0/mean");
    assert!(engine.is_idle());
    let list = bench.document("/v1/studies").await;
    assert_eq!(list["items"], json!([]));
}
