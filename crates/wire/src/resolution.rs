//! How finely and by which rules a submission is computed.

use meshwright_engine::analysis::{
    BodyFormula, ContactSolver, Formulas, Method, PlaneState, Resolution, StiffnessRule,
    ToothFormula,
};
use meshwright_engine::grid::GridLevel;
use serde::Serializer;
use serde::ser::SerializeMap;
use serde_json::{Value, json};

use super::declare::{
    Choice, EACH, Kind, Location, Named, Node, Object, ObjectReader, absent, document, flag, list,
    nested, number, word, words,
};
use super::interface::InterfaceRadii;
use super::problem::Code;
use super::units::from_um;

/// The most windows of a submission.
pub const MOST_WINDOWS: usize = 64;

/// The words of the methods.
pub fn methods() -> impl Iterator<Item = &'static str> {
    Method::OPTIONS.iter().map(|(word, ..)| *word)
}

/// True if the method of this name takes the faces into account.
pub fn sees_faces(name: &Node) -> bool {
    let mut methods = Method::OPTIONS.iter();
    methods.any(|(word, method, _)| {
        matches!(name, Node::Text(name) if name == word) && method.sees_faces()
    })
}

words! {
    Method {
        Flexible = "flexible": "both whole gears flexible, the reference (section 2 of the paper)",
        Decomposition = "decomposition":
            "rigid blanks plus fitted blank rotations (section 3 of the paper)",
        ProjectedDecomposition = "projected_decomposition":
            "the contact of blanks that are alike all around, plus the exact first-order term of what the holes change around them",
        ThreeDimensional = "three_dimensional":
            "both whole gears flexible along their faces too: helical gears, thin webs, uneven leads, misalignment",
        ThreeDimensionalProjected = "three_dimensional_projected":
            "along their faces, the contact of blanks that are alike all around, plus the first-order term of what the holes change around them; teeth that deviate are solved on the slices of the drawn pair",
        LoadDistribution = "load_distribution":
            "closed-form compliances on the theoretical lines of contact (eqs. 4 and 5); does not see holes",
    }

    GridLevel {
        Coarse = "coarse": "half as fine as standard, for first looks",
        Standard = "standard": "the level at which the published accuracy holds",
        Fine = "fine": "twice as fine as standard",
    }

    ToothFormula {
        WeberBanaschek = "weber_banaschek": "bending, shear and compression of the true profile",
        Iso6336 = "iso_6336":
            "the theoretical single stiffness of ISO 6336-1 (method B) with its factors for rack and material, without its empirical ones (C_M, low line loads); contains body and local deformation",
    }

    BodyFormula {
        Sainsot = "sainsot": "Sainsot, Velex and Duverger",
        HalfPlane = "half_plane": "the half plane of Weber and Banaschek",
        Rigid = "rigid": "no body compliance",
    }

    PlaneState {
        Stress = "stress": "no stress across the face width",
        Strain = "strain": "no strain across the face width",
    }
}

document! {
    /// How finely and by which rules the pair is computed. Every field has a default.
    pub struct ResolutionDocument as "Resolution", "Resolution" {
        /// The number of positions at which one mesh period is told. Statistics and spectrum are those of the curve between them too: the contact is
        /// solved further where a pair takes up or leaves the load and where an extreme stands.
        pub(super) positions_per_mesh_period: u32 =
            number("Positions in a mesh period", "1", 8.0, 2000.0).or(40.0),
        /// How many mesh periods are computed. A span shorter than the true period gives curves and statistics marked as partial and no
        /// spectrum; a longer one has to be a whole multiple of it.
        pub(super) span_mesh_periods: Option<u32> = absent(
            number("Mesh periods", "1", 1.0, 200_000.0),
            "the true period of the pair, which is filled in",
        ),
        /// Where windows begin, in whole mesh periods from the start of the true period: each runs over span_mesh_periods, which are fewer than the true period
        /// has, and no two overlap. Lists have one window behind the other, statistics are those of all. The orders of the mesh are estimated: what single
        /// teeth make of them in the windows is replaced by what they make over the true period. Other orders are not told.
        pub(super) window_starts: Option<Vec<u32>> = absent(
            list("Windows", number("Window start", "1", 0.0, 10_000_000.0), MOST_WINDOWS)
                .not_empty(Code::WrongLength, "give the mesh period in which a window begins")
                .unique("repeats a window"),
            "one span, from the start of the true period",
        )
        .left_out(),
        /// How fine the finite elements are; each level halves every element. Differences from fine, on the paper's cases: coarse within
        /// 0.2 % of the mean STE, 2 % of peak-to-peak and rms, 0.3 % of the mean stiffness and 4 % of the first three mesh harmonics;
        /// standard within 0.03, 0.5, 0.1 and 1 %. error_estimate tells it for your pair. In three dimensions coarse has half as many
        /// slices and elements and two orders less across the face than face_slices and face_order say, fine twice as many and two more.
        grid: GridLevel = word("Grid").or(GridLevel::Standard),
        /// The degree of the polynomials across the face by which three dimensions resolve teeth and rim: 8 within half a percent of
        /// oblique loads, 6 for first looks within one.
        pub(super) face_order: u32 = number("Order across the face", "1", 4.0, 12.0).or(8.0),
        /// The number of slices into which three dimensions cut the common face, and of strips in which they tell the load along it.
        pub(super) face_slices: u32 = number("Slices of the face", "1", 10.0, 200.0).or(40.0),
        /// The number of positions over one hole period at which the decomposition samples a holed blank.
        blank_positions: u32 = number("Positions in a hole period", "1", 8.0, 64.0).or(16.0),
        /// The radius between holes and tooth roots at which the decomposition cuts the blank: one for both gears, or one for each.
        pub(super) interface_radius_mm: InterfaceRadii = (),
        /// The solver of the contact conditions: the exact active set, or the augmented Lagrangian of the paper (eq. 7). They agree to
        /// the gap tolerance.
        pub(super) contact_solver: ContactSolverDocument = (),
        /// How the tangent stiffness is obtained: exactly, with the active contacts known, or by a central difference in the torque as
        /// the paper does.
        stiffness: StiffnessDocument = (),
        /// The formulas of the method load_distribution.
        load_distribution: LoadDistributionDocument = nested("LoadDistribution").or_defaults(),
        /// Also computes a second run for the discretization error: a finer one, which takes several times as long, or in three dimensions a coarser one, which
        /// differs by more than a finer one would.
        error_estimate: bool = flag("Error estimate", false),
    }
}

