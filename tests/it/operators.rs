//! What operators look at: the dashboard and the alerts that ship ask for numbers that there are.

use std::collections::BTreeSet;

use meshwright_engine::library::Library;
use serde_json::Value;

use crate::bench::{Asked, Bench, submission};

const DASHBOARD: &str = include_str!("../../deploy/grafana/meshwright.json");
const ALERTS: &str = include_str!("../../deploy/prometheus/alerts.yaml");

/// The names of numbers in a text.
fn names(text: &str) -> BTreeSet<&str> {
    let word = |c: char| !(c.is_ascii_alphanumeric() || c == '_');
    text.split(word)
        .filter(|word| word.starts_with("meshwright_"))
        .collect()
}

/// What rises from nothing is told as nothing before: the growth of a number that begins at one is none.
#[tokio::test]
async fn what_an_alert_waits_for_is_told_before_it_happens_the_first_time() {
    let bench = Bench::quick().await;
    let told = bench.get("/metrics").whole_text().await;
    let grows: Vec<&str> = ALERTS
        .split("increase(")
        .skip(1)
        .map(|rest| rest.split_once('[').unwrap().0)
        .collect();
    assert!(grows.len() >= 2, "{grows:?}");
    for number in grows {
        let (name, label) = number.trim_end_matches('}').split_once('{').unwrap();
        let is_told = |line: &str| line.starts_with(name) && line.contains(label);
        assert!(told.lines().any(is_told), "{number}");
    }
}

#[tokio::test]
async fn every_number_of_the_dashboard_and_of_the_alerts_is_told() {
    let bench = Bench::quick().await;
    let job = bench.submit(&submission(1.0)).await;
    bench.ended(&job).await;
    let preview = bench.post("/v1/preview", &submission(1.0)).send().await;
    assert!(preview.unwrap().status().is_success());
    let told = bench.get("/metrics").answer().await;
    let told = told.whole_text().await;
    let told = names(&told);

    let dashboard: Value = serde_json::from_str(DASHBOARD).unwrap();
    let panels = dashboard["panels"].as_array().unwrap();
    let asked = panels
        .iter()
        .flat_map(|panel| panel["targets"].as_array().unwrap())
        .map(|target| target["expr"].as_str().unwrap());
    let asked: Vec<&str> = asked.chain([ALERTS]).collect();
    let asked: BTreeSet<&str> = asked.iter().flat_map(|text| names(text)).collect();
    assert!(asked.len() > 20, "{asked:?}");
    let missing: Vec<_> = asked.difference(&told).collect();
    assert!(missing.is_empty(), "{missing:?} of {told:?}");
}

#[tokio::test]
async fn the_process_its_disk_and_who_vouches_for_people_are_told() {
    let bench = Bench::quick().await;
    let told = bench.get("/metrics").whole_text().await;
    let value = |name: &str| -> f64 {
        let line = told.lines().find(|line| line.starts_with(name)).unwrap();
        line.rsplit(' ').next().unwrap().parse().unwrap()
    };
    let version = format!(
        "meshwright_build_info{{version=\"{}\"}}",
        env!("CARGO_PKG_VERSION")
    );
    assert_eq!(value(&version), 1.0);
    assert!(value("meshwright_process_memory_bytes ") > 1e6);
    let (all, free) = (
        value("meshwright_disk_bytes "),
        value("meshwright_disk_free_bytes "),
    );
    assert!(0.0 < free && free <= all, "{free} of {all}");
    assert_eq!(value("meshwright_identity_provider_answers "), 1.0);
    for silence in ["up{job=~\".*meshwright.*\"} == 0", "absent(up{"] {
        assert!(ALERTS.contains(silence), "{silence}");
    }
}

#[test]
fn what_is_deployed_is_of_this_version() {
    let folder = crate::contract::root().join("deploy");
    let version = concat!("meshwright:", env!("CARGO_PKG_VERSION"));
    let mut named = 0;
    for file in [
        "kubernetes/meshwright.yaml",
        "kubernetes/keda.yaml",
        "compose.yaml",
    ] {
        let text = std::fs::read_to_string(folder.join(file)).unwrap();
        for line in text
            .lines()
            .filter(|line| line.contains("meshwright:") && line.contains("image:"))
        {
            named += 1;
            assert!(
                line.trim_end().ends_with(version) || !line.contains(|c: char| c.is_ascii_digit()),
                "{file}: {line}"
            );
        }
    }
    assert!(named >= 2, "{named}");
}

