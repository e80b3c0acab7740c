//! A pair that runs, before any load acts on its flanks.
//!
//! Rotation, heat and press fits move flanks, which are deviations of the drawn flanks, and stress free edges. The contact is then that of
//! any pair whose teeth deviate. Compliances stay those of the drawing.

use std::sync::Arc;

use super::AnalysisError;
use super::case::Case;
use super::running::{Bore, RestingStresses, Running};
use super::setup::Setup;
use super::warning::Warning;
use crate::assembly::{Blanks, InnerLoad, Parts, Spun};
use crate::gear::{Core, FlankGrowth, Member, PairDeviations, SpurGear};
use crate::grid::GridLevel;
use crate::ring::blank::Hold;
use crate::run::Run;

/// How far apart loaded teeth are coupled in the gears whose rotation is solved: nothing depends on it.
const COUPLED: usize = 4;

/// A pair that runs, before it is loaded.
#[derive(Debug, Clone)]
pub(super) struct PairState {
    /// Deviations of its teeth, including those by running.
    pub(super) deviations: PairDeviations,
    /// Stresses of its gears without load.
    pub(super) stresses: [RestingStresses; 2],
    /// How far its tips have moved outward in the mean.
    pub(super) radial_growth: [f64; 2],
    /// Warnings about it.
    pub(super) warnings: Vec<Warning>,
}

/// One gear that runs.
#[derive(Default)]
struct GearState {
    growth: FlankGrowth,
    tips: f64,
    stresses: RestingStresses,
    loose: Option<Warning>,
}

impl PairState {
    /// That of `case`, of whose gears `parts` says how they answer to rotation at this grid `level`; `None` of a case that does not run.
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
        let of = |member| GearState::of(&setup, running, member);
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
            deviations,
        }))
    }
}

impl GearState {
    fn of(setup: &Setup<'_>, running: &Running, member: Member) -> Result<Self, AnalysisError> {
        let pair = &setup.case.pair;
        let (gear, own) = (pair.gear(member), &running.gears[member.index()]);
        let mut state = Self {
            tips: own.thermal_strain * gear.tip_radius(),
            ..Self::default()
        };
        let strain = own.thermal_strain - running.shared_strain();
        state.growth.add_strain(gear, strain);
        let speed = running.angular_speed(pair, member);
        let interference = match own.bore {
            Bore::PressFit { interference } => interference,
            Bore::Held | Bore::Free => 0.0,
        };
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
        let mut interference = interference;
        if let Bore::PressFit { .. } = own.bore
            && let Some(loose) = loose_from(&found, interference)
            && speed >= loose
        {
            state.loose = Some(Warning::FitComesLoose {
                member,
                speed: running.driving_speed.0 * loose / speed,
            });
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

/// Adds so much of `lists` to `sums`, which are empty at first.
fn add_lists(sums: &mut Vec<Vec<f64>>, lists: &[Vec<f64>], amount: f64) {
    if sums.is_empty() {
        *sums = lists.iter().map(|list| vec![0.0; list.len()]).collect();
    }
    for (sum, value) in sums.iter_mut().flatten().zip(lists.iter().flatten()) {
        *sum += amount * value;
    }
}

/// The angular speed from which the shaft of `spun`, too large by the `interference` in radius, no longer presses on the bore in the mean.
fn loose_from(spun: &Spun, interference: f64) -> Option<f64> {
    let fit = spun.fit.as_ref()?;
    let (cold, lost) = (interference * fit.pressure, -spun.spin.pressure);
    (lost > 0.0).then(|| (cold.max(0.0) / lost).sqrt())
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
    /// How the gear `member` answers to its rotation, its bore held as `hold` says.
    fn spun(&self, member: Member, hold: Hold) -> Result<Option<Arc<Spun>>, AnalysisError> {
        let spec = self.spec(Blanks::Flexible);
        Ok(spec.spun(member, hold, self.parts, self.run)?)
    }
}
