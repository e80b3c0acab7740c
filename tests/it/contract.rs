//! The contract that is committed is the one that is served, and the parts know each other in one direction only.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use reqwest::Method;
use serde_json::Value;

use crate::bench::Bench;

pub(super) fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_clients_have_the_version_of_the_service() {
    let version = env!("CARGO_PKG_VERSION");
    for (file, line) in [
        (
            "typescript/package.json",
            format!("\"version\": \"{version}\""),
        ),
        ("python/pyproject.toml", format!("version = \"{version}\"")),
    ] {
        let text = fs::read_to_string(root().join("clients").join(file)).unwrap();
        assert!(text.contains(&line), "{file}: {line}");
    }
}

#[test]
fn the_committed_openapi_document_is_the_generated_one() {
    let path = root().join("api/openapi.json");
    let generated = format!("{:#}\n", meshwright::http::openapi());
    // Writing it anew is one command: MESHWRIGHT_WRITE_OPENAPI=1 ./test contract
    if std::env::var_os("MESHWRIGHT_WRITE_OPENAPI").is_some() {
        fs::write(&path, &generated).unwrap();
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == generated,
        "api/openapi.json is stale: run MESHWRIGHT_WRITE_OPENAPI=1 ./test contract"
    );
}

#[tokio::test]
async fn what_operations_show_to_send_works_as_it_stands() {
    let bench = Bench::quick().await;
    let document = meshwright::http::openapi();
    let mut sent = Vec::new();
    for (path, item) in document["paths"].as_object().unwrap() {
        let Some(contents) = item["post"]["requestBody"]["content"].as_object() else {
            continue;
        };
        let examples = contents.values().map(|content| &content["example"]);
        assert!(
            examples.into_iter().any(|shown| !shown.is_null()),
            "{path} shows nothing"
        );
        for (media_type, content) in contents {
            let shown = &content["example"];
            // Other containers of a model hold what its XML shows.
            if shown.is_null() {
                continue;
            }
            // Where messages may go the operator says, and which job is meant the client.
            if path == "/v1/webhooks" || path.contains('{') {
                continue;
            }
            let body = match shown.as_str() {
                Some(text) => text.to_owned(),
                None => shown.to_string(),
            };
            let request = bench
                .send(&shown_address(path, &item["post"]))
                .header("content-type", media_type)
                .body(body);
            let answer = request.send().await.unwrap();
            let status = answer.status();
            assert!(
                status.is_success(),
                "{path}: {status} {}",
                answer.text().await.unwrap()
            );
            sent.push(path.as_str());
        }
    }
    assert!(sent.len() >= 8, "{sent:?}");
    // What is listed is asked for with all that its parameters show.
    for (path, item) in document["paths"].as_object().unwrap() {
        // Who uses the service is for administrators, of whom there are none without keys.
        if path.contains('{') || item["get"].is_null() || path == "/v1/usage" {
            continue;
        }
        let shown = shown_address(path, &item["get"]);
        let answer = bench.client.get(bench.url(&shown)).send();
        let status = answer.await.unwrap().status();
        assert!(status.is_success(), "{shown}: {status}");
    }
}

#[tokio::test]
async fn no_operation_takes_a_parameter_that_it_does_not_declare() {
    let bench = Bench::quick().await;
    let document = meshwright::http::openapi();
    let mut refused = 0;
    for (path, item) in document["paths"].as_object().unwrap() {
        let address = path
            .replace("{id}", "00000000-0000-4000-8000-000000000000")
            .replace("{n}", "1");
        for method in item.as_object().unwrap().keys() {
            let method = Method::from_bytes(method.to_uppercase().as_bytes()).unwrap();
            let url = bench.url(&format!("{address}?torqe=115&limt=3"));
            let request = bench.client.request(method.clone(), url);
            let answer = request.send().await.unwrap();
            if path.starts_with("/health/") {
                assert!(answer.status().is_success(), "{path}");
                continue;
            }
            let status = answer.status();
            let problem: Value = answer.json().await.unwrap();
            let detail = problem["detail"].as_str().unwrap();
            assert_eq!(status, 400, "{method} {path}: {problem}");
            assert_eq!(problem["code"], "invalid_parameter", "{method} {path}");
            let names =
                |name: &str| detail.starts_with(&format!("{name} is not a parameter here."));
            assert!(names("torqe") || names("limt"), "{method} {path}: {detail}");
            refused += 1;
        }
    }
    assert!(refused > 60, "{refused}");
}

