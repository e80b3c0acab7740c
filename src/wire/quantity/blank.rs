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
    "The number N of equal, evenly spaced round holes.",
)
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
);

pub(in crate::wire) const HOLE_PHASE: Quantity = needed(
    "phase_deg",
    "Phase of the holes",
    "deg",
    (-360.0, 360.0),
    "The angle of a hole's center from the centerline of tooth 0 of its own gear, positive towards the loaded flank of that tooth.",
)
.or(Preset::Value(0.0));
