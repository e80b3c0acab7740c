//! Load sharing of the pairs at one position (eqs. 4 and 5).
//!
//! Each pair yields on its own, δ = C F_n + h(F_n) + e with the compliance C of its teeth and bodies, the approach h of its
//! flanks and their reliefs e, so that H of eq. 4 is diagonal. The F_n follow from δ pair by pair, and δ from their sum.

use super::approach::LineContact;

/// A pair of teeth on the line of contact.
#[derive(Debug, Clone, PartialEq)]
pub struct LinePair {
    /// n − floor(η).
    pub(super) offset: i32,
    /// C, in m/N; positive.
    pub(super) compliance: f64,
    /// The reliefs e of both flanks, in m.
    pub(super) gap: f64,
    /// The flanks at their contact.
    pub(super) contact: LineContact,
    /// True if h stands beside C; ISO's stiffness contains it.
    pub(super) with_approach: bool,
}

impl LinePair {
    /// C F + h(F) under `force` (N).
    fn deflection(&self, force: f64) -> f64 {
        let own = self.compliance * force;
        if self.with_approach && force > 0.0 {
            own + self.contact.approach(force)
        } else {
            own
        }
    }

    /// dF/dδ under `force` (N); zero without a force.
    fn stiffness(&self, force: f64) -> f64 {
        if force <= 0.0 {
            0.0
        } else if self.with_approach {
            1.0 / (self.compliance + self.contact.tangent_compliance(force))
        } else {
            1.0 / self.compliance
        }
    }

    /// The force, at most `most`, that deflects the pair by `deflection` (m).
    ///
    /// The deflection grows slower than the force: it lies above its chords from 0 and below its tangents. A force on the chord is too
    /// large, and from one that is too small Newton's steps rise without going too far, until rounding ends them.
    fn force(&self, deflection: f64, most: f64) -> f64 {
        if deflection <= 0.0 {
            return 0.0;
        }
        if !self.with_approach {
            return deflection / self.compliance;
        }
        let chord = most.min(deflection / self.deflection(most) * most);
        let newton =
            |force: f64| force + (deflection - self.deflection(force)) * self.stiffness(force);
        let mut force = newton(chord);
        if force <= 0.0 {
            force = chord;
            while self.deflection(force) > deflection {
                force /= 2.0;
            }
        }
        loop {
            let next = newton(force);
            // A step that does not lead up, or is no number, ends it.
            if next.is_nan() || next <= force {
                return force.min(most);
            }
            force = next;
        }
    }
}

/// State of the pairs at one position under a load.
#[derive(Debug, Clone, PartialEq)]
pub struct Shared {
    /// δ in m.
    pub transmission_error: f64,
    /// dF/dδ in N/m.
    pub stiffness: f64,
    /// The largest p_0 in Pa.
    pub peak_pressure: f64,
    /// The offset of the pair that has it.
    pub peak_offset: i32,
    /// Offset and force (N) of each pair.
    pub forces: Vec<(i32, f64)>,
    /// |Σ F_n − F|/F.
    pub residual: f64,
}

impl Shared {
    /// The pairs that carry load.
    pub fn loaded(&self) -> impl Iterator<Item = (i32, f64)> {
        self.forces
            .iter()
            .copied()
            .filter(|&(_, force)| force > 0.0)
    }

    /// The share of `load` (N) that the pair at `offset` carries.
    pub fn share(&self, offset: i32, load: f64) -> f64 {
        self.forces
            .iter()
            .find(|force| force.0 == offset)
            .map_or(0.0, |force| force.1 / load)
    }
}

/// Shares `load` (N, positive) among `pairs`, of which there is at least one.
pub fn share(pairs: &[LinePair], load: f64) -> Shared {
    let first = first_gap(pairs);
    let rise = rise(pairs, load);
    let forces: Vec<f64> = pairs
        .iter()
        .map(|pair| pair.force(rise - (pair.gap - first), load))
        .collect();
    let loaded = || pairs.iter().zip(&forces).filter(|(_, force)| **force > 0.0);
    let pressures = loaded().map(|(pair, &force)| (pair.offset, pair.contact.peak_pressure(force)));
    let (peak_offset, peak_pressure) =
        pressures.fold(
            (0, 0.0),
            |peak, next| {
                if next.1 > peak.1 { next } else { peak }
            },
        );
    Shared {
        transmission_error: first + rise,
        stiffness: loaded().map(|(pair, &force)| pair.stiffness(force)).sum(),
        peak_pressure,
        peak_offset,
        residual: (forces.iter().sum::<f64>() - load).abs() / load,
        forces: pairs.iter().map(|pair| pair.offset).zip(forces).collect(),
    }
}

