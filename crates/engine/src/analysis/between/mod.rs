//! A curve between its positions: kinks, extremes, and statistics over its span.
//!
//! δ and k are known at equal steps. Between them a pair takes up or leaves the load, contact reaches the start of a relief or a tip edge, and
//! the extremes of a curve often stand there. So the curve is divided where the loaded pairs change ([`events`]), a polynomial stands between
//! two neighboring positions or events ([`sections`]), and the contact is solved at some more positions, where
//! the extremes, and then the rest, are least known. At some more the largest pressures and stresses are looked for ([`peaks`]). The arrays of a curve stay on the equal steps; its statistics and its spectrum are those of the sections.

mod cubic;
mod events;
mod peaks;
mod refinement;
mod sections;

use super::Case;
use super::case::PositionInCurve;
use crate::contact::MeshContact;

pub(super) use peaks::{MOST_FOR_PEAKS, PeakSearch, Watched};
pub(super) use refinement::{Refinement, most_further};
pub(super) use sections::Sections;

/// A curve at one mesh position.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    pub(super) position: f64,
    pub(super) transmission_error: f64,
    pub(super) stiffness: f64,
    /// The torque of the driver over r_b1.
    pub(super) driving_load: f64,
    /// The pairs that carry load or are near to it.
    pub(super) pairs: Vec<PairState>,
}

/// Load share of a pair, or its distance from contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct PairState {
    /// The pair n.
    pub(super) pair: i64,
    /// Its share of the load.
    pub(super) share: f64,
    /// How far the driven gear would have to lag more for it to touch, in meters along the line of action, where it carries nothing and this is known.
    pub(super) clearance: Option<f64>,
}

impl Sample {
    /// Samples at `places` of a curve, with the `contacts`, δ and k there.
    pub(super) fn of(
        places: &[PositionInCurve],
        contacts: &[MeshContact],
        transmission_error: &[f64],
        stiffness: &[f64],
    ) -> Vec<Self> {
        let curves = transmission_error.iter().zip(stiffness);
        let each = places.iter().zip(curves);
        each.map(|(place, (&transmission_error, &stiffness))| {
            let states = contacts[place.contact].pairs.iter();
            let states = states.map(|pair| PairState {
                pair: pair.pair + place.later,
                share: pair.share,
                clearance: pair.clearance,
            });
            Self {
                position: place.position,
                transmission_error,
                stiffness,
                driving_load: contacts[place.contact].driving_load,
                pairs: states.collect(),
            }
        })
        .collect()
    }

    /// The same, `periods` whole mesh periods later.
    pub(super) fn later(&self, periods: i64) -> Self {
        let mut later = self.clone();
        later.position += periods as f64;
        for state in &mut later.pairs {
            state.pair += periods;
        }
        later
    }

    /// The state of pair `n`, if it is near.
    fn pair(&self, n: i64) -> Option<&PairState> {
        self.pairs.iter().find(|state| state.pair == n)
    }

    /// True if pair `n` carries load.
    fn carries(&self, n: i64) -> bool {
        self.pair(n).is_some_and(|state| state.share > 0.0)
    }
}

/// The stretch over which a curve runs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    /// Where it begins, as a mesh position.
    first: f64,
    /// Its mesh periods.
    periods: u32,
    /// Positions in a mesh period.
    per_period: u32,
    /// True if the curve is periodic in it.
    closes: bool,
}

impl Span {
    /// Span of the curves of `case`.
    pub(super) fn of(case: &Case) -> Self {
        Self {
            first: case.resolution.first_position,
            periods: case.span(),
            per_period: case.resolution.positions_per_mesh_period,
            closes: case.covers_whole_periods(),
        }
    }

    #[cfg(test)]
    pub(super) fn new(first: f64, periods: u32, per_period: u32, closes: bool) -> Self {
        Self {
            first,
            periods,
            per_period,
            closes,
        }
    }

    /// The distance of two positions.
    fn step(&self) -> f64 {
        1.0 / f64::from(self.per_period)
    }

    /// The multiple of a part of a step that is nearest to `place`; itself without a `lattice`.
    fn on_lattice(&self, place: f64, lattice: Option<u32>) -> f64 {
        lattice.map_or(place, |parts| {
            let nodes = f64::from(self.per_period * parts);
            (place * nodes).round() / nodes
        })
    }

    fn end(&self) -> f64 {
        self.first + f64::from(self.periods)
    }
}
