//! A bounded store of parts by their specifications.

use std::collections::{HashMap, VecDeque};
use std::fmt;
use std::hash::Hash;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Parts by their specs, shared between threads; the oldest leave for new ones where their sizes together pass a bound.
///
/// A stored part changes no digit: it depends on nothing but its spec. Two threads that want one at the same moment both make it, and get the same bits.
pub(super) struct Memo<S, P> {
    kept: Mutex<Kept<S, P>>,
    capacity: usize,
    bytes_of: fn(&P) -> usize,
}

struct Kept<S, P> {
    parts: HashMap<S, Arc<P>>,
    /// The specs, the oldest first.
    order: VecDeque<S>,
    bytes: usize,
}

impl<S: Hash + Eq + Clone, P> Memo<S, P> {
    /// A store of at most `capacity` bytes of parts of the size `bytes_of`.
    pub(super) fn new(capacity: usize, bytes_of: fn(&P) -> usize) -> Self {
        let kept = Kept {
            parts: HashMap::new(),
            order: VecDeque::new(),
            bytes: 0,
        };
        Self {
            kept: Mutex::new(kept),
            capacity,
            bytes_of,
        }
    }

    /// The part of `spec`, made if it is not there.
    pub(super) fn get(&self, spec: S, make: impl FnOnce(&S) -> P) -> Arc<P> {
        if let Some(known) = self.kept().parts.get(&spec) {
            return Arc::clone(known);
        }
        let made = Arc::new(make(&spec));
        let mut kept = self.kept();
        if kept.parts.insert(spec.clone(), Arc::clone(&made)).is_none() {
            kept.order.push_back(spec);
            kept.bytes += (self.bytes_of)(&made);
        }
        while kept.bytes > self.capacity && kept.order.len() > 1 {
            let oldest = kept.order.pop_front();
            if let Some(part) = oldest.and_then(|spec| kept.parts.remove(&spec)) {
                kept.bytes -= (self.bytes_of)(&part);
            }
        }
        made
    }

    /// Size of its parts in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.kept().bytes
    }

    fn kept(&self) -> MutexGuard<'_, Kept<S, P>> {
        // Only finished parts are in it, so that a panic elsewhere leaves nothing half done.
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<S: Hash + Eq + Clone, P> fmt::Debug for Memo<S, P> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} bytes of {}", self.bytes(), self.capacity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_made_once_and_the_oldest_go_first_beyond_the_bound() {
        let memo = Memo::new(20, |part: &Vec<u8>| part.len());
        let made = |spec: u32, bytes: usize| memo.get(spec, |_| vec![0; bytes]);
        let first = made(1, 10);
        assert!(Arc::ptr_eq(&first, &made(1, 0)), "there is room for it");
        made(2, 10);
        assert_eq!(memo.bytes(), 20);
        made(3, 5);
        assert_eq!(memo.bytes(), 15, "the first had to go");
        assert!(!Arc::ptr_eq(&first, &made(1, 1)));
    }

    #[test]
    fn a_part_larger_than_all_room_is_kept_alone() {
        let memo = Memo::new(20, |part: &Vec<u8>| part.len());
        memo.get(1, |_| vec![0; 10]);
        memo.get(2, |_| vec![0; 30]);
        assert_eq!(memo.bytes(), 30);
        memo.get(3, |_| vec![0; 10]);
        assert_eq!(memo.bytes(), 10);
    }
}
