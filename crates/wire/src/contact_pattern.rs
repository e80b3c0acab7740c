//! The contact pattern of a pair along its faces, for pages that draw it and let its lines move.

use meshwright_engine::analysis::contact_pattern::{
    ContactPattern, FlankBands, PatternCurve, PatternLine, PatternPosition, Pressure,
};
use serde::{Deserialize, Serialize};

use super::declare::document;
use super::units::{or_null, rounded_json, significant, to_mm, to_mpa, to_n_per_mm};

/// Significant digits of a place, and of the values there.
const DIGITS: (usize, usize) = (6, 5);

/// Positions at which lines are told, of all curves together: some 100 places each.
const MOST_POSITIONS: usize = 160;

document! {
    /// Where the flanks touch over the period, and how they press there. z is that of the common face; +z is the side from which the driving
    /// gear is seen to turn counter-clockwise.
    pub struct ContactPatternDocument as ContactPattern, "Contact pattern"
    answer of (pattern: &ContactPattern) with {
        let (flanks, torques) = (&pattern.flanks, pattern.curves.len());
        let [driving, driven] = flanks.each_ref().map(PatternFlank::of);
    } {
        /// The width of the common face, in mm.
        face_width_mm: f64 = place(pattern.face_width),
        /// The middles of equal strips of the common face, in mm from its middle.
        z_mm: Vec<f64> = pattern.heights.iter().map(|z| place(*z)).collect(),
        /// The flank of gear 1.
        driving: PatternFlank = driving,
        /// The flank of gear 2.
        driven: PatternFlank = driven,
        /// One entry for each output torque that was asked for, torque 0 aside.
        curves: Vec<PatternCurveDocument> = pattern
            .curves
            .iter()
            .map(|curve| PatternCurveDocument::of(curve, flanks, torques))
            .collect(),
    }
}

document! {
    /// The height of a flank, in equal bands.
    pub struct PatternFlank as PatternFlank, "Flank of a contact pattern"
    answer of (flank: &FlankBands) with {
        let [form, tip] = flank.ends;
    } {
        /// The diameter of the form circle, at which it begins, in mm.
        form_diameter_mm: f64 = place(2.0 * form),
        /// The diameter of the tip circle, at which it ends, in mm.
        tip_diameter_mm: f64 = place(2.0 * tip),
        /// The diameters of the middles of the bands, rising, in mm.
        diameter_mm: Vec<f64> = flank.radii.iter().map(|r| place(2.0 * r)).collect(),
    }
}

document! {
    /// The pattern at one output torque.
    pub struct PatternCurveDocument as PatternCurve, "Contact pattern at a torque"
    answer of (curve: &PatternCurve, flanks: &[FlankBands; 2], torques: usize) with {
        let [driving, driven] = curve.largest.each_ref().map(|map| PatternPressure::of(map));
        let pressures = driving.pressure_mpa.iter().chain(&driven.pressure_mpa);
        let pressures = pressures.flat_map(|row| &row.0).flatten();
        let step = (curve.positions.len() * torques).div_ceil(MOST_POSITIONS);
        let positions = curve.positions.iter().step_by(step.max(1));
    } {
        /// The output torque, in N m.
        output_torque_n_m: f64 = curve.output_torque,
        /// The largest pressure of the pattern, in MPa, edges where it has no limit aside.
        largest_pressure_mpa: f64 = pressures.copied().fold(0.0, f64::max),
        /// Of the flank of gear 1.
        driving: PatternPressure = driving,
        /// Of the flank of gear 2.
        driven: PatternPressure = driven,
        /// The lines of contact at mesh positions of the span, equally spaced: all positions of the job, or as many as make an answer of a bounded size.
        positions: Vec<PatternPositionDocument> =
            positions.map(|position| PatternPositionDocument::of(position, flanks)).collect(),
    }
}

document! {
    /// The pressure on a flank.
    pub struct PatternPressure as PatternPressure, "Pressure of a contact pattern"
    answer of (map: &[Vec<Pressure>]) {
        /// The largest pressure over the span, in MPa: a row for each band from the form circle up, with a value for each strip. 0 where nothing
        /// touches; null where a sharp tip edge carries, at which pressure has no limit.
        #[schema(value_type = Vec<Vec<Option<f64>>>)]
        pressure_mpa: Vec<Row> = map.iter().map(|row| Row::of(row)).collect(),
    }
}

/// The pressures of a band.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row(#[serde(serialize_with = "or_null")] pub(super) Vec<Option<f64>>);

impl Row {
    fn of(row: &[Pressure]) -> Self {
        let cell = |pressure: &Pressure| match pressure {
            Pressure::Of(pressure) => Some(rounded(to_mpa(*pressure))),
            Pressure::Unlimited => None,
        };
        Self(row.iter().map(cell).collect())
    }
}

document! {
    /// The lines of contact at a mesh position.
    pub struct PatternPositionDocument as PatternPosition, "Contact lines at a position"
    answer of (position: &PatternPosition, flanks: &[FlankBands; 2]) {
        /// The mesh position, in mesh periods.
        mesh_position: f64 = significant(position.mesh_position, 10),
        /// One entry for each pair of teeth that carries.
        lines: Vec<PatternLineDocument> = position
            .lines
            .iter()
            .map(|line| PatternLineDocument::of(line, flanks))
            .collect(),
    }
}

document! {
    /// The line of contact of one pair of teeth, slice by slice along z. All lists have one entry a slice.
    pub struct PatternLineDocument as PatternLine, "Contact line"
    answer of (line: &PatternLine, flanks: &[FlankBands; 2]) with {
        let slices = || line.slices.iter();
        let diameters = |g: usize| {
            let radii = slices().map(|slice| flanks[g].radius(slice.roll_lengths[g]));
            radii.map(|radius| place(2.0 * radius)).collect()
        };
    } {
        /// 0 for the pair that passed the pitch point last in the middle of the face, 1 for the next, -1 for the one before.
        pair_offset: i32 = line.pair_offset,
        /// The middles of the slices, in mm from the middle of the common face.
        z_mm: Vec<f64> = slices().map(|slice| place(slice.z)).collect(),
        /// How long each of them is loaded along z, in mm; the last ones of a line may be shorter than the others.
        length_mm: Vec<f64> = slices().map(|slice| place(slice.length)).collect(),
        /// Where they touch the flank of gear 1: the diameter, in mm.
        driving_diameter_mm: Vec<f64> = diameters(0),
        /// Where they touch the flank of gear 2: the diameter, in mm.
        driven_diameter_mm: Vec<f64> = diameters(1),
        /// The load on each for its width, along the transverse line of action, in N/mm.
        load_n_per_mm: Vec<f64> = slices()
            .map(|slice| rounded(to_n_per_mm(slice.force / slice.length)))
            .collect(),
        /// The largest pressure on each, in MPa; null at a sharp tip edge, where it has no limit.
        #[serde(serialize_with = "or_null")]
        pressure_mpa: Vec<Option<f64>> = slices()
            .map(|slice| slice.pressure.map(|pressure| rounded(to_mpa(pressure))))
            .collect(),
    }
}

impl ContactPatternDocument {
    /// The document as JSON.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, which no solution has.
    pub fn to_json(&self) -> serde_json::Result<String> {
        rounded_json(self)
    }
}

fn place(length: f64) -> f64 {
    significant(to_mm(length), DIGITS.0)
}

fn rounded(value: f64) -> f64 {
    significant(value, DIGITS.1)
}
