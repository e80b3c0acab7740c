//! How the holes of both gears stand best.

use meshwright_engine::analysis::hole_phase::{AtTurn, HolePhase};

use super::all;
use crate::declare::document;
use crate::units::{significant, to_um};

document! {
    /// The best turn of the driving gear's holes against those of the driven one, which excite one order together: the gears repeat at one order where holes over teeth
    /// are the same in both. The turn follows from the first order of what holes change, which full solutions at two turns correct.
    pub struct HolePhaseDocument as HolePhase, "Best phase of the holes"
    answer of (phase: &HolePhase) {
        /// The output torque under which it is the best, in N m: the largest of the submission.
        output_torque_n_m: f64 = phase.output_torque,
        /// The order of the holes, for each revolution of the driven gear.
        order: u32 = phase.order,
        /// What to add to `phase_deg` of the driving gear's holes, in degrees: from 0 to a hole pitch of the driving gear.
        turn_of_driving_deg: f64 = degrees(phase.turn_of_driving),
        /// The amplitude of the transmission error at this order with the turn, in um.
        amplitude_um: f64 = to_um(phase.amplitude),
        /// That of the submission as it is, in um.
        amplitude_now_um: f64 = to_um(phase.amplitude_now),
        /// The best turn where the other flanks carry, in degrees.
        other_flanks_turn_deg: f64 = degrees(phase.other_flanks_turn),
        /// Results of turns from 0 to a hole pitch of the driving gear.
        over_turn: OverTurnDocument = OverTurnDocument::of(&phase.over_turn),
    }
}

document! {
    /// Amplitude and peak-to-peak over the turn of the driving gear's holes. All lists run over the same turns.
    pub struct OverTurnDocument as OverTurn, "Over the turn of the holes"
    answer of (turns: &[AtTurn]) {
        /// What is added to `phase_deg` of the driving gear's holes, in degrees.
        turn_of_driving_deg: Vec<f64> = all(turns, |at| degrees(at.turn)),
        /// The amplitude of the transmission error at the order of the holes, in um.
        amplitude_um: Vec<f64> = all(turns, |at| to_um(at.amplitude)),
        /// The peak-to-peak of the transmission error at first order, in um, at up to 20 positions of each mesh period.
        peak_to_peak_um: Vec<f64> = all(turns, |at| to_um(at.peak_to_peak)),
    }
}

/// An angle in degrees, to the digits in which a turn is known.
fn degrees(angle: f64) -> f64 {
    significant(angle.to_degrees(), 7)
}
