"""Made-up people of known Weber fractions and exponents, and their answers to whole designs.

They are made without the chain, by the models that the analyses name. Designs, people and truths
were fixed before any coverage was computed.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from scipy.special import ndtr

from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.adaptive.series import adaptive_method, hears_choice
from squeezefilm.study.design.rules import AdaptiveCondition
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.design.trials import Trial, trials
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.analyze import analyze_answers
from squeezefilm.study.tasks.findings import TaskAnalysis

WEBER, WEBER_SPREAD = 0.15, 0.3
EXPONENT, EXPONENT_SPREAD = 0.9, 0.15
LAPSE, BIAS, CRITERION, NOISE = 0.02, 0.03, 1.4, 0.25
D_PRIME = 0.9538725524

DESIGNS = {
    "constant": dataclasses.replace(load_design("friction-jnd"), practice=0, catch=()),
    "adaptive": dataclasses.replace(load_design("period-jnd"), practice=0),
    "same-different": dataclasses.replace(
        load_design("period-same-different"), practice=0, catch=()
    ),
    "same-different, adaptive": dataclasses.replace(
        load_design("period-same-different"),
        practice=0,
        catch=(),
        stimuli=load_design("period-same-different").stimuli[:1],
        adaptive=(AdaptiveCondition("bayes", "bayesian", lowest=0.02, highest=1.0, count=160),),
    ),
    "magnitude": dataclasses.replace(load_design("coarseness-magnitude"), familiarisation=0),
}
EVERY = DESIGNS | {
    name.partition("-")[2]: dataclasses.replace(load_design(name), practice=0)
    for name in (
        "period-direction",
        "period-odd-one-out",
        "period-pairs",
        "period-ranking",
        "period-adjustment",
        "friction-yes-no",
        "friction-detection",
    )
}
_SETTINGS = EVERY["adjustment"]
# Wide enough for the least sensitive, who find surfaces equal that are 30 % apart.
EVERY["adjustment"] = dataclasses.replace(
    _SETTINGS, adaptive=(dataclasses.replace(_SETTINGS.adaptive[0], highest=0.9),)
)
for _name, _lowest, _highest in (
    ("direction", 0.02, 0.9),
    ("odd-one-out", 0.02, 1.5),
    ("yes-no", 0.004, 0.2),
):
    EVERY[f"{_name}, adaptive"] = dataclasses.replace(
        EVERY[_name],
        catch=(),
        adaptive=(
            AdaptiveCondition(
                "bayes",
                "bayesian",
                EVERY[_name].judged,
                lowest=_lowest,
                highest=_highest,
                count=160,
            ),
        ),
    )
EVERY["odd-one-out-of-four"] = dataclasses.replace(
    EVERY["odd-one-out"], task="odd-one-out-of-four", catch=()
)
THRESHOLD = 0.2
"""Threshold of an amount against a flat surface, over the Weber fraction of the same person."""
STRENGTH = 8.0
"""Exponent of strengths in ranks, over that of magnitudes."""


@dataclasses.dataclass(frozen=True)
class Person:
    """What is true of somebody."""

    weber: float
    exponent: float
    bias: float

    def answer(
        self, design: StudyDesign, pair: tuple[Stimulus, ...], random: np.random.Generator
    ) -> str | float:
        """To the surfaces of a trial."""
        if design.answers and random.random() < LAPSE:
            return str(random.choice(design.answers))
        amounts = [design.judged_value(one) for one in pair]
        if design.in_amounts:
            return self.detects(design, amounts, random)
        logs = [math.log(amount) for amount in amounts]
        if design.task == "magnitude-estimation":
            return math.exp(self.exponent * logs[0] + NOISE * random.standard_normal()) * 1e3
        # One percept's deviation, and that of a difference of two.
        own = math.log1p(self.weber) / D_PRIME
        spread = math.sqrt(2) * own
        if design.task == "same-different":
            apart = (logs[0] - logs[1]) / own + math.sqrt(2) * random.standard_normal()
            return "different" if abs(apart) > CRITERION else "same"
        if design.task == "direction":
            more = ndtr((logs[0] - math.log(design.reference_value) + self.bias) / spread)
            return "more" if random.random() < more else "less"
        if design.task.startswith("odd-one-out"):
            felt = np.array(logs) + own * random.standard_normal(len(logs))
            away = [abs(felt[k] - np.delete(felt, k).mean()) for k in range(len(logs))]
            return design.answers[int(np.argmax(away))]
        if design.task == "ranking":
            utility = STRENGTH * self.exponent * np.array(logs) + random.gumbel(size=3)
            return "".join(str(place + 1) for place in np.argsort(-utility))
        if design.task == "adjustment":
            apart = (logs[1] - logs[0] + self.bias) / spread + random.standard_normal()
            return "equal" if abs(apart) < 1 else "less" if apart > 0 else "more"
        more = ndtr((logs[0] - logs[1] + self.bias) / spread)
        return "first" if random.random() < more else "second"

    def detects(
        self, design: StudyDesign, amounts: list[float], random: np.random.Generator
    ) -> str:
        """To one surface, or two of which one is flat."""
        own = THRESHOLD * self.weber / D_PRIME
        if design.task == "yes-no":
            yes = ndtr(amounts[0] / own - 0.5 * CRITERION)
            return "yes" if random.random() < yes else "no"
        first = ndtr((amounts[0] - amounts[1]) / (math.sqrt(2) * own) + self.bias)
        return "first" if random.random() < first else "second"

    def truth(self, name: str) -> float:
        """The number that a design of `EVERY` measures of this person."""
        if EVERY[name].in_amounts:
            return THRESHOLD * self.weber
        return {
            "magnitude": self.exponent,
            "ranking": STRENGTH * self.exponent,
            "adjustment": math.expm1(-self.bias),
        }.get(name, self.weber)


def somebody(random: np.random.Generator) -> Person:
    """Drawn from the population."""
    weber, exponent, bias = random.standard_normal(3)
    return Person(
        WEBER * math.exp(WEBER_SPREAD * weber),
        EXPONENT + EXPONENT_SPREAD * exponent,
        BIAS * bias,
    )


def answered(design: StudyDesign, people: list[Person], random: np.random.Generator) -> Answers:
    """Everybody's answers to every trial of a design."""
    surfaces: list[Stimulus] = [*design.stimuli, *(one.stimulus for one in design.catch)]
    place = {one.name: k for k, one in enumerate(surfaces)}
    rows: list[dict[str, object]] = []
    task = design.described
    for number, person in enumerate(people):
        methods = {one.name: adaptive_method(one, task=design.task) for one in design.adaptive}
        for trial in trials(design, number, 7):
            if not trial.asks:
                continue
            names, intensity = list(trial.stimuli), math.nan
            if trial.adaptive:
                how, key, intensity = (trial.reference_first, trial.answer), "", 0.0
                if task.presents_comparison(*how):
                    intensity = methods[trial.adaptive].next_stimulus()
                    chosen = design.comparison(design.series(trial.adaptive), intensity)
                    key = f"{chosen.name} {intensity!r}"
                if key and key not in place:
                    place[key] = len(surfaces)
                    surfaces.append(chosen)
                names = list(task.arranges(design.reference, key, *how))
            pair = tuple(surfaces[place[name]] for name in names)
            given = person.answer(design, pair, random)
            if trial.adaptive:
                hears = hears_choice(design.series(trial.adaptive), task)
                methods[trial.adaptive].update(intensity, given if hears else given == trial.answer)
            rows.append(_row(design, number, trial, names, place, intensity, given))
    columns = {key: np.array([row[key] for row in rows]).T for key in rows[0]}
    return Answers(
        design=design,
        origin="made up",
        people=tuple(f"p{k}" for k in range(len(people))),
        surfaces=tuple(surfaces),
        **columns,  # type: ignore[arg-type] # by name
    )


