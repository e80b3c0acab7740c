"""The series: which pairs, torques and mesh positions, and how they are divided."""

from dataclasses import dataclass, field, replace

import numpy as np

from gears import Gear, Hole, Pair, Relief, Web
from solve import ALL_SIZES, Options


@dataclass(frozen=True)
class Series:
    """A series of positions of one pair. `check_at` is the position that is solved again on a finer grid."""

    name: str
    note: str
    pair: Pair
    torques: tuple
    positions: tuple
    options: Options = field(default_factory=Options)
    check_at: float = None
    # The stiffness is found at every so many positions.
    stiffness_every: int = 2
    refinement: float = 1.4
    # The sizes that are refined there.
    refined: tuple = ALL_SIZES
    stress: bool = False
    # Speed of the driving gear in revolutions per minute; each position is solved at rest and at this speed.
    driving_speed_rpm: float = 0.0
    # The file of the series that this one reproduces, if it is a check of the set-up.
    reproduces: str = None


def standard_gear(**changes):
    """One of the two alike gears of the standard pair, with its tip relief."""
    return replace(Gear(z=50, m=2.0, bore=15.0, relief=Relief(0.005, 1.75)), **changes)


def standard_pair(driven=None, **both):
    gear = standard_gear(**both)
    return Pair(gear, replace(gear, **(driven or {})), 100.5)


def shifted_pair(shift):
    gear = Gear(z=40, m=2.0, bore=16.0, x=shift, rack_tip_radius=0.2)
    return Pair(gear, replace(gear, z=80, x=-shift), 120.2)


def spread(start, end, count):
    """Positions from start to end, about equally far apart, on the sixteenths or tenths of a mesh period."""
    part = 10 if end < 1 else 16
    return tuple(round(float(eta) * part) / part for eta in np.linspace(start, end, count))


def all_series():
    """Every series by name."""
    listed = [
        Series(
            "calculix-check-s1",
            "three positions of S1, to prove the set-up",
            standard_pair(),
            (115.0,),
            (0.0, 0.1875, 0.4375),
            stiffness_every=1,
            reproduces="calculix-s1.json",
        ),
        Series(
            "calculix-check-s2",
            "two positions of S2, to prove the set-up",
            standard_pair(relief=None),
            (115.0,),
            (0.1875, 0.5),
            stiffness_every=1,
            reproduces="calculix-s2.json",
        ),
        Series(
            "calculix-recess",
            "the path of contact lies beyond the pitch point; no relief",
            shifted_pair(1.1),
            (115.0,),
            # Two pairs between 0.166 and 0.588 of a period, one pair in the rest.
            (0.0, 0.05, 0.1, 0.14, 0.18, 0.24, 0.38, 0.52, 0.57, 0.6, 0.64, 0.7, 0.85),
            check_at=0.14,
        ),
        Series(
            "calculix-approach",
            "the path of contact lies before the pitch point; no relief",
            shifted_pair(-1.1),
            (115.0,),
            (0.0, 0.1, 0.18, 0.22, 0.26, 0.3, 0.4, 0.58, 0.76, 0.84, 0.88, 0.92),
            check_at=0.26,
        ),
        materials(),
        contact_ratio(),
        pitch_error(),
        web(),
        web_holes(),
        four_holes(),
        crowning(),
        fillet(),
        rounding(),
        chamfer(),
        steep_relief(),
        undercut(),
        rotation(),
    ]
    return {series.name: series for series in listed}


def materials():
    relief = Relief(0.030, 1.2)
    driving = Gear(z=30, m=3.0, bore=12.0, relief=relief)
    driven = Gear(z=45, m=3.0, bore=20.0, relief=relief, youngs_modulus=3000.0, poisson_ratio=0.38)
    return Series(
        "calculix-materials",
        "steel drives a polymer; radial linear tip relief",
        Pair(driving, driven, 113.0),
        (8.0,),
        spread(0.0, 0.9, 10),
        Options(body=3.0, contact=0.04, strip=0.7, reach=0.15, contact_stiffness=3e6, overlap=0.002),
        check_at=0.3,
    )


def contact_ratio():
    gear = Gear(
        z=60, m=2.0, bore=15.0, alpha_deg=17.5, addendum=2.3, dedendum=2.6, rack_tip_radius=0.76, relief=Relief(0.006, 0.8)
    )
    return Series(
        "calculix-contact-ratio",
        "contact ratio 2.09: two or three pairs",
        Pair(gear, replace(gear, z=61), 121.2),
        (180.0,),
        (0.0, 0.02, 0.05, 0.08, 0.14, 0.3, 0.5, 0.7, 0.92, 0.95, 0.98),
        Options(body=3.0),
        check_at=0.05,
    )


def pitch_error():
    gear = standard_gear()
    along_base_tangent = 0.006 * np.cos(gear.alpha)
    return Series(
        "calculix-pitch-error",
        "tooth 3 of the driven gear stands 6 um of reference arc towards its loaded flank",
        standard_pair(driven=dict(pitch_deviations={3: along_base_tangent})),
        (115.0,),
        (2.0, 2.1, 2.2, 2.3, 3.0, 3.7, 3.8),
        check_at=2.2,
    )


