//! The curves of two pairs from their numbers: `cargo run -p meshwright-engine --example analyze`.
//!
//! A spur pair in its transverse section, with holes in the driven blank; and a helical pair along its faces, with a web and a crowned pinion. Everything is in
//! SI units. `contact.rs` and `helical.rs` show what goes on below.

use meshwright_engine::analysis::{
    Case, ContactSolver, Curve, FaceHoles, Faces, Resolution, SectionHoles, StiffnessRule, analyze,
};
use meshwright_engine::assembly::FaceResolution;
use meshwright_engine::gear::{
    Alignment, GearData, GearPair, Helix, HolePattern, LeadModification, SolidGear, SolidPair,
    SpurGear, Web,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

/// A gear of module 2 mm with a solid blank; of a helical gear, in its normal section.
fn drawn(tooth_count: u32, bore_radius: f64) -> GearData {
    GearData {
        thickness_deviation: -0.1e-3,
        ..GearData::plain(tooth_count, 2e-3, bore_radius)
    }
}

/// A resolution of this many positions in one mesh period, on the coarse grid.
fn one_period(positions: u32) -> Resolution {
    Resolution {
        positions_per_mesh_period: positions,
        first_position: 0.0,
        span_mesh_periods: Some(1),
        grid: GridLevel::Coarse,
        contact_solver: ContactSolver::ActiveSet,
        stiffness: StiffnessRule::Tangent,
        blank_positions: 16,
        interface_radii: [None; 2],
        error_estimate: false,
    }
}

fn show(name: &str, curve: &Curve) {
    let (deltas, stiffness) = (&curve.transmission_error, &curve.mesh_stiffness_tangent);
    println!("{name}, {} N m:", curve.output_torque);
    for (delta, k) in deltas.iter().zip(stiffness) {
        println!("  δ {:.3} µm, k {:.1} N/µm", 1e6 * delta, 1e-6 * k);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (parts, run) = (Library::default(), Run::unattended());

    let mut holed = drawn(31, 10e-3);
    let pattern = HolePattern {
        count: 4,
        circle_radius: 20e-3,
        radius: 4e-3,
        phase: 0.0,
    };
    holed.blank.holes = pattern.holes();
    let plane = GearPair::new(
        SpurGear::new(drawn(23, 8e-3))?,
        SpurGear::new(holed)?,
        54.4e-3,
    )?;
    let case = Case::in_section(plane, SectionHoles::Whole, vec![60.0], one_period(12));
    for curve in &analyze(&case, &parts, &run)?.curves {
        show("23/31 teeth, four holes", curve);
    }

    let mut webbed = drawn(50, 15e-3);
    webbed.blank.web = Some(Web {
        inner_radius: 22e-3,
        outer_radius: 44e-3,
        thickness: 5e-3,
    });
    let helix = 20_f64.to_radians();
    let gears = [
        SolidGear::new(drawn(25, 10e-3), Helix::right(helix), 0.0, None)?,
        SolidGear::new(webbed, Helix::right(-helix), 3e-3, None)?,
    ];
    let center_distance = gears
        .iter()
        .map(|gear| gear.section().reference_radius())
        .sum();
    let leads = [
        vec![LeadModification::Crowning { amount: 4e-6 }],
        Vec::new(),
    ];
    let faces = Faces {
        pair: SolidPair::new(gears, leads, center_distance, Alignment::default())?,
        resolution: FaceResolution::DRAFT,
        slices: 20,
        at_each_position: false,
        cure: false,
    };
    let case = Case::along_faces(faces, FaceHoles::Whole, vec![150.0], one_period(8));
    for curve in &analyze(&case, &parts, &run)?.curves {
        show("25/50 teeth with a helix of 20°", curve);
    }
    Ok(())
}
