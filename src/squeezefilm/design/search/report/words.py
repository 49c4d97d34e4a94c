"""A design search in words and rows, for terminal and page alike."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import changed, shown, signed
from squeezefilm.design.search.candidate import Design, Evaluated
from squeezefilm.design.search.criteria import CRITERIA, OF_SOLVED, bounded, criterion_of
from squeezefilm.design.search.found import DesignSearch, FrontMember
from squeezefilm.design.search.limits import (
    conflict_of,
    gains_in_words,
    limit_in_words,
    margins,
    nearest_of,
)
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.design.search.space import Choice, Variable
from squeezefilm.design.search.stock import OWN, PlateRoom

ALWAYS = ("resonance_frequency", "vibration_amplitude", "temperature_rise")
"""Criteria told of every plate beside its objectives."""
_LEAST = 0.001  # smaller changes of a friction are said to be so
_TOLERANCES = {
    "thickness": "thickness of the sheet",
    "ceramic_thickness": "thickness of the ceramics",
    "sides": "sides or diameter",
    "young_modulus": "Young's modulus of the sheet",
    "ceramic_stiffness": "stiffness of the ceramic",
    "charge_coefficient": "charge coefficient of the ceramic",
    "quality_factor": "quality factor of the assembly",
}
_LENGTHS = ("thickness", "ceramic_thickness", "sides")


def setting_words(variable: Variable, design: Design, requirements: Requirements) -> str:
    """Words for what a design has for a variable; of a material "as described" those of the display
    that the search starts from."""
    value = design.settings[variable.name]
    if isinstance(variable, Choice):
        if value != OWN:
            return str(value)
        return f"{getattr(requirements.own, variable.name).name} ({OWN})"
    if variable.unit.symbol == "1":
        number = float(value)
        return f"{number:g}" if number > 1 or number == int(number) else si.percent(number)
    return shown(float(value), variable.unit, 4)


def chosen_words(requirements: Requirements, design: Design) -> str:
    """Line of what was chosen of a plate; the shape before it where there are several."""
    said = ", ".join(_chosen(requirements, design))
    if len(requirements.spaces) == 1:
        return said
    return f"{requirements.spaces[design.shape].shape}: {said}"


def _chosen(requirements: Requirements, design: Design) -> Iterator[str]:
    space = requirements.spaces[design.shape]
    said = {variable.name: setting_words(variable, design, requirements) for variable in space}
    fixed = {variable.name for variable in space if variable.is_fixed}
    yield f"{said.pop('thickness')} of {said.pop('substrate')}"
    yield f"{said.pop('ceramic_thickness')} of {said.pop('ceramic')}"
    for name, text in said.items():
        if name.startswith("nodal_"):
            yield f"{text} {name.replace('_', ' ')}"
        elif name == "cover":
            if name not in fixed:
                yield f"ceramics cover {text}"
        else:
            yield f"{name.replace('_', ' ')} {text}"


def _sides(sides: tuple[si.Metre, si.Metre]) -> str:
    return " × ".join(shown(side, si.Unit("m")) for side in sides)


def _size(room: PlateRoom) -> str:
    """Sides that a plate may have."""
    least, most = _sides(room.least), _sides(room.most)
    return least if least == most else f"at least {least} and at most {most}"


def asked_sentences(requirements: Requirements) -> list[str]:
    """Sentences on what was asked for: finger, workspace, drive, objectives, limits, shapes."""
    touch, drive = requirements.touch, requirements.drive
    space = requirements.workspace
    finger = requirements.base.finger
    surface = requirements.base.surfaces[0].name
    rooms = (requirements.room_of(shape) for shape in requirements.shapes)
    sizes = " or ".join(dict.fromkeys(_size(room) for room in rooms))
    volts = shown(drive.voltage, si.Unit("V"))
    if drive.least_voltage not in (None, drive.voltage):
        volts = f"{shown(float(drive.least_voltage or 0), si.Unit('V'))} to {volts}"
    goals = " and ".join(criterion_of(objective).said for objective in requirements.objectives)
    bounds = [criterion.limit_said(bound) for criterion, bound in bounded(requirements.limits)]
    if requirements.limits.least_yield is not None:
        bounds.append(f"yield at least {si.percent(requirements.limits.least_yield)}")
    shapes = ", ".join(space.shape for space in requirements.spaces)
    return [
        f"A finger at {shown(touch.speed, si.Unit('m/s'))} with "
        f"{shown(finger.normal_force, si.Unit('N'))} on '{surface}', whose centre "
        f"explores {_sides((space.length, space.width))}; a plate of {sizes}, driven with {volts}.",
        f"As small as possible: {goals}.",
        f"Limits: {'; '.join(bounds) if bounds else 'none'}.",
        f"Shapes: {shapes}. Where a material is '{OWN}', it is that of {requirements.start_from}.",
    ]


def counts_sentence(search: DesignSearch) -> str:
    """Sentence on how many designs were looked at, and what is left of them."""
    screened, several = len(search.screened), len(search.solved) > search.plates_solved
    feasible = sum(candidate.is_feasible for candidate in search.screened)
    failed = sum(bool(candidate.reason) for candidate in search.screened)
    return (
        f"{many(screened, 'design')} screened, of which {feasible} keep all limits"
        + (f" and {failed} cannot be built or computed" if failed else "")
        + f"; {many(search.plates_solved, 'plate')} solved in three dimensions"
        + (", each judged at several voltages" if several else "")
        + f", of which {search.plates_feasible} keep them; "
        + (
            f"{front_words(search)} that none other beats: the front."
            if search.front
            else "the front is empty."
        )
    )


def empty_front_sentences(search: DesignSearch) -> list[str]:
    """Sentences on what stands in the way where no plate meets the requirements: the two limits
    that conflict, and the nearest plate; none where there is a front."""
    if search.front:
        return []
    said = []
    bounds = {
        criterion.key: criterion.limit_said(bound)
        for criterion, bound in bounded(search.requirements.limits)
    }
    if (conflict := conflict_of(search.screened)) is not None:
        first, second, miss = conflict
        said.append(
            f"Two limits conflict: {bounds[first]}, and {bounds[second]}. Screened designs keep "
            f"each, and none both; the best misses one by {si.percent(miss, 1)} of it."
        )
    if (nearest := nearest_of(search.screened)) is not None and nearest.broken:
        breaks = "; ".join(breach.sentence for breach in nearest.broken)
        said.append(
            f"The nearest that was screened: {chosen_words(search.requirements, nearest.design)}. "
            f"Of it {breaks}."
        )
    return said


def front_words(search: DesignSearch) -> str:
    """Words for how many plates the front has, and at how many voltages where these are more."""
    plates = many(search.plates_on_front, "plate")
    count = len(search.front)
    return plates if count == search.plates_on_front else f"{plates}, at {count} voltages in all,"


def many(count: int, word: str) -> str:
    """A count of things, in the plural unless there is one."""
    return f"{count} {word}{'' if count == 1 else 's'}"


def front_head(requirements: Requirements) -> list[str]:
    """The headings of `front_row`, without the name."""
    return [*(CRITERIA[key].said for key in _told(requirements)), "yield"]


def _told(requirements: Requirements) -> list[str]:
    """The keys of the criteria of a front's table."""
    keys = [criterion_of(objective).key for objective in requirements.objectives]
    return [*keys, *(key for key in ALWAYS if key not in keys)]


