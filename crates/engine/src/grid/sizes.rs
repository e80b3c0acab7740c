//! Sizes of the triangles of a whole blank, place by place.

use super::outline::Outline;
use crate::gear::{Side, Vector};

/// The growth of sizes away from a boundary, per length: that of the structured blank.
const GROWTH: f64 = 0.35;
/// The largest size, as a part of the distance from the axis: twice that of the structured blank along the radius at the
/// standard level, since these are the sizes of the coarse one.
const LARGEST: f64 = 0.24;
/// The size between two boundaries, as a part of the way from one to the other: two and a half triangles at the coarse level,
/// five at the standard one.
const OF_LIGAMENT: f64 = 0.4;
/// The least size, as a part of the interface radius, whatever is asked: finer than any ligament that a gear may have, and
/// reached only next to it.
const LEAST: f64 = 2e-4;
/// Samples of the size along a curve, per element of its own size.
const SAMPLES: f64 = 8.0;

/// How much of an element sizes may be exceeded by in all, so that blanks that differ by rounding have equal grids.
const SPARE: f64 = 1e-3;

/// A boundary and the size of the triangles along it.
#[derive(Debug, Clone)]
pub(super) struct Boundary {
    /// The curve.
    pub(super) outline: Outline,
    /// The size along it at the coarse level; infinite where it asks for none.
    pub(super) size: f64,
    /// True if it goes around the material; false for an opening within.
    pub(super) around: bool,
    /// Parts of the curve that ask for a smaller size, and which.
    details: Vec<(Side, f64)>,
    /// The least size that it asks for.
    pub(super) least_size: f64,
    /// Center and radius of a circle around all of a curve that has sides of its own.
    circle: Option<(Vector, f64)>,
}

impl Boundary {
    /// Sizes about `outline`, along which triangles have `size`, and where it has details the sizes that these ask for.
    pub(super) fn new(
        outline: Outline,
        size: f64,
        around: bool,
        details: Vec<(Side, f64)>,
    ) -> Self {
        let sizes = details.iter().map(|(_, size)| *size);
        Self {
            least_size: sizes.fold(size, f64::min),
            circle: outline.circle_around(),
            outline,
            size,
            around,
            details,
        }
    }

    /// How far off it `point` stands at least, as far as that is seen without a look at its sides.
    fn least_distance(&self, point: Vector) -> f64 {
        let off = |(center, radius): (Vector, f64)| (point - center).norm() - radius;
        self.circle.map_or(f64::NEG_INFINITY, off)
    }

    /// How far within the material `point` stands of it.
    fn clearance(&self, point: Vector) -> f64 {
        let distance = self.outline.distance(point);
        if self.around { -distance } else { distance }
    }

    /// The size that it asks for at `point`, so far off it, where that is less than `size`.
    fn asks(&self, point: Vector, distance: f64, size: f64) -> f64 {
        let size = size.min(self.size + GROWTH * distance);
        // Details are parts of the curve, and no nearer.
        if self.least_size + GROWTH * distance >= size {
            return size;
        }
        let details = self.details.iter();
        let sizes = details.map(|(side, size)| size + GROWTH * side.distance_to(point));
        sizes.fold(size, f64::min)
    }
}

/// The size of triangles at the coarse level, all over a blank of interface radius 1.
#[derive(Debug)]
pub(super) struct Sizes {
    /// Every boundary of the material.
    pub(super) boundaries: Vec<Boundary>,
    /// Factor of all sizes.
    pub(super) scale: f64,
}

impl Sizes {
    /// The size at `point`: 1-Lipschitz, so that neighboring triangles are of similar size.
    pub(super) fn at(&self, point: Vector) -> f64 {
        let mut size = LARGEST * point.norm();
        let (mut nearest, mut second) = (f64::INFINITY, f64::INFINITY);
        for boundary in &self.boundaries {
            let least = boundary.least_distance(point);
            if least >= second && boundary.least_size + GROWTH * least >= size {
                continue;
            }
            let distance = boundary.clearance(point).abs();
            size = boundary.asks(point, distance, size);
            second = second.min(distance.max(nearest));
            if distance < nearest {
                nearest = distance;
                second = second.min(boundary.outline.distance_across(point));
            }
        }
        (self.scale * size.min(OF_LIGAMENT * (nearest + second))).max(LEAST)
    }

