//! The load distribution: what its formulas must show, on the gears of the paper and on gears drawn at random.

mod cases;

use cases::{case, gear, pair};
use meshwright_engine::analysis::{
    Analysis, BodyFormula, Case, Curve, FormulaQuantity, Formulas, Model, PlaneState,
    StiffnessRule, ToothFormula, Warning, analyze,
};
use meshwright_engine::gear::{
    GearData, GearPair, Material, ModificationData, ReliefData, ReliefShape, ReliefStart, SpurGear,
};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

/// What the service presets.
const USUAL: Formulas = Formulas {
    tooth: ToothFormula::WeberBanaschek,
    body: BodyFormula::Sainsot,
    plane_state: PlaneState::Stress,
};
const ISO: Formulas = Formulas {
    tooth: ToothFormula::Iso6336,
    ..USUAL
};
/// What ISO's fit was made from.
const HALF_PLANE: Formulas = Formulas {
    body: BodyFormula::HalfPlane,
    plane_state: PlaneState::Strain,
    ..USUAL
};
/// Pairs that each invariant is tried on.
const DRAWN: usize = 150;
/// Positions of a mesh period on drawn pairs.
const POSITIONS: u32 = 12;

fn solve(case: &Case) -> Analysis {
    analyze(case, &Library::default(), &Run::unattended())
        .unwrap_or_else(|error| panic!("{error}: {case:?}"))
}

fn asked(pair: GearPair, formulas: Formulas, output_torque: f64) -> Case {
    let mut case = case(pair, &[output_torque]);
    case.model = Model::Formulas(formulas);
    case
}

fn curve(pair: GearPair, formulas: Formulas, output_torque: f64) -> Curve {
    let mut case = asked(pair, formulas, output_torque);
    case.resolution.positions_per_mesh_period = POSITIONS;
    solve(&case).curves.remove(0)
}

/// The peak pressure at position `i`: lines of contact have no corners.
fn pressure(curve: &Curve, i: usize) -> f64 {
    curve.peak_contact_pressure[i].expect("a pressure at every position")
}

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a / b - 1.0).abs() < tolerance
}

/// Two gears, their center distance and an output torque.
#[derive(Debug, Clone)]
struct Drawing {
    driving: GearData,
    driven: GearData,
    center_distance: f64,
    output_torque: f64,
}

impl Drawing {
    fn pair(&self) -> Option<GearPair> {
        let driving = SpurGear::new(self.driving.clone()).ok()?;
        let driven = SpurGear::new(self.driven.clone()).ok()?;
        GearPair::new(driving, driven, self.center_distance).ok()
    }

    fn curve(&self, formulas: Formulas) -> Curve {
        let pair = self
            .pair()
            .unwrap_or_else(|| panic!("does not mesh: {self:?}"));
        curve(pair, formulas, self.output_torque)
    }

    fn changed(self, change: impl Fn(&mut GearData)) -> Self {
        let mut changed = self;
        change(&mut changed.driving);
        change(&mut changed.driven);
        changed
    }
}

/// A seeded linear congruential generator (Knuth's MMIX constants), so that every run draws the same gears.
struct Numbers(u64);

