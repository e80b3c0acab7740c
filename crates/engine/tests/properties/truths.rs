//! The properties, each with a figure that must stay below its bound.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use meshwright_engine::analysis::{
    Analysis, Case, ContactSolver, Curve, Warning, analyze, pair_model,
};
use meshwright_engine::contact::MeshContact;
use meshwright_engine::gear::{
    GearData, GearPair, HoleShape, Member, ModificationData, PlaneState, ReliefStart, SpurGear,
    TablePlaces, TipEdge, ToothDeviations, Vector,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_engine::substructures::{hertz, logarithm_factor};

use crate::cases::{self, Made};
use crate::drawn::DrawnPair;

/// What must hold of a drawn pair.
pub(crate) struct Truth {
    /// What it says.
    pub(crate) name: &'static str,
    /// What its figure may be at most.
    pub(crate) bound: f64,
    /// By how much the pair departs from it; `None` where it says nothing of this pair. Parts of gears come from the library.
    pub(crate) figure: fn(&DrawnPair, &Library) -> Result<Option<f64>, String>,
}

pub(crate) const TRUTHS: &[Truth] = &[
    Truth {
        name: "no_flank_penetrates",
        // Over the deflection: where stretches of flank overlap two cells, of which pressures are even.
        bound: 2e-3,
        figure: penetration,
    },
    Truth {
        name: "the_pair_that_touches_first_carries",
        bound: 0.0,
        figure: first_touch_unloaded,
    },
    Truth {
        name: "all_lengths_times_s_and_the_torque_times_s_cubed_make_delta_times_s",
        bound: 1e-9,
        figure: similarity,
    },
    Truth {
        name: "all_moduli_and_the_torque_times_c_leave_delta",
        bound: 1e-9,
        figure: scaled_moduli,
    },
    Truth {
        name: "driver_and_driven_swapped_are_mirror_images",
        // Over the deflection: the arms of a wide contact change within it.
        bound: 2e-3,
        figure: swapped,
    },
    Truth {
        name: "holes_turned_by_their_pitch_are_the_same_holes",
        bound: 1e-9,
        figure: turned_by_hole_pitch,
    },
    Truth {
        name: "a_blank_turned_by_one_tooth_moves_the_curve_by_one_mesh_period",
        bound: 1e-9,
        figure: turned_by_tooth,
    },
    Truth {
        name: "delta_grows_with_the_torque",
        bound: 0.0,
        figure: not_monotone,
    },
    Truth {
        name: "the_curve_has_no_jump",
        // What a step of 1/24 mesh period leaves, as a part of δ, after fourteen halvings into the steeper half.
        bound: 2e-4,
        figure: jump,
    },
    Truth {
        name: "a_lone_contact_is_hertz",
        bound: 0.02,
        figure: beside_hertz,
    },
    Truth {
        name: "both_contact_solvers_agree",
        bound: 1e-6,
        figure: between_solvers,
    },
    Truth {
        name: "halving_every_element_changes_little",
        // As parts of what the standard level may be off: 0.1 % of the mean, 1 % of the peak-to-peak or 0.1 % of the mean where
        // that is more.
        bound: 1.0,
        figure: standard_beside_fine,
    },
];

/// Positions in the one mesh period that most properties look at.
const POSITIONS: u32 = 8;

/// One mesh period of `pair` on coarse grids.
pub(crate) fn case(pair: &GearPair, output_torques: &[f64]) -> Case {
    let mut case = cases::case(pair.clone(), output_torques);
    case.resolution.positions_per_mesh_period = POSITIONS;
    case.resolution.span_mesh_periods = Some(1);
    case.resolution.grid = GridLevel::Coarse;
    case
}

pub(crate) fn solve(case: &Case, library: &Library) -> Result<Analysis, String> {
    analyze(case, library, &Run::unattended()).map_err(|error| {
        let cause = std::error::Error::source(&error).map(ToString::to_string);
        format!("{error} {}", cause.unwrap_or_default())
    })
}

fn curve(pair: &GearPair, torque: f64, library: &Library) -> Result<Curve, String> {
    Ok(solve(&case(pair, &[torque]), library)?.curves.remove(0))
}

fn model(pair: &GearPair, library: &Library) -> Result<Made, String> {
    pair_model(&case(pair, &[1.0]), library, &Run::unattended())
        .map(|model| Made::new(pair.clone(), model))
        .map_err(|error| error.to_string())
}

fn contact(model: &Made, eta: f64, load: f64) -> Result<MeshContact, String> {
    model
        .contact(eta, load)
        .map_err(|error| format!("at {eta}: {error}"))
}

/// A model whose drawing is changed by `change`.
fn changed(
    pair: &GearPair,
    distance: f64,
    change: impl Fn(&mut GearData, Member),
) -> Result<GearPair, String> {
    let gear = |member: Member| {
        let mut data = pair.gear(member).data().clone();
        change(&mut data, member);
        SpurGear::new(data).map_err(|error| error.to_string())
    };
    GearPair::new(gear(Member::Driving)?, gear(Member::Driven)?, distance)
        .map_err(|error| error.to_string())
}

/// The same pair with involutes up to sharp tips, without deviations.
fn plain(pair: &GearPair) -> Result<GearPair, String> {
    changed(pair, pair.center_distance(), |data, _| {
        data.modifications.clear();
        data.tip_edge = TipEdge::Sharp;
        data.deviations = ToothDeviations::default();
    })
}

fn largest_difference(one: &[f64], other: &[f64]) -> f64 {
    one.iter()
        .zip(other)
        .map(|(a, b)| (a / b - 1.0).abs())
        .fold(0.0, f64::max)
}

/// What the mesh yields by at the least: the load over the largest stiffness. Where teeth deviate δ itself may be nothing.
fn deflection(curve: &Curve) -> f64 {
    let stiffest = curve.mesh_stiffness_tangent.iter().copied();
    curve.load / stiffest.fold(0.0, f64::max)
}

/// The largest difference over `deflection`.
fn apart(one: &[f64], other: &[f64], deflection: f64) -> f64 {
    let pairs = one.iter().zip(other);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / deflection
}

fn penetration(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    let analysis = solve(&case(&drawn.pair, &[drawn.output_torque]), library)?;
    let deflection = deflection(&analysis.curves[0]);
    let figure = analysis.evidence.largest_penetration / deflection;
    let is_undercut = |member: Member| drawn.pair.gear(member).is_undercut();
    if !Member::BOTH.into_iter().any(is_undercut) {
        return Ok(Some(figure));
    }
    // Below the corner of an undercut flank contact on the fillet is not followed, and warned of where it carries; beside the corner ten times as much is
    // allowed.
    let reaches_fillet =
        |warning: &Warning| matches!(warning, Warning::ContactReachesFillet { .. });
    let is_warned = analysis.warnings.iter().any(reaches_fillet);
    Ok((!is_warned).then_some(0.1 * figure))
}

/// The rigid gap of pair `n` at `eta` along the line of action, by looking at dense polygons of both flanks: independent of
/// how the engine finds it.
///
/// The driven flank is turned about its center until it touches; the angle times its base radius is the gap.
fn polygon_gap(pair: &GearPair, eta: f64, n: i64) -> Option<f64> {
    const POINTS: usize = 4000;
    let alpha_w = pair.working_pressure_angle();
    let s_1 = pair.pitch_roll_length() + (eta - n as f64) * pair.base_pitch();
    let flank = |member: Member| -> Vec<Vector> {
        let gear = pair.gear(member);
        let (turn, s, center) = match member {
            Member::Driving => (-alpha_w, s_1, 0.0),
            Member::Driven => (
                PI - alpha_w,
                pair.line_of_action() - s_1,
                pair.center_distance(),
            ),
        };
        let angle = turn - gear.flank().base_half_angle() + s / gear.base_radius();
        let tooth = pair.tooth(member, n);
        let tooth_0 = angle - tooth as f64 * gear.pitch_angle();
        let deviations = pair.deviations();
        let beside = deviations.of_gear(member).displacement(tooth_0);
        let (from, to) = (gear.form_roll_length(), gear.tip_roll_length());
        (0..=POINTS)
            .map(|i| {
                let s = from + (to - from) * i as f64 / POINTS as f64;
                // What is missing turns the flank back, at the radius where it is missing.
                let back = gear.removed(s) - deviations.of_gear(member).at(tooth, s);
                let point = gear.flank().point(s);
                let angle = angle - back / gear.base_radius();
                let (sin, cos) = angle.sin_cos();
                Vector::new(
                    cos * point.x - sin * point.y + center + beside.x,
                    sin * point.x + cos * point.y + beside.y,
                )
            })
            .collect()
    };
    // Both flanks as polar angle over radius about the driven center.
    let polar = |points: Vec<Vector>| -> Vec<(f64, f64)> {
        let mut polar: Vec<(f64, f64)> = points
            .into_iter()
            .map(|p| {
                let d = p - Vector::new(pair.center_distance(), 0.0);
                (d.norm(), d.y.atan2(d.x).rem_euclid(2.0 * PI))
            })
            .collect();
        polar.sort_by(|a, b| a.0.total_cmp(&b.0));
        polar
    };
    let (driving, driven) = (polar(flank(Member::Driving)), polar(flank(Member::Driven)));
    let at = |curve: &[(f64, f64)], r: f64| -> Option<f64> {
        let after = curve.partition_point(|point| point.0 < r);
        if after == 0 || after == curve.len() {
            return None;
        }
        let ((r_0, a_0), (r_1, a_1)) = (curve[after - 1], curve[after]);
        Some(a_0 + (a_1 - a_0) * (r - r_0) / (r_1 - r_0))
    };
    // A circle about the driven center meets both; the load turns the driven flank back, to greater angles, against the driving one.
    let of_driving = driving
        .iter()
        .filter_map(|&(r, angle)| Some(angle - at(&driven, r)?));
    let of_driven = driven
        .iter()
        .filter_map(|&(r, angle)| Some(at(&driving, r)? - angle));
    let gaps = of_driving.chain(of_driven);
    let least = gaps.fold(f64::INFINITY, f64::min);
    least
        .is_finite()
        .then_some(least * pair.driven().base_radius())
}

/// The number of positions at which the pair of least rigid gap carries nothing.
fn first_touch_unloaded(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    let pair = &drawn.pair;
    let curve = curve(pair, drawn.output_torque, library)?;
    let mut unloaded = 0;
    for (i, &eta) in curve.mesh_position.iter().enumerate() {
        let mut gaps: Vec<(i64, f64)> = (-4..=5)
            .filter_map(|n| Some((n, polygon_gap(pair, eta, n)?)))
            .collect();
        gaps.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (first, gap) = gaps[0];
        // Polygons are good to a small part of δ; pairs that touch together may carry in any shares.
        let doubtful = gaps
            .get(1)
            .is_some_and(|other| other.1 - gap < 0.05 * curve.transmission_error[i]);
        let share = |n: i64| -> f64 {
            let offset = (n - eta.floor() as i64) as i32;
            let shares = curve.load_shares.iter();
            shares
                .filter(|share| share.pair_offset == offset)
                .map(|share| share.share[i])
                .sum()
        };
        if !doubtful && share(first) == 0.0 {
            unloaded += 1;
        }
    }
    Ok(Some(f64::from(unloaded)))
}

/// Scales every length of a drawing.
fn scale(data: &mut GearData, s: f64) {
    let rack = &mut data.rack;
    for length in [
        &mut rack.module,
        &mut rack.addendum,
        &mut rack.dedendum,
        &mut rack.tip_radius,
        &mut data.face_width,
        &mut data.blank.bore_radius,
    ] {
        *length *= s;
    }
    for modification in &mut data.modifications {
        match modification {
            ModificationData::TipRelief(relief) | ModificationData::RootRelief(relief) => {
                relief.amount *= s;
                match &mut relief.start {
                    ReliefStart::RadialLength(length)
                    | ReliefStart::RollLength(length)
                    | ReliefStart::Diameter(length) => *length *= s,
                    ReliefStart::RollAngle(_) => {}
                }
            }
            ModificationData::Crowning { amount } | ModificationData::Slope { amount } => {
                *amount *= s;
            }
            ModificationData::Table { places, removed } => {
                let (TablePlaces::RollLengths(places) | TablePlaces::Diameters(places)) = places;
                places.iter_mut().chain(removed).for_each(|each| *each *= s);
            }
        }
    }
    data.thickness_deviation *= s;
    if let TipEdge::Rounded(size) | TipEdge::Chamfered(size) = &mut data.tip_edge {
        *size *= s;
    }
    let deviations = &mut data.deviations;
    let lists = deviations.cumulative_pitch.iter_mut();
    lists
        .chain(&mut deviations.profile_slope)
        .for_each(|each| *each *= s);
    if let Some(eccentricity) = &mut deviations.eccentricity {
        eccentricity.amount *= s;
    }
    if let Some(web) = &mut data.blank.web {
        web.inner_radius *= s;
        web.outer_radius *= s;
        web.thickness *= s;
    }
    for hole in &mut data.blank.holes {
        hole.circle_radius *= s;
        match &mut hole.shape {
            HoleShape::Round { radius } => *radius *= s,
            HoleShape::Slot { width, .. } => *width *= s,
            HoleShape::Contour(_) => unreachable!("holes are drawn round or as slots"),
        }
    }
}

fn similarity(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    // No power of two, so that every rounding differs.
    let s = 1.7;
    let Ok(larger) = changed(&drawn.pair, drawn.pair.center_distance() * s, |data, _| {
        scale(data, s)
    }) else {
        return Ok(None);
    };
    let one = curve(&drawn.pair, drawn.output_torque, library)?;
    let other = curve(&larger, drawn.output_torque * s.powi(3), library)?;
    let scaled: Vec<f64> = other
        .transmission_error
        .iter()
        .map(|delta| delta / s)
        .collect();
    let stiffness: Vec<f64> = other.mesh_stiffness_tangent.iter().map(|k| k / s).collect();
    // Gaps are differences of coordinates as large as the center distance, and no truer than those.
    let deflection = deflection(&one);
    let rounding = 4.0 * f64::EPSILON * drawn.pair.center_distance() / deflection;
    Ok(Some(
        (apart(&one.transmission_error, &scaled, deflection) - rounding)
            .max(largest_difference(&one.mesh_stiffness_tangent, &stiffness)),
    ))
}

fn scaled_moduli(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    let c = 0.37;
    let softer = changed(&drawn.pair, drawn.pair.center_distance(), |data, _| {
        data.material.youngs_modulus *= c;
    })?;
    let one = curve(&drawn.pair, drawn.output_torque, library)?;
    let other = curve(&softer, drawn.output_torque * c, library)?;
    let stiffness: Vec<f64> = other.mesh_stiffness_tangent.iter().map(|k| k / c).collect();
    Ok(Some(
        apart(
            &one.transmission_error,
            &other.transmission_error,
            deflection(&one),
        )
        .max(largest_difference(&one.mesh_stiffness_tangent, &stiffness)),
    ))
}

/// The part of its radii of curvature that a contact may be wide, where it is to lie on the line of action: departures are of its
/// square.
const NARROW: f64 = 0.01;

/// Whether every loaded pair touches inside the path of contact, farther from its ends than a contact is wide, and is narrow.
fn on_path(pair: &GearPair, contact: &MeshContact, eta: f64, torque: f64) -> bool {
    let (s_a, s_e) = pair.path_of_contact();
    let load = pair.load(torque);
    let factors: f64 = Member::BOTH
        .map(|member| {
            let e = pair.gear(member).material().youngs_modulus;
            logarithm_factor(e, pair.common_face_width())
        })
        .into_iter()
        .sum();
    contact
        .pairs
        .iter()
        .filter(|pair| pair.share > 0.0)
        .all(|loaded| {
            let s = pair.roll_length_of(eta - loaded.pair as f64);
            let other = pair.line_of_action() - s;
            if s <= s_a || s >= s_e {
                return false;
            }
            let (half_width, _) = hertz(
                load,
                s * other / (s + other),
                factors,
                pair.common_face_width(),
            );
            // Along a flank an arc is s/r_b of a roll length.
            let reach = 2.0
                * half_width
                * (pair.driving().base_radius() / s).max(pair.driven().base_radius() / other);
            s - reach > s_a && s + reach < s_e && half_width < NARROW * s.min(other)
        })
}

fn swapped(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    // A tooth that deviates would have another number on the other gear.
    let distance = drawn.pair.center_distance();
    let pair = &changed(&drawn.pair, distance, |data, _| {
        data.deviations = ToothDeviations::default();
    })?;
    // Seen from behind and run backward, the same flanks touch: hole angles, told from the loaded flank, stay as they are.
    let other = GearPair::new(pair.driven().clone(), pair.driving().clone(), distance)
        .map_err(|error| error.to_string())?;
    let load = pair.load(drawn.output_torque);
    let (here, there) = (model(pair, library)?, model(&other, library)?);
    let mut worst = None;
    for i in 0..POSITIONS {
        let eta = f64::from(i) / f64::from(POSITIONS);
        let one = contact(&here, eta, load)?;
        if on_path(pair, &one, eta, drawn.output_torque) {
            // Who is driven now stood still and turns, by what the other gear lagged; and is asked for what the driver gave.
            let lag = one.transmission_error / pair.base_pitch();
            let two = contact(&there, lag - eta, one.driving_load)?;
            let apart = (one.transmission_error - two.transmission_error).abs();
            let apart = apart * one.stiffness / load;
            worst = Some(apart.max(worst.unwrap_or(0.0)));
        }
    }
    Ok(worst)
}

fn turned_by_hole_pitch(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    let pair = &drawn.pair;
    if Member::BOTH
        .iter()
        .all(|&member| pair.gear(member).holes().is_empty())
    {
        return Ok(None);
    }
    let turned = changed(pair, pair.center_distance(), |data, _| {
        // The triangles of a blank that is laid as a whole do not repeat with its holes: it is turned by a whole turn.
        let in_sectors = data.blank.pattern().is_some() && data.blank.web.is_none();
        let repeats = if in_sectors {
            data.blank.symmetry().count
        } else {
            1
        };
        data.blank = data.blank.turned(2.0 * PI / f64::from(repeats));
    })?;
    let one = curve(pair, drawn.output_torque, library)?;
    let other = curve(&turned, drawn.output_torque, library)?;
    Ok(Some(apart(
        &one.transmission_error,
        &other.transmission_error,
        deflection(&one),
    )))
}

fn turned_by_tooth(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    let pair = &drawn.pair;
    if pair.is_as_drawn()
        && Member::BOTH
            .iter()
            .all(|&member| pair.gear(member).holes().is_empty())
    {
        return Ok(None);
    }
    // The next tooth of the driving gear is behind the reference tooth, that of the driven gear is ahead of it.
    let turned = changed(pair, pair.center_distance(), |data, member| {
        let pitch = 2.0 * PI / f64::from(data.tooth_count);
        let turn = match member {
            Member::Driving => pitch,
            Member::Driven => -pitch,
        };
        data.blank = data.blank.turned(turn);
        let deviations = &mut data.deviations;
        for list in [
            &mut deviations.cumulative_pitch,
            &mut deviations.profile_slope,
        ] {
            match member {
                _ if list.is_empty() => {}
                Member::Driving => list.rotate_right(1),
                Member::Driven => list.rotate_left(1),
            }
        }
        if let Some(eccentricity) = &mut deviations.eccentricity {
            eccentricity.direction += turn;
        }
    })?;
    let load = pair.load(drawn.output_torque);
    let (here, there) = (model(pair, library)?, model(&turned, library)?);
    let mut worst = 0.0_f64;
    for i in 0..POSITIONS {
        let eta = f64::from(i) / f64::from(POSITIONS);
        let (one, two) = (
            contact(&here, eta + 1.0, load)?,
            contact(&there, eta, load)?,
        );
        worst = worst.max((one.transmission_error / two.transmission_error - 1.0).abs());
    }
    Ok(Some(worst))
}

fn not_monotone(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    let torques = [0.1, 0.3, 1.0, 1.5].map(|factor| factor * drawn.output_torque);
    let curves = solve(&case(&drawn.pair, &torques), library)?.curves;
    let mut falls = 0;
    for curves in curves.windows(2) {
        let pairs = curves[0]
            .transmission_error
            .iter()
            .zip(&curves[1].transmission_error);
        falls += pairs.filter(|(less, more)| less >= more).count();
    }
    Ok(Some(falls as f64))
}

/// How much of the largest step of the curve is left where positions stand sixteen times as near; nothing where that is next to nothing
/// of δ.
fn jump(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    const COARSE: u32 = 24;
    const HALVINGS: u32 = 14;
    let mut case = case(&drawn.pair, &[drawn.output_torque]);
    case.resolution.positions_per_mesh_period = COARSE;
    let curve = solve(&case, library)?.curves.remove(0);
    let model = model(&drawn.pair, library)?;
    let load = drawn.pair.load(drawn.output_torque);
    let delta = |eta| Ok::<_, String>(contact(&model, eta, load)?.transmission_error);
    let deltas = &curve.transmission_error;
    let steps: BTreeMap<u64, usize> = (0..deltas.len() - 1)
        .map(|i| ((deltas[i + 1] - deltas[i]).abs().to_bits(), i))
        .collect();
    let mut worst = 0.0_f64;
    // The two largest steps, each followed into its steeper half.
    for &i in steps.values().rev().take(2) {
        let mut ends = [i, i + 1].map(|i| i as f64 / f64::from(COARSE));
        let mut values = [delta(ends[0])?, delta(ends[1])?];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (ends[0] + ends[1]);
            let value = delta(middle)?;
            if (value - values[0]).abs() > (values[1] - value).abs() {
                (ends[1], values[1]) = (middle, value);
            } else {
                (ends[0], values[0]) = (middle, value);
            }
        }
        // Where teeth deviate δ itself may be nothing.
        let scale = values[0].abs().max(deflection(&curve));
        worst = worst.max((values[1] - values[0]).abs() / scale);
    }
    Ok(Some(worst))
}

