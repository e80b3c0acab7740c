//! How finely and by which rules a submission is computed.

use meshwright_engine::analysis::{
    BodyFormula, ContactSolver, Formulas, Method, PlaneState, Resolution, StiffnessRule,
    ToothFormula,
};
use meshwright_engine::grid::GridLevel;
use serde::Serialize;
use serde_json::json;

use super::interface::{self, InterfaceRadii};
use super::problem::{Code, FieldError};
use super::quantity;
use super::schema::{self, documented};
use super::tree::{Choice, Node, ObjectReader, OptionalObject, as_word};
use super::units::from_um;

impl Choice for Method {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        (
            "flexible",
            Self::Flexible,
            "both whole gears flexible, the reference (section 2 of the paper)",
        ),
        (
            "decomposition",
            Self::Decomposition,
            "rigid blanks plus fitted blank rotations (section 3 of the paper)",
        ),
        (
            "projected_decomposition",
            Self::ProjectedDecomposition,
            "the contact of blanks that are alike all around, plus the exact first-order term of what the holes change around them",
        ),
        (
            "load_distribution",
            Self::LoadDistribution,
            "closed-form compliances on the theoretical lines of contact (eqs. 4 and 5); does not see holes",
        ),
    ];
}

impl Choice for GridLevel {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        (
            "coarse",
            Self::Coarse,
            "half as fine as standard, for first looks",
        ),
        (
            "standard",
            Self::Standard,
            "the level at which the published accuracy holds",
        ),
        ("fine", Self::Fine, "twice as fine as standard"),
    ];
}

impl Choice for ToothFormula {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        (
            "weber_banaschek",
            Self::WeberBanaschek,
            "bending, shear and compression of the true profile",
        ),
        (
            "iso_6336",
            Self::Iso6336,
            "the theoretical single stiffness of ISO 6336-1 (method B) with its factors for rack and material, without its empirical ones (C_M, low line loads); contains body and local deformation",
        ),
    ];
}

impl Choice for BodyFormula {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        ("sainsot", Self::Sainsot, "Sainsot, Velex and Duverger"),
        (
            "half_plane",
            Self::HalfPlane,
            "the half plane of Weber and Banaschek",
        ),
        ("rigid", Self::Rigid, "no body compliance"),
    ];
}

impl Choice for PlaneState {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        ("stress", Self::Stress, "no stress across the face width"),
        ("strain", Self::Strain, "no strain across the face width"),
    ];
}

/// How a submission is computed, in the reader's units, with every default filled in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResolutionDocument {
    pub(super) positions_per_mesh_period: u32,
    pub(super) span_mesh_periods: Option<u32>,
    #[serde(serialize_with = "as_word")]
    grid: GridLevel,
    blank_positions: u32,
    pub(super) interface_radius_mm: InterfaceRadii,
    contact_solver: ContactSolverDocument,
    stiffness: StiffnessDocument,
    load_distribution: LoadDistributionDocument,
    error_estimate: bool,
}

documented!(
    ResolutionDocument,
    "Resolution",
    [
        interface::EachRadius,
        ContactSolverDocument,
        StiffnessDocument,
        LoadDistributionDocument
    ],
    schema::object(
        "Resolution",
        "How finely and by which rules the pair is computed. Every field has a default.",
        vec![
            schema::number(&quantity::POSITIONS),
            schema::number(&quantity::SPAN),
            schema::choice(
                "grid",
                "Grid",
                "How fine the finite elements are; each level halves every element. Differences from fine, on the paper's cases: coarse within 0.2 % of the mean STE, 2 % of peak-to-peak and rms, 0.3 % of the mean stiffness and 4 % of the first three mesh harmonics; standard within 0.03, 0.5, 0.1 and 1 %. error_estimate tells it for your pair.",
                Some(GridLevel::Standard)
            ),
            schema::number(&quantity::BLANK_POSITIONS),
            interface::property(),
            schema::document::<ContactSolverDocument>("contact_solver", false),
            schema::document::<StiffnessDocument>("stiffness", false),
            schema::document::<LoadDistributionDocument>("load_distribution", false),
            schema::flag(
                "error_estimate",
                "Error estimate",
                "Whether a second, finer run tells the discretization error. It takes several times as long.",
                false
            ),
        ]
    )
);

/// The solver of the contact conditions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactSolverDocument {
    /// The exact active set.
    ActiveSet,
    /// The augmented Lagrangian of the paper.
    AugmentedLagrangian {
        /// The penalty stiffness; absent where it follows from the gears.
        #[serde(skip_serializing_if = "Option::is_none")]
        penalty_n_per_m: Option<f64>,
        /// The gap tolerance.
        gap_tolerance_um: f64,
    },
}

documented!(
    ContactSolverDocument,
    "ContactSolver",
    [AugmentedLagrangianSchema, AugmentedLagrangianSettingsSchema],
    schema::one_of(
        "Contact solver",
        "The solver of the contact conditions: the exact active set, or the augmented Lagrangian of the paper (eq. 7). They agree to the gap tolerance.",
        Some(json!("active_set")),
        vec![
            schema::word("Active set", "Exact.", "active_set"),
            schema::reference::<AugmentedLagrangianSchema>(),
        ]
    )
);

