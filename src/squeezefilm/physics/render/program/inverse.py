"""Inverses of a display, as tables that a renderer takes: the amplitude that makes a wanted
friction, and the share that a contact meets of it along the wave, by which it is divided.

A friction law is also asked as a table by what takes many samples.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.render.texture.pattern import FARTHEST, X_AXIS, Coordinate, FromPoint

_METRE, _SPEED = si.Unit("m"), si.Unit("m/s")
_MOST_KNOTS = 65_536
# Friction at rest is 1 by its definition; a curve may miss that by what a solver leaves.
_AT_REST = 1e-4
# Two knots closer than this in friction cannot be told apart by the inverse.
_FLAT = 1e-12
# By how much a row of a table may rise from a knot to the next and be taken for rounding.
_RISE_OVER_SPEEDS = 1e-6
# By how much what a solver leaves may pass 0 and 1.
_ROUNDING = 1e-6

LOWEST_SPEED: si.MetrePerSecond = 5e-3
"""Speed below which a friction law is inverted as at it (m/s). A finger that creeps this slowly
sticks and slips rather than slides, the law falls to its value at rest, where any amplitude makes
the same friction, and what an estimator says is noise (its own at rest is of this order)."""

LawOverSpeeds = Callable[[si.MetreArray, si.MetrePerSecondArray], si.DimensionlessArray]
"""Vibration amplitudes (m, shape (n,)) and finger speeds (m/s, shape (k,)) → µ′/µ (1, (k, n))."""


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class FrictionTable:
    """A friction law as a table: called with amplitudes (m), it gives µ′/µ (1) in their shape.

    `amplitude` rises from 0 (m), shape (n,); `speed` from 0 (m/s), shape (k,), is one place where
    the law does not depend on it. `relative_friction` there (1) has shape (k, n); linear between,
    and held beyond the last speed. `nominal_speed` (m/s) is taken where none is asked for.

    Raises `InputError` for arrays of other shapes, knots that do not rise, or friction beyond 0…1.
    """

    amplitude: Annotated[si.MetreArray, si.AtLeast(0.0), si.Rising(2)]
    speed: Annotated[si.MetrePerSecondArray, si.AtLeast(0.0), si.Rising()]
    relative_friction: Annotated[
        si.DimensionlessArray, si.AtLeast(-_ROUNDING), si.AtMost(1.0 + _ROUNDING)
    ]
    nominal_speed: si.MetrePerSecond

    def __post_init__(self) -> None:
        a, v, known = self.amplitude, self.speed, self.relative_friction
        object.__setattr__(self, "relative_friction", np.clip(known, 0.0, 1.0))
        if a[0] != 0.0 or known.shape != (v.size, a.size):
            raise InputError(
                f"relative_friction of shape {known.shape} over {v.shape} speeds and {a.shape} "
                "amplitudes is no table; give amplitudes that rise from 0, and of friction one row "
                "for each speed"
            )

    @si.checked_numbers
    def inverse(
        self, law: LawOverSpeeds, largest_amplitude: si.Metre, share: si.Dimensionless = 1.0
    ) -> FrictionInverse:
        """The amplitude for a wanted µ′/µ at a finger's speed: this table read backwards.

        `law` is what was tabulated, by which the inverse's error is measured between the knots;
        `largest_amplitude` (m) is the largest that may be asked for, and `share` (1) what it is of
        the amplitude that the table knows. What lies below `LOWEST_SPEED` gives way to a row at it.
        Raises `InputError` where friction does not fall, is not 1 at rest or rises, and for speeds
        that all are below `LOWEST_SPEED`.
        """
        v, rows = self.speed, self.relative_friction
        if v.size == 1:
            return FrictionInverse.from_function(lambda a: self(a / share), largest_amplitude)
        if v[-1] <= LOWEST_SPEED:
            raise InputError(
                "the last speed of an inverse must be above "
                f"{si.format_quantity(LOWEST_SPEED, _SPEED)}; tabulate the law for faster fingers"
            )
        if v[0] < LOWEST_SPEED:
            held = np.array([np.interp(LOWEST_SPEED, v, column) for column in rows.T])
            above = v > LOWEST_SPEED
            rows, v = np.vstack([held, rows[above]]), np.append(LOWEST_SPEED, v[above])
        a = self.amplitude * share
        falling = np.array([_falling(a, row, _RISE_OVER_SPEEDS) for row in rows])
        if np.all(falling[:, -1] >= 1.0 - _FLAT):
            raise _changes_nothing()
        middle = 0.25 * (falling[1:, 1:] + falling[1:, :-1] + falling[:-1, 1:] + falling[:-1, :-1])
        between = law(0.5 * (self.amplitude[1:] + self.amplitude[:-1]), 0.5 * (v[1:] + v[:-1]))
        found = si.returned("law", between, middle, "a row of amplitudes for each speed")
        error = float(np.max(np.abs(middle - found)))
        return FrictionInverse(a, v, falling, self.nominal_speed, error)

    @si.checked_numbers
    def __call__(
        self, amplitude: si.MetreLike, speed: si.MetrePerSecondLike | None = None
    ) -> si.DimensionlessArray:
        """Relative friction µ′/µ at amplitudes (m) and a finger's speeds (m/s, either sign; None:
        the nominal one); both broadcast. Raises `OutOfRangeError` outside of the table."""
        values, highest = np.asarray(amplitude, dtype=float), float(self.amplitude[-1])
        # A hair of slack: an exponential envelope may overshoot its target by rounding.
        slack = 1e-9 * highest
        if values.size and (values.min() < -slack or values.max() > highest + slack):
            raise OutOfRangeError(
                f"the friction law was tabulated for amplitudes from 0 to {highest:.4g} m and "
                f"asked at {values.min():.4g} to {values.max():.4g} m; tabulate it higher"
            )
        pace = np.abs(self.nominal_speed if speed is None else speed)
        if np.ndim(pace) == 0:
            return np.asarray(np.interp(values, self.amplitude, self.at_speed(float(pace))))
        values, pace = np.broadcast_arrays(values, pace)
        if self.speed.size == 1:
            return np.asarray(np.interp(values, self.amplitude, self.relative_friction[0]))
        row, along = _place(self.speed, pace)
        column, across = _place(self.amplitude, values)
        known = self.relative_friction
        below = known[row, column] * (1 - across) + known[row, column + 1] * across
        above = known[row + 1, column] * (1 - across) + known[row + 1, column + 1] * across
        return np.asarray(below * (1 - along) + above * along)

    @si.checked_numbers
    def at_speed(self, speed: si.MetrePerSecond) -> si.DimensionlessArray:
        """Relative friction µ′/µ at the table's amplitudes and one speed (m/s), shape (n,)."""
        if self.speed.size == 1:
            return np.asarray(self.relative_friction[0])
        row, along = _place(self.speed, np.array(abs(speed)))
        known = self.relative_friction
        return np.asarray(known[row] * (1 - along) + known[row + 1] * along)


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class FrictionInverse(FrictionTable):
    """A table of friction that rises nowhere with the amplitude, read backwards.

    It is the inverse of the table and not of another. The lowest and the highest speed hold beyond.
    Build it with `from_function` or, where friction depends on the finger's speed, by
    `FrictionTable.inverse`.

    Attributes beside those of `FrictionTable`, whose friction begins at 1 and strictly falls over
    the amplitude in a single row (a finger so fast that small amplitudes change nothing meets 1 at
    several knots):
        max_error: how far the friction at an amplitude found here may be from the one wanted (1),
            measured between the knots and the speeds on the law itself.
    """

    max_error: si.Dimensionless

    @classmethod
    @si.checked_numbers
    def from_function(
        cls,
        relative_friction: Callable[[si.MetreArray], si.DimensionlessArray],
        largest_amplitude: Annotated[si.Metre, si.Above(0.0), si.AtMost(1e-3)],
        *,
        knots: Annotated[int, si.AtLeast(3), si.AtMost(_MOST_KNOTS)] = 257,
        rise_allowed: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(0.1)] = 1e-9,
    ) -> FrictionInverse:
        """The inverse of a friction law that does not depend on the speed, up to an amplitude.

        Args:
            relative_friction: vibration amplitudes (m, zero-to-peak; shape (n,)) → relative
                friction (1; the same shape). Called once, with some 4 × `knots` amplitudes.
            largest_amplitude: the largest that may be asked for (m); above 0, at most 1 mm.
            knots: amplitudes in the table, evenly spaced; from 3 to 65 536.
            rise_allowed: by how much friction may rise from a knot to the next (1) and be taken
                for rounding; the rise is flattened and enters `max_error`.

        Raises:
            InputError: a value outside its range, or a friction that is not finite, is not 1 at
                rest or rises with amplitude.
        """
        fine = np.linspace(0.0, largest_amplitude, 4 * (knots - 1) + 1)
        values = relative_friction(fine)
        found = si.returned("relative_friction", values, fine, "one value per amplitude")
        falling = _falling(fine[::4], found[::4], rise_allowed)
        # Of a flat stretch the least amplitude is kept; what that costs is in the error stated.
        keep = np.append(True, np.diff(falling) < -_FLAT)
        if np.count_nonzero(keep) < 2:
            raise _changes_nothing()
        amplitude, friction = fine[::4][keep], falling[keep]
        error = float(np.max(np.abs(np.interp(fine, amplitude, friction) - found)))
        return cls(amplitude, np.zeros(1), friction[None, :], 0.0, error)

    @property
    def largest_amplitude(self) -> si.Metre:
        """The largest amplitude that may be asked for (m, zero-to-peak)."""
        return float(self.amplitude[-1])

    @property
    def least_friction(self) -> si.Dimensionless:
        """The least relative friction that can be reached at the nominal speed (1)."""
        return float(self.least_friction_at(self.nominal_speed))

    @si.checked_numbers
    def least_friction_at(self, speed: si.MetrePerSecondLike) -> si.DimensionlessArray:
        """The least relative friction that can be reached at speeds (m/s, either sign), in their
        shape (1)."""
        return self(np.full(np.shape(speed), self.largest_amplitude), speed)

    @si.checked_numbers
    def amplitude_for(
        self,
        relative_friction: si.DimensionlessLike,
        speed: si.MetrePerSecondLike | None = None,
    ) -> si.MetreArray:
        """The least amplitude (m, zero-to-peak) that makes a relative friction (1) under a finger
        at a speed (m/s, either sign; None: the nominal one); both broadcast.

        Raises:
            InputError: a friction above 1 or below the least that can be reached at the speed.
        """
        pace = np.asarray(self.nominal_speed if speed is None else speed, dtype=float)
        wanted, pace = np.broadcast_arrays(np.asarray(relative_friction, dtype=float), pace)
        lowest = self.least_friction_at(pace)
        beyond = wanted < lowest
        least = float(lowest[beyond].max()) if np.any(beyond) else 0.0
        si.require("relative_friction", wanted, at_least=least, at_most=1.0)
        if self.speed.size == 1:
            known = self.relative_friction[0]
            return np.asarray(np.interp(wanted, known[::-1], self.amplitude[::-1]))
        row, share = _place(self.speed, np.abs(pace))
        known = self.relative_friction

        def friction(knot: si.IntArray) -> si.DimensionlessArray:
            return np.asarray((1.0 - share) * known[row, knot] + share * known[row + 1, knot])

        # Bisection for the first knot where friction is no more than wanted.
        low = np.zeros(wanted.shape, dtype=np.int64)
        high = np.full(wanted.shape, self.amplitude.size - 1)
        while np.any(high - low > 1):
            middle = (low + high) >> 1
            sticky = friction(middle) > wanted
            low, high = np.where(sticky, middle, low), np.where(sticky, high, middle)
        above, below = friction(low), friction(high)
        drop = above - below
        part = np.where(above > wanted, (above - wanted) / np.where(drop > 0.0, drop, 1.0), 0.0)
        return np.asarray((1.0 - part) * self.amplitude[low] + part * self.amplitude[high])

    @si.checked_numbers
    def friction_at(
        self, amplitude: si.MetreLike, speed: si.MetrePerSecondLike | None = None
    ) -> si.DimensionlessArray:
        """Relative friction (1) at amplitudes (m, held beyond the largest) under a finger at a
        speed (m/s, either sign; None: the nominal one), by the knots; both broadcast."""
        return self(np.clip(amplitude, 0.0, self.largest_amplitude), speed)


