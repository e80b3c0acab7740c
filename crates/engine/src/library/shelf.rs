//! A bounded store that evicts the part that was unused for longest.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Parts beside the specs that say all of them, shared between threads; their sizes together stay within a bound.
///
/// Specs are compared by `==`, one after the other: there are some hundred of them, and a part takes a million times longer.
#[derive(Debug)]
pub(super) struct Shelf<S, P> {
    stock: Mutex<Stock<S, P>>,
    capacity: usize,
    /// The size of a part and its spec.
    bytes: fn(&S, &P) -> usize,
}

#[derive(Debug)]
struct Stock<S, P> {
    /// Entries by the time of their last use, the oldest first.
    entries: Vec<Entry<S, P>>,
    /// Gates of the parts that are being made: the thread that makes one holds its gate.
    making: Vec<(S, Arc<Mutex<()>>)>,
    bytes: usize,
    hits: u64,
    misses: u64,
    evictions: u64,
}

#[derive(Debug)]
struct Entry<S, P> {
    spec: S,
    part: Arc<P>,
    bytes: usize,
}

/// Use of a shelf.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShelfUsage {
    /// Size of its parts in bytes.
    pub bytes: usize,
    /// Limit of their size in bytes.
    pub capacity: usize,
    /// Parts that it holds.
    pub entries: usize,
    /// Times that a part was asked for and there, since the start.
    pub hits: u64,
    /// Times that a part was asked for and had to be computed, since the start.
    pub misses: u64,
    /// Parts that found no room or had to make room, since the start.
    pub evictions: u64,
}

impl<S: PartialEq + Clone, P> Shelf<S, P> {
    /// A shelf for `capacity` bytes of parts whose sizes `bytes` tells.
    pub(super) fn new(capacity: usize, bytes: fn(&S, &P) -> usize) -> Self {
        let stock = Stock {
            entries: Vec::new(),
            making: Vec::new(),
            bytes: 0,
            hits: 0,
            misses: 0,
            evictions: 0,
        };
        Self {
            stock: Mutex::new(stock),
            capacity,
            bytes,
        }
    }

    /// The part of `spec` if it is there. If it is not, who asked is to make it and to [`Shelf::keep`] it.
    pub(super) fn find(&self, spec: &S) -> Option<Arc<P>> {
        let mut stock = self.stock();
        let found = stock.find(spec);
        stock.misses += u64::from(found.is_none());
        found
    }

    /// Keeps the `part` of `spec`, if it fits, and lets others go for it.
    pub(super) fn keep(&self, spec: &S, part: &Arc<P>) {
        let bytes = (self.bytes)(spec, part);
        self.stock().keep(
            Entry {
                spec: spec.clone(),
                part: part.clone(),
                bytes,
            },
            self.capacity,
        );
    }

    /// The same where parts grow as they are used: all of them are weighed anew, those too that nobody asks for again.
    pub(super) fn keep_growing(&self, spec: &S, part: &Arc<P>) {
        self.stock().weigh(self.bytes);
        self.keep(spec, part);
    }

    /// The part of `spec`, made if it is not there; of two threads that want it at the same moment one makes it and the
    /// other waits. `make` must not itself wait for other threads, or they might wait for each other.
    pub(super) fn made_once<E>(
        &self,
        spec: &S,
        make: impl FnOnce() -> Result<P, E>,
    ) -> Result<Arc<P>, E> {
        let gate = {
            let mut stock = self.stock();
            if let Some(part) = stock.find(spec) {
                return Ok(part);
            }
            stock.gate(spec)
        };
        let _turn = gate.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(part) = self.find(spec) {
            return Ok(part);
        }
        let made = make().map(Arc::new);
        if let Ok(part) = &made {
            self.keep(spec, part);
        }
        self.stock().making.retain(|(making, _)| making != spec);
        made
    }

    /// The part of `spec`, made if it is not there; two threads that want it at the same moment both make it, and get the same bits.
    pub(super) fn made<E>(
        &self,
        spec: &S,
        make: impl FnOnce() -> Result<P, E>,
    ) -> Result<Arc<P>, E> {
        if let Some(known) = self.find(spec) {
            return Ok(known);
        }
        let made = make().map(Arc::new)?;
        self.keep(spec, &made);
        Ok(made)
    }

    /// Its use.
    pub(super) fn usage(&self) -> ShelfUsage {
        let stock = self.stock();
        ShelfUsage {
            bytes: stock.bytes,
            capacity: self.capacity,
            entries: stock.entries.len(),
            hits: stock.hits,
            misses: stock.misses,
            evictions: stock.evictions,
        }
    }

