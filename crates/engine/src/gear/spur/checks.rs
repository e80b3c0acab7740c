//! Checks of a gear's drawing: refusals, and values that would do.

use super::SpurGear;
use crate::gear::blank::Ligament;
use crate::gear::data::{
    DeviationList, LEAST_LIGAMENT, LEAST_RIM, LEAST_TIP_THICKNESS, LEAST_WEB_RIM,
};
use crate::gear::modification::{Modification, Relief, TablePlaces};
use crate::gear::tip::BrokenEdge;
use crate::gear::{
    GearError, ModificationData, ReliefData, TipEdge, ToothDeviations, ToothLeads, ToothProfiles,
};
use crate::root_finding::bisect;

impl SpurGear {
    pub(super) fn check_rack(&self) -> Result<(), GearError> {
        let rack = &self.normal_rack;
        let largest = rack.largest_tip_radius();
        if rack.tip_radius > largest {
            return Err(GearError::RackTipRadius {
                tip_radius: rack.tip_radius,
                largest,
            });
        }
        self.check_protuberance()?;
        let stretch = self.data.rack.module / rack.module;
        let largest = 2.0 * (stretch * rack.half_tip_land());
        // Rounding of a full tip radius leaves a land of nothing, or a little less.
        let (deviation, of_flanks) = (
            self.data.thickness_deviation,
            self.data.thickness_of_flanks(),
        );
        if of_flanks > largest.max(0.0) {
            return Err(GearError::TeethTooThick {
                deviation,
                largest: largest.max(0.0) + (deviation - of_flanks),
            });
        }
        Ok(())
    }

    fn check_protuberance(&self) -> Result<(), GearError> {
        let rack = &self.normal_rack;
        let Some(hob) = rack.protuberance else {
            return Ok(());
        };
        let (amount, stock) = (hob.amount, hob.grinding_stock);
        if amount < stock {
            return Err(GearError::ProtuberanceBelowStock { amount, stock });
        }
        let fits = |amount: f64| rack.least_protuberance_height(amount) <= rack.dedendum;
        if !fits(amount) {
            return Err(GearError::ProtuberanceTooLarge {
                amount,
                largest: bisect(0.0, amount, fits),
            });
        }
        let (least, largest) = (rack.least_protuberance_height(amount), rack.dedendum);
        if amount > 0.0 && !(least..=largest).contains(&hob.height) {
            return Err(GearError::ProtuberanceHeight {
                height: hob.height,
                least,
                largest,
            });
        }
        Ok(())
    }

