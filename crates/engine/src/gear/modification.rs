//! Profile modifications: material removed from the flank, normal to it.

use super::Involute;

/// Shape of a relief from its start to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReliefShape {
    /// In proportion to the radius.
    Linear,
    /// With its square.
    Parabolic,
}

/// Where a relief starts: it grows from there towards an end of the flank, at the tip circle or at the form circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReliefStart {
    /// A radial length from that circle.
    RadialLength(f64),
    /// A length along the path of contact, from that circle.
    RollLength(f64),
    /// A diameter.
    Diameter(f64),
    /// A roll angle of the flank, in radians.
    RollAngle(f64),
}

/// A relief as a drawing gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReliefData {
    /// The amount at the end of the flank: C_a at the tip, C_f at the form circle.
    pub amount: f64,
    /// How it grows towards that end.
    pub shape: ReliefShape,
    /// Where it starts.
    pub start: ReliefStart,
}

/// Where the entries of a profile table stand.
#[derive(Debug, Clone, PartialEq)]
pub enum TablePlaces {
    /// Rising roll lengths.
    RollLengths(Vec<f64>),
    /// Rising diameters.
    Diameters(Vec<f64>),
}

/// One modification of the loaded flanks as a drawing gives it; several of a gear add up. Lengths are in meters; removed material is positive.
#[derive(Debug, Clone, PartialEq)]
pub enum ModificationData {
    /// A relief that grows towards the tip circle.
    TipRelief(ReliefData),
    /// A relief that grows towards the form circle.
    RootRelief(ReliefData),
    /// A parabola in the roll length: nothing midway between form circle and tip circle, the amount C_α at both.
    Crowning {
        /// C_α.
        amount: f64,
    },
    /// In proportion to the roll length: nothing at the form circle, the amount C_Hα at the tip circle; negative adds.
    Slope {
        /// C_Hα.
        amount: f64,
    },
    /// A table, linear between its entries in the variable that it is given over, its ends held.
    Table {
        /// Where the entries stand.
        places: TablePlaces,
        /// Removed at each.
        removed: Vec<f64>,
    },
}

impl TablePlaces {
    /// The rising places, whatever they are.
    pub fn values(&self) -> &[f64] {
        match self {
            Self::RollLengths(values) | Self::Diameters(values) => values,
        }
    }

    /// The place of the roll length `s` of `flank`, and how fast it grows with it.
    fn place(&self, flank: &Involute, s: f64) -> (f64, f64) {
        match self {
            Self::RollLengths(_) => (s, 1.0),
            Self::Diameters(_) => {
                let r = flank.radius(s);
                (2.0 * r, 2.0 * s / r)
            }
        }
    }

    /// The roll lengths of `flank` at its places.
    pub(super) fn roll_lengths(&self, flank: &Involute) -> Vec<f64> {
        match self {
            Self::RollLengths(lengths) => lengths.clone(),
            Self::Diameters(diameters) => diameters
                .iter()
                .map(|diameter| flank.roll_length(diameter / 2.0))
                .collect(),
        }
    }
}

impl ReliefStart {
    /// The radius r_s at which a relief of the tip starts on `flank` under the tip radius r_a.
    pub fn below_tip(self, flank: &Involute, tip_radius: f64) -> f64 {
        self.radius(flank, tip_radius, -1.0)
    }

    /// The radius at which a relief of the root starts on `flank` above the form radius.
    pub fn above_form(self, flank: &Involute, form_radius: f64) -> f64 {
        self.radius(flank, form_radius, 1.0)
    }

    fn radius(self, flank: &Involute, end_radius: f64, outward: f64) -> f64 {
        match self {
            Self::RadialLength(length) => end_radius + outward * length,
            // A length past the base circle leaves the flank: no radius, rather than the mirrored point's.
            Self::RollLength(length) => match flank.roll_length(end_radius) + outward * length {
                s if s < 0.0 => 0.0,
                s => flank.radius(s),
            },
            Self::Diameter(diameter) => diameter / 2.0,
            Self::RollAngle(angle) => flank.radius(flank.base_radius() * angle),
        }
    }
}

