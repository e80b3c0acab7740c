//! The results document: curves over mesh position, their statistics and spectra, and the evidence for them.

use meshwright_engine::analysis::curve::{BlankFit, DecompositionParts, ErrorEstimate};
use meshwright_engine::analysis::spectrum::Spectrum;
use meshwright_engine::analysis::{
    Analysis, BodyFormula, Case, Curve, Formulas, Method, Statistics, ToothFormula,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

use super::geometry::{Frequencies, PairGeometry};
use super::problem::{Code, Problem};
use super::submission::{SOLVER_VERSION, Submission};
use super::units::{or_null, rounded_json, to_mm, to_mpa, to_um};
use super::warning::{GearName, WarningDocument};

/// What a submission comes to. It is bit-identical for the same input and version.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(title = "Results")]
pub struct Results {
    /// How the curves were computed.
    pub method: &'static str,
    /// The derived geometry.
    pub pair: PairGeometry,
    /// The frequencies at the speed given; absent without a speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequencies: Option<Frequencies>,
    /// What to know beside the numbers.
    pub warnings: Vec<WarningDocument>,
    /// One curve for each output torque, in the order of the submission.
    pub curves: Vec<CurveDocument>,
    /// How good the numbers are, and what they mean.
    pub evidence: EvidenceDocument,
}

/// The curves at one output torque. All lists, those of the spectrum aside, run over the same positions.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Curve, title = "Curve")]
pub struct CurveDocument {
    /// The output torque on the driven gear, in N m.
    pub output_torque_n_m: f64,
    /// The transmitted load on the line of action, in N: the torque over the driven base radius.
    pub load_n: f64,
    /// The mesh position, in mesh periods, end excluded; at 0 the reference pair touches at the pitch point.
    pub mesh_position: Vec<f64>,
    /// The rigid rotation of the driving gear, in degrees.
    pub driving_angle_deg: Vec<f64>,
    /// The rigid rotation of the driven gear, in degrees.
    pub driven_angle_deg: Vec<f64>,
    /// The static transmission error, in um, positive when load makes the driven gear lag.
    pub transmission_error_um: Vec<f64>,
    /// The tangent stiffness dF/d delta, in N/m.
    pub mesh_stiffness_tangent_n_per_m: Vec<f64>,
    /// The secant stiffness F/delta, in N/m.
    pub mesh_stiffness_secant_n_per_m: Vec<f64>,
    /// The number of tooth pairs that carry load.
    pub pairs_in_contact: Vec<u32>,
    /// The largest contact pressure, in MPa; null where a sharp tip corner carries, at which it has no limit.
    #[serde(serialize_with = "or_null")]
    pub peak_contact_pressure_mpa: Vec<Option<f64>>,
    /// The share of the load on each pair that ever carries any, by rising offset.
    pub load_shares: Vec<LoadShareDocument>,
    /// Statistics over the span.
    pub statistics: StatisticsDocument,
    /// The order spectrum; absent for a partial span.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<SpectrumDocument>,
    /// What the decomposition adds up; absent for other methods.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decomposition: Option<DecompositionDocument>,
}

/// The share of the load that the pairs at one offset carry.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = LoadShare, title = "Load share")]
pub struct LoadShareDocument {
    /// 0 for the pair that passed the pitch point last, 1 for the next, -1 for the one before.
    pub pair_offset: i32,
    /// Its share of the load, from 0 to 1.
    pub share: Vec<f64>,
}

/// Statistics over the span.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Statistics, title = "Statistics")]
pub struct StatisticsDocument {
    /// Whether the span is less than whole true periods.
    pub partial: bool,
    /// Of the transmission error, in um.
    pub transmission_error_um: StatisticsValues,
    /// Of the tangent stiffness, in N/m.
    pub mesh_stiffness_tangent_n_per_m: StatisticsValues,
}

/// Mean, fluctuation and range of a curve, in its unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Statistics of a curve")]
pub struct StatisticsValues {
    /// The mean.
    pub mean: f64,
    /// The root mean square of the fluctuation, the mean removed.
    pub rms: f64,
    /// The largest less the smallest value.
    pub peak_to_peak: f64,
}

/// Single-sided amplitudes and phases: y = sum of A cos(2 pi k j/n + phase), no window; the mean is left out.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Spectrum, title = "Spectrum")]
pub struct SpectrumDocument {
    /// Orders per revolution of the driven gear.
    pub order: Vec<f64>,
    /// The frequency of each order, in Hz; absent without a speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<Vec<f64>>,
    /// Amplitudes of the transmission error, in um.
    pub transmission_error_um: Vec<f64>,
    /// Phases of the transmission error, in degrees.
    pub transmission_error_phase_deg: Vec<f64>,
    /// Amplitudes of the tangent stiffness, in N/m.
    pub mesh_stiffness_tangent_n_per_m: Vec<f64>,
    /// Phases of the tangent stiffness, in degrees.
    pub mesh_stiffness_tangent_phase_deg: Vec<f64>,
    /// The lines that have names, by rising order.
    pub named: Vec<NamedOrderDocument>,
}

/// A line of the spectrum that has a name.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = NamedOrder, title = "Named order")]
pub struct NamedOrderDocument {
    /// The order per revolution of the driven gear.
    pub order: f64,
    /// Its name: H_Z2 and multiples for the mesh, H_N for the holes (H_N1 and H_N2 where both gears have different
    /// ones), H_Z2+N and so on for the sidebands.
    #[schema(example = "H_N")]
    pub label: String,
    /// Its frequency, in Hz; absent without a speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<f64>,
    /// The amplitude of the transmission error, in um.
    pub transmission_error_um: f64,
    /// The amplitude of the tangent stiffness, in N/m.
    pub mesh_stiffness_tangent_n_per_m: f64,
}

/// What the decomposition adds up, eq. 15.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Decomposition, title = "Decomposition")]
pub struct DecompositionDocument {
    /// The transmission error with rigid blanks, in um, at each position of the curve.
    pub rigid_blank_transmission_error_um: Vec<f64>,
    /// One entry for each holed gear.
    pub blanks: Vec<BlankFitDocument>,
}

/// What the decomposition found for one holed blank: mean + amplitude cos(N theta + phase), eq. 13.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = BlankFit, title = "Blank fit")]
pub struct BlankFitDocument {
    /// The gear.
    pub gear: GearName,
    /// The interface radius, in mm.
    pub interface_radius_mm: f64,
    /// The mean A, in um along the line of action.
    pub mean_um: f64,
    /// The amplitude B, in um along the line of action, not negative.
    pub amplitude_um: f64,
    /// The phase, in degrees.
    pub phase_deg: f64,
    /// The samples that were fitted.
    pub samples: Vec<BlankSampleDocument>,
}

/// One sample of a holed blank.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = BlankSample, title = "Blank sample")]
pub struct BlankSampleDocument {
    /// The mesh position, in mesh periods.
    pub mesh_position: f64,
    /// The rotation of the hub times the base radius, in um.
    pub rotation_um: f64,
}

/// How well the equations are satisfied, what they are, and what they leave out.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Evidence, title = "Evidence")]
pub struct EvidenceDocument {
    /// The version of the solver.
    pub solver_version: &'static str,
    /// SHA-256 of what decides the result: the filled-in submission without its tags, and the solver's version.
    pub input_hash: String,
    /// Unknowns of both gears before condensation; zero for formulas.
    pub degrees_of_freedom: u64,
    /// The largest difference between the output torque by cross products and the one asked for, over the latter.
    pub equilibrium_residual: f64,
    /// The largest product of contact force and gap, over load times largest transmission error.
    pub complementarity_residual: f64,
    /// The largest penetration left, in um.
    pub largest_penetration_um: f64,
    /// Iterations of the contact solver over all positions and torques.
    pub contact_iterations: u64,
    /// How the tangent stiffness was obtained.
    pub stiffness_rule: String,
    /// How it was computed, with every default filled in.
    #[schema(value_type = super::resolution::ResolutionDocument)]
    pub resolution: Map<String, Value>,
    /// What the numbers mean.
    pub definitions: Vec<Definition>,
    /// What the method leaves out.
    pub does_not_see: Vec<&'static str>,
    /// What a second grid level changes, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_estimate: Option<ErrorEstimateDocument>,
}

/// A term and what it means here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[schema(title = "Definition")]
pub struct Definition {
    /// The term.
    pub term: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

/// What a second grid level changes, the largest over the torques.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = ErrorEstimate, title = "Error estimate")]
pub struct ErrorEstimateDocument {
    /// In the mean transmission error, in um.
    pub transmission_error_mean_um: f64,
    /// In the peak-to-peak transmission error, in um.
    pub transmission_error_peak_to_peak_um: f64,
    /// In the mean tangent stiffness, in N/m.
    pub mesh_stiffness_tangent_mean_n_per_m: f64,
}

const DEFINITIONS: &[Definition] = &[
    Definition {
        term: "transmission_error",
        meaning: "The driven base radius times the rotation of the driven hub away from its conjugate position, the driving hub held; positive when load makes the driven gear lag, zero for unmodified rigid involutes in contact.",
    },
    Definition {
        term: "mesh_stiffness_tangent",
        meaning: "dF/d delta at the load, eq. 3 of the paper; stiffness_rule says how it was obtained.",
    },
    Definition {
        term: "mesh_stiffness_secant",
        meaning: "F/delta.",
    },
    Definition {
        term: "mesh_position",
        meaning: "Counts mesh periods; at 0 the reference pair, tooth 0 of both gears, touches at the pitch point. Both gears have then turned by mesh_position times 2 pi/Z, rigidly.",
    },
    Definition {
        term: "statistics",
        meaning: "Over the span: mean, root mean square after the mean is removed, largest less smallest.",
    },
    Definition {
        term: "order",
        meaning: "Per revolution of the driven gear. Amplitudes are single-sided, y = sum of A cos(2 pi k j/n + phase), without window.",
    },
    Definition {
        term: "pair_offset",
        meaning: "n - floor(mesh_position) for the pair that passes the pitch point at mesh position n: 0 for the pair that passed it last, 1 for the next.",
    },
];

impl Results {
    /// The results of `submission`.
    pub fn new(submission: &Submission, analysis: &Analysis) -> Self {
        let case = submission.case();
        Self {
            method: submission.method(),
            pair: PairGeometry::of(&case.pair),
            frequencies: Frequencies::of(case),
            warnings: analysis.warnings.iter().map(WarningDocument::of).collect(),
            curves: analysis
                .curves
                .iter()
                .map(|curve| CurveDocument::of(case, curve))
                .collect(),
            evidence: EvidenceDocument::of(submission, analysis),
        }
    }

    /// The document as JSON, its numbers rounded to ten significant digits.
    ///
    /// # Errors
    ///
    /// `internal_error` if a number is not finite, which no valid case may come to.
    pub fn to_json(&self) -> Result<String, Problem> {
        rounded_json(self).map_err(|error| Problem::new(Code::InternalError, error.to_string()))
    }
}

fn each(values: &[f64], convert: impl Fn(f64) -> f64) -> Vec<f64> {
    values.iter().copied().map(convert).collect()
}

impl CurveDocument {
    fn of(case: &Case, curve: &Curve) -> Self {
        let turned = |tooth_count: u32| {
            each(&curve.mesh_position, |eta| {
                eta * 360.0 / f64::from(tooth_count)
            })
        };
        Self {
            output_torque_n_m: curve.output_torque,
            load_n: curve.load,
            mesh_position: curve.mesh_position.clone(),
            driving_angle_deg: turned(case.pair.driving().tooth_count()),
            driven_angle_deg: turned(case.pair.driven().tooth_count()),
            transmission_error_um: each(&curve.transmission_error, to_um),
            mesh_stiffness_tangent_n_per_m: curve.mesh_stiffness_tangent.clone(),
            mesh_stiffness_secant_n_per_m: curve.mesh_stiffness_secant.clone(),
            pairs_in_contact: curve.pairs_in_contact.clone(),
            peak_contact_pressure_mpa: curve
                .peak_contact_pressure
                .iter()
                .map(|pressure| pressure.map(to_mpa))
                .collect(),
            load_shares: curve
                .load_shares
                .iter()
                .map(|share| LoadShareDocument {
                    pair_offset: share.pair_offset,
                    share: share.share.clone(),
                })
                .collect(),
            statistics: StatisticsDocument {
                partial: !case.covers_whole_periods(),
                transmission_error_um: StatisticsValues::of(
                    &curve.transmission_error_statistics,
                    to_um,
                ),
                mesh_stiffness_tangent_n_per_m: StatisticsValues::of(
                    &curve.mesh_stiffness_tangent_statistics,
                    |value| value,
                ),
            },
            spectrum: curve
                .spectrum
                .as_ref()
                .map(|spectrum| SpectrumDocument::of(case, spectrum)),
            decomposition: curve.decomposition.as_ref().map(DecompositionDocument::of),
        }
    }
}

impl StatisticsValues {
    fn of(statistics: &Statistics, convert: impl Fn(f64) -> f64) -> Self {
        Self {
            mean: convert(statistics.mean),
            rms: convert(statistics.rms),
            peak_to_peak: convert(statistics.peak_to_peak),
        }
    }
}

impl SpectrumDocument {
    fn of(case: &Case, spectrum: &Spectrum) -> Self {
        // An order counts per revolution of the driven gear, so that gear's speed turns it into a frequency.
        let driven_hz = Frequencies::of(case).map(|frequencies| frequencies.driven_hz);
        Self {
            order: spectrum.order.clone(),
            frequency_hz: driven_hz.map(|hz| each(&spectrum.order, |order| order * hz)),
            transmission_error_um: each(&spectrum.transmission_error, to_um),
            transmission_error_phase_deg: each(&spectrum.transmission_error_phase, f64::to_degrees),
            mesh_stiffness_tangent_n_per_m: spectrum.mesh_stiffness_tangent.clone(),
            mesh_stiffness_tangent_phase_deg: each(
                &spectrum.mesh_stiffness_tangent_phase,
                f64::to_degrees,
            ),
            named: spectrum
                .named
                .iter()
                .map(|line| NamedOrderDocument {
                    order: line.order,
                    label: line.label.clone(),
                    frequency_hz: driven_hz.map(|hz| line.order * hz),
                    transmission_error_um: to_um(line.transmission_error),
                    mesh_stiffness_tangent_n_per_m: line.mesh_stiffness_tangent,
                })
                .collect(),
        }
    }
}

impl DecompositionDocument {
    fn of(parts: &DecompositionParts) -> Self {
        Self {
            rigid_blank_transmission_error_um: each(&parts.rigid_blank_transmission_error, to_um),
            blanks: parts.blanks.iter().map(BlankFitDocument::of).collect(),
        }
    }
}

impl BlankFitDocument {
    fn of(fit: &BlankFit) -> Self {
        Self {
            gear: fit.member.into(),
            interface_radius_mm: to_mm(fit.interface_radius),
            mean_um: to_um(fit.mean),
            amplitude_um: to_um(fit.amplitude),
            phase_deg: fit.phase.to_degrees(),
            samples: fit
                .samples
                .iter()
                .map(|sample| BlankSampleDocument {
                    mesh_position: sample.mesh_position,
                    rotation_um: to_um(sample.rotation),
                })
                .collect(),
        }
    }
}

impl EvidenceDocument {
    fn of(submission: &Submission, analysis: &Analysis) -> Self {
        let evidence = &analysis.evidence;
        Self {
            solver_version: SOLVER_VERSION,
            input_hash: submission.input_hash(),
            degrees_of_freedom: evidence.degrees_of_freedom,
            equilibrium_residual: evidence.equilibrium_residual,
            complementarity_residual: evidence.complementarity_residual,
            largest_penetration_um: to_um(evidence.largest_penetration),
            contact_iterations: evidence.contact_iterations,
            stiffness_rule: submission.resolution().stiffness_in_words(),
            resolution: without_nulls(submission),
            definitions: DEFINITIONS.to_vec(),
            does_not_see: does_not_see(submission.case()),
            error_estimate: evidence
                .error_estimate
                .as_ref()
                .map(ErrorEstimateDocument::of),
        }
    }
}

/// The resolution as the submission echoes it; what is left to each gear's own default is left out.
fn without_nulls(submission: &Submission) -> Map<String, Value> {
    match serde_json::to_value(submission.resolution()) {
        Ok(Value::Object(fields)) => fields
            .into_iter()
            .filter(|(_, value)| !value.is_null())
            .collect(),
        _ => Map::new(),
    }
}

impl ErrorEstimateDocument {
    fn of(estimate: &ErrorEstimate) -> Self {
        Self {
            transmission_error_mean_um: to_um(estimate.mean),
            transmission_error_peak_to_peak_um: to_um(estimate.peak_to_peak),
            mesh_stiffness_tangent_mean_n_per_m: estimate.mean_stiffness,
        }
    }
}

/// What the method of `case` leaves out.
fn does_not_see(case: &Case) -> Vec<&'static str> {
    const ALWAYS: [&str; 4] = [
        "inertia and damping: the analysis is quasi-static",
        "friction between the flanks",
        "anything that varies across the face width: misalignment, crowning, helix; the model is plane",
        "shafts, bearings and housing: both hubs are rigid and their axes fixed",
    ];
    let own: Vec<&str> = match case.method {
        Method::Flexible => vec![],
        Method::Decomposition => vec![
            "sidebands of the holes about the mesh orders in the transmission error: each blank's rotation is fitted by its mean and one harmonic",
            "what the holes change in the load sharing between pairs",
        ],
        Method::ProjectedDecomposition => vec![
            "what the fluctuation of the holed blanks changes in the load sharing between pairs, beyond first order",
        ],
        Method::LoadDistribution => formulas_do_not_see(case.resolution.formulas),
    };
    ALWAYS.into_iter().chain(own).collect()
}

/// What the load distribution by `formulas` leaves out.
fn formulas_do_not_see(formulas: Formulas) -> Vec<&'static str> {
    const ALWAYS: [&str; 4] = [
        "holes: the bodies are solid",
        "contact off the theoretical line of action, at tip corners, and on it the way of the contact along the flank under load or relief",
        "the body that neighboring pairs share: each pair carries a body compliance of its own",
        "its own error: formulas have no grid, so that an error_estimate has nothing to refine",
    ];
    const OF_PARTS: &str = "that a wider gear is loaded on a part of its width: its teeth and body yield as if loaded on all of it; the flanks touch on the common width";
    let own: &[&str] = match (formulas.tooth, formulas.body) {
        (ToothFormula::WeberBanaschek, BodyFormula::Sainsot) => &[
            OF_PARTS,
            "Poisson's ratio and the plane state in the bodies: the fit of Sainsot, Velex and Duverger has neither",
        ],
        (ToothFormula::WeberBanaschek, BodyFormula::HalfPlane) => {
            &[OF_PARTS, "bores: a body is a half plane without end"]
        }
        (ToothFormula::WeberBanaschek, BodyFormula::Rigid) => &[
            OF_PARTS,
            "the deformation of the bodies: they are rigid, as asked for",
        ],
        (ToothFormula::Iso6336, _) => &[
            "width beyond the common face width",
            "bores, fillets, and where on the flank a pair touches: one stiffness, that of the stiffest position, stands for all",
            "how a contact stiffens with its load: the stiffness is constant",
            "what measured stiffnesses fall short of the theory: C_M = 0.8 of ISO 6336-1 and its fall below 100 N/mm are left out",
        ],
    };
    ALWAYS.iter().chain(own).copied().collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use meshwright_engine::analysis::curve::{BlankSample, LoadShare};
    use meshwright_engine::analysis::{Evidence, Warning};
    use meshwright_engine::gear::Member;
    use serde_json::json;

    use super::*;
    use crate::wire::examples;

    fn submission(name: &str, speed: Option<f64>) -> Submission {
        let example = examples()
            .iter()
            .find(|example| example.name == name)
            .expect("ships");
        let mut document: Value = serde_json::from_str(example.json).expect("JSON");
        document["driving_speed_rpm"] = json!(speed);
        Submission::parse(document.to_string().as_bytes()).expect("valid")
    }

    /// An analysis whose curves are a mean and two cosines, with digits down to the last bit as a real one has.
    fn analysis(case: &Case) -> Analysis {
        let positions = case.positions();
        let eta: Vec<f64> = (0..positions)
            .map(|i| i as f64 / f64::from(case.resolution.positions_per_mesh_period))
            .collect();
        let wave = |mean: f64, swing: f64| -> Vec<f64> {
            let swung =
                |&eta: &f64| mean + swing * ((TAU * eta).cos() + (TAU * eta / 7.0).sin() / 3.0);
            eta.iter().map(swung).collect()
        };
        let curve = |&torque: &f64| {
            let (delta, k) = (wave(14.118e-6, 0.4e-6), wave(2.19e8, 2.4e7));
            let load = case.pair.load(torque);
            Curve {
                output_torque: torque,
                load,
                mesh_stiffness_secant: delta.iter().map(|delta| load / delta).collect(),
                pairs_in_contact: vec![2; positions],
                peak_contact_pressure: wave(600e6, 50e6).into_iter().map(Some).collect(),
                load_shares: (-1..=2)
                    .map(|pair_offset| LoadShare {
                        pair_offset,
                        share: wave(0.25, 0.1),
                    })
                    .collect(),
                transmission_error_statistics: Statistics::of(&delta),
                mesh_stiffness_tangent_statistics: Statistics::of(&k),
                spectrum: case
                    .covers_whole_periods()
                    .then(|| Spectrum::of(&case.pair, case.span(), &delta, &k, case.driving_speed)),
                decomposition: Some(DecompositionParts {
                    rigid_blank_transmission_error: delta.clone(),
                    blanks: vec![BlankFit {
                        member: Member::Driven,
                        interface_radius: 45.5e-3,
                        mean: 2e-6,
                        amplitude: 0.1e-6,
                        phase: 1.0,
                        samples: vec![BlankSample {
                            mesh_position: 0.25,
                            rotation: 2.05e-6,
                        }],
                    }],
                }),
                mesh_position: eta.clone(),
                transmission_error: delta,
                mesh_stiffness_tangent: k,
            }
        };
        Analysis {
            curves: case.output_torques.iter().map(curve).collect(),
            evidence: Evidence {
                degrees_of_freedom: 1000,
                equilibrium_residual: 1e-13,
                complementarity_residual: 1e-15,
                largest_penetration: 1e-18,
                contact_iterations: 7,
                error_estimate: Some(ErrorEstimate {
                    mean: 1e-9,
                    peak_to_peak: 2e-9,
                    mean_stiffness: 1e5,
                }),
            },
            warnings: vec![Warning::TipCornerContact {
                member: Member::Driven,
                largest_share: 0.125,
            }],
        }
    }

    #[test]
    fn the_document_speaks_the_units_of_its_names() {
        let submission = submission("test-case-2", Some(600.0));
        let text = Results::new(&submission, &analysis(submission.case()))
            .to_json()
            .expect("finite");
        let document: Value = serde_json::from_str(&text).expect("JSON");
        let curve = &document["curves"][0];
        let near = |pointer: &str, expected: f64| {
            let value = document
                .pointer(pointer)
                .and_then(Value::as_f64)
                .expect(pointer);
            assert!(
                (value - expected).abs() <= 1e-9 * expected.abs(),
                "{pointer}: {value} {expected}"
            );
        };
        // The first sample is the mean and the whole swing; F = T/r_b2 with r_b2 = 50 cos 20 mm.
        near("/curves/0/transmission_error_um/0", 14.518);
        near("/curves/0/mesh_stiffness_tangent_n_per_m/0", 2.43e8);
        near("/curves/0/peak_contact_pressure_mpa/0", 650.0);
        near(
            "/curves/0/load_n",
            115.0 / (0.05 * 20_f64.to_radians().cos()),
        );
        near("/curves/0/driven_angle_deg/40", 7.2);
        near("/curves/0/decomposition/blanks/0/interface_radius_mm", 45.5);
        near(
            "/curves/0/decomposition/blanks/0/phase_deg",
            1_f64.to_degrees(),
        );
        near(
            "/evidence/error_estimate/transmission_error_peak_to_peak_um",
            2e-3,
        );
        near("/evidence/largest_penetration_um", 1e-12);
        near("/warnings/0/value", 12.5);
        // 600 rpm are 10 Hz; 50 teeth mesh at 500 Hz; the order counts turns of the driven gear, here 10 Hz too.
        near("/frequencies/mesh_hz", 500.0);
        near("/frequencies/period_hz", 100.0);
        let order = curve["spectrum"]["order"][0].as_f64().expect("a number");
        near("/curves/0/spectrum/frequency_hz/0", 10.0 * order);
        assert_eq!(curve["decomposition"]["blanks"][0]["gear"], "driven");
        assert_eq!(document["evidence"]["input_hash"], submission.input_hash());
        assert_eq!(document["evidence"]["resolution"]["grid"], "standard");
        assert_eq!(curve["statistics"]["partial"], false);
        assert!(!text.contains("null"));
    }

    #[test]
    fn the_load_distribution_says_what_each_of_its_formulas_does_not_see() {
        let unseen = |tooth, body| {
            let mut case = submission("test-case-2", None).case().clone();
            case.method = Method::LoadDistribution;
            case.resolution.formulas.tooth = tooth;
            case.resolution.formulas.body = body;
            does_not_see(&case).join("\n")
        };
        let (parts, whole) = (ToothFormula::WeberBanaschek, ToothFormula::Iso6336);
        for (tooth, body, word) in [
            (parts, BodyFormula::Sainsot, "Poisson's ratio"),
            (parts, BodyFormula::HalfPlane, "bores"),
            (parts, BodyFormula::Rigid, "they are rigid"),
            (whole, BodyFormula::Sainsot, "C_M"),
        ] {
            let told = unseen(tooth, body);
            assert!(told.contains(word), "{told}");
            assert!(told.contains("holes: the bodies are solid"));
        }
        assert!(!unseen(parts, BodyFormula::Sainsot).contains("C_M"));
        assert!(!unseen(whole, BodyFormula::Rigid).contains("they are rigid"));
    }

    #[test]
    fn all_lists_of_a_curve_have_one_entry_a_position() {
        let submission = submission("standard-pair", None);
        let text = Results::new(&submission, &analysis(submission.case()))
            .to_json()
            .expect("finite");
        let document: Value = serde_json::from_str(&text).expect("JSON");
        let curves = document["curves"].as_array().expect("curves");
        assert_eq!(curves.len(), 2);
        for curve in curves {
            for (name, list) in curve.as_object().expect("a curve") {
                if let Some(list) = list.as_array().filter(|_| name != "load_shares") {
                    assert_eq!(list.len(), 40, "{name}");
                }
            }
            for share in curve["load_shares"].as_array().expect("shares") {
                assert_eq!(share["share"].as_array().expect("a list").len(), 40);
            }
            assert_eq!(
                curve["spectrum"]["order"].as_array().expect("a list").len(),
                20
            );
        }
        assert!(document.get("frequencies").is_none());
    }

    #[test]
    fn the_results_of_case_3_stay_below_a_megabyte_and_a_half() {
        let submission = submission("test-case-3", Some(1000.0));
        let text = Results::new(&submission, &analysis(submission.case()))
            .to_json()
            .expect("finite");
        assert!(text.len() < 1_500_000, "{} bytes", text.len());
    }

    #[test]
    fn the_same_numbers_give_the_same_bytes_and_a_number_that_is_not_finite_gives_none() {
        let submission = submission("test-case-2", None);
        let mut analysis = analysis(submission.case());
        let write = |analysis: &Analysis| Results::new(&submission, analysis).to_json();
        assert_eq!(write(&analysis), write(&analysis));
        analysis.curves[0].mesh_stiffness_secant[3] = f64::INFINITY;
        assert_eq!(
            write(&analysis).expect_err("not finite").code,
            Code::InternalError
        );
    }
}
