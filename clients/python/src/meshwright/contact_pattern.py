"""Where the flanks of a pair touch, and how they press there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]


class ContactPattern:
    """The largest pressure over the period on both flanks, and the lines of contact at each position, torque by torque."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document

    @property
    def output_torques_n_m(self) -> list[float]:
        return [float(curve["output_torque_n_m"]) for curve in self.document["curves"]]

    @property
    def z_mm(self) -> Array:
        """The middles of strips of the common face, from its middle."""
        return np.array(self.document["z_mm"], dtype=np.float64)

    def diameter_mm(self, gear: str) -> Array:
        """The middles of bands of the height of the flank of the `driving` or `driven` gear."""
        return np.array(self.document[gear]["diameter_mm"], dtype=np.float64)

    def pressure_mpa(self, gear: str, curve: int = 0) -> Array:
        """The largest pressure over the period, a row for each diameter: 0 where nothing touches, infinite where a sharp tip edge carries."""
        rows = self.document["curves"][curve][gear]["pressure_mpa"]
        return np.array([[np.inf if value is None else value for value in row] for row in rows], dtype=np.float64)

    def lines(self, curve: int = 0) -> list[dict[str, Any]]:
        """The lines of contact at each told mesh position."""
        positions: list[dict[str, Any]] = self.document["curves"][curve]["positions"]
        return positions

    def plot(self, gear: str = "driving", curve: int = 0, axes: Axes | None = None) -> Axes:
        """The pressure by color over the face and the diameter."""
        import matplotlib.pyplot as plt

        axes = axes if axes is not None else plt.figure().add_subplot()
        pressure = self.pressure_mpa(gear, curve)
        shown = np.ma.masked_where((pressure == 0.0) | np.isinf(pressure), pressure)
        colors = axes.pcolormesh(self.z_mm, self.diameter_mm(gear), shown, vmin=0.0)
        axes.figure.colorbar(colors, ax=axes, label="contact pressure in MPa")
        axes.set(xlabel="z in mm", ylabel="diameter in mm", title=f"{gear} flank, {self.output_torques_n_m[curve]:g} N m")
        return axes
