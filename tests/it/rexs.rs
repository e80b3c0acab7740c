use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use reqwest::StatusCode;
use serde_json::Value;

use crate::bench::{Asked, Bench, problem};

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("api/examples")
        .join(name)
}

fn meshwright(arguments: &[&Path]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_meshwright"));
    program.args(arguments).output().unwrap()
}

fn path(text: &str) -> &Path {
    Path::new(text)
}

/// The results that `solve` writes of a file.
fn solved(folder: &Path, file: &Path) -> Value {
    let results = folder.join("results.json");
    let ran = meshwright(&[path("solve"), file, path("--output"), &results]);
    assert!(
        ran.status.success(),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    serde_json::from_slice(&std::fs::read(results).unwrap()).unwrap()
}

/// The largest difference of two lists.
fn apart(one: &Value, other: &Value) -> f64 {
    let (one, other) = (one.as_array().unwrap(), other.as_array().unwrap());
    assert_eq!(one.len(), other.len());
    let pairs = one.iter().zip(other);
    pairs.fold(0.0, |largest: f64, (a, b)| {
        largest.max((a.as_f64().unwrap() - b.as_f64().unwrap()).abs())
    })
}

#[test]
fn solve_takes_a_rexs_model_for_the_submission_that_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let of_model = solved(folder.path(), &example("test-case-2.rexs"));
    let of_json = solved(folder.path(), &example("test-case-2.json"));
    assert_eq!(of_model["method"], of_json["method"]);
    assert_eq!(of_model["curves"].as_array().unwrap().len(), 1);
    let (model, json) = (&of_model["curves"][0], &of_json["curves"][0]);
    assert_eq!(model["output_torque_n_m"], json["output_torque_n_m"]);
    // A nanometer of the transmission error is the ripple of the method, and all ten digits are equal where nothing differs but the
    // way in which tip circle and relief are said.
    assert!(
        apart(
            &model["transmission_error_um"],
            &json["transmission_error_um"]
        ) < 1e-6
    );
    let name = "mesh_stiffness_tangent_n_per_m";
    assert!(apart(&model[name], &json[name]) < 1e-6 * json[name][0].as_f64().unwrap());
    let mean = &model["statistics"]["transmission_error_um"]["mean"];
    assert!((mean.as_f64().unwrap() - 13.789).abs() < 1e-3, "{mean}");
}

#[test]
fn a_pair_and_its_curves_go_out_and_come_back_by_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let (submission, model) = (example("web.json"), folder.path().join("web.rexs"));
    let there = solved(folder.path(), &submission);
    let results = folder.path().join("results.json");
    let export = [
        path("rexs"),
        path("export"),
        &submission,
        &results,
        path("-o"),
        &model,
    ];
    let exported = meshwright(&export);
    assert!(exported.status.success(), "{exported:?}");
    let text = std::fs::read_to_string(&model).unwrap();
    assert!(text.contains("meshing_stiffness_characteristic"), "{text}");
    let back = solved(folder.path(), &model);
    let (there, back) = (&there["curves"][0], &back["curves"][0]);
    assert!(
        apart(
            &there["transmission_error_um"],
            &back["transmission_error_um"]
        ) < 1e-6
    );
    // Results of another submission are not put beside this pair.
    let other = example("test-case-2.json");
    let mixed = meshwright(&[path("rexs"), path("export"), &other, &results]);
    assert_eq!(mixed.status.code(), Some(2));
    assert!(
        String::from_utf8_lossy(&mixed.stderr).contains("input_hash"),
        "{mixed:?}"
    );
}

