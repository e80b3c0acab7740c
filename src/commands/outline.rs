//! `meshwright outline`: the openings of a blank out of a drawing in DXF.

use std::path::PathBuf;
use std::process::ExitCode;

use meshwright_exchange::dxf::{Choices, TOLERANCE_MM, outline};

use super::document::{EXIT_PROBLEM, number, read, write};

/// Read the openings of a blank from a DXF drawing: the `blank.outline` of a submission.
#[derive(Debug, clap::Args)]
pub(crate) struct Outline {
    /// The drawing, DXF as text; - reads standard input.
    drawing: PathBuf,
    /// Read this layer only; may be given several times.
    #[arg(long, value_name = "NAME")]
    layer: Vec<String>,
    /// Position of the gear's axis, in the unit of the drawing [default: its origin].
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    center: Option<[f64; 2]>,
    /// Join ends that are at most this far apart, 0 to 0.1 mm.
    #[arg(long, value_name = "MM", default_value_t = TOLERANCE_MM, value_parser = number)]
    tolerance: f64,
    /// Radius of the bore, where the drawing shows it with a keyway or splines; that contour is left out then.
    #[arg(long, value_name = "MM", value_parser = number)]
    bore_radius: Option<f64>,
    /// Where to write the outline.
    #[arg(long, short, default_value = "-")]
    output: PathBuf,
}

impl Outline {
    /// Runs the command and prints the assumptions and the entities left out.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or written. Faults of the drawing are printed and end with exit code 2.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        let choices = Choices {
            layers: self.layer.clone(),
            center: self.center,
            tolerance_mm: self.tolerance,
            bore_radius_mm: self.bore_radius,
        };
        match outline(&read(&self.drawing)?, &choices) {
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

/// The point that `X,Y` says.
fn point(text: &str) -> Result<[f64; 2], String> {
    meshwright_exchange::dxf::point(text)
        .ok_or_else(|| "two numbers with a comma between them are expected".to_owned())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use clap::Parser;

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
            center: None,
            tolerance: TOLERANCE_MM,
            bore_radius: None,
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
    #[derive(Debug, clap::Parser)]
    struct Line {
        #[command(flatten)]
        outline: Outline,
    }

    #[test]
    fn a_center_is_two_numbers_which_may_be_negative() {
        let read = |center: &str| Line::try_parse_from(["outline", "a.dxf", "--center", center]);
        let center = |text: &str| read(text).expect("a center").outline.center;
        assert_eq!(center("-12.5,80"), Some([-12.5, 80.0]));
        assert_eq!(center("1e2, -3"), Some([100.0, -3.0]));
        for wrong in ["12", "12;80", "1,2,3", "1,", "nan,0"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
