//! Contact cells on the pairs that come near, the compliance between them, and the summary of a solution on them.

use std::ops::Range;
use std::sync::Arc;

use faer::Mat;

use super::checked::Penetration;
use super::compliances::CachedCompliance;
use super::coupled::{LoadedPair, add_coupled, mirror};
use super::drawn::DrawnPair;
use super::facings::PairGap;
use super::factor::{add, dot};
use super::mesh_contact::{FlankLoad, MeshCells, MeshContact, PairContact, PairLoads, Spot};
use super::model::{
    ContactSolver, DeviatingPair, MeshPosition, PositionError, WarmPair, WarmStart,
};
use super::pair_cells::PairCells;
use super::patch::Extent;
use super::peak::Peak;
use super::problem::first_of;
use super::{
    AugmentedLagrangian, ContactProblem, ContactSolution, default_penalty, solve_active_set,
    solve_augmented_lagrangian,
};
use crate::gear::{GearPair, Member, teeth_on};
use crate::touch::placement::Pose;
use crate::wide::{Loops, wide};

/// The least part of its way that a pair yields by itself, and not together with the others.
const OWN: f64 = 0.1;

/// Updates of the multipliers after which the augmented Lagrangian gives up.
const MULTIPLIER_UPDATES: u32 = 2000;

/// At most 3 refinements, and only of patches with at most 128 cells: measured profiles start with narrow cells.
const MOST_HALVED: u32 = 3;
const MOST_TO_HALVE: usize = 128;

/// Change of the cells of a pair before they are solved again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refinement {
    /// More cells; or the same, moved so far ([`Extent::moved`]) that a contact narrower than they reach lies among them.
    Widen { moved: i32 },
    /// Half the width.
    Halve,
}

/// The contact cells of all pairs in reach of each other, with the teeth that stand there in one mesh period.
///
/// Cells are numbered pair after pair, pairs from the reference pair of the period.
pub struct ContactCells<'a> {
    deviating: DeviatingPair<'a>,
    pub(super) at: MeshPosition,
    pub(super) placed: Vec<PlacedCells>,
    /// Where the cells of each pair begin.
    starts: Vec<usize>,
}

/// The cells of one pair with the deviations of the teeth that stand there.
#[derive(Debug, Clone)]
pub(super) struct PlacedCells {
    /// Number of the pair, counted from the reference pair of the mesh period.
    pub(super) pair: i64,
    pub(super) drawn: DrawnPair,
    pub(super) extent: Extent,
    cells: Arc<Option<PairCells>>,
    /// The gaps g_0, as they would be were the driven gear to lag by nothing.
    pub(super) gaps: Vec<f64>,
    /// The arms of each cell about both axes.
    pub(super) arms: Vec<[f64; 2]>,
    /// The δ at which gaps were taken.
    pub(super) lag: f64,
}

impl PlacedCells {
    /// `cells` on the pair `near` in this `pose`, with a driven gear that lags by `lag`; `None` where there are none.
    pub(super) fn new(
        near: &PairGap,
        extent: Extent,
        cells: Arc<Option<PairCells>>,
        pose: &Pose<'_>,
        lag: f64,
    ) -> Option<Self> {
        let patch = &Option::as_ref(&cells)?.patch;
        let met = pose.gaps_and_arms(&patch.flank_points);
        let each = met.iter().zip(&patch.more);
        let gaps = each
            .map(|(met, more)| met.gap + more + lag * met.arms[1])
            .collect();
        let arms = met.iter().map(|met| met.arms).collect();
        Some(Self {
            pair: near.pair,
            drawn: near.drawn.clone(),
            extent,
            cells,
            gaps,
            arms,
            lag,
        })
    }

    /// The first of its cells to touch, and the δ at which it does.
    fn first(&self) -> (usize, f64) {
        let cells = self.gaps.iter().zip(&self.arms);
        first_of(cells.map(|(gap, arms)| gap / arms[1]))
    }

