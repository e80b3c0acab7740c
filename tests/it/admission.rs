//! Who gets in: keys and what they open, names of the service, rates, and what no client sees of another.

use meshwright::http::KeysRule;
use meshwright::jobs::{Clock, KeyRecord, Role, Store};
use meshwright::keys::Key;
use reqwest::{Response, StatusCode};
use serde_json::{Value, json};

use crate::bench::{Asked, Bench, problem, submission};

/// Makes a key in the database of a service that runs, as `meshwright keys create` does.
pub(crate) async fn make_key(
    bench: &Bench,
    client: &str,
    role: Role,
    adjust: impl FnOnce(&mut KeyRecord),
) -> String {
    let store = Store::open(&bench.config.database).await.unwrap();
    let key = Key::random().unwrap();
    let mut record = KeyRecord {
        id: key.id().to_owned(),
        client: client.to_owned(),
        name: client.to_owned(),
        role,
        secret_hash: key.secret_hash(),
        requests_per_second: None,
        queue_limit: None,
        created_at: jiff::Timestamp::now(),
        expires_at: None,
        revoked_at: None,
    };
    adjust(&mut record);
    store.add_key(&record).await.unwrap();
    store.close().await;
    key.reveal()
}

pub(crate) async fn key_of(bench: &Bench, client: &str) -> String {
    make_key(bench, client, Role::Client, |_| {}).await
}

async fn get(bench: &Bench, path: &str, key: &str) -> Response {
    bench.get(path).bearer_auth(key).answer().await
}

async fn submit(bench: &Bench, key: &str, torque: f64) -> Response {
    let request = bench.post("/v1/jobs", &submission(torque)).bearer_auth(key);
    request.answer().await
}

#[tokio::test]
async fn keys_are_needed_as_soon_as_there_is_one() {
    let bench = Bench::quick().await;
    let before = bench.submit(&submission(1.0)).await;
    let key = key_of(&bench, "portal").await;

    let refused = bench.get("/v1/jobs").answer().await;
    assert!(
        refused.headers()["www-authenticate"]
            .to_str()
            .unwrap()
            .starts_with("Bearer")
    );
    problem(refused, 401, "unauthorized").await;
    for wrong in [
        "",
        "mw",
        "mw_0123456789abcdef_00",
        &key[..key.len() - 1],
        &key.replace("mw_", "mx_"),
    ] {
        problem(get(&bench, "/v1/jobs", wrong).await, 401, "unauthorized").await;
    }
    // The right form and the wrong secret, of a key that is there and of one that is not.
    let (start, _) = key.rsplit_once('_').unwrap();
    let secret = "0".repeat(64);
    let asked = get(&bench, "/v1/jobs", &format!("{start}_{secret}")).await;
    problem(asked, 401, "unauthorized").await;
    let asked = get(&bench, "/v1/jobs", &format!("mw_0123456789abcdef_{secret}")).await;
    problem(asked, 401, "unauthorized").await;

    assert_eq!(get(&bench, "/v1/jobs", &key).await.status(), StatusCode::OK);
    assert_eq!(
        submit(&bench, &key, 2.0).await.status(),
        StatusCode::ACCEPTED
    );
    problem(get(&bench, &before, &key).await, 404, "job_not_found").await;
    // The jobs from before there were keys are somebody's who has a key for them.
    let heir = key_of(&bench, "anonymous").await;
    assert_eq!(get(&bench, &before, &heir).await.status(), StatusCode::OK);
    for public in [
        "/health/live",
        "/health/ready",
        "/v1/limits",
        "/v1/quantities",
        "/v1/examples",
        "/openapi.json",
        "/problems",
        "/docs/",
        "/",
        "/web/main.js",
    ] {
        let answer = bench.get(public).answer().await;
        assert_eq!(answer.status(), StatusCode::OK, "{public}");
    }
    for closed in [
        "/v1/studies",
        "/v1/webhooks",
        "/metrics",
        "/v1/jobs/x/results",
    ] {
        let answer = bench.get(closed).answer().await;
        assert_eq!(answer.status(), StatusCode::UNAUTHORIZED, "{closed}");
    }
    let validate = bench.post("/v1/validate", &submission(1.0)).answer().await;
    assert_eq!(validate.status(), StatusCode::UNAUTHORIZED);
}

