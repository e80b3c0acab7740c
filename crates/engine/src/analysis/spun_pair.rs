//! A pair that runs, before any load acts on its flanks.
//!
//! Rotation, heat and press fits move flanks, which are deviations of the drawn flanks, and stress free edges. The contact is then that of
//! any pair whose teeth deviate. Compliances stay those of the drawing.

use std::sync::Arc;

use super::AnalysisError;
use super::blank_modes::of_modes;
use super::case::{Case, Model};
use super::running::{Bore, RestingStresses, Running};
use super::setup::Setup;
use super::warning::Warning;
use crate::assembly::{Blanks, InnerLoad, Parts, Spun};
use crate::gear::{Core, FlankGrowth, GearPair, Member, PairDeviations, SolidGear, SpurGear};
use crate::grid::GridLevel;
use crate::ring::blank::Hold;
use crate::run::Run;
use crate::vibration::BoreSupport;
use crate::vibration::rotation::{MovedTeeth, PulledTeeth, RunningSupport};

/// How far apart loaded teeth are coupled in the gears whose rotation is solved: nothing depends on it.
const COUPLED: usize = 4;

/// A pair that runs, before it is loaded.
#[derive(Debug, Clone)]
pub(super) struct PairState {
    /// Deviations of its teeth, including those by running.
    pub(super) deviations: PairDeviations,
    /// Stresses of its gears without load, in the plane.
    pub(super) stresses: [RestingStresses; 2],
    /// The loads inside its gears along faces.
    pub(super) loads: [Option<LoadsInside>; 2],
    /// How far its tips have moved outward in the mean.
    pub(super) radial_growth: [f64; 2],
    /// Warnings about it.
    pub(super) warnings: Vec<Warning>,
}

/// Loads inside a gear along its face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadsInside {
    /// How it is carried.
    pub(super) support: RunningSupport,
    /// ω² in 1/s², and by how much its shaft is larger in radius than the bore, in meters.
    pub(super) amounts: [f64; 2],
}

/// One gear that runs.
#[derive(Default)]
struct GearState {
    growth: FlankGrowth,
    tips: f64,
    stresses: RestingStresses,
    loads: Option<LoadsInside>,
    loose: Option<Warning>,
}

impl PairState {
    /// Rotation of `case`, with the responses of its gears from `parts` at this grid `level`; `None` of a case that does not run.
    pub(super) fn of(
        case: &Case,
        level: GridLevel,
        parts: &dyn Parts,
        run: &Run,
    ) -> Result<Option<Self>, AnalysisError> {
        let Some(running) = case.runs() else {
            return Ok(None);
        };
        let drawn = case.pair.deviations();
        let setup = Setup::new((case, &drawn), level, COUPLED, parts, run);
        let of = |member: Member| match &case.model {
            Model::Faces(faces, _) => {
                // Along the face edges are computed for stresses alone: the section tells whether it bears the speed.
                if running.gears[member.index()].tensile_strength.is_some() {
                    GearState::of(&setup, running, member)?;
                }
                GearState::along_faces((case, running), faces.pair.gear(member), member, run)
            }
            Model::Section(_) | Model::Formulas(_) => GearState::of(&setup, running, member),
        };
        let (driving, driven) = rayon::join(|| of(Member::Driving), || of(Member::Driven));
        let states = [driving?, driven?];
        let growth = states.each_ref().map(|state| &state.growth);
        let deviations = drawn.growing(&case.pair, growth);
        let backlash = case.pair.backlash_with(&deviations);
        if backlash < 0.0 {
            return Err(AnalysisError::FlanksJam { backlash });
        }
        let [driving, driven] = states;
        let warnings = [driving.loose, driven.loose].into_iter().flatten();
        Ok(Some(Self {
            warnings: warnings.collect(),
            radial_growth: [driving.tips, driven.tips],
            stresses: [driving.stresses, driven.stresses],
            loads: [driving.loads, driven.loads],
            deviations,
        }))
    }
}

