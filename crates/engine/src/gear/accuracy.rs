//! Tolerances of teeth: those of ISO 1328-1:2013, and teeth drawn at random within them.

use std::f64::consts::{PI, TAU};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::{Eccentricity, SpurGear, ToothDeviations};

/// The accuracy classes A of ISO 1328-1:2013, from the finest.
pub const CLASSES: [u32; 2] = [1, 11];

/// Tolerances of ISO 1328-1:2013 for a gear of an accuracy class, unrounded, in meters.
///
/// The formulas of the standard are for class 5, in µm of the reference diameter d, the module m_n and the face width b in mm; each
/// class is √2 times as wide as the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// f_pT: of a single pitch, 0.001 d + 0.4 m_n + 5.
    pub single_pitch: f64,
    /// F_pT: of the cumulative pitch around the gear, 0.002 d + 0.55 √d + 0.7 m_n + 12.
    pub total_pitch: f64,
    /// f_HαT: of the slope of a profile, 0.4 m_n + 0.001 d + 4.
    pub profile_slope: f64,
    /// f_fαT: of the form of a profile, 0.55 m_n + 5.
    pub profile_form: f64,
    /// F_rT: of the runout, 0.9 F_pT.
    pub runout: f64,
    /// f_HβT: of the slope of a helix, 0.05 √d + 0.35 √b + 4.
    pub helix_slope: f64,
}

impl Tolerances {
    /// Tolerances of `gear` in a class of [`CLASSES`].
    pub fn of(gear: &SpurGear, class: u32) -> Self {
        let mm = |length: f64| 1e3 * length;
        let (d, m_n, b) = (
            mm(2.0 * gear.reference_radius()),
            mm(gear.normal_rack().module),
            mm(gear.face_width()),
        );
        let steps = f64::from(class) - 5.0;
        let allowed = |um_in_class_5: f64| 1e-6 * um_in_class_5 * 2_f64.powf(steps / 2.0);
        let total_pitch = 0.002 * d + 0.55 * d.sqrt() + 0.7 * m_n + 12.0;
        Self {
            single_pitch: allowed(0.001 * d + 0.4 * m_n + 5.0),
            total_pitch: allowed(total_pitch),
            profile_slope: allowed(0.4 * m_n + 0.001 * d + 4.0),
            profile_form: allowed(0.55 * m_n + 5.0),
            runout: allowed(0.9 * total_pitch),
            helix_slope: allowed(0.05 * d.sqrt() + 0.35 * b.sqrt() + 4.0),
        }
    }

    /// Teeth of one gear as a production of this accuracy makes them.
    ///
    /// A tolerance is 3 c standard deviations wide to each side, c the `capability`. Single pitch deviations are independent and close by
    /// taking their mean away, and displace teeth as wholes; so are the slopes of the profiles, which keep theirs; the eccentricity has two components,
    /// each of σ = F_rT/(6 c), because a runout is twice an eccentricity. No tolerance is enforced: that is for an [`Inspection`]. Of `normals`, standard normal
    /// deviates, it takes one for each tooth's pitch, one for each tooth's slope, and two for the eccentricity.
    pub fn draw(
        &self,
        tooth_count: u32,
        capability: f64,
        mut normals: impl Iterator<Item = f64>,
    ) -> ToothDeviations {
        let sigma = |tolerance: f64| tolerance / (3.0 * capability);
        let mut each = |sigma: f64, count: u32| -> Vec<f64> {
            let taken = normals.by_ref().take(count as usize);
            taken.map(|normal| sigma * normal).collect()
        };
        let single = each(sigma(self.single_pitch), tooth_count);
        let profile_slope = each(sigma(self.profile_slope), tooth_count);
        let off_center = each(sigma(self.runout) / 2.0, 2);

        let mean = single.iter().sum::<f64>() / f64::from(tooth_count);
        let cumulative_pitch = single.iter().scan(0.0, |sum, pitch| {
            *sum += pitch - mean;
            Some(*sum)
        });
        ToothDeviations {
            cumulative_pitch: cumulative_pitch.collect(),
            other_cumulative_pitch: Vec::new(),
            profile_slope,
            lead_slope: Vec::new(),
            profiles: None,
            leads: None,
            eccentricity: match off_center[..] {
                [x, y] => Some(Eccentricity {
                    amount: (x * x + y * y).sqrt(),
                    direction: libm::atan2(y, x),
                }),
                _ => None,
            },
        }
    }
}

