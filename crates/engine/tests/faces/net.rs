//! A net of points over both flanks of every pair of teeth, and how deep they penetrate: by the drawings of the gears and the forces on
//! them alone, whatever slices the contact was found on.
//!
//! A point of one flank stands on a circle about the axis of the other gear, and so far as that gear has a flank there, this says by how
//! much it may turn until they meet. Loads move flanks by their smooth yield and by the half space under each line, of which the width
//! of its contact is left out: there the flanks are pressed together.

use faer::Mat;
use meshwright_engine::contact::face::{FaceContact, FaceModel, FlankCompliance, SliceLoad};
use meshwright_engine::gear::{Member, SolidPair};
use nalgebra::Vector2;

/// Points of a net up the flank, and across the face.
const UP: usize = 40;
const ACROSS: usize = 37;
/// Parts of a slice for the half space under it.
const PARTS: usize = 8;
/// Images of a load in the ends of the face, to either side.
const IMAGES: u32 = 20;
/// So many half-widths of a contact from where flanks are nearest they are pressed together, and give way as under a line: at a kink or an edge the whole
/// contact lies on one side of that place.
const PRESSED: f64 = 2.5;

/// The net of a pair under the forces of one contact.
pub(crate) struct Net<'a> {
    pair: &'a SolidPair,
    contact: &'a FaceContact,
    /// The pairs that are loaded, the functions on the flanks of each gear, and what they are moved by.
    pairs: Vec<i64>,
    yields: [Box<dyn FlankCompliance>; 2],
    moved: [Mat<f64>; 2],
}

/// A point that penetrates.
#[derive(Clone, Copy, Default)]
pub(crate) struct Deepest {
    /// How deep, along the normal.
    pub(crate) depth: f64,
    /// The pair n, the height on the common face and both roll lengths.
    pub(crate) at: (i64, f64, [f64; 2]),
}

