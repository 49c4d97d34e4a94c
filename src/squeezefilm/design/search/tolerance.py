"""Share of the plates made that keep the limits, and what each tolerance does to them."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Annotated

import numpy as np
from scipy.stats import norm, qmc

from squeezefilm.core import quantities as si
from squeezefilm.design.search.candidate import (
    Design,
    Evaluated,
    display_of,
    screened,
)
from squeezefilm.design.search.criteria import breaches, criterion_of
from squeezefilm.design.search.requirements import Requirements, Tolerances, toleranced
from squeezefilm.design.search.worth_solving import CORRECTED
from squeezefilm.design.sweep.tasks import NoAnswer, tried
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate
from squeezefilm.physics.plausibility.checks import checked_before
from squeezefilm.physics.uncertainty.parameters import made_with, value_at

log = logging.getLogger(__name__)

DRAWS = 64
_NAMES = tuple(field.name for field in fields(Tolerances))


@dataclass(frozen=True)
class Made:
    """Plates made of one drawing: `draws` in number, the share that keeps the limits (`kept`), how
    often each limit was broken by key, the number that could not be computed (`failed`, which keep
    none), and the interval of each criterion from the 5 % to the 95 % quantile (SI).

    By the screening theory, in proportion to the solved plate as drawn. `effects` are, by tolerance
    and then by objective, by how much one standard deviation more changes the number.
    """

    draws: int
    kept: si.Dimensionless
    broken: Mapping[str, int]
    intervals: Mapping[str, tuple[float, float]]
    effects: Mapping[str, Mapping[str, float]]
    failed: int = 0


def made_of(
    requirements: Requirements, solved: Evaluated, draws: int = DRAWS, seed: int = 1
) -> Made:
    """Plates made of a solved design with the tolerances, drawn by a scrambled Sobol sequence."""
    nominal = _numbers(requirements, solved.design, np.zeros(len(_NAMES)))
    drawn = qmc.Sobol(len(_NAMES), seed=seed).random(draws)
    normal = np.asarray(norm.ppf(np.clip(drawn, 1e-9, 1 - 1e-9)))
    made = [_scaled(_numbers(requirements, solved.design, row), nominal, solved) for row in normal]
    limits, broken, kept = requirements.limits, dict[str, int](), 0
    for numbers in made:
        wrong = breaches(numbers, limits) if numbers else ()
        kept += bool(numbers) and not wrong
        for limit in wrong:
            broken[limit.key] = broken.get(limit.key, 0) + 1
    keys = [key for key in solved.numbers if key in CORRECTED]
    intervals = {}
    for key in keys:
        values = np.array([row.get(key, np.nan) for row in made])
        values = values[np.isfinite(values)]
        if values.size:
            low, high = np.quantile(values, (0.05, 0.95))
            intervals[key] = float(low), float(high)
    effects = _effects(requirements, solved, nominal)
    return Made(draws, kept / draws, broken, intervals, effects, made.count({}))


def _effects(
    requirements: Requirements, solved: Evaluated, nominal: Mapping[str, float]
) -> dict[str, dict[str, float]]:
    """Effects of those tolerances of the file that are not zero, by central differences."""
    effects: dict[str, dict[str, float]] = {}
    for number, name in enumerate(_NAMES):
        if getattr(requirements.tolerances, name) == 0:
            continue
        ends = []
        for sign in (-1.0, 1.0):
            row = np.zeros(len(_NAMES))
            row[number] = sign
            ends.append(_scaled(_numbers(requirements, solved.design, row), nominal, solved))
        if all(ends):
            told = ("resonance_frequency", *requirements.objectives)
            keys = {goal: criterion_of(goal).key for goal in told}
            effects[name] = {
                goal: (ends[1][key] - ends[0][key]) / 2
                for goal, key in keys.items()
                if key in ends[0]
            }
    return effects


def _scaled(
    numbers: Mapping[str, float], nominal: Mapping[str, float], solved: Evaluated
) -> dict[str, float]:
    """Screened numbers of a plate as made, in proportion to the solved plate as drawn."""
    made = {}
    for key, value in numbers.items():
        here, there = nominal.get(key), solved.numbers.get(key)
        in_proportion = here and there is not None and np.isfinite([here, there]).all()
        made[key] = value * there / here if here and there is not None and in_proportion else value
    return made


def _numbers(
    requirements: Requirements, design: Design, deviations: si.FloatArray
) -> dict[str, float]:
    """The screened criteria of a design as made, so many standard deviations off; empty where it
    cannot be."""
    with checked_before():
        numbers = tried(
            lambda: screened(requirements, as_made(requirements, design, deviations), design)
        )
    if isinstance(numbers, NoAnswer):
        if not numbers.lasting:
            log.error("plate %s as made: %s", design.address, numbers.reason)
        return {}
    return numbers


@si.checked_numbers
def as_made(
    requirements: Requirements, design: Design, deviations: Annotated[si.FloatArray, si.AtMost(40)]
) -> Display:
    """The display of a design as it may be made, `deviations` standard deviations off in each of
    the fields of `Tolerances`, in their order.

    All of a plate's ceramics are alike. Raises what the plate raises.
    """
    display, made = display_of(requirements, design), requirements.tolerances
    pairs = zip(_NAMES, deviations, strict=True)
    off = {name: float(by) * getattr(made, name) for name, by in pairs}
    body = display.actuator
    assert isinstance(body, RectangularPlate | DiscPlate), "shapes make no others"
    sheet = replace(
        body.substrate, young_modulus=body.substrate.young_modulus * (1 + off["young_modulus"])
    )
    ceramic = body.ceramic.scaled(
        stiffness=1 + off["ceramic_stiffness"], charge=1 + off["charge_coefficient"]
    )
    quality = body.quality_factor * (1 + off["quality_factor"])
    body = replace(body, substrate=sheet, ceramic=ceramic, quality_factor=quality)
    lengths = {path: value_at(body, path)[0] + off[of] for path, of in toleranced(body).items()}
    return replace(display, actuator=made_with(body, lengths))
