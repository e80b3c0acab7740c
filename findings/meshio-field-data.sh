#!/usr/bin/env bash
# meshio 5.3.5 reads the field data of a VTU file, and writes a VTU file without them.
#
# Expected: a file that was read and written says the same. Field data hold what is of the whole grid, such as the torque or the time of a result
# (VTK file formats: `FieldData` before the pieces). They are read into `field_data`, and writing drops them without a warning.
# Do instead: keep such numbers beside the file, or as point data.
#
# Seen:
# read:    {'torque_n_m': [115.0]}
# written: {} and said: nothing
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet meshio==5.3.5 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import contextlib
import io
import tempfile
from pathlib import Path

import meshio

TORQUE = 115.0
FILE = f"""<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid>
<FieldData><DataArray type="Float64" Name="torque_n_m" NumberOfTuples="1" format="ascii">{TORQUE}</DataArray></FieldData>
<Piece NumberOfPoints="4" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">9</DataArray></Cells></Piece>
</UnstructuredGrid></VTKFile>"""

assert meshio.__version__ == "5.3.5", meshio.__version__
with tempfile.TemporaryDirectory() as folder:
    first, second = Path(folder, "first.vtu"), Path(folder, "second.vtu")
    first.write_text(FILE)
    mesh = meshio.read(first)
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        mesh.write(second)
    again = meshio.read(second)
    print("read:   ", {name: values.tolist() for name, values in mesh.field_data.items()})
    print("written:", again.field_data, "and said:", said.getvalue().strip() or "nothing")
    assert mesh.field_data["torque_n_m"].tolist() == [TORQUE]
    assert again.field_data == {}, "field data are written now: the finding has ended"
    assert "FieldData" not in second.read_text(errors="replace")
    assert said.getvalue().strip() == ""
PYTHON