impl GearState {
    /// The gear `member` of `pair` as warm as it runs.
    fn warm(pair: &GearPair, running: &Running, member: Member) -> Self {
        let (gear, own) = (pair.gear(member), &running.gears[member.index()]);
        let mut state = Self {
            tips: own.thermal_strain * gear.tip_radius(),
            ..Self::default()
        };
        let strain = own.thermal_strain - running.shared_strain();
        state.growth.add_strain(gear, strain);
        state
    }

    /// The gear `member` of a case in three dimensions.
    fn along_faces(
        (case, running): (&Case, &Running),
        gear: &SolidGear,
        member: Member,
        run: &Run,
    ) -> Result<Self, AnalysisError> {
        let (pair, own) = (&case.pair, &running.gears[member.index()]);
        let mut state = Self::warm(pair, running, member);
        let speed = running.angular_speed(pair, member);
        let mut interference = own.bore.interference();
        if speed == 0.0 && interference == 0.0 {
            return Ok(state);
        }
        let section = pair.gear(member);
        let mut support = match (section.data().blank.core, own.bore) {
            (Core::Shaft { .. }, _) | (_, Bore::Held) => RunningSupport::Bore(BoreSupport::Held),
            (Core::Bore, Bore::Free) => RunningSupport::Bore(BoreSupport::Free),
            (Core::Bore, Bore::PressFit { .. }) => RunningSupport::Shaft,
        };
        let of =
            |support| PulledTeeth::of(gear, support, run).map_err(|error| of_modes(error, member));
        let mut pulled = of(support)?;
        if let Some(fit) = &pulled.fit
            && let Some(loose) = loose_from([pulled.spin.pressure, fit.pressure], interference)
            && speed >= loose
        {
            state.loose = Some(running.loose((member, speed), loose));
            (support, interference) = (RunningSupport::Bore(BoreSupport::Free), 0.0);
            pulled = of(support)?;
        }
        let amounts = [speed * speed, interference];
        for (moved, amount) in [Some(&pulled.spin), pulled.fit.as_ref()]
            .into_iter()
            .zip(amounts)
        {
            if let Some(moved) = moved.filter(|_| amount != 0.0) {
                state.bear_along(section, (&pulled, moved), amount);
            }
        }
        state.loads = Some(LoadsInside { support, amounts });
        Ok(state)
    }

    /// Adds so much of the displacement `moved` of the teeth `pulled`.
    fn bear_along(
        &mut self,
        section: &SpurGear,
        (pulled, moved): (&PulledTeeth, &MovedTeeth),
        amount: f64,
    ) {
        self.tips += amount * moved.tips;
        let shares: Vec<f64> = pulled.heights.iter().map(|(_, share)| *share).collect();
        let heights: Vec<f64> = pulled.heights.iter().map(|(z, _)| *z).collect();
        let flanks = moved.flanks.iter();
        let means: Vec<Vec<f64>> = flanks.map(|rows| mean(rows, &shares)).collect();
        let roll_lengths = &pulled.roll_lengths;
        self.growth
            .add_flanks(section, roll_lengths, &means, amount);
        let along = |rows: &Vec<Vec<f64>>| -> Vec<f64> {
            let of_rows: Vec<f64> = rows
                .iter()
                .map(|row| along_flank(roll_lengths, row))
                .collect();
            let middle: f64 = of_rows
                .iter()
                .zip(&shares)
                .map(|(row, share)| row * share)
                .sum();
            of_rows.iter().map(|row| row - middle).collect()
        };
        let along: Vec<Vec<f64>> = moved.flanks.iter().map(along).collect();
        self.growth.add_along(&heights, &along, amount);
    }

