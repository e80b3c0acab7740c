//! Drawings in DXF: closed loops of lines and arcs, as the `outline` of a blank.
//!
//! Read in this order: `file` (the entities of a file), `shape` with `curve` (the lines and arcs of an entity), `insert` (where a block stands), `pieces`
//! (those of the whole drawing), `chain` (closed loops of these), `center` (where the drawing turns about), and `drawing` (which loops bound openings).
//!
//! The reasons for an own reader stand in crates/README.md.

mod center;
mod chain;
mod curve;
mod drawing;
mod file;
mod insert;
mod outline;
mod pieces;
mod shape;
#[cfg(test)]
mod tests;

use meshwright_engine::gear::Vector;

use chain::{Within, chains, once};
use drawing::Drawing;
use file::{File, Unit};
use outline::MOST_FAULTS;
pub use outline::{Choices, Outline, Refused, TOLERANCE_MM, TOLERANCES_MM};
use pieces::{Pieces, Reader};

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
