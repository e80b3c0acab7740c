//! The formulas of a pair of gears: which pairs of teeth touch at a position, and how much each yields.

use super::approach::{ContactBody, LineContact};
use super::half_plane;
use super::iso6336;
use super::profile::ToothProfile;
use super::range::Formula;
use super::sainsot::Ring;
use super::sharing::LinePair;
use super::tooth_load::ToothLoad;
use super::weber_banaschek::ToothCompliance;
use super::{BodyFormula, FormulaError, Formulas, ToothFormula};
use crate::gear::{GearPair, Member, PairDeviations};

/// Loss of the path of contact by rounding, in base pitches: at a contact ratio of one no position stays empty.
const ROUNDING: f64 = 1e-9;
/// The least radius of curvature at a contact over the length of the line of action. On the base circle there is none, and
/// Hertz's pressure has no limit.
const LEAST_CURVATURE: f64 = 1e-6;

/// The formulas of a pair, with the data of its gears made once.
pub struct PairFormulas<'a> {
    pair: &'a GearPair,
    deviations: PairDeviations,
    formulas: Formulas,
    law: Law,
}

/// Compliance of a pair of teeth.
enum Law {
    /// By the sum over its parts; the flanks' approach stands beside it.
    Parts([GearParts; 2]),
    /// By one stiffness per unit of width, in N/m², which contains the approach.
    Whole(f64),
}

/// Data of one gear for the formulas.
struct GearParts {
    profile: ToothProfile,
    ring: Ring,
}

impl<'a> PairFormulas<'a> {
    /// The `formulas` of `pair`.
    pub fn new(pair: &'a GearPair, formulas: Formulas) -> Self {
        let parts = |member| {
            let gear = pair.gear(member);
            GearParts {
                profile: ToothProfile::of(gear),
                ring: Ring::of(gear),
            }
        };
        let law = match formulas.tooth {
            ToothFormula::WeberBanaschek => Law::Parts(Member::BOTH.map(parts)),
            ToothFormula::Iso6336 => Law::Whole(iso6336::single_stiffness(pair)),
        };
        Self {
            pair,
            deviations: pair.deviations(),
            formulas,
            law,
        }
    }

    /// The pairs of teeth on the path of contact at mesh position `eta`.
    ///
    /// # Errors
    ///
    /// [`FormulaError::NoCompliance`] where a formula gives no positive compliance, [`FormulaError::NoContact`].
    pub fn pairs_at(&self, eta: f64) -> Result<Vec<LinePair>, FormulaError> {
        let (s_a, s_e) = self.pair.path_of_contact();
        let (s_c, p_b) = (self.pair.pitch_roll_length(), self.pair.base_pitch());
        // The pair that passes the pitch point at mesh position n touches at s_C + (η − n) p_b.
        let first = (eta - (s_e - s_c) / p_b - ROUNDING).ceil() as i64;
        let last = (eta - (s_a - s_c) / p_b + ROUNDING).floor() as i64;
        if first > last {
            return Err(FormulaError::NoContact { mesh_position: eta });
        }
        (first..=last)
            .map(|n| {
                let offset = (n - eta.floor() as i64) as i32;
                self.line_pair(n, offset, s_c + (eta - n as f64) * p_b)
            })
            .collect()
    }

    /// The mesh positions, in the mesh period after `first`, just before and just behind which a pair comes to the line of contact or leaves it.
    pub fn ends_of_contact(&self, first: f64) -> Vec<f64> {
        /// Mesh periods to either side: far above rounding, and nothing moves by a digit that is shown.
        const BESIDE: f64 = 1e-7;
        let (s_a, s_e) = self.pair.path_of_contact();
        let (s_c, p_b) = (self.pair.pitch_roll_length(), self.pair.base_pitch());
        let fraction = |s: f64| ((s - s_c) / p_b - first).rem_euclid(1.0);
        let beside = |fraction: f64| [-BESIDE, BESIDE].map(|by| fraction + by);
        let each = [s_a, s_e].map(fraction).into_iter().flat_map(beside);
        each.map(|fraction| first + fraction.rem_euclid(1.0))
            .collect()
    }

    /// The pair n of teeth, at `offset`, that touches at the roll length `s` of the driving gear.
    fn line_pair(&self, n: i64, offset: i32, s: f64) -> Result<LinePair, FormulaError> {
        let (line, width) = (self.pair.line_of_action(), self.pair.common_face_width());
        let least = LEAST_CURVATURE * line;
        let rolls = [s, line - s].map(|roll| roll.max(least));
        let loads = Member::BOTH
            .map(|member| ToothLoad::at_roll_length(self.pair.gear(member), rolls[member.index()]));
        let gap = Member::BOTH.map(|member| {
            let gear = self.pair.gear(member);
            let s = rolls[member.index()];
            let tooth = self.pair.tooth(member, n);
            let deviations = self.deviations.of_gear(member);
            deviations.missing(gear, tooth, s, 0.0)
        });
        let bodies = Member::BOTH.map(|member| ContactBody {
            material: *self.pair.gear(member).material(),
            curvature_radius: rolls[member.index()],
            depth: loads[member.index()].depth,
        });
        let (compliance, with_approach) = match &self.law {
            Law::Parts(parts) => (self.sum_of_parts(parts, loads)?, true),
            Law::Whole(stiffness) => {
                let compliance = 1.0 / (stiffness * width);
                (positive(compliance, Formula::Iso6336, None)?, false)
            }
        };
        Ok(LinePair {
            offset,
            compliance,
            gap: gap[0] + gap[1],
            contact: LineContact::new(bodies, width, self.formulas.plane_state),
            with_approach,
        })
    }

