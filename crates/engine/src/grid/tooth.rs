//! The grid of one tooth and the rim under it.

use super::tooth_plan::{Plan, Sizes, ToothGrid};
use super::{GridError, GridLevel, checked};
use crate::gear::SpurGear;

impl ToothGrid {
    /// Divides tooth 0 of `gear` and the rim under it, out from `interface_radius`.
    ///
    /// # Errors
    ///
    /// [`GridError`] if the interface circle is not below the root circle, or if the tooth is so shaped that an element
    /// is distorted.
    pub fn new(
        gear: &SpurGear,
        interface_radius: f64,
        level: GridLevel,
    ) -> Result<Self, GridError> {
        Self::of_sizes(gear, interface_radius, &Sizes::OF_SECTION, level)
    }

    /// The same in fewer elements, even ones: for a section that carries polynomials along the axis.
    ///
    /// # Errors
    ///
    /// As [`ToothGrid::new`].
    pub fn of_prism(
        gear: &SpurGear,
        interface_radius: f64,
        level: GridLevel,
    ) -> Result<Self, GridError> {
        Self::of_sizes(gear, interface_radius, &Sizes::OF_PRISM, level)
    }

    /// The same with fillets that tell the stress along them.
    ///
    /// # Errors
    ///
    /// As [`ToothGrid::new`].
    pub fn of_stressed_prism(
        gear: &SpurGear,
        interface_radius: f64,
        level: GridLevel,
    ) -> Result<Self, GridError> {
        Self::of_sizes(gear, interface_radius, &Sizes::OF_STRESSED_PRISM, level)
    }

