#!/usr/bin/env bash
# opentorsion 0.3.2 gives a shaft of known stiffness six times the moment of inertia that it is told.
#
# Expected: `Shaft(k=..., I=...)`, "Moment of inertia of the shaft [kgm^2]", has the inertia I, so that the entries of its mass matrix add up to I: for two
# nodes I / 6 [[2, 1], [1, 2]]. A shaft of given length and diameter is made so. With `I` the division by 6 is missing, and frequencies of torsion
# in which the shaft's own inertia takes part are up to sqrt(6) too low.
# Do instead: give I / 6, or give length, diameter, G and density.
#
# Seen (500 mm of 50 mm steel, held at one end, 20 elements; closed form sqrt(k / I) / 4):
# by geometry: inertia 0.002454 kg m^2, first frequency 1581.5 Hz
# by k and I:  inertia 0.014726 kg m^2, first frequency 645.7 Hz
# closed form: inertia 0.002454 kg m^2, first frequency 1581.1 Hz
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet opentorsion==0.3.2 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import math
from importlib.metadata import version

import numpy as np
from opentorsion import Assembly, Disk, Shaft

assert version("opentorsion") == "0.3.2", version("opentorsion")
PARTS, LENGTH, DIAMETER, G, DENSITY, WALL = 20, 0.5, 0.05, 80e9, 8000.0, 1e6
AREA = math.pi * DIAMETER**4 / 32
STIFFNESS, INERTIA = G * AREA / LENGTH, DENSITY * AREA * LENGTH


def solved(shafts: list[Shaft]) -> tuple[float, float]:
    """The moment of inertia of the shafts and their first frequency of torsion in Hz, one end held by a disk that does not move."""
    assembly = Assembly(shafts, disk_elements=[Disk(0, I=WALL)])
    squares = np.sort(np.abs(assembly.undamped_modal_analysis()[0]))
    return float(assembly.M.sum() - WALL), float(math.sqrt(squares[1])) / (2 * math.pi)


geometry = solved([Shaft(i, i + 1, L=1e3 * LENGTH / PARTS, odl=1e3 * DIAMETER, G=G, rho=DENSITY) for i in range(PARTS)])
numbers = solved([Shaft(i, i + 1, k=STIFFNESS * PARTS, I=INERTIA / PARTS) for i in range(PARTS)])
exact = INERTIA, math.sqrt(STIFFNESS / INERTIA) / 4
for name, (inertia, hz) in (("by geometry:", geometry), ("by k and I: ", numbers), ("closed form:", exact)):
    print(f"{name} inertia {inertia:.6f} kg m^2, first frequency {hz:.1f} Hz")
assert abs(geometry[0] / exact[0] - 1) < 1e-6 and abs(geometry[1] / exact[1] - 1) < 1e-3, "a shaft of given geometry is right"
assert abs(numbers[0] / exact[0] - 6) < 1e-6, "the shaft has its inertia now: the finding has ended"
assert abs(exact[1] / numbers[1] / math.sqrt(6) - 1) < 1e-3
PYTHON
