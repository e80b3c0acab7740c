//! The fields that may have to change to make a gear: their values, bounds and places.

use super::GearDocument;
use super::blank::{BlankDocument, WebDocument};
use super::holes::{PatternDocument, SlotDocument};
use super::relief::{Relief, StartDocument};
use crate::wire::declare::{Declared, Number, Optional};

/// The fields that may have to change to make a gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Field {
    ProfileShift,
    /// The tip circle, by addendum or by diameter.
    Tip,
    Dedendum,
    RackTipRadius,
    ThicknessDeviation,
    /// The rounding or the chamfer.
    TipEdge,
    ReliefStart(ReliefPlace),
    /// A modification as a whole.
    Modification(ReliefPlace),
    /// The deviations as a whole.
    Deviations,
    Bore,
    /// The circle of a pattern of holes.
    HoleCircle(usize),
    /// The radius of its holes, or the width of its slots.
    HoleWidth(usize),
    SlotAngle(usize),
    WebInner,
    WebOuter,
    WebThickness,
}

/// Where a relief stands in the document of a gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ReliefPlace {
    /// In its own field.
    Short,
    /// Among the profile modifications.
    Listed(usize),
}

impl ReliefPlace {
    fn pointer_within(self) -> String {
        match self {
            Self::Short => "tip_relief".to_owned(),
            Self::Listed(i) => format!("profile_modifications/{i}"),
        }
    }
}

impl GearDocument {
    pub(super) fn value(&self, field: Field) -> f64 {
        let holes = self.blank.holes.patterns();
        let web = |value: fn(&WebDocument) -> f64| self.blank.web.as_ref().map_or(0.0, value);
        match field {
            Field::ProfileShift => self.profile_shift,
            Field::Tip => {
                let said = self.tip_diameter_mm.or(self.addendum_mm);
                said.unwrap_or(0.0)
            }
            Field::Dedendum => self.dedendum_mm,
            Field::RackTipRadius => self.rack_tip_radius_mm,
            Field::ThicknessDeviation => self.tooth_thickness_deviation_um,
            Field::TipEdge => {
                let edge = self.tip_rounding_mm.or(self.tip_chamfer_mm);
                edge.unwrap_or(0.0)
            }
            Field::ReliefStart(place) => {
                self.relief(place).map_or(0.0, |relief| relief.start.value)
            }
            Field::Bore => self.blank.bore_radius_mm,
            Field::HoleCircle(i) => holes[i].circle_radius_mm,
            Field::HoleWidth(i) => holes[i].width(),
            Field::SlotAngle(i) => holes[i].span_deg(),
            Field::WebInner => web(|web| web.inner_radius_mm),
            Field::WebOuter => web(|web| web.outer_radius_mm),
            Field::WebThickness => web(|web| web.thickness_mm),
            Field::Modification(_) | Field::Deviations => 0.0,
        }
    }

    pub(super) fn set(&mut self, field: Field, value: f64) {
        match field {
            Field::ProfileShift => self.profile_shift = value,
            Field::Tip => put_first([&mut self.tip_diameter_mm, &mut self.addendum_mm], value),
            Field::Dedendum => self.dedendum_mm = value,
            Field::RackTipRadius => self.rack_tip_radius_mm = value,
            Field::ThicknessDeviation => self.tooth_thickness_deviation_um = value,
            Field::TipEdge => {
                put_first([&mut self.tip_rounding_mm, &mut self.tip_chamfer_mm], value);
            }
            Field::Bore => self.blank.bore_radius_mm = value,
            Field::ReliefStart(place) => {
                if let Some(start) = self.start_mut(place) {
                    start.value = value;
                }
            }
            Field::HoleCircle(i) | Field::HoleWidth(i) | Field::SlotAngle(i) => {
                if let Some(pattern) = self.blank.holes.pattern_mut(i) {
                    match field {
                        Field::HoleCircle(_) => pattern.circle_radius_mm = value,
                        Field::HoleWidth(_) => pattern.set_width(value),
                        _ => {
                            if let Some(slot) = &mut pattern.slot {
                                slot.angle_deg = value;
                            }
                        }
                    }
                }
            }
            Field::WebInner | Field::WebOuter | Field::WebThickness => {
                if let Some(web) = &mut self.blank.web {
                    match field {
                        Field::WebInner => web.inner_radius_mm = value,
                        Field::WebOuter => web.outer_radius_mm = value,
                        _ => web.thickness_mm = value,
                    }
                }
            }
            Field::Modification(_) | Field::Deviations => {}
        }
    }

