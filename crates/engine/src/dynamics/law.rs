//! Laws of force that are piecewise linear, and the motion under one of their pieces.

/// Below this 2at is small, and the closed forms lose digits that their series keep.
const SMALL: f64 = 1e-3;

/// Laws of force with the same forces at their knots, one after the other. Each is continuous, and goes on straight beyond its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Laws {
    forces: Vec<f64>,
    /// Of each law its knots, strictly rising.
    knots: Vec<f64>,
    /// Knots at and below this place have no force of the loaded flank.
    touch: usize,
}

/// A piece of a law: force + stiffness (u − from) between two knots.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) low: f64,
    pub(super) high: f64,
    from: f64,
    force: f64,
    pub(super) stiffness: f64,
}

impl Piece {
    pub(super) fn force(&self, u: f64) -> f64 {
        self.force + self.stiffness * (u - self.from)
    }
}

impl Laws {
    /// Laws with `forces`, which do not fall, at their `knots`, the knots of one law after those of another. The loaded flank touches at the
    /// knot `touch`.
    pub fn new(forces: Vec<f64>, mut knots: Vec<f64>, touch: usize) -> Self {
        // Knots that rounding or a backlash of nothing brings together are held apart by less than an atom.
        const APART: f64 = 1e-14;
        for law in knots.chunks_mut(forces.len()) {
            for j in (0..touch).rev() {
                law[j] = law[j].min(law[j + 1] - APART);
            }
            for j in touch + 1..law.len() {
                law[j] = law[j].max(law[j - 1] + APART);
            }
        }
        Self {
            forces,
            knots,
            touch,
        }
    }

    /// How many laws there are.
    pub fn count(&self) -> usize {
        self.knots.len() / self.forces.len()
    }

    fn knots_of(&self, law: usize) -> &[f64] {
        let n = self.forces.len();
        &self.knots[law * n..(law + 1) * n]
    }

    /// The place of the piece of `law` in which `u` lies, the one above where `u` is a knot and `rises`; looked for from `near`.
    pub(super) fn place(&self, law: usize, u: f64, rises: bool, near: usize) -> usize {
        let knots = self.knots_of(law);
        let mut place = near.min(knots.len());
        while place < knots.len() && (u > knots[place] || (u == knots[place] && rises)) {
            place += 1;
        }
        while place > 0 && (u < knots[place - 1] || (u == knots[place - 1] && !rises)) {
            place -= 1;
        }
        place
    }

    /// The piece at `place` of `law`: that below its first knot has the place 0.
    pub(super) fn piece(&self, law: usize, place: usize) -> Piece {
        let knots = self.knots_of(law);
        let last = knots.len() - 1;
        let from = place.clamp(1, last) - 1;
        let stiffness =
            (self.forces[from + 1] - self.forces[from]) / (knots[from + 1] - knots[from]);
        Piece {
            low: if place == 0 {
                f64::NEG_INFINITY
            } else {
                knots[place - 1]
            },
            high: if place > last {
                f64::INFINITY
            } else {
                knots[place]
            },
            from: knots[from],
            force: self.forces[from],
            stiffness,
        }
    }

    /// The force of `law` at `u`.
    pub fn force(&self, law: usize, u: f64) -> f64 {
        let place = self.place(law, u, true, self.touch + 1);
        self.piece(law, place).force(u)
    }

    /// The stiffness of `law` at `u`.
    pub(super) fn stiffness(&self, law: usize, u: f64) -> f64 {
        let place = self.place(law, u, true, self.touch + 1);
        self.piece(law, place).stiffness
    }

    /// One law whose knots are the means of those of all, stretched about 0 to have the `stiffness` there.
    pub(super) fn mean(&self, stiffness: f64) -> Self {
        let (count, laws) = (self.forces.len(), self.count() as f64);
        let mean = |j: usize| self.knots.iter().skip(j).step_by(count).sum::<f64>() / laws;
        let mean = Self::new(
            self.forces.clone(),
            (0..count).map(mean).collect(),
            self.touch,
        );
        let stretched = mean.stiffness(0, 0.0) / stiffness;
        let knots = mean.knots.iter().map(|knot| stretched * knot).collect();
        Self::new(self.forces.clone(), knots, self.touch)
    }

    /// True if the loaded flanks are apart in the pieces at `place`.
    pub(super) fn is_apart(&self, place: usize) -> bool {
        place <= self.touch
    }
}

/// How a piece answers after a time t: g obeys g'' + 2a g' + (k/m) g = 0 from g = 0 and g' = 1; G is the integral of g.
///
/// Then u = u_0 + v_0 g + r G and u' = v_0 g' + r g, with r = (f − k u_0)/m the pull that is not in balance at the beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Response {
    pub(super) g: f64,
    pub(super) rate: f64,
    pub(super) integral: f64,
}

