//! How a pair runs: speed, temperatures and press fits, as they are asked for.

use meshwright_engine::analysis::running::{Bore, Running, RunningGear};
use meshwright_engine::analysis::{Method, RotationSpeed};
use meshwright_engine::gear::{GearPair, Member, PairDeviations};

use super::declare::{Choice as _, Errors, absent, document, nested, number, word, words};
use super::pair::PairDocument;
use super::problem::{Code, FieldError};
use super::units::{from_mpa, from_um, plain, significant, to_mm};

words! {
    /// What holds a bore while its gear rotates.
    pub enum BoreHold {
        Held = "held": "a rigid hub, as under load",
        Free = "free": "nothing but its mean rotation and displacement",
    }
}

document! {
    /// How the pair runs. Rotation, heat and press fits move the flanks, which the contact takes as deviations of the drawn flanks, and stress roots and hole
    /// edges beside the load. Compliances stay those of the drawing, and a load acts on bores that are held. All methods by finite elements see it.
    pub struct RunningDocument as "Running", "Running" {
        /// The speed of the driving gear, whose square the pull of rotation grows with.
        pub(crate) driving_speed_rpm: f64 =
            number("Speed of the driving gear", "1/min", 0.0, 1e6).or(0.0),
        /// The temperatures of the gears: each grows evenly, by `material.expansion_per_k`.
        temperature_c: Option<TemperaturesDocument> =
            absent(nested("Temperatures"), "the reference temperature"),
        /// The temperature at which the gears and the center distance are as drawn.
        reference_c: f64 = temperature("Reference temperature").or(20.0),
        /// Interferences of the bores with solid shafts of the material and the temperature of their gears. A fit stands in place of `bore`.
        press_fit_um: Option<PressFitsDocument> = absent(nested("PressFits"), "none"),
        /// What holds the bores while the gears rotate.
        bore: BoreHold = word("Bore").or(BoreHold::Held),
        /// The temperature of the housing, which changes the center distance.
        housing_temperature_c: Option<f64> =
            absent(temperature("Temperature of the housing"), "the reference temperature"),
        /// The thermal expansion of the housing for each kelvin.
        housing_expansion_per_k: f64 =
            number("Thermal expansion of the housing", "1/K", 0.0, 1e-3).or(11.5e-6),
    }
}

document! {
    /// The temperatures of the gears.
    pub struct TemperaturesDocument as "Temperatures", "Temperatures" {
        /// That of the driving gear.
        driving: Option<f64> =
            absent(temperature("Temperature of the driving gear"), "the reference temperature"),
        /// That of the driven gear.
        driven: Option<f64> =
            absent(temperature("Temperature of the driven gear"), "the reference temperature"),
    }
}

document! {
    /// By how much shafts are larger in diameter than the bores that they are pressed into, both cold.
    pub struct PressFitsDocument as "PressFits", "Press fits" {
        /// In the driving gear.
        driving: Option<f64> = absent(interference("Interference of the driving gear"), "none"),
        /// In the driven gear.
        driven: Option<f64> = absent(interference("Interference of the driven gear"), "none"),
    }
}

/// A temperature between those at which metals and plastics are brittle and those at which steel loses its strength.
const fn temperature(title: &'static str) -> super::declare::Number {
    number(title, "C", -100.0, 500.0)
}

const fn interference(title: &'static str) -> super::declare::Number {
    number(title, "um", 0.01, 5_000.0)
}

impl RunningDocument {
    /// How `pair` runs.
    pub(super) fn data(&self, pair: &PairDocument) -> Running {
        let temperatures = self.temperature_c.as_ref();
        let temperatures = [
            temperatures.and_then(|both| both.driving),
            temperatures.and_then(|both| both.driven),
        ];
        let fits = self.press_fits();
        let gear = |member: Member| {
            let gear = pair.gear(member);
            let risen = temperatures[member.index()].map_or(0.0, |own| own - self.reference_c);
            let bore = match (fits[member.index()], self.bore) {
                (Some(fit), _) => Bore::PressFit {
                    interference: from_um(fit) / 2.0,
                },
                (None, BoreHold::Held) => Bore::Held,
                (None, BoreHold::Free) => Bore::Free,
            };
            RunningGear {
                thermal_strain: gear.material.expansion_per_k * risen,
                bore,
                tensile_strength: gear.material.tensile_strength_mpa.map(from_mpa),
            }
        };
        Running {
            driving_speed: RotationSpeed(self.driving_speed_rpm / 60.0),
            gears: Member::BOTH.map(gear),
        }
    }

