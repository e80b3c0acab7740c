//! Substructures that several cases share: computed once, kept within a bound.

use std::sync::Arc;

use rayon::prelude::*;

use super::case::Case;
use super::shelf::{Shelf, ShelfUsage};
use super::{AnalysisError, Settings};
use crate::contact::flank_table::FlankTable;
use crate::contact::{ContactSolver, MeshContact};
use crate::fem::FemError;
use crate::fem::blank::BlankSubstructure;
use crate::fem::body::Coupling;
use crate::fem::cyclic::Harmonics;
use crate::fem::teeth::{FARTHEST_COUPLED, TeethRing};
use crate::fem::tooth::ToothSubstructure;
use crate::gear::{HolePattern, Member, SpurGear};
use crate::grid::blank::ELEMENTS_PER_TOOTH;
use crate::grid::{BlankGrid, GridError, GridLevel, ToothGrid};
use crate::run::{Run, Stopped};

/// Orders on the interface circle for each tooth, at most: beyond, the grids do not follow.
const MOST_ORDERS_PER_TOOTH: usize = 8;

/// Elements of the blank along the interface circle for each tooth, at most: a rim so thin that it would want more is
/// refused or warned of.
const MOST_ELEMENTS_PER_TOOTH: f64 = 10.0;

/// Elements along the interface circle of a holed blank, at least.
const ELEMENTS_AROUND_HOLES: f64 = 400.0;

/// All teeth of a gear, down to the interface circle.
#[derive(Debug)]
pub struct Teeth {
    /// The flank of each.
    pub flank: Arc<FlankTable>,
    /// Their ring.
    pub ring: TeethRing,
    /// Teeth with the interface circle held.
    pub on_rigid_blank: Arc<Coupling>,
    /// Unknowns before condensation.
    pub degrees_of_freedom: u64,
}

/// A gear on its flexible blank.
#[derive(Debug)]
pub struct Gear {
    /// How its loaded teeth move each other.
    pub coupling: Arc<Coupling>,
    /// Unknowns before condensation.
    pub degrees_of_freedom: u64,
}

/// What a model needs of one gear.
#[derive(Debug, Clone, Copy)]
pub(super) struct GearParts<'a> {
    pub(super) gear: &'a SpurGear,
    pub(super) member: Member,
    pub(super) interface_radius: f64,
    /// Whether its blank takes part, or is rigid.
    pub(super) with_blank: bool,
}

/// Something to be made for a gear.
type Task<'a> = (&'a GearParts<'a>, Part<'a>);

/// A part that several gears may share.
enum Part<'a> {
    Teeth,
    Blank(Option<&'a HolePattern>),
}

