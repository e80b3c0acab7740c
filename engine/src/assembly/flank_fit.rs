//! How what a flank yields from node to node becomes a polynomial over it.

use faer::Mat;
use faer::traits::ComplexField;

use super::half_space::HalfSpace;
use crate::fem::axial::AxialBasis;
use crate::fem::dense::symmetrize;
use crate::gear::SolidGear;
use crate::quadrature::legendre;

/// The degree up the flank of what a tooth yields under its own load, less the half space.
pub(super) const OWN_DEGREE: usize = 8;
/// The degree up the flank of what it yields under the loads of others.
pub(super) const OTHER_DEGREE: usize = 5;
/// How many nodes of the flank apart loads and displacements must be to tell the smooth part from the grid's own error.
const NODES_APART: usize = 3;
/// Singular values below this share of the largest say nothing.
const FIT_TOLERANCE: f64 = 1e-9;

/// The Legendre polynomials in the square of the roll length, over the flank, and their derivatives by the roll length.
pub(super) fn up_the_flank(
    [from, to]: [f64; 2],
    roll_length: f64,
    degree: usize,
) -> (Vec<f64>, Vec<f64>) {
    let t = (2.0 * roll_length * roll_length - from - to) / (to - from);
    let (mut values, mut slopes) = (vec![0.0; degree + 1], vec![0.0; degree + 1]);
    legendre(t, &mut values, &mut slopes);
    let by_roll = 4.0 * roll_length / (to - from);
    slopes.iter_mut().for_each(|slope| *slope *= by_roll);
    (values, slopes)
}

/// How values at the nodes of a flank become polynomials over it.
pub(super) struct FlankFit<'a> {
    gear: &'a SolidGear,
    pub(super) axial: &'a AxialBasis,
    roll_lengths: &'a [f64],
    pub(super) squares: [f64; 2],
}

impl<'a> FlankFit<'a> {
    pub(super) fn new(gear: &'a SolidGear, axial: &'a AxialBasis, roll_lengths: &'a [f64]) -> Self {
        let last = roll_lengths[roll_lengths.len() - 1];
        Self {
            gear,
            axial,
            roll_lengths,
            squares: [roll_lengths[0].powi(2), last.powi(2)],
        }
    }

    /// The polynomials of [`OTHER_DEGREE`] nearest to values at the nodes: a row for each of all the polynomials, the higher ones
    /// empty.
    pub(super) fn smoothing(&self) -> Mat<f64> {
        let nodes = self.roll_lengths;
        let values = Mat::from_fn(nodes.len(), OTHER_DEGREE + 1, |i, a| {
            up_the_flank(self.squares, nodes[i], OTHER_DEGREE).0[a]
        });
        let inverse = pseudo_inverse(&values);
        Mat::from_fn(OWN_DEGREE + 1, nodes.len(), |a, i| {
            if a <= OTHER_DEGREE {
                inverse[(a, i)]
            } else {
                0.0
            }
        })
    }

    /// The polynomials nearest to the compliance `g` of one flank under its own loads, node by node, less the half space: from
    /// nodes that stand [`NODES_APART`].
    pub(super) fn own(&self, g: &Mat<f64>) -> Mat<f64> {
        let (nodes, m, degrees) = (self.roll_lengths.len(), self.axial.len(), OWN_DEGREE + 1);
        let apart: Vec<(usize, usize)> = (0..nodes)
            .flat_map(|i| (0..nodes).map(move |j| (i, j)))
            .filter(|(i, j)| i.abs_diff(*j) >= NODES_APART)
            .collect();
        let polynomials: Vec<Vec<f64>> = self
            .roll_lengths
            .iter()
            .map(|s| up_the_flank(self.squares, *s, OWN_DEGREE).0)
            .collect();
        let products = Mat::from_fn(apart.len(), degrees * degrees, |row, ab| {
            let (i, j) = apart[row];
            polynomials[i][ab / degrees] * polynomials[j][ab % degrees]
        });
        let space = HalfSpace::new(self.gear, self.axial, self.least_distance());
        let mut smooth = Mat::<f64>::zeros(apart.len(), m * m);
        for (row, &(i, j)) in apart.iter().enumerate() {
            // Exchanged nodes exchange the functions.
            if i < j {
                continue;
            }
            let kernel = space.between(self.roll_lengths[i], self.roll_lengths[j]);
            let other = apart.partition_point(|pair| *pair < (j, i));
            for p in 0..m {
                for q in 0..m {
                    smooth[(row, p * m + q)] = g[(i * m + p, j * m + q)] - kernel[(p, q)];
                    smooth[(other, p * m + q)] = g[(j * m + p, i * m + q)] - kernel[(q, p)];
                }
            }
        }
        let shares = pseudo_inverse(&products) * smooth;
        let mut own = Mat::from_fn(degrees * m, degrees * m, |i, j| {
            shares[((i / m) * degrees + j / m, (i % m) * m + j % m)]
        });
        symmetrize(&mut own);
        own
    }

    /// The least length along the flank between nodes that stand [`NODES_APART`].
    fn least_distance(&self) -> f64 {
        let flank = self.gear.section().flank();
        let arcs: Vec<f64> = self
            .roll_lengths
            .iter()
            .map(|s| flank.arc_length(*s))
            .collect();
        let steps = arcs.windows(NODES_APART + 1);
        steps
            .map(|arcs| arcs[NODES_APART] - arcs[0])
            .fold(f64::INFINITY, f64::min)
    }
}

/// Q g Qᵀ, with Q the same for each of `m` functions along the axis.
pub(super) fn smoothed(smoothing: &Mat<f64>, g: &Mat<f64>, m: usize) -> Mat<f64> {
    let once = smoothed_rows(smoothing, g, m);
    smoothed_rows(smoothing, &once.transpose().to_owned(), m)
        .transpose()
        .to_owned()
}

/// Q g, of real or complex columns.
pub(super) fn smoothed_rows<T>(smoothing: &Mat<f64>, g: &Mat<T>, m: usize) -> Mat<T>
where
    T: ComplexField + Copy + std::ops::Mul<f64, Output = T> + std::ops::AddAssign,
{
    let mut rows = Mat::zeros(smoothing.nrows() * m, g.ncols());
    for j in 0..g.ncols() {
        for node in 0..smoothing.ncols() {
            for a in 0..smoothing.nrows() {
                let share = smoothing[(a, node)];
                for p in 0..m {
                    rows[(a * m + p, j)] += g[(node * m + p, j)] * share;
                }
            }
        }
    }
    rows
}

/// The least-squares inverse of a tall matrix.
fn pseudo_inverse(a: &Mat<f64>) -> Mat<f64> {
    let Ok(svd) = a.thin_svd() else {
        return Mat::zeros(a.ncols(), a.nrows());
    };
    let (u, v, s) = (svd.U(), svd.V(), svd.S().column_vector());
    let kept = (0..s.nrows())
        .take_while(|&i| s[i] > FIT_TOLERANCE * s[0])
        .count();
    let scaled = Mat::from_fn(v.nrows(), kept, |i, j| v[(i, j)] / s[j]);
    scaled * u.subcols(0, kept).transpose()
}