#[tokio::test]
async fn a_key_that_is_revoked_opens_nothing_from_that_moment_on() {
    let bench = Bench::quick().await;
    let key = key_of(&bench, "portal").await;
    assert_eq!(get(&bench, "/v1/jobs", &key).await.status(), StatusCode::OK);
    let store = Store::open(&bench.config.database).await.unwrap();
    let id = Key::parse(&key).unwrap().id().to_owned();
    assert!(store.revoke_key(&id, jiff::Timestamp::now()).await.unwrap());
    store.close().await;
    problem(get(&bench, "/v1/jobs", &key).await, 401, "unauthorized").await;
    // The last key that goes does not let everybody in.
    problem(bench.get("/v1/jobs"), 401, "unauthorized").await;
}

#[tokio::test]
async fn a_client_sees_and_touches_only_its_own() {
    let bench = Bench::quick().await;
    let (mine, other) = (key_of(&bench, "a").await, key_of(&bench, "b").await);
    let job = submit(&bench, &mine, 1.0).await.document().await;
    let study = json!({ "base": submission(1.0), "axes": [{ "path": "/output_torques_n_m/0", "values": [1, 2] }] });
    let study = bench
        .post("/v1/studies", &study)
        .bearer_auth(&mine)
        .answer()
        .await;
    let study = study.document().await;
    let links = |document: &Value| -> Vec<String> {
        let links = document["links"].as_object().unwrap();
        links
            .values()
            .map(|link| link.as_str().unwrap().to_owned())
            .collect()
    };
    for link in links(&job).into_iter().chain(links(&study)) {
        let answer = if link.ends_with("/cancel") {
            bench
                .post(&link, &json!({}))
                .bearer_auth(&other)
                .answer()
                .await
        } else {
            get(&bench, &link, &other).await
        };
        if link.contains('?') {
            let list = answer.document().await;
            assert_eq!(list["items"], json!([]), "{link}");
        } else {
            assert_eq!(answer.status(), StatusCode::NOT_FOUND, "{link}");
        }
    }
    let own = links(&job)[0].clone();
    problem(bench.delete(&own).bearer_auth(&other), 404, "job_not_found").await;
    // An equal submission of another client is computed for it, and tells nothing of the first.
    let theirs = submit(&bench, &other, 1.0).await.document().await;
    assert!(theirs["links"].get("same_as").is_none());
    for list in [
        "/v1/jobs?status=accepted,running,successful",
        "/v1/jobs",
        "/v1/studies",
    ] {
        let list = get(&bench, list, &other).await.document().await;
        let ids: Vec<&Value> = list["items"]
            .as_array()
            .unwrap()
            .iter()
            .map(|item| &item["id"])
            .collect();
        assert!(!ids.contains(&&job["id"]) && !ids.contains(&&study["id"]));
    }
}

#[tokio::test]
async fn a_reader_looks_and_changes_nothing_and_numbers_are_for_operators() {
    let bench = Bench::quick().await;
    let client = key_of(&bench, "portal").await;
    let reader = make_key(&bench, "portal", Role::Reader, |_| {}).await;
    let operator = make_key(&bench, "portal", Role::Operator, |_| {}).await;
    let job = submit(&bench, &client, 1.0).await.document().await;
    let path = job["links"]["self"].as_str().unwrap();
    assert_eq!(get(&bench, path, &reader).await.status(), StatusCode::OK);
    let validate = bench
        .post("/v1/validate", &submission(1.0))
        .bearer_auth(&reader);
    assert_eq!(validate.answer().await.status(), StatusCode::OK);
    problem(submit(&bench, &reader, 2.0).await, 403, "forbidden").await;
    problem(bench.delete(path).bearer_auth(&reader), 403, "forbidden").await;
    for key in [&client, &reader] {
        problem(get(&bench, "/metrics", key).await, 403, "forbidden").await;
    }
    assert_eq!(
        get(&bench, "/metrics", &operator).await.status(),
        StatusCode::OK
    );
}

