//! The edge between flank and tip circle: sharp, rounded or chamfered.

use super::{Involute, Vector, radial, tangential};

/// Shape of the broken edge at the tip, the same on both flanks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TipEdge {
    /// Not at all.
    #[default]
    Sharp,
    /// By an arc of this radius, tangent to the flank and to the tip circle.
    Rounded(f64),
    /// By a straight cut that begins this far below the tip circle, at 45 degrees to the radius there.
    Chamfered(f64),
}

/// A broken edge on the flank of tooth 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BrokenEdge {
    /// The roll length s_Fa at which the involute ends.
    pub(super) from: f64,
    line: EdgeLine,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum EdgeLine {
    Arc {
        center: Vector,
        radius: f64,
    },
    Straight {
        start: Vector,
        outward: Vector,
        end: Vector,
    },
}

impl BrokenEdge {
    /// The break `edge` of `flank` under the tip radius r_a; `None` for a sharp edge.
    pub(super) fn new(edge: TipEdge, flank: &Involute, tip_radius: f64) -> Option<Self> {
        let r_b = flank.base_radius();
        match edge {
            TipEdge::Sharp => None,
            TipEdge::Rounded(radius) => {
                // The center stands ρ inside the flank, at r_b e_r + (s − ρ) e_t, and ρ inside the tip circle.
                let inner = (tip_radius - radius).powi(2) - r_b * r_b;
                let across = inner.max(0.0).sqrt();
                let from = radius + across;
                let t = flank.tangent_angle(from);
                let center = r_b * radial(t) + across * tangential(t);
                Some(Self {
                    from,
                    line: EdgeLine::Arc { center, radius },
                })
            }
            TipEdge::Chamfered(depth) => {
                let from = flank.roll_length(tip_radius - depth);
                let start = flank.point(from);
                let angle = start.y.atan2(start.x);
                let (up, back) = (radial(angle), -tangential(angle));
                let along = (up + back).normalize();
                // Where the line reaches the tip circle: |start + x along| = r_a.
                let half = start.dot(&along);
                let x =
                    -half + (half * half + tip_radius * tip_radius - start.norm_squared()).sqrt();
                Some(Self {
                    from,
                    line: EdgeLine::Straight {
                        start,
                        outward: Vector::new(-along.y, along.x),
                        end: start + x * along,
                    },
                })
            }
        }
    }

    /// The half angle at which the broken edge meets the tip circle; negative where both edges of the tooth would cross.
    pub(super) fn half_angle(&self) -> f64 {
        let point = match self.line {
            EdgeLine::Arc { center, .. } => center,
            EdgeLine::Straight { end, .. } => end,
        };
        point.y.atan2(point.x)
    }

    /// How far the involute is turned back at the radius of its roll length `s` to lie on the edge, as a length on the base circle,
    /// and the slope of that by `s`; nothing below the edge. `s` lies below the tip circle, at which a rounding ends at right angles to
    /// the radius.
    pub(super) fn depth_and_slope(&self, flank: &Involute, s: f64) -> (f64, f64) {
        /// As near to a common tangent of rounding and tip circle as the slope is followed.
        const LEAST: f64 = 1e-6;
        if s <= self.from {
            return (0.0, 0.0);
        }
        let (r_b, r) = (flank.base_radius(), flank.radius(s));
        // The angle of the edge at the radius r, and how it changes with r.
        let (angle, change) = match self.line {
            EdgeLine::Arc { center, radius } => {
                let away = center.norm();
                let cosine = (r * r + away * away - radius * radius) / (2.0 * r * away);
                let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                let by_radius = (r * r - away * away + radius * radius) / (2.0 * r * r * away);
                (
                    center.y.atan2(center.x) + cosine.min(1.0).acos(),
                    -by_radius / sine.max(LEAST),
                )
            }
            EdgeLine::Straight { start, outward, .. } => {
                let along = Vector::new(outward.y, -outward.x);
                let half = start.dot(&along);
                let root = (half * half + r * r - start.norm_squared()).sqrt();
                let point = start + (root - half) * along;
                let across = point.x * along.y - point.y * along.x;
                (point.y.atan2(point.x), across / (r * root))
            }
        };
        let depth = r_b * (flank.half_angle(r) - angle);
        // The half angle of the involute falls by s/(r_b r) for each radius.
        let slope = -s / r * (s / r + r_b * change);
        (depth.max(0.0), slope)
    }

