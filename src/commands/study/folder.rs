//! The folder of a study on the disk.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;

/// Where results are written.
pub(super) struct ResultFolder(PathBuf);

impl ResultFolder {
    pub(super) fn make(path: &Path) -> anyhow::Result<Self> {
        let results = path.join("results");
        fs::create_dir_all(&results)
            .with_context(|| format!("{} cannot be made", results.display()))?;
        Ok(Self(path.to_owned()))
    }

    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    pub(super) fn write(&self, name: &str, text: &str) -> anyhow::Result<()> {
        let path = self.0.join(name);
        fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))
    }

    pub(super) fn write_json(&self, name: &str, document: &impl Serialize) -> anyhow::Result<()> {
        let json = serde_json::to_string_pretty(document);
        let json = json.with_context(|| format!("{name} would be no JSON"))?;
        self.write(name, &format!("{json}\n"))
    }

    /// Writes a results document under the number of its row, from 1, and as much of its label as a file name bears.
    pub(super) fn write_result(
        &self,
        row: usize,
        label: &str,
        document: &str,
    ) -> anyhow::Result<()> {
        let plain = |c: char| {
            if c.is_ascii_alphanumeric() || ".-=".contains(c) {
                c
            } else {
                '_'
            }
        };
        let label: String = label.chars().map(plain).take(60).collect();
        self.write(&format!("results/{:05}-{label}.json", row + 1), document)
    }
}
