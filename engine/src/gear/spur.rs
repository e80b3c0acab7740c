//! A whole spur gear: what its drawing says, checked once.

use std::f64::consts::PI;

use super::blank::Ligament;
use super::data::{DeviationList, LEAST_LIGAMENT, LEAST_RIM, LEAST_TIP_THICKNESS, LEAST_WEB_RIM};
use super::involute::involute_function;
use super::modification::{Modification, Relief, TablePlaces};
use super::rack::Trochoid;
use super::tip::BrokenEdge;
use super::{
    BlankRegion, GearData, GearError, Hole, HolePattern, Involute, Material, ModificationData,
    TipEdge, ToothDeviations,
};
use crate::root_finding::bisect;

/// A spur gear that can be made: neither undercut nor pointed, with its holes inside its blank.
///
/// Lengths are in meters, angles in radians.
#[derive(Debug, Clone, PartialEq)]
pub struct SpurGear {
    data: GearData,
    flank: Involute,
    broken_edge: Option<BrokenEdge>,
    modifications: Vec<Modification>,
    hole_repeats: u32,
}

impl SpurGear {
    /// Checks a drawing.
    ///
    /// # Errors
    ///
    /// [`GearError`] says which part cannot be made and what would do.
    pub fn new(data: GearData) -> Result<Self, GearError> {
        let rack = &data.rack;
        let (z, alpha) = (f64::from(data.tooth_count), rack.pressure_angle);
        let r = rack.module * z / 2.0;
        let psi_b = PI / (2.0 * z)
            + 2.0 * data.profile_shift * alpha.tan() / z
            + involute_function(alpha)
            + data.thickness_deviation / (2.0 * r);
        let mut gear = Self {
            data,
            flank: Involute::new(r * alpha.cos(), psi_b),
            broken_edge: None,
            modifications: Vec::new(),
            hole_repeats: 0,
        };

        gear.check_rack()?;
        gear.check_tooth()?;
        gear.broken_edge = gear.checked_edge()?;
        gear.check_blank()?;
        gear.hole_repeats = gear.data.blank.symmetry().count;
        gear.modifications = gear.checked_modifications()?;
        gear.check_deviations()?;
        Ok(gear)
    }

    fn check_rack(&self) -> Result<(), GearError> {
        let rack = &self.data.rack;
        let largest = rack.largest_tip_radius();
        if rack.tip_radius > largest {
            return Err(GearError::RackTipRadius {
                tip_radius: rack.tip_radius,
                largest,
            });
        }
        let largest = 2.0 * rack.half_tip_land();
        // Rounding of a full tip radius leaves a land of nothing, or a little less.
        if self.data.thickness_deviation > largest.max(0.0) {
            return Err(GearError::TeethTooThick {
                deviation: self.data.thickness_deviation,
                largest: largest.max(0.0),
            });
        }
        Ok(())
    }

    fn check_tooth(&self) -> Result<(), GearError> {
        let rack = &self.data.rack;
        let (r, sin) = (self.reference_radius(), rack.pressure_angle.sin());
        if self.form_roll_length_signed() < 0.0 {
            let smallest = (rack.straight_depth() - r * sin * sin) / rack.module;
            return Err(GearError::Undercut {
                profile_shift: self.data.profile_shift,
                smallest,
            });
        }
        let (r_a, r_form) = (self.tip_radius(), self.form_radius());
        if r_a <= r_form {
            return Err(GearError::NoFlank {
                tip_radius: r_a,
                form_radius: r_form,
            });
        }
        let thickness = self.tip_thickness();
        if thickness < LEAST_TIP_THICKNESS * rack.module {
            return Err(GearError::PointedTip {
                thickness,
                largest_addendum: self.largest_addendum(),
            });
        }
        Ok(())
    }

