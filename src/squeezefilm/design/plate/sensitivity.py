"""Shift of a plate's working mode when one thing about the plate is different.

Each `Change` makes another plate; it is solved in three dimensions like the first, and the mode is
recognised by its shape. Solved plates are kept, so that asking again costs nothing.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import SayProgress
from squeezefilm.design.plate.solved import sweep_around
from squeezefilm.physics.plate.layout import DiscPlate, GlueLayer, RectangularPlate
from squeezefilm.physics.plate.solid.modes import Label, PlateModes, tracked
from squeezefilm.physics.plate.solid.response import harmonic_response
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.symmetry import drive_signs
from squeezefilm.physics.uncertainty.parameters import with_values

Quantity = Literal["frequency", "amplitude"]

_Plate = TypeVar("_Plate", RectangularPlate, DiscPlate)

# Less alike than this (modal assurance criterion) is another mode under the same label.
_ALIKE = 0.6
_POINTS = 61
LOSSLESS: si.Dimensionless = 1e5
"""The quality factor that stands for a substrate without losses of its own."""


@dataclass(frozen=True)
class WorkingPoint:
    """Working point that the changes move: the working mode's frequency with its estimated error,
    the largest amplitude per volt on the upper face at resonance (None where nothing drives it),
    quality factor, and the frequency with the drive's terminals open."""

    label: Label
    frequency: si.Hertz
    frequency_error: si.Hertz
    largest_per_volt: si.MetrePerVolt | None
    quality_factor: si.Dimensionless
    open_frequency: si.Hertz


@dataclass(frozen=True)
class Change:
    """A thing that is different: its group (`name`), what it is changed to in words, and the plate
    that it makes of another. `frequency_only` where there is no amplitude to compare."""

    name: str
    change: str
    make: Callable[[RectangularPlate], RectangularPlate]
    frequency_only: bool = False


@dataclass(frozen=True)
class Sensitivity:
    """Effect of one change: relative shifts of the frequency and of the amplitude per volt (None
    where nothing drives the changed plate), and how alike the mode is to the unchanged one."""

    name: str
    change: str
    frequency: si.Hertz
    frequency_shift: si.Dimensionless
    largest_per_volt: si.MetrePerVolt | None
    amplitude_shift: si.Dimensionless | None
    likeness: si.Dimensionless


@dataclass(frozen=True)
class SensitivityTable:
    """The unchanged working point, and one row for each change."""

    reference: WorkingPoint
    rows: tuple[Sensitivity, ...]


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
) -> WorkingPoint:
    """A plate's working mode (or the one with this label) as `plate_sensitivity` compares it.

    Raises what `solve_modes` raises. The amplitude is left out where no electrode is driven or
    `amplitude` is False.
    """
    wanted = label or (plate.nodal_lines, 0)
    modes = _solved(plate, wanted)
    index = modes.index(wanted)
    frequency, quality = float(modes.frequencies[index]), float(modes.quality_factors[index])
    driven = amplitude and bool(np.any(drive_signs(plate)))
    return WorkingPoint(
        wanted,
        frequency,
        float(modes.errors[index]),
        _amplitude(plate, frequency, quality) if driven else None,
        quality,
        float(modes.open_frequencies[index]),
    )


def plate_sensitivity(
    plate: RectangularPlate,
    changes: Sequence[Change] | None = None,
    *,
    label: Label | None = None,
    amplitude: bool = True,
    progress: SayProgress | None = None,
) -> SensitivityTable:
    """The shift of the working mode's frequency and amplitude per volt under each change.

    `changes` default to `usual_changes`. Frequencies are extrapolated (error estimates of
    `solve_modes` apply to both plates alike, so that a shift is better than either); amplitudes are
    of the same mesh. Takes a second or two a change; plates solved before are kept on disk. Raises
    `InputError` where a changed plate has no mode with this label that moves like the unchanged
    one: the change is too large to compare.
    """
    wanted = label or (plate.nodal_lines, 0)
    every = tuple(usual_changes(plate) if changes is None else changes)
    tell = progress or (lambda _: None)
    tell("the unchanged plate")
    reference = working_point(plate, wanted, amplitude=amplitude)
    modes = _solved(plate, wanted)
    rows = []
    for number, change in enumerate(every, 1):
        tell(f"change {number} of {len(every)}: {change.name} {change.change}")
        other = change.make(plate)
        likeness = tracked(modes, _solved(other, wanted))[modes.index(wanted)][1]
        if likeness < _ALIKE:
            raise InputError(
                f"with {change.name} {change.change} the mode {wanted} moves in another shape "
                f"(likeness {likeness:.2f}, at least {_ALIKE:g} is compared); take a smaller change"
            )
        there = working_point(other, wanted, amplitude=amplitude and not change.frequency_only)
        before, after = reference.largest_per_volt, there.largest_per_volt
        rows.append(
            Sensitivity(
                change.name,
                change.change,
                there.frequency,
                there.frequency / reference.frequency - 1,
                after,
                None if before is None or after is None else after / before - 1,
                likeness,
            )
        )
    return SensitivityTable(reference, tuple(rows))


