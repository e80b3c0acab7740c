//! Documents that chance has changed: advice leads to a submission, and nothing gets past a problem.

use serde_json::{Value, json};

use super::Submission;
use crate::testing::{filled_in, parse, put};

/// A xorshift generator: the same numbers in every run.
struct Chance(u64);

impl Chance {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end as u64) as usize
    }
}

fn pointers(value: &Value, here: String, all: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                let pointer = format!("{here}/{key}");
                all.push(pointer.clone());
                pointers(value, pointer, all);
            }
        }
        Value::Array(items) => {
            for (i, value) in items.iter().enumerate() {
                let pointer = format!("{here}/{i}");
                all.push(pointer.clone());
                pointers(value, pointer, all);
            }
        }
        _ => {}
    }
}

/// Follows the advice of every problem until there is none, and says whether it led to a submission; `None` where a
/// problem has no advice.
fn follow_advice(document: &mut Value) -> Option<bool> {
    const MOST_ROUNDS: usize = 6;
    for _ in 0..MOST_ROUNDS {
        let Err(problem) = parse(document) else {
            return Some(true);
        };
        for error in &problem.errors {
            put(document, &error.pointer, json!(error.nearest?));
        }
    }
    Some(false)
}

#[test]
fn whoever_follows_the_advice_arrives_at_a_submission() {
    advice_leads_from(&filled_in("test-case-2"), 4000);
}

#[test]
fn whoever_follows_the_advice_on_real_teeth_arrives_at_a_submission() {
    let mut whole = filled_in("profile-modifications");
    let driving = filled_in("tip-diameter")["pair"]["driving"].clone();
    for name in [
        "addendum_mm",
        "tip_diameter_mm",
        "tooth_thickness_deviation_um",
    ] {
        whole["pair"]["driving"][name] = driving[name].clone();
    }
    let edges = filled_in("tip-edges");
    let eccentric = filled_in("eccentricity");
    whole["pair"]["driving"]["tip_rounding_mm"] =
        edges["pair"]["driving"]["tip_rounding_mm"].clone();
    whole["pair"]["driven"]["tip_chamfer_mm"] = edges["pair"]["driven"]["tip_chamfer_mm"].clone();
    whole["pair"]["driven"]["tooth_deviations"] =
        eccentric["pair"]["driven"]["tooth_deviations"].clone();
    advice_leads_from(&whole, 2000);
}

/// Changes a number or two of `whole`, `times` times, and follows the advice.
fn advice_leads_from(whole: &Value, times: usize) {
    let mut chance = Chance(0x2545_f491_4f6c_dd1d);
    let mut places = Vec::new();
    pointers(whole, String::new(), &mut places);
    places.retain(|place| whole.pointer(place).is_some_and(Value::is_number));
    let mut led = 0;
    for _ in 0..times {
        let mut document = whole.clone();
        for _ in 0..=chance.below(2) {
            let target = document
                .pointer_mut(&places[chance.below(places.len())])
                .expect("a place");
            let number = target.as_f64().expect("a number");
            let sign = if chance.below(8) == 0 { -1.0 } else { 1.0 };
            *target = json!(sign * number * 1.1_f64.powi(chance.below(60) as i32 - 30));
        }
        let sent = document.clone();
        // Two values together may leave no way out that changes only the fields at fault.
        if let Some(arrived) = follow_advice(&mut document) {
            assert!(arrived, "{sent}\n{document}\n{:?}", parse(&document));
            led += 1;
        }
    }
    assert!(4 * led > 3 * times, "advice is the rule: {led} of {times}");
}

#[test]
fn no_change_of_a_document_gets_past_a_problem_or_a_submission() {
    survives_changes(&filled_in("test-case-2"), 4000);
    for real in [
        "tip-diameter",
        "tip-edges",
        "profile-modifications",
        "eccentricity",
        "interface-radii",
        "web",
        "unequal-holes",
        "slots",
    ] {
        survives_changes(&filled_in(real), 1000);
    }
    survives_changes(&filled_in("pitch-deviations"), 500);
}

/// Puts odd values into `whole`, and breaks its text, so many times.
fn survives_changes(whole: &Value, times: usize) {
    let odd = [
        json!(null),
        json!(true),
        json!(""),
        json!([]),
        json!({}),
        json!([[[]]]),
        json!(0),
        json!(-1),
        json!(1),
        json!(1e308),
        json!(-1e308),
        json!(5e-324),
        json!(u64::MAX),
        json!(i64::MIN),
        json!(0.5),
        json!(7.77),
        json!(300),
        json!(1e5),
        json!("flexible"),
        json!({ "count": 3 }),
    ];
    let mut chance = Chance(0x9e37_79b9_7f4a_7c15);
    let mut places = Vec::new();
    pointers(whole, String::new(), &mut places);
    for _ in 0..times {
        let mut document = whole.clone();
        for _ in 0..=chance.below(3) {
            let place = &places[chance.below(places.len())];
            let Some(target) = document.pointer_mut(place) else {
                continue;
            };
            let value = match (target.as_f64(), chance.below(3)) {
                (Some(number), 0) => json!(number * 1.1_f64.powi(chance.below(40) as i32 - 20)),
                _ => odd[chance.below(odd.len())].clone(),
            };
            *target = value;
        }
        if let Err(problem) = parse(&document) {
            assert_eq!(problem.status, 422);
            assert!(!problem.errors.is_empty(), "{problem:?}");
            for error in &problem.errors {
                assert!(error.nearest.is_none_or(f64::is_finite), "{error:?}");
            }
        }
    }
    let text = whole.to_string().into_bytes();
    for _ in 0..times {
        let mut bytes = text.clone();
        for _ in 0..=chance.below(4) {
            let at = chance.below(bytes.len());
            match chance.below(3) {
                0 => bytes[at] = chance.below(256) as u8,
                1 => bytes.truncate(at.max(1)),
                _ => bytes.insert(at, b"{}[]\",:0-.e"[chance.below(11)]),
            }
        }
        if let Err(problem) = Submission::parse(&bytes) {
            assert!([400, 422].contains(&problem.status));
        }
    }
}
