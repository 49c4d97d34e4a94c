"""The paper's figures 4, 5, 10 and 11, redrawn from the corrected model."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.design.analysis.analyze import analyze
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.beam.modes import euler_bernoulli_frequency, timoshenko_frequency
from squeezefilm.physics.plate.laminate import Laminate, plate_laminate
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.validation.report.paper_figures import friction, pressure, wavelength

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_CRITERION = 20.6e3
_PRINTED_LIMIT = 16.1e-3


@style.drawn
def frequency_against_half_wavelength(section: Laminate) -> Figure:
    """Resonance frequency against half wavelength by two beam theories: the paper's Fig 10."""
    half = np.linspace(5e-3, 25e-3, 201)
    G, M = section.bending_stiffness, section.mass_per_area
    euler = np.asarray(euler_bernoulli_frequency(half, G, M))
    timoshenko = np.asarray(timoshenko_frequency(half, section))
    limit = float(np.interp(-_CRITERION, -euler, half))
    shear_limit = float(np.interp(-_CRITERION, -timoshenko, half))
    figure = style.new_figure(
        f"20.6 kHz needs a half wavelength below {limit * 1e3:.1f} mm (Euler–Bernoulli) or "
        f"{shear_limit * 1e3:.1f} mm (Timoshenko); the paper reads 16.1 mm",
        "waves in the paper's laminate, E of the substrate and c11_p of the ceramic",
        4.6,
    )
    axes = figure.subplots()
    axes.plot(1e3 * half, euler / 1e3, color=style.BLUE, label="Euler–Bernoulli")
    axes.plot(1e3 * half, timoshenko / 1e3, color=style.ORANGE, ls="--", label="Timoshenko")
    level = _CRITERION / 1e3
    axes.axhline(level, **style.REFERENCE, label="20.6 kHz (σ = 10)")
    for at, color in ((limit, style.BLUE), (shear_limit, style.ORANGE)):
        axes.plot([1e3 * at], [level], "o", color=color, ms=6, zorder=3)
    limit_mm, said = 1e3 * _PRINTED_LIMIT, "printed: 16.1 mm"
    axes.plot([limit_mm], [level], "x", color=style.INK, ms=9, mew=2, label=said)
    axes.set(xlim=(5, 25), ylim=(0, 110), xlabel="half wavelength (mm)", ylabel="frequency (kHz)")
    style.legend_below(axes)
    return figure


def reproduction_figures(tell: Callable[[str], None]) -> list[tuple[str, str]]:
    """Title and SVG element of each redrawn figure; `tell` is told what begins."""
    tell("figures 4 and 5: the stator")
    stator = analyze(load_display("biet2008-stator"), vibration_amplitude=2e-6)
    tell("figures 10 and 11: the plate")
    display = load_display("biet2008-plate")
    plate = analyze(display)
    assert isinstance(display.actuator, RectangularPlate)
    section = plate_laminate(display.actuator, "paper")
    beams = frequency_against_half_wavelength(section)
    drawings = (
        (4, "mean pressure under the finger", pressure(stator)),
        (5, "relative friction against amplitude", friction(stator)),
        (10, "frequency against half wavelength", beams),
        (11, "amplitude for four half wavelengths", wavelength(plate)),
    )
    titled = ((f"Figure {number}: {what}", number, figure) for number, what, figure in drawings)
    return [(title, style.svg(figure, f"fig{number}", title)) for title, number, figure in titled]
