"""The CalculiX deck of one position: two gears, their contact, a hub that is held and one that carries the torque.

Plane stress is written as plane strain with E (1 + 2 nu)/(1 + nu)^2 and nu/(1 + nu), which is the same thing in two
dimensions; CalculiX's own plane-stress elements are wedges that are not. The thickness is 1 mm, loads are per millimeter.
"""

import numpy as np

from grid import key

# CalculiX's sides of a triangle are those of the grid, counted from 1.
SIDE = ("S1", "S2", "S3")


# By whether a step is solved sharply. CalculiX's own criterion, 0.5 % of residual, leaves contacts undecided; a step that
# only prepares the next one may leave a tenth of the correction and of the number of contact points.
CONTROLS = {
    True: "*CONTROLS, PARAMETERS=FIELD\n1e-5, 1e-3, , , 2e-2, 1e-5, 1e-3, 1e-8\n"
    "*CONTROLS, PARAMETERS=CONTACT\n0.001, 0.1, 100, 60\n",
    False: "*CONTROLS, PARAMETERS=FIELD\n1e-3, 1e-2, , , 2e-2, 1e-5, 1e-3, 1e-8\n"
    "*CONTROLS, PARAMETERS=CONTACT\n0.1, 0.1, 100, 60\n",
}


def plane_stress_as_plane_strain(e, nu):
    return e * (1 + 2 * nu) / (1 + nu) ** 2, nu / (1 + nu)


def region_thickness(gear, region, face_width):
    """Thickness of a region of the blank over the face width: 0 rim, 1 web, 2 hub."""
    return gear.web.thickness / face_width if gear.web and region == 1 else 1.0


def contact_edges(grid, gear, n):
    """Sides (triangle, side) of the loaded flank of tooth n, a tip rounding included.

    The tip land is left out: no pressure can act on it beyond a sharp corner, but CalculiX would find points under the
    corner to lie under the land too, and push them out sideways.
    """
    tooth = n % gear.z
    found = []
    for edge in grid.edges:
        if edge.tooth == tooth and edge.loaded_side and edge.name in ("flank", "rounding", "fillet"):
            found += grid.sides[key(*edge.ends)]
    return found


def number(value):
    """A number in at most 20 characters, of which CalculiX reads no more: a longer one would lose its exponent."""
    return f"{value:.12g}"


def turning_hub(pair, grid, hub, first):
    """Ties the bore of the driven gear to dof 1 of node `hub`, which is rb2 times the hub's rotation."""
    tied = []
    for n in grid.edge_nodes("bore"):
        x, y = (grid.nodes[n] - pair.centers[1]) / pair.driven.rb
        for dof, factor in ((1, y), (2, -x)):
            tied.append(f"*EQUATION\n2\n{first + n}, {dof}, 1., {hub}, 1, {number(factor)}\n")
    return tied


def pull_of_rotation(pair, grids, speed):
    """Centrifugal loads of both gears about their axes, the driving one at `speed` in 1/s."""
    for which, (gear, grid) in enumerate(zip(pair.gears, grids)):
        square = (speed * pair.driving.z / gear.z) ** 2
        x, y = pair.centers[which]
        for region in np.unique(grid.regions):
            yield f"G{which}R{region}, CENTRIF, {number(square)}, {number(x)}, {number(y)}, 0., 0., 0., 1.\n"


def write_deck(path, pair, grids, pairs, steps, contact_stiffness, printed=()):
    """Writes the deck.

    `pairs` are the tooth pairs in reach, `steps` the load F (N) of each step, whether it is to be solved sharply, and the
    angular speed of the driving gear (1/s), `printed` the node sets (name, gear, nodes) whose displacements are printed.
    """
    offset = (0, len(grids[0].nodes))
    element_offset = (0, len(grids[0].triangles))
    hub = offset[1] + len(grids[1].nodes) + 1
    with open(path, "w") as out:
        out.write("*NODE, NSET=NALL\n")
        for which, grid in enumerate(grids):
            out.writelines(f"{offset[which] + k + 1}, {number(x)}, {number(y)}, 0\n" for k, (x, y) in enumerate(grid.nodes))
        out.write(f"{hub}, {pair.center_distance}, 0, 0\n*NSET, NSET=HUB\n{hub}\n")
        for which, (gear, grid) in enumerate(zip(pair.gears, grids)):
            for region in np.unique(grid.regions):
                name = f"G{which}R{region}"
                out.write(f"*ELEMENT, TYPE=CPE6, ELSET={name}\n")
                for k in np.flatnonzero(grid.regions == region):
                    nodes = ", ".join(str(offset[which] + n + 1) for n in grid.triangles[k])
                    out.write(f"{element_offset[which] + k + 1}, {nodes}\n")
                e, nu = plane_stress_as_plane_strain(gear.youngs_modulus, gear.poisson_ratio)
                e *= region_thickness(gear, region, pair.face_width)
                density = gear.density * region_thickness(gear, region, pair.face_width)
                out.write(f"*MATERIAL, NAME=M{name}\n*ELASTIC\n{number(e)}, {number(nu)}\n*DENSITY\n{number(density)}\n")
                out.write(f"*SOLID SECTION, ELSET={name}, MATERIAL=M{name}\n1.\n")
        out.write("*BOUNDARY\n")
        out.writelines(f"{n + 1}, 1, 2\n" for n in grids[0].edge_nodes("bore"))
        out.write(f"{hub}, 2, 3\n")
        out.writelines(turning_hub(pair, grids[1], hub, offset[1] + 1))
        for k, n in enumerate(pairs):
            for which, name in enumerate(("SLAVE", "MASTER")):
                out.write(f"*SURFACE, NAME={name}{k}, TYPE=ELEMENT\n")
                for element, side in contact_edges(grids[which], pair.gears[which], n):
                    out.write(f"{element_offset[which] + element + 1}, {SIDE[side]}\n")
        out.write(f"*SURFACE INTERACTION, NAME=TOUCH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{contact_stiffness:g}\n")
        for k in range(len(pairs)):
            out.write(f"*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE\nSLAVE{k}, MASTER{k}\n")
        for name, which, nodes in printed:
            out.write(f"*NSET, NSET={name}\n")
            out.writelines(f"{offset[which] + n + 1},\n" for n in nodes)
        for force, settled, speed in steps:
            out.write("*STEP, INC=60\n*STATIC\n1., 1., 1e-4, 1.\n")
            out.write(CONTROLS[settled])
            out.write(f"*CLOAD\n{hub}, 1, {number(force / pair.face_width)}\n")
            out.write("*DLOAD, OP=NEW\n")
            if speed:
                out.writelines(pull_of_rotation(pair, grids, speed))
            out.write("*NODE PRINT, NSET=HUB, FREQUENCY=999\nU\n")
            for name, _, _ in printed:
                out.write(f"*NODE PRINT, NSET={name}, FREQUENCY=999\nU\n")
            for k in range(len(pairs)):
                out.write(f"*CONTACT PRINT, SLAVE=SLAVE{k}, MASTER=MASTER{k}, FREQUENCY=999\nCF\n")
            out.write("*CONTACT PRINT, FREQUENCY=999\nCSTR\n")
            out.write("*END STEP\n")
