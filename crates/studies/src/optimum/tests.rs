//! Searches of functions whose optimum is known.
use crate::optimum::driver::{Driver, Problem};
use crate::optimum::outcome::{Outcome, best, front};
use crate::optimum::space::Axis;

type Function = fn(&[f64]) -> Outcome;

fn computed(goals: Vec<f64>, conditions: &[f64]) -> Outcome {
    let violations = conditions.iter().map(|g| g.max(0.0)).collect();
    Outcome::Computed { goals, violations }
}

/// Every design that a search asks for, and its outcome.
fn searched(problem: &Problem, function: Function) -> Vec<(Vec<f64>, Outcome)> {
    let mut driver = Driver::new(problem.clone());
    let mut all = Vec::new();
    loop {
        let designs = driver.ask();
        if designs.is_empty() {
            return all;
        }
        let outcomes: Vec<Outcome> = designs.iter().map(|design| function(design)).collect();
        driver.tell(&outcomes);
        all.extend(designs.into_iter().zip(outcomes));
    }
}

fn found(problem: &Problem, function: Function) -> (Vec<f64>, Outcome) {
    let all = searched(problem, function);
    let outcomes: Vec<Outcome> = all.iter().map(|(_, outcome)| outcome.clone()).collect();
    all[best(&outcomes).expect("a design")].clone()
}

fn problem(axes: usize, conditions: usize, evaluations: u32, seed: u32) -> Problem {
    Problem {
        axes: vec![Axis::Continuous; axes],
        goals: 1,
        conditions,
        evaluations,
        seed,
        start: None,
    }
}

/// The problem of Rosen and Suzuki, four variables from -3 to 3: the least value is -44 at (0, 1, 2, -1), where two of three conditions are active.
fn rosen_suzuki(u: &[f64]) -> Outcome {
    let x: Vec<f64> = u.iter().map(|u| 6.0 * u - 3.0).collect();
    let square: f64 = x.iter().map(|x| x * x).sum();
    let f = square + x[2] * x[2] - 5.0 * x[0] - 5.0 * x[1] - 21.0 * x[2] + 7.0 * x[3];
    let g = [
        square + x[0] - x[1] + x[2] - x[3] - 8.0,
        square + x[1] * x[1] + x[3] * x[3] - x[0] - x[3] - 10.0,
        square + x[0] * x[0] - x[3] * x[3] + 2.0 * x[0] - x[1] - x[3] - 5.0,
    ];
    computed(vec![f], &g)
}

/// The goal of a design that keeps its conditions.
fn kept(outcome: &Outcome) -> f64 {
    assert!(outcome.is_feasible(), "{outcome:?}");
    match outcome {
        Outcome::Computed { goals, .. } => goals[0],
        Outcome::Refused(_) => unreachable!("what is refused is not feasible"),
    }
}

#[test]
fn the_optimum_of_rosen_and_suzuki_is_found_at_its_active_conditions() {
    let mut gaps: Vec<f64> = (0..15)
        .map(|seed| kept(&found(&problem(4, 3, 600, seed), rosen_suzuki).1) + 44.0)
        .collect();
    gaps.sort_by(f64::total_cmp);
    // No design that keeps all conditions is better; the goal ranges over some hundreds.
    assert!(gaps[0] > 0.0, "{gaps:?}");
    assert!(gaps[7] < 0.1 && gaps[14] < 0.5, "{gaps:?}");
}

#[test]
fn every_seed_gives_its_own_designs_and_the_same_ones_each_time() {
    let one = searched(&problem(4, 3, 150, 1), rosen_suzuki);
    assert_eq!(one, searched(&problem(4, 3, 150, 1), rosen_suzuki));
    assert_ne!(one, searched(&problem(4, 3, 150, 2), rosen_suzuki));
    assert_eq!(one.len(), 150);
}

