//! Two gears with an extent along their axes in engagement: where their flanks meet along the faces.
//!
//! Every transverse section of the pair is the same pair of spur gears at another phase: a contact goes on by tan β_b/p_bt mesh
//! periods with each length along the axis. z runs from the middle of the common face; +z is the side from which the
//! driving gear is seen to turn counter-clockwise.

use super::lead::{LeadError, LeadModification};
use super::{GearPair, GearPairError, Member, PairDeviations, SolidGear};

/// The least part of the narrower face on which two gears touch.
const LEAST_OVERLAP: f64 = 0.1;

/// Least number of teeth of either gear that are out of mesh: no tooth carries at both ends of its face, in two pairs.
const LEAST_OUT_OF_MESH: f64 = 2.0;

/// Deviations of the axes of two gears, and of their faces. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Alignment {
    /// Where the mid plane of the driven face stands from that of the driving one.
    pub axial_offset: f64,
    /// By how much the axes are apart too far at the +z end of the common face and not at its −z end, in their plane.
    pub in_plane: f64,
    /// The same across their plane, positive where it opens the loaded flanks.
    pub out_of_plane: f64,
}

/// Why two gears with an extent along their axes cannot mesh. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SolidPairError {
    /// Their sections cannot mesh.
    #[error(transparent)]
    Section(#[from] GearPairError),
    /// Teeth of parallel axes wind as much one way as the other.
    #[error("helix angles of {driving} rad and {driven} rad do not mesh on parallel axes")]
    HelixMismatch {
        /// Of the driving gear, positive if right-handed.
        driving: f64,
        /// Of the driven gear.
        driven: f64,
    },
    /// The faces stand beside each other, or nearly.
    #[error(
        "an axial offset of {axial_offset} m leaves no common face; {nearest} m leaves a tenth of the narrower one"
    )]
    FacesDoNotOverlap {
        /// The offset asked for.
        axial_offset: f64,
        /// The nearest that leaves enough.
        nearest: f64,
    },
    /// A helical gear is so wide that its teeth wind around it, and nearly all are in mesh at once.
    #[error(
        "{total_contact_ratio} of the {teeth} teeth of the {member} gear are in mesh; a common face of {nearest} m leaves two out of it"
    )]
    TeethWindAround {
        /// The gear with fewer teeth.
        member: Member,
        /// Its teeth.
        teeth: u32,
        /// The total contact ratio ε_γ.
        total_contact_ratio: f64,
        /// The gear whose face bounds the common one, the driving gear where both do.
        narrower: Member,
        /// The widest common face.
        nearest: f64,
    },
    /// A lead cannot be modified so.
    #[error("the leads of the {member} gear: {error}")]
    Lead {
        /// The gear.
        member: Member,
        /// Why.
        error: LeadError,
    },
}

/// A stretch of the common face on which a pair of teeth is in some part of its engagement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLine {
    /// The pair n.
    pub pair: i64,
    /// Where it begins and ends along the axis.
    pub heights: [f64; 2],
}

/// Two gears on parallel axes, the first driving the second. Lengths are in meters, angles in radians.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidPair {
    gears: [SolidGear; 2],
    section: GearPair,
    leads: [Vec<LeadModification>; 2],
    alignment: Alignment,
    /// Where the common face begins and ends, from the middle of the driving face.
    common: [f64; 2],
}

/// Where the faces of `gears` overlap, from the middle of the driving one; the driven one stands `offset` from it.
fn common_face(gears: &[SolidGear; 2], offset: f64) -> [f64; 2] {
    let [b_1, b_2] = gears.each_ref().map(SolidGear::face_width);
    [
        (-0.5 * b_1).max(offset - 0.5 * b_2),
        (0.5 * b_1).min(offset + 0.5 * b_2),
    ]
}

impl SolidPair {
    /// The same pair with teeth that do not deviate.
    pub fn as_drawn(&self) -> Self {
        Self {
            gears: self.gears.each_ref().map(SolidGear::as_drawn),
            section: self.section.as_drawn(),
            ..self.clone()
        }
    }

