//! A curve between its positions.

use meshwright_engine::analysis::curve::{CurvePoint, EventSide, LoadShare, SAME_POSITION};
use meshwright_engine::analysis::stress::{GearStresses, PeakStress, StressedPlace};
use meshwright_engine::analysis::{Case, Curve};

use super::load_share::LoadShareDocument;
use super::stress::StressDocument;
use super::{all, each};
use crate::declare::document;
use crate::units::{or_null, to_mm, to_mpa, to_n_per_mm, to_um};

/// Positions farther apart than this multiple of their step are of different windows.
const NEXT: f64 = 1.5;

document! {
    /// A curve between its positions: at events, where a pair takes up or leaves the load, at the extremes of transmission error and stiffness, and at further
    /// positions at which the contact was solved. Pressure and stresses are largest at some of these. Its lists have the names of those of the curve.
    /// An event stands twice, with the stiffness just before and just behind it. Transmission error and stiffness are the curves of the statistics; pressure
    /// and stresses are solved where the contact was; the other values are on straight lines between the positions.
    pub struct BetweenDocument as Between, "Curve between its positions"
    answer of (case: &Case, curve: &Curve) with {
        let between = Between::of(case, curve);
        let points = &curve.points;
        let turned = |tooth_count: u32| {
            all(points, |point| point.mesh_position * 360.0 / f64::from(tooth_count))
        };
    } {
        /// The mesh position, in mesh periods, rising.
        mesh_position: Vec<f64> = all(points, |point| point.mesh_position),
        /// The rigid rotation of the driving gear, in degrees.
        driving_angle_deg: Vec<f64> = turned(case.pair.driving().tooth_count()),
        /// The rigid rotation of the driven gear, in degrees.
        driven_angle_deg: Vec<f64> = turned(case.pair.driven().tooth_count()),
        /// The static transmission error, in um.
        transmission_error_um: Vec<f64> = all(points, |point| to_um(point.transmission_error)),
        /// The tangent stiffness, in N/m.
        mesh_stiffness_tangent_n_per_m: Vec<f64> =
            all(points, |point| point.mesh_stiffness_tangent),
        /// The secant stiffness, in N/m.
        mesh_stiffness_secant_n_per_m: Vec<f64> = all(points, |point| {
            if curve.load == 0.0 { 0.0 } else { curve.load / point.transmission_error }
        }),
        /// The torque that the driver has to give, in N m.
        driving_torque_n_m: Vec<f64> = between.lines(&curve.driving_torque),
        /// The number of tooth pairs that carry load: that of the nearer position on the same side of the event.
        pairs_in_contact: Vec<u32> = between.nearer(&curve.pairs_in_contact),
        /// The largest contact pressure, in MPa; null where a sharp corner carries, or may.
        #[serde(serialize_with = "or_null")]
        peak_contact_pressure_mpa: Vec<Option<f64>> =
            all(&between.pressures(), |pressure| pressure.map(to_mpa)),
        /// The share of the load on each pair, by the offsets of the curve.
        load_shares: Vec<LoadShareDocument> =
            all(&between.load_shares(), LoadShareDocument::of),
        /// The largest stresses; absent as those of the curve are.
        stress?: StressDocument = curve
            .stresses
            .as_ref()
            .map(|stresses| StressDocument::of(&[0, 1].map(|i| between.stresses(&stresses[i])))),
        /// The load along the common face; absent for plane methods and at the torque 0.
        face?: FaceBetween = curve.face.as_ref().map(|face| {
            FaceBetween::of(&between.rows(&face.load), &between.lines(&face.load_centroid))
        }),
        /// The transmission error with rigid blanks, in um; absent for other methods than the decomposition.
        rigid_blank_transmission_error_um?: Vec<f64> = curve.decomposition.as_ref().map(|parts| {
            each(&between.lines(&parts.rigid_blank_transmission_error), to_um)
        }),
    }
}

