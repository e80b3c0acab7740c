//! Gear pairs drawn at random over the whole domain that the service admits.

use std::f64::consts::PI;

use meshwright_engine::gear::{
    BlankRegion, Core, Eccentricity, GearData, GearPair, Hole, HolePattern, HoleShape, Material,
    Member, ModificationData, Rack, ReliefData, ReliefShape, ReliefStart, SpurGear, TablePlaces,
    TipEdge, ToothDeviations, Web,
};

/// A stream of pseudo-random numbers (xorshift*), so that a seed names a draw forever.
#[derive(Debug, Clone)]
pub(crate) struct Draw(u64);

impl Draw {
    pub(crate) fn new(seed: u64) -> Self {
        // Neighboring seeds are spread over all bits.
        Self(seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Evenly distributed in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Evenly distributed in its logarithm.
    pub(crate) fn over_decades(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low.ln(), high.ln())).exp()
    }

    pub(crate) fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[(self.unit() * choices.len() as f64) as usize]
    }

    pub(crate) fn chance(&mut self, part: f64) -> bool {
        self.unit() < part
    }
}

/// A pair and a torque.
#[derive(Debug, Clone)]
pub(crate) struct DrawnPair {
    pub(crate) pair: GearPair,
    pub(crate) output_torque: f64,
}

/// Steel, aluminum and a plastic, and anything between.
fn material(draw: &mut Draw) -> Material {
    let (youngs_modulus, poisson_ratio, density) = draw.one_of(&[
        (210e9, 0.3, 7850.0),
        (210e9, 0.3, 7850.0),
        (70e9, 0.33, 2700.0),
        (3e9, 0.38, 1400.0),
        (0.0, 0.25, 5000.0),
    ]);
    Material {
        youngs_modulus: if youngs_modulus == 0.0 {
            draw.over_decades(3e9, 210e9)
        } else {
            youngs_modulus
        },
        poisson_ratio,
        density,
        yield_strength: None,
    }
}

fn tooth_count(draw: &mut Draw) -> u32 {
    if draw.chance(0.05) {
        draw.between(150.0, 300.0) as u32
    } else {
        draw.over_decades(15.0, 150.0) as u32
    }
}

fn relief(draw: &mut Draw, module: f64, data: &GearData) -> Option<ReliefData> {
    let start = match draw.one_of(&[0, 1, 2, 3, 4, 4]) {
        0 => ReliefStart::RadialLength(draw.between(0.2, 1.2) * module),
        1 => ReliefStart::RollLength(draw.between(0.3, 2.0) * module),
        2 => {
            let r = module * f64::from(data.tooth_count) / 2.0 + data.profile_shift * module;
            ReliefStart::Diameter(2.0 * (r + draw.between(-0.2, 0.8) * module))
        }
        3 => {
            let alpha = data.rack.pressure_angle;
            ReliefStart::RollAngle(alpha.tan() * draw.between(1.0, 1.3))
        }
        _ => return None,
    };
    Some(ReliefData {
        amount: draw.over_decades(1e-3, 8e-3) * module,
        shape: draw.one_of(&[ReliefShape::Linear, ReliefShape::Parabolic]),
        start,
    })
}

fn blank(draw: &mut Draw, root_radius: f64, module: f64) -> BlankRegion {
    let bore_radius = root_radius * draw.between(0.15, 0.7);
    let pattern = draw.chance(0.5).then(|| {
        let room = root_radius - module - bore_radius;
        let circle_radius = bore_radius + room * draw.between(0.35, 0.65);
        let count = draw.one_of(&[1, 2, 3, 4, 5, 6, 7, 8, 10, 12]);
        let beside = if count > 1 {
            circle_radius * (PI / f64::from(count)).sin()
        } else {
            f64::INFINITY
        };
        let most = beside
            .min(circle_radius - bore_radius)
            .min(root_radius - circle_radius);
        HolePattern {
            count,
            circle_radius,
            radius: most * draw.between(0.3, 0.85),
            phase: draw.between(-PI, PI),
        }
    });
    BlankRegion {
        bore_radius,
        core: Core::Bore,
        holes: pattern.map_or_else(Vec::new, |pattern| pattern.holes()),
        web: None,
    }
}

