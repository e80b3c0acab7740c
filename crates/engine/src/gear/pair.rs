//! Two spur gears in engagement.

use super::involute::involute_function;
use super::{
    FlankGrowth, GearError, Member, PairDeviations, SpurGear, ToothDeviations, Vector, gcd, radial,
    teeth_on,
};
use crate::root_finding::bisect;

/// Why two gears cannot mesh. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GearPairError {
    /// The modules differ.
    #[error("the modules differ: {driving} m and {driven} m")]
    ModuleMismatch {
        /// Of the driving gear.
        driving: f64,
        /// Of the driven gear.
        driven: f64,
    },
    /// The pressure angles differ.
    #[error("the pressure angles differ: {driving} rad and {driven} rad")]
    PressureAngleMismatch {
        /// Of the driving gear.
        driving: f64,
        /// Of the driven gear.
        driven: f64,
    },
    /// The tip circles do not overlap.
    #[error(
        "center distance {center_distance} m is more than the tip radii together ({tip_radii} m); at most {largest} m"
    )]
    TeethDoNotReach {
        /// The center distance asked for.
        center_distance: f64,
        /// The sum of the tip radii.
        tip_radii: f64,
        /// The largest center distance at which the contact ratio is one.
        largest: f64,
    },
    /// Between one pair of teeth and the next nothing carries the load.
    #[error(
        "the total contact ratio {contact_ratio} is below one; a center distance of at most {largest} m"
    )]
    ContactRatioBelowOne {
        /// The contact ratio at the distance asked for, with the overlap along the faces.
        contact_ratio: f64,
        /// The largest center distance at which it is one.
        largest: f64,
    },
    /// The teeth are thicker than the spaces that they enter.
    #[error(
        "the normal backlash {backlash} m is negative; a center distance of at least {smallest} m"
    )]
    NegativeBacklash {
        /// The normal backlash.
        backlash: f64,
        /// The smallest center distance without negative backlash.
        smallest: f64,
    },
    /// A tip enters the fillet or the root of the other gear.
    #[error(
        "the tips of the other gear reach below the flanks of the {member} gear; a center distance of at least {smallest} m"
    )]
    Interference {
        /// The gear whose fillet is hit.
        member: Member,
        /// The smallest center distance that avoids it.
        smallest: f64,
    },
}

/// Why two gears cannot deviate so.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DeviationsError {
    /// A list is not as long as there are teeth.
    #[error("the deviations of the {member} gear do not fit it")]
    Gear {
        /// The gear.
        member: Member,
        /// Why.
        #[source]
        error: GearError,
    },
    /// The flanks that stand out take all of the backlash.
    #[error(transparent)]
    Pair(GearPairError),
}

/// Two spur gears at a center distance, the first driving the second.
///
/// A value of this type can mesh: the contact ratio, with the overlap along the faces, is at least one, the backlash is not negative and no tip enters a
/// fillet. Where the last printed digits ([`super::printed`]) leave too little room for the other flanks, they are moved back. Lengths are in meters,
/// angles in radians.
#[derive(Debug, Clone, PartialEq)]
pub struct GearPair {
    driving: SpurGear,
    driven: SpurGear,
    center_distance: f64,
    working_pressure_angle: f64,
    line_of_action: f64,
    pitch_roll_length: f64,
    /// By how much the other flanks are moved back, where the last printed digits leave them too little room.
    moved_back: f64,
}

impl GearPair {
    /// Sets `driving` and `driven` at the operating `center_distance`.
    ///
    /// # Errors
    ///
    /// [`GearPairError`] says why they cannot mesh there, and the nearest distance at which they can.
    pub fn new(
        driving: SpurGear,
        driven: SpurGear,
        center_distance: f64,
    ) -> Result<Self, GearPairError> {
        Self::overlapping(driving, driven, center_distance, 0.0)
    }

