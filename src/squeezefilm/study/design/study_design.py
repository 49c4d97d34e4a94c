"""A study's design: its task, what is presented, how often and in which order; from a TOML file.

Each task is a record of `design.tasks`; `design.trials` makes each participant's trials.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import ReadBy
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.hard_limits import PARTICIPANT_TRIALS, require_within
from squeezefilm.core.results import config_hash
from squeezefilm.physics.perception.stimuli import Grating, Stimulus, Varied
from squeezefilm.physics.texture_files.image_file import with_images
from squeezefilm.study.design.rules import (
    AdaptiveCondition,
    CatchTrial,
    ExclusionRule,
    Exploring,
    MatchedWith,
    TrialRules,
    require_amounts,
    require_comparison,
    require_different,
    require_matching,
    require_name,
)
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.task import Condition, StudyTask, Task

Order = Literal["williams", "latin-square", "shuffled"]


@si.checked_numbers
@dataclass(frozen=True)
class StudyDesign:
    """A whole design. Read one with `load_design`.

    Args:
        name, title: what it is called, in files and for people.
        displays: presets or files of displays; every participant does the trials on each, in an
            order balanced over participants.
        task: name of a record of `design.tasks`.
        stimuli: the conditions.
        alternatives: real gratings; for match-to-sample only, where they are the answers.
        matched_with: what match-to-sample offers as answers: the "real gratings", or the "stimuli"
            themselves by name, which people got to know before.
        exploring: "strokes", to and fro along x, or "free" over the whole face.
        reference: name of the stimulus every other is compared with (tasks of several surfaces), or
            of the one that is worth `modulus` (magnitude estimation).
        judged: what two-interval answers are right about, differences are of (same-different,
            odd-one-out), and magnitudes are of.
        modulus: number given to the reference in magnitude estimation (1); 0 for free numbers.
        question: what the participant is asked.
        order: "williams" (each condition follows each other equally often), "latin-square"
            (equally often in each place) or "shuffled".
        familiarisation: rounds in which each alternative (or stimulus) is felt without an answer.
        practice: trials with feedback before the first block of each display.
        blocks: per display.
        repetitions: of every condition, per block.
        catch: trials to see whether people attend, spread at random over the blocks.
        adaptive: series in place of fixed repetitions; stimuli beside the reference are then for
            practice and familiarisation only.
        break_between_blocks: rest (s) before every block but the first.
        rules: of the exploration; a trial outside of them comes again.
        exclusion: who counts as not doing the task, and whether they are left out; they are only
            marked, by the rule's own numbers, without.
        practice_criterion: share of right answers in a round of practice below which there is
            another round (1); 0 for none.
        practice_rounds: of practice, at most.
        resume_within: time (s) after which a block that was left is begun again when somebody goes
            on; 0 for never.
        trial_duration: expected time of one trial (s), for planning.
        note: anything a reader must know, such as what of it is assumed.

    Raises:
        InputError: values outside their range or that do not fit the task.
    """

    name: str
    title: str
    displays: tuple[str, ...]
    task: Task
    stimuli: tuple[Stimulus, ...]
    alternatives: tuple[Grating, ...] = ()
    reference: str = ""
    judged: Varied = "spatial_period"
    modulus: Annotated[si.Dimensionless, si.AtLeast(0.0)] = 0.0
    question: str = ""
    order: Order = "williams"
    familiarisation: Annotated[int, si.AtLeast(0), si.AtMost(20)] = 0
    practice: Annotated[int, si.AtLeast(0), si.AtMost(1000)] = 0
    blocks: Annotated[int, si.AtLeast(1), si.AtMost(100)] = 1
    repetitions: Annotated[int, si.AtLeast(1), si.AtMost(1000)] = 1
    catch: tuple[CatchTrial, ...] = ()
    adaptive: tuple[AdaptiveCondition, ...] = ()
    break_between_blocks: Annotated[si.Second, si.AtLeast(0.0)] = 60.0
    trial_duration: Annotated[si.Second, si.Above(0.0), si.AtMost(3600.0)] = 20.0
    rules: TrialRules | None = None
    exclusion: ExclusionRule | None = None
    practice_criterion: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)] = 0.0
    practice_rounds: Annotated[int, si.AtLeast(1), si.AtMost(20)] = 3
    resume_within: Annotated[si.Second, si.AtLeast(0.0)] = 0.0
    note: str = ""
    matched_with: MatchedWith = "real gratings"
    exploring: Exploring = "strokes"
    provenance: Mapping[str, Provenance] = field(
        default_factory=dict, metadata={"loader": True}, compare=False, repr=False
    )

    def __post_init__(self) -> None:
        require_name(self.name)
        if not self.displays:
            raise InputError("displays is empty; name at least one", quantity="displays")
        require_different("displays", list(self.displays))
        if not self.stimuli:
            raise InputError("stimuli is empty; give at least one", quantity="stimuli")
        presented = [stimulus.name for stimulus in self.stimuli] + [
            trial.stimulus.name for trial in self.catch
        ]
        require_different("stimuli", presented)
        require_different("alternatives", [alternative.name for alternative in self.alternatives])
        require_different("adaptive", [series.name for series in self.adaptive])
        if self.reference and self.reference not in [stimulus.name for stimulus in self.stimuli]:
            known = [stimulus.name for stimulus in self.stimuli]
            raise InputError(
                f"reference = '{self.reference}' is no stimulus."
                f"{si.did_you_mean(self.reference, known)} Stimuli: {', '.join(known)}",
                quantity="reference",
            )
        names = self.answers
        require_matching(
            self.task, self.matched_with, self.exploring, self.stimuli, self.alternatives, names
        )
        amounts = [self.judged_value(stimulus) for stimulus in self.stimuli]
        require_amounts(self.described, self.judged, self.stimuli, amounts, self.reference)
        require_comparison(
            self.described,
            self.reference,
            len(self.stimuli),
            bool(self.adaptive),
            self.practice,
            self.practice_criterion,
            self.modulus,
        )
        for item in self.adaptive:
            self._require_series(item)
        self._require_answers()
        require_within(
            PARTICIPANT_TRIALS,
            self.most_trials,
            enough="give fewer repetitions, blocks, stimuli, series or displays",
        )

    @property
    def described(self) -> StudyTask:
        """The record of the task."""
        return TASKS[self.task]

    @property
    def compares(self) -> bool:
        """True where a trial presents several surfaces, one after the other."""
        return self.described.surfaces > 1

    @property
    def most_trials(self) -> int:
        """Upper bound of the trials that a participant has, without making them."""
        felt = self.familiarisation * max(len(self.stimuli), len(self.alternatives))
        caught = sum(trial.count for trial in self.catch)
        return len(self.displays) * (self.most_main_trials + felt + caught + self.practice)

    @property
    def most_main_trials(self) -> int:
        """Upper bound of the main trials that a participant has on a display."""
        if self.adaptive:
            return sum(series.count for series in self.adaptive)
        return self.blocks * self.repetitions * len(self.conditions)

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """Surfaces of the trials of a repetition, once each, as the task's record says; no more
        than a participant may have trials, and one."""
        here, compared = self.reference, self.described.reference
        names = [one.name for one in self.stimuli if not compared or one.name != here]
        every = self.described.conditions(here, names)
        return tuple(itertools.islice(every, int(PARTICIPANT_TRIALS.most) + 1))

    @property
    def answers(self) -> tuple[str, ...]:
        """The answers a participant may give; empty where any number may be given."""
        if self.task == "match-to-sample":
            return tuple(surface.name for surface in self.alternatives or self.stimuli)
        return self.described.answers

    @property
    def sha256(self) -> str:
        """Hash of every value of the design, whatever their sources are said to be."""
        return config_hash(dataclasses.replace(self, provenance={}))

    @property
    def spoken_question(self) -> str:
        """`question`, or the task's own."""
        if self.question:
            return self.question
        if self.matched_with == "stimuli":
            return "Which of the surfaces was it?"
        return self.described.question(self.judged)

    def stimulus(self, name: str) -> Stimulus:
        """The stimulus of that name, catch trials' too. Raises `InputError` if there is none."""
        every = [*self.stimuli, *(trial.stimulus for trial in self.catch)]
        for stimulus in every:
            if stimulus.name == name:
                return stimulus
        known = [stimulus.name for stimulus in every]
        raise InputError(
            f"design '{self.name}' has no stimulus '{name}'.{si.did_you_mean(name, known)} "
            f"It has: {', '.join(known)}"
        )

    def answer_to(self, *surfaces: Stimulus) -> str:
        """The right answer to a trial's surfaces; an empty text where nothing is.

        For match-to-sample the alternative that the stimulus `matches`, else that of the same
        period (to 1e-9 m), or itself. For two intervals the one with more of what is `judged`.
        """
        first = surfaces[0]
        if self.task == "match-to-sample" and self.matched_with == "stimuli":
            itself = first.name if first.name in self.answers else ""
            return first.matches or itself
        if self.task == "match-to-sample":
            if first.matches or first.waveform == "constant":
                return first.matches
            near = [
                alternative
                for alternative in self.alternatives
                if abs(alternative.period - first.period) < 1e-9
            ]
            return near[0].name if len(near) == 1 else ""
        if len(surfaces) < self.described.surfaces:
            return ""
        return self.described.right(surfaces, self.judged_value)

    def judged_value(self, surface: Stimulus) -> float:
        """Amount (SI) of what is judged that a stimulus has; of a period the whole one."""
        return surface.period if self.judged == "spatial_period" else surface.amount(self.judged)

    @property
    def in_amounts(self) -> bool:
        """True where differences are of amounts: of an orientation, or from a flat surface."""
        return self.described.compares_amounts(self.judged)

    @property
    def measure(self) -> str:
        """Name of what a difference that is just told is called."""
        return "threshold" if self.in_amounts else "Weber fraction"

    @property
    def reference_value(self) -> float:
        """Amount (SI) of what is judged that the reference has; NaN without one."""
        return self.judged_value(self.stimulus(self.reference)) if self.reference else math.nan

    def level(self, surface: Stimulus) -> float:
        """Place of a stimulus on the scale of which differences are taken."""
        value = self.judged_value(surface)
        return value if self.in_amounts else math.log(value)

    @property
    def reference_level(self) -> float:
        """The same of the reference; NaN without one."""
        return self.level(self.stimulus(self.reference)) if self.reference else math.nan

    @property
    def differences(self) -> list[float]:
        """Differences above 0 that the design asks about, of two stimuli without a reference."""
        if self.adaptive:
            ends = [x for series in self.adaptive for x in (series.lowest, series.highest)]
            return ends if self.in_amounts else [math.log1p(end) for end in ends]
        levels = [self.level(stimulus) for stimulus in self.stimuli]
        origins = [self.reference_level] if self.reference else levels
        apart = [abs(level - origin) for level in levels for origin in origins]
        return [difference for difference in apart if difference > 0]

    def catch_condition(self, catch: CatchTrial) -> Condition:
        """Surfaces of a catch trial: its stimulus, in tasks of several surfaces with the
        reference in an order in which its answer is right.

        Raises `InputError` if the answer is right in no order.
        """
        name, here = catch.stimulus.name, self.reference
        if not self.compares:
            return (name,)
        others = [here] if here else [stimulus.name for stimulus in self.stimuli]
        for order in self.described.conditions(name, others):
            if self.answer_to(*(self.stimulus(other) for other in order)) == catch.answer:
                return order
        raise InputError(
            f"the answer '{catch.answer}' of the catch trial '{name}' is never right beside the "
            f"reference '{here}'; change one of them",
            quantity="catch",
        )

    @property
    def on_a_scale(self) -> bool:
        """True where the surfaces have each another amount of what is judged, so that differences
        between them are told along it; those of adaptive series always have."""
        amounts = [self.judged_value(stimulus) for stimulus in self.stimuli]
        distinct = all(map(math.isfinite, amounts)) and len(set(amounts)) == len(amounts)
        return bool(self.adaptive) or distinct

    def series(self, name: str) -> AdaptiveCondition:
        """The adaptive series of that name. Raises `InputError` if there is none."""
        for series in self.adaptive:
            if series.name == name:
                return series
        known = ", ".join(series.name for series in self.adaptive)
        raise InputError(f"'{name}' is none of: {known}", quantity="adaptive_series")

    def comparison(self, series: AdaptiveCondition, intensity: float) -> Stimulus:
        """The stimulus that an adaptive series presents beside the reference at an intensity: more
        of what is varied, by that part of the reference's value; beside a flat one the first other
        stimulus with that much of it. Raises `InputError` if there can't be so much of it."""
        here = self.stimulus(self.reference)
        part = f"{100 * intensity:.3g} %"
        if self.described.reference == "flat":
            [textured, *_] = (one for one in self.stimuli if one.name != self.reference)
            return textured.varied(f"{textured.name} at {part}", series.varied, intensity)
        value = here.amount(series.varied) * (1.0 + intensity)
        return here.varied(f"{here.name} {100 * intensity:+.3g} %", series.varied, value)

    def _require_series(self, series: AdaptiveCondition) -> None:
        methods = self.described.adaptive
        if series.method not in methods:
            raise InputError(
                f"series '{series.name}' is by method = '{series.method}', which would settle "
                f"where a person's criterion has it; {self.task} takes method = '{methods[0]}'",
                quantity="adaptive",
            )
        if series.varied != self.judged:
            raise InputError(
                f"series '{series.name}' varies {series.varied} while {self.judged} is judged; "
                "make them the same, or no answer is right",
                quantity="adaptive",
            )
        is_signed = series.in_runs and self.described.reference != "flat"
        try:
            self.comparison(series, series.highest)
            if is_signed:
                si.require("highest", series.highest, below=1.0)
        except InputError as error:
            raise InputError(
                f"series '{series.name}' cannot go up to highest = {series.highest:g}: {error}",
                quantity="adaptive",
            ) from error

    def _require_answers(self) -> None:
        names = self.answers
        for trial in self.catch:
            if names and trial.answer not in names:
                raise InputError(
                    f"the answer '{trial.answer}' of a catch trial is none of: {', '.join(names)}",
                    quantity="catch",
                )
            self.catch_condition(trial)


def load_design(name_or_path: str | Path) -> StudyDesign:
    """The design of a preset study's name or of a TOML file. Raises `ConfigError` if it can't be.

    Pictures in a stimulus's pattern are read from beside the file; a texture file named in a
    stimulus is looked for from where the program runs.
    """
    from squeezefilm.core import config, presets

    path = presets.resolve(name_or_path, "study")
    design = config.load(StudyDesign, path)
    try:
        stimuli = with_images(design.stimuli, path.parent)
    except InputError as error:
        raise ConfigError(str(error), file=path, key=error.quantity or "file") from error
    return design if stimuli is design.stimuli else dataclasses.replace(design, stimuli=stimuli)


NamedDesign = Annotated[StudyDesign, ReadBy(load_design)]
"""A design, or in its place the name of a preset or the path of a file (see `reads_text`)."""
