//! Displacement of a gear by its rotation at a steady speed: the static solution of the same bodies, whose load is the mass matrix times the radius.
//!
//! The pull is the same in all sectors, which is class 0 of the ring. A free bore lets the gear turn, which no pull does: with s > 0
//!
//! ```text
//! u ← (K + s M)⁻¹ (f + s M u)
//! ```
//!
//! starts from rest and reaches K u = f, each step by the factor s/(λ + s), λ the lowest value of a mode that is pulled.
//!
//! A solid shaft that is pressed into the bore is one more part of the blank. Its load is that of a strain in the section that it would have if nothing held it.

use std::f64::consts::TAU;

use faer::{Mat, c64};

use super::heights::{Heights, Parity};
use super::section::Blank;
use super::system::{BoreSupport, Numbering, System};
use super::teeth::{PulledTooth, TeethOrder, ToothCell};
use super::{Body, MOST_ORDERS, ModesError, WHOLE_WIDTH};
use crate::fem::FemError;
use crate::fem::eigen::Pencil;
use crate::fem::prism::COMPONENTS;
use crate::gear::{Material, SolidGear, SpurGear, Vector, radial, tangential};
use crate::grid::GridError;
use crate::run::Run;

/// Change of the last step, as a part of the displacement. A step leaves less than a tenth of the error; rounding in thin discs leaves changes of 1e-8.
const SETTLED: f64 = 1e-6;
/// Steps, at most: the lowest mode that is pulled lies far above the shift.
const MOST_STEPS: usize = 200;

/// Support of a gear while it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunningSupport {
    /// Its bore.
    Bore(BoreSupport),
    /// A solid shaft of the same material, joined to its bore: the part of it within the hub.
    Shaft,
}

/// Displacement of the teeth of a gear by loads inside it. Lengths are in meters.
#[derive(Debug, Clone)]
pub struct PulledTeeth {
    /// The roll lengths of the nodes of a loaded flank, rising.
    pub roll_lengths: Vec<f64>,
    /// Heights from the middle of the face, rising, and the share of the face that each stands for.
    pub heights: Vec<(f64, f64)>,
    /// By its rotation, for ω² = 1 in 1/s².
    pub spin: MovedTeeth,
    /// By a shaft that is larger in radius by one meter; `None` without a shaft.
    pub fit: Option<MovedTeeth>,
}

/// Displacement of the teeth of a gear by one load.
#[derive(Debug, Clone)]
pub struct MovedTeeth {
    /// How far the loaded flank of each tooth stands out along the base tangent in its transverse section: height by height, node by node.
    pub flanks: Vec<Vec<Vec<f64>>>,
    /// How far the tips move outward in the mean.
    pub tips: f64,
    /// The mean pressure of the shaft on the bore, in Pa; 0 without a shaft.
    pub pressure: f64,
}

impl PulledTeeth {
    /// Pulled teeth of `gear`, which is carried as `support` says.
    ///
    /// # Errors
    ///
    /// [`ModesError`]. A free bore does not carry the pull of holes that do not repeat around the gear, and a shaft neither.
    pub fn of(gear: &SolidGear, support: RunningSupport, run: &Run) -> Result<Self, ModesError> {
        solved(gear, (support, ToothCell::new), run, |of, solution| {
            let moved = |load: usize| {
                let amounts = [0, 1].map(|other| f64::from(u8::from(other == load)));
                let (flanks, tips) = of.flanks(solution, amounts);
                MovedTeeth {
                    flanks,
                    tips,
                    pressure: solution.pressures[load],
                }
            };
            Self {
                spin: moved(0),
                fit: (support == RunningSupport::Shaft).then(|| moved(1)),
                roll_lengths: of.cell.flank.iter().map(|(s, _)| *s).collect(),
                heights: of
                    .faces()
                    .iter()
                    .map(|height| (height.z, height.share))
                    .collect(),
            }
        })
    }
}

