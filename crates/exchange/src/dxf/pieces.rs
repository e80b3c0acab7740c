//! The lines and arcs of a drawing, those of its blocks with them.

use std::collections::{BTreeMap, BTreeSet};

use meshwright_engine::gear::{Side, Vector};

use super::chain::Piece;
use super::file::{Entity, File, MOST_ENTITIES, code};
use super::insert::{Motion, Places};
use super::outline::{MOST_FAULTS, MOST_SIDES, Refused, SHORTEST_MM};
use super::shape::{self, Kind, Made};

/// The most that a coordinate of a submission may be, in mm.
const FARTHEST_MM: f64 = 25_000.0;

/// An arc that stands out from its chord by no more is a line, in mm.
const STRAIGHT_MM: f64 = 1e-6;

/// Blocks may stand within each other so deep.
const DEEPEST: usize = 16;

/// An entity that has lines and arcs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) entity: &'a Entity<'a>,
    /// The layer on which it is seen.
    pub(super) layer: &'a str,
    /// The block of which it is a part.
    block: Option<&'a str>,
    pub(super) made: Made,
}

impl Source<'_> {
    /// Kind and place.
    pub(super) fn place(&self) -> String {
        let block = self.block.map(|block| format!(" of the block {block}"));
        place(self.entity, self.layer) + &block.unwrap_or_default()
    }
}

/// Pieces of a drawing.
#[derive(Debug, Default)]
pub(super) struct Pieces<'a> {
    pub(super) pieces: Vec<Piece>,
    /// The entities that the pieces are of, by their numbers.
    pub(super) sources: Vec<Source<'a>>,
    /// How many entities of which kind are no part of an outline.
    left_out: BTreeMap<String, usize>,
    /// The layers on which something is.
    layers: BTreeSet<&'a str>,
    faults: Vec<String>,
    /// The entities that were looked at, so that blocks in blocks end.
    seen: usize,
}

/// Reader of the entities of a drawing, with the settings that they share.
pub(super) struct Reader<'a> {
    pub(super) file: &'a File<'a>,
    /// The layers that are asked for; all if there are none.
    pub(super) layers: &'a [String],
    pub(super) in_mm: f64,
}

/// The place of entities: as deep in blocks, of this block, moved so, and on this layer where they are on none of their own.
#[derive(Clone, Copy)]
struct Place<'a> {
    depth: usize,
    block: Option<&'a str>,
    motion: Motion,
    layer: Option<&'a str>,
}