#[test]
fn what_is_wrong_is_told_with_its_place_in_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let model = std::fs::read_to_string(example("test-case-2.rexs")).unwrap();
    let apart = folder.path().join("apart.rexs");
    std::fs::write(&apart, model.replacen(">100.5<", ">119<", 1)).unwrap();
    let refused = meshwright(&[path("solve"), &apart]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    for part in [
        "teeth_do_not_reach",
        "nearest: ",
        "from component 2 (cylindrical_stage \"Stage\"), center_distance",
    ] {
        assert!(said.contains(part), "{said}");
    }
    // Options of a model are nothing to a submission.
    let json = example("test-case-2.json");
    let refused = meshwright(&[path("solve"), &json, path("--torque"), path("20")]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(said.contains("--torque"), "{said}");
    // And they stand in place of what the model says.
    let model = example("test-case-2.rexs");
    let quick = [
        path("solve"),
        &model,
        path("--torque"),
        path("20"),
        path("--method"),
        path("load_distribution"),
    ];
    let solved = meshwright(&quick);
    assert!(solved.status.success(), "{solved:?}");
    let said = String::from_utf8_lossy(&solved.stdout).into_owned();
    assert!(
        said.contains("load_distribution over") && said.contains("        20  "),
        "{said}"
    );
}

#[tokio::test]
async fn a_model_is_read_and_a_job_is_written_as_one_over_http() {
    let bench = Bench::real().await;
    let post = |model: String, media_type: &'static str| {
        let request = bench.send("/v1/rexs");
        request
            .header("content-type", media_type)
            .body(model)
            .send()
    };
    let model = std::fs::read_to_string(example("test-case-2.rexs")).unwrap();
    let unread = "<attribute id=\"paint\" unit=\"none\">3</attribute></component>";
    let painted = model.replacen("</component>", unread, 1);
    let read = post(painted, "application/xml").await.unwrap();
    assert_eq!(read.status(), StatusCode::OK);
    let read = read.document().await;
    let submissions = read["submissions"].as_array().unwrap();
    assert_eq!(submissions.len(), 1);
    assert_eq!(
        submissions[0]["pair"]["driven"]["blank"]["holes"]["count"],
        10
    );
    let not_read = read["not_read"].as_array().unwrap();
    assert!(
        not_read.iter().any(|each| each["attribute"] == "paint"),
        "{not_read:?}"
    );

    // What it came to can be computed, and is a model again, with its curves.
    let mut submission = submissions[0].clone();
    submission["method"] = "load_distribution".into();
    let job = bench.submit(&submission).await;
    assert_eq!(bench.ended(&job).await["status"], "successful");
    let written = bench.get(&format!("{job}/submission.rexs"));
    let written = written.answer().await;
    assert_eq!(written.headers()["content-type"], "application/xml");
    let written = written.whole_text().await;
    assert!(written.contains("meshing_stiffness_characteristic"));
    let again = post(written, "text/xml").await.unwrap();
    let again = again.document().await;
    let distance = |of: &Value| of["pair"]["center_distance_mm"].clone();
    assert_eq!(distance(&again["submissions"][0]), distance(&submission));

    let text = post(model.clone(), "text/plain").await.unwrap();
    problem(text, 415, "unsupported_media_type").await;
    let json = post("{}".to_owned(), "application/json").await.unwrap();
    problem(json, 422, "model_refused").await;
    for nothing in ["no model", "<model version=\"1.4\"/>"] {
        let refused = post(nothing.to_owned(), "application/xml").await.unwrap();
        problem(refused, 422, "model_refused").await;
    }
    // Teeth that do not reach each other are told where the model says so.
    let apart = post(model.replacen(">100.5<", ">119<", 1), "application/xml");
    let apart = problem(apart.await.unwrap(), 422, "model_refused").await;
    let detail = apart["detail"].as_str().unwrap();
    assert!(
        detail.contains("component 2 (cylindrical_stage \"Stage\"), center_distance"),
        "{detail}"
    );
}

