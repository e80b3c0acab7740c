//! Contact along faces: lines that cross the flanks, cut into slices.
//!
//! Every transverse section of the pair is a plane pair at another phase: the plane's code says where its flanks touch first, how far they are apart, and
//! in which direction they push (`touch::gap_profile`). Along a slice stand nonlinear springs between
//! the flanks ([`spring`]): Hertz's, or the plane's patches of cells where a tip edge, a fillet or a kink is near. The line load is
//! integrated over the loaded part of the slice, so that it is continuous where the contact ends.
//! The rest of the compliance is linear: the smooth yield of both gears ([`FlankCompliance`]), and the half space along
//! each line, with images beyond the ends of the faces (`compliance`). `balance` finds the depths to which the springs are pressed.
//!
//! ```text
//! p = δ w − g − H N,   N = ∫ q(p) dz,   ∫ w q(p) dz = F,   w = arm cos β_b
//! ```
//!
//! N is normal to the flanks, F and δ are along the line of action of the transverse section.

mod balance;
mod compliance;
pub mod drawn;
pub mod even;
mod flanks;
mod model;
mod slice;
pub mod spring;
mod stage;

use faer::Mat;
use rayon::prelude::*;

use super::coupled::add_yielded;
use super::mesh_contact::Spot;
use super::peak::Peak;
use super::positions::PositionsError;
use super::{MeshContact, PairContact, PairLoads, PeakPlace, PositionError};
use crate::gear::{Member, SolidPair};
use crate::run::Run;
use balance::is_line_end;
pub use flanks::FaceFlanks;
use model::FirstReach;
pub use model::{FaceModel, FlankCompliance};
use slice::Within;
use spring::Pressed;
use stage::{Balanced, Stage};

/// How many slices the whole face is cut into, unless a case says otherwise.
pub const SLICES: usize = 40;

/// How far beyond δ pairs are looked for, as a part of how far the flanks are pressed.
const BEYOND: f64 = 0.3;

/// The position at which contact is looked for first.
const LOOKED_FROM: f64 = 0.0;

/// Pressures are read no nearer to the end of a line than this part of its blur: changes over less than a blur are not resolved. There a blur that is larger by a
/// twentieth changes the line load by less than 1 % (where it falls to nothing over eleven blurs). At the end itself it does so by 10 %.
const NEAREST_TO_END: f64 = 0.5;

/// The response of a slice beside the end of its line.
struct EndResponse {
    within: Within,
    pressed: Pressed,
    /// True if the slice is so short that this is the response of all of it.
    is_all: bool,
}

impl Balanced<'_> {
    /// How far from the middle of slice `i` (0) towards its beginning or its `end` (1) pressures are read, if its line ends there.
    fn read_up_to(&self, i: usize, end: usize) -> Option<f64> {
        let slices = &self.sliced.slices;
        let [here, other] = [end, 1 - end].map(|end| is_line_end(slices, i, end));
        let margin = 2.0 * NEAREST_TO_END * self.sliced.slicer.blur / slices[i].along;
        (here && !other).then_some(1.0 - margin)
    }

    /// The responses of slice `i` beside those of its ends at which its line ends under load.
    fn near_line_ends(&self, i: usize) -> Vec<EndResponse> {
        let (slices, blur) = (&self.sliced.slices, self.sliced.slicer.blur);
        let (slice, part) = (&slices[i], self.balance.carried[i].part);
        let ends = [(0, -1.0), (1, 1.0)].into_iter();
        let loaded = ends.filter(|(end, sign)| sign * part[*end] >= 1.0);
        let near = loaded.filter_map(|(end, sign)| {
            let up_to = self.read_up_to(i, end)?;
            let within = slice.between(sign * up_to);
            let depth = self.balance.depth(slices, i, &within, blur);
            let load = (depth > 0.0).then(|| slice.load(within.at, depth)[0])?;
            Some(EndResponse {
                pressed: within.place.spring.pressed(load),
                within,
                is_all: up_to < 0.0,
            })
        });
        near.collect()
    }

    /// The largest pressure on slice `i`: that `in_middle` of its loaded part, one where a kink stands in the middle of the contact, or one of those `at_ends` of
    /// its line.
    fn peak_of(&self, i: usize, in_middle: Peak, at_ends: &[EndResponse]) -> Peak {
        let ([from, to], half_width) = (self.balance.carried[i].part, in_middle.place.half_width);
        let [low, high] = [0, 1].map(|end| self.read_up_to(i, end));
        let from = low.map_or(from, |up_to| from.max(-up_to));
        let to = high.map_or(to, |up_to| to.min(up_to)).max(from);
        let (slices, blur) = (&self.sliced.slices, self.sliced.slicer.blur);
        let pair = in_middle.place.pair;
        let at_ends = at_ends.iter();
        let peaks = at_ends.filter_map(|end| end.within.peak(pair, &end.pressed));
        let mut largest = peaks.fold(in_middle, Peak::larger);
        self.sliced.each_kink(i, [from, to], half_width, |within| {
            let depth = self.balance.depth(slices, i, within, blur);
            if depth <= 0.0 {
                return;
            }
            let spring = &within.place.spring;
            let pressed = spring.pressed(spring.load(depth)[0]);
            if let Some(peak) = within.peak(pair, &pressed) {
                largest = largest.larger(peak);
            }
        });
        largest
    }
}

