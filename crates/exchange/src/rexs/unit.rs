//! The units of attributes. Each attribute has a unit of its own in the standard, and says it again; other spellings and other
//! powers of ten are converted.

use crate::significant;

/// The digits that the standard keeps of a number; smaller parts are noise of a conversion.
const DIGITS: usize = 15;

/// A unit of the standard, and units that are converted to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    /// As the standard writes it.
    pub(super) name: &'static str,
    /// Other units, as [`plain`] writes them, each with a factor and a divisor, so that powers of ten round once.
    others: &'static [(&'static str, f64, f64)],
}

pub(super) const NONE: Unit = Unit {
    name: "none",
    others: &[("", 1.0, 1.0), ("-", 1.0, 1.0)],
};

pub(super) const MM: Unit = Unit {
    name: "mm",
    others: &[("mum", 1.0, 1e3), ("cm", 10.0, 1.0), ("m", 1e3, 1.0)],
};

/// Of attributes of which only matters whether they are zero.
pub(super) const MM_OR_NONE: Unit = Unit {
    name: "mm",
    others: &[
        ("none", 1.0, 1.0),
        ("", 1.0, 1.0),
        ("-", 1.0, 1.0),
        ("mum", 1.0, 1e3),
    ],
};

pub(super) const DEG: Unit = Unit {
    name: "deg",
    others: &[("rad", 180.0, std::f64::consts::PI)],
};

pub(super) const MPA: Unit = Unit {
    name: "MPa",
    others: &[
        ("N/mm2", 1.0, 1.0),
        ("Pa", 1.0, 1e6),
        ("N/m2", 1.0, 1e6),
        ("GPa", 1e3, 1.0),
    ],
};

pub(super) const KG_PER_DM3: Unit = Unit {
    name: "kg / dm^3",
    others: &[("g/cm3", 1.0, 1.0), ("t/m3", 1.0, 1.0), ("kg/m3", 1.0, 1e3)],
};

pub(super) const N_M: Unit = Unit {
    name: "N m",
    others: &[("kNm", 1e3, 1.0), ("Nmm", 1.0, 1e3)],
};

pub(super) const PER_MINUTE: Unit = Unit {
    name: "1 / min",
    others: &[
        ("rpm", 1.0, 1.0),
        ("U/min", 1.0, 1.0),
        ("1/s", 60.0, 1.0),
        ("Hz", 60.0, 1.0),
        ("rad/s", 30.0, std::f64::consts::PI),
    ],
};

/// Of curves, which are written alone.
pub(super) const N_PER_MM: Unit = written_alone("N / mm");
pub(super) const MUM: Unit = written_alone("mum");

const fn written_alone(name: &'static str) -> Unit {
    Unit { name, others: &[] }
}

impl Unit {
    /// `value` in this unit, if `said` is one that is known here. An attribute that says none has the unit of the standard.
    pub(super) fn convert(self, value: f64, said: Option<&str>) -> Option<f64> {
        let Some(said) = said.map(plain) else {
            return Some(value);
        };
        if said == plain(self.name) {
            return Some(value);
        }
        let (_, factor, divisor) = self.others.iter().find(|(name, ..)| *name == said)?;
        Some(significant(value * factor / divisor, DIGITS))
    }

    /// The units that are known, as a person is told them.
    pub(super) fn known(self) -> String {
        let others = self.others.iter().map(|(name, ..)| *name);
        let names: Vec<&str> = std::iter::once(self.name)
            .chain(others.filter(|name| !name.is_empty()))
            .collect();
        names.join(", ")
    }
}

/// A unit as it is compared: without spaces, signs of multiplication and of powers, its other characters as the standard writes them.
fn plain(unit: &str) -> String {
    let mut plain = String::new();
    for character in unit.chars() {
        match character {
            '^' | '*' | '·' | '⋅' | '×' => {}
            '²' => plain.push('2'),
            '³' => plain.push('3'),
            '¹' => plain.push('1'),
            '⁻' | '−' => plain.push('-'),
            '°' | 'º' => plain.push_str("deg"),
            // The sign for micro, and the Greek letter.
            '\u{B5}' | '\u{3BC}' => plain.push_str("mu"),
            white if white.is_whitespace() => {}
            other => plain.push(other),
        }
    }
    match plain.as_str() {
        "um" => "mum".to_owned(),
        "degree" | "degrees" => "deg".to_owned(),
        "min-1" => "1/min".to_owned(),
        "s-1" => "1/s".to_owned(),
        _ => plain,
    }
}

/// Millimeters as micrometers.
pub(super) fn um_of_mm(value: f64) -> f64 {
    significant(value * 1e3, DIGITS)
}

