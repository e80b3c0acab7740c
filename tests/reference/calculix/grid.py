"""Finite-element grid of a whole gear: six-node triangles, fine where asked, mid-side nodes on the true outline.

The outline is divided here, by the same size field that gmsh obeys inside, so that gmsh only fills polygons.
"""

from dataclasses import dataclass, field
from math import pi

import gmsh
import numpy as np

from gears import polar, rotate


# The angle by which a curve may turn along one edge.
LARGEST_TURN = pi / 6
# Below this least Jacobian over twice the straight area a triangle counts as folded.
LEAST_JACOBIAN = 0.05


@dataclass
class Sizes:
    """Element size over the plane: the least of `coarse` by depth below the root circle and of discs that grow outward."""

    center: np.ndarray
    root_radius: float
    tooth: float
    body: float
    growth: float = 0.35
    # Rows of x, y, radius, size.
    discs: list = field(default_factory=list)

    def add(self, point, radius, size):
        self.discs.append((float(point[0]), float(point[1]), radius, size))

    def __call__(self, points):
        points = np.atleast_2d(points)
        depth = self.root_radius - np.hypot(*(points - self.center).T)
        size = np.clip(self.tooth + self.growth * depth, self.tooth, self.body)
        for x, y, radius, least in self.discs:
            distance = np.hypot(points[:, 0] - x, points[:, 1] - y) - radius
            size = np.minimum(size, least + self.growth * np.clip(distance, 0.0, None))
        return size

    def callback(self):
        """The field as a function of one point, for gmsh, which calls it very often."""
        discs = np.array(self.discs).reshape(-1, 4)
        x0, y0, r0, h0 = discs.T.copy()
        cx, cy = self.center

        def size(dim, tag, x, y, z, lc):
            depth = self.root_radius - np.sqrt((x - cx) ** 2 + (y - cy) ** 2)
            coarse = min(max(self.tooth + self.growth * depth, self.tooth), self.body)
            if not len(x0):
                return coarse
            distance = np.sqrt((x - x0) ** 2 + (y - y0) ** 2) - r0
            return min(coarse, float(np.min(h0 + self.growth * np.maximum(distance, 0.0))))

        return size


@dataclass
class Edge:
    """An edge of the outline: its ends, its middle, and the names of the curve that it lies on."""

    ends: tuple
    middle: np.ndarray
    name: str
    tooth: int = None
    loaded_side: bool = None


@dataclass
class Grid:
    """Nodes (numbered from 0), six-node triangles, the region of each triangle, and the edges of the outline.

    Corners are counter-clockwise; node 3 lies between corners 0 and 1, 4 between 1 and 2, 5 between 2 and 0.
    """

    nodes: np.ndarray
    triangles: np.ndarray
    regions: np.ndarray
    edges: list
    # For each pair of corner nodes: its mid-side node, and its (triangle, side) pairs.
    middles: dict
    sides: dict

    def edge_nodes(self, name):
        chosen = set()
        for edge in self.edges:
            if edge.name == name:
                chosen.update((*edge.ends, self.middles[key(*edge.ends)]))
        return sorted(chosen)


def key(i, j):
    return (i, j) if i < j else (j, i)


class Outline:
    """Points and edges of closed curves, divided by a size field."""

    def __init__(self, sizes):
        self.sizes, self.points, self.edges = sizes, [], []

    def loop(self, curves):
        """Adds a closed loop of (curve, edge attributes) and returns the numbers of its edges, in order."""
        start = len(self.points)
        first_edge = len(self.edges)
        for curve, attributes in curves:
            t = self.divide(curve)
            points, middles = curve(t[:-1]), curve((t[1:] + t[:-1]) / 2)
            for point, middle in zip(points, middles):
                k = len(self.points)
                self.points.append(point)
                self.edges.append(Edge((k, k + 1), middle, **attributes))
        last = self.edges[-1]
        last.ends = (last.ends[0], start)
        return range(first_edge, len(self.edges))

    def divide(self, curve):
        """Parameters that divide a curve into edges as long as the field asks, none turning by much."""
        t = np.linspace(0.0, 1.0, 801)
        points = curve(t)
        steps = np.diff(points, axis=0)
        length = np.hypot(*steps.T)
        turning = np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))).sum()
        wanted = np.concatenate([[0.0], np.cumsum(length / self.sizes((points[1:] + points[:-1]) / 2))])
        count = max(1, int(round(wanted[-1])), int(np.ceil(turning / LARGEST_TURN)))
        return np.interp(np.linspace(0.0, wanted[-1], count + 1), wanted, t)


