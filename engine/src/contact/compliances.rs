//! Compliances of cells that were stated before, and their factors, kept: pairs made to one drawing have them alike.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use faer::Mat;

use super::factor::Factor;
use super::memo::Memo;
use super::patch::Extent;
use crate::fem::dense::entries;

/// What compliances may take, in bytes: two hundred of eighty cells.
const MOST_BYTES: usize = 10 << 20;

/// What factors may take, in bytes: some thousand of forty touching cells.
const MOST_FACTOR_BYTES: usize = 24 << 20;

/// What the compliance of the cells of a model depends on.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct StatedCells {
    /// The bits of the load.
    pub(super) load: u64,
    /// The pairs from the reference pair of the mesh period, the bits of the phase at which each is laid, and how far.
    pub(super) pairs: Vec<(i64, u64, Extent)>,
    /// How the blanks stand under their teeth.
    pub(super) teeth_like: [usize; 2],
}

/// The compliances and factors of one model; shared between threads.
#[derive(Debug)]
pub struct Compliances {
    stated: Memo<StatedCells, Numbered>,
    factors: Arc<Factors>,
    count: AtomicU64,
}

/// Factors of compliances by the number of the compliance and the set that touches, bit by bit.
pub(super) type Factors = Memo<(u64, Vec<u64>), Option<Factor>>;

#[derive(Debug)]
struct Numbered {
    number: u64,
    compliance: Arc<Mat<f64>>,
}

/// A compliance whose factors are kept.
#[derive(Debug, Clone)]
pub(super) struct Known {
    pub(super) compliance: Arc<Mat<f64>>,
    number: u64,
    factors: Arc<Factors>,
}

impl Default for Compliances {
    fn default() -> Self {
        Self {
            stated: Memo::new(MOST_BYTES, |known| {
                size_of::<Numbered>() + size_of::<f64>() * entries(&known.compliance)
            }),
            factors: Arc::new(Memo::new(MOST_FACTOR_BYTES, |factor| {
                size_of::<Factor>() + factor.as_ref().map_or(0, Factor::bytes)
            })),
            count: AtomicU64::new(0),
        }
    }
}

impl Compliances {
    /// About how much memory is used, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.stated.bytes() + self.factors.bytes()
    }

    /// The compliance of `cells`, made if it is not there.
    pub(super) fn get(&self, cells: StatedCells, make: impl FnOnce() -> Mat<f64>) -> Known {
        let numbered = self.stated.get(cells, || Numbered {
            number: self.count.fetch_add(1, Ordering::Relaxed),
            compliance: Arc::new(make()),
        });
        Known {
            compliance: Arc::clone(&numbered.compliance),
            number: numbered.number,
            factors: Arc::clone(&self.factors),
        }
    }
}

impl Known {
    /// The factor of what of it belongs to the rising points of `set`; `None` where that is not positive definite.
    pub(super) fn factor(&self, set: &[usize]) -> Arc<Option<Factor>> {
        let mut bits = vec![0; self.compliance.nrows().div_ceil(64)];
        for point in set {
            bits[point / 64] |= 1 << (point % 64);
        }
        self.factors
            .get((self.number, bits), || Factor::new(&self.compliance, set))
    }
}
