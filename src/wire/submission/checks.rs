//! Whether the fields of a submission go together: torques, interface, span and size.

use meshwright_engine::gear::{GearPair, SpurGear};

use super::Purpose;
use super::document::Document;
use crate::wire::declare::Errors;
use crate::wire::problem::{Code, FieldError};
use crate::wire::resolution::ResolutionDocument;
use crate::wire::units::{Side, plain, rounded_inward};

/// The most positions times torques of one submission.
pub(in crate::wire) const MOST_POSITIONS: u64 = 20_000;

impl Document {
    /// Refuses torques that would deflect the teeth by more than about a quarter of a module: small displacements and a
    /// search among neighboring flanks mean nothing there.
    pub(super) fn check_torques(&self, pair: &GearPair, errors: &Errors) {
        const LARGEST_DEFLECTION: f64 = 0.25;
        // The usual mesh stiffness of steel gears, 14 N/(mm um), in proportion to Young's modulus.
        const USUAL_STIFFNESS: f64 = 14e9 / 210e9;
        let modulus = |gear: &SpurGear| gear.material().youngs_modulus;
        let softer = modulus(pair.driving()).min(modulus(pair.driven()));
        let module = pair.driving().data().rack.module;
        let largest_load =
            LARGEST_DEFLECTION * module * USUAL_STIFFNESS * softer * pair.common_face_width();
        let largest = largest_load * pair.driven().base_radius();
        for (i, &torque) in self.output_torques_n_m.iter().enumerate() {
            if torque > largest {
                let nearest = rounded_inward(largest, Side::AtMost, 0);
                let pointer = format!("/{}/{i}", Self::output_torques_n_m.name);
                let detail = format!(
                    "{pointer} is {} N m, which would deflect these teeth by more than about a quarter of a module; at most {} N m.",
                    plain(torque),
                    plain(nearest)
                );
                errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest));
            }
        }
    }

    pub(super) fn check_interface(&self, pair: &GearPair, errors: &Errors) {
        let pointer = format!(
            "/resolution/{}",
            ResolutionDocument::interface_radius_mm.name
        );
        let faults = self.resolution.interface_radius_mm.faults(pair, &pointer);
        faults.into_iter().for_each(|fault| errors.push(fault));
    }

    pub(super) fn check_span(&self, pair: &GearPair, errors: &Errors) {
        let (Some(span), period) = (self.resolution.span_mesh_periods, pair.period()) else {
            return;
        };
        if span > period && span % period != 0 {
            let nearest =
                (f64::from(span) / f64::from(period)).round().max(1.0) * f64::from(period);
            let pointer = format!("/resolution/{}", ResolutionDocument::span_mesh_periods.name);
            let detail = format!(
                "{pointer} is {span}; the true period is {period} mesh periods, and a longer span has to be a whole multiple of it."
            );
            errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest));
        }
    }

    pub(super) fn check_size(&self, purpose: Purpose, errors: &Errors) {
        let (limit, said) = match purpose {
            Purpose::Job => (MOST_POSITIONS, format!("the limit is {MOST_POSITIONS}")),
            Purpose::Preview { most_positions } => (
                most_positions,
                format!(
                    "the limit of a preview is {most_positions}, that of POST /v1/jobs {MOST_POSITIONS}"
                ),
            ),
        };
        let resolution = &self.resolution;
        let span = u64::from(resolution.span_mesh_periods.unwrap_or(1));
        let (positions, torques) = (
            u64::from(resolution.positions_per_mesh_period),
            self.output_torques_n_m.len() as u64,
        );
        let total = span * positions * torques;
        if total <= limit {
            return;
        }
        let fitting_positions = limit / (span * torques);
        let fitting_torques = limit / (span * positions);
        let fitting_span = limit / (positions * torques);
        let mut ways = Vec::new();
        let least_positions = ResolutionDocument::positions_per_mesh_period.spec.bounds.0 as u64;
        if fitting_positions >= least_positions {
            ways.push(format!("{fitting_positions} positions in a mesh period"));
        }
        if fitting_torques >= 1 {
            ways.push(format!("{fitting_torques} torques"));
        }
        if fitting_span >= 1 {
            ways.push(format!("a span of {fitting_span} mesh periods"));
        }
        if ways.is_empty() {
            ways.push("less of more than one of them".to_owned());
        }
        let (name, nearest) = if fitting_positions >= least_positions {
            (
                ResolutionDocument::positions_per_mesh_period.name,
                Some(fitting_positions as f64),
            )
        } else {
            let nearest = (fitting_span >= 1).then_some(fitting_span as f64);
            (ResolutionDocument::span_mesh_periods.name, nearest)
        };
        let detail = format!(
            "{span} mesh periods of {positions} positions at {torques} torques are {total} positions; {said}. What would fit: {}.",
            ways.join(", or ")
        );
        let pointer = format!("/resolution/{name}");
        errors.push(FieldError::new(pointer, Code::TooLarge, detail).nearest(nearest));
    }
}
