//! The load distribution over a mesh period: the pairs on the theoretical line of contact share the load (eqs. 4 and 5).
//!
//! Each pair yields on its own, δ = C F + h(F) + e with the compliance C of its teeth and bodies, Hertz's approach h and the
//! reliefs e, so that H of eq. 4 is diagonal. The loads that a common δ needs are found pair by pair, and δ by their sum.

use super::elastic_constants::ElasticConstants;
use super::half_plane::{self, FoundationForm};
use super::hertz::{ContactBody, LineContact};
use super::iso6336::{IsoGear, IsoPair};
use super::sainsot::GearBody;
use super::tooth_load::{InvoluteTooth, ToothLoad};
use super::weber_banaschek;
use crate::analysis::case::{BodyFormula, Case, Formulas, ToothFormula};
use crate::analysis::curve::{Evidence, LoadShare, Warning};
use crate::analysis::decomposition::{one_mesh_period, repeated};
use crate::analysis::{Analysis, AnalysisError, CurveParts, mesh_positions, warnings};
use crate::gear::{GearPair, Member, SpurGear};
use crate::run::Run;

/// Bisections of a load or of δ: an f64 has no more digits.
const BISECTIONS: u32 = 200;

/// Points of the tabulated profile on the flank and on the fillet.
const PROFILE_POINTS: u32 = 200;

/// Computes `case` by the load distribution.
pub(in crate::analysis) fn distribute(case: &Case, run: &Run) -> Result<Analysis, AnalysisError> {
    let compliances = Compliances::new(&case.pair, case.resolution.formulas)?;
    let mut warnings = warnings(case);
    for member in Member::BOTH {
        if compliances.extrapolates(member) {
            warnings.push(Warning::FormulaRange { member });
        }
    }
    let positions = one_mesh_period(case);
    let pairs = positions
        .iter()
        .map(|&eta| compliances.pairs_at(eta))
        .collect::<Result<Vec<_>, _>>()?;
    let mut evidence = Evidence::new(0);
    let mut curves = Vec::with_capacity(case.output_torques.len());
    for &output_torque in &case.output_torques {
        let load = case.pair.load(output_torque);
        let mut contacts = Vec::with_capacity(positions.len());
        for (&eta, pairs) in positions.iter().zip(&pairs) {
            let contact = share(pairs, load, eta)?;
            evidence.equilibrium_residual = evidence.equilibrium_residual.max(contact.residual);
            contacts.push(contact);
            run.reached(1)?;
        }
        let all = |value: fn(&Shared) -> f64| repeated(case, contacts.iter().map(value));
        let parts = CurveParts {
            transmission_error: all(|contact| contact.transmission_error),
            stiffness: all(|contact| contact.stiffness),
            peak_contact_pressure: repeated(
                case,
                contacts.iter().map(|contact| Some(contact.peak_pressure)),
            ),
            pairs_in_contact: repeated(
                case,
                contacts
                    .iter()
                    .map(|contact| contact.loads.iter().filter(|load| load.1 > 0.0).count() as u32),
            ),
            load_shares: load_shares(case, &contacts, load),
            decomposition: None,
        };
        curves.push(parts.into_curve(case, output_torque, mesh_positions(case)));
    }
    Ok(Analysis {
        curves,
        evidence,
        warnings,
    })
}

/// A tooth pair on the line of contact.
struct LinePair {
    /// n − floor(η).
    offset: i32,
    /// C of both teeth and bodies, in m/N.
    compliance: f64,
    /// The reliefs of both flanks, in m.
    gap: f64,
    contact: LineContact,
    /// Whether h(F) is already in the compliance.
    local_included: bool,
}

impl LinePair {
    /// C F + h(F).
    fn deflection(&self, force: f64) -> Result<f64, AnalysisError> {
        let local = if self.local_included {
            0.0
        } else {
            self.contact.approach(force).map_err(no_formula)?
        };
        Ok(self.compliance * force + local)
    }

    /// dδ/dF.
    fn tangent(&self, force: f64) -> Result<f64, AnalysisError> {
        let local = if self.local_included {
            0.0
        } else {
            self.contact.tangent_compliance(force).map_err(no_formula)?
        };
        Ok(self.compliance + local)
    }

    /// The force, at most `most`, that deflects the pair by `deflection`.
    fn force(&self, deflection: f64, most: f64) -> Result<f64, AnalysisError> {
        if deflection <= 0.0 {
            return Ok(0.0);
        }
        bisect(0.0, most, |force| Ok(self.deflection(force)? < deflection))
    }
}

/// What the pairs at one position do under a load.
struct Shared {
    transmission_error: f64,
    stiffness: f64,
    peak_pressure: f64,
    /// Offset and force of each pair.
    loads: Vec<(i32, f64)>,
    residual: f64,
}

