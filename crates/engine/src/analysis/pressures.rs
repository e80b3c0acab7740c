//! Summary of the pressures of a curve.

use super::Case;
use super::largest_where::LargestPressure;
use crate::contact::MeshContact;
use crate::flank::half_plane::{hertz, logarithm_factor};
use crate::gear::{Member, PlaneState};

/// Summary of the pressures of a curve over its span, between its positions too.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CurvePressures {
    /// The largest pressure and where it stands; `None` where one has no limit, and without load.
    pub largest: Option<LargestPressure>,
    /// The largest in Pa at least half the width of the contact away from kinks of the flanks, and on pairs of which no sharp corner carries; `None` where there
    /// is none.
    pub smooth: Option<f64>,
    /// The part of the span, from 0 to 1, in which a sharp corner carries.
    pub unbounded_share: f64,
    /// Hertz's pressure in Pa at the pitch point under the whole load ([`at_pitch_point`]).
    pub at_pitch_point: Option<f64>,
}

impl CurvePressures {
    /// Summary of the `contacts` of `case` under `load`: the mesh position and the contact at each, which repeat after a number of mesh periods.
    pub(super) fn of<'a>(
        (case, load): (&Case, f64),
        contacts: impl Iterator<Item = (f64, &'a MeshContact)> + Clone,
        repeats_after: u32,
    ) -> Self {
        let each = contacts.clone();
        let pressures = each.map(|(eta, contact)| (eta, contact.peak_pressure, contact.peak_place));
        let each = contacts.clone();
        let smooth = each.map(|(_, contact)| contact.smooth_pressure);
        let smooth = smooth.fold(0.0, f64::max);
        let corners = contacts.map(|(eta, contact)| (eta, contact.peak_pressure.is_none()));
        Self {
            largest: LargestPressure::of(pressures),
            smooth: (smooth > 0.0 || load == 0.0).then_some(smooth),
            unbounded_share: share_of((case, repeats_after), corners),
            at_pitch_point: at_pitch_point(case, load),
        }
    }
}

/// Hertz's pressure in Pa at the working pitch point of the pair of `case`.
///
/// One pair carries the whole `load` across the common face. The curvature is that of the flanks normal to the line of contact. The factors of contact
/// ratio and helix of ISO 6336-2, which lower it, are 1. `None` where the pitch point lies outside the path of contact from A to E.
pub fn at_pitch_point(case: &Case, load: f64) -> Option<f64> {
    let pair = &case.pair;
    let (s_a, s_e) = pair.path_of_contact();
    let s_1 = pair.pitch_roll_length();
    if !(s_a..=s_e).contains(&s_1) {
        return None;
    }
    let s_2 = pair.line_of_action() - s_1;
    let cosine = case
        .faces()
        .map_or(1.0, |faces| faces.pair.base_helix_angle().cos());
    // In the normal section radii and force are 1/cos β_b times those of the transverse one, and so is the length of the line across the face.
    let radius = s_1 * s_2 / (s_1 + s_2) / cosine;
    let length = pair.common_face_width() / cosine;
    let factor = |member: Member| {
        let material = pair.gear(member).material();
        logarithm_factor(material.plane_modulus(PlaneState::Strain), length)
    };
    let factors = Member::BOTH.map(factor).into_iter().sum();
    Some(hertz(load / cosine, radius, factors, length).1)
}

/// The part of the span of `case` in which something is so, known at mesh positions that repeat after a number of mesh periods: halfway between two of them where it
/// is so at one.
fn share_of((case, repeats_after): (&Case, u32), known: impl Iterator<Item = (f64, bool)>) -> f64 {
    let (first, length) = (case.resolution.first_position, f64::from(repeats_after));
    let mut known: Vec<(f64, bool)> = known
        .map(|(eta, is_so)| ((eta - first).rem_euclid(length), is_so))
        .collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(begin, is_so)) = known.first() else {
        return 0.0;
    };
    // A part of a period ends a step beyond its last position, at which it is as at that.
    let closes = case.covers_whole_periods() || repeats_after < case.span();
    let last = known.last().map_or(is_so, |last| last.1);
    known.push((begin + length, if closes { is_so } else { last }));
    let between = known.windows(2).map(|two| {
        let times = f64::from(u8::from(two[0].1)) + f64::from(u8::from(two[1].1));
        0.5 * times * (two[1].0 - two[0].0)
    });
    (between.sum::<f64>() / length).clamp(0.0, 1.0)
}
