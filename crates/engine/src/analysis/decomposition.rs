//! The decomposition of the paper (section 3): rigid blanks over one mesh period, plus the rotation of each holed blank.

use std::f64::consts::PI;
use std::sync::Arc;

use super::between::Sample;
use super::case::Case;
use super::curve::{BlankFit, BlankSample, Curve, DecompositionParts};
use super::curve_parts::CurveParts;
use super::evidence::Evidence;
use super::pair_contacts::ModeledPair;
use super::plan::{Pass, Sweep, unlike_holes};
use super::setup::Setup;
use super::warning::{warn_of_tips, warnings};
use super::{Analysis, AnalysisError};
use crate::assembly::interface::interface_radius;
use crate::assembly::{Blanks, CutGear, PartError};
use crate::contact::positions::contacts_keeping;
use crate::contact::{MeshContact, PairModel};
use crate::fem::FemError;
use crate::gear::Member;
use crate::ring::annulus::{Annulus, Imposed};
use crate::ring::motion::InterfaceMotion;

/// One holed gear of the decomposition: the model in which its blank is flexible and the other holed one is not, and its blank by
/// itself.
struct HoledBlank<'a> {
    member: Member,
    /// Where its turn is sampled.
    positions: &'a [f64],
    model: &'a PairModel,
    cut: &'a CutGear,
    /// How the interface circle moves in the whole gear.
    motion: InterfaceMotion<'a>,
    annulus: Annulus,
    /// The pair with all holed blanks rigid.
    rigid: &'a ModeledPair<'a>,
    interface_radius: f64,
}

/// Eqs. 9 to 15: δ = δ_wh + Σ over holed gears of A + B cos(N θ + phase), fitted to samples of the holed blank's rotation.
pub(super) fn solve(setup: Setup<'_>, plan: &Pass) -> Result<Analysis, AnalysisError> {
    let case = setup.case;
    let rigid = ModeledPair::new(setup, Blanks::HoledRigid)?;
    // How a blank turns under its hub is fitted as drawn: what teeth deviate is in δ_wh.
    let drawn = Case {
        pair: case.pair.as_drawn(),
        ..case.clone()
    };
    let of_drawn = Setup {
        case: &drawn,
        ..setup
    };
    let apart = (drawn.pair != case.pair).then(|| ModeledPair::new(of_drawn, Blanks::HoledRigid));
    let apart = apart.transpose()?;
    let rigid_as_drawn = apart.as_ref().unwrap_or(&rigid);
    let mut degrees_of_freedom = rigid.degrees_of_freedom;
    let modeled = |(member, sweep): &(Member, Sweep)| {
        let spec = of_drawn.spec(sweep.blanks);
        let model = spec.model(setup.parts, setup.run)?;
        let cut = spec.cut(*member, setup.parts, setup.run)?;
        Ok::<_, AnalysisError>((model, cut))
    };
    let modeled: Vec<_> = plan.samples.iter().map(modeled).collect::<Result<_, _>>()?;
    let mut blanks = Vec::new();
    for ((member, sweep), ((model, unknowns), cut)) in plan.samples.iter().zip(&modeled) {
        degrees_of_freedom = degrees_of_freedom.max(*unknowns);
        let of_member = |error: FemError| PartError::from(error).of(*member);
        let motion = cut.motion(setup.run).map_err(of_member)?;
        let annulus = cut.annulus(Imposed::Whole).map_err(of_member)?;
        let Some((motion, annulus)) = motion.zip(annulus) else {
            continue;
        };
        let asked = case.resolution.interface_radii[member.index()];
        blanks.push(HoledBlank {
            member: *member,
            positions: &sweep.positions,
            model,
            cut,
            motion,
            annulus,
            rigid: rigid_as_drawn,
            interface_radius: interface_radius(case.pair.gear(*member), asked),
        });
    }
    let mut evidence = Evidence::new(degrees_of_freedom);
    let mut warnings = warnings(case);
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let (curve, contacts) = curve(&rigid, &blanks, &plan.told, output_torque, &mut evidence)?;
        evidence.gather(&contacts, curve.load);
        warn_of_tips(&mut warnings, &contacts);
        curves.push(curve);
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings,
    })
}

/// The curve at one torque, its stiffness by a central difference, and the contacts on rigid blanks behind it.
fn curve(
    rigid: &ModeledPair<'_>,
    blanks: &[HoledBlank<'_>],
    told: &Sweep,
    output_torque: f64,
    evidence: &mut Evidence,
) -> Result<(Curve, Arc<Vec<MeshContact>>), AnalysisError> {
    let case = rigid.setup.case;
    let load = case.pair.load(output_torque);
    let step = told.step.unwrap_or(0.0);
    let under = |load: f64| Terms::under(rigid, blanks, load);
    let (middle, below, above) = (
        under(load)?,
        under(load * (1.0 - step))?,
        under(load * (1.0 + step))?,
    );
    let found = |sweep: &Sweep| {
        let (contacts, delta) = middle.at(&sweep.positions)?;
        let stiffness = sweep.stiffness(load, Vec::new, |other| {
            let terms = if other < load { &below } else { &above };
            Ok(terms.at(&sweep.positions)?.1)
        })?;
        Ok::<_, AnalysisError>((contacts, delta, stiffness))
    };
    let samples = |sweep: &Sweep, contacts: &[MeshContact], delta: &[f64], k: &[f64]| {
        Sample::of(&case.places(&sweep.positions), contacts, delta, k)
    };
    let (contacts, transmission_error, stiffness) = found(told)?;
    let known = samples(told, &contacts, &transmission_error, &stiffness);
    let sections = told.sections(
        (case, case.contacts_repeat_after()),
        known,
        rigid.setup.run,
        |sweep| {
            let (contacts, delta, stiffness) = found(sweep)?;
            evidence.gather(&contacts, load);
            Ok(samples(sweep, &contacts, &delta, &stiffness))
        },
    )?;
    let of_rigid_blank = contacts.iter().map(|contact| contact.transmission_error);
    let parts = CurveParts {
        transmission_error,
        stiffness,
        decomposition: Some(DecompositionParts {
            rigid_blank_transmission_error: case.repeated(of_rigid_blank),
            blanks: middle.fits,
        }),
        ..CurveParts::of_repeating(case, &contacts, sections)
    };
    Ok((parts.into_curve(case, output_torque), contacts))
}

/// The terms of eq. 15 under one load.
struct Terms<'a> {
    rigid: &'a ModeledPair<'a>,
    load: f64,
    fits: Vec<BlankFit>,
}