/// Displacement of the free edges of a gear by loads inside it: of its fillets, and of its holes.
#[derive(Debug, Clone, Default)]
pub struct PulledEdges {
    /// Both fillets of each tooth.
    pub fillets: MovedEdges,
    /// All holes.
    pub holes: MovedEdges,
}

impl PulledEdges {
    /// Edges of `gear`, which is carried as `support` says, while it turns with this ω² in 1/s² on a shaft that is larger in radius by so much in meters.
    ///
    /// # Errors
    ///
    /// As [`PulledTeeth::of`].
    pub fn of(
        gear: &SolidGear,
        support: RunningSupport,
        amounts: [f64; 2],
        run: &Run,
    ) -> Result<Self, ModesError> {
        solved(
            gear,
            (support, ToothCell::with_fillets),
            run,
            |of, solution| Self {
                fillets: of.fillets(solution, amounts),
                holes: of.holes(solution, amounts),
            },
        )
    }
}

/// Displacement of some edges of a section, all across a part of the gear.
#[derive(Debug, Clone, Default)]
pub struct MovedEdges {
    across: Across,
    sides: Vec<MovedSide>,
}

/// Functions along the axis of a part: quadratic pieces between every other one of `nodes`.
#[derive(Debug, Clone, Default)]
struct Across {
    nodes: Vec<f64>,
    /// True if the other half is the image of this one.
    is_half: bool,
}

/// A side of an element along an edge: its ends and its middle.
#[derive(Debug, Clone)]
struct MovedSide {
    /// In the frame of the gear.
    places: [Vector; 3],
    /// The displacement of each along the axes of this frame, function by function.
    moved: [Vec<[f64; COMPONENTS]>; 3],
}

impl MovedSide {
    /// How far along it, from −1 to 1, `place` stands, and how far from it.
    fn nearest(&self, place: &Vector) -> (f64, f64) {
        let [from, to, _] = self.places;
        let chord = to - from;
        let part = (place - from).dot(&chord) / chord.norm_squared();
        let xi = (2.0 * part - 1.0).clamp(-1.0, 1.0);
        let shares = along_side(xi);
        let on_it: Vector = self.places.iter().zip(shares).map(|(p, n)| n * p).sum();
        (xi, (place - on_it).norm())
    }
}

/// The shape functions of both ends of a side and of its middle.
fn along_side(xi: f64) -> [f64; 3] {
    [xi * (xi - 1.0) / 2.0, xi * (xi + 1.0) / 2.0, 1.0 - xi * xi]
}

impl MovedEdges {
    /// True if nothing moves.
    pub fn is_empty(&self) -> bool {
        self.sides.is_empty()
    }

    /// The displacement over the height from the middle of the face at the place of the edges next to `place`, along the axes of the gear.
    pub fn at(&self, place: Vector) -> impl Fn(f64) -> [f64; COMPONENTS] + '_ {
        let nearest = self.sides.iter().map(|side| (side, side.nearest(&place)));
        let nearest = nearest.min_by(|(_, one), (_, other)| one.1.total_cmp(&other.1));
        move |z| {
            let mut sum = [0.0; COMPONENTS];
            let Some((side, (xi, _))) = nearest else {
                return sum;
            };
            let (pieces, sign) = self.across.at(z);
            for (of_node, share) in side.moved.iter().zip(along_side(xi)) {
                for (function, value) in pieces {
                    for (sum, u) in sum.iter_mut().zip(of_node[function]) {
                        *sum += share * value * u;
                    }
                }
            }
            sum[2] *= sign;
            sum
        }
    }
}

