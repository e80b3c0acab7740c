//! The table of force, and the motion over speed.

use meshwright_engine::analysis::at_speed::{CurveDynamics, NamedResonance};
use meshwright_engine::dynamics::{Branch, Excitation, FlankRows, ForceTable};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{all, each};
use crate::declare::document;
use crate::units::to_um;

document! {
    /// The force between the gears over mesh position and approach: under which approach each load acts at each position, over the true period.
    pub struct ForceTableDocument as ForceTable, "Force table" answer of (table: &ForceTable) with {
        let in_um = |row: &Vec<f64>| each(row, to_um);
        let stiffness = |row: &Vec<f64>| {
            each(row, |compliance| {
                if compliance > 0.0 {
                    1.0 / compliance
                } else {
                    0.0
                }
            })
        };
        let stiffnesses =
            |flank: &FlankRows| all(flank.compliance.as_deref().unwrap_or_default(), stiffness);
        let (loaded, other) = (table.loaded(), table.other());
    } {
        /// The mesh position, in mesh periods, end excluded.
        mesh_position: Vec<f64> = table.mesh_positions(),
        /// The loads on the line of action, in N, rising from 0.
        load_n: Vec<f64> = table.loads().to_vec(),
        /// The approach under each load, in um: one row a load, one number a position. Positive where the driven gear lags.
        transmission_error_um: Vec<Vec<f64>> = all(&loaded.delta, in_um),
        /// The stiffness dF/d(approach) under each load, in N/m: one row a load, that of the load 0 being 0. With it tables need fewer loads.
        #[serde(default)]
        #[schema(required)]
        mesh_stiffness_tangent_n_per_m: Vec<Vec<f64>> = stiffnesses(loaded),
        /// The backlash along the line of action at each position, in um, deviations and eccentricity included: no force acts while the approach is less
        /// than that of load 0 by up to this much.
        backlash_um: Vec<f64> = each(&table.backlash(), to_um),
        /// The approach at which the other flanks carry each load: one row a load. Pitch deviations and eccentricity move them as they say; profile and
        /// lead slopes of single teeth are those of the loaded flanks alone.
        other_flank_transmission_error_um: Vec<Vec<f64>> = all(&other.delta, in_um),
        /// The stiffness of the other flanks under each load, in N/m, in the same order.
        #[serde(default)]
        #[schema(required)]
        other_flank_mesh_stiffness_tangent_n_per_m: Vec<Vec<f64>> = stiffnesses(other),
    }
}

document! {
    /// The motion of the gears over speed under one torque. All lists run over the same speeds.
    pub struct CurveDynamicsDocument as Dynamics, "Dynamics"
    answer of (dynamics: &CurveDynamics) with {
        let run_up = &dynamics.run_up;
        let branch = |branch: &Branch| BranchDocument::of(branch, dynamics);
    } {
        /// The first of `natural_frequencies_hz`.
        natural_frequency_hz: f64 = run_up.natural_frequencies[0],
        /// The natural frequencies of the gears on their mean mesh stiffness, in Hz, rising.
        #[serde(default)]
        #[schema(required)]
        natural_frequencies_hz: Vec<f64> = run_up.natural_frequencies.clone(),
        /// The mass on the line of action, in kg: 1/m = R_b1^2/J_1 + R_b2^2/J_2.
        equivalent_mass_kg: f64 = dynamics.equivalent_mass,
        /// The speed of the driving gear, in 1/min.
        driving_speed_rpm: Vec<f64> = each(&dynamics.speeds, to_rpm),
        /// Run up from the lowest speed; absent if not asked for.
        up?: BranchDocument = run_up.up.as_ref().map(branch),
        /// Run down from the highest speed; absent if not asked for.
        down?: BranchDocument = run_up.down.as_ref().map(branch),
        /// The resonances within the speeds, the largest amplitude first: each order that meets a natural frequency and carries more than 2 % of the motion
        /// there, once. The candidates with the largest expected amplitudes are searched: at most 160, at
        /// most 40 where the true period has 50 mesh periods, and at least 8.
        resonances: Vec<ResonanceDocument> = all(&dynamics.resonances, ResonanceDocument::of),
    }
}

