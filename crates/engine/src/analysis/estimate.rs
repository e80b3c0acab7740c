//! Estimate of the cost of a case before it is computed.

use super::at_speed::{run_up_cost, usual_stiffness};
use super::case::Model;
use super::case::{Case, Faces};
use super::cost::{Estimate, PartSpec};
use super::forces::{ForcesRequest, TablePlan};
use super::plan::{Pass, Plan};
use super::running::Running;
use crate::assembly::blank::blank_grid;
use crate::assembly::interface::{harmonics, interface_radius, orders_of_blank};
use crate::assembly::pair_spec::cells_per_patch;
use crate::assembly::{FaceComplianceSpec, GearSpec};
use crate::contact::{ContactSolver, default_penalty};
use crate::gear::{Member, SpurGear, gcd};
use crate::grid::{BlankGrid, GridLevel, ToothGrid};
use crate::ring::shaft::orders_of_edge;
use crate::touch::gap_profile::GapProfile;
use crate::vibration::rotation;

/// Seconds of one core for the first contact solution at a fraction of the mesh period, for each further one there, and for a linear
/// system of the augmented Lagrangian, all with the cells of [`CELLS`]; and for a multiplication and addition of dense linear algebra. Measured on a 2.6 GHz server
/// core.
const SECONDS: [f64; 4] = [0.27e-3, 0.035e-3, 0.02e-3, 0.065e-9];

/// Seconds of one core for a node of a tooth and of a blank. Measured as [`SECONDS`].
const NODE_SECONDS: [f64; 2] = [13e-6, 6.5e-6];

/// Seconds of one core for any case, and for the effect of holes at a position to the first order. Measured as [`SECONDS`].
const BASE_SECONDS: f64 = 0.01;
const FIRST_ORDER_SECONDS: f64 = 0.03e-3;

/// Two patches at the standard level. The time of a solution grows as the cells, and as their third power where load brings more pairs together than three.
const CELLS: f64 = 80.0;

/// Pairs beyond which tips dig in, and patches are placed again, wider; and how much longer a first solution takes then.
const FEW_PAIRS: usize = 3;
const DIGGING: f64 = 3.0;

/// How far from the pitch point pairs are looked for.
const FARTHEST_PAIR: i64 = 16;

/// Seconds of one core, for each of its teeth, in which a gear answers to a contact with its stresses.
const PER_ANSWER: f64 = 3.5e-6;

/// Bytes of one position: its contact, its place in the curves and in the document.
const POSITION_MEMORY: f64 = 1e3;

/// Patterns of force that a tooth exerts on the interface circle, about.
const PATTERNS: f64 = 18.0;

/// Memory of any case in bytes, including the stored data of its flanks.
const BASE_MEMORY: f64 = 56e6;

/// Estimates the cost of `case` with its `forces`; the grids are divided, nothing is solved. A gear whose grid fails costs nothing.
pub fn estimate(case: &Case, forces: Option<&ForcesRequest>) -> Estimate {
    let plan = Plan::of(case);
    let mut estimate = Estimate {
        memory: BASE_MEMORY as u64,
        seconds: BASE_SECONDS,
        ..Estimate::default()
    };
    match &case.model {
        Model::Formulas(_) => {}
        Model::Faces(faces, _) => add_faces(&mut estimate, &plan, faces),
        Model::Section(_) => add_gears(&mut estimate, &plan),
    }
    for window in case.windowed() {
        add_contacts(&mut estimate, &Plan::of(&window));
    }
    if let Some(at_rest) = case.at_rest() {
        // The gears are the same.
        add_contacts(&mut estimate, &Plan::of(&at_rest));
    }
    if let Some(forces) = forces {
        // The gears are the same.
        for plan in TablePlan::of(case, forces.table).plans() {
            add_contacts(&mut estimate, plan);
        }
        if let Some(request) = &forces.dynamics {
            let (seconds, memory) = run_up_cost(case, request);
            estimate.seconds += seconds;
            estimate.memory += memory;
        }
    }
    estimate
}

