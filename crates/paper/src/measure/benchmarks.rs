//! Results of `cargo bench`, beside the paper's times and the goals.

use std::fs;
use std::path::Path;

use anyhow::Context;
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// The groups of benchmarks in the order of the table.
const GROUPS: [&str; 9] = [
    "cold",
    "teeth known",
    "change",
    "study",
    "resolution",
    "case 2, driven gear",
    "case 2, one position",
    "case 3, driven gear",
    "case 3, one position",
];

/// The least time of one benchmark.
#[derive(Debug)]
pub(super) struct Benchmark {
    pub(super) group: String,
    pub(super) name: String,
    pub(super) seconds: f64,
}

/// The fields of a benchmark's name in criterion's files.
#[derive(Deserialize)]
struct Identity {
    group_id: String,
    function_id: String,
}

/// The fields of a benchmark's samples in criterion's files.
#[derive(Deserialize)]
struct Samples {
    iters: Vec<f64>,
    /// In nanoseconds, of all iterations of a sample together.
    times: Vec<f64>,
}

/// The benchmarks of the last run in `folder`, that of criterion, by group and name.
///
/// # Errors
///
/// If it cannot be read, or holds none.
pub(super) fn found(folder: &Path) -> anyhow::Result<Vec<Benchmark>> {
    let mut found = Vec::new();
    let none = || {
        format!(
            "{} holds no benchmarks: cargo bench -p meshwright-benches makes them",
            folder.display()
        )
    };
    for group in fs::read_dir(folder).with_context(none)? {
        let group = group?.path();
        if !group.is_dir() {
            continue;
        }
        for benchmark in fs::read_dir(group)? {
            let run = benchmark?.path().join("new");
            if run.join("sample.json").is_file() {
                found.push(read_benchmark(&run)?);
            }
        }
    }
    // A folder of criterion keeps the names of earlier benchmarks.
    found.retain(|benchmark| GROUPS.contains(&benchmark.group.as_str()));
    anyhow::ensure!(!found.is_empty(), none());
    found.sort_by_key(|benchmark| {
        let group = GROUPS.iter().position(|group| *group == benchmark.group);
        (group, benchmark.name.clone())
    });
    Ok(found)
}

/// The least of the samples in `run`, each the mean of its iterations.
fn read_benchmark(run: &Path) -> anyhow::Result<Benchmark> {
    let identity: Identity = read(&run.join("benchmark.json"))?;
    let samples: Samples = read(&run.join("sample.json"))?;
    let nanoseconds = samples.times.iter().zip(&samples.iters);
    let least = nanoseconds
        .map(|(time, iterations)| time / iterations)
        .fold(f64::INFINITY, f64::min);
    Ok(Benchmark {
        group: identity.group_id,
        name: identity.function_id,
        seconds: least / 1e9,
    })
}

fn read<T: DeserializeOwned>(path: &Path) -> anyhow::Result<T> {
    let text =
        fs::read_to_string(path).with_context(|| format!("{} cannot be read", path.display()))?;
    serde_json::from_str(&text)
        .with_context(|| format!("{} is none of criterion's", path.display()))
}

/// The paper's time for a benchmark, and the goal.
pub(super) fn expectation(benchmark: &Benchmark) -> (&'static str, &'static str) {
    match (benchmark.group.as_str(), benchmark.name.as_str()) {
        ("cold", "case 1, flexible") => ("15 h", "600 ms"),
        ("cold", "case 2, flexible") => ("15 h", "300 ms"),
        ("cold", "case 3, flexible") => ("40 h", "1500 ms"),
        ("cold", "case 3, decomposition") => ("40 min", "300 ms"),
        ("cold", "case 1, decomposition" | "case 2, decomposition") => ("30 min", "300 ms"),
        ("cold", name) if name.starts_with("case") && name.ends_with("projected") => ("", "300 ms"),
        ("teeth known", name) if name.starts_with("case") && !name.ends_with("flexible") => {
            ("", "100 ms")
        }
        ("change", "case 2, flexible, holes moved, 20 positions a mesh period") => ("", "50 ms"),
        ("study", name) if name.ends_with("flexible") => ("days", "2000 ms"),
        _ => ("", ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_sample_of_each_benchmark_is_told_in_the_order_of_the_groups() {
        let folder = tempfile::tempdir().expect("a folder");
        let put = |group: &str, name: &str, times: &str| {
            let run = folder.path().join(group).join(name).join("new");
            fs::create_dir_all(&run).expect("made");
            let identity = format!(r#"{{"group_id": "{group}", "function_id": "{name}"}}"#);
            fs::write(run.join("benchmark.json"), identity).expect("written");
            let samples = format!(r#"{{"iters": [1.0, 2.0], "times": {times}}}"#);
            fs::write(run.join("sample.json"), samples).expect("written");
        };
        assert!(found(folder.path()).is_err());
        put("change", "b", "[4e6, 6e6]");
        put("cold", "case 1, flexible", "[7e6, 16e6]");
        put("no longer run", "a", "[1.0, 1.0]");
        let found = found(folder.path()).expect("two benchmarks");
        let told: Vec<_> = found.iter().map(|of| (&*of.name, of.seconds)).collect();
        assert_eq!(told, [("case 1, flexible", 7e-3), ("b", 3e-3)]);
        assert_eq!(expectation(&found[0]), ("15 h", "600 ms"));
    }
}
