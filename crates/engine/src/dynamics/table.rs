//! The force between two gears over position and approach, and the energy behind it.

/// How loads rise from one row of a table to the next: as this power, so that rows are dense where a line contact is soft.
const RISE: f64 = 1.5;

/// How loads rise where a table is refined between two of its rows: evenly in x, the part of the largest load being 3 y/(1 + 2 y) with y = x to this
/// power, so that rows are close where loads are light and even where they are not.
const BETWEEN: f64 = 3.5;

/// Parts of the largest load that stand between 0 and the others, as far as these are larger: pairs of teeth come to carry one after the other there.
/// Tables of so few loads have none.
const LIGHT: ([f64; 2], usize) = ([7.5e-4, 6e-3], 7);

/// The least rise of δ from row to row in m, less than an atom.
const APART: f64 = 1e-14;

/// By how much a computed row may fall below the one before it, in m: rounding of coordinates.
const ROUNDING: f64 = 1e-12;

/// A row of a table that does not lie beyond that of the load before it.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "at mesh position {mesh_position} δ under {load} N is less by {falls} m than under the load before it"
)]
pub struct FallingRow {
    /// The mesh position η at which it falls most.
    pub mesh_position: f64,
    /// Its load in N, negative on the other flanks.
    pub load: f64,
    /// By how much it falls, in m.
    pub falls: f64,
}

/// The loads of a table: 0 and so many more, up to the largest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadSteps {
    /// The number of loads, the first of which is 0.
    pub count: usize,
    /// The largest load in N.
    pub largest: f64,
}

impl LoadSteps {
    /// The loads in N, rising from 0.
    pub fn loads(&self) -> Vec<f64> {
        let (light, few) = LIGHT;
        // The others begin lower the more there are.
        let lightest = ((self.count - 1) as f64).powf(-RISE);
        let wanted = if self.count > few {
            light.partition_point(|part| *part < lightest)
        } else {
            0
        };
        let light = &light[..wanted];
        let heavy = self.count - 1 - light.len();
        let heavy = (1..=heavy).map(|j| (j as f64 / heavy as f64).powf(RISE));
        let parts = [0.0].into_iter().chain(light.iter().copied()).chain(heavy);
        parts.map(|part| self.largest * part).collect()
    }
}

/// F(θ, δ) over the true period: the approach δ at each position under each of its loads, of both flanks.
///
/// Between positions and between loads δ is linear in both; beyond the largest load it is extrapolated linearly. [`ForceTable::refined`] puts a smooth table
/// between the computed rows. F follows by inversion: it is zero in the backlash, rises with δ, and has the energy V(η, δ) = ∫F dδ, from which both torques
/// follow: the work over a closed path of θ and δ is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceTable {
    /// Mesh periods after which it repeats.
    period: u32,
    loads: Vec<f64>,
    loaded: FlankRows,
    /// At minus the loads.
    other: FlankRows,
}

/// Compliance of one flank at equally spaced positions, a row each load.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FlankRows {
    /// δ in m.
    pub delta: Vec<Vec<f64>>,
    /// dδ/dF in m/N, where it is known. That of the load 0, which is infinite, is not looked at.
    pub compliance: Option<Vec<Vec<f64>>>,
}

impl FlankRows {
    /// Rows of which δ alone is known.
    pub fn of_delta(delta: Vec<Vec<f64>>) -> Self {
        Self {
            delta,
            compliance: None,
        }
    }
}

/// Forces of the gears at a position and an approach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forces {
    /// F = ∂V/∂δ in N.
    pub load: f64,
    /// ∂V/∂η in J per mesh period.
    pub per_period: f64,
    /// V in J.
    pub energy: f64,
}

impl ForceTable {
    /// A table over `period` mesh periods with these rows of the loaded and of the other flank, a row each of the `loads`, which rise
    /// from 0. Rows that rounding
    /// leaves equal are set apart.
    ///
    /// # Errors
    ///
    /// [`FallingRow`] if δ does not rise with the load.
    pub fn new(
        period: u32,
        loads: Vec<f64>,
        [loaded, other]: [FlankRows; 2],
    ) -> Result<Self, FallingRow> {
        let mut table = Self {
            period,
            loads,
            loaded: loaded.clone(),
            other: other.clone(),
        };
        set_apart(&mut table.loaded.delta, |a, b| a.max(b + APART));
        set_apart(&mut table.other.delta, |a, b| a.min(b - APART));
        let step = table.step();
        for (given, found, sign) in [(loaded, &table.loaded, 1.0), (other, &table.other, -1.0)] {
            let rows = given.delta.iter().zip(&found.delta).zip(&table.loads);
            for ((given, found), load) in rows {
                let falls = found
                    .iter()
                    .zip(given)
                    .map(|(found, given)| (found - given).abs());
                let Some((i, falls)) = falls.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else {
                    continue;
                };
                if falls > ROUNDING {
                    return Err(FallingRow {
                        mesh_position: i as f64 * step,
                        load: sign * load,
                        falls,
                    });
                }
            }
        }
        Ok(table)
    }

