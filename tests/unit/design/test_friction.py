"""What a friction analysis asks of the models, and its map, ripple and numbers."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.core.progress import NO_HURRY
from squeezefilm.design import friction
from squeezefilm.design.analysis.curves import ModelCurve
from squeezefilm.design.analysis.verdict import Finding
from squeezefilm.design.friction import (
    FrictionAnalysis,
    Wanted,
    analyze_friction,
    friction_map,
)
from squeezefilm.physics.chain.pad_law import MODEL_KINDS, ModelKind
from squeezefilm.physics.display import Display


@dataclasses.dataclass(frozen=True)
class Law:
    """µ′/µ falls by a tenth a micrometre, the steeper the less the finger presses; above 2 N there
    is no balance beyond 2 µm."""

    model: str = "partial-levitation"
    normal_force: float = 0.5
    position: float = 0.0
    frequency: float = 40e3
    half_wavelength: float = 9e-3
    gas: str = "air"
    finger: Any = None
    surface: Any = None

    @property
    def kind(self) -> ModelKind:
        return MODEL_KINDS[self.model]

    def by(self, model: str) -> Law:
        return dataclasses.replace(self, model=model)

    def at(self, amplitude: float) -> float:
        if self.normal_force > 1.99 and amplitude > 2.01e-6:
            raise OutOfRangeError("pressed through")
        return 1 - 0.1 * amplitude / 1e-6 * 0.5 / self.normal_force

    def curve(self, amplitude: np.ndarray) -> np.ndarray:
        return np.array([self.at(float(one)) for one in amplitude])

    def tapped(self, amplitude: float, speed: float) -> np.ndarray:
        return np.array([0.9 - amplitude / 1e-5 - speed, 7.0])


def prediction(law: Any = None, **changes: Any) -> Any:
    law = law or Law()
    sharing = SimpleNamespace(
        film_share=np.array([0.6, 9.0]), relative_friction=np.array([0.4, 9.0]),
        mean_gap=np.array([1.5e-6, 9.0]), residual=1e-9,
        relative_friction_error=np.array([1e-3, 9.0]),
    )  # fmt: skip
    values: dict[str, Any] = {
        "law": law, "voltage": 15.0, "vibration_amplitude": 2e-6, "frequency": 40e3,
        "normal_force": 0.5, "surface": SimpleNamespace(name="bare"),
        "touch": SimpleNamespace(
            free_amplitude=2.5e-6, kept=0.8, law=law, sharing=sharing, impedance=1.5 - 2j
        ),
        "relative_friction": 0.4, "model": "a-model", "relative_friction_limits": (0.35, 0.45),
        "speed": 0.1, "mode": None, "place_was_asked": False,
        "summary": lambda: {"tangential_force_N": 0.08},
    }  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


def test_a_map_goes_over_amplitudes_and_forces(stator: Display) -> None:
    found = friction_map(prediction(), 5)
    # At the least 3 µm, else twice the working amplitude; a tenth to four times the force.
    assert found.amplitude == pytest.approx(1e-6 * np.arange(5))
    assert found.normal_force[[0, -1]] == pytest.approx([0.05, 2.0])
    assert np.diff(np.log(found.normal_force)) == pytest.approx(np.full(4, np.log(40) / 4))
    assert found.model == "partial-levitation"
    expected = 1 - 0.05 * 1e6 * found.amplitude[None, :] / found.normal_force[:, None]
    # Where the asperities are pressed through a row ends; what was before it stays.
    expected[-1, 3:] = np.nan
    assert found.relative_friction == pytest.approx(expected, abs=1e-12, nan_ok=True)
    small = friction_map(prediction(vibration_amplitude=1e-6), 4)
    assert small.amplitude == pytest.approx(1e-6 * np.arange(4))
    assert friction_map(prediction()).relative_friction.shape == (40, 40)


@pytest.mark.parametrize(
    ("model", "mapped"),
    [
        ("levitation-2016", "levitation-2016"),
        ("partial-levitation", "partial-levitation"),
        ("paper2008", "levitation"),
        ("paper2008-printed", "levitation"),
    ],
)
def test_a_map_is_by_a_model_that_balances_loads(stator: Display, model: str, mapped: str) -> None:
    assert friction_map(prediction(law=Law(model)), 2).model == mapped


def test_the_ripple_is_of_the_standing_wave_under_the_finger() -> None:
    law = SimpleNamespace(
        ripple=lambda amplitude: ("ripple", amplitude), place=None, kind=MODEL_KINDS["levitation"]
    )
    assert friction._ripple(prediction(law=law)) == ("ripple", 2e-6)
    # A model that holds the gap has no balance that could ripple.
    assert friction._ripple(prediction(law=law, touch=SimpleNamespace(law=None))) is None
    # At a place of the face that was asked for the wave is no even one.
    assert friction._ripple(prediction(law=law, place_was_asked=True)) is None


@pytest.mark.parametrize("model", MODEL_KINDS)
def test_a_friction_is_analysed_by_every_model(stator: Display, model: str) -> None:
    result = analyze_friction(stator, model=model, samples=0)
    assert result.summary()["model"] == model
    # The paper's models know the finger over an antinode only: no wave is felt by them.
    assert (result.ripple is None) == model.startswith("paper2008")


@pytest.fixture
def parts(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Every part of an analysis by its name, and what it was asked."""
    asked: list[Any] = []

    def stand_in(name: str, answer: Any) -> None:
        def asked_for(*given: Any, **named: Any) -> Any:
            asked.append((name, given, named))
            return answer

        monkeypatch.setattr(friction, name, asked_for)

    stand_in("predict", PREDICTION)
    stand_in("wanted_friction", "the wanted")
    names = ("model_curves", "friction_map", "_ripple", "judged_area")
    for name in names:
        stand_in(name, f"the {name}")
    stand_in("interval_or_reason", ("the interval", "a reason"))
    stand_in("friction_verdict", (Finding("doubt", "the verdict"),))
    monkeypatch.setattr(friction, "why_not_good", lambda display, p: None)
    return asked


