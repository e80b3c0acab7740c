//! Directions: of teeth, and at nodes, where stiffness has components other than x and y.

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

/// Rows on (x, y) of each node as rows on the axes of each node.
pub(super) fn rows_in_axes(rows: &Mat<f64>, axes: &[[Vector; 2]]) -> Mat<f64> {
    Mat::from_fn(rows.nrows(), rows.ncols(), |i, j| {
        let node = j / 2;
        axes[node][j % 2].dot(&Vector::new(rows[(i, 2 * node)], rows[(i, 2 * node + 1)]))
    })
}

/// The angle of tooth `i` of `z` in the gear's frame.
pub fn tooth_angle(i: usize, z: usize) -> f64 {
    2.0 * std::f64::consts::PI * i as f64 / z as f64
}
