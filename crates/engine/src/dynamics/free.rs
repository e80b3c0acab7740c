//! Free motions of coupled bodies at a speed.
//!
//! The state s = (p, p') of the common modes obeys s' = A s + B f, with B = (0, Z). By the eigenvectors v of A it is s = Σ Re(v y), where each y moves by itself:
//! y' = λ y + b f. Of two conjugate eigenvalues one is taken, that with a positive frequency. A real one has a real y.

use std::f64::consts::PI;

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, evd_real, evd_scratch};
use faer::{Mat, Par};
use nalgebra::{Complex, DMatrix};

use super::bodies::Coupled;

/// Numbers that one step of arithmetic takes together.
pub(super) const LANES: usize = 4;

/// The largest product of the norms of the eigenvectors and of their inverse, over their number, before equal eigenvalues are separated.
const ILL_CONDITIONED: f64 = 1e6;

/// The part of a frequency by which each mode is separated from the one before then.
const APART: f64 = 1e-9;

/// Below this |λ t| the series of the exponential has more digits than its closed form.
const SHORT: f64 = 0.05;

/// Complex numbers, some at a time; beyond the last of them are zeros.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Complexes {
    pub(super) re: Vec<[f64; LANES]>,
    pub(super) im: Vec<[f64; LANES]>,
}

impl Complexes {
    pub(super) fn of(values: impl Iterator<Item = Complex<f64>>) -> Self {
        let values: Vec<Complex<f64>> = values.collect();
        let lanes = |part: fn(&Complex<f64>) -> f64| {
            let of =
                |chunk: &[Complex<f64>]| std::array::from_fn(|i| chunk.get(i).map_or(0.0, part));
            values.chunks(LANES).map(of).collect()
        };
        Self {
            re: lanes(|value| value.re),
            im: lanes(|value| value.im),
        }
    }

    pub(super) fn zeros(count: usize) -> Self {
        let lanes = vec![[0.0; LANES]; count.div_ceil(LANES)];
        Self {
            re: lanes.clone(),
            im: lanes,
        }
    }

    /// Real and imaginary parts.
    #[inline(always)]
    pub(super) fn parts(&self) -> (&[f64], &[f64]) {
        (self.re.as_flattened(), self.im.as_flattened())
    }

    fn get(&self, i: usize) -> Complex<f64> {
        let (chunk, lane) = (i / LANES, i % LANES);
        Complex::new(self.re[chunk][lane], self.im[chunk][lane])
    }

    /// Each of them times that of `other`.
    pub(super) fn times(&self, other: &Self) -> Self {
        let count = LANES * self.re.len();
        Self::of((0..count).map(|i| self.get(i) * other.get(i)))
    }

    /// Σ Re(`self` `other`).
    #[inline(always)]
    pub(super) fn real_of_product(&self, other: &Self) -> f64 {
        let mut sums = [0.0; LANES];
        let own = self.re.iter().zip(&self.im);
        for ((re, im), (by_re, by_im)) in own.zip(other.re.iter().zip(&other.im)) {
            for lane in 0..LANES {
                sums[lane] += re[lane] * by_re[lane] - im[lane] * by_im[lane];
            }
        }
        sums.iter().sum()
    }

    /// Adds `by` times `other`.
    pub(super) fn add(&mut self, by: f64, other: &Self) {
        let parts = [(&mut self.re, &other.re), (&mut self.im, &other.im)];
        for (own, other) in parts {
            for (own, other) in own.iter_mut().zip(other) {
                for lane in 0..LANES {
                    own[lane] += by * other[lane];
                }
            }
        }
    }

    /// Becomes itself times a real `factor`.
    pub(super) fn scale(&mut self, factor: f64) {
        for lanes in self.re.iter_mut().chain(&mut self.im) {
            *lanes = lanes.map(|value| factor * value);
        }
    }

    /// Becomes itself times `factor`, and `by` times `other` more.
    #[inline(always)]
    pub(super) fn carry(&mut self, factor: &Self, by: f64, other: &Self) {
        let own = self.re.iter_mut().zip(&mut self.im);
        let factors = factor.re.iter().zip(&factor.im);
        let others = other.re.iter().zip(&other.im);
        for (((re, im), (f_re, f_im)), (o_re, o_im)) in own.zip(factors).zip(others) {
            for lane in 0..LANES {
                let (a, b) = (re[lane], im[lane]);
                re[lane] = f_re[lane] * a - f_im[lane] * b + by * o_re[lane];
                im[lane] = f_im[lane] * a + f_re[lane] * b + by * o_im[lane];
            }
        }
    }
}

