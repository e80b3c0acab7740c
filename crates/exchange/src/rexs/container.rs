//! The containers of the standard: XML, JSON, and either of them packed in a zip archive, known by their first bytes. And the encoding of a text, by its own
//! declaration.

use std::borrow::Cow;
use std::io::{Cursor, Read};

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE};
use serde::Deserialize;
use serde::de::IgnoredAny;
use zip::ZipArchive;

use super::fault::{Fault, Refused};

/// First bytes of an archive: its first file, or its end where it has none.
const ARCHIVES: [&[u8]; 2] = [b"PK\x03\x04", b"PK\x05\x06"];

/// First bytes of a file's entry in the list of an archive.
const LISTED: &[u8] = b"PK\x01\x02";

/// The most files of an archive, which bounds the memory of their list. A model has some of others beside it.
const MOST_FILES: usize = 1000;

/// True if `document` is a model rather than a submission: an archive, XML, or JSON with a `model`.
pub fn is_model(document: &[u8]) -> bool {
    /// JSON of which one name is known.
    #[derive(Deserialize)]
    struct Known {
        #[serde(rename = "model")]
        _model: IgnoredAny,
    }
    is_packed(document)
        || decoded(document).is_ok_and(|text| {
            text.trim_start().starts_with('<') || serde_json::from_str::<Known>(&text).is_ok()
        })
}

/// True if `document` is an archive, whose model is still to be unpacked.
pub fn is_packed(document: &[u8]) -> bool {
    ARCHIVES.iter().any(|begin| document.starts_with(begin))
}

/// The model of an archive, or `document` itself if it is none: `most` bytes at the most, of which no more are unpacked whatever the
/// archive says.
///
/// # Errors
///
/// If it has more bytes, if the archive cannot be read, or if not exactly one file in it is a model by its name.
pub fn unpacked(document: &[u8], most: usize) -> Result<Cow<'_, [u8]>, Refused> {
    let bytes = if is_packed(document) {
        Cow::Owned(model_of_archive(document, most).map_err(of_file)?)
    } else {
        Cow::Borrowed(document)
    };
    if bytes.len() > most {
        let length = if is_packed(document) {
            "more".to_owned()
        } else {
            bytes.len().to_string()
        };
        let detail = format!("It has {length} bytes; at most {most} are read.");
        return Err(of_file(detail));
    }
    Ok(bytes)
}

/// A fault of the file as a whole.
pub(super) fn of_file(detail: String) -> Refused {
    Fault::new("the file", detail).into()
}

/// The one model in an archive, cut off after one byte more than `most`.
fn model_of_archive(archive: &[u8], most: usize) -> Result<Vec<u8>, String> {
    let broken = |error: &dyn std::fmt::Display| format!("It cannot be unpacked: {error}.");
    let files = archive
        .windows(LISTED.len())
        .filter(|bytes| *bytes == LISTED)
        .count();
    if files > MOST_FILES {
        return Err(format!(
            "It is an archive of {files} files; at most {MOST_FILES} are read."
        ));
    }
    let mut files = ZipArchive::new(Cursor::new(archive)).map_err(|error| broken(&error))?;
    let is_model = |name: &str| {
        let file = name.rsplit(['/', '\\']).next().unwrap_or_default();
        let file = file.to_ascii_lowercase();
        // Some systems pack notes of their own beside each file, under its name.
        !file.starts_with('.') && (file.ends_with(".rexs") || file.ends_with(".rexsj"))
    };
    let names = files.file_names().filter_map(Result::ok);
    let models: Vec<String> = names
        .filter(|name| is_model(name))
        .map(|name| name.into_owned())
        .collect();
    let [model] = models.as_slice() else {
        return Err(format!(
            "It is an archive in which {} files end in .rexs or .rexsj; one model is read.",
            models.len()
        ));
    };
    let file = files.by_name(model).map_err(|error| broken(&error))?;
    let mut bytes = Vec::new();
    let read = file.take(most as u64 + 1).read_to_end(&mut bytes);
    read.map_err(|error| broken(&error))?;
    Ok(bytes)
}

/// The text of a document: as the mark at its beginning says, or the declaration of XML, or else in UTF-8.
///
/// # Errors
///
/// A sentence, if its encoding is not known or the bytes are none of it.
pub(super) fn decoded(bytes: &[u8]) -> Result<Cow<'_, str>, String> {
    let (encoding, bytes) = match Encoding::for_bom(bytes) {
        Some((encoding, mark)) => (encoding, &bytes[mark..]),
        None => (declared(bytes)?, bytes),
    };
    if encoding == UTF_8 {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            format!(
                "It is no UTF-8 after byte {}, which it has to be where its declaration says nothing else.",
                error.valid_up_to()
            )
        })?;
        return Ok(Cow::Borrowed(text));
    }
    encoding
        .decode_without_bom_handling_and_without_replacement(bytes)
        .ok_or_else(|| format!("It is no {}, which it says to be.", encoding.name()))
}

