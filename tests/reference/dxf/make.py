#!/usr/bin/env python3
"""Draws the DXF files beside this one by ezdxf (PyPI), which has nothing of our reader: gears of our own as a laser shop and as a drawing office have them.
Of what ezdxf writes the unit, the blocks and the entities are kept."""

import math
import pathlib

import ezdxf
from ezdxf.math import BSpline, ConstructionArc, Vec3, bezier_to_bspline, cubic_bezier_from_arc, rational_bspline_from_arc

FOLDER = pathlib.Path(__file__).parent


def polar(radius, degrees):
    return Vec3(radius * math.cos(math.radians(degrees)), radius * math.sin(math.radians(degrees)), 0)


def write(document, name):
    """The file without the sections that say nothing of the drawing."""
    path = FOLDER / name
    document.saveas(path)
    lines = path.read_text(encoding="utf-8").splitlines()
    sections, at = {}, 0
    while at < len(lines):
        if lines[at : at + 2] == ["  0", "SECTION"]:
            end = lines.index("ENDSEC", at)
            sections[lines[at + 3]] = lines[at : end + 1]
            at = end
        at += 1
    unit = ["  0", "SECTION", "  2", "HEADER", "  9", "$INSUNITS", " 70", str(document.units), "  0", "ENDSEC"]
    kept = [unit, sections["BLOCKS"], sections["ENTITIES"], ["  0", "EOF"]]
    path.write_text("\n".join(line for section in kept for line in section) + "\n", encoding="utf-8")


def new():
    document = ezdxf.new("R2010", units=4)
    for block in list(document.blocks):
        if block.name.startswith("_"):
            document.blocks.delete_block(block.name, safe=False)
    return document, document.modelspace()


def add(space, curve):
    """A spline with its control points, its knots, and its weights if it has some."""
    spline = space.add_spline(degree=curve.degree)
    spline.control_points = curve.control_points
    spline.knots = curve.knots()
    if curve.weights():
        spline.weights = curve.weights()


def cubic(space, center, radius, start, end):
    """An arc as polynomials of degree 3, as many programs write it."""
    add(space, bezier_to_bspline(cubic_bezier_from_arc(center, radius, start, end)))


def laser():
    """12 teeth in splines through points of the involute, a bore of four splines, and openings of curves: a circle in four cubic splines, a kidney of a rational
    spline, ellipses and lines, an ellipse, and a stadium."""
    document, space = new()
    teeth, tip, root = 12, 52.0, 43.0
    base = 48.0 * math.cos(math.radians(20))
    half = 90 / teeth + math.degrees(math.tan(math.radians(20)) - math.radians(20))
    radii = [base + (tip - base) * i / 4 for i in range(5)]
    angle = lambda r: half - math.degrees(math.sqrt((r / base) ** 2 - 1) - math.acos(base / r))
    flank = [(r, angle(r)) for r in radii]
    for tooth in range(teeth):
        middle = 360 * tooth / teeth
        left = [polar(r, middle + a) for r, a in flank]
        right = [polar(r, middle - a) for r, a in flank]
        foot = [polar(root, middle + sign * half) for sign in (1, -1)]
        for points, low in ((left, foot[0]), (right, foot[1])):
            spline = space.add_spline(dxfattribs={"layer": "0"})
            spline.apply_construction_tool(ezdxf.math.fit_points_to_cad_cv(points))
            space.add_line(low, points[0])
        space.add_arc((0, 0), tip, middle - angle(tip), middle + angle(tip))
        cubic(space, (0, 0), root, middle + half, middle + 360 / teeth - half)
    for quarter in range(4):
        cubic(space, (0, 0), 8, 90 * quarter, 90 * quarter + 90)
    for quarter in range(4):
        cubic(space, polar(27, 0), 7, 90 * quarter, 90 * quarter + 90)
    # A kidney about the axis: radii 20 and 30, ends of radius 5 at 60 and 100 degrees.
    add(space, rational_bspline_from_arc((0, 0), 30, 60, 100))
    add(space, rational_bspline_from_arc((0, 0), 20, 60, 100))
    space.add_ellipse(polar(25, 60), major_axis=polar(5, 60), ratio=1, start_param=math.pi, end_param=2 * math.pi)
    cubic(space, polar(25, 100), 5, 100, 280)
    space.add_ellipse(polar(26, 180), major_axis=(9, 0, 0), ratio=0.5)
    # A stadium: lines as splines of degree 1 and 3.
    add(space, BSpline([(-4, -30), (4, -30)], order=2))
    add(space, BSpline([(4, -20), (1, -20), (-1, -20), (-4, -20)], order=4))
    space.add_arc((4, -25), 5, 270, 90)
    add(space, rational_bspline_from_arc((-4, -25), 5, 90, 270))
    write(document, "laser.dxf")


def office():
    """A gear at (150, 105) of its sheet: a block for each of eight holes, turned about the axis, a block in a block for slots in a polar row, a keyway in the bore, the rim
    drawn twice, and center lines and a pitch circle on a layer of their own."""
    document, space = new()
    center = Vec3(150, 105, 0)
    hole = document.blocks.new("HOLE", base_point=(2, 1))
    hole.add_circle((2, 1), 4)
    hole.add_line((-4, 1), (8, 1), dxfattribs={"layer": "CENTER"})
    slot = document.blocks.new("SLOT")
    slot.add_arc((-2, 0), 2, 90, 270)
    slot.add_line((-2, -2), (2, -2))
    slot.add_arc((2, 0), 2, -90, 90)
    slot.add_line((2, 2), (-2, 2))
    row = document.blocks.new("ROW")
    row.add_blockref("SLOT", (20, 0), dxfattribs={"rotation": 90, "layer": "OPENINGS"})
    for i in range(8):
        space.add_blockref("HOLE", center + polar(34, 45 * i), dxfattribs={"layer": "OPENINGS", "rotation": 30 * i})
    for i in range(6):
        space.add_blockref("ROW", center, dxfattribs={"rotation": 60 * i})
    document.blocks.new("NOTE").add_text("SCALE 2:1")
    space.add_blockref("NOTE", (0, 0), dxfattribs={"xscale": 2, "yscale": 2})
    space.add_circle(center, 47)
    space.add_circle(center, 47)
    # The bore with a keyway, 5 mm wide, up to 13 mm.
    half = math.degrees(math.asin(2.5 / 11))
    low = 11 * math.cos(math.radians(half))
    space.add_arc(center, 11, 90 + half, 450 - half)
    for a, b in (((2.5, low), (2.5, 13)), ((2.5, 13), (-2.5, 13)), ((-2.5, 13), (-2.5, low))):
        space.add_line(center + Vec3(a), center + Vec3(b))
    for way in ((55, 0), (0, 55)):
        space.add_line(center - Vec3(way), center + Vec3(way), dxfattribs={"layer": "CENTER"})
    space.add_circle(center, 34, dxfattribs={"layer": "CENTER"})
    write(document, "office.dxf")


laser()
office()