impl Within {
    /// The largest pressure there, on a line of `pair`.
    fn peak(&self, pair: i64, pressed: &Pressed) -> Option<Peak> {
        Some(Peak {
            pressure: pressed.pressure?,
            place: PeakPlace {
                pair,
                roll_lengths: self.place.roll_lengths,
                z: Some(self.z),
                half_width: pressed.half_width,
            },
        })
    }
}

/// The load on one slice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SliceLoad {
    /// The pair n.
    pub pair: i64,
    /// The middle of its loaded part, from the middle of the common face.
    pub z: f64,
    /// The length of that along the axis.
    pub length: f64,
    /// Its part of the load F along the line of action, in N.
    pub force: f64,
    /// Where it touches: roll length on the driving and on the driven gear.
    pub roll_lengths: [f64; 2],
    /// The largest pressure in Pa; `None` at a sharp tip edge, where it has no limit.
    pub pressure: Option<f64>,
    /// True if a sharp tip edge carries.
    pub at_sharp_edge: bool,
    /// Half the width of the contact along the profile, in meters.
    pub half_width: f64,
    /// The force N normal to the flanks, and dN/dF.
    pub normal: [f64; 2],
}

/// A force normal to a flank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalForce {
    /// The roll length at which it acts, in meters.
    pub roll_length: f64,
    /// The height at which it acts, from the middle of the gear's own face, in meters.
    pub z: f64,
    /// In N, pressing into the flank.
    pub force: f64,
}

/// A force in the middle of a slice.
#[derive(Debug, Clone, Copy, PartialEq)]
struct MiddleLoad {
    pair: i64,
    z: f64,
    roll_lengths: [f64; 2],
    /// As those of [`Place`].
    weights: [f64; 2],
    /// The force N normal to the flanks, and dN/dF.
    normal: [f64; 2],
}

/// The contact of the whole mesh at one position and load, along the faces.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceContact {
    /// Summed up pair by pair. Its largest pressure is none where a sharp tip edge carries.
    pub mesh: MeshContact,
    /// The slices that carry, pair by pair, along z.
    pub slices: Vec<SliceLoad>,
    /// The forces in the middles of slices that move the flanks as they do.
    middles: Vec<MiddleLoad>,
    /// The shares of the load that the tips of the driving and of the driven gear carry off the path of contact.
    pub corner_shares: [f64; 2],
}

impl FaceContact {
    /// Where the load stands in the mean along the common face, from its middle.
    pub fn load_centroid(&self) -> f64 {
        let slices = self.slices.iter();
        let (moment, force) = slices.fold((0.0, 0.0), |(moment, force), slice| {
            (moment + slice.force * slice.z, force + slice.force)
        });
        moment / force
    }

    /// Loads on the flanks of `member` of `pair`, line by line: the tooth, and the forces on it.
    pub fn pressing<'a>(
        &'a self,
        pair: &'a SolidPair,
        member: Member,
    ) -> impl Iterator<Item = (usize, impl Iterator<Item = NormalForce> + 'a)> + 'a {
        let lines = self.slices.chunk_by(|one, next| one.pair == next.pair);
        lines.map(move |line| {
            let of_slice = move |slice: &SliceLoad| NormalForce {
                roll_length: slice.roll_lengths[member.index()],
                z: pair.own_height(member, slice.z),
                force: slice.normal[0],
            };
            let tooth = pair.section().tooth(member, line[0].pair);
            (tooth, line.iter().map(of_slice))
        })
    }

    /// The load in each of `count` equal strips of a common face of `width`, in N.
    pub fn strips(&self, width: f64, count: usize) -> Vec<f64> {
        let mut strips = vec![0.0; count];
        for slice in &self.slices {
            add_to_strips(&mut strips, width, slice.z, slice.length, slice.force);
        }
        strips
    }
}