    /// As [`GearPair::new`], of the transverse sections of gears whose teeth overlap along their faces by `overlap_ratio`: both contact ratios together
    /// have to be at least one.
    ///
    /// # Errors
    ///
    /// As [`GearPair::new`].
    pub fn overlapping(
        driving: SpurGear,
        driven: SpurGear,
        center_distance: f64,
        overlap_ratio: f64,
    ) -> Result<Self, GearPairError> {
        let (rack_1, rack_2) = (&driving.data().rack, &driven.data().rack);
        if rack_1.module != rack_2.module {
            return Err(GearPairError::ModuleMismatch {
                driving: rack_1.module,
                driven: rack_2.module,
            });
        }
        if rack_1.pressure_angle != rack_2.pressure_angle {
            return Err(GearPairError::PressureAngleMismatch {
                driving: rack_1.pressure_angle,
                driven: rack_2.pressure_angle,
            });
        }
        let mut pair = Self::placed(driving, driven, center_distance);
        pair.moved_back = pair.check(overlap_ratio)?;
        Ok(pair)
    }

    fn placed(driving: SpurGear, driven: SpurGear, center_distance: f64) -> Self {
        let base_radii = driving.base_radius() + driven.base_radius();
        let working_pressure_angle = (base_radii / center_distance).acos();
        Self {
            line_of_action: center_distance * working_pressure_angle.sin(),
            pitch_roll_length: driving.base_radius() * working_pressure_angle.tan(),
            working_pressure_angle,
            driving,
            driven,
            center_distance,
            moved_back: 0.0,
        }
    }

    /// The same pair on blanks without bores and holes, for questions about flanks only.
    pub fn without_blanks(&self) -> Self {
        Self {
            driving: self.driving.without_blank(),
            driven: self.driven.without_blank(),
            ..*self
        }
    }

    /// The same pair of gears whose teeth do not deviate.
    pub fn as_drawn(&self) -> Self {
        Self {
            driving: self.driving.as_drawn(),
            driven: self.driven.as_drawn(),
            moved_back: (-self.drawn_backlash()).max(0.0),
            ..*self
        }
    }

    /// The pair whose loaded flanks touch as the other flanks of this one do: its mirror image about the line of centers, whose mesh position 0 is
    /// [`GearPair::other_flanks_later`] and which passes the others the other way round. Blanks stay as they are under the flanks.
    pub fn mirror_image(&self) -> Self {
        // The other flank of a driving tooth faces the driven tooth of the pair after its own.
        let first = [0, 1].map(|n| self.teeth(n));
        Self {
            driving: self.driving.mirror_image(first[0][0]),
            driven: self.driven.mirror_image(first[1][1]),
            ..*self
        }
    }

    /// The [mirror image](Self::mirror_image) with the blanks that the mirror shows: it rolls on its loaded flanks as this pair does on the others.
    pub fn mirror_image_of_gears(&self) -> Self {
        let mirrored = self.mirror_image();
        Self {
            driving: mirrored.driving.with_blank_mirrored(self.teeth(0)[0]),
            driven: mirrored.driven.with_blank_mirrored(self.teeth(1)[1]),
            ..mirrored
        }
    }

    /// The same pair with the driving blank turned by `angle` under its teeth, counter-clockwise.
    pub fn with_driving_blank_turned(&self, angle: f64) -> Self {
        Self {
            driving: self.driving.with_blank_turned(angle),
            ..self.clone()
        }
    }

    /// How many mesh periods after the loaded flank of a driving tooth its other flank passes the pitch point: the thickness of the tooth.
    pub fn other_flanks_later(&self) -> f64 {
        let alpha_w = self.working_pressure_angle();
        let half_angle = self.driving.flank().base_half_angle() - involute_function(alpha_w);
        2.0 * half_angle / self.driving.pitch_angle()
    }

    /// Slices of the flanks of both gears, one meter long, in plane strain: the state of a contact near a line of it.
    pub(crate) fn plane_strain(&self) -> Self {
        Self {
            driving: self.driving.plane_strain(),
            driven: self.driven.plane_strain(),
            ..*self
        }
    }

