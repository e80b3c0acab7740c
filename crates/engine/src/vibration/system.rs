//! Stiffness and mass of a sector times the functions along the axis, in one class of its ring.
//!
//! In class k all turns by e^{i2πk/S} from a sector to the next. Displacements are polar, so that the left side is the right one times that. The
//! outer circle moves by the orders n ≡ k (mod S), each with one amplitude for each component and function.

use std::f64::consts::TAU;

use faer::{Mat, c64};

use super::heights::{Heights, Parity, PartHeights};
use super::section::Section;
use crate::fem::eigen::Entry;
use crate::fem::prism::{
    COMPONENTS, Law3, SectionMatrices, SectionMatrix, section_mass, section_matrices,
};
use crate::gear::Material;

/// Radii that differ by a smaller part are one.
const SAME: f64 = 1e-9;

/// How the bore carries the gear.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BoreSupport {
    /// The bore does not move.
    Held,
    /// The bore turns about its axis as a rigid ring, and is held otherwise.
    FreeToTurn,
    /// Nothing.
    Free,
}

/// A section with its material.
#[derive(Debug)]
pub(super) struct System<'a> {
    pub(super) section: &'a Section,
    pub(super) heights: &'a Heights,
    /// The functions of each part of the section.
    parts: Vec<PartHeights>,
    /// The functions of each node: the first, and how many.
    spans: Vec<[usize; 2]>,
    /// The function of each node that is one in the middle of its part.
    middles: Vec<usize>,
    /// The polar angle of each node.
    pub(super) angles: Vec<f64>,
    elements: Vec<ElementMatrices>,
    support: BoreSupport,
}

#[derive(Debug)]
struct ElementMatrices {
    stiffness: SectionMatrices,
    mass: SectionMatrix,
}

/// Unknowns that a displacement of an element follows.
#[derive(Debug, Clone, Copy)]
enum Unknowns {
    /// An unknown, with its share.
    Own(u32, c64),
    /// A node of the outer circle, by its number among the displacements there.
    OnArc(u32),
}

/// Stiffness and mass between two displacements: column, row, values.
type Between = (u32, u32, [c64; 2]);

/// Entries of the nodes of the outer circle, before they follow its orders.
struct ArcEntries {
    /// The place of each node of the section on the circle.
    places: Vec<Option<u32>>,
    span: [usize; 2],
    /// Between unknowns beside the circle, the columns, and displacements on it.
    beside: Vec<Between>,
    /// Between displacements on it.
    within: Vec<Between>,
}

impl ArcEntries {
    fn new(system: &System<'_>) -> Self {
        let mut places = vec![None; system.section.grid.nodes.len()];
        for (place, node) in system.section.arc.iter().enumerate() {
            places[*node as usize] = Some(place as u32);
        }
        Self {
            places,
            span: system.span_of_arc(),
            beside: Vec::new(),
            within: Vec::new(),
        }
    }

    /// The number of a displacement on the circle.
    fn unknown(&self, node: u32, component: usize, index: usize) -> Option<u32> {
        let [first, count] = self.span;
        let place = self.places[node as usize]? as usize;
        Some(((place * COMPONENTS + component) * count + index - first) as u32)
    }

