//! Resonances: the meeting of an order of the motion with a natural frequency, its amplitude there, and its cause.

use std::collections::HashMap;
use std::f64::consts::SQRT_2;

use rayon::prelude::*;

use super::mesh::{CARRIES, Mesh, Motion};
use super::natural::Naturals;
use super::orbit::Orbit;
use super::order::Order;
use crate::run::{Run, Stopped};

/// Speeds that are looked at for an order, about.
pub(super) const LOOKED_AT: f64 = 8.0;

/// The orders whose resonances are sought, those with the largest amplitudes expected: so many that their true periods have this many mesh periods together,
/// within these bounds.
pub(super) const MOST_SOUGHT: (u32, [u32; 2]) = (2000, [8, 160]);

/// The largest lines of the static curve that are expected to resonate.
const MOST_LINES: usize = 400;

/// The largest lines that make the rest of the motion that is expected.
const MOST_BESIDE: usize = 64;

/// The part of the motion that an order has to be expected to carry to be sought: some of them come to more.
const EXPECTED: f64 = 0.5 * CARRIES;

/// Steps of the search for the largest amplitude near a meeting.
const MOST_STEPS: u32 = 6;

/// The first step over the speed, in least damping ratios and within these bounds.
const FIRST_STEP: (f64, [f64; 2]) = (0.5, [1e-3, 0.02]);

/// How far from the meeting, over its speed, the largest amplitude may stand: above it, below it, and below it where flanks part and the mesh is softer.
const NEAR: [f64; 3] = [0.1, 0.1, 0.5];

/// The precision of the speed of the largest amplitude over the first step.
const PRECISE: f64 = 0.05;

/// Resonances of one order nearer to each other than this, over their speed, are one.
const SAME: f64 = 0.01;

/// A resonance of an order of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// The order.
    pub order: Order,
    /// The speed of the driving gear in revolutions per second at which its amplitude is largest.
    pub speed: f64,
    /// Its frequency there in Hz.
    pub frequency: f64,
    /// The amplitude of x at this order in m, on the branch where it is larger.
    pub amplitude: f64,
    /// Cause.
    pub excited: Excitation,
}

/// The cause of a resonance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Excitation {
    /// Its own order in the static curve: without this line, more of it vanishes than with the mean stiffness at every position.
    Forced,
    /// The varying stiffness: with the mean one at every position and the same static curve, more of it vanishes than without its own line.
    Parametric,
}

/// The motions at all speeds, run through one way.
pub(super) struct Pass {
    pub(super) down: bool,
    /// By rising speed.
    pub(super) motions: Vec<Motion>,
}

/// A speed at which an order meets a natural frequency.
#[derive(Debug, Clone, Copy)]
struct Meeting {
    order: Order,
    /// The place of the natural frequency among those that are excited.
    natural: usize,
    speed: f64,
    /// The amplitude expected there.
    expected: f64,
}

/// The resonances of `mesh` within the speeds that were `passed`, the largest amplitude first.
///
/// # Errors
///
/// [`Stopped`] if `run` was told to stop.
pub(super) fn search(
    mesh: &Mesh<'_>,
    passes: &[Option<Pass>; 2],
    run: &Run,
) -> Result<Vec<Resonance>, Stopped> {
    let mean = mesh.of_mean_stiffness();
    let found: Result<Vec<Option<Resonance>>, Stopped> = meetings(mesh, passes)
        .par_iter()
        .map(|meeting| {
            run.check()?;
            Ok(resonance(mesh, &mean, passes, meeting))
        })
        .collect();
    let mut found: Vec<Resonance> = found?.into_iter().flatten().collect();
    found.sort_by(|a, b| {
        let larger = b.amplitude.total_cmp(&a.amplitude);
        larger.then(a.speed.total_cmp(&b.speed))
    });
    // Two natural frequencies close to each other have one largest amplitude.
    let mut apart: Vec<Resonance> = Vec::new();
    for one in found {
        let is_same = |other: &Resonance| {
            other.order == one.order && (other.speed / one.speed - 1.0).abs() < SAME
        };
        if !apart.iter().any(is_same) {
            apart.push(one);
        }
    }
    Ok(apart)
}

