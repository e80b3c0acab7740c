//! Order spectra: amplitudes per revolution of the driven gear.

use realfft::RealFftPlanner;

use crate::gear::{GearPair, SpurGear};

/// A speed of rotation, in revolutions per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationSpeed(pub f64);

/// A line of the spectrum that has a name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedOrder {
    /// The order per revolution of the driven gear.
    pub order: f64,
    /// For example `H_Z2`, `H_N`, `H_(Z2+N2)`.
    pub label: String,
    /// The amplitude of δ in meters.
    pub transmission_error: f64,
    /// The amplitude of k in N/m.
    pub mesh_stiffness_tangent: f64,
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

/// Mesh harmonics that get a name.
const NAMED_MESH_HARMONICS: u32 = 10;

/// Mesh harmonics around which sidebands get a name, and sidebands to either side.
const SIDEBANDS: (u32, u32) = (4, 2);

impl Spectrum {
    /// The spectrum of one curve of `pair` over `span` mesh periods, which are whole true periods.
    pub fn of(
        pair: &GearPair,
        span: u32,
        transmission_error: &[f64],
        stiffness: &[f64],
        speed: Option<RotationSpeed>,
    ) -> Self {
        let z_2 = f64::from(pair.driven().tooth_count());
        let (ste, k) = (harmonics(transmission_error), harmonics(stiffness));
        let order: Vec<f64> = (1..=ste.len())
            .map(|bin| bin as f64 * z_2 / f64::from(span))
            .collect();
        let named = named_orders(pair)
            .into_iter()
            .filter_map(|(order, label)| {
                let bin = order * f64::from(span) / z_2;
                let index = (bin.round() as usize)
                    .checked_sub(1)
                    .filter(|&index| index < ste.len())?;
                ((bin - bin.round()).abs() < 1e-9).then(|| NamedOrder {
                    order,
                    label,
                    transmission_error: ste[index].0,
                    mesh_stiffness_tangent: k[index].0,
                })
            })
            .collect();
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

    /// The named line with this label.
    pub fn line(&self, label: &str) -> Option<&NamedOrder> {
        self.named.iter().find(|line| line.label == label)
    }
}

/// Amplitude and phase of the bins 1 … n/2 of `values`: 2|X|/n, and |X|/n at Nyquist.
pub fn harmonics(values: &[f64]) -> Vec<(f64, f64)> {
    let n = values.len();
    if n < 2 {
        return Vec::new();
    }
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    // The mean goes first, so that it does not cost the small lines their digits.
    let mean = values.iter().sum::<f64>() / n as f64;
    let mut input: Vec<f64> = values.iter().map(|value| value - mean).collect();
    let mut output = transform.make_output_vec();
    transform
        .process(&mut input, &mut output)
        .expect("the planner made both buffers for this length");
    let line = |(bin, x): (usize, &realfft::num_complex::Complex<f64>)| {
        let factor = if 2 * bin == n { 1.0 } else { 2.0 };
        (factor * x.norm() / n as f64, x.arg())
    };
    output.iter().enumerate().skip(1).map(line).collect()
}

/// Orders per revolution of the driven gear that have names, each once: the mesh and its multiples, the holes (N), revolutions of gears
/// whose teeth deviate, run out or stand on unequal holes (R1 driving, R2 driven), and the sidebands of both about the mesh.
fn named_orders(pair: &GearPair) -> Vec<(f64, String)> {
    let (z_1, z_2) = (
        f64::from(pair.driving().tooth_count()),
        f64::from(pair.driven().tooth_count()),
    );
    let multiple = |k: u32| if k == 1 { String::new() } else { k.to_string() };
    let mut names: Vec<(f64, String)> = Vec::new();
    let mut add = |order: f64, label: String| {
        if order > 0.0 && names.iter().all(|(known, _)| (known - order).abs() > 1e-9) {
            names.push((order, label));
        }
    };
    for k in 1..=NAMED_MESH_HARMONICS {
        add(f64::from(k) * z_2, format!("H_{}Z2", multiple(k)));
    }
    let scales = [(pair.driving(), z_2 / z_1), (pair.driven(), 1.0)];
    let families = [
        (
            "N",
            scales.map(|(gear, scale)| hole_order(gear).map(|n| f64::from(n) * scale)),
        ),
        (
            "R",
            scales.map(|(gear, scale)| repeats_once(gear).then_some(scale)),
        ),
    ];
    let families: Vec<(f64, String)> = families.into_iter().flat_map(of_both).collect();
    for (n, name) in &families {
        add(*n, format!("H_{name}"));
    }
    for (n, name) in &families {
        for k in 1..=SIDEBANDS.0 {
            for l in 1..=SIDEBANDS.1 {
                for (sign, mark) in [(-1.0, '-'), (1.0, '+')] {
                    let label = format!("H_{}Z2{mark}{}{name}", multiple(k), multiple(l));
                    add(f64::from(k) * z_2 + sign * f64::from(l) * n, label);
                }
            }
        }
    }
    names.sort_by(|a, b| a.0.total_cmp(&b.0));
    names
}

/// The order that the holes of `gear` make in one of its revolutions: how often they repeat, or their number where they do not.
fn hole_order(gear: &SpurGear) -> Option<u32> {
    match gear.hole_repeats() {
        0 => None,
        1 => Some(gear.holes().len() as u32),
        repeats => Some(repeats),
    }
}

/// Whether only a whole revolution of `gear` brings back what its teeth or its holes do.
fn repeats_once(gear: &SpurGear) -> bool {
    let once = gear.hole_repeats() == 1 && gear.holes().len() > 1;
    once || !gear.deviations().is_none()
}

/// The lines of one kind: its name alone where one gear has them, or both at the same order; else with the number of the gear.
fn of_both((name, orders): (&str, [Option<f64>; 2])) -> Vec<(f64, String)> {
    match orders {
        [Some(one), Some(other)] if (one - other).abs() > 1e-9 => {
            vec![(one, format!("{name}1")), (other, format!("{name}2"))]
        }
        // A revolution is told with its gear, unless both are the same.
        [Some(one), None] if name == "R" => vec![(one, format!("{name}1"))],
        [None, Some(other)] if name == "R" => vec![(other, format!("{name}2"))],
        [_, Some(order)] | [Some(order), None] => vec![(order, name.to_owned())],
        [None, None] => Vec::new(),
    }
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
    fn cosines_come_back_with_their_amplitudes_and_phases() {
        let n = 200;
        let wave = |j: usize, bin: f64, phase: f64| {
            (2.0 * PI * bin * j as f64 / f64::from(n) + phase).cos()
        };
        let values: Vec<f64> = (0..n as usize)
            .map(|j| {
                5.0 + 0.5 * wave(j, 1.0, 0.3) + 0.2 * wave(j, 5.0, -2.0) + 0.1 * wave(j, 100.0, 0.0)
            })
            .collect();
        let lines = harmonics(&values);
        assert_eq!(lines.len(), 100);
        for (bin, amplitude, phase) in [(1, 0.5, 0.3), (5, 0.2, -2.0), (100, 0.1, 0.0)] {
            assert!(
                (lines[bin - 1].0 - amplitude).abs() < 1e-14
                    && (lines[bin - 1].1 - phase).abs() < 1e-12
            );
        }
    }

    #[test]
    fn orders_of_case_2_are_multiples_of_its_holes_and_carry_their_names() {
        let values: Vec<f64> = (0..200)
            .map(|j| {
                (2.0 * PI * f64::from(j) / 200.0).cos() * 3.0
                    + (2.0 * PI * f64::from(j) / 40.0).cos()
            })
            .collect();
        let spectrum = Spectrum::of(&case_2(), 5, &values, &values, Some(RotationSpeed(10.0)));
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
