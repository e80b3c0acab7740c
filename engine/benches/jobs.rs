//! Whole jobs in-process, by the goals of DESIGN section 6: cold (an empty library) unless the name says otherwise.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use meshwright_engine::analysis::{Case, Library, Method, analyze};
use meshwright_engine::run::Run;

#[path = "../tests/cases/mod.rs"]
mod cases;
use cases::{study_design, test_case};

fn solve(case: &Case, library: &Library) {
    black_box(
        analyze(case, library, &Run::unattended()).expect("the paper's cases have solutions"),
    );
}

fn jobs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("jobs");
    group.sample_size(10);
    let methods = [
        (Method::Flexible, "flexible"),
        (Method::Decomposition, "decomposition"),
        (Method::ProjectedDecomposition, "projected"),
    ];
    for (case, number) in [(test_case(1), 1), (test_case(2), 2), (test_case(3), 3)] {
        for (method, name) in methods {
            let case = Case {
                method,
                ..case.clone()
            };
            group.bench_function(format!("{name}, case {number}"), |bencher| {
                bencher.iter(|| solve(&case, &Library::default()))
            });
        }
    }
    group.bench_function(
        "projected, case 2, a new hole pattern on known teeth",
        |bencher| {
            let case = Case {
                method: Method::ProjectedDecomposition,
                ..test_case(2)
            };
            let solid = Case {
                method: Method::Flexible,
                ..study_design(None, &[115.0])
            };
            bencher.iter_batched(
                || {
                    let library = Library::default();
                    solve(&solid, &library);
                    library
                },
                |library| solve(&case, &library),
                criterion::BatchSize::PerIteration,
            );
        },
    );
    group.bench_function(
        "section 5, six designs at two torques, flexible",
        |bencher| {
            let holes = [
                None,
                Some((8, 34e-3, 8.385e-3)),
                Some((10, 34e-3, 7.5e-3)),
                Some((6, 30e-3, 9.683e-3)),
                Some((8, 30e-3, 8.385e-3)),
                Some((8, 27e-3, 8.385e-3)),
            ];
            bencher.iter(|| {
                let library = Library::default();
                for design in holes {
                    solve(&study_design(design, &[20.0, 115.0]), &library);
                }
            });
        },
    );
    group.finish();
}

criterion_group!(benches, jobs);
criterion_main!(benches);