/// Names the choice of the augmented Lagrangian in the contract, so that generators of clients need not.
enum AugmentedLagrangianSchema {}

documented!(
    AugmentedLagrangianSchema,
    "AugmentedLagrangian",
    [],
    schema::object(
        "Augmented Lagrangian",
        "The solver of the paper, eq. 7.",
        vec![(
            "augmented_lagrangian",
            schema::reference::<AugmentedLagrangianSettingsSchema>(),
            true
        )]
    )
);

/// Names its settings.
enum AugmentedLagrangianSettingsSchema {}

documented!(
    AugmentedLagrangianSettingsSchema,
    "AugmentedLagrangianSettings",
    [],
    schema::object(
        "Settings of the augmented Lagrangian",
        "Its penalty and its tolerance.",
        vec![
            schema::number(&quantity::PENALTY),
            schema::number(&quantity::GAP_TOLERANCE)
        ]
    )
);

/// How the tangent stiffness is obtained.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StiffnessDocument {
    /// Exactly, with the active contacts known.
    Tangent,
    /// By a central difference.
    #[serde(untagged)]
    TorqueStep {
        /// The step to either side.
        torque_step_percent: f64,
    },
}

documented!(
    StiffnessDocument,
    "StiffnessRule",
    [],
    schema::one_of(
        "Stiffness rule",
        "How the tangent stiffness is obtained: exactly, with the active contacts known, or by a central difference in the torque as the paper does.",
        Some(json!("tangent")),
        vec![
            schema::word("Tangent", "Exact.", "tangent"),
            schema::object(
                "Torque step",
                "A central difference in the torque.",
                vec![schema::number(&quantity::TORQUE_STEP)]
            ),
        ]
    )
);

/// The formulas of the load distribution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LoadDistributionDocument {
    #[serde(serialize_with = "as_word")]
    tooth: ToothFormula,
    #[serde(serialize_with = "as_word")]
    body: BodyFormula,
    #[serde(serialize_with = "as_word")]
    plane_state: PlaneState,
}

documented!(
    LoadDistributionDocument,
    "LoadDistribution",
    [],
    schema::object(
        "Load distribution",
        "The formulas of the method load_distribution.",
        vec![
            schema::choice(
                "tooth",
                "Tooth compliance",
                "The compliance of a tooth.",
                Some(ToothFormula::WeberBanaschek)
            ),
            schema::choice(
                "body",
                "Body compliance",
                "The compliance of the gear body.",
                Some(BodyFormula::Sainsot)
            ),
            schema::choice(
                "plane_state",
                "Plane state",
                "The plane state of tooth, half plane and local deformation.",
                Some(PlaneState::Stress)
            ),
        ]
    )
);

impl ResolutionDocument {
    /// Reads the resolution, or takes every default where it is absent.
    pub(super) fn read(resolution: OptionalObject<'_>) -> Option<Self> {
        let mut reader = match resolution {
            OptionalObject::Absent => return Some(Self::USUAL),
            OptionalObject::Wrong => return None,
            OptionalObject::Present(reader) => reader,
        };
        let positions_per_mesh_period = reader.count(&quantity::POSITIONS);
        let span_mesh_periods = reader.optional_number(&quantity::SPAN);
        let grid = reader.choice("grid", Some(Self::USUAL.grid));
        let blank_positions = reader.count(&quantity::BLANK_POSITIONS);
        let interface_radius_mm = InterfaceRadii::read(&mut reader);
        let contact_solver = match reader.get("contact_solver") {
            None => Some(Self::USUAL.contact_solver),
            Some(node) => ContactSolverDocument::read(node, &reader),
        };
        let stiffness = match reader.get("stiffness") {
            None => Some(Self::USUAL.stiffness),
            Some(node) => StiffnessDocument::read(node, &reader),
        };
        let load_distribution = match reader.optional_object("load_distribution") {
            OptionalObject::Absent => Some(Self::USUAL.load_distribution),
            OptionalObject::Wrong => None,
            OptionalObject::Present(formulas) => LoadDistributionDocument::read(formulas),
        };
        let error_estimate = reader.flag("error_estimate", false);
        reader.finish();
        Some(Self {
            positions_per_mesh_period: positions_per_mesh_period?,
            span_mesh_periods: span_mesh_periods?.map(|span| span as u32),
            grid: grid?,
            blank_positions: blank_positions?,
            interface_radius_mm: interface_radius_mm?,
            contact_solver: contact_solver?,
            stiffness: stiffness?,
            load_distribution: load_distribution?,
            error_estimate: error_estimate?,
        })
    }

    const USUAL: Self = Self {
        positions_per_mesh_period: 40,
        span_mesh_periods: None,
        grid: GridLevel::Standard,
        blank_positions: 16,
        interface_radius_mm: InterfaceRadii::Common(None),
        contact_solver: ContactSolverDocument::ActiveSet,
        stiffness: StiffnessDocument::Tangent,
        load_distribution: LoadDistributionDocument {
            tooth: ToothFormula::WeberBanaschek,
            body: BodyFormula::Sainsot,
            plane_state: PlaneState::Stress,
        },
        error_estimate: false,
    };