    fn of(setup: &Setup<'_>, running: &Running, member: Member) -> Result<Self, AnalysisError> {
        let pair = &setup.case.pair;
        let (gear, own) = (pair.gear(member), &running.gears[member.index()]);
        let mut state = Self::warm(pair, running, member);
        let speed = running.angular_speed(pair, member);
        let mut interference = own.bore.interference();
        if speed == 0.0 && interference == 0.0 {
            return Ok(state);
        }
        let hold = match (gear.data().blank.core, own.bore) {
            (Core::Shaft { .. }, _) | (_, Bore::PressFit { .. }) => Hold::Shaft,
            (Core::Bore, Bore::Free) => Hold::Free,
            (Core::Bore, Bore::Held) => Hold::Rigid,
        };
        let spun = |hold| setup.spun(member, hold);
        let Some(mut found) = spun(hold)? else {
            return Ok(state);
        };
        if let Bore::PressFit { .. } = own.bore
            && let Some(fit) = &found.fit
            && let Some(loose) = loose_from([found.spin.pressure, fit.pressure], interference)
            && speed >= loose
        {
            state.loose = Some(running.loose((member, speed), loose));
            let Some(free) = spun(Hold::Free)? else {
                return Ok(state);
            };
            (found, interference) = (free, 0.0);
        }
        state.bear(gear, &found, (speed, interference));
        if let Some(strength) = own.tensile_strength {
            let weakest = weakest(&found, (speed, interference), gear, strength);
            if weakest.stress > strength {
                return Err(AnalysisError::RimBreaks {
                    member,
                    stress: weakest.stress,
                    strength,
                    speed: weakest
                        .bearable
                        .map(|bearable| running.driving_speed.0 * bearable / speed),
                });
            }
        }
        Ok(state)
    }

    /// Adds the effect of `spun` at the angular `speed` and with the `interference` of its shaft.
    fn bear(&mut self, gear: &SpurGear, spun: &Spun, (speed, interference): (f64, f64)) {
        let loads = [
            (Some(&spun.spin), speed * speed),
            (spun.fit.as_ref(), interference),
        ];
        for (load, amount) in loads {
            let Some(load) = load.filter(|_| amount != 0.0) else {
                continue;
            };
            self.tips += amount * load.tips;
            self.growth
                .add_flanks(gear, &spun.roll_lengths, &load.flanks, amount);
            add_lists(&mut self.stresses.in_teeth, &load.in_teeth, amount);
            add_lists(&mut self.stresses.in_blank, &load.in_blank, amount);
        }
    }
}

/// The mean of `rows`, each of which has its share of the face.
fn mean(rows: &[Vec<f64>], shares: &[f64]) -> Vec<f64> {
    let mut mean = vec![0.0; rows.first().map_or(0, Vec::len)];
    for (row, share) in rows.iter().zip(shares) {
        for (sum, value) in mean.iter_mut().zip(row) {
            *sum += share * value;
        }
    }
    mean
}

/// The mean of `values` over the roll length.
fn along_flank(roll_lengths: &[f64], values: &[f64]) -> f64 {
    let pieces = roll_lengths.windows(2).zip(values.windows(2));
    let sums = pieces.map(|(s, values)| (s[1] - s[0]) * f64::midpoint(values[0], values[1]));
    sums.sum::<f64>() / (roll_lengths[roll_lengths.len() - 1] - roll_lengths[0])
}

/// Adds so much of `lists` to `sums`, which are empty at first.
fn add_lists(sums: &mut Vec<Vec<f64>>, lists: &[Vec<f64>], amount: f64) {
    if sums.is_empty() {
        *sums = lists.iter().map(|list| vec![0.0; list.len()]).collect();
    }
    for (sum, value) in sums.iter_mut().flatten().zip(lists.iter().flatten()) {
        *sum += amount * value;
    }
}

/// The angular speed from which a shaft that is too large by the `interference` in radius no longer presses on its bore in the mean: pressures are those of
/// rotation for ω² = 1 in 1/s², and of a shaft that is larger by one meter.
fn loose_from([spin, fit]: [f64; 2], interference: f64) -> Option<f64> {
    let (cold, lost) = (interference * fit, -spin);
    (lost > 0.0).then(|| (cold.max(0.0) / lost).sqrt())
}

