//! The pages to which a problem's `type` links, one for each kind of problem.

use axum::extract::Path;
use axum::response::Html;
use meshwright_wire::{Code, Problem};

use super::problem::Refusal;

/// List the problems
///
/// A page with every kind of problem that the service reports.
#[utoipa::path(
    get, path = "/problems", tag = "Reference", operation_id = "list_problems",
    security(()),
    responses((status = 200, description = "The page.", body = String, content_type = "text/html")),
)]
pub(super) async fn index() -> Html<String> {
    let row = |code: &Code| {
        // Relative to /problems, which has no slash at its end.
        format!(
            "<li><a href=\"problems/{}\">{}</a> ({})</li>",
            code.slug(),
            code.title(),
            code.status()
        )
    };
    Html(page(
        "Problems",
        &format!("<ul>{}</ul>", Code::ALL.iter().map(row).collect::<String>()),
    ))
}

/// Read about a problem
///
/// A page that explains one kind of problem; the `type` of a problem document links to it.
#[utoipa::path(
    get, path = "/problems/{slug}", tag = "Reference", operation_id = "get_problem",
    security(()),
    params(("slug" = String, Path, example = "out-of-range", description = "The code of the problem, with hyphens.")),
    responses(
        (status = 200, description = "The page.", body = String, content_type = "text/html"),
        (status = 404, description = "There is no such problem."),
    ),
)]
pub(super) async fn page_of(Path(slug): Path<String>) -> Result<Html<String>, Refusal> {
    let code = Code::ALL
        .iter()
        .find(|code| code.slug() == slug)
        .ok_or_else(|| {
            Problem::new(
                Code::NotFound,
                "There is no problem of this name; /problems lists them all.",
            )
        })?;
    let body = format!(
        "<p>{}</p><p>Code <code>{}</code>, status {}.</p><p><a href=\"../problems\">All problems</a></p>",
        code.explanation(),
        code.word(),
        code.status(),
    );
    Ok(Html(page(code.title(), &body)))
}

/// A page around a body. All text is our own, so nothing needs escaping.
fn page(title: &str, body: &str) -> String {
    format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title} - Meshwright</title>\
         <meta name=\"viewport\" content=\"width=device-width\">\
         <style>body {{ font: 1rem/1.5 system-ui, sans-serif; max-width: 40rem; margin: 3rem auto; padding: 0 1rem }}</style>\
         </head><body><h1>{title}</h1>{body}</body></html>"
    )
}
