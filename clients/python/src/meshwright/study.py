"""The table of a study."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas


class StudyTable:
    """A row for each design, as the service gives it; `frame` has a row for each design and torque."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document
        self.rows: list[dict[str, Any]] = document["rows"]

    def pareto(self) -> list[str]:
        """The labels of the designs that no other one beats."""
        return [row["label"] for row in self.rows if row["pareto"]]

    def frame(self) -> pandas.DataFrame:
        """Designs that cannot be built have no numbers, and their `problem`."""
        import pandas

        return pandas.DataFrame([line for row in self.rows for line in _lines(row)])


def _lines(row: dict[str, Any]) -> list[dict[str, Any]]:
    own = {name: row.get(name) for name in ("label", "status", "pareto", "mass_kg", "mass_removed_percent", "least_ligament_mm", "pair_mass_kg")}
    own["problem"] = row["problem"]["detail"] if row.get("problem") else None
    lines = []
    for curve in row["curves"] or [{}]:
        statistics = curve.get("statistics") or {}
        ste = statistics.get("transmission_error_um") or {}
        stiffness = statistics.get("mesh_stiffness_tangent_n_per_m") or {}
        lines.append(
            own
            | {
                "output_torque_n_m": curve.get("output_torque_n_m"),
                "mean_um": ste.get("mean"),
                "rms_um": ste.get("rms"),
                "peak_to_peak_um": ste.get("peak_to_peak"),
                "mean_stiffness_n_per_m": stiffness.get("mean"),
                "hole_order_um": curve.get("hole_order_um"),
                "mesh_order_um": curve.get("mesh_order_um"),
            }
        )
    return lines
