"""One edit of a display's text: what it writes, what it says of the source, what it refuses."""

from __future__ import annotations

from typing import Annotated, Literal

import pytest

from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.quantities import Hertz, Unit
from squeezefilm.lab.designing.form import (
    LONGEST_VALUE,
    OWN_VALUES,
    choices,
    display_of,
    edited,
    form,
    name_of,
    preset_text,
    stated,
)

GLASS = preset_text("touchpad-glass")
STATOR = preset_text("biet2008-stator")


def row_of(text: str, path: str) -> dict[str, object]:
    return next(row for row in form(text) if row["path"] == path)


def test_a_row_says_all_that_the_page_shows() -> None:
    row = row_of(GLASS, "actuator.length")
    assert row == {
        "path": "actuator.length", "section": "actuator", "name": "length", "unit": "m",
        "text": "100 mm", "value": 0.1, "whole": False, "choices": None, "optional": False,
        "source": "our own design of the size of a touch pad; no device", "evidence": "assumed",
    }  # fmt: skip
    ratio = row_of(GLASS, "actuator.substrate.poisson_ratio")
    assert (ratio["unit"], ratio["text"], ratio["value"]) == ("", "0.2", 0.2)
    lines = row_of(GLASS, "actuator.nodal_lines")
    assert (lines["text"], lines["value"], lines["whole"]) == ("7", 7, True)
    assert lines["evidence"] == "derived"
    word = row_of(GLASS, "actuator.lines_across")
    assert (word["unit"], word["value"], word["text"]) == (None, None, "width")
    assert word["choices"] == ["length", "width"]
    # A member of a list is counted, and stands in its list's section.
    second = row_of(GLASS, "actuator.patches.1.y")
    assert (second["section"], second["text"]) == ("actuator.patches.1", "55 mm")
    # Its source is the one of its table.
    assert second["source"] == "a strip along each long edge; our design"
    assert second["evidence"] == "assumed"
    assert name_of(GLASS) == "touchpad-glass"


def test_a_value_that_changes_keeps_where_it_was_from() -> None:
    found = edited(GLASS, "actuator.length", "  101 mm ")
    assert display_of(found).actuator.length == pytest.approx(0.101)  # type: ignore[union-attr]
    row = row_of(found, "actuator.length")
    old = "our own design of the size of a touch pad; no device"
    assert row["source"] == f"changed from 100 mm ({old})"
    assert row["evidence"] == "unstated"
    # Changed again, it still says where the first one was from.
    twice = edited(found, "actuator.length", "102 mm")
    assert row_of(twice, "actuator.length")["source"] == f"changed from 100 mm ({old})"
    # The same value again is no change.
    assert edited(GLASS, "actuator.length", "100 mm") == GLASS
    assert edited(GLASS, "actuator.nodal_lines", "7") == GLASS
    # The comments stay.
    assert found.startswith(GLASS[: GLASS.index("name =")])
    assert "# A gasket" in found


@pytest.mark.parametrize("spread", ['uncertainty = "1 mm"', 'range = ["50 mm", "54 mm"]'])
def test_evidence_and_spread_do_not_vouch_for_another_value(spread: str) -> None:
    stood = f'y = {{ value = "53 mm", {spread}, source = "a rule", evidence = "measured" }}'
    base = GLASS.replace('y = "55 mm"', stood, 1)
    assert row_of(base, "actuator.patches.1.y")["evidence"] == "measured"
    kept = edited(base, "actuator.patches.1.y", "53 mm")
    assert kept == base
    found = edited(base, "actuator.patches.1.y", "52 mm")
    assert spread not in found
    row = row_of(found, "actuator.patches.1.y")
    assert (row["text"], row["evidence"]) == ("52 mm", "unstated")
    assert row["source"] == "changed from 53 mm (a rule)"


def test_where_no_source_stood_none_is_made_up() -> None:
    base = GLASS.replace('y = "55 mm"', 'y = { value = "55 mm", evidence = "measured" }', 1)
    found = edited(base, "actuator.patches.1.y", "54 mm")
    assert "changed from" not in found
    assert row_of(found, "actuator.patches.1.y")["evidence"] == "unstated"


def test_a_plain_value_is_replaced_and_a_missing_one_is_written() -> None:
    found = edited(GLASS, "actuator.patches.0.length", "90 mm")
    row = row_of(found, "actuator.patches.0.length")
    # What vouched for it, here its table, vouched for the other value.
    assert row["source"] == "changed from 100 mm (a strip along each long edge; our design)"
    assert row["evidence"] == "unstated"
    assert edited(GLASS, "actuator.patches.0.length", "100 mm") == GLASS
    assert row_of(found, "actuator.patches.0.length")["value"] == pytest.approx(0.09)
    assert row_of(found, "actuator.patches.1.length")["value"] == pytest.approx(0.1)
    other = edited(GLASS, "actuator.patches.1.length", "90 mm")
    assert row_of(other, "actuator.patches.0.length")["value"] == pytest.approx(0.1)
    missing = next(
        row for row in form(STATOR)
        if row["optional"] and row["unit"] and row["value"] is not None and not row["source"]
        and f"\n{row['name']} " not in STATOR
    )  # fmt: skip
    found = edited(STATOR, missing["path"], missing["text"])
    assert row_of(found, missing["path"])["value"] == pytest.approx(missing["value"], rel=1e-5)
    assert str(missing["name"]) in found