impl<'a> Net<'a> {
    pub(crate) fn new<Y: FlankCompliance + 'static>(
        model: &'a FaceModel,
        contact: &'a FaceContact,
        yields: impl Fn(Member) -> Y,
    ) -> Self {
        let pair = model.pair();
        let reach = pair.total_contact_ratio().ceil() as i64 + 3;
        let slices = &contact.slices;
        let (first, last) = (slices[0].pair, slices[slices.len() - 1].pair);
        let pairs: Vec<i64> = (first - reach..=last + reach).collect();
        let yields =
            Member::BOTH.map(|member| Box::new(yields(member)) as Box<dyn FlankCompliance>);
        let moved = Member::BOTH.map(|member| {
            let of = &yields[member.index()];
            let size = of.basis_len();
            let mut loads = Mat::<f64>::zeros(size * pairs.len(), 1);
            let mut row = vec![0.0; size];
            for slice in slices {
                let z = pair.own_height(member, slice.z);
                of.basis(slice.roll_lengths[member.index()], z, &mut row);
                let first = size * (slice.pair - pairs[0]) as usize;
                for (i, value) in row.iter().enumerate() {
                    loads[(first + i, 0)] += value * slice.normal[0];
                }
            }
            let teeth: Vec<usize> = (0..pairs.len()).collect();
            of.smooth(&teeth) * loads
        });
        Self {
            pair,
            contact,
            pairs,
            yields,
            moved,
        }
    }

    /// The point of the net that penetrates deepest at the position `eta`.
    pub(crate) fn deepest(&self, eta: f64) -> Deepest {
        // Loads are even over a slice: at an end of the face half of one would stand beside it.
        let lengths = self.contact.slices.iter().map(|slice| slice.length);
        let half = 0.5 * (self.pair.common_face_width() - lengths.fold(0.0, f64::max));
        let mut deepest = Deepest::default();
        for &n in &self.pairs {
            for i in 0..ACROSS {
                let z = half * (2.0 * i as f64 / (ACROSS - 1) as f64 - 1.0);
                for (primary, s) in self.points() {
                    if let Some((depth, roll_lengths)) = self.depth(eta, (n, z), primary, s)
                        && depth > deepest.depth
                    {
                        deepest = Deepest {
                            depth,
                            at: (n, z, roll_lengths),
                        };
                    }
                }
            }
        }
        deepest
    }

    /// Whether all that carries is a line, without a sharp edge.
    pub(crate) fn are_lines(&self) -> bool {
        let slices = &self.contact.slices;
        let length: f64 = slices.iter().map(|slice| slice.length).sum();
        let widest = slices.iter().map(|slice| slice.half_width);
        let is_long = length > 20.0 * widest.fold(0.0, f64::max);
        is_long && slices.iter().all(|slice| !slice.at_sharp_edge)
    }

    /// The points up both flanks.
    fn points(&self) -> impl Iterator<Item = (Member, f64)> {
        Member::BOTH.into_iter().flat_map(|primary| {
            let gear = self.pair.section().gear(primary);
            let (from, to) = (gear.form_roll_length(), gear.tip_form_roll_length());
            (0..=UP).map(move |i| (primary, from + (to - from) * i as f64 / UP as f64))
        })
    }

    /// How deep the point at the roll length `s` of the flank of `primary` stands in the other flank, and where on both; `None` if it meets
    /// no flank there, or is pressed.
    fn depth(
        &self,
        eta: f64,
        (n, z): (i64, f64),
        primary: Member,
        s: f64,
    ) -> Option<(f64, [f64; 2])> {
        let section = self.pair.section();
        let at = section.roll_length_of(self.pair.phase(eta, n, z));
        let alpha = section.working_pressure_angle();
        let lag = self.contact.mesh.transmission_error / section.gear(Member::Driven).base_radius();
        let flanks = [at, section.line_of_action() - at];
        // From the axis of each gear, the other one at +x; flanks press clockwise on the driving gear's axis, the driven one turned by δ.
        let point = |member: Member, s: f64| {
            let r_b = section.gear(member).base_radius();
            let psi = alpha + (s - flanks[member.index()]) / r_b;
            let turn = match member {
                Member::Driving => psi,
                Member::Driven => psi - lag,
            };
            let (sin, cos) = turn.sin_cos();
            let (tangent, along) = (Vector2::new(cos, sin), Vector2::new(sin, -cos));
            (r_b * tangent + s * along, along)
        };
        let mate = primary.other();
        let (here, normal) = point(primary, s);
        // The half turn about the middle between the axes takes each gear to the other.
        let seen = Vector2::new(section.center_distance(), 0.0) - here;
        let other = section.gear(mate);
        let square = seen.norm_squared() - other.base_radius().powi(2);
        let met = square.max(0.0).sqrt();
        if square <= 0.0 || met < other.form_roll_length() || met > other.tip_form_roll_length() {
            return None;
        }
        let mut rolls = [s; 2];
        rolls[mate.index()] = met;
        if self.is_pressed(n, z, rolls) {
            return None;
        }
        let (there, _) = point(mate, met);
        let cross = |a: Vector2<f64>, b: Vector2<f64>| a.x * b.y - a.y * b.x;
        // Both flanks stand clockwise of what they press on.
        let angle = cross(seen, there).atan2(seen.dot(&there));
        let arm = -cross(seen, normal);
        let gap = arm * angle;
        let cosine = self.pair.base_helix_angle().cos();
        let teeth = section.teeth(n);
        let deviations = section.deviations();
        let removed = Member::BOTH.map(|member| {
            let (s, tooth) = (rolls[member.index()], teeth[member.index()]);
            let gear = section.gear(member);
            let turn = self.pair.gear(member).twist() * self.pair.own_height(member, z);
            let of = deviations.of_gear(member);
            gear.removed(s) - of.at(tooth, s) - of.runout(gear, tooth, s, turn)
        });
        let lead = self.pair.lead_gap(&deviations, teeth, z);
        let open = cosine * (gap + removed[0] + removed[1] + lead);
        if open >= 0.0 {
            return Some((0.0, rolls));
        }
        Some((-open - self.yielded((n, z), rolls), rolls))
    }

    fn line(&self, n: i64) -> impl Iterator<Item = &SliceLoad> {
        self.contact
            .slices
            .iter()
            .filter(move |slice| slice.pair == n)
    }

    /// Whether flanks are pressed together there.
    fn is_pressed(&self, n: i64, z: f64, rolls: [f64; 2]) -> bool {
        let cosine = self.pair.base_helix_angle().cos();
        self.line(n).any(|slice| {
            let beside = (z - slice.z).abs() < 0.5 * slice.length * (1.0 + 1e-9);
            let [s, mate] = self.touches(slice, z);
            // Up the flank, from the line.
            let away = (rolls[0].powi(2) - s.powi(2)).abs()
                / (2.0 * self.pair.section().gear(Member::Driving).base_radius());
            let away_on_mate = (rolls[1].powi(2) - mate.powi(2)).abs()
                / (2.0 * self.pair.section().gear(Member::Driven).base_radius());
            beside && away.min(away_on_mate) * cosine < PRESSED * slice.half_width
        })
    }

    /// Where the line of `slice` touches each gear at the height `z`: as its slices beside it say.
    fn touches(&self, slice: &SliceLoad, z: f64) -> [f64; 2] {
        let near = |other: &&SliceLoad| (other.z - slice.z).abs() < 1.5 * slice.length;
        let (mut low, mut high) = (slice, slice);
        for other in self.line(slice.pair).filter(near) {
            low = if other.z < low.z { other } else { low };
            high = if other.z > high.z { other } else { high };
        }
        let advance = self.pair.advance() * self.pair.section().base_pitch();
        [(0, advance), (1, -advance)].map(|(g, nominal)| {
            let slope = if high.z > low.z {
                (high.roll_lengths[g] - low.roll_lengths[g]) / (high.z - low.z)
            } else {
                nominal
            };
            slice.roll_lengths[g] + slope * (z - slice.z)
        })
    }

    /// How far both flanks of pair `n` give way along the normal at the height `z` and these roll lengths.
    fn yielded(&self, (n, z): (i64, f64), rolls: [f64; 2]) -> f64 {
        let of = Member::BOTH.map(|member| self.yielded_by(member, (n, z), rolls[member.index()]));
        of[0] + of[1]
    }

    fn yielded_by(&self, member: Member, (n, z): (i64, f64), s: f64) -> f64 {
        let yields = &self.yields[member.index()];
        let own = self.pair.own_height(member, z);
        let mut row = vec![0.0; yields.basis_len()];
        yields.basis(s, own, &mut row);
        let first = row.len() * (n - self.pairs[0]) as usize;
        let moved = &self.moved[member.index()];
        let smooth: f64 = (0..row.len()).map(|i| row[i] * moved[(first + i, 0)]).sum();

        let gear = self.pair.gear(member);
        let (r_b, tau) = (gear.section().base_radius(), gear.twist());
        let cosine = self.pair.base_helix_angle().cos();
        let material = gear.section().material();
        let factor = (1.0 - material.poisson_ratio.powi(2))
            / (std::f64::consts::PI * material.youngs_modulus);
        let mut half_space = 0.0;
        for slice in self.line(n) {
            for part in 0..PARTS {
                let to = slice.z + slice.length * ((part as f64 + 0.5) / PARTS as f64 - 0.5);
                let s_to = self.touches(slice, to)[member.index()];
                let to = self.pair.own_height(member, to);
                let perp =
                    (s * s - s_to * s_to) / (2.0 * r_b) - tau * 0.5 * (s + s_to) * (own - to);
                let gen_ = (own - to) / cosine;
                let distance = perp.hypot(gen_).max(0.5 * slice.half_width);
                let width = gear.face_width();
                let beyond = (1..=IMAGES).flat_map(|i| {
                    let mirrored = if i % 2 == 0 { own - to } else { own + to };
                    [-1.0, 1.0].map(|end| mirrored + end * f64::from(i) * width)
                });
                let images: f64 = beyond.map(|z| 1.0 / perp.hypot(z / cosine)).sum();
                // As far as these reach, a line without ends in the plane has this from both kinds of images.
                let reach = 2.0 * (f64::from(IMAGES) + 0.5) * width / cosine;
                let plane = 2.0 * cosine / width * (reach / gear.normal_rack().module).ln();
                let inverse = 1.0 / distance + images - plane;
                half_space += factor * slice.normal[0] / PARTS as f64 * inverse;
            }
        }
        smooth + half_space
    }
}
