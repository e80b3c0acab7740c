//! The guides, part of the program: explanations of fields, warnings and numbers, a click away from each. The build makes them from the texts in `docs`.

use std::sync::LazyLock;

use axum::Router;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::Response;
use axum::routing::get;
use meshwright_wire::{Code, Problem};

use super::app::App;
use super::problem::Refusal;
use super::static_files::{Folder, files};

static FILES: LazyLock<Folder> = LazyLock::new(|| Folder::of(files::GUIDES));

/// The guides at `/guides`, and their figures.
pub(super) fn routes_of_guides() -> Router<App> {
    Router::new()
        .route("/guides", get(index))
        .route("/guides/{name}", get(guide))
        .route("/guides/figures/{name}", get(figure))
}

async fn index(request: HeaderMap) -> Result<Response, Refusal> {
    answer("index.html", "list", "guides", &request).await
}

async fn guide(Path(name): Path<String>, request: HeaderMap) -> Result<Response, Refusal> {
    answer(&format!("{name}.html"), "guide", &name, &request).await
}

async fn figure(Path(name): Path<String>, request: HeaderMap) -> Result<Response, Refusal> {
    answer(&format!("figures/{name}"), "figure", &name, &request).await
}

async fn answer(
    file: &str,
    kind: &str,
    name: &str,
    request: &HeaderMap,
) -> Result<Response, Refusal> {
    let file = FILES.find(file).ok_or_else(|| {
        let detail = format!("There is no {kind} {name:?}; /guides lists the guides.");
        Problem::new(Code::NotFound, detail)
    })?;
    Ok(file.answer(request).await)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All texts between `before` and the next quotation mark.
    fn all_between<'a>(text: &'a str, before: &str) -> Vec<&'a str> {
        let parts = text.split(before).skip(1);
        parts.filter_map(|part| part.split('"').next()).collect()
    }

    /// The page of a guide.
    fn page(name: &str) -> Option<&'static str> {
        let file = format!("{name}.html");
        let found = files::GUIDES.iter().find(|(name, ..)| **name == file);
        found.map(|(_, plain, _)| std::str::from_utf8(plain).unwrap())
    }

    #[test]
    fn every_link_and_every_figure_of_a_guide_is_served() {
        let names = files::GUIDES.iter().filter_map(|(name, ..)| {
            let name = name.strip_suffix(".html")?;
            (name != "index").then_some(name)
        });
        for guide in names {
            let text = page(guide).unwrap();
            let (_, text) = text.split_once("<main>").unwrap();
            for link in all_between(text, "<a href=\"") {
                let (name, fragment) = link.split_once('#').unwrap_or((link, ""));
                if link.starts_with("https://") {
                    continue;
                }
                let name = if name.is_empty() { guide } else { name };
                let target = page(name).unwrap_or_else(|| panic!("{guide}: {link}"));
                assert!(
                    fragment.is_empty() || all_between(target, " id=\"").contains(&fragment),
                    "{guide}: {link}"
                );
            }
            for figure in all_between(text, "<img src=\"") {
                let known = files::GUIDES.iter().any(|(name, ..)| *name == figure);
                assert!(known, "{guide}: {figure}");
            }
            assert!(text.contains("<h1"), "{guide}");
            assert!(!text.contains(".md\""), "{guide}");
        }
    }

    #[test]
    fn what_is_linked_and_not_served_stays_as_words() {
        // The guide links to a file of the tree.
        let theory = page("theory").unwrap();
        assert!(theory.contains(" differences"), "the words stay");
        assert!(!theory.contains(">differences</a>"));
        assert!(
            theory.contains("<a href=\"limits"),
            "what is served is linked"
        );
    }
}
