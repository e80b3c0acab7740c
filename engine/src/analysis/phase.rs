//! The mesh at one fraction of its period: all that positions whole mesh periods apart have in common.
//!
//! Gears without their blanks repeat with every mesh period: the same flanks face each other across the same gaps. What
//! differs is which teeth they belong to, and so how the blanks under them yield. Gaps, cells and the compliance of the
//! teeth themselves are therefore found once for a fraction of the mesh period, and each period adds W V X Vᵀ Wᵀ.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

use super::case::ContactSolver;
use super::model::{
    MeshContact, PairContact, PairModel, PositionError, Touch, WarmStart, tooth_offset,
};
use crate::contact::flank::FlankPoint;
use crate::contact::half_plane::mean_logarithm;
use crate::contact::patch::{Approach, Patch};
use crate::contact::{
    AugmentedLagrangian, ContactProblem, ContactSolution, solve_active_set,
    solve_augmented_lagrangian,
};
use crate::gear::Member;

/// Pairs to either side of the reference pair that may touch.
const PAIRS_AROUND: i64 = 3;

/// Factors by which patches are widened, at most, until the contact fits inside them.
const LARGEST_WIDENING: f64 = 30.0;

/// Updates of the multipliers after which the augmented Lagrangian gives up.
const MULTIPLIER_UPDATES: u32 = 2000;

/// The mesh at one fraction of its period, under one load.
pub struct Phase<'a> {
    model: &'a PairModel,
    load: f64,
    /// The pairs that face each other, by their gap; numbered from the reference pair of the period.
    approaches: Vec<Approach>,
    /// What has been laid on them so far: one entry for most phases.
    laid: Vec<Laid>,
}

/// Contact cells on the pairs that come near, and all of their contact that does not depend on the period.
pub struct Laid {
    /// How many of the approaches.
    near: usize,
    /// By how much the patches are wider than the Hertz contact asks for.
    widening: f64,
    /// By pair, numbered from the reference pair of the period.
    patches: Vec<Patch>,
    /// Where the cells of each patch begin; cells are numbered patch after patch.
    starts: Vec<usize>,
    /// W V of each gear and patch.
    modes: [Vec<Mat<f64>>; 2],
    /// The compliance of the teeth with their interfaces held, logarithm included; its lower triangle.
    held: Mat<f64>,
    gaps: Vec<f64>,
    arms: Vec<f64>,
}

/// What a contact loads the modes of one tooth pair with.
#[derive(Debug, Clone)]
pub struct PairLoads {
    /// The pair, numbered from the reference pair of the period.
    pub pair: i64,
    /// Of the driving and of the driven tooth: Vᵀp, and Vᵀq that one newton of load adds to it; one column each.
    pub loads: [Mat<f64>; 2],
}

impl<'a> Phase<'a> {
    /// The mesh of `model` at `fraction` of its period under `load`.
    ///
    /// # Errors
    ///
    /// [`PositionError::NoContact`] if no flanks face each other.
    pub fn new(model: &'a PairModel, fraction: f64, load: f64) -> Result<Self, PositionError> {
        let mut approaches: Vec<Approach> = (-PAIRS_AROUND..=PAIRS_AROUND + 1)
            .filter_map(|n| Approach::of(&model.pair, fraction, n))
            .collect();
        if approaches.is_empty() {
            return Err(PositionError::NoContact);
        }
        approaches.sort_by(|a, b| a.gap.total_cmp(&b.gap));
        Ok(Self {
            model,
            load,
            approaches,
            laid: Vec::new(),
        })
    }

    /// The contact in mesh period `period`, summed up pair by pair, and what `keep` takes of it beside.
    ///
    /// # Errors
    ///
    /// [`PositionError`].
    pub fn contact<T>(
        &mut self,
        period: i64,
        warm: &mut WarmStart,
        keep: impl FnOnce(&Laid, &ContactSolution) -> T,
    ) -> Result<(MeshContact, T), PositionError> {
        let (index, _, solution) = self.solve(period, warm)?;
        let laid = &self.laid[index];
        let contact = laid.mesh_contact(self.model, period, self.load, &solution);
        Ok((contact, keep(laid, &solution)))
    }

    /// The contact in mesh period `period`, cell by cell.
    ///
    /// # Errors
    ///
    /// [`PositionError`].
    pub fn touch(mut self, period: i64, warm: &mut WarmStart) -> Result<Touch, PositionError> {
        let (index, problem, solution) = self.solve(period, warm)?;
        let mut patches = self.laid.swap_remove(index).patches;
        for patch in &mut patches {
            patch.pair += period;
        }
        Ok(Touch {
            patches,
            problem,
            solution,
        })
    }

