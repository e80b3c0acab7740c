//! A whole blank: any plane region between the bore and a circle, with a thickness by region.

use super::HolePattern;
use super::hole::{Hole, HoleShape};
use super::moments::Moments;
use crate::gear::lead::FaceEnds;

/// A ring of its own thickness within a blank. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Web {
    /// Where it begins.
    pub inner_radius: f64,
    /// Where it ends.
    pub outer_radius: f64,
    /// Its thickness, symmetric to the mid plane.
    pub thickness: f64,
}

/// The inside of the circle on which a blank ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Core {
    /// A bore, on which the hub is rigid.
    #[default]
    Bore,
    /// A shaft in one piece with the blank: it is solid to the axis, and the reaction is even over the section of the shaft, or a torque that rises with the
    /// radius.
    Shaft {
        /// The ends of the face through which the torque enters, half of it each where it is both. A plane knows both only.
        torque_at: FaceEnds,
    },
}

/// The blank: the bore or the shaft, the holes, and a web, if there is one. Elsewhere the blank is as thick as the face is wide.
#[derive(Debug, Clone, PartialEq)]
pub struct BlankRegion {
    /// The radius of the bore, or of the shaft, in meters.
    pub bore_radius: f64,
    /// Which of them it is.
    pub core: Core,
    /// The holes.
    pub holes: Vec<Hole>,
    /// The web.
    pub web: Option<Web>,
}

/// Where a blank is thinnest in its plane. Holes are numbered by their places in the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ligament {
    /// Between two holes.
    Between(usize, usize),
    /// Between the ends of one slot, or two parts of one contour.
    WithinSlot(usize),
    /// Between a hole and the bore.
    ToBore(usize),
    /// Between a hole and the circle around the blank.
    ToRim(usize),
}

impl HolePattern {
    /// The holes of the pattern, hole 0 first, counter-clockwise.
    pub fn holes(&self) -> Vec<Hole> {
        let turn = std::f64::consts::TAU / f64::from(self.count.max(1));
        let hole = |i: u32| Hole {
            circle_radius: self.circle_radius,
            angle: self.phase + f64::from(i) * turn,
            shape: HoleShape::Round {
                radius: self.radius,
            },
        };
        (0..self.count).map(hole).collect()
    }
}

impl BlankRegion {
    /// A blank with nothing but its bore.
    pub fn solid(bore_radius: f64) -> Self {
        Self {
            bore_radius,
            core: Core::Bore,
            holes: Vec::new(),
            web: None,
        }
    }

    /// The radius of the empty region about the axis: 0 of a shaft.
    pub fn open_radius(&self) -> f64 {
        match self.core {
            Core::Bore => self.bore_radius,
            Core::Shaft { .. } => 0.0,
        }
    }

    /// The ends of the face through which the torque enters its shaft; `None` on a bore.
    pub fn shaft(&self) -> Option<FaceEnds> {
        match self.core {
            Core::Bore => None,
            Core::Shaft { torque_at } => Some(torque_at),
        }
    }

    /// The same blank seen from its other side.
    pub(in crate::gear) fn turned_over(&self) -> Self {
        Self {
            core: match self.core {
                Core::Bore => Core::Bore,
                Core::Shaft { torque_at } => Core::Shaft {
                    torque_at: torque_at.turned_over(),
                },
            },
            ..self.clone()
        }
    }

    /// A blank with a pattern of holes.
    pub fn with_pattern(bore_radius: f64, pattern: HolePattern) -> Self {
        Self {
            holes: pattern.holes(),
            ..Self::solid(bore_radius)
        }
    }

    /// The largest radius that any hole reaches; `None` without holes.
    pub fn outer_reach(&self) -> Option<f64> {
        self.holes.iter().map(Hole::outer_reach).reduce(f64::max)
    }

    /// The smallest radius that any hole reaches; `None` without holes.
    pub fn inner_reach(&self) -> Option<f64> {
        self.holes.iter().map(Hole::inner_reach).reduce(f64::min)
    }

