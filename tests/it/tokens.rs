//! Tokens of an identity provider, which here is a listener of the test: what is accepted, and what is not.

use std::sync::atomic::{AtomicI64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::response::{IntoResponse, Redirect, Response as Answer};
use axum::routing::get;
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD as BASE64;
use futures_util::StreamExt;
use futures_util::stream::FuturesUnordered;
use jiff::{SignedDuration, Timestamp};
use meshwright::config::Config;
use meshwright::jobs::Clock;
use reqwest::{Response, StatusCode};
use ring::rand::SystemRandom;
use ring::signature::{ECDSA_P256_SHA256_FIXED_SIGNING, EcdsaKeyPair, KeyPair};
use serde_json::{Value, json};
use tokio::net::TcpListener;
use tokio::task::JoinHandle;

use crate::admission::key_of;
use crate::bench::{Asked, Bench, PATIENCE, problem, submission};
use crate::process::{LITTLE, LITTLE_MB, Process};
use crate::stores;

/// The audience of the service's tokens.
const AUDIENCE: &str = "gears";

/// A key that signs, by a name.
struct Signer {
    name: String,
    pair: EcdsaKeyPair,
}

impl Signer {
    fn new(name: &str) -> Self {
        let random = SystemRandom::new();
        let kind = &ECDSA_P256_SHA256_FIXED_SIGNING;
        let document = EcdsaKeyPair::generate_pkcs8(kind, &random).unwrap();
        Self {
            name: name.to_owned(),
            pair: EcdsaKeyPair::from_pkcs8(kind, document.as_ref(), &random).unwrap(),
        }
    }

    fn public(&self) -> Value {
        let (x, y) = self.pair.public_key().as_ref()[1..].split_at(32);
        json!({ "kty": "EC", "crv": "P-256", "alg": "ES256", "use": "sig", "kid": self.name,
                "x": BASE64.encode(x), "y": BASE64.encode(y) })
    }

    fn sign(&self, head: &Value, claims: &[u8]) -> String {
        let message = message(head, claims);
        let signature = self.pair.sign(&SystemRandom::new(), message.as_bytes());
        format!("{message}.{}", BASE64.encode(signature.unwrap()))
    }

    /// A token of this key with `claims`.
    fn token(&self, claims: &Value) -> String {
        let head = json!({ "alg": "ES256", "typ": "JWT", "kid": self.name });
        self.sign(&head, claims.to_string().as_bytes())
    }
}

fn message(head: &Value, claims: &[u8]) -> String {
    format!(
        "{}.{}",
        BASE64.encode(head.to_string()),
        BASE64.encode(claims)
    )
}

/// What the provider answers when it is asked for its keys.
#[derive(Clone)]
enum Keys {
    These(Vec<Value>),
    Nothing,
    /// No answer until other keys are given.
    Silent,
    /// Text without an end.
    Endless,
    /// Another address, which has them.
    Elsewhere(Vec<Value>),
}

/// An identity provider on the loopback.
struct Provider {
    issuer: String,
    keys: Arc<Mutex<Keys>>,
    asked: Arc<AtomicUsize>,
}

impl Provider {
    async fn with(keys: Keys) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let issuer = format!("http://{}/realm", listener.local_addr().unwrap());
        let keys = Arc::new(Mutex::new(keys));
        let asked = Arc::new(AtomicUsize::new(0));
        let discovery =
            json!({ "issuer": issuer, "jwks_uri": issuer.replace("/realm", "/keys") }).to_string();
        let answer = {
            let (keys, asked) = (Arc::clone(&keys), Arc::clone(&asked));
            async move |moved: bool| -> Answer {
                asked.fetch_add(1, Ordering::SeqCst);
                let now = || keys.lock().unwrap().clone();
                while matches!(now(), Keys::Silent) {
                    tokio::time::sleep(Duration::from_millis(10)).await;
                }
                match now() {
                    Keys::Silent => StatusCode::SERVICE_UNAVAILABLE.into_response(),
                    Keys::These(keys) => json!({ "keys": keys }).to_string().into_response(),
                    Keys::Elsewhere(keys) if moved => {
                        json!({ "keys": keys }).to_string().into_response()
                    }
                    Keys::Elsewhere(_) => Redirect::temporary("/moved").into_response(),
                    Keys::Nothing => StatusCode::SERVICE_UNAVAILABLE.into_response(),
                    Keys::Endless => {
                        let text = futures_util::stream::repeat_with(|| {
                            Ok::<_, std::convert::Infallible>(" ".repeat(4096))
                        });
                        Body::from_stream(text).into_response()
                    }
                }
            }
        };
        let moved = answer.clone();
        let router = Router::new()
            .route(
                "/realm/.well-known/openid-configuration",
                get(async move || discovery),
            )
            .route("/keys", get(async move || answer(false).await))
            .route("/moved", get(async move || moved(true).await));
        tokio::spawn(async move { axum::serve(listener, router).await });
        Self {
            issuer,
            keys,
            asked,
        }
    }

    fn give(&self, keys: Keys) {
        *self.keys.lock().unwrap() = keys;
    }

    /// How often it was asked for its keys.
    fn asked(&self) -> usize {
        self.asked.load(Ordering::SeqCst)
    }

    /// The claims of a good token for a client, with an hour to live.
    fn claims(&self, client: &str) -> Value {
        let now = Timestamp::now().as_second();
        json!({ "iss": self.issuer, "aud": AUDIENCE, "sub": client, "iat": now, "exp": now + 3600 })
    }

    fn configure(&self, config: &mut Config) {
        config.oidc.oidc_issuer = Some(self.issuer.parse().unwrap());
        config.oidc.oidc_audience = Some(AUDIENCE.to_owned());
        config.oidc.oidc_algorithm = vec![jsonwebtoken::Algorithm::ES256];
        config.oidc.oidc_operator_claim =
            Some("/realm_access/roles=gear-operator".parse().unwrap());
    }
}