impl Response {
    /// For `half_damping` a = c/2m and the `square` k/m of the frequency, after `t`.
    pub(super) fn new(half_damping: f64, square: f64, t: f64) -> Self {
        let decay = (-half_damping * t).exp();
        let rest = square - half_damping * half_damping;
        let turned = rest * t * t;
        // cos and sin(·)/·, or their continuation past critical damping.
        let (cosine, sine) = if turned.abs() < 1e-6 {
            (
                1.0 - turned / 2.0 + turned * turned / 24.0,
                t * (1.0 - turned / 6.0 + turned * turned / 120.0),
            )
        } else if rest > 0.0 {
            let w = rest.sqrt();
            let (sin, cos) = (w * t).sin_cos();
            (cos, sin / w)
        } else {
            let w = (-rest).sqrt();
            ((w * t).cosh(), (w * t).sinh() / w)
        };
        let g = decay * sine;
        let rate = decay * (cosine - half_damping * sine);
        let z = 2.0 * half_damping * t;
        let integral = if square * t * t > SMALL {
            (1.0 - rate - 2.0 * half_damping * g) / square
        } else if square == 0.0 && z > SMALL {
            (t - g) / (2.0 * half_damping)
        } else if z < 1.0 {
            Self::short_integral(half_damping, square, t)
        } else {
            // g(t + s) = g'(t) g(s) + g(t) (g'(s) + 2a g(s)), integrated over the second half.
            let half = Self::new(half_damping, square, t / 2.0);
            let again = half.rate * half.integral;
            half.integral + again + half.g * (half.g + 2.0 * half_damping * half.integral)
        };
        Self { g, rate, integral }
    }

    /// ∫g by the power series of g, for short times.
    fn short_integral(half_damping: f64, square: f64, t: f64) -> f64 {
        // g = Σ c_n t^n with (n + 2)(n + 1) c_{n+2} = −2a (n + 1) c_{n+1} − (k/m) c_n.
        let (mut before, mut now) = (0.0, 1.0);
        let mut power = t;
        let mut sum = 0.0;
        for n in 0..24 {
            let n = f64::from(n);
            power *= t;
            sum += now * power / (n + 2.0);
            let next =
                -(2.0 * half_damping * (n + 1.0) * now + square * before) / ((n + 2.0) * (n + 1.0));
            (before, now) = (now, next);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The classical Runge-Kutta method on u'' = r − 2a u' − s u from rest at `(u, v)`.
    fn integrated(a: f64, s: f64, r: f64, (mut u, mut v): (f64, f64), t: f64) -> (f64, f64) {
        let n = 20_000;
        let h = t / f64::from(n);
        let f = |u: f64, v: f64| (v, r - 2.0 * a * v - s * u);
        for _ in 0..n {
            let k1 = f(u, v);
            let k2 = f(u + h / 2.0 * k1.0, v + h / 2.0 * k1.1);
            let k3 = f(u + h / 2.0 * k2.0, v + h / 2.0 * k2.1);
            let k4 = f(u + h * k3.0, v + h * k3.1);
            u += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
            v += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        }
        (u, v)
    }

    #[test]
    fn a_piece_moves_as_its_equation_says_with_and_without_stiffness_and_damping() {
        for (a, s) in [
            (0.1, 4.0),
            (3.0, 4.0),
            (2.0, 4.0),
            (0.1, 0.0),
            (0.0, 0.0),
            (0.0, 4.0),
            (1e-5, 1e-9),
            (1.5, 1e-7),
            (0.0, 1e-5),
        ] {
            for t in [1e-3, 0.02, 0.7, 5.0] {
                let (r, u, v) = (0.7, 0.3, -1.1);
                let response = Response::new(a, s, t);
                let pull = r - s * u;
                let moved = (
                    u + v * response.g + pull * response.integral,
                    v * response.rate + pull * response.g,
                );
                let expected = integrated(a, s, r, (u, v), t);
                assert!(
                    (moved.0 - expected.0).abs() < 1e-11 * (1.0 + t)
                        && (moved.1 - expected.1).abs() < 1e-11 * (1.0 + t),
                    "{a} {s} {t}: {moved:?} {expected:?}"
                );
            }
        }
    }

    #[test]
    fn a_law_is_found_from_any_place_and_goes_on_straight() {
        let laws = Laws::new(
            vec![-1.0, 0.0, 0.0, 2.0],
            vec![-4.0, -3.0, 0.0, 1.0, -8.0, -6.0, 0.0, 2.0],
            2,
        );
        assert_eq!(laws.count(), 2);
        for near in 0..5 {
            for (u, rises, place) in [
                (-5.0, true, 0),
                (-3.5, true, 1),
                (-3.0, true, 2),
                (-3.0, false, 1),
                (0.0, false, 2),
                (0.0, true, 3),
                (7.0, true, 4),
            ] {
                assert_eq!(laws.place(0, u, rises, near), place, "{u} from {near}");
            }
        }
        for (u, force) in [
            (-5.0, -2.0),
            (-3.5, -0.5),
            (-1.0, 0.0),
            (0.5, 1.0),
            (2.0, 4.0),
        ] {
            assert_eq!(laws.force(0, u), force);
            assert_eq!(laws.force(1, 2.0 * u), force);
        }
        assert!(laws.is_apart(2) && !laws.is_apart(3));
    }
}
