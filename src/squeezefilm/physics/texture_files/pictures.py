"""Pictures as maps: PNG and JPEG to values from 0 (black) to 1 (white); of colours the brightness.

Size and kind are read from the file's header and checked before anything is decoded: a small file
may unpack to gigabytes. A picture has no scale of its own; whoever uses one gives the side of a
pixel. (What a PNG says of pixels per metre is set by cameras and screens, and not believed.)
"""

from __future__ import annotations

import io
import struct
import warnings
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, InputError, SqueezefilmWarning
from squeezefilm.core.hard_limits import PICTURE_BYTES
from squeezefilm.core.isolated_reading import Read, read_isolated
from squeezefilm.core.regular_file import read_regular
from squeezefilm.physics.render.texture.image import MOST_PIXELS

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
        _, (found,) = read_isolated(_brightness, data=data, file=name)
    except ConfigError as error:
        raise InputError(f"{name} {error.message}") from error
    # A camera that was held upright says so, and the picture is turned.
    if sorted(found.shape) != sorted((rows, columns)):
        raise InputError(f"{name} is damaged: its header does not belong to its pixels")
    if colours:
        text = f"{name} is in colour: of each pixel the brightness is used, from black to white"
        warnings.warn(text, SqueezefilmWarning, stacklevel=2)
    return np.asarray(found)


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
    """In the child: the values of a picture, the right way up."""
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
