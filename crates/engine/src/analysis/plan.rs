//! Computation plan of a method for a case. It is declared here alone: the methods execute it, progress counts it, and [`estimate`](super::estimate()) prices
//! it.

use super::AnalysisError;
use super::between::{MOST_FOR_PEAKS, Refinement, Sample, Sections, most_further};
use super::case::{Case, Method, PositionInCurve, StiffnessRule};
use super::case::{FaceHoles, Model, SectionHoles};
use super::checks::Checks;
use super::hole_phase::PhasePlan;
use crate::assembly::Blanks;
use crate::contact::MeshContact;
use crate::contact::positions::stages;
use crate::gear::{Member, SpurGear};
use crate::grid::GridLevel;
use crate::run::Run;

/// The torque step to either side, over the torque, with which the paper's route differentiates.
const TORQUE_STEP: f64 = 0.01;

/// The positions at which leads are tried that would even the load: as many as a mesh period has at least.
const TRIED: usize = 8;

/// Computation plan of a case.
pub(super) struct Plan {
    /// The request.
    pub(super) case: Case,
    /// The contacts under torque 0.
    pub(super) light: Sweep,
    /// The pass behind the curves, and a second one at another level for their discretization error. There is none without load.
    pub(super) passes: Vec<Pass>,
    /// The best turn of the driving blank, where there is one.
    pub(super) hole_phase: Option<PhasePlan>,
}

/// The level with which one along faces is compared for its error: the next coarser, which differs by more than a finer one would and costs less; the next finer of the
/// coarsest.
fn compared_along_faces(level: GridLevel) -> GridLevel {
    match level {
        GridLevel::Coarse | GridLevel::Fine => GridLevel::Standard,
        GridLevel::Standard => GridLevel::Coarse,
    }
}

/// Computations at one grid level, under each torque.
pub(super) struct Pass {
    pub(super) level: GridLevel,
    /// The contacts behind the curves.
    pub(super) curve: Sweep,
    /// Positions on rigid blanks, which the curves have beside.
    pub(super) rigid: Sweep,
    /// Positions that show the turn of a holed blank: with it flexible, and once more with all holed blanks rigid.
    pub(super) samples: Vec<(Member, Sweep)>,
    /// Exact solutions beside those of round blanks.
    pub(super) checks: Checks,
    /// Positions at which leads are tried that would even the load along the face.
    pub(super) evened: Vec<f64>,
    /// True if gears answer to each contact with their stresses.
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
    /// The mesh periods after which the contacts at these positions repeat.
    repeats_after: u32,
    pub(super) further: Further,
}

/// Positions between those of a sweep that may be solved further, where the curve is least known.
#[derive(Clone, Copy)]
pub(super) struct Further {
    /// How many at most.
    pub(super) most: usize,
    /// How many more at most, where pressures and stresses may be largest.
    pub(super) for_peaks: usize,
    /// The mesh periods after which the contacts at them repeat.
    pub(super) repeats_after: u32,
    /// The parts of a step of which they are whole multiples; `None` where they stand anywhere. What positions whole mesh periods apart share is then made for a
    /// few fractions of the mesh period.
    lattice: Option<u32>,
}

/// The lattices of further positions where teeth deviate, so that pairs made to one drawing have the same fractions of the mesh period: in the plane as fine as an
/// extreme at an event is believed, and on the slices of a drawn pair, which take longest to make.
const LATTICES: [u32; 2] = [8, 4];

impl Further {
    const NONE: Self = Self {
        most: 0,
        for_peaks: 0,
        repeats_after: 1,
        lattice: None,
    };

    /// The sweep of a curve with this number of positions, whose contacts repeat after this number of mesh periods.
    fn of(positions: usize, repeats_after: u32) -> Self {
        Self {
            most: most_further(positions, repeats_after),
            for_peaks: MOST_FOR_PEAKS,
            repeats_after,
            lattice: None,
        }
    }

    fn count(&self) -> usize {
        self.most + self.for_peaks
    }
}

