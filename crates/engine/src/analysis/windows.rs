//! Windows: stretches of a true period that is too long to be computed as a whole, where they stand, and one answer of them all.

use super::case::Case;
use super::curve::{Curve, FaceLoad, LoadShare};
use super::evidence::{ErrorEstimate, Evidence};
use super::mesh_wave::MeshWave;
use super::pressures::CurvePressures;
use super::single_flank::SingleFlank;
use super::statistics::{SamplingError, Statistics};
use super::stress::GearStresses;
use super::{Analysis, Resolution};
use crate::gear::{GearPair, Member};

impl Case {
    /// A case for each of its windows; itself where it has none.
    pub(super) fn windowed(&self) -> Vec<Self> {
        let at = |&window: &u32| Self {
            resolution: Resolution {
                first_position: f64::from(window),
                ..self.resolution
            },
            windows: vec![window],
            ..self.clone()
        };
        match self.windows.len() {
            0 => vec![self.clone()],
            _ => self.windows.iter().map(at).collect(),
        }
    }
}

/// First positions of windows of `mesh_periods` in the true period of `pair`, rising: at most `count` of them, none of which overlaps another.
///
/// The first has the largest step from one tooth pair to the next in its middle, at which tooth-to-tooth errors are largest: the change of the distance of both
/// flanks from each other at the pitch point, runout included. Each further one has the largest remaining step. Where teeth do not deviate they are spread
/// evenly.
pub fn windows_at_largest_steps(pair: &GearPair, mesh_periods: u32, count: usize) -> Vec<u32> {
    let (period, deviations) = (pair.period(), pair.deviations());
    let s = pair.pitch_roll_length();
    let rolls = [s, pair.line_of_action() - s];
    let towards = Member::BOTH.map(|member| -> Vec<f64> {
        let (gear, own) = (pair.gear(member), deviations.of_gear(member));
        let s = rolls[member.index()];
        let of = |tooth: usize| own.at(tooth, s) + own.runout(gear, tooth, s, 0.0);
        (0..gear.tooth_count() as usize).map(of).collect()
    });
    let of_pair = |n: u32| -> f64 {
        let teeth = pair.teeth(i64::from(n));
        Member::BOTH
            .map(|member| towards[member.index()][teeth[member.index()]])
            .iter()
            .sum()
    };
    let mut steps: Vec<(f64, u32)> = (0..period)
        .map(|n| ((of_pair(n + 1) - of_pair(n)).abs(), n))
        .collect();
    if steps.iter().all(|(step, _)| *step == 0.0) {
        let places = (0..count).map(|k| (k * period as usize / count.max(1)) as u32);
        return places.collect();
    }
    steps.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut starts: Vec<u32> = Vec::with_capacity(count);
    for (_, n) in steps {
        let start = (n + 1 + period - mesh_periods.div_ceil(2)) % period;
        let is_apart = |other: &u32| {
            let apart = start.abs_diff(*other);
            apart.min(period - apart) >= mesh_periods
        };
        if starts.len() < count && starts.iter().all(is_apart) {
            starts.push(start);
        }
    }
    starts.sort_unstable();
    starts
}

