//! The spring of a slice: how far the flanks close up near a short piece of a contact line.
//!
//! A line load q, spread over the contact's width, presses the middle of a slice of the length h by K q asinh(h/(2 ρ)), K = Σ 2(1 − ν²)/(πE) of both
//! bodies: the half space under that slice alone. ρ is the width of a contact of no shape, (a/2) e^(−1/2) of Hertz's; for any other contact
//! it is what the plane's cells say.

use std::cell::RefCell;

use crate::contact::facing::{Facing, RangeEnd, View};
use crate::contact::half_plane::{Entries, hertz, near_compliance};
use crate::contact::patch::{Extent, Patch};
use crate::contact::{ContactProblem, ContactSolution, solve_active_set};
use crate::gear::{Member, TipEdge};

/// Cells on the core of a patch.
const CELLS: usize = 24;

/// Below this part of the density that a spring was made for it is taken to be linear.
const LEAST: f64 = 1e-6;

/// A spring, and how long its slice is along the contact line.
pub(super) struct Spring {
    along: f64,
    /// Σ 2(1 − ν²)/(πE).
    factor: f64,
    /// The least load a length for which it is evaluated.
    least: f64,
    contact: Contact,
}

enum Contact {
    /// Of two cylinders with this relative radius.
    Hertz { radius: f64 },
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
    active: RefCell<Option<Vec<bool>>>,
}

/// How far a spring closes up, and how fast with the force.
#[derive(Debug, Clone, Copy)]
pub(super) struct Closing {
    pub(super) depth: f64,
    pub(super) growth: f64,
}

/// What a force does to a slice.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pressed {
    pub(super) pressure: Option<f64>,
    /// Whether it reaches a sharp tip edge, where pressure has no limit.
    pub(super) at_sharp_edge: bool,
    pub(super) half_width: f64,
    pub(super) tip_corner: Option<Member>,
    pub(super) fillet: Option<Member>,
}

impl Spring {
    /// Of two cylinders.
    pub(super) fn hertz(along: f64, radius: f64, factor: f64, density: f64) -> Self {
        Self {
            along,
            factor,
            least: LEAST * density,
            contact: Contact::Hertz { radius },
        }
    }

    /// Of the flanks of `facing` as `view` sees them, of slices one meter long, laid for `density`; and the normal gap between them.
    pub(super) fn patch(
        view: &View<'_>,
        facing: &Facing,
        (along, cosine, factor): (f64, f64, f64),
        density: f64,
    ) -> (Self, f64) {
        let extent = Extent {
            hollows: facing.hollows.len(),
            widened: 1,
            moved: 0,
            halved: 0,
        };
        let patch = Patch::new(view, facing, density, CELLS, extent);
        let stretches: Vec<[f64; 2]> = patch.stretches().collect();
        let compliance = near_compliance(&patch.near_fields, &stretches, &stretches, Entries::All);
        let gaps: Vec<f64> = patch.cells.iter().map(|cell| cosine * cell.gap).collect();
        let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
        let gaps = gaps.iter().map(|gap| gap - least).collect();
        let arms = vec![1.0; patch.cells.len()];
        let hollow = &facing.hollows[0];
        let problem = ContactProblem::new(compliance, gaps, arms);
        let (contact, gap) = match problem {
            Ok(problem) => {
                let gears = view.gears();
                let cells = Cells {
                    scale: gears.driving().data().rack.module,
                    sharp: Member::BOTH
                        .map(|member| gears.gear(member).data().tip_edge == TipEdge::Sharp),
                    active: RefCell::default(),
                    patch,
                    problem,
                };
                (Contact::Patch(Box::new(cells)), least)
            }
            // There is no room for a cell.
            Err(_) => {
                let [one, other] = hollow.roll_lengths.map(|s| s / cosine);
                let radius = one * other / (one + other);
                (Contact::Hertz { radius }, cosine * hollow.touch)
            }
        };
        let spring = Self {
            along,
            factor,
            least: LEAST * density,
            contact,
        };
        (spring, gap)
    }

