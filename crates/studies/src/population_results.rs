//! Statistics of the results of members: the spread of each quantity over a population.

use std::ops::Range;

use meshwright_engine::gear::Member;
use meshwright_wire::Status;
use meshwright_wire::declare::Node;
use meshwright_wire::draw::Accuracy;
use meshwright_wire::resolution::sees_faces;
use meshwright_wire::warning::GearName;
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

use crate::population::document::GearAccuracy;
use crate::population::{GEARS, Population, Source};
use crate::refusals::{RefusalState, Refusals};
use crate::sample::histogram::histogram;
use crate::sample::influence::{Ranked, of_group};
use crate::sample::points::Sampling;
use crate::sample::{Estimate, mean, percentile, standard_deviation};
use crate::study::Study;
use crate::table::{CurveSummary, Of, QUANTITIES, RowState, Summary};

/// The percentiles that are told.
const PERCENTS: [f64; 7] = [1.0, 5.0, 25.0, 50.0, 75.0, 95.0, 99.0];

/// Influences are found from so many members: more make them no truer than one needs.
const MOST_OF_INFLUENCES: u32 = 16_384;

/// Maximum number of values of all members in memory at a time.
const MOST_KEPT: usize = 8_000_000;

/// Statistics of a population over the members computed so far.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = PopulationResults, title = "Population results")]
pub struct PopulationResults {
    /// The study; null for a study that was computed from the command line.
    pub id: Option<Uuid>,
    /// Where it stands.
    pub status: Status,
    /// Members in all.
    pub size: u64,
    /// Members that have come to an end, whichever.
    pub done: u64,
    /// Members that could not be built or computed. Of them only `failed_share` knows.
    pub failed: u64,
    /// Members whose curves run over a part of their true period, over windows or a short span: their statistics are those of that part, and their peak-to-peak
    /// and rms are less than those of the true period.
    pub partial: u64,
    /// Why they could not, the most common reason first.
    pub refusals: Vec<RefusalState>,
    /// The quantities that the method has: those of the pair once, those of a curve for each torque.
    pub quantities: Vec<QuantityDocument>,
    /// The share of gears whose total cumulative pitch deviation, measured from the bore, is beyond the tolerance F_pT of their class: none of those that are
    /// inspected. Null where teeth are not drawn.
    pub beyond_total_pitch_tolerance: BeyondDocument,
    /// The share of the gears made that the inspection rejected, found from the first members; null where teeth are not drawn, or not inspected.
    pub rejected_by_inspection: BeyondDocument,
}

/// A share of the gears.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, ToSchema)]
#[schema(as = BeyondTolerance, title = "Share of gears")]
pub struct BeyondDocument {
    /// Of the driving gears, from 0 to 1.
    pub driving: Option<f64>,
    /// Of the driven gears.
    pub driven: Option<f64>,
}

/// How a quantity is spread over the members that have results. All numbers are in its unit.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = QuantityResults, title = "Spread of a quantity")]
pub struct QuantityDocument {
    /// The name of the quantity: the names of the table, joined by dots.
    pub name: &'static str,
    /// The output torque, in N m; null for a quantity of the pair, and where the torque itself varies.
    pub output_torque_n_m: Option<f64>,
    /// The members that have this quantity. The contact pressure has no limit where a sharp tip corner carries.
    pub count: u64,
    /// The mean.
    pub mean: f64,
    /// The standard deviation about the mean, over the number of members.
    pub standard_deviation: f64,
    /// The smallest value.
    pub smallest: f64,
    /// The largest value.
    pub largest: f64,
    /// The members, by their place in the table, that have the smallest, the middle and the largest value.
    pub members: ExtremesDocument,
    /// Percentiles of the members that have this quantity, linear between neighbors.
    pub percentiles: Vec<PercentileDocument>,
    /// The share of the members so far that could not be built or computed, from 0 to 1: percentiles do not know of them.
    pub failed_share: f64,
    /// How many members have which values.
    pub histogram: HistogramDocument,
    /// Shares of the variance by their sources. Empty where nothing varies.
    pub influences: Vec<InfluenceDocument>,
}

/// Members to look at.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Extremes, title = "Members to look at")]
pub struct ExtremesDocument {
    /// That of the smallest value.
    pub smallest: u32,
    /// That in the middle.
    pub median: u32,
    /// That of the largest value.
    pub largest: u32,
}

/// A percentile.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Percentile, title = "Percentile")]
pub struct PercentileDocument {
    /// Percentage of the members below it.
    pub percent: f64,
    /// Its value among the members.
    pub value: f64,
    /// With 95 % confidence the percentile of all that are made is not below this; null where there are too few members to tell.
    pub low: Option<f64>,
    /// Nor above this.
    pub high: Option<f64>,
}