/// The address of an operation with what its parameters show, none of which needs an escape. Every one shows something but those that name what is a client's own.
fn shown_address(path: &str, operation: &Value) -> String {
    let parameters = operation["parameters"].as_array().into_iter().flatten();
    let in_address = parameters.filter(|parameter| parameter["in"] == "query");
    let shown = in_address.filter_map(|parameter| {
        let name = parameter["name"].as_str().unwrap();
        let value = match &parameter["example"] {
            Value::Null => None,
            Value::String(text) => Some(text.clone()),
            other => Some(other.to_string()),
        };
        let is_own = ["cursor", "ids", "name", "tag", "submitted_by"].contains(&name);
        assert_eq!(value.is_none(), is_own, "{name}");
        Some(format!("{name}={}", value?))
    });
    let shown: Vec<String> = shown.collect();
    format!("{path}?{}", shown.join("&"))
}

#[test]
fn schemas_bear_the_names_that_a_person_would_give_and_enumerate_their_words() {
    fn check(schema: &Value, here: &str) {
        for (name, field) in schema["properties"].as_object().into_iter().flatten() {
            let is_text = field["type"] == "string";
            if is_text && ["method", "status", "code"].contains(&name.as_str()) {
                assert!(field["enum"].is_array(), "{here}.{name} is any text");
            }
            if let (Some(kinds), Some(words)) = (field["type"].as_array(), field["enum"].as_array())
            {
                let may_be_null = kinds.contains(&"null".into());
                assert_eq!(may_be_null, words.contains(&Value::Null), "{here}.{name}");
            }
        }
        let parts = schema.as_object().map(|parts| parts.values().collect());
        let items = schema.as_array().map(|items| items.iter().collect());
        let within: Vec<&Value> = parts.or(items).unwrap_or_default();
        within.into_iter().for_each(|part| check(part, here));
    }
    let document = meshwright::http::openapi();
    for (name, schema) in document["components"]["schemas"].as_object().unwrap() {
        let of_the_program = ["Document", "View", "State"];
        let is_artefact = of_the_program.iter().any(|end| name.ends_with(end));
        assert!(!is_artefact && !name.contains('_'), "{name}");
        check(schema, name);
    }
}

#[test]
fn the_readme_shows_what_solve_prints_of_its_pair() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let (_, rest) = readme.split_once("```json\n").unwrap();
    let (pair, rest) = rest.split_once("```").unwrap();
    let (_, rest) = rest.split_once("```\n").unwrap();
    let (shown, _) = rest.split_once("```").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let submission = folder.path().join("pair.json");
    fs::write(&submission, pair).unwrap();
    let ran = Command::new(env!("CARGO_BIN_EXE_meshwright"))
        .arg("solve")
        .arg(submission)
        .arg("--output")
        .arg(folder.path().join("results.json"))
        .output()
        .unwrap();
    let printed = String::from_utf8(ran.stdout).unwrap();
    // But for how long it took.
    let timeless = |text: &str| {
        let (before, time) = text.split_once(" positions in ").unwrap();
        let (_, after) = time.split_once(" s, ").unwrap();
        format!("{before}{after}")
    };
    assert_eq!(timeless(&printed), timeless(shown));
}