    pub(super) fn check_tooth(&self) -> Result<(), GearError> {
        let rack = &self.data.rack;
        if self.is_undercut && self.neck() < LEAST_TIP_THICKNESS * rack.module {
            if let Some(hob) = rack.protuberance.filter(|_| self.end_of_rack >= 0.0) {
                return Err(GearError::ProtuberanceTooLarge {
                    amount: hob.amount,
                    largest: hob.grinding_stock,
                });
            }
            let (r, sin) = (self.reference_radius(), rack.pressure_angle.sin());
            let smallest = (self.normal_rack.straight_depth() - r * sin * sin) / rack.module;
            return Err(GearError::Undercut {
                generating_profile_shift: self.generating_profile_shift(),
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

    /// The thickness of the tooth where its fillets come nearest to each other.
    fn neck(&self) -> f64 {
        const PLACES: u32 = 64;
        let (from, to) = self.fillet.ends();
        let at = |i: u32| {
            self.fillet
                .point(from + (to - from) * f64::from(i) / f64::from(PLACES))
        };
        2.0 * (0..=PLACES).map(|i| at(i).y).fold(f64::INFINITY, f64::min)
    }

    pub(super) fn check_blank(&self) -> Result<(), GearError> {
        let bore_radius = self.data.blank.bore_radius;
        let largest = self.root_radius() - LEAST_RIM * self.data.rack.module;
        if bore_radius > largest {
            return Err(GearError::BoreTooLarge {
                bore_radius,
                largest,
            });
        }
        let blank = &self.data.blank;
        let least = LEAST_LIGAMENT * self.normal_rack.module;
        for (place, ligament) in blank.ligaments(self.root_radius()) {
            // Written so that a ligament that is not a number is refused as well.
            if ligament >= least {
                continue;
            }
            let with = |hole: usize, gained: f64| {
                blank.holes[hole].half_width() + gained * (ligament - least)
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

    pub(super) fn checked_edge(&self) -> Result<Option<BrokenEdge>, GearError> {
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

    pub(super) fn checked_modifications(&self) -> Result<Vec<Modification>, GearError> {
        let (s_f, s_a) = (self.form_roll_length(), self.tip_roll_length());
        let mut checked = Vec::new();
        for (index, data) in self.data.modifications.iter().enumerate() {
            checked.push(match data {
                ModificationData::TipRelief(relief) | ModificationData::RootRelief(relief)
                    if relief.amount == 0.0 =>
                {
                    continue;
                }
                ModificationData::TipRelief(relief) => {
                    let start = relief.start.below_tip(&self.flank, self.tip_radius());
                    let ends = [start, self.tip_radius()];
                    Modification::Tip(self.checked_relief(index, relief, ends)?)
                }
                ModificationData::RootRelief(relief) => {
                    let start = relief.start.above_form(&self.flank, self.form_radius());
                    let ends = [start, self.form_radius()];
                    Modification::Root(self.checked_relief(index, relief, ends)?)
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

    /// The relief between the radii at which it starts and ends, if it starts on the flank and not at its end.
    fn checked_relief(
        &self,
        modification: usize,
        data: &ReliefData,
        [start_radius, end_radius]: [f64; 2],
    ) -> Result<Relief, GearError> {
        let (form_radius, tip_radius) = (self.form_radius(), self.tip_radius());
        if (form_radius..=tip_radius).contains(&start_radius) && start_radius != end_radius {
            let ReliefData { amount, shape, .. } = *data;
            return Ok(Relief::new(amount, shape, start_radius, end_radius));
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
        // Diameters below the base circle are no places of their own.
        let rising = places.roll_lengths(&self.flank);
        let fault = |entry| {
            Err(GearError::TableDoesNotRise {
                modification,
                entry,
            })
        };
        if rising.len() < 2 || rising.len() != removed.len() {
            return fault(rising.len().min(removed.len()));
        }
        match rising.windows(2).position(|pair| pair[0] >= pair[1]) {
            Some(before) => fault(before + 1),
            None => Ok(Modification::Table {
                places: places.clone(),
                removed: removed.to_vec(),
            }),
        }
    }

    /// Checks that `deviations` have this number of teeth.
    pub(in crate::gear) fn fits(&self, deviations: &ToothDeviations) -> Result<(), GearError> {
        let needed = self.data.tooth_count as usize;
        for (list, values) in [
            (DeviationList::Pitch, &deviations.cumulative_pitch),
            (
                DeviationList::OtherFlankPitch,
                &deviations.other_cumulative_pitch,
            ),
            (DeviationList::ProfileSlope, &deviations.profile_slope),
            (DeviationList::LeadSlope, &deviations.lead_slope),
        ] {
            if !values.is_empty() && values.len() != needed {
                return Err(GearError::DeviationCount {
                    list,
                    given: values.len(),
                    needed,
                });
            }
        }
        if let Some(ToothProfiles { places, removed }) = &deviations.profiles {
            let rising = places.roll_lengths(&self.flank);
            traces_fit(DeviationList::Profiles, &rising, removed, needed)?;
        }
        if let Some(ToothLeads { heights, removed }) = &deviations.leads {
            traces_fit(DeviationList::Leads, heights, removed, needed)?;
        }
        Ok(())
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

/// Checks that traces with entries at the rising `places` have this number of teeth.
fn traces_fit(
    list: DeviationList,
    places: &[f64],
    removed: &[Vec<f64>],
    needed: usize,
) -> Result<(), GearError> {
    if removed.len() != needed {
        return Err(GearError::DeviationCount {
            list,
            given: removed.len(),
            needed,
        });
    }
    let falls = places.windows(2).position(|pair| pair[0] >= pair[1]);
    let short = (places.len() < 2).then_some(places.len());
    let rows = removed.iter().map(Vec::len);
    let other = rows.filter(|len| *len != places.len()).min();
    let other = other.map(|len| len.min(places.len()));
    match falls.map(|before| before + 1).or(short).or(other) {
        Some(entry) => Err(GearError::TraceDoesNotFit { list, entry }),
        None => Ok(()),
    }
}
