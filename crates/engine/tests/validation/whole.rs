//! A whole gear without any condensation: every node of every tooth and of the blank in one sparse system.
//!
//! It shares the grids and the stiffness of one element with the engine, and nothing that comes after them: no Schur
//! complement, no cyclic symmetry, no loading modes, no complex amplitudes.

use std::collections::HashMap;
use std::f64::consts::PI;

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use meshwright_engine::gear::{Material, Vector, radial, tangential};
use meshwright_engine::grid::{BlankGrid, Element, Grid, ToothGrid};
use meshwright_engine::substructures::{ElementStiffness, element_stiffness};

/// What holds a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Hold {
    /// Nothing.
    Free,
    /// It has this displacement.
    At(Vector),
    /// It follows the trigonometric polynomial of the interface circle at this angle.
    OnCircle(f64),
}

/// Grids joined node by node.
#[derive(Debug, Clone, Default)]
pub(crate) struct Assembly {
    pub(crate) nodes: Vec<Vector>,
    pub(crate) holds: Vec<Hold>,
    pub(crate) elements: Vec<Element>,
}

impl Assembly {
    /// Adds `grid` turned by `angle`; the nodes in `shared` are there already. Returns the number of each of its nodes.
    pub(crate) fn add(&mut self, grid: &Grid, angle: f64, shared: &HashMap<u32, u32>) -> Vec<u32> {
        let (e_x, e_y) = (radial(angle), tangential(angle));
        let numbers: Vec<u32> = grid
            .nodes
            .iter()
            .enumerate()
            .map(|(local, point)| {
                shared.get(&(local as u32)).copied().unwrap_or_else(|| {
                    self.nodes.push(point.x * e_x + point.y * e_y);
                    self.holds.push(Hold::Free);
                    (self.nodes.len() - 1) as u32
                })
            })
            .collect();
        let elements = grid.elements.iter();
        self.elements
            .extend(elements.map(|element| element.renumbered(|local| numbers[local as usize])));
        numbers
    }

    /// Adds `count` copies of `grid`, the left side of each being the right side of the next; returns the numbers of each.
    pub(crate) fn add_ring(
        &mut self,
        grid: &Grid,
        (right, left): (&[u32], &[u32]),
        count: usize,
        phase: f64,
    ) -> Vec<Vec<u32>> {
        let mut copies: Vec<Vec<u32>> = Vec::with_capacity(count);
        for i in 0..count {
            let mut shared = HashMap::new();
            if let Some(before) = copies.last() {
                let sides = right.iter().zip(left);
                shared.extend(sides.map(|(r, l)| (*r, before[*l as usize])));
            }
            if i + 1 == count && count > 1 {
                let first = &copies[0];
                let sides = right.iter().zip(left);
                shared.extend(sides.map(|(r, l)| (*l, first[*r as usize])));
            }
            let angle = phase + 2.0 * PI * i as f64 / count as f64;
            copies.push(self.add(grid, angle, &shared));
        }
        copies
    }

    /// Holds the nodes `nodes` as `hold` says, by their place.
    pub(crate) fn hold(
        &mut self,
        nodes: impl IntoIterator<Item = u32>,
        hold: impl Fn(Vector) -> Hold,
    ) {
        for node in nodes {
            self.holds[node as usize] = hold(self.nodes[node as usize]);
        }
    }
}

/// On the interface circle at the node's own angle.
pub(crate) fn on_circle(point: Vector) -> Hold {
    Hold::OnCircle(point.y.atan2(point.x))
}

/// The sides of a blank sector with the ends that lie on the bore and on the interface circle.
pub(crate) fn whole_sides(grid: &BlankGrid) -> (Vec<u32>, Vec<u32>) {
    let ends = |arc: &[u32]| (arc[0], arc[arc.len() - 1]);
    let ((bore_right, bore_left), (arc_right, arc_left)) =
        (ends(&grid.bore_nodes), ends(&grid.arc_nodes));
    let side = |bore, side: &[u32], arc| [&[bore][..], side, &[arc][..]].concat();
    (
        side(bore_right, &grid.side_nodes.0, arc_right),
        side(bore_left, &grid.side_nodes.1, arc_left),
    )
}

