//! The numbers of what is taken off the flanks, and of what teeth deviate by.

use super::{Preset, Quantity, needed};

pub(in crate::wire) const RELIEF_AMOUNT: Quantity = needed(
    "amount_um",
    "Amount of tip relief",
    "um",
    (0.0, 1_000.0),
    "The material taken off at the tip circle, normal to the flank.",
);

pub(in crate::wire) const RELIEF_RADIAL_LENGTH: Quantity = needed(
    "radial_length_mm",
    "Radial length below the tip circle",
    "mm",
    (0.001, 225.0),
    "The relief starts at the tip radius less this length. However the start is given, it is at least 0.01 modules below the tip circle.",
);

pub(in crate::wire) const RELIEF_ROLL_LENGTH: Quantity = needed(
    "roll_length_from_tip_mm",
    "Length along the path of contact from the tip",
    "mm",
    (0.001, 2_000.0),
    "The relief starts where the roll length is this much less than at the tip circle.",
);

pub(in crate::wire) const RELIEF_DIAMETER: Quantity = needed(
    "diameter_mm",
    "Start diameter",
    "mm",
    (0.1, 16_000.0),
    "The relief starts at this diameter.",
);

pub(in crate::wire) const RELIEF_ROLL_ANGLE: Quantity = needed(
    "roll_angle_deg",
    "Start roll angle",
    "deg",
    (0.001, 180.0),
    "The relief starts at this roll angle of the flank, the roll length over the base radius.",
);

pub(in crate::wire) const ROOT_RELIEF_AMOUNT: Quantity = needed(
    "amount_um",
    "Amount of root relief",
    "um",
    (0.0, 1_000.0),
    "The material taken off at the form circle, where the flank ends, normal to the flank.",
);

pub(in crate::wire) const ROOT_RELIEF_RADIAL_LENGTH: Quantity = needed(
    "radial_length_mm",
    "Radial length above the form circle",
    "mm",
    (0.001, 225.0),
    "The relief starts at the form radius plus this length. However the start is given, it is at least 0.01 modules above the form circle.",
);

pub(in crate::wire) const ROOT_RELIEF_ROLL_LENGTH: Quantity = needed(
    "roll_length_from_form_mm",
    "Length along the path of contact from the form circle",
    "mm",
    (0.001, 2_000.0),
    "The relief starts where the roll length is this much more than at the form circle.",
);

pub(in crate::wire) const CROWNING_AMOUNT: Quantity = needed(
    "amount_um",
    "Amount of profile crowning",
    "um",
    (-1_000.0, 1_000.0),
    "The material taken off at the form circle and at the tip circle, normal to the flank; nothing is taken off midway between them. Negative adds.",
);

pub(in crate::wire) const SLOPE_AMOUNT: Quantity = needed(
    "amount_um",
    "Amount of the profile slope",
    "um",
    (-1_000.0, 1_000.0),
    "The material taken off at the tip circle, normal to the flank; nothing is taken off at the form circle. Negative adds.",
);

pub(in crate::wire) const TABLE_ROLL_LENGTH: Quantity = needed(
    "roll_length_mm",
    "Roll lengths",
    "mm",
    (0.0, 2_000.0),
    "Where the entries of the table stand, each larger than the one before: roll lengths, from the base circle along the path of contact.",
);

pub(in crate::wire) const TABLE_DIAMETER: Quantity = needed(
    "diameter_mm",
    "Diameters",
    "mm",
    (0.1, 16_000.0),
    "Where the entries of the table stand, each larger than the one before: diameters, not below the base circle.",
);

pub(in crate::wire) const TABLE_REMOVED: Quantity = needed(
    "removed_um",
    "Material removed",
    "um",
    (-1_000.0, 1_000.0),
    "The material taken off at each entry, normal to the flank; linear between entries, the first and the last held beyond them. Negative adds.",
);

pub(in crate::wire) const PITCH_CUMULATIVE: Quantity = needed(
    "pitch_cumulative_um",
    "Cumulative pitch deviations",
    "um",
    (-1_000.0, 1_000.0),
    "How far the loaded flank of each tooth, tooth 0 first, stands from its place towards its mate, as a transverse arc on the reference circle (ISO 1328-1). Along the base tangent it is times the cosine of the pressure angle.",
);

pub(in crate::wire) const PITCH_SINGLE: Quantity = needed(
    "pitch_single_um",
    "Single pitch deviations",
    "um",
    (-1_000.0, 1_000.0),
    "The deviation of each tooth, tooth 0 first, against the tooth before it, as a transverse arc on the reference circle (ISO 1328-1); that of tooth 0 is against the last tooth. Their sum has to be zero within 0.01 um. Summed up they are cumulative deviations from the last tooth.",
);

pub(in crate::wire) const PROFILE_SLOPES: Quantity = needed(
    "profile_slope_um",
    "Profile slope deviations",
    "um",
    (-1_000.0, 1_000.0),
    "The slope deviation of the loaded flank of each tooth, tooth 0 first: nothing at the form circle, this much towards the mate at the tip circle, linear in the roll length.",
);

pub(in crate::wire) const ECCENTRICITY_AMOUNT: Quantity = needed(
    "amount_um",
    "Amount of the eccentricity",
    "um",
    (0.0, 1_000.0),
    "The distance of the gear's own axis from the axis of rotation.",
);

pub(in crate::wire) const ECCENTRICITY_PHASE: Quantity = needed(
    "phase_deg",
    "Phase of the eccentricity",
    "deg",
    (-360.0, 360.0),
    "The direction of the gear's own axis from the axis of rotation: an angle from the centerline of tooth 0, positive towards the loaded flank of that tooth.",
)
.or(Preset::Value(0.0));
