//! The motion over speed: up and down, with the jumps between, its orders and its resonances.

use std::collections::HashMap;
use std::f64::consts::PI;

use super::bodies::Coupled;
use super::mesh::{CARRIES, Mesh, Motion, RunUpData, STEPS_A_PERIOD};
use super::orbit::{MOST_LOOKS, Orbit, SETTLED, WATCHED};
use super::order::Order;
use super::resonance::{self, LOOKED_AT, MOST_SOUGHT, Pass, Resonance};
use super::table::ForceTable;
use crate::run::{Run, Stopped};

/// Seconds of one core that a look takes.
const SECONDS_A_LOOK: f64 = 22e-9;

/// Time of a look over that of an oscillator where gear bodies vibrate, by itself and for each of their common modes, when a state is carried with its derivative
/// now and then. Measured with 3 and 31 modes, as are the two below.
const WITH_BODIES: [f64; 2] = [3.8, 0.26];

/// The same of motions that settle, for each mode: no derivative is carried, and fewer motions have to settle, because bodies damp them.
const SETTLES_WITH_BODIES: f64 = 0.025;

/// Seconds of one core for each mode that the search for its resonances takes.
const SECONDS_A_MODE: f64 = 0.12;

/// How often a period is gone through at each speed, about; where the motion jumps, more often.
const LOOKED_THROUGH: f64 = 8.0;

/// Motions that settle anew in the search for the resonances at one line of the stiffness, about: measured with damping ratios of 0.001 to 0.07.
const SETTLED_AT: f64 = 150.0;

/// The first line of the stiffness over its mean, and the power of its number by which further ones fall, about.
const VARIATION: f64 = 0.3;
const FALLING: f64 = 1.5;

/// One branch of the motion, speed by speed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Branch {
    /// Root mean square of x, its mean removed, in m.
    pub rms: Vec<f64>,
    /// Largest less smallest x in m.
    pub peak_to_peak: Vec<f64>,
    /// The largest F(θ, x) over F_0.
    pub load_factor: Vec<f64>,
    /// The largest force on either flank in N.
    pub largest_force: Vec<f64>,
    /// True where the loaded flanks separate.
    pub contact_lost: Vec<bool>,
    /// True periods after which the motion repeats; `None` where it was not found to.
    pub repeats: Vec<Option<u32>>,
    /// The amplitudes of x at the orders of the run-up, in m, order by order.
    pub orders: Vec<Vec<f64>>,
    /// True where the motion grows without bound; it is followed until it has run away.
    pub runs_away: Vec<bool>,
}

impl Branch {
    fn of(motions: &[Motion], orders: &[Order]) -> Self {
        let over_order = |order: &Order| {
            let amplitudes = motions.iter().map(|motion| motion.lines.at(*order));
            amplitudes.collect()
        };
        let all = motions.iter();
        Self {
            rms: all.clone().map(|motion| motion.rms).collect(),
            peak_to_peak: all.clone().map(|motion| motion.peak_to_peak).collect(),
            load_factor: all.clone().map(|motion| motion.load_factor).collect(),
            largest_force: all.clone().map(|motion| motion.largest_force).collect(),
            contact_lost: all.clone().map(|motion| motion.contact_lost).collect(),
            repeats: all.clone().map(|motion| motion.orbit.repeats).collect(),
            orders: orders.iter().map(over_order).collect(),
            runs_away: all.map(|motion| motion.orbit.runs_away).collect(),
        }
    }
}

/// The motion over speed under one load.
#[derive(Debug, Clone, PartialEq)]
pub struct RunUp {
    /// The natural frequencies in Hz of the bodies on the mean stiffness of their mesh, rising; without modes of the bodies √(k/m_e)/2π.
    pub natural_frequencies: Vec<f64>,
    /// The orders whose amplitudes are known, rising.
    pub orders: Vec<Order>,
    /// Up, where asked for.
    pub up: Option<Branch>,
    /// Down, where asked for; its lists rise with speed too.
    pub down: Option<Branch>,
    /// The resonances in range, the largest amplitude first.
    pub resonances: Vec<Resonance>,
}

impl RunUpData {
    /// Seconds of one core that the run-up through a mesh that repeats after `period` mesh periods takes, about.
    pub fn seconds(&self, period: u32) -> f64 {
        let coupled = self.coupled(1.0 / self.stiffness);
        let (moves, [swept_through, settles, sought]) = match &coupled {
            Some(coupled) => {
                let count = coupled.count() as f64;
                let [alone, more] = WITH_BODIES;
                let parts = [
                    alone + more * count,
                    SETTLES_WITH_BODIES * count,
                    SECONDS_A_MODE * count,
                ];
                (coupled.at_teeth(), parts)
            }
            None => (self.natural(), [1.0, 1.0, 0.0]),
        };
        let natural = self.natural() / (2.0 * PI);
        let steps = STEPS_A_PERIOD as f64 * f64::from(period);
        let looks = |speed: f64| self.looks(speed, STEPS_A_PERIOD as f64, moves);
        let teeth = f64::from(self.tooth_count);
        let meetings = self.orders.iter().map(|order| natural / (order * teeth));
        let meetings = meetings.filter(|speed| self.reaches(*speed));
        let swept: f64 = self.speeds.iter().copied().map(looks).sum();
        let resonant: f64 = meetings.map(looks).sum();
        let sweeps = self.sweeps.iter().filter(|asked| **asked).count() as f64;
        let all = sweeps * swept + LOOKED_AT * resonant;
        let decay = coupled
            .as_ref()
            .map_or_else(|| 1.0 / (self.damping_ratio * moves), Coupled::decay);
        let settled = self.looks_until_settled(moves, decay, period);
        let looks = swept_through * LOOKED_THROUGH * steps * all + settles * settled;
        SECONDS_A_LOOK * looks + sought
    }

