//! What the command line and the environment decide.

use std::net::SocketAddr;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use axum::http::{HeaderValue, Uri};

use crate::jobs::PreviewRules;
use crate::wire;

/// Where and how the service runs. Every option has its variable of the environment.
#[derive(Debug, Clone, clap::Args)]
pub struct Config {
    /// Address to listen on; port 0 takes a free one.
    #[arg(
        long,
        env = "MESHWRIGHT_LISTEN",
        default_value = "127.0.0.1:8080",
        value_name = "ADDRESS"
    )]
    pub listen: SocketAddr,

    /// File of the database; it is made if it is absent.
    #[arg(
        long,
        env = "MESHWRIGHT_DATABASE",
        default_value = "./meshwright.db",
        value_name = "FILE"
    )]
    pub database: PathBuf,

    /// Jobs computed at the same time; each may use every core [default: one for each core].
    #[arg(long, env = "MESHWRIGHT_WORKERS", value_name = "NUMBER")]
    pub workers: Option<NonZeroUsize>,

    /// Origins whose pages may call the service, separated by commas; * for all.
    #[arg(
        long,
        env = "MESHWRIGHT_CORS_ORIGIN",
        value_delimiter = ',',
        value_name = "ORIGIN"
    )]
    pub cors_origin: Vec<HeaderValue>,

    /// Address under which clients see the service, for all links [default: links are relative to the host].
    #[arg(long, env = "MESHWRIGHT_PUBLIC_URL", value_parser = public_url, value_name = "URL")]
    pub public_url: Option<String>,

    /// Jobs that may wait; further ones are refused.
    #[arg(
        long,
        env = "MESHWRIGHT_QUEUE_LIMIT",
        default_value_t = 1000,
        value_name = "NUMBER"
    )]
    pub queue_limit: u32,

    /// Time for one job; a job that takes longer fails.
    #[arg(long, env = "MESHWRIGHT_TIME_LIMIT_SECONDS", default_value_t = 600, value_name = "SECONDS",
          value_parser = clap::value_parser!(u64).range(1..=7 * 24 * 3600))]
    pub time_limit_seconds: u64,

    /// Memory for the teeth, blanks and gears that jobs and previews share, in MB of 2^20 bytes.
    #[arg(long, env = "MESHWRIGHT_CACHE_MB", default_value_t = 256, value_name = "MB",
          value_parser = clap::value_parser!(u32).range(0..=1 << 20))]
    pub cache_mb: u32,

    /// Previews that requests may wait for at the same time; further ones are refused.
    #[arg(long, env = "MESHWRIGHT_PREVIEWS", default_value_t = 8, value_name = "NUMBER",
          value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub previews: u32,

    /// Positions times torques of one preview, at most.
    #[arg(long, env = "MESHWRIGHT_PREVIEW_POSITIONS", default_value_t = 4000, value_name = "NUMBER",
          value_parser = clap::value_parser!(u64).range(1..=wire::limits().positions))]
    pub preview_positions: u64,

    /// Time for one preview, from its request to its answer.
    #[arg(long, env = "MESHWRIGHT_PREVIEW_TIME_LIMIT_SECONDS", default_value_t = 10, value_name = "SECONDS",
          value_parser = clap::value_parser!(u64).range(1..=60))]
    pub preview_time_limit_seconds: u64,
}

impl Config {
    /// The number of workers: as given, or one for each core.
    pub fn worker_count(&self) -> usize {
        self.workers
            .or_else(|| thread::available_parallelism().ok())
            .map_or(1, NonZeroUsize::get)
    }

    /// The time for one job.
    pub fn time_limit(&self) -> Duration {
        Duration::from_secs(self.time_limit_seconds)
    }

    /// Memory for the substructures that jobs and previews share, in bytes.
    pub fn cache_bytes(&self) -> usize {
        // More than can be addressed is as much as there is.
        (self.cache_mb as usize).saturating_mul(1 << 20)
    }

    /// What previews are allowed.
    pub fn preview_rules(&self) -> PreviewRules {
        PreviewRules {
            at_once: self.previews as usize,
            most_positions: self.preview_positions,
            time_limit: Duration::from_secs(self.preview_time_limit_seconds),
        }
    }
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