    /// Points of the edge from the tip circle down to the flank, at the parts `t` of the way, with their derivatives by t.
    pub(super) fn point(&self, flank: &Involute, t: f64) -> (Vector, Vector) {
        match self.line {
            EdgeLine::Arc { center, radius } => {
                let normal = flank.normal(self.from);
                let (first, last) = (center.y.atan2(center.x), normal.y.atan2(normal.x));
                let angle = first + t * (last - first);
                (
                    center + radius * radial(angle),
                    radius * (last - first) * tangential(angle),
                )
            }
            EdgeLine::Straight { start, end, .. } => (end + t * (start - end), start - end),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flank() -> Involute {
        Involute::new(46.984_631_039_295_42e-3, 0.0463)
    }

    #[test]
    fn a_rounding_touches_the_flank_and_the_tip_circle_with_common_tangents() {
        let edge = BrokenEdge::new(TipEdge::Rounded(0.3e-3), &flank(), 52e-3).expect("an edge");
        let (top, along) = edge.point(&flank(), 0.0);
        assert!((top.norm() - 52e-3).abs() < 1e-16);
        assert!(along.dot(&top).abs() < 1e-18);
        let (bottom, along) = edge.point(&flank(), 1.0);
        assert!((bottom - flank().point(edge.from)).norm() < 1e-17);
        assert!(along.dot(&flank().normal(edge.from)).abs() < 1e-18);
    }

    #[test]
    fn a_chamfer_leaves_the_flank_at_its_depth_under_45_degrees_and_ends_on_the_tip_circle() {
        let edge = BrokenEdge::new(TipEdge::Chamfered(0.2e-3), &flank(), 52e-3).expect("an edge");
        let (bottom, along) = edge.point(&flank(), 1.0);
        assert!((bottom.norm() - 51.8e-3).abs() < 1e-16);
        let cosine = -along.normalize().dot(&bottom.normalize());
        assert!((cosine - 0.5_f64.sqrt()).abs() < 1e-12);
        assert!((edge.point(&flank(), 0.0).0.norm() - 52e-3).abs() < 1e-15);
    }

    #[test]
    fn the_involute_turned_back_by_what_is_missing_lies_on_the_edge() {
        for (edge, ends) in [
            (TipEdge::Rounded(0.3e-3), 0.99),
            (TipEdge::Chamfered(0.2e-3), 1.0),
        ] {
            let edge = BrokenEdge::new(edge, &flank(), 52e-3).expect("an edge");
            assert_eq!(edge.depth_and_slope(&flank(), edge.from), (0.0, 0.0));
            let all = flank().roll_length(52e-3) - edge.from;
            for i in 1..20 {
                let s = edge.from + ends * all * f64::from(i) / 20.0;
                let (depth, slope) = edge.depth_and_slope(&flank(), s);
                let point = flank().point(s);
                let angle = point.y.atan2(point.x) - depth / flank().base_radius();
                let reached = point.norm() * radial(angle);
                // The nearest of many points of the edge.
                let away = (0..=20_000)
                    .map(|j| (edge.point(&flank(), f64::from(j) / 2e4).0 - reached).norm());
                assert!(away.fold(f64::INFINITY, f64::min) < 1e-8);
                let step = 1e-8;
                let difference = (edge.depth_and_slope(&flank(), s + step).0
                    - edge.depth_and_slope(&flank(), s - step).0)
                    / (2.0 * step);
                assert!(
                    (slope - difference).abs() < 1e-5 * (1.0 + slope),
                    "{slope} {difference}"
                );
            }
        }
    }
}