    /// Sets two gears, driving and driven, with their modified `leads` at the operating `center_distance`.
    ///
    /// # Errors
    ///
    /// [`SolidPairError`] says why they cannot mesh there.
    pub fn new(
        gears: [SolidGear; 2],
        leads: [Vec<LeadModification>; 2],
        center_distance: f64,
        alignment: Alignment,
    ) -> Result<Self, SolidPairError> {
        let [driving, driven] = gears.each_ref().map(|gear| gear.helix().signed());
        if driving != -driven {
            return Err(SolidPairError::HelixMismatch { driving, driven });
        }
        let [one, other] = gears.each_ref().map(|gear| gear.section().clone());
        let offset = alignment.axial_offset;
        let common = common_face(&gears, offset);
        let overlap_ratio = Self::overlap_of(&gears, offset);
        let section = GearPair::overlapping(one, other, center_distance, overlap_ratio)?;
        for member in Member::BOTH {
            let width = gears[member.index()].face_width();
            for (i, lead) in leads[member.index()].iter().enumerate() {
                let checked = lead.check(i, width);
                checked.map_err(|error| SolidPairError::Lead { member, error })?;
            }
        }
        let [b_1, b_2] = gears.each_ref().map(SolidGear::face_width);
        let least = LEAST_OVERLAP * b_1.min(b_2);
        // Rounding of an offset that was typed for the least is the least.
        let enough = common[1] - common[0] >= least * (1.0 - 1e-9);
        if !enough {
            return Err(SolidPairError::FacesDoNotOverlap {
                axial_offset: offset,
                nearest: (0.5 * (b_1 + b_2) - least).copysign(offset),
            });
        }
        let pair = Self {
            gears,
            section,
            leads,
            alignment,
            common,
        };
        pair.check_winding()?;
        Ok(pair)
    }

    /// The overlap ratio ε_β of `gears` whose faces stand `axial_offset` from each other; 0 where they do not overlap.
    pub fn overlap_of(gears: &[SolidGear; 2], axial_offset: f64) -> f64 {
        let section = gears[0].section();
        let common = common_face(gears, axial_offset);
        let width = (common[1] - common[0]).max(0.0);
        width * gears[0].twist().abs() * section.base_radius() / section.base_pitch()
    }

    fn check_winding(&self) -> Result<(), SolidPairError> {
        let teeth = |member: &Member| self.section.gear(*member).tooth_count();
        let [one, other] = Member::BOTH;
        let fewer = |first: bool| if first { one } else { other };
        let member = fewer(teeth(&one) <= teeth(&other));
        let most = f64::from(teeth(&member)) - LEAST_OUT_OF_MESH;
        let total_contact_ratio = self.total_contact_ratio();
        // Straight teeth stay apart whatever their contact ratio is.
        if self.advance() == 0.0 || total_contact_ratio <= most {
            return Ok(());
        }
        let width = |member: Member| self.gear(member).face_width();
        Err(SolidPairError::TeethWindAround {
            member,
            teeth: teeth(&member),
            total_contact_ratio,
            narrower: fewer(width(one) <= width(other)),
            nearest: (most - self.section.contact_ratio()).max(0.0) / self.advance().abs(),
        })
    }

