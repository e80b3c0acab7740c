//! The fillet and the root land of a tooth, by their length.

use crate::gear::rack::Trochoid;
use crate::gear::{SpurGear, Vector, radial};

/// The boundary of one half of the sector from the form point down: fillet, then root land, by length.
#[derive(Debug)]
pub(super) struct RootCurve {
    pub(super) fillet: Trochoid,
    /// Values of γ at equal steps, and the length of the fillet up to each.
    table: Vec<(f64, f64)>,
    root_radius: f64,
    land_angle: f64,
    half_pitch: f64,
}

impl RootCurve {
    pub(super) fn new(gear: &SpurGear) -> Self {
        const STEPS: usize = 400;
        let fillet = gear.fillet();
        let (gamma_0, gamma_1) = fillet.ends();
        let mut table = vec![(gamma_0, 0.0)];
        let (mut last, mut length) = (fillet.point(gamma_0), 0.0);
        for i in 1..=STEPS {
            let gamma = gamma_0 + (gamma_1 - gamma_0) * i as f64 / STEPS as f64;
            let point = fillet.point(gamma);
            length += (point - last).norm();
            table.push((gamma, length));
            last = point;
        }
        let half_pitch = gear.pitch_angle() / 2.0;
        Self {
            fillet,
            table,
            root_radius: gear.root_radius(),
            // Where the rack's tip land vanishes, rounding must not let the fillet pass the side.
            land_angle: last.y.atan2(last.x).min(half_pitch),
            half_pitch,
        }
    }

    fn fillet_length(&self) -> f64 {
        self.table.last().map_or(0.0, |(_, length)| *length)
    }

    pub(super) fn length(&self) -> f64 {
        self.fillet_length() + self.root_radius * (self.half_pitch - self.land_angle)
    }

    /// The length of the fillet down to γ = `gamma`.
    pub(super) fn length_at(&self, gamma: f64) -> f64 {
        let i = self
            .table
            .partition_point(|(g, _)| *g < gamma)
            .clamp(1, self.table.len() - 1);
        let ((g_0, s_0), (g_1, s_1)) = (self.table[i - 1], self.table[i]);
        s_0 + (s_1 - s_0) * (gamma - g_0) / (g_1 - g_0)
    }

    /// The point at `length` from the form point, on the true curve.
    pub(super) fn point(&self, length: f64) -> Vector {
        let past = length - self.fillet_length();
        if past >= 0.0 {
            let angle = (self.land_angle + past / self.root_radius).min(self.half_pitch);
            return self.root_radius * radial(angle);
        }
        let i = self
            .table
            .partition_point(|(_, s)| *s < length)
            .clamp(1, self.table.len() - 1);
        let ((g_0, s_0), (g_1, s_1)) = (self.table[i - 1], self.table[i]);
        self.fillet
            .point(g_0 + (g_1 - g_0) * (length - s_0) / (s_1 - s_0))
    }
}
