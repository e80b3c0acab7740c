//! The thickness of the teeth, in the way in which a drawing says it.

use meshwright_engine::gear::{Helix, MeasuredTeeth, SpurGear, Thickness, ToolDepth};

use super::GearDocument;
use super::faults::Fault;
use super::field::Field;
use super::proportions::check_between;
use crate::declare::{document, number, words};
use crate::problem::Code;
use crate::units::{Side, from_mm, from_um, plain, to_mm, to_um};

document! {
    /// A span over several teeth, between parallel planes that touch flanks.
    pub struct SpanDocument as "SpanMeasurement", "Span measurement" {
        /// k: the number of teeth that it is measured over.
        pub(super) teeth: u32 = number("Number of teeth", "1", 1.0, 1_000.0),
        /// W_k: its length, in the normal section.
        pub(super) length_mm: f64 = number("Length", "mm", 0.05, 52_500.0),
    }
}

document! {
    /// A size over two balls that lie in opposite spaces, or in nearly opposite ones where the number of teeth is odd.
    pub struct BallsDocument as "BallMeasurement", "Ball measurement" {
        /// D_M: the diameter of a ball.
        pub(super) ball_diameter_mm: f64 = number("Diameter of a ball", "mm", 0.05, 200.0),
        /// M_dK: the size over both balls.
        pub(super) over_balls_mm: f64 = number("Size over balls", "mm", 0.3, 53_000.0),
    }
}

words! {
    /// How teeth became thinner than the rack leaves them at the profile shift.
    pub enum ThinnedBy {
        Hob = "hob":
            "a hob that stands deeper: x_E = x + A_sn/(2 m_n tan alpha_n), A_sn negative for thinner teeth. Root and form circle lie deeper with it",
        FlankGrinding = "flank_grinding":
            "a tool that stands at x_E = x, and grinding of the flanks alone; the fillets move with the flanks, the root circle stays",
    }
}

impl GearDocument {
    /// The fields that say the thickness, each in another way.
    pub const THICKNESS: [&str; 4] = [
        Self::tooth_thickness_deviation_um.name,
        Self::tooth_thickness_deviation_normal_um.name,
        Self::span_measurement.name,
        Self::ball_measurement.name,
    ];

    /// Has the tool that cut the root stand at the generating profile shift `x_e`, where nothing else is said of it than the thickness.
    pub fn keep_generating_profile_shift(&mut self, x_e: f64) {
        if self.tool_depth() == ToolDepth::ByThickness {
            self.generating_profile_shift = Some(x_e);
        }
    }

    /// Where the tool stands that cuts the root.
    pub(super) fn tool_depth(&self) -> ToolDepth {
        match (self.generating_profile_shift, self.thinned_by) {
            (Some(x_e), _) => ToolDepth::At(x_e),
            (None, ThinnedBy::Hob) => ToolDepth::ByThickness,
            (None, ThinnedBy::FlankGrinding) => ToolDepth::Nominal,
        }
    }

    /// The generating profile shift x_E; x where the thickness cannot be measured.
    pub fn tool_shift(&self, helix: Helix) -> f64 {
        match self.tool_depth() {
            ToolDepth::At(x_e) => x_e,
            ToolDepth::Nominal => self.profile_shift,
            ToolDepth::ByThickness => {
                let deviation = self.thickness_deviation(helix).unwrap_or(0.0);
                self.profile_shift + self.measured(helix).profile_shift_of(deviation)
            }
        }
    }

    /// The field that decides the generating profile shift of the tool, and its value for `x_e`; the root circle where its diameter is given, because it then
    /// stays while x_E changes.
    pub(super) fn depth_said(&self, x_e: f64, helix: Helix) -> (Field, Option<f64>) {
        let more = x_e - self.tool_shift(helix);
        if let Some(diameter) = self.root_diameter_mm {
            let wider = diameter + 2.0 * more * self.module_mm;
            return (self.root_field(), Some(wider));
        }
        let shift = || Field::of("", Self::profile_shift);
        match (self.tool_depth(), self.thickness()) {
            (ToolDepth::At(_), _) => {
                let field = Field::of("", Self::generating_profile_shift.given());
                (field, Some(x_e))
            }
            // A size that is measured fixes x_E, whatever the nominal shift.
            (ToolDepth::ByThickness, Thickness::Span { .. } | Thickness::Balls { .. }) => {
                let measured = self.measured(helix);
                let deviation = measured.deviation_of(x_e - self.profile_shift);
                let said = self.thickness_said(deviation, helix);
                (self.thickness_field(), said)
            }
            _ => (shift(), Some(self.profile_shift + more)),
        }
    }

    /// The thickness of the engine, in the way in which it is given.
    fn thickness(&self) -> Thickness {
        let Self {
            tooth_thickness_deviation_um: transverse,
            tooth_thickness_deviation_normal_um: normal,
            span_measurement: span,
            ball_measurement: balls,
            ..
        } = self;
        match (normal, span, balls) {
            (Some(deviation), ..) => Thickness::Normal(from_um(*deviation)),
            (_, Some(span), _) => Thickness::Span {
                teeth: span.teeth,
                length: from_mm(span.length_mm),
            },
            (.., Some(balls)) => Thickness::Balls {
                diameter: from_mm(balls.ball_diameter_mm),
                over: from_mm(balls.over_balls_mm),
            },
            _ => Thickness::Transverse(from_um(transverse.unwrap_or(0.0))),
        }
    }

