//! The orders of a spectrum: of the mesh, of holes, of revolutions, and the sidebands of these about the mesh.

use crate::gear::{GearPair, Member, SpurGear};

/// Kind of a line of the spectrum.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OrderKind {
    /// The mesh, k times.
    Mesh {
        /// k.
        harmonic: u32,
    },
    /// Multiple of the order of a cause: n per N holes, or n per revolution.
    Cause {
        /// The cause.
        cause: OrderCause,
        /// n.
        multiple: u32,
    },
    /// A cause about the mesh: k times the mesh and n times the cause more, or less where n is negative.
    Sideband {
        /// k.
        harmonic: u32,
        /// The cause.
        cause: OrderCause,
        /// n.
        multiple: i32,
    },
}

/// Causes that repeat with the turning of gears, beside the mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OrderCause {
    /// True if it is the same at each of the holes; false if it comes once a revolution, as eccentricity, pitch deviations and errors of cutting do.
    pub holes: bool,
    /// The gears that make this order, by the order of [`Member::BOTH`].
    pub gears: Vec<Member>,
}

/// An order per revolution of the driven gear, with its name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct KnownOrder {
    pub(super) order: f64,
    pub(super) label: String,
    pub(super) kind: OrderKind,
}

/// Mesh harmonics that get a name.
const NAMED_MESH_HARMONICS: u32 = 10;

/// Multiples of a revolution that get a name whatever their amplitude.
const NAMED_REVOLUTIONS: u32 = 3;

/// Mesh harmonics around which sidebands get a name, and sidebands to either side.
const SIDEBANDS: (u32, u32) = (4, 2);

/// Largest distance, in orders of a revolution, from a mesh harmonic at which a line is called its sideband.
const NEAR_MESH: i64 = 5;

/// Orders nearer to each other than this are the same.
const SAME: f64 = 1e-9;

/// A cause of one or both gears, its order per revolution of the driven gear, and how it is called in a label.
#[derive(Debug, Clone)]
struct Family {
    cause: OrderCause,
    order: f64,
    name: String,
}

impl Family {
    /// Label of its `multiple`: 2N1 of holes, 2 or 2(1) of revolutions.
    fn called(&self, multiple: u32) -> String {
        match (self.cause.holes, multiple) {
            (true, 1) => self.name.clone(),
            (_, n) => format!("{n}{}", self.name),
        }
    }
}

/// The orders of a pair.
#[derive(Debug, Clone)]
pub(super) struct Orders {
    mesh: f64,
    holes: Vec<Family>,
    revolutions: Vec<Family>,
}

impl Orders {
    pub(super) fn of(pair: &GearPair) -> Self {
        let mesh = f64::from(pair.driven().tooth_count());
        // A revolution of a gear, in those of the driven one.
        let revolution = |member: Member| mesh / f64::from(pair.gear(member).tooth_count());
        let holes = |member: Member| {
            let count = hole_order(pair.gear(member))?;
            Some(f64::from(count) * revolution(member))
        };
        let once = |member: Member| repeats_once(pair.gear(member)).then(|| revolution(member));
        Self {
            mesh,
            holes: families(true, Member::BOTH.map(holes)),
            revolutions: families(false, Member::BOTH.map(once)),
        }
    }

    /// The orders that have names whatever their amplitude, each once and rising: the mesh and its multiples, holes, the first
    /// revolutions of gears that deviate, and the sidebands of both.
    pub(super) fn known(&self) -> Vec<KnownOrder> {
        let mut known: Vec<KnownOrder> = Vec::new();
        let mut add = |order: KnownOrder| {
            let is_new = known
                .iter()
                .all(|other| (other.order - order.order).abs() > SAME);
            if order.order > 0.0 && is_new {
                known.push(order);
            }
        };
        (1..=NAMED_MESH_HARMONICS).for_each(|k| add(self.mesh(k)));
        self.holes
            .iter()
            .for_each(|family| add(multiple_of(family, 1)));
        for family in &self.revolutions {
            (1..=NAMED_REVOLUTIONS).for_each(|n| add(multiple_of(family, n)));
        }
        for family in self.holes.iter().chain(&self.revolutions) {
            for k in 1..=SIDEBANDS.0 {
                for n in 1..=SIDEBANDS.1 as i32 {
                    [-n, n]
                        .into_iter()
                        .for_each(|n| add(self.sideband(k, family, n)));
                }
            }
        }
        known.sort_by(|a, b| a.order.total_cmp(&b.order));
        known
    }

