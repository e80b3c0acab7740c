//! Webhooks: messages that arrive, are signed, are sent again, and go nowhere else.

use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use meshwright::jobs::{Clock, Role};

use meshwright::webhooks::HookRules;
use reqwest::StatusCode;
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpListener;

use crate::admission::{key_of, make_key};
use crate::bench::{Asked, Bench, PATIENCE, eventually, problem, results, submission};
use crate::stores;

/// A receiver that answers one request after the other with these statuses, and tells what it was sent.
async fn receiver(
    statuses: &'static [&'static str],
) -> (u16, tokio::sync::mpsc::UnboundedReceiver<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let port = listener.local_addr().unwrap().port();
    let (sender, received) = tokio::sync::mpsc::unbounded_channel();
    tokio::spawn(async move {
        for status in statuses {
            let (mut stream, _) = listener.accept().await.unwrap();
            let mut text = String::new();
            // Head and body are small; the body ends with the last brace.
            while !text.ends_with("}}") {
                let mut part = [0; 4096];
                let count = stream.read(&mut part).await.unwrap();
                text.push_str(std::str::from_utf8(&part[..count]).unwrap());
            }
            let answer =
                format!("HTTP/1.1 {status}\r\ncontent-length: 0\r\nconnection: close\r\n\r\n");
            stream.write_all(answer.as_bytes()).await.unwrap();
            sender.send(text).unwrap();
        }
    });
    (port, received)
}

/// A receiver that takes every connection and answers nothing.
async fn silent_receiver() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let port = listener.local_addr().unwrap().port();
    tokio::spawn(async move {
        let mut held = Vec::new();
        while let Ok((stream, _)) = listener.accept().await {
            held.push(stream);
        }
    });
    port
}

/// A service that may send to a port of this machine, which only a test may.
async fn bench(port: u16) -> Bench {
    bench_of(&[port], Clock::system()).await
}

/// The same with several ports, and a clock.
async fn bench_of(ports: &[u16], clock: Clock) -> Bench {
    let mut bench = Bench::quick().await;
    bench.shut_down().await;
    bench.clock = clock;
    let allowed = ports
        .iter()
        .map(|port| format!("http://localhost:{port}").parse().unwrap());
    bench.hooks = HookRules {
        allowed: allowed.collect(),
        reachable: Arc::new(|_: &str, address: IpAddr| address.is_loopback()),
    };
    bench.start_again().await;
    bench
}

async fn next(received: &mut tokio::sync::mpsc::UnboundedReceiver<String>) -> String {
    tokio::time::timeout(PATIENCE, received.recv())
        .await
        .expect("a message comes")
        .unwrap()
}

fn header<'a>(message: &'a str, name: &str) -> &'a str {
    let line = message
        .lines()
        .find(|line| line.to_ascii_lowercase().starts_with(&format!("{name}:")));
    line.unwrap().split_once(':').unwrap().1.trim()
}

#[tokio::test]
async fn what_an_administrator_ends_and_deletes_is_told_to_its_client() {
    let (port, mut received) = receiver(&["200 OK", "200 OK", "200 OK"]).await;
    let bench = bench(port).await;
    let portal = key_of(&bench, "portal").await;
    let key = make_key(&bench, "operations", Role::Administrator, |_| {}).await;
    let hook = json!({ "url": format!("http://localhost:{port}/hook") });
    let made = bench.post("/v1/webhooks", &hook).bearer_auth(&portal);
    assert_eq!(made.answer().await.status(), StatusCode::CREATED);
    let job = bench
        .post("/v1/jobs", &submission(1.0))
        .bearer_auth(&portal);
    let job = job.document().await;
    let mut data = async || {
        let message = next(&mut received).await;
        let body = message.split("\r\n\r\n").nth(1).unwrap();
        let body: Value = serde_json::from_str(body).unwrap();
        assert_eq!(body["data"]["id"], job["id"]);
        (body["type"].clone(), body["data"]["by"].clone())
    };
    assert_eq!(data().await, (json!("job.ended"), Value::Null));
    let path = job["links"]["self"].as_str().unwrap();
    let gone = bench.delete(path).bearer_auth(&key).answer().await;
    assert_eq!(gone.status(), StatusCode::NO_CONTENT);
    assert_eq!(data().await, (json!("job.deleted"), json!("administrator")));
}

