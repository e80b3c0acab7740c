//! A small gear solved whole against the same gear condensed: first the substructures, then the trigonometric coupling.

use std::collections::HashMap;

use faer::Mat;
use meshwright_engine::gear::{SpurGear, Vector, radial, tangential};
use meshwright_engine::grid::{BlankGrid, Element, Grid, GridLevel, ToothGrid};
use meshwright_engine::run::Run;
use meshwright_engine::substructures::{
    BlankSubstructure, Coupling, Harmonics, InterfaceMotion, PlainGear, TeethRing,
    ToothSubstructure, default_interface_radius, harmonics, tooth_angle,
};

use crate::support::{gear, holed};
use crate::whole::{Assembly, Hold, Whole, WholeGear, on_circle, whole_tooth_sides};

/// Teeth and nodes on them that are loaded, and the neighbors whose answer is compared.
const LOADED_TEETH: [usize; 2] = [0, 5];
const OFFSETS: [i64; 5] = [-2, -1, 0, 1, 2];

fn small(holes: bool) -> SpurGear {
    let data = gear(18, 6e-3);
    let data = if holes {
        holed(data, 3, 10.5e-3, 2e-3, 0.21)
    } else {
        data
    };
    SpurGear::new(data).expect("a small gear")
}

fn tooth_grid(gear: &SpurGear, level: GridLevel) -> ToothGrid {
    ToothGrid::new(gear, default_interface_radius(gear), level).expect("a tooth")
}

fn blank_grid(gear: &SpurGear, level: GridLevel) -> BlankGrid {
    let r_w = default_interface_radius(gear);
    BlankGrid::new(
        gear.bore_radius(),
        r_w,
        gear.hole_pattern().as_ref(),
        gear.tooth_count(),
        6.0,
        level,
    )
    .expect("a blank")
}

/// The axes of the flank unknowns of `tooth`: the outward normal and the way to the tip.
fn flank_axes(gear: &SpurGear, tooth: usize, s: f64) -> [Vector; 2] {
    let t = gear.flank().tangent_angle(s) + tooth_angle(tooth, gear.tooth_count() as usize);
    [tangential(t), radial(t)]
}

/// Flank unknowns that are loaded: near the form point, in the middle, and near the tip.
fn loaded_unknowns(nodes: usize) -> Vec<usize> {
    let places = [2, nodes / 2, nodes - 3];
    places
        .into_iter()
        .flat_map(|node| [2 * node, 2 * node + 1])
        .collect()
}

/// What unit loads do to the flanks of neighboring teeth: for each loaded tooth and offset, all flank unknowns by the loaded
/// ones.
type Answers = Vec<Mat<f64>>;

/// Answers of the whole gear.
fn answers_of_whole(
    gear: &SpurGear,
    whole: &Whole,
    tooth: &ToothGrid,
    node: &dyn Fn(usize, usize) -> u32,
) -> Answers {
    let z = gear.tooth_count() as usize;
    let roll = &tooth.flank_roll_lengths;
    let unknowns = loaded_unknowns(roll.len());
    let mut loads = Vec::new();
    for loaded in LOADED_TEETH {
        for unknown in &unknowns {
            let mut forces = vec![Vector::zeros(); whole.assembly.nodes.len()];
            forces[node(loaded, unknown / 2) as usize] =
                flank_axes(gear, loaded, roll[unknown / 2])[unknown % 2];
            loads.push(forces);
        }
    }
    let displacements = whole.solve(&loads);
    let mut answers = Vec::new();
    for (place, loaded) in LOADED_TEETH.into_iter().enumerate() {
        for offset in OFFSETS {
            let other = (loaded as i64 + offset).rem_euclid(z as i64) as usize;
            answers.push(Mat::from_fn(
                2 * roll.len(),
                unknowns.len(),
                |row, column| {
                    let u = displacements[place * unknowns.len() + column]
                        [node(other, row / 2) as usize];
                    u.dot(&flank_axes(gear, other, roll[row / 2])[row % 2])
                },
            ));
        }
    }
    answers
}

