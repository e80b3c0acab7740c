//! Contact of teeth that deviate, on the slices of the pair as drawn.
//!
//! Deviations open and close gaps. To the first order they change nothing else, and δ changes by qᵀ Δg with q = dN/dF of the drawn contact. So each fraction of
//! the mesh period has the slices of the drawn pair and their compliance A with springs as stiff as they are under the drawn contact. What remains is the
//! linear contact of the plane ([`ContactProblem`]). It has the second order too: slices that lose contact, and slices that come into it.
//!
//! ```text
//! g = A N + g_0 + Δg − δ w >= 0,   N >= 0,   wᵀ N = F,   Δg = −Σ w_g e_g
//! ```
//!
//! e_g is how far the flank of gear g stands out beyond its drawing at the slice, along the base tangent, and w_g the arm of the slice about its axis. Where
//! slices carry as drawn, g_0 is such that the drawn contact is the solution without deviations.

use faer::Mat;
use rayon::prelude::*;

use super::slice::Slice;
use super::spring::{Pressed, Spring};
use super::stage::{Balanced, Stage};
use super::{FaceContact, FaceModel, FirstReach, Gathered, LOOKED_FROM, MiddleLoad, SliceLoad};
use crate::contact::compliances::CachedCompliance;
use crate::contact::memo::Memo;
use crate::contact::mesh_contact::Spot;
use crate::contact::peak::Peak;
use crate::contact::positions::{PositionsError, stages};
use crate::contact::{
    ContactProblem, ContactSolution, MeshContact, PeakPlace, PositionError, solve_active_set,
};
use crate::gear::{Member, PairDeviations, SolidPair};
use crate::run::Run;

/// Limit of stages in bytes: some fifty fractions of the mesh period under two loads.
const MOST_BYTES: usize = 24 << 20;

/// Limit of the factors of one stage in bytes.
const MOST_CORE_BYTES: usize = 96 << 10;

/// Fractions of the mesh period are known to this part of it.
const FRACTION: f64 = 1.0 / (1 << 28) as f64;

/// Line loads at which the response of a slice is known: the mean of the drawn contact times powers of this, from `LIGHTEST` such steps below it on.
const STEP: f64 = 2.5;
const LIGHTEST: i32 = 3;
const KNOWN: usize = 6;

/// The least margin of [`margin`] in meters, and the factor between two: members of a population share slices.
const LEAST_MARGIN: f64 = 1e-6;
const MARGIN_STEP: f64 = 2.0;

/// The slices of a pair as drawn and their contacts, for any deviations of its teeth; shared between threads.
#[derive(Debug)]
pub struct DrawnFaces {
    stages: Memo<StageSpec, Result<DrawnStage, PositionError>>,
    phases: Memo<[u64; 2], Result<[f64; 2], PositionError>>,
}

impl Default for DrawnFaces {
    fn default() -> Self {
        Self {
            stages: Memo::new(MOST_BYTES, |stage| {
                size_of::<DrawnStage>() + stage.as_ref().map_or(0, DrawnStage::bytes)
            }),
            phases: Memo::new(64 * size_of::<[f64; 2]>(), size_of_val),
        }
    }
}

impl DrawnFaces {
    /// About how much memory is used, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.stages.bytes() + self.phases.bytes()
    }
}

/// Specification of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct StageSpec {
    /// In parts of [`FRACTION`].
    fraction: i64,
    /// The bits of the load, and of the margin.
    load: u64,
    margin: u64,
}

/// The slices at one fraction of the mesh period.
struct DrawnStage {
    /// Of pairs counted from the mesh period.
    slices: Vec<DrawnSlice>,
    compliance: CachedCompliance,
    /// Gaps for the problem, without deviations.
    gaps: Vec<f64>,
    /// True for slices that carry as drawn.
    active: Vec<bool>,
}

/// One slice.
struct DrawnSlice {
    pair: i64,
    z: f64,
    length: f64,
    along: f64,
    roll_lengths: [f64; 2],
    /// The arms about both axes over the base radii, times cos β_b.
    weights: [f64; 2],
    /// By how much the section of each gear is turned.
    twists: [f64; 2],
    /// The δ at which it touches first as drawn.
    touch: f64,
    responses: Responses,
    /// Largest pressure over that of the mean line load, which a kink raises, or the end of a line.
    raised: f64,
}

/// Response of a slice to its line load.
struct Responses {
    /// The logarithm of the first line load.
    first: f64,
    known: [Pressed; KNOWN],
}

