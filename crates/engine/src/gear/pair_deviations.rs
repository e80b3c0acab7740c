//! Deviations of the flanks of two gears from their drawings, tooth by tooth.

use std::f64::consts::PI;

use super::lead::LeadModification;
use super::modification::Modification;
use super::{Eccentricity, Involute, Member, SpurGear, ToothDeviations, Vector};

/// Deviations of the teeth of one gear along their normals, tooth by tooth.
#[derive(Debug, Clone, PartialEq)]
pub struct GearDeviations {
    /// How far each flank is turned towards its mate, as a length on the base circle. Empty where all stand as drawn.
    turns: Vec<f64>,
    /// The same turn of each other flank, in the same sense. Empty where each stands as the loaded flank of its tooth does.
    other_turns: Vec<f64>,
    /// f_Hα of each flank. Empty where none is inclined.
    profile_slopes: Vec<f64>,
    /// Removal by each lead slope. Empty where there is none.
    lead_slopes: Vec<f64>,
    /// The traces of the profiles.
    profiles: Option<Profiles>,
    /// Removal by the trace of each lead. Empty where there are none.
    leads: Vec<LeadModification>,
    /// The growth of each flank along the face, less its mean, as removal. Empty where the growth of flanks is constant along their faces.
    grown: Vec<LeadModification>,
    /// The roll lengths between which a profile slope deviation grows from nothing to all of it.
    ends: [f64; 2],
    eccentricity: Option<Eccentricity>,
}

impl GearDeviations {
    /// Nothing deviates.
    const NONE: Self = Self {
        turns: Vec::new(),
        other_turns: Vec::new(),
        profile_slopes: Vec::new(),
        lead_slopes: Vec::new(),
        profiles: None,
        leads: Vec::new(),
        grown: Vec::new(),
        ends: [0.0, 1.0],
        eccentricity: None,
    };

    /// Effect of `teeth`, lists of deviations that fit `gear`, on its flanks.
    pub(super) fn of(gear: &SpurGear, teeth: &ToothDeviations) -> Self {
        let teeth = teeth.clone().without_zeros();
        // An arc f on the reference circle turns the flank by f/r, which is f cos α along the base tangent.
        let cosine = gear.data().rack.pressure_angle.cos();
        let turns = |arcs: &[f64]| arcs.iter().map(|arc| arc * cosine).collect();
        let alike = teeth.other_cumulative_pitch.is_empty();
        let profiles = teeth.profiles.as_ref().map(|traces| Profiles {
            flank: *gear.flank(),
            rounded: gear.rounding_of_kinks(),
            removed: traces
                .removed
                .iter()
                .map(|removed| Modification::Table {
                    places: traces.places.clone(),
                    removed: removed.clone(),
                })
                .collect(),
        });
        let leads = teeth.leads.iter().flat_map(|traces| {
            let rows = traces.removed.iter();
            rows.map(|removed| LeadModification::Table {
                places: traces.heights.clone(),
                removed: removed.clone(),
            })
        });
        Self {
            turns: turns(&teeth.cumulative_pitch),
            other_turns: if alike {
                Vec::new()
            } else {
                turns(&teeth.other_pitch())
            },
            profile_slopes: teeth.profile_slope,
            profiles,
            leads: leads.collect(),
            grown: Vec::new(),
            lead_slopes: teeth.lead_slope,
            ends: [gear.form_roll_length(), gear.tip_roll_length()],
            eccentricity: teeth.eccentricity,
        }
    }

    /// True if every tooth stands as drawn, about the axis of rotation.
    pub fn is_none(&self) -> bool {
        self.turns.is_empty()
            && self.other_turns.is_empty()
            && self.profile_slopes.is_empty()
            && self.lead_slopes.is_empty()
            && self.profiles.is_none()
            && self.leads.is_empty()
            && self.grown.is_empty()
            && self.eccentricity.is_none()
    }

    /// How far the loaded flank of `tooth` stands towards its mate at the roll length `s`, along the normal, beyond the drawing.
    pub fn at(&self, tooth: usize, s: f64) -> f64 {
        let slope = self.profile_slopes.get(tooth).map_or(0.0, |amount| {
            let [from, to] = self.ends;
            amount * (s - from) / (to - from)
        });
        let trace = self.trace(tooth);
        self.turn(tooth) + slope - trace.map_or(0.0, |trace| trace.depth(s))
    }

