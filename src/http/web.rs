//! The page at `/` and the files that it is made of, which are part of the program.

use axum::Router;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_TYPE, LINK};
use axum::response::{IntoResponse, Response};
use axum::routing::get;

use super::app::App;
use super::conditional::{Keep, Tag};
use crate::wire::{Code, Problem};

/// A file of the page.
struct File {
    name: &'static str,
    bytes: &'static [u8],
}

macro_rules! files {
    ($($name:literal)*) => {
        &[$(File { name: $name, bytes: include_bytes!(concat!("../../web/", $name)) },)*]
    };
}

const PAGE: &str = "index.html";

const FILES: &[File] = files! {
    "index.html"
    "style.css"
    "guide.css"
    "main.js"
    "api.js"
    "beginnings.js"
    "brush.js"
    "charts.js"
    "compare.js"
    "deformed.js"
    "design.js"
    "deviations.js"
    "dom.js"
    "download.js"
    "drawing.js"
    "export.js"
    "figure.js"
    "form.js"
    "geometry.js"
    "headline.js"
    "holes.js"
    "inputs.js"
    "jobs.js"
    "preview.js"
    "schema.js"
    "series.js"
    "sheet.js"
    "snippets.js"
    "study.js"
    "sweep.js"
    "icon.svg"
    "vendor/uplot.js"
    "vendor/uplot.css"
    "vendor/uplot-LICENSE"
};

/// The page at `/`, and its files under `/web/`.
pub(super) fn routes_of_page() -> Router<App> {
    Router::new()
        .route("/", get(page))
        .route("/web/{*name}", get(file))
}

async fn page(request: HeaderMap) -> Result<Response, Problem> {
    let mut response = answer(PAGE, &request).await?;
    // Machines that come to the root find the description of the service.
    let links = "<openapi.json>; rel=\"service-desc\", <docs/>; rel=\"service-doc\"";
    response
        .headers_mut()
        .insert(LINK, links.parse().expect("visible ASCII"));
    Ok(response)
}

async fn file(Path(name): Path<String>, request: HeaderMap) -> Result<Response, Problem> {
    answer(&name, &request).await
}

async fn answer(name: &str, request: &HeaderMap) -> Result<Response, Problem> {
    let found = FILES.iter().find(|file| file.name == name);
    let file = found.ok_or_else(|| {
        Problem::new(
            Code::NotFound,
            format!("The page has no file {name:?}; it begins at /."),
        )
    })?;
    let text = String::from_utf8_lossy(file.bytes);
    let made = async { Ok(([(CONTENT_TYPE, media_type(name))], file.bytes).into_response()) };
    Tag::of(&[&text])
        .answer(Keep::AskAgain, request, made)
        .await
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit_once('.').map(|(_, extension)| extension) {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "text/plain; charset=utf-8",
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};

    use super::*;

    fn files_under(folder: &Path) -> Vec<PathBuf> {
        let entries = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path());
        entries
            .flat_map(|path| {
                if path.is_dir() {
                    files_under(&path)
                } else {
                    vec![path]
                }
            })
            .collect()
    }

    #[test]
    fn every_file_of_the_page_is_in_the_program() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("web");
        for path in files_under(&root) {
            let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
            assert!(FILES.iter().any(|file| file.name == name), "{name}");
        }
    }

    #[test]
    fn the_page_asks_for_nothing_from_elsewhere() {
        for file in FILES
            .iter()
            .filter(|file| !file.name.starts_with("vendor/"))
        {
            let text = std::str::from_utf8(file.bytes).unwrap();
            let outside = text
                .split(['"', '\'', '`', ' ', '('])
                .filter(|word| word.starts_with("http") && word.contains("://"))
                .find(|word| !word.starts_with("http://www.w3.org/"));
            assert_eq!(outside, None, "{}", file.name);
        }
    }
}