/// Why a gear has no model.
#[derive(Debug, Clone, thiserror::Error)]
enum BuildError {
    #[error(transparent)]
    Grid(#[from] GridError),
    #[error(transparent)]
    Fem(#[from] FemError),
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// What a tooth, a blank or a gear depends on, bit by bit.
type Key = Vec<u64>;

/// A bounded store of teeth, blanks and gears, shared between threads; cloning shares it.
#[derive(Debug, Clone)]
pub struct Library(Arc<Shelves>);

#[derive(Debug)]
struct Shelves {
    teeth: Shelf<Key, Teeth>,
    blanks: Shelf<Key, BlankSubstructure>,
    gears: Shelf<Key, Gear>,
    contacts: Shelf<Key, Vec<MeshContact>>,
}

impl Default for Library {
    /// A library of 256 MB.
    fn default() -> Self {
        Self::with_capacity(256 << 20)
    }
}

impl Library {
    /// A library that keeps at most `bytes` of substructures, of each kind the least recently used leaving first.
    pub fn with_capacity(bytes: usize) -> Self {
        Self(Arc::new(Shelves {
            teeth: Shelf::new(bytes / 2),
            blanks: Shelf::new(bytes / 4),
            gears: Shelf::new(bytes / 8),
            contacts: Shelf::new(bytes / 8),
        }))
    }

    /// How each of its shelves is used, by what stands on it.
    pub fn usage(&self) -> [(&'static str, ShelfUsage); 4] {
        let Shelves {
            teeth,
            blanks,
            gears,
            contacts,
        } = &*self.0;
        [
            ("teeth", teeth.usage()),
            ("blanks", blanks.usage()),
            ("gears", gears.usage()),
            ("contacts", contacts.usage()),
        ]
    }

    /// The teeth of `gear` down to `interface_radius`.
    ///
    /// # Errors
    ///
    /// [`AnalysisError::Discretization`], or [`AnalysisError::Stopped`].
    pub fn teeth(
        &self,
        gear: &SpurGear,
        member: Member,
        interface_radius: f64,
        level: GridLevel,
        run: &Run,
    ) -> Result<Arc<Teeth>, AnalysisError> {
        self.shared_teeth(gear, interface_radius, level, run)
            .map_err(|error| error.of(member))
    }

    /// `gear` with its blank: its holes, its bore and its teeth.
    ///
    /// # Errors
    ///
    /// [`AnalysisError::Discretization`], or [`AnalysisError::Stopped`].
    pub fn gear(
        &self,
        gear: &SpurGear,
        member: Member,
        interface_radius: f64,
        level: GridLevel,
        farthest: usize,
        run: &Run,
    ) -> Result<Arc<Gear>, AnalysisError> {
        self.shared_gear(gear, interface_radius, level, farthest, run)
            .map_err(|error| error.of(member))
    }

    /// Makes in parallel, as far as they are not known, the teeth of `gears` and the blanks of those that take part with
    /// theirs: no part needs another, and equal ones are made once.
    ///
    /// # Errors
    ///
    /// [`AnalysisError::Discretization`], or [`AnalysisError::Stopped`].
    pub(super) fn prepare(
        &self,
        gears: &[GearParts<'_>],
        settings: Settings,
        run: &Run,
    ) -> Result<(), AnalysisError> {
        let Settings { level, farthest } = settings;
        // Teeth first: they take longest.
        let mut tasks: Vec<(Key, Task<'_>)> = Vec::new();
        let mut add = |key: Key, task| {
            if tasks.iter().all(|(known, _)| *known != key) {
                tasks.push((key, task));
            }
        };
        for of in gears {
            let key = teeth_key(of.gear, of.interface_radius, level);
            add(key, (of, Part::Teeth));
        }
        for of in gears {
            let whole = gear_key(of.gear, of.interface_radius, level, farthest);
            if of.with_blank && !self.0.gears.holds(&whole) {
                // A holed blank stands beside the solid one that its highest orders find.
                let low = orders_of_blank(of.gear, of.gear.holes(), of.interface_radius, level);
                let solid = (low != harmonics(of.gear, of.interface_radius, level)).then_some(None);
                for holes in [Some(of.gear.holes()), solid].into_iter().flatten() {
                    let key = blank_key(of.gear, holes, of.interface_radius, level);
                    add(key, (of, Part::Blank(holes)));
                }
            }
        }
        tasks
            .par_iter()
            .with_max_len(1)
            .try_for_each(|(_, (of, part))| {
                let (gear, radius) = (of.gear, of.interface_radius);
                let made = match part {
                    Part::Teeth => self.shared_teeth(gear, radius, level, run).map(drop),
                    Part::Blank(holes) => self
                        .shared_blank(gear, *holes, radius, level, run)
                        .map(drop),
                };
                made.map_err(|error| error.of(of.member))
            })
    }

    /// The contacts of `case` under `load` at `positions` with its holed blanks rigid, solved by `solve` if no other case
    /// has: they depend on no hole, so that all hole patterns on the same teeth share them.
    ///
    /// # Errors
    ///
    /// What `solve` fails with.
    pub(super) fn rigid_blank_contacts(
        &self,
        case: &Case,
        level: GridLevel,
        load: f64,
        positions: &[f64],
        solve: impl FnOnce() -> Result<Vec<MeshContact>, AnalysisError>,
    ) -> Result<Arc<Vec<MeshContact>>, AnalysisError> {
        let mut key = rigid_blank_key(case, level);
        key.push(load.to_bits());
        key.extend(positions.iter().map(|eta| eta.to_bits()));
        let bytes = |contacts: &Vec<MeshContact>| contacts.iter().map(MeshContact::bytes).sum();
        self.0.contacts.part(key, bytes, solve)
    }

    fn shared_teeth(
        &self,
        gear: &SpurGear,
        interface_radius: f64,
        level: GridLevel,
        run: &Run,
    ) -> Result<Arc<Teeth>, BuildError> {
        run.check()?;
        self.0.teeth.part_made_once(
            teeth_key(gear, interface_radius, level),
            Teeth::bytes,
            || build_teeth(gear, interface_radius, level, run),
        )
    }

    /// The blank of `gear` with `holes`, or without.
    fn shared_blank(
        &self,
        gear: &SpurGear,
        holes: Option<&HolePattern>,
        interface_radius: f64,
        level: GridLevel,
        run: &Run,
    ) -> Result<Arc<BlankSubstructure>, BuildError> {
        run.check()?;
        self.0.blanks.part_made_once(
            blank_key(gear, holes, interface_radius, level),
            |blank| size_of::<f64>() * blank.harmonics.unknowns().pow(2),
            || build_blank(gear, holes, interface_radius, level, run),
        )
    }

    fn shared_gear(
        &self,
        gear: &SpurGear,
        interface_radius: f64,
        level: GridLevel,
        farthest: usize,
        run: &Run,
    ) -> Result<Arc<Gear>, BuildError> {
        let key = gear_key(gear, interface_radius, level, farthest);
        self.0.gears.part(key, Gear::bytes, || {
            let teeth = self.shared_teeth(gear, interface_radius, level, run)?;
            let blank = self.shared_blank(gear, gear.holes(), interface_radius, level, run)?;
            let low = blank.harmonics;
            let coupling = if low == teeth.ring.harmonics {
                Coupling::on_blank(&teeth.ring, &blank, hole_phase(gear), farthest, run)?
            } else {
                let solid = self.shared_blank(gear, None, interface_radius, level, run)?;
                let ring = teeth.ring.above(low, &solid, run)?;
                Coupling::on_blank(&ring, &blank, hole_phase(gear), farthest, run)?
            };
            Ok(Gear {
                coupling: Arc::new(coupling),
                degrees_of_freedom: teeth.degrees_of_freedom + 2 * blank.grid_nodes as u64,
            })
        })
    }
}

impl Teeth {
    /// About how much memory they hold.
    fn bytes(&self) -> usize {
        let (n, r) = (self.ring.harmonics.unknowns(), self.flank.mode_count());
        let couplings = 2 * self.on_rigid_blank.entries();
        let patterns = (n + r) * self.ring.force_patterns.ncols();
        size_of::<f64>() * (n * n + patterns + couplings + self.flank.entries())
    }
}

impl Gear {
    /// About how much memory it holds.
    fn bytes(&self) -> usize {
        size_of::<f64>() * self.coupling.entries()
    }
}

impl BuildError {
    fn of(self, member: Member) -> AnalysisError {
        match self {
            Self::Stopped(stopped) | Self::Fem(FemError::Stopped(stopped)) => {
                AnalysisError::Stopped(stopped)
            }
            Self::Grid(error) => AnalysisError::Discretization {
                member,
                reason: error.to_string(),
            },
            Self::Fem(error) => AnalysisError::Discretization {
                member,
                reason: error.to_string(),
            },
        }
    }
}

/// The interface radius R_w of `gear`: one module below the root circle, or halfway to the holes or the bore where they
/// come closer.
pub fn default_interface_radius(gear: &SpurGear) -> f64 {
    let inner = gear
        .holes()
        .map_or(gear.bore_radius(), HolePattern::outer_reach);
    let r_f = gear.root_radius();
    (r_f - gear.data().rack.module).max(f64::midpoint(r_f, inner))
}

/// The interface radius R_w of one gear of a case.
pub(super) fn interface_radius(case: &Case, member: Member) -> f64 {
    let gear = case.pair.gear(member);
    let asked = case
        .resolution
        .interface_radius
        .filter(|_| gear.holes().is_some());
    asked.unwrap_or_else(|| default_interface_radius(gear))
}

/// The orders that the interface circle carries: on its way from the root circle the field of the teeth falls by
/// e^(−n (r_f − R_w)/R_w), at the standard level to e⁻⁴·⁵ of it for the first order that is left out.
///
/// What is left out shows with the square of that: on the fine grid the mean STE of the paper's cases moves by 2e-6 from
/// 4.5 to 6.5, and by 2e-8 from there to 9.75. More orders than the blank's grid resolves do harm: on the standard grid the
/// rms of case 1 is 4e-4 off the fine one's with 4.5, and 2e-3 with 6.5.
pub fn harmonics(gear: &SpurGear, interface_radius: f64, level: GridLevel) -> Harmonics {
    let z = gear.tooth_count() as usize;
    Harmonics {
        largest: orders_within(
            gear.root_radius() - interface_radius,
            interface_radius,
            level,
        )
        .clamp(z, MOST_ORDERS_PER_TOOTH * z),
    }
}

/// The orders that see the `holes` of a blank, by the same rule: on its way from the holes to the interface circle their
/// field falls as well. None of them, and all orders find the blank alike.
pub fn orders_of_blank(
    gear: &SpurGear,
    holes: Option<&HolePattern>,
    interface_radius: f64,
    level: GridLevel,
) -> Harmonics {
    let all = harmonics(gear, interface_radius, level);
    holes.map_or(all, |holes| {
        let depth = interface_radius - holes.outer_reach();
        let largest = orders_within(depth, interface_radius, level).min(all.largest);
        Harmonics { largest }
    })
}

/// The orders of a circle of radius `radius` whose fields fall by less than the share that the level leaves out over
/// `depth`.
fn orders_within(depth: f64, radius: f64, level: GridLevel) -> usize {
    let decay = match level {
        GridLevel::Coarse => 3.25,
        GridLevel::Standard => 4.5,
        GridLevel::Fine => 6.5,
    };
    // Similar gears, whose lengths differ by rounding, carry the same orders.
    (decay * radius / depth - 1e-9).ceil() as usize
}

fn build_teeth(
    gear: &SpurGear,
    interface_radius: f64,
    level: GridLevel,
    run: &Run,
) -> Result<Teeth, BuildError> {
    let grid = ToothGrid::new(gear, interface_radius, level)?;
    run.check()?;
    let tooth = ToothSubstructure::new(gear, &grid)?;
    run.check()?;
    let ring = TeethRing::new(&tooth, harmonics(gear, interface_radius, level), run)?;
    // Nodes of the interface circle belong to the teeth; the blank's follow them.
    let degrees_of_freedom = 2 * u64::from(gear.tooth_count()) * (tooth.own_nodes() as u64);
    Ok(Teeth {
        flank: Arc::new(FlankTable::new(&tooth, gear)),
        on_rigid_blank: Arc::new(Coupling::on_rigid_blank(&ring, FARTHEST_COUPLED)),
        ring,
        degrees_of_freedom,
    })
}

/// The grid of one sector of the blank of `gear`, with `holes` or without, fine enough on the interface circle for the
/// orders that it carries.
///
/// # Errors
///
/// [`GridError`] if the holes leave no room for elements.
pub fn blank_grid(
    gear: &SpurGear,
    holes: Option<&HolePattern>,
    interface_radius: f64,
    level: GridLevel,
) -> Result<BlankGrid, GridError> {
    let z = f64::from(gear.tooth_count());
    let orders = orders_of_blank(gear, holes, interface_radius, GridLevel::Standard).largest;
    // Seven nodes, three and a half elements, for two wavelengths of the highest order.
    let of_orders = 1.75 * orders as f64 / z;
    // Holes are as large as their gear and not as its teeth.
    let least = holes.map_or(ELEMENTS_PER_TOOTH, |_| {
        ELEMENTS_PER_TOOTH.min(ELEMENTS_AROUND_HOLES / z)
    });
    BlankGrid::new(
        gear.bore_radius(),
        interface_radius,
        holes,
        gear.tooth_count(),
        of_orders.clamp(least, MOST_ELEMENTS_PER_TOOTH),
        level,
    )
}

fn build_blank(
    gear: &SpurGear,
    holes: Option<&HolePattern>,
    interface_radius: f64,
    level: GridLevel,
    run: &Run,
) -> Result<BlankSubstructure, BuildError> {
    let grid = blank_grid(gear, holes, interface_radius, level)?;
    Ok(BlankSubstructure::new(
        &grid,
        interface_radius,
        gear.material(),
        gear.face_width(),
        orders_of_blank(gear, holes, interface_radius, level),
        run,
    )?)
}

fn tooth_bits(gear: &SpurGear) -> Vec<u64> {
    let data = gear.data();
    let rack = &data.rack;
    let material = &data.material;
    let numbers = [
        rack.module,
        rack.pressure_angle,
        rack.addendum,
        rack.dedendum,
        rack.tip_radius,
        data.profile_shift,
        data.face_width,
        material.youngs_modulus,
        material.poisson_ratio,
    ];
    numbers
        .iter()
        .map(|number| number.to_bits())
        .chain([u64::from(data.tooth_count)])
        .collect()
}

fn teeth_key(gear: &SpurGear, interface_radius: f64, level: GridLevel) -> Key {
    let mut key = tooth_bits(gear);
    key.extend([interface_radius.to_bits(), level as u64]);
    key
}

fn gear_key(gear: &SpurGear, interface_radius: f64, level: GridLevel, farthest: usize) -> Key {
    let mut key = teeth_key(gear, interface_radius, level);
    key.extend(blank_key(gear, gear.holes(), interface_radius, level));
    key.extend([hole_phase(gear).to_bits(), farthest as u64]);
    key
}

fn hole_phase(gear: &SpurGear) -> f64 {
    gear.holes().map_or(0.0, |holes| holes.phase)
}

/// What the contacts of a case depend on while its holed blanks are rigid.
fn rigid_blank_key(case: &Case, level: GridLevel) -> Key {
    let mut key = vec![case.pair.center_distance().to_bits()];
    for member in Member::BOTH {
        let gear = case.pair.gear(member);
        key.extend(teeth_key(gear, interface_radius(case, member), level));
        // A solid blank stays flexible, so that its bore counts; a holed one is rigid whatever is inside.
        key.push(gear.holes().map_or(gear.bore_radius().to_bits(), |_| 0));
        if let Some(relief) = gear.tip_relief() {
            key.extend([
                relief.amount().to_bits(),
                relief.start_radius().to_bits(),
                relief.shape() as u64,
            ]);
        }
    }
    match case.resolution.contact_solver {
        ContactSolver::ActiveSet => key.push(0),
        ContactSolver::AugmentedLagrangian {
            penalty,
            gap_tolerance,
        } => key.extend([penalty.to_bits(), gap_tolerance.to_bits()]),
    }
    key
}

fn blank_key(
    gear: &SpurGear,
    holes: Option<&HolePattern>,
    interface_radius: f64,
    level: GridLevel,
) -> Key {
    let mut key = tooth_bits(gear);
    let holes = holes.map_or([0.0; 3], |holes| {
        [f64::from(holes.count), holes.circle_radius, holes.radius]
    });
    key.extend(
        [interface_radius, gear.bore_radius()]
            .iter()
            .chain(&holes)
            .map(|number| number.to_bits()),
    );
    key.push(level as u64);
    key
}
