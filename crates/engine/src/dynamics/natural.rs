//! Natural frequencies that the mesh excites, over speed, and what a linear mesh makes of the static curve at them.

use std::f64::consts::PI;

use super::free::FreeMotions;
use super::mesh::Mesh;
use super::order::Order;

/// Speeds at which frequencies that depend on the speed are known; they are lines of it, nearly.
const SPEEDS: usize = 33;

/// The part of the largest displacement of the teeth in a free motion below which they stand still in it.
const FAINT: f64 = 1e-3;

/// The natural frequencies of a mesh, over speed.
pub(super) struct Naturals<'a> {
    mesh: &'a Mesh<'a>,
    /// Speeds of the driving gear in revolutions per second, rising, with the free motions of the bodies there; one where they do not depend on it, none where
    /// the gears are one mass.
    free: Vec<(f64, FreeMotions)>,
    /// Of each natural frequency its value in Hz at these speeds, and whether the mesh excites it there; one value where it does not depend on the speed.
    frequencies: Vec<Vec<(f64, bool)>>,
}

impl<'a> Naturals<'a> {
    /// Those of `mesh` at the speeds that are asked for.
    pub(super) fn of(mesh: &'a Mesh<'a>) -> Self {
        let ends = mesh.data.speeds.first().zip(mesh.data.speeds.last());
        let (coupled, (first, last)) = match (mesh.coupled(), ends) {
            (Some(coupled), Some(ends)) if coupled.depends_on_speed() => (coupled, ends),
            (coupled, _) => {
                let free = coupled.map(|coupled| (0.0, FreeMotions::of(coupled, 0.0)));
                let excited = mesh.excited_frequencies().into_iter();
                return Self {
                    mesh,
                    free: free.into_iter().collect(),
                    frequencies: excited.map(|hertz| vec![(hertz, true)]).collect(),
                };
            }
        };
        let free: Vec<(f64, FreeMotions)> = (0..SPEEDS)
            .map(|i| first + (last - first) * i as f64 / (SPEEDS - 1) as f64)
            .map(|speed| (speed, FreeMotions::of(coupled, 2.0 * PI * speed)))
            .collect();
        let at_speeds: Vec<Vec<(f64, f64)>> =
            free.iter().map(|(_, free)| free.frequencies()).collect();
        let count = at_speeds.iter().map(Vec::len).min().unwrap_or(0);
        let moved = at_speeds.iter().flatten().map(|(_, moved)| *moved);
        let most = moved.fold(0.0, f64::max);
        let of_one = |j: usize| {
            let at = at_speeds.iter().map(|all| all[j]);
            at.map(|(hertz, moved)| (hertz, moved > FAINT * most))
                .collect()
        };
        Self {
            mesh,
            frequencies: (0..count).map(of_one).collect(),
            free,
        }
    }

    /// The number of natural frequencies.
    pub(super) fn count(&self) -> usize {
        self.frequencies.len()
    }

    /// The speed at which `order` meets the natural frequency at this place; nothing beyond the speeds that are asked for.
    pub(super) fn meets(&self, natural: usize, order: Order) -> Option<f64> {
        let of = &self.frequencies[natural];
        if let [(hertz, _)] = of[..] {
            let speed = hertz / self.mesh.frequency(order, 1.0);
            return self.mesh.data.reaches(speed).then_some(speed);
        }
        let beyond = |i: usize| {
            let (hertz, is_excited) = of[i];
            let speed = self.free[i].0;
            (speed, self.mesh.frequency(order, speed) - hertz, is_excited)
        };
        (1..of.len()).find_map(|i| {
            let [(from, below, before), (to, above, after)] = [beyond(i - 1), beyond(i)];
            let is_met = below <= 0.0 && above > 0.0 && (before || after);
            is_met.then(|| from + (to - from) * below / (below - above))
        })
    }

    /// The amplitude over that of the static curve at a `frequency` in Hz and a `speed`, with the mean stiffness at every position and flanks that do not
    /// part.
    pub(super) fn gain(&self, frequency: f64, speed: f64) -> f64 {
        let omega = 2.0 * PI * frequency;
        let away = |of: &(f64, FreeMotions)| (of.0 - speed).abs();
        let nearest = self
            .free
            .iter()
            .min_by(|one, other| away(one).total_cmp(&away(other)));
        match nearest {
            Some((_, free)) => free.gain(omega),
            None => self.mesh.data.gain(omega),
        }
    }
}
