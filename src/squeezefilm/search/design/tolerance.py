"""How many of the plates that are made keep the limits, and what each tolerance does to them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Annotated

import numpy as np
from scipy.stats import norm, qmc

from squeezefilm import quantities as si
from squeezefilm.chain.prediction import predict
from squeezefilm.display import Display
from squeezefilm.errors import SqueezefilmError
from squeezefilm.plate.layout import DiscPlate, RectangularPlate
from squeezefilm.search.design.candidate import (
    Design,
    Evaluated,
    display_of,
    judged,
    screening_theory,
)
from squeezefilm.search.design.correction import CORRECTED
from squeezefilm.search.design.criteria import breaches
from squeezefilm.search.design.requirements import Requirements, Tolerances

DRAWS = 64
_NAMES = tuple(one.name for one in fields(Tolerances))


@dataclass(frozen=True)
class Made:
    """Plates made of one drawing: `draws` in number, the share that keeps the limits (`kept`), how
    often each limit was broken by key, and the interval of each criterion from the 5 % to the 95 %
    quantile (SI).

    By the screening theory, in proportion to the solved plate as drawn. `effects` are, by tolerance
    and then by objective, by how much one standard deviation more changes the number.
    """

    draws: int
    kept: si.Dimensionless
    broken: Mapping[str, int]
    intervals: Mapping[str, tuple[float, float]]
    effects: Mapping[str, Mapping[str, float]]


def made_of(
    requirements: Requirements, solved: Evaluated, draws: int = DRAWS, seed: int = 1
) -> Made:
    """Plates made of a solved design with the tolerances, drawn by a scrambled Sobol sequence."""
    nominal = _numbers(requirements, solved.design, np.zeros(len(_NAMES)))
    drawn = qmc.Sobol(len(_NAMES), seed=seed).random(draws)
    normal = np.asarray(norm.ppf(np.clip(drawn, 1e-9, 1 - 1e-9)))
    found = [_scaled(_numbers(requirements, solved.design, row), nominal, solved) for row in normal]
    limits, broken, kept = requirements.limits, dict[str, int](), 0
    for numbers in found:
        wrong = breaches(numbers, limits) if numbers else ()
        kept += bool(numbers) and not wrong
        for one in wrong:
            broken[one.key] = broken.get(one.key, 0) + 1
    keys = [key for key in solved.numbers if key in CORRECTED]
    intervals = {}
    for key in keys:
        values = np.array([one.get(key, np.nan) for one in found])
        values = values[np.isfinite(values)]
        if values.size:
            low, high = np.quantile(values, (0.05, 0.95))
            intervals[key] = float(low), float(high)
    return Made(draws, kept / draws, broken, intervals, _effects(requirements, solved, nominal))


def _effects(
    requirements: Requirements, solved: Evaluated, nominal: Mapping[str, float]
) -> dict[str, dict[str, float]]:
    """By central differences, of what the tolerances of the file are not zero of."""
    found: dict[str, dict[str, float]] = {}
    for number, name in enumerate(_NAMES):
        if getattr(requirements.tolerances, name) == 0:
            continue
        ends = []
        for sign in (-1.0, 1.0):
            row = np.zeros(len(_NAMES))
            row[number] = sign
            ends.append(_scaled(_numbers(requirements, solved.design, row), nominal, solved))
        if all(ends):
            keys = ("resonance_frequency", *requirements.objectives)
            found[name] = {key: (ends[1][key] - ends[0][key]) / 2 for key in keys if key in ends[0]}
    return found


def _scaled(
    numbers: Mapping[str, float], nominal: Mapping[str, float], solved: Evaluated
) -> dict[str, float]:
    """Screened numbers of a plate as made, in proportion to the solved plate as drawn."""
    found = {}
    for key, value in numbers.items():
        here, there = nominal.get(key), solved.numbers.get(key)
        in_proportion = here and there is not None and np.isfinite([here, there]).all()
        found[key] = value * there / here if here and there is not None and in_proportion else value
    return found


def _numbers(
    requirements: Requirements, design: Design, deviations: si.FloatArray
) -> dict[str, float]:
    """The screened criteria of a design as made, so many standard deviations off; empty where it
    cannot be."""
    try:
        display = as_made(requirements, design, deviations)
        found = predict(display, theory=screening_theory(requirements, design))
        return judged(requirements, display, found, design, "screened")
    except SqueezefilmError:
        return {}


@si.checked_numbers
def as_made(
    requirements: Requirements, design: Design, deviations: Annotated[si.FloatArray, si.AtMost(40)]
) -> Display:
    """The display of a design as it may be made, `deviations` standard deviations off in each of
    the fields of `Tolerances`, in their order.

    All of a plate's ceramics are alike. Raises what the plate raises.
    """
    display, made = display_of(requirements, design), requirements.tolerances
    off = {
        name: float(by) * getattr(made, name) for name, by in zip(_NAMES, deviations, strict=True)
    }
    body = display.actuator
    assert isinstance(body, RectangularPlate | DiscPlate), "shapes make no others"
    sheet = replace(
        body.substrate, young_modulus=body.substrate.young_modulus * (1 + off["young_modulus"])
    )
    ceramic = body.ceramic.scaled(
        stiffness=1 + off["ceramic_stiffness"], charge=1 + off["charge_coefficient"]
    )
    common = {
        "substrate": sheet,
        "ceramic": ceramic,
        "thickness": body.thickness + off["thickness"],
        "quality_factor": body.quality_factor * (1 + off["quality_factor"]),
    }
    if isinstance(body, DiscPlate):
        return replace(
            display,
            actuator=replace(
                body, **common, ceramic_thickness=body.ceramic_thickness + off["ceramic_thickness"]
            ),
        )
    return replace(display, actuator=replace(body, **common, **dict(_resized(body, off))))


def _resized(body: RectangularPlate, off: Mapping[str, float]) -> Iterator[tuple[str, object]]:
    """Sides and ceramics of a plate that came out longer: all along its length in proportion."""
    longer = 1 + off["sides"] / body.length
    yield "length", body.length * longer
    yield (
        "patches",
        tuple(
            replace(
                one,
                x=one.x * longer,
                length=one.length * longer,
                thickness=one.thickness + off["ceramic_thickness"],
            )
            for one in body.patches
        ),
    )
    yield (
        "supports",
        tuple(replace(one, x=one.x * longer, length=one.length * longer) for one in body.supports),
    )
