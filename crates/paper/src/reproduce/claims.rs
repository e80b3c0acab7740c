//! The paper's statements, compared with the computed numbers.

use meshwright_engine::analysis::Curve;

use super::computed::{Computed, Design, TestCase, line};
use super::paper::{OPTIMAL_TORQUES, STANDARD_PEAK_TO_PEAK};
use super::tables::{Cells, micro, peak_to_peak_at, percent, statistics, table};

/// Verdict on a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Holds,
    InPart,
    DoesNot,
}

impl Verdict {
    /// Holds if all do, not at all if none does.
    fn of(all: &[bool]) -> Self {
        match all.iter().filter(|&&one| one).count() {
            0 => Self::DoesNot,
            count if count == all.len() => Self::Holds,
            _ => Self::InPart,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::InPart => "**in part**",
            Self::DoesNot => "**does not hold**",
        }
    }
}

/// A claim, with the computed numbers.
pub(super) struct Claim {
    place: &'static str,
    words: &'static str,
    verdict: Verdict,
    numbers: String,
}

/// An amplitude below this share of another counts as negligible beside it.
const NEGLIGIBLE: f64 = 0.1;

/// An amplitude this far from another no longer counts as the same.
const SAME: f64 = 0.05;

/// Every claim.
///
/// # Errors
///
/// If a curve lacks a line that it must have.
pub(super) fn claims(computed: &Computed) -> anyhow::Result<[Claim; 16]> {
    Ok([
        hole_lines(computed)?,
        one_family(computed)?,
        identical_amplitudes(computed)?,
        sidebands(computed)?,
        sideband_cause(computed)?,
        sidebands_of_the_decomposition(computed)?,
        close_statistics(computed),
        best_torques(computed),
        standard_peak_to_peak(computed)?,
        low_torque_is_worse(computed)?,
        grows_with_radius(computed)?,
        more_holes(computed)?,
        grows_with_torque(computed)?,
        what_governs(computed)?,
        mean_stiffness(computed)?,
        stiffness_fluctuation(computed)?,
    ])
}

/// The table of claims.
pub(super) fn as_table(claims: &[Claim]) -> String {
    let rows: Vec<Cells> = claims
        .iter()
        .map(|claim| {
            vec![
                claim.place.to_owned(),
                claim.words.to_owned(),
                claim.verdict.word().to_owned(),
                claim.numbers.clone(),
            ]
        })
        .collect();
    table(
        &["section", "the paper says", "computed", "with the numbers"],
        &rows,
    )
}

/// The claims that do not hold or hold in part, in a sentence.
pub(super) fn refuted(claims: &[Claim]) -> String {
    let words = |verdict: Verdict| {
        claims
            .iter()
            .filter(move |claim| claim.verdict == verdict)
            .map(|claim| format!("\"{}\"", claim.words))
    };
    let not = words(Verdict::DoesNot).map(|words| format!("not {words}"));
    let in_part = words(Verdict::InPart).map(|words| format!("in part {words}"));
    not.chain(in_part).collect::<Vec<_>>().join("; ")
}

fn ste(curve: &Curve, label: &str) -> anyhow::Result<f64> {
    Ok(line(curve, label)?.0)
}

/// `of` for every item, joined.
fn listed<T>(
    items: impl IntoIterator<Item = T>,
    of: impl Fn(T) -> anyhow::Result<String>,
) -> anyhow::Result<String> {
    let texts: Vec<String> = items.into_iter().map(of).collect::<anyhow::Result<_>>()?;
    Ok(texts.join("; "))
}