impl FaceModel {
    /// The contact at each of `positions` under `load`.
    ///
    /// # Errors
    ///
    /// [`PositionsError`].
    pub fn contacts(
        &self,
        load: f64,
        positions: &[f64],
        run: &Run,
    ) -> Result<Vec<FaceContact>, PositionsError> {
        if positions.is_empty() {
            return Ok(Vec::new());
        }
        let first = self.reaches.get(load.to_bits(), |_| self.first_reach(load));
        let FirstReach { touch, delta } =
            Result::clone(&first).map_err(|error| PositionsError::at(error, LOOKED_FROM))?;
        let mut reach = delta;
        let stages = self.stages_of(positions);
        let mut is_counted = false;
        loop {
            let phases = self.flanks.phases_within(reach);
            let solved: Result<Vec<_>, PositionsError> = stages
                .par_iter()
                .map(|(fraction, places)| {
                    let mut stage = Stage::new(self, *fraction, load, phases);
                    let solved = places.iter().map(|&place| {
                        let eta = positions[place];
                        let period = (eta - fraction).round() as i64;
                        let reached = self.reached(&mut stage, (eta, period), load, reach);
                        run.reached(u64::from(!is_counted))?;
                        let reached = reached.map_err(|error| PositionsError::at(error, eta))?;
                        Ok((place, reached))
                    });
                    solved.collect::<Result<Vec<_>, PositionsError>>()
                })
                .collect();
            let mut solved: Vec<_> = solved?.into_iter().flatten().collect();
            is_counted = true;
            let farthest = solved.iter().map(|(_, (delta, _))| *delta);
            let farthest = farthest.fold(reach, f64::max);
            if farthest == reach {
                solved.sort_unstable_by_key(|(place, _)| *place);
                let module = self.pair().section().driving().data().rack.module;
                let contacts = solved.into_iter().filter_map(|(place, (_, contact))| {
                    let eta = positions[place];
                    let contact = contact?;
                    let checked = contact.mesh.check(module);
                    Some(checked.map_or_else(
                        |error| Err(PositionsError::at(error.into(), eta)),
                        |()| Ok(contact),
                    ))
                });
                return contacts.collect();
            }
            reach = beyond(farthest, touch);
        }
    }

    /// δ at the position `eta` under `load`, which is that of `stage` so many mesh `period`s on, and the contact among the flanks that touch before δ is
    /// `reach`. If there is none, δ is where the first of them touch.
    fn reached(
        &self,
        stage: &mut Stage<'_>,
        (eta, period): (f64, i64),
        load: f64,
        reach: f64,
    ) -> Result<(f64, Option<FaceContact>), PositionError> {
        let contact = stage.contact(period);
        match contact.map(|balanced| self.summary(&balanced, load)) {
            Err(PositionError::NoContact) => match self.flanks.least_touch(eta) {
                Some(touch) if touch > reach => Ok((touch, None)),
                _ => Err(PositionError::NoContact),
            },
            contact => contact.map(|contact| (contact.mesh.transmission_error, Some(contact))),
        }
    }

    /// The δ up to which flanks are looked at under `load`: a little more than δ is at one position, whichever are asked for. Slices lie where lines end,
    /// and lines end where flanks touch before δ is as large as that, so that a position which is solved by itself has the same slices as among all.
    fn first_reach(&self, load: f64) -> Result<FirstReach, PositionError> {
        let touch = self.flanks.least_touch(LOOKED_FROM);
        let touch = touch.ok_or(PositionError::NoContact)?;
        let moduli = self.flanks.moduli();
        // Solid gears yield by about half of this.
        let stiffness = 0.05 * moduli[0].min(moduli[1]) * self.pair().common_face_width();
        let mut reach = touch + load / stiffness;
        loop {
            let phases = self.flanks.phases_within(reach);
            let found = Stage::new(self, LOOKED_FROM, load, phases).contact(0)?;
            let delta = found.balance.transmission_error;
            if delta <= reach {
                let delta = beyond(delta, touch);
                return Ok(FirstReach { touch, delta });
            }
            reach = beyond(delta, touch);
        }
    }

    /// The contact at the position `eta` under `load` of sections in `phases`.
    #[cfg(test)]
    fn contact_within(
        &self,
        eta: f64,
        load: f64,
        phases: [f64; 2],
    ) -> Result<FaceContact, PositionError> {
        let balanced = Stage::new(self, eta, load, phases).contact(0)?;
        Ok(self.summary(&balanced, load))
    }

    /// The loads of `contact` on the functions over the flanks, pair by pair: a column for the forces, and one for their derivative to the load.
    pub fn loads(&self, contact: &FaceContact) -> Vec<PairLoads> {
        let lines = contact.middles.chunk_by(|one, next| one.pair == next.pair);
        lines
            .map(|line| PairLoads {
                pair: line[0].pair,
                loads: Member::BOTH.map(|member| self.load_of_line(member, line)),
            })
            .collect()
    }

