//! Which designs of a study no other one beats.

use std::cmp::Ordering;
use std::collections::{BTreeMap, HashSet};

use meshwright_wire::warning::GearName;

use super::quantity::{Of, QUANTITIES, Quantity};
use super::row::RowState;
use super::summary::{Conditions, Summary};

/// Values of all rows that one of them needs before it can be shown: the best ones, and the changed fields. It keeps three numbers of each row, so that a table
/// of any length is made row by row.
#[derive(Debug, Default)]
pub struct Outline {
    rows: usize,
    groups: BTreeMap<Conditions, Vec<(usize, [f64; 3])>>,
    pointers: Vec<String>,
    known: HashSet<String>,
    quantities: KnownQuantities,
}

/// Which quantities any row of a table has, each by its place among all of them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct KnownQuantities(u64);

const _: () = assert!(QUANTITIES.len() <= u64::BITS as usize);

impl KnownQuantities {
    /// Looks at the numbers of the next row.
    pub(super) fn add(&mut self, summary: &Summary) {
        for (i, quantity) in QUANTITIES.iter().enumerate() {
            let Of::Curve(of) = quantity.of else { continue };
            // A quantity of one gear has the same form for both.
            let mut curves = summary.curves().iter();
            let is_known = curves.any(|curve| of(curve, GearName::Driven).is_some());
            self.0 |= u64::from(is_known) << i;
        }
    }

    /// The quantities of curves that a table has columns of.
    pub(super) fn columns(self) -> impl Iterator<Item = &'static Quantity> {
        let all = QUANTITIES.iter().enumerate();
        let is_known = move |i: usize| self.0 & (1 << i) != 0;
        // Stresses stand together.
        let mut known = all.clone().filter(|(i, _)| is_known(*i));
        let stressed = known.any(|(_, quantity)| quantity.is_stress());
        let shown = all.filter(move |(i, quantity)| {
            let is_shown = quantity.in_every_table || is_known(*i);
            matches!(quantity.of, Of::Curve(_)) && (is_shown || stressed && quantity.is_stress())
        });
        shown.map(|(_, quantity)| quantity)
    }
}

impl Outline {
    /// Looks at the next row.
    pub fn add(&mut self, row: &RowState) {
        for pointer in row.changes.keys() {
            if !self.known.contains(pointer) {
                self.known.insert(pointer.clone());
                self.pointers.push(pointer.clone());
            }
        }
        if let Some(summary) = &row.summary
            && let Some(objectives) = summary.objectives()
        {
            let group = self.groups.entry(summary.conditions()).or_default();
            group.push((self.rows, objectives));
        }
        if let Some(summary) = &row.summary {
            self.quantities.add(summary);
        }
        self.rows += 1;
    }

    /// Which quantities any row has.
    pub fn quantities(&self) -> KnownQuantities {
        self.quantities
    }

    /// Changed fields of the rows, in the order of their first occurrence.
    pub fn pointers(&self) -> &[String] {
        &self.pointers
    }

    /// For each row, whether no other one is at least as good in everything and better in something.
    pub fn front(self) -> Vec<bool> {
        let mut optimal = vec![false; self.rows];
        for (_, designs) in self.groups {
            for i in front_of(designs) {
                optimal[i] = true;
            }
        }
        optimal
    }
}

fn front_of(mut designs: Vec<(usize, [f64; 3])>) -> Vec<usize> {
    // In lexical order a design is dominated by earlier ones only, and if by any then by one of the front.
    designs.sort_by(|(_, a), (_, b)| {
        a.iter()
            .zip(b)
            .map(|(a, b)| a.total_cmp(b))
            .find(|order| order.is_ne())
            .unwrap_or(Ordering::Equal)
    });
    let mut front: Vec<[f64; 3]> = Vec::new();
    let mut optimal = Vec::new();
    for (i, design) in designs {
        let dominated = front.iter().any(|other| {
            *other != design && other.iter().zip(&design).all(|(other, own)| other <= own)
        });
        if !dominated {
            front.push(design);
            optimal.push(i);
        }
    }
    optimal
}
