#!/usr/bin/env bash
# VTK 9.5.2 measures and integrates a quadratic cell in straight pieces.
#
# Expected: the area of the curved cell, because VTK_QUADRATIC_QUAD has the shape functions that its eight points say (VTK file formats, non-linear
# cells). vtkCellSizeFilter and vtkIntegrateAttributes, behind "Cell Size" and "Integrate Variables" of ParaView, divide it by its points into
# triangles, whose sides are chords. A quarter of a ring between the radii 1 and 2 as one cell loses 9 % of its area, and every integral over it.
# Do instead: integrate by the shape functions, or divide the cells before (vtkTessellatorFilter with its error metrics).
#
# Seen:
# vtkCellSizeFilter 2.1213, vtkIntegrateAttributes 2.1213, shape functions 2.3284, ring 2.3562
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet vtk==9.5.2 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import math

import numpy as np
import vtk

QUARTER = math.pi / 2
# Radius and angle of the corners, counter-clockwise, and of the middles of the sides between them.
POINTS = [(1, 0), (2, 0), (2, 1), (1, 1), (1.5, 0), (2, 0.5), (1.5, 1), (1, 0.5)]
PLACES = np.array([(r * math.cos(QUARTER * part), r * math.sin(QUARTER * part)) for r, part in POINTS])


def measured() -> tuple[float, float]:
    """The area of the cell by either filter."""
    grid, points, ids = vtk.vtkUnstructuredGrid(), vtk.vtkPoints(), vtk.vtkIdList()
    points.SetDataTypeToDouble()
    for x, y in PLACES:
        ids.InsertNextId(points.InsertNextPoint(x, y, 0))
    grid.SetPoints(points)
    grid.InsertNextCell(vtk.VTK_QUADRATIC_QUAD, ids)

    def area(found: vtk.vtkAlgorithm) -> float:
        found.SetInputData(grid)
        found.Update()
        return found.GetOutput().GetCellData().GetArray("Area").GetValue(0)

    return area(vtk.vtkCellSizeFilter()), area(vtk.vtkIntegrateAttributes())


def by_shape_functions() -> float:
    """The area of the cell as its shape functions bend it, by Gauss points."""

    def jacobian(x: float, y: float) -> float:
        slopes = [(s * (1 + y * t) * (2 * x * s + y * t) / 4, t * (1 + x * s) * (2 * y * t + x * s) / 4) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        slopes += [(-x * (1 - y), -(1 - x * x) / 2), ((1 - y * y) / 2, -y * (1 + x)), (-x * (1 + y), (1 - x * x) / 2), (-(1 - y * y) / 2, -y * (1 - x))]
        return float(np.linalg.det(PLACES.T @ np.array(slopes)))

    places, weights = np.polynomial.legendre.leggauss(5)
    return sum(u * v * jacobian(x, y) for x, u in zip(places, weights) for y, v in zip(places, weights))


version = vtk.vtkVersion().GetVTKVersion()
assert version == "9.5.2", version
size, integral = measured()
curved, ring = by_shape_functions(), 3 * math.pi / 4
print(f"vtkCellSizeFilter {size:.4f}, vtkIntegrateAttributes {integral:.4f}, shape functions {curved:.4f}, ring {ring:.4f}")
assert abs(curved / ring - 1) < 0.015, "the parabola through three points of the arc is that near to it"
# Chords: half of the sines of 45 degrees, twice, times 2^2 - 1^2.
assert abs(size - 3 * math.sin(QUARTER / 2)) < 1e-9, "the cell is measured otherwise now: the finding has ended"
assert abs(integral - size) < 1e-9
PYTHON
