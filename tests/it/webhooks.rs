//! Webhooks: messages that arrive, are signed, are sent again, and go nowhere else.

use std::net::IpAddr;
use std::sync::Arc;

use meshwright::jobs::HookRules;
use reqwest::StatusCode;
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpListener;

use crate::bench::{Bench, PATIENCE, RESULTS, problem, submission};

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

/// A service that may send to a port of this machine, which only a test may.
async fn bench(port: u16) -> Bench {
    let mut bench = Bench::quick().await;
    bench.shut_down().await;
    bench.hooks = HookRules {
        allowed: vec![format!("http://localhost:{port}").parse().unwrap()],
        reachable: Arc::new(|address: IpAddr| address.is_loopback()),
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
async fn the_end_of_a_job_and_of_a_study_is_told_and_signed() {
    let (port, mut received) = receiver(&["200 OK", "204 No Content"]).await;
    let bench = bench(port).await;
    let hook = json!({ "url": format!("http://localhost:{port}/hook?token=x") });
    let made = bench.post("/v1/webhooks", &hook).send().await.unwrap();
    assert_eq!(made.status(), StatusCode::CREATED);
    let made: Value = made.json().await.unwrap();
    assert!(made["secret"].as_str().unwrap().starts_with("whsec_"));
    let list = bench.job("/v1/webhooks").await;
    assert!(
        list["items"][0].get("secret").is_none(),
        "it is told once: {list}"
    );

    let job = bench.submit(&submission(1.0)).await;
    let message = next(&mut received).await;
    let body: Value = serde_json::from_str(message.split("\r\n\r\n").nth(1).unwrap()).unwrap();
    assert_eq!(
        (body["type"].as_str(), body["data"]["status"].as_str()),
        (Some("job.ended"), Some("successful"))
    );
    assert!(job.ends_with(body["data"]["id"].as_str().unwrap()));
    assert!(header(&message, "webhook-signature").starts_with("v1,"));
    assert!(header(&message, "webhook-timestamp").parse::<i64>().is_ok());
    assert!(message.starts_with("POST /hook?token=x "));

    let study = json!({ "base": submission(1.0), "axes": [{ "path": "/output_torques_n_m/0", "values": [5, 6] }] });
    bench.post("/v1/studies", &study).send().await.unwrap();
    let message = next(&mut received).await;
    assert!(
        message.contains("study.ended") && !message.contains("job.ended"),
        "one message for all of it: {message}"
    );
}

#[tokio::test]
async fn a_message_that_is_refused_is_sent_again_under_the_same_name() {
    let (port, mut received) = receiver(&["500 Oops", "200 OK"]).await;
    let bench = bench(port).await;
    let hook = json!({ "url": format!("http://localhost:{port}/"), "events": ["job.ended"] });
    bench.post("/v1/webhooks", &hook).send().await.unwrap();
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
    bench.post("/v1/webhooks", &hook).send().await.unwrap();
    bench.submit(&submission(1.0)).await;
    next(&mut received).await;
    let disabled = async {
        loop {
            let list = bench.job("/v1/webhooks").await;
            if list["items"][0]["disabled_at"].is_string() {
                return list;
            }
            tokio::time::sleep(std::time::Duration::from_millis(10)).await;
        }
    };
    let list = tokio::time::timeout(PATIENCE, disabled).await.unwrap();
    assert!(
        list["items"][0]["problem"]
            .as_str()
            .unwrap()
            .contains("410")
    );
    let id = list["items"][0]["id"].as_str().unwrap();
    let deleted = bench
        .client
        .delete(bench.url(&format!("/v1/webhooks/{id}")))
        .send()
        .await
        .unwrap();
    assert_eq!(deleted.status(), StatusCode::NO_CONTENT);
    let again = bench
        .client
        .delete(bench.url(&format!("/v1/webhooks/{id}")))
        .send()
        .await
        .unwrap();
    problem(again, 404, "webhook_not_found").await;
}

#[tokio::test]
async fn a_name_that_leads_to_a_private_address_is_sent_nothing() {
    // The name is allowed; it leads to this machine, which is not public.
    let (port, mut received) = receiver(&["200 OK"]).await;
    let mut bench = Bench::quick().await;
    bench.shut_down().await;
    bench.hooks = HookRules::to_public(vec![format!("http://localhost:{port}").parse().unwrap()]);
    bench.start_again().await;
    let hook = json!({ "url": format!("http://localhost:{port}/") });
    bench.post("/v1/webhooks", &hook).send().await.unwrap();
    bench.submit(&submission(1.0)).await;
    let told = async {
        loop {
            let list = bench.job("/v1/webhooks").await;
            if let Some(told) = list["items"][0]["problem"].as_str() {
                return told.to_owned();
            }
            tokio::time::sleep(std::time::Duration::from_millis(10)).await;
        }
    };
    let told = tokio::time::timeout(PATIENCE, told).await.unwrap();
    assert!(told.contains("no public address"), "{told}");
    assert!(received.try_recv().is_err());
}

#[tokio::test]
async fn webhooks_are_off_unless_hosts_are_allowed_and_private_addresses_never_are() {
    let bench = Bench::quick().await;
    let make = async |bench: &Bench, url: &str| {
        bench
            .post("/v1/webhooks", &json!({ "url": url }))
            .send()
            .await
            .unwrap()
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
            let hosts = ["hooks.example.com", "10.0.0.1", "http://169.254.169.254"];
            config.door.webhook_hosts = hosts.map(|host| host.parse().unwrap()).to_vec();
        },
        Arc::new(|_, _| Ok(RESULTS.to_owned())),
    )
    .await;
    for url in [
        "https://10.0.0.1/",
        "http://169.254.169.254/latest",
        "https://evil.example/",
        "file:///etc/passwd",
    ] {
        problem(make(&bench, url).await, 422, "webhook_refused").await;
    }
    assert_eq!(
        make(&bench, "https://hooks.example.com/").await.status(),
        StatusCode::CREATED
    );
}
