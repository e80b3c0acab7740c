//! The service with its real engine: what a portal gets for the examples that it finds.

use serde_json::{Value, json};

use crate::bench::{Asked, Bench, WAIT};

async fn post(bench: &Bench, json: String) -> (u16, Value) {
    let request = bench.client.post(format!("{}/v1/jobs", bench.base));
    let answer = request
        .header("content-type", "application/json")
        .header("prefer", WAIT)
        .body(json)
        .answer()
        .await;
    let status = answer.status().as_u16();
    let mut body = answer.document().await;
    let results = body.get_mut("results").map(Value::take);
    (status, results.unwrap_or(body))
}

async fn example(bench: &Bench, name: &str) -> Value {
    let examples = bench
        .client
        .get(format!("{}/v1/examples", bench.base))
        .document()
        .await;
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
    assert_eq!(error["code"], "teeth_do_not_reach");
    assert_eq!(error["pointer"], "/pair/center_distance_mm");
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

fn numbers(list: &Value) -> Vec<f64> {
    let list = list
        .as_array()
        .unwrap_or_else(|| panic!("{list} is a list"));
    list.iter().map(|each| each.as_f64().unwrap()).collect()
}

#[tokio::test]
#[ignore = "./test all"]
async fn a_run_up_comes_back_with_its_table_and_in_the_forms_of_other_programs() {
    let bench = Bench::real().await;
    let mut submission = example(&bench, "run-up").await;
    submission["resolution"] = json!({ "grid": "coarse" });
    submission["dynamics"]["driving_speed_rpm"]["count"] = json!(41);
    let path = bench.submit(&submission).await;
    let job = bench.ended(&path).await;
    assert_eq!(job["status"], "successful", "{job}");
    // 200 positions of one torque, twice as many of twelve loads; of a job that was long enough to tell, the solutions that those take, on
    // either flank, and between the positions of the curve those of events, extremes, and the largest pressures and stresses. All of them are done.
    let counts = [200, 258].map(|of_curve| [of_curve + 400 * 12, of_curve + 2 * 400 * 11]);
    let counts = counts.as_flattened();
    let total = job["positions_total"].as_u64().expect("a count");
    assert!(counts.contains(&total), "{job}");
    assert_eq!(job["positions_done"], total, "{job}");
    let results = bench.get(&format!("{path}/results")).answer().await;
    let results = results.document().await;

    let table = &results["force_table"];
    let loads = numbers(&table["load_n"]);
    let torque = loads[11]
        * results["pair"]["driven"]["base_radius_mm"]
            .as_f64()
            .unwrap()
        * 1e-3;
    assert!(
        loads[0] == 0.0 && (torque / 230.0 - 1.0).abs() < 1e-9,
        "twice the largest torque"
    );
    let rows = table["transmission_error_um"].as_array().unwrap();
    assert_eq!((rows.len(), numbers(&rows[0]).len()), (12, 400));
    assert_eq!(numbers(&table["mesh_position"]).len(), 400);
    let stiffness = table["mesh_stiffness_tangent_n_per_m"].as_array().unwrap();
    assert_eq!((stiffness.len(), numbers(&stiffness[11]).len()), (12, 400));
    assert!(numbers(&stiffness[0]).iter().all(|k| *k == 0.0));
    let backlash = results["pair"]["backlash_mm"].as_f64().unwrap() * 1e3;
    assert!(
        numbers(&table["backlash_um"])
            .iter()
            .all(|each| *each >= backlash - 1e-6)
    );
    for rows in rows.windows(2) {
        let (below, above) = (numbers(&rows[0]), numbers(&rows[1]));
        assert!(below.iter().zip(above).all(|(below, above)| *below < above));
    }

    let curve = &results["curves"][0];
    let dynamics = &curve["dynamics"];
    let mean = curve["statistics"]["mesh_stiffness_tangent_n_per_m"]["mean"]
        .as_f64()
        .unwrap();
    let mass = dynamics["equivalent_mass_kg"].as_f64().unwrap();
    let natural = dynamics["natural_frequency_hz"].as_f64().unwrap();
    // Rims and teeth stand outside their hubs.
    let on_hubs = (mean / mass).sqrt() / std::f64::consts::TAU;
    assert!(
        (1.05..1.3).contains(&(natural / on_hubs)),
        "{natural} {on_hubs}"
    );
    assert_eq!(
        dynamics["natural_frequencies_hz"][0],
        dynamics["natural_frequency_hz"]
    );
    let of = |gear: &str| {
        let gear = &results["pair"][gear];
        let radius = gear["base_radius_mm"].as_f64().unwrap() * 1e-3;
        radius * radius / gear["polar_inertia_kg_m2"].as_f64().unwrap()
    };
    assert!((mass * (of("driving") + of("driven")) - 1.0).abs() < 1e-9);
    for branch in ["up", "down"] {
        let branch = &dynamics[branch];
        let still = branch["dynamic_transmission_error_um"]["peak_to_peak"][0]
            .as_f64()
            .unwrap();
        let curve = curve["statistics"]["transmission_error_um"]["peak_to_peak"]
            .as_f64()
            .unwrap();
        assert!(
            (still / curve - 1.0).abs() < 0.02,
            "speed 0 is the static curve: {still} {curve}"
        );
        assert_eq!(branch["contact_lost"].as_array().unwrap().len(), 41);
        let labels: Vec<&str> = branch["orders"]
            .as_array()
            .unwrap()
            .iter()
            .map(|order| order["label"].as_str().unwrap())
            .collect();
        assert!(
            labels.contains(&"H_N") && labels.contains(&"H_Z2"),
            "{labels:?}"
        );
    }
    let unseen = results["evidence"]["does_not_see"].to_string();
    assert!(unseen.contains("shafts, bearings and housing"), "{unseen}");

    let get = async |file: &str| bench.get(&format!("{path}/results/{file}")).answer().await;
    let run_up = get("run-up.csv").await.whole_text().await;
    assert!(
        run_up.starts_with("output_torque_n_m,driving_speed_rpm,branch,rms_um,peak_to_peak_um,"),
        "{run_up}"
    );
    assert_eq!(run_up.lines().count(), 1 + 2 * 41);
    let drawn = get("run-up.svg").await.whole_text().await;
    assert!(drawn.starts_with("<svg") && drawn.contains("115 N m, down"));
    let csv = get("force-table.csv").await.whole_text().await;
    assert_eq!(
        csv.lines().filter(|line| !line.starts_with('#')).count(),
        1 + 2 * 12 * 400
    );
    assert!(
        get("force-table.txt")
            .await
            .whole_text()
            .await
            .starts_with("#1\n")
    );
    assert!(
        get("force-table.mo")
            .await
            .whole_text()
            .await
            .contains("end MeshwrightMesh;")
    );

    let fmu = get("force-table.fmu").await.bytes().await.unwrap();
    assert!(fmu.starts_with(b"PK"));

    let plain = bench.submit(&example(&bench, "standard-pair").await).await;
    bench.ended(&plain).await;
    for file in [
        "force-table.csv",
        "force-table.fmu",
        "run-up.csv",
        "run-up.svg",
    ] {
        let answer = bench.get(&format!("{plain}/results/{file}")).answer().await;
        assert_eq!(answer.status().as_u16(), 404, "{file}");
    }
}
