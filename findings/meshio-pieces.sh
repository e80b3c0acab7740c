#!/usr/bin/env bash
# meshio 5.3.5 reads a VTU file of several pieces with the points of all pieces and the cells of the last one alone.
#
# Expected: the cells of every piece. An UnstructuredGrid may have any number of pieces, each with points and cells of its own (VTK file formats, XML),
# and programs that compute in parallel write one for each process. The file is read without a warning. An integral over the
# cells is that of the last piece, and all other points belong to no cell.
# Do instead: merge the pieces before (pyvista, vtkXMLUnstructuredGridReader), or compare the number of cells with `NumberOfCells`.
#
# Seen:
# 1 pieces: 4 points, cells [[0, 1, 2, 3]]
# 2 pieces: 8 points, cells [[4, 5, 6, 7]]
# 3 pieces: 12 points, cells [[8, 9, 10, 11]]
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet meshio==5.3.5 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import tempfile
from pathlib import Path

import meshio

PIECE = """<Piece NumberOfPoints="4" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{x} 0 0 {y} 0 0 {y} 1 0 {x} 1 0</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">9</DataArray></Cells></Piece>"""


def file_of(pieces: int) -> str:
    """Unit squares side by side, one for each piece."""
    squares = "\n".join(PIECE.format(x=i, y=i + 1) for i in range(pieces))
    return (
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">'
        f"<UnstructuredGrid>{squares}</UnstructuredGrid></VTKFile>"
    )


assert meshio.__version__ == "5.3.5", meshio.__version__
with tempfile.TemporaryDirectory() as folder:
    for pieces in (1, 2, 3):
        path = Path(folder, "squares.vtu")
        path.write_text(file_of(pieces))
        mesh = meshio.read(path)
        cells = [cell for block in mesh.cells for cell in block.data.tolist()]
        print(f"{pieces} pieces: {len(mesh.points)} points, cells {cells}")
        assert len(mesh.points) == 4 * pieces
        last = 4 * (pieces - 1)
        assert cells == [[last, last + 1, last + 2, last + 3]], "every piece has its cell now: the finding has ended"
PYTHON
