//! Effect of holes on the compliance of flanks: a change of few unknowns, those of the web's outer circle.
//!
//! With the web's stiffness S + ΔS instead of S, C the compliance of the whole gear without holes on that circle and q_j its answer to
//! tooth j, teeth yield to each other by −q_iᵀ (I + ΔS C)⁻¹ ΔS q_j more. Teeth, rim and plain web stay as they are.

use std::f64::consts::TAU;

use faer::linalg::solvers::Solve as _;
use faer::{Mat, c64};

use rayon::prelude::*;

use super::PartError;
use super::amplitudes::{Amplitudes, RoundForm, block, put_rows, rows_of, sets_of_orders, turned};
use super::stack::{Stack, WebPorts, repeats_of, unknowns_of_holes};
use crate::fem::FemError;
use crate::fem::axial::AxialBasis;
use crate::fem::dense::entries;
use crate::fem::prism::{COMPONENTS, CondensationCost, Prism};
use crate::gear::{BlankRegion, Core, Hole, Ligament, Material, SpurGear};
use crate::grid::{BlankGrid, GridLevel};
use crate::ring::cyclic::Harmonics;
use crate::ring::solid::gear::ClassAnswers;
use crate::ring::solid::revolution::add_block;
use crate::ring::solid::web::{HoledRing, conjugate_below_zero, of_order};
use crate::run::Run;

/// Elements around the web for each order in which holes are taken into account; high orders need two for a wavelength.
const ELEMENTS_PER_ORDER: f64 = 5.0;
const USUAL_ELEMENTS: f64 = 70.0;
const ELEMENTS_PER_HIGH_ORDER: f64 = 2.0;
/// The thinnest ligament, in half widths of the narrowest hole, whose bending a coarse grid follows: thinner ones are divided twice as finely.
const THIN: f64 = 0.35;
/// Answers of a circle that differ from sums of others by less than this part of the largest are these sums.
const DEPENDENT: f64 = 1e-13;

/// The outer circle of a web as the teeth see it, while the web has no holes.
#[derive(Debug)]
pub(crate) struct WebInterface {
    /// The largest order in which holes are seen.
    largest: usize,
    /// The unknowns of a component of an order.
    size: usize,
    tooth_count: usize,
    /// S: the stiffness of the web without holes, of the orders 0 ….
    plain: Vec<Mat<c64>>,
    /// C: the compliance of the whole gear on the circle.
    compliance: RoundForm,
    /// q: the answer of the circle to the functions on the flank of tooth 0.
    answers: Mat<f64>,
    /// How the circle follows the interface circle, of the orders 0 ….
    follows: Vec<Mat<c64>>,
}

/// Effect of holes on the compliance of flanks.
#[derive(Debug, Clone)]
pub(crate) struct HoledChange {
    tooth_count: usize,
    largest: usize,
    size: usize,
    /// Independent answers of the circle to loads on tooth 0, a column each.
    answers: Mat<f64>,
    /// The part of each in the answer to each function on the flank.
    shares: Mat<f64>,
    /// −(I + ΔS C)⁻¹ ΔS times the independent answers, of the teeth after which all repeats.
    changes: Vec<Mat<f64>>,
}