impl FaceModel {
    /// The contact at each of `positions` under `load` of teeth with these `deviations`, on the slices of this model of the drawn pair, which `store` keeps.
    ///
    /// # Errors
    ///
    /// [`PositionsError`].
    pub fn contacts_on_drawn(
        &self,
        (store, deviations): (&DrawnFaces, &PairDeviations),
        load: f64,
        positions: &[f64],
        run: &Run,
    ) -> Result<Vec<FaceContact>, PositionsError> {
        let margin = margin(self.pair(), deviations);
        let phases = store.phases.get([load, margin].map(f64::to_bits), |_| {
            let FirstReach { delta, .. } = self.first_reach(load)?;
            Ok(self.flanks.phases_within(delta + margin))
        });
        let phases =
            Result::clone(&phases).map_err(|error| PositionsError::at(error, LOOKED_FROM))?;
        let module = self.pair().section().driving().data().rack.module;
        let solved: Result<Vec<_>, PositionsError> = stages(positions)
            .par_iter()
            .map(|(fraction, places)| {
                let spec = StageSpec {
                    fraction: (fraction / FRACTION).round() as i64,
                    load: load.to_bits(),
                    margin: margin.to_bits(),
                };
                let stage = store.stages.get(spec, |spec| {
                    let fraction = spec.fraction as f64 * FRACTION;
                    let balanced = Stage::new(self, fraction, load, phases).whole(0)?;
                    Ok(DrawnStage::new(self, &balanced))
                });
                let mut warm = None;
                let each = places.iter().map(|&place| {
                    let eta = positions[place];
                    let period = (eta - fraction).round() as i64;
                    let stage = Result::as_ref(&stage)
                        .map_err(|error| PositionsError::at(error.clone(), eta))?;
                    let contact = stage.contact((self.pair(), deviations), load, period, &mut warm);
                    run.reached(1)?;
                    let contact = contact.map_err(|error| PositionsError::at(error, eta))?;
                    let checked = contact.mesh.check(module);
                    checked.map_err(|error| PositionsError::at(error.into(), eta))?;
                    Ok((place, contact))
                });
                each.collect::<Result<Vec<_>, PositionsError>>()
            })
            .collect();
        let mut solved: Vec<_> = solved?.into_iter().flatten().collect();
        solved.sort_unstable_by_key(|(place, _)| *place);
        Ok(solved.into_iter().map(|(_, contact)| contact).collect())
    }
}

/// By how much a pair may stand nearer than those beside it: a bound of what `deviations` of successive teeth differ by, rounded up. The runout of a gear, which
/// moves all pairs alike, counts as little as it differs.
fn margin(pair: &SolidPair, deviations: &PairDeviations) -> f64 {
    let section = pair.section();
    let farthest = pair.total_contact_ratio().ceil() as i64;
    let of_gear = |member: Member| {
        let (gear, own) = (section.gear(member), deviations.of_gear(member));
        let s = match member {
            Member::Driving => section.pitch_roll_length(),
            Member::Driven => section.line_of_action() - section.pitch_roll_length(),
        };
        let ends = [gear.form_roll_length(), gear.tip_roll_length()];
        let count = i64::from(gear.tooth_count());
        let towards = |n: i64, s: f64| {
            let tooth = section.tooth(member, n);
            own.at(tooth, s) + own.runout(gear, tooth, s, 0.0)
        };
        let apart = (0..count).flat_map(|n| (1..=farthest).map(move |k| (n, n + k)));
        let apart = apart.map(|(n, other)| (towards(other, s) - towards(n, s)).abs());
        let inclined = (0..count).flat_map(|n| ends.map(|end| (n, end)));
        let inclined = inclined.map(|(n, end)| (towards(n, end) - towards(n, s)).abs());
        apart.fold(0.0, f64::max) + inclined.fold(0.0, f64::max) + 2.0 * own.largest_lead()
    };
    let bound = of_gear(Member::Driving) + of_gear(Member::Driven);
    let steps = (bound / LEAST_MARGIN).max(1.0).ln() / MARGIN_STEP.ln();
    LEAST_MARGIN * MARGIN_STEP.powi(steps.ceil() as i32)
}

