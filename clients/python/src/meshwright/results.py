"""Results as arrays, frames and plots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

def _array(values: list[float | None]) -> Array:
    """What is null on the wire is no number here."""
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


# How the ends of names say units, and how people write them.
_UNITS = (("_n_per_m", "N/m"), ("_n_per_mm", "N/mm"), ("_n_m", "N m"), ("_um", "µm"), ("_mm", "mm"), ("_deg", "deg"), ("_mpa", "MPa"), ("_n", "N"))


def _labeled(column: str) -> str:
    """The name of a column as an axis has it, with its unit."""
    for end, unit in _UNITS:
        if column.endswith(end):
            return f"{column.removesuffix(end).replace('_', ' ')} in {unit}"
    return column.replace("_", " ")


class Job(dict[str, Any]):
    """A job as the service tells it; what is asked most is an attribute too."""

    @property
    def id(self) -> str:
        return str(self["id"])

    @property
    def status(self) -> str:
        return str(self["status"])


class Curve:
    """The curves at one output torque. Units stand in the names; all arrays run over the same positions."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document

    @property
    def output_torque_n_m(self) -> float:
        return float(self.document["output_torque_n_m"])

    @property
    def mesh_position(self) -> Array:
        """In mesh periods, end excluded; 0 where the reference pair touches at the pitch point."""
        return self["mesh_position"]

    @property
    def transmission_error_um(self) -> Array:
        """Positive where load makes the driven gear lag."""
        return self["transmission_error_um"]

    @property
    def mesh_stiffness_tangent_n_per_m(self) -> Array:
        return self["mesh_stiffness_tangent_n_per_m"]

    @property
    def peak_contact_pressure_mpa(self) -> Array:
        """NaN where a sharp tip corner carries."""
        return self["peak_contact_pressure_mpa"]

    @property
    def columns(self) -> list[str]:
        """The names of the lists that run over the positions, in the order of the document."""
        count = len(self.document["mesh_position"])
        lists = ((name, value) for name, value in self.document.items() if name != "load_shares" and isinstance(value, list))
        return [name for name, value in lists if len(value) == count]

    @property
    def quantities(self) -> dict[str, float | None]:
        """The numbers of `GET /v1/quantities` by their names; empty in results of versions before 0.6."""
        quantities: dict[str, float | None] = self.document.get("quantities", {})
        return quantities

    @property
    def statistics(self) -> dict[str, Any]:
        statistics: dict[str, Any] = self.document["statistics"]
        return statistics

    def stress(self, gear: str) -> dict[str, Array]:
        """The largest stresses of the `driving` or `driven` gear, in MPa, and where they are; none unless they were asked for."""
        told: dict[str, list[float | None]] = self.document.get("stress", {}).get(gear, {})
        return {name: _array(values) for name, values in told.items()}

    def load_share(self, pair_offset: int) -> Array:
        """The share of the pair at an offset; zero for one that never carries."""
        for share in self.document["load_shares"]:
            if share["pair_offset"] == pair_offset:
                return _array(share["share"])
        return np.zeros_like(self.mesh_position)

    @property
    def face_load_factor(self) -> float | None:
        """K_Hbeta; none for methods that do not see the face, and at the torque 0."""
        factor = self.document.get("face", {}).get("face_load_factor")
        return None if factor is None else float(factor)

    @property
    def K_Hbeta(self) -> float | None:  # noqa: N802
        """The same by its symbol."""
        return self.face_load_factor

    @property
    def lead_cure(self) -> dict[str, float] | None:
        """The slope and crowning of the driving leads that would make K_Hbeta least, and what it would be; none where there is no face."""
        cure: dict[str, float] | None = self.document.get("face", {}).get("cure")
        return cure

    def order(self, label: str) -> float:
        """The amplitude of the transmission error, in um, at a named order such as `H_N` or `H_Z2`."""
        for line in self.document.get("spectrum", {}).get("named", []):
            if line["label"] == label:
                return float(line["transmission_error_um"])
        raise KeyError(f"the spectrum names no {label}")

    def __getitem__(self, column: str) -> Array:
        return _array(self.document[column])


class Results:
    """A results document, and its curves as arrays."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document
        self.curves = [Curve(curve) for curve in document["curves"]]
        self.job: Job | None = None
        """The job that computed it, with its id; none of a preview."""

    @property
    def pair(self) -> dict[str, Any]:
        """The derived geometry of the pair."""
        pair: dict[str, Any] = self.document["pair"]
        return pair

    def frame(self) -> pandas.DataFrame:
        """A row for each torque and position, with the stresses where they were asked for; `spectrum_frame` has the orders."""
        import pandas

        frames = []
        for curve in self.curves:
            columns = {name: curve[name] for name in curve.columns}
            for gear in ("driving", "driven"):
                columns |= {f"stress_{gear}_{name}": values for name, values in curve.stress(gear).items()}
            frames.append(pandas.DataFrame({"output_torque_n_m": curve.output_torque_n_m, **columns}))
        return pandas.concat(frames, ignore_index=True)

    def spectrum_frame(self) -> pandas.DataFrame:
        """A row for each torque and order."""
        import pandas

        frames = []
        for curve in self.curves:
            spectrum = curve.document.get("spectrum")
            if spectrum:
                columns = {name: values for name, values in spectrum.items() if name != "named"}
                frames.append(pandas.DataFrame({"output_torque_n_m": curve.output_torque_n_m, **columns}))
        return pandas.concat(frames, ignore_index=True) if frames else pandas.DataFrame()

    def plot(self, column: str = "transmission_error_um", axes: Axes | None = None) -> Axes:
        """Draws a column over the mesh position, a line for each torque."""
        from matplotlib import pyplot

        axes = pyplot.subplots()[1] if axes is None else axes
        for curve in self.curves:
            axes.plot(curve.mesh_position, curve[column], label=f"{curve.output_torque_n_m:g} N m")
        axes.set(xlabel="mesh position in mesh periods", ylabel=_labeled(column))
        axes.legend()
        return axes
