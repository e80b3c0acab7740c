//! The natural modes of both gears.

use meshwright_engine::analysis::blank_modes::{Met, MetMode};
use meshwright_engine::analysis::mesh_label;
use meshwright_engine::vibration::Direction;
use meshwright_engine::vibration::campbell::Wave;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::list::all;
use crate::declare::document;
use crate::gear_name::GearName;
use crate::units::significant;

document! {
    /// The natural modes of each gear at rest, the lowest first. Two modes of one frequency, a cosine and a sine, stand once.
    pub struct ModesDocument as Modes, "Modes" answer of (modes: &[Vec<MetMode>; 2]) {
        /// Those of the driving gear.
        driving: Vec<ModeDocument> = all(&modes[0], ModeDocument::of),
        /// Those of the driven gear.
        driven: Vec<ModeDocument> = all(&modes[1], ModeDocument::of),
    }
}

document! {
    /// A natural mode of a gear.
    pub struct ModeDocument as Mode, "Mode" answer of (found: &MetMode) with {
        let mode = &found.mode;
    } {
        /// The natural frequency of the gear at rest, in Hz.
        frequency_hz: f64 = mode.frequency,
        /// The diameters that stand still, n.
        nodal_diameters: u32 = mode.nodal_diameters,
        /// The circles between bore and teeth that stand still.
        nodal_circles: u32 = mode.nodal_circles,
        /// Along what it moves for the most part.
        direction: ModeDirection = mode.direction.into(),
        /// Whether two modes have this frequency, a cosine and a sine.
        is_double: bool = mode.is_double,
        /// By how many Hz one turn of its gear a second parts the two waves of the mode, seen in space: n out of the plane, n - c in it, where c is what Coriolis
        /// forces take back. 0 where the mode is one standing wave in space.
        wave_split: f64 = significant(mode.split(), 6),
        /// Where orders of the mesh meet it, up to the fifth: within the speeds of `dynamics` where these are a range, at any speed otherwise.
        crossings: Vec<CrossingDocument> = all(&found.met, CrossingDocument::of),
    }
}

document! {
    /// A speed at which an order of the mesh meets a mode, seen from the mesh, which stands still in space.
    pub struct CrossingDocument as Crossing, "Crossing" answer of (met: &Met) {
        /// The name of the order of the mesh, as in the spectrum.
        #[schema(example = "H_Z2")]
        label: String = mesh_label(met.crossing.multiple),
        /// The speed of the driving gear, in 1/min.
        driving_speed_rpm: f64 = 60.0 * met.driving_speed.0,
        /// The wave that is met.
        wave: WaveName = met.crossing.wave.into(),
    }
}

/// Along what a mode moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ModeDirection, title = "Direction of a mode")]
pub enum ModeDirection {
    /// Around the axis, alike on all of a circle.
    Torsion,
    /// In the plane of the gear.
    InPlane,
    /// Along the axis.
    OutOfPlane,
}

impl ModeDirection {
    /// Its words in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Torsion => "torsion",
            Self::InPlane => "in the plane",
            Self::OutOfPlane => "out of the plane",
        }
    }
}

impl From<Direction> for ModeDirection {
    fn from(direction: Direction) -> Self {
        match direction {
            Direction::Torsion => Self::Torsion,
            Direction::InPlane => Self::InPlane,
            Direction::OutOfPlane => Self::OutOfPlane,
        }
    }
}

/// A wave of a mode about the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ModeWave, title = "Wave of a mode")]
pub enum WaveName {
    /// With the turn of the gear.
    Forward,
    /// Against it.
    Backward,
    /// Neither.
    Standing,
}

impl WaveName {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Backward => "backward",
            Self::Standing => "standing",
        }
    }
}

impl From<Wave> for WaveName {
    fn from(wave: Wave) -> Self {
        match wave {
            Wave::Forward => Self::Forward,
            Wave::Backward => Self::Backward,
            Wave::Standing => Self::Standing,
        }
    }
}

impl ModesDocument {
    /// The modes of `gear`.
    pub fn of_gear(&self, gear: GearName) -> &[ModeDocument] {
        match gear {
            GearName::Driving => &self.driving,
            GearName::Driven => &self.driven,
        }
    }
}
