//! Where the time of a job goes: the grids, the substructures and the joined gear of the driven gears of cases 2 and 3, and
//! one position of their contact.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use meshwright_benches::group;
use meshwright_engine::analysis::{Case, pair_model};
use meshwright_engine::contact::WarmStart;
use meshwright_engine::contact::{MeshPhase, PairModel, solve_active_set};
use meshwright_engine::gear::{BlankRegion, Core, Hole, HoleShape, SpurGear};
use meshwright_engine::grid::{BlankGrid, GridLevel, ToothGrid};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_engine::substructures::{
    BlankSubstructure, Coupling, FlankTable, GapProfile, Harmonics, InterfaceMotion, PlainGear,
    TeethRing, ToothSubstructure, blank_grid, default_interface_radius, harmonics, orders_of_blank,
};

#[path = "../tests/cases/mod.rs"]
mod cases;
use cases::test_case;

fn gears(criterion: &mut Criterion) {
    for number in [2, 3] {
        let case = test_case(number);
        let gear = case.pair.driven();
        let radius = default_interface_radius(gear);
        let level = GridLevel::Standard;
        let orders = harmonics(gear, radius, level);
        let (material, width) = (gear.material(), gear.face_width());
        let run = Run::unattended();
        let mut group = group(criterion, &format!("case {number}, driven gear"), 2);

        let grid = ToothGrid::new(gear, radius, level).expect("a grid");
        group.bench_function("tooth: grid", |bencher| {
            bencher.iter(|| black_box(ToothGrid::new(gear, radius, level)));
        });
        let tooth = ToothSubstructure::new(gear, &grid).expect("a tooth");
        group.bench_function("tooth: condensed", |bencher| {
            bencher.iter(|| black_box(ToothSubstructure::new(gear, &grid)));
        });
        group.bench_function("tooth: flank table", |bencher| {
            bencher.iter(|| black_box(FlankTable::new(&tooth, gear)));
        });
        let ring = TeethRing::new(&tooth, orders, &run).expect("a ring");
        group.bench_function("teeth: ring", |bencher| {
            bencher.iter(|| black_box(TeethRing::new(&tooth, orders, &run)));
        });
        let lay = |gear: &SpurGear| blank_grid(gear, radius, level).expect("a grid");
        group.bench_function("blank: grid", |bencher| {
            bencher.iter(|| black_box(lay(gear)));
        });
        let condense = |grid: &BlankGrid, orders| {
            BlankSubstructure::new(grid, radius, material, width, orders, &run).expect("a blank")
        };
        let (low, grid) = (orders_of_blank(gear, radius, level), lay(gear));
        group.bench_function("blank: condensed, and its ring", |bencher| {
            bencher.iter(|| black_box(condense(&grid, low)));
        });
        let (blank, solid) = (
            condense(&grid, low),
            condense(&lay(&gear.without_holes()), orders),
        );
        group.bench_function("gear: without holes", |bencher| {
            bencher.iter(|| black_box(PlainGear::new(&ring, &solid, &run)));
        });
        let plain = PlainGear::new(&ring, &solid, &run).expect("a gear");
        let joined = || {
            let motion = InterfaceMotion::new(&ring, &plain, Some((&blank, 0.0)), &run)?;
            Coupling::new(&motion, 4, &run)
        };
        group.bench_function("gear: holes in it", |bencher| {
            bencher.iter(|| black_box(joined()));
        });
        group.finish();
    }
}

/// A blank without symmetry: four unequal holes under fifty teeth.
fn whole_blank(criterion: &mut Criterion) {
    let hole = |angle, radius| Hole {
        circle_radius: 30e-3,
        angle,
        shape: HoleShape::Round { radius },
    };
    let region = BlankRegion {
        bore_radius: 15e-3,
        core: Core::Bore,
        holes: vec![
            hole(0.0, 10e-3),
            hole(1.7, 8e-3),
            hole(3.2, 9e-3),
            hole(4.6, 6e-3),
        ],
        web: None,
    };
    let (radius, width, run) = (45.5e-3, 20e-3, Run::unattended());
    let case = test_case(2);
    let material = case.pair.driven().material();
    let lay = || BlankGrid::of_region(&region, width, radius, 50, 4.0, GridLevel::Standard);
    let mut group = group(criterion, "four unequal holes", 2);
    group.bench_function("blank: grid", |bencher| bencher.iter(|| black_box(lay())));
    let grid = lay().expect("a grid");
    let orders = Harmonics { largest: 51 };
    group.bench_function("blank: condensed, and its ring", |bencher| {
        bencher.iter(|| {
            black_box(BlankSubstructure::new(
                &grid, radius, material, width, orders, &run,
            ))
        });
    });
    group.finish();
}

/// The pairs to either side of position `eta` that may touch.
fn facings(case: &Case, eta: f64) -> Vec<GapProfile> {
    (-3..=4)
        .filter_map(|n| GapProfile::drawn(&case.pair, eta - f64::from(n)))
        .collect()
}

fn positions(criterion: &mut Criterion) {
    for number in [2, 3] {
        let case = test_case(number);
        let load = case.pair.load(case.output_torques[0]);
        let model = pair_model(&case, &Library::default(), &Run::unattended()).expect("a model");
        let mut group = group(criterion, &format!("case {number}, one position"), 2);
        for (eta, pairs) in [(0.05, "one pair"), (0.5, "two pairs")] {
            group.bench_function(format!("{pairs}: detection"), |bencher| {
                bencher.iter(|| black_box(facings(&case, eta)));
            });
            let mut warm = WarmStart::default();
            let cells = model
                .as_drawn()
                .cells(eta, load, &mut warm)
                .expect("contact");
            let touching = cells.solution.active.clone();
            group.bench_function(format!("{pairs}: contact solve, cold"), |bencher| {
                bencher.iter(|| black_box(solve_active_set(&cells.problem, load, None)));
            });
            group.bench_function(format!("{pairs}: contact solve, warm"), |bencher| {
                bencher.iter(|| black_box(solve_active_set(&cells.problem, load, Some(&touching))));
            });
            group.bench_function(format!("{pairs}: all of it, cold"), |bencher| {
                bencher.iter(|| {
                    let flanks_unknown = PairModel {
                        drawn: Arc::default(),
                        compliances: Arc::default(),
                        ..model.clone()
                    };
                    black_box(flanks_unknown.as_drawn().contact(
                        eta,
                        load,
                        &mut WarmStart::default(),
                    ))
                });
            });
            group.bench_function(
                format!("{pairs}: all of it, warm, flanks known"),
                |bencher| {
                    bencher.iter(|| black_box(model.as_drawn().contact(eta, load, &mut warm)));
                },
            );
            // A curve meets the same fraction of the mesh period once in every mesh period.
            let mut phase = MeshPhase::new(model.as_drawn(), eta, load).expect("flanks come near");
            let (mut period, periods) = (0, i64::from(case.pair.period()));
            group.bench_function(
                format!("{pairs}: all of it, a further mesh period"),
                |bencher| {
                    bencher.iter(|| {
                        period = (period + 1) % periods;
                        black_box(phase.contact(period, &mut warm, |_, _| ()))
                    });
                },
            );
        }
        group.finish();
    }
}

criterion_group!(benches, gears, whole_blank, positions);
criterion_main!(benches);
