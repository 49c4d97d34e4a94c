"""The order in which a folder's comparisons are told, and what each shows."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.validation.report import published


def test_curves_come_first_then_people_then_thresholds(monkeypatch: pytest.MonkeyPatch) -> None:
    pooled = published.pooled
    for room, names in (
        (published, "conditions inside_words model_rows comparison_figure"),
        (pooled, "people_rows people_words detection_rows detection_figure"),
    ):
        for name in names.split():
            monkeypatch.setattr(room, name, lambda of, name=name: f"{name} of {of.told.name}")
    monkeypatch.setattr(pooled, "detection_words", lambda of: [f"words of {of.told.name}", "more"])
    one = SimpleNamespace(
        told=SimpleNamespace(name="a"), adequacy=SimpleNamespace(sentence="it fits"), curve=None
    )
    one.curve = SimpleNamespace(told=one.told)
    people = SimpleNamespace(told=SimpleNamespace(name="b"), quantity="damping")
    seen = SimpleNamespace(told=SimpleNamespace(name="c"))
    compared: Any = SimpleNamespace(curves=[one], populations=[people], detections=[seen])
    curve, many, threshold = published._recordings(compared)
    assert [found.told for found in (curve, many, threshold)] == [one.told, people.told, seen.told]
    assert [found.part.heading for found in (curve, many, threshold)] == ["a", "b: damping", "c"]
    assert curve.part.sentences == ["conditions of a", "inside_words of a", "it fits"]
    assert many.part.sentences == ["people_words of b"]
    assert threshold.part.sentences == ["words of c", "more"]
    tables: list[Any] = [found.part.tables for found in (curve, many, threshold)]
    assert tables == [
        [(published.MODELS_HEAD, "model_rows of a")], [(pooled.PEOPLE_HEAD, "people_rows of b")],
        [(pooled.DETECTION_HEAD, "detection_rows of c")],
    ]  # fmt: skip
    drawn: list[Any] = [found.figure and found.figure() for found in (curve, many, threshold)]
    assert drawn == ["comparison_figure of a", None, "detection_figure of c"]
