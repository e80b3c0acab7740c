//! Natural frequencies and shapes of a gear: blank and teeth in three dimensions, by classes of its symmetry.
//!
//! K x = ω² M x with consistent masses. The blank from the bore to a circle below the roots is divided in its plane (`section`) and carries
//! quadratic functions along the axis that all parts share ([`heights`]), so that rim, web and hub move equal where they meet. The teeth stand on
//! that circle, order by order (`teeth`). In class k of S equal sectors all turns by e^{i2πk/S} from one to the next; each class is one sparse
//! Hermitian problem (`system`) for Lanczos's method (`fem::eigen`). Classes between 0 and S/2 stand for two modes, a cosine and a sine.
//!
//! [`shape`](ModeShape) has a mode on its grid.
//!
//! Helical teeth stand as straight ones of the same transverse section. A gear of one piece with its shaft is held where the shaft begins. Nothing
//! rotates: frequencies are those at rest in the frame of the gear ([`campbell`] says where they are met at speed).

pub mod campbell;
mod found;
pub mod heights;
mod mode;
pub mod rotation;
mod section;
mod shape;
mod system;
mod teeth;
#[cfg(test)]
mod tests;

use faer::{Mat, c64};
use rayon::prelude::*;

use self::heights::{Heights, Parity};
use self::section::Blank;
use self::system::{Numbering, System};
use self::teeth::{TeethOrder, ToothCell};
use crate::fem::FemError;
use crate::fem::eigen::{Entry, Lanczos, Pencil, inner};
use crate::gear::{Material, SolidGear};
use crate::grid::GridError;
use crate::run::Run;

pub use self::mode::{Direction, Mode, OrderShape};
pub use self::shape::{ModeShape, ShapeSize};
pub use self::system::BoreSupport;

/// The largest order of the circle on which the teeth stand.
const MOST_ORDERS: usize = 40;
/// Modes that each class is asked for at first.
const AT_FIRST: usize = 3;
/// Modes more that a class is asked for where those found are all among the lowest.
const MORE: usize = 4;
/// The shift, as a part of (c_s/r_a)², c_s the speed of shear waves.
const SHIFT: f64 = 1e-2;
/// The value of a rigid turn, as a part of the shift, is smaller.
const RIGID: f64 = 1e-6;

/// The modes that are asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModesAsked {
    /// How many of the lowest, at most.
    pub count: usize,
    /// The highest frequency in hertz, if there is a limit.
    pub highest: Option<f64>,
    /// How the bore carries the gear.
    pub bore: BoreSupport,
}

/// The parts by which the frequencies of a cosine and a sine of one wave differ at most where holes tell them apart, and where the grid alone does.
const NEAR: f64 = 0.05;
const ALIKE: f64 = 0.01;

/// Why modes could not be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModesError {
    /// The blank or its teeth cannot be divided.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// A matrix could not be factorized, or the caller stopped the work.
    #[error(transparent)]
    Fem(#[from] FemError),
}

/// The lowest modes of `gear`, the lowest first.
///
/// A double mode stands once. The result is the same to the last bit on any number of threads.
///
/// # Errors
///
/// [`ModesError`].
pub fn modes(gear: &SolidGear, asked: ModesAsked, run: &Run) -> Result<Vec<Mode>, ModesError> {
    let (modes, _) = of_gear(gear, |body| body.modes(asked, None, run))?;
    Ok(modes)
}

/// The shape of the mode at this place, from 0, among the [`modes`] of `gear`; `None` beyond the last of them.
///
/// # Errors
///
/// [`ModesError`].
pub fn mode_shape(
    gear: &SolidGear,
    asked: ModesAsked,
    place: usize,
    run: &Run,
) -> Result<Option<ModeShape>, ModesError> {
    let (_, shape) = of_gear(gear, |body| body.modes(asked, Some(place), run))?;
    Ok(shape)
}

/// The size of the shape of a mode of `gear`.
///
/// # Errors
///
/// [`ModesError::Grid`].
pub fn shape_size(gear: &SolidGear) -> Result<ShapeSize, ModesError> {
    of_gear(gear, |body| Ok(body.shape_size()))
}