    /// Calls `entries` with its entries on the orders of `numbering`.
    fn on_orders(self, system: &System<'_>, numbering: &Numbering, entries: &mut Vec<Entry>) {
        let [first, count] = self.span;
        let of_arc = &numbering.blocks[numbering.blocks.len() - numbering.orders.len()..];
        let places = system.section.arc.len();
        // The unknown of each order that each displacement on the circle follows, and its share.
        let follows = |displacement: u32| {
            let displacement = displacement as usize;
            let (place, of_node) = (
                displacement / (COMPONENTS * count),
                displacement % (COMPONENTS * count),
            );
            let (component, index) = (of_node / count, first + of_node % count);
            let angle = system.angles[system.section.arc[place] as usize];
            let orders = numbering.orders.iter().zip(of_arc);
            orders.filter_map(move |(order, block)| {
                let unknown = block.unknown(component, index)?;
                Some((unknown, c64::cis(*order as f64 * angle)))
            })
        };
        let by_displacement: Vec<Vec<(usize, c64)>> = (0..places * COMPONENTS * count)
            .map(|displacement| follows(displacement as u32).collect())
            .collect();
        let amplitudes = numbering.amplitude_size() * numbering.orders.len();
        let zero = [c64::new(0.0, 0.0); 2];
        let add = |sum: &mut [[c64; 2]], row: u32, [stiffness, mass]: [c64; 2]| {
            for (unknown, share) in &by_displacement[row as usize] {
                let of = &mut sum[unknown - numbering.first_amplitude];
                of[0] += share.conj() * stiffness;
                of[1] += share.conj() * mass;
            }
        };
        let mut push = |column: usize, sum: &[[c64; 2]]| {
            for (row, [stiffness, mass]) in sum.iter().enumerate() {
                let row = row + numbering.first_amplitude;
                if *mass != zero[0] || *stiffness != zero[0] {
                    entries.push(Entry {
                        column: column.min(row) as u32,
                        row: column.max(row) as u32,
                        // A column beyond the amplitudes, the turn of the bore, is the row.
                        stiffness: if column > row {
                            stiffness.conj()
                        } else {
                            *stiffness
                        },
                        mass: if column > row { mass.conj() } else { *mass },
                    });
                }
            }
        };
        let mut sum = vec![zero; amplitudes];
        let mut beside = self.beside;
        beside.sort_by_key(|(column, _, _)| *column);
        for of_column in beside.chunk_by(|one, other| one.0 == other.0) {
            sum.fill(zero);
            for (_, row, values) in of_column {
                add(&mut sum, *row, *values);
            }
            push(of_column[0].0 as usize, &sum);
        }
        // Rows first, then columns.
        let mut within = self.within;
        within.sort_by_key(|(column, _, _)| *column);
        let mut all = vec![zero; amplitudes * amplitudes];
        for of_column in within.chunk_by(|one, other| one.0 == other.0) {
            sum.fill(zero);
            for (_, row, values) in of_column {
                add(&mut sum, *row, *values);
            }
            for (unknown, share) in &by_displacement[of_column[0].0 as usize] {
                let column = unknown - numbering.first_amplitude;
                for (row, values) in sum.iter().enumerate().skip(column) {
                    let of = &mut all[column * amplitudes + row];
                    of[0] += share * values[0];
                    of[1] += share * values[1];
                }
            }
        }
        for column in 0..amplitudes {
            push(
                numbering.first_amplitude + column,
                &all[column * amplitudes..(column + 1) * amplitudes],
            );
        }
    }
}

/// The unknowns of a system in one class.
#[derive(Debug, Clone)]
pub(super) struct Numbering {
    /// The motions.
    pub(super) parity: Parity,
    /// The orders of the outer circle.
    pub(super) orders: Vec<i64>,
    /// The unknowns that each node follows: blocks with their shares.
    terms: Vec<Vec<(usize, c64)>>,
    blocks: Vec<Block>,
    /// The first unknown of the outer circle's orders; they are last but for the turn of the bore.
    pub(super) first_amplitude: usize,
    /// The unknown by which the bore turns, if it does.
    pub(super) turn: Option<usize>,
    /// The number of unknowns.
    pub(super) count: usize,
}

/// The unknowns of a node, or of an order: those of each component one after the other.
#[derive(Debug, Clone, Copy)]
struct Block {
    span: [usize; 2],
    /// The first unknown of each component, and the function that it belongs to.
    starts: [usize; COMPONENTS],
    firsts: [usize; COMPONENTS],
}

impl Block {
    fn unknown(&self, component: usize, index: usize) -> Option<usize> {
        let first = self.firsts[component];
        let end = self.span[0] + self.span[1];
        (index >= first && index < end).then(|| self.starts[component] + index - first)
    }
}