    /// The pair whose loaded flanks touch as the other flanks of this one do: turned over about the line of centers, at positions that go the
    /// other way round ([`GearPair::mirror_image`]). Holes stay where they are under the flanks.
    pub fn turned_over(&self) -> Self {
        let Alignment {
            axial_offset,
            in_plane,
            out_of_plane,
        } = self.alignment;
        let mut leads = Member::BOTH.map(|member| {
            let width = self.gear(member).face_width();
            let leads = self.leads(member).iter();
            leads
                .map(|lead| lead.turned_over(width))
                .collect::<Vec<_>>()
        });
        // The axes open from −z on; seen from the other side they have opened there already. So far the driven gear lags.
        let alpha = self.section.working_pressure_angle();
        let opened = in_plane * alpha.sin() - out_of_plane * alpha.cos();
        if opened != 0.0 {
            let half = 0.5 * self.gears[1].face_width();
            leads[1].push(LeadModification::Table {
                places: vec![-half, half],
                removed: vec![opened; 2],
            });
        }
        let [low, high] = self.common;
        Self {
            gears: (self.gears.each_ref()).map(|gear| gear.as_drawn().turned_over()),
            section: self.section.mirror_image(),
            leads,
            alignment: Alignment {
                axial_offset: 0.0 - axial_offset,
                in_plane: 0.0 - in_plane,
                out_of_plane,
            },
            common: [0.0 - high, 0.0 - low],
        }
    }

    /// The same with the blanks that stand under the other flanks: the holes of this pair as they are seen from the other side
    /// ([`GearPair::mirror_image_of_gears`]). Its teeth do not deviate.
    pub fn turned_over_with_blanks(&self) -> Self {
        let turned = self.turned_over();
        let section = self.section.as_drawn().mirror_image_of_gears();
        let [driving, driven] = &turned.gears;
        Self {
            gears: [
                driving.with_section(section.driving()),
                driven.with_section(section.driven()),
            ],
            section,
            ..turned
        }
    }

    /// The same with the driving blank turned by `angle` under its teeth, counter-clockwise.
    pub fn with_driving_blank_turned(&self, angle: f64) -> Self {
        let section = self.section.with_driving_blank_turned(angle);
        let [driving, driven] = &self.gears;
        Self {
            gears: [driving.with_section(section.driving()), driven.clone()],
            section,
            ..self.clone()
        }
    }

    /// The transverse section: a pair of spur gears.
    pub fn section(&self) -> &GearPair {
        &self.section
    }

    /// The gear that is `member` of the pair.
    pub fn gear(&self, member: Member) -> &SolidGear {
        &self.gears[member.index()]
    }

    /// How the leads of `member` are modified.
    pub fn leads(&self, member: Member) -> &[LeadModification] {
        &self.leads[member.index()]
    }

    /// How axes and faces stand.
    pub fn alignment(&self) -> Alignment {
        self.alignment
    }

    /// The width b of the common face.
    pub fn common_face_width(&self) -> f64 {
        self.common[1] - self.common[0]
    }

    /// Where `z` of the common face stands from the middle of the face of `member`.
    pub fn own_height(&self, member: Member, z: f64) -> f64 {
        let from_driving = z + f64::midpoint(self.common[0], self.common[1]);
        match member {
            Member::Driving => from_driving,
            Member::Driven => from_driving - self.alignment.axial_offset,
        }
    }

    /// tan β_b, positive where the driving gear is right-handed.
    fn base_helix_tangent(&self) -> f64 {
        self.gears[0].twist() * self.section.driving().base_radius()
    }

    /// The helix angle β_b at the base circles, without a sign.
    pub fn base_helix_angle(&self) -> f64 {
        self.base_helix_tangent().abs().atan()
    }

    /// The overlap ratio ε_β = b tan β_b/p_bt of the common face.
    pub fn overlap_ratio(&self) -> f64 {
        self.common_face_width() * self.advance().abs()
    }

    /// The total contact ratio ε_γ = ε_α + ε_β.
    pub fn total_contact_ratio(&self) -> f64 {
        self.section.contact_ratio() + self.overlap_ratio()
    }

    /// By how many mesh periods contacts go on with each meter along the axis.
    pub fn advance(&self) -> f64 {
        self.base_helix_tangent() / self.section.base_pitch()
    }

    /// The phase of pair `n` in the section at `z`: mesh periods since it passed the pitch point there.
    pub fn phase(&self, eta: f64, n: i64, z: f64) -> f64 {
        eta - n as f64 + z * self.advance()
    }

