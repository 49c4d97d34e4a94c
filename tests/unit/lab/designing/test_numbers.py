"""What the Design area shows of a display, from predictions made by hand or by a closed form."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.progress import Pace
from squeezefilm.lab.designing import numbers
from squeezefilm.lab.designing.form import display_of, edited, form, preset_text
from squeezefilm.lab.designing.numbers import DesignPoint, designed, opened, outline, predicted
from squeezefilm.physics.chain.area_map import active_area
from squeezefilm.physics.chain.friction import where_known
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.uncertainty.uncertainty import FrictionBand

STATOR, DISC = preset_text("biet2008-stator"), preset_text("winfield2007-tpad")
GLASS = preset_text("touchpad-glass")


def test_an_opened_display_is_its_text_and_all_that_its_form_shows() -> None:
    display = display_of(STATOR)
    assert opened(STATOR) == {
        "text": STATOR, "name": "biet2008-stator", "title": display.title,
        "form": form(STATOR), "outline": outline(STATOR), "calibration": None, "covered": {},
    }  # fmt: skip
    new = edited(STATOR, "drive.voltage", "99 V")
    assert numbers.changed(STATOR, "drive.voltage", "99 V") == opened(new)


def test_bodies_are_drawn_from_their_sizes() -> None:
    found = outline(GLASS)
    patches = found.pop("patches")
    sizes = {"length_m": 0.1, "width_m": 0.06, "thickness_m": pytest.approx(1.1e-3)}
    assert found == {"kind": "plate", **sizes}
    strip = {
        "x_m": 0.0, "length_m": 0.1, "width_m": 5e-3, "thickness_m": 0.5e-3, "face": "bottom",
        "electrode": "driven", "poling": 1, "shunt_resistance_ohm": None,
    }  # fmt: skip
    assert patches == [
        {**strip, "y_m": 0.0, "polarity": 1}, {**strip, "y_m": 0.055, "polarity": -1},
    ]  # fmt: skip
    assert outline(DISC) == {"kind": "disc", "diameter_m": 0.025}
    ring = {"kind": "ring", "diameter_m": pytest.approx(53.57e-3), "radial_width_m": 0.01}
    assert outline(STATOR) == ring


def test_a_body_of_another_kind_is_not_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    other = SimpleNamespace(actuator=SimpleNamespace(type="drum"))
    monkeypatch.setattr(numbers, "display_of", lambda _: other)
    with pytest.raises(InputError, match="type 'drum' cannot be drawn"):
        outline("")


def test_an_edit_is_made_on_the_way_only_where_there_is_one() -> None:
    assert DesignPoint(text=STATOR).edited() == STATOR
    assert DesignPoint(text=STATOR, path="drive.voltage").edited() == STATOR
    assert DesignPoint(text=STATOR, value="99 V").edited() == STATOR
    found = DesignPoint(text=STATOR, path="drive.voltage", value="99 V").edited()
    assert found == edited(STATOR, "drive.voltage", "99 V")


def test_a_stators_numbers_are_the_predictions_own() -> None:
    found = designed(
        DesignPoint(text=STATOR, voltage="100 V", surface="bare", force="0.7 N"), "screening"
    )
    display = display_of(STATOR)
    p = predict(display, voltage=100.0, normal_force=0.7, surface="bare")
    mode = p.mode
    expected: dict[str, Any] = {
        "text": STATOR, "quality": "screening", "name": "biet2008-stator", "title": display.title,
        "surface": "bare", "surfaces": [one.name for one in display.surfaces], "voltage_V": 100.0,
        "normal_force_N": 0.7, "mode": mode.label,
        "resonance_frequency_Hz": mode.resonance_frequency,
        "resonance_frequency_error_Hz": mode.frequency_error,
        "quality_factor": mode.quality_factor, "half_wavelength_m": mode.half_wavelength,
        "amplitude_per_volt_m_per_V": mode.amplitude_per_volt,
        "free_amplitude_m": p.touch.free_amplitude,
        "vibration_amplitude_m": p.vibration_amplitude, "squeeze_number": p.squeeze_number,
        "relative_friction": p.relative_friction, "friction_coefficient": p.friction_coefficient,
        "friction_reduction": p.friction_reduction, "tangential_force_N": p.tangential_force,
        "envelope_time_constant_s": pytest.approx(
            mode.quality_factor / (math.pi * mode.resonance_frequency)
        ),
        "vibration_model": p.amplitude_model, "friction_model": p.model,
        "warnings": list(p.warnings),
    }  # fmt: skip
    assert {key: found[key] for key in expected} == expected
    assert set(found) - set(expected) == {
        "friction_curve", "response", "line", "shape", "provenance", "since_screening",
        # What every prediction says of itself beside.
        "display", "frequency_Hz", "amplitude_model", "mean_pressure", "mean_pressure_error",
        "amplitude_kept_under_finger", "finger_impedance_N_s_per_m", "finger_speed_m_per_s", "heat",
        "model", "validity", "objections", "drive_electronics", "place", "active_area",
        "neighbour",
    }  # fmt: skip
    area, whole = found["active_area"], active_area(display, p.mode, p.law, p.drive)
    assert whole is not None
    assert {key: area[key] for key in whole.summary()} == whole.summary()
    assert area["said"] == whole.sentence
    assert len(area["map"]["relative_friction"]) == area["map"]["columns"] * area["map"]["rows"]
    assert np.nanmin(area["map"]["relative_friction"]) >= round(whole.best or 0.0, 4)
    curve = found["friction_curve"]
    amplitude = np.linspace(0.0, max(2 * p.vibration_amplitude, 2e-6), 49)
    np.testing.assert_allclose(curve["amplitude_m"], amplitude, rtol=1e-12)
    assert curve["relative_friction"] == pytest.approx(p.law.curve(amplitude), nan_ok=True)
    assert len(curve["paper2008"]) == 49
    response = found["response"]
    assert len(response["frequency_Hz"]) == 121
    told = mode.response(np.array(response["frequency_Hz"]))
    assert response["amplitude_per_volt_m_per_V"] == pytest.approx(told)
    assert found["shape"] is None


def test_a_plate_has_no_area_before_it_is_solved() -> None:
    found = designed(DesignPoint(text=preset_text("biet2008-plate")), "screening")
    assert found["active_area"] is None


def test_the_line_of_a_stator_is_the_wave_round_its_mean_circumference() -> None:
    line = designed(DesignPoint(text=STATOR), "screening")["line"]
    length, wave = math.pi * 53.57e-3, 18.7e-3
    np.testing.assert_allclose(line["position_m"], np.linspace(0.0, length, 241), rtol=1e-9)
    expected = np.cos(2 * math.pi * np.array(line["position_m"]) / wave)
    np.testing.assert_allclose(line["deflection"], expected, atol=1e-9)
    nodes = np.array(line["nodal_positions_m"])
    # Two in each of nine waves, half a wave apart.
    assert nodes.size == 18
    np.testing.assert_allclose(nodes, wave * (0.25 + 0.5 * np.arange(18)), rtol=1e-9)
    assert line["along"] == "x"


def test_a_plates_line_is_thinned_out_and_lies_where_its_nodal_lines_cross() -> None:
    position = np.linspace(0.0, 0.1, 9)
    line = SimpleNamespace(
        position=position, deflection=np.cos(60 * position), nodal_positions=np.array([0.02, 0.08])
    )
    p: Any = SimpleNamespace(mode=SimpleNamespace(line=line))
    glass, plate = display_of(GLASS).actuator, display_of(preset_text("biet2008-plate")).actuator
    along = {"position_m": [0.0, 0.05, 0.1], "nodal_positions_m": [0.02, 0.08]}
    found = numbers._line(p, glass)
    assert found == {
        "along": "y", **along, "deflection": pytest.approx(np.cos(60 * position[::4]))
    }  # fmt: skip
    found = numbers._line(p, plate)
    assert found is not None
    assert found["along"] == "x"
    none: Any = SimpleNamespace(mode=SimpleNamespace(line=None))
    assert numbers._line(none, plate) is None


def test_a_solved_shape_is_told_row_by_row_and_one_at_its_highest_point() -> None:
    asked: list[Any] = []

    def field(index: int, x: Any, y: Any, z: float) -> Any:
        asked.append((index, x, y, z))
        height = -2.0 * np.cos(40 * x)[:, None] * np.cos(30 * y)[None, :]
        return np.stack([height * 7, height * 9, height], axis=-1)

    plate = SimpleNamespace(length=0.1, width=0.06, thickness=1e-3)
    solid = SimpleNamespace(modes=SimpleNamespace(plate=plate, field=field), index=5)
    p: Any = SimpleNamespace(mode=SimpleNamespace(solid=solid))
    found = numbers._shape(p)
    assert found is not None
    assert (found["columns"], found["rows"]) == (84, 42)
    ((index, x, y, z),) = asked
    assert (index, z) == (5, 1e-3)
    np.testing.assert_allclose(x, np.linspace(0, 0.1, 84))
    np.testing.assert_allclose(y, np.linspace(0, 0.06, 42))
    expected = -np.cos(40 * x)[None, :] * np.cos(30 * y)[:, None]
    deflection = np.array(found["deflection"]).reshape(42, 84)
    np.testing.assert_allclose(deflection, expected, atol=0.51e-4)
    assert np.abs(deflection).max() == 1.0
    # Four digits are enough for a picture.
    assert all(round(one, 4) == one for one in found["deflection"])


@pytest.mark.parametrize(
    ("text", "quality", "theory"),
    [
        (GLASS, "screening", "timoshenko"),
        (GLASS, "solved", "solid"),
        (STATOR, "screening", None),
        (DISC, "solved", None),
    ],
)
def test_a_quality_is_a_theory_for_plates_only(
    monkeypatch: pytest.MonkeyPatch, text: str, quality: str, theory: str | None
) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(numbers, "predict", lambda display, **how: asked.append((display, how)))
    predicted(display_of(text), quality, DesignPoint(text=text))
    predicted(
        display_of(text),
        quality,
        DesignPoint(text=text, voltage="0.1 kV", surface="bare", force="300 mN"),
    )
    nothing = {"voltage": None, "normal_force": None, "surface": None, "theory": theory}
    given = {"voltage": 100.0, "normal_force": 0.3, "surface": "bare", "theory": theory}
    assert asked == [(display_of(text), nothing), (display_of(text), given)]
    with pytest.raises(InputError, match="quality"):
        predicted(display_of(text), "rough", DesignPoint(text=text))


def test_a_curve_of_the_papers_model_is_left_out_where_it_does_not_hold() -> None:
    law = predict(display_of(STATOR)).law.by("paper2008")
    # No law stands for an amplitude that is none.
    known = where_known(law.curve, np.array([0.0, -1e-6, 1e-6]))
    assert np.isfinite(known).tolist() == [True, False, True]
    assert known[2] == law.at(1e-6)


def test_a_solved_plate_is_told_of_while_it_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    solved: list[Any] = []

    def solid(actuator: Any, *, pace: Pace) -> None:
        solved.append(actuator)
        assert pace.tell is not None
        pace.tell("sweeping", 0.5)

    told: list[Any] = []
    asked: list[Any] = []

    def beam(display: Any, quality: str, point: DesignPoint) -> Any:
        asked.append((display, quality, point))
        return predicted(display, "screening", point)

    monkeypatch.setattr(numbers, "solid_mode", solid)
    monkeypatch.setattr(numbers, "tell", lambda *said: told.append(said))
    monkeypatch.setattr(numbers, "predicted", beam)
    point = DesignPoint(text=GLASS, voltage="10 V", path="drive.voltage", value="99 V")
    text = edited(GLASS, "drive.voltage", "99 V")
    found = designed(point, "solved")
    assert (found["text"], found["quality"], found["voltage_V"]) == (text, "solved", 10.0)
    assert asked[0] == (display_of(text), "solved", point)
    assert solved == [display_of(text).actuator]
    assert found["drive_electronics"] is None  # a beam has no admittance
    assert told == [("sweeping", 0.5)]
    # Neither a beam nor what is no plate is solved ahead, nor a stator fitted.
    loads: list[Any] = []
    monkeypatch.setattr(numbers, "load_of_mode", lambda *given: loads.append(given[0]))
    designed(point, "screening")
    assert loads == []
    designed(DesignPoint(text=STATOR), "solved")
    assert len(solved) == 1


def test_a_band_lies_on_every_third_amplitude_of_the_curve(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def banded(display: Any, p: Any, amplitude: Any, *, samples: int, progress: Any) -> Any:
        asked.append((display, p.voltage, samples))
        low = np.where(amplitude > 0, 0.3, np.nan)
        return (FrictionBand(amplitude, low, low + 0.2, level=0.9, samples=samples - 1),)

    monkeypatch.setattr(numbers, "friction_bands", banded)
    point = DesignPoint(text=STATOR, voltage="100 V")
    found = numbers.banded(point, "screening")
    assert asked == [(display_of(STATOR), 100.0, 64)]
    curve = designed(point, "screening")["friction_curve"]
    assert found["amplitude_m"] == curve["amplitude_m"][::3]
    assert found["low"] == [None] + [0.3] * 16
    assert found["high"] == [None] + [0.5] * 16
    assert (found["level"], found["samples"]) == (0.9, 63)
    point = DesignPoint(text=STATOR, voltage="100 V", path="finger.contact_length", value="8 mm")
    numbers.banded(point, "screening")
    assert asked[1:] == [(display_of(point.edited()), 100.0, 64)]


@pytest.mark.slow
def test_a_solved_plate_says_what_its_amplifier_gives() -> None:
    load = designed(DesignPoint(text=preset_text("biet2008-plate")), "solved")["drive_electronics"]
    assert load["channels"] == 7
    assert load["real_power_W"] == pytest.approx(load["matched_current_A"] * 15 / 2)


def test_a_solved_plate_that_was_screened_otherwise_says_why(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def prediction(amplitude: float, frequency: float) -> Any:
        return SimpleNamespace(
            vibration_amplitude=amplitude, mode=SimpleNamespace(resonance_frequency=frequency)
        )

    display, point = display_of(preset_text("touchpad-glass")), DesignPoint(text="")
    monkeypatch.setattr(numbers, "predicted", lambda *_: prediction(1.35e-6, 40e3))
    said = numbers._since_screening(display, prediction(5.77e-6, 39e3), point)
    assert "gave 1.35 µm at 40 kHz; the full solution gives 5.77 µm at 39 kHz" in said
    assert "a uniform beam, which is right to 13 %" in said
    assert numbers._since_screening(display, prediction(1.5e-6, 39e3), point) == ""
    disc = display_of(preset_text("winfield2007-tpad"))
    assert numbers._since_screening(disc, prediction(5.77e-6, 39e3), point) == ""