    /// The trace of the profile of `tooth`, where there are traces.
    pub(crate) fn trace(&self, tooth: usize) -> Option<Trace<'_>> {
        let profiles = self.profiles.as_ref()?;
        let removed = profiles.removed.get(tooth)?;
        Some(Trace { profiles, removed })
    }

    /// Removal by the lead of `tooth` at the height `z` from the middle of its face of this `width`, beside the modifications.
    pub fn removed_by_lead(&self, tooth: usize, z: f64, width: f64) -> f64 {
        let slope = LeadModification::Slope {
            amount: self.lead_slopes.get(tooth).copied().unwrap_or(0.0),
        };
        let lists = [self.leads.get(tooth), self.grown.get(tooth)];
        let lists = lists.into_iter().flatten();
        slope.removed(z, width) + lists.map(|lead| lead.removed(z, width)).sum::<f64>()
    }

    /// The most that the lead of any tooth removes or adds.
    pub fn largest_lead(&self) -> f64 {
        let most = |all: f64, each: &f64| each.abs().max(all);
        let largest = |leads: &[LeadModification]| {
            let entries = leads.iter().flat_map(LeadModification::entries);
            entries.fold(0.0, most)
        };
        let slopes = self.lead_slopes.iter().fold(0.0, most);
        slopes + largest(&self.leads) + largest(&self.grown)
    }

    /// Part of [`GearDeviations::at`] that is the same all along the flank of `tooth`.
    pub fn turn(&self, tooth: usize) -> f64 {
        self.turns.get(tooth).copied().unwrap_or(0.0)
    }

    /// As [`GearDeviations::turn`] of the other flank of `tooth`, in the same sense of rotation.
    pub fn other_turn(&self, tooth: usize) -> f64 {
        let turn = self.other_turns.get(tooth).copied();
        turn.unwrap_or_else(|| self.turn(tooth))
    }

    /// The slope of [`GearDeviations::at`] by the roll length, without the trace.
    pub(crate) fn profile_slope(&self, tooth: usize) -> f64 {
        let [from, to] = self.ends;
        let amount = self.profile_slopes.get(tooth);
        amount.map_or(0.0, |amount| amount / (to - from))
    }

    /// The slope of [`GearDeviations::at`] by the roll length `s`.
    pub fn slope(&self, tooth: usize, s: f64) -> f64 {
        let trace = self.trace(tooth);
        self.profile_slope(tooth) - trace.map_or(0.0, |trace| trace.slope(s))
    }

    /// How far the eccentricity moves the loaded flank of `tooth` of `gear` along its normal at the roll length `s`, to the first order in it, in
    /// the section that is turned by `turn`.
    pub fn runout(&self, gear: &SpurGear, tooth: usize, s: f64, turn: f64) -> f64 {
        let tooth_angle = tooth as f64 * gear.pitch_angle() + turn;
        let normal = tooth_angle + gear.flank().tangent_angle(s) + PI / 2.0;
        let moved = self.displacement(0.0);
        moved.x * normal.cos() + moved.y * normal.sin()
    }

    /// Material missing from the flank of `tooth` of `gear` where involutes would touch at the roll length `s`, along the normal and to the first order:
    /// modifications, less deviations towards the mate, in the section that is turned by `turn`.
    pub fn missing(&self, gear: &SpurGear, tooth: usize, s: f64, turn: f64) -> f64 {
        gear.removed(s) - self.at(tooth, s) - self.runout(gear, tooth, s, turn)
    }

    /// Where the gear's own axis stands from the axis of rotation while the centerline of tooth 0 points along `angle`.
    pub fn displacement(&self, angle: f64) -> Vector {
        self.eccentricity
            .map_or_else(Vector::zeros, |each| each.displacement(angle))
    }

    /// How far the gear's own axis stands from the axis of rotation.
    pub fn eccentricity(&self) -> f64 {
        self.eccentricity.map_or(0.0, |each| each.amount)
    }

    /// These on flanks of `gear` that have grown, so turned as a whole that flanks on the pitch point, at the roll length `pitch`, stand in the mean where they
    /// did.
    fn growing(mut self, gear: &SpurGear, growth: &FlankGrowth, pitch: f64) -> Self {
        let teeth = growth.at_form.len();
        if teeth == 0 {
            return self;
        }
        self.ends = [gear.form_roll_length(), gear.tip_roll_length()];
        let at = |s: f64| -> Vec<f64> {
            let part = (s - self.ends[0]) / (self.ends[1] - self.ends[0]);
            let both = growth.at_form.iter().zip(&growth.to_tip);
            both.map(|(form, more)| form + part * more).collect()
        };
        let mean = |values: &[f64]| values.iter().sum::<f64>() / teeth as f64;
        let (turned, middle) = (
            mean(&at(pitch)),
            at(f64::midpoint(self.ends[0], self.ends[1])),
        );
        // A tooth that grows does so on both of its flanks, which stand out in opposite senses.
        let grown = 2.0 * mean(&middle);
        let other_turns = (0..teeth).map(|i| self.other_turn(i) + middle[i] - grown - turned);
        let other_turns = other_turns.collect();
        let turns = (0..teeth).map(|i| self.turn(i) + growth.at_form[i] - turned);
        let turns = turns.collect();
        let slope = |i: usize| self.profile_slopes.get(i).copied().unwrap_or(0.0);
        let slopes = (0..teeth).map(|i| slope(i) + growth.to_tip[i]).collect();
        Self {
            turns,
            other_turns,
            profile_slopes: slopes,
            grown: growth.along.clone(),
            ..self
        }
    }

    /// How far the point that stands out most does.
    fn farthest_out(&self) -> f64 {
        let teeth = self.turns.len().max(self.profile_slopes.len());
        let sloped = |tooth: usize| {
            let slope = self.profile_slopes.get(tooth);
            self.turn(tooth) + slope.map_or(0.0, |slope| slope.max(0.0))
        };
        let profiles = self.profiles.iter().flat_map(|traces| &traces.removed);
        let added = profiles.flat_map(Modification::entries);
        let added = added.fold(0.0, |most: f64, removed| most.max(-removed));
        (0..teeth).map(sloped).fold(0.0, f64::max) + added
    }
}