/// The free motions of coupled bodies at a speed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FreeMotions {
    /// λ, none of which has a negative frequency.
    values: Vec<Complex<f64>>,
    /// Of each y its row over the state.
    of_state: Vec<Vec<Complex<f64>>>,
    /// v of each y.
    vectors: Vec<Vec<Complex<f64>>>,
    /// b.
    pushed: Vec<Complex<f64>>,
    /// By how much the teeth come nearer, and the hubs, with each y.
    pub(super) teeth: Complexes,
    pub(super) hubs: Complexes,
    /// The stiffness of the mesh in N/m.
    stiffness: f64,
}

impl FreeMotions {
    /// Those of `bodies` while the driving gear turns by `turn` rad/s.
    pub(super) fn of(bodies: &Coupled, turn: f64) -> Self {
        let found = eigenvectors(bodies, turn, 0.0);
        // Two gears that are alike have equal frequencies, whose eigenvectors rounding may bring together.
        let found = found.or_else(|| eigenvectors(bodies, turn, APART));
        let Eigenvectors {
            values,
            vectors,
            inverse,
        } = found.unwrap_or_else(|| Eigenvectors {
            values: Vec::new(),
            vectors: DMatrix::zeros(2 * bodies.count(), 0),
            inverse: DMatrix::zeros(0, 2 * bodies.count()),
        });
        let size = 2 * bodies.count();
        let mut of_state = Vec::new();
        let mut columns = Vec::new();
        let mut kept = Vec::new();
        let mut place = 0;
        while place < values.len() {
            let value = values[place];
            let is_pair = value.im != 0.0;
            let sine = |matrix: f64| if is_pair { matrix } else { 0.0 };
            let next = (place + 1).min(values.len() - 1);
            // s = Re(v y), with v = a + i b: a has Re y before it, and b has −Im y.
            let row = (0..size)
                .map(|i| Complex::new(inverse[(place, i)], -sine(inverse[(next, i)])))
                .collect();
            let column = (0..size)
                .map(|i| Complex::new(vectors[(i, place)], sine(vectors[(i, next)])))
                .collect();
            of_state.push(row);
            columns.push(column);
            kept.push(value);
            place += if is_pair { 2 } else { 1 };
        }
        let half = size / 2;
        let push = |row: &Vec<Complex<f64>>| -> Complex<f64> {
            let rates = bodies.teeth.iter().zip(&row[half..]);
            rates.map(|(z, w)| w * *z).sum()
        };
        let along = |of: &[f64]| {
            let sum = |column: &Vec<Complex<f64>>| of.iter().zip(column).map(|(z, v)| v * *z).sum();
            Complexes::of(columns.iter().map(sum))
        };
        Self {
            pushed: of_state.iter().map(push).collect(),
            teeth: along(&bodies.teeth),
            hubs: along(&bodies.hubs),
            values: kept,
            of_state,
            vectors: columns,
            stiffness: bodies.stiffness,
        }
    }

    /// y of `state`.
    pub(super) fn own(&self, state: &[f64]) -> Complexes {
        let rows = self.of_state.iter();
        Complexes::of(rows.map(|row| row.iter().zip(state).map(|(w, s)| w * *s).sum()))
    }

    /// Overwrites `state` with that of `own`.
    pub(super) fn to_state(&self, own: &Complexes, state: &mut [f64]) {
        state.fill(0.0);
        for (j, vector) in self.vectors.iter().enumerate() {
            let y = own.get(j);
            for (value, v) in state.iter_mut().zip(vector) {
                *value += v.re * y.re - v.im * y.im;
            }
        }
    }

    /// e^{λ t}, and the shares of a force that is linear in time at the beginning and at the end of `t`.
    pub(super) fn over(&self, t: f64) -> [Complexes; 3] {
        let all = self.values.iter().zip(&self.pushed);
        let each = all.map(|(value, pushed)| {
            let [whole, once, twice] = exponentials(value * t);
            [whole, pushed * t * (once - twice), pushed * t * twice]
        });
        let each: Vec<[Complex<f64>; 3]> = each.collect();
        [0, 1, 2].map(|k| Complexes::of(each.iter().map(|of| of[k])))
    }

