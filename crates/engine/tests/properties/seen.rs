//! Pairs on which a defect was once seen, each the instance of a class; what must hold of drawn pairs must hold of them.

use meshwright_engine::gear::{
    GearData, GearPair, HolePattern, Material, ModificationData, Rack, ReliefData, ReliefShape,
    ReliefStart, SpurGear,
};

use crate::drawn::DrawnPair;

/// What the drawings of both gears share: module, pressure angle in degrees, addendum, dedendum, rounding of the rack; in millimeters.
type SharedRack = [f64; 5];

/// Teeth, profile shift, face width, (E in GPa, ν, density), bore radius, in millimeters, and what the rest adds.
fn gear(
    rack: SharedRack,
    tooth_count: u32,
    [profile_shift, face_width, bore_radius]: [f64; 3],
    [youngs_modulus, poisson_ratio, density]: [f64; 3],
) -> GearData {
    let [module, pressure_angle, addendum, dedendum, tip_radius] = rack;
    GearData {
        rack: Rack {
            pressure_angle: pressure_angle.to_radians(),
            addendum: addendum * 1e-3,
            dedendum: dedendum * 1e-3,
            tip_radius: tip_radius * 1e-3,
            ..Rack::profile_a(module * 1e-3)
        },
        profile_shift,
        face_width: face_width * 1e-3,
        material: Material {
            youngs_modulus: youngs_modulus * 1e9,
            poisson_ratio,
            density,
            yield_strength: None,
        },
        ..GearData::plain(tooth_count, module * 1e-3, bore_radius * 1e-3)
    }
}

fn relieved(data: GearData, amount_um: f64, shape: ReliefShape, start: ReliefStart) -> GearData {
    GearData {
        modifications: vec![ModificationData::TipRelief(ReliefData {
            amount: amount_um * 1e-6,
            shape,
            start,
        })],
        ..data
    }
}

/// With N holes of the radius r on the circle R, in millimeters, hole 0 at an angle in degrees.
fn holed(mut data: GearData, count: u32, [circle, radius, phase]: [f64; 3]) -> GearData {
    data.blank.holes = HolePattern {
        count,
        circle_radius: circle * 1e-3,
        radius: radius * 1e-3,
        phase: phase.to_radians(),
    }
    .holes();
    data
}

fn pair(
    driving: GearData,
    driven: GearData,
    center_distance: f64,
    output_torque: f64,
) -> DrawnPair {
    let gear = |data| SpurGear::new(data).expect("a gear that can be made");
    DrawnPair {
        pair: GearPair::new(gear(driving), gear(driven), center_distance * 1e-3)
            .expect("a pair that meshes"),
        output_torque,
    }
}

const STEEL: [f64; 3] = [210.0, 0.3, 7850.0];
const ALUMINUM: [f64; 3] = [70.0, 0.33, 2700.0];
const POLYMER: [f64; 3] = [3.0, 0.38, 1400.0];

