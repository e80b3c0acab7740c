//! Images of a load beyond both ends of a face.
//!
//! A flank meets a free surface at both ends of its face. Without shear there, and without motion along the axis, a load yields as on a body without ends
//! with further loads of the same size: its images in both ends, the images of those, and so on. Unrolled, the ends of a flank are perpendicular to its
//! contact lines: all images of a point of a contact line stand on that line. Twice the length of the face along the line moves them onto each other.
//!
//! The sum of 1/√(x² + d²) over them has no limit, but its changes have. The constant is chosen so that the mean of both sums, over x from end to end, is
//! that of a line without ends in the plane, −(2/L) ln(d/m). The factor of cos(n π x/L) is K_0(n π d/L), so what varies along the line is positive definite
//! for each d.

/// Images to either side of which the inverse distances are summed one by one.
const DIRECT: i32 = 2;
const MIRRORED: i32 = 3;

/// The images beyond the ends of a face.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Images {
    /// L, the length of the face along a contact line.
    pub(crate) length: f64,
    /// The length over which logarithms are taken.
    pub(crate) module: f64,
}

impl Images {
    /// How far the load itself and the nearest of the images that move onto it stand from a place x on, in order.
    pub(crate) fn direct(&self) -> impl Iterator<Item = f64> + use<> {
        let period = 2.0 * self.length;
        (-DIRECT..=DIRECT).map(move |i| f64::from(i) * period)
    }

    /// The same for the images that are mirrored, x being the sum of the distances of the point and of the load from the middle of the face.
    pub(crate) fn mirrored(&self) -> impl Iterator<Item = f64> + use<> {
        let length = self.length;
        (-MIRRORED..MIRRORED).map(move |i| f64::from(2 * i + 1) * length)
    }

    /// What all other images than [`Images::direct`] add to the sum of 1/√(x² + d²), d being how far they are `beside` the line.
    pub(crate) fn beyond_direct(&self, x: f64, beside: f64) -> f64 {
        self.beyond(f64::from(2 * DIRECT + 1), x, beside)
    }

    /// What all other images than [`Images::mirrored`] add.
    pub(crate) fn beyond_mirrored(&self, x: f64, beside: f64) -> f64 {
        self.beyond(f64::from(2 * MIRRORED), x, beside)
    }

    /// By the formula of Euler and Maclaurin, from so many lengths on to both sides.
    fn beyond(&self, lengths: f64, x: f64, beside: f64) -> f64 {
        let side = |from: f64| {
            let far = from.hypot(beside);
            let even = ((from + far) / self.module).ln() / (2.0 * self.length);
            even + self.length * from / (12.0 * far.powi(3))
        };
        let edge = lengths * self.length;
        -side(edge - x) - side(edge + x)
    }
}

/// The mean of 1/√(x² + d²) over all distances x between two pieces of a line, each so long `along` it, whose middles are so far `apart`; d is `beside`.
pub(crate) fn inverse_in_the_mean(along: f64, apart: f64, beside: f64) -> f64 {
    let [before, at, after] =
        [-along, 0.0, along].map(|further| twice_inverse(apart + further, beside));
    (after - 2.0 * at + before) / (along * along)
}

/// A function of x whose derivative is 1/√(x² + d²), d being `beside`.
pub(crate) fn once_inverse(x: f64, beside: f64) -> f64 {
    (x / beside).asinh()
}

/// A function of x whose second derivative is 1/√(x² + d²), d being `beside`.
pub(crate) fn twice_inverse(x: f64, beside: f64) -> f64 {
    x * once_inverse(x, beside) - x.hypot(beside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::gauss_legendre;

    #[test]
    fn the_mean_over_two_pieces_is_that_of_all_distances_between_them() {
        let (along, beside) = (0.3, 0.2);
        let rule = gauss_legendre(40);
        for apart in [0.0, 0.3, 1.7] {
            let sum: f64 = rule
                .iter()
                .flat_map(|(x, w)| rule.iter().map(move |(y, v)| (x - y, w * v)))
                .map(|(x, w)| 0.25 * w / (apart + 0.5 * along * x).hypot(beside))
                .sum();
            let found = inverse_in_the_mean(along, apart, beside);
            assert!((found / sum - 1.0).abs() < 1e-9, "{found} {sum}");
        }
    }

    #[test]
    fn far_images_add_what_a_sum_of_them_adds_beside_lines_farther_than_the_face_is_long_too() {
        const MANY: i32 = 4000;
        let images = Images {
            length: 1.3,
            module: 0.2,
        };
        // The changes from a line through all images, whose sum has no limit.
        let change = |of: &dyn Fn(f64, f64) -> f64, x, beside| of(x, beside) - of(0.0, 0.0);
        let sum = |x: f64, beside: f64, places: &dyn Fn(i32) -> f64| -> f64 {
            let both = |i| [1.0, -1.0].map(|side| (x + side * places(i)).hypot(beside).recip());
            (0..MANY).flat_map(both).sum()
        };
        let direct = |i: i32| 2.0 * 1.3 * f64::from(DIRECT + 1 + i);
        let mirrored = |i: i32| 1.3 * f64::from(2 * (MIRRORED + i) + 1);
        for beside in [0.0, 0.3, 1.95, 3.9] {
            for x in [0.0, 0.7, -1.3] {
                let found = change(&|x, d| images.beyond_direct(x, d), x, beside);
                let expected = change(&|x, d| sum(x, d, &direct), x, beside);
                assert!((found - expected).abs() < 3e-4 / 1.3, "{found} {expected}");
                let found = change(&|x, d| images.beyond_mirrored(x, d), x, beside);
                let expected = change(&|x, d| sum(x, d, &mirrored), x, beside);
                assert!((found - expected).abs() < 2e-4 / 1.3, "{found} {expected}");
            }
        }
    }

    #[test]
    fn images_leave_the_changes_of_an_endless_sum_and_the_mean_of_the_plane() {
        const MANY: i32 = 4000;
        let images = Images {
            length: 1.3,
            module: 0.2,
        };
        for beside in [0.03, 0.4, 2.0] {
            let both = |x: f64, y: f64| {
                let near = |at: f64| 1.0 / (at).hypot(beside);
                let direct: f64 = images.direct().map(|at| near(x + at)).sum();
                let mirrored: f64 = images.mirrored().map(|at| near(y + at)).sum();
                direct
                    + mirrored
                    + images.beyond_direct(x, beside)
                    + images.beyond_mirrored(y, beside)
            };
            let endless = |x: f64, y: f64| -> f64 {
                let near = |at: f64| 1.0 / at.hypot(beside);
                (-MANY..=MANY)
                    .map(|i| {
                        let at = 2.0 * 1.3 * f64::from(i);
                        near(x + at) + near(y + at + 1.3)
                    })
                    .sum()
            };
            // A point in the middle of the face, and others up to its ends.
            for (x, y) in [(0.1, 0.3), (0.6, -0.5), (-0.4, 0.9)] {
                let change = both(x, y) - both(0.0, 0.0);
                let expected = endless(x, y) - endless(0.0, 0.0);
                assert!(
                    (change - expected).abs() < 1e-3 / 1.3,
                    "{change} {expected}"
                );
            }
            // The mean over a period of each sum.
            let mean: f64 = (0..2000)
                .map(|i| {
                    let x = 1.3 * ((f64::from(i) + 0.5) / 1000.0 - 1.0);
                    both(x, x) / 2000.0
                })
                .sum();
            let plane = -2.0 / 1.3 * (beside / 0.2_f64).ln();
            assert!((mean - plane).abs() < 1e-3 / 1.3, "{mean} {plane}");
        }
    }
}
