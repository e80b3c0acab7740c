//! A gear cut at its interface circle: how the circle moves under loads on the flanks, and the annulus inside it by itself.

use std::sync::Arc;

use super::{BlankUnderTeeth, GearSpec, PartError, Parts, Teeth, TeethSpec};
use crate::contact::FlankLoad;
use crate::fem::FemError;
use crate::ring::annulus::{Annulus, Imposed};
use crate::ring::blank::BlankSubstructure;
use crate::ring::motion::InterfaceMotion;
use crate::ring::plain::PlainGear;
use crate::run::Run;

/// A gear cut at its interface circle.
pub struct CutGear {
    pub(super) teeth: Arc<Teeth>,
    /// `None` if it is rigid.
    pub(super) blank: Option<CutBlank>,
}

/// A flexible blank.
pub(super) struct CutBlank {
    blank: Arc<BlankSubstructure>,
    pub(super) hole_angle: f64,
    is_holed: bool,
    plain: Arc<PlainGear>,
}

impl CutGear {
    /// The gear of `spec`.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn new(spec: &GearSpec, parts: &dyn Parts, run: &Run) -> Result<Self, PartError> {
        let teeth = parts.teeth(&spec.teeth, run)?;
        let blank = spec.blank.as_ref().map(|under| {
            let blank = parts.blank(&under.spec, run)?;
            CutBlank::new(under, blank, (&spec.teeth, &teeth), parts, run)
        });
        let blank = blank.transpose()?;
        Ok(Self { teeth, blank })
    }

    /// How its circle moves; `None` if it is held.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub fn motion(&self, run: &Run) -> Result<Option<InterfaceMotion<'_>>, FemError> {
        let motion = self.blank.as_ref().map(|cut| {
            let holed = cut.is_holed.then_some((&*cut.blank, cut.hole_angle));
            InterfaceMotion::new(&self.teeth.ring, &cut.plain, holed, run)
        });
        motion.transpose()
    }

    /// Loads on its flanks, in terms of the loading modes of each tooth.
    pub fn modal_loads(&self, loads: &[FlankLoad]) -> Vec<(usize, Vec<f64>)> {
        let flank = &self.teeth.flank;
        let modal = |load: &FlankLoad| (load.tooth, flank.modal_loads(&load.forces));
        loads.iter().map(modal).collect()
    }

    /// The moment of the loads on its flanks about its axis, counter-clockwise.
    pub fn moment(&self, loads: &[FlankLoad]) -> f64 {
        let moments = loads.iter();
        moments
            .map(|load| self.teeth.flank.moment(&load.forces))
            .sum()
    }

    /// Its blank by itself, on which displacements of the circle are `imposed`; `None` if it is rigid.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`].
    pub fn annulus(&self, imposed: Imposed) -> Result<Option<Annulus>, FemError> {
        let of = |cut: &CutBlank| Annulus::new(&cut.blank, cut.hole_angle, imposed);
        self.blank.as_ref().map(of).transpose()
    }
}

impl CutBlank {
    pub(super) fn new(
        under: &BlankUnderTeeth,
        blank: Arc<BlankSubstructure>,
        (spec, teeth): (&TeethSpec, &Teeth),
        parts: &dyn Parts,
        run: &Run,
    ) -> Result<Self, PartError> {
        let spec = under.plain(spec);
        let solid = parts.blank(&spec.blank, run)?;
        Ok(Self {
            blank,
            hole_angle: under.hole_angle,
            is_holed: under.holed().is_some(),
            plain: parts.plain_gear(&spec, (teeth, &solid), run)?,
        })
    }
}