fn hole_lines(computed: &Computed) -> anyhow::Result<Claim> {
    let mut shown = Vec::new();
    let numbers = listed(&computed.test_cases, |case| {
        let curve = case.flexible();
        let (h_n, h_z) = (ste(curve, "H_N")?, ste(curve, "H_Z2")?);
        Ok(format!(
            "case {}: H_N {}, H_Z2 {} µm",
            case.number,
            micro(h_n),
            micro(h_z)
        ))
    })?;
    for case in &computed.test_cases {
        let least = 0.01 * case.flexible().transmission_error_statistics.peak_to_peak;
        shown.push(ste(case.flexible(), "H_N")? > least && ste(case.flexible(), "H_Z2")? > least);
    }
    Ok(Claim {
        place: "4.1",
        words: "the spectra show the mesh harmonics and the line H_N of the holes",
        verdict: Verdict::of(&shown),
        numbers,
    })
}

fn one_family(computed: &Computed) -> anyhow::Result<Claim> {
    let case = &computed.test_cases[0];
    let mut off: f64 = 0.0;
    if let Some(spectrum) = &case.flexible().spectrum {
        for (order, amplitude) in spectrum.order.iter().zip(&spectrum.transmission_error) {
            // k 50 ± l 8 are the multiples of 2.
            if (order / 2.0 - (order / 2.0).round()).abs() > 1e-9 {
                off = off.max(*amplitude);
            }
        }
    }
    let share = off / case.flexible().transmission_error_statistics.mean;
    let one = line(case.flexible(), "H_N1").is_err() && line(case.flexible(), "H_N2").is_err();
    Ok(Claim {
        place: "4.1",
        words: "case 1: eight holes in both gears make no lines besides those of one",
        verdict: Verdict::of(&[one && share < 1e-9]),
        numbers: format!(
            "all lines are at multiples of gcd(50, 8) = 2; elsewhere nothing is above {} of the mean",
            if share < 1e-9 {
                "1e-9".to_owned()
            } else {
                format!("{share:.0e}")
            }
        ),
    })
}

fn identical_amplitudes(computed: &Computed) -> anyhow::Result<Claim> {
    const LABELS: [&str; 4] = ["H_N", "H_Z2", "H_2Z2", "H_3Z2"];
    let mut same = Vec::new();
    for case in &computed.test_cases {
        for label in LABELS {
            let (a, b) = (
                ste(case.decomposition(), label)?,
                ste(case.flexible(), label)?,
            );
            same.push((a / b - 1.0).abs() < SAME);
        }
    }
    let numbers = listed(&computed.test_cases, |case| {
        let differences = LABELS.map(|label| -> anyhow::Result<String> {
            Ok(format!(
                "{label} {}",
                percent(
                    ste(case.decomposition(), label)?,
                    ste(case.flexible(), label)?
                )
            ))
        });
        let differences: Vec<String> = differences.into_iter().collect::<anyhow::Result<_>>()?;
        Ok(format!("case {}: {}", case.number, differences.join(", ")))
    })?;
    Ok(Claim {
        place: "4.1",
        words: "the amplitudes of the components are identical for the flexible method and the decomposition",
        verdict: Verdict::of(&same),
        numbers: format!(
            "STE, decomposition to flexible, within 5 % counting as identical: {numbers}"
        ),
    })
}

/// The largest sideband H_(k Z2 ± l N) of a curve, k up to 4 and l up to 2: its name, and its amplitudes in δ and k.
fn largest_sideband(curve: &Curve) -> (String, f64, f64) {
    let mut largest = (String::new(), 0.0, 0.0);
    if let Some(spectrum) = &curve.spectrum {
        for named in &spectrum.named {
            if named.label.contains(['+', '-']) && named.transmission_error > largest.1 {
                largest = (named.label.clone(), named.transmission_error, largest.2);
            }
        }
        largest.2 = spectrum
            .named
            .iter()
            .filter(|named| named.label.contains(['+', '-']))
            .map(|named| named.mesh_stiffness_tangent)
            .fold(0.0, f64::max);
    }
    largest
}

