//! The tables of the paper, recomputed, as Markdown.

use meshwright_engine::analysis::{Curve, Statistics};
use meshwright_engine::gear::{Member, SpurGear};

use super::cases::{HOLE_CIRCLES, HOLE_COUNTS, design_name};
use super::computed::{Computed, Design, Sweep, TestCase, line};
use super::paper::{self, OPTIMAL_TORQUES, PrintedCase};

/// A row of a table.
pub(crate) type Cells = Vec<String>;

/// A Markdown table.
pub(crate) fn table(header: &[&str], rows: &[Cells]) -> String {
    let mut text = row(header);
    text.push_str(&row(&vec!["---"; header.len()]));
    for cells in rows {
        text.push_str(&row(cells));
    }
    text
}

/// One line of a Markdown table.
pub(super) fn row(cells: &[impl AsRef<str>]) -> String {
    let cells: Vec<&str> = cells.iter().map(AsRef::as_ref).collect();
    format!("| {} |\n", cells.join(" | "))
}

/// `value` in units of 1e-6 with three decimals.
pub(super) fn micro(value: f64) -> String {
    format!("{:.3}", value * 1e6)
}

/// `value` in units of 1e-3 with `decimals`.
fn milli(value: f64, decimals: usize) -> String {
    format!("{:.decimals$}", value * 1e3)
}

/// Difference of `value` from `reference`, in percent with its sign.
pub(super) fn percent(value: f64, reference: f64) -> String {
    let percent = (value / reference - 1.0) * 100.0;
    // Not "-0.0": the sign of nothing is noise.
    if percent.abs() < 0.05 {
        "0.0 %".into()
    } else {
        format!("{percent:+.1} %")
    }
}

/// The quantities of Table 2: names, then units.
const QUANTITIES: [(&str, &str); 6] = [
    ("STE mean", "µm"),
    ("STE rms", "µm"),
    ("STE peak-to-peak", "µm"),
    ("stiffness mean", "N/m"),
    ("stiffness rms", "N/m"),
    ("stiffness peak-to-peak", "N/m"),
];

/// The six values of Table 2 for a curve, in its units.
pub(super) fn statistics(curve: &Curve) -> [f64; 6] {
    let list =
        |s: &Statistics, scale: f64| [s.mean, s.rms, s.peak_to_peak].map(|value| value * scale);
    let [a, b, c] = list(&curve.transmission_error_statistics, 1e6);
    let [d, e, f] = list(&curve.mesh_stiffness_tangent_statistics, 1.0);
    [a, b, c, d, e, f]
}

fn number(i: usize, value: f64) -> String {
    if i < 3 {
        format!("{value:.3}")
    } else {
        format!("{value:.3e}")
    }
}

/// The heads of the columns of Table 2.
pub(super) const TABLE_2_HEADER: [&str; 8] = [
    "quantity",
    "unit",
    "paper, flexible",
    "flexible",
    "to the paper",
    "paper, decomposition (its error)",
    "decomposition (error)",
    "projected (error)",
];

/// The block of Table 2 for one test case.
pub(super) fn table_2(test_case: &TestCase) -> Vec<Cells> {
    let printed = &paper::TABLE_2[test_case.number - 1];
    let [flexible, decomposition, projected] = [
        test_case.flexible(),
        test_case.decomposition(),
        test_case.projected(),
    ]
    .map(statistics);
    (0..QUANTITIES.len())
        .map(|i| {
            let (name, unit) = QUANTITIES[i];
            let of_paper = printed.value(&printed.flexible, i);
            let against = |values: &[f64; 6]| {
                format!(
                    "{} ({})",
                    number(i, values[i]),
                    percent(values[i], flexible[i])
                )
            };
            vec![
                name.to_owned(),
                unit.to_owned(),
                number(i, of_paper),
                number(i, flexible[i]),
                percent(flexible[i], of_paper),
                printed_decomposition(printed, i),
                against(&decomposition),
                against(&projected),
            ]
        })
        .collect()
}

fn printed_decomposition(printed: &PrintedCase, i: usize) -> String {
    let value = printed.value(&printed.decomposition, i);
    format!("{} ({} %)", number(i, value), printed.errors[i])
}

