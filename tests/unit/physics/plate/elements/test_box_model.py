"""What a box model refuses before anything is assembled."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import GeometryError, InputError
from squeezefilm.physics.plate.elements.box_model import BoxModel, Medium, ModelElectrode
from squeezefilm.physics.plate.elements.lobatto import LineMesh

STEEL = Medium("steel", np.eye(6) * 1e11, 7800.0)
MESH = LineMesh((0.0, 1e-3, 2e-3), (2, 2))
SHAPE = (2, 2, 2)


def cells(value: int, shape: tuple[int, ...] = SHAPE) -> np.ndarray:
    return np.full(shape, value)


@pytest.mark.parametrize("medium", [SHAPE, (2, 2, 3), (2, 2)])
@pytest.mark.parametrize("ceramic", [SHAPE, (3, 2, 2), (8,)])
def test_media_and_ceramics_have_the_shape_of_the_grid(
    medium: tuple[int, ...], ceramic: tuple[int, ...]
) -> None:
    parts = (MESH, MESH, MESH, (STEEL,), cells(0, medium), cells(-1, ceramic))
    if medium == ceramic == SHAPE:
        assert BoxModel(*parts).medium.shape == SHAPE
        return
    with pytest.raises(InputError, match=r"shape \(2, 2, 2\)"):
        BoxModel(*parts)


def test_what_is_not_there_is_not_used() -> None:
    with pytest.raises(InputError, match="not in media"):
        BoxModel(MESH, MESH, MESH, (STEEL,), cells(1), cells(-1))
    with pytest.raises(GeometryError, match="no ceramic under it"):
        BoxModel(MESH, MESH, MESH, (STEEL,), cells(0), cells(-1), (ModelElectrode(2, 0),))
    with pytest.raises(GeometryError, match="not piezoelectric"):
        BoxModel(MESH, MESH, MESH, (STEEL,), cells(0), cells(0), (ModelElectrode(2, 0),))
