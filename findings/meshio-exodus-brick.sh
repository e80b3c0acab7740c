#!/usr/bin/env bash
# meshio 5.3.5 reads and writes bricks of 20 nodes in Exodus files with eight nodes in the places of eight others.
#
# Expected: each node in the middle of its own edge. meshio's "hexahedron20" has the order of VTK: bottom, top, upright edges. HEX20 of Exodus has bottom,
# upright, top (Exodus II manual, "HEX"). meshio takes one for the other, as it does not for Nastran and Gmsh. The corners are right, so that the mesh
# looks right, but elements are turned inside out: volume, integrals and stiffness are wrong. Others read a file that meshio wrote wrong the same way.
# Do instead: put the nodes in order after reading, and before writing: columns 0 to 11, 16 to 19, 12 to 15.
#
# Seen (a cube of side 1):
# as read:      8 of 12 nodes not in the middle of their edges, volume -0.2444, det J from -5.03 to 2.03 of a cube's
# put in order: 0 of 12 nodes not in the middle of their edges, volume 1.0000, det J from 1.00 to 1.00 of a cube's
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet meshio==5.3.5 netCDF4==1.7.4 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
from itertools import product

import meshio
import netCDF4
import numpy as np

assert meshio.__version__ == "5.3.5", meshio.__version__
CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
BOTTOM, TOP, UPRIGHT = [(0, 1), (1, 2), (2, 3), (3, 0)], [(4, 5), (5, 6), (6, 7), (7, 4)], [(0, 4), (1, 5), (2, 6), (3, 7)]
VTK_EDGES, EXODUS_EDGES = BOTTOM + TOP + UPRIGHT, BOTTOM + UPRIGHT + TOP
IN_ORDER = [*range(12), *range(16, 20), *range(12, 16)]


def middles(edges: list[tuple[int, int]]) -> np.ndarray:
    """The middles of edges of the cube."""
    return np.array([(CORNERS[a] + CORNERS[b]) / 2 for a, b in edges])


def write(name: str) -> None:
    """A file of one HEX20, as the manual orders it."""
    with netCDF4.Dataset(name, "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.version, file.api_version, file.floating_point_word_size = np.float32(5.1), np.float32(5.1), 8
        for dimension, size in (("num_dim", 3), ("num_nodes", 20), ("num_elem", 1), ("num_el_blk", 1), ("num_el_in_blk1", 1), ("num_nod_per_el1", 20)):
            file.createDimension(dimension, size)
        for axis, values in zip("xyz", np.vstack([CORNERS, middles(EXODUS_EDGES)]).T):
            file.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = values
        connect = file.createVariable("connect1", "i4", ("num_el_in_blk1", "num_nod_per_el1"))
        connect.elem_type = "HEX20"
        connect[:] = np.arange(1, 21)


def determinants(nodes: np.ndarray) -> np.ndarray:
    """det J of a brick of the order of VTK, over that of the cube, at 4 x 4 x 4 points of Gauss."""
    signs = 2 * np.vstack([CORNERS, middles(VTK_EDGES)]) - 1
    # The terms of the shape functions of 20 nodes; the functions are 1 at their own node and 0 at all others.
    powers = [p for p in product(range(3), repeat=3) if sum(e for e in p if e > 1) <= 2]
    shape = np.linalg.inv([[np.prod(sign**p) for p in powers] for sign in signs])
    points = list(product(np.polynomial.legendre.leggauss(4)[0], repeat=3))

    def slope(point: tuple[float, ...], p: tuple[int, ...], axis: int) -> float:
        parts = [e * x ** max(e - 1, 0) if k == axis else x**e for k, (x, e) in enumerate(zip(point, p))]
        return float(np.prod(parts))

    return np.array([8 * np.linalg.det(nodes.T @ shape.T @ [[slope(x, p, k) for k in range(3)] for p in powers]) for x in points])


write("brick.e")
mesh = meshio.read("brick.e")
assert mesh.cells[0].type == "hexahedron20"
cell = mesh.points[mesh.cells[0].data[0]]
weights = np.array([np.prod(w) for w in product(np.polynomial.legendre.leggauss(4)[1], repeat=3)]) / 8
for name, nodes, wrong in (("as read:     ", cell, 8), ("put in order:", cell[IN_ORDER], 0)):
    away = np.linalg.norm(nodes[8:] - middles(VTK_EDGES), axis=1) > 1e-9
    j = determinants(nodes)
    print(f"{name} {away.sum()} of 12 nodes not in the middle of their edges, volume {j @ weights:.4f}, det J from {j.min():.2f} to {j.max():.2f} of a cube's")
    assert away.sum() == wrong, "the order is right now: the finding has ended"
    assert (j.min() > 0.999) == (wrong == 0)
mesh.write("again.e")
with netCDF4.Dataset("again.e") as file:
    assert np.array_equal(np.asarray(file["connect1"][0]), np.arange(1, 21)), "it is written as it was read"
PYTHON