    fn measured(&self, helix: Helix) -> MeasuredTeeth {
        MeasuredTeeth {
            tooth_count: self.tooth_count,
            module: from_mm(self.module_mm),
            pressure_angle: self.pressure_angle_deg.to_radians(),
            profile_shift: self.profile_shift,
            helix_angle: helix.angle,
        }
    }

    /// The deviation of the tooth thickness as a transverse arc on the reference circle, in meters; `None` where balls would stand in the base circle.
    pub(super) fn thickness_deviation(&self, helix: Helix) -> Option<f64> {
        self.thickness().deviation(&self.measured(helix))
    }

    /// The field that says the thickness.
    fn thickness_field(&self) -> Field {
        match self.thickness() {
            Thickness::Transverse(_) => Field::of("", Self::tooth_thickness_deviation_um.given()),
            Thickness::Normal(_) => {
                Field::of("", Self::tooth_thickness_deviation_normal_um.given())
            }
            Thickness::Span { .. } => Field::of("span_measurement/", SpanDocument::length_mm),
            Thickness::Balls { .. } => Field::of("ball_measurement/", BallsDocument::over_balls_mm),
        }
    }

    /// Value of that field for teeth that deviate by `deviation`, a transverse arc in meters.
    fn thickness_said(&self, deviation: f64, helix: Helix) -> Option<f64> {
        let said = self
            .thickness()
            .of_deviation(&self.measured(helix), deviation)?;
        Some(match said {
            Thickness::Transverse(deviation) | Thickness::Normal(deviation) => to_um(deviation),
            Thickness::Span { length, .. } => to_mm(length),
            Thickness::Balls { over, .. } => to_mm(over),
        })
    }

    /// The teeth are too thick or too thin, with the deviation beyond which they are not.
    pub(super) fn thickness_fault(
        &self,
        helix: Helix,
        code: Code,
        detail: String,
        (deviation, side): (f64, Side),
    ) -> Fault {
        let bound = self.thickness_said(deviation, helix);
        let bound = bound.map(|bound| (bound, side));
        Fault::new(self.thickness_field(), code, detail, bound)
    }

    pub(super) fn check_thickness(&self, helix: Helix) -> Result<(), Fault> {
        const SAID: &str = "half a module to either side";
        let half = 0.5 * from_mm(self.module_mm);
        let field = self.thickness_field();
        if let Thickness::Transverse(deviation) | Thickness::Normal(deviation) = self.thickness() {
            let most = to_um(half);
            return check_between(field, to_um(deviation), -most, most, SAID);
        }
        let Some(deviation) = self.thickness_deviation(helix) else {
            let detail = format!(
                "Balls of {} mm under a size of {} mm would stand in the base circle.",
                plain(
                    self.ball_measurement
                        .as_ref()
                        .map_or(0.0, |balls| balls.ball_diameter_mm)
                ),
                plain(
                    self.ball_measurement
                        .as_ref()
                        .map_or(0.0, |balls| balls.over_balls_mm)
                ),
            );
            let least = (-half, Side::AtLeast);
            return Err(self.thickness_fault(helix, Code::OutOfRange, detail, least));
        };
        if deviation.abs() <= half {
            return Ok(());
        }
        let as_cut = self.thickness_said(0.0, helix);
        let as_cut = as_cut.map_or(String::new(), |said| {
            format!(" Teeth as the rack cuts them have {} mm.", plain(said))
        });
        let detail = format!(
            "This measure makes the teeth {} um {} than the rack leaves them, a transverse arc, more than {SAID}.{as_cut}",
            plain(to_um(deviation.abs())),
            if deviation < 0.0 {
                "thinner"
            } else {
                "thicker"
            },
        );
        let bound = if deviation < 0.0 {
            (-half, Side::AtLeast)
        } else {
            (half, Side::AtMost)
        };
        Err(self.thickness_fault(helix, Code::OutOfRange, detail, bound))
    }

    /// Refuses a measure whose gauge touches no involute of `gear`.
    pub(super) fn check_gauge(&self, gear: &SpurGear, helix: Helix) -> Result<(), Fault> {
        let thickness = self.thickness();
        let touch = match thickness {
            Thickness::Transverse(_) | Thickness::Normal(_) => return Ok(()),
            measured => measured.touch(&self.measured(helix)),
        };
        let flank = [gear.form_roll_length(), gear.tip_form_roll_length()];
        if touch.is_some_and(|s| s >= flank[0] && s <= flank[1]) {
            return Ok(());
        }
        let (field, what) = match thickness {
            Thickness::Span { .. } => (
                Field::of("span_measurement/", SpanDocument::teeth),
                "The planes of the span touch",
            ),
            _ => (
                Field::of("ball_measurement/", BallsDocument::ball_diameter_mm),
                "The balls touch",
            ),
        };
        let diameter = |s: f64| plain(to_mm(2.0 * gear.flank().radius(s)));
        let detail = format!(
            "{what} the teeth at a diameter of {} mm; their flanks reach from {} mm to {} mm.",
            diameter(touch.unwrap_or(0.0)),
            diameter(flank[0]),
            diameter(flank[1])
        );
        Err(Fault::new(field, Code::OutOfRange, detail, None))
    }
}
