#!/usr/bin/env bash
# meshio 5.3.5 takes the cylindrical coordinates of a Nastran file for x, y and z.
#
# Expected: points where the file puts them. The third field of GRID names the system of its coordinates (CP, Nastran quick reference guide); in a system
# of CORD2C these are radius, angle in degrees, and z. CORD2C is not read, CP arrives as "nastran:ref", a mere label, and radius and angle
# become x and y without a warning. A ring becomes a strip; areas, volumes and distances are wrong. Shifted or turned systems (CORD2R) are dropped too.
# Do instead: read with pyNastran and `xref=True`, whose `get_position` is in the basic system, or write the file in the basic system.
#
# Seen (a quarter of a ring, 20 to 60 mm, in six elements):
# meshio:      area 3600.0 mm^2, radius of the outer points 60.0 to 108.2 mm
# closed form: area 2484.7 mm^2, radius of the outer points 60.0 mm
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet meshio==5.3.5 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import contextlib
import io
import math
from pathlib import Path

import meshio
import numpy as np

assert meshio.__version__ == "5.3.5", meshio.__version__
PARTS, INNER, OUTER = 6, 20.0, 60.0
TURNS = [90 * part / PARTS for part in range(PARTS + 1)]

lines = ["CEND", "BEGIN BULK", "CORD2C,7,0,0.0,0.0,0.0,0.0,0.0,1.0,+C", "+C,1.0,0.0,0.0"]
lines += [f"GRID,{2 * k + n},7,{radius},{turn},0.0" for k, turn in enumerate(TURNS) for n, radius in ((1, INNER), (2, OUTER))]
lines += [f"CQUAD4,{k + 1},1,{2 * k + 1},{2 * k + 2},{2 * k + 4},{2 * k + 3}" for k in range(PARTS)]
Path("ring.bdf").write_text("\n".join([*lines, "PSHELL,1,1,1.0", "MAT1,1,210000.,,0.3", "ENDDATA", ""]))

said = io.StringIO()
with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
    mesh = meshio.read("ring.bdf")
assert said.getvalue().strip() == "", "it says something now: the finding has ended"


def area(points: np.ndarray) -> float:
    """The area of all elements."""
    corners = points[mesh.cells[0].data]
    across = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return float(np.linalg.norm(across, axis=1).sum() / 2)


true = np.array([(r * math.cos(math.radians(t)), r * math.sin(math.radians(t)), 0) for t in TURNS for r in (INNER, OUTER)])
exact = PARTS * (OUTER**2 - INNER**2) / 2 * math.sin(math.pi / 2 / PARTS)
outer = np.linalg.norm(mesh.points[1::2], axis=1)
print(f"meshio:      area {area(mesh.points):.1f} mm^2, radius of the outer points {outer.min():.1f} to {outer.max():.1f} mm")
print(f"closed form: area {exact:.1f} mm^2, radius of the outer points {OUTER:.1f} mm")
assert abs(area(true) / exact - 1) < 1e-12, "elements and order of the points are as written"
assert np.array_equal(mesh.points[:, :2], [(r, t) for t in TURNS for r in (INNER, OUTER)]), "the system is taken into account now: the finding has ended"
assert np.all(mesh.point_data["nastran:ref"] == 7)
PYTHON
