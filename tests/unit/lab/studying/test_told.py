"""What the experimenter's page is told of a study."""

from __future__ import annotations

from tests.unit.study.scripted import magnitudes

from squeezefilm.lab.studying.sittings import described


def test_a_study_is_told_with_its_task() -> None:
    assert described(magnitudes())["task"] == "magnitude-estimation"
