//! Pairs made to one drawing: each is the pair that it is alone, and δ follows what its teeth deviate by as its derivatives say.

mod cases;

use cases::{Made, case, gear, holed, pair, relieved};
use meshwright_engine::analysis::{analyze, pair_model};
use meshwright_engine::contact::positions::{contacts, contacts_keeping, contacts_of_many};
use meshwright_engine::contact::{PairInfluence, WarmStart, solve_active_set};
use meshwright_engine::gear::{
    DeviationsError, Eccentricity, GearPair, GearPairError, Member, Normals, PairDeviations,
    SpurGear, Tolerances, ToothDeviations,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

const TORQUE: f64 = 60.0;

/// 23 teeth on 31 with four holes.
fn drawn() -> GearPair {
    let driven = holed(relieved(gear(31, 10e-3)), 4, 20e-3, 4e-3, 0.3);
    pair(relieved(gear(23, 8e-3)), driven, 54.4e-3)
}

/// Teeth of both gears of the member `seed` of a production of this class.
fn teeth(pair: &GearPair, class: u32, seed: u64) -> [ToothDeviations; 2] {
    Member::BOTH.map(|member| {
        let gear = pair.gear(member);
        let mut normals = Normals::new(seed, member.index() as u64);
        Tolerances::of(gear, class).draw(gear.tooth_count(), 1.33, &mut normals)
    })
}

/// `pair` whose gears have these teeth.
fn with_teeth(pair: &GearPair, teeth: &[ToothDeviations; 2]) -> GearPair {
    let [driving, driven] = Member::BOTH.map(|member| {
        let mut data = pair.gear(member).data().clone();
        data.deviations = teeth[member.index()].clone();
        SpurGear::new(data).expect("a gear that can be made")
    });
    GearPair::new(driving, driven, pair.center_distance()).expect("a pair that meshes")
}

fn model(pair: &GearPair) -> meshwright_engine::contact::PairModel {
    let mut case = case(pair.clone(), &[TORQUE]);
    case.resolution.grid = GridLevel::Coarse;
    pair_model(&case, &Library::default(), &Run::unattended()).expect("a model")
}

#[test]
fn a_pair_among_others_is_the_pair_that_it_is_alone() {
    let pair = drawn();
    let run = Run::unattended();
    let teeth: Vec<_> = (0..20).map(|seed| teeth(&pair, 7, seed)).collect();
    let members: Vec<PairDeviations> = teeth
        .iter()
        .map(|teeth| PairDeviations::new(&pair, teeth.each_ref()).expect("room for them"))
        .collect();
    // Positions of which no two mesh periods have the same, and not in their order.
    let positions: Vec<f64> = (0..84).map(|i| f64::from(i * 37 % 84) / 7.0).collect();
    let known = model(&pair);
    for torque in [TORQUE, 5.0] {
        let load = pair.load(torque);
        let together = contacts_of_many(&known, &members, load, &positions, &run, Clone::clone);
        for (i, found) in together.expect("not stopped").into_iter().enumerate() {
            let found = found.expect("contacts");
            // By a model that has seen no other.
            if i % 7 == 0 {
                let fresh = model(&pair);
                let alone = contacts(fresh.deviating(&members[i]), load, &positions, &run);
                assert_eq!(alone.expect("contacts"), found, "{i}, {torque} N m");
            }
            // And as a pair of gears that are drawn with these teeth.
            if i % 10 == 0 && torque == TORQUE {
                let mut case = case(with_teeth(&pair, &teeth[i]), &[TORQUE]);
                case.resolution.grid = GridLevel::Coarse;
                case.resolution.positions_per_mesh_period = 7;
                case.resolution.span_mesh_periods = Some(12);
                case.resolution.contact_solver = known.solver;
                let analysis = analyze(&case, &Library::default(), &run).expect("a solution");
                let curve = &analysis.curves[0].transmission_error;
                for (eta, contact) in positions.iter().zip(&found) {
                    let place = (eta * 7.0).round() as usize;
                    let (one, other) = (curve[place], contact.transmission_error);
                    assert!((one / other - 1.0).abs() < 1e-9, "{eta}: {one} {other}");
                }
            }
        }
    }
}

#[test]
fn the_period_of_a_pair_is_that_of_the_teeth_it_has() {
    let pair = drawn();
    assert_eq!(pair.period(), 31, "four holes under 31 teeth");
    let teeth = teeth(&pair, 7, 1);
    let none = ToothDeviations::default();
    let period = |teeth: [&ToothDeviations; 2]| {
        pair.period_with(&PairDeviations::new(&pair, teeth).expect("room for them"))
    };
    assert_eq!(period([&none, &none]), 31);
    assert_eq!(period([&none, &teeth[1]]), 31);
    assert_eq!(period([&teeth[0], &none]), 23 * 31);
    assert_eq!(with_teeth(&pair, &teeth).period(), 23 * 31);
}

#[test]
fn teeth_that_do_not_fit_are_refused() {
    let pair = drawn();
    let (mut few, none) = (ToothDeviations::default(), ToothDeviations::default());
    few.cumulative_pitch = vec![1e-6; 22];
    let refused = PairDeviations::new(&pair, [&few, &none]);
    assert!(matches!(
        refused,
        Err(DeviationsError::Gear {
            member: Member::Driving,
            ..
        })
    ));
    let far = ToothDeviations {
        eccentricity: Some(Eccentricity {
            amount: 1e-3,
            direction: 0.0,
        }),
        ..ToothDeviations::default()
    };
    let refused = PairDeviations::new(&pair, [&none, &far]);
    assert!(matches!(
        refused,
        Err(DeviationsError::Pair(
            GearPairError::NegativeBacklash { .. }
        ))
    ));
}

#[test]
fn the_load_derivative_is_the_derivative_of_delta_by_every_gap() {
    let pair = drawn();
    let model = model(&pair);
    let deviations = PairDeviations::new(&pair, teeth(&pair, 7, 3).each_ref()).expect("room");
    let load = pair.load(TORQUE);
    for eta in [0.1, 3.45, 7.8] {
        let made = model.deviating(&deviations);
        let cells = made.cells(eta, load, &mut WarmStart::default());
        let cells = cells.expect("contact");
        let (problem, solution) = (&cells.problem, &cells.solution);
        let touching: Vec<usize> = (0..problem.point_count())
            .filter(|point| solution.active[*point])
            .collect();
        let step = 1e-11;
        for point in touching.iter().copied().step_by(5) {
            let at = |change: f64| {
                let mut gaps = problem.gaps().to_vec();
                gaps[point] += change;
                let changed = problem.with_gaps(gaps, problem.arms().to_vec());
                let solution = solve_active_set(&changed.expect("sound"), load, None);
                solution.expect("a solution").transmission_error
            };
            let difference = (at(step) - at(-step)) / (2.0 * step);
            let derivative = solution.load_derivative[point];
            assert!(
                (difference - derivative).abs() < 1e-5 * derivative.abs(),
                "{eta}, {point}: {difference} {derivative}"
            );
        }
    }
}

#[test]
fn delta_follows_pitch_and_slope_of_every_tooth_as_its_influences_say() {
    let pair = drawn();
    let model = model(&pair);
    let load = pair.load(TORQUE);
    let mut teeth = teeth(&pair, 6, 5);
    teeth[0].eccentricity = None;
    let deviations = |teeth: &[ToothDeviations; 2]| {
        PairDeviations::new(&pair, teeth.each_ref()).expect("room for them")
    };
    let run = Run::unattended();
    let positions = [0.13, 4.4, 6.71, 9.95];
    let influences = |teeth: &[ToothDeviations; 2]| -> Vec<Vec<PairInfluence>> {
        let deviations = deviations(teeth);
        let made = model.deviating(&deviations);
        let kept = contacts_keeping(made, load, &positions, &run, |cells, solution| {
            cells.influences(solution)
        });
        let kept = kept.expect("contacts").into_iter();
        kept.map(|(_, influences)| influences).collect()
    };
    let influences = influences(&teeth);
    let mut largest = 0.0_f64;
    for (eta, influences) in positions.iter().zip(&influences) {
        let carrying = influences.iter().filter(|each| each.by_pitch[1] != 0.0);
        let sum: f64 = carrying.clone().map(|each| each.by_pitch[1]).sum();
        // All driven teeth turned at once are the gear turned.
        let turned = -20_f64.to_radians().cos();
        assert!((sum / turned - 1.0).abs() < 1e-3, "{eta}: {sum}");
        for influence in carrying {
            for member in Member::BOTH {
                let (g, tooth) = (member.index(), influence.teeth[member.index()]);
                let difference = |list: fn(&mut ToothDeviations) -> &mut Vec<f64>| {
                    let step = 1e-9;
                    let [less, more] = [-step, step].map(|change| {
                        let mut teeth = teeth.clone();
                        list(&mut teeth[g])[tooth] += change;
                        let made = Made::of(&model, &pair, deviations(&teeth));
                        let contact = made.contact(*eta, load).expect("contact");
                        contact.transmission_error
                    });
                    (more - less) / (2.0 * step)
                };
                for (said, found) in [
                    (
                        influence.by_pitch[g],
                        difference(|teeth| &mut teeth.cumulative_pitch),
                    ),
                    (
                        influence.by_profile_slope[g],
                        difference(|teeth| &mut teeth.profile_slope),
                    ),
                ] {
                    println!("{eta}, {member} {tooth}: {said:.8} {found:.8}");
                    largest = largest.max((said - found).abs());
                }
            }
        }
    }
    // Where the tooth is the first to touch, gaps are taken at another angle; elsewhere eight digits agree.
    assert!(largest < 1e-3, "{largest:e}");
}

#[test]
fn gradients_tell_what_each_gear_makes_of_the_spread_as_a_sample_does() {
    const MEMBERS: u64 = 400;
    // So little that the same cells touch, nearly.
    const SPREADS: [f64; 2] = [0.02e-6, 0.03e-6];
    let pair = drawn();
    let model = model(&pair);
    let load = pair.load(TORQUE);
    let run = Run::unattended();
    let positions = [0.13, 4.4, 6.71, 9.95];
    let draw = |member: Member, seed: u64| {
        let normals = Normals::new(seed, member.index() as u64);
        let count = pair.gear(member).tooth_count() as usize;
        let pitch = normals.map(|normal| SPREADS[member.index()] * normal);
        ToothDeviations {
            cumulative_pitch: pitch.take(count).collect(),
            ..ToothDeviations::default()
        }
    };
    let curves = |members: &[[ToothDeviations; 2]]| -> Vec<Vec<f64>> {
        let of = |teeth: &[ToothDeviations; 2]| PairDeviations::new(&pair, teeth.each_ref());
        let members: Result<Vec<PairDeviations>, _> = members.iter().map(of).collect();
        let members = members.expect("room for them");
        let found = contacts_of_many(&model, &members, load, &positions, &run, |contact| {
            contact.transmission_error
        });
        let found = found.expect("not stopped").into_iter();
        found.map(|curve| curve.expect("contacts")).collect()
    };
    let none = ToothDeviations::default();
    let none = PairDeviations::new(&pair, [&none, &none]).expect("room");
    let made = model.deviating(&none);
    let influences = contacts_keeping(made, load, &positions, &run, |cells, solution| {
        cells.influences(solution)
    });
    let influences = influences.expect("contacts");

    let seeds = 0..MEMBERS;
    let first: Vec<[ToothDeviations; 2]> = seeds
        .clone()
        .map(|seed| Member::BOTH.map(|member| draw(member, seed)))
        .collect();
    // The same driving gears beside others.
    let second: Vec<[ToothDeviations; 2]> = seeds
        .map(|seed| {
            [
                draw(Member::Driving, seed),
                draw(Member::Driven, MEMBERS + seed),
            ]
        })
        .collect();
    let (one, other) = (curves(&first), curves(&second));
    for (place, (contact, influences)) in influences.iter().enumerate() {
        let told = |teeth: &[ToothDeviations; 2]| -> f64 {
            let each = influences.iter().flat_map(|of| {
                Member::BOTH.map(|member| {
                    let g = member.index();
                    of.by_pitch[g] * teeth[g].cumulative_pitch[of.teeth[g]]
                })
            });
            contact.transmission_error + each.sum::<f64>()
        };
        let by_gear = Member::BOTH.map(|member| {
            let g = member.index();
            let each = influences.iter().map(|of| of.by_pitch[g] * SPREADS[g]);
            each.map(|part| part * part).sum::<f64>()
        });
        let (variance, share) = (
            by_gear[0] + by_gear[1],
            by_gear[0] / (by_gear[0] + by_gear[1]),
        );
        let spread = variance.sqrt();
        for (teeth, curve) in first.iter().zip(&one) {
            let off = (curve[place] - told(teeth)).abs();
            // What cells that begin to touch add.
            assert!(off < 0.05 * spread, "{off:e} of {spread:e}");
        }
        let column = |curves: &[Vec<f64>]| -> Vec<f64> {
            let mean = curves.iter().map(|curve| curve[place]).sum::<f64>() / MEMBERS as f64;
            curves.iter().map(|curve| curve[place] - mean).collect()
        };
        let (one, other) = (column(&one), column(&other));
        let product = |a: &[f64], b: &[f64]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / MEMBERS as f64
        };
        let sampled = product(&one, &other) / product(&one, &one);
        println!("{share:.3} of the variance by gradients, {sampled:.3} by a sample");
        // Three standard errors of a correlation of so many.
        assert!((sampled - share).abs() < 3.0 / (MEMBERS as f64).sqrt());
        assert!((product(&one, &one) / variance - 1.0).abs() < 3.0 * (2.0 / MEMBERS as f64).sqrt());
    }
}
