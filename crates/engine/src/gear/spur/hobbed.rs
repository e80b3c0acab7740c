//! The profile cut by a hob with a protuberance, against the envelope of the hob.

use std::f64::consts::PI;

use super::SpurGear;
use super::tests::paper_gear;
use crate::gear::{GearData, GearError, Helix, Protuberance, Rack, SolidGear, Vector};
use crate::root_finding::bisect;

/// The profile of a hob in its normal section, built from the definitions of the standards, without an envelope.
struct Hob {
    rack: Rack,
    /// The center of the tip rounding: beside the middle of the tooth, and below the reference line.
    center: [f64; 2],
    /// Where the protuberance begins.
    begins: [f64; 2],
    /// The angle of its flank.
    angle: f64,
}

impl Hob {
    fn new(rack: Rack) -> Self {
        let Protuberance {
            amount,
            height,
            grinding_stock,
        } = rack.protuberance.expect("a hob with a protuberance");
        let (alpha, rho) = (rack.pressure_angle, rack.tip_radius);
        // A line beside the flank of the rack, by how far it stands out from it.
        let across =
            |out: f64, y: f64| PI * rack.module / 4.0 + out / alpha.cos() - y * alpha.tan();
        let deep = rack.dedendum - rho;
        let center = [across(amount - grinding_stock - rho, deep), deep];
        let kink = rack.dedendum - height;
        let begins = [across(-grinding_stock, kink), kink];
        // The line from there that touches the rounding.
        let passes_outside = |angle: f64| {
            (begins[0] - center[0]) * angle.cos() + (begins[1] - center[1]) * angle.sin() >= rho
        };
        let angle = bisect(0.0, alpha, passes_outside);
        Self {
            rack,
            center,
            begins,
            angle,
        }
    }

    /// Half the thickness of the hob's tooth, `y` below the reference line.
    fn half_width(&self, y: f64) -> f64 {
        let alpha = self.rack.pressure_angle;
        let from_kink = y - self.begins[1];
        let touches = self.center[1] + self.rack.tip_radius * self.angle.sin();
        if from_kink <= 0.0 {
            self.begins[0] - from_kink * alpha.tan()
        } else if y <= touches {
            self.begins[0] - from_kink * self.angle.tan()
        } else {
            let rho = self.rack.tip_radius;
            self.center[0] + (rho * rho - (y - self.center[1]).powi(2)).max(0.0).sqrt()
        }
    }

    /// The angle down to which the hob cuts at `radius`, from the centerline of the tooth: of all rollings that bring a point of its profile there.
    fn swept(&self, gear: &SpurGear, radius: f64) -> f64 {
        const STEPS: u32 = 4_000;
        let (r, shift) = (gear.reference_radius(), gear.generating_shift_length());
        // Across the teeth of a helical gear lengths along the rack are those of the normal section; along the section they are longer.
        let stretch = gear.data().rack.module / self.rack.module;
        let tip = self.rack.dedendum - shift;
        let space = gear.pitch_angle() / 2.0 + gear.data().thickness_of_flanks() / (2.0 * r);
        let widest = ((r - tip) / radius).min(1.0).acos();
        (0..=STEPS)
            .map(|i| {
                // The place on the circle of this radius, from the line to the pitch point.
                let psi = widest * (2.0 * f64::from(i) / f64::from(STEPS) - 1.0);
                let depth = r - radius * psi.cos();
                // How far the rack has come when its profile passes there; the gear has turned with it.
                let come = radius * psi.sin() + stretch * self.half_width(depth + shift);
                space + psi - come / r
            })
            .fold(f64::INFINITY, f64::min)
    }
}

/// Teeth of module 1 mm that are ground with 60 µm of stock after a hob with 110 µm of protuberance from 0.75 mm on.
fn ground(tooth_count: u32, profile_shift: f64) -> GearData {
    let mut data = paper_gear(tooth_count);
    data.rack = Rack {
        module: 1e-3,
        pressure_angle: 20_f64.to_radians(),
        addendum: 1e-3,
        dedendum: 1.4e-3,
        tip_radius: 0.3e-3,
        protuberance: Some(hob(110e-6, 0.75e-3, 60e-6)),
    };
    data.profile_shift = profile_shift;
    data.blank.bore_radius = 0.5e-3;
    data
}

fn hob(amount: f64, height: f64, grinding_stock: f64) -> Protuberance {
    Protuberance {
        amount,
        height,
        grinding_stock,
    }
}

