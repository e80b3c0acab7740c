//! Whole gears along their faces, held against what others computed.

mod cases;

use std::sync::Arc;
use std::time::Instant;

use cases::{
    above_the_tenth_harmonic, along_faces, drawn, face_yields, gear, helical, helical_pair,
    relieved,
};
use meshwright_engine::analysis::stress::PeakStress;
use meshwright_engine::analysis::{Analysis, Case, analyze};
use meshwright_engine::assembly::{FaceCompliance, FaceResolution};
use meshwright_engine::contact::face::{
    FaceContact, FaceModel, FlankCompliance, SLICES, SliceLoad,
};
use meshwright_engine::gear::{
    Alignment, BlankRegion, GearData, Hole, HolePattern, LeadModification, Member,
    ModificationData, ReliefData, ReliefShape, ReliefStart, SolidGear, SolidPair, Web,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_engine::substructures::FARTHEST_COUPLED;

/// The gear of the references: 40 teeth, normal module 2 mm, 20 mm wide, its rim held at a radius of 28 mm.
fn reference_gear(beta: f64, change: impl Fn(&mut GearData)) -> SolidGear {
    let mut data = gear(40, 28e-3);
    data.rack.tip_radius = 0.684e-3;
    change(&mut data);
    helical(data, beta.to_radians(), 0.0)
}

fn reference_pair(
    beta: f64,
    leads: [Vec<LeadModification>; 2],
    change: impl Fn(&mut GearData),
) -> SolidPair {
    let gears = [
        reference_gear(beta, &change),
        reference_gear(-beta, &change),
    ];
    let a = 2.0 * gears[0].section().reference_radius();
    SolidPair::new(gears, leads, a, Alignment::default()).expect("meshes")
}

fn case(pair: SolidPair, output_torques: &[f64], positions: u32) -> Case {
    let mut case = along_faces(pair, (FaceResolution::STANDARD, SLICES), output_torques);
    case.resolution.positions_per_mesh_period = positions;
    case
}

fn solve(case: &Case) -> Analysis {
    let started = Instant::now();
    let analysis = analyze(case, &Library::default(), &Run::unattended()).expect("solves");
    for curve in &analysis.curves {
        let (delta, stiffness) = (
            curve.transmission_error_statistics,
            curve.mesh_stiffness_tangent_statistics,
        );
        println!(
            "T {} STE {:.4} um, p-p {:.4} um, k {:.3} N/(mm um), K_Hb {:?}, p {:?}, {:?}",
            curve.output_torque,
            1e6 * delta.mean,
            1e6 * delta.peak_to_peak,
            1e-9 * stiffness.mean / 20.0,
            curve.face.as_ref().map(|face| face.face_load_factor),
            curve
                .peak_contact_pressure
                .iter()
                .flatten()
                .copied()
                .fold(0.0, f64::max)
                * 1e-6,
            started.elapsed(),
        );
    }
    println!("{:?}", analysis.evidence);
    analysis
}

/// Contacts of a narrow pair whose axes lie askew, or of its image in the plane of its face.
fn askew(seed: u64, image: bool, positions: &[f64]) -> Vec<FaceContact> {
    let mut draw = drawn(seed);
    let mut between = |low: f64, high: f64| low + (high - low) * draw();
    let sign = if image { -1.0 } else { 1.0 };
    let beta = match seed % 3 {
        0 => 0.0,
        1 => between(4.0, 12.0),
        _ => -between(12.0, 25.0),
    };
    let gears = [1.0, -1.0].map(|hand| {
        let mut data = gear(between(20.0, 50.0) as u32, 8e-3);
        data.face_width = between(5e-3, 10e-3);
        helical(data, sign * hand * beta.to_radians(), 0.0)
    });
    let yields = gears.each_ref().map(|gear| {
        let resolution = FaceResolution {
            face_order: 4,
            ..FaceResolution::DRAFT
        };
        let made = FaceCompliance::of(gear, resolution, &Run::unattended());
        Arc::new(made.expect("can be condensed")) as Arc<dyn FlankCompliance>
    });
    let [one, other] = gears
        .each_ref()
        .map(|gear| gear.section().reference_radius());
    let alignment = Alignment {
        axial_offset: sign * between(-1e-3, 1e-3),
        in_plane: sign * between(-20e-6, 20e-6),
        out_of_plane: sign * between(-20e-6, 20e-6),
    };
    let leads = [2e-6, 6e-6].map(|amount| vec![LeadModification::Crowning { amount }]);
    let pair = SolidPair::new(gears, leads, one + other + 0.1e-3, alignment).expect("meshes");
    let load = pair.common_face_width() * between(50e3, 300e3);
    let model = FaceModel::new(pair, yields, SLICES, FARTHEST_COUPLED);
    let solved = model.contacts(load, positions, &Run::unattended());
    solved.expect("a balance at every position")
}

#[test]
#[ignore = "./test all"]
fn narrow_pairs_on_crooked_axes_are_their_images_at_every_position() {
    // Teeth come into mesh by a tip at one end of the face, where lines are short and much loaded.
    let positions: Vec<f64> = (0..32).map(|i| f64::from(i) / 32.0).collect();
    for seed in 1..=12 {
        let [one, image] = [false, true].map(|image| askew(seed, image, &positions));
        let apart: Vec<f64> = one
            .iter()
            .zip(&image)
            .map(|(one, image)| one.mesh.transmission_error - image.mesh.transmission_error)
            .collect();
        // A misalignment counts from one end of the face, and so the image's from the other: by as much at every position.
        let shift = apart.iter().sum::<f64>() / 32.0;
        let most = apart
            .iter()
            .map(|apart| (apart - shift).abs())
            .fold(0.0, f64::max);
        assert!(most < 1e-15, "seed {seed}: {most:e}");
    }
}

#[test]
fn one_position_of_one_pair_is_that_of_calculix() {
    // tests/reference/3d: one pair on sectors held 4 mm below the root, 16 kN, 40 um over the face: δ 99.45 um without its penalty, the load
    // at −0.969 to −0.989 mm, the heaviest of ten strips 1.187 to 1.195 of their mean.
    let alone = |data: &mut GearData| {
        // The loaded flanks of all others stand back; whole teeth that did would meet the others' backs.
        let mut slopes = vec![-300e-6; 40];
        slopes[0] = 0.0;
        data.deviations.profile_slope = slopes;
    };
    let slope = vec![LeadModification::Slope { amount: 40e-6 }];
    let pair = reference_pair(20.0, [Vec::new(), slope], alone);
    let yields = Member::BOTH.map(|member| {
        let gear = pair.gear(member);
        let inner = gear.section().root_radius() - 4e-3;
        let made = FaceCompliance::of_sector(gear, inner, FaceResolution::STANDARD);
        Arc::new(made.expect("can be condensed")) as Arc<dyn FlankCompliance>
    });
    let model = FaceModel::new(pair, yields, SLICES, 16);
    let contact = model.contacts(16_000.0, &[0.0], &Run::unattended());
    let contact = contact.expect("a balance").remove(0);
    let delta = contact.mesh.transmission_error;
    let strips = contact.strips(20e-3, 10);
    let heaviest = strips.iter().copied().fold(0.0, f64::max) / 1600.0;
    let centroid = contact.load_centroid();
    println!("{delta} {centroid} {heaviest} {strips:?}");
    assert!((delta / 99.45e-6 - 1.0).abs() < 0.005, "{delta}");
    assert!((centroid + 0.979e-3).abs() < 0.04e-3, "{centroid}");
    assert!((heaviest / 1.19 - 1.0).abs() < 0.02, "{heaviest}");
}

#[test]
#[ignore = "./test all"]
fn the_helical_pair_of_the_references_yields_as_it_should() {
    // By theoretical contact lines alone another program finds δ 6.522 µm in the mean and K_Hβ 1.042, and with 10 µm over the face 11.47 µm and
    // 1.847, on segments of 25 teeth. Tip edges, which touch beside those lines, take 2 to 4 % of δ.
    let started = Instant::now();
    let analysis = solve(&case(
        reference_pair(20.0, [Vec::new(), Vec::new()], |_| ()),
        &[100.0, 10.0, 30.0, 60.0, 300.0],
        32,
    ));
    println!("cold {:?}", started.elapsed());
    let curve = &analysis.curves[0];
    let mean = 1e6 * curve.transmission_error_statistics.mean;
    assert!(mean > 0.96 * 6.522 && mean < 0.99 * 6.522, "{mean}");
    let slope = vec![LeadModification::Slope { amount: 10e-6 }];
    let tilted = solve(&case(
        reference_pair(20.0, [slope, Vec::new()], |_| ()),
        &[100.0],
        16,
    ));
    let face = tilted.curves[0].face.as_ref().expect("under load");
    let mean = 1e6 * tilted.curves[0].transmission_error_statistics.mean;
    assert!(mean > 0.96 * 11.47 && mean < 11.47, "{mean}");
    assert!(face.face_load_factor > 1.7 && face.face_load_factor < 1.95);
    assert!(face.load_centroid.iter().all(|z| *z < 0.0));
    let relieved = |data: &mut GearData| {
        data.modifications = vec![ModificationData::TipRelief(ReliefData {
            amount: 15e-6,
            shape: ReliefShape::Linear,
            start: ReliefStart::RadialLength(1e-3),
        })];
    };
    solve(&case(
        reference_pair(20.0, [Vec::new(), Vec::new()], relieved),
        &[100.0],
        16,
    ));
}

#[test]
#[ignore = "./test all"]
fn a_few_slices_that_carry_all_of_the_load_press_as_one_line() {
    // 180 µm over a face of 1.6 mm on a web that is a quarter of it: a dozen of 40 slices carry, shorter than their contact is wide.
    let gear = |teeth: u32, width: f64, beta: f64, web: bool| {
        let mut data = gear(teeth, 4.5e-3);
        let rack = &mut data.rack;
        (rack.module, rack.addendum, rack.dedendum) = (0.5e-3, 0.5e-3, 0.625e-3);
        (rack.pressure_angle, rack.tip_radius) = (15_f64.to_radians(), 0.19e-3);
        data.face_width = width;
        data.blank.web = web.then_some(Web {
            inner_radius: 8.9e-3,
            outer_radius: 18.9e-3,
            thickness: 0.39e-3,
        });
        helical(data, beta.to_radians(), 0.0)
    };
    let gears = [
        gear(42, 1.87e-3, -29.06, false),
        gear(72, 1.59e-3, 29.06, true),
    ];
    let yields = gears.each_ref().map(|gear| {
        let resolution = FaceResolution {
            face_order: 4,
            ..FaceResolution::DRAFT
        };
        let made = FaceCompliance::of(gear, resolution, &Run::unattended());
        Arc::new(made.expect("can be condensed")) as Arc<dyn FlankCompliance>
    });
    let alignment = Alignment {
        in_plane: 14e-6,
        ..Alignment::default()
    };
    let leads = [Vec::new(), Vec::new()];
    let pair = SolidPair::new(gears, leads, 32.63e-3, alignment).expect("meshes");
    // More would deflect the teeth by over a quarter of the module, which is no result.
    let load = pair.section().load(0.8);
    let model = FaceModel::new(pair, yields, SLICES, FARTHEST_COUPLED);
    let positions: Vec<f64> = (0..16).map(|i| f64::from(i) / 16.0).collect();
    let contacts = model.contacts(load, &positions, &Run::unattended());
    for contact in contacts.expect("a balance at every position") {
        let carried: f64 = contact.slices.iter().map(|slice| slice.force).sum();
        assert!((carried / load - 1.0).abs() < 1e-9);
        assert!(contact.load_centroid() < 0.0);
    }
}

/// 30/48 teeth of module 2 mm with a face of half a millimeter, which is in plane stress, the driven gear with this blank beside its bore:
/// in the plane, and along its faces.
fn narrow_pair(blank: impl Fn(&mut BlankRegion)) -> [Case; 2] {
    let narrow = |data: GearData| GearData {
        face_width: 0.5e-3,
        ..relieved(data)
    };
    let driving = narrow(gear(30, 12e-3));
    let mut driven = narrow(gear(48, 15e-3));
    blank(&mut driven.blank);
    let (a, torque) = (78.05e-3, 1.5);
    let gears = [driving.clone(), driven.clone()].map(|data| helical(data, 0.0, 0.0));
    let none = [Vec::new(), Vec::new()];
    let solid = SolidPair::new(gears, none, a, Alignment::default()).expect("meshes");
    let faces = along_faces(solid, (FaceResolution::STANDARD, 10), &[torque]);
    let plane = cases::case(cases::pair(driving, driven, a), &[torque]);
    [plane, faces].map(|mut case| {
        case.resolution.positions_per_mesh_period = 8;
        case.stress = true;
        case
    })
}

fn round_holes(count: u32, circle_radius: f64, radius: f64) -> Vec<Hole> {
    HolePattern {
        count,
        circle_radius,
        radius,
        phase: 0.0,
    }
    .holes()
}

/// Eight holes in the rim, of this radius on a circle of this radius.
fn in_rim(circle_radius: f64, radius: f64) -> impl Fn(&mut BlankRegion) {
    move |blank| blank.holes = round_holes(8, circle_radius, radius)
}

/// A web from 20 to 42 mm with these holes.
fn in_web(holes: Vec<Hole>) -> impl Fn(&mut BlankRegion) {
    move |blank| {
        blank.web = Some(Web {
            inner_radius: 20e-3,
            outer_radius: 42e-3,
            thickness: 0.2e-3,
        });
        blank.holes.clone_from(&holes);
    }
}

/// Of the driven gear of an analysis: mean and peak-to-peak of δ, the first order of its eight holes, the mean stiffness, and the largest stresses at its roots and
/// at its holes.
fn numbers(analysis: &Analysis) -> [f64; 6] {
    let curve = &analysis.curves[0];
    let of_holes = curve.transmission_error.iter().enumerate();
    let count = curve.transmission_error.len() as f64;
    let [cosine, sine] = of_holes.fold([0.0; 2], |[cosine, sine], (i, delta)| {
        let (s, c) = (std::f64::consts::TAU * i as f64 / count).sin_cos();
        [cosine + delta * c, sine + delta * s]
    });
    let stresses = curve.stresses.as_ref().expect("asked for");
    let most = |of: &[PeakStress]| of.iter().map(|peak| peak.stress).fold(0.0, f64::max);
    let delta = curve.transmission_error_statistics;
    [
        delta.mean,
        delta.peak_to_peak,
        2.0 / count * cosine.hypot(sine),
        curve.mesh_stiffness_tangent_statistics.mean,
        most(&stresses[1].root),
        most(&stresses[1].holes),
    ]
}

/// By what part each of [`numbers`] along the faces is off that of the plane, over so many mesh `periods` of so many `positions`.
fn off_the_plane(pair: [Case; 2], periods: u32, positions: u32) -> [f64; 6] {
    let [plane, faces] = pair.map(|mut case| {
        case.resolution.span_mesh_periods = Some(periods);
        case.resolution.positions_per_mesh_period = positions;
        numbers(&solve(&case))
    });
    std::array::from_fn(|i| faces[i] / plane[i] - 1.0)
}

#[test]
fn holes_near_the_roots_and_near_the_edge_of_a_web_yield_as_in_the_plane() {
    let [solid, ..] = off_the_plane(narrow_pair(|_| {}), 1, 4);
    for blank in [
        narrow_pair(in_rim(34e-3, 9e-3)),
        narrow_pair(in_web(round_holes(8, 33e-3, 8.5e-3))),
    ] {
        let [mean, peak_to_peak, _, stiffness, root, hole] = off_the_plane(blank, 1, 4);
        println!(
            "{mean:.4} ({solid:.4} solid), {peak_to_peak:.4}, {stiffness:.4}, {root:.4}, {hole:.4}"
        );
        assert!((mean - solid).abs() < 3e-3 && peak_to_peak.abs() < 0.015);
        assert!(stiffness.abs() < 5e-3 && root.abs() < 0.03 && hole.abs() < 0.03);
    }
}

#[test]
fn necks_between_holes_near_the_bore_yield_as_in_the_plane() {
    // Necks of 0.75 mm carry the rim on a ring of 0.5 mm: by far the most of δ is the turn of the rim, which the torque alone decides.
    let off = off_the_plane(narrow_pair(in_rim(24.5e-3, 9e-3)), 1, 4);
    println!("{off:.4?}");
    let [mean, peak_to_peak, _, stiffness, root, hole] = off;
    assert!(mean.abs() < 3e-3 && peak_to_peak.abs() < 0.015);
    assert!(stiffness.abs() < 5e-3 && root.abs() < 0.03 && hole.abs() < 0.03);
}

#[test]
#[ignore = "./test all"]
fn holes_near_roots_edges_of_webs_and_the_bore_yield_as_in_the_plane_at_length() {
    let [solid, ..] = off_the_plane(narrow_pair(|_| {}), 6, 8);
    for (name, pair) in [
        ("3.5 mm below the roots", narrow_pair(in_rim(33e-3, 9e-3))),
        ("2.5 mm", narrow_pair(in_rim(34e-3, 9e-3))),
        ("1.5 mm", narrow_pair(in_rim(35e-3, 9e-3))),
        ("1 mm, small", narrow_pair(in_rim(42.5e-3, 2e-3))),
        (
            "the edge of the web",
            narrow_pair(in_web(round_holes(8, 33e-3, 8.5e-3))),
        ),
        ("0.5 mm above the bore", narrow_pair(in_rim(20e-3, 4.5e-3))),
        ("1.5 mm, necks", narrow_pair(in_rim(25e-3, 8.5e-3))),
        ("0.5 mm, thin necks", narrow_pair(in_rim(24.5e-3, 9e-3))),
        (
            "its inner edge",
            narrow_pair(in_web(round_holes(8, 27.5e-3, 7e-3))),
        ),
    ] {
        // By 8 positions an extreme 1.5 mm below the roots is read 2 % too small.
        let off = off_the_plane(pair, 6, 12);
        println!("{name}: {off:.4?} ({solid:.4} solid)");
        let [mean, peak_to_peak, of_holes, _, root, hole] = off;
        assert!((mean - solid).abs() < 3e-3, "{name}");
        assert!(peak_to_peak.abs() < 0.015, "{name}");
        let rest = [of_holes, root, hole];
        assert!(rest.iter().all(|off| off.abs() < 0.03), "{name}");
    }
}

#[test]
#[ignore = "./test all"]
fn the_error_estimate_counts_the_orders_in_which_holes_are_seen() {
    let [_, case] = narrow_pair(in_rim(35e-3, 9e-3));
    let [standard, fine, estimate] = with_estimate(case);
    for i in [0, 1, 2] {
        assert!((fine[i] - standard[i]).abs() < estimate[i], "{i}");
    }
}

#[test]
#[ignore = "./test all"]
fn the_error_estimate_covers_what_the_fine_level_changes() {
    let gears = [20, -20].map(|hand: i32| {
        let mut data = gear(20, 8e-3);
        data.face_width = 12e-3;
        helical(data, f64::from(hand).to_radians(), 0.0)
    });
    let a = 2.0 * gears[0].section().reference_radius() + 0.1e-3;
    let leads = [
        vec![LeadModification::Crowning { amount: 4e-6 }],
        Vec::new(),
    ];
    let pair = SolidPair::new(gears, leads, a, Alignment::default()).expect("meshes");
    let resolution = FaceResolution {
        face_order: 6,
        ..FaceResolution::STANDARD
    };
    let [standard, fine, estimate] =
        with_estimate(along_faces(pair, (resolution, SLICES), &[60.0]));
    let ([delta, _, stiffness], [finer, _, stiffer]) = (standard, fine);
    // Levels differ, and by no more than their estimates.
    assert!((finer / delta - 1.0).abs() > 1e-5);
    assert!((finer - delta).abs() < estimate[0] && estimate[0] < 0.02 * delta);
    assert!((stiffer - stiffness).abs() < estimate[2]);
}

/// The mean of δ, its peak-to-peak and the mean stiffness of `case` at the standard and at the fine level from eight positions, and the errors that the former
/// estimates.
fn with_estimate(mut case: Case) -> [[f64; 3]; 3] {
    case.resolution.positions_per_mesh_period = 8;
    case.resolution.error_estimate = true;
    let standard = solve(&case);
    case.resolution.error_estimate = false;
    case.resolution.grid = GridLevel::Fine;
    let fine = solve(&case);
    assert!(fine.evidence.degrees_of_freedom > 2 * standard.evidence.degrees_of_freedom);
    let estimate = standard.evidence.error_estimate.expect("asked for");
    let of = |analysis: &Analysis| {
        let curve = &analysis.curves[0];
        let delta = curve.transmission_error_statistics;
        [
            delta.mean,
            delta.peak_to_peak,
            curve.mesh_stiffness_tangent_statistics.mean,
        ]
    };
    [
        of(&standard),
        of(&fine),
        [
            estimate.mean,
            estimate.peak_to_peak,
            estimate.mean_stiffness,
        ],
    ]
}

/// Those of `seeds` of which the fine level changes the mean of δ, its peak-to-peak or the mean stiffness by more than the standard one estimates.
fn beyond_the_estimate(seeds: impl Iterator<Item = u64>) -> Vec<u64> {
    let beyond = seeds.filter(|&seed| {
        let (pair, torque) = helical_pair(seed);
        let resolution = FaceResolution {
            face_order: 6,
            ..FaceResolution::STANDARD
        };
        let case = along_faces(pair, (resolution, SLICES / 2), &[torque]);
        let [standard, fine, estimate] = with_estimate(case);
        let parts: [f64; 3] = std::array::from_fn(|i| (fine[i] - standard[i]).abs() / estimate[i]);
        println!("{seed}: {parts:.2?} of {estimate:?} about {standard:?}");
        parts.iter().any(|part| *part > 1.0)
    });
    beyond.collect()
}

#[test]
#[ignore = "./test all"]
fn what_the_fine_level_changes_of_pairs_drawn_at_random_lies_within_the_estimate() {
    // Of the twenty the one whose peak-to-peak comes nearest to its estimate.
    let beyond = beyond_the_estimate(6..7);
    assert!(beyond.is_empty(), "{beyond:?}");
}

#[test]
#[ignore = "three levels of twenty pairs take minutes"]
fn what_the_fine_level_changes_of_pairs_drawn_at_random_lies_within_the_estimate_at_length() {
    let beyond = beyond_the_estimate(0..20);
    assert!(beyond.len() <= 2, "more than one in ten: {beyond:?}");
}

/// How far the contacts of a pair with the usual slices are from those with four times as many.
#[derive(Debug)]
struct Sliced {
    /// What stands above the tenth mesh harmonic of the difference, rms: of δ in meters, of k over its mean.
    above: [f64; 2],
    /// The largest difference of δ over δ.
    delta: f64,
    /// Those of the largest pressure away from kinks, and of that of any slice, as [`apart_from_kinks`].
    pressure: [f64; 2],
    /// That of the largest pressure at a position, and over all positions.
    told: [f64; 2],
}

impl Sliced {
    fn of(seed: u64, positions: usize) -> Self {
        let (pair, torque) = helical_pair(seed);
        let load = pair.section().load(torque);
        let resolution = FaceResolution {
            face_order: 4,
            ..FaceResolution::DRAFT
        };
        let yields = face_yields(&pair, resolution);
        let period: Vec<f64> = (0..positions)
            .map(|i| i as f64 / positions as f64)
            .collect();
        let [usual, fine] = [1, 4].map(|times| {
            let slices = times * SLICES;
            let model = FaceModel::new(pair.clone(), yields.clone(), slices, FARTHEST_COUPLED);
            let solved = model.contacts(load, &period, &Run::unattended());
            solved.expect("a balance at every position")
        });
        let both = || usual.iter().zip(&fine);
        let mean = fine.iter().map(|of| of.mesh.stiffness).sum::<f64>() / positions as f64;
        let above = |value: fn(&FaceContact) -> f64| {
            let apart: Vec<f64> = both().map(|(a, b)| value(a) - value(b)).collect();
            above_the_tenth_harmonic(&apart)
        };
        let most = |of: &dyn Fn(&FaceContact, &FaceContact) -> f64| {
            both().map(|(a, b)| of(a, b)).fold(0.0, f64::max)
        };
        let told = |of: &FaceContact| of.mesh.peak_pressure;
        let largest = |of: &[FaceContact]| of.iter().filter_map(told).fold(0.0, f64::max);
        Self {
            above: [
                above(|of| of.mesh.transmission_error),
                above(|of| of.mesh.stiffness) / mean,
            ],
            delta: most(&|a, b| {
                (a.mesh.transmission_error / b.mesh.transmission_error - 1.0).abs()
            }),
            pressure: [0, 1].map(|i| most(&|a, b| apart_from_kinks(&pair, a, b)[i])),
            told: [
                most(&|a, b| {
                    let both = told(a).zip(told(b));
                    both.map_or(0.0, |(a, b)| (a / b - 1.0).abs())
                }),
                (largest(&usual) / largest(&fine) - 1.0).abs(),
            ],
        }
    }
}

/// How far the pressures of slices of `one` differ from those of `other`, whose shorter slices are averaged over each. Looked at are places within the path and away
/// from kinks. First the largest of all, then that of any slice under at least half of it, over its own pressure.
fn apart_from_kinks(pair: &SolidPair, one: &FaceContact, other: &FaceContact) -> [f64; 2] {
    let section = pair.section();
    let (s_a, s_e) = section.path_of_contact();
    let kinks = Member::BOTH.map(|member| section.gear(member).kinks());
    let tangent = pair.base_helix_angle().tan();
    let is_free = |slice: &&SliceLoad| {
        let is_far = |member: Member, places: &[f64]| {
            let s = slice.roll_lengths[member.index()];
            // A roll length is that much shorter along the flank.
            let along = s / section.gear(member).base_radius();
            let away = 4.0 * slice.half_width / along + slice.length * tangent;
            places.iter().all(|at| (at - s).abs() > away)
        };
        let s = slice.roll_lengths[0];
        let on_path = s_a < s && s < s_e && is_far(Member::Driving, &[s_a, s_e]);
        let mut members = Member::BOTH.into_iter();
        on_path && members.all(|member| is_far(member, &kinks[member.index()]))
    };
    let free: Vec<&SliceLoad> = one.slices.iter().filter(is_free).collect();
    let pressures = free.iter().filter_map(|slice| slice.pressure);
    let largest = pressures.fold(0.0, f64::max);
    // At an end of a contact pressure falls to nothing within one slice.
    let is_pressed = |slice: &&&SliceLoad| slice.pressure > Some(0.5 * largest);
    let apart = free.iter().filter(is_pressed).filter_map(|slice| {
        let (mut sum, mut length) = (0.0, 0.0);
        for within in other.slices.iter().filter(|of| of.pair == slice.pair) {
            let [low, high] = [-0.5, 0.5].map(|half| {
                let end = within.z + half * within.length;
                end.clamp(slice.z - 0.5 * slice.length, slice.z + 0.5 * slice.length)
            });
            if high > low {
                sum += (high - low) * within.pressure?;
                length += high - low;
            }
        }
        Some((slice.pressure?, sum / length))
    });
    let (mut most, mut fine) = (0.0_f64, 0.0_f64);
    for (usual, shorter) in apart {
        most = most.max((usual - shorter).abs() / largest);
        fine = fine.max(shorter);
    }
    [(largest - fine).abs() / largest, most]
}

/// Those of `seeds` whose curves are rougher than asked, at so many positions: 0.3 nm and 0.1 % of the mean above the tenth harmonic, 0.1 % of δ, 1 % of the largest
/// pressure away from kinks and 2 % of the largest of all.
fn rough(seeds: impl Iterator<Item = u64>, positions: usize) -> Vec<String> {
    let of = seeds.map(|seed| {
        let sliced = Sliced::of(seed, positions);
        println!("{seed}: {sliced:?}");
        (seed, sliced)
    });
    let rough = of.filter(|(_, sliced)| {
        let holds = sliced.above[0] < 0.3e-9
            && sliced.above[1] < 1e-3
            && sliced.delta < 1e-3
            && sliced.pressure[0] < 1e-2
            && sliced.pressure[1] < 3e-2
            && sliced.told[1] < 2e-2;
        !holds
    });
    rough
        .map(|(seed, sliced)| format!("{seed}: {sliced:?}"))
        .collect()
}

#[test]
fn an_end_of_a_face_that_carries_a_light_load_alone_balances_at_kinks_and_corners() {
    let gears = [20, 20].map(|teeth| {
        let mut data = gear(teeth, 8e-3);
        data.face_width = 16e-3;
        data.modifications = vec![ModificationData::TipRelief(ReliefData {
            amount: 8e-6,
            shape: ReliefShape::Linear,
            start: ReliefStart::RadialLength(1e-3),
        })];
        helical(data, 0.0, 0.0)
    });
    let alignment = Alignment {
        in_plane: 200e-6,
        ..Alignment::default()
    };
    let leads = [Vec::new(), Vec::new()];
    let pair = SolidPair::new(gears, leads, 40.1e-3, alignment).expect("meshes");
    let resolution = FaceResolution {
        face_order: 6,
        ..FaceResolution::STANDARD
    };
    let (yields, load) = (face_yields(&pair, resolution), pair.section().load(1.0));
    // The last one is where flanks and a corner share the load of 80 slices.
    let period = (0..20)
        .map(|i| f64::from(i) / 20.0)
        .chain([0.625, 0.5628363]);
    let period: Vec<f64> = period.collect();
    for slices in [20, 80] {
        let model = FaceModel::new(pair.clone(), yields.clone(), slices, FARTHEST_COUPLED);
        let solved = model.contacts(load, &period, &Run::unattended());
        assert!(solved.is_ok(), "{slices}: {:?}", solved.err());
    }
}

/// How much farther flanks are pressed in the mean and how much larger the largest pressure away from kinks and corners is with 160 slices than with 40, over
/// both, under `torque` at these positions.
fn with_finer_slices(pair: &SolidPair, torque: f64, face_order: usize, period: &[f64]) -> [f64; 2] {
    let resolution = FaceResolution {
        face_order,
        ..FaceResolution::STANDARD
    };
    let yields = face_yields(pair, resolution);
    let load = pair.section().load(torque);
    let [usual, fine] = [SLICES, 4 * SLICES].map(|slices| {
        let model = FaceModel::new(pair.clone(), yields.clone(), slices, FARTHEST_COUPLED);
        let solved = model.contacts(load, period, &Run::unattended());
        let solved = solved.expect("a balance at every position");
        let pressed = |of: &FaceContact| of.mesh.transmission_error - of.mesh.touch;
        let largest = |most: f64, of: &FaceContact| most.max(of.mesh.smooth_pressure);
        [
            solved.iter().map(pressed).sum::<f64>(),
            solved.iter().fold(0.0, largest),
        ]
    });
    [0, 1].map(|i| fine[i] / usual[i] - 1.0)
}

/// 20/20 straight teeth of 2 mm, 16 mm wide, whose load leans towards one end of the face.
fn leaning(in_plane: f64, change: fn(GearData) -> GearData) -> SolidPair {
    let gears = [20, 20].map(|teeth| {
        let mut data = change(gear(teeth, 8e-3));
        data.face_width = 16e-3;
        helical(data, 0.0, 0.0)
    });
    let alignment = Alignment {
        in_plane,
        ..Alignment::default()
    };
    SolidPair::new(gears, [Vec::new(), Vec::new()], 40.1e-3, alignment).expect("meshes")
}

#[test]
fn the_largest_pressure_at_the_end_of_a_face_settles_with_the_slices() {
    // A little, and with all of it.
    for (in_plane, torque) in [(8e-6, 60.0), (200e-6, 1.0)] {
        let pair = leaning(in_plane, relieved);
        let [delta, pressure] = with_finer_slices(&pair, torque, 6, &[0.0125, 0.2625]);
        println!("{in_plane} {delta} {pressure}");
        assert!(delta.abs() < 1e-3, "{delta}");
        assert!(pressure.abs() < 1e-2, "{pressure}");
    }
}

#[test]
#[ignore = "./test all"]
fn the_largest_pressure_at_the_end_of_a_face_settles_at_every_position() {
    for (in_plane, torque) in [(8e-6, 60.0), (200e-6, 1.0)] {
        for change in [relieved as fn(GearData) -> GearData, |data| data] {
            let pair = leaning(in_plane, change);
            let resolution = FaceResolution {
                face_order: 6,
                ..FaceResolution::STANDARD
            };
            let (yields, load) = (face_yields(&pair, resolution), pair.section().load(torque));
            let positions: Vec<f64> = (0..20).map(|i| f64::from(i) / 20.0).collect();
            let [usual, finer, finest] = [1, 2, 4].map(|times| {
                let slices = times * SLICES;
                let model = FaceModel::new(pair.clone(), yields.clone(), slices, FARTHEST_COUPLED);
                let solved = model.contacts(load, &positions, &Run::unattended());
                solved.expect("a balance at every position")
            });
            for (i, eta) in positions.iter().enumerate() {
                // Where the largest stands at a kink or a corner, the smooth one steps as these enter the half width that it keeps from them.
                let mesh = &finest[i].mesh;
                if mesh.peak_pressure != Some(mesh.smooth_pressure) {
                    continue;
                }
                let [usual, finer, finest] =
                    [&usual, &finer, &finest].map(|of| of[i].mesh.smooth_pressure);
                println!("{in_plane} {eta}: {usual:.4e} {finer:.4e} {finest:.4e}");
                for fewer in [usual, finer] {
                    assert!((fewer / finest - 1.0).abs() < 1e-2, "{in_plane} {eta}");
                }
            }
        }
    }
}

#[test]
#[ignore = "./test all"]
fn the_largest_pressure_of_pairs_drawn_at_random_settles_with_the_slices() {
    let period: Vec<f64> = (0..8).map(|i| (f64::from(i) + 0.05) / 8.0).collect();
    let mut off = 0;
    for seed in 0..10 {
        let mut draw = drawn(seed);
        let mut between = |low: f64, high: f64| low + (high - low) * draw();
        let beta = match seed % 3 {
            0 => 0.0,
            1 => between(4.0, 12.0),
            _ => -between(12.0, 25.0),
        };
        let width = between(8e-3, 24e-3);
        let gears = [1.0, -1.0].map(|hand| {
            let mut data = gear(between(20.0, 50.0) as u32, 8e-3);
            data.face_width = width;
            helical(data, hand * f64::to_radians(beta), 0.0)
        });
        let radii = gears
            .each_ref()
            .map(|gear| gear.section().reference_radius());
        let alignment = Alignment {
            in_plane: between(-30e-6, 30e-6),
            ..Alignment::default()
        };
        let leads = [Vec::new(), Vec::new()];
        let a = radii[0] + radii[1] + 0.1e-3;
        let pair = SolidPair::new(gears, leads, a, alignment).expect("meshes");
        let torque = between(40e3, 250e3) * width / pair.section().load(1.0);
        let [delta, pressure] = with_finer_slices(&pair, torque, 6, &period);
        println!("{seed}: {delta} {pressure}");
        assert!(delta.abs() < 1e-3, "{seed}: {delta}");
        // The half width of the contact that is kept from a kink or a corner ends within a slice.
        assert!(pressure.abs() < 1.5e-2, "{seed}: {pressure}");
        off += u32::from(pressure.abs() > 1e-2);
    }
    assert!(off <= 1, "{off} pairs are off by more than 1 %");
}

#[test]
#[ignore = "./test all"]
fn curves_of_pairs_drawn_at_random_are_as_smooth_as_with_four_times_as_many_slices() {
    let rough = rough(0..2, 40);
    assert!(rough.is_empty(), "{rough:#?}");
}

#[test]
#[ignore = "240 positions of ten pairs with 40 and 160 slices take minutes"]
fn curves_of_pairs_drawn_at_random_are_as_smooth_as_with_four_times_as_many_slices_at_length() {
    let rough = rough(0..10, 240);
    // δ of seed 6 is 0.105 % off at one position; 0.41 and 0.36 nm of seeds 7 and 9 stand above the tenth harmonic.
    assert!(rough.len() <= 3, "{rough:#?}");
}