/// Answers of the substructures: H_ij = δ_ij H_0 + V X_ij Vᵀ.
fn answers_of_substructures(
    gear: &SpurGear,
    tooth: &ToothGrid,
    blank: &BlankGrid,
    harmonics: Harmonics,
) -> Answers {
    let substructure = ToothSubstructure::new(gear, tooth).expect("a tooth");
    let ring =
        TeethRing::new(&substructure, harmonics, &Run::unattended()).expect("a ring of teeth");
    let r_w = default_interface_radius(gear);
    let (run, z) = (Run::unattended(), gear.tooth_count());
    let solid = BlankGrid::new(gear.bore_radius(), r_w, None, z, 6.0, GridLevel::Coarse);
    let [solid, blank] = [&solid.expect("a ring"), blank].map(|grid| {
        let (material, width) = (gear.material(), gear.face_width());
        BlankSubstructure::new(grid, r_w, material, width, harmonics, &run).expect("a blank")
    });
    let plain = PlainGear::new(&ring, &solid, &run).expect("a gear");
    let holed = Some((&blank, gear.hole_angle()));
    let motion = InterfaceMotion::new(&ring, &plain, holed, &run).expect("a gear");
    let coupling = Coupling::new(&motion, 4, &run).expect("a gear");
    let unknowns = loaded_unknowns(substructure.roll_lengths.len());
    let v = &substructure.modes;
    let v_loaded = Mat::from_fn(unknowns.len(), v.ncols(), |i, j| v[(unknowns[i], j)]);
    let mut answers = Vec::new();
    for loaded in LOADED_TEETH {
        for offset in OFFSETS {
            let (x, transposed) = coupling.block(loaded, offset);
            // X runs from the loaded tooth to the other one; the answer of the other one is its transpose.
            let x = if transposed {
                x.to_owned()
            } else {
                x.transpose().to_owned()
            };
            let mut h = v * (x * v_loaded.transpose());
            if offset == 0 {
                h += Mat::from_fn(v.nrows(), unknowns.len(), |i, j| {
                    substructure.fixed_compliance[(i, unknowns[j])]
                });
            }
            answers.push(h);
        }
    }
    answers
}

/// The largest difference over the largest compliance.
fn difference(one: &Answers, other: &Answers) -> f64 {
    let largest = |m: &Mat<f64>| {
        (0..m.ncols())
            .flat_map(|j| m.col_as_slice(j))
            .fold(0.0_f64, |largest, value| largest.max(value.abs()))
    };
    let scale = other.iter().map(&largest).fold(0.0, f64::max);
    one.iter()
        .zip(other)
        .map(|(a, b)| largest(&(a - b)))
        .fold(0.0, f64::max)
        / scale
}

#[test]
fn a_condensed_gear_answers_as_the_whole_gear_does() {
    let gear = small(true);
    let (tooth, blank) = (
        tooth_grid(&gear, GridLevel::Coarse),
        blank_grid(&gear, GridLevel::Coarse),
    );
    let harmonics = Harmonics { largest: 40 };
    let condensed = answers_of_substructures(&gear, &tooth, &blank, harmonics);
    let properties = (gear.material(), gear.face_width());
    let whole = WholeGear::new(tooth, 18, &blank, 0.21, harmonics.largest, properties);
    let answers = answers_of_whole(&gear, &whole.whole, &whole.tooth, &|tooth, i| {
        whole.flank_node(tooth, i)
    });
    let difference = difference(&condensed, &answers);
    println!(
        "{} unknowns: {difference:.2e} of the largest compliance",
        whole.whole.unknowns()
    );
    // Condensation is exact; what is left is rounding, and modes below 1e-11 of the largest.
    assert!(difference < 1e-9);
}

/// One pitch of a solid gear with the nodes of the interface circle shared one by one: the tooth on polar blocks that
/// continue its arc to the bore.
struct Conforming {
    grid: Grid,
    /// Blank alone, with its nodes on the arc in the tooth's order.
    blank: Grid,
    blank_arc: Vec<u32>,
    /// Nodes of the bore in both.
    bore: Vec<u32>,
    blank_bore: Vec<u32>,
    /// Sides of both, inward ends included.
    sides: (Vec<u32>, Vec<u32>),
    blank_sides: (Vec<u32>, Vec<u32>),
}

impl Conforming {
    fn new(gear: &SpurGear, tooth: &ToothGrid, layers: usize) -> Self {
        let (r_w, r_0) = (default_interface_radius(gear), gear.bore_radius());
        // Rows of nodes from the interface circle inward; the eight-node element has no node at its center.
        let columns = tooth.arc_angles.len();
        let rows = 2 * layers + 1;
        let mut blank = Grid {
            nodes: Vec::new(),
            elements: Vec::new(),
        };
        let mut at = vec![u32::MAX; rows * columns];
        for row in 0..rows {
            let r = r_w * (r_0 / r_w).powf(row as f64 / (rows - 1) as f64);
            for column in (0..columns).filter(|column| row % 2 == 0 || column % 2 == 0) {
                at[row * columns + column] = blank.nodes.len() as u32;
                blank.nodes.push(r * radial(tooth.arc_angles[column]));
            }
        }
        for row in (0..rows - 1).step_by(2) {
            for column in (0..columns - 1).step_by(2) {
                let n = |i: usize, j: usize| at[(row + i) * columns + column + j];
                // Counter-clockwise: outward is up, growing angles run to the left as seen from there.
                blank.elements.push(Element::quadrilateral([
                    n(2, 0),
                    n(0, 0),
                    n(0, 2),
                    n(2, 2),
                    n(1, 0),
                    n(0, 1),
                    n(1, 2),
                    n(2, 1),
                ]));
            }
        }
        let row_of = |row: usize| at[row * columns..(row + 1) * columns].to_vec();
        let (blank_arc, blank_bore) = (row_of(0), row_of(rows - 1));
        let side = |column: usize| -> Vec<u32> {
            (0..rows)
                .rev()
                .map(|row| at[row * columns + column])
                .collect()
        };
        let blank_sides = (side(0), side(columns - 1));

        let mut one = Assembly::default();
        one.add(&tooth.grid, 0.0, &HashMap::new());
        let shared: HashMap<u32, u32> = blank_arc
            .iter()
            .copied()
            .zip(tooth.arc_nodes.iter().copied())
            .collect();
        for (own, theirs) in &shared {
            let apart = blank.nodes[*own as usize] - tooth.grid.nodes[*theirs as usize];
            assert!(apart.norm() < 1e-12, "shared nodes lie in one place");
        }
        let numbers = one.add(&blank, 0.0, &shared);
        let joined = |blank: &[u32], tooth: &[u32]| -> Vec<u32> {
            blank
                .iter()
                .map(|node| numbers[*node as usize])
                .chain(tooth[1..].iter().copied())
                .collect()
        };
        let (tooth_right, tooth_left) = whole_tooth_sides(tooth);
        Self {
            sides: (
                joined(&blank_sides.0, &tooth_right),
                joined(&blank_sides.1, &tooth_left),
            ),
            bore: blank_bore
                .iter()
                .map(|node| numbers[*node as usize])
                .collect(),
            grid: Grid {
                nodes: one.nodes,
                elements: one.elements,
            },
            blank,
            blank_arc,
            blank_bore,
            blank_sides,
        }
    }