/// Table 1: values from the drawing of each gear, and those that the paper prints.
pub(super) fn table_1(computed: &Computed) -> String {
    let mut rows = Vec::new();
    for (test_case, printed) in computed.test_cases.iter().zip(paper::BASE_RADII) {
        for (member, printed) in Member::BOTH.into_iter().zip(printed) {
            let gear = test_case.case.pair.gear(member);
            let holes = gear.hole_pattern();
            let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".into());
            rows.push(vec![
                test_case.number.to_string(),
                member.to_string(),
                gear.tooth_count().to_string(),
                format!("{} ({printed})", milli(gear.base_radius(), 3)),
                milli(gear.tip_radius(), 1),
                milli(gear.root_radius(), 1),
                milli(gear.form_radius(), 3),
                milli(gear.bore_radius(), 0),
                or_dash(holes.map(|h| {
                    format!(
                        "{} x r {} at R {}",
                        h.count,
                        milli(h.radius, 1),
                        milli(h.circle_radius, 1)
                    )
                })),
                or_dash(holes.map(|_| format!("{:.1} %", gear.removed_fraction() * 100.0))),
                or_dash(gear.least_ligament().map(|_| ligament(gear))),
                format!("{:.4}", gear.mass()),
            ]);
        }
    }
    table(
        &[
            "case",
            "gear",
            "Z",
            "R_b mm (paper)",
            "tip mm",
            "root mm",
            "form mm",
            "bore mm",
            "holes mm",
            "removed",
            "least ligament mm",
            "mass kg",
        ],
        &rows,
    )
}

/// Values of the pairs of Table 1.
pub(super) fn table_1_pairs(computed: &Computed) -> String {
    let rows: Vec<Cells> = computed
        .test_cases
        .iter()
        .zip(paper::CENTER_DISTANCES)
        .map(|(test_case, printed)| {
            let pair = &test_case.case.pair;
            let overlap =
                pair.driving().tip_radius() + pair.driven().tip_radius() - pair.center_distance();
            vec![
                test_case.number.to_string(),
                format!("{} ({printed})", milli(pair.center_distance(), 1)),
                format!("{:.3}", pair.working_pressure_angle().to_degrees()),
                format!("{:.4}", pair.contact_ratio()),
                milli(overlap / 2.0, 3),
                milli(pair.backlash(), 3),
                pair.period().to_string(),
                pair.driven().tooth_count().to_string(),
            ]
        })
        .collect();
    table(
        &[
            "case",
            "a mm (paper)",
            "working pressure angle deg",
            "contact ratio",
            "(r_a1 + r_a2 - a)/2 mm",
            "normal backlash mm",
            "true period in mesh periods",
            "the paper computes",
        ],
        &rows,
    )
}

/// The least ligament in mm, and where it is.
fn ligament(gear: &SpurGear) -> String {
    let Some(holes) = gear.hole_pattern() else {
        return "-".into();
    };
    let places = [
        (holes.ligament_between(), "between holes"),
        (gear.root_radius() - holes.outer_reach(), "below the roots"),
        (holes.inner_reach() - gear.bore_radius(), "at the bore"),
    ];
    let least = places.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    least.map_or_else(String::new, |(value, place)| {
        format!("{} {place}", milli(value, 2))
    })
}

/// The heads of the columns of Table 3.
pub(super) const TABLE_3_HEADER: [&str; 10] = [
    "design",
    "paper",
    "hole radius mm",
    "removed",
    "mass kg",
    "between holes mm",
    "below the roots mm",
    "at the bore mm",
    "least ligament mm",
    "STE p-p µm at 20 / 115 N m",
];

/// The row of Table 3 for one design.
pub(super) fn table_3_row(design: &Design) -> Cells {
    let gear = design.case.pair.driven();
    let of_holes = |value: fn(&SpurGear) -> Option<f64>, decimals| {
        value(gear).map_or_else(|| "-".into(), |value| milli(value, decimals))
    };
    let peak_to_peak = |i: usize| {
        design.flexible[i]
            .transmission_error_statistics
            .peak_to_peak
            * 1e6
    };
    vec![
        design.name.clone(),
        if design.kept {
            "kept".into()
        } else {
            "dropped".into()
        },
        of_holes(|gear| Some(gear.hole_pattern()?.radius), 3),
        format!("{:.2} %", gear.removed_fraction() * 100.0),
        format!("{:.4}", gear.mass()),
        of_holes(|gear| Some(gear.hole_pattern()?.ligament_between()), 2),
        of_holes(
            |gear| Some(gear.root_radius() - gear.hole_pattern()?.outer_reach()),
            2,
        ),
        of_holes(
            |gear| Some(gear.hole_pattern()?.inner_reach() - gear.bore_radius()),
            2,
        ),
        ligament(gear),
        format!("{:.2} / {:.2}", peak_to_peak(0), peak_to_peak(1)),
    ]
}

