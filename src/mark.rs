//! The byte-order mark with which some programs begin a text in UTF-8.

/// A JSON document without the mark before it.
pub(crate) fn without_mark(document: &[u8]) -> &[u8] {
    const MARK: &[u8] = "\u{feff}".as_bytes();
    match document.strip_prefix(MARK) {
        // Whatever else begins with it has its own way of saying how it is encoded.
        Some(rest) if rest.trim_ascii_start().starts_with(b"{") => rest,
        _ => document,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_taken_from_a_document_and_from_nothing_else() {
        for (text, rest) in [
            ("\u{feff}{}", "{}"),
            ("\u{feff}\r\n {}", "\r\n {}"),
            ("{}", "{}"),
            ("\u{feff}<model/>", "\u{feff}<model/>"),
            ("\u{feff}\u{feff}{}", "\u{feff}\u{feff}{}"),
            ("", ""),
        ] {
            assert_eq!(without_mark(text.as_bytes()), rest.as_bytes(), "{text:?}");
        }
    }
}
