//! Teeth drawn at random within the tolerances of an accuracy class.

use meshwright_engine::gear::{Helix, Inspection, Normals, Passed, Tolerances, ToothDeviations};
use meshwright_engine::run::Run;
use serde::Serialize;
use utoipa::ToSchema;

use super::declare::{
    EACH, Errors, Flag, Kind as _, Location, Node, Number, document, flag, nested, number,
};
use super::gear::{DeviationsDocument, GearDocument};
use super::problem::{Code, FieldError, Problem};
use super::size::{MOST_VALUES, refuse_many_values};
use super::units::{plain, significant, to_um};

document! {
    /// Teeth to draw at random for a gear. Deviations that the gear has are not looked at.
    pub struct DrawDocument as "DrawDeviations", "Draw deviations" {
        /// The gear.
        gear: GearDocument = nested(""),
        /// The accuracy class A of ISO 1328-1:2013, from the finest; each is wider by the square root of 2.
        iso_1328_class: u32 = CLASS,
        /// How many times three standard deviations of a deviation fit into its tolerance.
        capability: f64 = CAPABILITY,
        /// Seed of the random numbers: the same seed gives the same teeth on every machine.
        seed: u32 = SEED,
        /// The helix angle at the reference circle, whichever the hand, of which tolerances depend by the reference diameter.
        helix_angle_deg: f64 = number("Helix angle", "deg", -45.0, 45.0).or(0.0),
        /// Also draws the slopes of the leads, which only methods in three dimensions take. The other deviations are the same with them and without them.
        lead_slopes: bool = flag("Lead slopes", false),
        /// Draws a gear that has passed an inspection: each single pitch within f_pT, the cumulative pitch measured from the bore within F_pT, the runout
        /// within F_rT, and the slopes within theirs. Gears that do not pass are drawn again; without an inspection the first one is taken as it is.
        inspected: bool = INSPECTED,
    }
}

/// A class of ISO 1328-1:2013.
pub const CLASS: Number = number("Accuracy class", "1", 1.0, 11.0);

/// How well a process keeps its tolerances.
pub const CAPABILITY: Number = number("Process capability", "1", 0.1, 10.0).or(1.0);

/// Flag: gears outside of their class are rejected and drawn again.
pub const INSPECTED: Flag = flag("Inspected", true);

/// Seed of random numbers.
pub const SEED: Number = number("Seed", "1", 0.0, 4_294_967_295.0).or(1.0);

/// A request for teeth: gear, accuracy and seed.
pub struct Draw {
    accuracy: Accuracy,
    seed: u64,
    lead_slopes: bool,
}

impl DrawDocument {
    /// The request, if its gear can be made and may pass; faults are reported to `errors`.
    fn made(self, errors: &Errors, run: &Run) -> Option<Draw> {
        let made = self
            .gear
            .without_deviations()
            .to_gear("/gear", Helix::right(self.helix_angle_deg.to_radians()));
        let gear = errors.report(made)?;
        let accuracy = Accuracy {
            inspection: Inspection::of(&gear, self.iso_1328_class),
            capability: self.capability,
            is_inspected: self.inspected,
        };
        accuracy.refuse_hopeless(self.lead_slopes, "/capability", errors, run)?;
        Some(Draw {
            accuracy,
            seed: u64::from(self.seed),
            lead_slopes: self.lead_slopes,
        })
    }
}

/// How accurately a gear is made, and whether it is inspected.
///
/// Leads are drawn and inspected by themselves: they are independent of the other deviations, so that the law is that of whole gears that are drawn again, and the
/// same teeth have them and have them not.
#[derive(Debug, Clone)]
pub struct Accuracy {
    /// Its tolerances, and the measurements of an inspection.
    pub inspection: Inspection,
    /// How many times three standard deviations of a deviation fit into its tolerance.
    pub capability: f64,
    /// True if gears that do not pass are drawn again.
    pub is_inspected: bool,
}

impl Accuracy {
    /// Of so many gears made one has to pass.
    const MOST_FOR_ONE: usize = 100;

    /// Teeth with their eccentricity, of the standard normal deviates of each attempt.
    pub fn teeth<N: Iterator<Item = f64>>(&self, normals: impl Fn(u32) -> N) -> Option<Passed> {
        let (tolerances, count) = (&self.inspection.tolerances, self.inspection.tooth_count());
        self.passed(|attempt| tolerances.draw(count, self.capability, normals(attempt)))
    }

    /// Slopes of the leads of those teeth.
    pub fn lead_slopes<N: Iterator<Item = f64>>(
        &self,
        normals: impl Fn(u32) -> N,
    ) -> Option<Passed> {
        let (tolerances, count) = (&self.inspection.tolerances, self.inspection.tooth_count());
        self.passed(|attempt| ToothDeviations {
            lead_slope: tolerances.draw_lead_slopes(count, self.capability, normals(attempt)),
            ..ToothDeviations::default()
        })
    }

    fn passed(&self, draw: impl Fn(u32) -> ToothDeviations) -> Option<Passed> {
        if self.is_inspected {
            self.inspection.first_that_passes(draw)
        } else {
            let (teeth, attempts) = (draw(0), 1);
            Some(Passed { teeth, attempts })
        }
    }

