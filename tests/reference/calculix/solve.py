"""One position of a pair by CalculiX: sizes, grids, deck, the run, and the numbers read from its print file."""

import os
import re
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from deck import contact_edges, write_deck
from gears import polar, rotate
from grid import Sizes, gear_grid

ALL_SIZES = ("contact", "core", "fillet", "tooth", "body", "holes", "growth", "stress_fillet")
# Solutions at T and at this many T give the stiffness.
STEP = 1.02


@dataclass(frozen=True)
class Options:
    """How a position is divided and solved; lengths in millimeters."""

    # Element size at the contacts and at the fillets of loaded teeth, of unloaded teeth, in the body, at holes and webs.
    contact: float = 0.03
    fillet: float = 0.25
    tooth: float = 2.5
    body: float = 4.5
    holes: float = 1.4
    growth: float = 0.5
    # Half the length of flank that is divided finely.
    strip: float = 0.32
    # Element size within `core_reach` of the points of first touch, for contacts as narrow as those of a tip rounding.
    core: float = None
    core_reach: float = 0.04
    # Pairs whose rigid gap is smaller can come into contact.
    reach: float = 0.03
    # Rigid overlap of the first pair at the start, so that load control begins in contact; it is added to the result.
    overlap: float = 0.0004
    # Penalty, MPa/mm.
    contact_stiffness: float = 1e8
    # Extra discs of fine grid for stress: size along the loaded fillets of loaded teeth.
    stress_fillet: float = None

    def refined(self, factor, names=ALL_SIZES):
        """These options with the named sizes divided by a factor."""
        return replace(self, **{name: getattr(self, name) / factor for name in names if getattr(self, name)})


def add_strip(sizes, place, profile, touch, reach, size):
    """Discs of a size along the profile, as far as `reach` from a point."""
    distance = np.hypot(*(profile - touch).T)
    strip = profile[distance <= max(reach, distance.min() + 1e-9)]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(strip, axis=0).T))])
    spacing = 2.5 * size
    for at in np.arange(0.0, along[-1] + spacing, spacing):
        k = min(np.searchsorted(along, at), len(along) - 1)
        sizes.add(place(strip[k]), 1.3 * size, size)


def sizes_for(pair, which, eta, near, options, first_gap):
    """The size field of one gear: strips at the contacts, discs at the fillets around them, rings at holes and webs."""
    gear, center = pair.gears[which], pair.centers[which]
    sizes = Sizes(center, gear.rf, options.tooth, options.body, options.growth)
    turn = first_gap + options.overlap if which == 1 else 0.0
    place = lambda point: center + rotate(np.asarray(point) - center, turn / gear.rb)
    for n, (_, touch) in near.items():
        profile = pair.loaded_profile(which, eta, n)
        add_strip(sizes, place, profile, touch, options.strip, options.contact)
        if options.core:
            add_strip(sizes, place, profile, touch, options.core_reach, options.core)
    for tooth in {n + k for n in near for k in (-1, 0, 1)}:
        angle = pair.tooth_angle(which, eta, tooth)
        # The middle of the fillet, halfway between its ends in angle of its normal.
        middle = gear.fillet((gear.flank_start[0] + np.pi / 2) / 2)
        for side in (1.0, -1.0):
            point = rotate(middle * np.array([1.0, side]), angle) + center
            sizes.add(place(point), 0.35 * gear.m, options.fillet)
        if options.stress_fillet and tooth in near:
            for gamma in np.linspace(gear.flank_start[0], np.pi / 2, 40):
                point = rotate(gear.fillet(gamma), angle) + center
                sizes.add(place(point), 2 * options.stress_fillet, options.stress_fillet)
    zero = pair.tooth_angle(which, eta, 0)
    for hole in gear.holes:
        middle = center + polar(hole.circle_radius, zero + hole.angle)
        sizes.add(place(middle), hole.radius, options.holes)
    return sizes


@dataclass
class Position:
    """The grids and pairs of one position, and the rotation (rb2 times angle) that is built into them."""

    grids: list
    near: dict
    built_in: float


def prepare(pair, eta, options):
    near = pair.near_pairs(eta, options.reach)
    first_gap = min(gap for gap, _ in near.values())
    built_in = first_gap + options.overlap
    grids = []
    for which in (0, 1):
        sizes = sizes_for(pair, which, eta, near, options, first_gap)
        loaded = {n % pair.gears[which].z for n in near}
        grids.append(gear_grid(pair, which, eta, sizes, loaded, extra_turn=which * built_in / pair.driven.rb))
    return Position(grids, near, built_in)


def run_ccx(folder, name):
    """Runs CalculiX on one core; its print file and log stay in the folder."""
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    with open(folder / f"{name}.log", "w") as log:
        subprocess.run(["ccx", name], cwd=folder, stdout=log, stderr=log, env=environment)
    log = (folder / f"{name}.log").read_text()
    return "Job finished" in log, len(re.findall(r"^ iteration ", log, re.M))


