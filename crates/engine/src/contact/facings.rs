//! All pairs whose flanks face each other at one mesh position, and which of them come near.

use super::drawn::DrawnPair;
use super::model::{DeviatingPair, MeshPosition};
use super::patch::Extent;
use crate::gear::Member;
use crate::touch::gap_profile::{
    FirstContact, GapMinimum, GapProfile, MOST_TURNS, ROUNDING, RangeEnd, nearer_tip,
};
use crate::touch::placement::{self, Pose, Section};

/// Phases a mesh period, at the nearest of which pairs whose teeth deviate are placed as drawn.
const PHASES: f64 = 64.0;

/// Largest movement of contacts by an eccentricity, as a multiple of it: the common tangent of the base circles turns, and cot α_w is 4 at
/// the most.
const MOST_RUNOUT: f64 = 2.0;

/// If the eccentricities of both gears together exceed this part of a phase, the minimum of the gap is searched on the displaced flanks. The minimum of
/// the nearest drawn phase is wrong by the square of the distance from it, and by much more across a kink or beside a corner.
const DISPLACED: f64 = 0.25;

/// The pairs whose flanks face each other at one fraction of the mesh period; numbered from the reference pair of the
/// period. They are found outward from the path of contact, as far as is asked.
pub(super) struct PairsInReach<'a> {
    deviating: DeviatingPair<'a>,
    fraction: f64,
    /// True if nothing deviates.
    as_drawn: bool,
    /// How far the gears run out together, in phases.
    runout: f64,
    /// Every pair found, and the δ at which it touches as drawn.
    found: Vec<(i64, f64)>,
    frontier: [NextPair; 2],
    /// The mesh period asked about last, and the pairs known there.
    known: (i64, Vec<PairGap>),
}

/// The next pair on one side, and the touch of the last one found there.
struct NextPair {
    next: i64,
    step: i64,
    last: f64,
}

/// A pair that comes near.
#[derive(Debug, Clone)]
pub(super) struct PairGap {
    /// Number of the pair, counted from the reference pair of the mesh period.
    pub(super) pair: i64,
    /// The pair as drawn at its phase.
    pub(super) drawn: DrawnPair,
    /// How many mesh periods it is ahead of the drawn phase.
    ahead: f64,
    /// The distance from its first drawn minimum to that of the displaced flanks, towards the primary gear's tip; `None` if it was not searched.
    away: Option<f64>,
    /// The δ at which each of its minima touches.
    touches: Vec<f64>,
}

