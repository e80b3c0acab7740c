//! Modes read from the eigenvectors that were found.

use std::f64::consts::TAU;

use faer::{Mat, c64};

use super::heights::Parity;
use super::mode::{Direction, Mode, OrderShape};
use super::shape::ModeShape;
use super::system::{Numbering, System};
use super::teeth::{TeethOrder, ToothCell};
use crate::fem::eigen::{EigenPair, Lanczos, inner};
use crate::fem::prism::COMPONENTS;
use crate::gear::SolidGear;

/// Rings of equal depth; means over them distinguish the shapes.
const RINGS: usize = 24;
/// The amplitude on a ring, as a part of the largest, below which its sign says nothing.
const SMALL: f64 = 0.02;
/// The largest order that nodal diameters are counted to.
const MOST_DIAMETERS: i64 = 60;

/// The teeth of a gear.
#[derive(Debug, Clone, Copy)]
pub(super) struct Teeth<'a> {
    pub(super) gear: &'a SolidGear,
    pub(super) cell: &'a ToothCell,
    pub(super) orders: &'a [TeethOrder],
}

/// Eigenpair of a class, to be read as a mode.
pub(super) struct Found<'a> {
    pub(super) system: &'a System<'a>,
    pub(super) numbering: &'a Numbering,
    pub(super) parity: Parity,
    pub(super) class: usize,
    pub(super) weights: &'a [f64],
    pub(super) phase: f64,
    pub(super) teeth: Option<Teeth<'a>>,
}

