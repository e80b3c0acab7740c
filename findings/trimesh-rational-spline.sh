#!/usr/bin/env bash
# trimesh 5.2.0 reads a rational spline of a DXF drawing as if all its weights were 1, so that a circle comes out up to 6 % too large.
#
# Expected: the curve of the drawing. SPLINE has a weight (group code 41) for each control point (DXF reference); programs that write all curves as NURBS
# draw circles and arcs by weights 1 and cos(a / 2). Without them the curve bulges toward its control points. Bores, fillets and outlines are too large,
# with area and moments of them, and nothing is said.
# Do instead: let ezdxf flatten the splines, or have the drawing written with arcs.
#
# Seen (circle of radius 50 mm in nine control points):
# trimesh: radius 50.000 to 53.033 mm, area 8333.3 mm^2
# ezdxf:   radius 50.000 to 50.000 mm, area 7853.8 mm^2
# circle:  radius 50 mm, area 7854.0 mm^2
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet trimesh==5.2.0 ezdxf==1.4.2 numpy==2.4.6 scipy==1.17.1 networkx==3.6.1 shapely==2.2.0
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import math

import ezdxf
import numpy as np
import trimesh

assert trimesh.__version__ == "5.2.0", trimesh.__version__
RADIUS, SIDE = 50.0, math.sqrt(0.5)
CORNERS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]


def told(points: np.ndarray) -> tuple[float, float, float]:
    """The smallest and largest radius of a closed line, and its area."""
    radii, (x, y) = np.linalg.norm(points, axis=1), points.T
    return float(radii.min()), float(radii.max()), abs(float(x[:-1] @ y[1:] - x[1:] @ y[:-1])) / 2


doc = ezdxf.new("R2010")
doc.units = 4
spline = doc.modelspace().add_rational_spline(
    [(RADIUS * x, RADIUS * y, 0) for x, y in CORNERS], [1, SIDE] * 4 + [1], degree=2, knots=[0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
)
doc.saveas("circle.dxf")
path = trimesh.load_path("circle.dxf")
[entity] = path.entities
by_trimesh = told(entity.discrete(path.vertices, count=2001)[:, :2])
by_ezdxf = told(np.array([(point.x, point.y) for point in spline.flattening(1e-3)]))
circle = math.pi * RADIUS**2
for name, (low, high, area) in (("trimesh:", by_trimesh), ("ezdxf:  ", by_ezdxf)):
    print(f"{name} radius {low:.3f} to {high:.3f} mm, area {area:.1f} mm^2")
print(f"circle:  radius {RADIUS:.0f} mm, area {circle:.1f} mm^2")
assert abs(by_ezdxf[2] / circle - 1) < 1e-3, "the drawing is a circle"
# Without weights a quarter is the parabola of its three control points: middle (p0 + 2 p1 + p2) / 4, that is 3/4 of the corner's distance.
assert abs(by_trimesh[1] / (0.75 * RADIUS * math.sqrt(2)) - 1) < 1e-4, "the weights are read now: the finding has ended"
assert abs(by_trimesh[2] / (RADIUS**2 * (2 + 4 / 3)) - 1) < 1e-3
PYTHON
