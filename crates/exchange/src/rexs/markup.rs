//! A check of a file before it is parsed: content that would make parsing take a time that grows with the square of its size.

/// The most attributes of one element, and the most declarations of namespaces in all: a reader of XML compares each with all
/// others, and those that are declared further out. Files have up to a dozen, and a few.
const MOST_XML_ATTRIBUTES: usize = 100;
const MOST_NAMESPACES: usize = 100;

/// Checks the elements of `text`. The reader reports text that is not XML.
///
/// # Errors
///
/// A sentence about the excessive content, and its place.
pub(super) fn check(text: &str) -> Result<(), String> {
    let (mut rest, mut namespaces) = (text, 0);
    while let Some(at) = rest.find('<') {
        rest = &rest[at..];
        let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")]
            .into_iter()
            .find(|(begin, _)| rest.starts_with(begin));
        if let Some((begin, end)) = skipped {
            let inside = &rest[begin.len()..];
            rest = inside.find(end).map_or("", |at| &inside[at..]);
            continue;
        }
        let tag = tag(rest);
        namespaces += tag.namespaces;
        let line = || text[..text.len() - rest.len()].matches('\n').count() + 1;
        if tag.attributes > MOST_XML_ATTRIBUTES {
            return Err(format!(
                "The element in line {} has {} attributes; at most {MOST_XML_ATTRIBUTES} are read.",
                line(),
                tag.attributes
            ));
        }
        if namespaces > MOST_NAMESPACES {
            return Err(format!(
                "More than {MOST_NAMESPACES} namespaces are declared, the last of them in line {}.",
                line()
            ));
        }
        rest = &rest[tag.length..];
    }
    Ok(())
}

/// Content between the brackets of an element.
struct Tag {
    length: usize,
    attributes: usize,
    namespaces: usize,
}

/// The element with which `text` begins: to its closing bracket, which does not stand between quotes.
fn tag(text: &str) -> Tag {
    let (mut attributes, mut quote, mut outside) = (0, None, Vec::new());
    let mut length = text.len();
    for (at, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (Some(open), close) if open == close => quote = None,
            (Some(_), _) => {}
            (None, b'"' | b'\'') => {
                quote = Some(byte);
                attributes += 1;
            }
            (None, b'>') => {
                length = at + 1;
                break;
            }
            (None, byte) => outside.push(byte),
        }
    }
    let namespaces = outside.windows(5).filter(|word| word == b"xmlns").count();
    Tag {
        length,
        attributes,
        namespaces,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_and_namespaces_are_counted_where_they_are_some() {
        let many = |count: usize| (0..count).map(|i| format!(" a{i}='1'")).collect::<String>();
        for text in [
            format!("<a{}/>", many(100)),
            format!("<a{0}/><a{0}/>", many(90)),
            format!("<!-- <a{}/> --><a/>", many(200)),
            format!("<a><![CDATA[<a{}>]]></a>", many(200)),
            format!("<a b='<c{}/>'/>", many(200).replace('\'', "\"")),
            "<a xmlns='u'/>".repeat(100),
            "<a b='".to_owned(),
            "<!-- ".to_owned(),
            "<".to_owned(),
        ] {
            assert_eq!(check(&text), Ok(()), "{text}");
        }
        let told = check(&format!("<m>\n<a{}/></m>", many(101))).unwrap_err();
        assert!(told.contains("line 2 has 101 attributes"), "{told}");
        // A bracket between quotes does not close an element.
        assert!(check(&format!("<a b='>'{}/>", many(100))).is_err());
        let nested: String = (0..101).map(|i| format!("<a xmlns:n{i}='u'>")).collect();
        assert!(check(&nested).unwrap_err().contains("100 namespaces"));
    }

    #[test]
    fn it_takes_as_long_as_the_file_is() {
        // Were it the square of it, this would take hours.
        let text = "<a b='1' c='>'><!-- <x --></a>\n".repeat(500_000);
        assert_eq!(check(&text), Ok(()));
    }
}
