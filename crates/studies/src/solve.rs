//! From a submission to results that tell the quantities of each curve by their names.

use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_wire::{Problem, Results, Submission};

use crate::table::name_quantities;

/// Computes `submission` as [`meshwright_wire::solve`](fn@meshwright_wire::solve) does, and names the quantities of each curve.
///
/// # Errors
///
/// As for [`meshwright_wire::solve`](fn@meshwright_wire::solve).
pub fn solve(submission: &Submission, library: &Library, run: &Run) -> Result<Results, Problem> {
    let mut results = meshwright_wire::solve(submission, library, run)?;
    name_quantities(&mut results)?;
    Ok(results)
}

#[cfg(test)]
mod tests {
    use meshwright_wire::testing::submission;
    use serde_json::Value;

    use super::*;
    use crate::table::quantities;

    #[test]
    fn each_curve_tells_every_quantity_by_its_name_in_the_digits_that_stand_elsewhere() {
        let run = Run::unattended();
        let results = solve(&submission("light-load"), &Library::default(), &run).expect("solved");
        let results: Value =
            serde_json::from_str(&results.to_json().expect("finite")).expect("JSON");
        let curves = results["curves"].as_array().expect("curves");
        assert!(!curves.is_empty());
        for curve in curves {
            let told = curve["quantities"].as_object().expect("told");
            for quantity in quantities() {
                assert!(told.contains_key(quantity.name), "{}", quantity.name);
            }
            assert_eq!(told.len(), quantities().count());
            let mut seen = 0;
            for (name, value) in told {
                let pointer = format!("/statistics/{}", name.replace('.', "/"));
                if let Some(there) = curve.pointer(&pointer).filter(|there| there.is_number()) {
                    assert_eq!(there, value, "{name}");
                    seen += 1;
                }
            }
            assert!(seen >= 6, "{seen}");
            assert_eq!(told["contact_ratio"], results["pair"]["contact_ratio"]);
            assert_eq!(told["mass_kg.driven"], results["pair"]["driven"]["mass_kg"]);
            assert_eq!(told["stress.driving.root_mpa"], Value::Null);
        }
    }
}