/// The name and value of each label in a text of numbers.
fn labels(told: &str) -> BTreeSet<(&str, &str)> {
    let series = told.lines().filter(|line| !line.starts_with('#'));
    let labels = series.filter_map(|line| Some(line.split_once('{')?.1.rsplit_once('}')?.0));
    labels
        .flat_map(|labels| labels.split("\","))
        .filter_map(|label| label.split_once("=\""))
        .map(|(name, value)| (name, value.trim_end_matches('"')))
        .collect()
}

#[tokio::test]
async fn no_label_has_a_value_that_a_client_invents() {
    let bench = Bench::quick().await;
    let job = bench.submit(&submission(1.0)).await;
    bench.ended(&job).await;
    for number in 0..20 {
        let method = format!("INVENTED{number}{}", "X".repeat(8000));
        let method = reqwest::Method::from_bytes(method.as_bytes()).unwrap();
        for path in ["/v1/jobs", "/invented", &*format!("{job}/invented")] {
            let request = bench.client.request(method.clone(), bench.url(path));
            assert!(request.answer().await.status().is_client_error());
        }
        for folder in [
            "/web",
            "/docs",
            "/guides",
            "/guides/figures",
            "/v1/jobs",
            "/problems",
        ] {
            let answer = bench
                .get(&format!("{folder}/invented{number}"))
                .answer()
                .await;
            assert!(answer.status().is_client_error(), "{folder}");
        }
    }
    let told = bench.get("/metrics").whole_text().await;

    let document = bench.document("/openapi.json").await;
    let described = document["paths"].as_object().unwrap().keys();
    let mut routes: BTreeSet<&str> = described.map(String::as_str).collect();
    routes.extend([
        "none",
        "/",
        "/openapi.json",
        "/v1/studies/{id}/results.csv",
        "/shared/{secret}",
    ]);
    // The document has an operation for each file.
    routes.extend([
        "/v1/jobs/{id}/results/{table}",
        "/shared/{secret}/results/{table}",
        "/v1/studies/{id}/results/{file}",
    ]);
    // The document has the name of the file, `{n}.vtu`.
    routes.extend(["/v1/jobs/{id}/results/modes/{n}"]);
    // What is no part of the document has one pattern for each of its folders.
    routes.extend(["/docs", "/docs/", "/docs/{name}", "/web/{*name}"]);
    routes.extend(["/guides", "/guides/{name}", "/guides/figures/{name}"]);
    let shelves = Library::with_capacity(1).usage().map(|(shelf, _)| shelf);
    let mut seen = BTreeSet::new();
    for (name, value) in labels(&told) {
        seen.insert(name);
        let is_listed = match name {
            "method" => {
                let methods = [
                    "GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "other",
                ];
                methods.contains(&value) || meshwright_wire::methods().any(|it| it == value)
            }
            "route" => routes.contains(value),
            "status" => {
                ["successful", "failed"].contains(&value) || matches!(value.parse(), Ok(200..=599))
            }
            "code" => {
                meshwright_wire::Code::ALL
                    .iter()
                    .any(|code| code.word() == value)
                    || value == "none"
            }
            "version" => value == env!("CARGO_PKG_VERSION"),
            "le" => value == "+Inf" || value.parse::<f64>().is_ok(),
            "kind" => ["alone", "study"].contains(&value),
            "shelf" => shelves.contains(&value),
            "result" => ["arrived", "refused", "given_up"].contains(&value),
            "waits" => ["no", "yes"].contains(&value),
            _ => false,
        };
        assert!(is_listed, "{name} {:.100}", value);
    }
    assert!(
        seen.contains("method") && seen.contains("route"),
        "{seen:?}"
    );
    assert!(told.len() < 200_000, "{} bytes", told.len());
}
