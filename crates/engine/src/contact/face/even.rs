//! Which slope and which crowning of the driving leads would even the load along the face.
//!
//! The slices of a few positions are made once. A lead changes their gaps alone, so that another balance gives the loads of the strips of the face, and the springs at
//! that balance give their change with the lead. From there the lead that makes the heaviest strip lightest is that of a linear problem in two unknowns, within
//! a step that grows where the strips follow it and shrinks where they do not.

use faer::Mat;
use rayon::prelude::*;

use super::balance::{Start, balance};
use super::slice::Slice;
use super::stage::{Balanced, Stage};
use super::{FaceModel, add_to_strips, beyond};
use crate::gear::{LeadModification, Member};
use crate::run::{Run, Stopped};

/// The strips over which the face load factor is taken.
pub const STRIPS: usize = 10;

/// The most balances at each of them.
const TRIES: u32 = 16;

/// A further step has to promise to lower the heaviest strip by this part.
const LEAST_GAIN: f64 = 1e-3;

/// The lead that evens the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EvenLead {
    /// Further removal from the driving leads: linear in z, this much at the end at +z, in meters.
    pub slope: f64,
    /// The same at both ends, a parabola.
    pub crowning: f64,
    /// By how much the face load factor is lower with it: the quotient of that with and that without.
    pub lowered: f64,
}

/// The face load factor of the loads on [`STRIPS`] strips.
pub fn face_load_factor(strips: &[f64]) -> f64 {
    let largest = strips.iter().copied().fold(0.0, f64::max);
    largest * strips.len() as f64 / strips.iter().sum::<f64>()
}

/// A slope and a crowning.
type Lead = [f64; 2];

/// The slices at one position, and their compliance without springs.
struct Stand {
    slices: Vec<Slice>,
    /// Their gaps without a further lead, at their beginnings, middles and ends, and how far it opens them: a meter of slope, and one of
    /// crowning.
    gaps: Vec<[f64; 3]>,
    openings: [Vec<[f64; 3]>; 2],
    h: Mat<f64>,
    /// The balance that was found last.
    last: Option<Start>,
}

/// The strips of the face, each over the mean of all, and how they change with a lead.
#[derive(Debug, Clone)]
struct Strips {
    loads: [f64; STRIPS],
    changes: [[f64; STRIPS]; 2],
    /// δ in the mean.
    delta: f64,
}

impl FaceModel {
    /// The slope and the crowning of the driving leads that make the heaviest strip of the face lightest under `load` in the mean over
    /// `positions`, of which δ is at most `farthest`. They take away no more crowning than these leads have. `None` where the contacts have no balance.
    ///
    /// # Errors
    ///
    /// [`Stopped`].
    pub fn even_lead(
        &self,
        load: f64,
        positions: &[f64],
        farthest: f64,
        run: &Run,
    ) -> Result<Option<EvenLead>, Stopped> {
        let first = positions
            .first()
            .and_then(|eta| self.flanks.least_touch(*eta));
        let Some(touch) = first else {
            return Ok(None);
        };
        let phases = self.flanks.phases_within(beyond(farthest, touch));
        let stands: Option<Vec<Stand>> = positions
            .par_iter()
            .map(|&eta| self.stand(eta, load, phases))
            .collect();
        run.check()?;
        let Some(mut stands) = stands else {
            return Ok(None);
        };
        let mut at = |lead: Lead| -> Result<Option<Strips>, Stopped> {
            run.check()?;
            Ok(self.strips(&mut stands, lead, load))
        };
        let Some(first) = at([0.0; 2])? else {
            return Ok(None);
        };
        let before = first.heaviest();
        // A lead has to be compared with the closing of the flanks.
        let touch = positions
            .first()
            .and_then(|eta| self.flanks.least_touch(*eta));
        let mut step = (first.delta - touch.unwrap_or(0.0)).abs();
        let least = -self.crowning();
        let (mut lead, mut known) = ([0.0; 2], first);
        for _ in 0..TRIES {
            let (way, hoped) = known.lightest(step, least - lead[1]);
            let promised = known.heaviest() - hoped;
            if promised < LEAST_GAIN * known.heaviest() {
                break;
            }
            let aim = [lead[0] + way[0], lead[1] + way[1]];
            let Some(found) = at(aim)? else {
                step *= 0.25;
                continue;
            };
            let kept = (known.heaviest() - found.heaviest()) / promised;
            if kept > 0.7 {
                step *= 2.0;
            } else if kept < 0.3 {
                step *= 0.3;
            }
            if kept > 0.0 {
                (lead, known) = (aim, found);
            }
        }
        Ok(Some(EvenLead {
            slope: lead[0],
            crowning: lead[1],
            lowered: known.heaviest() / before,
        }))
    }

    /// The crowning that the driving leads have already.
    fn crowning(&self) -> f64 {
        let leads = self.pair().leads(Member::Driving).iter();
        let amounts = leads.map(|lead| match lead {
            LeadModification::Crowning { amount } => *amount,
            _ => 0.0,
        });
        amounts.sum::<f64>().max(0.0)
    }

