//! A plain integrator of motions.

/// A motion by the classical Runge-Kutta method at tight steps, from `state` on: the root mean square and the peak-to-peak of the first number that `see` tells of
/// a state, and the largest second one, over the last periods. Counts are those of steps in a `period`, of periods, and of the last ones that are looked at.
pub(crate) fn settled_by_runge_kutta<const N: usize>(
    period: f64,
    [steps, periods, watched]: [u32; 3],
    mut state: [f64; N],
    rate: impl Fn(f64, [f64; N]) -> [f64; N],
    see: impl Fn(f64, [f64; N]) -> (f64, f64),
) -> [f64; 3] {
    let h = period / f64::from(steps);
    let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
    let (mut least, mut most, mut largest) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for i in 0..periods * steps {
        let t = f64::from(i) * h;
        let on = |by: f64, k: [f64; N]| std::array::from_fn(|j| state[j] + by * h * k[j]);
        let k1 = rate(t, state);
        let k2 = rate(t + h / 2.0, on(0.5, k1));
        let k3 = rate(t + h / 2.0, on(0.5, k2));
        let k4 = rate(t + h, on(1.0, k3));
        for j in 0..N {
            state[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
        }
        if i >= (periods - watched) * steps {
            let (x, force) = see(t + h, state);
            n += 1.0;
            sum += x;
            squares += x * x;
            (least, most) = (least.min(x), most.max(x));
            largest = largest.max(force);
        }
    }
    let mean: f64 = sum / n;
    [(squares / n - mean * mean).sqrt(), most - least, largest]
}
