//! Progress of a command on a terminal.

use std::io::{IsTerminal as _, Write as _, stderr};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Time between two lines.
const BETWEEN: Duration = Duration::from_millis(100);

/// The beginning of a line of a terminal, which is empty then.
const EMPTY_LINE: &str = "\r\x1b[K";

/// A line on standard error that says how far a command is, where that is a terminal. It is gone when this is dropped.
pub(super) struct Progress {
    noun: &'static str,
    begun: Instant,
    /// The time of the last line; `None` where there is no terminal.
    shown: Option<Mutex<Instant>>,
}

impl Progress {
    /// Progress counted in `noun`.
    pub(super) fn of(noun: &'static str) -> Self {
        let begun = Instant::now();
        Self {
            noun,
            begun,
            shown: stderr().is_terminal().then(|| Mutex::new(begun)),
        }
    }

    /// Shows how many are done, and `more`, unless that was shown just now.
    pub(super) fn tell(&self, done: u64, total: u64, more: &str) {
        // Where another thread shows something, this is as good.
        let Some(mut shown) = self.shown.as_ref().and_then(|shown| shown.try_lock().ok()) else {
            return;
        };
        if shown.elapsed() < BETWEEN {
            return;
        }
        *shown = Instant::now();
        let line = line((done, total), self.noun, self.begun.elapsed(), more);
        // A terminal that has gone is no fault of the computation.
        let _ = write!(stderr(), "{EMPTY_LINE}{line}");
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.shown.is_some() {
            let _ = write!(stderr(), "{EMPTY_LINE}");
        }
    }
}

fn line((done, total): (u64, u64), noun: &str, elapsed: Duration, more: &str) -> String {
    let elapsed = elapsed.as_secs_f64();
    let mut line = format!("{done}/{total} {noun}, {elapsed:.0} s");
    if done > 0 {
        let left = elapsed * total.saturating_sub(done) as f64 / done as f64;
        line += &format!(", about {left:.0} s to go");
    }
    if !more.is_empty() {
        line += &format!("  {more}");
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_takes_as_long_for_each_as_what_is_done() {
        let after = |done| line((done, 40), "designs", Duration::from_secs(30), "");
        assert_eq!(after(0), "0/40 designs, 30 s");
        assert_eq!(after(10), "10/40 designs, 30 s, about 90 s to go");
        assert_eq!(after(40), "40/40 designs, 30 s, about 0 s to go");
    }
}
