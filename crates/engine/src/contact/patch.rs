//! Patches of contact cells about the places where flanks are nearest.
//!
//! The cells lie on the flank of the primary, the gear whose tip is nearer. On the line of action of unmodified flanks a cell presses along the
//! theoretical normal; elsewhere, where a relief inclines a flank or a tip corner digs into the other one, the normal is tilted and its
//! arms about the centers are not the base radii.

use std::ops::Range;

use crate::flank::half_plane::{NearField, logarithm_factor};
use crate::gear::{GearPair, Member, Vector};
use crate::root_finding::crossing;
use crate::touch::gap_profile::{GapMinimum, GapProfile, RangeEnd};
use crate::touch::meeting::{FlankPoint, FlankPoints};
use crate::touch::placement::Pose;

/// The cells on either side of a minimum, in half-widths of the contact under the whole load: the contact and a quarter more, so that a contact
/// that a relief shifts still fits.
const CORE: f64 = 1.25;

/// Largest rise of the gap within a core, in c F: a parabola has risen by half of that at the end of its contact, a
/// tilted corner by twice.
const MOST_RISE: f64 = 2.5;

/// Cells between two kinks where there are as many of them on a core, and how many times as many cells there are at the most.
const CELLS_A_KINK: usize = 6;
const MANY_KINKS: usize = 4;
const MOST_REFINED: usize = 4;

/// Maximum number of cells on the cores of a pair. Under a light load the core of a corner may be thousands of times as narrow as that of another minimum,
/// which is not covered as densely then.
const MOST_ON_CORES: f64 = 2048.0;

/// By how much each cell beside the core is wider than the one before, as a part of it.
const WIDER: f64 = 0.3;

/// Cells that are added on each open side at a time.
const FRINGE: usize = 8;

/// One contact cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Its place in the chain of ends along the flank ([`Patch::ends_along`]): it reaches from this one to the next.
    pub(super) stretch: usize,
    /// Its width along the flank as it is.
    pub width: f64,
    /// Roll length on the driving and on the driven gear.
    pub roll_lengths: [f64; 2],
    /// How each gear is pressed: components against its outward normal and against its way to the tip.
    pub directions: [[f64; 2]; 2],
    /// The gap of the flanks as drawn under no load, in the mean, positive when open.
    pub gap: f64,
    /// The arms of the force about the driving and the driven axis over the base radii, as drawn; 1 on the line of action.
    pub arms: [f64; 2],
}

/// The cells of one tooth pair.
#[derive(Debug, Clone)]
pub struct Patch {
    /// The gear on whose flank the cells lie.
    pub primary: Member,
    /// The cells, towards the primary gear's tip.
    pub cells: Vec<Cell>,
    /// Where cells begin and end, by arc length on the primary gear's involute, and along the flank as it is.
    pub(super) ends_along: Vec<[f64; 2]>,
    /// The ends of the flanks that the first and the last cell reach.
    pub ends: [Option<RangeEnd>; 2],
    /// Where a flank has a kink, by arc length on the primary gear's involute, rising.
    kinks: Vec<f64>,
    /// Places at which a flank ends in the corner of its undercut.
    corners: Vec<f64>,
    /// How each gear gives way near the contact.
    pub near_fields: [NearField; 2],
    /// True if the nominal contact lies past the primary gear's tip, off the path of contact.
    pub off_path: bool,
    /// The middle of each cell, to be followed.
    pub(super) flank_points: FlankPoints,
    /// Excess of the mean gap of each cell over the gap there.
    pub(super) more: Vec<f64>,
}

/// A stretch of flank on which forces may be even.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    pub(super) cell: Cell,
    /// Where it begins and ends along the flank as it is.
    pub(super) along: [f64; 2],
    /// Its middle, to be followed.
    pub(super) flank_point: FlankPoint,
    /// Excess of its mean gap over that at its middle.
    pub(super) more: f64,
}

/// How far about its minima a pair is covered with cells, and how densely.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub(super) struct Extent {
    /// The minima that are covered, of those that touch first.
    pub(super) minima: usize,
    /// How often cells were added on all open sides.
    pub(super) widened: usize,
    /// How often all cells were halved.
    pub(super) halved: u32,
    /// How far deviations that incline the flanks move the contact towards the primary gear's tip, in halves of [`half_width`].
    pub(super) moved: i32,
}

impl Extent {
    /// How far the contact at `minimum` under `load` moves where the flanks touch `along` farther towards the tip and are inclined by
    /// `inclination` for each length along them: an angle moves the least place of a parabola by its radius.
    pub(super) fn moved(
        gears: &GearPair,
        minimum: &GapMinimum,
        load: f64,
        (along, inclination): (f64, f64),
    ) -> i32 {
        let [down, up] = minimum.openings;
        let (indentation, radius) = indentation(gears, minimum, load);
        let half = 0.5 * contact_width(indentation, radius, 0.0);
        // A corner stays where it is.
        if down.max(up) * radius > half {
            return 0;
        }
        ((along + inclination * radius) / half).round() as i32
    }
}