    /// By how much the other flanks have to be moved back, of gears that can mesh.
    fn check(&self, overlap_ratio: f64) -> Result<f64, GearPairError> {
        let tip_radii = self.driving.tip_radius() + self.driven.tip_radius();
        let center_distance = self.center_distance;
        if center_distance >= tip_radii {
            let largest = self.largest_center_distance(overlap_ratio);
            return Err(GearPairError::TeethDoNotReach {
                center_distance,
                tip_radii,
                largest,
            });
        }
        let moved_back = self.shortfall(&self.deviations())?;
        for member in Member::BOTH {
            if !self.clears(member) {
                let smallest = self
                    .least_center_distance(center_distance, tip_radii, |pair| pair.clears(member));
                return Err(GearPairError::Interference { member, smallest });
            }
        }
        let contact_ratio = self.contact_ratio() + overlap_ratio;
        if contact_ratio < 1.0 {
            return Err(GearPairError::ContactRatioBelowOne {
                contact_ratio,
                largest: self.largest_center_distance(overlap_ratio),
            });
        }
        Ok(moved_back)
    }

    /// True if the other gear's tips stay on the flank of `member`, or in the room of its undercut, and clear of its root.
    fn clears(&self, member: Member) -> bool {
        let (gear, other) = (self.gear(member), self.gear(member.other()));
        let on_flank = self.lowest_roll_length(member) >= gear.form_roll_length();
        (on_flank || gear.is_undercut() && self.passes_fillet(member))
            && self.center_distance - other.tip_radius() > gear.root_radius()
    }

    /// True if the edges of the other gear's tips pass the undercut fillet of `member` without touching it.
    fn passes_fillet(&self, member: Member) -> bool {
        /// Places of the tip on its way through the space.
        const PLACES: u32 = 200;
        /// Loss of the distance by rounding, in modules.
        const ROUNDING: f64 = 1e-6;
        let (gear, other) = (self.gear(member), self.gear(member.other()));
        let (fillet, a) = (gear.fillet(), self.center_distance);
        let (r_root, r_form) = (gear.root_radius(), gear.form_radius());
        let s_tip = other.tip_form_roll_length();
        let edge = other.flank().radius(s_tip);
        // The tip stands at r_a e(θ) of its center; below the form circle of this gear while cos θ is more than this.
        let cosine = (a * a + edge * edge - r_form * r_form) / (2.0 * a * edge);
        let widest = cosine.clamp(-1.0, 1.0).acos();
        // Seen along the line of centers both gears turn against each other, and flanks touch at s_1 + s_2 = a sin α_w.
        let own = other.flank().half_angle(edge);
        let alpha = self.working_pressure_angle;
        (0..=PLACES).all(|i| {
            let theta = widest * (2.0 * f64::from(i) / f64::from(PLACES) - 1.0);
            // The centerline of the other tooth, and by it where its flank touches, and the centerline of the tooth here.
            let centerline = theta - own;
            let s_2 = (centerline + alpha + other.flank().base_half_angle()) * other.base_radius();
            let s_1 = self.line_of_action - s_2;
            let tooth = s_1 / gear.base_radius() - alpha - gear.flank().base_half_angle();
            let point = Vector::new(a, 0.0) - edge * radial(theta);
            let (r, angle) = (point.norm(), point.y.atan2(point.x) - tooth);
            if r <= r_root || r >= r_form {
                return true;
            }
            let wall = fillet.point(fillet.gamma_at(r));
            r * (angle - wall.y.atan2(wall.x)) >= -ROUNDING * gear.data().rack.module
        })
    }

    /// The roll length of `member` at which the tip of the other gear meets the line of action: negative beyond the base circle.
    fn lowest_roll_length(&self, member: Member) -> f64 {
        self.line_of_action() - self.gear(member.other()).tip_form_roll_length()
    }

    /// How much shorter the undercut of `member` makes the path of contact, a roll length.
    pub fn lost_to_undercut(&self, member: Member) -> f64 {
        let lost = self.gear(member).form_roll_length() - self.lowest_roll_length(member);
        lost.max(0.0)
    }

