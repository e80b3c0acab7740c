//! Requests that cannot be met: each gets a problem document, and none leaves anything behind.

use reqwest::{Method, Response, StatusCode};
use serde_json::Value;

use crate::bench::{Asked, Bench, problem, submission};

async fn send(bench: &Bench, body: impl Into<reqwest::Body>) -> Response {
    bench
        .send("/v1/jobs")
        .header("content-type", "application/json")
        .body(body)
        .answer()
        .await
}

#[tokio::test]
async fn bad_bodies_are_refused_and_leave_nothing_behind() {
    let bench = Bench::quick().await;
    let good = submission(115.0).to_string();
    let nested = format!(
        "{{\"method\":{}{}}}",
        "[".repeat(100_000),
        "]".repeat(100_000)
    );
    let bodies: Vec<Vec<u8>> = vec![
        b"".to_vec(),
        b"{".to_vec(),
        b"null".to_vec(),
        b"[]".to_vec(),
        b"\"text\"".to_vec(),
        b"{}".to_vec(),
        b"\xff\xfe".to_vec(),
        nested.into_bytes(),
        good.replacen('{', "{\"colour\":\"red\",", 1).into_bytes(),
        good.replacen('{', "{\"method\":\"flexible\",", 1)
            .into_bytes(),
        good.replace("115.0", "\"much\"").into_bytes(),
        good.replace("115.0", "NaN").into_bytes(),
        good.replace("115.0", "1e999").into_bytes(),
        format!("{good}{good}").into_bytes(),
    ];
    for body in bodies {
        let shown = String::from_utf8_lossy(&body[..body.len().min(80)]).into_owned();
        for path in ["/v1/jobs", "/v1/validate", "/v1/preview"] {
            let request = bench.send(path).header("content-type", "application/json");
            let response = request.body(body.clone()).answer().await;
            let status = response.status();
            assert!(matches!(status.as_u16(), 400 | 422), "{shown}: {status}");
            assert_eq!(
                response.headers()["content-type"],
                "application/problem+json",
                "{shown}"
            );
        }
    }
    let list: Value = bench.document("/v1/jobs").await;
    assert_eq!(list["items"].as_array().unwrap().len(), 0);
}

#[tokio::test]
async fn a_body_of_ten_megabytes_is_too_large() {
    let bench = Bench::quick().await;
    let asked = send(&bench, vec![b' '; 10_000_000]).await;
    problem(asked, 413, "payload_too_large").await;
    // Sent in chunks, its length is not known beforehand.
    let chunks =
        futures_util::stream::iter((0..100).map(|_| Ok::<_, std::io::Error>(vec![b' '; 100_000])));
    let asked = send(&bench, reqwest::Body::wrap_stream(chunks)).await;
    problem(asked, 413, "payload_too_large").await;
    let mut padded = " ".repeat(900_000);
    padded.push_str(&submission(115.0).to_string());
    assert_eq!(send(&bench, padded).await.status(), StatusCode::ACCEPTED);
}

#[tokio::test]
async fn only_json_is_read() {
    let bench = Bench::quick().await;
    let text = submission(115.0).to_string();
    for media_type in [
        None,
        Some("text/plain"),
        Some("application/x-www-form-urlencoded"),
        Some("application/jsonp"),
    ] {
        let mut request = bench.send("/v1/jobs").body(text.clone());
        if let Some(media_type) = media_type {
            request = request.header("content-type", media_type);
        }
        problem(request, 415, "unsupported_media_type").await;
    }
    let packed = bench
        .send("/v1/jobs")
        .header("content-type", "application/json");
    let asked = packed.header("content-encoding", "gzip").body(text.clone());
    problem(asked, 415, "unsupported_media_type").await;
    let request = bench
        .send("/v1/jobs")
        .header("content-type", "application/json; charset=utf-8");
    assert_eq!(
        request.body(text).answer().await.status(),
        StatusCode::ACCEPTED
    );
}

