//! Gear bodies that vibrate, from their drawings and their elements.

use std::f64::consts::PI;

use nalgebra::{Matrix6, SMatrix};

use super::blank_modes::{of_modes, solid};
use super::case::Model;
use super::{AnalysisError, Case};
use crate::assembly::interface::interface_radius;
use crate::assembly::{BlankSpec, PartError, Parts};
use crate::dynamics::mount::{self, MOTIONS, Rows};
use crate::dynamics::torsion::{Ring, Rotor};
use crate::dynamics::{Body, BodyWave, Mount, Support};
use crate::fem::FemError;
use crate::fem::dense::Cholesky;
use crate::gear::{BlankRegion, Member, SolidGear, Web};
use crate::ring::blank::BlankSubstructure;
use crate::ring::cyclic::Component;
use crate::run::Run;
use crate::vibration::{self, BoreSupport, Direction, Mode, ModesAsked};

/// Rings into which the band of a hole is divided.
const BANDS: u32 = 8;

/// Largest factor by which holes soften their rings beyond the share of material that they leave.
const SOFTEST: f64 = 1e3;

/// The twist of a blank with holes, of its elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist {
    /// The radius in m of the circle that turns.
    pub radius: f64,
    /// Its angle against a held bore over the torque all around it, in rad/(N m).
    pub angle: f64,
}

/// The twists of the driving and of the driven blank; `None` where the blank is the same all around.
pub type Twists = [Option<Twist>; 2];

/// Both blanks of a case as the run-up has them, by elements.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Blanks {
    /// How far they twist.
    pub twists: Twists,
    /// Their modes other than in torsion, the lowest first; none where they are not asked for.
    pub waves: [Vec<BodyWave>; 2],
}

impl Blanks {
    /// The blanks of `case`, with their modes other than in torsion up to the circular frequency `highest` if there is one.
    ///
    /// # Errors
    ///
    /// As for [`analyze`](super::analyze()).
    pub fn of(
        case: &Case,
        highest: Option<f64>,
        parts: &dyn Parts,
        run: &Run,
    ) -> Result<Self, AnalysisError> {
        let mut waves = [Vec::new(), Vec::new()];
        if let Some(highest) = highest {
            waves[0] = self::waves(case, Member::Driving, highest, run)?;
            // Equal gears vibrate alike.
            let gears = Member::BOTH.map(|member| case.solid_gear(member));
            waves[1] = if gears[0] == gears[1] {
                waves[0].clone()
            } else {
                self::waves(case, Member::Driven, highest, run)?
            };
        }
        Ok(Self {
            twists: twists(case, parts, run)?,
            waves,
        })
    }
}

/// The modes other than in torsion of a gear of `case` up to the circular frequency `highest` with its bore held: in the plane, and out of it where the model
/// has a face.
fn waves(
    case: &Case,
    member: Member,
    highest: f64,
    run: &Run,
) -> Result<Vec<BodyWave>, AnalysisError> {
    let gear = solid(case, member)?;
    let asked = ModesAsked {
        count: vibration::most_modes(gear.section().tooth_count()),
        highest: Some(highest / (2.0 * PI)),
        bore: BoreSupport::Held,
    };
    let found = vibration::modes(&gear, asked, run).map_err(|error| of_modes(error, member))?;
    let [radial, tangential, axial, ..] = at_mesh(case, member);
    let is_seen = |mode: &&Mode| match mode.direction {
        Direction::Torsion => false,
        Direction::InPlane => true,
        Direction::OutOfPlane => case.faces().is_some(),
    };
    let wave = |mode: &Mode| BodyWave {
        frequency: 2.0 * PI * mode.frequency,
        at_mesh: mode.around(&[radial, tangential, axial]),
        diameters: mode.nodal_diameters,
        split: mode.split(),
    };
    Ok(found.iter().filter(is_seen).map(wave).collect())
}

/// The twists of the blanks of `case`.
///
/// # Errors
///
/// As for [`analyze`](super::analyze()).
pub fn twists(case: &Case, parts: &dyn Parts, run: &Run) -> Result<Twists, AnalysisError> {
    let mut twists = [None; 2];
    for member in Member::BOTH {
        let gear = case.pair.gear(member);
        if gear.holes().is_empty() || matches!(case.model, Model::Formulas(_)) {
            continue;
        }
        let asked = case.resolution.interface_radii[member.index()];
        let radius = interface_radius(gear, asked);
        let spec = BlankSpec::new(gear, radius, case.resolution.grid);
        let made = parts.blank(&spec, run).and_then(|blank| Ok(twist(&blank)?));
        twists[member.index()] = Some(made.map_err(|error: PartError| error.of(member))?);
    }
    Ok(twists)
}