impl Patch {
    /// Places cells about the minima of `facing`, which is seen by `view`: `count` on that which touches first, in a core wide enough for
    /// `load`, and as dense ones about the others.
    ///
    /// Cells end where the flanks cease to face each other, so that they move with the contact and close up smoothly towards a corner,
    /// and at kinks. The cells of a patch are among those of the same patch widened: where contact does not reach beyond the core nothing changes.
    pub(super) fn new(
        view: &Pose<'_>,
        facing: &GapProfile,
        load: f64,
        count: usize,
        extent: Extent,
    ) -> Self {
        let gears = view.pair;
        let width = gears.common_face_width();
        let covered = &facing.minima[..extent.minima.min(facing.minima.len())];
        let chains = chains(view, facing, covered, load, count, extent);
        let mut patch = Self {
            primary: facing.primary,
            cells: Vec::new(),
            ends_along: Vec::new(),
            ends: [
                (chains[0][0] <= facing.range.from).then_some(facing.range.ends[0]),
                (chains[chains.len() - 1].last() >= Some(&facing.range.to))
                    .then_some(facing.range.ends[1]),
            ],
            kinks: facing.kinks.clone(),
            corners: facing.corners.clone(),
            near_fields: Member::BOTH.map(|member| {
                let s = facing.minima[0].roll_lengths[member.index()];
                NearField::new(gears.gear(member), s, width)
            }),
            off_path: facing.off_path,
            flank_points: FlankPoints::default(),
            more: Vec::new(),
        };
        let (mut last, mut along) = (None::<Vector>, 0.0);
        for chain in &chains {
            for (i, &arc) in chain.iter().enumerate() {
                let Some(point) = view.point(arc) else {
                    continue;
                };
                let here = point.place.point;
                along += last.map_or(0.0, |last| (here - last).norm());
                last = Some(here);
                patch.ends_along.push([arc, along]);
                if i > 0 {
                    patch.place(view, facing);
                }
            }
        }
        patch
    }

    /// Places the cell between the last two ends.
    fn place(&mut self, view: &Pose<'_>, facing: &GapProfile) {
        let place = self.ends_along.len() - 2;
        let ([from, _], [to, _]) = (self.ends_along[place], self.ends_along[place + 1]);
        if let Some(stretch) = self.stretch_between(view, &facing.kinks, from, to) {
            self.cells.push(Cell {
                stretch: place,
                ..stretch.cell
            });
            self.flank_points.push(&stretch.flank_point);
            self.more.push(stretch.more);
        }
    }

    /// The flank of the primary of `view`, this one's or the other gear, between its arcs `from` and `to`; `None` inside the other base circle.
    pub(super) fn stretch_between(
        &self,
        view: &Pose<'_>,
        kinks: &[f64],
        from: f64,
        to: f64,
    ) -> Option<Stretch> {
        let middle = view.point(f64::midpoint(from, to))?;
        let met = view.gap_and_arms(&middle);
        let gap = mean_gap(view, kinks, from, to).unwrap_or(met.gap);
        let (place, opposite) = (&middle.place, &middle.gap);
        let normal = view.common_normal(place.normal, opposite.normal);
        let on = |radial: Vector| {
            let across = Vector::new(-radial.y, radial.x);
            [normal.dot(&across), normal.dot(&radial)]
        };
        let (on_primary, on_secondary) = (on(place.radial).map(|each| -each), on(opposite.radial));
        let roll_lengths = view.on_both(middle.roll_length, opposite.roll_length);
        let along = if view.primary == self.primary {
            [from, to].map(|arc| self.along(arc))
        } else {
            let flank = view.pair.gear(self.primary).flank();
            let at = self.along(flank.arc_length(roll_lengths[self.primary.index()]));
            [at - 0.5 * (to - from), at + 0.5 * (to - from)]
        };
        Some(Stretch {
            cell: Cell {
                stretch: 0,
                width: along[1] - along[0],
                roll_lengths,
                directions: view.on_both(on_primary, on_secondary),
                gap,
                arms: met.arms,
            },
            along,
            flank_point: view.flank_point(&middle),
            more: gap - met.gap,
        })
    }