    fn load_of_line(&self, member: Member, line: &[MiddleLoad]) -> Mat<f64> {
        let flank = &self.yields[member.index()];
        let cosine = self.pair().base_helix_angle().cos();
        let mut row = vec![0.0; flank.basis_len()];
        let mut load = Mat::zeros(row.len(), 2);
        for slice in line {
            let z = self.pair().own_height(member, slice.z);
            flank.basis(slice.roll_lengths[member.index()], z, &mut row);
            let arm = slice.weights[member.index()] / cosine;
            for (column, normal) in slice.normal.into_iter().enumerate() {
                let force = arm * normal;
                for (sum, value) in load.col_as_slice_mut(column).iter_mut().zip(&row) {
                    *sum += force * value;
                }
            }
        }
        load
    }

    /// qᵀ R p and qᵀ R q of the smooth compliance R of `member`, where p and q are the forces of `loads` and how they rise, on the pairs so
    /// many mesh `periods` after theirs.
    pub fn yielded(&self, member: Member, loads: &[PairLoads], periods: i64) -> [f64; 2] {
        let (Some(first), Some(last)) = (loads.first(), loads.last()) else {
            return [0.0; 2];
        };
        let count = 1 + (last.pair - first.pair) as usize;
        let smooth = self.smooth(member, first.pair + periods, count);
        let mut sums = [0.0; 2];
        add_yielded(&mut sums, member.index(), loads, |a, b| {
            smooth.block(a + periods, b + periods)
        });
        sums
    }

    /// The summary of the `balanced` contact.
    fn summary(&self, balanced: &Balanced<'_>, load: f64) -> FaceContact {
        let Balanced {
            sliced,
            period,
            balance,
            ..
        } = balanced;
        let slices = &sliced.slices;
        let mut gathered = Gathered::default();
        for (i, (slice, carried)) in slices.iter().zip(&balance.carried).enumerate() {
            let pair = slice.pair + period;
            gathered.meet(pair);
            if carried.force <= 0.0 {
                continue;
            }
            let [from, to] = carried.part;
            let (part, middle) = (0.5 * (to - from), 0.5 * (from + to));
            let at_ends = balanced.near_line_ends(i);
            let in_the_mean = || {
                let density = carried.force / (part * slice.along);
                slice.middle.spring.pressed(density)
            };
            let of_all = at_ends.iter().find(|end| end.is_all);
            let mut pressed = of_all.map_or_else(in_the_mean, |end| end.pressed);
            let smooth = at_ends.iter().map(|end| end.pressed.smooth);
            pressed.smooth = smooth.fold(pressed.smooth, f64::max);
            let edge = &slice.ends[usize::from(middle > 0.0)].roll_lengths;
            let slice_load = SliceLoad {
                pair,
                z: slice.z + 0.5 * middle * slice.length,
                length: part * slice.length,
                force: carried.weighed,
                roll_lengths: [0, 1].map(|g| {
                    let at = slice.middle.roll_lengths[g];
                    at + (edge[g] - at) * middle.abs()
                }),
                pressure: pressed.pressure,
                at_sharp_edge: pressed.at_sharp_edge,
                half_width: pressed.half_width,
                normal: [carried.force, carried.rise],
            };
            let largest = slice_load.peak();
            let largest = largest.map(|in_middle| balanced.peak_of(i, in_middle, &at_ends));
            gathered.add(slice_load, &pressed, largest, load);
        }
        let forces = balance.forces.iter().zip(&balance.load_derivative);
        let middles = slices
            .iter()
            .zip(forces)
            .filter(|(_, (force, _))| **force != 0.0);
        let middles = middles.map(|(slice, (&force, &rise))| MiddleLoad {
            pair: slice.pair + period,
            z: slice.z,
            roll_lengths: slice.middle.roll_lengths,
            weights: slice.middle.weights,
            normal: [force, rise],
        });
        let spots = slices.iter().zip(balance.carried.iter().zip(&balance.gaps));
        let spots = spots.map(|(slice, (carried, &gap))| Spot {
            force: carried.force,
            gap,
            moments: [slice.middle.weights[0] * carried.force, carried.weighed],
        });
        let touches = slices.iter().flat_map(|slice| {
            let places = slice.ends.iter().chain([&slice.middle]);
            places.map(|place| place.gap / place.weights[1])
        });
        let mesh = MeshContact {
            transmission_error: balance.transmission_error,
            touch: touches.fold(f64::INFINITY, f64::min),
            stiffness: balance.stiffness,
            penetration: balance.penetration(&sliced.slices, sliced.compliance.lines()),
            iterations: balance.iterations,
            ..MeshContact::of_spots(load, spots, gathered.peak())
        };
        gathered.contact(mesh, middles.collect())
    }
}

