//! The discrete model of a pair: both gears' flanks and how their teeth move each other.

use std::sync::Arc;

use faer::Mat;

use super::case::ContactSolver;
use crate::contact::flank::{FlankPoint, FlankTable};
use crate::contact::half_plane::mean_logarithm;
use crate::contact::patch::{Approach, Patch};
use crate::contact::{
    AugmentedLagrangian, ContactError, ContactProblem, ContactSolution, solve_active_set,
    solve_augmented_lagrangian,
};
use crate::fem::body::Coupling;
use crate::gear::{GearPair, Member};

/// Pairs to either side of the reference pair that may touch.
const PAIRS_AROUND: i64 = 3;

/// Factors by which patches are widened, at most, until the contact fits inside them.
const LARGEST_WIDENING: f64 = 30.0;

/// Updates of the multipliers after which the augmented Lagrangian gives up.
const MULTIPLIER_UPDATES: u32 = 2000;

/// One gear: its flank table and the coupling of its teeth.
#[derive(Debug, Clone)]
pub struct GearModel {
    /// The flank of every tooth.
    pub flank: Arc<FlankTable>,
    /// How loaded teeth move each other.
    pub coupling: Arc<Coupling>,
}

/// A pair ready for contact at any position and load.
#[derive(Debug, Clone)]
pub struct PairModel {
    /// The pair.
    pub pair: GearPair,
    /// Driving and driven gear.
    pub gears: [GearModel; 2],
    /// Cells in one patch.
    pub cells_per_patch: usize,
    /// The solver.
    pub solver: ContactSolver,
}

/// The contact of one tooth pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PairContact {
    /// The pair n.
    pub pair: i64,
    /// The share w·p/F of the load.
    pub share: f64,
    /// The loads Vᵀp of the modes of the driving and the driven tooth.
    pub modal_loads: [Vec<f64>; 2],
    /// The loads Vᵀq that one newton of load adds to them.
    pub modal_derivatives: [Vec<f64>; 2],
    /// The gear whose tip touches off the path of contact, if one does.
    pub tip_corner: Option<Member>,
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
    /// The largest pressure in Pa.
    pub peak_pressure: f64,
    /// |Σ arm·p − F|/F, the arms by cross product about the driven axis.
    pub equilibrium: f64,
    /// The largest |p_j g_j| in N m.
    pub complementarity: f64,
    /// The largest penetration in meters.
    pub penetration: f64,
    /// Linear systems that the contact solver solved.
    pub iterations: u32,
}

/// What one position leaves for the next: where each pair was in contact, and how far the gears approached.
#[derive(Debug, Clone, Default)]
pub struct WarmStart {
    approach: Option<f64>,
    active: Vec<(i64, Vec<bool>)>,
}

/// Why a position has no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PositionError {
    /// No flanks face each other.
    #[error("no flanks come near each other")]
    NoContact,
    /// The contact solver failed.
    #[error(transparent)]
    Contact(#[from] ContactError),
}

impl MeshContact {
    /// About how much memory it holds.
    pub fn bytes(&self) -> usize {
        let loads = |pair: &PairContact| {
            let modes = |loads: &[Vec<f64>; 2]| loads.iter().map(Vec::len).sum::<usize>();
            modes(&pair.modal_loads) + modes(&pair.modal_derivatives)
        };
        let numbers: usize = self.pairs.iter().map(loads).sum();
        size_of::<Self>() + self.pairs.len() * size_of::<PairContact>() + numbers * size_of::<f64>()
    }

    /// The number of pairs that carry load.
    pub fn loaded_pairs(&self) -> u32 {
        self.pairs.iter().filter(|pair| pair.share > 0.0).count() as u32
    }
}

/// The contact of the whole mesh cell by cell: where the cells lie, the problem stated on them and its solution.
///
/// Cells are numbered patch after patch.
#[derive(Debug, Clone)]
pub struct Touch {
    /// The patches of the pairs that come near, by n.
    pub patches: Vec<Patch>,
    /// Compliance, gaps and arms of the cells.
    pub problem: ContactProblem,
    /// Forces, gaps and approach.
    pub solution: ContactSolution,
    /// The cells on the flank tables of both gears.
    points: [Vec<FlankPoint>; 2],
}

