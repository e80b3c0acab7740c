//! Lead modifications: material removed from the loaded flanks along the face, the same at every roll length.
//!
//! As profile modifications they are measured along the base tangent, in the transverse section; z runs along the axis from the middle
//! of the gear's own face.

use super::modification::in_table;

/// The ends of a face that something is done to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaceEnds {
    /// Both.
    Both,
    /// That at −z.
    Minus,
    /// That at +z.
    Plus,
}

impl FaceEnds {
    /// The same of a face that is seen from its other side.
    pub(super) fn turned_over(self) -> Self {
        match self {
            Self::Both => Self::Both,
            Self::Minus => Self::Plus,
            Self::Plus => Self::Minus,
        }
    }
}

/// One modification of the leads of a gear as a drawing gives it; several add up. Lengths are in meters; removed material is positive.
#[derive(Debug, Clone, PartialEq)]
pub enum LeadModification {
    /// A parabola: nothing in the middle of the face, the amount C_β at both ends.
    Crowning {
        /// C_β.
        amount: f64,
    },
    /// In proportion to z: nothing at the end at −z, the amount C_Hβ at that at +z; negative adds.
    Slope {
        /// C_Hβ.
        amount: f64,
    },
    /// In proportion to the distance from where it begins: the amount at the end.
    EndRelief {
        /// The amount at the end.
        amount: f64,
        /// How far from the end it begins.
        length: f64,
        /// The ends that have it.
        ends: FaceEnds,
    },
    /// A table, linear between its entries, its ends held.
    Table {
        /// Rising places along z.
        places: Vec<f64>,
        /// Removed at each.
        removed: Vec<f64>,
    },
}

/// Why leads cannot be modified so. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LeadError {
    /// A relief is longer than the face that it may take, or has no length.
    #[error(
        "an end relief of {length} m does not fit the face: more than 0 and at most {largest} m"
    )]
    EndReliefTooLong {
        /// Index of the modification in its list.
        modification: usize,
        /// The length asked for.
        length: f64,
        /// The largest: the face, or half of it where both ends are relieved.
        largest: f64,
    },
    /// A table has fewer than two entries, or as many places as it has no values for, or does not rise.
    #[error("entry {entry} of the lead table does not follow the one before it")]
    TableDoesNotRise {
        /// Index of the modification in its list.
        modification: usize,
        /// The first entry that is missing or not larger than the one before.
        entry: usize,
    },
}

impl LeadModification {
    /// Checks that it fits a face of `width`; `modification` is its place in the list.
    pub(super) fn check(&self, modification: usize, width: f64) -> Result<(), LeadError> {
        match self {
            Self::EndRelief { length, ends, .. } => {
                let largest = if *ends == FaceEnds::Both {
                    0.5 * width
                } else {
                    width
                };
                if *length > 0.0 && *length <= largest * (1.0 + 1e-12) {
                    return Ok(());
                }
                Err(LeadError::EndReliefTooLong {
                    modification,
                    length: *length,
                    largest,
                })
            }
            Self::Table { places, removed } => {
                let entries = places.len().min(removed.len());
                let stays = (1..entries).find(|&i| places[i] <= places[i - 1]);
                let short = (entries < 2 || places.len() != removed.len()).then_some(entries);
                match stays.or(short) {
                    Some(entry) => Err(LeadError::TableDoesNotRise {
                        modification,
                        entry,
                    }),
                    None => Ok(()),
                }
            }
            Self::Crowning { .. } | Self::Slope { .. } => Ok(()),
        }
    }

    /// The same on a face of `width` that is seen from its other side.
    pub(super) fn turned_over(&self, width: f64) -> Self {
        match self {
            Self::Crowning { .. } => self.clone(),
            Self::Slope { amount } => Self::Table {
                places: vec![-0.5 * width, 0.5 * width],
                removed: vec![*amount, 0.0],
            },
            Self::EndRelief {
                amount,
                length,
                ends,
            } => Self::EndRelief {
                amount: *amount,
                length: *length,
                ends: ends.turned_over(),
            },
            Self::Table { places, removed } => Self::Table {
                places: places.iter().rev().map(|z| 0.0 - z).collect(),
                removed: removed.iter().rev().copied().collect(),
            },
        }
    }

