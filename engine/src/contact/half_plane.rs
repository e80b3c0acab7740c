//! The local deformation of a flank: the half plane under cells of uniform pressure, and under Hertz's.

use std::f64::consts::PI;

/// The mean of ln|x − t| over x and t in two cells of unit width whose centers are `distance` cells apart.
///
/// The second difference of Φ(z) = z²/2 ln|z| − 3z²/4, whose second derivative is the logarithm.
pub fn mean_logarithm(distance: usize) -> f64 {
    let phi = |z: f64| {
        if z == 0.0 {
            0.0
        } else {
            z * z / 2.0 * z.abs().ln() - 0.75 * z * z
        }
    };
    let z = distance as f64;
    // Far away the second difference loses its digits; its series ln z − 1/(12 z²) does not.
    if distance > 100 {
        z.ln() - 1.0 / (12.0 * z * z)
    } else {
        phi(z + 1.0) - 2.0 * phi(z) + phi(z - 1.0)
    }
}

/// The factor c = 2/(π E' b) of the logarithm in the compliance of a half plane: u = −c F ln|x| + constant.
///
/// E' is Young's modulus in plane stress, E/(1 − ν²) in plane strain.
pub fn logarithm_factor(plane_modulus: f64, thickness: f64) -> f64 {
    2.0 / (PI * plane_modulus * thickness)
}

/// The half-width a of the contact of two cylinders under `load`, and its peak pressure.
///
/// With the sum c_1 + c_2 of the logarithm `factors` of both bodies, a² = 2 F ρ (c_1 + c_2), and
/// p_0 = 2F/(π a b) = a/(π b ρ (c_1 + c_2)) (Hertz). Both vanish with the load.
pub fn hertz(load: f64, radius: f64, factors: f64, width: f64) -> (f64, f64) {
    let a = (2.0 * load * radius * factors).sqrt();
    (a, a / (PI * width * radius * factors))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_logarithm_is_that_of_a_fine_sum() {
        for distance in [0_usize, 1, 5, 99, 101] {
            let n = 400;
            let sum: f64 = (0..n)
                .flat_map(|i| (0..n).map(move |j| (i, j)))
                .filter(|(i, j)| distance > 0 || i != j)
                .map(|(i, j)| {
                    (distance as f64 + (f64::from(i) - f64::from(j)) / f64::from(n))
                        .abs()
                        .ln()
                })
                .sum();
            let mean = sum / f64::from(n * n);
            assert!(
                (mean - mean_logarithm(distance)).abs() < 0.02,
                "{distance}: the sum leaves out its diagonal"
            );
            if distance > 1 {
                assert!((mean - mean_logarithm(distance)).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn hertz_at_the_pitch_point_of_the_standard_pair() {
        // DESIGN section 5, plane stress: half-width 115.0 µm and 677 MPa at T = 115 N m; both radii are 17.8187 mm.
        let factor = 2.0 * logarithm_factor(210e9, 20e-3);
        let (a, p) = hertz(2447.61, 17.8187e-3 / 2.0, factor, 20e-3);
        assert!((a - 115.0e-6).abs() < 0.06e-6, "{a}");
        assert!((p - 677e6).abs() < 0.6e6, "{p}");
    }
}
