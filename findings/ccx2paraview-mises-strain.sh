#!/usr/bin/env bash
# ccx2paraview 3.2.0 writes an equivalent strain of von Mises, `E_Mises`, that is 1.5 times what it should be.
#
# Expected: sqrt(2/3 e:e) with the deviator e of the strain, so that a bar that yields in tension has its axial strain as equivalent strain, and an
# elastic material has stress = 3 G strain for both equivalents. The converter computes it by the formula of the stress, sqrt(3/2 s:s). In tension of
# a material that keeps its volume the equivalent strain is then larger than the largest strain; a limit of strain seems to be reached at 2/3 of it.
# Do instead: multiply `E_Mises` and `MESTRAIN_Mises` by 2/3, or compute them from the components of `E`. `S_Mises` is right.
#
# Seen (tension, axial strain 0.01; elastic with Poisson's ratio 0.3, then plastic):
# elastic: E_Mises 0.013000, sqrt(2/3 e:e) 0.008667, S_Mises / 3 G 0.008667
# plastic: E_Mises 0.015000, sqrt(2/3 e:e) 0.010000
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet ccx2paraview==3.2.0 vtk==9.5.2 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import math
from importlib.metadata import version
from pathlib import Path

import vtk
from ccx2paraview import Converter

assert version("ccx2paraview") == "3.2.0", version("ccx2paraview")
AXIAL, E = 0.01, 210000.0
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def block(name: str, components: str, values: list[float]) -> list[str]:
    """A block of nodal results of a tensor, the same at all nodes (CalculiX GraphiX manual, "Nodal Results Block")."""
    pairs = [(1, 1), (2, 2), (3, 3), (1, 2), (2, 3), (3, 1)]
    head = ["  100CL  101 1.000000000           8                     0    1           1", f" -4  {name:8s}    6    1"]
    head += [f" -5  {components}{'XYZ'[i - 1]}{'XYZ'[j - 1]}         1    4    {i}    {j}" for i, j in pairs]
    return [*head, *(f" -1{n:10d}" + "".join(f"{v:12.5E}" for v in values) for n in range(1, 9)), " -3"]


def told(across: float) -> tuple[float, float]:
    """The equivalent strain and stress that the converter makes of a brick in tension, strained by -`across` to the sides."""
    lines = ["    1C", f"    2C{8:30d}{1:38d}", *(f" -1{n:10d}" + "".join(f"{v:12.5E}" for v in x) for n, x in enumerate(CORNERS, 1)), " -3"]
    lines += [f"    3C{1:30d}{1:38d}", " -1         1    1    0    1", " -2" + "".join(f"{n:10d}" for n in range(1, 9)), " -3"]
    lines += block("TOSTRAIN", "E", [AXIAL, -across, -across, 0, 0, 0]) + block("STRESS", "S", [E * AXIAL, 0, 0, 0, 0, 0])
    Path("bar.frd").write_text("\n".join([*lines, " 9999", ""]))
    Converter("bar.frd", ["vtu"]).run()
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName("bar.vtu")
    reader.Update()
    data = reader.GetOutput().GetPointData()
    return data.GetArray("E_Mises").GetValue(0), data.GetArray("S_Mises").GetValue(0)


def equivalent(across: float) -> float:
    """The equivalent strain of the same brick: sqrt(2/3 e:e)."""
    strains = [AXIAL, -across, -across]
    mean = sum(strains) / 3
    return math.sqrt(2 / 3 * sum((strain - mean) ** 2 for strain in strains))


(elastic, stress), (plastic, _) = told(0.3 * AXIAL), told(0.5 * AXIAL)
by_stress = stress / (3 * E / 2.6)
print(f"elastic: E_Mises {elastic:.6f}, sqrt(2/3 e:e) {equivalent(0.3 * AXIAL):.6f}, S_Mises / 3 G {by_stress:.6f}")
print(f"plastic: E_Mises {plastic:.6f}, sqrt(2/3 e:e) {equivalent(0.5 * AXIAL):.6f}")
assert abs(by_stress / equivalent(0.3 * AXIAL) - 1) < 1e-6, "the stress and the definition of the strain agree"
assert abs(equivalent(0.5 * AXIAL) / AXIAL - 1) < 1e-6, "a bar that yields has its axial strain"
for value, across in ((elastic, 0.3 * AXIAL), (plastic, 0.5 * AXIAL)):
    assert abs(value / equivalent(across) - 1.5) < 1e-6, "the strain is right now: the finding has ended"
PYTHON