    fn check_blank(&self) -> Result<(), GearError> {
        let bore_radius = self.data.blank.bore_radius;
        let largest = self.root_radius() - LEAST_RIM * self.data.rack.module;
        if bore_radius > largest {
            return Err(GearError::BoreTooLarge {
                bore_radius,
                largest,
            });
        }
        let blank = &self.data.blank;
        for (place, ligament) in blank.ligaments(self.root_radius()) {
            // Written so that a ligament that is not a number is refused as well.
            if ligament >= LEAST_LIGAMENT {
                continue;
            }
            let with = |hole: usize, gained: f64| {
                blank.holes[hole].half_width() + gained * (ligament - LEAST_LIGAMENT)
            };
            return Err(match place {
                Ligament::Between(one, other) => GearError::HolesOverlap {
                    holes: [one, other],
                    ligament,
                    largest_radius: with(other, 0.5),
                },
                Ligament::WithinSlot(hole) => GearError::HolesOverlap {
                    holes: [hole; 2],
                    ligament,
                    largest_radius: with(hole, 0.5),
                },
                Ligament::ToRim(hole) => GearError::HolesBreachRim {
                    hole,
                    ligament,
                    largest_radius: with(hole, 1.0),
                },
                Ligament::ToBore(hole) => GearError::HolesBreachBore {
                    hole,
                    ligament,
                    largest_radius: with(hole, 1.0),
                },
            });
        }
        if let Some(web) = blank.web {
            let largest = self.root_radius() - LEAST_WEB_RIM * self.data.rack.module;
            let (inner_radius, outer_radius) = (web.inner_radius, web.outer_radius);
            if !(inner_radius >= bore_radius
                && outer_radius > inner_radius
                && outer_radius <= largest)
            {
                return Err(GearError::WebOutside {
                    inner_radius,
                    outer_radius,
                    least: bore_radius,
                    largest,
                });
            }
        }
        Ok(())
    }

    fn checked_edge(&self) -> Result<Option<BrokenEdge>, GearError> {
        let (amount, of): (f64, fn(f64) -> TipEdge) = match self.data.tip_edge {
            TipEdge::Sharp => return Ok(None),
            TipEdge::Rounded(radius) => (radius, TipEdge::Rounded),
            TipEdge::Chamfered(depth) => (depth, TipEdge::Chamfered),
        };
        let broken = |amount: f64| BrokenEdge::new(of(amount), &self.flank, self.tip_radius());
        let fits = |amount: f64| {
            broken(amount)
                .is_some_and(|edge| edge.from > self.form_roll_length() && edge.half_angle() > 0.0)
        };
        if amount <= 0.0 {
            return Ok(None);
        }
        if !fits(amount) {
            let largest = bisect(0.0, amount, fits);
            return Err(GearError::TipEdgeTooLarge { amount, largest });
        }
        Ok(broken(amount))
    }

    fn checked_modifications(&self) -> Result<Vec<Modification>, GearError> {
        let (s_f, s_a) = (self.form_roll_length(), self.tip_roll_length());
        let mut checked = Vec::new();
        for (index, data) in self.data.modifications.iter().enumerate() {
            checked.push(match data {
                ModificationData::TipRelief(relief) => {
                    let r_s = relief.start.radius(&self.flank, self.tip_radius());
                    if relief.amount == 0.0 {
                        continue;
                    }
                    self.check_start(index, r_s, self.tip_radius())?;
                    Modification::Tip(Relief::new(
                        relief.amount,
                        relief.shape,
                        r_s,
                        self.tip_radius(),
                    ))
                }
                ModificationData::RootRelief(relief) => {
                    let r_s = relief.start.radius(&self.flank, self.form_radius());
                    if relief.amount == 0.0 {
                        continue;
                    }
                    self.check_start(index, r_s, self.form_radius())?;
                    Modification::Root(Relief::new(
                        relief.amount,
                        relief.shape,
                        r_s,
                        self.form_radius(),
                    ))
                }
                ModificationData::Crowning { amount } => Modification::Crowning {
                    amount: *amount,
                    middle: f64::midpoint(s_f, s_a),
                    half: 0.5 * (s_a - s_f),
                },
                ModificationData::Slope { amount } => Modification::Slope {
                    amount: *amount,
                    from: s_f,
                    length: s_a - s_f,
                },
                ModificationData::Table { places, removed } => {
                    self.checked_table(index, places, removed)?
                }
            });
        }
        Ok(checked)
    }

    /// Whether a relief that ends at `end_radius` starts elsewhere on the flank.
    fn check_start(
        &self,
        modification: usize,
        start_radius: f64,
        end_radius: f64,
    ) -> Result<(), GearError> {
        let (form_radius, tip_radius) = (self.form_radius(), self.tip_radius());
        if (form_radius..=tip_radius).contains(&start_radius) && start_radius != end_radius {
            return Ok(());
        }
        Err(GearError::ReliefTooLong {
            modification,
            start_radius,
            form_radius,
            tip_radius,
        })
    }

