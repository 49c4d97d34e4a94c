"""The working mode of a plate by the solved solid, with its response: what a display's chain needs.

One plate is asked for its mode many times (analysis, curves, tests), so the last few answers are
kept.
"""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import NO_HURRY, Deadline, Pace
from squeezefilm.physics.plate.circuit import (
    EquivalentCircuit,
    motional_branch,
    resolved_circuit,
)
from squeezefilm.physics.plate.elements.nodal_lines import largest_lobe
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.forecast import estimated_frequency, solve_size
from squeezefilm.physics.plate.solid.layers import Resolution
from squeezefilm.physics.plate.solid.modes import COARSE_AMPLITUDE_ERROR, MODEL, Label, PlateModes
from squeezefilm.physics.plate.solid.reduced import class_drive
from squeezefilm.physics.plate.solid.refined_modes import RefinedModes
from squeezefilm.physics.plate.solid.resonances import (
    Moving,
    Neighbour,
    label_name,
    strongest_neighbour,
)
from squeezefilm.physics.plate.solid.response import HarmonicResponse, harmonic_response
from squeezefilm.physics.plate.solid.solve import ModesRequest, solved_classes
from squeezefilm.physics.plate.solid.symmetry import PlateModel
from squeezefilm.physics.plate.sound import RadiatingSurface, smooth_surface

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
    """A mode of a plate, its response to one volt, and its centreline at resonance.

    `modes` holds it at `index`; `response` surrounds the resonance. `position` and `deflection` are
    the mode along the centreline of the upper face that crosses its nodal lines (along the length,
    or the width), 1 at its largest interior lobe, the antinode at `lobe` (x, y).

    `resonance` is the number of the response's frequency, within the mode's bandwidth, at which the
    antinode answers most; `amplitude_per_volt` is that answer, all modes in, `largest_per_volt` the
    largest anywhere on the face at the same frequency, and `alone_per_volt` what this mode has of
    the answer, Q F φ / ω²: much less where the drive moves its neighbours only.
    `amplitude_error` is the estimated error of `amplitude_per_volt`: of the discretisation, by
    what the mode's answer to the drive differs between the two meshes, and of the reduction.
    `modal_mass` is the mass that has the mode's kinetic energy if it moves as the lobe does.
    """

    modes: PlateModes
    index: int
    response: HarmonicResponse
    position: si.MetreArray
    deflection: si.FloatArray
    lobe: tuple[si.Metre, si.Metre]
    resonance: int
    amplitude_per_volt: si.MetrePerVolt
    largest_per_volt: si.MetrePerVolt
    alone_per_volt: si.MetrePerVolt
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
    def coarseness(self) -> str:
        """Sentence on a mode that a budget left on the coarse mesh; empty for others."""
        return self.modes.coarseness

    @property
    def quality_factor(self) -> si.Dimensionless:
        """Quality factor from the materials' losses, weighted by their share of the energy."""
        return float(self.modes.quality_factors[self.index])

    @property
    def half_wavelength(self) -> si.Metre:
        """See `PlateModes.half_wavelength` (m)."""
        return self.modes.half_wavelength(self.index)

    @property
    def circuit(self) -> EquivalentCircuit | None:
        """The mode's equivalent circuit; None where it has none, as `circuit_said` tells."""
        return self._circuit[0]

    @property
    def circuit_said(self) -> str:
        """Sentence on the circuit: why there is none, or that neighbours draw most of the power;
        empty for one that describes the plate near its resonance."""
        return self._circuit[1]

    @functools.cached_property
    def _circuit(self) -> tuple[EquivalentCircuit | None, str]:
        force = float(self.modes.drive_forces[self.index])
        if force == 0:
            return None, "none: the drive exerts no force on this mode"
        branch = motional_branch(self.frequency, self.quality_factor, 1.0, force)
        return resolved_circuit(branch, self.response)

    @functools.cached_property
    def neighbour(self) -> Neighbour | None:
        """The driven mode that adds most at this one's resonance; None where there is no other."""
        half = self.frequency / (2 * self.quality_factor)
        own = Moving(self.name, self.frequency, half, self.alone_per_volt)
        return strongest_neighbour(own, self.response.beside(self.frequency))

    @property
    def name(self) -> str:
        """The nodal lines across length and width, "(8,0)"."""
        return label_name(self.modes.labels[self.index])

    @si.checked_numbers
    def amplitude_per_volt_at(self, frequency: si.HertzLike) -> si.MetrePerVoltArray:
        """|w| per volt (m/V) at the largest interior lobe of the centreline, at frequencies (Hz).

        Of the solved response within its band, solved anew beyond; all modes in. Raises
        `InputError` unless they are above 0.
        """
        wanted = np.atleast_1d(np.asarray(frequency, dtype=float))
        si.require("frequency", wanted, si.Unit("Hz"), above=0)
        # With the resonance in the band, its mode is in the reduced space and not far outside.
        band, back = np.unique(np.append(wanted, self.frequency), return_inverse=True)
        amplitude = self._response(band).amplitude_at(*self.lobe)
        return np.asarray(amplitude[back[: wanted.size]])

    @si.checked_numbers
    def driven_at(self, frequency: si.Hertz | None = None) -> tuple[HarmonicResponse, int]:
        """A response of the plate, and which of its frequencies is the one asked for (Hz).

        Without one that at which the lobe answers most within the mode's bandwidth, whose answer
        is `amplitude_per_volt`. Raises `InputError` unless it is above 0.
        """
        if frequency is None or frequency == self.frequency:
            return self.response, self.resonance
        si.require("frequency", frequency, si.Unit("Hz"), above=0)
        band = np.union1d([frequency], self.frequency)
        return self._response(band), int(np.searchsorted(band, frequency))

    @si.checked_numbers
    def radiating(
        self,
        voltage: Annotated[si.Volt, si.AtLeast(0.0)],
        frequency: Annotated[si.Hertz, si.Above(0.0)],
    ) -> RadiatingSurface:
        """The upper face as a source of sound, without a finger: as it moves at resonance under a
        voltage (V, zero to peak), at a drive's frequency (Hz)."""
        factor = 2j * np.pi * frequency * voltage
        return smooth_surface(
            self.modes.plate.extent,
            lambda x, y: factor * self.response.motion(self.resonance, x, y),
            frequency,
            2 * self.half_wavelength,
        )

    def _response(self, frequencies: si.HertzArray) -> HarmonicResponse:
        known = self.response.frequencies
        if known[0] <= frequencies[0] and frequencies[-1] <= known[-1]:
            return self.response.at(frequencies)
        return _response(self.modes.plate, tuple(frequencies.tolist()), self.modes.resolution)


