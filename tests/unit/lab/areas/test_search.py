"""What the Search area answers, what its pages hear of a search, and which plate they open."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pytest
from pydantic import ValidationError
from tests.unit.lab.areas.too_long import require_refused_if_longer
from tests.unit.lab.searching.small import TEXT, evaluated, requirements

from squeezefilm.core import config, presets
from squeezefilm.design.search.candidate import display_of
from squeezefilm.lab import search_process as process
from squeezefilm.lab import search_process as shown
from squeezefilm.lab.areas import search as search_area
from squeezefilm.lab.areas.search import (
    SearchArea,
)
from squeezefilm.lab.search_process import SearchProcess
from squeezefilm.physics.display import Display

if TYPE_CHECKING:
    from .conftest import Talk

ASKED = requirements()
PLATE = shown.plate(ASKED, evaluated(ASKED, 0.3, relative_friction=0.3, finest_period=4e-4))
FOUND = {
    "type": "search found", "left": "about 9 s", "stage": "solving", "screened": 40, "solved": 2,
    "screened_front": [[0.3, 5e-4]], "front": [PLATE], "reference": None,
}  # fmt: skip


class Process:
    """What the lab's process was asked; it searches nothing."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.begun: list[dict[str, Any]] = []
        self.asked: list[str] = []
        self.running = False

        def start(_: SearchProcess, work: Callable[..., None], **how: Any) -> None:
            assert work is process.search
            self.begun.append(how)

        monkeypatch.setattr(SearchProcess, "start", start)
        for name in ("stop", "kill", "close"):
            monkeypatch.setattr(SearchProcess, name, lambda _, name=name: self.asked.append(name))
        monkeypatch.setattr(SearchProcess, "running", property(lambda _: self.running))


@pytest.fixture
def searcher(monkeypatch: pytest.MonkeyPatch) -> Process:
    return Process(monkeypatch)


@pytest.fixture
def lab(talk: Talk, searcher: Process) -> Talk:
    talk.area = SearchArea(talk.lab)  # type: ignore[attr-defined]
    return talk


def hears(lab: Talk, **message: Any) -> None:
    """The area hears a message of the process."""
    lab.area._told(dict(message))  # type: ignore[attr-defined]


def searched(lab: Talk) -> Any:
    return lab.say("what searches")["search"]


def test_presets_are_listed_with_what_was_searched_here(lab: Talk) -> None:
    kept = list(presets.names("requirements"))
    assert lab.say("requirements") == {"type": "requirements", "presets": kept, "saved": []}
    lab.say("start search", text=TEXT)
    (saved,) = lab.say("requirements")["saved"]
    assert saved.startswith("biet2008-plate-")
    preset = presets.resolve("biet2008-plate", "requirements").read_text(encoding="utf-8")
    for how, text in (({"preset": "biet2008-plate"}, preset), ({"file": saved}, TEXT)):
        assert lab.say("requirements text", **how) == {"type": "requirements text", "text": text}
    for wrong in ({}, {"preset": "biet2008-plate", "file": saved}):
        assert "one of them" in lab.refused("requirements text", **wrong)
    assert "is no preset" in lab.refused("requirements text", preset="../biet2008-plate")
    for name in ("../x", "a/b", ".."):
        assert "no name for a file" in lab.refused("requirements text", file=name)
    assert "no file requirements.toml" in lab.refused("requirements text", file="other")


def test_requirements_are_checked_where_things_are_parsed(lab: Talk) -> None:
    found = lab.say("check requirements", text=TEXT)
    assert (found["type"], found["name"]) == ("requirements checked", "biet2008-plate")
    wrong = TEXT.replace('length = "73 mm"', 'length = "73"')
    assert "line 11" in lab.refused("check requirements", text=wrong)
    assert lab.asked == [("quick", "requirements", "asked_of", False)] * 2


def test_a_search_is_started_as_it_was_asked_for(lab: Talk, searcher: Process) -> None:
    page = lab.opened()
    assert searched(lab) is None
    how = {"screened": 40, "solved": 6, "seed": 7, "jobs": 2}
    assert lab.say("start search", text=TEXT, **how) == {"type": "searching"}
    (begun,) = searcher.begun
    out = begun.pop("out")
    assert begun == {"text": TEXT, "folder": lab.folder, **how}
    assert out.parent == lab.folder / "searches"
    assert (out / "requirements.toml").read_text(encoding="utf-8") == TEXT
    now = searched(lab)
    assert {key: now["asked"][key] for key in how} == how
    assert now["asked"]["folder"] == f"searches/{out.name}"
    assert now["asked"]["title"] == ASKED.title
    assert (now["end"], now["stopping"]) == (None, False)
    assert [one["type"] for one in page.heard] == ["search"]


def test_what_is_wrong_is_said_before_anything_is_started(lab: Talk, searcher: Process) -> None:
    wrong = TEXT.replace('voltage = "15 V"', 'voltage = "-15 V"')
    assert "line 21" in lab.refused("start search", text=wrong)
    for what in (
        {"screened": 0}, {"screened": 1_000_001}, {"solved": -1}, {"seed": -1}, {"jobs": 0},
        {"jobs": 65}, {"screened": 1.5}, {"seed": 2**53 + 1}, {"out": "/tmp"}, {"scheduler": "x"},
    ):  # fmt: skip
        assert next(iter(what)) in lab.refused("start search", text=TEXT, **what)
    assert searcher.begun == []
    assert not (lab.folder / "searches").exists()


