//! Who may use the service, and how much of it each may use: hosts, keys, rates, and requests that wait.

use std::collections::HashSet;
use std::net::IpAddr;
use std::num::NonZeroU32;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::header::{CONNECTION, FORWARDED, HOST, HeaderName, HeaderValue, VIA};
use axum::http::uri::Authority;
use axum::http::{HeaderMap, Uri, Version};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use meshwright_connections::{
    ActiveRequest, Address, Budget, Connection, Part, Rates, Unauthenticated,
};
use meshwright_wire::{Code, Problem};
use tokio::time::Instant;
use uuid::Uuid;

use super::credential::{Credential, bearer};
use super::problem::{Refusal, overloaded};

/// A client may send so many times its requests of a second at once.
const BURST_SECONDS: NonZeroU32 = NonZeroU32::new(2).unwrap();

/// Limit of the requests that one link opens, per second. A page makes five.
const REQUESTS_OF_SHARE: NonZeroU32 = NonZeroU32::new(20).unwrap();

/// Limit of the requests that links open, per second and address.
const LOOKS_AT_SHARES: NonZeroU32 = NonZeroU32::new(100).unwrap();

/// Rule for keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum KeysRule {
    /// As soon as there is one, and wherever others than this machine may be at the other end: beyond the loopback, under a
    /// public name, behind a proxy.
    #[default]
    #[value(skip)]
    Careful,
    /// Always.
    Required,
    /// Never: everybody who reaches the service may do everything.
    None,
}

/// Rules of access.
#[derive(Debug, Clone)]
pub struct AccessRules {
    /// Rule for keys.
    pub keys: KeysRule,
    /// True if only this machine reaches the service, as far as its configuration says.
    pub local: bool,
    /// Names under which the service may be called, beside this machine's own and all addresses.
    pub hosts: Vec<String>,
    /// True if a name that is not among them is refused. Where keys are needed a foreign name does no harm.
    pub strict_hosts: bool,
    /// Requests a second of one client; 0: any number.
    pub requests_per_second: u32,
    /// Requests a second without a key that is known, of one address; 0: any number.
    pub unauthenticated_per_second: u32,
    /// Maximum number of requests of one client that wait for an event: streams of events, and `Prefer: wait`.
    pub waiting_per_client: u64,
    /// Maximum number of such requests of all clients together.
    pub waiting: u64,
}

/// The access to the service.
#[derive(Debug)]
pub struct Access {
    rules: AccessRules,
    hosts: HashSet<String>,
    /// By client and rate: the keys of a client may have different ones.
    rates: Rates<(String, NonZeroU32)>,
    /// Requests that wait for something to happen.
    waiting: Budget,
    /// Requests that links open, by link and by address.
    shares: Rates<Uuid>,
    looks_at_shares: Rates<Address>,
    /// True once the process has seen a key. Keys never vanish.
    has_keys: AtomicBool,
    unauthenticated: Option<Unauthenticated>,
}

impl Access {
    /// Access by these rules.
    pub fn new(rules: AccessRules) -> Self {
        let own = ["localhost".to_owned()];
        let hosts = rules.hosts.iter().map(|host| host.to_ascii_lowercase());
        Self {
            hosts: hosts.chain(own).collect(),
            unauthenticated: NonZeroU32::new(rules.unauthenticated_per_second)
                .map(Unauthenticated::new),
            waiting: Budget::limited(rules.waiting, rules.waiting_per_client),
            rules,
            rates: Rates::default(),
            shares: Rates::default(),
            looks_at_shares: Rates::default(),
            has_keys: AtomicBool::new(false),
        }
    }

    /// True if a request with these headers needs a key; `None` if that depends on whether a key exists.
    pub(super) fn asks_for_keys(&self, headers: &HeaderMap) -> Option<bool> {
        match self.rules.keys {
            KeysRule::Required => Some(true),
            KeysRule::None => Some(false),
            KeysRule::Careful => {
                let asks = !self.rules.local
                    || self.has_keys.load(Ordering::Relaxed)
                    || came_through_a_proxy(headers);
                asks.then_some(true)
            }
        }
    }

    /// True if every request needs a key, even while there is none.
    pub fn always_asks_for_keys(&self) -> bool {
        self.asks_for_keys(&HeaderMap::new()) == Some(true)
    }

    /// A key was seen to be there.
    pub fn found_keys(&self) {
        self.has_keys.store(true, Ordering::Relaxed);
    }

