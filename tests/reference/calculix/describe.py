"""The result file of a series: provenance, inputs (also as a submission of the service), positions, checks."""

import json
import re
from dataclasses import asdict
from math import sqrt

import numpy as np

PROVENANCE = (
    "CalculiX 2.20 (public finite-element solver) by the generator in tests/reference/calculix: plane stress, "
    "second-order triangles, frictionless surface-to-surface contact, one static solution per position and torque"
)
DEFINITION = (
    "delta = Rb2*phi, phi = backward rotation (torque direction) of the rigid driven bore from exact "
    "unmodified-involute conjugacy at fixed driver; eta = mesh periods past the passage of tooth pair 0 through the pitch "
    "point; pair n (tooth n of both gears) passes it at eta = n; label j of load shares is pair floor(eta) - j, at roll "
    "length s = sP + (eta - n)*pb on the driver (s=Rb1*roll angle); k = forward step of the load from T to 1.02 T; "
    "shares are normal forces over their sum; plane stress"
)


def describe(series, solved):
    positions = [solved[(eta, 1.0)] for eta in series.positions]
    document = {
        "provenance": PROVENANCE,
        "inputs": inputs(series),
        "not_converged": [p["mesh_position"] for p in positions if not p["converged"]],
        "checks": checks(series, solved, positions),
        "positions": positions,
    }
    return document


def inputs(series):
    pair = series.pair
    alike = pair.driving.youngs_modulus == pair.driven.youngs_modulus
    return {
        "series": series.name,
        "note": series.note,
        "E_MPa": pair.driving.youngs_modulus if alike else [g.youngs_modulus for g in pair.gears],
        "nu": pair.driving.poisson_ratio if alike else [g.poisson_ratio for g in pair.gears],
        "b_mm": pair.face_width,
        "a_mm": pair.center_distance,
        "gear1": gear_inputs(pair.driving),
        "gear2": gear_inputs(pair.driven),
        "derived": derived(pair),
        "driving_speed_rpm": series.driving_speed_rpm or None,
        "density_t_per_mm3": series.driving_speed_rpm and pair.driving.density or None,
        "T_Nm": list(series.torques),
        "options": {key: value for key, value in asdict(series.options).items() if value is not None},
        "definition": DEFINITION,
        "submission": submission(series),
    }


def gear_inputs(gear):
    table = gear.table()
    return {
        "z": gear.z,
        "m": gear.m,
        "alpha_deg": gear.alpha_deg,
        "x": gear.x,
        "rp": gear.rp,
        "rb": gear.rb,
        "ra": gear.ra,
        "rf": gear.rf,
        "bore": gear.bore,
        "E_MPa": gear.youngs_modulus,
        "nu": gear.poisson_ratio,
        "relief": gear.relief
        and {
            "Ca": gear.relief.amount,
            "L": gear.relief.length,
            "shape": {1: "linear", 2: "parabolic"}[gear.relief.exponent],
            "measure": "radial",
        },
        "holes": [
            {"R": h.circle_radius, "r": h.radius, "angle_deg": round(float(np.degrees(h.angle)), 9)} for h in gear.holes
        ]
        or None,
        "web": gear.web and asdict(gear.web),
        "profile_table": table and {"roll_length_mm": list(map(float, table[0])), "removed_mm": list(map(float, table[1]))},
        "tip_rounding": gear.tip_rounding,
        "tip_chamfer": gear.tip_chamfer,
        "pitch_deviation_base_tangent_mm": {str(n): float(p) for n, p in gear.pitch_deviations.items()} or None,
        "fillet": f"generated trochoid, rho={gear.rho:g} mm, hfP={gear.hf:g} mm",
        "r_form": gear.form_radius,
    }


def derived(pair):
    start, pitch, end = map(float, pair.path)
    reliefs = [
        sqrt((g.ra - g.relief.length) ** 2 - g.rb**2) if g.relief else None for g in pair.gears
    ]
    return {
        "aw_deg": float(np.degrees(pair.aw)),
        "pb": float(pair.pb),
        "sA": start,
        "sP": pitch,
        "sE": end,
        "eps_alpha": float(pair.contact_ratio),
        "ra": [g.ra for g in pair.gears],
        "rf": [g.rf for g in pair.gears],
        "rb": [g.rb for g in pair.gears],
        "rform": [g.form_radius for g in pair.gears],
        "relief_start_roll_length": reliefs,
    }


