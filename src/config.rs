//! Configuration from the command line and the environment.

use std::net::SocketAddr;
use std::num::NonZeroUsize;
use std::time::Duration;

use axum::http::{HeaderValue, Uri};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, value_parser};
use jiff::SignedDuration;
use jsonwebtoken::Algorithm;
use meshwright_connections::Bounds;

use crate::compute::{Cores, PreviewRules};
use crate::http::{AccessRules, KeysRule};
use crate::jobs::{DatabaseAddress, Keep, Migrate, Pace, Rules};
use crate::machine;
use crate::tokens::{self, Claim, ClaimValue, IssuerUrl, TokenRules};
use crate::webhooks::HookTarget;

/// Where and how the service runs. Every option has its variable of the environment (`with_variable`).
#[derive(Debug, Clone, clap::Args)]
pub struct Config {
    /// Address to listen on; port 0 takes a free one. If other machines can reach it, requests need keys.
    #[arg(long, default_value = "127.0.0.1:8080", value_name = "ADDRESS")]
    pub listen: SocketAddr,

    /// File of the database, which is made if it is absent; or postgres://user@host/name, on which several processes work.
    #[arg(
        long,
        default_value = "./meshwright.db",
        hide_env_values = true,
        value_name = "FILE or ADDRESS"
    )]
    pub database: DatabaseAddress,

    /// Who brings the tables of the database up to date: this process when it starts, or `meshwright migrate` only.
    #[arg(long, value_parser = migrate(), default_value = "auto")]
    pub migrate: Migrate,

    /// Tasks of this process. Several on one PostgreSQL may divide the work.
    #[arg(long, value_enum, default_value = "all")]
    pub role: Part,

    /// Jobs computed at the same time, each by up to eight threads [default: one for each core, fewer on large machines].
    #[arg(long, value_name = "NUMBER")]
    pub workers: Option<NonZeroUsize>,

    /// Origins whose pages may call the service, separated by commas; * for all.
    #[arg(long, value_delimiter = ',', value_name = "ORIGIN")]
    pub cors_origin: Vec<HeaderValue>,

    /// Address under which clients see the service, for all links [default: links are relative to the host].
    #[arg(long, value_parser = public_url, value_name = "URL")]
    pub public_url: Option<String>,

    /// Jobs that may wait; further ones are refused.
    #[arg(long, default_value_t = 1000, value_name = "NUMBER")]
    pub queue_limit: u32,

    /// Time for one job; a job that takes longer fails.
    #[arg(long, default_value_t = 600, value_name = "SECONDS",
          value_parser = value_parser!(u64).range(1..=7 * 24 * 3600))]
    pub time_limit_seconds: u64,

    /// Time after which a job whose worker has not been heard of is given to another one.
    #[arg(long, default_value = "30s", value_parser = lasting, value_name = "TIME", hide = true)]
    pub lease: Duration,

    /// Memory for the teeth, blanks and gears that jobs and previews share, in MB of 2^20 bytes.
    #[arg(long, default_value_t = 256, value_name = "MB",
          value_parser = value_parser!(u32).range(0..=1 << 20))]
    pub cache_mb: u32,

    /// Memory for everything that is computed or read at the same time, in MB; further work waits [default: half of the machine's].
    #[arg(long, value_name = "MB", value_parser = value_parser!(u64).range(64..=1 << 24))]
    pub memory_mb: Option<u64>,

    /// Memory that one job or preview may take, by the estimate of /v1/validate; larger ones are refused.
    #[arg(long, default_value_t = 2048, value_name = "MB",
          value_parser = value_parser!(u64).range(1..=1 << 20))]
    pub job_memory_mb: u64,

    /// Previews that requests may wait for at the same time; further ones are refused.
    #[arg(long, default_value_t = 8, value_name = "NUMBER",
          value_parser = value_parser!(u32).range(1..=1000))]
    pub previews: u32,

    /// Positions times torques of one preview, at most.
    #[arg(long, default_value_t = 4000, value_name = "NUMBER",
          value_parser = value_parser!(u64).range(1..=meshwright_wire::submission::MOST_POSITIONS))]
    pub preview_positions: u64,

    /// Time for one preview, from its request to its answer.
    #[arg(long, default_value_t = 10, value_name = "SECONDS",
          value_parser = value_parser!(u64).range(1..=60))]
    pub preview_time_limit_seconds: u64,

    /// Retention of results.
    #[command(flatten)]
    pub keep: KeepOptions,

    /// Who gets in, and how much of the service each gets.
    #[command(flatten)]
    pub admission: AdmissionOptions,

    /// Whose tokens are accepted beside keys.
    #[command(flatten)]
    pub oidc: OidcOptions,
}

