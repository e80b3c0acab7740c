//! The force table of a pair as an FMU 2.0, for Model Exchange and Co-Simulation.
//!
//! The program of the FMU is the same for all jobs: a C file in `fmu`, compiled when this program is built where a C compiler is installed. The part of the job
//! is the table, a resource that it reads.

use std::io::{Cursor, Write};

use zip::result::ZipResult;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::digits::significant;
use super::force_table::{LEFT_OUT, MeshForces};

/// The program in C, which every FMU holds.
const SOURCE: &str = include_str!("../../fmu/meshwright_mesh.c");

// Compiled, by platform: `BINARIES`, a path in the FMU and its bytes.
include!(concat!(env!("OUT_DIR"), "/fmu.rs"));

const NAME: &str = "meshwright_mesh";

/// The name, the kind and the meaning of each variable, by its reference.
#[rustfmt::skip]
const VARIABLES: [(&str, &str, &str); 5] = [
    ("theta_1_rad", "input", "Angle of the driving gear, in the sense in which it turns"),
    ("theta_2_rad", "input", "Angle of the driven gear, in the sense in which it turns"),
    ("torque_1_n_m", "output", "Torque of the mesh on the driving gear"),
    ("torque_2_n_m", "output", "Torque of the mesh on the driven gear"),
    ("transmission_error_um", "output", "Approach along the line of action, positive where the driven gear lags"),
];

/// The FMU of `forces`, which a `guid` tells from others.
///
/// # Errors
///
/// None that memory does not make.
pub fn fmu(forces: &MeshForces, guid: &str) -> ZipResult<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    // The same job gives the same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(6))
        .last_modified_time(DateTime::default());
    let mut add = |name: &str, bytes: &[u8]| -> ZipResult<()> {
        archive.start_file(name, options)?;
        archive.write_all(bytes)?;
        Ok(())
    };
    add("modelDescription.xml", description(forces, guid).as_bytes())?;
    add("resources/table.bin", &forces.table_of_doubles())?;
    add(&format!("sources/{NAME}.c"), SOURCE.as_bytes())?;
    for (path, bytes) in BINARIES {
        add(&format!("binaries/{path}"), bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}

fn description(forces: &MeshForces, guid: &str) -> String {
    let compiled = if BINARIES.is_empty() {
        "It holds its source only: no C compiler was there when the service was built."
    } else {
        "It holds its source too."
    };
    let [z_1, z_2] = forces.tooth_counts();
    let [d_1, d_2] = forces.base_radii.map(|r| significant(2e3 * r, 6));
    let [least, largest] =
        [-1.0, 1.0].map(|sign| significant(sign * forces.largest_output_torque(), 6));
    let method = &forces.method;
    let variables: String = VARIABLES
        .iter()
        .enumerate()
        .map(|(reference, (name, causality, meaning))| {
            let start = if *causality == "input" { " start=\"0\"" } else { "" };
            let unit = match *name {
                name if name.ends_with("_rad") => "rad",
                name if name.ends_with("_um") => "um",
                _ => "N.m",
            };
            format!(
                "    <ScalarVariable name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"continuous\" description=\"{meaning}\">\n      <Real unit=\"{unit}\"{start}/>\n    </ScalarVariable>\n"
            )
        })
        .collect();
    let unknowns: String = (3..=5)
        .map(|index| format!("      <Unknown index=\"{index}\" dependencies=\"1 2\"/>\n"))
        .collect();
    let sources = format!("<SourceFiles><File name=\"{NAME}.c\"/></SourceFiles>");
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<fmiModelDescription fmiVersion=\"2.0\" modelName=\"Gear mesh {z_1}/{z_2}\" guid=\"{guid}\" description=\"The force between two gears over their angles: {z_1} and {z_2} teeth on base circles of {d_1} and {d_2} mm, by the method {method}. Output torques from {least} to {largest} N m; beyond them the force goes on straight. Angles in rad, torques in N m, transmission error in um. Left out: {LEFT_OUT}. {compiled}\" generationTool=\"Meshwright\" variableNamingConvention=\"flat\" numberOfEventIndicators=\"0\">
  <ModelExchange modelIdentifier=\"{NAME}\" completedIntegratorStepNotNeeded=\"true\">{sources}</ModelExchange>
  <CoSimulation modelIdentifier=\"{NAME}\" canHandleVariableCommunicationStepSize=\"true\">{sources}</CoSimulation>
  <UnitDefinitions>
    <Unit name=\"rad\"><BaseUnit rad=\"1\"/></Unit>
    <Unit name=\"um\"><BaseUnit m=\"1\" factor=\"1e-6\"/></Unit>
    <Unit name=\"N.m\"><BaseUnit kg=\"1\" m=\"2\" s=\"-2\"/></Unit>
  </UnitDefinitions>
  <DefaultExperiment startTime=\"0\" stopTime=\"1\"/>
  <ModelVariables>
{variables}  </ModelVariables>
  <ModelStructure>
    <Outputs>
{unknowns}    </Outputs>
    <InitialUnknowns>
{unknowns}    </InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"
    )
}

