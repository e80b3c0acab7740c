//! How the service looks from outside: links, headers, documentation, health.

use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

use jiff::Timestamp;
use meshwright::http::KeysRule;
use meshwright::jobs::Clock;
use meshwright_wire::Code;
use reqwest::{Method, StatusCode};
use serde_json::{Value, json};

use crate::bench::{Asked, Bench, RESULTS, submission};

#[tokio::test]
async fn every_link_bears_the_public_address() {
    let public = "https://gears.example/mesh";
    let (bench, mut engine) = Bench::steered_with(|config| {
        config.public_url = Some(public.to_owned());
        // Under a public name keys are needed, unless that is told.
        config.admission.keys = Some(KeysRule::None);
    })
    .await;
    let response = bench.post("/v1/jobs", &submission(1.0)).answer().await;
    let location = response.headers()["location"].to_str().unwrap().to_owned();
    let path = location.strip_prefix(public).unwrap();
    let job = response.document().await;
    for link in ["self", "results", "events", "cancel"] {
        assert!(
            job["links"][link]
                .as_str()
                .unwrap()
                .starts_with(&format!("{public}/v1/jobs/"))
        );
    }
    let work = engine.next().await;
    let problem: Value = bench.document(&format!("{path}/results")).await;
    assert_eq!(
        problem["type"],
        format!("{public}/problems/result-not-ready")
    );
    let nowhere: Value = bench.document("/nowhere").await;
    assert_eq!(nowhere["type"], format!("{public}/problems/not-found"));

    work.fail(meshwright_wire::Problem::new(Code::TimeLimit, "late"));
    assert_eq!(
        bench.ended(path).await["problem"]["type"],
        format!("{public}/problems/time-limit")
    );
    let openapi: Value = bench.document("/openapi.json").await;
    assert_eq!(openapi["servers"][0]["url"], public);
}

#[tokio::test]
async fn pages_of_the_given_origins_may_call() {
    let origin = "https://portal.example";
    let (bench, _engine) =
        Bench::steered_with(|config| config.cors_origin = vec![origin.parse().unwrap()]).await;
    let ask = async |origin: &str| {
        let preflight = bench.client.request(Method::OPTIONS, bench.url("/v1/jobs"));
        let preflight = preflight
            .header("origin", origin)
            .header("access-control-request-method", "POST");
        preflight
            .header("access-control-request-headers", "idempotency-key,prefer")
            .answer()
            .await
    };
    let answer = ask(origin).await;
    assert_eq!(answer.status(), StatusCode::OK);
    assert_eq!(answer.headers()["access-control-allow-origin"], origin);
    assert!(
        answer.headers()["access-control-allow-headers"]
            .to_str()
            .unwrap()
            .contains("idempotency-key")
    );
    assert!(
        !ask("https://other.example")
            .await
            .headers()
            .contains_key("access-control-allow-origin")
    );

    let refused = bench
        .get("/v1/jobs/1")
        .header("origin", origin)
        .answer()
        .await;
    assert_eq!(
        refused.headers()["access-control-allow-origin"],
        origin,
        "a page may read why it was refused"
    );
    assert!(
        refused.headers()["access-control-expose-headers"]
            .to_str()
            .unwrap()
            .contains("location")
    );
}

#[tokio::test]
async fn answers_bear_the_request_id_and_are_packed_for_who_asks() {
    let bench = Bench::quick().await;
    let response = bench
        .get("/health/live")
        .header("x-request-id", "portal-7")
        .answer()
        .await;
    assert_eq!(response.headers()["x-request-id"], "portal-7");
    let response = bench.get("/nowhere").answer().await;
    assert_eq!(response.headers()["x-request-id"].len(), 36);

    let path = bench.submit(&submission(1.0)).await;
    bench.ended(&path).await;
    let results = bench
        .get(&format!("{path}/results"))
        .header("accept-encoding", "gzip")
        .answer()
        .await;
    assert_eq!(results.headers()["content-encoding"], "gzip");
    assert!(results.bytes().await.unwrap().len() < RESULTS.len());
}

#[tokio::test]
async fn every_problem_has_its_page() {
    let bench = Bench::quick().await;
    let index = bench.get("/problems").whole_text().await;
    for code in Code::ALL {
        let page = bench
            .get(&format!("/problems/{}", code.slug()))
            .answer()
            .await;
        assert_eq!(page.status(), StatusCode::OK);
        assert!(page.whole_text().await.contains(code.explanation()));
        assert!(index.contains(code.slug()));
    }
}

