//! Places of the fields of a submission, for names that stand at another one.

use std::cmp::Reverse;
use std::sync::LazyLock;

use serde_json::{Map, Value};

use super::SubmissionDocument;
use crate::declare::Object as _;
use crate::problem::{Code, FieldError};

/// Objects within each other, at most.
const DEEPEST: usize = 8;

/// A beginning of a name that is shorter tells nothing.
const SHORTEST: usize = 4;

/// Symbols of ISO 21771 and of elasticity, without indices of a gear, and the fields that they stand for.
const SYMBOLS: [(&str, &str); 24] = [
    ("z", "tooth_count"),
    ("m", "module_mm"),
    ("mn", "module_mm"),
    ("alpha", "pressure_angle_deg"),
    ("alphan", "pressure_angle_deg"),
    ("beta", "helix_angle_deg"),
    ("a", "center_distance_mm"),
    ("aw", "center_distance_mm"),
    ("x", "profile_shift"),
    ("b", "face_width_mm"),
    ("da", "tip_diameter_mm"),
    ("df", "root_diameter_mm"),
    ("ca", "amount_um"),
    ("hap", "addendum_mm"),
    ("hfp", "dedendum_mm"),
    ("rhofp", "rack_tip_radius_mm"),
    ("wk", "span_measurement"),
    ("mdk", "ball_measurement"),
    ("t", "output_torques_n_m"),
    ("t2", "output_torques_n_m"),
    ("torque", "output_torques_n_m"),
    ("e", "youngs_modulus_gpa"),
    ("nu", "poisson_ratio"),
    ("rho", "density_kg_m3"),
];

/// The names of all fields that stand in no list, with their places.
static PLACES: LazyLock<Vec<(String, String)>> = LazyLock::new(|| {
    let mut named = Vec::new();
    SubmissionDocument::name_fields(&mut named);
    let named = named.into_iter();
    let schemas: Map<String, Value> = named.map(|(name, of)| (name.to_owned(), of)).collect();
    let mut places = Vec::new();
    add(
        &SubmissionDocument::json_schema(),
        "",
        &schemas,
        &mut places,
    );
    places
});

/// Adds the fields of `schema`, which stands at `place`.
fn add(
    schema: &Value,
    place: &str,
    schemas: &Map<String, Value>,
    places: &mut Vec<(String, String)>,
) {
    if place.matches('/').count() > DEEPEST {
        return;
    }
    let named = schema["$ref"]
        .as_str()
        .and_then(|name| name.rsplit('/').next());
    if let Some(named) = named.and_then(|name| schemas.get(name)) {
        add(named, place, schemas, places);
    }
    for of in ["allOf", "anyOf", "oneOf"] {
        for part in schema[of].as_array().into_iter().flatten() {
            add(part, place, schemas, places);
        }
    }
    for (name, field) in schema["properties"].as_object().into_iter().flatten() {
        let place = format!("{place}/{name}");
        places.push((name.clone(), place.clone()));
        add(field, &place, schemas, places);
    }
}

/// The `error`; one of a field that is not known where it stands points to the place of such a field, if there is one.
pub(crate) fn pointing(error: FieldError) -> FieldError {
    const ASKS: &str = " meant?";
    if error.code != Code::UnknownField || error.detail.contains(ASKS) {
        return error;
    }
    let Some(place) = place_for(&error.pointer) else {
        return error;
    };
    let detail = format!("{} Is {place}{ASKS}", error.detail);
    FieldError { detail, ..error }
}

/// The place of a field that the name at the end of `pointer` means; of several the one nearest to `pointer`. The name is that of the field, its beginning, a
/// symbol for it, or says diameter for radius.
fn place_for(pointer: &str) -> Option<&'static str> {
    let (_, name) = pointer.rsplit_once('/')?;
    let plain = name.to_lowercase().replace('_', "");
    let symbol = SYMBOLS.iter().find(|(symbol, _)| *symbol == plain);
    let radius = name.replace("diameter", "radius");
    let is_meant = |known: &str| {
        let begins = known.strip_prefix(name).filter(|_| name.len() >= SHORTEST);
        known == name
            || known == radius
            || begins.is_some_and(|rest| rest.starts_with('_'))
            || symbol.is_some_and(|(_, meant)| *meant == known)
    };
    let common = |place: &str| {
        let steps = place.split('/').zip(pointer.split('/'));
        steps.take_while(|(a, b)| a == b).count()
    };
    let near = PLACES.iter().filter(|(known, _)| is_meant(known));
    let nearest =
        near.min_by_key(|(known, place)| (known != name, Reverse(common(place)), place.len()));
    nearest.map(|(_, place)| place.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symbol_stands_for_a_field_that_there_is() {
        for (symbol, field) in SYMBOLS {
            let known = PLACES.iter().any(|(known, _)| known == field);
            assert!(known, "{symbol}: {field}");
        }
    }
}