/// A provider with a key, and a service that trusts it.
async fn trusting() -> (Bench, Provider, Signer) {
    let signer = Signer::new("first");
    let provider = Provider::with(Keys::These(vec![signer.public()])).await;
    let bench = Bench::start(
        |config| provider.configure(config),
        Arc::new(|_, _| Ok(crate::bench::results())),
    )
    .await;
    (bench, provider, signer)
}

async fn with(bench: &Bench, path: &str, credential: &str) -> Response {
    let request = bench.get(path).bearer_auth(credential);
    request.answer().await
}

/// Clocks that a test sets forward.
#[derive(Clone, Default)]
struct Ahead(Arc<AtomicI64>);

impl Ahead {
    fn go(&self, seconds: i64) {
        self.0.fetch_add(seconds, Ordering::SeqCst);
    }

    async fn rule(&self, bench: &mut Bench) {
        let ahead = self.clone();
        let now =
            move || Timestamp::now() + SignedDuration::from_secs(ahead.0.load(Ordering::SeqCst));
        bench.shut_down().await;
        bench.clock = Clock::given(now.clone(), now);
        bench.start_again().await;
    }
}

#[tokio::test]
async fn a_token_opens_the_door_for_its_client_beside_keys() {
    let (bench, provider, signer) = trusting().await;
    let (ada, eve) = (
        signer.token(&provider.claims("ada")),
        signer.token(&provider.claims("eve")),
    );
    let made = bench.post("/v1/jobs", &submission(1.0)).bearer_auth(&ada);
    let made = made.answer().await;
    assert_eq!(made.status(), StatusCode::ACCEPTED);
    let path = made.headers()["location"].to_str().unwrap().to_owned();
    let key = key_of(&bench, "ada").await;
    for credential in [&ada, &key] {
        assert_eq!(
            with(&bench, &path, credential).await.status(),
            StatusCode::OK
        );
    }
    problem(with(&bench, &path, &eve).await, 404, "job_not_found").await;
    problem(bench.get(&path), 401, "unauthorized").await;

    let document: Value = bench.document("/openapi.json").await;
    assert_eq!(
        document["security"],
        json!([{ "key": [] }, { "token": [] }])
    );
    let scheme = &document["components"]["securitySchemes"]["token"];
    assert_eq!(
        (&scheme["type"], &scheme["scheme"], &scheme["bearerFormat"]),
        (&json!("http"), &json!("bearer"), &json!("JWT"))
    );
}