impl Across {
    /// The functions that are not 0 at the height `z`, and the sign of displacements along the axis there.
    fn at(&self, z: f64) -> ([(usize, f64); 3], f64) {
        let (z, sign) = match self.is_half && z < 0.0 {
            true => (-z, -1.0),
            false => (z, 1.0),
        };
        let ends = self.nodes.iter().step_by(2);
        let pieces = ends.clone().count().saturating_sub(1);
        let below = ends.take_while(|end| **end <= z).count();
        let first = 2 * below.saturating_sub(1).min(pieces.saturating_sub(1));
        let [from, to] = [first, first + 2].map(|node| self.nodes[node]);
        let shares = along_side(2.0 * (z - from) / (to - from) - 1.0);
        let functions = [first, first + 2, first + 1];
        ([0, 1, 2].map(|i| (functions[i], shares[i])), sign)
    }
}

/// Displacement of the unknowns of class 0 by each load: rotation, and of a shaft its misfit.
struct Solution<'a> {
    numbering: Numbering,
    moved: Mat<c64>,
    /// The mean pressure on the bore.
    pressures: [f64; 2],
    /// The orders between those that are in `teeth`.
    step: usize,
    teeth: &'a Teeth,
}

/// The `answer` of `gear` to the loads inside it, carried as the first of `made` says, with teeth divided by the other.
fn solved<T>(
    gear: &SolidGear,
    (support, cell): (
        RunningSupport,
        impl FnOnce(&SpurGear, f64) -> Result<ToothCell, GridError>,
    ),
    run: &Run,
    answer: impl FnOnce(&OfGear<'_>, &Solution<'_>) -> T,
) -> Result<T, ModesError> {
    let (blank, bore) = match support {
        RunningSupport::Bore(bore) => (Blank::new(gear)?, bore),
        RunningSupport::Shaft => (Blank::on_shaft(gear)?, BoreSupport::Free),
    };
    let section = gear.section();
    let cell = cell(section, blank.parts[0].outer_radius)?;
    let body = Body {
        blank: &blank,
        teeth: Some((gear, &cell)),
        material: section.material(),
    };
    let (heights, faces) = body.heights();
    let system = System::new(&blank.section, &heights, &faces, body.material, bore);
    let on_teeth = cell.system(&heights, section, gear.face_heights());
    let parity = heights.parities()[0];
    let largest = body.largest_order();
    let step = blank.section.sectors.max(1);
    let z = section.tooth_count() as usize;
    let mut teeth = Vec::new();
    for order in (0..=largest).step_by(step) {
        run.check().map_err(FemError::from)?;
        let own = TeethOrder::new(&on_teeth, parity, order as i64)?;
        // The pull has the orders in which the teeth repeat.
        let pulled = order.is_multiple_of(z).then(|| own.pulled(&on_teeth));
        teeth.push((own, pulled.transpose()?));
    }
    let fitted = (support == RunningSupport::Shaft).then(|| section.bore_radius());
    let (numbering, moved) = body.pulled((&system, parity), (step, &teeth), fitted, run)?;
    let pressures = match fitted {
        Some(radius) => body.pressures(&system, (&numbering, &moved), radius),
        None => [0.0; 2],
    };
    let of_gear = OfGear {
        gear,
        blank: &blank,
        system: &system,
        cell: &cell,
        on_teeth: &on_teeth,
        heights: &heights,
    };
    let solution = Solution {
        numbering,
        moved,
        pressures,
        step,
        teeth: &teeth,
    };
    Ok(answer(&of_gear, &solution))
}

/// Seconds of one core for an order of teeth, for the class of sectors with holes that is pulled, and for a gear without symmetry, of half a gear that is its own
/// image in the middle of its face. Measured on gears of 50 teeth.
const SECONDS: [f64; 3] = [0.05, 0.3, 12.5];

/// Seconds of one core, and bytes, that [`PulledTeeth::of`] takes for `gear`, about.
pub fn estimate(gear: &SolidGear) -> [f64; 2] {
    let section = gear.section();
    let faces: Vec<[f64; 2]> = gear.layers().iter().map(|part| part.heights).collect();
    let times = match Heights::new(&faces, f64::INFINITY).is_half {
        true => 1.0,
        false => WHOLE_WIDTH,
    };
    let [per_order, per_class, whole] = SECONDS;
    let (orders, class) = match section.hole_pattern() {
        Some(pattern) => (1 + MOST_ORDERS / pattern.count as usize, per_class),
        None if section.has_holes() => (1 + MOST_ORDERS, whole),
        None => (1, per_class),
    };
    let [_, bytes] = super::estimate(gear);
    [times * (per_order * orders as f64 + class), bytes]
}

