"""A scan beside solved shapes: the right one is called by its name, and neighbours are not."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.vibration.solved_shapes import (
    REST,
    DrivenShape,
    fit_grid_scan,
    shapes_at,
)
from squeezefilm.measure.recordings.kinds import GridScan
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.working_mode import working_mode

X, Y = (one.ravel() for one in np.meshgrid(np.linspace(0, 1, 24), np.linspace(0, 1, 12)))
SHAPES = {"(8,0)": np.cos(8 * np.pi * X), "(8,1)": np.cos(8 * np.pi * X) * np.cos(np.pi * Y)}


def noisy(w, share: float = 0.02):
    random = np.random.default_rng(1)
    parts = share * np.abs(w).max() / np.sqrt(2) * random.standard_normal((2, w.size))
    return w + parts[0] + 1j * parts[1]


@pytest.mark.slow
def test_the_papers_mode_is_told_from_its_neighbours() -> None:
    actuator = load_display("biet2008-plate").actuator
    mode = working_mode(actuator)
    assert mode.solid is not None
    modes = solve_modes(actuator, near=mode.resonance_frequency, count=9)
    x, y = np.linspace(1e-3, 82e-3, 34), np.linspace(1e-3, 48e-3, 16)
    response, at = mode.solid.driven_at()
    w = 15 * response.motion(at, x, y).ravel()
    places = [one.ravel() for one in np.meshgrid(x, y, indexing="ij")]
    recording = GridScan(*places, noisy(w), mode.resonance_frequency, 15.0)
    fit = fit_grid_scan(recording, shapes_at(modes, *places, DrivenShape.of(mode.solid)))
    assert fit.label.startswith("(8,0)")
    assert fit.likeness[fit.label] > 0.95
    assert max(value for name, value in fit.likeness.items() if name != fit.label) < 0.3
    assert fit.adequacy.adequate
    assert fit.amplitude.value == pytest.approx(15 * mode.amplitude_per_volt, rel=0.01)
    assert fit.observations[0].answer == "amplitude_per_volt"
    # A neighbour, scanned, is called by its own name.
    other = next(i for i, label in enumerate(modes.labels) if label == (8, 1))
    shapes = shapes_at(modes, *places, DrivenShape.of(mode.solid))
    scan = GridScan(*places, noisy(1e-6 * list(shapes.values())[other] + 0j), 34.7e3)
    found = fit_grid_scan(scan, shapes)
    assert found.label.startswith("(8,1)")
    assert found.likeness[fit.label] < 0.3


def test_parts_are_recovered_and_a_mixture_is_called_none() -> None:
    w = noisy(-1e-6j * SHAPES["(8,0)"] + 0.7e-6 * SHAPES["(8,1)"])
    fit = fit_grid_scan(GridScan(X, Y, w, 33e3, 10.0), SHAPES)
    assert fit.label == "(8,0)"
    assert fit.parts["(8,1)"].value == pytest.approx(0.7e-6, rel=0.02)
    assert not fit.adequacy.adequate
    assert "No single shape" in fit.adequacy.sentence
    assert fit.observations == ()


def test_noise_bounds_the_likeness_that_can_be_attained() -> None:
    fit = fit_grid_scan(GridScan(X, Y, noisy(1e-6 * SHAPES["(8,0)"] + 0j, 0.3), 33e3), SHAPES)
    assert fit.likeness["(8,0)"] == pytest.approx(fit.attainable, abs=0.01)
    assert fit.attainable < 0.9


@pytest.mark.parametrize(
    ("shapes", "words"),
    [
        ({}, "no shape"),
        ({"a": np.ones(3)}, "3 places"),
    ],
)
def test_shapes_that_do_not_serve_are_refused(shapes, words: str) -> None:
    with pytest.raises(InputError, match=words):
        fit_grid_scan(GridScan(X, Y, SHAPES["(8,0)"] + 0j, 33e3), shapes)


def test_of_two_shapes_that_the_places_cannot_tell_apart_one_is_left_out_and_said() -> None:
    shapes = {"a": 2 * SHAPES["(8,0)"] + 0.01 * X, "b": SHAPES["(8,0)"]}
    fit = fit_grid_scan(GridScan(X, Y, noisy(1e-6 * SHAPES["(8,0)"] + 0j), 33e3), shapes)
    assert fit.label == "b"
    assert fit.likeness.keys() == {"a", "b"}
    assert fit.parts.keys() == {"b"}
    assert "cannot tell a from b" in fit.adequacy.sentence


def test_a_scan_of_nothing_is_refused() -> None:
    for w, words in ((np.zeros(X.size) + 0j, "zero everywhere"), (np.full(X.size, np.nan), "12")):
        with pytest.raises(InputError, match=words):
            fit_grid_scan(GridScan(X, Y, w, 33e3), SHAPES)


def test_solved_shapes_are_told_at_other_places_relative_to_the_lobe() -> None:
    """Cubics, which splines follow exactly; the second is still at the lobe, so 1 at its most."""
    x, y = np.linspace(0, 80e-3, 9), np.linspace(0, 40e-3, 7)

    def bent(x, y):
        return 2 + x / 40e-3 - (y / 40e-3) ** 2

    def still(x, y):
        return 6 * (x / 80e-3 - 0.5) + 0 * y

    grid = np.meshgrid(x, y, indexing="ij")
    modes: Any = SimpleNamespace(
        plate=SimpleNamespace(length=80e-3, width=40e-3),
        count=2, x=x, y=y, shapes=np.stack([bent(*grid), still(*grid)]),
        labels=[(8, 0), None], frequencies=np.array([33e3, 34e3]),
    )  # fmt: skip
    lobe = (40e-3, 20e-3)
    driven = DrivenShape(x, y, bent(*grid), -0.5 * still(*grid), lobe, True, 10e-3)
    places = np.array([0.0, 13e-3, 71e-3]), np.array([40e-3, 3e-3, 22e-3])
    first, second, rest = shapes_at(modes, *places, driven).items()
    assert (first[0], second[0], rest[0]) == ("(8,0) at 33 kHz", "in plane at 34 kHz", REST)
    assert first[1] == pytest.approx(bent(*places) / bent(*lobe))
    assert second[1] == pytest.approx(still(*places) / 3)
    assert rest[1] == pytest.approx(-still(*places) / 3)
    for beside in ((-1e-3, 0.0), (81e-3, 0.0), (0.0, -1e-3), (0.0, 41e-3)):
        with pytest.raises(InputError, match="x" if beside[0] else "y"):
            shapes_at(modes, np.array(beside[:1]), np.array(beside[1:]), driven)