#[tokio::test]
async fn who_asks_too_often_is_told_when_to_come_again_and_nobody_else_is() {
    let bench = Bench::quick().await;
    let busy = make_key(&bench, "busy", Role::Client, |record| {
        record.requests_per_second = Some(2)
    })
    .await;
    let calm = key_of(&bench, "calm").await;
    let mut refused = None;
    for _ in 0..20 {
        let answer = get(&bench, "/v1/jobs", &busy).await;
        if answer.status() != StatusCode::OK {
            refused = Some(answer);
            break;
        }
    }
    let refused = refused.expect("twenty requests are more than four");
    assert_eq!(refused.headers()["retry-after"], "1");
    problem(refused, 429, "rate_limited").await;
    assert_eq!(
        get(&bench, "/v1/jobs", &calm).await.status(),
        StatusCode::OK
    );
}

#[tokio::test]
async fn a_client_fills_its_part_of_the_queue_and_not_that_of_others() {
    let (bench, mut engine) = Bench::steered().await;
    let small = make_key(&bench, "small", Role::Client, |record| {
        record.queue_limit = Some(2)
    })
    .await;
    let other = key_of(&bench, "other").await;
    assert_eq!(
        submit(&bench, &other, 50.0).await.status(),
        StatusCode::ACCEPTED
    );
    let _work = engine.next().await;
    for torque in [1.0, 2.0] {
        assert_eq!(
            submit(&bench, &small, torque).await.status(),
            StatusCode::ACCEPTED
        );
    }
    problem(submit(&bench, &small, 3.0).await, 429, "client_queue_full").await;
    assert_eq!(
        submit(&bench, &other, 3.0).await.status(),
        StatusCode::ACCEPTED
    );
}

#[tokio::test]
async fn a_foreign_name_of_the_service_is_refused() {
    let bench = Bench::quick().await;
    let ask = async |host: &str| bench.get("/v1/jobs").header("host", host).answer().await;
    for host in ["localhost", "127.0.0.1:1", "[::1]:80"] {
        assert_eq!(ask(host).await.status(), StatusCode::OK, "{host}");
    }
    problem(ask("evil.example").await, 421, "host_not_allowed").await;
}

#[tokio::test]
async fn without_a_key_nobody_beyond_this_machine_gets_in() {
    let (bench, _engine) =
        Bench::steered_with(|config| config.listen = "0.0.0.0:0".parse().unwrap()).await;
    let base = bench.base.replace("0.0.0.0", "127.0.0.1");
    let answer = bench.client.get(format!("{base}/v1/jobs")).answer().await;
    problem(answer, 401, "unauthorized").await;
    let document = bench
        .client
        .get(format!("{base}/openapi.json"))
        .document()
        .await;
    assert_eq!(document["security"], json!([{ "key": [] }]));
}

#[tokio::test]
async fn answers_say_what_browsers_may_not_do_and_under_what_name_they_are_logged() {
    let bench = Bench::quick().await;
    let parent = "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01";
    let answer = bench
        .get("/v1/jobs")
        .header("x-request-id", "portal-7")
        .header("traceparent", parent)
        .answer()
        .await;
    let header = |name: &str| answer.headers()[name].to_str().unwrap().to_owned();
    assert_eq!(header("x-content-type-options"), "nosniff");
    assert_eq!(header("x-frame-options"), "DENY");
    assert_eq!(header("cache-control"), "no-store");
    assert!(header("content-security-policy").contains("frame-ancestors 'none'"));
    assert_eq!(header("x-request-id"), "portal-7");
    assert!(header("traceparent").starts_with("00-0af7651916cd43dd8448eb211c80319c-"));
    assert_ne!(header("traceparent"), parent);
    let odd = bench
        .get("/v1/jobs")
        .header("x-request-id", "a b\" c")
        .answer()
        .await;
    assert_ne!(odd.headers()["x-request-id"], "a b\" c");
}

