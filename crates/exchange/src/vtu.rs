//! Displacements and stresses of both gears, and natural modes of one, as VTK unstructured grids, which ParaView, PyVista and meshio read.

use std::io::{self, BufWriter, Write};
use std::iter;

pub use super::piece::{Piece, Wave};
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use meshwright_engine::vibration::ModeShape;

/// Writes the driving and the driven gear as one grid, in binary XML. It is written number by number, so that no more of it is in memory than the gears.
///
/// At points: `displacement_um` against the hub of the gear, `stress_mpa` (a symmetric tensor), `von_mises_mpa`, in single precision. In cells: `gear`, 0
/// for the driving and 1 for the driven one, and of plates `thickness_mm`.
///
/// # Errors
///
/// Errors of `out`.
pub fn write(gears: [Piece<'_>; 2], out: impl Write) -> io::Result<()> {
    let points = || points_of(&gears);
    let count = points().count();
    let cells = || cells_of(&gears);
    let mut file = File(BufWriter::new(out));
    file.begin(&gears, &[])?;
    let displacements = points().flat_map(|(gear, i)| gear.values(i).displacement);
    file.vectors("displacement_um", count, displacements)?;
    let stresses = points().flat_map(|(gear, i)| gear.values(i).stress);
    file.array(
        "stress_mpa",
        ("Float32", 9),
        9 * count,
        stresses.map(single),
    )?;
    let von_mises = points().map(|(gear, i)| gear.values(i).von_mises);
    file.array(
        "von_mises_mpa",
        ("Float32", 1),
        count,
        von_mises.map(single),
    )?;
    file.0.write_all(b"</PointData><CellData>")?;
    let members = (0_u8..)
        .zip(gears)
        .flat_map(|(member, gear)| iter::repeat_n([member], gear.cells()));
    file.array("gear", ("UInt8", 1), cells().count(), members)?;
    if cells()
        .next()
        .is_some_and(|(gear, i)| gear.thickness(i).is_some())
    {
        let thicknesses = cells().filter_map(|(gear, i)| gear.thickness(i));
        file.array(
            "thickness_mm",
            ("Float32", 1),
            cells().count(),
            thicknesses.map(single),
        )?;
    }
    file.0.write_all(b"</CellData>")?;
    file.end(&gears)
}

/// Writes a natural mode as a grid: its cosine, and its sine if it has one. The largest displacement of either is 1 µm.
///
/// At points: `displacement_um`, and `displacement_sine_um` of a double mode. In the field: `frequency_hz`, and `modal_mass_kg` for these displacements over
/// 1 µm.
///
/// # Errors
///
/// Errors of `out`.
pub fn write_mode(shape: &ModeShape, out: impl Write) -> io::Result<()> {
    let scale = shape.largest();
    let wave = |part| Piece::Wave(Wave { shape, part, scale });
    let waves = [wave(0), wave(1)];
    let cosine = &waves[..1];
    let shown = if shape.mode.is_double { 2 } else { 1 };
    let numbers = [
        ("frequency_hz", shape.mode.frequency),
        ("modal_mass_kg", scale.powi(-2)),
    ];
    let mut file = File(BufWriter::new(out));
    file.begin(cosine, &numbers)?;
    let names = ["displacement_um", "displacement_sine_um"];
    for (name, wave) in names.into_iter().zip(waves).take(shown) {
        let displacements = (0..wave.points()).flat_map(|i| wave.values(i).displacement);
        file.vectors(name, wave.points(), displacements)?;
    }
    file.0.write_all(b"</PointData>")?;
    file.end(cosine)
}

/// All points, each with its piece.
fn points_of<'a>(pieces: &[Piece<'a>]) -> impl Iterator<Item = (Piece<'a>, usize)> {
    let pieces = pieces.iter().copied();
    pieces.flat_map(|piece| (0..piece.points()).map(move |i| (piece, i)))
}

/// All cells, each with its piece.
fn cells_of<'a>(pieces: &[Piece<'a>]) -> impl Iterator<Item = (Piece<'a>, usize)> {
    let pieces = pieces.iter().copied();
    pieces.flat_map(|piece| (0..piece.cells()).map(move |i| (piece, i)))
}

