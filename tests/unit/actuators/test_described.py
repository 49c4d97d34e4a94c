"""An actuator's file: its kind by its table, and what is said of a file that has none."""

from pathlib import Path

import pytest

from squeezefilm.actuators.described import KINDS, actuator_class, load_actuator
from squeezefilm.actuators.motor.description import MotorDescription
from squeezefilm.core import presets
from squeezefilm.core.errors import ConfigError

TEXT = presets.resolve("biet2008-motor", "actuator").read_text(encoding="utf-8")


def test_a_motor_is_read_with_units_and_sources() -> None:
    found = load_actuator("biet2008-motor")
    assert isinstance(found, MotorDescription)
    assert found.motor.cradle.preload == 20.0
    assert found.motor.contact.normal_stiffness == 2e7
    assert found.motor.plate.nodal_lines == 8
    assert len(found.motor.feet) == 4
    assert found.provenance["motor.contact.friction_coefficient"].evidence == "assumed"
    assert found.provenance["motor.plate.length"].evidence == "published"
    # The paper gives no number of its motor: what makes it one is assumed.
    for key in ("slider_mass", "cradle.preload", "contact.damping", "feet.0.x"):
        assert found.provenance[f"motor.{key}"].evidence == "assumed", key


def test_the_plate_may_name_its_materials(tmp_path: Path) -> None:
    start = TEXT.index("[motor.plate.substrate]")
    end = TEXT.index("# The paper's d31")
    file = tmp_path / "mine.toml"
    table = '[motor.plate.substrate]\nmaterial = "aluminium-6061"\n\n'
    file.write_text(TEXT[:start] + table + TEXT[end:], encoding="utf-8")
    found = load_actuator(file)
    assert isinstance(found, MotorDescription)
    assert found.motor.plate.substrate.density == pytest.approx(2700, rel=0.01)


@pytest.mark.parametrize("name", presets.names("actuator"))
def test_every_preset_is_one_of_the_kinds(name: str) -> None:
    assert (
        actuator_class(presets.resolve(name, "actuator").read_text(encoding="utf-8"))
        in KINDS.values()
    )
    load_actuator(name)


def test_a_slip_is_said_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "slip.toml"
    file.write_text(TEXT.replace('"20 N"', '"20 mm"'), encoding="utf-8")
    with pytest.raises(ConfigError, match=r"slip\.toml, line \d+: motor\.cradle\.preload: '20 mm'"):
        load_actuator(file)
    file.write_text(TEXT.replace("slider_mass", "slidermass"), encoding="utf-8")
    with pytest.raises(ConfigError, match="Did you mean 'slider_mass'"):
        load_actuator(file)


def test_a_file_without_an_actuator_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"has no table of an actuator; one needs \[motor\]"):
        actuator_class('name = "x"\n[moter]\n')
    with pytest.raises(ConfigError, match="Did you mean 'motor'"):
        actuator_class("[moter]\n")
    # What is no TOML is for the loader to explain.
    assert actuator_class("= 3") in KINDS.values()
    with pytest.raises(ConfigError, match="is neither a file nor a"):
        load_actuator("biet2008-moter")


def test_an_actuator_where_a_display_is_wanted_is_said_to_be_one() -> None:
    with pytest.raises(ConfigError, match="is a motor or a skin-stretch array, and a display is"):
        presets.resolve("biet2008-motor")
