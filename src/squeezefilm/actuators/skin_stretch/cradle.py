"""Places of the contactors, and the curvature of a cradle at which a fingertip touches all.

x runs along the finger and is the way of pulling, y across it. Cradle and fingertip are described
by their radii of curvature along x and y. The finger is pressed on: every contactor under it
carries a force that is not negative, with the tissue's own influence from one to the other
(`tissue.influence_matrix`, normal), or stands free.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from scipy.optimize import brentq, nnls

from squeezefilm.actuators.skin_stretch.tissue import Sizes, Tissue, influence_matrix
from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, InputError, UnreachableError
from squeezefilm.core.hard_limits import MOTION_SAMPLES, require_within
from squeezefilm.physics.render.texture.pattern import Pattern

_M = si.Unit("m")
Radius = Annotated[si.Metre, si.Above(0)]


@si.checked_numbers
@dataclass(frozen=True)
class Fingertip:
    """The radii of curvature of a fingertip where it touches, along and across the finger (assumed:
    a fingertip some 16 mm wide, flatter along itself)."""

    radius_along: Radius = 20e-3
    radius_across: Radius = 8e-3


@si.checked_numbers
@dataclass(frozen=True)
class FingerCradle:
    """`columns` of contactors along the finger and `rows` across it, at their pitches, each of
    `contactor_length` (along) × `contactor_width`, on a cradle of `radius_along` and
    `radius_across` (None: straight) that is at most `length` × `width`.

    Raises `GeometryError` where the contactors overlap, where there are more than the cradle holds,
    or where it would have to curve by more than a half circle.
    """

    columns: Annotated[int, si.AtLeast(1), si.AtMost(50)]
    rows: Annotated[int, si.AtLeast(1), si.AtMost(50)]
    pitch_along: Annotated[si.Metre, hard.SIDE]
    pitch_across: Annotated[si.Metre, hard.SIDE]
    contactor_length: Annotated[si.Metre, hard.SIDE]
    contactor_width: Annotated[si.Metre, hard.SIDE]
    length: Annotated[si.Metre, hard.SIDE]
    width: Annotated[si.Metre, hard.SIDE]
    radius_across: Radius | None = None
    radius_along: Radius | None = None

    def __post_init__(self) -> None:
        for name, number, pitch, side, span, radius in (
            (
                "columns",
                self.columns,
                self.pitch_along,
                self.contactor_length,
                self.length,
                self.radius_along,
            ),
            (
                "rows",
                self.rows,
                self.pitch_across,
                self.contactor_width,
                self.width,
                self.radius_across,
            ),
        ):
            shown = [si.format_quantity(length, _M) for length in (pitch, side, span)]
            if side > pitch:
                raise GeometryError(
                    f"contactors of {shown[1]} overlap at a pitch of {shown[0]} ({name}); make "
                    "them smaller or the pitch larger"
                )
            most = int((span - side + 1e-9) / pitch) + 1 if side <= span else 0
            if number > most:
                raise GeometryError(
                    f"{number} {name} of contactors at a pitch of {shown[0]} are more than a "
                    f"cradle of {shown[2]} holds, which has room for {most}; take fewer, a finer "
                    "pitch or a larger cradle",
                    quantity=name,
                )
            if radius is not None and number * pitch > np.pi * radius:
                raise GeometryError(
                    f"{number} {name} at {shown[0]} go more than half around a cradle of radius "
                    f"{si.format_quantity(radius, _M)}; make the radius larger"
                )

    @property
    def count(self) -> int:
        """Number of contactors."""
        return self.columns * self.rows

    @property
    def size(self) -> Sizes:
        """Sizes of one contactor, along and across (m)."""
        return self.contactor_length, self.contactor_width

    @property
    def places(self) -> tuple[si.MetreArray, si.MetreArray]:
        """x and y of the contactors' middles on the unrolled cradle (m), column by column."""
        x = (np.arange(self.columns) - (self.columns - 1) / 2) * self.pitch_along
        y = (np.arange(self.rows) - (self.rows - 1) / 2) * self.pitch_across
        return np.repeat(x, self.rows), np.tile(y, self.columns)

    @property
    def active_area(self) -> si.SquareMetre:
        """Area that the contactors span, a pitch for each."""
        return self.count * self.pitch_along * self.pitch_across


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class Seating:
    """A fingertip on a cradle: the `forces` on the contactors (N; 0 where it does not touch) and
    how far it came down since the first touch, `depth`."""

    forces: si.NewtonArray
    depth: si.Metre

    @property
    def touching(self) -> int:
        """Number of contactors that touch."""
        return int(np.count_nonzero(self.forces > 0))


def _sag(place: si.FloatArray, radius: float | None) -> si.FloatArray:
    """Fall of a circle at an arc length."""
    if radius is None:
        return np.zeros(place.shape)
    return np.asarray(radius * (1 - np.cos(np.minimum(np.abs(place) / radius, np.pi))))


def gaps(cradle: FingerCradle, finger: Fingertip) -> si.MetreArray:
    """The gap at every contactor when the finger first touches one (m); at least 0.

    Falls of circles along and across are added, and places are arcs: for contacts that reach less
    than a right angle around the finger.
    """
    x, y = cradle.places
    gap = _sag(x, finger.radius_along) - _sag(x, cradle.radius_along)
    gap = gap + _sag(y, finger.radius_across) - _sag(y, cradle.radius_across)
    return np.asarray(gap - gap.min())


