//! One contact of two gears, from their drawings to the transmission error: `cargo run -p meshwright-engine --example contact`.
//!
//! Two gears with 50 teeth each, eight holes in the second, under 115 N m. Everything is in SI units.

use meshwright_engine::assembly::{Blanks, MakeAll, Modeling, PairSpec};
use meshwright_engine::contact::{
    AugmentedLagrangian, ContactSolver, WarmStart, default_penalty, solve_active_set,
    solve_augmented_lagrangian,
};
use meshwright_engine::gear::{
    GearData, GearPair, HolePattern, ModificationData, ReliefData, ReliefShape, ReliefStart,
    SpurGear,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::run::Run;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 1. The drawing. A gear is what a rack cuts, less a relief at the tips, on a blank. `SpurGear::new` refuses what cannot be made,
    //    `GearPair::new` what cannot mesh.
    let solid = GearData {
        modifications: vec![ModificationData::TipRelief(ReliefData {
            amount: 5e-6,
            shape: ReliefShape::Linear,
            start: ReliefStart::RadialLength(1.75e-3),
        })],
        ..GearData::plain(50, 2e-3, 15e-3)
    };
    let mut holed = solid.clone();
    let pattern = HolePattern {
        count: 8,
        circle_radius: 34e-3,
        radius: 8.4e-3,
        phase: 0.0,
    };
    holed.blank.holes = pattern.holes();
    let pair = GearPair::new(SpurGear::new(solid)?, SpurGear::new(holed)?, 100.5e-3)?;
    println!(
        "contact ratio {:.3}; the contact repeats after {} mesh periods",
        pair.contact_ratio(),
        pair.period()
    );

    // 2. The model. One tooth of each gear is divided into finite elements and condensed to its flank, its blank to the circle on which
    //    both meet. What is left says how far any point of a flank gives way under a force at any other: the compliance.
    let modeling = Modeling {
        level: GridLevel::Standard,
        interface_radii: [None; 2],
        farthest: 4,
        solver: ContactSolver::ActiveSet,
    };
    let run = Run::unattended();
    let spec = PairSpec::new(&pair, Blanks::Flexible, &modeling);
    let (model, unknowns) = spec.model(&MakeAll, &run)?;
    println!("{unknowns} unknowns, condensed to flanks and one circle a gear");

    // 3. One mesh position, a quarter of a period after tooth 0 of both gears met at the pitch point. The load on the line of action is
    //    the torque over the base radius of the driven gear. Cells a few micrometers wide lie where flanks come near.
    let load = pair.load(115.0);
    let cells = model
        .as_drawn()
        .cells(0.25, load, &mut WarmStart::default())?;
    let problem = &cells.problem;
    println!("{load:.1} N on {} cells", problem.point_count());

    // 4. The problem. With the forces p, compliance H, gaps g_0 before loading, and arms w over the base radius, flanks may touch and
    //    push, but neither pull nor cross (Signorini):
    //
    //        g = H p + g_0 − δ w ≥ 0,   p ≥ 0,   p g = 0,   wᵀ p = F
    //
    //    δ is the transmission error: how far the driven gear lags. Two solvers that share nothing else agree on it: one finds the
    //    very cells that touch, the other is the paper's, which presses with springs until nothing crosses.
    let exact = solve_active_set(problem, load, None)?;
    let settings = AugmentedLagrangian {
        penalty: default_penalty(&pair),
        gap_tolerance: 1e-12,
        max_iterations: 2000,
    };
    let springs = solve_augmented_lagrangian(problem, load, &settings, &run)?;
    for (name, solution) in [("active set", &exact), ("augmented Lagrangian", &springs)] {
        println!(
            "{name}: δ {:.6} µm, k {:.2} N/µm, {} systems",
            1e6 * solution.transmission_error,
            1e-6 * solution.stiffness,
            solution.iterations
        );
    }

    // 5. What it is: forces balance the load, no cell that pushes is open, none crosses.
    let balance: f64 = exact
        .forces
        .iter()
        .zip(problem.arms())
        .map(|(p, w)| w * p)
        .sum();
    let open = exact
        .forces
        .iter()
        .zip(&exact.gaps)
        .filter(|(p, _)| **p > 0.0);
    let open = open.map(|(_, g)| g.abs()).fold(0.0, f64::max);
    let crossing = exact.gaps.iter().fold(0.0, |most: f64, g| most.max(-g));
    assert!((balance / load - 1.0).abs() < 1e-9 && open < 1e-12 && crossing < 1e-12);

    // 6. A mesh period, twelve positions of it: the curve that is heard. `analysis::analyze` does this, over as many periods as the
    //    contact takes to repeat, and adds statistics and spectrum.
    let mut warm = WarmStart::default();
    for i in 0..12 {
        let eta = f64::from(i) / 12.0;
        let contact = model.as_drawn().contact(eta, load, &mut warm)?;
        let shares = contact.pairs.iter().filter(|pair| pair.share > 0.0);
        let shares: Vec<String> = shares
            .map(|pair| format!("pair {} {:.0} %", pair.pair, 100.0 * pair.share))
            .collect();
        println!(
            "η {eta:.3}: δ {:.3} µm, {}",
            1e6 * contact.transmission_error,
            shares.join(", ")
        );
    }
    Ok(())
}
