//! Tables as CSV (RFC 4180) that a spreadsheet may open: what a client wrote never becomes a formula.

use std::borrow::Cow;

use serde_json::Value;

/// A table that grows cell by cell. Lines end with CR LF.
pub(crate) struct CsvWriter {
    inner: csv::Writer<Vec<u8>>,
    line: Vec<String>,
}

impl CsvWriter {
    /// An empty table.
    pub(crate) fn new() -> Self {
        let builder = csv::WriterBuilder::new()
            .terminator(csv::Terminator::CRLF)
            .flexible(true)
            .from_writer(Vec::new());
        Self {
            inner: builder,
            line: Vec::new(),
        }
    }

    /// A cell of text, which may be anybody's.
    pub(crate) fn text(&mut self, text: &str) {
        self.line.push(neutral(text).into_owned());
    }

    /// A cell of a number as JSON writes it; nothing for none.
    pub(crate) fn number(&mut self, value: Option<f64>) {
        self.line
            .push(value.map_or_else(String::new, |value| Value::from(value).to_string()));
    }

    /// A cell of whatever JSON has; nothing for null.
    pub(crate) fn value(&mut self, value: Option<&Value>) {
        match value {
            None | Some(Value::Null) => self.line.push(String::new()),
            Some(Value::String(text)) => self.text(text),
            Some(Value::Number(number)) => self.line.push(number.to_string()),
            Some(other) => self.text(&other.to_string()),
        }
    }

    /// Ends the line.
    pub(crate) fn end_line(&mut self) {
        self.inner
            .write_record(&self.line)
            .expect("memory takes every line");
        self.line.clear();
    }

    /// The text so far.
    pub(crate) fn into_text(self) -> String {
        let bytes = self.inner.into_inner().ok();
        let bytes = bytes.expect("memory takes every line");
        String::from_utf8(bytes).expect("cells are text")
    }
}

/// A text that spreadsheets take for text. They take one that begins with these characters for a formula, which may call
/// programs and addresses, some of them also behind what cannot be seen; an apostrophe before it prevents that. A number may keep
/// its sign.
fn neutral(text: &str) -> Cow<'_, str> {
    const BEGIN_A_FORMULA: [char; 8] = ['=', '+', '-', '@', '＝', '＋', '－', '＠'];
    let is_number = text.parse::<f64>().is_ok_and(f64::is_finite);
    let seen = text.trim_start_matches(cannot_be_seen);
    let is_formula = seen.starts_with(BEGIN_A_FORMULA) || text.starts_with(['\t', '\r', '\n']);
    if is_formula && !is_number {
        format!("'{text}").into()
    } else {
        text.into()
    }
}

/// Blanks of every width, controls, and marks of direction and joining.
fn cannot_be_seen(letter: char) -> bool {
    letter.is_whitespace()
        || letter.is_control()
        || matches!(letter, '\u{ad}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_that_begins_a_formula_is_neutralized_and_a_number_is_not() {
        for (text, written) in [
            ("=HYPERLINK(\"http://x\")", "'=HYPERLINK(\"http://x\")"),
            ("+1+1", "'+1+1"),
            ("-1-1", "'-1-1"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("\tx", "'\tx"),
            ("\rx", "'\rx"),
            ("＝1", "'＝1"),
            (" =1", "' =1"),
            ("\u{a0}=1", "'\u{a0}=1"),
            ("\u{200b}=1", "'\u{200b}=1"),
            ("\u{feff} \u{200b}@x", "'\u{feff} \u{200b}@x"),
            ("\0=1", "'\0=1"),
            (" a=1", " a=1"),
            ("-1.5", "-1.5"),
            ("+1e3", "+1e3"),
            ("8R34", "8R34"),
            ("a=b", "a=b"),
            ("", ""),
        ] {
            assert_eq!(neutral(text), written);
        }
    }

    #[test]
    fn cells_are_quoted_where_they_have_to_be() {
        let mut table = CsvWriter::new();
        for text in ["a, \"b\"", "=1", "plain"] {
            table.text(text);
        }
        table.number(Some(-1.5));
        table.number(None);
        table.value(Some(&serde_json::json!(["=1"])));
        table.value(Some(&serde_json::json!(-7)));
        table.end_line();
        assert_eq!(
            table.into_text(),
            "\"a, \"\"b\"\"\",'=1,plain,-1.5,,\"[\"\"=1\"\"]\",-7\r\n"
        );
    }
}
