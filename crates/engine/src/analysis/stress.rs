//! The largest stresses at the roots of the teeth and at the edges of the holes, position by position.
//!
//! A free edge is stressed along itself only: the von Mises stress there is the magnitude of that tension or compression.

use std::f64::consts::TAU;

use super::AnalysisError;
use super::found::Kept;
use super::running::RestingStresses;
use super::setup::Setup;
use crate::assembly::face_roots::UNDER_CONTACT;
use crate::assembly::inside::{Answer, LoadedGear};
use crate::assembly::{Blanks, Inside, PartError, Probes};
use crate::contact::{ContactCells, ContactSolution, FlankLoad};
use crate::gear::{Involute, Member, Vector, radial};
use crate::grid::Grid;
use crate::run::Run;

/// How far from a loaded tooth, in teeth, the roots are looked at: a rim bends between the ends of a slot or the spokes under it.
pub(super) const REACH: usize = 8;

/// The largest stress along some edges, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakStress {
    /// The stress in Pa: of von Mises at holes, along the edge at roots, where pressure is negative.
    pub stress: f64,
    /// The polar angle of the place from the centerline of tooth 0 in radians, from 0 to 2π, in the frame of the gear.
    pub angle: f64,
    /// The radius of the place in meters.
    pub radius: f64,
    /// Its height from the middle of the face of its gear, in meters; `None` in the plane.
    pub z: Option<f64>,
}

/// The largest stresses of one gear at each position of a curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GearStresses {
    /// The largest tension along the fillets and root lands beside the loaded flanks, of the loaded teeth and their neighbors.
    pub root: Vec<PeakStress>,
    /// The largest first principal stress along the fillets and root lands on both sides of all teeth in reach.
    pub root_tension: Vec<PeakStress>,
    /// The smallest one: the largest compression, which is negative.
    pub root_compression: Vec<PeakStress>,
    /// The largest stress along the edges of the holes; empty without holes.
    pub holes: Vec<PeakStress>,
    /// The largest of all of them at further mesh positions between those.
    pub between: Vec<(f64, GearPeaks)>,
}

/// Places of a gear whose largest stress is in the results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StressedPlace {
    /// [`GearStresses::root`].
    Root,
    /// [`GearStresses::root_tension`].
    RootTension,
    /// [`GearStresses::root_compression`].
    RootCompression,
    /// [`GearStresses::holes`].
    Hole,
}

/// Both gears, to be asked for the stresses under a contact.
pub(super) struct StressModel {
    gears: [StressedGear; 2],
}

struct StressedGear {
    member: Member,
    inside: Inside,
    sector_angles: Vec<f64>,
    tooth_count: usize,
    /// The loaded flank, and how near to a contact on it a place is stressed by that rather than by the bending of the tooth.
    flank: Involute,
    under_contact: f64,
    /// Where the nodes along the fillet beside the loaded flank stand and those along the other one: polar angles from the centerline of their
    /// tooth, and radii.
    fillets: Vec<[f64; 2]>,
    /// How many of them are beside the loaded flank.
    beside_loaded: usize,
    /// Stresses of the gear without load.
    resting: RestingStresses,
    /// The same of the nodes along the edges of holes, in the frame of sector 0.
    edges: Vec<[f64; 2]>,
}

/// The largest stresses of one gear at one position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GearPeaks {
    /// As [`GearStresses::root`].
    pub root: PeakStress,
    /// As [`GearStresses::root_tension`].
    pub tension: PeakStress,
    /// As [`GearStresses::root_compression`].
    pub compression: PeakStress,
    /// As [`GearStresses::holes`]; `None` without holes.
    pub hole: Option<PeakStress>,
}

/// The peaks of both gears at one position.
pub(super) type PositionPeaks = [GearPeaks; 2];

impl StressModel {
    /// Stresses of both gears as `setup` has them, blanks flexible.
    pub(super) fn new(setup: &Setup<'_>) -> Result<Self, AnalysisError> {
        let spec = setup.spec(Blanks::Flexible);
        let of = |member: Member| -> Result<StressedGear, AnalysisError> {
            let gear = setup.case.pair.gear(member);
            let grids = spec.grids(member)?;
            let (tooth, loaded) = (&grids.tooth.grid, &grids.tooth.fillet_nodes);
            let sides = [loaded, &grids.tooth.back_fillet_nodes];
            let edges = grids.blank.as_ref().map_or_else(Vec::new, |blank| {
                polar(&blank.grid, &blank.hole_edges.concat())
            });
            let probes =
                Probes::along_free_edges(&grids.tooth, grids.blank.as_ref(), gear.material());
            let inside = spec.inside(member, &grids, &probes, setup.parts, setup.run)?;
            Ok(StressedGear {
                member,
                sector_angles: inside.sector_angles(),
                inside,
                tooth_count: gear.tooth_count() as usize,
                flank: *gear.flank(),
                under_contact: UNDER_CONTACT * gear.data().rack.module,
                fillets: polar(tooth, &sides.map(Vec::as_slice).concat()),
                beside_loaded: loaded.len(),
                resting: setup
                    .resting
                    .map(|both| both[member.index()].clone())
                    .unwrap_or_default(),
                edges,
            })
        };
        let (driving, driven) = rayon::join(|| of(Member::Driving), || of(Member::Driven));
        Ok(Self {
            gears: [driving?, driven?],
        })
    }

