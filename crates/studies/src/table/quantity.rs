//! The numbers of a design by name: columns of tables, statistics of populations, goals and bounds of searches.

use meshwright_engine::analysis::Method;
use meshwright_wire::declare::{Choice as _, document};
use meshwright_wire::resolution::methods;
use meshwright_wire::results::{GearPeakStress, StatisticsValues, TransmissionErrorStatistics};
use meshwright_wire::submission::Submission;
use meshwright_wire::warning::GearName;
use serde::Serialize;
use utoipa::ToSchema;

use super::summary::{CurveSummary, Summary};

/// A number of a design.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// Its name on the wire.
    pub(crate) name: &'static str,
    title: &'static str,
    symbol: &'static str,
    unit: &'static str,
    /// Where it stands.
    pub(crate) of: Of,
    gear: Option<GearName>,
    better: Option<Better>,
    /// Where a row of a table has it, before its name.
    within: &'static str,
    /// True if every table has a column of it; otherwise only tables whose rows have it.
    pub(super) in_every_table: bool,
    /// Conditions on a submission that has it.
    needs: &'static [Needs],
    /// Its equivalent for a design without it, such as the ligament of a design without holes. `None` where it is only not computed.
    pub(crate) absent: fn(&Summary) -> Option<f64>,
}

/// Which way a number is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(title = "Better")]
pub enum Better {
    /// The less of it.
    Smaller,
    /// The more of it.
    Larger,
}

/// Subject of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(title = "What a quantity is of")]
pub enum QuantityOf {
    /// Of the pair, whatever the torque.
    Pair,
    /// Of the curve at each torque.
    Curve,
}

document! {
    /// A quantity of a design: columns of tables, goals and bounds of searches and results of populations have its name.
    pub struct QuantityEntry as Quantity, "Quantity" view of (quantity: &Quantity) {
        /// Its name in goals, bounds and populations.
        name: &'static str = quantity.name,
        /// Title.
        title: String = quantity.title(),
        /// How it is abbreviated.
        symbol: String = quantity.symbol(),
        /// Its unit, written as those of fields are; 1 without one.
        unit: &'static str = quantity.unit,
        /// Subject: the pair or each curve.
        of: QuantityOf = match quantity.of {
            Of::Pair(_) => QuantityOf::Pair,
            Of::Curve(_) => QuantityOf::Curve,
        },
        /// Of which gear it is; null where it is of both.
        #[schema(required)]
        gear: Option<GearName> = quantity.gear,
        /// Which way it is better; null where that depends.
        #[schema(required)]
        better: Option<Better> = quantity.better,
        /// Fields of a submission without which it is not told: JSON pointers. Where they are of both gears, one of them will do.
        needs: Vec<&'static str> = quantity
            .needs
            .iter()
            .flat_map(|needs| needs.pointers())
            .copied()
            .collect(),
        /// The methods that tell it.
        methods: Vec<&'static str> = methods()
            .filter(|method| quantity.is_known_to(method))
            .collect(),
    }
}

impl PartialEq for Quantity {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Quantity {
    /// The one of this name.
    pub fn of_name(name: &str) -> Option<&'static Self> {
        QUANTITIES.iter().find(|quantity| quantity.name == name)
    }

    const fn gear(self, gear: GearName) -> Self {
        let gear = Some(gear);
        Self { gear, ..self }
    }

    const fn smaller(self) -> Self {
        let better = Some(Better::Smaller);
        Self { better, ..self }
    }

    const fn larger(self) -> Self {
        let better = Some(Better::Larger);
        Self { better, ..self }
    }

    const fn in_statistics(self) -> Self {
        let within = "statistics.";
        Self { within, ..self }
    }

    const fn where_known(self) -> Self {
        let in_every_table = false;
        Self {
            in_every_table,
            ..self
        }
    }

    const fn needs(self, needs: &'static [Needs]) -> Self {
        Self { needs, ..self }
    }

    const fn or(self, absent: fn(&Summary) -> Option<f64>) -> Self {
        Self { absent, ..self }
    }

    /// Title.
    pub fn title(&self) -> String {
        let gear = self
            .gear
            .map(|gear| format!(" of the {} gear", gear.word()));
        self.title.to_owned() + &gear.unwrap_or_default()
    }

    /// How it is abbreviated.
    pub fn symbol(&self) -> String {
        let gear = match self.gear {
            None => "",
            Some(GearName::Driving) => "1",
            Some(GearName::Driven) => "2",
        };
        self.symbol.to_owned() + gear
    }

    /// Label of an axis over it.
    pub fn at_axis(&self) -> String {
        let title = self.title();
        match self.unit {
            "1" => title,
            unit => format!("{title} in {}", unit.replace("um", "µm")),
        }
    }