/// The same gear as workshops make it: with edges, modifications, deviations and blanks of every kind, each now and then.
fn as_made(draw: &mut Draw, data: &GearData) -> GearData {
    let mut data = data.clone();
    let module = data.rack.module;
    if draw.chance(0.3) {
        data.rack.addendum *= draw.between(0.85, 1.0);
    }
    if draw.chance(0.4) {
        data.thickness_deviation = module * draw.between(-0.05, 0.0);
    }
    data.tip_edge = match draw.one_of(&[0, 0, 1, 2]) {
        0 => TipEdge::Sharp,
        1 => TipEdge::Rounded(module * draw.between(0.02, 0.12)),
        _ => TipEdge::Chamfered(module * draw.between(0.02, 0.1)),
    };
    if draw.chance(0.3) {
        data.modifications
            .push(ModificationData::RootRelief(ReliefData {
                amount: draw.over_decades(1e-3, 6e-3) * module,
                shape: draw.one_of(&[ReliefShape::Linear, ReliefShape::Parabolic]),
                start: match draw.one_of(&[0, 1]) {
                    0 => ReliefStart::RadialLength(draw.between(0.1, 0.5) * module),
                    _ => ReliefStart::RollLength(draw.between(0.2, 1.0) * module),
                },
            }));
    }
    if draw.chance(0.3) {
        let amount = draw.over_decades(0.5e-3, 4e-3) * module;
        data.modifications
            .push(ModificationData::Crowning { amount });
    }
    if draw.chance(0.3) {
        let amount = draw.between(-2e-3, 3e-3) * module;
        data.modifications.push(ModificationData::Slope { amount });
    }
    data.deviations = deviations(draw, data.tooth_count, module);
    if let Ok(bare) = SpurGear::new(GearData {
        blank: BlankRegion::solid(1e-6),
        modifications: Vec::new(),
        ..data.clone()
    }) {
        if draw.chance(0.3) {
            data.modifications.push(table(draw, &bare));
        }
        if draw.chance(0.5) {
            data.blank = irregular_blank(draw, bare.root_radius(), module);
        }
        if draw.chance(0.4) {
            data.blank.web = web(draw, &data.blank, bare.root_radius(), &data);
        }
    }
    data
}

/// A measured profile: hills and hollows of a few thousandths of a module.
fn table(draw: &mut Draw, bare: &SpurGear) -> ModificationData {
    let (from, to) = (bare.form_roll_length(), bare.tip_roll_length());
    let count = draw.between(2.0, 9.0) as usize;
    let module = bare.data().rack.module;
    ModificationData::Table {
        places: TablePlaces::RollLengths(
            (0..count)
                .map(|i| from + (to - from) * i as f64 / (count - 1) as f64)
                .collect(),
        ),
        removed: (0..count)
            .map(|_| draw.between(0.0, 2e-3) * module)
            .collect(),
    }
}

fn deviations(draw: &mut Draw, tooth_count: u32, module: f64) -> ToothDeviations {
    let mut list = |chance: f64| -> Vec<f64> {
        let most = draw.over_decades(0.2e-3, 3e-3) * module;
        let given = draw.chance(chance);
        (0..tooth_count)
            .filter(|_| given)
            .map(|_| draw.between(-most, most))
            .collect()
    };
    let (cumulative_pitch, profile_slope) = (list(0.4), list(0.3));
    ToothDeviations {
        cumulative_pitch,
        profile_slope,
        eccentricity: draw.chance(0.3).then(|| Eccentricity {
            amount: draw.over_decades(0.5e-3, 10e-3) * module,
            direction: draw.between(-PI, PI),
        }),
        ..ToothDeviations::default()
    }
}

/// Holes and kidneys at any angles on up to two circles.
fn irregular_blank(draw: &mut Draw, root_radius: f64, module: f64) -> BlankRegion {
    let bore_radius = root_radius * draw.between(0.15, 0.5);
    let room = root_radius - 1.2 * module - bore_radius;
    let circles = draw.one_of(&[1, 1, 2]);
    let mut holes = Vec::new();
    for circle in 0..circles {
        let half = 0.5 * room / f64::from(circles);
        let circle_radius = bore_radius + half * f64::from(2 * circle + 1);
        let (count, first) = (draw.one_of(&[1, 2, 3, 5]), draw.between(-PI, PI));
        let pitch = 2.0 * PI / f64::from(count);
        for i in 0..count {
            let angle = first + pitch * (f64::from(i) + draw.between(-0.15, 0.15));
            let beside = 0.35 * circle_radius * (pitch / 2.0).min(1.0);
            let radius = half.min(beside) * draw.between(0.3, 0.8);
            let shape = if draw.chance(0.4) {
                HoleShape::Slot {
                    width: 2.0 * radius,
                    angle: 0.4 * pitch * draw.unit(),
                }
            } else {
                HoleShape::Round { radius }
            };
            holes.push(Hole {
                circle_radius,
                angle,
                shape,
            });
        }
    }
    BlankRegion {
        bore_radius,
        core: Core::Bore,
        holes,
        web: None,
    }
}

