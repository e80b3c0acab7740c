//! Drawing data of a spur gear, and the reasons why it cannot be made.

use super::{BlankRegion, Material, ModificationData, Rack, TipEdge, ToothDeviations};

/// The least material between a hole and its neighbor, the bore or the root circle, in modules (of the normal section).
pub const LEAST_LIGAMENT: f64 = 0.25;

/// The least thickness of a tooth at its tip circle, in modules; below it the tooth counts as pointed.
pub const LEAST_TIP_THICKNESS: f64 = 0.05;

/// The least rim between the bore and the root circle, in modules.
pub const LEAST_RIM: f64 = 1.0;

/// The generating profile shift x_E at which the tool stood when it cut the root. Fillet, root circle and form circle follow from it; the tip circle follows
/// from the profile shift x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ToolDepth {
    /// A hob cuts thinner teeth by standing deeper, at x_E = x + A_s/(2 m tan α).
    ByThickness,
    /// The tool stands at x_E = x. The flanks are ground until the teeth are as thin as they are, and the fillets move with them.
    Nominal,
    /// The tool stands at this x_E. The flanks are ground by the rest of the deviation, as with [`ToolDepth::Nominal`].
    At(f64),
}

/// Drawing data of a spur gear; [`super::SpurGear::new`] checks it.
#[derive(Debug, Clone, PartialEq)]
pub struct GearData {
    /// The number of teeth Z.
    pub tooth_count: u32,
    /// The basic rack.
    pub rack: Rack,
    /// The profile shift coefficient x.
    pub profile_shift: f64,
    /// The deviation A_s of the tooth thickness, a transverse arc on the reference circle; negative is thinner.
    pub thickness_deviation: f64,
    /// Where the tool stood that cut the root.
    pub tool_depth: ToolDepth,
    /// The edge between flanks and tip circle.
    pub tip_edge: TipEdge,
    /// The face width b.
    pub face_width: f64,
    /// Material removed from the loaded flanks.
    pub modifications: Vec<ModificationData>,
    /// How teeth deviate from each other.
    pub deviations: ToothDeviations,
    /// The material of teeth and blank.
    pub material: Material,
    /// The blank.
    pub blank: BlankRegion,
}

impl GearData {
    /// A gear that differs from its rack, profile A of ISO 53, in nothing: sharp and even teeth, 10 modules wide, of steel, on a solid blank with this
    /// bore. Lengths are in meters. Other gears name the values in which they differ from it.
    pub fn plain(tooth_count: u32, module: f64, bore_radius: f64) -> Self {
        Self {
            tooth_count,
            rack: Rack::profile_a(module),
            profile_shift: 0.0,
            thickness_deviation: 0.0,
            tool_depth: ToolDepth::ByThickness,
            tip_edge: TipEdge::Sharp,
            face_width: 10.0 * module,
            modifications: Vec::new(),
            deviations: ToothDeviations::default(),
            material: Material::STEEL,
            blank: BlankRegion::solid(bore_radius),
        }
    }

    /// The generating profile shift x_E, in modules of this section.
    pub fn generating_profile_shift(&self) -> f64 {
        match self.tool_depth {
            ToolDepth::ByThickness => {
                self.profile_shift + self.thickness_deviation / self.thickness_of_shift(1.0)
            }
            ToolDepth::Nominal => self.profile_shift,
            ToolDepth::At(x_e) => x_e,
        }
    }

    /// How much thicker the flanks are than the tool leaves them at x_E, a transverse arc on the reference circle: A_s − 2 (x_E − x) m tan α. 0 of a gear that a hob
    /// has finished.
    pub(super) fn thickness_of_flanks(&self) -> f64 {
        match self.tool_depth {
            ToolDepth::ByThickness => 0.0,
            ToolDepth::Nominal => self.thickness_deviation,
            ToolDepth::At(x_e) => {
                self.thickness_deviation - self.thickness_of_shift(x_e - self.profile_shift)
            }
        }
    }

    /// By how much a profile shift of `shift` makes teeth thicker, an arc on the reference circle: 2 `shift` m tan α.
    pub fn thickness_of_shift(&self, shift: f64) -> f64 {
        2.0 * shift * self.rack.module * self.rack.pressure_angle.tan()
    }
}

/// The least rim between a web and the root circle, in modules: less is no rim that teeth could stand on.
pub const LEAST_WEB_RIM: f64 = 0.5;

/// A list of deviations, one a tooth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviationList {
    /// The pitch.
    Pitch,
    /// The pitch of the other flanks.
    OtherFlankPitch,
    /// The profile slope.
    ProfileSlope,
    /// The lead slope.
    LeadSlope,
    /// Traces of the profiles.
    Profiles,
    /// Traces of the leads.
    Leads,
}

