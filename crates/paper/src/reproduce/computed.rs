//! The computation: test cases by every method, designs at both torques, sweeps over the torque.

use std::time::Instant;

use anyhow::Context;
use meshwright_engine::analysis::{Analysis, Case, Curve, Method, Model, SectionHoles, analyze};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

use super::cases;

/// The methods of Table 2, and ours beside them.
pub(super) const METHODS: [SectionHoles; 3] = [
    SectionHoles::Whole,
    SectionHoles::Fitted,
    SectionHoles::FirstOrder,
];

/// The name of the method that makes this of the holes of a section.
pub(super) fn name_of(holes: SectionHoles) -> &'static str {
    method_name(Model::Section(holes).method())
}

/// The name of a method in legends and tables.
pub(crate) fn method_name(method: Method) -> &'static str {
    match method {
        Method::Flexible => "flexible",
        Method::Decomposition => "decomposition",
        Method::ProjectedDecomposition => "projected decomposition",
        Method::ThreeDimensional => "three-dimensional",
        Method::ThreeDimensionalProjected => "three-dimensional, projected",
        Method::LoadDistribution => "load distribution",
    }
}

/// The torques of a sweep in N m: 40 equal steps from 2 to 300.
const SWEEP: (f64, f64, u32) = (2.0, 300.0, 40);

/// Points between the neighbors of the least peak-to-peak, to name its torque.
const REFINEMENT: u32 = 16;

/// Interface radii of test case 2 in meters, from above its holes (41.5 mm) to below its roots (47.5 mm).
const INTERFACES: [f64; 5] = [42.5e-3, 43.5e-3, 44.5e-3, 45.5e-3, 46.5e-3];

/// Everything that the report needs.
pub(super) struct Computed {
    /// Test cases 1 to 3.
    pub(super) test_cases: Vec<TestCase>,
    /// The standard pair, then the nine designs of Table 3.
    pub(super) designs: Vec<Design>,
    /// The standard pair, the 29/85 pair without holes, and test case 2.
    pub(super) sweeps: Vec<Sweep>,
    /// Test case 2 by decomposition at other interface radii in meters.
    pub(super) interfaces: Vec<(f64, Curve)>,
}

/// A test case by every method.
pub(super) struct TestCase {
    /// 1 to 3.
    pub(super) number: usize,
    /// The case, flexible.
    pub(super) case: Case,
    /// The answers, in the order of [`METHODS`].
    pub(super) answers: Vec<Answer>,
}

/// The answer of one method.
pub(super) struct Answer {
    /// The curve.
    pub(super) curve: Curve,
    /// Seconds with nothing computed before.
    pub(super) seconds: f64,
    /// Seconds with the pair without holes computed before, so that a new hole pattern costs its blanks only.
    pub(super) seconds_with_teeth: f64,
}

impl TestCase {
    pub(super) fn flexible(&self) -> &Curve {
        &self.answers[0].curve
    }

    pub(super) fn decomposition(&self) -> &Curve {
        &self.answers[1].curve
    }

    pub(super) fn projected(&self) -> &Curve {
        &self.answers[2].curve
    }
}

/// A design of section 5 at 20 and 115 N m.
pub(super) struct Design {
    /// Its name in the paper.
    pub(super) name: String,
    /// The case, flexible.
    pub(super) case: Case,
    /// True if the paper kept it; the standard pair counts as kept.
    pub(super) kept: bool,
    /// The flexible curves at 20 and 115 N m.
    pub(super) flexible: [Curve; 2],
    /// The same by decomposition.
    pub(super) decomposition: [Curve; 2],
}

/// Curves over the torque.
pub(super) struct Sweep {
    /// Name of the pair.
    pub(super) name: &'static str,
    /// One curve a torque, rising.
    pub(super) curves: Vec<Curve>,
    /// The torque of the least peak-to-peak in N m, between the sweep's own.
    pub(super) best_torque: f64,
    /// The peak-to-peak there, in meters.
    pub(super) best: f64,
}

