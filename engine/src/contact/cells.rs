//! Contact cells on the pairs that come near, the compliance between them, and what a solution on them says of the mesh.

use std::ops::Range;
use std::sync::Arc;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

use super::facing::RangeEnd;
use super::model::{ContactSolver, PairModel, PositionError, WarmStart};
use super::pair_cells::PairCells;
use super::patch::Patch;
use super::penetration::Found;
use super::{
    AugmentedLagrangian, ContactProblem, ContactSolution, default_penalty, solve_active_set,
    solve_augmented_lagrangian,
};
use crate::gear::{Member, teeth_on};

/// Updates of the multipliers after which the augmented Lagrangian gives up.
const MULTIPLIER_UPDATES: u32 = 2000;

/// The contact cells of all pairs in reach of each other, with the teeth that stand there in one mesh period.
///
/// Cells are numbered pair after pair, pairs from the reference pair of the period.
pub struct ContactCells<'a> {
    model: &'a PairModel,
    period: i64,
    pub(super) pairs: Vec<Arc<PairCells>>,
    /// Where the cells of each pair begin.
    starts: Vec<usize>,
    /// With the deviations of these very teeth.
    gaps: Vec<f64>,
    arms: Vec<f64>,
}

/// The contact of one tooth pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PairContact {
    /// The pair n.
    pub pair: i64,
    /// The share w·p/F of the load.
    pub share: f64,
    /// The gear whose tip touches off the path of contact, if one does.
    pub tip_corner: Option<Member>,
    /// The gear whose fillet the contact reaches, if it does: it is followed on the flanks only.
    pub fillet: Option<Member>,
}

/// The contact of the whole mesh at one position and load.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshContact {
    /// δ in meters.
    pub transmission_error: f64,
    /// dF/dδ in N/m with the active set held.
    pub stiffness: f64,
    /// The pairs that came near, by n.
    pub pairs: Vec<PairContact>,
    /// The largest pressure in Pa; `None` where a sharp tip corner carries, at which it has no limit.
    pub peak_pressure: Option<f64>,
    /// |Σ arm·p − F|/F, the arms by cross product about the driven axis.
    pub equilibrium: f64,
    /// The largest |p_j g_j| in N m.
    pub complementarity: f64,
    /// The largest penetration over the whole flanks of all pairs in reach, in meters.
    pub penetration: f64,
    /// Linear systems that the contact solver solved.
    pub iterations: u32,
}

/// The contact of the whole mesh cell by cell: where the cells lie, the problem stated on them and its solution.
///
/// Cells are numbered patch after patch.
#[derive(Debug, Clone)]
pub struct MeshCells {
    /// The patches of the pairs that come near, by n.
    pub patches: Vec<Patch>,
    /// Compliance, gaps and arms of the cells.
    pub problem: ContactProblem,
    /// Forces, gaps and transmission error.
    pub solution: ContactSolution,
}

/// What a contact loads the interfaces of one tooth pair with.
#[derive(Debug, Clone)]
pub struct PairLoads {
    /// The pair, numbered from the reference pair of the period.
    pub pair: i64,
    /// Vᵀp of the driving and of the driven tooth, one column for each set of forces.
    pub loads: [Mat<f64>; 2],
}

/// What a contact presses one tooth with.
#[derive(Debug, Clone, PartialEq)]
pub struct FlankLoad {
    /// The tooth.
    pub tooth: usize,
    /// The forces in N on the unknowns of its flank ([`crate::ring::tooth::ToothSubstructure`]).
    pub forces: Vec<f64>,
}

impl MeshContact {
    /// About how much memory it holds.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.pairs.len() * size_of::<PairContact>()
    }

    /// The number of pairs that carry load.
    pub fn loaded_pairs(&self) -> u32 {
        self.pairs.iter().filter(|pair| pair.share > 0.0).count() as u32
    }
}

