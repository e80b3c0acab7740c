//! Materials by their names: what a submission may call them, their numbers, and where these are printed.

use serde::Serialize;
use utoipa::ToSchema;

use super::declare::{Choice as _, words};

words! {
    /// The name of a material.
    pub enum MaterialName {
        CaseHardeningSteel = "16MnCr5": "case-hardening steel, flanks of 58 HRC",
        HeatTreatableSteel = "42CrMo4": "alloy steel, quenched and tempered, 16 to 40 mm thick",
        CarbonSteel = "C45": "carbon steel, quenched and tempered, 16 to 40 mm thick",
        GrayIron = "GG-25": "gray cast iron, EN-GJL-250",
        Polyoxymethylene = "POM": "polyoxymethylene, a copolymer without filler",
        Polyamide = "PA66": "polyamide 66 without filler, conditioned at 50 % of humidity",
        Polyetheretherketone = "PEEK": "polyetheretherketone without filler",
    }
}

/// Numbers of a material at another temperature than that of its entry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
#[schema(as = MaterialAtTemperature, title = "MaterialAtTemperature")]
pub struct AtTemperature {
    /// The temperature, in degrees Celsius.
    temperature_c: f64,
    /// Young's modulus, in GPa: that of the entry, in the ratio of the moduli that are printed for the two temperatures.
    youngs_modulus_gpa: f64,
    /// The mean coefficient of thermal expansion between the temperature of the entry and this one, in 1/K.
    expansion_per_k: f64,
}

/// The numbers of a material at a temperature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
#[schema(as = NamedMaterial, title = "NamedMaterial")]
pub struct MaterialEntry {
    /// The name, which `material.name` of a gear takes.
    #[serde(serialize_with = "as_word")]
    #[schema(value_type = String)]
    pub(crate) name: MaterialName,
    /// The kind of material, and its state.
    title: &'static str,
    /// Young's modulus, in GPa.
    pub(crate) youngs_modulus_gpa: f64,
    /// Poisson's ratio.
    pub(crate) poisson_ratio: f64,
    /// The density, in kg/m3.
    pub(crate) density_kg_m3: f64,
    /// The coefficient of thermal expansion, in 1/K.
    pub(crate) expansion_per_k: f64,
    /// The yield strength of the flanks, in MPa.
    pub(crate) yield_strength_mpa: f64,
    /// The temperature for which the numbers are printed, in degrees Celsius.
    temperature_c: f64,
    /// The numbers at higher temperatures, in rising order; straight lines are taken between them and from those of the entry.
    /// Poisson's ratio and the density, which goes with the dimensions of the cold gear, stay.
    at_temperatures: &'static [AtTemperature],
    /// The publications that print the numbers.
    source: &'static str,
}

fn as_word<S: serde::Serializer>(name: &MaterialName, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(name.word())
}

/// The numbers at a temperature, in the order of the fields.
const fn at(temperature_c: f64, youngs_modulus_gpa: f64, expansion_per_k: f64) -> AtTemperature {
    AtTemperature {
        temperature_c,
        youngs_modulus_gpa,
        expansion_per_k,
    }
}

/// Steels from 200 to 600 deg F.
static WARM_STEEL: [AtTemperature; 5] = [
    at(93.0, 205.0, 12.45e-6),
    at(149.0, 201.4, 12.68e-6),
    at(204.0, 197.1, 12.90e-6),
    at(260.0, 194.2, 13.12e-6),
    at(316.0, 189.9, 13.34e-6),
];

/// Young's modulus, Poisson's ratio, density and expansion of steels, and where they are printed.
macro_rules! steel {
    ($name:ident, $yield_strength_mpa:literal, $source:literal) => {
        MaterialEntry {
            youngs_modulus_gpa: 210.0,
            poisson_ratio: 0.3,
            density_kg_m3: 7850.0,
            expansion_per_k: 12e-6,
            yield_strength_mpa: $yield_strength_mpa,
            temperature_c: 20.0,
            at_temperatures: &WARM_STEEL,
            ..entry(
                MaterialName::$name,
                concat!(
                    "EN 1993-1-1:2005, 3.2.6 (modulus, Poisson's ratio, expansion); EN 1991-1-1:2002, table A.4 (density); ",
                    "W. C. Young and R. G. Budynas, Roark's Formulas for Stress and Strain, 2002 (modulus of carbon steels over temperature); ",
                    "EN 1993-1-2:2005, 3.4.1.1 (expansion over temperature); ",
                    $source
                ),
            )
        }
    };
}

