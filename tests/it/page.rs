//! The page, the outline that it draws, and the pictures and look-up tables of results.

use meshwright_wire::examples;
use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::bench::{Asked, Bench, problem, submission};

fn example(name: &str) -> Value {
    let found = examples().iter().find(|example| example.name == name);
    serde_json::from_str(found.unwrap().json).unwrap()
}

#[tokio::test]
async fn the_guides_are_read_in_a_browser_where_a_warning_leads_to_them() {
    let bench = Bench::quick().await;
    let list = bench.get("/guides").answer().await;
    let text = list.whole_text().await;
    assert!(
        text.contains("href=\"guides/is-my-thin-web-all-right\""),
        "{text}"
    );
    let mut thin = example("web");
    thin["pair"]["driven"]["blank"]["web"]["thickness_mm"] = json!(7.2);
    let answer = bench.post("/v1/validate", &thin).answer().await;
    let checked = answer.document().await;
    let warnings = checked["warnings"].as_array().unwrap();
    let warning = warnings
        .iter()
        .find(|warning| warning["code"] == "web_outside_plane_model")
        .unwrap();
    let guide = bench.get(warning["guide"].as_str().unwrap()).answer().await;
    assert_eq!(guide.headers()["content-type"], "text/html; charset=utf-8");
    let policy = guide.headers()["content-security-policy"].to_str().unwrap();
    assert!(policy.contains("style-src 'self'"), "{policy}");
    assert!(guide.whole_text().await.contains("plane stress"));
    let figure = bench.get("/guides/figures/spacing-even.svg").send().await;
    assert_eq!(figure.unwrap().headers()["content-type"], "image/svg+xml");
    for absent in ["/guides/none", "/guides/figures/none.svg"] {
        let answer = bench.get(absent).answer().await;
        assert_eq!(answer.status(), StatusCode::NOT_FOUND, "{absent}");
    }
}

#[tokio::test]
async fn teeth_are_drawn_by_the_law_of_their_class_and_taken_by_a_job() {
    let bench = Bench::quick().await;
    let mut pair = example("standard-pair");
    let draw = async |class: u32| {
        let asked = json!({ "gear": pair["pair"]["driven"], "iso_1328_class": class, "seed": 7 });
        let answer = bench.post("/v1/draw-deviations", &asked);
        answer.answer().await
    };
    let drawn = draw(6).await.document().await;
    let teeth = &drawn["tooth_deviations"];
    assert_eq!(teeth["pitch_single_um"].as_array().unwrap().len(), 50);
    assert_eq!(teeth["profile_slope_um"].as_array().unwrap().len(), 50);
    // Two classes coarser, twice as far: the same numbers, scaled.
    let coarse = draw(8).await.document().await;
    let ratio = coarse["tooth_deviations"]["profile_slope_um"][3]
        .as_f64()
        .unwrap()
        / teeth["profile_slope_um"][3].as_f64().unwrap();
    assert!((ratio - 2.0).abs() < 1e-3, "{ratio}");
    let refused = problem(draw(12).await, 422, "out_of_range").await;
    assert_eq!(refused["errors"][0]["pointer"], "/iso_1328_class");
    let teeth = teeth.clone();
    pair["pair"]["driven"]["tooth_deviations"] = teeth;
    let checked = bench.post("/v1/validate", &pair).send().await;
    let checked = checked.unwrap().document().await;
    assert_eq!(checked["pair"]["period_mesh_periods"], 50);
}

#[tokio::test]
async fn the_page_and_its_files_come_with_their_types_and_a_strict_policy() {
    let bench = Bench::quick().await;
    let page = bench.get("/").answer().await;
    assert_eq!(page.headers()["content-type"], "text/html; charset=utf-8");
    let policy = page.headers()["content-security-policy"].to_str().unwrap();
    assert!(
        policy.contains("script-src 'self'") && !policy.contains("unsafe"),
        "{policy}"
    );
    let tag = page.headers()["etag"].clone();
    let again = bench.get("/").header("if-none-match", &tag).answer().await;
    assert_eq!(again.status(), StatusCode::NOT_MODIFIED);

    let text = page.whole_text().await;
    let files = text.split('"').filter(|word| word.starts_with("web/"));
    let mut seen = 0;
    for file in files {
        let answer = bench.get(&format!("/{file}")).answer().await;
        assert_eq!(answer.status(), StatusCode::OK, "{file}");
        let media_type = answer.headers()["content-type"]
            .to_str()
            .unwrap()
            .to_owned();
        let expected = match file.rsplit_once('.').unwrap().1 {
            "js" => "text/javascript",
            "css" => "text/css",
            _ => "image/svg+xml",
        };
        assert!(media_type.starts_with(expected), "{file}: {media_type}");
        seen += 1;
    }
    assert!(seen > 10, "the page names {seen} files");
    for absent in [
        "/web/",
        "/web/none.js",
        "/web/../Cargo.toml",
        "/web/%2e%2e/Cargo.toml",
    ] {
        let answer = bench.get(absent).answer().await;
        assert_eq!(answer.status(), StatusCode::NOT_FOUND, "{absent}");
    }
}

