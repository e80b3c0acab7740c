//! Measured deviations of the teeth of a gear.

use meshwright_engine::gear::{Eccentricity, ToothDeviations};

use super::GearDocument;
use super::traces::{LARGEST, LeadTracesDocument, ProfileTracesDocument, too_large};
use crate::declare::{List, Number, absent, document, list, nested, number};
use crate::problem::{Code, FieldError};
use crate::units::{from_um, plain, to_um};

/// How far the sum of all single pitch deviations may be from zero, in um.
const CLOSURE: f64 = 0.01;

document! {
    /// Deviations of the teeth of a gear from each other. Positive is towards the mate, so that contact is earlier. Teeth are counted as angles are: tooth 1
    /// stands next to tooth 0 on the side of its loaded flank. The teeth of a driven gear mesh in rising order, those of a driving gear in falling order, and
    /// both keep their numbers when the other gear drives.
    pub struct DeviationsDocument as "ToothDeviations", "Tooth deviations" {
        /// How far the loaded flank of each tooth, tooth 0 first, stands from its place towards its mate, as a transverse arc on the
        /// reference circle (ISO 1328-1). Along the base tangent it is times the cosine of the pressure angle. The tooth is displaced as a whole,
        /// unless `other_flank_pitch_cumulative_um` says otherwise. The same constant for all teeth is a turn of the gear.
        pitch_cumulative_um: Option<Vec<f64>> =
            absent(each_tooth("Cumulative pitch deviations"), "none")
                .not_beside(&["pitch_single_um"]),
        /// The deviation of each tooth, tooth 0 first, against the tooth before it, as a transverse arc on the reference circle (ISO
        /// 1328-1); that of tooth 0 is against the last tooth. Their sum has to be zero within 0.01 um. Summed up they are cumulative
        /// deviations from the last tooth.
        pitch_single_um: Option<Vec<f64>> = absent(each_tooth("Single pitch deviations"), "none"),
        /// Where the other flank of each tooth stands, tooth 0 first, positive in the same sense of rotation as the deviations of the loaded flanks; absent:
        /// as they do, each tooth being displaced as a whole. Its mean is shifted to that of the loaded flanks, because the thickness of
        /// the gear says how thick its teeth are in the mean.
        other_flank_pitch_cumulative_um: Option<Vec<f64>> = absent(
            each_tooth("Cumulative pitch deviations of the other flanks"),
            "as the loaded flanks",
        ),
        /// The slope deviation of the loaded flank of each tooth, tooth 0 first: nothing at the form circle, this much towards the mate at
        /// the tip circle, linear in the roll length.
        profile_slope_um: Option<Vec<f64>> = absent(each_tooth("Profile slope deviations"), "none"),
        /// Material removed from the loaded flank of each tooth at the +z end of the face, tooth 0 first, linear from zero at its -z end, as a slope of
        /// lead_modifications: positive is away from the mate. It needs three dimensions.
        pub(crate) lead_slope_um: Option<Vec<f64>> =
            absent(each_tooth("Lead slopes"), "none") => in_three_dimensions,
        /// A measured trace of the profile of each loaded flank, beside its slope.
        profiles: Option<ProfileTracesDocument> =
            absent(nested("ProfileTraces"), "none").left_out(),
        /// A measured trace of the lead of each loaded flank, beside its slope. It needs three dimensions.
        pub(crate) leads: Option<LeadTracesDocument> =
            absent(nested("LeadTraces"), "none").left_out() => in_three_dimensions,
        /// The gear's own axis beside the axis of rotation.
        eccentricity: Option<EccentricityDocument> = absent(nested("Eccentricity"), "none"),
    }
}

document! {
    /// The gear's own axis beside the axis of rotation.
    pub struct EccentricityDocument as "Eccentricity", "Eccentricity" {
        /// The distance of the gear's own axis from the axis of rotation.
        amount_um: f64 = number("Amount of the eccentricity", "um", 0.0, 1_000.0),
        /// The direction of the gear's own axis from the axis of rotation: an angle from the centerline of tooth 0, positive towards the
        /// loaded flank of that tooth.
        phase_deg: f64 = number("Phase of the eccentricity", "deg", -360.0, 360.0).or(0.0),
    }
}

/// A deviation for each tooth. How few are too few depends on the gear, which says so.
const fn each_tooth(title: &'static str) -> List<Number> {
    let most = GearDocument::tooth_count.spec.bounds.1 as usize;
    list(title, number("", "um", -1_000.0, 1_000.0), most)
}

impl DeviationsDocument {
    /// How a reader is told `deviations`: to a tenth of a nanometer, single pitches that close.
    pub fn of(deviations: &ToothDeviations) -> Self {
        let rounded = |value: f64| (to_um(value) * 1e4).round() / 1e4 + 0.0;
        let sums = deviations.cumulative_pitch.iter().copied().map(rounded);
        let single = sums.scan(0.0, |before, sum| {
            let step = ((sum - *before) * 1e4).round() / 1e4 + 0.0;
            *before = sum;
            Some(step)
        });
        Self {
            pitch_cumulative_um: None,
            pitch_single_um: Some(single.collect()),
            other_flank_pitch_cumulative_um: (!deviations.other_cumulative_pitch.is_empty()).then(
                || {
                    deviations
                        .other_cumulative_pitch
                        .iter()
                        .copied()
                        .map(rounded)
                        .collect()
                },
            ),
            profile_slope_um: Some(
                deviations
                    .profile_slope
                    .iter()
                    .copied()
                    .map(rounded)
                    .collect(),
            ),
            lead_slope_um: (!deviations.lead_slope.is_empty())
                .then(|| deviations.lead_slope.iter().copied().map(rounded).collect()),
            profiles: None,
            leads: None,
            eccentricity: deviations
                .eccentricity
                .map(|eccentricity| EccentricityDocument {
                    amount_um: rounded(eccentricity.amount),
                    phase_deg: (eccentricity.direction.to_degrees() * 1e4).round() / 1e4 + 0.0,
                }),
        }
    }

