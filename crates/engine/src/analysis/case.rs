//! The request: a pair, torques and the way to compute.

use super::running::{RotationSpeed, Running};
use crate::assembly::{FaceContactsSpec, FaceResolution};
use crate::contact::ContactSolver;
use crate::gear::{GearPair, Member, SolidPair};
use crate::grid::GridLevel;
use crate::load_distribution::Formulas;

/// The method that turns a gear pair into curves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Both whole gears flexible: section 2 of the paper.
    Flexible,
    /// Rigid blanks plus fitted blank rotations: section 3 of the paper.
    Decomposition,
    /// The contact of round blanks plus the exact first-order term of the holes.
    ProjectedDecomposition,
    /// Closed-form compliances on the theoretical lines of contact: eqs. 4 and 5.
    LoadDistribution,
    /// Both whole gears flexible in three dimensions, contact along the faces.
    ThreeDimensional,
    /// The same for blanks that are rotationally symmetric, plus the first-order term of the holes.
    ThreeDimensionalProjected,
}

impl Method {
    /// True if it takes the gears along their faces into account, not only a section of them.
    pub fn sees_faces(self) -> bool {
        matches!(
            self,
            Self::ThreeDimensional | Self::ThreeDimensionalProjected
        )
    }

    /// True if it solves rotationally symmetric blanks and adds the first-order effect of holes.
    pub fn is_projected(self) -> bool {
        matches!(
            self,
            Self::ProjectedDecomposition | Self::ThreeDimensionalProjected
        )
    }

    /// True if it computes stresses at roots and holes.
    pub fn computes_stress(self) -> bool {
        matches!(self, Self::Flexible | Self::ThreeDimensional)
    }

    /// True if it sees that gears rotate, are warm and are pressed onto shafts.
    pub fn sees_running(self) -> bool {
        self != Self::LoadDistribution
    }

    /// True if it computes the best turn of the holes of both gears.
    pub fn finds_hole_phase(self) -> bool {
        self.sees_holes()
    }

    /// True if it takes the holes of the blanks into account.
    pub fn sees_holes(self) -> bool {
        self != Self::LoadDistribution
    }
}

/// Rule of the tangent stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StiffnessRule {
    /// Exactly, with the active contacts known.
    Tangent,
    /// By a central difference in the torque, as the paper does.
    TorqueStep {
        /// The step to either side over the torque.
        fraction: f64,
    },
}

/// Resolution of a case, and the rules by which it is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Positions in one mesh period.
    pub positions_per_mesh_period: u32,
    /// The first mesh position.
    pub first_position: f64,
    /// Mesh periods computed; `None` for the true period.
    pub span_mesh_periods: Option<u32>,
    /// The grid level.
    pub grid: GridLevel,
    /// The contact solver.
    pub contact_solver: ContactSolver,
    /// The rule for the tangent stiffness.
    pub stiffness: StiffnessRule,
    /// Positions over one hole period in the decomposition.
    pub blank_positions: u32,
    /// The interface radius R_w of each gear that has holes, in meters; `None` for its default.
    pub interface_radii: [Option<f64>; 2],
    /// Adds a second run at another grid level for the discretization error.
    pub error_estimate: bool,
}

/// A pair along its faces, and the resolution there.
#[derive(Debug, Clone, PartialEq)]
pub struct Faces {
    /// The pair, whose section is that of its case.
    pub pair: SolidPair,
    /// How finely its gears are resolved along their faces.
    pub resolution: FaceResolution,
    /// Slices into which the common face is cut.
    pub slices: usize,
    /// Keeps the load along the face at every position, not only its mean.
    pub at_each_position: bool,
    /// Searches the lead that would make the load even along the face.
    pub cure: bool,
}

