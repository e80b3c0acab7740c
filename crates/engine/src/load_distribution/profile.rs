//! The tooth's thickness over its height, from its true profile.

use crate::gear::SpurGear;

/// Steps of the table on the flank, and as many on the fillet.
const STEPS: u32 = 200;

/// Half the thickness of a tooth across its centerline, tabulated over the height above the root circle.
#[derive(Debug, Clone)]
pub(super) struct ToothProfile {
    /// Height and half thickness in m, by rising height.
    points: Vec<(f64, f64)>,
}

impl ToothProfile {
    /// The profile of a tooth of `gear`, from the foot of its fillet to its tip.
    pub(super) fn of(gear: &SpurGear) -> Self {
        let (flank, fillet) = (gear.flank(), gear.fillet());
        let (gamma_flank, gamma_root) = fillet.ends();
        let (s_form, s_tip) = (gear.form_roll_length(), gear.tip_roll_length());
        let between =
            |from: f64, to: f64, i: u32| from + (to - from) * f64::from(i) / f64::from(STEPS);
        let below = (0..STEPS).map(|i| fillet.point(between(gamma_root, gamma_flank, i)));
        let above = (0..=STEPS).map(|i| flank.point(between(s_form, s_tip, i)));
        Self {
            points: below
                .chain(above)
                .map(|point| (point.x - gear.root_radius(), point.y))
                .collect(),
        }
    }

    /// Half the thickness of the tooth at heights (m) above the root circle, which are asked for in rising order.
    pub(super) fn half_thicknesses(&self) -> impl FnMut(f64) -> f64 {
        let mut after = 1;
        move |y| {
            while self.points[after].0 < y && after + 1 < self.points.len() {
                after += 1;
            }
            let ((y_0, x_0), (y_1, x_1)) = (self.points[after - 1], self.points[after]);
            x_0 + (x_1 - x_0) * (y - y_0) / (y_1 - y_0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;

    #[test]
    fn the_thickness_is_that_of_flank_and_fillet_between_the_points_of_the_table() {
        let gear = SpurGear::new(paper_gear(29)).expect("a gear of the paper");
        let profile = ToothProfile::of(&gear);
        let (gamma_flank, gamma_root) = gear.fillet().ends();
        for i in 0..=77 {
            let fraction = f64::from(i) / 77.0;
            let s = gear.form_roll_length()
                + fraction * (gear.tip_roll_length() - gear.form_roll_length());
            let gamma = gamma_root + fraction * (gamma_flank - gamma_root);
            for point in [gear.flank().point(s), gear.fillet().point(gamma)] {
                // Chords of 1/200 of either curve lie off it by some 1e-8 m, where the fillet turns into the root
                // circle by five times as much.
                let x = profile.half_thicknesses()(point.x - gear.root_radius());
                assert!((x - point.y).abs() < 6e-8, "{x} beside {}", point.y);
            }
        }
    }
}