    /// Its lists, each with its field.
    fn lists(&self) -> impl Iterator<Item = (&'static str, &[f64])> {
        let lists = [
            (Self::pitch_cumulative_um.name, &self.pitch_cumulative_um),
            (Self::pitch_single_um.name, &self.pitch_single_um),
            (
                Self::other_flank_pitch_cumulative_um.name,
                &self.other_flank_pitch_cumulative_um,
            ),
            (Self::profile_slope_um.name, &self.profile_slope_um),
            (Self::lead_slope_um.name, &self.lead_slope_um),
        ];
        let given = lists.into_iter();
        given.filter_map(|(name, values)| Some((name, values.as_deref()?)))
    }

    /// Faults on a gear of `tooth_count` teeth and of `module` over the base circle, both in mm, whose deviations stand at `pointer`.
    pub(super) fn faults(
        &self,
        pointer: &str,
        (tooth_count, module): (u32, f64),
        base_radius: f64,
    ) -> Vec<FieldError> {
        let wrong_length = self
            .lists()
            .filter(|(_, values)| values.len() != tooth_count as usize)
            .map(|(name, values)| {
                let pointer = format!("{pointer}/{name}");
                let detail = format!(
                    "{pointer} has {} numbers; {tooth_count} are needed, one for each tooth.",
                    values.len()
                );
                FieldError::new(pointer, Code::WrongLength, detail).nearest(f64::from(tooth_count))
            });
        let faults: Vec<_> = wrong_length.collect();
        if !faults.is_empty() {
            return faults;
        }
        let large = self.too_large(pointer, module);
        large
            .into_iter()
            .chain(self.does_not_close(pointer))
            .chain(self.profiles.iter().flat_map(|traces| {
                let pointer = format!("{pointer}/{}", Self::profiles.name);
                traces.faults(&pointer, (tooth_count, module), base_radius)
            }))
            .chain(self.leads.iter().flat_map(|traces| {
                let pointer = format!("{pointer}/{}", Self::leads.name);
                traces.faults(&pointer, tooth_count, module)
            }))
            .collect()
    }

    /// Fault of a deviation above a quarter of a module, beyond which a search among neighboring flanks has no meaning.
    fn too_large(&self, pointer: &str, module: f64) -> Option<FieldError> {
        let most = 1e3 * LARGEST * module;
        let listed = self.lists().flat_map(|(name, values)| {
            let place = move |i| format!("{name}/{i}");
            let each = values.iter().enumerate();
            each.map(move |(i, value)| (place(i), *value))
        });
        let eccentricity = self.eccentricity.as_ref().map(|eccentricity| {
            let place = format!("eccentricity/{}", EccentricityDocument::amount_um.name);
            (place, eccentricity.amount_um)
        });
        let (place, value) = listed
            .chain(eccentricity)
            .find(|(_, value)| value.abs() > most)?;
        Some(too_large(format!("{pointer}/{place}"), value, most))
    }

    fn does_not_close(&self, pointer: &str) -> Option<FieldError> {
        let values = self.pitch_single_um.as_ref()?;
        let sum: f64 = values.iter().sum();
        // Rounding of a sum of hundreds of numbers is no gap.
        if sum.abs() <= CLOSURE * (1.0 + 1e-6) {
            return None;
        }
        let pointer = format!("{pointer}/{}", Self::pitch_single_um.name);
        let detail = format!(
            "{pointer} sums to {} um, and once around it has to be zero within {CLOSURE} um; {} um less in each of the {} closes it.",
            plain(sum),
            plain(sum / values.len() as f64),
            values.len()
        );
        Some(FieldError::new(pointer, Code::PitchDoesNotClose, detail))
    }

    /// The deviations of the engine.
    pub(super) fn data(&self) -> ToothDeviations {
        let meters = |values: &[f64]| values.iter().copied().map(from_um).collect();
        ToothDeviations {
            cumulative_pitch: match &self.pitch_single_um {
                None => meters(self.pitch_cumulative_um.as_deref().unwrap_or_default()),
                Some(values) => summed(values).into_iter().map(from_um).collect(),
            },
            other_cumulative_pitch: meters(
                self.other_flank_pitch_cumulative_um
                    .as_deref()
                    .unwrap_or_default(),
            ),
            profile_slope: meters(self.profile_slope_um.as_deref().unwrap_or_default()),
            lead_slope: meters(self.lead_slope_um.as_deref().unwrap_or_default()),
            profiles: self.profiles.as_ref().map(ProfileTracesDocument::data),
            leads: self.leads.as_ref().map(LeadTracesDocument::data),
            eccentricity: self.eccentricity.as_ref().map(|eccentricity| Eccentricity {
                amount: from_um(eccentricity.amount_um),
                direction: eccentricity.phase_deg.to_radians(),
            }),
        }
    }
}

/// The cumulative deviations of single ones, from the last tooth: that of tooth i is the sum of those up to it.
fn summed(single: &[f64]) -> Vec<f64> {
    let sums = single.iter().scan(0.0, |sum, deviation| {
        *sum += deviation;
        Some(*sum)
    });
    sums.collect()
}