    /// Where `arc` lies along the flank as it is.
    fn along(&self, arc: f64) -> f64 {
        let ends = &self.ends_along;
        let after = ends.partition_point(|end| end[0] < arc);
        match (after.checked_sub(1).map(|i| ends[i]), ends.get(after)) {
            (_, Some(end)) if end[0] == arc => end[1],
            (Some(low), Some(high)) => {
                low[1] + (arc - low[0]) * (high[1] - low[1]) / (high[0] - low[0])
            }
            // Beside all cells the flank is about as long as its involute.
            (Some(end), None) => end[1] + arc - end[0],
            (None, Some(end)) => end[1] + arc - end[0],
            (None, None) => arc,
        }
    }

    /// The width that most cells have, by arc length on the involute.
    pub(super) fn usual_width(&self) -> f64 {
        let widths = self.cells.iter().map(|cell| {
            let [from, to] = [0, 1].map(|end| self.ends_along[cell.stretch + end][0]);
            to - from
        });
        let mut widths: Vec<f64> = widths.collect();
        widths.sort_by(f64::total_cmp);
        widths[widths.len() / 2]
    }

    /// Where each cell begins and ends along the flank as it is.
    pub(super) fn stretches(&self) -> impl Iterator<Item = [f64; 2]> {
        self.cells
            .iter()
            .map(|cell| [0, 1].map(|end| self.ends_along[cell.stretch + end][1]))
    }

    /// About how much memory it takes beside itself, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.cells.as_slice())
            + size_of_val(self.ends_along.as_slice())
            + size_of_val(self.kinks.as_slice())
            + size_of_val(self.corners.as_slice())
            + self.flank_points.bytes()
            + size_of_val(self.more.as_slice())
    }

    /// True if `arc` lies in a cell.
    pub(super) fn covers(&self, arc: f64) -> bool {
        self.cells.iter().any(|cell| {
            let [from, to] = [0, 1].map(|end| self.ends_along[cell.stretch + end][0]);
            (from..=to).contains(&arc)
        })
    }

    /// Cells beside which there is none on the side of the root or of the tip, though the flanks face each other there.
    fn open_ends(&self) -> impl Iterator<Item = usize> {
        let last = self.cells.len().saturating_sub(1);
        let first = (self.ends[0].is_none() && !self.cells.is_empty()).then_some(0);
        let apart = (0..last)
            .filter(|i| self.cells[*i].stretch + 1 != self.cells[i + 1].stretch)
            .flat_map(|i| [i, i + 1]);
        first
            .into_iter()
            .chain(apart)
            .chain(self.ends[1].is_none().then_some(last))
    }

    /// True if there is room for more cells.
    pub(super) fn can_widen(&self) -> bool {
        self.open_ends().next().is_some()
    }

    /// True if contact of the `active` cells reaches one beside which there could be another.
    pub(super) fn overflows(&self, active: &[bool]) -> bool {
        self.open_ends().any(|i| active[i])
    }

    /// Distance of the middle of the `active` cells from the middle of all, in halves of a contact's half-width, where they are one stretch that would fit;
    /// cells reach 1.25 half-widths of the contact under the whole load to either side, so that this is about the unit of [`Extent::moved`].
    pub(super) fn off_middle(&self, active: &[bool]) -> i32 {
        let ends = self.ends == [None, None] && self.cells.len() == self.ends_along.len() - 1;
        let (first, last) = (
            active.iter().position(|active| *active),
            active.iter().rposition(|active| *active),
        );
        let (Some(first), Some(last), true) = (first, last, ends) else {
            return 0;
        };
        let at = |i: usize| self.ends_along[i][1];
        let all = at(self.cells.len()) - at(0);
        if at(last + 1) - at(first) > 0.8 * all {
            return 0;
        }
        let off = 0.5 * (at(first) + at(last + 1)) - 0.5 * (at(0) + at(self.cells.len()));
        (off / (0.5 * all / CORE) / 0.5).round() as i32
    }

    /// The contacts of the `active` cells: those of each follow one another.
    pub(super) fn contacts(&self, active: &[bool]) -> Vec<Range<usize>> {
        let mut contacts: Vec<Range<usize>> = Vec::new();
        for i in (0..active.len()).filter(|i| active[*i]) {
            match contacts.last_mut() {
                Some(last)
                    if last.end == i && self.cells[i - 1].stretch + 1 == self.cells[i].stretch =>
                {
                    last.end = i + 1;
                }
                _ => contacts.push(i..i + 1),
            }
        }
        contacts
    }

    /// Half the width along the flank of the `contact` of these cells.
    pub(super) fn half_width(&self, contact: &Range<usize>) -> f64 {
        let cells = &self.cells[contact.clone()];
        0.5 * cells.iter().map(|cell| cell.width).sum::<f64>()
    }

    /// Where the cells from the first to the last of `contact` begin and end, by arc length on the primary gear's involute.
    fn reach(&self, contact: &Range<usize>) -> [f64; 2] {
        let [first, last] = [contact.start, contact.end - 1].map(|i| self.cells[i].stretch);
        [self.ends_along[first][0], self.ends_along[last + 1][0]]
    }

    /// True if the flanks are smooth under the `contact` of these cells and up to one more cell beside it.
    pub(super) fn is_smooth_under(&self, contact: &Range<usize>) -> bool {
        let [from, to] = self.reach(contact);
        let beside = (to - from) / contact.len() as f64;
        let ends = (contact.start == 0 && self.ends[0].is_some())
            || (contact.end == self.cells.len() && self.ends[1].is_some());
        let mut kinks = self.kinks.iter();
        !ends && kinks.all(|kink| *kink < from - beside || *kink > to + beside)
    }

    /// The largest of the `pressures` of `active` cells at least half a contact's width away from kinks, where contacts are `times` as wide
    /// as these cells; 0 where there is none.
    pub(super) fn smooth_pressure(&self, pressures: &[f64], active: &[bool], times: f64) -> f64 {
        let kinks: Vec<f64> = self.kinks.iter().map(|kink| self.along(*kink)).collect();
        let mut largest = 0.0_f64;
        for contact in self.contacts(active) {
            let half_width = times * self.half_width(&contact);
            for i in contact {
                let stretch = self.cells[i].stretch;
                let [from, to] = [stretch, stretch + 1].map(|end| self.ends_along[end][1]);
                let away = |kink: &f64| (kink - f64::midpoint(from, to)).abs() >= half_width;
                if kinks.iter().all(away) {
                    largest = largest.max(pressures[i]);
                }
            }
        }
        largest
    }

    /// True if the contact of the `active` cells reaches a corner: the tip edge of a gear whose edge is `sharp`, or that of an undercut flank.
    pub(super) fn corner_carries(&self, active: &[bool], sharp: [bool; 2]) -> bool {
        let at_tip = self.ended_by(active).any(|end| match end {
            RangeEnd::Tip => sharp[self.primary.index()],
            RangeEnd::SecondaryTip => sharp[self.primary.other().index()],
            RangeEnd::Fillet | RangeEnd::SecondaryFillet => false,
        });
        let cells = self.cells.iter().zip(active);
        let mut carrying = cells.filter(|(_, active)| **active);
        at_tip
            || carrying.any(|(cell, _)| {
                let [from, to] = [0, 1].map(|end| self.ends_along[cell.stretch + end][0]);
                let mut corners = self.corners.iter();
                corners.any(|corner| (from..=to).contains(corner))
            })
    }

    /// The gear whose fillet the contact of the `active` cells reaches.
    pub(super) fn reached_fillet(&self, active: &[bool]) -> Option<Member> {
        self.ended_by(active).find_map(|end| match end {
            RangeEnd::Fillet => Some(self.primary),
            RangeEnd::SecondaryFillet => Some(self.primary.other()),
            RangeEnd::Tip | RangeEnd::SecondaryTip => None,
        })
    }

    /// The ends of the flanks that the contact of the `active` cells reaches.
    fn ended_by(&self, active: &[bool]) -> impl Iterator<Item = RangeEnd> {
        let first = self.ends[0].filter(|_| active.first() == Some(&true));
        let last = self.ends[1].filter(|_| active.last() == Some(&true));
        first.into_iter().chain(last)
    }
}

