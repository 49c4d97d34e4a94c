"""The pad over the standing wave: every ridge where it stands, in two limits of the skin.

The skin is soft in the mean and nearly inertial at ultrasonic frequency. If it is soft enough for
each ridge to sink until it is carried, every plateau has a balance of its own ("own", the
default); if the pad were stiff, all plateaus would hang on one mean gap ("one-gap"). A real pad
lies between, and the two are reported together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.finger.fingertip import Finger
from squeezefilm.physics.contact.rough_contact import ContactLaw
from squeezefilm.physics.contact.sharing.balance import share_load, share_load_tied
from squeezefilm.physics.contact.sharing.gas_table import FilmTable

Limit = Literal["own", "one-gap"]

_MOST_RIDGES = 100_000
# More points of ridges than that are taken in as many kinds, by the wave's amplitude there.
_KINDS = 4096
# Of a cell: less is rounding.
_LEAST_SHARE = 1e-9


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
    limit: Limit
    model: str

    @property
    def film_share(self) -> si.DimensionlessArray:
        """The film's share of the load (dimensionless); the asperities have the rest."""
        return self.film_pressure / (self.asperity_pressure + self.film_pressure)


class PadPoints(NamedTuple):
    """Points at which a pad's ridges are sampled, arrays of one shape: `along` the wave and
    `across` it (m from the pad's centre), how far each point's cell reaches either way (m), and the
    `shares` of the pad that they stand for, of sum 1."""

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
    """Points at which the ridges of a square contact are sampled.

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
    """Parts of cells of a size about their middles: middle and size of what lies within ± half, and
    its share of the cell."""
    beyond = np.clip(np.abs(middle) + size / 2 - half, 0.0, size)
    return middle - np.sign(middle) * beyond / 2, size - beyond, 1 - beyond / size


@si.checked_numbers
def pad_friction(
    table: FilmTable,
    asperities: ContactLaw,
    amplitude: si.MetreLike,
    swings: Annotated[si.DimensionlessArray, si.AtLeast(0.0)],
    shares: Annotated[si.DimensionlessArray, si.AtLeast(0.0)],
    plateau_pressure: si.Pascal,
    limit: Limit = "own",
) -> PadFriction:
    """The friction of plateaus that meet `swings`, their amplitudes over the antinode's, and carry
    `shares` of the pad, both of shape (points,).

    `amplitude` (m, at an antinode) may be an array. Raises as `share_load` does, and `InputError`
    for swings and shares that are not one for each point.
    """
    whole = float(np.sum(shares))
    if swings.ndim != 1 or shares.shape != swings.shape or whole <= 0:
        raise InputError(
            f"{shares.size} shares for {swings.size} swings; give one for each, not all 0",
            quantity="shares",
        )
    a, tied = np.atleast_1d(np.asarray(amplitude, dtype=float)), limit == "one-gap"
    # Ridges on the two sides of an antinode do the same: each kind is balanced once.
    if swings.size > _KINDS and not tied:
        swings = np.round(_KINDS * swings) / _KINDS
    kinds, alike = np.unique(np.round(swings, 9), return_inverse=True)
    weight = np.bincount(alike, weights=shares / whole).astype(float)
    weight /= np.sum(weight)
    met = np.outer(a, kinds)
    if tied:
        shared = share_load_tied(table, asperities, met, plateau_pressure, weight)
    else:
        shared = share_load(table, asperities, met, plateau_pressure)

    def mean(values: si.FloatArray) -> si.FloatArray:
        """The mean over all ridges, which one balance of all of them is already."""
        return values if tied else values @ weight

    return PadFriction(
        amplitude=a,
        # Weights sum to 1 within rounding only.
        relative_friction=np.minimum(mean(shared.relative_friction), 1.0),
        mean_gap=mean(shared.mean_gap),
        film_pressure=mean(shared.gas_pressure),
        asperity_pressure=mean(shared.asperity_pressure),
        relative_friction_error=mean(shared.relative_friction_error),
        residual=float(np.max(np.abs(shared.residual))),
        limit=limit,
        model=shared.model,
    )


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrictionRipple:
    """Ripple of the standing wave itself under a pad that moves along it at constant amplitude.

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
