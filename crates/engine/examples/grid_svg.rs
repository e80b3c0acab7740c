//! Draws a grid: `cargo run -p meshwright-engine --example grid_svg -- tooth 50 45.5 > tooth.svg`, or
//! `-- blank BORE INTERFACE TEETH [COUNT CIRCLE RADIUS]`, with lengths in millimeters.

use meshwright_engine::gear::{GearData, HolePattern, SpurGear};
use meshwright_engine::grid::ring_grid::ELEMENTS_PER_TOOTH;
use meshwright_engine::grid::{BlankGrid, Grid, GridLevel, ToothGrid};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize| -> Result<f64, Box<dyn std::error::Error>> {
        Ok(arguments.get(i).ok_or("too few arguments")?.parse()?)
    };
    let level = match std::env::var("GRID_LEVEL").as_deref() {
        Ok("coarse") => GridLevel::Coarse,
        Ok("fine") => GridLevel::Fine,
        _ => GridLevel::Standard,
    };
    let grid = match arguments.first().map(String::as_str) {
        Some("tooth") => {
            let gear = gear(
                number(1)? as u32,
                arguments.get(3).map_or(Ok(0.0), |x| x.parse())?,
            )?;
            ToothGrid::new(&gear, number(2)? * 1e-3, level)?.grid
        }
        _ => {
            let holes = if arguments.len() > 4 {
                Some(HolePattern {
                    count: number(4)? as u32,
                    circle_radius: number(5)? * 1e-3,
                    radius: number(6)? * 1e-3,
                    phase: 0.0,
                })
            } else {
                None
            };
            let (bore, interface, teeth) =
                (number(1)? * 1e-3, number(2)? * 1e-3, number(3)? as u32);
            BlankGrid::new(
                bore,
                interface,
                holes.as_ref(),
                teeth,
                ELEMENTS_PER_TOOTH,
                level,
            )?
            .grid
        }
    };
    eprintln!(
        "{} nodes, {} elements, {:?}",
        grid.nodes.len(),
        grid.elements.len(),
        grid.quality()
    );
    print!("{}", svg(&grid));
    Ok(())
}

fn gear(tooth_count: u32, profile_shift: f64) -> Result<SpurGear, Box<dyn std::error::Error>> {
    Ok(SpurGear::new(GearData {
        profile_shift,
        ..GearData::plain(tooth_count, 2e-3, 1e-3)
    })?)
}

/// Every element's outline as a polygon through its nodes, in micrometers.
fn svg(grid: &Grid) -> String {
    let micrometers = |node: u32| {
        let p = grid.nodes[node as usize] * 1e6;
        (p.x, -p.y)
    };
    let (mut low, mut high) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
    let mut outlines = String::new();
    for element in &grid.elements {
        outlines += "<polygon points=\"";
        for node in element.outline() {
            let (x, y) = micrometers(node);
            low = (low.0.min(x), low.1.min(y));
            high = (high.0.max(x), high.1.max(y));
            outlines += &format!("{x:.2},{y:.2} ");
        }
        outlines += "\"/>\n";
    }
    let (width, height) = (high.0 - low.0, high.1 - low.1);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{} {} {width} {height}\" fill=\"none\" stroke=\"black\" stroke-width=\"{}\">\n{outlines}</svg>\n",
        low.0,
        low.1,
        width / 2000.0
    )
}
