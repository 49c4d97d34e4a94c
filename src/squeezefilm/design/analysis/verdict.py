"""The verdict in words: what is good, what limits, what to doubt."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import source_doubt
from squeezefilm.design.analysis.area_odds import JudgedArea
from squeezefilm.design.analysis.curves import (
    COMPARED,
    PAPER_CRITERION,
    FrictionCurve,
)
from squeezefilm.design.analysis.ears import AUDIBLE, EarExposure
from squeezefilm.design.analysis.felt import GratingsLeft
from squeezefilm.design.plate.listed_modes import mode_doubts, why_undriven
from squeezefilm.physics.chain.active_area import CRITERIA
from squeezefilm.physics.chain.friction import where_known
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL, MODEL_KINDS
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.warming import too_hot
from squeezefilm.physics.uncertainty.model_choices import MECHANISM
from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

# Below this drop of the relative friction a difference is not noticed: Fehlberg 2022 reports about
# 0.2; the paper asks for 0.3.
NOTICED_DIFFERENCE: si.Dimensionless = 0.2

# Published displays reach about 3 µm; three times that is beyond doubt.
PLAUSIBLE_AMPLITUDE: si.Metre = 10e-6


TOO_HOT = "Driven for long, it gets warmer than its ceramic is known for."
Kind = Literal["good", "limit", "doubt"]


@dataclass(frozen=True)
class Finding:
    """A sentence of the verdict: good news, a limit to know, or a reason not to believe; what it is
    `about` where that matters, and in `short` what the first screen says in its place."""

    kind: Kind
    text: str
    about: Literal["", "friction", "gratings", "sources"] = field(default="", compare=False)
    short: str = field(default="", compare=False)


def verdict(
    display: Display,
    p: Prediction,
    area: JudgedArea | None,
    own: FrictionCurve,
    table: GratingsLeft | None,
    unsure: UncertainFriction | None = None,
    why_not: str = "",
) -> Iterator[Finding]:
    """Sentences on what an analysis amounts to: `own` is the curve of the prediction's model on its
    surface, `why_not` says why no friction is `unsure`.

    What the prediction's `objections` say and what speaks against the working mode come first;
    while an objection stands, or where the mode is not driven, nothing is good.
    """
    yield from (Finding("doubt", objection) for objection in p.objections)
    if p.voltage is not None:
        yield from (Finding("doubt", doubt) for doubt in mode_doubts(display, p.mode))
    # Why is said above.
    why = None if why_not_good(display, p) is None else ""

    def found() -> Iterator[Finding]:
        amplitude = f"{p.vibration_amplitude * 1e6:.3g} µm"
        yield from friction_verdict(p, unsure, why_not, area)
        yield from _of_needed_amplitude(p, own)
        yield from _of_ceramics_touched(display)
        if p.vibration_amplitude > PLAUSIBLE_AMPLITUDE:
            yield Finding(
                "doubt",
                f"{amplitude} is more than any bonded plate of this kind is known to do; ceramics "
                "turn nonlinear and bonds fail long before, and nothing here sees that.",
            )
        if p.heat is not None and (hot := too_hot(p.heat)) is not None:
            yield Finding("limit", hot, short=TOO_HOT)
        if table is not None:
            yield _of_gratings(table, p.relative_friction)
        if not MODEL_KINDS[p.model].shares_load:
            yield from (Finding("doubt", check.sentence) for check in p.validity.failed)
        if (doubt := source_doubt(display.provenance)) is not None:
            yield Finding("doubt", doubt, "sources")
        yield Finding(
            "doubt",
            "Friction is by a model fitted to published friction of people on glass, and to "
            "nothing else (squeezefilm reproduce --data published)."
            if p.model == DEFAULT_MODEL
            else f"Published friction of people on glass refutes the model '{p.model}' "
            "(squeezefilm reproduce --data published).",
            "sources",
        )

    yield from (held_back(finding, why) for finding in found())


def as_json(findings: Iterable[Finding]) -> list[dict[str, str]]:
    """Findings as plain JSON values: kind and text."""
    return [{"kind": finding.kind, "text": finding.text} for finding in findings]


def why_not_good(display: Display, p: Prediction) -> str | None:
    """Reason why nothing of a display may be called good: its working mode is not driven, or an
    objection stands, which says so itself (then empty). None where things may be good."""
    undriven = None if p.voltage is None else why_undriven(display, p.mode)
    return undriven or ("" if p.objections else None)


def held_back(finding: Finding, why: str | None) -> Finding:
    """A finding that is a limit in place of good news where there is a `why`, which is added."""
    if why is None or finding.kind != "good":
        return finding
    return replace(finding, kind="limit", text=f"{finding.text} {why}".strip())


def ears_finding(ears: EarExposure | None) -> Finding:
    """Finding on the sound at an ear: good where it is surely below the one for the public, a limit
    where it is surely above or audible, a doubt where that is open or unknown."""
    if ears is None:
        return Finding(
            "doubt",
            "The sound at an ear is not known here: the shape of what moves was not solved, or its "
            "amplitude was given. squeezefilm plate computes it for plates, discs and stators.",
        )
    if ears.frequency < AUDIBLE:
        return Finding("limit", ears.sentence)
    kind: dict[str, Kind] = {"below": "good", "above": "limit"}
    return Finding(kind.get(ears.standing, "doubt"), ears.sentence, short=ears.short)


def friction_verdict(
    p: Prediction,
    unsure: UncertainFriction | None,
    why_not: str,
    area: JudgedArea | None = None,
) -> tuple[Finding, ...]:
    """Findings on how probable it is that the friction falls below the paper's criterion: at the
    place of the prediction, and over the active area where there is one.

    Good where all of the interval lies below it, at the worst place of the active area too; a limit
    where it does not, a doubt where there is no interval (`why_not` says why). The same sentences
    wherever this verdict is shown; `held_back` is for whoever shows it.
    """
    finding = _at_the_place(p, unsure, why_not)
    if area is None:
        return (finding,)
    worst = area.area.worst
    highest = worst if area.odds is None else max(worst or 0.0, area.odds.worst_interval[1])
    everywhere = highest is not None and worst is not None and highest < PAPER_CRITERION
    kind = "limit" if finding.kind == "good" and not everywhere else finding.kind
    over = Finding(kind, f"{area.area.sentence}{_odds(area)}", "friction")
    return replace(finding, kind=kind), over


def _odds(area: JudgedArea) -> str:
    """Sentence on how probable the criterion is over the area."""
    if area.odds is None:
        return ""
    best, median, worst = (probability_words(p) for p in area.odds.probabilities_below(CRITERIA[0]))
    draws = len(area.odds.samples)
    unknown = int(np.sum(np.any(np.isnan(area.odds.samples), axis=1)))
    text = (
        f" When the uncertain inputs vary, it is below {CRITERIA[0]:.2f} with probability {best} "
        f"at the best place, {median} in the median and {worst} at the worst"
    )
    if unknown:
        text += f"; {unknown} of the {draws} draws give no friction there and count as not below it"
    return f"{text}."


def _at_the_place(p: Prediction, unsure: UncertainFriction | None, why_not: str) -> Finding:
    """Finding on the place of the prediction."""
    where = p.place_said
    if p.law.place is None:
        where += f", at {p.vibration_amplitude * 1e6:.3g} µm"
    elif abs(p.law.place.at_centre - 1) > 0.005:
        told_of = p.law.place.antinode_said
        amplitude = f"{p.vibration_amplitude * 1e6:.3g} µm"
        where += f" ({amplitude} at {told_of}, where amplitudes are given elsewhere)"
    asked = f"{PAPER_CRITERION:.2f}, as the paper asks"
    if unsure is None:
        because = why_not or "no interval was computed"
        return Finding(
            "doubt",
            f"µ′/µ is {p.relative_friction:.2f} as described {where} by the "
            f"model '{p.model}'. How probable it is that it lies below {asked}, is not known: "
            f"{because}.",
            "friction",
            f"No interval of the friction: {because}.",
        )
    low, high = unsure.interval
    noticed = 1 - NOTICED_DIFFERENCE
    text = (
        f"µ′/µ is {unsure.nominal:.2f} as described {where}. When the uncertain inputs and "
        f"models vary, its median is {unsure.median:.2f} ({si.percent(unsure.level)} "
        f"interval {low:.2f}–{high:.2f}); it is below {asked}, with probability "
        f"{probability_words(unsure.probability_below(PAPER_CRITERION))}, and below {noticed:.2f}, "
        "where people notice it, with probability "
        f"{probability_words(unsure.probability_below(noticed))}."
    )
    if high < PAPER_CRITERION:
        return Finding("good", text, "friction")
    if low <= PAPER_CRITERION:
        text += " The criterion lies inside the interval: whether it is met is open."
    return Finding("limit", text, "friction")


def probability_words(value: si.Dimensionless) -> str:
    """Probability in two digits; never 0 or 1, which so few draws cannot say."""
    return "above 0.99" if value > 0.99 else "below 0.01" if value < 0.01 else f"{value:.2f}"


def _of_needed_amplitude(p: Prediction, own: FrictionCurve) -> Iterator[Finding]:
    """Findings on what the criterion takes where the display as described misses it."""
    papers = not MODEL_KINDS[p.model].shares_load
    by = "By the paper's model" if papers else f"By the model '{p.model}'"
    if papers or p.relative_friction > PAPER_CRITERION:
        needed = own.amplitude_for_criterion
        ask = "no amplitude" if needed is None else f"{needed * 1e6:.3g} µm"
        yield Finding(
            "limit",
            f"{by} µ′/µ is {p.relative_friction:.2f} as described; {ask} would bring it to "
            f"{PAPER_CRITERION:.2f}.",
            "friction",
        )


def _of_ceramics_touched(display: Display) -> Iterator[Finding]:
    """Findings on ceramics that lie on the face that is touched."""
    plate = display.actuator
    if not isinstance(plate, RectangularPlate) or not (share := plate.coverage_of("top")):
        return
    yield Finding(
        "limit",
        f"Ceramics lie on {si.percent(share)} of the face that is touched. The friction is "
        "computed as if the surface went on over them: their steps and their material are left "
        "out.",
    )


def rival_frictions(p: Prediction) -> dict[str, si.Dimensionless]:
    """µ′/µ where a prediction was made by each compared model but its own, without those that
    refuse its amplitude."""
    frictions = {}
    for model, _ in COMPARED:
        if model != p.model:
            (friction,) = where_known(p.law.by(model).curve, np.array([p.vibration_amplitude]))
            if np.isfinite(friction):
                frictions[str(model)] = float(friction)
    return frictions


def model_form(
    unsure: UncertainFriction, rivals: Mapping[str, si.Dimensionless], frequency: si.Hertz
) -> Finding:
    """Finding on what an interval of the friction has varied and what it has not: how much of it is
    laws that nobody knows and which friction model holds, and how far rival models lie apart beside
    its width."""
    low, high = unsure.interval
    values = sum(not hasattr(influence.parameter, "options") for influence in unsure.influences)
    laws = len(unsure.influences) - values
    unknown = [group for group in unsure.groups if group.knowledge == "unknown"]
    part = f" ({si.percent(unknown[0].total)} of its variance)" if unknown else ""
    drawn = [influence for influence in unsure.influences if influence.parameter.path == MECHANISM]
    among = f", among them the friction model ({si.percent(drawn[0].total)})," if drawn else ""
    text = (
        f"The interval varies {values} inputs and {laws} laws{part}{among} by stated or assumed "
        f"ranges and weights, not the frequency "
        f"({si.format_quantity(frequency, si.Unit('Hz'))})"
    )
    if not rivals:
        return Finding("doubt", f"{text}.")
    least, most = min(rivals, key=rivals.__getitem__), max(rivals, key=rivals.__getitem__)
    apart = max(unsure.nominal, rivals[most]) - min(unsure.nominal, rivals[least])
    than = "more than" if apart > high - low else "no more than"
    return Finding(
        "doubt",
        f"{text}: rival models give {rivals[least]:.2f} ('{least}') to {rivals[most]:.2f} "
        f"('{most}'); together with this model they span {apart:.2f}, {than} the interval "
        f"({high - low:.2f}).",
    )


def _of_gratings(table: GratingsLeft, relative_friction: si.Dimensionless) -> Finding:
    """Finding on which square gratings survive, and how fast the finger may be on the worst; good
    only where the friction swings by as much as people notice."""
    noticed = 1 - relative_friction >= NOTICED_DIFFERENCE
    unfelt = (
        ""
        if noticed
        else f" None is good for that: the friction swings by {si.percent(1 - relative_friction)} "
        f"only, and people notice about {si.percent(NOTICED_DIFFERENCE)}."
    )
    fastest = table.fastest_speed
    worst = int(np.argmin(fastest))
    kept = [
        f"{1e3 * period:g}"
        for period, speed in zip(table.spatial_periods, fastest, strict=True)
        if speed >= table.speeds[-1]
    ]
    return Finding(
        "good" if kept and noticed else "limit",
        f"Square gratings of {', '.join(kept) or 'no listed'} mm keep 90 % of their swing, peak to "
        f"peak, up to {1e3 * table.speeds[-1]:g} mm/s; {1e3 * table.spatial_periods[worst]:g} mm "
        f"up to {1e3 * fastest[worst]:.0f} mm/s. Of the fundamental "
        f"{100 * table.fundamental:.0f} % are left there.{unfelt}",
        "gratings",
    )