#[tokio::test]
async fn the_outline_of_a_pair_comes_as_numbers_or_as_a_drawing() {
    let bench = Bench::quick().await;
    let case_2 = example("test-case-2");
    let outline = bench.post("/v1/outline", &case_2).document().await;
    assert_eq!(outline["driven"]["holes"].as_array().unwrap().len(), 10);
    assert_eq!(outline["driven"]["center_mm"], json!([100.5, 0.0]));
    assert_eq!(outline["driving"]["angle_per_mesh_period_deg"], 7.2);
    assert_eq!(outline["line_of_action"]["points"][2]["name"], "C");
    // The pitch point of equal gears is halfway.
    let pitch = outline["line_of_action"]["points"][2]["at_mm"][0]
        .as_f64()
        .unwrap();
    assert!((pitch - 50.25).abs() < 1e-6, "{pitch}");

    let request = bench
        .post("/v1/outline", &case_2)
        .header("accept", "image/svg+xml");
    let picture = request.answer().await;
    assert_eq!(picture.headers()["content-type"], "image/svg+xml");
    assert!(picture.whole_text().await.starts_with("<svg"));

    let asked = bench.post("/v1/outline", &example("bad-case-3-as-printed"));
    problem(asked, 422, "teeth_do_not_reach").await;
}

#[tokio::test]
async fn the_outline_of_a_drawing_is_that_of_a_submission() {
    let bench = Bench::quick().await;
    let post = |drawing: &str, media_type: &str, query: &str| {
        let request = bench.send(&format!("/v1/outline{query}"));
        let request = request.header("content-type", media_type);
        request.body(drawing.to_owned()).send()
    };
    let drawing = include_str!("../../api/examples/openings.dxf");
    for media_type in [
        "image/vnd.dxf",
        "application/dxf",
        "application/octet-stream",
    ] {
        let read = post(drawing, media_type, "").await.unwrap();
        assert_eq!(read.status(), StatusCode::OK, "{media_type}");
        let kind = "application/vnd.meshwright.outline+json";
        assert_eq!(read.headers()["content-type"], kind);
        let read = read.document().await;
        assert_eq!(read["bore_radius_mm"], 16.0);
        assert!(!read["remarks"].as_array().unwrap().is_empty());
        let mut submission = example("standard-pair");
        let blank = &mut submission["pair"]["driven"]["blank"];
        *blank = json!({ "bore_radius_mm": read["bore_radius_mm"], "outline": read["outline"] });
        let outline = bench.post("/v1/outline", &submission).document().await;
        let holes = outline["driven"]["holes"].as_array().unwrap();
        assert_eq!(holes.len(), 2, "{outline}");
        assert_eq!(holes[0]["radius_mm"], 7.5);
    }
    // The office drawing turns about (150, 105), and has a keyway.
    let office = include_str!("../reference/dxf/office.dxf");
    let refused = post(office, "image/vnd.dxf", "?bore_radius_mm=11").await;
    let refused = problem(refused.unwrap(), 422, "drawing_refused").await;
    let detail = refused["detail"].as_str().unwrap();
    assert!(detail.contains("turn about (150, 105)"), "{detail}");
    let query = "?center=150,105&bore_radius_mm=11&tolerance=0.005";
    let read = post(office, "image/vnd.dxf", query).await.unwrap();
    let read = read.document().await;
    assert_eq!(read["outline"].as_array().unwrap().len(), 15);
    let query = "?center=150,105&bore_radius_mm=11&layer=openings";
    let read = post(office, "image/vnd.dxf", query).await.unwrap();
    assert_eq!(
        read.document().await["outline"].as_array().unwrap().len(),
        14
    );
    for query in [
        "?center=150",
        "?tolerance=0.2",
        "?bore_radius_mm=-1",
        "?scale=2",
    ] {
        let refused = post(office, "image/vnd.dxf", query).await.unwrap();
        problem(refused, 400, "invalid_parameter").await;
    }
    let refused = post(drawing, "text/plain", "").await.unwrap();
    problem(refused, 415, "unsupported_media_type").await;
    let long = drawing.replace("EOF", &" ".repeat(4 << 20));
    let refused = post(&long, "image/vnd.dxf", "").await.unwrap();
    problem(refused, 413, "payload_too_large").await;
}

#[tokio::test]
async fn pictures_and_look_up_tables_stand_beside_the_results() {
    let bench = Bench::real().await;
    let path = bench.submit(&example("test-case-2")).await;
    bench.ended(&path).await;
    for picture in ["ste", "mesh-stiffness", "load-share", "spectrum"] {
        let answer = bench
            .get(&format!("{path}/results/{picture}.svg"))
            .answer()
            .await;
        assert_eq!(
            answer.headers()["content-type"],
            "image/svg+xml",
            "{picture}"
        );
        let text = answer.whole_text().await;
        assert!(
            text.starts_with("<svg") && !text.contains("NaN"),
            "{picture}"
        );
    }

    let results: Value = bench.document(&format!("{path}/results")).await;
    let table = bench
        .get(&format!("{path}/results/look-up-table.csv"))
        .answer()
        .await;
    let text = table.whole_text().await;
    let rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|line| line.starts_with(|first: char| first.is_ascii_digit()))
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(
        rows.len(),
        201,
        "five mesh periods of 40 positions, and the first again"
    );
    let mean = rows[..200].iter().map(|row| row[2]).sum::<f64>() / 200.0;
    let stiffness = &results["curves"][0]["statistics"]["mesh_stiffness_tangent_n_per_m"];
    // The statistics are those of the curve between its positions, where it jumps.
    assert!((mean / stiffness["mean"].as_f64().unwrap() - 1.0).abs() < 0.01);
}

#[tokio::test]
async fn results_without_what_a_picture_shows_say_so() {
    let bench = Bench::quick().await;
    let path = bench.submit(&submission(115.0)).await;
    bench.ended(&path).await;
    for absent in [
        "run-up.svg",
        "spectrum.svg?torque=20",
        "force-table.txt",
        "drawing.svg",
    ] {
        let asked = bench.get(&format!("{path}/results/{absent}"));
        problem(asked, 404, "not_found").await;
    }
}
