//! The mesh at one fraction of its period along faces: all that positions whole mesh periods apart have in common.
//!
//! As in the plane ([`crate::contact::Stage`]) the same flanks face each other in every mesh period. Slices, their springs, the half space along their lines,
//! the compliance at the ends of flanks and that of gears whose teeth are all alike are computed once, and each period adds the common compliance of its teeth of
//! a gear with holes. Where teeth deviate, every position is a stage by itself.

use std::sync::{Arc, OnceLock};

use faer::Mat;

use super::FaceModel;
use super::balance::{Balance, Start, balance};
use super::compliance::SliceCompliance;
use super::slice::{Loading, NearKink, Slice, Slicer, Stretches, Within};
use crate::contact::positions::stages;
use crate::contact::{ContactError, PositionError};

/// Slices are first made for a line load of so many times the mean over whole lines, and where they carry more, for this times a power of [`RUNG`]: positions
/// whole mesh periods apart have few kinds of slices.
pub(super) const HEAVIER: f64 = 3.5;
const RUNG: f64 = 1.1;

/// So many rungs farther slices are made where their compliance is not positive definite, and where they come to no balance: lines are blurred by 1.6 times as
/// much. The closing of a spring at a kink or a corner may fall as its load grows, where the contact reaches another part of the flank; beside a wider blur it
/// rises.
const LONGER: i32 = 10;

/// How many times the loaded parts of lines are cut finer, at most.
const FINEST: usize = 4;

/// Slices, and the part of their compliance that does not depend on the mesh period.
pub(super) struct Sliced<'a> {
    pub(super) slicer: Slicer<'a>,
    /// Of pairs counted from the mesh period.
    pub(super) slices: Vec<Slice>,
    pub(super) compliance: SliceCompliance,
    /// Where kinks stand in the middle of the contact on each slice: slice by slice. A kink is near in all mesh periods if it is in one.
    at_kinks: Vec<OnceLock<Option<Within>>>,
}

/// Slices in balance.
pub(super) struct Balanced<'a> {
    pub(super) sliced: Arc<Sliced<'a>>,
    /// The mesh period in which they stand.
    pub(super) period: i64,
    /// Their compliance without springs.
    pub(super) compliance: Mat<f64>,
    pub(super) balance: Balance,
}

/// Slices that were made, and the balance that was found on them last.
struct Made<'a> {
    stretches: Stretches,
    rung: i32,
    /// `None` where nothing is to be sliced.
    sliced: Option<Arc<Sliced<'a>>>,
    last: Option<Start>,
}

/// The mesh at one fraction of its period, under one load.
pub(super) struct Stage<'a> {
    model: &'a FaceModel,
    eta: f64,
    load: f64,
    /// The lines of sections that may touch.
    whole: Stretches,
    made: Vec<Made<'a>>,
}

impl FaceModel {
    /// `positions` by the stage to which they belong, with their places.
    pub(super) fn stages_of(&self, positions: &[f64]) -> Vec<(f64, Vec<usize>)> {
        if self.flanks.deviations.are_none() {
            return stages(positions);
        }
        let each = positions.iter().enumerate();
        each.map(|(place, eta)| (*eta, vec![place])).collect()
    }
}

impl<'a> Stage<'a> {
    /// The mesh of `model` at the position `eta`, and where teeth do not deviate whole mesh periods from there, under `load`, of sections in `phases`.
    pub(super) fn new(model: &'a FaceModel, eta: f64, load: f64, phases: [f64; 2]) -> Self {
        Self {
            model,
            eta,
            load,
            whole: Stretches::whole(model, eta, phases),
            made: Vec::new(),
        }
    }