/// A relief: c(r) = C ((r − r_s)/(r_e − r_s))^n, normal to the flank, in the radius however its start was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relief {
    amount: f64,
    shape: ReliefShape,
    start_radius: f64,
    end_radius: f64,
}

impl Relief {
    /// A relief of `amount` at `end_radius`: the tip radius, or the form radius for a root relief.
    pub(super) fn new(amount: f64, shape: ReliefShape, start_radius: f64, end_radius: f64) -> Self {
        Self {
            amount,
            shape,
            start_radius,
            end_radius,
        }
    }

    /// The amount C at its end.
    pub fn amount(&self) -> f64 {
        self.amount
    }

    /// The radius r_s at which the relief starts.
    pub fn start_radius(&self) -> f64 {
        self.start_radius
    }

    /// The material c(r) removed at `radius`, along the normal; zero before the start.
    pub fn depth(&self, radius: f64) -> f64 {
        let fraction = self.fraction(radius);
        self.amount
            * match self.shape {
                ReliefShape::Linear => fraction,
                ReliefShape::Parabolic => fraction * fraction,
            }
    }

    /// The slope dc/dr at `radius`, that of the relief where it has a kink.
    pub fn slope(&self, radius: f64) -> f64 {
        let length = self.end_radius - self.start_radius;
        if (radius - self.start_radius) * length < 0.0 {
            return 0.0;
        }
        self.amount / length
            * match self.shape {
                ReliefShape::Linear => 1.0,
                ReliefShape::Parabolic => 2.0 * self.fraction(radius),
            }
    }

    /// The part of the way from the start to the end.
    fn fraction(&self, radius: f64) -> f64 {
        ((radius - self.start_radius) / (self.end_radius - self.start_radius)).max(0.0)
    }
}

/// A modification of a flank that exists.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Modification {
    /// In the radius.
    Tip(Relief),
    /// In the radius.
    Root(Relief),
    /// C_α (2 (s − s_m)/(s_a − s_f))², s_m midway.
    Crowning { amount: f64, middle: f64, half: f64 },
    /// C_Hα (s − s_f)/(s_a − s_f).
    Slope { amount: f64, from: f64, length: f64 },
    /// Linear between rising places.
    Table {
        places: TablePlaces,
        removed: Vec<f64>,
    },
}

impl Modification {
    /// Material removed at the roll length `s` of `flank`, in meters.
    pub(super) fn depth(&self, flank: &Involute, s: f64) -> f64 {
        match self {
            Self::Tip(relief) | Self::Root(relief) => {
                // Most of a flank is not relieved, and its radius need not be known.
                let square = s * s + flank.base_radius() * flank.base_radius();
                let beyond = square - relief.start_radius * relief.start_radius;
                if beyond * (relief.end_radius - relief.start_radius) <= 0.0 {
                    0.0
                } else {
                    relief.depth(flank.radius(s))
                }
            }
            Self::Crowning {
                amount,
                middle,
                half,
            } => amount * ((s - middle) / half).powi(2),
            Self::Slope {
                amount,
                from,
                length,
            } => amount * (s - from) / length,
            Self::Table { places, removed } => {
                let (i, part) = in_table(places.values(), places.place(flank, s).0);
                removed[i] + part * (removed[i + 1] - removed[i])
            }
        }
    }

    /// The slope of [`Modification::depth`] by the roll length.
    pub(super) fn slope(&self, flank: &Involute, s: f64) -> f64 {
        match self {
            Self::Tip(relief) | Self::Root(relief) => {
                let r = flank.radius(s);
                relief.slope(r) * s / r
            }
            Self::Crowning {
                amount,
                middle,
                half,
            } => 2.0 * amount * (s - middle) / (half * half),
            Self::Slope { amount, length, .. } => amount / length,
            Self::Table { places, removed } => {
                let ((place, growth), values) = (places.place(flank, s), places.values());
                if place < values[0] || place > values[values.len() - 1] {
                    return 0.0;
                }
                let (i, _) = in_table(values, place);
                growth * (removed[i + 1] - removed[i]) / (values[i + 1] - values[i])
            }
        }
    }

