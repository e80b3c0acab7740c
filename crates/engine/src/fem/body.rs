//! What is divided into finite elements: a grid with a law, and so many unknowns at each node.

use super::element::{self, COMPONENTS};
use super::recovery::Functional;
use crate::gear::Material;
use crate::grid::Grid;

/// A body of finite elements.
pub trait Body {
    /// Its grid.
    fn grid(&self) -> &Grid;

    /// The number of unknowns of a node.
    fn unknowns_of_node(&self) -> usize;

    /// A stiffness of the size of that of its elements, in N/m.
    fn scale(&self) -> f64;

    /// The stiffness of each of its elements in turn, in N/m: its entries by unknowns, node by node.
    fn stiffnesses(&self) -> impl Iterator<Item = impl Fn(usize, usize) -> f64>;

    /// The unknowns of a node, rising, in sets that do not stiffen each other.
    fn independent(&self) -> Vec<Vec<usize>> {
        vec![(0..self.unknowns_of_node()).collect()]
    }
}

/// A body in plane stress: its unknowns at a node are u_x and u_y.
#[derive(Debug, Clone, Copy)]
pub struct Plate<'a> {
    /// Its grid.
    pub grid: &'a Grid,
    /// What it is made of.
    pub material: &'a Material,
    /// The thickness in meters of an element whose own is 1.
    pub thickness: f64,
}

impl Body for Plate<'_> {
    fn grid(&self) -> &Grid {
        self.grid
    }

    fn unknowns_of_node(&self) -> usize {
        COMPONENTS
    }

    fn scale(&self) -> f64 {
        self.material.youngs_modulus * self.thickness
    }

    fn stiffnesses(&self) -> impl Iterator<Item = impl Fn(usize, usize) -> f64> {
        self.grid.elements.iter().map(|element| {
            let (nodes, part) = (element.places(&self.grid.nodes), element.thickness());
            let thickness = self.thickness * part;
            let k = element::stiffness(element.kind(), &nodes, self.material, thickness);
            move |i: usize, j: usize| k[(i, j)]
        })
    }
}

/// What acts on a body.
#[derive(Debug, Clone, Default)]
pub struct Load {
    /// How those nodes move whose displacements are given, in meters: node by node, all unknowns of each.
    pub moves: Vec<f64>,
    /// Forces in N on what is free: along what each acts, and how large it is.
    pub forces: Vec<(Functional, f64)>,
}