    /// Both gears, ready to be loaded.
    pub(super) fn loaded<'a>(&'a self, run: &Run) -> Result<LoadedPair<'a>, AnalysisError> {
        let [driving, driven] = &self.gears;
        let loaded = |gear: &'a StressedGear| {
            let loaded = gear.inside.loaded(run);
            loaded.map_err(|error| PartError::from(error).of(gear.member))
        };
        let (driving, driven) = rayon::join(|| loaded(driving), || loaded(driven));
        Ok(LoadedPair {
            model: self,
            gears: [driving?, driven?],
        })
    }
}

/// Both gears, ready to be loaded.
pub(super) struct LoadedPair<'a> {
    model: &'a StressModel,
    gears: [LoadedGear<'a>; 2],
}

impl LoadedPair<'_> {
    /// The largest stresses under the contact `solution` on `cells`.
    pub(super) fn peaks(
        &self,
        cells: &ContactCells<'_>,
        solution: &ContactSolution,
    ) -> PositionPeaks {
        Member::BOTH.map(|member| {
            let (gear, loaded) = (
                &self.model.gears[member.index()],
                &self.gears[member.index()],
            );
            let loads = cells.flank_loads(member, &solution.forces);
            let answer = loaded.under(&loads);
            let roots = gear.roots(&loads, &answer);
            let sectors = gear.sector_angles.iter().enumerate();
            let holes = sectors.flat_map(|(sector, &turn)| {
                let along = answer.in_blank(sector).into_iter().zip(&gear.edges);
                let along = along.enumerate().map(move |(i, (stress, place))| {
                    (stress + gear.resting.in_blank(sector, i), place)
                });
                along.map(move |(stress, place)| in_plane(stress.abs(), turn, *place))
            });
            let hole = (!gear.edges.is_empty()).then(|| largest(holes));
            GearPeaks::of(&roots, hole)
        })
    }
}

/// The stress at one place of a root.
pub(super) struct RootStress {
    /// The place, with the stress that is compared beside the loaded flanks.
    pub(super) peak: PeakStress,
    /// The first principal stress, and the smallest one.
    pub(super) principal: [f64; 2],
    /// True beside the loaded flank of a loaded tooth or of its neighbor.
    pub(super) in_mesh: bool,
}

impl GearPeaks {
    /// Stresses of all `roots` within reach, and the largest of its holes.
    pub(super) fn of(roots: &[RootStress], hole: Option<PeakStress>) -> Self {
        let principal = |i: usize| {
            let each = roots.iter();
            each.map(move |root| PeakStress {
                stress: root.principal[i],
                ..root.peak
            })
        };
        let in_mesh = roots.iter().filter(|root| root.in_mesh);
        Self {
            root: largest(in_mesh.map(|root| root.peak)),
            tension: largest(principal(0)),
            compression: smallest(principal(1)),
            hole,
        }
    }
}

/// How many of `tooth_count` teeth `tooth` is away from the nearest of the `loaded` ones.
pub(super) fn teeth_away(
    tooth: usize,
    loaded: impl Iterator<Item = usize>,
    tooth_count: usize,
) -> usize {
    let apart = loaded.map(|loaded| loaded.abs_diff(tooth));
    let apart = apart.map(|d| d.min(tooth_count - d));
    apart.min().unwrap_or(tooth_count)
}

impl StressedGear {
    /// The stresses at the roots of all teeth that `loads` reach, tooth by tooth, but for places under a contact.
    fn roots(&self, loads: &[FlankLoad], answer: &Answer<'_>) -> Vec<RootStress> {
        let z = self.tooth_count;
        let away = |tooth| teeth_away(tooth, loads.iter().map(|load| load.tooth), z);
        let reached = (0..z).filter(|tooth| away(*tooth) <= REACH);
        let of_tooth = |tooth: usize| {
            let turn = TAU * tooth as f64 / z as f64;
            let along = answer.in_tooth(tooth).into_iter().zip(&self.fillets);
            let own = loads.iter().find(|load| load.tooth == tooth);
            let pressed = own.map_or(&[][..], |load| &load.roll_lengths).iter();
            let pressed: Vec<Vector> = pressed.map(|s| self.flank.point(*s)).collect();
            let is_free = move |[angle, radius]: [f64; 2]| {
                let place = radius * radial(angle);
                let mut pressed = pressed.iter();
                pressed.all(|contact| (place - contact).norm() >= self.under_contact)
            };
            let along = along.enumerate().map(move |(i, (stress, place))| {
                (i, (stress + self.resting.in_tooth(tooth, i), place))
            });
            along.filter(move |(_, (_, place))| is_free(**place)).map(
                move |(i, (stress, place))| RootStress {
                    peak: in_plane(stress, turn, *place),
                    // Nothing presses on a free edge.
                    principal: [stress; 2],
                    in_mesh: i < self.beside_loaded && away(tooth) <= 1,
                },
            )
        };
        reached.flat_map(of_tooth).collect()
    }
}

