"""What is shown of telling laws apart: the best experiment for each pair, and a map of all."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.report.kit import style
from squeezefilm.report.kit.numbers import M, N, shown
from squeezefilm.report.kit.terminal import heading, plain_console, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.analysis.friction.tell_apart import BestExperiment, Condition, ToldApart

_SPEED = si.Unit("m/s")
_OF = {"height_law": "laws of the heights", "finger.tangential_stiffness": "shear elements"}
_SHORT = {"height_law": "heights", "finger.tangential_stiffness": "shear"}


def show_told_apart(found: ToldApart) -> None:
    """Print which experiment would tell the laws apart."""
    console = plain_console()
    heading(console, "Which measurement would tell the laws apart")
    rows = [
        (
            _pair(one),
            _words(one.condition),
            "{:.2f} or {:.2f}".format(*one.means),
            _percent(one.right),
        )
        for one in found.best
    ]
    table(console, ("pair", "one condition", "µ′/µ", "right"), rows, fixed=(0,))
    heading(console, "Which ratio of two measurements with the same finger would")
    rows = [
        (
            _pair(one),
            f"{_words(one.ratio[0])} over {_words(one.ratio[1])}",
            "{:.2f} or {:.2f}".format(*one.ratio_means),
            _percent(one.ratio_right),
        )
        for one in found.best
    ]
    table(console, ("pair", "two conditions", "ratio", "right"), rows, fixed=(0,))
    for overall in found.overall:
        console.print(
            f"One condition for all {_OF[overall.of]}: {_words(overall.condition)}; right in "
            f"{_percent(overall.least)} of the cases for the two told worst."
        )
    console.print(
        "“Right” is how often whoever measures would choose the right one of the two; 50 % is "
        f"guessing. The rest of the finger is drawn ({found.draws} fingers); a measured µ′/µ is "
        f"taken to scatter by {si.percent(found.noise)}, which is assumed."
    )


@style.drawn
def told_apart(result: Any) -> Figure:
    """How well each pair is told apart, over force, amplitude and speed."""
    from scipy.special import ndtr

    found: ToldApart = result.apart
    best = max(found.best, key=lambda one: one.discriminability)
    figure = style.new_figure(
        f"One measurement tells {_OF[best.of]} best: {' or '.join(best.pair)}, at "
        f"{_words(best.condition)}, right in {_percent(best.right)} of the cases",
        f"{found.draws} fingers drawn, µ′/µ measured within {si.percent(found.noise)} (assumed); "
        "blank where draws are refused",
        6.0,
    )
    axes = figure.subplots(2, -(-len(found.pairs) // 2), sharex=True, sharey=True, squeeze=False)
    columns = [f"{1e6 * a:g} µm" for a in found.amplitudes]
    for one, pair, d in zip(axes.ravel(), found.best, found.discriminability, strict=False):
        # Amplitudes side by side, within each the speeds.
        right = ndtr(np.swapaxes(d, 1, 2).reshape(found.forces.size, -1) / 2)
        image = one.imshow(100 * right, vmin=50, vmax=100, cmap="cividis", aspect="auto")
        one.set_title(_pair(pair), fontsize=10)
        style.bare(one)
        for edge in range(1, found.amplitudes.size):
            one.axvline(edge * found.speeds.size - 0.5, color=style.PAPER, lw=2)
        middle = (np.arange(found.amplitudes.size) + 0.5) * found.speeds.size - 0.5
        one.set_xticks(middle, columns)
        one.set_yticks(range(found.forces.size), [f"{f:g} N" for f in found.forces])
    speeds = ", ".join(f"{1e3 * v:g}" for v in found.speeds)
    figure.supylabel("normal force")
    axes[-1, axes.shape[1] // 2].set_xlabel(
        f"amplitude, and within each from left to right {speeds} mm/s"
    )
    figure.colorbar(image, ax=axes, label="chooses the right one (%), 50 is guessing")
    return figure


def _pair(one: BestExperiment) -> str:
    return f"{_SHORT[one.of]}: {' or '.join(one.pair)}"


def _percent(share: float) -> str:
    """A probability of a model, which is never certain."""
    return si.percent(share) if share <= 0.99 else "above 99 %"


def _words(at: Condition) -> str:
    return f"{shown(at.normal_force, N)}, {shown(at.speed, _SPEED)}, {shown(at.amplitude, M)}"