#[test]
fn the_contract_says_what_generators_of_clients_need() {
    let document = meshwright::http::openapi();
    let paths = document["paths"].as_object().unwrap();
    // A path for each table, with the one media type that it has.
    assert!(!paths.keys().any(|path| path.contains("{table}")));
    for (file, media_type) in [
        ("ste.json", "application/json"),
        ("ste.csv", "text/csv"),
        ("run-up.svg", "image/svg+xml"),
        ("force-table.mo", "text/plain"),
        ("force-table.fmu", "application/octet-stream"),
    ] {
        let operation = &paths[&format!("/v1/jobs/{{id}}/results/{file}")]["get"];
        let word = file.replace(['-', '.'], "_");
        assert_eq!(operation["operationId"], format!("get_{word}"));
        let content = operation["responses"]["200"]["content"]
            .as_object()
            .unwrap();
        assert_eq!(content.keys().collect::<Vec<_>>(), [media_type], "{file}");
    }
    let mut ids = std::collections::BTreeSet::new();
    for (path, item) in paths {
        for (method, operation) in item.as_object().unwrap() {
            let here = format!("{method} {path}");
            assert!(
                ids.insert(operation["operationId"].as_str().unwrap()),
                "{here}"
            );
            for parameter in operation["parameters"].as_array().into_iter().flatten() {
                let is_header = parameter["in"] == "header";
                assert!(
                    !is_header || parameter["schema"]["type"].is_string(),
                    "{here}: {parameter}"
                );
            }
            for status in ["429", "503"] {
                let answer = &operation["responses"][status];
                let is_problem = answer["content"]["application/problem+json"].is_object();
                assert!(
                    !is_problem || answer["headers"]["Retry-After"].is_object(),
                    "{here}: {status}"
                );
            }
        }
    }
    let code = &document["components"]["schemas"]["Code"];
    assert!(code["enum"].is_null() && code["x-known-values"].as_array().unwrap().len() > 50);
    // Whatever a webhook may be told has a schema.
    let told = document["webhooks"].as_object().unwrap();
    let kinds = document["components"]["schemas"]["EventKind"]["enum"]
        .as_array()
        .unwrap();
    for kind in kinds
        .iter()
        .map(|kind| kind.as_str().unwrap())
        .chain(["webhook.ping"])
    {
        let schema = &told[kind]["post"]["requestBody"]["content"]["application/json"]["schema"];
        assert_eq!(schema["properties"]["type"]["const"], kind);
    }
}

#[test]
fn every_parameter_of_an_operation_stands_once_and_is_described() {
    let document = meshwright::http::openapi();
    let mut seen = 0;
    for (path, item) in document["paths"].as_object().unwrap() {
        for (method, operation) in item.as_object().unwrap() {
            let mut places = Vec::new();
            for parameter in operation["parameters"].as_array().into_iter().flatten() {
                seen += 1;
                let place = (&parameter["in"], &parameter["name"]);
                assert!(!places.contains(&place), "{method} {path}: {place:?} twice");
                places.push(place);
                let described = parameter["description"].is_string();
                assert!(described, "{method} {path}: {place:?} is not described");
            }
            let in_path = places.iter().filter(|(place, _)| *place == "path").count();
            assert_eq!(in_path, path.matches('{').count(), "{method} {path}");
        }
    }
    assert!(seen > 60, "{seen} parameters");
}

#[test]
fn every_field_of_a_submission_tells_a_form_its_title_and_its_kind() {
    let document = meshwright::http::openapi();
    let schemas = &document["components"]["schemas"];
    let mut seen = 0;
    for schema in [
        "Submission",
        "Preview",
        "Pair",
        "Gear",
        "Blank",
        "Holes",
        "Material",
        "TipRelief",
        "ProfileModification",
        "RootReliefModification",
        "TableModification",
        "ToothDeviations",
        "Eccentricity",
        "Slot",
        "Web",
        "Resolution",
    ] {
        let Some(properties) = schemas[schema]["properties"].as_object() else {
            continue;
        };
        for (name, field) in properties {
            seen += 1;
            let described = field["title"].is_string()
                || field["description"].is_string()
                || field["$ref"].is_string();
            assert!(
                described,
                "{schema}.{name} has neither title nor description"
            );
            if field["type"] == "number" || field["type"] == "integer" {
                for key in ["minimum", "maximum"] {
                    let bounded = field[key].is_number()
                        || field[format!("exclusive{}{}", &key[..1].to_uppercase(), &key[1..])]
                            .is_number();
                    assert!(bounded, "{schema}.{name} has no {key}");
                }
            }
        }
    }
    assert!(seen > 25, "the schemas of a submission have {seen} fields");
}

