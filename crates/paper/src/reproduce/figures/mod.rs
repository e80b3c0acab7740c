//! The figures of the paper, drawn from the computed results. Figs. 1 and 4 are flow charts without numbers.
//!
//! Read in this order: [`drawings`] (Figs. 2, 5 and 9), [`blanks`] (Fig. 3), [`cases`] (Figs. 6 to 8), [`designs`]
//! (Figs. 10 and 11), [`sweeps`] (the torques).

mod blanks;
mod cases;
mod designs;
mod drawings;
mod sweeps;

use meshwright_engine::analysis::Curve;

use super::computed::Computed;
use meshwright_plot::Figure;

/// A figure with its caption.
pub(super) struct Illustration {
    /// The name of its file.
    pub(super) file: &'static str,
    /// Its title.
    pub(super) title: String,
    /// Content, and differences from the paper.
    pub(super) caption: String,
    /// The figure.
    pub(super) svg: String,
}

impl Illustration {
    fn new(file: &'static str, caption: String, figure: &Figure) -> anyhow::Result<Self> {
        Ok(Self {
            file,
            title: figure.title.clone(),
            caption,
            svg: figure.to_svg(),
        })
    }
}

/// Every figure, in the paper's order; the sweeps follow.
///
/// # Errors
///
/// If one cannot be drawn.
pub(super) fn all(computed: &Computed) -> anyhow::Result<Vec<Illustration>> {
    let mut figures = vec![
        drawings::substructures(computed)?,
        blanks::rotations(computed)?,
        drawings::pairs(computed)?,
    ];
    for test_case in &computed.test_cases {
        figures.push(cases::curves_and_spectra(test_case)?);
    }
    figures.push(drawings::designs(computed)?);
    figures.push(designs::at(computed, 0)?);
    figures.push(designs::at(computed, 1)?);
    figures.push(sweeps::over_torque(computed)?);
    Ok(figures)
}

/// One curve over a revolution of a gear of `tooth_count` teeth: its angle in radians, and `values` times `scale`, which
/// go on with their period.
fn over_revolution(curve: &Curve, values: &[f64], scale: f64, tooth_count: u32) -> Vec<(f64, f64)> {
    // Positions start at 0 and are equally spaced, so that the second is the step.
    let step = curve.mesh_position.get(1).copied().unwrap_or(1.0);
    let pitch = std::f64::consts::TAU / f64::from(tooth_count);
    let count = (f64::from(tooth_count) / step).round() as usize;
    (0..=count)
        .zip(values.iter().cycle())
        .map(|(i, value)| (i as f64 * step * pitch, value * scale))
        .collect()
}
