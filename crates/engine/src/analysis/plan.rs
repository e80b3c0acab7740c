//! What a method will compute of a case. It is declared here alone: the methods execute it, progress is counted by it, and
//! [`estimate`](super::estimate()) prices it.

use super::AnalysisError;
use super::between::{Refinement, Sample, Sections, most_further};
use super::case::{Case, Method, StiffnessRule};
use super::case::{FaceHoles, Model, SectionHoles};
use super::first_order::Checks;
use crate::assembly::Blanks;
use crate::contact::positions::stages;
use crate::gear::{Member, SpurGear};
use crate::grid::GridLevel;
use crate::run::Run;

/// The torque step to either side, over the torque, with which the paper's route differentiates.
const TORQUE_STEP: f64 = 0.01;

/// The positions at which leads are tried that would even the load: as many as a mesh period has at least.
const TRIED: usize = 8;

/// What is computed of a case.
pub(super) struct Plan {
    /// What is asked.
    pub(super) asked: Case,
    /// The same without its torques of zero, in whose curves nothing is elastic.
    pub(super) loaded: Case,
    /// Whether curves are looked at between their positions.
    pub(super) is_refined: bool,
    /// The pass that answers, and a second one that tells the discretization error of it. There is none without load.
    pub(super) passes: Vec<Pass>,
}

/// The level that tells the error of one along faces: the next coarser, which differs by more than a finer one would and costs less; the next finer of the
/// coarsest.
fn compared_along_faces(level: GridLevel) -> GridLevel {
    match level {
        GridLevel::Coarse | GridLevel::Fine => GridLevel::Standard,
        GridLevel::Standard => GridLevel::Coarse,
    }
}

/// What is computed at one grid level, under each torque.
pub(super) struct Pass {
    pub(super) level: GridLevel,
    /// The contacts of which the curves tell.
    pub(super) told: Sweep,
    /// Those on rigid blanks that are told beside them.
    pub(super) rigid: Sweep,
    /// Those that show how a holed blank turns: with it flexible, and once more with all holed blanks rigid.
    pub(super) samples: Vec<(Member, Sweep)>,
    /// Exact solutions beside those of round blanks.
    pub(super) checks: Checks,
    /// Positions at which leads are tried that would even the load along the face.
    pub(super) evened: Vec<f64>,
    /// Whether gears answer to each contact with their stresses.
    pub(super) stress: bool,
}

/// Contacts at some positions, and the stiffness there.
pub(super) struct Sweep {
    /// The blanks that take part.
    pub(super) blanks: Blanks,
    /// The mesh positions.
    pub(super) positions: Vec<f64>,
    /// The step of the torque to either side, over the torque, by which the stiffness is found; `None` where it is that of the contacts.
    pub(super) step: Option<f64>,
    /// Positions between these that may be solved further, where they tell most of the curve.
    pub(super) further: usize,
}

impl Plan {
    pub(super) fn of(case: &Case) -> Self {
        let mut loaded = case.clone();
        loaded.output_torques.retain(|torque| *torque != 0.0);
        let level = case.resolution.grid;
        let mut levels = Vec::new();
        if !loaded.output_torques.is_empty() {
            levels.push(level);
            // Formulas have no grid to refine.
            if case.resolution.error_estimate && case.method() != Method::LoadDistribution {
                levels.push(if case.method().sees_faces() {
                    compared_along_faces(level)
                } else {
                    level.neighbor()
                });
            }
        }
        let pass = |level| Pass::of(&loaded, level);
        Self {
            asked: case.clone(),
            is_refined: true,
            passes: levels.into_iter().map(pass).collect(),
            loaded,
        }
    }

    /// The plan for the rows of a table, which are told at their positions alone.
    pub(super) fn of_rows(case: &Case) -> Self {
        let mut plan = Self {
            is_refined: false,
            ..Self::of(case)
        };
        for pass in &mut plan.passes {
            pass.told.further = 0;
        }
        plan
    }

    /// The contact solutions under all torques.
    pub(super) fn solutions(&self) -> u64 {
        let under_each: u64 = self.passes.iter().map(Pass::solutions).sum();
        under_each * self.loaded.output_torques.len() as u64
    }
}

impl Pass {
    fn of(case: &Case, level: GridLevel) -> Self {
        let answers = level == case.resolution.grid;
        let by_rule = match case.resolution.stiffness {
            StiffnessRule::Tangent => None,
            StiffnessRule::TorqueStep { fraction } => Some(fraction),
        };
        let (blanks, positions, step) = match case.model {
            Model::Section(SectionHoles::Whole) | Model::Faces(_, FaceHoles::Whole) => {
                (Blanks::Flexible, case.mesh_positions(), by_rule)
            }
            Model::Section(SectionHoles::Fitted) => (
                Blanks::HoledRigid,
                case.repeating_positions(),
                by_rule.or(Some(TORQUE_STEP)),
            ),
            Model::Section(SectionHoles::FirstOrder)
            | Model::Faces(_, FaceHoles::FirstOrder)
            | Model::Formulas(_) => (Blanks::Flexible, case.repeating_positions(), by_rule),
        };
        let told = Sweep {
            blanks,
            further: most_further(positions.len()),
            positions,
            step,
        };
        let is_cured = answers && case.faces().is_some_and(|faces| faces.cure);
        Self {
            level,
            rigid: Sweep {
                blanks: Blanks::HoledRigid,
                positions: if case.model == Model::Section(SectionHoles::FirstOrder) {
                    told.positions.clone()
                } else {
                    Vec::new()
                },
                step: None,
                further: 0,
            },
            samples: if case.model == Model::Section(SectionHoles::Fitted) {
                let of = |member| (member, samples(case, member, told.step));
                case.holed().into_iter().map(of).collect()
            } else {
                Vec::new()
            },
            checks: if case.method().is_projected() {
                Checks::of(case)
            } else {
                Checks::NONE
            },
            evened: if is_cured {
                spread(&told.positions, case.resolution.positions_per_mesh_period)
            } else {
                Vec::new()
            },
            stress: answers && case.stress && case.method().tells_stress(),
            told,
        }
    }

