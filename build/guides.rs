//! The guides as HTML: headings have anchors, and links lead to served files.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::io;

use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};

use crate::Named;

/// In the order in which they are listed.
const GUIDES: [&str; 14] = [
    "my-first-pair",
    "an-hour-at-the-bench",
    "from-kisssoft-or-a-drawing",
    "choose-a-relief",
    "compare-hole-patterns",
    "how-good-will-they-be",
    "find-a-design",
    "is-my-thin-web-all-right",
    "my-helical-pair",
    "will-it-rattle-or-whine",
    "limits",
    "theory",
    "validity",
    "integrate",
];

const FIGURES: [&str; 12] = [
    "fig-02-substructures.svg",
    "fig-03-blank-rotation.svg",
    "fig-07-case-2.svg",
    "fig-11-designs-at-115-n-m.svg",
    "page-deformed-helical.png",
    "page-deformed.png",
    "page-helical.png",
    "spacing-even.svg",
    "spacing-uneven.svg",
    "validity-blanks.svg",
    "validity-flanks.svg",
    "validity-pairs.svg",
];

/// The list of the guides, each guide, and their figures: names under which they are served, and contents.
pub(crate) fn files() -> Result<Vec<Named>, Box<dyn Error>> {
    let (mut files, mut list) = (Vec::new(), String::new());
    for name in GUIDES {
        let text = String::from_utf8(read(&format!("{name}.md"))?)?;
        let title = title_of(&text);
        write!(list, "<li><a href=\"guides/{name}\">{title}</a></li>")?;
        let page = page(title, "..", &as_html(&text));
        files.push((format!("{name}.html"), page.into_bytes()));
    }
    let index = page("Guides", ".", &format!("<h1>Guides</h1><ul>{list}</ul>"));
    files.push(("index.html".to_owned(), index.into_bytes()));
    for name in FIGURES {
        let path = format!("figures/{name}");
        let bytes = read(&path)?;
        files.push((path, bytes));
    }
    Ok(files)
}

fn read(name: &str) -> io::Result<Vec<u8>> {
    let path = format!("docs/{name}");
    println!("cargo:rerun-if-changed={path}");
    fs::read(path)
}

fn title_of(text: &str) -> &str {
    let first = text.lines().next().unwrap_or_default();
    first.trim_start_matches('#').trim()
}

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
    // Content wider than the page scrolls by itself, by keys too.
    page.replace(
        "<table>",
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Table\"><table>",
    )
    .replace("</table>", "</table></div>")
    .replace("<pre>", "<pre tabindex=\"0\">")
}

/// Where a link of a guide leads to in the program; none where it leads to a file that is not served.
fn address_of(link: &str) -> Option<CowStr<'static>> {
    if link.starts_with('#') || link.starts_with("https://") {
        return Some(link.to_owned().into());
    }
    let (file, fragment) = link.split_once('#').unwrap_or((link, ""));
    let name = file.strip_suffix(".md")?;
    GUIDES.iter().find(|guide| **guide == name)?;
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