def front_row(requirements: Requirements, member: FrontMember) -> list[str]:
    """Objectives, frequency, amplitude, temperature and yield of a plate of the front."""
    values = row_of(requirements, member.evaluated)
    return [*values, "not known" if member.made is None else si.percent(member.made.kept)]


def row_of(requirements: Requirements, candidate: Evaluated) -> list[str]:
    """The criteria of a front's table, of any evaluated design."""
    return [CRITERIA[key].shown(candidate.numbers.get(key)) for key in _told(requirements)]


def chosen_sentences(search: DesignSearch) -> list[str]:
    """Sentences on which plate is chosen, why, what it is made of, which limits are nearest, how
    many of those made keep them."""
    chosen = search.chosen
    if chosen is None:
        return []
    goals = [criterion_of(objective) for objective in search.requirements.objectives]
    has = " and ".join(
        f"{goal.said} {goal.shown(chosen.evaluated.numbers.get(goal.key))}" for goal in goals
    )
    best = " and ".join(
        goal.shown(float(search.objectives[:, k].min())) for k, goal in enumerate(goals)
    )
    said = [
        f"{chosen.name} has {has}. Of the front it is nearest to the best of every objective "
        f"({best}), each measured from the front's best to its worst."
        if len(search.front) > 1
        else f"{chosen.name} has {has}. It is the only plate of the front.",
        f"It is made of {chosen_words(search.requirements, chosen.evaluated.design)}.",
    ]
    near = list(margins(search.requirements, chosen.evaluated).items())[:2]
    if near:
        told = " and ".join(f"{CRITERIA[key].said} ({margin_words(by)})" for key, by in near)
        said.append(f"Its nearest limits: {told}.")
    return [*said, *made_sentences(search.requirements, chosen)]


def margin_words(margin: float) -> str:
    """Words for how far a number stays from its limit, as a share of the limit."""
    if math.isinf(margin) or math.isnan(margin):
        return "far from it"
    return f"{si.percent(margin, 1)} of it left" if margin >= 0 else f"{changed(-margin)} beyond it"


def made_sentences(requirements: Requirements, member: FrontMember) -> list[str]:
    """Sentences on how many plates made of a drawing keep the limits, and what they break."""
    made = member.made
    if made is None:
        return ["How many plates made of its drawing keep the limits was not computed."]
    breaks = sorted(made.broken.items(), key=lambda item: -item[1])
    told = ", ".join(f"{CRITERIA[key].said} in {count}" for key, count in breaks)
    failed = f"; {made.failed} could not be computed" if made.failed else ""
    alone = requirements.limits.unasked_of_made
    unasked = " and ".join(
        criterion.said
        for criterion, _ in bounded(requirements.limits)
        if criterion.limit in alone or criterion.key == "surest_friction"
    )
    return [
        f"Of {made.draws} plates made with the tolerances {si.percent(made.kept)} keep all limits"
        + (f" but those on {unasked}, which only a solved plate can be asked" if unasked else "")
        + (f"; limits broken: {told}" if told else "")
        + f"{failed}."
    ]


