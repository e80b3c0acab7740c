//! The page at `/` and the files that it is made of, which are part of the program.

use std::sync::LazyLock;

use axum::Router;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::http::header::LINK;
use axum::response::Response;
use axum::routing::get;
use meshwright_wire::{Code, Problem};

use super::app::App;
use super::problem::Refusal;
use super::static_files::{Folder, files};

static FILES: LazyLock<Folder> = LazyLock::new(|| Folder::of(files::PAGE));

/// The page at `/`, and its files under `/web/`.
pub(super) fn routes_of_page() -> Router<App> {
    Router::new()
        .route("/", get(page))
        .route("/web/{*name}", get(file))
}

async fn page(request: HeaderMap) -> Result<Response, Refusal> {
    let mut response = answer("index.html", &request).await?;
    // Machines that come to the root find the description of the service.
    let links = "<openapi.json>; rel=\"service-desc\", <docs/>; rel=\"service-doc\"";
    response
        .headers_mut()
        .insert(LINK, links.parse().expect("visible ASCII"));
    Ok(response)
}

async fn file(Path(name): Path<String>, request: HeaderMap) -> Result<Response, Refusal> {
    answer(&name, &request).await
}

async fn answer(name: &str, request: &HeaderMap) -> Result<Response, Refusal> {
    let file = FILES.find(name).ok_or_else(|| {
        Problem::new(
            Code::NotFound,
            format!("The page has no file {name:?}; it begins at /."),
        )
    })?;
    Ok(file.answer(request).await)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_asks_for_nothing_from_elsewhere() {
        let own = files::PAGE
            .iter()
            .filter(|(name, ..)| !name.starts_with("vendor/"));
        for (name, plain, _) in own {
            let text = std::str::from_utf8(plain).unwrap();
            let outside = text
                .split(['"', '\'', '`', ' ', '('])
                .filter(|word| word.starts_with("http") && word.contains("://"))
                .find(|word| !word.starts_with("http://www.w3.org/"));
            assert_eq!(outside, None, "{name}");
        }
    }
}
