//! A pair along its faces, and how its flanks give way.

use std::sync::Arc;

use faer::{Mat, MatRef};

use super::flanks::FaceFlanks;
use crate::contact::PositionError;
use crate::contact::memo::Memo;
use crate::fem::dense::entries;
use crate::gear::{Member, PairDeviations, SolidPair};

/// How the flanks of one gear give way, smoothly, to forces normal to them.
///
/// z runs from the middle of the gear's own face. The displacement of tooth i at (s, z) into the tooth, under the force N on tooth j at (s', z'), is basis(s,
/// z)ᵀ smooth_ij basis(s', z') N, and of one tooth also that of a half space with images of the force beyond both ends of the face, which the contact adds, and
/// the further compliance at its ends.
pub trait FlankCompliance: Send + Sync {
    /// The number of functions over a flank.
    fn basis_len(&self) -> usize;

    /// Their values at the roll length `roll_length` and the height `z`, into `row`.
    fn basis(&self, roll_length: f64, z: f64, row: &mut [f64]);

    /// The compliance in m/N between the functions of the `teeth`, one block of rows and columns a tooth; symmetric.
    fn smooth(&self, teeth: &[usize]) -> Mat<f64>;

    /// The number of teeth after which all that they yield repeats.
    fn repeats_after(&self) -> usize;

    /// Displacement of a piece of a contact line by a unit force on another piece of the same tooth, over which it is spread, beside the smooth compliance and
    /// the half space. Both pieces have the length `along`; each is about a point, a roll length and a height.
    fn at_ends(&self, point: (f64, f64), loaded: (f64, f64), along: f64) -> f64;
}

/// Limit of matrices of smooth compliance in bytes: those of a holed gear of 120 teeth, each with four.
const MOST_BYTES: usize = 48 << 20;

/// A profile that turns by less at a place has no kink there.
const LEAST_TURN: f64 = 1e-6;

/// Two gears with an extent along their axes, ready for contact.
pub struct FaceModel {
    pub(super) flanks: FaceFlanks,
    pub(super) yields: [Arc<dyn FlankCompliance>; 2],
    /// How far apart teeth may stand that are loaded together.
    pub(super) coupled: usize,
    /// The kinks of both profiles at which flanks press harder than beside them.
    pub(super) kinks: Vec<Kink>,
    smooth: Memo<TwoTeeth, Mat<f64>>,
    /// [`FaceModel::first_reach`] of the last few loads, by their bits.
    pub(super) reaches: Memo<u64, Result<FirstReach, PositionError>>,
}

/// How many first reaches are known, in bytes.
const MOST_REACHES: usize = 64 * size_of::<Result<FirstReach, PositionError>>();

/// How far contact is looked for at first under a load.
#[derive(Debug, Clone, Copy)]
pub(super) struct FirstReach {
    /// The δ at which the first flanks touch where it was looked for.
    pub(super) touch: f64,
    /// The δ up to which flanks are looked at.
    pub(super) delta: f64,
}

/// A kink of a profile.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kink {
    /// The phase at which it stands in the middle of the contact, as drawn: flanks open alike on both of its sides.
    pub(super) phase: f64,
    /// How far it moves along its flank for each length along the line of action.
    pub(super) along: f64,
}

impl Kink {
    fn all(pair: &SolidPair) -> Vec<Self> {
        let of = Member::BOTH.map(|member| {
            let kinks = pair.section().gear(member).kinks().into_iter();
            kinks.filter_map(move |s| Self::at(pair, member, s))
        });
        of.into_iter().flatten().collect()
    }

    /// That of `member` at the roll length `s`, if it stands out.
    fn at(pair: &SolidPair, member: Member, s: f64) -> Option<Self> {
        let (section, gear) = (pair.section(), pair.section().gear(member));
        let [before, beyond] = gear.slopes_beside(s);
        if beyond - before <= LEAST_TURN {
            return None;
        }
        // Where two cylinders of the relative radius R are turned by φ, they touch R φ farther along the flank.
        let along = s / gear.base_radius();
        let mate = section.line_of_action() - s;
        let radius = s * mate / (s + mate);
        let middle = s + 0.5 * (before + beyond) / (along * along) * radius;
        let phase = match member {
            Member::Driving => pair.phase_at(middle),
            Member::Driven => pair.phase_at(section.line_of_action() - middle),
        };
        Some(Self { phase, along })
    }
}

/// Two teeth of a gear: one by its number, and how many pairs later the other one meets the mate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct TwoTeeth {
    gear: usize,
    tooth: usize,
    later: usize,
}

impl FaceModel {
    /// The `pair`, each of whose gears yields as `yields` say, with its face cut into so many `slices`, and teeth loaded together up to
    /// `coupled` apart.
    pub fn new(
        pair: SolidPair,
        yields: [Arc<dyn FlankCompliance>; 2],
        slices: usize,
        coupled: usize,
    ) -> Self {
        Self {
            kinks: Kink::all(&pair),
            flanks: FaceFlanks::new(pair, slices),
            yields,
            coupled,
            smooth: Memo::new(MOST_BYTES, |smooth| size_of::<f64>() * entries(smooth)),
            reaches: Memo::new(MOST_REACHES, size_of_val),
        }
    }

    /// The same, whose teeth have these `deviations`.
    pub fn deviating(self, deviations: PairDeviations) -> Self {
        Self {
            flanks: self.flanks.deviating(deviations),
            reaches: Memo::new(MOST_REACHES, size_of_val),
            ..self
        }
    }

    /// The pair.
    pub fn pair(&self) -> &SolidPair {
        &self.flanks.pair
    }

    /// Its flanks before they yield.
    pub fn flanks(&self) -> &FaceFlanks {
        &self.flanks
    }

    /// The smooth compliance of the teeth of `member` in the pairs from `first` on. That of two teeth is made once: over a long period the teeth of a holed gear
    /// come back at each fraction of the mesh period.
    pub(super) fn smooth(&self, member: Member, first: i64, count: usize) -> Smooth {
        let section = self.pair().section();
        let z = section.gear(member).tooth_count() as usize;
        let (yields, step) = (&self.yields[member.index()], section.tooth(member, 1));
        let of_two = |a: usize, b: usize| {
            let key = TwoTeeth {
                gear: member.index(),
                tooth: section.tooth(member, first + a as i64) % yields.repeats_after(),
                later: b - a,
            };
            self.smooth.get(key, |key| {
                let other = (key.tooth + key.later * step) % z;
                if key.later == 0 {
                    return yields.smooth(&[key.tooth]);
                }
                let size = yields.basis_len();
                let both = yields.smooth(&[key.tooth, other]);
                both.submatrix(0, size, size, size).to_owned()
            })
        };
        let of_tooth = |a: usize| (a..count).map(|b| of_two(a, b)).collect();
        Smooth {
            first,
            later: (0..count).map(of_tooth).collect(),
        }
    }
}

/// The smooth compliance between the teeth of one gear in successive pairs.
pub(super) struct Smooth {
    first: i64,
    /// That between the tooth of each pair and itself, and those of all later pairs.
    later: Vec<Vec<Arc<Mat<f64>>>>,
}

impl Smooth {
    /// That between the teeth in two pairs.
    pub(super) fn block(&self, a: i64, b: i64) -> MatRef<'_, f64> {
        let [a, b] = [a, b].map(|pair| (pair - self.first) as usize);
        let block = |a: usize, b: usize| Mat::as_ref(&self.later[a][b - a]);
        if a <= b {
            block(a, b)
        } else {
            block(b, a).transpose()
        }
    }
}
