//! The contact cells of one tooth pair, and all of their contact that does not depend on which teeth these are.

use faer::Mat;

use super::factor::dot;
use super::patch::{Cell, Extent, Patch};
use crate::fem::dense;
use crate::flank::half_plane::{Entries, near_compliance};
use crate::flank::table::{FlankPoint, FlankTable};
use crate::gear::{GearPair, Member};
use crate::touch::gap_profile::GapProfile;
use crate::touch::placement::Pose;

/// The flanks of a pair as drawn, on which cells are placed.
#[derive(Clone, Copy)]
pub(super) struct PairFlanks<'a> {
    pub(super) pair: &'a GearPair,
    /// Tables of the driving and the driven gear.
    pub(super) tables: [&'a FlankTable; 2],
    /// Cells in one patch.
    pub(super) cells_per_patch: usize,
}

/// Specification of the cells of one pair of a model; numbers by their bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct CellsSpec {
    pub(super) phase: u64,
    /// The gear on whose flank they lie.
    pub(super) primary: Member,
    pub(super) load: u64,
    pub(super) cells_per_patch: usize,
    pub(super) extent: Extent,
}

/// The cells of one pair as drawn, some part of a mesh period after it passed the pitch point.
#[derive(Debug)]
pub(crate) struct PairCells {
    pub(super) spec: CellsSpec,
    /// Where they lie.
    pub(super) patch: Patch,
    /// The compliance of both teeth with their interfaces held; its lower triangle.
    pub(super) held: Mat<f64>,
    /// W V of each gear: how the flank follows its interface there.
    pub(super) shapes: [Mat<f64>; 2],
}

impl PairCells {
    /// Places cells on the flanks of `facing`; `None` where there is no room for one.
    pub(super) fn new(
        flanks: &PairFlanks<'_>,
        view: &Pose<'_>,
        facing: &GapProfile,
        spec: CellsSpec,
    ) -> Option<Self> {
        let (load, count) = (f64::from_bits(spec.load), spec.cells_per_patch);
        let patch = Patch::new(view, facing, load, count, spec.extent);
        if patch.cells.is_empty() {
            return None;
        }
        let stretches: Vec<[f64; 2]> = patch.stretches().collect();
        let (held, shapes) = compliance(flanks, &patch, (&patch.cells, &stretches), Entries::Lower);
        Some(Self {
            spec,
            patch,
            held,
            shapes,
        })
    }

    /// Loads of `forces` on its cells on the interface of each gear: Vᵀ Wᵀ p.
    #[inline(always)]
    pub(super) fn loads(&self, forces: &[f64]) -> [Vec<f64>; 2] {
        let presses = |force: &f64| *force != 0.0;
        let from = forces.iter().position(presses).unwrap_or(forces.len());
        let to = forces
            .iter()
            .rposition(presses)
            .map_or(from, |last| last + 1);
        let mut loads = self
            .shapes
            .each_ref()
            .map(|shapes| vec![0.0; shapes.ncols()]);
        for (shapes, loads) in self.shapes.iter().zip(&mut loads) {
            for (j, load) in loads.iter_mut().enumerate() {
                *load = dot(&shapes.col_as_slice(j)[from..to], &forces[from..to]);
            }
        }
        loads
    }

    /// The `forces` on its cells as loads on the unknowns of `flank`, that of the gear of index `gear`.
    pub(super) fn nodal_forces(&self, flank: &FlankTable, gear: usize, forces: &[f64]) -> Vec<f64> {
        flank.nodal_forces(&points(&self.patch.cells, flank, gear), forces)
    }

    /// About how much memory they take, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let numbers =
            dense::entries(&self.held) + self.shapes.iter().map(dense::entries).sum::<usize>();
        size_of::<Self>() + self.patch.bytes() + size_of::<f64>() * numbers
    }
}

/// Displacements of `cells` on the `stretches` by unit forces on the cells of `patch`, with the interfaces held, and W V of each gear at these cells.
pub(super) fn compliance(
    flanks: &PairFlanks<'_>,
    patch: &Patch,
    (cells, stretches): (&[Cell], &[[f64; 2]]),
    entries: Entries,
) -> (Mat<f64>, [Mat<f64>; 2]) {
    let loaded: Vec<[f64; 2]> = patch.stretches().collect();
    let mut held = near_compliance(&patch.near_fields, stretches, &loaded, entries);
    let shapes = [0, 1].map(|gear| {
        let flank = flanks.tables[gear];
        let (here, there) = (
            points(cells, flank, gear),
            points(&patch.cells, flank, gear),
        );
        held += flank.smooth_compliance(&here, &there, entries);
        flank.shapes_at(&here)
    });
    (held, shapes)
}

/// `cells` as points on `flank`, that of the gear of index `gear`.
pub(super) fn points(cells: &[Cell], flank: &FlankTable, gear: usize) -> Vec<FlankPoint> {
    let cells = cells.iter();
    cells
        .map(|cell| flank.point(cell.roll_lengths[gear], cell.directions[gear]))
        .collect()
}
