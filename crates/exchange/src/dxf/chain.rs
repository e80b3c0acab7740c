//! Closed loops of lines and arcs that are drawn in any order and direction.

use std::collections::HashMap;

use meshwright_engine::gear::{Side, Vector};

/// A line or an arc, and the entity that it is of.
#[derive(Debug)]
pub(super) struct Piece {
    pub(super) side: Side,
    pub(super) entity: usize,
}

/// The ends of pieces, twice as many: piece i begins at end 2 i and ends at the next.
struct Ends {
    points: Vec<Vector>,
    /// Those in each cell of a square lattice.
    cells: HashMap<[i64; 2], Vec<usize>>,
    /// The width of a cell, within which ends meet.
    within: f64,
}

/// What prevents loops.
pub(super) enum Open {
    /// Nothing meets the end `at` of an entity. The nearest end that meets none either, with its entity, is so far off.
    End {
        entity: usize,
        at: Vector,
        nearest: Option<(usize, f64)>,
    },
    /// More than two ends meet.
    Branch { entities: Vec<usize>, at: Vector },
}

/// A closed loop, each side of which begins exactly where the one before it ends.
pub(super) struct Loop {
    pub(super) sides: Vec<Side>,
    /// The entity of its first side.
    pub(super) entity: usize,
}

/// Closed loops of all `pieces`, each longer than `within`, the distance within which ends meet.
///
/// # Errors
///
/// The ends that meet no other or more than one, at most `most` of them.
pub(super) fn loops(pieces: &[Piece], within: f64, most: usize) -> Result<Vec<Loop>, Vec<Open>> {
    let ends = Ends::new(pieces, within);
    let count = ends.points.len();
    let mut mates: Vec<usize> = Vec::with_capacity(count);
    let (mut alone, mut branches) = (Vec::new(), Vec::<Open>::new());
    for end in 0..count {
        let found = ends.mates(end);
        mates.extend(found.first());
        match found.as_slice() {
            [_] => {}
            [] => alone.push(end),
            _ => {
                let point = ends.points[end];
                let is_told = |open: &Open| matches!(open, Open::Branch { at, .. } if (at - point).norm() <= 2.0 * within);
                if branches.len() < most && !branches.iter().any(is_told) {
                    let all = [end].into_iter().chain(found);
                    branches.push(Open::Branch {
                        entities: all.map(|end| pieces[end / 2].entity).collect(),
                        at: point,
                    });
                }
            }
        }
    }
    let left = most - branches.len();
    let open = alone
        .iter()
        .take(left)
        .map(|end| ends.open(pieces, *end, &alone));
    let open: Vec<Open> = branches.into_iter().chain(open).collect();
    if !open.is_empty() {
        return Err(open);
    }
    let mut is_taken = vec![false; pieces.len()];
    let mut loops = Vec::new();
    for (start, first) in pieces.iter().enumerate() {
        let (mut end, mut sides) = (2 * start, Vec::new());
        while !is_taken[end / 2] {
            is_taken[end / 2] = true;
            let side = pieces[end / 2].side;
            sides.push(if end.is_multiple_of(2) {
                side
            } else {
                side.reversed()
            });
            end = mates[end ^ 1];
        }
        let Some(last) = sides.last() else {
            continue;
        };
        let mut from = last.to;
        for side in &mut sides {
            *side = Side::new(from, side.to, side.bulge);
            from = side.to;
        }
        loops.push(Loop {
            sides,
            entity: first.entity,
        });
    }
    Ok(loops)
}

impl Ends {
    fn new(pieces: &[Piece], within: f64) -> Self {
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
        [point.x, point.y].map(|x| (x / self.within).floor() as i64)
    }

    /// The other ends that meet `end`, three of them at most.
    fn mates(&self, end: usize) -> Vec<usize> {
        let point = self.points[end];
        let [x, y] = self.cell(point);
        let cells = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]));
        cells
            .filter_map(|cell| self.cells.get(&cell))
            .flatten()
            .copied()
            .filter(|other| *other != end && (self.points[*other] - point).norm() <= self.within)
            .take(3)
            .collect()
    }

    /// That `end` meets none, as all of `alone`.
    fn open(&self, pieces: &[Piece], end: usize, alone: &[usize]) -> Open {
        let at = self.points[end];
        let others = alone.iter().filter(|other| **other != end);
        let nearest = others
            .map(|other| (pieces[other / 2].entity, (self.points[*other] - at).norm()))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        Open::End {
            entity: pieces[end / 2].entity,
            at,
            nearest,
        }
    }
}
