//! Directions at nodes: stiffness in components other than x and y.

use faer::Mat;

use crate::gear::{Vector, radial, tangential};

/// The symmetric matrix `a`, given on (x, y) of each node, on the axes of each node.
pub(super) fn in_axes(a: &Mat<f64>, axes: &[[Vector; 2]]) -> Mat<f64> {
    let n = axes.len();
    let mut rotated = Mat::zeros(2 * n, 2 * n);
    for j in 0..n {
        for i in 0..n {
            let block = nalgebra::Matrix2::new(
                a[(2 * i, 2 * j)],
                a[(2 * i, 2 * j + 1)],
                a[(2 * i + 1, 2 * j)],
                a[(2 * i + 1, 2 * j + 1)],
            );
            for (c, left) in axes[i].iter().enumerate() {
                for (d, right) in axes[j].iter().enumerate() {
                    rotated[(2 * i + c, 2 * j + d)] = left.dot(&(block * right));
                }
            }
        }
    }
    rotated
}

/// Polar axes of a node at `point`.
pub(super) fn polar_axes(point: Vector) -> [Vector; 2] {
    let angle = point.y.atan2(point.x);
    [radial(angle), tangential(angle)]
}

/// The symmetric matrix `a` on the polar axes of `points`.
pub(super) fn in_polar_axes(a: &Mat<f64>, points: impl Iterator<Item = Vector>) -> Mat<f64> {
    in_axes(a, &points.map(polar_axes).collect::<Vec<_>>())
}
