//! A gear as elements with values at their points: as a plate, as a volume, or on linear cells.

use meshwright_engine::analysis::fields::{GearField, Volume, VolumeElement, von_mises};
use meshwright_engine::grid::ElementKind;
use meshwright_engine::vibration::ModeShape;

/// A mode of a gear as displacements: its cosine or its sine, so large that `scale` kg^(−1/2) are 1 µm.
#[derive(Clone, Copy)]
pub struct Wave<'a> {
    pub(crate) shape: &'a ModeShape,
    pub(crate) part: usize,
    pub(crate) scale: f64,
}

/// A gear, as a plate or as a volume.
#[derive(Clone, Copy)]
pub enum Piece<'a> {
    /// As plane methods see it.
    Plate(&'a GearField),
    /// As those see it that see the faces.
    Volume(&'a Volume),
    /// A natural mode, without stresses.
    Wave(Wave<'a>),
    /// Any of them on linear cells.
    Linear(&'a Divided),
}

impl<'a> Piece<'a> {
    pub(crate) fn points(self) -> usize {
        match self {
            Self::Plate(gear) => gear.nodes.len(),
            Self::Volume(gear) => gear.nodes.len(),
            Self::Wave(wave) => wave.shape.nodes.len(),
            Self::Linear(gear) => gear.points.len(),
        }
    }

    pub(crate) fn cells(self) -> usize {
        match self {
            Self::Plate(gear) => gear.elements.len(),
            Self::Volume(gear) => gear.elements.len(),
            Self::Wave(wave) => wave.shape.elements.len(),
            Self::Linear(gear) => gear.cells.len(),
        }
    }

    /// Values at a point: its place in mm, its displacement in µm, and its stresses in MPa.
    pub(crate) fn values(self, number: usize) -> Values {
        let (place, displacement, stress, von_mises) = match self {
            Self::Plate(gear) => {
                let (at, u) = (gear.nodes[number], gear.displacements[number]);
                let [xx, yy, xy] = gear.stresses[number];
                (
                    [at.x, at.y, 0.0],
                    [u.x, u.y, 0.0],
                    [xx, xy, 0.0, xy, yy, 0.0, 0.0, 0.0, 0.0],
                    gear.von_mises[number],
                )
            }
            Self::Volume(gear) => {
                // Symmetric, so that rows are columns.
                let stress = gear.stresses[number].as_slice();
                (
                    gear.nodes[number].into(),
                    gear.displacements[number].into(),
                    std::array::from_fn(|place| stress[place]),
                    von_mises(&gear.stresses[number]),
                )
            }
            Self::Wave(Wave { shape, part, scale }) => {
                let u = 1e-6 / scale * shape.displacements[number][part];
                (shape.nodes[number].into(), u.into(), [0.0; 9], 0.0)
            }
            Self::Linear(gear) => return gear.points[number],
        };
        Values {
            place: place.map(|x| 1e3 * x),
            displacement: displacement.map(|u| 1e6 * u),
            stress: stress.map(|stress| stress / 1e6),
            von_mises: von_mises / 1e6,
        }
    }

    /// The shape of the section of an element, and the layers of linear cells across it: none of a plate, or where its cells are linear.
    pub(crate) fn element(self, number: usize) -> (ElementKind, u32) {
        match self {
            Self::Plate(gear) => (gear.elements[number].kind(), 0),
            Self::Volume(gear) => (gear.elements[number].kind, Divided::LAYERS),
            Self::Wave(wave) => (wave.shape.elements[number].kind, Divided::LAYERS),
            Self::Linear(gear) => (gear.cells[number].section(), 0),
        }
    }

    /// VTK's number of the shape of a cell, and its points.
    pub(crate) fn cell(self, number: usize) -> (u8, &'a [u32]) {
        match self {
            Self::Plate(gear) => {
                let element = &gear.elements[number];
                let shape = match element.kind() {
                    ElementKind::Quadrilateral => QUADRATIC_QUAD,
                    ElementKind::Triangle => QUADRATIC_TRIANGLE,
                };
                (shape, element.nodes())
            }
            Self::Volume(gear) => solid(&gear.elements[number]),
            Self::Wave(wave) => solid(&wave.shape.elements[number]),
            Self::Linear(gear) => {
                let cell = &gear.cells[number];
                (cell.shape, cell.corners())
            }
        }
    }

    /// The thickness of a cell in mm; none of a volume, which shows it.
    pub(crate) fn thickness(self, number: usize) -> Option<f64> {
        match self {
            Self::Plate(gear) => Some(1e3 * gear.thicknesses[number]),
            Self::Volume(_) | Self::Wave(_) => None,
            Self::Linear(gear) => gear.cells[number].thickness,
        }
    }
}

/// VTK's number of the shape of an element in space, and its points.
fn solid(element: &VolumeElement) -> (u8, &[u32]) {
    let shape = match element.kind {
        ElementKind::Quadrilateral => QUADRATIC_HEXAHEDRON,
        ElementKind::Triangle => QUADRATIC_WEDGE,
    };
    (shape, &element.nodes)
}

/// Shapes of cells by their numbers in `vtkCellType.h`.
const QUADRATIC_TRIANGLE: u8 = 22;
const QUADRATIC_QUAD: u8 = 23;
const QUADRATIC_HEXAHEDRON: u8 = 25;
const QUADRATIC_WEDGE: u8 = 26;

/// Layers of linear cells across an element of a volume, over whose height fields vary slowly.
const ACROSS: u32 = 2;

/// Shapes of cells by their numbers in `vtkCellType.h`.
pub(crate) const TRIANGLE: u8 = 5;
pub(crate) const QUAD: u8 = 9;
pub(crate) const HEXAHEDRON: u8 = 12;
pub(crate) const WEDGE: u8 = 13;

/// The most corners of a cell.
pub(crate) const MOST_CORNERS: usize = 8;

/// Values at a point, in the units of the file.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Values {
    pub(crate) place: [f64; 3],
    pub(crate) displacement: [f64; 3],
    pub(crate) stress: [f64; 9],
    pub(crate) von_mises: f64,
}

/// A linear cell: its shape, its points, and the thickness of a plate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    pub(crate) shape: u8,
    pub(crate) corners: [u32; MOST_CORNERS],
    pub(crate) thickness: Option<f64>,
}

impl Cell {
    /// The shape of its section.
    pub(crate) fn section(&self) -> ElementKind {
        match self.shape {
            TRIANGLE | WEDGE => ElementKind::Triangle,
            _ => ElementKind::Quadrilateral,
        }
    }

    pub(crate) fn corners(&self) -> &[u32] {
        let count = match self.shape {
            TRIANGLE => 3,
            QUAD => 4,
            WEDGE => 6,
            _ => MOST_CORNERS,
        };
        &self.corners[..count]
    }
}

/// A gear on linear cells. Neighbors share the points between them.
#[derive(Debug, Clone, Default)]
pub struct Divided {
    pub(crate) points: Vec<Values>,
    pub(crate) cells: Vec<Cell>,
}

impl Values {
    /// Adds a share of another point.
    pub(crate) fn add(&mut self, other: &Self, share: f64) {
        let add = |own: &mut [f64], of: &[f64]| {
            own.iter_mut()
                .zip(of)
                .for_each(|(own, of)| *own += share * of);
        };
        add(&mut self.place, &other.place);
        add(&mut self.displacement, &other.displacement);
        add(&mut self.stress, &other.stress);
        self.von_mises += share * other.von_mises;
    }
}

impl Divided {
    /// The bytes that it takes.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&*self.points) + size_of_val(&*self.cells)) as u64
    }

    /// Layers of cells across an element of a volume.
    pub(crate) const LAYERS: u32 = ACROSS;
}