/// Gears of all proportions by a fixed sequence of numbers, each with its helix.
fn drawn() -> Vec<(SpurGear, Rack, f64)> {
    let mut seed = 1_u64;
    let mut draw = |from: f64, to: f64| {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        from + (to - from) * ((seed >> 11) as f64 / (1_u64 << 53) as f64)
    };
    let gears = (0..120).filter_map(|i| {
        let mut data = ground(draw(6.0, 60.0) as u32, draw(-0.4, 1.0));
        let module = draw(0.5, 5.0) * 1e-3;
        let stock = draw(0.0, 0.06) * module;
        let amount = stock + draw(0.01, 0.15) * module;
        let mut rack = Rack {
            module,
            pressure_angle: draw(16.0, 26.0).to_radians(),
            addendum: module,
            dedendum: draw(1.15, 1.5) * module,
            tip_radius: draw(0.05, 0.45) * module,
            protuberance: None,
        };
        let least = rack.least_protuberance_height(amount);
        let height = least + draw(0.0, 0.9) * (rack.dedendum - least);
        rack.protuberance = Some(hob(amount, height, stock));
        data.rack = rack;
        data.thickness_deviation = draw(-0.1, 0.02) * module;
        let beta = if i % 3 == 0 {
            draw(5.0, 35.0).to_radians()
        } else {
            0.0
        };
        let gear = SolidGear::new(data, Helix::right(beta), 0.0, None).ok()?;
        Some((gear.section().clone(), rack, gear.base_helix_angle()))
    });
    gears.collect()
}

#[test]
fn the_root_is_what_the_hob_leaves_when_its_profile_is_swept() {
    let gears = drawn();
    let count = |is: fn(&SpurGear) -> bool| gears.iter().filter(|(gear, ..)| is(gear)).count();
    let by_the_straight_flank = count(|gear| gear.fillet().smooth_pieces().count() > 2);
    let undercut_without = count(|gear| gear.end_of_rack < 0.0);
    assert!(by_the_straight_flank > 20 && undercut_without > 10 && gears.len() > 80);
    for (gear, rack, base_helix_angle) in gears {
        let swept = |radius: f64| Hob::new(rack).swept(&gear, radius);
        let (form, root, tip) = (gear.form_radius(), gear.root_radius(), gear.tip_radius());
        // Places of the sweep stand up to a milliradian apart.
        let close = 5e-6 * rack.module;
        for i in 1..16 {
            let radius = root + (form - root) * f64::from(i) / 16.0;
            let point = gear.fillet().point(gear.fillet().gamma_at(radius));
            let off = radius * (swept(radius) - point.y.atan2(point.x));
            assert!(
                (-1e-2 * close..close).contains(&off),
                "{off:e} {:?}",
                gear.data()
            );
        }
        // Above it leaves at least the ground flank, which it cuts at the form radius, and at the tip all of the stock.
        for i in 1..8 {
            let radius = form + (tip - form) * f64::from(i) / 8.0;
            let left = radius * (swept(radius) - gear.flank().half_angle(radius));
            assert!(left > -1e-2 * close, "{left:e} {:?}", gear.data());
        }
        let reaches = |radius: f64| swept(radius) >= gear.flank().half_angle(radius);
        let cut = bisect(tip, root + 0.9 * (form - root), reaches);
        assert!((cut - form).abs() < 3e-5 * rack.module, "{cut} {form}");
        let stock = rack.protuberance.expect("a hob").grinding_stock;
        let left = swept(tip) - gear.flank().half_angle(tip);
        let expected = stock / base_helix_angle.cos() / gear.base_radius();
        assert!(tip * (left - expected).abs() < close, "{:?}", gear.data());
    }
}

#[test]
fn what_is_left_of_the_protuberance_moves_the_critical_section_as_iso_6336_3_has_it() {
    for (z, x) in [(25, 0.3), (40, 0.0), (31, -0.2), (60, 0.5)] {
        let gear = SpurGear::new(ground(z, x)).expect("can be made");
        let rack = gear.normal_rack();
        let (m, alpha) = (rack.module, rack.pressure_angle);
        let (h_f, rho) = (rack.dedendum / m, rack.tip_radius / m);
        let (s_pr, z) = (50e-6 / m, f64::from(z));
        // The tooth root chord at the 30 degree tangent, equations of method B.
        let e = PI / 4.0 - h_f * alpha.tan() + s_pr / alpha.cos()
            - (1.0 - alpha.sin()) * rho / alpha.cos();
        let g = rho - h_f + x;
        let h = 2.0 / z * (PI / 2.0 - e) - PI / 3.0;
        let mut theta = PI / 6.0;
        for _ in 0..100 {
            theta = 2.0 * g / z * theta.tan() - h;
        }
        let chord = z * (PI / 3.0 - theta).sin() + 3_f64.sqrt() * (g / theta.cos() - rho);

        let fillet = gear.fillet();
        let (from, to) = fillet.ends();
        let step = 1e-6;
        let way = |gamma: f64| fillet.point(gamma + step) - fillet.point(gamma - step);
        // Downward along the fillet the tangent turns away from the centerline.
        let steep = |gamma: f64| {
            let way: Vector = way(gamma);
            way.y.atan2(-way.x) < PI / 6.0
        };
        let gamma = bisect(from, to, steep);
        let found = 2.0 * fillet.point(gamma).y / m;
        assert!((found - chord).abs() < 1e-6, "{found} {chord}");
    }
}

