//! The numbers of a design by name: what populations tell and searches minimize.

use meshwright_engine::analysis::Method;

use super::summary::{CurveSummary, Summary};
use crate::declare::Choice as _;
use crate::results::{GearPeakStress, StatisticsValues};
use crate::submission::Submission;
use crate::warning::GearName;

/// A number of a design.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quantity {
    /// Its name on the wire.
    pub(crate) name: &'static str,
    /// Where it stands.
    pub(crate) of: Of,
    /// What a submission has to have for it.
    needs: &'static [Needs],
    /// What it is as good as for a design that has none, such as the ligament beside holes that there are not. None where it is only not told.
    pub(crate) absent: fn(&Summary) -> Option<f64>,
}

impl PartialEq for Quantity {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Quantity {
    const fn needs(self, needs: &'static [Needs]) -> Self {
        Self { needs, ..self }
    }

    const fn or(self, absent: fn(&Summary) -> Option<f64>) -> Self {
        Self { absent, ..self }
    }

    /// Whether it is a stress.
    pub(crate) fn is_stress(&self) -> bool {
        self.needs
            .iter()
            .any(|needs| matches!(needs, Needs::Stress))
    }

    /// What of `submission` stands against telling it, and what would tell it; none where it is told.
    pub(crate) fn not_told(&self, submission: &Submission) -> Option<String> {
        let mut needs = self.needs.iter();
        needs.find_map(|needs| needs.unmet(submission))
    }
}

/// What a submission has to have for a number to be told.
#[derive(Debug, Clone, Copy)]
enum Needs {
    /// Stresses that are asked for.
    Stress,
    /// A run-up that is asked for.
    Dynamics,
    /// One of some methods.
    Method(fn(Method) -> bool),
    /// A span of whole true periods, of which there is a spectrum.
    WholePeriods,
    /// Teeth that deviate.
    Deviations,
    /// No torque of 0.
    Load,
}

impl Needs {
    fn unmet(self, submission: &Submission) -> Option<String> {
        let case = submission.case();
        match self {
            Self::Stress => {
                (!case.stress).then(|| "the submission has to ask for it by /base/stress".to_owned())
            }
            Self::Dynamics => submission
                .forces()
                .is_none_or(|forces| forces.dynamics.is_none())
                .then(|| "the submission has to ask for it by /base/dynamics".to_owned()),
            Self::Method(tells) => (!tells(case.method())).then(|| {
                let told = Method::OPTIONS.iter().filter(|(_, method, _)| tells(*method));
                let told: Vec<&str> = told.map(|(word, ..)| *word).collect();
                format!(
                    "the method {} does not tell it; {} would",
                    case.method().word(),
                    told.join(", ")
                )
            }),
            Self::WholePeriods => (!case.covers_whole_periods()).then(|| {
                format!(
                    "/base/resolution/span_mesh_periods is {}, a part of the true period of {} mesh periods; leave it out, or give whole periods",
                    case.span(),
                    case.pair.period()
                )
            }),
            Self::Deviations => case.pair.is_as_drawn().then(|| {
                "teeth do not deviate, so that it is hole_order_um; ask for that, or for a percent of a population with accuracy".to_owned()
            }),
            Self::Load => case.output_torques.contains(&0.0).then(|| {
                "there is none at the torque 0; leave it out of /base/output_torques_n_m".to_owned()
            }),
        }
    }
}

/// Where a number of a design stands.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Of {
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
        needs: &[],
        absent: |_| None,
    }
}

/// What stresses need.
const STRESS: &[Needs] = &[
    Needs::Method(Method::tells_stress),
    Needs::Stress,
    Needs::Load,
];

/// Every number that has a name.
pub(crate) const QUANTITIES: &[Quantity] = &[
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
    curve("hole_order_um", CurveSummary::hole_order)
        .needs(&[Needs::Method(Method::sees_holes), Needs::WholePeriods])
        .or(|design| {
            let none = design.driving.has_no_holes() && design.driven.has_no_holes();
            none.then_some(0.0)
        }),
    curve("hole_order_of_holes_um", CurveSummary::hole_order_of_holes).needs(&[
        Needs::Method(Method::sees_holes),
        Needs::WholePeriods,
        Needs::Deviations,
    ]),
    curve("mesh_order_um", |curve, _| curve.mesh_order()).needs(&[Needs::WholePeriods]),
    curve("peak_contact_pressure_mpa", |curve, _| {
        curve.peak_contact_pressure_mpa
    })
    .or(|_| Some(f64::INFINITY)),
    curve("stress.driving.root_mpa", |curve, _| {
        Some(stress(curve, GearName::Driving)?.root_mpa)
    })
    .needs(STRESS),
    curve("stress.driving.hole_mpa", |curve, _| {
        stress(curve, GearName::Driving)?.hole_mpa
    })
    .needs(STRESS)
    .or(|design| design.driving.has_no_holes().then_some(0.0)),
    curve("stress.driven.root_mpa", |curve, _| {
        Some(stress(curve, GearName::Driven)?.root_mpa)
    })
    .needs(STRESS),
    curve("stress.driven.hole_mpa", |curve, _| {
        stress(curve, GearName::Driven)?.hole_mpa
    })
    .needs(STRESS)
    .or(|design| design.driven.has_no_holes().then_some(0.0)),
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
    .or(|_| Some(f64::INFINITY)),
    pair("least_ligament_mm.driven", |design| {
        design.driven.least_ligament_mm
    })
    .or(|_| Some(f64::INFINITY)),
    pair("contact_ratio", |design| design.contact_ratio),
    pair("backlash_mm", |design| design.backlash_mm),
    curve("dynamic_transmission_error_um.peak_to_peak", |curve, _| {
        curve.dynamic_peak_to_peak_um
    })
    .needs(&[Needs::Dynamics]),
    curve("face_load_factor", |curve, _| curve.face_load_factor)
        .needs(&[Needs::Method(Method::sees_faces), Needs::Load]),
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
