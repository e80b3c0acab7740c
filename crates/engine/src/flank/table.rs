//! The compliance of one gear's loaded flanks, ready for contact cells of any size anywhere on them.
//!
//! The finite elements give the compliance between flank nodes. Between points nearer to each other than a few elements a logarithm dominates that no grid
//! resolves. The remainder after subtraction of the half plane's logarithm is smooth, on the scale of the tooth and of the distance to the tip corner. That
//! smooth part R is tabulated on the flank nodes and interpolated; the logarithm is added in closed form for the cells at hand ([`super::half_plane`]).

use faer::Mat;

use super::corner::{Corner, block};
use super::half_plane::{Entries, logarithm_factor};
use crate::fem::dense::entries;
use crate::gear::{Involute, SpurGear};
use crate::ring::tooth::{ToothSubstructure, modal_loads};

/// Nodes this near to each other (two elements) see the grid rather than the body in their compliance.
const NEAR: usize = 4;

/// The smooth compliance of the loaded flank of one tooth with its interface held, and its loading modes.
#[derive(Debug, Clone)]
pub struct FlankTable {
    /// The arc length of each node from the base circle: the compliance is smooth along the flank, and not in the roll length
    /// near the base circle.
    arcs: Vec<f64>,
    /// R on (normal, towards the tip) of each node.
    smooth: Mat<f64>,
    /// V on the same unknowns.
    modes: Mat<f64>,
    flank: Involute,
    /// `None` where the edge at the tip is broken: it bends so little that the table knows all of it.
    corner: Option<Corner>,
}

/// A point on a flank in terms of the nodes around it: four nodes from `first`, their weights, and the components of the
/// direction in which it is pressed.
#[derive(Debug, Clone, Copy)]
pub struct FlankPoint {
    first: usize,
    weights: [f64; 4],
    direction: [f64; 2],
    /// The arc length from the base circle.
    arc: f64,
}