impl Plan {
    pub(super) fn of(case: &Case) -> Self {
        let level = case.resolution.grid;
        let mut levels = Vec::new();
        if case.loaded_torques().next().is_some() {
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
        let pass = |level| Pass::of(case, level);
        Self {
            case: case.clone(),
            light: Sweep::repeating(case, Blanks::HoledRigid, None),
            passes: levels.into_iter().map(pass).collect(),
            hole_phase: PhasePlan::of(case),
        }
    }

    /// The plan for the rows of a table, which are known at their positions alone.
    pub(super) fn of_rows(case: &Case) -> Self {
        let mut plan = Self::of(case);
        plan.light.further = Further::NONE;
        plan.hole_phase = None;
        for pass in &mut plan.passes {
            pass.curve.further = Further::NONE;
        }
        plan
    }

    /// The contact solutions under all torques.
    pub(super) fn solutions(&self) -> u64 {
        let under_each: u64 = self.passes.iter().map(Pass::solutions).sum();
        let phase = self.hole_phase.as_ref().map_or(0, PhasePlan::solutions);
        under_each * self.case.loaded_torques().count() as u64 + phase
    }
}

impl Pass {
    fn of(case: &Case, level: GridLevel) -> Self {
        let answers = level == case.resolution.grid;
        // A pass beside that of the answer is asked for statistics of δ and k.
        let is_solved_as_drawn = case.is_solved_as_drawn();
        // Each of them would have slices of its own.
        let for_peaks = if answers && !is_solved_as_drawn {
            MOST_FOR_PEAKS
        } else {
            0
        };
        let by_rule = match case.resolution.stiffness {
            StiffnessRule::Tangent => None,
            StiffnessRule::TorqueStep { fraction } => Some(fraction),
        };
        let curve = match case.model {
            Model::Section(SectionHoles::Whole) | Model::Faces(_, FaceHoles::Whole) => {
                Sweep::whole(case, by_rule)
            }
            Model::Section(SectionHoles::Fitted) => {
                Sweep::repeating(case, Blanks::HoledRigid, by_rule.or(Some(TORQUE_STEP)))
            }
            Model::Section(SectionHoles::FirstOrder)
            | Model::Faces(_, FaceHoles::FirstOrder)
            | Model::Formulas(_) => Sweep::repeating(case, Blanks::Flexible, by_rule),
        };
        let curve = Sweep {
            further: Further {
                for_peaks,
                lattice: match &case.model {
                    Model::Section(_) if !case.pair.is_as_drawn() => Some(LATTICES[0]),
                    Model::Faces(..) if is_solved_as_drawn => Some(LATTICES[1]),
                    Model::Section(_) | Model::Faces(..) | Model::Formulas(_) => None,
                },
                ..curve.further
            },
            ..curve
        };
        let is_cured = answers && case.faces().is_some_and(|faces| faces.cure);
        Self {
            level,
            rigid: Sweep {
                blanks: Blanks::HoledRigid,
                positions: if case.model == Model::Section(SectionHoles::FirstOrder) {
                    curve.positions.clone()
                } else {
                    Vec::new()
                },
                step: None,
                repeats_after: curve.repeats_after,
                further: Further::NONE,
            },
            samples: if case.model == Model::Section(SectionHoles::Fitted) {
                let of = |member| (member, samples(case, member, curve.step));
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
                spread(&curve.positions, case.resolution.positions_per_mesh_period)
            } else {
                Vec::new()
            },
            stress: answers && case.stress && case.method().computes_stress(),
            curve,
        }
    }

    /// The contact solutions under one torque.
    pub(super) fn solutions(&self) -> u64 {
        self.each(Sweep::solutions) + self.checks.solutions()
    }

    /// Number of positions that are the first at their fraction of the mesh period: the common part of the pair is computed there with them.
    pub(super) fn first_solutions(&self) -> u64 {
        self.each(Sweep::first_solutions) + self.checks.first_solutions()
    }

    /// `count` over all sweeps.
    fn each(&self, count: fn(&Sweep) -> u64) -> u64 {
        let samples: u64 = self.samples.iter().map(|(_, of)| 2 * count(of)).sum();
        count(&self.curve) + count(&self.rigid) + samples
    }

    /// True if holed blanks are also modelled as rigid ones.
    pub(super) fn has_rigid_blanks(&self) -> bool {
        self.curve.blanks == Blanks::HoledRigid || !self.rigid.positions.is_empty()
    }
}

impl Sweep {
    /// Every position of the curves of `case`.
    fn whole(case: &Case, step: Option<f64>) -> Self {
        let positions = case.mesh_positions();
        Self {
            blanks: Blanks::Flexible,
            further: Further::of(positions.len(), case.curves_repeat_after()),
            positions,
            repeats_after: case.span(),
            step,
        }
    }

    /// The positions of `case` after which contact on axisymmetric blanks repeats.
    fn repeating(case: &Case, blanks: Blanks, step: Option<f64>) -> Self {
        let (positions, repeats_after) = (case.repeating_positions(), case.contacts_repeat_after());
        Self {
            blanks,
            further: Further::of(positions.len(), repeats_after),
            positions,
            repeats_after,
            step,
        }
    }

