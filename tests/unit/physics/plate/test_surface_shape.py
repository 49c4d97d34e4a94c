"""How far each place of the face moves, for every body: against its own mode, and at its edges."""

from __future__ import annotations

import dataclasses
import pickle

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate, turned
from squeezefilm.physics.plate.surface_shape import (
    BeamSurface,
    DiscSurface,
    SolvedSurface,
    SurfaceShape,
    TrackSurface,
    surface_shape,
)
from squeezefilm.physics.plate.working_mode import working_mode

PLATE = load_display("biet2008-plate").actuator
STATOR = load_display("biet2008-stator").actuator
DISC = load_display("winfield2007-tpad").actuator


def at(shape: SurfaceShape, x: si.FloatArray, y: si.FloatArray) -> si.FloatArray:
    """The motion at points of the face."""
    swings, covered = shape.under(x, y, 1e-6, 1e-6)
    assert np.all(covered > 0.2)
    return swings


def test_a_beam_moves_alike_all_across_and_stands_still_at_its_nodes() -> None:
    mode = working_mode(PLATE, "timoshenko")
    shape = surface_shape(PLATE, mode)
    assert isinstance(shape, BeamSurface)
    assert "beam" in shape.words
    assert mode.line is not None
    nodes = mode.line.nodal_positions
    y = np.linspace(*shape.bounds[2:], 5)
    assert shape.grid(nodes, y) == pytest.approx(0.0, abs=1e-3)
    assert np.ptp(shape.grid(np.linspace(0, 0.083, 50), y), axis=1) == pytest.approx(0.0)
    assert at(shape, *(np.array([one]) for one in shape.lobe)) == pytest.approx(1.0)
    # Another process has the same surface.
    x = np.linspace(0, 0.083, 7)
    known = shape.grid(x, y)
    assert pickle.loads(pickle.dumps(shape)).grid(x, y) == pytest.approx(known, abs=1e-12)


def test_a_beam_with_its_nodal_lines_across_the_width_is_the_turned_one() -> None:
    assert isinstance(PLATE, RectangularPlate)
    other = turned(PLATE)
    shape = surface_shape(PLATE, working_mode(PLATE, "timoshenko"))
    over = surface_shape(other, working_mode(other, "timoshenko"))
    assert (shape.along, over.along) == ("x", "y")
    assert over.lobe == shape.lobe[::-1]
    x, y = np.linspace(0, 0.083, 30), np.linspace(0, 0.049, 7)
    assert pytest.approx(shape.grid(x, y)) == over.grid(y, x).T


def test_a_disc_varies_as_the_cosine_around_and_ends_at_its_rim() -> None:
    assert isinstance(DISC, DiscPlate)
    disc = dataclasses.replace(DISC, nodal_circles=0, nodal_diameters=2, sectors=4)
    mode = working_mode(disc)
    shape = surface_shape(disc, mode)
    assert isinstance(shape, DiscSurface)
    outer = disc.diameter / 2
    angle = np.linspace(0, 2 * np.pi, 73)
    radius = 0.6 * outer
    found = at(shape, radius * np.cos(angle), radius * np.sin(angle))
    assert found == pytest.approx(found[0] * np.abs(np.cos(2 * angle)), abs=1e-12)
    assert at(shape, *(np.array([one]) for one in shape.lobe)) == pytest.approx(1.0, abs=1e-6)
    corner = np.array([-outer, outer])
    assert np.all(shape.grid(corner, corner) == 0.0)
    assert not np.any(shape.on_face(corner, corner))


def test_a_stators_track_carries_a_wave_with_all_antinodes_alike_and_says_so() -> None:
    mode = working_mode(STATOR)
    shape = surface_shape(STATOR, mode)
    assert isinstance(shape, TrackSurface)
    assert "not known" in shape.words
    assert "measured" in shape.words
    half = mode.half_wavelength
    antinodes = half * np.arange(17)
    middle = np.full(17, shape.lobe[1])
    assert at(shape, antinodes, middle) == pytest.approx(1.0)
    assert at(shape, antinodes + half / 2, middle) == pytest.approx(0.0, abs=1e-12)
    # The ring is closed: a pad over where it begins overhangs nothing.
    assert shape.on_face(np.array([-1e-3]), middle[:1]).all()


@pytest.mark.slow
def test_the_map_is_the_solved_response_to_rounding_and_its_splines_follow() -> None:
    mode = working_mode(PLATE)
    assert mode.solid is not None
    shape = surface_shape(PLATE, mode)
    assert isinstance(shape, SolvedSurface)
    x, y = np.linspace(0, 0.083, 37), np.linspace(0, 0.049, 21)
    response = mode.solid.response
    whole = np.abs(response.displacement(x, y)[shape.number])
    scaled = mode.amplitude_per_volt * shape.grid(x, y)
    assert scaled == pytest.approx(whole, rel=1e-10, abs=1e-10 * whole.max())
    # Beside the knots the splines miss by less than a thousandth of the best antinode.
    rng = np.random.default_rng(5)
    places = np.sort(rng.uniform(0, 0.083, 60)), np.sort(rng.uniform(0, 0.049, 60))
    assert at(shape, places[0][:, None], places[1][None, :]) == pytest.approx(
        shape.grid(*places), abs=1e-3
    )


@pytest.mark.slow
def test_beside_the_resonance_the_shape_is_that_of_the_response_there() -> None:
    mode = working_mode(PLATE)
    assert mode.solid is not None
    frequency = 1.004 * mode.resonance_frequency
    shape = surface_shape(PLATE, mode, frequency)
    assert isinstance(shape, SolvedSurface)
    assert shape.response.frequencies[shape.number] == frequency
    x, y = np.array([0.01, 0.03]), np.array([0.01, 0.02])
    per_volt = mode.response(np.array([frequency]))[0]
    whole = np.abs(shape.response.displacement(x, y)[shape.number])
    assert per_volt * shape.grid(x, y) == pytest.approx(whole, rel=1e-9)
    # The neighbouring modes have another part there.
    assert np.max(np.abs(shape.grid(x, y) - surface_shape(PLATE, mode).grid(x, y))) > 1e-3


def test_a_mode_without_a_body_has_no_shape() -> None:
    mode = dataclasses.replace(working_mode(PLATE, "timoshenko"), beam=None, model="by hand")
    with pytest.raises(OutOfRangeError, match="no shape over the face"):
        surface_shape(PLATE, mode)
