//! Number of times that a blank repeats around its axis.

use std::f64::consts::TAU;

use super::hole::{Hole, HoleShape, wrapped};
use super::{BlankRegion, HolePattern};
use crate::gear::gcd;

/// Differences of holes that still count as equal: as a part of the radius of their circle for lengths, in radians for angles.
const ALIKE: f64 = 1e-12;
/// Differences of holes of a drawing that are still meant as equal, likewise: its coordinates have six or more digits.
const DRAWN: f64 = 1e-6;
/// The same in units of the last decimal of its coordinates, each of which is rounded by up to half a unit: a corner is off by 0.7 units, and so is the middle of its
/// opening, by which it is compared with another.
const UNITS: f64 = 3.0;

/// Differences of holes that still count as equal.
#[derive(Debug, Clone, Copy)]
struct Slack {
    /// As a part of the radius of their circle, and in radians.
    relative: f64,
    /// In meters.
    length: f64,
}

impl Slack {
    /// Tolerance of holes that are computed.
    const ROUNDING: Self = Self {
        relative: ALIKE,
        length: 0.0,
    };

    /// Tolerance of holes of a drawing whose coordinates have decimals of `unit`, in meters.
    fn of_drawing(unit: f64) -> Self {
        Self {
            relative: DRAWN,
            length: UNITS * unit,
        }
    }

    /// As a part of the radius of the circle of `hole`.
    fn at(&self, hole: &Hole) -> f64 {
        self.relative.max(self.length / hole.circle_radius)
    }
}

/// The turns that map a blank onto itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symmetry {
    /// The largest N such that a turn by 2π/N maps the blank onto itself; 0 without holes, where every turn does.
    pub count: u32,
    /// The holes that such a turn takes to one another, by their places in the list, in the order of the turns: one orbit
    /// for each hole of a sector.
    pub orbits: Vec<Vec<usize>>,
}

impl BlankRegion {
    /// The symmetry of the blank, to rounding.
    pub fn symmetry(&self) -> Symmetry {
        let classes = self.classes(Slack::ROUNDING);
        // Each class is taken to itself, so that the number of its holes is a multiple of N.
        let most = classes
            .iter()
            .fold(0, |most, class| gcd(most, class.len() as u32));
        let orbits_of = |count: u32| -> Option<Vec<Vec<usize>>> {
            let orbits = classes
                .iter()
                .map(|class| self.orbits(class, count, Slack::ROUNDING));
            Some(orbits.collect::<Option<Vec<_>>>()?.concat())
        };
        (1..=most)
            .rev()
            .filter(|count| most.is_multiple_of(*count))
            .find_map(|count| orbits_of(count).map(|orbits| Symmetry { count, orbits }))
            .unwrap_or(Symmetry {
                count: 0,
                orbits: Vec::new(),
            })
    }

    /// The holes as one pattern of equal round holes, equally spaced, with the first of the list as hole 0; `None` if they
    /// are none.
    pub fn pattern(&self) -> Option<HolePattern> {
        let Symmetry { count, orbits } = self.symmetry();
        let first = self.holes.first()?;
        let alone = orbits.len() == 1 && first.contour().is_none() && first.span() <= ALIKE;
        alone.then(|| HolePattern {
            count,
            circle_radius: first.circle_radius,
            radius: first.half_width(),
            phase: first.angle,
        })
    }

    /// The same blank with holes that are equal and equally spaced to within the digits of a drawing made so to the last digit: a hole stands by the first of its kind.
    /// `unit` is the last decimal of the drawing's coordinates, in meters.
    pub fn evened(mut self, unit: f64) -> Self {
        let slack = Slack::of_drawing(unit);
        for class in self.classes(slack) {
            let most = class.len() as u32;
            let counts = (2..=most).rev().filter(|count| most.is_multiple_of(*count));
            let even = counts
                .map(|count| (count, self.orbits(&class, count, slack)))
                .find_map(|(count, orbits)| Some((count, orbits?)));
            let Some((count, orbits)) = even else {
                continue;
            };
            for orbit in orbits {
                let first = self.holes[orbit[0]].clone();
                for (k, &hole) in orbit.iter().enumerate() {
                    self.holes[hole] = Hole {
                        angle: first.angle + TAU * k as f64 / f64::from(count),
                        circle_radius: first.circle_radius,
                        shape: self.holes[class[0]].shape.clone(),
                    };
                }
            }
        }
        self
    }

