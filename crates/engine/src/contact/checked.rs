//! The stretches of the flanks of one pair as drawn on which penetration is looked for.
//!
//! These are stretches across every end of a cell that carries and every kink, others spread over the rest of the flanks, and tips that
//! stand in a fillet. Stretches are as wide as a cell, since pressures that are even over a cell close gaps in the mean over one.

use std::collections::BTreeMap;

use super::pair_cells::{PairCells, PairFlanks, compliance};
use super::patch::{Cell, Patch, Stretch};
use crate::flank::half_plane::Entries;
use crate::gear::Member;
use crate::touch::gap_profile::{FlankRange, GapProfile, RangeEnd};
use crate::touch::meeting::FlankPoints;
use crate::touch::placement::Pose;

/// Stretches spread over the flanks beside the cells.
const BESIDE: usize = 48;

/// Penetration under a solution.
#[derive(Default)]
pub(super) struct Penetration {
    /// The largest penetration, in meters; zero if everything is open.
    pub(super) largest: f64,
    /// Pairs that penetrate beside their cells.
    pub(super) beside: Vec<i64>,
    /// How deep pairs penetrate between cells, which are wide beside the contact, or within one, about a kink.
    pub(super) between: BTreeMap<i64, f64>,
    /// Pairs in which the tip of one gear is pressed into the fillet of the other, and that other gear; cells do not follow there.
    pub(super) fillets: Vec<(i64, Member)>,
}

/// Where a stretch lies, which says how its gap is found.
#[derive(Debug, Clone, Copy)]
pub(super) enum CheckedKind {
    /// Across the end of the cell `at` and the beginning of the next, perhaps at a kink: the gap is between theirs.
    Across { at: usize, kink: bool },
    /// Within a cell, about a kink.
    Kink,
    /// On the flanks, beside the cells.
    Beside,
    /// On the fillet of a gear, faced by the other's tip.
    Fillet(Member),
}

impl CheckedKind {
    /// The gear from whose flank its gap is found in a pair with cells on `primary`; `None` where that is known from cells.
    pub(super) fn seen_from(self, primary: Member) -> Option<Member> {
        match self {
            Self::Across { .. } => None,
            Self::Fillet(member) => Some(member.other()),
            Self::Kink | Self::Beside => Some(primary),
        }
    }
}

/// A stretch that may penetrate.
#[derive(Debug)]
pub(super) struct CheckedStretch {
    pub(super) place: CheckedKind,
    /// Its mean gap less that at its `place` or its flank_point.
    pub(super) more: f64,
}

/// The stretches of one pair as drawn that may penetrate.
#[derive(Debug)]
pub(super) struct CheckedStretches {
    pub(super) stretches: Vec<CheckedStretch>,
    /// Points of those stretches that have one on a flank: those on the flank of the primary of the pair, and those on the other flank.
    pub(super) flank_points: [FlankPoints; 2],
    /// Displacements of each by unit forces on the cells of the pair, row by row with the interfaces held, and W V of each gear.
    pub(super) yields: Vec<f64>,
}

/// First and last cell of a contact, in steps: a little more than those that carry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Carrying {
    from: usize,
    to: usize,
}

impl Carrying {
    /// Stretches are shared between contacts that end within as many cells of each other.
    const STEP: usize = 16;

    pub(super) fn of(active: &[bool]) -> Self {
        let first = active.iter().position(|carries| *carries);
        let last = active.iter().rposition(|carries| *carries);
        let step = Self::STEP;
        Self {
            from: first.map_or(0, |first| first / step * step),
            to: last.map_or(0, |last| (last + 1).next_multiple_of(step)),
        }
    }

    /// True if the cell `i` may carry.
    pub(super) fn holds(self, i: usize) -> bool {
        (self.from..self.to).contains(&i)
    }
}