#[tokio::test]
async fn who_names_an_issuer_wants_to_know_everybody() {
    let (bench, ..) = trusting().await;
    problem(bench.get("/v1/jobs"), 401, "unauthorized").await;
    // And without one a token is no key.
    let bench = Bench::quick().await;
    let token = Signer::new("k").token(&json!({}));
    problem(with(&bench, "/v1/jobs", &token).await, 401, "unauthorized").await;
}

#[tokio::test]
async fn the_claim_that_the_operator_says_names_the_user() {
    let signer = Signer::new("first");
    let provider = Provider::with(Keys::These(vec![signer.public()])).await;
    let bench = Bench::start(
        |config| {
            provider.configure(config);
            config.oidc.oidc_user_claim = Some("/person/login".parse().unwrap());
        },
        Arc::new(|_, _| Ok(crate::bench::results())),
    )
    .await;
    let claims = |person: Value| {
        let mut claims = provider.claims("works");
        claims["person"] = person;
        signer.token(&claims)
    };
    let submit = |token: &str| bench.post("/v1/jobs", &submission(1.0)).bearer_auth(token);
    let ada = claims(json!({ "login": "ada" }));
    let told = submit(&ada).document().await;
    assert_eq!(told["submitted_by"], "ada");
    let told = submit(&claims(json!({}))).document().await;
    assert_eq!(told["submitted_by"], Value::Null, "a program has no user");
    problem(
        submit(&claims(json!({ "login": "a b" }))),
        401,
        "unauthorized",
    )
    .await;
    let other = submit(&ada).header("meshwright-user", "bob");
    problem(other, 422, "conflicting_fields").await;
}

#[tokio::test]
async fn the_claim_that_the_operator_says_makes_an_operator() {
    let (bench, provider, signer) = trusting().await;
    let mut claims = provider.claims("ada");
    for (roles, status) in [
        (json!(["user", "gear-operator"]), StatusCode::OK),
        (json!("gear-operator"), StatusCode::OK),
        (json!(["gear-operators"]), StatusCode::FORBIDDEN),
        (json!({ "gear-operator": true }), StatusCode::FORBIDDEN),
        (Value::Null, StatusCode::FORBIDDEN),
    ] {
        claims["realm_access"] = json!({ "roles": roles });
        let answer = with(&bench, "/metrics", &signer.token(&claims)).await;
        assert_eq!(answer.status(), status, "{claims}");
    }
}

