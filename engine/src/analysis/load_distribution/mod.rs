//! The classical route: contact on the theoretical line of contact, compliances from formulas (eqs. 4-5 of the
//! paper).
//!
//! A loaded pair of teeth gives way in three places, and for each there is a closed form. Forces act along the line
//! of action, so compliances (m/N) add up in series over the two gears:
//!
//! | what gives way | formula | module |
//! | --- | --- | --- |
//! | the tooth, a cantilever of varying section | Weber and Banaschek's integral over the true profile | [`weber_banaschek`] |
//! | the body under the tooth, as a ring on a rigid bore | Sainsot, Velex and Duverger | [`sainsot`] |
//! | the body under the tooth, as a half-plane | Weber and Banaschek; O'Donnell | [`half_plane`] |
//! | the flanks at the contact | Hertz, and Weber's approach of points at a depth | [`hertz`] |
//! | all of it at once, per pair of teeth | ISO 6336-1, method B, single stiffness | [`iso6336`] |
//!
//! Reading order: [`elastic_constants`] and [`tooth_load`] (where the load line meets the tooth, the one piece of
//! geometry that all formulas share), then the table from top to bottom.
//!
//! What this route cannot see: holes (a body is a ring or a half-plane), and the body that neighboring pairs share -
//! each pair carries a body of its own, so that the deflection of one tooth does not tilt the next. ISO's single
//! stiffness knows neither position nor bore.

mod curve;
pub mod elastic_constants;
pub mod half_plane;
pub mod hertz;
pub mod iso6336;
pub mod quantity;
pub mod sainsot;
pub mod tooth_load;
pub mod weber_banaschek;

pub(super) use curve::distribute;

#[cfg(test)]
mod tests {
    use super::elastic_constants::ElasticConstants;
    use super::half_plane::{self, FoundationForm};
    use super::hertz::{ContactBody, LineContact};
    use super::iso6336::{IsoGear, IsoPair};
    use super::tooth_load::{InvoluteTooth, ToothLoad};
    use super::weber_banaschek;
    use crate::analysis::PlaneState;

    #[test]
    fn the_sum_of_the_formulas_at_the_pitch_point_lies_near_the_single_stiffness_of_iso() {
        // ISO's q' is a fit to sums of this very kind. The tooth here runs down to the root circle as an
        // involute, without its fillet, and the load is one of many: 10 % allows for that.
        let steel = ElasticConstants::new(210e9, 0.3).expect("steel is a material");
        let (z, m, alpha, b, force) = (50.0_f64, 2e-3, 20_f64.to_radians(), 20e-3, 6000.0);
        let r_b = 0.5 * m * z * alpha.cos();
        let tooth = InvoluteTooth::new(50, alpha, 0.0, r_b, 47.5e-3).expect("the tooth exists");
        let s = r_b * alpha.tan();
        let load = ToothLoad::at_roll_length(&tooth, s).expect("the pitch point lies on the flank");

        // Half-thickness over height, by bisection for the radius whose flank point has that height.
        let half_thickness = |y: f64| {
            let (mut low, mut high) = (r_b, 60e-3);
            for _ in 0..60 {
                let r = 0.5 * (low + high);
                if r * tooth.half_angle_at(r).cos() < 47.5e-3 + y {
                    low = r;
                } else {
                    high = r;
                }
            }
            low * tooth.half_angle_at(low).sin()
        };
        let root_width = 2.0 * half_thickness(0.0);

        let plane = PlaneState::Strain;
        let bending = weber_banaschek::tooth_compliance(half_thickness, &load, b, &steel, plane)
            .expect("the profile is a tooth");
        let body = half_plane::compliance(
            FoundationForm::WeberBanaschek,
            &load,
            root_width,
            b,
            &steel,
            plane,
        )
        .expect("the root has a width");
        let flank = ContactBody {
            material: steel,
            curvature_radius: s,
            depth: load.depth,
        };
        let contact = LineContact::new([flank, flank], b, plane).expect("both flanks are convex");
        let approach = contact.approach(force).expect("the contact is narrow");

        let stiffness_per_width = 1.0 / (2.0 * (bending.total() + body) + approach / force) / b;
        let gear = IsoGear {
            tooth_count: 50,
            profile_shift: 0.0,
        };
        let c_th = IsoPair::new([gear, gear], 0.0, alpha)
            .expect("the pair is in ISO's range")
            .theoretical_single_stiffness();
        assert!(
            (stiffness_per_width / c_th - 1.0).abs() < 0.1,
            "{stiffness_per_width:e} beside {c_th:e} Pa"
        );
    }
}
