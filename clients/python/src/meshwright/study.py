"""The table of a study, and what a population comes to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas

# Shorter names of columns.
_SHORT = {
    "mean_um": "transmission_error_um.mean",
    "rms_um": "transmission_error_um.rms",
    "peak_to_peak_um": "transmission_error_um.peak_to_peak",
    "mean_stiffness_n_per_m": "mesh_stiffness_tangent_n_per_m.mean",
}


class StudyTable:
    """A row for each design, as the service gives it; `frame` has a row for each design and torque."""

    def __init__(
        self,
        document: dict[str, Any],
        population: dict[str, Any] | None = None,
        search: dict[str, Any] | None = None,
        best: dict[str, Any] | None = None,
        quantities: Sequence[dict[str, Any]] = (),
    ) -> None:
        self.document = document
        self.quantities = quantities
        self.rows: list[dict[str, Any]] = document["rows"]
        self.search = search
        self._population = population
        self._best = best

    def best(self) -> dict[str, Any]:
        """The submission of the best design that a search found; how good it is stands in `search["best"]`."""
        if self.search is None:
            raise ValueError("the designs of this study were not searched for")
        if self._best is None:
            raise ValueError("no design of this search could be had; its refusals say why")
        return self._best

    def front(self) -> pandas.DataFrame:
        """The front of a search of two goals: a row for each design, its variables and its goals."""
        import pandas

        designs = (self.search or {}).get("front", [])
        return pandas.DataFrame([{"row": each["row"], **each["values"]} | {f"goal_{i + 1}": goal for i, goal in enumerate(each["goals"])} for each in designs])

    def population(self) -> PopulationTable:
        """What the members of a population come to."""
        if self._population is None:
            raise ValueError("the designs of this study are no population")
        return PopulationTable(self._population)

    def pareto(self) -> list[str]:
        """The labels of the designs that no other one beats."""
        return [row["label"] for row in self.rows if row["pareto"]]

    def frame(self) -> pandas.DataFrame:
        """A column for each quantity, those of one gear of the study's `gear`. Designs that cannot be built have no numbers, and their `problem`."""
        import pandas

        named = [each for each in self.quantities if each["of"] == "curve" or each["gear"] in (None, self.document["gear"])]
        return pandas.DataFrame([line for row in self.rows for line in _lines(row, named)])


class PopulationTable:
    """How each quantity is spread over the members of a population; `frame` has a row for each quantity and torque."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document
        self.quantities: list[dict[str, Any]] = document["quantities"]

    def frame(self) -> pandas.DataFrame:
        """Percentiles stand in columns `p1` to `p99`, their confidence limits in `p1_low` and `p1_high`."""
        import pandas

        return pandas.DataFrame([_spread(quantity) for quantity in self.quantities])

    def influences(self) -> pandas.DataFrame:
        """A row for each quantity, torque and input: the part of the variance that the input makes."""
        import pandas

        return pandas.DataFrame(
            [
                {
                    "name": quantity["name"],
                    "output_torque_n_m": quantity["output_torque_n_m"],
                    "input": influence.get("path") or f"teeth of the {influence['accuracy']} gear",
                    "share": influence["share"],
                    "low": influence["low"],
                    "high": influence["high"],
                }
                for quantity in self.quantities
                for influence in quantity["influences"]
            ]
        )


def _spread(quantity: dict[str, Any]) -> dict[str, Any]:
    line = {name: quantity[name] for name in ("name", "output_torque_n_m", "count", "mean", "standard_deviation", "smallest", "largest")}
    line["failed_share"] = quantity.get("failed_share")
    for percentile in quantity["percentiles"]:
        name = f"p{percentile['percent']:g}"
        line |= {name: percentile["value"], f"{name}_low": percentile["low"], f"{name}_high": percentile["high"]}
    return line


def _lines(row: dict[str, Any], quantities: Sequence[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    own = {name: row.get(name) for name in ("label", "status", "pareto")}
    own["problem"] = row["problem"]["detail"] if row.get("problem") else None
    of_pair = [each["name"].removesuffix(f".{each['gear']}") for each in quantities if each["of"] == "pair"]
    of_curve = [each["name"] for each in quantities if each["of"] == "curve"]
    for curve in row["curves"] or [{}]:
        told = {name: _at(curve, name) for name in of_curve}
        short = {name: told.get(long) for name, long in _SHORT.items()}
        yield own | {name: _at(row, name) for name in of_pair} | {"output_torque_n_m": curve.get("output_torque_n_m")} | short | told


def _at(curve: dict[str, Any], name: str) -> float | None:
    """The number that a curve of a row, or its statistics, has under names that are joined by dots."""
    for place in (curve, curve.get("statistics")):
        found: Any = place
        for part in name.split("."):
            found = found.get(part) if isinstance(found, dict) else None
        if isinstance(found, (int, float)):
            return float(found)
    return None