#[tokio::test]
async fn the_end_of_a_job_and_of_a_study_is_told_and_signed() {
    let (port, mut received) = receiver(&["200 OK", "204 No Content"]).await;
    let bench = bench(port).await;
    let hook = json!({ "url": format!("http://localhost:{port}/hook?token=x") });
    let made = bench.post("/v1/webhooks", &hook).answer().await;
    assert_eq!(made.status(), StatusCode::CREATED);
    let made = made.document().await;
    assert!(made["secret"].as_str().unwrap().starts_with("whsec_"));
    let list = bench.job("/v1/webhooks").await;
    assert!(
        list["items"][0].get("secret").is_none(),
        "it is told once: {list}"
    );

    let job = bench.submit(&submission(1.0)).await;
    let message = next(&mut received).await;
    let body: Value = serde_json::from_str(message.split("\r\n\r\n").nth(1).unwrap()).unwrap();
    assert_eq!(body["type"], "job.ended");
    assert_eq!(body["data"]["status"], "successful");
    assert!(job.ends_with(body["data"]["id"].as_str().unwrap()));
    assert!(header(&message, "webhook-signature").starts_with("v1,"));
    assert!(header(&message, "webhook-timestamp").parse::<i64>().is_ok());
    assert!(message.starts_with("POST /hook?token=x "));

    let study = json!({ "base": submission(1.0), "axes": [{ "path": "/output_torques_n_m/0", "values": [5, 6] }] });
    bench.post("/v1/studies", &study).answer().await;
    let message = next(&mut received).await;
    assert!(
        message.contains("study.ended") && !message.contains("job.ended"),
        "one message for all of it: {message}"
    );
}

#[tokio::test]
async fn what_is_answered_from_earlier_results_has_an_end_that_is_told_at_once() {
    let (port, mut received) = receiver(&["200 OK"; 3]).await;
    let bench = bench(port).await;
    let first = bench.submit(&submission(5.0)).await;
    bench.ended(&first).await;
    let hook = json!({ "url": format!("http://localhost:{port}/") });
    bench.post("/v1/webhooks", &hook).answer().await;

    let again = bench.post("/v1/jobs", &submission(5.0)).answer().await;
    let again = again.document().await;
    assert_eq!(again["links"]["same_as"], first);
    let message = next(&mut received).await;
    assert!(message.contains(again["id"].as_str().unwrap()), "{message}");
    let study = json!({ "base": submission(1.0), "axes": [{ "path": "/output_torques_n_m/0", "values": [5] }] });
    let study = bench.post("/v1/studies", &study).answer().await;
    let study = study.document().await;
    let message = next(&mut received).await;
    assert!(message.contains("study.ended"), "{message}");
    assert!(message.contains(study["id"].as_str().unwrap()), "{message}");
}

#[tokio::test]
async fn however_many_clients_have_receivers_that_hang_another_one_is_told_at_once() {
    let hangs = silent_receiver().await;
    let (port, mut received) = receiver(&["200 OK"]).await;
    let mut bench = bench_of(&[hangs, port], Clock::system()).await;
    bench.times.webhook = Duration::from_secs(3600);
    bench.shut_down().await;
    bench.start_again().await;
    let good = key_of(&bench, "good").await;
    let send = async |path: &str, document: Value, key: &str| {
        let request = bench.post(path, &document).bearer_auth(key);
        let answer = request.answer().await;
        assert!(answer.status().is_success(), "{}", answer.status());
    };
    for number in 0..5 {
        let bad = key_of(&bench, &format!("bad {number}")).await;
        for i in 0..16 {
            let url = format!("http://localhost:{hangs}/{i}");
            send("/v1/webhooks", json!({ "url": url }), &bad).await;
        }
        for i in 0..10 {
            send("/v1/jobs", submission(1.0 + f64::from(i)), &bad).await;
        }
    }
    let url = format!("http://localhost:{port}/");
    send("/v1/webhooks", json!({ "url": url }), &good).await;
    send("/v1/jobs", submission(99.0), &good).await;
    // The other messages have an hour, so that this one comes beside them and not after them.
    let message = tokio::time::timeout(PATIENCE, received.recv());
    assert!(
        message.await.is_ok(),
        "before any of the others is given up"
    );
}