    /// Where on the common face each pair is in a phase between `first` and `last` at the mesh position `eta`.
    pub fn lines(&self, eta: f64, [first, last]: [f64; 2]) -> Vec<ContactLine> {
        let (half, advance) = (0.5 * self.common_face_width(), self.advance());
        let reach = half * advance.abs();
        let pairs = (eta - last - reach).ceil() as i64..=(eta - first + reach).floor() as i64;
        pairs
            .filter_map(|pair| {
                let [from, to] = [first, last].map(|phase| phase - (eta - pair as f64));
                let heights = if advance == 0.0 {
                    [-half, half]
                } else if advance > 0.0 {
                    [from / advance, to / advance]
                } else {
                    [to / advance, from / advance]
                };
                let heights = heights.map(|z| z.clamp(-half, half));
                (heights[1] > heights[0]).then_some(ContactLine { pair, heights })
            })
            .collect()
    }

    /// The theoretical contact lines at the mesh position `eta`: those on the path of contact.
    pub fn contact_lines(&self, eta: f64) -> Vec<ContactLine> {
        let (s_a, s_e) = self.section.path_of_contact();
        self.lines(eta, [s_a, s_e].map(|s| self.phase_at(s)))
    }

    /// The length of the theoretical contact lines at the mesh position `eta`.
    pub fn contact_length(&self, eta: f64) -> f64 {
        let lines = self.contact_lines(eta).into_iter();
        let heights = lines.map(|line| line.heights[1] - line.heights[0]);
        heights.sum::<f64>() / self.base_helix_angle().cos()
    }

    /// The phase at which a pair nominally touches at the roll length `s` of the driving gear.
    pub fn phase_at(&self, s: f64) -> f64 {
        (s - self.section.pitch_roll_length()) / self.section.base_pitch()
    }

    /// Gap of the loaded flanks of `teeth` at `z` beyond that of their sections, along the base tangent: by their leads and by the axes. `deviations` are those
    /// of the teeth.
    pub fn lead_gap(&self, deviations: &PairDeviations, teeth: [usize; 2], z: f64) -> f64 {
        let removed = self.removed_by_leads(deviations, teeth, z);
        self.misalignment_gap(z) + removed[0] + removed[1]
    }

    /// The gap of the flanks at `z` by the misalignment of the axes, along the base tangent.
    pub(crate) fn misalignment_gap(&self, z: f64) -> f64 {
        let along = z / self.common_face_width() + 0.5;
        let alpha = self.section.working_pressure_angle();
        let Alignment {
            in_plane,
            out_of_plane,
            ..
        } = self.alignment;
        (in_plane * alpha.sin() + out_of_plane * alpha.cos()) * along
    }

