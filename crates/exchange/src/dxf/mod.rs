//! Drawings in DXF: closed loops of lines and arcs, as the `outline` of a blank.
//!
//! Read in this order: `file` (the entities of a file), `shape` with `curve` (the lines and arcs of an entity), `insert` (where a block stands), `pieces`
//! (those of the whole drawing), `chain` (closed loops of these), `center` (where the drawing turns about), and `drawing` (which loops bound openings).
//!
//! Why no crate reads it stands in ARCHITECTURE.md.

mod center;
mod chain;
mod curve;
mod drawing;
mod file;
mod insert;
mod pieces;
mod shape;
#[cfg(test)]
mod tests;

use std::fmt;
use std::ops::RangeInclusive;

use meshwright_engine::gear::Vector;
use serde_json::Value;

use chain::{Within, chains, once};
use drawing::Drawing;
use file::{File, Unit};
use pieces::{Pieces, Reader};

/// Lines and arcs that are no longer are left out, in mm.
const SHORTEST_MM: f64 = 1e-3;

/// The most lines and arcs.
const MOST_SIDES: usize = 20_000;

/// The most faults in a refusal; nobody reads more before mending some.
const MOST_FAULTS: usize = 20;

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

/// The outline of the drawing `bytes`, DXF as text: of its model space, or of its entities on some layers.
///
/// The origin, or the chosen center, is the axis of the gear, the x axis the centerline of tooth 0. Loops that do not run around the axis bound openings. Of
/// the others the smallest circle within all openings is the bore and the largest beyond them the circle around. Openings are in the order of their radius
/// and angle.
///
/// # Errors
///
/// Everything that is wrong: a file that is no DXF, entities that are not read and may change the outline, ends that meet no other, and a drawing that turns
/// about another point than the axis.
pub fn outline(bytes: &[u8], choices: &Choices) -> Result<Outline, Refused> {
    let tolerance_mm = choices.tolerance_mm;
    if !TOLERANCES_MM.contains(&tolerance_mm) {
        return Err(format!(
            "The tolerance is {tolerance_mm} mm; {} to {} mm are taken.",
            TOLERANCES_MM.start(),
            TOLERANCES_MM.end()
        )
        .into());
    }
    let text = file::decoded(bytes)?;
    let file = file::parsed(&text)?;
    let in_mm = file.unit.map_or(1.0, |unit| unit.in_mm);
    let center = Vector::from(choices.center.unwrap_or_default());
    let mut remarks = vec![unit_taken(&file), axis_taken(choices.center)];
    let reader = Reader {
        file: &file,
        layers: &choices.layers,
        in_mm,
    };
    let pieces = reader.pieces(center)?;
    remarks.extend(pieces.left_out());
    let Pieces {
        pieces, sources, ..
    } = pieces;
    let mut drawing = Drawing {
        sources: &sources,
        in_mm,
        center,
        choices,
        remarks,
    };
    let within = Within::of(tolerance_mm, in_mm);
    let (pieces, mut twice) = once(pieces, within);
    let chains = chains(&pieces, within, MOST_FAULTS + 1)
        .map_err(|branches| drawing.faults(&pieces, &branches))?;
    if !chains.open.is_empty() || chains.loops.is_empty() {
        let open: Vec<_> = chains.open.into_iter().chain(chains.lone).collect();
        return Err(drawing.faults(&pieces, &open));
    }
    let (loops, again) = drawing.closed(chains.loops, within)?;
    twice.extend(again);
    drawing.say_twice(twice);
    drawing.say_gaps(chains.gaps);
    drawing.check_center(&loops)?;
    drawing.sorted(&loops, &pieces, &chains.lone)
}

/// The point that a text `X,Y` says.
pub fn point(text: &str) -> Option<[f64; 2]> {
    let (x, y) = text.split_once(',')?;
    let number = |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_finite());
    Some([number(x)?, number(y)?])
}

fn unit_taken(file: &File<'_>) -> String {
    match file.unit {
        None => "The drawing says no unit ($INSUNITS): its lengths are taken for mm.".to_owned(),
        Some(Unit { name, in_mm: 1.0 }) => format!("The drawing is in {name}."),
        Some(Unit { name, in_mm }) => format!("The drawing is in {name}, each {in_mm} mm."),
    }
}

fn axis_taken(center: Option<[f64; 2]>) -> String {
    let axis = match center {
        None => "The origin is taken for the axis of the gear, and the x axis for".to_owned(),
        Some([x, y]) => format!(
            "The point ({x}, {y}) is taken for the axis of the gear, and the way along x from there for"
        ),
    };
    format!("{axis} the centerline of tooth 0, whose loaded flank is on the side of positive y.")
}
