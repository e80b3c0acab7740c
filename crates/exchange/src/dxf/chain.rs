//! Closed loops of lines and arcs that are drawn in any order and direction.

use std::collections::HashMap;

use meshwright_engine::gear::{Side, Vector};

/// Ends no farther apart than this are the same, in mm: the digits of a drawing. Where others are near, these belong together first.
const SAME_MM: f64 = 1e-3;

/// Least distance of ends that are joined, in mm: the rounding of points computed from the angles of an arc and of a line.
const LEAST_MM: f64 = 1e-6;

/// Ends near an end beyond this number are not looked at.
const MOST_NEAR: usize = 200;

/// A line or an arc, and the number of the entity that it is of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) side: Side,
    pub(super) source: usize,
}

/// How far ends may be apart, in the unit of the drawing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Within {
    /// To be joined.
    pub(super) joined: f64,
    /// To be the same.
    pub(super) same: f64,
    /// Not to be worth a word.
    least: f64,
}

impl Within {
    /// Distances of a tolerance in mm.
    pub(super) fn of(tolerance_mm: f64, in_mm: f64) -> Self {
        let joined = tolerance_mm.max(LEAST_MM);
        Self {
            joined: joined / in_mm,
            same: joined.min(SAME_MM) / in_mm,
            least: LEAST_MM / in_mm,
        }
    }
}

/// The ends of pieces, twice as many: piece i begins at end 2 i and ends at the next.
struct Ends {
    points: Vec<Vector>,
    /// Ends in each cell of a square lattice.
    cells: HashMap<[i64; 2], Vec<usize>>,
    within: Within,
}

/// An end, or several, that prevent loops.
#[derive(Debug)]
pub(super) enum Open {
    /// Nothing meets the end `at` of a piece. The nearest end that meets none either, with the entity that it is of, is so far off.
    End {
        piece: usize,
        at: Vector,
        nearest: Option<(usize, f64)>,
    },
    /// More than two ends are near each other.
    Branch { sources: Vec<usize>, at: Vector },
}

/// A closed loop, each side of which begins exactly where the one before it ends.
#[derive(Debug)]
pub(super) struct Loop {
    pub(super) sides: Vec<Side>,
    /// The entities that they are of.
    pub(super) sources: Vec<usize>,
}

/// Loops, and curves that are not part of one.
#[derive(Debug)]
pub(super) struct Chains {
    pub(super) loops: Vec<Loop>,
    /// Ends that meet no other, of pieces that meet others at their other ends.
    pub(super) open: Vec<Open>,
    /// The ends of pieces that meet no others at both ends.
    pub(super) lone: Vec<Open>,
    /// The gaps that were closed: how many, and the largest.
    pub(super) gaps: (usize, f64),
}

/// Chains all `pieces`. Of `open` there are at most `most`.
///
/// # Errors
///
/// Places at which more than two ends are near each other, at most `most` of them.
pub(super) fn chains(pieces: &[Piece], within: Within, most: usize) -> Result<Chains, Vec<Open>> {
    let ends = Ends::new(pieces, within);
    let mates = ends.mates(pieces, most)?;
    let alone: Vec<usize> = (0..mates.len())
        .filter(|end| mates[*end].is_none())
        .collect();
    let (lone, open): (Vec<usize>, Vec<usize>) = alone
        .iter()
        .copied()
        .partition(|end| mates[end ^ 1].is_none());
    let fault = |end: &usize| ends.open(pieces, *end, &alone);
    let mut is_taken = vec![false; pieces.len()];
    for end in &alone {
        let mut next = Some(*end);
        while let Some(end) = next.filter(|end| !is_taken[end / 2]) {
            is_taken[end / 2] = true;
            next = mates[end ^ 1];
        }
    }
    let (mut loops, mut gaps) = (Vec::new(), (0, 0.0_f64));
    for start in 0..pieces.len() {
        let (mut end, mut sides, mut sources) = (2 * start, Vec::new(), Vec::new());
        while !is_taken[end / 2] {
            is_taken[end / 2] = true;
            let Piece { side, source } = pieces[end / 2];
            sources.push(source);
            sides.push(if end.is_multiple_of(2) {
                side
            } else {
                side.reversed()
            });
            let Some(next) = mates[end ^ 1] else {
                break;
            };
            end = next;
        }
        let Some(last) = sides.last() else {
            continue;
        };
        let mut from = last.to;
        for side in &mut sides {
            let gap = (side.from - from).norm();
            if gap > within.least {
                gaps = (gaps.0 + 1, gaps.1.max(gap));
            }
            *side = Side::new(from, side.to, side.bulge);
            from = side.to;
        }
        // A piece as short as its gaps may be nothing without them.
        sides.retain(|side| side.from != side.to);
        sources.sort_unstable();
        sources.dedup();
        loops.push(Loop { sides, sources });
    }
    Ok(Chains {
        loops,
        open: open.iter().take(most).map(fault).collect(),
        // Two ends of one piece are one fault, and all of these are looked at.
        lone: lone
            .iter()
            .filter(|end| end.is_multiple_of(2))
            .enumerate()
            .map(|(i, end)| match i {
                i if i < most => fault(end),
                _ => Open::End {
                    piece: end / 2,
                    at: ends.points[*end],
                    nearest: None,
                },
            })
            .collect(),
        gaps,
    })
}

