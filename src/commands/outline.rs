//! `meshwright outline`: the openings of a blank out of a drawing in DXF.

use std::path::PathBuf;
use std::process::ExitCode;

use meshwright_exchange::dxf::outline;

use super::document::{EXIT_PROBLEM, read, write};

/// Write the outline that a drawing comes to, for `blank.outline` of a submission.
#[derive(Debug, clap::Args)]
pub(crate) struct Outline {
    /// The drawing, DXF as text, the axis of the gear at its origin; - reads standard input.
    drawing: PathBuf,
    /// Take only what is on this layer; may be given several times.
    #[arg(long, value_name = "NAME")]
    layer: Vec<String>,
    /// Where to write the outline.
    #[arg(long, short, default_value = "-")]
    output: PathBuf,
}

impl Outline {
    /// Runs the command. What was assumed and left out is printed.
    ///
    /// # Errors
    ///
    /// If a file cannot be read or written. What is wrong with the drawing is printed, and is exit code 2.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        match outline(&read(&self.drawing)?, &self.layer) {
            Ok(outline) => {
                for remark in &outline.remarks {
                    eprintln!("{remark}");
                }
                write(&self.output, &outline.to_json())?;
                Ok(ExitCode::SUCCESS)
            }
            Err(refused) => {
                eprint!("{refused}");
                Ok(ExitCode::from(EXIT_PROBLEM))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn an_outline_is_written_and_a_drawing_that_is_refused_is_exit_code_two() {
        let folder = tempfile::tempdir().expect("a folder");
        let circle = "0\nCIRCLE\n8\nHoles\n10\n30\n20\n0\n40\n5\n";
        let entities = format!("{circle}0\nSPLINE\n8\nNotes\n");
        let text = format!("0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n");
        let mut command = Outline {
            drawing: folder.path().join("gear.dxf"),
            layer: vec!["Holes".to_owned()],
            output: folder.path().join("outline.json"),
        };
        fs::write(&command.drawing, text).expect("written");
        let code = command.run().expect("runs");
        assert_eq!(format!("{code:?}"), format!("{:?}", ExitCode::SUCCESS));
        let written = fs::read_to_string(&command.output).expect("an outline");
        let expected = "[\n  [\n    {\"arc_to\":[25.0,0.0],\"through\":[30.0,-5.0]},\n    {\"arc_to\":[35.0,0.0],\"through\":[30.0,5.0]}\n  ]\n]\n";
        assert_eq!(written, expected);
        command.layer.clear();
        let code = command.run().expect("runs");
        assert_eq!(
            format!("{code:?}"),
            format!("{:?}", ExitCode::from(EXIT_PROBLEM))
        );
    }
}
