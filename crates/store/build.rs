//! Lists the migrations of the database.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new("../../migrations");
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed={}", root.display());
    let migrations = [
        migrations("SQLITE", root)?,
        migrations("POSTGRES", &root.join("postgres"))?,
    ];
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    Ok(fs::write(out.join("migrations.rs"), migrations.concat())?)
}

/// The files of `folder` in the order of their numbers, in the words in Rust by which the program has them.
fn migrations(constant: &str, folder: &Path) -> Result<String, Box<dyn Error>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|end| end == "sql") {
            let stem = path.file_stem().and_then(|stem| stem.to_str());
            let (version, name) = stem
                .and_then(|stem| stem.split_once('_'))
                .ok_or_else(|| format!("{} has no number and name", path.display()))?;
            let version: i64 = version.parse()?;
            files.push((version, name.replace('_', " "), fs::canonicalize(&path)?));
        }
    }
    files.sort();
    let items: String = files
        .iter()
        .map(|(version, name, path)| format!("({version}, {name:?}, include_str!({path:?})), "))
        .collect();
    Ok(format!(
        "pub(super) const {constant}: &[(i64, &str, &str)] = &[{items}];\n"
    ))
}