impl Numbers {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn decade(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn gear(&mut self, module: f64, pressure_angle: f64) -> GearData {
        let mut data = gear(self.decade(15.0, 151.0) as u32, 0.0);
        data.rack.module = module;
        data.rack.pressure_angle = pressure_angle;
        data.rack.addendum = module;
        data.rack.dedendum = 1.25 * module;
        data.rack.tip_radius = self.between(0.1, 0.38) * module;
        data.profile_shift = self.between(-0.5, 0.8);
        data.face_width = self.decade(3.0, 20.0) * module;
        data.material.youngs_modulus = self.decade(3e9, 210e9);
        data.material.poisson_ratio = self.between(0.2, 0.45);
        let root_radius = module * (f64::from(data.tooth_count) / 2.0 - 1.25 + data.profile_shift);
        data.blank.bore_radius = self.between(0.15, 0.8) * root_radius;
        if self.between(0.0, 1.0) < 0.5 {
            data.modifications = vec![ModificationData::TipRelief(ReliefData {
                amount: self.between(1e-3, 1e-2) * module,
                shape: ReliefShape::Linear,
                start: ReliefStart::RadialLength(self.between(0.2, 0.9) * module),
            })];
        }
        data
    }

    /// Two gears with a little backlash under 10 to 1000 N/mm of steel, or as much less as their moduli are.
    fn drawing(&mut self) -> Drawing {
        let module = self.decade(0.5e-3, 10e-3);
        let alpha = self.between(15.0, 25.0).to_radians();
        let [driving, driven] = [self.gear(module, alpha), self.gear(module, alpha)];
        let z = f64::from(driving.tooth_count + driven.tooth_count);
        // Without backlash inv α_w = inv α + 2 (x_1 + x_2) tan α/(z_1 + z_2); each module more gives some 2 sin α of it.
        let shifts = driving.profile_shift + driven.profile_shift;
        let target = alpha.tan() - alpha + 2.0 * shifts * alpha.tan() / z;
        let (mut low, mut high) = (0.0_f64, 1.2_f64);
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if middle.tan() - middle < target {
                low = middle
            } else {
                high = middle
            }
        }
        let closed = module * z / 2.0 * alpha.cos() / low.cos();
        let [e_1, e_2] = [driving.clone(), driven.clone()].map(|data| data.material.youngs_modulus);
        // As teeth bear in proportion to their size.
        let line_load = self.decade(5e6, 250e6) * module * 2.0 / (1.0 / e_1 + 1.0 / e_2) / 210e9;
        let width = driving.face_width.min(driven.face_width);
        let base_radius = module * f64::from(driven.tooth_count) / 2.0 * alpha.cos();
        Drawing {
            driving,
            driven,
            center_distance: closed + self.between(0.02, 0.2) * module,
            output_torque: line_load * width * base_radius,
        }
    }

    /// As many drawings that mesh as each invariant is tried on.
    fn drawings(seed: u64) -> Vec<Drawing> {
        let mut numbers = Self(seed);
        let mut drawn = 0;
        let drawings: Vec<Drawing> = std::iter::repeat_with(|| {
            drawn += 1;
            numbers.drawing()
        })
        .filter(|drawing| drawing.pair().is_some())
        .take(DRAWN)
        .collect();
        println!("{DRAWN} pairs that mesh, of {drawn} drawn from seed {seed}");
        drawings
    }
}

#[test]
fn forces_in_proportion_to_the_modulus_deflect_by_the_same_amount() {
    for formulas in [USUAL, ISO] {
        let mean = |modulus: f64| {
            let mut data = gear(50, 15e-3);
            data.material.youngs_modulus = modulus;
            let case = asked(
                pair(data.clone(), data, 100.5e-3),
                formulas,
                115.0 * modulus / 210e9,
            );
            solve(&case).curves[0].transmission_error_statistics.mean
        };
        let steel = mean(210e9);
        for modulus in [70e9, 3e9] {
            let other = mean(modulus);
            assert!(
                near(other, steel, 1e-12),
                "{formulas:?}, {modulus} Pa: {other} for {steel} m"
            );
        }
    }
}

#[test]
fn a_wheel_with_more_shift_than_its_pinion_is_computed_and_flagged() {
    let shifted = |z: u32, x: f64| GearData {
        profile_shift: x,
        ..gear(z, 10e-3)
    };
    let solved = |x_1, x_2| {
        let pair = pair(shifted(30, x_1), shifted(60, x_2), 90.9e-3);
        let mut analysis = solve(&asked(pair, ISO, 300.0));
        (analysis.curves.remove(0), analysis.warnings)
    };
    let (within, no_warnings) = solved(0.2, 0.1);
    assert_eq!(no_warnings, []);
    let (outside, warnings) = solved(0.1, 0.2);
    let [Warning::FormulaRange(found)] = warnings[..] else {
        panic!("{warnings:?}")
    };
    assert_eq!(found.quantity, FormulaQuantity::ShiftDifference);
    assert!((found.value + 0.1).abs() < 1e-12 && found.least == 0.0);
    // The fit goes on smoothly: the same shift on the other gear changes little.
    let mean = |curve: &Curve| curve.mesh_stiffness_tangent_statistics.mean;
    assert!(near(mean(&outside), mean(&within), 0.05));
}

