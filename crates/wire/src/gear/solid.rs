//! The gear along its axis: its helix, where its web stands, and its hub.

use meshwright_engine::gear::{
    BlankRegion, FaceEnds, GearData, GearError, Helix, LeadModification, SolidGear, SolidGearError,
    SpurGear,
};

use super::GearDocument;
use super::blank::{BlankDocument, HubDocument, WebDocument};
use super::lead::LeadModificationDocument;
use crate::problem::{Code, FieldError};
use crate::units::{plain, to_mm};

impl GearDocument {
    /// The transverse section of the gear that winds by `helix`.
    pub(super) fn section(&self, helix: Helix) -> Result<SpurGear, GearError> {
        let data = self.data(helix);
        if helix.angle == 0.0 {
            return SpurGear::new(data);
        }
        let on_solid = GearData {
            blank: BlankRegion::solid(data.blank.bore_radius),
            ..data.clone()
        };
        match SolidGear::new(data, helix, 0.0, None) {
            Ok(gear) => Ok(gear.section().clone()),
            Err(SolidGearError::Section(error)) => Err(error),
            // Faults of its blank along the axis are reported elsewhere.
            Err(_) => match SolidGear::new(on_solid, helix, 0.0, None) {
                Err(SolidGearError::Section(error)) => Err(error),
                Ok(gear) => Ok(gear.section().clone()),
                Err(_) => SpurGear::new(self.data(helix)),
            },
        }
    }

    /// The gear along its axis, if it can be made.
    ///
    /// # Errors
    ///
    /// Every field that has to change.
    pub(crate) fn to_solid(
        &self,
        pointer: &str,
        helix: Helix,
    ) -> Result<SolidGear, Vec<FieldError>> {
        self.to_gear(pointer, helix)?;
        let made = SolidGear::new(
            self.data(helix),
            helix,
            self.blank.web_offset(),
            self.blank.hub_data(),
        );
        made.map_err(|error| self.solid_faults(pointer, &error))
    }

    /// Its lead modifications for the engine.
    pub(crate) fn leads(&self) -> Vec<LeadModification> {
        let leads = self.lead_modifications.iter();
        leads.map(LeadModificationDocument::data).collect()
    }

    /// Fields at `pointer` that the plane does not support, each with the value that the plane takes in its place.
    pub(crate) fn beyond_the_plane(&self, pointer: &str) -> Vec<(String, Option<f64>)> {
        let web = self.blank.web.as_ref().filter(|web| web.offset_mm != 0.0);
        let slopes = self.tooth_deviations.as_ref();
        let slopes = slopes.and_then(|deviations| deviations.lead_slope_um.as_ref());
        let slopes = slopes.filter(|slopes| slopes.iter().any(|slope| *slope != 0.0));
        let found = [
            (!self.lead_modifications.is_empty())
                .then(|| (Self::lead_modifications.name.to_owned(), None)),
            slopes.map(|_| ("tooth_deviations/lead_slope_um".to_owned(), None)),
            web.map(|_| {
                let place = format!("blank/web/{}", WebDocument::offset_mm.name);
                (place, Some(0.0))
            }),
            self.blank
                .hub
                .as_ref()
                .map(|_| (format!("blank/{}", BlankDocument::hub.name), None)),
            self.blank
                .shaft
                .as_ref()
                .filter(|shaft| shaft.torque_at != FaceEnds::Both)
                .map(|_| ("blank/shaft/torque_at".to_owned(), None)),
        ];
        let found = found.into_iter().flatten();
        found
            .map(|(place, nearest)| (format!("{pointer}/{place}"), nearest))
            .collect()
    }

    /// Faults of a gear along its axis.
    fn solid_faults(&self, pointer: &str, error: &SolidGearError) -> Vec<FieldError> {
        let mm = |value: f64| plain(to_mm(value));
        let hub = |field: &str| format!("{pointer}/blank/hub/{field}");
        let fault = match *error {
            // These were looked for before, with everything that would help.
            SolidGearError::Section(ref error) => {
                FieldError::new(pointer, Code::OutOfRange, error.to_string())
            }
            SolidGearError::HelixAngle { largest, .. } => {
                let detail = format!(
                    "Teeth that wind by more than {} deg are not computed.",
                    plain(largest.to_degrees())
                );
                FieldError::new("/pair/helix_angle_deg", Code::OutOfRange, detail)
                    .nearest(largest.to_degrees())
            }
            SolidGearError::WebBeyondFace { beyond, nearest } => {
                let detail = format!("The web stands {} mm out of the face.", mm(beyond));
                let pointer = format!("{pointer}/blank/web/{}", WebDocument::offset_mm.name);
                FieldError::new(pointer, Code::WebBeyondFace, detail).nearest(to_mm(nearest))
            }
            SolidGearError::WebThickerThanFace {
                thickness,
                face_width,
            } => {
                let detail = format!(
                    "The web is {} mm thick, the face {} mm wide; along the face no web stands out of it.",
                    mm(thickness),
                    mm(face_width)
                );
                let pointer = format!("{pointer}/blank/web/{}", WebDocument::thickness_mm.name);
                FieldError::new(pointer, Code::WebBeyondFace, detail).nearest(to_mm(face_width))
            }
            SolidGearError::HubNarrowerThanWeb { width, nearest } => {
                let detail = format!(
                    "The hub is {} mm wide, narrower than the web on it; at least {} mm hold the web.",
                    mm(width),
                    mm(nearest)
                );
                FieldError::new(hub(HubDocument::width_mm.name), Code::HubDoesNotFit, detail)
                    .nearest(to_mm(nearest))
            }
            SolidGearError::HubOutside {
                outer_radius,
                least,
                largest,
            } => {
                let nearest = if outer_radius >= largest {
                    least + 0.99 * (largest - least)
                } else {
                    least + 0.01 * (largest - least)
                };
                let detail = format!(
                    "The hub ends at {} mm; it has to end between the bore, or the shaft, at {} mm and {} mm.",
                    mm(outer_radius),
                    mm(least),
                    mm(largest)
                );
                let pointer = hub(HubDocument::outer_radius_mm.name);
                FieldError::new(pointer, Code::HubDoesNotFit, detail).nearest(to_mm(nearest))
            }
            SolidGearError::HubBesideFace { offset, nearest } => {
                let detail = format!(
                    "At the offset {} mm the hub and the face reach past each other; {} mm would do.",
                    mm(offset),
                    mm(nearest)
                );
                FieldError::new(
                    hub(HubDocument::offset_mm.name),
                    Code::HubDoesNotFit,
                    detail,
                )
                .nearest(to_mm(nearest))
            }
            SolidGearError::HoleAcrossEdge {
                hole,
                from,
                to,
                inner_radius,
                outer_radius,
            } => {
                let fault = self.edge_fault(hole, [from, to], [inner_radius, outer_radius]);
                return Self::field_errors(pointer, vec![Self::cured(fault)]);
            }
        };
        vec![fault]
    }
}
