//! What two flanks as drawn have of contact, whatever carries the teeth and however each of them deviates.
//!
//! Cells, the compliance of the teeth alone and the places where penetration is looked for hang on the flanks, the load and the fraction
//! of the mesh period. Models of one pair on other blanks, or with other deviations, share them.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::facing::Facing;
use super::model::PairModel;
use super::pair_cells::PairCells;
use super::penetration::Stretches;

/// What the stages of one pair may take, in bytes: two loads at forty positions a mesh period.
const MOST_BYTES: usize = 16 << 20;

/// By how much patches are widened at a time where the contact does not fit inside them.
const WIDENING: f64 = 1.5;

/// The steps in which the reach of a look grows: looks are the same whoever asks for them first.
const REACH_STEP: f64 = 1.5;

/// No look reaches less far beyond the least gap, in meters.
const LEAST_REACH: f64 = 1e-9;

/// The flanks of one pair as drawn, with what was found of them; shared between threads.
///
/// It changes no digit: what is found hangs on nothing but what it is asked for by.
#[derive(Debug, Default)]
pub struct DrawnFlanks(Mutex<VecDeque<Kept>>);

#[derive(Debug)]
struct Kept {
    /// The fraction of the mesh period and the load, bit by bit, and the cells in a patch.
    key: (u64, u64, usize),
    stage: Arc<DrawnStage>,
}

/// What flanks as drawn have of contact at one fraction of the mesh period, under one load.
#[derive(Debug, Default)]
pub(super) struct DrawnStage {
    cells: Mutex<Vec<(Laid, Arc<PairCells>)>>,
    stretches: Mutex<Vec<(Laid, i32, Arc<Stretches>)>>,
    bytes: AtomicUsize,
}

/// How the cells of a pair are laid.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Laid {
    /// The pair, from the reference pair of the mesh period.
    pair: i64,
    /// How often its patch was widened.
    widened: i32,
}

impl DrawnFlanks {
    /// About how much memory they take, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + bytes(&locked(&self.0))
    }

    /// Those at `fraction` of the mesh period under `load`, with so many cells in a patch.
    pub(super) fn stage(
        &self,
        fraction: f64,
        load: f64,
        cells_per_patch: usize,
    ) -> Arc<DrawnStage> {
        let key = (fraction.to_bits(), load.to_bits(), cells_per_patch);
        let mut stages = locked(&self.0);
        if let Some(kept) = stages.iter().find(|kept| kept.key == key) {
            return Arc::clone(&kept.stage);
        }
        while bytes(&stages) > MOST_BYTES {
            stages.pop_front();
        }
        let stage = Arc::<DrawnStage>::default();
        stages.push_back(Kept {
            key,
            stage: Arc::clone(&stage),
        });
        stage
    }
}

fn bytes(stages: &VecDeque<Kept>) -> usize {
    let each = stages.iter().map(|kept| &kept.stage.bytes);
    each.map(|bytes| bytes.load(Ordering::Relaxed)).sum()
}

impl DrawnStage {
    /// The cells of `facing`, its patch widened so often; `None` where there is no room for any.
    pub(super) fn cells(
        &self,
        model: &PairModel,
        facing: &Facing<'_>,
        load: f64,
        widened: i32,
    ) -> Option<Arc<PairCells>> {
        let laid = Laid {
            pair: facing.pair,
            widened,
        };
        let known = locked(&self.cells)
            .iter()
            .find(|known| known.0 == laid)
            .cloned();
        if let Some((_, cells)) = known {
            return Some(cells);
        }
        // Two threads that want it at the same moment both make it, and get the same bits.
        let cells = Arc::new(PairCells::new(model, facing, load, WIDENING.powi(widened))?);
        self.bytes.fetch_add(cells.bytes(), Ordering::Relaxed);
        locked(&self.cells).push((laid, Arc::clone(&cells)));
        Some(cells)
    }

    /// The stretches on the flanks of `facing` whose gap is within `reach`, and some beyond, with `cells` laid there by a patch
    /// `widened` so often; `least` is the least gap of all pairs.
    pub(super) fn stretches(
        &self,
        model: &PairModel,
        facing: &Facing<'_>,
        (cells, widened): (&PairCells, i32),
        (least, reach): (f64, f64),
    ) -> Arc<Stretches> {
        let laid = Laid {
            pair: facing.pair,
            widened,
        };
        let steps = ((reach - least).max(LEAST_REACH).ln() / REACH_STEP.ln()).ceil() as i32;
        let known = locked(&self.stretches)
            .iter()
            .find(|known| (known.0, known.1) == (laid, steps))
            .map(|known| Arc::clone(&known.2));
        known.unwrap_or_else(|| {
            let reach = least + REACH_STEP.powi(steps);
            let stretches = Arc::new(Stretches::new(model, cells, facing, reach));
            self.bytes.fetch_add(stretches.bytes(), Ordering::Relaxed);
            locked(&self.stretches).push((laid, steps, Arc::clone(&stretches)));
            stretches
        })
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // Only finished parts are in it, so that a panic elsewhere leaves nothing half done.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_beyond_the_bound_go_the_oldest_first() {
        let flanks = DrawnFlanks::default();
        let stage = |fraction: f64| flanks.stage(fraction, 100.0, 40);
        let first = stage(0.0);
        first.bytes.store(MOST_BYTES / 2, Ordering::Relaxed);
        stage(0.25).bytes.store(MOST_BYTES / 2, Ordering::Relaxed);
        assert!(Arc::ptr_eq(&first, &stage(0.0)), "there is room for both");
        stage(0.5).bytes.store(1, Ordering::Relaxed);
        let _ = stage(0.75);
        assert!(flanks.bytes() <= size_of::<DrawnFlanks>() + MOST_BYTES);
        assert!(!Arc::ptr_eq(&first, &stage(0.0)), "the oldest had to go");
        assert_eq!(stage(0.5).bytes.load(Ordering::Relaxed), 1);
    }

    #[test]
    fn other_loads_and_finer_cells_are_other_stages() {
        let flanks = DrawnFlanks::default();
        let one = flanks.stage(0.5, 100.0, 40);
        for other in [flanks.stage(0.5, 100.5, 40), flanks.stage(0.5, 100.0, 80)] {
            assert!(!Arc::ptr_eq(&one, &other));
        }
    }
}