impl<'a> Terms<'a> {
    fn under(
        rigid: &'a ModeledPair<'a>,
        blanks: &[HoledBlank<'_>],
        load: f64,
    ) -> Result<Self, AnalysisError> {
        let fits = blanks.iter().map(|blank| blank.fit(load));
        Ok(Self {
            rigid,
            load,
            fits: fits.collect::<Result<_, _>>()?,
        })
    }

    /// The contacts on rigid blanks at `positions`, and δ at the places in the curve that they tell of.
    fn at(&self, positions: &[f64]) -> Result<(Arc<Vec<MeshContact>>, Vec<f64>), AnalysisError> {
        let case = self.rigid.setup.case;
        let contacts = self.rigid.contacts(self.load, positions)?;
        let places = case.places(positions).into_iter();
        let delta = places.map(|place| {
            let fits = self.fits.iter().map(|fit| {
                let gear = case.pair.gear(fit.member);
                // Eq. (13) has 2πθ and N; with θ in radians, a period of 2π/N is cos(Nθ).
                let n = f64::from(gear.hole_repeats());
                fit.at(n * place.position * gear.pitch_angle())
            });
            contacts[place.contact].transmission_error + fits.sum::<f64>()
        });
        let delta = delta.collect();
        Ok((contacts, delta))
    }
}

impl HoledBlank<'_> {
    /// Samples R_b θ_gb, the rotation of the hub that the holed blank adds (eqs. 11, 12 and 14), over one hole period, and
    /// fits eq. 13 to it.
    ///
    /// The displacement of the interface circle in the whole solution, whose hub turns by δ_whole/R_b, less the rotation
    /// δ_wh/R_b that it has in wh, is imposed on the annulus, whose hub is free to turn and carries the moment of the flanks.
    /// As all of the displacement is imposed, the annulus is in the very state that it has in its gear, so that
    /// R_b θ_gb = δ_whole − δ_wh. (With its tangential part alone, and no traction in the radial direction, the annulus is
    /// softer than in its gear: docs/differences.md.)
    fn fit(&self, load: f64) -> Result<BlankFit, AnalysisError> {
        let Setup { case, run, .. } = self.rigid.setup;
        let gear = case.pair.gear(self.member);
        let positions = self.positions;
        let made = self.model.made(self.rigid.setup.deviations);
        let whole = contacts_keeping(made, load, positions, run, |cells, solution| {
            cells.flank_loads(self.member, &solution.forces)
        })?;
        let without = self.rigid.contacts(load, positions)?;
        let samples: Vec<BlankSample> = positions
            .iter()
            .zip(whole.iter().zip(without.iter()))
            .map(|(&mesh_position, ((whole, loads), without))| {
                let beyond = whole.transmission_error - without.transmission_error;
                let mut circle = self.motion.under(&self.cut.modal_loads(loads));
                self.annulus.turn(&mut circle, beyond / gear.base_radius());
                let torque = -self.cut.moment(loads);
                BlankSample {
                    mesh_position,
                    rotation: gear.base_radius() * self.annulus.hub_rotation(&circle, torque),
                }
            })
            .collect();
        let rotations: Vec<f64> = samples.iter().map(|sample| sample.rotation).collect();
        let harmonic = |k: u32| harmonic(&rotations, k);
        let (amplitude, phase) = harmonic(1);
        let higher = if unlike_holes(gear) > 1 {
            (2..(rotations.len() as u32).div_ceil(2))
                .map(harmonic)
                .collect()
        } else {
            Vec::new()
        };
        Ok(BlankFit {
            member: self.member,
            interface_radius: self.interface_radius,
            mean: rotations.iter().sum::<f64>() / rotations.len() as f64,
            amplitude,
            phase,
            higher,
            samples,
        })
    }
}

/// Amplitude and phase of the harmonic `k` ≥ 1 of evenly spaced `values` over one period.
fn harmonic(values: &[f64], k: u32) -> (f64, f64) {
    let count = values.len() as f64;
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (j, value) in values.iter().enumerate() {
        let (sin, cos) = (2.0 * PI * f64::from(k) * j as f64 / count).sin_cos();
        cosine += 2.0 * value * cos / count;
        sine += 2.0 * value * sin / count;
    }
    (cosine.hypot(sine), (-sine).atan2(cosine))
}