type Teeth = [(TeethOrder, Option<PulledTooth>)];

impl Body<'_> {
    /// The unknowns of class 0 of `system`, and their displacement under the pull of rotation, and under the misfit of a shaft of the radius `fitted`; `teeth` are
    /// those of the orders 0, `step`, 2 `step` ….
    fn pulled(
        &self,
        (system, parity): (&System<'_>, Parity),
        (step, teeth): (usize, &Teeth),
        fitted: Option<f64>,
        run: &Run,
    ) -> Result<(Numbering, Mat<c64>), FemError> {
        run.check()?;
        let of_order = |order: i64| teeth.get(order.unsigned_abs() as usize / step);
        let (numbering, entries) = self.assembled(system, (parity, 0), |order| {
            of_order(order).map(|(own, _)| own)
        });
        let mut loads = Mat::<c64>::zeros(numbering.count, 2);
        loads.subcols_mut(0, 1).copy_from(system.pull(&numbering));
        let size = numbering.amplitude_size();
        for (k, order) in numbering.orders.iter().enumerate() {
            let Some((_, Some(pulled))) = of_order(*order) else {
                continue;
            };
            let share = self.teeth_in_sector();
            for i in 0..size {
                let on_circle = pulled.on_circle[(i, 0)] * share;
                loads[(numbering.first_amplitude + k * size + i, 0)] += match *order < 0 {
                    true => on_circle.conj(),
                    false => on_circle,
                };
            }
        }
        if let Some(radius) = fitted {
            let innermost = self.blank.parts.len() - 1;
            let swollen = system.swollen(&numbering, innermost, radius);
            loads.subcols_mut(1, 1).copy_from(swollen);
        }
        let pencil = Pencil::new(numbering.count, &entries);
        let shift = self.shift();
        let factor = pencil.factor("the gear", shift)?;
        let mut moved = Mat::<c64>::zeros(numbering.count, 2);
        for _ in 0..MOST_STEPS {
            run.check()?;
            let mut next = &loads + pencil.mass_times(&moved) * faer::Scale(c64::new(shift, 0.0));
            factor.solve_in_place(&mut next);
            let change = &next - &moved;
            moved = next;
            let is_settled =
                |load: usize| change.col(load).norm_l2() <= SETTLED * moved.col(load).norm_l2();
            if (0..2).all(is_settled) {
                return Ok((numbering, moved));
            }
        }
        Err(FemError::NotPositiveDefinite {
            part: "a free gear whose holes do not repeat around it",
            unknowns: numbering.count,
        })
    }

    /// The mean pressure under each load of a shaft on a bore of this `radius`: E/((1 − ν) r) for each meter by which the shaft is pressed together.
    fn pressures(
        &self,
        system: &System<'_>,
        (numbering, moved): (&Numbering, &Mat<c64>),
        radius: f64,
    ) -> [f64; 2] {
        let Material {
            youngs_modulus: e,
            poisson_ratio: nu,
            density,
            ..
        } = *self.material;
        // A free disc that rotates grows by (1 − ν) ρ ω² r³/(4 E).
        let free = [(1.0 - nu) * density * radius.powi(3) / (4.0 * e), 1.0];
        [0, 1].map(|load| {
            let column = moved.subcols(load, 1).to_owned();
            let outward = system.mean_outward(numbering, &column, radius);
            e / ((1.0 - nu) * radius) * (free[load] - outward)
        })
    }
}

/// A gear, to be asked how it moves.
struct OfGear<'a> {
    gear: &'a SolidGear,
    blank: &'a Blank,
    system: &'a System<'a>,
    cell: &'a ToothCell,
    on_teeth: &'a System<'a>,
    heights: &'a Heights,
}

