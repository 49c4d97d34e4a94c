"""What a finger meets at each place of a display's active area, and the best of them.

The finger lies at one place after another. It takes from the vibration what it takes there (less
beside the antinodes), the best antinode is left with an amplitude, the solved shape says what each
ridge of the pad meets of it, and the pad's friction is the mean over its ridges, each at its own
balance.
"""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from scipy.interpolate import PchipInterpolator

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, OutOfRangeError, SqueezefilmError
from squeezefilm.physics.chain.active_area import ActiveArea
from squeezefilm.physics.chain.friction import FrictionLaw
from squeezefilm.physics.chain.pad_place import ALONG_RIDGE, PadPlace, met_by_pads, place_words
from squeezefilm.physics.chain.touch import FreeVibration, free_vibration, touched_amplitudes
from squeezefilm.physics.contact.sharing.pad import PadPoints, pad_points
from squeezefilm.physics.display import ActiveRegion, Display
from squeezefilm.physics.plate.layout import Actuator
from squeezefilm.physics.plate.surface_shape import SurfaceShape, TrackSurface, surface_shape
from squeezefilm.physics.plate.working_mode import WorkingMode

# Places to a half wavelength, and to a side at the least and the most.
_TO_A_HALF_WAVE = 12
_LEAST_PLACES, _MOST_PLACES = 49, 96
_KNOTS = 129
# Of the mean square under a pad, over that of the antinode: with more the antinode hardly moves
# beside the rest of the face, and no finger's load is known by it.
_MOST_BESIDE_LOBE = 1e3
# Places times points of the pad at a time, some 100 MB.
_AT_A_TIME = 2_000_000


def at_best_place(display: Display, mode: WorkingMode, law: FrictionLaw) -> FrictionLaw:
    """A law with its pad at the best place of the active area: where friction is lowest at the
    display's own voltage (1 V where that is 0) and the law's frequency.

    One place for all voltages and amplitudes, so that an amplitude, a voltage and a friction stand
    for each other whichever of them was asked for; another voltage may have its lowest friction a
    little beside it. As it is, over an antinode of an even wave, where the plate is taken as a
    beam, or friction is not known.
    """
    if not mode.has_shape or not law.kind.shares_load:
        return law
    own = free_vibration(display, mode, law.frequency, display.drive.voltage or 1.0, None)
    area = active_area(display, mode, law, own)
    if area is None or area.best_place is None:
        return law
    shape = surface_shape(display.actuator, mode, own.frequency)
    place = PadPlace(shape, *area.best_place, is_best_of_area=True)
    return dataclasses.replace(law, position=0.0, place=place)


def active_area(
    display: Display, mode: WorkingMode, law: FrictionLaw, drive: FreeVibration
) -> ActiveArea | None:
    """The active area of a display that vibrates in a mode, under a finger with a friction law,
    wherever that has its own pad.

    Its places are the display's own `active_area`, or those from which the contact does not
    overhang the face, the best antinode among them. The shape of the vibration is that without a
    finger: one finger changes it by the small parts that its neighbouring modes have. Kept for the
    last few. None where the mode has no shape over a face, or its antinode hardly moves beside the
    rest of it. Raises `GeometryError` for an active area beside the face.
    """
    over = dataclasses.replace(law, place=None, position=0.0)
    return _active_area(display.actuator, display.active_area, mode, over, drive)


# A prediction asks for its best place, whoever shows it for all of it.
@functools.lru_cache(maxsize=4)
def _active_area(
    actuator: Actuator,
    region: ActiveRegion | None,
    mode: WorkingMode,
    law: FrictionLaw,
    drive: FreeVibration,
) -> ActiveArea | None:
    try:
        shape = surface_shape(actuator, mode, drive.frequency)
    except OutOfRangeError:
        return None
    side = law.contact_side
    x, y, rule = _places(region, shape, side)
    at = np.argwhere(_inside(shape, side, x, y, region))
    swings, weights = _met(shape, (x, y), at, pad_points(law.finger, side, ALONG_RIDGE))
    mean_square = np.sum(weights * swings**2, axis=1)
    if np.max(mean_square) > _MOST_BESIDE_LOBE:
        return None
    lobe = touched_amplitudes(mode, law, drive.amplitude, mean_square)

    def over(values: si.FloatArray) -> si.FloatArray:
        """Values of the places there are, where they belong."""
        grid = np.full((x.size, y.size), np.nan)
        grid[at[:, 0], at[:, 1]] = values
        return grid

    friction, why_not = None, ""
    try:
        friction = over(_friction(law, lobe[:, None] * swings, weights))
    except SqueezefilmError as error:
        why_not = str(error)
    left = over(lobe)
    return ActiveArea(
        x=x,
        y=y,
        amplitude=left * shape.grid(x, y),
        lobe_amplitude=left,
        amplitude_under_pad=left * np.sqrt(over(mean_square)),
        relative_friction=friction,
        contact_side=side,
        rule=rule,
        shape_model=shape.model,
        shape_words=shape.words,
        why_not=why_not,
    )


