"""Shape of a generated involute spur gear, and where the teeth of a pair stand at a mesh position.

Lengths in millimeters, angles in radians. In the frame of a tooth its centerline is the x axis and its loaded flank lies
at positive angles, on both gears: the driving gear turns counter-clockwise about (0, 0), the driven gear clockwise about
(a, 0), and both are loaded on the counter-clockwise flank.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import atan2, cos, hypot, pi, sin, sqrt, tan

import numpy as np


def involute(angle):
    """The involute function, inv(angle) = tan(angle) - angle."""
    return np.tan(angle) - angle


def polar(radius, angle):
    """Points of given radius and angle; arrays of shape (..., 2)."""
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


@dataclass(frozen=True)
class Relief:
    """Material removed near the tip, normal to the flank, over the radius: amount * t^exponent from the start circle."""

    amount: float
    length: float
    exponent: int = 1

    def removed(self, radius, tip_radius):
        t = (radius - (tip_radius - self.length)) / self.length
        return self.amount * np.clip(t, 0.0, None) ** self.exponent


@dataclass(frozen=True)
class Hole:
    """A round hole; the angle of its center is counted from the centerline of tooth 0 towards its loaded flank."""

    circle_radius: float
    radius: float
    angle: float


@dataclass(frozen=True)
class Web:
    """The ring of the blank between two radii that is thinner than the face width."""

    inner_radius: float
    outer_radius: float
    thickness: float


@dataclass(frozen=True)
class Gear:
    """One gear: rack, blank, deviations and material. Defaults are the ISO 53 rack (of module 2) and steel."""

    z: int
    m: float
    bore: float
    alpha_deg: float = 20.0
    x: float = 0.0
    addendum: float = None
    dedendum: float = None
    rack_tip_radius: float = None
    relief: Relief = None
    holes: tuple = ()
    web: Web = None
    # Removed material (mm, normal to the flank) at roll lengths (mm), linear between them.
    profile_table: tuple = None
    # Height (mm) of a parabola in roll length between the form and the tip circle, as a table of so many points.
    crowning: float = None
    crowning_points: int = 41
    tip_rounding: float = 0.0
    # Depth below the tip circle at which a straight cut begins, at 45 degrees to the radius there.
    tip_chamfer: float = 0.0
    # Pitch deviation (mm) along the base tangent by tooth number, towards the loaded flank.
    pitch_deviations: dict = field(default_factory=dict)
    youngs_modulus: float = 210000.0
    poisson_ratio: float = 0.3
    # In tonnes per cubic millimeter.
    density: float = 7.85e-9

    @property
    def alpha(self):
        return np.radians(self.alpha_deg)

    @property
    def ha(self):
        return self.m if self.addendum is None else self.addendum

    @property
    def hf(self):
        return 1.25 * self.m if self.dedendum is None else self.dedendum

    @property
    def rho(self):
        return 0.38 * self.m if self.rack_tip_radius is None else self.rack_tip_radius

    @property
    def rp(self):
        return self.m * self.z / 2

    @property
    def rb(self):
        return self.rp * cos(self.alpha)

    @property
    def ra(self):
        return self.rp + self.ha + self.x * self.m

    @property
    def rf(self):
        return self.rp - self.hf + self.x * self.m

    @property
    def base_half_angle(self):
        """Half the angle of the tooth at the base circle."""
        return (pi / 2 + 2 * self.x * tan(self.alpha)) / self.z + involute(self.alpha)

    @cached_property
    def flank_start(self):
        """(gamma, roll length) where the involute begins: gamma is the angle of the trochoid's normal there, as in `fillet`.

        They touch at gamma = alpha, unless that lies before the base circle: the trochoid then cuts the involute (undercut).
        """
        straight_depth = self.hf - self.rho * (1 - sin(self.alpha)) - self.x * self.m
        tangent = self.rp * sin(self.alpha) - straight_depth / sin(self.alpha)
        if tangent >= 0:
            return self.alpha, tangent

        def beside(gamma):
            """By what angle the trochoid lies outside the involute at equal radius, and the roll length there."""
            radius, angle = self.trochoid(gamma)
            if radius < self.rb:
                return -1.0, 0.0
            s = sqrt(radius**2 - self.rb**2)
            return angle - (self.base_half_angle - (s / self.rb - atan2(s, self.rb))), s

        high = pi / 2
        low = next(gamma for gamma in np.linspace(pi / 2, self.alpha, 4001) if beside(gamma)[0] > 0)
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if beside(middle)[0] > 0 else (low, middle)
        return low, beside(low)[1]

    @property
    def form_roll_length(self):
        """Roll length where the involute begins."""
        return self.flank_start[1]

    @property
    def form_radius(self):
        return hypot(self.rb, self.form_roll_length)

    @property
    def tip_roll_length(self):
        """Roll length at the tip circle, whether or not a rounding takes the flank away before it."""
        return sqrt(self.ra**2 - self.rb**2)

    @property
    def flank_end_roll_length(self):
        """Roll length where the flank meets the tip circle, the tip rounding or the tip chamfer.

        The rounding's center lies on the flank's parallel curve at distance rho, which is an involute of the same base
        circle, and on the circle ra - rho.
        """
        if self.tip_chamfer:
            return sqrt((self.ra - self.tip_chamfer) ** 2 - self.rb**2)
        if not self.tip_rounding:
            return self.tip_roll_length
        center_radius = self.ra - self.tip_rounding
        return sqrt(center_radius**2 - self.rb**2) + self.tip_rounding

    def table(self):
        """Roll lengths and removed material of the profile deviation, or None."""
        if self.profile_table is not None:
            return self.profile_table
        if self.crowning is None:
            return None
        s = np.linspace(self.form_roll_length, self.tip_roll_length, self.crowning_points)
        middle, half = (s[0] + s[-1]) / 2, (s[-1] - s[0]) / 2
        return s, self.crowning * ((s - middle) / half) ** 2

    def removed(self, s):
        """Material removed normal to the flank at roll length s."""
        s = np.asarray(s, float)
        e = np.zeros_like(s)
        if self.relief:
            e = e + self.relief.removed(np.hypot(self.rb, s), self.ra)
        if (table := self.table()) is not None:
            e = e + np.interp(s, *table)
        return e

    def flank(self, s):
        """Point of the loaded flank at roll length s, in the tooth's frame; removed material turns it at equal radius."""
        s = np.asarray(s, float)
        angle = self.base_half_angle - (s / self.rb - np.arctan2(s, self.rb)) - self.removed(s) / self.rb
        return polar(np.hypot(self.rb, s), angle)

    def trochoid(self, gamma):
        """Radius and angle of the trochoid at `gamma`, before anything is removed."""
        land = pi * self.m / 4 - (self.hf - self.rho) * tan(self.alpha) - self.rho / cos(self.alpha)
        depth = self.hf - self.rho - self.x * self.m
        # The pitch point stands beside the rounding's center by this much, on the side away from the tooth.
        aside = depth / np.tan(gamma)
        foot = pi / self.z - (land - aside) / self.rp
        r, t = self.rp - depth - self.rho * np.sin(gamma), -aside - self.rho * np.cos(gamma)
        return np.hypot(r, t), foot + np.arctan2(t, r)

    def fillet(self, gamma):
        """Point of the trochoid; gamma is the angle of its normal to the rolling line, pi/2 at the root.

        Removed material of the flank fades to zero over the fillet.
        """
        radius, angle = self.trochoid(np.asarray(gamma, float))
        return polar(radius, angle - self.removed(self.form_roll_length) / self.rb * (1 - self.fillet_fade(gamma)))

    def fillet_fade(self, gamma):
        """Smooth step from 0 at the flank to 1 at the root circle."""
        start = self.flank_start[0]
        t = (gamma - start) / (pi / 2 - start)
        return t * t * (3 - 2 * t)

    def rounding(self, t):
        """Point of the tip rounding: t = 0 at the flank, 1 at the tip circle."""
        rho, s = self.tip_rounding, self.flank_end_roll_length
        on_flank = self.flank(s)
        normal_angle = self.base_half_angle - (s + self.removed(s)) / self.rb + pi / 2
        center = on_flank - rho * polar(1.0, normal_angle)
        tip_angle = atan2(center[1], center[0])
        return center + rho * polar(1.0, normal_angle + np.asarray(t, float) * (tip_angle - normal_angle))

    def chamfer(self, t):
        """Point of the tip chamfer: t = 0 at the flank, 1 at the tip circle."""
        start = self.flank(self.flank_end_roll_length)
        along = polar(1.0, atan2(start[1], start[0]) - pi / 4)
        half = start @ along
        length = -half + sqrt(half**2 + self.ra**2 - start @ start)
        return start + length * np.multiply.outer(np.asarray(t, float), along)

    def half_profile(self):
        """The loaded half of a tooth from the middle of the root land to the tip's center.

        A list of (name, curve, turn): curve maps [0, 1] to points, turn maps [0, 1] to the part of a pitch deviation's
        rotation that the point takes.
        """
        stretch = lambda low, high: lambda t: low + np.asarray(t, float) * (high - low)
        gamma = stretch(pi / 2, self.flank_start[0])
        root_end = self.fillet(pi / 2)
        root_angle = stretch(pi / self.z, atan2(root_end[1], root_end[0]))
        pieces = [
            ("land", lambda t: polar(self.rf, root_angle(t)), lambda t: 0.0 * t),
            ("fillet", lambda t: self.fillet(gamma(t)), lambda t: 1 - self.fillet_fade(gamma(t))),
        ]
        whole = lambda t: 1 + 0.0 * t
        kinks = self.flank_kinks()
        for low, high in zip(kinks, kinks[1:]):
            roll = stretch(low, high)
            pieces.append(("flank", lambda t, roll=roll: self.flank(roll(t)), whole))
        tip_corner = self.flank(self.flank_end_roll_length)
        if self.tip_rounding:
            pieces.append(("rounding", self.rounding, whole))
            tip_corner = self.rounding(1.0)
        if self.tip_chamfer:
            pieces.append(("chamfer", self.chamfer, whole))
            tip_corner = self.chamfer(1.0)
        tip_angle = stretch(atan2(tip_corner[1], tip_corner[0]), 0.0)
        pieces.append(("tip", lambda t: polar(self.ra, tip_angle(t)), whole))
        return pieces

    def flank_kinks(self):
        """Roll lengths between which the flank is smooth."""
        start, end = self.form_roll_length, self.flank_end_roll_length
        kinks = [start, end]
        if self.relief:
            kinks.append(sqrt((self.ra - self.relief.length) ** 2 - self.rb**2))
        return sorted(k for k in kinks if start <= k <= end)