    /// Refuses a capability at which fewer than one gear in a hundred would pass, those with `lead_slopes` by them too, and names the least one at which
    /// so many do.
    pub fn refuse_hopeless(
        &self,
        lead_slopes: bool,
        pointer: &str,
        errors: &Errors,
        run: &Run,
    ) -> Option<()> {
        const MADE: usize = 4000;
        if !self.is_inspected {
            return Some(());
        }
        let (tolerances, count) = (&self.inspection.tolerances, self.inspection.tooth_count());
        let part = |gear: usize| {
            // Any gears will do, the same ones for everybody.
            let normals = |stream| Normals::of_attempt(0, stream, gear as u32);
            let mut teeth = tolerances.draw(count, self.capability, normals(0));
            if lead_slopes {
                teeth.lead_slope = tolerances.draw_lead_slopes(count, self.capability, normals(1));
            }
            self.inspection.largest_part(&teeth)
        };
        let needed = MADE / Self::MOST_FOR_ONE;
        let mut parts = Vec::new();
        let mut passed = 0;
        for gear in 0..MADE {
            if run.check().is_err() {
                let detail = "Nobody waits for this any more.";
                errors.push(FieldError::new(pointer, Code::Stopped, detail));
                return None;
            }
            parts.push(part(gear));
            passed += usize::from(parts[gear] <= 1.0);
            if passed == needed {
                return Some(());
            }
        }
        // Deviations are in inverse proportion to the capability.
        parts.sort_by(f64::total_cmp);
        let capability = (100.0 * self.capability * parts[needed - 1]).ceil() / 100.0;
        let detail = format!(
            "{pointer} is {}; of gears with {count} teeth fewer than one in a hundred would pass the inspection of their class. At {} one in a hundred does; or take \"inspected\": false.",
            plain(self.capability),
            plain(capability)
        );
        errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(capability));
        None
    }

    /// That none of very many gears has passed.
    pub fn none_passed(&self, pointer: &str) -> FieldError {
        let detail = format!(
            "None of {} gears with {} teeth passed the inspection of their class at a capability of {}.",
            Inspection::MOST_ATTEMPTS,
            self.inspection.tooth_count(),
            plain(self.capability)
        );
        FieldError::new(pointer, Code::OutOfRange, detail)
    }
}

document! {
    /// The tolerances of ISO 1328-1:2013 for a gear and a class, unrounded, in um.
    pub struct TolerancesDocument as Tolerances, "Tolerances" answer of (tolerances: &Tolerances) {
        /// f_pT: of a single pitch.
        single_pitch: f64 = um(tolerances.single_pitch),
        /// F_pT: of the cumulative pitch around the gear.
        total_pitch: f64 = um(tolerances.total_pitch),
        /// f_HaT: of the slope of a profile.
        profile_slope: f64 = um(tolerances.profile_slope),
        /// f_faT: of the form of a profile.
        profile_form: f64 = um(tolerances.profile_form),
        /// F_rT: of the runout.
        runout: f64 = um(tolerances.runout),
        /// f_HbT: of the slope of a helix.
        helix_slope: f64 = um(tolerances.helix_slope),
    }
}

/// Teeth drawn at random.
#[derive(Debug, Serialize, ToSchema)]
#[schema(title = "Drawn deviations")]
pub struct DrawnDeviations {
    /// The deviations of the teeth, ready for a gear of a submission.
    tooth_deviations: DeviationsDocument,
    /// F_p: the total cumulative pitch deviation of these teeth, measured from the bore, so that the eccentricity counts, in um. Without an
    /// inspection it may be more than `total_pitch`.
    total_pitch_deviation_um: f64,
    /// The gears that were drawn before this one and did not pass; 0 without an inspection.
    gears_rejected: u32,
    /// The tolerances of the class, in um.
    tolerances_um: TolerancesDocument,
}

fn um(value: f64) -> f64 {
    significant(to_um(value), 10)
}

impl Draw {
    /// Reads and checks the request.
    ///
    /// # Errors
    ///
    /// As for a submission, and `stopped`.
    pub fn parse(document: &[u8], run: &Run) -> Result<Self, Problem> {
        refuse_many_values(document, MOST_VALUES)?;
        let node = Node::parse(document)?;
        let errors = Errors::default();
        let asked = DrawDocument::read(&node, &Location::root(&errors), &EACH);
        let draw = asked.and_then(|asked| asked.made(&errors, run));
        errors.settle(draw)
    }

