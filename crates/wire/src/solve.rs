//! From a submission to its results, or to its validation.

use meshwright_engine::analysis::Estimate;
use meshwright_engine::analysis::blank_modes::{self, blank_modes};
use meshwright_engine::analysis::contact_pattern::ContactPattern;
use meshwright_engine::analysis::fields::Volume;
use meshwright_engine::analysis::fields::{Fields, fields};
use meshwright_engine::analysis::{self, AnalysisError, face_fields};
use meshwright_engine::contact::Contradiction;
use meshwright_engine::gear::data::LEAST_LIGAMENT;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_engine::vibration::{ModeShape, ShapeSize};
use serde::Serialize;
use utoipa::ToSchema;

use super::declare::document;
use super::gear::{GearDocument, MOST_ENTRIES, MOST_HOLES, MOST_MODIFICATIONS};
use super::geometry::PairGeometry;
use super::problem::{Code, FieldError, Problem};
use super::resolution::ResolutionDocument;
use super::results::Results;
use super::running::jammed;
use super::submission::{
    MOST_POSITIONS, MOST_PROJECTED_POSITIONS, MOST_TAGS, MOST_TORQUES, SOLVER_VERSION, Submission,
};
use super::units::{Side, plain, rounded_inward, significant, to_mpa, to_um};
use super::warning::{GearName, WarningDocument};

/// Computes `submission`.
///
/// # Errors
///
/// A [`Problem`]: `not_converged`, `discretization_failed`, or `stopped` where `run` was told to stop.
pub fn solve(submission: &Submission, library: &Library, run: &Run) -> Result<Results, Problem> {
    let answer = match submission.forces() {
        None => analysis::analyze(submission.case(), library, run).map(|analysis| (analysis, None)),
        Some(request) => {
            analysis::forces::analyze_with_forces(submission.case(), request, library, run)
                .map(|(analysis, forces)| (analysis, Some(forces)))
        }
    };
    let (analysis, forces) = answer.map_err(|error| problem_of(&error))?;
    let results = Results::of(submission, &analysis, forces.as_ref());
    let Some(request) = submission.modes() else {
        return Ok(results);
    };
    let modes = blank_modes(submission.case(), request, run);
    let modes = modes.map_err(|error| problem_of(&error))?;
    Ok(results.with_modes(submission, &modes))
}

/// The shape of mode `number`, from 1, of a gear of `submission`.
///
/// # Errors
///
/// As for [`solve`], and `not_found` where the results list no such mode.
pub fn mode_shape(
    submission: &Submission,
    (gear, number): (GearName, u32),
    run: &Run,
) -> Result<ModeShape, Problem> {
    check_mode_number(submission, gear, number)?;
    let request = submission.modes().ok_or_else(no_modes)?;
    let place = (gear.member(), number as usize - 1);
    let shape = blank_modes::mode_shape(submission.case(), request, place, run);
    let shape = shape.map_err(|error| problem_of(&error))?;
    shape.ok_or_else(|| no_such_mode(gear, number))
}

/// Refuses a number of a mode that no list of `submission` reaches.
///
/// # Errors
///
/// `not_found`.
pub fn check_mode_number(
    submission: &Submission,
    gear: GearName,
    number: u32,
) -> Result<(), Problem> {
    let request = submission.modes().ok_or_else(no_modes)?;
    if (1..=request.asked.count).contains(&(number as usize)) {
        return Ok(());
    }
    Err(no_such_mode(gear, number))
}

/// Cost of [`mode_shape`] until it is written, and the size of the shape.
///
/// # Errors
///
/// As for [`solve`].
pub fn mode_shape_estimate(
    submission: &Submission,
    gear: GearName,
) -> Result<(Estimate, ShapeSize), Problem> {
    let estimate = blank_modes::mode_shape_estimate(submission.case(), gear.member());
    estimate.map_err(|error| problem_of(&error))
}

/// The problem of results without natural modes.
pub fn no_modes() -> Problem {
    let detail = "These results have no natural modes: the submission asks for none.";
    Problem::new(Code::NotFound, detail)
}

