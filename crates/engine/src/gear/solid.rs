//! A gear with an extent along its axis: a transverse section that turns along it, and the layers under the teeth.
//!
//! Everything stands in the frame of its gear: z = 0 is the middle of its face, the x axis the centerline of tooth 0 there, the
//! loaded flank lies on the side of positive y. The section at z is that at 0, turned counter-clockwise by τ z.

use super::{GearData, GearError, Hole, Rack, SpurGear, ToolDepth, Web};

/// The largest helix angle, in radians (45 degrees): beyond, teeth are those of a worm.
pub const LARGEST_HELIX_ANGLE: f64 = std::f64::consts::FRAC_PI_4;

/// Hand of a helix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hand {
    /// As a common screw: the section turns counter-clockwise along +z.
    Right,
    /// The other way.
    Left,
}

impl Hand {
    /// The hand of a mate with parallel axis.
    pub fn opposite(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }
}

/// Helix of the teeth of a gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Helix {
    /// The angle β at the reference circle, in radians; 0 of straight teeth.
    pub angle: f64,
    /// The hand.
    pub hand: Hand,
}

impl Helix {
    /// Straight teeth.
    pub const STRAIGHT: Self = Self {
        angle: 0.0,
        hand: Hand::Right,
    };

    /// The helix of the angle `beta`: right-handed if it is positive.
    pub fn right(beta: f64) -> Self {
        Self {
            angle: beta.abs(),
            hand: if beta < 0.0 { Hand::Left } else { Hand::Right },
        }
    }

    /// β with its sign: positive is right-handed.
    pub fn signed(&self) -> f64 {
        match self.hand {
            Hand::Right => self.angle,
            Hand::Left => -self.angle,
        }
    }
}

/// The ring on the bore, where it is not as wide as the face. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hub {
    /// Where it ends.
    pub outer_radius: f64,
    /// How wide it is.
    pub width: f64,
    /// Where its middle stands from that of the face.
    pub offset: f64,
}

/// A ring between two radii and two heights. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// The inner radius.
    pub inner_radius: f64,
    /// The outer radius.
    pub outer_radius: f64,
    /// Where it begins and ends along the axis.
    pub heights: [f64; 2],
}

/// A spur or helical gear that can be made. Lengths are in meters, angles in radians.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidGear {
    section: SpurGear,
    helix: Helix,
    web_offset: f64,
    hub: Option<Hub>,
}

/// Why a gear with an extent along its axis cannot be made as drawn. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SolidGearError {
    /// Its section cannot be made; the numbers are those of the normal section.
    #[error(transparent)]
    Section(#[from] GearError),
    /// The teeth wind too much.
    #[error("the helix angle {angle} rad is too large: at most {largest} rad")]
    HelixAngle {
        /// The angle asked for.
        angle: f64,
        /// The largest.
        largest: f64,
    },
    /// The web stands out of the face on one side, or on both.
    #[error("the web stands out of the face by {beyond} m; an offset of {nearest} m would do")]
    WebBeyondFace {
        /// By how much.
        beyond: f64,
        /// The nearest offset that would do.
        nearest: f64,
    },
    /// The web is thicker than the face is wide, which no offset mends.
    #[error("the web is {thickness} m thick on a face {face_width} m wide")]
    WebThickerThanFace {
        /// The thickness of the web.
        thickness: f64,
        /// The most that would do.
        face_width: f64,
    },
    /// The web stands out of the hub.
    #[error("the hub is narrower than its web; a width of {nearest} m would do")]
    HubNarrowerThanWeb {
        /// The width asked for.
        width: f64,
        /// The least that would do at its offset.
        nearest: f64,
    },
    /// The hub does not end between the bore and the rim.
    #[error("the hub ends at {outer_radius} m; it must end between {least} m and {largest} m")]
    HubOutside {
        /// Where it was to end.
        outer_radius: f64,
        /// The bore radius.
        least: f64,
        /// Where the rim begins.
        largest: f64,
    },
    /// The hub and the face stand beside each other, neither within the other.
    #[error("the hub and the face reach past each other; an offset of {nearest} m would do")]
    HubBesideFace {
        /// The offset asked for.
        offset: f64,
        /// The nearest that would do.
        nearest: f64,
    },
    /// A hole crosses an edge between parts of unlike width, or stands outside of the web.
    #[error(
        "hole {hole} reaches from {from} m to {to} m; it must lie between {inner_radius} m and {outer_radius} m"
    )]
    HoleAcrossEdge {
        /// Its place in the list.
        hole: usize,
        /// The smallest radius that it reaches.
        from: f64,
        /// The largest.
        to: f64,
        /// Where the part in which it may stand begins.
        inner_radius: f64,
        /// Where that part ends.
        outer_radius: f64,
    },
}

