"""Binary STL, read by another program: the same triangles, in millimetres."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.fabrication.step_file import stl_bytes, triangles_of
from squeezefilm.physics.plate.parts import Part, Sector


def test_another_program_reads_the_triangles(tmp_path: Path) -> None:
    ring = Part("ceramic", 1, "PZT", 7700.0, Sector(3e-3, 5e-3), -0.5e-3, 0.0)
    triangles = triangles_of(ring)
    data = stl_bytes(triangles, "a ring")
    assert len(data) == 84 + 50 * len(triangles)
    assert data[:80].rstrip() == b"millimetres; a ring"
    file = tmp_path / "ring.stl"
    file.write_bytes(data)
    found = meshio.read(file)
    corners = found.points[found.cells_dict["triangle"]]
    assert corners == pytest.approx(1e3 * triangles, abs=1e-6)
    # The normals that the file states are those of the corners' order.
    stated = np.frombuffer(data[84:], dtype=np.dtype([("n", "<f4", 3), ("c", "V38")]))["n"]
    found_normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.einsum("ij,ij->i", stated, found_normals) == pytest.approx(
        np.linalg.norm(found_normals, axis=1), rel=1e-3
    )


@pytest.mark.parametrize("shape", [(3, 3), (1, 3, 2), (1, 2, 3), (2, 1, 3, 3), (9,)])
def test_what_is_no_row_of_triangles_is_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match="corners by coordinates"):
        stl_bytes(np.zeros(shape), "a ring")


def test_a_name_in_other_letters_fits_the_header() -> None:
    data = stl_bytes(np.zeros((1, 3, 3)), "Gerät № 7 " * 20)
    assert len(data) == 84 + 50
    assert data[:80].isascii()