/// Traces of the profiles of a gear.
#[derive(Debug, Clone, PartialEq)]
struct Profiles {
    flank: Involute,
    /// A kink of a trace is rounded over this length to either side.
    rounded: f64,
    /// Removal of each, tooth 0 first.
    removed: Vec<Modification>,
}

/// The trace of the profile of one tooth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trace<'a> {
    profiles: &'a Profiles,
    removed: &'a Modification,
}

impl Trace<'_> {
    /// Removal at the roll length `s`.
    pub(crate) fn depth(&self, s: f64) -> f64 {
        self.removed.depth(&self.profiles.flank, s)
    }

    /// The slope of that.
    pub(crate) fn slope(&self, s: f64) -> f64 {
        self.removed.slope(&self.profiles.flank, s)
    }

    /// The same with kinks rounded, as those of modifications are.
    pub(crate) fn inclination(&self, s: f64) -> f64 {
        let half = self.profiles.rounded;
        (self.depth(s + half) - self.depth(s - half)) / (2.0 * half)
    }
}

/// Distance of the loaded flanks of a running gear from its drawing: along the normal, linear in the roll length, with a variation along the face that is the
/// same at all roll lengths. Empty lists are no growth.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FlankGrowth {
    /// At the form circle, in meters, tooth by tooth.
    at_form: Vec<f64>,
    /// By how much more at the tip circle.
    to_tip: Vec<f64>,
    /// Along the face, less the mean, as removal.
    along: Vec<LeadModification>,
}

impl FlankGrowth {
    /// Adds the growth of all lengths of `gear` by the `strain`: at the roll length s a flank then stands out by that part of s.
    pub fn add_strain(&mut self, gear: &SpurGear, strain: f64) {
        if strain == 0.0 {
            return;
        }
        let (from, to) = (gear.form_roll_length(), gear.tip_roll_length());
        let teeth = gear.tooth_count() as usize;
        self.add(vec![[strain * from, strain * (to - from)]; teeth]);
    }

