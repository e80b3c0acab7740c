//! The curves at one output torque, and their statistics.

use std::collections::BTreeMap;
use std::ops::Deref;

use meshwright_engine::analysis::at_speed::CurveDynamics;
use meshwright_engine::analysis::curve::LeadCorrection;
use meshwright_engine::analysis::mesh_wave::MeshWave;
use meshwright_engine::analysis::running::CurveRunning;
use meshwright_engine::analysis::{Case, Curve, FaceLoad, Statistics};

use super::between::BetweenDocument;
use super::decomposition::DecompositionDocument;
use super::forces::CurveDynamicsDocument;
use super::largest_where::PressureStatistics;
use super::load_share::LoadShareDocument;
use super::spectrum::SpectrumDocument;
use super::stress::{PeakStressDocument, StressDocument};
use super::{all, each};
use crate::declare::document;
use crate::units::{named_or_null, one_or_null, or_null, significant, to_mm, to_mpa, to_um, told};

/// The most multiples of the mesh order that have names, in windows and in tables.
pub const MOST_MESH_ORDERS: u32 = 10;

document! {
    /// The curves at one output torque. All lists, those of `between`, of the spectrum and of the dynamics aside, run over the same positions.
    pub struct CurveDocument as Curve, "Curve"
    answer of (case: &Case, curve: &Curve, dynamics: Option<&CurveDynamics>) with {
        let turned = |tooth_count: u32| {
            each(&curve.mesh_position, |eta| {
                eta * 360.0 / f64::from(tooth_count)
            })
        };
    } {
        /// The output torque on the driven gear, in N m.
        output_torque_n_m: f64 = curve.output_torque,
        /// The transmitted load on the line of action, in N: the torque over the driven base radius.
        load_n: f64 = curve.load,
        /// The mesh position, in mesh periods, end excluded; at 0 the reference pair touches at the pitch point.
        mesh_position: Vec<f64> = curve.mesh_position.clone(),
        /// The rigid rotation of the driving gear, in degrees.
        driving_angle_deg: Vec<f64> = turned(case.pair.driving().tooth_count()),
        /// The rigid rotation of the driven gear, in degrees.
        driven_angle_deg: Vec<f64> = turned(case.pair.driven().tooth_count()),
        /// The static transmission error, in um, positive when load makes the driven gear lag.
        transmission_error_um: Vec<f64> = each(&curve.transmission_error, to_um),
        /// The tangent stiffness dF/d delta, in N/m.
        mesh_stiffness_tangent_n_per_m: Vec<f64> = curve.mesh_stiffness_tangent.clone(),
        /// The secant stiffness F/delta, in N/m.
        mesh_stiffness_secant_n_per_m: Vec<f64> = curve.mesh_stiffness_secant.clone(),
        /// The torque that the driver has to give, in N m; the load times the driving base radius where unmodified flanks touch on the line of action
        /// alone.
        #[serde(default)]
        #[schema(required)]
        driving_torque_n_m: Vec<f64> = curve.driving_torque.clone(),
        /// The number of tooth pairs that carry load.
        pairs_in_contact: Vec<u32> = curve.pairs_in_contact.clone(),
        /// The largest contact pressure, in MPa, in plane strain as all pressures are; null where a sharp corner carries, at which it has no limit.
        #[serde(serialize_with = "or_null")]
        peak_contact_pressure_mpa: Vec<Option<f64>> =
            all(&curve.peak_contact_pressure, |pressure| {
                pressure.map(to_mpa)
            }),
        /// The share of the span, from 0 to 1, in which a sharp corner carries, at which pressure has no limit; null in results of versions before 0.6.
        #[serde(default, serialize_with = "one_or_null")]
        #[schema(required)]
        pressure_unbounded_share: Option<f64> =
            Some(significant(curve.pressures.unbounded_share, 6)),
        /// Hertz's pressure at the working pitch point, in MPa: of the whole load on one line across the common face, by the curvature normal to it, without factors of
        /// contact ratio and helix. Null where the pitch point lies outside the path of contact, and in results of versions before 0.6.
        #[serde(default, serialize_with = "one_or_null")]
        #[schema(required)]
        pitch_point_pressure_mpa: Option<f64> = curve.pressures.at_pitch_point.map(to_mpa),
        /// The largest contact pressure over the span, in MPa, at least half the width of the contact away from kinks of the flanks, and on pairs of which no
        /// sharp corner carries. Null where there is none, and in results of versions before 0.6.
        #[serde(default, serialize_with = "one_or_null")]
        #[schema(required)]
        smooth_contact_pressure_mpa: Option<f64> = curve.pressures.smooth.map(to_mpa),
        /// The share of the load on each pair that ever carries any, by rising offset.
        load_shares: Vec<LoadShareDocument> = all(&curve.load_shares, LoadShareDocument::of),
        /// The largest stresses; absent unless the submission asks for them, for other methods than `flexible` and `three_dimensional`, and
        /// at the torque 0.
        stress?: StressDocument = curve.stresses.as_ref().map(StressDocument::of),
        /// What speed, heat and press fits do; absent unless the submission says how the pair runs.
        running?: CurveRunningDocument = curve.running.as_ref().map(CurveRunningDocument::of),
        /// The load along the common face; absent for plane methods and at the torque 0.
        face?: FaceDocument = curve.face.as_ref().map(FaceDocument::of),
        /// Statistics over the span.
        statistics: StatisticsDocument = StatisticsDocument::of(case, curve),
        /// The numbers of `GET /v1/quantities` by their names, those of the pair among them; null where the results do not come to one. Where both gears make
        /// hole orders of their own, those of the driven gear. Absent in results of versions before 0.6.
        #[serde(serialize_with = "named_or_null")]
        quantities?: BTreeMap<String, Option<f64>> = None,
        /// The curve at points between its positions. `?between=true` of the results puts them into the lists. Absent in results of versions before 0.6.
        between?: BetweenDocument = Some(BetweenDocument::of(case, curve)),
        /// The order spectrum; absent for a partial span.
        spectrum?: SpectrumDocument = curve
            .spectrum
            .as_ref()
            .map(|spectrum| SpectrumDocument::of(case, spectrum)),
        /// The amplitudes of the transmission error at the mesh order and its multiples, in um, the first ten or as many as the positions tell, estimated from
        /// windows; absent without windows.
        mesh_orders_um?: Vec<f64> = curve.mesh_wave.as_ref().map(|wave| {
            let told = (case.resolution.positions_per_mesh_period / 2).min(MOST_MESH_ORDERS);
            let amplitudes = wave.amplitudes().into_iter().take(told as usize);
            amplitudes.map(to_um).collect()
        }),
        /// The parts that the decomposition adds; absent for other methods.
        decomposition?: DecompositionDocument =
            curve.decomposition.as_ref().map(DecompositionDocument::of),
        /// The motion over speed; absent unless the submission asks for it.
        dynamics?: CurveDynamicsDocument = dynamics.map(CurveDynamicsDocument::of),
    }
}