impl WebInterface {
    /// Of a gear whose web is seen through `web` and answers to its teeth as in `classes`. `onto` makes rows for the functions on a
    /// flank of columns for its nodes.
    pub(crate) fn new(
        web: WebPorts,
        tooth_count: usize,
        classes: &[ClassAnswers],
        onto: &dyn Fn(&Mat<c64>) -> Mat<c64>,
    ) -> Self {
        let largest = web.largest;
        let size = web.of[0].plain.nrows();
        // Of tooth 0, on the orders of both signs.
        let share = 1.0 / tooth_count as f64;
        let of_class = |class: &ClassAnswers| {
            let orders = Harmonics { largest }.orders_of_class(class.class, tooth_count);
            let mut compliance = Mat::<c64>::zeros(orders.len() * size, orders.len() * size);
            let place = |order: &i64| orders.iter().position(|own| own == order);
            let inner = class.circle.nrows() / class.orders.len().max(1);
            let follows = |order: &i64| {
                conjugate_below_zero(&web.of[order.unsigned_abs() as usize].follows, *order)
            };
            let follows: Vec<Mat<c64>> = class.orders.iter().map(follows).collect();
            for (a, n) in class.orders.iter().enumerate() {
                for (b, m) in class.orders.iter().enumerate() {
                    let (Some(row), Some(column)) = (place(n), place(m)) else {
                        continue;
                    };
                    let between = class
                        .compliance
                        .submatrix(a * inner, b * inner, inner, inner);
                    let block = &follows[a] * between * follows[b].adjoint();
                    let mut sum = compliance.submatrix_mut(row * size, column * size, size, size);
                    sum += block * faer::Scale(c64::new(share, 0.0));
                }
            }
            // For orders that the interface circle does not have, it is held.
            for (k, order) in orders.iter().enumerate() {
                let held = &web.of[order.unsigned_abs() as usize].held;
                add_block(
                    &mut compliance,
                    k * size,
                    &conjugate_below_zero(held, *order),
                );
            }
            (orders, compliance)
        };
        let of_classes = classes.iter().map(of_class);
        let compliance = RoundForm::new(of_classes, size, Amplitudes::Forces);
        let (plain, follows) = web
            .of
            .into_iter()
            .map(|port| (port.plain, port.follows))
            .unzip();
        let mut seen = Self {
            compliance,
            answers: Mat::zeros(0, 0),
            plain,
            follows,
            largest,
            size,
            tooth_count,
        };
        let circles = classes
            .iter()
            .map(|class| (class.orders.as_slice(), &class.circle));
        seen.answers = seen.answers_to(circles, onto);
        seen
    }

    /// The largest order in which holes are seen.
    pub(crate) fn largest(&self) -> usize {
        self.largest
    }

    /// Force of `order`, given as that of its absolute value, on the web's outer circle, transferred to the interface circle.
    pub(crate) fn on_interface(&self, order: i64, force: &Mat<c64>) -> Mat<c64> {
        let on = self.follows[order.unsigned_abs() as usize].adjoint() * force;
        conjugate_below_zero(&on, order)
    }

    /// The response of the web's outer circle to the `circles` of the interface circle: orders of each class, and their response to functions on tooth 0.
    /// `onto` makes rows for other functions from columns for these.
    pub(crate) fn answers_to<'a>(
        &self,
        circles: impl Iterator<Item = (&'a [i64], &'a Mat<c64>)>,
        onto: &dyn Fn(&Mat<c64>) -> Mat<c64>,
    ) -> Mat<f64> {
        let &Self { largest, size, .. } = self;
        let place = |order: i64| (order + largest as i64) as usize * size;
        let share = 1.0 / self.tooth_count as f64;
        let unknowns = (2 * largest + 1) * size;
        let mut answers = Mat::<c64>::zeros(unknowns, 0);
        for (orders, circle) in circles {
            let inner = circle.nrows() / orders.len().max(1);
            for (a, &n) in orders.iter().enumerate() {
                let follows = of_order(&self.follows, n);
                let answer = onto(&(follows * circle.subrows(a * inner, inner)));
                answers.resize_with(unknowns, answer.nrows(), |_, _| c64::new(0.0, 0.0));
                for j in 0..answer.nrows() {
                    for i in 0..size {
                        let value = answer[(j, i)] * share;
                        answers[(place(n) + i, j)] = value;
                        answers[(place(-n) + i, j)] = value.conj();
                    }
                }
            }
        }
        rows_on_real(&answers, largest, size)
    }

    /// The number of entries, for the size limit of the cache.
    pub(crate) fn entries(&self) -> usize {
        let plain: usize = self
            .plain
            .iter()
            .map(|of| 2 * of.nrows() * of.ncols())
            .sum();
        let follows: usize = self
            .follows
            .iter()
            .map(|of| 2 * of.nrows() * of.ncols())
            .sum();
        plain + follows + self.compliance.entries() + entries(&self.answers)
    }
}

