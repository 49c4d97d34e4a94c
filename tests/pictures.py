"""Pictures for tests: what the package only reads."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from squeezefilm.core.quantities import DimensionlessArray


def picture_bytes(values: DimensionlessArray, bits: int = 8) -> bytes:
    """The greyscale PNG of values from 0 to 1, the top row first, in 8 or 16 bits."""
    grey = np.rint(values * (2**bits - 1)).astype(np.uint8 if bits == 8 else np.uint16)
    stream = io.BytesIO()
    Image.fromarray(grey).save(stream, format="PNG")
    return stream.getvalue()


def coloured_bytes(values: DimensionlessArray, kind: str = "PNG", exif: int = 1) -> bytes:
    """A picture of red, green and blue from 0 to 1, shape (rows, columns, 3), as PNG or JPEG.

    `exif` says how the camera was held (1: upright).
    """
    stream, said = io.BytesIO(), Image.Exif()
    said[0x112] = exif
    picture = Image.fromarray(np.rint(values * 255).astype(np.uint8))
    picture.save(stream, format=kind, exif=said, **({"quality": 100} if kind == "JPEG" else {}))
    return stream.getvalue()
