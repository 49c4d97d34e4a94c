"""Figures of compensation: a grating at twice the speed, and which gratings survive."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.render.fidelity.survival import PAPER_PERIODS
from squeezefilm.report.kit import style
from squeezefilm.report.kit.numbers import M, S, shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.analysis.analyze import Analysis
    from squeezefilm.analysis.textures import CompensatedGrating, TextureSurvival

_PERIODS_SHOWN = 2


@style.drawn
def compensated_grating(grating: CompensatedGrating) -> Figure:
    """One grating by each drive: the amplitude over the way, and the command that makes it."""
    kept, waves = (
        [f"{100 * share:.0f}" for share in shares]
        for shares in (grating.swing_kept, grating.fundamental_kept)
    )
    figure = style.new_figure(
        f"At {1e3 * grating.speed:.0f} mm/s a grating of {shown(grating.spatial_period, M, 3)} "
        f"keeps {kept[0]} % of its swing ({waves[0]} % of its fundamental) without compensation, "
        f"{kept[1]} % ({waves[1]} %) with it, {kept[-1]} % ({waves[-1]} %) with phase inversion",
        f"{grating.drives[-1].model}, τ = {shown(grating.envelope.rise_time_constant, S, 3)}; "
        f"wanted: 0 to {100 * grating.level:g} % of what the full voltage holds",
        6.0,
    )
    top, bottom = figure.subplots(2, 1, height_ratios=[1.3, 1])
    way = 1e3 * grating.speed * grating.time
    last = way >= way[-1] - 1e3 * _PERIODS_SHOWN * grating.spatial_period
    x = way[last] - way[last][0]
    limit = grating.envelope.amplitude_limit
    wanted = grating.drives[0].wanted[last] / limit
    top.plot(x, wanted, color=style.MUTED, lw=1.2, label="wanted")
    for law, share, wave, drive, (color, dashes) in zip(
        grating.laws, kept, waves, grating.drives, style.LINES, strict=False
    ):
        name = f"{law.name}: {share} % ({wave} % of the fundamental)"
        top.plot(x, drive.amplitude[last] / limit, color=color, ls=dashes, label=name)
        bottom.plot(x, drive.command[last] / limit, color=color, ls=dashes, drawstyle="steps-post")
    for level in (1, -1):
        bottom.axhline(level, **style.GUIDE)
    said = "limit of the voltage"
    bottom.text(0.02 * x[-1], 1.06, said, color=style.MUTED, fontsize=9, va="bottom")
    top.set(ylabel="amplitude, relative to the limit", ylim=(0, 1.02))
    bottom.set(xlabel="finger's way (mm)", ylabel="command, relative", ylim=(-1.15, 1.4))
    bottom.set_yticks([-1, 0, 1])
    for axes in (top, bottom):
        axes.set_xlim(0, float(x[-1]))
    top.tick_params(labelbottom=False)
    style.legend_below(bottom, gap=0.22, handles=top.get_legend_handles_labels()[0])
    return figure


@style.drawn
def compensation(analysis: Analysis) -> Figure:
    """`compensated_grating` of an analysis."""
    found = analysis.compensated
    return _nothing() if found is None else compensated_grating(found)


@style.drawn
def survival(analysis: Analysis) -> Figure:
    """`texture_survival` of an analysis."""
    found = analysis.survival
    return _nothing() if found is None else texture_survival(found)


def _nothing() -> Figure:
    return style.message_figure("Nothing to compensate", "No voltage makes an amplitude here.")


@style.drawn
def texture_survival(table: TextureSurvival) -> Figure:
    """Which spatial period survives at which speed, one line per drive."""
    figure = style.new_figure(
        f"Compensation with phase inversion keeps a grating up to {table.gain[-1]:.2g} times the "
        f"finger speed, without inversion up to {table.gain[1]:.2g} times",
        f"{table.model}; swing from 0 to {100 * table.level:g} % of what the full voltage holds, "
        f"{100 * table.kept:g} % of it kept, peak to peak; Q as the display states it",
        5.0,
    )
    grid = figure.add_gridspec(2, 1, height_ratios=[1, 0.1])
    strip, axes = figure.add_subplot(grid[1]), figure.add_subplot(grid[0])
    strip.set_axis_off()
    for law, row, wave, (color, dashes) in zip(
        table.laws, table.finest_period, table.fundamental, style.LINES, strict=False
    ):
        name = f"{law.name}: {100 * wave:.0f} % of the fundamental"
        axes.loglog(1e3 * table.speeds, 1e3 * row, color=color, ls=dashes, label=name)
    for period in PAPER_PERIODS:
        named = "the paper's gratings" if period == PAPER_PERIODS[0] else None
        axes.axhline(1e3 * period, **style.GUIDE, label=named)
    axes.set_title(f"{style.plain(table.name)}, τ = {shown(table.time_constant, S, 3)}")
    axes.set(xlabel="finger speed (mm/s)", xlim=(10, 400), ylim=(0.02, 12))
    axes.set_ylabel("finest period that survives (mm)")
    axes.set_xticks([10, 20, 50, 100, 200, 400])
    axes.set_yticks([0.02, 0.05, 0.1, 0.2, 0.4, 1, 2, 4, 10])
    style.plain_log(axes.xaxis, axes.yaxis)
    style.legend_in(strip, axes, columns=2)
    return figure
