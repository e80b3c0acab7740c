//! Temporary.
use meshwright_engine::analysis::library::default_interface_radius;
use meshwright_engine::fem::tooth::ToothSubstructure;
use meshwright_engine::gear::Member;
use meshwright_engine::grid::{GridLevel, ToothGrid};
#[path = "../tests/cases/mod.rs"]
mod cases;
fn main() {
    faer::set_global_parallelism(faer::Par::Seq);
    let case = cases::test_case(2);
    let gear = case.pair.gear(Member::Driven);
    let radius = default_interface_radius(gear);
    let grid = ToothGrid::new(gear, radius, GridLevel::Standard).unwrap();
    for _ in 0..4 {
        std::hint::black_box(ToothSubstructure::new(gear, &grid).unwrap());
    }
}