impl<'a> System<'a> {
    /// The system of `section`, whose parts stand between `faces`.
    pub(super) fn new(
        section: &'a Section,
        heights: &'a Heights,
        faces: &[[f64; 2]],
        material: &Material,
        support: BoreSupport,
    ) -> Self {
        let law = Law3::new(material);
        let parts: Vec<PartHeights> = faces.iter().map(|faces| heights.part(*faces)).collect();
        let of_element = |element| ElementMatrices {
            stiffness: section_matrices(element, &section.grid, &law, 0.0),
            mass: section_mass(element, &section.grid) * material.density,
        };
        let count = section.grid.nodes.len();
        let mut spans = vec![[usize::MAX, 0]; count];
        let mut middles = vec![0; count];
        let nearest = |z: f64| {
            let distances = heights.nodes.iter().map(|node| (node - z).abs());
            let nearest = distances
                .enumerate()
                .min_by(|(_, one), (_, other)| one.total_cmp(other));
            nearest.map_or(0, |(index, _)| index)
        };
        for (element, part) in section.grid.elements.iter().zip(&section.part_of) {
            let own = &parts[*part];
            let [low, high] = faces[*part];
            let middle = nearest(f64::midpoint(low, high));
            for node in element.nodes() {
                let [first, count] = spans[*node as usize];
                let end = if first == usize::MAX {
                    0
                } else {
                    first + count
                };
                let first = first.min(own.first);
                spans[*node as usize] = [first, end.max(own.first + own.count()) - first];
                middles[*node as usize] = middle;
            }
        }
        let angles = section.grid.nodes.iter().map(|p| p.y.atan2(p.x));
        Self {
            section,
            heights,
            parts,
            spans,
            middles,
            angles: angles.collect(),
            elements: section.grid.elements.iter().map(of_element).collect(),
            support,
        }
    }

    /// The functions of an element of the section, by its place.
    pub(super) fn part(&self, element: usize) -> &PartHeights {
        &self.parts[self.section.part_of[element]]
    }

    /// The functions of the outer circle: the first, and how many.
    pub(super) fn span_of_arc(&self) -> [usize; 2] {
        self.span_of(self.section.arc[0])
    }

    /// The functions of `node`: the first, and how many.
    pub(super) fn span_of(&self, node: u32) -> [usize; 2] {
        self.spans[node as usize]
    }

    /// The unknowns of the motions of `parity` in `class`, with these orders of the outer circle.
    pub(super) fn numbering(&self, parity: Parity, class: usize, orders: &[i64]) -> Numbering {
        let section = self.section;
        let one = c64::new(1.0, 0.0);
        let mut numbering = Numbering {
            parity,
            orders: orders.to_vec(),
            terms: vec![Vec::new(); section.grid.nodes.len()],
            blocks: Vec::new(),
            first_amplitude: 0,
            turn: None,
            count: 0,
        };
        let mut is_own = vec![true; section.grid.nodes.len()];
        let (right, left) = &section.sides;
        let carried: &[u32] = match self.support {
            BoreSupport::Held | BoreSupport::FreeToTurn => &section.bore,
            BoreSupport::Free => &[],
        };
        for node in section.arc.iter().chain(carried).chain(left) {
            is_own[*node as usize] = false;
        }
        for (node, span) in self.spans.iter().enumerate() {
            if is_own[node] {
                let block = numbering.add(self.heights, parity, *span);
                numbering.terms[node].push((block, one));
            }
        }
        let phase = TAU * class as f64 / section.sectors as f64;
        for (right, left) in right.iter().zip(left) {
            if is_own[*right as usize] {
                let (block, _) = numbering.terms[*right as usize][0];
                numbering.terms[*left as usize].push((block, c64::cis(phase)));
            }
        }
        numbering.first_amplitude = numbering.count;
        let span = self.span_of_arc();
        for order in orders {
            let block = numbering.add(self.heights, parity, span);
            for node in &section.arc {
                let angle = self.angles[*node as usize];
                let share = c64::cis(*order as f64 * angle);
                numbering.terms[*node as usize].push((block, share));
            }
        }
        let turns = self.support == BoreSupport::FreeToTurn && class == 0;
        if turns && parity != Parity::Odd && !section.bore.is_empty() {
            numbering.turn = Some(numbering.count);
            numbering.count += 1;
        }
        numbering
    }

