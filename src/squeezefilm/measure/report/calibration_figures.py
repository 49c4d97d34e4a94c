"""A calibration in pictures: the model beside what was measured, and friction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.calibration_record import ComparedAnswer
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import shown, span
from squeezefilm.core.kit.page_style import FigureOf
from squeezefilm.measure.calibration.folder import FolderCalibration
from squeezefilm.physics.uncertainty.intervals import LEVEL

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PRIOR: dict[str, Any] = {"color": style.MUTED, "lw": 1.4}
_POSTERIOR: dict[str, Any] = {"color": style.BLUE, "lw": 4.5, "solid_capstyle": "butt"}
_ROW, _REST = 0.29, 1.6
_FINE = 1e-3  # up to which a difference is drawn in proportion, beyond it by its logarithm
_TICKS = (-0.1, -0.01, -0.001, 0.0, 0.001, 0.01, 0.1)


@style.drawn
def compared_figure(calibration: FolderCalibration) -> Figure:
    """Figure of what the model alone says of every measured number, before and after."""
    rows = calibration.calibration.compared
    far = [one for one in rows if one.after and abs(deviation(one)) > 2]
    title = (
        f"The calibrated model meets all {len(rows)} measured numbers within two standard errors"
        if not far
        else f"The calibrated model misses {len(far)} of {len(rows)} measured numbers by more than "
        "two standard errors"
    )
    figure = style.new_figure(
        title,
        f"{si.percent(LEVEL)} intervals of the model alone, without what it is believed to be off "
        "by; the scale is proportional within ±0.1 %, logarithmic beyond",
        _REST + _ROW * max(len(rows), 2),
    )
    axes = figure.subplots()
    for row, one in enumerate(rows):
        _before_after(axes, row, one)
        error = min(one.error, 0.9)
        look: dict[str, Any] = {"color": style.ORANGE, "capsize": 3, "ms": 4, "lw": 1.2}
        label = "" if row else "measured, ± one standard error"
        axes.errorbar([0], [row], xerr=[error], fmt="D", zorder=4, label=label, **look)
    _rows(axes, [row_name(one) for one in rows])
    axes.axvline(0, **style.ZERO)
    axes.set_xscale("symlog", linthresh=_FINE, linscale=0.6)
    axes.set_xticks(
        _TICKS, [f"{'−+'[tick > 0]}{100 * abs(tick):g} %" if tick else "0" for tick in _TICKS]
    )
    axes.minorticks_off()
    axes.set_xlim(-0.95, 2)
    axes.set_xlabel("model over measured, less 1")
    style.legend_below(axes, columns=3, gap=0.9 / (_REST + _ROW * len(rows)))
    return figure


def _before_after(axes: Axes, row: int, answer: ComparedAnswer) -> None:
    looks = ((answer.before, _PRIOR, "before"), (answer.after, _POSTERIOR, "after"))
    for ends, look, label in looks:
        if ends:
            axes.plot([ends[0] - 1, ends[2] - 1], [row, row], **look, label="" if row else label)


def deviation(answer: ComparedAnswer) -> float:
    """Number of standard errors (measurement's and model's together) by which the measured value
    lies above the calibrated model's median; NaN where the model has none."""
    if not answer.after:
        return float("nan")
    from scipy.special import ndtri

    spread = (answer.after[2] - answer.after[0]) / (2 * float(ndtri((1 + LEVEL) / 2)))
    return (1 - answer.after[1]) / max(float(np.hypot(answer.error, spread)), 1e-12)


def row_name(answer: ComparedAnswer) -> str:
    """An observation by its name, and its recording where it has one."""
    return style.plain(
        f"{answer.said} ({answer.recording})" if answer.recording else answer.said, 90
    )


@style.drawn
def friction_figure(calibrated: FolderCalibration) -> Figure:
    """Friction's interval before and after."""
    before, after = calibrated.calibration.before, calibrated.calibration.after
    pairs = (("as described", before), ("with what was measured", after))
    known = [(name, interval) for name, interval in pairs if interval is not None]
    if after is None:
        title = "Friction has no interval: too many draws have none"
    elif before is None:
        title = f"µ′/µ is {span(*after.interval)}"
    else:
        title = (
            f"µ′/µ is {span(*after.interval)} where it was {span(*before.interval)}: "
            f"{si.percent(after.width / before.width)} of that interval is left"
        )
    figure = style.new_figure(
        title, f"{si.percent(LEVEL)} intervals at the display's own voltage, force and speed", 2.5
    )
    axes = figure.subplots()
    for row, (_, interval) in enumerate(known):
        look = _POSTERIOR if interval is after else _PRIOR | {"lw": 4.5}
        axes.plot(interval.interval, [row, row], **look)
        axes.plot([interval.median], [row], **style.ESTIMATE)
    names = [f"{name},\n{shown(interval.amplitude, si.Unit('m'), 2)}" for name, interval in known]
    _rows(axes, names)
    axes.set(xlim=(0, 1.04), xlabel="relative friction µ′/µ")
    return figure


def _rows(axes: Axes, names: list[str]) -> None:
    """Rows from above, each with its name."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)


FIGURES = (
    FigureOf("friction", "Friction before and after", friction_figure),
    FigureOf(
        "compared",
        "The model beside every measurement",
        compared_figure,
        has=lambda result: result.calibration.compared,
    ),
)
"""The figures of a calibration, in the order of its page."""