/// The answer to a case with windows, of the `analyses` of each.
pub(super) fn joined(mut analyses: Vec<Analysis>) -> Analysis {
    if analyses.len() == 1 {
        return analyses.remove(0);
    }
    let evidence = analyses.iter().map(|analysis| analysis.evidence);
    let evidence = evidence.fold(Evidence::new(0), both);
    let mut warnings = Vec::new();
    let mut curves: Vec<Vec<Curve>> = Vec::new();
    for analysis in analyses {
        for warning in analysis.warnings {
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        curves.resize_with(analysis.curves.len(), Vec::new);
        let torques = curves.iter_mut().zip(analysis.curves);
        torques.for_each(|(windows, curve)| windows.push(curve));
    }
    Analysis {
        curves: curves.into_iter().filter_map(curve_of).collect(),
        evidence,
        warnings,
        hole_phase: None,
    }
}

/// The evidence of two windows of one model.
fn both(one: Evidence, other: Evidence) -> Evidence {
    let larger = |one: Option<f64>, other: Option<f64>| match (one, other) {
        (Some(one), Some(other)) => Some(one.max(other)),
        (known, None) | (None, known) => known,
    };
    let error_estimate = match (one.error_estimate, other.error_estimate) {
        (Some(one), Some(other)) => Some(ErrorEstimate {
            mean: one.mean.max(other.mean),
            peak_to_peak: one.peak_to_peak.max(other.peak_to_peak),
            mean_stiffness: one.mean_stiffness.max(other.mean_stiffness),
        }),
        (known, None) | (None, known) => known,
    };
    Evidence {
        degrees_of_freedom: one.degrees_of_freedom.max(other.degrees_of_freedom),
        equilibrium_residual: one.equilibrium_residual.max(other.equilibrium_residual),
        complementarity_residual: one
            .complementarity_residual
            .max(other.complementarity_residual),
        largest_penetration: one.largest_penetration.max(other.largest_penetration),
        contact_iterations: one.contact_iterations + other.contact_iterations,
        projection_error: larger(one.projection_error, other.projection_error),
        decomposition_error: larger(one.decomposition_error, other.decomposition_error),
        error_estimate,
    }
}

/// The curve of one torque over all windows, which are equally long, of that over each.
fn curve_of(windows: Vec<Curve>) -> Option<Curve> {
    let whole = Curve {
        mesh_position: each(&windows, |curve| &curve.mesh_position),
        transmission_error: each(&windows, |curve| &curve.transmission_error),
        mesh_stiffness_tangent: each(&windows, |curve| &curve.mesh_stiffness_tangent),
        mesh_stiffness_secant: each(&windows, |curve| &curve.mesh_stiffness_secant),
        driving_torque: each(&windows, |curve| &curve.driving_torque),
        pairs_in_contact: each(&windows, |curve| &curve.pairs_in_contact),
        peak_contact_pressure: each(&windows, |curve| &curve.peak_contact_pressure),
        pressures: pressures(&windows),
        points: each(&windows, |curve| &curve.points),
        peak_pressures_between: each(&windows, |curve| &curve.peak_pressures_between),
        load_shares: load_shares(&windows),
        transmission_error_statistics: statistics(&windows, |curve| {
            &curve.transmission_error_statistics
        }),
        mesh_stiffness_tangent_statistics: statistics(&windows, |curve| {
            &curve.mesh_stiffness_tangent_statistics
        }),
        single_flank: SingleFlank {
            tooth_to_tooth: largest(&windows, |curve| curve.single_flank.tooth_to_tooth),
            long_wave: None,
            short_wave: None,
            mesh_harmonics_rms: None,
        },
        sampling_error: SamplingError {
            mean: mean(&windows, |curve| curve.sampling_error.mean),
            peak_to_peak: largest(&windows, |curve| curve.sampling_error.peak_to_peak),
        },
        mesh_wave: MeshWave::mean(windows.iter().filter_map(|curve| curve.mesh_wave.as_ref())),
        face: face(&windows),
        stresses: stresses(&windows),
        ..windows.first()?.clone()
    };
    let rigid = |curve: &Curve| {
        let parts = curve.decomposition.as_ref();
        parts.map_or_else(Vec::new, |parts| {
            parts.rigid_blank_transmission_error.clone()
        })
    };
    let rigid = windows.iter().flat_map(rigid).collect();
    Some(Curve {
        decomposition: whole.decomposition.map(|mut parts| {
            parts.rigid_blank_transmission_error = rigid;
            parts
        }),
        ..whole
    })
}

/// A list of all windows, one behind the other.
fn each<T: Clone>(windows: &[Curve], list: impl Fn(&Curve) -> &Vec<T>) -> Vec<T> {
    windows.iter().flat_map(list).cloned().collect()
}

fn mean(windows: &[Curve], value: impl Fn(&Curve) -> f64) -> f64 {
    windows.iter().map(value).sum::<f64>() / windows.len() as f64
}

fn largest(windows: &[Curve], value: impl Fn(&Curve) -> f64) -> f64 {
    windows.iter().map(value).fold(f64::NEG_INFINITY, f64::max)
}

fn statistics(windows: &[Curve], of: impl Fn(&Curve) -> &Statistics) -> Statistics {
    let all = mean(windows, |curve| of(curve).mean);
    let square = mean(windows, |curve| {
        of(curve).rms.powi(2) + (of(curve).mean - all).powi(2)
    });
    let ends = windows.iter().map(&of).copied().reduce(|one, other| {
        let (low, high) = (other.smallest < one.smallest, other.largest > one.largest);
        Statistics {
            smallest: if low { other.smallest } else { one.smallest },
            smallest_at: if low {
                other.smallest_at
            } else {
                one.smallest_at
            },
            largest: if high { other.largest } else { one.largest },
            largest_at: if high {
                other.largest_at
            } else {
                one.largest_at
            },
            ..one
        }
    });
    let ends = ends.unwrap_or_default();
    Statistics {
        mean: all,
        rms: square.sqrt(),
        peak_to_peak: ends.largest - ends.smallest,
        ..ends
    }
}

fn pressures(windows: &[Curve]) -> CurvePressures {
    let each = windows.iter().map(|curve| curve.pressures);
    let both = |one: CurvePressures, other: CurvePressures| CurvePressures {
        largest: match (one.largest, other.largest) {
            (Some(one), Some(other)) if other.pressure > one.pressure => Some(other),
            (Some(one), Some(_)) => Some(one),
            _ => None,
        },
        smooth: match (one.smooth, other.smooth) {
            (Some(one), Some(other)) => Some(one.max(other)),
            (known, None) | (None, known) => known,
        },
        ..one
    };
    CurvePressures {
        unbounded_share: mean(windows, |curve| curve.pressures.unbounded_share),
        ..each.reduce(both).unwrap_or_default()
    }
}

/// The shares of the pairs that carry load in any window.
fn load_shares(windows: &[Curve]) -> Vec<LoadShare> {
    let offsets = windows.iter().flat_map(|curve| &curve.load_shares);
    let mut offsets: Vec<i32> = offsets.map(|share| share.pair_offset).collect();
    offsets.sort_unstable();
    offsets.dedup();
    let of_window = |curve: &Curve, offset: i32| {
        let mut own = curve.load_shares.iter();
        let own = own.find(|share| share.pair_offset == offset);
        own.map_or_else(
            || vec![0.0; curve.mesh_position.len()],
            |own| own.share.clone(),
        )
    };
    let of = |pair_offset: i32| LoadShare {
        pair_offset,
        share: windows
            .iter()
            .flat_map(|curve| of_window(curve, pair_offset))
            .collect(),
    };
    offsets.into_iter().map(of).collect()
}

/// The load along the face: means over the positions are those of the windows, and the lead that evens it is that of the first.
fn face(windows: &[Curve]) -> Option<FaceLoad> {
    let faces = windows.iter().map(|curve| curve.face.as_ref());
    let faces: Vec<&FaceLoad> = faces.collect::<Option<_>>()?;
    let first = *faces.first()?;
    let is_mean = first.load.len() == 1 && first.load_centroid.len() > 1;
    let rows = || faces.iter().flat_map(|face| &face.load);
    let load = if is_mean {
        let places = 0..first.heights.len();
        let sums = places.map(|i| rows().map(|row| row[i]).sum::<f64>());
        vec![sums.map(|sum| sum / faces.len() as f64).collect()]
    } else {
        rows().cloned().collect()
    };
    let centroids = faces.iter().flat_map(|face| &face.load_centroid);
    let factors = faces.iter().map(|face| face.face_load_factor);
    Some(FaceLoad {
        load,
        face_load_factor: factors.sum::<f64>() / faces.len() as f64,
        load_centroid: centroids.copied().collect(),
        ..first.clone()
    })
}

fn stresses(windows: &[Curve]) -> Option<[GearStresses; 2]> {
    let mut windows = windows.iter().map(|curve| curve.stresses.clone());
    let mut all = windows.next()??;
    for stresses in windows {
        for (all, own) in all.iter_mut().zip(stresses?) {
            all.root.extend(own.root);
            all.root_tension.extend(own.root_tension);
            all.root_compression.extend(own.root_compression);
            all.holes.extend(own.holes);
            all.between.extend(own.between);
        }
    }
    Some(all)
}