/// Tasks of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// Everything.
    All,
    /// Answer requests, deliver messages and remove old results; compute previews, but no jobs.
    Api,
    /// Compute jobs. Nothing listens, but for --metrics-listen.
    Worker,
}

impl Part {
    /// True if the process answers requests.
    pub fn answers(self) -> bool {
        self != Self::Worker
    }

    /// True if the process computes jobs.
    pub fn computes(self) -> bool {
        self != Self::Api
    }
}

/// Retention of results.
#[derive(Debug, Clone, clap::Args)]
pub struct KeepOptions {
    /// Time that jobs and studies are kept after their end, such as 30d or 12h; 0 keeps them for good.
    #[arg(long, default_value = "30d", value_parser = span, value_name = "TIME")]
    pub keep_results: Duration,

    /// Size of the database beyond which the jobs and studies that ended first are removed, in GB; 0 for no limit.
    #[arg(long, default_value_t = 10.0, value_name = "GB")]
    pub keep_gb: f64,

    /// Time between two removals of old results.
    #[arg(long, default_value = "5m", value_parser = lasting, value_name = "TIME", hide = true)]
    pub keep_every: Duration,
}

/// Who gets in, and how much of the service each gets.
#[derive(Debug, Clone, clap::Args)]
pub struct AdmissionOptions {
    /// Names under which clients call the service, beside localhost, its addresses and the public one; separated by commas.
    #[arg(long = "allowed-host", value_delimiter = ',', value_name = "NAME")]
    pub allowed_hosts: Vec<String>,

    /// Address of a listener of its own for /metrics and health; /metrics is served only there then.
    #[arg(long, value_name = "ADDRESS")]
    pub metrics_listen: Option<SocketAddr>,

    /// Whether requests need keys [default: once there is a key, and wherever other machines can reach the service: beyond the loopback, with a public or
    /// allowed name, behind a proxy].
    #[arg(long, value_enum, hide_default_value = true)]
    pub keys: Option<KeysRule>,

    /// Limit of requests a second without a valid key, for each address; all addresses together have 20 times that. 0 for no limit.
    #[arg(long, default_value_t = 50, value_name = "NUMBER")]
    pub requests_without_key: u32,

    /// Limit of requests a second of one client; 0 for no limit.
    #[arg(long, default_value_t = 0, value_name = "NUMBER")]
    pub requests_per_second: u32,

    /// Jobs of one client that may wait, not counting designs of studies [default: half of --queue-limit].
    #[arg(long, value_name = "NUMBER")]
    pub client_queue_limit: Option<u32>,

    /// Jobs of one user of a client (Meshwright-User) that may wait, of those that the client may have [default: half of them].
    #[arg(long, value_name = "NUMBER")]
    pub user_queue_limit: Option<u32>,

