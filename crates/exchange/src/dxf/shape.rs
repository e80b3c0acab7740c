//! The lines and arcs of entities.

use std::f64::consts::{PI, TAU};

use meshwright_engine::gear::{Side, Vector};

use super::curve::{Splined, ellipse, spline};
use super::file::{Entity, code, number};

/// The largest bulge: an arc that lacks 4e-6 of a circle.
const LARGEST_BULGE: f64 = 1e6;

/// Entities that are seen beside an outline and do not change it.
const ANNOTATIONS: [&str; 23] = [
    "ACAD_TABLE",
    "ARCALIGNEDTEXT",
    "ARC_DIMENSION",
    "ATTDEF",
    "ATTRIB",
    "DIMENSION",
    "HATCH",
    "IMAGE",
    "LARGE_RADIAL_DIMENSION",
    "LEADER",
    "MTEXT",
    "MULTILEADER",
    "OLE2FRAME",
    "OLEFRAME",
    "POINT",
    "RAY",
    "RTEXT",
    "SEQEND",
    "TEXT",
    "TOLERANCE",
    "VIEWPORT",
    "WIPEOUT",
    "XLINE",
];

/// Kind of an entity.
pub(super) enum Kind {
    /// Lines and arcs, in the unit of the drawing, and how they are had. No arc turns by more than a half turn.
    Sides(Vec<Side>, Made),
    /// A part of the drawing that stands elsewhere in the file.
    Block,
    /// Nothing of an outline.
    Annotation,
}

/// How the lines and arcs of an entity are had.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Made {
    /// The file says them.
    Drawn,
    /// They follow a curve to within a micrometer.
    Fitted,
    /// They join points of a curve, and how it runs between them is not said: the end of a sentence says why.
    Guessed(&'static str),
}