    /// How far it closes up under `force`.
    pub(super) fn closing(&self, force: f64) -> Closing {
        let q = (force / self.along).max(self.least);
        let (ln_rho, exponent) = self.width(q);
        // u = h/(2 ρ), and K q asinh u grows with q by K (asinh u − exponent · u/√(1 + u²)).
        let u = 0.5 * self.along * (-ln_rho).exp();
        let depth = self.factor * q * u.asinh();
        if force < self.least * self.along {
            let growth = depth / (q * self.along);
            return Closing {
                depth: growth * force,
                growth,
            };
        }
        let grown = u.asinh() - exponent * u / (1.0 + u * u).sqrt();
        Closing {
            depth,
            growth: self.factor * grown / self.along,
        }
    }

    /// How far it closes up under `force` at an end of its slice.
    pub(super) fn closing_at_end(&self, force: f64) -> f64 {
        if force <= 0.0 {
            return 0.0;
        }
        let q = (force / self.along).max(self.least);
        let (ln_rho, _) = self.width(q);
        0.5 * self.factor * force / self.along * (self.along * (-ln_rho).exp()).asinh()
    }

    /// ln ρ under the load `q` a length, and d ln ρ/d ln q.
    fn width(&self, q: f64) -> (f64, f64) {
        match &self.contact {
            Contact::Hertz { radius } => {
                let (a, _) = hertz(q, *radius, self.factor, 1.0);
                ((0.5 * a).ln() - 0.5, 0.5)
            }
            Contact::Patch(cells) => match cells.solved(q) {
                Some(solution) => {
                    let mean = solution.transmission_error / (q * self.factor);
                    let tangent = 1.0 / (solution.stiffness * self.factor);
                    (cells.scale.ln() - mean, mean - tangent)
                }
                None => (cells.scale.ln() - 10.0, 0.5),
            },
        }
    }

    /// What `force` does beside closing it.
    pub(super) fn pressed(&self, force: f64) -> Pressed {
        let q = (force / self.along).max(self.least);
        match &self.contact {
            Contact::Hertz { radius } => {
                let (half_width, pressure) = hertz(q, *radius, self.factor, 1.0);
                Pressed {
                    pressure: Some(pressure),
                    at_sharp_edge: false,
                    half_width,
                    tip_corner: None,
                    fillet: None,
                }
            }
            Contact::Patch(cells) => cells.pressed(q),
        }
    }
}

impl Cells {
    /// The contact under `q`; from the set that touched last, which changes no digit.
    fn solved(&self, q: f64) -> Option<ContactSolution> {
        let mut active = self.active.borrow_mut();
        let solution = solve_active_set(&self.problem, q, active.as_deref()).ok()?;
        *active = Some(solution.active.clone());
        Some(solution)
    }

