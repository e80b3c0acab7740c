//! Displacements and stresses everywhere in both gears, at one mesh position.

use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;

use super::setup::Setup;
use super::spun_pair::PairState;
use super::{AnalysisError, Case};
use crate::assembly::inside::Answer;
use crate::assembly::{Blanks, Inside, PartError, Parts, Probes};
use crate::contact::{FlankLoad, MeshPhase, WarmStart};
use crate::fem::FemError;
use crate::fem::prescribed::{Load, displacements};
use crate::fem::recovery::{Functional, stresses};
use crate::gear::{Member, SpurGear, Vector, radial, tangential};
use crate::grid::{BlankGrid, Element, Grid, ToothGrid};
use crate::ring::teeth::FARTHEST_COUPLED;
use crate::run::Run;
use crate::touch::placement::{Pose, Section};

pub use crate::fem::volume::{Volume, VolumeElement, von_mises};

/// Fields of one gear, node by node, where it stands at a mesh position: the driving axis is the origin, the driven one lies on the x axis.
///
/// Each tooth and the blank have nodes of their own where they meet.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GearField {
    /// Where the nodes lie before loading, in meters.
    pub nodes: Vec<Vector>,
    /// How each of them moves against the hub of its gear, in meters.
    pub displacements: Vec<Vector>,
    /// The stresses (σ_xx, σ_yy, τ_xy) at each in Pa: the mean of the elements that meet there.
    pub stresses: Vec<[f64; 3]>,
    /// The von Mises stress at each in Pa.
    pub von_mises: Vec<f64>,
    /// The elements, on these nodes.
    pub elements: Vec<Element>,
    /// The thickness of each element in meters.
    pub thicknesses: Vec<f64>,
    /// The edges at which the gear ends, each from a corner by a midside to a corner with the material on its left: those of the
    /// teeth, tooth after tooth counter-clockwise, then those of the holes and of the bore.
    pub edges: Vec<[u32; 3]>,
}

/// Both gears at one mesh position.
#[derive(Debug, Clone, PartialEq)]
pub struct Fields<G = GearField> {
    /// How far the driven gear lags, along the line of action, in meters: the hub of each gear turns by it or stands, as one looks at it.
    pub transmission_error: f64,
    /// The driving and the driven gear.
    pub gears: [G; 2],
}

/// Where a part stands: its origin and the direction of its x axis.
#[derive(Clone, Copy)]
struct Stand {
    origin: Vector,
    angle: f64,
}

