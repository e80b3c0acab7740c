//! The stress on a free surface of a prism, over some edges of its section.
//!
//! Nothing acts across a free surface, so that its strain decides its stress: with the surface a function of its length in the section and of z, the strains
//! along it are those of the displacements of its own nodes, and the stresses those of a sheet. No other node is needed.

use nalgebra::{Matrix2, Vector3};

use super::axial::AxialBasis;
use super::prism::{COMPONENTS, Prism};
use crate::gear::{Vector, radial, tangential};

/// Heights across the body at which stresses are computed, for each degree of its functions.
const HEIGHTS_PER_DEGREE: usize = 4;

/// Points of the rule by which a displacement is projected on the functions across the body, beyond their degree.
const RULE_BEYOND_DEGREE: usize = 3;

/// The free surface over some edges of the section of a prism.
#[derive(Debug)]
pub(crate) struct Surface {
    twist: f64,
    youngs_modulus: f64,
    poisson_ratio: f64,
    axial: AxialBasis,
    /// The nodes of the edges, edge after edge.
    nodes: Vec<Node>,
    heights: Vec<Height>,
}

/// A node of the section.
#[derive(Debug)]
struct Node {
    number: u32,
    place: Vector,
    /// The number of its edge.
    edge: usize,
    /// The sides of elements that meet at it.
    sides: Vec<Side>,
}

/// One side of an element, at one of its nodes.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// The part that it has in the node's strains.
    share: f64,
    /// Its nodes, as they stand in the surface.
    nodes: [usize; 3],
    /// The derivatives of their shape functions there.
    slopes: [f64; 3],
}

/// The stresses on a surface at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceStress {
    /// The larger and the smaller principal stress in the surface, in Pa; the third is none.
    pub principal: [f64; 2],
    /// The number of its edge.
    pub edge: usize,
    /// Where it stands in the section.
    pub place: Vector,
    /// The polar angle of the place, from the x axis of the section at z = 0.
    pub angle: f64,
    /// Its height.
    pub z: f64,
}

impl SurfaceStress {
    /// The stress of von Mises.
    pub fn von_mises(&self) -> f64 {
        let [one, other] = self.principal;
        (one * one - one * other + other * other).sqrt()
    }
}

impl Surface {
    /// Stress of `prism` over `edges`: corners and midsides in turn, beginning with a corner; closed ones without their first node again.
    pub(crate) fn new(prism: &Prism<'_>, edges: &[&[u32]], closed: bool) -> Self {
        let mut nodes = Vec::new();
        for (edge, numbers) in edges.iter().enumerate() {
            let sides = sides(numbers.len(), nodes.len(), closed);
            nodes.extend(numbers.iter().zip(sides).map(|(&number, sides)| Node {
                number,
                place: prism.grid.nodes[number as usize],
                edge,
                sides,
            }));
        }
        Self {
            twist: prism.twist,
            youngs_modulus: prism.material.youngs_modulus,
            poisson_ratio: prism.material.poisson_ratio,
            axial: prism.axial.clone(),
            nodes,
            heights: heights(prism.axial),
        }
    }

    /// The numbers of its nodes in the grid, edge after edge.
    pub(crate) fn nodes(&self) -> Vec<u32> {
        self.nodes.iter().map(|node| node.number).collect()
    }