    /// True if `point` stands within the material by `margin`.
    pub(super) fn is_inside(&self, point: Vector, margin: f64) -> bool {
        self.boundaries.iter().all(|boundary| {
            boundary.least_distance(point) >= margin || boundary.clearance(point) >= margin
        })
    }

    /// The lengths along `outline` that divide it into elements of these sizes, from 0 up to but without its whole length:
    /// at least `least` of them, and those of `through`, which rise.
    pub(super) fn divide(
        &self,
        outline: &Outline,
        own_size: f64,
        least: usize,
        through: &[f64],
    ) -> Vec<f64> {
        let whole = outline.length();
        let samples = (SAMPLES * whole / own_size.min(whole / least as f64)).ceil() as usize;
        let step = whole / samples as f64;
        // The number of elements up to each sample.
        let mut counts = vec![0.0];
        for i in 0..samples {
            let middle = outline.point(step * (i as f64 + 0.5));
            counts.push(counts[i] + step / self.at(middle));
        }
        let scale = (least as f64 / counts[samples]).max(1.0);
        let count_to = |length: f64| {
            let before = ((length / step) as usize).min(samples - 1);
            let part = length / step - before as f64;
            scale * (counts[before] + part * (counts[before + 1] - counts[before]))
        };
        let length_at = |count: f64| {
            let count = count / scale;
            let after = counts.partition_point(|c| *c <= count).clamp(1, samples);
            let (low, high) = (counts[after - 1], counts[after]);
            step * ((after - 1) as f64 + (count - low) / (high - low))
        };
        let mut lengths = Vec::new();
        let starts = std::iter::once(0.0).chain(through.iter().copied());
        let ends = through.iter().copied().chain([whole]);
        for (from, to) in starts.zip(ends) {
            let (first, last) = (count_to(from), count_to(to));
            let count = ((last - first - SPARE).ceil()).max(1.0);
            lengths.push(from);
            let inner = (1..count as usize).map(|i| first + (last - first) * i as f64 / count);
            lengths.extend(inner.map(length_at));
        }
        lengths
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring() -> Sizes {
        let boundary = |radius, size, around| {
            Boundary::new(Outline::Circle { radius }, size, around, Vec::new())
        };
        Sizes {
            boundaries: vec![boundary(1.0, 0.06, true), boundary(0.3, 0.1, false)],
            scale: 1.0,
        }
    }

    #[test]
    fn sizes_change_no_faster_than_places() {
        let sizes = ring();
        for i in 0..2000 {
            let at = |i: i32| Vector::new(0.3 + 0.35e-3 * f64::from(i), 1e-4 * f64::from(i));
            let (p, q) = (at(i), at(i + 1));
            assert!((sizes.at(p) - sizes.at(q)).abs() <= (p - q).norm());
        }
        assert!(sizes.is_inside(Vector::new(0.5, 0.0), 0.19));
        assert!(!sizes.is_inside(Vector::new(0.5, 0.0), 0.21));
        assert!(!sizes.is_inside(Vector::new(0.2, 0.0), 0.0));
    }

    #[test]
    fn a_division_goes_through_the_points_asked_for_in_elements_no_larger_than_their_size() {
        let sizes = ring();
        let outline = Outline::Circle { radius: 0.3 };
        let lengths = sizes.divide(&outline, 0.1, 12, &[0.5, 1.3]);
        assert!(lengths.contains(&0.5) && lengths.contains(&1.3) && lengths[0] == 0.0);
        assert!(
            lengths
                .windows(2)
                .all(|s| s[0] < s[1] && s[1] - s[0] < 0.101)
        );
        assert!(*lengths.last().expect("some") < outline.length());
    }
}