/// The solver of the contact conditions.
#[derive(Debug, Clone, PartialEq)]
pub enum ContactSolverDocument {
    /// The exact active set.
    ActiveSet,
    /// The augmented Lagrangian of the paper.
    AugmentedLagrangian(AugmentedLagrangian),
}

document! {
    /// The solver of the paper, eq. 7.
    pub struct LagrangianChoice as "AugmentedLagrangian", "Augmented Lagrangian" {
        /// Its penalty and its tolerance.
        augmented_lagrangian: AugmentedLagrangian = nested(""),
    }
}

document! {
    /// Its penalty and its tolerance.
    pub struct AugmentedLagrangian
    as "AugmentedLagrangianSettings", "Settings of the augmented Lagrangian" {
        /// The penalty stiffness of a contact cell, eq. 7 of the paper. It changes the number of iterations, not the result.
        penalty_n_per_m: Option<f64> = absent(
            number("Penalty stiffness", "N/m", 1e5, 1e18),
            "100 times Young's modulus of the softer gear times the common face width",
        )
        .left_out(),
        /// The penetration that the augmented Lagrangian leaves. The paper's value is 0.01.
        gap_tolerance_um: f64 = number("Gap tolerance", "um", 1e-9, 1.0).or(1e-6),
    }
}

/// How the tangent stiffness is obtained.
#[derive(Debug, Clone, PartialEq)]
pub enum StiffnessDocument {
    /// Exactly, with the active contacts known.
    Tangent,
    /// By a central difference.
    TorqueStep(TorqueStep),
}

document! {
    /// A central difference in the torque.
    pub struct TorqueStep as "TorqueStep", "Torque step" {
        /// The step to either side of the torque in the central difference.
        torque_step_percent: f64 = number("Torque step", "%", 0.01, 10.0),
    }
}

document! {
    /// The formulas of the method load_distribution.
    pub struct LoadDistributionDocument as "LoadDistribution", "Load distribution" {
        /// The compliance of a tooth.
        tooth: ToothFormula = word("Tooth compliance").or(ToothFormula::WeberBanaschek),
        /// The compliance of the gear body.
        body: BodyFormula = word("Body compliance").or(BodyFormula::Sainsot),
        /// The plane state of tooth, half plane and local deformation.
        plane_state: PlaneState = word("Plane state").or(PlaneState::Stress),
    }
}

impl ResolutionDocument {
    /// The same for the engine.
    pub(super) fn data(&self) -> Resolution {
        Resolution {
            positions_per_mesh_period: self.positions_per_mesh_period,
            first_position: f64::from(self.windows().first().copied().unwrap_or(0)),
            span_mesh_periods: self.span_mesh_periods,
            grid: self.grid,
            contact_solver: match &self.contact_solver {
                ContactSolverDocument::ActiveSet => ContactSolver::ActiveSet,
                ContactSolverDocument::AugmentedLagrangian(settings) => {
                    ContactSolver::AugmentedLagrangian {
                        penalty: settings.penalty_n_per_m,
                        gap_tolerance: from_um(settings.gap_tolerance_um),
                    }
                }
            },
            stiffness: match &self.stiffness {
                StiffnessDocument::Tangent => StiffnessRule::Tangent,
                StiffnessDocument::TorqueStep(step) => StiffnessRule::TorqueStep {
                    fraction: step.torque_step_percent / 100.0,
                },
            },
            blank_positions: self.blank_positions,
            interface_radii: self.interface_radius_mm.data(),
            error_estimate: self.error_estimate,
        }
    }