    /// How deep beyond the `touch` of the cell `first` the contact under `forces` ends on either side: the square of a pressure falls to zero
    /// there about evenly with the depth.
    fn closed(&self, first: usize, touch: f64, forces: &[f64]) -> [f64; 2] {
        let cells = &self.cells().patch.cells;
        let depth = |cell: usize| self.gaps[cell] / self.arms[cell][1] - touch;
        let square = |cell: usize| (forces[cell] / cells[cell].width).powi(2);
        let end = |last: Option<usize>, inward: isize| {
            let Some(last) = last else { return 0.0 };
            let beside = |by: isize| {
                last.checked_add_signed(by)
                    .filter(|&cell| cell < forces.len())
            };
            let outside = beside(-inward).map_or(f64::INFINITY, depth);
            let before = beside(inward).filter(|&cell| square(cell) > square(last));
            let more = before.map_or(0.0, |before| {
                (depth(last) - depth(before)) * square(last) / (square(before) - square(last))
            });
            (depth(last) + more.max(0.0)).min(outside)
        };
        let presses = |cell: &usize| forces[*cell] > 0.0;
        [
            end((0..=first).find(presses), 1),
            end((first..forces.len()).rev().find(presses), -1),
        ]
    }

    /// Its cells.
    pub(super) fn cells(&self) -> &PairCells {
        // There is none without.
        Option::as_ref(&self.cells).expect("cells that were placed")
    }
}

impl<'a> ContactCells<'a> {
    /// Cells of `placed`, at a mesh position of `deviating`.
    ///
    /// # Errors
    ///
    /// [`PositionError::TooFarApart`] if the model does not couple all of their teeth.
    pub(super) fn new(
        deviating: DeviatingPair<'a>,
        at: MeshPosition,
        mut placed: Vec<PlacedCells>,
    ) -> Result<Self, PositionError> {
        placed.sort_by_key(|placed| placed.pair);
        let (Some(first), Some(last)) = (placed.first(), placed.last()) else {
            return Err(PositionError::NoContact);
        };
        let apart = last.pair.abs_diff(first.pair) as usize;
        let coupled = deviating.model.coupled_teeth();
        if apart > coupled {
            return Err(PositionError::TooFarApart { apart, coupled });
        }
        let mut starts = vec![0];
        for placed in &placed {
            starts.push(starts[starts.len() - 1] + placed.gaps.len());
        }
        Ok(Self {
            deviating,
            at,
            placed,
            starts,
        })
    }

    /// The pairs, and the cells of each.
    pub(super) fn ranges(&self) -> impl Iterator<Item = (&PlacedCells, Range<usize>)> {
        let ranges = self.starts.windows(2).map(|range| range[0]..range[1]);
        self.placed.iter().zip(ranges)
    }

    /// How the interfaces of each pair move under the `forces` on all cells: that of the driving gear, and behind it that of the driven one.
    pub(super) fn interfaces_moved(&self, forces: &[f64]) -> Vec<Vec<f64>> {
        wide(InterfacesMoved {
            cells: self,
            forces,
        })
    }

    /// Key of the compliance of these cells beside the cells themselves: the places of the blanks under their teeth.
    pub(super) fn teeth_like(&self) -> [usize; 2] {
        Member::BOTH.map(|member| {
            let coupling = &self.deviating.model.gears[member.index()].coupling;
            coupling.like(self.deviating.model.pair.tooth(member, self.at.period))
        })
    }

    /// The problem on these cells, whose compliance is `known`.
    pub(super) fn problem(
        &self,
        known: &CachedCompliance,
    ) -> Result<ContactProblem, PositionError> {
        let each = self.placed.iter();
        let gaps = each
            .clone()
            .flat_map(|placed| placed.gaps.iter().copied())
            .collect();
        let arms = each
            .flat_map(|placed| placed.arms.iter().map(|arms| arms[1]))
            .collect();
        Ok(ContactProblem::of_known(known, gaps, arms)?)
    }

    /// The solution of their `problem` under `load`.
    pub(super) fn solve(
        &self,
        problem: &ContactProblem,
        load: f64,
        warm: &WarmStart,
    ) -> Result<ContactSolution, PositionError> {
        self.solved_from(problem, load, || self.touching(warm, load))
    }

    /// The solution by the model's solver of any `problem` under `load`; the active set starts from the cells that `touching` gives.
    pub(super) fn solved_from(
        &self,
        problem: &ContactProblem,
        load: f64,
        touching: impl FnOnce() -> Option<Vec<bool>>,
    ) -> Result<ContactSolution, PositionError> {
        Ok(match self.deviating.model.solver {
            ContactSolver::ActiveSet => solve_active_set(problem, load, touching().as_deref())?,
            ContactSolver::AugmentedLagrangian {
                penalty,
                gap_tolerance,
            } => {
                let settings = AugmentedLagrangian {
                    penalty: penalty.unwrap_or_else(|| default_penalty(&self.deviating.model.pair)),
                    gap_tolerance,
                    max_iterations: MULTIPLIER_UPDATES,
                };
                solve_augmented_lagrangian(problem, load, &settings, &self.deviating.model.run)?
            }
        })
    }