#[tokio::test]
async fn the_documentation_needs_nothing_from_elsewhere() {
    let bench = Bench::quick().await;
    let page = bench.get("/docs/").answer().await;
    assert_eq!(page.status(), StatusCode::OK);
    assert!(!page.whole_text().await.contains("://"));
    let script = bench.get("/docs/swagger-initializer.js").whole_text().await;
    assert!(
        script.contains("../openapi.json") && script.contains("\"validatorUrl\": \"none\""),
        "{script}"
    );

    let openapi: Value = bench.document("/openapi.json").await;
    for path in [
        "/v1/jobs",
        "/v1/jobs/{id}",
        "/v1/jobs/{id}/results",
        "/v1/jobs/{id}/results/ste.csv",
        "/v1/jobs/{id}/events",
        "/v1/jobs/{id}/cancel",
        "/v1/validate",
        "/v1/preview",
        "/v1/examples",
        "/v1/limits",
        "/v1/quantities",
        "/problems/{slug}",
        "/health/live",
        "/health/ready",
        "/metrics",
    ] {
        let methods = openapi["paths"][path]
            .as_object()
            .unwrap_or_else(|| panic!("{path} is not described"));
        for operation in methods.values() {
            for (status, response) in operation["responses"].as_object().unwrap() {
                assert!(
                    !response["description"]
                        .as_str()
                        .unwrap_or_default()
                        .is_empty(),
                    "{path} {status}"
                );
            }
        }
    }
}

#[tokio::test]
async fn the_service_tells_its_health_and_numbers() {
    let bench = Bench::quick().await;
    assert_eq!(bench.get("/health/live").whole_text().await, "alive");
    let ready = bench.get("/health/ready").answer().await;
    assert_eq!(ready.status(), StatusCode::OK);
    assert_eq!(ready.document().await["workers"], 1);

    let path = bench.submit(&submission(1.0)).await;
    bench.ended(&path).await;
    let numbers = bench.get("/metrics").whole_text().await;
    for name in [
        "meshwright_jobs_waiting",
        "meshwright_jobs_running",
        "meshwright_http_request_duration_seconds_bucket",
    ] {
        assert!(numbers.contains(name), "{name}");
    }
    assert!(
        numbers.contains("meshwright_jobs_ended_total{status=\"successful\",method=\"flexible\""),
        "{numbers}"
    );
    assert!(
        numbers.contains("route=\"/v1/jobs/{id}\""),
        "ids make no series of their own"
    );
}

#[tokio::test]
async fn what_can_be_known_without_a_job_is_told() {
    let bench = Bench::quick().await;
    let examples: Value = bench.document("/v1/examples").await;
    for example in examples["items"].as_array().unwrap() {
        assert!(
            example["name"].is_string()
                && example["description"].is_string()
                && example["submission"].is_object()
        );
    }
    assert!(bench.document("/v1/limits").await.is_object());
    let quantities: Value = bench.document("/v1/quantities").await;
    let of_name = |name: &str| {
        let mut items = quantities["items"].as_array().unwrap().iter();
        items.find(|item| item["name"] == name).unwrap().clone()
    };
    assert_eq!(
        of_name("stress.driven.root_mpa"),
        json!({ "name": "stress.driven.root_mpa", "title": "Root stress of the driven gear", "symbol": "σ_root2", "unit": "MPa", "of": "curve", "gear": "driven",
            "better": "smaller", "needs": ["/stress"], "methods": ["flexible", "three_dimensional"] })
    );
    let backlash = of_name("backlash_mm");
    assert_eq!(
        [
            &backlash["of"],
            &backlash["gear"],
            &backlash["better"],
            &backlash["needs"]
        ],
        [&json!("pair"), &Value::Null, &Value::Null, &json!([])]
    );
    let valid = bench
        .post("/v1/validate", &submission(115.0))
        .document()
        .await;
    assert_eq!(valid["valid"], true);
    let list: Value = bench.document("/v1/jobs").await;
    assert_eq!(list["items"].as_array().unwrap().len(), 0);
}

#[tokio::test]
async fn the_date_of_an_answer_follows_a_clock_that_is_set_back() {
    let mut bench = Bench::quick().await;
    bench.shut_down().await;
    let hand = Arc::new(AtomicI64::new(1_000_000_000));
    let read = Arc::clone(&hand);
    let wall = move || Timestamp::from_second(read.load(Ordering::Relaxed)).unwrap();
    bench.clock = Clock::given(wall, Timestamp::now);
    bench.start_again().await;
    for (second, date) in [
        (1_000_000_000, "Sun, 09 Sep 2001 01:46:40 GMT"),
        (0, "Thu, 01 Jan 1970 00:00:00 GMT"),
    ] {
        hand.store(second, Ordering::Relaxed);
        for path in ["/health/live", "/v1/jobs", "/nowhere"] {
            let answer = bench.get(path).answer().await;
            assert_eq!(answer.headers()["date"], date, "{path}");
        }
    }
}