    /// The declaration of `field`.
    pub(super) fn declared(&self, field: Field) -> Option<Declared<Number>> {
        let optional = |field: Declared<Optional<Number>>| field.map(|optional| optional.spec);
        Some(match field {
            Field::ProfileShift => Self::profile_shift,
            Field::Tip if self.tip_diameter_mm.is_some() => optional(Self::tip_diameter_mm),
            Field::Tip => optional(Self::addendum_mm),
            Field::Dedendum => Self::dedendum_mm,
            Field::RackTipRadius => Self::rack_tip_radius_mm,
            Field::ThicknessDeviation => Self::tooth_thickness_deviation_um,
            Field::TipEdge if self.tip_rounding_mm.is_some() => optional(Self::tip_rounding_mm),
            Field::TipEdge if self.tip_chamfer_mm.is_some() => optional(Self::tip_chamfer_mm),
            Field::ReliefStart(place) => self.relief(place)?.start.field(),
            Field::Bore => BlankDocument::bore_radius_mm,
            Field::HoleCircle(_) => PatternDocument::circle_radius_mm,
            Field::HoleWidth(i) => self.blank.holes.patterns()[i].width_field().1,
            Field::SlotAngle(_) => SlotDocument::angle_deg,
            Field::WebInner => WebDocument::inner_radius_mm,
            Field::WebOuter => WebDocument::outer_radius_mm,
            Field::WebThickness => WebDocument::thickness_mm,
            Field::TipEdge | Field::Modification(_) | Field::Deviations => return None,
        })
    }

    pub(super) fn pointer_within(&self, field: Field) -> String {
        let name = self.declared(field).map_or("", |declared| declared.name);
        match field {
            Field::ReliefStart(place) => format!("{}/start/{name}", place.pointer_within()),
            Field::Modification(place) => place.pointer_within(),
            Field::Deviations => "tooth_deviations".to_owned(),
            Field::Bore => format!("blank/{name}"),
            Field::HoleCircle(i) => format!("{}/{name}", self.blank.holes.pointer_within(i)),
            Field::HoleWidth(i) => {
                let (folder, _) = self.blank.holes.patterns()[i].width_field();
                format!("{}/{folder}{name}", self.blank.holes.pointer_within(i))
            }
            Field::SlotAngle(i) => format!("{}/slot/{name}", self.blank.holes.pointer_within(i)),
            Field::WebInner | Field::WebOuter | Field::WebThickness => format!("blank/web/{name}"),
            _ => name.to_owned(),
        }
    }

    /// Whether `value` is within the bounds of `field`.
    pub(super) fn accepts(&self, field: Field, value: f64) -> bool {
        self.declared(field).is_some_and(|declared| {
            let (least, most) = declared.spec.bounds;
            (least..=most).contains(&value)
        })
    }

    /// The places of all reliefs, in the order in which the engine is told of them.
    pub(super) fn relief_places(&self) -> impl Iterator<Item = ReliefPlace> {
        let listed = (0..self.profile_modifications.len()).map(ReliefPlace::Listed);
        [ReliefPlace::Short].into_iter().chain(listed)
    }

    /// The place of a modification that the engine knows by its number.
    pub(super) fn place_of(&self, modification: usize) -> ReliefPlace {
        match (&self.tip_relief, modification) {
            (Some(_), 0) => ReliefPlace::Short,
            (Some(_), i) => ReliefPlace::Listed(i - 1),
            (None, i) => ReliefPlace::Listed(i),
        }
    }

    /// The relief at `place`, if there is one.
    pub(super) fn relief(&self, place: ReliefPlace) -> Option<Relief> {
        match place {
            ReliefPlace::Short => Some(self.tip_relief.as_ref()?.relief()),
            ReliefPlace::Listed(i) => self.profile_modifications.get(i)?.relief(),
        }
    }

    fn start_mut(&mut self, place: ReliefPlace) -> Option<&mut StartDocument> {
        match place {
            ReliefPlace::Short => Some(&mut self.tip_relief.as_mut()?.start),
            ReliefPlace::Listed(i) => self.profile_modifications.get_mut(i)?.start_mut(),
        }
    }
}

/// Gives `value` to the first of two fields of which one stands in the place of the other.
fn put_first(fields: [&mut Option<f64>; 2], value: f64) {
    if let Some(given) = fields.into_iter().flatten().next() {
        *given = value;
    }
}
