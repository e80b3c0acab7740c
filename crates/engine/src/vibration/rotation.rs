//! Displacement of a gear by its rotation at a steady speed: the static solution of the same bodies, whose load is the mass matrix times the radius.
//!
//! The pull is the same in all sectors, which is class 0 of the ring. A free bore lets the gear turn, which no pull does: with s > 0
//!
//! ```text
//! u ← (K + s M)⁻¹ (f + s M u)
//! ```
//!
//! starts from rest and reaches K u = f, each step by the factor s/(λ + s), λ the lowest value of a mode that is pulled.

use std::f64::consts::TAU;

use faer::{Mat, c64};

use super::heights::{Heights, Parity};
use super::section::Blank;
use super::system::{BoreSupport, Numbering, System};
use super::teeth::{PulledTooth, TeethOrder, ToothCell};
use super::{Body, MOST_ORDERS, ModesError};
use crate::fem::FemError;
use crate::fem::eigen::Pencil;
use crate::fem::prism::COMPONENTS;
use crate::gear::{SolidGear, SpurGear, radial, tangential};
use crate::run::Run;

/// Change of the last step, as a part of the displacement. A step leaves less than a tenth of the error; rounding in thin discs leaves changes of 1e-8.
const SETTLED: f64 = 1e-6;
/// Steps, at most: the lowest mode that is pulled lies far above the shift.
const MOST_STEPS: usize = 200;

/// Displacement of the teeth of a gear by its rotation, for ω² = 1 in 1/s². Lengths are in meters.
#[derive(Debug, Clone)]
pub struct PulledTeeth {
    /// The roll lengths of the nodes of a loaded flank, rising.
    pub roll_lengths: Vec<f64>,
    /// Heights from the middle of the face, rising, and the share of the face that each stands for.
    pub heights: Vec<(f64, f64)>,
    /// How far the loaded flank of each tooth stands out along the base tangent in its transverse section: height by height, node by node.
    pub flanks: Vec<Vec<Vec<f64>>>,
    /// How far the tips move outward in the mean.
    pub tips: f64,
}

impl PulledTeeth {
    /// Pulled teeth of `gear`, whose bore is carried as `bore` says.
    ///
    /// # Errors
    ///
    /// [`ModesError`]. A free bore does not carry the pull of holes that do not repeat around the gear.
    pub fn of(gear: &SolidGear, bore: BoreSupport, run: &Run) -> Result<Self, ModesError> {
        let blank = Blank::new(gear)?;
        let section = gear.section();
        let cell = ToothCell::new(section, blank.parts[0].outer_radius)?;
        let body = Body {
            blank: &blank,
            teeth: Some((gear, &cell)),
            material: section.material(),
        };
        let (heights, faces) = body.heights();
        let system = System::new(&blank.section, &heights, &faces, body.material, bore);
        let on_teeth = cell.system(&heights, section, gear.face_heights());
        let parity = heights.parities()[0];
        let largest = body.largest_order();
        let step = blank.section.sectors.max(1);
        let z = section.tooth_count() as usize;
        let mut teeth = Vec::new();
        for order in (0..=largest).step_by(step) {
            run.check().map_err(FemError::from)?;
            let own = TeethOrder::new(&on_teeth, parity, order as i64)?;
            // The pull has the orders in which the teeth repeat.
            let pulled = order.is_multiple_of(z).then(|| own.pulled(&on_teeth));
            teeth.push((own, pulled.transpose()?));
        }
        let (numbering, moved) = body.pulled((&system, parity), (step, &teeth), run)?;
        let of_gear = OfGear {
            gear,
            cell: &cell,
            on_teeth: &on_teeth,
            heights: &heights,
            phase: blank.phase,
        };
        Ok(of_gear.teeth((&numbering, &moved), (step, &teeth)))
    }
}

