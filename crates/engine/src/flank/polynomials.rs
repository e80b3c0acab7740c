//! The polynomials up a flank.

use crate::quadrature::legendre;

/// The degree up the flank of a tooth's compliance under its own load, less the half space.
pub(crate) const OWN_DEGREE: usize = 6;
/// The degree up the flank of its compliance under the loads of others.
pub(crate) const OTHER_DEGREE: usize = 5;

/// The Legendre polynomials in the square of the roll length, over the flank, and their derivatives by the roll length.
pub(crate) fn up_the_flank(
    [from, to]: [f64; 2],
    roll_length: f64,
    degree: usize,
) -> (Vec<f64>, Vec<f64>) {
    let t = (2.0 * roll_length * roll_length - from - to) / (to - from);
    let (mut values, mut slopes) = (vec![0.0; degree + 1], vec![0.0; degree + 1]);
    legendre(t, &mut values, &mut slopes);
    let by_roll = 4.0 * roll_length / (to - from);
    slopes.iter_mut().for_each(|slope| *slope *= by_roll);
    (values, slopes)
}

/// The same values, each over its square's mean along the flank: weights of the nearest polynomials.
pub(crate) fn projecting(squares: [f64; 2], roll_length: f64, degree: usize) -> Vec<f64> {
    let (values, _) = up_the_flank(squares, roll_length, degree);
    let each = values.into_iter().enumerate();
    each.map(|(a, value)| (2 * a + 1) as f64 * value).collect()
}