    /// The compliance of teeth and bodies under `loads`, in m/N: each gear with its own face width.
    fn sum_of_parts(
        &self,
        parts: &[GearParts; 2],
        loads: [ToothLoad; 2],
    ) -> Result<f64, FormulaError> {
        let mut sum = 0.0;
        for member in Member::BOTH {
            let (parts, load) = (&parts[member.index()], &loads[member.index()]);
            sum += self.tooth(member, &parts.profile, load)?;
            sum += self.body(member, &parts.ring, load)?;
        }
        Ok(sum)
    }

    fn tooth(
        &self,
        member: Member,
        profile: &ToothProfile,
        load: &ToothLoad,
    ) -> Result<f64, FormulaError> {
        let gear = self.pair.gear(member);
        let tooth = ToothCompliance::new(
            profile.half_thicknesses(),
            load,
            gear.face_width(),
            gear.material(),
            self.formulas.plane_state,
        );
        positive(tooth.total(), Formula::WeberBanaschek, Some(member))
    }

    fn body(&self, member: Member, ring: &Ring, load: &ToothLoad) -> Result<f64, FormulaError> {
        let gear = self.pair.gear(member);
        let (b, material) = (gear.face_width(), gear.material());
        match self.formulas.body {
            BodyFormula::Rigid => Ok(0.0),
            BodyFormula::Sainsot => {
                let compliance = ring.compliance(load, b, material.youngs_modulus);
                positive(compliance, Formula::Sainsot, Some(member))
            }
            BodyFormula::HalfPlane => {
                let (width, plane) = (ring.root_width(), self.formulas.plane_state);
                let compliance = half_plane::compliance(load, width, b, material, plane);
                positive(compliance, Formula::HalfPlane, Some(member))
            }
        }
    }
}

/// Hands a compliance on if it is one.
fn positive(
    compliance: f64,
    formula: Formula,
    member: Option<Member>,
) -> Result<f64, FormulaError> {
    if compliance > 0.0 && compliance.is_finite() {
        Ok(compliance)
    } else {
        Err(FormulaError::NoCompliance {
            formula,
            member,
            compliance,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{PlaneState, SpurGear};

    fn formulas(tooth: ToothFormula, body: BodyFormula) -> Formulas {
        Formulas {
            tooth,
            body,
            plane_state: PlaneState::Strain,
        }
    }

    /// The standard pair in the steel of ISO 6336, with these face widths.
    fn standard_pair(widths: [f64; 2]) -> GearPair {
        let [one, other] = widths.map(|width| {
            let mut data = paper_gear(50);
            data.face_width = width;
            data.material.youngs_modulus = 206e9;
            SpurGear::new(data).expect("the standard gear")
        });
        GearPair::new(one, other, 100.5e-3).expect("the standard pair")
    }

    #[test]
    fn the_sum_of_the_formulas_at_the_pitch_point_lies_near_the_single_stiffness_of_iso() {
        // ISO's q' is a fit to sums of this very kind; the load, 300 N/mm, is one of many: 10 % allows for that.
        let (pair, force) = (standard_pair([20e-3; 2]), 6000.0);
        let at_pitch_point = |tooth, body| {
            PairFormulas::new(&pair, formulas(tooth, body))
                .pairs_at(0.0)
                .expect("the standard pair has formulas")
                .remove(0)
        };
        let sum = at_pitch_point(ToothFormula::WeberBanaschek, BodyFormula::HalfPlane);
        let whole = at_pitch_point(ToothFormula::Iso6336, BodyFormula::HalfPlane);
        let of_sum = sum.compliance + sum.contact.approach(force) / force;
        assert!(
            (of_sum / whole.compliance - 1.0).abs() < 0.1,
            "{of_sum:e} beside {:e} m/N",
            whole.compliance
        );
    }

    #[test]
    fn bodies_yield_by_their_own_width_and_the_contact_by_the_common_one() {
        let at_pitch_point = |tooth, widths| {
            let pair = standard_pair(widths);
            PairFormulas::new(&pair, formulas(tooth, BodyFormula::Sainsot))
                .pairs_at(0.0)
                .expect("the standard pair has formulas")
                .remove(0)
        };
        let parts = |widths| at_pitch_point(ToothFormula::WeberBanaschek, widths);
        let (narrow, wide, unlike) = (parts([20e-3; 2]), parts([30e-3; 2]), parts([20e-3, 30e-3]));
        let mean = f64::midpoint(narrow.compliance, wide.compliance);
        assert!((unlike.compliance / mean - 1.0).abs() < 1e-12);
        assert_eq!(unlike.contact, narrow.contact);
        let whole = |widths| at_pitch_point(ToothFormula::Iso6336, widths);
        assert_eq!(whole([30e-3, 20e-3]), whole([20e-3; 2]));
    }

    #[test]
    fn at_a_contact_ratio_of_one_no_position_is_without_a_pair() {
        let at = |a| {
            let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
            GearPair::new(gear.clone(), gear, a)
        };
        // 102.074 mm, to the last digit.
        let largest = crate::root_finding::bisect(101e-3, 103e-3, |a| at(a).is_ok());
        let pair = at(largest).expect("just meshes");
        assert!(pair.contact_ratio() < 1.0 + 1e-9);
        let formulas = PairFormulas::new(
            &pair,
            formulas(ToothFormula::WeberBanaschek, BodyFormula::Sainsot),
        );
        for i in 0..4000 {
            let pairs = formulas.pairs_at(f64::from(i) / 4000.0);
            assert!(pairs.is_ok_and(|pairs| !pairs.is_empty()), "position {i}");
        }
    }
}