/// How far the peak pressure is from Hertz's where one pair carries all the load away from corners and reliefs.
fn beside_hertz(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    let plain = plain(&drawn.pair)?;
    let pair = &plain;
    let load = pair.load(drawn.output_torque);
    let model = model(pair, library)?;
    let factors: f64 = Member::BOTH
        .map(|member| {
            let material = pair.gear(member).material();
            let modulus = material.plane_modulus(PlaneState::Strain);
            logarithm_factor(modulus, pair.common_face_width())
        })
        .into_iter()
        .sum();
    let mut worst = None;
    for i in 0..3 * POSITIONS {
        let eta = f64::from(i) / f64::from(3 * POSITIONS);
        let contact = contact(&model, eta, load)?;
        let mut loaded = contact.pairs.iter().filter(|pair| pair.share > 0.0);
        let (Some(only), None, Some(peak)) = (loaded.next(), loaded.next(), contact.peak_pressure)
        else {
            continue;
        };
        if !on_path(pair, &contact, eta, drawn.output_torque) {
            continue;
        }
        let s = pair.roll_length_of(eta - only.pair as f64);
        let other = pair.line_of_action() - s;
        let (_, pressure) = hertz(
            load,
            s * other / (s + other),
            factors,
            pair.common_face_width(),
        );
        worst = Some((peak / pressure - 1.0).abs().max(worst.unwrap_or(0.0)));
    }
    Ok(worst)
}

