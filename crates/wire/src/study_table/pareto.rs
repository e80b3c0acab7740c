//! Which designs of a study no other one beats.

use std::cmp::Ordering;
use std::collections::{BTreeMap, HashSet};

use super::row::RowState;
use super::summary::{Conditions, Summary};

/// What has to be known of all rows before one of them can be shown: which are best, and what they change. It keeps three
/// numbers of each row, so that a table of any length is made row by row.
#[derive(Debug, Default)]
pub struct Outline {
    rows: usize,
    groups: BTreeMap<Conditions, Vec<(usize, [f64; 3])>>,
    pointers: Vec<String>,
    known: HashSet<String>,
    told: Told,
}

/// What a table tells beside what every table does.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Told {
    /// Stresses.
    pub stress: bool,
    /// How even the load is along the face.
    pub faces: bool,
    /// What holes alone make of their order.
    pub holes_alone: bool,
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
        let summary = row.summary.as_ref();
        self.told.stress |= summary.is_some_and(Summary::has_stress);
        self.told.faces |= summary.is_some_and(Summary::has_faces);
        self.told.holes_alone |= summary.is_some_and(Summary::has_holes_alone);
        self.rows += 1;
    }

    /// What any row tells beside the rest.
    pub fn told(&self) -> Told {
        self.told
    }

    /// What the rows change, in the order in which it was met first.
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
