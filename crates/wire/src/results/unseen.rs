//! Effects that each method leaves out.

use meshwright_engine::analysis::at_speed::MountRequest;
use meshwright_engine::analysis::forces::ForcesRequest;
use meshwright_engine::analysis::{
    BodyFormula, Case, FaceHoles, Formulas, Model, SectionHoles, ToothFormula,
};
use meshwright_engine::gear::{SpurGear, TipEdge};

/// Effects that the method of `case` leaves out, and those that `forces` leave out beside the curves.
pub(super) fn does_not_see(case: &Case, forces: Option<&ForcesRequest>) -> Vec<&'static str> {
    const ALWAYS: [&str; 2] = [
        "friction between the flanks",
        "shafts, bearings and housing: both hubs are rigid and their axes fixed",
    ];
    const PLANE: [&str; 2] = [
        "anything that varies across the face width: misalignment, lead crowning, helix; the model is plane",
        "that a wide tooth cannot contract along its face: the transmission error is that of plane stress; contact pressures are those of plane strain, as a contact far narrower than its face has them",
    ];
    const ALONG_FACES: [&str; 2] = [
        "that a sharp tip edge has no limit to its yield: within a fiftieth of a module it is taken to be blunt",
        "how far shafts and bearings bend under the load: misalignment is what the submission says",
    ];
    const BEYOND_FIRST_ORDER: &str = "what the fluctuation of the holed blanks changes in the load sharing between pairs, beyond first order";
    const ON_DRAWN_SLICES: &str = "that teeth which deviate touch at other places of their flanks: gaps change on the slices of the drawn pair, whose springs are as stiff as under its own contact";
    let plane = case.faces().is_none().then_some(PLANE);
    let plane = plane.into_iter().flatten();
    let own: Vec<&str> = match &case.model {
        Model::Section(SectionHoles::Whole) => vec![],
        Model::Faces(_, FaceHoles::Whole) => ALONG_FACES.to_vec(),
        Model::Faces(_, FaceHoles::FirstOrder) => ALONG_FACES
            .into_iter()
            .chain([BEYOND_FIRST_ORDER])
            .chain(case.is_solved_as_drawn().then_some(ON_DRAWN_SLICES))
            .collect(),
        Model::Section(SectionHoles::Fitted) => vec![
            "sidebands of the holes about the mesh orders in the transmission error: each blank's rotation is fitted by its mean and one harmonic",
            "what the holes change in the load sharing between pairs",
        ],
        Model::Section(SectionHoles::FirstOrder) => vec![BEYOND_FIRST_ORDER],
        Model::Formulas(formulas) => formulas_do_not_see(*formulas),
    };
    let runs = forces.is_some_and(|forces| forces.dynamics.is_some());
    let inertia = if case.running.is_some() {
        "inertia and damping, but for the steady pull of rotation: the curves are quasi-static"
    } else if runs {
        "inertia and damping, but in the dynamics: the curves are quasi-static"
    } else {
        "inertia and damping: the analysis is quasi-static"
    };
    let [friction, shafts] = ALWAYS;
    [inertia, friction]
        .into_iter()
        .chain(plane)
        .chain([shafts])
        .chain(forces_do_not_see(forces))
        .chain(real_teeth_do_not_see(case))
        .chain(own)
        .chain(stress_not_computed(case))
        .chain(running_does_not_see(case))
        .collect()
}

/// What natural modes leave out.
pub(super) const MODES_DO_NOT_SEE: [&str; 3] = [
    "in the natural modes: shafts, bearings, housing, the mate and damping; each gear is by itself, and a gear of one piece with its shaft is held where the shaft begins",
    "in the natural modes: that spinning stiffens a gear, and the helix of its teeth, which are straight ones of the same transverse section there",
    "in the natural modes: that teeth couple motions of n nodal diameters with those of n - z, whose waves are shorter than two teeth",
];

