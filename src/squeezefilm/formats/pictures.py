"""Pictures as maps: greyscale PNG of 8 or 16 bits to values from 0 (black) to 1 (white).

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

from squeezefilm import quantities as si
from squeezefilm.errors import ConfigError, InputError
from squeezefilm.hard_limits import PICTURE_BYTES
from squeezefilm.isolated_reading import Read, read_isolated
from squeezefilm.regular_file import read_regular
from squeezefilm.render.texture.image import MOST_PIXELS

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_KINDS = {
    0: "greyscale",
    2: "colour",
    3: "colour from a palette",
    4: "greyscale with alpha",
    6: "colour with alpha",
}


def read_picture(path: str | Path) -> si.DimensionlessArray:
    """The values of a PNG, 0 (black) to 1 (white), shape (rows, columns), the top row first.

    Raises:
        InputError: a file that cannot be read, is no greyscale PNG of 8 or 16 bits, is damaged,
            or has more pixels than an `Image` may have (1 048 576).
    """
    return picture_from(read_regular(path, PICTURE_BYTES, "a PNG"), str(path))


def picture_from(data: bytes, name: str = "the picture") -> si.DimensionlessArray:
    """The values in the bytes of a PNG; `name` is what messages call it. See `read_picture`."""
    if data[:8] != _SIGNATURE or data[12:16] != b"IHDR" or len(data) < 33:
        raise InputError(f"{name} is no PNG; save it as a greyscale PNG of 8 or 16 bits")
    columns, rows, bits, kind = struct.unpack(">IIBB", data[16:26])
    if kind != 0 or bits not in (8, 16):
        raise InputError(
            f"{name} is {_KINDS.get(kind, f'of kind {kind}')} of {bits} bits; save it as greyscale "
            "of 8 or 16 bits, without transparency"
        )
    if rows * columns > MOST_PIXELS or rows * columns == 0:
        raise InputError(
            f"{name} has {columns} × {rows} pixels; an image may have from 1 to {MOST_PIXELS} "
            "together: make its pixels larger"
        )
    try:
        _, (found,) = read_isolated(_pixels, data=data, file=name)
    except ConfigError as error:
        raise InputError(f"{name} {error.message}") from error
    if found.shape != (rows, columns):
        raise InputError(f"{name} is damaged: its header does not belong to its pixels")
    return np.asarray(found / (2**bits - 1))


def _pixels(data: bytes) -> Read:
    """In the child: the pixels of a PNG as they are stored."""
    from PIL import Image as Pillow

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with Pillow.open(io.BytesIO(data), formats=("PNG",)) as picture:
                return None, [np.array(picture, dtype=float)]
    except (OSError, SyntaxError, ValueError, Warning, struct.error) as error:
        raise ConfigError(f"is damaged and cannot be read: {error}") from error
