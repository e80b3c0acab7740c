//! Order spectra: amplitudes per revolution of the driven gear.

use super::between::Sections;
use super::case::Case;
use super::orders::{KnownOrder, OrderKind, Orders};
use super::running::RotationSpeed;
use crate::fourier::harmonics;
use crate::gear::GearPair;

/// A line of the spectrum that has a name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedOrder {
    /// The order per revolution of the driven gear.
    pub order: f64,
    /// For example `H_Z2`, `H_N`, `H_Z2+N2`, `H_1`, `H_Z2-1(1)`.
    pub label: String,
    /// Kind.
    pub kind: OrderKind,
    /// The amplitude of δ in meters.
    pub transmission_error: f64,
    /// The amplitude of k in N/m.
    pub mesh_stiffness_tangent: f64,
    /// Of an order of holes, where teeth deviate: the amplitude of δ in meters that the pair has as it is drawn.
    pub of_holes: Option<f64>,
}

/// Single-sided amplitudes and phases: y = Σ A cos(2π k j/n + phase), no window; the mean is left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Orders k Z2/P per revolution of the driven gear, k = 1 … n/2.
    pub order: Vec<f64>,
    /// Amplitudes of δ in meters.
    pub transmission_error: Vec<f64>,
    /// Phases of δ in radians.
    pub transmission_error_phase: Vec<f64>,
    /// Amplitudes of k in N/m.
    pub mesh_stiffness_tangent: Vec<f64>,
    /// Phases of k in radians.
    pub mesh_stiffness_tangent_phase: Vec<f64>,
    /// Lines with names, by rising order.
    pub named: Vec<NamedOrder>,
    /// The frequency of each order in Hz, with a speed given.
    pub frequency: Option<Vec<f64>>,
}

/// Places in a mesh period, at least, at which a curve is read for its spectrum: with kinks and jumps in it, lines fall so slowly that those
/// beyond the last one given would add a percent to it.
const RESAMPLED: usize = 400;

/// Lines that get a name because they stand out, and the least part of the largest line that does.
const STANDING_OUT: (usize, f64) = (10, 0.01);

impl Spectrum {
    /// δ and k of the curve of `sections` over the span of `case`, at equal steps that are near enough for its spectrum.
    pub(super) fn resampled(case: &Case, sections: &Sections) -> [Vec<f64>; 2] {
        let (positions, periods) = (case.positions(), case.span() as usize);
        let finer = (RESAMPLED * periods).div_ceil(positions);
        sections.resampled(finer * positions)
    }

    /// The spectrum of a curve that was [resampled](Self::resampled) over the span of `case`, which is whole true periods: as many orders as its
    /// positions show.
    pub(super) fn of(case: &Case, resampled: [Vec<f64>; 2]) -> Self {
        let lines = resampled.map(|values| {
            let mut lines = harmonics(&values);
            lines.truncate(case.positions() / 2);
            lines
        });
        Self::of_lines(&case.pair, case.span(), lines, case.driving_speed)
    }

    /// The spectrum of equal samples of one curve of `pair` over `span` mesh periods, which are whole true periods.
    pub fn of_samples(
        pair: &GearPair,
        span: u32,
        transmission_error: &[f64],
        stiffness: &[f64],
        speed: Option<RotationSpeed>,
    ) -> Self {
        let lines = [transmission_error, stiffness].map(harmonics);
        Self::of_lines(pair, span, lines, speed)
    }

    /// The spectrum of the lines 1, 2, … of δ and k over `span` mesh periods.
    fn of_lines(
        pair: &GearPair,
        span: u32,
        [ste, k]: [Vec<(f64, f64)>; 2],
        speed: Option<RotationSpeed>,
    ) -> Self {
        let z_2 = f64::from(pair.driven().tooth_count());
        let order: Vec<f64> = (1..=ste.len())
            .map(|bin| bin as f64 * z_2 / f64::from(span))
            .collect();
        let named = named(&Orders::of(pair), &order, &ste, &k);
        let f_2 = speed.map(|speed| speed.0 * f64::from(pair.driving().tooth_count()) / z_2);
        Self {
            frequency: f_2.map(|f_2| order.iter().map(|order| order * f_2).collect()),
            order,
            transmission_error: ste.iter().map(|line| line.0).collect(),
            transmission_error_phase: ste.iter().map(|line| line.1).collect(),
            mesh_stiffness_tangent: k.iter().map(|line| line.0).collect(),
            mesh_stiffness_tangent_phase: k.iter().map(|line| line.1).collect(),
            named,
        }
    }

    /// Takes the orders of holes from the spectrum of the pair as it is drawn.
    pub(super) fn tell_holes_alone(&mut self, drawn: &Self) {
        let of_holes = |line: &&mut NamedOrder| matches!(&line.kind, OrderKind::Cause { cause, .. } if cause.holes);
        for line in self.named.iter_mut().filter(of_holes) {
            line.of_holes = drawn.line(&line.label).map(|own| own.transmission_error);
        }
    }

    /// The places of the orders of the holes among the lines.
    fn hole_orders(&self) -> impl Iterator<Item = usize> {
        let of_holes = |line: &&NamedOrder| matches!(&line.kind, OrderKind::Cause { cause, multiple: 1 } if cause.holes);
        let orders = self.named.iter().filter(of_holes).map(|line| line.order);
        orders.filter_map(|order| self.order.iter().position(|each| *each == order))
    }