/// A histogram.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Histogram, title = "Histogram")]
pub struct HistogramDocument {
    /// Where bars begin, and where the last one ends.
    pub edges: Vec<f64>,
    /// The members in each.
    pub counts: Vec<u64>,
}

/// The part of the variance that an input makes by itself.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Influence, title = "Influence")]
pub struct InfluenceDocument {
    /// The varied field, a JSON pointer into the submission.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// Or the gear whose teeth are drawn, all their deviations together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<GearName>,
    /// Its share of the variance, of first order, from 0 to 1.
    pub share: f64,
    /// With 95 % confidence it is not below this; null where there are too few members to tell.
    pub low: Option<f64>,
    /// Nor above this.
    pub high: Option<f64>,
}

/// The members of a population whose results have been looked at, and of their numbers those at some torques.
#[derive(Debug)]
pub struct PopulationSample {
    population: Population,
    gear: GearName,
    sources: Sources,
    torques: Range<usize>,
    done: u64,
    failed: u64,
    partial: u64,
    refusals: Refusals,
    /// Members that have results, in the order of the table.
    members: Vec<u32>,
    /// Of each quantity of the pair, in the order of [`QUANTITIES`]: the members' numbers, NaN where a member has none.
    of_pair: Vec<Vec<f64>>,
    /// The same of the curves, torque by torque.
    of_curves: Vec<CurveColumns>,
}

#[derive(Debug, Default, Clone)]
struct CurveColumns {
    /// The torque that all members have so far.
    output_torque_n_m: Option<f64>,
    columns: Vec<Vec<f64>>,
}

/// The differences between members, prepared for queries.
#[derive(Debug)]
struct Sources {
    base: Node,
    accuracies: [Option<Accuracy>; 2],
    counted: [Counted; 2],
}

/// Counts of the gears of the members.
#[derive(Debug, Default, Clone, Copy)]
struct Counted {
    /// Gears that were looked at.
    gears: u64,
    /// Of these, beyond F_pT.
    exceeded: u64,
    /// Gears that were made for them, and leads.
    made: u64,
    leads: u64,
}

impl Counted {
    /// Maximum number of random numbers for the estimate of an inspection's rejections.
    const MOST_DRAWN: u64 = 4_000_000;

    /// The part of the gears made that passed, teeth and leads being independent.
    fn passed(&self) -> f64 {
        let part = |made: u64| self.gears as f64 / made.max(1) as f64;
        part(self.made)
            * if self.leads > 0 {
                part(self.leads)
            } else {
                1.0
            }
    }
}

impl PopulationSample {
    /// No member so far of the population that `study` is; none if it is none. Of the curves it knows those of `torques`, counted from 0.
    pub fn new(study: &Study, torques: Range<usize>) -> Option<Self> {
        let population = study.population()?.clone();
        let accuracies = population.accuracies(study.base());
        Some(Self {
            sources: Sources {
                base: study.base().clone(),
                accuracies,
                counted: Default::default(),
            },
            gear: study.gear(),
            of_pair: vec![Vec::new(); QUANTITIES.len()],
            of_curves: Vec::new(),
            population,
            torques,
            done: 0,
            failed: 0,
            partial: 0,
            refusals: Refusals::default(),
            members: Vec::new(),
        })
    }

    /// The torques that one look at the table can take, for a population of `study`: so many that their numbers fit in memory.
    pub fn torques_at_once(study: &Study) -> usize {
        (MOST_KEPT / (QUANTITIES.len() * study.total()).max(1)).max(1)
    }

    /// Looks at the next row of the table, that of `member`.
    pub fn add(&mut self, member: u32, row: &RowState) {
        self.done += u64::from(row.status.has_ended());
        self.failed += u64::from(row.status == Status::Failed);
        self.refusals.note(row.problem.as_ref());
        let Some(summary) = &row.summary else {
            return;
        };
        let is_partial = summary.curves().iter().any(CurveSummary::is_partial);
        self.partial += u64::from(is_partial);
        let place = self.members.len();
        self.members.push(member);
        self.add_pair(summary);
        self.add_curves(summary, place);
        if self.torques.start == 0 {
            self.measure(member);
        }
    }

    fn add_pair(&mut self, summary: &Summary) {
        for (quantity, column) in QUANTITIES.iter().zip(&mut self.of_pair) {
            if let Of::Pair(of) = quantity.of
                && self.torques.start == 0
            {
                column.push(of(summary).unwrap_or(f64::NAN));
            }
        }
    }

