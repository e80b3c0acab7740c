//! Lists of a document, made of those of the engine.

/// Each of `values` in the unit of the document.
pub(super) fn each(values: &[f64], convert: impl Fn(f64) -> f64) -> Vec<f64> {
    values.iter().copied().map(convert).collect()
}

/// The document of each of `found`.
pub(super) fn all<'a, F, T>(found: &'a [F], tell: impl Fn(&'a F) -> T) -> Vec<T> {
    found.iter().map(tell).collect()
}