def web():
    return Series(
        "calculix-web",
        "the driven gear's blank is 6 mm thick between r 20 and 42 mm",
        standard_pair(driven=dict(web=Web(20.0, 42.0, 6.0))),
        (115.0,),
        (0.0, 0.1875, 0.25, 0.375, 0.5),
        check_at=0.25,
    )


def web_holes():
    # Six holes stand at 60 degrees, 8.333 mesh periods; the curve repeats after 25.
    holes = tuple(Hole(31.0, 6.0, np.radians(60.0 * k)) for k in range(6))
    return Series(
        "calculix-web-holes",
        "the web of calculix-web with six round holes",
        standard_pair(driven=dict(web=Web(20.0, 42.0, 6.0), holes=holes)),
        (115.0,),
        (0.0, 2.25, 4.5, 6.1875, 10.5, 15.75),
        check_at=2.25,
    )


def four_holes():
    holes = tuple(
        Hole(32.0, radius, np.radians(angle)) for radius, angle in ((9.0, 0.0), (6.0, 80.0), (8.0, 190.0), (5.0, 265.0))
    )
    return Series(
        "calculix-four-holes",
        "four unequal holes in the driven gear, over its whole revolution",
        standard_pair(driven=dict(holes=holes)),
        (115.0,),
        spread(0.0, 50 - 50 / 7, 7),
        check_at=7.125,
    )


def crowning():
    return Series(
        "calculix-crowning",
        "profile crowning of 8 um on both gears, as a table of 41 points; no tip relief",
        standard_pair(relief=None, crowning=0.008),
        (115.0,),
        (0.0, 0.1875, 0.25, 0.375, 0.5),
        check_at=0.25,
    )


def fillet():
    return Series(
        "calculix-fillet",
        "stress along the tensile root fillets of the loaded teeth",
        standard_pair(),
        (115.0,),
        (0.0, 0.25),
        Options(stress_fillet=0.025),
        check_at=0.25,
        refinement=0.5,
        refined=("stress_fillet",),
        stress=True,
    )


def chamfer():
    return Series(
        "calculix-chamfer",
        "tip chamfer of 0.2 mm on both gears, no relief: its edge carries early and late",
        standard_pair(relief=None, tip_chamfer=0.2),
        (115.0,),
        (0.1, 0.2, 0.24, 0.28, 0.32, 0.36, 0.5),
        check_at=0.28,
    )


def rounding():
    return Series(
        "calculix-rounding",
        "tip rounding of radius 0.2 mm on both gears, no relief",
        standard_pair(relief=None, tip_rounding=0.2),
        (115.0,),
        (0.05, 0.1, 0.15, 0.2, 0.25, 0.3),
        # Half the contact of a rounding is 10 um wide.
        Options(contact=0.02, strip=0.25, core=0.0025),
        check_at=0.25,
    )


def steep_relief():
    def gear(z, bore):
        return Gear(z=z, m=2.0, bore=bore, alpha_deg=25.0, rack_tip_radius=0.58, relief=Relief(0.030, 1.0, 2))

    return Series(
        "calculix-steep-relief",
        "parabolic relief of 30 um from 1 mm below the tips, at light and at full load",
        Pair(gear(17, 8.5), gear(80, 32.0), 97.5),
        (96.0, 384.0),
        (0.475, 0.525, 0.55, 0.575, 0.6, 0.65),
        check_at=0.55,
    )


def undercut():
    return Series(
        "calculix-undercut",
        "a pinion of 10 teeth, undercut: its path of contact begins where the trochoid cuts the flank, whose corner carries before",
        Pair(Gear(z=10, m=1.0, bore=1.5), Gear(z=80, m=1.0, bore=12.0), 45.0, face_width=5.0),
        (8.0,),
        # The corner carries from 0.34 to 0.59, and about 0.15, where the tip of the wheel has just come down on it. Two flanks carry from there to
        # 0.69, the corner of the tip a little longer.
        (0.0, 0.15, 0.3, 0.45, 0.5, 0.56, 0.62, 0.72),
        Options(contact=0.008, fillet=0.08, tooth=1.2, body=2.5, strip=0.12, core=0.0015, core_reach=0.015, contact_stiffness=3e9),
        check_at=0.45,
        stiffness_every=8,
    )


def rotation():
    # Ten holes stand at 36 degrees, five mesh periods: the curve repeats with the holes.
    holes = tuple(Hole(34.0, 7.5, np.radians(36.0 * k)) for k in range(10))
    return Series(
        "calculix-rotation",
        "ten holes in the driven gear, at rest and at 20,000 rpm: over one hole period, at two places of each mesh period",
        standard_pair(driven=dict(holes=holes)),
        (115.0,),
        tuple(0.25 + 0.5 * k for k in range(10)),
        check_at=1.25,
        driving_speed_rpm=20000.0,
    )
