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
const PIECES: usize = 30;

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

/// What is told of one branch, speed by speed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Branch {
    /// Root mean square of x, its mean removed, in m.
    pub rms: Vec<f64>,
    /// Largest less smallest x in m.
    pub peak_to_peak: Vec<f64>,
    /// The largest F(θ, x) over F_0.
    pub load_factor: Vec<f64>,
    /// Whether the loaded flanks part.
    pub contact_lost: Vec<bool>,
    /// True periods after which the motion repeats; `None` where it was not found to.
    pub repeats: Vec<Option<u32>>,
    /// The amplitude of x at each order asked for, in m, order by order.
    pub orders: Vec<Vec<f64>>,
    /// Whether the motion grows without bound; it is told until it has run away.
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
}

/// Why an order resonates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResonanceKind {
    /// The order meets the natural frequency.
    Forced,
    /// It meets twice that, and its part of the stiffness pumps.
    Parametric,
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
        let looks = |speed: &f64| {
            let step = 1.0 / (speed * f64::from(self.tooth_count) * STEPS_A_PERIOD as f64);
            (LOOKS * step * self.natural() / (2.0 * PI)).clamp(1.0, MOST_LOOKS)
        };
        let all: f64 = self.speeds.iter().map(looks).sum();
        let sweeps = self.sweeps.iter().filter(|asked| **asked).count() as f64;
        SECONDS_A_LOOK * LOOKED_THROUGH * sweeps * steps * all
    }

    /// The speeds in range at which one of the orders resonates, rising.
    pub fn resonances(&self) -> Vec<Resonance> {
        let natural = self.natural() / (2.0 * PI);
        let range = self.speeds.first().zip(self.speeds.last());
        let Some((&first, &last)) = range else {
            return Vec::new();
        };
        let mut found: Vec<Resonance> = Vec::new();
        for (order, per_period) in self.orders.iter().enumerate() {
            for (kind, times) in [
                (ResonanceKind::Forced, 1.0),
                (ResonanceKind::Parametric, 2.0),
            ] {
                let speed = times * natural / (per_period * f64::from(self.tooth_count));
                if (first..=last).contains(&speed) {
                    found.push(Resonance { speed, order, kind });
                }
            }
        }
        found.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        found
    }

    /// The motion in the mesh of `table`.
    ///
    /// # Errors
    ///
    /// [`Stopped`] if `run` was told to stop.
    pub fn run_up(&self, table: &ForceTable, run: &Run) -> Result<RunUp, Stopped> {
        let mesh = Mesh::new(self, table);
        let branch = |down: bool| {
            let wanted = self.sweeps[usize::from(down)];
            wanted.then(|| mesh.branch(down, run)).transpose()
        };
        let (up, down) = rayon::join(|| branch(false), || branch(true));
        Ok(RunUp {
            natural_frequency: self.natural() / (2.0 * PI),
            up: up?,
            down: down?,
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
    /// Cosine and sine of each order at the end of each step.
    waves: Vec<Vec<(f64, f64)>>,
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
        let wave = |order: &f64| {
            (1..=count)
                .map(|i| {
                    let (sin, cos) = (2.0 * PI * order * i as f64 / per_period).sin_cos();
                    (cos, sin)
                })
                .collect()
        };
        Self {
            data,
            laws: Laws::new(forces, knots, loads.len()),
            per_period,
            deflection,
            waves: data.orders.iter().map(wave).collect(),
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

    /// The branch from the lowest speed up, or from the highest down, each motion going on from the last.
    fn branch(&self, down: bool, run: &Run) -> Result<Branch, Stopped> {
        let data = self.data;
        let count = data.speeds.len();
        let mut seen: Vec<Option<Motion>> = vec![None; count];
        let scale = self.scale();
        let mut orbit = Orbit::REST;
        let order = |k: usize| if down { count - 1 - k } else { k };
        for place in (0..count).map(order) {
            run.check()?;
            let speed = data.speeds[place];
            seen[place] = Some(if speed > 0.0 {
                let oscillator = self.oscillator(speed);
                orbit = oscillator.settled(orbit, scale);
                let motion = self.motion(&oscillator, orbit);
                if orbit.runs_away {
                    orbit = Orbit::REST;
                }
                motion
            } else {
                self.standing()
            });
        }
        let mut branch = Branch {
            orders: vec![Vec::with_capacity(count); data.orders.len()],
            ..Branch::default()
        };
        for motion in seen.into_iter().flatten() {
            branch.rms.push(motion.rms);
            branch.peak_to_peak.push(motion.peak_to_peak);
            branch.load_factor.push(motion.load_factor);
            branch.contact_lost.push(motion.contact_lost);
            branch.repeats.push(motion.repeats);
            branch.runs_away.push(motion.runs_away);
            for (list, amplitude) in branch.orders.iter_mut().zip(motion.orders) {
                list.push(amplitude);
            }
        }
        Ok(branch)
    }

    /// The static curve.
    fn standing(&self) -> Motion {
        let mut watched = Watched::new(self);
        for (i, &x) in self.deflection.iter().enumerate() {
            watched.take(x);
            let before = (i + self.deflection.len() - 1) % self.deflection.len();
            watched.end_of_step(before, x);
        }
        watched.motion(1.0, false, Orbit::REST)
    }

    /// What `orbit` is seen to do.
    fn motion(&self, oscillator: &Oscillator<'_>, orbit: Orbit) -> Motion {
        let mut watched = Watched::new(self);
        let mut state = orbit.state;
        let (mut most, mut parted, mut left) = (0.0_f64, false, false);
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
                most = most.max(seen.force);
                parted |= seen.apart;
                if seen.part == 1.0 {
                    watched.end_of_step(seen.step, x);
                }
            });
        }
        watched.motion(most / self.data.load, parted, orbit)
    }
}

/// What is told of the motion at one speed.
#[derive(Debug, Clone)]
struct Motion {
    rms: f64,
    peak_to_peak: f64,
    load_factor: f64,
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
    steps: f64,
    orders: Vec<(f64, f64)>,
}

impl<'a> Watched<'a> {
    fn new(mesh: &'a Mesh<'a>) -> Self {
        Self {
            mesh,
            datum: mesh.deflection[0],
            sum: 0.0,
            squares: 0.0,
            least: f64::INFINITY,
            most: f64::NEG_INFINITY,
            steps: 0.0,
            orders: vec![(0.0, 0.0); mesh.waves.len()],
        }
    }

    fn take(&mut self, x: f64) {
        let x = x - self.datum;
        self.least = self.least.min(x);
        self.most = self.most.max(x);
    }

    fn end_of_step(&mut self, step: usize, x: f64) {
        let x = x - self.datum;
        self.steps += 1.0;
        self.sum += x;
        self.squares += x * x;
        for (sum, wave) in self.orders.iter_mut().zip(&self.mesh.waves) {
            sum.0 += x * wave[step].0;
            sum.1 += x * wave[step].1;
        }
    }

    fn motion(self, load_factor: f64, contact_lost: bool, orbit: Orbit) -> Motion {
        let steps = self.steps.max(1.0);
        let mean = self.sum / steps;
        let amplitude = |(cosine, sine): (f64, f64)| 2.0 * cosine.hypot(sine) / steps;
        Motion {
            rms: (self.squares / steps - mean * mean).max(0.0).sqrt(),
            peak_to_peak: (self.most - self.least).max(0.0),
            load_factor,
            contact_lost,
            repeats: orbit.repeats,
            runs_away: orbit.runs_away,
            orders: self.orders.into_iter().map(amplitude).collect(),
        }
    }
}
