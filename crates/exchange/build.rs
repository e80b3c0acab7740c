//! Compiles the FMU where a C compiler is.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const SOURCE: &str = "../fmu/meshwright_mesh.c";

fn main() -> Result<(), Box<dyn Error>> {
    for input in ["build.rs", "../fmu"] {
        println!("cargo:rerun-if-changed={input}");
    }
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    Ok(fs::write(out.join("fmu.rs"), fmu(&out)?)?)
}

/// Compiles the program of the FMU for Linux, if that is the target, and for Windows, if its compiler is installed. Without a compiler the FMU has no program.
fn fmu(out: &Path) -> Result<String, Box<dyn Error>> {
    let target = std::env::var("TARGET")?;
    let is_linux = target.starts_with("x86_64-") && target.contains("-linux-");
    let native = (is_linux && target == std::env::var("HOST")?)
        .then(|| std::env::var("CC").unwrap_or_else(|_| "cc".to_owned()));
    let mut items = String::new();
    for (compiler, path) in [
        (native, "linux64/meshwright_mesh.so"),
        (
            Some("x86_64-w64-mingw32-gcc".to_owned()),
            "win64/meshwright_mesh.dll",
        ),
    ] {
        let Some(compiler) = compiler else { continue };
        let file = out.join(path.replace('/', "-"));
        let done = Command::new(compiler)
            .args([
                "-O2",
                "-std=c99",
                "-shared",
                "-fPIC",
                "-fvisibility=hidden",
                "-o",
            ])
            .arg(&file)
            .args([SOURCE, "-lm"])
            .output();
        if done.is_ok_and(|done| done.status.success()) {
            items += &format!("({path:?}, include_bytes!({file:?})), ");
        }
    }
    Ok(format!("const BINARIES: &[(&str, &[u8])] = &[{items}];\n"))
}
