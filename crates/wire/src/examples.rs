//! Submissions to start from: the paper's test cases, the designs of its study, and one for each thing that real drawings say.

/// A submission that ships with the service.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Example {
    /// Its name, which is also its file's under `api/examples`.
    pub name: &'static str,
    /// Description.
    pub description: &'static str,
    /// False for the one that cannot be computed.
    pub valid: bool,
    /// The document.
    pub json: &'static str,
}

macro_rules! examples {
    ($($name:literal $valid:literal $description:literal)*) => {
        &[$(Example {
            name: $name,
            description: $description,
            valid: $valid,
            json: include_str!(concat!("../../../api/examples/", $name, ".json")),
        },)*]
    };
}

const EXAMPLES: &[Example] = examples! {
    "test-case-1" true "Test case 1 of the paper: 50/50 teeth, eight holes in both gears, 115 N m. The true period is 25 mesh periods."
    "test-case-2" true "Test case 2 of the paper: 50/50 teeth, ten holes in the driven gear, 115 N m. The true period is 5 mesh periods."
    "test-case-3" true "Test case 3 of the paper: 29/85 teeth, six holes in the driven gear, 160 N m, at 114.5 mm. The true period is 85 mesh periods."
    "standard-pair" true "The standard pair of the paper's study: 50/50 teeth, no holes, 115 and 20 N m."
    "design-8r34" true "Design 8R34 of the study: eight holes at 34 mm, a quarter of the blank removed."
    "design-10r34" true "Design 10R34 of the study: ten holes at 34 mm, a quarter of the blank removed."
    "design-6r30" true "Design 6R30 of the study: six holes at 30 mm, a quarter of the blank removed."
    "design-8r30" true "Design 8R30 of the study: eight holes at 30 mm, a quarter of the blank removed."
    "design-8r27" true "Design 8R27 of the study: eight holes at 27 mm, a quarter of the blank removed."
    "tip-diameter" true "Tip circles given by their diameters, and teeth made thinner for their backlash, at the reference center distance."
    "tip-edges" true "Rounded tip edges on the driving gear, chamfered ones on the driven gear."
    "profile-modifications" true "Root relief, crowning and slope beside the tip relief of the driving gear; a measured table on the driven gear."
    "pitch-deviations" true "Measured teeth: single pitch deviations of the driving gear, cumulative ones and profile slopes of the driven gear. The true period is a revolution."
    "eccentricity" true "A driven gear that turns 20 um beside its own axis, at a speed that gives frequencies."
    "light-load" true "The limit of light load, the torque 0, beside two loaded curves."
    "interface-radii" true "The decomposition of two holed gears that are cut at radii of their own."
    "web" true "A driven gear with a web thinner than its rim, and six holes in it."
    "unequal-holes" true "Six holes of two sizes at unequal angles: their order spreads over those of a revolution."
    "unequal-spacing" true "Eight equal holes at unequal angles: what an even ring puts into H_8 spreads over the orders beside it."
    "slots" true "Five kidneys along a circle."
    "spokes" true "A driven gear on five straight spokes of constant width."
    "stress" true "Design 8R34 with the largest stresses at its roots and at the edges of its holes."
    "helical-pair" true "A helical pair in three dimensions: a crowned pinion on a shaft askew, and a wheel whose web stands at one side. The load along the face and its factor K_Hbeta."
    "run-up" true "Test case 2 run up and down to 20,000 1/min: the force table, the motion of the gears over speed, and its resonances."
    "bad-case-3-as-printed" false "Test case 3 with the center distance that the paper prints, 118.5 mm: its teeth do not reach each other, and it is refused."
};

/// The study of the paper's section 5: the standard pair and five patterns of holes that remove a quarter of the blank.
pub const STUDY_SECTION_5: &str = include_str!("../../../api/examples/study-section-5.json");

