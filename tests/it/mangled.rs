//! Examples that chance has mangled, as all that they might be: what `crates/fuzz/run` looks for with coverage, and for as long as one likes.

use std::fs;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

use meshwright_fuzz_check::check;
use meshwright_wire::Submission;

use crate::generated::Chance;

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

/// A piece of `text` of at most `most` bytes, by its ends.
fn piece_of(chance: &mut Chance, text: &[u8], most: usize) -> Range<usize> {
    let from = chance.below(text.len() + 1);
    from..(from + chance.below(most)).min(text.len())
}

/// A number or word of `text`, by its ends; nothing where there is none.
fn token_of(chance: &mut Chance, text: &[u8]) -> Range<usize> {
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-._\"/".contains(byte);
    let start = chance.below(text.len() + 1);
    let behind = |at: usize, of: fn(bool) -> bool| {
        let rest = text[at..].iter().position(|byte| of(is_part(byte)));
        rest.map_or(text.len(), |steps| at + steps)
    };
    // Of a word that chance falls into, the next one.
    let from = behind(behind(start, |part| !part), |part| part);
    from..behind(from, |part| !part)
}

/// A number of `text`, by its ends; nothing where there is none.
fn number_of(chance: &mut Chance, text: &[u8]) -> Range<usize> {
    let start = chance.below(text.len() + 1);
    let rest = text[start..].iter().position(u8::is_ascii_digit);
    let from = rest.map_or(text.len(), |steps| start + steps);
    let is_part = |byte: &&u8| byte.is_ascii_digit() || **byte == b'.';
    from..from + text[from..].iter().take_while(is_part).count()
}

/// `text` with something in it changed, or something of `other` put into it.
fn change(chance: &mut Chance, text: &mut Vec<u8>, other: &[u8]) {
    match chance.below(12) {
        0 => {
            let at = chance.below(text.len());
            if let Some(byte) = text.get_mut(at) {
                *byte ^= 1 << (at % 8);
            }
        }
        1 => drop(text.drain(piece_of(chance, text, 40))),
        2 => {
            let piece = text[piece_of(chance, text, 200)].to_vec();
            let at = chance.below(text.len() + 1);
            text.splice(at..at, piece);
        }
        3 => {
            let piece = other[piece_of(chance, other, 400)].to_vec();
            let at = piece_of(chance, text, 400);
            text.splice(at, piece);
        }
        4 => text.truncate(chance.below(text.len() + 1)),
        5..=8 => {
            let number = [0.0, 0.5, 1.0, 2.0, 17.0, 40.0, 1e-3, 1e6][chance.below(8)]
                + chance.below(100) as f64 / 16.0;
            text.splice(number_of(chance, text), number.to_string().bytes());
        }
        _ => {
            let token = TOKENS[chance.below(TOKENS.len())];
            text.splice(token_of(chance, text), token.bytes());
        }
    }
}

#[test]
#[ignore = "./test all"]
fn mangled_examples_are_read_or_refused() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/api/examples");
    let files = fs::read_dir(folder).unwrap();
    let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    let texts: Vec<Vec<u8>> = files.iter().map(|file| fs::read(file).unwrap()).collect();
    assert!(texts.len() > 10, "{files:?}");
    let mut chance = Chance(0x9e37_79b9_7f4a_7c15);
    let mut read = 0;
    for input in 0..INPUTS {
        let mut text = texts[input % texts.len()].clone();
        let other = &texts[chance.below(texts.len())];
        for _ in 0..=chance.below(3) {
            change(&mut chance, &mut text, other);
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
