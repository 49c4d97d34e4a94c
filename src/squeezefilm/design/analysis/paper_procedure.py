"""The paper's design procedure (section 3.1) as a calculation, with its contradictions shown.

Workspace → frequency criterion (σ ≥ 10) → half wavelength → friction criterion (µ′/µ ≤ 0.7) →
ceramics and plate that follow.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, UnreachableError
from squeezefilm.physics.contact.sharing.levitation import vibration_amplitude_for
from squeezefilm.physics.film.gap import PaperGap, frequency_for_squeeze_number
from squeezefilm.physics.plate.beam_modes import (
    euler_bernoulli_half_wavelength,
    free_beam_mode,
    timoshenko_frequency,
)
from squeezefilm.physics.plate.laminate import Laminate

MEAN_EXPLORED_AREA: si.SquareMetre = 28.18e-4
"""Mean area explored in Smith's experiment; the largest, 128.37 cm², bounds from above."""
LARGEST_EXPLORED_AREA: si.SquareMetre = 128.37e-4
SQUEEZE_NUMBER: si.Dimensionless = 10.0
FREQUENCY_AMPLITUDE: si.Metre = 3e-6
"""Amplitude of the unfavourable film for which the frequency criterion is asked."""
WANTED_FRICTION: si.Dimensionless = 0.7
CERAMIC_LENGTH: si.Metre = 11e-3
CERAMIC_GAP: si.Metre = 1e-3
WIDTH: si.Metre = 49e-3
PAPER_HALF_WAVELENGTHS = (7.5e-3, 10e-3, 12.5e-3, 15e-3)
_NO_ASYMPTOTE_YET = (
    "σ ≥ 10 does not make the asymptote hold: there a smooth film reaches less than half of the "
    "asymptotic over-pressure"
)


@dataclass(frozen=True, eq=False)
class PaperDesign:
    """Result of the procedure, with the paper's contradictions in words.

    `half_wavelengths` and `amplitudes` are the points of its Fig 11; an amplitude is NaN where no
    amplitude up to 50 µm reaches the wanted friction.
    """

    lowest_frequency: si.Hertz
    longest_half_wavelength_euler: si.Metre
    longest_half_wavelength_timoshenko: si.Metre
    half_wavelengths: si.MetreArray
    amplitudes: si.MetreArray
    ceramics: int
    length: si.Metre
    width: si.Metre
    area: si.SquareMetre
    nodal_lines: int
    half_wavelength: si.Metre
    resonance_frequency: si.Hertz
    required_amplitude: si.Metre
    contradictions: tuple[str, ...]


def friction_criterion(
    gap: PaperGap,
    half_wavelengths: si.MetreArray | tuple[float, ...],
    relative_friction: si.Dimensionless,
    normal_force: si.Newton,
    ambient_pressure: si.Pascal,
) -> si.MetreArray:
    """The amplitude (m, zero-to-peak) that reaches a relative friction at each half wavelength (m).

    The paper's Fig 11; NaN where it is out of reach, see
    `physics.contact.sharing.levitation.vibration_amplitude_for`.
    """
    amplitudes = []
    for half in half_wavelengths:
        shorter = replace(gap, vibration_amplitude=0.0, wavelength=2 * float(half))
        try:
            amplitudes.append(
                vibration_amplitude_for(relative_friction, shorter, normal_force, ambient_pressure)
            )
        except UnreachableError:
            amplitudes.append(math.nan)
    return np.array(amplitudes)