    fn add_curves(&mut self, summary: &Summary, place: usize) {
        let curves = summary.curves().iter().skip(self.torques.start);
        for (i, curve) in curves.take(self.torques.len()).enumerate() {
            if self.of_curves.len() == i {
                self.of_curves.push(CurveColumns {
                    output_torque_n_m: Some(curve.output_torque_n_m),
                    columns: vec![Vec::new(); QUANTITIES.len()],
                });
            }
            let known = &mut self.of_curves[i];
            known.output_torque_n_m = known
                .output_torque_n_m
                .filter(|torque| *torque == curve.output_torque_n_m);
            for (quantity, column) in QUANTITIES.iter().zip(&mut known.columns) {
                if let Of::Curve(of) = quantity.of {
                    // Members before this one that had no such curve have no number.
                    column.resize(place, f64::NAN);
                    column.push(of(curve, self.gear).unwrap_or(f64::NAN));
                }
            }
        }
        for known in self.of_curves.iter_mut().skip(summary.curves().len()) {
            known
                .columns
                .iter_mut()
                .for_each(|column| column.resize(place + 1, f64::NAN));
        }
    }

    /// Looks whether the gears of a member keep F_pT, and how many were made for those that passed.
    fn measure(&mut self, member: u32) {
        for gear in GEARS {
            let Some(asked) = &self.population.accuracy[gear as usize] else {
                continue;
            };
            let counted = &mut self.sources.counted[gear as usize];
            let own = self.population.varies(gear).then(|| {
                let mut submission = self.sources.base.clone();
                let values = self.population.values(member);
                for (varied, value) in self.population.varied().iter().zip(values) {
                    let value = Node::Number(value);
                    submission.put(varied.path.steps(), value);
                }
                self.population.accuracies(&submission)[gear as usize].clone()
            });
            let accuracy = own.unwrap_or_else(|| self.sources.accuracies[gear as usize].clone());
            let Some(accuracy) = accuracy else {
                continue;
            };
            let teeth = u64::from(accuracy.inspection.tooth_count());
            if asked.inspected && teeth * (counted.made + counted.leads) > Counted::MOST_DRAWN {
                continue;
            }
            let Some(passed) = self.population.teeth(member, gear, &accuracy) else {
                continue;
            };
            let total = accuracy.inspection.total_pitch_deviation(&passed.teeth);
            counted.gears += 1;
            counted.exceeded += u64::from(total > accuracy.inspection.tolerances.total_pitch);
            counted.made += u64::from(passed.attempts);
            let sees_faces = self.sources.base.at(&["method"]).is_some_and(sees_faces);
            if asked.inspected && sees_faces {
                let leads = self.population.lead_slopes(member, gear, &accuracy);
                counted.leads += leads.map_or(0, |leads| u64::from(leads.attempts));
            }
        }
    }

    /// True if no member has torques beyond those that it knows.
    pub fn has_all_torques(&self) -> bool {
        self.of_curves.len() < self.torques.len()
    }

    /// Statistics of the members.
    pub fn results(&self, id: Option<Uuid>, status: Status) -> PopulationResults {
        let ranked = Inputs::of(&self.population, &self.members);
        let named = |columns: &[Vec<f64>], torque: Option<f64>| -> Vec<QuantityDocument> {
            let columns = QUANTITIES.iter().zip(columns);
            let known = columns.filter_map(|(quantity, column)| {
                self.quantity(quantity.name, torque, column, &ranked)
            });
            known.collect()
        };
        let mut quantities = named(&self.of_pair, None);
        for curve in &self.of_curves {
            quantities.extend(named(&curve.columns, curve.output_torque_n_m));
        }
        let of_gears = |tell: &dyn Fn(&Counted, &GearAccuracy) -> Option<f64>| {
            let [driving, driven] = GEARS.map(|gear| {
                let accuracy = self.population.accuracy[gear as usize].as_ref()?;
                let counted = &self.sources.counted[gear as usize];
                (counted.gears > 0).then(|| tell(counted, accuracy))?
            });
            BeyondDocument { driving, driven }
        };
        PopulationResults {
            id,
            status,
            size: self.population.size() as u64,
            done: self.done,
            failed: self.failed,
            partial: self.partial,
            refusals: self.refusals.most_common_first(),
            quantities,
            beyond_total_pitch_tolerance: of_gears(&|counted, _| {
                Some(counted.exceeded as f64 / counted.gears as f64)
            }),
            rejected_by_inspection: of_gears(&|counted, accuracy| {
                accuracy.inspected.then(|| 1.0 - counted.passed())
            }),
        }
    }

