//! A population: members of a design as they are made, each drawn from laws.
//!
//! A member is known by its number alone: `document` declares the laws, and `reading` finds their faults; `Population` draws a member, and
//! [`population_results`](crate::population_results) has the statistics of the members' results.

pub(crate) mod document;
mod reading;
#[cfg(test)]
mod tests;

use meshwright_engine::analysis::Method;
use meshwright_engine::gear::{Helix, Inspection, Member, Normals, Passed, SpurGear};
use meshwright_engine::run::Run;
use meshwright_wire::declare::{Choice as _, Errors, Node};
use meshwright_wire::draw::Accuracy;
use meshwright_wire::gear::{DeviationsDocument, GearDocument};
use meshwright_wire::pair::PairDocument;
use meshwright_wire::pointer::Pointer;
use meshwright_wire::resolution::sees_faces;
use meshwright_wire::submission::Windows;
use meshwright_wire::units::significant;
use serde_json::{Value, json};

use crate::sample::law::Law;
use crate::sample::normal;
use crate::sample::points::Points;
use document::{GearAccuracy, MembersDepth};

pub(crate) use document::{PopulationDocument, WindowDocument};
pub(crate) use reading::{number_at, rises};

/// Members drawn from laws. Each law has been checked, and its field takes a number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Population {
    size: u32,
    pub(crate) points: Points,
    varied: Vec<Varied>,
    /// Where the tools of members stand whose thickness varies.
    generating_profile_shift: MembersDepth,
    /// Of each gear, driving and driven: how accurately it is made.
    pub(crate) accuracy: [Option<GearAccuracy>; 2],
    /// Over what parts of their true periods members are computed, if not by the base.
    pub(crate) windows: Option<Windows>,
}

/// A field and its law.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Varied {
    pub(crate) path: Pointer,
    pub(crate) law: Law,
    /// True if the field takes whole numbers, to which values are rounded.
    whole: bool,
}

impl Varied {
    /// The value of the field for a number between 0 and 1.
    fn at(&self, u: f64) -> f64 {
        let value = self.law.quantile(u);
        if self.whole {
            value.round()
        } else {
            // Digits that are the same on every machine that adds them up.
            significant(value, 12)
        }
    }

    /// A value of the field as JSON has it.
    pub(crate) fn json_of(&self, value: f64) -> Value {
        if self.whole {
            json!(value as i64)
        } else {
            json!(value)
        }
    }

    /// The value in the middle of its law.
    pub(crate) fn median(&self) -> f64 {
        self.at(0.5)
    }
}

/// A source of the differences between members, whose share of the variance is estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Source<'a> {
    /// A field.
    Field(&'a Pointer),
    /// All teeth of a gear together.
    Teeth(Member),
}

pub(crate) const GEARS: [Member; 2] = [Member::Driving, Member::Driven];

/// The gear's number among two.
const _: () = assert!(Member::Driving as usize == 0 && Member::Driven as usize == 1);

impl Population {
    /// The number of members.
    pub(crate) fn size(&self) -> usize {
        self.size as usize
    }

    /// The fields that are varied.
    pub(crate) fn varied(&self) -> &[Varied] {
        &self.varied
    }

    /// True if the teeth of `gear` are drawn.
    pub(crate) fn draws_teeth_of(&self, gear: Member) -> bool {
        self.accuracy[gear as usize].is_some()
    }

    /// Values of a member's varied fields, in their order.
    pub(crate) fn values(&self, member: u32) -> Vec<f64> {
        let axes = self.varied.iter().zip(0..);
        axes.map(|(varied, axis)| varied.at(self.points.at(member, axis)))
            .collect()
    }

