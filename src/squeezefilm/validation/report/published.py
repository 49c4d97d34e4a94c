"""Measured friction beside every model, measured thresholds beside the rival senses: printed and
written by `reproduce --data`, and the documentation's page of published friction."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import checkout, json_text, markdown_table, write_folder
from squeezefilm.core.kit.numbers import decimals, printable, shown
from squeezefilm.core.kit.page_style import (
    bullets,
    page,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.core.kit.terminal import bullets as printed_bullets
from squeezefilm.core.kit.terminal import heading, say, table
from squeezefilm.core.results import stamp, write_whole
from squeezefilm.measure.fits.friction.friction_curve import LEVELS
from squeezefilm.measure.recordings.kinds import Told
from squeezefilm.measure.report.fit_figures import comparison_figure, conditions
from squeezefilm.measure.report.page import (
    MODELS_HEAD,
    inside_words,
    model_rows,
    model_words,
)
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL
from squeezefilm.physics.perception.observer import TUNED_AT, load_observer
from squeezefilm.physics.perception.senses import MEAN_FRICTION
from squeezefilm.validation.populations import (
    RIVALS,
    DetectionComparison,
    PopulationComparison,
    detection_medians,
    rival_observer,
)
from squeezefilm.validation.published_friction import FolderComparison

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TOTALS_HEAD = ("model", "off by", "log score, mean ± s.e.", "fitted")
COVERAGE_HEAD = ("finger or paper", "points", "in the 50 % interval", "in the 90 % interval")
PEOPLE_HEAD = ("model", "value", "share of measured below")
DETECTION_HEAD = ("period", "frequency", "measured", *RIVALS, "temporal over measured")
FITTED = (
    "'Off by' is the root mean square of measured less computed friction, over one friction at "
    "rest that knows no model (the line through the first three points). The friction at rest is "
    "fitted to each curve, whatever the model; of shapes without physics, and of the levitation "
    "whose length is fitted, one amplitude too."
)
SCORES = (
    "Each finger counts once, and so does each paper whose fingers are not told apart. The log "
    "score is the mean natural logarithm of the density of a point, in units of the friction at "
    "rest, with the model's error over the other fingers and papers as its spread: higher is "
    "better."
)
_HEAD = f"""# Published friction

Written by `squeezefilm reproduce --data published --write-docs`; do not edit. Published
measurements of fingers on ultrasonic plates that could be read, beside every model of friction and
beside two shapes without physics and the published levitation model of 2016.

{FITTED}

