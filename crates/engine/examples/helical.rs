//! A helical pair along its faces, from its drawings to the load on its lines of contact: `cargo run -p meshwright-engine --example helical`.
//!
//! The plane is in `contact.rs`. Here the gears have a helix of 20°, the driving one is crowned, and the driven one is a rim on a thin web that
//! stands 3 mm beside its middle. Everything is in SI units.

use std::sync::Arc;

use meshwright_engine::assembly::{FaceCompliance, FaceResolution};
use meshwright_engine::contact::face::{FaceModel, FlankCompliance, SLICES};
use meshwright_engine::gear::{
    Alignment, GearData, Helix, LeadModification, Member, SolidGear, SolidPair, Web,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::run::Run;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 1. The drawing: the rack stands in the normal section, and the helix makes the transverse one of it. A right-handed gear meshes with a
    //    left-handed one.
    let helix_angle = 20_f64.to_radians();
    let section = |tooth_count, bore_radius| GearData {
        thickness_deviation: -0.1e-3,
        ..GearData::plain(tooth_count, 2e-3, bore_radius)
    };
    let mut webbed = section(50, 15e-3);
    webbed.blank.web = Some(Web {
        inner_radius: 22e-3,
        outer_radius: 44e-3,
        thickness: 5e-3,
    });
    let driving = SolidGear::new(section(25, 10e-3), Helix::right(helix_angle), 0.0, None)?;
    let driven = SolidGear::new(webbed, Helix::right(-helix_angle), 3e-3, None)?;
    let center_distance =
        driving.section().reference_radius() + driven.section().reference_radius();
    let crowned = vec![LeadModification::Crowning { amount: 4e-6 }];
    let pair = SolidPair::new(
        [driving, driven],
        [crowned, Vec::new()],
        center_distance,
        Alignment::default(),
    )?;
    println!(
        "contact ratio {:.3} in the transverse section, overlap {:.3}",
        pair.section().contact_ratio(),
        pair.overlap_ratio()
    );

    // 2. How flanks give way. Each gear is divided in its transverse section, and across its face in polynomials. Condensed, what is left of it
    //    are functions of roll length and z on its flanks, and the compliance between them: of one tooth, and of its neighbors over the blank.
    let run = Run::unattended();
    let resolution = FaceResolution::DRAFT.at(GridLevel::Coarse);
    let [first, second] =
        Member::BOTH.map(|member| FaceCompliance::of(pair.gear(member), resolution, &run));
    let yields = [Arc::new(first?), Arc::new(second?)];
    let coupled = yields.each_ref().map(|of| of.coupled());
    println!(
        "{} functions on a flank of the driving gear, {} on one of the driven",
        yields[0].basis_len(),
        yields[1].basis_len()
    );

    // 3. The contact. Lines of contact cross the flanks; each is cut into slices, a slice is the plane's contact at another phase, and a nonlinear
    //    spring: Hertz's. With the depth p to which the springs are pressed, their gaps g, and H of both gears,
    //
    //        p = δ w − g − H N,   N = ∫ q(p) dz,   ∫ w q(p) dz = F
    let yields = yields.map(|of| of as Arc<dyn FlankCompliance>);
    let model = FaceModel::new(pair, yields, SLICES, coupled[0].min(coupled[1]));
    let load = model.pair().section().load(150.0);
    let positions: Vec<f64> = (0..8).map(|i| f64::from(i) / 8.0).collect();
    let contacts = model.contacts(load, &positions, &run)?;

    // 4. What it tells: δ and k as in the plane, and besides, where along the face the load stands. Under a rim that bends beside its web
    //    that is not the middle.
    for (eta, contact) in positions.iter().zip(&contacts) {
        let carried: f64 = contact.slices.iter().map(|slice| slice.force).sum();
        assert!((carried / load - 1.0).abs() < 1e-9);
        let lines = contact.mesh.pairs.iter().filter(|pair| pair.share > 0.0);
        println!(
            "η {eta:.3}: δ {:.3} µm, k {:.1} N/µm, {} lines, the load stands {:+.2} mm from the middle",
            1e6 * contact.mesh.transmission_error,
            1e-6 * contact.mesh.stiffness,
            lines.count(),
            1e3 * contact.load_centroid()
        );
    }
    let width = model.pair().common_face_width();
    let strips = contacts[0].strips(width, 10);
    let strips: Vec<String> = strips.iter().map(|force| format!("{force:.0}")).collect();
    println!("N on each tenth of the face at η = 0: {}", strips.join(" "));
    Ok(())
}