    /// H of both gears with these teeth.
    pub(super) fn compliance(&self) -> Mat<f64> {
        let model = self.deviating.model;
        let count = self.starts[self.placed.len()];
        let mut h = Mat::zeros(count, count);
        for (placed, range) in self.ranges() {
            let here = range.len();
            h.as_mut()
                .submatrix_mut(range.start, range.start, here, here)
                .copy_from(&placed.cells().held);
        }
        for member in Member::BOTH {
            let pairs = self.ranges().map(|(placed, range)| LoadedPair {
                pair: placed.pair,
                start: range.start,
                shapes: placed.cells().shapes[member.index()].as_ref(),
            });
            let pairs: Vec<LoadedPair<'_>> = pairs.collect();
            add_coupled(&mut h, &pairs, |a, b| {
                model.coupling(member, self.at.period, [a, b])
            });
        }
        mirror(&mut h);
        h
    }

    /// The pair.
    pub(super) fn pair(&self) -> &GearPair {
        &self.deviating.model.pair
    }

    /// Summary of the mesh from the `solution` of their `problem` under `load`, and its penetration.
    ///
    /// # Errors
    ///
    /// [`PositionError::Contact`] if the contact of a pair by itself has no solution.
    pub(super) fn mesh_contact(
        &self,
        load: f64,
        (problem, solution): (&ContactProblem, &ContactSolution),
        penetration: &Penetration,
    ) -> Result<MeshContact, PositionError> {
        let (mut peak, mut at_corner, mut smooth_pressure) = (None, false, 0.0_f64);
        let pairs = self.ranges().map(|(placed, range)| {
            let (pair, patch) = (self.at.period + placed.pair, &placed.cells().patch);
            let forces = &solution.forces[range.clone()];
            let active = &solution.active[range.clone()];
            let carried = placed.arms.iter().zip(forces);
            let share = carried.map(|(arms, p)| arms[1] * p).sum::<f64>() / load;
            if patch.corner_carries(active, [true; 2]) {
                at_corner = true;
            } else if share > 0.0 {
                let pressed = self.pressed(placed, &range, (problem, solution))?;
                let largest = pressed.peak;
                peak = Some(peak.map_or(largest, |peak: Peak| peak.larger(largest)));
                smooth_pressure = smooth_pressure.max(pressed.smooth);
            }
            let clearance = placed.arms.iter().zip(&solution.gaps[range]);
            let clearance = clearance.map(|(arms, gap)| gap / arms[1]);
            let pressed = || {
                penetration
                    .fillets
                    .iter()
                    .find(|(pair, _)| *pair == placed.pair)
            };
            Ok(PairContact {
                clearance: (share <= 0.0).then(|| clearance.fold(f64::INFINITY, f64::min)),
                tip_corner: (patch.off_path && share > 0.0).then_some(patch.primary),
                fillet: patch
                    .reached_fillet(active)
                    .or_else(|| pressed().map(|(_, gear)| *gear)),
                ..PairContact::of_share(pair, share)
            })
        });
        let pairs = pairs.collect::<Result<_, PositionError>>()?;
        let arms = self.placed.iter().flat_map(|placed| &placed.arms);
        let spots = arms.zip(solution.forces.iter().zip(&solution.gaps));
        let spots = spots.map(|(arms, (&force, &gap))| Spot {
            force,
            gap,
            moments: arms.map(|arm| arm * force),
        });
        Ok(MeshContact {
            transmission_error: solution.transmission_error,
            stiffness: solution.stiffness,
            pairs,
            smooth_pressure,
            penetration: penetration.largest,
            iterations: solution.iterations,
            ..MeshContact::of_spots(load, spots, peak.filter(|_| !at_corner))
        })
    }

    /// The contact cell by cell.
    pub(super) fn mesh_cells(
        &self,
        problem: ContactProblem,
        solution: ContactSolution,
    ) -> MeshCells {
        let patches = self.placed.iter();
        MeshCells {
            patches: patches
                .map(|placed| (self.at.period + placed.pair, placed.cells().patch.clone()))
                .collect(),
            problem,
            solution,
        }
    }