impl Running {
    /// The warning of a gear, at this angular speed, whose shaft is loose from the angular speed `loose` on.
    fn loose(&self, (member, speed): (Member, f64), loose: f64) -> Warning {
        Warning::FitComesLoose {
            member,
            speed: self.driving_speed.0 * loose / speed,
        }
    }
}

/// The place of a gear that is stretched most for its strength.
struct Weakest {
    /// The tension there, in Pa.
    stress: f64,
    /// The angular speed that every place would bear, if any.
    bearable: Option<f64>,
}

/// The largest stress at the free edges and the bore of `spun`.
fn weakest(
    spun: &Spun,
    (speed, interference): (f64, f64),
    gear: &SpurGear,
    strength: f64,
) -> Weakest {
    // A pressure p on a bore takes ν p from E times the strain along it.
    let ratio = gear.material().poisson_ratio;
    let of_load = |load: &InnerLoad| -> Vec<f64> {
        let edges = [&load.in_teeth, &load.in_blank].into_iter();
        let edges = edges.flat_map(|lists| lists.iter().flatten().copied());
        let bore = load.along_bore.iter().flatten();
        let bore = bore.map(|stress| stress - ratio * load.pressure);
        edges.chain(bore).collect()
    };
    let spin = of_load(&spun.spin);
    let fit = spun.fit.as_ref().map(of_load);
    let fit = fit.unwrap_or_else(|| vec![0.0; spin.len()]);
    let mut weakest = Weakest {
        stress: 0.0,
        bearable: Some(f64::INFINITY),
    };
    for (spin, fit) in spin.into_iter().zip(fit) {
        let at_rest = interference * fit;
        weakest.stress = weakest.stress.max(speed * speed * spin + at_rest);
        if at_rest >= strength {
            weakest.bearable = None;
        } else if spin > 0.0 {
            let most = ((strength - at_rest) / spin).sqrt();
            weakest.bearable = weakest.bearable.map(|bearable| bearable.min(most));
        }
    }
    weakest
}

