//! The numbers of the load, the speed and the resolution.

use super::{Preset, Quantity, needed};

pub(in crate::wire) const OUTPUT_TORQUE: Quantity = needed(
    "output_torques_n_m",
    "Output torque",
    "N m",
    (1e-6, 1e8),
    "A torque T on the driven gear; 0 is the limit of light load, the kinematic error of the flanks. The load on the line of action is T over the driven base radius; one that would deflect the teeth by more than about a quarter of a module is refused.",
)
.or_zero();

pub(in crate::wire) const DRIVING_SPEED: Quantity = needed(
    "driving_speed_rpm",
    "Speed of the driving gear",
    "1/min",
    (1e-3, 1e6),
    "The speed that turns orders into frequencies. It changes nothing else: the analysis is quasi-static.",
)
.or(Preset::Absent("no frequencies beside the orders"));

pub(in crate::wire) const POSITIONS: Quantity = needed(
    "positions_per_mesh_period",
    "Positions in a mesh period",
    "1",
    (8.0, 400.0),
    "The number of positions at which one mesh period is computed.",
)
.or(Preset::Value(40.0))
.counted();

pub(in crate::wire) const SPAN: Quantity = needed(
    "span_mesh_periods",
    "Mesh periods",
    "1",
    (1.0, 20_000.0),
    "How many mesh periods are computed. A span shorter than the true period gives curves and statistics marked as partial and no spectrum; a longer one has to be a whole multiple of it.",
)
.or(Preset::Absent("the true period of the pair, which is filled in"))
.counted();

pub(in crate::wire) const BLANK_POSITIONS: Quantity = needed(
    "blank_positions",
    "Positions in a hole period",
    "1",
    (8.0, 64.0),
    "The number of positions over one hole period at which the decomposition samples a holed blank.",
)
.or(Preset::Value(16.0))
.counted();

pub(in crate::wire) const INTERFACE_RADIUS: Quantity = needed(
    "interface_radius_mm",
    "Interface radius of holed gears",
    "mm",
    (0.1, 7_500.0),
    "The radius between holes and tooth roots at which the decomposition cuts the blank: one for both gears, or one for each.",
)
.or(Preset::Absent(
    "for each holed gear one module below its root circle, or halfway to the holes where they come closer",
));

pub(in crate::wire) const PENALTY: Quantity = needed(
    "penalty_n_per_m",
    "Penalty stiffness",
    "N/m",
    (1e5, 1e18),
    "The penalty stiffness of a contact cell, eq. 7 of the paper. It changes the number of iterations, not the result.",
)
.or(Preset::Absent(
    "100 times Young's modulus of the softer gear times the common face width",
));

pub(in crate::wire) const GAP_TOLERANCE: Quantity = needed(
    "gap_tolerance_um",
    "Gap tolerance",
    "um",
    (1e-9, 1.0),
    "The penetration that the augmented Lagrangian leaves. The paper's value is 0.01.",
)
.or(Preset::Value(1e-6));

pub(in crate::wire) const TORQUE_STEP: Quantity = needed(
    "torque_step_percent",
    "Torque step",
    "%",
    (0.01, 10.0),
    "The step to either side of the torque in the central difference.",
);