#[tokio::test]
async fn a_model_is_read_in_every_container_and_a_refused_one_says_why_of_each_stage() {
    let bench = Bench::real().await;
    let post = |model: Vec<u8>, media_type: &'static str, query: &'static str| {
        let request = bench.send(&format!("/v1/rexs{query}"));
        request
            .header("content-type", media_type)
            .body(model)
            .send()
    };
    let file = |name: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/rexs");
        std::fs::read(folder.join(name)).unwrap()
    };
    let mut plain = None;
    for (name, media_type) in [
        ("both-drive-false.rexs", "application/xml"),
        ("umlaut-latin-1.rexs", "text/xml; charset=ISO-8859-1"),
        ("json.rexsj", "application/json"),
        ("zipped.rexsz", "application/zip"),
        ("zipped.rexsz", "application/x-zip-compressed"),
        ("json.rexsj", "application/octet-stream"),
    ] {
        let read = post(file(name), media_type, "").await.unwrap();
        assert_eq!(read.status(), StatusCode::OK, "{name}");
        let submissions = read.document().await["submissions"].clone();
        assert_eq!(submissions[0]["pair"]["center_distance_mm"], 60.5);
        let plain = plain.get_or_insert_with(|| submissions.clone());
        assert_eq!(*plain, submissions, "{name}");
    }
    // More than may be sent is not unpacked either: 4 MiB of spaces in 4 kB.
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    archive
        .start_file("a.rexs", zip::write::SimpleFileOptions::default())
        .unwrap();
    std::io::Write::write_all(&mut archive, &vec![b' '; (4 << 20) + 1]).unwrap();
    let bomb = archive.finish().unwrap().into_inner();
    assert!(bomb.len() < 8192, "{}", bomb.len());
    let bomb = problem(
        post(bomb, "application/zip", "").await.unwrap(),
        422,
        "model_refused",
    );
    let bomb = bomb.await;
    assert!(
        bomb["detail"].as_str().unwrap().contains("4194304"),
        "{bomb}"
    );

    // Each stage has its own reasons: here what the model lacks, and what the pair would be.
    let two = String::from_utf8(file("two-stages-torque-at-input.rexs")).unwrap();
    let two = two.replacen(r#"unit="mm">90.5<"#, r#"unit="mm">120<"#, 1);
    let width = r#"<attribute id="face_width" unit="mm">20</attribute>"#;
    let two = two.replacen(width, "", 1);
    let refused = post(two.into_bytes(), "application/xml", "").await.unwrap();
    let refused = problem(refused, 422, "model_refused").await;
    let errors = refused["errors"].as_array().unwrap();
    assert_eq!(errors.len(), 2, "{errors:?}");
    for (error, pointer, code, detail) in [
        (
            &errors[0],
            "",
            "model_refused",
            "Stage 2: component 10 (cylindrical_gear): It has no face_width",
        ),
        (
            &errors[1],
            "/pair/center_distance_mm",
            "teeth_do_not_reach",
            "Stage 3: component 3 (cylindrical_stage \"Second\"), center_distance: ",
        ),
    ] {
        assert_eq!(error["pointer"], pointer);
        assert_eq!(error["code"], code);
        let told = error["detail"].as_str().unwrap();
        assert!(told.starts_with(detail), "{told}");
    }
    assert!(errors[1]["nearest"].as_f64().unwrap() < 120.0);
}

/// The models of our own as other programs write them.
fn models_of_other_programs() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/rexs");
    let files = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn every_file_of_another_program_is_read_or_refused_by_its_place_on_the_command_line() {
    let mut read = 0;
    for file in models_of_other_programs() {
        let stage = [path("--stage"), path("3")];
        let mut arguments = vec![path("rexs"), path("import"), &file];
        let name = file.file_name().unwrap().to_string_lossy();
        if name.starts_with("two-stages") {
            arguments.extend(stage);
        }
        let ran = meshwright(&arguments);
        let told = String::from_utf8_lossy(&ran.stderr);
        if ran.status.success() {
            let submission: Value = serde_json::from_slice(&ran.stdout).unwrap();
            assert!(submission["pair"].is_object(), "{name}");
            assert!(told.contains("Assumed: "), "{name}: {told}");
            read += 1;
        } else {
            assert_eq!(ran.status.code(), Some(2), "{name}: {told}");
            // Where it stands in the model.
            assert!(told.contains("component "), "{name}: {told}");
        }
    }
    assert!(read >= 9, "{read}");
}

