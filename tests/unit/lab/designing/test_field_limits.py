"""What a field of the display's form may be, found by trying."""

from __future__ import annotations

import pytest

from squeezefilm.core import presets
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.lab.designing.field_limits import allowed
from squeezefilm.lab.designing.form import edited, form, preset_text
from squeezefilm.lab.designing.numbers import DesignPoint, designed

PLATE = preset_text("biet2008-plate")


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("actuator.substrate.poisson_ratio", "above -1 below 0.5"),
        ("drive.voltage", "from 0 V up to 2 kV"),
        ("drive.duty", "from 0.001 up to 1"),
        # Patches of 12 mm raster on a plate of 83 × 49 mm.
        ("actuator.patches.0.length", "from 1 µm up to 12 mm"),
        ("actuator.patches.0.width", "from 1 µm up to 49 mm"),
        ("actuator.patches.0.x", "from 0 m up to 1 mm"),
        ("actuator.length", "from 83 mm up to 10 m"),
        ("actuator.ceramic.charge_coefficient", "from -1 µm/V up to 1 µm/V"),
        ("name", ""),
    ],
)
def test_limits_in_words(path: str, words: str) -> None:
    assert allowed(PLATE, path) == words


def test_whole_numbers_are_counted() -> None:
    text = preset_text("touchpad-glass")
    assert next(row for row in form(text) if row["path"] == "actuator.nodal_lines")["whole"]
    assert allowed(text, "actuator.nodal_lines") == "from 2 up to 300"
    # Sectors would need diameters, diameters sectors.
    assert allowed(preset_text("winfield2007-tpad"), "actuator.nodal_diameters") == "only 0"
    assert allowed(text, "actuator.patches.0.poling") == ""
    assert allowed(preset_text("winfield2007-tpad"), "actuator.nodal_circles") == "from 1 up to 100"


def test_a_path_that_is_not_there() -> None:
    with pytest.raises(InputError, match=r"no value at 'actuator\.depth'"):
        allowed(PLATE, "actuator.depth")


SHORT = "biet2008-stator"


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(one, marks=() if one == SHORT else pytest.mark.nightly)
        for one in presets.display_names()
    ],
)
def test_what_is_said_is_what_the_file_takes(name: str) -> None:
    """Just inside is taken, just outside refused, by the loader itself."""
    text = preset_text(name)
    tried = 0
    for row in form(text):
        if row["unit"] is None or row["whole"] or ".0." in row["path"]:
            continue
        words = allowed(text, row["path"]).split(" ")
        for word, outwards in (("from", -1), ("up", 1)):
            if word not in words:
                continue
            at = words.index(word) + (2 if word == "up" else 1)
            limit, unit = float(words[at]), " ".join(words[at + 1 : at + 2])
            with_unit = f" {unit}" if row["unit"] else ""
            edited(text, row["path"], f"{limit:.9g}{with_unit}" if with_unit else f"{limit:.9g}")
            beyond = limit + outwards * max(1e-3 * abs(limit), 1e-3)
            with pytest.raises(SqueezefilmError):
                edited(text, row["path"], f"{beyond:.9g}{with_unit}")
            tried += 1
    assert tried >= 5


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("actuator.nodal_lines", "actuator.nodal_lines: 'abc' is no whole number; write one"),
        ("actuator.thickness", "line 11: actuator.thickness: 'abc' is no quantity; write a number"),
    ],
)
def test_a_word_in_a_number_s_field_is_refused_in_a_sentence(path: str, says: str) -> None:
    with pytest.raises(InputError) as refused:
        edited(PLATE, path, "abc")
    assert str(refused.value).startswith(says)


def test_the_mode_of_a_plate_says_along_which_axis_it_lies() -> None:
    across = edited(PLATE, "actuator.lines_across", "width")
    for text, axis in ((PLATE, "x"), (across, "y")):
        assert designed(DesignPoint(text), "screening")["line"]["along"] == axis
