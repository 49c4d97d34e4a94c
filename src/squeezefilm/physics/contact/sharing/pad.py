"""The pad over the standing wave: every ridge where it stands, in two limits of the skin.

The skin is soft in the mean and nearly inertial at ultrasonic frequency. If it is soft enough for
each ridge to sink until it is carried, every plateau has a balance of its own ("own", the
default); if the pad were stiff, all plateaus would hang on one mean gap ("one-gap"). A real pad
lies between, and the two are reported together.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.finger.fingertip import Finger, Skin
from squeezefilm.physics.contact.rough_contact import ContactLaw
from squeezefilm.physics.contact.sharing.balance import share_load, share_load_tied
from squeezefilm.physics.contact.sharing.gas_table import FilmTable

Limit = Literal["own", "one-gap"]

_MOST_RIDGES = 100_000
# More points of ridges than that are taken in as many kinds, by the wave's amplitude there.
_KINDS = 4096
# Of a cell: less is rounding.
_LEAST_SHARE = 1e-9


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class PadPosture:
    """How the pad lies on the wave.

    `position` is the pad's centre from an antinode (m, along the wave). `pressure_tilt` τ makes
    the pressure p(1 + τ x/(l0/2)) across the pad, −1 < τ < 1 (limit "own"); `gap_tilt` is the
    angle (rad) by which the pad as a whole leans against the surface (limit "one-gap"). `swings`
    are the amplitudes that the points meet over the antinode's, one for each, where the wave is no
    |cos|: then `position` means nothing. `shares` are those of the pad that the points stand for,
    where they are not alike.
    """

    position: si.Metre = 0.0
    pressure_tilt: Annotated[si.Dimensionless, si.Above(-1), si.Below(1)] = 0.0
    gap_tilt: Annotated[si.Radian, si.AtLeast(-0.01), si.AtMost(0.01)] = 0.0
    swings: Annotated[si.DimensionlessArray, si.AtLeast(0.0)] | None = None
    shares: Annotated[si.DimensionlessArray, si.AtLeast(0.0)] | None = None

    @si.checked_numbers
    def weights(self, points: si.MetreArray) -> si.DimensionlessArray:
        """The share of the pad that each of its points stands for; they sum to 1."""
        if self.shares is None:
            return np.full(points.shape, 1 / points.size)
        whole = float(np.sum(self.shares))
        if self.shares.shape != points.shape or whole <= 0:
            raise InputError(
                f"{self.shares.size} shares for {points.size} points; give one for each, not all 0",
                quantity="shares",
            )
        return self.shares / whole

    @si.checked_numbers
    def over_the_antinode(
        self, points: si.MetreArray, half_wavelength: Annotated[si.Metre, si.Above(0.0)]
    ) -> si.DimensionlessArray:
        """The amplitudes that points (m from the pad's centre) meet, over the antinode's."""
        if self.swings is None:
            return np.abs(np.cos(np.pi * (points + self.position) / half_wavelength))
        if self.swings.shape != points.shape:
            raise InputError(
                f"{self.swings.size} swings for {points.size} points; give one for each",
                quantity="swings",
            )
        return self.swings


@dataclass(frozen=True, eq=False)
class PadFriction:
    """The pad's friction at an array of amplitudes (one-dimensional), in one limit.

    `relative_friction` is µ′/µ: the asperities' share of the load.
    `mean_gap` is the mean over the plateaus (m). `film_pressure` and `asperity_pressure` are means
    over all plateaus and the period (Pa); their shares of the plateau's pressure sum to 1 within
    `residual`, the largest imbalance.
    `relative_friction_error` bounds what the film table's error does to µ′/µ.
    """

    amplitude: si.MetreArray
    relative_friction: si.DimensionlessArray
    mean_gap: si.MetreArray
    film_pressure: si.PascalArray
    asperity_pressure: si.PascalArray
    relative_friction_error: si.DimensionlessArray
    residual: si.Dimensionless
    ridge_points: int
    limit: Limit
    model: str

    @property
    def film_share(self) -> si.DimensionlessArray:
        """The film's share of the load (dimensionless); the asperities have the rest."""
        return self.film_pressure / (self.asperity_pressure + self.film_pressure)


class PadPoints(NamedTuple):
    """Where a pad's ridges are sampled, arrays of one shape: `along` the wave and `across` it (m
    from the pad's centre), how far each point's cell reaches either way (m), and the `shares` of
    the pad that they stand for, of sum 1."""

    along: si.MetreArray
    across: si.MetreArray
    length: si.MetreArray
    width: si.MetreArray
    shares: si.DimensionlessArray

    def on_axes(
        self, along: Literal["x", "y"]
    ) -> tuple[si.MetreArray, si.MetreArray, si.MetreArray, si.MetreArray]:
        """Places along x and y, and how far their cells reach along x and y (m), under a wave along
        one of the axes."""
        if along == "x":
            return self.along, self.across, self.length, self.width
        return self.across, self.along, self.width, self.length


# Along a ridge at an angle to the nodal lines.
_ALONG = 64


@si.checked_numbers
def pad_points(
    finger: Finger,
    contact_length: Annotated[si.Metre, si.Above(0.0)] | None = None,
    spread: Annotated[int, si.AtLeast(1), si.AtMost(1000)] = 1,
) -> PadPoints:
    """Where the ridges of a square contact are sampled.

    Ridges stand at (i + ½) L along their normal, each in a cell of a period; with ridge_angle 0
    each has one x and `spread` points along it, at an angle 64 points along the contact's reach. A
    cell that the contact's edge cuts carries with the part within, and from its middle, so that
    friction is continuous in the contact's length. Raises `InputError` where the contact is shorter
    than a period of the ridges.
    """
    side = finger.contact_length if contact_length is None else contact_length
    half, period = side / 2, finger.ridge_period
    si.require("ridges in the contact", side / period, at_most=_MOST_RIDGES)
    if side < period:
        raise InputError(
            f"a contact of {si.format_quantity(side, si.Unit('m'))} holds no ridge of period "
            f"{si.format_quantity(period, si.Unit('m'))}; make the contact longer"
        )
    cos, sin = float(np.cos(finger.ridge_angle)), float(np.sin(finger.ridge_angle))
    if abs(sin) < 1e-9:
        cos, sin = 1.0, 0.0
    reach = half * (abs(cos) + abs(sin))
    count = int(np.ceil(reach / period))
    n = (np.arange(-count, count)[:, None] + 0.5) * period
    points = spread if sin == 0 else _ALONG
    step = 2 * reach / points
    t = (np.arange(points) + 0.5) * step - reach
    along, length, inside = _within(half, n * cos - t * sin, period * abs(cos) + step * abs(sin))
    across, width, beside = _within(half, n * sin + t * cos, period * abs(sin) + step * abs(cos))
    shares = inside * beside
    kept = shares > _LEAST_SHARE
    return PadPoints(
        along[kept], across[kept], length[kept], width[kept], shares[kept] / np.sum(shares[kept])
    )


def _within(
    half: float, middle: si.FloatArray, size: float
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """Of cells of a size about their middles: middle and size of what lies within ± half, and its
    share of the cell."""
    beyond = np.clip(np.abs(middle) + size / 2 - half, 0.0, size)
    return middle - np.sign(middle) * beyond / 2, size - beyond, 1 - beyond / size


@si.checked_numbers
def pad_friction(
    table: FilmTable,
    asperities: ContactLaw,
    amplitude: si.MetreLike,
    half_wavelength: Annotated[si.Metre, si.Above(0.0)],
    points: si.MetreArray,
    plateau_pressure: si.Pascal,
    *,
    limit: Limit = "own",
    posture: PadPosture | None = None,
    skin: Skin | None = None,
) -> PadFriction:
    """The friction of plateaus at `points` (m from the pad's centre) over a standing wave.

    `amplitude` (m, at an antinode) may be an array; the plate's amplitude at x is
    a |cos(πx/half_wavelength)|, unless the posture has its own swings. Raises as `share_load` does.
    """
    if points.ndim != 1:
        si.require("points", points, si.Unit("m"), axes=1)
    posture = posture or PadPosture()
    a = np.atleast_1d(np.asarray(amplitude, dtype=float))
    wave, shares = posture.over_the_antinode(points, half_wavelength), posture.weights(points)
    if limit == "one-gap":
        offset = np.tan(posture.gap_tilt) * points
        if posture.gap_tilt == 0:
            (wave,), shares = _kinds(shares, np.round(wave, 9))
            offset = np.zeros(wave.shape)
        ridges = _Tied(np.outer(a, wave), offset, shares)
        tied = _tied(table, asperities, ridges, plateau_pressure, skin)
        return dataclasses.replace(tied, amplitude=a, ridge_points=points.size)
    # Ridges on the two sides of an antinode do the same: each kind is balanced once.
    if points.size > _KINDS:
        wave = np.round(_KINDS * wave) / _KINDS
    if posture.pressure_tilt == 0:
        (wave,), weight = _kinds(shares, np.round(wave, 9))
        lean = np.ones_like(wave)
    else:
        reach = max(float(np.max(np.abs(points))), 1e-300)
        lean = 1 + posture.pressure_tilt * points / reach
        if points.size > _KINDS:
            lean = np.round(_KINDS * lean) / _KINDS
        (wave, lean), weight = _kinds(shares, np.round(wave, 9), np.round(lean, 9))
    own = share_load(table, asperities, np.outer(a, wave), plateau_pressure * lean, skin=skin)
    carrying = weight * lean / np.sum(weight * lean)
    return PadFriction(
        amplitude=a,
        # Weights sum to 1 within rounding only.
        relative_friction=np.minimum(own.relative_friction @ carrying, 1.0),
        mean_gap=own.mean_gap @ weight,
        film_pressure=own.gas_pressure @ weight,
        asperity_pressure=own.asperity_pressure @ weight,
        relative_friction_error=(own.relative_friction_error * lean) @ weight,
        residual=float(np.max(np.abs(own.residual))),
        ridge_points=points.size,
        limit="own",
        model=own.model,
    )


def _kinds(
    shares: si.DimensionlessArray, *columns: si.FloatArray
) -> tuple[si.FloatArray, si.DimensionlessArray]:
    """What differs among points, shape (columns, kinds), and the share of the pad of each kind."""
    if len(columns) == 1:  # several times quicker than along an axis
        alike, at = np.unique(columns[0], return_inverse=True)
        return alike[None, :], np.bincount(at, weights=shares).astype(float)
    kinds, at = np.unique(np.stack(columns), axis=1, return_inverse=True)
    return kinds, np.bincount(at.ravel(), weights=shares).astype(float)


class _Tied(NamedTuple):
    """Ridges at one mean gap: what they meet (m), shape (amplitudes, ridges), how far they stand
    off it (m), and their shares of the pad."""

    swings: si.MetreArray
    offset: si.MetreArray
    shares: si.DimensionlessArray


def _tied(
    table: FilmTable,
    asperities: ContactLaw,
    tied_ridges: _Tied,
    plateau_pressure: si.Pascal,
    skin: Skin | None,
) -> PadFriction:
    """All plateaus at one mean gap, each of its amplitudes."""
    swings, offset, shares = tied_ridges
    # Each balance is already the mean over all ridges.
    tied = [
        share_load_tied(
            table, asperities, swing, plateau_pressure, offset=offset, shares=shares, skin=skin
        )
        for swing in swings
    ]
    return PadFriction(
        amplitude=swings.max(axis=1),
        relative_friction=np.array([one.relative_friction for one in tied]),
        mean_gap=np.array([one.mean_gap for one in tied]),
        film_pressure=np.array([one.gas_pressure for one in tied]),
        asperity_pressure=np.array([one.asperity_pressure for one in tied]),
        relative_friction_error=np.array([one.relative_friction_error for one in tied]),
        residual=max(float(abs(one.residual)) for one in tied),
        ridge_points=offset.size,
        limit="one-gap",
        model=tied[0].model,
    )


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrictionRipple:
    """What a pad feels of the standing wave itself as it moves along it at constant amplitude.

    `relative_friction` at `position` (m from an antinode, half a wavelength), its mean, and
    `ripple`, from least to most over the mean (dimensionless).
    """

    position: si.MetreArray
    relative_friction: si.DimensionlessArray
    contact_length: si.Metre
    half_wavelength: si.Metre

    @property
    def mean(self) -> si.Dimensionless:
        """The mean of µ′/µ over half a wavelength."""
        return float(np.mean(self.relative_friction))

    @property
    def ripple(self) -> si.Dimensionless:
        """(max − min)/mean of µ′/µ; its period in space is half the wavelength."""
        return float(np.ptp(self.relative_friction)) / self.mean


@si.checked_numbers
def friction_ripple(
    table: FilmTable,
    asperities: ContactLaw,
    amplitude: si.Metre,
    half_wavelength: si.Metre,
    finger: Finger,
    *,
    normal_force: si.Newton | None = None,
    limit: Limit = "own",
    positions: Annotated[int, si.AtLeast(4)] = 24,
) -> FrictionRipple:
    """The friction as the pad crosses the wave's nodes, over half a wavelength.

    Raises as `pad_friction` does, and `InputError` for fewer than 4 positions.
    """
    side = float(np.sqrt(finger.contact_area(normal_force)))
    points = pad_points(finger, side)
    where = np.arange(positions) / positions * half_wavelength
    values = [
        pad_friction(
            table,
            asperities,
            amplitude,
            half_wavelength,
            points.along,
            finger.plateau_pressure(normal_force),
            limit=limit,
            posture=PadPosture(position=float(x), shares=points.shares),
        ).relative_friction[0]
        for x in where
    ]
    return FrictionRipple(where, np.array(values), side, half_wavelength)