    /// The angle of hole 0 of a pattern; 0 for any other blank.
    pub fn phase(&self) -> f64 {
        self.pattern().map_or(0.0, |pattern| pattern.phase)
    }

    /// The holes that are equal but for their angle, to within `slack`.
    fn classes(&self, slack: Slack) -> Vec<Vec<usize>> {
        let mut classes: Vec<Vec<usize>> = Vec::new();
        for (i, hole) in self.holes.iter().enumerate() {
            match classes
                .iter_mut()
                .find(|class| alike(&self.holes[class[0]], hole, slack))
            {
                Some(class) => class.push(i),
                None => classes.push(vec![i]),
            }
        }
        classes
    }

    /// The orbits of `class` under a turn by 2π/`count`; `None` if the turn takes a hole to where there is none.
    fn orbits(&self, class: &[usize], count: u32, slack: Slack) -> Option<Vec<Vec<usize>>> {
        let turn = TAU / f64::from(count);
        let mut left = class.to_vec();
        let mut orbits = Vec::new();
        while let Some(&first) = left.first() {
            let slack = slack.at(&self.holes[first]);
            let mut orbit = Vec::new();
            for k in 0..count {
                let angle = self.holes[first].angle + f64::from(k) * turn;
                let here = |&i: &usize| wrapped(self.holes[i].angle - angle).abs() <= slack;
                let place = left.iter().position(here)?;
                orbit.push(left.remove(place));
            }
            orbits.push(orbit);
        }
        Some(orbits)
    }
}

/// True if two holes are equal but for their angle; a slot of no angle is a round hole.
fn alike(one: &Hole, other: &Hole, slack: Slack) -> bool {
    let slack = slack.at(one);
    let near = |a: f64, b: f64| (a - b).abs() <= slack * one.circle_radius;
    near(one.circle_radius, other.circle_radius)
        && near(one.half_width(), other.half_width())
        && (one.span() - other.span()).abs() <= slack
        && match (one.contour(), other.contour()) {
            (None, None) => true,
            (Some(a), Some(b)) => a.is_like(b, slack * one.circle_radius),
            _ => false,
        }
}