/// The gap of the pair that touches first, in m.
fn first_gap(pairs: &[LinePair]) -> f64 {
    pairs
        .iter()
        .map(|pair| pair.gap)
        .fold(f64::INFINITY, f64::min)
}

/// Where `pairs`, of which there is at least one, touch under no load: δ in m, and the offsets of those that do, as far as gaps of fractions of an
/// atom are told apart.
pub fn touch(pairs: &[LinePair]) -> (f64, Vec<i32>) {
    const TOGETHER: f64 = 1e-12;
    let first = first_gap(pairs);
    let touching = pairs.iter().filter(|pair| pair.gap - first <= TOGETHER);
    (first, touching.map(|pair| pair.offset).collect())
}

/// How far δ rises, in m, from the first touch until Σ F_n(δ) is `load`; by Newton's method.
///
/// The deflections grow slower than the forces, so each F_n(δ) is convex: from above, where one pair carries the whole load
/// alone, no step goes too far, and δ falls until rounding ends it. Counted from the first touch, δ keeps its digits under
/// loads that deflect by far less than the reliefs.
pub fn rise(pairs: &[LinePair], load: f64) -> f64 {
    let first = first_gap(pairs);
    let mut rise = pairs
        .iter()
        .map(|pair| pair.gap - first + pair.deflection(load))
        .fold(f64::INFINITY, f64::min);
    loop {
        let (mut sum, mut stiffness) = (0.0, 0.0);
        for pair in pairs {
            let force = pair.force(rise - (pair.gap - first), load);
            sum += force;
            stiffness += pair.stiffness(force);
        }
        let next = rise - (sum - load) / stiffness;
        // A step that does not lead down, or is no number, ends it.
        if next.is_nan() || next >= rise {
            return rise;
        }
        rise = next;
    }
}

#[cfg(test)]
mod tests {
    use super::super::approach::ContactBody;
    use super::*;
    use crate::gear::Material;
    use crate::gear::PlaneState;

    fn line_pair(offset: i32, compliance: f64, gap: f64, with_approach: bool) -> LinePair {
        let body = ContactBody {
            material: Material::STEEL,
            curvature_radius: 18e-3,
            depth: 1.6e-3,
        };
        LinePair {
            offset,
            compliance,
            gap,
            contact: LineContact::new([body, body], 20e-3, PlaneState::Stress),
            with_approach,
        }
    }

    #[test]
    fn springs_with_gaps_share_as_by_hand() {
        // 2 and 4 nm/N, the second 3 µm farther apart: up to 1500 N the first carries alone, from there F_1 = 1500 N + 2 F_2.
        let pairs = [
            line_pair(0, 2e-9, 1e-6, false),
            line_pair(1, 4e-9, 4e-6, false),
        ];
        let alone = share(&pairs, 1000.0);
        assert!((alone.transmission_error - 3e-6).abs() < 1e-18);
        assert_eq!(alone.loaded().count(), 1);
        assert!((alone.share(0, 1000.0) - 1.0).abs() < 1e-12);
        assert!((alone.stiffness / 0.5e9 - 1.0).abs() < 1e-12);
        // 4500 N are 3500 and 1000 N.
        let both = share(&pairs, 4500.0);
        assert!((both.transmission_error - 8e-6).abs() < 1e-17);
        assert!((both.share(0, 4500.0) - 3500.0 / 4500.0).abs() < 1e-12);
        assert!((both.share(1, 4500.0) - 1000.0 / 4500.0).abs() < 1e-12);
        assert!((both.stiffness / 0.75e9 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn flanks_that_approach_share_so_that_all_pairs_come_to_the_same_error() {
        let pairs = [
            line_pair(0, 2e-9, 0.0, true),
            line_pair(1, 3e-9, 1e-6, true),
        ];
        for load in [1e-6, 100.0, 3000.0, 1e9] {
            let shared = share(&pairs, load);
            assert!(shared.residual < 1e-12, "{load} N: {}", shared.residual);
            for (pair, (_, force)) in pairs.iter().zip(&shared.forces) {
                let delta = pair.gap + pair.deflection(*force);
                assert!(*force == 0.0 || (delta / shared.transmission_error - 1.0).abs() < 1e-12);
            }
            // k is dF/dδ: a central step of a thousandth leaves its square.
            let step = 1e-3 * load;
            let stepped = 2.0 * step / (rise(&pairs, load + step) - rise(&pairs, load - step));
            assert!((shared.stiffness / stepped - 1.0).abs() < 1e-5, "{load} N");
        }
    }
}