    /// The loaded flank.
    pub fn loaded(&self) -> &FlankRows {
        &self.loaded
    }

    /// The other flank, at minus the loads.
    pub fn other(&self) -> &FlankRows {
        &self.other
    }

    /// Mesh periods after which it repeats.
    pub fn period(&self) -> u32 {
        self.period
    }

    /// Its positions over the period.
    pub fn positions(&self) -> usize {
        self.loaded.delta[0].len()
    }

    /// Its mesh positions, from 0, the end excluded.
    pub fn mesh_positions(&self) -> Vec<f64> {
        let step = self.step();
        (0..self.positions()).map(|i| i as f64 * step).collect()
    }

    fn step(&self) -> f64 {
        f64::from(self.period) / self.positions() as f64
    }

    /// Its loads in N, rising from 0.
    pub fn loads(&self) -> &[f64] {
        &self.loads
    }

    /// The backlash along the line of action in m, position by position.
    pub fn backlash(&self) -> Vec<f64> {
        let (one, other) = (&self.loaded.delta[0], &self.other.delta[0]);
        one.iter().zip(other).map(|(a, b)| a - b).collect()
    }

    /// δ under `load` ≥ 0 at each position.
    pub fn transmission_error(&self, load: f64) -> Vec<f64> {
        (0..self.positions())
            .map(|i| {
                let place = self.row_below(|j| self.loads[j] <= load);
                let part = (load - self.loads[place]) / (self.loads[place + 1] - self.loads[place]);
                let [low, high] = [place, place + 1].map(|j| self.loaded.delta[j][i]);
                low + part * (high - low)
            })
            .collect()
    }

    /// The least compliance from row to row of either flank, in m/N.
    pub(super) fn least_compliance(&self) -> f64 {
        let flanks = [&self.loaded, &self.other].into_iter();
        let rows = flanks.flat_map(|flank| flank.delta.windows(2).zip(self.loads.windows(2)));
        let rises = rows.flat_map(|(rows, loads)| {
            let rise = loads[1] - loads[0];
            let both = rows[0].iter().zip(&rows[1]);
            both.map(move |(low, high)| (high - low).abs() / rise)
        });
        rises.fold(f64::INFINITY, f64::min)
    }

    /// The table of a mesh that yields less by `compliance` in m/N under every load, which is less than its least.
    pub(super) fn stiffer_by(&self, compliance: f64) -> Self {
        let flank = |rows: &FlankRows, sign: f64| {
            let delta = rows.delta.iter().zip(&self.loads);
            let delta = delta.map(|(row, load)| {
                let yielded = sign * load * compliance;
                row.iter().map(|delta| delta - yielded).collect()
            });
            let less = |row: &Vec<f64>| row.iter().map(|own| own - compliance).collect();
            FlankRows {
                delta: delta.collect(),
                compliance: rows
                    .compliance
                    .as_ref()
                    .map(|rows| rows.iter().map(less).collect()),
            }
        };
        Self {
            period: self.period,
            loads: self.loads.clone(),
            loaded: flank(&self.loaded, 1.0),
            other: flank(&self.other, -1.0),
        }
    }

