//! Motions and forces of a circle in the real amplitudes a_0, a_1, b_1, a_2, … of its orders, each a block of unknowns.
//!
//! Bodies that repeat around their axis couple some orders only, those of one class ([`crate::ring::solid::sector`]): forms are kept class by
//! class.

use faer::{Mat, c64};

use crate::fem::dense::entries;

/// A symmetric form in the amplitudes of a circle: a stiffness or a compliance.
#[derive(Debug, Clone)]
pub(super) struct RoundForm {
    /// The unknowns of an amplitude.
    size: usize,
    /// The orders of each class, ascending, and the form in their amplitudes.
    classes: Vec<(Vec<usize>, Mat<f64>)>,
}

/// The motions or forces in which a [`RoundForm`] is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Amplitudes {
    /// Displacements, c_n = (a_n − i b_n)/2.
    Motions,
    /// The forces that work on them.
    Forces,
}

impl RoundForm {
    /// The real form of Hermitian ones, given for the signed orders of each class. A class stands for the opposite one too, its conjugate.
    pub(super) fn new(
        classes: impl IntoIterator<Item = (Vec<i64>, Mat<c64>)>,
        size: usize,
        of: Amplitudes,
    ) -> Self {
        let classes = classes.into_iter().filter(|(orders, _)| !orders.is_empty());
        Self {
            size,
            classes: classes
                .map(|(orders, form)| on_real(&orders, &form, size, of))
                .collect(),
        }
    }

    /// The form in the amplitudes of `orders`.
    pub(super) fn on(&self, orders: &[usize]) -> Mat<f64> {
        let count = amplitudes(orders, self.size);
        let mut form = Mat::zeros(count, count);
        for (own, of) in &self.classes {
            let shared = self.shared(own, orders);
            for (from, to) in &shared {
                for (row, place) in &shared {
                    form[(*place, *to)] = of[(*row, *from)];
                }
            }
        }
        form
    }

    /// `rows` in the amplitudes of `orders`, a column for each, times the form.
    pub(super) fn after(&self, rows: &Mat<f64>, orders: &[usize]) -> Mat<f64> {
        let mut product = Mat::zeros(rows.nrows(), rows.ncols());
        for (own, of) in &self.classes {
            let shared = self.shared(own, orders);
            let form = Mat::from_fn(shared.len(), shared.len(), |i, j| {
                of[(shared[i].0, shared[j].0)]
            });
            let columns = Mat::from_fn(rows.nrows(), shared.len(), |i, j| rows[(i, shared[j].1)]);
            let of_class = columns * form;
            for (j, (_, to)) in shared.iter().enumerate() {
                product.col_mut(*to).copy_from(of_class.col(j));
            }
        }
        product
    }

    /// The amplitudes that two lists of orders have in common: where each stands in that of `own`, and where in that of `orders`.
    fn shared(&self, own: &[usize], orders: &[usize]) -> Vec<(usize, usize)> {
        let starts = starts(orders, self.size);
        let of_order = |(order, from): (usize, usize)| {
            let (_, to) = starts.iter().find(|(other, _)| *other == order)?;
            Some((0..width(order, self.size)).map(move |i| (from + i, to + i)))
        };
        let own = self::starts(own, self.size).into_iter();
        own.filter_map(of_order).flatten().collect()
    }

    /// The form times columns of amplitudes of all orders.
    pub(super) fn times(&self, amplitudes: &Mat<f64>) -> Mat<f64> {
        let mut product = Mat::zeros(amplitudes.nrows(), amplitudes.ncols());
        for (orders, form) in &self.classes {
            let of_class = form * rows_of(amplitudes, orders, self.size);
            put_rows(&mut product, &of_class, orders, self.size);
        }
        product
    }

    /// The number of entries, for the size limit of the cache.
    pub(super) fn entries(&self) -> usize {
        self.classes.iter().map(|(_, form)| entries(form)).sum()
    }
}

/// The orders 0 … `largest` in sets that do not couple with each other where all repeats `repeats` times around.
pub(super) fn sets_of_orders(largest: usize, repeats: usize) -> Vec<Vec<usize>> {
    let class = |order: usize| (order % repeats).min(repeats - order % repeats);
    let sets = (0..=repeats / 2).map(|set| {
        let orders = 0..=largest;
        orders.filter(|order| class(*order) == set).collect()
    });
    sets.filter(|set: &Vec<usize>| !set.is_empty()).collect()
}