#[test]
fn a_protuberance_of_the_grinding_stock_leaves_the_root_of_the_basic_rack() {
    // The rounding then touches the ground flank itself, as that of the rack does.
    for (z, x) in [(30, 0.2), (12, 0.0), (60, -0.3)] {
        let mut data = ground(z, x);
        let of = |protuberance, data: &mut GearData| {
            data.rack.protuberance = protuberance;
            SpurGear::new(data.clone()).expect("can be made")
        };
        let plain = of(None, &mut data);
        for same in [hob(60e-6, 0.75e-3, 60e-6), hob(0.0, 0.0, 0.0)] {
            let gear = of(Some(same), &mut data);
            assert_eq!(gear.fillet(), plain.fillet());
            assert_eq!(gear.form_roll_length(), plain.form_roll_length());
            assert_eq!(gear.is_undercut(), plain.is_undercut());
        }
        // A little more cuts off a little of the flank, and nothing of the root circle.
        let gear = of(Some(hob(60.001e-6, 0.75e-3, 60e-6)), &mut data);
        let more = gear.form_radius() - plain.form_radius();
        assert!(more > 0.0 && more < 0.03e-3, "{more:e}");
        let foot = |gear: &SpurGear| gear.fillet().point(gear.fillet().ends().1);
        assert!((foot(&gear) - foot(&plain)).norm() < 2e-9);
    }
}

#[test]
fn more_protuberance_ends_the_flank_farther_out_and_leaves_less_of_the_tooth() {
    let with = |amount: f64| {
        let mut data = ground(35, 0.1);
        data.rack.protuberance = Some(hob(amount, 0.75e-3, 60e-6));
        SpurGear::new(data).expect("can be made")
    };
    let gears = [60e-6, 70e-6, 90e-6, 120e-6, 160e-6].map(with);
    for pair in gears.windows(2) {
        assert!(pair[1].form_radius() > pair[0].form_radius());
        assert!(pair[1].mass() < pair[0].mass());
        assert_eq!(pair[1].root_radius(), pair[0].root_radius());
        assert!(pair[1].is_undercut());
    }
}

#[test]
fn a_hob_that_cannot_be_is_refused_and_the_named_value_cures_it() {
    let refused = |hob: Protuberance| {
        let mut data = ground(30, 0.0);
        data.rack.protuberance = Some(hob);
        SpurGear::new(data).expect_err("no such hob")
    };
    let fits = |hob: Protuberance| {
        let mut data = ground(30, 0.0);
        data.rack.protuberance = Some(hob);
        SpurGear::new(data).is_ok()
    };
    let GearError::ProtuberanceBelowStock { stock, .. } = refused(hob(50e-6, 0.75e-3, 60e-6))
    else {
        panic!("a step in the root")
    };
    assert!(fits(hob(stock, 0.75e-3, 60e-6)));
    // Upright: the rounding of 0.3 mm stands out by 0.11 mm at 20 degrees.
    let (sin, cos) = 20_f64.to_radians().sin_cos();
    let upright = 0.3e-3 * (1.0 + cos / sin) - (0.3e-3 - 110e-6) / sin;
    for (height, bound) in [(0.5e-3, upright), (1.5e-3, 1.4e-3)] {
        let GearError::ProtuberanceHeight { least, largest, .. } =
            refused(hob(110e-6, height, 60e-6))
        else {
            panic!("no place for a flank")
        };
        let nearest = if height < least { least } else { largest };
        assert!((nearest - bound).abs() < 1e-15);
        assert!(fits(hob(110e-6, nearest, 60e-6)));
    }
    // A small one comes out of the rounding where the circle does: 0.3 mm less 0.01 mm from its center.
    let GearError::ProtuberanceHeight { least, .. } = refused(hob(10e-6, 0.1e-3, 0.0)) else {
        panic!("within the rounding")
    };
    let across = (0.3e-3_f64.powi(2) - 0.29e-3_f64.powi(2)).sqrt();
    assert!((least - (0.3e-3 - 0.29e-3 * sin + across * cos)).abs() < 1e-15);
    assert!(fits(hob(10e-6, least, 0.0)));
    let GearError::ProtuberanceTooLarge { largest, .. } = refused(hob(0.5e-3, 1.4e-3, 60e-6))
    else {
        panic!("it would begin above the reference line")
    };
    assert!(fits(hob(largest, 1.4e-3, 60e-6)));
}

#[test]
fn far_below_its_flank_nothing_of_a_hobbed_gear_is_not_a_number() {
    // With 60 teeth the root circle lies outside of the base circle.
    for (z, x) in [(60, 0.0), (60, 0.9), (20, 0.0), (10, 0.0)] {
        let gear = SpurGear::new(ground(z, x)).expect("can be made");
        let lowest = gear.lowest_roll_length();
        assert!((0.0..gear.form_roll_length()).contains(&lowest));
        for part in [0.0, 0.01, 0.3, 0.7, 0.999] {
            let s = part * gear.form_roll_length();
            let (removed, inclination) = gear.removed_and_inclination(s);
            assert!(removed >= 0.0 && inclination.is_finite() && gear.removed_slope(s).is_finite());
        }
        // Just below the corner the flank has gone.
        assert!(gear.removed(0.999 * gear.form_roll_length()) > 0.0);
    }
}