/// The meetings at which an order may be a part of the motion. Four kinds of orders are looked at: those that are known; half of those at which the
/// stiffness varies enough for parametric resonance; lines of the static curve that a linear mesh would amplify so far; and those found at a speed beside
/// the meeting.
fn meetings(mesh: &Mesh<'_>, passes: &[Option<Pass>; 2]) -> Vec<Meeting> {
    let data = mesh.data;
    let speeds = &data.speeds;
    let statics = mesh.standing().lines;
    let naturals = Naturals::of(mesh);
    let mut found: HashMap<(Order, usize), Meeting> = HashMap::new();
    let mut add = |natural: usize, order: Order, speed: f64, expected: f64| {
        let meeting = Meeting {
            order,
            natural,
            speed,
            expected,
        };
        found.entry((order, natural)).or_insert(meeting);
    };
    let mut lines: Vec<(Order, f64)> = statics.all().collect();
    lines.sort_by(|a, b| b.1.total_cmp(&a.1));
    lines.truncate(MOST_LINES);
    let parametric = mesh.stiffness_lines();
    for natural in 0..naturals.count() {
        let meets = |order: Order| naturals.meets(natural, order);
        let resonant =
            |order: Order, speed: f64| naturals.gain(mesh.frequency(order, speed), speed);
        for order in data.known(mesh.period) {
            if let Some(speed) = meets(order) {
                add(
                    natural,
                    order,
                    speed,
                    resonant(order, speed) * statics.at(order),
                );
            }
        }
        // Mathieu's equation is unstable at twice the natural frequency from 4 ζ on.
        let parametric = parametric
            .all()
            .filter(|(_, part)| *part > 2.0 * data.damping_ratio);
        for (order, _) in parametric {
            if let Some(speed) = meets(order.half()) {
                add(natural, order.half(), speed, f64::INFINITY);
            }
        }
        for &(order, amplitude) in &lines {
            let Some(speed) = meets(order) else {
                continue;
            };
            let response = |&(other, amplitude): &(Order, f64)| {
                (amplitude * naturals.gain(mesh.frequency(other, speed), speed)).powi(2)
            };
            let all: f64 = lines.iter().take(MOST_BESIDE).map(response).sum();
            let expected = resonant(order, speed) * amplitude;
            if expected > EXPECTED * all.sqrt() {
                add(natural, order, speed, expected);
            }
        }
        for pass in passes.iter().flatten() {
            for (i, motion) in pass.motions.iter().enumerate() {
                let low = speeds[i.saturating_sub(1)];
                let high = speeds[(i + 1).min(speeds.len() - 1)];
                let whole = SQRT_2 * motion.rms;
                for (order, part) in motion.carriers() {
                    if let Some(speed) = meets(order)
                        && (low..=high).contains(&speed)
                    {
                        add(natural, order, speed, part * whole);
                    }
                }
            }
        }
    }
    let mut found: Vec<Meeting> = found.into_values().collect();
    found.sort_by(|a, b| {
        let larger = b.expected.total_cmp(&a.expected);
        larger.then(a.speed.total_cmp(&b.speed))
    });
    let (periods, [least, most]) = MOST_SOUGHT;
    found.truncate((periods / mesh.period).clamp(least, most) as usize);
    found
}

