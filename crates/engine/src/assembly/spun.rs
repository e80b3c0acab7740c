//! A gear that rotates, or is pressed onto a shaft: how its flanks stand out, and how its edges are stressed.
//!
//! The pull of rotation and the misfit of a shaft are loads inside the gear, the same in all teeth and in all sectors of the blank. With
//! the interface circle held each of them is one more right-hand side on the factor of its grid; then the circle moves by q = C f.

use faer::Mat;

use super::{BlankUnderTeeth, GearSpec, PartError, PlainGearSpec, Probes, Teeth, TeethSpec};
use crate::fem::centrifugal::centrifugal;
use crate::fem::recovery::{Functional, edge_stresses};
use crate::gear::{Core, Material, Vector};
use crate::grid::BlankGrid;
use crate::ring::blank::{BlankLoad, BlankLoads, BlankRecovery, Hold};
use crate::ring::motion::InterfaceMotion;
use crate::ring::plain::PlainGear;
use crate::ring::teeth_loads::TeethLoads;
use crate::ring::teeth_recovery::TeethRecovery;
use crate::ring::tooth::ToothSubstructure;
use crate::run::Run;

/// A gear on its own blank, and the support of its bore while it rotates.
#[derive(Debug, Clone, PartialEq)]
pub struct SpunSpec {
    teeth: TeethSpec,
    under: BlankUnderTeeth,
    hold: Hold,
}

/// A gear under one load inside it. Stresses are in Pa along free edges, positive in tension.
#[derive(Debug, Clone)]
pub struct InnerLoad {
    /// How far the loaded flank of each tooth stands out along its normal, in meters, node by node from the form circle to the tip.
    pub flanks: Vec<Vec<f64>>,
    /// How far the tips move outward in the mean, in meters.
    pub tips: f64,
    /// The stresses along the fillets of each tooth, in the order of [`Probes::along_free_edges`].
    pub in_teeth: Vec<Vec<f64>>,
    /// The stresses around the holes of each sector of the blank, in that order.
    pub in_blank: Vec<Vec<f64>>,
    /// The stresses along the bore of each sector, less those of a pressure on it; empty for a bore that a rigid hub holds.
    pub along_bore: Vec<Vec<f64>>,
    /// The mean pressure of the shaft on the bore, in Pa.
    pub pressure: f64,
}

/// A gear under the loads of its rotation.
#[derive(Debug, Clone)]
pub struct Spun {
    /// The roll lengths of the nodes of its flanks, rising.
    pub roll_lengths: Vec<f64>,
    /// Under the pull of rotation for ω² = 1 in 1/s².
    pub spin: InnerLoad,
    /// On a solid shaft that is larger in radius by one meter; `None` without a shaft.
    pub fit: Option<InnerLoad>,
}

impl SpunSpec {
    /// The gear of `spec`, its bore held as `hold` says; `None` of a gear on a rigid blank.
    pub fn new(spec: &GearSpec, hold: Hold) -> Option<Self> {
        let blank = spec.blank.clone();
        blank.map(|under| Self {
            teeth: spec.teeth.clone(),
            under,
            hold,
        })
    }

    /// The teeth.
    pub(super) fn teeth(&self) -> &TeethSpec {
        &self.teeth
    }

    /// The gear without holes.
    pub(super) fn plain(&self) -> PlainGearSpec {
        self.under.plain(&self.teeth)
    }