def _place(knots: si.FloatArray, values: si.FloatArray) -> tuple[si.IntArray, si.FloatArray]:
    """Indices of the knots below values, and places up to the next (0 to 1); held at both ends."""
    at = np.clip(np.searchsorted(knots, values, side="right") - 1, 0, knots.size - 2)
    part = (values - knots[at]) / (knots[at + 1] - knots[at])
    return at, np.clip(part, 0.0, 1.0)


def _falling(
    amplitude: si.MetreArray, friction: si.DimensionlessArray, rise_allowed: float
) -> si.DimensionlessArray:
    """A friction curve from 1 on that rises nowhere."""
    si.require("relative_friction", friction, at_least=0.0)
    if abs(friction[0] - 1.0) > _AT_REST:
        raise InputError(
            f"the relative friction at rest is {friction[0]:.6g}; it must be 1: divide the curve "
            "by its value at amplitude 0"
        )
    rise = np.diff(friction)
    if np.any(rise > rise_allowed):
        place = int(np.argmax(rise > rise_allowed))
        raise InputError(
            f"friction rises by {rise[place]:.3g} from "
            f"{si.format_quantity(amplitude[place], _METRE)} to "
            f"{si.format_quantity(amplitude[place + 1], _METRE)}, so an amplitude for it is not "
            "unique; end the curve there, or allow the rise if it is noise (rise_allowed)"
        )
    return np.minimum.accumulate(np.append(1.0, friction[1:]))