/// The mean gap from `from` to `to`, by two Gauss points between each two `kinks`.
fn mean_gap(view: &Pose<'_>, kinks: &[f64], from: f64, to: f64) -> Option<f64> {
    let first = kinks.partition_point(|kink| *kink <= from);
    let inside = kinks[first..].iter().copied().take_while(|kink| *kink < to);
    let (mut sum, mut begin) = (0.0, from);
    for end in inside.chain([to]) {
        let (middle, offset) = (f64::midpoint(begin, end), (end - begin) / 12.0_f64.sqrt());
        for arc in [middle - offset, middle + offset] {
            sum += 0.5 * (end - begin) * view.gap_and_arms(&view.point(arc)?).gap;
        }
        begin = end;
    }
    Some(sum / (to - from))
}

/// Rising ends of cells: chains of them, apart from each other.
fn chains(
    view: &Pose<'_>,
    facing: &GapProfile,
    covered: &[GapMinimum],
    load: f64,
    count: usize,
    extent: Extent,
) -> Vec<Vec<f64>> {
    let range = &facing.range;
    let cores = covered
        .iter()
        .map(|minimum| core(view, minimum, load, facing));
    let cores: Vec<[f64; 2]> = cores.collect();
    let [from, to] = cores[0];
    // A profile as it was measured has many minima, and a contact in each.
    let inside = |kink: &&f64| from < **kink && **kink < to;
    let kinks = facing.kinks.iter().filter(inside).count();
    let count = if kinks < MANY_KINKS {
        count
    } else {
        count.max(CELLS_A_KINK * kinks).min(MOST_REFINED * count)
    };
    let count = count << extent.halved;
    let width = (to - from) / count as f64;
    // Moved by whole cells too.
    let half = (0.5 * count as f64 / (2.0 * CORE)).round() * width;
    let width = width.max(covered_by(&cores) / MOST_ON_CORES);
    let by = f64::from(extent.moved) * half;
    let moved = [from + by, to + by].map(|end| end.clamp(range.from, range.to));
    let [from, to] = if moved[0] + half < moved[1] {
        moved
    } else {
        [from, to]
    };
    // The others in whole cells from the first, so that they add to it and change nothing.
    let on_lattice = |[low, high]: [f64; 2]| {
        [
            from + ((low - from) / width).floor() * width,
            to + ((high - to) / width).ceil() * width,
        ]
    };
    let mut cores: Vec<[f64; 2]> = std::iter::once([from, to])
        .chain(cores[1..].iter().map(|core| on_lattice(*core)))
        .map(|[low, high]| [low.max(range.from), high.min(range.to)])
        .collect();
    cores.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut joined: Vec<[f64; 2]> = Vec::new();
    for [low, high] in cores {
        match joined.last_mut() {
            Some(last) if low <= last[1] + 0.5 * width => last[1] = last[1].max(high),
            _ => joined.push([low, high]),
        }
    }
    let mut chains: Vec<Vec<f64>> = joined
        .into_iter()
        .map(|core| ending_at_kinks(core, width, facing))
        .collect();
    widen(&mut chains, facing, width, extent.widened);
    chains
}

