"""Rules of a design: catch trials, series, what comes again, who is left out, what tasks demand."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.stimuli import Grating, Stimulus, Varied
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.task import StudyTask

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,79}")
_LEAST_RANGE = 2.0
"""Least ratio of a Bayesian series' highest difference to its lowest."""


@si.checked_numbers
@dataclass(frozen=True)
class CatchTrial:
    """A trial whose answer is plain to everyone who attends, and how often it comes.

    `answer` is what is right. In a task of two surfaces `stimulus` comes with the reference.
    """

    stimulus: Stimulus
    answer: str
    count: Annotated[int, si.AtLeast(1), si.AtMost(1000)] = 1


@si.checked_numbers
@dataclass(frozen=True)
class AdaptiveCondition:
    """A series of trials in which a method chooses each comparison after the last answer.

    Args:
        name: of the series.
        method: "staircase" or "bayesian"; "limits" (runs from either end until the answer changes)
            or "adjustment" (somebody asks for more or less until it is equal).
        varied: what of the design's reference is changed; what the design's `judged` asks about.
        start: of a staircase: first difference from the reference, in parts of the reference's
            value (1).
        lowest, highest: differences allowed, likewise (1); runs that are not of a flat reference go
            as far below it as above.
        step: in parts of the reference's value (1); a staircase halves it at the first reversals.
        down: correct answers in a row that make a staircase harder.
        count: trials; of same-different half present the reference twice, in random order.
    """

    name: str
    method: Literal["staircase", "bayesian", "limits", "adjustment"]
    varied: Varied = "spatial_period"
    start: si.Dimensionless = 0.4
    lowest: Annotated[si.Dimensionless, si.Above(0.0)] = 0.005
    highest: Annotated[si.Dimensionless, si.Above("lowest"), si.AtMost(100.0)] = 0.9
    step: si.Dimensionless = 0.1
    down: Annotated[int, si.AtLeast(1), si.AtMost(10)] = 2
    count: Annotated[int, si.AtLeast(1), si.AtMost(10000)] = 60

    @property
    def in_runs(self) -> bool:
        """True of runs whose next level follows from what was answered, right or wrong."""
        return self.method in ("limits", "adjustment")

    def __post_init__(self) -> None:
        require_name(self.name)
        if self.in_runs:
            si.require("step", self.step, above=0.0)
        if self.method == "staircase":
            si.require("start", self.start, at_least=self.lowest, at_most=self.highest)
            si.require("step", self.step, above=0.0, at_most=self.highest)
        if self.method == "staircase" and self.highest - self.lowest < self.step / 4:
            raise InputError(
                f"series '{self.name}' cannot move: from lowest = {self.lowest:g} to highest = "
                f"{self.highest:g} there is less than its smallest step, {self.step / 4:g}; take a "
                "smaller step or a wider range",
                quantity="step",
            )
        if self.in_runs and not 3 * self.step <= self.highest - self.lowest:
            raise InputError(
                f"series '{self.name}' has no room: from highest = {self.highest:g} to lowest = "
                f"{self.lowest:g} there are fewer than three steps of {self.step:g}; take smaller "
                "steps or a wider range",
                quantity="step",
            )
        if self.method == "bayesian" and self.highest < _LEAST_RANGE * self.lowest:
            raise InputError(
                f"series '{self.name}' cannot move: its highest difference, {self.highest:g}, is "
                f"less than {_LEAST_RANGE:g} times its lowest, {self.lowest:g}, and all of its "
                "forty choices are alike; take a wider range",
                quantity="highest",
            )


def require_name(name: str) -> None:
    """Refuse a name that cannot go into a file's name. Raises `InputError`."""
    if not _NAME.fullmatch(name):
        raise InputError(
            f"name = {name!r} cannot be used: it goes into file names; write up to 80 of the "
            "letters A-Z a-z, digits, dot, dash and underscore, beginning with a letter or digit",
            quantity="name",
        )


def require_different(what: str, names: list[str]) -> None:
    """Refuse a name that is there twice. Raises `InputError`."""
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(
            f"{what} have a name twice ({', '.join(twice)}); name each differently", quantity=what
        )


_Speed = Annotated[si.MetrePerSecond, si.AtLeast(0.0), si.AtMost(10.0)]
_Force = Annotated[si.Newton, si.AtLeast(0.0), si.AtMost(50.0)]