document! {
    /// What speed, heat and press fits do to a curve.
    pub struct CurveRunningDocument as CurveRunning, "What running does"
    answer of (running: &CurveRunning) {
        /// How far the tips have moved outward in the mean, in um.
        radial_growth_um: RadialGrowth = RadialGrowth::of(running.radial_growth),
        /// The amplitude, at the order of the holes, of the transmission error at speed less that of the same pair at rest, as warm and on the same shafts, under
        /// the same torque, in um; of several such orders the largest. Null without holes, and for a partial span.
        #[serde(serialize_with = "one_or_null")]
        #[schema(required)]
        hole_order_um: Option<f64> = running.hole_order.map(to_um),
    }
}

document! {
    /// How far the tips of both gears have moved outward.
    pub struct RadialGrowth as RadialGrowth, "Radial growth" answer of (growth: [f64; 2]) {
        /// Those of the driving gear, in um.
        driving: f64 = to_um(growth[0]),
        /// Those of the driven gear, in um.
        driven: f64 = to_um(growth[1]),
    }
}

document! {
    /// The load along the common face.
    pub struct FaceDocument as Face, "Load along the face" answer of (face: &FaceLoad) {
        /// The middles of equal strips of the common face, in mm from its middle; +z is the side from which the driving gear is seen to turn
        /// counter-clockwise.
        z_mm: Vec<f64> = each(&face.heights, to_mm),
        /// The load on each strip for its width, along the transverse line of action, in N/mm: one row, the mean over the positions, or a row a
        /// position where the submission asks for them.
        load_n_per_mm: Vec<Vec<f64>> = all(&face.load, |row| each(row, |load| load * 1e-3)),
        /// K_Hbeta: of ten equal strips of the common face the load of the largest over their mean, the mean over the positions of each.
        face_load_factor: f64 = face.face_load_factor,
        /// The lead that would make K_Hbeta least.
        cure?: LeadCureDocument = face.cure.as_ref().map(LeadCureDocument::of),
        /// Where the load stands in the mean at each position, in mm from the middle of the common face.
        load_centroid_mm: Vec<f64> = each(&face.load_centroid, to_mm),
    }
}