/// The encoding that a document without a mark says to be in.
fn declared(bytes: &[u8]) -> Result<&'static Encoding, String> {
    match bytes {
        [b'<' | b'{', 0, ..] => return Ok(UTF_16LE),
        [0, b'<' | b'{', ..] => return Ok(UTF_16BE),
        _ => {}
    }
    let head = &bytes[..bytes.len().min(200)];
    let head = String::from_utf8_lossy(head);
    let declaration = head
        .strip_prefix("<?xml")
        .and_then(|rest| rest.split_once("?>"));
    let said = declaration.and_then(|(declaration, _)| {
        let (_, said) = declaration.split_once("encoding")?;
        let said = said.trim_start().strip_prefix('=')?.trim_start();
        let quote = said.chars().next().filter(|c| matches!(c, '"' | '\''))?;
        said[1..].split(quote).next().map(str::to_owned)
    });
    let Some(said) = said else {
        return Ok(UTF_8);
    };
    let encoding = Encoding::for_label(said.as_bytes()).ok_or_else(|| {
        format!("Its declaration says that it is in \"{said}\", which is not known here.")
    })?;
    // Texts of UTF-16 that were written to a file in bytes still say so.
    let wide = encoding == UTF_16LE || encoding == UTF_16BE;
    Ok(if wide { UTF_8 } else { encoding })
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in files {
            archive
                .start_file(*name, SimpleFileOptions::default())
                .expect("a file");
            archive.write_all(bytes).expect("bytes");
        }
        archive.finish().expect("an archive").into_inner()
    }

    #[test]
    fn the_model_of_an_archive_is_the_one_that_is_called_so() {
        let packed = archive(&[
            ("notes/a.knd", b"x"),
            ("__MACOSX/._a.rexsj", b"y"),
            ("a/A.REXSJ", b"{}"),
        ]);
        assert_eq!(unpacked(&packed, 2).expect("a model").as_ref(), b"{}");
        let told = |files: &[(&str, &[u8])]| {
            let refused = unpacked(&archive(files), 100).expect_err("no model");
            refused.to_string()
        };
        assert!(told(&[("a.txt", b"")]).contains("0 files end in .rexs"));
        assert!(told(&[]).contains("an archive in which 0 files end in .rexs"));
        let two: [(&str, &[u8]); 2] = [("a.rexs", b""), ("b.rexs", b"")];
        assert!(told(&two).contains("2 files end in .rexs"));
        let cut = &packed[..packed.len() - 30];
        let refused = unpacked(cut, 100).expect_err("cut off").to_string();
        assert!(refused.contains("unpacked"), "{refused}");
    }

    #[test]
    fn no_more_is_unpacked_than_may_be_read() {
        // A million bytes in a thousand.
        let packed = archive(&[("a.rexs", &vec![b' '; 1 << 20])]);
        assert!(packed.len() < 2000, "{}", packed.len());
        assert!(unpacked(&packed, 1 << 20).is_ok());
        let refused = unpacked(&packed, (1 << 20) - 1).expect_err("one byte too many");
        assert!(refused.to_string().contains("1048575"), "{refused}");
        let names: Vec<String> = (0..1001).map(|i| format!("{i}")).collect();
        let many: Vec<(&str, &[u8])> = names.iter().map(|name| (name.as_str(), &b""[..])).collect();
        let refused = unpacked(&archive(&many), 100).expect_err("too many files");
        assert!(refused.to_string().contains("1001 files"), "{refused}");
    }

    #[test]
    fn a_text_is_in_the_encoding_that_it_declares() {
        let declared = |encoding: &str| format!("<?xml version='1.0' encoding='{encoding}'?><µ/>");
        let utf_16 = |text: &str, mark: &[u8], bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
            mark.iter()
                .copied()
                .chain(text.encode_utf16().flat_map(bytes))
                .collect()
        };
        let latin = |text: &str| -> Vec<u8> { text.chars().map(|c| c as u8).collect() };
        #[rustfmt::skip]
        let cases = [
            (declared("UTF-8").into_bytes(), declared("UTF-8")),
            (declared("utf-16").into_bytes(), declared("utf-16")),
            (latin(&declared("ISO-8859-1")), declared("ISO-8859-1")),
            (latin(&declared("windows-1252")), declared("windows-1252")),
            (utf_16(&declared("UTF-16"), b"\xFF\xFE", u16::to_le_bytes), declared("UTF-16")),
            (utf_16(&declared("UTF-16"), b"\xFE\xFF", u16::to_be_bytes), declared("UTF-16")),
            (utf_16(&declared("UTF-16"), b"", u16::to_le_bytes), declared("UTF-16")),
            ("\u{FEFF}<µ/>".to_owned().into_bytes(), "<µ/>".to_owned()),
            (b"{}".to_vec(), "{}".to_owned()),
        ];
        for (bytes, text) in cases {
            assert_eq!(decoded(&bytes).expect("known"), text);
        }
        let unknown = decoded(b"<?xml version='1.0' encoding='EBCDIC-X'?>");
        assert!(unknown.expect_err("unknown").contains("EBCDIC-X"));
        let broken = decoded(b"<\xFC/>").expect_err("no UTF-8");
        assert!(broken.contains("after byte 1"), "{broken}");
        let odd = decoded(b"\xFF\xFE<").expect_err("half a character");
        assert!(odd.contains("UTF-16LE"), "{odd}");
    }
}
