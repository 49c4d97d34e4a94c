"""The messages of the Design area: open, edit, compute, save."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from squeezefilm.core import presets
from squeezefilm.core.errors import InputError
from squeezefilm.core.regular_file import read_toml_text
from squeezefilm.core.results import write_whole
from squeezefilm.lab.designing import form as description
from squeezefilm.lab.designing import numbers as design
from squeezefilm.lab.files import existing, fresh
from squeezefilm.lab.wire import Answer, FileName, Name, Request, Text, as_text
from squeezefilm.lab.worker import PAGE

if TYPE_CHECKING:
    from squeezefilm.lab.server import Lab


class ComputeDesign(Request, design.DesignPoint):
    """A display at a working point, and how it is computed."""

    quality: Literal["screening", "solved", "band"]
    of: Literal["screening", "solved"] = "screening"


class DesignArea:
    """Answers the Design area's messages."""

    def __init__(self, lab: Lab) -> None:
        self._lab = lab
        add = lab.experimenter.add
        add("ping", self._ping)
        add("displays", self._listing)
        add("open display", self._open_display)
        add("edit display", self._edit)
        add("compute design", self._compute, ComputeDesign)
        add("cancel design", self._cancel)
        add("save display", self._save)

    async def _listing(self) -> Answer:
        saved = sorted(path.stem for path in self._lab.folder.glob("*.toml"))
        return {"type": "displays", "presets": list(presets.display_names()), "saved": saved}

    async def _open_display(
        self, preset: Name | None = None, file: Name | None = None, text: Text | None = None
    ) -> Answer:
        given = [source for source in (preset, file, text) if source is not None]
        if len(given) != 1:
            raise InputError("say which display: a preset, a file or a text, one of them")
        if preset is not None:
            text = description.preset_text(preset)
        elif file is not None:
            text = read_toml_text(existing(self._lab.folder, file, ".toml"))
        return await self._display(design.opened, str(text))

    async def _display(self, work: Callable[..., Answer], *arguments: str) -> Answer:
        return {"type": "display", **await self._lab.quick.do(None, work, *arguments)}

    async def _edit(self, text: Text, path: design.ValuePath, value: design.TypedValue) -> Answer:
        return await self._display(design.changed, text, path, value)

    async def _compute(self, asked: ComputeDesign) -> Answer:
        quick, slow, page = self._lab.quick, self._lab.slow, PAGE.get(None)

        def told(text: str, share: float) -> None:
            if page in self._lab.pages:
                line = {"type": "computing", "quality": asked.quality, "text": text, "share": share}
                self._lab.pages[page].say(as_text(line))

        if asked.quality == "band":
            answer = await slow.do(
                "band", design.banded, asked, asked.of, gives_way=True, told=told
            )
            return {"type": "band", **answer}
        worker, hears = (quick, None) if asked.quality == "screening" else (slow, told)
        answer = await worker.do(
            asked.quality, design.designed, asked, asked.quality, gives_way=True, told=hears
        )
        return {"type": "design", **answer}

    async def _cancel(self) -> Answer:
        self._lab.cancel(PAGE.get(None))
        return {"type": "cancelled"}

    async def _save(self, text: Text, name: FileName, replace: bool = False) -> Answer:
        await self._lab.quick.do(None, description.name_of, text)
        file = fresh(self._lab.folder, name, ".toml", replace=replace)
        write_whole(file, text)
        return {"type": "saved", "file": file.name}

    async def _ping(self) -> Answer:
        return {"type": "pong"}
