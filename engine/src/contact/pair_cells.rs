//! The contact cells of one tooth pair, and all of their contact that does not depend on which teeth these are.

use faer::Mat;

use super::facing::Facing;
use super::flank_table::{FlankPoint, FlankTable};
use super::half_plane::in_row;
use super::model::PairModel;
use super::patch::Patch;
use crate::fem::dense::entries;

/// Cells are laid as densely on widened patches, up to so many times as many.
const MOST_WIDENED: f64 = 4.0;

/// The cells of one pair at one fraction of the mesh period.
#[derive(Debug)]
pub struct PairCells {
    /// Where they lie.
    pub(super) patch: Patch,
    /// The compliance of both teeth with their interfaces held; its lower triangle.
    pub(super) held: Mat<f64>,
    /// W V of each gear: how the flank follows its interface there.
    pub(super) shapes: [Mat<f64>; 2],
}

impl PairCells {
    /// Lays cells on the flanks of `facing`, in a patch `widening` times as wide as `load` needs; `None` where there is no room for one.
    pub(super) fn new(
        model: &PairModel,
        facing: &Facing<'_>,
        load: f64,
        widening: f64,
    ) -> Option<Self> {
        let count = (model.cells_per_patch as f64 * widening.min(MOST_WIDENED)).round() as usize;
        let patch = Patch::new(facing, load, count, widening);
        let here = patch.cells.len();
        if here == 0 {
            return None;
        }
        let mut held = Mat::zeros(here, here);
        let shapes = [0, 1].map(|gear| {
            let flank = &model.gears[gear].flank;
            let points = points(&patch, flank, gear);
            held += flank.smooth_compliance(&points, &points);
            flank.shapes_at(&points)
        });
        let near = in_row(&patch.near_fields, 0.0, patch.cell_width, here);
        for j in 0..here {
            for i in j..here {
                held[(i, j)] += near[i - j];
            }
        }
        Some(Self {
            patch,
            held,
            shapes,
        })
    }

    /// What `forces` on its cells are on the unknowns of `flank`, that of the gear of index `gear`.
    pub(super) fn nodal_forces(&self, flank: &FlankTable, gear: usize, forces: &[f64]) -> Vec<f64> {
        flank.nodal_forces(&points(&self.patch, flank, gear), forces)
    }

    /// About how much memory they take, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let numbers = entries(&self.held) + self.shapes.iter().map(entries).sum::<usize>();
        size_of::<Self>() + size_of_val(self.patch.cells.as_slice()) + size_of::<f64>() * numbers
    }

    /// Whether a wider patch would have more room.
    pub(super) fn can_widen(&self) -> bool {
        self.patch.ends.contains(&None)
    }

    /// Whether contact of the `active` cells reaches an end of the patch beyond which the flanks still face each other.
    pub(super) fn overflows(&self, active: &[bool]) -> bool {
        let [first, last] = [active.first(), active.last()].map(|end| end == Some(&true));
        (first && self.patch.ends[0].is_none()) || (last && self.patch.ends[1].is_none())
    }
}

/// The cells of `patch` as points on `flank`, that of the gear of index `gear`.
fn points(patch: &Patch, flank: &FlankTable, gear: usize) -> Vec<FlankPoint> {
    let cells = patch.cells.iter();
    cells
        .map(|cell| flank.point(cell.roll_lengths[gear], cell.directions[gear]))
        .collect()
}
