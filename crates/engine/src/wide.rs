//! Loops over numbers with the widest vectors that the machine has.

use nalgebra::SimdRealField;
pub(crate) use pulp::NullaryFnOnce as Loops;

/// A number, or several side by side; each is computed to the same bits as by itself.
pub(crate) trait Numbers: SimdRealField<Element = f64> + Copy {}

impl<T: SimdRealField<Element = f64> + Copy> Numbers for T {}

/// Does `work`, of which all that is inlined runs on such vectors. Operations and their order stay, and so does every digit.
///
/// Closures are inlined where they are small; larger work says so of itself, as a type whose [`Loops::call`] is always inlined.
pub(crate) fn wide<W: Loops>(work: W) -> W::Output {
    pulp::Arch::new().dispatch(work)
}
