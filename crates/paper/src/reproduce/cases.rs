//! Computed cases: the paper's test cases and designs, from the examples that ship with the service.

use anyhow::Context;
use meshwright_engine::analysis::{Case, Model, SectionHoles};
use meshwright_engine::gear::{GearPair, HolePattern, SpurGear};
use meshwright_wire::{Submission, examples};

/// The share of the blank that the designs of section 5 give up.
const REMOVED: f64 = 0.25;

/// The numbers of holes and the radii of their circles, in mm, of Table 3.
pub(super) const HOLE_COUNTS: [u32; 3] = [6, 8, 10];
pub(super) const HOLE_CIRCLES: [u32; 3] = [27, 30, 34];

/// The cells of Table 3 that the paper ticks, in the order of its Figs. 10 and 11.
pub(super) const KEPT: [(u32, u32); 5] = [(8, 34), (10, 34), (6, 30), (8, 30), (8, 27)];

/// The case of the example called `name`, over the true period of whatever pair it is given.
///
/// # Errors
///
/// If no such example ships, or if it cannot be computed.
pub(crate) fn example(name: &str) -> anyhow::Result<Case> {
    let example = examples()
        .iter()
        .find(|example| example.name == name)
        .with_context(|| format!("no example is called {name}"))?;
    let submission = Submission::parse(example.json.as_bytes())
        .map_err(|problem| anyhow::anyhow!("the example {name}: {}", problem.detail))?;
    let mut case = submission.case().clone();
    // The submission has the period of its own pair filled in.
    case.resolution.span_mesh_periods = None;
    Ok(case)
}

/// `case` in its section, by the method that makes this of its holes.
pub(crate) fn by(case: &Case, holes: SectionHoles) -> Case {
    Case {
        model: Model::Section(holes),
        ..case.clone()
    }
}

/// `case` at other output torques, in N m.
pub(crate) fn at_torques(case: &Case, output_torques: Vec<f64>) -> Case {
    Case {
        output_torques,
        ..case.clone()
    }
}

/// `case` with `holes` in its driven gear and none in its driving gear.
///
/// # Errors
///
/// If the holes do not fit.
pub(crate) fn with_holes(case: &Case, holes: Option<HolePattern>) -> anyhow::Result<Case> {
    let with = |gear: &SpurGear, holes: Option<HolePattern>| {
        let mut data = gear.data().clone();
        data.blank.holes = holes.map_or_else(Vec::new, |pattern| pattern.holes());
        SpurGear::new(data)
    };
    let pair = &case.pair;
    let (driving, driven) = (with(pair.driving(), None)?, with(pair.driven(), holes)?);
    Ok(Case {
        pair: GearPair::new(driving, driven, pair.center_distance())?,
        ..case.clone()
    })
}

/// The radius in meters of `count` holes that remove a quarter of the blank of `gear`, to a micrometer as on a drawing.
pub(super) fn hole_radius(gear: &SpurGear, count: u32) -> f64 {
    let area = REMOVED * gear.nominal_blank_area() / f64::from(count);
    ((area / std::f64::consts::PI).sqrt() * 1e6).round() / 1e6
}

/// The design of `count` holes on a circle of `circle` mm, with both torques of section 5.
///
/// # Errors
///
/// If the holes do not fit.
pub(super) fn design(count: u32, circle: u32) -> anyhow::Result<Case> {
    let standard = example("standard-pair")?;
    let holes = HolePattern {
        count,
        circle_radius: f64::from(circle) / 1e3,
        radius: hole_radius(standard.pair.driven(), count),
        phase: 0.0,
    };
    with_holes(&standard, Some(holes))
}

/// The name of a design in the paper, such as 8R34.
pub(super) fn design_name(count: u32, circle: u32) -> String {
    format!("{count}R{circle}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_designs_that_the_paper_kept_are_the_examples_that_ship() {
        for (count, circle) in KEPT {
            let name = format!("design-{}", design_name(count, circle).to_lowercase());
            assert_eq!(
                design(count, circle).expect("fits"),
                example(&name).expect("ships")
            );
        }
    }

    #[test]
    fn a_quarter_of_the_blank_goes_whatever_the_number_of_holes() {
        for count in HOLE_COUNTS {
            let case = design(count, 30).expect("fits");
            assert!((case.pair.driven().removed_fraction() - 0.25).abs() < 1e-4);
        }
    }
}