    /// Kind of any order that is a whole multiple of a cause in the pair: of holes first, then near the mesh, then of revolutions.
    pub(super) fn describe(&self, order: f64) -> Option<KnownOrder> {
        if let Some(k) = whole(order / self.mesh) {
            return Some(self.mesh(k));
        }
        let of = |families: &[Family]| {
            families
                .iter()
                .find_map(|family| Some(multiple_of(family, whole(order / family.order)?)))
        };
        of(&self.holes)
            .or_else(|| self.near_mesh(order))
            .or_else(|| of(&self.revolutions))
    }

    /// The name of any order. A broken multiple of a cause in the pair has the name of its whole: half of the mesh order is H_Z2/2.
    pub(super) fn name(&self, order: f64, parts: u32) -> String {
        let whole = order * f64::from(parts);
        let mut known = self.known().into_iter();
        let known = known.find(|known| (known.order - whole).abs() < SAME);
        let Some(known) = known.or_else(|| self.describe(whole)) else {
            return format!("H_{order}");
        };
        if parts == 1 {
            known.label
        } else {
            format!("{}/{parts}", known.label)
        }
    }

    fn near_mesh(&self, order: f64) -> Option<KnownOrder> {
        let k = (order / self.mesh).round();
        if k < 1.0 {
            return None;
        }
        self.revolutions.iter().find_map(|family| {
            let n = (order - k * self.mesh) / family.order;
            let is_near = (n - n.round()).abs() < SAME && (n.round() as i64).abs() <= NEAR_MESH;
            is_near.then(|| self.sideband(k as u32, family, n.round() as i32))
        })
    }

    fn mesh(&self, harmonic: u32) -> KnownOrder {
        KnownOrder {
            order: f64::from(harmonic) * self.mesh,
            label: mesh_label(harmonic),
            kind: OrderKind::Mesh { harmonic },
        }
    }

    fn sideband(&self, harmonic: u32, family: &Family, multiple: i32) -> KnownOrder {
        let mark = if multiple < 0 { '-' } else { '+' };
        let called = family.called(multiple.unsigned_abs());
        KnownOrder {
            order: f64::from(harmonic) * self.mesh + f64::from(multiple) * family.order,
            label: format!("H_{}{mark}{called}", mesh_name(harmonic)),
            kind: OrderKind::Sideband {
                harmonic,
                cause: family.cause.clone(),
                multiple,
            },
        }
    }
}

fn multiple_of(family: &Family, multiple: u32) -> KnownOrder {
    KnownOrder {
        order: f64::from(multiple) * family.order,
        label: format!("H_{}", family.called(multiple)),
        kind: OrderKind::Cause {
            cause: family.cause.clone(),
            multiple,
        },
    }
}

/// The label of this mesh harmonic in a spectrum.
pub fn mesh_label(harmonic: u32) -> String {
    format!("H_{}", mesh_name(harmonic))
}

fn mesh_name(harmonic: u32) -> String {
    match harmonic {
        1 => "Z2".to_owned(),
        k => format!("{k}Z2"),
    }
}

/// `value` as a count, if it is one.
fn whole(value: f64) -> Option<u32> {
    (value > 0.5 && (value - value.round()).abs() < SAME).then_some(value.round() as u32)
}

/// The order that the holes of `gear` make in one of its revolutions: how often they repeat, or their number where they do not.
fn hole_order(gear: &SpurGear) -> Option<u32> {
    match gear.hole_repeats() {
        0 => None,
        1 => Some(gear.holes().len() as u32),
        repeats => Some(repeats),
    }
}

/// True if the effect of teeth or holes of `gear` repeats only after a whole revolution.
fn repeats_once(gear: &SpurGear) -> bool {
    let unequal = gear.hole_repeats() == 1 && gear.holes().len() > 1;
    unequal || !gear.deviations().is_none()
}

