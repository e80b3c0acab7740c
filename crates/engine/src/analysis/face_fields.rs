//! Displacements and stresses all through both gears of a pair that is seen along its faces, at one mesh position.

use std::sync::Arc;

use super::case::Faces;
use super::fields::{Fields, GearField, free_edges};
use super::three_dimensional::{running_model, yields};
use super::{AnalysisError, Case};
use crate::assembly::face_inside::MovedParts;
use crate::assembly::{FaceCompliance, FaceComplianceSpec, FaceInside, Parts};
use crate::contact::face::FaceContact;
use crate::fem::volume::{Frame, Volume, von_mises};
use crate::gear::{Member, Vector};
use crate::run::Run;
use crate::touch::placement::{Pose, Section};

/// Both gears of `case` under `output_torque`, positive, at the mesh position `eta`, by the method that sees the whole gears; `None` for a plane
/// case.
///
/// The driving axis is that of z, the driven one crosses the x axis, and z counts from the middle of the common face. Parts have nodes of their own
/// where they meet, and a narrower part meets a wider one within its width.
///
/// # Errors
///
/// As [`super::analyze`].
pub fn volumes(
    case: &Case,
    output_torque: f64,
    eta: f64,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Option<Fields<Volume>>, AnalysisError> {
    let field_of = |moved: &[MovedParts], _: &Faces, _: Member, place: Frame| {
        let mut volume = Volume::default();
        moved.iter().for_each(|of| of.add_to(&mut volume, place));
        volume
    };
    of_gears(case, (output_torque, eta), parts, run, field_of)
}

/// The same in the section through the middle of the common face; of parts that end before it, where they end. Stresses are those in the plane, von
/// Mises stresses those of all components.
///
/// # Errors
///
/// As [`super::analyze`].
pub fn section(
    case: &Case,
    output_torque: f64,
    eta: f64,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Option<Fields>, AnalysisError> {
    let field_of = |moved: &[MovedParts], faces: &Faces, member: Member, place: Frame| {
        let mut field = GearField::default();
        let z = faces.pair.own_height(member, 0.0);
        moved.iter().for_each(|of| field.cut(of, z, place));
        field
    };
    of_gears(case, (output_torque, eta), parts, run, field_of)
}

/// Result of `field_of` for both gears.
fn of_gears<T: Send>(
    case: &Case,
    (output_torque, eta): (f64, f64),
    parts: &dyn Parts,
    run: &Run,
    field_of: impl Fn(&[MovedParts], &Faces, Member, Frame) -> T + Sync,
) -> Result<Option<Fields<T>>, AnalysisError> {
    faer::set_global_parallelism(faer::Par::Seq);
    let Some(faces) = &case.faces().map(|faces| faces.at(case.resolution.grid)) else {
        return Ok(None);
    };
    let yields = yields(faces, parts, run)?;
    let model = running_model((case, faces), &yields, parts, run)?;
    let contacts = model.contacts(case.pair.load(output_torque), &[eta], run)?;
    let Some(contact) = contacts.first() else {
        return Ok(None);
    };
    let deviations = case.pair.deviations();
    let pose = Pose::real(
        (&case.pair, &deviations),
        Section::straight(eta, 0),
        0.0,
        (Member::Driving, eta),
    );
    let of = |member: Member| {
        let (axis, angle) = pose.frame(member);
        // The gear's own middle stands beside that of the common face.
        let own = faces.pair.own_height(member, 0.0);
        let place = Frame {
            axis,
            angle: angle - faces.pair.gear(member).twist() * own,
            height: -own,
        };
        let moved = moved((faces, &yields), member, contact, parts, run)?;
        run.check()?;
        Ok::<_, AnalysisError>(field_of(&moved, faces, member, place))
    };
    let (driving, driven) = rayon::join(|| of(Member::Driving), || of(Member::Driven));
    Ok(Some(Fields {
        transmission_error: contact.mesh.transmission_error,
        gears: [driving?, driven?],
    }))
}

fn moved(
    (faces, yields): (&Faces, &[Arc<FaceCompliance>; 2]),
    member: Member,
    contact: &FaceContact,
    parts: &dyn Parts,
    run: &Run,
) -> Result<Vec<MovedParts>, AnalysisError> {
    let spec = FaceComplianceSpec::new(faces.pair.gear(member), faces.resolution);
    let yields = yields[member.index()].clone();
    let inside = FaceInside::new(spec, yields, parts, run).map_err(|error| error.of(member))?;
    let loads: Vec<_> = contact
        .pressing(&faces.pair, member)
        .map(|(tooth, pressing)| inside.forces(tooth, pressing))
        .collect();
    let moved = inside.under(&loads, run);
    moved.map_err(|error| error.of(member).into())
}

impl GearField {
    /// Adds the sections of `parts` at the height `z`, of a gear that stands at `place`.
    fn cut(&mut self, parts: &MovedParts, z: f64, place: Frame) {
        let edges = free_edges(parts.grid(), parts.joints());
        for section in parts.sections(z, place) {
            let first = self.nodes.len() as u32;
            let flat = |v: &nalgebra::Vector3<f64>| Vector::new(v.x, v.y);
            self.nodes.extend(section.nodes.iter().map(flat));
            self.displacements
                .extend(section.displacements.iter().map(flat));
            let stresses = section.stresses.iter();
            self.stresses
                .extend(stresses.map(|of| [of.m11, of.m22, of.m12]));
            self.von_mises
                .extend(section.stresses.iter().map(von_mises));
            let elements = parts.grid().elements.iter();
            self.elements
                .extend(elements.map(|of| of.renumbered(|node| first + node)));
            self.edges
                .extend(edges.iter().map(|edge| edge.map(|node| first + node)));
        }
    }
}
