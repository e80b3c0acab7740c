//! Definition of a time: the least of a few runs.

use std::time::Instant;

use anyhow::Context;
use meshwright_engine::analysis::{Analysis, Case, analyze};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

use crate::reproduce::computed::method_name;

/// Runs of one piece of work, at most.
pub(super) const RUNS: u32 = 3;

/// Work that has taken this many seconds is not run again.
pub(super) const PATIENCE: f64 = 1.5;

/// The least time in seconds of `work`, and its result: of [`RUNS`] runs, or as many as begin within [`PATIENCE`].
///
/// Other work on the machine only ever adds time, so that the least is nearest to the time of the work by itself. `prepare` is not timed.
///
/// # Errors
///
/// Errors of `prepare` or `work`.
pub(super) fn least<I, T>(
    mut prepare: impl FnMut() -> anyhow::Result<I>,
    mut work: impl FnMut(I) -> anyhow::Result<T>,
) -> anyhow::Result<(f64, T)> {
    let mut run = || {
        let input = prepare()?;
        let started = Instant::now();
        let output = work(input)?;
        Ok::<_, anyhow::Error>((started.elapsed().as_secs_f64(), output))
    };
    let mut best = run()?;
    let mut spent = best.0;
    for _ in 1..RUNS {
        if spent > PATIENCE {
            break;
        }
        let next = run()?;
        spent += next.0;
        if next.0 < best.0 {
            best = next;
        }
    }
    Ok(best)
}

/// The least time of `case` in seconds, with nothing computed before.
///
/// # Errors
///
/// If it cannot be computed.
pub(super) fn cold(case: &Case) -> anyhow::Result<f64> {
    Ok(least(|| Ok(()), |()| answer(case, &Library::default()))?.0)
}

/// The answer to `case`.
///
/// # Errors
///
/// If it cannot be computed.
pub(super) fn answer(case: &Case, library: &Library) -> anyhow::Result<Analysis> {
    analyze(case, library, &Run::unattended())
        .with_context(|| format!("the {} method failed", method_name(case.method())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quick_work_is_run_a_few_times_each_with_its_own_preparation() {
        let (mut prepared, mut runs) = (0, 0);
        let prepare = || {
            prepared += 1;
            Ok(prepared)
        };
        let (seconds, given) = least(prepare, |input| {
            runs += 1;
            Ok(input)
        })
        .expect("nothing fails");
        assert!(seconds >= 0.0 && (1..=3).contains(&given));
        assert_eq!((prepared, runs), (3, 3));
    }
}