    fn checked_table(
        &self,
        modification: usize,
        places: &TablePlaces,
        removed: &[f64],
    ) -> Result<Modification, GearError> {
        let places: Vec<f64> = match places {
            TablePlaces::RollLengths(lengths) => lengths.clone(),
            TablePlaces::Diameters(diameters) => diameters
                .iter()
                .map(|diameter| self.flank.roll_length(diameter / 2.0))
                .collect(),
        };
        let fault = |entry| {
            Err(GearError::TableDoesNotRise {
                modification,
                entry,
            })
        };
        if places.len() < 2 || places.len() != removed.len() {
            return fault(places.len().min(removed.len()));
        }
        match places.windows(2).position(|pair| pair[0] >= pair[1]) {
            Some(before) => fault(before + 1),
            None => Ok(Modification::Table {
                places,
                removed: removed.to_vec(),
            }),
        }
    }

    fn check_deviations(&self) -> Result<(), GearError> {
        let needed = self.data.tooth_count as usize;
        let deviations = &self.data.deviations;
        for (list, values) in [
            (DeviationList::Pitch, &deviations.cumulative_pitch),
            (DeviationList::ProfileSlope, &deviations.profile_slope),
        ] {
            if !values.is_empty() && values.len() != needed {
                return Err(GearError::DeviationCount {
                    list,
                    given: values.len(),
                    needed,
                });
            }
        }
        Ok(())
    }

    /// The drawing.
    pub fn data(&self) -> &GearData {
        &self.data
    }

    /// The same teeth on a blank without bore and holes: what is left to say where the blank does not matter.
    pub fn without_blank(&self) -> Self {
        self.on_blank(BlankRegion::solid(0.0))
    }

    /// The same gear without holes.
    pub fn without_holes(&self) -> Self {
        self.on_blank(BlankRegion {
            holes: Vec::new(),
            ..self.data.blank.clone()
        })
    }

    /// The same gear with hole 0 at the angle 0.
    pub fn with_holes_unturned(&self) -> Self {
        self.on_blank(self.data.blank.turned(-self.hole_angle()))
    }

    /// The same gear with flanks as the rack cuts them, each like the other, up to a sharp tip.
    pub fn with_plain_flanks(&self) -> Self {
        Self {
            data: GearData {
                tip_edge: TipEdge::Sharp,
                modifications: Vec::new(),
                deviations: ToothDeviations::default(),
                ..self.data.clone()
            },
            broken_edge: None,
            modifications: Vec::new(),
            ..self.clone()
        }
    }

    /// The same gear with teeth that do not deviate.
    pub fn as_drawn(&self) -> Self {
        Self {
            data: GearData {
                deviations: ToothDeviations::default(),
                ..self.data.clone()
            },
            ..self.clone()
        }
    }

    /// The same gear on a `blank` that is known to fit.
    fn on_blank(&self, blank: BlankRegion) -> Self {
        Self {
            hole_repeats: blank.symmetry().count,
            data: GearData {
                blank,
                ..self.data.clone()
            },
            ..self.clone()
        }
    }

    /// The number of teeth Z.
    pub fn tooth_count(&self) -> u32 {
        self.data.tooth_count
    }

    /// The face width b.
    pub fn face_width(&self) -> f64 {
        self.data.face_width
    }

    /// The material.
    pub fn material(&self) -> &Material {
        &self.data.material
    }

    /// The bore radius.
    pub fn bore_radius(&self) -> f64 {
        self.data.blank.bore_radius
    }

    /// The holes of the blank.
    pub fn holes(&self) -> &[Hole] {
        &self.data.blank.holes
    }

    /// Whether it has holes.
    pub fn has_holes(&self) -> bool {
        !self.holes().is_empty()
    }

    /// The holes as one pattern of equal round ones, if that is what they are.
    pub fn hole_pattern(&self) -> Option<HolePattern> {
        self.data.blank.pattern()
    }

    /// The angle of hole 0 from the centerline of tooth 0; 0 without holes.
    pub fn hole_angle(&self) -> f64 {
        self.holes().first().map_or(0.0, |hole| hole.angle)
    }

    /// How often the holes repeat around the blank: N of a pattern; 0 without holes.
    pub fn hole_repeats(&self) -> u32 {
        self.hole_repeats
    }

    /// The loaded flank of tooth 0.
    pub fn flank(&self) -> &Involute {
        &self.flank
    }

    /// The fillet of tooth 0 on its loaded side.
    pub fn fillet(&self) -> Trochoid {
        Trochoid::new(
            &self.data.rack,
            self.data.tooth_count,
            self.profile_shift_length(),
            self.data.thickness_deviation,
        )
    }