    /// Loads of the `forces` on all cells on the interfaces of each pair, one column each.
    pub fn loads(&self, forces: &[&[f64]]) -> Vec<PairLoads> {
        self.ranges()
            .map(|(placed, range)| {
                let forces =
                    Mat::from_fn(range.len(), forces.len(), |i, j| forces[j][range.start + i]);
                let shapes = &placed.cells().shapes;
                PairLoads {
                    pair: placed.pair,
                    loads: std::array::from_fn(|gear| shapes[gear].transpose() * &forces),
                }
            })
            .collect()
    }

    /// The `forces` on all cells as loads on the flanks of `member`, for each loaded tooth.
    pub fn flank_loads(&self, member: Member, forces: &[f64]) -> Vec<FlankLoad> {
        let (gear, pair) = (member.index(), &self.deviating.model.pair);
        let flank = &self.deviating.model.gears[gear].flank;
        self.ranges()
            .map(|(placed, range)| (placed, &forces[range]))
            .filter(|(_, forces)| forces.iter().any(|force| *force > 0.0))
            .map(|(placed, forces)| {
                let cells = placed.cells().patch.cells.iter().zip(forces);
                let pressed = cells.filter(|(_, force)| **force > 0.0);
                FlankLoad {
                    tooth: pair.tooth(member, self.at.period + placed.pair),
                    roll_lengths: pressed.map(|(cell, _)| cell.roll_lengths[gear]).collect(),
                    forces: placed.cells().nodal_forces(flank, gear, forces),
                }
            })
            .collect()
    }

    /// The cells that are likely to touch, judged by a contact of about the same pairs.
    ///
    /// All pairs move by the displacement of the load beside it. From there each is taken for a spring of its earlier stiffness, and under the load that it
    /// carries so, it touches wherever its gap is no deeper than such a force closed before.
    fn touching(&self, warm: &WarmStart, load: f64) -> Option<Vec<bool>> {
        let known: Vec<&WarmPair> = self
            .placed
            .iter()
            .filter_map(|placed| warm.pairs.iter().find(|pair| pair.pair == placed.pair))
            .collect();
        if known.is_empty() {
            return None;
        }
        let mean = |of: fn(&WarmPair) -> f64| {
            known.iter().map(|pair| of(pair)).sum::<f64>() / known.len() as f64
        };
        let usual = (
            mean(|pair| pair.stiffness),
            [mean(|pair| pair.closed[0]), mean(|pair| pair.closed[1])],
        );
        let spring = |placed: &PlacedCells| {
            let known = warm.pairs.iter().find(|pair| pair.pair == placed.pair);
            let known = known.map(|pair| (pair.stiffness, pair.closed));
            (placed.first(), known.unwrap_or(usual))
        };
        let springs: Vec<_> = self.placed.iter().map(spring).collect();
        let mut rising: Vec<(f64, f64)> = springs
            .iter()
            .map(|&((_, touch), (spring, _))| (touch, spring))
            .collect();
        rising.sort_by(|a, b| a.0.total_cmp(&b.0));
        // δ, less the common motion, at which the springs that it reaches carry the load.
        let (mut stiffness, mut moment, mut delta) = (0.0, 0.0, f64::INFINITY);
        for (touch, spring) in rising {
            if touch >= delta {
                break;
            }
            stiffness += spring;
            moment += spring * touch;
            delta = (load + moment) / stiffness;
        }
        let touching = self
            .placed
            .iter()
            .zip(&springs)
            .flat_map(|(placed, spring)| {
                let &((first, touch), (stiffness, closed)) = spring;
                let force = stiffness * (delta - touch);
                let cells = placed.gaps.iter().zip(&placed.arms).enumerate();
                cells.map(move |(cell, (gap, arms))| {
                    gap / arms[1] - touch <= force * closed[usize::from(cell > first)]
                })
            });
        Some(touching.collect())
    }

