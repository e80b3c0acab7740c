//! Where a condition ceases to hold.

/// Halvings that bring any interval met here down to neighboring numbers.
const MOST_HALVINGS: u32 = 200;

/// The last place, going from `good` towards `bad`, at which `holds` still holds, to the last digit.
///
/// `holds` is taken to hold at `good` and to fail at `bad`; neither is asked. Where it changes several times, one of the
/// changes is found. `bad` may lie below `good`.
pub fn bisect(mut good: f64, mut bad: f64, mut holds: impl FnMut(f64) -> bool) -> f64 {
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
    fn a_condition_that_never_or_always_holds_leads_to_an_end() {
        assert_eq!(bisect(1.0, 3.0, |_| false), 1.0);
        assert_eq!(bisect(1.0, 3.0, |_| true), 3.0_f64.next_down());
    }
}
