//! The spring at a place of a contact line: how much farther the flanks close up there than where the line load is blurred.
//!
//! The linear compliance has the half space's 1/√(x² + ρ_0²) along lines, with one blur ρ_0 for all. A line load q over a contact of the width ρ presses
//! the flanks farther together by K q ln(ρ_0/ρ), with K = Σ 2(1 − ν²)/(πE) of both bodies. For Hertz's contact ρ is (a/2) e^(−1/2); for any other the plane's
//! cells give it. It grows with the load: the closing rises only as far as ρ is below ρ_0 e^(−1/2).

use std::f64::consts::LN_2;
use std::sync::{Mutex, OnceLock, PoisonError};

use crate::contact::patch::{Extent, Patch};
use crate::contact::{ContactProblem, ContactSolution, solve_active_set};
use crate::fem::dense::mirror_lower;
use crate::flank::half_plane::{Entries, hertz, near_compliance};
use crate::gear::{Member, TipEdge};
use crate::touch::gap_profile::GapProfile;
use crate::touch::placement::Pose;

/// Cells on the core of a patch.
const CELLS: usize = 24;

/// Below this part of the density that a spring was made for it is taken to be linear.
const LEAST: f64 = 1e-6;

/// The growth of the closing with the load, in K, under the largest load for which the blur of lines is chosen.
const STIFFEST: f64 = 0.1;

/// The line loads at which cells are solved: that for which they are made times powers of this, from `LIGHTEST` such steps below it on.
const STEP: f64 = 4.0;
const LIGHTEST: i32 = 5;
const SOLVED: usize = LIGHTEST as usize + 3;

/// The piece of a contact line that a spring stands for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// The blur ρ_0 of lines.
    pub(super) blur: f64,
    /// The relative radius of both flanks.
    pub(super) radius: f64,
    /// Σ 2(1 − ν²)/(πE).
    pub(super) factor: f64,
}

/// A spring.
pub(super) struct Spring {
    line: Line,
    /// The least load a length for which it is evaluated, and that beyond which it goes on straight.
    least: f64,
    most: f64,
    /// The logarithms of the latter, of the factor and of the blur.
    ln_most: f64,
    ln_factor: f64,
    ln_blur: f64,
    /// The load a length below which its pressure is that of two cylinders.
    free_under: f64,
    contact: Contact,
}

enum Contact {
    /// Of two cylinders; with ln ρ under a load a length of one.
    Hertz { ln_width: f64 },
    /// Of any profiles.
    Patch(Box<Cells>),
}

/// The cells of a patch of one meter, with gaps from that of the first to touch.
struct Cells {
    patch: Patch,
    problem: ContactProblem,
    /// The module, over which its logarithms are taken.
    scale: f64,
    sharp: [bool; 2],
    active: Mutex<Option<Vec<bool>>>,
    /// The load for which the response was asked last, and that: neighboring slices ask for that at their common end.
    pressed: Mutex<Option<(f64, Pressed)>>,
    /// The logarithm of the load for which the cells are made, and ln ρ and d ln ρ/d ln q at those that are solved.
    made_for: f64,
    widths: [OnceLock<[f64; 2]>; SOLVED],
}

/// Response of a slice to a load.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pressed {
    pub(super) pressure: Option<f64>,
    /// The largest at least half the width of the contact away from kinks; 0 where there is none, and at a sharp tip edge.
    pub(super) smooth: f64,
    /// True if it reaches a sharp tip edge, where pressure has no limit.
    pub(super) at_sharp_edge: bool,
    pub(super) half_width: f64,
    pub(super) tip_corner: Option<Member>,
    pub(super) fillet: Option<Member>,
}

/// The blur of lines for a largest line load: of Hertz's contact under it, of which no relative radius is larger than `radius`, the closing grows by
/// [`STIFFEST`] still.
pub(super) fn blur(heaviest: f64, radius: f64, factor: f64) -> f64 {
    // K q ln(ρ_0/ρ) grows with q by K (ln(ρ_0/ρ) − 1/2), and ρ = (a/2) e^(−1/2).
    0.5 * hertz(heaviest, radius, factor, 1.0).0 * STIFFEST.exp()
}

impl Spring {
    fn new(line: Line, [density, heaviest]: [f64; 2], contact: Contact) -> Self {
        let most = heaviest.max(density);
        Self {
            line,
            least: LEAST * density,
            most,
            ln_most: most.ln(),
            ln_factor: line.factor.ln(),
            ln_blur: line.blur.ln(),
            free_under: 0.0,
            contact,
        }
    }

    /// Of two cylinders, for a mean and a largest line load.
    pub(super) fn hertz(of: Line, densities: [f64; 2]) -> Self {
        // ρ = (a/2) e^(−1/2), a² = 2 q R K.
        let ln_width = 0.5 * (2.0 * of.radius * of.factor).ln() - 0.5 - LN_2;
        Self::new(of, densities, Contact::Hertz { ln_width })
    }

