//! The decomposition of the paper (section 3): rigid blanks over one mesh period, plus the rotation of each holed blank.

use std::f64::consts::PI;
use std::sync::Arc;

use super::case::Case;
use super::curve::{BlankFit, BlankSample, DecompositionParts};
use super::curve_parts::CurveParts;
use super::found::Found;
use super::pair_contacts::ModeledPair;
use super::plan::{Pass, Sweep, unlike_holes};
use super::setup::Setup;
use super::under_load::curves;
use super::{Analysis, AnalysisError};
use crate::assembly::interface::interface_radius;
use crate::assembly::{Blanks, CutGear, PartError};
use crate::contact::positions::contacts_keeping;
use crate::contact::{MeshContact, PairModel};
use crate::fem::FemError;
use crate::gear::{Member, PairDeviations};
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
pub(super) fn solve(setup: Setup<'_>, pass: &Pass) -> Result<Analysis, AnalysisError> {
    let case = setup.case;
    let rigid = ModeledPair::new(setup, Blanks::HoledRigid)?;
    // The turn of a blank under its hub is fitted as drawn: deviations of the teeth are in δ_wh.
    let drawn = Case {
        pair: case.pair.as_drawn(),
        ..case.clone()
    };
    let as_drawn = PairDeviations::NONE;
    let of_drawn = Setup {
        case: &drawn,
        deviations: &as_drawn,
        ..setup
    };
    let deviates = !setup.deviations.are_none();
    let apart = deviates.then(|| ModeledPair::new(of_drawn, Blanks::HoledRigid));
    let apart = apart.transpose()?;
    let rigid_as_drawn = apart.as_ref().unwrap_or(&rigid);
    let mut degrees_of_freedom = rigid.degrees_of_freedom;
    let modeled = |(member, sweep): &(Member, Sweep)| {
        let spec = of_drawn.spec(sweep.blanks);
        let model = spec.model(setup.parts, setup.run)?;
        let cut = spec.cut(*member, setup.parts, setup.run)?;
        Ok::<_, AnalysisError>((model, cut))
    };
    let modeled: Vec<_> = pass.samples.iter().map(modeled).collect::<Result<_, _>>()?;
    let mut blanks = Vec::new();
    for ((member, sweep), ((model, unknowns), cut)) in pass.samples.iter().zip(&modeled) {
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
    curves((case, pass), degrees_of_freedom, setup.run, |under| {
        let load = under.load;
        let step = pass.curve.step.unwrap_or(0.0);
        let terms = |load: f64| Terms::under(&rigid, &blanks, load);
        let (middle, below, above) = (
            terms(load)?,
            terms(load * (1.0 - step))?,
            terms(load * (1.0 + step))?,
        );
        let find = |sweep: &Sweep| {
            let (contacts, transmission_error) = middle.at(sweep)?;
            let stiffness = sweep.stiffness_by_step(load, |other| {
                let terms = if other < load { &below } else { &above };
                Ok(terms.at(sweep)?.1)
            })?;
            Ok(Found::<()> {
                contacts: contacts.to_vec(),
                transmission_error,
                stiffness: stiffness.unwrap_or_default(),
                kept: Vec::new(),
            })
        };
        let found = find(&pass.curve)?;
        let (parts, _) = under.parts(&found, &[], |sweep, _| find(sweep))?;
        under.fitted_but_for(middle.remainder());
        let of_rigid = found.contacts.iter();
        let of_rigid = of_rigid.map(|contact| contact.transmission_error);
        Ok(CurveParts {
            decomposition: Some(DecompositionParts {
                rigid_blank_transmission_error: case.repeated(of_rigid),
                blanks: middle.fits,
            }),
            ..parts
        })
    })
}

/// The terms of eq. 15 under one load.
struct Terms<'a> {
    rigid: &'a ModeledPair<'a>,
    load: f64,
    fits: Vec<BlankFit>,
}

impl<'a> Terms<'a> {
    /// Error of δ at the samples of the holed blanks: the remainder of the fits.
    fn remainder(&self) -> f64 {
        let pair = &self.rigid.setup.case.pair;
        let each = self.fits.iter();
        each.map(|fit| fit.remainder(pair.gear(fit.member))).sum()
    }

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

    /// The contacts on rigid blanks at the positions of `sweep`, and δ at all places in the curve at which they stand.
    fn at(&self, sweep: &Sweep) -> Result<(Arc<Vec<MeshContact>>, Vec<f64>), AnalysisError> {
        let case = self.rigid.setup.case;
        let contacts = self.rigid.contacts(self.load, &sweep.positions)?;
        let places = sweep.places(case).into_iter();
        let delta = places.map(|place| {
            let fits = self.fits.iter().map(|fit| {
                let gear = case.pair.gear(fit.member);
                fit.at_position(gear, place.position)
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
        let made = self.model.deviating(self.rigid.setup.deviations);
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