/// Why a gear cannot be made as drawn. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GearError {
    /// The rack's tip rounding does not fit between its flanks.
    #[error("the rack's tip rounding of radius {tip_radius} m does not fit: at most {largest} m")]
    RackTipRadius {
        /// The radius asked for.
        tip_radius: f64,
        /// The largest that fits.
        largest: f64,
    },
    /// The protuberance is less than the stock: grinding would leave a step in the root, and where it ends is not known.
    #[error("a protuberance of {amount} m is less than the grinding stock of {stock} m")]
    ProtuberanceBelowStock {
        /// The protuberance asked for.
        amount: f64,
        /// The grinding stock, which is the least that leaves no step.
        stock: f64,
    },
    /// The protuberance leaves no tooth, or no height within the dedendum at which it could begin.
    #[error("a protuberance of {amount} m is too large; at most {largest} m")]
    ProtuberanceTooLarge {
        /// The protuberance asked for.
        amount: f64,
        /// The largest that would do.
        largest: f64,
    },
    /// The protuberance begins too near to the hob's tip, or above its reference line.
    #[error("the protuberance begins at {height} m; it must be between {least} m and {largest} m")]
    ProtuberanceHeight {
        /// The height asked for, from the hob's tip line.
        height: f64,
        /// Height of a flank that stands upright, or of the place where the rounding comes out of the hob's flank.
        least: f64,
        /// The dedendum.
        largest: f64,
    },
    /// The rack cuts so far into the flanks that next to nothing of the tooth is left between them.
    #[error(
        "undercut leaves no tooth at the generating profile shift {generating_profile_shift}; {smallest} avoids it"
    )]
    Undercut {
        /// The generating profile shift x_E.
        generating_profile_shift: f64,
        /// The smallest x_E that avoids undercut.
        smallest: f64,
    },
    /// The flanks meet, or nearly, below the tip circle.
    #[error(
        "the tooth is {thickness} m thick at its tip; an addendum of {largest_addendum} m leaves enough"
    )]
    PointedTip {
        /// The thickness at the tip circle, negative if the flanks cross.
        thickness: f64,
        /// The largest addendum of the rack that leaves [`LEAST_TIP_THICKNESS`].
        largest_addendum: f64,
    },
    /// No involute is left between the form circle and the tip circle.
    #[error("the tip radius {tip_radius} m leaves no flank above the form radius {form_radius} m")]
    NoFlank {
        /// The tip radius.
        tip_radius: f64,
        /// The form radius.
        form_radius: f64,
    },
    /// The thicker teeth leave no space between their fillets.
    #[error(
        "teeth thicker by {deviation} m leave no space between their fillets; at most {largest} m"
    )]
    TeethTooThick {
        /// The thickness deviation asked for.
        deviation: f64,
        /// The largest that leaves a root.
        largest: f64,
    },
    /// The broken edges of the tip meet, or leave no involute.
    #[error("a tip edge broken by {amount} m leaves no tip; at most {largest} m")]
    TipEdgeTooLarge {
        /// The rounding radius or chamfer asked for.
        amount: f64,
        /// The largest that leaves a tip and a flank.
        largest: f64,
    },
    /// A relief starts off the flank, or at the end where it should be largest.
    #[error(
        "the relief starts at radius {start_radius} m, outside the flank from {form_radius} m to {tip_radius} m"
    )]
    ReliefTooLong {
        /// Index of the modification in its list.
        modification: usize,
        /// The radius at which it was to start.
        start_radius: f64,
        /// The form radius.
        form_radius: f64,
        /// The tip radius.
        tip_radius: f64,
    },
    /// A profile table has fewer than two entries, or as many places as it has no values for, or does not rise.
    #[error("entry {entry} of the profile table does not follow the one before it")]
    TableDoesNotRise {
        /// Index of the modification in its list.
        modification: usize,
        /// The first entry that is missing or not larger than the one before.
        entry: usize,
    },
    /// A list of deviations has not one entry for each tooth.
    #[error("{given} deviations for {needed} teeth")]
    DeviationCount {
        /// Which list.
        list: DeviationList,
        /// Its length.
        given: usize,
        /// The number of teeth.
        needed: usize,
    },
    /// The places of traces do not rise, are fewer than two, or a trace has not one entry for each.
    #[error("entry {entry} of the traces does not follow the one before it")]
    TraceDoesNotFit {
        /// Of which traces.
        list: DeviationList,
        /// The first entry that is missing, one too many, or not beyond the one before it.
        entry: usize,
    },
    /// The web does not lie between the bore and the rim under the teeth.
    #[error(
        "the web from {inner_radius} m to {outer_radius} m must lie between {least} m and {largest} m"
    )]
    WebOutside {
        /// Where it was to begin.
        inner_radius: f64,
        /// Where it was to end.
        outer_radius: f64,
        /// The bore radius.
        least: f64,
        /// The largest radius that leaves [`LEAST_WEB_RIM`].
        largest: f64,
    },
    /// The bore leaves too thin a rim below the root circle.
    #[error("the bore of radius {bore_radius} m leaves no rim; at most {largest} m")]
    BoreTooLarge {
        /// The bore radius asked for.
        bore_radius: f64,
        /// The largest that leaves [`LEAST_RIM`].
        largest: f64,
    },
    /// Holes leave too little between them, or a slot between its ends.
    #[error("the holes leave {ligament} m between them; a radius of {largest_radius} m would do")]
    HolesOverlap {
        /// Their places in the list; twice the same for the ends of one slot.
        holes: [usize; 2],
        /// The material left, negative if they overlap.
        ligament: f64,
        /// The largest radius, or half width of a slot, that leaves [`LEAST_LIGAMENT`].
        largest_radius: f64,
    },
    /// A hole leaves too little below the root circle.
    #[error(
        "the holes leave {ligament} m below the root circle; a radius of {largest_radius} m would do"
    )]
    HolesBreachRim {
        /// Its place in the list.
        hole: usize,
        /// The material left, negative if they cut through.
        ligament: f64,
        /// The largest radius, or half width of a slot, that leaves [`LEAST_LIGAMENT`].
        largest_radius: f64,
    },
    /// A hole leaves too little around the bore.
    #[error(
        "the holes leave {ligament} m around the bore; a radius of {largest_radius} m would do"
    )]
    HolesBreachBore {
        /// Its place in the list.
        hole: usize,
        /// The material left, negative if they cut through.
        ligament: f64,
        /// The largest radius, or half width of a slot, that leaves [`LEAST_LIGAMENT`].
        largest_radius: f64,
    },
}