impl FlankTable {
    /// Tabulates the flank of `tooth`, a tooth of `gear`.
    pub fn new(tooth: &ToothSubstructure, gear: &SpurGear) -> Self {
        let factor = logarithm_factor(gear.material().youngs_modulus, gear.face_width());
        let module = gear.data().rack.module;
        let nodes = tooth.roll_lengths.len();
        let mut smooth = tooth.fixed_compliance.clone();
        for component in [0, 1] {
            let mut part = Mat::from_fn(nodes, nodes, |i, j| {
                let distance = (tooth.flank_points[i] - tooth.flank_points[j]).norm();
                let logarithm = if i == j {
                    0.0
                } else {
                    factor * (distance / module).ln()
                };
                tooth.fixed_compliance[(2 * i + component, 2 * j + component)] + logarithm
            });
            bridge_diagonal(&mut part);
            for j in 0..nodes {
                for i in 0..nodes {
                    smooth[(2 * i + component, 2 * j + component)] = part[(i, j)];
                }
            }
        }
        let flank = *gear.flank();
        let roll_lengths = tooth.roll_lengths.iter();
        let arcs: Vec<f64> = roll_lengths.map(|s| flank.arc_length(*s)).collect();
        let between = |one: f64, other: f64| {
            let [one, other] = [one, other].map(|arc| stencil(&arcs, arc));
            let mut sum = [[0.0; 2]; 2];
            for (i, weight) in one.1.into_iter().enumerate() {
                for (j, other_weight) in other.1.into_iter().enumerate() {
                    let entry = block(&smooth, one.0 + i, other.0 + j);
                    for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        sum[a][b] += weight * other_weight * entry[a][b];
                    }
                }
            }
            sum
        };
        let sharp = gear.edge_point(0.0).is_none();
        let corner = sharp.then(|| Corner::new(gear, &arcs, factor, between));
        Self {
            arcs,
            smooth,
            modes: tooth.modes.clone(),
            flank,
            corner,
        }
    }

    /// The number of table entries, for the size limit of the cache.
    pub fn entries(&self) -> usize {
        entries(&self.smooth) + entries(&self.modes)
    }

    /// The number r of loading modes.
    pub fn mode_count(&self) -> usize {
        self.modes.ncols()
    }

    /// The point at roll length `s`, pressed along `direction` (against the outward normal, against the way to the tip).
    pub fn point(&self, s: f64, direction: [f64; 2]) -> FlankPoint {
        let arc = self.flank.arc_length(s);
        // A broken edge goes on beyond the last node, where nothing presses, and below the first one an undercut flank turns into its fillet.
        let known = arc.clamp(self.arcs[0], self.arcs[self.arcs.len() - 1]);
        let (first, weights) = stencil(&self.arcs, known);
        FlankPoint {
            first,
            weights,
            direction,
            arc,
        }
    }

    /// The smooth compliance W R Wᵀ between `points` and `loaded` points of one tooth with its interface held, without the
    /// logarithm; above the diagonal it may be wrong where these `entries` are not asked for.
    pub fn smooth_compliance(
        &self,
        points: &[FlankPoint],
        loaded: &[FlankPoint],
        entries: Entries,
    ) -> Mat<f64> {
        let ((row, weights), (column, loads)) = (weights(points), weights(loaded));
        let around = self
            .smooth
            .submatrix(row, column, weights.ncols(), loads.ncols());
        let mut compliance = &weights * around * loads.transpose();
        let Some(corner) = &self.corner else {
            return compliance;
        };
        let near = |(_, point): &(usize, &FlankPoint)| corner.may_know(point.arc);
        for (j, load) in loaded.iter().enumerate().filter(near) {
            let points = points.iter().enumerate().skip(entries.first(j));
            for (i, point) in points.filter(near) {
                if let Some(block) = corner.compliance(point.arc, load.arc) {
                    let moved =
                        block.map(|row| row[0] * load.direction[0] + row[1] * load.direction[1]);
                    compliance[(i, j)] =
                        point.direction[0] * moved[0] + point.direction[1] * moved[1];
                }
            }
        }
        compliance
    }

    /// The `forces` at `points`, along their directions, as loads on the flank's unknowns: along the outward normal and towards the tip, node by node, so that
    /// pressure is negative.
    pub fn nodal_forces(&self, points: &[FlankPoint], forces: &[f64]) -> Vec<f64> {
        let mut nodal = vec![0.0; self.modes.nrows()];
        for (point, force) in points.iter().zip(forces) {
            for (node, weight) in (point.first..).zip(point.weights) {
                for (component, against) in point.direction.into_iter().enumerate() {
                    nodal[2 * node + component] -= weight * against * force;
                }
            }
        }
        nodal
    }

    /// The `forces` on the flank's unknowns, in terms of the loading modes.
    pub fn modal_loads(&self, forces: &[f64]) -> Vec<f64> {
        modal_loads(&self.modes, forces)
    }

    /// The moment of `forces` on the flank's unknowns about the axis of the gear, counter-clockwise.
    pub fn moment(&self, forces: &[f64]) -> f64 {
        // At r_b e_r + s e_t a force along the normal e_t has the arm r_b, one towards the tip, along e_r, the arm −s.
        let arms = self.arcs.iter().flat_map(|arc| {
            [
                self.flank.base_radius(),
                -self.flank.roll_length_at_arc(*arc),
            ]
        });
        arms.zip(forces).map(|(arm, force)| arm * force).sum()
    }

    /// W V: how the flank follows its interface at `points`.
    pub fn shapes_at(&self, points: &[FlankPoint]) -> Mat<f64> {
        let (first, weights) = weights(points);
        &weights * self.modes.subrows(first, weights.ncols())
    }
}

/// The first of the four of `nodes` around `x`, and their weights in a cubic.
fn stencil(nodes: &[f64], x: f64) -> (usize, [f64; 4]) {
    let after = nodes.partition_point(|&node| node < x);
    let first = after.saturating_sub(2).min(nodes.len() - 4);
    let stencil = &nodes[first..first + 4];
    let weights = std::array::from_fn(|i| {
        (0..4)
            .filter(|&j| j != i)
            .map(|j| (x - stencil[j]) / (stencil[i] - stencil[j]))
            .product()
    });
    (first, weights)
}

