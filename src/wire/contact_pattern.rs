//! The contact pattern of a pair along its faces, for pages that draw it and let its lines move.

use meshwright_engine::analysis::contact_pattern::{
    ContactPattern, FlankBands, PatternCurve, PatternLine, PatternPosition, Pressure,
};
use serde::Serialize;
use utoipa::ToSchema;

use super::units::{or_null, rounded_json, significant, to_mm, to_mpa, to_n_per_mm};

/// Digits of a place, and of what acts there.
const DIGITS: (usize, usize) = (6, 5);

/// Positions at which lines are told, of all curves together: some 100 places each.
const MOST_POSITIONS: usize = 160;

/// Where the flanks touch over the period, and how they press there. z is that of the common face; +z is the side from which the driving
/// gear is seen to turn counter-clockwise.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Contact pattern")]
pub struct ContactPatternDocument {
    /// The width of the common face, in mm.
    pub face_width_mm: f64,
    /// The middles of equal strips of the common face, in mm from its middle.
    pub z_mm: Vec<f64>,
    /// The flank of gear 1.
    pub driving: PatternFlank,
    /// The flank of gear 2.
    pub driven: PatternFlank,
    /// One entry for each output torque that was asked for, torque 0 aside.
    pub curves: Vec<PatternCurveDocument>,
}

/// The height of a flank, in equal bands.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Flank of a contact pattern")]
pub struct PatternFlank {
    /// The diameter of the form circle, at which it begins, in mm.
    pub form_diameter_mm: f64,
    /// The diameter of the tip circle, at which it ends, in mm.
    pub tip_diameter_mm: f64,
    /// The diameters of the middles of the bands, rising, in mm.
    pub diameter_mm: Vec<f64>,
}

/// The pattern at one output torque.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = PatternCurve, title = "Contact pattern at a torque")]
pub struct PatternCurveDocument {
    /// The output torque, in N m.
    pub output_torque_n_m: f64,
    /// The largest pressure of the pattern, in MPa, edges where it has no limit aside.
    pub largest_pressure_mpa: f64,
    /// Of the flank of gear 1.
    pub driving: PatternPressure,
    /// Of the flank of gear 2.
    pub driven: PatternPressure,
    /// The lines of contact at mesh positions of the span, equally spaced: all positions of the job, or as many as make an answer of a bounded size.
    pub positions: Vec<PatternPositionDocument>,
}

/// The pressure on a flank.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Pressure of a contact pattern")]
pub struct PatternPressure {
    /// The largest pressure over the span, in MPa: a row for each band from the form circle up, with a value for each strip. 0 where nothing
    /// touches; null where a sharp tip edge carries, at which pressure has no limit.
    #[schema(value_type = Vec<Vec<Option<f64>>>)]
    pub pressure_mpa: Vec<Row>,
}