fn no_such_mode(gear: GearName, number: u32) -> Problem {
    let detail = format!(
        "The results list no mode {number} of the {} gear: /modes/{} has the modes from 1.",
        gear.word(),
        gear.word()
    );
    Problem::new(Code::NotFound, detail)
}

/// Displacements and stresses in both gears, as the method sees them.
pub enum Inside {
    /// Of plane methods: plates.
    Plates(Fields),
    /// Of those that see the faces.
    Volumes(Fields<Volume>),
}

/// Displacements and stresses in both gears of `submission` under a torque of it, not 0, at a mesh position.
///
/// # Errors
///
/// As for [`solve`].
pub fn inside(
    submission: &Submission,
    (output_torque_n_m, mesh_position): (f64, f64),
    library: &Library,
    run: &Run,
) -> Result<Inside, Problem> {
    let (case, torque, eta) = (submission.case(), output_torque_n_m, mesh_position);
    let found = || match face_fields::volumes(case, torque, eta, library, run)? {
        Some(volumes) => Ok(Inside::Volumes(volumes)),
        None => fields(case, torque, eta, library, run).map(Inside::Plates),
    };
    found().map_err(|error| problem_of(&error))
}

/// The same of plates, and in a section through the middle of the common face.
///
/// # Errors
///
/// As for [`solve`].
pub fn section(
    submission: &Submission,
    (output_torque_n_m, mesh_position): (f64, f64),
    library: &Library,
    run: &Run,
) -> Result<Fields, Problem> {
    let (case, torque, eta) = (submission.case(), output_torque_n_m, mesh_position);
    let found = || match face_fields::section(case, torque, eta, library, run)? {
        Some(section) => Ok(section),
        None => fields(case, torque, eta, library, run),
    };
    found().map_err(|error| problem_of(&error))
}

/// The contact pattern of `submission` under those of its torques, none of them 0.
///
/// # Errors
///
/// As for [`solve`], and `not_found` for a method that does not see the faces.
pub fn contact_pattern(
    submission: &Submission,
    output_torques_n_m: &[f64],
    library: &Library,
    run: &Run,
) -> Result<ContactPattern, Problem> {
    let case = submission.case();
    let found = analysis::contact_pattern::contact_pattern(case, output_torques_n_m, library, run);
    let pattern = found.map_err(|error| problem_of(&error))?;
    pattern.ok_or_else(|| {
        let detail = format!(
            "The contact over the flanks is seen by the method three_dimensional; {} has one section for the whole face.",
            submission.method()
        );
        Problem::new(Code::NotFound, detail)
    })
}