#[test]
fn a_search_begins_with_the_design_that_it_is_given_and_ends_no_worse() {
    let start = vec![0.5, 2.0 / 3.0, 5.0 / 6.0, 1.0 / 3.0];
    let begun = Problem {
        start: Some(start.clone()),
        ..problem(4, 3, 30, 1)
    };
    let all = searched(&begun, rosen_suzuki);
    assert_eq!(all[0].0, start);
    assert!((kept(&all[0].1) + 44.0).abs() < 1e-9);
    assert!((kept(&found(&begun, rosen_suzuki).1) + 44.0).abs() < 1e-9);
}

/// A slope that falls towards designs that cannot be had, which begin where the first variable is below that of the bowl's middle.
fn with_a_cliff(u: &[f64]) -> Outcome {
    if u[0] < 0.6 || u[1] > 0.3 {
        return Outcome::Refused((0.6 - u[0]).max(0.0) + (u[1] - 0.3).max(0.0));
    }
    computed(vec![u[0] + (u[1] - 0.3).abs() + (u[2] - 0.5).abs()], &[])
}

#[test]
fn how_far_a_refusal_is_from_holding_leads_to_what_can_be_had() {
    for seed in 0..7 {
        let best = kept(&found(&problem(3, 0, 300, seed), with_a_cliff).1);
        assert!((0.6..0.63).contains(&best), "seed {seed}: {best}");
    }
}

#[test]
fn of_nothing_but_refusals_none_is_best() {
    let all = searched(&problem(3, 0, 60, 1), |_| Outcome::Refused(1.0));
    let outcomes: Vec<Outcome> = all.into_iter().map(|(_, outcome)| outcome).collect();
    assert_eq!((outcomes.len(), best(&outcomes)), (60, None));
}

/// The coarsest classes on both gears, of which each has eleven, for which a spread stays below a bound: 5 and 8, or as cheap a pair.
fn classes(u: &[f64]) -> Outcome {
    let class = |u: f64| (10.0 * u).round();
    let [driving, driven] = [class(u[0]), class(u[1])];
    let spread = 3.0 * 1.4_f64.powf(driving) + 2.0_f64.powf(0.5 * driven);
    computed(vec![-2.0 * driving - driven], &[spread / 25.0 - 1.0])
}

#[test]
fn variables_with_steps_take_no_value_twice_and_end_with_the_last_design() {
    let stepped = Problem {
        axes: vec![Axis::Steps(10); 2],
        ..problem(2, 1, 400, 3)
    };
    let all = searched(&stepped, classes);
    assert_eq!(all.len(), 121, "every design once, and no more");
    let least = all
        .iter()
        .filter(|(_, outcome)| outcome.is_feasible())
        .map(|(_, outcome)| kept(outcome))
        .fold(f64::INFINITY, f64::min);
    for seed in 0..9 {
        let few = Problem {
            evaluations: 50,
            seed,
            ..stepped.clone()
        };
        let all = searched(&few, classes);
        let mut designs: Vec<_> = all
            .iter()
            .map(|(u, _)| [u[0].to_bits(), u[1].to_bits()])
            .collect();
        designs.sort_unstable();
        designs.dedup();
        assert_eq!(designs.len(), 50, "none twice");
        assert_eq!(kept(&found(&few, classes).1), least, "seed {seed}");
    }
}

/// A bowl whose middle lies at the last but one of nine values of its stepped variable.
fn mixed(u: &[f64]) -> Outcome {
    computed(
        vec![(8.0 * u[0] - 7.0).powi(2) + 10.0 * (u[1] - 0.4).powi(2) + u[0] * u[1]],
        &[],
    )
}

#[test]
fn a_variable_with_steps_beside_continuous_ones_reaches_its_best_value() {
    for seed in 0..9 {
        let both = Problem {
            axes: vec![Axis::Steps(8), Axis::Continuous],
            ..problem(2, 0, 120, seed)
        };
        let (best, _) = found(&both, mixed);
        assert_eq!(8.0 * best[0], 7.0, "seed {seed}");
    }
}

