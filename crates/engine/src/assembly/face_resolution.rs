//! Resolution of gears along their faces.

use crate::grid::GridLevel;

const LEAST_ORDER: usize = 3;
/// The width in modules from which a face has all of its polynomials, and the degree that any has.
const WIDE: f64 = 2.0;

/// Resolution of the compliance of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct FaceResolution {
    /// The degree P of the polynomials across the face.
    pub face_order: usize,
    /// The degree of those across a web or a hub.
    pub web_order: usize,
    /// The orders of its outer circle in which holes of a web are seen, at least: more where holes come near its edge or the roots.
    pub web_harmonics: usize,
    /// How fine the sections of teeth are.
    pub sections: GridLevel,
}

impl FaceResolution {
    /// For results: oblique line loads within half a percent.
    pub const STANDARD: Self = Self {
        face_order: 8,
        web_order: 4,
        web_harmonics: 14,
        sections: GridLevel::Standard,
    };

    /// For first looks: within a percent.
    pub const DRAFT: Self = Self {
        face_order: 6,
        web_order: 3,
        web_harmonics: 10,
        sections: GridLevel::Standard,
    };

    /// The same at a grid `level` that stands to the standard one as these do: sections, orders across the face and around webs together.
    pub fn at(self, level: GridLevel) -> Self {
        let finer = |count: usize, step: usize| match level {
            GridLevel::Coarse => count.saturating_sub(step),
            GridLevel::Standard => count,
            GridLevel::Fine => count + step,
        };
        Self {
            face_order: finer(self.face_order, 2).max(LEAST_ORDER),
            web_order: finer(self.web_order, 1).max(2),
            web_harmonics: finer(self.web_harmonics, 4).max(6),
            sections: level,
        }
    }

    /// The fields of teeth at the holes, and those of holes at the edges of the part with the holes, fall to e^−these in the first order that is left out.
    ///
    /// δ errs by the square of such a part. Stress errs by (1 + d) e^−d of the decay d, as its orders count with their number.
    pub(super) fn hole_decays(&self) -> [f64; 2] {
        match self.sections {
            GridLevel::Coarse => [4.0, 2.5],
            GridLevel::Standard => [5.5, 4.0],
            GridLevel::Fine => [7.5, 6.0],
        }
    }

    /// The resolution of a face of `modules` modules: a face narrower than its teeth are high has no polynomials finer than their grid.
    pub(super) fn of_width(self, modules: f64) -> Self {
        let order = (self.face_order as f64 * (modules / WIDE).min(1.0)).ceil() as usize;
        Self {
            face_order: order.max(LEAST_ORDER),
            ..self
        }
    }

    /// The degree of the pieces across a rim that is broken at the faces of its web: that of half of the whole face.
    pub fn piece_order(self) -> usize {
        self.face_order / 2 + 1
    }
}