impl<'a> Reader<'a> {
    /// The lines and arcs of everything that is asked for, about `center`.
    ///
    /// # Errors
    ///
    /// Entities that are not read and may change the outline, and that there are too many.
    pub(super) fn pieces(&self, center: Vector) -> Result<Pieces<'a>, Refused> {
        let mut found = Pieces::default();
        let place = Place {
            depth: 0,
            block: None,
            motion: Motion::to_origin(center),
            layer: None,
        };
        self.read(&self.file.entities, place, &mut found)?;
        if !found.faults.is_empty() {
            return Err(Refused(found.faults));
        }
        if found.pieces.is_empty() {
            return Err(self.nothing(&found).into());
        }
        Ok(found)
    }

    /// Reads the entities of one group. Faults of one of them are added to the list.
    ///
    /// # Errors
    ///
    /// A sentence, if there are too many.
    fn read(
        &self,
        entities: &'a [Entity<'a>],
        place: Place<'a>,
        found: &mut Pieces<'a>,
    ) -> Result<(), String> {
        let mut next = 0;
        while let Some(entity) = entities.get(next) {
            let rest = &entities[next + 1..];
            let is_vertex =
                |other: &&Entity<'_>| entity.name == "POLYLINE" && other.name == "VERTEX";
            let count = rest.iter().take_while(is_vertex).count();
            next += 1 + count;
            found.count(1 + count)?;
            // An entity without a layer of its own in a block is on that of the block.
            let own = Some(entity.layer()).filter(|layer| *layer != NO_LAYER);
            let layer = own.or(place.layer).unwrap_or(NO_LAYER);
            found.layers.insert(layer);
            let is_asked = self.is_asked(layer);
            let is_seen = entity.flags(code::PAPER) == 0 && entity.flags(code::HIDDEN) == 0;
            if is_asked && !is_seen {
                found.leave_out("of sheets of paper or hidden");
            }
            // A block has entities on other layers than its own.
            if !is_seen || !is_asked && entity.name != "INSERT" {
                continue;
            }
            let kind = shape::kind(entity, &rest[..count], self.in_mm);
            let read = kind.and_then(|kind| match kind {
                Kind::Annotation if entity.name == "SEQEND" => Ok(None),
                Kind::Annotation => {
                    found.leave_out(entity.name);
                    Ok(None)
                }
                Kind::Block => self.places(entity, &place.motion).map(Some),
                Kind::Sides(sides, made) => {
                    let source = Source {
                        entity,
                        layer,
                        block: place.block,
                        made,
                    };
                    self.take(&sides, &place.motion, source, found)?;
                    Ok(None)
                }
            });
            match read {
                Ok(None) => {}
                Ok(Some((block, places))) => {
                    let inner = Place {
                        depth: place.depth + 1,
                        layer: Some(layer),
                        ..place
                    };
                    self.read_block(entity, block, &places, inner, found)?;
                }
                Err(detail) => {
                    let source = Source {
                        entity,
                        layer,
                        block: place.block,
                        made: Made::Drawn,
                    };
                    found.wrong(format!("{} {detail}.", source.place()));
                }
            }
            if found.pieces.len() > MOST_SIDES {
                return Err(format!(
                    "There are more than {MOST_SIDES} lines and arcs; choose the layer of the openings with --layer."
                ));
            }
        }
        Ok(())
    }

    fn is_asked(&self, layer: &str) -> bool {
        let same = |asked: &String| asked.to_lowercase() == layer.to_lowercase();
        self.layers.is_empty() || self.layers.iter().any(same)
    }

    /// The block for which `insert` stands, and where it does.
    fn places(
        &self,
        insert: &'a Entity<'a>,
        motion: &Motion,
    ) -> Result<(&'a super::file::Block<'a>, Places), String> {
        let name = insert.text(code::NAME).unwrap_or_default();
        let Some(block) = self.file.blocks.get(&name.to_lowercase()) else {
            return Err(format!(
                "stands for the block {name}, which is not in the file"
            ));
        };
        if block.head.flags(code::FLAGS) & (OTHER_FILE | LAID_OVER) != 0 {
            let path = block.head.text(code::PATH).unwrap_or_default();
            let path: String = path.chars().take(120).collect();
            return Err(format!(
                "stands for the block {name} in another file, {path}: bind it to the drawing"
            ));
        }
        Ok((block, Places::of(insert, &block.head, motion)?))
    }

    /// Reads a block in each of its places.
    fn read_block(
        &self,
        insert: &'a Entity<'a>,
        block: &'a super::file::Block<'a>,
        places: &Places,
        place: Place<'a>,
        found: &mut Pieces<'a>,
    ) -> Result<(), String> {
        let name = insert.text(code::NAME).unwrap_or_default();
        let before = (found.pieces.len(), found.sources.len(), found.faults.len());
        for motion in places.motions() {
            // A block of nothing takes time too.
            found.count(1)?;
            if place.depth > DEEPEST {
                found.wrong(format!(
                    "The block {name} stands in others more than {DEEPEST} deep."
                ));
                return Ok(());
            }
            let place = Place {
                block: Some(name),
                motion,
                ..place
            };
            self.read(&block.entities, place, found)?;
        }
        let is_more = found.pieces.len() > before.0 || found.faults.len() > before.2;
        if let Some([x, y]) = places.scales.filter(|_| is_more) {
            found.pieces.truncate(before.0);
            found.sources.truncate(before.1);
            found.faults.truncate(before.2);
            found.wrong(format!(
                "{} stands for the block {name} at the scale {x}, {y}: blocks are read at the scale 1; explode it.",
                self::place(insert, place.layer.unwrap_or(NO_LAYER))
            ));
        }
        Ok(())
    }

    /// Takes the sides of an entity, each beginning exactly where the one before it ends if it is to.
    fn take(
        &self,
        sides: &[Side],
        motion: &Motion,
        source: Source<'a>,
        found: &mut Pieces<'a>,
    ) -> Result<(), String> {
        let moved: Vec<Side> = sides.iter().map(|side| motion.side(side)).collect();
        let is_near = |point: Vector| point.norm() * self.in_mm <= FARTHEST_MM;
        let is_near = |side: &Side| is_near(side.from) && is_near(side.to);
        if !moved.iter().all(is_near) {
            return Err(format!(
                "reaches more than {FARTHEST_MM} mm from the axis; look at the unit of the drawing, and at --center"
            ));
        }
        let number = found.sources.len();
        let before = found.pieces.len();
        // Where the last side ends that was left out, and where the one before it does.
        let mut skipped: Option<[Vector; 2]> = None;
        for side in moved {
            let from = match skipped {
                Some([end, from]) if end == side.from => from,
                _ => side.from,
            };
            let chord = (side.to - from).norm() * self.in_mm;
            if chord <= SHORTEST_MM {
                skipped = Some([side.to, from]);
                continue;
            }
            skipped = None;
            let is_line = side.bulge.abs() * chord / 2.0 <= STRAIGHT_MM;
            let bulge = if is_line { 0.0 } else { side.bulge };
            found.pieces.push(Piece {
                side: Side::new(from, side.to, bulge),
                source: number,
            });
        }
        // The last of them goes to the side before.
        if let (Some([end, from]), Some(last)) = (skipped, found.pieces[before..].last_mut())
            && last.side.to == from
        {
            last.side = Side::new(last.side.from, end, last.side.bulge);
        }
        if found.pieces.len() == before {
            found.leave_out("shorter than 0.001 mm");
        } else {
            found.sources.push(source);
        }
        Ok(())
    }

    /// That there is no line and no arc.
    fn nothing(&self, found: &Pieces<'_>) -> String {
        let known: Vec<&str> = found.layers.iter().copied().take(MOST_FAULTS).collect();
        let on = match self.layers {
            [] => String::new(),
            layers => format!(" on layer {}", layers.join(" or ")),
        };
        if known.is_empty() {
            return format!("There are no lines and arcs{on}; the drawing has no entities.");
        }
        format!(
            "There are no lines and arcs{on}; entities are on: {}.",
            known.join(", ")
        )
    }
}