#[tokio::test]
async fn files_of_the_page_and_of_the_documentation_come_packed_as_they_were_built() {
    let bench = Bench::quick().await;
    for path in [
        "/",
        "/web/main.js",
        "/docs/",
        "/docs/swagger-ui-bundle.js",
        "/openapi.json",
        "/v1/examples",
        "/v1/quantities",
    ] {
        let plain = bench.get(path).answer().await;
        assert_eq!(plain.headers().get("content-encoding"), None);
        let tag = plain.headers()["etag"].clone();
        let known = bench.get(path).header("if-none-match", &tag).answer().await;
        assert_eq!(known.status(), StatusCode::NOT_MODIFIED, "{path}");
        let plain = plain.bytes().await.unwrap();
        let packed = bench
            .get(path)
            .header("accept-encoding", "gzip")
            .answer()
            .await;
        assert_eq!(packed.headers()["content-encoding"], "gzip", "{path}");
        assert_eq!(packed.headers()["vary"], "accept-encoding", "{path}");
        // Another form is another thing, as long as the tag is a strong one.
        assert_ne!(packed.headers()["etag"], tag);
        let packed = packed.bytes().await.unwrap();
        let mut unpacked = Vec::new();
        let mut decoder = flate2::read::GzDecoder::new(packed.as_ref());
        std::io::Read::read_to_end(&mut decoder, &mut unpacked).unwrap();
        assert_eq!(unpacked, plain, "{path}");
    }
}

#[tokio::test]
async fn an_answer_that_is_packed_has_another_tag_than_the_same_as_it_is_and_each_is_known() {
    let bench = Bench::quick().await;
    let job = bench.submit(&submission(1.0)).await;
    bench.ended(&job).await;
    let torques: Vec<f64> = (1..=40).map(f64::from).collect();
    let axes = json!([{ "path": "/output_torques_n_m/0", "values": torques }]);
    let study = json!({ "base": submission(1.0), "axes": axes });
    let study = bench.post("/v1/studies", &study).answer().await;
    let study = study.headers()["location"].to_str().unwrap().to_owned();
    bench.ended(&study).await;
    for path in [
        format!("{job}/results"),
        format!("{study}/results"),
        format!("{study}/results/table.csv"),
    ] {
        let get = async |takes: &str, known: Option<&str>| {
            let mut request = bench.get(&path).header("accept-encoding", takes);
            if let Some(known) = known {
                request = request.header("if-none-match", known);
            }
            let answer = request.answer().await;
            let tag = answer.headers()["etag"].to_str().unwrap().to_owned();
            let packed = answer.headers().contains_key("content-encoding");
            (answer.status().as_u16(), tag, packed)
        };
        let (plain, packed) = (get("identity", None).await, get("gzip", None).await);
        assert_eq!((plain.2, packed.2), (false, true), "{path}");
        assert_ne!(plain.1, packed.1, "{path}");
        for (takes, (_, tag, _)) in [("identity", &plain), ("gzip", &packed)] {
            let known = get(takes, Some(tag)).await;
            assert_eq!((known.0, &known.1), (304, tag), "{path}");
        }
    }
}

#[tokio::test]
async fn a_load_balancer_learns_of_the_health_by_a_bare_request() {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    let bench = Bench::quick().await;
    let ask = async |head: &str| {
        let address = bench.base.strip_prefix("http://").unwrap();
        let mut stream = tokio::net::TcpStream::connect(address).await.unwrap();
        stream
            .write_all(format!("{head}\r\n\r\n").as_bytes())
            .await
            .unwrap();
        let mut answer = vec![0; 12];
        stream.read_exact(&mut answer).await.unwrap();
        String::from_utf8(answer).unwrap()[9..].to_owned()
    };
    // HAProxy asks so unless it is told otherwise.
    assert_eq!(ask("OPTIONS /health/live HTTP/1.0").await, "405");
    assert_eq!(ask("GET /health/live HTTP/1.0").await, "200");
    assert_eq!(ask("GET /health/ready HTTP/1.0").await, "200");
    assert_eq!(ask("GET /v1/jobs HTTP/1.0").await, "400");
    assert_eq!(ask("GET /health/live HTTP/1.1").await, "400");
    let doubled = "GET /health/live HTTP/1.1\r\nhost: localhost\r\nhost: localhost";
    assert_eq!(ask(doubled).await, "400");
}

#[tokio::test]
async fn a_document_may_begin_with_a_byte_order_mark() {
    let bench = Bench::quick().await;
    let sent = async |path: &str, body: String| {
        let request = bench.send(path).header("content-type", "application/json");
        request.body(body).answer().await.status()
    };
    let marked = format!("\u{feff}{}", submission(1.0));
    assert_eq!(sent("/v1/jobs", marked.clone()).await, StatusCode::ACCEPTED);
    assert_eq!(sent("/v1/validate", marked.clone()).await, StatusCode::OK);
    let batch = format!("\u{feff}{}", json!({ "submissions": [submission(1.0)] }));
    assert_eq!(sent("/v1/jobs/batch", batch).await, StatusCode::ACCEPTED);
    // One, and at the beginning.
    assert_eq!(
        sent("/v1/jobs", format!("\u{feff}{marked}")).await,
        StatusCode::BAD_REQUEST
    );
}