@dataclass(frozen=True)
class Pair:
    """Two gears at a center distance. Pair n of teeth passes the pitch point at mesh position n."""

    driving: Gear
    driven: Gear
    center_distance: float
    face_width: float = 20.0

    @property
    def gears(self):
        return self.driving, self.driven

    @property
    def centers(self):
        return np.zeros(2), np.array([self.center_distance, 0.0])

    @property
    def aw(self):
        return np.arccos((self.driving.rb + self.driven.rb) / self.center_distance)

    @property
    def pb(self):
        return pi * self.driving.m * cos(self.driving.alpha)

    @property
    def path(self):
        """Roll lengths on the driving gear at the start of the path of contact, the pitch point and the end.

        An undercut flank may begin inside the tip circle of its mate, and ends the path there.
        """
        total = self.center_distance * sin(self.aw)
        start = max(total - self.driven.tip_roll_length, self.driving.form_roll_length)
        end = min(self.driving.tip_roll_length, total - self.driven.form_roll_length)
        return start, self.driving.rb * tan(self.aw), end

    @property
    def contact_ratio(self):
        start, _, end = self.path
        return (end - start) / self.pb

    def roll_length(self, eta, n):
        """Roll length on the driving gear of pair n at mesh position eta."""
        return self.path[1] + (eta - n) * self.pb

    def tooth_angle(self, which, eta, n):
        """Angle of the centerline of tooth n of gear `which` (0 drives) about its own center."""
        s = self.roll_length(eta, n)
        gear = self.gears[which]
        if which == 0:
            return -self.aw + s / gear.rb - gear.base_half_angle
        s2 = self.center_distance * sin(self.aw) - s
        return pi - self.aw + s2 / gear.rb - gear.base_half_angle

    def loaded_profile(self, which, eta, n, count=4000):
        """Dense points of the loaded half profile of tooth n, from the form circle to the tip's center, in space."""
        gear = self.gears[which]
        t = np.linspace(0.0, 1.0, count)
        turn = gear.pitch_deviations.get(n % gear.z, 0.0) / gear.rb
        angle = self.tooth_angle(which, eta, n) + turn
        pieces = [curve(t) for name, curve, _ in gear.half_profile() if name in ("flank", "rounding", "chamfer", "tip")]
        return rotate(np.concatenate(pieces), angle) + self.centers[which]

    def gap(self, eta, n):
        """How far (rb2 times angle) the driven gear may turn backwards until pair n touches, and the point of touch.

        Both profiles as angle over radius about the driven gear's center; their least distance.
        """
        center = self.centers[1]
        own = self.loaded_profile(1, eta, n) - center
        mate = self.loaded_profile(0, eta, n) - center
        r2, r1 = np.hypot(*own.T), np.hypot(*mate.T)
        # Along the driving tooth the distance to the other center falls from root to tip; beyond that turn it grows.
        mate, r1 = mate[: np.argmin(r1) + 1][::-1], r1[: np.argmin(r1) + 1][::-1]
        angle_about = lambda points: np.mod(np.arctan2(points[:, 1], points[:, 0]), 2 * pi)
        tip = np.argmax(r2 > self.driven.ra - 1e-9)
        r2, own = r2[: tip + 1], own[: tip + 1]
        radii = np.union1d(r1, r2)
        radii = radii[(radii >= max(r1[0], r2[0])) & (radii <= min(r1[-1], r2[-1]))]
        if not len(radii):
            return np.inf, None
        apart = np.interp(radii, r1, angle_about(mate)) - np.interp(radii, r2, angle_about(own))
        k = np.argmin(apart)
        return self.driven.rb * apart[k], center + polar(radii[k], np.interp(radii[k], r1, angle_about(mate)))

    def near_pairs(self, eta, reach):
        """The pairs whose gap is below `reach`, as {n: (gap, point)}; none is more than a base pitch off the path."""
        near = {}
        start, pitch, end = self.path
        first = eta - (end - pitch) / self.pb - 1
        last = eta + (pitch - start) / self.pb + 1
        for n in range(int(np.ceil(first)), int(np.floor(last)) + 1):
            gap, point = self.gap(eta, n)
            if gap < reach:
                near[n] = (gap, point)
        return near


def rotate(points, angle):
    c, s = cos(angle), sin(angle)
    return points @ np.array([[c, s], [-s, c]])