/// The resonance at `meeting`, if the order carries a part of the motion there.
fn resonance(
    mesh: &Mesh<'_>,
    mean: &Mesh<'_>,
    passes: &[Option<Pass>; 2],
    meeting: &Meeting,
) -> Option<Resonance> {
    let mut largest: Option<Look> = None;
    for pass in passes.iter().flatten() {
        let mut trail = Trail::of(mesh, pass, meeting);
        // Where flanks do not part there is one motion, whichever way speeds are run through.
        let is_alike = largest.as_ref().is_some_and(|seen| {
            let here = trail.at(seen.speed);
            !here.parts && (here.amplitude / seen.amplitude - 1.0).abs() < 1e-6
        });
        if is_alike {
            continue;
        }
        let Some(found) = trail.largest() else {
            continue;
        };
        if largest
            .as_ref()
            .is_none_or(|seen| found.amplitude > seen.amplitude)
        {
            largest = Some(found);
        }
    }
    let Look {
        speed,
        amplitude,
        orbit,
        ..
    } = largest.filter(|seen| seen.carries)?;
    let order = meeting.order;
    let with = |mesh: &Mesh<'_>| mesh.settled(speed, &orbit).lines.at(order);
    // A broken order has no line to leave out.
    let without = if order.is_whole() {
        with(&mesh.without(order))
    } else {
        amplitude
    };
    let excited = if with(mean) < without {
        Excitation::Parametric
    } else {
        Excitation::Forced
    };
    Some(Resonance {
        order,
        speed,
        frequency: mesh.frequency(order, speed),
        amplitude,
        excited,
    })
}

/// An order at one speed of a pass.
#[derive(Debug, Clone)]
struct Look {
    speed: f64,
    amplitude: f64,
    /// True if it carries a part of the motion.
    carries: bool,
    /// True if the flanks separate.
    parts: bool,
    orbit: Orbit,
}

/// A pass, with the speeds at which it was looked at for an order besides.
struct Trail<'a> {
    mesh: &'a Mesh<'a>,
    pass: &'a Pass,
    meeting: &'a Meeting,
    /// Speeds at which motions are known, rising, with these.
    known: Vec<(f64, Orbit)>,
}

impl<'a> Trail<'a> {
    fn of(mesh: &'a Mesh<'a>, pass: &'a Pass, meeting: &'a Meeting) -> Self {
        let orbits = pass.motions.iter().map(|motion| motion.orbit.clone());
        Self {
            mesh,
            pass,
            meeting,
            known: mesh.data.speeds.iter().copied().zip(orbits).collect(),
        }
    }

    fn look(&self, speed: f64, motion: &Motion) -> Look {
        let amplitude = motion.lines.at(self.meeting.order);
        Look {
            speed,
            amplitude,
            carries: amplitude > CARRIES * SQRT_2 * motion.rms,
            parts: motion.contact_lost,
            orbit: motion.orbit.clone(),
        }
    }

    /// The motion at `speed`, going on from the one at the last speed before it.
    fn at(&mut self, speed: f64) -> Look {
        let place = self.known.partition_point(|(known, _)| *known <= speed);
        let before = if self.pass.down && self.known[place - 1].0 < speed {
            place.min(self.known.len() - 1)
        } else {
            place - 1
        };
        let motion = self.mesh.settled(speed, &self.known[before].1);
        let look = self.look(speed, &motion);
        self.known.insert(place, (speed, motion.orbit));
        look
    }

    /// The speeds among which the largest amplitude is sought, where flanks `part` or not.
    fn bounds(&self, part: bool) -> [f64; 2] {
        let [above, below, apart] = NEAR;
        let low = if part { apart } else { below };
        let speeds = &self.mesh.data.speeds;
        let (first, last) = (speeds[0], speeds[speeds.len() - 1]);
        let speed = self.meeting.speed;
        [
            (speed * (1.0 - low)).max(first),
            (speed * (1.0 + above)).min(last),
        ]
    }