impl HoledChange {
    /// Of the holes of `section`, whose gear is otherwise that of `stack` and sees its web as `web`.
    pub(crate) fn new(
        stack: &Stack,
        section: &SpurGear,
        web: &WebInterface,
        run: &Run,
    ) -> Result<Self, PartError> {
        let &WebInterface {
            largest,
            size,
            tooth_count: z,
            ..
        } = web;
        let [answers, shares] = independent(&web.answers);
        let holed = HoledSection::new(stack, section, largest)?;
        let mut change = holed.ring(&[], run)?.on_outer(holed.phase, run)?;
        for class in &mut change {
            for (k, order) in class.orders.iter().enumerate() {
                let plain = -of_order(&web.plain, *order);
                add_block(&mut class.stiffness, k * size, &plain);
            }
        }
        let change = change.into_iter().map(|of| (of.orders, of.stiffness));
        let change = RoundForm::new(change, size, Amplitudes::Motions);
        let repeats = repeats_of(section);
        let known = z / repeats;
        let of_set = |orders: &Vec<usize>| {
            run.check()?;
            let change = change.on(orders);
            let coupled = Mat::<f64>::identity(change.nrows(), change.nrows())
                + web.compliance.after(&change, orders);
            let factor = coupled.partial_piv_lu();
            let own = rows_of(&answers, orders, size);
            let turned = |tooth: usize| {
                let angle = TAU * tooth as f64 / z as f64;
                turned(&own, orders.iter().copied(), size, angle)
            };
            if known * own.ncols() > change.nrows() {
                let of_motion = -factor.solve(change);
                return Ok((0..known).map(|tooth| &of_motion * turned(tooth)).collect());
            }
            let of_tooth = |tooth| -factor.solve(&change * turned(tooth));
            Ok((0..known).map(of_tooth).collect())
        };
        let sets = sets_of_orders(largest, repeats);
        let of_sets: Vec<Vec<Mat<f64>>> = sets
            .par_iter()
            .map(of_set)
            .collect::<Result<_, PartError>>()?;
        let mut changes = vec![Mat::zeros(answers.nrows(), answers.ncols()); known];
        for (orders, of_set) in sets.iter().zip(&of_sets) {
            for (change, rows) in changes.iter_mut().zip(of_set) {
                put_rows(change, rows, orders, size);
            }
        }
        Ok(Self {
            tooth_count: z,
            largest,
            size,
            changes,
            answers,
            shares,
        })
    }

    /// The teeth after which all repeats.
    pub(crate) fn repeats_after(&self) -> usize {
        self.changes.len()
    }

    /// The mean over the teeth: axisymmetric.
    pub(crate) fn round_average(&self) -> Self {
        let share = 1.0 / self.changes.len() as f64;
        let mut mean = Mat::zeros(self.answers.nrows(), self.answers.ncols());
        for (tooth, change) in self.changes.iter().enumerate() {
            let back = -TAU * tooth as f64 / self.tooth_count as f64;
            mean += self.turned(change, back) * share;
        }
        Self {
            changes: vec![mean],
            ..self.clone()
        }
    }

    /// `amplitudes` of all orders, turned by `angle`.
    fn turned(&self, amplitudes: &Mat<f64>, angle: f64) -> Mat<f64> {
        turned(amplitudes, 0..=self.largest, self.size, angle)
    }

    /// Further compliance of tooth `i` under the functions of tooth `j`.
    pub(crate) fn between(&self, i: usize, j: usize) -> Mat<f64> {
        let (z, known) = (self.tooth_count, j % self.changes.len());
        let seen = (i + z - (j - known)) % z;
        let turned = self.turned(&self.answers, TAU * seen as f64 / z as f64);
        let between = turned.transpose() * &self.changes[known];
        self.shares.transpose() * between * &self.shares
    }

    /// The parts of the independent answers in that to a load on the functions of a flank.
    fn shares_of(&self, load: &[f64]) -> Mat<f64> {
        &self.shares * Mat::from_fn(load.len(), 1, |i, _| load[i])
    }

