"""Triangles as a binary STL file, in millimetres, as printers and CAD programs read it."""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@si.checked_numbers
def stl_bytes(triangles: si.MetreArray, title: str) -> bytes:
    """A binary STL of triangles (m), shape (triangles, 3, 3), each anticlockwise from outside.

    `title` stands in the header, 80 bytes of ASCII. Single precision: corners within 6e-8 of their
    size. Raises `InputError` for another shape.
    """
    if triangles.ndim != 3 or triangles.shape[1:] != (3, 3):
        raise InputError(
            f"triangles of the shape {triangles.shape} are none; give corners by coordinates, "
            "(triangles, 3, 3)",
            quantity="triangles",
        )
    scaled = 1e3 * np.asarray(triangles, dtype=float)
    normal = np.cross(scaled[:, 1] - scaled[:, 0], scaled[:, 2] - scaled[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    records = np.zeros(len(scaled), dtype=_RECORD)
    records["normal"] = normal / np.where(length > 0, length, 1.0)
    records["corners"] = scaled
    # A header that begins with "solid" would be taken for a file in words.
    head = f"millimetres; {title}".encode("ascii", "replace")[:80].ljust(80)
    return head + len(records).to_bytes(4, "little") + records.tobytes()