    /// The values of a table; none of others.
    pub(super) fn entries(&self) -> &[f64] {
        match self {
            Self::Table { removed, .. } => removed,
            Self::Tip(_) | Self::Root(_) | Self::Crowning { .. } | Self::Slope { .. } => &[],
        }
    }

    /// The roll lengths at which [`Modification::slope`] jumps, or begins to grow.
    pub(super) fn kinks(&self, flank: &Involute) -> Vec<f64> {
        match self {
            Self::Tip(relief) | Self::Root(relief) => vec![flank.roll_length(relief.start_radius)],
            Self::Crowning { .. } | Self::Slope { .. } => Vec::new(),
            Self::Table { places, .. } => places.roll_lengths(flank),
        }
    }

    /// The roll lengths of `flank` between which it removes nothing.
    pub(super) fn untouched(&self, flank: &Involute) -> [f64; 2] {
        match self {
            Self::Tip(relief) => [0.0, flank.roll_length(relief.start_radius)],
            Self::Root(relief) => [flank.roll_length(relief.start_radius), f64::INFINITY],
            Self::Crowning { .. } | Self::Slope { .. } | Self::Table { .. } => [0.0, 0.0],
        }
    }

    /// True if it only ever bends the flank away from its mate, so that the gap keeps one least place.
    pub(super) fn is_convex(&self) -> bool {
        match self {
            Self::Tip(relief) | Self::Root(relief) => relief.amount >= 0.0,
            Self::Crowning { amount, .. } => *amount >= 0.0,
            Self::Slope { .. } => true,
            Self::Table { .. } => false,
        }
    }
}

