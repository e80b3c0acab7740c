//! Warnings to read with the numbers of a result.

use super::at_speed::CurveDynamics;
use super::case::Model;
use super::{Case, Curve, Method, Statistics};
use crate::contact::MeshContact;
use crate::dynamics::ForceTable;
use crate::gear::{GearPair, Member, SpurGear};
use crate::load_distribution::{FormulaRange, out_of_range};

/// Backlash below this, in modules, counts as none.
const NO_BACKLASH: f64 = 1e-6;

/// Tip clearance below that of the racks by more than this, in modules, gives a warning.
const LOST_TIP_CLEARANCE: f64 = 0.05;

/// The least clearance that racks leave, in modules, where their addendum is not known because a tip diameter is given.
const CLEARANCE_OF_RACKS: f64 = 0.2;

/// Ratio of the face widths above which plane models are warned of: the load spreads over the wider gear's width by bending it, which
/// a plane does not see.
const LIKE_WIDTHS: f64 = 1.5;

/// Parts of the mean and of the peak-to-peak beyond which the error of the projected decomposition gives a warning. Its users look at the effect of holes on
/// the fluctuation; at single positions it is off by 4 % of that on case 1 of the paper, in its statistics by 0.1 %.
const DOUBTFUL_PROJECTION: [f64; 2] = [0.01, 0.05];

/// Part of the peak-to-peak above which the remainder of the decomposition's fits to the turn of holed blanks gives a warning.
const DOUBTFUL_DECOMPOSITION: f64 = 0.05;

/// Positions a mesh period below which there is a warning of orders: each position gives half a mesh harmonic, and the upper ones badly.
pub const FEW_POSITIONS: u32 = 20;

/// Part of the peak-to-peak, and length in meters, above which the estimated error between positions is warned of.
pub const OPEN_PEAK_TO_PEAK: (f64, f64) = (0.02, 1e-9);

/// Part of the largest load of a table above which forces are warned of; up to this ratio the difference is rounding.
const BEYOND: f64 = 1.0 + 1e-9;

/// From this part on by which the natural frequency is another with the inertia of rims and teeth where it is, there is a warning: the estimate is as good.
const RIMS_MATTER: f64 = 0.05;

/// A curve that fluctuates by a smaller part of its mean counts as one that fluctuates by so much: less is no concern of anyone.
const LEAST_FLUCTUATION: f64 = 1e-3;

/// From this part of the face width on for a web, and from this number of modules on for the rim around it, the plane model holds, judged by the effect of both
/// on the variation of the transmission error; webs below the second part, and rims below the second number, are outside of a plane model.
pub const PLANE_WEB: [f64; 2] = [0.4, 0.2];
/// See [`PLANE_WEB`].
pub const PLANE_RIM: [f64; 2] = [3.5, 2.0];