    /// The same gears at another distance, whether they can mesh there or not.
    pub(super) fn at(&self, center_distance: f64) -> Self {
        Self::placed(self.driving.clone(), self.driven.clone(), center_distance)
    }

    /// The center distance at which the contact ratio, with the overlap, falls to one; it falls as the distance grows.
    fn largest_center_distance(&self, overlap_ratio: f64) -> f64 {
        let low = self.driving.base_radius() + self.driven.base_radius();
        let high = self.driving.tip_radius() + self.driven.tip_radius();
        bisect(low, high, |a| {
            self.at(a).contact_ratio() + overlap_ratio >= 1.0
        })
    }

    /// The smallest center distance in (`low`, `high`) from which `holds` holds.
    fn least_center_distance(&self, low: f64, high: f64, holds: impl Fn(&Self) -> bool) -> f64 {
        bisect(high, low, |a| holds(&self.at(a)))
    }

    /// The driving gear, gear 1.
    pub fn driving(&self) -> &SpurGear {
        &self.driving
    }

    /// The driven gear, gear 2.
    pub fn driven(&self) -> &SpurGear {
        &self.driven
    }

    /// The gear that is `member` of the pair.
    pub fn gear(&self, member: Member) -> &SpurGear {
        match member {
            Member::Driving => &self.driving,
            Member::Driven => &self.driven,
        }
    }

    /// The operating center distance a.
    pub fn center_distance(&self) -> f64 {
        self.center_distance
    }

    /// The working pressure angle α_w: cos α_w = (r_b1 + r_b2)/a.
    pub fn working_pressure_angle(&self) -> f64 {
        self.working_pressure_angle
    }

    /// The length a sin α_w of the line of action between the base circles, on which s_1 + s_2 is constant.
    pub fn line_of_action(&self) -> f64 {
        self.line_of_action
    }

    /// The base pitch p_b.
    pub fn base_pitch(&self) -> f64 {
        self.driving.base_pitch()
    }

    /// The working pitch radius r_w of `member`: r_b/cos α_w.
    pub fn working_radius(&self, member: Member) -> f64 {
        self.gear(member).base_radius() / self.working_pressure_angle().cos()
    }

    /// The roll length on the driving gear at the pitch point C, where the reference pair touches at mesh position 0.
    pub fn pitch_roll_length(&self) -> f64 {
        self.pitch_roll_length
    }

    /// The roll length on the driving gear at which a pair nominally touches `periods` mesh periods after it passed the pitch
    /// point.
    pub fn roll_length_of(&self, periods: f64) -> f64 {
        self.pitch_roll_length() + periods * self.base_pitch()
    }

    /// The roll lengths on the driving gear at the ends A and E of the path of contact: where the tips meet the line of action, or where undercut ends a
    /// flank before that.
    pub fn path_of_contact(&self) -> (f64, f64) {
        let forms = Member::BOTH.map(|member| self.gear(member).form_roll_length());
        (
            self.lowest_roll_length(Member::Driving).max(forms[0]),
            self.driving
                .tip_form_roll_length()
                .min(self.line_of_action() - forms[1]),
        )
    }

    /// The contact ratio ε_α: the length g_α of the path of contact over the base pitch p_b.
    pub fn contact_ratio(&self) -> f64 {
        let (s_a, s_e) = self.path_of_contact();
        (s_e - s_a) / self.base_pitch()
    }

    /// The specific sliding ζ of the flank of `member` at the ends A and E of the path of contact: the sliding velocity over the velocity at
    /// which the contact runs along this flank, ζ = 1 − (z ρ')/(z' ρ), where ρ is the roll length here and ρ' that of the other gear. It
    /// has no bound where a flank touches on its base circle: `None` there.
    pub fn specific_sliding(&self, member: Member) -> [Option<f64>; 2] {
        let (gear, other) = (self.gear(member), self.gear(member.other()));
        let ratio = f64::from(gear.tooth_count()) / f64::from(other.tooth_count());
        let (s_a, s_e) = self.path_of_contact();
        [s_a, s_e].map(|s_1| {
            let s = [s_1, self.line_of_action() - s_1];
            let (rho, other_rho) = (s[member.index()], s[member.other().index()]);
            let zeta = 1.0 - ratio * other_rho / rho;
            zeta.is_finite().then_some(zeta)
        })
    }

