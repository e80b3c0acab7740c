//! Holes of one gear that remove the same share of the blank, however many they are.

use std::f64::consts::PI;

use meshwright_engine::gear::Member;
use serde_json::{Map, Value, json};

use crate::wire::quantity::{self, Preset, Quantity};
use crate::wire::tree::{Choice, Node, ObjectReader};
use crate::wire::units::significant;

pub(super) const MASS_REMOVED: Quantity = Quantity {
    name: "mass_removed_percent",
    title: "Mass removed",
    unit: "%",
    description: "The share of the blank that the holes remove. The blank is the ring between the bore and the mean of tip and root circle.",
    bounds: (0.01, 99.0),
    preset: Preset::Needed,
    whole: false,
    or_zero: false,
};

impl Choice for Member {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        ("driving", Self::Driving, "gear 1, which drives"),
        ("driven", Self::Driven, "gear 2, which is driven"),
    ];
}

/// The rule that sets the hole radius of each design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ConstantMass {
    pub(super) gear: Member,
    percent: f64,
}

impl ConstantMass {
    pub(super) fn read(mut rule: ObjectReader<'_>) -> Option<Self> {
        let gear = rule.choice::<Member>("gear", None);
        let percent = rule.number(&MASS_REMOVED, None);
        rule.finish();
        Some(Self {
            gear: gear?,
            percent: percent?,
        })
    }

    /// Whether `pointer` names a radius that it sets: that of the pattern, or of each pattern of a list.
    pub(super) fn sets(self, pointer: &str) -> bool {
        let within = pointer.strip_prefix(&*self.holes_pointer());
        let Some(rest) = within.and_then(|rest| rest.strip_suffix(quantity::HOLE_RADIUS.name))
        else {
            return false;
        };
        let item = rest
            .strip_suffix('/')
            .and_then(|rest| rest.strip_prefix('/'));
        rest == "/" || item.is_some_and(|item| item.bytes().all(|byte| byte.is_ascii_digit()))
    }

    fn holes_pointer(self) -> String {
        format!("/pair/{}/blank/holes", self.gear.word())
    }

    /// Gives the holes of `submission` their radius, and notes it among the changes; the patterns of a list get the same. What cannot
    /// be read is left to the check of the submission.
    ///
    /// N π r² = percent · π (((r_a + r_f)/2)² − r_bore²), DESIGN section 4.
    pub(super) fn apply(self, submission: &mut Node, changes: &mut Map<String, Value>) {
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
                (self.percent / 100.0 * blank_area / (PI * count)).sqrt(),
                12,
            )
        } else {
            quantity::HOLE_RADIUS.bounds.0
        };
        let name = quantity::HOLE_RADIUS.name;
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
    let count = match pattern.at(&[quantity::HOLE_ANGLES.name]) {
        Some(Node::List(angles)) => Some(angles.len() as f64),
        _ => pattern.number_at(&[quantity::HOLE_COUNT.name]),
    };
    count.filter(|&count| count >= 1.0)
}

/// The area between the bore and the mean of tip and root circle, in mm².
fn blank_area(gear: &Node) -> Option<f64> {
    let given = |quantity: &Quantity| {
        let node = gear
            .at(&[quantity.name])
            .filter(|node| **node != Node::Null);
        node.map(|_| gear.number_at(&[quantity.name]))
    };
    let m = given(&quantity::MODULE)??;
    let z = given(&quantity::TOOTH_COUNT)??;
    let or_preset =
        |quantity: &Quantity| given(quantity).unwrap_or_else(|| quantity.preset_for(Some(m)));
    let shifted = m * z / 2.0 + or_preset(&quantity::PROFILE_SHIFT)? * m;
    let r_a = match given(&quantity::TIP_DIAMETER) {
        Some(diameter) => diameter? / 2.0,
        None => shifted + or_preset(&quantity::ADDENDUM)?,
    };
    let r_f = shifted - or_preset(&quantity::DEDENDUM)?;
    let bore = gear.number_at(&["blank", quantity::BORE_RADIUS.name])?;
    Some(PI * (((r_a + r_f) / 2.0).powi(2) - bore.powi(2)))
}