/// Solves Σ F_n(δ) = F exactly: each F_n grows with δ.
fn share(pairs: &[LinePair], load: f64, mesh_position: f64) -> Result<Shared, AnalysisError> {
    let first = pairs
        .iter()
        .map(|pair| pair.gap)
        .fold(f64::INFINITY, f64::min);
    if pairs.is_empty() {
        return Err(AnalysisError::NoContact { mesh_position });
    }
    // With the whole load on the pair that touches first, δ is at its largest.
    let mut largest = f64::INFINITY;
    for pair in pairs {
        largest = largest.min(pair.gap + pair.deflection(load)?);
    }
    let forces = |delta: f64| {
        pairs
            .iter()
            .map(|pair| pair.force(delta - pair.gap, load))
            .collect::<Result<Vec<f64>, _>>()
    };
    let delta = bisect(first, largest, |delta| {
        Ok(forces(delta)?.iter().sum::<f64>() < load)
    })?;
    let forces = forces(delta)?;
    let (mut stiffness, mut peak_pressure) = (0.0, 0.0_f64);
    for (pair, &force) in pairs.iter().zip(&forces).filter(|(_, force)| **force > 0.0) {
        stiffness += 1.0 / pair.tangent(force)?;
        peak_pressure = peak_pressure.max(pair.contact.peak_pressure(force));
    }
    Ok(Shared {
        transmission_error: delta,
        stiffness,
        peak_pressure,
        residual: (forces.iter().sum::<f64>() - load).abs() / load,
        loads: pairs.iter().map(|pair| pair.offset).zip(forces).collect(),
    })
}

/// Where, between `low` and `high`, `below` ceases to hold.
fn bisect(
    mut low: f64,
    mut high: f64,
    below: impl Fn(f64) -> Result<bool, AnalysisError>,
) -> Result<f64, AnalysisError> {
    for _ in 0..BISECTIONS {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            break;
        }
        if below(middle)? {
            low = middle
        } else {
            high = middle
        }
    }
    Ok(high)
}

fn load_shares(case: &Case, contacts: &[Shared], load: f64) -> Vec<LoadShare> {
    let mut offsets: Vec<i32> = contacts
        .iter()
        .flat_map(|contact| &contact.loads)
        .filter(|load| load.1 > 0.0)
        .map(|load| load.0)
        .collect();
    offsets.sort_unstable();
    offsets.dedup();
    let of = |offset: i32, contact: &Shared| {
        contact
            .loads
            .iter()
            .find(|load| load.0 == offset)
            .map_or(0.0, |found| found.1 / load)
    };
    offsets
        .into_iter()
        .map(|pair_offset| LoadShare {
            pair_offset,
            share: repeated(
                case,
                contacts.iter().map(|contact| of(pair_offset, contact)),
            ),
        })
        .collect()
}

/// The formulas of a pair, its profiles tabulated once.
struct Compliances<'a> {
    pair: &'a GearPair,
    formulas: Formulas,
    gears: [GearFormulas; 2],
    iso: Option<f64>,
}

struct GearFormulas {
    material: ElasticConstants,
    tooth: InvoluteTooth,
    body: GearBody,
    /// Height above the root circle along the centerline, and half thickness there.
    profile: Vec<(f64, f64)>,
}

impl<'a> Compliances<'a> {
    fn new(pair: &'a GearPair, formulas: Formulas) -> Result<Self, AnalysisError> {
        let gears = [
            GearFormulas::new(pair.driving())?,
            GearFormulas::new(pair.driven())?,
        ];
        let iso = match formulas.tooth {
            ToothFormula::WeberBanaschek => None,
            ToothFormula::Iso6336 => Some(iso_stiffness(pair)?),
        };
        Ok(Self {
            pair,
            formulas,
            gears,
            iso,
        })
    }

    fn extrapolates(&self, member: Member) -> bool {
        let uses_body = self.iso.is_none() && self.formulas.body == BodyFormula::Sainsot;
        uses_body && !self.gears[member.index()].body.extrapolations().is_empty()
    }

    /// The pairs on the path of contact at mesh position `eta`.
    fn pairs_at(&self, eta: f64) -> Result<Vec<LinePair>, AnalysisError> {
        let (s_a, s_e) = self.pair.path_of_contact();
        let (s_c, p_b) = (self.pair.pitch_roll_length(), self.pair.base_pitch());
        let reference = eta.floor() as i64;
        (-3..=4)
            .map(|offset| {
                (
                    offset as i32,
                    s_c + (eta - (reference + offset) as f64) * p_b,
                )
            })
            .filter(|&(_, s)| (s_a..=s_e).contains(&s))
            .map(|(offset, s)| self.line_pair(offset, [s, self.pair.line_of_action() - s]))
            .collect()
    }

