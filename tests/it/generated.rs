//! Submissions made from the schema by chance, many of them of examples that chance has changed: whatever validates has results,
//! or a problem that names a field. Some run with the tests, ten thousand by `tests/hostile/run long`.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_wire::{Code, Problem, Submission};
use serde_json::{Map, Value, json};

/// The variable that says how many.
const COUNT: &str = "MESHWRIGHT_GENERATED";

/// What takes longer by its estimate is made smaller first, and left out if it still does.
const LONGEST_S: f64 = 1.0;

/// A xorshift generator: the same submissions in every run.
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end.max(1) as u64) as usize
    }

    pub(crate) fn one_in(&mut self, many: usize) -> bool {
        self.below(many) == 0
    }

    pub(crate) fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.below(1 << 20) as f64 / f64::from((1 << 20) - 1)
    }
}

/// What makes values from the schema.
struct Maker {
    schemas: Map<String, Value>,
    chance: Chance,
}

impl Maker {
    fn new(seed: u64) -> Self {
        let document = serde_json::to_value(meshwright::http::openapi()).unwrap();
        let schemas = document["components"]["schemas"].as_object().unwrap();
        Self {
            schemas: schemas.clone(),
            chance: Chance(seed),
        }
    }

    fn resolved(&self, schema: &Value) -> Value {
        match schema["$ref"].as_str() {
            Some(address) => {
                let name = address.rsplit('/').next().unwrap();
                self.resolved(&self.schemas[name])
            }
            None => schema.clone(),
        }
    }

    /// A value that the schema allows.
    fn value(&mut self, schema: &Value) -> Value {
        let schema = self.resolved(schema);
        if let Some(choices) = schema["oneOf"].as_array() {
            let chosen = choices[self.chance.below(choices.len())].clone();
            return self.value(&chosen);
        }
        if let Some(words) = schema["enum"].as_array() {
            return words[self.chance.below(words.len())].clone();
        }
        let kinds: Vec<&str> = match &schema["type"] {
            Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).collect(),
            Value::String(kind) => vec![kind],
            _ => return Value::Null,
        };
        match kinds[self.chance.below(kinds.len())] {
            "object" => self.object(&schema),
            "array" => {
                let least = schema["minItems"].as_u64().unwrap_or(0) as usize;
                let most = schema["maxItems"]
                    .as_u64()
                    .unwrap_or(4)
                    .min(least as u64 + 4) as usize;
                let count = least + self.chance.below(most - least + 1);
                (0..count).map(|_| self.value(&schema["items"])).collect()
            }
            kind @ ("number" | "integer") => self.number(&schema, kind == "integer"),
            "boolean" => json!(self.chance.one_in(2)),
            "string" => json!("a".repeat(1 + self.chance.below(8))),
            _ => Value::Null,
        }
    }

    /// A number between its bounds, often on one of them.
    fn number(&mut self, schema: &Value, whole: bool) -> Value {
        let bound = |name: &str, other: f64| schema[name].as_f64().unwrap_or(other);
        let (least, most) = (bound("minimum", -1e3), bound("maximum", 1e3));
        let value = match self.chance.below(8) {
            0 => least,
            1 => most,
            // Small ones are more often such as can be made.
            2..=5 => self
                .chance
                .between(least, most.min(least.max(0.0) + 30.0).max(least)),
            _ => self.chance.between(least, most),
        };
        if whole {
            json!(value.round() as i64)
        } else {
            json!(value)
        }
    }

    fn object(&mut self, schema: &Value) -> Value {
        let required: Vec<&str> = schema["required"]
            .as_array()
            .map_or_else(Vec::new, |names| {
                names.iter().filter_map(Value::as_str).collect()
            });
        let empty = Map::new();
        let fields = schema["properties"].as_object().unwrap_or(&empty).clone();
        let mut made = Map::new();
        for (name, schema) in &fields {
            if required.contains(&name.as_str()) || self.chance.one_in(3) {
                made.insert(name.clone(), self.value(schema));
            }
        }
        made.into()
    }

    /// Changes a field somewhere in `document`, which `schema` describes: another value, one that was absent, or null.
    fn change(&mut self, document: &mut Value, schema: &Value) {
        let schema = self.resolved(schema);
        let Some(fields) = schema["properties"].as_object() else {
            *document = self.value(&schema);
            return;
        };
        let Some(object) = document.as_object_mut() else {
            *document = self.value(&schema);
            return;
        };
        let names: Vec<&String> = fields.keys().collect();
        let name = names[self.chance.below(names.len())];
        let field = &fields[name];
        match object.get_mut(name) {
            Some(inner) if inner.is_object() && !self.chance.one_in(6) => {
                // Of several forms the one that fits is asked for by whoever reads it.
                let form = self.resolved(field);
                let forms = form["oneOf"].as_array().cloned().unwrap_or_default();
                let form = forms
                    .into_iter()
                    .map(|form| self.resolved(&form))
                    .find(|form| form["properties"].is_object())
                    .unwrap_or(form);
                self.change(inner, &form);
            }
            _ => {
                let value = self.value(field);
                object.insert(name.clone(), value);
            }
        }
    }
}