impl PairModel {
    /// The contact at mesh position `eta` under `load`, summed up pair by pair.
    ///
    /// # Errors
    ///
    /// [`PositionError`].
    pub fn contact(
        &self,
        eta: f64,
        load: f64,
        warm: &mut WarmStart,
    ) -> Result<MeshContact, PositionError> {
        self.touch(eta, load, warm)
            .map(|touch| self.mesh_contact(&touch, load))
    }

    /// The contact at mesh position `eta` under `load`, cell by cell.
    ///
    /// # Errors
    ///
    /// [`PositionError`].
    pub fn touch(&self, eta: f64, load: f64, warm: &mut WarmStart) -> Result<Touch, PositionError> {
        let reference = eta.floor() as i64;
        let mut approaches: Vec<Approach> = (reference - PAIRS_AROUND
            ..=reference + PAIRS_AROUND + 1)
            .filter_map(|n| Approach::of(&self.pair, eta, n))
            .collect();
        approaches.sort_by(|a, b| a.gap.total_cmp(&b.gap));
        let first_gap = approaches.first().ok_or(PositionError::NoContact)?.gap;
        // Pairs farther apart than the gears approach cannot touch; the guess is checked below.
        let mut reach = warm.approach.map_or(first_gap, |approach| 1.2 * approach);
        let mut widening = 1.0;
        loop {
            let near = approaches
                .iter()
                .filter(|approach| approach.gap <= reach.max(first_gap));
            let mut patches: Vec<Patch> = near
                .map(|approach| {
                    approach.patch(
                        &self.pair,
                        load,
                        self.logarithm_factors(),
                        self.cells_per_patch,
                        widening,
                    )
                })
                .collect();
            patches.retain(|patch| !patch.cells.is_empty());
            patches.sort_by_key(|patch| patch.pair);
            if patches.is_empty() {
                return Err(PositionError::NoContact);
            }
            let touch = self.solve(patches, load, warm)?;
            let (patches, solution) = (&touch.patches, &touch.solution);
            let missed = approaches.iter().any(|approach| {
                approach.gap > reach.max(first_gap) && approach.gap < solution.approach * 1.1
            });
            if missed {
                reach = 1.2 * solution.approach;
                continue;
            }
            if widening < LARGEST_WIDENING && overflows(patches, &solution.active) {
                widening *= 1.5;
                continue;
            }
            *warm = WarmStart::after(patches, solution);
            return Ok(touch);
        }
    }

    fn logarithm_factors(&self) -> f64 {
        self.gears
            .iter()
            .map(|gear| gear.flank.logarithm_factor())
            .sum()
    }

