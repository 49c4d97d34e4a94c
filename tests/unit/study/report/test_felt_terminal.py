"""What a path would have felt like, on the terminal."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
from tests.unit.made_results import made_result
from tests.unit.printed import printed

from squeezefilm.physics.perception.observer import FingerClass
from squeezefilm.physics.perception.path_percepts import RunPercept
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.record.exploration import Exploration
from squeezefilm.study.report.felt_path import show_all, show_felt
from squeezefilm.study.simulated.felt_paths import FeltPath, Likeness

WENT = Exploration(4.0, 2.5, 0.2, 0.08, 0.0964, 3, 1.0, 0.375)
FINGER = FingerClass(12e-3, 0.0, "dry", 0.65, 0.08)


def run(periods: list[float], evidence: list[float], swings: tuple[float, float]) -> RunPercept:
    rhythms = SimpleNamespace(period=np.array(periods), d_prime=np.array(evidence))
    percept: Any = SimpleNamespace(candidates=rhythms)
    return RunPercept(percept, 3, 0.12, 0.08, *swings)


ALONG = run([4e-3, 2e-3, 8e-3, 1e-3], [5.126, 2.5, 1.25, 1.0], (0.3, 0.0625))
ACROSS = run([4e-3, 2e-3], [-math.inf, -math.inf], (0.0, 0.0))


def felt(**other: Any) -> FeltPath:
    values = {
        "stimulus": Stimulus("fine", 4e-3, "period"), "display": "plate", "source": "mine.csv",
        "observer": SimpleNamespace(detection_criterion=1.0), "explored": WENT, "finger": FINGER,
        "force_is": "measured", "directions": {"along x": ALONG, "along y": ACROSS},
        "nearest": (Likeness("fine", 0.126), Likeness("coarse", math.inf)),
        "compared_by": "the rhythm", "choice": "", "answer": "", "assumed": ("the skin is dry",),
    }  # fmt: skip
    path: FeltPath = made_result(FeltPath, **(values | other))
    return path


def test_a_path_says_how_it_went_and_what_was_felt_in_each_direction() -> None:
    assert printed(lambda: show_felt(felt())) == [
        "SIMULATED: 4 mm along x (d′ = 5.1), nothing along y",
        "Surface fine square grating",
        "Display plate",
        "Path 200 mm in 2.5 s mine.csv",
        "Explored 80 mm/s in the mean 96.4 mm/s at most, 3 passes, 38 % of the face",
        "Force 0.65 N measured",
        "Evidence by direction",
        "Runs Clearest rhythm d′ Next Swing asked Swing felt",
        "along x 3 4 mm 5.13 2 mm (2.50), 8 mm (1.25) 0.300 0.062",
        "along y 3 none 0.00 – 0.000 0.000",
        "How far from each surface by the rhythm",
        "Surface Standard deviations",
        "fine 0.13",
        "coarse nothing felt",
        "the skin is dry",
    ]


def test_what_was_answered_is_said_of_a_trial_only() -> None:
    lines = printed(lambda: show_felt(felt(choice="coarse", answer="fine")))
    assert "Answered coarse right: fine" in lines
    assert "Answered coarse right: nothing" in printed(lambda: show_felt(felt(choice="coarse")))
    assert "Answered – right: fine" in printed(lambda: show_felt(felt(answer="fine")))


def test_of_a_face_that_is_not_known_no_share_is_said() -> None:
    unknown = dataclasses.replace(WENT, coverage=math.nan)
    lines = printed(lambda: show_felt(felt(explored=unknown)))
    assert "Explored 80 mm/s in the mean 96.4 mm/s at most, 3 passes" in lines


def test_evidence_at_the_criterion_is_not_felt() -> None:
    strict = SimpleNamespace(detection_criterion=5.126)
    first = printed(lambda: show_felt(felt(observer=strict)))[0]
    assert first == "SIMULATED: nothing along x, nothing along y"


def test_paths_of_a_trial_are_shown_in_turn_and_once_told_to_be_nobodys() -> None:
    lines = printed(lambda: show_all((felt(display="one"), felt(display="two"))))
    assert [line for line in lines if line.startswith("Display")] == ["Display one", "Display two"]
    assert lines[-1].startswith("Nobody's percept was measured")