    /// The material around the holes inside the circle of `rim_radius`, place by place: between each two, within a slot,
    /// to the bore and to the circle. Negative where they overlap.
    pub fn ligaments(&self, rim_radius: f64) -> impl Iterator<Item = (Ligament, f64)> {
        let alone = self.holes.iter().enumerate().flat_map(move |(i, hole)| {
            [
                (Ligament::ToBore(i), hole.inner_reach() - self.bore_radius),
                (Ligament::ToRim(i), rim_radius - hole.outer_reach()),
                (Ligament::WithinSlot(i), hole.ligament_between_own_ends()),
            ]
        });
        let pairs =
            (0..self.holes.len()).flat_map(move |i| (i + 1..self.holes.len()).map(move |j| (i, j)));
        let between = pairs.map(|(i, j)| {
            (
                Ligament::Between(i, j),
                self.holes[i].ligament_to(&self.holes[j]),
            )
        });
        alone.chain(between)
    }

    /// The thinnest ligament of the holes inside the circle of `rim_radius`, and its width; `None` without holes.
    pub fn least_ligament(&self, rim_radius: f64) -> Option<(Ligament, f64)> {
        self.ligaments(rim_radius)
            .reduce(|least, next| if next.1 < least.1 { next } else { least })
    }

    /// The thickness at the distance `radius` from the axis, of a blank as thick as `face_width` outside its web.
    pub fn thickness_at(&self, radius: f64, face_width: f64) -> f64 {
        match self.web {
            Some(web) if radius > web.inner_radius && radius < web.outer_radius => web.thickness,
            _ => face_width,
        }
    }

    /// The web, unless it is as thick as the face is wide: then it is none.
    pub fn web_in(&self, face_width: f64) -> Option<Web> {
        self.web.filter(|web| web.thickness != face_width)
    }

    /// The area of all holes together, in m²: holes that overlap count twice.
    pub fn hole_area(&self) -> f64 {
        self.holes.iter().map(|hole| hole.moments().area).sum()
    }

    /// Material removed by bore, holes and web from a body as thick as `face_width`: volume in m³, first moment in m⁴, polar moment in m⁵. Times the density
    /// they are its parts of mass, imbalance and inertia.
    ///
    /// In closed form, also where a hole crosses the edge of the web. A web thicker than the face adds, which is negative here.
    pub fn taken_away(&self, face_width: f64) -> Moments {
        let holes: Moments = self.holes.iter().map(Hole::moments).sum();
        let through = (Moments::of_disc(self.open_radius()) + holes) * face_width;
        let Some(web) = self.web else { return through };
        let (inner, outer) = (
            web.inner_radius.max(self.bore_radius),
            web.outer_radius.max(self.bore_radius),
        );
        // An empty region cannot be thinned.
        let within = |radius: f64| {
            let holes: Moments = self
                .holes
                .iter()
                .map(|hole| hole.moments_within(radius))
                .sum();
            Moments::of_disc(radius) - holes
        };
        through + (within(outer) - within(inner)) * (face_width - web.thickness)
    }

    /// The same blank turned by `angle` counter-clockwise.
    pub fn turned(&self, angle: f64) -> Self {
        let turn = |hole: &Hole| Hole {
            angle: hole.angle + angle,
            ..hole.clone()
        };
        Self {
            holes: self.holes.iter().map(turn).collect(),
            ..self.clone()
        }
    }

