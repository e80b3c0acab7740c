//! The service with its real engine: what a portal gets for the examples that it finds.

use serde_json::Value;

use super::bench::Bench;

async fn post(bench: &Bench, json: String) -> (u16, Value) {
    let request = bench.client.post(format!("{}/v1/jobs", bench.base));
    let answer = request
        .header("content-type", "application/json")
        .header("prefer", "wait=20")
        .body(json)
        .send()
        .await
        .unwrap();
    let status = answer.status().as_u16();
    let mut body: Value = answer.json().await.unwrap();
    let results = body.get_mut("results").map(Value::take);
    (status, results.unwrap_or(body))
}

async fn example(bench: &Bench, name: &str) -> Value {
    let examples: Value = bench
        .client
        .get(format!("{}/v1/examples", bench.base))
        .send()
        .await
        .unwrap()
        .json()
        .await
        .unwrap();
    let items = examples["items"]
        .as_array()
        .or(examples.as_array())
        .unwrap();
    items
        .iter()
        .find(|item| item["name"] == name)
        .unwrap_or_else(|| panic!("{name} in {examples}"))["submission"]
        .clone()
}

#[tokio::test]
async fn test_case_2_comes_back_with_the_curves_of_the_paper_and_their_evidence() {
    let bench = Bench::real().await;
    let (status, results) = post(&bench, example(&bench, "test-case-2").await.to_string()).await;
    assert_eq!(status, 200, "{results}");
    let curve = &results["curves"][0];
    let mean = |name: &str| curve["statistics"][name]["mean"].as_f64().unwrap();
    // Issue and DESIGN section 5: 13.79 µm and 2.19e8 N/m within 1 %.
    assert!((mean("transmission_error_um") / 13.79 - 1.0).abs() < 0.01);
    assert!((mean("mesh_stiffness_tangent_n_per_m") / 2.19e8 - 1.0).abs() < 0.01);
    assert_eq!(results["pair"]["period_mesh_periods"], 5);
    for name in [
        "mesh_position",
        "driving_angle_deg",
        "driven_angle_deg",
        "transmission_error_um",
        "mesh_stiffness_tangent_n_per_m",
        "mesh_stiffness_secant_n_per_m",
        "pairs_in_contact",
        "peak_contact_pressure_mpa",
    ] {
        assert_eq!(curve[name].as_array().unwrap().len(), 200, "{name}");
    }
    assert!(
        results["evidence"]["equilibrium_residual"]
            .as_f64()
            .unwrap()
            < 1e-12
    );
    let named = curve["spectrum"]["named"].as_array().unwrap();
    assert!(
        named
            .iter()
            .any(|line| line["label"] == "H_N" && line["order"] == 10.0)
    );
}

#[tokio::test]
async fn case_3_as_printed_is_refused_with_a_distance_that_works() {
    let bench = Bench::real().await;
    let printed = example(&bench, "bad-case-3-as-printed").await;
    let (status, problem) = post(&bench, printed.to_string()).await;
    assert_eq!(status, 422);
    let error = &problem["errors"][0];
    assert_eq!(
        (error["code"].as_str(), error["pointer"].as_str()),
        (Some("teeth_do_not_reach"), Some("/pair/center_distance_mm"))
    );
    // The nearest distance has a contact ratio of one: 115.567 mm in closed form.
    let nearest = error["nearest"].as_f64().unwrap();
    assert!((115.55..=115.567).contains(&nearest), "{nearest}");
    let mut cured = printed;
    cured["pair"]["center_distance_mm"] = nearest.into();
    cured["resolution"] = serde_json::json!({ "span_mesh_periods": 1, "grid": "coarse", "positions_per_mesh_period": 8 });
    let (status, results) = post(&bench, cured.to_string()).await;
    assert_eq!(status, 200, "{results}");
    assert!(
        results["warnings"]
            .as_array()
            .unwrap()
            .iter()
            .any(|warning| warning["code"] == "partial_span")
    );
}

#[tokio::test]
async fn every_method_answers_with_the_same_document_and_says_what_it_does_not_see() {
    let bench = Bench::real().await;
    let mut submission = example(&bench, "test-case-2").await;
    submission["resolution"] =
        serde_json::json!({ "grid": "coarse", "positions_per_mesh_period": 16 });
    for method in [
        "flexible",
        "decomposition",
        "projected_decomposition",
        "load_distribution",
    ] {
        submission["method"] = method.into();
        let (status, results) = post(&bench, submission.to_string()).await;
        assert_eq!(
            (status, results["method"].as_str()),
            (200, Some(method)),
            "{results}"
        );
        let unseen = results["evidence"]["does_not_see"].to_string();
        assert_eq!(
            unseen.contains("the bodies are solid"),
            method == "load_distribution",
            "{method}: {unseen}"
        );
    }
}
