//! One thing varied at a time: tooth count, hole count, positions, torques.

use anyhow::Context;
use meshwright_engine::analysis::{Case, SectionHoles, pair_model};
use meshwright_engine::gear::{BlankRegion, GearData, GearPair, HolePattern, SpurGear};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

use super::stopwatch::{answer, cold, least};
use crate::reproduce::cases::{at_torques, by, example, with_holes};

/// The varied quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Varied {
    /// The teeth of both gears.
    ToothCount,
    /// The holes of the driven gear.
    HoleCount,
    /// Positions in a mesh period.
    PositionsPerMeshPeriod,
    /// Output torques in one submission.
    TorqueCount,
}

/// How the time of a job grows with one number of its submission.
#[derive(Debug)]
pub(super) struct Growth {
    pub(super) varied: Varied,
    pub(super) series: Vec<TimeSeries>,
}

/// Times over the number that varies.
#[derive(Debug)]
pub(super) struct TimeSeries {
    pub(super) name: &'static str,
    pub(super) counts: Vec<u32>,
    pub(super) seconds: Vec<f64>,
}

impl TimeSeries {
    /// A series of no points yet.
    pub(super) fn new(name: &'static str) -> Self {
        Self {
            name,
            counts: Vec::new(),
            seconds: Vec::new(),
        }
    }

    fn push(&mut self, count: u32, seconds: f64) {
        self.counts.push(count);
        self.seconds.push(seconds);
    }

    fn over(
        name: &'static str,
        counts: &[u32],
        seconds: impl Fn(u32) -> anyhow::Result<f64>,
    ) -> anyhow::Result<Self> {
        let mut series = Self::new(name);
        for &count in counts {
            series.push(count, seconds(count)?);
        }
        Ok(series)
    }
}

impl Growth {
    /// The name of its figure's file.
    pub(super) fn file(&self) -> String {
        let what = match self.varied {
            Varied::ToothCount => "tooth-count",
            Varied::HoleCount => "hole-count",
            Varied::PositionsPerMeshPeriod => "positions",
            Varied::TorqueCount => "torques",
        };
        format!("growth-{what}.svg")
    }
}

const TOOTH_COUNTS: [u32; 9] = [20, 30, 40, 50, 70, 100, 150, 200, 300];
const HOLE_COUNTS: [u32; 12] = [0, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24];
const POSITIONS: [u32; 6] = [10, 20, 40, 100, 200, 400];
const TORQUES: [u32; 6] = [1, 2, 5, 10, 15, 20];

/// Mesh periods computed where the true period would change with the varied quantity: that of test case 2.
const SPAN: u32 = 5;

/// Test case 2 by these methods, where positions or torques vary.
const METHODS: [(SectionHoles, &str); 3] = [
    (SectionHoles::Whole, "flexible"),
    (SectionHoles::Fitted, "decomposition"),
    (SectionHoles::FirstOrder, "projected"),
];

/// Measures them all, and reports each to `progress`.
///
/// # Errors
///
/// If a case cannot be made or computed.
pub(super) fn measured(progress: &dyn Fn(&str)) -> anyhow::Result<Vec<Growth>> {
    progress("Tooth counts.");
    let mut growths = vec![over_teeth()?];
    progress("Hole counts.");
    growths.push(over_holes()?);
    progress("Positions and torques.");
    let case_2 = example("test-case-2")?;
    growths.push(over(
        Varied::PositionsPerMeshPeriod,
        &POSITIONS,
        |method, count| {
            let mut case = by(&case_2, method);
            case.resolution.positions_per_mesh_period = count;
            case
        },
    )?);
    growths.push(over(Varied::TorqueCount, &TORQUES, |method, count| {
        // Torques down to a third of that of the test case.
        let torques = (0..count).map(|i| 115.0 * (1.0 - f64::from(i) / 30.0));
        at_torques(&by(&case_2, method), torques.collect())
    })?);
    Ok(growths)
}

fn over(
    varied: Varied,
    counts: &[u32],
    case: impl Fn(SectionHoles, u32) -> Case,
) -> anyhow::Result<Growth> {
    let series = METHODS
        .into_iter()
        .map(|(method, name)| TimeSeries::over(name, counts, |count| cold(&case(method, count))));
    Ok(Growth {
        varied,
        series: series.collect::<anyhow::Result<_>>()?,
    })
}