/// Displacements of some nodes of a cell of teeth by each order that is not negative: function by function, node by node. Those of the opposite orders are
/// conjugate.
type ByOrder = Vec<(i64, Vec<Vec<[c64; COMPONENTS]>>)>;

impl OfGear<'_> {
    /// Displacements of `nodes` of a cell of teeth under so much of each load.
    fn by_order(&self, solution: &Solution<'_>, amounts: [f64; 2], nodes: &[u32]) -> ByOrder {
        let Solution {
            numbering,
            moved,
            step,
            teeth,
            ..
        } = solution;
        let size = numbering.amplitude_size();
        let mut parts = Vec::new();
        for (k, order) in numbering.orders.iter().enumerate() {
            if *order < 0 {
                continue;
            }
            let (own, pulled) = &teeth[*order as usize / step];
            let first = numbering.first_amplitude + k * size;
            let amplitude = Mat::from_fn(size, 1, |i, _| {
                let [spin, fit] = [0, 1].map(|load| moved[(first + i, load)] * amounts[load]);
                spin + fit
            });
            let mut all = own.moved(amplitude);
            if *order == 0
                && let Some(pulled) = pulled
            {
                for i in 0..pulled.held.nrows() {
                    all[(i, 0)] += pulled.held[(i, 0)] * amounts[0];
                }
            }
            parts.push((*order, self.at_nodes(&own.numbering, &all, nodes)));
        }
        parts
    }

    /// The displacement of a function at a node of those that have `parts`, in polar components, where the cell has turned by `angle`.
    fn of_tooth(parts: &ByOrder, angle: f64, (index, node): (usize, usize)) -> [f64; COMPONENTS] {
        let mut sum = [0.0; COMPONENTS];
        for (order, of) in parts {
            let turn = c64::cis(*order as f64 * angle);
            let share = if *order == 0 { 1.0 } else { 2.0 };
            for (sum, u) in sum.iter_mut().zip(of[index][node]) {
                *sum += share * (u * turn).re;
            }
        }
        sum
    }

    /// The angle of `tooth` in the frame of the gear, and in that of the blank.
    fn angles(&self, tooth: u32) -> [f64; 2] {
        let angle = TAU * f64::from(tooth) / f64::from(self.gear.section().tooth_count());
        [angle, angle - self.blank.phase]
    }

    /// How far the flanks of all teeth stand out under so much of each load, and how far the tips move outward in the mean.
    fn flanks(&self, solution: &Solution<'_>, amounts: [f64; 2]) -> (Vec<Vec<Vec<f64>>>, f64) {
        let section = self.gear.section();
        let nodes: Vec<u32> = self.cell.flank.iter().map(|(_, node)| *node).collect();
        let parts = self.by_order(solution, amounts, &nodes);
        let heights = self.faces();
        let z = section.tooth_count();
        let axes = self.axes(section);
        let last = nodes.len() - 1;
        let mut tips = 0.0;
        let flanks = (0..z).map(|tooth| {
            let [_, angle] = self.angles(tooth);
            let rows = heights.iter().map(|height| {
                let rows = axes.iter().enumerate().map(|(node, axes)| {
                    let [r, t, along] = Self::of_tooth(&parts, angle, (height.index, node));
                    if node == last {
                        tips += height.share * r / f64::from(z);
                    }
                    axes[0] * r + axes[1] * t + axes[2] * height.side * along
                });
                rows.collect()
            });
            rows.collect()
        });
        (flanks.collect(), tips)
    }

    /// The fillets of all teeth under so much of each load.
    fn fillets(&self, solution: &Solution<'_>, amounts: [f64; 2]) -> MovedEdges {
        let [first, count] = self.on_teeth.span_of_arc();
        let grid = &self.cell.section.grid;
        let mut sides = Vec::new();
        for edge in &self.cell.fillets {
            let parts = self.by_order(solution, amounts, edge);
            for tooth in 0..self.gear.section().tooth_count() {
                let [angle, of_blank] = self.angles(tooth);
                let nodes = edge.iter().enumerate().map(|(i, node)| {
                    let place = turned(grid.nodes[*node as usize], angle);
                    let moved = (0..count)
                        .map(|index| in_axes(place, Self::of_tooth(&parts, of_blank, (index, i))));
                    (place, moved.collect())
                });
                add_sides(&mut sides, &nodes.collect::<Vec<_>>(), false);
            }
        }
        MovedEdges {
            across: self.across([first, count]),
            sides,
        }
    }

    /// The edges of all holes under so much of each load.
    fn holes(&self, solution: &Solution<'_>, amounts: [f64; 2]) -> MovedEdges {
        let section = &self.blank.section;
        let Some(node) = section.hole_edges.iter().flatten().next() else {
            return MovedEdges::default();
        };
        let [first, count] = self.system.span_of(*node);
        let moved = &solution.moved;
        let of = Mat::from_fn(moved.nrows(), 1, |i, _| {
            moved[(i, 0)] * amounts[0] + moved[(i, 1)] * amounts[1]
        });
        let mut sides = Vec::new();
        for sector in 0..section.sectors {
            // All is alike in all sectors.
            let turn = self.blank.phase + TAU * sector as f64 / section.sectors as f64;
            for edge in &section.hole_edges {
                let nodes = edge.iter().map(|node| {
                    let place = turned(section.grid.nodes[*node as usize], turn);
                    let moved = (0..count).map(|index| {
                        let at = |c| (*node, c, first + index);
                        let polar = [0, 1, 2]
                            .map(|c| self.system.displacement(&solution.numbering, &of, at(c)).re);
                        in_axes(place, polar)
                    });
                    (place, moved.collect())
                });
                add_sides(&mut sides, &nodes.collect::<Vec<_>>(), true);
            }
        }
        MovedEdges {
            across: self.across([first, count]),
            sides,
        }
    }

    /// The functions along the axis of a span of them.
    fn across(&self, [first, count]: [usize; 2]) -> Across {
        Across {
            nodes: self.heights.nodes[first..first + count].to_vec(),
            is_half: self.heights.is_half,
        }
    }

    /// The displacement of `nodes` where the unknowns of a cell have `moved`: function by function, node by node.
    fn at_nodes(
        &self,
        numbering: &Numbering,
        moved: &Mat<c64>,
        nodes: &[u32],
    ) -> Vec<Vec<[c64; COMPONENTS]>> {
        let [first, count] = self.on_teeth.span_of_arc();
        let of_node = |index: usize, node: u32| {
            [0, 1, 2].map(|c| {
                self.on_teeth
                    .displacement(numbering, moved, (node, c, first + index))
            })
        };
        let rows = (0..count).map(|index| {
            let of_nodes = nodes.iter().map(|node| of_node(index, *node));
            of_nodes.collect()
        });
        rows.collect()
    }

    /// Parts of a displacement (radial, tangential, axial) at the nodes of the flank that it stands out by in its section: n and −tan β_b.
    fn axes(&self, section: &SpurGear) -> Vec<[f64; COMPONENTS]> {
        let flank = section.flank();
        let along = -self.gear.twist() * flank.base_radius();
        let nodes = self.cell.flank.iter().map(|(s, node)| {
            let place = self.cell.section.grid.nodes[*node as usize];
            let (angle, normal) = (place.y.atan2(place.x), flank.normal(*s));
            [
                normal.dot(&radial(angle)),
                normal.dot(&tangential(angle)),
                along,
            ]
        });
        nodes.collect()
    }

    /// The heights of the face.
    fn faces(&self) -> Vec<Height> {
        let part = self.heights.part(self.gear.face_heights());
        let share = |p: usize| -> f64 { (0..part.count()).map(|q| part.products[(p, q)]).sum() };
        let width: f64 = (0..part.count()).map(share).sum();
        let own = (0..part.count()).map(|index| Height {
            index,
            z: self.heights.nodes[part.first + index],
            share: share(index) / width,
            side: 1.0,
        });
        let own: Vec<Height> = own.collect();
        if !self.heights.is_half {
            return own;
        }
        // The other half is the image of this one.
        let halved = |height: &Height, side: f64| Height {
            z: side * height.z,
            share: height.share / 2.0,
            side,
            ..*height
        };
        let middle = own[0];
        let below = own[1..].iter().rev().map(|height| halved(height, -1.0));
        let above = own[1..].iter().map(|height| halved(height, 1.0));
        below.chain([middle]).chain(above).collect()
    }
}

