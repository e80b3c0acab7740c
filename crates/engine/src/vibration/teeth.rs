//! The teeth as their ring moves on one order of the circle on which they are joined to the blank.
//!
//! A tooth follows its circle without inertia of its own motion relative to it: the lowest frequency of a tooth on a circle that is held is far above those of
//! blanks. Its mass follows from that motion, Xᴴ M X. An order is taken by itself: the orders n ± z that teeth couple it to have short waves.

use faer::{Mat, c64};

use super::heights::{Heights, Parity};
use super::section::Section;
use super::system::{BoreSupport, Numbering, System};
use crate::fem::FemError;
use crate::fem::eigen::{Entry, Pencil, PencilFactor};
use crate::gear::SpurGear;
use crate::grid::{GridError, GridLevel, ToothGrid};

/// One tooth with its part of the rim.
#[derive(Debug)]
pub(super) struct ToothCell {
    pub(super) section: Section,
    /// The node on the loaded flank next to the reference circle.
    pub(super) pitch_node: u32,
    /// The nodes of the loaded flank, each with its roll length, rising.
    pub(super) flank: Vec<(f64, u32)>,
    /// The nodes of both fillets, corners and middles in turn: first of that beside the loaded flank.
    pub(super) fillets: [Vec<u32>; 2],
}

/// A tooth under the pull of rotation for ω² = 1 in 1/s².
#[derive(Debug)]
pub(super) struct PulledTooth {
    /// Its force on the amplitude of an order of the circle.
    pub(super) on_circle: Mat<c64>,
    /// The displacement of the unknowns of the cell beside the circle, while that is held.
    pub(super) held: Mat<c64>,
}

/// The ring of teeth on one order of its circle, for each tooth.
#[derive(Debug)]
pub(super) struct TeethOrder {
    /// The stiffness.
    pub(super) stiffness: Mat<c64>,
    /// The mass.
    pub(super) mass: Mat<c64>,
    /// The unknowns of the cell by those of the order.
    follows: Mat<c64>,
    /// The unknowns of the cell.
    pub(super) numbering: Numbering,
}

impl ToothCell {
    /// The cell of `gear` out from `interface_radius`.
    ///
    /// # Errors
    ///
    /// [`GridError`].
    pub(super) fn new(gear: &SpurGear, interface_radius: f64) -> Result<Self, GridError> {
        let tooth = ToothGrid::of_prism(gear, interface_radius, GridLevel::Coarse)?;
        Ok(Self::of_grid(gear, tooth))
    }

    /// The same with fillets that tell the stress along them.
    ///
    /// # Errors
    ///
    /// [`GridError`].
    pub(super) fn with_fillets(gear: &SpurGear, interface_radius: f64) -> Result<Self, GridError> {
        let tooth = ToothGrid::of_stressed_prism(gear, interface_radius, GridLevel::Standard)?;
        Ok(Self::of_grid(gear, tooth))
    }

    fn of_grid(gear: &SpurGear, tooth: ToothGrid) -> Self {
        let radius = gear.reference_radius();
        let from_pitch = |node: &&u32| (tooth.grid.nodes[**node as usize].norm() - radius).abs();
        let pitch_node = tooth
            .flank_nodes
            .iter()
            .min_by(|one, other| from_pitch(one).total_cmp(&from_pitch(other)));
        let z = gear.tooth_count() as usize;
        Self {
            pitch_node: pitch_node.copied().unwrap_or(0),
            fillets: [tooth.fillet_nodes, tooth.back_fillet_nodes],
            flank: tooth
                .flank_roll_lengths
                .iter()
                .copied()
                .zip(tooth.flank_nodes.iter().copied())
                .collect(),
            section: Section {
                part_of: vec![0; tooth.grid.elements.len()],
                sectors: z,
                sides: tooth.side_nodes,
                bore: Vec::new(),
                around: z * (tooth.arc_nodes.len() / 2),
                arc: tooth.arc_nodes,
                grid: tooth.grid,
                hole_edges: Vec::new(),
            },
        }
    }

