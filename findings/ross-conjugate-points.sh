#!/usr/bin/env bash
# ROSS 2.3.0 takes the varying stiffness of a gear mesh from points of the two flanks that do not touch each other.
#
# Expected: at each turn the points where a pair of teeth touches on the line of action. Their rolling lengths r_b tan(alpha) add up to the length between
# the points where that line touches the base circles, a sin(alpha_w), whatever the turn (involute gears, ISO 21771). `Mesh` adds the turn to the
# pressure angle itself, not to its tangent, and begins where the driving gear's own involute begins, not where the tip of the other gear meets it.
# The two points are some tenths to two millimeters apart, and the mean stiffness is 2 to 6 % high by the same formulas of compliance.
# Do instead: pass a mean `gear_mesh_stiffness` of another source, or add up `_compute_stiffness` at conjugate points.
#
# Seen (module 2 mm, 20 degrees; mm at three turns, mean stiffness in MN/m):
# 62/62: line 42.410, points 41.847 41.511 41.847, stiffness 254.8, at conjugate points 249.6
# 20/60: line 27.362, points 26.783 26.178 26.700, stiffness 313.9, at conjugate points 302.0
# 60/20: line 27.362, points 26.110 25.566 26.231, stiffness 319.6, at conjugate points 302.0
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet ross-rotordynamics==2.3.0 plotly==5.24.1 numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PYTHON'
from importlib.metadata import version

import numpy as np
from ross.gear_element import GearElementTVMS, Mesh
from ross.materials import steel

assert version("ross-rotordynamics") == "2.3.0", version("ross-rotordynamics")
ALPHA = np.radians(20)


def gear(teeth: int, node: int) -> GearElementTVMS:
    """A spur gear of steel, module 2 mm, as wide as its bore is: 20 mm."""
    return GearElementTVMS(n=node, material=steel, width=0.02, bore_diameter=0.02, module=0.002, n_teeth=teeth, pr_angle=ALPHA)


for teeth in ((62, 62), (20, 60), (60, 20)):
    one, two = gear(teeth[0], 0), gear(teeth[1], 1)
    mesh = Mesh(one, two)
    line = (one.base_radius + two.base_radius) * np.tan(ALPHA)
    first, last = (one.pr_angles_dict[name] for name in ("start_point", "addendum"))
    turns = np.array([0, 0.5, 1]) * (last - first)
    # As `_angular_equivalent_stiffness` places them.
    points = one.base_radius * np.tan(first + turns) + two.base_radius * np.tan(two.pr_angles_dict["addendum"] - mesh.gear_ratio * turns)

    begin, end = line - two.base_radius * np.tan(two.pr_angles_dict["addendum"]), one.base_radius * np.tan(last)

    def of_pair(roll: float) -> float:
        """The stiffness of the pair that touches at a rolling length of the driving gear, by the same compliances."""
        if not begin <= roll <= end:
            return 0.0
        each = (gear_._compute_stiffness(np.arctan(length / gear_.base_radius)) for gear_, length in ((one, roll), (two, line - roll)))
        return 1 / (1 / mesh.hertzian_stiffness + sum(1 / k for k in each))

    pitch = 2 * np.pi * one.base_radius / teeth[0]
    conjugate = np.mean([of_pair(begin + t * pitch) + of_pair(begin + (t + 1) * pitch) for t in (np.arange(200) + 0.5) / 200])
    told = np.mean(mesh.stiffness_range)
    spread = " ".join(f"{1e3 * p:.3f}" for p in points)
    print(f"{teeth[0]}/{teeth[1]}: line {1e3 * line:.3f}, points {spread}, stiffness {told / 1e6:.1f}, at conjugate points {conjugate / 1e6:.1f}")
    assert abs((end - begin) / pitch / mesh.contact_ratio - 1) < 1e-9, "the path of contact is that of its own contact ratio"
    assert np.all(line - points > 0.4e-3) and told / conjugate > 1.015, "the points meet now: the finding has ended"
PYTHON