/// Adds the sides along an edge of these nodes, corners and middles in turn: their places, and their displacements function by function.
fn add_sides(
    sides: &mut Vec<MovedSide>,
    nodes: &[(Vector, Vec<[f64; COMPONENTS]>)],
    is_closed: bool,
) {
    let last = nodes.len() - usize::from(!is_closed);
    for start in (0..last).step_by(2) {
        let of_side = [start, start + 2, start + 1].map(|i| &nodes[i % nodes.len()]);
        sides.push(MovedSide {
            places: of_side.map(|(place, _)| *place),
            moved: of_side.map(|(_, moved)| moved.clone()),
        });
    }
}

/// `place` turned by `angle`.
fn turned(place: Vector, angle: f64) -> Vector {
    let [along, across] = [radial(angle), tangential(angle)];
    place.x * along + place.y * across
}

/// Polar components of a displacement at `place` along the axes of its frame.
fn in_axes(place: Vector, [r, t, along]: [f64; COMPONENTS]) -> [f64; COMPONENTS] {
    let angle = place.y.atan2(place.x);
    let flat = r * radial(angle) + t * tangential(angle);
    [flat.x, flat.y, along]
}

/// A height of the face.
#[derive(Debug, Clone, Copy)]
struct Height {
    /// Its function.
    index: usize,
    z: f64,
    /// The share of the face.
    share: f64,
    /// −1 on the image of the half that was solved.
    side: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::Layer;