    /// Adds `amount` times the displacement of the flanks of each tooth of `gear` at the rising `roll_lengths`: the line that is nearest to it, by least
    /// squares over the flank.
    pub fn add_flanks(
        &mut self,
        gear: &SpurGear,
        roll_lengths: &[f64],
        flanks: &[Vec<f64>],
        amount: f64,
    ) {
        let (from, to) = (gear.form_roll_length(), gear.tip_roll_length());
        let last = roll_lengths.len() - 1;
        let weights =
            (0..=last).map(|i| roll_lengths[(i + 1).min(last)] - roll_lengths[i.max(1) - 1]);
        let weights: Vec<f64> = weights.collect();
        let parts = roll_lengths.iter().map(|s| (s - from) / (to - from));
        let parts: Vec<f64> = parts.collect();
        let line = |values: &Vec<f64>| {
            let mut sums = [0.0; 5];
            for ((w, x), y) in weights.iter().zip(&parts).zip(values) {
                for (sum, term) in sums.iter_mut().zip([1.0, *x, x * x, *y, x * y]) {
                    *sum += w * term;
                }
            }
            let [one, x, xx, y, xy] = sums;
            let determinant = one * xx - x * x;
            [
                (y * xx - xy * x) / determinant,
                (xy * one - y * x) / determinant,
            ]
            .map(|value| amount * value)
        };
        self.add(flanks.iter().map(line).collect());
    }

    /// Adds `amount` times how far the flank of each tooth stands out at the rising `heights` beyond its mean.
    pub fn add_along(&mut self, heights: &[f64], beyond_mean: &[Vec<f64>], amount: f64) {
        let lead = |beyond: &Vec<f64>| LeadModification::Table {
            places: heights.to_vec(),
            removed: beyond.iter().map(|beyond| -amount * beyond).collect(),
        };
        self.along.extend(beyond_mean.iter().map(lead));
    }

    fn add(&mut self, lines: Vec<[f64; 2]>) {
        self.at_form.resize(lines.len(), 0.0);
        self.to_tip.resize(lines.len(), 0.0);
        for (i, [form, more]) in lines.into_iter().enumerate() {
            self.at_form[i] += form;
            self.to_tip[i] += more;
        }
    }
}

/// Deviations of the teeth of both gears of a pair: its difference from others made to the same drawings.
///
/// Contact is solved for a model of the drawn pair and these ([`crate::contact::PairModel::deviating`]).
#[derive(Debug, Clone, PartialEq)]
pub struct PairDeviations {
    gears: [GearDeviations; 2],
    /// How far they may bring any two flanks nearer to each other than they are drawn, along the line of action.
    nearest: f64,
}

impl PairDeviations {
    /// Nothing deviates.
    pub const NONE: Self = Self {
        gears: [GearDeviations::NONE, GearDeviations::NONE],
        nearest: 0.0,
    };

    /// Effect of `teeth` that fit `gears` on their flanks.
    pub(super) fn of(gears: [&SpurGear; 2], teeth: [&ToothDeviations; 2]) -> Self {
        let gears = Member::BOTH
            .map(Member::index)
            .map(|i| GearDeviations::of(gears[i], teeth[i]));
        Self::of_gears(gears)
    }

    /// These on `gears` whose flanks have grown, so turned that flanks at the roll lengths `pitch` stand in the mean where they did.
    pub(super) fn grown(
        self,
        gears: [&SpurGear; 2],
        pitch: [f64; 2],
        growth: [&FlankGrowth; 2],
    ) -> Self {
        let [driving, driven] = self.gears;
        Self::of_gears([
            driving.growing(gears[0], growth[0], pitch[0]),
            driven.growing(gears[1], growth[1], pitch[1]),
        ])
    }

    fn of_gears(gears: [GearDeviations; 2]) -> Self {
        // Off the path of contact the arm differs from one; a tenth more is more than it ever makes.
        let each = gears
            .each_ref()
            .map(|gear| 1.1 * (gear.farthest_out() + gear.eccentricity()));
        Self {
            nearest: each[0] + each[1],
            gears,
        }
    }

    /// Deviations of the gear `member`.
    pub fn of_gear(&self, member: Member) -> &GearDeviations {
        &self.gears[member.index()]
    }

    /// True if nothing deviates: the contact on rotationally symmetric blanks repeats with every mesh period.
    pub fn are_none(&self) -> bool {
        self.gears.iter().all(GearDeviations::is_none)
    }

    /// How far they may bring any two flanks nearer to each other than they are drawn, along the line of action.
    pub fn nearest(&self) -> f64 {
        self.nearest
    }
}

impl Default for PairDeviations {
    fn default() -> Self {
        Self::NONE
    }
}