def usual_changes(plate: RectangularPlate) -> Iterator[Change]:
    """Changes of what is seldom known well about a plate, by as much as it is seldom known.

    Sizes are relative, so that they fit any plate: on the paper's they are E 115 and 131 GPa,
    c11_p ∓10 %, plate and ceramic ±0.05 mm, ρ 8360 kg/m³, ν 0.27 and 0.33, glue of 20 and 50 µm.
    """
    own, ceramic = plate.substrate, plate.ceramic
    E, rho, nu = own.young_modulus, own.density, own.poisson_ratio
    t, tp, Q = plate.thickness, plate.ceramic_thickness, plate.quality_factor
    yield from _both(
        "plate Young's modulus", "substrate.young_modulus", "Pa", E * 115 / 123, E * 131 / 123
    )
    for share in (0.9, 1.1):
        yield Change(
            "ceramic stiffness c11_p",
            f"{100 * (share - 1):+.0f} %".replace("-", "−"),
            functools.partial(with_ceramic_stiffness, share=share),
        )
    yield from _both("plate thickness", "thickness", "m", 0.975 * t, 1.025 * t)
    yield from _both("ceramic thickness", "patches.*.thickness", "m", 0.95 * tp, 1.05 * tp)
    low, high = rho * 8140 / 8250, rho * 8360 / 8250
    yield from _both("plate density", "substrate.density", "kg/m3", low, high)
    low, high = nu - 0.03, min(nu + 0.03, 0.49)
    yield from _both("plate Poisson's ratio", "substrate.poisson_ratio", "1", low, high)
    yield Change("ceramics open", "each on its own", with_open_ceramics, frequency_only=True)
    if plate.glue is not None:
        own_glue = plate.glue
        for name, path, unit, value in (
            ("glue thickness", "glue.thickness", "m", own_glue.thickness),
            ("glue Young's modulus", "glue.young_modulus", "Pa", own_glue.young_modulus),
        ):
            yield from _both(name, path, unit, 0.5 * value, 1.5 * value)
    else:
        for modulus, thickness in itertools.product((3e9, 1e9), (0.02 * tp, 0.05 * tp)):
            glued = functools.partial(with_glue, thickness=thickness, young_modulus=modulus)
            yield Change(f"glue of {_text(modulus, 'Pa')}", _text(thickness, "m"), glued)
    if own.quality_factor is None:
        for share in (0.8, 1.2):
            yield Change(
                "quality factor, all materials",
                f"{Q:.3g} → {share * Q:.3g}",
                functools.partial(with_values, values={"quality_factor": share * Q}),
            )
        yield Change("losses", "in the ceramic alone", with_loss_in_ceramic_alone)
    if ceramic.stress_coefficient is not None and ceramic.constants is None:
        other = "printed_e31" if ceramic.data_set == "from_d31" else "from_d31"
        yield Change("ceramic data set", f"{ceramic.data_set} → {other}", with_other_data_set)


def _both(name: str, path: str, unit: str, low: float, high: float) -> Iterator[Change]:
    for value in (low, high):
        make = functools.partial(with_values, values={path: value})
        yield Change(name, _text(value, unit), make)


def _text(value: float, unit: str) -> str:
    if unit == "1":
        return f"{value:.3g}"
    return si.format_quantity(value, si.Unit(unit), 4).replace("m3", "m³")


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


def with_open_ceramics(plate: RectangularPlate) -> RectangularPlate:
    """The plate with every ceramic's electrode left open."""
    patches = tuple(
        dataclasses.replace(patch, electrode="open", shunt_resistance=None)
        for patch in plate.patches
    )
    return dataclasses.replace(plate, patches=patches)


def with_glue(
    plate: RectangularPlate, thickness: si.Metre, young_modulus: si.Pascal
) -> RectangularPlate:
    """The plate with a glue line of this thickness and Young's modulus (losses as `GlueLayer`)."""
    return dataclasses.replace(plate, glue=GlueLayer(thickness, young_modulus))


def with_loss_in_ceramic_alone(plate: RectangularPlate) -> RectangularPlate:
    """The plate with no losses but its ceramic's (and its glue's, where it has one)."""
    return with_values(plate, {"substrate.quality_factor": LOSSLESS})