    /// The contact solutions under one torque.
    pub(super) fn solutions(&self) -> u64 {
        self.each(Sweep::solutions) + self.checks.solutions()
    }

    /// Those of them that are the first at their fraction of the mesh period: what the pair has in common there is found with them.
    pub(super) fn first_solutions(&self) -> u64 {
        self.each(Sweep::first_solutions) + self.checks.first_solutions()
    }

    /// `count` over all sweeps.
    fn each(&self, count: fn(&Sweep) -> u64) -> u64 {
        let samples: u64 = self.samples.iter().map(|(_, of)| 2 * count(of)).sum();
        count(&self.told) + count(&self.rigid) + samples
    }

    /// Whether holed blanks also stand as rigid ones.
    pub(super) fn has_rigid_blanks(&self) -> bool {
        self.told.blanks == Blanks::HoledRigid || !self.rigid.positions.is_empty()
    }
}

impl Sweep {
    /// Solutions at each position.
    fn at_each(&self) -> u64 {
        if self.step.is_some() { 3 } else { 1 }
    }

    fn solutions(&self) -> u64 {
        self.at_each() * (self.positions.len() + self.further) as u64
    }

    fn first_solutions(&self) -> u64 {
        self.at_each() * (stages(&self.positions).len() + self.further) as u64
    }

    /// The same at other `positions`.
    pub(super) fn at(&self, positions: &[f64]) -> Self {
        Self {
            blanks: self.blanks,
            positions: positions.to_vec(),
            step: self.step,
            further: 0,
        }
    }

    /// The curve of `case` through `samples` at these positions, and through those that `solve` finds further, which repeat `after` so many mesh
    /// periods.
    pub(super) fn sections(
        &self,
        (case, after): (&Case, u32),
        samples: Vec<Sample>,
        run: &Run,
        mut solve: impl FnMut(&Self) -> Result<Vec<Sample>, AnalysisError>,
    ) -> Result<Sections, AnalysisError> {
        if self.further == 0 {
            return Ok(Sections::of(case, &samples));
        }
        let refinement = Refinement::of(case, after, self.positions.len());
        let mut left = self.further;
        let sections = refinement.sections(samples, |positions| {
            left -= positions.len();
            solve(&self.at(positions))
        })?;
        // What was not needed is done.
        run.reached(self.at_each() * left as u64)?;
        Ok(sections)
    }

    /// The stiffness under `load`: that of its contacts, or by a central difference of what δ is `at` a smaller and a larger one.
    pub(super) fn stiffness(
        &self,
        load: f64,
        of_contacts: impl FnOnce() -> Vec<f64>,
        at: impl Fn(f64) -> Result<Vec<f64>, AnalysisError>,
    ) -> Result<Vec<f64>, AnalysisError> {
        let Some(step) = self.step else {
            return Ok(of_contacts());
        };
        let (below, above) = (at(load * (1.0 - step))?, at(load * (1.0 + step))?);
        let rises = below.iter().zip(&above).map(|(below, above)| above - below);
        Ok(rises.map(|rise| 2.0 * step * load / rise).collect())
    }
}

/// Holes that no turn of the blank takes to each other: 1 for a pattern.
pub(super) fn unlike_holes(gear: &SpurGear) -> u32 {
    gear.holes().len() as u32 / gear.hole_repeats().max(1)
}

/// Where the turn of a holed blank is sampled: over one hole period. Unlike holes make more than one harmonic, and need as many more samples.
fn samples(case: &Case, member: Member, step: Option<f64>) -> Sweep {
    let gear = case.pair.gear(member);
    let count = case.resolution.blank_positions * unlike_holes(gear).max(1);
    let period = f64::from(gear.tooth_count()) / f64::from(gear.hole_repeats().max(1));
    Sweep {
        blanks: Blanks::OnlyHoledOf(member),
        positions: (0..count)
            .map(|j| f64::from(j) * period / f64::from(count))
            .collect(),
        step,
        further: 0,
    }
}

/// A few of `positions`: each at another fraction of the mesh period, and spread over all periods.
fn spread(positions: &[f64], per_period: u32) -> Vec<f64> {
    let per_period = per_period as usize;
    let periods = positions.len() / per_period;
    let place = |i: usize| i * periods / TRIED * per_period + i * per_period / TRIED;
    (0..TRIED).map(|i| positions[place(i)]).collect()
}