/// Seconds of one core for an order of teeth, for the class of sectors with holes that is pulled, and for a gear without symmetry, of half a gear that is its own
/// image in the middle of its face; and how much longer another takes. Measured on gears of 50 teeth.
const SECONDS: [f64; 3] = [0.05, 0.3, 12.5];
const WHOLE_WIDTH: f64 = 6.0;

/// Seconds of one core, and bytes, that [`PulledTeeth::of`] takes for `gear`, about.
pub fn estimate(gear: &SolidGear) -> [f64; 2] {
    let section = gear.section();
    let faces: Vec<[f64; 2]> = gear.layers().iter().map(|part| part.heights).collect();
    let times = match Heights::new(&faces, f64::INFINITY).is_half {
        true => 1.0,
        false => WHOLE_WIDTH,
    };
    let [per_order, per_class, whole] = SECONDS;
    let (orders, class) = match section.hole_pattern() {
        Some(pattern) => (1 + MOST_ORDERS / pattern.count as usize, per_class),
        None if section.has_holes() => (1 + MOST_ORDERS, whole),
        None => (1, per_class),
    };
    let [_, bytes] = super::estimate(gear);
    [times * (per_order * orders as f64 + class), bytes]
}

type Teeth = [(TeethOrder, Option<PulledTooth>)];

impl Body<'_> {
    /// The unknowns of class 0 of `system`, and their displacement under the pull of rotation; `teeth` are those of the orders 0, `step`, 2 `step` ….
    fn pulled(
        &self,
        (system, parity): (&System<'_>, Parity),
        (step, teeth): (usize, &Teeth),
        run: &Run,
    ) -> Result<(Numbering, Mat<c64>), FemError> {
        run.check()?;
        let of_order = |order: i64| teeth.get(order.unsigned_abs() as usize / step);
        let (numbering, entries) = self.assembled(system, (parity, 0), |order| {
            of_order(order).map(|(own, _)| own)
        });
        let mut pull = system.pull(&numbering);
        let size = numbering.amplitude_size();
        for (k, order) in numbering.orders.iter().enumerate() {
            let Some((_, Some(pulled))) = of_order(*order) else {
                continue;
            };
            let share = self.teeth_in_sector();
            for i in 0..size {
                let on_circle = pulled.on_circle[(i, 0)] * share;
                pull[(numbering.first_amplitude + k * size + i, 0)] += match *order < 0 {
                    true => on_circle.conj(),
                    false => on_circle,
                };
            }
        }
        let pencil = Pencil::new(numbering.count, &entries);
        let shift = self.shift();
        let factor = pencil.factor("the gear", shift)?;
        let mut moved = Mat::<c64>::zeros(numbering.count, 1);
        for _ in 0..MOST_STEPS {
            run.check()?;
            let mut next = &pull + pencil.mass_times(&moved) * faer::Scale(c64::new(shift, 0.0));
            factor.solve_in_place(&mut next);
            let change = (&next - &moved).norm_l2();
            moved = next;
            if change <= SETTLED * moved.norm_l2() {
                return Ok((numbering, moved));
            }
        }
        Err(FemError::NotPositiveDefinite {
            part: "a free gear whose holes do not repeat around it",
            unknowns: numbering.count,
        })
    }
}

/// A gear, to be asked how its teeth move.
struct OfGear<'a> {
    gear: &'a SolidGear,
    cell: &'a ToothCell,
    on_teeth: &'a System<'a>,
    heights: &'a Heights,
    phase: f64,
}