def _row(
    design: StudyDesign,
    number: int,
    trial: Trial,
    names: list[str],
    place: dict[str, int],
    intensity: float,
    given: str | float,
) -> dict[str, object]:
    answers = {name: k for k, name in enumerate(design.answers)}
    series = {one.name: k for k, one in enumerate(design.adaptive)}
    return {
        "participant": number,
        "number": trial.number,
        "phase": trial.phase,
        "display": 0,
        "series": series.get(trial.adaptive, -1),
        "presented": [place[name] for name in names],
        "intensity": intensity,
        "choice": answers[given] if isinstance(given, str) else -1,
        "right": answers.get(trial.answer, -1),
        "estimate": math.nan if isinstance(given, str) else given,
        "response_time": 1.0 + number / 10 + trial.number / 1000,
    }


def analysed(name: str, people: list[Person], random: np.random.Generator) -> TaskAnalysis:
    """The analysis of everybody's answers to a design of `EVERY`."""
    design = EVERY[name]
    found = analyze_answers(answered(design, people, random), name)[design.displays[0]]
    assert isinstance(found, TaskAnalysis)
    return found


def coverage(name: str, runs: int, people: int = 8, seed: int = 1) -> dict[str, float]:
    """Shares of 95 % intervals that hold the truth: of persons, of the population's mean and, where
    there is one, its spread; the mean's median length; and the mean error of the population's
    number, in parts of the truth but for an adjustment's; and the share of people whom the
    design's rule names, though all of them do the task."""
    typical = Person(WEBER, EXPONENT, 0.0).truth(name)
    spread = EXPONENT_SPREAD if name == "magnitude" else WEBER_SPREAD
    spread = STRENGTH * EXPONENT_SPREAD if name == "ranking" else spread
    persons, held, spreads, lengths, errors, named = [], [], [], [], [], []
    for run in range(runs):
        random = np.random.default_rng([seed, run])
        group = [somebody(random) for _ in range(people)]
        found = analysed(name, group, random)
        for one in found.persons:
            truth = group[int(one.person.removeprefix("p"))].truth(name)
            persons.append(one.estimate.low <= truth <= one.estimate.high)
        assert found.screening is not None
        named.append(len(found.screening.named))
        assert found.pooled is not None
        held.append(found.pooled.low <= typical <= found.pooled.high)
        if found.spread is not None:
            spreads.append(found.spread.low <= spread <= found.spread.high)
        lengths.append(found.pooled.high - found.pooled.low)
        errors.append((found.pooled.value - typical) / (typical or 1.0))
    return {
        "persons": float(np.mean(persons)),
        "population": float(np.mean(held)),
        "spread": float(np.mean(spreads)) if spreads else math.nan,
        "length": float(np.median(lengths)),
        "error": float(np.mean(errors)),
        "named": float(np.mean(named)) / people,
    }