    /// The unknown, with its share, that `component` of the function `index` at `node` follows, off the outer circle; `None` where it is held.
    fn follows(
        &self,
        numbering: &Numbering,
        (node, component, index): (u32, usize, usize),
    ) -> Option<(u32, c64)> {
        match numbering.terms[node as usize].first() {
            Some((block, share)) => {
                let unknown = numbering.blocks[*block].unknown(component, index)?;
                Some((unknown as u32, *share))
            }
            None => {
                let turn = numbering.turn.filter(|_| component == 1)?;
                let radius = self.section.grid.nodes[node as usize].norm();
                Some((turn as u32, c64::new(radius, 0.0)))
            }
        }
    }

    /// Hands the entries of stiffness and mass to `entries`.
    pub(super) fn assemble(&self, numbering: &Numbering, entries: &mut Vec<Entry>) {
        let mut arc = ArcEntries::new(self);
        let mut local: Vec<(usize, usize, Unknowns)> = Vec::new();
        let elements = self.section.grid.elements.iter().zip(&self.section.part_of);
        for ((element, part), matrices) in elements.zip(&self.elements) {
            let part = &self.parts[*part];
            local.clear();
            for (a, node) in element.nodes().iter().enumerate() {
                for c in 0..COMPONENTS {
                    for p in 0..part.count() {
                        let index = part.first + p;
                        let unknowns = match arc.unknown(*node, c, index) {
                            Some(unknown) => Unknowns::OnArc(unknown),
                            None => match self.follows(numbering, (*node, c, index)) {
                                Some((unknown, share)) => Unknowns::Own(unknown, share),
                                None => continue,
                            },
                        };
                        local.push((COMPONENTS * a + c, p, unknowns));
                    }
                }
            }
            let SectionMatrices {
                plain,
                mixed,
                axial,
            } = &matrices.stiffness;
            for &(a, p, rows) in &local {
                for &(b, q, columns) in &local {
                    let product = part.products[(p, q)];
                    if product == 0.0 {
                        // Functions of pieces that do not touch.
                        continue;
                    }
                    let stiffness = || {
                        plain[(a, b)] * product
                            + mixed[(a, b)] * part.slope[(p, q)]
                            + mixed[(b, a)] * part.slope[(q, p)]
                            + axial[(a, b)] * part.slopes[(p, q)]
                    };
                    let mass = || matrices.mass[(a, b)] * product;
                    match (rows, columns) {
                        (Unknowns::Own(row, share), Unknowns::Own(column, by)) if row >= column => {
                            let share = share.conj() * by;
                            entries.push(Entry {
                                column,
                                row,
                                stiffness: share * stiffness(),
                                mass: share * mass(),
                            });
                        }
                        (Unknowns::OnArc(row), Unknowns::Own(column, by)) => {
                            let values = [by * stiffness(), by * mass()];
                            arc.beside.push((column, row, values));
                        }
                        (Unknowns::OnArc(row), Unknowns::OnArc(column)) => {
                            let one = c64::new(1.0, 0.0);
                            let values = [one * stiffness(), one * mass()];
                            arc.within.push((column, row, values));
                        }
                        _ => {}
                    }
                }
            }
        }
        arc.on_orders(self, numbering, entries);
    }

    /// The pull of rotation on the unknowns for ω² = 1 in 1/s²: the mass times the radius.
    pub(super) fn pull(&self, numbering: &Numbering) -> Mat<c64> {
        let grid = &self.section.grid;
        let mut pull = Mat::<c64>::zeros(numbering.count, 1);
        let elements = grid.elements.iter().zip(&self.section.part_of);
        for ((element, part), matrices) in elements.zip(&self.elements) {
            let part = &self.parts[*part];
            let width = |p: usize| (0..part.count()).map(move |q| part.products[(p, q)]);
            let widths: Vec<f64> = (0..part.count()).map(|p| width(p).sum()).collect();
            let radii = element.nodes().iter();
            let radii = radii.map(|node| grid.nodes[*node as usize].norm());
            for (a, node) in element.nodes().iter().enumerate() {
                for component in 0..COMPONENTS - 1 {
                    let by_radius = radii.clone().enumerate();
                    let by_radius = by_radius.map(|(b, r)| {
                        r * matrices.mass[(COMPONENTS * a + component, COMPONENTS * b)]
                    });
                    let force: f64 = by_radius.sum();
                    for (p, width) in widths.iter().enumerate() {
                        let of = (*node, component, part.first + p);
                        self.each_followed(numbering, of, |unknown, share| {
                            pull[(unknown, 0)] += share.conj() * (force * width);
                        });
                    }
                }
            }
        }
        pull
    }

