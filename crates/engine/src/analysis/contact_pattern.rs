//! The contact pattern: where the flanks touch over a period, and how they press there; and the lines of contact that make it.

use super::case::Faces;
use super::three_dimensional::{running_model, yields};
use super::{AnalysisError, Case};
use crate::assembly::Parts;
use crate::contact::face::{FaceContact, SliceLoad};
use crate::gear::{Member, SolidPair};
use crate::run::Run;

/// Equal strips across the common face, and equal bands of the height of a flank.
const STRIPS: usize = 40;
const BANDS: usize = 32;

/// The pressure at a place of a flank. Of two the worse is the larger.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub enum Pressure {
    /// In Pa; zero where nothing touches.
    Of(f64),
    /// A sharp tip edge carries there, at which pressure has no limit.
    Unlimited,
}

/// The pattern of a pair under each of its loads. Lengths are in meters.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPattern {
    /// The width of the common face.
    pub face_width: f64,
    /// The middles of the strips, from the middle of the common face.
    pub heights: Vec<f64>,
    /// The driving and the driven flank.
    pub flanks: [FlankBands; 2],
    /// One entry for each output torque that was asked for.
    pub curves: Vec<PatternCurve>,
}

/// The bands into which the height of a flank is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct FlankBands {
    /// The radii of the form circle and of the tip circle, between which it lies.
    pub ends: [f64; 2],
    /// The radii of the middles of the bands, rising.
    pub radii: Vec<f64>,
    base_radius: f64,
}

/// The pattern under one load.
#[derive(Debug, Clone, PartialEq)]
pub struct PatternCurve {
    /// T in N m.
    pub output_torque: f64,
    /// The largest pressure over the positions on the driving and on the driven flank, band by band and strip by strip.
    pub largest: [Vec<Vec<Pressure>>; 2],
    /// The lines of contact at each position.
    pub positions: Vec<PatternPosition>,
}

/// The lines of contact at a position.
#[derive(Debug, Clone, PartialEq)]
pub struct PatternPosition {
    /// η in mesh periods.
    pub mesh_position: f64,
    /// One a pair that carries.
    pub lines: Vec<PatternLine>,
}

/// The line of contact of one pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PatternLine {
    /// n − floor(η) of the pair.
    pub pair_offset: i32,
    /// Its slices along z.
    pub slices: Vec<SliceLoad>,
}

/// The contact pattern of `case` under those of its torques that are in `output_torques`, none of them 0: that of the whole gears at every position,
/// also where they are projected. `None` for a plane case.
///
/// # Errors
///
/// As for [`super::analyze`].
pub fn contact_pattern(
    case: &Case,
    output_torques: &[f64],
    parts: &dyn Parts,
    run: &Run,
) -> Result<Option<ContactPattern>, AnalysisError> {
    faer::set_global_parallelism(faer::Par::Seq);
    let Some(faces) = &case.faces().map(|faces| faces.at(case.resolution.grid)) else {
        return Ok(None);
    };
    let yields = yields(faces, parts, run)?;
    let model = running_model((case, faces), &yields, parts, run)?;
    let positions = case.mesh_positions();
    let flanks = Member::BOTH.map(|member| FlankBands::of(&faces.pair, member));
    let map = Map {
        faces,
        flanks: &flanks,
    };
    let curves = output_torques.iter().map(|&output_torque| {
        let load = case.pair.load(output_torque);
        let contacts = model.contacts(load, &positions, run)?;
        Ok(PatternCurve {
            output_torque,
            largest: map.largest(&contacts, case.span()),
            positions: positions
                .iter()
                .zip(&contacts)
                .map(|(&eta, contact)| PatternPosition::of(eta, contact))
                .collect(),
        })
    });
    let curves = curves.collect::<Result<_, AnalysisError>>()?;
    Ok(Some(ContactPattern {
        face_width: faces.pair.common_face_width(),
        heights: (0..STRIPS).map(|strip| map.height(strip)).collect(),
        curves,
        flanks: flanks.clone(),
    }))
}

