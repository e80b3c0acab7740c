//! The motion over speed: up and down, with the jumps between, its orders and its resonances.

use std::f64::consts::PI;

use super::law::Laws;
use super::orbit::{Orbit, Scale};
use super::oscillator::{Oscillator, Step};
use super::table::ForceTable;
use crate::run::{Run, Stopped};

/// Steps in a mesh period, at least.
const STEPS_A_PERIOD: usize = 128;

/// Pieces of the law of force of a flank, at least.
const PIECES: usize = 44;

/// Looks in a period of free motion, about.
const LOOKS: f64 = 20.0;

/// Looks in a step, at most: below the speeds that would need more, the motion is that of the static deflection.
const MOST_LOOKS: f64 = 64.0;

/// Seconds of one core that a look takes.
const SECONDS_A_LOOK: f64 = 60e-9;

/// How often a period is gone through at each speed, about; where the motion jumps, more often.
const LOOKED_THROUGH: f64 = 8.0;

/// What a run-up is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct RunUpData {
    /// Speeds of the driving gear in revolutions per second, rising; 0 is the static curve.
    pub speeds: Vec<f64>,
    /// Teeth of the driving gear.
    pub tooth_count: u32,
    /// The load F_0 in N.
    pub load: f64,
    /// m_e in kg.
    pub mass: f64,
    /// ζ.
    pub damping_ratio: f64,
    /// The mean mesh stiffness under F_0 in N/m.
    pub stiffness: f64,
    /// Orders to tell, per mesh period.
    pub orders: Vec<f64>,
    /// Whether to run up, and whether to run down.
    pub sweeps: [bool; 2],
}

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
    /// Whether the loaded flanks part.
    pub contact_lost: Vec<bool>,
    /// True periods after which the motion repeats; `None` where it was not found to.
    pub repeats: Vec<Option<u32>>,
    /// The amplitude of x at each order asked for, in m, order by order.
    pub orders: Vec<Vec<f64>>,
    /// Whether the motion grows without bound; it is followed until it has run away.
    pub runs_away: Vec<bool>,
}

/// The motion over speed under one load.
#[derive(Debug, Clone, PartialEq)]
pub struct RunUp {
    /// The natural frequency √(k/m_e)/2π in Hz.
    pub natural_frequency: f64,
    /// Up, where asked for.
    pub up: Option<Branch>,
    /// Down, where asked for; its lists rise with speed too.
    pub down: Option<Branch>,
    /// The resonances in range. The first has the largest amplitude; of equal ones a forced one comes first, then the lower speed.
    pub resonances: Vec<Resonance>,
}

/// Why an order resonates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ResonanceKind {
    /// The order meets the natural frequency.
    Forced,
    /// It meets twice that, and its part of the stiffness pumps.
    Parametric,
}

/// Both, forced first.
const KINDS: [ResonanceKind; 2] = [ResonanceKind::Forced, ResonanceKind::Parametric];

impl ResonanceKind {
    /// How often what moves at the natural frequency comes in two true periods, in one of which the order comes so many `times`.
    fn half_order(self, times: u64) -> u64 {
        match self {
            Self::Forced => 2 * times,
            Self::Parametric => times,
        }
    }
}

/// A speed at which an order resonates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// The speed of the driving gear in revolutions per second.
    pub speed: f64,
    /// The place of the order.
    pub order: usize,
    /// Why.
    pub kind: ResonanceKind,
    /// The amplitude of x at the natural frequency at this speed, in m, on the branch where it is larger.
    pub amplitude: f64,
}

/// A speed at which a half order is at the natural frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Meeting {
    /// The speed of the driving gear in revolutions per second.
    speed: f64,
    /// How often it comes in two true periods.
    half_order: u64,
}

