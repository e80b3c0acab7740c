//! Who gets in, and how much of the service each gets: hosts, keys, rates, and those who wait.

use std::collections::{HashMap, HashSet};
use std::net::IpAddr;
use std::num::NonZeroU32;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::header::HOST;
use axum::http::uri::Authority;
use axum::http::{HeaderMap, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use governor::clock::{Clock as _, DefaultClock};
use governor::{DefaultDirectRateLimiter, Quota};

use crate::wire::{Code, Problem};

/// A client may send so many times its requests of a second at once.
const BURST_SECONDS: u32 = 2;

/// What is allowed to whom.
#[derive(Debug, Clone)]
pub struct DoorRules {
    /// Whether the service listens to this machine only. Elsewhere nobody gets in without a key.
    pub loopback: bool,
    /// Names under which the service may be called, beside this machine's own and all addresses.
    pub hosts: Vec<String>,
    /// Whether a name that is not among them is refused. Where keys are needed a foreign name does no harm.
    pub strict_hosts: bool,
    /// Requests a second of one client; 0: any number.
    pub requests_per_second: u32,
    /// So many requests of one client may wait for something to happen: streams of events, and `Prefer: wait`.
    pub waiting_per_client: usize,
    /// So many of all clients together.
    pub waiting: usize,
}

/// The door of the service.
#[derive(Debug)]
pub struct Door {
    rules: DoorRules,
    hosts: HashSet<String>,
    /// By client and rate: the keys of a client may have different ones.
    rates: Mutex<HashMap<(String, NonZeroU32), Arc<DefaultDirectRateLimiter>>>,
    waiting: Arc<Mutex<HashMap<String, usize>>>,
}

impl Door {
    /// A door with these rules.
    pub fn new(rules: DoorRules) -> Self {
        let own = ["localhost".to_owned()];
        let hosts = rules.hosts.iter().map(|host| host.to_ascii_lowercase());
        Self {
            hosts: hosts.chain(own).collect(),
            rules,
            rates: Mutex::default(),
            waiting: Arc::default(),
        }
    }

    /// Whether nobody gets in without a key, even while there is none.
    pub(super) fn always_asks_for_keys(&self) -> bool {
        !self.rules.loopback
    }

    /// Refuses a request that was not meant for this service. A page of a foreign name that suddenly points to this
    /// machine could otherwise speak to it in its visitor's browser (DNS rebinding). A page cannot do that under a mere
    /// address.
    ///
    /// # Errors
    ///
    /// `invalid_parameter` without a host, `host_not_allowed` for a foreign one.
    pub(super) fn check_host(&self, uri: &Uri, headers: &HeaderMap) -> Result<(), Problem> {
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
        if known || !self.rules.strict_hosts {
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
        let burst = quota.saturating_mul(NonZeroU32::MIN.saturating_add(BURST_SECONDS - 1));
        let limiter = {
            let mut rates = self.rates.lock().expect("nothing panics with this lock");
            let limiter = rates.entry((client.to_owned(), quota)).or_insert_with(|| {
                let quota = Quota::per_second(quota).allow_burst(burst);
                Arc::new(DefaultDirectRateLimiter::direct(quota))
            });
            Arc::clone(limiter)
        };
        limiter
            .check()
            .map_err(|not_until| not_until.wait_time_from(DefaultClock::default().now()))
    }

    /// A place among those who wait, kept until it is dropped; `None` if there is none.
    pub(super) fn place_to_wait(&self, client: &str) -> Option<PlaceToWait> {
        let mut waiting = self.waiting.lock().expect("nothing panics with this lock");
        let all: usize = waiting.values().sum();
        let own = waiting.get(client).copied().unwrap_or_default();
        if all >= self.rules.waiting || own >= self.rules.waiting_per_client {
            return None;
        }
        waiting.insert(client.to_owned(), own + 1);
        Some(PlaceToWait {
            waiting: Arc::clone(&self.waiting),
            client: client.to_owned(),
        })
    }
}

/// Refuses requests that were not meant for this service.
pub(super) async fn check_host(
    State(door): State<Arc<Door>>,
    request: Request,
    next: Next,
) -> Response {
    match door.check_host(request.uri(), request.headers()) {
        Ok(()) => next.run(request).await,
        Err(problem) => problem.into_response(),
    }
}

/// A place among those who wait.
#[derive(Debug)]
pub(super) struct PlaceToWait {
    waiting: Arc<Mutex<HashMap<String, usize>>>,
    client: String,
}

impl Drop for PlaceToWait {
    fn drop(&mut self) {
        let mut waiting = self.waiting.lock().expect("nothing panics with this lock");
        if let Some(own) = waiting.get_mut(&self.client) {
            *own -= 1;
            if *own == 0 {
                waiting.remove(&self.client);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn door(adjust: impl FnOnce(&mut DoorRules)) -> Door {
        let mut rules = DoorRules {
            loopback: true,
            hosts: vec!["Gears.example".to_owned()],
            strict_hosts: true,
            requests_per_second: 3,
            waiting_per_client: 2,
            waiting: 3,
        };
        adjust(&mut rules);
        Door::new(rules)
    }

    fn check(door: &Door, hosts: &[&str]) -> Option<Code> {
        let mut headers = HeaderMap::new();
        for host in hosts {
            headers.append(HOST, host.parse().unwrap());
        }
        let path = Uri::from_static("/v1/jobs");
        door.check_host(&path, &headers)
            .err()
            .map(|problem| problem.code)
    }

    #[test]
    fn a_foreign_name_is_refused_and_an_address_is_not() {
        let strict = door(|_| {});
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
        let open = door(|rules| rules.strict_hosts = false);
        assert_eq!(check(&open, &["evil.example"]), None);
        assert_eq!(check(&open, &[]), Some(Code::InvalidParameter));
    }

    #[test]
    fn a_client_that_asks_too_often_waits_and_no_other_one_does() {
        let door = door(|_| {});
        let taken = (0..20)
            .take_while(|_| door.count_request("a", None).is_ok())
            .count();
        assert_eq!(taken, 6, "two seconds' worth at once");
        let wait = door.count_request("a", None).unwrap_err();
        assert!(
            wait > Duration::ZERO && wait <= Duration::from_secs(1),
            "{wait:?}"
        );
        assert!(door.count_request("b", None).is_ok());
        assert!(
            (0..100).all(|_| door.count_request("c", Some(0)).is_ok()),
            "0 is any number"
        );
    }

    #[test]
    fn two_keys_of_a_client_by_turns_get_no_more_than_both_may() {
        let door = door(|_| {});
        let taken = (0..100)
            .filter(|turn| {
                let rate = if turn % 2 == 0 { 3 } else { 5 };
                door.count_request("a", Some(rate)).is_ok()
            })
            .count();
        assert!(taken <= 6 + 10 + 1, "{taken}");
    }

    #[test]
    fn places_to_wait_are_bounded_for_each_and_for_all() {
        let door = door(|_| {});
        let first = door.place_to_wait("a").unwrap();
        let _second = door.place_to_wait("a").unwrap();
        assert!(door.place_to_wait("a").is_none());
        let _third = door.place_to_wait("b").unwrap();
        assert!(door.place_to_wait("b").is_none(), "all places are taken");
        drop(first);
        assert!(door.place_to_wait("b").is_some());
    }
}
