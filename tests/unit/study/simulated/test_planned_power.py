"""Power of a planned study, on chains written down by hand: certain, hopeless, and in between."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from scipy.special import ndtr

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.percepts import Apparatus
from squeezefilm.physics.perception.senses import D_PRIME_OF_75, Candidates
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.simulated import planned_power as module
from squeezefilm.study.simulated.chain_tables import ChainTables
from squeezefilm.study.simulated.planned_power import SIZES, PlannedPower, planned_power

PERIODS = np.array([0.4e-3, 2e-3, 4e-3, 8e-3, 10e-3])
TWO = dataclasses.replace(
    load_design("biet2008-gratings"), displays=("biet2008-stator", "biet2008-plate")
)
EXACT = dataclasses.replace(
    load_observer(), finger_classes=1, candidates=1, period_spread=0.0, lapse_rate=0.0,
    learning_excess=0.0,
)  # fmt: skip
NAMES = [one.name for one in TWO.stimuli]


@pytest.fixture
def displays(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, ...]]:
    """The displays that were computed: beyond doubt on the stator, nothing felt on the plate."""
    asked: list[tuple[str, ...]] = []

    def chain_tables(design: StudyDesign, observer: Any, finger: str, progress: Any) -> ChainTables:
        asked.append(design.displays)
        progress("a finger")
        period = PERIODS[None, :, None]
        felt = 1e6 if design.displays == ("biet2008-stator",) else -np.inf
        return ChainTables(
            design=design,
            observer=observer,
            fingers=observer.fingers(),
            apparatus=(Apparatus(),),
            virtual=Candidates(period[None, ..., None], np.full((1, 1, 5, 1, 1), felt)),
            real=Candidates(period, np.full((1, 5, 1), 1e6)),
        )

    monkeypatch.setattr(module, "chain_tables", chain_tables)
    monkeypatch.setattr(module, "POOL", 200)
    return asked


def power(first: str = NAMES[3], second: str = NAMES[4], **others: Any) -> PlannedPower:
    arguments = {"participants": (2, 6), "studies": 50, **others}
    return planned_power(TWO, EXACT, first, second, **arguments)


def test_what_is_never_confused_needs_the_fewest(displays: list[tuple[str, ...]]) -> None:
    found = power(NAMES[0], NAMES[1])
    # Never confused and always named: a score of 1 for each of the two.
    assert found.difference == pytest.approx(2.0, abs=0.1)
    assert found.curve.power.tolist() == [1.0, 1.0]
    assert found.curve.needed == 2
    assert displays == [("biet2008-stator",)]
    assert (found.first, found.second) == (NAMES[0], NAMES[1])
    assert (found.design, found.display) == (TWO.name, "biet2008-stator")
    assert (found.observer, found.origin) == (EXACT.name, "simulated")


def test_what_is_not_felt_is_found_as_often_as_by_chance(displays: list[tuple[str, ...]]) -> None:
    found = power(display="biet2008-plate", studies=200, alpha=0.3, target=0.6)
    assert displays == [("biet2008-plate",)]
    assert found.display == "biet2008-plate"
    assert found.difference == pytest.approx(0.0, abs=0.05)
    assert found.curve.power == pytest.approx([0.3, 0.3], abs=0.12)
    assert found.curve.needed is None
    curve = found.curve
    assert (curve.studies, curve.alpha, curve.target) == (200, 0.3, 0.6)


def test_8_against_10_mm_differ_as_three_independent_percepts_do(
    displays: list[tuple[str, ...]],
) -> None:
    # As in `test_participants`: p is the share of right answers, so the score is 2 (2 p − 1).
    sigma, apart = math.log1p(EXACT.period_weber_fraction) / D_PRIME_OF_75, math.log(10 / 8)
    near, order = ndtr(apart / 2 / (sigma * math.sqrt(1.5))), ndtr(apart / (sigma * math.sqrt(2)))
    right = near * order + (1 - near) * (1 - order)
    found = power(NAMES[3], NAMES[4])
    assert found.difference == pytest.approx(2 * (2 * right - 1), abs=0.12)
    assert found.curve.power[1] > found.curve.power[0]
    # The two in the other order are as far apart.
    assert power(NAMES[4], NAMES[3]).difference == pytest.approx(found.difference)


@pytest.mark.slow
def test_the_seed_is_of_people_and_studies(displays: list[tuple[str, ...]]) -> None:
    one, same, other = power(seed=3), power(seed=3), power(seed=4)
    assert one.curve.power.tolist() == same.curve.power.tolist()
    assert one.difference == same.difference != other.difference
    assert one.seed == 3
    data = one.summary()
    assert data["provenance"]["seed"] == 3
    assert (data["design"], data["origin"], data["first"]) == (TWO.name, "simulated", NAMES[3])
    assert data["curve"]["participants"] == [2, 6]
    hashes = {one.summary()["provenance"]["config_sha256"], data["provenance"]["config_sha256"]}
    assert len(hashes) == 1
    changed = dataclasses.replace(one, observer="another").summary()["provenance"]
    assert changed["config_sha256"] not in hashes


def test_each_step_is_told(displays: list[tuple[str, ...]]) -> None:
    told: list[str] = []
    power(progress=told.append)
    assert told == [
        "a finger",
        "200 simulated participants",
        "studies of size 1 of 2",
        "studies of size 2 of 2",
    ]


def test_sizes_rise_from_the_fewest_that_a_test_can_have() -> None:
    assert SIZES[0] == 2
    assert list(SIZES) == sorted(set(SIZES))
    assert SIZES[-1] == 48


def test_names_that_are_not_in_the_design_are_refused(displays: list[tuple[str, ...]]) -> None:
    known = ", ".join(NAMES)
    near = f"{NAMES[3]}s"
    for names in ((near, NAMES[0]), (NAMES[0], near)):
        with pytest.raises(InputError) as caught:
            power(*names)
        assert str(caught.value) == (
            f"design '{TWO.name}' has no stimulus '{near}'. Did you mean '{NAMES[3]}'? It has: "
            f"{known}"
        )
    with pytest.raises(InputError) as caught:
        power(display="glass")
    assert "'glass' is neither a file nor a preset" in str(caught.value)
    assert not displays


def test_each_stimulus_needs_its_own_right_answer(displays: list[tuple[str, ...]]) -> None:
    turned = dataclasses.replace(TWO, stimuli=TWO.stimuli[::-1])
    with pytest.raises(InputError) as caught:
        planned_power(turned, EXACT, NAMES[0], NAMES[1], participants=(2,), studies=10)
    assert str(caught.value) == (
        f"power needs each stimulus of '{TWO.name}' to have its own right answer, in the order of "
        "the stimuli"
    )
    assert not displays
