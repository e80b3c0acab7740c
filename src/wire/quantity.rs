//! Numbers of the submission: one table of titles, units, defaults and bounds, used by the check and by the schema.

use super::problem::Code;
use super::units::plain;

/// What stands for a number that is not given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Preset {
    /// Nothing: it has to be given.
    Needed,
    /// This value.
    Value(f64),
    /// So many times the module.
    Modules(f64),
    /// Nothing, and that means something.
    Absent(&'static str),
}

/// A number of the submission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Quantity {
    /// The field.
    pub(super) name: &'static str,
    /// Its title in a form.
    pub(super) title: &'static str,
    /// Its unit; "1" for a pure number.
    pub(super) unit: &'static str,
    /// What it is.
    pub(super) description: &'static str,
    /// The smallest and the largest value that are accepted, in its unit.
    pub(super) bounds: (f64, f64),
    /// Its default.
    pub(super) preset: Preset,
    /// Whether it counts.
    pub(super) whole: bool,
}

impl Quantity {
    /// Checks `value`, which stands at `place`.
    ///
    /// # Errors
    ///
    /// The code, a sentence with the numbers, and the nearest value that is accepted.
    pub(super) fn check(
        &self,
        value: f64,
        place: &str,
    ) -> Result<f64, (Code, String, Option<f64>)> {
        let (least, most) = self.bounds;
        if !(least..=most).contains(&value) {
            let code = if self.name == OUTPUT_TORQUE.name && value <= 0.0 {
                Code::TorqueNotPositive
            } else {
                Code::OutOfRange
            };
            let detail = format!(
                "{place} is {}{unit}; it has to lie between {}{unit} and {}{unit}.",
                plain(value),
                plain(least),
                plain(most),
                unit = self.spoken_unit()
            );
            return Err((code, detail, Some(value.clamp(least, most))));
        }
        if self.whole && value.fract() != 0.0 {
            let detail = format!("{place} is {}; a whole number is expected.", plain(value));
            return Err((Code::WrongType, detail, Some(value.round())));
        }
        Ok(value)
    }

    fn spoken_unit(&self) -> String {
        match self.unit {
            "1" => String::new(),
            unit => format!(" {unit}"),
        }
    }
}

const fn needed(
    name: &'static str,
    title: &'static str,
    unit: &'static str,
    bounds: (f64, f64),
    description: &'static str,
) -> Quantity {
    Quantity {
        name,
        title,
        unit,
        description,
        bounds,
        preset: Preset::Needed,
        whole: false,
    }
}

impl Quantity {
    const fn or(self, preset: Preset) -> Self {
        Self { preset, ..self }
    }

    const fn counted(self) -> Self {
        Self {
            whole: true,
            ..self
        }
    }
}

/// The most output torques of one submission.
pub(super) const MOST_TORQUES: usize = 60;
/// The most positions times torques of one submission.
pub(super) const MOST_POSITIONS: u64 = 20_000;
/// The most tags, and the most characters of one.
pub(super) const MOST_TAGS: (usize, usize) = (16, 64);

pub(super) const CENTER_DISTANCE: Quantity = needed(
    "center_distance_mm",
    "Center distance",
    "mm",
    (0.5, 20_000.0),
    "The operating center distance, not the reference one. Teeth have to reach each other with a contact ratio of at least one, without negative backlash and without interference.",
);

pub(super) const TOOTH_COUNT: Quantity = needed(
    "tooth_count",
    "Number of teeth",
    "1",
    (5.0, 300.0),
    "The number of teeth Z. Few teeth need profile shift against undercut.",
)
.counted();

pub(super) const MODULE: Quantity = needed(
    "module_mm",
    "Module",
    "mm",
    (0.1, 50.0),
    "The module m, the same for both gears.",
);

pub(super) const PRESSURE_ANGLE: Quantity = needed(
    "pressure_angle_deg",
    "Pressure angle",
    "deg",
    (12.0, 32.0),
    "The pressure angle of the basic rack, the same for both gears.",
)
.or(Preset::Value(20.0));

pub(super) const PROFILE_SHIFT: Quantity = needed(
    "profile_shift",
    "Profile shift coefficient",
    "1",
    (-2.0, 2.0),
    "The profile shift x in modules, positive outward.",
)
.or(Preset::Value(0.0));