/// Adds the cost of the contacts of `plan`.
fn add_contacts(estimate: &mut Estimate, plan: &Plan) {
    let case = &plan.case;
    let positions = (case.positions() * case.output_torques.len()) as u64;
    estimate.memory += (POSITION_MEMORY * positions as f64) as u64;
    estimate.seconds += match &case.model {
        Model::Formulas(_) => SECONDS[0] / 10.0 * plan.solutions() as f64,
        Model::Faces(faces, _) => {
            estimate.memory += 8 * (positions * faces.slices as u64);
            add_drawn(estimate, plan, faces);
            let of_phase = plan.hole_phase.as_ref().map_or(0.0, |phase| {
                let solutions = [phase.solutions(), phase.first_solutions()];
                of_slices(case, faces, case.resolution.grid, solutions)
            });
            along_faces(plan, faces) + of_phase
        }
        Model::Section(_) => {
            let of_passes = case.output_torques.iter().flat_map(|torque| {
                let each = plan.passes.iter();
                each.map(|pass| {
                    let solutions = [pass.solutions(), pass.first_solutions()];
                    in_plane(case, *torque, pass.level, solutions)
                })
            });
            let of_phase = plan.hole_phase.as_ref().map_or(0.0, |phase| {
                let solutions = [phase.solutions(), phase.first_solutions()];
                in_plane(case, phase.output_torque(), case.resolution.grid, solutions)
            });
            let by_holes = if case.method().is_projected() {
                FIRST_ORDER_SECONDS * positions as f64
            } else {
                0.0
            };
            of_passes.sum::<f64>() + of_phase + by_holes
        }
    };
}

/// Adds the cost of the plane gears of `plan`, and of their answers to contacts.
fn add_gears(estimate: &mut Estimate, plan: &Plan) {
    for (number, pass) in plan.passes.iter().enumerate() {
        for member in Member::BOTH {
            let again = plan.hole_phase.as_ref().filter(|_| number == 0);
            let again = again.map_or(0, |phase| phase.joined(member));
            let Some(gear) = GearCost::of(&plan.case, member, pass, again) else {
                continue;
            };
            estimate.memory += gear.memory;
            if number == 0 {
                estimate.degrees_of_freedom += gear.degrees_of_freedom;
            }
            let mut times = 1_u64;
            if number == 0 && plan.case.runs().is_some() {
                // It is made once more, with the rows of its rotation.
                times += 1;
            }
            if pass.stress {
                // It is made once more, with the rows of its inside.
                times += 1;
                let teeth = f64::from(plan.case.pair.gear(member).tooth_count());
                estimate.seconds += PER_ANSWER * teeth * answers(plan, pass);
            }
            estimate.memory += gear.memory / 4 * (times - 1);
            let times = times as f64;
            let teeth = PartSpec::Teeth(Box::new(gear.spec.teeth.clone()));
            estimate.add_part(teeth, times * gear.teeth_seconds);
            let joined = PartSpec::Gear(Box::new(gear.spec));
            estimate.add_part(joined, times * gear.joined_seconds);
        }
    }
}

/// Contacts that gears answer to with their stresses in a `pass` of `plan`.
fn answers(plan: &Plan, pass: &Pass) -> f64 {
    (pass.curve.solved_positions() * plan.case.loaded_torques().count()) as f64
}

/// Seconds of one core for the yield of one gear with nine functions across the face, and the power of these by which it grows. Measured as [`SECONDS`].
const FACE_SECONDS: f64 = 0.5;
const FACE_GROWTH: f64 = 3.4;

/// Seconds of one core for the contact of a slice: the first at its fraction of the mesh period, a further one there, and one where teeth deviate. Measured as
/// [`SECONDS`].
const SLICE_SECONDS: [f64; 3] = [80e-6, 40e-6, 120e-6];

/// The same of a slice as drawn on which teeth that deviate are solved, and of each solution on it.
const DRAWN_SLICE_SECONDS: [f64; 2] = [160e-6, 2e-6];

/// Limit of the memory of such slices in bytes.
const DRAWN_MEMORY: u64 = 24 << 20;

/// Seconds of one core for the rows that lead to the edges of the holes of one gear. Measured as [`SECONDS`].
const EDGE_SECONDS: f64 = 1.0;

/// How many times as long as the displacement of flanks by rotation that of edges takes, whose fillets are divided more finely.
const EDGES_OF_ROTATION: f64 = 5.0;

/// Seconds of one core for the rows that lead to the roots of one gear at the order 8, and for the answer of one of its teeth at a position;
/// and bytes of such rows while they are made. Measured as [`SECONDS`].
const ROOT_SECONDS: [f64; 2] = [2.5, 0.25e-3];
const ROOT_MEMORY: f64 = 290e6;

/// Teeth whose roots answer at a position, about.
const TEETH_ANSWERING: f64 = 20.0;

/// Positions in whose time a lead is tried at one, about.
const EVENING: u64 = 2;