    /// Designs of studies of one client that may wait.
    #[arg(long, default_value_t = 100_000, value_name = "NUMBER",
          value_parser = value_parser!(i64).range(1..))]
    pub client_design_limit: i64,

    /// Streams of events and waiting requests that one client may have open, at most an eighth of --connections; all together may
    /// have eight times as many, at most half of --connections.
    #[arg(long, default_value_t = 64, value_name = "NUMBER")]
    pub client_streams: usize,

    /// Connections at the same time; idle ones are evicted for new ones. One client, or one address without a key, has a quarter of them
    /// busy at most.
    #[arg(long, default_value_t = 1024, value_name = "NUMBER")]
    pub connections: usize,

    /// Time for the head of a request to come, and for an idle connection to stay.
    #[arg(long, default_value = "20s", value_parser = span, value_name = "TIME")]
    pub idle_time: Duration,

    /// Hosts to which clients may have webhooks sent, separated by commas: hooks.example.com, *.example.com. They are sent by https; http is
    /// allowed for a host that is named with it: http://HOST:PORT. A host named
    /// in full may have a private address, one of this machine or its link only if it is named by that address. Without any, webhooks are off.
    #[arg(long = "webhook-host", value_delimiter = ',', value_name = "HOST")]
    pub webhook_hosts: Vec<HookTarget>,
}

/// Whose tokens are accepted beside keys.
#[derive(Debug, Clone, clap::Args)]
pub struct OidcOptions {
    /// Identity provider (OpenID Connect) whose tokens are accepted beside keys: the value of their claim iss [default: keys alone].
    #[arg(long, value_name = "URL", requires = "oidc_audience")]
    pub oidc_issuer: Option<IssuerUrl>,

    /// The audience (aud) of its tokens for this service.
    #[arg(long, value_name = "NAME", requires = "oidc_issuer")]
    pub oidc_audience: Option<String>,

    /// Claim that names the client: its name, or a JSON pointer into the claims. Take one that its bearer cannot choose.
    #[arg(long, default_value = "sub", value_name = "CLAIM")]
    pub oidc_client_claim: Claim,

    /// Claim that names the user of the client, as the header Meshwright-User does beside a key [default: none].
    #[arg(long, value_name = "CLAIM")]
    pub oidc_user_claim: Option<Claim>,

    /// Claim that makes an operator, as the word or in a list: roles=admin, /realm_access/roles=admin [default: no token does].
    #[arg(long, value_name = "CLAIM=VALUE")]
    pub oidc_operator_claim: Option<ClaimValue>,

    /// Claim that makes an administrator, in the same way [default: no token does].
    #[arg(long, value_name = "CLAIM=VALUE")]
    pub oidc_administrator_claim: Option<ClaimValue>,

    /// Algorithms that its tokens may be signed with, separated by commas.
    #[arg(long, value_delimiter = ',', default_value = "RS256", value_parser = tokens::algorithm, value_name = "NAME")]
    pub oidc_algorithm: Vec<Algorithm>,
}

impl OidcOptions {
    /// Rules for tokens; `None` without an issuer.
    pub fn rules(&self) -> Option<TokenRules> {
        Some(TokenRules {
            issuer: self.oidc_issuer.clone()?,
            audience: self.oidc_audience.clone()?,
            algorithms: self.oidc_algorithm.clone(),
            client: self.oidc_client_claim.clone(),
            user: self.oidc_user_claim.clone(),
            operator: self.oidc_operator_claim.clone(),
            administrator: self.oidc_administrator_claim.clone(),
        })
    }
}

impl Config {
    /// The number of workers: none where jobs are computed elsewhere, as given, or as many as the machine is good for.
    pub fn worker_count(&self) -> usize {
        if !self.role.computes() {
            return 0;
        }
        self.workers
            .map_or_else(|| Cores::here().workers(), NonZeroUsize::get)
    }

    /// How the workers keep time.
    pub fn pace(&self) -> Pace {
        let time_limit = Duration::from_secs(self.time_limit_seconds);
        Pace::with_lease(self.lease, time_limit)
    }

    /// Memory for the substructures that jobs and previews share, in bytes.
    pub fn cache_bytes(&self) -> usize {
        // More than can be addressed is as much as there is.
        (self.cache_mb as usize).saturating_mul(1 << 20)
    }

    /// How memory is divided.
    pub fn memory(&self) -> Memory {
        /// Documents are read one after the other, so that more would not make it faster.
        const MOST_FOR_READING: u64 = 256;
        /// Answers wait for those who read them. Large ones are sent in pieces.
        const MOST_FOR_ANSWERS: u64 = 256;
        let all = self.memory_mb.unwrap_or_else(|| machine::memory_mb() / 2);
        let reading = (all / 4).clamp(1, MOST_FOR_READING);
        let answers = (all / 8).clamp(1, MOST_FOR_ANSWERS);
        Memory {
            reading,
            answers,
            computing: all.saturating_sub(reading + answers).max(1),
        }
    }

