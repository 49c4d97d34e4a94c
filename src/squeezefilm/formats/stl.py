"""Triangles as a binary STL file, in millimetres, as printers and CAD programs read it."""

from __future__ import annotations

import numpy as np

from squeezefilm import quantities as si

_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl_bytes(triangles: si.FloatArray, title: str) -> bytes:
    """A binary STL of triangles (m), shape (triangles, 3, 3), each anticlockwise from outside.

    `title` stands in the header, 80 bytes of ASCII. Single precision: corners within 6e-8 of their
    size.
    """
    scaled = 1e3 * np.asarray(triangles, dtype=float)
    normal = np.cross(scaled[:, 1] - scaled[:, 0], scaled[:, 2] - scaled[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    records = np.zeros(len(scaled), dtype=_RECORD)
    records["normal"] = normal / np.where(length > 0, length, 1.0)
    records["corners"] = scaled
    # A header that begins with "solid" would be taken for a file in words.
    head = f"millimetres; {title}".encode("ascii", "replace")[:80].ljust(80)
    return head + len(records).to_bytes(4, "little") + records.tobytes()
