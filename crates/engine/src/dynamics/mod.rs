//! Motion of the gears at speed: forces over position and approach, and the response to them.
//!
//! One torsional degree of freedom on the line of action, x = r_b1 θ_1 − r_b2 θ_2:
//!
//! m_e x'' + c x' + F(θ, x) = F_0, θ = ωt, 1/m_e = r_b1²/J_1 + r_b2²/J_2, c = 2 ζ √(k m_e),
//!
//! with k the mean mesh stiffness under F_0. F is zero in the backlash and that of the other flank beyond it; the damping acts out of
//! contact too.
//!
//! - [`table`]: F(θ, δ) over the true period, interpolated, with its energy and the torques that follow from it,
//! - [`law`]: piecewise linear laws of force, and the motion under one of their pieces in closed form,
//! - [`oscillator`]: motion over a period as a chain of such pieces, with its derivative to the state at the beginning,
//! - [`orbit`]: periodic motions by Newton's method on that derivative, their multipliers, and where a motion settles,
//! - [`order`]: orders of a motion, and its amplitudes at them,
//! - `mesh`: a table at the steps of a run-up, and the motion in it at any speed,
//! - `natural`: the natural frequencies over speed,
//! - [`resonance`]: where orders of the motion resonate, and what excites them,
//! - [`run_up`]: both branches over speed, and their amplitudes,
//! - [`torsion`]: bodies that turn in themselves, and their lowest natural frequency on the mesh,
//! - [`bodies`], [`mount`]: bodies with modes on their mesh, their shafts and their supports; `free`: their free motions at a speed,
//! - [`coupled`]: the motion of such bodies over a period.
//!
//! Time is divided into steps. In each the shape of F is that of the middle of the step, and the static deflection δ_s(θ) under F_0, about which it stands,
//! moves on evenly: u = x − δ_s obeys m u'' + c u' + G(u) = F_0 − c δ_s' with a law G that is piecewise linear and constant in time. From step to step u' takes
//! up the change of δ_s'. Each piece has a closed form, so that a constant stiffness is met exactly, whatever the step; a varying one is met to second order.

pub mod bodies;
pub mod coupled;
mod free;
pub mod law;
mod mesh;
pub mod mount;
mod natural;
pub mod orbit;
pub mod order;
pub mod oscillator;
pub mod resonance;
pub mod run_up;
pub mod table;
pub mod torsion;

pub use bodies::{Body, BodyMode, BodyWave, Coupled, Damping};
pub use law::Laws;
pub use mesh::RunUpData;
pub use mount::{Mount, Support};
pub use orbit::Orbit;
pub use order::Order;
pub use oscillator::{Oscillator, State};
pub use resonance::{Excitation, Resonance};
pub use run_up::{Branch, RunUp};
pub use table::{FallingRow, FlankRows, ForceTable, LoadSteps};
