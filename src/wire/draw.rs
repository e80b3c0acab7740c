//! Teeth drawn at random within the tolerances of an accuracy class.

use meshwright_engine::gear::{Helix, Normals, SpurGear, Tolerances, total_pitch_deviation};
use serde::Serialize;
use utoipa::ToSchema;

use super::declare::{
    EACH, Errors, Kind as _, Node, Number, Place, answer, document, flag, nested, number,
};
use super::gear::{DeviationsDocument, GearDocument};
use super::problem::Problem;
use super::size::{MOST_VALUES, refuse_many_values};
use super::units::{significant, to_um};

document! {
    /// Teeth to draw at random for a gear. Deviations that the gear has are not looked at.
    pub struct DrawDocument as "DrawDeviations", "Draw deviations" {
        /// The gear.
        gear: GearDocument = nested(""),
        /// The accuracy class A of ISO 1328-1:2013, from the finest; each is wider by the square root of 2.
        iso_1328_class: u32 = CLASS,
        /// How many times three standard deviations of a deviation fit into its tolerance.
        capability: f64 = CAPABILITY,
        /// What the numbers are drawn from: the same seed gives the same teeth on every machine.
        seed: u32 = SEED,
        /// The helix angle at the reference circle, whichever the hand, of which tolerances depend by the reference diameter.
        helix_angle_deg: f64 = number("Helix angle", "deg", -45.0, 45.0).or(0.0),
        /// Whether the slopes of the leads are drawn too, which only methods in three dimensions take. The other deviations are the same with
        /// them and without them.
        lead_slopes: bool = flag("Lead slopes", false),
    }
}

/// A class of ISO 1328-1:2013.
pub(super) const CLASS: Number = number("Accuracy class", "1", 1.0, 11.0);

/// How well a process keeps its tolerances.
pub(super) const CAPABILITY: Number = number("Process capability", "1", 0.1, 10.0).or(1.0);

/// What random numbers are drawn from.
pub(super) const SEED: Number = number("Seed", "1", 0.0, 4_294_967_295.0).or(1.0);

/// What is asked: teeth for a gear, of an accuracy, from a seed.
pub struct Draw {
    gear: SpurGear,
    class: u32,
    capability: f64,
    seed: u64,
    lead_slopes: bool,
}

impl DrawDocument {
    /// What is asked, if its gear can be made; what prevents it is reported to `errors`.
    fn made(self, errors: &Errors) -> Option<Draw> {
        let made = self
            .gear
            .without_deviations()
            .to_gear("/gear", Helix::right(self.helix_angle_deg.to_radians()));
        Some(Draw {
            gear: errors.report(made)?,
            class: self.iso_1328_class,
            capability: self.capability,
            seed: u64::from(self.seed),
            lead_slopes: self.lead_slopes,
        })
    }
}

answer! {
    /// The tolerances of ISO 1328-1:2013 for a gear and a class, unrounded, in um.
    pub struct TolerancesDocument as Tolerances, "Tolerances" of (tolerances: &Tolerances) {
        /// f_pT: of a single pitch.
        single_pitch: f64 = told(tolerances.single_pitch),
        /// F_pT: of the cumulative pitch around the gear.
        total_pitch: f64 = told(tolerances.total_pitch),
        /// f_HaT: of the slope of a profile.
        profile_slope: f64 = told(tolerances.profile_slope),
        /// f_faT: of the form of a profile.
        profile_form: f64 = told(tolerances.profile_form),
        /// F_rT: of the runout.
        runout: f64 = told(tolerances.runout),
        /// f_HbT: of the slope of a helix.
        helix_slope: f64 = told(tolerances.helix_slope),
    }
}

/// Teeth drawn at random.
#[derive(Debug, Serialize, ToSchema)]
#[schema(title = "Drawn deviations")]
pub struct DrawnDeviations {
    /// What the teeth deviate by, ready for a gear of a submission.
    tooth_deviations: DeviationsDocument,
    /// F_p: the total cumulative pitch deviation of these teeth, in um. It may be more than `total_pitch`, which is not enforced.
    total_pitch_deviation_um: f64,
    /// What the class allows, in um.
    tolerances_um: TolerancesDocument,
}

fn told(value: f64) -> f64 {
    significant(to_um(value), 10)
}

impl Draw {
    /// Reads and checks what is asked.
    ///
    /// # Errors
    ///
    /// As for a submission.
    pub fn parse(document: &[u8]) -> Result<Self, Problem> {
        refuse_many_values(document, MOST_VALUES)?;
        let node = Node::parse(document)?;
        let errors = Errors::default();
        let asked = DrawDocument::read(&node, &Place::root(&errors), &EACH);
        let draw = asked.and_then(|asked| asked.made(&errors));
        errors.settle(draw)
    }

