"""A path as it would have been felt: its figure, and the words for the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import M, shown
from squeezefilm.core.kit.terminal import heading, plain_console, show_rows, table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.study.simulated.felt_paths import FeltPath

_COLOURS = {"along x": style.BLUE, "along y": style.ORANGE}
_PIXELS = 240


@style.drawn
def felt_path(path: FeltPath) -> Figure:
    """The path over the surface, its runs by direction, and the evidence for rhythms in each."""
    figure = style.new_figure(
        f"{style.plain(path.stimulus.name, 24)} along this path: {_said(path)}",
        f"SIMULATED by observer '{style.plain(path.observer.name)}'; {path.source}; force "
        f"{path.finger.normal_force:.2g} N, {path.force_is}",
        4.6,
    )
    left, right = figure.subplots(1, 2, width_ratios=[1.1, 1])
    _over_surface(left, path)
    highest = path.observer.detection_criterion
    for name, direction in path.directions.items():
        evidence = direction.percept.evidence
        label = f"{name}: {direction.runs} runs, {shown(direction.way, M, 2)}"
        right.plot(1e3 * evidence.period, evidence.rhythm, color=_COLOURS[name], label=label)
        highest = max(highest, float(evidence.rhythm.max()))
    right.axhline(path.observer.detection_criterion, **style.REFERENCE)
    right.set(xscale="log", xlim=(0.25, 20), ylim=(0, 1.12 * highest))
    right.set(xlabel="spatial period along the path (mm)", ylabel="evidence for a rhythm, d′")
    right.set_xticks([0.4, 1, 2, 4, 10], ["0.4", "1", "2", "4", "10"])
    right.minorticks_off()
    right.set_title("dashed: below it nothing is felt")
    right.legend(loc="upper left", frameon=False)
    return figure


def _over_surface(axes: Axes, found: FeltPath) -> None:
    from squeezefilm.physics.perception.path_runs import straight_runs

    x, y = (np.concatenate([getattr(path, axis) for path in found.paths]) for axis in ("x", "y"))
    room = 0.1 * max(np.ptp(x), np.ptp(y)) + 1e-3
    ends = x.min() - room, x.max() + room, y.min() - room, y.max() + room
    u, w = np.linspace(*ends[:2], _PIXELS), np.linspace(*ends[2:], _PIXELS)
    values = found.stimulus.surface()(u[None, :], w[:, None], 0.08, 0.0)
    left, right, bottom, top = (1e3 * float(end) for end in ends)
    axes.imshow(
        values,
        extent=(left, right, bottom, top),
        origin="lower",
        cmap="Greys",
        alpha=0.35,
        aspect="equal",
        interpolation="nearest",
    )
    for path in found.paths:
        axes.plot(1e3 * path.x, 1e3 * path.y, color=style.METAL, lw=0.9)
        for run in straight_runs(path):
            rows = slice(run.begin, run.end + 1)
            colour = _COLOURS["along x" if run.along_x else "along y"]
            axes.plot(1e3 * path.x[rows], 1e3 * path.y[rows], color=colour, lw=1.6)
    axes.set(xlabel="x (mm)", ylabel="y (mm)")
    axes.set_title("blue: runs along x; orange: along y; dark: sticky")


def _said(path: FeltPath) -> str:
    """Words for what is felt in either direction."""
    parts = []
    for name, direction in path.directions.items():
        if direction.clearest_d_prime > path.observer.detection_criterion:
            period = shown(direction.clearest_period, M, 3)
            parts.append(f"{period} {name} (d′ = {direction.clearest_d_prime:.2g})")
        else:
            parts.append(f"nothing {name}")
    return ", ".join(parts)


def show_felt(path: FeltPath) -> None:
    """Print what a path would have felt like, what it tells apart, and what that rests on."""
    went = path.explored
    known = "" if math.isnan(went.coverage) else f", {100 * went.coverage:.0f} % of the face"
    rows = [
        ("Surface", path.stimulus.name, path.stimulus.kind),
        ("Display", path.display, ""),
        ("Path", f"{shown(went.path_length, M, 3)} in {went.touched:.3g} s", path.source),
        (
            "Explored",
            f"{1e3 * went.mean_speed:.3g} mm/s in the mean",
            f"{1e3 * went.peak_speed:.3g} mm/s at most, {went.passes} passes{known}",
        ),
        ("Force", f"{path.finger.normal_force:.3g} N", path.force_is),
    ]
    if path.answer or path.choice:
        rows.append(("Answered", path.choice or "–", f"right: {path.answer or 'nothing'}"))
    console = show_rows(f"SIMULATED: {_said(path)}", rows)
    heading(console, "Evidence by direction")
    head = ("", "Runs", "Clearest rhythm", "d′", "Next", "Swing asked", "Swing felt")
    table(console, head, [_row(name, path) for name in path.directions], fixed=(0,))
    heading(console, f"How far from each surface by {path.compared_by}")
    away = [(likeness.name, _apart(likeness.apart)) for likeness in path.nearest]
    table(console, ("Surface", "Standard deviations"), away, fixed=(0,))
    for said in path.assumed:
        console.print(f"  {said}", style="dim", highlight=False)


def _apart(value: float) -> str:
    return f"{value:.2f}" if math.isfinite(value) else "nothing felt"


def _row(name: str, path: FeltPath) -> tuple[str, ...]:
    percept = path.directions[name]
    rhythms = percept.percept.candidates
    more = [
        f"{shown(float(period), M, 3)} ({d:.2f})"
        for period, d in zip(rhythms.period[1:], rhythms.d_prime[1:], strict=True)
        if math.isfinite(d)
    ]
    clear = "none" if math.isnan(percept.clearest_period) else shown(percept.clearest_period, M, 3)
    return (
        name,
        f"{percept.runs}",
        clear,
        f"{percept.clearest_d_prime:.2f}",
        ", ".join(more[:2]) or "–",
        f"{percept.asked_swing:.3f}",
        f"{percept.felt_swing:.3f}",
    )


def show_all(paths: tuple[FeltPath, ...]) -> None:
    """Print each surface's after another."""
    for path in paths:
        show_felt(path)
    plain_console().print(
        "Nobody's percept was measured: this is what the observer's senses make of the path.",
        highlight=False,
    )