    /// As [`Spring::hertz`], of the flanks of `facing` as `view` sees them, which stand free under less than a load a length; and the normal gap between them.
    pub(super) fn patch(
        view: &Pose<'_>,
        facing: &GapProfile,
        cosine: f64,
        of: Line,
        densities: [f64; 2],
        free_under: f64,
    ) -> (Self, f64) {
        let extent = Extent {
            minima: facing.minima.len(),
            widened: 1,
            moved: 0,
            halved: 0,
        };
        let patch = Patch::new(view, facing, densities[0], CELLS, extent);
        let stretches: Vec<[f64; 2]> = patch.stretches().collect();
        let mut compliance =
            near_compliance(&patch.near_fields, &stretches, &stretches, Entries::Lower);
        mirror_lower(&mut compliance);
        let gaps: Vec<f64> = patch.cells.iter().map(|cell| cosine * cell.gap).collect();
        let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
        let gaps = gaps.iter().map(|gap| gap - least).collect();
        let arms = vec![1.0; patch.cells.len()];
        match ContactProblem::new(compliance, gaps, arms) {
            Ok(problem) => {
                let gears = view.pair;
                let cells = Cells {
                    scale: gears.driving().data().rack.module,
                    sharp: Member::BOTH
                        .map(|member| gears.gear(member).data().tip_edge == TipEdge::Sharp),
                    active: Mutex::default(),
                    pressed: Mutex::default(),
                    made_for: densities[0].ln(),
                    widths: Default::default(),
                    patch,
                    problem,
                };
                let contact = Contact::Patch(Box::new(cells));
                let spring = Self {
                    free_under,
                    ..Self::new(of, densities, contact)
                };
                (spring, least)
            }
            // There is no room for a cell.
            Err(_) => (Self::hertz(of, densities), cosine * facing.minima[0].touch),
        }
    }

    /// True if it is that of two cylinders.
    pub(super) fn is_hertz(&self) -> bool {
        matches!(self.contact, Contact::Hertz { .. })
    }

    /// The load a length under which it closes up by `depth`, and how fast that grows with it.
    pub(super) fn load(&self, depth: f64) -> [f64; 2] {
        const STEPS: u32 = 30;
        // Newton's steps square the remainder.
        const SHORT: f64 = 1e-7;
        const USUAL_PART: f64 = 2.0;
        let sought = depth.ln() - self.ln_factor;
        let mut at = (sought - USUAL_PART.ln()).min(self.ln_most);
        let mut growth = 1.0;
        for _ in 0..STEPS {
            let [closed, rise] = self.closed(at);
            let step = (sought - closed) / rise;
            growth = rise;
            if at == self.ln_most && step > 0.0 {
                // Straight on.
                let closed = (closed + self.ln_factor).exp();
                let growth = self.most / (closed * rise);
                return [self.most + growth * (depth - closed), growth];
            }
            at = (at + step).min(self.ln_most);
            if step.abs() < SHORT {
                break;
            }
        }
        let q = at.exp();
        if q < self.least {
            let [closed, _] = self.closed(self.least.ln());
            let growth = self.least / (closed + self.ln_factor).exp();
            return [growth * depth, growth];
        }
        [q, q / (depth * growth)]
    }

    /// The logarithm of how far it closes up, over K, under a load a length of this logarithm, and how fast that grows with this.
    fn closed(&self, ln_q: f64) -> [f64; 2] {
        const FLATTEST: f64 = 0.05;
        let [ln_rho, exponent] = self.width(ln_q);
        let part = self.ln_blur - ln_rho;
        if part < FLATTEST {
            return [ln_q + FLATTEST.ln(), 1.0];
        }
        let rise = 1.0 - exponent / part;
        [ln_q + part.ln(), rise.max(FLATTEST)]
    }

    /// How far it closes up under the load `q` a length.
    pub(super) fn closing(&self, q: f64) -> f64 {
        if q <= 0.0 {
            return 0.0;
        }
        let known = q.clamp(self.least, self.most);
        let [closed, _] = self.closed(known.ln());
        (closed + self.ln_factor).exp() * q / known
    }

    /// ln ρ under a load a length of this logarithm, and d ln ρ/d ln q.
    fn width(&self, ln_q: f64) -> [f64; 2] {
        match &self.contact {
            Contact::Hertz { ln_width } => [0.5 * ln_q + ln_width, 0.5],
            Contact::Patch(cells) => cells.width(ln_q, self.line.factor),
        }
    }