    /// Gives the gears of `pair`, a member written as `node`, the generating profile shift of the drawn gear where their thickness varies: that with the middle of
    /// its laws. A gear that says its generating profile shift by itself keeps that.
    pub(crate) fn keep_roots(&self, node: &Node, pair: &mut PairDocument) {
        if self.generating_profile_shift == MembersDepth::ByThickness {
            return;
        }
        for gear in GEARS {
            let mut drawn = node.clone();
            let of_thickness = self.varied.iter().filter(|varied| {
                let mut fields = GearDocument::THICKNESS.iter();
                fields.any(|field| varied.path.starts_with(&["pair", gear.word(), field]))
            });
            let mut varies = false;
            for varied in of_thickness {
                varies = true;
                drawn.put(varied.path.steps(), Node::Number(varied.median()));
            }
            let drawn = drawn.at(&["pair", gear.word()]).filter(|_| varies);
            let Some(drawn) = drawn.and_then(GearDocument::at) else {
                continue;
            };
            let x_e = drawn.tool_shift(pair.helix(gear));
            pair.gear_mut(gear)
                .keep_generating_profile_shift(significant(x_e, 12));
        }
    }

    /// Gives the gears of a member their teeth, with slopes of their leads for a `method` that takes the faces into account; faults of a gear are reported to
    /// `errors`.
    pub(crate) fn give_teeth(
        &self,
        member: u32,
        pair: &mut PairDocument,
        method: Method,
        errors: &Errors,
    ) -> Option<()> {
        for gear in GEARS {
            let Some(accuracy) = &self.accuracy[gear as usize] else {
                continue;
            };
            let helix = pair.helix(gear);
            let document = pair.gear_mut(gear);
            let made = document.clone().without_deviations();
            let made = errors.report(made.to_gear(&format!("/pair/{gear}"), helix))?;
            let accuracy = accuracy.of(&made);
            let mut passed = self.teeth(member, gear, &accuracy);
            if method.sees_faces()
                && let Some(own) = &mut passed
            {
                let leads = self.lead_slopes(member, gear, &accuracy);
                match leads {
                    Some(leads) => own.teeth.lead_slope = leads.teeth.lead_slope,
                    None => passed = None,
                }
            }
            let Some(Passed { teeth, .. }) = passed else {
                errors.push(accuracy.none_passed(&format!("/pair/{gear}/tooth_deviations")));
                return None;
            };
            document.set_deviations(DeviationsDocument::of(&teeth));
        }
        Some(())
    }

    /// The teeth that `gear` has in a member; none if none of very many gears passes.
    ///
    /// The eccentricity is two numbers that act on the whole: they have axes of the points, behind those of the fields. The teeth are hundreds
    /// of numbers of which none matters by itself: they are random, and so is all of a gear that is drawn again.
    pub(crate) fn teeth(&self, member: u32, gear: Member, accuracy: &Accuracy) -> Option<Passed> {
        let drawn = self.drawn_for(member, gear);
        let first = self.varied.len() as u32 + 2 * gear as u32;
        let teeth = 2 * accuracy.inspection.tooth_count() as usize;
        accuracy.teeth(|attempt| {
            let mut normals = self.normals(1, drawn, gear, attempt);
            let own: Vec<f64> = normals.by_ref().take(teeth).collect();
            let eccentricity = if attempt == 0 {
                [first, first + 1].map(|axis| normal::quantile(self.points.at(drawn, axis)))
            } else {
                std::array::from_fn(|_| normals.next().unwrap_or_default())
            };
            own.into_iter().chain(eccentricity)
        })
    }

    /// How the leads of that gear slope, by numbers of their own: the same teeth have them and have them not.
    pub(crate) fn lead_slopes(
        &self,
        member: u32,
        gear: Member,
        accuracy: &Accuracy,
    ) -> Option<Passed> {
        let drawn = self.drawn_for(member, gear);
        accuracy.lead_slopes(|attempt| self.normals(3, drawn, gear, attempt))
    }

    /// The numbers for an attempt at `gear` as it is `drawn` for a member; those from another `first` stream are independent.
    fn normals(&self, first: u64, drawn: u32, gear: Member, attempt: u32) -> Normals {
        let stream = (u64::from(gear as u8) + first) << 32 | u64::from(drawn);
        Normals::of_attempt(u64::from(self.points.seed), stream, attempt)
    }

    /// The member for which the gear of `member` was drawn first: every gear of some batches is in two pairs, so that the common part of two pairs of one gear
    /// gives the gear's share of the variance.
    fn drawn_for(&self, member: u32, gear: Member) -> u32 {
        if self.is_shared(member, gear) {
            member.min(crate::sample::partner(member))
        } else {
            member
        }
    }

