//! Checks of fields against each other: torques, interface, span, forces and size.

use meshwright_engine::analysis::rotors::unheld;
use meshwright_engine::analysis::{Case, Faces, Method, Resolution};
use meshwright_engine::assembly::NearHoles;
use meshwright_engine::dynamics::mount::extremes;
use meshwright_engine::gear::{GearPair, Member, SpurGear};
use meshwright_engine::vibration::most_modes;

use super::document::{OUTPUT_TORQUE, Purpose, SubmissionDocument};
use crate::declare::{Choice as _, Errors};
use crate::forces::{DynamicsQuestion, ForceTableQuestion, MOTIONS, SpeedRange, Speeds};
use crate::modes::ModesQuestion;
use crate::problem::{Code, FieldError};
use crate::resolution::{ContactSolverDocument, ResolutionDocument};
use crate::units::{Side, plain, rounded_inward, significant};

/// The most positions times torques of one submission.
pub const MOST_POSITIONS: u64 = 20_000;

/// The same for the projected methods on teeth that do not deviate: they solve one mesh period, and add the effect of holes at each position.
pub const MOST_PROJECTED_POSITIONS: u64 = 200_000;

/// The part of the largest eigenvalue, or of a stiffness, that counts as a rounding.
const ROUNDING: f64 = 1e-9;

/// The part of the mesh force that may be left without a reaction.
const UNHELD: f64 = 1e-6;

/// The most mesh periods of a run-up: of its true period, at all speeds, under all torques.
const MOST_PERIODS_RUN: u64 = 200_000;

impl SubmissionDocument {
    /// Refuses torques that would deflect the teeth by more than about a quarter of a module: small displacements and a
    /// search among neighboring flanks mean nothing there.
    pub(super) fn check_torques(&self, pair: &GearPair, errors: &Errors) {
        for (i, &torque) in self.output_torques_n_m.iter().enumerate() {
            let pointer = format!("/{}/{i}", Self::output_torques_n_m.name);
            refuse_large_torque(pair, torque, pointer, errors);
        }
    }

    /// Refuses stresses that the method does not tell.
    pub(super) fn check_stress(&self, errors: &Errors) {
        if self.stress && !self.method.computes_stress() {
            let pointer = format!("/{}", Self::stress.name);
            let methods = Method::OPTIONS.iter();
            let methods: Vec<&str> = methods
                .filter(|(_, method, _)| method.computes_stress())
                .map(|(word, ..)| *word)
                .collect();
            let detail = format!(
                "{pointer} is asked for, and the method {} does not tell it; {} do.",
                self.method.word(),
                methods.join(" and ")
            );
            errors.push(FieldError::new(pointer, Code::QuantityNotTold, detail));
        }
    }

    /// The center distance at which the pair runs over the cold one, in lengths of its gears.
    pub(super) fn distance_growth(&self) -> f64 {
        let running = self.running.as_ref();
        running.map_or(1.0, |running| running.distance_growth(&self.pair))
    }

    /// Refuses a pair that cannot run so, and tables and run-ups of one that runs.
    pub(super) fn check_running(&self, pair: &GearPair, errors: &Errors) {
        let Some(running) = &self.running else {
            return;
        };
        running.check(self.method, (&self.pair, pair), errors);
        let forces = [
            (self.force_table.is_some(), Self::force_table.name),
            (self.dynamics.is_some(), Self::dynamics.name),
        ];
        for (_, name) in forces.into_iter().filter(|(is_asked, _)| *is_asked) {
            let detail = format!(
                "/{name} is asked for beside /running: tables of force and run-ups are those of gears at rest, as drawn. Leave one of them out."
            );
            errors.push(FieldError::new(
                format!("/{name}"),
                Code::QuantityNotTold,
                detail,
            ));
        }
    }

    /// Refuses choices that three dimensions do not have.
    pub(super) fn refuse_plane_choices(&self, errors: &Errors) {
        let solver = matches!(
            self.resolution.contact_solver,
            ContactSolverDocument::AugmentedLagrangian(_)
        );
        if solver {
            let pointer = format!("/resolution/{}", ResolutionDocument::contact_solver.name);
            let detail = format!("{pointer}: three dimensions are solved by the active set alone.");
            errors.push(FieldError::new(pointer, Code::NotInThreeDimensions, detail));
        }
    }

