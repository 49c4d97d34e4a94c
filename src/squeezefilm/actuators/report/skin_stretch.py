"""Rows and figures of a skin-stretch array, for the terminal and the page."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.actuators.analysis.drawn import with_interval
from squeezefilm.actuators.analysis.skin_stretch import SkinStretchAnalysis
from squeezefilm.actuators.skin_stretch.bimorph import (
    PUBLISHED_BLOCKED,
    PUBLISHED_FREE,
    PUBLISHED_LOADED,
)
from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import HZ, M, N, Row, V, W, shown
from squeezefilm.core.kit.page_style import FigureOf

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.actuators.analysis.skin_stretch import ShownWave

SKIN_STRETCH_ANSWERS = {
    "deflection_on_skin_m": "deflection on the skin",
    "force_on_skin_N": "force on the skin",
    "crosstalk": "crosstalk",
}


def skin_stretch_rows(analysis: SkinStretchAnalysis) -> list[Row]:
    """The key numbers: quantity, value, remark."""
    array, tip, budget = analysis.array, analysis.tip, analysis.array.budget
    heat, driven = analysis.power
    sure = functools.partial(with_interval, analysis.drawn)
    count = array.cradle.count
    ways = " or ".join(way.replace("_", " ") for way in analysis.lines)
    seated = "never all" if analysis.least_force is None else shown(analysis.least_force, N, 3)
    return [
        (
            "Free deflection",
            sure(analysis.free_deflection, "free_deflection_m", M),
            f"at {shown(analysis.voltage, V, 3)}; the paper says {shown(PUBLISHED_FREE, M, 3)}",
        ),
        (
            "Blocked force",
            sure(analysis.blocked_force, "blocked_force_N", N),
            f"the paper says {shown(PUBLISHED_BLOCKED, N, 3)}",
        ),
        (
            "Against the skin",
            sure(tip.deflection, "deflection_on_skin_m", M),
            f"and {sure(tip.force, 'force_on_skin_N', N)}; the skin's "
            f"{analysis.skin.stiffness / 1e3:.3g} N/mm are assumed, as the paper's "
            f"{shown(PUBLISHED_LOADED, M, 3)} imply",
        ),
        (
            "Resonance",
            shown(array.bender.resonance_frequency, HZ, 3),
            f"free; {shown(tip.resonance_frequency, HZ, 3)} on the skin, within 3 dB up to "
            f"{shown(tip.bandwidth, HZ, 3)}",
        ),
        (
            "Crosstalk",
            sure(array.crosstalk, "crosstalk", si.Unit("1")),
            "of its displacement, at the neighbour that moves most",
        ),
        (
            "Contactors",
            f"{analysis.seating.touching} of {count} touch",
            f"under {shown(array.normal_force, N, 3)}; all from {seated} on",
        ),
        (
            "Slip",
            f"{analysis.together.slipping} of {count}",
            f"where all pull alike; {analysis.wave.pull.slipping} in a wave of "
            f"{shown(analysis.wave.period, M, 3)}",
        ),
        (
            "Actuators alone",
            f"{1e3 * budget.mass:.3g} g",
            f"{1e6 * budget.volume:.3g} cm³, of 60 g and 150 cm³; {1e4 * budget.area:.3g} cm² "
            "active; clamps, drivers and housing are not modelled",
        ),
        (
            "Power at 100 Hz",
            shown(driven, W, 3),
            f"that drivers burn at full swing; {shown(heat, W, 2)} heats the ceramics",
        ),
        (
            "Wires",
            " or ".join(map(str, analysis.lines.values())),
            f"{ways}; a count, not a circuit",
        ),
    ]


_DRAWN_TIMES = 10


@style.drawn
def load_line_figure(analysis: SkinStretchAnalysis) -> Figure:
    """An actuator's load line and the skin's, and where they meet; and its answer to a sine."""
    um, mn = 1e6, 1e3
    tip = analysis.tip
    figure = style.new_figure(
        f"{um * tip.deflection:.3g} µm and {mn * tip.force:.3g} mN against the skin",
        "actuator as a solid, linear skin under one contactor alone; right: one mode",
        4.0,
    )
    left, right = figure.subplots(1, 2)
    free = um * analysis.free_deflection
    left.plot([0, free], [mn * analysis.blocked_force, 0], color=style.BLUE, label="actuator")
    reach = min(free, um * analysis.blocked_force / analysis.skin.stiffness)
    left.plot(
        [0, reach], [0, reach * mn / um * analysis.skin.stiffness], color="black", label="skin"
    )
    _intervals(left, analysis, free)
    left.plot(um * tip.deflection, mn * tip.force, "o", color=style.ORANGE)
    left.set(xlabel="deflection (µm)", ylabel="force (mN)", xlim=(0, None), ylim=(0, None))
    style.legend_below(left, columns=3)
    right.plot(analysis.frequencies, um * np.abs(analysis.motion), color=style.BLUE)
    right.axvline(tip.bandwidth, color=style.ORANGE, lw=1, label="within 3 dB up to here")
    right.set(xlabel="frequency (Hz)", ylabel="deflection on the skin (µm)", xscale="log")
    style.legend_below(right)
    return figure


def _intervals(axes: Axes, analysis: SkinStretchAnalysis, free: float) -> None:
    """Between which lines the skin lies in 5 to 95 % of the draws, and how far deflection and force
    do."""
    drawn = analysis.drawn.intervals
    if not drawn:
        return
    um, mn = 1e6, 1e3
    low, _, high = (mn / um * stiffness for stiffness in drawn["skin_stiffness_N_per_m"])
    skins = ([0, free], [0, free * low], [0, free * high])
    axes.fill_between(*skins, color="black", alpha=0.12, lw=0, label="skin, 5 to 95 %")
    x, y = um * analysis.tip.deflection, mn * analysis.tip.force
    (left, _, right), (below, _, above) = drawn["deflection_on_skin_m"], drawn["force_on_skin_N"]
    across = [[max(0, y - mn * below)], [max(0, mn * above - y)]]
    along = [[max(0, x - um * left)], [max(0, um * right - x)]]
    axes.errorbar(x, y, across, along, color=style.ORANGE, capsize=3)
    axes.set_ylim(0, 1.05 * mn * analysis.blocked_force)


@style.drawn
def strain_figure(analysis: SkinStretchAnalysis) -> Figure:
    """The strain along the finger at the wave's first instant, and what the contactors do."""
    wave = analysis.wave
    figure = style.new_figure(
        f"A wave of {1e3 * wave.period:.3g} mm strains the skin by up to "
        f"{100 * np.max(np.abs(wave.strain)):.2g} %",
        "elastic layer on bone, quasi-static, contactors held by friction; means over cells",
        4.4,
    )
    left, right = figure.subplots(1, 2)
    _strain_map(figure, left, wave)
    _contactors(right, analysis)
    style.legend_below(right, columns=2)
    return figure


