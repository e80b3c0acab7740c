//! The test bench: a service on a free port, a client, and an engine whose work the test steers.

use std::sync::{Arc, mpsc as blocking};
use std::time::Duration;

use meshwright::compute::Solve;
use meshwright::config::Config;
use meshwright::jobs::{Clock, DatabaseAddress};
use meshwright::serve::{Compute, Service, World, serve};
use meshwright::times::Times;
use meshwright::webhooks::HookRules;
use meshwright_engine::run::Run;
use meshwright_wire::{Code, Problem, Results, Submission};
use reqwest::{Client, RequestBuilder, Response, StatusCode};
use serde_json::{Value, json};
use tempfile::TempDir;
use tokio::sync::mpsc;

use crate::{stores, threads};

/// Time after which an answer is missing. No verdict depends on how fast an answer comes before that.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// The preference of a request that is to be answered when its job has ended: the longest wait after which an answer still comes within [`PATIENCE`].
pub(crate) const WAIT: &str = "wait=50";

/// The job or study that `look` asks for, when it has ended. Panics if nothing of it changes during a whole wait.
pub(crate) async fn ended(look: impl Fn() -> RequestBuilder) -> Value {
    let mut seen = Value::Null;
    loop {
        let now = look().header("prefer", WAIT).document().await;
        if ["successful", "failed", "dismissed"].contains(&now["status"].as_str().unwrap()) {
            return now;
        }
        assert_ne!(now, seen, "nothing happens");
        seen = now;
    }
}