/// The pairs by name.
pub(crate) fn pairs() -> Vec<(&'static str, DrawnPair)> {
    vec![
        ("recess-lost-pair", {
            let rack = [2.0, 20.0, 2.0, 2.5, 0.2];
            pair(
                gear(rack, 40, [1.1, 20.0, 16.0], STEEL),
                gear(rack, 80, [-1.1, 20.0, 16.0], STEEL),
                120.2,
                115.0,
            )
        }),
        ("approach-wrong-carrier", {
            let rack = [2.0, 20.0, 2.0, 2.5, 0.2];
            pair(
                gear(rack, 40, [-1.1, 20.0, 16.0], STEEL),
                gear(rack, 80, [1.1, 20.0, 16.0], STEEL),
                120.2,
                115.0,
            )
        }),
        ("lost-pair-approach", {
            let rack = [
                3.1258646138394375,
                22.5,
                2.5565581988266297,
                3.338024352286489,
                0.15632448933811027,
            ];
            pair(
                gear(
                    rack,
                    119,
                    [-0.9620631413197323, 31.258646138394376, 71.8574564165718],
                    STEEL,
                ),
                gear(
                    rack,
                    118,
                    [0.7993903414772469, 31.258646138394376, 73.43470953812363],
                    STEEL,
                ),
                369.99818040438527,
                1280.2358349037952,
            )
        }),
        ("lost-pair-recess-2", {
            let rack = [
                4.563148596572517,
                20.0,
                4.203768377476081,
                5.34455552661921,
                0.22820306131459156,
            ];
            pair(
                gear(
                    rack,
                    99,
                    [1.0211712911704673, 45.63148596572517, 90.07642253915401],
                    STEEL,
                ),
                gear(
                    rack,
                    118,
                    [-1.0604731580075746, 45.63148596572517, 103.61684602739768],
                    STEEL,
                ),
                495.0589307515056,
                1442.6529443390637,
            )
        }),
        ("hcr-recess", {
            let rack = [
                3.678836781390933,
                15.0,
                3.678836781390933,
                4.5985459767386665,
                0.18397862743736054,
            ];
            pair(
                relieved(
                    gear(
                        rack,
                        137,
                        [1.1631394776090043, 36.78836781390933, 100.67230953626245],
                        STEEL,
                    ),
                    12.18615223359934,
                    ReliefShape::Linear,
                    ReliefStart::RadialLength(1.471_534_712_556_373e-3),
                ),
                gear(
                    rack,
                    125,
                    [-1.0383236536792266, 36.78836781390933, 88.60357184482051],
                    STEEL,
                ),
                482.4941691828507,
                64.45919723426198,
            )
        }),
        ("unequal-width-pressure", {
            let rack = [2.0, 20.0, 2.0, 2.5, 0.2];
            pair(
                relieved(
                    gear(rack, 50, [0.0, 20.0, 15.0], STEEL),
                    8.0,
                    ReliefShape::Linear,
                    ReliefStart::RadialLength(1.0e-3),
                ),
                relieved(
                    gear(rack, 50, [0.0, 40.0, 15.0], STEEL),
                    8.0,
                    ReliefShape::Linear,
                    ReliefStart::RadialLength(1.0e-3),
                ),
                100.5,
                115.0,
            )
        }),
        ("unequal-width-2", {
            let rack = [
                6.592988120218401,
                20.0,
                6.592988120218401,
                8.241235150273,
                1.97789643606552,
            ];
            pair(
                gear(
                    rack,
                    104,
                    [0.0, 107.99677884633144, 234.21590297075866],
                    POLYMER,
                ),
                relieved(
                    gear(
                        rack,
                        102,
                        [0.0, 62.17848231868102, 262.40092718469236],
                        ALUMINUM,
                    ),
                    25.281043618318854,
                    ReliefShape::Linear,
                    ReliefStart::Diameter(677.220894973596e-3),
                ),
                679.4074257885062,
                2.7127795261981222,
            )
        }),
        ("not-converged-not-pd", {
            let rack = [2.0, 20.0, 2.0, 2.5, 0.2];
            pair(
                gear(rack, 200, [0.0, 20.0, 15.0], STEEL),
                gear(rack, 200, [0.0, 20.0, 15.0], STEEL),
                400.2,
                2500.0,
            )
        }),
        ("similarity", {
            let rack = [
                2.3217192314687165,
                20.0,
                2.3217192314687165,
                2.9021490393358955,
                0.6965157694406149,
            ];
            pair(
                relieved(
                    gear(
                        rack,
                        147,
                        [-0.007890934618422107, 25.361120951304418, 25.15888409084354],
                        STEEL,
                    ),
                    11.479119914172747,
                    ReliefShape::Parabolic,
                    ReliefStart::RollLength(2.3384476223784816e-3),
                ),
                relieved(
                    gear(
                        rack,
                        114,
                        [0.0, 13.684689412519814, 103.54867772350477],
                        POLYMER,
                    ),
                    20.633076996384663,
                    ReliefShape::Linear,
                    ReliefStart::RollLength(1.6142049283974842e-3),
                ),
                303.08212094964676,
                0.017874429123753192,
            )
        }),
        ("corner-pressure-grid", {
            let rack = [2.0, 20.0, 2.0, 2.5, 0.2];
            pair(
                gear(rack, 50, [0.0, 20.0, 15.0], STEEL),
                gear(rack, 50, [0.0, 20.0, 15.0], STEEL),
                100.5,
                115.0,
            )
        }),
        ("fine-pp-2pct", {
            let rack = [
                2.9035265868277795,
                25.0,
                2.9035265868277795,
                3.6294082335347246,
                0.580705317365556,
            ];
            pair(
                relieved(
                    gear(
                        rack,
                        63,
                        [0.3210475696543707, 11.911086003645334, 44.38192470283412],
                        ALUMINUM,
                    ),
                    8.882660017710718,
                    ReliefShape::Linear,
                    ReliefStart::RollLength(4.70344196297296e-3),
                ),
                gear(
                    rack,
                    125,
                    [0.0, 11.911086003645334, 142.2728027545612],
                    STEEL,
                ),
                273.8855566675024,
                1.586321664331949,
            )
        }),
        ("projected-14pct", {
            let rack = [
                3.002740000060762,
                22.5,
                3.5697416539455364,
                4.320426653960727,
                0.6005480000121524,
            ];
            pair(
                holed(
                    relieved(
                        gear(
                            rack,
                            45,
                            [0.6986114476685552, 58.45520848038839, 19.60169156574634],
                            POLYMER,
                        ),
                        10.926692800999163,
                        ReliefShape::Parabolic,
                        ReliefStart::RollLength(5.421872219429957e-3),
                    ),
                    5,
                    [42.21571659253571, 18.37872773633689, -149.08935500092332],
                ),
                holed(
                    relieved(
                        gear(
                            rack,
                            45,
                            [0.04845125826125546, 37.42512951637579, 9.508006481796114],
                            STEEL,
                        ),
                        3.5760851676656533,
                        ReliefShape::Parabolic,
                        ReliefStart::RollAngle(f64::to_radians(29.585995879777474)),
                    ),
                    10,
                    [48.88089008291546, 7.7739287336497656, 68.81859850666675],
                ),
                137.42149653627257,
                0.5153916487364921,
            )
        }),
        // Light contacts on measured profiles, narrower than a cell, which let flanks penetrate between cells.
        ("a narrow contact at a kink", DrawnPair::as_made(841)),
        ("a narrow contact at an edge", DrawnPair::as_made(447)),
    ]
}