/// Both gears of `case` under `output_torque`, positive, at the mesh position `eta`, by the flexible method.
///
/// # Errors
///
/// As [`super::analyze`].
pub fn fields(
    case: &Case,
    output_torque: f64,
    eta: f64,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Fields, AnalysisError> {
    faer::set_global_parallelism(faer::Par::Seq);
    let level = case.resolution.grid;
    let state = PairState::of(case, level, parts, run)?;
    let deviations = &state.map_or_else(|| case.pair.deviations(), |state| state.deviations);
    let setup = Setup::new((case, deviations), level, FARTHEST_COUPLED, parts, run);
    let (model, _) = setup.model(Blanks::Flexible)?;
    let at = |error| AnalysisError::at_position(error, eta);
    let mut phase = MeshPhase::new(
        model.deviating(deviations),
        eta,
        case.pair.load(output_torque),
    )
    .map_err(at)?;
    let period = eta.floor() as i64;
    let (contact, loads) = phase
        .contact(period, &mut WarmStart::default(), |cells, solution| {
            Member::BOTH.map(|member| cells.flank_loads(member, &solution.forces))
        })
        .map_err(at)?;
    let pose = Pose::real(
        (&case.pair, deviations),
        Section::straight(eta, 0),
        0.0,
        (Member::Driving, eta),
    );
    let of = |member: Member| {
        let (origin, angle) = pose.frame(member);
        of_gear(
            &setup,
            member,
            &loads[member.index()],
            Stand { origin, angle },
        )
    };
    let (driving, driven) = rayon::join(|| of(Member::Driving), || of(Member::Driven));
    Ok(Fields {
        transmission_error: contact.transmission_error,
        gears: [driving?, driven?],
    })
}

/// The gear `member` under `loads`, with the centerline of tooth 0 along the x axis of `stand`.
fn of_gear(
    setup: &Setup<'_>,
    member: Member,
    loads: &[FlankLoad],
    stand: Stand,
) -> Result<GearField, AnalysisError> {
    let gear = setup.case.pair.gear(member);
    let spec = setup.spec(Blanks::Flexible);
    let grids = spec.grids(member)?;
    let along =
        |node: u32| [Vector::x(), Vector::y()].map(|axis| Functional::displacement(node, axis));
    let interface = interface_of(&grids.tooth).into_iter();
    let probes = Probes {
        in_tooth: interface.flat_map(along).collect(),
        in_blank: Vec::new(),
    };
    let inside = spec.inside(member, &grids, &probes, setup.parts, setup.run)?;
    let fem = |error: FemError| PartError::from(error).of(member);
    let loaded = inside.loaded(setup.run).map_err(fem)?;
    let answer = loaded.under(loads);
    let mut field = GearField::default();
    add_teeth(&mut field, gear, &grids.tooth, loads, &answer, stand).map_err(fem)?;
    setup.run.check()?;
    if let Some(blank) = &grids.blank {
        add_blank(&mut field, gear, blank, &inside, &answer, stand).map_err(fem)?;
    }
    Ok(field)
}

/// The nodes at which a tooth meets its neighbors and the blank.
fn interface_of(tooth: &ToothGrid) -> Vec<u32> {
    let (right, left) = &tooth.side_nodes;
    let sides = right.iter().chain(left);
    sides.chain(&tooth.arc_nodes).copied().collect()
}

fn add_teeth(
    field: &mut GearField,
    gear: &SpurGear,
    tooth: &ToothGrid,
    loads: &[FlankLoad],
    answer: &Answer<'_>,
    stand: Stand,
) -> Result<(), FemError> {
    let interface = interface_of(tooth);
    let count = gear.tooth_count() as usize;
    let flank = gear.flank();
    let on_flank = |forces: &[f64]| -> Vec<(u32, Vec<f64>)> {
        let nodes = tooth.flank_nodes.iter().zip(&tooth.flank_roll_lengths);
        nodes
            .zip(forces.chunks_exact(2))
            .map(|((node, &s), force)| {
                let to_tip = radial(flank.tangent_angle(s));
                let force = force[0] * flank.normal(s) + force[1] * to_tip;
                (*node, force.as_slice().to_vec())
            })
            .collect()
    };
    let of_tooth = |number: usize| {
        let own = loads.iter().find(|load| load.tooth == number);
        Load {
            moves: answer.in_tooth(number),
            forces: own.map_or_else(Vec::new, |load| on_flank(&load.forces)),
        }
    };
    let acting: Vec<Load> = (0..count).map(of_tooth).collect();
    let plate = (gear.material(), gear.face_width());
    let moved = displacements("the tooth", &tooth.grid, plate, &interface, &acting)?;
    let edges = free_edges(&tooth.grid, &interface);
    for (number, moved) in moved.iter().enumerate() {
        let turn = TAU * number as f64 / count as f64;
        field.add(&tooth.grid, &edges, moved, gear, stand.turned(turn));
    }
    Ok(())
}

fn add_blank(
    field: &mut GearField,
    gear: &SpurGear,
    blank: &BlankGrid,
    inside: &Inside,
    answer: &Answer<'_>,
    stand: Stand,
) -> Result<(), FemError> {
    let whole = blank.unrolled();
    let first = inside.sector_angles().first().copied().unwrap_or(0.0);
    let angles: Vec<f64> = whole.arc_angles.iter().map(|angle| angle + first).collect();
    let bore = whole.bore_nodes.iter().map(|node| {
        let point = whole.grid.nodes[*node as usize];
        point.y.atan2(point.x)
    });
    let bore: Vec<f64> = bore.collect();
    let on_arc = answer.on_circle(&angles).into_iter().zip(&whole.arc_angles);
    let on_bore = answer.on_bore(&bore).into_iter().zip(&bore);
    let moves = on_arc
        .chain(on_bore)
        .map(|([u_r, u_t], angle)| u_r * radial(*angle) + u_t * tangential(*angle));
    let acting = Load {
        moves: moves.flat_map(|u| [u.x, u.y]).collect(),
        forces: Vec::new(),
    };
    let moved: Vec<u32> = whole
        .arc_nodes
        .iter()
        .chain(&whole.bore_nodes)
        .copied()
        .collect();
    let plate = (gear.material(), gear.face_width());
    let answers = displacements("the blank", &whole.grid, plate, &moved, &[acting])?;
    let edges = free_edges(&whole.grid, &whole.arc_nodes);
    for moved in &answers {
        field.add(&whole.grid, &edges, moved, gear, stand.turned(first));
    }
    Ok(())
}

/// The edges of `grid` that belong to one element alone and do not lie between nodes of `inner`.
pub(super) fn free_edges(grid: &Grid, inner: &[u32]) -> Vec<[u32; 3]> {
    let all = || grid.elements.iter().flat_map(edges_of);
    let ends = |[from, _, to]: [u32; 3]| (from.min(to), from.max(to));
    let mut elements_at: HashMap<(u32, u32), u32> = HashMap::new();
    for edge in all() {
        *elements_at.entry(ends(edge)).or_default() += 1;
    }
    let inner: HashSet<u32> = inner.iter().copied().collect();
    let meets_another = |edge: &[u32; 3]| edge.iter().all(|node| inner.contains(node));
    all()
        .filter(|edge| elements_at[&ends(*edge)] == 1 && !meets_another(edge))
        .collect()
}

/// The edges of an element counter-clockwise.
fn edges_of(element: &Element) -> impl Iterator<Item = [u32; 3]> + '_ {
    let nodes = element.nodes();
    let corners = element.kind().corner_count();
    (0..corners).map(move |i| [nodes[i], nodes[corners + i], nodes[(i + 1) % corners]])
}