/// A warning to read with the numbers of the result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Warning {
    /// The teeth fit without any backlash; only the loaded flanks are solved.
    ZeroBacklash {
        /// By how much the other flanks are moved back, in meters, because the last printed digits leave no room.
        moved_back: f64,
    },
    /// Less room between the tips of a gear and the root circle of the other one than the racks leave.
    SmallTipClearance {
        /// The gear whose tips they are.
        member: Member,
        /// The clearance in meters.
        clearance: f64,
        /// The clearance that the racks leave, dedendum less addendum, in meters.
        of_racks: f64,
        /// By how much gear programs shorten the tips of both gears, in meters, and the tip diameters that follow, driving and driven; none where the racks
        /// themselves leave no more.
        shortened: Option<(f64, [f64; 2])>,
    },
    /// The rack undercuts the flanks of a gear so far that its mate's tips pass below them: the path of contact is shorter.
    UndercutShortensPath {
        /// The gear that is undercut.
        member: Member,
        /// The roll length that is lost, in meters.
        roll_length: f64,
    },
    /// Material around the holes thinner than one module.
    ThinLigament {
        /// The gear.
        member: Member,
        /// The ligament in meters.
        ligament: f64,
    },
    /// The motion grows without bound at some speeds.
    MotionUnbounded {
        /// The lowest and the highest of these speeds of the driving gear, in revolutions per second.
        speeds: [f64; 2],
    },
    /// The motion is largest at the first or the last of the speeds asked for: beyond it may be more.
    MotionAtEndOfSpeeds {
        /// The speed of the driving gear, in revolutions per second.
        speed: f64,
        /// True if it is the lowest one.
        is_lowest: bool,
        /// The largest less the smallest transmission error there, in m.
        peak_to_peak: f64,
    },
    /// The motion loads the mesh beyond the force table, which goes on straight there.
    LoadBeyondForceTable {
        /// The lowest and the highest of these speeds of the driving gear, in revolutions per second.
        speeds: [f64; 2],
        /// The largest force over the largest load of the table.
        ratio: f64,
        /// The output torque of the largest load of the table, in N m.
        largest_output_torque: f64,
    },
    /// Rims and teeth have inertia outside the webs that carry them, which the motion takes to stand on the hubs.
    RimInertiaOnHub {
        /// The natural frequency of the motion in Hz.
        natural_frequency: f64,
        /// The same with the inertia where it is, about.
        of_rims: f64,
    },
    /// A tip corner carries load off the line of action.
    TipCornerContact {
        /// The gear whose tip touches.
        member: Member,
        /// The largest share of the load that such a contact carries.
        largest_share: f64,
    },
    /// The contact reaches the fillet of a gear, where it is not followed: the load at its end is wrong.
    ContactReachesFillet {
        /// The gear whose fillet is reached.
        member: Member,
    },
    /// A web or the rim around it is thinner than a plane model can stand for.
    WebOutsidePlaneModel {
        /// The gear.
        member: Member,
        /// The thickness of the web over the face width.
        web: f64,
        /// The rim between web and root circle, in modules.
        rim: f64,
    },
    /// The face widths differ by more than a plane model can stand for.
    FaceWidthsDiffer {
        /// The larger over the smaller.
        ratio: f64,
    },
    /// The contact presses so hard that the material of a gear does not stay linear.
    ContactBeyondElasticity {
        /// The gear that bears less.
        member: Member,
        /// The largest contact pressure in Pa.
        pressure: f64,
        /// Up to which it stays linear, in Pa.
        limit: f64,
    },
    /// The largest contact pressure stands at a kink of a profile modification, which a run-in would round.
    PressureAtKink {
        /// The gear whose profile has the kink.
        member: Member,
        /// The diameter at which the kink stands, in meters.
        diameter: f64,
        /// The pressure in Pa.
        pressure: f64,
    },
    /// Too few positions a mesh period: the orders of its higher multiples are wrong, or the peak-to-peak is open.
    FewPositions {
        /// The positions.
        positions: u32,
        /// How much of the peak-to-peak of δ they leave open, where it is more than [`OPEN_PEAK_TO_PEAK`]: the estimate of the curve of which it is most.
        open: Option<f64>,
    },
    /// The span is not whole true periods: statistics are partial and there is no spectrum.
    PartialSpan {
        /// Mesh periods computed.
        span: u32,
        /// Mesh periods of the true period.
        period: u32,
    },
    /// A formula is used outside the range for which it was published.
    FormulaRange(FormulaRange),
    /// The method does not see holes that the drawing has.
    HolesNotSeen,
    /// A gear comes loose from the shaft that it is pressed onto, and is computed as free from it.
    FitComesLoose {
        /// The gear.
        member: Member,
        /// The speed of the driving gear from which the mean pressure of the fit is gone, in revolutions per second.
        speed: f64,
    },
    /// The remainder of the projected decomposition's first-order term shows in its curve.
    ProjectionDoubtful {
        /// The largest difference to the exact δ that was found, in meters.
        error: f64,
        /// Its part of the mean of the curve.
        part_of_mean: f64,
        /// Its part of the peak-to-peak of the curve.
        part_of_peak_to_peak: f64,
    },
    /// The remainder of one harmonic for each holed blank shows in the curve of the decomposition.
    DecompositionDoubtful {
        /// The largest difference to the exact δ that was found, in meters.
        error: f64,
        /// Its part of the peak-to-peak of the curve.
        part_of_peak_to_peak: f64,
    },
}