    /// The teeth.
    pub fn drawn(&self) -> DrawnDeviations {
        let tolerances = Tolerances::of(&self.gear, self.class);
        let normals = Normals::new(self.seed, 0);
        let (count, capability) = (self.gear.tooth_count(), self.capability);
        let mut teeth = tolerances.draw(count, capability, normals);
        if self.lead_slopes {
            let normals = Normals::new(self.seed, 1);
            teeth.lead_slope = tolerances.draw_lead_slopes(count, capability, normals);
        }
        DrawnDeviations {
            total_pitch_deviation_um: told(total_pitch_deviation(&teeth)),
            tooth_deviations: DeviationsDocument::of(&teeth),
            tolerances_um: TolerancesDocument::of(&tolerances),
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::wire::Code;
    use crate::wire::testing::{and, example, parse};

    fn standard_pair() -> Value {
        example("standard-pair")
    }

    fn drawn(document: &Value) -> Result<Value, Problem> {
        let draw = Draw::parse(document.to_string().as_bytes())?;
        Ok(serde_json::to_value(draw.drawn()).expect("JSON"))
    }

    #[test]
    fn what_is_drawn_is_taken_by_a_submission_as_it_stands() {
        let mut submission = standard_pair();
        let gear = submission["pair"]["driven"].clone();
        let asked = |seed: u64| json!({ "gear": gear, "iso_1328_class": 6, "seed": seed });
        let answer = drawn(&asked(3)).expect("drawn");
        assert_eq!(answer, drawn(&asked(3)).expect("drawn"));
        assert_ne!(answer, drawn(&asked(4)).expect("drawn"));
        assert!(
            (answer["tolerances_um"]["single_pitch"]
                .as_f64()
                .expect("a number")
                - 5.9 * 2_f64.sqrt())
            .abs()
                < 1e-8
        );
        submission["pair"]["driven"]["tooth_deviations"] = answer["tooth_deviations"].clone();
        let parsed = parse(&submission).expect("it closes");
        assert_eq!(parsed.case().pair.period(), 50);
        let teeth = parsed.case().pair.driven().deviations();
        let total = answer["total_pitch_deviation_um"]
            .as_f64()
            .expect("a number");
        assert!((1e6 * total_pitch_deviation(teeth) - total).abs() < 2e-4);
        // What the gear has already is not looked at.
        let again = json!({ "gear": submission["pair"]["driven"], "iso_1328_class": 6, "seed": 3 });
        assert_eq!(answer, drawn(&again).expect("drawn"));
    }

    #[test]
    fn lead_slopes_come_where_they_are_asked_for_and_change_no_other_number() {
        let gear = standard_pair()["pair"]["driven"].clone();
        let asked = |more: Value| {
            let asked = json!({ "gear": gear, "iso_1328_class": 6, "seed": 3 });
            drawn(&and(asked, &more)).expect("drawn")
        };
        let without = asked(json!({}));
        assert!(without["tooth_deviations"]["lead_slope_um"].is_null());
        let mut with = asked(json!({ "lead_slopes": true }));
        let slopes = with["tooth_deviations"]["lead_slope_um"].take();
        assert_eq!(slopes.as_array().map(Vec::len), Some(50));
        assert_eq!(with["tooth_deviations"], without["tooth_deviations"]);
        let mut solid = standard_pair();
        solid["method"] = json!("three_dimensional");
        solid["pair"]["driven"]["tooth_deviations"] =
            asked(json!({ "lead_slopes": true }))["tooth_deviations"].take();
        assert!(parse(&solid).is_ok());
        // The reference diameter of a helical gear is larger, its normal module the same.
        let helical = asked(json!({ "helix_angle_deg": -30 }));
        let told =
            |answer: &Value, name: &str| answer["tolerances_um"][name].as_f64().expect("a number");
        let d = 100.0 / 30_f64.to_radians().cos();
        let expected = 2_f64.sqrt() * (0.001 * d + 0.8 + 5.0);
        assert!((told(&helical, "single_pitch") - expected).abs() < 1e-8);
        assert!(told(&helical, "helix_slope") > told(&without, "helix_slope"));
    }

    #[test]
    fn a_class_that_the_standard_does_not_have_is_refused_with_the_nearest() {
        let gear = &standard_pair()["pair"]["driven"];
        let problem = drawn(&json!({ "gear": gear, "iso_1328_class": 12 })).expect_err("no class");
        let error = &problem.errors[0];
        assert_eq!((error.code, error.nearest), (Code::OutOfRange, Some(11.0)));
        assert_eq!(error.pointer, "/iso_1328_class");
        let problem = drawn(&json!({ "gear": { "module_mm": 2 } })).expect_err("half a gear");
        assert!(
            problem
                .errors
                .iter()
                .any(|error| error.pointer == "/gear/tooth_count")
        );
    }
}