def submission(series):
    """The same pair in the words of the service."""
    pair = series.pair
    document = {
        "method": "flexible",
        "pair": {
            "center_distance_mm": pair.center_distance,
            "driving": gear_submission(pair.driving, pair.face_width),
            "driven": gear_submission(pair.driven, pair.face_width),
        },
        "output_torques_n_m": list(series.torques),
    }
    if series.driving_speed_rpm:
        document["running"] = {"driving_speed_rpm": series.driving_speed_rpm, "bore": "held"}
    return document


def gear_submission(gear, face_width):
    document = {
        "tooth_count": gear.z,
        "module_mm": gear.m,
        "pressure_angle_deg": gear.alpha_deg,
        "profile_shift": gear.x,
        "addendum_mm": gear.ha,
        "dedendum_mm": gear.hf,
        "rack_tip_radius_mm": gear.rho,
        "face_width_mm": face_width,
        "material": {"youngs_modulus_gpa": gear.youngs_modulus / 1e3, "poisson_ratio": gear.poisson_ratio},
        "blank": {"bore_radius_mm": gear.bore},
    }
    if gear.relief:
        shape = {1: "linear", 2: "parabolic"}[gear.relief.exponent]
        start = {"radial_length_mm": gear.relief.length}
        document["tip_relief"] = {"amount_um": gear.relief.amount * 1e3, "shape": shape, "start": start}
    if (table := gear.table()) is not None:
        removed = [round(float(e) * 1e3, 9) for e in table[1]]
        document["profile_modifications"] = [
            {"kind": "table", "roll_length_mm": list(map(float, table[0])), "removed_um": removed}
        ]
    if gear.tip_rounding:
        document["tip_rounding_mm"] = gear.tip_rounding
    if gear.tip_chamfer:
        document["tip_chamfer_mm"] = gear.tip_chamfer
    if gear.pitch_deviations:
        on_reference = gear.rp / gear.rb * 1e3
        cumulative = [round(gear.pitch_deviations.get(n, 0.0) * on_reference, 9) for n in range(gear.z)]
        document["tooth_deviations"] = {"pitch_cumulative_um": cumulative}
    if gear.web:
        document["blank"]["web"] = {
            "inner_radius_mm": gear.web.inner_radius,
            "outer_radius_mm": gear.web.outer_radius,
            "thickness_mm": gear.web.thickness,
        }
    if gear.holes:
        document["blank"]["holes"] = [
            {
                "circle_radius_mm": h.circle_radius,
                "at_deg": [round(float(np.degrees(h.angle)), 9)],
                "radius_mm": h.radius,
            }
            for h in gear.holes
        ]
    return document


def checks(series, solved, positions):
    """Balances over the series, and the position that was solved again on a finer grid."""
    loads = [load for position in positions for load in position["loads"]]
    found = {
        "largest_force_imbalance": max((abs(load["force_balance"]) for load in loads), default=None),
        "largest_moment_imbalance": max((abs(load["moment_balance"]) for load in loads), default=None),
    }
    if series.check_at is not None:
        coarse, fine = solved[(series.check_at, 1.0)], solved[(series.check_at, series.refinement)]
        found["grid"] = {
            "mesh_position": series.check_at,
            "sizes_divided_by": series.refinement,
            "sizes": list(series.refined),
            "nodes": [grid.get("nodes") for grid in (coarse, fine)],
            "converged": fine["converged"],
            "loads": fine["loads"],
        }
    return found


def as_text(document):
    """The document as JSON with one line for each list of numbers or words."""
    text = json.dumps(document, indent=1)
    flat = re.compile(r"\[\s*((?:[^\[\]{}]+?,\s*)*[^\[\]{}]+?)\s*\]")
    return flat.sub(lambda found: "[" + re.sub(r",\s+", ", ", found.group(1)) + "]", text) + "\n"
