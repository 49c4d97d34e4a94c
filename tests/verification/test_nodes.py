"""Where a drawn nodal line is, the shape that is drawn stands still: within a tenth of a
millimetre, asked of the solved field itself."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.working import SolidMode
from squeezefilm.physics.plate.surface_shape import surface_shape
from squeezefilm.physics.plate.working_mode import ModeLine, working_mode
from verification.random_plates import affordable_plate

NEAR = 0.1e-3


def solved_line(mode: SolidMode, place: np.ndarray) -> np.ndarray:
    """The solved field on the line through the lobe, at places along the wave (m)."""
    plate = mode.modes.plate
    at = [np.array([one]) for one in mode.lobe]
    axis = 0 if plate.lines_across == "length" else 1
    at[axis] = place
    return mode.modes.field(mode.index, *at, plate.thickness)[..., 2].ravel()


def require_zeros(mode: SolidMode, line: ModeLine) -> None:
    nodes = line.nodal_positions
    assert nodes.size >= 2
    ends = line.position[[0, -1]]
    before = np.clip(nodes - NEAR, *ends)
    after = np.clip(nodes + NEAR, *ends)
    assert np.all(solved_line(mode, before) * solved_line(mode, after) < 0)
    # And none is left out: between two of them the field keeps its sign.
    for low, high in zip(nodes[:-1] + NEAR, nodes[1:] - NEAR, strict=True):
        inside = solved_line(mode, np.linspace(low, high, 40))
        assert np.all(inside > 0) or np.all(inside < 0)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["biet2008-plate"])
def test_the_nodes_of_a_preset_are_the_zeros_of_its_drawn_line(name: str) -> None:
    mode = working_mode(load_display(name).actuator)
    assert mode.solid is not None
    assert mode.line is not None
    require_zeros(mode.solid, mode.line)


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["touchpad-glass", "basdogan2020-glass"])
def test_so_are_those_of_the_glass_presets(name: str) -> None:
    test_the_nodes_of_a_preset_are_the_zeros_of_its_drawn_line(name)


@pytest.mark.parametrize(
    ("count", "seed"),
    [
        pytest.param(2, 2, marks=pytest.mark.slow),
        pytest.param(8, 4, marks=pytest.mark.nightly),
    ],
)
def test_so_are_those_of_random_plates(count: int, seed: int) -> None:
    tried = 0
    while tried < count:
        seed += 1
        plate: RectangularPlate = affordable_plate(seed)
        try:
            mode = working_mode(plate)
        except InputError:
            continue  # This plate has no such mode.
        assert mode.solid is not None
        assert mode.line is not None
        require_zeros(mode.solid, mode.line)
        tried += 1


def test_the_nodes_of_a_disc_and_a_beam_are_those_of_their_maps() -> None:
    plate, disc = (
        load_display("biet2008-plate").actuator,
        load_display("winfield2007-tpad").actuator,
    )
    for actuator, theory in ((plate, "timoshenko"), (disc, "solid")):
        mode = working_mode(actuator, theory)  # type: ignore[arg-type]
        assert mode.line is not None
        nodes, shape = mode.line.nodal_positions, surface_shape(actuator, mode)
        assert nodes.size >= 2
        assert shape.grid(nodes, np.array([mode.lobe[1]])) == pytest.approx(0.0, abs=2e-3)
