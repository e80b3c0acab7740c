//! Circles on which parts of unlike width meet.
//!
//! The circle of the narrower part follows that of the wider one, in the mean over each of its functions.

use faer::{Mat, c64};

use crate::fem::FemError;
use crate::fem::axial::AxialBasis;
use crate::fem::dense::Cholesky;
use crate::fem::prism::COMPONENTS;

/// T: the displacement of `order` on the functions `narrow` of a circle that follows the functions `wide`, whose frame turns by
/// `twist` against its own: ∫ f_p e^{−i n τ z} g_q dz for each component.
pub fn trace(narrow: &AxialBasis, wide: &AxialBasis, order: i64, twist: f64) -> Mat<c64> {
    let phase = order as f64 * twist;
    let real = narrow.integrals(wide, |z| (phase * z).cos());
    let imaginary = narrow.integrals(wide, |z| -(phase * z).sin());
    let (rows, columns) = (narrow.len(), wide.len());
    let mut t = Mat::<c64>::zeros(COMPONENTS * rows, COMPONENTS * columns);
    for c in 0..COMPONENTS {
        for q in 0..columns {
            for p in 0..rows {
                t[(c * rows + p, c * columns + q)] = c64::new(real[(p, q)], imaginary[(p, q)]);
            }
        }
    }
    t
}

/// The stiffness of `order` on the functions `upper`, which stand on a circle that is carried by `stiffness` on the functions
/// `lower`. `twist` is that of the upper frame against the lower one.
///
/// # Errors
///
/// [`FemError::NotPositiveDefinite`].
pub(crate) fn carried(
    stiffness: &Mat<c64>,
    lower: &AxialBasis,
    upper: &AxialBasis,
    order: i64,
    twist: f64,
) -> Result<Mat<c64>, FemError> {
    if is_narrower(lower, upper) {
        // U_lower = T U_upper.
        let t = trace(lower, upper, order, twist);
        return Ok(t.adjoint() * stiffness * &t);
    }
    // U_upper = T U_lower, and forces go the other way: T S⁻¹ Tᴴ is the compliance.
    let mut half = trace(upper, lower, order, -twist).adjoint().to_owned();
    let factor = Cholesky::new(stiffness.clone()).ok_or(not_definite(stiffness))?;
    factor.half_solve_in_place(half.as_mut());
    let compliance = half.adjoint() * &half;
    let mut inverse = Mat::<c64>::identity(compliance.nrows(), compliance.nrows());
    Cholesky::new(compliance)
        .ok_or(not_definite(stiffness))?
        .solve_in_place(inverse.as_mut());
    Ok(inverse)
}

/// Motion of the circle on the functions `lower`, which `stiffness` carries, under one on the functions `upper` that moves by `moved`: the inverse of the
/// condensation in [`carried`].
///
/// # Errors
///
/// As [`carried`].
pub(crate) fn below(
    stiffness: &Mat<c64>,
    [lower, upper]: [&AxialBasis; 2],
    (order, twist): (i64, f64),
    moved: &Mat<c64>,
) -> Result<Mat<c64>, FemError> {
    if is_narrower(lower, upper) {
        return Ok(trace(lower, upper, order, twist) * moved);
    }
    let mut yields = trace(upper, lower, order, -twist).adjoint().to_owned();
    let factor = Cholesky::new(stiffness.clone()).ok_or(not_definite(stiffness))?;
    factor.solve_in_place(yields.as_mut());
    let force = carried(stiffness, lower, upper, order, twist)? * moved;
    Ok(yields * force)
}

/// True if the lower part is no wider than the upper one.
fn is_narrower(lower: &AxialBasis, upper: &AxialBasis) -> bool {
    let width = |basis: &AxialBasis| basis.heights()[1] - basis.heights()[0];
    width(lower) <= width(upper)
}

fn not_definite(stiffness: &Mat<c64>) -> FemError {
    FemError::NotPositiveDefinite {
        part: "the hub",
        unknowns: stiffness.nrows(),
    }
}
