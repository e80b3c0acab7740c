//! The service with an engine that takes no time, or all of it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Duration;

use clap::Parser;
use meshwright::config::Config;
use meshwright::jobs::Clock;
use meshwright::serve::{Compute, World, serve};
use meshwright::times::Times;
use meshwright::webhooks::HookRules;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_wire::{Code, Problem, Submission};

use crate::SUBMISSION;

#[derive(Parser)]
pub(crate) struct Stub {
    engine: String,
    #[command(flatten)]
    config: Config,
}

/// Serves until it is interrupted.
pub(crate) fn run(arguments: Stub) -> anyhow::Result<()> {
    let compute: Compute = match arguments.engine.as_str() {
        "instant" => instant()?,
        _ => Arc::new(|_: &Submission, _: &Library, run: &Run| {
            while run.check().is_ok() {
                thread::sleep(Duration::from_millis(50));
            }
            Err(Problem::new(Code::InternalError, "stopped"))
        }),
    };
    tracing_subscriber::fmt()
        .with_max_level(tracing::Level::INFO)
        .with_writer(std::io::stderr)
        .with_ansi(false)
        .init();
    tokio::runtime::Runtime::new()?.block_on(async {
        let world = World {
            compute,
            clock: Clock::system(),
            hooks: HookRules::to_named(Vec::new()),
            times: Times::USUAL,
        };
        let service = serve(&arguments.config, world).await?;
        println!(
            "Meshwright serves http://{}; its engine is {}.",
            service.address().expect("it listens"),
            arguments.engine
        );
        tokio::signal::ctrl_c().await?;
        service.shut_down().await;
        Ok(())
    })
}

/// An engine that has the results of test case 2 ready. Those of every job differ, as those of distinct jobs do.
fn instant() -> anyhow::Result<Compute> {
    let submission = Submission::parse(SUBMISSION.as_bytes())
        .map_err(|problem| anyhow::anyhow!("{problem:?}"))?;
    let results = meshwright_wire::solve(&submission, &Library::default(), &Run::unattended())
        .map_err(|problem| anyhow::anyhow!("{problem:?}"))?;
    let jobs = AtomicU64::new(0);
    Ok(Arc::new(move |_, _, _| {
        let mut own = results.clone();
        own.curves[0].load_n += jobs.fetch_add(1, Ordering::Relaxed) as f64;
        Ok(own)
    }))
}