#[tokio::test]
async fn hostile_tokens_open_nothing_and_are_told_why() {
    let (bench, provider, signer) = trusting().await;
    let now = Timestamp::now().as_second();
    let good = provider.claims("ada");
    let changed = |name: &str, value: Value| {
        let mut claims = good.clone();
        match value {
            Value::Null => claims.as_object_mut().unwrap().remove(name),
            value => claims
                .as_object_mut()
                .unwrap()
                .insert(name.to_owned(), value),
        };
        claims
    };
    // What is at the edge is taken.
    for claims in [
        good.clone(),
        changed("aud", json!(["other", AUDIENCE])),
        changed("exp", json!(now - 20)),
        changed("exp", json!(now as f64 + 60.5)),
        changed("exp", json!(9e15)),
        changed("nbf", json!(now + 20)),
        changed("sub", json!("é".repeat(100))),
    ] {
        let answer = with(&bench, "/v1/jobs", &signer.token(&claims)).await;
        assert_eq!(answer.status(), StatusCode::OK, "{claims}");
    }

    let head = |adjust: Value| {
        let mut head = json!({ "alg": "ES256", "typ": "JWT", "kid": "first" });
        for (name, value) in adjust.as_object().unwrap() {
            match value {
                Value::Null => head.as_object_mut().unwrap().remove(name),
                value => head
                    .as_object_mut()
                    .unwrap()
                    .insert(name.clone(), value.clone()),
            };
        }
        head
    };
    let text = good.to_string();
    let signed = |adjust: Value| signer.sign(&head(adjust), text.as_bytes());
    let unsigned = |algorithm: &str, signature: &str| {
        let message = message(&head(json!({ "alg": algorithm })), text.as_bytes());
        format!("{message}.{signature}")
    };
    // The public key, which everybody has, as if it were a secret.
    let by_the_public_key = {
        use hmac::{Hmac, KeyInit, Mac};
        let message = message(&head(json!({ "alg": "HS256" })), text.as_bytes());
        let secret = signer.pair.public_key();
        let mut mac = Hmac::<sha2::Sha256>::new_from_slice(secret.as_ref()).unwrap();
        mac.update(message.as_bytes());
        format!("{message}.{}", BASE64.encode(mac.finalize().into_bytes()))
    };
    let other = Signer::new("first");
    let with_a_key = head(json!({ "jwk": other.public() }));
    let whole = signer.token(&good);
    #[rustfmt::skip]
    let cases = [
        ("alg none", unsigned("none", "")),
        ("alg NONE", unsigned("NONE", "")),
        ("no signature", unsigned("ES256", "")),
        ("HS256 by the public key", by_the_public_key),
        ("an algorithm not allowed", signed(json!({ "alg": "ES384" }))),
        ("an algorithm of another key", signed(json!({ "alg": "RS256" }))),
        ("signed by somebody else", other.token(&good)),
        ("brings its own key", other.sign(&with_a_key, text.as_bytes())),
        ("no kid", signed(json!({ "kid": null }))),
        ("an empty kid", signed(json!({ "kid": "" }))),
        ("a kid that is no text", signed(json!({ "kid": 1 }))),
        ("a kid that nobody has", signed(json!({ "kid": "../../first" }))),
        ("crit", signed(json!({ "crit": ["exp"] }))),
        ("an empty crit", signed(json!({ "crit": [] }))),
        ("for a log-out", signed(json!({ "typ": "logout+jwt" }))),
        ("another issuer", signer.token(&changed("iss", json!("https://evil.example")))),
        ("the issuer with a slash", signer.token(&changed("iss", json!(format!("{}/", provider.issuer))))),
        ("issuers", signer.token(&changed("iss", json!([provider.issuer, "x"])))),
        ("no issuer", signer.token(&changed("iss", Value::Null))),
        ("another audience", signer.token(&changed("aud", json!("gears2")))),
        ("two audiences", signer.token(&changed("aud", json!(["a", "b"])))),
        ("no audiences", signer.token(&changed("aud", json!([])))),
        ("no audience", signer.token(&changed("aud", Value::Null))),
        ("expired", signer.token(&changed("exp", json!(now - 60)))),
        ("an end beyond all numbers", signer.token(&changed("exp", json!(1e300)))),
        ("expired long ago", signer.token(&changed("exp", json!(-1e300)))),
        ("no end", signer.token(&changed("exp", Value::Null))),
        ("an end in words", signer.token(&changed("exp", json!("4102444800")))),
        ("not yet", signer.token(&changed("nbf", json!(now + 90)))),
        ("a beginning in words", signer.token(&changed("nbf", json!("0")))),
        ("no client", signer.token(&changed("sub", Value::Null))),
        ("a client that is a number", signer.token(&changed("sub", json!(7)))),
        ("a client that is a list", signer.token(&changed("sub", json!(["ada"])))),
        ("an empty client", signer.token(&changed("sub", json!("")))),
        ("a long client", signer.token(&changed("sub", json!("a".repeat(101))))),
        ("a client with NUL", signer.token(&changed("sub", json!("ada\u{0}")))),
        ("a client with a line", signer.token(&changed("sub", json!("ada\nroot")))),
        ("oversized", signer.token(&changed("more", json!("a".repeat(20_000))))),
        ("claims that are no object", signer.sign(&head(json!({})), b"[]")),
        ("claims that are no JSON", signer.sign(&head(json!({})), b"\xff{")),
        ("an issuer twice", signer.sign(&head(json!({})), text.replacen('{', "{\"iss\":\"x\",", 1).as_bytes())),
        (
            "deep claims",
            signer.sign(
                &head(json!({})),
                format!("{{\"a\":{}1{}}}", "[".repeat(3000), "]".repeat(3000)).as_bytes(),
            ),
        ),
        ("cut off", whole[..whole.len() - 1].to_owned()),
        ("a fourth part", format!("{whole}.x")),
        ("two parts", whole.rsplit_once('.').unwrap().0.to_owned()),
        ("padded", format!("{whole}==")),
        ("as a key", format!("mw_{whole}")),
    ];
    for (what, token) in cases {
        let refused = problem(with(&bench, "/v1/jobs", &token).await, 401, "unauthorized").await;
        let detail = refused["detail"].as_str().unwrap();
        assert!(detail.contains("token"), "{what}: {detail}");
        assert!(!detail.contains(&token), "{what}: {detail}");
    }
    // Twice, each good: nobody knows which one a proxy has looked at.
    let twice = bench
        .get("/v1/jobs")
        .bearer_auth(&whole)
        .bearer_auth(&whole);
    problem(twice, 401, "unauthorized").await;
}

