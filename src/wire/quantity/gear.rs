//! The numbers of a gear: rack, teeth and material.

use super::{Preset, Quantity, needed};

pub(in crate::wire) const CENTER_DISTANCE: Quantity = needed(
    "center_distance_mm",
    "Center distance",
    "mm",
    (0.5, 20_000.0),
    "The operating center distance, not the reference one. Teeth have to reach each other with a contact ratio of at least one, without negative backlash and without interference.",
);

pub(in crate::wire) const TOOTH_COUNT: Quantity = needed(
    "tooth_count",
    "Number of teeth",
    "1",
    (5.0, 300.0),
    "The number of teeth Z. Few teeth need profile shift against undercut.",
)
.counted();

pub(in crate::wire) const MODULE: Quantity = needed(
    "module_mm",
    "Module",
    "mm",
    (0.1, 50.0),
    "The module m, the same for both gears.",
);

pub(in crate::wire) const PRESSURE_ANGLE: Quantity = needed(
    "pressure_angle_deg",
    "Pressure angle",
    "deg",
    (12.0, 32.0),
    "The pressure angle of the basic rack, the same for both gears.",
)
.or(Preset::Value(20.0));

pub(in crate::wire) const PROFILE_SHIFT: Quantity = needed(
    "profile_shift",
    "Profile shift coefficient",
    "1",
    (-2.0, 2.0),
    "The profile shift x in modules, positive outward.",
)
.or(Preset::Value(0.0));

pub(in crate::wire) const ADDENDUM: Quantity = needed(
    "addendum_mm",
    "Addendum of the basic rack",
    "mm",
    (0.02, 100.0),
    "The tip radius is the reference radius plus the addendum plus the profile shift; tips are not shortened. Between 0.2 and 2 modules.",
)
.or(Preset::ModulesUnless(1.0, TIP_DIAMETER.name));

pub(in crate::wire) const TIP_DIAMETER: Quantity = needed(
    "tip_diameter_mm",
    "Tip diameter",
    "mm",
    (0.1, 16_000.0),
    "The diameter of the tip circle, said instead of the addendum, which it then decides: the same bounds hold for that.",
)
.or(Preset::Absent("the addendum decides"));

pub(in crate::wire) const DEDENDUM: Quantity = needed(
    "dedendum_mm",
    "Dedendum of the basic rack",
    "mm",
    (0.05, 125.0),
    "The root radius is the reference radius less the dedendum plus the profile shift. Between 0.5 and 2.5 modules.",
)
.or(Preset::Modules(1.25));

pub(in crate::wire) const RACK_TIP_RADIUS: Quantity = needed(
    "rack_tip_radius_mm",
    "Tip rounding of the basic rack",
    "mm",
    (0.005, 50.0),
    "The radius of the rack's tip rounding, which generates the fillet. At least 0.05 modules, and it has to fit between the rack's flanks; where the default does not, the largest that does is taken.",
)
.or(Preset::Modules(0.38));

pub(in crate::wire) const THICKNESS_DEVIATION: Quantity = needed(
    "tooth_thickness_deviation_um",
    "Deviation of the tooth thickness",
    "um",
    (-25_000.0, 25_000.0),
    "How much thicker the teeth are than the rack leaves them, as a transverse arc on the reference circle; negative is thinner and gives backlash. Half a module to either side, and a space has to be left between fillets.",
)
.or(Preset::Value(0.0));

pub(in crate::wire) const TIP_ROUNDING: Quantity = needed(
    "tip_rounding_mm",
    "Rounding of the tip edges",
    "mm",
    (0.001, 50.0),
    "The radius of an arc between flank and tip circle, tangent to both, on both flanks alike: 0, or at least 0.01 modules. Not together with tip_chamfer_mm.",
)
.or(Preset::Absent("sharp edges"))
.or_zero();

pub(in crate::wire) const TIP_CHAMFER: Quantity = needed(
    "tip_chamfer_mm",
    "Chamfer of the tip edges",
    "mm",
    (0.001, 50.0),
    "How far below the tip circle a cut at 45 deg begins, on both flanks alike: 0, or at least 0.01 modules. Not together with tip_rounding_mm.",
)
.or(Preset::Absent("sharp edges"))
.or_zero();

pub(in crate::wire) const FACE_WIDTH: Quantity = needed(
    "face_width_mm",
    "Face width",
    "mm",
    (0.1, 2_000.0),
    "The width of the gear. Contact is on the smaller of the two widths; each body has its own.",
);

pub(in crate::wire) const YOUNGS_MODULUS: Quantity = needed(
    "youngs_modulus_gpa",
    "Young's modulus",
    "GPa",
    (0.1, 1_000.0),
    "Young's modulus E of teeth and blank.",
)
.or(Preset::Value(210.0));

pub(in crate::wire) const POISSON_RATIO: Quantity = needed(
    "poisson_ratio",
    "Poisson's ratio",
    "1",
    (0.0, 0.49),
    "Poisson's ratio of teeth and blank.",
)
.or(Preset::Value(0.3));

pub(in crate::wire) const DENSITY: Quantity = needed(
    "density_kg_m3",
    "Density",
    "kg/m3",
    (10.0, 25_000.0),
    "The density, for mass and inertia only.",
)
.or(Preset::Value(7850.0));