    /// The lowest radius of `member` that the mate's tip reaches on its flank: where its active profile begins.
    pub fn active_root_radius(&self, member: Member) -> f64 {
        let gear = self.gear(member);
        let lowest = self.lowest_roll_length(member).max(gear.form_roll_length());
        gear.flank().radius(lowest)
    }

    /// The tip clearance of `member`: from its tip to the root circle of the other gear, negative where it would cut into it.
    pub fn tip_clearance(&self, member: Member) -> f64 {
        let (gear, other) = (self.gear(member), self.gear(member.other()));
        self.center_distance - gear.tip_radius() - other.root_radius()
    }

    /// Amount by which gear programs shorten tips so that the clearance stays that of the racks, dedendum less addendum: the excess of both shifts over that of
    /// the center distance over that of unshifted gears. Not positive where no clearance is lost.
    pub fn usual_tip_shortening(&self) -> f64 {
        let shifted = Member::BOTH.map(|member| {
            let gear = self.gear(member);
            gear.reference_radius() + gear.profile_shift_length()
        });
        shifted[0] + shifted[1] - self.center_distance
    }

    /// The backlash along the line of action (of a helical gear its transverse one), not negative.
    pub fn backlash(&self) -> f64 {
        self.drawn_backlash() + self.moved_back
    }

    /// Distance by which the other flanks are moved back from where they are drawn, along the line of action: the negative backlash that the last printed
    /// digits explain.
    pub fn moved_back(&self) -> f64 {
        self.moved_back
    }

    /// The backlash along the line of action of flanks where they are drawn, negative where they have no room.
    pub(super) fn drawn_backlash(&self) -> f64 {
        let alpha_w = self.working_pressure_angle();
        let thickness = |member| {
            let half_angle =
                self.gear(member).flank().base_half_angle() - involute_function(alpha_w);
            2.0 * self.working_radius(member) * half_angle
        };
        let pitch = self.working_radius(Member::Driving) * self.driving.pitch_angle();
        (pitch - thickness(Member::Driving) - thickness(Member::Driven)) * alpha_w.cos()
    }

    /// Deviations of the teeth of both gears.
    pub fn deviations(&self) -> PairDeviations {
        let teeth = Member::BOTH.map(|member| self.gear(member).deviations());
        PairDeviations::of([&self.driving, &self.driven], teeth)
    }

    /// The number of mesh periods after which `member` stands in an equal position again: Z/gcd(Z, N) with holes that repeat N times, 1 without, Z where its teeth
    /// deviate.
    pub fn period_of(&self, member: Member) -> u32 {
        let gear = self.gear(member);
        self.period_of_gear(member, gear.deviations().is_none())
    }

    fn period_of_gear(&self, member: Member, teeth_as_drawn: bool) -> u32 {
        let gear = self.gear(member);
        let z = gear.tooth_count();
        if teeth_as_drawn {
            match gear.hole_repeats() {
                0 => 1,
                repeats => z / gcd(z, repeats),
            }
        } else {
            z
        }
    }

    /// The number of mesh periods after which the contact repeats: the least common multiple of both gears'.
    pub fn period(&self) -> u32 {
        least_common_multiple(Member::BOTH.map(|member| self.period_of(member)))
    }

    /// As [`GearPair::period_with`], of gears without holes.
    pub(super) fn period_of_teeth(&self, deviations: &PairDeviations) -> u32 {
        least_common_multiple(Member::BOTH.map(|member| {
            let alike = deviations.of_gear(member).is_none();
            if alike {
                1
            } else {
                self.gear(member).tooth_count()
            }
        }))
    }

    /// As [`GearPair::period`], of gears that have these `deviations` instead of their own.
    pub fn period_with(&self, deviations: &PairDeviations) -> u32 {
        least_common_multiple(
            Member::BOTH
                .map(|member| self.period_of_gear(member, deviations.of_gear(member).is_none())),
        )
    }

