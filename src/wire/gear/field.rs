//! The fields that may have to change to make a gear: their values, bounds and places.

use super::GearDocument;
use crate::wire::quantity::{self, Quantity};

/// The fields that may have to change to make a gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Field {
    ProfileShift,
    Addendum,
    Dedendum,
    RackTipRadius,
    ReliefStart,
    Bore,
    HoleCircle,
    HoleRadius,
}

impl GearDocument {
    pub(super) fn value(&self, field: Field) -> f64 {
        let holes = self.blank.holes.as_ref();
        match field {
            Field::ProfileShift => self.profile_shift,
            Field::Addendum => self.addendum_mm,
            Field::Dedendum => self.dedendum_mm,
            Field::RackTipRadius => self.rack_tip_radius_mm,
            Field::ReliefStart => self
                .tip_relief
                .as_ref()
                .map_or(0.0, |relief| relief.start.value),
            Field::Bore => self.blank.bore_radius_mm,
            Field::HoleCircle => holes.map_or(0.0, |holes| holes.circle_radius_mm),
            Field::HoleRadius => holes.map_or(0.0, |holes| holes.radius_mm),
        }
    }

    pub(super) fn set(&mut self, field: Field, value: f64) {
        let holes = self.blank.holes.as_mut();
        match (field, holes, self.tip_relief.as_mut()) {
            (Field::ProfileShift, ..) => self.profile_shift = value,
            (Field::Addendum, ..) => self.addendum_mm = value,
            (Field::Dedendum, ..) => self.dedendum_mm = value,
            (Field::RackTipRadius, ..) => self.rack_tip_radius_mm = value,
            (Field::Bore, ..) => self.blank.bore_radius_mm = value,
            (Field::ReliefStart, _, Some(relief)) => relief.start.value = value,
            (Field::HoleCircle, Some(holes), _) => holes.circle_radius_mm = value,
            (Field::HoleRadius, Some(holes), _) => holes.radius_mm = value,
            (Field::ReliefStart, _, None) | (Field::HoleCircle | Field::HoleRadius, None, _) => {}
        }
    }

    pub(super) fn quantity(&self, field: Field) -> Option<&'static Quantity> {
        Some(match field {
            Field::ProfileShift => &quantity::PROFILE_SHIFT,
            Field::Addendum => &quantity::ADDENDUM,
            Field::Dedendum => &quantity::DEDENDUM,
            Field::RackTipRadius => &quantity::RACK_TIP_RADIUS,
            Field::ReliefStart => self.tip_relief.as_ref()?.start.way.quantity(),
            Field::Bore => &quantity::BORE_RADIUS,
            Field::HoleCircle => &quantity::HOLE_CIRCLE,
            Field::HoleRadius => &quantity::HOLE_RADIUS,
        })
    }

    pub(super) fn pointer_within(&self, field: Field) -> String {
        let name = self.quantity(field).map_or("", |quantity| quantity.name);
        let folder = match field {
            Field::ProfileShift | Field::Addendum | Field::Dedendum | Field::RackTipRadius => "",
            Field::ReliefStart => "tip_relief/start/",
            Field::Bore => "blank/",
            Field::HoleCircle | Field::HoleRadius => "blank/holes/",
        };
        format!("{folder}{name}")
    }

    /// Whether `value` is within the bounds of `field`.
    pub(super) fn accepts(&self, field: Field, value: f64) -> bool {
        self.quantity(field)
            .is_some_and(|quantity| (quantity.bounds.0..=quantity.bounds.1).contains(&value))
    }
}