/// The kind of `entity`; `vertices` are those that follow it.
///
/// # Errors
///
/// The end of a sentence that begins with its kind.
pub(super) fn kind(
    entity: &Entity<'_>,
    vertices: &[Entity<'_>],
    in_mm: f64,
) -> Result<Kind, String> {
    let mut made = Made::Drawn;
    let sides = match entity.name {
        "LINE" => line(entity)?,
        "CIRCLE" => arc(entity, 0.0, TAU)?,
        "ARC" => {
            let [start, end] =
                [code::START_ANGLE, code::END_ANGLE].map(|code| entity.number(code, None));
            let (start, end) = (start?.to_radians(), end?.to_radians());
            let turn = (end - start).rem_euclid(TAU);
            arc(entity, start, if turn > 0.0 { turn } else { TAU })?
        }
        "ELLIPSE" => {
            made = Made::Fitted;
            ellipse(entity, is_seen_from_below(entity)?, in_mm)?
        }
        "SPLINE" => match spline(entity, in_mm)? {
            Splined::Sides(sides) => {
                made = Made::Fitted;
                sides
            }
            Splined::Points(points) => {
                made = Made::Guessed(THROUGH_POINTS);
                let closing = (entity.flags(code::FLAGS) & CLOSED != 0).then(|| points[0]);
                let ends: Vec<Vector> = points.into_iter().chain(closing).collect();
                joined(&ends)
            }
        },
        "LWPOLYLINE" => polyline(entity, &corners(entity)?)?,
        "POLYLINE" => {
            let flags = entity.flags(code::FLAGS);
            if flags & (MESH | FACES) != 0 {
                return Err("is a surface: draw its edge in lines and arcs".to_owned());
            }
            let is_splined = flags & SPLINE != 0;
            if is_splined {
                made = Made::Guessed(THROUGH_POINTS);
            }
            // The frame of a spline is seen beside it.
            let is_corner =
                |vertex: &&Entity<'_>| !is_splined || vertex.flags(code::FLAGS) & FRAME == 0;
            let corners = vertices.iter().filter(is_corner).map(corners);
            let corners: Result<Vec<_>, _> = corners.collect();
            polyline(entity, &corners?.concat())?
        }
        "INSERT" => return Ok(Kind::Block),
        name if ANNOTATIONS.contains(&name) => return Ok(Kind::Annotation),
        _ => {
            return Err(
                "is not read, and may change the outline: draw it in lines and arcs, or put it on another layer".to_owned(),
            );
        }
    };
    Ok(Kind::Sides(sides, made))
}

/// Why the points of a spline are no outline.
const THROUGH_POINTS: &str = "is a spline of which the file has points that it goes through, and not how it runs between them: write it with control points, or draw it in lines and arcs";

/// The lines from point to point.
fn joined(points: &[Vector]) -> Vec<Side> {
    let lines = points.windows(2).filter(|ends| ends[0] != ends[1]);
    lines.map(|ends| Side::new(ends[0], ends[1], 0.0)).collect()
}

/// Flags of a polyline.
const CLOSED: u16 = 1;
const SPLINE: u16 = 4;
const SPACE: u16 = 8;
const MESH: u16 = 16;
const FACES: u16 = 64;

/// The flag of a vertex that belongs to the frame of a spline.
const FRAME: u16 = 16;

fn line(entity: &Entity<'_>) -> Result<Vec<Side>, String> {
    let [x, y, z] = [code::X, code::Y, code::Z].map(|code| entity.number(code, default(code)));
    let [u, v, w] =
        [code::END_X, code::END_Y, code::END_Z].map(|code| entity.number(code, default(code)));
    if (z? - w?).abs() > 1e-6 {
        return Err("does not lie in the plane of the drawing".to_owned());
    }
    Ok(vec![Side::new(
        Vector::new(x?, y?),
        Vector::new(u?, v?),
        0.0,
    )])
}

/// Only heights may be left out.
fn default(code: i32) -> Option<f64> {
    [code::Z, code::END_Z].contains(&code).then_some(0.0)
}

fn arc(entity: &Entity<'_>, start: f64, turn: f64) -> Result<Vec<Side>, String> {
    let [x, y, radius] = [code::X, code::Y, code::RADIUS].map(|code| entity.number(code, None));
    let (center, radius) = (Vector::new(x?, y?), radius?);
    if radius <= 0.0 {
        return Err(format!("has the radius {radius}"));
    }
    let is_seen_from_below = is_seen_from_below(entity)?;
    let parts = if turn > PI { 2 } else { 1 };
    let step = turn / f64::from(parts);
    let at = |i: u8| {
        let angle = start + f64::from(i) * step;
        center + radius * Vector::new(angle.cos(), angle.sin())
    };
    let sides = (0..parts).map(|i| Side::new(at(i), at(i + 1), (step / 4.0).tan()));
    Ok(sides
        .map(|side| turned_over(side, is_seen_from_below))
        .collect())
}

/// A corner of a polyline: where it stands, its height, and the bulge of the side that begins there.
type Corner = (Vector, f64, f64);

/// The corners that the groups of an entity say.
fn corners(entity: &Entity<'_>) -> Result<Vec<Corner>, String> {
    let mut corners: Vec<Corner> = Vec::new();
    for (code, text) in &entity.groups {
        if *code == code::X {
            corners.push((Vector::new(number(*code, text)?, 0.0), 0.0, 0.0));
        }
        let Some((at, height, bulge)) = corners.last_mut() else {
            continue;
        };
        match *code {
            code::Y => at.y = number(*code, text)?,
            code::Z => *height = number(*code, text)?,
            code::BULGE => *bulge = number(*code, text)?,
            _ => {}
        }
    }
    Ok(corners)
}

fn polyline(entity: &Entity<'_>, corners: &[Corner]) -> Result<Vec<Side>, String> {
    let flags = entity.flags(code::FLAGS);
    let is_seen_from_below = flags & SPACE == 0 && is_seen_from_below(entity)?;
    let mut sides = Vec::new();
    for (i, (from, height, bulge)) in corners.iter().enumerate() {
        let next = match corners.get(i + 1) {
            Some(next) => next,
            None if flags & CLOSED != 0 => &corners[0],
            None => break,
        };
        if (next.1 - height).abs() > 1e-6 {
            return Err("does not lie in the plane of the drawing".to_owned());
        }
        if bulge.abs() > LARGEST_BULGE {
            return Err(format!("has the bulge {bulge} at its corner {}", i + 1));
        }
        let side = Side::new(*from, next.0, *bulge);
        if bulge.abs() > 1.0 {
            let (middle, half) = (side.middle(), (bulge.atan() / 2.0).tan());
            sides.extend([
                Side::new(*from, middle, half),
                Side::new(middle, next.0, half),
            ]);
        } else {
            sides.push(side);
        }
    }
    Ok(sides
        .into_iter()
        .map(|side| turned_over(side, is_seen_from_below))
        .collect())
}

/// True if the plane of an entity is that of the drawing seen from below: its x axis then runs the other way.
pub(super) fn is_seen_from_below(entity: &Entity<'_>) -> Result<bool, String> {
    let [x, y, z] = code::NORMAL;
    let [x, y, z] =
        [(x, 0.0), (y, 0.0), (z, 1.0)].map(|(code, default)| entity.number(code, Some(default)));
    let (x, y, z) = (x?, y?, z?);
    if x.hypot(y) <= 1e-9 * z.abs() {
        Ok(z < 0.0)
    } else {
        Err("does not lie in the plane of the drawing".to_owned())
    }
}

fn turned_over(side: Side, is_seen_from_below: bool) -> Side {
    let over = |point: Vector| Vector::new(-point.x, point.y);
    if is_seen_from_below {
        Side::new(over(side.from), over(side.to), -side.bulge)
    } else {
        side
    }
}