/// Table 3: all nine combinations.
pub(super) fn table_3(computed: &Computed) -> anyhow::Result<String> {
    let mut rows = Vec::new();
    for circle in HOLE_CIRCLES {
        for count in HOLE_COUNTS {
            rows.push(table_3_row(computed.design(&design_name(count, circle))?));
        }
    }
    Ok(table(&TABLE_3_HEADER, &rows))
}

/// The heads of the columns of section 5.
pub(super) const SECTION_5_HEADER: [&str; 11] = [
    "design",
    "T N m",
    "STE mean µm",
    "rms µm",
    "p-p µm",
    "H_N µm",
    "H_Z2 µm",
    "k mean N/m",
    "k rms N/m",
    "k p-p N/m",
    "decomposition: rms, p-p, H_N µm",
];

/// The rows of section 5 for one design: one a torque.
pub(super) fn section_5_rows(design: &Design) -> anyhow::Result<Vec<Cells>> {
    let amplitude = |curve: &Curve, label| {
        if design.case.pair.driven().holes().is_empty() && label == "H_N" {
            return Ok("-".to_owned());
        }
        Ok::<_, anyhow::Error>(micro(line(curve, label)?.0))
    };
    design
        .flexible
        .iter()
        .zip(&design.decomposition)
        .map(|(flexible, decomposition)| {
            let values = statistics(flexible);
            let fitted = statistics(decomposition);
            let mut cells = vec![design.name.clone(), format!("{}", flexible.output_torque)];
            cells.extend((0..3).map(|i| number(i, values[i])));
            cells.push(amplitude(flexible, "H_N")?);
            cells.push(amplitude(flexible, "H_Z2")?);
            cells.extend((3..6).map(|i| number(i, values[i])));
            cells.push(format!(
                "{}, {}, {}",
                number(1, fitted[1]),
                number(2, fitted[2]),
                amplitude(decomposition, "H_N")?
            ));
            Ok(cells)
        })
        .collect()
}

/// The study of section 5: the standard pair and the five designs that the paper kept.
pub(super) fn section_5(computed: &Computed) -> anyhow::Result<String> {
    let mut rows = Vec::new();
    for design in computed.designs.iter().filter(|design| design.kept) {
        rows.extend(section_5_rows(design)?);
    }
    Ok(table(&SECTION_5_HEADER, &rows))
}

/// The torques of least peak-to-peak.
pub(super) fn sweeps(computed: &Computed) -> String {
    let [fifty, reducer] = OPTIMAL_TORQUES;
    let rows: Vec<Cells> = computed
        .sweeps
        .iter()
        .zip([fifty, reducer, fifty])
        .map(|(sweep, printed)| {
            vec![
                sweep.name.to_owned(),
                format!("{:.0}", sweep.best_torque),
                format!("{:.2}", sweep.best * 1e6),
                format!("{printed:.0}"),
                format!("{:.2}", peak_to_peak_at(sweep, printed) * 1e6),
            ]
        })
        .collect();
    table(
        &[
            "pair",
            "T of least p-p N m",
            "p-p there µm",
            "the paper's T N m",
            "p-p there µm",
        ],
        &rows,
    )
}

/// Effect of the interface radius on the decomposition of test case 2, against the flexible method.
pub(super) fn interfaces(computed: &Computed) -> anyhow::Result<String> {
    let flexible = computed.test_cases[1].flexible();
    let reference = statistics(flexible);
    let mut rows = Vec::new();
    for (radius, curve) in &computed.interfaces {
        let values = statistics(curve);
        let mut cells = vec![milli(*radius, 1)];
        cells.extend((0..values.len()).map(|i| percent(values[i], reference[i])));
        for label in ["H_N", "H_Z2"] {
            cells.push(percent(line(curve, label)?.0, line(flexible, label)?.0));
        }
        rows.push(cells);
    }
    let printed = paper::TABLE_2[1]
        .decomposition
        .iter()
        .zip(paper::TABLE_2[1].flexible);
    let mut of_paper = vec!["paper".to_owned()];
    of_paper.extend(printed.map(|(value, reference)| percent(*value, reference)));
    of_paper.extend(["-".to_owned(), "-".to_owned()]);
    rows.push(of_paper);
    Ok(table(
        &[
            "R_w mm", "STE mean", "rms", "p-p", "k mean", "k rms", "k p-p", "H_N", "H_Z2",
        ],
        &rows,
    ))
}