#[tokio::test]
async fn a_webhook_that_was_given_up_is_taken_up_again_with_what_waited() {
    let (port, mut received) = receiver(&["410 Gone", "200 OK", "200 OK"]).await;
    let bench = bench(port).await;
    let hook = json!({ "url": format!("http://localhost:{port}/") });
    let made = bench.post("/v1/webhooks", &hook).answer().await;
    let made = made.document().await;
    let path = format!("/v1/webhooks/{}", made["id"].as_str().unwrap());
    let post = async |what: &str| {
        let request = bench.send(&format!("{path}/{what}"));
        request.answer().await
    };
    bench.submit(&submission(1.0)).await;
    let first = next(&mut received).await;
    let becomes = async |path: &str, pointer: &str, value: &Value| {
        eventually(async || {
            let seen = bench.job(path).await;
            let is_there = seen.pointer(pointer) == Some(value);
            if is_there { Ok(()) } else { Err(seen) }
        })
        .await;
    };
    let list = format!("{path}/deliveries");
    becomes(&list, "/items/0/answered", &json!(410)).await;
    assert_eq!(bench.job(&list).await["items"][0]["status"], "waiting");
    problem(post("ping").await, 409, "webhook_disabled").await;

    let enabled = post("enable").await.document().await;
    assert_eq!(
        (&enabled["disabled_at"], &enabled["failures"]),
        (&Value::Null, &json!(0))
    );
    let again = next(&mut received).await;
    assert_eq!(header(&first, "webhook-id"), header(&again, "webhook-id"));
    becomes(&list, "/items/0/status", &json!("arrived")).await;

    // Another secret, and for a day the one before, too.
    let rotated = post("rotate").await.document().await;
    assert_ne!(rotated["secret"], made["secret"]);
    let ping = post("ping").await;
    assert_eq!(ping.status(), StatusCode::ACCEPTED);
    let ping = ping.document().await;
    let message = next(&mut received).await;
    assert_eq!(header(&message, "webhook-id"), ping["id"].as_str().unwrap());
    assert!(message.contains("webhook.ping"), "{message}");
    let signatures: Vec<_> = header(&message, "webhook-signature").split(' ').collect();
    assert_eq!(signatures.len(), 2, "{signatures:?}");
    assert!(
        signatures
            .iter()
            .all(|signature| signature.starts_with("v1,"))
    );
    assert_ne!(signatures[0], signatures[1]);
    becomes(&list, "/items/0/status", &json!("arrived")).await;
    let list = bench.job(&list).await;
    assert_eq!(list["items"].as_array().unwrap().len(), 2, "{list}");
    assert_eq!(
        (&list["items"][0]["type"], &list["items"][1]["attempts"]),
        (&json!("webhook.ping"), &json!(2))
    );
}

#[tokio::test]
async fn a_webhook_is_made_once_under_a_key_and_its_secret_told_again() {
    let bench = bench(1).await;
    let make = async |url: &str| {
        let request = bench
            .post("/v1/webhooks", &json!({ "url": url }))
            .header("idempotency-key", "k");
        request.answer().await
    };
    let first = make("http://localhost:1/a").await;
    assert_eq!(first.status(), StatusCode::CREATED);
    let first = first.document().await;
    let again = make("http://localhost:1/a").await;
    assert_eq!(again.status(), StatusCode::OK);
    let again = again.document().await;
    assert_eq!(
        (&first["id"], &first["secret"]),
        (&again["id"], &again["secret"])
    );
    let other = make("http://localhost:1/b").await;
    problem(other, 422, "idempotency_conflict").await;
    let list = bench.job("/v1/webhooks").await;
    assert_eq!(list["items"].as_array().unwrap().len(), 1);
}

#[tokio::test]
async fn patience_goes_by_the_clock_that_all_processes_share() {
    let (port, mut received) = receiver(&["500 Oops"]).await;
    // The clocks of this process are a year late; where there is one process, its own is the one that all share.
    let late = || Timestamp::now() - SignedDuration::from_hours(365 * 24);
    let bench = bench_of(&[port], Clock::given(late, late)).await;
    let hook = json!({ "url": format!("http://localhost:{port}/") });
    bench.post("/v1/webhooks", &hook).answer().await;
    bench.submit(&submission(1.0)).await;
    next(&mut received).await;
    let retry_at = eventually(async || {
        let list = bench.job("/v1/webhooks").await;
        let at = list["items"][0]["retry_at"]
            .as_str()
            .map(str::parse::<Timestamp>);
        at.ok_or(list)
    });
    let retry_at = retry_at.await.unwrap();
    let late = retry_at.duration_until(Timestamp::now()) > SignedDuration::from_hours(24);
    assert_eq!(late, !stores::on_postgres(), "{retry_at}");
}

