"""The messages of the Feel area: textures, pictures, parity, strokes."""

from __future__ import annotations

import base64
import binascii
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.folder import csv_text
from squeezefilm.core.regular_file import read_toml_text
from squeezefilm.core.results import write_whole
from squeezefilm.lab.designing import program as feel
from squeezefilm.lab.files import existing, fresh
from squeezefilm.lab.wire import Answer, FileName, Name, Request, Text
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
Rows = Annotated[
    list[tuple[float, float, float, float, float, float, float, float]],
    Field(max_length=200_000),
]
"""Rows of a stroke, as `COLUMNS` names them."""


class OnDisplay(Request, feel.TextureOnDisplay):
    """A texture (a preset or a text) on a display's text."""


class FeelArea:
    """Answers the Feel area's messages."""

    def __init__(self, lab: Lab) -> None:
        self._lab, self._folder, self._quick = lab, lab.folder / "textures", lab.quick
        add = lab.experimenter.add
        add("textures", self._listing)
        add("texture text", self._text_of)
        add("load texture", self._load, OnDisplay)
        add("parity", self._parity, OnDisplay)
        add("add picture", self._add_picture)
        add("save texture", self._save_texture)
        add("save stroke", self._save_stroke)

    async def _listing(self) -> Answer:
        kept = [
            {"name": name, "title": load_texture(name).title} for name in presets.texture_names()
        ]
        saved = sorted(path.stem for path in self._folder.glob("*.toml"))
        return {"type": "textures", "presets": kept, "saved": saved}

    async def _text_of(self, preset: Name | None = None, file: Name | None = None) -> Answer:
        if (preset is None) == (file is None):
            raise InputError("say which texture: a preset or a saved file, one of them")
        if preset is not None:
            path = presets.resolve(preset, "texture")
            if preset not in presets.texture_names():
                raise InputError(f"'{preset}' is no preset texture")
        else:
            path = existing(self._folder, str(file), ".toml")
        return {"type": "texture text", "text": read_toml_text(path)}

    async def _on_display(self, work: Callable[..., Answer], asked: OnDisplay) -> Answer:
        # What takes seconds stays out of a drag's way.
        line = self._quick if asked.quality == "screening" else self._lab.slow
        return await line.do(work.__name__, work, asked, self._folder, gives_way=True)

    async def _load(self, asked: OnDisplay) -> Answer:
        return {"type": "feel", **await self._on_display(feel.feel, asked)}

    async def _parity(self, asked: OnDisplay) -> Answer:
        return {"type": "parity", **await self._on_display(feel.parity, asked)}

    async def _add_picture(
        self,
        name: FileName,
        data: Annotated[str, Field(max_length=7_000_000)],
        pixel: Name,
        replace: bool = False,
    ) -> Answer:
        """Keep a PNG or JPEG in base64; `pixel` is the side of its pixels with the unit."""
        try:
            picture = base64.b64decode(data, validate=True)
        except binascii.Error as error:
            raise InputError("the picture's data are no base64; drop it again") from error
        suffix = ".jpg" if picture[:2] == b"\xff\xd8" else ".png"
        file = fresh(self._folder, name, suffix, replace=replace)
        rows, columns, note = await self._quick.do(None, feel.pixels_of, picture, name)
        if not 1e-6 <= si.parse_quantity(pixel, si.Unit("m")) <= 0.1:
            raise InputError(f"a pixel of {pixel}: it may have 1 µm to 10 cm")
        write_whole(file, picture)
        text = (
            f'title = "{file.stem}, {columns} × {rows} pixels of {pixel}"\n\n[texture]\n'
            'type = "relative_friction"\nlow = 0.6\nhigh = 1.0\n\n[texture.pattern]\n'
            f'type = "image_file"\nfile = "{file.name}"\npixel = "{pixel}"\n'
            'outside = "zero"\n'
        )
        await self._quick.do(None, feel.title_of, text, self._folder)
        return {"type": "texture text", "text": text, "note": note}

    async def _save_texture(self, name: FileName, text: Text, replace: bool = False) -> Answer:
        await self._quick.do(None, feel.title_of, text, self._folder)
        file = fresh(self._folder, name, ".toml", replace=replace)
        self._folder.mkdir(exist_ok=True)
        write_whole(file, text)
        return {"type": "saved", "file": f"textures/{file.name}"}

    async def _save_stroke(self, name: FileName, rows: Rows, replace: bool = False) -> Answer:
        folder = self._lab.folder / "strokes"
        file = fresh(folder, name, ".csv", replace=replace)
        felt = fresh(folder, f"{file.stem}.felt", ".csv", replace=replace)
        file.parent.mkdir(exist_ok=True)
        # The motion alone is what a stroke's file has elsewhere; what was felt lies beside it.
        write_whole(felt, csv_text(COLUMNS, rows))
        write_whole(file, csv_text(COLUMNS[:3], [row[:3] for row in rows]))
        return {"type": "saved", "file": f"strokes/{file.name}"}
