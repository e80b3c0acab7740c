//! A trial of some designs before any is computed: whether any can be built, and whether they have the values that a search needs.

use meshwright_engine::run::Run;
use meshwright_wire::declare::{Errors, Node};
use meshwright_wire::pointer::Pointer;
use meshwright_wire::problem::{Code, FieldError, Problem};
use meshwright_wire::submission::{Submission, Windows};

use super::faults::look_around;
use super::{Plan, Study};
use crate::population::{Population, WindowDocument};
use crate::search::{Role, Search};
use crate::table::Quantity;

/// Maximum number of members of a population that are tried.
const MEMBERS: usize = 256;

/// Maximum number of designs that are tried for those from which the cost of a study is estimated.
const LOOKED_AT: usize = 16;

/// Place of the span of a submission.
const SPAN: [&str; 2] = ["resolution", "span_mesh_periods"];

/// Maximum number of designs of a search that are tried over its population, and of members of each.
const OF_SEARCH: (usize, u32) = (4, 16);

impl Study {
    /// Reads and checks a study that is to be computed.
    ///
    /// # Errors
    ///
    /// As [`Study::parse`], and 422 where no member or design can be built, for one reason that none of them would mend, or where they lack a value that a
    /// search needs (`quantity_not_told`).
    pub fn submitted(document: &[u8], run: &Run) -> Result<Self, Problem> {
        let study = Self::parse(document, run)?;
        let errors = Errors::default();
        match &study.plan {
            Plan::Population(population) => {
                study.inspect(population, "/population", &errors, run);
                if errors.count() == 0 {
                    study.try_members(population, &errors, run)?;
                }
            }
            Plan::Search(search) => {
                // A variable may make other gears of them, or make them better.
                let varies = |path: &Pointer| {
                    path.last(1)
                        .iter()
                        .any(|last| last == "capability" || last == "tooth_count")
                };
                if let Some(population) = search.population()
                    && !search.paths_of_variables().any(varies)
                {
                    study.inspect(population, "/search/population", &errors, run);
                }
                if errors.count() == 0 {
                    study.try_designs(search, &errors, run)?;
                }
            }
            Plan::Axes(_) | Plan::Designs(_) => {}
        }
        errors.settle(Some(study))
    }

    /// At most `most` designs that can be built, from which the cost of all is estimated: spread over the rows, or over the space of a search.
    ///
    /// # Errors
    ///
    /// `stopped`.
    pub fn samples(&self, most: usize, run: &Run) -> Result<Vec<Submission>, Problem> {
        let mut samples = Vec::with_capacity(most);
        if let Plan::Search(search) = &self.plan {
            // A design of a search over a population is computed as its members.
            let role = match search.looks_at_members() {
                true => Role::Member(1, 0),
                false => Role::Design(1),
            };
            let trials = search.trials(self.base()).take(LOOKED_AT);
            for (i, changes) in trials.enumerate() {
                look_around(i, run)?;
                samples.extend(self.searched(role, &changes).submission);
                if samples.len() == most {
                    break;
                }
            }
            return Ok(samples);
        }
        let rows = self.total();
        let looked_at = rows.min(LOOKED_AT);
        for i in 0..looked_at {
            look_around(i, run)?;
            // The first row and the last one come first.
            let step = if i % 2 == 0 {
                i / 2
            } else {
                looked_at - 1 - i / 2
            };
            let row = step * (rows - 1) / (looked_at - 1).max(1);
            let design = self.design(row);
            samples.extend(design.and_then(|design| design.submission.ok()));
            if samples.len() == most {
                break;
            }
        }
        Ok(samples)
    }

    /// Refuses gears of which hardly any would pass their inspection.
    fn inspect(&self, population: &Population, at: &str, errors: &Errors, run: &Run) {
        let mut base = self.base.clone();
        for varied in population.varied() {
            let value = varied.json_of(varied.median());
            base.put(varied.path.steps(), Node::of(&value));
        }
        population.refuse_hopeless(&base, at, errors, run);
    }