    /// Refuses holes whose fields cannot be followed along faces, by the finest of the runs.
    pub(super) fn check_holes(&self, faces: &Faces, errors: &Errors) {
        let Resolution {
            grid,
            error_estimate,
            ..
        } = self.resolution.data();
        let finest = match error_estimate {
            true => grid.max(grid.neighbor()),
            false => grid,
        };
        let resolution = faces.resolution.at(finest);
        for member in Member::BOTH {
            let Some(near) = NearHoles::of(faces.pair.gear(member), resolution) else {
                continue;
            };
            for error in self
                .pair
                .gear(member)
                .near_holes(&format!("/pair/{member}"), &near)
            {
                errors.push(error);
            }
        }
    }

    /// Dynamics need a table.
    pub(super) fn fill_in_table(&mut self) {
        if self.dynamics.is_some() {
            self.force_table
                .get_or_insert_with(ForceTableQuestion::usual);
        }
    }

    /// Refuses a table of a part of the true period or of loads that cannot be, and a run-up without load or with speeds that do not rise.
    pub(super) fn check_forces(&self, pair: &GearPair, errors: &Errors) {
        let Some(table) = &self.force_table else {
            return;
        };
        let (span, period) = (self.resolution.span_mesh_periods, pair.period());
        if span.is_some_and(|span| span % period != 0) {
            let pointer = format!("/resolution/{}", ResolutionDocument::span_mesh_periods.name);
            let detail = format!(
                "{pointer} is {}; a force table and a run-up need the true period, {period} mesh periods.",
                span.unwrap_or(0)
            );
            errors.push(
                FieldError::new(pointer, Code::OutOfRange, detail).nearest(f64::from(period)),
            );
        }
        let torques = &self.output_torques_n_m;
        let largest = torques.iter().copied().fold(0.0, f64::max);
        let pointer = format!(
            "/{}/{}",
            Self::force_table.name,
            ForceTableQuestion::largest_output_torque_n_m.name
        );
        match table.largest_output_torque_n_m {
            None if largest == 0.0 => {
                let detail = format!(
                    "{pointer} is not given, and the largest output torque is 0; a table needs a load."
                );
                errors.push(FieldError::new(pointer, Code::MissingField, detail));
            }
            // The default table ends at the load that the teeth bear.
            None => {}
            Some(given) if self.dynamics.is_some() && given < largest => {
                let detail = format!(
                    "{pointer} is {} N m; a run-up at {} N m needs a table that goes at least as far.",
                    plain(given),
                    plain(largest)
                );
                errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(largest));
            }
            Some(given) => refuse_large_torque(pair, given, pointer, errors),
        }
        if let Some(dynamics) = &self.dynamics {
            self.check_run_up(dynamics, pair, errors);
        }
    }

    /// Refuses more modes than the grid of a gear carries, and gears that have no counterpart in three dimensions.
    pub(super) fn check_modes(&self, case: &Case, errors: &Errors) {
        let Some(modes) = &self.modes else {
            return;
        };
        for member in Member::BOTH {
            let z = case.pair.gear(member).tooth_count();
            let most = most_modes(z);
            if modes.count as usize > most {
                let pointer = format!("/{}/{}", Self::modes.name, ModesQuestion::count.name);
                let detail = format!(
                    "{pointer} is {}; the grid of the {member} gear, with {z} teeth, carries {most} modes.",
                    modes.count
                );
                errors
                    .push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(most as f64));
                return;
            }
            if let Err(error) = case.solid_gear(member) {
                let pointer = format!("/{}", Self::modes.name);
                let detail = format!(
                    "{pointer} takes the {member} gear in three dimensions, where it cannot be made: {error}."
                );
                errors.push(FieldError::new(pointer, Code::DiscretizationFailed, detail));
            }
        }
    }

    /// Refuses supports that are no stiffness, or leave a gear without a reaction to the mesh force.
    pub(super) fn check_supports(&self, case: &Case, errors: &Errors) {
        let dynamics = self.dynamics.as_ref();
        let Some(supports) = dynamics.and_then(|dynamics| dynamics.support_stiffness.as_ref())
        else {
            return;
        };
        for member in Member::BOTH {
            let Some(rows) = supports.of(member) else {
                continue;
            };
            let pointer = format!(
                "/{}/{}/{member}",
                Self::dynamics.name,
                DynamicsQuestion::support_stiffness.name
            );
            if let Err(error) = check_support(rows, &pointer) {
                errors.push(error);
                continue;
            }
            let Some(stiffness) = supports.matrix(member) else {
                continue;
            };
            let [least, largest] = extremes(&stiffness);
            if least < -ROUNDING * largest.abs().max(least.abs()) {
                let detail = format!(
                    "{pointer} has the eigenvalue {}: the support would push the gear on. A stiffness has none below 0.",
                    plain(significant(least, 4))
                );
                errors.push(FieldError::new(pointer, Code::OutOfRange, detail));
                continue;
            }
            let left = unheld(case, member, &stiffness);
            if left > UNHELD {
                let detail = format!(
                    "{pointer} leaves {} % of the mesh force without a reaction: the {member} gear is free to move along it. Leave the support out for an axis that stands still.",
                    plain(significant(100.0 * left, 3))
                );
                errors.push(FieldError::new(pointer, Code::OutOfRange, detail));
            }
        }
    }

    fn check_run_up(&self, dynamics: &DynamicsQuestion, pair: &GearPair, errors: &Errors) {
        for (i, torque) in self.output_torques_n_m.iter().enumerate() {
            if *torque == 0.0 {
                let pointer = format!("/{}/{i}", Self::output_torques_n_m.name);
                let detail = format!(
                    "{pointer} is 0; without a load nothing holds the flanks together, and there is no run-up."
                );
                let nearest = OUTPUT_TORQUE.bounds.0;
                errors.push(
                    FieldError::new(pointer, Code::TorqueNotPositive, detail).nearest(nearest),
                );
            }
        }
        let speeds = &dynamics.driving_speed_rpm;
        let within = format!(
            "/{}/{}",
            Self::dynamics.name,
            DynamicsQuestion::driving_speed_rpm.name
        );
        if let Speeds::Range(range) = speeds
            && range.to <= range.from
        {
            let most = SpeedRange::to.spec.bounds.1;
            let (name, nearest) = if range.from < most {
                (SpeedRange::to.name, (range.from + 1.0).min(most))
            } else {
                (SpeedRange::from.name, most - 1.0)
            };
            let detail = format!(
                "{within} goes from {} to {} 1/min; speeds have to rise.",
                plain(range.from),
                plain(range.to)
            );
            let pointer = format!("{within}/{name}");
            errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest));
        }
        let each = u64::from(pair.period()) * self.output_torques_n_m.len() as u64;
        let total = each * u64::from(speeds.count());
        if total > MOST_PERIODS_RUN {
            let fits = MOST_PERIODS_RUN / each;
            let detail = format!(
                "{} of {} at {} are {total} mesh periods; the limit is {MOST_PERIODS_RUN}. What would fit: {}.",
                counted(u64::from(speeds.count()), "speed"),
                counted(u64::from(pair.period()), "mesh period"),
                counted(self.output_torques_n_m.len() as u64, "torque"),
                counted(fits, "speed")
            );
            let pointer = format!("{within}/{}", SpeedRange::count.name);
            let nearest = (fits >= 2).then_some(fits as f64);
            errors.push(FieldError::new(pointer, Code::TooLarge, detail).nearest(nearest));
        }
    }

    pub(super) fn check_interface(&self, pair: &GearPair, errors: &Errors) {
        let pointer = format!(
            "/resolution/{}",
            ResolutionDocument::interface_radius_mm.name
        );
        let faults = self.resolution.interface_radius_mm.faults(pair, &pointer);
        errors.report::<()>(Err(faults));
    }

    pub(super) fn check_span(&self, pair: &GearPair, errors: &Errors) {
        let (Some(span), period) = (self.resolution.span_mesh_periods, pair.period()) else {
            return;
        };
        if span > period && span % period != 0 {
            let nearest =
                (f64::from(span) / f64::from(period)).round().max(1.0) * f64::from(period);
            let pointer = format!("/resolution/{}", ResolutionDocument::span_mesh_periods.name);
            let detail = format!(
                "{pointer} is {span}; the true period is {period} mesh periods, and a longer span has to be a whole multiple of it."
            );
            errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest));
        }
    }

    /// Refuses windows of whole true periods, beyond the true period, or over each other.
    pub(super) fn check_windows(&self, pair: &GearPair, errors: &Errors) {
        let (starts, period) = (self.resolution.windows(), pair.period());
        if starts.is_empty() {
            return;
        }
        let pointer = format!("/resolution/{}", ResolutionDocument::window_starts.name);
        let span = self.resolution.span_mesh_periods.unwrap_or(period);
        if span >= period {
            let detail = format!(
                "{pointer} are windows of {span} mesh periods, and the true period has {period}; leave them out, or give a span_mesh_periods below it."
            );
            errors.push(FieldError::new(pointer, Code::ConflictingFields, detail));
            return;
        }
        for (i, start) in starts.iter().enumerate() {
            let pointer = format!("{pointer}/{i}");
            if *start >= period {
                let detail = format!(
                    "{pointer} is {start}; the true period has {period} mesh periods, of which the last begins at {}.",
                    period - 1
                );
                let nearest = f64::from(period - 1);
                errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest));
                return;
            }
            let before = starts[..i].last().map_or(0, |before| before + span);
            if *start < before || (i > 0 && start + span > starts[0] + period) {
                let detail = format!(
                    "{pointer} is {start}; windows rise and do not overlap, at the end of the true period of {period} neither, and each has {span} mesh periods."
                );
                errors.push(FieldError::new(pointer, Code::OutOfRange, detail));
                return;
            }
        }
    }

    pub(super) fn check_size(&self, purpose: Purpose, pair: &GearPair, errors: &Errors) {
        let most = if self.method.is_projected() && pair.is_as_drawn() {
            MOST_PROJECTED_POSITIONS
        } else {
            MOST_POSITIONS
        };
        let (limit, said) = match purpose {
            Purpose::Job => (most, format!("the limit is {most}")),
            Purpose::Preview { most_positions } => (
                most_positions,
                format!("the limit of a preview is {most_positions}, that of POST /v1/jobs {most}"),
            ),
        };
        let resolution = &self.resolution;
        let windows = resolution.windows().len().max(1) as u64;
        let span = u64::from(resolution.span_mesh_periods.unwrap_or(1)) * windows;
        let (positions, torques) = (
            u64::from(resolution.positions_per_mesh_period),
            self.output_torques_n_m.len() as u64,
        );
        let loads = self.force_table.as_ref().map_or(0, |table| table.loads);
        // Of each position of a mesh period.
        let of_table = u64::from(loads) * u64::from(pair.period());
        let of_curves = span * torques;
        let total = positions * (of_curves + of_table);
        if total <= limit {
            return;
        }
        let left = limit.saturating_sub(positions * of_table);
        let fitting_positions = limit / (of_curves + of_table);
        let fitting_torques = left / (span * positions);
        let fitting_span = left / (positions * torques * windows);
        let mut ways = Vec::new();
        let least_positions = ResolutionDocument::positions_per_mesh_period.spec.bounds.0 as u64;
        if fitting_positions >= least_positions {
            ways.push(format!("{fitting_positions} positions in a mesh period"));
        }
        if fitting_torques >= 1 {
            ways.push(counted(fitting_torques, "torque"));
        }
        let (fewest_loads, _) = ForceTableQuestion::loads.spec.bounds;
        let fitting_loads =
            (limit / positions).saturating_sub(of_curves) / u64::from(pair.period());
        if of_table > 0 && fitting_loads >= fewest_loads as u64 {
            ways.push(format!("{fitting_loads} loads"));
        }
        if fitting_span >= 1 && of_table == 0 {
            ways.push(format!(
                "{} of {}",
                if windows > 1 { "windows" } else { "a span" },
                counted(fitting_span, "mesh period")
            ));
        }
        if ways.is_empty() {
            ways.push("less of more than one of them".to_owned());
        }
        let (name, nearest) = if fitting_positions >= least_positions {
            (
                ResolutionDocument::positions_per_mesh_period.name,
                Some(fitting_positions as f64),
            )
        } else {
            let nearest = (fitting_span >= 1).then_some(fitting_span as f64);
            (ResolutionDocument::span_mesh_periods.name, nearest)
        };
        let table = if of_table > 0 {
            format!(
                " and a force table of {} mesh periods at {loads} loads",
                pair.period()
            )
        } else {
            String::new()
        };
        let detail = format!(
            "{} of {positions} positions at {}{table} are {total} positions; {said}. What would fit: {}.",
            counted(span, "mesh period"),
            counted(torques, "torque"),
            ways.join(", or ")
        );
        let pointer = format!("/resolution/{name}");
        errors.push(FieldError::new(pointer, Code::TooLarge, detail).nearest(nearest));
    }
}