    /// Response to the load `q` a length beside the closing.
    pub(super) fn pressed(&self, q: f64) -> Pressed {
        match &self.contact {
            Contact::Patch(cells) if q >= self.free_under => cells.pressed(q),
            // Cells are as fine as the usual load wants.
            Contact::Hertz { .. } | Contact::Patch(_) => {
                let (half_width, pressure) = hertz(q, self.line.radius, self.line.factor, 1.0);
                Pressed {
                    pressure: Some(pressure),
                    smooth: pressure,
                    half_width,
                    ..Pressed::default()
                }
            }
        }
    }
}

impl Cells {
    /// ln ρ under a load a length of this logarithm, and d ln ρ/d ln q: a cubic between those that are solved, straight on beside them.
    fn width(&self, ln_q: f64, factor: f64) -> [f64; 2] {
        let step = STEP.ln();
        let place = (ln_q - self.made_for) / step + f64::from(LIGHTEST);
        let within = place.clamp(0.0, (SOLVED - 1) as f64);
        let first = (within as usize).min(SOLVED - 2);
        let t = within - first as f64;
        let at = |i: usize| {
            *self.widths[i].get_or_init(|| {
                let steps = i as f64 - f64::from(LIGHTEST);
                self.solved_width((self.made_for + steps * step).exp(), factor)
            })
        };
        if t == 0.0 || t == 1.0 {
            let [ln_rho, exponent] = at(first + t as usize);
            return [ln_rho + (place - within) * step * exponent, exponent];
        }
        let ([one, one_slope], [other, other_slope]) = (at(first), at(first + 1));
        let (rise, slopes) = (other - one, [one_slope * step, other_slope * step]);
        // One + t m + t² (3 r − 2 m − n) + t³ (m + n − 2 r).
        let square = 3.0 * rise - 2.0 * slopes[0] - slopes[1];
        let cube = slopes[0] + slopes[1] - 2.0 * rise;
        [
            one + t * (slopes[0] + t * (square + t * cube)),
            (slopes[0] + t * (2.0 * square + 3.0 * t * cube)) / step,
        ]
    }

    fn solved_width(&self, q: f64, factor: f64) -> [f64; 2] {
        match self.solved(q) {
            Some(solution) => {
                let mean = solution.transmission_error / (q * factor);
                let tangent = 1.0 / (solution.stiffness * factor);
                [self.scale.ln() - mean, mean - tangent]
            }
            None => [self.scale.ln() - 10.0, 0.5],
        }
    }

    /// The contact under `q`; from the set that touched last, which changes no digit.
    fn solved(&self, q: f64) -> Option<ContactSolution> {
        let mut active = self.active.lock().unwrap_or_else(PoisonError::into_inner);
        let solution = solve_active_set(&self.problem, q, active.as_deref()).ok()?;
        *active = Some(solution.active.clone());
        Some(solution)
    }

    fn pressed(&self, q: f64) -> Pressed {
        let mut last = self.pressed.lock().unwrap_or_else(PoisonError::into_inner);
        match *last {
            Some((load, pressed)) if load == q => pressed,
            _ => {
                let pressed = self.pressed_anew(q);
                *last = Some((q, pressed));
                pressed
            }
        }
    }