_KEPT: Kept[SolidMode] = Kept("solved-plates", SolidMode, large=True)


@functools.lru_cache(maxsize=4)
def _response(
    plate: RectangularPlate, frequencies: tuple[float, ...], resolution: Resolution
) -> HarmonicResponse:
    """The last few responses beside a resonance: amplitude and shape are both asked of one."""
    return harmonic_response(plate, np.array(frequencies), resolution=resolution)


@si.checked_numbers
def solid_mode(
    plate: RectangularPlate,
    label: tuple[int, int] | None = None,
    *,
    pace: Pace = NO_HURRY,
) -> SolidMode:
    """A plate's mode with the nodal lines of `label` by three-dimensional piezoelectric elements.

    Without a label the plate's working mode. `pace` is told a text and a fraction, and its budget
    bounds the time: where finer meshes would not end in time the coarse one's answer is given, with
    its larger error (`coarseness`). The last plates that were solved are kept, those under each
    budget by themselves; in full also on disk, from one process to the next (`Kept`).
    Raises what `solve_modes` and `harmonic_response` raise: `InputError` where there is no such
    mode or nothing drives the plate, `GeometryError` for a plate that the elements cannot carry,
    `OutOfTimeError` where not even the coarse mesh would end in time.
    """
    return _solid_mode(plate, None if label == plate.working_label else label, pace)


# A plate keeps 10 to 100 MB in memory and 5 MB on disk.
@functools.lru_cache(maxsize=8)
def _solid_mode(plate: RectangularPlate, label: tuple[int, int] | None, pace: Pace) -> SolidMode:
    asked = repr((plate, label))
    kept = _KEPT.get(asked, [plate])
    if kept is None:
        kept = _solved_mode(plate, label, pace)
        if not kept.coarseness:
            _KEPT.put(asked, kept, [plate])
    # Without its bulk wherever else it is sent.
    again = functools.partial(_part_again, plate, label)
    return dataclasses.replace(
        kept,
        modes=dataclasses.replace(kept.modes, _again=functools.partial(again, "modes")),
        response=dataclasses.replace(kept.response, _again=functools.partial(again, "response")),
    )