/// The problem of an engine's error, with the field that can mend it.
fn problem_of(error: &AnalysisError) -> Problem {
    const TORQUES: &str = "/output_torques_n_m";
    let of_field = |pointer: &str, code, detail| {
        Problem::of_fields(vec![FieldError::new(pointer, code, detail)])
    };
    match error {
        AnalysisError::NotConverged {
            mesh_position,
            residual,
            iterations,
        } => of_field(
            TORQUES,
            Code::NotConverged,
            format!(
                "The contact did not converge at mesh position {}: a gap of {} um was left after {iterations} iterations.",
                plain(*mesh_position),
                plain(to_um(*residual))
            ),
        ),
        AnalysisError::ContactFailed {
            mesh_position,
            error,
        } => of_field(
            TORQUES,
            Code::NotConverged,
            format!(
                "The contact at mesh position {} could not be solved: {error}.",
                plain(*mesh_position)
            ),
        ),
        AnalysisError::Contradicted {
            mesh_position,
            error,
        } => of_field(
            TORQUES,
            Code::NotConverged,
            format!(
                "The contact found at mesh position {} contradicts its own evidence: {}.",
                plain(*mesh_position),
                contradiction(error)
            ),
        ),
        AnalysisError::WorkDiffers {
            output_torque,
            mean,
            expected,
        } => of_field(
            TORQUES,
            Code::NotConverged,
            format!(
                "Under {} N m the driving torque is {} N m in the mean over a whole period, and {} N m by the work of both torques. More positions may do.",
                plain(*output_torque),
                plain(*mean),
                plain(*expected)
            ),
        ),
        AnalysisError::NoContact { mesh_position } => of_field(
            "/pair/center_distance_mm",
            Code::NotConverged,
            format!(
                "No flanks come near each other at mesh position {}.",
                plain(*mesh_position)
            ),
        ),
        AnalysisError::TooFarApart {
            mesh_position,
            apart,
            coupled,
        } => of_field(
            TORQUES,
            Code::NotConverged,
            format!(
                "At mesh position {} the load presses teeth together that stand {apart} apart; the model couples at most {coupled}. A smaller torque would do.",
                plain(*mesh_position)
            ),
        ),
        AnalysisError::NoFormula {
            formula,
            member,
            compliance,
        } => {
            let part = member.map_or(String::new(), |member| format!(" of the {member} gear"));
            of_field(
                "/resolution/load_distribution",
                Code::NoFormula,
                format!(
                    "Far outside the range for which it was published, {formula}{part} gives a pair of teeth a compliance of {} um/N. It has to be a positive number.",
                    plain(to_um(*compliance))
                ),
            )
        }
        AnalysisError::SectionDiffers => Problem::new(Code::InternalError, error.to_string()),
        AnalysisError::RowFalls(row) => of_field(
            "/force_table",
            Code::NotConverged,
            format!(
                "At mesh position {} the transmission error under {} N is less by {} um than under the load before it. A mesh never yields less under more load: this is a mistake of the solver, and no table is made of it.",
                plain(row.mesh_position),
                plain(row.load),
                plain(to_um(row.falls))
            ),
        ),
        AnalysisError::RimBreaks {
            member,
            stress,
            strength,
            speed,
        } => {
            let pointer = match speed {
                Some(_) => "/running/driving_speed_rpm".to_owned(),
                None => format!("/running/press_fit_um/{member}"),
            };
            let nearest = speed.map(|speed| rounded_inward(60.0 * speed, Side::AtMost, 0));
            let bearable = nearest.map_or_else(
                || "The press fit alone is too much.".to_owned(),
                |rpm| format!("It bears {} 1/min.", plain(rpm)),
            );
            let detail = format!(
                "{pointer}: rotation and press fit stretch the {member} gear by {} MPa, and its material bears {} MPa. {bearable}",
                plain(significant(to_mpa(*stress), 4)),
                plain(significant(to_mpa(*strength), 4))
            );
            let error = FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest);
            Problem::of_fields(vec![error])
        }
        AnalysisError::FlanksJam { backlash } => {
            Problem::of_fields(vec![jammed("/running", *backlash)])
        }
        AnalysisError::Discretization { member, reason } => of_field(
            &format!("/pair/{member}"),
            Code::DiscretizationFailed,
            format!("The {member} gear could not be divided into elements: {reason}."),
        ),
        AnalysisError::Stopped(_) => {
            Problem::new(Code::Stopped, "The work was stopped before it was done.")
        }
    }
}

/// How a contact contradicts its own evidence, in the units of results.
fn contradiction(of: &Contradiction) -> String {
    match of {
        Contradiction::Penetration { depth, deflection } => format!(
            "flanks penetrate each other by {} um, as where a tip is pressed into a fillet, and the load deflects the teeth by {} um",
            plain(to_um(*depth)),
            plain(to_um(*deflection))
        ),
        Contradiction::Deflection { deflection, most } => format!(
            "the load deflects the teeth by {} um, and displacements are small up to a quarter of a module, {} um",
            plain(to_um(*deflection)),
            plain(to_um(*most))
        ),
        Contradiction::Residual { residual } => format!(
            "the forces differ from the load by {} of it",
            plain(*residual)
        ),
    }
}

/// The answer to a submission that would be accepted.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Validation")]
pub struct Validation {
    /// True; a submission that is not valid is answered with its problem.
    pub valid: bool,
    /// The submission with every default filled in.
    pub submission: Submission,
    /// The derived geometry, as in the results.
    pub pair: PairGeometry,
    /// Warnings that are known before the computation.
    pub warnings: Vec<WarningDocument>,
    /// Estimated cost of the computation.
    pub estimate: EstimateDocument,
}

