//! What is asked of the natural modes of the gears.

use meshwright_engine::analysis::RotationSpeed;
use meshwright_engine::analysis::blank_modes::ModesRequest;
use meshwright_engine::vibration::{BoreSupport, ModesAsked};

use super::declare::{absent, document, number, word, words};
use super::forces::{DynamicsQuestion, Speeds};

words! {
    /// How the bore carries a gear that vibrates.
    pub enum BoreWord {
        Held = "held": "the bore does not move",
        FreeToTurn = "free_to_turn":
            "the bore turns about its axis as a rigid ring, and is held otherwise; the rigid turn is no mode",
    }
}

document! {
    /// Natural frequencies and shapes of each gear at rest, teeth on it, in three dimensions whatever the method. Shafts, bearings and the mate are left out.
    /// The run-up of a submission with `dynamics` takes in the modes of all directions with the bore held, by the number `dynamics.blank_modes`.
    pub struct ModesQuestion as "ModesRequest", "Modes request" {
        /// The most modes of each gear, the lowest first. Two modes of one frequency, a cosine and a sine, stand once. A gear has at most as many as its grid
        /// tells apart: 36 up to 36 teeth, one for each tooth up to 80.
        pub(super) count: u32 = number("Modes", "1", 1.0, 80.0).or(20.0),
        /// The highest frequency.
        highest_hz: Option<f64> = absent(
            number("Highest frequency", "Hz", 1.0, 1e7),
            "no limit beside the number of modes",
        ),
        /// How the bore carries the gear.
        bore: BoreWord = word("Bore").or(BoreWord::Held),
    }
}

impl ModesQuestion {
    /// What the engine is asked; the mesh matters at the speeds of `dynamics`.
    pub(super) fn data(&self, dynamics: Option<&DynamicsQuestion>) -> ModesRequest {
        let bore = match self.bore {
            BoreWord::Held => BoreSupport::Held,
            BoreWord::FreeToTurn => BoreSupport::FreeToTurn,
        };
        let speeds = dynamics.and_then(|dynamics| match &dynamics.driving_speed_rpm {
            Speeds::Range(range) => Some([range.from, range.to]),
            Speeds::One(_) => None,
        });
        ModesRequest {
            asked: ModesAsked {
                count: self.count as usize,
                highest: self.highest_hz,
                bore,
            },
            speeds: speeds.map(|ends| ends.map(|rpm| RotationSpeed(rpm / 60.0))),
        }
    }
}
