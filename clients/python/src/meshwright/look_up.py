"""Look-up tables: mesh stiffness and transmission error over the angle, for rotor dynamics and multibody codes."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .results import Array

_REMARKS = ("#", "%")


@dataclass(frozen=True)
class LookUpTable:
    """One true period in SI units. The last row repeats the first, so that a reader may wrap at the last angle.

    Angles are those of the two gears from the position at which a pair of teeth touches at the pitch point, each growing in the
    sense in which its gear turns. The transmission error is a length along the line of action, positive where the driven gear lags.
    """

    driving_angle_rad: Array
    driven_angle_rad: Array
    mesh_stiffness_n_per_m: Array
    transmission_error_m: Array
    head: dict[str, str]

    @classmethod
    def parse(cls, text: str) -> LookUpTable:
        """Reads the text of `look-up-table.csv` or `look-up-table.txt`."""
        head: dict[str, str] = {}
        rows: list[list[float]] = []
        for line in text.splitlines():
            if line.startswith(_REMARKS):
                name, _, value = line[1:].strip().partition(": ")
                head[name] = value
            elif line and not line[0].isalpha():
                rows.append([float(cell) for cell in line.replace(",", " ").split()])
        if not rows or any(len(row) != 4 for row in rows):
            raise ValueError("this is no look-up table of Meshwright: its rows have four columns")
        columns = np.array(rows, dtype=np.float64).T
        return cls(columns[0], columns[1], columns[2], columns[3], head)

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> LookUpTable:
        """Reads a file."""
        return cls.parse(Path(path).read_text(encoding="utf-8"))

    @property
    def mean_stiffness_n_per_m(self) -> float:
        """Over the period, whose last row is its first again."""
        return float(self.mesh_stiffness_n_per_m[:-1].mean())

    def to_ross(self, mesh: Any) -> Any:
        """Gives a `ross` `Mesh` (ROSS 2.3 and 3.1) this stiffness: it interpolates over the angle of the driving gear and wraps at its end.

        Raises ValueError where that cannot take effect: with its backlash model on, ROSS takes the force from a table of its own.
        """
        if getattr(mesh, "backlash", None) is not None:
            raise ValueError("with backlash enabled, ROSS takes the mesh force from a stiffness table of its own, and this one would have no effect: make the Mesh without backlash")
        mesh.theta_range = self.driving_angle_rad
        mesh.stiffness_range = self.mesh_stiffness_n_per_m
        mesh.stiffness = self.mean_stiffness_n_per_m
        return mesh