/// The pieces without those that are drawn twice, and the entities that these are of.
pub(super) fn once(pieces: Vec<Piece>, within: Within) -> (Vec<Piece>, Vec<usize>) {
    let same = within.same;
    let cell = |point: Vector| [point.x, point.y].map(|x| (x / same).floor() as i64);
    let mut middles: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    let (mut kept, mut twice): (Vec<Piece>, Vec<usize>) = (Vec::new(), Vec::new());
    for piece in pieces {
        let side = piece.side;
        // Of pieces as short as this, two that follow each other are near each other.
        let near = same.min(0.25 * side.length());
        let is_near = |a: Vector, b: Vector| (a - b).norm() <= near;
        let is_same = |other: &usize| {
            let other = kept[*other].side;
            let there = is_near(side.from, other.from) && is_near(side.to, other.to);
            let back = is_near(side.from, other.to) && is_near(side.to, other.from);
            (there || back) && is_near(side.middle(), other.middle())
        };
        let [x, y] = cell(side.middle());
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]));
        let mut around = around.filter_map(|cell| middles.get(&cell)).flatten();
        if around.any(is_same) {
            twice.push(piece.source);
        } else {
            middles.entry([x, y]).or_default().push(kept.len());
            kept.push(piece);
        }
    }
    twice.dedup();
    (kept, twice)
}

impl Ends {
    fn new(pieces: &[Piece], within: Within) -> Self {
        let both = |piece: &Piece| [piece.side.from, piece.side.to];
        let mut ends = Self {
            points: pieces.iter().flat_map(both).collect(),
            cells: HashMap::new(),
            within,
        };
        for (end, point) in ends.points.iter().enumerate() {
            let cell = ends.cell(*point);
            ends.cells.entry(cell).or_default().push(end);
        }
        ends
    }

    fn cell(&self, point: Vector) -> [i64; 2] {
        [point.x, point.y].map(|x| (x / self.within.joined).floor() as i64)
    }

    /// The other ends within a distance of `end`.
    fn near(&self, end: usize, distance: f64) -> impl Iterator<Item = usize> {
        let point = self.points[end];
        let [x, y] = self.cell(point);
        let cells = (-1..=1).flat_map(move |i| (-1..=1).map(move |j| [x + i, y + j]));
        cells
            .filter_map(|cell| self.cells.get(&cell))
            .flatten()
            .copied()
            .filter(move |other| *other != end && (self.points[*other] - point).norm() <= distance)
    }

    /// The end that each end meets, if it meets one: the one that is the same, else the one that is near.
    ///
    /// # Errors
    ///
    /// Places at which more than two ends are, at most `most` of them.
    fn mates(&self, pieces: &[Piece], most: usize) -> Result<Vec<Option<usize>>, Vec<Open>> {
        let Within { joined, same, .. } = self.within;
        let count = self.points.len();
        let alike: Vec<Vec<usize>> = (0..count)
            .map(|end| self.near(end, same).take(2).collect())
            .collect();
        let is_free = |end: usize| alike[end].is_empty();
        let mut mates = Vec::with_capacity(count);
        let mut branches: Vec<Open> = Vec::new();
        for end in 0..count {
            let mut others = alike[end].clone();
            if others.len() < 2 {
                // The other end of a piece that is shorter than the gaps is no neighbor.
                let is_short = pieces[end / 2].side.length() <= joined;
                let near = self.near(end, joined).take(MOST_NEAR);
                let near = near.filter(|other| !(is_short && *other == end ^ 1));
                let near: Vec<usize> = near.collect();
                if is_free(end) {
                    others = near;
                } else {
                    others.extend(near.into_iter().filter(|other| is_free(*other)));
                }
            }
            match others.as_slice() {
                [] => mates.push(None),
                [one] => mates.push(Some(*one)),
                _ => {
                    let at = self.points[end];
                    let is_told = |open: &Open| matches!(open, Open::Branch { at: other, .. } if (other - at).norm() <= 2.0 * joined);
                    if branches.len() < most && !branches.iter().any(is_told) {
                        let all = std::iter::once(end).chain(others);
                        branches.push(Open::Branch {
                            sources: all.take(3).map(|end| pieces[end / 2].source).collect(),
                            at,
                        });
                    }
                    mates.push(None);
                }
            }
        }
        if branches.is_empty() {
            Ok(mates)
        } else {
            Err(branches)
        }
    }

    /// That `end` meets none, as all of `alone`.
    fn open(&self, pieces: &[Piece], end: usize, alone: &[usize]) -> Open {
        let at = self.points[end];
        let others = alone.iter().filter(|other| **other != end);
        let nearest = others
            .map(|other| (pieces[other / 2].source, (self.points[*other] - at).norm()))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        Open::End {
            piece: end / 2,
            at,
            nearest,
        }
    }
}
