//! Where the line of a load meets the tooth: the geometry that the formulas share.
//!
//! Without friction the load lies on the flank's normal, and the normal of an involute touches the base circle. Seen
//! from the tooth's centerline (radial, from the gear's center O) a load at roll length s has
//!
//! - the load angle α_m = s/r_b − ψ_b, between the load and the perpendicular to the centerline; positive when the load
//!   also presses the tooth toward the hub;
//! - its crossing with the centerline at the radius r_b/cos α_m, thus at the height u = r_b/cos α_m − r_f above the root
//!   circle;
//! - the depth t = s − r_b tan α_m, along the load from the flank to the centerline (Weber's t_1, t_2).
//!
//! Here ψ_b is half the angle that the tooth spans at its base circle. The component across the tooth is F cos α_m, the
//! one along it F sin α_m; the bending moment at a height y is F cos α_m (u − y).

use crate::gear::SpurGear;

/// The least height of a load over the root radius: a load below it bends the tooth by nothing that counts.
const LEAST_HEIGHT: f64 = 1e-6;

/// Where a load acts on a tooth, as the formulas want it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ToothLoad {
    /// The height u above the root circle at which the load line crosses the tooth's centerline, in m; positive.
    pub(super) height: f64,
    /// The angle α_m between the load and the perpendicular to the centerline, in rad; positive toward the hub, within a
    /// right angle.
    pub(super) angle: f64,
    /// The distance t from the flank to the centerline along the load, in m; positive.
    pub(super) depth: f64,
}

impl ToothLoad {
    /// The load on a tooth of `gear` at `roll_length` (m), between the base circle and the tip.
    pub(super) fn at_roll_length(gear: &SpurGear, roll_length: f64) -> Self {
        let (r_b, r_f, s) = (gear.base_radius(), gear.root_radius(), roll_length);
        let alpha_m = s / r_b - gear.flank().base_half_angle();
        let u = r_b / alpha_m.cos() - r_f;
        Self {
            // On large gears the line of a load near the root crosses the centerline below the root circle: there is no
            // tooth left to bend, and the formulas want a positive height.
            height: u.max(LEAST_HEIGHT * r_f),
            angle: alpha_m,
            depth: s - r_b * alpha_m.tan(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;

    #[test]
    fn the_load_line_runs_from_the_flank_to_the_centerline_as_coordinates_say() {
        // The flank point in coordinates (along and across the centerline), then t along the inward normal: it must
        // end on the centerline at r_f + u. Only rounding is allowed for.
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        for s in [13.3564e-3, 17.8187e-3, 22.2810e-3] {
            let load = ToothLoad::at_roll_length(&gear, s);
            let point = gear.flank().point(s);
            let along = point.x - load.depth * load.angle.sin();
            let across = point.y - load.depth * load.angle.cos();
            assert!((along - (47.5e-3 + load.height)).abs() < 1e-15);
            assert!(across.abs() < 1e-15);
        }
    }

    #[test]
    fn a_load_below_the_root_circle_keeps_a_positive_height() {
        let mut data = paper_gear(150);
        data.rack.dedendum = 2.1e-3;
        data.rack.tip_radius = 0.2e-3;
        let gear = SpurGear::new(data).expect("a large gear with short teeth");
        let load = ToothLoad::at_roll_length(&gear, gear.form_roll_length());
        assert!(gear.base_radius() / load.angle.cos() < gear.root_radius());
        assert!(load.height > 0.0 && load.height < 1e-6);
    }
}
