//! Packs the files that are part of the program, once: those of the page, those of the documentation, and the guides, which it makes of their text.

mod guides;

use std::error::Error;
use std::fs;
use std::io::{Cursor, Read, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use zip::ZipArchive;

/// Parts of the page of the documentation, beside its beginning in `src/http/docs.js`.
const DOCS: [&str; 7] = [
    "favicon-16x16.png",
    "favicon-32x32.png",
    "index.css",
    "index.html",
    "swagger-ui-bundle.js",
    "swagger-ui-standalone-preset.js",
    "swagger-ui.css",
];

fn main() -> Result<(), Box<dyn Error>> {
    for input in ["build", "web", "src/http/docs.js"] {
        println!("cargo:rerun-if-changed={input}");
    }
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    let list = [
        list("PAGE", &page()?, &out.join("page"))?,
        list("DOCS", &docs()?, &out.join("docs"))?,
        list("GUIDES", &guides::files()?, &out.join("guides"))?,
    ];
    Ok(fs::write(out.join("files.rs"), list.concat())?)
}

/// A file by its name.
type Named = (String, Vec<u8>);

/// Every file in `web`, and in the folders there.
fn page() -> Result<Vec<Named>, Box<dyn Error>> {
    let (root, mut files) = (Path::new("web"), Vec::new());
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(root)?.to_str().ok_or("a name is text")?;
                files.push((name.replace('\\', "/"), fs::read(&path)?));
            }
        }
    }
    files.sort();
    Ok(files)
}

fn docs() -> Result<Vec<Named>, Box<dyn Error>> {
    let mut archive =
        ZipArchive::new(Cursor::new(utoipa_swagger_ui_vendored::SWAGGER_UI_VENDORED))?;
    let mut files = vec![(
        "swagger-initializer.js".to_owned(),
        fs::read("src/http/docs.js")?,
    )];
    for name in DOCS {
        let path = archive
            .file_names()
            .filter_map(Result::ok)
            .find(|path| path.ends_with(&format!("/dist/{name}")))
            .ok_or_else(|| format!("the documentation has no {name}"))?
            .into_owned();
        let mut bytes = Vec::new();
        archive.by_name(&path)?.read_to_end(&mut bytes)?;
        files.push((name.to_owned(), bytes));
    }
    Ok(files)
}

/// Writes each of `files` as it is and packed into `folder`, and gives the words in Rust by which the program has them.
fn list(constant: &str, files: &[Named], folder: &Path) -> Result<String, Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    let mut items = String::new();
    for (number, (name, bytes)) in files.iter().enumerate() {
        let [plain, packed] = ["", ".gz"].map(|end| folder.join(format!("{number}{end}")));
        fs::write(&plain, bytes)?;
        let mut encoder = GzEncoder::new(fs::File::create(&packed)?, Compression::best());
        encoder.write_all(bytes)?;
        encoder.finish()?;
        items += &format!("({name:?}, include_bytes!({plain:?}), include_bytes!({packed:?})), ");
    }
    Ok(format!(
        "pub(in crate::http) const {constant}: &[File] = &[{items}];\n"
    ))
}
