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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fifth_degree_polynomial_is_integrated_exactly() {
        let integral: f64 = gauss_legendre_panels(0.0, 2.0, 3)
            .map(|(x, w)| w * x.powi(5))
            .sum();
        assert!((integral - 64.0 / 6.0).abs() < 1e-13);
    }
}