    /// The radial displacement of a thin annulus from 20 to 50 mm at its bore and outside, under each load, and the pressures on the bore.
    fn loaded(bore: BoreSupport, is_on_shaft: bool, material: &Material) -> [[f64; 3]; 2] {
        let heights = [-0.1e-3, 0.1e-3];
        let part = |inner_radius: f64, outer_radius: f64| Layer {
            inner_radius,
            outer_radius,
            heights,
        };
        let mut parts = vec![part(20e-3, 50e-3)];
        if is_on_shaft {
            parts.push(part(0.08e-3, 20e-3));
        }
        let blank = Blank::of_parts(parts, 24);
        let body = Body {
            blank: &blank,
            teeth: None,
            material,
        };
        let (heights, faces) = body.heights();
        let system = System::new(&blank.section, &heights, &faces, body.material, bore);
        let parity = heights.parities()[0];
        let fitted = is_on_shaft.then_some(20e-3);
        let (numbering, moved) = body
            .pulled((&system, parity), (24, &[]), fitted, &Run::unattended())
            .expect("sound");
        let pressures = body.pressures(&system, (&numbering, &moved), 20e-3);
        [0, 1].map(|load| {
            let column = moved.subcols(load, 1).to_owned();
            let outside = system.in_middle(&numbering, &column, blank.section.arc[0])[0].re;
            let bore = system.mean_outward(&numbering, &column, 20e-3);
            [bore, outside, pressures[load]]
        })
    }

    /// The same by rotation at both circles, without a shaft.
    fn annulus(bore: BoreSupport, material: &Material) -> [f64; 2] {
        let [[bore, outside, _], _] = loaded(bore, false, material);
        [bore, outside]
    }