fn sidebands(computed: &Computed) -> anyhow::Result<Claim> {
    let mut negligible = Vec::new();
    for case in &computed.test_cases {
        let curve = case.flexible();
        let (_, in_ste, in_k) = largest_sideband(curve);
        let (h_n, h_z) = (line(curve, "H_N")?, line(curve, "H_Z2")?);
        negligible.push(in_ste < NEGLIGIBLE * h_n.0.min(h_z.0));
        negligible.push(in_k < NEGLIGIBLE * h_n.1.min(h_z.1));
    }
    let numbers = listed(&computed.test_cases, |case| {
        let curve = case.flexible();
        let (label, in_ste, in_k) = largest_sideband(curve);
        let (h_n, h_z) = (line(curve, "H_N")?, line(curve, "H_Z2")?);
        let share = |a: f64, b: f64| format!("{:.0} %", a / b * 100.0);
        Ok(format!(
            "case {}: {label} has {} µm, {} of H_N and {} of H_Z2; in k the largest is {} of H_N and {} of H_Z2",
            case.number,
            micro(in_ste),
            share(in_ste, h_n.0),
            share(in_ste, h_z.0),
            share(in_k, h_n.1),
            share(in_k, h_z.1)
        ))
    })?;
    Ok(Claim {
        place: "4.1",
        words: "the flexible method has sidebands H_(kZ2 ± lN), negligible beside H_N and H_kZ2",
        verdict: Verdict::of(&negligible),
        numbers: format!("below a tenth counting as negligible: {numbers}"),
    })
}

fn sideband_cause(computed: &Computed) -> anyhow::Result<Claim> {
    let case = &computed.test_cases[1];
    let below = ste(case.flexible(), "H_Z2-N")?;
    Ok(Claim {
        place: "4.1",
        words: "there are sidebands because N is not a submultiple of Z2",
        verdict: Verdict::of(&[below < 1e-9]),
        numbers: format!(
            "in case 2, where N = 10 divides Z2 = 50, H_(Z2-N) has {} µm: the product of mesh and hole modulation is enough",
            micro(below)
        ),
    })
}

fn sidebands_of_the_decomposition(computed: &Computed) -> anyhow::Result<Claim> {
    let share = |case: &TestCase| {
        let curve = case.decomposition();
        let (_, in_ste, in_k) = largest_sideband(curve);
        (
            in_ste / curve.transmission_error_statistics.mean,
            in_k / curve.mesh_stiffness_tangent_statistics.mean,
        )
    };
    let holds: Vec<bool> = computed
        .test_cases
        .iter()
        .map(|case| share(case).0 < 1e-9 && share(case).1 > 1e-4)
        .collect();
    let numbers = listed(&computed.test_cases, |case| {
        Ok(format!(
            "case {}: {:.2} %",
            case.number,
            share(case).1 * 100.0
        ))
    })?;
    Ok(Claim {
        place: "4.1",
        words: "the decomposition has no sidebands in the STE, but has them in k",
        verdict: Verdict::of(&holds),
        numbers: format!(
            "STE below 1e-9 of the mean; k, largest sideband over the mean: {numbers}"
        ),
    })
}

fn close_statistics(computed: &Computed) -> Claim {
    let errors = |case: &TestCase| {
        let (a, b) = (
            statistics(case.decomposition()),
            statistics(case.flexible()),
        );
        [0, 1, 2, 3].map(|i| a[i] / b[i] - 1.0)
    };
    let paper = [0.005, 0.12, 0.12, 0.05];
    let close: Vec<bool> = computed
        .test_cases
        .iter()
        .flat_map(|case| {
            errors(case)
                .into_iter()
                .zip(paper)
                .map(|(error, bound)| error.abs() <= bound)
        })
        .collect();
    let numbers: Vec<String> = computed
        .test_cases
        .iter()
        .map(|case| {
            let [mean, rms, peak_to_peak, k] =
                errors(case).map(|error| format!("{:+.1}", error * 100.0));
            format!("case {}: {mean}, {rms}, {peak_to_peak}, {k} %", case.number)
        })
        .collect();
    Claim {
        place: "4.1",
        words: "the decomposition is close: mean within 0.5 %, rms and peak-to-peak within 12 %, mean k within 5 %",
        verdict: Verdict::of(&close),
        numbers: numbers.join("; "),
    }
}