impl DrawnStage {
    /// That of the drawn contact `balanced` of `model`.
    fn new(model: &FaceModel, balanced: &Balanced<'_>) -> Self {
        let (slices, balance) = (&balanced.sliced.slices, &balanced.balance);
        let growth = balance.growth();
        let (mut compliance, forces) = (balanced.compliance.clone(), &balance.forces);
        let loaded = || {
            forces
                .iter()
                .zip(&growth)
                .filter(|(force, _)| **force > 0.0)
        };
        let all: f64 = forces.iter().sum();
        // How far flanks are pressed into the springs, in the mean over the load.
        let usual = loaded()
            .map(|(force, growth)| force * force / growth)
            .sum::<f64>()
            / all;
        let carried = slices.iter().zip(forces).filter(|(_, force)| **force > 0.0);
        let mean = all / carried.map(|(slice, _)| slice.along).sum::<f64>();
        for (i, slice) in slices.iter().enumerate() {
            let spring = &slice.middle.spring;
            // A slice that carries on a part of its length grows as it comes to carry on all of it.
            let whole = slice.along * spring.load(usual)[1];
            let stiffness = growth[i].max(whole);
            compliance[(i, i)] += 1.0 / stiffness;
        }
        let opened = &compliance * Mat::from_fn(slices.len(), 1, |i, _| forces[i]);
        let delta = balance.transmission_error;
        let gaps = (slices.iter().zip(forces).enumerate()).map(|(i, (slice, force))| {
            if *force > 0.0 {
                delta * slice.middle.weights[1] - opened[(i, 0)]
            } else {
                slice.middle.gap
            }
        });
        let of_slice =
            |(i, slice): (usize, &Slice)| DrawnSlice::new(model, balanced, (i, slice), mean);
        Self {
            gaps: gaps.collect(),
            active: forces.iter().map(|force| *force > 0.0).collect(),
            slices: slices.iter().enumerate().map(of_slice).collect(),
            compliance: CachedCompliance::alone(compliance, MOST_CORE_BYTES),
        }
    }

    fn bytes(&self) -> usize {
        let of_each = size_of::<DrawnSlice>() + size_of::<f64>() + size_of::<bool>();
        self.slices.len() * of_each + self.compliance.bytes().max(MOST_CORE_BYTES)
    }

    /// The contact so many mesh `period`s on of the teeth of `pair` with these `deviations`, looked for from the slices that carried last.
    fn contact(
        &self,
        (pair, deviations): (&SolidPair, &PairDeviations),
        load: f64,
        period: i64,
        warm: &mut Option<Vec<bool>>,
    ) -> Result<FaceContact, PositionError> {
        let towards = |slice: &DrawnSlice| slice.towards(pair, deviations, period);
        let towards: Vec<f64> = self.slices.iter().map(towards).collect();
        let gaps = self.gaps.iter().zip(&towards);
        let gaps = gaps.map(|(gap, towards)| gap - towards).collect();
        let arms = self.slices.iter().map(|slice| slice.weights[1]).collect();
        let problem = ContactProblem::of_known(&self.compliance, gaps, arms)?;
        let from = warm.as_deref().unwrap_or(&self.active);
        let solution = solve_active_set(&problem, load, Some(from))?;
        let contact = self.summary(&solution, &towards, load, period);
        *warm = Some(solution.active);
        Ok(contact)
    }

    fn summary(
        &self,
        solution: &ContactSolution,
        towards: &[f64],
        load: f64,
        period: i64,
    ) -> FaceContact {
        let mut gathered = Gathered::default();
        let mut middles = Vec::new();
        let normals = solution.forces.iter().zip(&solution.load_derivative);
        for (slice, (&force, &rise)) in self.slices.iter().zip(normals) {
            let pair = slice.pair + period;
            gathered.meet(pair);
            if force <= 0.0 {
                continue;
            }
            let pressed = slice.responses.at(force / slice.along);
            let slice_load = SliceLoad {
                pair,
                z: slice.z,
                length: slice.length,
                force: slice.weights[1] * force,
                roll_lengths: slice.roll_lengths,
                pressure: pressed.pressure,
                at_sharp_edge: pressed.at_sharp_edge,
                half_width: pressed.half_width,
                normal: [force, rise],
            };
            let largest = slice_load.peak().map(|peak| Peak {
                pressure: slice.raised * peak.pressure,
                ..peak
            });
            gathered.add(slice_load, &pressed, largest, load);
            middles.push(MiddleLoad {
                pair,
                z: slice.z,
                roll_lengths: slice.roll_lengths,
                weights: slice.weights,
                normal: [force, rise],
            });
        }
        let spots = self
            .slices
            .iter()
            .zip(solution.forces.iter().zip(&solution.gaps));
        let spots = spots.map(|(slice, (&force, &gap))| Spot {
            force,
            gap,
            moments: slice.weights.map(|weight| weight * force),
        });
        let touches = self.slices.iter().zip(towards);
        let touches = touches.map(|(slice, towards)| slice.touch - towards / slice.weights[1]);
        let deepest = solution.gaps.iter().copied().fold(0.0, f64::min);
        let mesh = MeshContact {
            transmission_error: solution.transmission_error,
            touch: touches.fold(f64::INFINITY, f64::min),
            stiffness: solution.stiffness,
            penetration: -deepest,
            iterations: solution.iterations,
            ..MeshContact::of_spots(load, spots, gathered.peak())
        };
        gathered.contact(mesh, middles)
    }
}