impl PairGap {
    /// The δ at which it touches first.
    pub(super) fn touch(&self) -> f64 {
        self.touches.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Its minima up to the last that touches before δ is `reach`.
    pub(super) fn minima_within(&self, reach: f64) -> usize {
        let last = self.touches.iter().rposition(|touch| *touch <= reach);
        1 + last.unwrap_or(0)
    }

    /// How far the deviations of its teeth move the contact under `load` in mesh period `period` of `deviating` ([`Extent`]).
    pub(super) fn moved(&self, deviating: DeviatingPair<'_>, (period, load): (i64, f64)) -> i32 {
        let pair = &deviating.model.pair;
        let Some(facing) = self.drawn.facing() else {
            return 0;
        };
        let minimum = &facing.minima[0];
        if let Some(away) = self.away {
            return Extent::moved(pair, minimum, load, (away, 0.0));
        }
        let (along, inclined) = self.displaced(deviating, period, facing);
        Extent::moved(pair, minimum, load, (along, inclined))
    }

    /// Where the flanks touch in mesh period `period` of `deviating`, as a distance along the drawn `facing` towards the primary gear's tip, and the inclination
    /// that the slopes of its teeth add for each length along it.
    fn displaced(
        &self,
        deviating: DeviatingPair<'_>,
        period: i64,
        facing: &GapProfile,
    ) -> (f64, f64) {
        let pair = &deviating.model.pair;
        let teeth = pair.teeth(period + self.pair);
        let minimum = &facing.minima[0];
        // Arc over roll length.
        let growth = |member: Member| {
            let r_b = pair.gear(member).base_radius();
            (minimum.roll_lengths[member.index()] / r_b).max(1e-9)
        };
        // Towards the tip of one is towards the root of the other.
        let inclination = |member: Member| {
            let slope = deviating
                .deviations
                .of_gear(member)
                .slope(teeth[member.index()], minimum.roll_lengths[member.index()]);
            slope / growth(member)
        };
        let (primary, secondary) = (facing.primary, facing.primary.other());
        let ahead = match primary {
            Member::Driving => self.ahead,
            Member::Driven => -self.ahead,
        };
        let along = ahead * pair.base_pitch() * growth(primary);
        (along, inclination(primary) - inclination(secondary))
    }

    /// True if the slopes of its teeth in mesh period `period` of `deviating` take the contact as far as the tip of the secondary gear.
    fn is_inclined_to_secondary_tip(&self, deviating: DeviatingPair<'_>, period: i64) -> bool {
        let Some(facing) = self.drawn.facing() else {
            return false;
        };
        let (along, inclined) = self.displaced(deviating, period, facing);
        let minimum = &facing.minima[0];
        let [s_1, s_2] = minimum.roll_lengths;
        // An angle moves the least place of a parabola by its radius.
        let arc = minimum.arc + along + inclined * s_1 * s_2 / (s_1 + s_2);
        inclined != 0.0 && arc < facing.range.from && facing.range.ends[0] == RangeEnd::SecondaryTip
    }

    /// Its pose at a mesh position of `deviating`, with a driven gear that lags by `lag`.
    pub(super) fn pose<'a>(
        &self,
        deviating: DeviatingPair<'a>,
        at: MeshPosition,
        lag: f64,
    ) -> Option<Pose<'a>> {
        let n = at.period + self.pair;
        let primary = self.drawn.facing()?.primary;
        Some(deviating.pose(at.eta(), n, lag, (primary, self.drawn.phase)))
    }
}

impl<'a> PairsInReach<'a> {
    /// The pairs on the path of contact and those beside it; `None` if no flanks face each other at all.
    pub(super) fn new(deviating: DeviatingPair<'a>, fraction: f64) -> Option<Self> {
        let gears = &deviating.model.pair;
        let (s_a, s_e) = gears.path_of_contact();
        // Pair n touches at the roll length of η − n periods.
        let periods = |s: f64| (s - gears.roll_length_of(0.0)) / gears.base_pitch();
        let first = (fraction - periods(s_e)).floor() as i64;
        let last = (fraction - periods(s_a)).ceil() as i64;
        let frontier = |next, step| NextPair {
            next,
            step,
            last: f64::NEG_INFINITY,
        };
        let runout: f64 = Member::BOTH
            .map(|member| deviating.deviations.of_gear(member).eccentricity())
            .iter()
            .sum();
        let mut facings = Self {
            deviating,
            fraction,
            as_drawn: deviating.deviations.are_none(),
            runout: runout / gears.base_pitch() * PHASES,
            found: Vec::new(),
            frontier: [frontier(first - 1, -1), frontier(last + 1, 1)],
            known: (0, Vec::new()),
        };
        for n in first..=last {
            facings.add(n);
        }
        let touch = |n: i64| {
            let found = facings.found.iter().find(|(pair, _)| *pair == n);
            found.map_or(f64::INFINITY, |found| found.1)
        };
        let ends = [touch(first), touch(last)];
        for (frontier, end) in facings.frontier.iter_mut().zip(ends) {
            frontier.last = end;
        }
        (!facings.found.is_empty()).then_some(facings)
    }

    /// Adds pair `n` as drawn; the δ at which it touches, without end where flanks do not face each other.
    fn add(&mut self, n: i64) -> f64 {
        let model = self.deviating.model;
        let drawn = model.drawn_pair(self.fraction - n as f64);
        let touch = drawn.facing().map_or(f64::INFINITY, GapProfile::touch);
        if touch < f64::INFINITY {
            self.found.push((n, touch));
        }
        touch
    }

    /// The mesh position in mesh period `period`.
    pub(super) fn at(&self, period: i64) -> MeshPosition {
        MeshPosition {
            fraction: self.fraction,
            period,
        }
    }

    /// True if nothing deviates.
    pub(super) fn are_as_drawn(&self) -> bool {
        self.as_drawn
    }