@si.checked_numbers
@dataclass(frozen=True)
class TrialRules:
    """Limits of an exploration; None for no rule.

    A trial outside of them keeps its answer in the file, set aside, and is asked again at the end
    of its block; an adaptive series asks it again at the same level. What a device does not know
    (most know no force) is not judged.

    Args:
        slowest, fastest: mean speed (m/s).
        lightest, hardest: mean normal force (N).
        shortest_way: path of the finger (m): less is no movement.
        least_touch: share of the time in which the finger touched (1): less is a lifted finger.

    Raises:
        InputError: a value outside its range, or limits in the wrong order.
    """

    slowest: _Speed | None = None
    fastest: Annotated[_Speed, si.Above("slowest")] | None = None
    lightest: _Force | None = None
    hardest: Annotated[_Force, si.Above("lightest")] | None = None
    shortest_way: Annotated[si.Metre, si.AtLeast(0.0), si.AtMost(10.0)] | None = None
    least_touch: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)] | None = None

    def broken(
        self,
        way: si.Metre,
        speed: si.MetrePerSecond,
        force: si.Newton,
        touch: si.Dimensionless,
    ) -> str:
        """The rule that an exploration breaks, in a participant's words; empty for none.

        NaN is what is not known. No movement is said first: speed follows from it.
        """
        for value, limit, wrong, said, unit in (
            (way, self.shortest_way, operator.lt, "the finger hardly moved", "m"),
            (touch, self.least_touch, operator.lt, "the finger was lifted", "1"),
            (speed, self.slowest, operator.lt, "the finger moved too slowly", "m/s"),
            (speed, self.fastest, operator.gt, "the finger moved too fast", "m/s"),
            (force, self.lightest, operator.lt, "the finger pressed too lightly", "N"),
            (force, self.hardest, operator.gt, "the finger pressed too hard", "N"),
        ):
            if limit is not None and not math.isnan(value) and wrong(value, limit):
                one, other = (si.format_quantity(v, si.Unit(unit), 3) for v in (value, limit))
                end = "least" if wrong is operator.lt else "most"
                return f"{said} ({one}; at {end} {other})"
        return ""


_Share = Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)]
_Chance = Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(0.5)]


@si.checked_numbers
@dataclass(frozen=True)
class ExclusionRule:
    """Limits beyond which somebody counts as not doing the task.

    `identification.screening` applies them.

    It is part of the design and of its hash: whoever changes it after the answers has another
    design. Results are shown with and without the people whom it names, whatever `action` says.

    Args:
        action: "exclude" leaves them out of the results that are quoted; "mark" only names them.
        chance: probability at which somebody who guesses may pass as doing the task, or seem to
            mix up the answers (1).
        one_answer: share of one answer at which somebody only gives that one (1).
        turned: how many times likelier the answers must be, as a power of e, if the person guessed
            or mixed them up in a part of the session, than if nothing changed (1).
        lapses: lapse rate that somebody surely exceeds, with 95 % (1).
        catch: probability of so many missed catch trials from somebody who attends (1).
        fastest: response time below which nobody can have felt anything (s); 0 for no rule.
        fast: share of the answers below `fastest` that is allowed (1).
        complete: least share of the trials, of what the design or whoever has most answered (1).
    """

    action: Literal["mark", "exclude"] = "mark"
    chance: _Chance = 0.001
    one_answer: _Share = 0.9
    turned: Annotated[si.Dimensionless, si.AtLeast(0.0)] = 6.0
    lapses: _Share = 0.2
    catch: _Chance = 0.01
    fastest: Annotated[si.Second, si.AtLeast(0.0), si.AtMost(60.0)] = 0.15
    fast: _Share = 0.1
    complete: _Share = 0.75


MatchedWith = Literal["real gratings", "stimuli"]
"""Answers that match-to-sample offers."""
Exploring = Literal["strokes", "free"]
"""Ways to explore: to and fro along x, or over the whole face."""


def require_matching(
    task: str,
    matched_with: MatchedWith,
    exploring: Exploring,
    stimuli: Sequence[Stimulus],
    alternatives: Sequence[Grating],
    names: Sequence[str],
) -> None:
    """Refuse answers that do not fit the task, or the way in which they are explored; `names` are
    those that may be given. Raises `InputError` that says what fits."""
    matching, among = task == "match-to-sample", matched_with == "stimuli"
    if among and (not matching or alternatives or len(stimuli) < 2):
        raise InputError(
            'matched_with = "stimuli" is for match-to-sample among two or more stimuli without '
            f"[[alternatives]]; here are {len(stimuli)} stimuli and {len(alternatives)} "
            f"alternatives in a study of {task}",
            quantity="matched_with",
        )
    if matching and not among and len(alternatives) < 2:
        raise InputError(
            "match-to-sample needs two or more [[alternatives]], the real gratings; there are "
            f"{len(alternatives)}. Where the answers are the stimuli themselves, say matched_with "
            '= "stimuli"',
            quantity="alternatives",
        )
    if not matching and alternatives:
        raise InputError(
            f"task = '{task}' has no alternatives; remove them or take match-to-sample",
            quantity="alternatives",
        )
    if alternatives and exploring == "free":
        raise InputError(
            'real gratings are explored by strokes along x; for exploring = "free" take '
            'matched_with = "stimuli"',
            quantity="exploring",
        )
    for stimulus in stimuli:
        if stimulus.matches and stimulus.matches not in names:
            raise InputError(
                f"stimulus '{stimulus.name}' matches '{stimulus.matches}', which is no "
                f"alternative.{si.did_you_mean(stimulus.matches, names)} "
                f"Alternatives: {', '.join(names)}",
                quantity="stimuli",
            )


