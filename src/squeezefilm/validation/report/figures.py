"""The paper's figures 4, 5, 10 and 11, redrawn from the corrected model."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.core.kit.model_looks import look_of
from squeezefilm.core.kit.numbers import M, N, shown
from squeezefilm.design.analysis.analysis import Analysis
from squeezefilm.design.analysis.analyze import analyze
from squeezefilm.design.analysis.curves import PAPER_CRITERION, pressure_profiles, wavelength_curves
from squeezefilm.design.analysis.report.figures import criterion_line, working_point
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.beam_modes import euler_bernoulli_frequency, timoshenko_frequency
from squeezefilm.physics.plate.laminate import Laminate, plate_laminate
from squeezefilm.physics.plate.layout import RectangularPlate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_CRITERION = 20.6e3
_PRINTED_LIMIT = 16.1e-3
_RIDGES_IN_ZOOM = 2.6


@style.drawn
def frequency_against_half_wavelength(section: Laminate) -> Figure:
    """Resonance frequency against half wavelength by two beam theories: the paper's Fig 10."""
    half = np.linspace(5e-3, 25e-3, 201)
    G, M = section.bending_stiffness, section.mass_per_area
    euler = np.asarray(euler_bernoulli_frequency(half, G, M))
    timoshenko = np.asarray(timoshenko_frequency(half, section))
    limit = float(np.interp(-_CRITERION, -euler, half))
    shear_limit = float(np.interp(-_CRITERION, -timoshenko, half))
    figure, axes = style.new_axes(
        f"20.6 kHz needs a half wavelength below {limit * 1e3:.1f} mm (Euler–Bernoulli) or "
        f"{shear_limit * 1e3:.1f} mm (Timoshenko); the paper reads 16.1 mm",
        "waves in the paper's laminate, E of the substrate and c11_p of the ceramic",
        4.6,
    )
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


@style.drawn
def pressure(analysis: Analysis) -> Figure:
    """Gap and mean pressure along the contact, whole and enlarged: the paper's Fig 4."""
    p, display = analysis.prediction, analysis.display
    profiles = pressure_profiles(p)
    profile = profiles[0]
    x, gap = 1e3 * profile.position, 1e6 * profile.thickness
    tops = [float(np.max(item.mean_pressure)) for item in profiles]
    carried = 1 + p.normal_force / display.finger.contact_length**2 / display.gas.ambient_pressure
    where = (
        "over the ridge crests only" if display.finger.ridge_amplitude > 0 else "at the antinode"
    )
    title = f"The film's pressure rises {where}: to {tops[0]:.3g} times ambient by the paper"
    if len(tops) > 1:
        title += f", to {tops[1]:.3g} in the solved film"
    if max(tops) < 1.0005:
        title = (
            f"The film adds no pressure here; {carried:.3f} times ambient would carry the finger"
        )
    names = ", ".join(f"{item.model}" for item in profiles)
    figure = style.new_figure(title, f"{names} (grooves sealed at their ends)", 5.8)
    # The strip has the legend: a figure's own would lie on the small print.
    gap_axes, near_gap, mean_axes, near_mean, strip = figure.subplot_mosaic(
        "ab;cd;ss", width_ratios=[2.2, 1], height_ratios=[1, 1, 0.09]
    ).values()
    for whole, near in ((gap_axes, near_gap), (mean_axes, near_mean)):
        near.sharey(whole)
        near.tick_params(labelleft=False)
    span = 0.5 * _RIDGES_IN_ZOOM * 1e3 * display.finger.ridge_period
    span = min(span, float(x[-1]))
    for above, below, ends in (
        (gap_axes, mean_axes, (float(x[0]), float(x[-1]))),
        (near_gap, near_mean, (-span, span)),
    ):
        below.sharex(above)
        above.tick_params(labelbottom=False)
        above.fill_between(x, gap, 1.12 * float(np.max(gap)), color=style.SKIN, lw=0)
        above.plot(x, gap, color=style.INK, lw=1.2)
        above.set(ylim=(0, 1.12 * float(np.max(gap))))
        for item in profiles:
            look = look_of(item.model)
            mean = float(np.trapezoid(item.mean_pressure, x) / (x[-1] - x[0]))
            name = f"{look.name}, mean {mean:.4f}"
            below.plot(x, item.mean_pressure, color=look.color, lw=1.4, label=name)
        below.axhline(carried, **style.WANTED, label=f"would carry the finger: {carried:.4f}")
        below.set(xlim=ends, xlabel="position under the finger (mm)")
    gap_axes.set(ylabel="mean gap (µm)")
    mean_axes.set(ylabel="pressure over ambient")
    gap_axes.set_title("the whole contact: the finger's ridges, and the plate at 0")
    near_gap.set_title("enlarged")
    style.legend_in(strip, mean_axes)
    return figure