pub(super) const ADDENDUM: Quantity = needed(
    "addendum_mm",
    "Addendum of the basic rack",
    "mm",
    (0.02, 100.0),
    "The tip radius is the reference radius plus the addendum plus the profile shift; tips are not shortened. Between 0.2 and 2 modules.",
)
.or(Preset::Modules(1.0));

pub(super) const DEDENDUM: Quantity = needed(
    "dedendum_mm",
    "Dedendum of the basic rack",
    "mm",
    (0.05, 125.0),
    "The root radius is the reference radius less the dedendum plus the profile shift. Between 0.5 and 2.5 modules.",
)
.or(Preset::Modules(1.25));

pub(super) const RACK_TIP_RADIUS: Quantity = needed(
    "rack_tip_radius_mm",
    "Tip rounding of the basic rack",
    "mm",
    (0.005, 50.0),
    "The radius of the rack's tip rounding, which generates the fillet. At least 0.05 modules, and it has to fit between the rack's flanks; where the default does not, the largest that does is taken.",
)
.or(Preset::Modules(0.38));

pub(super) const FACE_WIDTH: Quantity = needed(
    "face_width_mm",
    "Face width",
    "mm",
    (0.1, 2_000.0),
    "The width of the gear. Contact is on the smaller of the two widths; each body has its own.",
);

pub(super) const RELIEF_AMOUNT: Quantity = needed(
    "amount_um",
    "Amount of tip relief",
    "um",
    (0.0, 1_000.0),
    "The material taken off at the tip circle, normal to the flank.",
);

pub(super) const RELIEF_RADIAL_LENGTH: Quantity = needed(
    "radial_length_mm",
    "Radial length below the tip circle",
    "mm",
    (0.001, 225.0),
    "The relief starts at the tip radius less this length. However the start is given, it is at least 0.01 modules below the tip circle.",
);

pub(super) const RELIEF_ROLL_LENGTH: Quantity = needed(
    "roll_length_from_tip_mm",
    "Length along the path of contact from the tip",
    "mm",
    (0.001, 2_000.0),
    "The relief starts where the roll length is this much less than at the tip circle.",
);

pub(super) const RELIEF_DIAMETER: Quantity = needed(
    "diameter_mm",
    "Start diameter",
    "mm",
    (0.1, 16_000.0),
    "The relief starts at this diameter.",
);

pub(super) const RELIEF_ROLL_ANGLE: Quantity = needed(
    "roll_angle_deg",
    "Start roll angle",
    "deg",
    (0.001, 180.0),
    "The relief starts at this roll angle of the flank, the roll length over the base radius.",
);

pub(super) const YOUNGS_MODULUS: Quantity = needed(
    "youngs_modulus_gpa",
    "Young's modulus",
    "GPa",
    (0.1, 1_000.0),
    "Young's modulus E of teeth and blank.",
)
.or(Preset::Value(210.0));

pub(super) const POISSON_RATIO: Quantity = needed(
    "poisson_ratio",
    "Poisson's ratio",
    "1",
    (0.0, 0.49),
    "Poisson's ratio of teeth and blank.",
)
.or(Preset::Value(0.3));

pub(super) const DENSITY: Quantity = needed(
    "density_kg_m3",
    "Density",
    "kg/m3",
    (10.0, 25_000.0),
    "The density, for mass and inertia only.",
)
.or(Preset::Value(7850.0));

pub(super) const BORE_RADIUS: Quantity = needed(
    "bore_radius_mm",
    "Bore radius",
    "mm",
    (0.02, 7_500.0),
    "The radius on which the hub is rigid: at least 5 % of the root radius, and a module below it.",
);

pub(super) const HOLE_COUNT: Quantity = needed(
    "count",
    "Number of holes",
    "1",
    (1.0, 60.0),
    "The number N of equal, evenly spaced round holes.",
)
.counted();

pub(super) const HOLE_CIRCLE: Quantity = needed(
    "circle_radius_mm",
    "Radius of the hole circle",
    "mm",
    (0.1, 7_500.0),
    "The radius R of the circle through the holes' centers.",
);

