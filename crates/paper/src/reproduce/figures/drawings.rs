//! Figs. 2, 5 and 9: the gears as they are cut.

use anyhow::Context;
use meshwright_engine::gear::{SpurGear, Vector};
use meshwright_plot::{Color, WHITE};

use super::super::cases::{HOLE_CIRCLES, HOLE_COUNTS, design_name};
use super::super::computed::Computed;
use super::Illustration;
use meshwright_plot::drawing::{Placement, gear, openings, outline, placements, window};
use meshwright_plot::{Drawing, Figure, Look, Panel, Shape};

const ELASTIC: Color = Color(190, 208, 226);
const RIGID: Color = Color(150, 150, 150);
const DROPPED: Color = Color(236, 226, 214);
const CIRCLE: Color = Color(213, 94, 0);

const PARTS: [(&str, Color, Look); 3] = [
    ("elastic", ELASTIC, Look::Patch),
    ("rigid", RIGID, Look::Patch),
    ("interface circle R_w", CIRCLE, Look::Line),
];
const CHOICE: [(&str, Color, Look); 3] = [
    ("kept by the paper", ELASTIC, Look::Patch),
    ("dropped", DROPPED, Look::Patch),
    ("hole circle R", CIRCLE, Look::Line),
];

fn legend(entries: &[(&str, Color, Look)]) -> Vec<(String, Color, Look)> {
    entries
        .iter()
        .map(|&(name, color, look)| (name.to_owned(), color, look))
        .collect()
}

/// Fig. 2: test case 2 as a whole, as "wh" and as "gb".
pub(super) fn substructures(computed: &Computed) -> anyhow::Result<Illustration> {
    let test_case = computed
        .test_cases
        .get(1)
        .context("there are three test cases")?;
    let pair = &test_case.case.pair;
    let parts = test_case.decomposition().decomposition.as_ref();
    let fit = parts
        .and_then(|parts| parts.blanks.first())
        .context("a decomposition tells its parts")?;
    let r_w = fit.interface_radius;
    let [place_1, place_2] = placements(pair);
    let (gear_1, gear_2) = (pair.driving(), pair.driven());

    let mut whole = gear(gear_1, place_1, ELASTIC);
    whole.extend(gear(gear_2, place_2, ELASTIC));
    whole.push(Shape::Circle(place_2.center, r_w, CIRCLE));

    let mut rigid_blank = gear(gear_1, place_1, ELASTIC);
    rigid_blank.push(Shape::Region(outline(gear_2, place_2), ELASTIC));
    rigid_blank.push(Shape::Disk(place_2.center, r_w, RIGID));
    rigid_blank.push(Shape::Disk(place_2.center, gear_2.bore_radius(), WHITE));

    let mut holed_blank = vec![Shape::Disk(place_2.center, r_w, ELASTIC)];
    holed_blank.extend(openings(gear_2, place_2));

    // In the scale of the other panels.
    let (low, high) = window(pair);
    let shift = place_2.center - (low + high) / 2.0;
    let about_2 = (low + shift, high + shift);
    let panels = [
        ("whole pair", whole, window(pair)),
        ("rigid blank (paper: wh)", rigid_blank, window(pair)),
        ("holed blank (paper: gb)", holed_blank, about_2),
    ];
    let figure = Figure {
        title: "Fig. 2: test case 2 and its two substructures".into(),
        columns: 3,
        panel_size: (340, 210),
        panels: panels
            .into_iter()
            .map(|(title, shapes, window)| {
                Panel::Drawing(Drawing {
                    title: title.into(),
                    window,
                    shapes,
                    legend: legend(&PARTS),
                })
            })
            .collect(),
    };
    let caption = format!(
        "Test case 2 from its true geometry. The interface is the circle R_w = {:.1} mm, one module below the roots; the \
         paper gives no radius. In the rigid-blank part everything inside R_w turns as one body, in the holed-blank part \
         the ring from the bore to R_w is elastic.",
        r_w * 1e3
    );
    Illustration::new("fig-02-substructures.svg", caption, &figure)
}