/// The twist of `blank` under a torque that acts evenly around its circle, which is free to take any shape.
fn twist(blank: &BlankSubstructure) -> Result<Twist, FemError> {
    let unknowns = blank.stiffness.ncols();
    let round = blank.harmonics.cosine(0, Component::Tangential);
    let radius = blank.interface_radius;
    let mut moved = faer::Mat::zeros(unknowns, 1);
    // A torque of 1 does the work of its angle.
    moved[(round, 0)] = 1.0 / radius;
    Cholesky::new(blank.stiffness.clone())
        .ok_or(FemError::NotPositiveDefinite {
            part: "the blank in torsion",
            unknowns,
        })?
        .solve_in_place(moved.as_mut());
    Ok(Twist {
        radius,
        angle: moved[(round, 0)] / radius,
    })
}

/// The body of a gear of `case` with this inertia or its own, which twists by `twist`, with its modes up to the circular frequency and the number of
/// `limits`, on its `mount`.
pub(super) fn body(
    case: &Case,
    member: Member,
    inertia: Option<f64>,
    twist: Option<Twist>,
    (highest, most): (f64, usize),
    mount: Mount,
) -> Body {
    let own = own_inertia(case, member);
    let base_radius = case.pair.gear(member).base_radius();
    let modes = if has_modes(case, member, inertia) {
        rotor(case, member, own, twist).modes(base_radius, highest, most)
    } else {
        Vec::new()
    };
    Body {
        inertia: inertia.unwrap_or(own),
        base_radius,
        modes,
        waves: Vec::new(),
        mount,
    }
}

/// True if a gear of `case` with this inertia has modes: with less than that of its drawing it has none, and neither has it where its compliance comes from
/// formulas.
pub(super) fn has_modes(case: &Case, member: Member, inertia: Option<f64>) -> bool {
    let is_enough = inertia.is_none_or(|inertia| inertia >= own_inertia(case, member));
    is_enough && !matches!(case.model, Model::Formulas(_))
}

/// The polar inertia of a gear as drawn, in kg m².
pub(super) fn own_inertia(case: &Case, member: Member) -> f64 {
    match case.faces() {
        Some(faces) => faces.pair.gear(member).polar_inertia(),
        None => case.pair.gear(member).polar_inertia(),
    }
}

/// A ring of a blank, with the share of it that holes take.
#[derive(Debug, Clone, Copy)]
struct Band {
    radii: [f64; 2],
    /// How wide it is along the axis, and where its middle stands from that of the face.
    thickness: f64,
    offset: f64,
    open: f64,
}

/// Rings of a blank between bore and root circle.
fn bands(case: &Case, member: Member) -> Vec<Band> {
    let gear = case.pair.gear(member);
    let blank = &gear.data().blank;
    let solid = case.faces().map(|of| of.pair.gear(member));
    let hub = solid.and_then(SolidGear::hub);
    let (bore, root) = (blank.bore_radius, gear.root_radius());
    let mut edges = vec![bore, root];
    edges.extend(
        blank
            .web
            .iter()
            .flat_map(|web| [web.inner_radius, web.outer_radius]),
    );
    edges.extend(hub.map(|hub| hub.outer_radius));
    for hole in &blank.holes {
        let [inner, outer] = [hole.inner_reach(), hole.outer_reach()];
        edges
            .extend((0..=BANDS).map(|i| inner + (outer - inner) * f64::from(i) / f64::from(BANDS)));
    }
    edges.retain(|edge| (bore..=root).contains(edge));
    edges.sort_by(f64::total_cmp);
    edges.dedup();
    let open = |radius: f64| -> f64 {
        let areas = blank
            .holes
            .iter()
            .map(|hole| hole.moments_within(radius).area);
        areas.sum()
    };
    let bands = edges.windows(2).map(|ends| {
        let [inner, outer] = [ends[0], ends[1]];
        let middle = f64::midpoint(inner, outer);
        let is_web = |web: &Web| (web.inner_radius..web.outer_radius).contains(&middle);
        let (thickness, offset) = match hub {
            Some(hub) if middle < hub.outer_radius => (hub.width, hub.offset),
            _ => {
                let offset = solid.map_or(0.0, SolidGear::web_offset);
                let is_web = blank.web.as_ref().is_some_and(is_web);
                let thickness = blank.thickness_at(middle, gear.face_width());
                (thickness, if is_web { offset } else { 0.0 })
            }
        };
        Band {
            radii: [inner, outer],
            thickness,
            offset,
            open: (open(outer) - open(inner)) / (PI * (outer * outer - inner * inner)),
        }
    });
    bands.collect()
}

/// Rings of a blank between bore and root circle, with the share of a ring that its holes leave, and the teeth on the last of them, of a gear with the polar
/// inertia `own`.
///
/// Where holes are, shear goes around them: the rings there are so much softer that the whole twists by `twist`.
fn rotor(case: &Case, member: Member, own: f64, twist: Option<Twist>) -> Rotor {
    let gear = case.pair.gear(member);
    let material = gear.material();
    let rings = bands(case, member).into_iter().map(|band| Ring {
        radii: band.radii,
        thickness: band.thickness * (1.0 - band.open),
        softer: 1.0,
    });
    let mut rings: Vec<Ring> = rings.collect();
    if let Some(Twist { radius, angle }) = twist {
        let blank = &gear.data().blank;
        soften(&mut rings, blank, angle * material.shear_modulus(), radius);
    }
    let rotor = Rotor {
        rings,
        shear_modulus: material.shear_modulus(),
        density: material.density,
        outer: 0.0,
    };
    let teeth = own - rotor.inertia_of_rings();
    Rotor {
        outer: teeth,
        ..rotor
    }
}