    fn stock(&self) -> MutexGuard<'_, Stock<S, P>> {
        // The stock holds only finished parts, so that a panic elsewhere leaves nothing half done in it.
        self.stock.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<S: PartialEq + Clone, P> Stock<S, P> {
    fn find(&mut self, spec: &S) -> Option<Arc<P>> {
        let place = self.entries.iter().position(|entry| entry.spec == *spec)?;
        self.hits += 1;
        self.entries[place..].rotate_left(1);
        self.entries.last().map(|entry| entry.part.clone())
    }

    fn keep(&mut self, entry: Entry<S, P>, capacity: usize) {
        if let Some(place) = self.entries.iter().position(|old| old.spec == entry.spec) {
            self.bytes -= self.entries.remove(place).bytes;
        }
        if entry.bytes > capacity {
            // All others would have to go, and then it would go itself.
            self.evictions += 1;
        } else {
            self.bytes += entry.bytes;
            self.entries.push(entry);
        }
        while self.bytes > capacity {
            self.bytes -= self.entries.remove(0).bytes;
            self.evictions += 1;
        }
    }

    fn weigh(&mut self, bytes: fn(&S, &P) -> usize) {
        for entry in &mut self.entries {
            entry.bytes = bytes(&entry.spec, &entry.part);
        }
        self.bytes = self.entries.iter().map(|entry| entry.bytes).sum();
    }

    /// The gate of whoever makes the part of `spec`.
    fn gate(&mut self, spec: &S) -> Arc<Mutex<()>> {
        if let Some((_, gate)) = self.making.iter().find(|(making, _)| making == spec) {
            return gate.clone();
        }
        let gate = Arc::default();
        self.making.push((spec.clone(), Arc::clone(&gate)));
        gate
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Barrier;
    use std::sync::atomic::AtomicUsize;
    use std::sync::atomic::Ordering::Relaxed;
    use std::thread;

    use super::*;

    /// A shelf whose parts are numbers and take as many bytes.
    fn shelf(capacity: usize) -> Shelf<u32, u32> {
        Shelf::new(capacity, |_, part| *part as usize)
    }

    /// True if the part of `spec`, `size` bytes large, had to be made.
    fn made(shelf: &Shelf<u32, u32>, spec: u32, size: u32) -> bool {
        let mut made = false;
        let make = || {
            made = true;
            Ok::<_, ()>(size)
        };
        assert_eq!(shelf.made_once(&spec, make).as_deref(), Ok(&size));
        made
    }

    /// True if the part of `spec`, 10 bytes large, had to be made.
    fn built(shelf: &Shelf<u32, u32>, spec: u32) -> bool {
        made(shelf, spec, 10)
    }

    #[test]
    fn what_was_not_used_for_longest_goes_first() {
        let shelf = shelf(20);
        assert!(built(&shelf, 1) && built(&shelf, 2) && !built(&shelf, 1));
        assert!(built(&shelf, 3), "the third makes the shelf too full");
        assert!(!built(&shelf, 1) && built(&shelf, 2), "2 had to go");
    }

    #[test]
    fn a_part_that_is_too_large_is_given_but_not_kept_and_drives_no_other_out() {
        let shelf = shelf(15);
        assert!(built(&shelf, 1));
        for _ in 0..2 {
            assert!(made(&shelf, 2, 16));
        }
        assert!(!built(&shelf, 1));
    }

    #[test]
    fn it_tells_how_it_is_used() {
        let shelf = shelf(20);
        for key in [1, 2, 1, 3] {
            built(&shelf, key);
        }
        let usage = ShelfUsage {
            bytes: 20,
            capacity: 20,
            entries: 2,
            hits: 1,
            misses: 3,
            evictions: 1,
        };
        assert_eq!(shelf.usage(), usage);
    }

    #[test]
    fn what_is_made_twice_at_once_is_kept_once() {
        let shelf = shelf(20);
        assert!(shelf.find(&1).is_none() && shelf.find(&1).is_none());
        for _ in 0..2 {
            shelf.keep(&1, &Arc::new(10));
        }
        assert_eq!(shelf.find(&1).as_deref(), Some(&10));
        let usage = shelf.usage();
        assert_eq!((usage.entries, usage.bytes, usage.misses), (1, 10, 2));
    }

    #[test]
    fn parts_that_have_grown_are_weighed_though_nobody_asked_for_them_again() {
        let shelf: Shelf<u32, AtomicUsize> = Shelf::new(20, |_, part| part.load(Relaxed));
        for key in 1..=3 {
            let part = Arc::new(AtomicUsize::new(0));
            shelf.keep_growing(&key, &part);
            part.store(15, Relaxed);
        }
        assert!(
            shelf.find(&1).is_none(),
            "30 bytes were there when the third came"
        );
        assert!(shelf.find(&2).is_some() && shelf.find(&3).is_some());
        assert_eq!(shelf.usage().evictions, 1);
    }

    #[test]
    fn a_failure_is_not_kept() {
        let shelf = shelf(100);
        assert_eq!(shelf.made_once(&1, || Err("no")), Err("no"));
        assert!(built(&shelf, 1));
    }

    /// Result of the second of two requests for the same part: it comes while the first makes it, to `made`, and would itself make `own`.
    fn second_of_two(
        shelf: &Shelf<u32, u32>,
        made: Result<u32, ()>,
        own: Result<u32, ()>,
    ) -> Result<u32, ()> {
        let begun = Barrier::new(2);
        thread::scope(|scope| {
            scope.spawn(|| {
                let build = || {
                    begun.wait();
                    made
                };
                shelf.made_once(&1, build)
            });
            begun.wait();
            shelf.made_once(&1, || own).map(|part| *part)
        })
    }

    #[test]
    fn of_two_who_want_the_same_part_one_makes_it() {
        let shelf = shelf(20);
        assert_eq!(
            second_of_two(&shelf, Ok(1), Err(())),
            Ok(1),
            "the first made it"
        );
        assert_eq!((shelf.usage().misses, shelf.usage().hits), (1, 1));
    }

    #[test]
    fn who_waited_for_a_failure_makes_the_part() {
        assert_eq!(second_of_two(&shelf(20), Err(()), Ok(2)), Ok(2));
    }
}
