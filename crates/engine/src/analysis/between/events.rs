//! Where pairs take up or leave the load between two positions.

use super::Sample;

/// Events nearer to each other, or to a position, than this part of the way between two positions are one.
const TOGETHER: f64 = 1e-3;

/// The part of the way between two positions over which an event is looked for from one of them alone.
const FARTHEST: f64 = 0.6;

/// Evidence of an event's place from the samples on both sides.
#[derive(Debug, Clone, Copy)]
pub(super) struct EventPlace {
    pub(super) at: f64,
    /// True if it was followed to there; otherwise it may be anywhere between its neighbors.
    pub(super) is_known: bool,
}

/// The places between the samples `at` and `at + 1` of `samples` at which a pair takes up or leaves the load, rising.
pub(super) fn events(samples: &[Sample], at: usize) -> Vec<EventPlace> {
    let (before, after) = (&samples[at], &samples[at + 1]);
    let (from, to) = (before.position, after.position);
    let pairs = before.pairs.iter().chain(&after.pairs);
    let mut changing: Vec<i64> = pairs
        .map(|state| state.pair)
        .filter(|&n| before.carries(n) != after.carries(n))
        .collect();
    changing.sort_unstable();
    changing.dedup();
    let margin = TOGETHER * (to - from);
    let within = |place: Option<f64>| EventPlace {
        at: place.map_or(f64::midpoint(from, to), |place| {
            place.clamp(from + margin, to - margin)
        }),
        is_known: place.is_some(),
    };
    let mut found: Vec<EventPlace> = changing
        .iter()
        .map(|&n| within(event(samples, at, n)))
        .collect();
    found.sort_by(|a, b| a.at.total_cmp(&b.at));
    found.dedup_by(|later, earlier| later.at - earlier.at < margin);
    if found.len() > 1 {
        // Each ends where the next one stands.
        found.iter_mut().for_each(|place| place.is_known = true);
    }
    // Pairs that take the whole load over from each other without a share in common touch together nowhere but at one place.
    if !before
        .pairs
        .iter()
        .any(|state| state.share > 0.0 && after.carries(state.pair))
        && changing
            .iter()
            .all(|&n| clearance_of(samples, at, n).is_none())
        && let Some(place) = crossing(samples, at)
    {
        return vec![within(Some(place))];
    }
    found
}

/// Where pair `n`, which carries at only one of the samples `at` and `at + 1`, takes up or leaves the load.
///
/// Its share falls to zero there from one side, and the clearance of its flanks from the other. Either is extrapolated from its last two samples; the nearer
/// they are, the more it counts. `None` if neither becomes zero between the samples.
fn event(samples: &[Sample], at: usize, n: i64) -> Option<f64> {
    let carries_after = samples[at + 1].carries(n);
    let (from, to) = (samples[at].position, samples[at + 1].position);
    let share = |sample: &Sample| {
        let state = sample.pair(n)?;
        (state.share > 0.0).then_some(state.share)
    };
    let clearance = |sample: &Sample| {
        let state = sample.pair(n)?;
        state.clearance.filter(|_| state.share <= 0.0)
    };
    let (by_before, by_after) = if carries_after {
        (
            zero(samples, at, false, clearance),
            zero(samples, at, true, share),
        )
    } else {
        (
            zero(samples, at, false, share),
            zero(samples, at, true, clearance),
        )
    };
    let width = to - from;
    match (by_before, by_after) {
        (Some(before), Some(after)) => {
            let weight = |way: f64| 1.0 / (way.powi(2) + (TOGETHER * width).powi(2));
            let (a, b) = (weight(before - from), weight(to - after));
            Some((a * before + b * after) / (a + b))
        }
        // From one side alone the other end of the way may just have been found to lie beyond it.
        (Some(before), None) => Some(before.min(from + FARTHEST * width)),
        (None, Some(after)) => Some(after.max(to - FARTHEST * width)),
        (None, None) => None,
    }
}

/// The clearance of pair `n` at the samples `at` and `at + 1`.
fn clearance_of(samples: &[Sample], at: usize, n: i64) -> Option<f64> {
    let of = |sample: &Sample| sample.pair(n)?.clearance;
    of(&samples[at]).or_else(|| of(&samples[at + 1]))
}

/// Where `value`, extrapolated from two samples on one side of the interval that begins at `at`, is zero within it.
fn zero(
    samples: &[Sample],
    at: usize,
    from_after: bool,
    value: impl Fn(&Sample) -> Option<f64>,
) -> Option<f64> {
    let (near, far) = if from_after {
        (samples.get(at + 1)?, samples.get(at + 2))
    } else {
        (
            samples.get(at)?,
            at.checked_sub(1).and_then(|far| samples.get(far)),
        )
    };
    let (x, y) = (near.position, value(near)?);
    let (before_x, before_y) = far.and_then(|far| Some((far.position, value(far)?)))?;
    let rate = (before_y - y) / (before_x - x);
    let place = x - y / rate;
    let (from, to) = (samples[at].position, samples[at + 1].position);
    (from <= place && place <= to).then_some(place)
}

/// Where the lines along which δ comes and goes cross between the samples `at` and `at + 1`.
fn crossing(samples: &[Sample], at: usize) -> Option<f64> {
    let line = |near: &Sample, far: &Sample| {
        let rate =
            (near.transmission_error - far.transmission_error) / (near.position - far.position);
        (near.transmission_error - rate * near.position, rate)
    };
    let (c_0, c_1) = line(&samples[at], samples.get(at.checked_sub(1)?)?);
    let (d_0, d_1) = line(&samples[at + 1], samples.get(at + 2)?);
    let place = (d_0 - c_0) / (c_1 - d_1);
    let (from, to) = (samples[at].position, samples[at + 1].position);
    (from < place && place < to).then_some(place)
}