/// The problem of Binh and Korn, x from 0 to 5 and y from 0 to 3: the front lies at x = y up to 3 and at y = 3 beyond.
fn binh_and_korn(u: &[f64]) -> Outcome {
    let [x, y] = [5.0 * u[0], 3.0 * u[1]];
    let goals = vec![4.0 * (x * x + y * y), (x - 5.0).powi(2) + (y - 5.0).powi(2)];
    let conditions = [
        (x - 5.0).powi(2) + y * y - 25.0,
        7.7 - (x - 8.0).powi(2) - (y + 3.0).powi(2),
    ];
    computed(goals, &conditions)
}

#[test]
fn a_search_that_has_settled_begins_elsewhere_and_comes_to_its_end() {
    // Optima in corners, with and without steps, and far more evaluations than it takes to settle there.
    for seed in 0..5 {
        for axes in [
            vec![Axis::Steps(400)],
            vec![Axis::Steps(4), Axis::Continuous],
            vec![Axis::Continuous; 2],
            vec![Axis::Steps(20); 3],
        ] {
            let sloping = Problem {
                axes,
                ..problem(1, 0, 3000, seed)
            };
            let all = searched(&sloping, |u| computed(vec![-u.iter().sum::<f64>()], &[]));
            let possible = crate::optimum::space::count(&sloping.axes)
                .unwrap_or(u64::MAX)
                .min(3000);
            assert_eq!(all.len() as u64, possible);
            assert!(
                all.iter()
                    .all(|(u, _)| u.iter().all(|u| (0.0..=1.0).contains(u)))
            );
            let outcomes: Vec<Outcome> = all.iter().map(|(_, outcome)| outcome.clone()).collect();
            let (found, _) = &all[best(&outcomes).expect("a design")];
            assert!(found.iter().all(|u| *u > 0.999), "{found:?}");
        }
    }
}

#[test]
fn two_goals_come_to_the_front_of_binh_and_korn() {
    let two = Problem {
        goals: 2,
        ..problem(2, 2, 400, 1)
    };
    let all = searched(&two, binh_and_korn);
    let outcomes: Vec<Outcome> = all.iter().map(|(_, outcome)| outcome.clone()).collect();
    let front = front(&outcomes);
    assert!(front.len() > 25, "{}", front.len());
    let mut places: Vec<f64> = Vec::new();
    for i in &front {
        let [x, y] = [5.0 * all[*i].0[0], 3.0 * all[*i].0[1]];
        // The point of the front at as much of the first goal; the second ranges from 4 to 50.
        let square = x * x + y * y;
        let (x, y) = if square < 18.0 {
            ((square / 2.0).sqrt(), (square / 2.0).sqrt())
        } else {
            ((square - 9.0).sqrt(), 3.0)
        };
        let least = (x - 5.0).powi(2) + (y - 5.0).powi(2);
        let Outcome::Computed { goals, .. } = &all[*i].1 else {
            unreachable!("it is feasible")
        };
        assert!(
            (-1e-9..2.5).contains(&(goals[1] - least)),
            "({x}, {y}) is far from the front"
        );
        places.push(x);
    }
    // From one end to the other without a hole.
    places.sort_by(f64::total_cmp);
    assert!(
        places[0] < 0.3 && places[places.len() - 1] > 4.5,
        "{places:?}"
    );
    assert!(
        places.windows(2).all(|two| two[1] - two[0] < 0.7),
        "{places:?}"
    );
    // The compromise lies in the middle of the front.
    let [x, _] = [all[best(&outcomes).expect("a design")].0[0] * 5.0, 0.0];
    assert!((1.0..4.0).contains(&x), "{x}");
}

/// Two bowls with their middles apart, stretched along axes that are turned against the variables: the front is the straight line between the middles.
fn bowls(u: &[f64]) -> Outcome {
    let from = |middle: [f64; 4]| -> f64 {
        let x: Vec<f64> = u.iter().zip(middle).map(|(u, middle)| u - middle).collect();
        // Sums and differences of neighbors are orthogonal.
        let turned = [x[0] + x[1], x[0] - x[1], x[2] + x[3], x[2] - x[3]];
        let stretched = turned.iter().zip([1.0, 30.0, 3.0, 10.0]);
        stretched.map(|(x, stretch)| stretch * x * x).sum()
    };
    computed(
        vec![from([0.3, 0.4, 0.6, 0.2]), from([0.7, 0.5, 0.5, 0.6])],
        &[],
    )
}

