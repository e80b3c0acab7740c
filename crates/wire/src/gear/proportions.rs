//! Bounds of a gear's numbers that depend on its other numbers, so that nothing degenerate reaches the grids.

use meshwright_engine::gear::{Helix, SpurGear};

use super::faults::Fault;
use super::field::Field;
use super::relief::Relief;
use super::{GearDocument, LEAST_RACK_TIP_RADIUS, USUAL_DEDENDUM};
use crate::problem::{Code, FieldError};
use crate::units::{Side, from_mm, plain};

impl GearDocument {
    /// Makes the gear, or tells the first thing that prevents it.
    pub(super) fn made(&self, helix: Helix) -> Result<SpurGear, Fault> {
        self.check_proportions(helix)?;
        let gear = self
            .section(helix)
            .map_err(|error| self.fault(&error, helix))?;
        self.check_gauge(&gear, helix)?;
        // A relief that begins where it ends is a step, which no grid and no contact search can follow.
        let short = self.relief_places().find_map(|place| {
            let relief = self.relief(place).filter(Relief::is_there)?;
            let start = relief.start.radius(&gear);
            let (least, most) =
                self.relief_range(relief.start.end, [gear.form_radius(), gear.tip_radius()]);
            (!(least..=most).contains(&start)).then_some((place, start))
        });
        match short {
            Some((place, start)) => {
                let ends = [gear.form_radius(), gear.tip_radius()];
                Err(self.relief_fault(place, start, ends))
            }
            None => Ok(gear),
        }
    }

    fn check_proportions(&self, helix: Helix) -> Result<(), Fault> {
        let m = self.module_mm;
        self.check_addendum(helix)?;
        self.check_thickness(helix)?;
        self.check_dedendum(helix)?;
        check_between(
            Field::of("", Self::rack_tip_radius_mm),
            self.rack_tip_radius_mm,
            LEAST_RACK_TIP_RADIUS * m,
            2.0 * m,
            &format!("{LEAST_RACK_TIP_RADIUS} and 2 modules"),
        )?;
        self.check_protuberance()?;
        let (edge, broken) = self.tip_edge_field();
        if broken > 0.0 {
            let least = 0.01 * m;
            check_between(edge, broken, least, f64::INFINITY, "0.01 modules and more")?;
        }
        // A bore or a hole that is a mere point has a logarithmically singular compliance.
        let least_bore = 0.05 * self.root_radius_mm();
        let (core, radius) = self.blank.core_field();
        check_between(
            core,
            radius,
            least_bore,
            f64::INFINITY,
            "5 % of the root radius and more",
        )?;
        for (i, pattern) in self.blank.holes.patterns().iter().enumerate() {
            check_between(
                self.hole_width(i),
                pattern.width(),
                pattern.of_half_width(self.least_hole_mm()),
                f64::INFINITY,
                "1 % of the root radius to each side and more",
            )?;
        }
        self.check_openings()?;
        self.check_web()
    }

    /// The addendum has its bounds in modules, and they are those of the tip diameter too.
    fn check_addendum(&self, helix: Helix) -> Result<(), Fault> {
        let said = |modules: f64| self.tip_said(modules * self.module_mm, helix);
        check_between(
            self.tip_field(),
            self.tip_diameter_mm.unwrap_or_else(|| self.addendum(helix)),
            said(0.2),
            said(2.0),
            "an addendum of 0.2 to 2 modules",
        )
    }

    /// The dedendum has its bounds in modules, and they are those of the root diameter too.
    fn check_dedendum(&self, helix: Helix) -> Result<(), Fault> {
        let said = |modules: f64| self.root_said(modules * self.module_mm, helix);
        let (at_least, at_most) = (said(0.5).min(said(2.5)), said(0.5).max(said(2.5)));
        check_between(
            self.root_field(),
            self.root_diameter_mm
                .unwrap_or_else(|| self.dedendum(helix)),
            at_least,
            at_most,
            "a dedendum of 0.5 to 2.5 modules",
        )
    }

    pub(super) fn least_hole_mm(&self) -> f64 {
        0.01 * self.root_radius_mm()
    }

    /// The root radius of straight teeth of nominal thickness, in mm: as near as the least sizes of bores and holes need it.
    fn root_radius_mm(&self) -> f64 {
        let nominal = |dedendum: f64| self.shifted_radius_mm(Helix::STRAIGHT) - dedendum;
        match self.root_diameter_mm {
            Some(diameter) => diameter / 2.0,
            None => nominal(self.dedendum_mm.unwrap_or(USUAL_DEDENDUM * self.module_mm)),
        }
    }

    /// The base radius, in mm.
    pub(super) fn base_radius_mm(&self) -> f64 {
        let reference = self.module_mm * f64::from(self.tooth_count) / 2.0;
        reference * self.pressure_angle_deg.to_radians().cos()
    }

    /// The least radial length of a relief, in meters.
    pub(super) fn least_relief(&self) -> f64 {
        0.01 * from_mm(self.module_mm)
    }

    /// Faults of its lists, which no single number mends.
    pub(super) fn list_faults(&self, pointer: &str) -> Vec<FieldError> {
        let modifications = self.profile_modifications.iter().enumerate();
        let tables = modifications.filter_map(|(i, modification)| Some((i, modification.table()?)));
        let of_tables = tables.flat_map(|(i, table)| {
            let place = format!("{pointer}/profile_modifications/{i}");
            table.faults(&place, self.module_mm, self.base_radius_mm())
        });
        let of_deviations = self.tooth_deviations.iter().flat_map(|deviations| {
            let place = format!("{pointer}/tooth_deviations");
            let size = (self.tooth_count, self.module_mm);
            deviations.faults(&place, size, self.base_radius_mm())
        });
        let of_holes = self.blank.too_many(pointer);
        of_tables.chain(of_deviations).chain(of_holes).collect()
    }

    /// The same gear without lists, its modifications in their places.
    pub(super) fn without_lists(&self) -> Self {
        let mut gear = self.clone();
        gear.tooth_deviations = None;
        if gear.blank.too_many("").is_some() {
            gear.blank = gear.blank.without_openings();
        }
        for modification in &mut gear.profile_modifications {
            modification.empty_table();
        }
        gear
    }
}

/// Refuses a `value` of `field` that is outside its bounds, which are `said` in words.
pub(super) fn check_between(
    field: Field,
    value: f64,
    least: f64,
    most: f64,
    said: &str,
) -> Result<(), Fault> {
    // Rounding of values that were computed from the other numbers.
    const ROUNDING: f64 = 1e-12;
    let bound = if value < least - ROUNDING * least.abs() {
        (least, Side::AtLeast)
    } else if value > most + ROUNDING * most.abs() {
        (most, Side::AtMost)
    } else {
        return Ok(());
    };
    let detail = format!("{} {} is outside {said}.", plain(value), field.unit);
    Err(Fault::new(field, Code::OutOfRange, detail, Some(bound)))
}
