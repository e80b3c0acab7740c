//! Hobs with a protuberance.

use meshwright_engine::gear::Protuberance;
use serde_json::{Value, json};

use super::{data_of, fault, with};
use crate::Code;
use crate::testing::{echo, parse};

/// A gear of module 2 with this hob.
fn hob(amount_um: f64, height_mm: f64, grinding_stock_um: f64) -> Value {
    json!({ "dedendum_mm": 2.8, "rack_tip_radius_mm": 0.6, "protuberance": {
        "amount_um": amount_um, "height_mm": height_mm, "grinding_stock_um": grinding_stock_um
    } })
}

#[test]
fn a_protuberance_reaches_the_engine_in_meters_and_no_stock_is_the_default() {
    let expected = Protuberance {
        amount: 220e-6,
        height: 1.5e-3,
        grinding_stock: 120e-6,
    };
    let data = data_of(&hob(220.0, 1.5, 120.0));
    assert_eq!(data.rack.protuberance, Some(expected));
    let bare = json!({ "protuberance": { "amount_um": 100, "height_mm": 1.5 } });
    let found = data_of(&bare).rack.protuberance.expect("said");
    assert_eq!(found.grinding_stock, 0.0);
    assert_eq!(data_of(&json!({})).rack.protuberance, None);
    assert_eq!(
        data_of(&json!({ "protuberance": null })).rack.protuberance,
        None
    );
}

#[test]
fn a_hob_that_cannot_be_is_answered_with_the_nearest_that_can() {
    // Upright: 0.6 (1 + 1/tan 20) - (0.6 - 0.22)/sin 20 = 1.1375 mm.
    for (fields, place, nearest) in [
        (hob(100.0, 1.5, 120.0), "amount_um", 120.0),
        (hob(220.0, 3.0, 120.0), "height_mm", 2.8),
        (hob(220.0, 0.9, 120.0), "height_mm", 1.1375),
    ] {
        let found = fault(&fields, &format!("protuberance/{place}"), Code::OutOfRange);
        let nearest_found = found.nearest.expect("one that would do");
        assert!(
            (nearest_found - nearest).abs() < 1e-4 * nearest,
            "{found:?}"
        );
    }
    let none = json!({ "protuberance": { "height_mm": 1.0 } });
    fault(&none, "protuberance/amount_um", Code::MissingField);
}

#[test]
fn a_gear_without_a_protuberance_is_written_without_the_word() {
    let written = |fields: &Value| {
        let submission = parse(&with(fields)).expect("valid");
        echo(&submission)["pair"]["driving"].clone()
    };
    assert!(written(&json!({})).get("protuberance").is_none());
    assert_eq!(
        written(&hob(220.0, 1.5, 120.0))["protuberance"],
        json!({ "amount_um": 220.0, "height_mm": 1.5, "grinding_stock_um": 120.0 })
    );
}
