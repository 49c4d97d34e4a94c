"""A picture beside a texture's file as a pattern: named in TOML, read and put in its place.

In a texture's file::

    pattern = { type = "image_file", file = "map.png", pixel = "0.1 mm" }

Black is 0 and white is 1, which the level around it (`low`, `high`) makes a quantity. The file is
looked for beside the TOML file and below, nowhere else.

PNG and JPEG are read to values from 0 to 1, of colours the brightness. Size and kind are read from
the file's header and checked before anything is decoded: a small file may unpack to gigabytes. A
picture has no scale of its own (what a PNG says of pixels per metre is set by cameras and screens).
"""

from __future__ import annotations

import dataclasses
import io
import struct
import warnings
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, InputError, SqueezefilmWarning
from squeezefilm.core.hard_limits import PICTURE_BYTES
from squeezefilm.core.isolated_reading import Read, read_isolated
from squeezefilm.core.regular_file import read_regular
from squeezefilm.physics.render.opcodes import Assembler
from squeezefilm.physics.render.texture.image import MOST_PIXELS, Image
from squeezefilm.physics.render.texture.pattern import Pattern

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COLOURED = {2, 3, 6}
"""PNG's kinds of pixels that have colours: as such, from a palette, with alpha."""
_BRIGHTNESS = (299, 587, 114)
"""Thousandths of red, green and blue, as they are stored (ITU-R BT.601-7, section 2.5.1)."""
_NO_FRAME = {0xC4, 0xC8, 0xCC}
"""JPEG's markers from C0 to CF that begin no frame (ITU-T T.81, table B.1)."""


def read_picture(path: str | Path) -> si.DimensionlessArray:
    """The values of a PNG or JPEG, 0 (black) to 1 (white), shape (rows, columns), top row first.

    Warns of colours, of which the brightness is taken.

    Raises:
        InputError: a file that cannot be read, is no PNG or JPEG, has transparent pixels, is
            damaged, or has more pixels than an `Image` may have (1 048 576).
    """
    return picture_from(read_regular(path, PICTURE_BYTES, "a picture"), str(path))


def picture_from(data: bytes, name: str = "the picture") -> si.DimensionlessArray:
    """The values in the bytes of a picture; `name` is what messages call it. See `read_picture`."""
    columns, rows, colours = _header(data, name)
    if rows * columns > MOST_PIXELS or rows * columns == 0:
        raise InputError(
            f"{name} has {columns} × {rows} pixels; an image may have from 1 to {MOST_PIXELS} "
            "together: make its pixels larger"
        )
    try:
        _, (pixels,) = read_isolated(_brightness, data=data, file=name)
    except ConfigError as error:
        raise InputError(f"{name} {error.message}") from error
    # A camera that was held upright says so, and the picture is turned.
    if sorted(pixels.shape) != sorted((rows, columns)):
        raise InputError(f"{name} is damaged: its header does not belong to its pixels")
    if colours:
        text = f"{name} is in colour: of each pixel the brightness is used, from black to white"
        warnings.warn(text, SqueezefilmWarning, stacklevel=2)
    return np.asarray(pixels)


def _header(data: bytes, name: str) -> tuple[int, int, bool]:
    """Columns, rows, and whether there are colours."""
    if data[:8] == _SIGNATURE and data[12:16] == b"IHDR" and len(data) >= 33:
        columns, rows, _, kind = struct.unpack(">IIBB", data[16:26])
        return columns, rows, kind in _COLOURED
    if data[:3] == b"\xff\xd8\xff":
        at = 2
        while at + 10 <= len(data) and data[at] == 0xFF:
            marker, length = struct.unpack(">BH", data[at + 1 : at + 4])
            if 0xC0 <= marker <= 0xCF and marker not in _NO_FRAME:
                rows, columns, components = struct.unpack(">HHB", data[at + 5 : at + 10])
                return columns, rows, components > 1
            at += 2 + length
    raise InputError(f"{name} is no PNG and no JPEG; save it as one of them")