/// Count and noun in words, from the singular `one`.
fn counted(count: u64, one: &str) -> String {
    format!("{count} {one}{}", if count == 1 { "" } else { "s" })
}

/// The output torque in N m that deflects the teeth of `pair` by about a quarter of a module.
pub(super) fn bearable_torque(pair: &GearPair) -> f64 {
    const LARGEST_DEFLECTION: f64 = 0.25;
    // The usual mesh stiffness of steel gears, 14 N/(mm um), in proportion to Young's modulus.
    const USUAL_STIFFNESS: f64 = 14e9 / 210e9;
    let modulus = |gear: &SpurGear| gear.material().youngs_modulus;
    let softer = modulus(pair.driving()).min(modulus(pair.driven()));
    let module = pair.driving().data().rack.module;
    let largest_load =
        LARGEST_DEFLECTION * module * USUAL_STIFFNESS * softer * pair.common_face_width();
    largest_load * pair.driven().base_radius()
}

/// Refuses a `torque`, which stands at `pointer`, that would deflect the teeth of `pair` by more than about a quarter of a module.
fn refuse_large_torque(pair: &GearPair, torque: f64, pointer: String, errors: &Errors) {
    let largest = bearable_torque(pair);
    if torque > largest {
        let nearest = rounded_inward(largest, Side::AtMost, 0);
        let detail = format!(
            "{pointer} is {} N m, which would deflect these teeth by more than about a quarter of a module; at most {} N m.",
            plain(torque),
            plain(nearest)
        );
        errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest));
    }
}

