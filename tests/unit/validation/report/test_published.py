"""The order in which a folder's comparisons are told, and what each shows."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.validation.report import published


def test_curves_come_first_then_people_then_thresholds(monkeypatch: pytest.MonkeyPatch) -> None:
    names = (
        "conditions inside_words model_rows comparison_figure people_rows people_words "
        "people_figure detection_rows detection_figure"
    )
    for name in names.split():
        monkeypatch.setattr(published, name, lambda of, name=name: f"{name} of {of.told.name}")
    monkeypatch.setattr(
        published, "detection_words", lambda of: [f"words of {of.told.name}", "more"]
    )
    one = SimpleNamespace(
        told=SimpleNamespace(name="a"), adequacy=SimpleNamespace(sentence="it fits"), curve=None
    )
    one.curve = SimpleNamespace(told=one.told)
    people = SimpleNamespace(told=SimpleNamespace(name="b"), quantity="damping")
    seen = SimpleNamespace(told=SimpleNamespace(name="c"))
    compared: Any = SimpleNamespace(curves=[one], populations=[people], detections=[seen])
    curve, many, threshold = published._recordings(compared)
    assert [found.told for found in (curve, many, threshold)] == [one.told, people.told, seen.told]
    assert [found.name for found in (curve, many, threshold)] == ["a", "b: damping", "c"]
    assert curve.words == ["conditions of a", "inside_words of a", "it fits"]
    assert many.words == ["people_words of b"]
    assert threshold.words == ["words of c", "more"]
    captions = [found.caption for found in (curve, many, threshold)]
    assert captions == [
        "How far each model is off", "What each model gives", "What each rival gives",
    ]  # fmt: skip
    assert [found.head for found in (curve, many, threshold)] == [
        published.MODELS_HEAD, published.PEOPLE_HEAD, published.DETECTION_HEAD,
    ]  # fmt: skip
    rows: list[Any] = [found.rows for found in (curve, many, threshold)]
    assert rows == ["model_rows of a", "people_rows of b", "detection_rows of c"]
    figures: list[Any] = [found.figure() for found in (curve, many, threshold)]
    assert figures == ["comparison_figure of a", "people_figure of b", "detection_figure of c"]