/// Fig. 5: the three test cases in mesh.
pub(super) fn pairs(computed: &Computed) -> anyhow::Result<Illustration> {
    let panels = computed
        .test_cases
        .iter()
        .map(|test_case| {
            let pair = &test_case.case.pair;
            let [place_1, place_2] = placements(pair);
            let mut shapes = gear(pair.driving(), place_1, ELASTIC);
            shapes.extend(gear(pair.driven(), place_2, ELASTIC));
            Panel::Drawing(Drawing {
                title: format!(
                    "test case {}: {}/{} teeth, a = {:.1} mm",
                    test_case.number,
                    pair.driving().tooth_count(),
                    pair.driven().tooth_count(),
                    pair.center_distance() * 1e3
                ),
                window: window(pair),
                shapes,
                legend: Vec::new(),
            })
        })
        .collect();
    let figure = Figure {
        title: "Fig. 5: the test cases at mesh position 0".into(),
        columns: 3,
        panel_size: (340, 230),
        panels,
    };
    let caption = "Involutes, trochoid fillets, bores and holes as computed, gear 1 on the left, tooth 0 of both in contact at \
                   the pitch point. Bores and hole circles are ours (the paper gives neither); test case 3 is at 114.5 mm, \
                   because at the printed 118.5 mm its teeth do not reach each other. Each panel has its own scale."
        .to_owned();
    Illustration::new("fig-05-test-cases.svg", caption, &figure)
}

/// Fig. 9: the nine designs of Table 3.
pub(super) fn designs(computed: &Computed) -> anyhow::Result<Illustration> {
    let mut panels = Vec::new();
    for circle in HOLE_CIRCLES {
        for count in HOLE_COUNTS {
            let design = computed.design(&design_name(count, circle))?;
            let driven = design.case.pair.driven();
            panels.push(Panel::Drawing(panel(&design.name, driven, design.kept)));
        }
    }
    let figure = Figure {
        title: "Fig. 9: the nine designs of Table 3, each a quarter of the blank lighter".into(),
        columns: 3,
        panel_size: (290, 270),
        panels,
    };
    let caption = "Columns: 6, 8 and 10 holes; rows: R = 27, 30 and 34 mm (from the center to the middle of a hole); hole \
                   radius r and least ligament of each above it. Blue: the five that the paper keeps."
        .to_owned();
    Illustration::new("fig-09-designs.svg", caption, &figure)
}

fn panel(name: &str, driven: &SpurGear, kept: bool) -> Drawing {
    let place = Placement {
        center: Vector::zeros(),
        angle: 0.0,
    };
    let mut shapes = gear(driven, place, if kept { ELASTIC } else { DROPPED });
    let radius = driven
        .hole_pattern()
        .map_or(0.0, |holes| holes.circle_radius);
    shapes.push(Shape::Circle(Vector::zeros(), radius, CIRCLE));
    let reach = Vector::new(1.0, 1.0) * 1.03 * driven.tip_radius();
    Drawing {
        title: format!(
            "{name}: r {:.3} mm, ligament {:.1} mm",
            driven.hole_pattern().map_or(0.0, |holes| holes.radius) * 1e3,
            driven.least_ligament().unwrap_or_default() * 1e3
        ),
        window: (-reach, reach),
        shapes,
        legend: legend(&CHOICE),
    }
}

#[cfg(test)]
mod tests {
    use meshwright_engine::gear::Vector;
    use meshwright_plot::drawing::{Placement, outline};
    use meshwright_wire::{Submission, examples};

    #[test]
    fn the_outline_encloses_the_mass_of_the_solid_gear() {
        let example = examples()
            .iter()
            .find(|example| example.name == "standard-pair")
            .expect("ships");
        let submission = Submission::parse(example.json.as_bytes()).expect("valid");
        let gear = submission.case().pair.driven();
        let place = Placement {
            center: Vector::new(0.1, -0.2),
            angle: 0.3,
        };
        let outline = outline(gear, place);
        let next = outline.iter().cycle().skip(1);
        let area: f64 = outline
            .iter()
            .zip(next)
            .map(|(p, q)| (p.x * q.y - p.y * q.x) / 2.0)
            .sum();
        let bore = std::f64::consts::PI * gear.bore_radius().powi(2);
        let mass = gear.material().density * gear.face_width() * (area - bore);
        // Chords for arcs: 19 points a tooth.
        assert!(
            (mass / gear.mass() - 1.0).abs() < 1e-3,
            "{mass} kg, {} kg",
            gear.mass()
        );
    }
}
