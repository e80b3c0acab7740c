#![doc = include_str!("../README.md")]
//!
//! The source is Benaicha et al., "A decomposition method for the fast computation of the transmission error of gears with holes" (2021, hal-03230238);
//! equation numbers are the paper's.
//!
//! # The theory on a page
//!
//! Gear 1 drives, gear 2 is driven. The driving hub is held, the driven hub carries the torque T and turns back by
//! δ/R_b2: δ is the *static transmission error* (eq. 1), positive when load makes the driven gear lag, zero when rigid
//! unmodified involutes just touch. F = T/R_b2 is the transmitted load and k = dF/dδ the *mesh stiffness* (eq. 3).
//! The mesh position η counts mesh periods; at η = 0 tooth 0 of both gears touch at the pitch point.
//!
//! 1. **Geometry** ([`gear`]). An involute point at roll length s stands at r_b e_r(t) + s e_t(t), t = ψ_b − s/r_b. Gaps
//!    between flanks follow in closed form: the normal of an involute through any point is a tangent of its base circle
//!    (`touch::gap_profile`, `contact::patch`).
//! 2. **Substructures** ([`grid`], `fem`). One tooth sector is condensed exactly to its loaded flank and its interface:
//!    H_0 is the flank's compliance with the interface held, Ψ its answer to the interface (`ring::tooth`). The blank
//!    between bore and R_w is any plane region with a thickness by region ([`gear::BlankRegion`]), condensed as a whole or, where
//!    it is a pattern of holes, by the sector of one (`ring::blank`). Both meet on the circle R_w in trigonometric
//!    polynomials, whatever Z, N and the angle of the holes (`ring::harmonics`, `ring::cyclic`, `assembly::interface`).
//! 3. **Whole gears** (`ring::body`, `assembly::gear`). C = (S_blank + S_teeth)⁻¹ on that circle, and between the flanks of
//!    teeth i and j H_ij = δ_ij H_0 + Ψ_i C_ij Ψ_jᵀ, for every tooth on its own. Stresses inside follow from the same factors
//!    (`fem::recovery`).
//! 4. **Contact** ([`contact`]). At each position: minimize ½ pᵀHp + g_0ᵀp subject to wᵀp = F, p ≥ 0 (eqs. 4 to 6); δ is
//!    the multiplier of the load. H on the contact cells is the smooth part of the finite-element compliance, interpolated,
//!    plus the half plane's logarithm in closed form (`flank::table`, `flank::half_plane`), so that cells of a few
//!    micrometers move with the contact over elements of a tenth of a millimeter. Two solvers share nothing but H, g_0
//!    and w: an exact active set and the augmented Lagrangian of eq. 7.
//! 5. **Methods** ([`analysis`]). Flexible (section 2 of the paper), decomposition (section 3, eqs. 9 to 15), projected
//!    decomposition (ours), and the classical load distribution (eqs. 4 and 5) from closed-form compliances
//!    ([`load_distribution`], a room of its own).
//!
//! 6. **At speed** ([`dynamics`]). δ(θ, F) over a ladder of loads is a table of force with an energy ([`analysis::forces`]), and
//!    m_e x'' + c x' + F(θ, x) = F_0 is run through speeds, up and down.
//!
//! # Along the face
//!
//! Of a helical gear, a web narrower than the face, an uneven lead or axes out of line no transverse section is like the next. The paper has
//! none of this. z runs along the axis from the middle of the face, and each step above has its counterpart:
//!
//! 1. **Geometry** ([`gear::SolidGear`], [`gear::SolidPair`]). The transverse section at z is the plane pair at the phase
//!    η + z/p_x, p_x the axial pitch ([`gear::SolidPair::phase`]), so that lines of contact cross the flanks. Leads and deviations turn the flanks of each
//!    section (`touch::placement::Section`); axes that are out of line are a gap over z.
//! 2. **Substructures** (`fem::prism`, `fem::axial`, `ring::solid`). A gear is its section times polynomials across the face, in a
//!    frame that turns with the helix. Teeth, rim, web and hub are condensed part by part, order by order around the circle; where parts of unlike
//!    width meet, the displacements of the narrower one are those of the wider (`ring::solid::joint`). A web with holes takes its sector or its whole grid,
//!    as in the plane (`ring::solid::web`).
//! 3. **Compliance of flanks** ([`contact::face::FlankCompliance`], [`assembly::FaceCompliance`]). On a flank are functions of roll length and z; between
//!    them stands the smooth compliance of the gear, of each tooth and of its neighbors. Singular parts are left out of it and added in closed form: a
//!    half space under each line of contact, and the difference of a flank from one at its tip and at both ends of its face.
//! 4. **Contact** ([`contact::face`]). Lines are cut into slices. A slice is a contact of the plane: a nonlinear spring between the flanks, whose
//!    force over its depth is Hertz's, or that of the plane's cells where a tip, a fillet or a kink is near ([`contact::face::spring`]). Newton's method finds the depths
//!    at which springs, compliance and load are in balance.
//! 5. **Methods** ([`analysis`]). Both whole gears at every position (`three_dimensional`), or over one mesh period, with the first-order effect of holes
//!    added for each period (`three_dimensional_projected`). Stresses at roots and around holes, and fields, come from the same factors
//!    ([`assembly::FaceRoots`], `assembly::face_holes`, [`assembly::FaceInside`]).
//!
//! `contact::face::SLICES` sets the cuts of a face; with straight teeth, even leads and a blank as wide as the face the results are those of the plane for
//! narrow (plane stress) and wide (plane strain) faces, which tests check.
//!
//! # Further rooms
//!
//! The rest of the paper: the inner unknowns of the annulus (K_in,in and K_in,ed of eqs. 11 and 12) are eliminated exactly with every blank
//! (`fem::condensation`); its remainder on the circle R_w is `ring::annulus`, on which `analysis::decomposition` puts the displacement of the whole gear.
//! The frequency f_0 (eq. 2) is that of the true period ([`gear::GearPair::period`]), the first order of a [`analysis::spectrum::Spectrum`]. M and C (eq. 8)
//! are dropped: everything but [`dynamics`] is quasi-static.
//!
//! *Mesh* always means gear teeth in engagement; finite elements live on a [`grid::Grid`].
//!
//! The arrow: analysis → assembly → contact → touch, flank → ring → fem → grid → gear. The load distribution stands beside, on the drawings and on Hertz.
//! [`assembly`] makes a pair that is ready for contact of two drawings, part by part: teeth, blank, gear, pair. It asks [`assembly::Parts`] for each part;
//! [`library`] is a layer around all of this that keeps parts for other cases, and no file of the mechanics knows it.

pub mod analysis;
pub mod assembly;
pub mod contact;
pub mod dynamics;
pub(crate) mod fem;
pub(crate) mod flank;
pub mod fourier;
pub mod gear;
pub mod grid;
pub mod library;
pub mod load_distribution;
pub mod quadrature;
pub(crate) mod ring;
pub(crate) mod root_finding;
pub mod run;
pub mod substructures;
pub(crate) mod touch;
pub mod vibration;
mod wide;