    /// The first tip relief, if there is any.
    pub fn tip_relief(&self) -> Option<&Relief> {
        self.modifications.iter().find_map(|each| match each {
            Modification::Tip(relief) => Some(relief),
            _ => None,
        })
    }

    /// The material removed from every loaded flank at the roll length `s`, along the normal: modifications and the broken edge.
    pub fn removed(&self, s: f64) -> f64 {
        let edge = self
            .broken_edge
            .map_or(0.0, |edge| edge.depth_and_slope(&self.flank, s).0);
        self.modified(s) + edge
    }

    /// The part of [`SpurGear::removed`] that is meant by modifications, without the broken edge.
    pub(super) fn modified(&self, s: f64) -> f64 {
        let depths = self
            .modifications
            .iter()
            .map(|each| each.depth(&self.flank, s));
        depths.sum()
    }

    /// The slope of [`SpurGear::removed`] by the roll length.
    pub fn removed_slope(&self, s: f64) -> f64 {
        let modified = self
            .modifications
            .iter()
            .map(|each| each.slope(&self.flank, s));
        let edge = self
            .broken_edge
            .map_or(0.0, |edge| edge.depth_and_slope(&self.flank, s).1);
        modified.sum::<f64>() + edge
    }

    /// Whether the modifications only ever bend the flank away from its mate.
    pub fn is_convex(&self) -> bool {
        self.modifications.iter().all(Modification::is_convex)
    }

    /// How the teeth deviate from each other.
    pub fn deviations(&self) -> &ToothDeviations {
        &self.data.deviations
    }

    /// How far the loaded flank of `tooth` stands towards its mate at the roll length `s`, along the normal, beyond the drawing.
    ///
    /// An arc f on the reference circle turns the flank by f/r, which is f cos α along the base tangent.
    pub fn deviation(&self, tooth: usize, s: f64) -> f64 {
        let ToothDeviations {
            cumulative_pitch,
            profile_slope,
            ..
        } = &self.data.deviations;
        let pitch = cumulative_pitch
            .get(tooth)
            .map_or(0.0, |arc| arc * self.data.rack.pressure_angle.cos());
        let slope = profile_slope.get(tooth).map_or(0.0, |amount| {
            let (from, to) = (self.form_roll_length(), self.tip_roll_length());
            amount * (s - from) / (to - from)
        });
        pitch + slope
    }

    /// How far the eccentricity moves the loaded flank of `tooth` along its normal at the roll length `s`, to the first order in it.
    pub fn runout(&self, tooth: usize, s: f64) -> f64 {
        let normal = tooth as f64 * self.pitch_angle() + self.flank.tangent_angle(s) + PI / 2.0;
        let moved = self.data.deviations.displacement(0.0);
        moved.x * normal.cos() + moved.y * normal.sin()
    }

    /// The slope of [`SpurGear::deviation`] by the roll length.
    pub fn deviation_slope(&self, tooth: usize) -> f64 {
        let amount = self.data.deviations.profile_slope.get(tooth);
        amount.map_or(0.0, |amount| {
            amount / (self.tip_roll_length() - self.form_roll_length())
        })
    }

    /// The largest and the smallest [`SpurGear::deviation`] of any point of any flank.
    pub fn deviation_range(&self) -> [f64; 2] {
        let ends = [self.form_roll_length(), self.tip_roll_length()];
        let all = (0..self.data.tooth_count as usize)
            .flat_map(|tooth| ends.map(|s| self.deviation(tooth, s)));
        all.fold([0.0, 0.0], |[high, low], each| {
            [high.max(each), low.min(each)]
        })
    }

    /// The flank from the form circle to the tip circle, by arc length from the base circle.
    pub fn flank_arcs(&self) -> (f64, f64) {
        (
            self.flank.arc_length(self.form_roll_length()),
            self.flank.arc_length(self.tip_roll_length()),
        )
    }

    /// The angle 2π/Z between teeth.
    pub fn pitch_angle(&self) -> f64 {
        2.0 * PI / f64::from(self.data.tooth_count)
    }

    /// The reference radius r = m Z/2.
    pub fn reference_radius(&self) -> f64 {
        self.data.rack.module * f64::from(self.data.tooth_count) / 2.0
    }

    /// The base radius r_b = r cos α (R_b in the paper).
    pub fn base_radius(&self) -> f64 {
        self.flank.base_radius()
    }

