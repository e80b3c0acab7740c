//! A web with holes: a plane grid times functions across it, on the orders of its outer circle.

use faer::{Mat, c64};
use rayon::prelude::*;

use super::revolution::{add_block, last_of};
use super::sector::SolidSector;
use crate::fem::FemError;
use crate::fem::prism::Prism;
use crate::grid::BlankGrid;
use crate::run::Run;

/// The Hermitian stiffness on the orders −`largest` … `largest` of the outer circle of the ring of sectors `grid`, order by
/// order; `prism` is its section with the functions across it.
///
/// `hub` is what carries the inner circle, one of each order 0 … `largest`; without it that circle is held. Hole 0 of a pattern
/// stands at the angle `phase`.
///
/// # Errors
///
/// [`FemError`].
pub fn holed_ring(
    grid: &BlankGrid,
    phase: f64,
    prism: &Prism<'_>,
    hub: Option<&[Mat<c64>]>,
    largest: usize,
    run: &Run,
) -> Result<Mat<c64>, FemError> {
    let (right, left) = &grid.side_nodes;
    let angle = |node: &u32| {
        let place = grid.grid.nodes[*node as usize];
        place.y.atan2(place.x)
    };
    let (inner, held) = match hub {
        Some(_) => (grid.bore_nodes.as_slice(), [].as_slice()),
        None => ([].as_slice(), grid.bore_nodes.as_slice()),
    };
    let kept: Vec<u32> = [right.as_slice(), left, inner, &grid.arc_nodes]
        .into_iter()
        .flatten()
        .copied()
        .collect();
    let sector = SolidSector {
        count: grid.sector_count as usize,
        size: prism.unknowns_of_node(),
        stiffness: prism.condense("the web", &kept, held, &[])?.stiffness,
        side_nodes: right.len(),
        arcs: vec![inner.iter().map(angle).collect(), grid.arc_angles.clone()],
    };
    let size = sector.size;
    let classes: Vec<(Vec<i64>, Mat<c64>)> = (0..=sector.count / 2)
        .into_par_iter()
        .map(|class| {
            run.check()?;
            let orders = sector.orders(class, largest);
            if orders.is_empty() {
                return Ok((orders, Mat::zeros(0, 0)));
            }
            let mut stiffness = sector.class_stiffness(class, &orders);
            let first = size * sector.side_nodes;
            stiffness *= faer::Scale(c64::new(sector.count as f64, 0.0));
            if let Some(hub) = hub {
                for (k, order) in orders.iter().enumerate() {
                    add_block(&mut stiffness, first + k * size, &of_order(hub, *order));
                }
            } else {
                // The inner circle, which is held, has unknowns without stiffness: they are no part of it.
                let from = first + orders.len() * size;
                let place = |i: usize| if i < first { i } else { i - first + from };
                let count = stiffness.nrows() - orders.len() * size;
                stiffness = Mat::from_fn(count, count, |i, j| stiffness[(place(i), place(j))]);
            }
            let outer = last_of(&stiffness, orders.len() * size)?;
            Ok((orders, outer))
        })
        .collect::<Result<_, FemError>>()?;

    let count = size * (2 * largest + 1);
    let mut ring = Mat::<c64>::zeros(count, count);
    let place = |order: i64| (order + largest as i64) as usize * size;
    for (orders, outer) in &classes {
        for (a, &n) in orders.iter().enumerate() {
            for (b, &m) in orders.iter().enumerate() {
                let turn = SolidSector::turn(m - n, phase);
                for j in 0..size {
                    for i in 0..size {
                        let value = outer[(a * size + i, b * size + j)] * turn;
                        // The class of the opposite orders is the conjugate of this one.
                        ring[(place(n) + i, place(m) + j)] = value;
                        ring[(place(-n) + i, place(-m) + j)] = value.conj();
                    }
                }
            }
        }
    }
    Ok(ring)
}

/// That of an order of either sign, of those of 0 and more.
pub fn of_order(orders: &[Mat<c64>], order: i64) -> Mat<c64> {
    let of = &orders[order.unsigned_abs() as usize];
    if order < 0 {
        of.conjugate().to_owned()
    } else {
        of.clone()
    }
}