    /// The amplitude at the speed asked for to which the amplitudes rise from the meeting.
    fn risen(&self) -> Option<Look> {
        let speeds = &self.mesh.data.speeds;
        let look = |i: usize| {
            let look = self.look(speeds[i], &self.pass.motions[i]);
            let [low, high] = self.bounds(look.parts);
            (low..=high).contains(&look.speed).then_some(look)
        };
        let beyond = speeds.partition_point(|speed| *speed <= self.meeting.speed);
        let beside = [
            beyond.checked_sub(1),
            (beyond < speeds.len()).then_some(beyond),
        ];
        let begins = beside
            .into_iter()
            .flatten()
            .filter_map(|i| Some((i, look(i)?)));
        let (mut place, mut here) =
            begins.max_by(|a, b| a.1.amplitude.total_cmp(&b.1.amplitude))?;
        loop {
            let beside = [
                place.checked_sub(1),
                (place + 1 < speeds.len()).then_some(place + 1),
            ];
            let next = beside
                .into_iter()
                .flatten()
                .filter_map(|i| Some((i, look(i)?)));
            let next = next.filter(|(_, next)| next.amplitude > here.amplitude);
            match next.max_by(|a, b| a.1.amplitude.total_cmp(&b.1.amplitude)) {
                Some(higher) => (place, here) = higher,
                None => return Some(here),
            }
        }
    }

    /// The largest amplitude near the meeting; nothing if the order carries no part of the motion at it and at the speeds beside it.
    ///
    /// Near a resonance 1/A² is a parabola of the speed. Where the motion jumps the amplitude is the largest that was seen.
    fn largest(&mut self) -> Option<Look> {
        let met = self.at(self.meeting.speed);
        let carries = met.carries;
        let begin = self.risen().filter(|risen| risen.amplitude > met.amplitude);
        let mut best = begin.unwrap_or(met);
        if !(carries || best.carries) {
            return None;
        }
        let (in_damping, [least, most]) = FIRST_STEP;
        let step = (in_damping * self.mesh.least_damping()).clamp(least, most) * best.speed;
        let mut seen = vec![best.clone()];
        let mut wanted = vec![best.speed - step, best.speed + step];
        for _ in 0..MOST_STEPS {
            let [low, high] = self.bounds(best.parts);
            let Some(speed) = wanted.pop() else { break };
            let speed = speed.clamp(low, high);
            if seen
                .iter()
                .any(|known| (known.speed - speed).abs() < PRECISE * step)
            {
                if wanted.is_empty() {
                    break;
                }
                continue;
            }
            let look = self.at(speed);
            if look.amplitude > best.amplitude {
                best = look.clone();
            }
            let place = seen.partition_point(|known| known.speed < speed);
            seen.insert(place, look);
            if wanted.is_empty() {
                wanted.extend(next(&seen, step));
            }
        }
        // A higher natural frequency with nothing of its own lies on the slope of another one.
        let [low, high] = self.bounds(best.parts);
        let is_slope = [low, high].contains(&best.speed) && !self.is_end(best.speed);
        (self.meeting.natural == 0 || !is_slope).then_some(best)
    }

    fn is_end(&self, speed: f64) -> bool {
        let speeds = &self.mesh.data.speeds;
        [speeds.first(), speeds.last()].contains(&Some(&speed))
    }
}

/// The speed at which to look next for the largest amplitude after those that were `seen`, by rising speed.
fn next(seen: &[Look], step: f64) -> Option<f64> {
    let places = 0..seen.len();
    let best = places.max_by(|&a, &b| seen[a].amplitude.total_cmp(&seen[b].amplitude))?;
    if best == 0 {
        return Some(seen[0].speed - step);
    }
    if best + 1 == seen.len() {
        return Some(seen[best].speed + step);
    }
    let [a, b, c] = [best - 1, best, best + 1].map(|i| (seen[i].speed, seen[i].amplitude.powi(-2)));
    // The vertex of the parabola through all three.
    let (left, right) = ((b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0));
    let curvature = (right - left) / (c.0 - a.0);
    let vertex = f64::midpoint(a.0, b.0) - left / (2.0 * curvature);
    let inside = (a.0 + 0.01 * (b.0 - a.0)..=c.0 - 0.01 * (c.0 - b.0)).contains(&vertex);
    inside.then_some(vertex)
}