    /// The forces on the unknowns of the part `swollen` of the section that is larger in its plane by one meter at `radius` before it is joined to the others.
    pub(super) fn swollen(&self, numbering: &Numbering, swollen: usize, radius: f64) -> Mat<c64> {
        let grid = &self.section.grid;
        let mut forces = Mat::<c64>::zeros(numbering.count, 1);
        let elements = grid.elements.iter().zip(&self.section.part_of);
        for ((element, part), matrices) in elements.zip(&self.elements) {
            if *part != swollen {
                continue;
            }
            let part = &self.parts[*part];
            let strained = |a: usize, of: &SectionMatrix, is_back: bool| -> f64 {
                let radii = element.nodes().iter().enumerate();
                let by_node = radii.map(|(b, node)| {
                    let outward = grid.nodes[*node as usize].norm() / radius;
                    let column = COMPONENTS * b;
                    outward
                        * if is_back {
                            of[(column, a)]
                        } else {
                            of[(a, column)]
                        }
                });
                by_node.sum()
            };
            for (a, node) in element.nodes().iter().enumerate() {
                for component in 0..COMPONENTS {
                    let row = COMPONENTS * a + component;
                    let plain = strained(row, &matrices.stiffness.plain, false);
                    let mixed = strained(row, &matrices.stiffness.mixed, true);
                    for p in 0..part.count() {
                        // Of a displacement that is the same at all heights.
                        let all = 0..part.count();
                        let width: f64 = all.clone().map(|q| part.products[(p, q)]).sum();
                        let rise: f64 = all.map(|q| part.slope[(q, p)]).sum();
                        let force = plain * width + mixed * rise;
                        let of = (*node, component, part.first + p);
                        self.each_followed(numbering, of, |unknown, share| {
                            forces[(unknown, 0)] += share.conj() * force;
                        });
                    }
                }
            }
        }
        forces
    }

    /// How far the circle of this `radius`, which nodes of the section stand on, moves outward in the mean over its angle and its width.
    pub(super) fn mean_outward(&self, numbering: &Numbering, x: &Mat<c64>, radius: f64) -> f64 {
        let nodes = &self.section.grid.nodes;
        let is_on_it = |node: &u32| (nodes[*node as usize].norm() / radius - 1.0).abs() < SAME;
        let on_it = (0..nodes.len() as u32).filter(is_on_it);
        let mut moved: Vec<(f64, f64)> = on_it
            .map(|node| {
                let [outward, ..] = self.mean(numbering, x, node);
                (self.angles[node as usize], outward.re)
            })
            .collect();
        moved.sort_by(|one, other| one.0.total_cmp(&other.0));
        if self.section.sides.0.is_empty()
            && let Some(&(angle, outward)) = moved.first()
        {
            moved.push((angle + TAU, outward));
        }
        let pieces = moved.windows(2).map(|ends| {
            let [(from, one), (to, other)] = [ends[0], ends[1]];
            [to - from, (to - from) * f64::midpoint(one, other)]
        });
        let [angle, outward] = pieces.fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
        outward / angle
    }

    /// Calls `each` with the unknowns, and their shares, that `component` of the function `index` at `node` follows.
    fn each_followed(
        &self,
        numbering: &Numbering,
        (node, component, index): (u32, usize, usize),
        mut each: impl FnMut(usize, c64),
    ) {
        let terms = &numbering.terms[node as usize];
        if terms.is_empty()
            && let Some((unknown, share)) = self.follows(numbering, (node, component, index))
        {
            each(unknown as usize, share);
        }
        for (block, share) in terms {
            if let Some(unknown) = numbering.blocks[*block].unknown(component, index) {
                each(unknown, *share);
            }
        }
    }

