"""Plates with one thing different, and what their working mode then is.

Each is solved in three dimensions; solved plates are kept, so that asking again costs nothing.
"""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kept.store import Kept
from squeezefilm.design.plate.solved import sweep_around
from squeezefilm.physics.plate.layout import DiscPlate, GlueLayer, RectangularPlate
from squeezefilm.physics.plate.solid.modes import Label, PlateModes
from squeezefilm.physics.plate.solid.response import harmonic_response
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.symmetry import drive_signs
from squeezefilm.physics.uncertainty.parameters import with_values

LOSSLESS: si.Dimensionless = 1e5
"""The quality factor that stands for a substrate without losses of its own."""
_POINTS = 61

_Plate = TypeVar("_Plate", RectangularPlate, DiscPlate)


@dataclass(frozen=True)
class PlatePoint:
    """Working mode of a plate: its frequency with its estimated error,
    the largest amplitude per volt on the upper face at resonance (None where nothing drives it),
    quality factor, and the frequency with the drive's terminals open."""

    label: Label
    frequency: si.Hertz
    frequency_error: si.Hertz
    largest_per_volt: si.MetrePerVolt | None
    quality_factor: si.Dimensionless
    open_frequency: si.Hertz


_MODES: Kept[PlateModes] = Kept("compared-modes", PlateModes)
_AMPLITUDES: Kept[float] = Kept("compared-amplitudes", float)


@functools.lru_cache(maxsize=256)
def _solved(plate: RectangularPlate, label: Label) -> PlateModes:
    def modes() -> PlateModes:
        # Without what fields are evaluated on: megabytes each, and not asked for here.
        return dataclasses.replace(solve_modes(plate, mode=label), _fields=(), _again=None)

    return _MODES.found(repr((plate, label)), modes)


@functools.lru_cache(maxsize=256)
def _amplitude(
    plate: RectangularPlate, frequency: si.Hertz, quality: si.Dimensionless
) -> si.MetrePerVolt:
    def largest() -> float:
        # The harmonic mesh is another one, so the peak need not lie at the middle exactly.
        response = harmonic_response(plate, sweep_around(frequency, quality, _POINTS))
        return float(np.max(response.maximum))

    return _AMPLITUDES.found(repr((plate, frequency, quality)), largest)


def working_point(
    plate: RectangularPlate, label: Label | None = None, *, amplitude: bool = True
) -> PlatePoint:
    """A plate's working mode (or the one with this label) as explanations are compared by it.

    Raises what `solve_modes` raises. The amplitude is left out where no electrode is driven or
    `amplitude` is False.
    """
    wanted = label or (plate.nodal_lines, 0)
    modes = _solved(plate, wanted)
    index = modes.index(wanted)
    frequency, quality = float(modes.frequencies[index]), float(modes.quality_factors[index])
    driven = amplitude and bool(np.any(drive_signs(plate)))
    return PlatePoint(
        wanted,
        frequency,
        float(modes.errors[index]),
        _amplitude(plate, frequency, quality) if driven else None,
        quality,
        float(modes.open_frequencies[index]),
    )


def with_ceramic_stiffness(plate: _Plate, share: si.Dimensionless) -> _Plate:
    """The plate or disc with all stiffnesses of its ceramic multiplied, d31 (or e31) kept."""
    return dataclasses.replace(plate, ceramic=plate.ceramic.scaled(stiffness=share))


def with_other_data_set(plate: RectangularPlate) -> RectangularPlate:
    """The plate with the other of the two data sets of its ceramic believed."""
    ceramic = plate.ceramic
    other: Literal["from_d31", "printed_e31"] = (
        "printed_e31" if ceramic.data_set == "from_d31" else "from_d31"
    )
    return dataclasses.replace(plate, ceramic=dataclasses.replace(ceramic, data_set=other))


def with_glue(
    plate: RectangularPlate, thickness: si.Metre, young_modulus: si.Pascal
) -> RectangularPlate:
    """The plate with a glue line of this thickness and Young's modulus (losses as `GlueLayer`)."""
    return dataclasses.replace(plate, glue=GlueLayer(thickness, young_modulus))


def with_loss_in_ceramic_alone(plate: RectangularPlate) -> RectangularPlate:
    """The plate with no losses but its ceramic's (and its glue's, where it has one)."""
    return with_values(plate, {"substrate.quality_factor": LOSSLESS})
