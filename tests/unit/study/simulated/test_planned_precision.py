"""How many people make an answer precise: intervals narrow with people."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.power import above_0
from squeezefilm.study.report.terminal_analysis import show_precision
from squeezefilm.study.simulated import planned_precision as module
from squeezefilm.study.simulated.planned_power import (
    pair_scores,
    planned_power,
    require_pair,
)
from squeezefilm.study.simulated.planned_precision import planned_precision

from .test_judgements import ALIKE, DEPTHS, EXACT, NUMBERS, tables


@pytest.fixture(autouse=True)
def quickly(monkeypatch: pytest.MonkeyPatch) -> None:
    def made(design: Any, _observer: Any, **_: Any) -> Any:
        return tables(design, 3.0)

    monkeypatch.setattr(module, "chain_tables", made)
    monkeypatch.setattr("squeezefilm.study.simulated.planned_power.chain_tables", made)
    monkeypatch.setattr("squeezefilm.study.simulated.planned_power.POOL", 60)


def test_what_was_found_before_a_stop_is_not_computed_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of precision and of power, whose numbers are those of one that was never stopped."""

    def ask(**more: Any) -> list[Any]:
        numbers: dict[str, Any] = {"participants": (2, 12), "studies": 10, "seed": 1, **more}
        precise = planned_precision(NUMBERS, EXACT, 0.1, people=30, **numbers).summary()
        names = (one.name for one in NUMBERS.stimuli[:2])
        power = planned_power(NUMBERS, EXACT, *names, **numbers).summary()
        return [{**one, "provenance": None} for one in (precise, power)]

    def stop(step: str) -> None:
        if step == "studies of 12 people":
            raise KeyboardInterrupt

    never_stopped = ask()
    monkeypatch.setenv("SQUEEZEFILM_CACHE", str(tmp_path))
    with pytest.raises(KeyboardInterrupt):
        ask(progress=stop)
    assert {one.name for one in tmp_path.iterdir()} == {"simulated-truths", "simulated-shares"}
    assert len(list((tmp_path / "simulated-shares").iterdir())) == 1
    assert ask() == never_stopped
    # Now nothing is left to simulate.
    monkeypatch.setattr(f"{planned_power.__module__}.simulated_answers", None)
    assert ask() == never_stopped


@pytest.mark.parametrize(
    "design",
    [
        pytest.param(ALIKE, id="same-different", marks=pytest.mark.slow),
        pytest.param(NUMBERS, id="magnitude-estimation"),
    ],
)
def test_more_people_are_more_precise(design: Any) -> None:
    found = planned_precision(
        design, EXACT, 0.15, participants=(2, 12, 40), studies=20, people=60, seed=1
    )
    assert found.curve.power[0] <= found.curve.power[1] <= found.curve.power[2]
    assert np.all(found.curve.low <= found.curve.power)
    assert np.all(found.held > 0.8)
    data = found.summary()
    assert data["origin"] == "simulated"
    again = planned_precision(
        design, EXACT, 0.15, participants=(2, 12, 40), studies=20, people=60, seed=1
    )
    assert again.curve.power.tolist() == found.curve.power.tolist()


def test_intervals_that_hold_too_seldom_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    found = planned_precision(NUMBERS, EXACT, 0.15, participants=(2, 4), studies=40, people=40)
    show_precision(dataclasses.replace(found, held=np.array([0.7, 0.95])))
    said = " ".join(capsys.readouterr().out.split())
    assert "With 2 people the interval holds the value less often than the 95 %" in said
    show_precision(dataclasses.replace(found, held=np.array([0.9, 0.95])))
    assert "less often" not in capsys.readouterr().out


def test_what_cannot_be_asked_is_refused() -> None:
    for options in ({"participants": (1,)}, {"studies": 5}, {"target": 1.0}, {"people": 5}):
        with pytest.raises(InputError):
            planned_precision(ALIKE, EXACT, 0.1, **options)  # type: ignore[arg-type] # refused
    with pytest.raises(InputError, match="precision"):
        planned_precision(ALIKE, EXACT, 0.0)
    with pytest.raises(InputError, match="neither a file nor a preset"):
        planned_precision(ALIKE, EXACT, 0.1, display="nowhere")


@pytest.mark.slow
def test_pairs_are_told_apart_in_every_task() -> None:
    for design, first, second in (
        (ALIKE, "4 mm", "6 mm"), (NUMBERS, "2 mm", "8 mm"), (DEPTHS, "30 %", "42 %"),
    ):  # fmt: skip
        found = planned_power(design, EXACT, first, second, participants=(3, 8), studies=20)
        assert found.difference > 0 or design is DEPTHS
        assert found.curve.participants.tolist() == [3, 8]


def test_pairs_that_no_test_tells_apart_are_refused() -> None:
    with pytest.raises(InputError, match="name it as one"):
        require_pair(ALIKE, "5 mm", "6 mm")
    with pytest.raises(InputError, match="from itself"):
        require_pair(ALIKE, "4 mm", "4 mm")
    from squeezefilm.study.design.study_design import load_design

    with pytest.raises(InputError, match="precision"):
        require_pair(load_design("period-jnd"), "4 mm", "6 mm")


@pytest.mark.slow
def test_scores_are_nought_of_people_who_cannot_tell() -> None:
    from squeezefilm.study.simulated.judgements import simulate_judgements

    blind = simulate_judgements(tables(ALIKE, -np.inf), 60, 2)
    assert pair_scores(blind, "4 mm", "6 mm").mean() == pytest.approx(0.0, abs=0.05)
    sharp = dataclasses.replace(EXACT, period_weber_fraction=0.01)
    seen = simulate_judgements(dataclasses.replace(tables(ALIKE), observer=sharp), 20, 2)
    assert pair_scores(seen, "4 mm", "6 mm").mean() > 0.5
    assert above_0(np.zeros(4)) == 1.0
    assert above_0(np.full(4, 0.5)) == 0.0
    assert above_0(np.array([1.0, 2.0, 3.0])) == pytest.approx(0.0371, abs=1e-3)
