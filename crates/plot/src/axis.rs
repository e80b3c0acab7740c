//! Axes: a range, a scale and the ticks that a reader expects on it.

/// How values are laid along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    Linear,
    Logarithmic,
}

/// An axis from `low` to `high` with its label, units included.
#[derive(Debug, Clone)]
pub struct Axis {
    pub(crate) label: String,
    scale: Scale,
    low: f64,
    high: f64,
    ticks: Vec<(f64, String)>,
}

impl Axis {
    /// A linear axis with about six ticks.
    pub fn linear(label: &str, low: f64, high: f64) -> Self {
        let step = nice_step(high - low);
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        let decimals = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
        let ticks = (first..=last)
            .map(|i| i as f64 * step)
            .map(|value| (value, format!("{value:.decimals$}")))
            .collect();
        Self {
            label: label.into(),
            scale: Scale::Linear,
            low,
            high,
            ticks,
        }
    }

    /// A linear axis from `low` to `high`, or to the next ticks beyond `values` where they reach further.
    pub fn reaching<'a>(
        label: &str,
        (low, high): (f64, f64),
        values: impl IntoIterator<Item = &'a f64>,
    ) -> Self {
        let (least, most) = values
            .into_iter()
            .filter(|value| value.is_finite())
            .fold((low, high), |(least, most), &value| {
                (least.min(value), most.max(value))
            });
        let step = nice_step(most - least);
        let low = if least < low {
            (least / step).floor() * step
        } else {
            low
        };
        let high = if most > high {
            (most / step).ceil() * step
        } else {
            high
        };
        Self::linear(label, low, high)
    }

    /// A logarithmic axis between two powers of ten.
    pub fn decades(label: &str, low: i32, high: i32) -> Self {
        let stride = if high - low > 6 { 2 } else { 1 };
        let ticks = (low..=high)
            .filter(|exponent| (exponent - low) % stride == 0)
            .map(|exponent| (10_f64.powi(exponent), power_of_ten(exponent)))
            .collect();
        Self {
            label: label.into(),
            scale: Scale::Logarithmic,
            low: 10_f64.powi(low),
            high: 10_f64.powi(high),
            ticks,
        }
    }

    /// An axis of angles over one revolution, in radians.
    pub fn revolution(label: &str) -> Self {
        use std::f64::consts::PI;
        let names = ["0", "π/2", "π", "3π/2", "2π"];
        let ticks = (0..)
            .zip(names)
            .map(|(i, name)| (f64::from(i) * PI / 2.0, name.to_owned()));
        Self::linear(label, 0.0, 2.0 * PI).with_ticks(ticks.collect())
    }

    /// The axis with other ticks.
    pub fn with_ticks(self, ticks: Vec<(f64, String)>) -> Self {
        Self { ticks, ..self }
    }

    /// True if `value` lies on the axis.
    pub(crate) fn shows(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Labels beside it, and their places.
    pub(crate) fn ticks(&self) -> &[(f64, String)] {
        &self.ticks
    }

    /// The part of the way between the ends at which `value` stands, from 0 to 1; a value beyond an end is put there.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        let value = value.clamp(self.low, self.high);
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Logarithmic => (value / self.low).ln() / (self.high / self.low).ln(),
        }
    }
}

/// The step of 1, 2 or 5 times a power of ten that divides `span` into about six.
fn nice_step(span: f64) -> f64 {
    let rough = (span / 6.0).max(f64::MIN_POSITIVE);
    let power = 10_f64.powf(rough.log10().floor());
    let nice = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|nice| nice * power >= 0.85 * rough);
    nice.unwrap_or(10.0) * power
}

fn power_of_ten(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = exponent.to_string();
    let raised = digits.chars().map(|c| match c.to_digit(10) {
        Some(digit) => DIGITS[digit as usize],
        None => '⁻',
    });
    std::iter::once('1').chain(['0']).chain(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, name)| name.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_numbers_with_the_decimals_they_need() {
        assert_eq!(
            names(&Axis::linear("", 10.0, 22.0)),
            ["10", "12", "14", "16", "18", "20", "22"]
        );
        assert_eq!(
            names(&Axis::linear("", 0.5, 3.0)),
            ["0.5", "1.0", "1.5", "2.0", "2.5", "3.0"]
        );
        assert_eq!(
            names(&Axis::decades("", -2, 1)),
            ["10⁻²", "10⁻¹", "10⁰", "10¹"]
        );
    }

    #[test]
    fn an_axis_reaches_past_its_printed_ends_where_the_values_do() {
        let axis = Axis::reaching("", (12.0, 18.0), &[11.3, 14.0]);
        assert_eq!((axis.low, axis.high), (11.0, 18.0));
    }

    #[test]
    fn decades_are_equally_long() {
        let axis = Axis::decades("", -4, 0);
        assert!((axis.fraction(1e-2) - 0.5).abs() < 1e-12);
        assert!((axis.fraction(1e-1) - 0.75).abs() < 1e-12);
    }
}