#[tokio::test]
async fn keys_that_nobody_has_are_asked_for_once_in_five_seconds_and_new_ones_are_found() {
    let (mut bench, provider, first) = trusting().await;
    let ahead = Ahead::default();
    ahead.rule(&mut bench).await;
    let status = async |signer: &Signer| {
        let token = signer.token(&provider.claims("ada"));
        with(&bench, "/v1/jobs", &token).await.status()
    };
    assert_eq!(status(&first).await, StatusCode::OK);
    let before = provider.asked();
    for i in 0..50 {
        let unknown = Signer::new(&format!("unknown-{i}"));
        assert_eq!(status(&unknown).await, StatusCode::UNAUTHORIZED);
    }
    assert_eq!(provider.asked(), before, "the five seconds are not over");
    // The provider changes its key. Who comes first has it fetched, others who come meanwhile wait for that.
    let second = Signer::new("second");
    provider.give(Keys::These(vec![
        second.public(),
        json!({ "kty": "later" }),
    ]));
    assert_eq!(status(&second).await, StatusCode::UNAUTHORIZED);
    ahead.go(6);
    let all = futures_util::future::join_all((0..10).map(|_| status(&second))).await;
    assert!(
        all.iter().all(|status| *status == StatusCode::OK),
        "{all:?}"
    );
    assert_eq!(provider.asked(), before + 1);
    assert_eq!(
        status(&first).await,
        StatusCode::UNAUTHORIZED,
        "it was withdrawn"
    );
}

#[tokio::test]
async fn a_key_that_is_withdrawn_opens_nothing_soon_after() {
    let (mut bench, provider, first) = trusting().await;
    let ahead = Ahead::default();
    ahead.rule(&mut bench).await;
    let token = first.token(&provider.claims("ada"));
    assert_eq!(
        with(&bench, "/v1/jobs", &token).await.status(),
        StatusCode::OK
    );
    provider.give(Keys::These(vec![Signer::new("second").public()]));
    ahead.go(9 * 60);
    assert_eq!(
        with(&bench, "/v1/jobs", &token).await.status(),
        StatusCode::OK
    );
    ahead.go(60);
    problem(with(&bench, "/v1/jobs", &token).await, 401, "unauthorized").await;
}