    /// How far deviations may bring flanks nearer.
    pub(super) fn nearer(&self) -> f64 {
        self.deviating.deviations.nearest()
    }

    /// The δ at which the first pair touches as drawn.
    pub(super) fn least(&self) -> f64 {
        let touches = self.found.iter().map(|found| found.1);
        touches.fold(f64::INFINITY, f64::min)
    }

    /// The δ at which the first pair touches in mesh period `period`: the transmission error under no load.
    pub(super) fn touch(&mut self, period: i64) -> f64 {
        let nearest = self.found.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let near = nearest.and_then(|(n, _)| self.near(*n, period));
        let bound = near.map_or(f64::INFINITY, |near| near.touch());
        // Others touch first only before that.
        let near = self.within(period, bound).into_iter();
        near.map(|near| near.touch()).fold(bound, f64::min)
    }

    /// The pairs that touch in mesh period `period` before δ is `reach`; at least the one that touches first.
    pub(super) fn within(&mut self, period: i64, reach: f64) -> Vec<PairGap> {
        let as_drawn = reach + self.nearer() + ROUNDING;
        self.find_within(as_drawn);
        if self.known.0 != period {
            self.known = (period, Vec::new());
        }
        for &(n, touch) in &self.found {
            if touch <= as_drawn && self.known.1.iter().all(|near| near.pair != n) {
                self.known.1.extend(self.near(n, period));
            }
        }
        let mut near: Vec<PairGap> = self.known.1.clone();
        near.sort_by(|a, b| a.touch().total_cmp(&b.touch()));
        let count = near.partition_point(|near| near.touch() <= reach);
        near.truncate(count.max(1));
        near
    }

    /// Pair `n` of mesh period `period`.
    fn near(&self, n: i64, period: i64) -> Option<PairGap> {
        let model = self.deviating.model;
        let phase = self.fraction - n as f64;
        if self.as_drawn {
            let drawn = model.drawn_pair(phase);
            let minima = &drawn.facing()?.minima;
            let touches = minima.iter().map(|minimum| minimum.touch).collect();
            return Some(PairGap {
                pair: n,
                ahead: 0.0,
                away: None,
                touches,
                drawn,
            });
        }
        let shifts = Shifts::of(self.deviating, phase, period + n);
        // Along a curve a tooth keeps its own deviation, and so its drawn phase. With a large eccentricity the phase is another at every position.
        let (primary, shift, drawn) = if MOST_RUNOUT * self.runout > 1.0 {
            let primary = shifts.nearer_tip;
            let shift = shifts.on_flanks[primary.index()];
            (primary, shift, shift)
        } else {
            let drawn = (shifts.by_tooth * PHASES).round() / PHASES;
            let primary = nearer_tip(&model.pair, phase + drawn);
            (primary, shifts.on_flanks[0], drawn)
        };
        let mut near = PairGap {
            pair: n,
            ahead: shift - drawn,
            away: None,
            touches: Vec::new(),
            drawn: model.drawn_pair_on(phase + drawn, primary),
        };
        self.find_touches(&mut near, period)?;
        if self.runout > DISPLACED || near.is_inclined_to_secondary_tip(self.deviating, period) {
            self.find_on_displaced(&mut near, period);
        }
        Some(near)
    }

