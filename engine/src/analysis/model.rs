//! The discrete model of a pair: both gears' flanks and how their teeth move each other.

use std::sync::Arc;

use super::case::ContactSolver;
use super::phase::Phase;
use crate::contact::flank::FlankTable;
use crate::contact::patch::Patch;
use crate::contact::{ContactError, ContactProblem, ContactSolution};
use crate::fem::body::Coupling;
use crate::gear::{GearPair, Member};

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
///
/// Pairs are numbered from the reference pair of the position's own mesh period.
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
        size_of::<Self>() + self.pairs.len() * size_of::<PairContact>()
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
        let period = eta.floor();
        let mut phase = Phase::new(self, eta - period, load)?;
        let (contact, ()) = phase.contact(period as i64, warm, |_, _| ())?;
        Ok(contact)
    }

    /// The contact at mesh position `eta` under `load`, cell by cell.
    ///
    /// # Errors
    ///
    /// [`PositionError`].
    pub fn touch(&self, eta: f64, load: f64, warm: &mut WarmStart) -> Result<Touch, PositionError> {
        let period = eta.floor();
        Phase::new(self, eta - period, load)?.touch(period as i64, warm)
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

impl WarmStart {
    /// After a solution with this approach, in which these cells of these pairs touched.
    pub(super) fn new(approach: f64, active: Vec<(i64, Vec<bool>)>) -> Self {
        Self {
            approach: Some(approach),
            active,
        }
    }

    /// How far the gears approached; `None` at a cold start.
    pub(super) fn approach(&self) -> Option<f64> {
        self.approach
    }

    /// The cells that touched before, in the numbering of `patches`; cells move with the contact, so that they mostly
    /// still do. A pair that was not there before starts open.
    pub(super) fn touching(&self, patches: &[Patch]) -> Option<Vec<bool>> {
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
