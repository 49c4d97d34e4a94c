"""Explanations of the prototype below the paper's model, and what one frequency cannot tell.

Several explanations are each brought to the measured frequency by one free parameter. What they
then predict for other measurements says which of these would tell them apart, and by how much.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.progress import SayProgress
from squeezefilm.design.analysis.published_claims import measured_of_preset
from squeezefilm.design.plate.solved import (
    PlatePoint,
    with_ceramic_stiffness,
    with_glue,
    with_other_data_set,
    working_point,
)
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.uncertainty.parameters import with_values

MODAL_FREQUENCY: si.Hertz = 35.6e3  # section 3.1.3, Fig 13
HARMONIC_FREQUENCY: si.Hertz = 34.77e3  # section 3.1.3, Fig 14
HARMONIC_AMPLITUDE: si.Metre = 3.2e-6
MEASURED_FREQUENCY: si.Hertz = measured_of_preset("biet2008-plate", "resonance_frequency")
MEASURED_AMPLITUDE: si.Metre = measured_of_preset("biet2008-plate", "vibration_amplitude")
DRIVE_VOLTAGE: si.Volt = 15.0


@functools.cache
def paper_plate() -> RectangularPlate:
    """The plate of the preset biet2008-plate."""
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    return plate


@functools.cache
def paper_points() -> tuple[PlatePoint, PlatePoint]:
    """Mode (8,0) of the paper's plate with d31 and with the printed e31."""
    plate = paper_plate()
    return working_point(plate), working_point(with_other_data_set(plate))


NEIGHBOURS = ((6, 0), (7, 0), (9, 0))

# How well each could be measured: a resonance of Q 60 to a tenth of its half-power width, an
# amplitude with a vibrometer at a known point, a quality factor from that width.
RATIO_ACCURACY: si.Dimensionless = 0.002
OPEN_ACCURACY: si.Dimensionless = 0.002
AMPLITUDE_ACCURACY: si.Dimensionless = 0.1


@dataclass(frozen=True)
class Explanation:
    """A set of parameters with which the mode lies at the measured frequency.

    `free` names the parameter that was solved for and `value` says what came out. Ratios are of the
    neighbouring modes' frequencies (`NEIGHBOURS`) to the working mode's; `open_shift` is the
    relative rise of the frequency with the drive's terminals open. The amplitude is at 15 V with
    the stated quality factor (60 but for the glue's own losses), and `quality_factor_for_measured`
    the one that would give the measured amplitude.
    """

    name: str
    free: str
    value: str
    frequency: si.Hertz
    neighbour_ratios: tuple[float, ...]
    open_shift: si.Dimensionless
    amplitude: si.Metre
    quality_factor: si.Dimensionless
    quality_factor_for_measured: si.Dimensionless

    @property
    def amplitude_for_q_60(self) -> si.Metre:
        """The amplitude at 15 V if the whole had a quality factor of 60: what an amplitude tells
        once Q is measured too."""
        return self.amplitude * 60 / self.quality_factor


@dataclass(frozen=True)
class Separation:
    """The distance of two explanations in each further measurement, in units of what it could
    resolve; above about 2 it tells them apart."""

    first: str
    second: str
    measurements: tuple[str, ...]
    apart: tuple[float, ...]


@dataclass(frozen=True)
class PrototypeStudy:
    """The solved plate beside the paper's numbers, and the explanations."""

    from_d31: PlatePoint
    printed_e31: PlatePoint
    explanations: tuple[Explanation, ...]
    separations: tuple[Separation, ...]


MEASUREMENTS = (
    *(f"f({label[0]},{label[1]}) / f(8,0)" for label in NEIGHBOURS),
    "open-circuit shift",
    "amplitude at known Q",
)


def _softer_and_thinner(plate: RectangularPlate, value: float) -> RectangularPlate:
    thinner = with_values(plate, {"substrate.young_modulus": 115e9, "thickness": value})
    return with_ceramic_stiffness(thinner, 0.9)


def _softer(plate: RectangularPlate, value: float) -> RectangularPlate:
    softer = {"substrate.young_modulus": plate.substrate.young_modulus * value}
    return with_ceramic_stiffness(with_values(plate, softer), value)