/// The pressures of a band.
#[derive(Debug, Clone, Serialize)]
pub struct Row(#[serde(serialize_with = "or_null")] Vec<Option<f64>>);

/// The lines of contact at a mesh position.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = PatternPosition, title = "Contact lines at a position")]
pub struct PatternPositionDocument {
    /// The mesh position, in mesh periods.
    pub mesh_position: f64,
    /// One entry for each pair of teeth that carries.
    pub lines: Vec<PatternLineDocument>,
}

/// The line of contact of one pair of teeth, slice by slice along z. All lists have one entry a slice.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = PatternLine, title = "Contact line")]
pub struct PatternLineDocument {
    /// 0 for the pair that passed the pitch point last in the middle of the face, 1 for the next, -1 for the one before.
    pub pair_offset: i32,
    /// The middles of the slices, in mm from the middle of the common face.
    pub z_mm: Vec<f64>,
    /// Where they touch the flank of gear 1: the diameter, in mm.
    pub driving_diameter_mm: Vec<f64>,
    /// Where they touch the flank of gear 2: the diameter, in mm.
    pub driven_diameter_mm: Vec<f64>,
    /// The load on each for its width, along the transverse line of action, in N/mm.
    pub load_n_per_mm: Vec<f64>,
    /// The largest pressure on each, in MPa; null at a sharp tip edge, where it has no limit, and at the end of a line that is shorter than
    /// its contact is wide.
    #[serde(serialize_with = "or_null")]
    pub pressure_mpa: Vec<Option<f64>>,
}

impl ContactPatternDocument {
    /// The document of `pattern`.
    pub fn of(pattern: &ContactPattern) -> Self {
        let flanks = &pattern.flanks;
        let [driving, driven] = flanks.each_ref().map(PatternFlank::of);
        let torques = pattern.curves.len();
        Self {
            face_width_mm: place(pattern.face_width),
            z_mm: pattern.heights.iter().map(|z| place(*z)).collect(),
            driving,
            driven,
            curves: pattern
                .curves
                .iter()
                .map(|curve| PatternCurveDocument::of(curve, flanks, torques))
                .collect(),
        }
    }

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

fn told(value: f64) -> f64 {
    significant(value, DIGITS.1)
}

impl PatternFlank {
    fn of(flank: &FlankBands) -> Self {
        let [form_diameter_mm, tip_diameter_mm] = flank.ends.map(|radius| place(2.0 * radius));
        Self {
            form_diameter_mm,
            tip_diameter_mm,
            diameter_mm: flank.radii.iter().map(|r| place(2.0 * r)).collect(),
        }
    }
}

impl PatternCurveDocument {
    fn of(curve: &PatternCurve, flanks: &[FlankBands; 2], torques: usize) -> Self {
        let [driving, driven] = curve.largest.each_ref().map(|map| PatternPressure::of(map));
        let pressures = driving.pressure_mpa.iter().chain(&driven.pressure_mpa);
        let pressures = pressures.flat_map(|row| &row.0).flatten();
        let largest = pressures.copied().fold(0.0, f64::max);
        let step = (curve.positions.len() * torques).div_ceil(MOST_POSITIONS);
        let positions = curve.positions.iter().step_by(step.max(1));
        Self {
            output_torque_n_m: curve.output_torque,
            largest_pressure_mpa: largest,
            driving,
            driven,
            positions: positions
                .map(|position| PatternPositionDocument::of(position, flanks))
                .collect(),
        }
    }
}

impl PatternPressure {
    fn of(map: &[Vec<Pressure>]) -> Self {
        let cell = |pressure: &Pressure| match pressure {
            Pressure::Of(pressure) => Some(told(to_mpa(*pressure))),
            Pressure::Unlimited => None,
        };
        let row = |row: &Vec<Pressure>| Row(row.iter().map(cell).collect());
        Self {
            pressure_mpa: map.iter().map(row).collect(),
        }
    }
}

impl PatternPositionDocument {
    fn of(position: &PatternPosition, flanks: &[FlankBands; 2]) -> Self {
        let lines = position.lines.iter();
        Self {
            mesh_position: significant(position.mesh_position, 10),
            lines: lines
                .map(|line| PatternLineDocument::of(line, flanks))
                .collect(),
        }
    }
}

impl PatternLineDocument {
    fn of(line: &PatternLine, flanks: &[FlankBands; 2]) -> Self {
        let slices = || line.slices.iter();
        let diameters = |g: usize| {
            let radii = slices().map(|slice| flanks[g].radius(slice.roll_lengths[g]));
            radii.map(|radius| place(2.0 * radius)).collect()
        };
        Self {
            pair_offset: line.pair_offset,
            z_mm: slices().map(|slice| place(slice.z)).collect(),
            driving_diameter_mm: diameters(0),
            driven_diameter_mm: diameters(1),
            load_n_per_mm: slices()
                .map(|slice| told(to_n_per_mm(slice.force / slice.length)))
                .collect(),
            pressure_mpa: slices()
                .map(|slice| slice.pressure.map(|pressure| told(to_mpa(pressure))))
                .collect(),
        }
    }
}