fn single(number: f64) -> [u8; 4] {
    (number as f32).to_le_bytes()
}

/// A file that is written array by array.
struct File<W: Write>(BufWriter<W>);

impl<W: Write> File<W> {
    /// Begins a grid of these pieces, with single numbers beside it, up to the arrays of its points.
    fn begin(&mut self, pieces: &[Piece<'_>], numbers: &[(&str, f64)]) -> io::Result<()> {
        self.0.write_all(
            br#"<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64"><UnstructuredGrid>"#,
        )?;
        if !numbers.is_empty() {
            self.0.write_all(b"<FieldData>")?;
            for (name, number) in numbers {
                let value = iter::once(number.to_le_bytes());
                self.array(name, ("Float64", 1), 1, value)?;
            }
            self.0.write_all(b"</FieldData>")?;
        }
        let (points, cells) = (points_of(pieces).count(), cells_of(pieces).count());
        write!(
            self.0,
            r#"<Piece NumberOfPoints="{points}" NumberOfCells="{cells}"><PointData>"#
        )
    }

    /// Writes an array of vectors at points.
    fn vectors(
        &mut self,
        name: &str,
        count: usize,
        numbers: impl Iterator<Item = f64>,
    ) -> io::Result<()> {
        self.array(name, ("Float32", 3), 3 * count, numbers.map(single))
    }

    /// Ends the grid of these pieces with its points and cells.
    fn end(mut self, pieces: &[Piece<'_>]) -> io::Result<()> {
        let (points, cells) = (points_of(pieces).count(), cells_of(pieces).count());
        self.0.write_all(b"<Points>")?;
        let at = points_of(pieces).flat_map(|(piece, i)| piece.values(i).place);
        self.vectors("Points", points, at)?;
        self.0.write_all(b"</Points><Cells>")?;
        let corners = cells_of(pieces)
            .map(|(piece, i)| piece.cell(i).1.len())
            .sum();
        let firsts = pieces.iter().scan(0, |next, piece| {
            let first = *next;
            *next += piece.points() as u64;
            Some((first, *piece))
        });
        let connectivity = firsts.flat_map(|(first, piece)| {
            let nodes = (0..piece.cells()).flat_map(move |i| piece.cell(i).1);
            nodes.map(move |node| (first + u64::from(*node)).to_le_bytes())
        });
        self.array("connectivity", ("UInt64", 1), corners, connectivity)?;
        let ends = cells_of(pieces).scan(0_u64, |end, (piece, i)| {
            *end += piece.cell(i).1.len() as u64;
            Some(end.to_le_bytes())
        });
        self.array("offsets", ("UInt64", 1), cells, ends)?;
        let shapes = cells_of(pieces).map(|(piece, i)| [piece.cell(i).0]);
        self.array("types", ("UInt8", 1), cells, shapes)?;
        self.0
            .write_all(b"</Cells></Piece></UnstructuredGrid></VTKFile>")?;
        self.0.flush()
    }

    /// Writes `count` numbers of a type of VTK, so many of which belong together.
    fn array<const BYTES: usize>(
        &mut self,
        name: &str,
        (kind, components): (&str, usize),
        count: usize,
        numbers: impl Iterator<Item = [u8; BYTES]>,
    ) -> io::Result<()> {
        write!(self.0, r#"<DataArray type="{kind}" Name="{name}""#)?;
        // meshio makes a table of one column of numbers of which it is told that each stands alone.
        if kind == "Float64" {
            // A number beside the grid.
            write!(self.0, r#" NumberOfTuples="{count}""#)?;
        }
        if components > 1 {
            write!(self.0, r#" NumberOfComponents="{components}""#)?;
        }
        self.0.write_all(br#" format="binary">"#)?;
        let mut encoder = EncoderWriter::new(&mut self.0, &STANDARD);
        encoder.write_all(&((count * BYTES) as u64).to_le_bytes())?;
        for number in numbers {
            encoder.write_all(&number)?;
        }
        encoder.finish()?;
        drop(encoder);
        self.0.write_all(b"</DataArray>")
    }
}

#[cfg(test)]
mod tests {
    use meshwright_engine::gear::Vector;
    use meshwright_engine::grid::Element;
    use vtkio::model::{Attribute, DataSet, IOBuffer, Piece as Inline, Vtk};

    use super::*;
    use meshwright_engine::analysis::fields::GearField;

    /// A plate of one square, whose numbers are told apart by `sign`.
    fn square(sign: f64) -> GearField {
        let places = [
            (0.0, 0.0),
            (1.0, 0.0),
            (1.0, 1.0),
            (0.0, 1.0),
            (0.5, 0.0),
            (1.0, 0.5),
            (0.5, 1.0),
            (0.0, 0.5),
        ];
        GearField {
            nodes: places.map(|(x, y)| sign * Vector::new(x, y)).to_vec(),
            displacements: places
                .map(|(x, y)| sign * 1e-6 * Vector::new(y, x))
                .to_vec(),
            stresses: places.map(|(x, y)| [x * 1e6, y * 1e6, sign * 1e6]).to_vec(),
            von_mises: places.map(|(x, _)| (2.0 + sign * x) * 1e6).to_vec(),
            elements: vec![Element::quadrilateral([0, 1, 2, 3, 4, 5, 6, 7])],
            thicknesses: vec![0.02 + 0.01 * sign],
            edges: Vec::new(),
        }
    }

    /// vtkio reads it, which has a hand of its own in the format.
    #[test]
    fn what_is_written_is_read_by_another_program_as_the_numbers_of_both_gears() {
        let gears = [square(1.0), square(-1.0)];
        let mut text = Vec::new();
        write(gears.each_ref().map(Piece::Plate), &mut text).expect("memory takes it");
        let read = Vtk::parse_xml(&*text).expect("the format is right");
        let DataSet::UnstructuredGrid { pieces, .. } = read.data else {
            panic!("an unstructured grid");
        };
        let Inline::Inline(grid) = &pieces[0] else {
            panic!("it stands in the file");
        };
        let all = |numbers: fn(&GearField) -> Vec<f64>| -> Vec<f32> {
            gears
                .iter()
                .flat_map(numbers)
                .map(|number| number as f32)
                .collect()
        };
        let floats =
            |buffer: &IOBuffer| buffer.clone().into_vec::<f32>().expect("single precision");
        let named = |attributes: &[Attribute], name: &str| {
            let found = attributes.iter().find_map(|attribute| match attribute {
                Attribute::DataArray(array) if array.name == name => Some(array.data.clone()),
                _ => None,
            });
            found.unwrap_or_else(|| panic!("{name}"))
        };
        let points = |name| floats(&named(&grid.data.point, name));
        assert_eq!(
            floats(&grid.points),
            all(|gear| gear
                .nodes
                .iter()
                .flat_map(|at| [1e3 * at.x, 1e3 * at.y, 0.0])
                .collect())
        );
        assert_eq!(
            points("displacement_um"),
            all(|gear| gear
                .displacements
                .iter()
                .flat_map(|u| [1e6 * u.x, 1e6 * u.y, 0.0])
                .collect())
        );
        assert_eq!(
            points("stress_mpa"),
            all(|gear| {
                let tensor = |[xx, yy, xy]: &[f64; 3]| {
                    [*xx, *xy, 0.0, *xy, *yy, 0.0, 0.0, 0.0, 0.0].map(|it| it / 1e6)
                };
                gear.stresses.iter().flat_map(tensor).collect()
            })
        );
        assert_eq!(
            points("von_mises_mpa"),
            all(|gear| gear.von_mises.iter().map(|it| it / 1e6).collect())
        );
        assert_eq!(
            floats(&named(&grid.data.cell, "thickness_mm")),
            [30.0, 10.0]
        );
        assert_eq!(
            named(&grid.data.cell, "gear").into_vec::<u8>(),
            Some(vec![0, 1])
        );
        let (nodes, ends) = grid.cells.cell_verts.clone().into_xml();
        assert_eq!((nodes, ends), ((0..16).collect(), vec![8, 16]));
        assert_eq!(grid.cells.types, [vtkio::model::CellType::QuadraticQuad; 2]);
    }
}