    /// A key or token of this fingerprint was found to be known.
    pub(super) fn remember(&self, fingerprint: String) {
        if let Some(unauthenticated) = &self.unauthenticated {
            unauthenticated.remember(fingerprint);
        }
    }

    /// Counts a request from `address`, unless its key has been found to be known before, or nobody needs one.
    ///
    /// # Errors
    ///
    /// The time after which it may come again.
    fn count_unauthenticated(&self, address: Address, headers: &HeaderMap) -> Result<(), Duration> {
        let asks = self.asks_for_keys(headers) == Some(true);
        match self.unauthenticated.as_ref().filter(|_| asks) {
            Some(unauthenticated) => {
                let shown = bearer(headers).ok().flatten();
                let fingerprint = shown.as_ref().map(Credential::fingerprint);
                unauthenticated.count(address, fingerprint.as_deref())
            }
            None => Ok(()),
        }
    }

    /// Refuses a request that was not meant for this service. A page of a foreign name that suddenly points to this
    /// machine could otherwise speak to it in its visitor's browser (DNS rebinding). A page cannot do that under a mere
    /// address.
    ///
    /// # Errors
    ///
    /// `invalid_parameter` without a host, `host_not_allowed` for a foreign one.
    fn check_host(&self, request: &Request, strict: bool) -> Result<(), Problem> {
        let (uri, headers) = (request.uri(), request.headers());
        // The usual check of a load balancer. Such a request is from no browser, and health tells nothing of anybody.
        let has_no_host = !headers.contains_key(HOST) && uri.authority().is_none();
        if has_no_host && request.version() < Version::HTTP_11 && is_health(uri) {
            return Ok(());
        }
        let mut given = headers.get_all(HOST).iter();
        let header = given.next().and_then(|host| host.to_str().ok());
        let authority = uri.authority().map(Authority::as_str).or(header);
        let parsed = authority.and_then(|host| host.parse::<Authority>().ok());
        let (Some(authority), None) = (parsed, given.next()) else {
            return Err(Problem::new(
                Code::InvalidParameter,
                "A request names its Host, once.",
            ));
        };
        let host = authority.host().to_ascii_lowercase();
        let literal = host.trim_start_matches('[').trim_end_matches(']');
        let known =
            literal.parse::<IpAddr>().is_ok() || self.hosts.contains(host.trim_end_matches('.'));
        if known || !strict {
            Ok(())
        } else {
            Err(Problem::new(
                Code::HostNotAllowed,
                format!(
                    "This service is not called {host:?}. Its operator can allow the name (--allowed-host)."
                ),
            ))
        }
    }

    /// Counts a request of a client.
    ///
    /// # Errors
    ///
    /// The time after which it may come again.
    pub(super) fn count_request(
        &self,
        client: &str,
        own_rate: Option<u32>,
    ) -> Result<(), Duration> {
        let rate = own_rate.unwrap_or(self.rules.requests_per_second);
        let Some(quota) = NonZeroU32::new(rate) else {
            return Ok(());
        };
        let burst = quota.saturating_mul(BURST_SECONDS).get();
        let key = (client.to_owned(), quota);
        self.rates.count(key, quota, burst, Instant::now())
    }

    /// Counts a request by a link's secret, valid or not.
    ///
    /// # Errors
    ///
    /// The time after which the address may send the next.
    pub(super) fn count_looks_at_shares(&self, address: Address) -> Result<(), Duration> {
        let burst = LOOKS_AT_SHARES.get() * BURST_SECONDS.get();
        self.looks_at_shares
            .count(address, LOOKS_AT_SHARES, burst, Instant::now())
    }

    /// Counts a request that this link opens.
    ///
    /// # Errors
    ///
    /// The time after which the next is answered.
    pub(super) fn count_share(&self, link: Uuid) -> Result<(), Duration> {
        let burst = REQUESTS_OF_SHARE.get() * BURST_SECONDS.get();
        self.shares
            .count(link, REQUESTS_OF_SHARE, burst, Instant::now())
    }

    /// A place among the requests that wait, kept until it is dropped; `None` if there is none.
    pub(super) fn place_to_wait(&self, client: &str) -> Option<Part> {
        self.waiting.try_take(client, 1)
    }
}

/// True for a request for the health of the service.
pub(super) fn is_health(uri: &Uri) -> bool {
    uri.path().starts_with("/health/")
}

