"""`write_play`: numbers, figures and a page of a session, beside its record."""

from __future__ import annotations

import math
from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.numbers import HZ, M, S, printable, shown
from squeezefilm.core.kit.page_style import (
    FigureOf,
    Pictures,
    bullets,
    drawn_figures,
    links,
    page,
    picture_files,
    picture_sections,
    rows_section,
    section,
    stamped,
)
from squeezefilm.instruments.report.terminal import play_rows, play_warnings
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.shared import class_ends

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.instruments.bench.play import PlayResult
    from squeezefilm.instruments.bench.played_session import PlayedSession, PlayedWay

_WINDOW = 0.25


@style.drawn
def friction(session: PlayedSession) -> Figure:
    """Friction wanted and rendered over the finger's place, as recorded and as it was."""
    judged = session.by_truth or session.by_record
    way = judged.way
    if way.time.size < 8:
        said = "There is no place to draw friction over."
        return style.message_figure("The finger was not seen", said)
    title = f"{style.plain(session.setup.name, 40)}: "
    fidelity = judged.fidelity
    if fidelity is None:
        title += "it cannot be judged"
    else:
        kept = fidelity.contrast_kept[np.isfinite(fidelity.contrast_kept)]
        title += f"{100 * float(kept[0]):.0f} % of the contrast is kept" if kept.size else "played"
        if math.isfinite(fidelity.lag):
            word = "late" if fidelity.lag >= 0 else "early"
            title += f", {1e3 * abs(fidelity.lag):.2f} mm {word}"
    figure, axes = style.new_axes(title, f"{way.source}; friction by the display's law", 4.2)
    part = _middle_pass(way)
    order = part[np.argsort(way.x[part])]
    x, wanted = 1e3 * way.x[order], way.relative_friction_wanted[order]
    axes.plot(x, wanted, **style.WANTED, label="wanted where the finger was")
    axes.plot(x, way.relative_friction_rendered[order], **style.RENDERED, label="rendered")
    if session.by_truth is not None:
        seen = session.by_record.way
        inside = (seen.time >= way.time[part[0]]) & (seen.time <= way.time[part[-1]])
        x, rendered = 1e3 * seen.x[inside], seen.relative_friction_rendered[inside]
        named = "by the record (sensor and pickup)"
        axes.plot(x, rendered, ".", ms=3, color=style.GREEN, label=named)
    axes.set(xlabel="place of the finger (mm)", ylabel="relative friction µ′/µ", ylim=(0, 1.05))
    style.legend_below(axes, columns=3)
    return figure