#[tokio::test]
async fn a_provider_that_gives_no_keys_keeps_nobody_out_who_has_one_of_the_service() {
    let signer = Signer::new("first");
    let provider = Provider::with(Keys::Nothing).await;
    let mut bench = Bench::start(
        |config| provider.configure(config),
        Arc::new(|_, _| Ok(crate::bench::results())),
    )
    .await;
    let ahead = Ahead::default();
    ahead.rule(&mut bench).await;
    let token = signer.token(&provider.claims("ada"));
    let key = key_of(&bench, "ada").await;
    let good = vec![signer.public()];
    for keys in [
        Keys::Nothing,
        Keys::Endless,
        Keys::Elsewhere(good.clone()),
        Keys::These(Vec::new()),
    ] {
        provider.give(keys);
        ahead.go(6);
        let refused = with(&bench, "/v1/jobs", &token).await;
        assert_eq!(refused.headers()["retry-after"], "5");
        let _ = problem(refused, 503, "identity_provider_unavailable").await;
        assert_eq!(
            with(&bench, "/v1/jobs", &key).await.status(),
            StatusCode::OK
        );
        let ready = bench.get("/health/ready").answer().await;
        assert_eq!(ready.status(), StatusCode::OK);
    }
    provider.give(Keys::These(good));
    ahead.go(6);
    assert_eq!(
        with(&bench, "/v1/jobs", &token).await.status(),
        StatusCode::OK
    );
    // It is gone again: its keys go on to open for a day, new ones cannot be looked for.
    provider.give(Keys::Nothing);
    ahead.go(23 * 3600);
    let now = Timestamp::now().as_second();
    let mut claims = provider.claims("ada");
    claims["exp"] = json!(now + 90_000);
    let token = signer.token(&claims);
    assert_eq!(
        with(&bench, "/v1/jobs", &token).await.status(),
        StatusCode::OK
    );
    // Between two fetches nobody looks for them: nobody is known to have them.
    for (seconds, status, code) in [
        (0, 401, "unauthorized"),
        (6, 503, "identity_provider_unavailable"),
    ] {
        ahead.go(seconds);
        let new = with(&bench, "/v1/jobs", &Signer::new("new").token(&claims)).await;
        problem(new, status, code).await;
    }
    ahead.go(3600);
    let old = with(&bench, "/v1/jobs", &token).await;
    problem(old, 503, "identity_provider_unavailable").await;
}

/// A provider that is silent has this long in these tests: no fetch ends by itself.
const NEVER: Duration = Duration::from_secs(3600);

/// Sends 100 requests with tokens of keys that the provider never had.
fn flood(bench: &Bench, token: impl Fn(usize) -> String) -> FuturesUnordered<JoinHandle<Response>> {
    let send = |i| {
        let request = bench.get("/v1/jobs").bearer_auth(token(i));
        tokio::spawn(request.timeout(NEVER).answer())
    };
    (0..100).map(send).collect()
}

