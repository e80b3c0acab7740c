//! What is asked beside the curves: a table of force, and the motion over speed.

use meshwright_engine::analysis::at_speed::DynamicsRequest;
use meshwright_engine::analysis::forces::ForceTableRequest;

use super::declare::{absent, document, nested, number, word, words};

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
        /// The number of loads, 0 among them. They rise as the power 3/2 of their place, from 0 to the largest. The table has twice as many
        /// positions as the curves. Interpolated with its stiffnesses it is within 0.2 % of the largest load of direct solutions with 12 loads and 40
        /// positions in a mesh period, nine times of ten within 0.03 %.
        pub(super) loads: u32 = number("Loads", "1", 4.0, 60.0).or(12.0),
        /// The output torque of the largest load. Beyond it the table goes on straight.
        pub(super) largest_output_torque_n_m: Option<f64> = absent(
            number("Largest output torque", "N m", 1e-6, 1e8),
            "twice the largest output torque",
        ),
    }
}

impl ForceTableQuestion {
    /// What is asked where a table is needed and nothing is said of it.
    pub(super) fn usual() -> Self {
        Self {
            loads: 12,
            largest_output_torque_n_m: None,
        }
    }

    pub(super) fn data(&self) -> ForceTableRequest {
        ForceTableRequest {
            loads: self.loads,
            largest_output_torque: self.largest_output_torque_n_m,
        }
    }
}

document! {
    /// The motion of the gears over speed: one torsional degree of freedom on the line of action, with backlash.
    pub struct DynamicsQuestion as "DynamicsRequest", "Dynamics request" {
        /// The speeds of the driving gear.
        pub(super) driving_speed_rpm: SpeedRange = nested("SpeedRange"),
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
        pub(super) from: f64 = number("Lowest speed", "1/min", 0.0, 1e6),
        /// The highest speed.
        pub(super) to: f64 = number("Highest speed", "1/min", 0.0, 1e6),
        /// The number of speeds.
        pub(super) count: u32 = number("Speeds", "1", 2.0, 4000.0).or(400.0),
    }
}

impl SpeedRange {
    /// The speeds in 1/min.
    fn speeds(&self) -> impl Iterator<Item = f64> {
        let step = (self.to - self.from) / f64::from(self.count - 1);
        (0..self.count).map(move |i| {
            if i + 1 == self.count {
                self.to
            } else {
                self.from + f64::from(i) * step
            }
        })
    }
}

impl DynamicsQuestion {
    pub(super) fn data(&self) -> DynamicsRequest {
        DynamicsRequest {
            speeds: self
                .driving_speed_rpm
                .speeds()
                .map(|rpm| rpm / 60.0)
                .collect(),
            damping_ratio: self.damping_ratio,
            inertias: [self.driving_inertia_kg_m2, self.driven_inertia_kg_m2],
            sweeps: [self.sweep != Sweep::Down, self.sweep != Sweep::Up],
        }
    }
}
