"""The verdict in words: what is good, what limits, what to doubt."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.curves import PAPER_CRITERION, FrictionCurve
from squeezefilm.analysis.film.models import FilmComparison
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
    curves: tuple[FrictionCurve, ...],
    table: FidelityTable | None,
    films: FilmComparison | None,
) -> Iterator[Finding]:
    """What an analysis amounts to, in sentences."""
    amplitude = f"{p.vibration_amplitude * 1e6:.3g} µm"
    yield _of_friction(p, amplitude, curves)
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
    if films is not None:
        yield from _of_films(p, films)
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


def _of_friction(p: Prediction, amplitude: str, curves: tuple[FrictionCurve, ...]) -> Finding:
    """How far the friction falls, against the paper's criterion."""
    here = next(c for c in curves if c.surface == p.surface.name and c.model == p.model)
    papers = MODEL_KINDS[p.model].film == "asymptote"
    by = "By the paper's model" if papers else f"By the model '{p.model}'"
    lowered = (
        f"{by} {amplitude} lower the friction to {100 * p.relative_friction:.3g} % of what it is "
        "without vibration"
    )
    if p.relative_friction <= PAPER_CRITERION:
        return Finding("good", f"{lowered}, below the 70 % that the paper asks for.")
    needed = here.amplitude_for_criterion
    ask = "which no amplitude reaches" if needed is None else f"which {needed * 1e6:.3g} µm reach"
    noticed = 1 - p.relative_friction >= NOTICED_DIFFERENCE
    return Finding("limit" if noticed else "doubt", f"{lowered}; the paper asks for 70 %, {ask}.")


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


def _of_films(p: Prediction, films: FilmComparison) -> Iterator[Finding]:
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
        f"{open_.load_share:.1%} of the finger, ridges pressed flat "
        + ("all of it." if plateau.load_share >= 1 else f"{plateau.load_share:.0%} of it.")
        + " Partial levitation, where film and asperities share the load of a "
        "flattened ridge, lies between.",
    )
    if films.balance is not None:
        yield Finding("limit", films.balance.sentence)
    if films.teeth is not None:
        yield Finding("limit", films.teeth.sentence)
