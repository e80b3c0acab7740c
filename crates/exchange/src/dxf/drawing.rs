//! Which loops of a drawing bound openings, which are the bore and the circle around, and which are none of these.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use meshwright_engine::gear::{Moments, Side, Vector};
use serde_json::{Value, json};

use super::center::{Closed, Seen, reach, seen};
use super::chain::{Loop, Open, Piece, Within};
use super::outline::{Choices, MOST_FAULTS, Outline, Refused, SHORTEST_MM};
use super::pieces::Source;
use super::shape::Made;
use crate::significant;

/// A loop of fitted curves that is a circle to within this is taken for one, in mm.
const CIRCLE_MM: f64 = 1e-3;

/// A drawing, and remarks on it.
pub(super) struct Drawing<'a> {
    pub(super) sources: &'a [Source<'a>],
    pub(super) in_mm: f64,
    /// Where its axis is, in its own frame.
    pub(super) center: Vector,
    pub(super) choices: &'a Choices,
    pub(super) remarks: Vec<String>,
}

impl<'a> Drawing<'a> {
    /// How far from the axis a center may be, in the unit of the drawing.
    fn slack(&self) -> f64 {
        self.choices.tolerance_mm.max(SHORTEST_MM) / self.in_mm
    }

    /// The ends that prevent loops, in sentences.
    pub(super) fn faults(&self, pieces: &[Piece], open: &[Open]) -> Refused {
        let open = open.iter().take(MOST_FAULTS + 1);
        Refused(open.map(|open| self.fault(pieces, open)).collect())
    }

    fn fault(&self, pieces: &[Piece], open: &Open) -> String {
        let tolerance = self.choices.tolerance_mm;
        match open {
            Open::End { piece, at, nearest } => {
                let near = match nearest {
                    Some((other, distance)) => format!(
                        "the nearest open end, of {}, is {} mm off",
                        self.sources[*other].place(),
                        significant(distance * self.in_mm, 3)
                    ),
                    None => "no other end is open".to_owned(),
                };
                format!(
                    "{} ends at {}, and nothing goes on within {tolerance} mm: {near}. Close the loop, choose the layer of the openings with --layer, or join ends up to 0.1 mm apart with --tolerance.",
                    self.sources[pieces[*piece].source].place(),
                    self.point(*at)
                )
            }
            Open::Branch { sources, at } => {
                let places = sources.iter().map(|i| self.sources[*i].place());
                let mut places: Vec<String> = places.collect();
                places.dedup();
                format!(
                    "More than two ends meet at {} within {tolerance} mm: of {}. Leave two of them, or choose a smaller --tolerance.",
                    self.point(*at),
                    places.join("; ")
                )
            }
        }
    }

    /// A point in the frame of the drawing.
    fn point(&self, at: Vector) -> String {
        let [x, y] = self.coordinates(at);
        format!("({x}, {y})")
    }

    /// The coordinates of a point in the frame of the drawing.
    fn coordinates(&self, at: Vector) -> [f64; 2] {
        let at = at + self.center;
        // The remainder of a sum's rounding counts as zero.
        [at.x, at.y].map(|x| significant((x * 1e9).round() / 1e9 + 0.0, 9))
    }

    /// The loops as a whole, without those that are drawn twice, and the entities that these are of.
    pub(super) fn closed(
        &self,
        loops: Vec<Loop>,
        within: Within,
    ) -> Result<(Vec<Closed>, Vec<usize>), Refused> {
        let mut closed: Vec<Closed> = Vec::with_capacity(loops.len());
        for Loop { sides, sources } in loops {
            let area = sides.iter().map(Side::moments).sum::<Moments>().area;
            let length: f64 = sides.iter().map(Side::length).sum();
            if area.abs() * self.in_mm <= SHORTEST_MM * length {
                let detail = format!(
                    "{} begins a loop that encloses nothing.",
                    self.sources[sources[0]].place()
                );
                return Err(detail.into());
            }
            closed.push(self.as_circle(Closed::of(sides, sources)));
        }
        let mut order: Vec<usize> = (0..closed.len()).collect();
        order.sort_by(|a, b| {
            closed[*a]
                .whole
                .center
                .x
                .total_cmp(&closed[*b].whole.center.x)
        });
        let near = 2.0 * within.same;
        let mut is_again = vec![false; closed.len()];
        for (i, one) in order.iter().enumerate() {
            let center = closed[*one].whole.center;
            let beside = order[i + 1..]
                .iter()
                .take_while(|other| closed[**other].whole.center.x - center.x <= near);
            for other in beside {
                if !is_again[*one] && closed[*one].is_same(&closed[*other], near) {
                    is_again[*other] = true;
                }
            }
        }
        let mut again = Vec::new();
        let mut kept = Vec::with_capacity(closed.len());
        for (closed, is_again) in closed.into_iter().zip(is_again) {
            if is_again {
                again.extend(closed.sources);
            } else {
                kept.push(closed);
            }
        }
        Ok((kept, again))
    }