#[tokio::test]
async fn what_is_not_there_is_said_so() {
    let bench = Bench::quick().await;
    for path in [
        "/nowhere",
        "/v1",
        "/v1/jobs/",
        "/docs/nothing",
        "/problems/nothing",
        "/v1/jobs/%ff",
    ] {
        let response = bench.get(path).answer().await;
        assert!(matches!(response.status().as_u16(), 400 | 404), "{path}");
        assert_eq!(
            response.headers()["content-type"],
            "application/problem+json",
            "{path}"
        );
    }
    for path in [
        "/v1/jobs/1",
        "/v1/jobs/00000000-0000-0000-0000-000000000000",
    ] {
        problem(bench.get(path), 404, "job_not_found").await;
        problem(bench.delete(path), 404, "job_not_found").await;
        for part in ["results", "events", "results/ste.csv"] {
            problem(bench.get(&format!("{path}/{part}")), 404, "job_not_found").await;
        }
        problem(bench.cancel(path), 404, "job_not_found").await;
    }
}

#[tokio::test]
async fn a_method_that_is_not_taken_is_told_which_are() {
    let bench = Bench::quick().await;
    for (method, path, allowed) in [
        (Method::PUT, "/v1/jobs", "GET,HEAD,POST"),
        (Method::GET, "/v1/validate", "POST"),
        (Method::GET, "/v1/preview", "POST"),
        (Method::POST, "/v1/jobs/1/results", "GET,HEAD"),
    ] {
        let response = bench.client.request(method, bench.url(path)).answer().await;
        let mut methods: Vec<_> = response.headers()["allow"]
            .to_str()
            .unwrap()
            .split(',')
            .map(str::to_owned)
            .collect();
        methods.sort();
        assert_eq!(methods.join(","), allowed);
        problem(response, 405, "method_not_allowed").await;
    }
}

#[tokio::test]
async fn a_job_that_needs_more_memory_than_it_may_have_is_refused_wherever_it_comes_from() {
    let bench = Bench::start(
        |config| config.job_memory_mb = 1,
        std::sync::Arc::new(|_, _| unreachable!("nothing is computed")),
    )
    .await;
    let document = submission(115.0);
    let answer = bench.post("/v1/jobs", &document).answer().await;
    let told = problem(answer, 422, "too_large").await;
    assert!(told["detail"].as_str().unwrap().contains("1 MB"), "{told}");

    let batch = serde_json::json!({ "submissions": [document] });
    let told = problem(bench.post("/v1/jobs/batch", &batch), 422, "too_large").await;
    assert_eq!(told["errors"][0]["pointer"], "/submissions/0");

    let study = serde_json::json!({
        "base": document,
        "axes": [{ "path": "/pair/driven/blank/bore_radius_mm", "values": [15.0, 16.0] }],
    });
    let answer = bench.post("/v1/studies", &study).answer().await;
    let path = answer.headers()["location"].to_str().unwrap().to_owned();
    let table = bench.get(&format!("{path}/results")).answer().await;
    let table = table.document().await;
    for row in table["rows"].as_array().unwrap() {
        assert_eq!(row["problem"]["code"], "too_large", "{row}");
    }
}

#[tokio::test]
async fn a_number_of_a_query_that_is_none_is_refused_with_the_one_that_would_do() {
    let bench = Bench::quick().await;
    let results = "/v1/jobs/none/results";
    for (path, nearest) in [
        (format!("{results}/edges.json?torque=115,5"), "115.5"),
        (format!("{results}/edges.json?mesh_position=0,25"), "0.25"),
        (
            format!("{results}/fields.vtu?mesh_position=-1,5e-1"),
            "-0.15",
        ),
        (format!("{results}/contact-pattern.json?torque=7,5"), "7.5"),
        (format!("{results}/ste.csv?torque=7,5"), "7.5"),
        ("/v1/jobs?limit=2,4".to_owned(), "2"),
        ("/v1/studies?limit=10.0".to_owned(), "10"),
        ("/v1/projects?limit=3,0".to_owned(), "3"),
    ] {
        let told = problem(bench.get(&path), 400, "invalid_parameter").await;
        let detail = told["detail"].as_str().unwrap();
        assert!(
            detail.ends_with(&format!("{nearest} would do")),
            "{path}: {detail}"
        );
    }
    for name in ["tolerance", "bore_radius_mm"] {
        let path = format!("/v1/outline?{name}=0,01");
        let drawing = bench.send(&path).header("content-type", "image/vnd.dxf");
        let told = problem(drawing.body("0\nEOF\n"), 400, "invalid_parameter").await;
        let detail = told["detail"].as_str().unwrap();
        let begun = format!("{name}: ");
        assert!(
            detail.starts_with(&begun) && detail.ends_with("0.01 would do"),
            "{detail}"
        );
    }
    let path = format!("{results}/edges.json?torque=NaN");
    problem(bench.get(&path), 400, "invalid_parameter").await;
}
