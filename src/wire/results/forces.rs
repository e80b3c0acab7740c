//! The table of force, and the motion over speed.

use meshwright_engine::analysis::forces::CurveDynamics;
use meshwright_engine::dynamics::{Branch, ForceTable, ResonanceKind};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::each;
use crate::wire::units::to_um;

/// The force between the gears over mesh position and approach: under which approach each load acts at each position, over the true period.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = ForceTable, title = "Force table")]
pub struct ForceTableDocument {
    /// The mesh position, in mesh periods, end excluded.
    pub mesh_position: Vec<f64>,
    /// The loads on the line of action, in N, rising from 0.
    pub load_n: Vec<f64>,
    /// The approach under each load, in um: one row a load, one number a position. Positive where the driven gear lags.
    pub transmission_error_um: Vec<Vec<f64>>,
    /// The stiffness dF/d(approach) under each load, in N/m: one row a load, that of the load 0 being 0. With it tables need fewer loads.
    #[serde(default)]
    #[schema(required)]
    pub mesh_stiffness_tangent_n_per_m: Vec<Vec<f64>>,
    /// The backlash along the line of action at each position, in um: no force acts while the approach is less than that of load 0 by up to
    /// this much.
    pub backlash_um: Vec<f64>,
    /// The approach at which the other flanks, as drawn, carry each load: one row a load.
    pub other_flank_transmission_error_um: Vec<Vec<f64>>,
}

impl ForceTableDocument {
    pub(super) fn of(table: &ForceTable) -> Self {
        let rows = |rows: &[Vec<f64>]| rows.iter().map(|row| each(row, to_um)).collect();
        let stiff = |compliance: f64| {
            if compliance > 0.0 {
                1.0 / compliance
            } else {
                0.0
            }
        };
        let stiffness = table.compliance().unwrap_or_default().iter();
        Self {
            mesh_stiffness_tangent_n_per_m: stiffness.map(|row| each(row, stiff)).collect(),
            mesh_position: table.mesh_positions(),
            load_n: table.loads().to_vec(),
            transmission_error_um: rows(table.rows()),
            backlash_um: each(&table.backlash(), to_um),
            other_flank_transmission_error_um: rows(table.rows_of_other_flank()),
        }
    }
}

/// The motion of the gears over speed under one torque. All lists run over the same speeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Dynamics, title = "Dynamics")]
pub struct CurveDynamicsDocument {
    /// The natural frequency of the mean mesh stiffness and the equivalent mass, in Hz.
    pub natural_frequency_hz: f64,
    /// The mass on the line of action, in kg: 1/m = R_b1^2/J_1 + R_b2^2/J_2.
    pub equivalent_mass_kg: f64,
    /// The speed of the driving gear, in 1/min.
    pub driving_speed_rpm: Vec<f64>,
    /// Run up from the lowest speed; absent if not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up: Option<BranchDocument>,
    /// Run down from the highest speed; absent if not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub down: Option<BranchDocument>,
    /// The speeds at which an order meets the natural frequency, or twice it, rising.
    pub resonances: Vec<ResonanceDocument>,
}

/// The motion over speed, run through one way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = RunUpBranch, title = "Branch of a run-up")]
pub struct BranchDocument {
    /// The dynamic transmission error, in um.
    pub dynamic_transmission_error_um: DynamicErrorDocument,
    /// The largest force between the gears over the static load.
    pub dynamic_load_factor: Vec<f64>,
    /// Whether the loaded flanks part.
    pub contact_lost: Vec<bool>,
    /// True periods after which the motion repeats; 0 where it was not found to.
    pub period_multiple: Vec<u32>,
    /// The amplitudes at the orders of mesh and holes, and at others that stand out.
    pub orders: Vec<OrderAmplitudesDocument>,
}

/// The dynamic transmission error over speed, in um.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = DynamicTransmissionError, title = "Dynamic transmission error")]
pub struct DynamicErrorDocument {
    /// The root mean square of the fluctuation, the mean removed.
    pub rms: Vec<f64>,
    /// The largest less the smallest value.
    pub peak_to_peak: Vec<f64>,
}

/// The amplitude at one order over speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = OrderAmplitudes, title = "Amplitudes of an order")]
pub struct OrderAmplitudesDocument {
    /// Its name, as in the spectrum.
    #[schema(example = "H_Z2")]
    pub label: String,
    /// Its amplitude, in um.
    pub amplitude_um: Vec<f64>,
}

/// A speed at which an order resonates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Resonance, title = "Resonance")]
pub struct ResonanceDocument {
    /// The speed of the driving gear, in 1/min.
    pub driving_speed_rpm: f64,
    /// The name of the order.
    #[schema(example = "H_Z2")]
    pub label: String,
    /// Whether it is forced or parametric.
    pub kind: ResonanceKindName,
}

/// Why an order resonates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ResonanceKind, title = "Kind of a resonance")]
pub enum ResonanceKindName {
    /// The order meets the natural frequency.
    Forced,
    /// It meets twice the natural frequency; its part of the stiffness pumps.
    Parametric,
}

impl CurveDynamicsDocument {
    pub(super) fn of(dynamics: &CurveDynamics) -> Self {
        let branch = |branch: &Branch| BranchDocument::of(branch, &dynamics.labels);
        Self {
            natural_frequency_hz: dynamics.run_up.natural_frequency,
            equivalent_mass_kg: dynamics.equivalent_mass,
            driving_speed_rpm: each(&dynamics.speeds, to_rpm),
            up: dynamics.run_up.up.as_ref().map(branch),
            down: dynamics.run_up.down.as_ref().map(branch),
            resonances: dynamics
                .resonances
                .iter()
                .map(|resonance| ResonanceDocument {
                    driving_speed_rpm: to_rpm(resonance.speed),
                    label: dynamics.labels[resonance.order].clone(),
                    kind: match resonance.kind {
                        ResonanceKind::Forced => ResonanceKindName::Forced,
                        ResonanceKind::Parametric => ResonanceKindName::Parametric,
                    },
                })
                .collect(),
        }
    }
}

fn to_rpm(revolutions_per_second: f64) -> f64 {
    60.0 * revolutions_per_second
}

impl BranchDocument {
    fn of(branch: &Branch, labels: &[String]) -> Self {
        let orders = labels.iter().zip(&branch.orders);
        Self {
            dynamic_transmission_error_um: DynamicErrorDocument {
                rms: each(&branch.rms, to_um),
                peak_to_peak: each(&branch.peak_to_peak, to_um),
            },
            dynamic_load_factor: branch.load_factor.clone(),
            contact_lost: branch.contact_lost.clone(),
            period_multiple: branch
                .repeats
                .iter()
                .map(|repeats| repeats.unwrap_or(0))
                .collect(),
            orders: orders
                .map(|(label, amplitudes)| OrderAmplitudesDocument {
                    label: label.clone(),
                    amplitude_um: each(amplitudes, to_um),
                })
                .collect(),
        }
    }
}
