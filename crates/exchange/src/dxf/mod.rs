//! Drawings in DXF: closed loops of lines and arcs, as the `outline` of a blank.
//!
//! Read in this order: `file` (the entities of a file), `shape` (the lines and arcs of an entity), `chain` (closed loops of these), and here which of
//! them bound openings.
//!
//! Why no crate reads it stands in ARCHITECTURE.md.

mod chain;
mod file;
mod shape;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::fmt;

use meshwright_engine::gear::blank::contour::winding;
use meshwright_engine::gear::{Moments, Side, Vector};
use serde_json::{Value, json};

use crate::significant;
use chain::{Loop, Open, Piece, loops};
use file::{Entity, File, Unit, code};
use shape::Kind;

/// Ends that are no farther apart meet, in mm.
const WITHIN_MM: f64 = 1e-3;

/// An arc that stands out from its chord by no more is a line, in mm.
const STRAIGHT_MM: f64 = 1e-6;

/// The most lines and arcs.
const MOST_SIDES: usize = 20_000;

/// The most faults in a refusal; nobody reads more before mending some.
const MOST_FAULTS: usize = 20;

/// What a drawing comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// The loops of `blank.outline`: the sides of each, as a submission has them, clockwise around an opening.
    pub loops: Vec<Vec<Value>>,
    /// What was assumed and what was left out, in sentences.
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

/// The outline of the drawing `bytes`, DXF as text: of its model space, or of what is there on `layers` if any are named.
///
/// The origin is the axis of the gear, the x axis the centerline of tooth 0. Loops that do not run around the axis bound openings. Of the others the
/// smallest circle within all openings is the bore and the largest beyond them the circle around. Openings are in the order of their radius and angle.
///
/// # Errors
///
/// Everything that is wrong: a file that is no DXF, entities that are not read and may change the outline, ends that meet no other.
pub fn outline(bytes: &[u8], layers: &[String]) -> Result<Outline, Refused> {
    let text = file::decoded(bytes)?;
    let File { entities, unit } = file::parsed(&text)?;
    let mut drawing = Drawing {
        entities: &entities,
        unit,
        remarks: Vec::new(),
    };
    drawing.remarks.push(match unit {
        None => "The drawing says no unit ($INSUNITS): its lengths are taken for mm.".to_owned(),
        Some(Unit { name, in_mm: 1.0 }) => format!("The drawing is in {name}."),
        Some(Unit { name, in_mm }) => format!("The drawing is in {name}, each {in_mm} mm."),
    });
    drawing.remarks.push(
        "The origin is taken for the axis of the gear, and the x axis for the centerline of tooth 0, whose loaded flank is on the side of positive y."
            .to_owned(),
    );
    let pieces = drawing.pieces(layers)?;
    let within = WITHIN_MM / drawing.in_mm();
    let loops = loops(&pieces, within, MOST_FAULTS + 1)
        .map_err(|open| Refused(open.iter().map(|open| drawing.fault(open)).collect()))?;
    let loops = drawing.sorted(loops)?;
    Ok(Outline {
        loops: loops.iter().map(|sides| drawing.written(sides)).collect(),
        remarks: drawing.remarks,
    })
}

/// A drawing, and remarks on it.
struct Drawing<'a> {
    entities: &'a [Entity<'a>],
    unit: Option<Unit>,
    remarks: Vec<String>,
}