    /// What the engine is told.
    pub(super) fn data(&self) -> Resolution {
        Resolution {
            positions_per_mesh_period: self.positions_per_mesh_period,
            span_mesh_periods: self.span_mesh_periods,
            grid: self.grid,
            contact_solver: match self.contact_solver {
                ContactSolverDocument::ActiveSet => ContactSolver::ActiveSet,
                ContactSolverDocument::AugmentedLagrangian {
                    penalty_n_per_m,
                    gap_tolerance_um,
                } => ContactSolver::AugmentedLagrangian {
                    penalty: penalty_n_per_m,
                    gap_tolerance: from_um(gap_tolerance_um),
                },
            },
            stiffness: match self.stiffness {
                StiffnessDocument::Tangent => StiffnessRule::Tangent,
                StiffnessDocument::TorqueStep {
                    torque_step_percent,
                } => StiffnessRule::TorqueStep {
                    fraction: torque_step_percent / 100.0,
                },
            },
            blank_positions: self.blank_positions,
            interface_radii: self.interface_radius_mm.data(),
            formulas: Formulas {
                tooth: self.load_distribution.tooth,
                body: self.load_distribution.body,
                plane_state: self.load_distribution.plane_state,
            },
            error_estimate: self.error_estimate,
        }
    }

    /// The stiffness rule, as the evidence words it.
    pub(super) fn stiffness_in_words(&self) -> String {
        match self.stiffness {
            StiffnessDocument::Tangent => {
                "tangent: dF/d delta, exact with the active contacts known".to_owned()
            }
            StiffnessDocument::TorqueStep {
                torque_step_percent,
            } => {
                format!(
                    "torque step: central difference with {torque_step_percent} % of the torque to either side"
                )
            }
        }
    }
}

impl ContactSolverDocument {
    fn read(node: &Node, parent: &ObjectReader<'_>) -> Option<Self> {
        const EXPECTED: &str = "\"active_set\" or {\"augmented_lagrangian\": {\"penalty_n_per_m\": ..., \"gap_tolerance_um\": ...}}";
        let pointer = parent.pointer_to("contact_solver");
        match node {
            Node::Text(word) if word == "active_set" => return Some(Self::ActiveSet),
            Node::Text(word) if word == "augmented_lagrangian" => {
                return Some(Self::AugmentedLagrangian {
                    penalty_n_per_m: None,
                    gap_tolerance_um: preset(&quantity::GAP_TOLERANCE),
                });
            }
            Node::Object(_) => {}
            _ => {
                parent.wrong_kind("contact_solver", node, EXPECTED);
                return None;
            }
        }
        let mut reader = parent.object(node, pointer.clone())?;
        let solver =
            match reader.optional_object("augmented_lagrangian") {
                OptionalObject::Absent => {
                    let detail = format!("{pointer} has to be {EXPECTED}.");
                    reader.report(FieldError::new(pointer, Code::MissingField, detail));
                    None
                }
                OptionalObject::Wrong => None,
                OptionalObject::Present(mut inner) => {
                    let penalty_n_per_m = inner.optional_number(&quantity::PENALTY);
                    let gap_tolerance_um = inner.number(&quantity::GAP_TOLERANCE, None);
                    inner.finish();
                    penalty_n_per_m.zip(gap_tolerance_um).map(
                        |(penalty_n_per_m, gap_tolerance_um)| Self::AugmentedLagrangian {
                            penalty_n_per_m,
                            gap_tolerance_um,
                        },
                    )
                }
            };
        reader.finish();
        solver
    }
}

fn preset(quantity: &quantity::Quantity) -> f64 {
    match quantity.preset {
        quantity::Preset::Value(value) => value,
        _ => quantity.bounds.0,
    }
}

impl StiffnessDocument {
    fn read(node: &Node, parent: &ObjectReader<'_>) -> Option<Self> {
        match node {
            Node::Text(word) if word == "tangent" => Some(Self::Tangent),
            Node::Object(_) => {
                let mut reader = parent.object(node, parent.pointer_to("stiffness"))?;
                let step = reader.number(&quantity::TORQUE_STEP, None);
                reader.finish();
                step.map(|torque_step_percent| Self::TorqueStep {
                    torque_step_percent,
                })
            }
            _ => {
                parent.wrong_kind(
                    "stiffness",
                    node,
                    "\"tangent\" or {\"torque_step_percent\": 1.0}",
                );
                None
            }
        }
    }
}

impl LoadDistributionDocument {
    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let usual = ResolutionDocument::USUAL.load_distribution;
        let tooth = reader.choice("tooth", Some(usual.tooth));
        let body = reader.choice("body", Some(usual.body));
        let plane_state = reader.choice("plane_state", Some(usual.plane_state));
        reader.finish();
        Some(Self {
            tooth: tooth?,
            body: body?,
            plane_state: plane_state?,
        })
    }
}
