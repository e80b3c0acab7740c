//! A bounded store that forgets what was not used for longest.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Parts by key, shared between threads; their sizes together stay within a bound.
#[derive(Debug)]
pub(super) struct Shelf<K, T> {
    books: Mutex<Books<K, T>>,
    capacity: usize,
}

#[derive(Debug)]
struct Books<K, T> {
    /// Each part with its size and when it was last used.
    parts: HashMap<K, (Arc<T>, usize, u64)>,
    /// Who makes one of these parts holds its gate.
    making: HashMap<K, Arc<Mutex<()>>>,
    bytes: usize,
    clock: u64,
    hits: u64,
    misses: u64,
    evictions: u64,
}

/// How a shelf is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShelfUsage {
    /// What its parts take, in bytes.
    pub bytes: usize,
    /// What they may take, in bytes.
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

impl<K: Eq + Hash + Clone, T> Shelf<K, T> {
    /// A shelf for `capacity` bytes.
    pub(super) fn new(capacity: usize) -> Self {
        let books = Books {
            parts: HashMap::new(),
            making: HashMap::new(),
            bytes: 0,
            clock: 0,
            hits: 0,
            misses: 0,
            evictions: 0,
        };
        Self {
            books: Mutex::new(books),
            capacity,
        }
    }

    /// The part of `key`, built if it is not there; `bytes` tells the size of a new one.
    ///
    /// Two threads that want the same new part at the same moment both build it, and get the same bits.
    pub(super) fn part<E>(
        &self,
        key: K,
        bytes: impl FnOnce(&T) -> usize,
        build: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, E> {
        if let Some(part) = self.books().find(&key) {
            return Ok(part);
        }
        self.made(key, bytes, build)
    }

    /// As [`Shelf::part`], but of two threads that want the same new part at the same moment one builds it and the other
    /// waits. `build` must not itself wait for other threads, or they might wait for each other.
    pub(super) fn part_made_once<E>(
        &self,
        key: K,
        bytes: impl FnOnce(&T) -> usize,
        build: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, E> {
        let gate = {
            let mut books = self.books();
            if let Some(part) = books.find(&key) {
                return Ok(part);
            }
            books.making.entry(key.clone()).or_default().clone()
        };
        let _turn = gate.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(part) = self.books().find(&key) {
            return Ok(part);
        }
        let made = self.made(key.clone(), bytes, build);
        self.books().making.remove(&key);
        made
    }

    /// Whether the part of `key` is there.
    pub(super) fn holds(&self, key: &K) -> bool {
        self.books().parts.contains_key(key)
    }

    fn made<E>(
        &self,
        key: K,
        bytes: impl FnOnce(&T) -> usize,
        build: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, E> {
        self.books().misses += 1;
        let part = Arc::new(build()?);
        let size = bytes(&part);
        self.books().keep(key, part.clone(), size, self.capacity);
        Ok(part)
    }

    /// How it is used.
    pub(super) fn usage(&self) -> ShelfUsage {
        let books = self.books();
        ShelfUsage {
            bytes: books.bytes,
            capacity: self.capacity,
            entries: books.parts.len(),
            hits: books.hits,
            misses: books.misses,
            evictions: books.evictions,
        }
    }

    fn books(&self) -> MutexGuard<'_, Books<K, T>> {
        // The books hold only finished parts, so that a panic elsewhere leaves nothing half done in them.
        self.books.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<K: Eq + Hash + Clone, T> Books<K, T> {
    fn find(&mut self, key: &K) -> Option<Arc<T>> {
        self.clock += 1;
        let (part, _, used) = self.parts.get_mut(key)?;
        self.hits += 1;
        *used = self.clock;
        Some(part.clone())
    }

    fn keep(&mut self, key: K, part: Arc<T>, size: usize, capacity: usize) {
        if size > capacity {
            // All others would have to go, and then it would go itself.
            self.evictions += 1;
            return;
        }
        self.clock += 1;
        self.bytes += size;
        if let Some((_, size, _)) = self.parts.insert(key, (part, size, self.clock)) {
            self.bytes -= size;
        }
        while self.bytes > capacity {
            let oldest = self.parts.iter().min_by_key(|(_, (_, _, used))| *used);
            let Some(key) = oldest.map(|(key, _)| key.clone()) else {
                break;
            };
            if let Some((_, size, _)) = self.parts.remove(&key) {
                self.bytes -= size;
                self.evictions += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Barrier;
    use std::thread;

    use super::*;

    fn built(shelf: &Shelf<u32, u32>, key: u32) -> bool {
        let mut built = false;
        let build = || {
            built = true;
            Ok::<_, ()>(key)
        };
        assert_eq!(shelf.part(key, |_| 10, build).as_deref(), Ok(&key));
        built
    }

    #[test]
    fn what_was_not_used_for_longest_goes_first() {
        let shelf = Shelf::new(20);
        assert!(built(&shelf, 1) && built(&shelf, 2) && !built(&shelf, 1));
        assert!(built(&shelf, 3), "the third makes the shelf too full");
        assert!(!built(&shelf, 1) && built(&shelf, 2), "2 had to go");
    }

    #[test]
    fn a_part_that_is_too_large_is_given_but_not_kept_and_drives_no_other_out() {
        let shelf = Shelf::new(15);
        assert!(built(&shelf, 1));
        for _ in 0..2 {
            assert_eq!(shelf.part(2, |_| 16, || Ok::<_, ()>(2)).as_deref(), Ok(&2));
        }
        assert!(!built(&shelf, 1));
    }

    #[test]
    fn it_tells_how_it_is_used() {
        let shelf = Shelf::new(20);
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
    fn a_failure_is_not_kept() {
        let shelf = Shelf::<u32, u32>::new(100);
        assert_eq!(shelf.part(1, |_| 10, || Err("no")), Err("no"));
        assert!(built(&shelf, 1));
    }

    /// What the second gets of two who want the same part: it comes while the first makes it, to `made`, and would itself
    /// make `own`.
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
                shelf.part_made_once(1, |_| 10, build)
            });
            begun.wait();
            shelf.part_made_once(1, |_| 10, || own).map(|part| *part)
        })
    }

    #[test]
    fn of_two_who_want_the_same_part_one_makes_it() {
        let shelf = Shelf::new(20);
        assert_eq!(
            second_of_two(&shelf, Ok(1), Err(())),
            Ok(1),
            "the first made it"
        );
        assert_eq!((shelf.usage().misses, shelf.usage().hits), (1, 1));
    }

    #[test]
    fn who_waited_for_a_failure_makes_the_part() {
        assert_eq!(second_of_two(&Shelf::new(20), Err(()), Ok(2)), Ok(2));
    }
}