impl SolidGear {
    /// Checks a drawing: `normal` is its normal section, as ISO 21771 has it: the rack with its module, its pressure angle and its round tips, the profile
    /// shift in normal modules.
    ///
    /// `web_offset` is where the middle of the web stands from that of the face; without a `hub` the blank is as wide as the face
    /// inside the web. With straight teeth the section is the gear of [`SpurGear::new`], to the last digit.
    ///
    /// # Errors
    ///
    /// [`SolidGearError`] with the part that cannot be made and the value that would do.
    pub fn new(
        normal: GearData,
        helix: Helix,
        web_offset: f64,
        hub: Option<Hub>,
    ) -> Result<Self, SolidGearError> {
        // This form refuses values that are not numbers as well.
        if !(helix.angle >= 0.0 && helix.angle <= LARGEST_HELIX_ANGLE) {
            return Err(SolidGearError::HelixAngle {
                angle: helix.angle,
                largest: LARGEST_HELIX_ANGLE,
            });
        }
        let rack = normal.rack;
        let cos = helix.angle.cos();
        let transverse = GearData {
            rack: Rack {
                module: rack.module / cos,
                pressure_angle: transverse_angle(rack.pressure_angle, cos),
                ..rack
            },
            profile_shift: normal.profile_shift * cos,
            tool_depth: match normal.tool_depth {
                ToolDepth::At(x_e) => ToolDepth::At(x_e * cos),
                depth => depth,
            },
            ..normal
        };
        let section =
            SpurGear::cut_by(rack, transverse).map_err(|error| in_normal_section(error, cos))?;
        let gear = Self {
            section,
            helix,
            web_offset,
            hub,
        };
        gear.check_layers()?;
        gear.check_holes()?;
        Ok(gear)
    }

    /// The transverse section.
    pub fn section(&self) -> &SpurGear {
        &self.section
    }

    /// The rack in the normal section.
    pub fn normal_rack(&self) -> &Rack {
        self.section.normal_rack()
    }

    /// How the teeth wind.
    pub fn helix(&self) -> Helix {
        self.helix
    }

    /// τ: by how much the section turns along the axis, in radians a meter, positive if right-handed.
    pub fn twist(&self) -> f64 {
        self.helix.signed().tan() / self.section.reference_radius()
    }

    /// The helix angle β_b at the base circle, without a sign: tan β_b = |τ| r_b.
    pub fn base_helix_angle(&self) -> f64 {
        self.helix_angle_at(self.section.base_radius())
    }

    /// The helix angle β_y at `radius`, without a sign: tan β_y = |τ| r_y.
    pub fn helix_angle_at(&self, radius: f64) -> f64 {
        (self.twist().abs() * radius).atan()
    }

    /// The face width b.
    pub fn face_width(&self) -> f64 {
        self.section.face_width()
    }

    /// Where the middle of the web stands from that of the face.
    pub fn web_offset(&self) -> f64 {
        self.web_offset
    }

    /// The hub, where it is not as wide as the face.
    pub fn hub(&self) -> Option<Hub> {
        self.hub
    }

