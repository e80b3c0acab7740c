//! A running search: choice of the next rows, and outcomes of the earlier ones; `state` is the view of its study.

mod state;

use serde_json::{Map, Value};

use crate::optimum::driver::Driver;
use crate::optimum::outcome::{Outcome, best, front};
use crate::refusals::Refusals;
use crate::search::measure::{Judged, distance, failed_share};
use crate::search::{Role, Search};
use crate::study::{Design, Study};
use crate::table::{RowState, Summary};

pub use state::*;

/// A search and the outcomes of its rows so far. It is a function of the study and of its rows, so that nothing else has to be stored: a new one continues
/// where the old one stopped once it has the same rows.
pub struct Searching {
    pub(crate) study: Study,
    driver: Driver,
    /// Designs that have been looked at.
    candidates: Vec<Candidate>,
    outcomes: Vec<Outcome>,
    generations: Vec<GenerationState>,
    /// Rows of generations that have ended.
    rows: u64,
    refusals: Refusals,
    /// Why members of designs that could be had could not.
    member_refusals: Refusals,
    /// The designs of the current generation, and the outcomes of the first of them.
    asked: Vec<Asked>,
    fresh: Vec<Outcome>,
    /// The design whose rows are being read, and how many rows of the generation follow.
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
    /// Number of its rows that are members.
    members: u32,
}

/// A design that has been looked at.
struct Candidate {
    row: u64,
    values: Map<String, Value>,
    goals: Vec<Option<f64>>,
    conditions: Vec<Option<f64>>,
    failed_share: Option<f64>,
}

/// Rows of one design.
struct Looked {
    row: u64,
    nominal: RowState,
    /// None of those without results.
    members: Vec<Option<Summary>>,
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
            refusals: Refusals::default(),
            member_refusals: Refusals::default(),
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

    /// True if the row of this label is the confirmation of the best design: it stands behind all others.
    pub fn is_confirmation(label: &str) -> bool {
        Role::of_label(label) == Some(Role::Confirmed)
    }

    /// Goes on to the next generation, once all rows of the one before have been read: so many rows it has, none once every design has been asked for.
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

    /// Reports the outcome of the next row of the current generation.
    pub fn tell(&mut self, row: RowState) {
        match &mut self.looked {
            Some(design) if matches!(Role::of_label(&row.label), Some(Role::Member(..))) => {
                self.member_refusals.note(row.problem.as_ref());
                design.members.push(row.summary);
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

    /// Judges the design whose rows have all been read.
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
        self.refusals.note(nominal.problem.as_ref());
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
        self.candidates.push(Candidate {
            row,
            values: changes,
            goals: judged.goals,
            conditions: judged.conditions,
            failed_share: failed_share(&members),
        });
        judged.outcome
    }

    /// The best design once more, as it is to be confirmed; none where no design keeps every condition.
    pub fn confirmation(&self) -> Option<Design> {
        let found = best(&self.outcomes).filter(|i| self.outcomes[*i].is_feasible())?;
        Some(
            self.study
                .searched(Role::Confirmed, &self.candidates[found].values),
        )
    }

    /// Reports the outcome of the confirmation.
    pub fn confirm(&mut self, row: &RowState) {
        let search = self.search();
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
        let feasible = match &row.summary {
            Some(summary) => search.is_kept_as_drawn(summary, self.study.gear()),
            None => Some(false),
        };
        let (goals, conditions) =
            judged.map_or_else(Default::default, |judged| (judged.goals, judged.conditions));
        self.confirmed = Some(ConfirmedDesign {
            row: self.rows,
            feasible,
            goals,
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
                failed_share: candidate.failed_share,
            }
        };
        let confirmed = self.confirmed.as_ref();
        let has_failed = confirmed.is_some_and(|confirmed| confirmed.feasible == Some(false));
        let best = best(&self.outcomes).map(found).map(|best| FoundDesign {
            feasible: best.feasible && !has_failed,
            ..best
        });
        let front = if self.search().goals.len() > 1 {
            front(&self.outcomes)
        } else {
            Vec::new()
        };
        SearchState {
            evaluations: self.candidates.len() as u64,
            best,
            front: front.into_iter().map(found).collect(),
            generations: self.generations.clone(),
            refusals: self.refusals.most_common_first(),
            member_refusals: self.member_refusals.most_common_first(),
            ended_by: self.ended_by,
            confirmed: self.confirmed.clone(),
        }
    }
}

impl SearchState {
    /// Why nothing was found, in a sentence; none if something was.
    pub fn why_nothing(&self) -> Option<String> {
        if self.best.is_some() {
            return None;
        }
        if let Some(most) = self.refusals.first() {
            return Some(format!(
                "None of the {} designs could be had; {} of them for one reason, {}: {}",
                self.evaluations, most.count, most.code, most.detail
            ));
        }
        let most = self.member_refusals.first()?;
        Some(format!(
            "Of none of the {} designs enough members could be had; {} were not for one reason, {}: {}",
            self.evaluations, most.count, most.code, most.detail
        ))
    }
}