    /// Makes it of its `teeth` and of the `plain` gear that it is without holes.
    pub(super) fn make(
        &self,
        teeth: &Teeth,
        plain: &PlainGear,
        run: &Run,
    ) -> Result<Spun, PartError> {
        run.check()?;
        let (grid_of_tooth, grid) = (self.teeth.grid()?, self.under.spec.grid()?);
        let (gear, under) = (self.teeth.gear(), &self.under);
        let (material, width) = (gear.material(), gear.face_width());
        let mut probes = Probes::along_free_edges(&grid_of_tooth, Some(&grid), material);
        let around_holes = probes.in_blank.len();
        let region = &under.spec.gear().data().blank;
        if region.core == Core::Bore && self.hold != Hold::Rigid {
            let is_closed = grid.side_nodes.0.is_empty();
            let bore = edge_stresses(&grid.grid, material, &grid.bore_nodes, is_closed);
            probes.in_blank.extend(bore);
        }
        let loads = self.loads_of_blank(&grid, (material, width), region.bore_radius);

        let pull = centrifugal(&grid_of_tooth.grid, material, width);
        let nothing = Functional::new(Vec::new());
        let in_tooth: Vec<Functional> = [pull, nothing].into_iter().take(loads.len()).collect();
        let (tooth, rows, of_tooth) =
            ToothSubstructure::loaded(gear, &grid_of_tooth, &probes.in_tooth, &in_tooth)?;
        run.check()?;
        let of_teeth = TeethLoads::new(&tooth, (&rows, &of_tooth), &teeth.ring, run)?;
        let recovery = TeethRecovery::new(&tooth, &rows, teeth.ring.harmonics, run)?;
        let (blank, in_blank, of_blank) =
            under
                .spec
                .make_loaded(&grid, self.hold, &probes.in_blank, &loads, run)?;
        let holed = Some((&blank, under.hole_angle));
        let motion = InterfaceMotion::new(&teeth.ring, plain, holed, run)?;

        let flank = gear.flank();
        let answer = |load: usize| {
            let column = |of: &Mat<f64>| of.col_as_slice(load).to_vec();
            let mut forces = column(&of_teeth.forces);
            let on_blank = in_blank
                .harmonics
                .turned(&column(&of_blank.forces), -under.hole_angle);
            for (force, more) in forces.iter_mut().zip(on_blank) {
                *force += more;
            }
            let q = motion.under_forces(&forces);
            let added = |mut values: Vec<f64>, held: &[f64]| {
                for (value, held) in values.iter_mut().zip(held) {
                    *value += held;
                }
                values
            };
            let count = teeth.ring.tooth_count;
            let moved: Vec<Vec<f64>> = (0..count)
                .map(|i| {
                    let moved = teeth.ring.flank_moved(&tooth.modes, i, &q);
                    added(moved, of_teeth.flank.col_as_slice(load))
                })
                .collect();
            // Both components of the tip: along the normal and along the flank's own radius.
            let nodes = tooth.roll_lengths.len();
            let tip = flank.point(tooth.roll_lengths[nodes - 1]);
            let axes = flank.normal(tooth.roll_lengths[nodes - 1]);
            let along = Vector::new(axes.y, -axes.x);
            let tips = moved.iter().map(|unknowns| {
                let [normal, towards_tip] = [0, 1].map(|c| unknowns[2 * (nodes - 1) + c]);
                (normal * axes + towards_tip * along).dot(&tip) / tip.norm()
            });
            let tips = tips.sum::<f64>() / count as f64;
            let held = of_teeth.values.col_as_slice(load);
            let in_teeth = (0..count).map(|i| added(recovery.values(i, &[], &[], &q), held));
            let held = of_blank.values.col_as_slice(load);
            let sectors: Vec<Vec<f64>> = (0..in_blank.sector_count)
                .map(|i| added(in_blank.values(i, under.hole_angle, &q), held))
                .collect();
            let (around, along): (Vec<_>, Vec<_>) = sectors
                .iter()
                .map(|all| all.split_at(around_holes))
                .map(|(holes, bore)| (holes.to_vec(), bore.to_vec()))
                .unzip();
            InnerLoad {
                tips,
                flanks: moved
                    .iter()
                    .map(|unknowns| unknowns.iter().step_by(2).copied().collect())
                    .collect(),
                in_teeth: in_teeth.collect(),
                in_blank: around,
                along_bore: along,
                pressure: self.pressure(
                    &loads[load],
                    (&of_blank, load, &in_blank),
                    (under.hole_angle, &q),
                    (material, region.bore_radius),
                ),
            }
        };
        Ok(Spun {
            roll_lengths: tooth.roll_lengths.clone(),
            spin: answer(0),
            fit: (loads.len() > 1).then(|| answer(1)),
        })
    }

    /// The loads of the blank: rotation, and of a shaft its misfit.
    fn loads_of_blank(
        &self,
        grid: &BlankGrid,
        (material, width): (&Material, f64),
        bore_radius: f64,
    ) -> Vec<BlankLoad> {
        let forces = centrifugal(&grid.grid, material, width);
        // A free disc grows by (1 − ν) ρ ω² r³/(4 E).
        let grown = (1.0 - material.poisson_ratio) * material.density * bore_radius.powi(3)
            / (4.0 * material.youngs_modulus);
        let spin = BlankLoad {
            forces,
            swelling: grown,
        };
        let fit = BlankLoad {
            forces: Functional::new(Vec::new()),
            swelling: 1.0,
        };
        match self.hold {
            Hold::Rigid | Hold::Free => vec![spin],
            Hold::Shaft => vec![spin, fit],
        }
    }

    /// The mean pressure of the shaft on the bore: E/((1 − ν) r) for each meter by which it is pressed together.
    fn pressure(
        &self,
        load: &BlankLoad,
        (held, number, recovery): (&BlankLoads, usize, &BlankRecovery),
        (hole_angle, q): (f64, &[f64]),
        (material, radius): (&Material, f64),
    ) -> f64 {
        if self.hold != Hold::Shaft {
            return 0.0;
        }
        let moved = held.bore[number] + recovery.bore_outward(hole_angle, q);
        material.youngs_modulus / (1.0 - material.poisson_ratio) / radius * (load.swelling - moved)
    }
}

impl Spun {
    /// The numbers that it keeps.
    pub fn entries(&self) -> usize {
        let of = |load: &InnerLoad| {
            let lists = [
                &load.flanks,
                &load.in_teeth,
                &load.in_blank,
                &load.along_bore,
            ];
            lists
                .iter()
                .flat_map(|lists| lists.iter())
                .map(Vec::len)
                .sum::<usize>()
        };
        self.roll_lengths.len() + of(&self.spin) + self.fit.as_ref().map_or(0, of)
    }
}