fn best_torques(computed: &Computed) -> Claim {
    let mut holds = Vec::new();
    let mut numbers = Vec::new();
    for (sweep, printed) in computed.sweeps.iter().zip(OPTIMAL_TORQUES) {
        holds.push((sweep.best_torque / printed - 1.0).abs() < 0.15);
        numbers.push(format!(
            "{}: least p-p {:.2} µm at {:.0} N m, {:.2} µm at the paper's {printed}",
            sweep.name,
            sweep.best * 1e6,
            sweep.best_torque,
            peak_to_peak_at(sweep, printed) * 1e6
        ));
    }
    Claim {
        place: "4.1, 5.1",
        words: "the relief minimizes the STE at 115 N m (50/50) and 160 N m (29/85)",
        verdict: Verdict::of(&holds),
        numbers: format!(
            "within 15 % counting as that torque: {}",
            numbers.join("; ")
        ),
    }
}

fn standard_peak_to_peak(computed: &Computed) -> anyhow::Result<Claim> {
    let curves = &computed.design("standard")?.flexible;
    let found = [0, 1].map(|i| curves[i].transmission_error_statistics.peak_to_peak * 1e6);
    // The paper gives whole micrometers.
    let holds = [0, 1].map(|i| (found[i] - STANDARD_PEAK_TO_PEAK[i]).abs() < 0.5);
    Ok(Claim {
        place: "5.1",
        words: "the standard pair has p-p 2 µm at 20 N m and 1 µm at 115 N m",
        verdict: Verdict::of(&holds),
        numbers: format!(
            "{:.2} and {:.2} µm; CalculiX (tests/reference) has 2.51 µm over nine positions at 20 N m",
            found[0], found[1]
        ),
    })
}

fn low_torque_is_worse(computed: &Computed) -> anyhow::Result<Claim> {
    let curves = &computed.design("standard")?.flexible;
    let [low, high] = [0, 1].map(|i| curves[i].transmission_error_statistics.peak_to_peak);
    Ok(Claim {
        place: "5.1",
        words: "the p-p of the standard pair is larger at 20 than at 115 N m",
        verdict: Verdict::of(&[low > high]),
        numbers: format!("{:.2} against {:.2} µm", low * 1e6, high * 1e6),
    })
}

fn grows_with_radius(computed: &Computed) -> anyhow::Result<Claim> {
    let designs = ["8R27", "8R30", "8R34"].map(|name| computed.design(name));
    let mut holds = Vec::new();
    let mut numbers = Vec::new();
    for torque in [0, 1] {
        let mut amplitudes = Vec::new();
        for design in &designs {
            let design = design
                .as_ref()
                .map_err(|error| anyhow::anyhow!("{error}"))?;
            amplitudes.push(ste(&design.flexible[torque], "H_N")?);
        }
        holds.push(amplitudes.is_sorted());
        let texts: Vec<String> = amplitudes.into_iter().map(micro).collect();
        numbers.push(format!(
            "{} µm at {} N m",
            texts.join(" < "),
            [20, 115][torque]
        ));
    }
    Ok(Claim {
        place: "5.2",
        words: "H_N grows with R: 8R27 < 8R30 < 8R34",
        verdict: Verdict::of(&holds),
        numbers: numbers.join("; "),
    })
}

