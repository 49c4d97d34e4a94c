from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.unit.design.search.made_up import random_designs, requirements

from squeezefilm.core.errors import GeometryError
from squeezefilm.design.fabrication.report.sheet_parts import tolerance_said
from squeezefilm.design.search import limits
from squeezefilm.design.search.candidate import (
    Design,
    Evaluated,
    display_of,
    evaluate,
    sourced_display_of,
)
from squeezefilm.design.search.limits import as_made, made_of
from squeezefilm.design.search.requirements import (
    Limits,
    Requirements,
    load_requirements,
    toleranced,
)
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.uncertainty.parameters import uncertain_parameters, value_at


@pytest.fixture(scope="module")
def wanted() -> Requirements:
    return requirements()


@pytest.fixture(scope="module")
def solved(wanted: Requirements) -> Evaluated:
    """A feasible design, as if its solved numbers were a tenth above the screened ones."""
    for design in random_designs(wanted, 200):
        one = evaluate(wanted, design, "screened")
        if one.is_feasible:
            numbers = {key: 1.1 * value for key, value in one.numbers.items()}
            return replace(one, level="solved", numbers=numbers)
    raise AssertionError("none of 200 designs is feasible")


def test_as_drawn_nothing_changes(wanted: Requirements, solved: Evaluated) -> None:
    as_drawn = as_made(wanted, solved.design, np.zeros(7))
    assert as_drawn.actuator == display_of(wanted, solved.design).actuator


def test_each_tolerance_moves_what_it_names(wanted: Requirements, solved: Evaluated) -> None:
    drawn = display_of(wanted, solved.design).actuator
    assert isinstance(drawn, RectangularPlate)
    rows = np.eye(7)
    thicker = as_made(wanted, solved.design, rows[0]).actuator
    assert thicker.thickness == pytest.approx(drawn.thickness + 20e-6)  # type: ignore[union-attr]
    longer = as_made(wanted, solved.design, rows[2]).actuator
    assert isinstance(longer, RectangularPlate)
    assert longer.length == pytest.approx(drawn.length + 50e-6)
    assert longer.width == pytest.approx(drawn.width + 50e-6)
    assert longer.patches[-1].x + longer.patches[-1].length == pytest.approx(longer.length)
    stiffer = as_made(wanted, solved.design, rows[3]).actuator
    assert isinstance(stiffer, RectangularPlate)
    assert stiffer.substrate.young_modulus == pytest.approx(1.02 * drawn.substrate.young_modulus)


def test_the_interval_is_about_the_solved_number(wanted: Requirements, solved: Evaluated) -> None:
    made = made_of(wanted, solved, draws=16)
    low, high = made.intervals["resonance_frequency"]
    own = solved.numbers["resonance_frequency"]
    assert low < own < high
    assert high - low < 0.2 * own
    effects = made.effects
    assert effects["thickness"]["resonance_frequency"] > 0
    assert effects["quality_factor"]["relative_friction"] < 0
    assert abs(effects["quality_factor"]["resonance_frequency"]) < 1e-6 * own


@pytest.mark.slow
def test_the_yield_is_the_share_that_keeps_the_limits(
    wanted: Requirements, solved: Evaluated
) -> None:
    own = solved.numbers["resonance_frequency"]
    # The frequency spreads by a few percent about its own value: half of the plates keep it.
    half = Limits(least_frequency=own)
    made = made_of(replace(wanted, limits=half), solved, draws=32)
    assert made.kept == pytest.approx(0.5, abs=0.2)
    assert set(made.broken) == {"resonance_frequency"}
    assert made.broken["resonance_frequency"] == round((1 - made.kept) * made.draws)


def test_what_cannot_be_made_is_not_kept(wanted: Requirements) -> None:
    design = random_designs(wanted, 1)[0]
    impossible = Design(0, tuple({**design.settings, "cover": 0.01}.items()))
    made = made_of(wanted, Evaluated(impossible, "solved", {}), draws=4)
    assert made.kept == 0


def test_an_effect_on_the_thickness_is_that_of_the_sheet(
    wanted: Requirements, solved: Evaluated
) -> None:
    thin = replace(wanted, objectives=("relative_friction", "thickness"))
    alike = evaluate(thin, solved.design, "screened")
    found = made_of(thin, replace(alike, level="solved"), draws=4)
    assert found.effects["thickness"]["thickness"] == pytest.approx(20e-6)


def test_a_fault_of_ours_costs_the_plate_that_has_it_and_no_search(
    wanted: Requirements, solved: Evaluated, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, calls = limits.screened, itertools.count()

    def at_times(*asked: Any) -> dict[str, float]:
        if next(calls) == 3:  # the first is the plate as drawn
            raise ZeroDivisionError("of ours")
        return real(*asked)

    monkeypatch.setattr(limits, "screened", at_times)
    assert made_of(wanted, solved, draws=8).failed == 1


@pytest.mark.parametrize("name", ["biet2008-plate", "winfield2007-tpad"])
def test_file_drawing_and_yield_have_the_same_tolerances(name: str) -> None:
    """Three standard deviations off, a plate is at the end of what its file says of each length;
    the drawing has two of them, as ±."""
    asked = load_requirements(name)
    for design in random_designs(asked, 20):
        try:
            display = sourced_display_of(asked, design)
        except GeometryError:
            continue
        made = as_made(asked, design, np.array([3.0, 3.0, 3.0, 0, 0, 0, 0]))
        said = [path for path in toleranced(display.actuator) if "patches" not in path]  # type: ignore[arg-type]
        for path in [f"actuator.{one}" for one in said]:
            spread = display.provenance[path].distribution
            assert spread is not None
            assert value_at(made, path)[0] == pytest.approx(spread.support[1])
        assert tolerance_said(display, "actuator.thickness") == " ±0.04"
        sides = "length" if name == "biet2008-plate" else "diameter"
        assert tolerance_said(display, f"actuator.{sides}") == " ±0.1"
        thickness = [one.path for one in uncertain_parameters(display, driven=True)]
        assert sum("thickness" in path and "glue" not in path for path in thickness) == 2
        return
    raise AssertionError("none of 20 designs can be built")
