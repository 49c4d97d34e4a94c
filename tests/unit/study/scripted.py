"""A scripted examiner and device, and small studies to run them on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.conduct.run import Acknowledgement, Presentation, StudyRun
from squeezefilm.study.conduct.sessions import Exposure, SessionConditions, begin_session
from squeezefilm.study.conduct.study_device import (
    DeviceIdentity,
    DeviceVerification,
    NoDevice,
    StudyDevice,
    TrialMotion,
)
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.design.rules import AdaptiveCondition
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.simulated.participants import right_answers

LOUD = Exposure("biet2008-plate", 33e3, 0.5, 124.0, 1200.0, 100.0, "somebody 1984", "estimated")
CONSENT = SessionConditions(consent=True, room="quiet room")
TRACE = '# {"seed": 1}\ntime_s,x_m\n0.0,0.0\n0.1,0.01\n'


def gratings(repetitions: int = 2, displays: tuple[str, ...] = ("biet2008-plate",)) -> StudyDesign:
    """A small match-to-sample: three gratings, one round of familiarisation."""
    lengths = {"2 mm": 2e-3, "4 mm": 4e-3, "8 mm": 8e-3}
    return StudyDesign(
        name="small",
        title="Small",
        displays=displays,
        task="match-to-sample",
        stimuli=tuple(Stimulus(name, at, "period") for name, at in lengths.items()),
        alternatives=tuple(Grating(name, at, "period") for name, at in lengths.items()),
        familiarisation=1,
        repetitions=repetitions,
    )


def magnitudes() -> StudyDesign:
    """A small magnitude estimation: two gratings, the shorter being 10."""
    return StudyDesign(
        name="magnitude",
        title="",
        displays=("biet2008-plate",),
        task="magnitude-estimation",
        stimuli=(Stimulus("4 mm", 4e-3, "period"), Stimulus("8 mm", 8e-3, "period")),
        reference="4 mm",
        modulus=10.0,
    )


def staircase(count: int = 30) -> StudyDesign:
    """A small two-interval study with one staircase and one Bayesian series."""
    return StudyDesign(
        name="jnd",
        title="",
        displays=("biet2008-plate",),
        task="two-interval",
        stimuli=(Stimulus("4 mm", 4e-3, "period"),),
        reference="4 mm",
        adaptive=(
            AdaptiveCondition("stairs", "staircase", count=count),
            AdaptiveCondition("bayes", "bayesian", count=count),
        ),
    )


class Script:
    """Answers by the trial's seed; keeps what it saw, and may stop as a person would."""

    def __init__(self, most: int | None = None) -> None:
        self.most = most
        self.seen: list[Presentation] = []
        self.told: list[Acknowledgement] = []

    def rest(self, duration: float) -> None:
        """No rest."""

    def feel(self, presentation: Presentation, place: int) -> None:
        """Long enough."""

    def ask(self, presentation: Presentation) -> str | float:
        """An answer that the seed fixes, so that any run of the same trials gives it."""
        if self.most is not None and len(self.told) >= self.most:
            raise KeyboardInterrupt
        names = sorted(presentation.trial.alternatives)
        if not names:
            return float(presentation.trial.seed % 100 + 1)
        return names[presentation.trial.seed % len(names)]

    def acknowledge(self, presentation: Presentation, told: Acknowledgement) -> None:
        """Keep it."""
        self.seen.append(presentation)
        self.told.append(told)


class Bench:
    """A device that plays nothing and can be off."""

    def __init__(self, amplitude: float = 2e-6, resonance: float = 30.5e3) -> None:
        self.amplitude, self.resonance = amplitude, resonance
        self.playing: list[str] = []
        self.trace = TRACE
        self.silent = True

    def identity(self) -> DeviceIdentity:
        """A name and two hashes."""
        return DeviceIdentity("bench", "d" * 64, "c" * 64)

    def verify_device(self) -> DeviceVerification:
        """As it was made, against 2 µm and 30.5 kHz."""
        return DeviceVerification(self.amplitude, 2e-6, self.resonance, 30.5e3)

    def present(self, stimulus: Stimulus, seed: int) -> None:
        """Plays."""
        self.playing.append(stimulus.name)
        self.silent = False

    def stop(self) -> TrialMotion:
        """Silent; a finger of which all is known."""
        self.silent = True
        return TrialMotion(0.08, 0.086, 0.49, self.trace)


def session(store: StudyStore, participant: str, device: StudyDevice | None = None) -> StudyRun:
    """A session begun without a device."""
    begun = begin_session(
        store, participant, device or NoDevice(), CONSENT, None, acknowledged=False
    )
    return StudyRun(store, begun)


def run_through(path: Path, design: StudyDesign, people: int = 2, seed: int = 7) -> StudyStore:
    """A study in which everyone has answered everything."""
    store = StudyStore.create(path, design, seed)
    for _ in range(people):
        who = store.enrol()
        while any(p["uuid"] == who and p["answered"] < p["planned"] for p in store.participants()):
            conduct(session(store, who), NoDevice(), Script())
    return store


def matched(
    design: StudyDesign, display: Any, stimulus: Any, choice: Any, number: Any, times: Any
) -> Answers:
    """Simulated matches, each of shape (people, trials)."""
    people, asked = choice.shape
    nothing = np.full(choice.size, np.nan)
    return Answers(
        design=design, origin="simulated",
        people=tuple(f"simulated-{person + 1}" for person in range(people)),
        surfaces=design.stimuli, participant=np.repeat(np.arange(people), asked),
        number=number.ravel() + 1, phase=np.full(choice.size, "main"), display=display.ravel(),
        series=np.full(choice.size, -1), presented=stimulus.reshape(1, -1), intensity=nothing,
        choice=choice.ravel(), right=right_answers(design)[stimulus.ravel()], estimate=nothing,
        response_time=times.ravel(),
    )  # fmt: skip