**What was never measured in them**: metal and coated surfaces, forces above 0.8 N, frequencies
below 29 kHz, moisture, and speed as the only change. The numbers were read off figures, with an
error of about 1 % of an axis.
"""


def total_rows(compared: FolderComparison) -> list[tuple[str, ...]]:
    """The models over all fingers and papers, the nearest first."""
    return [
        (
            model_words(total.model),
            decimals(total.difference, 3),
            decimals(total.log_score, 2)
            + ("" if total.log_score_error is None else f" ± {total.log_score_error:.2f}"),
            str(total.fitted),
        )
        for total in compared.totals
    ]


def people_rows(compared: PopulationComparison) -> list[tuple[str, ...]]:
    """Rows of what each model gives of a number of many people."""
    return [
        (
            model_words(model),
            "–" if value is None else _valued(value, compared.unit),
            "–" if value is None else si.percent(compared.share_below(value)),
        )
        for model, value in compared.models
    ]


def _valued(value: float, unit: str) -> str:
    return f"{1e6 * value:.3g} mg" if unit == "kg" else printable(shown(value, si.Unit(unit), 3))


def covered_words(compared: FolderComparison) -> str:
    """Number of fingers and papers that lie in the interval of the default, in words."""
    within, units, (low, high) = compared.units_covered
    return (
        f"{within} of {units} fingers or papers lie in the interval of the default, at least 90 % "
        f"of their points ({low:.2f}–{high:.2f}, 95 % interval of the share)"
    )


def coverage_rows(compared: FolderComparison) -> list[tuple[str, ...]]:
    """Rows by finger or paper of the share of points in two central intervals of the default."""
    at = [LEVELS.index(level) for level in (0.5, 0.9)]
    # A finger or paper goes by the name of its first curve.
    names = {item.curve.unit: item.curve.told.name for item in reversed(compared.curves)}
    return [
        (printable(names[unit]), str(points), *(si.percent(inside[k] / points) for k in at))
        for unit, (inside, points) in compared.coverage.items()
    ]


def people_words(compared: PopulationComparison) -> str:
    """Distribution of a number over people."""
    low, median, high = (
        _valued(float(value), compared.unit)
        for value in np.quantile(compared.measured, [0.05, 0.5, 0.95])
    )
    return (
        f"{compared.quantity}: median {median}, 5 to 95 % {low} to {high}, "
        f"{compared.measured.size} measured; {compared.display}, {compared.conditions}"
    )


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
    """Sentences on what was measured, how near the senses come, and what is assumed."""
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


_TICKS = (0.003, 0.01, 0.03, 0.1)

# Micrometres and milligrams, on the axis of a figure.
_SHOWN = {"m": ("µm", 1e6), "kg": ("mg", 1e6)}


@style.drawn
def people_figure(compared: PopulationComparison) -> Figure:
    """Share of people below each value, and the values of the models."""
    unit, scale = _SHOWN.get(compared.unit, (compared.unit, 1.0))
    figure, axes = style.new_axes(
        f"{compared.quantity}: {compared.measured.size} measured",
        f"nothing fitted; {compared.display}, {compared.conditions}",
        4,
    )
    ordered = scale * np.sort(compared.measured)
    axes.step(
        ordered,
        np.arange(1, ordered.size + 1) / ordered.size,
        color=style.INK,
        where="post",
        label="measured",
    )
    for model, value in compared.models:
        if value is not None:
            look = style.RENDERED if model == DEFAULT_MODEL else style.GUIDE
            axes.axvline(scale * value, **look, label=model if model == DEFAULT_MODEL else None)
    axes.set(xlabel=f"{compared.quantity} ({unit})", ylabel="share of measured", ylim=(0, 1))
    style.legend_beside(axes)
    return figure


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
    for axes, speed in zip(cells, (m.speed, 2 * TUNED_AT), strict=True):
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


class _Compared(NamedTuple):
    """A recording beside the models: who measured it, its name, what is said (first on what and how
    it was measured), its table, and what draws its figure."""

    told: Told
    name: str
    words: Sequence[str]
    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    figure: Callable[[], Figure]


_Table = tuple[str, Sequence[str], Sequence[Sequence[str]]]


def _recordings(compared: FolderComparison) -> Iterator[_Compared]:
    """Curves first, then numbers of many people, then thresholds."""
    numbers: _Table
    for curve in compared.curves:
        told = curve.curve.told
        words = [conditions(curve), inside_words(curve), curve.adequacy.sentence]
        numbers = ("How far each model is off", MODELS_HEAD, model_rows(curve))
        yield _Compared(told, told.name, words, *numbers, partial(comparison_figure, curve))
    for people in compared.populations:
        name = f"{people.told.name}: {people.quantity}"
        numbers = ("What each model gives", PEOPLE_HEAD, people_rows(people))
        yield _Compared(
            people.told,
            name,
            [people_words(people)],
            *numbers,
            partial(people_figure, people),
        )
    for detected in compared.detections:
        told = detected.told
        numbers = ("What each rival gives", DETECTION_HEAD, detection_rows(detected))
        figure = partial(detection_figure, detected)
        yield _Compared(told, told.name, detection_words(detected), *numbers, figure)


def _totals(compared: FolderComparison) -> tuple[_Table, _Table]:
    """Caption, head and rows of the models over all curves, and of the points in intervals."""
    held = "Points in the default's intervals"
    return (
        ("All curves", TOTALS_HEAD, total_rows(compared)),
        (held, COVERAGE_HEAD, coverage_rows(compared)),
    )


def show_comparisons(compared: FolderComparison) -> None:
    """Print each curve, the numbers of many people and the totals beside the models."""
    for recording in _recordings(compared):
        heading(recording.name)
        table(recording.head, recording.rows, fixed=(0,))
        printed_bullets([("", words, "") for words in recording.words])
    if len(compared.curves) > 1:
        heading("All curves")
        for _, head, rows in _totals(compared):
            table(head, rows, fixed=(0,))
        printed_bullets([("", covered_words(compared), ""), ("", SCORES, "")])
    say(f"\n{FITTED}")


def write_comparisons(compared: FolderComparison, folder: Path) -> Path:
    """Write curves.json, a picture of each curve and measured-curves.html into `folder`.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    summary = compared.summary()
    summary_stamp = stamp(summary)
    files: dict[str, str | bytes] = {"curves.json": json_text(summary | {"stamp": summary_stamp})}
    body = section("What is compared", f"<p>{FITTED}</p>")
    if len(compared.curves) > 1:
        rows, held = (text_table(*total) for total in _totals(compared))
        body += section("All curves", rows + bullets([covered_words(compared), SCORES]) + held)
    for number, recording in enumerate(_recordings(compared), 1):
        figure = recording.figure()
        files[f"curve-{number}.png"] = style.png(figure)
        said = [*recording.words, *(f"{what}: {how}" for what, how in recording.told.facts)]
        rows = text_table(recording.caption, recording.head, recording.rows)
        body += section(escape(printable(recording.name)), bullets(said) + rows)
        body += picture_sections({f"curve-{number}": (recording.name, figure)})
    files["measured-curves.html"] = page(
        "Measured friction",
        "Measured friction",
        "beside every model, beside fitted shapes, and beside our interval",
        body,
        stamped(summary_stamp, "SHA-256 of curves and answers"),
    )
    return write_folder(folder, files)


def write_friction_docs(compared: FolderComparison, root: Path | None = None) -> Path:
    """Write docs/reference/published-friction.md of a checkout (the package's own, or the one at
    `root`) with its picture.

    Raises `InputError` where the package is installed without one.
    """
    docs = checkout(root) / "docs"
    for detected in compared.detections:
        write_whole(
            docs / "pictures" / "published-thresholds.png",
            style.png(detection_figure(detected)),
        )
    path = docs / "reference" / "published-friction.md"
    write_whole(path, friction_markdown(compared))
    return path


def friction_markdown(compared: FolderComparison) -> str:
    """The text of the page: all curves, each curve, the numbers of many people, and thresholds."""
    lines = [_HEAD, "## All curves", ""]
    totals, held = (markdown_table(total[1:]) for total in _totals(compared))
    lines += [*totals, "", f"{covered_words(compared)}. {SCORES}", "", *held, ""]
    for recording in _recordings(compared):
        how, *rest = recording.words
        lines += [f"## {recording.name.capitalize()}", "", f"{recording.told.source}. {how}.", ""]
        lines += markdown_table((recording.head, recording.rows))
        lines += ["", f"{'; '.join(rest)}.", ""] if rest else [""]
    if compared.detections:
        lines += ["![Measured and computed thresholds](../pictures/published-thresholds.png)", ""]
    return "\n".join(lines)