impl Computed {
    /// Computes it all, and reports to `progress`.
    ///
    /// # Errors
    ///
    /// If a case cannot be made or computed.
    pub(super) fn new(progress: &dyn Fn(&str)) -> anyhow::Result<Self> {
        let test_cases = (1..=3)
            .map(|number| {
                let test_case = test_case(number)?;
                let times: Vec<String> = METHODS
                    .iter()
                    .zip(&test_case.answers)
                    .map(|(method, answer)| format!("{} {:.2} s", name_of(*method), answer.seconds))
                    .collect();
                progress(&format!("Test case {number}: {}.", times.join(", ")));
                Ok(test_case)
            })
            .collect::<anyhow::Result<_>>()?;
        let started = Instant::now();
        let designs = designs()?;
        progress(&format!(
            "Section 5: {} designs at two torques by two methods, {:.2} s.",
            designs.len(),
            started.elapsed().as_secs_f64()
        ));
        let mut sweeps = Vec::new();
        for (name, case) in sweep_cases()? {
            let started = Instant::now();
            let sweep = sweep(name, &case)?;
            progress(&format!(
                "Torque sweep, {name}: least p-p {:.2} um at {:.0} N m, {:.2} s.",
                sweep.best * 1e6,
                sweep.best_torque,
                started.elapsed().as_secs_f64()
            ));
            sweeps.push(sweep);
        }
        let started = Instant::now();
        let interfaces = interfaces()?;
        progress(&format!(
            "Interface radius: {} values, {:.2} s.",
            interfaces.len(),
            started.elapsed().as_secs_f64()
        ));
        Ok(Self {
            test_cases,
            designs,
            sweeps,
            interfaces,
        })
    }

    /// The design called `name`.
    pub(super) fn design(&self, name: &str) -> anyhow::Result<&Design> {
        let found = self.designs.iter().find(|design| design.name == name);
        found.with_context(|| format!("no design is called {name}"))
    }

    /// The designs that the paper kept, without the standard pair.
    pub(super) fn holed_kept(&self) -> impl Iterator<Item = &Design> {
        self.designs
            .iter()
            .filter(|design| design.kept && design.case.pair.driven().has_holes())
    }
}

fn answer(case: &Case, library: &Library) -> anyhow::Result<Analysis> {
    analyze(case, library, &Run::unattended())
        .with_context(|| format!("the {} method failed", method_name(case.method())))
}

fn only_curve(case: &Case, library: &Library) -> anyhow::Result<Curve> {
    let mut curves = answer(case, library)?.curves;
    curves.pop().context("a case of one torque has one curve")
}

/// Computes test case `number` by every method, each from nothing and once more with its teeth known.
pub(super) fn test_case(number: usize) -> anyhow::Result<TestCase> {
    let case = cases::example(&format!("test-case-{number}"))?;
    let without_holes = cases::with_holes(&case, None)?;
    let answers = METHODS
        .into_iter()
        .map(|method| {
            let case = cases::by(&case, method);
            let teeth = Library::default();
            only_curve(&without_holes, &teeth)?;
            let started = Instant::now();
            let curve = only_curve(&case, &Library::default())?;
            let seconds = started.elapsed().as_secs_f64();
            let started = Instant::now();
            only_curve(&case, &teeth)?;
            Ok(Answer {
                curve,
                seconds,
                seconds_with_teeth: started.elapsed().as_secs_f64(),
            })
        })
        .collect::<anyhow::Result<_>>()?;
    Ok(TestCase {
        number,
        case,
        answers,
    })
}

/// The standard pair and the nine designs of Table 3, those that the paper kept first.
fn designs() -> anyhow::Result<Vec<Design>> {
    let library = Library::default();
    let standard = cases::example("standard-pair")?;
    let mut designs = vec![design("standard", standard, true, &library)?];
    let all = cases::HOLE_CIRCLES
        .into_iter()
        .flat_map(|circle| cases::HOLE_COUNTS.map(|count| (count, circle)));
    let dropped = all.filter(|cell| !cases::KEPT.contains(cell));
    for (count, circle) in cases::KEPT.into_iter().chain(dropped) {
        let kept = cases::KEPT.contains(&(count, circle));
        let case = cases::design(count, circle)?;
        designs.push(design(
            &cases::design_name(count, circle),
            case,
            kept,
            &library,
        )?);
    }
    Ok(designs)
}