impl Found<'_> {
    /// The mode of `pair`, whose value ω² is `value`, and its vector.
    pub(super) fn mode(&self, value: f64, pair: &EigenPair, lanczos: &Lanczos) -> (Mode, Mat<c64>) {
        let sectors = self.system.section.sectors;
        let is_double = self.class != 0 && 2 * self.class != sectors;
        let x = self.normalized(&pair.vector, is_double);
        let (order, component, nodal_circles) = self.ring_shape(&x);
        let energies = self.energies(&x);
        let direction = match self.parity {
            Parity::Odd => Direction::OutOfPlane,
            Parity::Whole if energies[2] > energies[0] + energies[1] => Direction::OutOfPlane,
            _ if order == 0 && component == 1 => Direction::Torsion,
            _ => Direction::InPlane,
        };
        let [turned, planar] = self.numbering.turned(&x);
        let pencil = lanczos.pencil();
        let whole = inner(&planar, &pencil.mass_times(&planar)).re;
        let coupled = inner(&planar, &pencil.mass_times(&turned)).im;
        let sign = if order < 0 { 1.0 } else { -1.0 };
        let mode = Mode {
            frequency: value.max(0.0).sqrt() / TAU,
            is_double,
            direction,
            nodal_diameters: order.unsigned_abs() as u32,
            nodal_circles,
            coriolis: if whole > 0.0 {
                sign * coupled / whole
            } else {
                0.0
            },
            residual: pair.residual,
            shape: self.shape(&x),
        };
        (mode, x)
    }

    /// The vector with a modal mass of 1 kg in the whole gear, real where the mode is single.
    fn normalized(&self, x: &Mat<c64>, is_double: bool) -> Mat<c64> {
        let sectors = self.system.section.sectors as f64;
        let copies = sectors * self.system.heights.copies();
        // The real part of a wave has half of its mass.
        let scale = if is_double {
            (2.0 / copies).sqrt()
        } else {
            copies.sqrt().recip()
        };
        let mut squares = c64::new(0.0, 0.0);
        for node in 0..self.weights.len() as u32 {
            for u in self.system.in_middle(self.numbering, x, node) {
                squares += u * u * self.weights[node as usize];
            }
        }
        let turn = if is_double || squares.norm() == 0.0 {
            c64::new(1.0, 0.0)
        } else {
            c64::cis(-squares.arg() / 2.0)
        };
        x * faer::Scale(turn * scale)
    }

    /// The kinetic energy of each component in the middle of its part, but for a factor.
    fn energies(&self, x: &Mat<c64>) -> [f64; COMPONENTS] {
        let mut energies = [0.0; COMPONENTS];
        for (node, weight) in self.weights.iter().enumerate() {
            let moved = self.system.in_middle(self.numbering, x, node as u32);
            for (energy, u) in energies.iter_mut().zip(moved) {
                *energy += weight * u.norm_sqr();
            }
        }
        energies
    }

    /// The order that carries most of the energy, the component that does in it, and the circles on which that changes its sign.
    fn ring_shape(&self, x: &Mat<c64>) -> (i64, usize, u32) {
        let section = self.system.section;
        let sectors = section.sectors as i64;
        let radii: Vec<f64> = section.grid.nodes.iter().map(|p| p.norm()).collect();
        let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
        let most = radii.iter().copied().fold(0.0, f64::max);
        let ring_of = |radius: f64| {
            let part = (radius - least) / (most - least);
            ((part * RINGS as f64) as usize).min(RINGS - 1)
        };
        let moved: Vec<[c64; COMPONENTS]> = (0..radii.len() as u32)
            .map(|node| self.system.in_middle(self.numbering, x, node))
            .collect();
        let mut masses = [0.0; RINGS];
        for (radius, weight) in radii.iter().zip(self.weights) {
            masses[ring_of(*radius)] += weight;
        }
        let amplitudes = |order: i64| {
            let mut sums = [[c64::new(0.0, 0.0); COMPONENTS]; RINGS];
            for (node, moved) in moved.iter().enumerate() {
                let turn = c64::cis(-(order as f64) * self.system.angles[node]);
                for (sum, u) in sums[ring_of(radii[node])].iter_mut().zip(moved) {
                    *sum += *u * turn * self.weights[node];
                }
            }
            sums
        };
        let of_class = |order: &i64| order.rem_euclid(sectors) == self.class as i64;
        let mut best = (0.0, 0, 0, [[c64::new(0.0, 0.0); COMPONENTS]; RINGS]);
        let mut orders: Vec<i64> = (-MOST_DIAMETERS..=MOST_DIAMETERS)
            .filter(of_class)
            .collect();
        orders.sort_by_key(|order| (order.abs(), *order < 0));
        for order in orders {
            let sums = amplitudes(order);
            let mut energies = [0.0; COMPONENTS];
            for (ring, mass) in sums.iter().zip(&masses) {
                for (energy, sum) in energies.iter_mut().zip(ring) {
                    *energy += if *mass > 0.0 {
                        sum.norm_sqr() / mass
                    } else {
                        0.0
                    };
                }
            }
            let total: f64 = energies.iter().sum();
            // Opposite orders of a real shape carry the same but for rounding.
            if total > best.0 * (1.0 + 1e-6) {
                let largest = (0..COMPONENTS)
                    .max_by(|one, other| energies[*one].total_cmp(&energies[*other]));
                best = (total, order, largest.unwrap_or(0), sums);
            }
        }
        let (_, order, component, sums) = best;
        let means = sums.iter().zip(&masses).filter(|(_, mass)| **mass > 0.0);
        let means: Vec<c64> = means.map(|(ring, mass)| ring[component] / *mass).collect();
        let largest = means
            .iter()
            .copied()
            .fold(c64::new(0.0, 0.0), |one, other| {
                if other.norm() > one.norm() {
                    other
                } else {
                    one
                }
            });
        let aligned = means.iter().map(|mean| (mean * largest.conj()).re);
        let told: Vec<f64> = aligned
            .filter(|mean| mean.abs() > SMALL * largest.norm_sqr())
            .collect();
        let changes = told.windows(2).filter(|two| two[0] * two[1] < 0.0).count();
        (order, component, changes as u32)
    }

    /// The amplitude of order `k` of the outer circle in `x`; that of a negative order is conjugate, as its teeth are those of the opposite order.
    fn amplitude(&self, x: &Mat<c64>, k: usize) -> Mat<c64> {
        let size = self.numbering.amplitude_size();
        let first = self.numbering.first_amplitude + k * size;
        let amplitude = x.subrows(first, size);
        if self.numbering.orders[k] < 0 {
            amplitude.conjugate().to_owned()
        } else {
            amplitude.to_owned()
        }
    }

    /// The shape of `mode`, whose vector is `x`, on the grids of blank and teeth.
    pub(super) fn on_grid(&self, mode: Mode, x: &Mat<c64>) -> ModeShape {
        let mut shape = ModeShape::of(mode);
        let sectors = self.system.section.sectors;
        let per_sector = TAU * self.class as f64 / sectors as f64;
        let of_blank = |copy: usize, place: (u32, usize, usize)| {
            let moved = self.system.displacement(self.numbering, x, place);
            moved * c64::cis(per_sector * copy as f64)
        };
        shape.add(self.system, self.parity, (sectors, self.phase), of_blank);
        let Some(Teeth { gear, cell, orders }) = self.teeth else {
            return shape;
        };
        let tooth = cell.system(self.system.heights, gear.section(), gear.face_heights());
        let (nodes, levels) = (
            cell.section.grid.nodes.len(),
            self.system.heights.nodes.len(),
        );
        let index = |(node, component, level): (u32, usize, usize)| {
            (node as usize * COMPONENTS + component) * levels + level
        };
        let of_order = |k: usize| -> Vec<c64> {
            let order = self.numbering.orders[k];
            let of = &orders[order.unsigned_abs() as usize];
            let moved = of.moved(self.amplitude(x, k));
            let turn = c64::cis(-(order as f64) * self.phase);
            let place = |i: usize| {
                let component = i / levels % COMPONENTS;
                ((i / levels / COMPONENTS) as u32, component, i % levels)
            };
            let value = |i: usize| {
                let value = tooth.displacement(&of.numbering, &moved, place(i));
                turn * if order < 0 { value.conj() } else { value }
            };
            (0..nodes * COMPONENTS * levels).map(value).collect()
        };
        let by_order: Vec<Vec<c64>> = (0..self.numbering.orders.len()).map(of_order).collect();
        let z = gear.section().tooth_count() as usize;
        let of_tooth = |copy: usize, place: (u32, usize, usize)| -> c64 {
            let angle = TAU * copy as f64 / z as f64;
            let all = self.numbering.orders.iter().zip(&by_order);
            all.map(|(order, values)| values[index(place)] * c64::cis(*order as f64 * angle))
                .sum()
        };
        shape.add(&tooth, self.parity, (z, 0.0), of_tooth);
        shape
    }

    /// How the teeth move, order by order.
    fn shape(&self, x: &Mat<c64>) -> Vec<OrderShape> {
        let Some(Teeth { gear, cell, orders }) = self.teeth else {
            return Vec::new();
        };
        let tooth = cell.system(self.system.heights, gear.section(), gear.face_heights());
        let of_order = |(k, order): (usize, &i64)| {
            let of = &orders[order.unsigned_abs() as usize];
            let moved = of.moved(self.amplitude(x, k));
            let turn = c64::cis(-(*order as f64) * self.phase);
            let mean = |node: u32| {
                let mut mean = tooth.mean(&of.numbering, &moved, node);
                for u in &mut mean {
                    let value = if *order < 0 { u.conj() } else { *u };
                    *u = value * turn;
                }
                mean
            };
            let foot = cell.section.arc[cell.section.arc.len() / 2];
            OrderShape {
                order: *order,
                at_pitch: mean(cell.pitch_node),
                on_rim: mean(foot),
            }
        };
        self.numbering
            .orders
            .iter()
            .enumerate()
            .map(of_order)
            .collect()
    }
}
