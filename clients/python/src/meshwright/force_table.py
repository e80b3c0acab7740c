"""Force tables: the force between the gears over the angle and the approach, for multibody codes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .results import Array


@dataclass(frozen=True)
class ForceTable:
    """The force F and the part ∂V/∂θ_1 of the torque, over a true period of the driving angle and over the approach δ = R_b1 θ_1 − R_b2 θ_2, in SI units.

    Angles grow in the sense in which each gear turns; F is zero in the backlash and negative on the other flank.
    """

    driving_angle_rad: Array
    approach_m: Array
    force_n: Array
    torque_n_m: Array
    base_radii_m: tuple[float, float]
    head: dict[str, str]

    @classmethod
    def parse(cls, text: str) -> ForceTable:
        """Reads the text of `force-table.txt`."""
        head: dict[str, str] = {}
        tables: dict[str, Array] = {}
        lines = iter(text.splitlines())
        for line in lines:
            if line.startswith("# "):
                name, _, value = line[2:].partition(": ")
                head[name] = value
            elif line.startswith("double "):
                name, _, size = line.removeprefix("double ").partition("(")
                tables[name] = _rows(lines, int(size.partition(",")[0]))
        if not {"force", "torque"} <= tables.keys():
            raise ValueError("this is no force table of Meshwright: it has the tables force and torque")
        force, torque = tables["force"], tables["torque"]
        radii = (float(head["driving_base_radius_m"]), float(head["driven_base_radius_m"]))
        return cls(force[1:, 0], force[0, 1:], force[1:, 1:], torque[1:, 1:], radii, head)

    def torques(self, driving_angle_rad: float, driven_angle_rad: float) -> tuple[float, float]:
        """The torques of the mesh on the driving and on the driven gear, in N m: the user force of a multibody code."""
        one, other = self.base_radii_m
        first, last = self.driving_angle_rad[0], self.driving_angle_rad[-1]
        row = _place(self.driving_angle_rad, first + (driving_angle_rad - first) % (last - first))
        column = _place(self.approach_m, one * driving_angle_rad - other * driven_angle_rad)
        force = _between(self.force_n, row, column)
        return -one * force - _between(self.torque_n_m, row, column), other * force


def _rows(lines: Iterator[str], count: int) -> Array:
    return np.array([[float(cell) for cell in next(lines).split()] for _ in range(count)], dtype=np.float64)


def _place(knots: Array, value: float) -> tuple[int, float]:
    """The stretch in which a value lies, and how far on; those at the ends go on beyond them."""
    i = min(max(int(np.searchsorted(knots, value, side="right")) - 1, 0), len(knots) - 2)
    return i, float((value - knots[i]) / (knots[i + 1] - knots[i]))


def _between(table: Array, row: tuple[int, float], column: tuple[int, float]) -> float:
    (i, x), (j, y) = row, column
    corners = table[i : i + 2, j : j + 2]
    return float(np.array([1.0 - x, x]) @ corners @ np.array([1.0 - y, y]))