/// Warnings of a case before it is computed.
pub fn warnings(case: &Case) -> Vec<Warning> {
    let pair = &case.pair;
    let mut warnings = Vec::new();
    let moved_back = pair.moved_back();
    if moved_back > 0.0 || pair.backlash() < NO_BACKLASH * pair.driving().data().rack.module {
        warnings.push(Warning::ZeroBacklash { moved_back });
    }
    for member in Member::BOTH {
        let gear = pair.gear(member);
        warnings.extend(small_tip_clearance(pair, member));
        let roll_length = pair.lost_to_undercut(member);
        if roll_length > 0.0 {
            warnings.push(Warning::UndercutShortensPath {
                member,
                roll_length,
            });
        }
        if let Some(ligament) = gear
            .least_ligament()
            .filter(|&ligament| ligament < gear.data().rack.module)
        {
            warnings.push(Warning::ThinLigament { member, ligament });
        }
        // The method of closed forms takes no web into its numbers.
        if case.method() != Method::LoadDistribution && case.faces().is_none() {
            warnings.extend(web_outside_plane(gear, member));
        }
    }
    let widths = [pair.driving().face_width(), pair.driven().face_width()];
    let ratio = widths[0].max(widths[1]) / pair.common_face_width();
    if ratio > LIKE_WIDTHS && case.faces().is_none() {
        warnings.push(Warning::FaceWidthsDiffer { ratio });
    }
    if !case.covers_whole_periods() {
        warnings.push(Warning::PartialSpan {
            span: case.span(),
            period: pair.period(),
        });
    }
    let positions = case.resolution.positions_per_mesh_period;
    if positions < FEW_POSITIONS {
        warnings.push(Warning::FewPositions {
            positions,
            open: None,
        });
    }
    if let Model::Formulas(formulas) = case.model {
        if !case.holed().is_empty() {
            warnings.push(Warning::HolesNotSeen);
        }
        let torques = case.output_torques.iter().copied();
        let least = torques.fold(f64::INFINITY, f64::min);
        let outside = out_of_range(pair, formulas, least);
        warnings.extend(outside.into_iter().map(Warning::FormulaRange));
    }
    warnings
}

/// Warns of tips that stand nearer to the root circle of the other gear than the racks leave them: those of gears that nobody shortened.
fn small_tip_clearance(pair: &GearPair, member: Member) -> Option<Warning> {
    let clearance = pair.tip_clearance(member);
    let module = pair.gear(member).normal_rack().module;
    let dedendum = |member: Member| pair.gear(member.other()).data().rack.dedendum;
    let of_racks = dedendum(member) - addendum_of_rack(pair, member);
    // The rounding of a value typed at the limit is not below it.
    let is_lost = of_racks - clearance > LOST_TIP_CLEARANCE * module * (1.0 + 1e-9);
    let shortening = pair.usual_tip_shortening();
    is_lost.then(|| Warning::SmallTipClearance {
        member,
        clearance,
        of_racks,
        shortened: (shortening > 0.0).then(|| {
            let shorter = |member| {
                let gear = pair.gear(member);
                let done = addendum_of_rack(pair, member) - gear.data().rack.addendum;
                2.0 * (gear.tip_radius() - (shortening - done).max(0.0))
            };
            (shortening, Member::BOTH.map(shorter))
        }),
    })
}

/// The addendum of the rack of `member`. Where it is less than a module the tips may have been shortened: it is a module then, as far as the dedendum of the
/// other gear leaves [`CLEARANCE_OF_RACKS`].
fn addendum_of_rack(pair: &GearPair, member: Member) -> f64 {
    let gear = pair.gear(member);
    let module = gear.normal_rack().module;
    let room = pair.gear(member.other()).data().rack.dedendum - CLEARANCE_OF_RACKS * module;
    gear.data().rack.addendum.max(module.min(room))
}

/// Warns of a web and a rim that a plane takes for stiffer than they are.
fn web_outside_plane(gear: &SpurGear, member: Member) -> Option<Warning> {
    let drawn = gear
        .data()
        .blank
        .web
        .filter(|web| web.thickness < gear.face_width())?;
    let web = drawn.thickness / gear.face_width();
    let rim = (gear.root_radius() - drawn.outer_radius) / gear.data().rack.module;
    // The rounding of a value typed at the limit is not below it.
    let below = |value: f64, [limit, _]: [f64; 2]| value < limit * (1.0 - 1e-9);
    (below(web, PLANE_WEB) || below(rim, PLANE_RIM)).then_some(Warning::WebOutsidePlaneModel {
        member,
        web,
        rim,
    })
}