impl Drawing<'_> {
    fn in_mm(&self) -> f64 {
        self.unit.map_or(1.0, |unit| unit.in_mm)
    }

    /// The lines and arcs of all entities that are asked for.
    fn pieces(&mut self, layers: &[String]) -> Result<Vec<Piece>, Refused> {
        let (entities, in_mm) = (self.entities, self.in_mm());
        let is_asked = |entity: &Entity<'_>| {
            let same = |layer: &String| layer.to_lowercase() == entity.layer().to_lowercase();
            layers.is_empty() || layers.iter().any(same)
        };
        let (mut pieces, mut faults) = (Vec::new(), Vec::new());
        let mut left_out: BTreeMap<String, usize> = BTreeMap::new();
        let mut leave_out = |what: &str| *left_out.entry(what.to_owned()).or_default() += 1;
        let mut next = 0;
        while let Some(entity) = entities.get(next) {
            let index = next;
            let rest = &entities[index + 1..];
            let is_vertex =
                |other: &&Entity<'_>| entity.name == "POLYLINE" && other.name == "VERTEX";
            let count = rest.iter().take_while(is_vertex).count();
            next += 1 + count;
            if !is_asked(entity) {
                continue;
            }
            if entity.flags(code::PAPER) != 0 || entity.flags(code::HIDDEN) != 0 {
                leave_out("of sheets of paper or hidden");
                continue;
            }
            match shape::kind(entity, &rest[..count], in_mm) {
                Ok(Kind::Annotation) if entity.name == "SEQEND" => {}
                Ok(Kind::Annotation) => leave_out(entity.name),
                Ok(Kind::Sides(sides)) => {
                    for side in sides {
                        let chord = (side.to - side.from).norm() * in_mm;
                        if chord <= WITHIN_MM {
                            leave_out("shorter than 0.001 mm");
                            continue;
                        }
                        let is_line = side.bulge.abs() * chord / 2.0 <= STRAIGHT_MM;
                        let bulge = if is_line { 0.0 } else { side.bulge };
                        pieces.push(Piece {
                            side: Side::new(side.from, side.to, bulge),
                            entity: index,
                        });
                    }
                }
                Err(detail) => faults.push(format!("{} {detail}.", entity.place())),
            }
            if pieces.len() > MOST_SIDES {
                return Err(format!(
                    "There are more than {MOST_SIDES} lines and arcs; choose the layer of the openings with --layer."
                )
                .into());
            }
        }
        if !faults.is_empty() {
            return Err(Refused(faults));
        }
        if pieces.is_empty() {
            return Err(self.nothing(layers).into());
        }
        if !left_out.is_empty() {
            let left_out = left_out
                .iter()
                .map(|(what, count)| format!("{count} {what}"));
            let left_out: Vec<String> = left_out.collect();
            self.remarks
                .push(format!("Left out: {}.", left_out.join(", ")));
        }
        Ok(pieces)
    }

    /// That there is no line and no arc.
    fn nothing(&self, layers: &[String]) -> String {
        let known: BTreeSet<&str> = self.entities.iter().map(Entity::layer).collect();
        let known: Vec<&str> = known.into_iter().take(MOST_FAULTS).collect();
        let on = match layers {
            [] => String::new(),
            layers => format!(" on layer {}", layers.join(" or ")),
        };
        format!(
            "There are no lines and arcs{on}; there is something on: {}.",
            known.join(", ")
        )
    }

    /// What prevents loops at an end.
    fn fault(&self, open: &Open) -> String {
        let point = |at: &Vector| format!("({}, {})", significant(at.x, 9), significant(at.y, 9));
        match open {
            Open::End {
                entity,
                at,
                nearest,
            } => {
                let near = match nearest {
                    Some((other, distance)) => format!(
                        "the nearest open end, of {}, is {} mm off",
                        self.entities[*other].place(),
                        significant(distance * self.in_mm(), 3)
                    ),
                    None => "no other end is open".to_owned(),
                };
                format!(
                    "{} ends at {}, and nothing goes on within 0.001 mm: {near}. Close the loop, or choose the layer of the openings with --layer.",
                    self.entities[*entity].place(),
                    point(at)
                )
            }
            Open::Branch { entities, at } => {
                let mut places: Vec<String> =
                    entities.iter().map(|i| self.entities[*i].place()).collect();
                places.dedup();
                format!(
                    "More than two ends meet at {}: of {}. Leave two of them.",
                    point(at),
                    places.join("; ")
                )
            }
        }
    }

    /// The loops of an outline, with the material on their left.
    fn sorted(&mut self, loops: Vec<Loop>) -> Result<Vec<Vec<Side>>, Refused> {
        let mut openings = Vec::new();
        let (mut layers, mut around) = (BTreeSet::new(), Vec::new());
        for Loop { sides, entity } in loops {
            let area = sides.iter().map(Side::moments).sum::<Moments>().area;
            let length: f64 = sides.iter().map(Side::length).sum();
            let entity = &self.entities[entity];
            if area.abs() * self.in_mm() <= WITHIN_MM * length {
                let detail = format!(
                    "{} begins a loop that encloses nothing: is it drawn twice?",
                    entity.place()
                );
                return Err(detail.into());
            }
            if winding(&sides, Vector::zeros()) != 0 {
                around.push((reach(&sides), entity));
                continue;
            }
            layers.insert(entity.layer());
            openings.push(match area < 0.0 {
                true => sides,
                false => sides.iter().rev().map(Side::reversed).collect(),
            });
        }
        if openings.is_empty() {
            let detail = "Each loop runs around the origin, which is the axis of the gear; none bounds an opening.";
            return Err(detail.to_owned().into());
        }
        let mut openings = in_order(openings);
        let [least, most] = reach(&openings.concat());
        let layers: Vec<&str> = layers.into_iter().collect();
        self.remarks.push(format!(
            "Openings on layer {}: {}, from the radius {} mm to {} mm.",
            layers.join(" and "),
            openings.len(),
            self.mm(least),
            self.mm(most)
        ));
        openings.extend(self.circles(around, [least, most])?);
        Ok(openings)
    }

    /// The bore and the circle around of the loops around the axis, each with its least and its largest radius; openings lie between those of `within`.
    fn circles(
        &mut self,
        mut around: Vec<([f64; 2], &Entity<'_>)>,
        within: [f64; 2],
    ) -> Result<Vec<Vec<Side>>, Refused> {
        let [least, most] = within;
        let (mut bore, mut outer, mut others) = (None, None, Vec::new());
        // From the smallest to the largest.
        around.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]));
        for ([low, high], entity) in around {
            let radii = format!("{} to {} mm", self.mm(low), self.mm(high));
            let is_circle = (high - low) * self.in_mm() <= 2.0 * WITHIN_MM;
            let (is_inside, is_outside) = (high <= least, low >= most);
            if !is_circle && is_inside || !is_inside && !is_outside {
                let why = match is_inside {
                    true => "a bore is a circle: draw it without keyway and splines",
                    false => "openings lie on both sides of it or cross it",
                };
                let detail = format!(
                    "{} begins a loop around the axis with the radii {radii}; {why}.",
                    entity.place()
                );
                return Err(detail.into());
            }
            let radius = f64::midpoint(low, high);
            let circle = |radius| format!("a circle of {} mm", self.mm(radius));
            match (is_inside, is_circle) {
                (true, _) if bore.is_none() => bore = Some(radius),
                (true, _) => others.push(circle(radius)),
                (false, true) => others.extend(outer.replace(radius).map(circle)),
                (false, false) => others.push(format!("a contour of {radii}")),
            }
        }
        if let Some(radius) = bore {
            let radius = significant(radius * self.in_mm(), 9);
            self.remarks.push(format!(
                "The smallest circle about the axis is the bore: blank/bore_radius_mm is {radius}."
            ));
        }
        if !others.is_empty() {
            let others = others.join(", ");
            self.remarks.push(format!(
                "Left out, for they run around the axis and bound no opening: {others}."
            ));
        }
        let bore = bore.map(|radius| circle(radius, -1.0));
        Ok(bore
            .into_iter()
            .chain(outer.map(|radius| circle(radius, 1.0)))
            .collect())
    }

    /// A length in sentences, in mm.
    fn mm(&self, length: f64) -> f64 {
        significant(length * self.in_mm(), 6)
    }

    /// The sides of a loop, as a submission has them.
    fn written(&self, sides: &[Side]) -> Vec<Value> {
        // 2.0000000000000004 says no more than 2.
        const DIGITS: f64 = 1e12;
        let point = |at: Vector| {
            json!([at.x, at.y].map(|x| (x * self.in_mm() * DIGITS).round() / DIGITS + 0.0))
        };
        let side = |side: &Side| {
            if side.bulge == 0.0 {
                json!({ "line_to": point(side.to) })
            } else {
                json!({ "arc_to": point(side.to), "through": point(side.middle()) })
            }
        };
        sides.iter().map(side).collect()
    }
}