impl Tolerances {
    /// Slopes of the leads of teeth, of independent σ = f_HβT/(3 c); one of `normals` for each.
    pub fn draw_lead_slopes(
        &self,
        tooth_count: u32,
        capability: f64,
        normals: impl Iterator<Item = f64>,
    ) -> Vec<f64> {
        let sigma = self.helix_slope / (3.0 * capability);
        let taken = normals.take(tooth_count as usize);
        taken.map(|normal| sigma * normal).collect()
    }
}

/// A gear of an accuracy class as an inspector sees it: its teeth are measured from the bore and held to the tolerances.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspection {
    /// Tolerances of the class.
    pub tolerances: Tolerances,
    tooth_count: u32,
    pressure_angle: f64,
    /// The direction of the normal of the loaded flank of tooth 0 where it meets the reference circle, from the centerline of that tooth.
    normal: f64,
}

/// A gear that has passed, and the number of gears that were made for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Passed {
    /// Deviations of its teeth.
    pub teeth: ToothDeviations,
    /// The gears that were made, this one included.
    pub attempts: u32,
}

impl Inspection {
    /// Maximum number of gears drawn for one. Where one in a hundred passes, all of them fail two times of a thousand millions.
    pub const MOST_ATTEMPTS: u32 = 2000;

    /// Tolerances of `gear` in a class of [`CLASSES`].
    pub fn of(gear: &SpurGear, class: u32) -> Self {
        let pressure_angle = gear.data().rack.pressure_angle;
        let at_reference = gear.base_radius() * pressure_angle.tan();
        Self {
            tolerances: Tolerances::of(gear, class),
            tooth_count: gear.tooth_count(),
            pressure_angle,
            normal: gear.flank().tangent_angle(at_reference) + PI / 2.0,
        }
    }

    /// The number of teeth.
    pub fn tooth_count(&self) -> u32 {
        self.tooth_count
    }

    /// The total cumulative pitch deviation F_p, measured from the bore: between the tooth that stands out most and the one that stands back most, the
    /// eccentricity included, whose e moves a flank by an arc e cos(.)/cos α on the reference circle.
    pub fn total_pitch_deviation(&self, teeth: &ToothDeviations) -> f64 {
        let tooth = TAU / f64::from(self.tooth_count);
        let arcs = (0..self.tooth_count).map(|i| {
            let own = teeth.cumulative_pitch.get(i as usize).copied();
            let run_out = teeth.eccentricity.map_or(0.0, |each| {
                let turned = f64::from(i) * tooth + self.normal - each.direction;
                each.amount * libm::cos(turned) / libm::cos(self.pressure_angle)
            });
            own.unwrap_or(0.0) + run_out
        });
        let (least, most) = arcs.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), arc| {
            (arc.min(least), arc.max(most))
        });
        (most - least).max(0.0)
    }

    /// The largest part of its tolerance that any deviation takes, of those that `teeth` have: each single pitch of f_pT, F_p of F_pT, each profile slope of
    /// f_HαT, each lead slope of f_HβT, and twice the eccentricity of F_rT. Up to 1 a gear passes. All deviations being drawn for a capability, the part is in
    /// inverse proportion to it.
    pub fn largest_part(&self, teeth: &ToothDeviations) -> f64 {
        let allowed = &self.tolerances;
        let largest = |values: &mut dyn Iterator<Item = f64>, tolerance: f64| {
            values.fold(0.0_f64, |most, value| most.max(value.abs())) / tolerance
        };
        let sums = &teeth.cumulative_pitch;
        let before = sums.iter().skip(sums.len().saturating_sub(1)).chain(sums);
        let mut single = sums.iter().zip(before).map(|(own, before)| own - before);
        let mut total = [self.total_pitch_deviation(teeth)].into_iter();
        let mut run_out = teeth.eccentricity.iter().map(|each| 2.0 * each.amount);
        [
            largest(&mut single, allowed.single_pitch),
            largest(&mut total, allowed.total_pitch),
            largest(&mut run_out, allowed.runout),
            largest(
                &mut teeth.profile_slope.iter().copied(),
                allowed.profile_slope,
            ),
            largest(&mut teeth.lead_slope.iter().copied(), allowed.helix_slope),
        ]
        .into_iter()
        .fold(0.0, f64::max)
    }

    /// The first of the gears that `draw` makes, attempt by attempt, which passes; none if none of [`Inspection::MOST_ATTEMPTS`] does.
    pub fn first_that_passes(&self, draw: impl Fn(u32) -> ToothDeviations) -> Option<Passed> {
        (0..Self::MOST_ATTEMPTS).find_map(|attempt| {
            let teeth = draw(attempt);
            let attempts = attempt + 1;
            (self.largest_part(&teeth) <= 1.0).then_some(Passed { teeth, attempts })
        })
    }
}

