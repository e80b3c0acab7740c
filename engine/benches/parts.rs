//! The parts of a job: grids, substructures, the joined gear and one position.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use meshwright_engine::analysis::Library;
use meshwright_engine::analysis::library::default_interface_radius;
use meshwright_engine::fem::tooth::ToothSubstructure;
use meshwright_engine::gear::Member;
use meshwright_engine::grid::{GridLevel, ToothGrid};
use meshwright_engine::run::Run;

#[path = "../tests/cases/mod.rs"]
mod cases;
use cases::test_case;

fn parts(criterion: &mut Criterion) {
    let case = test_case(3);
    let gear = case.pair.driven();
    let radius = default_interface_radius(gear);
    let run = Run::unattended();
    let mut group = criterion.benchmark_group("parts of case 3, gear 2");
    group.sample_size(20);
    let grid = ToothGrid::new(gear, radius, GridLevel::Standard).expect("a grid");
    group.bench_function("tooth grid", |bencher| {
        bencher.iter(|| black_box(ToothGrid::new(gear, radius, GridLevel::Standard)))
    });
    group.bench_function("tooth condensed", |bencher| {
        bencher.iter(|| black_box(ToothSubstructure::new(gear, &grid)))
    });
    group.bench_function("teeth", |bencher| {
        bencher.iter(|| {
            black_box(Library::default().teeth(
                gear,
                Member::Driven,
                radius,
                GridLevel::Standard,
                &run,
            ))
        });
    });
    group.bench_function("teeth, blank and their coupling", |bencher| {
        bencher.iter(|| {
            black_box(Library::default().gear(
                gear,
                Member::Driven,
                radius,
                GridLevel::Standard,
                &run,
            ))
        });
    });
    group.finish();
}

criterion_group!(benches, parts);
criterion_main!(benches);