    /// The values of a table; none of others.
    pub(super) fn entries(&self) -> &[f64] {
        match self {
            Self::Table { removed, .. } => removed,
            Self::Crowning { .. } | Self::Slope { .. } | Self::EndRelief { .. } => &[],
        }
    }

    /// Material removed at `z` of a face of `width`.
    pub fn removed(&self, z: f64, width: f64) -> f64 {
        match self {
            Self::Crowning { amount } => amount * (2.0 * z / width).powi(2),
            Self::Slope { amount } => amount * (z / width + 0.5),
            Self::EndRelief {
                amount,
                length,
                ends,
            } => {
                let at = |from_end: f64| amount * (1.0 - from_end / length).max(0.0);
                let (minus, plus) = (at(z + 0.5 * width), at(0.5 * width - z));
                match ends {
                    FaceEnds::Both => minus + plus,
                    FaceEnds::Minus => minus,
                    FaceEnds::Plus => plus,
                }
            }
            Self::Table { places, removed } => {
                let (i, part) = in_table(places, z);
                removed[i] + part * (removed[i + 1] - removed[i])
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_modification_removes_its_amount_where_the_drawing_says() {
        let b = 20e-3;
        let near = |value: f64, expected: f64| assert!((value - expected).abs() < 1e-18, "{value}");
        let crowning = LeadModification::Crowning { amount: 4e-6 };
        for (z, removed) in [(-10e-3, 4e-6), (0.0, 0.0), (5e-3, 1e-6), (10e-3, 4e-6)] {
            near(crowning.removed(z, b), removed);
        }
        let slope = LeadModification::Slope { amount: -6e-6 };
        for (z, removed) in [(-10e-3, 0.0), (0.0, -3e-6), (10e-3, -6e-6)] {
            near(slope.removed(z, b), removed);
        }
        let relief = |ends| LeadModification::EndRelief {
            amount: 8e-6,
            length: 4e-3,
            ends,
        };
        for (ends, [minus, plus]) in [
            (FaceEnds::Both, [8e-6, 4e-6]),
            (FaceEnds::Minus, [8e-6, 0.0]),
            (FaceEnds::Plus, [0.0, 4e-6]),
        ] {
            near(relief(ends).removed(-10e-3, b), minus);
            near(relief(ends).removed(8e-3, b), plus);
            near(relief(ends).removed(5e-3, b), 0.0);
        }
        let table = LeadModification::Table {
            places: vec![-8e-3, 0.0, 4e-3],
            removed: vec![3e-6, 1e-6, 5e-6],
        };
        for (z, removed) in [(-9e-3, 3e-6), (-4e-3, 2e-6), (2e-3, 3e-6), (10e-3, 5e-6)] {
            near(table.removed(z, b), removed);
        }
    }

    #[test]
    fn what_does_not_fit_the_face_is_refused_with_what_would() {
        let relief = |length, ends| LeadModification::EndRelief {
            amount: 8e-6,
            length,
            ends,
        };
        assert!(relief(10e-3, FaceEnds::Both).check(0, 20e-3).is_ok());
        assert!(relief(20e-3, FaceEnds::Plus).check(0, 20e-3).is_ok());
        for (length, ends, largest) in [
            (11e-3, FaceEnds::Both, 10e-3),
            (21e-3, FaceEnds::Minus, 20e-3),
            (0.0, FaceEnds::Plus, 20e-3),
        ] {
            let expected = LeadError::EndReliefTooLong {
                modification: 3,
                length,
                largest,
            };
            assert_eq!(relief(length, ends).check(3, 20e-3), Err(expected));
        }
        let table = |places: &[f64], values: usize| {
            let table = LeadModification::Table {
                places: places.to_vec(),
                removed: vec![0.0; values],
            };
            table.check(1, 20e-3)
        };
        assert!(table(&[-1.0, 1.0], 2).is_ok());
        for (places, values, entry) in [
            (&[0.0, 1.0, 1.0][..], 3, 2),
            (&[0.0], 1, 1),
            (&[0.0, 1.0], 3, 2),
        ] {
            let expected = LeadError::TableDoesNotRise {
                modification: 1,
                entry,
            };
            assert_eq!(table(places, values), Err(expected));
        }
    }
}