/// Standard normal deviates, the same for a seed and a stream on every machine: the generator is specified bit by bit, and the
/// functions are those of a library instead of the machine's own.
#[derive(Debug, Clone)]
pub struct Normals {
    generator: ChaCha8Rng,
    /// Box and Muller's way makes two at a time.
    kept: Option<f64>,
}

impl Normals {
    /// Random numbers of a `seed`; each `stream` of it is independent of the others. Streams below 2^40 are those of first attempts.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self {
            generator,
            kept: None,
        }
    }

    /// Random numbers of a further attempt at the draw of a `stream`; attempt 0 is that stream.
    pub fn of_attempt(seed: u64, stream: u64, attempt: u32) -> Self {
        Self::new(seed, u64::from(attempt) << 40 | stream)
    }

    fn draw(&mut self) -> f64 {
        if let Some(kept) = self.kept.take() {
            return kept;
        }
        // Never zero, whose logarithm is none.
        let radius = (-2.0 * libm::log(1.0 - self.uniform())).sqrt();
        let angle = TAU * self.uniform();
        self.kept = Some(radius * libm::sin(angle));
        radius * libm::cos(angle)
    }

    /// One of the 2⁵³ numbers from 0 to 1, 1 excluded, each as likely.
    fn uniform(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 53) as f64;
        (self.generator.next_u64() >> 11) as f64 * STEP
    }
}

impl Iterator for Normals {
    type Item = f64;