/// The number of amplitudes of `orders`, in unknowns of which each has `size`.
pub(super) fn amplitudes(orders: &[usize], size: usize) -> usize {
    orders.iter().map(|order| width(*order, size)).sum()
}

/// Where the cosine of an order stands, in blocks; the sine follows.
pub(super) fn block(order: usize) -> usize {
    if order == 0 { 0 } else { 2 * order - 1 }
}

/// The unknowns of both amplitudes of an order.
fn width(order: usize, size: usize) -> usize {
    if order == 0 { size } else { 2 * size }
}

/// `orders`, and where the amplitudes of each begin if they stand one after the other.
fn starts(orders: &[usize], size: usize) -> Vec<(usize, usize)> {
    let each = orders.iter().scan(0, |next, order| {
        let start = *next;
        *next += width(*order, size);
        Some((*order, start))
    });
    each.collect()
}

/// The places of the amplitudes of `orders` among those of all.
fn places(orders: &[usize], size: usize) -> impl Iterator<Item = usize> {
    orders.iter().flat_map(move |order| {
        let first = block(*order) * size;
        first..first + width(*order, size)
    })
}

/// The rows of `amplitudes`, of all orders, that belong to `orders`.
pub(super) fn rows_of(amplitudes: &Mat<f64>, orders: &[usize], size: usize) -> Mat<f64> {
    let places: Vec<usize> = places(orders, size).collect();
    Mat::from_fn(places.len(), amplitudes.ncols(), |i, j| {
        amplitudes[(places[i], j)]
    })
}

/// Puts `rows`, those of `orders`, to their places among `amplitudes` of all orders.
pub(super) fn put_rows(amplitudes: &mut Mat<f64>, rows: &Mat<f64>, orders: &[usize], size: usize) {
    for (i, place) in places(orders, size).enumerate() {
        for j in 0..rows.ncols() {
            amplitudes[(place, j)] = rows[(i, j)];
        }
    }
}

/// The amplitudes of `orders`, one after the other, turned by `angle` counter-clockwise.
pub(super) fn turned(
    amplitudes: &Mat<f64>,
    orders: impl IntoIterator<Item = usize>,
    size: usize,
    angle: f64,
) -> Mat<f64> {
    let mut turned = amplitudes.clone();
    let mut first = 0;
    for order in orders {
        if order > 0 {
            let (sin, cos) = (order as f64 * angle).sin_cos();
            for j in 0..amplitudes.ncols() {
                for a in first..first + size {
                    let b = a + size;
                    turned[(a, j)] = cos * amplitudes[(a, j)] - sin * amplitudes[(b, j)];
                    turned[(b, j)] = cos * amplitudes[(b, j)] + sin * amplitudes[(a, j)];
                }
            }
        }
        first += width(order, size);
    }
    turned
}

/// The Hermitian `form` in the amplitudes of the signed `orders` of one class, and its conjugate in the opposite ones, as one in real amplitudes.
fn on_real(orders: &[i64], form: &Mat<c64>, size: usize, of: Amplitudes) -> (Vec<usize>, Mat<f64>) {
    let mut own: Vec<usize> = orders.iter().map(|n| n.unsigned_abs() as usize).collect();
    own.sort_unstable();
    own.dedup();
    let starts = starts(&own, size);
    let share = match of {
        Amplitudes::Motions => 0.5,
        Amplitudes::Forces => 1.0,
    };
    // A class that is its own opposite has both signs.
    let times = match orders.contains(&-orders[0]) {
        true => 1.0,
        false => 2.0,
    };
    // (first place, weight) of the real unknowns that an order has.
    let parts = |order: i64| -> Vec<(usize, c64)> {
        let order_of = order.unsigned_abs() as usize;
        let start = starts.iter().find(|(own, _)| *own == order_of);
        let first = start.map_or(0, |(_, first)| *first);
        match order.signum() {
            0 => vec![(first, c64::new(1.0, 0.0))],
            sign => vec![
                (first, c64::new(share, 0.0)),
                (first + size, c64::new(0.0, -share * sign as f64)),
            ],
        }
    };
    let count = amplitudes(&own, size);
    let mut real = Mat::zeros(count, count);
    for (b, &m) in orders.iter().enumerate() {
        for (a, &n) in orders.iter().enumerate() {
            for (column, with) in parts(m) {
                for (row, by) in parts(n) {
                    let weight = by.conj() * with * times;
                    for j in 0..size {
                        for i in 0..size {
                            real[(row + i, column + j)] +=
                                (weight * form[(a * size + i, b * size + j)]).re;
                        }
                    }
                }
            }
        }
    }
    (own, real)
}