    fn of_sizes(
        gear: &SpurGear,
        interface_radius: f64,
        sizes: &Sizes,
        level: GridLevel,
    ) -> Result<Self, GridError> {
        let root_radius = gear.root_radius();
        if !(interface_radius > 0.0 && interface_radius < root_radius) {
            return Err(GridError::InterfaceOutsideRim {
                interface_radius,
                root_radius,
            });
        }
        let plan = Plan::new(gear, interface_radius, sizes, level);
        let tooth = plan.build();
        Ok(Self {
            grid: checked(tooth.grid)?,
            ..tooth
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{Protuberance, TipEdge, radial};
    use crate::grid::root_curve::RootCurve;
    use crate::grid::tooth_plan::{SIZE_AT_TIP, SIZE_ON_FLANK};

    const LEVELS: [GridLevel; 3] = [GridLevel::Coarse, GridLevel::Standard, GridLevel::Fine];

    fn gear(tooth_count: u32, profile_shift: f64) -> Option<SpurGear> {
        let mut data = paper_gear(tooth_count);
        data.profile_shift = profile_shift;
        data.blank.bore_radius = 1e-3;
        SpurGear::new(data).ok()
    }

    /// Teeth of all counts, shifts and racks that can be made, with interface circles from close to deep, in modules.
    fn sweep() -> Vec<(SpurGear, f64)> {
        let mut gears = Vec::new();
        for z in [17, 18, 20, 25, 29, 50, 85, 150, 300] {
            for x in [-0.3, 0.0, 0.5, 0.9, 1.2] {
                gears.extend(gear(z, x));
            }
        }
        // Unusual racks: tall, short, pointed, sharp, and with the largest rounding.
        for z in [25, 50, 120] {
            for (alpha, addendum, dedendum, tip_radius) in [
                (20.0, 2.6e-3, 3.2e-3, 0.5e-3),
                (20.0, 1.2e-3, 1.6e-3, 0.4e-3),
                (20.0, 2e-3, 2.5e-3, 0.0),
                (20.0, 2e-3, 2.5e-3, 0.94e-3),
                (20.0, 2.75e-3, 2.5e-3, 0.76e-3),
                (14.5, 2e-3, 2.314e-3, 0.4e-3),
                (25.0, 2e-3, 2.5e-3, 0.5e-3),
                (28.0, 1.6e-3, 2.0e-3, 0.6e-3),
            ] {
                let mut data = paper_gear(z);
                data.blank.bore_radius = 1e-3;
                data.rack.pressure_angle = f64::to_radians(alpha);
                (data.rack.addendum, data.rack.dedendum, data.rack.tip_radius) =
                    (addendum, dedendum, tip_radius);
                gears.extend(SpurGear::new(data.clone()).ok());
                data.rack.tip_radius = data.rack.largest_tip_radius();
                gears.extend(SpurGear::new(data).ok());
            }
        }
        // Hobs with a protuberance, whose straight flank cuts the involute or not.
        for (z, amount, height) in [
            (20, 0.15e-3, 1.2e-3),
            (50, 0.15e-3, 1.8e-3),
            (120, 0.4e-3, 2.2e-3),
            (120, 0.1e-3, 1.0e-3),
        ] {
            let mut data = paper_gear(z);
            data.rack.dedendum = 2.8e-3;
            data.rack.protuberance = Some(Protuberance {
                amount,
                height,
                grinding_stock: 0.05e-3,
            });
            gears.push(SpurGear::new(data).expect("can be made"));
        }
        gears
            .into_iter()
            .flat_map(|gear| [0.1, 0.25, 0.5, 1.0, 1.5, 3.0].map(|depth| (gear.clone(), depth)))
            .collect()
    }

    fn divided(gear: &SpurGear, depth: f64, level: GridLevel) -> ToothGrid {
        let r_w = gear.root_radius() - depth * gear.data().rack.module;
        ToothGrid::new(gear, r_w, level).unwrap_or_else(|error| {
            panic!(
                "{:?} with {} teeth, {depth} modules deep at {level:?}: {error}",
                gear.data().rack,
                gear.tooth_count()
            )
        })
    }

    #[test]
    #[ignore = "./test all"]
    fn teeth_of_all_shapes_keep_angles_above_twenty_five_degrees() {
        let cases = sweep();
        assert!(cases.len() > 300);
        for (gear, depth) in cases {
            for level in LEVELS {
                let tooth = divided(&gear, depth, level);
                let quality = tooth.grid.quality();
                let (low, high) = (
                    quality.smallest_angle.to_degrees(),
                    quality.largest_angle.to_degrees(),
                );
                assert!(low > 25.0 && high < 155.0);
            }
        }
    }

    #[test]
    fn a_tooth_sector_has_the_area_of_the_profile() {
        for (gear, depth) in sweep() {
            let r_w = gear.root_radius() - depth * gear.data().rack.module;
            let ring = gear.mass() / (gear.data().material.density * gear.face_width());
            let bore = gear.bore_radius();
            let area = (ring + PI * (bore * bore - r_w * r_w)) / f64::from(gear.tooth_count());
            let grid = divided(&gear, depth, GridLevel::Standard).grid;
            // Parabolas through the fillet, and where its curvature jumps to that of the root circle.
            assert!(
                (grid.area() / area - 1.0).abs() < 2e-4,
                "{} of {area}",
                grid.area()
            );
        }
    }

    #[test]
    #[ignore = "./test all"]
    fn broken_edges_are_followed_by_sound_elements_and_take_off_the_area_that_they_should() {
        let mut count = 0;
        for (gear, depth) in sweep().into_iter().step_by(19) {
            let m = gear.data().rack.module;
            for edge in [0.02, 0.05, 0.1, 0.2, 0.35]
                .into_iter()
                .flat_map(|part| [TipEdge::Rounded(part * m), TipEdge::Chamfered(part * m)])
            {
                let mut data = gear.data().clone();
                data.tip_edge = edge;
                let Ok(broken) = SpurGear::new(data) else {
                    continue;
                };
                for level in LEVELS {
                    let tooth = divided(&broken, depth, level);
                    let quality = tooth.grid.quality();
                    assert!(
                        quality.smallest_angle.to_degrees() > 18.0,
                        "{edge:?} {:?} {:?}",
                        gear.data(),
                        quality
                    );
                    let rolls = &tooth.flank_roll_lengths;
                    assert_eq!(rolls.len(), tooth.flank_nodes.len());
                    assert!(rolls.windows(2).all(|s| s[0] < s[1]));
                    assert!(rolls.contains(&broken.tip_form_roll_length()));
                }
                let grid = divided(&broken, depth, GridLevel::Standard).grid;
                let r_w = gear.root_radius() - depth * m;
                let ring = broken.mass() / (gear.data().material.density * gear.face_width());
                let bore = gear.bore_radius();
                let area = (ring + PI * (bore * bore - r_w * r_w)) / f64::from(gear.tooth_count());
                // The cap that is left out of a rounding, and of a chamfer that leaves hardly any land.
                let at_edge = broken.edge_point(1.0).expect("a broken edge");
                let thin = broken.tip_half_angle() < 0.25 * at_edge.y.atan2(at_edge.x);
                let cap = match edge {
                    TipEdge::Rounded(amount) => 0.2 * amount * gear.tip_thickness(),
                    TipEdge::Chamfered(amount) if thin => 0.2 * amount * gear.tip_thickness(),
                    _ => 0.0,
                };
                let missing = area - grid.area();
                assert!(
                    (-3e-4 * area..3e-4 * area + cap).contains(&missing),
                    "{edge:?} {:e} of {area:e}, cap {cap:e}",
                    missing
                );
                count += 1;
            }
        }
        assert!(count > 20, "{count}");
    }

    #[test]
    fn an_edge_broken_by_nothing_is_sharp() {
        let sharp = gear(50, 0.0).expect("the standard gear");
        for edge in [TipEdge::Rounded(0.0), TipEdge::Chamfered(0.0)] {
            let mut data = sharp.data().clone();
            data.tip_edge = edge;
            let broken = SpurGear::new(data).expect("the standard gear");
            assert_eq!(
                divided(&broken, 1.0, GridLevel::Coarse),
                divided(&sharp, 1.0, GridLevel::Coarse)
            );
        }
    }

    #[test]
    fn each_level_halves_every_element() {
        for (gear, depth) in sweep().into_iter().step_by(5) {
            let [coarse, standard, fine] = LEVELS.map(|level| divided(&gear, depth, level));
            let count = |tooth: &ToothGrid| tooth.grid.elements.len();
            assert_eq!(
                (4 * count(&coarse), 4 * count(&standard)),
                (count(&standard), count(&fine))
            );
            for (i, s) in coarse.flank_roll_lengths.iter().enumerate().step_by(2) {
                assert!(
                    (s - standard.flank_roll_lengths[2 * i]).abs() < 1e-3 * gear.data().rack.module
                );
            }
        }
    }

    #[test]
    fn flank_nodes_lie_on_the_involute_from_the_form_point_to_the_tip_in_growing_elements() {
        for (gear, depth) in sweep() {
            let tooth = divided(&gear, depth, GridLevel::Standard);
            let (flank, m) = (gear.flank(), gear.data().rack.module);
            let s = &tooth.flank_roll_lengths;
            assert_eq!(
                (s[0], s[s.len() - 1]),
                (gear.form_roll_length(), gear.tip_roll_length())
            );
            assert_eq!((s.len(), s.len() % 2), (tooth.flank_nodes.len(), 1));
            for (node, s) in tooth.flank_nodes.iter().zip(s) {
                assert_eq!(tooth.grid.nodes[*node as usize], flank.point(*s));
            }
            let sizes: Vec<_> = s
                .windows(3)
                .step_by(2)
                .map(|s| (flank.arc_length(s[2]) - flank.arc_length(s[0])) / m)
                .collect();
            assert!(
                sizes
                    .windows(2)
                    .all(|h| h[1] < h[0] * (1.0 + 1e-9) && h[0] < 1.3 * h[1])
            );
            // Sizes are the asked for ones but for the rounding of an even count.
            assert!(sizes[sizes.len() - 1] < 1.25 * SIZE_AT_TIP && sizes[0] < 1.15 * SIZE_ON_FLANK);
        }
    }

    #[test]
    fn the_interface_circle_and_the_sides_are_in_order_and_equal() {
        for (gear, depth) in sweep() {
            let tooth = divided(&gear, depth, GridLevel::Standard);
            let r_w = gear.root_radius() - depth * gear.data().rack.module;
            let point = |node: &u32| tooth.grid.nodes[*node as usize];
            let half = gear.pitch_angle() / 2.0;
            let angles = &tooth.arc_angles;
            assert!(
                (angles[0] + half).abs() < 1e-15 && (angles[angles.len() - 1] - half).abs() < 1e-15
            );
            assert!(
                angles.windows(2).all(|a| a[0] < a[1]) && angles.len() == tooth.arc_nodes.len()
            );
            for (node, angle) in tooth.arc_nodes.iter().zip(angles) {
                assert!((point(node) - r_w * radial(*angle)).norm() < 1e-15);
            }
            let (right, left) = &tooth.side_nodes;
            assert_eq!(right.len(), left.len());
            for (a, b) in right.iter().zip(left) {
                let (a, b) = (point(a), point(b));
                assert_eq!((a.x, a.y), (b.x, -b.y), "mirror images");
                assert!((b.y.atan2(b.x) - half).abs() < 1e-14);
            }
            let radii: Vec<_> = left.iter().map(|n| point(n).norm()).collect();
            assert!(radii[0] > r_w && radii.windows(2).all(|r| r[0] < r[1]));
            assert!((radii[radii.len() - 1] - gear.root_radius()).abs() < 1e-15);
        }
    }

    #[test]
    fn the_fillet_and_the_root_land_are_followed_by_every_node_on_the_boundary() {
        let gear = gear(50, 0.0).expect("the standard gear");
        let curve = RootCurve::new(&gear);
        let (gamma_0, gamma_1) = gear.fillet().ends();
        for i in 0..=100 {
            let point = curve.point(curve.length() * f64::from(i) / 100.0);
            // The nearest of many points of the true curve.
            let nearest = (0..=20_000)
                .map(|k| gamma_0 + (gamma_1 - gamma_0) * f64::from(k) / 20_000.0)
                .map(|gamma| (gear.fillet().point(gamma) - point).norm())
                .fold((point.norm() - gear.root_radius()).abs(), f64::min);
            assert!(nearest < 1e-7, "the samples stand 1e-7 m apart");
        }
    }

    #[test]
    fn an_interface_circle_through_the_teeth_is_refused() {
        let gear = gear(50, 0.0).expect("the standard gear");
        for r_w in [0.0, 47.5e-3, 50e-3, f64::NAN] {
            assert!(matches!(
                ToothGrid::new(&gear, r_w, GridLevel::Standard),
                Err(GridError::InterfaceOutsideRim { .. })
            ));
        }
    }
}