/// The materials, one for each name in their order.
#[rustfmt::skip]
pub static MATERIALS: [MaterialEntry; 7] = [
    steel!(CaseHardeningSteel, 2130.0,
        "ASTM E140 (58 HRC are 653 HV) and D. Tabor, The Hardness of Metals, 1951 (yield strength: a third of the hardness)"),
    steel!(HeatTreatableSteel, 750.0, "EN 10083-3:2006 (least yield strength)"),
    steel!(CarbonSteel, 430.0, "EN 10083-2:2006 (least yield strength)"),
    MaterialEntry {
        youngs_modulus_gpa: 110.0, poisson_ratio: 0.26, density_kg_m3: 7200.0, expansion_per_k: 11.7e-6,
        yield_strength_mpa: 165.0, temperature_c: 20.0,
        at_temperatures: &[at(93.0, 108.3, 11.7e-6), at(149.0, 105.8, 11.7e-6), at(204.0, 103.5, 11.7e-6)],
        ..entry(MaterialName::GrayIron,
            "EN 1561:2011, annex A: modulus 103 to 118 GPa, the least proof stress of 0.1 %, expansion from 20 to 200 deg C; \
            W. C. Young and R. G. Budynas, Roark's Formulas for Stress and Strain, 2002 (modulus of gray cast iron over temperature)")
    },
    MaterialEntry {
        youngs_modulus_gpa: 2.85, poisson_ratio: 0.37, density_kg_m3: 1410.0, expansion_per_k: 110e-6,
        yield_strength_mpa: 64.0, temperature_c: 23.0,
        at_temperatures: &[at(71.0, 1.37, 110e-6), at(104.0, 0.76, 110e-6)],
        ..entry(MaterialName::Polyoxymethylene,
            "Celanese, data sheet of Hostaform C 9021 (ISO 527, ISO 1183, ISO 11359); Poisson's ratio: usual for POM; \
            Celanese, design manual of Celcon, M90 (flexural modulus over temperature, ASTM D790)")
    },
    MaterialEntry {
        youngs_modulus_gpa: 1.4, poisson_ratio: 0.4, density_kg_m3: 1140.0, expansion_per_k: 100e-6,
        yield_strength_mpa: 55.0, temperature_c: 23.0,
        at_temperatures: &[at(77.0, 0.656, 100e-6), at(121.0, 0.48, 100e-6)],
        ..entry(MaterialName::Polyamide,
            "DuPont, data sheet of Zytel 103HSL NC010, conditioned (ISO 527, ISO 1183, ISO 11359); Poisson's ratio: usual for PA66; \
            DuPont, design guide of Zytel, 101 at 50 % of humidity (flexural modulus over temperature, ASTM D790)")
    },
    MaterialEntry {
        youngs_modulus_gpa: 4.0, poisson_ratio: 0.4, density_kg_m3: 1300.0, expansion_per_k: 45e-6,
        yield_strength_mpa: 98.0, temperature_c: 23.0,
        ..entry(MaterialName::Polyetheretherketone,
            "Victrex, data sheet of PEEK 450G (ISO 527, ISO 1183, ISO 11359 along the flow); Poisson's ratio: usual for PEEK")
    },
];

/// An entry with its words alone.
const fn entry(name: MaterialName, source: &'static str) -> MaterialEntry {
    MaterialEntry {
        name,
        title: MaterialName::OPTIONS[name as usize].2,
        youngs_modulus_gpa: 0.0,
        poisson_ratio: 0.0,
        density_kg_m3: 0.0,
        expansion_per_k: 0.0,
        yield_strength_mpa: 0.0,
        temperature_c: 0.0,
        at_temperatures: &[],
        source,
    }
}

impl MaterialEntry {
    /// The entry of this name.
    pub(crate) fn of_name(name: MaterialName) -> &'static Self {
        &MATERIALS[name as usize]
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::problem::Code;
    use crate::submission::Submission;
    use crate::testing::example;

    fn with_material(material: serde_json::Value) -> serde_json::Value {
        let mut submission = example("standard-pair");
        submission["pair"]["driven"]["material"] = material;
        // Within the limit of every material.
        submission["output_torques_n_m"] = json!([5.0]);
        submission
    }

    fn filled_in(material: serde_json::Value) -> serde_json::Value {
        let submission = Submission::parse(with_material(material).to_string().as_bytes());
        let echo: serde_json::Value =
            serde_json::from_str(&submission.expect("valid").canonical_json()).expect("JSON");
        echo["pair"]["driven"]["material"].clone()
    }