_Make = Callable[[RectangularPlate, float], RectangularPlate]


# Name, what is free, its unit, from where to where it is looked for, and how the plate is made.
_CASES: tuple[tuple[str, str, str, float, float, _Make], ...] = (
    ("50 µm of glue", "its Young's modulus", "Pa", 0.3e9, 3e9,
     lambda plate, value: with_glue(plate, 50e-6, value)),
    ("20 µm of glue", "its Young's modulus", "Pa", 0.1e9, 1e9,
     lambda plate, value: with_glue(plate, 20e-6, value)),
    ("E 115 GPa, c11_p −10 %, thinner plate", "plate thickness", "m", 1.6e-3, 2e-3,
     _softer_and_thinner),
    ("plate and ceramic softer alike", "share of E and c11_p", "1", 0.7, 1.0, _softer),
    ("a heavier plate", "its density", "kg/m3", 8250.0, 13500.0,
     lambda plate, value: with_values(plate, {"substrate.density": value})),
    ("50 µm of glue, printed e31", "its Young's modulus", "Pa", 0.3e9, 3e9,
     lambda plate, value: with_glue(with_other_data_set(plate), 50e-6, value)),
)  # fmt: skip


def prototype_study(progress: SayProgress | None = None) -> PrototypeStudy:
    """Solve it all: some sixty plates, a minute; solved plates are kept for the next call.

    Raises what `solve_modes` raises.
    """
    tell = progress or (lambda _: None)
    plate = paper_plate()
    from_d31, printed = paper_points()
    explanations = []
    for name, free, unit, low, high, make in _CASES:
        tell(f"30.5 kHz by {name}")
        explanations.append(_explained(plate, name, free, unit, (low, high), make))
    pairs = itertools.combinations(explanations, 2)
    return PrototypeStudy(
        from_d31, printed, tuple(explanations), tuple(_apart(a, b) for a, b in pairs)
    )


def _explained(
    plate: RectangularPlate,
    name: str,
    free: str,
    unit: str,
    between: tuple[float, float],
    make: _Make,
) -> Explanation:
    from scipy.optimize import brentq

    def above(logarithm: float) -> float:
        point = working_point(make(plate, float(np.exp(logarithm))), amplitude=False)
        return point.frequency / MEASURED_FREQUENCY - 1

    logarithms = float(np.log(between[0])), float(np.log(between[1]))
    if above(logarithms[0]) * above(logarithms[1]) > 0:
        raise SqueezefilmError(
            f"{free} between {between[0]:.3g} and {between[1]:.3g} ({unit}) does not bring "
            f"'{name}' to {MEASURED_FREQUENCY:.0f} Hz; widen the range in "
            "validation/explanations.py"
        )
    root = float(np.exp(brentq(above, *logarithms, xtol=2e-4, rtol=1e-4)))
    solved = make(plate, root)
    point = working_point(solved)
    assert point.largest_per_volt is not None
    amplitude = DRIVE_VOLTAGE * point.largest_per_volt
    ratios = tuple(
        working_point(solved, label, amplitude=False).frequency / point.frequency
        for label in NEIGHBOURS
    )
    text = f"{root:.3f}" if unit == "1" else si.format_quantity(root, si.Unit(unit), 3)
    text = f"{root:.0f} {unit}" if unit == "kg/m3" else text
    return Explanation(
        name,
        free,
        text.replace("m3", "m³"),
        point.frequency,
        ratios,
        point.open_frequency / point.frequency - 1,
        amplitude,
        point.quality_factor,
        point.quality_factor * MEASURED_AMPLITUDE / amplitude,
    )


def _apart(a: Explanation, b: Explanation) -> Separation:
    ratios = [
        abs(p / q - 1) / RATIO_ACCURACY
        for p, q in zip(a.neighbour_ratios, b.neighbour_ratios, strict=True)
    ]
    return Separation(
        a.name,
        b.name,
        MEASUREMENTS,
        (
            *ratios,
            abs(a.open_shift - b.open_shift) / OPEN_ACCURACY,
            abs(float(np.log(a.amplitude_for_q_60 / b.amplitude_for_q_60))) / AMPLITUDE_ACCURACY,
        ),
    )