    /// A loop of fitted curves that is a circle, as that.
    fn as_circle(&self, closed: Closed) -> Closed {
        let mut sources = closed.sources.iter();
        let is_fitted = sources.any(|source| self.sources[*source].made == Made::Fitted);
        let whole = &closed.whole;
        if !is_fitted || !whole.is_circle(CIRCLE_MM / self.in_mm) {
            return closed;
        }
        let (at, sense) = (whole.center, whole.area.signum());
        let moved = |side: &Side| Side::new(side.from + at, side.to + at, side.bulge);
        let sides = circle(whole.radius(), sense);
        Closed::of(sides.iter().map(moved).collect(), closed.sources)
    }

    /// Says which entities are drawn twice.
    pub(super) fn say_twice(&mut self, mut twice: Vec<usize>) {
        twice.sort_unstable();
        twice.dedup();
        if !twice.is_empty() {
            let names = twice.iter().map(|source| self.sources[*source].entity.name);
            self.remarks
                .push(format!("Drawn twice and taken once: {}.", counted(names)));
        }
    }

    /// Says how many ends were joined.
    pub(super) fn say_gaps(&mut self, (count, largest): (usize, f64)) {
        if count > 0 {
            self.remarks.push(format!(
                "Joined: {count} pairs of ends that are up to {} mm apart.",
                significant(largest * self.in_mm, 3)
            ));
        }
    }

    /// Refuses a drawing that turns about another point than the axis.
    pub(super) fn check_center(&self, loops: &[Closed]) -> Result<(), Refused> {
        let slack = self.slack();
        match seen(loops, slack) {
            Some(Seen { at, why }) if at.norm() > slack => {
                let axis = match self.choices.center {
                    None => "the origin",
                    Some(_) => "the chosen center",
                };
                let [x, y] = self.coordinates(at);
                let detail = format!(
                    "The drawing does not turn about {axis}: it seems to turn about ({x}, {y}), {why}. Choose that by --center {x},{y}, or in a request by center, or move the drawing there."
                );
                Err(detail.into())
            }
            _ => Ok(()),
        }
    }

