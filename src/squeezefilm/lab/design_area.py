"""The messages of the Design area: open, edit, compute, save."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from squeezefilm import presets
from squeezefilm.errors import InputError
from squeezefilm.lab import description, design
from squeezefilm.lab.field_limits import allowed
from squeezefilm.lab.files import existing, fresh
from squeezefilm.lab.wire import LONGEST_TEXT, Answer, Request
from squeezefilm.results import write_whole

if TYPE_CHECKING:
    from squeezefilm.lab.server import Lab


class OpenDisplay(Request):
    """A preset by name, a file saved in the lab's folder, or a TOML text."""

    preset: str | None = Field(None, max_length=100)
    file: str | None = Field(None, max_length=100)
    text: str | None = Field(None, max_length=LONGEST_TEXT)


class EditDisplay(Request):
    """One value of a display's text."""

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


class FieldLimits(Request):
    """A value of a display's text by its dotted path."""

    text: str = Field(max_length=LONGEST_TEXT)
    path: str = Field(max_length=200)


class SaveDisplay(Request):
    """A display's text under a name in the lab's folder."""

    text: str = Field(max_length=LONGEST_TEXT)
    name: str = Field(max_length=64)
    replace: bool = False


def add_design(lab: Lab) -> None:
    """Let the lab answer the Design area's messages."""

    async def listing(_: Request) -> Answer:
        saved = sorted(path.stem for path in lab.folder.glob("*.toml"))
        return {"type": "displays", "presets": list(presets.names()), "saved": saved}

    async def open_display(asked: OpenDisplay) -> Answer:
        given = [one for one in (asked.preset, asked.file, asked.text) if one is not None]
        if len(given) != 1:
            raise InputError("say which display: a preset, a file or a text, one of them")
        if asked.preset is not None:
            text = description.preset_text(asked.preset)
        elif asked.file is not None:
            text = existing(lab.folder, asked.file, ".toml").read_text(encoding="utf-8")
        else:
            text = str(asked.text)
        return _display(text)

    async def edit(asked: EditDisplay) -> Answer:
        return _display(description.edited(asked.text, asked.path, asked.value))

    async def limits(asked: FieldLimits) -> Answer:
        found = await lab.workers.quick.do("limits", allowed, asked.text, asked.path)
        return {"type": "field limits", "path": asked.path, "allowed": found}

    async def compute(asked: ComputeDesign) -> Answer:
        text = asked.text
        if asked.path is not None and asked.value is not None:
            text = description.edited(text, asked.path, asked.value)
        point = asked.voltage, asked.surface, asked.force
        if asked.quality == "band":
            found = await lab.workers.slow.do("band", design.band, text, asked.of, *point)
            return {"type": "band", **found}
        line = lab.workers.quick if asked.quality == "screening" else lab.workers.slow
        found = await line.do(f"design {asked.quality}", design.design, text, asked.quality, *point)
        return {"type": "design", "text": text, **found}

    async def save(asked: SaveDisplay) -> Answer:
        description.display_of(asked.text)
        file = fresh(lab.folder, asked.name, ".toml", replace=asked.replace)
        write_whole(file, asked.text)
        return {"type": "saved", "file": file.name}

    async def ping(_: Request) -> Answer:
        return {"type": "pong"}

    add = lab.experimenter.add
    add("ping", Request, ping)
    add("displays", Request, listing)
    add("open display", OpenDisplay, open_display)
    add("edit display", EditDisplay, edit)
    add("field limits", FieldLimits, limits)
    add("compute design", ComputeDesign, compute)
    add("save display", SaveDisplay, save)


def _display(text: str) -> Answer:
    display = description.display_of(text)
    return {
        "type": "display",
        "text": text,
        "name": display.name,
        "title": display.title,
        "form": description.form(text),
        "outline": design.outline(text),
    }