def circle(center, radius, start=0.0):
    return lambda t: center + polar(radius, start + 2 * pi * np.asarray(t, float))


def tooth_curves(gear, tooth, angle, center):
    """The outline of one tooth counter-clockwise, from root land to root land, with the attributes of its edges."""
    turned = gear.pitch_deviations.get(tooth, 0.0) / gear.rb

    def placed(curve, turn, side):
        def point(t):
            t = np.asarray(t, float)
            local = curve(t) * np.array([1.0, side])
            theta = angle + turned * turn(t)
            c, s = np.cos(theta), np.sin(theta)
            return center + np.stack(
                [c * local[..., 0] - s * local[..., 1], s * local[..., 0] + c * local[..., 1]], axis=-1
            )

        return point

    half = gear.half_profile()
    curves = []
    for name, curve, turn in half:
        curves.append((placed(curve, turn, -1.0), dict(name=name, tooth=tooth, loaded_side=False)))
    for name, curve, turn in reversed(half):
        back = placed(curve, turn, 1.0)
        curves.append((lambda t, back=back: back(1 - np.asarray(t, float)), dict(name=name, tooth=tooth, loaded_side=True)))
    return curves


def gear_grid(pair, which, eta, sizes, fine_teeth, extra_turn=0.0):
    """The grid of gear `which` of the pair at mesh position eta, turned counter-clockwise by `extra_turn`.

    A curved edge can fold its triangle, usually at a sharp fillet. There the grid is made finer on the teeth (by number)
    that have to be true, and the edge straight on the others.
    """
    for _ in range(20):
        grid = divided(pair, which, eta, sizes, extra_turn)
        straighten(grid, fine_teeth)
        folded = np.flatnonzero(relative_jacobians(grid) < LEAST_JACOBIAN)
        if not len(folded):
            return grid
        for corners in grid.nodes[grid.triangles[folded, :3]]:
            reach = np.hypot(*(corners - corners.mean(axis=0)).T).max()
            sizes.add(corners.mean(axis=0), reach, 0.6 * reach)
    raise RuntimeError(f"triangles at {grid.nodes[grid.triangles[folded, 0]]} stay folded")


def straighten(grid, fine_teeth):
    """Moves the middles of edges that fold a triangle onto their chords, except on the given teeth."""
    folded = set(np.flatnonzero(relative_jacobians(grid) < LEAST_JACOBIAN))
    for edge in grid.edges:
        ends = key(*edge.ends)
        if edge.tooth is not None and edge.tooth not in fine_teeth and any(t in folded for t, _ in grid.sides[ends]):
            grid.nodes[grid.middles[ends]] = (grid.nodes[ends[0]] + grid.nodes[ends[1]]) / 2


def divided(pair, which, eta, sizes, extra_turn):
    gear, center = pair.gears[which], pair.centers[which]
    outline = Outline(sizes)
    # Tooth n of the driving gear lies clockwise of tooth 0, that of the driven gear counter-clockwise.
    tooth_sense = -1 if which == 0 else 1
    zero = pair.tooth_angle(which, eta, 0) + extra_turn
    around = []
    for k in range(gear.z):
        around += tooth_curves(gear, (tooth_sense * k) % gear.z, zero + 2 * pi * k / gear.z, center)
    outer = outline.loop(around)

    bounds = [outer]
    if gear.web:
        bounds += [
            outline.loop([(circle(center, r), dict(name="web"))]) for r in (gear.web.outer_radius, gear.web.inner_radius)
        ]
    bore = outline.loop([(circle(center, gear.bore), dict(name="bore"))])
    bounds.append(bore)
    holes = []
    for hole in gear.holes:
        middle = center + polar(hole.circle_radius, zero + hole.angle)
        holes.append((hole, outline.loop([(circle(middle, hole.radius), dict(name="hole"))])))

    # Regions from the rim inwards: each is bounded by one circle outside, one inside, and the holes in it.
    regions = []
    for k, (outside, inside) in enumerate(zip(bounds, bounds[1:])):
        in_it = [edges for hole, edges in holes if region_of(hole, gear) == k]
        regions.append([outside, inside, *in_it])
    return fill(outline, regions, sizes)


