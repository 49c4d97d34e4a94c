"""The verdict in words: what is good, what limits, what to doubt."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.curves import PAPER_CRITERION, FrictionCurve
from squeezefilm.analysis.film.models import FilmComparison
from squeezefilm.analysis.uncertainty import UncertainFriction
from squeezefilm.chain.friction_models import MODEL_KINDS
from squeezefilm.chain.prediction import Prediction
from squeezefilm.display import Display
from squeezefilm.render.fidelity.survival import FidelityTable

# Below this drop of the relative friction a difference is not noticed: Fehlberg 2022 reports about
# 0.2; the paper asks for 0.3.
NOTICED_DIFFERENCE: si.Dimensionless = 0.2

# Published displays reach about 3 µm; three times that is beyond doubt.
PLAUSIBLE_AMPLITUDE: si.Metre = 10e-6


@dataclass(frozen=True)
class Finding:
    """One sentence of the verdict: good news, a limit to know, or a reason not to believe."""

    kind: Literal["good", "limit", "doubt"]
    text: str


def verdict(
    display: Display,
    p: Prediction,
    own: FrictionCurve,
    table: FidelityTable | None,
    unsure: UncertainFriction | None = None,
    why_not: str = "",
) -> Iterator[Finding]:
    """What an analysis amounts to, in sentences: `own` is the curve of the prediction's model on
    its surface, `why_not` says why no friction is `unsure`."""
    amplitude = f"{p.vibration_amplitude * 1e6:.3g} µm"
    yield friction_verdict(p, unsure, why_not)
    yield from _of_needed_amplitude(p, own)
    if p.vibration_amplitude > PLAUSIBLE_AMPLITUDE:
        yield Finding(
            "doubt",
            f"{amplitude} is more than any bonded plate of this kind is known to do; ceramics "
            "turn nonlinear and bonds fail long before, and nothing here sees that.",
        )
    if table is not None:
        yield _of_gratings(table)
    if MODEL_KINDS[p.model].film == "asymptote":
        yield from (Finding("doubt", check.sentence) for check in p.validity.failed)
    assumed = [path for path, item in display.provenance.items() if item.evidence == "assumed"]
    if assumed:
        yield Finding(
            "doubt",
            f"{len(assumed)} of {len(display.provenance)} sourced values of this display are "
            f"assumed, not measured or published: squeezefilm show {display.name} lists them.",
        )
    yield Finding(
        "doubt",
        "Friction against amplitude is not validated against measurements: no measured curve "
        "of an ultrasonic display could be read anywhere.",
    )


def friction_verdict(p: Prediction, unsure: UncertainFriction | None, why_not: str) -> Finding:
    """How probable it is that the friction falls below the paper's criterion.

    Good where all of the interval lies below it, a limit where it does not, a doubt where there is
    no interval (`why_not` says why). The same sentence wherever this verdict is shown.
    """
    amplitude = f"{p.vibration_amplitude * 1e6:.3g} µm"
    asked = f"{PAPER_CRITERION:.2f}, as the paper asks"
    if unsure is None:
        because = why_not or "no interval was computed"
        return Finding(
            "doubt",
            f"µ′/µ is {p.relative_friction:.2f} as described at {amplitude} by the model "
            f"'{p.model}'. How probable it is that it lies below {asked}, is not known: {because}.",
        )
    low, high = unsure.interval
    noticed = 1 - NOTICED_DIFFERENCE
    text = (
        f"µ′/µ is below {asked}, with probability "
        f"{_probability(unsure.probability_below(PAPER_CRITERION))} "
        f"({si.percent(unsure.level)} interval {low:.2f}–{high:.2f}, median {unsure.median:.2f}; "
        f"{unsure.nominal:.2f} as described at {amplitude}); "
        f"below {noticed:.2f}, where people notice it, with probability "
        f"{_probability(unsure.probability_below(noticed))}."
    )
    if high < PAPER_CRITERION:
        return Finding("good", text)
    if low <= PAPER_CRITERION:
        text += " The criterion lies inside the interval: whether it is met is open."
    return Finding("limit", text)


def _probability(value: si.Dimensionless) -> str:
    """In two digits; never 0 or 1, which so few draws cannot say."""
    return "above 0.99" if value > 0.99 else "below 0.01" if value < 0.01 else f"{value:.2f}"


def _of_needed_amplitude(p: Prediction, own: FrictionCurve) -> Iterator[Finding]:
    """What the paper's criterion takes where the display as described misses it."""
    papers = MODEL_KINDS[p.model].film == "asymptote"
    by = "By the paper's model" if papers else f"By the model '{p.model}'"
    if papers or p.relative_friction > PAPER_CRITERION:
        needed = own.amplitude_for_criterion
        ask = "no amplitude" if needed is None else f"{needed * 1e6:.3g} µm"
        yield Finding(
            "limit",
            f"{by} µ′/µ is {p.relative_friction:.2f} as described; {ask} would bring it to "
            f"{PAPER_CRITERION:.2f}.",
        )


def _of_gratings(table: FidelityTable) -> Finding:
    """Which square gratings survive, and how fast the finger may be on the worst."""
    fastest = table.fastest_speed
    worst = int(np.argmin(fastest))
    kept = [
        f"{1e3 * period:g}"
        for period, survives in zip(
            table.spatial_periods, table.amplitude_survives[:, -1], strict=True
        )
        if survives
    ]
    return Finding(
        "good" if kept else "limit",
        f"Square gratings of {', '.join(kept) or 'no listed'} mm keep 90 % of their swing, peak to "
        f"peak, up to {1e3 * table.speeds[-1]:g} mm/s; {1e3 * table.spatial_periods[worst]:g} mm "
        f"up to {1e3 * fastest[worst]:.0f} mm/s. Of the fundamental "
        f"{100 * table.fundamental_at_limit:.0f} % are left there.",
    )


def film_findings(p: Prediction, films: FilmComparison) -> Iterator[Finding]:
    """What the readings of the film say of one another; no verdict on the display, whose friction
    one of them gives."""
    paper, sealed = films.result("paper2008"), films.result("film-sealed")
    open_, plateau = films.result("film-open"), films.result("film-plateau")
    if sealed.over_pressure > 0 and open_.over_pressure > 0:
        yield Finding(
            "doubt",
            f"The paper's asymptote promises {paper.over_pressure / sealed.over_pressure:.3g} "
            f"times the over-pressure of the solved film with sealed grooves (squeeze number "
            f"{p.squeeze_number:.3g}), and {paper.over_pressure / open_.over_pressure:.3g} "
            f"times that with grooves open at the edge of the contact.",
        )
    yield Finding(
        "doubt",
        f"How ridges are drawn decides: sinusoidal ridges with open grooves carry "
        f"{si.percent(open_.load_share, 1)} of the finger, ridges pressed flat "
        + ("all of it." if plateau.load_share >= 1 else f"{si.percent(plateau.load_share)} of it.")
        + " Partial levitation, where film and asperities share the load of a "
        "flattened ridge, lies between.",
    )
    if films.balance is not None:
        yield Finding("limit", films.balance.sentence)
    if films.teeth is not None:
        yield Finding("limit", films.teeth.sentence)
