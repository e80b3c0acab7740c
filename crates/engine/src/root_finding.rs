//! Where a condition ceases to hold, and where a value is least.

/// Halvings that bring any interval met here down to neighboring numbers.
const MOST_HALVINGS: u32 = 200;

/// The last place, going from `good` towards `bad`, at which `holds` still holds, to the last digit.
///
/// `holds` is taken to hold at `good` and to fail at `bad`; neither is asked. Where it changes several times, one of the
/// changes is found. `bad` may lie below `good`.
pub(crate) fn bisect(mut good: f64, mut bad: f64, mut holds: impl FnMut(f64) -> bool) -> f64 {
    for _ in 0..MOST_HALVINGS {
        let middle = f64::midpoint(good, bad);
        if middle == good || middle == bad {
            break;
        }
        if holds(middle) {
            good = middle
        } else {
            bad = middle
        }
    }
    good
}

/// The last place, going from `good` towards `bad`, at which `value` is not negative, to the last few digits.
///
/// Both come with their values, which are taken to be positive and negative. Steps are those of inverse quadratic interpolation where three places say that
/// it closes in, and halvings elsewhere (Chandrupatla, Adv. Eng. Softw. 28 (1997) 145): about seven evaluations where `value` is smooth. `bad` may lie
/// below `good`, and `value` may be infinite.
pub(crate) fn crossing(
    good: (f64, f64),
    bad: (f64, f64),
    mut value: impl FnMut(f64) -> f64,
) -> f64 {
    let holds = |at: (f64, f64)| at.1 >= 0.0;
    // The last place and the one across from it.
    let (mut here, mut across) = (good, bad);
    let secant = here.1 / (here.1 - across.1);
    let mut part = if secant > 0.0 && secant < 1.0 {
        secant
    } else {
        0.5
    };
    for _ in 0..MOST_HALVINGS {
        let far = here.0.abs().max(across.0.abs());
        let least = 2.0 * f64::EPSILON * far / (across.0 - here.0).abs();
        if here.1 == 0.0 || least.is_nan() || least >= 0.5 {
            break;
        }
        let place = here.0 + part.clamp(least, 1.0 - least) * (across.0 - here.0);
        let next = (place, value(place));
        // The one that it replaces.
        let before = if holds(next) == holds(here) {
            here
        } else {
            std::mem::replace(&mut across, here)
        };
        here = next;
        part = interpolated(here, across, before);
    }
    if holds(here) { here.0 } else { across.0 }
}

/// The part of the way from `here` to `across` at which the inverse parabola through them and the place `before` crosses zero; half where it may turn in
/// between.
fn interpolated(here: (f64, f64), across: (f64, f64), before: (f64, f64)) -> f64 {
    let xi = (here.0 - across.0) / (before.0 - across.0);
    let phi = (here.1 - across.1) / (before.1 - across.1);
    let is_steady = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
    if !is_steady {
        return 0.5;
    }
    let between = |one: (f64, f64), other: (f64, f64)| one.1 / (other.1 - one.1);
    between(here, across) * between(before, across)
        + (before.0 - here.0) / (across.0 - here.0)
            * between(here, before)
            * between(across, before)
}

/// The place between two at which `value`, which falls and then rises, is least: by golden sections, to a billionth of their distance.
pub(crate) fn least_between([mut low, mut high]: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 50;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let inner = |from: f64, to: f64| to + GOLDEN * (from - to);
    let (mut a, mut b) = (inner(low, high), inner(high, low));
    let (mut at_a, mut at_b) = (value(a), value(b));
    for _ in 0..STEPS {
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = inner(low, high);
            at_a = value(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = inner(high, low);
            at_b = value(b);
        }
    }
    f64::midpoint(low, high)
}