    #[test]
    fn a_shaft_presses_an_annulus_out_as_lame_has_it_and_turns_with_it_as_a_disc() {
        // Of one material, for an interference of 1 in radius: p = E (b² − a²)/(2 a b²), and b moves out by a/b. In one piece both turn as a disc,
        // u = (1 − ν) ρ b³/(4 E), and the bore loses ρ (3 + ν)/8 (b² − a²) of its pressure.
        let (a, b) = (20e-3_f64, 50e-3_f64);
        // Shaft and annulus become unlike in thickness, and are joined: that reaches over the elements beside the bore, however thin both are.
        for (poisson_ratio, within) in [(Material::STEEL.poisson_ratio, 5e-3), (0.0, 1e-4)] {
            let material = Material {
                poisson_ratio,
                ..Material::STEEL
            };
            let Material {
                youngs_modulus: e,
                poisson_ratio: nu,
                density: rho,
                ..
            } = material;
            let [[_, turned, lost], [bore, fitted, pressure]] =
                loaded(BoreSupport::Free, true, &material);
            let expected = e * (b * b - a * a) / (2.0 * a * b * b);
            let at_bore = 1.0 - (1.0 - nu) * a * expected / e;
            for (found, expected) in [
                (fitted, a / b),
                (pressure, expected),
                (bore, at_bore),
                (turned, (1.0 - nu) * rho * b.powi(3) / (4.0 * e)),
                (lost, -rho * (3.0 + nu) / 8.0 * (b * b - a * a)),
            ] {
                println!("{nu}: {found:e} {expected:e} {:e}", found / expected - 1.0);
                assert!(
                    (found / expected - 1.0).abs() < within,
                    "{nu}: {found:e} {expected:e}"
                );
            }
        }
    }

    #[test]
    fn a_rotating_annulus_moves_as_its_closed_form_does() {
        // u = (1 − ν²)/E (A r + B/r − ρ r³/8), σ_r = E/(1 − ν²)(u' + ν u/r): no stress at a free edge, no displacement at a held one.
        let (a, b) = (20e-3_f64, 50e-3_f64);
        // A held bore does not become thinner either, and that reaches over the elements beside it, however thin the annulus is; without Poisson's ratio
        // there is nothing to hold.
        for (poisson_ratio, of_held) in [(Material::STEEL.poisson_ratio, 5e-3), (0.0, 1e-4)] {
            let material = Material {
                poisson_ratio,
                ..Material::STEEL
            };
            let Material {
                youngs_modulus: e,
                poisson_ratio: nu,
                density,
                ..
            } = material;
            let free = |r: f64| {
                let (one, more) = (1.0 - nu, (1.0 + nu) * a * a * b * b / (r * r));
                density / (8.0 * e) * (3.0 + nu) * r * (one * (a * a + b * b) + more)
                    - density / (8.0 * e) * (1.0 - nu * nu) * r.powi(3)
            };
            let moved = annulus(BoreSupport::Free, &material);
            for (found, radius) in moved.into_iter().zip([a, b]) {
                let expected = free(radius);
                assert!(
                    (found / expected - 1.0).abs() < 1e-4,
                    "{found:e} {expected:e}"
                );
            }
            // Held at a: (1 + ν) A − (1 − ν) B/b² = ρ (3 + ν) b²/8 and A a + B/a = ρ a³/8.
            let (p, q) = (
                density * (3.0 + nu) * b * b / 8.0,
                density * a.powi(4) / 8.0,
            );
            let c_b =
                ((1.0 + nu) * q / (a * a) - p) / ((1.0 + nu) / (a * a) + (1.0 - nu) / (b * b));
            let c_a = (q - c_b) / (a * a);
            let expected = (1.0 - nu * nu) / e * (c_a * b + c_b / b - density * b.powi(3) / 8.0);
            let [at_bore, at_rim] = annulus(BoreSupport::Held, &material);
            assert!(
                at_bore == 0.0 && (at_rim / expected - 1.0).abs() < of_held,
                "{at_rim:e} {expected:e}"
            );
        }
    }
}