def design_plate(
    section: Laminate,
    gap: PaperGap,
    viscosity: si.PascalSecond,
    ambient_pressure: si.Pascal,
    normal_force: si.Newton,
    smallest_area: si.SquareMetre = MEAN_EXPLORED_AREA,
) -> PaperDesign:
    """The plate that the paper's procedure leads to, for one laminate and one finger.

    The number of ceramics is the smallest that covers `smallest_area` (m²); the mode has one
    antinode a ceramic and one beyond each end. Valid where the paper's model is: for comparison,
    not for design. Raises `InputError` where that is more than the largest explored area.
    """
    lowest = float(
        frequency_for_squeeze_number(
            SQUEEZE_NUMBER,
            gap.contact_length,
            gap.with_amplitude(FREQUENCY_AMPLITUDE).reference_thickness,
            viscosity,
            ambient_pressure,
        )
    )
    euler = float(
        euler_bernoulli_half_wavelength(lowest, section.bending_stiffness, section.mass_per_area)
    )
    timoshenko = timoshenko_half_wavelength(lowest, section)
    halves = np.array(PAPER_HALF_WAVELENGTHS)
    amplitudes = friction_criterion(gap, halves, WANTED_FRICTION, normal_force, ambient_pressure)
    ceramics, length = _ceramics(smallest_area)
    lines = ceramics + 1
    mode = free_beam_mode(section, length, lines)
    required = friction_criterion(
        gap, (mode.half_wavelength,), WANTED_FRICTION, normal_force, ambient_pressure
    )
    return PaperDesign(
        lowest_frequency=lowest,
        longest_half_wavelength_euler=euler,
        longest_half_wavelength_timoshenko=timoshenko,
        half_wavelengths=halves,
        amplitudes=amplitudes,
        ceramics=ceramics,
        length=length,
        width=WIDTH,
        area=length * WIDTH,
        nodal_lines=lines,
        half_wavelength=mode.half_wavelength,
        resonance_frequency=mode.frequency,
        required_amplitude=float(required[0]),
        contradictions=(
            _against_division(length, lines, mode.half_wavelength),
            _against_rising(halves, amplitudes),
            f"the frequency criterion allows λ/2 up to {euler * 1e3:.4g} mm (Euler–Bernoulli) or "
            f"{timoshenko * 1e3:.4g} mm (Timoshenko), not the paper's 16.1 mm",
            _NO_ASYMPTOTE_YET,
        ),
    )


def _against_division(length: si.Metre, lines: int, half: si.Metre) -> str:
    """Sentence that a free plate's half wavelength is not its length over its nodal lines."""
    return (
        f"a free plate of {length * 1e3:.4g} mm with {lines} nodal lines has λ/2 = "
        f"{half * 1e3:.4g} mm, not {length * 1e3:.4g}/{lines} = {length / lines * 1e3:.4g} mm"
    )


def _against_rising(halves: si.MetreArray, amplitudes: si.MetreArray) -> str:
    """Sentence on how the amplitude of the friction criterion goes with the half wavelength."""
    falling = bool(np.all(np.diff(amplitudes[np.argsort(halves)]) < 0))
    return (
        f"the friction criterion needs {_list(amplitudes)} µm at λ/2 = {_list(halves, 1e3)} mm; "
        + (
            "it falls with the half wavelength, and the paper lists it rising"
            if falling
            else "it does not fall with the half wavelength"
        )
    )


def _ceramics(smallest_area: si.SquareMetre) -> tuple[int, si.Metre]:
    """The number of ceramics, and the plate's length (m); `InputError` for too large a plate."""
    pitch = CERAMIC_LENGTH + CERAMIC_GAP
    ceramics = math.ceil((smallest_area / WIDTH + CERAMIC_GAP) / pitch)
    # An odd number puts an antinode at the centre, where the paper's plate has one.
    ceramics += 1 - ceramics % 2
    length = ceramics * pitch - CERAMIC_GAP
    area = length * WIDTH
    if area > LARGEST_EXPLORED_AREA:
        raise InputError(
            f"{ceramics} ceramics of {si.format_quantity(CERAMIC_LENGTH, si.Unit('m'))} make "
            f"a plate of {area * 1e4:.4g} cm2, above the largest explored area of "
            f"{LARGEST_EXPLORED_AREA * 1e4:.4g} cm2; use fewer, shorter or narrower ones"
        )
    return ceramics, length


def _list(values: si.MetreArray, scale: float = 1e6) -> str:
    return "/".join(f"{value * scale:.3g}" for value in values)


def timoshenko_half_wavelength(frequency: si.Hertz, section: Laminate) -> si.Metre:
    """The half wavelength (m) of a Timoshenko beam at a frequency (Hz), to 1e-12 m."""
    from scipy.optimize import brentq

    thickness = sum(layer.thickness for layer in section.layers)
    return float(
        brentq(
            lambda half: float(timoshenko_frequency(half, section)) - frequency,
            thickness,
            1e4 * thickness,
            xtol=1e-12,
        )
    )