    /// The amplitude at the hubs over that of the static curve, at the circular frequency `omega`, of a mesh with a constant stiffness.
    pub(super) fn gain(&self, omega: f64) -> f64 {
        let at = Complex::new(0.0, omega);
        let each = self.values.iter().zip(&self.pushed).enumerate();
        let sum: Complex<f64> = each
            .map(|(j, (value, pushed))| {
                let share = self.hubs.get(j) * pushed;
                share / (at - value) + share.conj() / (at - value.conj())
            })
            .sum();
        0.5 * self.stiffness * sum.norm()
    }

    /// The natural frequencies in Hz, rising, each with how far the teeth move in it: in kg^(−1/2), as for a modal mass of 1.
    pub(super) fn frequencies(&self) -> Vec<(f64, f64)> {
        let each = self.values.iter().zip(&self.pushed).enumerate();
        let each = each.filter(|(_, (value, _))| value.im > 0.0);
        let told = each.map(|(j, (value, pushed))| {
            let moved = (self.teeth.get(j) * pushed * value.norm()).norm().sqrt();
            (value.norm() / (2.0 * PI), moved)
        });
        let mut told: Vec<(f64, f64)> = told.collect();
        told.sort_by(|one, other| one.0.total_cmp(&other.0));
        told
    }
}

impl Coupled {
    /// The amplitude at the hubs over that of the static curve, at the circular frequency `omega`, of a mesh with a constant stiffness while the driving gear
    /// turns by `turn` rad/s.
    pub fn gain(&self, omega: f64, turn: f64) -> f64 {
        FreeMotions::of(self, turn).gain(omega)
    }
}

/// Eigenvalues of a matrix, their vectors and the inverse of these: two columns, and two rows, of a pair.
struct Eigenvectors {
    values: Vec<Complex<f64>>,
    vectors: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

/// Those of the rates of `bodies`, whose frequencies are `apart` by this part beforehand. Nothing if the vectors are not independent.
fn eigenvectors(bodies: &Coupled, turn: f64, apart: f64) -> Option<Eigenvectors> {
    let size = 2 * bodies.count();
    let half = size / 2;
    // Displacements times their frequencies are of the size of velocities.
    let scale = |i: usize| if i < half { bodies.frequencies[i] } else { 1.0 };
    let rate = bodies.rate(turn);
    let scaled = Mat::from_fn(size, size, |i, j| {
        let own = if i == half + j {
            1.0 + apart * j as f64
        } else {
            1.0
        };
        own * scale(i) * rate[(i, j)] / scale(j)
    });
    let mut vectors = Mat::<f64>::zeros(size, size);
    let (mut re, mut im) = (Diag::<f64>::zeros(size), Diag::<f64>::zeros(size));
    let scratch = evd_scratch::<f64>(
        size,
        ComputeEigenvectors::No,
        ComputeEigenvectors::Yes,
        Par::Seq,
        Default::default(),
    );
    evd_real(
        scaled.as_ref(),
        re.as_mut(),
        im.as_mut(),
        None,
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(scratch)),
        Default::default(),
    )
    .ok()?;
    let values = (0..size).map(|j| Complex::new(re[j], im[j])).collect();
    let mut vectors = DMatrix::from_fn(size, size, |i, j| vectors[(i, j)]);
    let mut place = 0;
    while place < size {
        let columns = if im[place] != 0.0 { 2 } else { 1 };
        let mut pair = vectors.columns_mut(place, columns);
        let norm = pair.norm();
        pair /= norm;
        place += columns;
    }
    let inverse = vectors.clone().try_inverse()?;
    let condition = vectors.norm() * inverse.norm() / size as f64;
    let is_well = condition < ILL_CONDITIONED;
    if apart == 0.0 && !is_well {
        return None;
    }
    let unscaled = DMatrix::from_fn(size, size, |i, j| vectors[(i, j)] / scale(i));
    let inverse = DMatrix::from_fn(size, size, |i, j| inverse[(i, j)] * scale(j));
    Some(Eigenvectors {
        values,
        vectors: unscaled,
        inverse,
    })
}

/// e^w, (e^w − 1)/w and (e^w − 1 − w)/w².
fn exponentials(w: Complex<f64>) -> [Complex<f64>; 3] {
    let one = Complex::new(1.0, 0.0);
    let whole = w.exp();
    if w.norm() > SHORT {
        let once = (whole - one) / w;
        return [whole, once, (once - one) / w];
    }
    // Σ wⁿ/(n + 1)! and Σ wⁿ/(n + 2)!.
    let (mut once, mut twice, mut term) = (one, one * 0.5, one);
    for n in 1..12 {
        term *= w / f64::from(n + 1);
        once += term;
        twice += term / f64::from(n + 2);
    }
    [whole, once, twice]
}
