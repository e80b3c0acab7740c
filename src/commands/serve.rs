//! `meshwright serve`: the service until a signal ends it.

use std::io::IsTerminal;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use anyhow::Context;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

use super::demo;
use crate::config::{Config, with_variable};
use crate::jobs::Clock;
use crate::serve::{END, World, serve};
#[cfg(feature = "otlp")]
use crate::spans::Spans;
use crate::times::Times;
use crate::webhooks::HookRules;

/// Serve jobs over HTTP.
#[derive(Debug, clap::Args)]
#[command(after_help = Times::USUAL.help())]
#[command(mut_args(|option| if option.get_id() == "demo" { option } else { with_variable(option) }))]
pub(crate) struct Serve {
    #[command(flatten)]
    config: Config,
    /// Submit test case 2 of the paper once the service runs, print its results, and go on serving.
    #[arg(long)]
    demo: bool,
    /// Collector of OpenTelemetry that takes a span of each request and each job, by OTLP over HTTP: http://localhost:4318 [default:
    /// none]. Needs a program that is built with the feature `otlp`, as the container image is.
    #[arg(long, value_parser = endpoint, value_name = "URL")]
    otlp_endpoint: Option<String>,
    /// Write the log as JSON, one object to a line.
    #[arg(long)]
    log_json: bool,
}

impl Serve {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If the service cannot start, or the demo gets an answer that it cannot read.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        let runtime = crate::runtime::runtime()?;
        let ended = runtime.block_on(self.until_signal());
        // Work that nobody waits for any more does not hold the process up.
        runtime.shutdown_background();
        ended.map(|()| ExitCode::SUCCESS)
    }

    /// Starts the log on standard error: levels by target from `MESHWRIGHT_LOG` (`info,meshwright::http=debug`), else `info`.
    fn log(&self) -> anyhow::Result<()> {
        // The demo prints by itself; the log would interrupt it.
        let quiet = if self.demo { "warn" } else { "info" };
        let levels = std::env::var("MESHWRIGHT_LOG").unwrap_or_else(|_| quiet.to_owned());
        let levels: Targets = levels
            .parse()
            .with_context(|| format!("MESHWRIGHT_LOG is no list of levels: {levels:?}"))?;
        let lines = tracing_subscriber::fmt::layer()
            .with_writer(std::io::stderr)
            .with_ansi(std::io::stderr().is_terminal());
        let registry = tracing_subscriber::registry().with(levels);
        if self.log_json {
            registry.with(lines.json()).init();
        } else {
            registry.with(lines).init();
        }
        Ok(())
    }

    async fn until_signal(&self) -> anyhow::Result<()> {
        self.log()?;
        let world = World {
            compute: Arc::new(meshwright_studies::solve),
            clock: Clock::system(),
            hooks: HookRules::to_named(self.config.admission.webhook_hosts.clone()),
            times: Times::USUAL,
        };
        #[cfg(feature = "otlp")]
        let spans = {
            let spans = self.otlp_endpoint.as_deref().map(Spans::start);
            spans.transpose().context("spans cannot be exported")?
        };
        let service = serve(&self.config, world).await?;
        match service.address() {
            Some(address) => {
                println!("Meshwright serves http://{address}; its documentation is at /docs.");
                if self.demo {
                    demo::run(address).await?;
                }
            }
            None => println!("Meshwright computes jobs of {}.", self.config.database),
        }
        signal().await?;
        end_in_any_case();
        // A second signal does not wait for the end of the first.
        let end = async {
            service.shut_down().await;
            #[cfg(feature = "otlp")]
            if let Some(spans) = spans {
                spans.end().await;
            }
        };
        tokio::select! {
            () = end => Ok(()),
            second = signal() => second,
        }
    }
}

/// Checks the address of a collector, below which /v1/traces is.
fn endpoint(text: &str) -> Result<String, String> {
    if cfg!(not(feature = "otlp")) {
        return Err(
            "this program is built without the export of spans; build it with --features otlp"
                .to_owned(),
        );
    }
    let uri: axum::http::Uri = text.parse().map_err(|error| format!("{error}"))?;
    let known_scheme = matches!(uri.scheme_str(), Some("http" | "https"));
    if !known_scheme || uri.host().is_none() || uri.query().is_some() {
        return Err("expected http:// or https://, a host, and perhaps a path".to_owned());
    }
    Ok(text.to_owned())
}

/// Ends the process when its shutdown takes too long, even if no thread of the runtime runs any more. Answered requests are on the disk. The next start finds
/// the jobs that ran.
fn end_in_any_case() {
    std::thread::spawn(|| {
        std::thread::sleep(END + Duration::from_millis(500));
        eprintln!(
            "The service did not end in order in {} s, and is cut off.",
            END.as_secs()
        );
        std::process::exit(1);
    });
}

/// Comes with ctrl-c, or when the system asks the process to end.
pub(super) async fn signal() -> anyhow::Result<()> {
    let interrupt = tokio::signal::ctrl_c();
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let mut terminate = signal(SignalKind::terminate()).context("cannot listen for signals")?;
        tokio::select! {
            result = interrupt => result.context("cannot listen for signals"),
            _ = terminate.recv() => Ok(()),
        }
    }
    #[cfg(not(unix))]
    interrupt.await.context("cannot listen for signals")
}