#[tokio::test]
async fn numbers_and_health_may_have_a_listener_of_their_own() {
    let (bench, _engine) = Bench::steered_with(|config| {
        config.admission.metrics_listen = Some("127.0.0.1:0".parse().unwrap());
    })
    .await;
    problem(bench.get("/metrics"), 404, "not_found").await;
    let base = format!("http://{}", bench.service().metrics_address().unwrap());
    for path in ["/metrics", "/health/live", "/health/ready"] {
        let answer = bench.client.get(format!("{base}{path}")).answer().await;
        assert_eq!(answer.status(), StatusCode::OK, "{path}");
        // Nobody needs a key there: a page of a foreign name that leads there must not read it.
        let foreign = bench.client.get(format!("{base}{path}"));
        let asked = foreign.header("host", "evil.example");
        problem(asked, 421, "host_not_allowed").await;
    }
    let asked = bench.client.get(format!("{base}/v1/jobs"));
    problem(asked, 404, "not_found").await;
    let asked = bench.client.post(format!("{base}/metrics"));
    problem(asked, 405, "method_not_allowed").await;
}

#[tokio::test]
async fn behind_a_proxy_or_under_a_public_name_a_key_is_needed_though_it_listens_to_this_machine() {
    let bench = Bench::quick().await;
    let ask = async |header: &str| {
        let request = bench.get("/v1/jobs").header(header, "for=192.0.2.7");
        request.answer().await
    };
    assert_eq!(ask("accept").await.status(), StatusCode::OK);
    for header in [
        "forwarded",
        "via",
        "x-forwarded",
        "x-forwarded-for",
        "x-forwarded-host",
        "x-real-ip",
    ] {
        problem(ask(header).await, 401, "unauthorized").await;
    }
    let key = key_of(&bench, "portal").await;
    let known = bench.get("/v1/jobs").bearer_auth(&key);
    let known = known.header("x-forwarded-for", "192.0.2.7").answer().await;
    assert_eq!(known.status(), StatusCode::OK);

    for (keys, status) in [
        (None, 401),
        (Some(KeysRule::Required), 401),
        (Some(KeysRule::None), 200),
    ] {
        let (named, _engine) = Bench::steered_with(|config| {
            config.admission.allowed_hosts = vec!["gears.example".to_owned()];
            config.admission.keys = keys;
        })
        .await;
        let answer = named
            .get("/v1/jobs")
            .header("host", "gears.example")
            .answer()
            .await;
        assert_eq!(answer.status(), status, "{keys:?}");
    }
}

#[tokio::test]
async fn a_stream_ends_with_its_key() {
    let (bench, mut engine) = Bench::steered().await;
    let key = key_of(&bench, "portal").await;
    let taken = submit(&bench, &key, 1.0).await;
    let path = taken.headers()["location"].to_str().unwrap().to_owned();
    let _work = engine.next().await;
    let stream = bench.get(&format!("{path}/events")).bearer_auth(&key);
    let mut stream = stream.answer().await;
    assert!(stream.chunk().await.unwrap().is_some());
    let store = Store::open(&bench.config.database).await.unwrap();
    let id = key.split('_').nth(1).unwrap();
    assert!(store.revoke_key(id, jiff::Timestamp::now()).await.unwrap());
    store.close().await;
    // Nothing happens to the job meanwhile.
    while stream.chunk().await.unwrap().is_some() {}
}

#[tokio::test]
async fn who_waits_gets_no_results_once_its_key_is_revoked() {
    let (bench, mut engine) = Bench::steered().await;
    let key = key_of(&bench, "portal").await;
    let request = bench.post("/v1/jobs", &submission(1.0)).bearer_auth(&key);
    let request = request.header("prefer", "wait=60").send();
    let waiting = tokio::spawn(request);
    let work = engine.next().await;
    let store = Store::open(&bench.config.database).await.unwrap();
    let id = key.split('_').nth(1).unwrap();
    assert!(store.revoke_key(id, jiff::Timestamp::now()).await.unwrap());
    store.close().await;
    work.finish();
    let answer = waiting.await.unwrap().unwrap().document().await;
    assert_eq!(answer["status"], "successful");
    assert!(answer["results"].is_null(), "{answer}");
}