def region_of(hole, gear):
    """0 for the rim (or a blank without a web), 1 for the web, 2 for the hub."""
    if not gear.web:
        return 0
    inner, outer = hole.circle_radius - hole.radius, hole.circle_radius + hole.radius
    if inner > gear.web.outer_radius:
        return 0
    if inner > gear.web.inner_radius and outer < gear.web.outer_radius:
        return 1
    if outer < gear.web.inner_radius:
        return 2
    raise ValueError("a hole crosses the edge of the web")


def fill(outline, regions, sizes):
    """Lets gmsh fill the regions with triangles and makes them of second order."""
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setNumber("Mesh.Algorithm", 6)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
        geo = gmsh.model.geo
        for k, (x, y) in enumerate(outline.points):
            geo.addPoint(x, y, 0.0, tag=k + 1)
        for k, edge in enumerate(outline.edges):
            geo.addLine(edge.ends[0] + 1, edge.ends[1] + 1, tag=k + 1)
            geo.mesh.setTransfiniteCurve(k + 1, 2)
        loops = {}
        for region, bounds in enumerate(regions):
            for edges in bounds:
                if edges not in loops:
                    loops[edges] = geo.addCurveLoop([k + 1 for k in edges])
            geo.addPlaneSurface([loops[edges] for edges in bounds], tag=region + 1)
        geo.synchronize()
        gmsh.model.mesh.setSizeCallback(sizes.callback())
        gmsh.model.mesh.generate(2)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        number = {int(tag): k for k, tag in enumerate(tags)}
        nodes = coordinates.reshape(-1, 3)[:, :2]
        corners, region_of_triangle = [], []
        for region in range(len(regions)):
            _, _, found = gmsh.model.mesh.getElements(2, region + 1)
            triangles = np.array([number[int(tag)] for tag in found[0]]).reshape(-1, 3)
            corners.append(triangles)
            region_of_triangle.append(np.full(len(triangles), region))
    finally:
        gmsh.finalize()
    return second_order(outline, nodes, np.concatenate(corners), np.concatenate(region_of_triangle))


def second_order(outline, nodes, corners, regions):
    """Six-node triangles; edges of the outline get their middles from the true curve."""
    a, b, c = (nodes[corners[:, k]] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    corners = np.where((area < 0)[:, None], corners[:, ::-1], corners)
    at = {tuple(np.round(point, 9)): k for k, point in enumerate(nodes)}
    for edge in outline.edges:
        edge.ends = tuple(at[tuple(np.round(outline.points[end], 9))] for end in edge.ends)
    true_middle = {key(*edge.ends): edge.middle for edge in outline.edges}

    points, middles, sides, triangles = list(nodes), {}, {}, []
    for number, triangle in enumerate(corners):
        mids = []
        for side in range(3):
            ends = key(int(triangle[side]), int(triangle[(side + 1) % 3]))
            if ends not in middles:
                middles[ends] = len(points)
                points.append(true_middle.get(ends, (nodes[ends[0]] + nodes[ends[1]]) / 2))
            mids.append(middles[ends])
            sides.setdefault(ends, []).append((number, side))
        triangles.append([*map(int, triangle), *mids])
    missing = [edge for edge in outline.edges if key(*edge.ends) not in sides]
    if missing:
        raise RuntimeError(f"gmsh lost {len(missing)} edges of the outline")
    return Grid(np.array(points), np.array(triangles), regions, outline.edges, middles, sides)


def relative_jacobians(grid):
    """The least Jacobian of each triangle over its corners and middles, over twice its straight area."""
    x = grid.nodes[grid.triangles]
    straight = cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    relative = []
    for r, s in ((0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5)):
        j = np.einsum("kd,ekx->edx", shape_gradients(r, s), x)
        relative.append(cross(j[:, 0], j[:, 1]) / straight)
    return np.min(relative, axis=0)


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def shape_gradients(r, s):
    """Derivatives of the six shape functions by the triangle's coordinates r and s; shape (6, 2)."""
    t = 1 - r - s
    return np.array(
        [
            [1 - 4 * t, 1 - 4 * t],
            [4 * r - 1, 0.0],
            [0.0, 4 * s - 1],
            [4 * (t - r), -4 * r],
            [4 * s, 4 * r],
            [-4 * s, 4 * (t - s)],
        ]
    )
