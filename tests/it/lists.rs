//! Lists of jobs.

use reqwest::Response;
use serde_json::json;

use crate::bench::{Asked, Bench, problem, submission};

async fn list(bench: &Bench, query: &str) -> Response {
    bench.get(&format!("/v1/jobs{query}")).answer().await
}

async fn ids(bench: &Bench, query: &str) -> Vec<String> {
    let list = list(bench, query).await.document().await;
    list["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|job| job["links"]["self"].as_str().unwrap().to_owned())
        .collect()
}

#[tokio::test]
async fn pages_hold_every_job_once_newest_first_also_when_new_ones_come() {
    let (bench, mut engine) = Bench::steered().await;
    let mut submitted = Vec::new();
    for torque in 1..=5 {
        submitted.push(bench.submit(&submission(f64::from(torque))).await);
    }
    let _running = engine.next().await;
    submitted.reverse();

    let (mut found, mut query) = (Vec::new(), "?limit=2".to_owned());
    loop {
        let response = list(&bench, &query).await;
        let link = response
            .headers()
            .get("link")
            .map(|link| link.to_str().unwrap().to_owned());
        let page = response.document().await;
        for job in page["items"].as_array().unwrap() {
            assert!(job.get("submission").is_none(), "a list is small");
            found.push(job["links"]["self"].as_str().unwrap().to_owned());
        }
        let Some(next) = page["next"].as_str() else {
            assert_eq!(link, None);
            break;
        };
        query = format!("?limit=2&cursor={next}");
        assert_eq!(link.unwrap(), format!("</v1/jobs{query}>; rel=\"next\""));
        bench.submit(&submission(100.0 + found.len() as f64)).await;
    }
    assert_eq!(found, submitted);
}

#[tokio::test]
async fn a_list_is_selected_by_state_tag_and_id() {
    let (bench, mut engine) = Bench::steered().await;
    let mut tagged = submission(1.0);
    tagged["tags"] = json!(["case 2", "a,b"]);
    let first = bench.submit(&tagged).await;
    let work = engine.next().await;
    let second = bench.submit(&submission(2.0)).await;

    assert_eq!(ids(&bench, "?status=running").await, [first.as_str()]);
    assert_eq!(
        ids(&bench, "?status=accepted,running").await,
        [second.as_str(), &first]
    );
    assert!(ids(&bench, "?status=failed").await.is_empty());
    assert_eq!(ids(&bench, "?tag=case%202").await, [first.as_str()]);
    assert_eq!(ids(&bench, "?tag=a%2Cb").await, [first.as_str()]);
    assert!(ids(&bench, "?tag=a").await.is_empty());
    let id = |path: &str| path.rsplit('/').next().unwrap().to_owned();
    let unknown = "00000000-0000-0000-0000-000000000000";
    assert_eq!(
        ids(&bench, &format!("?ids={},{unknown}", id(&first))).await,
        [first.as_str()]
    );
    assert!(ids(&bench, "?ids=").await.is_empty());
    work.finish();
    bench.ended(&first).await;
    assert_eq!(
        ids(
            &bench,
            &format!("?status=successful&ids={},{}", id(&first), id(&second))
        )
        .await,
        [first.as_str()]
    );
    drop(engine);
}

#[tokio::test]
async fn parameters_that_are_not_understood_are_refused() {
    let bench = Bench::quick().await;
    let many = format!(
        "?ids={}",
        vec!["00000000-0000-0000-0000-000000000000"; 201].join(",")
    );
    for query in [
        "?limit=0",
        "?limit=201",
        "?limit=-1",
        "?limit=x",
        "?status=done",
        "?ids=1",
        "?cursor=x",
        "?colour=red",
        &many,
    ] {
        problem(list(&bench, query).await, 400, "invalid_parameter").await;
    }
}

#[tokio::test]
async fn a_text_with_a_character_nul_is_refused_by_either_store() {
    let bench = Bench::quick().await;
    for query in [
        "/v1/jobs?tag=%00",
        "/v1/jobs?tag=a%00b",
        "/v1/studies?name=%00",
        "/v1/studies?tag=%00",
    ] {
        problem(bench.get(query), 400, "invalid_parameter").await;
    }
}