/// How long `cores` are together where they overlap or not.
fn covered_by(cores: &[[f64; 2]]) -> f64 {
    let mut rising = cores.to_vec();
    rising.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut covered = f64::NEG_INFINITY;
    let lengths = rising.into_iter().map(|[from, to]| {
        let length = (to - from.max(covered)).max(0.0);
        covered = covered.max(to);
        length
    });
    lengths.sum()
}

/// The stretch about `minimum` that the contact may take under the whole load, and a quarter beside it.
fn core(view: &Pose<'_>, minimum: &GapMinimum, load: f64, facing: &GapProfile) -> [f64; 2] {
    let GapProfile { range, kinks, .. } = facing;
    let (indentation, radius) = indentation(view.pair, minimum, load);
    let ways = minimum
        .openings
        .map(|angle| CORE * contact_width(indentation, radius, angle));
    let [down, up] = ways;
    let (low, high) = (minimum.arc - down, minimum.arc + up);
    let gap = |arc: f64| view.point(arc).map_or(f64::INFINITY, |point| point.gap.gap);
    let least = gap(minimum.arc);
    let room = |arc: f64| MOST_RISE * indentation - (gap(arc) - least);
    // Beyond a kink the gap may open faster than the parabola does.
    let bent = |from: f64, to: f64| kinks.iter().any(|kink| from < *kink && *kink < to);
    let convex = facing.minima.len() == 1;
    let to = |end: f64| {
        let (from, to) = (end.min(minimum.arc), end.max(minimum.arc));
        let end = end.clamp(range.from, range.to);
        if !convex || !bent(from, to) {
            return end;
        }
        let beyond = (end, room(end));
        if beyond.1 > 0.0 {
            end
        } else {
            crossing((minimum.arc, MOST_RISE * indentation), beyond, room)
        }
    };
    [to(low), to(high)]
}

/// c F, the depth that goes with the logarithm of both bodies under `load`, and the radius of the gap's parabola at `minimum`.
fn indentation(gears: &GearPair, minimum: &GapMinimum, load: f64) -> (f64, f64) {
    let width = gears.common_face_width();
    let factors: f64 = Member::BOTH
        .map(|member| logarithm_factor(gears.gear(member).material().youngs_modulus, width))
        .into_iter()
        .sum();
    let [s_1, s_2] = minimum.roll_lengths;
    // Near a base circle the involute is as sharp as one likes; a tenth of the other radius is as small as the patch goes.
    let least = 0.1 * s_1.max(s_2);
    let [rho_1, rho_2] = [s_1, s_2].map(|radius| radius.max(least));
    (load * factors, rho_1 * rho_2 / (rho_1 + rho_2))
}

/// Least width of a cell, as a part of the others.
const SLIVER: f64 = 1e-3;

/// Nor narrower than this part of its distance from a kink.
const NARROW: f64 = 0.2;

/// Distance from a kink, in widths, within which cells end only where the division about the kink says.
const BESIDE: f64 = 1.3;

/// How often cells are halved towards a kink, where pressure grows with the logarithm of the distance from it.
const AT_KINK: u32 = 2;

/// An edge that turns the flank by no more, as reliefs and measured profiles do, presses as a kink wherever in the contact it stands: the power with which
/// pressure grows towards it is hardly one.
const SHALLOW: f64 = 0.05;

