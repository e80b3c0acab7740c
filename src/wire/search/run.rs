//! A search under way: which rows come next, and what came of those that are there.

use std::collections::BTreeMap;

use meshwright_search::driver::Driver;
use meshwright_search::outcome::{Outcome, best, front};
use serde_json::{Map, Value};

use super::measure::{Judged, distance};
use super::{
    ConfirmedDesign, FoundDesign, GenerationState, RefusalState, Role, Search, SearchEnd,
    SearchState,
};
use crate::wire::study::{Design, Study};
use crate::wire::study_table::{RowState, Summary};

/// A search and what came of its rows so far. It is a function of the study and of its rows, so that nothing else has to be kept: who tells a
/// new one the same rows again goes on where the first one stopped.
pub struct Searching {
    pub(super) study: Study,
    driver: Driver,
    /// Designs that have been looked at.
    candidates: Vec<Candidate>,
    outcomes: Vec<Outcome>,
    generations: Vec<GenerationState>,
    /// Rows of generations that have ended.
    rows: u64,
    refusals: BTreeMap<String, RefusalState>,
    /// The designs of the generation that is being looked at, and what came of the first of them.
    asked: Vec<Asked>,
    fresh: Vec<Outcome>,
    /// The design whose rows are being told, and how many rows of the generation follow.
    looked: Option<Looked>,
    rows_left: usize,
    ended_by: Option<SearchEnd>,
    confirmed: Option<ConfirmedDesign>,
}

/// A design that is being looked at.
struct Asked {
    number: usize,
    point: Vec<f64>,
    changes: Map<String, Value>,
    /// So many of its rows are members.
    members: u32,
}

/// A design that has been looked at.
struct Candidate {
    row: u64,
    values: Map<String, Value>,
    goals: Vec<Option<f64>>,
    conditions: Vec<Option<f64>>,
}

/// Rows of one design.
struct Looked {
    row: u64,
    nominal: RowState,
    members: Vec<Summary>,
}

impl Searching {
    /// The search that `study` is, before its first row; none if it is none.
    pub fn new(study: Study) -> Option<Self> {
        let driver = Driver::new(study.search()?.space(study.base()));
        Some(Self {
            study,
            driver,
            candidates: Vec::new(),
            outcomes: Vec::new(),
            generations: Vec::new(),
            rows: 0,
            refusals: BTreeMap::new(),
            asked: Vec::new(),
            fresh: Vec::new(),
            looked: None,
            rows_left: 0,
            ended_by: None,
            confirmed: None,
        })
    }

    fn search(&self) -> &Search {
        self.study
            .search()
            .expect("only a search is made into one under way")
    }

    /// Rows of the generations that have ended.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// The seconds after which no further generation is to be begun.
    pub fn seconds(&self) -> Option<f64> {
        self.search().seconds()
    }

    /// Whether the row of this label is the best design once more: it stands behind all others.
    pub fn is_confirmation(label: &str) -> bool {
        Role::of_label(label) == Some(Role::Confirmed)
    }

    /// Goes on to the next generation, once all rows of the one before have been told: so many rows it has, none once every design has been asked for.
    pub fn ask(&mut self) -> usize {
        let points = self.driver.ask();
        if points.is_empty() {
            self.end();
        }
        let numbered = (self.candidates.len() + 1..).zip(points);
        self.asked = numbered
            .map(|(number, point)| self.asked_at(number, point))
            .collect();
        self.rows_left = self
            .asked
            .iter()
            .map(|asked| 1 + asked.members as usize)
            .sum();
        self.rows_left
    }

    fn asked_at(&self, number: usize, point: Vec<f64>) -> Asked {
        let changes = self.search().changes_at(&point);
        let drawn = self.study.searched(Role::Design(number), &changes);
        let looks = drawn.submission.is_ok() && self.search().looks_at_members();
        Asked {
            number,
            members: if looks {
                self.search().members() as u32
            } else {
                0
            },
            point,
            changes,
        }
    }

    /// A row of the generation that was asked for last, by its place in it.
    ///
    /// # Panics
    ///
    /// If it has no such row.
    pub fn design(&self, row: usize) -> Design {
        let mut place = row;
        for asked in &self.asked {
            let rows = 1 + asked.members as usize;
            if place < rows {
                let role = match place {
                    0 => Role::Design(asked.number),
                    member => Role::Member(asked.number, member as u32 - 1),
                };
                return self.study.searched(role, &asked.changes);
            }
            place -= rows;
        }
        panic!("the generation has no row {row}");
    }

    /// No further designs are asked for: there are none, or the time is over.
    pub fn end(&mut self) {
        self.ended_by = Some(
            if self.candidates.len() >= self.search().evaluations as usize {
                SearchEnd::Evaluations
            } else if self.driver.is_exhausted() {
                SearchEnd::Exhausted
            } else {
                SearchEnd::Seconds
            },
        );
    }

    /// What came of the next row of the generation that was asked for last.
    pub fn tell(&mut self, row: RowState) {
        match &mut self.looked {
            Some(design) if matches!(Role::of_label(&row.label), Some(Role::Member(..))) => {
                design.members.extend(row.summary);
            }
            _ => {
                self.finish_design();
                self.looked = Some(Looked {
                    row: self.rows,
                    nominal: row,
                    members: Vec::new(),
                });
            }
        }
        self.rows += 1;
        self.rows_left = self.rows_left.saturating_sub(1);
        if self.rows_left == 0 {
            self.finish_design();
            self.finish_generation();
        }
    }

