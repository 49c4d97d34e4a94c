"""The documentation has few entries, and its page of accuracy whatever was measured."""

from __future__ import annotations

import re
from pathlib import Path

from squeezefilm.core import presets
from squeezefilm.design.analysis.published_claims import read_claims
from squeezefilm.measure.recordings.read import check_folder

ROOT = Path(__file__).parents[2]


def test_the_navigation_has_at_most_thirty_entries() -> None:
    nav = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:\n")[2]
    entries = re.findall(r"^ +- [^:]+: \S+$", nav, re.MULTILINE)
    assert 20 < len(entries) <= 30


def test_the_page_of_accuracy_has_all_that_was_measured() -> None:
    page = (ROOT / "docs" / "reference" / "accuracy.md").read_text(encoding="utf-8")
    recordings = [each.recording for each in check_folder(presets.friction_folder()).checks]
    assert len(recordings) > 5
    missing = [each.told.name for each in recordings if each.told.name not in page]
    claims = [claim.statement for claim in read_claims().all_claims if claim.relation == "equals"]
    missing += [said for said in claims if "measured" in said and said not in page]
    assert not missing, "make accuracy"
