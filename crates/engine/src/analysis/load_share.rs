//! The share of the load that each pair of teeth carries.

/// The share of the load that the tooth pairs at one offset carry, position by position.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadShare {
    /// n − floor(η) of the pair that passes the pitch point at mesh position n.
    pub pair_offset: i32,
    /// w·p/F of that pair.
    pub share: Vec<f64>,
}
