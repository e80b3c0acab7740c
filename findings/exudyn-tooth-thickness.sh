#!/usr/bin/env bash
# exudyn 1.13.6 draws involute gears whose teeth are too thick at the pitch circle, by 0.004 of its radius at 20 degrees.
#
# Expected: a tooth as thick as half of the pitch, pi m / 2, less half of `backlash` (the thickness of a reference tooth, ISO 21771). `InvoluteGear`
# centers the tooth by the first of its own points of the involute that lies beyond the pitch circle, not by the point on it. Points are
# 180 degrees / (`maxSteps` - 1) of roll apart. Two gears made so overlap at their distance, here by 0.24 mm; a `backlash` of some hundredths of the
# module does not help, and the excess jumps with the pressure angle.
# Do instead: pass `maxSteps=20000`, and a `tolerance` against too many points.
#
# Seen (module 2 mm, 20 degrees, thickness in mm):
# 20 teeth: 3.2222, pi m / 2 3.1416, with 20000 steps 3.1416
# 40 teeth: 3.3027, pi m / 2 3.1416, with 20000 steps 3.1416
# both together 6.5249, pitch 6.2832
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet exudyn==1.13.6 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import math
from importlib.metadata import version

import numpy as np
from exudyn.machines import InvoluteGear

assert version("exudyn") == "1.13.6", version("exudyn")
MODULE, ALPHA = 2.0, math.radians(20)


def thickness(teeth: int, **more: int) -> float:
    """The length of the arc of the pitch circle between both flanks of the tooth that the class draws."""
    gear = InvoluteGear(module=MODULE, nTeeth=teeth, pressureAngleDeg=20, **more)
    outline, angles = gear.GenerateTooth(), []
    for flank in np.array_split(outline, 2, axis=1):
        radius, angle = np.hypot(*flank), np.arctan2(flank[1], flank[0])
        order = np.argsort(radius, kind="stable")
        angles.append(np.interp(gear.pitchRadius, radius[order], angle[order]))
    return abs(angles[1] - angles[0]) * gear.pitchRadius


half = math.pi * MODULE / 2
# The polar angle of the involute at its first point beyond the pitch circle, less that at the pitch circle.
roll = math.ceil(math.tan(ALPHA) / (math.pi / 99)) * math.pi / 99
excess = (roll - math.atan(roll)) - (math.tan(ALPHA) - ALPHA)
total = 0.0
for teeth in (20, 40):
    drawn, fine = thickness(teeth), thickness(teeth, maxSteps=20000)
    total += drawn
    print(f"{teeth} teeth: {drawn:.4f}, pi m / 2 {half:.4f}, with 20000 steps {fine:.4f}")
    assert abs(fine / half - 1) < 1e-4, "a gear of many points is right"
    assert abs((drawn - half) / (MODULE * teeth * excess) - 1) < 0.05, "the tooth is as thick as it should be now: the finding has ended"
print(f"both together {total:.4f}, pitch {2 * half:.4f}")
assert total > 2 * half + 0.2
PYTHON