pub(super) const HOLE_RADIUS: Quantity = needed(
    "radius_mm",
    "Radius of a hole",
    "mm",
    (0.05, 3_750.0),
    "The radius r of each hole: at least 1 % of the root radius. At least 0.5 mm of material has to be left between holes, to the bore and to the root circle; below one module there is a warning.",
);

pub(super) const HOLE_PHASE: Quantity = needed(
    "phase_deg",
    "Phase of the holes",
    "deg",
    (-360.0, 360.0),
    "The angle of a hole's center from the centerline of tooth 0 of its own gear, positive towards the loaded flank of that tooth.",
)
.or(Preset::Value(0.0));

pub(super) const OUTPUT_TORQUE: Quantity = needed(
    "output_torques_n_m",
    "Output torque",
    "N m",
    (1e-6, 1e8),
    "A torque T on the driven gear. The load on the line of action is T over the driven base radius; one that would deflect the teeth by more than about a quarter of a module is refused.",
);

pub(super) const DRIVING_SPEED: Quantity = needed(
    "driving_speed_rpm",
    "Speed of the driving gear",
    "1/min",
    (1e-3, 1e6),
    "The speed that turns orders into frequencies. It changes nothing else: the analysis is quasi-static.",
)
.or(Preset::Absent("no frequencies beside the orders"));

pub(super) const POSITIONS: Quantity = needed(
    "positions_per_mesh_period",
    "Positions in a mesh period",
    "1",
    (8.0, 400.0),
    "The number of positions at which one mesh period is computed.",
)
.or(Preset::Value(40.0))
.counted();

pub(super) const SPAN: Quantity = needed(
    "span_mesh_periods",
    "Mesh periods",
    "1",
    (1.0, 20_000.0),
    "How many mesh periods are computed. A span shorter than the true period gives curves and statistics marked as partial and no spectrum; a longer one has to be a whole multiple of it.",
)
.or(Preset::Absent("the true period of the pair, which is filled in"))
.counted();

pub(super) const BLANK_POSITIONS: Quantity = needed(
    "blank_positions",
    "Positions in a hole period",
    "1",
    (8.0, 64.0),
    "The number of positions over one hole period at which the decomposition samples a holed blank.",
)
.or(Preset::Value(16.0))
.counted();

pub(super) const INTERFACE_RADIUS: Quantity = needed(
    "interface_radius_mm",
    "Interface radius of holed gears",
    "mm",
    (0.1, 7_500.0),
    "The radius between holes and tooth roots at which the decomposition cuts the blank.",
)
.or(Preset::Absent(
    "for each holed gear one module below its root circle, or halfway to the holes where they come closer",
));

pub(super) const PENALTY: Quantity = needed(
    "penalty_n_per_m",
    "Penalty stiffness",
    "N/m",
    (1e5, 1e18),
    "The penalty stiffness of a contact cell, eq. 7 of the paper. It changes the number of iterations, not the result.",
)
.or(Preset::Absent(
    "100 times Young's modulus of the softer gear times the common face width",
));

pub(super) const GAP_TOLERANCE: Quantity = needed(
    "gap_tolerance_um",
    "Gap tolerance",
    "um",
    (1e-9, 1.0),
    "The penetration that the augmented Lagrangian leaves. The paper's value is 0.01.",
)
.or(Preset::Value(1e-6));

pub(super) const TORQUE_STEP: Quantity = needed(
    "torque_step_percent",
    "Torque step",
    "%",
    (0.01, 10.0),
    "The step to either side of the torque in the central difference.",
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_outside_its_bounds_is_answered_with_the_nearer_bound() {
        let (code, detail, nearest) = TOOTH_COUNT.check(-3.0, "/z").expect_err("negative");
        assert_eq!((code, nearest), (Code::OutOfRange, Some(5.0)));
        assert!(detail.contains("-3"), "{detail}");
        let (_, detail, nearest) = MODULE.check(1e308, "/m").expect_err("enormous");
        assert_eq!(nearest, Some(50.0));
        assert!(detail.contains("1e308 mm"), "{detail}");
        let (code, _, nearest) = TOOTH_COUNT.check(30.4, "/z").expect_err("a fraction");
        assert_eq!((code, nearest), (Code::WrongType, Some(30.0)));
        let (code, ..) = OUTPUT_TORQUE.check(0.0, "/t").expect_err("no load");
        assert_eq!(code, Code::TorqueNotPositive);
    }
}
