"""The working mode of a plate by the solved solid, with its response: what a display's chain needs.

One plate is asked for its mode many times (analysis, curves, tests), so the last few answers are
kept.
"""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.solid.model import PlateModel
from squeezefilm.plate.solid.modes import MODEL, PlateModes
from squeezefilm.plate.solid.reduced import class_drive
from squeezefilm.plate.solid.refined_modes import RefinedModes
from squeezefilm.plate.solid.response import HarmonicResponse, harmonic_response
from squeezefilm.plate.solid.solve import solve_for_response
from squeezefilm.progress import ShareProgress

RESPONSE_POINTS = 200
_LINE_POINTS = 401
# Enough for a display, and nearly always met by the first refinement; the estimate stands beside
# the frequency.
_TOLERANCE = 3e-3
# The part of the time that the modes take; the response takes the rest.
_MODES = 0.8


@si.checked_numbers
def response_frequencies(
    frequency: si.Hertz,
    quality_factor: si.Dimensionless,
    points: Annotated[int, si.AtLeast(2)] = RESPONSE_POINTS,
) -> si.FloatArray:
    """Frequencies (Hz) around a resonance, ±8/Q, dense where the curve turns within f/Q.

    Raises `InputError` for fewer than 2 points.
    """
    span = min(max(8 / quality_factor, 0.02), 0.5)
    near = np.sinh(np.linspace(-4, 4, points)) / np.sinh(4)
    return np.asarray(frequency * (1 + span * near))


@dataclass(frozen=True, eq=False)
class SolidMode:
    """One mode of a plate, its response to one volt, and its centreline at resonance.

    `modes` holds it at `index`; `response` surrounds the resonance. `position` and `deflection` are
    the mode along the centreline of the upper face that crosses its nodal lines (along the length,
    or the width), 1 at its largest interior lobe, which is at `lobe` (x, y);
    `nodal_positions` the nodal lines along it; `amplitude_per_volt` is the largest
    answer of that lobe within the mode's bandwidth, `modal_amplitude_per_volt` what this mode has
    in it, Q F φ / ω²: much less where the drive moves its neighbours only.
    `amplitude_error` is the estimated error of `amplitude_per_volt`: of the discretisation, by
    what the mode's answer to the drive differs between the two meshes, and of the reduction.
    `modal_mass` is the mass that has the mode's kinetic energy if it moves as the lobe does.
    """

    modes: PlateModes
    index: int
    response: HarmonicResponse
    position: si.MetreArray
    deflection: si.FloatArray
    nodal_positions: si.MetreArray
    lobe: tuple[si.Metre, si.Metre]
    amplitude_per_volt: si.MetrePerVolt
    modal_amplitude_per_volt: si.MetrePerVolt
    modal_mass: si.Kilogram
    amplitude_error: si.MetrePerVolt
    model: str = MODEL

    @property
    def frequency(self) -> si.Hertz:
        """Resonance frequency (Hz), extrapolated from two meshes."""
        return float(self.modes.frequencies[self.index])

    @property
    def frequency_error(self) -> si.Hertz:
        """Estimated error of `frequency` (Hz): of the discretisation, not of the data."""
        return float(self.modes.errors[self.index])

    @property
    def quality_factor(self) -> si.Dimensionless:
        """From the materials' losses, weighted by their share of the energy."""
        return float(self.modes.quality_factors[self.index])

    @property
    def half_wavelength(self) -> si.Metre:
        """See `PlateModes.half_wavelength` (m)."""
        return self.modes.half_wavelength(self.index)

    @si.checked_numbers
    def amplitude_per_volt_at(self, frequency: si.HertzLike) -> si.MetrePerVoltArray:
        """|w| per volt (m/V) at the largest interior lobe of the centreline, at frequencies (Hz).

        Of the solved response within its band, solved anew beyond; all modes in. Raises
        `InputError` unless they are above 0.
        """
        wanted = np.atleast_1d(np.asarray(frequency, dtype=float))
        si.require("frequency", wanted, si.Unit("Hz"), above=0)
        # With the resonance in the band, its mode is in the reduced space and not far outside.
        known = self.response.frequencies
        band, back = np.unique(np.append(wanted, self.frequency), return_inverse=True)
        inside = known[0] <= band[0] and band[-1] <= known[-1]
        plate = self.modes.plate
        response = self.response.at(band) if inside else harmonic_response(plate, band)
        amplitude = response.amplitude_at(*self.lobe)
        return np.asarray(amplitude[back[: wanted.size]])


@dataclass(frozen=True, slots=True)
class _Listener:
    """Who is told how far a solve is: no part of what was asked, so that a cache sees one key."""

    tell: ShareProgress | None = field(default=None, compare=False)

    def share(self, first: float, last: float) -> ShareProgress | None:
        """Whom a part of the work tells, which goes from one fraction of the whole to another."""
        tell = self.tell
        if tell is None:
            return None
        return lambda text, fraction: tell(text, first + (last - first) * fraction)


