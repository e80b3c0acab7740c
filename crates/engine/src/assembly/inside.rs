//! The inside of a gear whose flanks are loaded: functionals of its displacements, such as the stress along an edge.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::cut::{CutBlank, CutGear};
use super::{GearGrids, GearSpec, PartError, Parts, Probes};
use crate::contact::FlankLoad;
use crate::fem::FemError;
use crate::ring::blank::BlankRecovery;
use crate::ring::motion::InterfaceMotion;
use crate::ring::teeth_recovery::TeethRecovery;
use crate::ring::tooth::ToothSubstructure;
use crate::run::Run;

/// A gear with functionals of its inside.
pub struct Inside {
    cut: CutGear,
    in_tooth: TeethRecovery,
    /// `None` if the blank is rigid.
    in_blank: Option<BlankRecovery>,
}

/// A gear that can be loaded.
pub struct LoadedGear<'a> {
    inside: &'a Inside,
    /// How its interface circle moves; `None` if it is held.
    motion: Option<InterfaceMotion<'a>>,
}

/// Response of a gear to one set of loads.
pub struct Answer<'a> {
    inside: &'a Inside,
    loads: &'a [FlankLoad],
    modal_loads: Vec<(usize, Vec<f64>)>,
    /// The amplitudes of the interface circle.
    motion: Vec<f64>,
}

impl Inside {
    /// The inside of the gear of `spec` on its `grids`, asked for `probes`.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn new(
        spec: &GearSpec,
        grids: &GearGrids,
        probes: &Probes,
        parts: &dyn Parts,
        run: &Run,
    ) -> Result<Self, PartError> {
        let gear = spec.teeth.gear();
        let teeth = parts.teeth(&spec.teeth, run)?;
        let (tooth, rows) = ToothSubstructure::with_recovery(gear, &grids.tooth, &probes.in_tooth)?;
        run.check()?;
        let in_tooth = TeethRecovery::new(&tooth, &rows, teeth.ring.harmonics, run)?;
        let blank = spec.blank.as_ref().zip(grids.blank.as_ref());
        let made = blank.map(|(under, grid)| {
            let (blank, recovery) = under.spec.make_with(grid, &probes.in_blank, run)?;
            let cut = CutBlank::new(under, Arc::new(blank), (&spec.teeth, &teeth), parts, run)?;
            Ok::<_, PartError>((cut, recovery))
        });
        let (blank, in_blank) = made.transpose()?.unzip();
        Ok(Self {
            cut: CutGear { teeth, blank },
            in_tooth,
            in_blank,
        })
    }

    /// The same, ready to be loaded.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub fn loaded(&self, run: &Run) -> Result<LoadedGear<'_>, FemError> {
        Ok(LoadedGear {
            inside: self,
            motion: self.cut.motion(run)?,
        })
    }

    /// The angles from the centerline of tooth 0 to the frames of the equal sectors of its blank; none of a rigid one.
    pub fn sector_angles(&self) -> Vec<f64> {
        let both = self.cut.blank.as_ref().zip(self.in_blank.as_ref());
        both.map_or_else(Vec::new, |(blank, recovery)| {
            let count = recovery.sector_count;
            let turn = |sector: usize| TAU * sector as f64 / count as f64;
            (0..count)
                .map(|sector| blank.hole_angle + turn(sector))
                .collect()
        })
    }
}

impl<'a> LoadedGear<'a> {
    /// Under `loads` on its flanks.
    pub fn under(&self, loads: &'a [FlankLoad]) -> Answer<'a> {
        let cut = &self.inside.cut;
        let modal_loads = cut.modal_loads(loads);
        let motion = self.motion.as_ref().map_or_else(
            || vec![0.0; cut.teeth.ring.harmonics.unknowns()],
            |motion| motion.under(&modal_loads),
        );
        Answer {
            inside: self.inside,
            loads,
            modal_loads,
            motion,
        }
    }
}

impl Answer<'_> {
    /// Values of the functionals of a tooth, in tooth `tooth`.
    pub fn in_tooth(&self, tooth: usize) -> Vec<f64> {
        let own = self.loads.iter().find(|load| load.tooth == tooth);
        let own = own.map_or(&[][..], |load| &load.forces);
        let recovery = &self.inside.in_tooth;
        recovery.values(tooth, own, &self.modal_loads, &self.motion)
    }

    /// How the interface circle moves, radially and tangentially, at `angles` from the centerline of tooth 0.
    pub fn on_circle(&self, angles: &[f64]) -> Vec<[f64; 2]> {
        let harmonics = self.inside.cut.teeth.ring.harmonics;
        let at = |angle: &f64| {
            let shapes = harmonics.on_circle(&[*angle]);
            [0, 1].map(|c| {
                let terms = self.motion.iter().enumerate();
                terms.map(|(j, q)| shapes[(c, j)] * q).sum()
            })
        };
        angles.iter().map(at).collect()
    }

    /// How the circle of the bore moves, radially and tangentially, at `angles` from the frame of sector 0 of the blank: a bore stands still.
    pub fn on_bore(&self, angles: &[f64]) -> Vec<[f64; 2]> {
        let Inside { cut, in_blank, .. } = self.inside;
        let both = cut.blank.as_ref().zip(in_blank.as_ref());
        both.map_or_else(
            || vec![[0.0; 2]; angles.len()],
            |(blank, recovery)| recovery.on_bore(blank.hole_angle, &self.motion, angles),
        )
    }

    /// Values of the functionals of the blank, in sector `sector`; none of a rigid one.
    pub fn in_blank(&self, sector: usize) -> Vec<f64> {
        let Inside { cut, in_blank, .. } = self.inside;
        let both = cut.blank.as_ref().zip(in_blank.as_ref());
        both.map_or_else(Vec::new, |(blank, recovery)| {
            recovery.values(sector, blank.hole_angle, &self.motion)
        })
    }
}
