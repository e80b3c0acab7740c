//! The outline of a tooth as it is cut, for drawings.

use std::f64::consts::PI;

use super::{Involute, SpurGear, Vector, radial};

/// Maximum number of chords of one piece: a bound on the work, met only by tolerances far below a drawing's.
const MOST_CHORDS: u32 = 1024;

impl SpurGear {
    /// The outline of tooth 0 with half a space on either side, counter-clockwise, in the frame of the gear.
    ///
    /// The outline begins on the root circle in the middle of the space before the tooth and ends in the middle of the one behind it, so that Z of them, each
    /// turned by the pitch angle, close. Every point lies on the true profile: root circle, fillet, flank with its modifications, tip edge and tip circle. No
    /// point of the profile is farther than `tolerance` from the chords.
    pub fn tooth_outline(&self, tolerance: f64) -> Vec<Vector> {
        let unloaded = self.half_outline(false, tolerance);
        let loaded = self.half_outline(true, tolerance);
        let mirrored = unloaded.iter().map(|p| Vector::new(p.x, -p.y));
        let behind = loaded.iter().rev();
        // Both halves have the middle of the tip land.
        mirrored.chain(behind.skip(1).copied()).collect()
    }

    /// Half of the outline, on the counter-clockwise side, from the middle of the space to the middle of the tip land.
    fn half_outline(&self, loaded: bool, tolerance: f64) -> Vec<Vector> {
        let (flank, fillet) = (self.flank(), self.fillet());
        let (r_a, r_f) = (self.tip_radius(), self.root_radius());
        let (flank_ends, fillet_end) = fillet.ends();
        let foot = fillet.point(fillet_end);
        let space = PI / f64::from(self.tooth_count());
        let foot_angle = foot.y.atan2(foot.x).min(space);
        let removed = |s: f64| if loaded { self.modified(s) } else { 0.0 };

        let mut points = vec![r_f * radial(space)];
        let mut add = |piece: &dyn Fn(f64) -> Vector| {
            points.extend(chords(piece, tolerance).into_iter().skip(1));
        };
        add(&|t| r_f * radial(space + t * (foot_angle - space)));
        add(&|t| fillet.point(fillet_end + t * (flank_ends - fillet_end)));
        let (from, to) = (self.form_roll_length(), self.tip_form_roll_length());
        add(&|t| {
            let s = from + t * (to - from);
            turned_back(flank, s, removed(s))
        });
        if let Some(edge) = self.broken_edge() {
            add(&|t| edge.point(flank, 1.0 - t).0);
        }
        let corner = self.tip_half_angle();
        add(&|t| r_a * radial(corner * (1.0 - t)));
        points
    }
}

/// The point at the roll length `s` of `flank`, turned back by the length `depth` on the base circle.
fn turned_back(flank: &Involute, s: f64, depth: f64) -> Vector {
    let point = flank.point(s);
    let angle = point.y.atan2(point.x) - depth / flank.base_radius();
    point.norm() * radial(angle)
}

/// The points of the curve over [0, 1] whose chords stay within `tolerance` of it.
fn chords(curve: &dyn Fn(f64) -> Vector, tolerance: f64) -> Vec<Vector> {
    let mut count = 1;
    loop {
        let at = |i: u32, of: u32| curve(f64::from(i) / f64::from(of));
        let strays = |i: u32| {
            let chord = (at(i, count) + at(i + 1, count)) / 2.0;
            (at(2 * i + 1, 2 * count) - chord).norm() > tolerance
        };
        if count >= MOST_CHORDS || !(0..count).any(strays) {
            return (0..=count).map(|i| at(i, count)).collect();
        }
        count *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::super::spur::tests::paper_gear;
    use super::*;
    use crate::gear::{ModificationData, ReliefData, ReliefShape, ReliefStart, TipEdge};

    const TOLERANCE: f64 = 1e-6;

    fn distance_to_segment(p: Vector, a: Vector, b: Vector) -> f64 {
        let along = b - a;
        let t = (p - a).dot(&along) / along.norm_squared().max(1e-30);
        (p - a - t.clamp(0.0, 1.0) * along).norm()
    }

    fn distance(p: Vector, outline: &[Vector]) -> f64 {
        let segments = outline.windows(2);
        segments
            .map(|ends| distance_to_segment(p, ends[0], ends[1]))
            .fold(f64::INFINITY, f64::min)
    }

    fn gears() -> Vec<SpurGear> {
        let plain = paper_gear(50);
        let mut modified = paper_gear(29);
        modified.blank.bore_radius = 10e-3;
        modified.modifications = vec![ModificationData::TipRelief(ReliefData {
            amount: 20e-6,
            shape: ReliefShape::Linear,
            start: ReliefStart::RadialLength(1.75e-3),
        })];
        let mut rounded = paper_gear(50);
        rounded.tip_edge = TipEdge::Rounded(0.3e-3);
        rounded.thickness_deviation = -80e-6;
        [plain, modified, rounded]
            .map(|data| SpurGear::new(data).expect("can be made"))
            .into()
    }

    #[test]
    fn every_point_of_the_profile_is_within_a_micrometer_of_the_outline() {
        for gear in gears() {
            let outline = gear.tooth_outline(TOLERANCE);
            let (flank, fillet) = (gear.flank(), gear.fillet());
            let (from, to) = (gear.form_roll_length(), gear.tip_form_roll_length());
            for i in 0..=1000 {
                let t = f64::from(i) / 1000.0;
                let s = from + t * (to - from);
                let loaded = turned_back(flank, s, gear.removed(s));
                let unloaded = Vector::new(flank.point(s).x, -flank.point(s).y);
                let (first, last) = fillet.ends();
                let root = fillet.point(first + t * (last - first));
                for p in [loaded, unloaded, root] {
                    let away = distance(p, &outline);
                    assert!(away < TOLERANCE, "{away:e} m at {t}");
                }
            }
        }
    }

    #[test]
    fn outlines_of_all_teeth_close() {
        for gear in gears() {
            let outline = gear.tooth_outline(TOLERANCE);
            let (first, last) = (outline[0], outline[outline.len() - 1]);
            let turn = nalgebra::Rotation2::new(gear.pitch_angle());
            assert!((turn * first - last).norm() < 1e-15);
            assert!((first.norm() - gear.root_radius()).abs() < 1e-15);
            let highest = outline.iter().map(|p| p.norm()).fold(0.0, f64::max);
            assert!((highest - gear.tip_radius()).abs() < 1e-15);
            // Counter-clockwise all along, but where the fillet undercuts nothing: angles rise.
            assert!(outline.iter().all(|p| p.norm() > 0.99 * gear.root_radius()));
            assert!(outline.len() < 400, "{} points", outline.len());
        }
    }
}