def _middle_pass(way: PlayedWay) -> si.FloatArray:
    """Indices of the one-way pass in the middle of a session, between moves of more than 1 mm."""
    from scipy.signal import find_peaks

    turns = [find_peaks(x, prominence=1e-3)[0] for x in (way.x, -way.x)]
    ends = np.sort(np.concatenate([[0], *turns, [way.x.size - 1]]))
    middle = int(np.searchsorted(ends, way.x.size // 2))
    return np.arange(ends[middle - 1], ends[middle] + 1)


@style.drawn
def amplitude(session: PlayedSession) -> Figure:
    """The amplitude commanded, reported by the pickup and true, over a quarter of a second."""
    rows = session.trace.rows
    if len(rows) < 8:
        return style.message_figure("Nothing was played", "The record holds no rows.")
    plan = session.setup.plan.loop
    time = rows[:, column.TIME]
    middle = float(time[len(time) // 2])
    inside = np.abs(time - middle) <= 0.5 * _WINDOW
    t = time[inside]
    largest = plan.envelope.amplitude_limit
    figure = style.new_figure(
        f"The display reaches {shown(largest, M, 3)}; the plate follows its commands with "
        f"τ = {shown(plan.envelope.rise_time_constant, S, 2)}",
        f"mode {session.setup.plan.mode}, compensation {plan.compensation}, commands "
        f"{shown(plan.output_delay, S, 2)} ahead",
        5.0,
    )
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    commanded = plan.amplitude_per_volt * np.abs(rows[inside, column.VOLTAGE])
    above.step(
        t + plan.output_delay,
        1e6 * commanded,
        where="post",
        color=style.ORANGE,
        lw=1.2,
        label="commanded, at its time",
    )
    if session.by_truth is not None:
        way = session.by_truth.way
        near = np.abs(way.time - middle) <= 0.5 * _WINDOW
        above.plot(way.time[near], 1e6 * way.amplitude[near], **style.RENDERED, label="true")
    seen = session.by_record.way
    near = np.abs(seen.time - middle) <= 0.5 * _WINDOW
    x, y = seen.time[near], 1e6 * seen.amplitude[near]
    above.plot(x, y, ".", ms=3.5, color=style.GREEN, label="in the record")
    above.set(ylabel="amplitude (µm)", ylim=(0, 1.12e6 * largest))
    style.legend_beside(above)
    below.plot(t, 1e3 * rows[inside, column.X], color=style.INK, lw=1.4)
    below.set(xlabel="time (s)", ylabel="place (mm)", xlim=(t[0], t[-1]))
    return figure


@style.drawn
def lateness(session: PlayedSession) -> Figure:
    """Figure of how late ticks were made, and how long samples wait for their command."""
    late = session.last("loop").get("lateness")
    if not late or not late["made"]:
        return style.message_figure("The loop could not say how late it was", "It made no tick.")
    rate, counts, due = late["rate_Hz"], np.array(late["counts"]), late["made"] + late["lost"]
    lost = f"{100 * late['lost'] / due:.2g} % of {due} ticks were lost"
    if not late["lost"]:
        lost = f"None of {due} ticks was lost"
    figure = style.new_figure(
        f"{lost}; half are made within {shown(late['p50_s'], S, 2)}, 99.9 % within "
        f"{shown(late['p99_9_s'], S, 2)}",
        f"loop at {shown(rate, HZ, 3)}; a tick is lost when the next is due before it began",
        3.8,
    )
    left, right = figure.subplots(1, 2)
    # The first class, whatever is below 100 ns, is drawn as wide as the next.
    ends = 1e6 * class_ends()[:-1]
    edges = np.concatenate([[ends[0] ** 2 / ends[1]], ends])
    left.stairs(counts[:-1], edges, fill=True, color=style.BLUE)
    used = np.flatnonzero(counts[:-1])
    left.set_xlim(edges[max(int(used[0]) - 2, 0)], max(2e6 / rate, 1.5 * edges[used[-1] + 1]))
    left.axvline(1e6 / rate, **style.REFERENCE, label="a period")
    left.set(xscale="log", yscale="log", xlabel="lateness (µs)", ylabel="ticks")
    left.set_ylim(0.7, None)
    left.legend(loc="upper left", frameon=False)
    lag = session.trace.rows[:, column.LAG]
    lag = 1e3 * lag[np.isfinite(lag)]
    if lag.size:
        right.hist(lag, bins=60, color=style.GREEN)
    right.set(xlabel="way from sample to its command (mm)", ylabel="ticks")
    return figure


FIGURES = (
    FigureOf("friction", "Friction along the finger's way", friction),
    FigureOf("amplitude", "Amplitude", amplitude),
    FigureOf("lateness", "Lateness and lag", lateness),
)


def write_play(
    result: PlayResult, folder: Path, progress: Callable[[str], None] | None = None
) -> Path:
    """Write summary.json, figures and play.html into `folder`, where the record is.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    tell = progress or (lambda _: None)
    tell("figures")
    figures = drawn_figures(FIGURES, result.session, "play-")
    files = picture_files(figures)
    files["summary.json"] = json_text(result.summary())
    there = {*files, *(file.name for file in folder.glob("*"))}
    beside = sorted(name for name in there if Path(name).suffix in (".sqft", ".csv", ".json"))
    files["play.html"] = _page(result, figures, beside)
    return write_folder(folder, files)


def _page(result: PlayResult, figures: Pictures, files: list[str]) -> str:
    session = result.session
    title = escape(printable(session.setup.name))
    stamp = session.trace.metadata
    caption = "What the finger met, how late the loop was, what the link lost"
    return page(
        f"{title}: a session",
        title,
        f"played on <code>{escape(printable(session.setup.display.name))}</code>,\n"
        f"drive <code>{escape(printable(str(stamp.get('drive', ''))))}</code>, by squeezefilm",
        rows_section("Numbers", caption, play_rows(result))
        + picture_sections(figures)
        + section("Warnings", bullets(play_warnings(session))),
        f"{stamped(stamp, 'SHA-256 of display, texture and settings', 'begun')} ·\n"
        f"seed {escape(str(stamp.get('seed', '')))}. Beside this page: {links(files)}.",
    )