    /// The names that lead to it in a row of a table, joined by dots. The numbers of one gear that a row has of the pair are those of the study's.
    pub(super) fn column(&self) -> String {
        let of_pair = matches!(self.of, Of::Pair(_));
        let gear = self.gear.filter(|_| of_pair).map(GearName::word);
        let own = gear.and_then(|gear| self.name.strip_suffix(gear)?.strip_suffix('.'));
        format!("{}{}", self.within, own.unwrap_or(self.name))
    }

    /// True if a row of a study of `gear` has it.
    pub(super) fn is_in_rows_of(&self, gear: GearName) -> bool {
        matches!(self.of, Of::Curve(_)) || self.gear.is_none_or(|own| own == gear)
    }

    /// True if the method of this name computes it.
    fn is_known_to(&self, method: &str) -> bool {
        let method = Method::of_word(method);
        self.needs.iter().all(|needs| match needs {
            Needs::Method(tells) => method.is_some_and(tells),
            _ => true,
        })
    }

    /// True if it is a stress.
    pub(crate) fn is_stress(&self) -> bool {
        self.needs
            .iter()
            .any(|needs| matches!(needs, Needs::Stress))
    }

    /// The reason why a computation of `submission` does not have it, and the change that would help; `None` where it has it.
    pub(crate) fn why_absent(&self, submission: &Submission) -> Option<String> {
        let mut needs = self.needs.iter();
        needs.find_map(|needs| needs.unmet(submission))
    }
}

/// Condition on a submission that has a quantity.
#[derive(Debug, Clone, Copy)]
enum Needs {
    /// Stresses that are asked for.
    Stress,
    /// A run-up that is asked for.
    Dynamics,
    /// One of some methods.
    Method(fn(Method) -> bool),
    /// A span of whole true periods, of which there is a spectrum.
    WholePeriods,
    /// Teeth that deviate.
    Deviations,
    /// No torque of 0.
    Load,
}

impl Needs {
    /// The fields of a submission that have to be given.
    fn pointers(self) -> &'static [&'static str] {
        match self {
            Self::Stress => &["/stress"],
            Self::Dynamics => &["/dynamics"],
            Self::Deviations => &[
                "/pair/driving/tooth_deviations",
                "/pair/driven/tooth_deviations",
            ],
            Self::Method(_) | Self::WholePeriods | Self::Load => &[],
        }
    }

    fn unmet(self, submission: &Submission) -> Option<String> {
        let case = submission.case();
        match self {
            Self::Stress => {
                (!case.stress).then(|| "the submission has to ask for it by /base/stress".to_owned())
            }
            Self::Dynamics => submission
                .forces()
                .is_none_or(|forces| forces.dynamics.is_none())
                .then(|| "the submission has to ask for it by /base/dynamics".to_owned()),
            Self::Method(tells) => (!tells(case.method())).then(|| {
                let methods = Method::OPTIONS.iter().filter(|(_, method, _)| tells(*method));
                let methods: Vec<&str> = methods.map(|(word, ..)| *word).collect();
                format!(
                    "the method {} does not tell it; {} would",
                    case.method().word(),
                    methods.join(", ")
                )
            }),
            Self::WholePeriods => (!case.covers_whole_periods()).then(|| {
                format!(
                    "/base/resolution/span_mesh_periods is {}, a part of the true period of {} mesh periods; leave it out, or give whole periods",
                    case.span(),
                    case.pair.period()
                )
            }),
            Self::Deviations => case.pair.is_as_drawn().then(|| {
                "teeth do not deviate, so that it is hole_order_um; ask for that, for /base/pair/driving/tooth_deviations or those of the driven gear, or for a percent of a population with accuracy".to_owned()
            }),
            Self::Load => case.output_torques.contains(&0.0).then(|| {
                "there is none at the torque 0; leave it out of /base/output_torques_n_m".to_owned()
            }),
        }
    }
}

/// Where a number of a design stands.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Of {
    /// A value of the pair, for any torque.
    Pair(fn(&Summary) -> Option<f64>),
    /// A value of a curve, for the study's gear.
    Curve(fn(&CurveSummary, GearName) -> Option<f64>),
}