def solve_position(pair, eta, torques, options, folder, stiffness=True, stress=False, speed=0.0):
    """Solves one position at each torque (N m) and, for the stiffness, at its step; with a speed of the driving gear (1/s) at
    the torque and that speed instead.

    Returns a dictionary as it stands in the result files.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    position = prepare(pair, eta, options)
    pairs = list(position.near)
    torques = sorted(torques)
    rb2 = pair.driven.rb
    # CalculiX divides the faces that touch only when a load step begins, before they slide by some micrometers; where a
    # corner touches that matters, so the load is kept for a second step.
    factors = [(1.0, False, 0.0), (1.0, True, 0.0)]
    if speed:
        factors.append((1.0, True, speed))
    elif stiffness:
        factors.append((STEP, True, 0.0))
    load_steps = [(factor * torque * 1e3 / rb2, *how) for torque in torques for factor, *how in factors]
    printed = []
    if stress:
        from stress import fillet_sets

        printed = fillet_sets(pair, position)
    write_deck(folder / "p.inp", pair, position.grids, pairs, load_steps, options.contact_stiffness, printed)
    finished, iterations = run_ccx(folder, "p")
    owners = {
        triangle: n for n in pairs for triangle, _ in contact_edges(position.grids[0], pair.driving, n)
    }
    steps = read_steps(folder / "p.dat", pair, pairs, owners, len(load_steps))
    base = int(np.floor(eta))
    label = lambda n: str(base - n)
    document = {
        "mesh_position": eta,
        "tooth_pairs": {label(n): n for n in pairs},
        "roll_lengths_mm": {label(n): round(float(pair.roll_length(eta, n)), 6) for n in pairs},
        "rigid_gaps_um": {label(n): round(float(gap) * 1e3, 4) for n, (gap, _) in position.near.items()},
        "loads": [],
        "nodes": sum(len(grid.nodes) for grid in position.grids),
        "iterations": iterations,
        "converged": finished and len(steps) == len(load_steps),
    }
    for k, torque in enumerate(torques):
        settled = k * len(factors) + 1
        if len(steps) <= settled:
            break
        force, at = load_steps[settled][0], steps[settled]
        delta = position.built_in + at["hub"]
        load = {
            "output_torque_n_m": torque,
            "transmission_error_um": round(delta * 1e3, 4),
            "load_shares": {label(n): round(share, 4) for n, share in at["shares"].items() if share > 0},
            "largest_contact_pressure_mpa": {label(n): round(p, 1) for n, p in at["pressures"].items() if p > 0},
            "force_balance": round(at["sum"] * pair.face_width / force - 1, 6),
            "moment_balance": round(at["moment"] * pair.face_width / (force * rb2) - 1, 6),
        }
        if speed and len(steps) > settled + 1:
            turning = position.built_in + steps[settled + 1]["hub"]
            load["at_speed"] = {"transmission_error_um": round(turning * 1e3, 4), "beyond_rest_um": round((turning - delta) * 1e3, 5)}
        elif stiffness and len(steps) > settled + 1:
            step = position.built_in + steps[settled + 1]["hub"] - delta
            load["stiffness_step_2_percent_n_per_um"] = round((STEP - 1) * force / step * 1e-3, 2)
        if stress:
            from stress import fillet_stress

            load["fillets"] = fillet_stress(pair, position, eta, at["printed"])
        document["loads"].append(load)
    return document


def read_steps(path, pair, pairs, owners, count):
    """The converged steps of a print file: rotation, normal forces, moments and pressures of the pairs."""
    if not path.exists():
        return []
    text = path.read_text()
    # Each time that was reached opens with the hub's displacement; whole times are ends of steps.
    blocks = re.split(r"(?= displacements \(vx,vy,vz\) for set HUB and time)", text)[1:]
    steps = []
    for block in blocks:
        time = float(block.split("time", 1)[1].split()[0])
        if abs(time - round(time)) > 1e-9 or round(time) != len(steps) + 1:
            continue
        steps.append(read_step(block, pair, pairs, owners))
    return steps[:count]


NUMBER = r"[-+]?\d\.\d+E[-+]\d+"


def read_step(block, pair, pairs, owners):
    hub = float(re.search(r"HUB and time.*\n\n\s+\d+\s+(" + NUMBER + ")", block).group(1))
    forces, moments = {}, {}
    for k, n in enumerate(pairs):
        found = re.search(rf"slave set SLAVE{k},.*?total surface force.*?\n\n(.*?)\n", block, re.S)
        fx, fy, _, _, _, mz = map(float, found.group(1).split())
        # The printed force is that on the driving gear's surface; about the other center it turns as the torque does.
        forces[n] = float(np.hypot(fx, fy))
        moments[n] = mz - pair.center_distance * fy
    total = sum(forces.values())
    printed = {}
    for found in re.finditer(r"displacements \(vx,vy,vz\) for set (FILLET\w+) and time.*\n\n((?:\s+\d+.*\n)+)", block):
        rows = np.array([line.split() for line in found.group(2).strip().splitlines()], float)
        printed[found.group(1)] = {int(row[0]): row[1:3] for row in rows}
    return {
        "hub": hub,
        "sum": total,
        "moment": sum(moments.values()),
        "shares": {n: force / total for n, force in forces.items()},
        "pressures": read_pressures(block, owners),
        "printed": printed,
    }


def read_pressures(block, owners):
    """The largest pressure at the integration points of each pair; `owners` tells whose a driving gear's triangle is."""
    found = re.search(r"contact stress.*?\n\n((?:\s+\d+\s+\d+\s+" + NUMBER + r".*\n)+)", block)
    largest = {}
    for line in found.group(1).strip().splitlines() if found else ():
        element, _, pressure = line.split()[:3]
        n = owners[int(element) - 1]
        largest[n] = max(largest.get(n, 0.0), float(pressure))
    return largest
