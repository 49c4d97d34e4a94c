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

from squeezefilm import quantities as si
from squeezefilm.contact.finger.fingertip import Finger
from squeezefilm.contact.finger.skin import Skin
from squeezefilm.contact.rough_contact import ContactLaw
from squeezefilm.contact.sharing.balance import share_load, share_load_tied
from squeezefilm.contact.sharing.gas_table import FilmTable
from squeezefilm.contact.sharing.shear import AsperityShear, sheared_friction
from squeezefilm.errors import InputError

Limit = Literal["own", "one-gap"]

_MOST_RIDGES = 100_000
# More points of ridges than that are taken in as many kinds, by the wave's amplitude there.
_KINDS = 4096


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

    `relative_friction` is µ′/µ: the asperities' share of the load, or, where what touches is
    elastic until it slips, the share of the friction at rest that it keeps.
    `mean_gap` is the mean over the plateaus (m). `film_pressure` and `asperity_pressure` are means
    over all plateaus and the period (Pa); their shares of the plateau's pressure sum to 1 within
    `residual`, the largest imbalance.
    `relative_friction_error` bounds what the film table's error does to µ′/µ: that of the
    asperities' share, in proportion.
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


@si.checked_numbers
def ridge_points(
    finger: Finger, contact_length: Annotated[si.Metre, si.Above(0.0)] | None = None
) -> si.FloatArray:
    """Where along the wave (m from the pad's centre) the ridges are sampled, each point alike.

    Ridges stand at (i + ½) L along their normal; with ridge_angle 0 each has one x. At an angle
    each ridge in the square contact is sampled along its length, a quarter of a period apart or
    finer. Raises `InputError` where the contact holds no ridge.
    """
    side = finger.contact_length if contact_length is None else contact_length
    si.require("ridges in the contact", side / finger.ridge_period, at_most=_MOST_RIDGES)
    return np.asarray(_ridge_places(finger, side, 1)[0])


# Along a ridge that stands across the wave, over a pattern that changes along it too.
_ALONG = 8


@si.checked_numbers
def pad_points(
    finger: Finger, contact_length: Annotated[si.Metre, si.Above(0.0)] | None = None
) -> tuple[si.FloatArray, si.FloatArray]:
    """Where the ridges are sampled over the pad (m from its centre), along the wave and across it.

    The points of `ridge_points`, spread along the ridges too: eight to a ridge that stands across
    the wave. Raises as it does.
    """
    side = finger.contact_length if contact_length is None else contact_length
    si.require("ridges in the contact", side / finger.ridge_period, at_most=_MOST_RIDGES)
    return _ridge_places(finger, side, _ALONG)


def _ridge_places(
    finger: Finger, side: si.Metre, spread: int
) -> tuple[si.FloatArray, si.FloatArray]:
    """The points of the ridges in a square, along and across the wave; `spread` of them along a
    ridge that has one place along the wave."""
    half, period, angle = side / 2, finger.ridge_period, finger.ridge_angle
    reach = half * (abs(np.cos(angle)) + abs(np.sin(angle)))
    count = int(np.floor(reach / period + 0.5))
    across = (np.arange(-count, count) + 0.5) * period
    if abs(np.sin(angle)) < 1e-9:
        ridges = across[np.abs(across) <= half]
        y = (np.arange(spread) + 0.5) / spread * side - half
        points, beside = np.repeat(ridges, spread), np.tile(y, ridges.size)
    else:
        along = (np.arange(64) + 0.5) / 64 * 2 * reach - reach
        x = across[:, None] * np.cos(angle) - along * np.sin(angle)
        y = across[:, None] * np.sin(angle) + along * np.cos(angle)
        inside = (np.abs(x) <= half) & (np.abs(y) <= half)
        points, beside = x[inside], y[inside]
    if points.size == 0:
        raise InputError(
            f"a contact of {si.format_quantity(side, si.Unit('m'))} holds no ridge of period "
            f"{si.format_quantity(period, si.Unit('m'))}; make the contact longer"
        )
    return np.asarray(points, dtype=float), np.asarray(beside, dtype=float)


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
    shear: AsperityShear | None = None,
) -> PadFriction:
    """The friction of plateaus at `points` (m from the pad's centre) over a standing wave.

    `amplitude` (m, at an antinode) may be an array; the plate's amplitude at x is
    a |cos(πx/half_wavelength)|, unless the posture has its own swings. Without a `shear` friction
    is the asperities' share of the load. Raises as `share_load` does.
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
        tied = _tied(table, asperities, ridges, plateau_pressure, skin, shear)
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
    share = own.relative_friction
    kept = share if shear is None else sheared_friction(own, shear, table.frequency)
    carrying = weight * lean / np.sum(weight * lean)
    # Weights sum to 1 within rounding only.
    friction, carried = np.minimum(kept @ carrying, 1.0), share @ carrying
    return PadFriction(
        amplitude=a,
        relative_friction=friction,
        mean_gap=own.mean_gap @ weight,
        film_pressure=own.gas_pressure @ weight,
        asperity_pressure=own.asperity_pressure @ weight,
        relative_friction_error=(own.relative_friction_error * lean) @ weight * friction / carried,
        residual=float(np.max(np.abs(own.residual))),
        ridge_points=points.size,
        limit="own",
        model=_named(own.model, shear),
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
    shear: AsperityShear | None,
) -> PadFriction:
    """All plateaus at one mean gap, each of its amplitudes."""
    swings, offset, shares = tied_ridges
    # Each balance is already the mean over all ridges.
    tied = [
        share_load_tied(
            table, asperities, one, plateau_pressure, offset=offset, shares=shares, skin=skin
        )
        for one in swings
    ]
    share = np.array([one.relative_friction for one in tied])
    gaps = np.array([one.mean_gap for one in tied])
    kept = share
    if shear is not None:
        # What the skin moves at ultrasonic frequency is left out of the shear's swing.
        ridges = dataclasses.replace(
            tied[0],
            mean_gap=gaps[:, None] + offset,
            gap_amplitude=swings,
            plateau_pressure=np.full(swings.shape, plateau_pressure),
        )
        kept = np.minimum(sheared_friction(ridges, shear, table.frequency) @ shares, 1.0)
    return PadFriction(
        amplitude=swings.max(axis=1),
        relative_friction=kept,
        mean_gap=gaps,
        film_pressure=np.array([one.gas_pressure for one in tied]),
        asperity_pressure=np.array([one.asperity_pressure for one in tied]),
        relative_friction_error=np.array([one.relative_friction_error for one in tied])
        * kept
        / share,
        residual=max(float(abs(one.residual)) for one in tied),
        ridge_points=offset.size,
        limit="one-gap",
        model=_named(tied[0].model, shear),
    )


def _named(model: str, shear: AsperityShear | None) -> str:
    if shear is None:
        return model
    return f"{model}, {shear.words}"


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
    shear: AsperityShear | None = None,
) -> FrictionRipple:
    """The friction as the pad crosses the wave's nodes, over half a wavelength.

    Raises as `pad_friction` does, and `InputError` for fewer than 4 positions.
    """
    side = float(np.sqrt(finger.contact_area(normal_force)))
    points = ridge_points(finger, side)
    where = np.arange(positions) / positions * half_wavelength
    values = [
        pad_friction(
            table,
            asperities,
            amplitude,
            half_wavelength,
            points,
            finger.plateau_pressure(normal_force),
            limit=limit,
            posture=PadPosture(position=float(x)),
            shear=shear,
        ).relative_friction[0]
        for x in where
    ]
    return FrictionRipple(where, np.array(values), side, half_wavelength)