/// The answer of `work` on the body of `gear`.
fn of_gear<T>(
    gear: &SolidGear,
    work: impl FnOnce(Body<'_>) -> Result<T, FemError>,
) -> Result<T, ModesError> {
    let blank = Blank::new(gear)?;
    let section = gear.section();
    let cell = ToothCell::new(section, blank.parts[0].outer_radius)?;
    Ok(work(Body {
        blank: &blank,
        teeth: Some((gear, &cell)),
        material: section.material(),
    })?)
}

/// The largest number of modes that can be asked of a gear with the given number of teeth: two of each number of nodal diameters that its grid follows, one in the plane and one out
/// of it.
pub fn most_modes(tooth_count: u32) -> usize {
    2 * (section::least_around(tooth_count as usize) / 2).min(MOST_ORDERS)
}

/// Seconds of one core in each parity, with [`HEIGHTS`] functions along the axis: for an order of teeth, for an element along the arc of a sector with a hole in
/// a class, and for a gear without symmetry. Measured on gears of 25 to 90 teeth, good to a factor of two.
const SECONDS: [f64; 3] = [0.013, 0.025, 9.0];
const HEIGHTS: f64 = 3.0;
/// The powers of the functions along the axis by which these grow. Only some of them reach into a web, where holes are.
const GROWTH: [f64; 3] = [2.2, 1.5, 1.5];
/// Bytes of the first two, and of the last in one parity.
const BYTES: [f64; 2] = [150e6, 450e6];
/// How much more memory a gear takes that is not its own image in the middle of its face than one parity of one that is.
const WHOLE_WIDTH: f64 = 6.0;

/// Rough cost of [`modes`] of `gear`: seconds of one core, and bytes.
pub fn estimate(gear: &SolidGear) -> [f64; 2] {
    let section = gear.section();
    let heights = Heights::of_layers(&gear.layers());
    let parities = heights.parities().len() as f64;
    let grown = heights.nodes.len() as f64 / HEIGHTS;
    let each = |of: usize| parities * SECONDS[of] * grown.powf(GROWTH[of]);
    let orders = most_modes(section.tooth_count()) as f64 / 2.0;
    let [seconds, bytes] = match section.hole_pattern() {
        Some(pattern) => {
            let count = f64::from(pattern.count);
            let classes = f64::from(pattern.count / 2 + 1);
            [
                each(1) * classes * section::around_holes(count) / count,
                BYTES[0],
            ]
        }
        None if section.has_holes() => {
            let copies = if heights.is_half { 2.0 } else { WHOLE_WIDTH };
            [each(2), BYTES[1] * copies]
        }
        None => [0.0, BYTES[0]],
    };
    [each(0) * orders + seconds, bytes]
}

/// A blank with or without teeth.
struct Body<'a> {
    blank: &'a Blank,
    teeth: Option<(&'a SolidGear, &'a ToothCell)>,
    material: &'a Material,
}

/// One class of motions on its way to its modes.
struct Class<'a> {
    system: &'a System<'a>,
    parity: Parity,
    class: usize,
    numbering: Numbering,
    lanczos: Lanczos,
    /// The largest value that counts as a rigid turn.
    rigid_below: f64,
}

impl Class<'_> {
    /// The values found, without a rigid turn.
    fn values(&self) -> impl Iterator<Item = (usize, f64)> {
        let found = self.lanczos.found().iter().enumerate();
        let values = found.map(|(index, pair)| (index, pair.value));
        values.filter(|(_, value)| *value > self.rigid_below)
    }

    /// True if a mode below `limit` may be missing.
    fn may_miss(&self, limit: f64) -> bool {
        let last = self.lanczos.found().last();
        !self.lanczos.is_exhausted() && last.is_none_or(|pair| pair.value < limit)
    }
}

/// A mode among those found, by its place, and the one that is its sine where two single modes stand once, with its sign.
#[derive(Debug, Clone, Copy)]
struct Listed {
    place: usize,
    sine: Option<(usize, f64)>,
}