/// Computes one design at both torques by both methods.
pub(super) fn design(
    name: &str,
    case: Case,
    kept: bool,
    library: &Library,
) -> anyhow::Result<Design> {
    let case = cases::at_torques(&case, vec![20.0, 115.0]);
    let curves = |method| -> anyhow::Result<[Curve; 2]> {
        let curves = answer(&cases::by(&case, method), library)?.curves;
        curves.try_into().map_err(|curves: Vec<Curve>| {
            anyhow::anyhow!("{} curves for two torques", curves.len())
        })
    };
    Ok(Design {
        name: name.into(),
        kept,
        flexible: curves(SectionHoles::Whole)?,
        decomposition: curves(SectionHoles::Fitted)?,
        case,
    })
}

/// Test case 2 by decomposition with the interface at each of [`INTERFACES`].
fn interfaces() -> anyhow::Result<Vec<(f64, Curve)>> {
    let mut case = cases::by(&cases::example("test-case-2")?, SectionHoles::Fitted);
    let library = Library::default();
    INTERFACES
        .into_iter()
        .map(|radius| {
            case.resolution.interface_radii = [Some(radius); 2];
            Ok((radius, only_curve(&case, &library)?))
        })
        .collect()
}

fn sweep_cases() -> anyhow::Result<[(&'static str, Case); 3]> {
    let reducer = cases::with_holes(&cases::example("test-case-3")?, None)?;
    Ok([
        ("standard pair", cases::example("standard-pair")?),
        ("29/85 teeth without holes", reducer),
        // Forty torques of a holed pair: a case for the method that solves the contact over one mesh period.
        (
            "test case 2, projected",
            cases::by(&cases::example("test-case-2")?, SectionHoles::FirstOrder),
        ),
    ])
}

fn sweep(name: &'static str, case: &Case) -> anyhow::Result<Sweep> {
    let library = Library::default();
    let (low, high, count) = SWEEP;
    let curves = answer(&cases::at_torques(case, steps(low, high, count)), &library)?.curves;
    let peak_to_peak = |curve: &Curve| curve.transmission_error_statistics.peak_to_peak;
    let least = |curves: &[Curve]| {
        let order =
            |a: &usize, b: &usize| peak_to_peak(&curves[*a]).total_cmp(&peak_to_peak(&curves[*b]));
        (0..curves.len())
            .min_by(order)
            .context("a sweep has points")
    };
    let i = least(&curves)?;
    let from = curves[i.saturating_sub(1)].output_torque;
    let to = curves[(i + 1).min(curves.len() - 1)].output_torque;
    let near = answer(
        &cases::at_torques(case, steps(from, to, REFINEMENT)),
        &library,
    )?
    .curves;
    let best = &near[least(&near)?];
    Ok(Sweep {
        name,
        best_torque: best.output_torque,
        best: peak_to_peak(best),
        curves,
    })
}

/// `count` equal steps from `low` to `high`, both included.
fn steps(low: f64, high: f64, count: u32) -> Vec<f64> {
    let step = (high - low) / f64::from(count - 1);
    (0..count).map(|i| low + f64::from(i) * step).collect()
}

/// The named line of the spectrum of `curve`: its amplitudes of δ in meters and of k in N/m.
pub(crate) fn line(curve: &Curve, label: &str) -> anyhow::Result<(f64, f64)> {
    let spectrum = curve
        .spectrum
        .as_ref()
        .context("a true period has a spectrum")?;
    let line = spectrum
        .line(label)
        .with_context(|| format!("the spectrum has no line {label}"))?;
    Ok((line.transmission_error, line.mesh_stiffness_tangent))
}
