//! Displacements and stresses of both gears as a VTK unstructured grid, which ParaView, PyVista and meshio read.

use meshwright_engine::analysis::fields::GearField;
use meshwright_engine::grid::ElementKind;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, IOBuffer,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};

/// The driving and the driven gear as one grid, in binary XML.
///
/// At points: `displacement_um` against the hub of the gear, `stress_mpa` (a symmetric tensor), `von_mises_mpa`. In cells: `thickness_mm`,
/// and `gear`, 0 for the driving and 1 for the driven one. Points are in mm. Numbers have single precision.
///
/// # Errors
///
/// When the grid cannot be written, which the sizes of gears do not let happen.
pub fn document(gears: &[GearField; 2]) -> Result<Vec<u8>, vtkio::Error> {
    let nodes = || gears.iter().flat_map(|gear| &gear.nodes);
    let displacements = gears.iter().flat_map(|gear| &gear.displacements);
    let stresses = gears.iter().flat_map(|gear| &gear.stresses);
    let mpa = |stress: f64| (stress / 1e6) as f32;
    let points: Vec<f32> = nodes()
        .flat_map(|node| [(1e3 * node.x) as f32, (1e3 * node.y) as f32, 0.0])
        .collect();
    let displacement: Vec<f32> = displacements
        .flat_map(|u| [(1e6 * u.x) as f32, (1e6 * u.y) as f32, 0.0])
        .collect();
    let stress: Vec<f32> = stresses
        .flat_map(|&[xx, yy, xy]| {
            let [xx, yy, xy] = [xx, yy, xy].map(mpa);
            [xx, xy, 0.0, xy, yy, 0.0, 0.0, 0.0, 0.0]
        })
        .collect();
    let von_mises: Vec<f32> = gears
        .iter()
        .flat_map(GearField::von_mises)
        .map(mpa)
        .collect();

    let (mut connectivity, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
    let (mut thickness, mut member) = (Vec::<f32>::new(), Vec::<u8>::new());
    let mut first = 0;
    for (number, gear) in (0..).zip(gears) {
        for (element, width) in gear.elements.iter().zip(&gear.thicknesses) {
            connectivity.extend(element.nodes().iter().map(|node| first + u64::from(*node)));
            offsets.push(connectivity.len() as u64);
            types.push(match element.kind() {
                ElementKind::Quadrilateral => CellType::QuadraticQuad,
                ElementKind::Triangle => CellType::QuadraticTriangle,
            });
            thickness.push((1e3 * width) as f32);
            member.push(number);
        }
        first += gear.nodes.len() as u64;
    }
    let of_points = vec![
        named(DataArray::vectors("displacement_um"), displacement),
        named(DataArray::tensors("stress_mpa"), stress),
        named(DataArray::scalars("von_mises_mpa", 1), von_mises),
    ];
    let of_cells = vec![
        named(DataArray::scalars("thickness_mm", 1), thickness),
        named(DataArray::scalars("gear", 1), member),
    ];
    let grid = Vtk {
        version: Version::new(),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        file_path: None,
        data: DataSet::inline(UnstructuredGridPiece {
            points: points.into(),
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
