//! What `cargo bench` found, as a table beside the paper's times, the goals and an earlier run.
//!
//! `cargo run --release --example bench_table -- CRITERION_FOLDER [--baseline NAME] [--before BEFORE.csv]
//! [--csv]` prints Markdown, or with `--csv` what a later run takes as `--before`. Times are the least of criterion's samples,
//! each the mean of its iterations: other work on a machine only ever adds time.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

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

#[derive(Deserialize)]
struct Benchmark {
    group_id: String,
    function_id: String,
}

#[derive(Deserialize)]
struct Sample {
    iters: Vec<f64>,
    /// In nanoseconds, of all iterations of a sample together.
    times: Vec<f64>,
}

struct Row {
    group: String,
    name: String,
    milliseconds: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (mut folder, mut baseline, mut before, mut csv) = (
        PathBuf::from("target/criterion"),
        "new".to_owned(),
        None,
        false,
    );
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--baseline" => baseline = arguments.next().ok_or("--baseline wants a name")?,
            "--before" => before = Some(arguments.next().ok_or("--before wants a file")?),
            "--csv" => csv = true,
            other => folder = PathBuf::from(other),
        }
    }
    let rows = rows(&folder, &baseline)?;
    if csv {
        println!("group;name;least_ms");
        for row in &rows {
            println!("{};{};{:.6}", row.group, row.name, row.milliseconds);
        }
        return Ok(());
    }
    let before = match before {
        Some(path) => read_before(&fs::read_to_string(path)?)?,
        None => Vec::new(),
    };
    println!("| what | paper | goal | before | after |");
    println!("| --- | ---: | ---: | ---: | ---: |");
    let mut group = "";
    for row in &rows {
        if row.group != group {
            group = &row.group;
            println!("| **{group}** | | | | |");
        }
        let (paper, goal) = expectation(group, &row.name);
        let known = before
            .iter()
            .find(|known| known.group == row.group && known.name == row.name);
        println!(
            "| {} | {paper} | {goal} | {} | {} |",
            row.name,
            known.map_or("-".to_owned(), |known| shown(known.milliseconds)),
            shown(row.milliseconds)
        );
    }
    Ok(())
}

/// The benchmarks of a run by group and name.
fn rows(folder: &Path, baseline: &str) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for group in fs::read_dir(folder)? {
        let group = group?.path();
        if !group.is_dir() {
            continue;
        }
        for benchmark in fs::read_dir(group)? {
            let run = benchmark?.path().join(baseline);
            if !run.join("sample.json").is_file() {
                continue;
            }
            let names: Benchmark = read(&run.join("benchmark.json"))?;
            let sample: Sample = read(&run.join("sample.json"))?;
            let times = sample.times.iter().zip(&sample.iters);
            let least = times
                .map(|(time, iterations)| time / iterations)
                .fold(f64::INFINITY, f64::min);
            rows.push(Row {
                group: names.group_id,
                name: names.function_id,
                milliseconds: least / 1e6,
            });
        }
    }
    // A folder of criterion keeps what earlier benchmarks were called.
    rows.retain(|row| GROUPS.contains(&row.group.as_str()));
    rows.sort_by_key(|row| {
        let group = GROUPS.iter().position(|group| *group == row.group);
        (group, row.name.clone())
    });
    Ok(rows)
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T, Box<dyn Error>> {
    let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(serde_json::from_str(&text)?)
}

fn read_before(text: &str) -> Result<Vec<Row>, Box<dyn Error>> {
    let rows = text.lines().skip(1).map(|line| {
        let mut cells = line.split(';').map(str::to_owned);
        let mut next = || cells.next().ok_or(format!("{line} lacks a cell"));
        Ok(Row {
            group: next()?,
            name: next()?,
            milliseconds: next()?.parse()?,
        })
    });
    rows.collect()
}

/// What the paper took and what DESIGN section 6 wants.
fn expectation(group: &str, name: &str) -> (&'static str, &'static str) {
    match (group, name) {
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

fn shown(milliseconds: f64) -> String {
    match milliseconds {
        t if t >= 100.0 => format!("{t:.0} ms"),
        t if t >= 1.0 => format!("{t:.1} ms"),
        t => format!("{:.1} µs", t * 1e3),
    }
}