    /// The slices in balance, so many mesh periods on.
    ///
    /// Where few slices carry load, the loaded part of each line is cut into finer ones.
    pub(super) fn contact(&mut self, period: i64) -> Result<Balanced<'a>, PositionError> {
        let whole = self.whole.clone();
        let mut balanced = self.balanced(&whole, period, 0.0)?;
        let mut loaded = balanced.loaded(self.model, &whole);
        for _ in 0..FINEST {
            let Some(stretches) = loaded else { break };
            // Where finer slices come to no balance, the longer ones are kept.
            let heaviest = balanced.balance.heaviest;
            let Ok(finer) = self.balanced(&stretches, period, heaviest) else {
                break;
            };
            if stretches.end_under_load(&finer.sliced.slices, &finer.balance.carried, &whole) {
                break;
            }
            balanced = finer;
            loaded = balanced.loaded(self.model, &stretches);
        }
        Ok(balanced)
    }

    /// The balance of the slices of whole lines, not cut finer.
    pub(super) fn whole(&mut self, period: i64) -> Result<Balanced<'a>, PositionError> {
        self.balanced(&self.whole.clone(), period, 0.0)
    }

    /// The rung of a line load, and the line load of a rung.
    fn rung_of(&self, line_load: f64) -> i32 {
        let over = line_load / self.heaviest(0);
        (over.ln() / RUNG.ln()).ceil().max(0.0) as i32
    }

    fn heaviest(&self, rung: i32) -> f64 {
        HEAVIER * self.whole.mean_load(self.load) * RUNG.powi(rung)
    }

    /// The balance of the slices of `stretches`, which are to carry a line load of `expected` at most.
    ///
    /// Lines are blurred by more than their contact is wide. Where it is wider than that of the line load for which they were made, others are made, until a
    /// line would be a point.
    fn balanced(
        &mut self,
        stretches: &Stretches,
        period: i64,
        expected: f64,
    ) -> Result<Balanced<'a>, PositionError> {
        let model = self.model;
        let mut rung = self.rung_of(expected);
        loop {
            let made = self.made(stretches, rung);
            let sliced = made.sliced.clone().ok_or(PositionError::NoContact)?;
            let start = made.last.clone();
            let apart = sliced.pairs_apart();
            if apart > model.coupled {
                return Err(PositionError::TooFarApart {
                    apart,
                    coupled: model.coupled,
                });
            }
            let compliance = sliced.compliance.of_teeth(model, period);
            let is_point = sliced.slicer.is_no_line(stretches);
            match balance(&compliance, &sliced.slices, self.load, start.as_ref()) {
                Ok(balance) if is_point || balance.heaviest <= self.heaviest(rung) => {
                    self.made(stretches, rung).last = Some(balance.start());
                    return Ok(Balanced {
                        sliced,
                        period,
                        compliance,
                        balance,
                    });
                }
                Ok(balance) => rung = self.rung_of(balance.heaviest).saturating_add(1),
                Err(PositionError::Contact(
                    ContactError::NotPositiveDefinite { .. } | ContactError::NotConverged { .. },
                )) if !is_point => {
                    rung = rung.saturating_add(LONGER);
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// The slices of `stretches` with springs for the line load of this `rung`.
    fn made(&mut self, stretches: &Stretches, rung: i32) -> &mut Made<'a> {
        let known = |made: &Made<'_>| made.rung == rung && made.stretches == *stretches;
        let known = self.made.iter().position(known);
        let place = known.unwrap_or_else(|| {
            let loading = Loading {
                load: self.load,
                heaviest: self.heaviest(rung),
            };
            let slicer = Slicer::new(self.model, self.eta, stretches, loading);
            self.made.push(Made {
                stretches: stretches.clone(),
                rung,
                sliced: Sliced::new(self.model, slicer, stretches).map(Arc::new),
                last: None,
            });
            self.made.len() - 1
        });
        &mut self.made[place]
    }
}

impl<'a> Sliced<'a> {
    /// The slices of `stretches` of `model`; `None` if there is none.
    pub(super) fn new(
        model: &FaceModel,
        slicer: Slicer<'a>,
        stretches: &Stretches,
    ) -> Option<Self> {
        let slices = slicer.slices(stretches);
        let kinks = slices.len() * slicer.kink_count();
        (!slices.is_empty()).then(|| Self {
            compliance: SliceCompliance::new(model, &slices, slicer.blur),
            at_kinks: std::iter::repeat_with(OnceLock::new).take(kinks).collect(),
            slicer,
            slices,
        })
    }

    /// Calls `each` with the places of the loaded `part` of slice `i` that are nearest to kinks beside which a contact of this `half_width` reaches. Where that
    /// is an end of the load within the slice, nothing presses there.
    pub(super) fn each_kink(
        &self,
        i: usize,
        part: [f64; 2],
        half_width: f64,
        mut each: impl FnMut(&Within),
    ) {
        let slice = &self.slices[i];
        for NearKink {
            number,
            stands,
            nearest,
        } in self.slicer.near_kinks(slice, part, half_width)
        {
            if stands == nearest {
                let known = &self.at_kinks[i * self.slicer.kink_count() + number];
                let known = known.get_or_init(|| self.slicer.within(slice, nearest));
                known.iter().for_each(&mut each);
            } else if nearest.abs() == 1.0 {
                slice.at_end(nearest).iter().for_each(&mut each);
            }
        }
    }

    /// The compliance of the slices without springs, so many mesh `period`s on.
    #[cfg(test)]
    pub(super) fn compliance(&self, model: &FaceModel, period: i64) -> Mat<f64> {
        self.compliance.of_teeth(model, period)
    }

    /// How far the pairs of its slices are apart.
    fn pairs_apart(&self) -> usize {
        let pairs = [self.slices.first(), self.slices.last()];
        let [first, last] = pairs.map(|slice| slice.map_or(0, |slice| slice.pair));
        first.abs_diff(last) as usize
    }
}

impl Balanced<'_> {
    /// The loaded part of each line of `of`, whose slices these are, if together they are less than half a face: they are cut finer then.
    fn loaded(&self, model: &FaceModel, of: &Stretches) -> Option<Stretches> {
        let carried = self.balance.carried.iter();
        let gaps = carried.zip(&self.balance.gaps);
        let gaps: Vec<f64> = gaps
            .map(|(carried, gap)| if carried.force > 0.0 { 0.0 } else { *gap })
            .collect();
        of.loaded(model, &self.sliced.slices, &gaps)
    }
}