    /// True if the partner of `member` has the same `gear`. Where both gears are drawn they take turns, batch by batch.
    pub(crate) fn is_shared(&self, member: u32, gear: Member) -> bool {
        let drawn: Vec<Member> = GEARS
            .into_iter()
            .filter(|gear| self.draws_teeth_of(*gear))
            .collect();
        // Where nothing else differs the gear makes all of the variance, and two pairs of it would be one.
        let alone = drawn.len() == 1 && self.varied.is_empty();
        !alone && !drawn.is_empty() && drawn[crate::sample::batch(member) % drawn.len()] == gear
    }

    /// Everything that differs between members and of which it is known how much of the variance it makes.
    ///
    /// Gears that pass an inspection follow one law, and two pairs of one gear give its share of the variance. Where its tolerances differ between members, two
    /// of them may not get the same gear.
    pub(crate) fn sources(&self) -> Vec<Source<'_>> {
        let fields = self.varied.iter().map(|varied| Source::Field(&varied.path));
        let is_of_one_law = |gear: &Member| {
            let accuracy = self.accuracy[*gear as usize].as_ref();
            accuracy.is_some_and(|accuracy| !accuracy.inspected || !self.varies_tolerances(*gear))
        };
        let teeth = GEARS.into_iter().filter(is_of_one_law);
        fields.chain(teeth.map(Source::Teeth)).collect()
    }

    /// How accurately the gears of a base are made; none where they are not drawn, or a gear cannot be made.
    pub(crate) fn accuracies(&self, base: &Node) -> [Option<Accuracy>; 2] {
        GEARS.map(|gear| {
            let accuracy = self.accuracy[gear as usize].as_ref()?;
            let document = GearDocument::at(base.at(&["pair", gear.word()])?)?;
            let angle = match base.at(&["pair", "helix_angle_deg"]) {
                Some(Node::Number(angle)) => Some(*angle),
                _ => None,
            };
            let helix = Helix::right(angle.unwrap_or(0.0).to_radians());
            let made = document.without_deviations().to_gear("", helix).ok()?;
            Some(accuracy.of(&made))
        })
    }

    /// Refuses gears of a base, which has the middle of each law, of which fewer than one in a hundred would pass the inspection, at the place `at` of the
    /// population.
    pub(crate) fn refuse_hopeless(&self, base: &Node, at: &str, errors: &Errors, run: &Run) {
        let sees_faces = base.at(&["method"]).is_some_and(sees_faces);
        for (gear, accuracy) in GEARS.into_iter().zip(self.accuracies(base)) {
            if let Some(accuracy) = accuracy {
                let pointer = format!("{at}/accuracy/{gear}/capability");
                accuracy.refuse_hopeless(sees_faces, &pointer, errors, run);
            }
        }
    }

    /// True if a field of `gear` is varied, on which the measurement of its teeth may depend.
    pub(crate) fn varies(&self, gear: Member) -> bool {
        let mut paths = self.varied.iter().map(|varied| &varied.path);
        paths.any(|path| path.starts_with(&["pair", gear.word()]))
    }

    /// True if the tolerances of `gear` differ between members, because the size of its teeth is varied.
    fn varies_tolerances(&self, gear: Member) -> bool {
        const SIZES: [&str; 4] = [
            "tooth_count",
            "module_mm",
            "pressure_angle_deg",
            "face_width_mm",
        ];
        let mut paths = self.varied.iter().map(|varied| &varied.path);
        paths.any(|path| {
            let of_gear = SIZES
                .iter()
                .any(|size| path.starts_with(&["pair", gear.word(), size]));
            of_gear || path.starts_with(&["pair", "helix_angle_deg"])
        })
    }
}

impl GearAccuracy {
    /// That of `gear`.
    fn of(&self, gear: &SpurGear) -> Accuracy {
        Accuracy {
            inspection: Inspection::of(gear, self.iso_1328_class),
            capability: self.capability,
            is_inspected: self.inspected,
        }
    }
}