@si.checked_numbers
def solid_mode(
    plate: RectangularPlate,
    label: tuple[int, int] | None = None,
    *,
    progress: ShareProgress | None = None,
) -> SolidMode:
    """A plate's mode with the nodal lines of `label` by three-dimensional piezoelectric elements.

    Without a label the plate's working mode. `progress` is called with a text and a fraction; the
    last plates that were solved are kept. Raises what `solve_modes` and `harmonic_response` raise:
    `InputError` where there is no such mode or nothing drives the plate, `GeometryError` for a
    plate that the elements cannot carry.
    """
    return _solid_mode(plate, label, _Listener(progress))


# A plate keeps 10 to 100 MB.
@functools.lru_cache(maxsize=8)
def _solid_mode(
    plate: RectangularPlate, label: tuple[int, int] | None, listener: _Listener
) -> SolidMode:
    wanted = label or plate.working_label
    modes, pieces = solve_for_response(plate, wanted, _TOLERANCE, listener.share(0.0, _MODES))
    index = modes.index(wanted)
    frequency, quality = float(modes.frequencies[index]), float(modes.quality_factors[index])
    response = dataclasses.replace(
        harmonic_response(
            plate,
            response_frequencies(frequency, quality),
            progress=listener.share(_MODES, 1.0),
            solved=pieces,
        ),
        _again=functools.partial(_response_again, plate, label),
    )
    lengthwise = wanted[0] >= wanted[1]
    span, across = (plate.length, plate.width)[:: 1 if lengthwise else -1]
    x, middle = np.linspace(0, span, _LINE_POINTS), np.array([across / 2])
    if lengthwise:
        line = modes.field(index, x, middle, plate.thickness)[:, 0, 2]
    else:
        line = modes.field(index, middle, x, plate.thickness)[0, :, 2]
    nodes = modes.nodal_positions(index)
    inside = _interior(x, nodes)
    at = int(np.flatnonzero(inside)[np.argmax(np.abs(line[inside]))])
    near = np.abs(response.frequencies / frequency - 1) < 1 / quality
    lobe = float(x[at]), across / 2
    lobe = lobe if lengthwise else lobe[::-1]
    amplitude = response.amplitude_at(*lobe)
    # At the mode, not at the highest point of the band: a neighbour may move more.
    per_volt = float(np.max(np.where(near, amplitude, 0.0)))
    doubt = _answer_change(pieces, float(modes.mesh_frequencies[index]), lobe)
    return SolidMode(
        modes=modes,
        index=index,
        response=response,
        position=x,
        deflection=line / line[at],
        nodal_positions=nodes,
        lobe=lobe,
        amplitude_per_volt=per_volt,
        modal_amplitude_per_volt=float(
            quality * abs(modes.drive_forces[index] * line[at]) / (2 * np.pi * frequency) ** 2
        ),
        modal_mass=float(1 / line[at] ** 2),
        amplitude_error=(doubt + response.truncation_error) * per_volt,
    )


def _answer_change(
    pieces: list[RefinedModes], frequency: si.Hertz, lobe: tuple[si.Metre, si.Metre]
) -> si.Dimensionless:
    """How much a mode's answer to the drive at a point, F φ / ω², changed from the coarse mesh to
    the refined one: the refined one lacks less than that."""

    def answer(solved: PlateModel, value: float, vector: si.FloatArray) -> float:
        G, _ = solved.slabs.electrode_columns
        x, y = (np.array([place]) for place in lobe)
        w = solved.field(vector[:, None], x, y, solved.plate.thickness)[0, 0, 0, 2]
        return float(abs((G @ class_drive(solved)) @ vector * w) / value)

    wanted = (2 * np.pi * frequency) ** 2
    piece = min(pieces, key=lambda one: float(np.min(np.abs(one.values - wanted))))
    at = int(np.argmin(np.abs(piece.values - wanted)))
    rough, number = piece.found, piece.index[at]
    fine = answer(piece.solved, piece.values[at], piece.vectors[:, at])
    if fine == 0:
        return 0.0
    coarse = answer(rough.solved, rough.values[number], rough.vectors[:, number])
    return abs(coarse / fine - 1)


def _response_again(plate: RectangularPlate, label: tuple[int, int] | None) -> HarmonicResponse:
    return solid_mode(plate, label).response


def _interior(
    position: si.MetreArray, nodes: si.MetreArray
) -> np.ndarray[tuple[int], np.dtype[np.bool]]:
    """Between the outermost nodal lines: free ends move further than any finger meets."""
    if nodes.size < 2:
        return np.ones(position.size, dtype=bool)
    return np.asarray((position > nodes[0]) & (position < nodes[-1]))