#[tokio::test]
async fn a_message_that_is_refused_is_sent_again_under_the_same_name() {
    let (port, mut received) = receiver(&["500 Oops", "200 OK"]).await;
    let bench = bench(port).await;
    let hook = json!({ "url": format!("http://localhost:{port}/"), "events": ["job.ended"] });
    bench.post("/v1/webhooks", &hook).answer().await;
    bench.submit(&submission(1.0)).await;
    let first = next(&mut received).await;
    // Five seconds later, by the schedule.
    let second = next(&mut received).await;
    assert_eq!(header(&first, "webhook-id"), header(&second, "webhook-id"));
}

#[tokio::test]
async fn who_answers_that_it_is_gone_is_sent_nothing_more() {
    let (port, mut received) = receiver(&["410 Gone"]).await;
    let bench = bench(port).await;
    let hook = json!({ "url": format!("http://localhost:{port}/") });
    bench.post("/v1/webhooks", &hook).answer().await;
    bench.submit(&submission(1.0)).await;
    next(&mut received).await;
    let list = eventually(async || {
        let list = bench.job("/v1/webhooks").await;
        let is_disabled = list["items"][0]["disabled_at"].is_string();
        if is_disabled { Ok(list) } else { Err(list) }
    })
    .await;
    assert!(
        list["items"][0]["problem"]
            .as_str()
            .unwrap()
            .contains("410")
    );
    let id = list["items"][0]["id"].as_str().unwrap();
    let deleted = bench.delete(&format!("/v1/webhooks/{id}")).answer().await;
    assert_eq!(deleted.status(), StatusCode::NO_CONTENT);
    let asked = bench.delete(&format!("/v1/webhooks/{id}"));
    problem(asked, 404, "webhook_not_found").await;
}

#[tokio::test]
async fn a_name_that_leads_to_this_machine_is_sent_nothing() {
    // The name is allowed; it leads to this machine, which has to be named by its address.
    let (port, mut received) = receiver(&["200 OK"]).await;
    let mut bench = Bench::quick().await;
    bench.shut_down().await;
    bench.hooks = HookRules::to_named(vec![format!("http://localhost:{port}").parse().unwrap()]);
    bench.start_again().await;
    let hook = json!({ "url": format!("http://localhost:{port}/") });
    bench.post("/v1/webhooks", &hook).answer().await;
    bench.submit(&submission(1.0)).await;
    let told = eventually(async || {
        let list = bench.job("/v1/webhooks").await;
        let told = list["items"][0]["problem"].as_str().map(str::to_owned);
        told.ok_or(list)
    })
    .await;
    assert!(told.contains("no address that may be sent to"), "{told}");
    assert!(received.try_recv().is_err());
}

#[tokio::test]
async fn webhooks_are_off_unless_hosts_are_allowed_and_addresses_that_are_not_public_are_those_named()
 {
    let bench = Bench::quick().await;
    let make = async |bench: &Bench, url: &str| {
        bench
            .post("/v1/webhooks", &json!({ "url": url }))
            .answer()
            .await
    };
    let off = problem(
        make(&bench, "https://hooks.example.com/").await,
        422,
        "webhook_refused",
    )
    .await;
    assert!(off["detail"].as_str().unwrap().contains("off"));
    let bench = Bench::start(
        |config| {
            let hosts = ["hooks.example.com", "10.0.0.1", "http://*.254.169.254"];
            config.admission.webhook_hosts = hosts.map(|host| host.parse().unwrap()).to_vec();
        },
        Arc::new(|_, _| Ok(results())),
    )
    .await;
    for url in [
        "https://10.0.0.2/",
        "http://169.254.169.254/latest",
        "http://0xa9fea9fe/latest",
        "http://2852039166/latest",
        "https://evil.example/",
        "file:///etc/passwd",
    ] {
        problem(make(&bench, url).await, 422, "webhook_refused").await;
    }
    for url in ["https://hooks.example.com/", "https://10.0.0.1/"] {
        assert_eq!(
            make(&bench, url).await.status(),
            StatusCode::CREATED,
            "{url}"
        );
    }
}
