//! The outline of a drawing, the choices that a drawing leaves open, and its limits.

use std::fmt;
use std::ops::RangeInclusive;

use serde_json::Value;

/// Lines and arcs that are no longer are left out, in mm.
pub(super) const SHORTEST_MM: f64 = 1e-3;

/// The most lines and arcs.
pub(super) const MOST_SIDES: usize = 20_000;

/// The most faults in a refusal; nobody reads more before mending some.
pub(super) const MOST_FAULTS: usize = 20;

/// How far ends may be apart to be joined, in mm.
pub const TOLERANCES_MM: RangeInclusive<f64> = 0.0..=0.1;

/// That distance where none is chosen, in mm.
pub const TOLERANCE_MM: f64 = 0.01;

/// Choices that a drawing leaves open.
#[derive(Debug, Clone, PartialEq)]
pub struct Choices {
    /// The layers that are read; all if none are named.
    pub layers: Vec<String>,
    /// The place of the axis, in the unit of the drawing; its origin if none is given.
    pub center: Option<[f64; 2]>,
    /// Ends no farther apart than this are joined, in mm: one of [`TOLERANCES_MM`].
    pub tolerance_mm: f64,
    /// The radius of the bore, in mm, instead of the circle that is drawn.
    pub bore_radius_mm: Option<f64>,
}

impl Default for Choices {
    /// Everything that is drawn, about the origin.
    fn default() -> Self {
        Self {
            layers: Vec::new(),
            center: None,
            tolerance_mm: TOLERANCE_MM,
            bore_radius_mm: None,
        }
    }
}

/// The outline of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// The loops of `blank.outline`: the sides of each, as a submission has them, clockwise around an opening.
    pub loops: Vec<Vec<Value>>,
    /// The radius of the bore, in mm: that which is chosen, or that of the circle that is drawn.
    pub bore_radius_mm: Option<f64>,
    /// Assumptions and entities left out, in sentences.
    pub remarks: Vec<String>,
}

impl Outline {
    /// The outline as JSON, a side a line.
    pub fn to_json(&self) -> String {
        let sides = |sides: &Vec<Value>| {
            let lines: Vec<String> = sides.iter().map(|side| format!("    {side}")).collect();
            format!("  [\n{}\n  ]", lines.join(",\n"))
        };
        let loops: Vec<String> = self.loops.iter().map(sides).collect();
        format!("[\n{}\n]", loops.join(",\n"))
    }
}

/// Everything that prevents an outline, in sentences.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub struct Refused(pub Vec<String>);

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "The drawing cannot be taken.")?;
        for detail in self.0.iter().take(MOST_FAULTS) {
            writeln!(f, "  {detail}")?;
        }
        match self.0.len().saturating_sub(MOST_FAULTS) {
            0 => Ok(()),
            more => writeln!(f, "  and {more} more"),
        }
    }
}

impl From<String> for Refused {
    fn from(detail: String) -> Self {
        Self(vec![detail])
    }
}
