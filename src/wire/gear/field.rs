//! The fields that may have to change to make a gear: their values, bounds and places.

use super::GearDocument;
use super::blank::WebDocument;
use super::relief::ReliefDocument;
use crate::wire::quantity::{self, Quantity};

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
            Field::Tip => self.tip_circle.value(),
            Field::Dedendum => self.dedendum_mm,
            Field::RackTipRadius => self.rack_tip_radius_mm,
            Field::ThicknessDeviation => self.tooth_thickness_deviation_um,
            Field::TipEdge => self.tip_edge.value(),
            Field::ReliefStart(place) => {
                self.relief(place).map_or(0.0, |relief| relief.start.value)
            }
            Field::Bore => self.blank.bore_radius_mm,
            Field::HoleCircle(i) => holes[i].circle_radius_mm,
            Field::HoleWidth(i) => holes[i].shape.width_value(),
            Field::SlotAngle(i) => holes[i].shape.span_deg(),
            Field::WebInner => web(|web| web.inner_radius_mm),
            Field::WebOuter => web(|web| web.outer_radius_mm),
            Field::WebThickness => web(|web| web.thickness_mm),
            Field::Modification(_) | Field::Deviations => 0.0,
        }
    }

    pub(super) fn set(&mut self, field: Field, value: f64) {
        match field {
            Field::ProfileShift => self.profile_shift = value,
            Field::Tip => self.tip_circle = self.tip_circle.with(value),
            Field::Dedendum => self.dedendum_mm = value,
            Field::RackTipRadius => self.rack_tip_radius_mm = value,
            Field::ThicknessDeviation => self.tooth_thickness_deviation_um = value,
            Field::TipEdge => self.tip_edge = self.tip_edge.with(value),
            Field::Bore => self.blank.bore_radius_mm = value,
            Field::ReliefStart(place) => {
                if let Some(relief) = self.relief_mut(place) {
                    relief.start.value = value;
                }
            }
            Field::HoleCircle(i) | Field::HoleWidth(i) | Field::SlotAngle(i) => {
                if let Some(pattern) = self.blank.holes.pattern_mut(i) {
                    match field {
                        Field::HoleCircle(_) => pattern.circle_radius_mm = value,
                        Field::HoleWidth(_) => pattern.shape.set_width(value),
                        _ => pattern.shape.set_span(value),
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

    pub(super) fn quantity(&self, field: Field) -> Option<&'static Quantity> {
        Some(match field {
            Field::ProfileShift => &quantity::PROFILE_SHIFT,
            Field::Tip => self.tip_circle.quantity(),
            Field::Dedendum => &quantity::DEDENDUM,
            Field::RackTipRadius => &quantity::RACK_TIP_RADIUS,
            Field::ThicknessDeviation => &quantity::THICKNESS_DEVIATION,
            Field::TipEdge => self.tip_edge.quantity()?,
            Field::ReliefStart(place) => self.relief(place)?.start.quantity(),
            Field::Bore => &quantity::BORE_RADIUS,
            Field::HoleCircle(_) => &quantity::HOLE_CIRCLE,
            Field::HoleWidth(i) => self.blank.holes.patterns()[i].shape.width().0,
            Field::SlotAngle(_) => &quantity::SLOT_ANGLE,
            Field::WebInner => &quantity::WEB_INNER,
            Field::WebOuter => &quantity::WEB_OUTER,
            Field::WebThickness => &quantity::WEB_THICKNESS,
            Field::Modification(_) | Field::Deviations => return None,
        })
    }

    pub(super) fn pointer_within(&self, field: Field) -> String {
        let name = self.quantity(field).map_or("", |quantity| quantity.name);
        match field {
            Field::ReliefStart(place) => format!("{}/start/{name}", place.pointer_within()),
            Field::Modification(place) => place.pointer_within(),
            Field::Deviations => "tooth_deviations".to_owned(),
            Field::Bore => format!("blank/{name}"),
            Field::HoleCircle(i) => format!("{}/{name}", self.blank.holes.pointer_within(i)),
            Field::HoleWidth(i) => {
                let (_, folder) = self.blank.holes.patterns()[i].shape.width();
                format!("{}/{folder}{name}", self.blank.holes.pointer_within(i))
            }
            Field::SlotAngle(i) => format!("{}/slot/{name}", self.blank.holes.pointer_within(i)),
            Field::WebInner | Field::WebOuter | Field::WebThickness => format!("blank/web/{name}"),
            _ => name.to_owned(),
        }
    }

    /// Whether `value` is within the bounds of `field`.
    pub(super) fn accepts(&self, field: Field, value: f64) -> bool {
        self.quantity(field)
            .is_some_and(|quantity| (quantity.bounds.0..=quantity.bounds.1).contains(&value))
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
    pub(super) fn relief(&self, place: ReliefPlace) -> Option<&ReliefDocument> {
        match place {
            ReliefPlace::Short => self.tip_relief.as_ref(),
            ReliefPlace::Listed(i) => self.profile_modifications.get(i)?.relief(),
        }
    }

    fn relief_mut(&mut self, place: ReliefPlace) -> Option<&mut ReliefDocument> {
        match place {
            ReliefPlace::Short => self.tip_relief.as_mut(),
            ReliefPlace::Listed(i) => self.profile_modifications.get_mut(i)?.relief_mut(),
        }
    }
}