    /// The largest amplitude, over the orders of holes, of δ of this curve less that of `other`; `None` without holes.
    pub(super) fn apart_at_hole_orders(&self, other: &Self) -> Option<f64> {
        let apart = self.hole_orders().map(|i| {
            let [a, b] = [self, other].map(|spectrum| {
                let (sin, cos) = spectrum.transmission_error_phase[i].sin_cos();
                let amplitude = spectrum.transmission_error[i];
                [amplitude * cos, amplitude * sin]
            });
            (a[0] - b[0]).hypot(a[1] - b[1])
        });
        apart.reduce(f64::max)
    }

    /// The named line with this label.
    pub fn line(&self, label: &str) -> Option<&NamedOrder> {
        self.named.iter().find(|line| line.label == label)
    }
}

/// The lines that have names, by rising order: those that have one whatever their amplitude, and those that stand out of the others.
fn named(
    orders: &Orders,
    places: &[f64],
    ste: &[(f64, f64)],
    stiffness: &[(f64, f64)],
) -> Vec<NamedOrder> {
    let Some(first) = places.first() else {
        return Vec::new();
    };
    let known = orders.known().into_iter().filter_map(|known| {
        let bin = known.order / first;
        let index = (bin.round() as usize).checked_sub(1)?;
        let is_a_line = index < places.len() && (bin - bin.round()).abs() < 1e-9;
        is_a_line.then_some((index, known))
    });
    let mut lines: Vec<(usize, KnownOrder)> = known.collect();
    let others = standing_out(ste, |index| lines.iter().all(|(known, _)| *known != index));
    let others: Vec<_> = others
        .into_iter()
        .filter_map(|index| Some((index, orders.describe(places[index])?)))
        .collect();
    lines.extend(others);
    lines.sort_by_key(|(index, _)| *index);
    let line = |(index, known): (usize, KnownOrder)| NamedOrder {
        order: known.order,
        label: known.label,
        kind: known.kind,
        transmission_error: ste[index].0,
        mesh_stiffness_tangent: stiffness[index].0,
        of_holes: None,
    };
    lines.into_iter().map(line).collect()
}

/// The largest lines among the `others`, as far as they are a part of the largest of all.
fn standing_out(lines: &[(f64, f64)], others: impl Fn(usize) -> bool) -> Vec<usize> {
    let largest = lines
        .iter()
        .fold(0.0_f64, |largest, line| largest.max(line.0));
    let (most, part) = STANDING_OUT;
    let mut found: Vec<usize> = (0..lines.len())
        .filter(|&index| lines[index].0 > part * largest && others(index))
        .collect();
    found.sort_by(|&a, &b| lines[b].0.total_cmp(&lines[a].0));
    found.truncate(most);
    found
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{HolePattern, SpurGear};

    fn case_2() -> GearPair {
        let solid = SpurGear::new(paper_gear(50)).expect("a gear");
        let mut data = paper_gear(50);
        data.blank.holes = HolePattern {
            count: 10,
            circle_radius: 34e-3,
            radius: 7.5e-3,
            phase: 0.0,
        }
        .holes();
        GearPair::new(solid, SpurGear::new(data).expect("a gear"), 100.5e-3).expect("meshes")
    }

    #[test]
    fn a_line_that_stands_out_is_named_by_what_it_is() {
        let wave = |j: u32, bin: f64| (2.0 * PI * bin * f64::from(j) / 200.0).cos();
        let values: Vec<f64> = (0..200)
            .map(|j| wave(j, 5.0) + 0.5 * wave(j, 2.0) + 0.005 * wave(j, 3.0))
            .collect();
        let spectrum = Spectrum::of_samples(&case_2(), 5, &values, &values, None);
        let twice = spectrum.line("H_2N").expect("it stands out");
        assert!((twice.transmission_error - 0.5).abs() < 1e-13 && twice.order == 20.0);
        // Half a percent of the largest line is the third multiple, and a sideband that is named anyway.
        assert!(spectrum.line("H_3N").is_none());
        assert!(spectrum.named.is_sorted_by(|a, b| a.order < b.order));
    }

    #[test]
    fn orders_of_case_2_are_multiples_of_its_holes_and_carry_their_names() {
        let values: Vec<f64> = (0..200)
            .map(|j| {
                (2.0 * PI * f64::from(j) / 200.0).cos() * 3.0
                    + (2.0 * PI * f64::from(j) / 40.0).cos()
            })
            .collect();
        let spectrum =
            Spectrum::of_samples(&case_2(), 5, &values, &values, Some(RotationSpeed(10.0)));
        assert_eq!(spectrum.order[..2], [10.0, 20.0]);
        assert!((spectrum.line("H_N").expect("named").transmission_error - 3.0).abs() < 1e-13);
        assert!((spectrum.line("H_Z2").expect("named").transmission_error - 1.0).abs() < 1e-13);
        assert_eq!(spectrum.line("H_Z2-N").expect("named").order, 40.0);
        assert_eq!(spectrum.line("H_2Z2+2N").expect("named").order, 120.0);
        assert_eq!(
            spectrum.frequency.expect("a speed was given")[4],
            500.0,
            "the mesh frequency is Z1 times the speed"
        );
    }
}