/// The support of a gear of `case` by a stiffness with these rows, in N/m, N and N m about the middle of its face.
pub fn support(case: &Case, member: Member, rows: &Rows) -> Support {
    Support {
        stiffness: matrix(rows),
        mass: rigid_mass(case, member),
        at_mesh: at_mesh(case, member),
    }
}

/// The part of the mesh force on a gear of `case` that a support with these `rows` leaves without a reaction.
pub fn unheld(case: &Case, member: Member, rows: &Rows) -> f64 {
    let radius = case.pair.gear(member).base_radius();
    mount::unheld(&matrix(rows), &at_mesh(case, member), radius)
}

fn matrix(rows: &Rows) -> Matrix6<f64> {
    Matrix6::from_fn(|i, j| rows[i][j])
}

/// Mass and inertia of a gear of `case` for motions along x, y and z and about x and y, about the middle of its face, in the mean over a turn.
fn rigid_mass(case: &Case, member: Member) -> SMatrix<f64, MOTIONS, MOTIONS> {
    let gear = case.pair.gear(member);
    let solid = case.faces().map(|of| of.pair.gear(member));
    let mass = solid.map_or_else(|| gear.mass(), SolidGear::mass);
    let face = gear.face_width();
    let density = gear.material().density;
    let mut bands = bands(case, member);
    if let Some(shaft) = solid.and_then(SolidGear::shaft) {
        let [low, high] = shaft.heights;
        bands.push(Band {
            radii: [shaft.inner_radius, shaft.outer_radius],
            thickness: high - low,
            offset: f64::midpoint(low, high),
            open: 0.0,
        });
    }
    // What no band has stands along the face.
    let (mut rest, mut first, mut second) = (mass, 0.0, 0.0);
    for band in bands {
        let [inner, outer] = band.radii;
        let area = PI * (outer * outer - inner * inner) * (1.0 - band.open);
        let own = density * area * band.thickness;
        rest -= own;
        first += own * band.offset;
        second += own * (band.thickness.powi(2) / 12.0 + band.offset.powi(2));
    }
    second += rest * face * face / 12.0;
    let tilt = own_inertia(case, member) / 2.0 + second;
    let mut matrix = SMatrix::from_diagonal(&[mass, mass, mass, tilt, tilt].into());
    (matrix[(0, 4)], matrix[(4, 0)]) = (first, first);
    (matrix[(1, 3)], matrix[(3, 1)]) = (-first, -first);
    matrix
}

/// By how much the teeth of a gear of `case` come nearer to its mate, along the transverse line of action, as it moves along x, y and z and turns about x
/// and y, about the middle of its face; x points towards the mate. The force is taken at the pitch point in the middle of the common face.
fn at_mesh(case: &Case, member: Member) -> [f64; MOTIONS] {
    let (sin, cos) = case.pair.working_pressure_angle().sin_cos();
    let radius = case.pair.gear(member).base_radius();
    let (helix, height) = case.faces().map_or((0.0, 0.0), |faces| {
        let twist = faces.pair.gear(member).twist();
        (twist * radius, faces.pair.own_height(member, 0.0))
    });
    // A right-handed driving gear is pressed along z, and comes nearer against it.
    let axial = -helix;
    [
        sin,
        cos,
        axial,
        -height * cos,
        height * sin - axial * radius / cos,
    ]
}

/// Softens the rings where `blank` has holes so that `rings` up to `radius` twist by `twist` times the shear modulus, in 1/m³. Rings are no stiffer than by the
/// share that holes leave of them.
fn soften(rings: &mut [Ring], blank: &BlankRegion, twist: f64, radius: f64) {
    let is_holed = |ring: &Ring| {
        let middle = f64::midpoint(ring.radii[0], ring.radii[1]);
        let mut holes = blank.holes.iter();
        holes.any(|hole| (hole.inner_reach()..hole.outer_reach()).contains(&middle))
    };
    let within = |ring: &Ring| ring.within(radius).map_or(0.0, |ring| ring.twist());
    let (holed, plain): (Vec<&Ring>, Vec<&Ring>) = rings.iter().partition(|ring| is_holed(ring));
    let [holed, plain] = [holed, plain].map(|rings| rings.into_iter().map(within).sum::<f64>());
    let softer = ((twist - plain) / holed).clamp(1.0, SOFTEST);
    for ring in rings.iter_mut().filter(|ring| is_holed(ring)) {
        ring.softer = softer;
    }
}
