"""A design evaluated: what is asked of its display, and what becomes of a refusal."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.design.search.made_up import random_designs, requirements

from squeezefilm.core.errors import GeometryError, OutOfRangeError
from squeezefilm.design.search import candidate, evolution
from squeezefilm.design.search.candidate import (
    Design,
    at_other_voltages,
    evaluate,
    rough_frequency,
    screened,
)
from squeezefilm.design.search.evolution import Proposals
from squeezefilm.physics.plate.beam_modes import timoshenko_frequency
from squeezefilm.physics.plate.laminate import plate_laminate, section_with

WANTED = requirements()


def buildable() -> Design:
    """A design whose plate can be built."""
    for design in random_designs(WANTED, 50):
        try:
            candidate.display_of(WANTED, design)
        except GeometryError:
            continue
        return design
    raise AssertionError


DESIGN = buildable()
GOOD = {"relative_friction": 0.5, "resonance_frequency": 30e3, "temperature_rise": 20.0}


@pytest.fixture
def predicted(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """A prediction that nothing computed, and what it was asked of."""
    made = SimpleNamespace(
        mode=SimpleNamespace(has_shape=True), warnings=("it warms",), objections=("a", "no shape"),
        numbers=dict(GOOD), more={"area": 0.9}, asked=[],
    )  # fmt: skip

    def predict(display: Any, **how: Any) -> Any:
        made.asked.append((display, how))
        return made

    monkeypatch.setattr(candidate, "predict", predict)
    monkeypatch.setattr(
        candidate, "numbers_of_prediction", lambda *said: made.numbers | {"cost": said[3]}
    )
    monkeypatch.setattr(candidate, "numbers_of_solved", lambda *_: made.more)
    return made


def test_what_is_screened_is_asked_of_the_beam_alone(predicted: SimpleNamespace) -> None:
    found = evaluate(WANTED, DESIGN, "screened")
    assert (found.design, found.level) == (DESIGN, "screened")
    cost = WANTED.shapes[0].cost_class(DESIGN.settings)
    assert found.numbers == GOOD | {"cost": cost}
    assert (found.is_feasible, found.reason, found.warnings, found.lasting) == (True, "", (), True)
    ((display, how),) = predicted.asked
    assert how == {"theory": "timoshenko"}
    assert display.provenance == {}
    assert display.drive.voltage == DESIGN.settings["voltage"]
    assert display.name == f"small-{DESIGN.address}"
    assert screened(WANTED, display, DESIGN) == found.numbers


def test_what_is_solved_has_its_sources_more_numbers_and_warnings(
    predicted: SimpleNamespace,
) -> None:
    predicted.numbers["temperature_rise"] = 75.0
    found = evaluate(WANTED, DESIGN, "solved")
    ((display, how),) = predicted.asked
    assert how == {"voltage": None}
    assert "actuator.thickness" in display.provenance
    assert found.numbers["area"] == 0.9
    assert found.warnings == ("it warms",)
    # 60 K are allowed.
    assert [one.key for one in found.broken] == ["temperature_rise"]
    assert not found.is_feasible


def test_a_plate_that_has_no_such_shape_is_no_design(predicted: SimpleNamespace) -> None:
    predicted.mode.has_shape = False
    found = evaluate(WANTED, DESIGN, "solved")
    assert (found.reason, found.numbers, found.lasting) == ("no shape", {}, True)
    # By the theory of screening every plate has its shape.
    assert evaluate(WANTED, DESIGN, "screened").is_feasible


@pytest.mark.parametrize(
    ("error", "reason", "lasting"),
    [
        (OutOfRangeError("too thick"), "too thick", True),
        (ZeroDivisionError("by three"), "not foreseen: ZeroDivisionError: by three", False),
    ],
)
def test_a_refusal_is_an_answer_and_a_fault_may_be_mended(
    error: Exception, reason: str, lasting: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: Any, **__: Any) -> Any:
        raise error

    monkeypatch.setattr(candidate, "predict", refused)
    found = evaluate(WANTED, DESIGN, "solved")
    assert (found.reason, found.lasting, found.numbers) == (reason, lasting, {})
    assert found.objectives(("relative_friction",)) == (math.inf,)
    assert not found.is_feasible
    assert found.seconds >= 0.0


def test_other_voltages_of_a_plate_go_from_the_least_to_the_most() -> None:
    others = at_other_voltages(WANTED, DESIGN)
    volts = [float(one.settings["voltage"]) for one in others]
    assert (volts[0], volts[-1]) == (5.0, 15.0)
    assert np.diff(volts) == pytest.approx(2.5)
    assert {one.plate for one in others} == {DESIGN.plate}
    fixed = dataclasses.replace(
        WANTED, drive=dataclasses.replace(WANTED.drive, least_voltage=WANTED.drive.voltage)
    )
    assert at_other_voltages(fixed, DESIGN) == []


def test_a_rough_frequency_lies_between_the_bare_plates_and_the_covered_ones() -> None:
    body: Any = candidate.display_of(WANTED, DESIGN).actuator
    half = body.length / (body.nodal_lines - 0.5)
    bare = timoshenko_frequency(half, section_with(body, "plane_strain", 0.0, 0.0))
    covered = timoshenko_frequency(half, plate_laminate(body))
    found = rough_frequency(WANTED, DESIGN)
    share = math.log(found / bare) / math.log(covered / bare)
    assert share == pytest.approx(body.coverage)
    assert 0.0 < share < 1.0


def test_what_is_no_plate_of_strips_or_cannot_be_built_has_no_rough_frequency(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refused(*_: Any) -> Any:
        raise GeometryError("too short")

    monkeypatch.setattr(candidate, "display_of", refused)
    assert math.isnan(rough_frequency(WANTED, DESIGN))
    other: Any = SimpleNamespace(shapes=[SimpleNamespace(type="disc")])
    assert math.isnan(rough_frequency(other, DESIGN))


def test_a_first_generation_is_of_designs_whose_rough_frequency_is_allowed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looked: list[float] = []

    def rough(_: Any, design: Design) -> float:
        looked.append(1e4 * float(design.settings["nodal_lines"]))
        return looked[-1]

    monkeypatch.setattr(evolution, "rough_frequency", rough)

    def aimed(low: float | None, high: float | None, count: int) -> list[dict[str, float]]:
        limits = dataclasses.replace(WANTED.limits, least_frequency=low, most_frequency=high)
        wanted = dataclasses.replace(WANTED, limits=limits)
        return Proposals(wanted, 0, "screened", 1)._aimed(count)

    space = WANTED.spaces[0]
    found = aimed(6e4, 7e4, 5)
    assert len(found) == 5
    assert all(space.at(places)["nodal_lines"] in (6, 7) for places in found)
    assert all(places.keys() == {one.name for one in space.free} for places in found)
    # Drawn until there are enough of them, and not for ever.
    assert looked[-1] in (6e4, 7e4)
    assert sum(6e4 <= one <= 7e4 for one in looked) == 5
    looked.clear()
    assert aimed(1.0, 2.0, 3) == []
    assert len(looked) == 3 * 40
    for ends in ((6e4, None), (None, 7e4)):
        assert aimed(*ends, 5) == []