    #[test]
    fn every_name_has_its_entry_and_numbers_that_a_gear_may_have() {
        for (i, (word, name, title)) in MaterialName::OPTIONS.iter().enumerate() {
            let entry = MaterialEntry::of_name(*name);
            assert_eq!((entry.name, entry.title), (*name, *title), "{i}");
            assert!(entry.source.len() > 20 && entry.expansion_per_k > 1e-6);
            let material = filled_in(json!({ "name": word }));
            assert_eq!(material["name"], *word);
            assert_eq!(material["youngs_modulus_gpa"], entry.youngs_modulus_gpa);
            assert_eq!(material["poisson_ratio"], entry.poisson_ratio);
            assert_eq!(material["density_kg_m3"], entry.density_kg_m3);
            assert_eq!(material["yield_strength_mpa"], entry.yield_strength_mpa);
        }
    }

    #[test]
    fn moduli_fall_with_temperature_as_printed() {
        // Each row: the moduli that the source prints, first for the temperature of the entry; in GPa, those of POM and PA66 in kpsi.
        let carbon_steel = &[202.0, 197.2, 193.7, 189.6, 186.8, 182.7][..];
        for (name, printed) in [
            (MaterialName::CaseHardeningSteel, carbon_steel),
            (MaterialName::HeatTreatableSteel, carbon_steel),
            (MaterialName::CarbonSteel, carbon_steel),
            (MaterialName::GrayIron, &[92.4, 91.0, 88.9, 86.9][..]),
            (MaterialName::Polyoxymethylene, &[375.0, 180.0, 100.0][..]),
            (MaterialName::Polyamide, &[175.0, 82.0, 60.0][..]),
        ] {
            let entry = MaterialEntry::of_name(name);
            assert_eq!(entry.at_temperatures.len() + 1, printed.len(), "{name:?}");
            let mut before = entry.temperature_c;
            for (point, modulus) in entry.at_temperatures.iter().zip(&printed[1..]) {
                let expected = entry.youngs_modulus_gpa * modulus / printed[0];
                let off = point.youngs_modulus_gpa / expected - 1.0;
                assert!(off.abs() < 2e-3, "{name:?} {}", point.temperature_c);
                assert!(point.temperature_c > before);
                before = point.temperature_c;
                if printed == carbon_steel {
                    // EN 1993-1-2: the length grows by 1.2e-5 T + 0.4e-8 T^2 - 2.416e-4 from 20 deg C.
                    let t = point.temperature_c;
                    let grown = 1.2e-5 * t + 0.4e-8 * t * t - 2.416e-4;
                    let mean = grown / (t - 20.0);
                    assert!((point.expansion_per_k / mean - 1.0).abs() < 1e-3);
                }
            }
        }
    }

    #[test]
    fn numbers_beside_a_name_hold_and_a_name_changes_nothing_but_numbers() {
        let hot = filled_in(json!({ "name": "POM", "youngs_modulus_gpa": 1.2 }));
        // The data sheet prints 2.85 GPa and 1410 kg/m3.
        assert_eq!(
            (&hot["youngs_modulus_gpa"], &hot["density_kg_m3"]),
            (&json!(1.2), &json!(1410.0))
        );
        // What is filled in says the same when it is sent again.
        assert_eq!(filled_in(hot.clone()), hot);
        let hash = |material| {
            let document = with_material(material).to_string();
            Submission::parse(document.as_bytes())
                .expect("valid")
                .input_hash()
        };
        let mut unnamed = hot.clone();
        unnamed.as_object_mut().expect("an object").remove("name");
        assert_eq!(hash(hot), hash(unnamed));
        assert!(filled_in(json!({})).get("name").is_none());
    }

    #[test]
    fn an_unknown_name_is_refused_with_the_nearest() {
        for (given, meant) in [
            ("16mncr5", "16MnCr5"),
            ("42CrMo", "42CrMo4"),
            ("pom", "POM"),
            ("GG25", "GG-25"),
        ] {
            let document = with_material(json!({ "name": given })).to_string();
            let problem = Submission::parse(document.as_bytes()).expect_err("unknown");
            let error = &problem.errors[0];
            assert_eq!(error.code, Code::WrongType);
            assert_eq!(error.pointer, "/pair/driven/material/name");
            assert!(
                error.detail.contains(&format!("Is {meant} meant?")),
                "{}",
                error.detail
            );
        }
    }
}