    /// The forces on the web's outer circle by which holes act like a change of the web, under loads on the functions of some teeth, each
    /// with its number.
    pub(crate) fn forces(&self, loads: &[(usize, &[f64])]) -> Vec<f64> {
        let mut sum = Mat::zeros(self.answers.nrows(), 1);
        for (tooth, load) in loads {
            let known = tooth % self.changes.len();
            let load = self.shares_of(load);
            let ahead = TAU * (tooth - known) as f64 / self.tooth_count as f64;
            sum += self.turned(&(&self.changes[known] * load), ahead);
        }
        sum.col_as_slice(0).to_vec()
    }

    /// How the web's outer circle moves under `loads`, as in [`HoledChange::forces`], in amplitudes a_0, a_1, b_1, … from tooth 0; `web` is that
    /// without holes.
    pub(crate) fn circle(&self, web: &WebInterface, loads: &[(usize, &[f64])]) -> Vec<f64> {
        let forces = self.forces(loads);
        let forces = Mat::from_fn(forces.len(), 1, |i, _| forces[i]);
        let mut moved = web.compliance.times(&forces);
        for (tooth, load) in loads {
            let load = self.shares_of(load);
            let angle = TAU * *tooth as f64 / self.tooth_count as f64;
            moved += self.turned(&(&self.answers * load), angle);
        }
        moved.col_as_slice(0).to_vec()
    }

    /// Forces on the web's outer circle as tooth `tooth` sees them.
    pub(crate) fn seen_from(&self, tooth: usize, forces: &[f64]) -> Vec<f64> {
        let forces = Mat::from_fn(forces.len(), 1, |i, _| forces[i]);
        let back = -TAU * tooth as f64 / self.tooth_count as f64;
        self.turned(&forces, back).col_as_slice(0).to_vec()
    }

    /// The number of entries, for the size limit of the cache.
    pub(crate) fn entries(&self) -> usize {
        entries(&self.answers) * (1 + self.changes.len()) + entries(&self.shares)
    }
}

/// Orthogonal columns of which those of `answers` are sums but for [`DEPENDENT`] parts, and the part of each in each answer.
fn independent(answers: &Mat<f64>) -> [Mat<f64>; 2] {
    let parted = answers.col_piv_qr();
    let triangle = parted.thin_R();
    // They fall.
    let sizes: Vec<f64> = (0..triangle.nrows())
        .map(|i| triangle[(i, i)].abs())
        .collect();
    let count = sizes.partition_point(|size| *size > DEPENDENT * sizes[0]);
    let columns = parted.compute_thin_Q().subcols(0, count).to_owned();
    let shares = columns.transpose() * answers;
    [columns, shares]
}

/// The section of a web with its holes, and its support.
pub(super) struct HoledSection {
    pub(super) grid: BlankGrid,
    /// Where hole 0 of a pattern stands.
    pub(super) phase: f64,
    /// The largest order that its circles are asked for.
    largest: usize,
    /// Stiffness under each order 0 … of its inner circle; `None` where that is held.
    hub: Option<Vec<Mat<c64>>>,
    material: Material,
    axial: AxialBasis,
}

impl HoledSection {
    /// The web of `section`, whose gear is otherwise that of `stack`, for the orders up to `largest`.
    pub(super) fn new(
        stack: &Stack,
        section: &SpurGear,
        largest: usize,
    ) -> Result<Self, PartError> {
        let (grid, phase) = holed_grid(stack, section, largest)?;
        let hub = (0..=largest)
            .map(|order| stack.below(1, order, 0.0))
            .collect::<Result<Option<Vec<_>>, _>>()?;
        Ok(Self {
            grid,
            phase,
            largest,
            hub,
            material: *section.material(),
            axial: stack.across[1].clone(),
        })
    }