    /// The mirror image of the blank about the centerline of tooth 0.
    pub(in crate::gear) fn mirrored(&self) -> Self {
        let mirror = |hole: &Hole| Hole {
            angle: -hole.angle,
            shape: match &hole.shape {
                HoleShape::Contour(contour) => HoleShape::Contour(contour.mirrored()),
                round => round.clone(),
            },
            ..hole.clone()
        };
        Self {
            holes: self.holes.iter().map(mirror).collect(),
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::gear::blank::hole::tests::holes;
    use crate::gear::radial;

    fn region(web: Option<Web>) -> BlankRegion {
        let all = holes();
        let apart = Hole {
            angle: -1.65,
            ..all[4].clone()
        };
        BlankRegion {
            bore_radius: 12e-3,
            core: Core::Bore,
            holes: vec![all[0].clone(), all[1].clone(), all[3].clone(), apart],
            web,
        }
    }

    const WEB: Web = Web {
        inner_radius: 20e-3,
        outer_radius: 31e-3,
        thickness: 6e-3,
    };

    #[test]
    fn a_web_of_the_face_width_takes_nothing_away() {
        let even = Web {
            thickness: 20e-3,
            ..WEB
        };
        assert_eq!(
            region(Some(even)).taken_away(20e-3),
            region(None).taken_away(20e-3)
        );
        assert_eq!(region(Some(even)).thickness_at(25e-3, 20e-3), 20e-3);
    }

    #[test]
    fn what_is_taken_away_is_the_sum_over_a_lattice_of_cells() {
        let region = region(Some(WEB));
        let (b, outer) = (20e-3, 45e-3);
        let taken = region.taken_away(b);
        // Midpoint rule in polar coordinates: cells of 0.1 mm by 0.09 degrees.
        let (rings, rays) = (900, 4000);
        let mut expected = Moments::default();
        for i in 0..rings {
            let r = outer * (f64::from(i) + 0.5) / f64::from(rings);
            let cell = r * (outer / f64::from(rings)) * (2.0 * PI / f64::from(rays));
            for k in 0..rays {
                let point = r * radial(2.0 * PI * (f64::from(k) + 0.5) / f64::from(rays));
                let void = r < region.bore_radius
                    || region.holes.iter().any(|h| h.distance_to(point) < 0.0);
                let missing = if void {
                    b
                } else {
                    b - region.thickness_at(r, b)
                };
                expected = expected
                    + Moments {
                        area: cell * missing,
                        first: cell * missing * point,
                        polar: cell * missing * r * r,
                    };
            }
        }
        // Cells on the edges count whole or not at all.
        assert!((taken.area / expected.area - 1.0).abs() < 3e-4);
        assert!((taken.polar / expected.polar - 1.0).abs() < 3e-4);
        assert!((taken.first - expected.first).norm() < 3e-4 * expected.area * 30e-3);
        assert!(
            taken.first.norm() > 0.01 * taken.area * 30e-3,
            "unequal holes are out of balance"
        );
    }

    #[test]
    fn a_pattern_takes_away_what_its_closed_forms_say_and_leaves_its_balance() {
        let pattern = HolePattern {
            count: 8,
            circle_radius: 30e-3,
            radius: 8e-3,
            phase: 0.3,
        };
        let region = BlankRegion::with_pattern(15e-3, pattern);
        let taken = region.taken_away(20e-3);
        let area = pattern.area() + PI * 225e-6;
        let polar = pattern.polar_moment() + PI / 2.0 * 15e-3_f64.powi(4);
        assert!((taken.area / (20e-3 * area) - 1.0).abs() < 1e-13);
        assert!((taken.polar / (20e-3 * polar) - 1.0).abs() < 1e-13);
        assert!(taken.first.norm() < 1e-13 * taken.area * 30e-3);
        let (place, ligament) = region.least_ligament(45e-3).expect("holes");
        assert!(matches!(place, Ligament::Between(..)));
        assert!((ligament - pattern.ligament_between()).abs() < 1e-16);
    }

    #[test]
    fn the_thinnest_place_is_found() {
        let with = |hole| BlankRegion {
            holes: vec![hole],
            ..region(None)
        };
        let all = holes();
        let (place, left) = with(all[0].clone()).least_ligament(45e-3).expect("a hole");
        assert_eq!(place, Ligament::ToRim(0));
        assert!((left - 7e-3).abs() < 1e-16);
        let (place, _) = with(all[4].clone()).least_ligament(45e-3).expect("a hole");
        assert_eq!(place, Ligament::ToBore(0));
        assert!(
            region(None)
                .turned(1.0)
                .least_ligament(45e-3)
                .expect("holes")
                .1
                < 7e-3
        );
        assert_eq!(
            BlankRegion {
                holes: Vec::new(),
                ..region(None)
            }
            .least_ligament(45e-3),
            None
        );
    }
}