/// Effects that a force table and a run-up leave out.
fn forces_do_not_see(forces: Option<&ForcesRequest>) -> Vec<&'static str> {
    let mut unseen = Vec::new();
    if forces.is_some() {
        unseen.push("the holes under the other flanks where they are, and slopes of single teeth on them: those flanks carry as the mirror image of the loaded ones");
    }
    if let Some(dynamics) = forces.and_then(|forces| forces.dynamics.as_ref()) {
        let is_mounted = dynamics.mounts != [MountRequest::default(); 2];
        unseen.push(if is_mounted {
            "in the dynamics, of shafts and supports their mass, the machines beyond them, gyroscopic moments and what displaced axes do to the contact"
        } else {
            "in the dynamics, shafts, bearings and housing"
        });
        if !dynamics.all_directions || dynamics.blank_modes == Some(0) {
            unseen.push("in the dynamics, vibrations of the gear bodies other than in torsion: with `modes` and without `blank_modes` 0 they are a part of it");
        } else {
            unseen.push("in the dynamics, that modes vary around a gear with holes: each is taken by its nodal diameters and its mean over a turn; and that spinning stiffens a gear");
            if is_mounted {
                unseen.push("in the dynamics, that the modes of the gear bodies push on the supports and are moved by them, beside the turn");
            }
        }
        unseen.push("in the dynamics, that the gears turn unevenly: the mesh position follows the mean speed; the damping is one number, in contact and out of it");
    }
    unseen
}

/// What is left out of gears that run.
fn running_does_not_see(case: &Case) -> Vec<&'static str> {
    if case.running.is_none() {
        return Vec::new();
    }
    let mut unseen = vec![
        "that tips which have moved outward reach farther: pairs come and go where the drawn tips do, and the growth of a flank is a line over its roll length",
        "heat that is uneven within a gear",
        "what speed and heat make of stiffness: a load acts on the drawn gears, their bores held; displacement fields are those of the load alone",
    ];
    if case.faces().is_some() {
        unseen.push("that the growth of a flank by its roll length varies along its face; whether rotation and fit break a rim; the shaft of a gear of one piece with it, which holds it as it turns; a shaft that is pressed in beyond the width of its hub");
    } else {
        unseen
            .push("rotation that a web or a hub out of the middle of its face turns into bending");
    }
    unseen
}

/// Why stresses that were asked for are not all there.
fn stress_not_computed(case: &Case) -> Option<&'static str> {
    case.stress.then_some(
        "stress under the contact itself, and concentrated where regions of unlike thickness meet: stress tells roots and hole edges",
    )
}

/// Effects left out of modified, broken and deviating teeth, as far as the gears of `case` have them.
fn real_teeth_do_not_see(case: &Case) -> Vec<&'static str> {
    let gears = [case.pair.driving(), case.pair.driven()];
    let any = |has: fn(&SpurGear) -> bool| gears.into_iter().any(has);
    let mut unseen = Vec::new();
    let one_sided = |gear: &SpurGear| {
        let slopes = [
            &gear.deviations().profile_slope,
            &gear.deviations().lead_slope,
        ];
        let traces = gear.deviations().profiles.is_some() || gear.deviations().leads.is_some();
        let slopes = slopes.iter().any(|list| !list.is_empty());
        !gear.data().modifications.is_empty() || slopes || traces
    };
    if any(one_sided) {
        unseen.push("the unloaded flanks: modifications, slopes and traces of single teeth are those of the loaded ones");
    }
    if any(|gear| !gear.deviations().are_teeth_equal()) {
        unseen.push("that a tooth which stands out is thicker, and stiffer, by what it stands out: every tooth yields as drawn");
    }
    if case.faces().is_none() && any(|gear| gear.data().blank.web.is_some()) {
        unseen.push("that force flows around the edges of a web: every region is in plane stress with its own thickness");
    }
    let by_formula = matches!(case.model, Model::Formulas(_));
    if by_formula && any(|gear| gear.data().blank.web.is_some()) {
        unseen.push("webs: the bodies are as thick as their faces are wide");
    }
    if any(|gear| gear.data().blank.shaft().is_some()) {
        unseen.push("how a shaft bends and twists beside the gear that is cut on it: its section under the gear, along faces those at both ends, is held in the mean");
    }
    if by_formula && any(|gear| gear.data().blank.shaft().is_some()) {
        unseen.push(
            "that a shaft in one piece with its gear gives way: the formulas take it for rigid",
        );
    }
    if by_formula && any(|gear| gear.data().tip_edge != TipEdge::Sharp) {
        unseen.push("contact on broken tip edges: a pair is taken to part where they begin");
    }
    if by_formula && any(|gear| gear.deviations().eccentricity.is_some()) {
        unseen.push("what an eccentricity changes in the lines of contact: it moves the flanks along them, and their ends stay");
    }
    if case.output_torques.contains(&0.0) {
        unseen.push(
            "at the torque 0, the deformation: the flanks are rigid, and the first of them touch",
        );
    }
    unseen
}