    /// The displacement of `component` of the function `index` at `node`, by the unknowns.
    pub(super) fn displacement(
        &self,
        numbering: &Numbering,
        x: &Mat<c64>,
        (node, component, index): (u32, usize, usize),
    ) -> c64 {
        let mut sum = c64::new(0.0, 0.0);
        self.each_followed(numbering, (node, component, index), |unknown, share| {
            sum += x[(unknown, 0)] * share;
        });
        sum
    }

    /// The displacement of `node` in the middle of its part.
    pub(super) fn in_middle(
        &self,
        numbering: &Numbering,
        x: &Mat<c64>,
        node: u32,
    ) -> [c64; COMPONENTS] {
        let index = self.middles[node as usize];
        [0, 1, 2].map(|component| self.displacement(numbering, x, (node, component, index)))
    }

    /// The displacement of `node` in the mean over its width.
    pub(super) fn mean(&self, numbering: &Numbering, x: &Mat<c64>, node: u32) -> [c64; COMPONENTS] {
        let Some(part) = self.parts.iter().find(|part| {
            let own = [part.first, part.count()];
            own == self.spans[node as usize]
        }) else {
            return self.in_middle(numbering, x, node);
        };
        let share = |p: usize| -> f64 { (0..part.count()).map(|q| part.products[(p, q)]).sum() };
        let width: f64 = (0..part.count()).map(share).sum();
        // Odd motions of the other half have the opposite sign, and are zero in the mean, as the function of them on the middle is.
        [0, 1, 2].map(|component| {
            if self.heights.is_odd(numbering.parity, component) {
                return c64::new(0.0, 0.0);
            }
            let values = (0..part.count()).map(|p| {
                let of = (node, component, part.first + p);
                self.displacement(numbering, x, of) * (share(p) / width)
            });
            values.sum()
        })
    }

    /// A part of the mass at each node, per function along the axis: the diagonal of the mass of the section.
    pub(super) fn node_weights(&self) -> Vec<f64> {
        let mut weights = vec![0.0; self.section.grid.nodes.len()];
        let elements = self.section.grid.elements.iter().zip(&self.section.part_of);
        for ((element, part), matrices) in elements.zip(&self.elements) {
            let part = &self.parts[*part];
            let count = part.count();
            let width: f64 = (0..count * count)
                .map(|i| part.products[(i / count, i % count)])
                .sum();
            for (a, node) in element.nodes().iter().enumerate() {
                weights[*node as usize] += matrices.mass[(3 * a, 3 * a)] * width;
            }
        }
        weights
    }
}

impl Numbering {
    fn add(&mut self, heights: &Heights, parity: Parity, span: [usize; 2]) -> usize {
        let mut block = Block {
            span,
            starts: [0; COMPONENTS],
            firsts: [0; COMPONENTS],
        };
        let end = span[0] + span[1];
        for component in 0..COMPONENTS {
            let is_zero = heights.is_zero(parity, component, span[0]);
            block.firsts[component] = span[0] + usize::from(is_zero);
            block.starts[component] = self.count;
            self.count += end - block.firsts[component];
        }
        self.blocks.push(block);
        self.blocks.len() - 1
    }

    /// The number of unknowns of one order of the outer circle.
    pub(super) fn amplitude_size(&self) -> usize {
        let end = self.turn.unwrap_or(self.count);
        (end - self.first_amplitude) / self.orders.len().max(1)
    }

    /// The unknowns turned by a right angle in the plane: (u_r, u_t) becomes (−u_t, u_r), and the axial ones become zero.
    pub(super) fn turned(&self, x: &Mat<c64>) -> [Mat<c64>; 2] {
        let mut turned = Mat::<c64>::zeros(self.count, 1);
        let mut planar = turned.clone();
        for block in &self.blocks {
            for index in block.firsts[0]..block.span[0] + block.span[1] {
                let at = |component| block.unknown(component, index);
                if let (Some(r), Some(t)) = (at(0), at(1)) {
                    turned[(r, 0)] = -x[(t, 0)];
                    turned[(t, 0)] = x[(r, 0)];
                    planar[(r, 0)] = x[(r, 0)];
                    planar[(t, 0)] = x[(t, 0)];
                }
            }
        }
        if let Some(turn) = self.turn {
            planar[(turn, 0)] = x[(turn, 0)];
        }
        [turned, planar]
    }
}