#[test]
fn a_torque_step_is_taken_where_it_is_asked_for() {
    // The central difference of 1 % is off by (1 %)² of the curvature of Hertz's law.
    let data = gear(50, 15e-3);
    let mut case = asked(pair(data.clone(), data, 100.5e-3), USUAL, 115.0);
    let tangent = solve(&case).curves.remove(0);
    case.resolution.stiffness = StiffnessRule::TorqueStep { fraction: 0.01 };
    let stepped = solve(&case).curves.remove(0);
    assert_ne!(
        tangent.mesh_stiffness_tangent,
        stepped.mesh_stiffness_tangent
    );
    assert_eq!(tangent.transmission_error, stepped.transmission_error);
    for (a, b) in tangent
        .mesh_stiffness_tangent
        .iter()
        .zip(&stepped.mesh_stiffness_tangent)
    {
        assert!(near(*a, *b, 1e-4), "{a} {b}");
    }
}

#[test]
fn gears_of_another_size_under_torques_by_its_cube_deflect_by_the_size() {
    for drawing in Numbers::drawings(1) {
        for formulas in [USUAL, HALF_PLANE, ISO] {
            let curve = drawing.curve(formulas);
            for s in [0.1, 7.0] {
                let mut sized = drawing.clone().changed(|data| {
                    let rack = &mut data.rack;
                    for length in [
                        &mut rack.module,
                        &mut rack.addendum,
                        &mut rack.dedendum,
                        &mut rack.tip_radius,
                        &mut data.face_width,
                        &mut data.blank.bore_radius,
                    ] {
                        *length *= s;
                    }
                    if let [ModificationData::TipRelief(relief)] = &mut data.modifications[..] {
                        relief.amount *= s;
                        if let ReliefStart::RadialLength(length) = &mut relief.start {
                            *length *= s;
                        }
                    }
                });
                sized.center_distance *= s;
                sized.output_torque *= s * s * s;
                let other = sized.curve(formulas);
                for i in 0..POSITIONS as usize {
                    let ratio = other.transmission_error[i] / curve.transmission_error[i];
                    assert!(
                        near(ratio, s, 1e-9),
                        "{s}, position {i}: {ratio} {drawing:?}"
                    );
                    // k goes with the width, p with nothing.
                    let ratio = other.mesh_stiffness_tangent[i] / curve.mesh_stiffness_tangent[i];
                    assert!(
                        near(ratio, s, 1e-6),
                        "{s}, position {i}: {ratio} {drawing:?}"
                    );
                    assert!(near(pressure(&other, i), pressure(&curve, i), 1e-6));
                }
            }
        }
    }
}

#[test]
fn moduli_and_torque_scaled_alike_change_no_deflection() {
    for drawing in Numbers::drawings(2) {
        for formulas in [USUAL, HALF_PLANE, ISO] {
            let curve = drawing.curve(formulas);
            let mut scaled = drawing
                .clone()
                .changed(|data| data.material.youngs_modulus *= 0.03);
            scaled.output_torque *= 0.03;
            let other = scaled.curve(formulas);
            for (a, b) in curve
                .transmission_error
                .iter()
                .zip(&other.transmission_error)
            {
                assert!(near(*a, *b, 1e-9), "{a} {b} {drawing:?}");
            }
        }
    }
}

#[test]
fn widths_and_torque_scaled_alike_change_no_deflection() {
    for drawing in Numbers::drawings(3) {
        for formulas in [USUAL, HALF_PLANE, ISO] {
            let curve = drawing.curve(formulas);
            let mut scaled = drawing.clone().changed(|data| data.face_width *= 2.5);
            scaled.output_torque *= 2.5;
            let other = scaled.curve(formulas);
            for (a, b) in curve
                .transmission_error
                .iter()
                .zip(&other.transmission_error)
            {
                assert!(near(*a, *b, 1e-9), "{a} {b} {drawing:?}");
            }
        }
    }
}