/// Looks until `look` finds something, and panics after [`PATIENCE`] with what it saw last.
pub(crate) async fn eventually<Found, Seen: std::fmt::Debug>(
    mut look: impl AsyncFnMut() -> Result<Found, Seen>,
) -> Found {
    let start = std::time::Instant::now();
    loop {
        match look().await {
            Ok(found) => return found,
            Err(seen) => assert!(start.elapsed() < PATIENCE, "still {seen:?}"),
        }
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

/// Results as an engine might give them, as they are written.
pub(crate) const RESULTS: &str = include_str!("results.json").trim_ascii_end();

/// The same as the engine gives them.
pub(crate) fn results() -> Results {
    Results::read(RESULTS).unwrap()
}

/// The usual configuration, with one worker, few places and a free port.
pub(crate) fn config(database: &DatabaseAddress) -> Config {
    #[derive(clap::Parser)]
    struct Arguments {
        #[command(flatten)]
        config: Config,
    }
    let database = &stores::address(database);
    let arguments = [
        "test",
        "--listen",
        "127.0.0.1:0",
        "--database",
        database,
        "--workers",
        "1",
        "--queue-limit",
        "100",
        "--previews",
        "4",
        "--preview-time-limit-seconds",
        "60",
    ];
    <Arguments as clap::Parser>::parse_from(arguments).config
}

/// A service and a client of it.
pub(crate) struct Bench {
    pub(crate) config: Config,
    compute: Compute,
    pub(crate) clock: Clock,
    pub(crate) hooks: HookRules,
    pub(crate) times: Times,
    service: Option<Service>,
    pub(crate) base: String,
    pub(crate) client: Client,
    _folder: TempDir,
}

/// The work that the engine was given, one computation after the other.
pub(crate) struct Engine(mpsc::UnboundedReceiver<Work>);

/// One computation, which waits for what the test tells it.
pub(crate) struct Work {
    /// What is to be computed.
    pub(crate) submission: Value,
    run: Run,
    orders: blocking::Sender<Order>,
    pub(crate) ended: tokio::sync::oneshot::Receiver<()>,
}

enum Order {
    Reach(u64),
    Finish(Box<Result<Results, Problem>>),
    Panic,
}

impl Bench {
    /// A service with one worker whose engine gives [`RESULTS`] at once.
    pub(crate) async fn quick() -> Self {
        Self::start(|_| {}, Arc::new(|_, _| Ok(results()))).await
    }

    /// A service with one worker whose engine waits for orders.
    pub(crate) async fn steered() -> (Self, Engine) {
        Self::steered_with(|_| {}).await
    }

    pub(crate) async fn steered_with(adjust: impl FnOnce(&mut Config)) -> (Self, Engine) {
        let (engine, solve) = Engine::new();
        (Self::start(adjust, solve).await, engine)
    }

    /// A service with one worker that computes.
    pub(crate) async fn real() -> Self {
        Self::start_with(|_| {}, Arc::new(meshwright_studies::solve)).await
    }

    pub(crate) async fn start(adjust: impl FnOnce(&mut Config), solve: Solve) -> Self {
        Self::start_with(
            adjust,
            Arc::new(move |submission, _, run| solve(submission, run)),
        )
        .await
    }

    pub(crate) async fn start_with(adjust: impl FnOnce(&mut Config), compute: Compute) -> Self {
        threads::watch();
        let folder = tempfile::tempdir().unwrap();
        let mut config = config(&stores::place(&folder).await);
        adjust(&mut config);
        let client = meshwright::client().timeout(PATIENCE).build().unwrap();
        let hooks = HookRules::to_named(config.admission.webhook_hosts.clone());
        let mut bench = Self {
            config,
            compute,
            clock: Clock::system(),
            hooks,
            times: Times::USUAL,
            service: None,
            base: String::new(),
            client,
            _folder: folder,
        };
        bench.start_again().await;
        bench
    }

    /// Starts a service on the same database.
    pub(crate) async fn start_again(&mut self) {
        let service = self.another().await.unwrap();
        self.base = format!("http://{}", service.address().unwrap());
        self.service = Some(service);
    }

    /// A second service on the same database.
    pub(crate) async fn another(&self) -> anyhow::Result<Service> {
        self.another_on(self.config.database.clone()).await
    }

    /// A service like this one on the database at `place`.
    pub(crate) async fn another_on(&self, place: DatabaseAddress) -> anyhow::Result<Service> {
        let config = Config {
            database: place,
            ..self.config.clone()
        };
        let world = World {
            compute: Arc::clone(&self.compute),
            clock: self.clock.clone(),
            hooks: self.hooks.clone(),
            times: self.times,
        };
        serve(&config, world).await
    }

    /// The service, to ask what HTTP does not tell.
    pub(crate) fn service(&self) -> &Service {
        self.service.as_ref().unwrap()
    }

    /// Ends the service as a crash would.
    pub(crate) async fn kill(&mut self) {
        self.service.take().unwrap().kill().await;
        stores::pass_a_lease(&self.config.database).await;
    }

    /// Ends the service in order.
    pub(crate) async fn shut_down(&mut self) {
        self.service.take().unwrap().shut_down().await;
    }

    pub(crate) fn url(&self, path: &str) -> String {
        format!("{}{path}", self.base)
    }

    pub(crate) fn get(&self, path: &str) -> RequestBuilder {
        self.client.get(self.url(path))
    }

    pub(crate) fn post(&self, path: &str, document: &Value) -> RequestBuilder {
        self.send(path).json(document)
    }

    /// A POST without a body.
    pub(crate) fn send(&self, path: &str) -> RequestBuilder {
        self.client.post(self.url(path))
    }

    pub(crate) fn delete(&self, path: &str) -> RequestBuilder {
        self.client.delete(self.url(path))
    }

    /// Asks for the end of what is at `path`.
    pub(crate) fn cancel(&self, path: &str) -> RequestBuilder {
        self.send(&format!("{path}/cancel"))
    }

    /// Submits a job and gives its address.
    pub(crate) async fn submit(&self, document: &Value) -> String {
        let response = self.post("/v1/jobs", document).answer().await;
        assert_eq!(response.status(), StatusCode::ACCEPTED);
        response.headers()["location"].to_str().unwrap().to_owned()
    }

    /// The job at an address.
    pub(crate) async fn job(&self, path: &str) -> Value {
        let response = self.get(path).answer().await;
        assert_eq!(response.status(), StatusCode::OK);
        response.document().await
    }

    /// The document at an address.
    pub(crate) async fn document(&self, path: &str) -> Value {
        let answer = self.get(path).answer().await;
        answer.document().await
    }

    /// The answer for a file that is computed anew. On a busy machine it is made after its request was answered (202), and asked for again.
    pub(crate) async fn file(&self, path: &str) -> Response {
        eventually(async || {
            let answer = self.get(path).answer().await;
            match answer.status() {
                StatusCode::ACCEPTED => Err(StatusCode::ACCEPTED),
                _ => Ok(answer),
            }
        })
        .await
    }

    /// The job at an address when it has ended. It may take a minute of a machine that has much else to do.
    pub(crate) async fn ended(&self, path: &str) -> Value {
        ended(|| self.get(path)).await
    }
}

/// What a test asks, and what is answered: both have the same document.
pub(crate) trait Asked: Sized {
    /// The answer, which has to come.
    async fn answer(self) -> Response;

    /// The JSON of it.
    async fn document(self) -> Value {
        self.answer().await.json().await.unwrap()
    }

    /// The text of it.
    async fn whole_text(self) -> String {
        self.answer().await.text().await.unwrap()
    }
}

impl Asked for RequestBuilder {
    async fn answer(self) -> Response {
        self.send().await.unwrap()
    }
}

impl Asked for Response {
    async fn answer(self) -> Response {
        self
    }
}

/// The events of a stream, one after the other.
pub(crate) struct Events {
    response: Response,
    text: String,
}

impl Events {
    pub(crate) async fn of(bench: &Bench, path: &str) -> Self {
        Self::with(bench, path, |request| request).await
    }

    /// The same, asked for by an adjusted request.
    pub(crate) async fn with(
        bench: &Bench,
        path: &str,
        adjust: impl FnOnce(RequestBuilder) -> RequestBuilder,
    ) -> Self {
        let request = bench
            .get(&format!("{path}/events"))
            .header("last-event-id", "7")
            .timeout(PATIENCE);
        let response = adjust(request).answer().await;
        assert_eq!(response.status(), StatusCode::OK);
        assert_eq!(response.headers()["content-type"], "text/event-stream");
        Self {
            response,
            text: String::new(),
        }
    }

    /// The name and data of the next event; none at the end of the stream.
    pub(crate) async fn next(&mut self) -> Option<(String, Value)> {
        loop {
            if let Some((event, rest)) = self.text.split_once("\n\n") {
                let field = |name: &str| {
                    event
                        .lines()
                        .find_map(|line| line.strip_prefix(name))
                        .map(str::to_owned)
                };
                let found = field("event: ").zip(field("data: "));
                self.text = rest.to_owned();
                if let Some((name, data)) = found {
                    return Some((name, serde_json::from_str(&data).unwrap()));
                }
            } else {
                let chunk = self.response.chunk().await.unwrap()?;
                self.text.push_str(std::str::from_utf8(&chunk).unwrap());
            }
        }
    }
}

impl Engine {
    fn new() -> (Self, Solve) {
        let (begun, works) = mpsc::unbounded_channel();
        let solve = move |submission: &Submission, run: &Run| {
            let (orders, to_do) = blocking::channel();
            let (end, ended) = tokio::sync::oneshot::channel::<()>();
            let _end_when_dropped = end;
            // A test that is over takes no more work.
            let _ = begun.send(Work {
                submission: serde_json::to_value(submission).unwrap(),
                run: run.clone(),
                orders,
                ended,
            });
            obey(&to_do, run)
        };
        (Self(works), Arc::new(solve))
    }

    /// The next computation that begins.
    pub(crate) async fn next(&mut self) -> Work {
        tokio::time::timeout(PATIENCE, self.0.recv())
            .await
            .expect("the engine is given work")
            .unwrap()
    }

    /// Whether no computation has begun.
    pub(crate) fn is_idle(&mut self) -> bool {
        self.0.try_recv().is_err()
    }
}

fn obey(to_do: &blocking::Receiver<Order>, run: &Run) -> Result<Results, Problem> {
    let stopped = || Problem::new(Code::InternalError, "stopped");
    loop {
        run.check().map_err(|_| stopped())?;
        // The engine's promise: a stop is obeyed within 100 ms.
        match to_do.recv_timeout(Duration::from_millis(2)) {
            Ok(Order::Reach(count)) => run.reached(count).map_err(|_| stopped())?,
            Ok(Order::Finish(result)) => return *result,
            Ok(Order::Panic) => panic!("as the test ordered"),
            Err(blocking::RecvTimeoutError::Timeout) => {}
            Err(blocking::RecvTimeoutError::Disconnected) => return Err(stopped()),
        }
    }
}

impl Work {
    pub(crate) fn reach(&self, count: u64) {
        self.orders.send(Order::Reach(count)).unwrap();
    }

    pub(crate) fn finish(self) {
        self.orders
            .send(Order::Finish(Box::new(Ok(results()))))
            .unwrap();
    }

    pub(crate) fn fail(self, problem: Problem) {
        self.orders
            .send(Order::Finish(Box::new(Err(problem))))
            .unwrap();
    }

    pub(crate) fn panic(self) {
        self.orders.send(Order::Panic).unwrap();
    }

    /// Comes back when the computation has obeyed a stop.
    pub(crate) async fn stopped(self) {
        tokio::time::timeout(PATIENCE, self.ended)
            .await
            .expect("the work ends")
            .unwrap_err();
        assert!(self.run.check().is_err());
    }
}

/// A submission: test case 2 of the paper, at one output torque.
pub(crate) fn submission(torque: f64) -> Value {
    let gear = json!({
        "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0,
        "tip_relief": { "amount_um": 5.0, "shape": "linear", "start": { "radial_length_mm": 1.75 } },
        "blank": { "bore_radius_mm": 16.0 },
    });
    let mut driven = gear.clone();
    driven["blank"]["holes"] = json!({ "count": 10, "circle_radius_mm": 34.0, "radius_mm": 7.5 });
    json!({
        "method": "flexible",
        "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": driven },
        "output_torques_n_m": [torque],
    })
}

/// The problem document that is answered, which must be one, of a status and code.
pub(crate) async fn problem(asked: impl Asked, status: u16, code: &str) -> Value {
    let response = asked.answer().await;
    let found = response.status().as_u16();
    assert_eq!(
        response.headers()["content-type"],
        "application/problem+json"
    );
    let problem = response.document().await;
    assert_eq!(
        (found, problem["status"].as_u64(), problem["code"].as_str()),
        (status, Some(status.into()), Some(code)),
        "{problem}"
    );
    assert_eq!(
        problem["type"],
        format!("/problems/{}", code.replace('_', "-"))
    );
    assert!(!problem["detail"].as_str().unwrap().is_empty());
    problem
}

#[test]
fn the_results_of_the_stub_are_written_as_results_are() {
    assert_eq!(results().to_json().unwrap(), RESULTS);
}