    /// The tip radius r_a = r + h_a + x m; tips are not shortened.
    pub fn tip_radius(&self) -> f64 {
        self.reference_radius() + self.data.rack.addendum + self.profile_shift_length()
    }

    /// The root radius r_f = r − h_f + x m.
    pub fn root_radius(&self) -> f64 {
        self.reference_radius() - self.data.rack.dedendum + self.profile_shift_length()
    }

    /// The base pitch p_b = π m cos α.
    pub fn base_pitch(&self) -> f64 {
        PI * self.data.rack.module * self.data.rack.pressure_angle.cos()
    }

    /// The roll length at which the generated flank ends and the fillet begins.
    pub fn form_roll_length(&self) -> f64 {
        self.form_roll_length_signed().max(0.0)
    }

    /// The form radius: where the flank ends and the fillet begins.
    pub fn form_radius(&self) -> f64 {
        self.flank.radius(self.form_roll_length())
    }

    /// The roll length at the tip circle.
    pub fn tip_roll_length(&self) -> f64 {
        self.flank.roll_length(self.tip_radius())
    }

    /// The roll length s_Fa at which the involute ends: at the tip circle, or at a broken edge.
    pub fn tip_form_roll_length(&self) -> f64 {
        self.broken_edge
            .map_or_else(|| self.tip_roll_length(), |edge| edge.from)
    }

    /// Half the angle of the tip land between both edges.
    pub fn tip_half_angle(&self) -> f64 {
        self.broken_edge.map_or_else(
            || self.flank.half_angle(self.tip_radius()),
            |edge| edge.half_angle(),
        )
    }

    /// The edge between flank and tip circle, if it is broken.
    pub(super) fn broken_edge(&self) -> Option<&BrokenEdge> {
        self.broken_edge.as_ref()
    }

    /// The thickness of the tooth along its tip circle, were its edges sharp.
    pub fn tip_thickness(&self) -> f64 {
        let r_a = self.tip_radius();
        2.0 * r_a * self.flank.half_angle(r_a)
    }

    /// The thinnest material around the holes: between them, above them and below them. `None` without holes.
    pub fn least_ligament(&self) -> Option<f64> {
        let blank = &self.data.blank;
        let least = blank.least_ligament(self.root_radius());
        least.map(|(_, ligament)| ligament)
    }

    /// The share of the blank that the holes remove; the blank is the ring between the bore and the mean of tip and root
    /// circle.
    pub fn removed_fraction(&self) -> f64 {
        self.data.blank.hole_area() / self.nominal_blank_area()
    }

    /// The area π (((r_a + r_f)/2)² − r_bore²) to which removed mass is referred.
    pub fn nominal_blank_area(&self) -> f64 {
        let mean = f64::midpoint(self.tip_radius(), self.root_radius());
        PI * (mean.powi(2) - self.bore_radius().powi(2))
    }

    fn profile_shift_length(&self) -> f64 {
        self.data.profile_shift * self.data.rack.module
    }

    fn form_roll_length_signed(&self) -> f64 {
        let sin = self.data.rack.pressure_angle.sin();
        self.reference_radius() * sin
            - (self.data.rack.straight_depth() - self.profile_shift_length()) / sin
    }