/// Computes what validates; the code of its problem, if it has one.
fn compute(document: &Value, library: &Library) -> Result<Option<Code>, String> {
    let code_of = |problem: &Problem| -> Result<Code, String> {
        let names_a_field = !problem.errors.is_empty();
        if names_a_field && problem.code != Code::InternalError {
            Ok(problem.code)
        } else {
            Err(format!("{}: {}", problem.code.slug(), problem.detail))
        }
    };
    let parse = |document: &Value| Submission::parse(document.to_string().as_bytes());
    let mut submission = match parse(document) {
        Ok(submission) => submission,
        Err(problem) => return code_of(&problem).map(Some),
    };
    if meshwright_wire::validate(&submission).estimate.seconds > LONGEST_S {
        let mut smaller = document.clone();
        for (name, value) in [
            ("grid", json!("coarse")),
            ("positions_per_mesh_period", json!(8)),
            ("error_estimate", json!(false)),
            ("span_mesh_periods", json!(1)),
        ] {
            smaller["resolution"][name] = value;
        }
        match parse(&smaller) {
            Ok(made) if meshwright_wire::validate(&made).estimate.seconds <= LONGEST_S => {
                submission = made
            }
            _ => return Ok(None),
        }
    }
    let run = Run::new(Arc::new(AtomicBool::new(false)), |_, _| {});
    match meshwright_wire::solve(&submission, library, &run) {
        Ok(_) => Ok(None),
        Err(problem) => code_of(&problem).map(Some),
    }
}

#[test]
fn whatever_validates_has_results_or_a_problem_that_names_a_field() {
    let count = std::env::var(COUNT).map_or(40, |count| count.parse().unwrap());
    let examples: Vec<Value> = meshwright_wire::examples()
        .iter()
        .filter(|example| example.valid)
        .map(|example| serde_json::from_str(example.json).unwrap())
        .filter(|document: &Value| document.get("base").is_none())
        .collect();
    let mut maker = Maker::new(20_261_122);
    let schema = maker.schemas["Submission"].clone();
    let library = Library::with_capacity(64 << 20);
    let (mut came_to, mut computed) = (BTreeMap::<&str, usize>::new(), 0);
    let mut longest = Duration::ZERO;
    for number in 0..count {
        let document = if maker.chance.one_in(10) {
            maker.value(&schema)
        } else {
            let mut document = examples[maker.chance.below(examples.len())].clone();
            document["resolution"]["grid"] = json!("coarse");
            document["resolution"]["positions_per_mesh_period"] = json!(8);
            for _ in 0..=maker.chance.below(3) {
                maker.change(&mut document, &schema);
            }
            document
        };
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| compute(&document, &library)));
        longest = longest.max(start.elapsed());
        match outcome {
            Ok(Ok(None)) => computed += 1,
            Ok(Ok(Some(code))) => *came_to.entry(code.slug()).or_default() += 1,
            Ok(Err(fault)) => panic!("number {number}: {fault}\n{document}"),
            Err(_) => panic!("number {number} panics\n{document}"),
        }
    }
    println!(
        "{count} submissions: {computed} have results; {came_to:?}; the longest took {longest:?}"
    );
    assert!(
        computed * 10 > count,
        "chance makes too few that can be computed"
    );
}