fn over_teeth() -> anyhow::Result<Growth> {
    let mut gears = TimeSeries::new("both gears");
    let mut positions = TimeSeries::new("200 positions");
    let mut whole = TimeSeries::new("whole job, flexible");
    for count in TOOTH_COUNTS {
        let case = of_teeth(count)?;
        let (_, (of_gears, of_positions)) = least(|| Ok(()), |()| stages(&case))?;
        gears.push(count, of_gears);
        positions.push(count, of_positions);
        whole.push(count, of_gears + of_positions);
    }
    Ok(Growth {
        varied: Varied::ToothCount,
        series: vec![whole, gears, positions],
    })
}

/// The seconds that the gears of `case` take from nothing, and those of its positions.
fn stages(case: &Case) -> anyhow::Result<(f64, f64)> {
    let library = Library::default();
    let started = std::time::Instant::now();
    pair_model(case, &library, &Run::unattended()).context("the gears cannot be modeled")?;
    let gears = started.elapsed().as_secs_f64();
    answer(case, &library)?;
    Ok((gears, started.elapsed().as_secs_f64() - gears))
}

/// Test case 2 with `count` teeth on both gears: the teeth as they are, bore and holes scaled with the room for them.
fn of_teeth(count: u32) -> anyhow::Result<Case> {
    let mut case = example("test-case-2")?;
    let data = case.pair.driving().data().clone();
    let (z, module) = (f64::from(count), data.rack.module);
    // The teeth stand as far apart as those of the test case; the interface circle is one module below the roots.
    let center_distance = z * module + 0.5e-3;
    let interface = 0.5 * z * module - data.rack.dedendum - module;
    let bore_radius = 0.16 * z * module;
    let room = interface - bore_radius;
    let of = |holes| {
        SpurGear::new(GearData {
            tooth_count: count,
            blank: match holes {
                Some(pattern) => BlankRegion::with_pattern(bore_radius, pattern),
                None => BlankRegion::solid(bore_radius),
            },
            ..data.clone()
        })
    };
    let holes = HolePattern {
        count: 10,
        circle_radius: bore_radius + 0.5 * room,
        radius: 0.25 * room,
        phase: 0.0,
    };
    case.pair = GearPair::new(of(None)?, of(Some(holes))?, center_distance)?;
    case.resolution.span_mesh_periods = Some(SPAN);
    Ok(case)
}

fn over_holes() -> anyhow::Result<Growth> {
    let case_2 = example("test-case-2")?;
    let of = |count, span, method| -> anyhow::Result<f64> {
        let mut case = with_holes(&by(&case_2, method), holes(count))?;
        case.resolution.span_mesh_periods = span;
        cold(&case)
    };
    let series = [
        ("flexible, true period", None, SectionHoles::Whole),
        ("flexible, 5 mesh periods", Some(SPAN), SectionHoles::Whole),
        ("projected, true period", None, SectionHoles::FirstOrder),
    ];
    let series = series.into_iter().map(|(name, span, method)| {
        TimeSeries::over(name, &HOLE_COUNTS, |count| of(count, span, method))
    });
    Ok(Growth {
        varied: Varied::HoleCount,
        series: series.collect::<anyhow::Result<_>>()?,
    })
}

/// `count` holes on the circle of test case 2, as large as there while there is room between them.
fn holes(count: u32) -> Option<HolePattern> {
    const CIRCLE: f64 = 34e-3;
    (count > 0).then(|| HolePattern {
        count,
        circle_radius: CIRCLE,
        radius: (0.72 * std::f64::consts::PI * CIRCLE / f64::from(count)).min(7.5e-3),
        phase: 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_that_is_measured_can_be_made_and_test_case_2_is_one_of_them() {
        for count in TOOTH_COUNTS {
            assert_eq!(of_teeth(count).expect("meshes").positions(), 200);
        }
        let case_2 = example("test-case-2").expect("ships");
        for count in HOLE_COUNTS {
            let case = with_holes(&case_2, holes(count)).expect("fits");
            assert_eq!(count == 10, case == case_2);
        }
    }
}
