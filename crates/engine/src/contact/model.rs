//! The discrete model of a pair: both gears' flanks and how their teeth move each other.

use std::sync::Arc;

use faer::MatRef;

use super::compliances::Compliances;
use super::contradiction::Contradiction;
use super::drawn::{DrawnFlanks, DrawnPair};
use super::pair_cells::PairFlanks;
use super::problem::ContactError;
use crate::flank::table::FlankTable;
use crate::gear::{GearPair, Member, PairDeviations, teeth_on};
use crate::ring::body::Coupling;
use crate::run::Run;
use crate::touch::placement::{Pose, Section};

/// The solver of the contact conditions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactSolver {
    /// The exact active set.
    ActiveSet,
    /// The augmented Lagrangian of the paper, eq. 7.
    AugmentedLagrangian {
        /// The penalty stiffness κ of a contact cell in N/m; `None` for [`super::default_penalty`].
        penalty: Option<f64>,
        /// The gap tolerance ε in meters.
        gap_tolerance: f64,
    },
}

/// One gear: its flank table and the coupling of its teeth.
#[derive(Debug, Clone)]
pub struct GearModel {
    /// The flank of every tooth.
    pub flank: Arc<FlankTable>,
    /// Compliance between loaded teeth.
    pub coupling: Arc<Coupling>,
}

/// A pair ready for contact at any position and load.
#[derive(Debug, Clone)]
pub struct PairModel {
    /// The pair as drawn: deviations are those of a [`DeviatingPair`].
    pub pair: GearPair,
    /// Driving and driven gear.
    pub gears: [GearModel; 2],
    /// Cells in one patch.
    pub cells_per_patch: usize,
    /// The solver.
    pub solver: ContactSolver,
    /// By which a solver of many steps is stopped.
    pub run: Run,
    /// Stored data of its flanks as drawn.
    pub drawn: Arc<DrawnFlanks>,
    /// Stored compliances on them, with these gears.
    pub compliances: Arc<Compliances>,
}

/// Warm start of one position for the next: the load of each pair, and the transmission error.
///
/// Pairs are numbered from the reference pair of the position's own mesh period.
#[derive(Debug, Clone, Default)]
pub struct WarmStart {
    /// The transmission error; `None` at a cold start.
    pub(super) transmission_error: Option<f64>,
    /// Displacement of the next pair by a force on one, in m/N.
    pub(super) between: f64,
    /// The pairs that carried.
    pub(super) pairs: Vec<WarmPair>,
}

/// How a pair carried.
#[derive(Debug, Clone, Copy)]
pub(super) struct WarmPair {
    pub(super) pair: i64,
    /// Its force over the motion of δ since its touch, less the common motion of all pairs.
    pub(super) stiffness: f64,
    /// By how much it closed its gap at either end, beyond the touch, for each unit of force.
    pub(super) closed: [f64; 2],
}

/// A mesh position: a fraction of the mesh period, and the whole periods before it.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeshPosition {
    pub(super) fraction: f64,
    pub(super) period: i64,
}

impl MeshPosition {
    /// η.
    pub(super) fn eta(self) -> f64 {
        self.fraction + self.period as f64
    }
}

/// Why a position has no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PositionError {
    /// No flanks face each other.
    #[error("no flanks come near each other")]
    NoContact,
    /// Teeth touch that are farther apart than the model couples.
    #[error(
        "teeth touch that stand {apart} apart, and the model couples those up to {coupled} apart"
    )]
    TooFarApart {
        /// Teeth between the first and the last that touch.
        apart: usize,
        /// How far apart coupled teeth stand.
        coupled: usize,
    },
    /// The contact solver failed.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The solution contradicts its own evidence.
    #[error(transparent)]
    Contradicted(#[from] Contradiction),
}

/// One pair made to the drawings of a model: the deviations of its teeth beside the data that it shares with all others.
#[derive(Debug, Clone, Copy)]
pub struct DeviatingPair<'a> {
    /// The drawn pair.
    pub model: &'a PairModel,
    /// Deviations of its teeth.
    pub deviations: &'a PairDeviations,
}

impl<'a> DeviatingPair<'a> {
    /// The pose of its pair `n` at the mesh position `eta`, the driven gear lagging by `lag`, for points that were placed on a primary at a phase.
    pub(super) fn pose(self, eta: f64, n: i64, lag: f64, placed: (Member, f64)) -> Pose<'a> {
        let made = (&self.model.pair, self.deviations);
        Pose::real(made, Section::straight(eta, n), lag, placed)
    }
}

impl PairModel {
    /// A pair that is just as drawn.
    pub fn as_drawn(&self) -> DeviatingPair<'_> {
        static NONE: PairDeviations = PairDeviations::NONE;
        self.deviating(&NONE)
    }

    /// A pair whose teeth deviate by `deviations`: these change gaps, arms and the places where flanks meet, and never a compliance.
    pub fn deviating<'a>(&'a self, deviations: &'a PairDeviations) -> DeviatingPair<'a> {
        DeviatingPair {
            model: self,
            deviations,
        }
    }

    /// The same pair on gears whose teeth move each other as `change` makes of how they do.
    pub fn with_couplings(&self, change: impl Fn(Member, &Arc<Coupling>) -> Arc<Coupling>) -> Self {
        let gears = Member::BOTH.map(|member| {
            let gear = &self.gears[member.index()];
            GearModel {
                flank: Arc::clone(&gear.flank),
                coupling: change(member, &gear.coupling),
            }
        });
        Self {
            gears,
            compliances: Arc::default(),
            ..self.clone()
        }
    }

    /// Its flanks as drawn.
    pub(super) fn flanks(&self) -> PairFlanks<'_> {
        PairFlanks {
            pair: &self.pair,
            tables: self.gears.each_ref().map(|gear| &*gear.flank),
            cells_per_patch: self.cells_per_patch,
        }
    }

    /// Its pair at `phase`, seen from the gear whose tip is nearer.
    pub(super) fn drawn_pair(&self, phase: f64) -> DrawnPair {
        self.drawn.pair(&self.flanks(), phase)
    }

    /// Its pair at `phase`, seen from the flank of `primary`.
    pub(super) fn drawn_pair_on(&self, phase: f64, primary: Member) -> DrawnPair {
        self.drawn.pair_on(&self.flanks(), phase, primary)
    }

    /// X between the teeth of `member` in two pairs, which are numbered from the reference pair of the mesh period `period`.
    pub(crate) fn coupling(
        &self,
        member: Member,
        period: i64,
        [a, b]: [i64; 2],
    ) -> MatRef<'_, f64> {
        let coupling = &self.gears[member.index()].coupling;
        let tooth = self.pair.tooth(member, period + a);
        match coupling.block(tooth, teeth_on(member, b - a)) {
            (x, false) => x.as_ref(),
            (x, true) => x.transpose(),
        }
    }

    /// How far apart coupled teeth of either gear stand at most.
    pub fn coupled_teeth(&self) -> usize {
        let [one, other] = [0, 1].map(|gear| self.gears[gear].coupling.farthest());
        one.min(other)
    }
}
