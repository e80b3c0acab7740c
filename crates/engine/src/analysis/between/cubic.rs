//! Polynomials of the third degree and below.

/// c_0 + c_1 t + c_2 t² + c_3 t³ with t = x − x_0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cubic {
    origin: f64,
    coefficients: [f64; 4],
}

impl Cubic {
    /// The polynomial of the least degree through `nodes`, of which there are one to four at different places.
    pub(super) fn through(nodes: &[(f64, f64)]) -> Self {
        let count = nodes.len().min(4);
        let origin = nodes.first().map_or(0.0, |node| node.0);
        // Newton's divided differences, multiplied out from the last node to the first.
        let mut differences = [0.0; 4];
        for (difference, node) in differences.iter_mut().zip(nodes) {
            *difference = node.1;
        }
        for order in 1..count {
            for i in (order..count).rev() {
                differences[i] =
                    (differences[i] - differences[i - 1]) / (nodes[i].0 - nodes[i - order].0);
            }
        }
        let mut coefficients = [0.0; 4];
        for i in (0..count).rev() {
            let t = nodes[i].0 - origin;
            for power in (1..4).rev() {
                coefficients[power] = coefficients[power - 1] - t * coefficients[power];
            }
            coefficients[0] = differences[i] - t * coefficients[0];
        }
        Self {
            origin,
            coefficients,
        }
    }

    /// The one with these values and slopes at two places.
    pub(super) fn hermite(ends: [(f64, f64); 2], slopes: [f64; 2]) -> Self {
        let [(from, begins), (to, ends)] = ends;
        let width = to - from;
        let rise = (ends - begins) / width;
        Self {
            origin: from,
            coefficients: [
                begins,
                slopes[0],
                (3.0 * rise - 2.0 * slopes[0] - slopes[1]) / width,
                (slopes[0] + slopes[1] - 2.0 * rise) / (width * width),
            ],
        }
    }

    pub(super) fn at(&self, x: f64) -> f64 {
        let t = x - self.origin;
        let [c_0, c_1, c_2, c_3] = self.coefficients;
        c_0 + t * (c_1 + t * (c_2 + t * c_3))
    }

    /// The places between `from` and `to` at which it is level.
    pub(super) fn level_within(&self, from: f64, to: f64) -> impl Iterator<Item = f64> {
        let [_, c_1, c_2, c_3] = self.coefficients;
        let root = (c_2 * c_2 - 3.0 * c_1 * c_3).sqrt();
        // Of both solutions the one without cancellation, and the other by their product.
        let sum = -(c_2 + c_2.signum() * root);
        let origin = self.origin;
        [sum / (3.0 * c_3), c_1 / sum]
            .into_iter()
            .map(move |t| origin + t)
            .filter(move |x| from < *x && *x < to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_points_of_a_cubic_give_it_back_with_its_extremes() {
        // (x − 1)(x − 2)(x + 3) = x³ − 7x + 6 is level at ±√(7/3).
        let cubic = |x: f64| (x - 1.0) * (x - 2.0) * (x + 3.0);
        let nodes = [-2.5, 0.5, 0.7, 3.0].map(|x| (x, cubic(x)));
        let found = Cubic::through(&nodes);
        for x in [-3.0, -1.0, 0.0, 2.2] {
            assert!((found.at(x) - cubic(x)).abs() < 1e-12);
        }
        let mut level: Vec<f64> = found.level_within(-3.0, 3.0).collect();
        level.sort_by(f64::total_cmp);
        assert_eq!(level.len(), 2);
        assert!((level[1] - (7.0_f64 / 3.0).sqrt()).abs() < 1e-12 && level[0] < 0.0);
        let slope = |x: f64| 3.0 * x * x - 7.0;
        let ends = [-1.0, 2.0];
        let same = Cubic::hermite(ends.map(|x| (x, cubic(x))), ends.map(slope));
        assert!((same.at(0.3) - cubic(0.3)).abs() < 1e-12);
    }

    #[test]
    fn fewer_points_give_a_polynomial_of_a_lower_degree() {
        assert_eq!(Cubic::through(&[(1.0, 4.0)]).at(7.0), 4.0);
        let line = Cubic::through(&[(1.0, 4.0), (2.0, 6.0)]);
        assert!((line.at(4.0) - 10.0).abs() < 1e-14);
        assert_eq!(line.level_within(0.0, 9.0).count(), 0);
        let parabola = Cubic::through(&[(0.0, 1.0), (1.0, 0.0), (3.0, 4.0)]);
        let level: Vec<f64> = parabola.level_within(0.0, 3.0).collect();
        assert!(level.len() == 1 && (level[0] - 1.0).abs() < 1e-12);
    }
}
