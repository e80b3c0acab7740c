//! Student's distribution, for the mean of a few numbers.

/// The 97.5 % points for 1, 2, ... degrees of freedom, from any table.
const TABLE: [f64; 15] = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160,
    2.145, 2.131,
];

/// The value that is exceeded with a probability of 2.5 %; none without freedom.
pub(crate) fn quantile_975(degrees_of_freedom: usize) -> Option<f64> {
    let last = degrees_of_freedom.min(TABLE.len());
    last.checked_sub(1).map(|i| TABLE[i])
}