    /// Looks until motions have settled where the mesh is expected to excite them by its stiffness, about. Free motions of the circular frequency `moves` fall by
    /// a factor e in the time `decay`.
    fn looks_until_settled(&self, moves: f64, decay: f64, period: u32) -> f64 {
        let natural = self.natural() / (2.0 * PI);
        let teeth = f64::from(self.tooth_count);
        // Mathieu's equation is unstable at twice the natural frequency from a variation of 4 ζ on.
        let lines = (VARIATION / (2.0 * self.damping_ratio)).powf(1.0 / FALLING);
        let most = f64::from(MOST_SOUGHT.1[1]);
        let orders = (1..)
            .map(f64::from)
            .take_while(|line| *line <= lines.min(most));
        let speeds = orders.map(|line| natural / (0.5 * line * teeth));
        let at = |speed: f64| {
            let per_period =
                self.looks(speed, STEPS_A_PERIOD as f64, moves) * STEPS_A_PERIOD as f64;
            let in_a_second = per_period * speed * teeth;
            let [least, most] = [per_period * f64::from(period), MOST_LOOKS];
            let [first, second] = SETTLED;
            let each = [first, second, WATCHED]
                .map(|constants| (constants * decay * in_a_second).min(most).max(least));
            each.iter().sum::<f64>()
        };
        let reached = speeds.filter(|speed| self.reaches(*speed));
        SETTLED_AT * reached.map(at).sum::<f64>()
    }

    /// Bytes that the run-up takes, about: the amplitudes of all motions, from which orders are chosen.
    pub fn memory(&self, period: u32) -> u64 {
        let lines = STEPS_A_PERIOD as u64 / 2 * u64::from(period);
        let sweeps = self.sweeps.iter().filter(|asked| **asked).count() as u64;
        size_of::<f32>() as u64 * sweeps * self.speeds.len() as u64 * lines
    }

    /// True if `speed` is among those asked for or between two of them.
    pub(super) fn reaches(&self, speed: f64) -> bool {
        let ends = self.speeds.first().zip(self.speeds.last());
        ends.is_some_and(|(first, last)| (*first..=*last).contains(&speed))
    }

    /// The motion in the mesh of `table`.
    ///
    /// # Errors
    ///
    /// [`Stopped`] if `run` was told to stop.
    pub fn run_up(&self, table: &ForceTable, run: &Run) -> Result<RunUp, Stopped> {
        let mesh = Mesh::new(self, table);
        let pass = |down: bool| {
            let wanted = self.sweeps[usize::from(down)];
            wanted.then(|| mesh.passed(down, run)).transpose()
        };
        let (up, down) = rayon::join(|| pass(false), || pass(true));
        let passes = [up?, down?];
        let resonances = resonance::search(&mesh, &passes, run)?;
        let orders = mesh.orders(&passes, &resonances);
        let branch = |pass: &Option<Pass>| {
            let pass = pass.as_ref()?;
            Some(Branch::of(&pass.motions, &orders))
        };
        let [up, down] = passes.each_ref().map(branch);
        Ok(RunUp {
            natural_frequencies: mesh.natural_frequencies(),
            orders,
            up,
            down,
            resonances,
        })
    }
}

impl Mesh<'_> {
    /// The motions from the lowest speed up, or from the highest down, each going on from the last.
    fn passed(&self, down: bool, run: &Run) -> Result<Pass, Stopped> {
        let speeds = &self.data.speeds;
        let mut orbit = Orbit::REST;
        let mut motion = |speed: &f64| {
            run.check()?;
            let motion = self.settled(*speed, &orbit);
            orbit = if motion.orbit.runs_away {
                Orbit::REST
            } else {
                motion.orbit.clone()
            };
            Ok(motion)
        };
        let motions = if down {
            let motions: Result<Vec<_>, _> = speeds.iter().rev().map(motion).collect();
            let mut motions = motions?;
            motions.reverse();
            motions
        } else {
            speeds.iter().map(&mut motion).collect::<Result<_, _>>()?
        };
        Ok(Pass { down, motions })
    }

    /// The orders in the results, rising: those that are known, those of `resonances`, and those that carry a part of the motion at any speed, as far as
    /// there is room.
    fn orders(&self, passes: &[Option<Pass>; 2], resonances: &[Resonance]) -> Vec<Order> {
        let mut parts: HashMap<Order, f64> = HashMap::new();
        let motions = passes.iter().flatten().flat_map(|pass| &pass.motions);
        for (order, part) in motions.flat_map(|motion| motion.carriers()) {
            let most = parts.entry(order).or_default();
            *most = most.max(part);
        }
        for resonance in resonances {
            parts.entry(resonance.order).or_insert(CARRIES);
        }
        for order in self.data.known(self.period) {
            parts.insert(order, f64::INFINITY);
        }
        let mut all: Vec<(Order, f64)> = parts.into_iter().collect();
        let place = |order: &Order| order.per_true_period();
        all.sort_by(|a, b| {
            b.1.total_cmp(&a.1)
                .then(place(&a.0).total_cmp(&place(&b.0)))
        });
        all.truncate(self.data.most_orders);
        let mut orders: Vec<Order> = all.into_iter().map(|(order, _)| order).collect();
        orders.sort_by(|a, b| place(a).total_cmp(&place(b)));
        orders
    }
}