    /// Displacements of the nodes where its section is turned by `turn`, as [`Surface::stresses`] takes them: `at` has the displacement along the axes of the gear over
    /// the height, at a place in the section that is turned.
    pub(crate) fn moved_by<F: Fn(f64) -> [f64; COMPONENTS]>(
        &self,
        turn: f64,
        at: impl Fn(Vector) -> F,
    ) -> Vec<f64> {
        let m = self.axial.len();
        let rule = self.axial.rule(self.axial.degree() + RULE_BEYOND_DEGREE);
        let rule: Vec<(Vec<f64>, f64)> = rule
            .into_iter()
            .map(|(z, w)| (self.axial.values(z).iter().map(|f| w * f).collect(), z))
            .collect();
        let mut moved = vec![0.0; self.nodes.len() * COMPONENTS * m];
        for (node, moved) in self
            .nodes
            .iter()
            .zip(moved.chunks_exact_mut(COMPONENTS * m))
        {
            let angle = node.place.y.atan2(node.place.x) + turn;
            let over_height = at(node.place.norm() * radial(angle));
            for (weights, z) in &rule {
                let [x, y, along] = over_height(*z);
                let flat = Vector::new(x, y);
                let polar = [
                    flat.dot(&radial(angle)),
                    flat.dot(&tangential(angle)),
                    along,
                ];
                for (moved, u) in moved.chunks_exact_mut(m).zip(polar) {
                    for (moved, weight) in moved.iter_mut().zip(weights) {
                        *moved += weight * u;
                    }
                }
            }
        }
        moved
    }

    /// The stresses at each node and height where the nodes move by `moved`: node by node, in polar components, for each function along the
    /// axis.
    pub(crate) fn stresses(&self, moved: &[f64]) -> Vec<SurfaceStress> {
        let m = self.axial.len();
        let frames: Vec<[Vector; 2]> = self
            .nodes
            .iter()
            .map(|node| {
                let angle = node.place.y.atan2(node.place.x);
                [radial(angle), tangential(angle)]
            })
            .collect();
        let mut stresses = Vec::with_capacity(self.nodes.len() * self.heights.len());
        for Height { z, values, slopes } in &self.heights {
            // In the axes of the section, at this height.
            let of = |node: usize, functions: &[f64]| {
                let [r, t, w] = std::array::from_fn(|c| {
                    let first = (node * COMPONENTS + c) * m;
                    let shares = moved[first..first + m].iter().zip(functions);
                    shares.map(|(u, f)| u * f).sum::<f64>()
                });
                let flat = r * frames[node][0] + t * frames[node][1];
                Vector3::new(flat.x, flat.y, w)
            };
            let at: Vec<_> = (0..self.nodes.len()).map(|i| of(i, values)).collect();
            for (i, node) in self.nodes.iter().enumerate() {
                let rise = of(i, slopes);
                let mut strain = Matrix2::zeros();
                for side in &node.sides {
                    strain += side.share * self.strain(i, side, (&at, rise));
                }
                stresses.push(SurfaceStress {
                    principal: self.principal(&strain),
                    edge: node.edge,
                    place: node.place,
                    angle: node.place.y.atan2(node.place.x) + self.twist * z,
                    z: *z,
                });
            }
        }
        stresses
    }

    /// The strains in the surface at node `i` as `side` sees them, along orthonormal directions: `at` are the displacements of all nodes, and
    /// `rise` that of this one by z, in the axes of the section.
    fn strain(
        &self,
        i: usize,
        side: &Side,
        (at, rise): (&[Vector3<f64>], Vector3<f64>),
    ) -> Matrix2<f64> {
        let of_side = || side.nodes.into_iter().zip(side.slopes);
        let tangent: Vector = of_side()
            .map(|(k, slope)| slope * self.nodes[k].place)
            .sum();
        let along: Vector3<f64> = of_side().map(|(k, slope)| slope * at[k]).sum();
        // The section turns with z, and its axes with it.
        let turned = |x: f64, y: f64| self.twist * Vector3::new(-y, x, 0.0);
        let a = [
            Vector3::new(tangent.x, tangent.y, 0.0),
            turned(self.nodes[i].place.x, self.nodes[i].place.y) + Vector3::z(),
        ];
        let u = [along, rise + turned(at[i].x, at[i].y)];
        let covariant = Matrix2::from_fn(|j, k| 0.5 * (a[j].dot(&u[k]) + a[k].dot(&u[j])));
        // a_1 = l_11 e_1, a_2 = l_21 e_1 + l_22 e_2.
        let l_11 = a[0].norm();
        let l_21 = a[1].dot(&a[0]) / l_11;
        let l_22 = (a[1].norm_squared() - l_21 * l_21).sqrt();
        let back = Matrix2::new(1.0 / l_11, 0.0, -l_21 / (l_11 * l_22), 1.0 / l_22);
        back * covariant * back.transpose()
    }

