//! What is computed of a gear pair: the methods, from the classical one on.

pub mod load_distribution;