fn more_holes(computed: &Computed) -> anyhow::Result<Claim> {
    let mut holds = Vec::new();
    let mut numbers = Vec::new();
    for (more, fewer) in [("10R34", "8R34"), ("8R30", "6R30")] {
        let (a, b) = (computed.design(more)?, computed.design(fewer)?);
        for torque in [0, 1] {
            let both = |design: &Design| design.flexible[torque].transmission_error_statistics;
            let (a, b) = (both(a), both(b));
            holds.push(a.rms < b.rms);
            holds.push(a.peak_to_peak < b.peak_to_peak);
            numbers.push(format!(
                "{more} to {fewer} at {} N m: rms {}, p-p {}",
                [20, 115][torque],
                percent(a.rms, b.rms),
                percent(a.peak_to_peak, b.peak_to_peak)
            ));
        }
    }
    Ok(Claim {
        place: "5.2",
        words: "more holes at the same R lower the STE fluctuation: 10R34 < 8R34, 8R30 < 6R30",
        verdict: Verdict::of(&holds),
        numbers: numbers.join("; "),
    })
}

fn grows_with_torque(computed: &Computed) -> anyhow::Result<Claim> {
    let mut holds = Vec::new();
    for design in computed.holed_kept() {
        holds.push(ste(&design.flexible[0], "H_N")? < ste(&design.flexible[1], "H_N")?);
    }
    let numbers = listed(computed.holed_kept(), |design| {
        let [low, high] = [0, 1].map(|i| ste(&design.flexible[i], "H_N"));
        Ok(format!(
            "{} {} to {} µm",
            design.name,
            micro(low?),
            micro(high?)
        ))
    })?;
    Ok(Claim {
        place: "5.2",
        words: "H_N grows with the torque",
        verdict: Verdict::of(&holds),
        numbers,
    })
}

fn what_governs(computed: &Computed) -> anyhow::Result<Claim> {
    let mut holds = Vec::new();
    let mut numbers = Vec::new();
    for design in computed.holed_kept() {
        let share = |i: usize| -> anyhow::Result<f64> {
            Ok(ste(&design.flexible[i], "H_N")? / ste(&design.flexible[i], "H_Z2")?)
        };
        holds.push(share(0)? < 1.0 && share(1)? > share(0)?);
        numbers.push(format!(
            "{} {:.2} to {:.2}",
            design.name,
            share(0)?,
            share(1)?
        ));
    }
    Ok(Claim {
        place: "5.2",
        words: "the relief governs the fluctuation at 20 N m, the deformation at 115 N m",
        verdict: Verdict::of(&holds),
        numbers: format!("H_N over H_Z2 from 20 to 115 N m: {}", numbers.join("; ")),
    })
}

/// Change of one statistic of k by the holes, in percent, for each design at one torque.
fn stiffness_changes(
    computed: &Computed,
    torque: usize,
    of: usize,
) -> anyhow::Result<(Vec<bool>, String)> {
    let standard = statistics(&computed.design("standard")?.flexible[torque])[of];
    let mut lower = Vec::new();
    let mut texts = Vec::new();
    for design in computed.holed_kept() {
        let value = statistics(&design.flexible[torque])[of];
        lower.push(value < standard);
        texts.push(format!("{} {}", design.name, percent(value, standard)));
    }
    Ok((
        lower,
        format!("at {} N m {}", [20, 115][torque], texts.join(", ")),
    ))
}

fn mean_stiffness(computed: &Computed) -> anyhow::Result<Claim> {
    let (low, high) = (
        stiffness_changes(computed, 0, 3)?,
        stiffness_changes(computed, 1, 3)?,
    );
    Ok(Claim {
        place: "5.2, 6",
        words: "holes lower the mean mesh stiffness",
        verdict: Verdict::of(&[low.0, high.0].concat()),
        numbers: format!("{}; {}", low.1, high.1),
    })
}

fn stiffness_fluctuation(computed: &Computed) -> anyhow::Result<Claim> {
    let (low, high) = (
        stiffness_changes(computed, 0, 4)?,
        stiffness_changes(computed, 1, 4)?,
    );
    Ok(Claim {
        place: "5.2, 6",
        words: "holes lower the fluctuation of the mesh stiffness",
        verdict: Verdict::of(&[low.0, high.0].concat()),
        numbers: format!("rms: {}; {}", low.1, high.1),
    })
}