/// True if a proxy has passed the request on. Its sender is then not on this machine, whatever the address says.
fn came_through_a_proxy(headers: &HeaderMap) -> bool {
    let passed_on = |name: &HeaderName| {
        let name = name.as_str();
        name == "x-real-ip" || name == "x-forwarded" || name.starts_with("x-forwarded-")
    };
    headers.contains_key(FORWARDED) || headers.contains_key(VIA) || headers.keys().any(passed_on)
}

/// Refuses requests without a key that is known when too many of them come, and ends their connection: the next ones
/// on it would be more of the same. Health is asked for by those who keep the service alive.
pub(super) async fn limit_unauthenticated(
    State(access): State<Arc<Access>>,
    request: Request,
    next: Next,
) -> Response {
    let connection = request.extensions().get::<Arc<Connection>>();
    let connection = connection.filter(|_| !is_health(request.uri()));
    let counted = connection.map_or(Ok(()), |connection| {
        access.count_unauthenticated(connection.address, request.headers())
    });
    match counted {
        Ok(()) => next.run(request).await,
        Err(wait) => {
            metrics::counter!("meshwright_strangers_refused_total").increment(1);
            last_of_its_connection(Refusal::too_many_unauthenticated(wait).into_response())
        }
    }
}

/// Refuses a request where its client has as many active as one may have, or all connections are busy. Health is answered always.
pub(super) async fn limit_active(request: Request, next: Next) -> Response {
    let active = request.extensions().get::<Arc<ActiveRequest>>().cloned();
    let Some(active) = active.filter(|_| !is_health(request.uri())) else {
        return next.run(request).await;
    };
    let refused = |error| Refusal::from(overloaded(error)).into_response();
    if let Err(error) = active.leave_reserve().await {
        return last_of_its_connection(refused(error));
    }
    // One with a key counts for its client, once that is known. Behind a proxy all have one address.
    let may_have_key = matches!(bearer(request.headers()), Ok(Some(_)));
    match active.count_for_address() {
        Err(error) if !may_have_key => return refused(error),
        _ => {}
    }
    let response = next.run(request).await;
    match active.count_for_address() {
        Ok(()) => response,
        // The request needed no key, or had an unknown one.
        Err(error) => refused(error),
    }
}

fn last_of_its_connection(mut response: Response) -> Response {
    let close = HeaderValue::from_static("close");
    response.headers_mut().insert(CONNECTION, close);
    response
}

/// Refuses requests that were not meant for this service.
pub(super) async fn check_host(
    State(access): State<Arc<Access>>,
    request: Request,
    next: Next,
) -> Response {
    let strict = access.rules.strict_hosts;
    match access.check_host(&request, strict) {
        Ok(()) => next.run(request).await,
        Err(problem) => Refusal::from(problem).into_response(),
    }
}

/// The same where nobody needs a key, so that the names have to be known in any case.
pub(super) async fn check_known_host(
    State(access): State<Arc<Access>>,
    request: Request,
    next: Next,
) -> Response {
    match access.check_host(&request, true) {
        Ok(()) => next.run(request).await,
        Err(problem) => Refusal::from(problem).into_response(),
    }
}

#[cfg(test)]
mod tests {
    use axum::body::Body;

    use super::*;

    fn access(adjust: impl FnOnce(&mut AccessRules)) -> Access {
        let mut rules = AccessRules {
            keys: KeysRule::Careful,
            local: true,
            hosts: vec!["Gears.example".to_owned()],
            strict_hosts: true,
            requests_per_second: 3,
            unauthenticated_per_second: 2,
            waiting_per_client: 2,
            waiting: 3,
        };
        adjust(&mut rules);
        Access::new(rules)
    }

    fn check(access: &Access, hosts: &[&str]) -> Option<Code> {
        check_of(access, Version::HTTP_11, "/v1/jobs", hosts)
    }

    fn check_of(access: &Access, version: Version, path: &str, hosts: &[&str]) -> Option<Code> {
        let mut request = axum::http::Request::get(path).version(version);
        for host in hosts {
            request = request.header(HOST, *host);
        }
        let request = request.body(Body::empty()).unwrap();
        let checked = access.check_host(&request, access.rules.strict_hosts);
        checked.err().map(|problem| problem.code)
    }