def test_what_cannot_be_written_is_refused_in_words() -> None:
    for path, value, words in (
        ("actuator.length", "x" * (LONGEST_VALUE + 1), "a value of 2001 characters; at most 2000"),
        ("actuator.depth", "1 mm", r"no value at 'actuator\.depth'"),
        ("actuator.patches.7.x", "1 mm", "no value at"),
        ("actuator.nodal_lines", "7.5", "'7.5' is no whole number"),
        ("actuator.nodal_lines", "many", "'many' is no whole number"),
        ("actuator.substrate.poisson_ratio", "much", "poisson_ratio"),
        ("actuator.length", "10 kg", "length"),
        ("actuator.lines_across", "depth", "lines_across"),
    ):
        with pytest.raises(SqueezefilmError, match=words):
            edited(GLASS, path, value)
    # As long as a value may be it is the display that refuses it.
    with pytest.raises(SqueezefilmError) as refused:
        edited(GLASS, "actuator.length", "x" * LONGEST_VALUE)
    assert "characters; at most" not in str(refused.value)


def test_what_stands_in_no_table_of_its_own_is_left_to_the_text() -> None:
    # A value given in a whole that is no table: tomlkit cannot reach into it.
    import squeezefilm.lab.designing.form as module

    with pytest.MonkeyPatch.context() as patched:
        row = {"path": "name.inner", "whole": False, "unit": "m"}
        patched.setattr(module, "form", lambda _: [row])
        with pytest.raises(InputError, match=r"'name\.inner' cannot be changed here \(.*edit the"):
            edited(GLASS, "name.inner", "1 mm")


def test_words_are_written_as_words_and_numbers_as_numbers() -> None:
    found = edited(GLASS, "actuator.substrate.poisson_ratio", "0.25")
    assert "poisson_ratio = { value = 0.25," in found
    found = edited(GLASS, "actuator.lines_across", "length")
    assert 'lines_across = { value = "length"' in found
    found = edited(GLASS, "title", "true glass")
    assert display_of(found).title == "true glass"


def test_a_number_is_shown_with_six_digits() -> None:
    found = edited(GLASS, "actuator.patches.0.length", "83.12345678 mm")
    assert row_of(found, "actuator.patches.0.length")["text"] == "83.1235 mm"


def test_a_type_says_what_a_value_may_be() -> None:
    word = Literal["one", "two"]
    assert choices(word) == ["one", "two"]
    assert choices(bool) == ["true", "false"]
    assert choices(str) is None
    assert stated(word | None) == word
    assert stated(None | str) is str
    assert stated(str) is str
    # A quantity that may be left out knows its unit itself.
    assert stated(Hertz | None) in (Hertz, Hertz | None)
    assert choices(Annotated[float, Unit("m")]) is None


def test_a_material_is_chosen_from_the_library() -> None:
    row = row_of(GLASS, "actuator.substrate.material")
    assert row["text"] == OWN_VALUES
    assert "aluminium 5083" in row["choices"]  # type: ignore[operator]
    found = edited(GLASS, "actuator.substrate.material", "aluminium 5083")
    assert row_of(found, "actuator.substrate.material")["text"] == "aluminium 5083"
    modulus = row_of(found, "actuator.substrate.young_modulus")
    assert modulus["text"] == "71 GPa"
    assert "MatWeb" in str(modulus["source"])
    # What the library does not say stays; what was assumed of another material does not.
    assert row_of(found, "actuator.substrate.quality_factor")["text"] == "1000.0"
    assert "borosilicate" not in found[found.index("[actuator.substrate]") :][:200]
    ceramic = edited(found, "actuator.ceramic.material", "PZT-8")
    assert row_of(ceramic, "actuator.ceramic.charge_coefficient")["text"] == "-97 pm/V"
    glue = edited(ceramic, "actuator.glue.material", "filled epoxy")
    assert row_of(glue, "actuator.glue.thickness")["text"] == "20 um"
    assert row_of(glue, "actuator.glue.young_modulus")["text"] == "7 GPa"
    with pytest.raises(InputError, match="there is no material 'wood'"):
        edited(GLASS, "actuator.substrate.material", "wood")


def test_a_value_of_the_library_is_overwritten_beside_its_name() -> None:
    start, end = GLASS.index("[actuator.substrate]"), GLASS.index("[actuator.ceramic]")
    for named in ('[actuator.substrate]\nmaterial = "brass"\n\n', 'substrate = "brass"\n\n'):
        text = GLASS[:start] + named + GLASS[end:]
        found = edited(text, "actuator.substrate.density", "8500 kg/m3")
        row = row_of(found, "actuator.substrate.density")
        assert (row["text"], row["evidence"]) == ("8500 kg/m3", "unstated")
        assert row["source"] == "changed from 8530 kg/m3 (Olin Brass, C26000)"
        assert row_of(found, "actuator.substrate.young_modulus")["text"] == "112 GPa"
        same = edited(text, "actuator.substrate.density", "8530 kg/m3")
        assert display_of(same).provenance == display_of(text).provenance
        assert row_of(found, "actuator.substrate.material")["text"] == "brass CuZn30"


def test_what_was_measured_goes_with_the_body_that_it_was_measured_of() -> None:
    text = preset_text("biet2008-plate")
    assert display_of(edited(text, "drive.voltage", "12 V")).measured is not None
    assert display_of(edited(text, "actuator.thickness", "2.1 mm")).measured is None
    assert display_of(edited(text, "actuator.patches.0.length", "10 mm")).measured is None


def test_an_edited_preset_does_not_keep_the_presets_name() -> None:
    text = edited(preset_text("biet2008-plate"), "drive.voltage", "12 V")
    assert name_of(text) == "biet2008-plate, edited"
    assert name_of(edited(text, "drive.voltage", "13 V")) == "biet2008-plate, edited"
    # Who names a display keeps the name.
    own = edited(text, "name", "mine")
    assert name_of(own) == name_of(edited(own, "drive.voltage", "12 V")) == "mine"
