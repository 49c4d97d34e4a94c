"""Amplitude that makes a wanted friction: the display's friction law, inverted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

_METRE, _SPEED = si.Unit("m"), si.Unit("m/s")
_MOST_KNOTS = 65_536
# Friction at rest is 1 by its definition; a curve may miss that by what a solver leaves.
_AT_REST = 1e-4
# Two knots closer than this in friction cannot be told apart by the inverse.
_FLAT = 1e-12

LOWEST_SPEED: si.MetrePerSecond = 5e-3
"""Speed below which a friction law is inverted as at it (m/s). A finger that creeps this slowly
sticks and slips rather than slides, the law falls to its value at rest, where any amplitude makes
the same friction, and what an estimator says is noise (its own at rest is of this order)."""

LawOverSpeeds = Callable[[si.MetreArray, si.MetrePerSecondArray], si.DimensionlessArray]
"""Vibration amplitudes (m, shape (n,)) and finger speeds (m/s, shape (k,)) → µ′/µ (1, (k, n))."""


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class FrictionInverse:
    """Knots of a falling friction law, read backwards with straight lines between them.

    Between two speeds friction is linear in the speed at each knot, as a table of the law has it,
    so that this is the inverse of that table and not of another; the lowest and the highest speed
    hold beyond. Build it with `from_function` or, where friction depends on the finger's speed,
    `over_speeds`.

    Attributes:
        amplitude: rising from 0 (m, zero-to-peak), shape (n,).
        speed: of the finger, rising (m/s), shape (k,); one where friction does not depend on it.
        relative_friction: from 1 (1), shape (k, n); strictly falling if k = 1, else nowhere rising
            (a finger so fast that small amplitudes change nothing meets 1 at several knots).
        nominal_speed: where none is said (m/s).
        max_error: how far the friction at an amplitude found here may be from the one wanted (1),
            measured between the knots and the speeds on the law itself.
    """

    amplitude: si.MetreArray
    speed: si.MetrePerSecondArray
    relative_friction: si.DimensionlessArray
    nominal_speed: si.MetrePerSecond
    max_error: si.Dimensionless

    def __post_init__(self) -> None:
        shape = (np.size(self.speed), np.size(self.amplitude))
        if np.shape(self.relative_friction) != shape:
            raise InputError(
                f"relative_friction of shape {np.shape(self.relative_friction)} belongs to no "
                f"{shape[0]} speeds and {shape[1]} amplitudes; give one row for each speed"
            )

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

    @classmethod
    @si.checked_numbers
    def over_speeds(
        cls,
        law: LawOverSpeeds,
        amplitude: Annotated[si.MetreArray, si.AtLeast(0.0), si.AtMost(1e-3)],
        speed: Annotated[si.MetrePerSecondArray, si.AtLeast(0.0)],
        nominal_speed: Annotated[si.MetrePerSecond, si.AtLeast(0.0)],
        *,
        known: si.DimensionlessArray | None = None,
        rise_allowed: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(0.1)] = 1e-6,
    ) -> FrictionInverse:
        """The inverse of a friction law that depends on the finger's speed.

        Args:
            law: amplitudes and speeds → µ′/µ. Asked at the middles of all cells, for `max_error`,
                and before at the knots unless they are `known`.
            amplitude: of the knots, rising from 0 (m, zero-to-peak), shape (n,), n ≥ 3.
            speed: of the rows, rising (m/s), shape (k,), k ≥ 2; the last above `LOWEST_SPEED`.
                What lies below that gives way to a row at it.
            nominal_speed: where none is said (m/s).
            known: what the law says at the knots (1), shape (k, n), if it was asked already.
            rise_allowed: as in `from_function`, in each row.

        Raises:
            InputError: a value outside its range, knots or speeds that do not rise, or a friction
                that is not finite, is not 1 at rest, or rises with amplitude.
        """
        a, v = np.asarray(amplitude, dtype=float), np.asarray(speed, dtype=float)
        if a.ndim != 1 or a.size < 3 or a[0] != 0.0 or np.any(np.diff(a) <= 0.0):
            raise InputError("amplitudes of an inverse must rise from 0; give at least 3")
        if v.ndim != 1 or v.size < 2 or np.any(np.diff(v) <= 0.0) or v[-1] <= LOWEST_SPEED:
            raise InputError(
                "speeds of an inverse must rise, and the last must be above "
                f"{si.format_quantity(LOWEST_SPEED, _SPEED)}; give at least 2"
            )
        rows = _rows_of(law, a, v) if known is None else np.asarray(known, dtype=float)
        if rows.shape != (v.size, a.size):
            raise InputError(
                f"known friction of shape {rows.shape} belongs to no {v.size} speeds and "
                f"{a.size} amplitudes; give one row for each speed"
            )
        if v[0] < LOWEST_SPEED:
            held = np.array([np.interp(LOWEST_SPEED, v, column) for column in rows.T])
            above = v > LOWEST_SPEED
            rows, v = np.vstack([held, rows[above]]), np.append(LOWEST_SPEED, v[above])
        falling = np.array([_falling(a, row, rise_allowed) for row in rows])
        if np.all(falling[:, -1] >= 1.0 - _FLAT):
            raise _changes_nothing()
        middle = 0.25 * (falling[1:, 1:] + falling[1:, :-1] + falling[:-1, 1:] + falling[:-1, :-1])
        found = _rows_of(law, 0.5 * (a[1:] + a[:-1]), 0.5 * (v[1:] + v[:-1]))
        error = float(np.max(np.abs(middle - found)))
        return cls(a, v, falling, nominal_speed, error)

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
        row, share = self._place(np.asarray(speed, dtype=float))
        return self._friction(row, share, np.full(row.shape, self.amplitude.size - 1))

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
        row, share = self._place(pace)
        # Bisection for the first knot where friction is no more than wanted.
        low = np.zeros(wanted.shape, dtype=np.int64)
        high = np.full(wanted.shape, self.amplitude.size - 1)
        while np.any(high - low > 1):
            middle = (low + high) >> 1
            sticky = self._friction(row, share, middle) > wanted
            low, high = np.where(sticky, middle, low), np.where(sticky, high, middle)
        above, below = self._friction(row, share, low), self._friction(row, share, high)
        drop = above - below
        part = np.where(above > wanted, (above - wanted) / np.where(drop > 0.0, drop, 1.0), 0.0)
        return np.asarray((1.0 - part) * self.amplitude[low] + part * self.amplitude[high])

    @si.checked_numbers
    def friction_at(
        self, amplitude: si.MetreLike, speed: si.MetrePerSecondLike | None = None
    ) -> si.DimensionlessArray:
        """Relative friction (1) at amplitudes (m, held beyond the largest) under a finger at a
        speed (m/s, either sign; None: the nominal one), by the knots; both broadcast."""
        pace = np.asarray(self.nominal_speed if speed is None else speed, dtype=float)
        a, pace = np.broadcast_arrays(np.asarray(amplitude, dtype=float), pace)
        if self.speed.size == 1:
            return np.asarray(np.interp(a, self.amplitude, self.relative_friction[0]))
        row, share = self._place(pace)
        held = np.clip(a, 0.0, self.largest_amplitude)
        knot = np.searchsorted(self.amplitude, held, side="right") - 1
        knot = np.clip(knot, 0, self.amplitude.size - 2)
        step = self.amplitude[knot + 1] - self.amplitude[knot]
        part = (held - self.amplitude[knot]) / step
        first, second = self._friction(row, share, knot), self._friction(row, share, knot + 1)
        return np.asarray((1.0 - part) * first + part * second)

    def _place(self, speed: si.FloatArray) -> tuple[si.IntArray, si.FloatArray]:
        """The row at or below speeds, and the share of the next."""
        if self.speed.size == 1:
            return np.zeros(speed.shape, dtype=np.int64), np.zeros(speed.shape)
        held = np.clip(np.abs(speed), self.speed[0], self.speed[-1])
        row = np.clip(np.searchsorted(self.speed, held, side="right") - 1, 0, self.speed.size - 2)
        step = self.speed[row + 1] - self.speed[row]
        return row, np.asarray((held - self.speed[row]) / step)

    def _friction(
        self, row: si.IntArray, share: si.FloatArray, knot: si.IntArray
    ) -> si.DimensionlessArray:
        known = self.relative_friction
        following = np.minimum(row + 1, self.speed.size - 1)
        return np.asarray((1.0 - share) * known[row, knot] + share * known[following, knot])


def _rows_of(
    law: LawOverSpeeds, amplitude: si.MetreArray, speed: si.MetrePerSecondArray
) -> si.DimensionlessArray:
    """Rows of a law at amplitudes and speeds, if it is one finite value for each."""
    grid = np.broadcast_to(amplitude, (speed.size, amplitude.size))
    return si.returned("law", law(amplitude, speed), grid, "a row of amplitudes for each speed")


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
