//! What operators look at: the dashboard and the alerts that ship ask for numbers that there are.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::bench::{Asked, Bench, Said, submission};

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
    let told = bench.get("/metrics").answer().await.body().await;
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
    let told = told.body().await;
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