    /// Limits of previews.
    pub fn preview_rules(&self) -> PreviewRules {
        PreviewRules {
            at_once: self.previews as usize,
            most_positions: self.preview_positions,
            time_limit: Duration::from_secs(self.preview_time_limit_seconds),
        }
    }
}

impl Config {
    /// Limits of the queue.
    pub fn rules(&self) -> Rules {
        Rules {
            queue_limit: self.queue_limit,
            client_queue_limit: self
                .admission
                .client_queue_limit
                .unwrap_or(self.queue_limit.div_ceil(2)),
            user_queue_limit: self.admission.user_queue_limit,
            client_design_limit: self.admission.client_design_limit,
            // A larger job could only be computed beyond the memory of the process.
            job_memory_mb: self.job_memory_mb.min(self.memory().computing),
            memory_mb: self.memory().computing,
        }
    }

    /// Retention of results.
    pub fn keep(&self) -> Keep {
        let options = &self.keep;
        let bytes = options.keep_gb * 1e9;
        Keep {
            results_for: SignedDuration::try_from(options.keep_results)
                .ok()
                .filter(|time| !time.is_zero()),
            bytes: (bytes > 0.0).then_some(bytes as u64),
            first: options.keep_every.min(FIRST_LOOK),
            every: options.keep_every,
        }
    }

    /// Rules of access.
    pub fn access_rules(&self) -> AccessRules {
        let public = self.public_url.iter().filter_map(|url| {
            let uri: Uri = url.parse().ok()?;
            uri.host().map(str::to_owned)
        });
        let hosts: Vec<String> = public
            .chain(self.admission.allowed_hosts.iter().cloned())
            .collect();
        let loopback = self.listen.ip().is_loopback();
        let (connections, streams) = (self.bounds().connections, self.admission.client_streams);
        AccessRules {
            keys: self.admission.keys.unwrap_or_default(),
            // Who names somebody that vouches for people wants to know who they are.
            local: loopback && hosts.is_empty() && self.oidc.oidc_issuer.is_none(),
            // Elsewhere the names of the service are known only if they are given; there, keys are needed anyway.
            strict_hosts: loopback || !hosts.is_empty(),
            hosts,
            requests_per_second: self.admission.requests_per_second,
            unauthenticated_per_second: self.admission.requests_without_key,
            // Each has a connection: one client's leave half of those that it may have busy to its other requests, and those of all leave
            // half to others.
            waiting_per_client: streams.min((connections / 8).max(1)) as u64,
            waiting: streams.saturating_mul(8).min((connections / 2).max(1)) as u64,
        }
    }

    /// How connections are bounded.
    pub fn bounds(&self) -> Bounds {
        Bounds {
            connections: self
                .admission
                .connections
                .min(descriptors_for_connections()),
            head: self.admission.idle_time,
            stall: self.admission.idle_time.max(LEAST_STALL),
        }
    }
}

/// How the memory of `--memory-mb` is divided, in MB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// For documents sent to the service, while it reads them.
    pub reading: u64,
    /// For answers, until they have left.
    pub answers: u64,
    /// For computations.
    pub computing: u64,
}

/// The first removal of old results comes no sooner after the start. A clock that was wrong at the start is right by then.
const FIRST_LOOK: Duration = Duration::from_secs(600);

/// A client that takes nothing of its answer is given at least so long: its system may have taken two megabytes at once, which it reads at
/// 30 KB a second. Where connections are short it gives way before that.
const LEAST_STALL: Duration = Duration::from_secs(120);

/// Descriptors that the process needs for itself: the database, its log, files, requests of its own, and the reserve of connections.
const OWN_DESCRIPTORS: u64 = 128;

