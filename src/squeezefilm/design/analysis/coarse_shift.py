"""Shift of a plate's working mode with another glue, by its solid on the coarse mesh.

A beam has no glue, and a solve on two meshes takes seconds. The coarse mesh lacks as much of the
changed plate as of the described one, so that what differs between the two is right to a few
percent of itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.layers import COARSE
from squeezefilm.physics.plate.solid.response import HarmonicResponse, harmonic_response
from squeezefilm.physics.plate.working_mode import WorkingMode

# The band around the mode (a share of its frequency either way) that is searched, its frequencies,
# and the steps of the reduction: with 14 steps the shifts of the presets stay within 1e-4.
_REACH, _POINTS, _STEPS = 0.06, 1201, 6
# The coarse mesh is up to a percent too stiff: so far off the described mode is looked for.
_NEAR = 0.015
_GRID = (25, 17)


class ModeShift(NamedTuple):
    """Relative changes of the resonance frequency and of the amplitude per volt at the lobe."""

    frequency: si.Dimensionless
    amplitude: si.Dimensionless


class CoarseShifts:
    """Shifts of one plate's mode; the plate as described is solved when the first is asked for."""

    def __init__(self, plate: RectangularPlate, mode: WorkingMode) -> None:
        self.plate, self.mode = plate, mode
        self._described: tuple[si.ComplexArray, float, float] | None = None

    def to(self, changed: RectangularPlate) -> ModeShift:
        """The shifts from the plate as described to another one of the same sides.

        The mode is found again as the largest answer in the shape that it has as described. 0.1 to
        0.4 s for each plate (processor time, presets). Within 8 % of the shift of the frequency and
        within 3 % of that of the amplitude of plates solved on two meshes
        (`tests/verification/test_plate_sensitivity.py`). Raises `OutOfRangeError` where the mode
        leaves 6 % of its frequency or is not driven, and what `harmonic_response` raises.
        """
        if self._described is None:
            response = self._response(self.plate)
            f0 = self.mode.resonance_frequency
            answer = response.amplitude_at(*self.mode.lobe)
            near = np.flatnonzero(np.abs(response.frequencies / f0 - 1) < _NEAR)
            at = int(near[np.argmax(answer[near])])
            if at in (near[0], near[-1]):
                raise OutOfRangeError(
                    "the drive does not move this mode, so that there is no amplitude to compare; "
                    "choose a mode that it drives (squeezefilm modes lists them)"
                )
            shape = self._surface(response)[at]
            self._described = shape, *self._peak(response, shape)
        shape, frequency, amplitude = self._described
        there, moves = self._peak(self._response(changed), shape)
        return ModeShift(there / frequency - 1, moves / amplitude - 1)

    def _response(self, plate: RectangularPlate) -> HarmonicResponse:
        band = self.mode.resonance_frequency * np.linspace(1 - _REACH, 1 + _REACH, _POINTS)
        return harmonic_response(plate, band, steps=_STEPS, resolution=COARSE, extrapolate=False)

    def _surface(self, response: HarmonicResponse) -> si.ComplexArray:
        """The motion of the upper face, shape (frequencies, places)."""
        x, y = (
            np.linspace(0, side, count)
            for side, count in zip((self.plate.length, self.plate.width), _GRID, strict=True)
        )
        return response.displacement(x, y).reshape(response.frequencies.size, -1)

    def _peak(
        self, response: HarmonicResponse, shape: si.ComplexArray
    ) -> tuple[si.Hertz, si.MetrePerVolt]:
        """Frequency of the largest motion in a shape (Hz), and the lobe's amplitude there (m/V)."""
        f = response.frequencies
        alike = np.abs(self._surface(response) @ shape.conj())
        at = int(np.argmax(alike))
        if not 0 < at < f.size - 1:
            raise OutOfRangeError(
                f"this glue moves the mode by more than {si.percent(_REACH)}; ask for the solved "
                "plate (sensitivities solved)"
            )
        # A resonance is a parabola in 1/|w|², near its top between the points of the band too.
        low, top, high = 1 / alike[at - 1 : at + 2] ** 2
        off = (low - high) / (2 * (low - 2 * top + high))
        frequency = float(f[at] + off * (f[1] - f[0]))
        lobe = response.at(np.array([frequency])).amplitude_at(*self.mode.lobe)
        return frequency, float(lobe[0])
