"""Films side by side at one working point: shares of the load, curves, teeth and plateaus.

The films that are solved in the plane take seconds, so they are left out, and what compares teeth
stands in for itself with numbers of its own; `tests/verification` checks those solvers.
"""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.analysis.film import models
from squeezefilm.analysis.film.models import FilmComparison, compare_film_models
from squeezefilm.chain.friction import FrictionLaw, friction_law
from squeezefilm.chain.prediction import Prediction, predict
from squeezefilm.contact.sharing.film_load import DESCRIPTIONS, FilmLoad
from squeezefilm.display import Display, load_display
from squeezefilm.errors import OutOfRangeError
from squeezefilm.film.planar import teeth
from squeezefilm.plate.layout import AnnularStator

STATOR = load_display("biet2008-stator")
assert isinstance(STATOR.actuator, AnnularStator)
PLAIN = dataclasses.replace(
    STATOR, actuator=dataclasses.replace(STATOR.actuator, tooth_pitch=None, slot_width=None)
)
# 0.5 N on 1 cm² of the stator's finger, over the paper's 100 kPa.
PRESSURE = 0.05


@pytest.fixture(scope="module")
def point() -> Prediction:
    return predict(PLAIN, model="paper2008")


def compared(
    monkeypatch: pytest.MonkeyPatch, p: Prediction, display: Display = PLAIN, *of: str
) -> FilmComparison:
    monkeypatch.setattr(models, "FILM_MODELS", of or ("paper2008", "film-plateau"))
    found = compare_film_models(display, p)
    assert found is not None
    return found


def test_nothing_is_compared_where_nothing_vibrates() -> None:
    assert compare_film_models(PLAIN, predict(PLAIN, voltage=0.0, model="paper2008")) is None


def test_each_film_carries_its_share(monkeypatch: pytest.MonkeyPatch, point: Prediction) -> None:
    found = compared(monkeypatch, point)
    paper, plateau = found.results
    assert paper.over_pressure == pytest.approx(point.mean_pressure - 1)
    assert paper.load_share == pytest.approx(paper.over_pressure / PRESSURE)
    assert paper.relative_friction == pytest.approx(1 - paper.load_share)
    assert paper.relative_friction == pytest.approx(point.relative_friction)
    assert (paper.over_pressure_error, paper.status) == (0.0, "closed form")
    assert paper.description == DESCRIPTIONS["paper2008"]
    # Plateaus carry more than the finger, which then floats.
    assert plateau.load_share > 1
    assert plateau.relative_friction == 0.0
    assert 0 < plateau.over_pressure_error < 0.01 * plateau.over_pressure
    assert found.result("film-plateau") is plateau
    assert found.teeth is None


def test_a_harder_finger_is_carried_less(monkeypatch: pytest.MonkeyPatch) -> None:
    hard = predict(PLAIN, surface="bare", normal_force=2.0, model="paper2008")
    found = compared(monkeypatch, hard, PLAIN, "paper2008")
    paper = found.result("paper2008")
    assert paper.over_pressure == pytest.approx(hard.mean_pressure - 1)
    assert paper.load_share == pytest.approx(paper.over_pressure / (4 * PRESSURE))
    assert paper.relative_friction == pytest.approx(1 - paper.load_share)


def test_curves_run_to_four_micrometres_or_a_quarter_beyond(
    monkeypatch: pytest.MonkeyPatch, point: Prediction
) -> None:
    curves = compared(monkeypatch, point).curves
    assert [curve.model for curve in curves] == ["paper2008", "film-plateau"]
    for curve in curves:
        assert curve.amplitude == pytest.approx(np.geomspace(0.1e-6, 4e-6, curve.amplitude.size))
        assert curve.amplitude.size > 20
        law = friction_law(
            PLAIN, point.mode.half_wavelength, point.frequency, surface=point.surface,
            normal_force=point.normal_force, model=curve.model,
        )  # fmt: skip
        for k in (0, 10, -1):
            expected = law.load(float(curve.amplitude[k])).over_pressure / PRESSURE
            assert curve.load_share[k] == pytest.approx(expected)
    wide = predict(PLAIN, vibration_amplitude=8e-6, model="paper2008")
    (curve,) = compared(monkeypatch, wide, PLAIN, "paper2008").curves
    assert curve.amplitude[[0, -1]] == pytest.approx([0.25e-6, 10e-6])