/// An option with its variable of the environment: `MESHWRIGHT_` and the name of its field.
pub(crate) fn with_variable(option: Arg) -> Arg {
    let variable = format!("MESHWRIGHT_{}", option.get_id().as_str().to_uppercase());
    option.env(variable)
}

/// Who may bring the tables of the database up to date, by its words.
fn migrate() -> impl TypedValueParser<Value = Migrate> {
    let words = [
        PossibleValue::new("auto")
            .help("Every process that starts, where there is something to do"),
        PossibleValue::new("never")
            .help("`meshwright migrate` only, with the rights that it takes"),
    ];
    PossibleValuesParser::new(words).map(|word| match word.as_str() {
        "never" => Migrate::Never,
        _ => Migrate::Auto,
    })
}

/// Number of connections for which the system grants the process descriptors.
fn descriptors_for_connections() -> usize {
    #[cfg(unix)]
    {
        let granted = rustix::process::getrlimit(rustix::process::Resource::Nofile).current;
        let left = granted.map_or(u64::MAX, |granted| granted.saturating_sub(OWN_DESCRIPTORS));
        usize::try_from(left).unwrap_or(usize::MAX).max(8)
    }
    #[cfg(not(unix))]
    usize::MAX
}

/// Reads a span of time: 30d, 12h, 5m, 20s, or 0.
fn span(text: &str) -> Result<Duration, String> {
    if text == "0" {
        return Ok(Duration::ZERO);
    }
    let wrong = || "expected a number and d, h, m or s, such as 30d; or 0".to_owned();
    let unit = text.chars().last().ok_or_else(wrong)?;
    let seconds: u64 = match unit {
        'd' => 24 * 3600,
        'h' => 3600,
        'm' => 60,
        's' => 1,
        _ => return Err(wrong()),
    };
    let number: u64 = text[..text.len() - unit.len_utf8()]
        .parse()
        .map_err(|_| wrong())?;
    const LONGEST: u64 = 100 * 366 * 24 * 3600;
    let all = number.checked_mul(seconds).filter(|all| *all <= LONGEST);
    all.map(Duration::from_secs)
        .ok_or_else(|| "a century is the longest".to_owned())
}

/// Reads a span that is not 0: something is done once in each, or ends with it.
///
/// # Errors
///
/// The expected form.
pub fn lasting(text: &str) -> Result<Duration, String> {
    let wrong = || "0 is too short; 1s is the least".to_owned();
    span(text).and_then(|span| Some(span).filter(|span| !span.is_zero()).ok_or_else(wrong))
}

/// Checks a public address, and takes the slash from its end.
fn public_url(text: &str) -> Result<String, String> {
    let uri: Uri = text.parse().map_err(|error| format!("{error}"))?;
    let known_scheme = matches!(uri.scheme_str(), Some("http" | "https"));
    if !known_scheme || uri.host().is_none() || uri.query().is_some() {
        return Err("expected http:// or https://, a host, and perhaps a path".to_owned());
    }
    Ok(text.trim_end_matches('/').to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_done_once_in_each_span_has_one() {
        assert_eq!(lasting("1s"), Ok(Duration::from_secs(1)));
        assert!(lasting("0").is_err() && lasting("0s").is_err());
    }

    #[test]
    fn a_span_of_time_has_a_unit() {
        for (text, seconds) in [
            ("30d", 30 * 86_400),
            ("12h", 43_200),
            ("5m", 300),
            ("20s", 20),
            ("0", 0),
        ] {
            assert_eq!(span(text), Ok(Duration::from_secs(seconds)));
        }
        for text in ["", "30", "d", "-1d", "1.5h", "1 d", "99999999999d", "5é"] {
            assert!(span(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_public_address_has_a_scheme_and_a_host_and_ends_without_a_slash() {
        assert_eq!(
            public_url("https://gears.example/api/"),
            Ok("https://gears.example/api".to_owned())
        );
        for text in [
            "gears.example",
            "/api",
            "ftp://gears.example",
            "https://gears.example/?q",
            "",
            "https://a b",
        ] {
            assert!(public_url(text).is_err(), "{text}");
        }
    }
}