    fn largest_addendum(&self) -> f64 {
        let r_0 = self.reference_radius() + self.profile_shift_length();
        let least = LEAST_TIP_THICKNESS * self.data.rack.module;
        let thick_enough = |addendum: f64| {
            let r_a = r_0 + addendum;
            2.0 * r_a * self.flank.half_angle(r_a) >= least
        };
        bisect(
            self.form_radius() - r_0,
            self.data.rack.addendum,
            thick_enough,
        )
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::gear::{Rack, ReliefData, ReliefShape, ReliefStart};

    /// The paper's gears (Table 1): module 2 mm, 20 degrees, addendum 2 mm, dedendum 2.5 mm, width 20 mm, steel.
    pub(crate) fn paper_gear(tooth_count: u32) -> GearData {
        GearData {
            tooth_count,
            rack: Rack {
                module: 2e-3,
                pressure_angle: 20_f64.to_radians(),
                addendum: 2e-3,
                dedendum: 2.5e-3,
                tip_radius: 0.76e-3,
            },
            profile_shift: 0.0,
            thickness_deviation: 0.0,
            tip_edge: TipEdge::Sharp,
            face_width: 20e-3,
            modifications: Vec::new(),
            deviations: ToothDeviations::default(),
            material: Material {
                youngs_modulus: 210e9,
                poisson_ratio: 0.3,
                density: 7850.0,
            },
            blank: BlankRegion::solid(15e-3),
        }
    }

    fn with_holes(count: u32, circle_radius: f64, radius: f64) -> Result<SpurGear, GearError> {
        let mut data = paper_gear(50);
        data.blank.holes = HolePattern {
            count,
            circle_radius,
            radius,
            phase: 0.0,
        }
        .holes();
        SpurGear::new(data)
    }

    #[test]
    fn the_form_radius_is_the_one_of_the_independent_solver() {
        // calculix-s1.json: r_form = 48.31354660697083 mm.
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        assert!((gear.form_radius() - 48.313_546_606_970_83e-3).abs() < 1e-12);
    }

    #[test]
    fn undercut_begins_below_the_textbook_tooth_count_and_the_named_shift_cures_it() {
        // z_min = 2 h_Ff/(m sin² α) = 17.1 for the ISO rack with rounding 0.38 m, whose straight depth is one module.
        assert!(
            SpurGear::new(paper_gear(18)).is_err(),
            "a bore of 15 mm leaves no rim"
        );
        let small = |z, x| {
            let mut data = paper_gear(z);
            data.blank.bore_radius = 5e-3;
            data.profile_shift = x;
            SpurGear::new(data)
        };
        assert!(small(18, 0.0).is_ok());
        let Err(GearError::Undercut { smallest, .. }) = small(12, 0.0) else {
            panic!("12 teeth are undercut")
        };
        assert!(small(12, smallest + 1e-9).is_ok());
        assert!(matches!(
            small(12, smallest - 1e-6),
            Err(GearError::Undercut { .. })
        ));
    }

    #[test]
    fn a_pointed_tooth_is_refused_and_the_named_addendum_cures_it() {
        let mut data = paper_gear(30);
        data.rack.addendum = 4e-3;
        let Err(GearError::PointedTip {
            largest_addendum, ..
        }) = SpurGear::new(data.clone())
        else {
            panic!("pointed")
        };
        data.rack.addendum = largest_addendum;
        assert!(SpurGear::new(data).is_ok());
    }

    #[test]
    fn holes_are_refused_where_they_touch_and_the_named_radius_cures_each() {
        // Touching limits R sin(π/N) , less half the least ligament.
        let Err(GearError::HolesOverlap { largest_radius, .. }) = with_holes(8, 27e-3, 10.5e-3)
        else {
            panic!("overlap")
        };
        assert!((largest_radius - (10.332e-3 - 0.25e-3)).abs() < 1e-6);
        assert!(with_holes(8, 27e-3, largest_radius - 1e-12).is_ok());
        let Err(GearError::HolesBreachRim { largest_radius, .. }) = with_holes(6, 38e-3, 9.5e-3)
        else {
            panic!("rim")
        };
        assert!((largest_radius - 9e-3).abs() < 1e-12);
        let Err(GearError::HolesBreachBore { largest_radius, .. }) = with_holes(3, 25e-3, 10e-3)
        else {
            panic!("bore")
        };
        assert!((largest_radius - 9.5e-3).abs() < 1e-12);
    }

    #[test]
    fn a_relief_must_start_on_the_flank() {
        let mut data = paper_gear(50);
        let relief = |length| {
            ModificationData::TipRelief(ReliefData {
                amount: 5e-6,
                shape: ReliefShape::Linear,
                start: ReliefStart::RadialLength(length),
            })
        };
        data.modifications = vec![relief(3.7e-3)];
        assert!(matches!(
            SpurGear::new(data.clone()),
            Err(GearError::ReliefTooLong { .. })
        ));
        data.modifications = vec![relief(1.75e-3)];
        let gear = SpurGear::new(data).expect("fits");
        assert!((gear.removed(gear.tip_roll_length()) - 5e-6).abs() < 1e-18);
    }

    #[test]
    fn a_quarter_of_the_blank_goes_with_the_papers_hole_radii() {
        // Bore 15 mm and 25 % give r = 7.500 (10 holes), 8.385 (8), 9.683 (6) mm.
        for (count, circle_radius, radius) in [
            (10, 34e-3, 7.5e-3),
            (8, 34e-3, 8.385e-3),
            (6, 30e-3, 9.683e-3),
        ] {
            let gear = with_holes(count, circle_radius, radius).expect("a design of the study");
            assert!((gear.removed_fraction() - 0.25).abs() < 5e-5);
        }
    }
}