@si.checked_numbers
def seat(
    cradle: FingerCradle, finger: Fingertip, tissue: Tissue, force: Annotated[si.Newton, hard.FORCE]
) -> Seating:
    """Contactors that a fingertip touches under a normal force (N), and the force on each.

    Frictionless, small strains, linear tissue: a guide to about a third of its thickness. Raises
    `UnreachableError` for a force that needs more than ten thicknesses of depth.
    """
    x, y = cradle.places
    C, gap = influence_matrix(tissue, x, y, cradle.size, True), gaps(cradle, finger)
    root = np.linalg.cholesky(C)

    def forces(depth: float) -> si.FloatArray:
        # The least of ½ pᵀCp − (depth − gap)ᵀp over p ≥ 0.
        return np.asarray(nnls(root.T, np.linalg.solve(root, depth - gap), maxiter=6000)[0])

    # All of the force on all contactors at once, and every gap closed, is deep enough.
    even = float(np.max(C @ np.full(gap.size, force / gap.size)))
    most = gap.max() + 10 * even + 1e-6
    for _ in range(30):
        if forces(most).sum() >= force:
            break
        most *= 2
    else:
        raise UnreachableError(
            f"a force of {si.format_quantity(force, si.Unit('N'))} seats no finger on this cradle, "
            "however deep; press less hard"
        )
    depth = float(brentq(lambda d: forces(d).sum() - force, 0.0, most, xtol=1e-12, rtol=1e-9))
    return Seating(forces(depth), depth)


@si.checked_numbers
def force_for_all(cradle: FingerCradle, finger: Fingertip, tissue: Tissue) -> si.Newton:
    """The least normal force (N) under which a fingertip touches every contactor.

    With all in contact the forces are linear in depth, so no search is made. Raises
    `UnreachableError` where some contactor is lifted however hard one presses (contactors of an
    incompressible layer can be).
    """
    x, y = cradle.places
    C, gap = influence_matrix(tissue, x, y, cradle.size, True), gaps(cradle, finger)
    per_depth, offset = np.linalg.solve(C, np.stack([np.ones(gap.size), gap], axis=1)).T
    if np.any(per_depth <= 0):
        raise UnreachableError(
            f"{int(np.sum(per_depth <= 0))} of {gap.size} contactors are never reached; take "
            "another radius of the cradle or a larger pitch"
        )
    depth = float(np.max(offset / per_depth))
    return max(float((per_depth * depth - offset).sum()), 0.0)


@si.checked_numbers
def radii_that_touch_all(
    cradle: FingerCradle,
    finger: Fingertip,
    tissue: Tissue,
    force: Annotated[si.Newton, hard.FORCE],
) -> tuple[si.Metre, si.Metre]:
    """Radii across (m) of the cradle between which a fingertip under a force (N) touches every
    contactor; the upper is infinite, given as 1 m, where a straight cradle does.

    Looks at the radii from what half a circle needs to 1 m. Raises `UnreachableError` where none
    does, with the least force that would.
    """
    tightest = 1.001 * cradle.rows * cradle.pitch_across / np.pi
    curvatures = np.linspace(1.0, 1 / tightest, 81)

    def over(curvature: float) -> float:
        return force_for_all(replace(cradle, radius_across=1 / curvature), finger, tissue) - force

    needed = np.array([over(curvature) for curvature in curvatures])
    good = np.flatnonzero(needed <= 0)
    if good.size == 0:
        best = 1 / curvatures[int(np.argmin(needed))]
        raise UnreachableError(
            f"no radius lets a fingertip under {si.format_quantity(force, si.Unit('N'))} touch all "
            f"{cradle.count} contactors; a radius of {si.format_quantity(best, _M)} needs "
            f"{si.format_quantity(float(needed.min() + force), si.Unit('N'))}, the least"
        )
    first, last = int(good[0]), int(good[-1])
    flat = curvatures[0] if first == 0 else brentq(over, curvatures[first - 1], curvatures[first])
    steep = curvatures[-1] if last == 80 else brentq(over, curvatures[last], curvatures[last + 1])
    return 1 / float(steep), 1 / float(flat)


VoltArray = Annotated[si.FloatArray, si.Unit("V")]


@si.checked_numbers
def pattern_voltages(
    pattern: Pattern,
    cradle: FingerCradle,
    times: si.SecondArray,
    velocity: tuple[si.MetrePerSecond, si.MetrePerSecond],
    voltage: Annotated[si.Volt, si.AtLeast(0)],
) -> VoltArray:
    """The voltages (V) of all actuators while the finger moves over a pattern: shape (times,
    contactors).

    `velocity` (m/s) is the finger's along x and y over the pattern; at time 0 (s) its middle is at
    the pattern's origin. The speed reaches the pattern, as do the times. Places finer than two
    pitches are not resolved (`finest_period`). Raises `InputError` for what is no pattern, times
    that are no row, or more than 20 million samples.
    """
    si.require("times", times, si.Unit("s"), axes=1)
    if times.size == 0:
        raise InputError("times is empty; give at least one", quantity="times")
    require_within(MOTION_SAMPLES, float(max(times.size * cradle.count, 2)), "samples")
    x, y = cradle.places
    at = times[:, None]
    speed = float(np.hypot(*velocity))
    values = pattern(x + velocity[0] * at, y + velocity[1] * at, speed, at)
    return np.asarray(voltage * (2 * values - 1))


@si.checked_numbers
def finest_period(cradle: FingerCradle, along: bool = True) -> si.Metre:
    """The shortest period (m) of a grating along (or across) the finger that contactors still tell
    from a longer one: two pitches (Nyquist). At the period itself the phase decides what comes."""
    return 2 * (cradle.pitch_along if along else cradle.pitch_across)