fn between_solvers(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    let exact = case(&drawn.pair, &[drawn.output_torque]);
    let delta = |case: &Case| -> Result<Vec<f64>, String> {
        Ok(solve(case, library)?.curves.remove(0).transmission_error)
    };
    let one = solve(&exact, library)?.curves.remove(0);
    let deflection = deflection(&one);
    let mut other = exact.clone();
    other.resolution.contact_solver = ContactSolver::AugmentedLagrangian {
        penalty: Some(1e3 * one.load / deflection),
        gap_tolerance: 1e-7 * deflection,
    };
    Ok(Some(apart(
        &one.transmission_error,
        &delta(&other)?,
        deflection,
    )))
}

fn standard_beside_fine(drawn: &DrawnPair, library: &Library) -> Result<Option<f64>, String> {
    let at = |level| -> Result<Curve, String> {
        let mut case = case(&drawn.pair, &[drawn.output_torque]);
        case.resolution.grid = level;
        case.resolution.positions_per_mesh_period = 16;
        Ok(solve(&case, library)?.curves.remove(0))
    };
    let (standard, fine) = (at(GridLevel::Standard)?, at(GridLevel::Fine)?);
    let (a, b) = (
        standard.transmission_error_statistics,
        fine.transmission_error_statistics,
    );
    let mean = (a.mean / b.mean - 1.0).abs() / 1e-3;
    let allowed = (1e-2 * b.peak_to_peak).max(1e-3 * b.mean);
    Ok(Some(
        mean.max((a.peak_to_peak - b.peak_to_peak).abs() / allowed),
    ))
}
