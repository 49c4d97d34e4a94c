"""The chain: what depends on what, which model is named, and what is refused."""

import dataclasses

import numpy as np
import pytest

from squeezefilm.display import Display, load_display
from squeezefilm.errors import ContradictionError, InputError, OutOfRangeError
from squeezefilm.prediction import friction_law, predict, relative_friction_curve


@pytest.fixture(scope="module")
def plate() -> Display:
    return load_display("biet2008-plate")


@pytest.fixture(scope="module")
def stator() -> Display:
    return load_display("biet2008-stator")


def test_no_vibration_leaves_friction_as_it_is(plate: Display) -> None:
    still = predict(plate, voltage=0.0)
    assert still.relative_friction == 1
    assert still.mean_pressure == pytest.approx(1, abs=1e-12)
    assert still.friction_reduction == 0


def test_amplitude_is_linear_in_the_voltage_and_falls_off_resonance(plate: Display) -> None:
    full, half = predict(plate), predict(plate, voltage=7.5)
    assert half.vibration_amplitude == pytest.approx(full.vibration_amplitude / 2)
    assert half.relative_friction > full.relative_friction
    off = predict(plate, frequency=1.01 * full.mode.resonance_frequency)
    # 1/√(Q²(1−1.01²)²+1) with Q = 60
    assert off.vibration_amplitude / full.vibration_amplitude == pytest.approx(
        1 / np.sqrt((60 * (1.01**2 - 1)) ** 2 + 1), rel=1e-9
    )


def test_the_models_are_named(plate: Display, stator: Display) -> None:
    assert predict(plate).amplitude_model == "timoshenko_beam_plane_strain"
    assert predict(plate, theory="euler_bernoulli").amplitude_model.startswith("euler_bernoulli")
    assert predict(stator).amplitude_model == "measured_stator"
    assert predict(stator, vibration_amplitude=1e-6).amplitude_model == "given"
    assert predict(stator).model == "paper2008"
    assert predict(stator, model="paper2008-printed").model == "paper2008-printed"


def test_the_reduction_carries_the_base_friction(stator: Display) -> None:
    # The adhesive lowers relative friction less than the bare stator, and absolute friction more
    # only through its larger base coefficient.
    rough, bare = predict(stator, surface="adhesive"), predict(stator, surface="bare")
    assert rough.relative_friction > bare.relative_friction
    for p in (rough, bare):
        assert p.friction_reduction == pytest.approx(
            p.friction_coefficient * (1 - p.relative_friction)
        )


def test_contradicting_data_warn_or_are_refused(plate: Display) -> None:
    assert any("printed_e31" in text for text in predict(plate).warnings)
    with pytest.raises(ContradictionError):
        predict(plate, strict=True)


def test_a_model_out_of_range_warns_or_is_refused(stator: Display) -> None:
    p = predict(stator)
    assert not p.validity.holds
    assert any("σ → ∞" in text for text in p.warnings)
    with pytest.raises(OutOfRangeError, match="strict=False"):
        predict(stator, strict=True)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"voltage": -1.0}, "voltage"),
        ({"voltage": float("nan")}, "voltage"),
        ({"normal_force": 0.0}, "normal_force"),
        ({"frequency": 0.0}, "frequency"),
        ({"vibration_amplitude": -1e-6}, "vibration_amplitude"),
        ({"voltage": 1.0, "vibration_amplitude": 1e-6}, "both"),
        ({"surface": "glass"}, "adhesive, bare"),
    ],
)
def test_impossible_working_points_are_refused(
    plate: Display, arguments: dict[str, object], says: str
) -> None:
    with pytest.raises(InputError, match=says):
        predict(plate, **arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("surface", ["adhesive", "bare"])
def test_the_tabulated_law_is_within_its_stated_error(stator: Display, surface: str) -> None:
    where = stator.surface(surface)
    law = friction_law(stator, 6e-6, 9.35e-3, surface=where)
    between = np.linspace(0, 6e-6, 777)
    exact = relative_friction_curve(stator, between, 9.35e-3, surface=where)
    assert np.max(np.abs(law(between) - exact)) < 1e-4
    with pytest.raises(OutOfRangeError, match="tabulate"):
        law(np.array([6.1e-6]))


def test_force_and_roughness_act_as_they_must(stator: Display) -> None:
    a = np.linspace(0, 5e-6, 41)
    light = relative_friction_curve(stator, a, 9.35e-3, normal_force=0.3)
    heavy = relative_friction_curve(stator, a, 9.35e-3, normal_force=0.7)
    assert np.all(light[1:] < heavy[1:])
    assert np.all(np.diff(light) <= 0)
    smooth = relative_friction_curve(stator, a, 9.35e-3, surface=stator.surface("bare"))
    rough = relative_friction_curve(stator, a, 9.35e-3)
    assert np.all(smooth[1:] < rough[1:])


def test_a_display_needs_surfaces_with_different_names(plate: Display) -> None:
    with pytest.raises(InputError, match="empty"):
        dataclasses.replace(plate, surfaces=())
    twice = (plate.surfaces[0], plate.surfaces[0])
    with pytest.raises(InputError, match="same name twice"):
        dataclasses.replace(plate, surfaces=twice)
