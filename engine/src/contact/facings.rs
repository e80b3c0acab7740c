//! All pairs whose flanks face each other at one fraction of the mesh period, and which of them come near.

use super::facing::Facing;
use crate::gear::{GearPair, Member};

/// The pairs whose flanks face each other at one fraction of the mesh period, by rising gap; numbered from the reference pair of the
/// period. They are looked for outward from the path of contact, as far as is asked.
pub(super) struct Facings<'a> {
    gears: &'a GearPair,
    fraction: f64,
    home: i64,
    /// How far deviations may bring flanks nearer, and farther apart: both not negative.
    nearer: f64,
    farther: f64,
    found: Vec<Facing<'a>>,
    /// The least gap as drawn.
    least: f64,
    /// The mesh period asked about last, and the δ at which pairs touch there, as far as they were asked for.
    touches: (i64, Vec<(i64, f64)>),
    /// The next pairs to look at, before and after those found, and the gap of the last one there.
    frontier: [Frontier; 2],
}

struct Frontier {
    next: i64,
    step: i64,
    last_gap: f64,
}

impl<'a> Facings<'a> {
    /// The pairs on the path of contact and those beside it, `home` mesh periods on; `None` if no flanks face each other at all.
    pub(super) fn new(gears: &'a GearPair, fraction: f64, home: i64) -> Option<Self> {
        let (s_a, s_e) = gears.path_of_contact();
        // Pair n touches at the roll length of η − n periods.
        let periods = |s: f64| (s - gears.roll_length_of(0.0)) / gears.base_pitch();
        let first = (fraction - periods(s_e)).floor() as i64;
        let last = (fraction - periods(s_a)).ceil() as i64;
        let mut found: Vec<Facing<'a>> = (first..=last)
            .filter_map(|n| Facing::of(gears, fraction, n, home))
            .collect();
        let frontier = |last: i64, step| Frontier {
            next: last + step,
            step,
            last_gap: found
                .iter()
                .find(|facing| facing.pair == last)
                .map_or(f64::INFINITY, |facing| facing.gap),
        };
        let frontier = [frontier(first, -1), frontier(last, 1)];
        found.sort_by(|a, b| a.gap.total_cmp(&b.gap));
        let ranges = Member::BOTH.map(|member| gears.gear(member).deviation_range());
        (!found.is_empty()).then_some(Self {
            gears,
            fraction,
            home,
            nearer: ranges[0][0] + ranges[1][0],
            farther: -ranges[0][1] - ranges[1][1],
            touches: (0, Vec::new()),
            frontier,
            least: found.first().map_or(f64::INFINITY, |facing| facing.gap),
            found,
        })
    }

    /// The δ at which the first pair touches in mesh period `period`: the transmission error under no load.
    pub(super) fn touch(&mut self, period: i64) -> f64 {
        // The pair that is nearest as drawn comes no nearer than its own teeth stand; others must be nearer than that.
        let first = self.found[0].gap + self.farther;
        self.within(period, first)
            .into_iter()
            .map(|(_, gap)| gap)
            .fold(f64::INFINITY, f64::min)
    }

    /// The pairs that touch in mesh period `period` before δ is `reach`, by their place in [`Facings::all`], with the δ of each; at least
    /// the one that touches first.
    pub(super) fn within(&mut self, period: i64, reach: f64) -> Vec<(usize, f64)> {
        let as_drawn = reach + self.nearer;
        self.look_as_far_as(as_drawn);
        let count = self.found.partition_point(|facing| facing.gap <= as_drawn);
        let mut pairs: Vec<(usize, f64)> = (0..count.max(1))
            .map(|i| (i, self.touch_of(i, period)))
            .collect();
        if pairs.iter().any(|(_, gap)| *gap <= reach) {
            pairs.retain(|(_, gap)| *gap <= reach);
        } else {
            pairs.sort_by(|a, b| a.1.total_cmp(&b.1));
            pairs.truncate(1);
        }
        pairs
    }

    /// The δ at which the pair at place `i` touches in mesh period `period`.
    fn touch_of(&mut self, i: usize, period: i64) -> f64 {
        let facing = &self.found[i];
        let (of_period, known) = &mut self.touches;
        if *of_period != period {
            *of_period = period;
            known.clear();
        }
        // Each step of a solution asks again.
        if let Some((_, touch)) = known.iter().find(|(pair, _)| *pair == facing.pair) {
            return *touch;
        }
        let touch = facing.touch_of(self.gears.teeth(period + facing.pair));
        known.push((facing.pair, touch));
        touch
    }

    /// Finds the pairs whose gap as drawn is within `reach`.
    fn look_as_far_as(&mut self, reach: f64) {
        // Beyond the path of contact gaps grow from pair to pair.
        for frontier in &mut self.frontier {
            while frontier.last_gap <= reach {
                let facing = Facing::of(self.gears, self.fraction, frontier.next, self.home);
                frontier.last_gap = facing.map_or(f64::INFINITY, |facing| facing.gap);
                frontier.next += frontier.step;
                if let Some(facing) = facing {
                    let place = self.found.partition_point(|known| known.gap <= facing.gap);
                    self.found.insert(place, facing);
                }
            }
        }
    }

    /// How far deviations may bring flanks nearer.
    pub(super) fn nearer(&self) -> f64 {
        self.nearer
    }

    /// The least gap as drawn.
    pub(super) fn least(&self) -> f64 {
        self.least
    }

    /// The facing of `pair`, which was found.
    pub(super) fn of_pair(&self, pair: i64) -> Option<&Facing<'a>> {
        self.found.iter().find(|facing| facing.pair == pair)
    }

    /// All that were found.
    pub(super) fn all(&self) -> &[Facing<'a>] {
        &self.found
    }
}
