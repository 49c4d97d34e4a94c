"""Which numbers have a source: their own, their table's, none, or none any more."""

from __future__ import annotations

from pathlib import Path

import pytest

from squeezefilm.core import presets
from squeezefilm.core.config import Provenance, load_text
from squeezefilm.core.config.provenance import (
    UNSTATED,
    changed_from,
    source_doubt,
    stated_sources,
    unstated,
)
from squeezefilm.core.errors import ConfigError
from squeezefilm.physics.display import Display, load_display, new_display_file

TEXT = presets.path("biet2008-plate").read_text(encoding="utf-8")
LENGTH = 'length = { value = "83 mm", source = "paper, section 3.1.2" }'
assert LENGTH in TEXT


@pytest.fixture
def copy(tmp_path: Path) -> str:
    """The text of what `squeezefilm new` writes."""
    file = tmp_path / "mine.toml"
    new_display_file(file, "biet2008-plate")
    assert load_display(file).measured is None
    return file.read_text(encoding="utf-8")


def test_a_copy_is_as_well_founded_as_what_it_was_copied_from(copy: str) -> None:
    found, preset = load_text(Display, copy), load_display("biet2008-plate")
    of_preset = {
        path: source
        for path, source in preset.provenance.items()
        if not path.startswith("measured.")
    }
    assert found.provenance == of_preset
    assert unstated(found.provenance) == ()


@pytest.mark.parametrize(
    ("now", "lapses"),
    [
        (LENGTH.replace("83", "84"), True),
        # Another evidence does not make the words of the source true.
        (LENGTH.replace("83", "84").replace(" }", ', evidence = "measured" }'), True),
        (LENGTH.replace("83 mm", "8.3 cm"), False),
        (LENGTH.replace("83 mm", "84 mm").replace("paper, section 3.1.2", "caliper"), False),
    ],
)
def test_a_number_alone_that_changes_loses_its_source(copy: str, now: str, lapses: bool) -> None:
    found = load_text(Display, copy.replace(LENGTH, now)).provenance["actuator.length"]
    if lapses:
        was = changed_from("83 mm", "paper, section 3.1.2")
        assert (found.source, found.evidence) == (was, UNSTATED)
    else:
        assert found.evidence == "published"
        assert not found.source.startswith("changed from")
    # Without the line that says what it was copied from nothing can be known.
    plain = copy.replace('copied_from = "biet2008-plate"', "").replace(LENGTH, now)
    assert load_text(Display, plain).provenance["actuator.length"].evidence != UNSTATED


def test_the_source_of_a_table_lapses_for_the_number_that_changed_and_no_other(copy: str) -> None:
    found = load_text(Display, copy.replace('x = "24 mm"', 'x = "23.5 mm"')).provenance
    assert unstated(found) == ("actuator.patches.2.x",)
    assert "changed from 24 mm (paper" in found["actuator.patches.2.x"].source


def test_numbers_without_a_source_are_unstated_and_words_need_none() -> None:
    bare = TEXT.replace(LENGTH, 'length = "83 mm"').replace(
        'nodal_lines = { value = 8, source = "paper, section 3.1.3: mode (8,0)" }',
        "nodal_lines = 8",
    )
    found = load_text(Display, bare).provenance
    assert unstated(found) == ("actuator.length", "actuator.nodal_lines")
    assert "actuator.type" not in found
    assert "actuator.patches.0.polarity" not in found
    assert found["actuator.patches.3.y"].source.startswith("paper, section 3.1.2: 7 ceramics")
    # A table vouches for its own values, not for those of the tables in it.
    above = bare.replace("[actuator]\n", '[actuator]\nsource = "drawing 17"\n')
    again = load_text(Display, above.replace('y = "0 mm"', 'y = { value = "0 mm" }'))
    assert again.provenance["actuator.length"] == Provenance("drawing 17")
    assert again.provenance["actuator.patches.0.y"].source.startswith("paper")


def test_who_computes_sources_without_an_original_gets_those_of_the_file() -> None:
    from squeezefilm.core.config.provenance import split_provenance

    display = load_display("biet2008-plate")
    split = split_provenance({"gas": {"density": "1.2 kg/m3"}})
    assert stated_sources(display, split) == {"gas.density": Provenance("", UNSTATED)}


def test_a_preset_that_is_none_is_refused(copy: str) -> None:
    for name, says in (('"biet2008-plat"', "Did you mean 'biet2008-plate'"), ("3", "3 is no name")):
        bad = copy.replace('copied_from = "biet2008-plate"', f"copied_from = {name}")
        with pytest.raises(ConfigError, match=says) as caught:
            load_text(Display, bad)
        assert caught.value.key == "copied_from"
        assert caught.value.line == 4


def test_what_is_doubtful_is_counted() -> None:
    sound, assumed, bare = Provenance("a"), Provenance("b", "assumed"), Provenance("", UNSTATED)
    assert source_doubt({"x": sound}) is None
    assert source_doubt({"x": sound, "y": assumed}) == (
        "1 of 2 values of this display are assumed, not measured or published: squeezefilm show "
        "lists them."
    )
    assert source_doubt({"x": bare, "y": assumed, "z": bare}) == (
        "2 of 3 values of this display have no source, and 1 are assumed, not measured or "
        "published: squeezefilm show lists them."
    )
    assert "read from no file" in str(source_doubt({}))
