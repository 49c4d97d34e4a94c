"""The messages of the Feel area: textures, pictures, parity, strokes."""

from __future__ import annotations

import base64
import binascii
import csv
import io
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Literal

from pydantic import Field

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.regular_file import read_toml_text
from squeezefilm.core.results import write_whole
from squeezefilm.lab.designing import program as feel
from squeezefilm.lab.files import existing, fresh
from squeezefilm.lab.wire import LONGEST_TEXT, Answer, Request
from squeezefilm.physics.texture_files.texture_file import load_texture

if TYPE_CHECKING:
    from squeezefilm.lab.server import Lab

COLUMNS = (
    "time_s",
    "x_m",
    "y_m",
    "speed_m_per_s",
    "wanted_amplitude_m",
    "amplitude_m",
    "relative_friction",
    "tangential_force_N",
)
"""Columns of a stroke's table."""
MOST_ROWS = 200_000


class OnDisplay(Request):
    """A texture (a preset or a text) on a display's text."""

    display: str = Field(max_length=LONGEST_TEXT)
    preset: str | None = Field(None, max_length=100)
    texture: str | None = Field(None, max_length=LONGEST_TEXT)
    quality: Literal["screening", "solved"] = "screening"


class TextureText(Request):
    """The text of a preset texture or of one saved here."""

    preset: str | None = Field(None, max_length=100)
    file: str | None = Field(None, max_length=100)


class AddPicture(Request):
    """A PNG or JPEG in base64, and the side of its pixels with the unit."""

    name: str = Field(max_length=64)
    data: str = Field(max_length=7_000_000)
    pixel: str = Field(max_length=100)
    replace: bool = False


class SaveTexture(Request):
    """A texture's text under a name."""

    name: str = Field(max_length=64)
    text: str = Field(max_length=LONGEST_TEXT)
    replace: bool = False


class SaveStroke(Request):
    """Rows of a stroke, as `COLUMNS` names them, under a name."""

    name: str = Field(max_length=64)
    rows: list[tuple[float, float, float, float, float, float, float, float]] = Field(
        max_length=MOST_ROWS
    )
    replace: bool = False


class FeelArea:
    """Answers the Feel area's messages."""

    def __init__(self, lab: Lab) -> None:
        self._lab, self._folder, self._quick = lab, lab.folder / "textures", lab.workers.quick
        add = lab.experimenter.add
        add("textures", Request, self._listing)
        add("texture text", TextureText, self._text_of)
        add("load texture", OnDisplay, self._load)
        add("parity", OnDisplay, self._parity)
        add("add picture", AddPicture, self._add_picture)
        add("save texture", SaveTexture, self._save_texture)
        add("save stroke", SaveStroke, self._save_stroke)

    async def _listing(self, _: Request) -> Answer:
        kept = [
            {"name": name, "title": load_texture(name).title} for name in presets.texture_names()
        ]
        saved = sorted(path.stem for path in self._folder.glob("*.toml"))
        return {"type": "textures", "presets": kept, "saved": saved}

    async def _text_of(self, asked: TextureText) -> Answer:
        if (asked.preset is None) == (asked.file is None):
            raise InputError("say which texture: a preset or a saved file, one of them")
        if asked.preset is not None:
            file = presets.resolve(asked.preset, "texture")
            if asked.preset not in presets.texture_names():
                raise InputError(f"'{asked.preset}' is no preset texture")
        else:
            file = existing(self._folder, str(asked.file), ".toml")
        text = read_toml_text(file)
        return {"type": "texture text", "text": text}

    async def _on_display(self, work: Callable[..., Answer], asked: OnDisplay) -> Answer:
        # What takes seconds stays out of a drag's way.
        line = self._quick if asked.quality == "screening" else self._lab.workers.slow
        texture = feel.TextureOnDisplay(**asked.own, folder=self._folder)
        return await line.do(work.__name__, work, texture, gives_way=True)

    async def _load(self, asked: OnDisplay) -> Answer:
        return {"type": "feel", **await self._on_display(feel.feel, asked)}

    async def _parity(self, asked: OnDisplay) -> Answer:
        return {"type": "parity", **await self._on_display(feel.parity, asked)}

    async def _add_picture(self, asked: AddPicture) -> Answer:
        try:
            data = base64.b64decode(asked.data, validate=True)
        except binascii.Error as error:
            raise InputError("the picture's data are no base64; drop it again") from error
        suffix = ".jpg" if data[:2] == b"\xff\xd8" else ".png"
        file = fresh(self._folder, asked.name, suffix, replace=asked.replace)
        rows, columns, note = await self._quick.do(None, feel.pixels_of, data, asked.name)
        pixel = si.parse_quantity(asked.pixel, si.Unit("m"))
        if not 1e-6 <= pixel <= 0.1:
            raise InputError(f"a pixel of {asked.pixel}: it may have 1 µm to 10 cm")
        write_whole(file, data)
        text = (
            f'title = "{file.stem}, {columns} × {rows} pixels of {asked.pixel}"\n\n[texture]\n'
            'type = "relative_friction"\nlow = 0.6\nhigh = 1.0\n\n[texture.pattern]\n'
            f'type = "image_file"\nfile = "{file.name}"\npixel = "{asked.pixel}"\n'
            'outside = "zero"\n'
        )
        await self._quick.do(None, feel.title_of, text, self._folder)
        return {"type": "texture text", "text": text, "note": note}

    async def _save_texture(self, asked: SaveTexture) -> Answer:
        await self._quick.do(None, feel.title_of, asked.text, self._folder)
        file = fresh(self._folder, asked.name, ".toml", replace=asked.replace)
        self._folder.mkdir(exist_ok=True)
        write_whole(file, asked.text)
        return {"type": "saved", "file": f"textures/{file.name}"}

    async def _save_stroke(self, asked: SaveStroke) -> Answer:
        folder, replace = self._lab.folder / "strokes", asked.replace
        file = fresh(folder, asked.name, ".csv", replace=replace)
        felt = fresh(folder, f"{file.stem}.felt", ".csv", replace=replace)
        file.parent.mkdir(exist_ok=True)
        # The motion alone is what a stroke's file has elsewhere; what was felt lies beside it.
        write_whole(felt, _csv(COLUMNS, asked.rows))
        write_whole(file, _csv(COLUMNS[:3], [row[:3] for row in asked.rows]))
        return {"type": "saved", "file": f"strokes/{file.name}"}


def _csv(columns: Sequence[str], rows: Iterable[Sequence[float]]) -> str:
    text = io.StringIO()
    table = csv.writer(text)
    table.writerow(columns)
    table.writerows(rows)
    return text.getvalue()
