"""Limits of a search: which bind, what each costs, and the share of plates made that keep them."""

from __future__ import annotations

import itertools
import logging
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Annotated

import numpy as np
from scipy.stats import norm, qmc

from squeezefilm.core import quantities as si
from squeezefilm.design.search.candidate import Design, Evaluated, display_of, screened
from squeezefilm.design.search.criteria import CRITERIA, bounded, breaches, criterion_of, excess_of
from squeezefilm.design.search.requirements import Requirements, Tolerances, toleranced
from squeezefilm.design.search.space import Choice, Number, Space, Step
from squeezefilm.design.search.worth_solving import CORRECTED
from squeezefilm.design.sweep.tasks import NoAnswer, tried
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate
from squeezefilm.physics.plausibility.checks import checked_before
from squeezefilm.physics.uncertainty.parameters import made_with, value_at

# Parts of a range of lengths that are told apart, and the designs a part must have to be told of.
_PARTS, _LEAST_DESIGNS = 5, 20


@dataclass(frozen=True)
class LimitReason:
    """Effect of a limit: how many screened designs break it (`broken`), how many nothing but it
    (`alone`), and by objective the best that would be without it (SI)."""

    key: str
    limit: float
    broken: int
    alone: int
    best_without: Mapping[str, float]


@dataclass(frozen=True)
class EmptyCorner:
    """A part of the space without a feasible design: what was chosen there, in words, how many
    were screened, the limit most often broken ("" where they cannot be built), and by what share of
    them, and a sentence of one of them."""

    shape: str
    where: str
    designs: int
    key: str
    share: si.Dimensionless
    example: str


def limit_reasons(
    requirements: Requirements, screened: Sequence[Evaluated]
) -> tuple[LimitReason, ...]:
    """Effect of every limit on the screened designs, the one that is broken most first."""
    reasons = []
    best = _best(requirements, [candidate for candidate in screened if candidate.is_feasible])
    for criterion, bound in bounded(requirements.limits):
        broken = [
            candidate
            for candidate in screened
            if any(b.key == criterion.key for b in candidate.broken)
        ]
        alone = [candidate for candidate in broken if len(candidate.broken) == 1]
        without = _best(requirements, alone)
        gained = {
            key: value
            for key, value in without.items()
            if np.isfinite(value) and value < best.get(key, np.inf)
        }
        reasons.append(LimitReason(criterion.key, bound, len(broken), len(alone), gained))
    return tuple(sorted(reasons, key=lambda reason: -reason.broken))


def _best(requirements: Requirements, designs: Sequence[Evaluated]) -> dict[str, float]:
    rows = [design.objectives(requirements.objectives) for design in designs]
    if not rows:
        return {}
    return dict(zip(requirements.objectives, np.min(rows, axis=0).tolist(), strict=True))


def empty_corners(
    requirements: Requirements, screened: Sequence[Evaluated]
) -> tuple[EmptyCorner, ...]:
    """The parts of each variable's range in which no screened design is feasible, with why."""
    corners: list[EmptyCorner] = []
    for number, space in enumerate(requirements.spaces):
        here = [candidate for candidate in screened if candidate.design.shape == number]
        for variable in space.free:
            parts: dict[str, list[Evaluated]] = {}
            for candidate in here:
                parts.setdefault(_part(variable, candidate.design.settings), []).append(candidate)
            for where, inside in parts.items():
                if len(inside) < _LEAST_DESIGNS or any(design.is_feasible for design in inside):
                    continue
                corners.append(_corner(space, where, inside))
    return tuple(sorted(corners, key=lambda corner: -corner.designs))


