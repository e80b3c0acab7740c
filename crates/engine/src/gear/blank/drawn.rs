//! Regions bounded by closed curves of a drawing: openings, and circles about the axis.

use std::f64::consts::TAU;

use super::contour::{Contour, ContourFault, SAME, Side, check, merged};
use super::hole::{Hole, HoleShape};
use super::moments::Moments;
use crate::gear::Vector;

/// The same for a circle about the axis, which a drawing may tell to six digits.
const DRAWN: f64 = 1e-6;

/// A region bounded by a closed curve, with the material on its left.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawn {
    /// An opening.
    Opening(Hole),
    /// A circle about the axis.
    Circle {
        /// Its radius.
        radius: f64,
        /// True if the material is inside of it: a bore has it outside.
        is_inside: bool,
    },
}

impl Contour {
    /// The opening inside of `sides`, each of which begins where the one before it ends, the first where the last ends. Sides of one line or of one
    /// circle become one; a circle is a round hole, and a kidney along a circle about the axis a slot.
    ///
    /// # Errors
    ///
    /// [`ContourFault`].
    pub fn opening(sides: &[Side]) -> Result<Hole, ContourFault> {
        check(sides)?;
        let sides = merged(sides);
        if let Some(hole) = round(&sides).or_else(|| slot(&sides)) {
            return Ok(hole);
        }
        let moments: Moments = sides.iter().map(Side::moments).sum();
        let center = moments.first / moments.area;
        let angle = center.y.atan2(center.x);
        let mut sides: Vec<Side> = sides.iter().map(|side| side.turned(-angle)).collect();
        let first = (0..sides.len())
            .min_by(|i, j| {
                let seen = |i: usize| {
                    let arm = sides[i].from - Vector::new(center.norm(), 0.0);
                    // A corner straight outside may be seen just behind.
                    (arm.y.atan2(arm.x) + 1e-6).rem_euclid(TAU)
                };
                seen(*i).total_cmp(&seen(*j))
            })
            .unwrap_or(0);
        sides.rotate_left(first);
        Ok(Hole {
            circle_radius: center.norm(),
            angle,
            shape: HoleShape::Contour(Self(sides.into())),
        })
    }

    /// The region bounded by `sides`, which run with the material on their left: clockwise around an opening.
    ///
    /// # Errors
    ///
    /// [`ContourFault`]: [`ContourFault::Clockwise`] of an opening that runs counter-clockwise.
    pub fn drawn(sides: &[Side]) -> Result<Drawn, ContourFault> {
        if let Some(first) = sides.first() {
            let alike = |side: &Side| {
                side.bulge * first.bulge > 0.0
                    && side.center.norm() <= DRAWN * first.radius
                    && (side.radius - first.radius).abs() <= DRAWN * first.radius
            };
            let turns: f64 = sides.iter().map(Side::turn).sum();
            if sides.iter().all(alike) && (turns.abs() - TAU).abs() < DRAWN {
                return Ok(Drawn::Circle {
                    radius: first.radius,
                    is_inside: turns > 0.0,
                });
            }
        }
        let backward: Vec<Side> = sides.iter().rev().map(Side::reversed).collect();
        let count = sides.len();
        let side = |i: usize| count - 1 - i;
        Self::opening(&backward)
            .map(Drawn::Opening)
            .map_err(|fault| match fault {
                ContourFault::NoLength { side: i } => ContourFault::NoLength { side: side(i) },
                ContourFault::Crosses { sides: [a, b] } => ContourFault::Crosses {
                    sides: [side(b), side(a)],
                },
                // Side i began where the one before it ended.
                ContourFault::TooSharp { corner } => ContourFault::TooSharp {
                    corner: (count - corner) % count,
                },
                other => other,
            })
    }
}

/// A circle as a round hole.
fn round(sides: &[Side]) -> Option<Hole> {
    let [one, other] = sides else { return None };
    let center = one.center;
    let is_circle = one.bulge > 0.0
        && other.bulge > 0.0
        && (center - other.center).norm() <= SAME * one.radius
        && (one.radius - other.radius).abs() <= SAME * one.radius;
    is_circle.then(|| Hole {
        circle_radius: center.norm(),
        angle: center.y.atan2(center.x),
        shape: HoleShape::Round { radius: one.radius },
    })
}

/// Two arcs about the axis between half circles as a slot.
fn slot(sides: &[Side]) -> Option<Hole> {
    let about_axis = |side: &Side| side.bulge != 0.0 && side.center.norm() <= SAME * side.radius;
    if sides.len() != 4 {
        return None;
    }
    let outer = sides
        .iter()
        .position(|side| about_axis(side) && side.bulge > 0.0)?;
    let [outer, end, inner, other] = [0, 1, 2, 3].map(|k| &sides[(outer + k) % 4]);
    let width = outer.radius - inner.radius;
    let half_circle = |side: &Side| {
        side.bulge > 0.0
            && (side.radius - width / 2.0).abs() <= SAME * width
            && (side.bulge - 1.0).abs() <= SAME
    };
    let is_slot = about_axis(inner) && inner.bulge < 0.0 && half_circle(end) && half_circle(other);
    is_slot.then(|| {
        let middle = outer.middle();
        Hole {
            circle_radius: f64::midpoint(outer.radius, inner.radius),
            angle: middle.y.atan2(middle.x),
            shape: HoleShape::Slot {
                width,
                angle: outer.turn(),
            },
        }
    })
}