impl SliceLoad {
    /// Its largest pressure, in the middle of its loaded part, and the place of it.
    fn peak(&self) -> Option<Peak> {
        Some(Peak {
            pressure: self.pressure?,
            place: PeakPlace {
                pair: self.pair,
                roll_lengths: self.roll_lengths,
                z: Some(self.z),
                half_width: self.half_width,
            },
        })
    }
}

/// Loads on slices, summed up pair by pair.
#[derive(Default)]
struct Gathered {
    pairs: Vec<PairContact>,
    slices: Vec<SliceLoad>,
    largest: Option<Peak>,
    at_sharp_edge: bool,
    smooth_pressure: f64,
    corner_shares: [f64; 2],
}

impl Gathered {
    /// Notes that `pair` has slices, whether they carry or not.
    fn meet(&mut self, pair: i64) {
        if self.pairs.last().is_none_or(|last| last.pair != pair) {
            self.pairs.push(PairContact::of_share(pair, 0.0));
        }
    }

    /// Adds a loaded `slice` of the pair that was met last, its response, and its `largest` pressure, under a mesh `load`.
    fn add(&mut self, slice: SliceLoad, pressed: &Pressed, largest: Option<Peak>, load: f64) {
        let share = slice.force / load;
        if let Some(last) = self.pairs.last_mut() {
            last.share += share;
            last.fillet = last.fillet.or(pressed.fillet);
        }
        if let Some(member) = pressed.tip_corner {
            self.corner_shares[member.index()] += share;
        }
        self.at_sharp_edge |= pressed.at_sharp_edge;
        self.smooth_pressure = self.smooth_pressure.max(pressed.smooth);
        self.largest = match (self.largest, largest) {
            (Some(one), Some(other)) => Some(one.larger(other)),
            (one, other) => one.or(other),
        };
        self.slices.push(SliceLoad {
            pressure: largest.map(|peak| peak.pressure),
            ..slice
        });
    }

    /// The largest pressure; `None` where a sharp edge carries.
    fn peak(&self) -> Option<Peak> {
        self.largest.filter(|_| !self.at_sharp_edge)
    }

    /// The contact of these slices with what is known of the `mesh`, and with the forces in the middles of its slices.
    fn contact(self, mesh: MeshContact, middles: Vec<MiddleLoad>) -> FaceContact {
        FaceContact {
            mesh: MeshContact {
                pairs: self.pairs,
                smooth_pressure: self.smooth_pressure,
                ..mesh
            },
            slices: self.slices,
            middles,
            corner_shares: self.corner_shares,
        }
    }
}

/// Adds the `force` on a piece of a common face of `width`, so long about `z`, to the equal strips that it lies in.
fn add_to_strips(strips: &mut [f64], width: f64, z: f64, length: f64, force: f64) {
    let strip = width / strips.len() as f64;
    let from = (z - 0.5 * length + 0.5 * width) / strip;
    let to = from + length / strip;
    let density = force / (to - from);
    let first = (from.floor().max(0.0) as usize).min(strips.len() - 1);
    for (i, load) in strips.iter_mut().enumerate().skip(first) {
        let (low, high) = (i as f64, (i + 1) as f64);
        if low >= to {
            break;
        }
        *load += density * (to.min(high) - from.max(low)).max(0.0);
    }
}