impl<'a> ContactCells<'a> {
    /// Those of `pairs`, in mesh period `period`.
    ///
    /// # Errors
    ///
    /// [`PositionError::TooFarApart`] if the model does not couple all of their teeth.
    pub(super) fn new(
        model: &'a PairModel,
        period: i64,
        mut pairs: Vec<Arc<PairCells>>,
    ) -> Result<Self, PositionError> {
        pairs.sort_by_key(|pair| pair.patch.pair);
        let (Some(first), Some(last)) = (pairs.first(), pairs.last()) else {
            return Err(PositionError::NoContact);
        };
        let apart = last.patch.pair.abs_diff(first.patch.pair) as usize;
        let coupled = model.coupled_teeth();
        if apart > coupled {
            return Err(PositionError::TooFarApart { apart, coupled });
        }
        let mut starts = vec![0];
        let (mut gaps, mut arms) = (Vec::new(), Vec::new());
        for pair in &pairs {
            let patch = &pair.patch;
            starts.push(starts[starts.len() - 1] + patch.cells.len());
            let teeth = model.pair.teeth(period + patch.pair);
            gaps.extend(
                patch
                    .cells
                    .iter()
                    .map(|cell| cell.gap_between(&model.pair, teeth)),
            );
            arms.extend(patch.cells.iter().map(|cell| cell.arm));
        }
        Ok(Self {
            model,
            period,
            pairs,
            starts,
            gaps,
            arms,
        })
    }

    /// The pairs, and the cells of each.
    pub(super) fn ranges(&self) -> impl Iterator<Item = (&PairCells, Range<usize>)> {
        let ranges = self.starts.windows(2).map(|range| range[0]..range[1]);
        self.pairs.iter().map(Arc::as_ref).zip(ranges)
    }

    /// How the interface of `member` in `pair` moves under what loads the interfaces of all pairs.
    pub(super) fn moved(&self, member: Member, pair: i64, loads: &[PairLoads]) -> Mat<f64> {
        let gear = member.index();
        let coupling = &self.model.gears[gear].coupling;
        let mut moved = Mat::zeros(coupling.shape_count(), 1);
        for other in loads {
            let (x, transposed) = coupling.block(
                self.model.pair.tooth(member, self.period + pair),
                teeth_on(member, other.pair - pair),
            );
            let force = &other.loads[gear];
            moved += if transposed {
                x.transpose() * force
            } else {
                x * force
            };
        }
        moved
    }

    /// What the compliance of these cells depends on beside the cells themselves: how the blanks stand under their teeth.
    pub(super) fn teeth_like(&self) -> [usize; 2] {
        Member::BOTH.map(|member| {
            let coupling = &self.model.gears[member.index()].coupling;
            coupling.like(self.model.pair.tooth(member, self.period))
        })
    }

    /// The problem on these cells, stated `before` for cells of the same compliance or anew.
    pub(super) fn problem(
        &self,
        before: Option<&ContactProblem>,
    ) -> Result<ContactProblem, PositionError> {
        let gaps = self.gaps.clone();
        Ok(match before {
            Some(problem) => problem.with_gaps(gaps)?,
            None => ContactProblem::of_lower_triangle(self.compliance(), gaps, self.arms.clone())?,
        })
    }

    /// The solution of their `problem` under `load`.
    pub(super) fn solve(
        &self,
        problem: &ContactProblem,
        load: f64,
        warm: &WarmStart,
    ) -> Result<ContactSolution, PositionError> {
        Ok(match self.model.solver {
            ContactSolver::ActiveSet => {
                solve_active_set(problem, load, self.touching(warm).as_deref())?
            }
            ContactSolver::AugmentedLagrangian {
                penalty,
                gap_tolerance,
            } => {
                let settings = AugmentedLagrangian {
                    penalty: penalty.unwrap_or_else(|| default_penalty(&self.model.pair)),
                    gap_tolerance,
                    max_iterations: MULTIPLIER_UPDATES,
                };
                solve_augmented_lagrangian(problem, load, &settings, &self.model.run)?
            }
        })
    }

    /// H of both gears with these teeth; its lower triangle.
    fn compliance(&self) -> Mat<f64> {
        let model = self.model;
        let count = self.gaps.len();
        let mut h = Mat::zeros(count, count);
        for (pair, range) in self.ranges() {
            let here = range.len();
            h.as_mut()
                .submatrix_mut(range.start, range.start, here, here)
                .copy_from(&pair.held);
        }
        for member in Member::BOTH {
            let gear = member.index();
            for (b, other) in self.pairs.iter().enumerate() {
                let of_other = other.shapes[gear].transpose();
                for (a, pair) in self.pairs.iter().enumerate().skip(b) {
                    let (x, transposed) = model.gears[gear].coupling.block(
                        model.pair.tooth(member, self.period + pair.patch.pair),
                        teeth_on(member, other.patch.pair - pair.patch.pair),
                    );
                    let half = if transposed {
                        x.transpose() * of_other
                    } else {
                        x * of_other
                    };
                    let (rows, columns) = (pair.patch.cells.len(), other.patch.cells.len());
                    matmul(
                        h.as_mut()
                            .submatrix_mut(self.starts[a], self.starts[b], rows, columns),
                        Accum::Add,
                        &pair.shapes[gear],
                        half,
                        1.0,
                        Par::Seq,
                    );
                }
            }
        }
        h
    }