PREDICTION = prediction(law=SimpleNamespace(kind=MODEL_KINDS["partial-levitation"]))


def test_an_analysis_passes_on_what_was_asked(stator: Display, parts: list[Any]) -> None:
    told: list[str] = []
    said = told.append
    found = analyze_friction(
        stator, voltage=100.0, frequency=41e3, normal_force=0.3, surface="bare",
        model="levitation-2016", position=1e-3, speed=0.1, ambient_pressure=5e4,
        wanted_friction=0.6, samples=16, seed=9, points=7, progress=said,
    )  # fmt: skip
    thin = dataclasses.replace(stator, gas=stator.gas.at_pressure(5e4))
    point = {"frequency": 41e3, "normal_force": 0.3, "surface": "bare", "model": "levitation-2016"}
    point |= {"display": thin, "place": None}
    more = {"voltage": 100.0, "vibration_amplitude": None, "position": 1e-3}
    assert parts == [
        ("predict", (), point | more | {"speed": 0.1, "pace": NO_HURRY}),
        (
            "wanted_friction", (thin, PREDICTION, 0.6),
            {"samples": 16, "seed": 9, "progress": said},
        ),
        ("model_curves", (PREDICTION,), {}),
        ("friction_map", (PREDICTION, 7), {}),
        (
            "interval_or_reason", (thin, PREDICTION),
            {"samples": 16, "seed": 9, "progress": said},
        ),
        ("judged_area", (thin, PREDICTION), {"samples": 16, "seed": 9}),
        ("_ripple", (PREDICTION,), {}),
        ("friction_verdict", (PREDICTION, "the interval", "a reason", "the judged_area"), {}),
    ]  # fmt: skip
    assert (found.display, found.prediction) == (thin, PREDICTION)
    assert (found.curves, found.map, found.uncertainty, found.ripple) == (
        "the model_curves", "the friction_map", "the interval", "the _ripple",
    )  # fmt: skip
    assert found.wanted == "the wanted"
    assert found.verdict == (Finding("doubt", "the verdict"),)
    assert found.active_area == "the judged_area"
    assert told == [
        "amplitude and load balance", "models side by side", "map over amplitude and force",
        "ripple of the standing wave, and the active area",
    ]  # fmt: skip