/// The next `count` answers.
async fn next_of(
    forged: &mut FuturesUnordered<JoinHandle<Response>>,
    count: usize,
) -> Vec<Response> {
    let mut answers = Vec::new();
    for _ in 0..count {
        answers.push(forged.next().await.unwrap().unwrap());
    }
    answers
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn of_the_tokens_that_a_silent_provider_cannot_check_sixty_four_wait_for_one_fetch() {
    let provider = Provider::with(Keys::Nothing).await;
    let mut bench = Bench::start(
        |config| provider.configure(config),
        Arc::new(|_, _| Ok(crate::bench::results())),
    )
    .await;
    bench.times.provider = NEVER;
    let key = key_of(&bench, "ada").await;
    // The first fetch is over.
    let ahead = Ahead::default();
    ahead.rule(&mut bench).await;
    let token = Signer::new("first").token(&provider.claims("ada"));
    let refused = with(&bench, "/v1/jobs", &token).await;
    problem(refused, 503, "identity_provider_unavailable").await;
    provider.give(Keys::Silent);
    ahead.go(60);
    let before = provider.asked();
    let token = |i: usize| Signer::new(&format!("forged-{i}")).token(&provider.claims("eve"));
    let mut forged = flood(&bench, token);
    // Those that find no place are answered while the provider is silent, and so are requests that need no token.
    let mut answers = next_of(&mut forged, 100 - 64).await;
    for request in [
        bench.get("/health/ready"),
        bench.get("/v1/jobs").bearer_auth(&key),
    ] {
        assert_eq!(request.answer().await.status(), StatusCode::OK);
    }
    provider.give(Keys::Nothing);
    answers.extend(next_of(&mut forged, 64).await);
    for answer in answers {
        assert!(answer.headers().contains_key("retry-after"));
        problem(answer, 503, "identity_provider_unavailable").await;
    }
    assert_eq!(provider.asked(), before + 1);
}

#[tokio::test]
async fn a_provider_that_answers_nothing_is_given_up_after_its_time() {
    let provider = Provider::with(Keys::Silent).await;
    let mut bench = Bench::start(
        |config| provider.configure(config),
        Arc::new(|_, _| Ok(crate::bench::results())),
    )
    .await;
    bench.times.provider = Duration::from_millis(100);
    bench.shut_down().await;
    bench.start_again().await;
    let token = Signer::new("first").token(&provider.claims("ada"));
    let refused = with(&bench, "/v1/jobs", &token).await;
    problem(refused, 503, "identity_provider_unavailable").await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_thousand_forged_tokens_that_a_silent_provider_cannot_check_take_little_memory() {
    let provider = Provider::with(Keys::Silent).await;
    let folder = tempfile::tempdir().unwrap();
    let trusts = [
        "--oidc-issuer",
        &provider.issuer,
        "--oidc-audience",
        AUDIENCE,
        "--requests-without-key",
        "1000",
    ];
    let arguments = [&LITTLE[..], &trusts].concat();
    let process = Process::start_with(&stores::place(&folder).await, &arguments);
    let client = meshwright::client().timeout(PATIENCE).build().unwrap();
    let mut claims = provider.claims("eve");
    claims["much"] = "x".repeat(3000).into();
    let token = Signer::new("forged").token(&claims);
    let forged = (0..1000).map(|_| {
        let request = client.get(format!("{}/v1/jobs", process.base));
        request.bearer_auth(&token).send()
    });
    for answer in futures_util::future::join_all(forged)
        .await
        .into_iter()
        .flatten()
    {
        assert!(!answer.status().is_success());
    }
    let memory = process.peak_memory_mb();
    println!("1,000 forged tokens beside a silent provider: at most {memory} MB");
    assert!(memory < LITTLE_MB, "{memory} MB");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_provider_that_falls_silent_is_asked_once_in_five_seconds_for_keys_that_it_never_had() {
    let (mut bench, provider, signer) = trusting().await;
    bench.times.provider = NEVER;
    let ahead = Ahead::default();
    ahead.rule(&mut bench).await;
    let known = signer.token(&provider.claims("ada"));
    let status = async |token: &str| with(&bench, "/v1/jobs", token).await.status();
    assert_eq!(status(&known).await, StatusCode::OK);
    provider.give(Keys::Silent);
    ahead.go(6);
    let before = provider.asked();
    let unknown = |i: usize| Signer::new(&format!("unknown-{i}")).token(&provider.claims("eve"));
    let mut forged = flood(&bench, unknown);
    for answer in next_of(&mut forged, 100 - 64).await {
        assert_eq!(answer.status(), StatusCode::UNAUTHORIZED);
    }
    // A request with a known key does not wait for the fetch.
    assert_eq!(status(&known).await, StatusCode::OK);
    provider.give(Keys::Nothing);
    for answer in next_of(&mut forged, 64).await {
        assert_eq!(answer.status(), StatusCode::SERVICE_UNAVAILABLE);
    }
    // Until the next fetch, tokens of unknown keys are refused without one.
    assert_eq!(status(&unknown(100)).await, StatusCode::UNAUTHORIZED);
    assert_eq!(provider.asked(), before + 1);
}

#[tokio::test]
async fn a_stream_ends_with_its_token() {
    let signer = Signer::new("first");
    let provider = Provider::with(Keys::These(vec![signer.public()])).await;
    let (mut bench, mut engine) = Bench::steered_with(|config| provider.configure(config)).await;
    let ahead = Ahead::default();
    ahead.rule(&mut bench).await;
    let token = signer.token(&provider.claims("ada"));
    let made = bench.post("/v1/jobs", &submission(1.0)).bearer_auth(&token);
    let made = made.answer().await;
    let path = made.headers()["location"].to_str().unwrap().to_owned();
    let _work = engine.next().await;
    let stream = bench.get(&format!("{path}/events")).bearer_auth(&token);
    let mut stream = stream.answer().await;
    assert!(stream.chunk().await.unwrap().is_some());
    ahead.go(3700);
    // Nothing happens to the job meanwhile.
    while stream.chunk().await.unwrap().is_some() {}
    problem(with(&bench, &path, &token).await, 401, "unauthorized").await;
}

#[tokio::test]
async fn a_token_that_was_taken_is_no_strangers_and_one_that_was_not_is() {
    let signer = Signer::new("first");
    let provider = Provider::with(Keys::These(vec![signer.public()])).await;
    let (bench, _engine) = Bench::steered_with(|config| {
        provider.configure(config);
        config.admission.requests_without_key = 1;
    })
    .await;
    let token = signer.token(&provider.claims("ada"));
    for _ in 0..100 {
        assert_eq!(
            with(&bench, "/v1/jobs", &token).await.status(),
            StatusCode::OK
        );
    }
    let other = Signer::new("other").token(&provider.claims("ada"));
    let mut statuses = Vec::new();
    for _ in 0..100 {
        statuses.push(with(&bench, "/v1/jobs", &other).await.status());
    }
    assert!(statuses.contains(&StatusCode::TOO_MANY_REQUESTS));
}

#[tokio::test]
async fn the_program_takes_tokens_by_its_options_and_logs_whose_they_are_and_not_them() {
    let signer = Signer::new("first");
    let provider = Provider::with(Keys::These(vec![signer.public()])).await;
    let folder = tempfile::tempdir().unwrap();
    let log = std::fs::File::create(folder.path().join("log")).unwrap();
    let program = || std::process::Command::new(env!("CARGO_BIN_EXE_meshwright"));
    let mut service = program()
        .args(["serve", "--listen", "127.0.0.1:0", "--database"])
        .arg(folder.path().join("tokens.db"))
        .args([
            "--oidc-issuer",
            &provider.issuer,
            "--oidc-audience",
            AUDIENCE,
        ])
        .args(["--oidc-algorithm", "RS256,ES256"])
        .env("MESHWRIGHT_OIDC_CLIENT_CLAIM", "/org/name")
        .env("MESHWRIGHT_OIDC_OPERATOR_CLAIM", "roles=boss")
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
    let mut claims = provider.claims("4711");
    claims["org"] = json!({ "name": "gear works" });
    claims["jti"] = json!("token-7");
    claims["roles"] = json!(["boss"]);
    let token = signer.token(&claims);
    let answer = reqwest::Client::new()
        .get(format!("{base}/metrics"))
        .bearer_auth(&token);
    assert_eq!(answer.answer().await.status(), StatusCode::OK);
    service.kill().unwrap();
    service.wait().unwrap();
    let log = std::fs::read_to_string(folder.path().join("log")).unwrap();
    let is_of_request = |line: &&str| {
        ["/metrics", "4711", "gear works", "token-7", "status=200"]
            .iter()
            .all(|part| line.contains(part))
    };
    assert!(log.lines().any(|line| is_of_request(&line)), "{log}");
    assert!(!log.contains(token.rsplit_once('.').unwrap().1));

    // What does not go together is said at once.
    for arguments in [
        ["--oidc-issuer", "https://id.example"].as_slice(),
        &["--oidc-audience", "gears"],
        &["--oidc-issuer", "http://id.example", "--oidc-audience", "a"],
        &[
            "--oidc-issuer",
            "https://id.example",
            "--oidc-audience",
            "a",
            "--oidc-algorithm",
            "HS256",
        ],
        &["--oidc-operator-claim", "roles"],
    ] {
        let refused = program().arg("serve").args(arguments).output().unwrap();
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}");
    }
}
