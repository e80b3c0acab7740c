//! A cache of the compliances of sets of cells and of their factors: equal for all pairs made to one drawing.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use faer::Mat;

use super::factor::{Core, Factor, core_of};
use super::memo::Memo;
use super::pair_cells::CellsSpec;
use crate::fem::dense::entries;

/// Limit of compliances in bytes: two hundred of eighty cells.
const MOST_BYTES: usize = 10 << 20;

/// Limit of cores in bytes: two thousand of forty touching cells.
const MOST_CORE_BYTES: usize = 36 << 20;

/// Specification of the compliance of a model's cells.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct ComplianceKey {
    /// The pairs, numbered from the reference pair of the mesh period, and their cells.
    pub(super) pairs: Vec<(i64, CellsSpec)>,
    /// How the blanks stand under their teeth.
    pub(super) teeth_like: [usize; 2],
}

/// The compliances of one model and the factors of cores; shared between threads.
#[derive(Debug)]
pub struct Compliances {
    assembled: Memo<ComplianceKey, CachedCompliance>,
    cores: Arc<Cores>,
    count: AtomicU64,
}

/// Factors of cores by the number of the compliance, and the blocks.
type Cores = Memo<(u64, Vec<usize>), Option<Core>>;

/// A compliance whose factors are kept.
#[derive(Debug, Clone)]
pub(super) struct CachedCompliance {
    pub(super) compliance: Arc<Mat<f64>>,
    number: u64,
    cores: Arc<Cores>,
}

fn bytes_of_core(core: &Option<Core>) -> usize {
    size_of::<Core>() + core.as_ref().map_or(0, Core::bytes)
}

impl Default for Compliances {
    fn default() -> Self {
        Self {
            assembled: Memo::new(MOST_BYTES, |known| {
                size_of::<CachedCompliance>() + size_of::<f64>() * entries(&known.compliance)
            }),
            cores: Arc::new(Memo::new(MOST_CORE_BYTES, bytes_of_core)),
            count: AtomicU64::new(0),
        }
    }
}

impl Compliances {
    /// About how much memory is used, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.assembled.bytes() + self.cores.bytes()
    }

    /// The compliance of `cells`, made if it is not there.
    pub(super) fn get(
        &self,
        cells: ComplianceKey,
        make: impl FnOnce() -> Mat<f64>,
    ) -> CachedCompliance {
        let cached = self.assembled.get(cells, |_| CachedCompliance {
            compliance: Arc::new(make()),
            number: self.count.fetch_add(1, Ordering::Relaxed),
            cores: Arc::clone(&self.cores),
        });
        CachedCompliance::clone(&cached)
    }
}

impl CachedCompliance {
    /// A `compliance` by itself, whose cores take so many bytes at most.
    pub(super) fn alone(compliance: Mat<f64>, most_bytes: usize) -> Self {
        Self {
            compliance: Arc::new(compliance),
            number: 0,
            cores: Arc::new(Memo::new(most_bytes, bytes_of_core)),
        }
    }

    /// About how much memory is used, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of::<f64>() * entries(&self.compliance) + self.cores.bytes()
    }

    /// The factor of its part at the rising points of `set`; `None` where that is not positive definite.
    pub(super) fn factor(&self, set: &[usize]) -> Option<Factor> {
        let blocks = core_of(set);
        let core = self.cores.get((self.number, blocks), |(_, blocks)| {
            Core::new(&self.compliance, blocks)
        });
        Factor::new(&self.compliance, set, core)
    }
}
