//! `meshwright serve --demo`: test case 2 of the paper, submitted and followed over HTTP as a portal would.

use std::io::{IsTerminal, Write};
use std::net::SocketAddr;

use anyhow::{Context, bail};
use serde_json::Value;

use super::chart::line_chart;

/// The submission of the demo.
const TEST_CASE_2: &str = include_str!("../../api/examples/test-case-2.json");

/// Submits the case to the service at `address`, follows its events, and prints the results.
pub(super) async fn run(address: SocketAddr) -> anyhow::Result<()> {
    let base = format!("http://{address}");
    let client = crate::client().build().context("no client can be set up")?;
    println!(
        "\nPOST {base}/v1/jobs: test case 2 of the paper, 10 holes in the driven gear, 115 N m, flexible method."
    );
    let answer = client
        .post(format!("{base}/v1/jobs"))
        .header("content-type", "application/json")
        .body(TEST_CASE_2)
        .send()
        .await
        .context("the service does not answer")?;
    let (status, job): (_, Value) = (
        answer.status(),
        answer.json().await.context("the job is not JSON")?,
    );
    if status == reqwest::StatusCode::UNAUTHORIZED {
        bail!(
            "the demo has no key, and this service asks for one: let it listen on this machine alone, or leave --demo out"
        );
    }
    let link = |name: &str| -> anyhow::Result<String> {
        let path = job["links"][name]
            .as_str()
            .with_context(|| format!("the job has no link to its {name}: {job}"))?;
        Ok(if path.starts_with('/') {
            format!("{base}{path}")
        } else {
            path.to_owned()
        })
    };
    if job["links"]["same_as"].is_string() {
        println!("The service has computed this before: its results are kept.");
    }
    follow(&client, &link("events")?).await?;

    let job_now: Value = client.get(link("self")?).send().await?.json().await?;
    if job_now["status"] != "successful" {
        bail!(
            "the job ended as {}: {}",
            job_now["status"],
            job_now["problem"]
        );
    }
    let results: Value = client.get(link("results")?).send().await?.json().await?;
    show(&results, &job_now)?;
    println!(
        "  page     {base}/\n  job      {}\n  results  {}\n  curve    {}/ste.csv, {0}/results/ste.svg\n  docs     {base}/docs\n",
        link("self")?,
        link("results")?,
        link("results")?
    );
    println!("Still serving; ctrl-c ends it.");
    Ok(())
}

/// Shows the progress in the job's events until they end.
async fn follow(client: &reqwest::Client, events: &str) -> anyhow::Result<()> {
    let mut stream = client
        .get(events)
        .send()
        .await
        .context("the job has no events")?;
    let mut pending = String::new();
    let mut last = String::new();
    while let Some(chunk) = stream.chunk().await.context("the events broke off")? {
        pending.push_str(&String::from_utf8_lossy(&chunk));
        while let Some(end) = pending.find('\n') {
            let line: String = pending.drain(..=end).collect();
            let Some(data) = line
                .strip_prefix("data:")
                .and_then(|data| serde_json::from_str::<Value>(data.trim()).ok())
            else {
                continue;
            };
            let Some(percent) = data["progress_percent"].as_u64() else {
                continue;
            };
            let line = format!(
                "  {percent:3} %  {} of {} positions",
                data["positions_done"], data["positions_total"]
            );
            if line == last {
                continue;
            }
            if std::io::stdout().is_terminal() {
                print!("\r{line}");
                std::io::stdout().flush()?;
            } else {
                println!("{line}");
            }
            last = line;
        }
    }
    println!();
    Ok(())
}

fn show(results: &Value, job: &Value) -> anyhow::Result<()> {
    let curve = &results["curves"][0];
    let values: Vec<f64> = curve["transmission_error_um"]
        .as_array()
        .context("no curve")?
        .iter()
        .filter_map(Value::as_f64)
        .collect();
    let span = results["pair"]["period_mesh_periods"]
        .as_f64()
        .context("no period")?;
    println!("Static transmission error in um over one true period, {span} mesh periods:\n");
    println!("{}", line_chart(&values, span, "mesh periods", 96, 17));
    let (ste, k) = (
        &curve["statistics"]["transmission_error_um"],
        &curve["statistics"]["mesh_stiffness_tangent_n_per_m"],
    );
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    println!(
        "  transmission error  mean {:.3}  rms {:.3}  peak-to-peak {:.3} um",
        number(&ste["mean"]),
        number(&ste["rms"]),
        number(&ste["peak_to_peak"])
    );
    println!(
        "  mesh stiffness      mean {:.4e}  rms {:.3e}  peak-to-peak {:.3e} N/m",
        number(&k["mean"]),
        number(&k["rms"]),
        number(&k["peak_to_peak"])
    );
    println!(
        "  solved in {} s, equilibrium to {:.0e}; the paper's finite elements took 15 h.\n",
        number(&job["wall_time_seconds"]),
        number(&results["evidence"]["equilibrium_residual"])
    );
    Ok(())
}