/// Openings by the radius of their center of mass, and those of a circle by its angle from the x axis: the order in which they were drawn says nothing.
fn in_order(openings: Vec<Vec<Side>>) -> Vec<Vec<Side>> {
    /// What radii and angles of a circle of openings may differ by: the digits of a drawing.
    const ALIKE: f64 = 1e-6;
    let center = |sides: &[Side]| {
        let moments: Moments = sides.iter().map(Side::moments).sum();
        moments.first / moments.area
    };
    let mut placed: Vec<(f64, f64, Vec<Side>)> = openings
        .into_iter()
        .map(|sides| {
            let center = center(&sides);
            let angle = (center.y.atan2(center.x) + ALIKE).rem_euclid(TAU);
            (center.norm(), angle, sides)
        })
        .collect();
    placed.sort_by(|a, b| a.0.total_cmp(&b.0));
    for circle in placed.chunk_by_mut(|a, b| b.0 - a.0 <= ALIKE * b.0) {
        circle.sort_by(|a, b| a.1.total_cmp(&b.1));
    }
    placed.into_iter().map(|placed| placed.2).collect()
}

/// The least and the largest distance from the axis.
fn reach(sides: &[Side]) -> [f64; 2] {
    let reaches = sides.iter().map(Side::reach);
    reaches.fold([f64::INFINITY, 0.0], |[least, most], [low, high]| {
        [least.min(low), f64::max(most, high)]
    })
}

/// A circle about the axis, counter-clockwise if `sense` is 1, clockwise if it is -1.
fn circle(radius: f64, sense: f64) -> Vec<Side> {
    let (one, other) = (Vector::new(radius, 0.0), Vector::new(-radius, 0.0));
    vec![Side::new(one, other, sense), Side::new(other, one, sense)]
}