document! {
    /// The motion over speed, run through one way.
    pub struct BranchDocument as RunUpBranch, "Branch of a run-up"
    answer of (branch: &Branch, dynamics: &CurveDynamics) {
        /// The dynamic transmission error, in um.
        dynamic_transmission_error_um: DynamicErrorDocument = DynamicErrorDocument::of(branch),
        /// The largest force between the gears over the static load.
        dynamic_load_factor: Vec<f64> = branch.load_factor.clone(),
        /// True where the loaded flanks separate.
        contact_lost: Vec<bool> = branch.contact_lost.clone(),
        /// True periods after which the motion repeats; 0 where it was not found to.
        period_multiple: Vec<u32> = all(&branch.repeats, |repeats| repeats.unwrap_or(0)),
        /// The amplitudes at the orders of the mesh to the tenth, of holes, of the first revolutions of gears that deviate, at the sidebands of both, at those
        /// that stand out of the static curve, and at every other one that carries more than 2 % of the motion at any speed: its amplitude over the root
        /// mean square times the square root of 2. There are at most 12 for each mesh period of the true period; those that carry least are left out.
        orders: Vec<OrderAmplitudesDocument> = dynamics
            .labels
            .iter()
            .zip(&dynamics.orders)
            .zip(&branch.orders)
            .map(|((label, order), found)| OrderAmplitudesDocument::of(label, *order, found))
            .collect(),
    }
}

document! {
    /// The dynamic transmission error over speed, in um.
    pub struct DynamicErrorDocument as DynamicTransmissionError, "Dynamic transmission error"
    answer of (branch: &Branch) {
        /// The root mean square of the fluctuation, the mean removed.
        rms: Vec<f64> = each(&branch.rms, to_um),
        /// The largest less the smallest value.
        peak_to_peak: Vec<f64> = each(&branch.peak_to_peak, to_um),
    }
}

document! {
    /// The amplitude at one order over speed.
    pub struct OrderAmplitudesDocument as OrderAmplitudes, "Amplitudes of an order"
    answer of (label: &str, order: f64, amplitudes: &[f64]) {
        /// Its name, as in the spectrum. `H_Z2/2` is half of the mesh order.
        #[schema(example = "H_Z2")]
        label: String = label.to_owned(),
        /// The order, for each revolution of the driven gear.
        #[serde(default)]
        #[schema(required)]
        order: f64 = order,
        /// Its amplitude, in um.
        amplitude_um: Vec<f64> = each(amplitudes, to_um),
    }
}

document! {
    /// A resonance of an order of the motion.
    pub struct ResonanceDocument as Resonance, "Resonance"
    answer of (found: &NamedResonance) with {
        let resonance = &found.resonance;
    } {
        /// The name of the order of the motion. `H_Z2/2` is a motion at half of the mesh order.
        #[schema(example = "H_Z2")]
        label: String = found.label.clone(),
        /// The order, for each revolution of the driven gear.
        #[serde(default)]
        #[schema(required)]
        order: f64 = found.order,
        /// Whether its own line in the static curve makes it, or the varying stiffness.
        #[serde(default, alias = "kind")]
        #[schema(required)]
        excited: ExcitationName = resonance.excited.into(),
        /// The speed of the driving gear at which its amplitude is largest, in 1/min.
        driving_speed_rpm: f64 = to_rpm(resonance.speed),
        /// Its frequency there, in Hz.
        #[serde(default)]
        #[schema(required)]
        frequency_hz: f64 = resonance.frequency,
        /// Its amplitude there, in um, on the branch where it is larger.
        #[serde(default)]
        #[schema(required)]
        amplitude_um: f64 = to_um(resonance.amplitude),
    }
}

/// The cause of a resonance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = Excitation, title = "Cause of a resonance")]
pub enum ExcitationName {
    /// Its own line in the static curve: more of it vanishes without this line than with the mean stiffness at every position.
    #[default]
    Forced,
    /// The varying stiffness: more of it vanishes with the mean stiffness at every position than without its own line in the static curve.
    Parametric,
}

impl From<Excitation> for ExcitationName {
    fn from(excited: Excitation) -> Self {
        match excited {
            Excitation::Forced => Self::Forced,
            Excitation::Parametric => Self::Parametric,
        }
    }
}

fn to_rpm(revolutions_per_second: f64) -> f64 {
    60.0 * revolutions_per_second
}
