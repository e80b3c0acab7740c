//! The guides, which are part of the program: what a field, a warning or a number means, a click from where it is asked.

use std::fmt::Write;

use axum::Router;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use meshwright_connections::Keep;
use meshwright_wire::{Code, Problem};
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};

use super::answer::tag_of_parts;
use super::app::App;
use super::problem::Refusal;

/// A guide by its name, as it is written.
struct Guide {
    name: &'static str,
    text: &'static str,
}

/// A figure of the guides.
struct Figure {
    name: &'static str,
    bytes: &'static [u8],
}

macro_rules! guides {
    ($($name:literal)*) => {
        &[$(Guide { name: $name, text: include_str!(concat!("../../docs/", $name, ".md")) },)*]
    };
}

macro_rules! figures {
    ($($name:literal)*) => {
        &[$(Figure { name: $name, bytes: include_bytes!(concat!("../../docs/figures/", $name)) },)*]
    };
}

const GUIDES: &[Guide] = guides! {
    "my-first-pair"
    "an-hour-at-the-bench"
    "from-kisssoft-or-a-drawing"
    "choose-a-relief"
    "compare-hole-patterns"
    "how-good-will-they-be"
    "find-a-design"
    "is-my-thin-web-all-right"
    "my-helical-pair"
    "will-it-rattle-or-whine"
    "limits"
    "theory"
    "validity"
    "integrate"
};

const FIGURES: &[Figure] = figures! {
    "fig-02-substructures.svg"
    "fig-03-blank-rotation.svg"
    "fig-07-case-2.svg"
    "fig-11-designs-at-115-n-m.svg"
    "page-deformed-helical.png"
    "page-deformed.png"
    "page-helical.png"
    "spacing-even.svg"
    "spacing-uneven.svg"
    "validity-blanks.svg"
    "validity-flanks.svg"
    "validity-pairs.svg"
};

/// The guides at `/guides`, and their figures.
pub(super) fn routes_of_guides() -> Router<App> {
    Router::new()
        .route("/guides", get(index))
        .route("/guides/{name}", get(guide))
        .route("/guides/figures/{name}", get(figure))
}

async fn index(request: HeaderMap) -> Result<Response, Refusal> {
    let list = GUIDES.iter().fold(String::new(), |mut list, guide| {
        let _ = write!(
            list,
            "<li><a href=\"guides/{}\">{}</a></li>",
            guide.name,
            title_of(guide.text)
        );
        list
    });
    let page = page("Guides", ".", &format!("<h1>Guides</h1><ul>{list}</ul>"));
    answer("text/html; charset=utf-8", page.into(), &request).await
}

async fn guide(Path(name): Path<String>, request: HeaderMap) -> Result<Response, Refusal> {
    let guide = GUIDES.iter().find(|guide| guide.name == name);
    let guide = guide.ok_or_else(|| nothing("guide", &name))?;
    let page = page(title_of(guide.text), "..", &as_html(guide.text));
    answer("text/html; charset=utf-8", page.into(), &request).await
}

async fn figure(Path(name): Path<String>, request: HeaderMap) -> Result<Response, Refusal> {
    let figure = FIGURES.iter().find(|figure| figure.name == name);
    let figure = figure.ok_or_else(|| nothing("figure", &name))?;
    let media_type = if name.ends_with(".svg") {
        "image/svg+xml"
    } else {
        "image/png"
    };
    answer(media_type, figure.bytes.into(), &request).await
}

fn nothing(kind: &str, name: &str) -> Problem {
    let detail = format!("There is no {kind} {name:?}; /guides lists the guides.");
    Problem::new(Code::NotFound, detail)
}

async fn answer(
    media_type: &'static str,
    bytes: Vec<u8>,
    request: &HeaderMap,
) -> Result<Response, Refusal> {
    let tag = tag_of_parts(&[&String::from_utf8_lossy(&bytes)]);
    let made = async { Ok(([(CONTENT_TYPE, media_type)], bytes).into_response()) };
    tag.answer(Keep::AskAgain, request, made).await
}

fn title_of(text: &str) -> &str {
    let first = text.lines().next().unwrap_or_default();
    first.trim_start_matches('#').trim()
}