    /// The last row but one at which `reached` holds.
    fn row_below(&self, reached: impl Fn(usize) -> bool) -> usize {
        let (mut low, mut high) = (0, self.loads.len() - 1);
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if reached(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// The load in N at the mesh position `eta` and the approach `delta`: negative where the other flanks touch.
    pub fn load(&self, eta: f64, delta: f64) -> f64 {
        self.forces(eta, delta).load
    }

    /// Between which of its positions `place` stands, in steps from the first one.
    fn between(&self, place: f64) -> Between {
        let first = (place.floor() as usize).min(self.positions() - 1);
        Between {
            first,
            second: (first + 1) % self.positions(),
            part: place - first as f64,
            step: self.step(),
        }
    }

    /// Forces of the gears at the mesh position `eta` and the approach `delta`.
    pub fn forces(&self, eta: f64, delta: f64) -> Forces {
        let between = self.between((eta / self.step()).rem_euclid(self.positions() as f64));
        let (loaded, other) = (&self.loaded.delta, &self.other.delta);
        if delta > between.value(&loaded[0]) {
            self.of_flank(loaded, between, delta, 1.0)
        } else if delta < between.value(&other[0]) {
            self.of_flank(other, between, delta, -1.0)
        } else {
            Forces {
                load: 0.0,
                per_period: 0.0,
                energy: 0.0,
            }
        }
    }

    /// The forces of a flank whose load acts in the direction `sign`.
    fn of_flank(&self, rows: &[Vec<f64>], between: Between, delta: f64, sign: f64) -> Forces {
        let at = |j: usize| between.value(&rows[j]);
        let last = self.row_below(|j| sign * (delta - at(j)) >= 0.0);
        let (low, high) = (at(last), at(last + 1));
        let part = (delta - low) / (high - low);
        let load = self.loads[last] + part * (self.loads[last + 1] - self.loads[last]);
        let slope = |j: usize| between.slope(&rows[j]);
        let (mut energy, mut per_period) = (0.0, 0.0);
        for j in 0..last {
            energy += (self.loads[j] + self.loads[j + 1]) / 2.0 * (at(j + 1) - at(j));
            per_period -= (slope(j) + slope(j + 1)) / 2.0 * (self.loads[j + 1] - self.loads[j]);
        }
        let here = slope(last) + part * (slope(last + 1) - slope(last));
        energy += (self.loads[last] + load) / 2.0 * (delta - low);
        per_period -= (slope(last) + here) / 2.0 * (load - self.loads[last]);
        Forces {
            load: sign * load,
            per_period: sign * per_period,
            energy: sign * energy,
        }
    }

    /// The table with `by_position` times as many positions and `by_load` times as many stretches between loads, of four at least.
    pub fn refined(&self, by_position: usize, by_load: usize) -> Self {
        let largest = self.loads[self.loads.len() - 1];
        let between = self.loads.windows(2).flat_map(|ends| {
            let [from, to] = [ends[0], ends[1]].map(|load| place_of(load / largest));
            (1..=by_load).map(move |j| {
                let part = j as f64 / by_load as f64;
                // The end as it stands, to the last digit.
                if j == by_load {
                    ends[1]
                } else {
                    largest * part_at(from + part * (to - from))
                }
            })
        });
        let loads = self.loads.iter().take(1).copied().chain(between).collect();
        self.under(by_position, loads)
    }

    /// The table with `by_position` times as many positions under `loads`, which rise from 0 to its largest. Along a row: on cubics through its own, and on
    /// the lesser of two branches where pairs of teeth begin or cease to carry. From row to row, of four at least: so that compliances are met where they
    /// are known, and as along a row where they are not. Where rows would meet that way, δ is linear from load to load, and from position to position: as the rows that were
    /// computed rise, so do those between them, everywhere.
    pub fn under(&self, by_position: usize, loads: Vec<f64>) -> Self {
        // The other flanks have their kinks upside down.
        let flank = |rows: &FlankRows, sign: f64| {
            let turned = |row: &Vec<f64>| row.iter().map(|delta| sign * delta).collect();
            let delta: Vec<Vec<f64>> = rows.delta.iter().map(turned).collect();
            let mut between_loads = match &rows.compliance {
                Some(compliance) => self.met(&delta, compliance, &loads),
                None => self.along_loads(&delta, &loads),
            };
            self.let_rise(&mut between_loads, &delta, &loads);
            let positions = self.positions() * by_position;
            let mut fine = vec![vec![0.0; positions]; loads.len()];
            for i in 0..positions {
                let place = i as f64 / by_position as f64;
                let mut column: Vec<f64> = between_loads
                    .iter()
                    .map(|row| between_closed(row, place))
                    .collect();
                if !column.is_sorted_by(|a, b| a < b) {
                    let between = self.between(place);
                    column = between_loads.iter().map(|row| between.value(row)).collect();
                }
                for (row, delta) in fine.iter_mut().zip(column) {
                    row[i] = sign * delta;
                }
            }
            FlankRows::of_delta(fine)
        };
        Self {
            period: self.period,
            loaded: flank(&self.loaded, 1.0),
            other: flank(&self.other, -1.0),
            loads,
        }
    }

    /// Makes `rows` under `loads` linear in the load at positions where they do not rise from one row of `delta`, which are those of the table, to the next.
    fn let_rise(&self, rows: &mut [Vec<f64>], delta: &[Vec<f64>], loads: &[f64]) {
        for (own, ends) in self.loads.windows(2).zip(delta.windows(2)) {
            let within = loads.partition_point(|load| *load <= own[0])
                ..loads.partition_point(|load| *load < own[1]);
            for i in 0..self.positions() {
                let [low, high] = [ends[0][i], ends[1][i]];
                let on_the_way = rows[within.clone()].iter().map(|row| row[i]);
                let column = std::iter::once(low).chain(on_the_way).chain([high]);
                if column.is_sorted_by(|a, b| a < b) {
                    continue;
                }
                for j in within.clone() {
                    let part = (loads[j] - own[0]) / (own[1] - own[0]);
                    rows[j][i] = low + part * (high - low);
                }
            }
        }
    }

    /// `delta` at its positions under `loads`.
    fn along_loads(&self, delta: &[Vec<f64>], loads: &[f64]) -> Vec<Vec<f64>> {
        let largest = self.loads[self.loads.len() - 1];
        let row = |&load: &f64| {
            let first = self.row_below(|j| self.loads[j] <= load);
            let [from, to] = [first, first + 1].map(|j| self.loads[j]);
            if load == to {
                return delta[first + 1].clone();
            }
            let [place, first_place, last_place] =
                [load, from, to].map(|load| place_of(load / largest));
            let part = (place - first_place) / (last_place - first_place);
            let at = |i: usize| between_open(&self.loads, |j| delta[j][i], (first, part), load);
            (0..self.positions()).map(at).collect()
        };
        loads.iter().map(row).collect()
    }

    /// The same, so that `compliance` is met too.
    fn met(&self, delta: &[Vec<f64>], compliance: &[Vec<f64>], loads: &[f64]) -> Vec<Vec<f64>> {
        let mut rows = vec![vec![0.0; self.positions()]; loads.len()];
        for i in 0..self.positions() {
            let at = |rows: &[Vec<f64>]| rows.iter().map(|row| row[i]).collect::<Vec<f64>>();
            let stretches = Stretch::all(&self.loads, &at(delta), &at(compliance));
            for (j, &load) in loads.iter().enumerate() {
                let first = self.row_below(|j| self.loads[j] <= load);
                let own = [first, first + 1]
                    .into_iter()
                    .find(|&j| self.loads[j] == load);
                rows[j][i] = own.map_or_else(|| stretches[first].delta(load), |j| delta[j][i]);
            }
        }
        rows
    }
}

/// The part of the largest load at a place between 0 and 1.
fn part_at(place: f64) -> f64 {
    let y = place.powf(BETWEEN);
    3.0 * y / (1.0 + 2.0 * y)
}

/// The place at which that part stands.
fn place_of(part: f64) -> f64 {
    (part / (3.0 - 2.0 * part)).powf(1.0 / BETWEEN)
}

/// From this ratio on of how fast its compliance falls to how fast those beside it do, a stretch has a kink.
const KINKED: f64 = 1.5;

/// The least power of the load as which δ rises from nothing.
const LEAST_POWER: f64 = 0.1;

/// δ over the load, from one row of a table to the next, where compliances are known at both.
///
/// A line contact stiffens with the logarithm of its load, c = c_0 − κ ln F, and all at once where one more pair of teeth comes to carry.
#[derive(Debug)]
struct Stretch {
    /// Where it begins, and where it ends: the load, δ and dδ/dF.
    ends: [[f64; 3]; 2],
    course: Course,
}

/// How δ goes over a stretch.
#[derive(Debug)]
enum Course {
    /// From no load, as a power of it: 1 of a spring, a little less of a line contact, less of one that spreads along the face.
    FromNothing { power: f64 },
    /// A + B x + C x ln x + D x² with x = F over the load at which it begins.
    Smooth { b: f64, c: f64, d: f64 },
    /// From both ends to `place`, the compliance falling by `fall` ln F on either side of it.
    Kinked { place: f64, fall: f64 },
}

impl Stretch {
    /// Courses between `loads`, the first of which is 0, with these δ and these compliances.
    fn all(loads: &[f64], deltas: &[f64], compliances: &[f64]) -> Vec<Self> {
        let ends: Vec<[[f64; 3]; 2]> = (1..loads.len())
            .map(|j| [j - 1, j].map(|j| [loads[j], deltas[j], compliances[j]]))
            .collect();
        // κ of each.
        let falls: Vec<f64> = ends.iter().map(Self::fall).collect();
        ends.iter()
            .enumerate()
            .map(|(j, &ends)| {
                let beside = falls[j.saturating_sub(1)..(j + 2).min(falls.len())].iter();
                let fall = beside.copied().fold(f64::INFINITY, f64::min).max(0.0);
                let course = if j == 0 {
                    Course::from_nothing(&ends)
                } else if falls[j] > KINKED * fall {
                    Course::kinked(&ends, fall).unwrap_or_else(|| Course::smooth(&ends))
                } else {
                    Course::smooth(&ends)
                };
                Self { ends, course }
            })
            .collect()
    }

    /// How far the compliance falls with the logarithm of the load.
    fn fall(&[[from, delta, compliance], [to, next, less]]: &[[f64; 3]; 2]) -> f64 {
        if from == 0.0 {
            (next - delta) / to - less
        } else {
            (compliance - less) / (to / from).ln()
        }
    }

    /// δ under `load`.
    fn delta(&self, load: f64) -> f64 {
        let [[from, delta, _], [to, next, _]] = self.ends;
        match self.course {
            Course::FromNothing { power } => delta + (next - delta) * (load / to).powf(power),
            Course::Smooth { b, c, d } => {
                let x = load / from;
                delta + b * (x - 1.0) + c * x * x.ln() + d * (x * x - 1.0)
            }
            Course::Kinked { place, fall } if load <= place => {
                delta + risen(&self.ends[0], fall, load)
            }
            Course::Kinked { fall, .. } => next + risen(&self.ends[1], fall, load),
        }
    }
}

impl Course {
    /// Meets δ and dδ/dF at its end.
    fn from_nothing(&[[_, delta, _], [to, next, compliance]]: &[[f64; 3]; 2]) -> Self {
        let power = compliance * to / (next - delta);
        // Rounding apart, δ rises, and no faster than in proportion.
        Self::FromNothing {
            power: power.clamp(LEAST_POWER, 1.0),
        }
    }

    /// Meets δ and dδ/dF at both ends.
    fn smooth(&[[from, delta, compliance], [to, next, less]]: &[[f64; 3]; 2]) -> Self {
        let (ratio, rise) = (to / from, next - delta);
        // Slopes over x: B + C + 2 D at its beginning.
        let (first, last) = (compliance * from, less * from);
        let (width, logarithm) = (ratio - 1.0, ratio.ln());
        // C ln r + 2 D (r − 1) = last − first, and C (r ln r − (r − 1)) + D (r − 1)² = rise − first (r − 1).
        let (p, q) = (last - first, rise - first * width);
        let along = ratio * logarithm - width;
        let determinant = logarithm * width * width - 2.0 * width * along;
        let c = (p * width * width - 2.0 * width * q) / determinant;
        let d = (logarithm * q - along * p) / determinant;
        Self::Smooth {
            b: first - c - 2.0 * d,
            c,
            d,
        }
    }

    /// Keeps δ continuous where the courses from both ends, whose compliances fall by `fall` ln F, change; `None` if they do not meet.
    fn kinked(ends: &[[f64; 3]; 2], fall: f64) -> Option<Self> {
        let &[from, to] = ends;
        // The course from the beginning, less that from the end, which rises up to the kink by less and less.
        let apart = |load: f64| from[1] + risen(&from, fall, load) - to[1] - risen(&to, fall, load);
        let [low, high] = [from[0], to[0]];
        let meets = apart(low) < 0.0 && apart(high) > 0.0;
        meets.then(|| {
            let place = crate::root_finding::bisect(low, high, |load| apart(load) < 0.0);
            Self::Kinked { place, fall }
        })
    }
}

/// By how much δ is more under `load` than at one `end` from which the compliance falls by `fall` ln F.
fn risen(&[at, _, compliance]: &[f64; 3], fall: f64, load: f64) -> f64 {
    compliance * (load - at) - fall * (load * (load / at).ln() - (load - at))
}

/// Puts each row beyond the one before.
fn set_apart(rows: &mut [Vec<f64>], beyond: impl Fn(f64, f64) -> f64) {
    for j in 1..rows.len() {
        let (before, rest) = rows.split_at_mut(j);
        for (value, before) in rest[0].iter_mut().zip(&before[j - 1]) {
            *value = beyond(*value, *before);
        }
    }
}

/// A place between two positions.
#[derive(Debug, Clone, Copy)]
struct Between {
    first: usize,
    second: usize,
    part: f64,
    /// Their distance in mesh periods.
    step: f64,
}

impl Between {
    fn value(&self, row: &[f64]) -> f64 {
        row[self.first] + self.part * (row[self.second] - row[self.first])
    }

    fn slope(&self, row: &[f64]) -> f64 {
        (row[self.second] - row[self.first]) / self.step
    }
}

/// Value at `place` of a closed row, in steps of the row.
fn between_closed(row: &[f64], place: f64) -> f64 {
    let first = place.floor();
    let value = |k: i64| row[(first as i64 + k).rem_euclid(row.len() as i64) as usize];
    let part = place - first;
    let through = || lagrange([-1, 0, 1, 2].map(value), part);
    if part == 0.0 {
        value(0)
    } else {
        kinked([-2, -1, 0, 1, 2, 3].map(value), part).unwrap_or_else(through)
    }
}

/// Value under a load `part` of the way on from row `first` of the `values` under `loads`, four or more.
fn between_open(
    loads: &[f64],
    value: impl Fn(usize) -> f64,
    (first, part): (usize, f64),
    load: f64,
) -> f64 {
    if part == 0.0 {
        return value(first);
    }
    // The cubic over the load: proportional values stay proportional.
    let through = || {
        let begin = first.saturating_sub(1).min(loads.len() - 4);
        let nodes = begin..begin + 4;
        let weight = |k: usize| -> f64 {
            let others = nodes.clone().filter(|other| *other != k);
            others
                .map(|other| (load - loads[other]) / (loads[k] - loads[other]))
                .product()
        };
        nodes.clone().map(|k| value(k) * weight(k)).sum()
    };
    if first < 2 || first + 3 >= loads.len() {
        return through();
    }
    let about = [0, 1, 2, 3, 4, 5].map(|k| value(first + k - 2));
    kinked(about, part).unwrap_or_else(through)
}

/// Value at `t` between the third and the fourth of six values, if δ has a kink there.
///
/// Where one more pair of teeth begins to carry, δ falls behind its value without that pair: it is the lesser of two smooth branches, each of which is known on
/// its own side. Each is continued by its parabola; where there is no kink, one of the two continuations passes below the value on the other side.
fn kinked(values: [f64; 6], t: f64) -> Option<f64> {
    let parabola = |y: [f64; 3], u: f64| {
        y[0] * (u - 1.0) * (u - 2.0) / 2.0 - y[1] * u * (u - 2.0) + y[2] * u * (u - 1.0) / 2.0
    };
    let before = |t: f64| parabola([values[0], values[1], values[2]], t + 2.0);
    let after = |t: f64| parabola([values[5], values[4], values[3]], 3.0 - t);
    (before(1.0) > values[3] && after(0.0) > values[2]).then(|| before(t).min(after(t)))
}

/// The cubic through values at −1, 0, 1 and 2.
fn lagrange(values: [f64; 4], t: f64) -> f64 {
    if t == 0.0 {
        return values[1];
    }
    let weights = [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ];
    values.iter().zip(weights).map(|(y, w)| y * w).sum()
}

#[cfg(test)]
pub(super) mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// A mesh that softens towards no load, with an approach that varies by position, and another flank 3 below.
    pub(in crate::dynamics) fn wavy(positions: usize, count: usize) -> ForceTable {
        let place = |j: usize| j as f64 / (count - 1) as f64;
        let loads: Vec<f64> = (0..count).map(|j| 4.0 * part_at(place(j))).collect();
        let eta = |i: usize| i as f64 / positions as f64;
        let of = |load: f64, eta: f64| {
            let wave = 0.2 * (2.0 * PI * eta).cos() + 0.1 * (4.0 * PI * eta + 0.7).sin();
            0.05 * wave + load.powf(0.9) * (1.0 + wave)
        };
        let rows = |sign: f64, from: f64| {
            loads
                .iter()
                .map(|load| {
                    (0..positions)
                        .map(|i| from + sign * of(*load, sign * eta(i)))
                        .collect()
                })
                .collect()
        };
        let compliance = loads.iter().map(|load| {
            let at = |i: usize| {
                let waved = of(1.0, eta(i)) - of(0.0, eta(i));
                0.9 * load.powf(-0.1) * waved
            };
            (0..positions).map(at).collect()
        });
        let compliance = compliance.collect();
        let loaded = FlankRows {
            delta: rows(1.0, 0.0),
            compliance: Some(compliance),
        };
        let other = FlankRows::of_delta(rows(-1.0, -3.0));
        ForceTable::new(1, loads, [loaded, other]).expect("rows that rise")
    }

    #[test]
    fn a_row_that_falls_is_told_and_one_that_rounding_moved_is_set_apart() {
        let ladder = LoadSteps {
            count: 3,
            largest: 4.0,
        };
        let table = |falls: f64, sign: f64| {
            let rows = |sign: f64, from: f64, falls: f64| {
                // At the first position it rises.
                let row = |first: f64, last: f64| vec![from + sign * first, from + sign * last];
                let rows = [(0.0, 0.0), (1e-6, 2e-6), (3e-6, 2e-6 - falls)];
                FlankRows::of_delta(rows.map(|(first, last)| row(first, last)).to_vec())
            };
            let falling = |of: f64| if of == sign { falls } else { -1e-6 };
            let flanks = [
                rows(1.0, 0.0, falling(1.0)),
                rows(-1.0, -9e-6, falling(-1.0)),
            ];
            ForceTable::new(2, ladder.loads(), flanks)
        };
        for sign in [1.0, -1.0] {
            let fall = table(0.3e-6, sign).expect_err("it falls");
            assert_eq!((fall.mesh_position, fall.load), (1.0, 4.0 * sign));
            assert!((fall.falls / 0.3e-6 - 1.0).abs() < 1e-6, "{fall}");
            let apart = table(1e-15, sign).expect("rounding");
            let flank = if sign > 0.0 {
                apart.loaded()
            } else {
                apart.other()
            };
            let rise = sign * (flank.delta[2][1] - flank.delta[1][1]);
            assert!(rise > 0.0 && rise < 2.0 * APART, "{rise:e}");
        }
    }

    #[test]
    fn rows_between_rows_that_rise_rise_too() {
        // δ = c F, with a compliance c that is very small at two positions beside each other: a cubic through those around them is negative in between. The
        // compliances of the loaded flank are ten times too large, so that the curve that meets them turns back from row to row.
        let compliance = [1e-6, 1e-6, 1e-6, 1e-9, 1e-9, 1e-6, 1e-6, 1e-6];
        let loads = [0.0, 1.0, 2.0, 4.0, 8.0].to_vec();
        let rows = |factor: f64, from: f64| {
            let row = |load: &f64| {
                compliance
                    .iter()
                    .map(|c| from + factor * c * load)
                    .collect()
            };
            loads.iter().map(row).collect::<Vec<Vec<f64>>>()
        };
        let loaded = FlankRows {
            delta: rows(1.0, 0.0),
            compliance: Some(vec![compliance.map(|c| 10.0 * c).to_vec(); loads.len()]),
        };
        let other = FlankRows::of_delta(rows(-1.0, -1e-6));
        let table = ForceTable::new(1, loads, [loaded, other]).expect("rows that rise");
        let fine = table.refined(4, 4);
        let loads = fine.loads.windows(2);
        for (j, load) in loads.map(|ends| ends[1] - ends[0]).enumerate() {
            for i in 0..fine.positions() {
                for (flank, sign) in [(fine.loaded(), 1.0), (fine.other(), -1.0)] {
                    let rises = sign * (flank.delta[j + 1][i] - flank.delta[j][i]) / load;
                    // Where it is linear it rises as the rows beside it do; where it is not, more than rounding.
                    assert!(rises > 1e-3 * 1e-9, "{sign} {i} {j}: {rises:e}");
                }
            }
        }
        // Halfway between the two positions, under the loads of the table.
        let halfway = |j: usize| fine.loaded().delta[j][14];
        for (j, load) in [(4, 1.0), (8, 2.0), (12, 4.0), (16, 8.0)] {
            assert!((halfway(j) / (1e-9 * load) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn loads_of_a_table_rise_however_many_there_are() {
        for count in 2..400 {
            let loads = LoadSteps {
                count,
                largest: 3.0,
            }
            .loads();
            assert_eq!((loads.len(), loads[0], loads[count - 1]), (count, 0.0, 3.0));
            assert!(loads.is_sorted_by(|a, b| a < b), "{count}: {loads:?}");
        }
    }

    #[test]
    fn no_load_acts_in_the_backlash_and_loads_rise_on_both_sides_of_it() {
        let table = wavy(40, 9);
        for eta in [0.0, 0.21, 0.5, 0.999, 3.4, -0.2] {
            let touch = table.refined(1, 1).loaded.delta[0].clone();
            let here = between_closed(&touch, eta * 40.0);
            for inside in [0.01, 1.0, 2.5] {
                assert_eq!(table.load(eta, here - inside), 0.0);
            }
            let mut before = 0.0;
            for step in 1..60 {
                let load = table.load(eta, here + 0.1 * f64::from(step));
                assert!(load > before);
                before = load;
            }
            let mut before = 0.0;
            for step in 1..60 {
                let load = table.load(eta, -3.2 - 0.1 * f64::from(step));
                assert!(load < before);
                before = load;
            }
        }
    }

    #[test]
    fn a_load_of_the_table_comes_back_at_its_approach() {
        let table = wavy(24, 9);
        for (j, load) in table.loads().iter().enumerate() {
            for (i, eta) in table.mesh_positions().into_iter().enumerate() {
                let found = table.load(eta, table.loaded.delta[j][i]);
                assert!((found - load).abs() < 1e-12, "{found} {load}");
                let found = table.load(eta, table.other.delta[j][i]);
                assert!((found + load).abs() < 1e-12, "{found} {load}");
            }
        }
    }

    #[test]
    fn what_a_closed_path_takes_it_gives_back() {
        // There and back in position while δ goes through backlash and other flank and beyond the largest load. No interval lies astride a
        // position of the table, where the torque steps.
        let table = wavy(24, 9);
        let (cells, parts) = (17_i32, 20_000_i32);
        let n = 2 * cells * parts;
        let path = |i: i32| {
            let there = i.min(n - i);
            let eta = f64::from(there) / f64::from(parts) / 24.0;
            (
                eta,
                -0.5 + 5.0 * (2.0 * PI * f64::from(i) / f64::from(n)).sin(),
            )
        };
        let (mut work, mut of_load, mut moved) = (0.0, 0.0, 0.0);
        for i in 0..n {
            let (a, b) = (path(i), path(i + 1));
            let middle = table.forces((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0);
            let one = middle.load * (b.1 - a.1);
            work += one + middle.per_period * (b.0 - a.0);
            of_load += one;
            moved += one.abs();
            if i == n / 5 {
                let gained = table.forces(b.0, b.1).energy - table.forces(0.0, -0.5).energy;
                assert!(
                    (work - gained).abs() < 1e-9 * gained.abs(),
                    "{work} {gained}"
                );
            }
        }
        assert!(work.abs() < 1e-9 * moved, "{work} of {moved}");
        // The load alone does not.
        assert!(of_load.abs() > 0.01 * moved);
    }

    #[test]
    fn a_kink_between_two_values_is_found_where_it_is() {
        // The lesser of two parabolas, which meet at 0.3 of the way between the third and the fourth value.
        let one = |x: f64| 1.0 + 0.5 * x + 0.1 * x * x;
        let other = |x: f64| one(x) - 0.7 * (x - 0.3) - 0.2 * (x - 0.3) * (x - 0.3);
        let least = |x: f64| if x < 0.3 { one(x) } else { other(x) };
        let values = [-2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(least);
        for t in [0.1, 0.29, 0.31, 0.8] {
            let found = kinked(values, t).expect("a kink");
            assert!((found - least(t)).abs() < 1e-12, "{t}");
        }
        assert_eq!(
            kinked(
                [-2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(|x: f64| x.powi(3)),
                0.3
            ),
            None
        );
    }

    #[test]
    fn refining_keeps_what_was_computed_and_comes_near_what_was_not() {
        let coarse = wavy(48, 9);
        let fine = coarse.refined(4, 4);
        for (j, row) in coarse.loaded.delta.iter().enumerate() {
            for (i, value) in row.iter().enumerate() {
                assert_eq!(fine.loaded.delta[4 * j][4 * i], *value);
            }
        }
        let true_one = wavy(192, 33);
        let near = |found: &[Vec<f64>], expected: &[Vec<f64>], most: f64| {
            for (found, expected) in found.iter().zip(expected) {
                for (found, expected) in found.iter().zip(expected) {
                    assert!((found - expected).abs() < most, "{found} {expected}");
                }
            }
        };
        near(&fine.loaded.delta, &true_one.loaded.delta, 2e-3);
        // Without compliances nothing says how soft the first stretch begins.
        let [found, expected] = [&fine, &true_one].map(|table| &table.other.delta);
        near(found, expected, 1e-2);
    }

    #[test]
    fn a_kink_is_found_of_what_stands_beside_it() {
        // A line contact, to which another comes at a load between two of the table.
        let ladder = LoadSteps {
            count: 12,
            largest: 1000.0,
        };
        let at = |load: f64, kink: f64| {
            let logarithm = if load > 0.0 {
                (load / 1000.0).ln()
            } else {
                0.0
            };
            let one = load * (1.0 - 0.05 * (logarithm - 1.0));
            let parallel = (load - kink).max(0.0);
            (
                one - 0.35 * parallel,
                1.0 - 0.05 * logarithm - if load > kink { 0.35 } else { 0.0 },
            )
        };
        for kink in [60.0, 300.0, 333.0, 480.0, 700.0, 930.0] {
            let row = |load: f64| vec![at(load, kink).0; 8];
            let rows = |sign: f64| {
                ladder
                    .loads()
                    .into_iter()
                    .map(|load| row(load).iter().map(|d| sign * d).collect())
                    .collect()
            };
            let compliance = ladder
                .loads()
                .into_iter()
                .map(|load| vec![at(load, kink).1; 8])
                .collect::<Vec<_>>();
            let flanks = [1.0, -1.0].map(|sign| FlankRows {
                delta: rows(sign),
                compliance: Some(compliance.clone()),
            });
            let table = ForceTable::new(1, ladder.loads(), flanks).expect("rows that rise");
            let table = table.refined(1, 16);
            let both = table.loaded.delta.iter().zip(&table.other.delta);
            let missed = table.loads().iter().zip(both).map(|(load, (row, other))| {
                let delta = at(*load, kink).0;
                let loads = [
                    table.load(0.2, delta) - load,
                    table.load(0.2, -delta) + load,
                ];
                let deltas = [row[0] - delta, other[0] + delta];
                loads
                    .into_iter()
                    .chain(deltas)
                    .fold(0.0_f64, |most, d| most.max(d.abs()))
            });
            let missed = missed.fold(0.0, f64::max);
            assert!(missed < 1e-3 * 1000.0, "{kink}: {missed}");
        }
    }
}