impl RunUpData {
    /// √(k/m_e) in rad/s.
    fn natural(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    fn damping(&self) -> f64 {
        2.0 * self.damping_ratio * (self.stiffness * self.mass).sqrt()
    }

    /// Seconds of one core that the run-up through a mesh that repeats after `period` mesh periods takes, about.
    pub fn seconds(&self, period: u32) -> f64 {
        let steps = STEPS_A_PERIOD as f64 * f64::from(period);
        let looks = |speed: f64| {
            let step = 1.0 / (speed * f64::from(self.tooth_count) * STEPS_A_PERIOD as f64);
            (LOOKS * step * self.natural() / (2.0 * PI)).clamp(1.0, MOST_LOOKS)
        };
        let meetings = self.meetings(period);
        let speeds = self.speeds.iter().copied();
        let all: f64 = speeds
            .chain(meetings.iter().map(|meeting| meeting.speed))
            .map(looks)
            .sum();
        let sweeps = self.sweeps.iter().filter(|asked| **asked).count() as f64;
        SECONDS_A_LOOK * LOOKED_THROUGH * sweeps * steps * all
    }

    /// How often each order comes in a true period of `period` mesh periods.
    fn per_true_period(&self, period: u32) -> impl Iterator<Item = u64> {
        let times = move |order: &f64| (order * f64::from(period)).round() as u64;
        self.orders.iter().map(times)
    }

    /// The speeds in range at which one of the orders resonates, each once, rising.
    fn meetings(&self, period: u32) -> Vec<Meeting> {
        let natural = self.natural() / (2.0 * PI);
        let (Some(&first), Some(&last)) = (self.speeds.first(), self.speeds.last()) else {
            return Vec::new();
        };
        let mut half_orders: Vec<u64> = self
            .per_true_period(period)
            .flat_map(|times| KINDS.map(|kind| kind.half_order(times)))
            .filter(|half_order| *half_order > 0)
            .collect();
        half_orders.sort_unstable();
        half_orders.dedup();
        let teeth = f64::from(self.tooth_count);
        let meetings = half_orders.into_iter().rev().map(|half_order| Meeting {
            speed: 2.0 * natural * f64::from(period) / (half_order as f64 * teeth),
            half_order,
        });
        meetings
            .filter(|meeting| (first..=last).contains(&meeting.speed))
            .collect()
    }

    /// The resonances at `meetings`, at which x has these `amplitudes` at the natural frequency.
    fn resonances(&self, period: u32, meetings: &[(Meeting, f64)]) -> Vec<Resonance> {
        let mut found = Vec::new();
        for (order, times) in self.per_true_period(period).enumerate() {
            for kind in KINDS {
                let half_order = kind.half_order(times);
                let met = meetings.iter().find(|(at, _)| at.half_order == half_order);
                found.extend(met.map(|&(Meeting { speed, .. }, amplitude)| Resonance {
                    speed,
                    order,
                    kind,
                    amplitude,
                }));
            }
        }
        found.sort_by(|a, b| {
            let larger = b.amplitude.total_cmp(&a.amplitude);
            larger
                .then(a.kind.cmp(&b.kind))
                .then(a.speed.total_cmp(&b.speed))
        });
        found
    }

    /// The motion in the mesh of `table`.
    ///
    /// # Errors
    ///
    /// [`Stopped`] if `run` was told to stop.
    pub fn run_up(&self, table: &ForceTable, run: &Run) -> Result<RunUp, Stopped> {
        let mesh = Mesh::new(self, table);
        let meetings = self.meetings(table.period());
        let branch = |down: bool| {
            let wanted = self.sweeps[usize::from(down)];
            wanted
                .then(|| mesh.branch(down, &meetings, run))
                .transpose()
        };
        let (up, down) = rayon::join(|| branch(false), || branch(true));
        let ((up, upward), (down, downward)) = (up?.unzip(), down?.unzip());
        let met = meetings.iter().enumerate().map(|(i, meeting)| {
            let amplitudes = [&upward, &downward].into_iter().flatten();
            let larger = amplitudes.map(|branch| branch[i]).fold(0.0, f64::max);
            (*meeting, larger)
        });
        let met: Vec<(Meeting, f64)> = met.collect();
        Ok(RunUp {
            natural_frequency: self.natural() / (2.0 * PI),
            up,
            down,
            resonances: self.resonances(table.period(), &met),
        })
    }
}

/// A table made ready to be run through at any speed.
struct Mesh<'a> {
    data: &'a RunUpData,
    laws: Laws,
    /// Steps in a mesh period.
    per_period: f64,
    /// δ_s under F_0 at the ends of steps.
    deflection: Vec<f64>,
    /// How often each order comes in two true periods.
    half_orders: Vec<u64>,
    /// Cosine and sine at the ends of the steps of two true periods of what comes once in them.
    waves: Vec<(f64, f64)>,
}