#[tokio::test]
async fn every_file_of_another_program_is_read_over_http_as_on_the_command_line() {
    let bench = Bench::real().await;
    let mut files = 0;
    for file in models_of_other_programs() {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let stage = if name.starts_with("two-stages") { 3 } else { 0 };
        let query = if stage > 0 {
            format!("?stage={stage}")
        } else {
            String::new()
        };
        let request = bench.send(&format!("/v1/rexs{query}"));
        let request = request.header("content-type", "application/octet-stream");
        let answer = request
            .body(std::fs::read(&file).unwrap())
            .send()
            .await
            .unwrap();

        let mut arguments = vec![path("rexs"), path("import"), &file];
        let said = stage.to_string();
        if stage > 0 {
            arguments.extend([path("--stage"), path(&said)]);
        }
        let ran = meshwright(&arguments);
        if ran.status.success() {
            assert_eq!(answer.status(), StatusCode::OK, "{name}");
            let read = answer.document().await;
            let submission: Value = serde_json::from_slice(&ran.stdout).unwrap();
            assert_eq!(read["submissions"], Value::from(vec![submission]), "{name}");
            assert!(!read["assumed"].as_array().unwrap().is_empty(), "{name}");
        } else {
            let refused = problem(answer, 422, "model_refused").await;
            let told = String::from_utf8_lossy(&ran.stderr);
            for error in refused["errors"].as_array().unwrap() {
                let detail = error["detail"].as_str().unwrap();
                let place = &detail[detail.find("component ").expect("its place in the model")..];
                let place = place.split(')').next().unwrap();
                assert!(told.contains(place), "{name}: {place}: {told}");
            }
        }
        files += 1;
    }
    assert_eq!(files, 14);
}

#[tokio::test]
async fn the_loaded_flanks_are_chosen_where_they_differ_and_other_files_are_named() {
    let bench = Bench::real().await;
    let model = std::fs::read_to_string(example("test-case-2.rexs")).unwrap();
    // The relief is that of one flank alone.
    let left = r#"<ref id="12" role="origin"/>"#;
    let differs = model.replacen(left, r#"<ref id="10" role="origin"/>"#, 1);
    let post = |model: &str, query: &str| {
        let request = bench.send(&format!("/v1/rexs{query}"));
        let request = request.header("content-type", "application/xml");
        request.body(model.to_owned()).send()
    };
    let refused = problem(post(&differs, "").await.unwrap(), 422, "model_refused").await;
    let detail = refused["detail"].as_str().unwrap();
    assert!(detail.contains("--flank left"), "{detail}");
    for (query, relieved) in [("?flank=right", true), ("?flank=left", false)] {
        let read = post(&differs, query).await.unwrap().document().await;
        let relief = &read["submissions"][0]["pair"]["driving"]["tip_relief"];
        assert_eq!(relief.is_object(), relieved, "{query}: {relief}");
    }
    let wrong = post(&differs, "?flank=up").await.unwrap();
    problem(wrong, 400, "invalid_parameter").await;

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("differs.rexs");
    std::fs::write(&file, &differs).unwrap();
    let import = [path("rexs"), path("import"), &file];
    assert_eq!(meshwright(&import).status.code(), Some(2));
    let chosen = meshwright(&[&import[..], &[path("--flank"), path("right")]].concat());
    assert!(chosen.status.success(), "{chosen:?}");

    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/rexs");
    let elsewhere = reference.join("material-in-a-database.rexs");
    let refused = meshwright(&[path("solve"), &elsewhere]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(
        said.contains("component 9 (material)") && said.contains("./database_material.rexs"),
        "{said}"
    );
}