/// Warns of tips that touch off the path of contact, and of contact that reaches a fillet.
pub(super) fn warn_of_tips(warnings: &mut Vec<Warning>, contacts: &[MeshContact]) {
    for member in Member::BOTH {
        let mut pairs = contacts.iter().flat_map(|contact| &contact.pairs);
        let warning = Warning::ContactReachesFillet { member };
        if pairs.any(|pair| pair.fillet == Some(member)) && !warnings.contains(&warning) {
            warnings.push(warning);
        }
        let shares = contacts
            .iter()
            .flat_map(|contact| &contact.pairs)
            .filter(|pair| pair.tip_corner == Some(member))
            .map(|pair| pair.share);
        let largest_share = shares.fold(0.0, f64::max);
        if largest_share > 0.0 {
            warn_of_corner(warnings, member, largest_share);
        }
    }
}

/// Warns of a tip corner, once for each gear.
pub(super) fn warn_of_corner(warnings: &mut Vec<Warning>, member: Member, share: f64) {
    for warning in &mut *warnings {
        if let Warning::TipCornerContact {
            member: known,
            largest_share,
        } = warning
            && *known == member
        {
            *largest_share = largest_share.max(share);
            return;
        }
    }
    warnings.push(Warning::TipCornerContact {
        member,
        largest_share: share,
    });
}

/// Warns of an `error` of the projected decomposition that shows in a curve with these `statistics`; of the largest error once.
pub(super) fn warn_of_projection(warnings: &mut Vec<Warning>, error: f64, statistics: &Statistics) {
    let mean = statistics.mean.abs().max(f64::MIN_POSITIVE);
    let parts = [
        error / mean,
        error / statistics.peak_to_peak.max(LEAST_FLUCTUATION * mean),
    ];
    if parts[0] <= DOUBTFUL_PROJECTION[0] && parts[1] <= DOUBTFUL_PROJECTION[1] {
        return;
    }
    let larger = |warning: &Warning| matches!(warning, Warning::ProjectionDoubtful { error: known, .. } if *known >= error);
    if !warnings.iter().any(larger) {
        warnings.retain(|warning| !matches!(warning, Warning::ProjectionDoubtful { .. }));
        warnings.push(Warning::ProjectionDoubtful {
            error,
            part_of_mean: parts[0],
            part_of_peak_to_peak: parts[1],
        });
    }
}

/// Warns of an `error` of the decomposition that shows in a curve with these `statistics`; of that which shows most once.
pub(super) fn warn_of_decomposition(
    warnings: &mut Vec<Warning>,
    error: f64,
    statistics: &Statistics,
) {
    let least = LEAST_FLUCTUATION * statistics.mean.abs().max(f64::MIN_POSITIVE);
    let part = error / statistics.peak_to_peak.max(least);
    let more = |warning: &Warning| matches!(warning, Warning::DecompositionDoubtful { part_of_peak_to_peak, .. } if *part_of_peak_to_peak >= part);
    if part <= DOUBTFUL_DECOMPOSITION || warnings.iter().any(more) {
        return;
    }
    warnings.retain(|warning| !matches!(warning, Warning::DecompositionDoubtful { .. }));
    warnings.push(Warning::DecompositionDoubtful {
        error,
        part_of_peak_to_peak: part,
    });
}

/// Warns of a `curve` whose positions leave its peak-to-peak open; of that which leaves most once.
pub(super) fn warn_of_positions(warnings: &mut Vec<Warning>, case: &Case, curve: &Curve) {
    let error = curve.sampling_error.peak_to_peak;
    let (part, least) = OPEN_PEAK_TO_PEAK;
    let found = error / curve.transmission_error_statistics.peak_to_peak;
    if error <= least || found.is_nan() || found <= part {
        return;
    }
    for warning in &mut *warnings {
        if let Warning::FewPositions { open, .. } = warning {
            *open = Some(open.map_or(found, |known| known.max(found)));
            return;
        }
    }
    warnings.push(Warning::FewPositions {
        positions: case.resolution.positions_per_mesh_period,
        open: Some(found),
    });
}