/// The places from `from` to `to` at which `value` is no more than beside them, with its value there: of `count` even steps, and found between them
/// where it changes by more than `rounding` from step to step.
pub(crate) fn least_places(
    [from, to]: [f64; 2],
    count: usize,
    rounding: f64,
    value: impl Fn(f64) -> f64,
) -> Vec<(f64, f64)> {
    let at = |i: usize| from + (to - from) * i as f64 / count as f64;
    let values: Vec<f64> = (0..=count).map(|i| value(at(i))).collect();
    let places = (0..=count).filter_map(|i| {
        let beside = [i.saturating_sub(1), (i + 1).min(count)];
        let rises = beside.map(|k| values[k] - values[i]);
        if !rises.iter().all(|rise| *rise >= 0.0) {
            return None;
        }
        let here = (at(i), values[i]);
        if rises.iter().all(|rise| *rise <= rounding) {
            return Some(here);
        }
        let between = least_between(beside.map(at), &value);
        let found = (between, value(between));
        Some(if found.1 < here.1 { found } else { here })
    });
    places.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_found_to_the_last_digit_from_either_side() {
        let below = bisect(0.0, 2.0, |x| x * x < 2.0);
        let above = bisect(2.0, 0.0, |x| x * x >= 2.0);
        assert!(below * below < 2.0 && above * above >= 2.0);
        assert_eq!(below.next_up(), above, "nothing lies between them");
    }

    #[test]
    fn a_smooth_change_is_found_to_the_last_digits_in_a_few_evaluations() {
        let mut count = 0;
        let root = |from: (f64, f64), to: (f64, f64), count: &mut u32| {
            crossing(from, to, |x| {
                *count += 1;
                2.0 - x * x
            })
        };
        for (good, bad) in [(0.0, 2.0), (1.4, 30.0), (-1.0, 1.5)] {
            let (ends, value) = ([good, bad], |x: f64| 2.0 - x * x);
            let [good, bad] = ends.map(|x| (x, value(x)));
            let found = root(good, bad, &mut count);
            assert!((found - 2.0_f64.sqrt()).abs() < 1e-15, "{found}");
            assert!(2.0 - found * found >= 0.0);
        }
        assert!(count < 3 * 12, "{count}");
    }

    #[test]
    fn a_change_by_a_jump_or_beside_an_infinite_value_is_found() {
        let jump = |x: f64| if x < 0.3 { 1.0 } else { -1e-9 };
        let found = crossing((1e-3, 1.0), (1.0, -1e-9), jump);
        assert!((found - 0.3).abs() < 1e-15 && found < 0.3);
        let beside = |x: f64| if x > 0.5 { x - 0.7 } else { f64::NEG_INFINITY };
        let found = crossing((1.0, 0.3), (0.0, f64::NEG_INFINITY), beside);
        assert!((found - 0.7).abs() < 1e-15 && found >= 0.7);
    }

    #[test]
    fn the_least_place_of_a_parabola_and_of_a_kink_is_found() {
        let parabola = least_between([0.0, 3.0], |x| (x - 2.3) * (x - 2.3));
        assert!((parabola - 2.3).abs() < 1e-7, "{parabola}");
        let kink = least_between([0.0, 3.0], |x: f64| (x - 0.4).abs());
        assert!((kink - 0.4).abs() < 1e-9, "{kink}");
    }

    #[test]
    fn each_of_several_least_places_is_found() {
        // Kinks at 0.13 and 0.77, and a parabola at the end.
        let value = |x: f64| {
            (x - 0.13)
                .abs()
                .min((x - 0.77).abs())
                .min((x - 1.0).powi(2) + 0.01)
        };
        let found = least_places([0.0, 1.0], 20, 1e-12, value);
        let expected = [(0.13, 0.0), (0.77, 0.0), (1.0, 0.01)];
        assert_eq!(found.len(), 3, "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found.0 - expected.0).abs() < 1e-9 && (found.1 - expected.1).abs() < 1e-9);
        }
    }

    #[test]
    fn a_condition_that_never_or_always_holds_leads_to_an_end() {
        assert_eq!(bisect(1.0, 3.0, |_| false), 1.0);
        assert_eq!(bisect(1.0, 3.0, |_| true), 3.0_f64.next_down());
    }
}