impl Kept for PositionPeaks {
    fn watched(&self) -> Vec<f64> {
        let of = |peaks: &GearPeaks| {
            let hole = peaks.hole.map_or(0.0, |peak| peak.stress);
            let roots = [peaks.root.stress, peaks.tension.stress];
            [roots[0], roots[1], -peaks.compression.stress, hole]
        };
        self.iter().flat_map(of).collect()
    }
}

impl StressedPlace {
    /// The largest of `peaks` there.
    pub fn of(self, peaks: &GearPeaks) -> Option<PeakStress> {
        match self {
            Self::Root => Some(peaks.root),
            Self::RootTension => Some(peaks.tension),
            Self::RootCompression => Some(peaks.compression),
            Self::Hole => peaks.hole,
        }
    }
}

impl GearStresses {
    /// The largest stresses at `place`, position by position.
    pub fn of(&self, place: StressedPlace) -> &[PeakStress] {
        match place {
            StressedPlace::Root => &self.root,
            StressedPlace::RootTension => &self.root_tension,
            StressedPlace::RootCompression => &self.root_compression,
            StressedPlace::Hole => &self.holes,
        }
    }

    /// The largest stress at `place` over a curve with these mesh `positions`, between them too, and the mesh position at which it stands; `None` where there is
    /// no such place.
    pub fn largest(&self, place: StressedPlace, positions: &[f64]) -> Option<(f64, PeakStress)> {
        let between = self.between.iter();
        let between = between.filter_map(|(eta, peaks)| Some((*eta, place.of(peaks)?)));
        let at_positions = positions.iter().copied();
        let at_positions = at_positions.zip(self.of(place).iter().copied());
        at_positions.chain(between).reduce(|one, other| {
            if other.1.stress.abs() > one.1.stress.abs() {
                other
            } else {
                one
            }
        })
    }

    /// Stresses of both gears, from the peaks at each position, and at others `between` these.
    pub(super) fn of_positions(
        peaks: &[PositionPeaks],
        (places, between): (&[f64], &[PositionPeaks]),
    ) -> [Self; 2] {
        let between = |gear: usize| {
            let each = places.iter().zip(between);
            each.map(move |(eta, both)| (*eta, both[gear]))
        };
        [0, 1].map(|gear| Self {
            root: peaks.iter().map(|both| both[gear].root).collect(),
            root_tension: peaks.iter().map(|both| both[gear].tension).collect(),
            root_compression: peaks.iter().map(|both| both[gear].compression).collect(),
            holes: peaks.iter().filter_map(|both| both[gear].hole).collect(),
            between: between(gear).collect(),
        })
    }
}

/// The `stress` at a polar place that is turned by `turn`, of the plane.
fn in_plane(stress: f64, turn: f64, [angle, radius]: [f64; 2]) -> PeakStress {
    PeakStress {
        stress,
        angle: turn + angle,
        radius,
        z: None,
    }
}

/// The polar angles and the radii of `nodes`.
fn polar(grid: &Grid, nodes: &[u32]) -> Vec<[f64; 2]> {
    let places = nodes.iter().map(|node| grid.nodes[*node as usize]);
    places
        .map(|place| [place.y.atan2(place.x), place.norm()])
        .collect()
}

/// The first of the largest of `stresses`.
pub(super) fn largest(stresses: impl Iterator<Item = PeakStress>) -> PeakStress {
    let none = PeakStress {
        stress: 0.0,
        angle: 0.0,
        radius: 0.0,
        z: None,
    };
    stresses.fold(none, |most, peak| {
        if peak.stress > most.stress {
            PeakStress {
                angle: peak.angle.rem_euclid(TAU),
                ..peak
            }
        } else {
            most
        }
    })
}

/// The first of the smallest of `stresses`.
pub(super) fn smallest(stresses: impl Iterator<Item = PeakStress>) -> PeakStress {
    let opposite = |peak: PeakStress| PeakStress {
        stress: -peak.stress,
        ..peak
    };
    opposite(largest(stresses.map(opposite)))
}