def effect_table(
    requirements: Requirements, member: FrontMember
) -> tuple[list[str], list[tuple[str, ...]]]:
    """Headings and rows of what one standard deviation more of each tolerance does: the tolerance
    and its size, without a heading, then the changes of frequency and objectives."""
    keys = tuple(dict.fromkeys(("resonance_frequency", *requirements.objectives)))
    rows = []
    for name, effects in ({} if member.made is None else member.made.effects).items():
        by = getattr(requirements.tolerances, name)
        size = shown(by, si.Unit("m")) if name in _LENGTHS else si.percent(by, 1)
        changes = (_effect(key, effects.get(key)) for key in keys)
        rows.append((f"{_TOLERANCES[name]} +{size}", *changes))
    return [criterion_of(key).said for key in keys], rows


def _effect(objective: str, value: float | None) -> str:
    if value is None or not math.isfinite(value):
        return "not known"
    if value == 0:
        return "none"
    criterion = criterion_of(objective)
    if criterion.unit.symbol == "1" and abs(value) < _LEAST:
        return f"less than {_LEAST:g}"
    return signed(value, criterion.unit, 2)


def reference_sentences(search: DesignSearch) -> list[str]:
    """Sentences on what the display to compare with left on the table, or why none can be said."""
    reference, requirements = search.reference, search.requirements
    if not requirements.compare_with:
        return []
    name = requirements.compare_with
    if reference is None:
        return [f"{name} was not judged: the search was stopped before."]
    if reference.reason:
        return [f"{name} could not be judged: {reference.reason}"]
    own = reference.objectives(requirements.objectives)
    goals = [criterion_of(objective) for objective in requirements.objectives]
    has = " and ".join(
        f"{goal.said} {goal.shown(value)}" for goal, value in zip(goals, own, strict=True)
    )
    said = [f"Judged in the same way, {name} has {has}."]
    said += [f"It breaks a limit: {limit.sentence}." for limit in reference.broken]
    if not reference.broken:
        said.append("It keeps every limit that could be asked of it.")
    if not search.front:
        return [*said, "No plate was found to set beside it."]
    said += [_left(search, k, own) for k in range(len(goals))]
    better = search.plates_better
    said.append(
        f"Of {many(search.plates_on_front, 'plate')} of the front {better} beat it: better in an "
        "objective and worse in none."
        if better
        else "No plate of the front is better than it in an objective and worse in none."
    )
    return said


def _left(search: DesignSearch, k: int, own: tuple[float, ...]) -> str:
    """Words for how much better one objective can be where no other is worse."""
    goals = [criterion_of(objective) for objective in search.requirements.objectives]
    others = [j for j in range(len(goals)) if j != k]
    rows = search.objectives
    as_good = np.flatnonzero(np.all(rows[:, others] <= np.array(own)[others], axis=1))
    beside = " and ".join(goals[j].said for j in others)
    now = goals[k].shown(own[k])
    if as_good.size:
        best = as_good[np.argmin(rows[as_good, k])]
        if rows[best, k] < own[k]:
            text = goals[k].shown(float(rows[best, k]))
            return (
                f"With {beside} no worse, {goals[k].said} can be {text} in place of {now} "
                f"({search.front[best].name})."
            )
    return f"With {beside} no worse, no plate was found whose {goals[k].said} is below {now}."


def rank_sentences(search: DesignSearch) -> list[str]:
    """Sentences on how well the screening ranked what was then solved."""
    said = [
        f"Screening and solving rank the solved plates by {criterion_of(name).said} with "
        f"Spearman's ρ = {value:.2f}."
        for name, value in search.ranks.items()
    ]
    return said or ["Too few plates were solved to say how good the screening was."]


def limit_sentences(search: DesignSearch) -> list[str]:
    """Sentences on what each limit does to the screened designs; those that none breaks in one
    sentence, those that none was asked in another."""
    count = len(search.screened)
    said = [limit_in_words(limit, count) for limit in search.limits if limit.broken]
    idle = [limit for limit in search.limits if not limit.broken]
    for head, those in (
        ("No screened design breaks", [reason for reason in idle if reason.key not in OF_SOLVED]),
        ("Asked of solved plates only", [reason for reason in idle if reason.key in OF_SOLVED]),
    ):
        if those:
            said.append(f"{head}: {'; '.join(CRITERIA[o.key].limit_said(o.limit) for o in those)}.")
    return said or ["No limit was asked for."]


def limit_gain(search: DesignSearch) -> str:
    """The limit without which the objectives could be better, in a sentence; "" for none."""
    for limit in search.limits:
        if limit.best_without:
            return (
                f"The limit on {CRITERIA[limit.key].said} costs: without it there would be "
                f"{gains_in_words(limit)} (screened, not solved)."
            )
    return ""