    /// The places in the curve of `case` at which its contacts stand.
    pub(super) fn places(&self, case: &Case) -> Vec<PositionInCurve> {
        case.places(&self.positions, self.repeats_after)
    }

    /// Solutions at each position.
    fn at_each(&self) -> u64 {
        if self.step.is_some() { 3 } else { 1 }
    }

    /// Its positions and the further ones, at most.
    pub(super) fn solved_positions(&self) -> usize {
        self.positions.len() + self.further.count()
    }

    fn solutions(&self) -> u64 {
        self.at_each() * self.solved_positions() as u64
    }

    fn first_solutions(&self) -> u64 {
        self.at_each() * (stages(&self.positions).len() + self.further.count()) as u64
    }

    /// Number of fractions of the mesh period, with those of further positions at most, where these stand on a lattice.
    pub(super) fn lattice_fractions(&self) -> u64 {
        let parts = u64::from(self.further.lattice.unwrap_or(1));
        self.at_each() * parts * stages(&self.positions).len() as u64
    }

    /// The same at `positions` between these.
    pub(super) fn at(&self, positions: &[f64]) -> Self {
        Self {
            blanks: self.blanks,
            positions: positions.to_vec(),
            step: self.step,
            repeats_after: self.further.repeats_after,
            further: Further::NONE,
        }
    }

    /// The curve of `case` through `samples` at these positions, and through those that `solve` finds further.
    pub(super) fn sections(
        &self,
        case: &Case,
        samples: Vec<Sample>,
        run: &Run,
        mut solve: impl FnMut(&Self) -> Result<Vec<Sample>, AnalysisError>,
    ) -> Result<Sections, AnalysisError> {
        let Further {
            repeats_after,
            lattice,
            ..
        } = self.further;
        let refinement = Refinement::of(case, repeats_after, self.positions.len()).on(lattice);
        let mut left = self.further.most;
        let sections = refinement.sections(samples, |positions| {
            left -= positions.len();
            solve(&self.at(positions))
        })?;
        // Positions that were not needed count as done.
        run.reached(self.at_each() * left as u64)?;
        Ok(sections)
    }

    /// Counts positions that were not needed for peaks as done; `solved` of them were needed.
    pub(super) fn peaks_searched(&self, solved: usize, run: &Run) -> Result<(), AnalysisError> {
        let left = self.further.for_peaks.saturating_sub(solved);
        Ok(run.reached(self.at_each() * left as u64)?)
    }

    /// The stiffness under `load`: that of its `contacts`, or by a central difference of δ between those `at` a smaller and a larger one.
    pub(super) fn stiffness(
        &self,
        load: f64,
        contacts: &[MeshContact],
        at: impl Fn(f64) -> Result<Vec<MeshContact>, AnalysisError>,
    ) -> Result<Vec<f64>, AnalysisError> {
        let deltas = |load: f64| {
            let contacts = at(load)?.into_iter();
            Ok(contacts.map(|contact| contact.transmission_error).collect())
        };
        let rise = self.stiffness_by_step(load, deltas)?;
        Ok(rise.unwrap_or_else(|| contacts.iter().map(|contact| contact.stiffness).collect()))
    }

    /// The stiffness under `load` by a central difference of δ `at` a smaller and a larger one; `None` where it is that of contacts.
    pub(super) fn stiffness_by_step(
        &self,
        load: f64,
        at: impl Fn(f64) -> Result<Vec<f64>, AnalysisError>,
    ) -> Result<Option<Vec<f64>>, AnalysisError> {
        let Some(step) = self.step else {
            return Ok(None);
        };
        let (below, above) = (at(load * (1.0 - step))?, at(load * (1.0 + step))?);
        let rises = below.iter().zip(&above).map(|(below, above)| above - below);
        Ok(Some(rises.map(|rise| 2.0 * step * load / rise).collect()))
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
        repeats_after: 1,
        further: Further::NONE,
    }
}

/// A few of `positions`: each at another fraction of the mesh period, and spread over all periods.
fn spread(positions: &[f64], per_period: u32) -> Vec<f64> {
    let per_period = per_period as usize;
    let periods = positions.len() / per_period;
    let place = |i: usize| i * periods / TRIED * per_period + i * per_period / TRIED;
    (0..TRIED).map(|i| positions[place(i)]).collect()
}