def _corner(space: Space, where: str, inside: Sequence[Evaluated]) -> EmptyCorner:
    counts = Counter(key for candidate in inside for key in {b.key for b in candidate.broken})
    built = sum(bool(candidate.reason) for candidate in inside)
    if not counts or built > max(counts.values()):
        example = next(candidate.reason for candidate in inside if candidate.reason)
        return EmptyCorner(space.shape, where, len(inside), "", built / len(inside), example)
    key, count = counts.most_common(1)[0]
    # The one that comes nearest to the limit.
    nearest = min(
        (b for candidate in inside for b in candidate.broken if b.key == key),
        key=lambda limit: limit.excess,
    )
    return EmptyCorner(
        space.shape, where, len(inside), key, count / len(inside), f"at best {nearest.sentence}"
    )


def _part(variable: Number | Step | Choice, settings: Mapping[str, float | int | str]) -> str:
    """The part of a variable's range in which a design lies, in words."""
    name, value = variable.name.replace("_", " "), settings[variable.name]
    if isinstance(variable, Choice):
        return f"{name} {value}"
    if isinstance(variable, Step):
        return f"{name} {si.format_quantity(float(value), variable.unit, 3)}"
    width = (variable.high - variable.low) / _PARTS
    at = min(int((float(value) - variable.low) / width), _PARTS - 1)
    ends = (si.format_quantity(variable.low + k * width, variable.unit, 3) for k in (at, at + 1))
    return f"{name} {' to '.join(ends)}"


def nearest_of(screened: Sequence[Evaluated]) -> Evaluated | None:
    """The design that can be built whose worst breach is the smallest; None where none can be."""
    built = [design for design in screened if not design.reason]
    return min(
        built, key=lambda design: max((b.excess for b in design.broken), default=0.0), default=None
    )


def conflict_of(screened: Sequence[Evaluated]) -> tuple[str, str, si.Dimensionless] | None:
    """The two limits (keys of criteria) that screened designs are farthest from keeping both, and
    by what share of its limit the best of them misses one; None where each pair is kept by one."""
    excess = [
        {b.key: b.excess for b in candidate.broken}
        for candidate in screened
        if not candidate.reason
    ]
    keys = sorted({key for broken in excess for key in broken})
    alone = {key: min(broken.get(key, 0.0) for broken in excess) for key in keys}
    pairs = {
        (first, second): min(max(o.get(first, 0.0), o.get(second, 0.0)) for o in excess)
        for first, second in itertools.combinations(keys, 2)
        if alone[first] == alone[second] == 0
    }
    pair = max(pairs, key=lambda key: pairs[key], default=None)
    return None if pair is None or pairs[pair] <= 0 else (*pair, pairs[pair])


def margins(requirements: Requirements, candidate: Evaluated) -> dict[str, si.Dimensionless]:
    """Distance of a design from each limit that it could be judged by, as a share of it, the
    nearest first."""
    margin_of = {
        criterion.key: -excess_of(criterion, value, bound)
        for criterion, bound in bounded(requirements.limits)
        if not math.isnan(value := criterion.value(candidate.numbers))
    }
    return dict(sorted(margin_of.items(), key=lambda item: item[1]))


def limit_in_words(reason: LimitReason, screened: int) -> str:
    """Sentence on what a limit does."""
    criterion = CRITERIA[reason.key]
    said = (
        f"{criterion.limit_said(reason.limit)}: broken by {reason.broken} of {screened} "
        f"screened designs, by {reason.alone} as the only limit"
    )
    if reason.best_without:
        said += f"; without it {gains_in_words(reason)} would be there"
    return said + "."


def gains_in_words(reason: LimitReason) -> str:
    """The objectives that would be there without a limit."""
    gained = ((criterion_of(name), value) for name, value in reason.best_without.items())
    return " and ".join(
        f"{criterion.said} of {criterion.shown(value)}" for criterion, value in gained
    )


def corner_in_words(corner: EmptyCorner) -> str:
    """A part of the space without a feasible design, in a sentence."""
    of = f"{corner.shape}, {corner.where}: none of {corner.designs} screened designs is feasible"
    if not corner.key:
        return f"{of}; {100 * corner.share:.0f} % cannot be built, for example: {corner.example}"
    said = CRITERIA[corner.key].said
    return f"{of}; {100 * corner.share:.0f} % of them break the limit of {said} ({corner.example})"


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