document! {
    /// Lead modification that makes the load even along the face at this torque: add a slope and a crowning of these amounts to the `lead_modifications` of the
    /// driving gear. Found from a few positions, and within 2 % of the amounts that a job finds for it.
    pub struct LeadCureDocument as LeadCure, "Lead that evens the load"
    answer of (cure: &LeadCorrection) {
        /// The slope to add, in um: taken off at the +z end of the face; negative adds.
        lead_slope_um: f64 = significant(to_um(cure.slope), 4),
        /// The crowning to add, in um; negative reduces the crowning of the leads, and never makes a flank hollow.
        crowning_um: f64 = significant(to_um(cure.crowning), 4),
        /// K_Hbeta with both.
        face_load_factor: f64 = significant(cure.face_load_factor, 4),
    }
}

document! {
    /// Statistics over the span.
    pub struct StatisticsDocument as Statistics, "Statistics"
    answer of (case: &Case, curve: &Curve) {
        /// True if the span is less than whole true periods.
        partial: bool = !case.covers_whole_periods(),
        /// Of the transmission error, in um.
        transmission_error_um: TransmissionErrorStatistics = TransmissionErrorStatistics::of(curve),
        /// Of the tangent stiffness, in N/m.
        mesh_stiffness_tangent_n_per_m: StatisticsValues =
            StatisticsValues::of(&curve.mesh_stiffness_tangent_statistics, |value| value),
        /// Of the contact pressure, in MPa; absent in results of versions before 0.5.
        peak_contact_pressure_mpa?: PressureStatistics =
            Some(PressureStatistics::of(&case.pair, curve)),
        /// The largest stresses, where they were asked for.
        stress?: PeakStressDocument = curve
            .stresses
            .as_ref()
            .map(|stresses| PeakStressDocument::of((case, &curve.mesh_position), stresses)),
    }
}

document! {
    /// Statistics of the transmission error, in um: also those of single-flank testing, by the terms of ISO/TR 10064-1.
    pub struct TransmissionErrorStatistics
    as TransmissionErrorStatistics, "Statistics of the transmission error"
    answer of (curve: &Curve) {
        /// Statistics that both curves have.
        #[serde(flatten)]
        whole: StatisticsValues = StatisticsValues::of(&curve.transmission_error_statistics, to_um),
        /// f_i', the largest range in any stretch of one mesh period; null in results of versions before 0.5.
        #[serde(default, serialize_with = "one_or_null")]
        #[schema(required)]
        tooth_to_tooth: Option<f64> = Some(to_um(curve.single_flank.tooth_to_tooth)),
        /// f_l', the peak-to-peak of the part with fewer than half a cycle in a mesh period; null for a partial span, which does not contain it.
        #[serde(default, serialize_with = "one_or_null")]
        #[schema(required)]
        long_wave: Option<f64> = curve.single_flank.long_wave.map(to_um),
        /// f_k', the peak-to-peak of the rest; null as `long_wave` is.
        #[serde(default, serialize_with = "one_or_null")]
        #[schema(required)]
        short_wave: Option<f64> = curve.single_flank.short_wave.map(to_um),
        /// The root mean square of the harmonics of the mesh; null as `long_wave` is, but over windows, from which it is estimated.
        #[serde(default, serialize_with = "one_or_null")]
        #[schema(required)]
        mesh_harmonics_rms: Option<f64> = {
            let estimated = curve.mesh_wave.as_ref().map(MeshWave::rms);
            curve.single_flank.mesh_harmonics_rms.or(estimated).map(to_um)
        },
    }
}

impl Deref for TransmissionErrorStatistics {
    type Target = StatisticsValues;

    fn deref(&self) -> &StatisticsValues {
        &self.whole
    }
}

document! {
    /// Mean, fluctuation and extremes of a curve, in its unit: of the curve between its positions too, so that they may lie outside the lists.
    pub struct StatisticsValues as StatisticsValues, "Statistics of a curve"
    answer of (statistics: &Statistics, convert: fn(f64) -> f64) {
        /// The mean.
        mean: f64 = convert(statistics.mean),
        /// The root mean square of the fluctuation, the mean removed.
        rms: f64 = convert(statistics.rms),
        /// The largest less the smallest value, as both are told.
        peak_to_peak: f64 = told(convert(statistics.largest)) - told(convert(statistics.smallest)),
        /// The smallest value; where a pair takes up or leaves the load, of both sides.
        #[serde(default)]
        #[schema(required)]
        smallest: f64 = convert(statistics.smallest),
        /// The mesh position at which it stands.
        #[serde(default)]
        #[schema(required)]
        smallest_at: f64 = significant(statistics.smallest_at, 6),
        /// The largest value; where a pair takes up or leaves the load, of both sides.
        #[serde(default)]
        #[schema(required)]
        largest: f64 = convert(statistics.largest),
        /// The mesh position at which it stands.
        #[serde(default)]
        #[schema(required)]
        largest_at: f64 = significant(statistics.largest_at, 6),
    }
}
