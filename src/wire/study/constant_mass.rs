//! Holes of one gear that remove the same share of the blank, however many they are.

use std::f64::consts::PI;

use meshwright_engine::gear::Member;
use serde_json::{Map, Value, json};

use crate::wire::declare::{Choice, Declared, Node, Number, document, number, word, words};
use crate::wire::gear::{BlankDocument, GearDocument, PatternDocument};
use crate::wire::units::significant;

words! {
    Member {
        Driving = "driving": "gear 1, which drives",
        Driven = "driven": "gear 2, which is driven",
    }
}

document! {
    /// Sets the hole radius of each design so that its holes remove the same share of the blank. A design without holes is left alone.
    /// The radius stands among the changes of the design's row.
    pub(super) struct ConstantMass as "ConstantMass", "Constant mass" {
        /// The gear with the holes.
        pub(super) gear: Member = word("Gear"),
        /// The share of the blank that the holes remove. The blank is the ring between the bore and the mean of tip and root circle.
        mass_removed_percent: f64 = number("Mass removed", "%", 0.01, 99.0),
    }
}

/// The radius of the holes of a pattern.
fn hole_radius() -> Declared<Number> {
    PatternDocument::radius_mm.map(|optional| optional.spec)
}

impl ConstantMass {
    /// Whether `pointer` names a radius that it sets: that of the pattern, or of each pattern of a list.
    pub(super) fn sets(&self, pointer: &str) -> bool {
        let within = pointer.strip_prefix(&*self.holes_pointer());
        let Some(rest) = within.and_then(|rest| rest.strip_suffix(hole_radius().name)) else {
            return false;
        };
        let item = rest
            .strip_suffix('/')
            .and_then(|rest| rest.strip_prefix('/'));
        rest == "/" || item.is_some_and(|item| item.bytes().all(|byte| byte.is_ascii_digit()))
    }

    fn holes_pointer(&self) -> String {
        format!("/pair/{}/blank/holes", self.gear.word())
    }

    /// Gives the holes of `submission` their radius, and notes it among the changes; the patterns of a list get the same. What cannot
    /// be read is left to the check of the submission.
    ///
    /// N π r² = percent · π (((r_a + r_f)/2)² − r_bore²), DESIGN section 4.
    pub(super) fn apply(&self, submission: &mut Node, changes: &mut Map<String, Value>) {
        let gear = ["pair", self.gear.word()];
        let holes = ["pair", self.gear.word(), "blank", "holes"];
        let Some(blank_area) = submission.at(&gear).and_then(blank_area) else {
            return;
        };
        let counts: Option<Vec<(String, f64)>> = match submission.at(&holes) {
            Some(pattern @ Node::Object(_)) => {
                count_of(pattern).map(|count| vec![(String::new(), count)])
            }
            Some(Node::List(patterns)) => {
                let numbered = patterns.iter().enumerate();
                let count =
                    |(i, pattern): (usize, &Node)| Some((i.to_string(), count_of(pattern)?));
                numbered.map(count).collect()
            }
            _ => None,
        };
        let Some(counts) = counts.filter(|counts| !counts.is_empty()) else {
            return;
        };
        let count: f64 = counts.iter().map(|(_, count)| count).sum();
        // If the bore leaves no blank, any radius will do for the check to come to that.
        let radius = if blank_area > 0.0 {
            significant(
                (self.mass_removed_percent / 100.0 * blank_area / (PI * count)).sqrt(),
                12,
            )
        } else {
            hole_radius().spec.bounds.0
        };
        let name = hole_radius().name;
        for (item, _) in &counts {
            let mut place = holes.to_vec();
            place.extend((!item.is_empty()).then_some(&**item));
            place.push(name);
            if blank_area > 0.0 {
                changes.insert(format!("/{}", place.join("/")), json!(radius));
            }
            submission.put(&place, Node::Number(radius));
        }
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

/// The area between the bore and the mean of tip and root circle, in mm².
fn blank_area(gear: &Node) -> Option<f64> {
    let given = |name: &str| {
        let node = gear.at(&[name]).filter(|node| **node != Node::Null);
        node.map(|_| gear.number_at(&[name]))
    };
    let m = given(GearDocument::module_mm.name)??;
    let z = given(GearDocument::tooth_count.name)??;
    let or_preset =
        |name: &str, number: Number| given(name).unwrap_or_else(|| number.preset(Some(m)));
    let (shift, dedendum) = (GearDocument::profile_shift, GearDocument::dedendum_mm);
    let addendum = GearDocument::addendum_mm;
    let shifted = m * z / 2.0 + or_preset(shift.name, shift.spec)? * m;
    let r_a = match given(GearDocument::tip_diameter_mm.name) {
        Some(diameter) => diameter? / 2.0,
        None => shifted + or_preset(addendum.name, addendum.spec.spec)?,
    };
    let r_f = shifted - or_preset(dedendum.name, dedendum.spec)?;
    let bore = gear.number_at(&["blank", BlankDocument::bore_radius_mm.name])?;
    Some(PI * (((r_a + r_f) / 2.0).powi(2) - bore.powi(2)))
}