/// The arrow of ARCHITECTURE.md: http -> webhooks -> jobs -> compute -> studies -> wire -> engine. What is a crate of its own knows what its manifest names.
#[test]
fn each_part_knows_only_the_parts_below_it() {
    // The numbers of studies know neither gears nor JSON.
    let above_numbers = [
        "serde",
        "meshwright_engine",
        "meshwright_wire",
        "crate::table",
        "crate::population",
        "crate::search",
        "crate::study",
    ];
    #[rustfmt::skip]
    let forbidden: [(&str, &[&str]); 12] = [
        ("crates/wire/src", &["axum", "sqlx", "tokio", "std::fs", "std::net"]),
        ("crates/studies/src", &["axum", "sqlx", "tokio", "std::fs", "std::net"]),
        ("crates/studies/src/optimum", &above_numbers),
        ("crates/studies/src/sample", &above_numbers),
        ("src/compute", &["crate::jobs", "crate::http", "crate::serve", "axum"]),
        ("src", &["sqlx"]),
        ("crates/store/src", &["meshwright_wire", "meshwright_engine", "axum", "hyper"]),
        ("src/jobs", &["crate::http", "crate::serve", "crate::webhooks", "axum"]),
        ("src/webhooks", &["crate::http", "crate::serve", "axum"]),
        ("crates/connections/src", &["axum", "sqlx", "std::fs", "meshwright_engine", "meshwright_wire"]),
        ("crates/exchange/src", &["tokio", "axum", "sqlx", "std::fs", "std::net"]),
        ("crates/engine/src", &["serde", "tokio", "axum", "sqlx", "std::fs", "std::net", "std::time"]),
    ];
    for (folder, names) in forbidden {
        for file in rust_files(&root().join(folder)) {
            let text = fs::read_to_string(&file).unwrap();
            for line in text
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"))
            {
                let line = line.trim_start();
                for name in names {
                    let used = line.starts_with("use ") && line.contains(name)
                        || line.contains(&format!("{name}::"));
                    assert!(!used, "{} knows {name}: {line}", file.display());
                }
            }
        }
    }
}

/// Inside the engine: analysis -> assembly -> contact, load_distribution -> touch, flank -> ring -> fem -> grid -> gear;
/// vibration stands on fem.
#[test]
fn the_mechanics_build_on_each_other_in_one_direction() {
    let layers = [
        "gear",
        "grid",
        "fem",
        "ring",
        "vibration",
        "flank",
        "touch",
        "load_distribution",
        "contact",
        "assembly",
        "analysis",
    ];
    for (level, layer) in layers.iter().enumerate() {
        for file in rust_files(&root().join("crates/engine/src").join(layer)) {
            let text = fs::read_to_string(&file).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap_or_default();
            for above in &layers[level + 1..] {
                let used = code.lines().any(|line| {
                    !line.trim_start().starts_with("//")
                        && line.contains(&format!("crate::{above}"))
                });
                assert!(!used, "{} knows {above}", file.display());
            }
        }
    }
}

/// rustfmt does not enter what is written in macros. Comments and single words or sentences are as long as they are.
#[test]
fn lines_of_declarations_have_a_hundred_columns_at_most() {
    let mut seen = 0;
    for folder in ["crates/wire/src", "crates/studies/src", "src"] {
        for file in rust_files(&root().join(folder)) {
            let text = fs::read_to_string(&file).unwrap();
            let mut end = None;
            for (line, number) in text.lines().zip(1..) {
                let bare = line.trim_start();
                let indent = &line[..line.len() - bare.len()];
                let is_begun = ["document! {", "tagged! {", "words! {"].contains(&bare);
                match &end {
                    None if is_begun => end = Some(format!("{indent}}}")),
                    Some(last) if line == last => end = None,
                    Some(_) => {
                        seen += 1;
                        let is_exempt = bare.starts_with("//") || bare.starts_with('"');
                        let columns = line.chars().count();
                        let file = file.display();
                        assert!(is_exempt || columns <= 100, "{file}:{number}: {columns}");
                    }
                    None => {}
                }
            }
        }
    }
    assert!(seen > 1000, "{seen} lines");
}

pub(super) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}