    /// The principal stresses of a sheet that is strained so.
    fn principal(&self, strain: &Matrix2<f64>) -> [f64; 2] {
        let (e, nu) = (self.youngs_modulus, self.poisson_ratio);
        let mean = e / (1.0 - nu) * (strain.m11 + strain.m22) / 2.0;
        let radius = e / (1.0 + nu) * f64::hypot((strain.m11 - strain.m22) / 2.0, strain.m12);
        [mean + radius, mean - radius]
    }
}

/// The sides of the elements along an edge of `count` nodes, at each of these; the first stands at `first`.
fn sides(count: usize, first: usize, closed: bool) -> Vec<Vec<Side>> {
    let mut sides = vec![Vec::new(); count];
    let last = count - usize::from(!closed);
    // The derivatives of the three shape functions at −1, 0 and 1.
    let slopes = [[-1.5, 2.0, -0.5], [-0.5, 0.0, 0.5], [0.5, -2.0, 1.5]];
    for start in (0..last).step_by(2) {
        let of_side = [0, 1, 2].map(|k| (start + k) % count);
        for (place, slopes) in of_side.into_iter().zip(slopes) {
            let end = !closed && (place == 0 || place == last);
            sides[place].push(Side {
                share: if place % 2 == 1 || end { 1.0 } else { 0.5 },
                nodes: of_side.map(|place| first + place),
                slopes,
            });
        }
    }
    sides
}

