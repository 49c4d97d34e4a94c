"""A search that nothing computed: designs as the search draws them, numbers by a rule of thumb that
this file states, and all that follows from them as the search would say it."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from squeezefilm.core.results import stamp
from squeezefilm.design.search.candidate import Design, Evaluated, Level, design_of
from squeezefilm.design.search.criteria import breaches
from squeezefilm.design.search.found import DesignSearch, FrontMember
from squeezefilm.design.search.limits import Made
from squeezefilm.design.search.requirements import Requirements, load_requirements
from squeezefilm.design.search.shapes import EdgeStrips
from squeezefilm.design.search.worth_solving import learned
from squeezefilm.design.sweep.tradeoffs import front_of

NAME = "biet2008-plate"


@functools.cache
def requirements_of(*, shapes: int = 1, objectives: int = 2) -> Requirements:
    """Those of the preset but for the finest period, after the rule below; with a second shape or a
    third objective."""
    own = load_requirements(NAME)
    limits = replace(own.limits, most_finest_period=0.6e-3)
    own = replace(own, limits=limits, objectives=("relative_friction", "finest_period"))
    strips = own.shapes[0]
    more = (EdgeStrips(strips.sheets, strips.ceramics, 5, 9),) if shapes == 2 else ()
    third = ("mass",) if objectives == 3 else ()
    return replace(own, shapes=(strips, *more), objectives=(*own.objectives, *third))


def made_search(
    *,
    screened: int = 200,
    solved: int = 40,
    shapes: int = 1,
    objectives: int = 2,
    limits: dict[str, float] | None = None,
    stopped: bool = False,
) -> DesignSearch:
    """A search of so many designs; `limits` are others than the preset's."""
    requirements = requirements_of(shapes=shapes, objectives=objectives)
    if limits:
        requirements = replace(requirements, limits=replace(requirements.limits, **limits))
    rng = np.random.default_rng(3)
    before = list({one.design: one for one in _screened(requirements, screened, rng)}.values())
    best = sorted(before, key=lambda one: (not one.is_feasible, one.design.address))
    after = [_evaluated(requirements, one.design, "solved", rng) for one in best[:solved]]
    seen = {one.design: one for one in before}
    return DesignSearch(
        requirements=requirements,
        seed=1,
        screened=tuple(before),
        solved=tuple(after),
        front=_front(requirements, after),
        reference=None if stopped else _reference(requirements),
        corrections=tuple(
            learned(space, seen, [one for one in after if one.design.shape == number])
            for number, space in enumerate(requirements.spaces)
        ),
        computed=len(before) + len(after),
        kept=0,
        seconds=12.0,
        stopped=stopped,
        provenance=stamp(requirements.base, 1) | {"requirements_sha256": "0" * 64},
    )


def _screened(requirements: Requirements, count: int, rng: np.random.Generator) -> list[Evaluated]:
    found = []
    for number in range(count):
        shape = number % len(requirements.spaces)
        space = requirements.spaces[shape]
        shares = {one.name: float(share) for one, share in zip(space, rng.random(20), strict=False)}
        found.append(_evaluated(requirements, design_of(shape, space.at(shares)), "screened", rng))
    return found


def _evaluated(
    requirements: Requirements, design: Design, level: Level, rng: np.random.Generator
) -> Evaluated:
    """More lines and thicker sheets: a higher frequency, less motion, more friction, finer
    gratings; one in fifty cannot be built. A solved plate is a few percent off."""
    if level == "screened" and rng.random() < 0.02:
        return Evaluated(design, level, {}, reason="9 ceramics on 83 mm are too short")
    chosen = design.settings
    off = 1 + (0.05 * rng.standard_normal() if level == "solved" else 0.0)
    lines, sheet = float(chosen["nodal_lines"]), 1e3 * float(chosen["thickness"])
    layer = 1e3 * float(chosen["ceramic_thickness"])
    frequency = 400 * lines * lines * (0.3 + sheet) ** 0.8 / (1 + 0.1 * layer) * off
    motion = 3e-6 * (3e4 / frequency) ** 0.7 / (0.4 + layer) * off
    friction = 1 / (1 + (motion / 1.4e-6) ** 1.5)
    numbers = {
        "relative_friction": friction,
        "finest_period": 0.33e-3 * (1 + 1.2e4 / frequency),
        "resonance_frequency": frequency,
        "squeeze_number": frequency / 2e3,
        "vibration_amplitude": motion,
        "half_wavelength": 0.083 / lines,
        "mass": 0.02 + 0.01 * sheet + 0.008 * layer,
        "total_thickness": 1e-3 * (sheet + layer),
        "deflection": 4e-5 / (sheet + layer) ** 3,
        "stress": 4e6 * motion / 1e-6,
        "cost": 1.0,
        "power": 8.0,
        "temperature_rise": 20 + 9 * motion / 1e-6 * off,
        "field": float(chosen["voltage"]) / (1e-3 * layer),
        "current": 1.0,
    }
    if level == "solved":
        numbers |= {"neighbour": math.inf if lines > 7 else 4.2, "area": 0.9}
    return Evaluated(
        design, level, numbers, breaches(numbers, requirements.limits),
        warnings=("the plate warms",) if level == "solved" else (),
    )  # fmt: skip


def _front(requirements: Requirements, solved: Sequence[Evaluated]) -> tuple[FrontMember, ...]:
    feasible = [one for one in solved if one.is_feasible]
    if not feasible:
        return ()
    rows = np.array([one.objectives(requirements.objectives) for one in feasible])
    kept = sorted(front_of(rows), key=lambda k: tuple(rows[k]))
    return tuple(FrontMember(feasible[k], _made(feasible[k], requirements)) for k in kept)


def _made(one: Evaluated, requirements: Requirements) -> Made:
    ends = {
        key: (0.9 * one.numbers[key], 1.1 * one.numbers[key])
        for key in ("relative_friction", "finest_period", "resonance_frequency")
    }
    effects = {
        "thickness": {"resonance_frequency": 165.0, "relative_friction": 1e-3},
        "charge_coefficient": {"resonance_frequency": 0.0, "relative_friction": -0.022},
    }
    return Made(64, 0.53125, {"temperature_rise": 30}, ends, effects)


def _reference(requirements: Requirements) -> Evaluated:
    numbers = {
        "relative_friction": 0.62, "finest_period": 0.44e-3, "resonance_frequency": 33567.3,
        "squeeze_number": 17.1, "vibration_amplitude": 1.7e-6, "mass": 0.0962,
        "temperature_rise": 73.77, "stress": 15.9e6, "deflection": 4.2e-6, "neighbour": math.inf,
    }  # fmt: skip
    return Evaluated(Design(0, ()), "solved", numbers, breaches(numbers, requirements.limits))
