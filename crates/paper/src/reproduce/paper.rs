//! Values printed in the paper, to stand beside the computed ones (Benaicha et al. 2021, hal-03230238).

/// STE mean, rms and peak-to-peak in um, then stiffness mean, rms and peak-to-peak in N/m.
pub(super) type Row = [f64; 6];

/// One block of Table 2.
pub(super) struct PrintedCase {
    /// The flexible method.
    pub(super) flexible: Row,
    /// The decomposition.
    pub(super) decomposition: Row,
    /// The errors in %, as printed, without sign.
    pub(super) errors: Row,
    /// Divisor of the stiffness: where the paper takes the load as T/R_b1, the tooth ratio.
    pub(super) stiffness_divisor: f64,
    /// Hours for the flexible method (section 4.2).
    pub(super) flexible_hours: u32,
    /// Minutes for the decomposition.
    pub(super) decomposition_minutes: u32,
}

impl PrintedCase {
    /// The value of `row` in column `i` under our definition of the load.
    pub(super) fn value(&self, row: &Row, i: usize) -> f64 {
        if i < 3 {
            row[i]
        } else {
            row[i] / self.stiffness_divisor
        }
    }
}

/// Table 2, with the STE rms of case 3 as 0.468 where 10.468 is printed, and with the times of section 4.2.
pub(super) const TABLE_2: [PrintedCase; 3] = [
    PrintedCase {
        flexible: [24.587, 0.572, 2.408, 1.088e8, 6.358e6, 2.101e7],
        decomposition: [24.534, 0.523, 2.216, 1.103e8, 6.356e6, 1.984e7],
        errors: [0.2, 8.5, 8.0, 1.4, 0.03, 5.5],
        stiffness_divisor: 1.0,
        flexible_hours: 15,
        decomposition_minutes: 30,
    },
    PrintedCase {
        flexible: [13.651, 0.418, 1.843, 2.130e8, 2.210e7, 6.367e7],
        decomposition: [13.587, 0.365, 1.688, 2.239e8, 2.263e7, 6.394e7],
        errors: [0.5, 12.0, 8.4, 5.0, 2.4, 0.4],
        stiffness_divisor: 1.0,
        flexible_hours: 15,
        decomposition_minutes: 30,
    },
    PrintedCase {
        flexible: [15.103, 0.468, 2.222, 4.347e8, 3.456e7, 1.017e8],
        decomposition: [15.093, 0.466, 2.129, 4.325e8, 4.345e7, 1.018e8],
        errors: [0.1, 0.4, 4.4, 0.5, 1.5, 0.1],
        stiffness_divisor: 85.0 / 29.0,
        flexible_hours: 40,
        decomposition_minutes: 40,
    },
];

/// The torques in N m for which section 4 says that the relief minimizes the fluctuation: 50/50 and 29/85 teeth.
pub(super) const OPTIMAL_TORQUES: [f64; 2] = [115.0, 160.0];

/// The peak-to-peak STE in um that section 5 gives the standard pair at 20 and 115 N m.
pub(super) const STANDARD_PEAK_TO_PEAK: [f64; 2] = [2.0, 1.0];

/// The base radii in mm that Table 1 prints, driving then driven.
pub(super) const BASE_RADII: [[f64; 2]; 3] = [[46.984, 46.984], [46.984, 46.984], [27.251, 79.874]];

/// The center distances in mm that Table 1 prints.
pub(super) const CENTER_DISTANCES: [f64; 3] = [100.5, 100.5, 118.5];
