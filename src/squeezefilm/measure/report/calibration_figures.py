"""A calibration in a picture: friction before and after; and how its numbers are called."""

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


FIGURES = (FigureOf("friction", "Friction before and after", friction_figure),)
"""The figures of a calibration, in the order of its page."""