    fn pressed_anew(&self, q: f64) -> Pressed {
        let Some(solution) = self.solved(q) else {
            return Pressed::default();
        };
        let patch = &self.patch;
        let at_corner = patch.corner_carries(&solution.active, self.sharp);
        let cells = patch.cells.iter().zip(&solution.forces);
        let pressures = cells.clone().map(|(cell, p)| p / cell.width);
        let pressures: Vec<f64> = pressures.collect();
        let largest = pressures.iter().copied().fold(0.0, f64::max);
        let smooth = || patch.smooth_pressure(&pressures, &solution.active, 1.0);
        let width: f64 = cells
            .filter(|(_, p)| **p > 0.0)
            .map(|(cell, _)| cell.width)
            .sum();
        Pressed {
            pressure: (!at_corner).then_some(largest),
            smooth: if at_corner { 0.0 } else { smooth() },
            at_sharp_edge: at_corner,
            half_width: 0.5 * width,
            tip_corner: patch.off_path.then_some(patch.primary),
            fillet: patch.reached_fillet(&solution.active),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flank::half_plane::logarithm_factor;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{GearPair, PlaneState, SpurGear};

    const COSINE: f64 = 0.95;
    const DENSITY: f64 = 1e5;

    fn pair() -> (GearPair, f64) {
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        let modulus = gear.material().plane_modulus(PlaneState::Strain);
        let pair = GearPair::new(gear.clone(), gear, 100.5e-3).expect("meshes");
        (pair.plane_strain(), 2.0 * logarithm_factor(modulus, 1.0))
    }

    fn patch(phase: f64, blur: f64) -> (Spring, f64) {
        let (pair, factor) = pair();
        let facing = GapProfile::drawn(&pair, phase).expect("they face each other");
        let view = Pose::drawn(&pair, phase, facing.primary);
        let [s, other] = facing.minima[0].roll_lengths.map(|s| s / COSINE);
        let of = Line {
            blur,
            radius: s * other / (s + other),
            factor,
        };
        Spring::patch(&view, &facing, COSINE, of, [DENSITY, 2.5 * DENSITY], 0.0)
    }

    /// How far `spring` closes up under the load `q` a length.
    fn depth(spring: &Spring, q: f64) -> f64 {
        (spring.closed(q.ln())[0] + spring.ln_factor).exp()
    }

    #[test]
    fn cells_where_flanks_stand_free_are_hertzs_contact() {
        let blur = 0.2e-3;
        let (cells, gap) = patch(0.1, blur);
        assert!(gap < 4e-9, "the mean over a cell: {gap}");
        let (pair, factor) = pair();
        let s = pair.roll_length_of(0.1) / COSINE;
        let other = (pair.line_of_action() / COSINE) - s;
        let of = Line {
            blur,
            radius: s * other / (s + other),
            factor,
        };
        let hertz = Spring::hertz(of, [DENSITY, 2.5 * DENSITY]);
        for part in [0.2, 0.5, 1.0, 2.0] {
            let q = part * DENSITY;
            let sought = depth(&hertz, q);
            assert!((depth(&cells, q) / sought - 1.0).abs() < 2e-2, "{part}");
            let [load, growth] = cells.load(sought);
            let [expected, grown] = hertz.load(sought);
            assert!((expected / q - 1.0).abs() < 1e-9);
            assert!((load / q - 1.0).abs() < 2e-2, "{part}: {load} {q}");
            assert!((growth / grown - 1.0).abs() < 5e-2, "{part}");
            let (a, b) = (cells.pressed(q), hertz.pressed(q));
            let of = |pressed: Pressed| pressed.pressure.expect("no corner is near");
            assert!((of(a) / of(b) - 1.0).abs() < 6e-2);
        }
    }

    #[test]
    fn every_spring_takes_loads_that_grow_as_it_says_and_stiffens() {
        let blur = 0.2e-3;
        let (pair, factor) = pair();
        let (s_a, s_e) = pair.path_of_contact();
        let periods = |s: f64| (s - pair.pitch_roll_length()) / pair.base_pitch();
        let hertz = Spring::hertz(
            Line {
                blur,
                radius: 9e-3,
                factor,
            },
            [DENSITY, 2.5 * DENSITY],
        );
        // Just inside the path of contact, where a tip corner is near, and beyond its end.
        let at_tip = patch(periods(s_e) - 0.01, blur).0;
        let beyond = patch(periods(s_a) - 0.05, blur).0;
        let thin = patch(periods(s_e) - 0.01, 2e-6).0;
        for (number, spring) in [hertz, at_tip, beyond, thin].iter().enumerate() {
            let mut last: Option<[f64; 2]> = None;
            for i in 0..60 {
                let depth = 1e-13 * 10_f64.powf(0.15 * f64::from(i));
                let [load, growth] = spring.load(depth);
                assert!(load > 0.0 && growth > 0.0);
                if let Some(last) = last {
                    assert!(load > last[0]);
                    // A slice shorter than its contact is wide is no line, and beyond their table springs are extrapolated linearly. Where a cell just touches
                    // the slope steps a little.
                    let stiffens = growth > last[1] * (1.0 - 2e-2);
                    assert!(stiffens || number == 3, "{i}: {last:?} {load} {growth}");
                }
                last = Some([load, growth]);
                let step = 1e-5 * depth;
                let slope =
                    (spring.load(depth + step)[0] - spring.load(depth - step)[0]) / (2.0 * step);
                let beyond = [depth - step, depth + step].map(|depth| spring.load(depth)[0]);
                let turns = beyond.iter().any(|q| *q < 2.0 * spring.least)
                    || (beyond[0] <= spring.most) != (beyond[1] <= spring.most);
                assert!(
                    turns || (growth / slope - 1.0).abs() < 1e-5,
                    "{i}: {slope} {growth}"
                );
            }
        }
    }

    #[test]
    fn a_contact_beyond_the_path_is_one_of_a_tip_corner() {
        let (pair, _) = pair();
        let (_, s_e) = pair.path_of_contact();
        let phase = (s_e - pair.pitch_roll_length()) / pair.base_pitch() + 0.05;
        let (spring, gap) = patch(phase, 0.5e-3);
        assert!(gap > 0.1e-6);
        let pressed = spring.pressed(0.2 * DENSITY);
        assert_eq!(pressed.pressure, None);
        assert_eq!(pressed.tip_corner, Some(Member::Driving));
        // A corner is softer than two cylinders.
        let free = patch(0.1, 0.2e-3).0;
        assert!(depth(&spring, 0.2 * DENSITY) > depth(&free, 0.2 * DENSITY));
    }
}
