//! Requests beside the curves: a table of force, and the motion over speed.

use meshwright_engine::analysis::at_speed::DynamicsRequest;
use meshwright_engine::analysis::forces::ForceTableRequest;

use serde::Serializer;
use serde_json::{Value, json};

use super::declare::{
    EACH, Kind, Location, Named, Node, Number, absent, document, number, word, words,
};

words! {
    /// Which way speeds are run through.
    pub enum Sweep {
        Up = "up": "from the lowest speed to the highest",
        Down = "down": "from the highest speed to the lowest",
        Both = "both": "both, which differ where the motion jumps",
    }
}

document! {
    /// A table of the force between the gears over mesh position and approach.
    pub struct ForceTableQuestion as "ForceTableRequest", "Force table request" {
        /// The number of loads, 0 among them. They rise as the power 3/2 of their place, from 0 to the largest; of eight or more two are light, 0.00075 and
        /// 0.006 of the largest. The table has twice as many positions as the curves. Interpolated with its stiffnesses it is within 0.2 % of the largest load
        /// of direct solutions with 12 loads and 40 positions in a mesh period, nine times of ten within 0.03 %.
        pub(super) loads: u32 = number("Loads", "1", 4.0, 60.0).or(12.0),
        /// The output torque of the largest load. Beyond it the table goes on straight; where a run-up goes there, a warning tells it.
        pub(super) largest_output_torque_n_m: Option<f64> = absent(
            number("Largest output torque", "N m", 1e-6, 1e8),
            "twice the largest output torque, or what the teeth bear where that is less",
        ),
    }
}

impl ForceTableQuestion {
    /// The default request where a table is needed and none is given.
    pub(super) fn usual() -> Self {
        Self {
            loads: 12,
            largest_output_torque_n_m: None,
        }
    }

    /// The table for curves up to the output torque `largest` in N m, of teeth that bear `bearable`.
    pub(super) fn data(&self, largest: f64, bearable: f64) -> ForceTableRequest {
        let usual = (2.0 * largest > bearable).then_some(bearable);
        ForceTableRequest {
            loads: self.loads,
            largest_output_torque: self.largest_output_torque_n_m.or(usual),
        }
    }
}

document! {
    /// The motion of the gears over speed: one torsional degree of freedom on the line of action, with backlash.
    pub struct DynamicsQuestion as "DynamicsRequest", "Dynamics request" {
        /// The speeds of the driving gear, or the only one.
        pub(super) driving_speed_rpm: Speeds = (),
        /// The damping over the critical one, of the mean mesh stiffness; it acts out of contact too.
        damping_ratio: f64 = number("Damping ratio", "1", 1e-3, 1.0).or(0.05),
        /// The polar inertia of all that turns with the driving gear.
        driving_inertia_kg_m2: Option<f64> = absent(
            number("Driving inertia", "kg m^2", 1e-9, 1e6),
            "that of the gear as drawn",
        ),
        /// The polar inertia of all that turns with the driven gear.
        driven_inertia_kg_m2: Option<f64> = absent(
            number("Driven inertia", "kg m^2", 1e-9, 1e6),
            "that of the gear as drawn",
        ),
        /// Which way the speeds are run through.
        sweep: Sweep = word("Sweep").or(Sweep::Both),
    }
}

document! {
    /// Speeds in equal steps, both ends included.
    pub struct SpeedRange as "SpeedRange", "Speed range" {
        /// The lowest speed; 0 is the static curve.
        pub(super) from: f64 = speed("Lowest speed"),
        /// The highest speed.
        pub(super) to: f64 = speed("Highest speed"),
        /// The number of speeds.
        pub(super) count: u32 = number("Speeds", "1", 2.0, 4000.0).or(400.0),
    }
}

/// A speed of the driving gear.
const fn speed(title: &'static str) -> Number {
    number(title, "1/min", 0.0, 1e6)
}

/// The speeds of the driving gear.
#[derive(Debug, Clone, PartialEq)]
pub enum Speeds {
    /// In equal steps.
    Range(SpeedRange),
    /// One, in 1/min.
    One(f64),
}

impl Speeds {
    /// The number of speeds.
    pub(super) fn count(&self) -> u32 {
        match self {
            Self::Range(range) => range.count,
            Self::One(_) => 1,
        }
    }

    /// The speeds in 1/min.
    fn list(&self) -> Vec<f64> {
        match self {
            Self::Range(SpeedRange { from, to, count }) => {
                let step = (to - from) / f64::from(count - 1);
                let inner = (0..count - 1).map(|i| from + f64::from(i) * step);
                inner.chain([*to]).collect()
            }
            Self::One(speed) => vec![*speed],
        }
    }
}

impl Kind for Speeds {
    type Spec = ();

    fn read(node: &Node, place: &Location<'_>, _: &()) -> Option<Self> {
        match node {
            Node::Object(_) => SpeedRange::read(node, place, &EACH).map(Self::Range),
            Node::Number(_) => f64::read(node, place, &speed("Speed")).map(Self::One),
            _ => place.wrong_kind(
                node,
                "a speed in 1/min or {\"from\": 0, \"to\": 20000, \"count\": 400}",
            ),
        }
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Range(range) => range.write(serializer),
            Self::One(speed) => speed.write(serializer),
        }
    }

    fn describe(about: &str, _: &()) -> Value {
        json!({
            "title": "Speeds",
            "description": about,
            "oneOf": [SpeedRange::describe("", &EACH), f64::describe("The only speed.", &speed("Speed"))],
        })
    }

    fn name_parts(named: &mut Named) {
        SpeedRange::name_parts(named);
    }
}

impl DynamicsQuestion {
    pub(super) fn data(&self) -> DynamicsRequest {
        DynamicsRequest {
            speeds: self
                .driving_speed_rpm
                .list()
                .iter()
                .map(|rpm| rpm / 60.0)
                .collect(),
            damping_ratio: self.damping_ratio,
            inertias: [self.driving_inertia_kg_m2, self.driven_inertia_kg_m2],
            sweeps: [self.sweep != Sweep::Down, self.sweep != Sweep::Up],
        }
    }
}