    fn solve(
        &self,
        patches: Vec<Patch>,
        load: f64,
        warm: &WarmStart,
    ) -> Result<Touch, PositionError> {
        let points: [Vec<FlankPoint>; 2] = std::array::from_fn(|gear| {
            let cells = patches.iter().flat_map(|patch| &patch.cells);
            cells
                .map(|cell| {
                    self.gears[gear]
                        .flank
                        .point(cell.roll_lengths[gear], cell.directions[gear])
                })
                .collect()
        });
        let compliance = self.compliance(&patches, &points);
        let cells = || patches.iter().flat_map(|patch| &patch.cells);
        let problem = ContactProblem::new(
            compliance,
            cells().map(|cell| cell.gap).collect(),
            cells().map(|cell| cell.arm).collect(),
        )?;
        let solution = match self.solver {
            ContactSolver::ActiveSet => {
                solve_active_set(&problem, load, warm.touching(&patches).as_deref())?
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
        Ok(Touch {
            patches,
            problem,
            solution,
            points,
        })
    }

    /// H of both gears on the cells of `patches`.
    fn compliance(&self, patches: &[Patch], points: &[Vec<FlankPoint>; 2]) -> Mat<f64> {
        let starts = starts(patches);
        let count = starts[patches.len()];
        let mut h = Mat::zeros(count, count);
        for (member, gear, points) in [
            (Member::Driving, &self.gears[0], &points[0]),
            (Member::Driven, &self.gears[1], &points[1]),
        ] {
            for (a, patch) in patches.iter().enumerate() {
                for (b, other) in patches.iter().enumerate().take(a + 1) {
                    let Some(coupling) = gear.coupling.block(
                        self.tooth(member, patch.pair),
                        tooth_offset(member, other.pair - patch.pair),
                    ) else {
                        continue;
                    };
                    let rows = (starts[a], &points[starts[a]..starts[a + 1]]);
                    let cols = (starts[b], &points[starts[b]..starts[b + 1]]);
                    gear.flank
                        .add_compliance(&mut h, rows, cols, a == b, coupling);
                }
            }
        }
        let factors = self.logarithm_factors();
        for (a, patch) in patches.iter().enumerate() {
            let width = patch.cell_width.ln();
            let logarithms: Vec<f64> = (0..patch.cells.len())
                .map(|d| factors * (mean_logarithm(d) + width))
                .collect();
            for j in starts[a]..starts[a + 1] {
                for i in j..starts[a + 1] {
                    h[(i, j)] -= logarithms[i - j];
                }
            }
        }
        for j in 0..count {
            for i in 0..j {
                h[(i, j)] = h[(j, i)];
            }
        }
        h
    }

    fn mesh_contact(&self, touch: &Touch, load: f64) -> MeshContact {
        let Touch {
            patches,
            solution,
            points,
            ..
        } = touch;
        let starts = starts(patches);
        let width = self.pair.contact_width();
        let mut peak_pressure = 0.0_f64;
        let pairs = patches
            .iter()
            .enumerate()
            .map(|(a, patch)| {
                let range = starts[a]..starts[a + 1];
                let (p, q) = (
                    &solution.forces[range.clone()],
                    &solution.load_derivative[range.clone()],
                );
                let share = patch
                    .cells
                    .iter()
                    .zip(p)
                    .map(|(cell, p)| cell.arm * p)
                    .sum::<f64>()
                    / load;
                peak_pressure = p.iter().fold(peak_pressure, |peak, p| {
                    peak.max(p / (patch.cell_width * width))
                });
                let modal = |forces: &[f64]| {
                    std::array::from_fn(|g| {
                        self.gears[g]
                            .flank
                            .modal_loads(&points[g][range.clone()], forces)
                    })
                };
                PairContact {
                    pair: patch.pair,
                    share,
                    modal_loads: modal(p),
                    modal_derivatives: modal(q),
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

    /// The tooth of `member` in pair n. Seen counter-clockwise in its own frame, the next tooth of the driving gear is
    /// ahead and meshes before, that of the driven gear is behind and meshes after.
    pub fn tooth(&self, member: Member, n: i64) -> usize {
        let z = i64::from(self.pair.gear(member).tooth_count());
        tooth_offset(member, n).rem_euclid(z) as usize
    }
}

/// The teeth counter-clockwise from the tooth of one pair to that of the pair `pairs` later.
pub fn tooth_offset(member: Member, pairs: i64) -> i64 {
    match member {
        Member::Driving => -pairs,
        Member::Driven => pairs,
    }
}

fn starts(patches: &[Patch]) -> Vec<usize> {
    let mut starts = vec![0];
    for patch in patches {
        starts.push(starts[starts.len() - 1] + patch.cells.len());
    }
    starts
}

/// Whether contact reaches an end of a patch that is not an end of the flank.
fn overflows(patches: &[Patch], active: &[bool]) -> bool {
    let starts = starts(patches);
    patches.iter().enumerate().any(|(a, patch)| {
        (active[starts[a]] && !patch.starts_at_form)
            || (active[starts[a + 1] - 1] && !patch.ends_at_tip)
    })
}

impl WarmStart {
    fn after(patches: &[Patch], solution: &ContactSolution) -> Self {
        let starts = starts(patches);
        let active = patches
            .iter()
            .enumerate()
            .map(|(a, patch)| {
                (
                    patch.pair,
                    solution.active[starts[a]..starts[a + 1]].to_vec(),
                )
            })
            .collect();
        Self {
            approach: Some(solution.approach),
            active,
        }
    }

    /// The cells that touched before, in the numbering of `patches`; cells move with the contact, so that they mostly
    /// still do. A pair that was not there before starts open.
    fn touching(&self, patches: &[Patch]) -> Option<Vec<bool>> {
        self.approach?;
        let touching = patches.iter().flat_map(|patch| {
            let before = self
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
}