    /// Where windows begin; empty without.
    pub(super) fn windows(&self) -> &[u32] {
        self.window_starts.as_deref().unwrap_or_default()
    }

    /// The formulas of the load distribution.
    pub(super) fn formulas(&self) -> Formulas {
        Formulas {
            tooth: self.load_distribution.tooth,
            body: self.load_distribution.body,
            plane_state: self.load_distribution.plane_state,
        }
    }

    /// The stiffness rule, as the evidence words it.
    pub(super) fn stiffness_in_words(&self) -> String {
        match &self.stiffness {
            StiffnessDocument::Tangent => {
                "tangent: dF/d delta, exact with the active contacts known".to_owned()
            }
            StiffnessDocument::TorqueStep(step) => format!(
                "torque step: central difference with {} % of the torque to either side",
                step.torque_step_percent
            ),
        }
    }
}

impl Kind for ContactSolverDocument {
    type Spec = ();

    fn read(node: &Node, place: &Location<'_>, _: &()) -> Option<Self> {
        const EXPECTED: &str = "\"active_set\" or {\"augmented_lagrangian\": {\"penalty_n_per_m\": ..., \"gap_tolerance_um\": ...}}";
        let usual = Node::Object(Vec::new());
        match node {
            Node::Text(word) if word == "active_set" => Some(Self::ActiveSet),
            Node::Text(word) if word == "augmented_lagrangian" => {
                let settings = AugmentedLagrangian::read(&usual, place, &EACH);
                settings.map(Self::AugmentedLagrangian)
            }
            Node::Object(_) => {
                let mut reader = ObjectReader::new(node, place.clone())?;
                if reader.present("augmented_lagrangian").is_none() {
                    let detail = format!("{place} has to be {EXPECTED}.");
                    place.wrong::<()>(Code::MissingField, detail, None);
                    reader.finish();
                    return None;
                }
                let choice = LagrangianChoice::read_whole(reader)?;
                Some(Self::AugmentedLagrangian(choice.augmented_lagrangian))
            }
            _ => place.wrong_kind(node, EXPECTED),
        }
    }

    fn usual(_: &()) -> Option<Self> {
        Some(Self::ActiveSet)
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::ActiveSet => serializer.serialize_str("active_set"),
            Self::AugmentedLagrangian(settings) => {
                let mut map = serializer.serialize_map(Some(1))?;
                map.serialize_entry("augmented_lagrangian", settings)?;
                map.end()
            }
        }
    }

    fn describe(_: &str, _: &()) -> Value {
        json!({ "$ref": "#/components/schemas/ContactSolver" })
    }

    fn name_parts(named: &mut Named) {
        let schema = json!({
            "title": "Contact solver",
            "description": ResolutionDocument::contact_solver.about.trim_start(),
            "default": "active_set",
            "oneOf": [
                { "type": "string", "title": "Active set", "description": "Exact.", "enum": ["active_set"] },
                LagrangianChoice::describe("", &EACH),
            ],
        });
        named.push(("ContactSolver", schema));
        LagrangianChoice::name_parts(named);
    }
}

impl Kind for StiffnessDocument {
    type Spec = ();

    fn read(node: &Node, place: &Location<'_>, _: &()) -> Option<Self> {
        match node {
            Node::Text(word) if word == "tangent" => Some(Self::Tangent),
            Node::Object(_) => TorqueStep::read(node, place, &EACH).map(Self::TorqueStep),
            _ => place.wrong_kind(node, "\"tangent\" or {\"torque_step_percent\": 1.0}"),
        }
    }

    fn usual(_: &()) -> Option<Self> {
        Some(Self::Tangent)
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Tangent => serializer.serialize_str("tangent"),
            Self::TorqueStep(step) => step.write(serializer),
        }
    }

    fn describe(_: &str, _: &()) -> Value {
        json!({ "$ref": "#/components/schemas/StiffnessRule" })
    }

    fn name_parts(named: &mut Named) {
        let schema = json!({
            "title": "Stiffness rule",
            "description": ResolutionDocument::stiffness.about.trim_start(),
            "default": "tangent",
            "oneOf": [
                { "type": "string", "title": "Tangent", "description": "Exact.", "enum": ["tangent"] },
                TorqueStep::json_schema(),
            ],
        });
        named.push(("StiffnessRule", schema));
    }
}
