//! A mesh that is ready to be run through at any speed, and the motion in it.

use std::borrow::Cow;
use std::f64::consts::PI;

use super::bodies::{Body, Coupled, Damping};
use super::coupled::{CoupledMotion, Drift};
use super::law::Laws;
use super::orbit::{Orbit, Repeating, Scale};
use super::order::{Lines, Order};
use super::oscillator::{Oscillator, Step};
use super::table::ForceTable;

/// Steps in a mesh period, at least.
pub(super) const STEPS_A_PERIOD: usize = 128;

/// Pieces of the law of force of a flank, at least.
const PIECES: usize = 44;

/// Looks in a period of free motion, about.
const LOOKS: f64 = 20.0;

/// Looks in a step, at most: below the speeds that would need more, the motion is that of the static deflection.
const MOST_LOOKS: f64 = 64.0;

/// The part of the least compliance of a mesh that the modes of both bodies may yield: the rest is that of teeth and contact.
const MOST_YIELD: f64 = 0.9;

/// The part of the motion from which on an order is in the results.
pub(super) const CARRIES: f64 = 0.02;

/// True periods in which the orders of a motion that was not found to repeat are sought.
const PERIODS_WITHOUT_END: u32 = 2;

/// Parameters of a run-up.
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
    /// The driving and the driven gear: without any modes, shafts and supports they are m_e.
    pub bodies: [Body; 2],
    /// ζ.
    pub damping_ratio: f64,
    /// ζ of the modes of the bodies, and of the bodies on their shafts and supports.
    pub body_damping_ratio: f64,
    /// The mean mesh stiffness under F_0 in N/m.
    pub stiffness: f64,
    /// Orders per mesh period that are in the results whatever their amplitude.
    pub orders: Vec<f64>,
    /// The number of orders in the results, at most: of more, those that carry least of the motion are left out.
    pub most_orders: usize,
    /// Directions: run-up, and run-down.
    pub sweeps: [bool; 2],
}

impl RunUpData {
    /// √(k/m_e) in rad/s.
    pub(super) fn natural(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    pub(super) fn damping(&self) -> f64 {
        2.0 * self.damping_ratio * (self.stiffness * self.mass).sqrt()
    }

    /// The amplitude over that of the static curve of one mass at the circular frequency `omega`, with the mean stiffness at every position and flanks that
    /// do not part.
    pub(super) fn gain(&self, omega: f64) -> f64 {
        let ratio = omega / self.natural();
        let damping = 2.0 * self.damping_ratio * ratio;
        1.0 / (1.0 - ratio * ratio).hypot(damping)
    }

    /// The orders in the results whatever their amplitude, of a mesh that repeats after `period` mesh periods.
    pub(super) fn known(&self, period: u32) -> impl Iterator<Item = Order> {
        let times = move |order: &f64| (order * f64::from(period)).round() as u32;
        let known = self.orders.iter().map(times).filter(|times| *times > 0);
        known.map(|times| Order::new(times, 1))
    }

    /// The bodies on their mesh, where they have modes, shafts or supports: with as many of the lowest modes as yield less than the mesh does, whose least
    /// compliance is `least`.
    ///
    /// The mean stiffness of the mesh has the modes in it, that of the teeth has not.
    pub(super) fn coupled(&self, least: f64) -> Option<Coupled> {
        let mut bodies = self.bodies.clone();
        loop {
            if bodies.iter().all(Body::is_one_mass) {
                return None;
            }
            let yields: f64 = bodies.iter().map(Body::compliance).sum();
            if yields < MOST_YIELD * least {
                let damping = Damping {
                    mesh: self.damping(),
                    bodies: self.body_damping_ratio,
                };
                let teeth = 1.0 / (1.0 / self.stiffness - yields);
                return Coupled::new(&bodies, teeth, damping);
            }
            let highest = bodies.iter().map(Body::highest).fold(0.0, f64::max);
            for body in &mut bodies {
                body.keep_below(highest);
            }
        }
    }

    /// Steps of a mesh period at `speed`, at least `per_period`, for motions of the circular frequency `natural`.
    pub(super) fn looks(&self, speed: f64, per_period: f64, natural: f64) -> f64 {
        let step = 1.0 / (speed * f64::from(self.tooth_count) * per_period);
        (LOOKS * step * natural / (2.0 * PI))
            .ceil()
            .clamp(1.0, MOST_LOOKS)
    }
}

/// A force table at the steps of a run-up.
#[derive(Debug, Clone)]
pub(super) struct Mesh<'a> {
    pub(super) data: &'a RunUpData,
    /// One of each step, or one for all of them.
    laws: Cow<'a, Laws>,
    /// Mesh periods after which it repeats.
    pub(super) period: u32,
    /// Steps in a mesh period.
    per_period: f64,
    /// δ_s under F_0 at the ends of steps.
    deflection: Vec<f64>,
    /// The mean stiffness of the laws under F_0 in N/m.
    stiffness: f64,
    /// The bodies, where they have modes, shafts or supports. The laws are those of the teeth alone then.
    coupled: Option<Cow<'a, Coupled>>,
}

