//! Contact cells on the pairs that come near, the compliance between them, and what a solution on them says of the mesh.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

use super::facing::{Facing, RangeEnd};
use super::flank_table::FlankPoint;
use super::model::{ContactSolver, PairModel, PositionError, WarmStart, teeth_on};
use super::patch::Patch;
use super::penetration::Found;
use super::{
    AugmentedLagrangian, ContactProblem, ContactSolution, solve_active_set,
    solve_augmented_lagrangian,
};
use crate::gear::Member;

/// Updates of the multipliers after which the augmented Lagrangian gives up.
const MULTIPLIER_UPDATES: u32 = 2000;

/// Contact cells at one fraction of the mesh period, and all of their contact that does not depend on the period.
///
/// Cells are numbered patch after patch, pairs from the reference pair of the period.
pub struct ContactCells {
    pub(super) patches: Vec<Patch>,
    /// Pairs on which cells were to be laid.
    pair_count: usize,
    /// Where the cells of each patch begin.
    pub(super) starts: Vec<usize>,
    /// W V of each gear and patch: how the flank follows its interface there.
    pub(super) shapes: [Vec<Mat<f64>>; 2],
    /// The compliance of the teeth with their interfaces held; its lower triangle.
    held: Mat<f64>,
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

impl ContactCells {
    /// Lays cells on the flanks of `facings`, in patches `widening` times as wide as `load` needs.
    ///
    /// # Errors
    ///
    /// [`PositionError::TooFarApart`] if the model does not couple all of their teeth.
    pub(super) fn new(
        model: &PairModel,
        facings: &[Facing<'_>],
        load: f64,
        widening: f64,
    ) -> Result<Self, PositionError> {
        let mut patches: Vec<Patch> = facings
            .iter()
            .map(|facing| Patch::new(facing, load, model.cells_per_patch, widening))
            .filter(|patch| !patch.cells.is_empty())
            .collect();
        patches.sort_by_key(|patch| patch.pair);
        let (Some(first), Some(last)) = (patches.first(), patches.last()) else {
            return Err(PositionError::NoContact);
        };
        let apart = last.pair.abs_diff(first.pair) as usize;
        let coupled = model.coupled_teeth();
        if apart > coupled {
            return Err(PositionError::TooFarApart { apart, coupled });
        }
        let mut starts = vec![0];
        for patch in &patches {
            starts.push(starts[starts.len() - 1] + patch.cells.len());
        }
        let count = starts[patches.len()];
        let mut held = Mat::zeros(count, count);
        let mut shapes = [Vec::new(), Vec::new()];
        for (patch, &start) in patches.iter().zip(&starts) {
            let here = patch.cells.len();
            let mut block = held.as_mut().submatrix_mut(start, start, here, here);
            for (gear, shapes) in shapes.iter_mut().enumerate() {
                let flank = &model.gears[gear].flank;
                let points: Vec<FlankPoint> = patch
                    .cells
                    .iter()
                    .map(|cell| flank.point(cell.roll_lengths[gear], cell.directions[gear]))
                    .collect();
                block += flank.smooth_compliance(&points, &points);
                shapes.push(flank.shapes_at(&points));
            }
            let near: Vec<f64> = (0..here)
                .map(|distance| {
                    let fields = patch.near_fields.iter();
                    fields
                        .map(|field| {
                            field.between(distance as f64 * patch.cell_width, patch.cell_width)
                        })
                        .sum()
                })
                .collect();
            for j in 0..here {
                for i in j..here {
                    block[(i, j)] += near[i - j];
                }
            }
        }
        let cells = || patches.iter().flat_map(|patch| &patch.cells);
        Ok(Self {
            pair_count: facings.len(),
            held,
            shapes,
            gaps: cells().map(|cell| cell.gap).collect(),
            arms: cells().map(|cell| cell.arm).collect(),
            patches,
            starts,
        })
    }

    /// The number of pairs with cells.
    pub(super) fn pair_count(&self) -> usize {
        self.pair_count
    }

    /// The patches, and the cells of each.
    pub(super) fn ranges(&self) -> impl Iterator<Item = (&Patch, std::ops::Range<usize>)> {
        let ranges = self.starts.windows(2).map(|range| range[0]..range[1]);
        self.patches.iter().zip(ranges)
    }

    /// The contact under `load` of the teeth that mesh in `period`.
    pub(super) fn solve(
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
                solve_active_set(&problem, load, self.touching(warm).as_deref())?
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
                let of_other = self.shapes[gear][b].transpose();
                for (a, patch) in self.patches.iter().enumerate().skip(b) {
                    let (x, transposed) = model.gears[gear].coupling.block(
                        model.tooth(member, period + patch.pair),
                        teeth_on(member, other.pair - patch.pair),
                    );
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
                        &self.shapes[gear][a],
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
        model: &PairModel,
        period: i64,
        load: f64,
        solution: &ContactSolution,
        found: &Found,
    ) -> MeshContact {
        let width = model.pair.common_face_width();
        let mut peak_pressure = Some(0.0_f64);
        let pairs = self
            .ranges()
            .map(|(patch, range)| {
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
                    pair: period + patch.pair,
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

    /// The contact of `period` cell by cell.
    pub(super) fn into_mesh_cells(
        self,
        period: i64,
        problem: ContactProblem,
        solution: ContactSolution,
    ) -> MeshCells {
        let mut patches = self.patches;
        for patch in &mut patches {
            patch.pair += period;
        }
        MeshCells {
            patches,
            problem,
            solution,
        }
    }

    /// What the `forces` on all cells load the interfaces of each pair with, one column each.
    pub fn loads(&self, forces: &[&[f64]]) -> Vec<PairLoads> {
        self.ranges()
            .enumerate()
            .map(|(a, (patch, range))| {
                let forces =
                    Mat::from_fn(range.len(), forces.len(), |i, j| forces[j][range.start + i]);
                PairLoads {
                    pair: patch.pair,
                    loads: std::array::from_fn(|gear| self.shapes[gear][a].transpose() * &forces),
                }
            })
            .collect()
    }

    /// Whether wider patches would have more room.
    pub(super) fn can_widen(&self) -> bool {
        self.patches.iter().any(|patch| patch.ends.contains(&None))
    }

    /// Whether contact reaches an end of a patch beyond which the flanks still face each other.
    pub(super) fn overflows(&self, active: &[bool]) -> bool {
        self.ranges().any(|(patch, range)| {
            (active[range.start] && patch.ends[0].is_none())
                || (active[range.end - 1] && patch.ends[1].is_none())
        })
    }

    /// The cells that touched before; cells move with the contact, so that they mostly still do. A pair that was not there before starts
    /// open.
    fn touching(&self, warm: &WarmStart) -> Option<Vec<bool>> {
        warm.transmission_error?;
        let touching = self.patches.iter().flat_map(|patch| {
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
            .map(|(patch, range)| (patch.pair, solution.active[range].to_vec()));
        WarmStart {
            transmission_error: Some(solution.transmission_error),
            active: active.collect(),
        }
    }
}