    /// Judges the design whose rows have all been told.
    fn finish_design(&mut self) {
        let Some(looked) = self.looked.take() else {
            return;
        };
        let Some(asked) = self.asked.get(self.fresh.len()) else {
            return;
        };
        let (point, changes) = (asked.point.clone(), asked.changes.clone());
        let outcome = self.look_at(&point, changes, looked);
        self.fresh.push(outcome);
    }

    fn finish_generation(&mut self) {
        let outcomes = std::mem::take(&mut self.fresh);
        self.asked.clear();
        self.driver.tell(&outcomes);
        let feasible = outcomes
            .iter()
            .filter(|outcome| outcome.is_feasible())
            .count() as u32;
        self.outcomes.extend(outcomes);
        self.generations.push(GenerationState {
            best: self.least(),
            feasible,
        });
    }

    /// The least of the first goal so far.
    fn least(&self) -> Option<f64> {
        let first = *front(&self.outcomes).first()?;
        *self.candidates[first].goals.first()?
    }

    fn look_at(&mut self, point: &[f64], changes: Map<String, Value>, looked: Looked) -> Outcome {
        let Looked {
            row,
            nominal,
            members,
        } = looked;
        let search = self.search();
        let values: Vec<f64> = search
            .variables
            .iter()
            .zip(point)
            .map(|(variable, u)| variable.at(*u))
            .collect();
        let judged = match &nominal.summary {
            Some(summary) => search.judge(&values, summary, &members, self.study.gear()),
            None => {
                let submission = self.study.node_searched(&changes);
                Judged {
                    outcome: Outcome::Refused(distance(&nominal, submission.as_ref())),
                    goals: vec![None; search.goals.len()],
                    conditions: vec![None; search.conditions.len()],
                }
            }
        };
        if let Some(problem) = &nominal.problem {
            self.note_refusal(problem);
        }
        self.candidates.push(Candidate {
            row,
            values: changes,
            goals: judged.goals,
            conditions: judged.conditions,
        });
        judged.outcome
    }

    fn note_refusal(&mut self, problem: &Value) {
        let text = |name: &str| problem[name].as_str().unwrap_or_default().to_owned();
        let refusal = self
            .refusals
            .entry(text("code"))
            .or_insert_with(|| RefusalState {
                code: text("code"),
                count: 0,
                detail: text("detail"),
            });
        refusal.count += 1;
    }

    /// The best design once more, as it is to be confirmed; none where no design keeps every condition.
    pub fn confirmation(&self) -> Option<Design> {
        let found = best(&self.outcomes).filter(|i| self.outcomes[*i].is_feasible())?;
        Some(
            self.study
                .searched(Role::Confirmed, &self.candidates[found].values),
        )
    }

    /// What came of the best design once more.
    pub fn confirm(&mut self, row: &RowState) {
        let search = self.search();
        let about_members = |percent: Option<f64>| percent.is_some();
        let values: Vec<f64> = search
            .variables
            .iter()
            .map(|variable| {
                row.changes
                    .get(variable.path.text())
                    .and_then(Value::as_f64)
                    .unwrap_or(f64::NAN)
            })
            .collect();
        let judged = row
            .summary
            .as_ref()
            .map(|summary| search.judge(&values, summary, &[], self.study.gear()));
        let conditions = judged
            .as_ref()
            .map_or_else(Vec::new, |judged| judged.conditions.clone());
        let told = search
            .conditions
            .iter()
            .all(|one| !about_members(one.measure.percent));
        let feasible = judged.as_ref().and_then(|judged| match &judged.outcome {
            Outcome::Computed { violations, .. } => {
                Some(violations.iter().all(|violation| *violation == 0.0))
            }
            Outcome::Refused(_) => None,
        });
        self.confirmed = Some(ConfirmedDesign {
            row: self.rows,
            feasible: feasible.filter(|_| told),
            goals: judged.map_or_else(Vec::new, |judged| judged.goals),
            conditions,
            error_estimate: row.summary.as_ref().and_then(Summary::error_estimate),
            problem: row.problem.clone(),
        });
    }

    /// How far it has come.
    pub fn state(&self) -> SearchState {
        let found = |i: usize| {
            let candidate = &self.candidates[i];
            FoundDesign {
                row: candidate.row,
                values: candidate.values.clone(),
                feasible: self.outcomes[i].is_feasible(),
                goals: candidate.goals.clone(),
                conditions: candidate.conditions.clone(),
            }
        };
        let mut refusals: Vec<RefusalState> = self.refusals.values().cloned().collect();
        refusals.sort_by(|a, b| b.count.cmp(&a.count).then(a.code.cmp(&b.code)));
        let front = if self.search().goals.len() > 1 {
            front(&self.outcomes)
        } else {
            Vec::new()
        };
        SearchState {
            evaluations: self.candidates.len() as u64,
            best: best(&self.outcomes).map(found),
            front: front.into_iter().map(found).collect(),
            generations: self.generations.clone(),
            refusals,
            ended_by: self.ended_by,
            confirmed: self.confirmed.clone(),
        }
    }
}

impl SearchState {
    /// Why nothing was found, in a sentence; none if something was.
    pub fn why_nothing(&self) -> Option<String> {
        let most = self.refusals.first().filter(|_| self.best.is_none())?;
        Some(format!(
            "None of the {} designs could be had; {} of them for one reason, {}: {}",
            self.evaluations, most.count, most.code, most.detail
        ))
    }
}