document! {
    /// Estimated cost of a computation.
    pub struct EstimateDocument as Estimate, "Estimate"
        answer of ((submission, estimate): (&Submission, &Estimate)) {
        /// Unknowns of both gears before condensation.
        degrees_of_freedom: u64 = estimate.degrees_of_freedom,
        /// Memory, in MB.
        memory_mb: u64 = estimate.memory.div_ceil(1_000_000),
        /// Time on one core, in seconds.
        seconds: f64 = estimate.seconds,
        /// Positions times torques.
        positions: u64 = submission.positions_total(),
    }
}

/// The filled-in form of `submission`, and its estimated cost.
pub fn validate(submission: &Submission) -> Validation {
    let case = submission.case();
    let warnings = analysis::warnings(case);
    Validation {
        valid: true,
        submission: submission.clone(),
        pair: PairGeometry::of(case),
        warnings: submission.warnings(&warnings),
        estimate: EstimateDocument::of((submission, &submission.estimate())),
    }
}

document! {
    /// The limits of a submission. Those of the service stand beside them.
    pub struct Limits as Limits, "Limits of a submission" view of (designs: usize) with {
        let counts = |(least, most): (f64, f64)| [least as u32, most as u32];
        let positions = ResolutionDocument::positions_per_mesh_period.spec.bounds;
    } {
        /// The version of the solver.
        solver_version: &'static str = SOLVER_VERSION,
        /// The most output torques.
        torques: usize = MOST_TORQUES,
        /// The most positions times torques.
        positions: u64 = MOST_POSITIONS,
        /// The same of the projected methods on teeth that do not deviate.
        projected_positions: u64 = MOST_PROJECTED_POSITIONS,
        /// The most positions in a mesh period.
        positions_per_mesh_period: u32 = counts(positions)[1],
        /// The most holes in a gear.
        holes: usize = MOST_HOLES,
        /// The fewest and the most teeth.
        tooth_count: [u32; 2] = counts(GearDocument::tooth_count.spec.bounds),
        /// The smallest and the largest module, in mm.
        module_mm: [f64; 2] = GearDocument::module_mm.spec.bounds.into(),
        /// The most profile modifications of a gear, beside its tip relief.
        profile_modifications: usize = MOST_MODIFICATIONS,
        /// The most entries of a profile table.
        table_entries: usize = MOST_ENTRIES,
        /// The most tags.
        tags: usize = MOST_TAGS.0,
        /// The most characters of a tag.
        tag_length: usize = MOST_TAGS.1,
        /// The most designs of a study.
        designs: usize = designs,
        /// The least material around a hole, in modules.
        least_ligament_modules: f64 = LEAST_LIGAMENT,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The code of `error` and the detail of its only field.
    fn said(error: &AnalysisError) -> (Code, String) {
        let problem = problem_of(error);
        let [field] = &problem.errors[..] else {
            panic!("{:?}", problem.errors);
        };
        (field.code, field.detail.clone())
    }

    #[test]
    fn a_result_that_contradicts_itself_has_not_converged_with_its_position_and_number() {
        for (error, number) in [
            (
                Contradiction::Penetration {
                    depth: 1.5e-6,
                    deflection: 12e-6,
                },
                "1.5 um",
            ),
            (
                Contradiction::Deflection {
                    deflection: -0.4,
                    most: 5e-4,
                },
                "-400000 um",
            ),
            (Contradiction::Residual { residual: 2e-5 }, "2e-5"),
        ] {
            let (code, detail) = said(&AnalysisError::Contradicted {
                mesh_position: 0.625,
                error,
            });
            assert_eq!(code, Code::NotConverged);
            assert!(
                detail.contains("0.625") && detail.contains(number),
                "{detail}"
            );
        }
        let (code, detail) = said(&AnalysisError::WorkDiffers {
            output_torque: 100.0,
            mean: 52.5,
            expected: 50.0,
        });
        assert_eq!(code, Code::NotConverged);
        assert!(
            detail.contains("52.5 N m") && detail.contains("50 N m"),
            "{detail}"
        );
    }
}
