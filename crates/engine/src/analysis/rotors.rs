//! Gear bodies in torsion, from their drawings and their elements.

use std::f64::consts::PI;

use super::case::Model;
use super::{AnalysisError, Case};
use crate::assembly::interface::interface_radius;
use crate::assembly::{BlankSpec, PartError, Parts};
use crate::dynamics::Body;
use crate::dynamics::torsion::{Ring, Rotor};
use crate::fem::FemError;
use crate::fem::dense::Cholesky;
use crate::gear::{BlankRegion, Member};
use crate::ring::blank::BlankSubstructure;
use crate::ring::cyclic::Component;
use crate::run::Run;

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
/// `limits`. A body that is to have less inertia than the gear as drawn has none, and neither have bodies whose compliance comes from formulas.
pub(super) fn body(
    case: &Case,
    member: Member,
    inertia: Option<f64>,
    twist: Option<Twist>,
    (highest, most): (f64, usize),
) -> Body {
    let own = own_inertia(case, member);
    let inertia = inertia.unwrap_or(own);
    let base_radius = case.pair.gear(member).base_radius();
    let is_seen = inertia >= own && !matches!(case.model, Model::Formulas(_));
    let modes = if is_seen {
        rotor(case, member, own, twist).modes(base_radius, highest, most)
    } else {
        Vec::new()
    };
    Body {
        inertia,
        base_radius,
        modes,
    }
}

/// The polar inertia of a gear as drawn, in kg m².
pub(super) fn own_inertia(case: &Case, member: Member) -> f64 {
    match case.faces() {
        Some(faces) => faces.pair.gear(member).polar_inertia(),
        None => case.pair.gear(member).polar_inertia(),
    }
}

/// Rings of a blank between bore and root circle, with the share of a ring that its holes leave, and the teeth on the last of them, of a gear with the polar
/// inertia `own`.
///
/// Where holes are, shear goes around them: the rings there are so much softer that the whole twists by `twist`.
fn rotor(case: &Case, member: Member, own: f64, twist: Option<Twist>) -> Rotor {
    let gear = case.pair.gear(member);
    let material = gear.material();
    let blank = &gear.data().blank;
    let hub = case.faces().and_then(|of| of.pair.gear(member).hub());
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
    let rings = edges.windows(2).map(|ends| {
        let [inner, outer] = [ends[0], ends[1]];
        let middle = f64::midpoint(inner, outer);
        let thickness = match hub {
            Some(hub) if middle < hub.outer_radius => hub.width,
            _ => blank.thickness_at(middle, gear.face_width()),
        };
        let share = (open(outer) - open(inner)) / (PI * (outer * outer - inner * inner));
        Ring {
            radii: [inner, outer],
            thickness: thickness * (1.0 - share),
            softer: 1.0,
        }
    });
    let mut rings: Vec<Ring> = rings.collect();
    if let Some(Twist { radius, angle }) = twist {
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