def require_amounts(
    task: StudyTask,
    judged: Varied,
    stimuli: Sequence[Stimulus],
    amounts: Sequence[float],
    reference: str,
) -> None:
    """Refuse a task that compares amounts where a surface has none of what is judged (NaN): a
    shape has no period; and a reference that is not flat where one is detected against it."""
    flat = task.reference == "flat"
    of_reference = dict(zip((one.name for one in stimuli), amounts, strict=True)).get(reference)
    if flat and (judged != "friction_depth" or of_reference != 0.0):
        raise InputError(
            f"task = '{task.name}' detects a surface against a flat one: say judged = "
            '"friction_depth", and name a stimulus with waveform = "constant" as the reference',
            quantity="reference",
        )
    if task.name in ("match-to-sample", "same-different"):
        return
    if task.ranks and any(map(math.isnan, amounts)):
        return
    for stimulus, amount in zip(stimuli, amounts, strict=True):
        if (
            task.ordered
            and task.surfaces > 1
            and stimulus.name != reference
            and amount == of_reference
        ):
            raise InputError(
                f"stimulus '{stimulus.name}' has the same {judged} as the reference: no answer "
                "would be right; change it, or `judged`",
                quantity="stimuli",
            )
        takes_logarithms = (task.ranks or task.model) and not task.compares_amounts(judged)
        if math.isnan(amount) or (amount <= 0 and takes_logarithms):
            raise InputError(
                f"stimulus '{stimulus.name}' ({stimulus.kind}) has no {judged}, which "
                f'{task.name} asks about; judge another, like judged = "friction_depth", or take '
                "same-different or match-to-sample",
                quantity="judged",
            )


def require_comparison(
    task: StudyTask,
    reference: str,
    stimuli: int,
    is_adaptive: bool,
    practice: int,
    practice_criterion: si.Dimensionless,
    modulus: si.Dimensionless,
) -> None:
    """Refuse a task without what it compares with, and numbers that it does not take."""
    if task.reference and not reference:
        raise InputError(
            f"task = '{task.name}' compares with a reference; name one of the stimuli",
            quantity="reference",
        )
    if task.ranks and stimuli < 3:
        raise InputError(
            f"task = '{task.name}' compares all surfaces with each other; give three or more "
            f"[[stimuli]], there are {stimuli}",
            quantity="stimuli",
        )
    if task.reference and stimuli < 2 and not is_adaptive:
        raise InputError(
            "only the reference is there; add a stimulus to compare with it, or [[adaptive]]",
            quantity="stimuli",
        )
    if task.name == "adjustment" and not is_adaptive:
        raise InputError(
            'an adjustment is a series of steps: give [[adaptive]] with method = "adjustment", its '
            "highest difference, step and count",
            quantity="adaptive",
        )
    if is_adaptive and not task.adaptive:
        taking = ", ".join(name for name, other in TASKS.items() if other.adaptive)
        raise InputError(
            f"adaptive series compare with a reference, in task = {taking}; '{task.name}' does not",
            quantity="adaptive",
        )
    if task.reference and practice and stimuli < 2:
        raise InputError(
            "practice needs a stimulus to compare with the reference; add one (adaptive "
            "series use it for practice only), or practice = 0",
            quantity="practice",
        )
    if practice_criterion and (not practice or task.name == "magnitude-estimation"):
        raise InputError(
            f"practice_criterion = {practice_criterion:g} needs practice with right "
            "answers; give practice = 8 or so, or leave it out (numbers are never right)",
            quantity="practice_criterion",
        )
    if modulus and (task.name != "magnitude-estimation" or not reference):
        raise InputError(
            "a modulus needs magnitude-estimation and a reference that it is given to",
            quantity="modulus",
        )