    /// Refuses a gear of `pair` along its face whose holes pull its axis to one side while no hub holds it.
    fn check_uneven(&self, running: &Running, pair: &GearPair, errors: &Errors) {
        for (member, own) in Member::BOTH.into_iter().zip(&running.gears) {
            let gear = pair.gear(member);
            if !gear.has_holes() || gear.hole_repeats() > 1 || gear.data().blank.shaft().is_some() {
                continue;
            }
            let pointer = match own.bore {
                Bore::PressFit { .. } => format!("/running/press_fit_um/{member}"),
                Bore::Free if self.driving_speed_rpm > 0.0 => "/running/bore".to_owned(),
                Bore::Free | Bore::Held => continue,
            };
            let detail = format!(
                "{pointer}: the holes of the {member} gear do not repeat around it. Along faces such a gear is followed on a held bore alone; the method flexible follows it on any."
            );
            errors.push(FieldError::new(pointer, Code::NotInThreeDimensions, detail));
        }
    }

    fn press_fits(&self) -> [Option<f64>; 2] {
        let fits = self.press_fit_um.as_ref();
        [
            fits.and_then(|both| both.driving),
            fits.and_then(|both| both.driven),
        ]
    }

    /// The warm center distance over the cold one, in lengths of the gears of `pair`, which have grown too.
    pub(super) fn distance_growth(&self, pair: &PairDocument) -> f64 {
        let risen = self
            .housing_temperature_c
            .map_or(0.0, |own| own - self.reference_c);
        (1.0 + self.housing_expansion_per_k * risen) / (1.0 + self.data(pair).shared_strain())
    }

    /// Refuses what goes together with no method, gear or backlash of the submission: `pair` at its warm center distance.
    pub(super) fn check(
        &self,
        method: Method,
        (document, pair): (&PairDocument, &GearPair),
        errors: &Errors,
    ) {
        if !method.sees_running() {
            let detail = format!(
                "/running is not seen by the method {}; flexible sees it.",
                method.word()
            );
            errors.push(FieldError::new("/running", Code::QuantityNotTold, detail));
        }
        for (member, fit) in Member::BOTH.into_iter().zip(self.press_fits()) {
            let shaft = pair.gear(member).data().blank.shaft();
            if let (Some(fit), Some(_)) = (fit, shaft) {
                let pointer = format!("/running/press_fit_um/{member}");
                let detail = format!(
                    "{pointer} is {} um, and /pair/{member}/blank/shaft is in one piece with its gear; leave one of them out.",
                    plain(fit)
                );
                errors.push(FieldError::new(pointer, Code::ConflictingFields, detail));
            }
        }
        let running = self.data(document);
        if method.sees_faces() {
            self.check_uneven(&running, pair, errors);
        }
        let growth = running.thermal_growth(pair);
        let deviations = pair.deviations().growing(pair, growth.each_ref());
        let backlash = pair.backlash_with(&deviations);
        if deviations != PairDeviations::NONE && backlash < 0.0 {
            errors.push(jammed("/running/temperature_c", backlash));
        }
    }
}

/// That the flanks which have grown leave so little `backlash`, in meters.
pub(super) fn jammed(pointer: &str, backlash: f64) -> FieldError {
    let detail = format!(
        "The flanks that have grown leave a backlash of {} mm along the line of action: the teeth jam. A larger center distance or thinner teeth leave room.",
        plain(significant(to_mm(backlash), 3))
    );
    FieldError::new(pointer, Code::NegativeBacklash, detail)
}