    /// Refuses a population of which no member can be built; of a large one, whose first ones all fail for one reason.
    fn try_members(
        &self,
        population: &Population,
        errors: &Errors,
        run: &Run,
    ) -> Result<(), Problem> {
        let tried = population.size().min(MEMBERS);
        let mut failures = Failures::default();
        for member in 0..tried {
            look_around(member, run)?;
            match self.design(member).map(|design| design.submission) {
                Some(Err(problem)) => failures.add(problem),
                Some(Ok(_)) | None => return Ok(()),
            }
            if tried < population.size() && !failures.are_alike {
                return Ok(());
            }
        }
        let what = format!("None of {tried} members can be built");
        let member = |population: &Population| {
            let composed = self.composed(0)?;
            Some(composed.design(Some((population, 0))).submission)
        };
        let placed = |error| self.at_window((population, "/population"), member, error);
        failures.report(&what, placed, errors);
        Ok(())
    }

    /// The `error` at its place in the base; one of too many positions at the window of the `population` at `at`, with the longest window over which `member` gives
    /// one that can be built, unless the base has a span of its own.
    fn at_window(
        &self,
        (population, at): (&Population, &str),
        member: impl Fn(&Population) -> Option<Result<Submission, Problem>>,
        error: FieldError,
    ) -> FieldError {
        let is_of_span = error.code == Code::TooLarge && error.pointer.starts_with("/resolution/");
        let spans = self.base.at(&SPAN).is_some_and(|span| *span != Node::Null);
        let longest = (is_of_span && !spans).then(|| longest_window(population, member));
        let Some(longest) = longest.flatten() else {
            return in_base(error);
        };
        let pointer = match population.windows {
            Some(_) => format!("{at}/window/mesh_periods"),
            None => format!("{at}/window"),
        };
        let detail = format!(
            "{} {at}/window of {longest} mesh periods would do.",
            error.detail
        );
        FieldError::new(pointer, Code::TooLarge, detail).nearest(f64::from(longest))
    }

    /// Refuses a search none of whose designs, or none of whose members, can be built for a reason outside of the pair, and one that needs values that they do
    /// not have.
    fn try_designs(&self, search: &Search, errors: &Errors, run: &Run) -> Result<(), Problem> {
        let (most, members) = OF_SEARCH;
        let [mut of_designs, mut of_members] = [false, true].map(|percent| Asked {
            missing: search.asked(percent),
            any_built: false,
            failures: Failures::default(),
        });
        let looks_at_members = search.looks_at_members();
        let mut looked = 0;
        for (i, changes) in search.trials(self.base()).enumerate() {
            look_around(i, run)?;
            of_designs.add(self.searched(Role::Design(1), &changes).submission);
            if of_designs.any_built && looks_at_members && looked < most {
                looked += 1;
                for member in 0..members.min(search.members() as u32) {
                    if of_members.is_settled() {
                        break;
                    }
                    let role = Role::Member(1, member);
                    of_members.add(self.searched(role, &changes).submission);
                }
            }
            let members_settled = !looks_at_members || looked == most || of_members.is_settled();
            if of_designs.is_settled() && members_settled {
                break;
            }
        }
        let mends = |pointer: &str| {
            let mut paths = search.paths();
            pointer.starts_with("/pair/") || paths.any(|path| path.covers(pointer))
        };
        let member = |population: &Population| {
            let changes = search.trials(self.base()).next()?;
            let (composed, _) = self.composed_of_search(Role::Member(1, 0), &changes);
            Some(composed.design(Some((population, 0))).submission)
        };
        let placed = |error| match search.population() {
            Some(population) => self.at_window((population, "/search/population"), member, error),
            None => in_base(error),
        };
        for (asked, what) in [(of_designs, "design"), (of_members, "member")] {
            asked.report(what, mends, placed, errors);
        }
        Ok(())
    }
}

/// The `error` of a submission at its place in the base.
fn in_base(error: FieldError) -> FieldError {
    let pointer = format!("/base{}", error.pointer);
    FieldError { pointer, ..error }
}