/// The sides of a tooth sector with the ends that lie on the interface circle.
pub(crate) fn whole_tooth_sides(grid: &ToothGrid) -> (Vec<u32>, Vec<u32>) {
    let arc = &grid.arc_nodes;
    let side = |end, side: &[u32]| [&[end][..], side].concat();
    (
        side(arc[0], &grid.side_nodes.0),
        side(arc[arc.len() - 1], &grid.side_nodes.1),
    )
}

/// An assembly with its factorized stiffness on the free nodes and the amplitudes of the interface circle.
pub(crate) struct Whole {
    pub(crate) assembly: Assembly,
    stiffnesses: Vec<ElementStiffness>,
    /// The orders 0 … M of the interface circle.
    largest_order: usize,
    /// The first unknown of each free node.
    first: Vec<Option<u32>>,
    free: usize,
    factor: Llt<u32, f64>,
}

impl Whole {
    pub(crate) fn new(
        assembly: Assembly,
        material: &Material,
        thickness: f64,
        largest_order: usize,
    ) -> Self {
        let mut first = vec![None; assembly.nodes.len()];
        let mut free = 0_u32;
        for (place, hold) in first.iter_mut().zip(&assembly.holds) {
            if *hold == Hold::Free {
                *place = Some(free);
                free += 2;
            }
        }
        let free = free as usize;
        let circle = assembly
            .holds
            .iter()
            .any(|hold| matches!(hold, Hold::OnCircle(_)));
        let amplitudes = if circle {
            2 * (2 * largest_order + 1)
        } else {
            0
        };
        let stiffnesses: Vec<_> = assembly
            .elements
            .iter()
            .map(|element| {
                let points = element.places(&assembly.nodes);
                element_stiffness(
                    element.kind(),
                    &points,
                    material,
                    thickness * element.thickness(),
                )
            })
            .collect();

        let mut triplets = Vec::new();
        let mut on_amplitudes = Mat::<f64>::zeros(amplitudes, amplitudes);
        for (element, k) in assembly.elements.iter().zip(&stiffnesses) {
            let nodes = element.nodes();
            let mut rows: Vec<(usize, Vec<f64>)> = Vec::new();
            for (local, &node) in nodes.iter().enumerate() {
                if let Hold::OnCircle(angle) = assembly.holds[node as usize] {
                    let [x, y] = on_amplitudes_at(angle, largest_order);
                    rows.push((2 * local, x));
                    rows.push((2 * local + 1, y));
                }
            }
            for (a, &node_a) in nodes.iter().enumerate() {
                let Some(row) = first[node_a as usize] else {
                    continue;
                };
                for (b, &node_b) in nodes.iter().enumerate() {
                    let Some(col) = first[node_b as usize] else {
                        continue;
                    };
                    for (c, d) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        let (i, j) = (row + c, col + d);
                        if i >= j {
                            triplets.push(Triplet::new(
                                i,
                                j,
                                k[(2 * a + c as usize, 2 * b + d as usize)],
                            ));
                        }
                    }
                }
                for c in 0..2 {
                    for q in 0..if rows.is_empty() { 0 } else { amplitudes } {
                        let value: f64 = rows
                            .iter()
                            .map(|(local, on)| k[(2 * a + c, *local)] * on[q])
                            .sum();
                        triplets.push(Triplet::new((free + q) as u32, row + c as u32, value));
                    }
                }
            }
            for (i, on_i) in &rows {
                for (j, on_j) in &rows {
                    let k = k[(*i, *j)];
                    for q in 0..amplitudes {
                        for p in q..amplitudes {
                            on_amplitudes[(p, q)] += on_i[p] * k * on_j[q];
                        }
                    }
                }
            }
        }
        for q in 0..amplitudes {
            for p in q..amplitudes {
                triplets.push(Triplet::new(
                    (free + p) as u32,
                    (free + q) as u32,
                    on_amplitudes[(p, q)],
                ));
            }
        }
        let n = free + amplitudes;
        let stiffness = SparseColMat::<u32, f64>::try_new_from_triplets(n, n, &triplets)
            .expect("within the indices");
        let factor = stiffness
            .sp_cholesky(Side::Lower)
            .expect("a held body is stiff");
        Self {
            assembly,
            stiffnesses,
            largest_order,
            first,
            free,
            factor,
        }
    }

    /// The number of unknowns.
    pub(crate) fn unknowns(&self) -> usize {
        self.free + self.amplitudes()
    }

    fn amplitudes(&self) -> usize {
        let circle = self
            .assembly
            .holds
            .iter()
            .any(|hold| matches!(hold, Hold::OnCircle(_)));
        if circle {
            2 * (2 * self.largest_order + 1)
        } else {
            0
        }
    }

    /// The displacement of every node under each column of nodal forces, with held nodes where they are held.
    pub(crate) fn solve(&self, forces: &[Vec<Vector>]) -> Vec<Vec<Vector>> {
        let held: Vec<Vector> = self
            .assembly
            .holds
            .iter()
            .map(|hold| {
                if let Hold::At(u) = hold {
                    *u
                } else {
                    Vector::zeros()
                }
            })
            .collect();
        let of_held = self.nodal_forces(&held);
        let mut right = Mat::<f64>::zeros(self.unknowns(), forces.len());
        for (column, forces) in forces.iter().enumerate() {
            let net: Vec<Vector> = forces.iter().zip(&of_held).map(|(f, h)| f - h).collect();
            self.gather(&net, right.col_as_slice_mut(column));
        }
        let solved = self.factor.solve(&right);
        (0..forces.len())
            .map(|column| self.scatter(solved.col_as_slice(column)))
            .collect()
    }

    /// Nodal forces as forces on the unknowns.
    pub(crate) fn gather(&self, forces: &[Vector], unknowns: &mut [f64]) {
        unknowns.fill(0.0);
        for (node, force) in forces.iter().enumerate() {
            match (self.first[node], self.assembly.holds[node]) {
                (Some(place), _) => {
                    unknowns[place as usize] += force.x;
                    unknowns[place as usize + 1] += force.y;
                }
                (None, Hold::OnCircle(angle)) if *force != Vector::zeros() => {
                    let [x, y] = on_amplitudes_at(angle, self.largest_order);
                    for (q, (x, y)) in x.iter().zip(&y).enumerate() {
                        unknowns[self.free + q] += x * force.x + y * force.y;
                    }
                }
                _ => {}
            }
        }
    }

    fn scatter(&self, unknowns: &[f64]) -> Vec<Vector> {
        let holds = self.assembly.holds.iter().zip(&self.first);
        holds
            .map(|(hold, first)| match (*hold, *first) {
                (Hold::At(u), _) => u,
                (Hold::OnCircle(angle), _) => {
                    let amplitudes = &unknowns[self.free..];
                    let [x, y] = on_amplitudes_at(angle, self.largest_order)
                        .map(|on| on.iter().zip(amplitudes).map(|(on, a)| on * a).sum::<f64>());
                    Vector::new(x, y)
                }
                (Hold::Free, Some(place)) => {
                    Vector::new(unknowns[place as usize], unknowns[place as usize + 1])
                }
                (Hold::Free, None) => unreachable!("a free node has its place"),
            })
            .collect()
    }

    /// K u on every node, element by element.
    pub(crate) fn nodal_forces(&self, displacements: &[Vector]) -> Vec<Vector> {
        let mut forces = vec![Vector::zeros(); displacements.len()];
        for (element, k) in self.assembly.elements.iter().zip(&self.stiffnesses) {
            let nodes = element.nodes();
            for (a, &node_a) in nodes.iter().enumerate() {
                for (b, &node_b) in nodes.iter().enumerate() {
                    let u = displacements[node_b as usize];
                    forces[node_a as usize] += Vector::new(
                        k[(2 * a, 2 * b)] * u.x + k[(2 * a, 2 * b + 1)] * u.y,
                        k[(2 * a + 1, 2 * b)] * u.x + k[(2 * a + 1, 2 * b + 1)] * u.y,
                    );
                }
            }
        }
        forces
    }
}

