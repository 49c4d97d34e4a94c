"""A fitted psychometric function and the answers it was fitted to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.report.kit import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.study.psychometric.fit import PsychometricFit


@style.drawn
def psychometric_function(fit: PsychometricFit) -> Figure:
    """Share of positive answers against intensity; the area of a point is its number of trials."""
    function, log = fit.function, fit.function.axis == "log"
    low, high = fit.posterior_interval["threshold"]
    figure = style.new_figure(
        f"The threshold is {function.threshold:.3g}, with {fit.level:.0%} between {low:.3g} and "
        f"{high:.3g}",
        f"{function.shape} function, guess rate {function.guess_rate:.2g}, lapse rate "
        f"{function.lapse_rate:.2g}; {int(fit.trials.sum())} trials; credible interval",
        4.4,
    )
    axes = figure.subplots()
    first, last = float(fit.intensity[0]), float(fit.intensity[-1])
    room = 0.0 if log else 0.04 * (last - first)
    ends = first - room, last + room
    x = np.geomspace(*ends, 201) if log else np.linspace(*ends, 201)
    axes.plot(x, 100 * np.asarray(function(x)), color=style.BLUE)
    share = 100 * fit.positive / fit.trials
    area = 20 + 180 * fit.trials / fit.trials.max()
    axes.scatter(fit.intensity, share, s=area, color=style.MUTED, edgecolor=style.PAPER, zorder=3)
    middle = 100 * float(np.asarray(function(function.threshold)))
    axes.plot([low, high], [middle, middle], color=style.ORANGE, lw=2.4, zorder=4)
    axes.plot(
        [function.threshold], [middle], "D", color=style.ORANGE, ms=7, mec=style.PAPER, zorder=5
    )
    axes.set(xlabel="intensity", ylabel="positive answers (%)", ylim=(-2, 103))
    if log:
        axes.set_xscale("log")
        style.plain_log(axes.xaxis)
    return figure
