//! `meshwright study`: a study from a file, computed here and now.

mod compute;
mod folder;
mod picture;
mod tables;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use meshwright_engine::run::Run;
use meshwright_studies::table::{csv, table};
use meshwright_studies::{
    PopulationResults, PopulationSample, Study as StudyDocument, StudyResults,
};

use self::compute::{Computed, compute};
use self::folder::ResultFolder;
use self::picture::picture;
use self::tables::{search_table, short_table, spread_table};
use super::document::{EXIT_PROBLEM, has_field, read, text_of};
use crate::jobs::{search_state, why_failed};

/// Compute a study: many variants of one submission, and their table.
#[derive(Debug, clap::Args)]
pub(crate) struct Study {
    /// The study; - reads standard input.
    study: PathBuf,
    /// Folder for table.json, table.csv and picture.svg, and each result unless the study keeps statistics only. A population adds population.json. A search
    /// adds search.json, how it went, and best.json, the submission of the best design. The folder is made if it is absent. Without it, only a short table is
    /// printed.
    #[arg(long, short, value_name = "DIR")]
    output: Option<PathBuf>,
}

impl Study {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If a file cannot be read or written. A study that is refused, or none of whose designs can be computed, is exit
    /// code 2.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        let document = read(&self.study)?;
        if has_field(&document, "pair") {
            eprintln!("This is a submission, not a study; `meshwright solve` computes it.");
            return Ok(ExitCode::from(EXIT_PROBLEM));
        }
        let study = match StudyDocument::submitted(&document, &Run::unattended()) {
            Ok(study) => study,
            Err(problem) => {
                eprint!("{}", text_of(&problem));
                return Ok(ExitCode::from(EXIT_PROBLEM));
            }
        };
        let folder = self.output.as_deref().map(ResultFolder::make).transpose()?;

        let started = Instant::now();
        let computed = compute(&study, folder.as_ref())?;
        let elapsed = started.elapsed();

        let search = search_state(&computed.record);
        let best = search.as_ref().and_then(|search| {
            let row = usize::try_from(search.best.as_ref()?.row).ok()?;
            let row = computed.rows.get(row)?;
            study.submission_searched(&row.label, &row.changes)
        });
        let population = population(&study, &computed);
        let results = results(&study, computed);
        if let Some(folder) = &folder {
            folder.write_json("table.json", &results)?;
            folder.write("table.csv", &csv(&results.rows))?;
            if let Some(population) = &population {
                folder.write_json("population.json", population)?;
            }
            if let Some(search) = &search {
                folder.write_json("search.json", search)?;
            }
            if let Some(best) = &best {
                folder.write("best.json", &format!("{best}\n"))?;
            }
            if let Some(picture) = picture(&study, &results, population.as_ref(), search.as_ref()) {
                folder.write("picture.svg", &picture.to_svg())?;
            }
        }
        match (&search, &population) {
            (Some(search), _) => print!("{}", search_table(&study, search, elapsed)),
            (None, Some(population)) => print!("{}", spread_table(population, elapsed)),
            (None, None) => print!("{}", short_table(&results, elapsed)),
        }
        let Some(problem) = &results.problem else {
            return Ok(ExitCode::SUCCESS);
        };
        // The table of a search ends with it.
        if search.is_none() {
            eprintln!("{}", problem["detail"].as_str().unwrap_or_default());
        }
        Ok(ExitCode::from(EXIT_PROBLEM))
    }
}

/// Results of a population; `None` if no member has any.
fn population(study: &StudyDocument, computed: &Computed) -> Option<PopulationResults> {
    let mut sample = PopulationSample::new(study, 0..StudyDocument::MOST_TORQUES)?;
    for (member, row) in (0..).zip(&computed.rows) {
        sample.add(member, row);
    }
    Some(sample.results(None, computed.record.status()))
}

