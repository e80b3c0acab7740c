//! The natural modes of both gears of a case, and where the mesh meets them.

use super::case::Case;
use super::cost::Estimate;
use super::error::AnalysisError;
use super::running::RotationSpeed;
use crate::fem::FemError;
use crate::gear::{Helix, Member, SolidGear, SolidGearError};
use crate::run::Run;
use crate::vibration::campbell::Crossing;
use crate::vibration::{self, Mode, ModeShape, ModesAsked, ModesError, ShapeSize};

/// Multiples of the mesh order that are looked at.
pub const MULTIPLES: u32 = 5;

/// The modes that are asked for, and the speeds at which it matters where the mesh meets them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModesRequest {
    /// The modes of each gear.
    pub asked: ModesAsked,
    /// The lowest and the highest speed of the driving gear; all speeds where there are none.
    pub speeds: Option<[RotationSpeed; 2]>,
}

/// A speed at which the mesh meets a mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Met {
    /// Multiple and wave; its turns are those of the gear.
    pub crossing: Crossing,
    /// The speed of the driving gear.
    pub driving_speed: RotationSpeed,
}

/// A mode with the speeds at which the mesh meets it.
#[derive(Debug, Clone, PartialEq)]
pub struct MetMode {
    /// The mode.
    pub mode: Mode,
    /// The speeds, order by order.
    pub met: Vec<Met>,
}

impl Case {
    /// A gear of the case with its extent along the axis: straight and as wide as its face where the model is plane.
    ///
    /// # Errors
    ///
    /// [`SolidGearError`] where a plane gear has no such counterpart: holes across the edge of a web.
    pub fn solid_gear(&self, member: Member) -> Result<SolidGear, SolidGearError> {
        match self.faces() {
            Some(faces) => Ok(faces.pair.gear(member).clone()),
            None => {
                let data = self.pair.gear(member).data().clone();
                SolidGear::new(data, Helix::STRAIGHT, 0.0, None)
            }
        }
    }
}

/// The modes of the driving and the driven gear of `case`.
///
/// # Errors
///
/// [`AnalysisError::Discretization`] if a gear cannot be divided, and [`AnalysisError::Stopped`].
pub fn blank_modes(
    case: &Case,
    request: &ModesRequest,
    run: &Run,
) -> Result<[Vec<MetMode>; 2], AnalysisError> {
    let gears = [solid(case, Member::Driving)?, solid(case, Member::Driven)?];
    let of = |member: Member| {
        let modes = vibration::modes(&gears[member.index()], request.asked, run);
        modes.map_err(|error| of_modes(error, member))
    };
    let driving = of(Member::Driving)?;
    // Equal gears have equal modes.
    let driven = if gears[0] == gears[1] {
        driving.clone()
    } else {
        of(Member::Driven)?
    };
    let met = |modes: Vec<Mode>, member: Member| {
        let modes = modes.into_iter();
        modes.map(|mode| met(mode, case, member, request)).collect()
    };
    Ok([met(driving, Member::Driving), met(driven, Member::Driven)])
}

/// `error` as that of the gear `member`.
pub(super) fn of_modes(error: ModesError, member: Member) -> AnalysisError {
    match error {
        ModesError::Fem(FemError::Stopped(stopped)) => AnalysisError::Stopped(stopped),
        error => AnalysisError::Discretization {
            member,
            reason: error.to_string(),
        },
    }
}

/// The shape of a mode of a gear of `case`, by its place among the [`blank_modes`], from 0; `None` beyond the last of them.
///
/// # Errors
///
/// As for [`blank_modes`].
pub fn mode_shape(
    case: &Case,
    request: &ModesRequest,
    (member, place): (Member, usize),
    run: &Run,
) -> Result<Option<ModeShape>, AnalysisError> {
    let gear = solid(case, member)?;
    let shape = vibration::mode_shape(&gear, request.asked, place, run);
    shape.map_err(|error| of_modes(error, member))
}

/// A gear of `case` with its extent along the axis.
pub(super) fn solid(case: &Case, member: Member) -> Result<SolidGear, AnalysisError> {
    let gear = case.solid_gear(member);
    gear.map_err(|error| AnalysisError::Discretization {
        member,
        reason: error.to_string(),
    })
}

/// `mode` of a gear of `case` with the speeds of `request` at which the mesh meets it.
fn met(mode: Mode, case: &Case, member: Member, request: &ModesRequest) -> MetMode {
    let z = case.pair.gear(member).tooth_count();
    // Turns of the driving gear for each of this one.
    let ratio = f64::from(z) / f64::from(case.pair.driving().tooth_count());
    let is_asked = |met: &Met| {
        request
            .speeds
            .is_none_or(|[from, to]| met.driving_speed.0 >= from.0 && met.driving_speed.0 <= to.0)
    };
    let met = mode
        .crossings(z, MULTIPLES)
        .into_iter()
        .map(|crossing| Met {
            crossing,
            driving_speed: RotationSpeed(crossing.turns * ratio),
        });
    MetMode {
        met: met.filter(is_asked).collect(),
        mode,
    }
}

/// Cost of [`blank_modes`] of `case` beside that of the case.
pub fn blank_modes_estimate(case: &Case) -> Estimate {
    let gears = Member::BOTH.map(|member| case.solid_gear(member).ok());
    let of = |gear: &Option<SolidGear>| gear.as_ref().map_or([0.0; 2], vibration::estimate);
    let mut both = [of(&gears[0]), of(&gears[1])];
    if gears[0] == gears[1] {
        // Equal gears are computed once.
        both[1] = [0.0; 2];
    }
    Estimate {
        // One gear after the other.
        memory: both.iter().map(|[_, bytes]| *bytes).fold(0.0, f64::max) as u64,
        seconds: both.iter().map(|[seconds, _]| seconds).sum(),
        ..Estimate::default()
    }
}

/// Cost of [`mode_shape`] of a gear of `case` until it is written, and the size of the shape.
///
/// # Errors
///
/// [`AnalysisError::Discretization`].
pub fn mode_shape_estimate(
    case: &Case,
    member: Member,
) -> Result<(Estimate, ShapeSize), AnalysisError> {
    let gear = solid(case, member)?;
    let size = vibration::shape_size(&gear).map_err(|error| of_modes(error, member))?;
    let [seconds, bytes] = vibration::estimate(&gear);
    let estimate = Estimate {
        degrees_of_freedom: 3 * size.nodes as u64,
        memory: bytes as u64 + size.bytes() as u64,
        seconds,
        ..Estimate::default()
    };
    Ok((estimate, size))
}
