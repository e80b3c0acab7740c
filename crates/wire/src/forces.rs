//! Requests beside the curves: a table of force, and the motion over speed.

use meshwright_engine::analysis::at_speed::{DynamicsRequest, MOST_MODES, MountRequest};
use meshwright_engine::analysis::forces::ForceTableRequest;
use meshwright_engine::gear::Member;

use serde::Serializer;
use serde_json::{Value, json};

use super::declare::{
    EACH, Kind, List, Location, Named, Node, Number, absent, document, list, nested, number, word,
    words,
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
    /// The motion of the gears over speed: torsion on the line of action, with backlash, of gears whose bodies turn in themselves; with all modes of the bodies
    /// where the submission has `modes`, and on shafts and supports where these are given.
    pub struct DynamicsQuestion as "DynamicsRequest", "Dynamics request" {
        /// The speeds of the driving gear, or the only one.
        pub(super) driving_speed_rpm: Speeds = (),
        /// The damping over the critical one, of the mean mesh stiffness; it acts out of contact too.
        damping_ratio: f64 = number("Damping ratio", "1", 1e-3, 1.0).or(0.05),
        /// The polar inertia of all that turns with the driving gear. What exceeds its own is at the bore.
        driving_inertia_kg_m2: Option<f64> = absent(
            number("Driving inertia", "kg m^2", 1e-9, 1e6),
            "that of the gear as drawn",
        ),
        /// The polar inertia of all that turns with the driven gear. What exceeds its own is at the bore.
        driven_inertia_kg_m2: Option<f64> = absent(
            number("Driven inertia", "kg m^2", 1e-9, 1e6),
            "that of the gear as drawn",
        ),
        /// The number of modes of each gear body between bore and teeth, which are outside its web. 0: rims and teeth turn with the hubs. The modes are those
        /// in torsion. Where the submission has `modes`, those in the plane are among them, and along faces those out of the plane: of the modes below twice the
        /// highest mesh frequency, those by which the body yields most. A gear that is to have less inertia than it has as drawn has none, and neither have gears by
        /// the method `load_distribution`.
        blank_modes: Option<u32> = absent(
            number("Blank modes", "1", 0.0, MOST_MODES as f64),
            "as many as lie below twice the highest mesh frequency, and at least one",
        ),
        /// The damping of these modes over the critical one, and of each mode of a gear by itself on its shaft and its support.
        blank_damping_ratio: f64 = number("Blank damping ratio", "1", 0.0, 1.0).or(0.02),
        /// Shafts between the hubs and the machines beside them. The far end of a shaft turns evenly, at the angle at which the shaft carries the torque at rest.
        pub(super) shaft_stiffness_n_m_per_rad: Option<ShaftStiffnessDocument> = absent(
            nested("ShaftStiffness"),
            "the torques at the hubs do not change",
        )
        .left_out(),
        /// Stiffness that carries each gear as a rigid body, beside its turn: motions of the gear along and about its axes, which the mesh force excites.
        pub(super) support_stiffness: Option<SupportStiffnessDocument> = absent(
            nested("SupportStiffness"),
            "the axes stand still",
        )
        .left_out(),
        /// Which way the speeds are run through.
        sweep: Sweep = word("Sweep").or(Sweep::Both),
    }
}

document! {
    /// The torsional stiffness of the shaft of each gear, between its hub and a far end that turns evenly.
    pub struct ShaftStiffnessDocument as "ShaftStiffness", "Shaft stiffness" {
        /// That of the shaft of the driving gear.
        driving: Option<f64> = absent(
            shaft("Shaft of the driving gear"),
            "the torque at the driving hub does not change",
        ),
        /// That of the shaft of the driven gear.
        driven: Option<f64> = absent(
            shaft("Shaft of the driven gear"),
            "the torque at the driven hub does not change",
        ),
    }
}

document! {
    /// The stiffness of the support of each gear about the middle of its face, in six rows of six numbers. Rows are force and torque along x, y and z; columns
    /// are displacement and turn along x, y and z; units are N/m, N and N m. x points towards the mate, z along the axis to the side from which the driving gear is seen to turn
    /// counter-clockwise. It stands still as the gear turns, is symmetric, has no negative eigenvalue and holds the gear against the mesh force.
    pub struct SupportStiffnessDocument as "SupportStiffness", "Support stiffness" {
        /// That of the driving gear.
        driving: Option<Vec<Vec<f64>>> = absent(
            support("Support of the driving gear"),
            "the axis of the driving gear stands still",
        ),
        /// That of the driven gear.
        driven: Option<Vec<Vec<f64>>> = absent(
            support("Support of the driven gear"),
            "the axis of the driven gear stands still",
        ),
    }
}

/// Rows and columns of the stiffness of a support.
pub(super) const MOTIONS: usize = 6;

const fn shaft(title: &'static str) -> Number {
    number(title, "N m/rad", 1.0, 1e12)
}

const fn support(title: &'static str) -> List<List<Number>> {
    let row = list("", number("", "N/m, N, N m", -1e15, 1e15), MOTIONS);
    list(title, row, MOTIONS)
}

impl SupportStiffnessDocument {
    /// The rows of the support of a gear.
    pub(super) fn of(&self, member: Member) -> Option<&[Vec<f64>]> {
        let rows = match member {
            Member::Driving => &self.driving,
            Member::Driven => &self.driven,
        };
        rows.as_deref()
    }

    /// The support of a gear, where it has six rows of six numbers: the mean of the stiffness and its transpose.
    pub(super) fn matrix(&self, member: Member) -> Option<[[f64; MOTIONS]; MOTIONS]> {
        let rows = self.of(member)?;
        let is_whole = rows.len() == MOTIONS && rows.iter().all(|row| row.len() == MOTIONS);
        let mean = |i: usize| std::array::from_fn(|j| f64::midpoint(rows[i][j], rows[j][i]));
        is_whole.then(|| std::array::from_fn(mean))
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
    /// What the engine is asked; bodies vibrate in all directions where the submission asks for their natural modes.
    pub(super) fn data(&self, all_directions: bool) -> DynamicsRequest {
        let shafts = self.shaft_stiffness_n_m_per_rad.as_ref();
        let shafts = shafts.map_or([None; 2], |shafts| [shafts.driving, shafts.driven]);
        let supports = self.support_stiffness.as_ref();
        let mounts = Member::BOTH.map(|member| MountRequest {
            shaft: shafts[member.index()],
            support: supports.and_then(|supports| supports.matrix(member)),
        });
        DynamicsRequest {
            speeds: self
                .driving_speed_rpm
                .list()
                .iter()
                .map(|rpm| rpm / 60.0)
                .collect(),
            damping_ratio: self.damping_ratio,
            inertias: [self.driving_inertia_kg_m2, self.driven_inertia_kg_m2],
            blank_modes: self.blank_modes,
            all_directions,
            blank_damping_ratio: self.blank_damping_ratio,
            mounts,
            sweeps: [self.sweep != Sweep::Down, self.sweep != Sweep::Up],
        }
    }
}