fn web(draw: &mut Draw, blank: &BlankRegion, root_radius: f64, data: &GearData) -> Option<Web> {
    let room = root_radius - 1.5 * data.rack.module - blank.bore_radius;
    let inner_radius = blank.bore_radius + room * draw.between(0.0, 0.3);
    let outer_radius = blank.bore_radius + room * draw.between(0.6, 1.0);
    (outer_radius > inner_radius).then(|| Web {
        inner_radius,
        outer_radius,
        thickness: data.face_width * draw.between(0.2, 1.2),
    })
}

impl DrawnPair {
    /// The first pair as workshops make it that can be made of the numbers that `seed` names.
    pub(crate) fn as_made(seed: u64) -> Self {
        let mut draw = Draw::new(!seed);
        loop {
            let Some((drawn, output_torque)) = Self::drawn(&mut draw) else {
                continue;
            };
            let mut gear =
                |member: Member| SpurGear::new(as_made(&mut draw, drawn.gear(member).data())).ok();
            let (Some(driving), Some(driven)) = (gear(Member::Driving), gear(Member::Driven))
            else {
                continue;
            };
            let distance = drawn.center_distance() + 0.02 * driving.data().rack.module;
            if let Ok(pair) = GearPair::new(driving, driven, distance) {
                return Self {
                    pair,
                    output_torque,
                };
            }
        }
    }

    /// The first pair that can be made of the numbers that `seed` names.
    pub(crate) fn of(seed: u64) -> Self {
        let mut draw = Draw::new(seed);
        loop {
            if let Some((pair, output_torque)) = Self::drawn(&mut draw) {
                return Self {
                    pair,
                    output_torque,
                };
            }
        }
    }

    fn drawn(draw: &mut Draw) -> Option<(GearPair, f64)> {
        let module = draw.over_decades(0.5e-3, 10e-3);
        let pressure_angle = draw.between(15.0, 25.0).to_radians();
        // Long teeth now and then: contact ratios to 2.9.
        let addendum = module
            * if draw.chance(0.3) {
                draw.between(1.0, 1.45)
            } else {
                1.0
            };
        let rack = Rack {
            module,
            pressure_angle,
            addendum,
            dedendum: addendum + 0.25 * module,
            tip_radius: module * draw.between(0.05, 0.3),
            protuberance: None,
        };
        let width = module * draw.between(5.0, 15.0);
        let shifts = if draw.chance(0.3) {
            // The path of contact moves beside the pitch point.
            let x = draw.between(-1.2, 1.2);
            [x, -x + draw.between(-0.1, 0.1)]
        } else {
            [draw.between(-0.3, 0.6), draw.between(-0.3, 0.6)]
        };
        let mut gears = Vec::new();
        for profile_shift in shifts {
            let tooth_count = tooth_count(draw);
            let mut data = GearData {
                rack,
                profile_shift,
                face_width: if draw.chance(0.3) {
                    width * draw.between(1.0, 2.0)
                } else {
                    width
                },
                material: material(draw),
                ..GearData::plain(tooth_count, rack.module, 1e-6)
            };
            let bare = SpurGear::new(data.clone()).ok()?;
            data.blank = blank(draw, bare.root_radius(), module);
            let relief = relief(draw, module, &data);
            data.modifications
                .extend(relief.map(ModificationData::TipRelief));
            gears.push(SpurGear::new(data).ok()?);
        }
        let driven = gears.pop()?;
        let driving = gears.pop()?;
        // From the distance without backlash, found by what the pair says of a near one.
        let sum = f64::from(driving.tooth_count() + driven.tooth_count());
        let near = module * (sum / 2.0 + shifts[0] + shifts[1]);
        let distance = match GearPair::new(driving.clone(), driven.clone(), near * 0.98) {
            Ok(_) => near,
            Err(meshwright_engine::gear::GearPairError::NegativeBacklash { smallest, .. }) => {
                smallest
            }
            Err(_) => near,
        };
        let pair = GearPair::new(
            driving.clone(),
            driven.clone(),
            distance + module * draw.between(0.0, 0.15),
        )
        .ok()?;
        // A line load that strains the softer gear as steel is strained by 5 to 300 N/mm.
        let softer = driving
            .material()
            .youngs_modulus
            .min(driven.material().youngs_modulus);
        let line_load = draw.over_decades(5e3, 300e3) * (module / 2e-3) * softer / 210e9;
        let load = line_load * pair.common_face_width();
        Some((pair, load * driven.base_radius()))
    }
}