impl HoleShape {
    /// The shape by its simplest name: a slot of no angle is round.
    pub fn simplest(self) -> Self {
        match self {
            Self::Slot { width, angle } if angle <= ALIKE => Self::Round {
                radius: width / 2.0,
            },
            shape => shape,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::Core;

    fn pattern(count: u32, circle_radius: f64, radius: f64, phase: f64) -> HolePattern {
        HolePattern {
            count,
            circle_radius,
            radius,
            phase,
        }
    }

    fn region(patterns: &[HolePattern]) -> BlankRegion {
        BlankRegion {
            bore_radius: 10e-3,
            core: Core::Bore,
            holes: patterns.iter().flat_map(HolePattern::holes).collect(),
            web: None,
        }
    }

    #[test]
    fn equal_holes_in_any_order_are_the_pattern() {
        for count in [1, 2, 3, 7, 8, 60] {
            let drawn = pattern(count, 30e-3, 1e-3, 0.4);
            let mut region = BlankRegion::with_pattern(10e-3, drawn);
            assert_eq!(region.pattern(), Some(drawn));
            region.holes[1..].reverse();
            // Degrees and whole turns leave roundings.
            for hole in &mut region.holes[1..] {
                hole.angle = (hole.angle.to_degrees() + 720.0).to_radians();
            }
            assert_eq!(region.pattern(), Some(drawn));
            assert_eq!(region.symmetry().count, count);
        }
    }

    #[test]
    fn a_slot_of_no_angle_is_a_round_hole_of_the_pattern() {
        let mut region = region(&[pattern(6, 30e-3, 4e-3, 0.1)]);
        let shape = HoleShape::Slot {
            width: 8e-3,
            angle: 0.0,
        };
        region.holes[2].shape = shape.clone();
        assert_eq!(region.pattern(), Some(pattern(6, 30e-3, 4e-3, 0.1)));
        assert_eq!(shape.simplest(), HoleShape::Round { radius: 4e-3 });
    }

    #[test]
    fn several_circles_repeat_as_often_as_all_of_them_do() {
        let two = region(&[pattern(6, 30e-3, 3e-3, 0.1), pattern(9, 20e-3, 2e-3, 0.7)]);
        let symmetry = two.symmetry();
        assert_eq!((symmetry.count, symmetry.orbits.len()), (3, 2 + 3));
        assert_eq!(symmetry.orbits[0], [0, 2, 4]);
        assert_eq!(two.pattern(), None);
        // Two rings of four on one circle, not an eighth of a turn apart.
        let paired = region(&[pattern(4, 30e-3, 3e-3, 0.0), pattern(4, 30e-3, 3e-3, 0.5)]);
        assert_eq!(
            (paired.symmetry().count, paired.symmetry().orbits.len()),
            (4, 2)
        );
    }

    #[test]
    fn unequal_holes_or_spacings_do_not_repeat() {
        let mut uneven = region(&[pattern(4, 30e-3, 5e-3, 0.0)]);
        uneven.holes[1].angle += 1e-9;
        assert_eq!((uneven.symmetry().count, uneven.pattern()), (1, None));
        let mut unequal = region(&[pattern(4, 30e-3, 5e-3, 0.0)]);
        unequal.holes[2].shape = HoleShape::Round { radius: 5.001e-3 };
        assert_eq!(
            (unequal.symmetry().count, unequal.symmetry().orbits.len()),
            (1, 4)
        );
        assert_eq!(
            region(&[]).symmetry().count,
            0,
            "a solid blank repeats at every angle"
        );
    }

    #[test]
    fn holes_that_are_equal_to_the_digits_of_a_drawing_repeat() {
        let drawn = pattern(7, 30e-3, 3e-3, 0.2);
        let mut region = region(&[drawn]);
        for (i, hole) in region.holes.iter_mut().enumerate() {
            hole.angle += 4e-7 * (i as f64).sin();
            hole.circle_radius *= 1.0 + 1e-7 * i as f64;
        }
        assert_eq!(region.symmetry().count, 1);
        let evened = region.clone().evened(1e-9);
        assert_eq!(evened.pattern(), Some(drawn));
        assert_eq!(evened.clone().evened(1e-9), evened);
        region.holes[3].angle += 1e-5;
        assert_eq!(region.clone().evened(1e-9), region);
        // Of a drawing with three decimals of a millimeter that is a third of a micrometer.
        assert_eq!(region.evened(1e-6).pattern(), Some(drawn));
    }

    #[test]
    fn slots_repeat_with_their_number_but_are_no_pattern_of_round_holes() {
        let mut slots = region(&[pattern(5, 30e-3, 3e-3, 0.2)]);
        for hole in &mut slots.holes {
            hole.shape = HoleShape::Slot {
                width: 6e-3,
                angle: 0.4,
            };
        }
        assert_eq!((slots.symmetry().count, slots.pattern()), (5, None));
        let [mut low, mut high] = [f64::INFINITY, 0.0_f64];
        for i in 0..5 {
            let gap = slots.holes[i].ligament_to(&slots.holes[(i + 1) % 5]);
            (low, high) = (low.min(gap), high.max(gap));
        }
        assert!(low > 0.0 && high - low < 1e-15);
    }
}