impl Setup<'_> {
    /// Response of the gear `member` to its rotation, its bore held as `hold` says.
    fn spun(&self, member: Member, hold: Hold) -> Result<Option<Arc<Spun>>, AnalysisError> {
        let spec = self.spec(Blanks::Flexible);
        Ok(spec.spun(member, hold, self.parts, self.run)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::case::tests::plain;
    use crate::analysis::running::{RotationSpeed, RunningGear};
    use crate::analysis::{FaceHoles, Faces, SectionHoles};
    use crate::assembly::{FaceResolution, MakeAll};
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{Alignment, Helix, HolePattern, SolidPair, Web};

    /// 50/50 teeth of a face, the driven gear with six holes and, where it is given, a web of the thickness with its middle so far from that of the face.
    fn pair(face_width: f64, beta: f64, web: Option<[f64; 2]>) -> SolidPair {
        let gear = |sign: f64, is_holed: bool| {
            let mut data = paper_gear(50);
            data.face_width = face_width;
            let mut offset = 0.0;
            if is_holed {
                data.blank.holes = HolePattern {
                    count: 6,
                    circle_radius: 31e-3,
                    radius: 8e-3,
                    phase: 0.1,
                }
                .holes();
                data.blank.web = web.map(|[thickness, _]| Web {
                    inner_radius: 20e-3,
                    outer_radius: 42e-3,
                    thickness,
                });
                offset = web.map_or(0.0, |[_, offset]| offset);
            }
            SolidGear::new(data, Helix::right(sign * beta), offset, None).expect("can be made")
        };
        let gears = [gear(1.0, false), gear(-1.0, true)];
        let distance = 2.0 * gears[0].section().reference_radius() + 0.5e-3;
        let leads = [Vec::new(), Vec::new()];
        SolidPair::new(gears, leads, distance, Alignment::default()).expect("meshes")
    }

    fn state(pair: &SolidPair, along_faces: bool, bore: Bore) -> PairState {
        let model = if along_faces {
            let faces = Faces {
                pair: pair.clone(),
                resolution: FaceResolution::DRAFT,
                slices: 20,
                at_each_position: false,
                cure: false,
            };
            Model::Faces(Box::new(faces), FaceHoles::Whole)
        } else {
            Model::Section(SectionHoles::Whole)
        };
        let mut case = plain(pair.section().clone(), model, 10.0, 8);
        let gear = RunningGear {
            thermal_strain: 0.0,
            bore,
            tensile_strength: None,
        };
        case.running = Some(Running {
            driving_speed: RotationSpeed(20_000.0 / 60.0),
            gears: [gear; 2],
        });
        let run = Run::unattended();
        let state = PairState::of(&case, GridLevel::Standard, &MakeAll, &run).expect("solves");
        state.expect("it runs")
    }

    #[test]
    fn a_narrow_face_moves_in_space_as_in_the_plane() {
        // One body, two solutions: the plane by grids of its own, space by others of half the fineness.
        let pair = pair(1e-3, 0.0, Some([0.4e-3, 0.0]));
        let fitted = Bore::PressFit {
            interference: 10e-6,
        };
        for bore in [Bore::Held, Bore::Free, fitted] {
            let [plane, space] = [false, true].map(|along_faces| state(&pair, along_faces, bore));
            for member in Member::BOTH {
                let gear = pair.section().gear(member);
                let (form, tip) = (gear.form_roll_length(), gear.tip_roll_length());
                let at = |state: &PairState, tooth: usize, s: f64| {
                    let of = state.deviations.of_gear(member);
                    of.at(tooth, s)
                };
                let places: Vec<(usize, f64)> = (0..25)
                    .flat_map(|tooth| [form, 0.5 * (form + tip), tip].map(|s| (tooth, s)))
                    .collect();
                let both = [&plane, &space]
                    .map(|state| places.iter().map(|(tooth, s)| at(state, *tooth, *s)));
                let largest = both[0].clone().fold(0.0, |most: f64, u| most.max(u.abs()));
                let apart = both[0].clone().zip(both[1].clone());
                let apart = apart.fold(0.0, |most: f64, (u, v)| most.max((u - v).abs()));
                println!("{bore:?} {member}: {apart:e} of {largest:e}");
                // A step from web to rim yields in space, and not in the plane.
                assert!(
                    apart < 0.02 * largest,
                    "{bore:?} {member}: {apart} {largest}"
                );
            }
            for (plane, space) in plane.radial_growth.into_iter().zip(space.radial_growth) {
                assert!((space / plane - 1.0).abs() < 5e-3, "{space} {plane}");
            }
        }
    }

    #[test]
    fn a_rim_goes_out_farther_where_no_web_holds_it() {
        let ends = |offset: f64| {
            let pair = pair(20e-3, 0.0, Some([4e-3, offset]));
            let state = state(&pair, true, Bore::Held);
            let driven = state.deviations.of_gear(Member::Driven);
            [-10e-3, offset, 10e-3].map(|z| -driven.removed_by_lead(0, z, 20e-3))
        };
        let [minus, middle, plus] = ends(0.0);
        assert!(
            (minus - plus).abs() < 1e-9 && plus - middle > 0.1e-6,
            "{minus} {middle} {plus}"
        );
        // A web at one side turns the rim about it.
        let [minus, _, plus] = ends(6e-3);
        let [image, _, other] = ends(-6e-3);
        assert!((minus - plus).abs() > 0.1e-6, "{minus} {plus}");
        assert!(
            (minus - other).abs() < 1e-3 * minus.abs() && (plus - image).abs() < 1e-3 * minus.abs()
        );
    }
}