/// Bytes of one gear with nine functions across the face while it is made, and of its web besides.
const FACE_MEMORY: [f64; 2] = [110e6, 60e6];

/// Seconds of one core for a multiplication and addition in which a web with holes is condensed, or holes answer to flanks. Measured as [`SECONDS`].
const COUPLING_SECONDS: f64 = 0.05e-9;

/// Nodes of a tooth and its rim in a section, about.
const SECTION_NODES: f64 = 330.0;

/// Adds the cost of the gears of `plan` along their `faces`, and of their answers to contacts.
fn add_faces(estimate: &mut Estimate, plan: &Plan, faces: &Faces) {
    let case = &plan.case;
    for (number, pass) in plan.passes.iter().enumerate() {
        let resolution = faces.at(pass.level).resolution;
        let nodes = match pass.level {
            GridLevel::Coarse => 0.3,
            GridLevel::Standard => 1.0,
            GridLevel::Fine => 3.5,
        };
        for member in Member::BOTH {
            let spec = FaceComplianceSpec::new(faces.pair.gear(member), resolution);
            let gear = case.pair.gear(member);
            // Once more with each turn of its blank, and in the mirror.
            let again = plan.hole_phase.as_ref().filter(|_| number == 0);
            let turned = f64::from(again.map_or(1, |phase| 1 + phase.joined(member)));
            let mirrored = f64::from(1 + u8::from(again.is_some()));
            let webs = mirrored * f64::from(gear.data().blank.web_in(gear.face_width()).is_some());
            let functions = spec.functions_across() as f64;
            let growth = functions / 9.0;
            let mut seconds =
                mirrored * FACE_SECONDS * growth.powf(FACE_GROWTH) * nodes * f64::sqrt(nodes);
            let bytes =
                FACE_MEMORY[0] * growth.powi(2) * nodes * f64::sqrt(nodes) + webs * FACE_MEMORY[1];
            let mut of_holes = spec.cost_of_holes(false);
            if pass.stress {
                // They are condensed once more, with the rows of their edges.
                let edges = spec.cost_of_holes(true);
                of_holes.operations += edges.operations;
                of_holes.memory = of_holes.memory.max(edges.memory);
            }
            seconds += turned * COUPLING_SECONDS * of_holes.operations;
            let coupled = spec.coupled_unknowns().map(|count| count as f64);
            let flank = spec.basis_len() as f64 * repeated_teeth(gear);
            seconds += turned * COUPLING_SECONDS * coupling(coupled, flank);
            // The form of all, and of each set its matrix, the factors and what they are made of.
            let coupling = 8.0 * (6.0 * coupled[0] * coupled[1] + coupled[1] * flank);
            let kept = 8.0 * coupled[1] * flank;
            estimate.memory += (bytes + of_holes.memory.max(coupling) + kept) as u64;
            if number == 0 {
                let teeth = f64::from(gear.tooth_count());
                estimate.degrees_of_freedom +=
                    (3.0 * functions * nodes * SECTION_NODES * teeth) as u64;
            }
            estimate.add_part(PartSpec::Face(Box::new(spec)), seconds);
        }
        let is_loaded = |running: &Running| !running.grows_evenly();
        if case.runs().is_some_and(is_loaded) {
            let of = [(number == 0, 1.0), (pass.stress, EDGES_OF_ROTATION)].into_iter();
            let times: f64 = of.filter(|(is, _)| *is).map(|(_, times)| times).sum();
            for member in Member::BOTH.into_iter().filter(|_| times > 0.0) {
                let [seconds, bytes] = rotation::estimate(faces.pair.gear(member));
                estimate.seconds += times * seconds;
                // Both at once, before the contacts.
                estimate.memory += bytes as u64 / 2;
            }
        }
        if pass.stress {
            let [per_gear, per_answer] = ROOT_SECONDS;
            let answers = 2.0 * TEETH_ANSWERING * answers(plan, pass);
            // The edges of holes are condensed as the web is.
            let made = 2.0 * per_gear + case.holed().len() as f64 * EDGE_SECONDS;
            let growth = (resolution.face_order + 1) as f64 / 9.0;
            estimate.seconds += made * growth.powf(2.5) + per_answer * growth * answers;
            estimate.memory += (2.0 * ROOT_MEMORY * growth.powi(2)) as u64;
        }
    }
}

/// The teeth of `gear` after which all repeats around it.
fn repeated_teeth(gear: &SpurGear) -> f64 {
    let teeth = gear.tooth_count();
    f64::from(teeth / gcd(teeth, gear.hole_repeats().max(1)))
}

