"""Output of `reproduce` about the prototype: the paper's frequencies and amplitudes beside ours,
what could explain the difference, and which measurement would tell the explanations apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import changed
from squeezefilm.validation.explanations import (
    AMPLITUDE_ACCURACY,
    DRIVE_VOLTAGE,
    HARMONIC_AMPLITUDE,
    HARMONIC_FREQUENCY,
    MEASURED_AMPLITUDE,
    MEASURED_FREQUENCY,
    MEASUREMENTS,
    MODAL_FREQUENCY,
    OPEN_ACCURACY,
    RATIO_ACCURACY,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.validation.explanations import Explanation, PrototypeStudy

_TOLD_APART = 2.0
Table = tuple[tuple[str, ...], Sequence[tuple[str, ...]]]
Item = str | tuple[str, Sequence[str]]
"""A member of a list, or one with a list of its own."""
Block = str | list[Item] | Table | Callable[[], "Figure"]
"""A paragraph, a list, a table, or what draws a figure, which HTML has."""


class Part(NamedTuple):
    """A part of the page of validation, in Markdown and in HTML: a heading and what is under it."""

    heading: str
    blocks: Sequence[Block]
    level: int = 2


def comparison(study: PrototypeStudy) -> Table:
    """The paper's numbers beside the solved plate's, head and rows."""
    ours, printed = study.from_d31, study.printed_e31
    assert ours.largest_per_volt is not None
    assert printed.largest_per_volt is not None
    d31, e31 = (DRIVE_VOLTAGE * p for p in (ours.largest_per_volt, printed.largest_per_volt))
    rows: list[tuple[str, ...]] = [
        (name, f"{value / 1e3:.4g} kHz", *(_kilohertz(p.frequency, value) for p in (ours, printed)))
        for name, value in (
            ("modal analysis, section 3.1.3", MODAL_FREQUENCY),
            ("harmonic analysis, section 3.1.3", HARMONIC_FREQUENCY),
            ("measured, section 3.2.1", MEASURED_FREQUENCY),
        )
    ]
    rows += [
        (name, f"{value * 1e6:.3g} µm", *(_micrometres(w, value) for w in (d31, e31)))
        for name, value in (
            ("amplitude of the harmonic analysis", HARMONIC_AMPLITUDE),
            ("amplitude measured (half of p-p)", MEASURED_AMPLITUDE),
        )
    ]
    rows.append(
        (
            "frequency with open terminals",
            "–",
            *(
                f"{p.open_frequency / 1e3:.2f} kHz ({changed(p.open_frequency / p.frequency - 1)})"
                for p in (ours, printed)
            ),
        )
    )
    return ("at 15 V, Q 60", "paper", "solved with d31", "solved with the printed e31"), rows


def explanation_table(study: PrototypeStudy) -> Table:
    """Parameter sets that all give the measured frequency, and what else they predict."""
    rows = [
        (
            explanation.name,
            f"{explanation.free}: {explanation.value}",
            f"{explanation.frequency / 1e3:.2f} kHz",
            *(f"{ratio:.4f}" for ratio in explanation.neighbour_ratios),
            changed(explanation.open_shift),
            f"{explanation.amplitude * 1e6:.2f} µm (Q {explanation.quality_factor:.0f})",
            f"{explanation.quality_factor_for_measured:.0f}",
        )
        for explanation in study.explanations
    ]
    head = (
        "explanation",
        "solved for",
        "(8,0)",
        *MEASUREMENTS[:3],
        "open shift",
        "amplitude at 15 V",
        "Q for 1.15 µm",
    )
    return head, rows


def separation_table(study: PrototypeStudy) -> Table:
    """The distance of each two explanations, in units of what could be measured."""
    rows = []
    for separation in study.separations:
        told = [
            m
            for m, a in zip(separation.measurements, separation.apart, strict=True)
            if a > _TOLD_APART
        ]
        rows.append(
            (
                f"{separation.first} / {separation.second}",
                *(f"{apart:.1f}" for apart in separation.apart),
                ", ".join(told) or "none of these",
            )
        )
    return ("pair", *MEASUREMENTS, "told apart by"), rows


def sentences(study: PrototypeStudy) -> list[Item]:
    """The conclusions in words; every number computed."""
    ours = study.from_d31
    missing = MEASURED_FREQUENCY / ours.frequency - 1
    frequencies = len(MEASUREMENTS) - 2
    same = [
        s for s in study.separations if max(s.apart[:frequencies]) <= _TOLD_APART
    ]  # told apart by no neighbouring mode
    open_only = [s for s in same if s.apart[frequencies] > _TOLD_APART]
    never = [s for s in study.separations if max(s.apart) <= _TOLD_APART]
    amplitudes = [explanation.amplitude_for_q_60 * 1e6 for explanation in study.explanations]
    worst = max(
        abs(explanation.frequency / MEASURED_FREQUENCY - 1) for explanation in study.explanations
    )
    return [
        f"The prototype lies {changed(missing)} from the perfectly bonded plate with d31.",
        f"{len(study.explanations)} different sets of parameters give 30.5 kHz within "
        f"{100 * worst:.2f} %: one frequency cannot identify the cause.",
        f"Assumed to be measurable: ratios of frequencies to {100 * RATIO_ACCURACY:.1f} %, the "
        f"open-circuit shift to {OPEN_ACCURACY * 100:.1f} percentage points, an amplitude at known "
        f"Q to {100 * AMPLITUDE_ACCURACY:.0f} %; {_TOLD_APART:g} times as much tells two "
        "explanations apart.",
        f"Of {len(study.separations)} pairs {len(study.separations) - len(same)} are told apart by "
        f"the frequencies of neighbouring modes ({', '.join(MEASUREMENTS[:frequencies])}), "
        f"{len(open_only)} more by the open-circuit shift, {len(never)} by none of these"
        + (": " + "; ".join(f"{s.first} / {s.second}" for s in never) if never else "")
        + ".",
        f"For a Q of 60 the explanations predict {min(amplitudes):.2f} to {max(amplitudes):.2f} "
        "µm at 15 V; the measured 1.15 µm helps only when Q is measured too, since any of them "
        "gives it with the Q in the last column.",
        "The heavier plate and the plate softer alike go beyond what copper-beryllium has; they "
        "stand for mass added and stiffness lost from any cause.",
        "Modes with an odd number of nodal lines, (7,0) and (9,0), do not answer the symmetric "
        "drive: drive one half of the ceramics, or one ceramic, to find them.",
    ]


def prototype_parts(study: PrototypeStudy) -> list[Part]:
    """The comparison, and what would identify the cause."""
    apart = "Distance of each pair, in units of what could be measured:"
    return [
        Part("The plate: the paper, the solved plate, the prototype", [comparison(study)]),
        Part(
            "What one frequency cannot tell",
            [
                sentences(study),
                partial(identifiability, study),
                explanation_table(study),
                apart,
                separation_table(study),
            ],
            level=3,
        ),
    ]


@style.drawn
def identifiability(study: PrototypeStudy) -> Figure:
    """Draw what each explanation of 30.5 kHz predicts for every further measurement."""
    figure = style.new_figure(
        f"{len(study.explanations)} explanations of 30.5 kHz, and what would tell them apart",
        "piezoelectric_solid_3d, each explanation solved for its free parameter; bars are what a "
        "measurement could resolve: explanations whose bars overlap are not told apart by it",
        4.4,
    )
    panels = figure.subplots(1, len(MEASUREMENTS), sharey=True)
    at = np.arange(len(study.explanations))[::-1]
    for number, axes in enumerate(panels):
        values, errors, label = _panel(study.explanations, number)
        for y, value, error, explanation in zip(
            at, values, errors, study.explanations, strict=True
        ):
            color = style.ORANGE if "e31" in explanation.name else style.BLUE
            axes.errorbar(value, y, xerr=error, fmt="o", ms=5, lw=2.2, capsize=3, color=color)
        axes.set_xlabel(label)
        axes.set_ylim(-0.6, at.size - 0.4)
        axes.locator_params(axis="x", nbins=3)
        axes.margins(x=0.15)
        if number:
            axes.tick_params(left=False)
    panels[-1].axvline(MEASURED_AMPLITUDE * 1e6, **style.LANDMARK)
    panels[-1].annotate(
        "measured,\nQ unknown",
        (MEASURED_AMPLITUDE * 1e6, 0.2),
        (3, 0),
        xycoords=("data", "axes fraction"),
        textcoords="offset points",
        va="top",
        fontsize=8,
        color=style.MUTED,
    )
    panels[0].set_yticks(
        at,
        [
            f"{explanation.name}\n{explanation.free}: {explanation.value}"
            for explanation in study.explanations
        ],
        fontsize=8.5,
    )
    return figure


def _panel(
    explanations: Sequence[Explanation], number: int
) -> tuple[list[float], list[float], str]:
    ratios = len(MEASUREMENTS) - 2
    if number < ratios:
        values = [explanation.neighbour_ratios[number] for explanation in explanations]
        return values, [v * RATIO_ACCURACY for v in values], MEASUREMENTS[number]
    if number == ratios:
        values = [100 * explanation.open_shift for explanation in explanations]
        return values, [100 * OPEN_ACCURACY] * len(values), "open shift (%)"
    values = [1e6 * explanation.amplitude_for_q_60 for explanation in explanations]
    return values, [v * AMPLITUDE_ACCURACY for v in values], "15 V, Q 60 (µm)"


def _kilohertz(value: float, paper: float) -> str:
    return f"{value / 1e3:.2f} kHz ({changed(value / paper - 1)})"


def _micrometres(value: float, paper: float) -> str:
    return f"{value * 1e6:.2f} µm ({changed(value / paper - 1, 0)})"