    fn line_pair(&self, offset: i32, rolls: [f64; 2]) -> Result<LinePair, AnalysisError> {
        let (plane, width) = (self.formulas.plane_state, self.pair.common_face_width());
        let (mut compliance, mut gap) = (0.0, 0.0);
        let mut bodies = Vec::with_capacity(2);
        for member in Member::BOTH {
            let (gear, formulas) = (self.pair.gear(member), &self.gears[member.index()]);
            let s = rolls[member.index()];
            let load = ToothLoad::at_roll_length(&formulas.tooth, s).map_err(no_formula)?;
            gap += gear.relief_depth(gear.flank().radius(s));
            bodies.push(ContactBody {
                material: formulas.material,
                curvature_radius: s,
                depth: load.depth,
            });
            if self.iso.is_none() {
                compliance += self.tooth_and_body(gear, formulas, &load)?;
            }
        }
        if let Some(stiffness) = self.iso {
            compliance = 1.0 / (stiffness * width);
        }
        let contact = LineContact::new([bodies[0], bodies[1]], width, plane).map_err(no_formula)?;
        Ok(LinePair {
            offset,
            compliance,
            gap,
            contact,
            local_included: self.iso.is_some(),
        })
    }

    fn tooth_and_body(
        &self,
        gear: &SpurGear,
        formulas: &GearFormulas,
        load: &ToothLoad,
    ) -> Result<f64, AnalysisError> {
        let (b, plane) = (gear.face_width(), self.formulas.plane_state);
        let tooth = weber_banaschek::tooth_compliance(
            |y| formulas.half_thickness(y),
            load,
            b,
            &formulas.material,
            plane,
        )
        .map_err(no_formula)?;
        let body = match self.formulas.body {
            BodyFormula::Rigid => 0.0,
            BodyFormula::Sainsot => formulas
                .body
                .compliance(load, b, formulas.material.young_modulus())
                .map_err(no_formula)?,
            BodyFormula::HalfPlane => half_plane::compliance(
                FoundationForm::WeberBanaschek,
                load,
                formulas.body.root_width(),
                b,
                &formulas.material,
                plane,
            )
            .map_err(no_formula)?,
        };
        Ok(tooth.total() + body)
    }
}

impl GearFormulas {
    fn new(gear: &SpurGear) -> Result<Self, AnalysisError> {
        let material = gear.material();
        let fillet = gear.fillet();
        let (gamma_0, gamma_1) = fillet.ends();
        let root = fillet.point(gamma_1);
        let fraction = |i: u32| f64::from(i) / f64::from(PROFILE_POINTS);
        let flank = (0..=PROFILE_POINTS).map(|i| {
            gear.flank().point(
                gear.tip_roll_length()
                    + (gear.form_roll_length() - gear.tip_roll_length()) * fraction(i),
            )
        });
        let below =
            (1..=PROFILE_POINTS).map(|i| fillet.point(gamma_0 + (gamma_1 - gamma_0) * fraction(i)));
        let mut profile: Vec<(f64, f64)> = flank
            .chain(below)
            .map(|point| (point.x - gear.root_radius(), point.y))
            .collect();
        profile.reverse();
        Ok(Self {
            material: ElasticConstants::new(material.youngs_modulus, material.poisson_ratio)
                .map_err(no_formula)?,
            tooth: InvoluteTooth::with_base_half_angle(
                gear.flank().base_half_angle(),
                gear.base_radius(),
                gear.root_radius(),
            )
            .map_err(no_formula)?,
            body: GearBody::new(gear.root_radius(), gear.bore_radius(), root.y.atan2(root.x))
                .map_err(no_formula)?,
            profile,
        })
    }

    /// Half the thickness of the tooth at the height `y` above the root circle.
    fn half_thickness(&self, y: f64) -> f64 {
        let after = self
            .profile
            .partition_point(|point| point.0 < y)
            .clamp(1, self.profile.len() - 1);
        let ((y_0, x_0), (y_1, x_1)) = (self.profile[after - 1], self.profile[after]);
        x_0 + (x_1 - x_0) * (y - y_0) / (y_1 - y_0)
    }
}

/// c'_th in N/m²; the formula wants the larger profile shift first.
fn iso_stiffness(pair: &GearPair) -> Result<f64, AnalysisError> {
    let gear = |gear: &SpurGear| IsoGear {
        tooth_count: gear.tooth_count(),
        profile_shift: gear.data().profile_shift,
    };
    let mut gears = [gear(pair.driving()), gear(pair.driven())];
    if gears[0].profile_shift < gears[1].profile_shift {
        gears.swap(0, 1);
    }
    let iso =
        IsoPair::new(gears, 0.0, pair.driving().data().rack.pressure_angle).map_err(no_formula)?;
    Ok(iso.theoretical_single_stiffness())
}

fn no_formula(error: impl std::error::Error) -> AnalysisError {
    AnalysisError::NoFormula {
        reason: error.to_string(),
    }
}
