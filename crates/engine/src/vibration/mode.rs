//! One mode: its frequency, its kind, and how the teeth move in it.

use faer::c64;

use crate::fem::prism::COMPONENTS;

/// Main direction of a mode's motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Around the axis, axisymmetric.
    Torsion,
    /// In the plane of the gear.
    InPlane,
    /// Along the axis.
    OutOfPlane,
}

/// The part of one order in how the teeth move: at the angle φ from tooth 0 the displacement is that times e^{inφ}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrderShape {
    /// n, of either sign.
    pub order: i64,
    /// Outward along the radius, counter-clockwise, and along the axis, in kg^(−1/2): at the loaded flank on the reference circle, in the mean over the face.
    pub at_pitch: [c64; COMPONENTS],
    /// The same on the circle below the roots.
    pub on_rim: [c64; COMPONENTS],
}

/// A natural mode of a gear.
///
/// Shapes have a modal mass of 1 kg. A double mode is two with the same frequency: the real part of its shape and the imaginary one.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// In hertz, of the gear at rest.
    pub frequency: f64,
    /// True if it is two modes of one frequency.
    pub is_double: bool,
    /// Main direction of its motion.
    pub direction: Direction,
    /// Lines across the gear that stand still.
    pub nodal_diameters: u32,
    /// Circles between bore and teeth that stand still.
    pub nodal_circles: u32,
    /// c = −2 ∫ U V dm/∫ (U² + V²) dm for u_r = U cos nφ and u_t = V sin nφ: the part of Coriolis forces. 1 of a rigid translation.
    pub coriolis: f64,
    /// How far the pair is from a mode: ‖A⁻¹ M x − θ x‖/θ, which bounds the relative error of the frequency against the grid's own.
    pub residual: f64,
    /// How the teeth move.
    pub shape: Vec<OrderShape>,
}

impl Mode {
    /// The displacement (radial, tangential, axial) in kg^(−1/2) of the loaded flank on the reference circle at the angle `angle` from tooth 0: that of the cosine, and that
    /// of the sine of a double mode, which is zero otherwise.
    pub fn at_pitch(&self, angle: f64) -> [[f64; COMPONENTS]; 2] {
        self.at(angle, |order| order.at_pitch)
    }

    /// The same on the circle below the roots.
    pub fn on_rim(&self, angle: f64) -> [[f64; COMPONENTS]; 2] {
        self.at(angle, |order| order.on_rim)
    }

    /// The displacement in kg^(−1/2) of the loaded flank on the reference circle along `direction` (radial, tangential, axial), by the nodal diameters of the mode
    /// alone: the root of the mean square over its places around the gear of the cosine and the sine together. Without nodal diameters that is the displacement.
    /// A single mode with nodal diameters has half of its mean square in each of the two waves that make it.
    pub fn around(&self, direction: &[f64; COMPONENTS]) -> f64 {
        let n = i64::from(self.nodal_diameters);
        let of_order = |order: i64| -> c64 {
            let own = self.shape.iter().filter(|of| of.order == order);
            own.flat_map(|of| of.at_pitch.iter().zip(direction))
                .map(|(u, along)| u * *along)
                .sum()
        };
        if n == 0 {
            return of_order(0).re.abs();
        }
        let [ahead, back] = [of_order(n), of_order(-n)];
        if self.is_double {
            ahead.norm().hypot(back.norm())
        } else {
            (ahead + back.conj()).norm() / std::f64::consts::SQRT_2
        }
    }

    /// Takes `other`, a single mode with as many nodal diameters and nearly the same frequency, as its sine: both have the Coriolis forces of the wave
    /// that they make. `coupled` is x₁ᵀ M J x₂ of their vectors, J the turn by a right angle. They become one double mode if they `are_equal`. Returns the
    /// sign of `other` in the wave.
    pub(super) fn pair_with(&mut self, other: &mut Self, coupled: f64, are_equal: bool) -> f64 {
        let joined = |sign: f64| -> Vec<OrderShape> {
            let both = self.shape.iter().zip(&other.shape);
            let add = |one: [c64; COMPONENTS], other: [c64; COMPONENTS]| {
                std::array::from_fn(|i| one[i] + other[i] * c64::new(0.0, sign))
            };
            both.map(|(one, other)| OrderShape {
                order: one.order,
                at_pitch: add(one.at_pitch, other.at_pitch),
                on_rim: add(one.on_rim, other.on_rim),
            })
            .collect()
        };
        let n = i64::from(self.nodal_diameters);
        let forward = |shape: &[OrderShape]| -> f64 {
            let own = shape.iter().filter(|of| of.order == n);
            own.flat_map(|of| of.on_rim).map(|u| u.norm_sqr()).sum()
        };
        let [ahead, back] = [1.0, -1.0].map(joined);
        let (sign, shape) = match forward(&ahead) >= forward(&back) {
            true => (1.0, ahead),
            false => (-1.0, back),
        };
        let coriolis = -sign * coupled;
        (self.coriolis, other.coriolis) = (coriolis, coriolis);
        if are_equal {
            self.is_double = true;
            self.frequency = f64::midpoint(self.frequency, other.frequency);
            self.residual = self.residual.max(other.residual);
            self.shape = shape;
        }
        sign
    }

    fn at(
        &self,
        angle: f64,
        of: impl Fn(&OrderShape) -> [c64; COMPONENTS],
    ) -> [[f64; COMPONENTS]; 2] {
        let mut sum = [[0.0; COMPONENTS]; 2];
        for order in &self.shape {
            let turn = c64::cis(order.order as f64 * angle);
            for (component, value) in of(order).into_iter().enumerate() {
                let value = value * turn;
                sum[0][component] += value.re;
                sum[1][component] += if self.is_double { value.im } else { 0.0 };
            }
        }
        sum
    }
}