impl DrawnSlice {
    /// `slice` number i of the drawn contact `balanced` of `model`, in which slices carry this `mean` line load.
    fn new(
        model: &FaceModel,
        balanced: &Balanced<'_>,
        (i, slice): (usize, &Slice),
        mean: f64,
    ) -> Self {
        let places = slice.ends.iter().chain([&slice.middle]);
        let touches = places.map(|place| place.gap / place.weights[1]);
        let pair = model.pair();
        let twist = |member: Member| pair.gear(member).twist() * pair.own_height(member, slice.z);
        Self {
            pair: slice.pair,
            z: slice.z,
            length: slice.length,
            along: slice.along,
            roll_lengths: slice.middle.roll_lengths,
            weights: slice.middle.weights,
            twists: Member::BOTH.map(twist),
            touch: touches.fold(f64::INFINITY, f64::min),
            responses: Responses::new(&slice.middle.spring, mean),
            raised: balanced.raised(i),
        }
    }

    /// By how much the flanks stand nearer to each other than drawn, along their normal, so many mesh periods on.
    fn towards(&self, pair: &SolidPair, deviations: &PairDeviations, period: i64) -> f64 {
        let section = pair.section();
        let teeth = section.teeth(self.pair + period);
        let of_gear = |member: Member| {
            let g = member.index();
            let (own, tooth, s) = (deviations.of_gear(member), teeth[g], self.roll_lengths[g]);
            let (height, width) = (
                pair.own_height(member, self.z),
                pair.gear(member).face_width(),
            );
            let along_profile =
                own.at(tooth, s) + own.runout(section.gear(member), tooth, s, self.twists[g]);
            self.weights[g] * (along_profile - own.removed_by_lead(tooth, height, width))
        };
        of_gear(Member::Driving) + of_gear(Member::Driven)
    }
}

impl Balanced<'_> {
    /// The largest pressure on slice `i` over that of its mean line load.
    fn raised(&self, i: usize) -> f64 {
        let (slice, carried) = (&self.sliced.slices[i], &self.balance.carried[i]);
        if carried.force <= 0.0 {
            return 1.0;
        }
        let [from, to] = carried.part;
        let q = carried.force / (0.5 * (to - from) * slice.along);
        let pressed = slice.middle.spring.pressed(q);
        pressed.pressure.map_or(1.0, |pressure| {
            let place = PeakPlace {
                pair: slice.pair,
                roll_lengths: slice.middle.roll_lengths,
                z: Some(slice.z),
                half_width: pressed.half_width,
            };
            let at_ends = self.near_line_ends(i);
            let of_all = at_ends.iter().find(|end| end.is_all);
            let of_all = of_all.and_then(|end| end.within.peak(slice.pair, &end.pressed));
            let middle = of_all.unwrap_or(Peak { pressure, place });
            self.peak_of(i, middle, &at_ends).pressure / pressure
        })
    }
}

impl Responses {
    /// That of a slice on `spring`, about a `mean` line load.
    fn new(spring: &Spring, mean: f64) -> Self {
        let first = mean.ln() - f64::from(LIGHTEST) * STEP.ln();
        let at = |k: usize| spring.pressed((first + k as f64 * STEP.ln()).exp());
        Self {
            first,
            known: std::array::from_fn(at),
        }
    }

    /// That under the line load `q`: powers of it between the known ones, and as of two cylinders beyond them.
    fn at(&self, q: f64) -> Pressed {
        let place = (q.ln() - self.first) / STEP.ln();
        let within = place.clamp(0.0, (KNOWN - 1) as f64);
        let low = (within as usize).min(KNOWN - 2);
        let (part, beyond) = (
            within - low as f64,
            (0.5 * (place - within) * STEP.ln()).exp(),
        );
        let [one, other] = [low, low + 1].map(|k| &self.known[k]);
        let nearest = if part < 0.5 { one } else { other };
        let between = |a: f64, b: f64| {
            let mean = if a > 0.0 && b > 0.0 {
                a.powf(1.0 - part) * b.powf(part)
            } else {
                a + part * (b - a)
            };
            mean * beyond
        };
        let pressure = nearest.pressure.map(|known| {
            let [a, b] = [one, other].map(|of| of.pressure.unwrap_or(known));
            between(a, b)
        });
        Pressed {
            pressure,
            smooth: between(one.smooth, other.smooth),
            half_width: between(one.half_width, other.half_width),
            ..*nearest
        }
    }
}
