//! A thousand pairs as gear programs write them: shifts to four decimals, distances and tip diameters to three, tips shortened, few teeth.

use serde_json::{Value, json};

use crate::testing::parse;
use crate::{Code, Submission};

/// Numbers between 0 and 1, the same on every machine (splitmix64).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^= mixed >> 31;
        (mixed >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn one_of(&mut self, values: &[f64]) -> f64 {
        values[(self.next() * values.len() as f64) as usize]
    }
}

fn printed(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    (value * scale).round() / scale
}

fn involute(angle: f64) -> f64 {
    angle.tan() - angle
}

/// A pair without backlash as a program designs it with all digits, and prints it with few.
fn designed(chance: &mut Chance) -> Value {
    let inch = 25.4 / chance.one_of(&[6.0, 10.0, 12.0, 14.0, 16.0]);
    let module = chance.one_of(&[0.5, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0, inch]);
    let angle_deg = chance.one_of(&[20.0, 20.0, 20.0, 20.0, 25.0, 17.5, 22.5]);
    let helix_deg = chance.one_of(&[0.0, 0.0, 0.0, 12.5, 15.0, 20.0, 23.0556, 30.0]);
    let few = chance.between(8.0, 18.0);
    let usual = chance.between(17.0, 45.0);
    let z_1 = chance.one_of(&[few, usual, usual]).floor();
    let z_2 = (z_1 * chance.between(1.0, 5.0)).floor();
    let (alpha_n, beta) = (f64::to_radians(angle_deg), f64::to_radians(helix_deg));
    let alpha = (alpha_n.tan() / beta.cos()).atan();
    // Few teeth without a shift are undercut.
    let x_1 = chance.between(0.0, 0.5);
    let x_2 = chance.between(-0.1, 0.3);
    // No backlash: inv α_wt = inv α_t + 2 (x_1 + x_2) tan α_n/(z_1 + z_2).
    let wanted = involute(alpha) + 2.0 * (x_1 + x_2) * alpha_n.tan() / (z_1 + z_2);
    let (mut low, mut high) = (0.0, 1.2);
    for _ in 0..100 {
        let middle = f64::midpoint(low, high);
        if involute(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    let reference = module * (z_1 + z_2) / (2.0 * beta.cos());
    let distance = reference * alpha.cos() / f64::midpoint(low, high).cos();
    let shortening = reference + (x_1 + x_2) * module - distance;
    let module = printed(module, 5);
    let allowance = chance.one_of(&[0.0, 0.0, -40.0, -80.0]) * module.sqrt() / 2.0;
    let gear = |z: f64, x: f64| {
        let radius = module * z / (2.0 * beta.cos()) + x * module;
        let mut gear = json!({
            "tooth_count": z, "module_mm": module, "pressure_angle_deg": angle_deg, "profile_shift": printed(x, 4),
            "face_width_mm": printed(10.0 * module, 1),
            "tip_diameter_mm": printed(2.0 * (radius + module - shortening.max(0.0)), 3),
            "blank": { "bore_radius_mm": printed(0.3 * (radius - 1.25 * module), 2) },
        });
        if allowance != 0.0 {
            gear["tooth_thickness_deviation_normal_um"] = json!(printed(allowance, 0));
        }
        gear
    };
    json!({
        "method": if helix_deg == 0.0 { "flexible" } else { "three_dimensional" },
        "pair": {
            "center_distance_mm": printed(distance, 3), "helix_angle_deg": helix_deg,
            "driving": gear(z_1, x_1), "driven": gear(z_2, x_2),
        },
        "output_torques_n_m": [printed(module.powi(3), 3)],
    })
}

#[test]
fn of_a_thousand_pairs_that_programs_write_no_more_than_ten_are_refused_each_for_its_teeth() {
    let mut chance = Chance(1);
    let (mut refused, mut moved_back, mut helical) = (Vec::new(), 0, 0);
    for number in 0..1000 {
        let document = designed(&mut chance);
        helical += u32::from(document["method"] == "three_dimensional");
        match parse(&document) {
            Ok(submission) => moved_back += u32::from(is_moved_back(&submission)),
            Err(problem) => refused.push((number, problem, document)),
        }
    }
    for (number, problem, document) in &refused {
        println!("{number}: {:?}\n{document}", problem.errors);
    }
    assert!(refused.len() <= 10, "{} are refused", refused.len());
    // Teeth that are pointed or too short to go on meshing are no matter of digits.
    let accepted = [
        Code::PointedTip,
        Code::ContactRatioBelowOne,
        Code::Interference,
    ];
    for (number, problem, _) in &refused {
        let code = problem.errors[0].code;
        assert!(accepted.contains(&code), "{number}: {:?}", problem.errors);
    }
    // The table contains enough of the cases that it is for.
    assert!(moved_back > 150 && helical > 300, "{moved_back} {helical}");
}

/// True if printed digits left too little room for the other flanks.
fn is_moved_back(submission: &Submission) -> bool {
    submission.case().pair.moved_back() > 1e-10
}
