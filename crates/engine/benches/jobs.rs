//! Whole jobs in this process: cold (an empty library) unless the name says otherwise.

use std::hint::black_box;

use criterion::{BatchSize, Bencher, Criterion, criterion_group, criterion_main};
use meshwright_benches::group;
use meshwright_engine::analysis::at_speed::{DynamicsRequest, dynamics};
use meshwright_engine::analysis::forces::{ForceTableRequest, force_table};
use meshwright_engine::analysis::rotors::Blanks;
use meshwright_engine::analysis::{Case, FaceHoles, Faces, Method, Model, analyze, pair_model};
use meshwright_engine::assembly::FaceResolution;
use meshwright_engine::assembly::{Parts, TeethSpec};
use meshwright_engine::contact::WarmStart;
use meshwright_engine::contact::face::SLICES;
use meshwright_engine::gear::{
    Alignment, GearPair, Helix, Member, SolidGear, SolidPair, SpurGear, Web,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_engine::substructures::default_interface_radius;

#[path = "../tests/cases/mod.rs"]
mod cases;
use cases::{case, gear, holed, model_by, standard_pair, study_design, test_case};

const METHODS: [(Method, &str); 4] = [
    (Method::Flexible, "flexible"),
    (Method::Decomposition, "decomposition"),
    (Method::ProjectedDecomposition, "projected"),
    (Method::LoadDistribution, "load distribution"),
];

fn solve(case: &Case, library: &Library) {
    black_box(
        analyze(case, library, &Run::unattended()).expect("the paper's cases have solutions"),
    );
}

fn solve_cold(case: &Case) {
    solve(case, &Library::default());
}

/// The paper's cases and the standard pair, with the names that the benchmarks give them.
fn pairs() -> [(Case, &'static str); 4] {
    [
        (test_case(1), "case 1"),
        (test_case(2), "case 2"),
        (test_case(3), "case 3"),
        (case(standard_pair(true), &[115.0]), "standard pair"),
    ]
}

fn by(case: &Case, method: Method) -> Case {
    Case {
        model: model_by(method, &case.model),
        ..case.clone()
    }
}

/// A library that knows the teeth of `case` and nothing else.
fn with_teeth(case: &Case) -> Library {
    let library = Library::default();
    for member in Member::BOTH {
        let gear = case.pair.gear(member);
        let radius = default_interface_radius(gear);
        library
            .teeth(
                &TeethSpec::new(gear, radius, case.resolution.grid),
                &Run::unattended(),
            )
            .expect("the teeth of the paper have grids");
    }
    library
}

/// `case` with the hole circles of its gears larger by `change`, in meters.
fn with_moved_holes(case: &Case, change: f64) -> Case {
    let moved = |gear: &SpurGear| {
        let mut data = gear.data().clone();
        for hole in &mut data.blank.holes {
            hole.circle_radius += change;
        }
        SpurGear::new(data).expect("holes that move by a tenth of a millimeter still fit")
    };
    let (driving, driven) = (moved(case.pair.driving()), moved(case.pair.driven()));
    Case {
        pair: GearPair::new(driving, driven, case.pair.center_distance())
            .expect("holes do not keep teeth apart"),
        ..case.clone()
    }
}

fn cold(criterion: &mut Criterion) {
    let mut group = group(criterion, "cold", 3);
    for (case, pair) in pairs() {
        for (method, name) in METHODS {
            let case = by(&case, method);
            group.bench_function(format!("{pair}, {name}"), |bencher| {
                bencher.iter(|| solve_cold(&case));
            });
        }
    }
    group.finish();
}

fn teeth_known(criterion: &mut Criterion) {
    let mut group = group(criterion, "teeth known", 3);
    for (case, pair) in pairs() {
        for (method, name) in METHODS.into_iter().take(3) {
            let case = by(&case, method);
            group.bench_function(format!("{pair}, {name}"), |bencher| {
                bencher.iter_batched_ref(
                    || with_teeth(&case),
                    |library| solve(&case, library),
                    BatchSize::PerIteration,
                );
            });
        }
    }
    group.finish();
}

/// `case` with its holes moved, when all is known of the case before.
fn move_holes(bencher: &mut Bencher<'_>, case: &Case) {
    let moved = with_moved_holes(case, 0.1e-3);
    bencher.iter_batched_ref(
        || {
            let library = with_teeth(case);
            solve(case, &library);
            library
        },
        |library| solve(&moved, library),
        BatchSize::PerIteration,
    );
}

/// What a designer does who drags a hole or turns up the torque: everything is known but what changes.
fn changes(criterion: &mut Criterion) {
    let mut group = group(criterion, "change", 3);
    for (case, pair) in pairs().into_iter().take(3) {
        for (method, name) in METHODS.into_iter().take(3) {
            let case = by(&case, method);
            let library = Library::default();
            solve(&case, &library);
            let mut torque = case.output_torques[0];
            group.bench_function(format!("{pair}, {name}, a further torque"), |bencher| {
                bencher.iter(|| {
                    // A torque that no iteration had before, so that its contacts are not known.
                    torque += 1e-6;
                    let further = Case {
                        output_torques: vec![torque],
                        ..case.clone()
                    };
                    solve(&further, &library);
                });
            });
        }
    }
    for (case, pair) in pairs().into_iter().take(3) {
        for (method, name) in METHODS.into_iter().take(3) {
            let mut case = by(&case, method);
            group.bench_function(format!("{pair}, {name}, holes moved"), |bencher| {
                move_holes(bencher, &case);
            });
            // What a preview computes; the pair before it was previewed as well.
            case.resolution.positions_per_mesh_period = 20;
            if pair == "case 2" {
                group.bench_function(
                    format!("{pair}, {name}, holes moved, 20 positions a mesh period"),
                    |bencher| move_holes(bencher, &case),
                );
            }
        }
    }
    for (case, pair) in pairs() {
        let model = pair_model(&case, &Library::default(), &Run::unattended())
            .expect("the paper's pairs have models");
        let load = case.pair.load(case.output_torques[0]);
        let steps = f64::from(case.resolution.positions_per_mesh_period);
        let positions = case.positions();
        let (mut i, mut warm) = (0, WarmStart::default());
        group.bench_function(format!("{pair}, flexible, a further position"), |bencher| {
            bencher.iter(|| {
                let eta = i as f64 / steps;
                i = (i + 1) % positions;
                black_box(
                    model
                        .as_drawn()
                        .contact(eta, load, &mut warm)
                        .expect("every position of the paper's cases has a solution"),
                )
            });
        });
    }
    group.finish();
}

fn study(criterion: &mut Criterion) {
    let holes = [
        None,
        Some((8, 34e-3, 8.385e-3)),
        Some((10, 34e-3, 7.5e-3)),
        Some((6, 30e-3, 9.683e-3)),
        Some((8, 30e-3, 8.385e-3)),
        Some((8, 27e-3, 8.385e-3)),
    ];
    let mut group = group(criterion, "study", 3);
    for (method, name) in METHODS.into_iter().take(3) {
        group.bench_function(
            format!("section 5, six designs at two torques, {name}"),
            |bencher| {
                bencher.iter(|| {
                    let library = Library::default();
                    for design in holes {
                        solve(&by(&study_design(design, &[20.0, 115.0]), method), &library);
                    }
                });
            },
        );
    }
    group.finish();
}

fn resolution(criterion: &mut Criterion) {
    let mut group = group(criterion, "resolution", 3);
    for (level, name) in [
        (GridLevel::Coarse, "coarse"),
        (GridLevel::Standard, "standard"),
        (GridLevel::Fine, "fine"),
    ] {
        let mut case = test_case(2);
        case.resolution.grid = level;
        group.bench_function(format!("case 2, flexible, {name} grid"), |bencher| {
            bencher.iter(|| solve_cold(&case));
        });
    }
    let mut case = test_case(2);
    case.resolution.error_estimate = true;
    group.bench_function("case 2, flexible, with error estimate", |bencher| {
        bencher.iter(|| solve_cold(&case));
    });
    group.finish();
}

/// Case 2 with its force table, and up and down through 400 speeds once the table is there.
fn forces(criterion: &mut Criterion) {
    let case = test_case(2);
    let (library, run) = (Library::default(), Run::unattended());
    let request = ForceTableRequest {
        loads: 12,
        largest_output_torque: None,
    };
    let table = || force_table(&case, request, &library, &run).expect("a table");
    let analysis = analyze(&case, &library, &run).expect("curves");
    let speeds = DynamicsRequest {
        speeds: (0..400)
            .map(|i| f64::from(i) / 399.0 * 20_000.0 / 60.0)
            .collect(),
        damping_ratio: 0.05,
        inertias: [None; 2],
        blank_modes: None,
        all_directions: false,
        blank_damping_ratio: 0.02,
        mounts: Default::default(),
        sweeps: [true, true],
    };
    let mut group = group(criterion, "forces", 3);
    group.bench_function("case 2, table of twelve loads", |bencher| {
        bencher.iter(|| black_box(table()));
    });
    let table = table();
    group.bench_function("case 2, 400 speeds to 20,000 rpm, up and down", |bencher| {
        bencher.iter(|| {
            black_box(dynamics(
                &case,
                &analysis.curves[0],
                &table,
                (&speeds, &Blanks::default()),
                &run,
            ))
            .expect("nobody stops it")
        });
    });
    group.finish();
}

/// A pair along its faces: 40/40 teeth of normal module 2 mm at 20 degrees, 20 mm wide, with this web in the driven one, and six holes at this radius.
fn helical(web: bool, hole_circle: Option<f64>) -> Case {
    let solid = |beta: f64, web: bool| {
        let mut data = gear(40, 20e-3);
        data.blank.web = web.then_some(Web {
            inner_radius: 26e-3,
            outer_radius: 36e-3,
            thickness: 6e-3,
        });
        let data = match hole_circle.filter(|_| web) {
            Some(radius) => holed(data, 6, radius, 3.5e-3, 0.0),
            None => data,
        };
        SolidGear::new(data, Helix::right(beta), 0.0, None).expect("can be made")
    };
    let beta = 20_f64.to_radians();
    let gears = [solid(beta, false), solid(-beta, web)];
    let center_distance = 2.0 * gears[0].section().reference_radius();
    let leads = [Vec::new(), Vec::new()];
    let pair = SolidPair::new(gears, leads, center_distance, Alignment::default());
    let pair = pair.expect("meshes");
    let mut case = case(pair.section().clone(), &[100.0]);
    let faces = Faces {
        pair,
        resolution: FaceResolution::STANDARD,
        slices: SLICES,
        at_each_position: false,
        cure: false,
    };
    case.model = Model::Faces(Box::new(faces), FaceHoles::Whole);
    case
}

/// Pairs along their faces: cold, with parts known, and with a hole moved.
fn faces(criterion: &mut Criterion) {
    let mut group = group(criterion, "faces", 3);
    let mut solid = helical(false, None);
    solid.resolution.positions_per_mesh_period = 32;
    solid.output_torques = vec![20.0, 60.0, 100.0, 150.0, 200.0];
    let holes = |radius: f64, method: Method| {
        let mut case = by(&helical(true, Some(radius)), method);
        case.resolution.positions_per_mesh_period = 16;
        case
    };
    let cases = [
        (solid, "40/40 teeth, 32 positions, 5 torques"),
        (
            holes(31e-3, Method::ThreeDimensional),
            "six holes in a web, 20 mesh periods of 16 positions",
        ),
        (
            holes(31e-3, Method::ThreeDimensionalProjected),
            "six holes in a web, 20 mesh periods of 16 positions, projected",
        ),
    ];
    for (case, name) in &cases {
        group.bench_function(format!("{name}, cold"), |bencher| {
            bencher.iter(|| solve_cold(case));
        });
        let library = Library::default();
        solve(case, &library);
        group.bench_function(format!("{name}, parts known"), |bencher| {
            bencher.iter(|| solve(case, &library));
        });
    }
    for (case, name) in &cases[1..] {
        let moved = holes(31.2e-3, case.method());
        group.bench_function(format!("{name}, holes moved"), |bencher| {
            bencher.iter_batched_ref(
                || {
                    let library = Library::default();
                    solve(case, &library);
                    library
                },
                |library| solve(&moved, library),
                BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

criterion_group!(
    benches,
    cold,
    teeth_known,
    changes,
    study,
    resolution,
    forces,
    faces
);
criterion_main!(benches);