impl<'a> Mesh<'a> {
    pub(super) fn new(data: &'a RunUpData, table: &ForceTable) -> Self {
        let coupled = data.coupled(table.least_compliance());
        let yields = match &coupled {
            Some(coupled) => 1.0 / data.stiffness - 1.0 / coupled.stiffness,
            None => 0.0,
        };
        let computed = table.positions() / table.period() as usize;
        // Rows between those that were computed rise, but may do so by less than the bodies yield: the teeth are refined alone.
        let table = table.stiffer_by(yields).refined(
            STEPS_A_PERIOD.div_ceil(computed),
            PIECES.div_ceil(table.loads().len() - 1),
        );
        let of_teeth = table.transmission_error(data.load);
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
            let rest = middle(&of_teeth);
            let other = table.other().delta.iter().rev();
            let rows = other.chain(&table.loaded().delta);
            knots.extend(rows.map(|row| middle(row) - rest));
        }
        let yielded = yields * data.load;
        let deflection = of_teeth.iter().map(|delta| delta + yielded).collect();
        Self {
            data,
            laws: Cow::Owned(Laws::new(forces, knots, loads.len())),
            period: table.period(),
            per_period: count as f64 / f64::from(table.period()),
            deflection,
            stiffness: coupled
                .as_ref()
                .map_or(data.stiffness, |coupled| coupled.stiffness),
            coupled: coupled.map(Cow::Owned),
        }
    }

    /// The same with one stiffness at every position, the mean one under F_0, and the static curve as it is.
    pub(super) fn of_mean_stiffness(&self) -> Mesh<'_> {
        Mesh {
            laws: Cow::Owned(self.laws.mean(self.stiffness)),
            ..self.clone_borrowed()
        }
    }

    /// The same with its stiffness as it is, and without the line of `order` in the static curve.
    pub(super) fn without(&self, order: Order) -> Mesh<'_> {
        let count = self.deflection.len() as f64;
        let wave = |i: usize| {
            let (sin, cos) = (2.0 * PI * order.per_true_period() * i as f64 / count).sin_cos();
            [cos, sin]
        };
        let mut line = [0.0; 2];
        for (i, delta) in self.deflection.iter().enumerate() {
            for (sum, wave) in line.iter_mut().zip(wave(i)) {
                *sum += 2.0 / count * delta * wave;
            }
        }
        let [cosine, sine] = line;
        let rest = |(i, delta): (usize, &f64)| {
            let [cos, sin] = wave(i);
            delta - cosine * cos - sine * sin
        };
        Mesh {
            deflection: self.deflection.iter().enumerate().map(rest).collect(),
            ..self.clone_borrowed()
        }
    }

    /// The same with the laws of this one.
    fn clone_borrowed(&self) -> Mesh<'_> {
        Mesh {
            data: self.data,
            laws: Cow::Borrowed(&self.laws),
            period: self.period,
            per_period: self.per_period,
            deflection: self.deflection.clone(),
            stiffness: self.stiffness,
            coupled: self.coupled.as_deref().map(Cow::Borrowed),
        }
    }

    /// The amplitudes of the stiffness under F_0 over its mean.
    pub(super) fn stiffness_lines(&self) -> Lines {
        let stiffness = |step: usize| self.laws.stiffness(step, 0.0) / self.stiffness;
        let samples: Vec<f64> = (0..self.deflection.len()).map(stiffness).collect();
        Lines::of(&samples, 1)
    }

    /// The bodies, where they have modes, shafts or supports.
    pub(super) fn coupled(&self) -> Option<&Coupled> {
        self.coupled.as_deref()
    }

    /// The least damping ratio of resonances that are sought: that of the mesh, or of modes of the bodies other than in torsion where it is less.
    pub(super) fn least_damping(&self) -> f64 {
        let has_waves = self.coupled().is_some_and(Coupled::depends_on_speed);
        let of_bodies = has_waves.then_some(self.data.body_damping_ratio);
        of_bodies.map_or(self.data.damping_ratio, |ratio| {
            ratio.min(self.data.damping_ratio)
        })
    }

    /// The natural frequencies in Hz, rising.
    pub(super) fn natural_frequencies(&self) -> Vec<f64> {
        match &self.coupled {
            Some(coupled) => coupled.natural_frequencies(),
            None => vec![self.data.natural() / (2.0 * PI)],
        }
    }

    /// Frequencies in Hz that the mesh excites, of bodies at rest.
    pub(super) fn excited_frequencies(&self) -> Vec<f64> {
        match &self.coupled {
            Some(coupled) => coupled.excited_frequencies(),
            None => self.natural_frequencies(),
        }
    }

    /// The frequency of `order` in Hz at `speed`.
    pub(super) fn frequency(&self, order: Order, speed: f64) -> f64 {
        let turns = speed * f64::from(self.data.tooth_count) / f64::from(self.period);
        order.per_true_period() * turns
    }

    /// δ_s' at `speed`, step by step.
    fn drifts(&self, duration: f64) -> Vec<f64> {
        let count = self.deflection.len();
        (0..count)
            .map(|i| (self.deflection[(i + 1) % count] - self.deflection[i]) / duration)
            .collect()
    }

    /// The oscillator at `speed`.
    fn moving(&self, speed: f64) -> Box<dyn Repeating + '_> {
        match &self.coupled {
            Some(coupled) => Box::new(self.coupled_motion(coupled, speed)),
            None => Box::new(self.oscillator(speed)),
        }
    }

    /// The duration of a step at `speed`.
    fn step(&self, speed: f64) -> f64 {
        1.0 / (speed * f64::from(self.data.tooth_count) * self.per_period)
    }

    fn coupled_motion<'b>(&'b self, coupled: &'b Coupled, speed: f64) -> CoupledMotion<'b> {
        let count = self.deflection.len();
        let mean = self.deflection.iter().sum::<f64>() / count as f64;
        let drift = |i: usize| Drift {
            law: i % self.laws.count(),
            deflection: [i, (i + 1) % count].map(|i| self.deflection[i] - mean),
        };
        let looks = self.data.looks(speed, self.per_period, coupled.at_teeth());
        CoupledMotion::new(
            (&self.laws, self.data.load),
            (coupled, 2.0 * PI * speed),
            (self.step(speed), looks as u32),
            (0..count).map(drift).collect(),
        )
    }

    fn oscillator(&self, speed: f64) -> Oscillator<'_> {
        let data = self.data;
        let duration = self.step(speed);
        let damping = data.damping();
        let drifts = self.drifts(duration);
        let count = drifts.len();
        let steps = (0..count)
            .map(|i| Step {
                law: i % self.laws.count(),
                force: data.load - damping * drifts[i],
                kick: drifts[(i + count - 1) % count] - drifts[i],
            })
            .collect();
        Oscillator {
            laws: &self.laws,
            mass: data.mass,
            damping,
            duration,
            looks: data.looks(speed, self.per_period, data.natural()) as u32,
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

    /// The motion at `speed` to which one settles that was that of `from` before; at speed 0 the static curve.
    pub(super) fn settled(&self, speed: f64, from: &Orbit) -> Motion {
        if speed == 0.0 {
            return self.standing();
        }
        let scale = self.scale();
        let moving = self.moving(speed);
        let orbit = moving.settled(from, scale);
        let mut watched = Watched::new(self, &orbit);
        let mut state = orbit.state.clone();
        let mut left = false;
        let count = self.deflection.len();
        for _ in 0..orbit.periods {
            moving.over_period(&mut state, None, &mut |seen| {
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

    /// The static curve.
    pub(super) fn standing(&self) -> Motion {
        let mut watched = Watched::new(self, &Orbit::REST);
        for &x in &self.deflection {
            watched.take(x);
            watched.end_of_step(x);
        }
        watched.force(self.data.load, false);
        watched.motion(Orbit::REST)
    }
}

/// The motion at one speed.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub(super) orbit: Orbit,
    /// Root mean square of x, its mean removed, in m.
    pub(super) rms: f64,
    /// Largest less smallest x in m.
    pub(super) peak_to_peak: f64,
    /// The largest force of the loaded flank over F_0.
    pub(super) load_factor: f64,
    /// The largest force on either flank in N.
    pub(super) largest_force: f64,
    /// True where the loaded flanks separate.
    pub(super) contact_lost: bool,
    /// The amplitudes of x in m.
    pub(super) lines: Lines,
}

impl Motion {
    /// The orders that carry a part of the motion, with this part: the amplitude over that of a single order with the same root mean square.
    pub(super) fn carriers(&self) -> impl Iterator<Item = (Order, f64)> {
        let whole = 2.0_f64.sqrt() * self.rms;
        let all = self.lines.all().filter(move |_| whole > LEAST_MOTION);
        all.map(move |(order, amplitude)| (order, amplitude / whole))
            .filter(|(_, part)| *part > CARRIES)
    }
}

/// A motion below this is rounding, in m.
const LEAST_MOTION: f64 = 1e-14;

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
    steps: usize,
    /// True periods in which orders are sought.
    periods: u32,
    /// The sums of x at the ends of the steps in so many true periods.
    folded: Vec<f64>,
}

impl<'a> Watched<'a> {
    fn new(mesh: &'a Mesh<'a>, orbit: &Orbit) -> Self {
        let periods = orbit.repeats.unwrap_or(PERIODS_WITHOUT_END);
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
            periods,
            folded: vec![0.0; periods as usize * mesh.deflection.len()],
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
        self.sum += x;
        self.squares += x * x;
        let count = self.folded.len();
        self.folded[self.steps % count] += x;
        self.steps += 1;
    }

    fn motion(mut self, orbit: Orbit) -> Motion {
        let steps = self.steps.max(1) as f64;
        let mean = self.sum / steps;
        let count = self.folded.len();
        for (i, sum) in self.folded.iter_mut().enumerate() {
            // A motion that ran away was not seen everywhere.
            let seen = (self.steps + count - 1 - i) / count;
            *sum = if seen > 0 { *sum / seen as f64 } else { mean };
        }
        Motion {
            orbit,
            rms: (self.squares / steps - mean * mean).max(0.0).sqrt(),
            peak_to_peak: (self.most - self.least).max(0.0),
            load_factor: self.largest[0] / self.mesh.data.load,
            largest_force: self.largest[1],
            contact_lost: self.parted,
            lines: Lines::of(&self.folded, self.periods),
        }
    }
}