impl OfGear<'_> {
    /// The teeth where the unknowns of class 0 have `moved`.
    fn teeth(
        &self,
        (numbering, moved): (&Numbering, &Mat<c64>),
        (step, teeth): (usize, &Teeth),
    ) -> PulledTeeth {
        let section = self.gear.section();
        let size = numbering.amplitude_size();
        // Displacements by each order that is not negative, and with the circle held: those of the opposite orders are conjugate.
        let mut parts: Vec<(i64, Vec<Vec<[c64; COMPONENTS]>>)> = Vec::new();
        for (k, order) in numbering.orders.iter().enumerate() {
            if *order < 0 {
                continue;
            }
            let (own, pulled) = &teeth[*order as usize / step];
            let amplitude = moved.subrows(numbering.first_amplitude + k * size, size);
            let mut all = own.moved(amplitude.to_owned());
            if *order == 0
                && let Some(pulled) = pulled
            {
                for i in 0..pulled.held.nrows() {
                    all[(i, 0)] += pulled.held[(i, 0)];
                }
            }
            parts.push((*order, self.on_flank(&own.numbering, &all)));
        }
        let heights = self.faces();
        let z = section.tooth_count();
        let axes = self.axes(section);
        let last = self.cell.flank.len() - 1;
        let mut tips = 0.0;
        let flanks = (0..z).map(|tooth| {
            let angle = TAU * f64::from(tooth) / f64::from(z) - self.phase;
            let at = |index: usize, node: usize| -> [f64; COMPONENTS] {
                let mut sum = [0.0; COMPONENTS];
                for (order, of) in &parts {
                    let turn = c64::cis(*order as f64 * angle);
                    let share = if *order == 0 { 1.0 } else { 2.0 };
                    for (sum, u) in sum.iter_mut().zip(of[index][node]) {
                        *sum += share * (u * turn).re;
                    }
                }
                sum
            };
            let rows = heights.iter().map(|height| {
                let rows = axes.iter().enumerate().map(|(node, axes)| {
                    let [r, t, along] = at(height.index, node);
                    if node == last {
                        tips += height.share * r / f64::from(z);
                    }
                    axes[0] * r + axes[1] * t + axes[2] * height.side * along
                });
                rows.collect()
            });
            rows.collect()
        });
        PulledTeeth {
            flanks: flanks.collect(),
            roll_lengths: self.cell.flank.iter().map(|(s, _)| *s).collect(),
            heights: heights
                .iter()
                .map(|height| (height.z, height.share))
                .collect(),
            tips,
        }
    }

    /// The displacement of the nodes of the flank where the unknowns of a cell have `moved`: function by function, node by node.
    fn on_flank(&self, numbering: &Numbering, moved: &Mat<c64>) -> Vec<Vec<[c64; COMPONENTS]>> {
        let [first, count] = self.on_teeth.span_of_arc();
        let of_node = |index: usize, node: u32| {
            [0, 1, 2].map(|c| {
                self.on_teeth
                    .displacement(numbering, moved, (node, c, first + index))
            })
        };
        let rows = (0..count).map(|index| {
            let nodes = self.cell.flank.iter();
            nodes.map(|(_, node)| of_node(index, *node)).collect()
        });
        rows.collect()
    }

    /// Parts of a displacement (radial, tangential, axial) at the nodes of the flank that it stands out by in its section: n and −tan β_b.
    fn axes(&self, section: &SpurGear) -> Vec<[f64; COMPONENTS]> {
        let flank = section.flank();
        let along = -self.gear.twist() * flank.base_radius();
        let nodes = self.cell.flank.iter().map(|(s, node)| {
            let place = self.cell.section.grid.nodes[*node as usize];
            let (angle, normal) = (place.y.atan2(place.x), flank.normal(*s));
            [
                normal.dot(&radial(angle)),
                normal.dot(&tangential(angle)),
                along,
            ]
        });
        nodes.collect()
    }

    /// The heights of the face.
    fn faces(&self) -> Vec<Height> {
        let part = self.heights.part(self.gear.face_heights());
        let share = |p: usize| -> f64 { (0..part.count()).map(|q| part.products[(p, q)]).sum() };
        let width: f64 = (0..part.count()).map(share).sum();
        let own = (0..part.count()).map(|index| Height {
            index,
            z: self.heights.nodes[part.first + index],
            share: share(index) / width,
            side: 1.0,
        });
        let own: Vec<Height> = own.collect();
        if !self.heights.is_half {
            return own;
        }
        // The other half is the image of this one.
        let halved = |height: &Height, side: f64| Height {
            z: side * height.z,
            share: height.share / 2.0,
            side,
            ..*height
        };
        let middle = own[0];
        let below = own[1..].iter().rev().map(|height| halved(height, -1.0));
        let above = own[1..].iter().map(|height| halved(height, 1.0));
        below.chain([middle]).chain(above).collect()
    }
}