    /// The next one; there is always one.
    fn next(&mut self) -> Option<f64> {
        Some(self.draw())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;

    fn gear(tooth_count: u32) -> SpurGear {
        SpurGear::new(paper_gear(tooth_count)).expect("a gear of the paper")
    }

    #[test]
    fn tolerances_are_those_computed_by_hand() {
        // z 50, m 2 mm: d 100 mm, b 20 mm. In class 5: f_pT = 0.1 + 0.8 + 5 = 5.9 um, F_pT = 0.2 + 5.5 + 1.4 + 12 = 19.1,
        // f_HaT = 0.8 + 0.1 + 4 = 4.9, f_faT = 1.1 + 5 = 6.1, F_rT = 17.19, f_HbT = 0.5 + 0.35 x 4.472136 + 4 = 6.0652476.
        let expected = [5.9, 19.1, 4.9, 6.1, 17.19, 6.065_247_6];
        let gear = gear(50);
        for (class, factor) in [
            (5, 1.0),
            (7, 2.0),
            (1, 0.25),
            (6, std::f64::consts::SQRT_2),
            (11, 8.0),
        ] {
            let found = Tolerances::of(&gear, class);
            let found = [
                found.single_pitch,
                found.total_pitch,
                found.profile_slope,
                found.profile_form,
                found.runout,
                found.helix_slope,
            ];
            for (found, expected) in found.into_iter().zip(expected) {
                let expected = 1e-6 * factor * expected;
                assert!(
                    (found / expected - 1.0).abs() < 1e-8,
                    "{class}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn the_same_seed_draws_the_same_numbers_on_every_machine() {
        // ChaCha with 8 rounds by a second implementation (Python, with its own logarithm and cosine), seed 1 in streams 0 and 1.
        let mut first = Normals::new(1, 0);
        let mut other = Normals::new(1, 1);
        let drawn: Vec<f64> = (0..3).map(|_| first.draw()).collect();
        assert_ne!(drawn[0], other.draw());
        assert_eq!(
            Normals::new(1, 0).draw().to_bits(),
            drawn[0].to_bits(),
            "{drawn:?}"
        );
        for (found, expected) in drawn.iter().zip(EXPECTED_OF_SEED_1) {
            assert!((found - expected).abs() < 1e-12, "{drawn:?}");
        }
    }

    const EXPECTED_OF_SEED_1: [f64; 3] = [
        0.888_152_971_890_830_1,
        0.491_058_348_587_415_2,
        0.258_089_893_650_407,
    ];

    #[test]
    fn deviates_are_normal() {
        // Of n deviates the mean has a standard error of 1/sqrt(n), the variance of sqrt(2/n); five of them are allowed.
        const N: usize = 200_000;
        let mut normals = Normals::new(7, 3);
        let drawn: Vec<f64> = (0..N).map(|_| normals.draw()).collect();
        let part = |holds: &dyn Fn(f64) -> bool| {
            drawn.iter().filter(|each| holds(**each)).count() as f64 / N as f64
        };
        let mean = drawn.iter().sum::<f64>() / N as f64;
        let variance = drawn.iter().map(|each| each * each).sum::<f64>() / N as f64;
        assert!(mean.abs() < 5.0 / (N as f64).sqrt(), "{mean}");
        assert!(
            (variance - 1.0).abs() < 5.0 * (2.0 / N as f64).sqrt(),
            "{variance}"
        );
        for (within, expected) in [(1.0, 0.682_689_5), (2.0, 0.954_499_7), (3.0, 0.997_300_2)] {
            let found = part(&|each| each.abs() < within);
            assert!((found - expected).abs() < 5.0 * (0.25 / N as f64).sqrt());
        }
        let neighbors = drawn.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / N as f64;
        assert!(
            neighbors.abs() < 5.0 / (N as f64).sqrt(),
            "independent: {neighbors}"
        );
    }

    #[test]
    fn drawn_teeth_spread_as_the_class_and_the_capability_say() {
        let (gear, capability) = (gear(50), 1.33);
        let tolerances = Tolerances::of(&gear, 6);
        let members: Vec<ToothDeviations> = (0..400)
            .map(|member| tolerances.draw(50, capability, Normals::new(1, member)))
            .collect();
        let spread = |values: &[f64]| {
            (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
        };
        let of_all = |list: &dyn Fn(&ToothDeviations) -> Vec<f64>| {
            spread(&members.iter().flat_map(list).collect::<Vec<_>>())
        };
        let single = |each: &ToothDeviations| {
            let sums = &each.cumulative_pitch;
            (0..50)
                .map(|i| sums[i] - if i == 0 { 0.0 } else { sums[i - 1] })
                .collect()
        };
        // Taking the mean of 50 away takes a fiftieth of the variance.
        let expected = tolerances.single_pitch / (3.0 * capability) * (1.0_f64 - 1.0 / 50.0).sqrt();
        assert!((of_all(&single) / expected - 1.0).abs() < 0.03);
        let slopes = of_all(&|each| each.profile_slope.clone());
        assert!((slopes * 3.0 * capability / tolerances.profile_slope - 1.0).abs() < 0.03);
        let eccentricity = of_all(&|each| vec![each.eccentricity.map_or(0.0, |e| e.amount)]);
        let expected = 2_f64.sqrt() * tolerances.runout / (6.0 * capability);
        assert!((eccentricity / expected - 1.0).abs() < 0.1);
        for each in &members {
            let last = each.cumulative_pitch[49];
            assert!(last.abs() < 1e-15, "it closes once around: {last}");
        }
        assert_ne!(members[0], members[1]);
    }

    /// A gear with eccentric teeth of given cumulative pitch.
    fn made(cumulative_pitch: Vec<f64>, eccentricity: Option<(f64, f64)>) -> ToothDeviations {
        ToothDeviations {
            cumulative_pitch,
            eccentricity: eccentricity
                .map(|(amount, direction)| Eccentricity { amount, direction }),
            ..ToothDeviations::default()
        }
    }

    #[test]
    fn an_eccentric_gear_has_the_total_pitch_deviation_of_its_runout() {
        // Of many teeth it is 2 e/cos α, whatever the direction.
        let of_many = Inspection::of(&gear(150), 6);
        for direction in [0.0, 1.0, -2.5] {
            let teeth = made(Vec::new(), Some((10e-6, direction)));
            let found = of_many.total_pitch_deviation(&teeth);
            let expected = 20e-6 / 20_f64.to_radians().cos();
            assert!((found / expected - 1.0).abs() < 1e-3, "{found}");
        }
        // The turn of the flanks elsewhere, the runout along the normal at the reference circle, is this arc times cos α.
        let mut data = paper_gear(29);
        data.deviations = made(Vec::new(), Some((10e-6, 0.7)));
        let eccentric = SpurGear::new(data).expect("a gear");
        let inspection = Inspection::of(&eccentric, 6);
        let deviations = super::super::GearDeviations::of(&eccentric, eccentric.deviations());
        let alpha = 20_f64.to_radians();
        let at_reference = eccentric.base_radius() * alpha.tan();
        let arcs: Vec<f64> = (0..29)
            .map(|tooth| deviations.runout(&eccentric, tooth, at_reference, 0.0) / alpha.cos())
            .collect();
        let range = arcs.iter().copied().fold(f64::MIN, f64::max)
            - arcs.iter().copied().fold(f64::MAX, f64::min);
        let found = inspection.total_pitch_deviation(eccentric.deviations());
        assert!((found - range).abs() < 1e-12, "{found} {range}");
        // Pitch that undoes it leaves nothing.
        let undone = made(arcs.iter().map(|arc| -arc).collect(), Some((10e-6, 0.7)));
        assert!(inspection.total_pitch_deviation(&undone) < 1e-12);
    }

    #[test]
    fn each_deviation_beyond_its_tolerance_rejects_a_gear() {
        let inspection = Inspection::of(&gear(50), 5);
        let allowed = inspection.tolerances;
        // A single tooth that stands out by f: two single pitches of f, and F_p is f.
        let one_out = |f: f64| {
            let mut sums = vec![0.0; 50];
            sums[7] = f;
            made(sums, None)
        };
        // Every pitch of one half too long, of the other too short: F_p is 25 of them.
        let drifting = |f: f64| {
            made(
                (0..50)
                    .map(|i| f * f64::from(25 - (25_i32 - i).abs()))
                    .collect(),
                None,
            )
        };
        // The first tooth against the last one counts as well.
        let across_the_end = |f: f64| {
            made(
                (0..50).map(|i| if i < 25 { 0.0 } else { f }).collect(),
                None,
            )
        };
        let slopes = |profile: f64, lead: f64| ToothDeviations {
            profile_slope: vec![0.0, profile],
            lead_slope: vec![lead, 0.0],
            ..ToothDeviations::default()
        };
        let eccentric = |e: f64| made(Vec::new(), Some((e, 0.3)));
        for factor in [0.999, 1.001] {
            for teeth in [
                one_out(factor * allowed.single_pitch),
                one_out(-factor * allowed.single_pitch),
                across_the_end(factor * allowed.single_pitch),
                drifting(factor * allowed.total_pitch / 25.0),
                slopes(-factor * allowed.profile_slope, 0.0),
                slopes(0.0, factor * allowed.helix_slope),
            ] {
                let part = inspection.largest_part(&teeth);
                assert!((part - factor).abs() < 1e-9, "{part}: {teeth:?}");
            }
        }
        // An eccentricity of F_rT/2 makes F_p 0.9 F_pT/cos α, which is less than F_pT.
        let part = inspection.largest_part(&eccentric(allowed.runout / 2.0));
        assert!((part - 1.0).abs() < 1e-9, "{part}");
        // Both together are more than F_pT, where each alone passes.
        let mut both = drifting(0.8 * allowed.total_pitch / 25.0);
        assert!(inspection.largest_part(&both) < 1.0);
        both.eccentricity = Some(Eccentricity {
            amount: 0.45 * allowed.runout,
            direction: PI / 2.0,
        });
        let all = [0.0, PI / 2.0, PI, -PI / 2.0].map(|direction| {
            both.eccentricity = both
                .eccentricity
                .map(|each| Eccentricity { direction, ..each });
            inspection.largest_part(&both)
        });
        assert!(all.iter().any(|part| *part > 1.0), "{all:?}");
    }

    #[test]
    fn as_many_gears_pass_as_a_second_program_found() {
        // Shares beyond F_pT of class 6 at capability 1, from the pitch alone and measured from the bore, by numpy over 20,000 gears; and 8 % of those with 150 teeth
        // pass, at a capability of 0.67 none of 20,000.
        const COUNT: u64 = 2000;
        for (teeth, alone, from_bore) in [(29, 0.02, 0.17), (85, 0.44, 0.59), (150, 0.77, 0.83)] {
            let inspection = Inspection::of(&gear(teeth), 6);
            let draw = |member, capability| {
                let normals = Normals::new(5, member);
                inspection.tolerances.draw(teeth, capability, normals)
            };
            let share = |holds: &dyn Fn(ToothDeviations) -> bool, capability| {
                let found = (0..COUNT).filter(|member| holds(draw(*member, capability)));
                found.count() as f64 / COUNT as f64
            };
            let beyond = |teeth: &ToothDeviations| {
                inspection.total_pitch_deviation(teeth) > inspection.tolerances.total_pitch
            };
            let of_pitch = share(
                &|teeth| {
                    beyond(&ToothDeviations {
                        eccentricity: None,
                        ..teeth
                    })
                },
                1.0,
            );
            let of_both = share(&|teeth| beyond(&teeth), 1.0);
            // Four standard errors of 2000, and the rounding of the second program.
            assert!((of_pitch - alone).abs() < 0.05, "{teeth}: {of_pitch}");
            assert!((of_both - from_bore).abs() < 0.05, "{teeth}: {of_both}");
            if teeth == 150 {
                let passing =
                    |capability| share(&|teeth| inspection.largest_part(&teeth) <= 1.0, capability);
                assert!((passing(1.0) - 0.08).abs() < 0.025, "{}", passing(1.0));
                assert_eq!(passing(0.67), 0.0);
            }
        }
    }

    #[test]
    fn a_rejected_gear_is_followed_by_another_of_a_stream_of_its_own() {
        let inspection = Inspection::of(&gear(85), 6);
        let draw = |attempt| {
            let normals = Normals::of_attempt(1, 3, attempt);
            inspection.tolerances.draw(85, 1.0, normals)
        };
        let passed = inspection.first_that_passes(draw).expect("a third pass");
        assert!(inspection.largest_part(&passed.teeth) <= 1.0);
        assert_eq!(passed.teeth, draw(passed.attempts - 1));
        for attempt in 0..passed.attempts - 1 {
            assert!(inspection.largest_part(&draw(attempt)) > 1.0);
            assert_ne!(draw(attempt), draw(attempt + 1));
        }
        let uninspected = inspection.tolerances.draw(85, 1.0, Normals::new(1, 3));
        assert_eq!(
            draw(0),
            uninspected,
            "the first attempt is the gear that nobody looks at"
        );
        let hopeless = |attempt| {
            let normals = Normals::of_attempt(1, 3, attempt);
            inspection.tolerances.draw(85, 0.1, normals)
        };
        assert_eq!(inspection.first_that_passes(hopeless), None);
    }
}