/// Effects that the load distribution by `formulas` leaves out.
fn formulas_do_not_see(formulas: Formulas) -> Vec<&'static str> {
    const ALWAYS: [&str; 4] = [
        "holes: the bodies are solid",
        "contact off the theoretical line of action, at tip corners, and on it the way of the contact along the flank under load or relief",
        "the body that neighboring pairs share: each pair carries a body compliance of its own",
        "its own error: formulas have no grid, so that an error_estimate has nothing to refine",
    ];
    const OF_PARTS: &str = "that a wider gear is loaded on a part of its width: its teeth and body yield as if loaded on all of it; the flanks touch on the common width";
    let own: &[&str] = match (formulas.tooth, formulas.body) {
        (ToothFormula::WeberBanaschek, BodyFormula::Sainsot) => &[
            OF_PARTS,
            "Poisson's ratio and the plane state in the bodies: the fit of Sainsot, Velex and Duverger has neither",
        ],
        (ToothFormula::WeberBanaschek, BodyFormula::HalfPlane) => {
            &[OF_PARTS, "bores: a body is a half plane without end"]
        }
        (ToothFormula::WeberBanaschek, BodyFormula::Rigid) => &[
            OF_PARTS,
            "the deformation of the bodies: they are rigid, as asked for",
        ],
        (ToothFormula::Iso6336, _) => &[
            "width beyond the common face width",
            "bores, fillets, and where on the flank a pair touches: one stiffness, that of the stiffest position, stands for all",
            "how a contact stiffens with its load: the stiffness is constant",
            "what measured stiffnesses fall short of the theory: C_M = 0.8 of ISO 6336-1 and its fall below 100 N/mm are left out",
        ],
    };
    ALWAYS.iter().chain(own).copied().collect()
}

#[cfg(test)]
mod tests {
    use meshwright_engine::analysis::PlaneState;

    use super::*;
    use crate::testing::{example, parse, submission, with};

    #[test]
    fn modifications_are_those_of_the_loaded_flanks_and_eccentricity_is_that_of_both() {
        let relief = serde_json::json!({ "amount_um": 5.0, "start": { "radial_length_mm": 1.75 } });
        let says = |relief: serde_json::Value| {
            let reliefs = [
                ("/pair/driving/tip_relief", relief.clone()),
                ("/pair/driven/tip_relief", relief),
            ];
            let submission = parse(&with(example("eccentricity"), &reliefs)).expect("valid");
            let unseen = does_not_see(submission.case(), None);
            unseen.iter().any(|what| what.contains("unloaded flanks"))
        };
        assert!(says(relief));
        assert!(!says(serde_json::Value::Null));
    }

    #[test]
    fn the_load_distribution_says_what_each_of_its_formulas_does_not_see() {
        let any = submission("test-case-2");
        let unseen = |tooth, body| {
            let mut case = any.case().clone();
            case.model = Model::Formulas(Formulas {
                tooth,
                body,
                plane_state: PlaneState::Stress,
            });
            does_not_see(&case, None).join("\n")
        };
        let (parts, whole) = (ToothFormula::WeberBanaschek, ToothFormula::Iso6336);
        for (tooth, body, word) in [
            (parts, BodyFormula::Sainsot, "Poisson's ratio"),
            (parts, BodyFormula::HalfPlane, "bores"),
            (parts, BodyFormula::Rigid, "they are rigid"),
            (whole, BodyFormula::Sainsot, "C_M"),
        ] {
            let listed = unseen(tooth, body);
            assert!(listed.contains(word), "{listed}");
            assert!(listed.contains("holes: the bodies are solid"));
        }
        assert!(!unseen(parts, BodyFormula::Sainsot).contains("C_M"));
        assert!(!unseen(whole, BodyFormula::Rigid).contains("they are rigid"));
    }
}
