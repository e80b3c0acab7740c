//! The force table of a pair as an FMU 2.0, for Model Exchange and Co-Simulation.
//!
//! The program of the FMU is the same for all jobs: a C file in `fmu`, compiled when this program is built where a C compiler is there. What
//! is of the job is the table, a resource that it reads.

use std::io::{Cursor, Write};

use zip::result::ZipResult;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::force_table::MeshForces;

/// The program in C, which every FMU holds.
const SOURCE: &str = include_str!("../../fmu/meshwright_mesh.c");

// Compiled, by platform: `BINARIES`, a path in the FMU and its bytes.
include!(concat!(env!("OUT_DIR"), "/fmu.rs"));

const NAME: &str = "meshwright_mesh";

/// The name, the kind and the meaning of each variable, by its reference.
const VARIABLES: [(&str, &str, &str); 5] = [
    (
        "theta_1_rad",
        "input",
        "Angle of the driving gear, in the sense in which it turns",
    ),
    (
        "theta_2_rad",
        "input",
        "Angle of the driven gear, in the sense in which it turns",
    ),
    (
        "torque_1_n_m",
        "output",
        "Torque of the mesh on the driving gear",
    ),
    (
        "torque_2_n_m",
        "output",
        "Torque of the mesh on the driven gear",
    ),
    (
        "transmission_error_um",
        "output",
        "Approach along the line of action, positive where the driven gear lags",
    ),
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
    add("modelDescription.xml", description(guid).as_bytes())?;
    add("resources/table.bin", &forces.table_of_doubles())?;
    add(&format!("sources/{NAME}.c"), SOURCE.as_bytes())?;
    for (path, bytes) in BINARIES {
        add(&format!("binaries/{path}"), bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}

fn description(guid: &str) -> String {
    let compiled = if BINARIES.is_empty() {
        "It holds its source only: no C compiler was there when the service was built."
    } else {
        "It holds its source too."
    };
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
<fmiModelDescription fmiVersion=\"2.0\" modelName=\"Gear mesh\" guid=\"{guid}\" description=\"The force between two gears over their angles. {compiled}\" generationTool=\"Meshwright\" variableNamingConvention=\"flat\" numberOfEventIndicators=\"0\">
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
        let said = description("one").contains("source only");
        assert_eq!(said, BINARIES.is_empty());
    }
}