    /// The layers of the entities of a loop.
    fn layers_of(&self, closed: &Closed) -> impl Iterator<Item = &'a str> {
        let sources = self.sources;
        closed.sources.iter().map(move |i| sources[*i].layer)
    }

    /// The loops of an outline, with the material on their left. `lone` are the ends of pieces that meet no others.
    pub(super) fn sorted(
        mut self,
        loops: &[Closed],
        pieces: &[Piece],
        lone: &[Open],
    ) -> Result<Outline, Refused> {
        let (around, openings): (Vec<&Closed>, Vec<&Closed>) = loops
            .iter()
            .partition(|closed| closed.is_around(Vector::zeros()));
        let layers: BTreeSet<&str> = openings
            .iter()
            .flat_map(|closed| self.layers_of(closed))
            .collect();
        if openings.is_empty() {
            let detail = "Each loop runs around the axis of the gear; none bounds an opening.";
            // One that was meant may be open.
            let mut refused = self.faults(pieces, lone);
            refused.0.insert(0, detail.to_owned());
            return Err(refused);
        }
        self.leave_out_lines(&layers, pieces, lone)?;
        self.check_openings(&openings)?;
        let clockwise = openings.iter().map(|closed| match closed.whole.area < 0.0 {
            true => closed.sides.clone(),
            false => closed.sides.iter().rev().map(Side::reversed).collect(),
        });
        let mut found = in_order(clockwise.collect());
        let [least, most] = reach(&found.concat());
        let names: Vec<&str> = layers.iter().copied().collect();
        self.remarks.push(format!(
            "Openings on layer {}: {}, from the radius {} mm to {} mm.",
            names.join(" and "),
            found.len(),
            self.mm(least),
            self.mm(most)
        ));
        let (circles, bore) = self.circles(&around, [least, most], &layers)?;
        found.extend(circles);
        Ok(Outline {
            loops: found.iter().map(|sides| self.written(sides)).collect(),
            bore_radius_mm: bore,
            remarks: self.remarks,
        })
    }

    /// Leaves out lines and arcs that meet no others, as center lines, where no opening is on their layers.
    fn leave_out_lines(
        &mut self,
        layers: &BTreeSet<&str>,
        pieces: &[Piece],
        lone: &[Open],
    ) -> Result<(), Refused> {
        let source = |open: &Open| match open {
            Open::End { piece, .. } => self.sources.get(pieces[*piece].source),
            Open::Branch { .. } => None,
        };
        let is_beside =
            |open: &&Open| source(open).is_some_and(|source| !layers.contains(source.layer));
        let (beside, wrong): (Vec<&Open>, Vec<&Open>) = lone.iter().partition(is_beside);
        if !wrong.is_empty() {
            let wrong = wrong.iter().take(MOST_FAULTS + 1);
            return Err(Refused(
                wrong.map(|open| self.fault(pieces, open)).collect(),
            ));
        }
        let names = beside.iter().filter_map(|open| source(open));
        let names = names.map(|source| format!("{} on layer {}", source.entity.name, source.layer));
        let names: Vec<String> = names.collect();
        if !names.is_empty() {
            let names = counted(names.iter().map(String::as_str));
            self.remarks.push(format!(
                "Left out, for they meet nothing and no opening is on their layer: {names}."
            ));
        }
        Ok(())
    }

    /// Refuses openings that are not known, and those within others.
    fn check_openings(&self, openings: &[&Closed]) -> Result<(), Refused> {
        let mut faults = Vec::new();
        for closed in openings {
            let sources = closed.sources.iter().map(|i| &self.sources[*i]);
            faults.extend(sources.filter_map(|source| match source.made {
                Made::Guessed(why) => Some(format!("{} {why}.", source.place())),
                Made::Drawn | Made::Fitted => None,
            }));
        }
        for outer in openings {
            for inner in openings {
                if !std::ptr::eq(*outer, *inner) && outer.encloses(inner) {
                    faults.push(format!(
                        "{} begins one loop inside another, that of {}: what stands in an opening is no part of the gear. Leave one of them out, or put it on another layer.",
                        self.sources[inner.sources[0]].place(),
                        self.sources[outer.sources[0]].place()
                    ));
                }
            }
            if faults.len() > MOST_FAULTS {
                break;
            }
        }
        if faults.is_empty() {
            Ok(())
        } else {
            Err(Refused(faults))
        }
    }

    /// The bore and the circle around of the loops around the axis, and the radius of the bore in mm. Openings lie between the radii of `within` and are on
    /// `layers`.
    fn circles(
        &mut self,
        around: &[&Closed],
        within: [f64; 2],
        layers: &BTreeSet<&str>,
    ) -> Result<(Vec<Vec<Side>>, Option<f64>), Refused> {
        let [least, most] = within;
        let chosen = self.choices.bore_radius_mm;
        if let Some(chosen) = chosen.filter(|chosen| *chosen >= least * self.in_mm) {
            let detail = format!(
                "A bore with the radius {chosen} mm reaches the openings, which begin at {} mm.",
                self.mm(least)
            );
            return Err(detail.into());
        }
        let slack = self.slack();
        let (mut bore, mut outer, mut others) = (None, None, Vec::new());
        // From the smallest to the largest.
        let mut around: Vec<([f64; 2], &Closed)> = around
            .iter()
            .map(|closed| (reach(&closed.sides), *closed))
            .collect();
        around.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]));
        for ([low, high], closed) in around {
            let radii = format!("{} to {} mm", self.mm(low), self.mm(high));
            let mut sources = closed.sources.iter().map(|i| &self.sources[*i]);
            let is_known = sources.all(|source| !matches!(source.made, Made::Guessed(_)));
            let is_circle = is_known && high - low <= 2.0 * slack;
            let (is_inside, is_outside) = (high <= least, low >= most);
            // Web edges and pitch circles.
            let is_beside =
                is_circle && !self.layers_of(closed).any(|layer| layers.contains(layer));
            let radius = f64::midpoint(low, high);
            let circle = |radius| format!("a circle of {} mm", self.mm(radius));
            match (is_inside, is_circle) {
                (true, true) if bore.is_none() && chosen.is_none() => bore = Some(radius),
                (true, true) => others.push(circle(radius)),
                (true, false) if chosen.is_some() => {
                    others.push(format!("a bore of {radii}, with a keyway or the like"));
                }
                (false, true) if is_outside => others.extend(outer.replace(radius).map(circle)),
                (false, false) if is_outside => others.push(format!("a contour of {radii}")),
                (false, true) if is_beside => others.push(circle(radius)),
                _ => {
                    let why = if is_inside {
                        "a bore is a circle: draw it without keyway and splines, or say its radius by --bore-radius, or in a request by bore_radius_mm"
                    } else {
                        "openings lie on both sides of it or cross it"
                    };
                    let detail = format!(
                        "{} begins a loop around the axis with the radii {radii}; {why}.",
                        self.sources[closed.sources[0]].place()
                    );
                    return Err(detail.into());
                }
            }
        }
        let drawn = bore.map(|radius| significant(radius * self.in_mm, 9));
        if let Some(radius) = drawn {
            self.remarks.push(format!(
                "The smallest circle about the axis is the bore: blank/bore_radius_mm is {radius}."
            ));
        }
        if let Some(radius) = chosen {
            self.remarks
                .push(format!("As chosen, blank/bore_radius_mm is {radius}."));
        }
        if !others.is_empty() {
            let others = others.join(", ");
            self.remarks.push(format!(
                "Left out, for they run around the axis and bound no opening: {others}."
            ));
        }
        let bore = bore.map(|radius| circle(radius, -1.0));
        let circles = bore
            .into_iter()
            .chain(outer.map(|radius| circle(radius, 1.0)))
            .collect();
        Ok((circles, chosen.or(drawn)))
    }

    /// A length in sentences, in mm.
    fn mm(&self, length: f64) -> f64 {
        significant(length * self.in_mm, 6)
    }

    /// The sides of a loop, as a submission has them.
    fn written(&self, sides: &[Side]) -> Vec<Value> {
        // 2.0000000000000004 says no more than 2.
        const DIGITS: f64 = 1e12;
        let point = |at: Vector| {
            json!([at.x, at.y].map(|x| (x * self.in_mm * DIGITS).round() / DIGITS + 0.0))
        };
        let side = |side: &Side| {
            if side.bulge == 0.0 {
                json!({ "line_to": point(side.to) })
            } else {
                json!({ "arc_to": point(side.to), "through": point(side.middle()) })
            }
        };
        sides.iter().map(side).collect()
    }
}