impl<'a> Mesh<'a> {
    fn new(data: &'a RunUpData, table: &ForceTable) -> Self {
        let computed = table.positions() / table.period() as usize;
        let table = table.refined(
            STEPS_A_PERIOD.div_ceil(computed),
            PIECES.div_ceil(table.loads().len() - 1),
        );
        let deflection = table.transmission_error(data.load);
        let loads = table.loads();
        let forces: Vec<f64> = loads
            .iter()
            .rev()
            .map(|load| -load)
            .chain(loads.iter().copied())
            .collect();
        let count = table.positions();
        let mut knots = Vec::with_capacity(count * forces.len());
        for i in 0..count {
            let next = (i + 1) % count;
            let middle = |row: &[f64]| f64::midpoint(row[i], row[next]);
            let rest = middle(&deflection);
            let other = table.other().delta.iter().rev();
            knots.extend(
                other
                    .chain(&table.loaded().delta)
                    .map(|row| middle(row) - rest),
            );
        }
        let per_period = count as f64 / f64::from(table.period());
        let twice = 2 * count;
        let wave = |i: usize| {
            let (sin, cos) = (2.0 * PI * i as f64 / twice as f64).sin_cos();
            (cos, sin)
        };
        let times = data.per_true_period(table.period());
        Self {
            data,
            laws: Laws::new(forces, knots, loads.len()),
            per_period,
            deflection,
            half_orders: times.map(|times| 2 * times).collect(),
            waves: (0..twice).map(wave).collect(),
        }
    }

    /// δ_s' at `speed`, step by step.
    fn drifts(&self, duration: f64) -> Vec<f64> {
        let count = self.deflection.len();
        (0..count)
            .map(|i| (self.deflection[(i + 1) % count] - self.deflection[i]) / duration)
            .collect()
    }

    fn oscillator(&self, speed: f64) -> Oscillator<'_> {
        let data = self.data;
        let duration = 1.0 / (speed * f64::from(data.tooth_count) * self.per_period);
        let damping = data.damping();
        let drifts = self.drifts(duration);
        let count = drifts.len();
        let steps = (0..count)
            .map(|i| Step {
                law: i,
                force: data.load - damping * drifts[i],
                kick: drifts[(i + count - 1) % count] - drifts[i],
            })
            .collect();
        let looks = LOOKS * duration * data.natural() / (2.0 * PI);
        Oscillator {
            laws: &self.laws,
            mass: data.mass,
            damping,
            duration,
            looks: looks.ceil().clamp(1.0, MOST_LOOKS) as u32,
            steps,
        }
    }

    fn scale(&self) -> Scale {
        let most = self
            .deflection
            .iter()
            .fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let least = self.deflection.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let u = self.data.load / self.data.stiffness + most - least;
        Scale {
            u,
            v: u * self.data.natural(),
        }
    }

    /// The branch from the lowest speed up, or from the highest down, each motion going on from the last; and the amplitudes of x at the natural
    /// frequency at each of the `meetings`, whose motions go on from the nearest speed before.
    fn branch(
        &self,
        down: bool,
        meetings: &[Meeting],
        run: &Run,
    ) -> Result<(Branch, Vec<f64>), Stopped> {
        let data = self.data;
        let count = data.speeds.len();
        let mut seen: Vec<Option<Motion>> = vec![None; count];
        let scale = self.scale();
        let mut orbit = Orbit::REST;
        let mut orbits = vec![orbit; count];
        let order = |k: usize| if down { count - 1 - k } else { k };
        for place in (0..count).map(order) {
            run.check()?;
            let speed = data.speeds[place];
            seen[place] = Some(if speed > 0.0 {
                let oscillator = self.oscillator(speed);
                orbit = oscillator.settled(orbit, scale);
                let motion = self.motion(&oscillator, orbit, &self.half_orders);
                if orbit.runs_away {
                    orbit = Orbit::REST;
                }
                motion
            } else {
                self.standing()
            });
            orbits[place] = orbit;
        }
        let mut amplitudes = Vec::with_capacity(meetings.len());
        for meeting in meetings {
            run.check()?;
            let below = data.speeds.partition_point(|speed| *speed <= meeting.speed);
            let before = if down {
                below.min(count - 1)
            } else {
                below - 1
            };
            let oscillator = self.oscillator(meeting.speed);
            let settled = oscillator.settled(orbits[before], scale);
            let motion = self.motion(&oscillator, settled, &[meeting.half_order]);
            amplitudes.push(motion.orders[0]);
        }
        let mut branch = Branch {
            orders: vec![Vec::with_capacity(count); data.orders.len()],
            ..Branch::default()
        };
        for motion in seen.into_iter().flatten() {
            branch.rms.push(motion.rms);
            branch.peak_to_peak.push(motion.peak_to_peak);
            branch.load_factor.push(motion.load_factor);
            branch.largest_force.push(motion.largest_force);
            branch.contact_lost.push(motion.contact_lost);
            branch.repeats.push(motion.repeats);
            branch.runs_away.push(motion.runs_away);
            for (list, amplitude) in branch.orders.iter_mut().zip(motion.orders) {
                list.push(amplitude);
            }
        }
        Ok((branch, amplitudes))
    }

    /// The static curve.
    fn standing(&self) -> Motion {
        let mut watched = Watched::new(self, &self.half_orders);
        for &x in &self.deflection {
            watched.take(x);
            watched.end_of_step(x);
        }
        watched.force(self.data.load, false);
        watched.motion(Orbit::REST)
    }

    /// What `orbit` is seen to do, at these half orders.
    fn motion(&self, oscillator: &Oscillator<'_>, orbit: Orbit, half_orders: &[u64]) -> Motion {
        let mut watched = Watched::new(self, half_orders);
        let mut state = orbit.state;
        let mut left = false;
        let scale = self.scale();
        let count = self.deflection.len();
        for _ in 0..orbit.periods {
            (state, _) = oscillator.after_period(state, |seen| {
                left |= scale.is_left_by(seen.u);
                if left {
                    return;
                }
                let (from, to) = (
                    self.deflection[seen.step],
                    self.deflection[(seen.step + 1) % count],
                );
                let x = from + seen.part * (to - from) + seen.u;
                watched.take(x);
                watched.force(seen.force, seen.apart);
                if seen.part == 1.0 {
                    watched.end_of_step(x);
                }
            });
        }
        watched.motion(orbit)
    }
}

