//! `meshwright-paper measure`: the speed of this machine, and the growth of time with the size of a request.
//!
//! Read in this order: [`stopwatch`] (definition of a time), [`benchmarks`] (results of `cargo bench`), [`growth`] (one quantity varied at a time), [`levels`]
//! (cost and gain of a finer grid), [`report`] (tables and figures).

mod benchmarks;
mod growth;
mod levels;
mod report;
mod stopwatch;

use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::Context;

use benchmarks::Benchmark;
use growth::Growth;
use levels::LevelRow;

/// Measure the speed of this machine, and the growth of time with the size of a request: tables and four figures. It takes a minute or two; other work on the
/// machine makes its numbers worse.
#[derive(Debug, clap::Args)]
pub(crate) struct Measure {
    /// Folder of the results of cargo bench.
    #[arg(long, default_value = "target/criterion", value_name = "DIR")]
    criterion: PathBuf,
    /// The folder to write measured.md and the figures to.
    #[arg(long, short, default_value = "target/performance", value_name = "DIR")]
    output: PathBuf,
}

/// Everything that is measured.
#[derive(Debug)]
struct Measured {
    machine: Machine,
    benchmarks: Vec<Benchmark>,
    growth: Vec<Growth>,
    grid_levels: Vec<LevelRow>,
}

/// The machine and the version of the measurements.
#[derive(Debug)]
struct Machine {
    processor: String,
    threads: usize,
    version: &'static str,
    compiler: &'static str,
}

impl Machine {
    fn this() -> Self {
        // Only Linux tells without asking the processor itself.
        let told = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = told
            .lines()
            .find(|line| line.starts_with("model name"))
            .and_then(|line| line.split_once(':'));
        Self {
            processor: model
                .map_or(std::env::consts::ARCH, |(_, name)| name.trim())
                .to_owned(),
            threads: rayon::current_num_threads(),
            version: env!("CARGO_PKG_VERSION"),
            compiler: env!("MESHWRIGHT_COMPILER"),
        }
    }
}

impl Measure {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If a case cannot be computed or a file cannot be written.
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        let started = Instant::now();
        let tell = |what: &str| println!("{:5.1} s  {what}", started.elapsed().as_secs_f64());
        let benchmarks = benchmarks::found(&self.criterion)?;
        let growth = growth::measured(&|what| tell(what))?;
        tell("Grid levels.");
        let measured = Measured {
            machine: Machine::this(),
            benchmarks,
            growth,
            grid_levels: levels::measured()?,
        };
        fs::create_dir_all(&self.output)
            .with_context(|| format!("{} cannot be created", self.output.display()))?;
        self.write("measured.md", &report::text(&measured))?;
        for growth in &measured.growth {
            self.write(&growth.file(), &report::figure(growth).to_svg())?;
        }
        tell(&format!("{} is complete.", self.output.display()));
        Ok(())
    }

    fn write(&self, file: &str, text: &str) -> anyhow::Result<()> {
        let path = self.output.join(file);
        fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))
    }
}