/// How often towards a corner that digs in, the tip's or a broken edge's, where it grows with a power.
const AT_CORNER: u32 = 4;

/// The ends of cells of about `width` over a stretch of the flank of `facing`. A kink ends one and stands among narrower cells, at distances from it
/// that do not depend on the other ends: nothing steps as cells move over it.
fn ending_at_kinks([from, to]: [f64; 2], width: f64, facing: &GapProfile) -> Vec<f64> {
    let GapProfile { range, kinks, .. } = facing;
    let count = ((to - from) / width).round().max(1.0) as usize;
    let width = (to - from) / count as f64;

    // Places towards which cells become narrower, and the number of halvings.
    let is_tip = |end: RangeEnd| matches!(end, RangeEnd::Tip | RangeEnd::SecondaryTip);
    let mut towards: Vec<(f64, u32)> = Vec::new();
    if from == range.from && is_tip(range.ends[0]) {
        towards.push((from, AT_CORNER));
    }
    let mut last = None;
    let first = kinks.partition_point(|kink| *kink <= from);
    for kink in kinks[first..].iter().take_while(|kink| **kink < to) {
        let before = ((kink - from) / width) as usize;
        // Kinks denser than cells lie inside of them.
        if last != Some(before) && before < count {
            last = Some(before);
            let digs_in = |minimum: &GapMinimum| {
                let [down, up] = minimum.openings;
                minimum.arc == *kink && down.min(up) > 0.0 && down + up > SHALLOW
            };
            let corner = facing.minima.iter().any(digs_in);
            towards.push((*kink, if corner { AT_CORNER } else { AT_KINK }));
        }
    }
    if to == range.to && is_tip(range.ends[1]) {
        towards.push((to, AT_CORNER));
    }
    let nearest = |end: f64| {
        let distances = towards.iter().map(|(place, _)| (end - place).abs());
        distances.fold(f64::INFINITY, f64::min)
    };
    let evenly = (1..count).map(|i| from + i as f64 * width);
    let mut ends: Vec<f64> = evenly
        .filter(|end| nearest(*end) > BESIDE * width)
        .collect();
    ends.extend([from, to]);
    for (i, &(place, times)) in towards.iter().enumerate() {
        // Half the way to the next is room for each.
        let low = i
            .checked_sub(1)
            .map_or(from, |i| f64::midpoint(towards[i].0, place));
        let high = towards
            .get(i + 1)
            .map_or(to, |next| f64::midpoint(place, next.0));
        let about = halved_about(place, width, times);
        ends.extend(about.filter(|end| low < *end && *end < high));
        ends.push(place);
    }
    ends.sort_by(f64::total_cmp);
    // The pressure of a cell far narrower than those beside it would be arbitrary. A kink is kept before other ends.
    let is_kink = |end: f64| towards.iter().any(|(place, _)| *place == end);
    ends.dedup_by(|after, before| {
        let away = nearest(*before).min(nearest(*after)).min(width);
        let one = *after - *before < (NARROW * away).max(SLIVER * width);
        if one && is_kink(*after) {
            *before = *after;
        }
        one
    });
    if let Some(end) = ends.last_mut() {
        *end = to;
    }
    ends
}

/// The ends of cells on both sides of `place`, from `width` off it, halved a given number of times towards it.
fn halved_about(place: f64, width: f64, times: u32) -> impl Iterator<Item = f64> {
    let parts = (0..=times).map(move |i| width * 0.5_f64.powi(i as i32));
    parts.flat_map(move |part| [place - part, place + part])
}

/// Adds cells that grow away from the `chains` on all their open sides, until they meet.
fn widen(chains: &mut Vec<Vec<f64>>, facing: &GapProfile, width: f64, times: usize) {
    if times == 0 {
        return;
    }
    let GapProfile { range, kinks, .. } = facing;
    let firsts: Vec<f64> = chains.iter().map(|chain| chain[0]).collect();
    let lasts: Vec<f64> = chains.iter().map(|chain| chain[chain.len() - 1]).collect();
    let mut joined: Vec<Vec<f64>> = Vec::new();
    for (i, chain) in chains.drain(..).enumerate() {
        // Half the way to the next chain is room for each.
        let low = if i == 0 {
            range.from
        } else {
            f64::midpoint(lasts[i - 1], firsts[i])
        };
        let high = firsts
            .get(i + 1)
            .map_or(range.to, |next| f64::midpoint(lasts[i], *next));
        let mut before = fringe((chain[0], low), kinks, width, times);
        before.reverse();
        let beyond = fringe((chain[chain.len() - 1], high), kinks, width, times);
        let ends = before.into_iter().chain(chain).chain(beyond);
        match joined.last_mut() {
            Some(last) if i > 0 && last.last() == Some(&low) => {
                // Both came to the same middle.
                last.extend(ends.filter(|end| *end > low));
            }
            _ => joined.push(ends.collect()),
        }
    }
    // Where a core ends beside a kink it leaves a cell of any width.
    let in_core =
        |kink: f64| (0..firsts.len()).any(|i| firsts[i] + width < kink && kink < lasts[i] - width);
    for chain in &mut joined {
        for (i, &kink) in kinks.iter().enumerate() {
            let beside = [i.wrapping_sub(1), i + 1].map(|k| kinks.get(k));
            let mut others = beside.into_iter().flatten();
            if !in_core(kink) && others.all(|other| (other - kink).abs() > 2.0 * BESIDE * width) {
                narrow_towards(kink, chain, width);
            }
        }
        leave_no_slivers(chain, kinks);
    }
    *chains = joined;
}

