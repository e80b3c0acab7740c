#!/usr/bin/env bash
# SolidsPy 1.1.0.post1 tells stresses at nodes of quadrilaterals that belong to other points: a beam in bending seems to bear half of its stress, or none.
#
# Expected: what its documentation of `strain_nodes` says, values extrapolated from the points of Gauss to the nodes and averaged. Instead each node gets
# the value of one point of Gauss of each element, at 0.58 of the way to a corner, and not of the nearest: nodes go around the element, the points go row
# by row, so that two of four corners get the value of the opposite side. With one row of elements across a beam in bending, both signs meet in each
# node and cancel; with two, half of the stress is left.
# Do instead: evaluate B times the displacements at the nodes (`femutil.elast_diff_2d` at r, s = -1 and 1) and average.
#
# Seen (pure bending, bottom edge, MPa at x = 0 1 2 3 4 mm):
# SolidsPy, 1 row:  -57.7 0.0 0.0 0.0 57.7
# SolidsPy, 2 rows: -78.9 -50.0 -50.0 -50.0 -21.1
# at the nodes:     -100.0 -100.0 -100.0 -100.0 -100.0
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet solidspy==1.1.0.post1 meshio==3.0.0 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PYTHON'
from importlib.metadata import version

import numpy as np
from solidspy import femutil
from solidspy.postprocesor import strain_nodes

assert version("solidspy") == "1.1.0.post1", version("solidspy")
ALONG, E, STRESS = 4, 200e3, 100.0
GAUSS = 1 / np.sqrt(3)


def bent(rows: int) -> tuple[np.ndarray, np.ndarray]:
    """The stresses along the bottom edge of a beam of so many rows of elements: as SolidsPy tells them, and evaluated at the nodes."""
    corner = lambda i, j: j * (ALONG + 1) + i  # noqa: E731
    nodes = np.array([[corner(i, j), i, 2 * j / rows - 1, 0, 0] for j in range(rows + 1) for i in range(ALONG + 1)], float)
    around = [[corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)] for j in range(rows) for i in range(ALONG)]
    elements = np.array([[number, 1, 0, *each] for number, each in enumerate(around)])
    x, y = nodes[:, 1], nodes[:, 2]
    # Bending of a material that does not shrink across: the strain along x is y times a constant, and elements of four nodes follow u exactly.
    moved = np.column_stack([STRESS / E * x * y, np.zeros(len(x))])
    told = strain_nodes(nodes, elements, np.array([[E, 0.0]]), moved)[1][:, 0]
    total, count = np.zeros(len(x)), np.zeros(len(x))
    for each in around:
        for node, (r, s) in zip(each, ((-1, -1), (1, -1), (1, 1), (-1, 1))):
            b = femutil.elast_diff_2d(r, s, nodes[each, 1:3], femutil.shape_quad4)[1]
            total[node] += E * (b @ moved[each].ravel())[0]
            count[node] += 1
    assert np.allclose(total / count, STRESS * y), "the closed form of bending"
    return told[: ALONG + 1], (total / count)[: ALONG + 1]


for rows, parts in ((1, [GAUSS, 0, 0, 0, -GAUSS]), (2, [(1 + GAUSS) / 2, 0.5, 0.5, 0.5, (1 - GAUSS) / 2])):
    told, right = bent(rows)
    print(f"SolidsPy, {rows} row{'s:' if rows > 1 else ': '}", *(f"{value + 0.0:.1f}" for value in told.round(9)))
    assert np.allclose(told, -STRESS * np.array(parts)), "the stress belongs to its node now: the finding has ended"
print("at the nodes:    ", *(f"{value:.1f}" for value in right))
PYTHON