    fn hold_all(
        assembly: &mut Assembly,
        copies: &[Vec<u32>],
        nodes: &[u32],
        hold: fn(Vector) -> Hold,
    ) {
        let all: Vec<u32> = copies
            .iter()
            .flat_map(|copy| nodes.iter().map(|node| copy[*node as usize]))
            .collect();
        assembly.hold(all, hold);
    }

    /// Answers with the nodes shared.
    fn answers(&self, gear: &SpurGear, tooth: &ToothGrid) -> Answers {
        let mut assembly = Assembly::default();
        let z = gear.tooth_count() as usize;
        let copies = assembly.add_ring(&self.grid, (&self.sides.0, &self.sides.1), z, 0.0);
        Self::hold_all(&mut assembly, &copies, &self.bore, |_| {
            Hold::At(Vector::zeros())
        });
        let whole = Whole::new(assembly, gear.material(), gear.face_width(), 0);
        // The tooth came first, so that its nodes keep their numbers.
        answers_of_whole(gear, &whole, tooth, &|i, node| {
            copies[i][tooth.flank_nodes[node] as usize]
        })
    }

    /// Answers with the same blocks on either side of a circle that moves by harmonics up to `largest_order`.
    fn answers_by_harmonics(
        &self,
        gear: &SpurGear,
        tooth: &ToothGrid,
        largest_order: usize,
    ) -> Answers {
        let mut assembly = Assembly::default();
        let z = gear.tooth_count() as usize;
        let (right, left) = whole_tooth_sides(tooth);
        let teeth = assembly.add_ring(&tooth.grid, (&right, &left), z, 0.0);
        let (right, left) = &self.blank_sides;
        let blanks = assembly.add_ring(&self.blank, (right, left), z, 0.0);
        Self::hold_all(&mut assembly, &teeth, &tooth.arc_nodes, on_circle);
        Self::hold_all(&mut assembly, &blanks, &self.blank_arc, on_circle);
        Self::hold_all(&mut assembly, &blanks, &self.blank_bore, |_| {
            Hold::At(Vector::zeros())
        });
        let whole = Whole::new(assembly, gear.material(), gear.face_width(), largest_order);
        answers_of_whole(gear, &whole, tooth, &|i, node| {
            teeth[i][tooth.flank_nodes[node] as usize]
        })
    }
}

#[test]
fn harmonics_on_the_interface_circle_do_what_shared_nodes_do() {
    let gear = small(false);
    for level in [GridLevel::Coarse, GridLevel::Standard] {
        let tooth = tooth_grid(&gear, level);
        let conforming = Conforming::new(
            &gear,
            &tooth,
            if level == GridLevel::Coarse { 8 } else { 16 },
        );
        let exact = conforming.answers(&gear, &tooth);
        let r_w = default_interface_radius(&gear);
        let shipped = harmonics(&gear, r_w, level).largest;
        let grown = shipped * 3 / 2;
        let of = |largest: usize| {
            difference(
                &conforming.answers_by_harmonics(&gear, &tooth, largest),
                &exact,
            )
        };
        let (with_shipped, with_grown) = (of(shipped), of(grown));
        // The blank's own grid, as the engine lays it, instead of the continued arcs.
        let own = answers_of_substructures(
            &gear,
            &tooth,
            &blank_grid(&gear, level),
            Harmonics { largest: shipped },
        );
        let with_own = difference(&own, &exact);
        println!(
            "{level:?}: {shipped} orders {with_shipped:.2e}, {grown} orders {with_grown:.2e}, own blank grid {with_own:.2e}"
        );
        let bound = if level == GridLevel::Coarse {
            2e-3
        } else {
            5e-4
        };
        assert!(with_shipped < bound && with_own < bound);
        assert!(with_grown < with_shipped, "more orders come nearer");
    }
}