/// Places `ends` anew about a `kink` among them, as [`ending_at_kinks`] does.
fn narrow_towards(kink: f64, ends: &mut Vec<f64>, width: f64) {
    let (first, last) = (ends[0], ends[ends.len() - 1]);
    let inside = |end: f64| first < end && end < last;
    if !inside(kink) {
        return;
    }
    // A fringe begins anew at the kink, and its first cell is just as wide: it goes, however that is rounded.
    let away = (BESIDE + SLIVER) * width;
    ends.retain(|&end| !inside(end) || (end - kink).abs() > away);
    let about = halved_about(kink, width, AT_KINK).chain([kink]);
    ends.extend(about.filter(|end| inside(*end)));
    ends.sort_by(f64::total_cmp);
}

/// Removes ends that leave a cell far narrower than those beside it, as where a kink stands just before or beyond the stretch: its pressure would be arbitrary.
/// Kinks stay.
fn leave_no_slivers(ends: &mut Vec<f64>, kinks: &[f64]) {
    let is_kink = |end: f64| kinks.contains(&end);
    let mut i = 1;
    while i + 2 < ends.len() {
        let [before, cell, beyond] = [i, i + 1, i + 2].map(|i| ends[i] - ends[i - 1]);
        if cell >= NARROW * before.min(beyond) {
            i += 1;
        } else if !is_kink(ends[i]) {
            ends.remove(i);
        } else if !is_kink(ends[i + 1]) {
            ends.remove(i + 1);
        } else {
            i += 1;
        }
    }
}

/// The ends of the cells beyond `end` towards `limit`; at `kinks` they begin anew as narrow as at first.
fn fringe((end, limit): (f64, f64), kinks: &[f64], width: f64, times: usize) -> Vec<f64> {
    let way = (limit - end).signum();
    let (mut ends, mut at, mut step) = (Vec::new(), end, width);
    for _ in 0..FRINGE * times {
        let left = (limit - at).abs();
        if left <= 1e-9 * width {
            break;
        }
        step *= 1.0 + WIDER;
        // No sliver is left at the limit.
        let next = if left < 1.5 * step {
            limit
        } else {
            at + way * step
        };
        let beyond = |kink: &f64| (kink - at) * way > SLIVER * width;
        let before = |kink: &f64| (next - kink) * way > SLIVER * width;
        let mut between = kinks
            .iter()
            .copied()
            .filter(|kink| beyond(kink) && before(kink));
        let kink = if way > 0.0 {
            between.next()
        } else {
            between.next_back()
        };
        at = kink.unwrap_or(next);
        if kink.is_some() {
            step = width;
        }
        ends.push(at);
    }
    ends
}

