//! Tip relief: material taken off the flank near the tip.

use super::Involute;

/// How the relief grows from its start to the tip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReliefShape {
    /// In proportion to the radius.
    Linear,
    /// With its square.
    Parabolic,
}

/// Where a relief starts, in any of the ways that a drawing may say it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReliefStart {
    /// A radial length below the tip circle.
    RadialLength(f64),
    /// A length along the path of contact, back from the tip.
    RollLengthFromTip(f64),
    /// A diameter.
    Diameter(f64),
    /// A roll angle of the flank, in radians.
    RollAngle(f64),
}

impl ReliefStart {
    /// The radius r_s at which the relief starts on `flank` under the tip radius r_a.
    pub fn radius(self, flank: &Involute, tip_radius: f64) -> f64 {
        match self {
            Self::RadialLength(length) => tip_radius - length,
            // A length past the base circle leaves the flank: no radius, rather than the mirrored point's.
            Self::RollLengthFromTip(length) => match flank.roll_length(tip_radius) - length {
                s if s < 0.0 => 0.0,
                s => flank.radius(s),
            },
            Self::Diameter(diameter) => diameter / 2.0,
            Self::RollAngle(angle) => flank.radius(flank.base_radius() * angle),
        }
    }
}

/// A tip relief: c(r) = C_a ((r − r_s)/(r_a − r_s))^n, normal to the flank, in the radius however its start was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipRelief {
    amount: f64,
    shape: ReliefShape,
    start_radius: f64,
    tip_radius: f64,
}

impl TipRelief {
    pub(super) fn new(amount: f64, shape: ReliefShape, start_radius: f64, tip_radius: f64) -> Self {
        Self {
            amount,
            shape,
            start_radius,
            tip_radius,
        }
    }

    /// The amount C_a at the tip.
    pub fn amount(&self) -> f64 {
        self.amount
    }

    /// The radius r_s at which the relief starts.
    pub fn start_radius(&self) -> f64 {
        self.start_radius
    }

    /// How the relief grows.
    pub fn shape(&self) -> ReliefShape {
        self.shape
    }

    /// The material c(r) removed at `radius`, along the normal; zero below the start.
    pub fn depth(&self, radius: f64) -> f64 {
        let fraction = self.fraction(radius);
        self.amount
            * match self.shape {
                ReliefShape::Linear => fraction,
                ReliefShape::Parabolic => fraction * fraction,
            }
    }

    /// The slope dc/dr at `radius`, towards the tip where the relief has a kink.
    pub fn slope(&self, radius: f64) -> f64 {
        if radius < self.start_radius {
            return 0.0;
        }
        self.amount / (self.tip_radius - self.start_radius)
            * match self.shape {
                ReliefShape::Linear => 1.0,
                ReliefShape::Parabolic => 2.0 * self.fraction(radius),
            }
    }

    /// The part of the way from the start to the tip.
    fn fraction(&self, radius: f64) -> f64 {
        ((radius - self.start_radius) / (self.tip_radius - self.start_radius)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_roll_length_past_the_base_circle_starts_nowhere_on_the_flank() {
        let flank = Involute::new(46.984_631_039_295_42e-3, 0.0463);
        let length = flank.roll_length(52e-3) + 20e-3;
        assert_eq!(
            ReliefStart::RollLengthFromTip(length).radius(&flank, 52e-3),
            0.0
        );
    }

    #[test]
    fn the_slope_is_that_of_the_depth() {
        for shape in [ReliefShape::Linear, ReliefShape::Parabolic] {
            let relief = TipRelief::new(5e-6, shape, 50.25e-3, 52e-3);
            for radius in [50e-3, 50.3e-3, 51e-3, 51.9e-3] {
                let step = 1e-7;
                let difference =
                    (relief.depth(radius + step) - relief.depth(radius - step)) / (2.0 * step);
                assert!((relief.slope(radius) - difference).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn the_four_ways_to_give_a_start_agree() {
        // The relief of the paper's gears: 1.75 mm below a tip radius of 52 mm is the operating pitch radius 50.25 mm,
        // at the roll length 17.8187 mm (FIELD section 3.1).
        let flank = Involute::new(46.984_631_039_295_42e-3, 0.0463);
        let r_a = 52e-3;
        let s = flank.roll_length(50.25e-3);
        assert!((s - 17.8187e-3).abs() < 1e-7);
        for start in [
            ReliefStart::RadialLength(1.75e-3),
            ReliefStart::RollLengthFromTip(flank.roll_length(r_a) - s),
            ReliefStart::Diameter(100.5e-3),
            ReliefStart::RollAngle(s / flank.base_radius()),
        ] {
            assert!((start.radius(&flank, r_a) - 50.25e-3).abs() < 1e-15);
        }
    }
}