/// Refuses a support that has not six rows of six numbers, or is not symmetric.
fn check_support(rows: &[Vec<f64>], pointer: &str) -> Result<(), FieldError> {
    let wrong_length = |pointer: String, count: usize, of: &str| {
        let detail = format!("{pointer} has {count} {of}; a support has {MOTIONS} by {MOTIONS}.");
        FieldError::new(pointer, Code::WrongLength, detail).nearest(MOTIONS as f64)
    };
    if rows.len() != MOTIONS {
        return Err(wrong_length(pointer.to_owned(), rows.len(), "rows"));
    }
    for (i, row) in rows.iter().enumerate() {
        if row.len() != MOTIONS {
            let pointer = format!("{pointer}/{i}");
            return Err(wrong_length(pointer, row.len(), "numbers"));
        }
    }
    for (i, row) in rows.iter().enumerate() {
        for (j, (other, own)) in rows.iter().map(|row| row[i]).zip(row).enumerate().take(i) {
            if (own - other).abs() > ROUNDING * own.abs().max(other.abs()) {
                let pointer = format!("{pointer}/{i}/{j}");
                let detail = format!(
                    "{pointer} is {}, and its counterpart across the diagonal {}; a stiffness is symmetric.",
                    plain(*own),
                    plain(other)
                );
                return Err(FieldError::new(pointer, Code::OutOfRange, detail).nearest(other));
            }
        }
    }
    Ok(())
}