/// Model of a pair.
#[derive(Debug, Clone, PartialEq)]
pub enum Model {
    /// Elastic gears in their transverse section.
    Section(SectionHoles),
    /// Elastic gears along their faces.
    Faces(Box<Faces>, FaceHoles),
    /// Formulas for the compliance of gears, on the theoretical lines of contact: eqs. 4 and 5. They have no holes.
    Formulas(Formulas),
}

/// Effect of holes on the contact of a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionHoles {
    /// All that they do: section 2 of the paper.
    Whole,
    /// First-order effect beside rotationally symmetric blanks.
    FirstOrder,
    /// How they let a rigid rim turn, fitted to a sinusoid: section 3 of the paper.
    Fitted,
}

/// Effect of holes on the contact along faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaceHoles {
    /// All that they do.
    Whole,
    /// First-order effect beside rotationally symmetric blanks.
    FirstOrder,
}

impl Model {
    /// The method that it is.
    pub fn method(&self) -> Method {
        match self {
            Self::Section(SectionHoles::Whole) => Method::Flexible,
            Self::Section(SectionHoles::FirstOrder) => Method::ProjectedDecomposition,
            Self::Section(SectionHoles::Fitted) => Method::Decomposition,
            Self::Faces(_, FaceHoles::Whole) => Method::ThreeDimensional,
            Self::Faces(_, FaceHoles::FirstOrder) => Method::ThreeDimensionalProjected,
            Self::Formulas(_) => Method::LoadDistribution,
        }
    }
}

impl Model {
    /// The same without the search for an even load.
    fn without_cure(&self) -> Self {
        match self {
            Self::Faces(faces, holes) => {
                let faces = Faces {
                    cure: false,
                    ..(**faces).clone()
                };
                Self::Faces(Box::new(faces), *holes)
            }
            Self::Section(_) | Self::Formulas(_) => self.clone(),
        }
    }
}

/// A place in a curve, and its contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct PositionInCurve {
    /// The mesh position.
    pub(super) position: f64,
    /// Which contact it is.
    pub(super) contact: usize,
    /// Offset in mesh periods.
    pub(super) later: i64,
}

impl Faces {
    /// Specification of the contacts of the pair as drawn.
    pub(super) fn drawn_contacts(&self) -> FaceContactsSpec {
        FaceContactsSpec {
            pair: self.pair.as_drawn(),
            resolution: self.resolution,
            slices: self.slices,
        }
    }

    /// The same at a grid `level`, of which the standard one has the counts that these are: orders, sections and slices go together.
    pub(super) fn at(&self, level: GridLevel) -> Self {
        Self {
            resolution: self.resolution.at(level),
            slices: match level {
                GridLevel::Coarse => self.slices.div_ceil(2),
                GridLevel::Standard => self.slices,
                GridLevel::Fine => 2 * self.slices,
            },
            ..self.clone()
        }
    }
}

/// A pair under load, and how to compute it.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// The pair: a plane one, or the transverse section of that of its faces ([`AnalysisError::SectionDiffers`](super::AnalysisError::SectionDiffers)).
    pub pair: GearPair,
    /// How it is modeled.
    pub model: Model,
    /// Output torques T on the driven gear, in newton meters; positive.
    pub output_torques: Vec<f64>,
    /// How to compute.
    pub resolution: Resolution,
    /// Where windows of the span begin, in whole mesh periods; empty: the span begins at the first position.
    pub windows: Vec<u32>,
    /// Computes the largest stresses at roots and holes.
    pub stress: bool,
    /// The speed of the driving gear, if frequencies are wanted.
    pub driving_speed: Option<RotationSpeed>,
    /// How the pair runs, where the method sees that ([`Method::sees_running`]).
    pub running: Option<Running>,
}

impl Case {
    /// A plane `pair` of elastic gears over the whole span, with the effect of holes by `holes`, under `output_torques` in newton meters. It is at rest, and
    /// without stresses.
    pub fn in_section(
        pair: GearPair,
        holes: SectionHoles,
        output_torques: Vec<f64>,
        resolution: Resolution,
    ) -> Self {
        Self {
            pair,
            model: Model::Section(holes),
            output_torques,
            resolution,
            windows: Vec::new(),
            stress: false,
            driving_speed: None,
            running: None,
        }
    }