    /// The tooth of `member` in pair n.
    pub fn tooth(&self, member: Member, n: i64) -> usize {
        let z = i64::from(self.gear(member).tooth_count());
        teeth_on(member, n).rem_euclid(z) as usize
    }

    /// The teeth of pair n, driving and driven.
    pub fn teeth(&self, n: i64) -> [usize; 2] {
        Member::BOTH.map(|member| self.tooth(member, n))
    }

    /// True if nothing of either gear deviates from its drawing: the contact on rigid blanks repeats with every mesh period.
    pub fn is_as_drawn(&self) -> bool {
        Member::BOTH
            .into_iter()
            .all(|member| self.gear(member).deviations().is_none())
    }

    /// The face width on which the gears touch: the smaller of the two.
    pub fn common_face_width(&self) -> f64 {
        self.driving.face_width().min(self.driven.face_width())
    }

    /// The transmitted load F = T/r_b2 of the output torque T (newton meters to newtons).
    pub fn load(&self, output_torque: f64) -> f64 {
        output_torque / self.driven.base_radius()
    }
}

impl PairDeviations {
    /// Effect of `teeth`, those of the driving and of the driven gear, on the flanks of `pair`, for any deviations of its own.
    ///
    /// # Errors
    ///
    /// [`DeviationsError`].
    pub fn new(pair: &GearPair, teeth: [&ToothDeviations; 2]) -> Result<Self, DeviationsError> {
        for member in Member::BOTH {
            let fits = pair.gear(member).fits(teeth[member.index()]);
            fits.map_err(|error| DeviationsError::Gear { member, error })?;
        }
        let deviations = Self::of([&pair.driving, &pair.driven], teeth);
        pair.shortfall(&deviations).map_err(DeviationsError::Pair)?;
        Ok(deviations)
    }

    /// These on the gears of `pair` whose flanks have grown, so turned that flanks on the pitch point stand in the mean where they did.
    pub fn growing(self, pair: &GearPair, growth: [&FlankGrowth; 2]) -> Self {
        let s_1 = pair.pitch_roll_length();
        let pitch = [s_1, pair.line_of_action() - s_1];
        self.grown([&pair.driving, &pair.driven], pitch, growth)
    }
}