document! {
    /// The load along the common face between the positions of a curve.
    pub struct FaceBetween as FaceBetween, "Load along the face between positions"
    answer of (load: &[Vec<f64>], load_centroid: &[f64]) {
        /// The load on each strip for its width, in N/mm: a row a point; empty where the curve has the mean over the positions alone.
        load_n_per_mm: Vec<Vec<f64>> = all(load, |row| each(row, to_n_per_mm)),
        /// Where the load stands in the mean, in mm from the middle of the common face.
        load_centroid_mm: Vec<f64> = each(load_centroid, to_mm),
    }
}

/// The points of a curve among its positions.
struct Between<'a> {
    curve: &'a Curve,
    spots: Vec<Spot>,
    /// The further mesh positions, rising, each with its place among them.
    solved: Vec<(f64, usize)>,
}

/// A point between two positions of a curve.
struct Spot {
    /// The positions beside it; the same one behind the last of a curve that does not close.
    beside: [usize; 2],
    /// Their mesh positions; behind the end of a curve that closes it goes on.
    positions: [f64; 2],
    /// The part of the way from the first to the second.
    part: f64,
    /// The nearer of both on the same side of the event.
    nearer: usize,
}

impl<'a> Between<'a> {
    /// That of `curve` of `case`.
    fn of(case: &Case, curve: &'a Curve) -> Self {
        let step = 1.0 / f64::from(case.resolution.positions_per_mesh_period);
        let closing = case.covers_whole_periods().then(|| f64::from(case.span()));
        let positions = &curve.mesh_position;
        let spot = |point: &CurvePoint| {
            let behind = positions.partition_point(|position| *position <= point.mesh_position);
            let from = behind.saturating_sub(1);
            let next = positions.get(from + 1).copied();
            let next = next.filter(|next| next - positions[from] < NEXT * step);
            let closing = closing.filter(|_| from + 1 == positions.len());
            let (to, end) = match (next, closing) {
                (Some(next), _) => (from + 1, next),
                (None, Some(span)) => (0, positions[0] + span),
                // Behind the last of a part of a period all is as there.
                (None, None) => (from, positions[from]),
            };
            let length = end - positions[from];
            let part = if length > 0.0 {
                (point.mesh_position - positions[from]) / length
            } else {
                0.0
            };
            Spot {
                beside: [from, to],
                positions: [positions[from], end],
                part,
                nearer: if part < 0.5 { from } else { to },
            }
        };
        let mut spots: Vec<Spot> = curve.points.iter().map(spot).collect();
        let mut begin = 0;
        for beside in spots.chunk_by_mut(|one, other| one.beside == other.beside) {
            let points = &curve.points[begin..begin + beside.len()];
            begin += beside.len();
            let at = |side: EventSide| move |point: &CurvePoint| point.event == Some(side);
            let first = points.iter().position(at(EventSide::Before));
            let last = points.iter().rposition(at(EventSide::Behind));
            for (i, spot) in beside.iter_mut().enumerate() {
                if first.is_some_and(|first| i <= first) {
                    spot.nearer = spot.beside[0];
                } else if last.is_some_and(|last| i >= last) {
                    spot.nearer = spot.beside[1];
                }
            }
        }
        let solved = curve.peak_pressures_between.iter().enumerate();
        let mut solved: Vec<(f64, usize)> = solved.map(|(i, (eta, _))| (*eta, i)).collect();
        solved.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            curve,
            spots,
            solved,
        }
    }

    /// The further position at which `point` stands, if the contact was solved there.
    fn solved_at(&self, point: &CurvePoint) -> Option<usize> {
        let near = point.mesh_position - SAME_POSITION;
        let i = self.solved.partition_point(|(eta, _)| *eta < near);
        let (eta, place) = self.solved.get(i)?;
        (eta - point.mesh_position <= SAME_POSITION).then_some(*place)
    }

    /// The `values` of the nearer positions.
    fn nearer<T: Copy>(&self, values: &[T]) -> Vec<T> {
        all(&self.spots, |spot| values[spot.nearer])
    }

    /// `values` on straight lines between the positions.
    fn lines(&self, values: &[f64]) -> Vec<f64> {
        all(&self.spots, |spot| {
            spot.line(spot.beside.map(|i| values[i]))
        })
    }

    /// The same of `rows` of a face; empty where there is one row for all positions.
    fn rows(&self, rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
        if rows.len() != self.curve.mesh_position.len() {
            return Vec::new();
        }
        let row = |spot: &Spot| {
            let [from, to] = spot.beside.map(|i| rows[i].iter());
            from.zip(to)
                .map(|(from, to)| spot.line([*from, *to]))
                .collect()
        };
        all(&self.spots, row)
    }

    /// The largest pressures: where the contact was solved, those; else on lines between the positions, `None` beside one at which it has no limit.
    fn pressures(&self) -> Vec<Option<f64>> {
        let values = &self.curve.peak_contact_pressure;
        let points = self.curve.points.iter();
        let pressure = |(point, spot): (&CurvePoint, &Spot)| match self.solved_at(point) {
            Some(place) => self.curve.peak_pressures_between[place].1,
            None => {
                let [from, to] = spot.beside.map(|i| values[i]);
                Some(spot.line([from?, to?]))
            }
        };
        points.zip(&self.spots).map(pressure).collect()
    }

    /// The shares of the load, by the offsets of the curve.
    fn load_shares(&self) -> Vec<LoadShare> {
        let shares = &self.curve.load_shares;
        let of_spot = |(point, spot): (&CurvePoint, &Spot)| -> Vec<f64> {
            // The offset of a pair falls by one with each whole mesh position.
            let later = spot
                .positions
                .map(|position| (point.mesh_position.floor() - position.floor()) as i32);
            let at = |side: usize, offset: i32| {
                let mut known = shares.iter();
                let known = known.find(|share| share.pair_offset == offset + later[side]);
                known.map_or(0.0, |known| known.share[spot.beside[side]])
            };
            let each = shares.iter().map(|share| share.pair_offset);
            let each: Vec<f64> = each
                .map(|offset| spot.line([at(0, offset), at(1, offset)]))
                .collect();
            let sum: f64 = each.iter().sum();
            let scale = if sum > 0.0 { sum.recip() } else { 1.0 };
            each.into_iter().map(|share| share * scale).collect()
        };
        let points = self.curve.points.iter().zip(&self.spots);
        let rows: Vec<Vec<f64>> = points.map(of_spot).collect();
        let each = shares.iter().enumerate();
        each.map(|(i, share)| LoadShare {
            pair_offset: share.pair_offset,
            share: rows.iter().map(|row| row[i]).collect(),
        })
        .collect()
    }

    /// The largest stresses of a gear: where the contact was solved for them, those; else on lines between the positions, and where the nearer stands.
    fn stresses(&self, gear: &GearStresses) -> GearStresses {
        let of = |place: StressedPlace| -> Vec<PeakStress> {
            let known = gear.of(place);
            if known.is_empty() {
                return Vec::new();
            }
            let points = self.curve.points.iter().zip(&self.spots);
            let peak = |(point, spot): (&CurvePoint, &Spot)| {
                let solved = self.solved_at(point);
                let solved = solved.and_then(|solved| place.of(&gear.between.get(solved)?.1));
                solved.unwrap_or_else(|| PeakStress {
                    stress: spot.line(spot.beside.map(|i| known[i].stress)),
                    ..known[spot.nearer]
                })
            };
            points.map(peak).collect()
        };
        GearStresses {
            root: of(StressedPlace::Root),
            root_tension: of(StressedPlace::RootTension),
            root_compression: of(StressedPlace::RootCompression),
            holes: of(StressedPlace::Hole),
            between: Vec::new(),
        }
    }
}

impl Spot {
    /// The value on the straight line between these `ends`.
    fn line(&self, [from, to]: [f64; 2]) -> f64 {
        from + self.part * (to - from)
    }
}
