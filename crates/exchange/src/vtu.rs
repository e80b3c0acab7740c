//! Displacements and stresses of both gears as a VTK unstructured grid, which ParaView, PyVista and meshio read.

use meshwright_engine::analysis::fields::GearField;
use meshwright_engine::fem::volume::{Volume, von_mises};
use meshwright_engine::grid::ElementKind;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, IOBuffer,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};

/// A gear as the file has it: points in mm, in single precision.
#[derive(Default)]
pub struct Piece {
    /// Three numbers a point.
    points: Vec<f32>,
    displacement: Vec<f32>,
    /// Nine numbers a point.
    stress: Vec<f32>,
    von_mises: Vec<f32>,
    cells: Vec<(CellType, Vec<u32>)>,
    /// One a cell; none of a volume, which shows it.
    thickness: Vec<f32>,
}

impl Piece {
    fn count(&self) -> u64 {
        self.von_mises.len() as u64
    }
}

impl From<&GearField> for Piece {
    fn from(gear: &GearField) -> Self {
        let elements = gear.elements.iter();
        Self {
            points: (gear.nodes.iter())
                .flat_map(|node| [1e3 * node.x, 1e3 * node.y, 0.0].map(single))
                .collect(),
            displacement: (gear.displacements.iter())
                .flat_map(|u| [1e6 * u.x, 1e6 * u.y, 0.0].map(single))
                .collect(),
            stress: (gear.stresses.iter())
                .flat_map(|&[xx, yy, xy]| [xx, xy, 0.0, xy, yy, 0.0, 0.0, 0.0, 0.0].map(mpa))
                .collect(),
            von_mises: gear.von_mises.iter().copied().map(mpa).collect(),
            cells: elements
                .map(|element| {
                    let kind = match element.kind() {
                        ElementKind::Quadrilateral => CellType::QuadraticQuad,
                        ElementKind::Triangle => CellType::QuadraticTriangle,
                    };
                    (kind, element.nodes().to_vec())
                })
                .collect(),
            thickness: (gear.thicknesses.iter())
                .map(|width| single(1e3 * width))
                .collect(),
        }
    }
}

impl From<&Volume> for Piece {
    fn from(gear: &Volume) -> Self {
        let elements = gear.elements.iter();
        Self {
            points: (gear.nodes.iter())
                .flat_map(|node| [node.x, node.y, node.z].map(|x| single(1e3 * x)))
                .collect(),
            displacement: (gear.displacements.iter())
                .flat_map(|u| [u.x, u.y, u.z].map(|u| single(1e6 * u)))
                .collect(),
            // Symmetric, so that rows are columns.
            stress: (gear.stresses.iter())
                .flat_map(|stress| stress.iter().copied().map(mpa))
                .collect(),
            von_mises: gear.stresses.iter().map(von_mises).map(mpa).collect(),
            cells: elements
                .map(|element| {
                    let kind = match element.kind {
                        ElementKind::Quadrilateral => CellType::QuadraticHexahedron,
                        ElementKind::Triangle => CellType::QuadraticWedge,
                    };
                    (kind, element.nodes.clone())
                })
                .collect(),
            thickness: Vec::new(),
        }
    }
}

fn single(value: f64) -> f32 {
    value as f32
}

fn mpa(stress: f64) -> f32 {
    single(stress / 1e6)
}

/// The driving and the driven gear as one grid, in binary XML.
///
/// At points: `displacement_um` against the hub of the gear, `stress_mpa` (a symmetric tensor), `von_mises_mpa`. In cells: `gear`, 0 for the driving
/// and 1 for the driven one, and of plates `thickness_mm`.
///
/// # Errors
///
/// When the grid cannot be written, which the sizes of gears do not let happen.
pub fn document(gears: [Piece; 2]) -> Result<Vec<u8>, vtkio::Error> {
    let (mut connectivity, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
    let mut member = Vec::<u8>::new();
    let mut both = Piece::default();
    for (number, gear) in (0..).zip(gears) {
        let first = both.count();
        for (kind, nodes) in &gear.cells {
            connectivity.extend(nodes.iter().map(|node| first + u64::from(*node)));
            offsets.push(connectivity.len() as u64);
            types.push(*kind);
            member.push(number);
        }
        both.points.extend(gear.points);
        both.displacement.extend(gear.displacement);
        both.stress.extend(gear.stress);
        both.von_mises.extend(gear.von_mises);
        both.thickness.extend(gear.thickness);
    }
    let of_points = vec![
        named(DataArray::vectors("displacement_um"), both.displacement),
        named(DataArray::tensors("stress_mpa"), both.stress),
        named(DataArray::scalars("von_mises_mpa", 1), both.von_mises),
    ];
    let mut of_cells = vec![named(DataArray::scalars("gear", 1), member)];
    if !both.thickness.is_empty() {
        of_cells.push(named(DataArray::scalars("thickness_mm", 1), both.thickness));
    }
    let grid = Vtk {
        version: Version::new(),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        file_path: None,
        data: DataSet::inline(UnstructuredGridPiece {
            points: both.points.into(),
            cells: Cells {
                cell_verts: VertexNumbers::XML {
                    connectivity,
                    offsets,
                },
                types,
            },
            data: Attributes {
                point: of_points,
                cell: of_cells,
            },
        }),
    };
    let mut text = Vec::new();
    grid.write_xml(&mut text)?;
    Ok(text)
}

fn named(array: DataArray, values: impl Into<IOBuffer>) -> Attribute {
    Attribute::DataArray(array.with_data(values))
}