/// Multiplications and additions in which the `coupled` unknowns of holes respond to a number of functions on flanks: of each set of orders that do not couple, a
/// factorization, and a product and a solution for each function.
fn coupling([set, all]: [f64; 2], functions: f64) -> f64 {
    all / set.max(1.0) * set * set * (set / 3.0 + 2.0 * functions)
}

/// Adds the cost of the slices of the drawn pair on which `plan` solves teeth that deviate. Pairs made to one drawing share them.
fn add_drawn(estimate: &mut Estimate, plan: &Plan, faces: &Faces) {
    if !plan.case.is_solved_as_drawn() {
        return;
    }
    let torques = plan.case.loaded_torques().count() as u64;
    for pass in &plan.passes {
        let faces = faces.at(pass.level);
        let fractions = torques * pass.curve.lattice_fractions();
        let seconds = DRAWN_SLICE_SECONDS[0] * slices_together(&faces) * fractions as f64;
        estimate.memory += DRAWN_MEMORY;
        estimate.add_part(
            PartSpec::DrawnFaces(Box::new(faces.drawn_contacts())),
            seconds,
        );
    }
}

/// Slices that come together at a position, about: two pairs or more carry along all of the face.
fn slices_together(faces: &Faces) -> f64 {
    faces.slices as f64 * (1.0 + faces.pair.total_contact_ratio())
}

/// Seconds that the contacts of `plan` take along the faces.
fn along_faces(plan: &Plan, faces: &Faces) -> f64 {
    let torques = plan.case.loaded_torques().count() as f64;
    let of_pass = |pass: &Pass| {
        let evened = EVENING * pass.evened.len() as u64;
        if plan.case.is_solved_as_drawn() {
            let solved = (pass.solutions() - pass.checks.solutions()) as f64;
            let on_drawn = slices_together(&faces.at(pass.level)) * solved;
            let exact = pass.checks.solutions() + evened;
            let exact = of_slices(&plan.case, faces, pass.level, [exact, exact]);
            return torques * (DRAWN_SLICE_SECONDS[1] * on_drawn + exact);
        }
        let firsts = pass.first_solutions();
        let solutions = [pass.solutions() + evened, firsts + evened];
        torques * of_slices(&plan.case, faces, pass.level, solutions)
    };
    plan.passes.iter().map(of_pass).sum()
}

/// Seconds that contacts of `case` along `faces` take at a grid `level`: `solutions` in all, `firsts` of them the first at their fraction of the mesh period.
fn of_slices(case: &Case, faces: &Faces, level: GridLevel, [solutions, firsts]: [u64; 2]) -> f64 {
    let [per_first, as_drawn, deviating] = SLICE_SECONDS;
    let per_further = if case.pair.is_as_drawn() {
        as_drawn
    } else {
        deviating
    };
    let further = (solutions - firsts) as f64;
    let each = per_first * firsts as f64 + per_further * further;
    slices_together(&faces.at(level)) * each
}

/// Seconds that contacts of `case` under a torque take in the plane: their number, and how many of them are the first at their fraction of the mesh period.
fn in_plane(
    case: &Case,
    output_torque: f64,
    level: GridLevel,
    [solutions, firsts]: [u64; 2],
) -> f64 {
    let [per_first, per_further, per_system, _] = SECONDS;
    let further = (solutions - firsts) as f64;
    let [solutions, firsts] = [solutions, firsts].map(|count| count as f64);
    let pairs = pairs_together(case, output_torque);
    let cells = (pairs * cells_per_patch(level)) as f64 / CELLS;
    let [first, times] = match pairs > FEW_PAIRS {
        true => [DIGGING * per_first, cells.powi(3)],
        false => [per_first, cells],
    };
    let solved = first * firsts + per_further * further;
    times * (solved + per_system * systems(case) * solutions)
}

/// The tooth pairs that come together under a torque, about.
fn pairs_together(case: &Case, output_torque: f64) -> usize {
    let pair = &case.pair;
    let delta = pair.load(output_torque) / usual_stiffness(pair);
    let within = |n: &i64| {
        GapProfile::drawn(pair, 0.5 - *n as f64).is_some_and(|facing| facing.touch() <= delta)
    };
    let near = (-FARTHEST_PAIR..=FARTHEST_PAIR).filter(within).count();
    near.max(pair.contact_ratio().ceil() as usize)
}

