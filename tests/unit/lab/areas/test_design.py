"""What the Design area answers, on which line of work, and which files it writes."""

from __future__ import annotations

import asyncio
import contextvars
import json
from typing import TYPE_CHECKING, Any

import pytest
from tests.unit.lab.areas.too_long import require_refused_if_longer

from squeezefilm.core import presets
from squeezefilm.lab.areas.design import (
    DesignArea,
)
from squeezefilm.lab.designing import numbers
from squeezefilm.lab.designing.form import preset_text
from squeezefilm.lab.worker import PAGE

if TYPE_CHECKING:
    from .conftest import Talk

STATOR = preset_text("biet2008-stator")


@pytest.fixture
def lab(talk: Talk) -> Talk:
    DesignArea(talk.lab)
    return talk


def test_displays_are_listed_with_what_was_saved(lab: Talk) -> None:
    assert lab.say("ping") == {"type": "pong"}
    kept = list(presets.display_names())
    assert lab.say("displays") == {"type": "displays", "presets": kept, "saved": []}
    for name in ("two", "one"):
        assert lab.say("save display", text=STATOR, name=name) == {
            "type": "saved", "file": f"{name}.toml",
        }  # fmt: skip
    assert lab.say("displays")["saved"] == ["one", "two"]


def test_a_display_is_opened_by_name_by_file_or_as_a_text(lab: Talk) -> None:
    mine = STATOR.replace("biet2008-stator", "mine")
    lab.say("save display", text=mine, name="mine")
    for how, text in (
        ({"preset": "biet2008-stator"}, STATOR),
        ({"file": "mine"}, mine),
        ({"text": mine}, mine),
    ):
        found = lab.say("open display", **how)
        assert found["type"] == "display"
        assert found["text"] == text
        assert found["name"] == ("mine" if text is mine else "biet2008-stator")
    for wrong in ({}, {"preset": "biet2008-stator", "file": "mine"}, {"file": "mine", "text": ""}):
        assert "a preset, a file or a text, one of them" in lab.refused("open display", **wrong)
    assert "there is no file other.toml" in lab.refused("open display", file="other")


def test_an_edit(lab: Talk) -> None:
    found = lab.say("edit display", text=STATOR, path="drive.voltage", value="99 V")
    assert found["type"] == "display"
    (row,) = [one for one in found["form"] if one["path"] == "drive.voltage"]
    assert row["value"] == 99.0
    assert lab.asked == [("quick", None, "changed", False)]


@pytest.mark.slow
def test_what_takes_seconds_is_computed_on_the_slow_line(
    lab: Talk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(numbers, "friction_bands", _no_band)
    question = {
        "text": STATOR, "voltage": "100 V", "surface": "bare", "force": "0.7 N",
        "path": "finger.contact_length", "value": "8 mm",
    }  # fmt: skip
    for quality in ("screening", "solved"):
        found = lab.say("compute design", quality=quality, **question)
        assert (found["type"], found["quality"]) == ("design", quality)
        assert (found["voltage_V"], found["surface"]) == (100.0, "bare")
        assert found["normal_force_N"] == 0.7
        assert '"8 mm"' in found["text"]
        assert (lab.told is None) == (quality == "screening")
    assert "no band" in lab.refused("compute design", quality="band", of="solved", **question)
    assert lab.told is not None
    assert lab.asked == [
        ("quick", "screening", "designed", True),
        ("slow", "solved", "designed", True),
        ("slow", "band", "banded", True),
    ]


def _no_band(*_: Any, **__: Any) -> Any:
    # The real one takes seconds.
    raise ValueError("no band")


def test_a_band_is_of_the_quality_that_is_asked_for(
    lab: Talk, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[Any, ...]] = []

    def banded(point: numbers.DesignPoint, quality: str) -> dict[str, Any]:
        asked.append((point.edited(), quality))
        return {"low": [0.5]}

    monkeypatch.setattr(numbers, "banded", banded)
    assert lab.say("compute design", text="t", quality="band") == {"type": "band", "low": [0.5]}
    lab.say("compute design", text="t", quality="band", of="solved")
    assert asked == [("t", "screening"), ("t", "solved")]


def test_how_far_it_is_is_told_the_page_that_asked_as_long_as_it_is_open(lab: Talk) -> None:
    page, other = lab.opened(), lab.opened()
    context = contextvars.copy_context()
    context.run(PAGE.set, page)  # type: ignore[arg-type]
    context.run(lab.say, "compute design", text=STATOR, quality="solved")
    assert lab.told is not None
    lab.told("sweeping", 0.25)
    line = {"type": "computing", "quality": "solved", "text": "sweeping", "share": 0.25}
    assert page.heard == [line]
    del lab.lab.pages[page]  # type: ignore[arg-type]
    lab.told("sweeping", 0.5)
    assert (page.heard, other.heard) == ([line], [])


def test_a_page_cancels_its_own_work(lab: Talk, monkeypatch: pytest.MonkeyPatch) -> None:
    cancelled: list[Any] = []
    monkeypatch.setattr(type(lab.lab), "cancel", lambda _, page: cancelled.append(page))
    context = contextvars.copy_context()
    context.run(PAGE.set, "a")  # type: ignore[arg-type]
    assert context.run(lab.say, "cancel design") == {"type": "cancelled"}
    assert cancelled == ["a"]


def test_a_display_is_saved_once_unless_it_may_be_replaced(lab: Talk) -> None:
    file = lab.folder / "mine.toml"
    assert "actuator" in lab.refused("save display", text='name = "x"', name="mine")
    assert not file.exists()
    lab.say("save display", text=STATOR, name="mine")
    changed = STATOR + "# newer\n"
    assert "mine.toml exists" in lab.refused("save display", text=changed, name="mine")
    assert file.read_text(encoding="utf-8") == STATOR
    lab.say("save display", text=changed, name="mine", replace=True)
    assert file.read_text(encoding="utf-8") == changed


@pytest.mark.parametrize(
    ("kind", "field", "most", "others"),
    [
        ("open display", "preset", 100, {}),
        ("open display", "file", 100, {}),
        ("open display", "text", 400_000, {}),
        ("edit display", "text", 400_000, {"path": "", "value": ""}),
        ("edit display", "path", 200, {"text": "", "value": ""}),
        ("edit display", "value", 2000, {"text": "", "path": ""}),
        ("compute design", "text", 400_000, {"quality": "band"}),
        ("compute design", "voltage", 100, {"text": "", "quality": "band"}),
        ("compute design", "surface", 100, {"text": "", "quality": "band"}),
        ("compute design", "force", 100, {"text": "", "quality": "band"}),
        ("compute design", "path", 200, {"text": "", "quality": "band"}),
        ("compute design", "value", 2000, {"text": "", "quality": "band"}),
        ("save display", "text", 400_000, {"name": ""}),
        ("save display", "name", 64, {"text": ""}),
    ],
)
def test_texts_that_are_too_long_are_refused(
    lab: Talk, kind: str, field: str, most: int, others: dict[str, Any]
) -> None:
    require_refused_if_longer(lab, kind, field, most, others)


def test_a_failed_request_says_so_to_its_asker(lab: Talk) -> None:
    text = json.dumps({"id": 3, "type": "compute design", "text": "", "quality": "rough"})
    found = asyncio.run(lab.lab.experimenter.answer(text))
    assert (found["id"], found["type"]) == (3, "error")
    assert found["message"].startswith("quality: ")