impl Body<'_> {
    /// The functions along the axis of all parts, and where the faces of each part are.
    fn heights(&self) -> (Heights, Vec<[f64; 2]>) {
        let parts = &self.blank.parts;
        let faces = parts.iter().map(|part| part.heights).collect();
        (Heights::of_layers(parts), faces)
    }

    /// The largest order of the circle on which the teeth stand.
    fn largest_order(&self) -> usize {
        (self.blank.section.around / 2).min(MOST_ORDERS)
    }

    /// The teeth on one sector of the blank.
    fn teeth_in_sector(&self) -> f64 {
        let teeth = self
            .teeth
            .map_or(0.0, |(gear, _)| f64::from(gear.section().tooth_count()));
        teeth / self.blank.section.sectors as f64
    }

    /// The shift s.
    fn shift(&self) -> f64 {
        let outer = self.blank.parts[0].outer_radius;
        let shear = self.material.shear_modulus() / self.material.density;
        SHIFT * shear / outer.powi(2)
    }

    /// The unknowns of a class of motions, and the entries of its matrices: with the teeth that `of_order` has on the orders of the circle.
    fn assembled<'t>(
        &self,
        system: &System<'_>,
        (parity, class): (Parity, usize),
        of_order: impl Fn(i64) -> Option<&'t TeethOrder>,
    ) -> (Numbering, Vec<Entry>) {
        let (sectors, largest) = (system.section.sectors as i64, self.largest_order() as i64);
        let of_class = |order: &i64| order.rem_euclid(sectors) == class as i64;
        let orders: Vec<i64> = (-largest..=largest).filter(of_class).collect();
        let numbering = system.numbering(parity, class, &orders);
        let mut entries: Vec<Entry> = Vec::new();
        system.assemble(&numbering, &mut entries);
        let (share, size) = (self.teeth_in_sector(), numbering.amplitude_size());
        for (k, order) in orders.iter().enumerate() {
            let first = numbering.first_amplitude + k * size;
            let Some(of_order) = of_order(*order) else {
                continue;
            };
            match order {
                0.. => of_order.add(first, share, &mut entries),
                _ => of_order.add_opposite(first, share, &mut entries),
            }
        }
        (numbering, entries)
    }

    /// The size of the shape of a mode.
    fn shape_size(&self) -> ShapeSize {
        let (heights, faces) = self.heights();
        let section = &self.blank.section;
        let held = BoreSupport::Held;
        let blank = System::new(section, &heights, &faces, self.material, held);
        let size = ShapeSize::of(&blank, section.sectors);
        let Some((gear, cell)) = self.teeth else {
            return size;
        };
        let tooth = cell.system(&heights, gear.section(), gear.face_heights());
        let z = gear.section().tooth_count() as usize;
        size.and(ShapeSize::of(&tooth, z))
    }

    /// The lowest modes, and the shape of that at the place `shown`.
    fn modes(
        &self,
        asked: ModesAsked,
        shown: Option<usize>,
        run: &Run,
    ) -> Result<(Vec<Mode>, Option<ModeShape>), FemError> {
        let (heights, faces) = self.heights();
        let heights = &heights;
        let system = &System::new(
            &self.blank.section,
            heights,
            &faces,
            self.material,
            asked.bore,
        );
        let largest = self.largest_order();
        let teeth = self.teeth_orders(heights, largest, run)?;
        let sectors = self.blank.section.sectors;
        let keys: Vec<(Parity, usize)> = heights
            .parities()
            .iter()
            .flat_map(|parity| (0..=(sectors / 2).min(largest)).map(|class| (*parity, class)))
            .collect();
        let mut classes: Vec<Class<'_>> = keys
            .into_par_iter()
            .map(|(parity, class)| {
                let of_parity = teeth.iter().find(|(of, _)| *of == parity);
                let orders = of_parity.map(|(_, orders)| orders.as_slice());
                self.class(system, (parity, class), orders, run)
            })
            .collect::<Result<_, _>>()?;
        // Where no symmetry is used, a double mode is found twice.
        let copies = if sectors == 1 && self.repeats() > 2 {
            2
        } else {
            1
        };
        let count = copies * asked.count;
        let highest = asked.highest.map_or(f64::INFINITY, |hertz| {
            (std::f64::consts::TAU * hertz).powi(2)
        });
        loop {
            let mut values: Vec<f64> = classes
                .iter()
                .flat_map(|class| class.values().map(|(_, value)| value))
                .collect();
            values.sort_by(f64::total_cmp);
            let enough = values.get(count.saturating_sub(1)).copied();
            let limit = enough.unwrap_or(f64::INFINITY).min(highest);
            let is_open = |class: &Class<'_>| class.may_miss(limit);
            if !classes.iter().any(is_open) {
                break;
            }
            classes.par_iter_mut().try_for_each(|class| {
                if !class.may_miss(limit) {
                    return Ok(());
                }
                let wanted = class.lanczos.found().len() + MORE;
                class.lanczos.find(wanted, run)
            })?;
        }
        let mut lowest: Vec<(f64, usize, usize)> = Vec::new();
        for (place, class) in classes.iter().enumerate() {
            let below = class.values().filter(|(_, value)| *value <= highest);
            lowest.extend(below.map(|(index, value)| (value, place, index)));
        }
        lowest.sort_by(|one, other| one.0.total_cmp(&other.0));
        lowest.truncate(count);
        let weights = system.node_weights();
        let found = |place: usize| {
            let class = &classes[lowest[place].1];
            let of_parity = teeth.iter().find(|(of, _)| *of == class.parity);
            let teeth = of_parity.and_then(|(_, orders)| {
                self.teeth
                    .map(|(gear, cell)| found::Teeth { gear, cell, orders })
            });
            found::Found {
                system: class.system,
                numbering: &class.numbering,
                parity: class.parity,
                class: class.class,
                weights: &weights,
                phase: self.blank.phase,
                teeth,
            }
        };
        let made = (0..lowest.len()).into_par_iter().map(|place| {
            let (value, class, index) = lowest[place];
            let lanczos = &classes[class].lanczos;
            found(place).mode(value, &lanczos.found()[index], lanczos)
        });
        let (mut modes, vectors): (Vec<Mode>, Vec<Mat<c64>>) = made.unzip();
        let alone = |place: usize| Listed { place, sine: None };
        let mut listed: Vec<Listed> = (0..modes.len()).map(alone).collect();
        if sectors == 1 {
            let coupled = |(one, other): (usize, usize)| {
                let class = &classes[lowest[one].1];
                let [turned, _] = class.numbering.turned(&vectors[other]);
                let mass = class.lanczos.pencil().mass_times(&turned);
                inner(&vectors[one], &mass).re * heights.copies()
            };
            let same_class = |one: usize, other: usize| lowest[one].1 == lowest[other].1;
            listed = self.pair_up(&mut modes, same_class, coupled);
            listed.truncate(asked.count);
        }
        let shape = shown.and_then(|shown| {
            let Listed { place, sine } = *listed.get(shown)?;
            let mut x = vectors[place].clone();
            if let Some((other, sign)) = sine {
                x += &vectors[other] * faer::Scale(c64::new(0.0, sign));
            }
            Some(found(place).on_grid(modes[place].clone(), &x))
        });
        let of_list = listed.iter().map(|listed| modes[listed.place].clone());
        Ok((of_list.collect(), shape))
    }

    /// How often the holes repeat around the gear.
    fn repeats(&self) -> u32 {
        self.teeth
            .map_or(1, |(gear, _)| gear.section().hole_repeats())
    }

    /// Finds the cosine and the sine of each wave among single `modes`. Those that differ by their grid alone stand once in the list.
    fn pair_up(
        &self,
        modes: &mut [Mode],
        same_class: impl Fn(usize, usize) -> bool,
        coupled: impl Fn((usize, usize)) -> f64,
    ) -> Vec<Listed> {
        let repeats = self.repeats();
        let mut is_taken = vec![false; modes.len()];
        let mut is_left = vec![true; modes.len()];
        let mut sines = vec![None; modes.len()];
        for one in 0..modes.len() {
            let (n, direction) = (modes[one].nodal_diameters, modes[one].direction);
            if is_taken[one] || n == 0 {
                continue;
            }
            let apart = |other: &usize| modes[*other].frequency / modes[one].frequency - 1.0;
            let Some(other) = (one + 1..modes.len()).find(|other| {
                let equal =
                    modes[*other].nodal_diameters == n && modes[*other].direction == direction;
                equal && !is_taken[*other] && same_class(one, *other) && apart(other) < NEAR
            }) else {
                continue;
            };
            let are_equal =
                repeats > 2 && !(2 * n).is_multiple_of(repeats) && apart(&other) < ALIKE;
            (is_taken[one], is_taken[other]) = (true, true);
            is_left[other] = !are_equal;
            let (head, tail) = modes.split_at_mut(other);
            let sign = head[one].pair_with(&mut tail[0], coupled((one, other)), are_equal);
            sines[one] = are_equal.then_some((other, sign));
        }
        let left = (0..modes.len()).filter(|place| is_left[*place]);
        left.map(|place| Listed {
            place,
            sine: sines[place],
        })
        .collect()
    }

    /// The teeth on the orders 0 to `largest` of their circle, for each parity; the circle's system is made for it.
    fn teeth_orders(
        &self,
        heights: &Heights,
        largest: usize,
        run: &Run,
    ) -> Result<Vec<(Parity, Vec<TeethOrder>)>, FemError> {
        let Some((gear, cell)) = self.teeth else {
            return Ok(Vec::new());
        };
        let system = cell.system(heights, gear.section(), gear.face_heights());
        let of_parity = |parity: &Parity| {
            let orders = (0..=largest).into_par_iter().map(|order| {
                run.check()?;
                TeethOrder::new(&system, *parity, order as i64)
            });
            Ok((*parity, orders.collect::<Result<_, FemError>>()?))
        };
        heights.parities().iter().map(of_parity).collect()
    }

    /// Class `of.1` of the motions of parity `of.0`, before its first mode; `teeth` are those of the orders 0 to `largest`.
    fn class<'s>(
        &self,
        system: &'s System<'s>,
        (parity, class): (Parity, usize),
        teeth: Option<&[TeethOrder]>,
        run: &Run,
    ) -> Result<Class<'s>, FemError> {
        run.check()?;
        let of_order = |order: i64| teeth.map(|teeth| &teeth[order.unsigned_abs() as usize]);
        let (numbering, entries) = self.assembled(system, (parity, class), of_order);
        let pencil = Pencil::new(numbering.count, &entries);
        let shift = self.shift();
        let mut lanczos = Lanczos::new("the blank", pencil, shift)?;
        lanczos.find(AT_FIRST, run)?;
        let is_free = numbering.turn.is_some();
        Ok(Class {
            system,
            parity,
            class,
            numbering,
            lanczos,
            rigid_below: if is_free {
                RIGID * shift
            } else {
                f64::NEG_INFINITY
            },
        })
    }
}