    /// The same of a pair along its `faces`, whose transverse section is the plane pair of the case.
    pub fn along_faces(
        faces: Faces,
        holes: FaceHoles,
        output_torques: Vec<f64>,
        resolution: Resolution,
    ) -> Self {
        let section = faces.pair.section().clone();
        Self {
            model: Model::Faces(Box::new(faces), holes),
            ..Self::in_section(section, SectionHoles::Whole, output_torques, resolution)
        }
    }

    /// The method by which it is computed.
    pub fn method(&self) -> Method {
        self.model.method()
    }

    /// The pair along its faces, where these are seen.
    pub fn faces(&self) -> Option<&Faces> {
        match &self.model {
            Model::Faces(faces, _) => Some(faces),
            Model::Section(_) | Model::Formulas(_) => None,
        }
    }

    /// The output torques that are not 0. Without load nothing is elastic, and all methods have the same curve.
    pub(super) fn loaded_torques(&self) -> impl Iterator<Item = f64> {
        let torques = self.output_torques.iter().copied();
        torques.filter(|torque| *torque != 0.0)
    }

    /// The mesh periods that are computed.
    pub fn span(&self) -> u32 {
        self.resolution
            .span_mesh_periods
            .unwrap_or_else(|| self.pair.period())
    }

    /// True if the span is a whole multiple of the true period, so that a spectrum exists.
    pub fn covers_whole_periods(&self) -> bool {
        self.span().is_multiple_of(self.pair.period())
    }

    /// The same for the pair as drawn, for the part of the holes alone in their order of the spectrum; `None` where no teeth deviate, or there is no spectrum.
    /// The method is the same, and takes at most as long again. Along faces, where a contact takes longest, it is the first-order method.
    pub(super) fn holes_alone(&self) -> Option<Self> {
        let is_told = self.covers_whole_periods() && self.method().sees_holes();
        if !is_told || self.pair.is_as_drawn() || self.holed().is_empty() {
            return None;
        }
        Some(Self {
            pair: self.pair.as_drawn(),
            model: match &self.model {
                Model::Faces(faces, _) => {
                    let faces = Faces {
                        pair: faces.pair.as_drawn(),
                        cure: false,
                        ..(**faces).clone()
                    };
                    Model::Faces(Box::new(faces), FaceHoles::FirstOrder)
                }
                other => other.clone(),
            },
            resolution: Resolution {
                span_mesh_periods: None,
                error_estimate: false,
                ..self.resolution
            },
            windows: Vec::new(),
            stress: false,
            ..self.clone()
        })
    }

    /// How it runs, by a method that sees that.
    pub(super) fn runs(&self) -> Option<&Running> {
        let running = self.running.as_ref();
        running.filter(|_| self.method().sees_running())
    }

    /// The same at rest, as warm and on the same shafts, which a curve at speed is compared with; `None` at rest, and where that says nothing of its holes.
    pub(super) fn at_rest(&self) -> Option<Self> {
        let running = self.runs()?;
        if running.driving_speed.0 == 0.0 || self.holed().is_empty() || !self.covers_whole_periods()
        {
            return None;
        }
        Some(Self {
            running: Some(Running {
                driving_speed: RotationSpeed(0.0),
                ..*running
            }),
            model: self.model.without_cure(),
            resolution: Resolution {
                error_estimate: false,
                ..self.resolution
            },
            stress: false,
            ..self.clone()
        })
    }

    /// The positions of one curve, of one with windows those of each.
    pub fn positions(&self) -> usize {
        self.span() as usize * self.resolution.positions_per_mesh_period as usize
    }