def _brightness(data: bytes) -> Read:
    """Values of a picture, the right way up (read in the child)."""
    from PIL import Image as Pillow
    from PIL import ImageOps

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with Pillow.open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
                upright = ImageOps.exif_transpose(picture)
                if upright.mode in ("L", "I;16", "I"):
                    white = 255 if upright.mode == "L" else 65535
                    return None, [np.array(upright, dtype=float) / white]
                colours = np.array(upright.convert("RGBA"), dtype=int)
    except (OSError, SyntaxError, ValueError, Warning, struct.error) as error:
        raise ConfigError(f"is damaged and cannot be read: {error}") from error
    if np.any(colours[..., 3] < 255):
        raise ConfigError(
            "has transparent pixels, which have no brightness of their own; save it without "
            "transparency"
        )
    return None, [colours[..., :3] @ _BRIGHTNESS / (255 * sum(_BRIGHTNESS))]


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class ImageFile(Pattern):
    """An image whose pixels are in a PNG file; `image` reads them. See `Image` for the rest.

    Args:
        file: its path, relative to the file that names it, with / between folders.
        pixel: side of a pixel (m): there is no image without a scale.
        left, bottom: the frame's corner (m).
        outside: "hold", "repeat" or "zero".

    Raises:
        InputError: a path that is absolute or climbs out with "..", or a value out of range.
    """

    file: str
    pixel: Annotated[si.Metre, si.AtLeast(1e-06), si.AtMost(0.1)]
    left: si.Metre = 0.0
    bottom: si.Metre = 0.0
    outside: Literal["hold", "repeat", "zero"] = "hold"
    type: Literal["image_file"] = field(default="image_file", repr=False)

    def __post_init__(self) -> None:
        path = PurePosixPath(self.file)
        windows = PureWindowsPath(self.file)
        climbs = ".." in path.parts or ".." in windows.parts
        if not self.file or "\0" in self.file or climbs or path.is_absolute() or windows.anchor:
            raise InputError(
                f"file = '{self.file}' cannot be used: it must lie beside the texture's file or in "
                "a folder below it; give a relative path without '..'",
                quantity="file",
            )

    def image(self, folder: Path) -> Image:
        """The image, read from a file under `folder`.

        Raises:
            InputError: a file that lies elsewhere (a link may lead out) or cannot be read.
        """
        inside = folder.resolve()
        try:
            path = (inside / self.file).resolve()
        except (OSError, RuntimeError) as error:
            # Before Python 3.13 a circle of links is no OSError.
            raise InputError(
                f"file = '{self.file}' cannot be followed: {error}; copy the picture there",
                quantity="file",
            ) from error
        if not path.is_relative_to(inside):
            raise InputError(
                f"file = '{self.file}' leads out of {folder}; copy the picture there",
                quantity="file",
            )
        values = read_picture(path)
        return Image.from_array(
            values, self.pixel, left=self.left, bottom=self.bottom, outside=self.outside
        )

    def _lower(self, assembler: Assembler) -> None:
        raise InputError(
            f"the picture '{self.file}' has not been read; load the texture from its file, or call "
            "with_images(texture, folder)"
        )


def with_images(value: Any, folder: Path | None) -> Any:
    """A texture or pattern with every `ImageFile` replaced by its `Image`, from under `folder`.

    Raises:
        InputError: a picture that cannot be used, or one asked for without a folder (None).
    """
    if isinstance(value, ImageFile):
        if folder is None:
            raise InputError(
                f"the picture '{value.file}' has no folder to be in: the texture is no file",
                quantity="file",
            )
        return value.image(folder)
    if isinstance(value, tuple):
        items = tuple(with_images(item, folder) for item in value)
        return items if any(a is not b for a, b in zip(items, value, strict=True)) else value
    if not dataclasses.is_dataclass(value) or isinstance(value, type | Image):
        return value
    changed = {}
    for part in dataclasses.fields(value):
        if not part.init:
            continue
        before = getattr(value, part.name)
        after = with_images(before, folder)
        if after is not before:
            changed[part.name] = after
    return dataclasses.replace(value, **changed) if changed else value
