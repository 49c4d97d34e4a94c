"""What can be asked for: names with and without units, of groups, of lists; what nobody answers."""

import math
import sys
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.sweep.answers import (
    VERBS,
    AskedNumber,
    asked_for,
    catalogue,
    numbers_of,
    without_units,
)
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display

sys.path.append(str(Path(__file__).parents[4] / "tools"))


@pytest.mark.parametrize(
    ("name", "asked"),
    [
        ("relative_friction", [("predict", "relative_friction")]),
        ("resonance_frequency", [("predict", "resonance_frequency_Hz")]),
        ("resonance_frequency_Hz", [("predict", "resonance_frequency_Hz")]),
        ("plate.current", [("plate", "current_A")]),
        ("current", [("plate", "current_A")]),
        ("plate.modes.3.frequency", [("plate", "modes.3.frequency_Hz")]),
        ("lag_m", [("render", "lag_m")]),
        ("felt.finest_period_felt", [("analyze", "felt.finest_period_felt_m")]),
        ("wanted.voltage", [("friction", "wanted.voltage_V")]),
        ("finest_period.100 mm/s", [("analyze", "finest_period_m.100 mm/s")]),
        ("sound_pressure_level.0.3 m", [("plate", "sound_pressure_level_dB.0.3 m")]),
        (
            "friction.relative_friction_interval",
            [("friction", f"relative_friction_interval.{k}") for k in (0, 1)],
        ),
        ("followed", [("followed", "frequency_Hz")]),
        ("followed.alone_per_volt", [("followed", "alone_per_volt_m_per_V")]),
    ],
)
def test_the_quickest_verb_that_knows_a_name_is_asked(
    name: str, asked: list[tuple[str, str]]
) -> None:
    assert asked_for([name]) == tuple(AskedNumber(*one) for one in asked)


def test_commas_part_names_and_none_is_asked_twice() -> None:
    found = asked_for(["relative_friction, coupling_coefficient", "relative_friction,"])
    assert [one.column for one in found] == ["relative_friction", "coupling_coefficient"]
    other = asked_for(["analyze.relative_friction"])[0]
    assert (other.column, other.unit.symbol) == ("analyze.relative_friction", "1")


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("resonance_frequency_Hz", "Hz"),
        ("finest_period_m.100 mm/s", "m"),
        ("sound_pressure_level_dB.0.3 m", "dB"),
        ("finger_impedance_N_s_per_m.0", "N*s/m"),
        ("apparent_power_VA", "VA"),
        ("spatial_frequency_per_m.0", "1/m"),
        ("amplitude_m_per_V", "m/V"),
        ("heat.thermal_resistance_K_per_W", "K/W"),
        ("equivalent_circuit.motional_inductance_V_s_per_A", "V*s/A"),
        ("relative_friction", "1"),
    ],
)
def test_the_unit_stands_in_the_key(key: str, unit: str) -> None:
    assert AskedNumber("predict", key).unit.symbol == unit
    assert unit == "1" or without_units(key) != key


@pytest.mark.parametrize(
    ("name", "draws"),
    [
        ("relative_friction_median", True),
        ("friction.relative_friction_interval", True),
        ("wanted.voltage_median", True),
        ("wanted.share_beyond_drive", True),
        ("power_W", True),
        ("felt.share_never_felt", True),
        ("felt.finest_period_felt", False),
        ("relative_friction", False),
        ("heat.cold_power", False),
        ("active_area.relative_friction.median", False),
    ],
)
def test_what_is_part_of_an_interval_has_draws(name: str, draws: bool) -> None:
    assert {one.draws for one in asked_for([name])} == {draws}


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("relative_frictoin", r"Did you mean 'relative_friction'\?"),
        ("friction", "Did you mean relative_friction, friction_coefficient"),
        ("lag", "may be lag_m or lag_s; say which"),
        ("plate.modes", r"is a list of plate; say which of it, like modes\.0\.frequency"),
        ("plate.relative_friction", "no verb answers that"),
        ("zzz", r"There are, by the verb that is asked first: predict: voltage, .*render: "),
    ],
)
def test_what_nobody_answers_is_refused_with_what_there_is(name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        asked_for([name])


def test_nothing_asked_is_refused() -> None:
    for names in ([], [""], [" , "]):
        with pytest.raises(InputError, match="nothing is asked for; give ask"):
            asked_for(names)


def test_numbers_are_found_wherever_they_stand() -> None:
    said = {"a": 1, "b": {"c_m": 2.5, "t": "text"}, "l": [3, [4]], "n": None, "yes": True,
            "provenance": {"seed": 5}}  # fmt: skip
    found = dict(numbers_of(said))
    assert math.isnan(found.pop("n"))
    assert found == {"a": 1.0, "b.c_m": 2.5, "l.0": 3.0, "l.1.0": 4.0, "yes": 1.0}


def test_what_predict_says_of_a_stator_is_listed() -> None:
    said = dict(numbers_of(predict("biet2008-stator").summary()))
    for key, value in said.items():
        if value == value:
            assert asked_for([f"predict.{key}"]) == (AskedNumber("predict", key),)


@pytest.mark.nightly
def test_the_list_is_as_its_tool_writes_it() -> None:
    import sweep_answers

    for verb, keys in catalogue().items():
        assert sorted(keys) == sorted(sweep_answers.keys(verb)), "run tools/sweep_answers.py"


def test_a_rendering_without_a_texture_is_refused() -> None:
    with pytest.raises(InputError, match="render needs a texture"):
        VERBS["render"].answer(load_display("biet2008-plate"), {}, 0)
