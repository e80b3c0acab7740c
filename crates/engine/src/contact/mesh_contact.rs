//! The summary of a solved contact: of the mesh, of each pair, and cell by cell.

use faer::Mat;

use super::patch::Patch;
use super::peak::{Peak, PeakPlace};
use super::problem::{ContactProblem, ContactSolution};
use crate::gear::Member;

/// The contact of one tooth pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PairContact {
    /// The pair n.
    pub pair: i64,
    /// The share w·p/F of the load.
    pub share: f64,
    /// How much more the driven gear would have to lag for the pair to touch, in meters along the line of action; `None` where it carries or
    /// this is not known.
    pub clearance: Option<f64>,
    /// The gear whose tip touches off the path of contact, if one does.
    pub tip_corner: Option<Member>,
    /// The gear whose fillet the contact reaches, if it does: it is followed on the flanks only.
    pub fillet: Option<Member>,
}

/// The contact of the whole mesh at one position and load.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshContact {
    /// δ in meters.
    pub transmission_error: f64,
    /// The δ at which the first flanks touch, that under no load, in meters.
    pub touch: f64,
    /// dF/dδ in N/m with the active set held.
    pub stiffness: f64,
    /// Load of the driver: the torque on the driving gear over r_b1. It is F where all contact is on unmodified flanks on the line of action; elsewhere arms
    /// differ.
    pub driving_load: f64,
    /// The pairs that came near, by n.
    pub pairs: Vec<PairContact>,
    /// The largest pressure in Pa; `None` where a sharp corner carries, at which it has no limit.
    pub peak_pressure: Option<f64>,
    /// Where that is; `None` without one, and without load.
    pub peak_place: Option<PeakPlace>,
    /// The largest pressure in Pa of pairs of which no sharp corner carries, at least half the width of the contact away from kinks of the flanks; 0 where there
    /// is none.
    pub smooth_pressure: f64,
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
    /// The pairs n that come near, and their patches.
    pub patches: Vec<(i64, Patch)>,
    /// Compliance, gaps and arms of the cells.
    pub problem: ContactProblem,
    /// Forces, gaps and transmission error.
    pub solution: ContactSolution,
}

/// Loads of a contact on the interfaces of one tooth pair.
#[derive(Debug, Clone)]
pub struct PairLoads {
    /// The pair, numbered from the reference pair of the period.
    pub pair: i64,
    /// Vᵀp of the driving and of the driven tooth, one column for each set of forces.
    pub loads: [Mat<f64>; 2],
}

/// Loads of a contact on one tooth.
#[derive(Debug, Clone, PartialEq)]
pub struct FlankLoad {
    /// The tooth.
    pub tooth: usize,
    /// The roll lengths in m at which its flank is pressed.
    pub roll_lengths: Vec<f64>,
    /// The forces in N on the unknowns of its flank ([`crate::ring::tooth::ToothSubstructure`]).
    pub forces: Vec<f64>,
}

/// A loaded place: a cell in the plane, a slice along faces.
pub(super) struct Spot {
    /// The force p in N, and the gap g that is left under it.
    pub(super) force: f64,
    pub(super) gap: f64,
    /// The force times its arms about the driving and the driven axis.
    pub(super) moments: [f64; 2],
}

impl PairContact {
    /// A pair with this share of the load, of which nothing else is known.
    pub(crate) fn of_share(pair: i64, share: f64) -> Self {
        Self {
            pair,
            share,
            clearance: None,
            tip_corner: None,
            fillet: None,
        }
    }
}

impl MeshContact {
    /// Summary of the contact of `spots` that carry `load`; `peak` is `None` where a sharp corner carries.
    pub(super) fn of_spots(
        load: f64,
        spots: impl Iterator<Item = Spot>,
        peak: Option<Peak>,
    ) -> Self {
        let (mut moments, mut complementarity) = ([0.0; 2], 0.0_f64);
        for spot in spots {
            moments = [0, 1].map(|gear| moments[gear] + spot.moments[gear]);
            complementarity = complementarity.max((spot.force * spot.gap).abs());
        }
        let [driving_load, carried] = moments;
        Self {
            driving_load,
            peak_pressure: peak.map(|peak| peak.pressure),
            peak_place: peak.map(|peak| peak.place),
            equilibrium: (carried - load).abs() / load,
            complementarity,
            ..Self::default()
        }
    }

    /// About how much memory it holds.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.pairs.len() * size_of::<PairContact>()
    }

    /// The number of pairs that carry load.
    pub fn loaded_pairs(&self) -> u32 {
        self.pairs.iter().filter(|pair| pair.share > 0.0).count() as u32
    }
}
