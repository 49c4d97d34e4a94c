"""A page's conversation: each message is answered as its own, and an end lets go of everything."""

from __future__ import annotations

import asyncio
import json
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.lab import server
from squeezefilm.lab.server import MOST_WAITING, converse
from squeezefilm.lab.worker import PAGE, SupersededError


class Page:
    """A page that says these messages, and goes."""

    def __init__(self, *messages: str | None) -> None:
        self.messages, self.accepted = list(messages), False

    async def accept(self) -> None:
        """Be open."""
        self.accepted = True

    async def receive(self) -> dict[str, Any]:
        """The next message, after what can be answered at once was."""
        for _ in range(5):
            await asyncio.sleep(0)
        if not self.messages:
            return {"type": "websocket.disconnect"}
        return {"type": "websocket.receive", "text": self.messages.pop(0)}


class Line:
    """What a page is told."""

    def __init__(self, page: Page, is_participant: bool = False) -> None:
        self.page, self.is_participant, self.closed = page, is_participant, False
        self.said: list[Any] = []
        self.refused: list[int] = []

    def say(self, text: str) -> None:
        """Keep it."""
        self.said.append(json.loads(text))

    def refuse(self, code: int, reason: str) -> None:
        """Keep it."""
        assert reason
        self.refused.append(code)

    def close(self) -> None:
        """Keep that it was."""
        self.closed = True


class Dispatcher:
    """Answers with the page that asks; waits for ever where it is told to."""

    def __init__(self) -> None:
        self.cancelled = 0

    async def answer(self, text: str) -> dict[str, Any]:
        """The answer."""
        if text == "old":
            raise SupersededError("newer")
        if text == "wait":
            try:
                await asyncio.sleep(3600)
            except asyncio.CancelledError:
                self.cancelled += 1
                raise
        return {"said": text, "asked_by": id(PAGE.get())}


def talked(
    monkeypatch: pytest.MonkeyPatch, *messages: str | None, is_participant: bool = False
) -> tuple[Any, Line, Dispatcher, Page]:
    """The lab, the line and who answered after a conversation."""
    lines: list[Line] = []

    def opened(page: Page) -> Line:
        lines.append(Line(page, is_participant))
        return lines[-1]

    monkeypatch.setattr(server, "OpenPage", opened)
    page, dispatcher = Page(*messages), Dispatcher()
    lab: Any = SimpleNamespace(pages={}, gone=[], begun=0, ended=[])
    lab.left = [lab.gone.append]

    def begin() -> None:
        lab.begun += 1

    lab.quick, lab.cancel = SimpleNamespace(begin=begin), lab.ended.append

    async def talk() -> None:
        # In a context of its own, as a server's.
        await asyncio.create_task(converse(lab, dispatcher, page))  # type: ignore[arg-type]
        await asyncio.sleep(0)

    asyncio.run(talk())
    return lab, lines[0], dispatcher, page


def test_answers_know_which_page_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    lab, line, _, page = talked(monkeypatch, "one", "two")
    assert page.accepted
    assert line.said == [{"said": said, "asked_by": id(page)} for said in ("one", "two")]
    assert (lab.pages, line.closed, lab.gone, lab.ended) == ({}, True, [page], [page])
    assert line.refused == []


@pytest.mark.parametrize(("is_participant", "begun"), [(False, 1), (True, 0)])
def test_what_computes_begins_with_the_experimenters_page(
    is_participant: bool, begun: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert talked(monkeypatch, is_participant=is_participant)[0].begun == begun


def test_work_that_newer_work_replaced_is_answered_with_its_number(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(SupersededError, "number", 5, raising=False)
    _, line, _, _ = talked(monkeypatch, "old")
    assert line.said == [{"id": 5, "type": "error", "message": "newer work took its place"}]


def test_what_is_no_text_or_too_much_at_once_is_refused_and_the_rest_answered(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    _, line, dispatcher, _ = talked(monkeypatch, None, "one", *["wait"] * (MOST_WAITING + 2))
    assert [answer["said"] for answer in line.said] == ["one"]
    assert line.refused == [1003, 1008, 1008]
    # Nobody waits for what a page that is gone asked for.
    assert dispatcher.cancelled == MOST_WAITING