    fn pressed(&self, q: f64) -> Pressed {
        let Some(solution) = self.solved(q) else {
            return Pressed {
                pressure: None,
                at_sharp_edge: false,
                half_width: 0.0,
                tip_corner: None,
                fillet: None,
            };
        };
        let patch = &self.patch;
        let ended = patch.ended_by(&solution.active);
        let seat = patch.seat;
        let fillet = ended.iter().find_map(|end| match end {
            RangeEnd::Fillet => Some(seat),
            RangeEnd::MateFillet => Some(seat.other()),
            _ => None,
        });
        let at_corner = ended.iter().any(|end| match end {
            RangeEnd::Tip => self.sharp[seat.index()],
            RangeEnd::MateTip => self.sharp[seat.other().index()],
            _ => false,
        });
        let cells = patch.cells.iter().zip(&solution.forces);
        let largest = cells
            .clone()
            .map(|(cell, p)| p / cell.width)
            .fold(0.0, f64::max);
        let width: f64 = cells
            .filter(|(_, p)| **p > 0.0)
            .map(|(cell, _)| cell.width)
            .sum();
        Pressed {
            pressure: (!at_corner).then_some(largest),
            at_sharp_edge: at_corner,
            half_width: 0.5 * width,
            tip_corner: patch.off_path.then_some(seat),
            fillet,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::half_plane::logarithm_factor;
    use crate::contact::placement::Placement;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{GearPair, PlaneState, SpurGear};

    const COSINE: f64 = 0.95;
    const DENSITY: f64 = 1e5;

    fn pair() -> (GearPair, f64) {
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        let modulus = gear.material().plane_modulus(PlaneState::Strain);
        let pair = GearPair::new(gear.clone(), gear, 100.5e-3).expect("meshes");
        (pair.long_slices(), 2.0 * logarithm_factor(modulus, 1.0))
    }

    fn patch(phase: f64, along: f64) -> (Spring, f64) {
        let (pair, factor) = pair();
        let facing = Facing::drawn(&pair, phase).expect("they face each other");
        let view = View {
            placement: Placement::drawn(&pair, phase),
            seat: facing.seat,
        };
        Spring::patch(&view, &facing, (along, COSINE, factor), DENSITY)
    }

    #[test]
    fn cells_where_flanks_stand_free_are_hertzs_contact() {
        let along = 0.5e-3;
        let (cells, gap) = patch(0.1, along);
        assert!(gap < 4e-9, "the mean over a cell: {gap}");
        let (pair, factor) = pair();
        let s = pair.roll_length_of(0.1) / COSINE;
        let other = (pair.line_of_action() / COSINE) - s;
        let hertz = Spring::hertz(along, s * other / (s + other), factor, DENSITY);
        for part in [0.2, 0.5, 1.0, 2.0] {
            let force = part * DENSITY * along;
            let (a, b) = (cells.closing(force), hertz.closing(force));
            assert!(
                (a.depth / b.depth - 1.0).abs() < 2e-2,
                "{part}: {a:?} {b:?}"
            );
            assert!(
                (a.growth / b.growth - 1.0).abs() < 5e-2,
                "{part}: {a:?} {b:?}"
            );
            let (a, b) = (cells.pressed(force), hertz.pressed(force));
            let of = |pressed: Pressed| pressed.pressure.expect("no corner is near");
            assert!((of(a) / of(b) - 1.0).abs() < 6e-2);
        }
    }

    #[test]
    fn every_spring_grows_as_it_says_and_stiffens() {
        let along = 0.5e-3;
        let (pair, factor) = pair();
        let (s_a, s_e) = pair.path_of_contact();
        let periods = |s: f64| (s - pair.pitch_roll_length()) / pair.base_pitch();
        let hertz = Spring::hertz(along, 9e-3, factor, DENSITY);
        // Just inside the path of contact, where a tip corner is near, and beyond its end.
        let at_tip = patch(periods(s_e) - 0.01, along).0;
        let beyond = patch(periods(s_a) - 0.05, along).0;
        let thin = patch(periods(s_e) - 0.01, 2e-6).0;
        for (spring, along) in [
            (hertz, along),
            (at_tip, along),
            (beyond, along),
            (thin, 2e-6),
        ] {
            let mut last: Option<Closing> = None;
            for i in 0..60 {
                let force = DENSITY * along * 10_f64.powf(-8.0 + 0.15 * f64::from(i));
                let closing = spring.closing(force);
                assert!(closing.depth > 0.0 && closing.growth > 0.0);
                if let Some(last) = last {
                    assert!(closing.depth > last.depth);
                    // One that is shorter than its contact is wide is no line.
                    let stiffens = closing.growth < last.growth * (1.0 + 1e-3);
                    assert!(stiffens || along < 1e-5, "{i}: {last:?} {closing:?}");
                }
                last = Some(closing);
                let step = 1e-5 * force;
                let rise = spring.closing(force + step).depth - spring.closing(force - step).depth;
                let slope = rise / (2.0 * step);
                // Where a cell just touches the slope steps a little.
                assert!(
                    (closing.growth / slope - 1.0).abs() < 0.02,
                    "{i}: {slope} {closing:?}"
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
        let pressed = spring.pressed(0.2 * DENSITY * 0.5e-3);
        assert_eq!(pressed.pressure, None);
        assert_eq!(pressed.tip_corner, Some(Member::Driving));
        // A corner is softer than two cylinders.
        let free = patch(0.1, 0.5e-3).0;
        let force = 0.2 * DENSITY * 0.5e-3;
        assert!(spring.closing(force).depth > free.closing(force).depth);
    }
}