def _contactors(axes: Axes, analysis: SkinStretchAnalysis) -> None:
    """Places of each contactor's skin, drawn larger, and which slip."""
    slips = analysis.wave.slips[0]
    x, y = (1e3 * place for place in analysis.array.cradle.places)
    moved = _DRAWN_TIMES * 1e3 * analysis.wave.displacements[0]
    true_length: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1}
    axes.quiver(x, y, moved, np.zeros(moved.size), color=style.BLUE, width=0.006, **true_length)
    axes.plot(x[~slips], y[~slips], "o", ms=3, color="black", label="sticks")
    axes.plot(x[slips], y[slips], "o", ms=3, mfc="white", color=style.ORANGE, label="slips")
    side = analysis.array.cradle.pitch_along * 1e3
    axes.set(xlabel="along the finger (mm)", ylabel="across (mm)", aspect="equal")
    axes.set_xlim(x.min() - side, x.max() + side)
    axes.set_title(f"the skin's way under contactors, {_DRAWN_TIMES} times", fontsize="medium")


def _strain_map(figure: Figure, axes: Axes, wave: ShownWave) -> None:
    most = 100 * float(np.max(np.abs(wave.strain)))
    cells = (1e3 * wave.edges_x, 1e3 * wave.edges_y, 100 * wave.strain[0].T)
    drawn = axes.pcolormesh(*cells, cmap="RdBu_r", vmin=-most, vmax=most)
    figure.colorbar(drawn, ax=axes, shrink=0.8)
    axes.set(xlabel="along the finger (mm)", ylabel="across (mm)", aspect="equal")
    axes.set_title("strain along the finger (%)", fontsize="medium")


@style.drawn
def crosstalk_figure(analysis: SkinStretchAnalysis) -> Figure:
    """Displacement of the skin with distance from the contactor that moves a neighbour most."""
    array = analysis.array
    x, y = array.cradle.places
    shares = 100 * array.crosstalk_shares
    # Mirrored contactors do so equally: the first, whatever rounding says.
    pulls = int(np.argmax(np.round(shares.max(axis=0), 9)))
    share, apart = shares[:, pulls], 1e3 * np.hypot(x - x[pulls], y - y[pulls])
    others = apart > 0
    figure = style.new_figure(
        f"Crosstalk: a neighbour's skin moves by at most {100 * array.crosstalk:.3g} %",
        "one actuator driven, all others hold still as the springs they are",
        4.0,
    )
    left, right = figure.subplots(1, 2)
    along = np.abs(y - y[pulls]) < 1e-9
    left.plot(apart[others & along], share[others & along], "o", ms=4, label="along the pull")
    left.plot(
        apart[others & ~along], share[others & ~along], "s", ms=4, mfc="none", label="elsewhere"
    )
    left.set(xlabel="distance (mm)", ylabel="of its own displacement (%)", ylim=(0, None))
    style.legend_below(left, columns=2)
    forces = 1e3 * analysis.seating.forces
    drawn = right.scatter(1e3 * x, 1e3 * y, c=forces, s=60, cmap="viridis")
    figure.colorbar(drawn, ax=right, shrink=0.8)
    right.set(xlabel="along the finger (mm)", ylabel="across (mm)", aspect="equal")
    right.set_title("finger's force on each contactor (mN)", fontsize="medium")
    return figure


SKIN_STRETCH_FIGURES = (
    FigureOf("load-line", "One actuator against the skin", load_line_figure),
    FigureOf("strain", "The skin under the array", strain_figure),
    FigureOf("crosstalk", "Crosstalk and seat", crosstalk_figure),
)