def test_what_is_not_asked_for_is_not_computed(stator: Display, parts: list[Any]) -> None:
    found = analyze_friction(stator, vibration_amplitude=2e-6, samples=0)
    assert [name for name, *_ in parts] == [
        "predict", "model_curves", "friction_map", "interval_or_reason",
        "judged_area", "_ripple", "friction_verdict",
    ]  # fmt: skip
    assert parts[0][2]["display"] is stator
    assert parts[0][2]["vibration_amplitude"] == 2e-6
    assert parts[0][2]["speed"] is None
    assert parts[3][2]["samples"] == 0
    assert found.wanted is None


def test_a_summary_has_every_number_under_its_name(stator: Display) -> None:
    curve = ModelCurve("paper2008", np.array([1e-6, 3e-6]), np.array([0.8, 0.4]))
    unsure = SimpleNamespace(interval=(0.3, 0.5), level=0.9, summary=lambda: {"seed": 1})
    found: Any = FrictionAnalysis(
        stator, PREDICTION, (curve,), unsure, None, SimpleNamespace(ripple=0.07),  # type: ignore[arg-type]
        Wanted(0.6, 1.4e-6, 12.0), (Finding("limit", "open"),),
    )  # fmt: skip
    said = found.summary()
    assert said.pop("provenance")["config_sha256"]
    assert said == {
        "tangential_force_N": 0.08, "ambient_pressure_Pa": 1e5, "active_area": None,
        "free_amplitude_m": 2.5e-6, "amplitude_kept": 0.8,
        "relative_friction_interval": [0.3, 0.5], "interval_level": 0.9,
        "relative_friction_limits": {
            "each_ridge_at_its_own_balance": 0.35, "all_ridges_at_one_mean_gap": 0.45,
        },
        "load_shares": {
            "film": 0.6, "asperities": 0.4, "mean_gap_m": 1.5e-6, "residual": 1e-9,
            "relative_friction_error": 1e-3,
        },
        "standing_wave_ripple": 0.07,
        "wanted": {
            "relative_friction": 0.6, "vibration_amplitude_m": 1.4e-6, "voltage_V": 12.0,
            "why_not": "", "why_no_interval": "",
        },
        # In the middle of 0.8 at 1 µm and 0.4 at 3 µm.
        "models": [{"model": "paper2008", "relative_friction": pytest.approx(0.6)}],
        "measurements_missed": None, "uncertainty": {"seed": 1},
        "verdict": [{"kind": "limit", "text": "open"}],
    }  # fmt: skip


def test_a_summary_says_none_where_there_is_nothing(stator: Display) -> None:
    p = prediction(
        relative_friction_limits=None,
        touch=SimpleNamespace(free_amplitude=2e-6, kept=1.0, sharing=None, impedance=None),
    )
    none: Any = None
    said = FrictionAnalysis(
        stator, p, (), none, none, none, none, (Finding("doubt", ""),)
    ).summary()
    for name in ("relative_friction_interval", "interval_level", "relative_friction_limits",
                 "load_shares", "standing_wave_ripple", "wanted", "uncertainty"):  # fmt: skip
        assert said[name] is None, name


def test_a_verdict_on_a_mode_that_is_not_driven_is_not_good(
    parts: list[Any], stator: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(friction, "friction_verdict", lambda *about: (Finding("good", "Fine."),))
    monkeypatch.setattr(friction, "why_not_good", lambda display, p: "It is not driven.")
    found = analyze_friction(stator, samples=0)
    assert found.verdict == (Finding("limit", "Fine. It is not driven."),)