    /// The mesh positions of one curve: the span in equal steps from the first, its end excluded.
    pub(super) fn mesh_positions(&self) -> Vec<f64> {
        let first = self.resolution.first_position;
        let steps = f64::from(self.resolution.positions_per_mesh_period);
        (0..self.positions())
            .map(|i| first + i as f64 / steps)
            .collect()
    }

    /// True if the flanks of all teeth of a gear are equal, so that contact on rotationally symmetric blanks repeats with every mesh period. A gear without
    /// holes grows evenly, and so does one with holes under heat alone.
    fn flanks_are_equal(&self) -> bool {
        let grow_equally = |running: &Running| self.holed().is_empty() || running.grows_evenly();
        self.pair.is_as_drawn() && self.runs().is_none_or(grow_equally)
    }

    /// True if teeth that deviate are solved on the slices of the drawn pair: along faces by the first-order method, at rest. Rotation and heat may move flanks
    /// by far more than teeth deviate.
    pub fn is_solved_as_drawn(&self) -> bool {
        self.method() == Method::ThreeDimensionalProjected
            && !self.pair.is_as_drawn()
            && self.runs().is_none()
    }

    /// The mesh positions after which contact on axisymmetric blanks repeats: those of one mesh period, or of the whole
    /// span where teeth deviate.
    pub(super) fn repeating_positions(&self) -> Vec<f64> {
        let mut positions = self.mesh_positions();
        if self.flanks_are_equal() {
            positions.truncate(self.resolution.positions_per_mesh_period as usize);
        }
        positions
    }

    /// The places in a curve at which the contacts at the mesh positions `at` stand, which repeat `after` that number of mesh periods: these positions, and as
    /// many mesh periods later as the span has.
    pub(super) fn places(&self, at: &[f64], after: u32) -> Vec<PositionInCurve> {
        let of_period = |later: i64| {
            let at = at.iter().enumerate();
            at.map(move |(contact, position)| PositionInCurve {
                position: position + later as f64,
                contact,
                later,
            })
        };
        let times = i64::from(self.span() / after);
        (0..times)
            .flat_map(|time| of_period(time * i64::from(after)))
            .collect()
    }

    /// The mesh periods after which contact on axisymmetric blanks repeats; the span where teeth deviate.
    pub(super) fn contacts_repeat_after(&self) -> u32 {
        if self.flanks_are_equal() {
            1
        } else {
            self.span()
        }
    }

    /// The mesh periods after which a curve repeats; the span where that is less.
    pub(super) fn curves_repeat_after(&self) -> u32 {
        if self.covers_whole_periods() {
            self.pair.period()
        } else {
            self.span()
        }
    }

    /// Values at the repeating positions, continued over the whole span.
    pub(super) fn repeated<T: Clone>(&self, period: impl Iterator<Item = T> + Clone) -> Vec<T> {
        period.cycle().take(self.positions()).collect()
    }

    /// The gears with holes.
    pub(super) fn holed(&self) -> Vec<Member> {
        Member::BOTH
            .into_iter()
            .filter(|&member| !self.pair.gear(member).holes().is_empty())
            .collect()
    }
}

#[cfg(test)]
pub(in crate::analysis) mod tests {
    use super::*;

    /// `pair` as `model` has it under one torque, on the coarse grid, with a given number of positions a mesh period.
    pub(in crate::analysis) fn plain(
        pair: GearPair,
        model: Model,
        output_torque: f64,
        positions_per_mesh_period: u32,
    ) -> Case {
        Case {
            pair,
            model,
            output_torques: vec![output_torque],
            resolution: Resolution {
                positions_per_mesh_period,
                first_position: 0.0,
                span_mesh_periods: None,
                grid: GridLevel::Coarse,
                contact_solver: ContactSolver::ActiveSet,
                stiffness: StiffnessRule::Tangent,
                blank_positions: 16,
                interface_radii: [None; 2],
                error_estimate: false,
            },
            windows: Vec::new(),
            stress: false,
            driving_speed: None,
            running: None,
        }
    }
}
