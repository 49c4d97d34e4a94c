"""The active area of a display: what a finger meets at every place of it, not at the best alone.

The finger lies at one place after another. It takes from the vibration what it takes there (less
beside the antinodes), the best antinode is left with an amplitude, the solved shape says what each
ridge of the pad meets of it, and the pad's friction is the mean over its ridges, each at its own
balance.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.chain.pad_place import met_by_pads, place_words
from squeezefilm.chain.prediction import Prediction
from squeezefilm.chain.touch import touched_amplitudes
from squeezefilm.contact.sharing.pad import pad_points
from squeezefilm.display import ActiveRegion, Display
from squeezefilm.errors import GeometryError, OutOfRangeError, SqueezefilmError
from squeezefilm.plate.surface_shape import SurfaceShape, TrackSurface, surface_shape

CRITERIA: tuple[si.Dimensionless, ...] = (0.70, 0.80)
"""The paper asks for µ′/µ of 0.70; from 0.80 on, a drop of 0.2, people notice it."""

# Places to a half wavelength, and to a side at the least and the most.
_TO_A_HALF_WAVE = 12
_LEAST_PLACES, _MOST_PLACES = 49, 96
# Between places, for shares and the median: linear.
_BETWEEN = 8
_KNOTS = 257
# Places times points of the pad at a time, some 100 MB.
_AT_A_TIME = 2_000_000


@dataclass(frozen=True, eq=False)
class ActiveArea:
    """Amplitude and friction with the finger's centre at places `x` × `y` (m), arrays (x, y).

    `amplitude` (m, zero-to-peak) is that of the face at the place, `lobe_amplitude` that of the
    best antinode at the same time: both with the finger at the place. `amplitude_under_pad` is the
    root mean square over the pad's ridges. NaN where the face has no such place.
    `relative_friction` µ′/µ under the pad is None where the model of friction has none beside the
    antinodes; `why_not` then says why. `rule` says where the area is from, `shape_words` what the
    shape of the vibration is, `shape_model` what made it.

    Shares, median and the rest count area between the places too, by straight lines: within 0.01
    of twice as many places on the paper's plate.
    """

    x: si.MetreArray
    y: si.MetreArray
    amplitude: si.MetreArray
    lobe_amplitude: si.MetreArray
    amplitude_under_pad: si.MetreArray
    relative_friction: si.DimensionlessArray | None
    contact_side: si.Metre
    rule: str
    shape_model: str
    shape_words: str
    why_not: str = ""

    @functools.cached_property
    def _finely(self) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
        """µ′/µ over small parts of the area, rising, and the share of the area that each is."""
        assert self.relative_friction is not None, "asked only where there is a friction"
        fine = _halfway(_halfway(self.relative_friction).T).T
        parts = np.outer(_parts(self.x), _parts(self.y))
        known = np.isfinite(fine)
        order = np.argsort(fine[known])
        return fine[known][order], parts[known][order] / np.sum(parts[known])

    @property
    def best(self) -> si.Dimensionless | None:
        """The lowest µ′/µ of a place."""
        return None if self.relative_friction is None else float(np.nanmin(self.relative_friction))

    @property
    def worst(self) -> si.Dimensionless | None:
        """The highest µ′/µ of a place."""
        return None if self.relative_friction is None else float(np.nanmax(self.relative_friction))

    @property
    def median(self) -> si.Dimensionless | None:
        """The µ′/µ that half of the area stays below."""
        if self.relative_friction is None:
            return None
        values, shares = self._finely
        return float(np.interp(0.5, np.cumsum(shares) - shares / 2, values))

    def share_below(self, relative_friction: si.Dimensionless) -> si.Dimensionless | None:
        """The share of the area (0 to 1) on which µ′/µ is below a value."""
        if self.relative_friction is None:
            return None
        values, shares = self._finely
        # A sum of many shares is 1 to rounding only.
        return round(float(np.sum(shares[values < relative_friction])), 9)

    @property
    def uniformity(self) -> si.Dimensionless | None:
        """The least friction reduction 1 − µ′/µ of the area over the greatest: 1 where it is the
        same everywhere, 0 where a place has none; None where nothing is reduced."""
        if self.best is None or self.worst is None or self.best >= 1:
            return None
        return (1 - self.worst) / (1 - self.best)

    def _place(self, at: int) -> tuple[si.Metre, si.Metre]:
        i, j = np.unravel_index(at, self.amplitude.shape)
        return float(self.x[i]), float(self.y[j])

    @property
    def best_place(self) -> tuple[si.Metre, si.Metre] | None:
        """Where µ′/µ is lowest (m); of places alike the first."""
        if self.relative_friction is None:
            return None
        return self._place(int(np.nanargmin(np.round(self.relative_friction, 9))))

    @property
    def worst_place(self) -> tuple[si.Metre, si.Metre] | None:
        """Where µ′/µ is highest (m); of places alike the first."""
        if self.relative_friction is None:
            return None
        return self._place(int(np.nanargmax(np.round(self.relative_friction, 9))))

    @property
    def of_note(self) -> tuple[tuple[tuple[si.Metre, si.Metre], si.Metre], ...]:
        """The best place, one in the median and the worst (m), each with the best antinode's
        amplitude (m) while the finger is there; none where the friction is not known."""
        if self.relative_friction is None:
            return ()
        near = np.round(self.relative_friction, 9), self.lobe_amplitude.ravel()
        wanted = (self.best, self.median, self.worst)
        found = [
            int(np.nanargmin(np.abs(near[0] - value))) for value in wanted if value is not None
        ]
        return tuple((self._place(at), float(near[1][at])) for at in found)

    @property
    def amplitude_range(self) -> tuple[si.Metre, si.Metre]:
        """The least and the largest root mean square under the pad (m)."""
        under = self.amplitude_under_pad
        return float(np.nanmin(under)), float(np.nanmax(under))

    @property
    def sentence(self) -> str:
        """The range, its places and the share, for people."""
        sides = [1e3 * float(axis[-1] - axis[0]) for axis in (self.x, self.y)]
        size = " × ".join(f"{side:.3g} mm" for side in sides if side > 0) or "one place"
        head = f"Over the active area of {size} ({self.rule})"
        if self.best_place is None or self.worst_place is None:
            low, high = (1e6 * one for one in self.amplitude_range)
            return (
                f"{head} the amplitude under the pad is {low:.3g} µm to {high:.3g} µm (root mean "
                f"square); the friction there is not known: {self.why_not}."
            )
        return (
            f"{head} µ′/µ is {self.best:.2f} at the best place ({place_words(self.best_place)}), "
            f"{self.median:.2f} in the median and {self.worst:.2f} at the worst "
            f"({place_words(self.worst_place)}); it is below {CRITERIA[0]:.2f} on "
            f"{percent(self.share_below(CRITERIA[0]))} and below {CRITERIA[1]:.2f} on "
            f"{percent(self.share_below(CRITERIA[1]))} of the area."
        )

    def summary(self) -> dict[str, Any]:
        """What JSON has under `active_area`; keys carry units."""
        return {
            "x_m": [float(self.x[0]), float(self.x[-1])],
            "y_m": [float(self.y[0]), float(self.y[-1])],
            "rule": self.rule,
            "places": [self.x.size, self.y.size],
            "amplitude_under_pad_m": list(self.amplitude_range),
            "relative_friction": None
            if self.best_place is None or self.worst_place is None
            else {
                "best": self.best,
                "median": self.median,
                "worst": self.worst,
                "best_place_m": list(self.best_place),
                "worst_place_m": list(self.worst_place),
            },
            "share_below": {f"{one:.2f}": self.share_below(one) for one in CRITERIA},
            "uniformity": self.uniformity,
            "uniformity_is": "least friction reduction over greatest",
            "shape_model": self.shape_model,
            "shape": self.shape_words,
            "why_no_friction": self.why_not,
        }


def percent(share: si.Dimensionless | None) -> str:
    """A share in whole percent, "61 %"; never 0 or 100 unless it is."""
    if share is None:
        return "an unknown share"
    if 0 < share < 0.005 or 0.995 < share < 1:
        return "less than 1 %" if share < 0.5 else "more than 99 %"
    return f"{100 * share:.0f} %"


@si.checked_numbers
def active_area(
    display: Display, prediction: Prediction, *, refinement: int = 1
) -> ActiveArea | None:
    """The active area of a display at the working point of a prediction.

    Its places are the display's own `active_area`, or those from which the contact does not
    overhang the face, the best antinode among them; `refinement` times the default dozen to a half
    wavelength (96 at the most). The shape of the vibration is that without a finger: one finger
    changes it by the small parts that its neighbouring modes have. None where the actuator's mode
    has no shape over a face.
    """
    p = prediction
    try:
        shape = surface_shape(display.actuator, p.mode, p.frequency)
    except OutOfRangeError:
        return None
    side = p.law.contact_side
    x, y, rule = _places(display.active_area, shape, side, refinement)
    points = pad_points(p.law.finger, side)
    at_centre = shape.grid(x, y)
    at = np.argwhere(_inside(shape, side, x, y, display.active_area))
    parts = np.array_split(at, -(-at.shape[0] * points[0].size // _AT_A_TIME))
    met = [met_by_pads(shape, x[one[:, 0]], y[one[:, 1]], points) for one in parts]
    swings = np.concatenate([swings for swings, _ in met])
    # Points beside the face carry nothing, the others in their stead.
    weights = np.concatenate([there for _, there in met]).astype(float)
    weights /= np.sum(weights, axis=1, keepdims=True)
    mean_square = np.sum(weights * swings**2, axis=1)
    lobe = np.full(mean_square.shape, p.vibration_amplitude)
    if p.voltage is not None:
        lobe = touched_amplitudes(p.mode, p.law, p.touch.free_amplitude, mean_square)

    def over(values: si.FloatArray) -> si.FloatArray:
        """Values of the places there are, where they belong."""
        grid = np.full(at_centre.shape, np.nan)
        grid[at[:, 0], at[:, 1]] = values
        return grid

    friction, why_not = None, ""
    try:
        friction = over(_friction(p, lobe[:, None] * swings, weights))
    except SqueezefilmError as error:
        why_not = str(error)
    return ActiveArea(
        x=x,
        y=y,
        amplitude=over(lobe) * at_centre,
        lobe_amplitude=over(lobe),
        amplitude_under_pad=over(lobe * np.sqrt(mean_square)),
        relative_friction=friction,
        contact_side=side,
        rule=rule,
        shape_model=shape.model,
        shape_words=shape.words,
        why_not=why_not,
    )


def _friction(
    p: Prediction, met: si.MetreArray, weights: si.DimensionlessArray
) -> si.DimensionlessArray:
    """µ′/µ of pads whose points meet amplitudes (m) and carry shares of the load, both of shape
    (places, points)."""
    kind = p.law.kind
    if kind.film != "shared" or kind.limit != "own":
        raise OutOfRangeError(
            f"the model '{p.model}' does not give each ridge a balance of its own, and so no "
            "friction beside the antinodes"
        )
    highest = float(np.max(met))
    if highest == 0:
        return np.ones(met.shape[0])
    # Denser at small amplitudes, where the law bends within the roughness.
    knots = highest * np.linspace(0, 1, _KNOTS) ** 2
    each = np.interp(met, knots, p.law.ridge_friction(knots))
    return np.asarray(np.sum(weights * each, axis=1))


def _places(
    region: ActiveRegion | None, shape: SurfaceShape, side: si.Metre, refinement: int
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
    step = shape.half_wavelength / (_TO_A_HALF_WAVE * refinement)
    x, y = (
        _along(span, step, at, _MOST_PLACES * refinement)
        for span, at in zip(spans, shape.lobe, strict=True)
    )
    return x, y, rule


def _along(
    span: tuple[si.Metre, si.Metre], step: si.Metre, lobe: si.Metre, most: int
) -> si.MetreArray:
    """Places along a side, evenly but for the best antinode, where friction is at its sharpest."""
    low, high = span
    if high <= low:
        return np.array([low])
    count = int(np.clip(np.ceil((high - low) / step), _LEAST_PLACES - 1, most))
    places = np.linspace(low, high, count + 1)
    nearest = int(np.argmin(np.abs(places - lobe)))
    if low <= lobe <= high and abs(places[nearest] - lobe) > 1e-6 * (high - low):
        places = np.sort(np.append(places, lobe))
    return places


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
    """Whether places are in the area: near a round rim only those half a contact from it."""
    left, right, _, _ = shape.bounds
    if region is not None or left >= 0:
        return np.ones((x.size, y.size), dtype=bool)
    reach = max(right - side / 2, 1e-9)
    return np.asarray(np.hypot(x[:, None], y[None, :]) <= reach * (1 + 1e-9))


def _halfway(values: si.FloatArray) -> si.FloatArray:
    """Values along the first axis at the middles of equal parts between every two of them."""
    if values.shape[0] == 1:
        return values
    t = ((np.arange(_BETWEEN) + 0.5) / _BETWEEN)[:, None]
    between = values[:-1, None] * (1 - t) + values[1:, None] * t
    return between.reshape(-1, values.shape[1])


def _parts(places: si.MetreArray) -> si.MetreArray:
    """How long these parts are; all of one place."""
    return np.ones(1) if places.size == 1 else np.repeat(np.diff(places) / _BETWEEN, _BETWEEN)