    fn quantity(
        &self,
        name: &'static str,
        output_torque_n_m: Option<f64>,
        column: &[f64],
        inputs: &Inputs<'_>,
    ) -> Option<QuantityDocument> {
        let numbered = self.members.iter().copied().zip(column.iter().copied());
        let mut sorted: Vec<(u32, f64)> = numbered.filter(|(_, value)| !value.is_nan()).collect();
        sorted.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        let (smallest, largest) = (*sorted.first()?, *sorted.last()?);
        let values: Vec<f64> = sorted.iter().map(|(_, value)| *value).collect();
        let histogram = histogram(&values)?;
        Some(QuantityDocument {
            name,
            output_torque_n_m,
            count: values.len() as u64,
            mean: mean(&values)?,
            standard_deviation: standard_deviation(&values)?,
            smallest: smallest.1,
            largest: largest.1,
            members: ExtremesDocument {
                smallest: smallest.0,
                median: sorted[sorted.len() / 2].0,
                largest: largest.0,
            },
            percentiles: self.percentiles(&sorted, &values, column),
            failed_share: self.failed as f64 / self.done.max(1) as f64,
            histogram: HistogramDocument {
                edges: histogram.edges,
                counts: histogram.counts,
            },
            influences: inputs.influences(column),
        })
    }

    fn percentiles(
        &self,
        sorted: &[(u32, f64)],
        values: &[f64],
        column: &[f64],
    ) -> Vec<PercentileDocument> {
        let pairs: Vec<[f64; 2]> = GEARS
            .into_iter()
            .flat_map(|gear| pairs_of(&self.population, gear, &self.members, column))
            .collect();
        let estimate = |percent: f64| {
            let limit = percentile::percentile(values, percent);
            let effect = percentile::design_effect(&pairs, values.len(), limit, percent / 100.0);
            match self.population.points.sampling {
                Sampling::Sobol => percentile::of_replicates(sorted, percent, effect),
                Sampling::Random => percentile::of_independent(values, percent, effect),
            }
        };
        let percentiles = PERCENTS.into_iter().map(|percent| {
            let Estimate { value, low, high } = estimate(percent);
            PercentileDocument {
                percent,
                value,
                low,
                high,
            }
        });
        percentiles.collect()
    }
}

/// The numbers in `column` of each two members that have the same `gear`, where both have one.
fn pairs_of(
    population: &Population,
    gear: Member,
    members: &[u32],
    column: &[f64],
) -> Vec<[f64; 2]> {
    let followed = members.windows(2).zip(column.windows(2));
    let found = followed.filter(|(members, values)| {
        let [first, second] = [members[0], members[1]];
        first.is_multiple_of(2)
            && second == crate::sample::partner(first)
            && population.is_shared(first, gear)
            && values.iter().all(|value| !value.is_nan())
    });
    found.map(|(_, values)| [values[0], values[1]]).collect()
}

/// The inputs of the first members, by which influences are found.
struct Inputs<'a> {
    population: &'a Population,
    members: &'a [u32],
    /// Of each source that is a field.
    ranked: Vec<Ranked>,
}

impl<'a> Inputs<'a> {
    fn of(population: &'a Population, members: &'a [u32]) -> Self {
        let count = members.partition_point(|member| *member < MOST_OF_INFLUENCES);
        let members = &members[..count];
        let values: Vec<Vec<f64>> = members
            .iter()
            .map(|member| population.values(*member))
            .collect();
        let ranked = (0..population.varied().len()).map(|i| {
            let inputs: Vec<f64> = values.iter().map(|values| values[i]).collect();
            Ranked::new(members, &inputs)
        });
        Self {
            ranked: ranked.collect(),
            population,
            members,
        }
    }

    /// Shares of the variance of `column` by their sources.
    fn influences(&self, column: &[f64]) -> Vec<InfluenceDocument> {
        let column = &column[..self.members.len()];
        let mut ranked = self.ranked.iter();
        let sources = self.population.sources();
        let alone = sources.len() == 1;
        let found = sources.into_iter().filter_map(|source| {
            let (path, accuracy, share) = match source {
                Source::Field(path) => (
                    Some(path.text().to_owned()),
                    None,
                    ranked.next()?.share(column)?,
                ),
                Source::Teeth(gear) => {
                    let share = if alone {
                        whole(column)?
                    } else {
                        of_group(&pairs_of(self.population, gear, self.members, column))?
                    };
                    (None, Some(GearName::from(gear)), share)
                }
            };
            Some(InfluenceDocument {
                path,
                accuracy,
                share: share.value,
                low: share.low,
                high: share.high,
            })
        });
        found.collect()
    }
}

/// The share of the only thing that differs, where anything does.
fn whole(column: &[f64]) -> Option<Estimate> {
    let numbers = || column.iter().copied().filter(|value| !value.is_nan());
    let (least, most) = (numbers().reduce(f64::min)?, numbers().reduce(f64::max)?);
    (least < most).then_some(Estimate {
        value: 1.0,
        low: Some(1.0),
        high: Some(1.0),
    })
}