/// How often each of `names` is there.
fn counted<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for name in names {
        *counts.entry(name).or_default() += 1;
    }
    let counts = counts.iter().map(|(name, count)| format!("{count} {name}"));
    counts.collect::<Vec<_>>().join(", ")
}

/// Openings by the radius of their center of mass, and those of a circle by its angle from the x axis: the order in which they were drawn says nothing.
fn in_order(openings: Vec<Vec<Side>>) -> Vec<Vec<Side>> {
    /// Tolerance of radii and angles in a circle of openings: the digits of a drawing.
    const ALIKE: f64 = 1e-6;
    let center = |sides: &[Side]| {
        let moments: Moments = sides.iter().map(Side::moments).sum();
        moments.first / moments.area
    };
    let mut placed: Vec<(f64, f64, Vec<Side>)> = openings
        .into_iter()
        .map(|sides| {
            let center = center(&sides);
            let angle = (center.y.atan2(center.x) + ALIKE).rem_euclid(TAU);
            (center.norm(), angle, sides)
        })
        .collect();
    placed.sort_by(|a, b| a.0.total_cmp(&b.0));
    for circle in placed.chunk_by_mut(|a, b| b.0 - a.0 <= ALIKE * b.0) {
        circle.sort_by(|a, b| a.1.total_cmp(&b.1));
    }
    placed.into_iter().map(|placed| placed.2).collect()
}

/// A circle about the axis, counter-clockwise if `sense` is 1, clockwise if it is -1.
fn circle(radius: f64, sense: f64) -> Vec<Side> {
    let (one, other) = (Vector::new(radius, 0.0), Vector::new(-radius, 0.0));
    vec![Side::new(one, other, sense), Side::new(other, one, sense)]
}
