//! Whole processes: `meshwright solve` cold, from the command to the end of the process, with its peak memory.
//!
//! Prints a table. Wall times are minimum and median of [`RUNS`] processes; user time is that of the fastest; peak memory is
//! the largest resident set of any.

use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use wait4::Wait4;

/// Processes for each row.
const RUNS: usize = 7;

const PAIRS: [(&str, &str); 4] = [
    ("case 1", include_str!("../api/examples/test-case-1.json")),
    ("case 2", include_str!("../api/examples/test-case-2.json")),
    ("case 3", include_str!("../api/examples/test-case-3.json")),
    (
        "standard pair",
        include_str!("../api/examples/standard-pair.json"),
    ),
];

const METHODS: [(&str, &str); 4] = [
    ("flexible", "flexible"),
    ("decomposition", "decomposition"),
    ("projected_decomposition", "projected"),
    ("load_distribution", "load distribution"),
];

/// What one process took.
struct Spent {
    wall: Duration,
    user: Duration,
    memory: u64,
}

fn main() -> io::Result<()> {
    let folder = tempfile::tempdir()?;
    println!(
        "| `meshwright solve` | wall, min ms | wall, median ms | user CPU ms | peak memory MB |"
    );
    println!("| --- | ---: | ---: | ---: | ---: |");
    for (pair, example) in PAIRS {
        for (method, name) in METHODS {
            let mut submission: Value = serde_json::from_str(example)?;
            submission["method"] = method.into();
            let path = folder.path().join("submission.json");
            std::fs::write(&path, submission.to_string())?;
            let mut runs = Vec::with_capacity(RUNS);
            for _ in 0..RUNS {
                runs.push(run(&path)?);
            }
            println!("{}", row(&format!("{pair}, {name}"), runs));
        }
    }
    Ok(())
}

fn run(submission: &Path) -> io::Result<Spent> {
    let started = Instant::now();
    let mut child = Command::new(env!("CARGO_BIN_EXE_meshwright"))
        .arg("solve")
        .arg(submission)
        .stdout(Stdio::null())
        .spawn()?;
    let used = child.wait4()?;
    let wall = started.elapsed();
    if !used.status.success() {
        return Err(io::Error::other(format!(
            "meshwright solve: {}",
            used.status
        )));
    }
    Ok(Spent {
        wall,
        user: used.rusage.utime,
        memory: used.rusage.maxrss,
    })
}

fn row(name: &str, mut runs: Vec<Spent>) -> String {
    runs.sort_by_key(|spent| spent.wall);
    let milliseconds = |duration: Duration| duration.as_secs_f64() * 1e3;
    let memory = runs.iter().map(|spent| spent.memory).max().unwrap_or(0);
    format!(
        "| {name} | {:.0} | {:.0} | {:.0} | {:.0} |",
        milliseconds(runs[0].wall),
        milliseconds(runs[RUNS / 2].wall),
        milliseconds(runs[0].user),
        memory as f64 / 1e6,
    )
}
