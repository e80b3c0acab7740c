//! Order spectra: amplitudes per revolution of the driven gear.

/// A speed of rotation, in revolutions per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationSpeed(pub f64);

/// A line of the spectrum that has a name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedOrder {
    /// The order per revolution of the driven gear.
    pub order: f64,
    /// For example `H_Z2`, `H_N`, `H_(Z2+N2)`.
    pub label: String,
    /// The amplitude of δ in meters.
    pub transmission_error: f64,
    /// The amplitude of k in N/m.
    pub mesh_stiffness_tangent: f64,
}

/// Single-sided amplitudes and phases: y = Σ A cos(2π k j/n + phase), no window; the mean is left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Orders k Z2/P per revolution of the driven gear, k = 1 … n/2.
    pub order: Vec<f64>,
    /// Amplitudes of δ in meters.
    pub transmission_error: Vec<f64>,
    /// Phases of δ in radians.
    pub transmission_error_phase: Vec<f64>,
    /// Amplitudes of k in N/m.
    pub mesh_stiffness_tangent: Vec<f64>,
    /// Phases of k in radians.
    pub mesh_stiffness_tangent_phase: Vec<f64>,
    /// Lines with names, by rising order.
    pub named: Vec<NamedOrder>,
    /// The frequency of each order in Hz, with a speed given.
    pub frequency: Option<Vec<f64>>,
}