/// A height of the face.
#[derive(Debug, Clone, Copy)]
struct Height {
    /// Its function.
    index: usize,
    z: f64,
    /// The share of the face.
    share: f64,
    /// −1 on the image of the half that was solved.
    side: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::{Layer, Material};

    /// The radial displacement of a thin annulus from 20 to 50 mm at both of its circles.
    fn annulus(bore: BoreSupport, material: &Material) -> [f64; 2] {
        let part = Layer {
            inner_radius: 20e-3,
            outer_radius: 50e-3,
            heights: [-0.1e-3, 0.1e-3],
        };
        let blank = Blank::of_parts(vec![part], 24);
        let body = Body {
            blank: &blank,
            teeth: None,
            material,
        };
        let (heights, faces) = body.heights();
        let system = System::new(&blank.section, &heights, &faces, body.material, bore);
        let parity = heights.parities()[0];
        let (numbering, moved) = body
            .pulled((&system, parity), (24, &[]), &Run::unattended())
            .expect("sound");
        [blank.section.bore[0], blank.section.arc[0]]
            .map(|node| system.in_middle(&numbering, &moved, node)[0].re)
    }

    #[test]
    fn a_rotating_annulus_moves_as_its_closed_form_does() {
        // u = (1 − ν²)/E (A r + B/r − ρ r³/8), σ_r = E/(1 − ν²)(u' + ν u/r): no stress at a free edge, no displacement at a held one.
        let (a, b) = (20e-3_f64, 50e-3_f64);
        // A held bore does not become thinner either, and that reaches over the elements beside it, however thin the annulus is; without Poisson's ratio
        // there is nothing to hold.
        for (poisson_ratio, of_held) in [(Material::STEEL.poisson_ratio, 5e-3), (0.0, 1e-4)] {
            let material = Material {
                poisson_ratio,
                ..Material::STEEL
            };
            let Material {
                youngs_modulus: e,
                poisson_ratio: nu,
                density,
                ..
            } = material;
            let free = |r: f64| {
                let (one, more) = (1.0 - nu, (1.0 + nu) * a * a * b * b / (r * r));
                density / (8.0 * e) * (3.0 + nu) * r * (one * (a * a + b * b) + more)
                    - density / (8.0 * e) * (1.0 - nu * nu) * r.powi(3)
            };
            let moved = annulus(BoreSupport::Free, &material);
            for (found, radius) in moved.into_iter().zip([a, b]) {
                let expected = free(radius);
                assert!(
                    (found / expected - 1.0).abs() < 1e-4,
                    "{found:e} {expected:e}"
                );
            }
            // Held at a: (1 + ν) A − (1 − ν) B/b² = ρ (3 + ν) b²/8 and A a + B/a = ρ a³/8.
            let (p, q) = (
                density * (3.0 + nu) * b * b / 8.0,
                density * a.powi(4) / 8.0,
            );
            let c_b =
                ((1.0 + nu) * q / (a * a) - p) / ((1.0 + nu) / (a * a) + (1.0 - nu) / (b * b));
            let c_a = (q - c_b) / (a * a);
            let expected = (1.0 - nu * nu) / e * (c_a * b + c_b / b - density * b.powi(3) / 8.0);
            let [at_bore, at_rim] = annulus(BoreSupport::Held, &material);
            assert!(
                at_bore == 0.0 && (at_rim / expected - 1.0).abs() < of_held,
                "{at_rim:e} {expected:e}"
            );
        }
    }
}
