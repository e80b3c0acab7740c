//! Points of a curve between its positions.

/// Mesh positions no farther apart than this are one.
pub const SAME_POSITION: f64 = 1e-9;

/// Sides of a mesh position at which a pair takes up or leaves the load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventSide {
    /// Just before it.
    Before,
    /// Just behind it.
    Behind,
}

/// A point of a curve between its positions, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// The mesh position η.
    pub mesh_position: f64,
    /// δ.
    pub transmission_error: f64,
    /// k.
    pub mesh_stiffness_tangent: f64,
    /// The side that it is of, at an event.
    pub event: Option<EventSide>,
}