fn least_common_multiple([p_1, p_2]: [u32; 2]) -> u32 {
    p_1 / gcd(p_1, p_2) * p_2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::HolePattern;
    use crate::gear::spur::tests::paper_gear;

    fn gear(tooth_count: u32) -> SpurGear {
        let mut data = paper_gear(tooth_count);
        data.blank.bore_radius = 10e-3;
        SpurGear::new(data).expect("a gear of the paper")
    }

    #[test]
    fn contact_ratios_and_path_points_are_those_of_the_closed_form() {
        // By the closed forms of ISO 21771, with 30 digits: a in mm, α_w in degrees, g_α, ε_α, s_1 at A, C, E, j_bn in mm.
        let table = [
            (
                50, 50, 100.5, 20.76902, 8.92462, 1.51155, 13.3564, 17.8187, 22.2810, 0.34836,
            ),
            (
                29, 85, 114.0, 20.00000, 10.27160, 1.73969, 4.5060, 9.9186, 14.7776, 0.0,
            ),
            (
                29, 85, 114.5, 20.67646, 8.83303, 1.49604, 5.9446, 10.2845, 14.7776, 0.34760,
            ),
        ];
        for (z1, z2, a, alpha_w, g_alpha, ratio, s_a, s_c, s_e, backlash) in table {
            let pair = GearPair::new(gear(z1), gear(z2), a * 1e-3).expect("meshes");
            let near = |value: f64, printed: f64, half_digit: f64| {
                assert!((value - printed).abs() <= half_digit, "{value} {printed}")
            };
            near(pair.working_pressure_angle().to_degrees(), alpha_w, 6e-6);
            near(
                pair.contact_ratio() * pair.base_pitch() * 1e3,
                g_alpha,
                6e-6,
            );
            near(pair.contact_ratio(), ratio, 6e-6);
            near(pair.path_of_contact().0 * 1e3, s_a, 6e-5);
            near(pair.pitch_roll_length() * 1e3, s_c, 6e-5);
            near(pair.path_of_contact().1 * 1e3, s_e, 6e-5);
            near(pair.backlash() * 1e3, backlash, 6e-6);
        }
    }

    /// Two gears by the ISO 53 rack with this `tip_radius`, in modules.
    fn of_module(
        teeth: [u32; 2],
        module: f64,
        tip_radius: f64,
        a: f64,
    ) -> Result<GearPair, GearPairError> {
        let [one, other] = teeth.map(|tooth_count| {
            let mut data = paper_gear(tooth_count);
            data.rack = crate::gear::Rack {
                tip_radius: tip_radius * module,
                ..crate::gear::Rack::profile_a(module)
            };
            data.blank.bore_radius = module;
            SpurGear::new(data).expect("can be made")
        });
        GearPair::new(one, other, a)
    }

    #[test]
    fn undercut_shortens_the_path_of_contact_only_where_the_mates_tips_pass_below_the_flank() {
        // The contact ratio, and the roll length lost in mm: by the swept rounding of the rack, from public examples of gears.
        for (teeth, module, tip_radius, a, ratio, lost) in [
            ([17, 43], 1.0, 0.38, 30.0, 1.6211, 0.0),
            ([16, 64], 0.396_875, 0.38, 15.875, 1.6452, 0.0017),
            (
                [10, 80],
                1.0,
                0.38,
                45.0,
                1.0927,
                (1.598 - 1.0927) * PI_COS_20,
            ),
            ([17, 22], 4.0, 0.25, 78.0, 1.5477, 0.0),
        ] {
            let pair = of_module(teeth, module * 1e-3, tip_radius, a * 1e-3).expect("meshes");
            let found = pair.contact_ratio();
            assert!((found - ratio).abs() < 6e-5, "{teeth:?}: {found}");
            let shorter = pair.lost_to_undercut(Member::Driving) * 1e3;
            // The ratio without the undercut is printed to three decimals.
            assert!(
                (shorter - lost).abs() < (1.5e-3 * lost).max(6e-5),
                "{shorter}"
            );
            assert_eq!(pair.lost_to_undercut(Member::Driven), 0.0);
        }
        let pair = of_module([17, 43], 1e-3, 0.38, 30e-3).expect("meshes");
        let begins = pair.path_of_contact().0;
        assert!(
            (begins - 0.36e-3).abs() < 5e-6,
            "contact begins above the base circle"
        );
        assert!(matches!(
            of_module([10, 80], 1e-3, 0.38, 45.8e-3),
            Err(GearPairError::ContactRatioBelowOne { .. })
        ));
    }

    /// The base pitch of module 1 at 20 degrees.
    const PI_COS_20: f64 = 2.952_131;

    #[test]
    fn flanks_slide_at_both_ends_of_the_path_as_velocities_say() {
        // Independent of roll lengths: the velocities of both gears at the point of contact, along the flanks.
        for (z1, z2, a) in [(50, 50, 100.5e-3), (29, 85, 114e-3), (29, 85, 114.5e-3)] {
            let pair = GearPair::new(gear(z1), gear(z2), a).expect("meshes");
            let (speed_1, speed_2) = (1.0, -f64::from(z1) / f64::from(z2));
            let alpha_w = pair.working_pressure_angle();
            let along_line = crate::gear::tangential(-alpha_w);
            let (s_a, s_e) = pair.path_of_contact();
            for (end, s) in [s_a, s_e].into_iter().enumerate() {
                let at =
                    pair.driving().base_radius() * crate::gear::radial(-alpha_w) + s * along_line;
                let velocity = |speed: f64, center: f64| {
                    let arm = at - crate::gear::Vector::new(center, 0.0);
                    // Along the flank: across the line of action.
                    speed * (arm.y * along_line.y + arm.x * along_line.x)
                };
                let [v_1, v_2] = [velocity(speed_1, 0.0), velocity(speed_2, a)];
                for (member, expected) in [
                    (Member::Driving, (v_1 - v_2) / v_1),
                    (Member::Driven, (v_2 - v_1) / v_2),
                ] {
                    let found = pair.specific_sliding(member)[end].expect("bounded");
                    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
                }
            }
            // At A the root of the driving flank slides, at E that of the driven one.
            let [at_a, at_e] = pair.specific_sliding(Member::Driving);
            assert!(at_a < Some(0.0) && at_e > Some(0.0));
        }
    }

    #[test]
    fn an_active_profile_begins_where_the_tip_of_the_mate_ends() {
        let pair = GearPair::new(gear(50), gear(50), 100.5e-3).expect("meshes");
        // s_A = 13.3564 mm on a base radius of 46.984631 mm: sqrt(r_b2 + s2) = 48.846254 mm.
        let found = pair.active_root_radius(Member::Driving);
        assert!((found - 48.846_25e-3).abs() < 1e-7, "{found}");
        assert!(found > pair.driving().form_radius());
    }

    #[test]
    fn the_distance_printed_for_case_3_leaves_the_teeth_apart() {
        // Table 1 prints 118.5 mm, but the tip circles end at 31 mm + 87 mm; continuous meshing ends at 115.567 mm.
        let Err(GearPairError::TeethDoNotReach {
            tip_radii, largest, ..
        }) = GearPair::new(gear(29), gear(85), 118.5e-3)
        else {
            panic!("the teeth do not reach")
        };
        assert!((tip_radii - 118e-3).abs() < 1e-15);
        assert!((largest - 115.567e-3).abs() < 5e-7);
        assert!(GearPair::new(gear(29), gear(85), largest).is_ok());
        assert!(matches!(
            GearPair::new(gear(29), gear(85), largest + 1e-6),
            Err(GearPairError::ContactRatioBelowOne { .. })
        ));
    }

    #[test]
    fn teeth_too_thick_for_their_distance_are_refused_and_zero_backlash_is_not() {
        let Err(GearPairError::NegativeBacklash { smallest, .. }) =
            GearPair::new(gear(50), gear(50), 99.9e-3)
        else {
            panic!("jams")
        };
        assert!(
            (smallest - 100e-3).abs() < 1e-9,
            "the reference distance of unshifted gears has zero backlash"
        );
        assert!(GearPair::new(gear(50), gear(50), 100e-3).is_ok());
        assert!(matches!(
            GearPair::new(gear(50), gear(50), 80e-3),
            Err(GearPairError::NegativeBacklash { .. })
        ));
    }

    #[test]
    fn a_tip_that_enters_a_fillet_is_refused() {
        let mut long = paper_gear(50);
        long.rack.addendum = 2.6e-3;
        let long = SpurGear::new(long).expect("a long tooth");
        let Err(GearPairError::Interference {
            member: Member::Driving,
            smallest,
        }) = GearPair::new(gear(29), long.clone(), 114e-3 - 35e-3 + 1e-4)
        else {
            panic!("the long tips enter the fillets of the pinion")
        };
        assert!(GearPair::new(gear(29), long, smallest).is_ok());
    }

    #[test]
    fn the_true_periods_of_the_three_test_cases_are_25_5_and_85() {
        let holed = |z: u32, count| {
            let mut data = paper_gear(z);
            data.blank.holes = HolePattern {
                count,
                circle_radius: 30e-3,
                radius: 5e-3,
                phase: 0.0,
            }
            .holes();
            SpurGear::new(data).expect("fits")
        };
        let period = |one, other, a| GearPair::new(one, other, a).expect("meshes").period();
        assert_eq!(period(holed(50, 8), holed(50, 8), 100.5e-3), 25);
        assert_eq!(period(gear(50), holed(50, 10), 100.5e-3), 5);
        assert_eq!(period(gear(29), holed(85, 6), 114.5e-3), 85);
        assert_eq!(period(gear(50), gear(50), 100.5e-3), 1);
    }
}