/// Micrometers as millimeters.
pub(super) fn mm_of_um(value: f64) -> f64 {
    value / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_is_the_same_in_every_unit() {
        for (value, unit) in [
            (0.0051, "mm"),
            (5.1, "mum"),
            (5.1, "um"),
            (5.1, "µm"),
            (0.00051, "cm"),
            (5.1e-6, "m"),
            (5.1e-6, " m "),
            (5.1, "\u{3BC}m"),
            (5.1, "\u{B5}m"),
        ] {
            assert_eq!(MM.convert(value, Some(unit)), Some(0.0051), "{unit}");
        }
        assert_eq!(MM.convert(0.0051, None), Some(0.0051));
        assert_eq!(MM.convert(0.2, Some("inch")), None);
        assert_eq!(MM.convert(0.2, Some("deg")), None);
        assert_eq!(um_of_mm(0.0051), 5.1);
    }

    #[test]
    fn stresses_densities_torques_speeds_and_angles_convert() {
        assert_eq!(MPA.convert(210.0, Some("GPa")), Some(210_000.0));
        assert_eq!(MPA.convert(210_000.0, Some("N / mm^2")), Some(210_000.0));
        assert_eq!(MPA.convert(2.1e11, Some("Pa")), Some(210_000.0));
        assert_eq!(KG_PER_DM3.convert(7850.0, Some("kg / m^3")), Some(7.85));
        for unit in ["N / mm^2", "N/mm^2", "N/mm²", "N/mm2", "N / mm²", "MPa"] {
            assert_eq!(
                MPA.convert(210_000.0, Some(unit)),
                Some(210_000.0),
                "{unit}"
            );
        }
        for unit in ["kg / dm^3", "kg/dm³", "kg/dm3", "g/cm³", "t/m³"] {
            assert_eq!(KG_PER_DM3.convert(7.85, Some(unit)), Some(7.85), "{unit}");
        }
        for unit in ["N m", "Nm", "N·m", "N*m", "N⋅m"] {
            assert_eq!(N_M.convert(115.0, Some(unit)), Some(115.0), "{unit}");
        }
        for unit in ["1 / min", "1/min", "min^-1", "min⁻¹", "rpm"] {
            assert_eq!(
                PER_MINUTE.convert(1500.0, Some(unit)),
                Some(1500.0),
                "{unit}"
            );
        }
        for unit in ["deg", "°", "º", "degree"] {
            assert_eq!(DEG.convert(20.0, Some(unit)), Some(20.0), "{unit}");
        }
        // A thousandth of a pascal is no million of them.
        assert_eq!(MPA.convert(210_000.0, Some("mPa")), None);
        assert_eq!(N_M.convert(0.115, Some("kN m")), Some(115.0));
        assert_eq!(N_M.convert(115_000.0, Some("N mm")), Some(115.0));
        assert_eq!(PER_MINUTE.convert(25.0, Some("1 / s")), Some(1500.0));
        let speed = 1500.0 / 30.0 * std::f64::consts::PI;
        assert_eq!(PER_MINUTE.convert(speed, Some("rad / s")), Some(1500.0));
        assert_eq!(DEG.convert(20.0, Some("°")), Some(20.0));
        assert_eq!(DEG.convert(20_f64.to_radians(), Some("rad")), Some(20.0));
    }

    /// Every unit of the lists of versions 1.0 to 2.0.
    const LISTED: [&str; 66] = [
        "C",
        "mm",
        "°",
        "none",
        "kN",
        "K",
        "%",
        "N mm / rad",
        "N / m",
        "N",
        "mum",
        "N m",
        "rad",
        "MPa",
        "W / mm",
        "l / min",
        "h",
        "HV",
        "N / mm^2",
        "1e-6 / C",
        "kg / dm^3",
        "W / (m K)",
        "J / (kg K)",
        "mm^2 / s",
        "1 / min",
        "s",
        "HRC",
        "HB",
        "W",
        "kW",
        "N / rad",
        "Hz",
        "m / s^2",
        "m / s",
        "m^2",
        "K m^2 / W",
        "N / (mm mum)",
        "(N / mm^2)^0.5",
        "1e-6 mm^3 / (N m)",
        "K (m / s)^0.75 mm^1.75 / W",
        "mg",
        "1 / s",
        "mm / h",
        "mm^2 / N",
        "N / mm",
        "mPa s",
        "N / (mm s^0.5 K)",
        "rad / s",
        "mus",
        "K / mus",
        "dB",
        "Pa",
        "m^3 / s",
        "mm^2",
        "1 / mm",
        "kg",
        "kg m^2",
        "deg",
        "MRev",
        "W / (m^2 K)",
        "kg / mm",
        "pF",
        "Ohm",
        "V",
        "pS / m",
        "V / m",
    ];

    #[test]
    fn every_unit_of_the_standards_lists_converts_to_those_of_its_quantity_alone() {
        let pi = std::f64::consts::PI;
        #[rustfmt::skip]
        let quantities: [(Unit, &[(&str, f64)]); 7] = [
            (NONE, &[("none", 1.0)]),
            (MM, &[("mm", 1.0), ("mum", 1e-3)]),
            (DEG, &[("deg", 1.0), ("°", 1.0), ("rad", 180.0 / pi)]),
            (MPA, &[("MPa", 1.0), ("N / mm^2", 1.0), ("Pa", 1e-6)]),
            (KG_PER_DM3, &[("kg / dm^3", 1.0)]),
            (N_M, &[("N m", 1.0)]),
            (PER_MINUTE, &[("1 / min", 1.0), ("1 / s", 60.0), ("Hz", 60.0), ("rad / s", 30.0 / pi)]),
        ];
        let powers = |unit: &str| unit.replace("^2", "²").replace("^3", "³");
        for (unit, own) in quantities {
            for said in LISTED {
                let expected = own.iter().find(|(name, _)| *name == said);
                // With and without spaces and signs of multiplication, powers as they are printed.
                let close = said.replace(' ', "");
                for spelling in [
                    said,
                    &close,
                    &powers(said),
                    &powers(&close),
                    &said.replace("N m", "N*m"),
                    &said.replace("N m", "N·m"),
                ] {
                    let found = unit.convert(3.0, Some(spelling));
                    match (found, expected) {
                        (Some(found), Some((_, factor))) => {
                            assert!(
                                (found / (3.0 * factor) - 1.0).abs() < 1e-14,
                                "{spelling}: {found} {}",
                                unit.name
                            );
                        }
                        (found, expected) => assert!(
                            found.is_none() && expected.is_none(),
                            "{spelling}: {found:?} {}",
                            unit.name
                        ),
                    }
                }
            }
        }
    }
}
