"""Stress along the loaded root fillets, from the displacements of their nodes.

The fillet is free of traction, so that its state is uniaxial: the stress along it is E times the strain along it, the von
Mises stress is its magnitude, and where it is tensile it is the greatest principal stress too. The strain is taken at the
two Gauss points of each quadratic edge, where its error is one order smaller.
"""

from math import sqrt

import numpy as np

from gears import rotate
from grid import key

GAUSS = (-1 / sqrt(3), 1 / sqrt(3))
GEARS = ("driving", "driven")


def set_name(which, n):
    # CalculiX's names take no minus.
    return f"FILLET{which}T{n + 1000}"


def fillet_edges(pair, grid, which, n):
    tooth = n % pair.gears[which].z
    return [e for e in grid.edges if e.tooth == tooth and e.loaded_side and e.name in ("fillet", "land")]


def fillet_sets(pair, position):
    """The node sets (name, gear, nodes) whose displacements are wanted."""
    sets = []
    for n in position.near:
        for which, grid in enumerate(position.grids):
            nodes = set()
            for edge in fillet_edges(pair, grid, which, n):
                nodes.update((*edge.ends, grid.middles[key(*edge.ends)]))
            sets.append((set_name(which, n), which, sorted(nodes)))
    return sets


def fillet_stress(pair, position, eta, printed):
    """For each gear and tooth pair: place and stress along the loaded fillet, from the flank to the middle of the land.

    Angles are from the tooth's centerline towards its loaded flank, arcs from the form circle.
    """
    base = int(np.floor(eta))
    found = []
    for n in position.near:
        for which, grid in enumerate(position.grids):
            gear = pair.gears[which]
            first = 1 + (len(position.grids[0].nodes) if which else 0)
            displacement = {node - first: u for node, u in printed[set_name(which, n)].items()}
            turn = pair.tooth_angle(which, eta, n) + which * position.built_in / gear.rb
            points, stresses = [], []
            for edge in fillet_edges(pair, grid, which, n):
                nodes = [edge.ends[0], grid.middles[key(*edge.ends)], edge.ends[1]]
                x = rotate(grid.nodes[nodes] - pair.centers[which], -turn)
                u = rotate(np.array([displacement[k] for k in nodes]), -turn)
                for xi in GAUSS:
                    shape = np.array([xi * (xi - 1) / 2, 1 - xi**2, xi * (xi + 1) / 2])
                    slope = np.array([xi - 0.5, -2 * xi, xi + 0.5])
                    along, stretch = slope @ x, slope @ u
                    points.append(shape @ x)
                    stresses.append(gear.youngs_modulus * (along @ stretch) / (along @ along))
            points, stresses = np.array(points), np.array(stresses)
            start = gear.fillet(gear.flank_start[0])
            steps = np.hypot(*np.diff(np.vstack([start, points]), axis=0).T)
            k, tensile = int(np.argmax(np.abs(stresses))), int(np.argmax(stresses))
            angle = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
            found.append(
                {
                    "gear": GEARS[which],
                    "pair": str(base - n),
                    "largest_von_mises_mpa": round(float(abs(stresses[k])), 2),
                    "largest_at_angle_deg": round(float(angle[k]), 4),
                    "largest_at_radius_mm": round(float(np.hypot(*points[k])), 4),
                    "largest_principal_mpa": round(float(stresses[tensile]), 2),
                    "largest_principal_at_angle_deg": round(float(angle[tensile]), 4),
                    "angle_deg": [round(float(v), 4) for v in angle],
                    "radius_mm": [round(float(v), 4) for v in np.hypot(*points.T)],
                    "arc_from_form_circle_mm": [round(float(v), 4) for v in np.cumsum(steps)],
                    "tangential_stress_mpa": [round(float(v), 2) for v in stresses],
                }
            )
    return found