/// The weights W of the unknowns around `points`, one row each, and the first of these unknowns.
fn weights(points: &[FlankPoint]) -> (usize, Mat<f64>) {
    let first = points.iter().map(|point| point.first).min().unwrap_or(0);
    let end = points.iter().map(|point| point.first + 4).max();
    let mut weights = Mat::zeros(points.len(), 2 * (end.unwrap_or(first) - first));
    for (i, point) in points.iter().enumerate() {
        for (node, weight) in point.weights.into_iter().enumerate() {
            for (component, along) in point.direction.into_iter().enumerate() {
                weights[(i, 2 * (point.first - first + node) + component)] = weight * along;
            }
        }
    }
    (2 * first, weights)
}

/// Replaces the entries of the symmetric table `a` near its diagonal by an extrapolation from its farther ones.
///
/// Along each antidiagonal the smooth part is even in the distance d between the nodes: a + b d² + c d⁴ through the
/// distances 4, 8 and 12 bridges the nearer ones. Near the ends of the flank fewer distances fit, and the last few nodes
/// continue their neighbors in a straight line.
fn bridge_diagonal(a: &mut Mat<f64>) {
    let last = a.nrows() as i64 - 1;
    let source = a.clone();
    let near = NEAR as i64;
    let bridged = |sum: i64, d: i64| -> Option<f64> {
        let reach = sum.min(2 * last - sum);
        // Distances along one antidiagonal share the parity of their sum.
        let parity = sum % 2;
        let nodes: Vec<i64> = [near + parity, near + 4 + parity, near + 8 + parity]
            .into_iter()
            .filter(|&n| n <= reach)
            .collect();
        if nodes.is_empty() {
            return None;
        }
        let x = (d * d) as f64;
        let mut value = 0.0;
        for &n in &nodes {
            let weight: f64 = nodes
                .iter()
                .filter(|&&m| m != n)
                .map(|&m| (x - (m * m) as f64) / ((n * n - m * m) as f64))
                .product();
            value += weight * source[(((sum - n) / 2) as usize, ((sum + n) / 2) as usize)];
        }
        Some(value)
    };
    let mut set = |i: i64, j: i64, value: f64| {
        a[(i as usize, j as usize)] = value;
        a[(j as usize, i as usize)] = value;
    };
    // The sums nearest to either end for which the bridge has at least two distances; beyond, straight continuation.
    let (first_sum, last_sum) = (near + 4, 2 * last - near - 4);
    for d in 0..near {
        for sum in (d..=2 * last - d).filter(|sum| (sum - d) % 2 == 0) {
            let inside = sum.clamp(
                first_sum + (first_sum - d).rem_euclid(2),
                last_sum - (last_sum - d).rem_euclid(2),
            );
            let Some(mut value) = bridged(inside, d) else {
                continue;
            };
            if inside != sum {
                let step = if sum < inside { 2 } else { -2 };
                if let Some(next) = bridged(inside + step, d) {
                    value += (value - next) * ((inside - sum) / step).abs() as f64;
                }
            }
            set((sum - d) / 2, (sum + d) / 2, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_even_function_is_bridged_across_its_polluted_diagonal() {
        let exact = |i: usize, j: usize| {
            let (mean, d) = ((i + j) as f64 / 100.0, (i as f64 - j as f64) / 100.0);
            2.0 + mean - 3.0 * mean * mean + d * d * (1.0 + mean) - d.powi(4)
        };
        let mut table = Mat::from_fn(60, 60, |i, j| {
            if i.abs_diff(j) < NEAR {
                99.0
            } else {
                exact(i, j)
            }
        });
        bridge_diagonal(&mut table);
        for i in 0..60_usize {
            for j in 0..60_usize {
                // Where all three distances fit, the bridge is exact for this function; towards the ends fewer fit and it goes on
                // straight, which leaves the curvature (6 of this mean's) over twelve nodes: 6/2 · 0.12² / 2 = 0.02.
                let ends = (i + j).min(118 - i - j);
                let tolerance = if ends >= NEAR + 9 { 1e-10 } else { 3e-2 };
                assert!(
                    (table[(i, j)] - exact(i, j)).abs() < tolerance,
                    "({i}, {j}): {} {}",
                    table[(i, j)],
                    exact(i, j)
                );
            }
        }
    }
}