    #[test]
    fn only_health_is_told_to_the_oldest_protocol_without_a_host() {
        let access = access(|_| {});
        let (old, new) = (Version::HTTP_10, Version::HTTP_11);
        let missing = Some(Code::InvalidParameter);
        for path in ["/health/live", "/health/ready"] {
            assert_eq!(check_of(&access, old, path, &[]), None);
            assert_eq!(check_of(&access, new, path, &[]), missing);
            assert_eq!(check_of(&access, old, path, &["localhost"; 2]), missing);
            let foreign = check_of(&access, old, path, &["evil.example"]);
            assert_eq!(foreign, Some(Code::HostNotAllowed));
        }
        for path in ["/v1/jobs", "/metrics", "/", "/healthy"] {
            assert_eq!(check_of(&access, old, path, &[]), missing, "{path}");
        }
    }

    #[test]
    fn a_foreign_name_is_refused_and_an_address_is_not() {
        let strict = access(|_| {});
        for host in [
            "localhost",
            "LOCALHOST:8080",
            "127.0.0.1:8080",
            "[::1]:8080",
            "10.1.2.3",
            "gears.example",
            "gears.example.",
        ] {
            assert_eq!(check(&strict, &[host]), None, "{host}");
        }
        for host in [
            "evil.example",
            "localhost.evil.example",
            "gears.example.evil.example:80",
            "xn--1",
        ] {
            assert_eq!(
                check(&strict, &[host]),
                Some(Code::HostNotAllowed),
                "{host}"
            );
        }
        for hosts in [&[][..], &[""], &["a b"], &["localhost", "localhost"]] {
            assert_eq!(
                check(&strict, hosts),
                Some(Code::InvalidParameter),
                "{hosts:?}"
            );
        }
        let open = access(|rules| rules.strict_hosts = false);
        assert_eq!(check(&open, &["evil.example"]), None);
        assert_eq!(check(&open, &[]), Some(Code::InvalidParameter));
    }

    #[test]
    fn keys_are_needed_wherever_somebody_else_may_be_at_the_other_end() {
        let asks = |access: &Access, header: Option<&'static str>| {
            let headers =
                header.map(|name| (HeaderName::from_static(name), HeaderValue::from_static("x")));
            access.asks_for_keys(&headers.into_iter().collect())
        };
        let passed_on = [
            "forwarded",
            "via",
            "x-forwarded",
            "x-forwarded-for",
            "x-forwarded-proto",
            "x-real-ip",
        ];
        let local = access(|_| {});
        assert_eq!(asks(&local, None), None);
        assert_eq!(asks(&local, Some("x-request-id")), None);
        assert!(
            passed_on
                .iter()
                .all(|name| asks(&local, Some(name)) == Some(true))
        );
        local.found_keys();
        assert_eq!(asks(&local, None), Some(true));
        assert_eq!(asks(&access(|rules| rules.local = false), None), Some(true));
        let required = access(|rules| rules.keys = KeysRule::Required);
        assert_eq!(asks(&required, None), Some(true));
        let none = access(|rules| (rules.keys, rules.local) = (KeysRule::None, false));
        assert!(
            passed_on
                .iter()
                .all(|name| asks(&none, Some(name)) == Some(false))
        );
    }

    #[test]
    fn a_client_that_asks_too_often_waits_and_no_other_one_does() {
        let access = access(|_| {});
        let taken = (0..20)
            .take_while(|_| access.count_request("a", None).is_ok())
            .count();
        assert_eq!(taken, 6, "two seconds' worth at once");
        let wait = access.count_request("a", None).unwrap_err();
        assert!(
            wait > Duration::ZERO && wait <= Duration::from_secs(1),
            "{wait:?}"
        );
        assert!(access.count_request("b", None).is_ok());
        assert!(
            (0..100).all(|_| access.count_request("c", Some(0)).is_ok()),
            "0 is any number"
        );
    }

    #[test]
    fn two_keys_of_a_client_by_turns_get_no_more_than_both_may() {
        let access = access(|_| {});
        let taken = (0..100)
            .filter(|turn| {
                let rate = if turn % 2 == 0 { 3 } else { 5 };
                access.count_request("a", Some(rate)).is_ok()
            })
            .count();
        assert!(taken <= 6 + 10 + 1, "{taken}");
    }

    #[test]
    fn places_to_wait_are_bounded_for_each_and_for_all() {
        let access = access(|_| {});
        let first = access.place_to_wait("a").unwrap();
        let _second = access.place_to_wait("a").unwrap();
        assert!(access.place_to_wait("a").is_none());
        let _third = access.place_to_wait("b").unwrap();
        assert!(access.place_to_wait("b").is_none(), "all places are taken");
        drop(first);
        assert!(access.place_to_wait("b").is_some());
    }
}