    pub(super) fn mesh_contact(
        &self,
        load: f64,
        solution: &ContactSolution,
        found: &Found,
    ) -> MeshContact {
        let width = self.model.pair.common_face_width();
        let mut peak_pressure = Some(0.0_f64);
        let pairs = self
            .ranges()
            .map(|(PairCells { patch, .. }, range)| {
                let (forces, active) = (&solution.forces[range.clone()], &solution.active[range]);
                let cells = patch.cells.iter().zip(forces);
                let share = cells.map(|(cell, p)| cell.arm * p).sum::<f64>() / load;
                let ended = patch.ended_by(active);
                let at_corner = ended
                    .iter()
                    .any(|end| matches!(end, RangeEnd::Tip | RangeEnd::MateTip));
                let pressures = forces.iter().map(|p| p / (patch.cell_width * width));
                peak_pressure = peak_pressure
                    .filter(|_| !at_corner)
                    .map(|peak| pressures.fold(peak, f64::max));
                PairContact {
                    pair: self.period + patch.pair,
                    share,
                    tip_corner: (patch.off_path && share > 0.0).then_some(patch.seat),
                    fillet: ended
                        .iter()
                        .find_map(|end| match end {
                            RangeEnd::Fillet => Some(patch.seat),
                            RangeEnd::MateFillet => Some(patch.seat.other()),
                            _ => None,
                        })
                        .or_else(|| {
                            let mut fillets = found.fillets.iter();
                            fillets
                                .find(|(pair, _)| *pair == patch.pair)
                                .map(|(_, gear)| *gear)
                        }),
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
            transmission_error: solution.transmission_error,
            stiffness: solution.stiffness,
            pairs,
            peak_pressure,
            equilibrium: solution.load_residual,
            complementarity,
            penetration: found.largest,
            iterations: solution.iterations,
        }
    }

    /// The contact cell by cell.
    pub(super) fn mesh_cells(
        &self,
        problem: ContactProblem,
        solution: ContactSolution,
    ) -> MeshCells {
        let patches = self.pairs.iter().map(|pair| Patch {
            pair: pair.patch.pair + self.period,
            ..pair.patch.clone()
        });
        MeshCells {
            patches: patches.collect(),
            problem,
            solution,
        }
    }

    /// What the `forces` on all cells load the interfaces of each pair with, one column each.
    pub fn loads(&self, forces: &[&[f64]]) -> Vec<PairLoads> {
        self.ranges()
            .map(|(pair, range)| {
                let forces =
                    Mat::from_fn(range.len(), forces.len(), |i, j| forces[j][range.start + i]);
                PairLoads {
                    pair: pair.patch.pair,
                    loads: std::array::from_fn(|gear| pair.shapes[gear].transpose() * &forces),
                }
            })
            .collect()
    }

    /// What the `forces` on all cells are on the flanks of `member`, tooth by tooth of those that carry any.
    pub fn flank_loads(&self, member: Member, forces: &[f64]) -> Vec<FlankLoad> {
        let (gear, pair) = (member.index(), &self.model.pair);
        let flank = &self.model.gears[gear].flank;
        self.ranges()
            .map(|(cells, range)| (cells, &forces[range]))
            .filter(|(_, forces)| forces.iter().any(|force| *force > 0.0))
            .map(|(cells, forces)| FlankLoad {
                tooth: pair.tooth(member, self.period + cells.patch.pair),
                forces: cells.nodal_forces(flank, gear, forces),
            })
            .collect()
    }

    /// The cells that touched before; cells move with the contact, so that they mostly still do. A pair that was not there before starts
    /// open.
    fn touching(&self, warm: &WarmStart) -> Option<Vec<bool>> {
        warm.transmission_error?;
        let touching = self.pairs.iter().flat_map(|pair| {
            let patch = &pair.patch;
            let before = warm
                .active
                .iter()
                .find(|(pair, active)| *pair == patch.pair && active.len() == patch.cells.len());
            before.map_or_else(
                || vec![false; patch.cells.len()],
                |(_, active)| active.clone(),
            )
        });
        Some(touching.collect())
    }

    pub(super) fn warm_start(&self, solution: &ContactSolution) -> WarmStart {
        let active = self
            .ranges()
            .map(|(pair, range)| (pair.patch.pair, solution.active[range].to_vec()));
        WarmStart {
            transmission_error: Some(solution.transmission_error),
            active: active.collect(),
        }
    }
}