    /// The same gear with teeth that all are as drawn.
    pub fn as_drawn(&self) -> Self {
        Self {
            section: self.section.as_drawn(),
            ..self.clone()
        }
    }

    /// The same gear seen from its other side, holes left where they are: parts at z are then at −z.
    pub(super) fn turned_over(&self) -> Self {
        let hub = self.hub.map(|hub| Hub {
            offset: 0.0 - hub.offset,
            ..hub
        });
        Self {
            section: self.section.turned_over(),
            web_offset: 0.0 - self.web_offset,
            hub,
            ..self.clone()
        }
    }

    /// The same gear with another section of the same teeth.
    pub(super) fn with_section(&self, section: &SpurGear) -> Self {
        Self {
            section: section.clone(),
            ..self.clone()
        }
    }

    /// The same gear without holes.
    pub fn without_holes(&self) -> Self {
        Self {
            section: self.section.without_holes(),
            ..self.clone()
        }
    }

    /// The same gear with flanks as the rack cuts them, each like the other, up to a sharp tip.
    pub fn with_plain_flanks(&self) -> Self {
        Self {
            section: self.section.with_plain_flanks(),
            ..self.clone()
        }
    }

    /// Where the face begins and ends.
    pub fn face_heights(&self) -> [f64; 2] {
        let half = self.face_width() / 2.0;
        [-half, half]
    }

    /// Parts below the root circle, from outside to the bore or the radius of the shaft, by their widths.
    pub fn layers(&self) -> Vec<Layer> {
        let blank = &self.section.data().blank;
        let (bore, root) = (blank.bore_radius, self.section.root_radius());
        let face = self.face_heights();
        let hub = self
            .hub
            .map(|hub| (bore, hub.outer_radius, around(hub.offset, hub.width)));
        let web = blank.web.map(|web: Web| {
            (
                web.inner_radius,
                web.outer_radius,
                around(self.web_offset, web.thickness),
            )
        });
        let parts: Vec<(f64, f64, [f64; 2])> = hub.into_iter().chain(web).collect();
        let mut edges: Vec<f64> = parts
            .iter()
            .flat_map(|(inner, outer, _)| [*inner, *outer])
            .chain([bore, root])
            .filter(|r| (bore..=root).contains(r))
            .collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let mut layers: Vec<Layer> = Vec::new();
        for ends in edges.windows(2).rev() {
            let middle = f64::midpoint(ends[0], ends[1]);
            let part = parts
                .iter()
                .find(|(inner, outer, _)| (*inner..*outer).contains(&middle));
            let heights = part.map_or(face, |(_, _, heights)| *heights);
            match layers.last_mut() {
                Some(above) if above.heights == heights => above.inner_radius = ends[0],
                _ => layers.push(Layer {
                    inner_radius: ends[0],
                    outer_radius: ends[1],
                    heights,
                }),
            }
        }
        layers
    }

    /// The part inside the radius of the shaft of a gear that is of one piece with it: as wide as its hub, or as the face.
    pub fn shaft(&self) -> Option<Layer> {
        let blank = &self.section.data().blank;
        blank.shaft().map(|_| Layer {
            inner_radius: 0.0,
            outer_radius: blank.bore_radius,
            heights: self
                .hub
                .map_or(self.face_heights(), |hub| around(hub.offset, hub.width)),
        })
    }

