"""A lab that is talked to as its pages do, but computes in the test's own process."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from squeezefilm.lab.guard import Keys, Places
from squeezefilm.lab.server import Lab
from squeezefilm.lab.worker import Told


class Page:
    """A page that hears what it is told."""

    def __init__(self, is_participant: bool = False) -> None:
        self.is_participant = is_participant
        self.heard: list[dict[str, Any]] = []

    def say(self, text: str) -> None:
        """It is told something."""
        self.heard.append(json.loads(text))


class Talk:
    """A lab without processes; `asked` is what its lines of work were asked for.

    Each entry: the line, the slot, the work's name, and whether it gives way to newer work.
    """

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.folder = folder
        self.lab = Lab(folder, Keys(), Places(frozenset({"x"})))
        self.asked: list[tuple[str, str | None, str, bool]] = []
        self.told: Told | None = None
        for line in ("quick", "slow"):
            self._put(line, monkeypatch)

    def _put(self, line: str, monkeypatch: pytest.MonkeyPatch) -> None:
        async def do(
            slot: str | None,
            work: Callable[..., Any],
            *arguments: Any,
            gives_way: bool = False,
            told: Told | None = None,
        ) -> Any:
            self.asked.append((line, slot, work.__name__, gives_way))
            self.told = told
            return work(*arguments)

        monkeypatch.setattr(getattr(self.lab, line), "do", do)

    def say(self, type: str, **fields: Any) -> dict[str, Any]:
        """A page asks, the participant's where the type is one of its own; the answer."""
        text = json.dumps({"id": 7, "type": type, **fields})
        whom = self.lab.participant if type in self.lab.participant._known else None
        found = asyncio.run((whom or self.lab.experimenter).answer(text))
        assert found.pop("id") == 7
        return found

    def model(self, type: str) -> Any:
        """The model of messages of a type."""
        return {**self.lab.experimenter._known, **self.lab.participant._known}[type][0]

    def opened(self, is_participant: bool = False) -> Page:
        """A page of one kind, open from now on."""
        page: Any = Page(is_participant)
        self.lab.pages[page] = page
        return page  # type: ignore[no-any-return]

    def refused(self, type: str, **fields: Any) -> str:
        """The sentence with which a request is refused."""
        found = self.say(type, **fields)
        assert found["type"] == "error"
        return str(found["message"])


@pytest.fixture
def talk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Talk:
    """A lab with an empty folder and no area yet."""
    return Talk(tmp_path, monkeypatch)