#[test]
fn the_wider_gear_made_wider_stiffens_itself_and_leaves_the_contact_where_it_was() {
    for drawing in Numbers::drawings(4) {
        let mut wider = drawing.clone();
        let gear = if drawing.driving.face_width < drawing.driven.face_width {
            &mut wider.driven
        } else {
            &mut wider.driving
        };
        gear.face_width *= 1.5;
        let (curve, other) = (drawing.curve(USUAL), wider.curve(USUAL));
        for i in 0..POSITIONS as usize {
            assert!(
                other.transmission_error[i] < curve.transmission_error[i],
                "{drawing:?}"
            );
            // One pair alone carries the same load on the same width.
            if curve.pairs_in_contact[i] == 1 && other.pairs_in_contact[i] == 1 {
                assert!(near(pressure(&other, i), pressure(&curve, i), 1e-12));
            }
        }
        let (iso, iso_wider) = (drawing.curve(ISO), wider.curve(ISO));
        assert_eq!(iso.transmission_error, iso_wider.transmission_error);
    }
}

#[test]
fn a_pair_turned_round_deflects_by_the_mirrored_curve() {
    // The driven gear drives, under the same load along the line of action: what happened at η happens at −η.
    for drawing in Numbers::drawings(5) {
        let pair = drawing.pair().expect("meshes");
        let ratio = pair.driving().base_radius() / pair.driven().base_radius();
        let turned = Drawing {
            driving: drawing.driven.clone(),
            driven: drawing.driving.clone(),
            output_torque: drawing.output_torque * ratio,
            ..drawing
        };
        for formulas in [USUAL, HALF_PLANE, ISO] {
            let (curve, other) = (drawing.curve(formulas), turned.curve(formulas));
            let n = POSITIONS as usize;
            for i in 0..n {
                let (a, b) = (
                    curve.transmission_error[i],
                    other.transmission_error[(n - i) % n],
                );
                assert!(near(a, b, 1e-9), "position {i}: {a} {b} {drawing:?}");
            }
        }
    }
}

#[test]
fn more_torque_deflects_more_and_presses_harder() {
    for drawing in Numbers::drawings(6) {
        for formulas in [USUAL, HALF_PLANE, ISO] {
            let curves = [0.1, 0.9, 1.0, 3.0].map(|factor| {
                let mut drawing = drawing.clone();
                drawing.output_torque *= factor;
                drawing.curve(formulas)
            });
            for pair in curves.windows(2) {
                for i in 0..POSITIONS as usize {
                    assert!(pair[1].transmission_error[i] > pair[0].transmission_error[i]);
                    assert!(pair[1].peak_contact_pressure[i] > pair[0].peak_contact_pressure[i]);
                }
            }
        }
    }
}