    fn check_layers(&self) -> Result<(), SolidGearError> {
        let blank = &self.section.data().blank;
        let face = self.face_heights();
        if let Some(web) = blank.web {
            let [low, high] = around(self.web_offset, web.thickness);
            let beyond = (face[0] - low).max(high - face[1]);
            // Flush faces differ by roundings.
            let slack = 1e-9 * self.face_width();
            if web.thickness > self.face_width() + slack {
                return Err(SolidGearError::WebThickerThanFace {
                    thickness: web.thickness,
                    face_width: self.face_width(),
                });
            }
            let fits = beyond <= slack;
            if !fits {
                let play = ((self.face_width() - web.thickness) / 2.0).max(0.0);
                return Err(SolidGearError::WebBeyondFace {
                    beyond,
                    nearest: self.web_offset.clamp(-play, play),
                });
            }
        }
        let Some(hub) = self.hub else { return Ok(()) };
        let largest = blank.web.map_or_else(
            || self.section.root_radius() - self.normal_rack().module,
            |web| web.outer_radius,
        );
        if !(hub.outer_radius > blank.bore_radius && hub.outer_radius < largest) {
            return Err(SolidGearError::HubOutside {
                outer_radius: hub.outer_radius,
                least: blank.bore_radius,
                largest,
            });
        }
        let own = around(hub.offset, hub.width);
        let slack = 1e-9 * self.face_width();
        let within = |inner: [f64; 2], outer: [f64; 2]| {
            inner[0] >= outer[0] - slack && inner[1] <= outer[1] + slack
        };
        let touches_web = blank
            .web
            .filter(|web| web.inner_radius <= hub.outer_radius)
            .map(|web| around(self.web_offset, web.thickness));
        match touches_web {
            Some(web) if !within(web, own) => Err(SolidGearError::HubNarrowerThanWeb {
                width: hub.width,
                nearest: 2.0 * (web[1] - hub.offset).max(hub.offset - web[0]),
            }),
            None if !(within(own, face) || within(face, own)) => {
                let play = (self.face_width() - hub.width).abs() / 2.0;
                Err(SolidGearError::HubBesideFace {
                    offset: hub.offset,
                    nearest: hub.offset.clamp(-play, play),
                })
            }
            _ => Ok(()),
        }
    }

    /// All holes stand in one part.
    fn check_holes(&self) -> Result<(), SolidGearError> {
        let holes: &[Hole] = self.section.holes();
        if holes.is_empty() {
            return Ok(());
        }
        // Holes stand in the web, or where there is none in the part that carries the teeth.
        let layers = self.layers();
        let has_web = self
            .section
            .data()
            .blank
            .web_in(self.face_width())
            .is_some();
        let home = &layers[usize::from(has_web && layers.len() > 1)];
        for (index, hole) in holes.iter().enumerate() {
            let (from, to) = (hole.inner_reach(), hole.outer_reach());
            if !(from > home.inner_radius && to < home.outer_radius) {
                return Err(SolidGearError::HoleAcrossEdge {
                    hole: index,
                    from,
                    to,
                    inner_radius: home.inner_radius,
                    outer_radius: home.outer_radius,
                });
            }
        }
        Ok(())
    }
}

/// The heights of a part of so much `width` whose middle stands at `offset`.
fn around(offset: f64, width: f64) -> [f64; 2] {
    [offset - width / 2.0, offset + width / 2.0]
}

/// α_t by tan α_t = tan α_n/cos β; α_n itself of straight teeth.
pub(super) fn transverse_angle(normal: f64, cos: f64) -> f64 {
    if cos == 1.0 {
        normal
    } else {
        (normal.tan() / cos).atan()
    }
}