impl CheckedStretches {
    /// Stretches at the flanks of `facing`, seen by `view`, whose gap as drawn is within `reach`.
    pub(super) fn new(
        flanks: &PairFlanks<'_>,
        view: &Pose<'_>,
        facing: &GapProfile,
        (cells, carrying): (&PairCells, Carrying),
        reach: f64,
    ) -> Self {
        let mut checked: Vec<(Stretch, CheckedStretch)> = Vec::new();
        let patch = &cells.patch;
        let between = |from: f64, to: f64| patch.stretch_between(view, &facing.kinks, from, to);
        let within = |stretch: &Stretch| stretch.cell.gap <= reach;
        for (i, pair) in patch.cells.windows(2).enumerate() {
            let apart = pair[0].stretch + 1 != pair[1].stretch;
            if apart || pair.iter().all(|cell| cell.gap > reach) {
                continue;
            }
            let carries = carrying.holds(i) || carrying.holds(i + 1);
            let kink = facing.kinks.contains(&patch.ends_along[pair[1].stretch][0]);
            if !carries && !kink {
                continue;
            }
            let place = CheckedKind::Across { at: i, kink };
            let [from, at, to] = [0, 1, 2].map(|end| patch.ends_along[pair[0].stretch + end][0]);
            let across = between(f64::midpoint(from, at), f64::midpoint(at, to));
            let [one, other] = [pair[0], pair[1]];
            let gap = (one.width * one.gap + other.width * other.gap) / (one.width + other.width);
            checked.extend(across.filter(within).map(|stretch| {
                let more = stretch.cell.gap - gap;
                (stretch, CheckedStretch { place, more })
            }));
        }
        let half = 0.5 * patch.usual_width();
        let range = &facing.range;
        let (low, high) = (range.from + half, range.to - half);
        let about = |arc: f64| {
            let arc = arc.max(low).min(high);
            between(arc - half, arc + half)
        };
        let kinks = facing.kinks.iter().filter(|kink| {
            patch.covers(**kink) && patch.ends_along.iter().all(|end| end[0] != **kink)
        });
        let beside = (0..=BESIDE).map(|i| low + (high - low) * i as f64 / BESIDE as f64);
        let near = |arc: &f64| {
            let point = view.point(*arc);
            point.is_some_and(|point| point.gap.gap <= reach)
        };
        let places = kinks.map(|kink| (*kink, CheckedKind::Kink)).chain(
            beside
                .filter(|arc| !patch.covers(*arc) && near(arc))
                .map(|arc| (arc, CheckedKind::Beside)),
        );
        for (arc, place) in places {
            checked.extend(about(arc).filter(within).map(|stretch| {
                let more = stretch.more;
                (stretch, CheckedStretch { place, more })
            }));
        }
        // A tip stands in a fillet where the other flank ends there.
        let secondary = view.seen_from_secondary();
        let of_secondary = (range.ends[0] == RangeEnd::Fillet)
            .then(|| secondary.range())
            .flatten();
        for (view, range) in [(*view, Some(*range)), (secondary, of_secondary)] {
            let tip = range.and_then(|range| tip_in_fillet(&view, &range, patch, half));
            checked.extend(tip.filter(|(_, gap)| *gap <= reach).map(|(stretch, gap)| {
                let place = CheckedKind::Fillet(view.primary.other());
                let more = gap - (stretch.cell.gap - stretch.more);
                (stretch, CheckedStretch { place, more })
            }));
        }
        Self::at(flanks, cells, checked)
    }

    /// The stretches `checked` beside `cells`.
    fn at(
        flanks: &PairFlanks<'_>,
        cells: &PairCells,
        checked: Vec<(Stretch, CheckedStretch)>,
    ) -> Self {
        let stretches: Vec<[f64; 2]> = checked.iter().map(|(stretch, _)| stretch.along).collect();
        let here: Vec<Cell> = checked.iter().map(|(stretch, _)| stretch.cell).collect();
        let (held, shapes) = compliance(flanks, &cells.patch, (&here, &stretches), Entries::All);
        let [one, other] = &shapes;
        let width = held.ncols() + one.ncols() + other.ncols();
        let mut yields = vec![0.0; checked.len() * width];
        let columns =
            [&held, one, other].map(|part| (0..part.ncols()).map(|j| part.col_as_slice(j)));
        for (j, column) in columns.into_iter().flatten().enumerate() {
            for (row, entry) in yields.chunks_exact_mut(width).zip(column) {
                row[j] = *entry;
            }
        }
        let mut flank_points = [FlankPoints::default(), FlankPoints::default()];
        for (stretch, of) in &checked {
            if let Some(from) = of.place.seen_from(cells.patch.primary) {
                flank_points[usize::from(from != cells.patch.primary)].push(&stretch.flank_point);
            }
        }
        Self {
            yields,
            flank_points,
            stretches: checked.into_iter().map(|(_, checked)| checked).collect(),
        }
    }

    /// About how much memory they take, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let flank_points: usize = self.flank_points.iter().map(FlankPoints::bytes).sum();
        size_of::<Self>()
            + size_of_val(&*self.stretches)
            + flank_points
            + size_of_val(&*self.yields)
    }
}

/// The tip of the primary of `view` where it stands in the fillet of the other gear, and the gap there: it gives way about as the highest
/// place that faces the flank does.
fn tip_in_fillet(
    view: &Pose<'_>,
    range: &FlankRange,
    patch: &Patch,
    half: f64,
) -> Option<(Stretch, f64)> {
    let gap = view.tip_to_fillet(range)?;
    let stretch = patch.stretch_between(view, &[], range.to - 2.0 * half, range.to)?;
    Some((stretch, gap))
}
