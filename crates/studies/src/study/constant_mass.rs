//! Holes of one gear that remove the same share of the blank, however many and of whichever shape they are.

use std::f64::consts::PI;

use meshwright_engine::gear::{Helix, Member};
use meshwright_wire::declare::{Choice, Declared, Node, Number, document, number, word};
use meshwright_wire::gear::{BlankDocument, GearDocument, PatternDocument, SlotDocument};
use meshwright_wire::pair::PairDocument;
use meshwright_wire::units::significant;
use serde_json::{Map, Value, json};

document! {
    /// Sets the holes of each design so that they remove the same share of the blank: round ones get a radius, slots a width of twice that radius, the same in
    /// all patterns. A design without holes keeps none. The sizes stand among the changes of the design's row.
    pub(super) struct ConstantMass as "ConstantMass", "Constant mass" {
        /// The gear with the holes.
        pub(super) gear: Member = word("Gear"),
        /// The share of the blank that the holes remove. The blank is the ring between the bore and the mean of tip and root circle.
        mass_removed_percent: f64 = number("Mass removed", "%", 0.01, 99.0),
    }
}

/// The radius of the holes of a pattern.
fn hole_radius() -> Declared<Number> {
    PatternDocument::radius_mm.given()
}

/// The size of a pattern's holes, where it stands in the pattern.
const RADIUS: [&str; 1] = [PatternDocument::radius_mm.name];
const WIDTH: [&str; 2] = [PatternDocument::slot.name, SlotDocument::width_mm.name];

/// A pattern of holes whose size is to be set.
struct Pattern {
    /// Its place in a list of patterns; none where it stands alone.
    item: Option<String>,
    count: f64,
    /// Of slots the length of one between the centers of its ends, in mm, along the circle of the holes.
    arc: Option<f64>,
}

impl ConstantMass {
    /// True if `pointer` names a size that it sets: that of the pattern, or of each pattern of a list.
    pub(super) fn sets(&self, pointer: &str) -> bool {
        let Some(rest) = pointer.strip_prefix(&*self.holes_pointer()) else {
            return false;
        };
        let sizes = [&RADIUS[..], &WIDTH].map(|size| format!("/{}", size.join("/")));
        let items = sizes.iter().filter_map(|size| rest.strip_suffix(&**size));
        items.into_iter().any(|item| {
            let number = item.strip_prefix('/');
            item.is_empty()
                || number.is_some_and(|item| item.bytes().all(|byte| byte.is_ascii_digit()))
        })
    }

    fn holes_pointer(&self) -> String {
        format!("/pair/{}/blank/holes", self.gear.word())
    }

    /// Gives the holes of `submission` their radius r, and slots the width 2 r, and notes it among the changes; the patterns of a list get the same. The check
    /// of the submission reports values that cannot be read.
    ///
    /// Σ N (π r² + 2 r R φ) = percent · π (((r_a + r_f)/2)² − r_bore²), DESIGN section 4; R φ is the length of a slot between the centers of its ends.
    pub(super) fn apply(&self, submission: &mut Node, changes: &mut Map<String, Value>) {
        let gear = ["pair", self.gear.word()];
        let holes = ["pair", self.gear.word(), "blank", "holes"];
        let helix = submission.number_at(&["pair", PairDocument::helix_angle_deg.name]);
        let helix = Helix::right(helix.unwrap_or(0.0).to_radians());
        let Some(gear) = submission.at(&gear) else {
            return;
        };
        // Of a gear that cannot be read, as of one without a blank, any radius will do for the check to come to that.
        let blank_area = blank_area(gear, helix).unwrap_or(0.0);
        let patterns: Option<Vec<Pattern>> = match submission.at(&holes) {
            Some(pattern @ Node::Object(_)) => {
                Pattern::of(pattern, None).map(|pattern| vec![pattern])
            }
            Some(Node::List(patterns)) => {
                let numbered = patterns.iter().enumerate();
                let each = numbered.map(|(i, pattern)| Pattern::of(pattern, Some(i.to_string())));
                each.collect()
            }
            _ => None,
        };
        let Some(patterns) = patterns.filter(|patterns| !patterns.is_empty()) else {
            return;
        };
        let radius = if blank_area > 0.0 {
            let wanted = self.mass_removed_percent / 100.0 * blank_area;
            let round: f64 = PI * patterns.iter().map(|pattern| pattern.count).sum::<f64>();
            let arcs = patterns
                .iter()
                .map(|pattern| pattern.count * pattern.arc.unwrap_or(0.0));
            let arcs: f64 = arcs.sum();
            significant(wanted / (arcs + (arcs.powi(2) + round * wanted).sqrt()), 12)
        } else {
            hole_radius().spec.bounds.0
        };
        for pattern in &patterns {
            let mut place = holes.to_vec();
            place.extend(pattern.item.as_deref());
            let size = if pattern.arc.is_some() {
                place.extend(WIDTH);
                2.0 * radius
            } else {
                place.extend(RADIUS);
                radius
            };
            if blank_area > 0.0 {
                changes.insert(format!("/{}", place.join("/")), json!(size));
            }
            submission.put(&place, Node::Number(size));
        }
    }
}

impl Pattern {
    /// The pattern that `node` tells, if it can be read.
    fn of(node: &Node, item: Option<String>) -> Option<Self> {
        let slot = node.at(&[PatternDocument::slot.name]);
        let arc = match slot.filter(|slot| **slot != Node::Null) {
            None => None,
            Some(slot) => {
                let angle = slot.number_at(&[SlotDocument::angle_deg.name])?;
                let circle = node.number_at(&[PatternDocument::circle_radius_mm.name])?;
                Some(circle * angle.to_radians())
            }
        };
        Some(Self {
            item,
            count: count_of(node)?,
            arc,
        })
    }
}

/// The number of holes of a pattern, if it can be read.
fn count_of(pattern: &Node) -> Option<f64> {
    let count = match pattern.at(&[PatternDocument::at_deg.name]) {
        Some(Node::List(angles)) => Some(angles.len() as f64),
        _ => pattern.number_at(&[PatternDocument::count.name]),
    };
    count.filter(|&count| count >= 1.0)
}

/// The area between the bore and the mean of tip and root circle, in mm², of a gear whose teeth wind by `helix`.
fn blank_area(gear: &Node, helix: Helix) -> Option<f64> {
    let mut solid = gear.clone();
    solid.put(&["blank", BlankDocument::holes.name], Node::Null)?;
    let [r_a, r_f] = GearDocument::at(&solid)?.tip_and_root_mm(helix);
    let shaft = gear.at(&["blank", BlankDocument::shaft.name]);
    let bore = match shaft.filter(|shaft| **shaft != Node::Null) {
        Some(_) => 0.0,
        None => gear.number_at(&["blank", BlankDocument::bore_radius_mm.name])?,
    };
    Some(PI * (((r_a + r_f) / 2.0).powi(2) - bore.powi(2)))
}
