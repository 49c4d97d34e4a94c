"""Motion of a solved plate's face at its resonance, at the places of a scan; a line beside it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, NamedTuple

import numpy as np
from scipy.interpolate import RectBivariateSpline

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import Adequacy, Estimate, adequacy_of
from squeezefilm.measure.fits.least_squares import fit_separable
from squeezefilm.physics.plate.solid.working import SolidMode

REST = "what else the drive moves"
"""The label of the motion that is not the working mode's, beside the labels of modes."""


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class DrivenShape:
    """The motion of a face at places `x`, `y` (m), shapes (x, y), at a resonance: `swing` in phase
    with the best antinode, 1 there, and `rest` a quarter of a period away from that, 0 there.

    At its resonance a mode answers a quarter of a period late; all others that the drive moves,
    among them those far away in frequency, answer at once. They are what a scan has beside the
    mode, of some per cent, and no neighbour alone describes them. `lobe` (m) is the antinode's
    place, `lengthwise` says that nodal lines lie across the length; `half_wavelength` (m) is the
    mode's, of its profile over the whole face, which differs from that along one line.
    """

    x: si.MetreArray
    y: si.MetreArray
    swing: si.DimensionlessArray
    rest: si.DimensionlessArray
    lobe: tuple[si.Metre, si.Metre]
    lengthwise: bool
    half_wavelength: si.Metre

    @classmethod
    def of(cls, mode: SolidMode) -> DrivenShape:
        """Shape of a solved mode at its own resonance."""
        response, at = mode.driven_at()
        x, y = mode.modes.x, mode.modes.y
        there = response.motion(at, *(np.array([place]) for place in mode.lobe))[0, 0]
        turned = response.motion(at, x, y) / there
        lines = mode.modes.labels[mode.index] or (1, 0)
        lengthwise = lines[0] >= lines[1]
        half = mode.half_wavelength
        return cls(x, y, turned.real, turned.imag, mode.lobe, lengthwise, half)

    @cached_property
    def _splines(self) -> tuple[RectBivariateSpline, RectBivariateSpline]:
        swing, rest = (
            RectBivariateSpline(self.x, self.y, motion) for motion in (self.swing, self.rest)
        )
        return swing, rest

    @si.checked_numbers
    def at(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        """Swing and rest (2, points) at places (m); beside the face those of its edge.

        Raises `InputError` for places that are no rows of one length.
        """
        si.require_alike(x=x, y=y)
        return np.array([spline.ev(x, y) for spline in self._splines])

    @si.checked_numbers
    def along(self, position: si.MetreArray) -> si.DimensionlessArray:
        """Swing and rest (2, points) along the line through the best antinode that crosses the
        nodal lines, from the face's edge (m)."""
        if self.lengthwise:
            return self.at(position, np.full(position.size, self.lobe[1]))
        return self.at(np.full(position.size, self.lobe[0]), position)

    @property
    def antinode(self) -> si.Metre:
        """Place of the best antinode on that line (m)."""
        return self.lobe[0 if self.lengthwise else 1]


class LineByShape(NamedTuple):
    """A line scan as a multiple of a solved shape: the antinode's `amplitude` (m) and `phase` (rad,
    None without a recorded one), the `offset` (m) of the scan's zero from the face's edge, and the
    fitted `model` (m, (points,)) of data whose sign of the phase is right."""

    amplitude: Estimate
    phase: Estimate | None
    offset: Estimate
    model: si.Array
    phase_reversed: bool
    adequacy: Adequacy


@si.checked_numbers
def line_by_shape(
    shape: DrivenShape,
    x: si.MetreArray,
    w: si.Array,
    *,
    reach: Annotated[si.Metre, si.Above(0.0)],
) -> LineByShape:
    """The shape of the line that fits displacements `w` (m, real or complex) at rising `x` (m).

    Swing and rest have each a weight of its own; the line may begin up to `reach` (m) from the
    face's edge. The line is taken to run through the best antinode. Raises `InputError` where
    there are fewer points than numbers, the places do not rise, or nothing moves.
    """
    w = np.asarray(w)
    if w.dtype.kind not in "fc" or not np.all(np.isfinite(w)) or not np.any(w):
        raise InputError("w must be finite displacements, not all of them 0", quantity="w")
    si.require_alike(x=x, w=w)
    if not np.all(np.diff(x) > 0) or x.size < 2:
        raise InputError("x must rise from point to point", quantity="x")
    recorded = np.iscomplexobj(w)

    def rows(offset: float) -> si.Array:
        swing, rest = shape.along(x + offset)
        return np.stack([swing, rest] if recorded else [swing], axis=1)

    def columns(own: si.FloatArray) -> tuple[si.Array, si.Array]:
        offset, step = float(own[0]), 1e-3 * reach
        bent = (rows(offset + step) - rows(offset - step)) / (2 * step)
        return rows(offset), bent[None]

    size = float(np.max(np.abs(w)))
    fit = fit_separable(columns, w / size, np.zeros(1), reach=reach)
    reversed_ = False
    if recorded:
        # The rest moves at once and the mode late: ahead of the swing, unless the sign is wrong.
        ahead = fit.estimate(lambda _, c: float((c[1] * np.conj(c[0])).imag), "1")
        reversed_ = ahead.interval[1] < 0
    if reversed_:
        w = w.conj()
        fit = fit_separable(columns, w / size, np.zeros(1), reach=reach)
    adequacy = adequacy_of(
        w,
        fit.residual * size,
        lambda i: f"{1e3 * x[i]:.3g} mm along the line",
        model="The plate's solved shape",
        said="No even wave fits, as on any plate with ceramics. "
        + ("The phase was recorded with the other sign. " if reversed_ else ""),
        remedy="Check that the line runs through the best antinode from the plate's edge, or doubt "
        "the solved plate.",
    )
    return LineByShape(
        amplitude=fit.estimate(lambda _, c: size * float(abs(c[0])), "m", positive=True),
        phase=fit.angle(lambda _, weights: complex(weights[0])) if recorded else None,
        offset=fit.estimate(lambda numbers, _: float(numbers[0]), "m"),
        model=fit.model * size,
        phase_reversed=reversed_,
        adequacy=adequacy,
    )