/// The motion at one speed.
#[derive(Debug, Clone)]
struct Motion {
    rms: f64,
    peak_to_peak: f64,
    load_factor: f64,
    largest_force: f64,
    contact_lost: bool,
    repeats: Option<u32>,
    orders: Vec<f64>,
    runs_away: bool,
}

/// Sums over a motion.
struct Watched<'a> {
    mesh: &'a Mesh<'a>,
    /// From where x is counted, so that sums keep their digits.
    datum: f64,
    sum: f64,
    squares: f64,
    least: f64,
    most: f64,
    /// The largest force of the loaded flank, and of either.
    largest: [f64; 2],
    parted: bool,
    steps: u64,
    half_orders: &'a [u64],
    /// The sums of x times the cosine and times the sine of each.
    waves: Vec<(f64, f64)>,
}

impl<'a> Watched<'a> {
    fn new(mesh: &'a Mesh<'a>, half_orders: &'a [u64]) -> Self {
        Self {
            mesh,
            datum: mesh.deflection[0],
            sum: 0.0,
            squares: 0.0,
            least: f64::INFINITY,
            most: f64::NEG_INFINITY,
            largest: [0.0; 2],
            parted: false,
            steps: 0,
            half_orders,
            waves: vec![(0.0, 0.0); half_orders.len()],
        }
    }

    fn take(&mut self, x: f64) {
        let x = x - self.datum;
        self.least = self.least.min(x);
        self.most = self.most.max(x);
    }

    fn force(&mut self, force: f64, apart: bool) {
        self.largest[0] = self.largest[0].max(force);
        self.largest[1] = self.largest[1].max(force.abs());
        self.parted |= apart;
    }

    fn end_of_step(&mut self, x: f64) {
        let x = x - self.datum;
        self.steps += 1;
        self.sum += x;
        self.squares += x * x;
        let count = self.mesh.waves.len() as u64;
        for (sum, half_order) in self.waves.iter_mut().zip(self.half_orders) {
            let (cosine, sine) = self.mesh.waves[(half_order * self.steps % count) as usize];
            sum.0 += x * cosine;
            sum.1 += x * sine;
        }
    }

    fn motion(self, orbit: Orbit) -> Motion {
        let steps = self.steps.max(1) as f64;
        let mean = self.sum / steps;
        // What repeats after an odd number of true periods has nothing that comes an odd number of times in two of them.
        let odd = orbit.repeats.is_some_and(|repeats| repeats % 2 == 1);
        let waves = self.half_orders.iter().zip(&self.waves);
        let amplitude = |(half_order, (cosine, sine)): (&u64, &(f64, f64))| {
            if odd && half_order % 2 == 1 {
                0.0
            } else {
                2.0 * cosine.hypot(*sine) / steps
            }
        };
        Motion {
            rms: (self.squares / steps - mean * mean).max(0.0).sqrt(),
            peak_to_peak: (self.most - self.least).max(0.0),
            load_factor: self.largest[0] / self.mesh.data.load,
            largest_force: self.largest[1],
            contact_lost: self.parted,
            repeats: orbit.repeats,
            runs_away: orbit.runs_away,
            orders: waves.map(amplitude).collect(),
        }
    }
}