    /// Its system between the faces of the teeth.
    pub(super) fn system<'a>(
        &'a self,
        heights: &'a Heights,
        gear: &SpurGear,
        faces: [f64; 2],
    ) -> System<'a> {
        let held = BoreSupport::Held;
        System::new(&self.section, heights, &[faces], gear.material(), held)
    }
}

impl TeethOrder {
    /// The ring of cells `system` on `order`, by motions of `parity`.
    ///
    /// # Errors
    ///
    /// [`FemError`] if the grid is degenerate.
    pub(super) fn new(system: &System<'_>, parity: Parity, order: i64) -> Result<Self, FemError> {
        let class = order.rem_euclid(system.section.sectors as i64) as usize;
        let numbering = system.numbering(parity, class, &[order]);
        let mut entries = Vec::new();
        system.assemble(&numbering, &mut entries);
        let (inner, all) = (numbering.first_amplitude, numbering.count);
        let factor = within(inner, &entries)?;
        // Forces of an amplitude on the inner unknowns while they are held: entries of its rows are the conjugate.
        let mut forces = Mat::<c64>::zeros(inner, all - inner);
        for entry in &entries {
            let (row, column) = (entry.row as usize, entry.column as usize);
            if row >= inner && column < inner {
                forces[(column, row - inner)] -= entry.stiffness.conj();
            }
        }
        factor.solve_in_place(&mut forces);
        let mut follows = Mat::<c64>::zeros(all, all - inner);
        follows.subrows_mut(0, inner).copy_from(&forces);
        for i in 0..all - inner {
            follows[(inner + i, i)] = c64::new(1.0, 0.0);
        }
        let pencil = Pencil::new(all, &entries);
        let reduced = |times: Mat<c64>| follows.adjoint() * times;
        Ok(Self {
            stiffness: reduced(pencil.stiffness_times(&follows)),
            mass: reduced(pencil.mass_times(&follows)),
            follows,
            numbering,
        })
    }

    /// A tooth of the same `system` under the pull of rotation.
    ///
    /// # Errors
    ///
    /// As [`TeethOrder::new`].
    pub(super) fn pulled(&self, system: &System<'_>) -> Result<PulledTooth, FemError> {
        let mut entries = Vec::new();
        system.assemble(&self.numbering, &mut entries);
        let inner = self.numbering.first_amplitude;
        let pull = system.pull(&self.numbering);
        let mut held = pull.subrows(0, inner).to_owned();
        within(inner, &entries)?.solve_in_place(&mut held);
        Ok(PulledTooth {
            on_circle: self.follows.adjoint() * pull,
            held,
        })
    }

    /// The unknowns of the cell where the circle moves by this `amplitude` of the order.
    pub(super) fn moved(&self, amplitude: Mat<c64>) -> Mat<c64> {
        &self.follows * amplitude
    }

    /// The same on the opposite order.
    pub(super) fn add_opposite(&self, first: usize, share: f64, entries: &mut Vec<Entry>) {
        let own = entries.len();
        self.add(first, share, entries);
        for entry in &mut entries[own..] {
            entry.stiffness = entry.stiffness.conj();
            entry.mass = entry.mass.conj();
        }
    }

    /// Adds `share` of it to the entries of unknowns from `first` on.
    pub(super) fn add(&self, first: usize, share: f64, entries: &mut Vec<Entry>) {
        for column in 0..self.mass.ncols() {
            for row in column..self.mass.nrows() {
                entries.push(Entry {
                    column: (first + column) as u32,
                    row: (first + row) as u32,
                    stiffness: self.stiffness[(row, column)] * share,
                    mass: self.mass[(row, column)] * share,
                });
            }
        }
    }
}

/// The factor of the stiffness of the first `inner` unknowns among `entries`.
fn within(inner: usize, entries: &[Entry]) -> Result<PencilFactor, FemError> {
    let is_inner = |entry: &&Entry| (entry.row as usize) < inner;
    let within: Vec<Entry> = entries.iter().filter(is_inner).copied().collect();
    Pencil::new(inner, &within).factor("the teeth", 0.0)
}
