//! Assembly of a curve from the results of a method at each position.

use super::Case;
use super::between::Sections;
use super::curve::{Curve, DecompositionParts, FaceLoad, LoadShare};
use super::found::{Between, Found};
use super::mesh_wave::MeshWave;
use super::pressures::CurvePressures;
use super::single_flank::SingleFlank;
use super::spectrum::Spectrum;
use super::stress::GearStresses;
use crate::contact::MeshContact;

/// Results of a method at each position of one torque.
pub(super) struct CurveParts {
    pub(super) transmission_error: Vec<f64>,
    pub(super) stiffness: Vec<f64>,
    /// δ and k between the positions.
    pub(super) sections: Sections,
    /// Torque on the driving gear over r_b1.
    pub(super) driving_load: Vec<f64>,
    pub(super) pairs_in_contact: Vec<u32>,
    pub(super) peak_contact_pressure: Vec<Option<f64>>,
    /// The largest pressure at further positions.
    pub(super) peak_pressures_between: Vec<(f64, Option<f64>)>,
    pub(super) pressures: CurvePressures,
    pub(super) load_shares: Vec<LoadShare>,
    pub(super) decomposition: Option<DecompositionParts>,
    pub(super) stresses: Option<[GearStresses; 2]>,
    pub(super) face: Option<FaceLoad>,
}

impl CurveParts {
    /// The curve of these parts at one torque of `case`.
    pub(super) fn into_curve(self, case: &Case, output_torque: f64) -> Curve {
        let load = case.pair.load(output_torque);
        let sections = &self.sections;
        let resampled = case
            .covers_whole_periods()
            .then(|| Spectrum::resampled(case, sections));
        let delta = resampled.as_ref().map(|[delta, _]| delta.as_slice());
        let single_flank = SingleFlank::of(sections, delta);
        let is_window = !case.windows.is_empty() && !case.covers_whole_periods();
        let found = (&*self.transmission_error, &*self.load_shares);
        let mesh_wave = is_window.then(|| MeshWave::of((case, load), sections, found));
        let spectrum = resampled.map(|resampled| Spectrum::of(case, resampled));
        let [
            transmission_error_statistics,
            mesh_stiffness_tangent_statistics,
        ] = sections.statistics();
        let mesh_position = case.mesh_positions();
        let further = self.peak_pressures_between.iter();
        let further: Vec<f64> = further.map(|(eta, _)| *eta).collect();
        let points = sections.points(&mesh_position, &further);
        Curve {
            output_torque,
            load,
            mesh_position,
            points,
            peak_pressures_between: self.peak_pressures_between,
            mesh_stiffness_secant: self
                .transmission_error
                .iter()
                .map(|delta| if load == 0.0 { 0.0 } else { load / delta })
                .collect(),
            driving_torque: self
                .driving_load
                .iter()
                .map(|load| load * case.pair.driving().base_radius())
                .collect(),
            transmission_error_statistics,
            mesh_stiffness_tangent_statistics,
            single_flank,
            sampling_error: sections.error(),
            transmission_error: self.transmission_error,
            mesh_stiffness_tangent: self.stiffness,
            pairs_in_contact: self.pairs_in_contact,
            peak_contact_pressure: self.peak_contact_pressure,
            pressures: self.pressures,
            load_shares: self.load_shares,
            spectrum,
            mesh_wave,
            decomposition: self.decomposition,
            stresses: self.stresses,
            face: self.face,
            running: None,
        }
    }
}

impl CurveParts {
    /// Parts of a curve from the results `found` under `load` at the first positions of `case`, after which it repeats, and `between` them; its curve is that
    /// of `sections`.
    pub(super) fn of<K>(
        (case, load): (&Case, f64),
        found: &Found<K>,
        between: &Between<K>,
        sections: Sections,
    ) -> Self {
        let contacts = &found.contacts;
        let mut positions = case.mesh_positions();
        positions.truncate(contacts.len());
        let further = between.positions.iter().zip(&between.contacts);
        let all = positions.iter().zip(contacts).chain(further);
        let all = all.map(|(eta, contact)| (*eta, contact));
        let solved = between.positions.iter().zip(&between.contacts);
        let solved = solved.map(|(eta, contact)| (*eta, contact.peak_pressure));
        let repeats_after = positions.len() as u32 / case.resolution.positions_per_mesh_period;
        let shares = load_shares(&positions, contacts).into_iter();
        let each = contacts.iter();
        Self {
            transmission_error: found.transmission_error.clone(),
            stiffness: found.stiffness.clone(),
            sections,
            driving_load: case.repeated(each.clone().map(|contact| contact.driving_load)),
            pairs_in_contact: case.repeated(each.clone().map(MeshContact::loaded_pairs)),
            peak_contact_pressure: case.repeated(each.map(|contact| contact.peak_pressure)),
            peak_pressures_between: solved.collect(),
            pressures: CurvePressures::of((case, load), all, repeats_after),
            load_shares: shares
                .map(|LoadShare { pair_offset, share }| LoadShare {
                    pair_offset,
                    share: case.repeated(share.iter().copied()),
                })
                .collect(),
            decomposition: None,
            stresses: None,
            face: None,
        }
    }
}

/// Shares of the load by pair offset n − floor(η), for the offsets that ever carry load.
fn load_shares(positions: &[f64], contacts: &[MeshContact]) -> Vec<LoadShare> {
    let mut shares: Vec<LoadShare> = Vec::new();
    for (i, (eta, contact)) in positions.iter().zip(contacts).enumerate() {
        for pair in contact.pairs.iter().filter(|pair| pair.share > 0.0) {
            let pair_offset = (pair.pair - eta.floor() as i64) as i32;
            let place = shares
                .iter()
                .position(|share| share.pair_offset == pair_offset)
                .unwrap_or_else(|| {
                    shares.push(LoadShare {
                        pair_offset,
                        share: vec![0.0; positions.len()],
                    });
                    shares.len() - 1
                });
            shares[place].share[i] = pair.share;
        }
    }
    shares.sort_by_key(|share| share.pair_offset);
    shares
}