    /// The solution in one period and the cells on which it was found.
    fn solve(
        &mut self,
        period: i64,
        warm: &mut WarmStart,
    ) -> Result<(usize, ContactProblem, ContactSolution), PositionError> {
        let first_gap = self.approaches[0].gap;
        // Pairs farther apart than the gears approach cannot touch; the guess is checked below.
        let mut reach = warm.approach().map_or(first_gap, |approach| 1.2 * approach);
        let mut widening = 1.0;
        loop {
            let near = self.near(reach.max(first_gap));
            let index = self.lay(near, widening)?;
            let laid = &self.laid[index];
            let (problem, solution) = laid.solve(self.model, period, self.load, warm)?;
            if laid.near < self.near(1.1 * solution.approach) {
                reach = 1.2 * solution.approach;
            } else if widening < LARGEST_WIDENING && laid.overflows(&solution.active) {
                widening *= 1.5;
            } else {
                *warm = laid.warm_start(&solution);
                return Ok((index, problem, solution));
            }
        }
    }

    /// The number of approaches within `reach`.
    fn near(&self, reach: f64) -> usize {
        self.approaches
            .partition_point(|approach| approach.gap <= reach)
    }

    /// Where cells on at least `near` pairs, widened by `widening`, are laid.
    fn lay(&mut self, near: usize, widening: f64) -> Result<usize, PositionError> {
        let enough = |laid: &Laid| laid.near >= near && laid.widening == widening;
        if let Some(index) = self.laid.iter().position(enough) {
            return Ok(index);
        }
        let approaches = &self.approaches[..near];
        self.laid
            .push(Laid::new(self.model, approaches, self.load, widening)?);
        Ok(self.laid.len() - 1)
    }
}

impl Laid {
    fn new(
        model: &PairModel,
        approaches: &[Approach],
        load: f64,
        widening: f64,
    ) -> Result<Self, PositionError> {
        let factors: f64 = model
            .gears
            .iter()
            .map(|gear| gear.flank.logarithm_factor())
            .sum();
        let mut patches: Vec<Patch> = approaches
            .iter()
            .map(|approach| {
                approach.patch(&model.pair, load, factors, model.cells_per_patch, widening)
            })
            .filter(|patch| !patch.cells.is_empty())
            .collect();
        patches.sort_by_key(|patch| patch.pair);
        if patches.is_empty() {
            return Err(PositionError::NoContact);
        }
        let mut starts = vec![0];
        for patch in &patches {
            starts.push(starts[starts.len() - 1] + patch.cells.len());
        }
        let count = starts[patches.len()];
        let mut held = Mat::zeros(count, count);
        let mut modes = [Vec::new(), Vec::new()];
        for (patch, &start) in patches.iter().zip(&starts) {
            let here = patch.cells.len();
            let mut block = held.as_mut().submatrix_mut(start, start, here, here);
            for (gear, modes) in modes.iter_mut().enumerate() {
                let flank = &model.gears[gear].flank;
                let points: Vec<FlankPoint> = patch
                    .cells
                    .iter()
                    .map(|cell| flank.point(cell.roll_lengths[gear], cell.directions[gear]))
                    .collect();
                block += flank.smooth_compliance(&points);
                modes.push(flank.modes_at(&points));
            }
            let width = patch.cell_width.ln();
            let logarithms: Vec<f64> = (0..here)
                .map(|d| factors * (mean_logarithm(d) + width))
                .collect();
            for j in 0..here {
                for i in j..here {
                    block[(i, j)] -= logarithms[i - j];
                }
            }
        }
        let cells = || patches.iter().flat_map(|patch| &patch.cells);
        Ok(Self {
            near: approaches.len(),
            widening,
            held,
            modes,
            gaps: cells().map(|cell| cell.gap).collect(),
            arms: cells().map(|cell| cell.arm).collect(),
            patches,
            starts,
        })
    }

