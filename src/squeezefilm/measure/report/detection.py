"""Measured thresholds of friction modulation beside the rival senses: rows, words, a figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.measure.fits.friction.populations import (
    MEAN_FRICTION,
    RIVALS,
    DetectionComparison,
    detection_medians,
    rival_observer,
)
from squeezefilm.physics.perception.observer import TUNED_AT, load_observer

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DETECTION_HEAD = ("period", "frequency", "measured", *RIVALS, "temporal over measured")
_TWICE = 2 * TUNED_AT
_TICKS = (0.003, 0.01, 0.03, 0.1)


def detection_rows(compared: DetectionComparison) -> list[tuple[str, ...]]:
    """Each period: the measured median and those of the rivals, as friction coefficients."""
    m, made = compared.measured, dict(compared.rivals)
    return [
        (
            f"{1e3 * m.period[k]:g} mm",
            f"{m.speed / m.period[k]:.3g} Hz",
            f"{m.amplitude[k]:.4f}",
            *(f"{made[rival][k]:.4f}" for rival in RIVALS),
            f"{made['temporal'][k] / m.amplitude[k]:.2f}",
        )
        for k in range(m.period.size)
    ]


def detection_words(compared: DetectionComparison) -> list[str]:
    """What was measured, how near the senses come, and what is assumed."""
    m, made = compared.measured, dict(compared.rivals)["temporal"]
    off = np.abs(np.log(made / m.amplitude))
    return [
        f"least amplitude (zero-to-peak) of the friction coefficient that is detected: medians of "
        f"{m.people} people, {1e3 * m.speed:g} mm/s, {m.normal_force:g} N",
        f"{np.count_nonzero(off < np.log(1.5))} of {m.period.size} medians within a factor of 1.5, "
        f"the farthest by {np.exp(off.max()):.3f}; two numbers were fitted to those at "
        f"{1e3 * TUNED_AT:g} mm/s, where the rivals are alike",
        f"the mean friction coefficient is not published: {MEAN_FRICTION:g} is assumed, and that "
        "what is detected is in proportion to it; how people differ is not known",
    ]


@style.drawn
def detection_figure(compared: DetectionComparison) -> Figure:
    """Measured medians and the rivals at their speed, and what the rivals say at twice the speed at
    which they were fitted."""
    m, observer = compared.measured, load_observer()
    figure = style.new_figure(
        "Modulation of friction that is detected",
        f"rival senses, mean friction {MEAN_FRICTION:g} assumed; {m.people} people, "
        f"{m.normal_force:g} N",
        5,
    )
    period = np.geomspace(m.period.min(), m.period.max(), 81)
    cells = figure.subplots(1, 2, sharey=True)
    looks = dict(zip(RIVALS, style.LINES, strict=False))
    for axes, speed in zip(cells, (m.speed, _TWICE), strict=True):
        for rival in RIVALS:
            colour, dashes = looks[rival]
            medians = detection_medians(
                rival_observer(observer, rival), m, speed=speed, period=period
            )
            axes.plot(1e3 * period, medians, color=colour, ls=dashes, label=rival)
        axes.set(xscale="log", yscale="log", xlabel="spatial period (mm)")
        axes.set_xticks(1e3 * m.period, [f"{x:g}" for x in 1e3 * m.period], minor=False)
        axes.minorticks_off()
        axes.set_title(f"at {1e3 * speed:g} mm/s" + ("" if speed == m.speed else ": predicted"))
    cells[0].plot(1e3 * m.period, m.amplitude, "o", color=style.INK, ms=5)
    cells[1].plot([], [], "o", color=style.INK, ms=5, label="measured")
    cells[0].set_yticks(_TICKS, [f"{x:g}" for x in _TICKS])
    cells[0].set_ylabel("amplitude of the friction coefficient")
    style.legend_beside(cells[1])
    return figure
