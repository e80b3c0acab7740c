//! The numbers of what carries the teeth.

use super::{Preset, Quantity, needed};

pub(in crate::wire) const BORE_RADIUS: Quantity = needed(
    "bore_radius_mm",
    "Bore radius",
    "mm",
    (0.02, 7_500.0),
    "The radius on which the hub is rigid: at least 5 % of the root radius, and a module below it.",
);

pub(in crate::wire) const HOLE_COUNT: Quantity = needed(
    "count",
    "Number of holes",
    "1",
    (1.0, 60.0),
    "The number N of equal, evenly spaced holes.",
)
.or(Preset::Absent(
    "none; needed unless at_deg says where each hole stands",
))
.counted();

pub(in crate::wire) const HOLE_CIRCLE: Quantity = needed(
    "circle_radius_mm",
    "Radius of the hole circle",
    "mm",
    (0.1, 7_500.0),
    "The radius R of the circle through the holes' centers.",
);

pub(in crate::wire) const HOLE_RADIUS: Quantity = needed(
    "radius_mm",
    "Radius of a hole",
    "mm",
    (0.05, 3_750.0),
    "The radius r of each hole: at least 1 % of the root radius. At least 0.5 mm of material has to be left between holes, to the bore and to the root circle; below one module there is a warning.",
).or(Preset::Absent("none; needed unless the holes are slots"));

pub(in crate::wire) const HOLE_PHASE: Quantity = needed(
    "phase_deg",
    "Phase of the holes",
    "deg",
    (-360.0, 360.0),
    "The angle of a hole's center from the centerline of tooth 0 of its own gear, positive towards the loaded flank of that tooth.",
)
.or(Preset::Value(0.0));

pub(in crate::wire) const HOLE_ANGLES: Quantity = needed(
    "at_deg",
    "Angles of the holes",
    "deg",
    (-360.0, 360.0),
    "The angle of each hole's center from the centerline of tooth 0 of its own gear, positive towards the loaded flank of that tooth; instead of count and phase_deg. Unequal angles spread the order of the holes over those of a revolution.",
);

pub(in crate::wire) const SLOT_WIDTH: Quantity = needed(
    "width_mm",
    "Width of a slot",
    "mm",
    (0.1, 7_500.0),
    "The width across the hole circle, which is the diameter of the round ends: at least 2 % of the root radius.",
);

pub(in crate::wire) const SLOT_ANGLE: Quantity = needed(
    "angle_deg",
    "Angle of a slot",
    "deg",
    (0.0, 350.0),
    "The angle between the centers of the ends; with 0 the slot is a round hole.",
);

pub(in crate::wire) const WEB_INNER: Quantity = needed(
    "inner_radius_mm",
    "Inner radius of the web",
    "mm",
    (0.02, 7_500.0),
    "Where the web begins: at the bore, or at least 0.1 modules outside of it.",
);

pub(in crate::wire) const WEB_OUTER: Quantity = needed(
    "outer_radius_mm",
    "Outer radius of the web",
    "mm",
    (0.1, 7_500.0),
    "Where the web ends: at least half a module below the root circle, and 0.1 modules outside of its inner radius.",
);

pub(in crate::wire) const WEB_THICKNESS: Quantity = needed(
    "thickness_mm",
    "Thickness of the web",
    "mm",
    (0.001, 8_000.0),
    "Its thickness, symmetric to the middle of the face: 1 % to four times the face width. A web as thick as the face is wide is none.",
);