    /// Finds when the minima of `near` touch in mesh period `period`.
    fn find_touches(&self, near: &mut PairGap, period: i64) -> Option<()> {
        let at = |lag: f64| near.pose(self.deviating, self.at(period), lag);
        let as_drawn = at(0.0)?;
        let further = |pose: &Pose<'_>, minimum: &GapMinimum| {
            let met = pose.gap_and_arms_of(&minimum.flank_point);
            met.gap / met.arms[1]
        };
        let touch = |minimum: &GapMinimum| {
            // A corner pushes in another direction than it moves: the step to its touch is a few percent too long or too short.
            let mut lag = further(&as_drawn, minimum);
            for _ in 0..MOST_TURNS {
                let step = at(lag).map_or(0.0, |pose| further(&pose, minimum));
                lag += step;
                if step.abs() < ROUNDING {
                    break;
                }
            }
            lag
        };
        near.touches = near.drawn.facing()?.minima.iter().map(touch).collect();
        Some(())
    }

    /// Finds where and when the displaced flanks of `near` touch first in mesh period `period`.
    fn find_on_displaced(&self, near: &mut PairGap, period: i64) -> Option<()> {
        let mut real = self.real(near, period)?;
        if real.facing.is_at_secondary_tip() {
            // On its own flank a gear's tip is where cells end, however the gears stand.
            let model = self.deviating.model;
            let primary = near.drawn.primary.other();
            let mut on_other = PairGap {
                drawn: model.drawn_pair_on(near.drawn.phase, primary),
                ..near.clone()
            };
            if self.find_touches(&mut on_other, period).is_some()
                && let Some(found) = self.real(&on_other, period)
            {
                *near = on_other;
                real = found;
            }
        }
        let first = &real.facing.minima[0];
        let away = |minimum: &GapMinimum| first.arc - minimum.arc;
        let minima = &near.drawn.facing()?.minima;
        let nearest = |a: &&GapMinimum, b: &&GapMinimum| away(a).abs().total_cmp(&away(b).abs());
        let (i, minimum) = minima
            .iter()
            .enumerate()
            .min_by(|a, b| nearest(&a.1, &b.1))?;
        near.touches[i] = real.delta();
        near.away = (i == 0).then(|| away(minimum));
        Some(())
    }

    /// The flanks of `near` where they touch first in mesh period `period`.
    fn real(&self, near: &PairGap, period: i64) -> Option<FirstContact<'a>> {
        let pair = (&self.deviating.model.pair, self.deviating.deviations);
        let section = Section::straight(self.at(period).eta(), period + near.pair);
        FirstContact::of(pair, section, near.drawn.primary, 0.0, ROUNDING)
    }

    /// Finds the pairs that touch as drawn before δ is `reach`.
    fn find_within(&mut self, reach: f64) {
        // Beyond the path of contact gaps grow from pair to pair.
        for side in 0..2 {
            while self.frontier[side].last <= reach {
                let NextPair { next, step, .. } = self.frontier[side];
                let last = self.add(next);
                self.frontier[side] = NextPair {
                    next: next + step,
                    step,
                    last,
                };
            }
        }
    }
}

/// How far deviations move the place where a pair touches, as a change of its phase in mesh periods.
struct Shifts {
    /// By the deviations of its teeth alone.
    by_tooth: f64,
    /// With the eccentricities too, by the place on the driving and by that on the driven flank. These differ, because the line of action is longer or
    /// shorter as the axes are farther apart or nearer.
    on_flanks: [f64; 2],
    /// The gear whose tip is nearer to the contact then.
    nearer_tip: Member,
}

impl Shifts {
    /// Facings of pair `n` from `phase` on: the driving flank touches where the common tangent of both base circles meets it.
    fn of(DeviatingPair { model, deviations }: DeviatingPair<'_>, phase: f64, n: i64) -> Self {
        let gears = &model.pair;
        let angles = placement::angles(gears, phase);
        let centers = placement::centers(gears, deviations, n, angles);
        let [driving, driven] = Member::BOTH.map(|member| gears.gear(member));
        let between = centers[1] - centers[0];
        let base = driving.base_radius() + driven.base_radius();
        let (apart, tooth) = (between.norm(), gears.tooth(Member::Driving, n));
        let tangent = between.y.atan2(between.x) - (base / apart).min(1.0).acos();
        let s_1 = driving.base_radius() * (angles[0] + driving.flank().base_half_angle() - tangent);
        let out = deviations.of_gear(Member::Driving).at(tooth, s_1);
        let as_drawn = gears.roll_length_of(phase);
        let line = (apart * apart - base * base).max(0.0).sqrt();
        let rolls = [s_1 + out, line - s_1 - out];
        let shift = |s: f64| (s - as_drawn) / gears.base_pitch();
        let to_tip = Member::BOTH
            .map(|member| gears.gear(member).tip_form_roll_length() - rolls[member.index()]);
        Self {
            by_tooth: shift(as_drawn + out),
            on_flanks: [shift(rolls[0]), shift(gears.line_of_action() - rolls[1])],
            nearer_tip: if to_tip[0] < to_tip[1] {
                Member::Driving
            } else {
                Member::Driven
            },
        }
    }
}
