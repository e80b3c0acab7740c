//! The long wave of a curve: its part with fewer than half a cycle in a mesh period, such as runout and holes make.

use realfft::RealFftPlanner;

/// The long wave of a curve that repeats, at equal steps, without the mean.
#[derive(Debug, Clone)]
pub(super) struct LongWave {
    first: f64,
    step: f64,
    values: Vec<f64>,
}

impl LongWave {
    /// Long wave of `values` at equal steps from the mesh position `first` over a number of mesh periods, after which they repeat.
    pub(super) fn of(values: &[f64], first: f64, periods: u32) -> Self {
        Self {
            first,
            step: f64::from(periods) / values.len() as f64,
            values: slow(values, periods as usize),
        }
    }

    /// Its value at a mesh position, on straight lines between the steps.
    pub(super) fn at(&self, mesh_position: f64) -> f64 {
        let place = (mesh_position - self.first) / self.step;
        let (before, part) = (place.floor(), place.fract());
        let at = |i: usize| self.values[i % self.values.len()];
        let before = before as usize;
        at(before) + part * (at(before + 1) - at(before))
    }

    /// Its largest value less its smallest.
    pub(super) fn range(&self) -> f64 {
        let [low, high] = [f64::min, f64::max].map(|pick| self.values.iter().copied().reduce(pick));
        high.unwrap_or(0.0) - low.unwrap_or(0.0)
    }
}

/// The lines of `values`, at equal steps over a number of mesh periods that repeat, with fewer than half a cycle in a mesh period, but for the mean.
fn slow(values: &[f64], periods: usize) -> Vec<f64> {
    let n = values.len();
    if periods <= 2 {
        return vec![0.0; n];
    }
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, back) = (planner.plan_fft_forward(n), planner.plan_fft_inverse(n));
    let mut input = values.to_vec();
    let mut lines = forward.make_output_vec();
    forward
        .process(&mut input, &mut lines)
        .expect("the planner made both buffers for this length");
    for (bin, line) in lines.iter_mut().enumerate() {
        *line = if bin > 0 && 2 * bin < periods {
            *line / n as f64
        } else {
            Default::default()
        };
    }
    back.process(&mut lines, &mut input)
        .expect("the planner made both buffers for this length");
    input
}