/// A guide as it is read in a browser: headings can be linked to, and links lead to what is served here.
fn as_html(text: &str) -> String {
    let options = Options::ENABLE_TABLES;
    let mut events: Vec<Event> = Parser::new_ext(text, options).collect();
    name_headings(&mut events);
    let mut dropped = false;
    let shown = events.into_iter().filter_map(|event| match event {
        Event::Start(Tag::Link {
            link_type,
            dest_url,
            title,
            id,
        }) => {
            let address = address_of(&dest_url);
            dropped = address.is_none();
            Some(Event::Start(Tag::Link {
                link_type,
                dest_url: address?,
                title,
                id,
            }))
        }
        Event::End(TagEnd::Link) if dropped => {
            dropped = false;
            None
        }
        other => Some(other),
    });
    let mut page = String::new();
    html::push_html(&mut page, shown);
    // What is wider than the page scrolls by itself, by keys too.
    page.replace(
        "<table>",
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Table\"><table>",
    )
    .replace("</table>", "</table></div>")
    .replace("<pre>", "<pre tabindex=\"0\">")
}

/// Where a link of a guide leads to here; none where it leads to a file that is not served.
fn address_of(link: &str) -> Option<CowStr<'static>> {
    if link.starts_with('#') || link.starts_with("https://") {
        return Some(link.to_owned().into());
    }
    let (file, fragment) = link.split_once('#').unwrap_or((link, ""));
    let name = file.strip_suffix(".md")?;
    GUIDES.iter().find(|guide| guide.name == name)?;
    let fragment = if fragment.is_empty() {
        String::new()
    } else {
        format!("#{fragment}")
    };
    Some(format!("{name}{fragment}").into())
}

/// Gives each heading the id by which it is linked to: its words in lower case, joined by hyphens.
fn name_headings(events: &mut [Event]) {
    for i in 0..events.len() {
        let words: String = events[i..]
            .iter()
            .take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_))))
            .filter_map(|event| match event {
                Event::Text(text) | Event::Code(text) => Some(text.as_ref()),
                _ => None,
            })
            .collect();
        if let Event::Start(Tag::Heading { id, .. }) = &mut events[i] {
            let kept = words.to_lowercase().replace(' ', "-");
            let kept = kept.chars().filter(|c| c.is_alphanumeric() || *c == '-');
            *id = Some(kept.collect::<String>().into());
        }
    }
}

fn page(title: &str, root: &str, body: &str) -> String {
    format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title} - Meshwright</title>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <link rel=\"icon\" href=\"{root}/web/icon.svg\" type=\"image/svg+xml\"><link rel=\"stylesheet\" href=\"{root}/web/guide.css\"></head>\
         <body><nav><a href=\"{root}/\">Meshwright</a> <a href=\"{root}/guides\">Guides</a> <a href=\"{root}/docs/\">API</a></nav><main>{body}</main></body></html>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What stands between `before` and a quotation mark, wherever it does.
    fn all_between<'a>(text: &'a str, before: &str) -> Vec<&'a str> {
        let parts = text.split(before).skip(1);
        parts.filter_map(|part| part.split('"').next()).collect()
    }

    #[test]
    fn every_link_and_every_figure_of_a_guide_is_served() {
        for guide in GUIDES {
            let page = as_html(guide.text);
            for link in all_between(&page, "<a href=\"") {
                let (name, fragment) = link.split_once('#').unwrap_or((link, ""));
                if link.starts_with("https://") {
                    continue;
                }
                let target = GUIDES
                    .iter()
                    .find(|guide| guide.name == name)
                    .map_or(guide, |found| found);
                assert!(name.is_empty() || target.name == name, "{link}");
                let ids = as_html(target.text);
                assert!(
                    fragment.is_empty() || all_between(&ids, " id=\"").contains(&fragment),
                    "{}: {link}",
                    guide.name
                );
            }
            for figure in all_between(&page, "<img src=\"figures/") {
                assert!(
                    FIGURES.iter().any(|known| known.name == figure),
                    "{}: {figure}",
                    guide.name
                );
            }
            assert!(page.contains("<h1"), "{}", guide.name);
            assert!(!page.contains(".md\""), "{}", guide.name);
        }
    }

    #[test]
    fn what_is_linked_and_not_served_stays_as_words() {
        let page = as_html(
            "# T\n\nSee [the tool](../README.md#x), [limits](limits.md) and [a](https://example.com).\n",
        );
        assert!(page.contains("See the tool, <a href=\"limits\">limits</a> and <a href=\"https://example.com\">a</a>."), "{page}");
    }
}