/// Linear systems that the augmented Lagrangian solves at a position, about: none for the active set.
fn systems(case: &Case) -> f64 {
    let ContactSolver::AugmentedLagrangian {
        penalty,
        gap_tolerance,
    } = case.resolution.contact_solver
    else {
        return 0.0;
    };
    // An update leaves 1/(1 + κ h) of the error, with h of the default penalty that leaves a hundredth.
    let strength = penalty.map_or(100.0, |penalty| {
        100.0 * penalty / default_penalty(&case.pair)
    });
    let first_error = 1e-3 * case.pair.driving().data().rack.module;
    let updates = (first_error / gap_tolerance).max(1.0).ln() / strength.ln_1p();
    5.0 + updates.min(2000.0)
}

/// Cost of making one gear, in all models that a pass needs of it.
struct GearCost {
    spec: GearSpec,
    degrees_of_freedom: u64,
    memory: u64,
    /// Time on one core in seconds, of its teeth, and of its blank and of joining them.
    teeth_seconds: f64,
    joined_seconds: f64,
}

impl GearCost {
    /// The cost of a gear for `pass`, joined with its blank `again` times; `None` where its grid fails.
    fn of(case: &Case, member: Member, pass: &Pass, again: u32) -> Option<Self> {
        let level = pass.level;
        let [.., per_operation] = SECONDS;
        let [per_tooth_node, per_blank_node] = NODE_SECONDS;
        let gear = case.pair.gear(member);
        let radius = interface_radius(gear, case.resolution.interface_radii[member.index()]);
        let tooth = ToothGrid::new(gear, radius, level).ok()?;
        let blank = blank_grid(gear, radius, level).ok()?;
        let (teeth, sectors) = (u64::from(gear.tooth_count()), u64::from(blank.sector_count));
        let tooth_nodes = (tooth.grid.nodes.len() - tooth.side_nodes.0.len() - 1) as u64;
        let blank_nodes = blank.own_nodes() as u64;

        let orders = orders_of_blank(gear, radius, level);
        let (all, met) = (
            harmonics(gear, radius, level).unknowns() as f64,
            orders.unknowns() as f64,
        );
        // A gear that repeats itself keeps the rows of the teeth of one period.
        let repeats = f64::from(gcd(gear.tooth_count(), blank.sector_count));
        let rows = teeth as f64 / repeats;
        // One model has this blank flexible; in another that stands beside it the coupling of all teeth is the same.
        let joined = f64::from(1 + again);
        let couplings = joined * rows + if pass.has_rigid_blanks() { 17.0 } else { 0.0 };
        // At most two matrices of all orders at once: the ring of teeth, and the matrix that is factorized.
        let mut memory = (8.0
            * (2.0 * all * all
                + 2.0 * met * rows.min(32.0) * PATTERNS
                + 5.0 * couplings * (2.0 * PATTERNS).powi(2))
            + 3e3 * (tooth_nodes + blank_nodes) as f64) as u64;
        if gear.data().blank.shaft().is_some() {
            let edge = orders_of_edge(&blank).unknowns() as f64;
            memory += (8.0 * 2.0 * edge * (edge + met)) as u64;
        }
        let factorization = met * met * met / (6.0 * repeats * repeats);
        let answers = rows * PATTERNS * met * (met / (2.0 * repeats) + 5.0 * PATTERNS);
        let operations = condensed(&blank, met) + joined * (factorization + answers);
        Some(Self {
            spec: GearSpec::on_own_blank(gear, radius, level, 0),
            degrees_of_freedom: 2 * (teeth * tooth_nodes + sectors * blank_nodes),
            memory,
            teeth_seconds: per_tooth_node * tooth_nodes as f64,
            joined_seconds: per_blank_node * blank_nodes as f64 + per_operation * operations,
        })
    }
}

/// Multiplications and additions in which `blank` is condensed to the nodes of its circle and its sides, and these to the `met` unknowns on the circle.
fn condensed(blank: &BlankGrid, met: f64) -> f64 {
    let sectors = f64::from(blank.sector_count);
    let [arc, side] =
        [blank.arc_nodes.len(), blank.side_nodes.0.len()].map(|nodes| 2.0 * nodes as f64);
    let kept = arc + 2.0 * side;
    // Sectors are joined class by class in complex numbers, each class with its own orders and half of all classes.
    let (times, each) = if side > 0.0 {
        (2.0, met / sectors)
    } else {
        (1.0, met)
    };
    let on_sides = side * side * (side / 6.0 + each);
    kept.powi(3) / 3.0 + times * sectors * (arc * each * (arc + each) + on_sides)
}