/// The same of a section whose shifts are in transverse modules, in normal ones.
fn in_normal_section(error: GearError, cos: f64) -> GearError {
    match error {
        GearError::Undercut {
            generating_profile_shift,
            smallest,
        } => GearError::Undercut {
            generating_profile_shift: generating_profile_shift / cos,
            smallest: smallest / cos,
        },
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{Core, FaceEnds, Involute, radial, tangential};
    use std::f64::consts::{FRAC_PI_2, PI};

    /// The gear of the references: 40 teeth, normal module 2 mm, 20 degrees.
    fn helical(angle: f64) -> SolidGear {
        let mut data = paper_gear(40);
        data.rack.tip_radius = 0.76e-3;
        SolidGear::new(data, Helix::right(angle.to_radians()), 0.0, None).expect("can be made")
    }

    #[test]
    fn the_transverse_section_is_that_of_the_reference() {
        let gear = helical(20.0);
        let section = gear.section();
        for (found, expected) in [
            (section.reference_radius(), 42.5671e-3),
            (section.base_radius(), 39.6936e-3),
            (section.tip_radius(), 44.5671e-3),
            (section.root_radius(), 40.0671e-3),
            (gear.twist() * 1e-3, 0.008_550_5),
            (gear.base_helix_angle(), 18.7472_f64.to_radians()),
        ] {
            assert!((found / expected - 1.0).abs() < 2e-6, "{found} {expected}");
        }
        assert!((helical(-20.0).twist() + gear.twist()).abs() < 1e-15);
    }

    #[test]
    fn straight_teeth_are_those_of_the_plane() {
        let plane = SpurGear::new(paper_gear(40)).expect("the standard gear");
        assert_eq!(*helical(0.0).section(), plane);
    }

    #[test]
    fn the_fillet_of_an_oblique_rack_meets_the_involute_and_the_root_circle() {
        for (angle, x) in [(8.0, 0.0), (20.0, 0.4), (33.0, -0.1)] {
            let mut data = paper_gear(40);
            data.profile_shift = x;
            let gear = SolidGear::new(data, Helix::right(f64::to_radians(angle)), 0.0, None)
                .expect("can be made");
            let section = gear.section();
            let (fillet, flank): (_, &Involute) = (section.fillet(), section.flank());
            let (start, end) = fillet.ends();
            let s = section.form_roll_length();
            assert!((fillet.point(start) - flank.point(s)).norm() < 1e-14);
            let step = 1e-6;
            let tangent = (fillet.point(start + step) - fillet.point(start)).normalize();
            assert!(tangent.dot(&flank.normal(s)).abs() < 1e-4);
            assert!((fillet.point(end).norm() - section.root_radius()).abs() < 1e-15);
        }
    }

    #[test]
    fn an_oblique_rack_rounded_in_its_normal_section_never_cuts_into_the_fillet() {
        let gear = helical(25.0);
        let (section, rack) = (gear.section(), gear.normal_rack());
        let cos = gear.helix().angle.cos();
        let fillet = section.fillet();
        let (start, end) = fillet.ends();
        let boundary: Vec<(f64, f64)> = (0..=4000)
            .map(|i| fillet.point(start + (end - start) * f64::from(i) / 4000.0))
            .map(|p| (p.norm(), p.y.atan2(p.x)))
            .collect();
        let r = section.reference_radius();
        let z = f64::from(section.tooth_count());
        let mut nearest = f64::INFINITY;
        for roll in -1500..=1500 {
            let turn = f64::from(roll) * 2e-4;
            for arc in 0..=200 {
                // A point of the circle in the normal section, seen along the teeth.
                let angle = FRAC_PI_2 * f64::from(arc) / 200.0;
                let depth = rack.dedendum - rack.tip_radius + rack.tip_radius * angle.sin();
                let across = (rack.half_tip_land() + rack.tip_radius * angle.cos()) / cos;
                let phi = PI / z - turn;
                let point = (r - depth) * radial(phi) - (across - r * turn) * tangential(phi);
                let (radius, theta) = (point.norm(), point.y.atan2(point.x));
                let after = boundary.partition_point(|known| known.0 > radius);
                if after == 0 || after == boundary.len() {
                    continue;
                }
                let ((r_0, t_0), (r_1, t_1)) = (boundary[after - 1], boundary[after]);
                let edge = t_0 + (t_1 - t_0) * (radius - r_0) / (r_1 - r_0);
                nearest = nearest.min(radius * (theta - edge));
            }
        }
        assert!((-1e-7..1e-6).contains(&nearest), "{nearest:e}");
    }

    fn webbed(web_offset: f64, hub: Option<Hub>) -> Result<SolidGear, SolidGearError> {
        let mut data = paper_gear(40);
        data.blank.web = Some(Web {
            inner_radius: 20e-3,
            outer_radius: 33e-3,
            thickness: 5e-3,
        });
        SolidGear::new(data, Helix::right(0.35), web_offset, hub)
    }

    #[test]
    fn layers_stand_from_the_root_circle_to_the_bore() {
        let hub = Hub {
            outer_radius: 20e-3,
            width: 30e-3,
            offset: 2e-3,
        };
        let gear = webbed(7.5e-3, Some(hub)).expect("can be made");
        let layers = gear.layers();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-15;
        assert_eq!(layers.len(), 3);
        for (layer, [inner, outer, low, high]) in layers.iter().zip([
            [33e-3, gear.section().root_radius(), -10e-3, 10e-3],
            [20e-3, 33e-3, 5e-3, 10e-3],
            [15e-3, 20e-3, -13e-3, 17e-3],
        ]) {
            assert!(near(layer.inner_radius, inner) && near(layer.outer_radius, outer));
            assert!(near(layer.heights[0], low) && near(layer.heights[1], high));
        }
        assert_eq!(helical(20.0).layers().len(), 1);
    }

    #[test]
    fn a_gear_of_one_piece_with_its_shaft_has_the_mass_of_the_disc_inside_and_is_turned_over_with_its_ends()
     {
        let hub = Hub {
            outer_radius: 20e-3,
            width: 30e-3,
            offset: 2e-3,
        };
        for (hub, width) in [(None, 20e-3), (Some(hub), 30e-3)] {
            let bored = webbed(0.0, hub).expect("can be made");
            let mut data = paper_gear(40);
            data.blank = bored.section().data().blank.clone();
            data.blank.core = Core::Shaft {
                torque_at: FaceEnds::Minus,
            };
            let solid = SolidGear::new(data, Helix::right(0.35), 0.0, hub).expect("can be made");
            let radius = solid.section().bore_radius();
            let disc = solid.section().material().density * PI * radius.powi(2) * width;
            let [more, turns] = [
                solid.mass() - bored.mass(),
                solid.polar_inertia() - bored.polar_inertia(),
            ];
            assert!((more / disc - 1.0).abs() < 1e-12, "{more} {disc}");
            assert!((turns / (disc * radius.powi(2) / 2.0) - 1.0).abs() < 1e-10);
            let shaft = solid.shaft().expect("a shaft");
            assert_eq!([shaft.inner_radius, shaft.outer_radius], [0.0, radius]);
            assert!((shaft.heights[1] - shaft.heights[0] - width).abs() < 1e-15);
            let blank = |gear: &SolidGear| gear.section().data().blank.shaft();
            assert_eq!(blank(&solid.turned_over()), Some(FaceEnds::Plus));
            assert_eq!(bored.shaft().map(|shaft| shaft.heights), None);
        }
    }

    #[test]
    fn webs_and_hubs_out_of_place_are_refused_and_what_is_named_cures_it() {
        let Err(SolidGearError::WebBeyondFace { nearest, .. }) = webbed(9e-3, None) else {
            panic!("1.5 mm beyond")
        };
        assert!((nearest - 7.5e-3).abs() < 1e-15 && webbed(nearest, None).is_ok());
        let hub = |width: f64| Hub {
            outer_radius: 20e-3,
            width,
            offset: -1e-3,
        };
        let Err(SolidGearError::HubNarrowerThanWeb { nearest, .. }) = webbed(3e-3, Some(hub(6e-3)))
        else {
            panic!("the web reaches to 5.5 mm, the hub to 2 mm")
        };
        assert!(webbed(3e-3, Some(hub(nearest))).is_ok());
        assert!((nearest - 13e-3).abs() < 1e-15);
        let wide = Hub {
            outer_radius: 35e-3,
            ..hub(20e-3)
        };
        assert!(matches!(
            webbed(0.0, Some(wide)),
            Err(SolidGearError::HubOutside { .. })
        ));
        let steep = SolidGear::new(paper_gear(40), Helix::right(0.8), 0.0, None);
        assert!(matches!(steep, Err(SolidGearError::HelixAngle { .. })));
    }
}
