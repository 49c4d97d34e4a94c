"""The active area of a display: what a finger meets at every place of it, in numbers and words."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.results import values_of
from squeezefilm.physics.chain.pad_place import place_words

CRITERIA: tuple[si.Dimensionless, ...] = (0.70, 0.80)
"""The paper asks for µ′/µ of 0.70; from 0.80 on, a drop of 0.2, people notice it."""

# Between places, for shares and the median: linear.
_BETWEEN = 8


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
        """Relative friction µ′/µ over small parts of the area, rising, and the share of the area
        that each is."""
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
        """Place where µ′/µ is lowest (m), of places alike the one that moves most."""
        if self.relative_friction is None:
            return None
        return self._place(lowest(self.relative_friction, self.amplitude))

    @property
    def worst_place(self) -> tuple[si.Metre, si.Metre] | None:
        """Place where µ′/µ is highest (m); of places alike the first."""
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
        places = [
            int(np.nanargmin(np.abs(near[0] - value))) for value in wanted if value is not None
        ]
        return tuple((self._place(at), float(near[1][at])) for at in places)

    @property
    def amplitude_range(self) -> tuple[si.Metre, si.Metre]:
        """The least and the largest root mean square under the pad (m)."""
        under = self.amplitude_under_pad
        return float(np.nanmin(under)), float(np.nanmax(under))

    @property
    def _size_said(self) -> str:
        """Size as it follows "the active area"; a disc's has no corners."""
        sides = [1e3 * float(axis[-1] - axis[0]) for axis in (self.x, self.y)]
        if np.isnan(self.amplitude[0, 0]):
            return f", a disc of {sides[0]:.3g} mm"
        size = " × ".join(f"{side:.3g} mm" for side in sides if side > 0)
        return f" of {size or 'one place'}"

    @property
    def sentence(self) -> str:
        """The range, its places and the share, for people."""
        head = f"Over the active area{self._size_said} ({self.rule})"
        if self.best_place is None or self.worst_place is None:
            low, high = (1e6 * amplitude for amplitude in self.amplitude_range)
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
        """Mapping that JSON has under `active_area`; keys carry units."""
        return {
            "x_m": [float(self.x[0]), float(self.x[-1])],
            "y_m": [float(self.y[0]), float(self.y[-1])],
            "rule": self.rule,
            "places": [self.x.size, self.y.size],
            "amplitude_under_pad_m": list(self.amplitude_range),
            "relative_friction": None
            if self.best_place is None or self.worst_place is None
            else {
                **values_of(self, "best median worst"),
                "best_place_m": list(self.best_place),
                "worst_place_m": list(self.worst_place),
            },
            "share_below": {
                f"{criterion:.2f}": self.share_below(criterion) for criterion in CRITERIA
            },
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


def lowest(relative_friction: si.DimensionlessArray, moved: si.FloatArray) -> int:
    """Index at which a map of µ′/µ is lowest; of places alike the one that is moved most, so that a
    vibration too small for any friction to fall has its best place where a larger one has it."""
    rounded = np.round(relative_friction, 9)
    alike = rounded == np.nanmin(rounded)
    size = np.abs(moved)
    return int(np.argmax(np.where(alike, np.round(size / (np.nanmax(size) or 1.0), 9), -1.0)))


def _halfway(values: si.FloatArray) -> si.FloatArray:
    """Values along the first axis at the middles of equal parts between every two of them."""
    if values.shape[0] == 1:
        return values
    t = ((np.arange(_BETWEEN) + 0.5) / _BETWEEN)[:, None]
    between = values[:-1, None] * (1 - t) + values[1:, None] * t
    return between.reshape(-1, values.shape[1])


def _parts(places: si.MetreArray) -> si.MetreArray:
    """Lengths of these parts; all of one place."""
    return np.ones(1) if places.size == 1 else np.repeat(np.diff(places) / _BETWEEN, _BETWEEN)
