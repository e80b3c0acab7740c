//! Gauss-Legendre quadrature.

/// The 3-point Gauss-Legendre rule on [−1, 1]: points and weights, exact to degree 5.
pub const GAUSS_3: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// The points and weights of a composite 3-point rule on [`from`, `to`] in `panels` equal panels.
pub fn gauss_legendre_panels(
    from: f64,
    to: f64,
    panels: usize,
) -> impl Iterator<Item = (f64, f64)> {
    let half = (to - from) / (2.0 * panels as f64);
    (0..panels).flat_map(move |panel| {
        let center = from + half * (2 * panel + 1) as f64;
        GAUSS_3
            .into_iter()
            .map(move |(x, w)| (center + half * x, half * w))
    })
}

/// The Legendre polynomials P_0 … P_n and their derivatives at `t`, into slices of n + 1.
pub fn legendre(t: f64, values: &mut [f64], slopes: &mut [f64]) {
    for p in 0..values.len() {
        let degree = p as f64;
        (values[p], slopes[p]) = match p {
            0 => (1.0, 0.0),
            1 => (t, 1.0),
            _ => (
                ((2.0 * degree - 1.0) * t * values[p - 1] - (degree - 1.0) * values[p - 2])
                    / degree,
                slopes[p - 2] + (2.0 * degree - 1.0) * values[p - 1],
            ),
        };
    }
}

/// The Gauss-Legendre rule of `count` points on [−1, 1]: points, rising, and weights; exact to degree 2 `count` − 1.
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let (mut values, mut slopes) = (vec![0.0; count + 1], vec![0.0; count + 1]);
    let mut point = |i: usize| {
        let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
        // Newton from this start gains digits at once; a few steps more cost nothing.
        for _ in 0..8 {
            legendre(x, &mut values, &mut slopes);
            x -= values[count] / slopes[count];
        }
        legendre(x, &mut values, &mut slopes);
        (x, 2.0 / ((1.0 - x * x) * slopes[count].powi(2)))
    };
    (0..count).map(&mut point).collect()
}

/// The weights of three `places` in the value `at` a fourth, by the parabola through them.
pub fn parabola(places: [f64; 3], at: f64) -> [f64; 3] {
    [[0, 1, 2], [1, 0, 2], [2, 0, 1]].map(|[own, a, b]| {
        let [own, a, b] = [own, a, b].map(|i| places[i]);
        (at - a) * (at - b) / ((own - a) * (own - b))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_of_n_points_is_exact_to_degree_2n_less_1() {
        for count in [1, 2, 3, 5, 9, 24, 60] {
            let rule = gauss_legendre(count);
            for degree in [0, 2 * (count / 2), 2 * count - 1, 2 * count - 2] {
                let degree = degree as i32;
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree)).sum();
                let exact = if degree % 2 == 0 {
                    2.0 / f64::from(degree + 1)
                } else {
                    0.0
                };
                assert!(
                    (sum - exact).abs() < 1e-13,
                    "{count} points, degree {degree}"
                );
            }
        }
    }

    #[test]
    fn a_fifth_degree_polynomial_is_integrated_exactly() {
        let integral: f64 = gauss_legendre_panels(0.0, 2.0, 3)
            .map(|(x, w)| w * x.powi(5))
            .sum();
        assert!((integral - 64.0 / 6.0).abs() < 1e-13);
    }
}