def _met(
    shape: SurfaceShape,
    axes: tuple[si.MetreArray, si.MetreArray],
    at: si.IntArray,
    points: PadPoints,
) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
    """Amplitudes at points of pads at places of a grid, with weights: both (places, points)."""
    x, y = axes
    dx, dy, length, width = points.on_axes(shape.along)
    across, by_x = np.unique(dx, return_index=True)
    along, by_y = np.unique(dy, return_index=True)
    if at.shape[0] == x.size * y.size and across.size * along.size == dx.size:
        # Ridges along an axis, under every place of a grid: their points are a grid too.
        values_there, covered = (
            values.reshape(x.size, across.size, y.size, along.size)
            .transpose(0, 2, 1, 3)
            .reshape(at.shape[0], -1)
            for values in shape.under_grid(
                (x[:, None] + across).ravel(),
                (y[:, None] + along).ravel(),
                np.tile(length[by_x], x.size),
                np.tile(width[by_y], y.size),
            )
        )
        order = np.lexsort((dy, dx))
        weights = points.shares[order] * covered
        return values_there, weights / np.sum(weights, axis=1, keepdims=True)
    parts = np.array_split(at, -(-at.shape[0] * dx.size // _AT_A_TIME))
    met = [met_by_pads(shape, x[part[:, 0]], y[part[:, 1]], points) for part in parts]
    return (
        np.concatenate([swings for swings, _ in met]),
        np.concatenate([shares for _, shares in met]),
    )


def _friction(
    law: FrictionLaw, met: si.MetreArray, weights: si.DimensionlessArray
) -> si.DimensionlessArray:
    """Relative friction µ′/µ of pads whose points meet amplitudes (m) and carry shares of the load,
    both of shape (places, points)."""
    kind = law.kind
    if not kind.shares_load:
        raise OutOfRangeError(
            f"the model '{law.model}' does not give each ridge a balance of its own, and so no "
            "friction beside the antinodes"
        )
    highest = float(np.max(met))
    if highest == 0:
        return np.ones(met.shape[0])
    # Denser at small amplitudes, where the law bends within the roughness.
    knots = highest * np.linspace(0, 1, _KNOTS) ** 2
    each = PchipInterpolator(knots, law.ridge_friction(knots))(met)
    return np.asarray(np.sum(weights * each, axis=1))


def _places(
    region: ActiveRegion | None, shape: SurfaceShape, side: si.Metre
) -> tuple[si.MetreArray, si.MetreArray, str]:
    """The places along x and y (m), and by what rule they are the active area."""
    left, right, front, back = shape.bounds
    if region is not None:
        if not (
            left <= region.x_from <= region.x_to <= right
            and front <= region.y_from <= region.y_to <= back
        ):
            raise GeometryError(
                f"active_area goes from {place_words((region.x_from, region.y_from))} to "
                f"{place_words((region.x_to, region.y_to))}, and the face from "
                f"{place_words((left, front))} to {place_words((right, back))}; keep to the face",
                quantity="active_area",
            )
        spans = (region.x_from, region.x_to), (region.y_from, region.y_to)
        rule = "as the display's description has it"
    elif isinstance(shape, TrackSurface):
        spans = (0.0, 2 * shape.half_wavelength), _inset(front, back, side)
        rule = "one wave of the track, all others are alike"
    else:
        spans = _inset(left, right, side), _inset(front, back, side)
        rule = f"the face less half the contact's {1e3 * side:.3g} mm at every edge"
    step = shape.half_wavelength / _TO_A_HALF_WAVE
    x, y = (_along(span, step, at) for span, at in zip(spans, shape.lobe, strict=True))
    return x, y, rule


def _along(span: tuple[si.Metre, si.Metre], step: si.Metre, lobe: si.Metre) -> si.MetreArray:
    """Places along a side, evenly but for the best antinode, where friction is at its sharpest."""
    low, high = span
    if high <= low:
        return np.array([low])
    count = int(np.clip(np.ceil((high - low) / step), _LEAST_PLACES - 1, _MOST_PLACES))
    places = np.linspace(low, high, count + 1)
    nearest = int(np.argmin(np.abs(places - lobe)))
    if low <= lobe <= high and abs(places[nearest] - lobe) > 1e-6 * (high - low):
        places = np.sort(np.append(places, lobe))
    # The middle of a disc to rounding.
    return np.where(np.abs(places) < 1e-12, 0.0, places)


def _inset(low: si.Metre, high: si.Metre, side: si.Metre) -> tuple[si.Metre, si.Metre]:
    """A side less half the contact at both ends, its middle where the contact is wider."""
    if high - low <= side:
        return (low + high) / 2, (low + high) / 2
    return low + side / 2, high - side / 2


def _inside(
    shape: SurfaceShape,
    side: si.Metre,
    x: si.MetreArray,
    y: si.MetreArray,
    region: ActiveRegion | None,
) -> np.ndarray[tuple[int, ...], np.dtype[np.bool]]:
    """True where places are in the area: near a round rim only those half a contact from it."""
    left, right, _, _ = shape.bounds
    if region is not None or left >= 0:
        return np.ones((x.size, y.size), dtype=bool)
    reach = max(right - side / 2, 1e-9)
    return np.asarray(np.hypot(x[:, None], y[None, :]) <= reach * (1 + 1e-9))
