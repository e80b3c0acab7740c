//! Running of a pair: gears that rotate, are warm and are pressed onto shafts.

use std::f64::consts::TAU;

use crate::gear::{FlankGrowth, GearPair, Member};

/// A speed of rotation, in revolutions per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationSpeed(pub f64);

/// Support of a gear's bore while it rotates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bore {
    /// A rigid hub.
    Held,
    /// Only its mean rotation and displacement are held.
    Free,
    /// A solid shaft of the material of the gear, which is larger in radius by `interference` meters before both are joined.
    PressFit {
        /// Half of the interference of the diameters, in meters.
        interference: f64,
    },
}

impl Bore {
    /// Half of the interference of the diameters of bore and shaft in meters, 0 without a press fit.
    pub(super) fn interference(self) -> f64 {
        match self {
            Self::PressFit { interference } => interference,
            Self::Held | Self::Free => 0.0,
        }
    }
}

/// Running of one gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunningGear {
    /// The strain by which it has grown with its temperature.
    pub thermal_strain: f64,
    /// Support of its bore; a gear in one piece with its shaft is held by that.
    pub bore: Bore,
    /// The tensile strength of its material in pascals, where it is known.
    pub tensile_strength: Option<f64>,
}

/// Running state of a pair. Its center distance is that of the warm housing over 1 plus [`Running::shared_strain`]: a pair that has grown evenly, tips and all,
/// is similar to the drawn one, and only the unequal growth of its parts is in its flanks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Running {
    /// The speed of the driving gear.
    pub driving_speed: RotationSpeed,
    /// The driving and the driven gear.
    pub gears: [RunningGear; 2],
}

/// Effect of running on a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveRunning {
    /// How far the tips of the driving and of the driven gear have moved outward in the mean, in meters.
    pub radial_growth: [f64; 2],
    /// The largest amplitude, over the orders of the holes, of δ at speed less δ of the same pair at rest, in meters; `None` without holes, or without a
    /// spectrum.
    pub hole_order: Option<f64>,
}

impl Running {
    /// The strain that both gears share: the mean of their thermal strains.
    pub fn shared_strain(&self) -> f64 {
        f64::midpoint(self.gears[0].thermal_strain, self.gears[1].thermal_strain)
    }

    /// True if all teeth of a gear grow by the same amount, whatever its holes are: at rest, and without a press fit.
    pub(super) fn grows_evenly(&self) -> bool {
        let is_fitted = |gear: &RunningGear| gear.bore.interference() != 0.0;
        self.driving_speed.0 == 0.0 && !self.gears.iter().any(is_fitted)
    }

    /// The thermal growth of the flanks of both gears of `pair` beyond their common part.
    pub fn thermal_growth(&self, pair: &GearPair) -> [FlankGrowth; 2] {
        Member::BOTH.map(|member| {
            let strain = self.gears[member.index()].thermal_strain;
            let mut growth = FlankGrowth::default();
            growth.add_strain(pair.gear(member), strain - self.shared_strain());
            growth
        })
    }

    /// The angular speed of `member` in radians per second.
    pub(super) fn angular_speed(&self, pair: &GearPair, member: Member) -> f64 {
        let teeth = |member| f64::from(pair.gear(member).tooth_count());
        TAU * self.driving_speed.0 * teeth(Member::Driving) / teeth(member)
    }
}

/// The stresses along the free edges of a gear that runs without load, in Pa.
#[derive(Debug, Clone, Default)]
pub(super) struct RestingStresses {
    /// Along the fillets of each tooth.
    pub(super) in_teeth: Vec<Vec<f64>>,
    /// Around the holes of each sector of the blank.
    pub(super) in_blank: Vec<Vec<f64>>,
}

impl RestingStresses {
    /// Stress at place `i` of the fillets of `tooth`.
    pub(super) fn in_tooth(&self, tooth: usize, i: usize) -> f64 {
        self.in_teeth.get(tooth).map_or(0.0, |places| places[i])
    }

    /// Stress at place `i` around the holes of `sector`.
    pub(super) fn in_blank(&self, sector: usize, i: usize) -> f64 {
        self.in_blank.get(sector).map_or(0.0, |places| places[i])
    }
}
