"""What is made of a friction curve, of a folder of them, and of a finger, with a display that is
made up."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.measure.fits.friction import friction_curve, friction_scores
from squeezefilm.measure.fits.friction.friction_curve import compare_friction_curve
from squeezefilm.measure.fits.friction.friction_scores import with_finger
from squeezefilm.measure.recordings.kinds import (
    DetectionThresholds,
    FingertipImpedances,
    FrictionCurve,
    FrictionDecays,
    Told,
)
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL, MODEL_KINDS
from squeezefilm.physics.display import load_display
from squeezefilm.validation import populations, published_friction
from squeezefilm.validation.published_friction import compare_folder

DISPLAY = load_display("biet2008-plate")
AMPLITUDE = np.array([0.0, 0.5e-6, 1e-6, 1.5e-6])
CURVE = FrictionCurve(
    AMPLITUDE,
    np.array([0.8, 0.6, 0.4, 0.24]),
    30e3,
    0.5,
    0.02,
    np.full(4, 0.02),
    told=Told(name="mine"),
    display="biet2008-plate",
)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, float]]:
    """What is predicted: every law falls by 0.4 per µm from 1, 10 % wide to either side; one model
    refuses all amplitudes above 1.2 µm."""
    every: list[dict[str, float]] = []

    def fall(amplitude: Any, refuses: bool) -> Any:
        if refuses and np.max(amplitude) > 1.2e-6:
            raise OutOfRangeError("beyond its range")
        return 1.0 - 0.4e6 * np.asarray(amplitude)

    def law(model: str) -> Any:
        refuses = model != DEFAULT_MODEL
        return SimpleNamespace(
            curve=lambda amplitude: fall(amplitude, refuses),
            at=lambda amplitude: float(fall(amplitude, refuses)),
        )

    def predict(display: Any, **how: float) -> Any:
        assert display.name == "biet2008-plate"
        every.append(how)
        return SimpleNamespace(law=SimpleNamespace(by=law))

    def bands(_display: Any, _prediction: Any, amplitude: Any, levels: Any, **how: Any) -> Any:
        how["progress"]("draws", 0.5)
        middle = fall(amplitude, False)
        return [
            SimpleNamespace(low=middle - 0.1 * level, high=middle + 0.1 * level) for level in levels
        ]

    monkeypatch.setattr(friction_curve, "predict", predict)
    monkeypatch.setattr(friction_curve, "friction_bands", bands)
    return every


def test_a_curve_is_compared_at_its_own_conditions_and_its_rest_is_fitted(
    asked: list[dict[str, float]],
) -> None:
    told: list[str] = []
    found = compare_friction_curve(CURVE, told.append)
    assert asked == [
        {"vibration_amplitude": 1.5e-6, "frequency": 30e3, "normal_force": 0.5, "speed": 0.02}
    ]
    assert found.display == "biet2008-plate"
    assert found.assumed == ()
    # Twice 0.4 in place of 0.8: as the law, with 0.8 at rest, falls as the curve does but its end.
    model = next(score for score in found.models if score.model == DEFAULT_MODEL)
    assert model.friction / found.fitted_at_rest == pytest.approx([1.0, 0.8, 0.6, 0.4])
    assert found.band.low == pytest.approx(np.array([1.0, 0.8, 0.6, 0.4]) - 0.1 * found.band.level)
    relative = CURVE.friction / found.fitted_at_rest
    inside = np.abs(relative - np.array([1.0, 0.8, 0.6, 0.4])) <= 0.1 * found.band.level
    assert found.inside_levels[-1].tolist() == inside.tolist()
    # What a model refuses it does not answer, and what it answers is kept.
    other = next(
        score for score in found.models if score.model in MODEL_KINDS and score is not model
    )
    assert np.isnan(other.friction).tolist() == [False, False, False, True]
    # The half of its draws is three quarters of the whole.
    assert [text.partition(" (")[0] for text in told] == [
        "mine: the working mode of biet2008-plate", *(f"mine: {model}" for model in MODEL_KINDS),
        "draws",
    ]  # fmt: skip
    assert told[-1].startswith("draws (75 %")


def test_what_a_recording_does_not_tell_is_the_displays(asked: list[dict[str, float]]) -> None:
    found = compare_friction_curve(replace(CURVE, normal_force=None, speed=None), display=DISPLAY)
    finger = DISPLAY.finger
    assert found.assumed == ("normal_force", "speed")
    assert (found.normal_force, found.speed) == (finger.normal_force, finger.speed)
    (how,) = asked
    assert (how["normal_force"], how["speed"]) == (finger.normal_force, finger.speed)


def test_points_of_other_conditions_are_predicted_apart(asked: list[dict[str, float]]) -> None:
    found = compare_friction_curve(replace(CURVE, speed=np.array([0.02, 0.05, 0.02, 0.05])))
    assert [(how["speed"], how["vibration_amplitude"]) for how in asked] == [
        (0.02, 1e-6), (0.05, 1.5e-6),
    ]  # fmt: skip
    # The model that refuses 1.5 µm answers at the slower speed alone, and 0.5 µm at the other.
    other = next(
        score
        for score in found.models
        if score.model in MODEL_KINDS and score.model != DEFAULT_MODEL
    )
    assert np.isnan(other.friction).tolist() == [False, False, False, True]


def check(recording: Any, kind: str) -> Any:
    return SimpleNamespace(recording=recording, kind=kind)


def recording(kind: type, name: str) -> Any:
    """A recording of a kind, of which nothing is known but its name."""
    made: Any = kind.__new__(kind)
    object.__setattr__(made, "told", Told(name=name))
    object.__setattr__(made, "display", f"display of {name}")
    return made


def folder_of(monkeypatch: pytest.MonkeyPatch, *checks: Any, refused: Any = ()) -> list[Any]:
    """A folder of recordings; every comparison is its arguments."""
    did: list[Any] = []

    def kept(name: str, answer: Any) -> Any:
        def do(*said: Any) -> Any:
            did.append((name, *said))
            return answer(said[0])

        return do

    found = SimpleNamespace(checks=checks, refused=refused)
    monkeypatch.setattr(published_friction, "check_folder", lambda _: found)
    monkeypatch.setattr(
        published_friction, "display_of", lambda name, display: f"{name}: {display}"
    )
    for name, answer in (
        ("rest_friction", lambda _: None),
        ("compare_detection", lambda _: "a detection"),
        ("compare_friction_curve", lambda of: SimpleNamespace(curve=of, models=("a model",))),
        ("compare_decays", lambda _: "decays"),
        ("compare_impedances", lambda _: ["damping", "mass"]),
        ("total_scores", lambda curves: ("total", len(curves))),
    ):
        monkeypatch.setattr(published_friction, name, kept(name, answer))
    return did


def test_each_kind_in_a_folder_is_compared_by_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    of = {
        kind: recording(kind, kind.__name__)
        for kind in (FrictionDecays, DetectionThresholds, FingertipImpedances, FrictionCurve)
    }
    other = check(SimpleNamespace(), "impedance")
    did = folder_of(monkeypatch, other, *(check(one, "x") for one in of.values()))
    told = print
    found = compare_folder("here", told)
    assert found.detections == ("a detection",)
    assert found.populations == ("decays", "damping", "mass")
    assert found.totals == ("total", 1)
    assert [one.curve for one in found.curves] == [of[FrictionCurve]]

    def shown(kind: type) -> str:
        return f"{kind.__name__}: display of {kind.__name__}"

    curve = of[FrictionCurve]
    assert did[1:] == [
        # A curve that cannot be compared is refused before anything is computed.
        ("rest_friction", curve),
        ("compare_decays", of[FrictionDecays], shown(FrictionDecays), told),
        ("compare_impedances", of[FingertipImpedances], shown(FingertipImpedances)),
        ("compare_friction_curve", curve, told, shown(FrictionCurve)),
        ("total_scores", [curve], [("a model",)]),
    ]


def test_a_folder_without_curves_has_no_totals(monkeypatch: pytest.MonkeyPatch) -> None:
    thresholds = recording(DetectionThresholds, "t")
    folder_of(monkeypatch, check(thresholds, "detection thresholds"))
    found = compare_folder("here")
    assert (found.curves, found.totals, found.populations) == ((), (), ())


def test_a_folder_of_other_kinds_or_with_a_torn_file_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    others = [check(SimpleNamespace(), kind) for kind in ("ring-down", "impedance", "ring-down")]
    folder_of(monkeypatch, *others)
    with pytest.raises(InputError, match="no friction curve, only: impedance, ring-down"):
        compare_folder("here")
    folder_of(monkeypatch, *others, refused=[SimpleNamespace(why="torn"), SimpleNamespace(why="x")])
    with pytest.raises(InputError, match=r"^torn$"):
        compare_folder("here")


def test_fingertips_are_compared_where_they_were_pressed(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    impedance: complex | None = 3.0 - 12.0j

    def predict(display: Any, **how: float) -> Any:
        asked.append((display.name, how))
        touch = SimpleNamespace(impedance=impedance)
        return SimpleNamespace(touch=touch, law=SimpleNamespace(model="a model"))

    monkeypatch.setattr(populations, "predict", predict)
    touches = FingertipImpedances(
        np.array([2.0, 3.0, 4.5]), np.array([1e-4, 2e-4, 3e-4]), 25e3, 0.8, told=Told(name="tips")
    )
    damping, mass = populations.compare_impedances(touches, DISPLAY)
    assert asked == [
        ("biet2008-plate",
         {"vibration_amplitude": 0.1e-6, "frequency": 25e3, "normal_force": 0.8})
    ]  # fmt: skip
    assert damping.models == (("a model", pytest.approx(3.0)),)
    # An impedance of −12j is a stiffness: a mass below zero.
    assert mass.models == (("a model", pytest.approx(-12.0 / (2 * np.pi * 25e3))),)
    assert (mass.measured is touches.mass, mass.unit, damping.unit) == (True, "kg", "N*s/m")
    assert "25000 Hz, 0.8 N" in damping.conditions
    impedance = None
    for one in populations.compare_impedances(touches, DISPLAY):
        assert one.models == (("a model", None),)


def test_a_finger_is_taken_from_a_curve_of_one_condition(monkeypatch: pytest.MonkeyPatch) -> None:
    curve = CURVE
    monkeypatch.setattr(friction_scores, "read_recording", lambda _: curve)
    assert with_finger(DISPLAY, "new") is DISPLAY
    with pytest.raises(InputError, match="'thumb' is no finger; allowed are new, mean, and a file"):
        with_finger(DISPLAY, "thumb")
    curve = replace(CURVE, speed=np.array([0.02, 0.05, 0.02, 0.05]))
    with pytest.raises(InputError, match="mixes forces, speeds or frequencies"):
        with_finger(DISPLAY, "mine.toml")
    monkeypatch.setattr(friction_scores, "read_recording", lambda _: "a ring-down")
    with pytest.raises(InputError, match=r"mine\.toml holds no friction curve"):
        with_finger(DISPLAY, Path("mine.toml"))
