"""The table of friction over load, speed, amplitude and law is that of the page on models."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.filterwarnings("ignore::squeezefilm.errors.OutOfRangeWarning")
def test_the_page_shows_what_the_tool_prints() -> None:
    rows = runpy.run_path(str(ROOT / "tools" / "friction_over_laws.py"))["rows"]()
    page = (ROOT / "docs" / "explanation" / "models.md").read_text(encoding="utf-8")
    assert "\n".join(rows) in page
    assert "–" not in "".join(rows)


@pytest.mark.filterwarnings("ignore::squeezefilm.errors.OutOfRangeWarning")
def test_the_default_law_holds_at_every_force_of_the_table() -> None:
    tool = runpy.run_path(str(ROOT / "tools" / "friction_over_laws.py"))
    law = tool["law_of"]()
    assert max(tool["FORCES"]) < law.finger.largest_force(law.surface.roughness)