    fn solve(
        &self,
        model: &PairModel,
        period: i64,
        load: f64,
        warm: &WarmStart,
    ) -> Result<(ContactProblem, ContactSolution), PositionError> {
        let problem = ContactProblem::of_lower_triangle(
            self.compliance(model, period),
            self.gaps.clone(),
            self.arms.clone(),
        )?;
        let solution = match model.solver {
            ContactSolver::ActiveSet => {
                solve_active_set(&problem, load, warm.touching(&self.patches).as_deref())?
            }
            ContactSolver::AugmentedLagrangian {
                penalty,
                gap_tolerance,
            } => {
                let settings = AugmentedLagrangian {
                    penalty,
                    gap_tolerance,
                    max_iterations: MULTIPLIER_UPDATES,
                };
                solve_augmented_lagrangian(&problem, load, &settings)?
            }
        };
        Ok((problem, solution))
    }

    /// H of both gears with the teeth that mesh in `period`; its lower triangle.
    fn compliance(&self, model: &PairModel, period: i64) -> Mat<f64> {
        let mut h = self.held.clone();
        for member in Member::BOTH {
            let gear = member.index();
            for (b, other) in self.patches.iter().enumerate() {
                let of_other = self.modes[gear][b].transpose();
                for (a, patch) in self.patches.iter().enumerate().skip(b) {
                    let Some((x, transposed)) = model.gears[gear].coupling.block(
                        model.tooth(member, period + patch.pair),
                        tooth_offset(member, other.pair - patch.pair),
                    ) else {
                        continue;
                    };
                    let half = if transposed {
                        x.transpose() * of_other
                    } else {
                        x * of_other
                    };
                    let (rows, columns) = (patch.cells.len(), other.cells.len());
                    matmul(
                        h.as_mut()
                            .submatrix_mut(self.starts[a], self.starts[b], rows, columns),
                        Accum::Add,
                        &self.modes[gear][a],
                        half,
                        1.0,
                        Par::Seq,
                    );
                }
            }
        }
        h
    }

    fn mesh_contact(
        &self,
        model: &PairModel,
        period: i64,
        load: f64,
        solution: &ContactSolution,
    ) -> MeshContact {
        let width = model.pair.contact_width();
        let mut peak_pressure = 0.0_f64;
        let pairs = self
            .patches
            .iter()
            .zip(self.starts.windows(2))
            .map(|(patch, range)| {
                let forces = &solution.forces[range[0]..range[1]];
                let cells = patch.cells.iter().zip(forces);
                let share = cells.map(|(cell, p)| cell.arm * p).sum::<f64>() / load;
                peak_pressure = forces.iter().fold(peak_pressure, |peak, p| {
                    peak.max(p / (patch.cell_width * width))
                });
                PairContact {
                    pair: period + patch.pair,
                    share,
                    tip_corner: (patch.off_path && share > 0.0).then_some(patch.carrier),
                }
            })
            .collect();
        let complementarity = solution
            .forces
            .iter()
            .zip(&solution.gaps)
            .map(|(p, g)| (p * g).abs())
            .fold(0.0, f64::max);
        MeshContact {
            transmission_error: solution.approach,
            stiffness: solution.stiffness,
            pairs,
            peak_pressure,
            equilibrium: solution.load_residual,
            complementarity,
            penetration: solution.penetration,
            iterations: solution.iterations,
        }
    }

    /// What `solution` loads the modes of each pair with.
    pub fn modal_loads(&self, solution: &ContactSolution) -> Vec<PairLoads> {
        let (p, q) = (&solution.forces, &solution.load_derivative);
        let pairs = self.patches.iter().zip(self.starts.windows(2)).enumerate();
        pairs
            .map(|(a, (patch, range))| {
                let here = &[&p[range[0]..range[1]], &q[range[0]..range[1]]];
                let forces = Mat::from_fn(patch.cells.len(), 2, |i, j| here[j][i]);
                PairLoads {
                    pair: patch.pair,
                    loads: std::array::from_fn(|gear| self.modes[gear][a].transpose() * &forces),
                }
            })
            .collect()
    }

    /// Whether contact reaches an end of a patch that is not an end of the flank.
    fn overflows(&self, active: &[bool]) -> bool {
        let mut patches = self.patches.iter().zip(self.starts.windows(2));
        patches.any(|(patch, range)| {
            (active[range[0]] && !patch.starts_at_form)
                || (active[range[1] - 1] && !patch.ends_at_tip)
        })
    }

    fn warm_start(&self, solution: &ContactSolution) -> WarmStart {
        let patches = self.patches.iter().zip(self.starts.windows(2));
        let active = patches.map(|(patch, range)| {
            let active = &solution.active[range[0]..range[1]];
            (patch.pair, active.to_vec())
        });
        WarmStart::new(solution.approach, active.collect())
    }
}
