//! Where a block stands: turned, mirrored and moved, and never another size.

use meshwright_engine::gear::{Side, Vector};

use super::file::{Entity, code};
use super::shape::is_seen_from_below;

/// The scale of a block may be off by so much from 1: the digits of a file.
const DIGITS: f64 = 1e-9;

/// A motion of the plane, which may turn it over.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    /// Where the units along x and y come to lie, and the origin.
    along: [Vector; 2],
    origin: Vector,
}

impl Motion {
    /// Brings `center` to the origin.
    pub(super) fn to_origin(center: Vector) -> Self {
        Self {
            along: [Vector::new(1.0, 0.0), Vector::new(0.0, 1.0)],
            origin: -center,
        }
    }

    fn direction(&self, way: Vector) -> Vector {
        self.along[0] * way.x + self.along[1] * way.y
    }

    fn point(&self, at: Vector) -> Vector {
        self.origin + self.direction(at)
    }

    /// A side where it stands.
    pub(super) fn side(&self, side: &Side) -> Side {
        let [x, y] = self.along;
        let bulge = if x.x * y.y - x.y * y.x < 0.0 {
            -side.bulge
        } else {
            side.bulge
        };
        Side::new(self.point(side.from), self.point(side.to), bulge)
    }

    /// This motion after another one.
    fn after(&self, first: &Self) -> Self {
        Self {
            along: first.along.map(|way| self.direction(way)),
            origin: self.point(first.origin),
        }
    }
}

/// The places in which a block stands.
pub(super) struct Places {
    /// Its motion in the first column and row.
    first: Motion,
    /// From column to column and from row to row, and how many there are.
    steps: [(Vector, u32); 2],
    /// Its scales along x and y, if one of them is not 1.
    pub(super) scales: Option<[f64; 2]>,
}

impl Places {
    /// Pieces of `insert`, of the block that `head` begins. `outer` is the motion of the insert's own block.
    ///
    /// # Errors
    ///
    /// The end of a sentence, if a group is no number, or if its plane is not that of the drawing.
    pub(super) fn of(
        insert: &Entity<'_>,
        head: &Entity<'_>,
        outer: &Motion,
    ) -> Result<Self, String> {
        let number = |code: i32| insert.number(code, Some(0.0));
        let [sx, sy] = code::SCALES.map(|code| insert.number(code, Some(1.0)));
        let (sx, sy) = (sx?, sy?);
        let is_size = |scale: f64| (scale.abs() - 1.0).abs() <= DIGITS;
        let angle = number(code::ROTATION)?.to_radians();
        let (sin, cos) = angle.sin_cos();
        // From below, x runs the other way.
        let over = if is_seen_from_below(insert)? {
            -1.0
        } else {
            1.0
        };
        let plane = Motion {
            along: [Vector::new(over * cos, sin), Vector::new(over * -sin, cos)],
            origin: Vector::new(over * number(code::X)?, number(code::Y)?),
        };
        let [base_x, base_y] = [code::X, code::Y].map(|code| head.number(code, Some(0.0)));
        let (x, y) = (sx.signum(), sy.signum());
        let block = Motion {
            along: [Vector::new(x, 0.0), Vector::new(0.0, y)],
            origin: -Vector::new(x * base_x?, y * base_y?),
        };
        let plane = outer.after(&plane);
        let [columns, rows] = code::COUNTS.map(|code| u32::from(insert.flags(code)).max(1));
        let [dx, dy] = code::SPACINGS.map(number);
        Ok(Self {
            first: plane.after(&block),
            steps: [
                (plane.direction(Vector::new(dx?, 0.0)), columns),
                (plane.direction(Vector::new(0.0, dy?)), rows),
            ],
            scales: (!is_size(sx) || !is_size(sy)).then_some([sx, sy]),
        })
    }

    /// The motion of the block in each of its places.
    pub(super) fn motions(&self) -> impl Iterator<Item = Motion> {
        let Self { first, steps, .. } = self;
        let [(dx, columns), (dy, rows)] = *steps;
        (0..rows).flat_map(move |row| {
            (0..columns).map(move |column| Motion {
                origin: first.origin + f64::from(column) * dx + f64::from(row) * dy,
                ..*first
            })
        })
    }
}