def test_one_search_at_a_time(lab: Talk, searcher: Process) -> None:
    lab.say("start search", text=TEXT)
    assert "stop that search first" in lab.refused("start search", text=TEXT)
    # It said that it ended, and its process is still there.
    hears(lab, type="search ended", failed=False, message="finished", result={})
    searcher.running = True
    assert "stop that search first" in lab.refused("start search", text=TEXT)
    searcher.running = False
    lab.say("start search", text=TEXT)
    assert len(searcher.begun) == 2


def test_every_page_hears_what_was_found_and_one_that_comes_later_sees_it(lab: Talk) -> None:
    hears(lab, **FOUND)  # of a search that this area does not know: nothing
    page, other, person = lab.opened(), lab.opened(), lab.opened(is_participant=True)
    lab.say("start search", text=TEXT)
    hears(lab, type="search says", text="screening strips")
    hears(lab, **FOUND)
    assert [one["type"] for one in page.heard] == ["search", "search says", "search"]
    assert other.heard == page.heard
    assert person.heard == []
    shown_now = page.heard[-1]["search"]
    assert shown_now["says"] == "screening strips"
    assert shown_now["left"] == "about 9 s"
    assert shown_now["front"][0]["name"] == PLATE["name"]
    late = searched(lab)
    assert {**late, "seconds": 0} == {**shown_now, "seconds": 0}
    hears(lab, type="search says", text="what is made")
    assert searched(lab)["left"] == ""
    result = {"chosen": PLATE["name"], "front": [PLATE], "limits": ["a"], "stopped": False}
    hears(lab, type="search ended", failed=False, message="finished", result=result)
    end = searched(lab)
    assert end["end"] == {"failed": False, "message": "finished"}
    assert (end["chosen"], end["limits"], end["screened"]) == (PLATE["name"], ["a"], 40)
    assert end["seconds"] == searched(lab)["seconds"]


def test_a_search_that_fails_keeps_what_it_showed_and_says_why(lab: Talk) -> None:
    lab.say("start search", text=TEXT)
    hears(lab, **FOUND)
    hears(lab, type="search ended", failed=True, message="the disk is full")
    found = searched(lab)
    assert found["end"] == {"failed": True, "message": "the disk is full"}
    assert found["front"][0]["name"] == PLATE["name"]


def test_a_plate_is_opened_by_its_name_while_the_search_runs_and_after(lab: Talk) -> None:
    assert "search again" in lab.refused("open found", name=PLATE["name"])
    lab.say("start search", text=TEXT)
    assert "is on the front" in lab.refused("open found", name=PLATE["name"])
    hears(lab, **FOUND)
    for _ in range(2):
        found = lab.say("open found", name=PLATE["name"])
        assert found["type"] == "found display"
        design = evaluated(ASKED, 0.3).design
        assert config.load_text(Display, found["text"]) == display_of(ASKED, design)
        hears(lab, type="search ended", failed=False, message="finished", result={})
    assert lab.asked[-1] == ("quick", None, "display_text", False)
    assert "is on the front" in lab.refused("open found", name="../x")


def test_a_stop_is_asked_for_once_and_then_insisted_on(
    lab: Talk, searcher: Process, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert lab.say("stop search") == {"type": "stopping"}
    assert searcher.asked == []
    lab.say("start search", text=TEXT)
    lab.say("stop search")
    assert (searcher.asked, searched(lab)["stopping"]) == (["stop"], True)
    lab.say("stop search")
    assert searcher.asked == ["stop", "kill"]
    hears(lab, type="search ended", failed=False, message="stopped")
    lab.say("stop search")
    assert searcher.asked == ["stop", "kill"]


def test_a_search_that_does_not_stop_is_ended(
    lab: Talk, searcher: Process, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(search_area, "LONGEST_STOP", 0.01)

    async def stopped(ends: bool) -> None:
        await lab.lab.experimenter.answer(
            json.dumps({"id": 1, "type": "start search", "text": TEXT})
        )
        await lab.lab.experimenter.answer(json.dumps({"id": 2, "type": "stop search"}))
        if ends:
            hears(lab, type="search ended", failed=False, message="stopped")
        await asyncio.sleep(0.1)

    asyncio.run(stopped(ends=True))
    assert searcher.asked == ["stop"]
    asyncio.run(stopped(ends=False))
    assert searcher.asked == ["stop", "stop", "kill"]


def test_the_end_of_the_lab_is_the_end_of_the_search(lab: Talk, searcher: Process) -> None:
    lab.lab.close()
    assert searcher.asked == ["close"]


def test_what_the_process_says_reaches_the_pages_by_the_servers_loop(lab: Talk) -> None:
    area: Any = lab.area  # type: ignore[attr-defined]
    area._tell({"type": "search says", "text": "before any"})

    async def told() -> None:
        await lab.lab.experimenter.answer(
            json.dumps({"id": 1, "type": "start search", "text": TEXT})
        )
        area._tell({"type": "search says", "text": "from a thread"})
        await asyncio.sleep(0)
        await asyncio.sleep(0)

    asyncio.run(told())
    assert searched(lab)["says"] == "from a thread"
    # After the server's loop has ended nobody is told, and nothing fails.
    area._tell({"type": "search says", "text": "too late"})
    assert searched(lab)["says"] == "from a thread"


@pytest.mark.parametrize(
    ("kind", "field", "most"),
    [
        ("requirements text", "preset", 100),
        ("requirements text", "file", 100),
        ("check requirements", "text", 400_000),
        ("start search", "text", 400_000),
        ("open found", "name", 64),
    ],
)
def test_texts_that_are_too_long_are_refused(lab: Talk, kind: str, field: str, most: int) -> None:
    require_refused_if_longer(lab, kind, field, most, {})


def test_nothing_that_is_not_asked_for_is_taken(lab: Talk) -> None:
    with pytest.raises(ValidationError):
        lab.model("start search")(id=1, type="t", text="", out="/tmp")