/// The mesh periods of the longest window of `population` over which `member` gives one that has few enough positions, if there is one.
fn longest_window(
    population: &Population,
    member: impl Fn(&Population) -> Option<Result<Submission, Problem>>,
) -> Option<u32> {
    let places = population
        .windows
        .as_ref()
        .map_or(1, |windows| windows.places);
    let fits = |mesh_periods: u32| {
        let windows = Some(Windows {
            mesh_periods,
            places,
        });
        let mut over = population.clone();
        over.windows = windows;
        matches!(member(&over), Some(Ok(_)))
    };
    let (least, most) = WindowDocument::mesh_periods.spec.bounds;
    let (mut least, mut most) = (least as u32, most as u32);
    if !fits(least) {
        return None;
    }
    while most - least > 1 {
        let middle = u32::midpoint(least, most);
        if fits(middle) {
            least = middle;
        } else {
            most = middle;
        }
    }
    Some(least)
}

/// A value that a search needs and that no design, or no member, has so far: the place of the request, and the reason of the first design that was built.
struct Asked {
    missing: Vec<(String, &'static Quantity, Option<String>)>,
    any_built: bool,
    failures: Failures,
}

impl Asked {
    fn add(&mut self, submission: Result<Submission, Problem>) {
        match submission {
            Err(problem) => self.failures.add(problem),
            Ok(submission) => {
                self.any_built = true;
                self.missing.retain_mut(|(_, quantity, why)| {
                    let own = quantity.why_absent(&submission);
                    let stays = own.is_some();
                    *why = why.take().or(own);
                    stays
                });
            }
        }
    }

    fn is_settled(&self) -> bool {
        self.any_built && self.missing.is_empty()
    }

    fn report(
        self,
        what: &str,
        mends: impl Fn(&str) -> bool,
        placed: impl Fn(FieldError) -> FieldError,
        errors: &Errors,
    ) {
        if !self.any_built {
            self.report_stresses(errors);
            if self.failures.are_alike && !self.failures.could_be_mended(mends) {
                let what = format!("No {what} can be built");
                self.failures.report(&what, placed, errors);
            }
            return;
        }
        for (pointer, quantity, why) in self.missing {
            let why = why.unwrap_or_default();
            let detail = format!("{} is not told: {why}.", quantity.name);
            errors.push(FieldError::new(pointer, Code::QuantityNotTold, detail));
        }
    }

    /// Where no design can be built because its method does not tell the stresses that are asked for, goals and conditions of stress are told so too.
    fn report_stresses(&self, errors: &Errors) {
        let failed = self
            .failures
            .first
            .iter()
            .flat_map(|problem| &problem.errors);
        let failed = failed.filter(|_| self.failures.are_alike);
        for error in failed.filter(|error| error.code == Code::QuantityNotTold) {
            for (pointer, quantity, _) in &self.missing {
                if quantity.is_stress() {
                    let detail = format!("{} is not told: {}", quantity.name, error.detail);
                    errors.push(FieldError::new(pointer, Code::QuantityNotTold, detail));
                }
            }
        }
    }
}

/// Why designs could not be built.
#[derive(Default)]
struct Failures {
    first: Option<Problem>,
    are_alike: bool,
}

impl Failures {
    fn add(&mut self, problem: Problem) {
        fn places(problem: &Problem) -> Vec<(&str, Code)> {
            let errors = problem.errors.iter();
            errors
                .map(|error| (error.pointer.as_str(), error.code))
                .collect()
        }
        match &self.first {
            None => (self.first, self.are_alike) = (Some(problem), true),
            Some(first) => self.are_alike &= places(first) == places(&problem),
        }
    }

    fn could_be_mended(&self, mends: impl Fn(&str) -> bool) -> bool {
        let mut errors = self.first.iter().flat_map(|problem| &problem.errors);
        errors.any(|error| mends(&error.pointer))
    }

    /// Reports the errors of the first at their places in the study.
    fn report(self, what: &str, placed: impl Fn(FieldError) -> FieldError, errors: &Errors) {
        for error in self.first.into_iter().flat_map(|problem| problem.errors) {
            let error = placed(error);
            errors.push(FieldError {
                detail: format!("{what}: {}", error.detail),
                ..error
            });
        }
    }
}