/// Warns of pressures that a material does not bear in proportion, and of those at kinks.
pub(super) fn warn_of_pressures(warnings: &mut Vec<Warning>, case: &Case, curves: &[Curve]) {
    let limits = Member::BOTH.map(|member| {
        let material = case.pair.gear(member).material();
        (member, material.elastic_contact_pressure())
    });
    let [driving, driven] = limits;
    let (member, limit) = if driven.1 < driving.1 {
        driven
    } else {
        driving
    };
    let pressures = curves.iter().flat_map(|curve| {
        let largest = curve.pressures.largest.map(|largest| largest.pressure);
        let at_positions = curve.peak_contact_pressure.iter().flatten().copied();
        at_positions.chain(largest)
    });
    let pressure = pressures.fold(0.0, f64::max);
    if pressure > limit {
        warnings.push(Warning::ContactBeyondElasticity {
            member,
            pressure,
            limit,
        });
    }
    let largest = curves.iter().filter_map(|curve| curve.pressures.largest);
    let at_kinks = largest.filter_map(|largest| Some((largest, largest.kink(&case.pair)?)));
    let worst = at_kinks.max_by(|(one, _), (other, _)| one.pressure.total_cmp(&other.pressure));
    warnings.extend(
        worst.map(|(largest, (member, diameter))| Warning::PressureAtKink {
            member,
            diameter,
            pressure: largest.pressure,
        }),
    );
}

/// Warns of speeds at which the motion grows without bound or loads the mesh beyond its `table`, whose loads are those of the base radius `driven`, and of
/// inertia that stands elsewhere than the motion has it.
pub(super) fn warn_of_motions(
    warnings: &mut Vec<Warning>,
    dynamics: &[CurveDynamics],
    (table, driven): (&ForceTable, f64),
) {
    let largest = table.loads().last().copied().unwrap_or(f64::INFINITY);
    let seen = dynamics.iter().flat_map(|of| {
        let branches = [&of.run_up.up, &of.run_up.down].into_iter().flatten();
        branches.flat_map(|branch| {
            let seen = branch.runs_away.iter().zip(&branch.largest_force);
            seen.zip(&of.speeds)
                .map(|((runs_away, force), speed)| (*speed, (!runs_away).then(|| force / largest)))
        })
    });
    // Speeds, and the largest force as a multiple of the table's largest load; `None` where the motion is not bounded.
    let seen: Vec<(f64, Option<f64>)> = seen.collect();
    let unbounded = seen.iter().filter(|(_, ratio)| ratio.is_none());
    let found = ends(unbounded.map(|(speed, _)| *speed));
    warnings.extend(found.map(|speeds| Warning::MotionUnbounded { speeds }));
    let beyond = || seen.iter().filter(|(_, ratio)| *ratio > Some(BEYOND));
    let found = ends(beyond().map(|(speed, _)| *speed));
    warnings.extend(found.map(|speeds| Warning::LoadBeyondForceTable {
        speeds,
        ratio: beyond().filter_map(|(_, ratio)| *ratio).fold(0.0, f64::max),
        largest_output_torque: largest * driven,
    }));
    let at_end = dynamics.iter().filter_map(largest_at_end);
    let most = at_end.max_by(|a, b| a.2.total_cmp(&b.2));
    warnings.extend(most.map(
        |(speed, is_lowest, peak_to_peak)| Warning::MotionAtEndOfSpeeds {
            speed,
            is_lowest,
            peak_to_peak,
        },
    ));
    let off = dynamics.iter().filter_map(|of| {
        let (natural_frequency, of_rims) = (
            of.run_up.natural_frequencies[0],
            of.natural_frequency_of_rims?,
        );
        let off = (of_rims / natural_frequency - 1.0).abs();
        (off > RIMS_MATTER).then_some((off, natural_frequency, of_rims))
    });
    let most = off.max_by(|a, b| a.0.total_cmp(&b.0));
    warnings.extend(
        most.map(|(_, natural_frequency, of_rims)| Warning::RimInertiaOnHub {
            natural_frequency,
            of_rims,
        }),
    );
}

/// The first or the last of several speeds, if the motion is largest there: whether it is the first, and the peak-to-peak value. Below standstill is nothing.
fn largest_at_end(of: &CurveDynamics) -> Option<(f64, bool, f64)> {
    let [first, .., last] = of.speeds[..] else {
        return None;
    };
    let branches = [&of.run_up.up, &of.run_up.down].into_iter().flatten();
    let all = branches.flat_map(|branch| of.speeds.iter().zip(&branch.peak_to_peak));
    let (speed, peak_to_peak) = all.max_by(|a, b| a.1.total_cmp(b.1))?;
    let is_lowest = *speed == first;
    let is_end = is_lowest && first > 0.0 || *speed == last;
    is_end.then_some((*speed, is_lowest, *peak_to_peak))
}

/// The lowest and the highest of `speeds`.
fn ends(speeds: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    speeds.fold(None, |ends, speed| {
        let [low, high] = ends.unwrap_or([speed; 2]);
        Some([low.min(speed), high.max(speed)])
    })
}
