//! The numbers of a design by name: what populations tell and searches minimize.

use super::summary::{CurveSummary, Summary};
use crate::wire::results::{GearPeakStress, StatisticsValues};
use crate::wire::warning::GearName;

/// A number of a design.
#[derive(Debug, Clone, Copy)]
pub(in crate::wire) struct Quantity {
    /// Its name on the wire.
    pub(in crate::wire) name: &'static str,
    /// Where it stands.
    pub(in crate::wire) of: Of,
    /// What a submission has to have for it.
    pub(in crate::wire) needs: Needs,
    /// What it is as good as for a design that has none: the ligament beside holes that there are not.
    pub(in crate::wire) absent: Option<f64>,
}

impl PartialEq for Quantity {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Quantity {
    const fn needs(self, field: &'static str) -> Self {
        let needs = Needs::Field(field);
        Self { needs, ..self }
    }

    const fn needs_faces(self) -> Self {
        let needs = Needs::Faces;
        Self { needs, ..self }
    }

    const fn or(self, absent: f64) -> Self {
        let absent = Some(absent);
        Self { absent, ..self }
    }
}

/// What a submission has to have for a number to be told.
#[derive(Debug, Clone, Copy)]
pub(in crate::wire) enum Needs {
    /// It is always told.
    Nothing,
    /// The field by which it is asked for.
    Field(&'static str),
    /// A method that sees the faces.
    Faces,
}

/// Where a number of a design stands.
#[derive(Debug, Clone, Copy)]
pub(in crate::wire) enum Of {
    /// It is the pair's, whatever the torque.
    Pair(fn(&Summary) -> Option<f64>),
    /// It is that of a curve, the study's gear being given.
    Curve(fn(&CurveSummary, GearName) -> Option<f64>),
}

const fn pair(name: &'static str, of: fn(&Summary) -> Option<f64>) -> Quantity {
    quantity(name, Of::Pair(of))
}

const fn curve(name: &'static str, of: fn(&CurveSummary, GearName) -> Option<f64>) -> Quantity {
    quantity(name, Of::Curve(of))
}

const fn quantity(name: &'static str, of: Of) -> Quantity {
    Quantity {
        name,
        of,
        needs: Needs::Nothing,
        absent: None,
    }
}

/// Every number that has a name.
pub(in crate::wire) const QUANTITIES: &[Quantity] = &[
    curve("transmission_error_um.mean", |curve, _| {
        Some(ste(curve)?.mean)
    }),
    curve("transmission_error_um.rms", |curve, _| {
        Some(ste(curve)?.rms)
    }),
    curve("transmission_error_um.peak_to_peak", |curve, _| {
        Some(ste(curve)?.peak_to_peak)
    }),
    curve("mesh_stiffness_tangent_n_per_m.mean", |curve, _| {
        Some(stiffness(curve)?.mean)
    }),
    curve("mesh_stiffness_tangent_n_per_m.rms", |curve, _| {
        Some(stiffness(curve)?.rms)
    }),
    curve("mesh_stiffness_tangent_n_per_m.peak_to_peak", |curve, _| {
        Some(stiffness(curve)?.peak_to_peak)
    }),
    curve("hole_order_um", CurveSummary::hole_order).or(0.0),
    curve("mesh_order_um", |curve, _| curve.mesh_order()),
    curve("peak_contact_pressure_mpa", |curve, _| {
        curve.peak_contact_pressure_mpa
    })
    .or(f64::INFINITY),
    curve("stress.driving.root_mpa", |curve, _| {
        Some(stress(curve, GearName::Driving)?.root_mpa)
    })
    .needs("stress"),
    curve("stress.driving.hole_mpa", |curve, _| {
        stress(curve, GearName::Driving)?.hole_mpa
    })
    .needs("stress")
    .or(0.0),
    curve("stress.driven.root_mpa", |curve, _| {
        Some(stress(curve, GearName::Driven)?.root_mpa)
    })
    .needs("stress"),
    curve("stress.driven.hole_mpa", |curve, _| {
        stress(curve, GearName::Driven)?.hole_mpa
    })
    .needs("stress")
    .or(0.0),
    pair("mass_kg.driving", |design| design.driving.mass_kg),
    pair("mass_kg.driven", |design| design.driven.mass_kg),
    pair("mass_removed_percent.driving", |design| {
        design.driving.mass_removed_percent
    }),
    pair("mass_removed_percent.driven", |design| {
        design.driven.mass_removed_percent
    }),
    pair("least_ligament_mm.driving", |design| {
        design.driving.least_ligament_mm
    })
    .or(f64::INFINITY),
    pair("least_ligament_mm.driven", |design| {
        design.driven.least_ligament_mm
    })
    .or(f64::INFINITY),
    pair("contact_ratio", |design| design.contact_ratio),
    pair("backlash_mm", |design| design.backlash_mm),
    curve("dynamic_transmission_error_um.peak_to_peak", |curve, _| {
        curve.dynamic_peak_to_peak_um
    })
    .needs("dynamics"),
    curve("face_load_factor", |curve, _| curve.face_load_factor).needs_faces(),
];

fn ste(curve: &CurveSummary) -> Option<&StatisticsValues> {
    Some(&curve.statistics.as_ref()?.transmission_error_um)
}

fn stiffness(curve: &CurveSummary) -> Option<&StatisticsValues> {
    Some(&curve.statistics.as_ref()?.mesh_stiffness_tangent_n_per_m)
}

fn stress(curve: &CurveSummary, gear: GearName) -> Option<&GearPeakStress> {
    let stress = curve.statistics.as_ref()?.stress.as_ref()?;
    Some(match gear {
        GearName::Driving => &stress.driving,
        GearName::Driven => &stress.driven,
    })
}
