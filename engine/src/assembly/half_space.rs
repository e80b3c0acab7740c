//! What a half space yields between lines along a flank: the singular part of what a tooth yields under its own load.

use std::f64::consts::PI;

use faer::Mat;

use crate::fem::axial::AxialBasis;
use crate::gear::{Material, SolidGear};

/// The half space's compliance between lines along the flank: (1 − ν²)/(π E) ∫∫ f_p f_q / distance.
pub(super) struct HalfSpace {
    points: Vec<(f64, Vec<f64>)>,
    scale: f64,
    twist: f64,
    base_radius: f64,
    along: f64,
}

impl HalfSpace {
    pub(super) fn new(gear: &SolidGear, axial: &AxialBasis, least_distance: f64) -> Self {
        let section = gear.section();
        let Material {
            youngs_modulus: e,
            poisson_ratio: nu,
            ..
        } = *section.material();
        let breaks = axial.breaks();
        let longest = breaks
            .windows(2)
            .map(|ends| ends[1] - ends[0])
            .fold(0.0, f64::max);
        // Three points to the shortest distance of two lines resolve what is between them.
        let count = (3.0 * longest / least_distance).ceil() as usize + 12;
        let points = axial.rule(count).into_iter().map(|(z, w)| {
            let weighted = axial.values(z).into_iter().map(|f| w * f).collect();
            (z, weighted)
        });
        Self {
            points: points.collect(),
            scale: (1.0 - nu * nu) / (PI * e),
            twist: gear.twist(),
            base_radius: section.base_radius(),
            along: 1.0 / gear.base_helix_angle().cos(),
        }
    }

    /// Between the displacement at roll length `s` and the load at `loaded`.
    pub(super) fn between(&self, s: f64, loaded: f64) -> Mat<f64> {
        let m = self.points[0].1.len();
        let level = (s * s - loaded * loaded) / (2.0 * self.base_radius);
        let slope = self.twist * f64::midpoint(s, loaded);
        let mut sum = Mat::zeros(m, m);
        let mut line = vec![0.0; m];
        for (z, f) in &self.points {
            line.fill(0.0);
            for (z_loaded, g) in &self.points {
                let apart = z - z_loaded;
                let (across, along) = (level - slope * apart, self.along * apart);
                let near = self.scale / (across * across + along * along).sqrt();
                for (sum, g) in line.iter_mut().zip(g) {
                    *sum += near * g;
                }
            }
            for (q, line) in line.iter().enumerate() {
                for (p, f) in f.iter().enumerate() {
                    sum[(p, q)] += f * line;
                }
            }
        }
        sum
    }
}