/// How far a contact reaches from its middle or from its corner, where the gap opens as σ x + x²/(2 ρ).
///
/// Without an angle σ this is Hertz's half-width, a² = 2 ρ c F. A tilted corner on a half plane presses with
/// p ~ √((L − x)/x) over the width L = 2 c F/σ. The root between them has both as its limits.
fn contact_width(indentation: f64, radius: f64, angle: f64) -> f64 {
    // σ L/2 + L²/(2 ρ) = c F, without the difference of like numbers.
    let root = (angle * angle + 8.0 * indentation / radius).sqrt();
    4.0 * indentation / (angle + root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{ModificationData, ReliefData, ReliefShape, ReliefStart, SpurGear};

    fn pair() -> GearPair {
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        GearPair::new(gear.clone(), gear, 100.5e-3).expect("meshes")
    }

    fn patch(pair: &GearPair, phase: f64, count: usize) -> Patch {
        let facing = GapProfile::drawn(pair, phase).expect("flanks that face each other");
        let view = Pose::drawn(pair, phase, facing.primary);
        let extent = Extent {
            minima: 1,
            widened: 0,
            moved: 0,
            halved: 0,
        };
        Patch::new(&view, &facing, 2447.61, count, extent)
    }

    #[test]
    fn no_cell_is_a_sliver_as_a_kink_passes_the_end_of_a_stretch() {
        let mut data = paper_gear(50);
        data.modifications = vec![ModificationData::TipRelief(ReliefData {
            amount: 8e-6,
            shape: ReliefShape::Linear,
            start: ReliefStart::RadialLength(1e-3),
        })];
        let gear = || SpurGear::new(data.clone()).expect("the relieved gear");
        let pair = GearPair::new(gear(), gear(), 100.5e-3).expect("meshes");
        for i in 0..2000 {
            let phase = -0.8 + 8e-4 * f64::from(i);
            let Some(facing) = GapProfile::drawn(&pair, phase) else {
                continue;
            };
            let view = Pose::drawn(&pair, phase, facing.primary);
            let extent = Extent {
                minima: facing.minima.len(),
                widened: 1,
                moved: 0,
                halved: 0,
            };
            let patch = Patch::new(&view, &facing, 2447.61, 8, extent);
            // Cells at the ends of the flanks excepted.
            let widths: Vec<f64> = patch.cells.iter().map(|cell| cell.width).collect();
            for near in widths.windows(3) {
                let narrow = near[1] / near[0].min(near[2]);
                assert!(narrow >= 0.19, "{phase}: {near:?}");
            }
        }
    }

    #[test]
    fn conjugate_flanks_touch_on_the_line_of_action_with_arm_one() {
        let pair = pair();
        for phase in [0.0, 0.3, -0.7, -0.3, -0.25] {
            let patch = patch(&pair, phase, 40);
            let s = pair.roll_length_of(phase);
            // At x beside the line of action both normals are turned against each other by x (1/s_1 + 1/s_2): half of that
            // tilts the force, whose arm then differs by s_2 times it.
            let other = pair.line_of_action() - s;
            let width = patch.cells[0].width;
            let tilt = 20.0 * width * (1.0 / s + 1.0 / other) / 2.0;
            let most = 1.1 * tilt * other / pair.driven().base_radius();
            let arms = patch.cells.iter().map(|cell| cell.arms[1]);
            assert!(arms.into_iter().all(|arm| (arm - 1.0).abs() < most));
            let nearest = patch
                .cells
                .iter()
                .min_by(|a, b| a.gap.total_cmp(&b.gap))
                .expect("cells");
            // Half a cell beside it: along a roll length a cell is r_b/s of its width.
            let cell = width * pair.driving().base_radius() / s.min(pair.line_of_action() - s);
            assert!((nearest.roll_lengths[0] - s).abs() < 0.51 * cell);
            let sum = nearest.roll_lengths[0] + nearest.roll_lengths[1];
            assert!((sum - pair.line_of_action()).abs() < cell);
        }
    }

    #[test]
    fn the_gap_beside_the_contact_is_the_parabola_of_the_relative_curvature() {
        let patch = patch(&pair(), 0.2, 41);
        let (center, end) = (patch.cells[20], patch.cells[36]);
        let x = 16.0 * center.width;
        let curvature = 1.0 / center.roll_lengths[0] + 1.0 / center.roll_lengths[1];
        assert!(
            ((end.gap - center.gap) / (x * x / 2.0 * curvature) - 1.0).abs() < 0.03,
            "third-order terms are x/ρ"
        );
    }

    #[test]
    fn past_the_path_of_contact_the_patch_ends_at_the_tip_corner_of_either_gear() {
        let pair = pair();
        let (s_a, s_e) = pair.path_of_contact();
        let periods = |s: f64| (s - pair.pitch_roll_length()) / pair.base_pitch();
        for (eta, primary) in [
            (periods(s_a) - 0.1, Member::Driven),
            (periods(s_e) + 0.1, Member::Driving),
        ] {
            let patch = patch(&pair, eta, 40);
            assert!(patch.off_path && patch.primary == primary);
            assert_eq!(patch.ends, [None, Some(RangeEnd::Tip)]);
            let last = patch.cells.last().expect("cells");
            assert!(patch.cells.iter().all(|cell| cell.gap >= last.gap));
        }
    }

    #[test]
    fn a_contact_is_as_wide_as_hertz_or_as_the_tilted_corner_has_it() {
        let (indentation, radius) = (7e-7, 9e-3);
        let hertz = (2.0_f64 * indentation * radius).sqrt();
        assert!((contact_width(indentation, radius, 0.0) / hertz - 1.0).abs() < 1e-14);
        // At an angle where the parabola is small beside the tilt: their ratio is L/(ρ σ) = 1.6e-4.
        let tilted = contact_width(indentation, radius, 1.0);
        assert!((tilted / (2.0 * indentation) - 1.0).abs() < 2e-4);
    }
}