    /// Removal by the leads of both gears, and by those of `teeth` with these `deviations`, at `z` along the base tangent.
    pub(crate) fn removed_by_leads(
        &self,
        deviations: &PairDeviations,
        teeth: [usize; 2],
        z: f64,
    ) -> [f64; 2] {
        Member::BOTH.map(|member| {
            let (width, own) = (self.gear(member).face_width(), self.own_height(member, z));
            let leads = self.leads(member).iter();
            let of_tooth = deviations.of_gear(member);
            let of_tooth = of_tooth.removed_by_lead(teeth[member.index()], own, width);
            leads.map(|lead| lead.removed(own, width)).sum::<f64>() + of_tooth
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::Helix;
    use crate::gear::lead::FaceEnds;
    use crate::gear::spur::tests::paper_gear;

    fn pair(beta: f64, width: f64, alignment: Alignment) -> Result<SolidPair, SolidPairError> {
        let gear = |beta: f64, width: f64| {
            let mut data = paper_gear(40);
            data.face_width = width;
            SolidGear::new(data, Helix::right(beta), 0.0, None).expect("a gear that can be made")
        };
        let gears = [gear(beta, width), gear(-beta, 20e-3)];
        let a = 2.0 * gears[0].section().reference_radius();
        SolidPair::new(gears, [Vec::new(), Vec::new()], a, alignment)
    }

    #[test]
    fn the_ratios_are_those_of_the_standard() {
        let pair = pair(20_f64.to_radians(), 20e-3, Alignment::default()).expect("meshes");
        // ε_β = b sin β/(π m_n).
        let overlap = 20.0 * 20_f64.to_radians().sin() / (std::f64::consts::PI * 2.0);
        assert!((pair.overlap_ratio() - overlap).abs() < 1e-13);
        // sin β_b = sin β cos α_n.
        let sine = 20_f64.to_radians().sin() * 20_f64.to_radians().cos();
        assert!((pair.base_helix_angle().sin() - sine).abs() < 1e-15);
        let total = pair.section().contact_ratio() + overlap;
        assert!((pair.total_contact_ratio() - total).abs() < 1e-13);
    }

    #[test]
    fn the_contact_lines_have_one_length_where_the_overlap_is_whole() {
        let beta = 20_f64.to_radians();
        for whole in [1.0, 2.0] {
            let width = whole * std::f64::consts::PI * 2e-3 / beta.sin();
            let mut gears = [beta, -beta].map(|beta| {
                let mut data = paper_gear(40);
                data.face_width = width;
                SolidGear::new(data, Helix::right(beta), 0.0, None).expect("can be made")
            });
            for _ in 0..2 {
                let a = 2.0 * gears[0].section().reference_radius();
                let none = [Vec::new(), Vec::new()];
                let pair = SolidPair::new(gears.clone(), none, a, Alignment::default());
                let pair = pair.expect("meshes");
                // ε_α b/cos β_b for each unit of the overlap ratio, whatever the position.
                let expected =
                    pair.section().contact_ratio() * width / pair.base_helix_angle().cos();
                for i in 0..97 {
                    let length = pair.contact_length(f64::from(i) / 97.0);
                    assert!((length / expected - 1.0).abs() < 1e-12, "{length}");
                }
                gears.reverse();
            }
        }
        let other = pair(beta, 17e-3, Alignment::default()).expect("meshes");
        let lengths: Vec<f64> = (0..16)
            .map(|i| other.contact_length(f64::from(i) / 16.0))
            .collect();
        let least = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let most = lengths.iter().copied().fold(0.0, f64::max);
        assert!(most / least > 1.01, "elsewhere it swings");
    }

    #[test]
    fn faces_that_stand_apart_are_refused_and_the_named_offset_cures_it() {
        let offset = |axial_offset| Alignment {
            axial_offset,
            ..Alignment::default()
        };
        for sign in [1.0, -1.0] {
            let Err(SolidPairError::FacesDoNotOverlap { nearest, .. }) =
                pair(0.1, 10e-3, offset(sign * 15e-3))
            else {
                panic!("they touch at an edge only")
            };
            assert!((nearest - sign * 14e-3).abs() < 1e-12);
            let cured = pair(0.1, 10e-3, offset(nearest)).expect("a millimeter of common face");
            assert!((cured.common_face_width() - 1e-3).abs() < 1e-12);
        }
        let inside = pair(0.1, 10e-3, offset(3e-3)).expect("the narrow face within the wide one");
        assert!((inside.common_face_width() - 10e-3).abs() < 1e-15);
        assert!((inside.own_height(Member::Driving, 0.0)).abs() < 1e-15);
        assert!((inside.own_height(Member::Driven, 0.0) + 3e-3).abs() < 1e-15);
    }

    #[test]
    fn gears_that_wind_the_same_way_do_not_mesh() {
        let gear = |beta: f64| {
            SolidGear::new(paper_gear(40), Helix::right(beta), 0.0, None).expect("can be made")
        };
        let gears = [gear(0.2), gear(0.2)];
        let a = 2.0 * gears[0].section().reference_radius();
        let refused = SolidPair::new(gears, [Vec::new(), Vec::new()], a, Alignment::default());
        assert!(matches!(refused, Err(SolidPairError::HelixMismatch { .. })));
    }

    #[test]
    fn teeth_that_wind_around_their_gear_until_two_are_out_of_mesh_are_refused_with_the_width_that_leaves_two()
     {
        let beta = 40_f64.to_radians();
        let pair = |width: f64| {
            let gear = |beta: f64| {
                let mut data = paper_gear(20);
                data.face_width = width;
                data.blank.bore_radius = 8e-3;
                SolidGear::new(data, Helix::right(beta), 0.0, None)
                    .expect("a gear that can be made")
            };
            let gears = [gear(beta), gear(-beta)];
            let a = 2.0 * gears[0].section().reference_radius();
            SolidPair::new(gears, [Vec::new(), Vec::new()], a, Alignment::default())
        };
        let Err(SolidPairError::TeethWindAround { nearest, teeth, .. }) = pair(200e-3) else {
            panic!("an overlap of 20 of 20 teeth");
        };
        // ε_β = b sin β/(π m_n) = 18 − ε_α.
        let transverse = pair(20e-3).expect("meshes").section().contact_ratio();
        let width = (18.0 - transverse) * std::f64::consts::PI * 2e-3 / beta.sin();
        assert!(teeth == 20 && (nearest / width - 1.0).abs() < 1e-12);
        assert!(pair(nearest * (1.0 - 1e-9)).is_ok());
        assert!(pair(nearest * (1.0 + 1e-9)).is_err());
    }

    #[test]
    fn turned_over_the_other_flanks_are_as_far_apart_as_they_were() {
        let leads = vec![
            LeadModification::Slope { amount: 7e-6 },
            LeadModification::EndRelief {
                amount: 5e-6,
                length: 4e-3,
                ends: FaceEnds::Plus,
            },
            LeadModification::Table {
                places: vec![-6e-3, 1e-3, 5e-3],
                removed: vec![1e-6, 0.0, 3e-6],
            },
            LeadModification::Crowning { amount: 2e-6 },
        ];
        let alignment = Alignment {
            axial_offset: 3e-3,
            in_plane: 10e-6,
            out_of_plane: 20e-6,
        };
        let plain = pair(0.2, 18e-3, alignment).expect("meshes");
        let with = SolidPair {
            leads: [leads.clone(), leads],
            ..plain
        };
        // On the other flanks openings across the plane of the axes close.
        let of_other = SolidPair {
            alignment: Alignment {
                out_of_plane: -alignment.out_of_plane,
                ..alignment
            },
            ..with.clone()
        };
        let turned = with.turned_over();
        for z in [-7e-3, -3e-3, 0.0, 2e-3, 6.5e-3] {
            let gap = |pair: &SolidPair, z| pair.lead_gap(&PairDeviations::NONE, [0, 0], z);
            assert!((gap(&turned, -z) - gap(&of_other, z)).abs() < 1e-18);
        }
        // Turned twice it is the same, but for the form of its leads.
        let back = turned.turned_over();
        assert_eq!((back.gears, back.common), (with.gears.clone(), with.common));
        let even = pair(0.2, 20e-3, Alignment::default()).expect("meshes");
        assert_eq!(even.turned_over(), even);
    }

    #[test]
    fn a_misalignment_opens_from_nothing_to_its_part_along_the_line_of_action() {
        let alignment = Alignment {
            axial_offset: 0.0,
            in_plane: 10e-6,
            out_of_plane: 20e-6,
        };
        let pair = pair(0.2, 20e-3, alignment).expect("meshes");
        let alpha = pair.section().working_pressure_angle();
        let gap = |z| pair.lead_gap(&PairDeviations::NONE, [0, 0], z);
        assert!(gap(-10e-3).abs() < 1e-18);
        let whole = 10e-6 * alpha.sin() + 20e-6 * alpha.cos();
        assert!((gap(10e-3) - whole).abs() < 1e-18);
    }
}
