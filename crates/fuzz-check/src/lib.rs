//! Bytes as a submission, a preview, a study, a REXS model and a drawing: whatever they are, reading ends in a document or a problem, and what was
//! read is read again from its echo, or from the model that it is written as.

use meshwright_engine::run::Run;
use meshwright_exchange::dxf::outline;
use meshwright_exchange::rexs::{Choices, import, is_model};
use meshwright_wire::{Preview, Problem, Searching, Study, Submission, model_of};

/// So many designs of a study are expanded.
const DESIGNS: usize = 8;

/// Reads `bytes` as all that they might be.
///
/// # Panics
///
/// If something does not hold that should, whatever they are.
pub fn check(bytes: &[u8]) {
    // Loops, or why there are none.
    let _ = outline(bytes, &[]);
    if is_model(bytes) {
        check_model(bytes);
        return;
    }
    match Submission::parse(bytes) {
        Ok(submission) => {
            let again = Submission::parse(submission.canonical_json().as_bytes());
            let again = again.expect("an echo is valid");
            assert_eq!(again.input_hash(), submission.input_hash());
        }
        Err(problem) => check_problem(&problem),
    }
    if let Err(problem) = Preview::parse(bytes, 4000) {
        check_problem(&problem);
    }
    match Study::submitted(bytes, &Run::unattended()) {
        Ok(study) => check_study(&study),
        Err(problem) => check_problem(&problem),
    }
}

/// Takes a model, and writes what it comes to as one that can be taken again.
fn check_model(bytes: &[u8]) {
    let Ok(imported) = import(bytes, &Choices::default()) else {
        return;
    };
    match Submission::parse(imported.submission.to_string().as_bytes()) {
        Ok(submission) => {
            let model = model_of(&submission, None, "");
            import(model.as_bytes(), &Choices::default()).expect("what is written can be read");
        }
        Err(problem) => check_problem(&problem),
    }
}

/// Expands the first designs.
fn check_study(study: &Study) {
    if let Some(mut search) = Searching::new(study.clone()) {
        for row in 0..search.ask().min(DESIGNS) {
            if let Err(problem) = &search.design(row).submission {
                check_problem(problem);
            }
        }
        return;
    }
    for row in 0..study.total().min(DESIGNS) {
        let design = study.design(row).expect("there are so many");
        if let Err(problem) = &design.submission {
            check_problem(problem);
        }
    }
    assert!(study.design(study.total()).is_none());
}

fn check_problem(problem: &Problem) {
    assert!([400, 422].contains(&problem.status), "{problem:?}");
    assert!(!problem.detail.contains("NaN"), "{problem:?}");
    for error in &problem.errors {
        assert!(error.nearest.is_none_or(f64::is_finite), "{error:?}");
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::path::Path;

    use super::*;

    /// So many inputs, the same in every run.
    const INPUTS: usize = 40_000;

    /// What may stand where a number or a word is expected.
    const TOKENS: &[&str] = &[
        "0",
        "-0.0",
        "-1",
        "1",
        "2",
        "0.1",
        "1e-320",
        "1e308",
        "-1e308",
        "1e999",
        "4294967296",
        "9007199254740993",
        "17.5",
        "null",
        "true",
        "\"\"",
        "\"infinity\"",
        "\"/pair/driven\"",
        "\"flexible\"",
        "\"three_dimensional\"",
        "[]",
        "{}",
        "[[]]",
        "[0,1]",
        "{\"count\":3}",
        "\u{feff}",
        "\\u0000",
        "&#1;",
        "e",
        "-",
        "\"",
    ];

    /// A xorshift generator.
    struct Chance(u64);

    impl Chance {
        fn below(&mut self, end: usize) -> usize {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 % end.max(1) as u64) as usize
        }

        /// A piece of `text` of at most `most` bytes, by its ends.
        fn piece(&mut self, text: &[u8], most: usize) -> std::ops::Range<usize> {
            let from = self.below(text.len() + 1);
            from..(from + self.below(most)).min(text.len())
        }

        /// A number or word of `text`, by its ends; nothing where there is none.
        fn token(&mut self, text: &[u8]) -> std::ops::Range<usize> {
            let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-._\"/".contains(byte);
            let start = self.below(text.len() + 1);
            let behind = |at: usize, of: fn(bool) -> bool| {
                let rest = text[at..].iter().position(|byte| of(is_part(byte)));
                rest.map_or(text.len(), |steps| at + steps)
            };
            // Of a word that chance falls into, the next one.
            let from = behind(behind(start, |part| !part), |part| part);
            from..behind(from, |part| !part)
        }

        /// A number of `text`, by its ends; nothing where there is none.
        fn number(&mut self, text: &[u8]) -> std::ops::Range<usize> {
            let start = self.below(text.len() + 1);
            let rest = text[start..].iter().position(u8::is_ascii_digit);
            let from = rest.map_or(text.len(), |steps| start + steps);
            let is_part = |byte: &&u8| byte.is_ascii_digit() || **byte == b'.';
            from..from + text[from..].iter().take_while(is_part).count()
        }

        /// `text` with something in it changed, or something of `other` put into it.
        fn change(&mut self, text: &mut Vec<u8>, other: &[u8]) {
            match self.below(12) {
                0 => {
                    let at = self.below(text.len());
                    if let Some(byte) = text.get_mut(at) {
                        *byte ^= 1 << (at % 8);
                    }
                }
                1 => drop(text.drain(self.piece(text, 40))),
                2 => {
                    let piece = text[self.piece(text, 200)].to_vec();
                    let at = self.below(text.len() + 1);
                    text.splice(at..at, piece);
                }
                3 => {
                    let piece = other[self.piece(other, 400)].to_vec();
                    let at = self.piece(text, 400);
                    text.splice(at, piece);
                }
                4 => text.truncate(self.below(text.len() + 1)),
                5..=8 => {
                    let number = [0.0, 0.5, 1.0, 2.0, 17.0, 40.0, 1e-3, 1e6][self.below(8)]
                        + self.below(100) as f64 / 16.0;
                    text.splice(self.number(text), number.to_string().bytes());
                }
                _ => {
                    let token = TOKENS[self.below(TOKENS.len())];
                    text.splice(self.token(text), token.bytes());
                }
            }
        }
    }

    /// What `crates/fuzz/run` looks for with coverage and for as long as one likes, over mangled examples.
    #[test]
    fn mangled_examples_are_read_or_refused() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../api/examples");
        let files = std::fs::read_dir(folder).expect("the examples");
        let mut files: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
        files.sort();
        let texts: Vec<Vec<u8>> = files
            .iter()
            .map(|file| std::fs::read(file).expect("a file"))
            .collect();
        assert!(texts.len() > 10, "{files:?}");
        let mut chance = Chance(0x9e37_79b9_7f4a_7c15);
        let mut read = 0;
        for input in 0..INPUTS {
            let mut text = texts[input % texts.len()].clone();
            let other = &texts[chance.below(texts.len())];
            for _ in 0..=chance.below(3) {
                chance.change(&mut text, other);
            }
            let outcome = catch_unwind(AssertUnwindSafe(|| check(&text)));
            assert!(
                outcome.is_ok(),
                "input {input}: {}",
                String::from_utf8_lossy(&text)
            );
            read += usize::from(Submission::parse(&text).is_ok());
        }
        // Else chance does not reach beyond the first brace.
        assert!(
            (INPUTS / 100..INPUTS).contains(&read),
            "{read} of them are submissions"
        );
    }
}