    fn stand(&self, eta: f64, load: f64, phases: [f64; 2]) -> Option<Stand> {
        let Balanced {
            sliced,
            compliance: h,
            balance,
            ..
        } = Stage::new(self, eta, load, phases).whole(0).ok()?;
        let slices = sliced.slices.clone();
        let width = self.pair().gear(Member::Driving).face_width();
        let opened = |lead: &LeadModification| -> Vec<[f64; 3]> {
            let removed = slices.iter().map(|slice| {
                let weights = [
                    slice.ends[0].weights[1],
                    slice.middle.weights[1],
                    slice.ends[1].weights[1],
                ];
                std::array::from_fn(|i| {
                    let z = slice.z + 0.5 * (i as f64 - 1.0) * slice.length;
                    let z = self.pair().own_height(Member::Driving, z);
                    weights[i] * lead.removed(z, width)
                })
            });
            removed.collect()
        };
        let openings = [
            opened(&LeadModification::Slope { amount: 1.0 }),
            opened(&LeadModification::Crowning { amount: 1.0 }),
        ];
        Some(Stand {
            gaps: slices.iter().map(gaps).collect(),
            openings,
            h,
            slices,
            last: Some(balance.start()),
        })
    }

    /// The strips of the face in the mean over `stands` with a further `lead`.
    fn strips(&self, stands: &mut [Stand], lead: Lead, load: f64) -> Option<Strips> {
        let width = self.pair().common_face_width();
        let each: Option<Vec<Strips>> = stands
            .par_iter_mut()
            .map(|stand| stand.strips(lead, load, width))
            .collect();
        let each = each?;
        let count = each.len() as f64;
        let mean = |of: &dyn Fn(&Strips) -> f64| each.iter().map(of).sum::<f64>() / count;
        let row = |of: &dyn Fn(&Strips, usize) -> f64| -> [f64; STRIPS] {
            std::array::from_fn(|i| mean(&|strips| of(strips, i)))
        };
        Some(Strips {
            loads: row(&|strips, i| strips.loads[i]),
            changes: [0, 1].map(|k| row(&|strips, i| strips.changes[k][i])),
            delta: mean(&|strips| strips.delta),
        })
    }
}

impl Stand {
    fn strips(&mut self, lead: Lead, load: f64, width: f64) -> Option<Strips> {
        for (i, slice) in self.slices.iter_mut().enumerate() {
            let [begin, middle, end] = std::array::from_fn(|place| {
                let opened: f64 = (0..2).map(|k| lead[k] * self.openings[k][i][place]).sum();
                self.gaps[i][place] + opened
            });
            slice.middle.gap = middle;
            (slice.ends[0].gap, slice.ends[1].gap) = (begin, end);
        }
        let balance = balance(&self.h, &self.slices, load, self.last.as_ref()).ok()?;
        self.last = Some(balance.start());
        let spread = |forces: &[f64]| -> [f64; STRIPS] {
            let mut strips = [0.0; STRIPS];
            for ((slice, carried), force) in self.slices.iter().zip(&balance.carried).zip(forces) {
                let [from, to] = carried.part;
                if carried.force > 0.0 {
                    let z = slice.z + 0.25 * (from + to) * slice.length;
                    let length = 0.5 * (to - from) * slice.length;
                    let force = force * STRIPS as f64 / load;
                    add_to_strips(&mut strips, width, z, length, force);
                }
            }
            strips
        };
        let forces = balance.carried.iter().map(|carried| carried.weighed);
        let forces: Vec<f64> = forces.collect();
        Some(Strips {
            loads: spread(&forces),
            // The touching slices go on touching, and carry the load.
            changes: [0, 1].map(|k| spread(&balance.change(&self.openings[k]))),
            delta: balance.transmission_error,
        })
    }
}

/// The gaps of `slice` at its beginning, in its middle and at its end.
fn gaps(slice: &Slice) -> [f64; 3] {
    let [begin, end] = slice.ends.each_ref().map(|end| end.gap);
    [begin, slice.middle.gap, end]
}

impl Strips {
    fn heaviest(&self) -> f64 {
        self.loads.iter().copied().fold(0.0, f64::max)
    }

    fn after(&self, [slope, crowning]: Lead) -> f64 {
        let each = (0..STRIPS)
            .map(|i| self.loads[i] + slope * self.changes[0][i] + crowning * self.changes[1][i]);
        each.fold(0.0, f64::max)
    }

    /// The way of at most `step` in either lead, the crowning not below `least`, after which the heaviest strip is lightest, if strips go on
    /// changing as they do; and how heavy it is then.
    ///
    /// There two of these meet: strips that are as heavy as each other, and ends of the step. All such places are looked at.
    fn lightest(&self, step: f64, least: f64) -> (Lead, f64) {
        let low = least.max(-step).min(0.0);
        // a slope + b crowning = c.
        let mut lines = vec![
            [1.0, 0.0, -step],
            [1.0, 0.0, step],
            [0.0, 1.0, low],
            [0.0, 1.0, step],
        ];
        for i in 0..STRIPS {
            for j in 0..i {
                let apart = |values: &[f64; STRIPS]| values[i] - values[j];
                let [a, b] = self.changes.each_ref().map(apart);
                lines.push([a, b, -apart(&self.loads)]);
            }
        }
        let mut best = ([0.0; 2], self.heaviest());
        for (i, one) in lines.iter().enumerate() {
            for other in &lines[..i] {
                let turn = one[0] * other[1] - one[1] * other[0];
                let way = [
                    (one[2] * other[1] - one[1] * other[2]) / turn,
                    (one[0] * other[2] - one[2] * other[0]) / turn,
                ];
                const ROUNDING: f64 = 1.0 + 1e-9;
                let inside = way[0].abs() <= step * ROUNDING
                    && way[1] <= step * ROUNDING
                    && way[1] >= low * ROUNDING;
                if !inside {
                    continue;
                }
                let heaviest = self.after(way);
                if heaviest < best.1 {
                    best = (way, heaviest);
                }
            }
        }
        best
    }
}