def _changes_nothing() -> InputError:
    return InputError("friction does not fall with amplitude, so nothing can be rendered by it")


# A plate in a standing wave |cos(πx/λ½)| vibrates at antinodes and rests at nodes, so a texture
# that asks for one amplitude is felt with a ripple of period λ½, half the wavelength.
_MOST_FACTORS = 65_536


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class WaveCompensation:
    """Compensation of the wave's weakness, place by place; a renderer divides amplitudes by it.

    Build it with `from_ripple`.

    Args:
        half_wavelength: the period (m); from 1 µm to 10 m.
        factors: local amplitude over that at the strongest place (1), evenly spaced over one
            period from coordinate 0; above 0, at most 1. The least is the greatest gain's inverse.
        along: the coordinate across the nodal lines; no distance from a point.

    Raises:
        InputError: a value outside its range.
    """

    half_wavelength: Annotated[si.Metre, si.AtLeast(1e-06), si.AtMost(FARTHEST)]
    factors: Annotated[tuple[si.Dimensionless, ...], si.Above(0.0), si.AtMost(1.0)]
    along: Coordinate = X_AXIS

    def __post_init__(self) -> None:
        if not 2 <= len(self.factors) <= _MOST_FACTORS:
            raise InputError(f"{len(self.factors)} factors cannot be used; give 2 to 65 536")
        if isinstance(self.along, FromPoint):
            raise InputError("a wave runs along a direction; give AlongX, AlongY, AlongDirection")

    @classmethod
    @si.checked_numbers
    def from_ripple(
        cls,
        position: si.MetreArray,
        relative_friction: si.DimensionlessArray,
        inverse: FrictionInverse,
        half_wavelength: si.Metre,
        *,
        least: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)] = 0.1,
        along: Coordinate = X_AXIS,
    ) -> WaveCompensation:
        """Compensation by friction, computed or measured, of a pad that crosses the wave at a
        drive.

        `position` (m) are evenly spaced places over one `half_wavelength` from 0 on, its end left
        out; `relative_friction` (1) the friction there; `inverse` that of the pad where friction
        falls most. The amplitude that explains the friction at each place, over the largest such,
        is the factor. Exact where the place acts as a factor on the amplitude.

        Raises:
            InputError: places that are not such, or a friction the inverse does not reach.
        """
        places = np.asarray(position, dtype=float)
        friction = np.asarray(relative_friction, dtype=float)
        even = np.arange(places.size) / max(places.size, 1) * half_wavelength
        if places.ndim != 1 or places.shape != friction.shape or places.size < 4:
            raise InputError("position and relative_friction must be two lists of one length, ≥ 4")
        if np.max(np.abs(places - even)) > 1e-6 * half_wavelength:
            raise InputError(
                "position must be evenly spaced from 0 over one half wavelength, its end left out"
            )
        amplitude = inverse.amplitude_for(friction)
        largest = float(np.max(amplitude))
        if largest == 0.0:
            raise InputError("nothing vibrates at any of these places, so there is no ripple")
        factors = np.clip(amplitude / largest, least, 1.0)
        return cls(half_wavelength, tuple(factors.tolist()), along)

    @si.checked_numbers
    def factor(self, x: si.MetreLike, y: si.MetreLike = 0.0) -> si.DimensionlessArray:
        """The factor at places (1), as the renderer reads it: linear between those of a period."""
        where = self.along.at(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        places = np.arange(len(self.factors)) / len(self.factors)
        return np.asarray(np.interp(where / self.half_wavelength, places, self.factors, period=1))