    /// The teeth.
    ///
    /// # Errors
    ///
    /// `out_of_range`, if none of very many gears passes.
    pub fn drawn(&self) -> Result<DrawnDeviations, Problem> {
        let normals = |stream| move |attempt| Normals::of_attempt(self.seed, stream, attempt);
        let passed = self.accuracy.teeth(normals(0));
        let leads = self
            .lead_slopes
            .then(|| self.accuracy.lead_slopes(normals(1)));
        let (
            Some(Passed {
                mut teeth,
                attempts,
            }),
            Some(leads),
        ) = (passed, leads.map_or(Some(None), |leads| leads.map(Some)))
        else {
            let error = self.accuracy.none_passed("/capability");
            return Err(Problem::of_fields(vec![error]));
        };
        let mut rejected = attempts - 1;
        if let Some(leads) = leads {
            rejected += leads.attempts - 1;
            teeth.lead_slope = leads.teeth.lead_slope;
        }
        let inspection = &self.accuracy.inspection;
        Ok(DrawnDeviations {
            total_pitch_deviation_um: um(inspection.total_pitch_deviation(&teeth)),
            gears_rejected: rejected,
            tooth_deviations: DeviationsDocument::of(&teeth),
            tolerances_um: TolerancesDocument::of(&inspection.tolerances),
        })
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::testing::{and, example, parse};

    fn standard_pair() -> Value {
        example("standard-pair")
    }

    fn drawn(document: &Value) -> Result<Value, Problem> {
        let draw = Draw::parse(document.to_string().as_bytes(), &Run::unattended())?;
        Ok(serde_json::to_value(draw.drawn()?).expect("JSON"))
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
        let inspection = Inspection::of(parsed.case().pair.driven(), 6);
        assert!((1e6 * inspection.total_pitch_deviation(teeth) - total).abs() < 2e-4);
        assert!(
            total
                <= answer["tolerances_um"]["total_pitch"]
                    .as_f64()
                    .expect("a number")
        );
        // Deviations that the gear has already are ignored.
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
        let tolerance =
            |answer: &Value, name: &str| answer["tolerances_um"][name].as_f64().expect("a number");
        let d = 100.0 / 30_f64.to_radians().cos();
        let expected = 2_f64.sqrt() * (0.001 * d + 0.8 + 5.0);
        assert!((tolerance(&helical, "single_pitch") - expected).abs() < 1e-8);
        assert!(tolerance(&helical, "helix_slope") > tolerance(&without, "helix_slope"));
    }

    #[test]
    fn gears_that_are_not_of_their_class_are_drawn_again_unless_nobody_inspects_them() {
        let mut gear = standard_pair()["pair"]["driven"].clone();
        gear["tooth_count"] = json!(85);
        let asked = |seed: u64, more: Value| {
            let asked =
                json!({ "gear": gear, "iso_1328_class": 6, "seed": seed, "lead_slopes": true });
            drawn(&and(asked, &more)).expect("drawn")
        };
        let number = |answer: &Value, pointer: &str| {
            answer
                .pointer(pointer)
                .and_then(Value::as_f64)
                .expect(pointer)
        };
        let beyond = |answer: &Value| {
            number(answer, "/total_pitch_deviation_um")
                > number(answer, "/tolerances_um/total_pitch")
        };
        let (mut rejected, mut out_of_class) = (0.0, 0);
        for seed in 0..40 {
            let (inspected, as_made) = (
                asked(seed, json!({})),
                asked(seed, json!({ "inspected": false })),
            );
            assert!(!beyond(&inspected));
            out_of_class += u32::from(beyond(&as_made));
            assert_eq!(as_made["gears_rejected"], 0);
            rejected += number(&inspected, "/gears_rejected");
            if inspected["gears_rejected"] == 0 {
                assert_eq!(inspected, as_made, "the first one has passed");
            }
        }
        // 59 % are beyond F_pT, and 80 % pass by each of the others that has 85 numbers: about three of four gears do not pass.
        assert!((14..34).contains(&out_of_class), "{out_of_class}");
        assert!((60.0..240.0).contains(&rejected), "{rejected}");
        // The deviations of versions without an inspection, to the last digit.
        let earlier = json!({ "gear": standard_pair()["pair"]["driven"], "iso_1328_class": 6, "seed": 3, "inspected": false });
        let teeth = &drawn(&earlier).expect("drawn")["tooth_deviations"];
        assert_eq!(teeth["pitch_single_um"][0], EARLIER[0]);
        assert_eq!(teeth["profile_slope_um"][49], EARLIER[1]);
        assert_eq!(teeth["eccentricity"]["amount_um"], EARLIER[2]);
    }

    /// By version 0.4.0.
    const EARLIER: [f64; 3] = [3.2817, -1.4894, 0.3353];

    #[test]
    fn where_fewer_than_one_gear_in_a_hundred_would_pass_the_capability_is_named_that_is_needed() {
        let mut gear = standard_pair()["pair"]["driven"].clone();
        gear["tooth_count"] = json!(150);
        let asked = |capability: f64| {
            drawn(&json!({ "gear": gear, "iso_1328_class": 6, "capability": capability }))
        };
        let problem = asked(0.67).expect_err("none of 20,000 passes");
        let error = &problem.errors[0];
        assert_eq!(
            (&*error.pointer, error.code),
            ("/capability", Code::OutOfRange)
        );
        let needed = error.nearest.expect("it is named");
        assert!((0.75..1.0).contains(&needed), "{needed}");
        assert!(asked(needed).is_ok());
        assert!(asked(needed - 0.02).is_err());
        assert!(asked(1.0).is_ok(), "8 % pass");
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
