"""Screen of what decides: the same rows in the terminal and at the top of the page."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import HZ, KELVIN, A, M, Row, V, W, shown, signed, span
from squeezefilm.design.analysis.curves import PAPER_CRITERION
from squeezefilm.design.analysis.verdict import NOTICED_DIFFERENCE, probability_words
from squeezefilm.design.plate.listed_modes import why_undriven
from squeezefilm.physics.display import DECAY_LENGTH
from squeezefilm.physics.uncertainty.parameters import parameter_name

if TYPE_CHECKING:
    from squeezefilm.design.analysis.analysis import Analysis

MOST_DOUBTS = 3
HEAD = ("Quantity", "Value", "90 % interval")
"""Heads of the numbers."""
# A computed number that lies so far from the measured one is doubted.
_OFF = 0.2
# Displays of the paper, whose own criterion is theirs.
_PAPER = "biet2008-"


class FirstScreen(NamedTuple):
    """A sentence on the criterion, at most six numbers with their intervals (label, value,
    interval), at most three things that could make them wrong, and the next step."""

    sentence: str
    numbers: list[Row]
    doubts: list[str]
    next_step: str


def first_screen(analysis: Analysis) -> FirstScreen:
    """The few things to decide from, of an analysis."""
    doubts = [statement for statement, _ in _doubts(analysis)]
    return FirstScreen(_sentence(analysis), _numbers(analysis), doubts, _next_step(analysis))


def doubted(analysis: Analysis) -> set[str]:
    """Texts of the findings that stand on the first screen, in short."""
    return {text for _, text in _doubts(analysis)}


def criterion(analysis: Analysis) -> tuple[si.Dimensionless, str]:
    """The µ′/µ to fall below, and whose it is: the one asked for, the paper's for its own displays,
    or else where people notice a difference."""
    if analysis.wanted is not None:
        return analysis.wanted.relative_friction, "which was asked for"
    if analysis.display.name.startswith(_PAPER):
        return PAPER_CRITERION, "as Biet (2008) asks"
    return 1 - NOTICED_DIFFERENCE, "where people notice it"


def _sentence(analysis: Analysis) -> str:
    """Sentence on how probable it is that the criterion is met."""
    unsure, area, volts = analysis.uncertainty, analysis.active_area, analysis.prediction.voltage
    below, whose = criterion(analysis)
    if unsure is None:
        return f"How probable it is that µ′/µ falls below {below:.2f}, {whose}, is not known."
    text = (
        f"{'Friction' if volts is None else f'At {shown(volts, V)} friction'} falls below "
        f"{below:.2f} of that without vibration, {whose}, with probability "
        f"{probability_words(unsure.probability_below(below))}"
    )
    if area is None or area.odds is None:
        return f"{text}."
    worst = probability_words(area.odds.probabilities_below(below)[-1])
    return f"{text} at the best place and {worst} at the worst."


def _numbers(analysis: Analysis) -> list[Row]:
    """The numbers with their intervals."""
    p, unsure, area = analysis.prediction, analysis.uncertainty, analysis.active_area
    known = {item.quantity: item for item in analysis.measured}
    frequency = known.get("Resonance frequency")
    measured = "" if frequency is None else f"measured {shown(frequency.measured, HZ)}"
    swing = None if unsure is None else unsure.amplitude_interval
    friction = "" if unsure is None else span(*unsure.interval)
    rows = [
        ("Resonance frequency", shown(p.mode.resonance_frequency, HZ), measured),
        ("Peak amplitude, finger on", shown(p.vibration_amplitude, M, 3), _between(swing, M)),
        ("Relative friction µ′/µ", f"{p.relative_friction:.2f}", friction),
    ]
    if area is not None and area.area.worst is not None:
        within = "" if area.odds is None else span(*area.odds.worst_interval)
        rows.append(("µ′/µ, worst place", f"{area.area.worst:.2f}", within))
    load = analysis.drive_electronics
    if unsure is not None and unsure.power is not None:
        rows.append(("Power taken", shown(unsure.power, W, 3), _between(unsure.power_interval, W)))
    elif load is not None:
        rows.append(("Current", shown(load.current, A, 3), ""))
    if p.voltage and p.heat is not None:
        rise = signed(p.heat.tracked.temperature_rise, KELVIN)
        ends = _between(p.heat.rise_range, KELVIN)
        rows.append(("Temperature rise", rise, f"emissivity: {ends}" if ends else ""))
    return rows


def _between(ends: tuple[float, float] | None, unit: si.Unit) -> str:
    """An interval with its unit said once, where both ends have the same."""
    if ends is None:
        return ""
    low, high = (shown(end, unit, 3) for end in ends)
    number, _, symbol = low.partition(" ")
    return f"{number}–{high}" if high.endswith(f" {symbol}") else f"{low} to {high}"


def _doubts(analysis: Analysis) -> list[tuple[str, str]]:
    """Doubts about the numbers, the worst first: in short, and the finding's own text."""
    far = [
        (
            f"{beside.quantity}: computed {si.percent(abs(beside.difference))} "
            f"{'above' if beside.difference > 0 else 'below'} the measured "
            f"{shown(beside.measured, si.Unit(beside.unit), 3)}.",
            "",
        )
        for beside in analysis.measured
        if abs(beside.difference) > _OFF
    ]
    findings = [
        finding
        for finding in analysis.findings
        if finding.kind == "doubt"
        or (finding.kind == "limit" and finding.about not in ("friction", "gratings"))
    ]
    # What reaches an ear comes last in the verdict, and is more than a remark on sources.
    findings.sort(key=lambda finding: finding.about == "sources")
    said = [(finding.short or first_statement(finding.text), finding.text) for finding in findings]
    return [*far, *said][:MOST_DOUBTS]


def _next_step(analysis: Analysis) -> str:
    """Sentence on what to do next."""
    unsure, p = analysis.uncertainty, analysis.prediction
    undriven = p.voltage is not None and why_undriven(analysis.display, p.mode) is not None
    if undriven or p.vibration_amplitude == 0:
        return "Give it a voltage and a mode that it drives (squeezefilm modes lists them)."
    if unsure is None:
        return "Ask for an interval of the friction, by 16 samples."
    for influence in unsure.influences:
        if influence.parameter.knowledge == "measurable":
            path, share = influence.parameter.path, si.percent(max(influence.total, 0.0))
            what = f"the {parameter_name(path)} ({path})"
            if path == DECAY_LENGTH:
                what = "friction over amplitude under your finger (--finger FILE)"
            return f"Measure {what}: {share} of the variance of µ′/µ."
    return "Nothing that can be measured would make the friction surer."


def first_statement(text: str) -> str:
    """A text up to the end of its first statement."""
    return f"{re.split(r'(?<=[.!?]) (?=[A-Z])|; |: | [(](?![0-9])', text)[0].rstrip('.')}."
