//! REXS, the gearbox exchange format of the FVA: a pair of cylindrical gears out of a model, and a pair with its curves as a model.
//!
//! A model is a list of components with attributes, relations between components, and load cases. Read in this order: `container` (XML, JSON or an archive),
//! `content`, `file` with `json` and `markup`, `unit` (units of its numbers), `fault` (faults of a model), `reading`, `import` with `gear`, `hob`, `flank`,
//! `shaft` and `load`, and `export`.
//!
//! Names are those of versions 1.0 to 2.0. Fields without a name in the format stand in attributes `custom_meshwright_...`.

mod container;
mod content;
mod export;
mod fault;
mod file;
mod flank;
mod gear;
mod hob;
mod import;
mod json;
mod load;
mod markup;
mod reading;
mod shaft;
mod unit;

pub use container::{is_model, is_packed, unpacked};
pub use export::export;
pub use fault::{Fault, Refused};
pub use import::{Import, NotRead, each_stage, import};
pub use reading::{Choices, LoadedFlank};

/// The attributes that only this program writes and reads, each named once for both directions.
mod own {
    /// Of the stage: the method, as a submission has it.
    pub(super) const METHOD: &str = "custom_meshwright_method";
    /// Of a gear: the openings of its blank by the field of each kind, the JSON of a submission.
    pub(super) const OPENINGS: [(&str, &str); 3] = [
        ("holes", "custom_meshwright_holes"),
        ("spokes", "custom_meshwright_spokes"),
        ("outline", "custom_meshwright_outline"),
    ];
    /// Of a gear: the protuberance of its hob, the JSON of a submission.
    pub(super) const PROTUBERANCE: &str = "custom_meshwright_protuberance";
    /// Of a gear that is of one piece with its shaft: that, the JSON of a submission.
    pub(super) const SHAFT: &str = "custom_meshwright_shaft";
    /// Of a gear: the deviations of the teeth, the JSON of a submission.
    pub(super) const DEVIATIONS: &str = "custom_meshwright_tooth_deviations";
    /// Of a gear: the radius of the tip edges.
    pub(super) const TIP_ROUNDING: &str = "custom_meshwright_tip_rounding";
    /// Of a flank: profile tables, the JSON of a submission.
    pub(super) const TABLES: &str = "custom_meshwright_profile_tables";
    /// Of a flank: end reliefs and tables of its lead, the JSON of a submission.
    pub(super) const LEADS: &str = "custom_meshwright_lead_modifications";
    /// Of the stage: where the mid plane of the driven face stands from that of the driving one.
    pub(super) const AXIAL_OFFSET: &str = "custom_meshwright_axial_offset";
    /// Of the stage: how the axes stand askew, the JSON of a submission.
    pub(super) const MISALIGNMENT: &str = "custom_meshwright_misalignment";
    /// Of a gear body: where the mid plane of the web stands from that of the face.
    pub(super) const WEB_OFFSET: &str = "custom_meshwright_web_offset";
    /// Of a gear body: a hub of another width, the JSON of a submission.
    pub(super) const HUB: &str = "custom_meshwright_hub";
    /// Of a gear body: where the web begins.
    pub(super) const WEB_INNER_RADIUS: &str = "custom_meshwright_web_inner_radius";
    /// Of the stage in a load case: where in the mesh each entry of the characteristic stands, in mesh periods.
    pub(super) const MESH_POSITION: &str = "custom_meshwright_mesh_position";
    /// Of the stage in a load case: the load over the transmission error.
    pub(super) const SECANT: &str = "custom_meshwright_mesh_stiffness_secant";
    /// Of the stage in a load case.
    pub(super) const TRANSMISSION_ERROR: &str = "custom_meshwright_transmission_error";
}
