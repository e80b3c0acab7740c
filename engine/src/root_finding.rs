//! Where something ceases to hold.

/// The last place, going from `good` towards `bad`, at which `holds` still holds: to the last digit.
///
/// `holds` is taken to change once on the way; it is not asked at `good`.
pub fn bisect(mut good: f64, mut bad: f64, holds: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = f64::midpoint(good, bad);
        if middle == good || middle == bad || middle.is_nan() {
            return good;
        }
        if holds(middle) {
            good = middle
        } else {
            bad = middle
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_of_two_is_found_to_its_last_digit_from_either_side() {
        let root = 2.0_f64.sqrt();
        let below = bisect(0.0, 2.0, |x| x * x <= 2.0);
        let above = bisect(2.0, 0.0, |x| x * x > 2.0);
        assert!(below <= root && root - below <= f64::EPSILON * 2.0);
        assert!(above >= below && above - below <= f64::EPSILON * 2.0);
    }

    #[test]
    fn what_never_ceases_holds_up_to_the_end() {
        assert!((bisect(1.0, 3.0, |_| true) - 3.0).abs() < 1e-15);
        assert_eq!(bisect(1.0, 3.0, |_| false), 1.0);
    }
}