/// Why the dropped designs may have been dropped: each has a ligament thinner than any that was kept in that place.
pub(super) fn dropped(computed: &Computed) -> String {
    const PLACES: [&str; 3] = ["between the holes", "below the roots", "at the bore"];
    let ligaments = |design: &Design| {
        let gear = design.case.pair.driven();
        gear.hole_pattern().map(|holes| {
            [
                holes.ligament_between(),
                gear.root_radius() - holes.outer_reach(),
                holes.inner_reach() - gear.bore_radius(),
            ]
        })
    };
    let kept: Vec<[f64; 3]> = computed.holed_kept().filter_map(ligaments).collect();
    let least = [0, 1, 2].map(|i| {
        kept.iter()
            .map(|place| place[i])
            .fold(f64::INFINITY, f64::min)
    });
    let reasons = computed
        .designs
        .iter()
        .filter(|design| !design.kept)
        .map(|design| {
            let thin: Vec<String> = ligaments(design)
                .into_iter()
                .flatten()
                .zip(least)
                .zip(PLACES)
                .filter(|((value, least), _)| value < least)
                .map(|((value, least), place)| {
                    format!(
                        "{} mm {place} (kept: {} mm or more)",
                        milli(value, 2),
                        milli(least, 2)
                    )
                })
                .collect();
            let thin = if thin.is_empty() {
                "no ligament thinner than the kept ones".into()
            } else {
                thin.join(", ")
            };
            format!("- {}: {thin}.\n", design.name)
        });
    reasons.collect()
}

/// The peak-to-peak at `torque`, linear between the torques of the sweep.
pub(super) fn peak_to_peak_at(sweep: &Sweep, torque: f64) -> f64 {
    let point = |curve: &Curve| {
        (
            curve.output_torque,
            curve.transmission_error_statistics.peak_to_peak,
        )
    };
    sweep
        .curves
        .windows(2)
        .map(|two| (point(&two[0]), point(&two[1])))
        .find(|&((low, _), (high, _))| (low..=high).contains(&torque))
        .map_or(f64::NAN, |((t_0, y_0), (t_1, y_1))| {
            y_0 + (y_1 - y_0) * (torque - t_0) / (t_1 - t_0)
        })
}

/// The times beside the paper's, to one digit.
pub(super) fn times(computed: &Computed) -> String {
    let rows: Vec<Cells> = computed
        .test_cases
        .iter()
        .zip(&paper::TABLE_2)
        .map(|(test_case, printed)| {
            let answers = &test_case.answers;
            vec![
                test_case.number.to_string(),
                format!("{} h", printed.flexible_hours),
                seconds(answers[0].seconds),
                format!("{} min", printed.decomposition_minutes),
                seconds(answers[1].seconds),
                seconds(answers[2].seconds),
                seconds(answers[1].seconds_with_teeth),
                seconds(answers[2].seconds_with_teeth),
            ]
        })
        .collect();
    table(
        &[
            "case",
            "paper, flexible",
            "flexible",
            "paper, decomposition",
            "decomposition",
            "projected",
            "decomposition, teeth known",
            "projected, teeth known",
        ],
        &rows,
    )
}

/// `value` in seconds to one significant digit.
fn seconds(value: f64) -> String {
    let power = 10_f64.powf(value.max(1e-3).log10().floor());
    let decimals = (-power.log10()).max(0.0).round() as usize;
    format!("{:.decimals$} s", (value / power).round() * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_one_digit() {
        let texts = [0.034, 0.28, 0.96, 1.4, 12.0].map(seconds);
        assert_eq!(texts, ["0.03 s", "0.3 s", "1.0 s", "1 s", "10 s"]);
    }

    #[test]
    fn differences_are_told_in_percent_with_their_sign() {
        assert_eq!(percent(0.88, 1.0), "-12.0 %");
        assert_eq!(percent(1.0001, 1.0), "0.0 %");
    }
}
