//! Tables as CSV (RFC 4180) for spreadsheets: a text of a client never becomes a formula.

use std::borrow::Cow;

use serde_json::Value;

/// A table that grows cell by cell. Lines end with CR LF.
pub struct CsvWriter {
    inner: csv::Writer<Vec<u8>>,
    line: Vec<String>,
}

impl Default for CsvWriter {
    /// An empty table.
    fn default() -> Self {
        let builder = csv::WriterBuilder::new()
            .terminator(csv::Terminator::CRLF)
            .flexible(true)
            .from_writer(Vec::new());
        Self {
            inner: builder,
            line: Vec::new(),
        }
    }
}

impl CsvWriter {
    /// A cell of text, which may be anybody's.
    pub fn text(&mut self, text: &str) {
        self.line.push(neutral(text).into_owned());
    }

    /// A cell of a number as JSON writes it; nothing for none.
    pub fn number(&mut self, value: Option<f64>) {
        self.line
            .push(value.map_or_else(String::new, |value| Value::from(value).to_string()));
    }

    /// A cell of whatever JSON has; nothing for null.
    pub fn value(&mut self, value: Option<&Value>) {
        match value {
            None | Some(Value::Null) => self.line.push(String::new()),
            Some(Value::String(text)) => self.text(text),
            Some(Value::Number(number)) => self.line.push(number.to_string()),
            Some(other) => self.text(&other.to_string()),
        }
    }

    /// Ends the line.
    pub fn end_line(&mut self) {
        self.inner
            .write_record(&self.line)
            .expect("memory takes every line");
        self.line.clear();
    }

    /// The text so far.
    pub fn into_text(self) -> String {
        let bytes = self.inner.into_inner().ok();
        let bytes = bytes.expect("memory takes every line");
        String::from_utf8(bytes).expect("cells are text")
    }
}

/// Characters that begin a formula in a spreadsheet.
const BEGIN_A_FORMULA: [char; 8] = ['=', '+', '-', '@', '＝', '＋', '－', '＠'];

/// A text that spreadsheets read as text. They read one that begins with certain characters as a formula, which may call programs and addresses, some of them
/// also behind invisible characters; an apostrophe before it prevents that. A number may keep its sign.
fn neutral(text: &str) -> Cow<'_, str> {
    let is_number = text.parse::<f64>().is_ok_and(f64::is_finite);
    let first = text.chars().find(|letter| can_be_seen(*letter));
    let is_formula = first.is_some_and(|first| BEGIN_A_FORMULA.contains(&first))
        || text.starts_with(['\t', '\r', '\n']);
    if is_formula && !is_number {
        format!("'{text}").into()
    } else {
        text.into()
    }
}

/// Letters, figures and the signs of ASCII can. Of all others (blanks, marks of direction, of joining and of variants, some of which no list
/// has) it is not relied upon.
fn can_be_seen(letter: char) -> bool {
    /// Letters of Hangul that stand for one that is not there.
    const FILLERS: [char; 4] = ['\u{115f}', '\u{1160}', '\u{3164}', '\u{ffa0}'];
    letter.is_ascii_graphic()
        || BEGIN_A_FORMULA.contains(&letter)
        || letter.is_alphanumeric() && !FILLERS.contains(&letter)
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
            ("\u{61c}=1", "'\u{61c}=1"),
            ("\u{34f}=1", "'\u{34f}=1"),
            ("\u{fe0f}=1", "'\u{fe0f}=1"),
            ("\u{3164}=1", "'\u{3164}=1"),
            ("\u{2800}\u{e0020}＝1", "'\u{2800}\u{e0020}＝1"),
            ("é=1", "é=1"),
            ("10°-20°", "10°-20°"),
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
        let mut table = CsvWriter::default();
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
