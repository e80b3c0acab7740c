//! Where modes meet the orders of the mesh as the gear turns, seen from the mesh, which stands still in space.
//!
//! A mode of n nodal diameters is two waves, one with the turn and one against it. In the frame of the gear they have the frequency f; in space f ± (n − c) Ω,
//! Ω the turns a second, where Coriolis forces reduce the nodal diameters by c. Mesh order k excites k z Ω, so that it is met at Ω = f/(k z ∓ (n − c)). A
//! translation of the rim (n = 1, c = 1) is met at f/(k z): it does not depend on the turn.

use super::{Direction, Mode};

/// A wave of a mode about the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wave {
    /// With the turn of the gear.
    Forward,
    /// Against it.
    Backward,
    /// Neither: no nodal diameters, or ones that stand in space.
    Standing,
}

/// A speed at which a mesh order meets a mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// The multiple k of the mesh order.
    pub multiple: u32,
    /// The wave that is met.
    pub wave: Wave,
    /// The turns of this gear a second.
    pub turns: f64,
}

/// The largest difference of n and c that counts as none.
const STANDING: f64 = 1e-3;

impl Mode {
    /// By how many hertz a turn a second parts the waves of the mode, seen in space: n − c.
    pub fn split(&self) -> f64 {
        let n = f64::from(self.nodal_diameters);
        match self.direction {
            Direction::Torsion => 0.0,
            Direction::InPlane => n - self.coriolis,
            Direction::OutOfPlane => n,
        }
    }

    /// The frequencies of its waves in hertz, in space, at a speed in turns a second.
    pub fn waves(&self, turns: f64) -> Vec<(Wave, f64)> {
        let split = self.split();
        if split.abs() < STANDING {
            return vec![(Wave::Standing, self.frequency)];
        }
        vec![
            (Wave::Forward, self.frequency + split * turns),
            (Wave::Backward, self.frequency - split * turns),
        ]
    }

    /// Where the mesh orders k z, k from 1 to `multiples`, of a gear with `tooth_count` teeth meet it.
    pub fn crossings(&self, tooth_count: u32, multiples: u32) -> Vec<Crossing> {
        let split = self.split();
        let of_multiple = |multiple: u32| {
            let order = f64::from(multiple) * f64::from(tooth_count);
            let waves: &[(Wave, f64)] = match split.abs() < STANDING {
                true => &[(Wave::Standing, 0.0)],
                false => &[(Wave::Backward, 1.0), (Wave::Forward, -1.0)],
            };
            let met = waves.iter().filter_map(move |(wave, sign)| {
                let by = order + sign * split;
                (by > 0.0).then_some(Crossing {
                    multiple,
                    wave: *wave,
                    turns: self.frequency / by,
                })
            });
            met.collect::<Vec<_>>()
        };
        (1..=multiples).flat_map(of_multiple).collect()
    }
}
