//! The boundaries of a blank and the edges of its web, divided into the sides of triangles.

use std::f64::consts::PI;

use super::outline::Outline;
use super::sizes::{Boundary, Sizes};
use super::triangles::Chain;
use crate::gear::Vector;

/// Elements around any closed curve at the coarse level, at least.
pub(super) const LEAST_AROUND: usize = 12;
/// Points on the edge of a web stand off the boundary by this at least, in sizes, except where both cross; nearer by, elements
/// take the mean of both thicknesses.
const NEAREST_WEB: f64 = 0.45;
/// Two points on a boundary where web edges cross it stand apart by this at least, in sizes; of nearer ones the first counts.
const NEAREST_CROSSINGS: f64 = 0.5;

/// All curves in their elements.
#[derive(Debug)]
pub(super) struct Outlines {
    points: Vec<Vector>,
    chains: Vec<Chain>,
}

/// Where the edge of a web meets a boundary: how far around its circle, and the node that stands there.
type Meeting = (f64, u32);

impl Outlines {
    /// Divides `boundaries`, and the circles of `web_edges` as far as they run through the material.
    pub(super) fn new(boundaries: &[Boundary], web_edges: &[f64], sizes: &Sizes) -> Self {
        let mut outlines = Self {
            points: Vec::new(),
            chains: Vec::new(),
        };
        let mut meetings: Vec<Vec<Meeting>> = vec![Vec::new(); web_edges.len()];
        for boundary in boundaries {
            outlines.add_boundary(boundary, web_edges, &mut meetings, sizes);
        }
        for (radius, mut meetings) in web_edges.iter().zip(meetings) {
            meetings.sort_by(|a, b| a.0.total_cmp(&b.0));
            outlines.add_web_edge(*radius, &meetings, sizes);
        }
        outlines
    }

    /// The points, and the chains that stand on them: boundaries first.
    pub(super) fn finish(self) -> (Vec<Vector>, Vec<Chain>) {
        (self.points, self.chains)
    }

    fn node(&mut self, point: Vector) -> u32 {
        self.points.push(point);
        self.points.len() as u32 - 1
    }

    fn add_boundary(
        &mut self,
        boundary: &Boundary,
        web_edges: &[f64],
        meetings: &mut [Vec<Meeting>],
        sizes: &Sizes,
    ) {
        let outline = &boundary.outline;
        let mut crossings: Vec<(f64, Option<usize>)> = Vec::new();
        for (edge, radius) in web_edges.iter().enumerate() {
            crossings.extend(
                outline
                    .crossings(*radius)
                    .into_iter()
                    .map(|s| (s, Some(edge))),
            );
        }
        // Where sides join smoothly a point is worth having, where they meet at an angle there has to be one.
        let (sharp, smooth): (Vec<_>, Vec<_>) = outline
            .corners()
            .into_iter()
            .partition(|(_, is_sharp)| *is_sharp);
        crossings.extend(smooth.into_iter().map(|(s, _)| (s, None)));
        let sharp: Vec<f64> = sharp.into_iter().map(|(s, _)| s).collect();
        let apart = |a: f64, b: f64| (a - b).abs() > NEAREST_CROSSINGS * sizes.at(outline.point(a));
        crossings.retain(|(s, _)| sharp.iter().all(|corner| apart(*s, *corner)));
        crossings.extend(sharp.iter().filter(|s| **s > 0.0).map(|s| (*s, None)));
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Also not too near the start, which is a point of its own.
        let least = |s: f64| NEAREST_CROSSINGS * sizes.at(outline.point(s));
        let mut last = 0.0;
        crossings.retain(|&(s, _)| {
            let apart =
                sharp.contains(&s) || s - last > least(s) && outline.length() - s > least(s);
            if apart {
                last = s;
            }
            apart
        });
        let through: Vec<f64> = crossings.iter().map(|(s, _)| *s).collect();
        let lengths = sizes.divide(outline, boundary.least_size, LEAST_AROUND, &through);
        let nodes: Vec<u32> = lengths
            .iter()
            .map(|s| self.node(outline.point(*s)))
            .collect();
        for (s, edge) in crossings {
            let Some(edge) = edge else { continue };
            if let Some(place) = lengths.iter().position(|length| *length == s) {
                let point = outline.point(s);
                let around = web_edges[edge] * (point.y.atan2(point.x) + PI);
                meetings[edge].push((around, nodes[place]));
            }
        }
        self.chains.push(Chain {
            outline: outline.clone(),
            nodes,
            lengths,
            closed: true,
            bounds: true,
        });
    }

    /// Divides the edge of a web at `radius` through its `meetings`: one closed chain, or several open ones between boundaries.
    fn add_web_edge(&mut self, radius: f64, meetings: &[Meeting], sizes: &Sizes) {
        let outline = Outline::Circle { radius };
        let through: Vec<f64> = meetings
            .iter()
            .map(|(s, _)| *s)
            .filter(|s| *s > 0.0)
            .collect();
        let lengths = sizes.divide(&outline, outline.length() / 64.0, LEAST_AROUND, &through);
        let nodes: Vec<Option<u32>> = lengths
            .iter()
            .map(|s| {
                let met = meetings.iter().find(|(at, _)| at == s);
                met.map(|(_, node)| *node).or_else(|| {
                    let point = outline.point(*s);
                    let stands = sizes.is_inside(point, NEAREST_WEB * sizes.at(point));
                    stands.then(|| self.node(point))
                })
            })
            .collect();
        let count = nodes.len();
        // Past the start of the circle lengths go on.
        let length = |i: usize| lengths[i % count] + (i / count) as f64 * outline.length();
        let joined = |i: usize| {
            let middle = outline.point(f64::midpoint(length(i), length(i + 1)));
            nodes[i % count].is_some()
                && nodes[(i + 1) % count].is_some()
                && sizes.is_inside(middle, 0.0)
        };
        let chain = |links: std::ops::Range<usize>, closed: bool| {
            let last = if closed { links.end } else { links.end + 1 };
            Chain {
                outline: outline.clone(),
                nodes: (links.start..last)
                    .filter_map(|i| nodes[i % count])
                    .collect(),
                lengths: (links.start..last).map(length).collect(),
                closed,
                bounds: false,
            }
        };
        let Some(gap) = (0..count).find(|i| !joined(*i)) else {
            self.chains.push(chain(0..count, true));
            return;
        };
        let mut first = gap + 1;
        for i in gap + 1..=gap + count {
            if !joined(i) {
                if i > first {
                    self.chains.push(chain(first..i, false));
                }
                first = i + 1;
            }
        }
    }
}