#[test]
fn every_number_is_finite_and_positive_whatever_is_asked_for() {
    let mut outside = 0;
    let all: Vec<Formulas> = [ToothFormula::WeberBanaschek, ToothFormula::Iso6336]
        .into_iter()
        .flat_map(|tooth| {
            [
                BodyFormula::Sainsot,
                BodyFormula::HalfPlane,
                BodyFormula::Rigid,
            ]
            .map(|body| (tooth, body))
        })
        .flat_map(|(tooth, body)| {
            [PlaneState::Stress, PlaneState::Strain].map(|plane_state| Formulas {
                tooth,
                body,
                plane_state,
            })
        })
        .collect();
    for drawing in Numbers::drawings(7) {
        for &formulas in &all {
            let mut case = asked(drawing.pair().expect("meshes"), formulas, 1.0);
            case.resolution.positions_per_mesh_period = POSITIONS;
            // A hundred thousand times what the teeth bear deflects them by more than a quarter of a module.
            case.output_torques = vec![1e5 * drawing.output_torque];
            let refused = analyze(&case, &Library::default(), &Run::unattended());
            assert!(refused.is_err(), "{drawing:?}");
            case.output_torques = [1e-9, 1.0].map(|f| f * drawing.output_torque).to_vec();
            let analysis = solve(&case);
            outside += usize::from(!analysis.warnings.is_empty());
            for curve in &analysis.curves {
                let sound = |values: &[f64]| values.iter().all(|v| v.is_finite() && *v > 0.0);
                assert!(sound(&curve.transmission_error), "{drawing:?}");
                assert!(sound(&curve.mesh_stiffness_tangent), "{drawing:?}");
                assert!(sound(&curve.mesh_stiffness_secant), "{drawing:?}");
                let pressures: Vec<f64> = (0..curve.mesh_position.len())
                    .map(|i| pressure(curve, i))
                    .collect();
                assert!(sound(&pressures), "{drawing:?}");
                for i in 0..curve.mesh_position.len() {
                    let shares: f64 = curve.load_shares.iter().map(|share| share.share[i]).sum();
                    assert!((shares - 1.0).abs() < 1e-9, "{shares} {drawing:?}");
                }
            }
            assert!(analysis.evidence.equilibrium_residual < 1e-9);
        }
    }
    println!("{outside} of {} cases with a warning", DRAWN * all.len());
}

/// The mean secant stiffness by ISO's single stiffness over that by the sum of the parts.
fn iso_over_parts(drawing: &Drawing) -> f64 {
    let mean = |formulas| {
        let secant = drawing.curve(formulas).mesh_stiffness_secant;
        secant.iter().sum::<f64>()
    };
    mean(ISO) / mean(HALF_PLANE)
}

#[test]
fn isos_stiffness_lies_above_the_sum_of_the_parts_by_as_much_as_the_stiffest_position_does() {
    // q' was fitted to sums like these, of steel gears with x_1 ≥ x_2. It is that of the stiffest position and stands for
    // all of them, so that the mean over the path of contact lies above the mean of the sums.
    let ratios: Vec<f64> = Numbers::drawings(8)
        .into_iter()
        .filter_map(|drawing| {
            let steel = drawing.changed(|data| {
                data.material = Material::STEEL;
                data.modifications.clear();
                data.face_width = 20.0 * data.rack.module;
            });
            let mut gears = [steel.driving.clone(), steel.driven.clone()];
            gears.sort_by_key(|data| data.tooth_count);
            let [x_1, x_2] = gears.map(|data| data.profile_shift);
            (x_1 >= x_2 && x_1 + x_2 >= -0.5).then_some(steel)
        })
        .map(|mut steel| {
            // 300 N/mm at a module of 10 mm, and as much less as the gears are smaller.
            let line_load = 300e3 * steel.driving.rack.module / 10e-3;
            let radius = steel.pair().expect("meshes").driven().base_radius();
            steel.output_torque = line_load * steel.driven.face_width * radius;
            iso_over_parts(&steel)
        })
        .collect();
    let (least, most) = ends(&ratios);
    println!("{} pairs, from {least} to {most}", ratios.len());
    assert!(ratios.len() > 50 && least > 1.0 && most < 1.4);
}

#[test]
fn isos_stiffness_and_the_sum_of_the_parts_lie_within_a_factor_of_1_7_on_any_gears_of_one_width() {
    // ISO's stiffness is that of the common width; the sum of the parts also knows what stands beside it.
    let ratios: Vec<f64> = Numbers::drawings(9)
        .into_iter()
        .map(|drawing| {
            let width = f64::min(drawing.driving.face_width, drawing.driven.face_width);
            iso_over_parts(&drawing.changed(|data| data.face_width = width))
        })
        .collect();
    let (least, most) = ends(&ratios);
    println!("from {least} to {most}");
    assert!(least > 1.0 / 1.7 && most < 1.7);
}

fn ends(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, 0.0), |(least, most), &v| {
            (f64::min(least, v), f64::max(most, v))
        })
}