/// The first problem of Zitzler, Deb and Thiele with five variables: the front is y = 1 − √x, at zeros of all variables but the first.
fn zdt1(u: &[f64]) -> Outcome {
    let g = 1.0 + 9.0 * crate::sample::mean(&u[1..]).expect("variables");
    computed(vec![u[0], g * (1.0 - (u[0] / g).sqrt())], &[])
}

/// The area between a corner and the front, over that of the rectangle to the best of both goals.
fn area_behind(all: &[(Vec<f64>, Outcome)], corner: [f64; 2]) -> f64 {
    let outcomes: Vec<Outcome> = all.iter().map(|(_, outcome)| outcome.clone()).collect();
    let (mut area, mut top) = (0.0, corner[1]);
    for i in front(&outcomes) {
        let goals = outcomes[i].goals_if_feasible().expect("it is on the front");
        if goals[0] < corner[0] && goals[1] < top {
            area += (corner[0] - goals[0]) * (top - goals[1]);
            top = goals[1];
        }
    }
    area / (corner[0] * corner[1])
}

#[test]
fn the_front_of_two_goals_is_far_nearer_than_that_of_designs_at_random() {
    // The areas behind the whole fronts: of the bowls by their closed form, f and (1 - √f)² times the value at the other middle; of the other 1 - 1/3 plus the
    // area between it and the corner.
    let across = {
        let Outcome::Computed { goals, .. } = bowls(&[0.7, 0.5, 0.5, 0.6]) else {
            unreachable!("it is computed")
        };
        goals[0]
    };
    let cases: [(Function, usize, [f64; 2], f64); 2] = [
        (bowls, 4, [across; 2], 1.0 - 1.0 / 6.0),
        (
            zdt1,
            5,
            [1.1; 2],
            (0.1 * 1.1 + 1.0 * 0.1 + 2.0 / 3.0) / 1.21,
        ),
    ];
    for (function, axes, corner, whole) in cases {
        let missing = |all: &[(Vec<f64>, Outcome)]| whole - area_behind(all, corner);
        let mut found = Vec::new();
        let mut random = Vec::new();
        for seed in 0..15 {
            let two = Problem {
                goals: 2,
                ..problem(axes, 0, 500, seed)
            };
            found.push(missing(&searched(&two, function)));
            let mut chance = crate::optimum::chance::Chance::new(seed);
            let drawn = (0..500).map(|_| {
                let u: Vec<f64> = (0..axes).map(|_| chance.even()).collect();
                let outcome = function(&u);
                (u, outcome)
            });
            random.push(missing(&drawn.collect::<Vec<_>>()));
        }
        for list in [&mut found, &mut random] {
            list.sort_by(f64::total_cmp);
        }
        assert!(found[0] > 0.0, "more than there is: {found:?}");
        assert!(found[7] < 0.1 * random[7], "{found:?} {random:?}");
        assert!(
            found[14] < 0.7 * random[0],
            "the worst against the best at random: {found:?} {random:?}"
        );
    }
}

#[test]
fn a_search_of_steps_has_looked_one_step_beside_what_it_ends_with() {
    let mut missed = 0;
    for seed in 0..60 {
        let stepped = Problem {
            axes: vec![Axis::Steps(10); 2],
            ..problem(2, 1, 30, seed)
        };
        let all = searched(&stepped, classes);
        assert_eq!(all.len(), 30, "seed {seed}");
        let (best, outcome) = found(&stepped, classes);
        let beside = [[0.1, 0.0], [-0.1, 0.0], [0.0, 0.1], [0.0, -0.1]];
        let is_better = beside.iter().any(|by| {
            let design = [0, 1].map(|i| (best[i] + by[i]).clamp(0.0, 1.0));
            classes(&design).order(&outcome).is_lt()
        });
        missed += usize::from(is_better);
    }
    // 2 have, whose last designs were still improving; 8 had when no search looked there on purpose.
    assert!(missed <= 4, "{missed} of 60");
}
