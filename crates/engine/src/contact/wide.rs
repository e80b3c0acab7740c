//! Loops over numbers with the widest vectors that the machine has.

use nalgebra::SimdRealField;
pub(super) use pulp::NullaryFnOnce as Loops;

/// A number, or several side by side; what is computed of it is computed of each of them, to the bit as of it alone.
pub(super) trait Numbers: SimdRealField<Element = f64> + Copy {}

impl<T: SimdRealField<Element = f64> + Copy> Numbers for T {}

/// Does `work`, of which all that is inlined runs on such vectors. Operations and their order stay, and so does every digit.
///
/// Closures are inlined where they are small; larger work says so of itself, as a type whose [`Loops::call`] is always inlined.
pub(super) fn wide<W: Loops>(work: W) -> W::Output {
    pulp::Arch::new().dispatch(work)
}

#[cfg(test)]
mod tests {
    use super::super::factor::dot;
    use super::*;

    #[test]
    fn wide_vectors_change_no_digit() {
        for count in [1, 7, 8, 40, 111] {
            let [one, other] = [0.3, 1.7].map(|k: f64| -> Vec<f64> {
                (0..count).map(|i| (k * f64::from(i)).cos()).collect()
            });
            let wide = wide(|| dot(&one, &other));
            assert_eq!(wide.to_bits(), dot(&one, &other).to_bits(), "{count}");
        }
    }
}
