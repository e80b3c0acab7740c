//! Whole gears: the teeth of each joined with the blank under them.

use std::sync::Arc;

use super::{BlankSpec, PartError, Teeth, TeethSpec};
use crate::contact::GearModel;
use crate::gear::{Member, SpurGear};
use crate::grid::{BlankGrid, GridLevel, ToothGrid};
use crate::ring::blank::BlankSubstructure;
use crate::ring::body::Coupling;
use crate::ring::motion::InterfaceMotion;
use crate::ring::plain::PlainGear;
use crate::run::Run;

/// Specification of a gear.
#[derive(Debug, Clone, PartialEq)]
pub struct GearSpec {
    /// Its teeth.
    pub teeth: TeethSpec,
    /// The blank under them; `None` for one that does not give way, so that the interface circle is held (paper: wh).
    pub blank: Option<BlankUnderTeeth>,
}

/// A flexible blank under the teeth of a gear.
#[derive(Debug, Clone, PartialEq)]
pub struct BlankUnderTeeth {
    /// The blank by itself.
    pub spec: BlankSpec,
    /// The angle of its hole 0 in radians.
    pub hole_angle: f64,
    /// How far apart, in teeth, loaded teeth are coupled.
    pub farthest: usize,
}

/// A gear ready for contact.
#[derive(Debug, Clone)]
pub struct Gear {
    /// Its flank, and how its loaded teeth move each other.
    pub model: GearModel,
    /// Unknowns before condensation.
    pub degrees_of_freedom: u64,
}

/// A gear that is wanted, and whose it is should it fail.
#[derive(Debug, Clone)]
pub struct WantedGear {
    /// Its place in the pair.
    pub member: Member,
    /// Its specification.
    pub spec: GearSpec,
}

/// The grids of a gear.
#[derive(Debug, Clone)]
pub struct GearGrids {
    /// Grid of one tooth.
    pub tooth: ToothGrid,
    /// Grid of its blank, or of one of its equal sectors; `None` for a rigid one.
    pub blank: Option<BlankGrid>,
}

impl GearSpec {
    /// `gear` on a rigid blank.
    pub fn on_rigid_blank(gear: &SpurGear, interface_radius: f64, level: GridLevel) -> Self {
        Self {
            teeth: TeethSpec::new(gear, interface_radius, level),
            blank: None,
        }
    }

    /// `gear` on its own blank; teeth up to `farthest` apart are coupled.
    pub fn on_own_blank(
        gear: &SpurGear,
        interface_radius: f64,
        level: GridLevel,
        farthest: usize,
    ) -> Self {
        Self {
            teeth: TeethSpec::new(gear, interface_radius, level),
            blank: Some(BlankUnderTeeth {
                spec: BlankSpec::new(gear, interface_radius, level),
                hole_angle: gear.hole_angle(),
                farthest,
            }),
        }
    }

    /// Its grids.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn grids(&self) -> Result<GearGrids, PartError> {
        let blank = self.blank.as_ref().map(|blank| blank.spec.grid());
        Ok(GearGrids {
            tooth: self.teeth.grid()?,
            blank: blank.transpose()?,
        })
    }

    /// The plain gear of which it is made; `None` on a rigid blank.
    pub(super) fn plain(&self) -> Option<PlainGearSpec> {
        self.blank.as_ref().map(|under| under.plain(&self.teeth))
    }

    /// Its blank, if that has holes.
    pub(super) fn holed(&self) -> Option<&BlankSpec> {
        self.blank.as_ref().and_then(BlankUnderTeeth::holed)
    }

    /// Joins `teeth` with its blank: with the `plain` gear, and with a blank that has `holes`.
    pub(super) fn join(
        &self,
        teeth: &Teeth,
        plain: Option<&PlainGear>,
        holed: Option<&BlankSubstructure>,
        run: &Run,
    ) -> Result<Gear, PartError> {
        let (coupling, blank_nodes) = match (&self.blank, plain) {
            (Some(under), Some(plain)) => {
                let holed_at = holed.map(|holed| (holed, under.hole_angle));
                let motion = InterfaceMotion::new(&teeth.ring, plain, holed_at, run)?;
                let coupling = Coupling::new(&motion, under.farthest, run)?;
                let nodes = holed.map_or(plain.blank_nodes, |holed| holed.grid_nodes);
                (Arc::new(coupling), nodes)
            }
            _ => (teeth.on_rigid_blank.clone(), 0),
        };
        Ok(Gear {
            model: GearModel {
                flank: teeth.flank.clone(),
                coupling,
            },
            degrees_of_freedom: teeth.degrees_of_freedom + 2 * blank_nodes as u64,
        })
    }
}

impl BlankUnderTeeth {
    /// The gear without holes whose teeth are `teeth`.
    pub(super) fn plain(&self, teeth: &TeethSpec) -> PlainGearSpec {
        PlainGearSpec {
            teeth: teeth.clone(),
            blank: self.spec.solid(),
        }
    }

    /// The blank, if it has holes.
    pub(super) fn holed(&self) -> Option<&BlankSpec> {
        (self.spec != self.spec.solid()).then_some(&self.spec)
    }
}

/// Specification of a gear without holes.
#[derive(Debug, Clone, PartialEq)]
pub struct PlainGearSpec {
    /// Its teeth.
    pub teeth: TeethSpec,
    /// Its blank.
    pub blank: BlankSpec,
}