def _part_again(plate: RectangularPlate, label: tuple[int, int] | None, name: str) -> Any:
    """The `modes` or the `response` of a mode, solved again."""
    return getattr(solid_mode(plate, label), name)


def _solved_mode(plate: RectangularPlate, label: tuple[int, int] | None, pace: Pace) -> SolidMode:
    wanted = label or plate.working_label
    request = ModesRequest(
        plate,
        mode=wanted,
        tolerance=_TOLERANCE,
        progress=pace.share(0.0, _MODES),
        deadline=_deadline_of_modes(plate, wanted, pace),
    )
    modes, pieces = solved_classes(request, keep_factors=True)
    index = modes.index(wanted)
    frequency, quality = float(modes.frequencies[index]), float(modes.quality_factors[index])
    response = harmonic_response(
        plate,
        response_frequencies(frequency, quality),
        resolution=modes.resolution,
        progress=pace.share(_MODES, 1.0),
        solved=pieces,
    )
    lengthwise = wanted[0] >= wanted[1]
    span, across = (plate.length, plate.width)[:: 1 if lengthwise else -1]
    x, middle = np.linspace(0, span, _LINE_POINTS), np.array([across / 2])
    if lengthwise:
        line = modes.field(index, x, middle, plate.thickness)[:, 0, 2]
    else:
        line = modes.field(index, middle, x, plate.thickness)[0, :, 2]
    at = largest_lobe(x, line)
    lobe = float(x[at]), across / 2
    lobe = lobe if lengthwise else lobe[::-1]
    amplitude = response.amplitude_at(*lobe)
    # At the mode, not at the highest point of the band: a neighbour may move more.
    near = np.abs(response.frequencies / frequency - 1) < 1 / quality
    resonance = int(np.argmax(np.where(near, amplitude, 0.0)))
    per_volt = float(amplitude[resonance])
    alone = quality * float(modes.drive_forces[index]) / (2 * np.pi * frequency) ** 2
    doubt = (
        COARSE_AMPLITUDE_ERROR
        if modes.left_coarse
        else _answer_change(pieces, float(modes.mesh_frequencies[index]), lobe)
    )
    return SolidMode(
        modes=modes,
        index=index,
        response=response,
        position=x,
        deflection=line / line[at],
        lobe=lobe,
        resonance=resonance,
        amplitude_per_volt=per_volt,
        largest_per_volt=response.largest(resonance),
        alone_per_volt=alone * float(np.abs(line[at])),
        modal_mass=float(1 / line[at] ** 2),
        amplitude_error=(doubt + response.truncation_error) * per_volt,
    )


def _deadline_of_modes(plate: RectangularPlate, label: Label, pace: Pace) -> Deadline | None:
    """Time at which the modes must be there, so that their response is there in time.

    Raises `OutOfTimeError` where the coarse meshes alone would take longer.
    """
    deadline = pace.deadline()
    if deadline is None or pace.budget is None:
        return None
    size = solve_size(plate, label, estimated_frequency(plate, label))
    size.require_within(deadline, pace.budget)
    return deadline.earlier(size.response)


def _answer_change(
    pieces: list[RefinedModes], frequency: si.Hertz, lobe: tuple[si.Metre, si.Metre]
) -> si.Dimensionless:
    """Change of a mode's answer to the drive at a point, F φ / ω², from the coarse mesh to the
    refined one: the refined one lacks less than that."""

    def answer(solved: PlateModel, value: float, vector: si.FloatArray) -> float:
        G, _ = solved.slabs.electrode_columns
        x, y = (np.array([place]) for place in lobe)
        w = solved.field(vector[:, None], x, y, solved.plate.thickness)[0, 0, 0, 2]
        return float(abs((G @ class_drive(solved)) @ vector * w) / value)

    wanted = (2 * np.pi * frequency) ** 2
    piece = min(pieces, key=lambda other: float(np.min(np.abs(other.values - wanted))))
    at = int(np.argmin(np.abs(piece.values - wanted)))
    rough, number = piece.found, piece.index[at]
    fine = answer(piece.solved, piece.values[at], piece.vectors[:, at])
    if fine == 0:
        return 0.0
    coarse = answer(rough.solved, rough.values[number], rough.vectors[:, number])
    return abs(coarse / fine - 1)