impl Pressure {
    fn worse(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

impl PatternPosition {
    fn of(eta: f64, contact: &FaceContact) -> Self {
        let lines = contact.slices.chunk_by(|one, next| one.pair == next.pair);
        Self {
            mesh_position: eta,
            lines: lines
                .map(|line| PatternLine {
                    pair_offset: (line[0].pair - eta.floor() as i64) as i32,
                    slices: line.to_vec(),
                })
                .collect(),
        }
    }
}

impl FlankBands {
    fn of(pair: &SolidPair, member: Member) -> Self {
        let gear = pair.section().gear(member);
        let ends = [gear.form_radius(), gear.tip_radius()];
        let band = (ends[1] - ends[0]) / BANDS as f64;
        Self {
            ends,
            radii: (0..BANDS)
                .map(|i| ends[0] + (i as f64 + 0.5) * band)
                .collect(),
            base_radius: gear.base_radius(),
        }
    }

    /// The radius at a roll length.
    pub fn radius(&self, roll_length: f64) -> f64 {
        self.base_radius.hypot(roll_length)
    }

    /// The band at a roll length; the last one for lengths beyond.
    fn band(&self, roll_length: f64) -> usize {
        let height = (self.radius(roll_length) - self.ends[0]) / (self.ends[1] - self.ends[0]);
        ((height * BANDS as f64).max(0.0) as usize).min(BANDS - 1)
    }
}

/// Where a pair touches at one height, and how it presses there.
struct Touch {
    pair: i64,
    bands: [usize; 2],
    pressure: Pressure,
}

/// Grid of a map.
struct Map<'a> {
    faces: &'a Faces,
    flanks: &'a [FlankBands; 2],
}

impl Map<'_> {
    fn height(&self, strip: usize) -> f64 {
        self.faces.pair.common_face_width() * ((strip as f64 + 0.5) / STRIPS as f64 - 0.5)
    }

    /// The largest pressure that `contacts` at equally spaced positions of a `span` exert, and those between two of them by the way.
    fn largest(&self, contacts: &[FaceContact], span: u32) -> [Vec<Vec<Pressure>>; 2] {
        let mut maps = [(); 2].map(|()| vec![vec![Pressure::Of(0.0); STRIPS]; BANDS]);
        for strip in 0..STRIPS {
            let touches: Vec<Vec<Touch>> = contacts
                .iter()
                .map(|contact| self.touches(contact, strip))
                .collect();
            for (i, now) in touches.iter().enumerate() {
                // After the last position comes the first one again, with other numbers of its pairs.
                let (next, renamed) = match touches.get(i + 1) {
                    Some(next) => (next, 0),
                    None => (&touches[0], i64::from(span)),
                };
                for touch in now {
                    let later = next.iter();
                    let later = later.filter(|later| later.pair + renamed == touch.pair);
                    for (map, member) in maps.iter_mut().zip(Member::BOTH) {
                        let mut mark = |band: usize, pressure| {
                            map[band][strip] = map[band][strip].worse(pressure);
                        };
                        let from = touch.bands[member.index()];
                        mark(from, touch.pressure);
                        for later in later.clone() {
                            let to = (later.bands[member.index()], later.pressure);
                            between((from, touch.pressure), to, &mut mark);
                        }
                    }
                }
            }
        }
        maps
    }

    /// Where `contact` touches in a strip: by the slices that reach over its middle, and by those that lie in it, however short they are. One between two strips
    /// lies in both.
    fn touches(&self, contact: &FaceContact, strip: usize) -> Vec<Touch> {
        const ROUNDING: f64 = 1e-9;
        let middle = self.height(strip);
        let width = self.faces.pair.common_face_width() / STRIPS as f64;
        let there = |slice: &&SliceLoad| {
            (slice.z - middle).abs() <= 0.5 * slice.length.max(width) * (1.0 + ROUNDING)
        };
        let slices = contact.slices.iter().filter(there);
        slices.filter_map(|slice| self.touch(slice)).collect()
    }

    /// Where `slice` touches, if it carries.
    fn touch(&self, slice: &SliceLoad) -> Option<Touch> {
        let pressure = if slice.at_sharp_edge {
            Pressure::Unlimited
        } else {
            Pressure::Of(slice.pressure?)
        };
        let band = |g: usize| self.flanks[g].band(slice.roll_lengths[g]);
        Some(Touch {
            pair: slice.pair,
            bands: [band(0), band(1)],
            pressure,
        })
    }
}

/// Fills the bands between two, neither of them included, with interpolated pressures.
fn between(
    (from, one): (usize, Pressure),
    (to, other): (usize, Pressure),
    mut mark: impl FnMut(usize, Pressure),
) {
    let apart = from.abs_diff(to) as f64;
    for band in from.min(to) + 1..from.max(to) {
        let part = band.abs_diff(from) as f64 / apart;
        let pressure = match (one, other) {
            (Pressure::Of(one), Pressure::Of(other)) => Pressure::Of(one + part * (other - one)),
            // An edge carries at the edge alone.
            (Pressure::Unlimited, Pressure::Unlimited) => Pressure::Unlimited,
            (limited @ Pressure::Of(_), _) | (_, limited) => limited,
        };
        mark(band, pressure);
    }
}
