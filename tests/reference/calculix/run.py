"""Solves a series and writes its result file: python run.py NAME... [--processes 2] [--work FOLDER].

Every position is kept in the work folder, so that a run that was broken off goes on where it stopped.
"""

import argparse
import json
import tempfile
from concurrent.futures import ProcessPoolExecutor, as_completed
from math import pi
from pathlib import Path

from describe import as_text, describe
from series import all_series
from solve import solve_position

RESULTS = Path(__file__).resolve().parent.parent


def solve_and_keep(name, eta, refinement, work):
    """One position of a series on a grid refined by a factor; from the work folder if it stands there."""
    series = all_series()[name]
    folder = Path(work) / name / f"{eta:g}x{refinement:g}"
    kept = folder / "position.json"
    if kept.exists():
        return json.loads(kept.read_text())
    options = series.options.refined(refinement, series.refined)
    try:
        every = series.positions.index(eta) % series.stiffness_every == 0 or eta == series.check_at
        speed = series.driving_speed_rpm * pi / 30
        position = solve_position(series.pair, eta, series.torques, options, folder, every, series.stress, speed)
    except Exception as error:
        # A position without a solution is said, not dropped.
        position = {"mesh_position": eta, "loads": [], "converged": False, "error": str(error)}
    folder.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(position))
    return position


def solve_series(series, processes, work):
    wanted = [(eta, 1.0) for eta in series.positions]
    if series.check_at is not None:
        wanted.append((series.check_at, series.refinement))
    solved = {}
    with ProcessPoolExecutor(processes, max_tasks_per_child=1) as pool:
        tasks = {pool.submit(solve_and_keep, series.name, *position, work): position for position in wanted}
        for task in as_completed(tasks):
            solved[tasks[task]] = task.result()
            report(series, tasks[task], task.result())
    return solved


def report(series, position, result):
    loads = "; ".join(
        f"{load['output_torque_n_m']:g} N m: {load['transmission_error_um']} um, "
        f"k {load.get('stiffness_step_2_percent_n_per_um')}, shares {load['load_shares']}"
        for load in result["loads"]
    )
    state = "" if result["converged"] else " NOT CONVERGED " + result.get("error", "")
    print(f"{series.name} eta {position[0]:g} (grid x{position[1]:g}):{state} {loads}", flush=True)


def main():
    series = all_series()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="+", choices=series)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--work", type=Path, default=Path(tempfile.gettempdir()) / "meshwright-calculix")
    arguments = parser.parse_args()
    for name in arguments.names:
        solved = solve_series(series[name], arguments.processes, arguments.work)
        document = describe(series[name], solved)
        (RESULTS / f"{name}.json").write_text(as_text(document))


if __name__ == "__main__":
    main()
