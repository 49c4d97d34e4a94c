"""The documentation's page of published friction."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.unit.measure.report.test_page import folder

from squeezefilm.core.errors import InputError
from squeezefilm.validation.report.published import write_friction_docs

PAGE = Path(__file__).parents[4] / "docs" / "reference" / "published-friction.md"


def test_the_page_has_every_curve_and_every_number_of_people(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="needs a checkout"):
        write_friction_docs(folder(), tmp_path)
    (tmp_path / "docs" / "pictures").mkdir(parents=True)
    (tmp_path / "docs" / "reference").mkdir()
    (tmp_path / "pyproject.toml").write_text("")
    text = write_friction_docs(folder(), tmp_path).read_text(encoding="utf-8")
    assert text.count("| levitation (the default) | 0.240 |") == 2
    assert "decay amplitude τ: median 2 µm" in text
    assert "| partial-levitation | 0.008 | 1.50 | 1 |" in text


def test_the_committed_page_says_what_readme_and_index_say() -> None:
    rows = [line.split(" | ") for line in PAGE.read_text(encoding="utf-8").splitlines()]
    off = {row[0].strip("| "): float(row[1]) for row in rows if len(row) == 4 and "0." in row[1]}
    default = off["levitation (the default)"]
    baseline = off["exponential (no physics)"]
    for page in (PAGE.parents[1] / "index.md", PAGE.parents[2] / "README.md"):
        said = " ".join(page.read_text(encoding="utf-8").split())
        assert f"off by {default:.2f} of the friction at rest" in said
        assert f"by {baseline:.2f}" in said