#[tokio::test]
async fn those_without_a_key_are_refused_when_they_ask_too_often_and_those_with_one_are_not() {
    let (bench, _engine) = Bench::steered_with(|config| {
        config.admission.keys = Some(KeysRule::Required);
        config.admission.requests_without_key = 1;
    })
    .await;
    let key = key_of(&bench, "portal").await;
    assert_eq!(get(&bench, "/v1/jobs", &key).await.status(), StatusCode::OK);
    let mut refused = None;
    for _ in 0..100 {
        let answer = bench.get("/web/main.js").answer().await;
        if answer.status() != StatusCode::OK {
            refused = Some(answer);
            break;
        }
    }
    let refused = refused.expect("a hundred at once are too many");
    assert_eq!(refused.headers()["connection"], "close");
    assert!(refused.headers().contains_key("retry-after"));
    problem(refused, 429, "rate_limited").await;
    for _ in 0..100 {
        assert_eq!(get(&bench, "/v1/jobs", &key).await.status(), StatusCode::OK);
        assert_eq!(
            bench.get("/health/ready").answer().await.status(),
            StatusCode::OK
        );
    }
}

#[tokio::test]
async fn a_key_opens_until_it_expires() {
    let mut bench = Bench::quick().await;
    let end = jiff::Timestamp::now() + jiff::SignedDuration::from_hours(1);
    let key = make_key(&bench, "visitor", Role::Client, |record| {
        record.expires_at = Some(end);
    })
    .await;
    assert_eq!(get(&bench, "/v1/jobs", &key).await.status(), StatusCode::OK);
    bench.shut_down().await;
    bench.clock = Clock::given(move || end, jiff::Timestamp::now);
    bench.start_again().await;
    problem(get(&bench, "/v1/jobs", &key).await, 401, "unauthorized").await;
    // It was made, so that not everybody is let in.
    problem(bench.get("/v1/jobs"), 401, "unauthorized").await;
}

#[tokio::test]
async fn the_log_says_which_key_did_what_and_not_its_secret() {
    let folder = tempfile::tempdir().unwrap();
    let program = || std::process::Command::new(env!("CARGO_BIN_EXE_meshwright"));
    let database = folder.path().join("log.db");
    let made = program()
        .args([
            "keys",
            "create",
            "portal",
            "--expires-in",
            "1h",
            "--database",
        ])
        .arg(&database)
        .output()
        .unwrap();
    let key = String::from_utf8(made.stdout).unwrap();
    let key = key.trim();
    let (id, secret) = key[3..].split_once('_').unwrap();
    let log = std::fs::File::create(folder.path().join("log")).unwrap();
    let mut service = program()
        .args(["serve", "--listen", "127.0.0.1:0", "--database"])
        .arg(&database)
        .env("MESHWRIGHT_LOG", "info")
        .stdout(std::process::Stdio::piped())
        .stderr(log)
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut output = std::io::BufReader::new(service.stdout.take().unwrap());
    std::io::BufRead::read_line(&mut output, &mut line).unwrap();
    let base = line
        .split_whitespace()
        .find(|word| word.starts_with("http://"));
    let base = base.unwrap().trim_end_matches([';', '/']);
    let answer = reqwest::Client::new()
        .delete(format!("{base}/v1/webhooks/no-id"))
        .bearer_auth(key);
    assert!(answer.answer().await.status().is_client_error());
    // The secret of a link stands in its address, and in no log of that.
    let shared = format!("mws_{}", "5ec2e7".repeat(11).split_at(64).0);
    for path in ["shared/{}", "shared/{}/results/ste.svg", "elsewhere/{}"] {
        let url = format!("{base}/{}", path.replace("{}", &shared));
        let answer = reqwest::Client::new().get(url).answer().await;
        assert!(answer.status().is_client_error());
    }
    service.kill().unwrap();
    service.wait().unwrap();
    let log = std::fs::read_to_string(folder.path().join("log")).unwrap();
    let told = |line: &&str| {
        ["DELETE", "/v1/webhooks/no-id", id, "portal", "status=4"]
            .iter()
            .all(|part| line.contains(part))
    };
    assert!(log.lines().any(|line| told(&line)), "{log}");
    assert!(!log.contains(secret));
    assert!(log.contains("/shared/mws_.../results/ste.svg"), "{log}");
    assert!(!log.contains(&shared), "{log}");
}