/// The layer of entities without one.
const NO_LAYER: &str = "0";

/// Flags of a block.
const OTHER_FILE: u16 = 4;
const LAID_OVER: u16 = 8;

impl Pieces<'_> {
    fn leave_out(&mut self, what: &str) {
        *self.left_out.entry(what.to_owned()).or_default() += 1;
    }

    /// Counts entities that are looked at.
    ///
    /// # Errors
    ///
    /// A sentence, if there are too many.
    fn count(&mut self, entities: usize) -> Result<(), String> {
        self.seen += entities;
        if self.seen <= MOST_ENTITIES {
            return Ok(());
        }
        Err(format!(
            "There are more than {MOST_ENTITIES} entities, those of its blocks in each of their places with them; choose the layer of the openings with --layer, or explode the blocks."
        ))
    }

    /// Adds a fault, up to the number that is reported.
    fn wrong(&mut self, sentence: String) {
        if self.faults.len() <= MOST_FAULTS {
            self.faults.push(sentence);
        }
    }

    /// A sentence about an entity that is not part of an outline.
    pub(super) fn left_out(&self) -> Option<String> {
        let left_out = self.left_out.iter();
        let left_out: Vec<String> = left_out
            .map(|(what, count)| format!("{count} {what}"))
            .collect();
        (!left_out.is_empty()).then(|| format!("Left out: {}.", left_out.join(", ")))
    }
}

/// Kind and place of an entity.
fn place(entity: &Entity<'_>, layer: &str) -> String {
    format!("{} on layer {layer}, line {}", entity.name, entity.line)
}