    /// Refinements of the cells of pairs. Cells are widened if the contact reaches beyond them or flanks penetrate beside them, and there is room for more. If no
    /// pair is, cells between which flanks penetrate deeper than `deep` are halved.
    pub(super) fn refinements(
        &self,
        solution: &ContactSolution,
        penetration: &Penetration,
        deep: f64,
    ) -> Vec<(i64, Refinement)> {
        let room = self.ranges().filter_map(|(placed, range)| {
            let patch = &placed.cells().patch;
            let active = &solution.active[range];
            let beside = penetration.beside.contains(&placed.pair);
            let is_widened = patch.can_widen() && (beside || patch.overflows(active));
            let moved = patch.off_middle(active);
            is_widened.then_some((placed.pair, Refinement::Widen { moved }))
        });
        let room: Vec<(i64, Refinement)> = room.collect();
        if !room.is_empty() {
            return room;
        }
        let deepest = |placed: &PlacedCells| {
            penetration
                .between
                .get(&placed.pair)
                .copied()
                .unwrap_or(0.0)
        };
        let halves = self.placed.iter().filter(|placed| {
            placed.extent.halved < MOST_HALVED
                && placed.cells().patch.cells.len() <= MOST_TO_HALVE
                && deepest(placed) > deep
        });
        halves
            .map(|placed| (placed.pair, Refinement::Halve))
            .collect()
    }

    /// Displacement in the middle of the next pair by a force in the middle of one, in the mean.
    fn between(&self, problem: &ContactProblem) -> Option<f64> {
        let middles = self
            .ranges()
            .map(|(_, range)| usize::midpoint(range.start, range.end));
        let middles: Vec<usize> = middles.collect();
        let pairs = middles.windows(2);
        let count = pairs.len();
        let yields = pairs.map(|pair| problem.compliance()[(pair[0], pair[1])]);
        (count > 0).then(|| yields.sum::<f64>() / count as f64)
    }

    /// The start of contacts near this one under `load`; the `last` started this.
    pub(super) fn warm_start(
        &self,
        problem: &ContactProblem,
        solution: &ContactSolution,
        load: f64,
        last: &WarmStart,
    ) -> WarmStart {
        let delta = solution.transmission_error;
        let between = self.between(problem).unwrap_or(last.between);
        // Common motion of all pairs, whichever of them carries.
        let shared = between * load;
        let pairs = self.ranges().filter_map(|(placed, range)| {
            let forces = &solution.forces[range];
            let carried = placed.arms.iter().zip(forces);
            let force: f64 = carried.map(|(arms, force)| arms[1] * force).sum();
            let (first, touch) = placed.first();
            (force > 0.0).then(|| WarmPair {
                pair: placed.pair,
                stiffness: force / (delta - touch - shared).max(OWN * (delta - touch)),
                closed: placed
                    .closed(first, touch, forces)
                    .map(|depth| depth / force),
            })
        });
        WarmStart {
            transmission_error: Some(delta),
            between,
            pairs: pairs.collect(),
        }
    }
}

/// The loops of [`ContactCells::interfaces_moved`].
struct InterfacesMoved<'a> {
    cells: &'a ContactCells<'a>,
    forces: &'a [f64],
}

impl Loops for InterfacesMoved<'_> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let cells = self.cells;
        let mut loads = Vec::with_capacity(cells.placed.len());
        for (placed, range) in cells.ranges() {
            loads.push(placed.cells().loads(&self.forces[range]));
        }
        let mut all_moved = Vec::with_capacity(cells.placed.len());
        for placed in &cells.placed {
            let mut moved = Vec::new();
            for member in Member::BOTH {
                cells.move_interface(&mut moved, member, placed.pair, &loads);
            }
            all_moved.push(moved);
        }
        all_moved
    }
}

impl ContactCells<'_> {
    /// Puts behind `moved` how the interface of `member` in `pair` moves under the `loads` of all pairs.
    #[inline(always)]
    fn move_interface(
        &self,
        moved: &mut Vec<f64>,
        member: Member,
        pair: i64,
        loads: &[[Vec<f64>; 2]],
    ) {
        let model = self.deviating.model;
        let coupling = &model.gears[member.index()].coupling;
        let start = moved.len();
        moved.resize(start + coupling.shape_count(), 0.0);
        let moved = &mut moved[start..];
        for (other, load) in self.placed.iter().zip(loads) {
            let (x, transposed) = coupling.block(
                model.pair.tooth(member, self.at.period + pair),
                teeth_on(member, other.pair - pair),
            );
            let load = &load[member.index()];
            for (j, force) in load.iter().enumerate() {
                let column = x.col_as_slice(j);
                if transposed {
                    moved[j] += dot(column, load);
                } else {
                    add(moved, column, *force);
                }
            }
        }
    }
}