def test_a_film_that_cannot_be_solved_says_why_and_its_curve_ends(
    monkeypatch: pytest.MonkeyPatch, point: Prediction
) -> None:
    whole = FrictionLaw.load

    def load(law: FrictionLaw, amplitude: float) -> FilmLoad:
        if law.model == "film-plateau" and 1e-6 < amplitude < 3e-6:
            raise OutOfRangeError("too far")
        return whole(law, amplitude)

    monkeypatch.setattr(FrictionLaw, "load", load)
    found = compared(monkeypatch, point)
    assert found.result("paper2008").load_share > 0
    failed = found.result("film-plateau")
    assert failed.status == "not solved: too far"
    assert failed.description == DESCRIPTIONS["film-plateau"]
    assert np.all(np.isnan(dataclasses.astuple(failed)[2:6]))
    good, bad = found.curves
    assert np.all(np.isfinite(good.load_share))
    assert np.array_equal(np.isfinite(bad.load_share), bad.amplitude <= 1e-6)


@pytest.mark.parametrize(
    ("ratio", "says"),
    [
        (1.42, "142 % of that of a continuous surface: they do matter here, and the paper assumes"),
        (0.79, "79 % of that of a continuous surface: they do matter here"),
        (1.25, "125 % of that of a continuous surface: they matter little here"),
        (0.8, "80 % of that of a continuous surface: they matter little here"),
    ],
)
def test_teeth_are_compared_in_parts_of_the_contact(
    monkeypatch: pytest.MonkeyPatch, point: Prediction, ratio: float, says: str
) -> None:
    asked: dict[str, Any] = {}

    def compare(squeeze_number: float, gap: Any, **others: Any) -> Any:
        asked.update(others, sigma=squeeze_number, gap=gap)
        return SimpleNamespace(continuous=0.1, toothed=0.2, ratio=ratio)

    monkeypatch.setattr(teeth, "compare_teeth", compare)
    found = compared(monkeypatch, point, STATOR, "paper2008").teeth
    assert found is not None
    assert found.sentence.startswith(f"Teeth change the over-pressure under open ridges to {says}")
    assert (found.continuous, found.toothed, found.ratio) == (0.1, 0.2, ratio)
    assert (found.tooth_pitch, found.slot_width) == (2.34e-3, 0.6e-3)
    # Teeth of 1.74 mm each 2.34 mm under a finger of 10 mm.
    assert asked["tooth_width"] == pytest.approx(0.174)
    assert asked["tooth_pitch"] == pytest.approx(0.234)
    assert asked["sigma"] == point.squeeze_number
    mean = 0.6e-6 + point.vibration_amplitude + 50e-6
    assert asked["gas"].knudsen_number == pytest.approx(STATOR.gas.mean_free_path / mean)
    gap = asked["gap"]
    assert gap.excursion_ratio == pytest.approx(point.vibration_amplitude / mean)
    assert gap.ridge_height == pytest.approx(50e-6 / mean)
    assert gap.wave_number == pytest.approx(2 * np.pi * 10 / 18.7)
    assert gap.ridge_wave_number == pytest.approx(2 * np.pi * 10e-3 / 350e-6)


def test_teeth_that_cannot_be_compared_are_left_out(
    monkeypatch: pytest.MonkeyPatch, point: Prediction
) -> None:
    def compare(*_: Any, **__: Any) -> Any:
        raise OutOfRangeError("too far")

    monkeypatch.setattr(teeth, "compare_teeth", compare)
    assert compared(monkeypatch, point, STATOR, "paper2008").teeth is None


def test_plateaus_alone_carry_the_finger_at_a_mean_gap(
    monkeypatch: pytest.MonkeyPatch, point: Prediction
) -> None:
    found = compared(monkeypatch, point, PLAIN, "paper2008").balance
    assert found is not None
    # 250 of every 350 µm carry 5 kPa, and at an antinode the surface comes nearer by its amplitude.
    assert found.plateau_pressure == pytest.approx(7e3)
    assert found.least_gap == pytest.approx(found.mean_gap - point.vibration_amplitude)
    assert 0 < found.mean_gap_error < 0.01 * found.mean_gap
    assert found.sentence == (
        "On flattened ridges over an antinode the film carries the finger at a mean gap of "
        f"{found.mean_gap * 1e6:.3g} µm, at its least {found.least_gap * 1e6:.2g} µm: above the "
        "roughness, so the finger could float there."
    )
    hard = compared(
        monkeypatch, predict(PLAIN, normal_force=5.0, model="paper2008"), PLAIN, "paper2008"
    ).balance
    assert hard is not None
    assert hard.plateau_pressure == pytest.approx(70e3)
    assert hard.mean_gap < found.mean_gap
    assert hard.sentence.endswith(
        ": below the roughness of 0.6 µm, so film and contact share the load."
    )
    too_hard = predict(PLAIN, normal_force=20.0, model="paper2008")
    assert compared(monkeypatch, too_hard, PLAIN, "paper2008").balance is None
