"""What is said of a value that cannot be right, and of one that is doubtful."""

import dataclasses
from pathlib import Path

import pytest
from tests.unit.physics.plausibility.described import changed

from squeezefilm.core import presets
from squeezefilm.core.errors import ConfigError
from squeezefilm.physics.chain import touch
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.chain.wanted_voltage import voltage_for_friction
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.layout import GlueLayer
from squeezefilm.physics.plausibility.checks import foreseen, implausibilities, require_plausible
from squeezefilm.physics.plausibility.expected import ratios

PLATE = "biet2008-plate"


def with_value(path: str, value: float, name: str = PLATE) -> Display:
    parts = tuple(int(part) if part.isdigit() else part for part in path.split("."))
    out: Display = changed(load_display(name), parts, value)
    return out


@pytest.mark.parametrize(
    ("path", "value", "meant"),
    [
        ("actuator.substrate.density", 2.7, "2700 kg/m3"),
        ("actuator.substrate.density", 8.25, "8250 kg/m3"),
        ("actuator.substrate.young_modulus", 70e6, "70 GPa"),
        ("actuator.thickness", 0.9, "900 µm"),
        ("actuator.ceramic.density", 7.7, "7700 kg/m3"),
        ("actuator.ceramic.in_plane_stiffness", 67.9e6, "67.9 GPa"),
        ("finger.contact_length", 10e-6, "10 mm"),
    ],
)
def test_a_slip_of_unit_is_refused_with_what_is_meant(path: str, value: float, meant: str) -> None:
    with pytest.raises(ConfigError) as caught:
        require_plausible(with_value(path, value))
    assert caught.value.key == path
    assert "cannot be right" in caught.value.message
    assert caught.value.message.endswith(f"Did you mean {meant}?")


def test_thick_glue_is_refused_before_any_solve(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(touch, "working_mode", None)
    base = load_display(PLATE)
    plate = dataclasses.replace(base.actuator, glue=GlueLayer(30e-3, 3e9))  # type: ignore[arg-type]
    display = dataclasses.replace(base, actuator=plate)
    for ask in (predict, lambda one: voltage_for_friction(one, 0.5)):
        with pytest.raises(ConfigError, match=r"actuator\.glue\.thickness.*Did you mean 30 µm"):
            ask(display)


def test_the_line_of_a_file_is_named(tmp_path: Path) -> None:
    text = presets.path(PLATE).read_text(encoding="utf-8").replace('"8250 kg/m3"', '"8.25 kg/m3"')
    file = tmp_path / "own.toml"
    file.write_text(text, encoding="utf-8")
    line = 1 + next(n for n, row in enumerate(text.splitlines()) if "8.25 kg/m3" in row)
    with pytest.raises(ConfigError, match=f"line {line}: actuator.substrate.density") as caught:
        foreseen(file)
    assert caught.value.file == str(file)


def test_several_are_told_at_once_with_their_lines() -> None:
    text = presets.path(PLATE).read_text(encoding="utf-8")
    display = changed(
        with_value("actuator.substrate.density", 2.7), ("finger", "normal_force"), 5e3
    )
    with pytest.raises(ConfigError) as caught:
        require_plausible(display, text=text, file="own.toml")
    message = str(caught.value)
    assert message.startswith("own.toml: 2 values cannot be right:\n")
    assert "  actuator.substrate.density: 2.7 kg/m³ cannot be right" in message
    assert "  finger.normal_force: 5 kN cannot be right" in message
    assert message.count("(line ") == 2


def test_what_follows_from_a_value_that_cannot_be_right_is_not_told_again() -> None:
    # The wave speed of such a plate cannot be right either.
    keys = [one.key for one in implausibilities(with_value("actuator.substrate.density", 2.7))]
    assert keys == ["actuator.substrate.density"]


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        ("actuator.nodal_lines", 4, "the expected frequency is 7.37 kHz, which is doubtful"),
        ("actuator.substrate.young_modulus", 12.3e9, "the wave speed of the substrate is"),
        ("drive.voltage", 150.0, "the expected power per mass is 11.2 W/g, which is doubtful"),
        ("thermal.coercive_field", 1e5, "0.1 kV/mm is doubtful"),
        ("gas.mean_free_path", 670e-9, "the mean free path over the kinetic one is 10"),
        ("actuator.patches.3.width", 4.9e-3, "the ceramic size over its neighbours' is 0.1"),
        ("finger.plateau_width", 25e-6, "the plateau over ridge period is 0.0714"),
    ],
)
def test_a_doubtful_value_is_told_and_not_refused(path: str, value: float, said: str) -> None:
    display = with_value(path, value)
    key = path.replace("patches.3", "patches.4")
    doubts = require_plausible(display)
    assert any(said in one for one in doubts), doubts
    assert [one.refused for one in implausibilities(display)] == [False] * len(doubts)
    assert any(one.startswith(f"{key}: ") for one in doubts) or "wave speed" in said


def test_the_voltage_that_is_asked_for_counts() -> None:
    display = load_display(PLATE)
    assert require_plausible(display) == require_plausible(display, 15.0) == ()
    assert any("per mass" in one for one in require_plausible(display, 150.0))
    assert require_plausible(display, 0.0) == ()


def test_ratios_are_of_the_actuator_that_there_is() -> None:
    stator = {one.of for one in ratios(load_display("biet2008-stator"))}
    assert "speed of the stator's wave" in stator
    assert "wave speed of the substrate" not in stator
    disc = {one.of for one in ratios(load_display("winfield2007-tpad"))}
    assert "expected frequency" in disc
    assert "area of ceramics over that of the plate" not in disc


def test_a_prediction_carries_what_is_doubtful_as_an_objection() -> None:
    p = predict(with_value("actuator.nodal_lines", 4), theory="timoshenko")
    assert len(p.objections) == 1
    assert "people hear it" in p.objections[0]
    assert p.warnings[0] == p.objections[0]
    assert p.summary()["objections"] == list(p.objections)