/// The interval of the rising `places` that holds `s`, or the nearest one, and the part of it before `s`.
pub(super) fn in_table(places: &[f64], s: f64) -> (usize, f64) {
    let after = places.partition_point(|place| *place <= s);
    let i = after.clamp(1, places.len() - 1) - 1;
    let part = (s - places[i]) / (places[i + 1] - places[i]);
    (i, part.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLANK: (f64, f64) = (46.984_631_039_295_42e-3, 0.0463);

    fn flank() -> Involute {
        Involute::new(FLANK.0, FLANK.1)
    }

    #[test]
    fn a_roll_length_past_the_base_circle_starts_nowhere_on_the_flank() {
        let length = flank().roll_length(52e-3) + 20e-3;
        assert_eq!(
            ReliefStart::RollLength(length).below_tip(&flank(), 52e-3),
            0.0
        );
    }

    #[test]
    fn every_slope_is_that_of_its_depth() {
        let flank = flank();
        let (s_f, s_a) = (flank.roll_length(48.3e-3), flank.roll_length(52e-3));
        let relief = |shape, from, to| Relief::new(5e-6, shape, from, to);
        let modifications = [
            Modification::Tip(relief(ReliefShape::Linear, 50.25e-3, 52e-3)),
            Modification::Tip(relief(ReliefShape::Parabolic, 50.25e-3, 52e-3)),
            Modification::Root(relief(ReliefShape::Linear, 49.5e-3, 48.3e-3)),
            Modification::Root(relief(ReliefShape::Parabolic, 49.5e-3, 48.3e-3)),
            Modification::Crowning {
                amount: 4e-6,
                middle: f64::midpoint(s_f, s_a),
                half: 0.5 * (s_a - s_f),
            },
            Modification::Slope {
                amount: -3e-6,
                from: s_f,
                length: s_a - s_f,
            },
            Modification::Table {
                places: TablePlaces::RollLengths(vec![s_f, 15e-3, 18e-3, s_a]),
                removed: vec![2e-6, 0.0, 1e-6, 8e-6],
            },
            Modification::Table {
                places: TablePlaces::Diameters(vec![96.6e-3, 98e-3, 101.7e-3, 104e-3]),
                removed: vec![2e-6, 0.0, 1e-6, 8e-6],
            },
        ];
        for modification in &modifications {
            for radius in [48.4e-3, 49.1e-3, 50e-3, 50.3e-3, 51e-3, 51.9e-3] {
                let (s, step) = (flank.roll_length(radius), 1e-8);
                let difference = (modification.depth(&flank, s + step)
                    - modification.depth(&flank, s - step))
                    / (2.0 * step);
                let slope = modification.slope(&flank, s);
                assert!(
                    (slope - difference).abs() < 1e-8,
                    "{modification:?} at {radius}: {slope} {difference}"
                );
            }
        }
    }

    #[test]
    fn each_modification_removes_its_amount_where_the_drawing_says() {
        let flank = flank();
        let (s_f, s_a) = (flank.roll_length(48.3e-3), flank.roll_length(52e-3));
        let near = |value: f64, expected: f64| assert!((value - expected).abs() < 1e-18, "{value}");
        let crowning = Modification::Crowning {
            amount: 4e-6,
            middle: f64::midpoint(s_f, s_a),
            half: 0.5 * (s_a - s_f),
        };
        near(crowning.depth(&flank, s_f), 4e-6);
        near(crowning.depth(&flank, s_a), 4e-6);
        near(crowning.depth(&flank, f64::midpoint(s_f, s_a)), 0.0);
        let root = Modification::Root(Relief::new(6e-6, ReliefShape::Linear, 49.5e-3, 48.3e-3));
        near(root.depth(&flank, s_f), 6e-6);
        near(root.depth(&flank, flank.roll_length(48.9e-3)), 3e-6);
        near(root.depth(&flank, flank.roll_length(49.6e-3)), 0.0);
        let table = Modification::Table {
            places: TablePlaces::RollLengths(vec![14e-3, 16e-3, 20e-3]),
            removed: vec![3e-6, 1e-6, 5e-6],
        };
        // The ends are held.
        for (s, removed) in [(13e-3, 3e-6), (15e-3, 2e-6), (18e-3, 3e-6), (21e-3, 5e-6)] {
            near(table.depth(&flank, s), removed);
        }
    }

    #[test]
    fn a_table_is_linear_in_the_variable_that_it_is_given_over() {
        // Of two entries over diameters it is the linear relief between them; over roll lengths it is not.
        let flank = flank();
        let (start, end) = (50.25e-3, 52e-3);
        let relief = Relief::new(30e-6, ReliefShape::Linear, start, end);
        let table = |places| Modification::Table {
            places,
            removed: vec![0.0, 30e-6],
        };
        let over_diameters = table(TablePlaces::Diameters(vec![2.0 * start, 2.0 * end]));
        let roll_lengths = [start, end].map(|radius| flank.roll_length(radius));
        let over_lengths = table(TablePlaces::RollLengths(roll_lengths.to_vec()));
        let s = flank.roll_length(51.1e-3);
        assert!((over_diameters.depth(&flank, s) - relief.depth(51.1e-3)).abs() < 1e-18);
        assert!((over_lengths.depth(&flank, s) - relief.depth(51.1e-3)).abs() > 0.2e-6);
        assert_eq!(over_diameters.kinks(&flank), roll_lengths);
    }

    #[test]
    fn the_four_ways_to_give_a_start_agree() {
        // The relief of the paper's gears: 1.75 mm below a tip radius of 52 mm is the operating pitch radius 50.25 mm,
        // at the roll length 17.8187 mm.
        let flank = flank();
        let r_a = 52e-3;
        let s = flank.roll_length(50.25e-3);
        assert!((s - 17.8187e-3).abs() < 1e-7);
        for start in [
            ReliefStart::RadialLength(1.75e-3),
            ReliefStart::RollLength(flank.roll_length(r_a) - s),
            ReliefStart::Diameter(100.5e-3),
            ReliefStart::RollAngle(s / flank.base_radius()),
        ] {
            assert!((start.below_tip(&flank, r_a) - 50.25e-3).abs() < 1e-15);
        }
        let r_f = 48.3e-3;
        for start in [
            ReliefStart::RadialLength(1.95e-3),
            ReliefStart::RollLength(s - flank.roll_length(r_f)),
            ReliefStart::Diameter(100.5e-3),
            ReliefStart::RollAngle(s / flank.base_radius()),
        ] {
            assert!((start.above_form(&flank, r_f) - 50.25e-3).abs() < 1e-15);
        }
    }
}
