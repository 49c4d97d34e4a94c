"""The messages of the Design area: open, edit, compute, save."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from pydantic import Field

from squeezefilm.core import presets
from squeezefilm.core.errors import InputError
from squeezefilm.core.regular_file import read_toml_text
from squeezefilm.core.results import write_whole
from squeezefilm.lab.designing import form as description
from squeezefilm.lab.designing import numbers as design
from squeezefilm.lab.files import existing, fresh
from squeezefilm.lab.wire import LONGEST_TEXT, Answer, Request, as_text
from squeezefilm.lab.worker import PAGE

if TYPE_CHECKING:
    from squeezefilm.lab.server import Lab


class OpenDisplay(Request):
    """A preset by name, a file saved in the lab's folder, or a TOML text."""

    preset: str | None = Field(None, max_length=100)
    file: str | None = Field(None, max_length=100)
    text: str | None = Field(None, max_length=LONGEST_TEXT)


class EditDisplay(Request):
    """Edit of one value of a display's text."""

    text: str = Field(max_length=LONGEST_TEXT)
    path: str = Field(max_length=200)
    value: str = Field(max_length=description.LONGEST_VALUE)


class ComputeDesign(Request):
    """A display at a working point; `edit` is made on the way, so that a slider asks once."""

    text: str = Field(max_length=LONGEST_TEXT)
    quality: Literal["screening", "solved", "band"]
    of: Literal["screening", "solved"] = "screening"
    voltage: str | None = Field(None, max_length=100)
    surface: str | None = Field(None, max_length=100)
    force: str | None = Field(None, max_length=100)
    path: str | None = Field(None, max_length=200)
    value: str | None = Field(None, max_length=description.LONGEST_VALUE)


class SaveDisplay(Request):
    """A display's text under a name in the lab's folder."""

    text: str = Field(max_length=LONGEST_TEXT)
    name: str = Field(max_length=64)
    replace: bool = False


class DesignArea:
    """Answers the Design area's messages."""

    def __init__(self, lab: Lab) -> None:
        self._lab = lab
        add = lab.experimenter.add
        add("ping", Request, self._ping)
        add("displays", Request, self._listing)
        add("open display", OpenDisplay, self._open_display)
        add("edit display", EditDisplay, self._edit)
        add("compute design", ComputeDesign, self._compute)
        add("cancel design", Request, self._cancel)
        add("save display", SaveDisplay, self._save)

    async def _listing(self, _: Request) -> Answer:
        saved = sorted(path.stem for path in self._lab.folder.glob("*.toml"))
        return {"type": "displays", "presets": list(presets.display_names()), "saved": saved}

    async def _open_display(self, asked: OpenDisplay) -> Answer:
        given = [source for source in (asked.preset, asked.file, asked.text) if source is not None]
        if len(given) != 1:
            raise InputError("say which display: a preset, a file or a text, one of them")
        if asked.preset is not None:
            text = description.preset_text(asked.preset)
        elif asked.file is not None:
            file = existing(self._lab.folder, asked.file, ".toml")
            text = read_toml_text(file)
        else:
            text = str(asked.text)
        return await self._display(design.opened, text)

    async def _display(self, work: Callable[..., Answer], *arguments: str) -> Answer:
        return {"type": "display", **await self._lab.workers.quick.do(None, work, *arguments)}

    async def _edit(self, asked: EditDisplay) -> Answer:
        return await self._display(design.changed, asked.text, asked.path, asked.value)

    async def _compute(self, asked: ComputeDesign) -> Answer:
        point = design.DesignPoint(**asked.model_dump(exclude={"id", "type", "quality", "of"}))
        quick, slow, page = self._lab.workers.quick, self._lab.workers.slow, PAGE.get(None)

        def told(text: str, share: float) -> None:
            if page in self._lab.pages:
                line = {"type": "computing", "quality": asked.quality, "text": text, "share": share}
                self._lab.pages[page].say(as_text(line))

        if asked.quality == "band":
            answer = await slow.do(
                "band", design.banded, point, asked.of, gives_way=True, told=told
            )
            return {"type": "band", **answer}
        worker, hears = (quick, None) if asked.quality == "screening" else (slow, told)
        answer = await worker.do(
            asked.quality, design.designed, point, asked.quality, gives_way=True, told=hears
        )
        return {"type": "design", **answer}

    async def _cancel(self, _: Request) -> Answer:
        self._lab.workers.cancel(PAGE.get(None))
        return {"type": "cancelled"}

    async def _save(self, asked: SaveDisplay) -> Answer:
        await self._lab.workers.quick.do(None, description.name_of, asked.text)
        file = fresh(self._lab.folder, asked.name, ".toml", replace=asked.replace)
        write_whole(file, asked.text)
        return {"type": "saved", "file": file.name}

    async def _ping(self, _: Request) -> Answer:
        return {"type": "pong"}