/// The families of both gears' orders. Holes of both that make different orders have the number of their gear. Revolutions are those of
/// the driven gear, per which orders count; those of the driving gear have its number, unless both are the same.
fn families(holes: bool, orders: [Option<f64>; 2]) -> Vec<Family> {
    let family = |order: f64, gears: &[Member], number: &str| Family {
        cause: OrderCause {
            holes,
            gears: gears.to_vec(),
        },
        order,
        name: match (holes, number) {
            (true, number) => format!("N{number}"),
            (false, "1") => "(1)".to_owned(),
            (false, _) => String::new(),
        },
    };
    let (one, two) = (&[Member::Driving], &[Member::Driven]);
    match orders {
        [Some(first), Some(second)] if (first - second).abs() > SAME => {
            vec![family(first, one, "1"), family(second, two, "2")]
        }
        [Some(order), Some(_)] => vec![family(order, &Member::BOTH, "")],
        [Some(order), None] if !holes && (order - 1.0).abs() > SAME => {
            vec![family(order, one, "1")]
        }
        [Some(order), None] => vec![family(order, one, "")],
        [None, Some(order)] => vec![family(order, two, "")],
        [None, None] => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{Eccentricity, GearData, HolePattern, SpurGear};

    fn eccentric(tooth_count: u32) -> GearData {
        let mut data = paper_gear(tooth_count);
        data.blank.bore_radius = 10e-3;
        data.deviations.eccentricity = Some(Eccentricity {
            amount: 10e-6,
            direction: 0.0,
        });
        data
    }

    fn orders(driving: GearData, driven: GearData, center_distance: f64) -> Orders {
        let [driving, driven] = [driving, driven].map(|data| SpurGear::new(data).expect("a gear"));
        Orders::of(&GearPair::new(driving, driven, center_distance).expect("meshes"))
    }

    fn label(orders: &Orders, order: f64) -> String {
        orders.describe(order).expect("a whole multiple").label
    }

    #[test]
    fn equal_gears_share_their_revolutions_and_unlike_ones_have_numbers() {
        let alike = orders(eccentric(50), eccentric(50), 100.5e-3);
        let known = alike.known();
        assert_eq!((known[0].order, &*known[0].label), (1.0, "H_1"));
        assert_eq!(label(&alike, 49.0), "H_Z2-1");
        let unlike = orders(eccentric(29), eccentric(85), 114.5e-3);
        assert_eq!(label(&unlike, 85.0 / 29.0), "H_1(1)");
        assert_eq!(label(&unlike, 85.0 - 85.0 / 29.0), "H_Z2-1(1)");
        assert_eq!(label(&unlike, 86.0), "H_Z2+1");
        let of_both = unlike
            .known()
            .iter()
            .filter(|known| known.order < 9.0)
            .count();
        assert_eq!(of_both, 6, "three revolutions each");
    }

    #[test]
    fn a_ghost_order_is_told_per_revolution_of_the_gear_that_turns_so_often() {
        let mut solid = paper_gear(29);
        solid.blank.bore_radius = 10e-3;
        let driven = orders(solid, eccentric(85), 114.5e-3);
        let ghost = driven.describe(63.0).expect("whole revolutions");
        let cause = OrderCause {
            holes: false,
            gears: vec![Member::Driven],
        };
        assert_eq!(ghost.label, "H_63");
        assert_eq!(
            ghost.kind,
            OrderKind::Cause {
                cause,
                multiple: 63
            }
        );
        assert_eq!(
            driven.describe(85.0 / 29.0),
            None,
            "the driving gear does not deviate"
        );
    }

    #[test]
    fn a_part_of_an_order_is_called_by_it_and_a_sideband_as_in_the_spectrum() {
        let mut holed = eccentric(50);
        holed.deviations.eccentricity = None;
        holed.blank.holes = HolePattern {
            count: 10,
            circle_radius: 34e-3,
            radius: 7.5e-3,
            phase: 0.0,
        }
        .holes();
        let orders = orders(paper_gear(50), holed, 100.5e-3);
        let named = [(25.0, 2), (75.0, 2), (5.0, 2), (40.0, 1), (30.0, 1)];
        let names = named.map(|(order, parts)| orders.name(order, parts));
        assert_eq!(names, ["H_Z2/2", "H_3Z2/2", "H_N/2", "H_Z2-N", "H_Z2-2N"]);
        assert_eq!(orders.name(7.0, 1), "H_7");
    }

    #[test]
    fn what_holes_make_is_told_before_what_a_revolution_makes() {
        let mut holed = eccentric(50);
        holed.blank.holes = HolePattern {
            count: 10,
            circle_radius: 34e-3,
            radius: 7.5e-3,
            phase: 0.0,
        }
        .holes();
        let orders = orders(paper_gear(50), holed, 100.5e-3);
        let labels = [10.0, 20.0, 50.0, 51.0, 7.0].map(|order| label(&orders, order));
        assert_eq!(labels, ["H_N", "H_2N", "H_Z2", "H_Z2+1", "H_7"]);
    }
}