/// Every example.
pub fn examples() -> &'static [Example] {
    EXAMPLES
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{filled_in, submission};
    use crate::{Code, Submission};

    #[test]
    fn every_example_is_what_it_says() {
        for example in examples() {
            let read = Submission::parse(example.json.as_bytes());
            assert_eq!(read.is_ok(), example.valid, "{}: {read:?}", example.name);
        }
    }

    #[test]
    fn the_examples_of_real_drawings_say_what_their_names_say() {
        let (driving, driven) = ("/pair/driving", "/pair/driven");
        #[rustfmt::skip]
        let cases = [
            ("tip-diameter", driving, "/tip_diameter_mm"),
            ("tip-diameter", driven, "/tooth_thickness_deviation_um"),
            ("tip-edges", driving, "/tip_rounding_mm"),
            ("tip-edges", driven, "/tip_chamfer_mm"),
            ("profile-modifications", driving, "/profile_modifications/2/amount_um"),
            ("profile-modifications", driven, "/profile_modifications/0/removed_um/5"),
            ("pitch-deviations", driving, "/tooth_deviations/pitch_single_um/49"),
            ("pitch-deviations", driven, "/tooth_deviations/pitch_cumulative_um/49"),
            ("pitch-deviations", driven, "/tooth_deviations/profile_slope_um/49"),
            ("eccentricity", driven, "/tooth_deviations/eccentricity/amount_um"),
            ("light-load", "", "/output_torques_n_m/2"),
            ("web", driven, "/blank/web/thickness_mm"),
            ("unequal-holes", driven, "/blank/holes/1/at_deg/1"),
            ("unequal-spacing", driven, "/blank/holes/at_deg/1"),
            ("slots", driven, "/blank/holes/slot/width_mm"),
            ("spokes", driven, "/blank/spokes/fillet_radius_mm"),
            ("interface-radii", "", "/resolution/interface_radius_mm/driving"),
            ("run-up", "", "/dynamics/driving_speed_rpm/to"),
        ];
        for (name, within, place) in cases {
            let place = &format!("{within}{place}");
            let echo = filled_in(name);
            let said = echo.pointer(place).and_then(serde_json::Value::as_f64);
            assert!(
                said.is_some_and(|said| said != 0.0),
                "{name}: {place} is {said:?}"
            );
        }
    }

    #[test]
    fn the_true_periods_are_those_of_the_paper_s_cases() {
        // DESIGN section 1: 25, 5 and 85; at 40 positions.
        for (name, positions) in [
            ("test-case-1", 1000),
            ("test-case-2", 200),
            ("test-case-3", 3400),
        ] {
            assert_eq!(submission(name).positions_total(), positions);
        }
    }

    #[test]
    fn the_designs_of_the_study_remove_a_quarter_of_the_blank() {
        // DESIGN section 4: 25 % of the area between bore and mean of tip and root circle; radii given to a micrometer.
        for example in examples()
            .iter()
            .filter(|example| example.name.starts_with("design-"))
        {
            let submission = Submission::parse(example.json.as_bytes()).expect("valid");
            let driven = submission.case().pair.driven();
            assert!(
                (driven.removed_fraction() - 0.25).abs() < 5e-5,
                "{}",
                example.name
            );
            assert_eq!(submission.case().output_torques, [115.0, 20.0]);
        }
    }

    #[test]
    fn case_3_as_printed_is_refused_with_the_nearest_distance_that_works() {
        let bad = examples()
            .iter()
            .find(|example| !example.valid)
            .expect("ships");
        let problem = Submission::parse(bad.json.as_bytes()).expect_err("the teeth do not reach");
        assert_eq!((problem.code, problem.status), (Code::TeethDoNotReach, 422));
        let [error] = problem.errors.as_slice() else {
            panic!("one error: {problem:?}")
        };
        assert_eq!(error.pointer, "/pair/center_distance_mm");
        assert_eq!(
            error.nearest,
            Some(115.56),
            "API.md prints 115.56; the contact ratio is one at 115.567"
        );
        assert!(error.detail.contains("118 mm"), "{}", error.detail);
        let cured = bad.json.replace("118.5", "115.56");
        assert!(Submission::parse(cured.as_bytes()).is_ok());
    }

    #[test]
    fn the_example_of_stresses_asks_for_them() {
        assert!(submission("stress").case().stress);
    }
}