/// A height across the body, and the functions and their slopes there.
#[derive(Debug)]
struct Height {
    z: f64,
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// Heights across the body, both ends among them and where its pieces join not.
fn heights(axial: &AxialBasis) -> Vec<Height> {
    let pieces = axial.breaks().windows(2);
    let per_piece = HEIGHTS_PER_DEGREE * (axial.len() - 1) / pieces.len();
    let inner = pieces.flat_map(|ends| {
        let step = (ends[1] - ends[0]) / per_piece as f64;
        (0..per_piece).map(move |i| ends[0] + (i as f64 + 0.5) * step)
    });
    let [low, high] = axial.heights();
    [low]
        .into_iter()
        .chain(inner)
        .chain([high])
        .map(|z| Height {
            z,
            values: axial.values(z),
            slopes: axial.slopes(z),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{HolePattern, Material, SpurGear};
    use crate::grid::{BlankGrid, Grid, GridLevel, ToothGrid};
    use nalgebra::Matrix3;

    /// A section, edges of it, and whether these are closed.
    type Drawn = (Grid, Vec<Vec<u32>>, bool);

    fn tooth() -> Drawn {
        let section = SpurGear::new(paper_gear(30)).expect("can be made");
        let section = section.without_blank();
        let inner = section.root_radius() - 4e-3;
        let drawn = ToothGrid::of_stressed_prism(&section, inner, GridLevel::Coarse);
        let drawn = drawn.expect("a usable grid");
        let edges = vec![drawn.fillet_nodes, drawn.back_fillet_nodes];
        (drawn.grid, edges, false)
    }

    fn holed_sector() -> Drawn {
        let pattern = HolePattern {
            count: 5,
            circle_radius: 16e-3,
            radius: 4e-3,
            phase: 0.0,
        };
        let level = GridLevel::Coarse;
        let drawn = BlankGrid::new(8e-3, 24e-3, Some(&pattern), 30, 4.0, level);
        let drawn = drawn.expect("a usable grid");
        (drawn.grid, drawn.hole_edges, true)
    }

    #[test]
    fn a_uniform_strain_is_found_in_every_surface_however_it_turns() {
        let strain = Matrix3::new(3.0, 0.7, -0.4, 0.7, -1.0, 0.9, -0.4, 0.9, 2.0) * 1e-4;
        let drawn = [
            (tooth(), 0.0),
            (tooth(), 12.0),
            (tooth(), -17.0),
            (holed_sector(), 0.0),
        ];
        for ((grid, edges, closed), twist) in drawn {
            let axial = &AxialBasis::new(&[-5e-3, 5e-3], 10);
            let prism = Prism {
                grid: &grid,
                material: &Material::STEEL,
                twist,
                axial,
            };
            let edges: Vec<&[u32]> = edges.iter().map(Vec::as_slice).collect();
            let surface = Surface::new(&prism, &edges, closed);
            let m = axial.len();
            let mut moved = vec![0.0; surface.nodes.len() * COMPONENTS * m];
            for (i, Node { place, .. }) in surface.nodes.iter().enumerate() {
                for (z, w) in axial.rule(30) {
                    let angle = place.y.atan2(place.x) + twist * z;
                    let at = place.norm() * radial(angle);
                    let u = strain * Vector3::new(at.x, at.y, z);
                    let flat = Vector::new(u.x, u.y);
                    let polar = [flat.dot(&radial(angle)), flat.dot(&tangential(angle)), u.z];
                    for (p, f) in axial.values(z).into_iter().enumerate() {
                        for (c, u) in polar.into_iter().enumerate() {
                            moved[(i * COMPONENTS + c) * m + p] += w * f * u;
                        }
                    }
                }
            }
            let places = surface.heights.len() * surface.nodes.len();
            let stresses = surface.stresses(&moved);
            assert_eq!(stresses.len(), places);
            for (k, found) in stresses.iter().enumerate() {
                let i = k % surface.nodes.len();
                // Directions along the edge and along the axis, where the section has turned to.
                let side = surface.nodes[i].sides[0];
                let of_side = side.nodes.iter().zip(side.slopes);
                let edge: Vector = of_side.map(|(n, s)| s * surface.nodes[*n].place).sum();
                let turn = twist * found.z;
                let (sin, cos) = turn.sin_cos();
                let turned =
                    |v: Vector| Vector3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, 0.0);
                let place = surface.nodes[i].place;
                let spiral = twist * turned(Vector::new(-place.y, place.x)) + Vector3::z();
                let e_1 = turned(edge).normalize();
                let e_2 = (spiral - spiral.dot(&e_1) * e_1).normalize();
                let seen = |a: &Vector3<f64>, b: &Vector3<f64>| a.dot(&(strain * b));
                let (a, b, c) = (seen(&e_1, &e_1), seen(&e_2, &e_2), seen(&e_1, &e_2));
                // Hooke's law of a sheet, direction by direction.
                let along = |one: f64, other: f64| 210e9 / 0.91 * (one + 0.3 * other);
                let (xx, yy, xy) = (along(a, b), along(b, a), 210e9 / 1.3 * c);
                let [one, other] = found.principal;
                // Where two sides meet they do so at an angle.
                let slack = match surface.nodes[i].sides.len() {
                    1 => 1e-7,
                    _ => 0.1,
                };
                let off = (one + other - xx - yy).abs();
                assert!(off < slack * 60e6, "{one} {other} {off} {i}");
                let off = (one * other - xx * yy + xy * xy).abs();
                assert!(off < slack * 60e6_f64.powi(2), "{one} {other} {off} {i}");
                let mises = 0.5 * ((xx - yy).powi(2) + xx * xx + yy * yy) + 3.0 * xy * xy;
                let off = (found.von_mises().powi(2) - mises).abs();
                assert!(off < slack * 60e6_f64.powi(2), "{one} {other} {off} {i}");
            }
        }
    }
}