/// What the amplitudes of the interface circle add to (u_x, u_y) at `angle`: for each order n = 0 … M the radial and the
/// tangential cosine, then the radial and the tangential sine.
fn on_amplitudes_at(angle: f64, largest_order: usize) -> [Vec<f64>; 2] {
    let (e_r, e_t) = (radial(angle), tangential(angle));
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for n in 0..=largest_order {
        let (sin, cos) = (n as f64 * angle).sin_cos();
        let waves = [cos, sin];
        for wave in waves.iter().take(if n == 0 { 1 } else { 2 }) {
            for e in [e_r, e_t] {
                x.push(wave * e.x);
                y.push(wave * e.y);
            }
        }
    }
    [x, y]
}

/// A whole gear: its teeth and its blank on the interface circle, the bore held.
pub(crate) struct WholeGear {
    pub(crate) whole: Whole,
    /// The number of each node of the tooth grid, tooth by tooth.
    pub(crate) teeth: Vec<Vec<u32>>,
    /// The number of each node of the blank's grid, sector by sector.
    pub(crate) sectors: Vec<Vec<u32>>,
    pub(crate) tooth: ToothGrid,
    pub(crate) bore: Vec<u32>,
}

impl WholeGear {
    /// `tooth_count` copies of `tooth` on `blank`, whose hole 0 stands at `phase`.
    pub(crate) fn new(
        tooth: ToothGrid,
        tooth_count: usize,
        blank: &BlankGrid,
        phase: f64,
        largest_order: usize,
        (material, thickness): (&Material, f64),
    ) -> Self {
        let mut assembly = Assembly::default();
        let (right, left) = whole_tooth_sides(&tooth);
        let teeth = assembly.add_ring(&tooth.grid, (&right, &left), tooth_count, 0.0);
        let (right, left) = whole_sides(blank);
        let sectors = assembly.add_ring(
            &blank.grid,
            (&right, &left),
            blank.sector_count as usize,
            phase,
        );
        let all = |copies: &[Vec<u32>], nodes: &[u32]| -> Vec<u32> {
            copies
                .iter()
                .flat_map(|copy| nodes.iter().map(|node| copy[*node as usize]))
                .collect()
        };
        assembly.hold(all(&teeth, &tooth.arc_nodes), on_circle);
        assembly.hold(all(&sectors, &blank.arc_nodes), on_circle);
        let mut bore = all(&sectors, &blank.bore_nodes);
        bore.sort_unstable();
        bore.dedup();
        assembly.hold(bore.iter().copied(), |_| Hold::At(Vector::zeros()));
        let whole = Whole::new(assembly, material, thickness, largest_order);
        Self {
            whole,
            teeth,
            sectors,
            tooth,
            bore,
        }
    }

    /// The node of flank node `i` of tooth `tooth`.
    pub(crate) fn flank_node(&self, tooth: usize, i: usize) -> u32 {
        self.teeth[tooth][self.tooth.flank_nodes[i] as usize]
    }

    /// No force on any node.
    pub(crate) fn no_forces(&self) -> Vec<Vector> {
        vec![Vector::zeros(); self.whole.assembly.nodes.len()]
    }
}
