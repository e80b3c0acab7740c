//! The file: pairs of lines, a group code and its value, of which the entities and those of blocks are kept.

use std::borrow::Cow;
use std::collections::HashMap;
use std::str::FromStr;

/// The most bytes of a file: a drawing of a gear has some hundred thousand.
const MOST_BYTES: usize = 16 << 20;

/// The most entities of a file, and of its drawing with those of its blocks in each place where they stand.
pub(super) const MOST_ENTITIES: usize = 100_000;

/// First bytes of a binary file.
const BINARY: &[u8] = b"AutoCAD Binary DXF";

/// First bytes of the other format of the same program.
const DWG: &[u8] = b"AC10";

/// The codes of the groups that are read of an entity.
pub(super) mod code {
    /// The file of a block that stands in another.
    pub(in super::super) const PATH: i32 = 1;
    /// The block that an entity stands for.
    pub(in super::super) const NAME: i32 = 2;
    pub(in super::super) const LAYER: i32 = 8;
    pub(in super::super) const X: i32 = 10;
    pub(in super::super) const Y: i32 = 20;
    pub(in super::super) const Z: i32 = 30;
    pub(in super::super) const END_X: i32 = 11;
    pub(in super::super) const END_Y: i32 = 21;
    pub(in super::super) const END_Z: i32 = 31;
    pub(in super::super) const RADIUS: i32 = 40;
    /// The length of the minor axis of an ellipse over that of the major one.
    pub(in super::super) const RATIO: i32 = 40;
    pub(in super::super) const KNOT: i32 = 40;
    pub(in super::super) const WEIGHT: i32 = 41;
    pub(in super::super) const BULGE: i32 = 42;
    /// Where an ellipse begins and ends, in radians from its major axis.
    pub(in super::super) const PARAMETERS: [i32; 2] = [41, 42];
    /// The scales of a block along x and y.
    pub(in super::super) const SCALES: [i32; 2] = [41, 42];
    /// The columns and rows of a block that stands in several places, and how far they are apart.
    pub(in super::super) const COUNTS: [i32; 2] = [70, 71];
    pub(in super::super) const SPACINGS: [i32; 2] = [44, 45];
    /// The angle of a block, in degrees.
    pub(in super::super) const ROTATION: i32 = 50;
    pub(in super::super) const START_ANGLE: i32 = 50;
    pub(in super::super) const END_ANGLE: i32 = 51;
    /// Not 0 if it is not seen.
    pub(in super::super) const HIDDEN: i32 = 60;
    /// Not 0 if it belongs to a sheet of paper.
    pub(in super::super) const PAPER: i32 = 67;
    pub(in super::super) const FLAGS: i32 = 70;
    pub(in super::super) const DEGREE: i32 = 71;
    /// The direction out of its plane.
    pub(in super::super) const NORMAL: [i32; 3] = [210, 220, 230];
    /// The unit of a drawing, in its header.
    pub(super) const UNIT: i32 = 70;
}

/// A drawing.
#[derive(Debug)]
pub(super) struct File<'a> {
    pub(super) entities: Vec<Entity<'a>>,
    /// The blocks, by their names in small letters.
    pub(super) blocks: HashMap<String, Block<'a>>,
    /// The unit, if it says one.
    pub(super) unit: Option<Unit>,
}

/// A part of a drawing that stands in one or several places of it.
#[derive(Debug)]
pub(super) struct Block<'a> {
    /// Says its name, its flags and its base point.
    pub(super) head: Entity<'a>,
    pub(super) entities: Vec<Entity<'a>>,
}

/// A unit of length.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit {
    pub(super) name: &'static str,
    pub(super) in_mm: f64,
}

/// An entity with the groups that it has.
#[derive(Debug)]
pub(super) struct Entity<'a> {
    pub(super) name: &'a str,
    /// The line of its name, counted from 1.
    pub(super) line: usize,
    pub(super) groups: Vec<(i32, &'a str)>,
}

impl Entity<'_> {
    /// The value of the first group with this code.
    pub(super) fn text(&self, code: i32) -> Option<&str> {
        let group = self.groups.iter().find(|group| group.0 == code);
        group.map(|group| group.1)
    }

    /// The same as a number, or `default` if there is none.
    ///
    /// # Errors
    ///
    /// The end of a sentence, if it is no number, or if there is neither group nor default.
    pub(super) fn number(&self, code: i32, default: Option<f64>) -> Result<f64, String> {
        match (self.text(code), default) {
            (Some(text), _) => number(code, text),
            (None, Some(default)) => Ok(default),
            (None, None) => Err(format!("has no group {code}")),
        }
    }

    /// A group of flags; none are set if there is no such group.
    pub(super) fn flags(&self, code: i32) -> u16 {
        self.text(code).and_then(whole).unwrap_or(0)
    }

    pub(super) fn layer(&self) -> &str {
        self.text(code::LAYER).unwrap_or("0")
    }
}

