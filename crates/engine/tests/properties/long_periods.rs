//! Peak-to-peak of δ from few positions over long periods, compared with many positions.

use meshwright_engine::analysis::{Case, Curve};
use meshwright_engine::gear::{GearData, GearPair, HolePattern, SpurGear};
use meshwright_engine::library::Library;

use super::cases;
use super::drawn::DrawnPair;
use super::truths::{case, solve};

/// Mesh periods of a long true period, and of one that is still solved at many positions in seconds.
const LONG: std::ops::RangeInclusive<u32> = 12..=60;

/// Positions a mesh period of the right values. From 40 on they are within 0.5 % (`between`).
const MANY: u32 = 80;

/// The true period of `pair` at so many positions a mesh period.
fn curve(pair: &GearPair, torque: f64, positions: u32) -> Curve {
    let mut case: Case = case(pair, &[torque]);
    case.resolution.positions_per_mesh_period = positions;
    case.resolution.span_mesh_periods = None;
    solve(&case, &Library::default())
        .expect("a curve")
        .curves
        .remove(0)
}

/// A pair of the paper's module and rack whose driven gear has these holes.
fn holed(teeth: [u32; 2], shift: f64, center_distance: f64, holes: HolePattern) -> GearPair {
    let gear = |data: GearData| SpurGear::new(data).expect("can be made");
    let mut driving = cases::gear(teeth[0], 0.25e-3 * f64::from(teeth[0]));
    driving.profile_shift = shift;
    let mut driven = cases::gear(teeth[1], 0.25e-3 * f64::from(teeth[1]));
    driven.blank.holes = holes.holes();
    GearPair::new(gear(driving), gear(driven), center_distance).expect("they mesh")
}

/// 9/38 teeth, undercut, six holes: 19 periods.
fn undercut() -> (GearPair, f64) {
    let holes = HolePattern {
        count: 6,
        circle_radius: 22e-3,
        radius: 6e-3,
        phase: 5_f64.to_radians(),
    };
    (holed([9, 38], 0.1, 47.2e-3, holes), 60.0)
}

/// 23/47 teeth, five holes: 47 periods.
fn five_holes() -> (GearPair, f64) {
    let holes = HolePattern {
        count: 5,
        circle_radius: 27e-3,
        radius: 8e-3,
        phase: 3_f64.to_radians(),
    };
    (holed([23, 47], 0.0, 70.2e-3, holes), 120.0)
}

/// 30/48 teeth with small holes, whose order is 1 nm: 7 of them, 48 periods; and 6, 8 periods.
fn small_holes() -> [(GearPair, f64); 2] {
    let pair = |count, circle_radius, radius| {
        let holes = HolePattern {
            count,
            circle_radius,
            radius,
            phase: 0.0,
        };
        (holed([30, 48], 0.0, 78.2e-3, holes), 5.0)
    };
    [pair(7, 27.47e-3, 2.38e-3), pair(6, 28.39e-3, 2.11e-3)]
}

#[test]
fn small_orders_of_holes_are_those_of_many_positions() {
    for (pair, torque) in small_holes() {
        let holes = f64::from(pair.driven().hole_repeats());
        let lines = |positions| {
            let spectrum = curve(&pair, torque, positions).spectrum.expect("it closes");
            [1.0, 2.0, 3.0].map(|multiple| {
                let is_it = |order: &f64| (order - multiple * holes).abs() < 1e-9;
                let place = spectrum.order.iter().position(is_it).expect("a line");
                spectrum.transmission_error[place]
            })
        };
        let right = lines(MANY);
        for positions in [10, 12, 20] {
            for (found, right) in lines(positions).into_iter().zip(right) {
                assert!(
                    (found - right).abs() <= (0.03 * right).max(5e-11),
                    "{holes} holes, {positions} positions: {found:e} for {right:e}"
                );
            }
        }
    }
}

/// The peak-to-peak of δ.
fn peak_to_peak(curve: &Curve) -> f64 {
    curve.transmission_error_statistics.peak_to_peak
}

#[test]
fn an_undercut_pinion_has_its_peak_to_peak_from_twelve_positions_over_nineteen_periods() {
    // 240 positions a mesh period and those between them: 3.171 um. Cubics alone made 3.944 of twelve positions.
    let (pair, torque) = undercut();
    let found = peak_to_peak(&curve(&pair, torque, 12));
    assert!((found / 3.171e-6 - 1.0).abs() < 0.02, "{found:e}");
}

#[test]
#[ignore = "./test all"]
fn long_periods_have_their_peak_to_peak_from_ten_positions() {
    let named = [
        ("9/38".to_owned(), undercut()),
        ("23/47".to_owned(), five_holes()),
    ];
    let drawn = (0..).flat_map(|seed: u64| {
        let pair = |drawn: DrawnPair| (drawn.pair, drawn.output_torque);
        [
            (format!("seed {seed}"), pair(DrawnPair::of(seed))),
            (
                format!("seed {seed} as made"),
                pair(DrawnPair::as_made(seed)),
            ),
        ]
    });
    let drawn = drawn.filter(|(_, (pair, _))| LONG.contains(&pair.period()));
    let (mut wrong, mut unsaid) = (Vec::new(), Vec::new());
    for (name, (pair, torque)) in named.into_iter().chain(drawn.take(18)) {
        let right = peak_to_peak(&curve(&pair, torque, MANY));
        for positions in [10, 12, 20] {
            let curve = curve(&pair, torque, positions);
            let off = peak_to_peak(&curve) - right;
            // A nanometer is nobody's concern.
            let part = (off.abs() - 1e-9).max(0.0) / right;
            let told = curve.sampling_error.peak_to_peak / right;
            println!(
                "{name}, {} periods, {positions} positions: {:+.2} % of {:.3} um, estimate {:.2} %",
                pair.period(),
                100.0 * off / right,
                1e6 * right,
                100.0 * told
            );
            if part > 0.02 {
                let said = format!("{name} at {positions}: {part}, estimate {told}");
                if told <= 0.02 {
                    assert!(off.abs() < 15e-9 || part < 1.2 * told, "{said}");
                    unsaid.push(said.clone());
                }
                wrong.push(said);
            }
        }
    }
    // Where they are off by more, their own estimate says so, and `few_positions` with it. Two curves are not told: one 11 nm off, one by 2.3 % with an
    // estimate of 1.96 %.
    assert!(unsaid.len() <= 2, "{unsaid:#?} of {wrong:#?}");
    assert!(wrong.len() <= 6, "{wrong:#?}");
}
