"""What a sweep varies, read from texts, numbers and files."""

from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.quantities import Unit
from squeezefilm.design.sweep.answers import OPTIONS
from squeezefilm.design.sweep.axes import Axis, axes_of, axis_of, axis_of_file
from squeezefilm.physics.display import load_display

PLATE = load_display("biet2008-plate")
STATOR = load_display("biet2008-stator")


def steps(axis: Axis) -> list[object]:
    return [value for (value,) in axis.steps]


def test_a_range_is_evenly_spaced_with_its_ends_as_written() -> None:
    (axis,) = axes_of(PLATE, "actuator.thickness=1 mm..3 mm:9")
    assert axis.columns == ("actuator.thickness_m",)
    assert steps(axis) == [k / 4e3 for k in range(4, 13)]
    assert not axis.logarithmic
    falling = axis_of("voltage", "20 V .. 10 V : 3", PLATE)
    assert steps(falling) == [20.0, 15.0, 10.0]


def test_a_range_may_be_spaced_by_its_logarithm() -> None:
    axis = axis_of("voltage", "1 V..100 V:5:log", PLATE)
    values = np.array(steps(axis))
    assert values[[0, -1]].tolist() == [1.0, 100.0]
    assert values[1:] / values[:-1] == pytest.approx(np.sqrt(10))
    assert axis.logarithmic
    with pytest.raises(InputError, match="start above 0"):
        axis_of("voltage", "0 V..100 V:5:log", PLATE)


def test_lists_words_numbers_and_one_value() -> None:
    glue = axis_of("finger.normal_force", "0.3 N, 0.5 N", PLATE)
    assert steps(glue) == [0.3, 0.5]
    assert steps(axis_of("surface", "adhesive, bare", PLATE)) == ["adhesive", "bare"]
    assert axis_of("surface", "adhesive, bare", PLATE).units == (None,)
    assert steps(axis_of("voltage", "20 V", PLATE)) == [20.0]
    assert steps(axis_of("voltage", [10, "15 V", np.float64(20)], PLATE)) == [10.0, 15.0, 20.0]
    assert steps(axis_of("voltage", 12.5, PLATE)) == [12.5]
    motions = axis_of("motion", "60 mm/s over 4 cm, 2 passes; 80 mm/s over 4 cm", PLATE)
    assert steps(motions) == ["60 mm/s over 4 cm, 2 passes", "80 mm/s over 4 cm"]


def test_whole_numbers_stay_whole_and_all_of_a_list_change_together() -> None:
    lines = axis_of("actuator.nodal_lines", "6..8:3", PLATE)
    assert steps(lines) == [6, 7, 8]
    assert all(isinstance(value, int) for value in steps(lines))
    with pytest.raises(InputError, match="must be a whole number"):
        axis_of("actuator.nodal_lines", "6..8:4", PLATE)
    every = axis_of("actuator.patches.*.thickness", "0.5 mm, 1 mm", PLATE)
    assert every.units == (Unit("m"),)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("actuator.thicknes=1 mm", r"no 'thicknes'\. Did you mean 'thickness'\?"),
        ("thickness=1 mm", r"say of what, actuator\.thickness or actuator\.patches\.\*\.thickness"),
        ("voltag=1 V", r"Did you mean 'voltage'\?"),
        ("actuator.thickness=1..3:9", "'1' has no unit"),
        ("actuator.thickness=1 mm..3 mm", "no number of steps; write it behind a colon"),
        ("actuator.thickness=1 kHz", "wrong dimension"),
        ("actuator.thickness=1 mm..3 mm:1", "at least 2 steps"),
        ("actuator.thickness=1 mm..1 mm:3", "is no range"),
        ("actuator.thickness=1 mm, 1 mm", "takes a value twice"),
        ("actuator.substrate.name=steel", "is no number"),
        ("actuator.thickness", "says not what is varied"),
        ("voltage=-1 V", "at least 0 V"),
        ("normal_force=0 N", "above 0 N"),
        ("wanted_friction=1.5", "at most 1"),
        ("model=levitaton", r"Did you mean 'levitation'\?"),
        ("braking=perhaps", "Allowed: true, false"),
        ("band=20 kHz", "is no band"),
        ("texture=no-such", "neither a file nor"),
    ],
)
def test_what_is_none_is_refused_with_what_would_do(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        axes_of(PLATE, text)


def test_what_is_no_text_and_no_number_is_refused() -> None:
    for values in ([True], [None], [float("nan")]):
        with pytest.raises(InputError, match="voltage = "):
            axis_of("voltage", values, PLATE)
    with pytest.raises(InputError, match="is no text"):
        axis_of("surface", [1.0], PLATE)


def test_a_file_is_an_axis_whose_columns_change_together(tmp_path: Path) -> None:
    file = tmp_path / "points.csv"
    file.write_text(
        "\ufeff# mine\nactuator.thickness [mm], surface ,voltage\n"
        "1.5,bare,10 V\n1.5,adhesive,20 V\n"
    )
    axis = axis_of_file(file, PLATE)
    assert axis.columns == ("actuator.thickness_m", "surface", "voltage_V")
    assert axis.steps == ((1.5e-3, "bare", 10.0), (1.5e-3, "adhesive", 20.0))
    assert axis.numbers is None
    for text, message in (
        ("voltage\n", "no header and row"),
        ("voltage\n10\n", r"line 2.*'10' has no unit"),
        ("voltage,surface\n10 V\n", r"line 2.*has 1 cells where the header has 2"),
        ("# mine\n\nvoltage\n10 V\n\n# of it\n20\n", r"line 7.*'20' has no unit"),
        ("# mine\nvoltage,speed\n\n10 V\n", r"line 4.*has 1 cells where the header has 2"),
    ):
        file.write_text(text)
        with pytest.raises(ConfigError, match=message):
            axis_of_file(file, PLATE)


def test_a_name_is_varied_once(tmp_path: Path) -> None:
    both = axes_of(STATOR, {"voltage": "1 V, 2 V", "normal_force": ["0.3 N"]})
    assert [len(axis) for axis in both] == [2, 1]
    with pytest.raises(InputError, match="voltage is varied twice"):
        axes_of(STATOR, ["voltage=1 V", "voltage=2 V"])
    assert axes_of(STATOR, "voltage=1 V") == axes_of(STATOR, ["voltage=1 V"])


def test_options_become_arguments_of_verbs() -> None:
    assert OPTIONS["voltage"].argument(15.0) == 15.0
    assert OPTIONS["band"].argument("25 kHz:45 kHz") == (25e3, 45e3)
    assert OPTIONS["braking"].argument("true") is True
    assert OPTIONS["surface"].argument("bare") == "bare"
