//! Results: curves over mesh position.

pub use super::curve_point::{CurvePoint, EventSide, SAME_POSITION};
pub use super::load_share::LoadShare;
use super::mesh_wave::MeshWave;
use super::pressures::CurvePressures;
use super::running::CurveRunning;
use super::single_flank::SingleFlank;
use super::spectrum::Spectrum;
use super::statistics::{SamplingError, Statistics};
use super::stress::GearStresses;
use crate::contact::face::even::EvenLead;
use crate::gear::{Member, SpurGear};

/// One sample of a holed blank in the decomposition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlankSample {
    /// The mesh position η.
    pub mesh_position: f64,
    /// R_b θ_gb in meters.
    pub rotation: f64,
}

/// The decomposition's fit for one holed blank: A + B cos(N θ + phase), eq. 13.
#[derive(Debug, Clone, PartialEq)]
pub struct BlankFit {
    /// The gear.
    pub member: Member,
    /// The interface radius R_w.
    pub interface_radius: f64,
    /// A in meters.
    pub mean: f64,
    /// B ≥ 0 in meters.
    pub amplitude: f64,
    /// The phase in radians.
    pub phase: f64,
    /// Amplitude and phase of the harmonics 2, 3, … of holes that are not equal or not equally spaced; the paper has none.
    pub higher: Vec<(f64, f64)>,
    /// The samples that were fitted.
    pub samples: Vec<BlankSample>,
}

impl BlankFit {
    /// The fitted rotation R_b θ_gb at the angle `angle` = N θ, in meters.
    pub fn at(&self, angle: f64) -> f64 {
        let first = self.amplitude * (angle + self.phase).cos();
        let higher = self.higher.iter().zip(2_u32..);
        let higher =
            higher.map(|((amplitude, phase), k)| amplitude * (f64::from(k) * angle + phase).cos());
        self.mean + first + higher.sum::<f64>()
    }

    /// The fitted rotation of the blank of `gear` at a mesh position, in meters.
    pub(super) fn at_position(&self, gear: &SpurGear, mesh_position: f64) -> f64 {
        // Eq. (13) has 2πθ and N; with θ in radians, a period of 2π/N is cos(Nθ).
        self.at(f64::from(gear.hole_repeats()) * mesh_position * gear.pitch_angle())
    }

    /// The largest difference of the fit to its samples, in meters.
    pub(super) fn remainder(&self, gear: &SpurGear) -> f64 {
        let each = self.samples.iter();
        let left = each
            .map(|sample| (sample.rotation - self.at_position(gear, sample.mesh_position)).abs());
        left.fold(0.0, f64::max)
    }
}

/// The parts that the decomposition adds up, eq. 15.
#[derive(Debug, Clone, PartialEq)]
pub struct DecompositionParts {
    /// δ_wh at each position of the curve, in meters.
    pub rigid_blank_transmission_error: Vec<f64>,
    /// One entry a holed gear.
    pub blanks: Vec<BlankFit>,
}

/// Lead that makes the load even along the face: a further modification of the driving leads. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeadCorrection {
    /// Removed at the end at +z, linear from zero at the end at −z.
    pub slope: f64,
    /// Removed at both ends, a parabola.
    pub crowning: f64,
    /// K_Hβ with it.
    pub face_load_factor: f64,
}

impl LeadCorrection {
    /// The lead `lead` with the face load factor that it gives.
    pub(super) fn of(lead: EvenLead, face_load_factor: f64) -> Self {
        Self {
            slope: lead.slope,
            crowning: lead.crowning,
            face_load_factor: (lead.lowered * face_load_factor).max(1.0),
        }
    }
}

/// The load along the common face. Lengths are in meters.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceLoad {
    /// The middles of equal strips, from the middle of the common face.
    pub heights: Vec<f64>,
    /// The load in N/m on each: its mean over the positions, in one row, or a row a position.
    pub load: Vec<Vec<f64>>,
    /// K_Hβ: the largest of ten equal strips over their mean, the mean over the positions of each.
    pub face_load_factor: f64,
    /// The lead that would make K_Hβ least, if it was found.
    pub cure: Option<LeadCorrection>,
    /// Where the load stands in the mean, at each position.
    pub load_centroid: Vec<f64>,
}

/// The curves at one output torque. All lists run over the same positions, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The output torque T in N m.
    pub output_torque: f64,
    /// The transmitted load F = T/r_b2 in N.
    pub load: f64,
    /// Mesh position η, in mesh periods.
    pub mesh_position: Vec<f64>,
    /// The static transmission error δ in meters, positive when load makes the driven gear lag.
    pub transmission_error: Vec<f64>,
    /// k = dF/dδ in N/m, eq. 3.
    pub mesh_stiffness_tangent: Vec<f64>,
    /// F/δ in N/m.
    pub mesh_stiffness_secant: Vec<f64>,
    /// The torque in N m that the driver has to give: it is F r_b1 where unmodified flanks touch on the line of action alone.
    pub driving_torque: Vec<f64>,
    /// The number of tooth pairs that carry load.
    pub pairs_in_contact: Vec<u32>,
    /// The largest contact pressure in Pa; `None` where a sharp tip corner carries, at which it has no limit.
    pub peak_contact_pressure: Vec<Option<f64>>,
    /// Summary of the pressures.
    pub pressures: CurvePressures,
    /// The share of each pair that ever carries load, by rising offset.
    pub load_shares: Vec<LoadShare>,
    /// Points between the positions, rising: the events, twice each, the extremes, and further positions at which the contact was solved.
    pub points: Vec<CurvePoint>,
    /// The largest contact pressure in Pa at further mesh positions; `None` as in `peak_contact_pressure`.
    pub peak_pressures_between: Vec<(f64, Option<f64>)>,
    /// Of δ.
    pub transmission_error_statistics: Statistics,
    /// The parts of δ that single-flank testing distinguishes.
    pub single_flank: SingleFlank,
    /// Of the tangent stiffness.
    pub mesh_stiffness_tangent_statistics: Statistics,
    /// By how much the statistics of δ may be off between the positions.
    pub sampling_error: SamplingError,
    /// The order spectrum, where the span is whole periods: of the curve between its positions too.
    pub spectrum: Option<Spectrum>,
    /// The part that repeats with every mesh period, estimated from the windows of a case that has some.
    pub mesh_wave: Option<MeshWave>,
    /// The parts of the decomposition, for that method.
    pub decomposition: Option<DecompositionParts>,
    /// The load along the common face, by the method that sees it, under load.
    pub face: Option<FaceLoad>,
    /// The largest stresses in the driving and in the driven gear, where they were asked for, by a whole contact at each position, under load.
    pub stresses: Option<[GearStresses; 2]>,
    /// Effect of running, of a pair that runs.
    pub running: Option<CurveRunning>,
}