    /// The web as a prism.
    pub(super) fn prism(&self) -> Prism<'_> {
        Prism {
            grid: &self.grid.grid,
            material: &self.material,
            twist: 0.0,
            axial: &self.axial,
        }
    }

    /// The ring of it, which can be asked how the nodes `recovered` move.
    pub(super) fn ring(&self, recovered: &[u32], run: &Run) -> Result<HoledRing<'_>, FemError> {
        let asked = (self.largest, recovered);
        HoledRing::new(&self.grid, &self.prism(), self.hub.as_deref(), asked, run)
    }
}

/// The grid of the web of `section` for the orders up to `largest`, and where hole 0 of a pattern stands.
fn holed_grid(
    stack: &Stack,
    section: &SpurGear,
    largest: usize,
) -> Result<(BlankGrid, f64), PartError> {
    let layer = &stack.layers[1];
    let region = BlankRegion {
        bore_radius: layer.inner_radius,
        core: Core::Bore,
        web: None,
        ..section.data().blank.clone()
    };
    let z = section.tooth_count();
    let orders = largest as f64;
    let around = (ELEMENTS_PER_ORDER * orders)
        .min(USUAL_ELEMENTS)
        .max(ELEMENTS_PER_HIGH_ORDER * orders);
    let widths = region.holes.iter().map(Hole::half_width);
    let narrowest = widths.fold(f64::INFINITY, f64::min);
    let is_thin = |(_, least): (Ligament, f64)| least < THIN * narrowest;
    let least = region.least_ligament(layer.outer_radius);
    // The nodes of its circles stay as many as their orders need.
    let (level, nodes) = match (least.is_some_and(is_thin), stack.sections) {
        (true, GridLevel::Fine) => (GridLevel::Fine, 0.5),
        (true, _) | (false, GridLevel::Fine) => (GridLevel::Standard, 1.0),
        (false, _) => (GridLevel::Coarse, 2.0),
    };
    let grid = BlankGrid::of_region(
        &region,
        section.face_width(),
        layer.outer_radius,
        z,
        nodes * around / f64::from(z),
        level,
    )?;
    Ok((grid, region.phase()))
}

/// The unknowns that the holes of `section` couple, and all amplitudes that they move, of a gear that is otherwise that of `stack`; 0 without holes.
pub(crate) fn coupled_unknowns(stack: &Stack, section: &SpurGear) -> [usize; 2] {
    let Some(largest) = stack.hole_orders else {
        return [0; 2];
    };
    let size = COMPONENTS * stack.across[1].len();
    let carried = stack.layers.len() > 2;
    [
        unknowns_of_holes(section, (largest, size), carried),
        size * (2 * largest + 1),
    ]
}

/// Cost of the web of `section` with its holes, whose gear is otherwise that of `stack`, with how the `edges` of holes move or without; nothing without holes.
pub(crate) fn cost_of_holes(stack: &Stack, section: &SpurGear, edges: bool) -> CondensationCost {
    let Some(largest) = stack.hole_orders else {
        return CondensationCost::default();
    };
    let Ok((grid, _)) = holed_grid(stack, section, largest) else {
        return CondensationCost::default();
    };
    let prism = Prism {
        grid: &grid.grid,
        material: section.material(),
        twist: 0.0,
        axial: &stack.across[1],
    };
    let recovered = match edges {
        true => grid.hole_edges.iter().map(Vec::len).sum(),
        false => 0,
    };
    let carried = stack.layers.len() > 2;
    HoledRing::cost(&grid, &prism, carried, (largest, recovered))
}

/// Amplitudes of the orders −`largest` … `largest` as a_0, a_1, b_1, …
fn rows_on_real(rows: &Mat<c64>, largest: usize, size: usize) -> Mat<f64> {
    let mut real = Mat::zeros((2 * largest + 1) * size, rows.ncols());
    for n in 0..=largest {
        for j in 0..rows.ncols() {
            for i in 0..size {
                let value = rows[((n + largest) * size + i, j)];
                if n == 0 {
                    real[(i, j)] = value.re;
                } else {
                    real[(block(n) * size + i, j)] = 2.0 * value.re;
                    real[((block(n) + 1) * size + i, j)] = -2.0 * value.im;
                }
            }
        }
    }
    real
}