@style.drawn
def friction(analysis: Analysis) -> Figure:
    """Relative friction against amplitude on each surface: the paper's Fig 5, and solved."""
    p, display, curves = analysis.prediction, analysis.display, analysis.friction_curves
    here = analysis.own_curve
    at = shown(p.vibration_amplitude, M, 3)
    needed = here.amplitude_for_criterion
    title = (
        f"At {at} the friction on {style.plain(here.surface, 20)} is {p.relative_friction:.3g} of "
        "what it is without vibration; 0.7 takes "
        + ("more than 50 µm" if needed is None else shown(needed, M, 3))
    )
    models = ", ".join(dict.fromkeys(curve.model for curve in curves))
    figure, axes = style.new_axes(
        title, f"{models}; {shown(p.normal_force, N)}", 4.4 + 0.24 * (len(curves) + 2)
    )
    for number, curve in enumerate(curves):
        look = look_of(curve.model)
        # The colour is the model's, the dashes the surface's.
        color, dashes = look.color, style.LINES[number % len(display.surfaces) % 4][1]
        reached = curve.amplitude_for_criterion
        zero = curve.zero_friction_amplitude
        words = "0.7 out of reach" if reached is None else f"0.7 at {shown(reached, M, 3)}"
        words += "" if zero is None else f", zero at {shown(zero, M, 3)}"
        name = f"{look.name}, {style.plain(curve.surface, 20)}"
        name += f" ({shown(curve.roughness, M, 3)}): {words}"
        axes.plot(
            1e6 * curve.amplitude, curve.relative_friction, color=color, ls=dashes, label=name
        )
        if reached is not None:
            _drop(axes, reached, color)
        if zero is not None and zero <= curve.amplitude[-1]:
            axes.plot([1e6 * zero], [0], "s", color=color, ms=6, clip_on=False, zorder=4)
    criterion_line(axes)
    working_point(axes, analysis)
    style.friction_axes(axes, 1e6 * max(float(c.amplitude[-1]) for c in curves), top=1.06)
    style.legend_below(axes, columns=1)
    return figure


@style.drawn
def wavelength(analysis: Analysis) -> Figure:
    """Relative friction against amplitude for four half wavelengths: the paper's Fig 11."""
    p = analysis.prediction
    curves = wavelength_curves(p)
    at = [shown(c.amplitude_for_criterion, M, 3) for c in curves]
    short = min(curves, key=lambda c: c.half_wavelength)
    long = max(curves, key=lambda c: c.half_wavelength)
    title = (
        f"A shorter wave needs more amplitude for µ′/µ = 0.7: "
        f"{at[curves.index(short)]} at λ/2 = {shown(short.half_wavelength, M, 3)}, "
        f"{at[curves.index(long)]} at {shown(long.half_wavelength, M, 3)}"
    )
    model = f"{curves[0].model}, {style.plain(p.surface.name, 20)}, {shown(p.normal_force, N)}"
    figure, axes = style.new_axes(title, model, 4.8)
    right = 1e6 * float(max(c.amplitude[-1] for c in curves))
    for number, curve in enumerate(curves):
        color, dashes = style.LINES[number % len(style.LINES)]
        name = f"λ/2 = {shown(curve.half_wavelength, M, 3)}: 0.7 at {at[number]}"
        axes.plot(
            1e6 * curve.amplitude, curve.relative_friction, color=color, ls=dashes, label=name
        )
        if 1e6 * curve.amplitude_for_criterion <= right:
            _drop(axes, curve.amplitude_for_criterion, color)
    criterion_line(axes)
    if 1e6 * p.vibration_amplitude <= right:
        # On the paper's curves stands what the paper's model says of this display.
        friction = p.law.by("paper2008").at(p.vibration_amplitude)
        here = (
            f"{shown(p.vibration_amplitude, M, 3)} and λ/2 = {shown(p.mode.half_wavelength, M, 3)}"
        )
        words = f"this display by paper2008: {friction:.2f} at {here}"
        style.mark(axes, 1e6 * p.vibration_amplitude, friction, 9, words)
    style.friction_axes(axes, right, top=1.06)
    style.legend_below(axes)
    return figure


def _drop(axes: Axes, amplitude: float, color: str) -> None:
    """A line from the criterion down to the amplitude that reaches it."""
    axes.plot([1e6 * amplitude] * 2, [0, PAPER_CRITERION], color=color, lw=0.9, ls=(0, (1, 2)))
    axes.plot([1e6 * amplitude], [PAPER_CRITERION], "o", color=color, ms=5, zorder=3)


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