/// A number of a group.
///
/// # Errors
///
/// The end of a sentence, if it is none.
pub(super) fn number(code: i32, text: &str) -> Result<f64, String> {
    let number = f64::from_str(text).ok().filter(|number| number.is_finite());
    number.ok_or_else(|| format!("has a group {code} that is no number"))
}

fn whole<T: FromStr>(text: &str) -> Option<T> {
    text.parse().ok()
}

/// The entities of a file, and its unit.
///
/// # Errors
///
/// A sentence, if it is too large, no DXF in text or cut off, or if its unit is none for a gear.
pub(super) fn parsed(text: &str) -> Result<File<'_>, String> {
    let mut entities: Vec<Entity<'_>> = Vec::new();
    let mut blocks: HashMap<String, Block<'_>> = HashMap::new();
    let (mut block, mut count): (Option<Block<'_>>, usize) = (None, 0);
    let mut unit = None;
    let (mut section, mut variable) = ("", "");
    let (mut begins, mut is_whole) = (false, false);
    let mut lines = (1..).zip(text.lines());
    while let Some((line, first)) = lines.next() {
        let code: i32 = whole(first.trim()).ok_or_else(|| {
            format!("Line {line} is no group code: it is no DXF in text, or it is damaged before.")
        })?;
        let Some((_, value)) = lines.next() else {
            break;
        };
        let value = value.trim();
        match (code, value) {
            (0, "EOF") => break,
            (0, "SECTION") => begins = true,
            (0, "ENDSEC") => {
                is_whole |= section == "ENTITIES";
                section = "";
            }
            (code::NAME, name) if begins => {
                begins = false;
                section = name;
            }
            (0, "ENDBLK") if section == "BLOCKS" => {
                if let Some(block) = block.take() {
                    let name = block.head.text(code::NAME).unwrap_or_default();
                    blocks.insert(name.to_lowercase(), block);
                }
            }
            (0, name) if section == "ENTITIES" || section == "BLOCKS" => {
                count += 1;
                if count > MOST_ENTITIES {
                    return Err(format!(
                        "It has more than {MOST_ENTITIES} entities, of which no more are read."
                    ));
                }
                let entity = Entity {
                    name,
                    line: line + 1,
                    groups: Vec::new(),
                };
                match &mut block {
                    _ if section == "ENTITIES" => entities.push(entity),
                    _ if name == "BLOCK" => {
                        block = Some(Block {
                            head: entity,
                            entities: Vec::new(),
                        });
                    }
                    Some(block) => block.entities.push(entity),
                    // Stands in no block.
                    None => {}
                }
            }
            (9, name) if section == "HEADER" => variable = name,
            (code::UNIT, said) if section == "HEADER" && variable == "$INSUNITS" => {
                unit = unit_of(said)?;
            }
            // Groups beyond are data that other programs attach.
            (..1000, value) if section == "ENTITIES" => {
                if let Some(entity) = entities.last_mut() {
                    entity.groups.push((code, value));
                }
            }
            (..1000, value) if section == "BLOCKS" => {
                if let Some(Block { head, entities }) = &mut block {
                    let entity = entities.last_mut().unwrap_or(head);
                    entity.groups.push((code, value));
                }
            }
            _ => {}
        }
    }
    if is_whole {
        Ok(File {
            entities,
            blocks,
            unit,
        })
    } else {
        Err("It has no section ENTITIES, or is cut off within it.".to_owned())
    }
}

/// The unit that `$INSUNITS` stands for; `None` of no unit.
fn unit_of(said: &str) -> Result<Option<Unit>, String> {
    let (name, in_mm) = match said {
        "0" => return Ok(None),
        "1" => ("inches", 25.4),
        "2" => ("feet", 304.8),
        "4" => ("mm", 1.0),
        "5" => ("cm", 10.0),
        "6" => ("m", 1000.0),
        "9" => ("mils", 0.0254),
        "13" => ("micrometers", 1e-3),
        "14" => ("dm", 100.0),
        _ => {
            return Err(format!(
                "Its unit, $INSUNITS, is {said}, which is not taken for a gear: set 4 for mm, or 1 for inches."
            ));
        }
    };
    Ok(Some(Unit { name, in_mm }))
}

/// The text of a file. Since 2007 it is in UTF-8, before it was in the encoding of the country, of which only names of layers tell.
///
/// # Errors
///
/// A sentence, if it is too large or of another format.
pub(super) fn decoded(bytes: &[u8]) -> Result<Cow<'_, str>, String> {
    if bytes.len() > MOST_BYTES {
        return Err(format!(
            "It has {} bytes; at most {MOST_BYTES} are read.",
            bytes.len()
        ));
    }
    if bytes.starts_with(BINARY) {
        return Err("It is a binary DXF: save it as text (ASCII).".to_owned());
    }
    if bytes.starts_with(DWG) {
        return Err("It is a DWG: save it as DXF.".to_owned());
    }
    Ok(match std::str::from_utf8(bytes) {
        Ok(text) => text.trim_start_matches('\u{FEFF}').into(),
        Err(_) => encoding_rs::WINDOWS_1252.decode(bytes).0,
    })
}
