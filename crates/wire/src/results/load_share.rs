//! Shares of the load that pairs of teeth carry.

use meshwright_engine::analysis::curve::LoadShare;

use crate::declare::document;

document! {
    /// The share of the load that the pairs at one offset carry.
    pub struct LoadShareDocument as LoadShare, "Load share" answer of (share: &LoadShare) {
        /// 0 for the pair that passed the pitch point last, 1 for the next, -1 for the one before.
        pair_offset: i32 = share.pair_offset,
        /// Its share of the load, from 0 to 1.
        share: Vec<f64> = share.share.clone(),
    }
}