impl Stand {
    fn turned(self, by: f64) -> Self {
        Self {
            angle: self.angle + by,
            ..self
        }
    }
}

impl GearField {
    /// Adds `grid`, a part of `gear` that ends at `edges`, stands at `stand` and moves by `moved` in its own axes.
    fn add(
        &mut self,
        grid: &Grid,
        edges: &[[u32; 3]],
        moved: &[Vector],
        gear: &SpurGear,
        stand: Stand,
    ) {
        let first = self.nodes.len() as u32;
        let (e_x, e_y) = (radial(stand.angle), tangential(stand.angle));
        let turned = |v: &Vector| v.x * e_x + v.y * e_y;
        let nodes = grid.nodes.iter().map(|node| stand.origin + turned(node));
        self.nodes.extend(nodes);
        self.displacements.extend(moved.iter().map(turned));
        let stresses = stresses(grid, gear.material(), moved);
        self.stresses.extend(stresses.iter().map(|[xx, yy, xy]| {
            let along = |a: &Vector, b: &Vector| {
                xx * a.x * b.x + yy * a.y * b.y + xy * (a.x * b.y + a.y * b.x)
            };
            // The axes of the pair as the part sees them.
            let (x, y) = (Vector::new(e_x.x, e_y.x), Vector::new(e_x.y, e_y.y));
            [along(&x, &x), along(&y, &y), along(&x, &y)]
        }));
        self.von_mises.extend(
            stresses
                .iter()
                .map(|[xx, yy, xy]| (xx * xx - xx * yy + yy * yy + 3.0 * xy * xy).sqrt()),
        );
        self.edges
            .extend(edges.iter().map(|edge| edge.map(|node| first + node)));
        for element in &grid.elements {
            self.elements.push(element.renumbered(|node| first + node));
            self.thicknesses
                .push(gear.face_width() * element.thickness());
        }
    }
}