#[cfg(test)]
mod tests {
    use std::io::Read;
    use std::process::Command;

    use zip::ZipArchive;

    use super::*;
    use crate::force_table::tests::forces;

    #[test]
    fn an_fmu_is_the_same_for_the_same_table_and_holds_its_source() {
        let forces = forces();
        let bytes = fmu(&forces, "one").expect("memory");
        assert_eq!(bytes, fmu(&forces, "one").expect("memory"));
        let mut archive = ZipArchive::new(Cursor::new(bytes)).expect("an archive");
        let mut source = String::new();
        let name = "sources/meshwright_mesh.c";
        let mut file = archive.by_name(name).expect("the source");
        file.read_to_string(&mut source).expect("text");
        assert_eq!(source, SOURCE);
        drop(file);
        let mut table = Vec::new();
        let mut file = archive.by_name("resources/table.bin").expect("the table");
        file.read_to_end(&mut table).expect("bytes");
        let number = |i: usize| {
            let bytes = table[8 * i..8 * i + 8].try_into().expect("eight bytes");
            f64::from_le_bytes(bytes)
        };
        let (positions, rows) = (number(0), number(1));
        assert_eq!(
            table.len(),
            8 * (5 + (rows * (1.0 + 2.0 * positions)) as usize)
        );
        assert_eq!(number(3), 40e-3);
        assert_eq!(number(5), 0.0, "the first load");
        assert_eq!(number(4 + rows as usize), 1000.0, "the last");
    }

    #[test]
    fn an_fmu_without_a_binary_says_so() {
        let said = description(&forces(), "one").contains("source only");
        assert_eq!(said, BINARIES.is_empty());
    }

    #[test]
    fn the_description_names_pair_torque_range_and_units() {
        let text = description(&forces(), "one");
        for said in [
            "modelName=\"Gear mesh 20/25\"",
            "20 and 25 teeth on base circles of 80 and 100 mm, by the method flexible",
            "Output torques from -50 to 50 N m",
            "Angles in rad, torques in N m, transmission error in um",
            "Left out: inertia, shafts, supports and vibrations of the gear bodies",
        ] {
            assert!(text.contains(said), "{said}: {text}");
        }
    }

    #[test]
    fn functions_get_the_prefix_that_a_static_link_asks_for() {
        // FMI 2.0, fmi2Functions.h: FMI2_FUNCTION_PREFIX stands before each name, and nothing where it is not defined.
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../fmu/meshwright_mesh.c");
        for (define, name) in [
            (None, "fmi2DoStep"),
            (Some("-DFMI2_FUNCTION_PREFIX=one_"), "one_fmi2DoStep"),
        ] {
            let expanded = Command::new("cc")
                .args(["-std=c99", "-E", "-P"])
                .args(define)
                .arg(source)
                .output();
            let Ok(expanded) = expanded else {
                println!("NOT CHECKED: there is no C compiler here.");
                return;
            };
            assert!(expanded.status.success());
            let text = String::from_utf8_lossy(&expanded.stdout);
            let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            let steps: Vec<&str> = words.filter(|word| word.ends_with("fmi2DoStep")).collect();
            assert!(
                !steps.is_empty() && steps.iter().all(|word| *word == name),
                "{steps:?}"
            );
        }
    }
}
