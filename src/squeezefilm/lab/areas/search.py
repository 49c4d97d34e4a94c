"""The messages of the Search area: requirements, a search that runs, the plates that it finds."""

from __future__ import annotations

import asyncio
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from pydantic import Field

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import DESIGNS_SCREENED, DESIGNS_SOLVED
from squeezefilm.core.regular_file import read_toml_text
from squeezefilm.core.results import write_whole
from squeezefilm.lab.files import existing, named
from squeezefilm.lab.search_process import SearchProcess, asked_of, display_text, folder_of, search
from squeezefilm.lab.wire import Answer, FileName, Name, Request, Seed, Text

if TYPE_CHECKING:
    from squeezefilm.lab.server import Lab

MOST_JOBS = 64
LONGEST_STOP: si.Second = 20.0
"""Longest wait for a search that was stopped to say what it found; then its process is ended."""
_REQUIREMENTS = "requirements"


class StartSearch(Request):
    """Request for a search by requirements as TOML text: how many designs are looked at and solved,
    the seed, and processes."""

    text: Text
    screened: int = Field(2000, ge=int(DESIGNS_SCREENED.least), le=int(DESIGNS_SCREENED.most))
    solved: int = Field(120, ge=int(DESIGNS_SOLVED.least), le=int(DESIGNS_SOLVED.most))
    seed: Seed = 1
    jobs: int = Field(1, ge=1, le=MOST_JOBS)


@dataclass(slots=True)
class _Search:
    """The search that runs, or the last one: what was asked, and what is known of it."""

    text: str
    asked: dict[str, Any]
    began: si.Second = field(default_factory=time.monotonic)
    took: si.Second | None = None
    says: str = "starting"
    known: dict[str, Any] = field(default_factory=dict)
    stopping: bool = False
    end: dict[str, Any] | None = None

    def message(self) -> Answer:
        """Message that a page gets."""
        seconds = time.monotonic() - self.began if self.took is None else self.took
        return {
            "asked": self.asked,
            "seconds": seconds,
            "says": self.says,
            "stopping": self.stopping,
            "end": self.end,
            **self.known,
        }


class SearchArea:
    """Answers the Search area's messages; `process` has the process that searches."""

    def __init__(self, lab: Lab) -> None:
        self._lab, self._folder = lab, lab.folder / "searches"
        self._loop: asyncio.AbstractEventLoop | None = None
        self._search: _Search | None = None
        self.process = SearchProcess(self._tell)
        lab.closing.append(self.process.close)
        add = lab.experimenter.add
        add("requirements", self._listing)
        add("requirements text", self._text_of)
        add("check requirements", self._check)
        add("start search", self._start, StartSearch)
        add("what searches", self._what)
        add("stop search", self._stop)
        add("open found", self._open)

    async def _listing(self) -> Answer:
        files = self._folder.glob(f"*/{_REQUIREMENTS}.toml")
        saved = sorted(path.parent.name for path in files)
        return {
            "type": "requirements",
            "presets": list(presets.names("requirements")),
            "saved": saved,
        }

    async def _text_of(self, preset: Name | None = None, file: Name | None = None) -> Answer:
        """The text of preset requirements, or of those of a search that was begun here."""
        if (preset is None) == (file is None):
            raise InputError("say which requirements: a preset or those of a search, one of them")
        if preset is not None:
            if preset not in presets.names("requirements"):
                raise InputError(f"'{preset}' is no preset of requirements")
            path = presets.resolve(preset, "requirements")
        else:
            path = existing(named(self._folder, str(file), ""), _REQUIREMENTS, ".toml")
        return {"type": "requirements text", "text": read_toml_text(path)}

    async def _asked(self, text: str) -> dict[str, Any]:
        return await self._lab.quick.do("requirements", asked_of, text, self._lab.folder)

    async def _check(self, text: Text) -> Answer:
        return {"type": "requirements checked", **await self._asked(text)}

    async def _start(self, asked: StartSearch) -> Answer:
        how = asked.model_dump(include={"screened", "solved", "seed", "jobs"})
        wanted = await self._asked(asked.text)
        if self.process.running or (self._search is not None and self._search.end is None):
            raise InputError(SearchProcess.in_use)
        place = named(self._folder, folder_of(wanted["name"], asked.text), "")
        place.mkdir(parents=True, exist_ok=True)
        write_whole(place / f"{_REQUIREMENTS}.toml", asked.text)
        self._loop = asyncio.get_running_loop()
        self.process.start(search, text=asked.text, folder=self._lab.folder, out=place, **how)
        self._search = _Search(asked.text, {**wanted, **how, "folder": f"searches/{place.name}"})
        self._tell_pages()
        return {"type": "searching"}

    async def _what(self) -> Answer:
        return self._message()

    async def _stop(self) -> Answer:
        running = self._search
        if running is not None and running.end is None:
            if running.stopping:
                # Who presses it again does not want to wait.
                self.process.kill()
            else:
                running.stopping = True
                self.process.stop()
                asyncio.get_running_loop().call_later(LONGEST_STOP, self._end, running)
                self._tell_pages()
        return {"type": "stopping"}

    def _end(self, search: _Search) -> None:
        if search is self._search and search.end is None:
            self.process.kill()

    async def _open(self, name: FileName) -> Answer:
        running = self._search
        front = [] if running is None else running.known.get("front", [])
        design = next((plate["design"] for plate in front if plate["name"] == name), None)
        if running is None or design is None:
            raise InputError(f"no plate {name} is on the front; search again")
        work = display_text, running.text, self._lab.folder, design["shape"], design["values"]
        return {"type": "found display", "text": await self._lab.quick.do(None, *work)}

    def _tell(self, message: dict[str, Any]) -> None:
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._told, message)

    def _told(self, message: dict[str, Any]) -> None:
        """The process said something."""
        search, kind = self._search, message.pop("type")
        if search is None:
            return
        if kind == "search says":
            search.says, search.known["left"] = message["text"], ""
            self._lab.tell({"type": kind, **message})
            return
        if kind == SearchProcess.ended:
            search.took = time.monotonic() - search.began
            search.known |= message.pop("result", {})
            search.end, search.says = message, message["message"]
        else:
            search.known |= message
        self._tell_pages()

    def _message(self) -> Answer:
        return {"type": "search", "search": self._search and self._search.message()}

    def _tell_pages(self) -> None:
        self._lab.tell(self._message())