/// A reach somewhat beyond `delta` of flanks that `touch` before.
fn beyond(delta: f64, touch: f64) -> f64 {
    delta + BEYOND * (delta - touch).abs()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::balance::balance;
    use super::slice::{Loading, Slicer, Stretches};
    use super::stage::{HEAVIER, Sliced};
    use super::*;
    use crate::assembly::{FaceCompliance, FaceComplianceSpec, FaceResolution, MakeAll, Parts};
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{
        Alignment, Core, FaceEnds, Helix, HolePattern, LeadModification, SolidGear, Web,
    };
    use crate::ring::teeth::FARTHEST_COUPLED;

    #[test]
    #[ignore = "./test all"]
    fn by_contact_lines_alone_the_pair_is_that_of_another_program() {
        // 40/40 teeth, 20 degrees, 100 N m, by lines that end with the path of contact: δ 6.522 µm in the mean with K_Hβ 1.042, and 11.471 µm with
        // 1.847 where the face opens by 10 µm, on a segment of 25 teeth with polynomials to degree 6 (0.2 % below degree 8). On nine teeth, whose free
        // sides yield too, it finds 6.763 µm.
        let gear = |beta: f64| {
            let mut data = paper_gear(40);
            data.rack.tip_radius = 0.684e-3;
            data.blank.bore_radius = 28e-3;
            let helix = Helix::right(beta.to_radians());
            SolidGear::new(data, helix, 0.0, None).expect("a gear that can be made")
        };
        let gears = [gear(20.0), gear(-20.0)];
        let yields = gears.each_ref().map(|gear| {
            let made = FaceCompliance::of(gear, FaceResolution::STANDARD, &Run::unattended());
            Arc::new(made.expect("can be condensed")) as Arc<dyn FlankCompliance>
        });
        for (amount, mean, factor) in [(0.0, 6.522e-6, 1.042), (10e-6, 11.471e-6, 1.847)] {
            let leads = [vec![LeadModification::Slope { amount }], Vec::new()];
            let a = 2.0 * gears[0].section().reference_radius();
            let pair = SolidPair::new(gears.clone(), leads, a, Alignment::default());
            let pair = pair.expect("meshes");
            let load = pair.section().load(100.0);
            let model = FaceModel::new(pair, yields.clone(), SLICES, 16);
            let contacts: Vec<FaceContact> = (0..16)
                .map(|i| {
                    let eta = f64::from(i) / 16.0;
                    let section = model.pair().section();
                    let (s_a, s_e) = section.path_of_contact();
                    let phases = [s_a, s_e].map(|s| model.pair().phase_at(s));
                    let lines = Stretches::whole(&model, eta, phases);
                    let heaviest = HEAVIER * lines.mean_load(load);
                    let slicer = Slicer::new(&model, eta, &lines, Loading { load, heaviest });
                    let sliced = Sliced::new(&model, slicer, &lines).expect("slices");
                    let compliance = sliced.compliance(&model, 0);
                    let balance = balance(&compliance, &sliced.slices, load, None);
                    let balanced = Balanced {
                        balance: balance.expect("a balance"),
                        sliced: Arc::new(sliced),
                        period: 0,
                        compliance,
                    };
                    model.summary(&balanced, load)
                })
                .collect();
            let deltas = contacts
                .iter()
                .map(|contact| contact.mesh.transmission_error);
            let found = deltas.sum::<f64>() / 16.0;
            let mut strips = [0.0; 10];
            for contact in &contacts {
                let of_one = contact.strips(20e-3, 10);
                strips
                    .iter_mut()
                    .zip(of_one)
                    .for_each(|(all, one)| *all += one);
            }
            let heaviest = strips.iter().copied().fold(0.0, f64::max);
            let found_factor = 10.0 * heaviest / strips.iter().sum::<f64>();
            println!("{found} {found_factor}");
            assert!((found / mean - 1.0).abs() < 0.01, "{found}");
            assert!((found_factor / factor - 1.0).abs() < 0.02, "{found_factor}");
        }
    }

    #[test]
    fn a_pinion_carries_more_at_the_end_through_which_its_torque_enters() {
        // 20/60 straight teeth of module 2, 40 mm wide, the pinion of one piece with a shaft of 14 mm.
        let (width, radius, run) = (40e-3, 14e-3, Run::unattended());
        let gear = |teeth: u32, bore_radius: f64, core: Core| {
            let mut data = paper_gear(teeth);
            data.face_width = width;
            (data.blank.bore_radius, data.blank.core) = (bore_radius, core);
            SolidGear::new(data, Helix::STRAIGHT, 0.0, None).expect("a gear that can be made")
        };
        let resolution = FaceResolution {
            face_order: 6,
            ..FaceResolution::DRAFT
        };
        let wheel = gear(60, 30e-3, Core::Bore);
        let yields = |gear: &SolidGear| {
            Arc::new(FaceCompliance::of(gear, resolution, &run).expect("definite"))
        };
        let of_wheel = yields(&wheel);
        let solved = [FaceEnds::Both, FaceEnds::Minus, FaceEnds::Plus].map(|torque_at| {
            let pinion = gear(20, radius, Core::Shaft { torque_at });
            let yields: [Arc<dyn FlankCompliance>; 2] = [yields(&pinion), of_wheel.clone()];
            let leads = [Vec::new(), Vec::new()];
            let sections = [&pinion, &wheel].map(|gear| gear.section().reference_radius());
            let a = sections[0] + sections[1];
            let gears = [pinion, wheel.clone()];
            let pair = SolidPair::new(gears, leads, a, Alignment::default()).expect("meshes");
            let load = width * 200e3;
            let model = FaceModel::new(pair, yields, SLICES, FARTHEST_COUPLED);
            let positions: Vec<f64> = (0..8).map(|i| f64::from(i) / 8.0).collect();
            let contacts = model.contacts(load, &positions, &run).expect("balances");
            let mut strips = [0.0; 10];
            let mut delta = 0.0;
            for contact in &contacts {
                delta += contact.mesh.transmission_error / 8.0;
                let of_one = contact.strips(width, 10).into_iter();
                strips
                    .iter_mut()
                    .zip(of_one)
                    .for_each(|(all, one)| *all += one);
            }
            (delta, strips, even::face_load_factor(&strips))
        });
        let [both, minus, plus] = &solved;
        let all: f64 = plus.1.iter().sum();
        assert!((minus.0 / plus.0 - 1.0).abs() < 1e-6);
        for (one, other) in plus.1.iter().zip(minus.1.iter().rev()) {
            assert!((one - other).abs() < 1e-5 * all, "{one} {other}");
        }
        for (one, other) in both.1.iter().zip(both.1.iter().rev()) {
            assert!((one - other).abs() < 1e-5 * all, "{one} {other}");
        }
        // Towards the end at +z, by the twist of the pinion alone: ISO 6336-1 (2006), 7.4 has 0.7 × 0.023 (b/d)² µm for 1 N/mm; by the stiffness c_γβ, and half
        // of it as it is linear and as the ends carry on, K_Hβ = 1 + 0.0161 × 0.85 c_γα/2 with c_γα some 20 N/(mm µm).
        let by_iso = 0.0161 * 0.85 * 20.0 / 2.0;
        let found = plus.2 - both.2;
        assert!(
            (0.7 * by_iso..2.0 * by_iso).contains(&found),
            "{found} {by_iso}"
        );
        assert!(plus.1[9] > plus.1[0]);
        // The teeth stand back by T b/(4 G J) more, J that of a cylinder between the shaft and the tips.
        let section = gear(20, radius, Core::Bore).section().clone();
        let torque = width * 200e3 * section.flank().base_radius();
        let turned = (plus.0 - both.0) / section.flank().base_radius();
        let modulus = section.material().youngs_modulus / 2.6;
        let [most, least] = [radius, section.tip_radius()]
            .map(|of| torque * width / (4.0 * modulus * std::f64::consts::FRAC_PI_2 * of.powi(4)));
        assert!(
            (least..most).contains(&turned),
            "{least:e} {turned:e} {most:e}"
        );
    }

    /// A gear that does not yield.
    struct Rigid;

    impl FlankCompliance for Rigid {
        fn basis_len(&self) -> usize {
            1
        }

        fn basis(&self, _roll_length: f64, _z: f64, row: &mut [f64]) {
            row.fill(0.0);
        }

        fn smooth(&self, teeth: &[usize]) -> Mat<f64> {
            Mat::zeros(teeth.len(), teeth.len())
        }

        fn repeats_after(&self) -> usize {
            1
        }

        fn at_ends(&self, _point: (f64, f64), _loaded: (f64, f64), _along: f64) -> f64 {
            0.0
        }
    }

    #[test]
    fn the_ends_of_a_slice_are_the_places_within_it_there() {
        let gears = [0.35, -0.35].map(|beta| {
            let made = SolidGear::new(paper_gear(40), Helix::right(beta), 0.0, None);
            made.expect("a gear that can be made")
        });
        let a = 2.0 * gears[0].section().reference_radius() + 0.1e-3;
        let leads = [vec![LeadModification::Slope { amount: 10e-6 }], Vec::new()];
        let pair = SolidPair::new(gears, leads, a, Alignment::default()).expect("meshes");
        let yields: [Arc<dyn FlankCompliance>; 2] = [Arc::new(Rigid), Arc::new(Rigid)];
        let load = pair.section().load(100.0);
        let model = FaceModel::new(pair, yields, SLICES, FARTHEST_COUPLED);
        let lines = Stretches::whole(&model, 0.3, model.flanks.phases_within(20e-6));
        let heaviest = HEAVIER * lines.mean_load(load);
        let slicer = Slicer::new(&model, 0.3, &lines, Loading { load, heaviest });
        let mut seen = 0;
        for slice in &slicer.slices(&lines) {
            for at in [-1.0, 1.0] {
                let known = slice.at_end(at).expect("flanks face each other");
                let anew = slicer.within(slice, at).expect("flanks face each other");
                assert!((known.z - anew.z).abs() < 1e-15);
                assert!((known.place.gap - anew.place.gap).abs() < 1e-14);
                let [one, other] = [known, anew].map(|of| of.place.spring.load(1e-6)[0]);
                assert!((one / other - 1.0).abs() < 1e-8, "{one} {other}");
                seen += 1;
            }
        }
        assert!(seen > 2 * SLICES);
    }

    /// A gear somewhere between two others.
    struct Mixed {
        of: [Arc<FaceCompliance>; 2],
        share: f64,
    }

    impl FlankCompliance for Mixed {
        fn basis_len(&self) -> usize {
            self.of[0].basis_len()
        }

        fn basis(&self, roll_length: f64, z: f64, row: &mut [f64]) {
            self.of[0].basis(roll_length, z, row);
        }

        fn smooth(&self, teeth: &[usize]) -> Mat<f64> {
            let [one, other] = self.of.each_ref().map(|of| of.smooth(teeth));
            one * (1.0 - self.share) + other * self.share
        }

        fn repeats_after(&self) -> usize {
            self.of[1].repeats_after()
        }

        fn at_ends(&self, point: (f64, f64), loaded: (f64, f64), along: f64) -> f64 {
            self.of[0].at_ends(point, loaded, along)
        }
    }

    #[test]
    fn the_projected_term_is_the_derivative_of_the_transmission_error_to_the_holes() {
        // δ(H_0 + e ΔH) at e = ±1e-4, with springs that are not linear.
        let beta = 0.3;
        let gear = |beta: f64, count: u32| {
            let mut data = paper_gear(24);
            data.blank.bore_radius = 6e-3;
            data.blank.web = Some(Web {
                inner_radius: 6e-3,
                outer_radius: 18e-3,
                thickness: 6e-3,
            });
            data.blank.holes = HolePattern {
                count,
                circle_radius: 13e-3,
                radius: 3e-3,
                phase: 0.2,
            }
            .holes();
            SolidGear::new(data, Helix::right(beta), -3e-3, None).expect("can be made")
        };
        let gears = [gear(beta, 3), gear(-beta, 4)];
        let a = 2.0 * gears[0].section().reference_radius() + 0.1e-3;
        let leads = [Vec::new(), Vec::new()];
        let pair = SolidPair::new(gears, leads, a, Alignment::default()).expect("meshes");
        let resolution = FaceResolution {
            face_order: 4,
            web_order: 2,
            web_harmonics: 6,
            sections: crate::grid::GridLevel::Standard,
        };
        let (run, load) = (Run::unattended(), pair.section().load(60.0));
        let yields = Member::BOTH.map(|member| {
            let spec = FaceComplianceSpec::new(pair.gear(member), resolution);
            MakeAll.face_compliance(&spec, &run).expect("definite")
        });
        let model = |share: f64| {
            let yields = yields.each_ref().map(|whole| {
                let of = [Arc::new(whole.round_average()), Arc::clone(whole)];
                Arc::new(Mixed { of, share }) as Arc<dyn FlankCompliance>
            });
            FaceModel::new(pair.clone(), yields, SLICES / 2, FARTHEST_COUPLED)
        };
        let (round, whole) = (model(0.0), model(1.0));
        // As far as both reach, so that all have the same slices.
        let phases = whole.flanks.phases_within(30e-6);
        let step = 1e-4;
        let (below, above) = (model(-step), model(step));
        for eta in [0.05, 0.3, 0.55, 0.9] {
            let at = |model: &FaceModel, period: f64| {
                let found = model.contact_within(eta + period, load, phases);
                found.expect("a contact")
            };
            let found = at(&round, 0.0);
            let later = at(&round, 3.0);
            let delta = |of: &FaceContact| of.mesh.transmission_error;
            assert!((delta(&found) / delta(&later) - 1.0).abs() < 1e-9);
            // Positions whole mesh periods apart, solved one after the other on the same slices, are the same as each of them alone.
            let positions = [0.0, 3.0, 7.0].map(|period| eta + period);
            let contacts = |positions: &[f64]| {
                let contacts = whole.contacts(load, positions, &run);
                contacts.expect("contacts")
            };
            let together = contacts(&positions);
            assert!((delta(&together[1]) / delta(&together[0]) - 1.0).abs() > 1e-6);
            for (together, eta) in together.iter().zip(positions) {
                let alone = &contacts(&[eta])[0];
                assert!((delta(together) / delta(alone) - 1.0).abs() < 1e-10);
                let slices = together.slices.iter().zip(&alone.slices);
                for (one, other) in slices {
                    assert_eq!(one.pair, other.pair, "{eta}");
                    assert!((one.force - other.force).abs() < 1e-7 * load);
                }
                assert_eq!(together.slices.len(), alone.slices.len());
            }
            let loads = round.loads(&found);
            for period in [0, 3] {
                let term = |model: &FaceModel| {
                    let of = Member::BOTH.map(|member| model.yielded(member, &loads, period)[0]);
                    of[0] + of[1]
                };
                let change = term(&whole) - term(&round);
                let difference = (delta(&at(&above, period as f64))
                    - delta(&at(&below, period as f64)))
                    / (2.0 * step);
                assert!(
                    (change - difference).abs() < 1e-5 * difference.abs().max(1e-7),
                    "{eta} {period}: {change} {difference}"
                );
            }
        }
    }
}
