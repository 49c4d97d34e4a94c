"""Every quantity that the lab shows is explained, with its source."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from squeezefilm import lab
from squeezefilm.core import presets
from squeezefilm.lab.designing.form import form, preset_text

STATIC = Path(lab.__file__).parent / "static"
ENTRIES = {
    found[1]: found[2]
    for found in re.finditer(
        r"^  (\w+): \{(.*)\},$", (STATIC / "glossary.js").read_text(encoding="utf-8"), re.MULTILINE
    )
}


@pytest.mark.parametrize("name", presets.display_names())
def test_every_field_of_a_display_is_explained(name: str) -> None:
    rows = [row for row in form(preset_text(name)) if row["name"] != "type"]
    assert {row["path"] for row in rows if row["name"] not in ENTRIES} == set()
    assert len(rows) > 30


def test_every_explanation_has_a_text_and_a_source() -> None:
    assert len(ENTRIES) > 90
    for key, entry in ENTRIES.items():
        assert re.search(r'text: "[^"]{8,}"', entry), key
        assert re.search(r'source: "[^"]{4,}"', entry), key


def test_every_number_on_a_page_names_an_explanation() -> None:
    asked = set()
    for path in (STATIC / "areas").glob("*.js"):
        source = path.read_text(encoding="utf-8")
        for found in re.finditer(r'\bnumber\("[^"]+"(?:, "(\w+)")?\)', source):
            assert found[1], f"{path.name}: {found[0]}"
            asked.add(found[1])
        if (table := re.search(r"const EXPLAINED = \[(.*?)\];", source, re.DOTALL)) is not None:
            asked |= set(re.findall(r'\["[^"]+", "(\w+)"\]', table[1]))
    assert asked - set(ENTRIES) == set()
    assert len(asked) > 20


def test_the_glossary_of_the_pages_names_things_as_the_lab_does() -> None:
    # The lab explains a number where it stands, the page a word; the same thing has one name.
    page = Path(__file__).parents[3] / "docs" / "reference" / "glossary.md"
    word = re.compile(r"^\*\*([^*]+)\*\*(?: ([^:(;,]+?))?(?: \([^)]*\))?:", re.MULTILINE)
    words = word.findall(page.read_text(encoding="utf-8"))
    symbols = {
        found[1].lower(): found[2]
        for entry in ENTRIES.values()
        if (found := re.search(r'name: "([^"]+)", symbol: "([^"]+)"', entry))
    }
    both = [(name.lower(), symbol) for name, symbol in words if name.lower() in symbols]
    assert len(both) >= 5, "the two glossaries have drifted apart"
    for name, symbol in both:
        assert symbol in ("", symbols[name]), name
    assert len({name for name, _ in words}) == len(words) > 40