fn results(study: &StudyDocument, computed: Computed) -> StudyResults {
    let Computed { record, rows } = computed;
    let problem = why_failed(&record);
    StudyResults {
        id: None,
        status: record.status(),
        done: record.done(),
        total: record.total,
        gear: study.gear(),
        problem: problem
            .map(|problem| serde_json::to_value(problem).expect("a problem is strings")),
        rows: table(study.gear(), rows),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::time::Duration;

    use meshwright_wire::Status;
    use serde_json::{Value, json};

    use super::*;

    fn study() -> StudyDocument {
        let mut study: Value =
            serde_json::from_str(meshwright_wire::examples::STUDY_SECTION_5).unwrap();
        // The formulas do not see holes, but they are quick.
        study["base"]["method"] = json!("load_distribution");
        let designs = study["designs"].as_array_mut().unwrap();
        designs.push(json!({ "label": "8R34 again", "changes": designs[1]["changes"] }));
        designs.push(json!({ "label": "14R34", "changes": {
            "/pair/driven/blank/holes": { "count": 14, "circle_radius_mm": 45 } } }));
        StudyDocument::parse(study.to_string().as_bytes(), &Run::unattended()).unwrap()
    }

    #[test]
    fn a_study_leaves_its_table_and_every_result() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        let folder = ResultFolder::make(&path).unwrap();
        let computed = compute(&study(), Some(&folder)).unwrap();
        assert_eq!(population(&study(), &computed), None);
        let results = results(&study(), computed);
        let labels: Vec<&str> = results.rows.iter().map(|row| &*row.label).collect();
        assert_eq!(
            labels,
            [
                "standard",
                "8R34",
                "10R34",
                "6R30",
                "8R30",
                "8R27",
                "8R34 again",
                "14R34"
            ]
        );
        assert_eq!(results.rows[1].curves, results.rows[6].curves);
        assert_eq!(results.rows[7].status, Status::Failed);
        assert_eq!(
            results.rows[7].problem.as_ref().unwrap()["code"],
            "holes_breach_rim"
        );
        let files = fs::read_dir(path.join("results")).unwrap().count();
        assert_eq!(files, 7);
        assert!(path.join("results/00002-8R34.json").exists());

        let drawn = picture(&study(), &results, None, None).expect("seven designs");
        let svg = drawn.to_svg();
        assert!(svg.contains("Mass of both gears in kg"), "{svg}");
        assert!(svg.contains("that no other beats"), "{svg}");
        let text = short_table(&results, Duration::from_secs(2));
        assert!(
            text.contains("7 of 8 designs computed in 2.00 s, 3.5 a second."),
            "{text}"
        );
        assert!(text.contains("14R34: "), "{text}");
    }

    #[test]
    fn a_search_whose_confirmation_fails_says_so_first_and_why_members_failed_last() {
        use meshwright_studies::refusals::RefusalState;
        use meshwright_studies::searching::{ConfirmedDesign, FoundDesign};
        let search = include_str!("../../../api/examples/search-holes.json");
        let search = StudyDocument::parse(search.as_bytes(), &Run::unattended()).unwrap();
        let state = meshwright_studies::SearchState {
            evaluations: 3,
            best: Some(FoundDesign {
                row: 1,
                values: serde_json::Map::new(),
                feasible: false,
                goals: vec![Some(1.0)],
                conditions: vec![Some(25.0), Some(0.0)],
                failed_share: Some(0.25),
            }),
            confirmed: Some(ConfirmedDesign {
                row: 9,
                feasible: Some(false),
                goals: vec![Some(1.1)],
                conditions: vec![Some(25.0), Some(43.3)],
                error_estimate: None,
                problem: None,
            }),
            member_refusals: vec![RefusalState {
                code: "too_large".to_owned(),
                count: 5,
                detail: "Too many positions.".to_owned(),
            }],
            ..Default::default()
        };
        let text = search_table(&search, &state, Duration::from_secs(2));
        let lines: Vec<&str> = text.lines().collect();
        assert!(
            lines[0].starts_with("NOT FEASIBLE: ") && lines[0].contains("43.3"),
            "{text}"
        );
        assert!(
            text.contains("25.0 % of its members have no results"),
            "{text}"
        );
        let last = lines.last().unwrap();
        assert!(
            last.starts_with("3 designs in ")
                && last.ends_with("5 members failed: 5 too_large; the first: Too many positions."),
            "{text}"
        );
    }

    /// Pairs of the paper, by formulas, whose center distances differ.
    fn at_distances(low: f64, high: f64) -> Value {
        let mut document: Value =
            serde_json::from_str(meshwright_wire::examples::STUDY_SECTION_5).unwrap();
        document["base"]["method"] = json!("load_distribution");
        document.as_object_mut().unwrap().remove("designs");
        document.as_object_mut().unwrap().remove("constant_mass");
        document["name"] = json!("Center distances of the spring");
        document["population"] = json!({ "size": 80, "vary": [
            { "path": "/pair/center_distance_mm", "kind": "uniform", "low": low, "high": high }
        ] });
        document
    }

    #[test]
    fn the_last_line_of_a_population_says_how_many_members_were_computed_and_why_others_failed() {
        let document = at_distances(99.9, 101.0);
        let study =
            StudyDocument::parse(document.to_string().as_bytes(), &Run::unattended()).unwrap();
        let computed = compute(&study, None).unwrap();
        let failed: Vec<&Value> = computed
            .rows
            .iter()
            .filter_map(|row| row.problem.as_ref())
            .collect();
        // Without profile shift teeth of 50 and 50 have no backlash at 100 mm.
        let nearer = (0..study.total()).filter(|member| {
            let design = study.design(*member).unwrap();
            design.changes["/pair/center_distance_mm"].as_f64().unwrap() < 100.0
        });
        assert_eq!(failed.len(), nearer.count());
        assert!(failed.len() > 4, "{}", failed.len());
        let found = population(&study, &computed).expect("a population");
        let text = spread_table(&found, Duration::from_secs(2));
        let expected = format!(
            "{} of 80 members computed in 2.00 s, {:.1} a second. {} members failed: {} {}; the first: {}",
            80 - failed.len(),
            (80 - failed.len()) as f64 / 2.0,
            failed.len(),
            failed.len(),
            failed[0]["code"].as_str().unwrap(),
            failed[0]["detail"].as_str().unwrap(),
        );
        assert_eq!(text.lines().last(), Some(&*expected));
    }

    #[test]
    fn a_population_leaves_what_its_members_come_to() {
        let mut document = at_distances(100.45, 100.55);
        let study =
            StudyDocument::parse(document.to_string().as_bytes(), &Run::unattended()).unwrap();
        let computed = compute(&study, None).unwrap();
        let found = population(&study, &computed).expect("a population");
        assert_eq!((found.size, found.done, found.failed), (80, 80, 0));
        let drawn = picture(&study, &results(&study, computed), Some(&found), None);
        let svg = drawn.expect("two torques").to_svg();
        assert!(svg.contains("p95"), "{svg}");
        assert!(svg.contains("Center distances of the spring"), "{svg}");
        // One torque has a histogram, which names it and the percentiles.
        document["base"]["output_torques_n_m"] = json!([115]);
        let one =
            StudyDocument::parse(document.to_string().as_bytes(), &Run::unattended()).unwrap();
        let of_one = compute(&one, None).unwrap();
        let spread = population(&one, &of_one).expect("a population");
        let drawn = picture(&one, &results(&one, of_one), Some(&spread), None);
        let svg = drawn.expect("one torque").to_svg();
        let peaks = spread
            .quantities
            .iter()
            .find(|quantity| quantity.name.ends_with("peak_to_peak"));
        let p95 = peaks
            .unwrap()
            .percentiles
            .iter()
            .find(|one| one.percent == 95.0)
            .unwrap()
            .value;
        assert!(
            svg.contains("115 N m, p5 ") && svg.contains(&format!("p95 {p95:.3}")),
            "{svg}"
        );
        let text = spread_table(&found, Duration::from_secs(2));
        assert!(
            text.contains("80 of 80 members computed in 2.00 s, 40.0 a second."),
            "{text}"
        );
        assert!(
            text.contains(
                "% of the variance of the peak-to-peak value comes from /pair/center_distance_mm."
            ),
            "{text}"
        );
    }
}