/// Name, title, symbol and unit.
type Names = [&'static str; 4];

const fn pair(names: Names, of: fn(&Summary) -> Option<f64>) -> Quantity {
    quantity(names, Of::Pair(of))
}

const fn curve(names: Names, of: fn(&CurveSummary, GearName) -> Option<f64>) -> Quantity {
    quantity(names, Of::Curve(of))
}

const fn quantity([name, title, symbol, unit]: Names, of: Of) -> Quantity {
    Quantity {
        name,
        title,
        symbol,
        unit,
        of,
        gear: None,
        better: None,
        within: "",
        in_every_table: true,
        needs: &[],
        absent: |_| None,
    }
}

/// A number of both gears, each by the name that ends with it.
macro_rules! of_gears {
    ($name:literal, $title:literal, $symbol:literal, $unit:literal, |$gear:ident| $of:expr) => {
        [
            of_gears!(@one driving Driving $name, $title, $symbol, $unit, |$gear| $of),
            of_gears!(@one driven Driven $name, $title, $symbol, $unit, |$gear| $of),
        ]
    };
    (@one $member:ident $Gear:ident $name:literal, $title:literal, $symbol:literal, $unit:literal, |$gear:ident| $of:expr) => {
        pair([concat!($name, ".", stringify!($member)), $title, $symbol, $unit], |design| {
            let $gear = &design.$member;
            $of
        })
        .gear(GearName::$Gear)
    };
}

/// A stress of both gears.
macro_rules! stresses {
    ($name:literal, $title:literal, $symbol:literal, |$stress:ident| $of:expr) => {
        [
            stresses!(@one driving Driving $name, $title, $symbol, |$stress| $of),
            stresses!(@one driven Driven $name, $title, $symbol, |$stress| $of),
        ]
    };
    (@one $member:ident $Gear:ident $name:literal, $title:literal, $symbol:literal, |$stress:ident| $of:expr) => {
        curve(
            [concat!("stress.", stringify!($member), ".", $name), $title, $symbol, "MPa"],
            |curve, _| {
                let $stress = stress(curve, GearName::$Gear)?;
                $of
            },
        )
        .gear(GearName::$Gear)
        .in_statistics()
        .where_known()
        .needs(STRESS)
    };
}

/// Conditions of stresses.
const STRESS: &[Needs] = &[
    Needs::Method(Method::computes_stress),
    Needs::Stress,
    Needs::Load,
];

const MASS: [Quantity; 2] = of_gears! { "mass_kg", "Mass", "m_", "kg", |gear| gear.mass_kg };
const REMOVED: [Quantity; 2] = of_gears! {
    "mass_removed_percent", "Mass removed by holes", "Δm_", "%", |gear| gear.mass_removed_percent
};
const LIGAMENT: [Quantity; 2] = of_gears! {
    "least_ligament_mm", "Least ligament", "s_", "mm", |gear| gear.least_ligament_mm
};
const INERTIA: [Quantity; 2] = of_gears! {
    "polar_inertia_kg_m2", "Polar inertia", "J_", "kg m^2", |gear| gear.polar_inertia_kg_m2
};
const ROOT: [Quantity; 2] = stresses! {
    "root_mpa", "Root stress", "σ_root", |stress| Some(stress.root_mpa)
};
const TENSION: [Quantity; 2] = stresses! {
    "root_tension_mpa", "Root tension", "σ_tension", |stress| stress.root_tension_mpa
};
const COMPRESSION: [Quantity; 2] = stresses! {
    "root_compression_mpa", "Root compression", "σ_compression", |stress| stress.root_compression_mpa
};
const HOLE: [Quantity; 2] = stresses! {
    "hole_mpa", "Hole stress", "σ_hole", |stress| stress.hole_mpa
};

/// Every number that has a name, in the order of the columns of a table: a row each.
#[rustfmt::skip]
pub(crate) const QUANTITIES: &[Quantity] = &[
    MASS[0].smaller(), MASS[1].smaller(),
    REMOVED[0].larger(), REMOVED[1].larger(),
    LIGAMENT[0].larger().or(|_| Some(f64::INFINITY)), LIGAMENT[1].larger().or(|_| Some(f64::INFINITY)),
    INERTIA[0], INERTIA[1],
    pair(["pair_mass_kg", "Mass of both gears", "m", "kg"], Summary::pair_mass).smaller(),
    pair(["contact_ratio", "Contact ratio", "ε", "1"], |design| design.contact_ratio).larger(),
    pair(["backlash_mm", "Backlash", "j_bn", "mm"], |design| design.backlash_mm),
    curve(["transmission_error_um.mean", "Mean transmission error", "STE mean", "um"],
        |curve, _| Some(ste(curve)?.mean)).in_statistics(),
    curve(["transmission_error_um.rms", "Rms of the transmission error", "STE rms", "um"],
        |curve, _| Some(ste(curve)?.rms)).in_statistics().smaller(),
    curve(["transmission_error_um.peak_to_peak", "Peak-to-peak transmission error", "STE p-p", "um"],
        |curve, _| Some(ste(curve)?.peak_to_peak)).in_statistics().smaller(),
    curve(["mesh_stiffness_tangent_n_per_m.mean", "Mean mesh stiffness", "k mean", "N/m"],
        |curve, _| Some(stiffness(curve)?.mean)).in_statistics().larger(),
    curve(["mesh_stiffness_tangent_n_per_m.rms", "Rms of the mesh stiffness", "k rms", "N/m"],
        |curve, _| Some(stiffness(curve)?.rms)).in_statistics().smaller(),
    curve(["mesh_stiffness_tangent_n_per_m.peak_to_peak", "Peak-to-peak mesh stiffness", "k p-p", "N/m"],
        |curve, _| Some(stiffness(curve)?.peak_to_peak)).in_statistics().smaller(),
    ROOT[0].smaller(), TENSION[0].smaller(), COMPRESSION[0].larger(),
    HOLE[0].smaller().or(|design| design.driving.has_no_holes().then_some(0.0)),
    ROOT[1].smaller(), TENSION[1].smaller(), COMPRESSION[1].larger(),
    HOLE[1].smaller().or(|design| design.driven.has_no_holes().then_some(0.0)),
    curve(["face_load_factor", "Face load factor", "K_Hβ", "1"],
        |curve, _| curve.face_load_factor).smaller().where_known()
        .needs(&[Needs::Method(Method::sees_faces), Needs::Load]),
    curve(["hole_order_of_holes_um", "Amplitude of the holes alone", "H_N of holes", "um"],
        CurveSummary::hole_order_of_holes).smaller().where_known()
        .needs(&[Needs::Method(Method::sees_holes), Needs::WholePeriods, Needs::Deviations]),
    curve(["hole_order_um", "Amplitude at the order of the holes", "H_N", "um"],
        CurveSummary::hole_order).smaller()
        .needs(&[Needs::Method(Method::sees_holes), Needs::WholePeriods])
        .or(|design| (design.driving.has_no_holes() && design.driven.has_no_holes()).then_some(0.0)),
    curve(["mesh_order_um", "Amplitude at the mesh order", "H_Z2", "um"],
        |curve, _| curve.mesh_order()).smaller().needs(&[Needs::WholePeriods]),
    curve(["peak_contact_pressure_mpa", "Largest contact pressure", "p_max", "MPa"],
        |curve, _| curve.peak_contact_pressure_mpa).smaller().where_known().or(|_| Some(f64::INFINITY)),
    curve(["pressure_unbounded_share", "Share of the period in which a sharp corner carries", "t_∞", "1"],
        |curve, _| curve.pressure_unbounded_share).smaller().where_known(),
    curve(["pitch_point_pressure_mpa", "Hertz's pressure at the pitch point", "p_C", "MPa"],
        |curve, _| curve.pitch_point_pressure_mpa).smaller().where_known(),
    curve(["smooth_contact_pressure_mpa", "Largest contact pressure away from kinks and corners", "p_smooth", "MPa"],
        |curve, _| curve.smooth_contact_pressure_mpa).smaller().where_known().or(|_| Some(f64::INFINITY)),
    curve(["dynamic_transmission_error_um.peak_to_peak", "Peak-to-peak dynamic transmission error", "DTE p-p", "um"],
        |curve, _| curve.dynamic_peak_to_peak_um).smaller().where_known().needs(&[Needs::Dynamics]),
    curve(["transmission_error_um.tooth_to_tooth", "Tooth-to-tooth transmission error", "f_i'", "um"],
        |curve, _| ste(curve)?.tooth_to_tooth).in_statistics().smaller().where_known(),
    curve(["transmission_error_um.long_wave", "Long-wave transmission error", "f_l'", "um"],
        |curve, _| ste(curve)?.long_wave).in_statistics().smaller().where_known().needs(&[Needs::WholePeriods]),
    curve(["transmission_error_um.short_wave", "Short-wave transmission error", "f_k'", "um"],
        |curve, _| ste(curve)?.short_wave).in_statistics().smaller().where_known().needs(&[Needs::WholePeriods]),
    curve(["transmission_error_um.mesh_harmonics_rms", "Rms of the mesh harmonics", "STE mesh rms", "um"],
        |curve, _| ste(curve)?.mesh_harmonics_rms).in_statistics().smaller().where_known()
        .needs(&[Needs::WholePeriods]),
];

/// All of them, as clients see them.
pub fn quantities() -> impl Iterator<Item = QuantityEntry> {
    QUANTITIES.iter().map(QuantityEntry::of)
}

fn ste(curve: &CurveSummary) -> Option<&TransmissionErrorStatistics> {
    Some(&curve.statistics.as_ref()?.transmission_error_um)
}

fn stiffness(curve: &CurveSummary) -> Option<&StatisticsValues> {
    Some(&curve.statistics.as_ref()?.mesh_stiffness_tangent_n_per_m)
}

fn stress(curve: &CurveSummary, gear: GearName) -> Option<&GearPeakStress> {
    let stress = curve.statistics.as_ref()?.stress.as_ref()?;
    Some(match gear {
        GearName::Driving => &stress.driving,
        GearName::Driven => &stress.driven,
    })
}
