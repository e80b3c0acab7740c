//! The hob that cuts before grinding: its differences from the basic rack of the ground flanks.

use meshwright_engine::gear::Protuberance;

use super::GearDocument;
use super::faults::Fault;
use super::field::Field;
use super::proportions::check_between;
use crate::declare::{Declared, Number, document, number};
use crate::problem::Code;
use crate::units::{Side, from_mm, from_um, plain, to_mm, to_um};

/// The largest protuberance, in modules.
const LARGEST: f64 = 0.3;

document! {
    /// A hob that leaves stock on the flanks and cuts deeper at the root, so that the grinding wheel runs out freely. All other fields of the gear describe the
    /// ground teeth, the dedendum and the tip rounding of the hob. Its flank stands back by the stock, parallel to that of the basic rack. From `height_mm` on
    /// down a straight flank leads to the tip rounding and touches it, and the rounding touches a parallel to the hob's own flank that stands out from it by
    /// the amount (p_r, q and h of ISO 6336-3 and gear programs; the angle of the protuberance follows). The rest of the amount after grinding undercuts the
    /// flank: it ends where the root as it is hobbed cuts the involute.
    pub struct ProtuberanceDocument as "Protuberance", "Protuberance" {
        /// p_r: how far the tip rounding stands out from the hob's flank, normal to it in the normal section. At least the grinding stock, at most 0.3 modules. As much as the
        /// stock leaves the root of the basic rack, and nothing is left to undercut the flank.
        pub(super) amount_um: f64 = number("Amount of the protuberance", "um", 0.0, 15_000.0),
        /// How far above the hob's tip line the protuberance begins. At least where its flank would stand upright, at most the dedendum.
        pub(super) height_mm: f64 = number("Height of the protuberance", "mm", 0.0, 125.0),
        /// q: stock ground off each flank, normal to it in the normal section.
        pub(super) grinding_stock_um: f64 = number("Grinding stock", "um", 0.0, 15_000.0).or(0.0),
    }
}

impl ProtuberanceDocument {
    /// The protuberance of the engine.
    pub(super) fn data(&self) -> Protuberance {
        Protuberance {
            amount: from_um(self.amount_um),
            height: from_mm(self.height_mm),
            grinding_stock: from_um(self.grinding_stock_um),
        }
    }
}

impl GearDocument {
    pub(super) fn check_protuberance(&self) -> Result<(), Fault> {
        let Some(hob) = &self.protuberance else {
            return Ok(());
        };
        let most = 1e3 * LARGEST * self.module_mm;
        let said = format!("0 to {LARGEST} modules");
        for (declared, value) in [
            (
                ProtuberanceDocument::grinding_stock_um,
                hob.grinding_stock_um,
            ),
            (ProtuberanceDocument::amount_um, hob.amount_um),
        ] {
            check_between(place(declared), value, 0.0, most, &said)?;
        }
        Ok(())
    }

    /// Grinding would leave a step in the root.
    pub(super) fn protuberance_below_stock(amount: f64, stock: f64) -> Fault {
        Fault::new(
            place(ProtuberanceDocument::amount_um),
            Code::OutOfRange,
            format!(
                "A protuberance of {} um is less than the grinding stock of {} um: grinding would leave a step in the root, and where it ends is not said.",
                plain(to_um(amount)),
                plain(to_um(stock))
            ),
            Some((to_um(stock), Side::AtLeast)),
        )
    }

    /// Fault of an amount that leaves no tooth, or begins above the reference line at any height.
    pub(super) fn protuberance_too_large(amount: f64, largest: f64) -> Fault {
        Fault::new(
            place(ProtuberanceDocument::amount_um),
            Code::OutOfRange,
            format!(
                "A protuberance of {} um does not fit on this hob; at most {} um does.",
                plain(to_um(amount)),
                plain(to_um(largest))
            ),
            Some((to_um(largest), Side::AtMost)),
        )
    }

    /// Fault of a height from which no straight flank leads to its rounding, or which lies above the reference line.
    pub(super) fn protuberance_height(height: f64, [least, largest]: [f64; 2]) -> Fault {
        let bound = if height < least {
            (to_mm(least), Side::AtLeast)
        } else {
            (to_mm(largest), Side::AtMost)
        };
        Fault::new(
            place(ProtuberanceDocument::height_mm),
            Code::OutOfRange,
            format!(
                "A protuberance of this amount begins {} mm above the tip of the hob; it can from {} mm, where its flank would stand upright or its rounding comes out of the hob's, to {} mm, the dedendum.",
                plain(to_mm(height)),
                plain(to_mm(least)),
                plain(to_mm(largest))
            ),
            Some(bound),
        )
    }
}

fn place(declared: Declared<Number>) -> Field {
    Field::of("protuberance/", declared)
}
