"""A scan as a multiple of a solved shape: what of it is found again, and what is called wrong."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.measure.fits.by_kind import fit_recording
from squeezefilm.measure.fits.vibration.line_scan import LineScanFit, fit_line_scan
from squeezefilm.measure.fits.vibration.solved_shapes import (
    REST,
    DrivenShape,
    fit_grid_scan,
    line_by_shape,
)
from squeezefilm.measure.recordings.kinds import GridScan, LineScan
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.working import solid_mode

LENGTH, WIDTH = 80e-3, 40e-3
U, V = np.linspace(0, LENGTH, 161), np.linspace(0, WIDTH, 41)
BENT = 8 * np.pi * (U / LENGTH + 0.04 * np.sin(2 * np.pi * U / LENGTH))
SWING = np.cos(BENT)[:, None] * (1 - 0.1 * (V / WIDTH - 0.5) ** 2)
LOBE = float(U[np.argmax(SWING[60:100, 20]) + 60])
REST_SHAPE = 0.05 * (np.cos(6 * np.pi * U / LENGTH) - np.cos(6 * np.pi * LOBE / LENGTH))
SHAPE = DrivenShape(
    U, V, SWING, np.tile(REST_SHAPE[:, None], V.size), (LOBE, WIDTH / 2), True, 10e-3
)
X = np.linspace(1e-3, 78e-3, 130)


def line(offset: float = 0.0, share: float = 0.01, seed: int = 1) -> si.ComplexArray:
    swing, rest = SHAPE.along(X + offset)
    w = 2e-6 * np.exp(-1.5j) * (swing + 1j * rest)
    random = np.random.default_rng(seed).standard_normal((2, X.size))
    return np.asarray(w + share * 2e-6 * (random[0] + 1j * random[1]) / np.sqrt(2))


def test_amplitude_phase_and_where_the_line_begins_are_found_again() -> None:
    held = np.zeros(3)
    for seed in range(60):
        found = line_by_shape(SHAPE, X, line(0.4e-3, seed=seed), reach=2.5e-3)
        assert found.adequacy.adequate
        assert found.phase is not None
        for i, (one, true) in enumerate(
            ((found.amplitude, 2e-6), (found.phase, -1.5), (found.offset, 0.4e-3))
        ):
            held[i] += one.interval[0] < true < one.interval[1]
    assert np.all(held >= 51)


def test_a_wrong_sign_of_the_phase_is_noticed_by_what_moves_at_once() -> None:
    found = line_by_shape(SHAPE, X, line().conj(), reach=2.5e-3)
    assert found.phase_reversed
    assert "other sign" in found.adequacy.sentence
    assert found.phase is not None
    assert found.phase.value == pytest.approx(-1.5, abs=0.01)
    # Without a recorded phase neither is asked for.
    real = line_by_shape(SHAPE, X, (line() * np.exp(1.5j)).real, reach=2.5e-3)
    assert real.phase is None
    assert not real.phase_reversed
    assert real.amplitude.value == pytest.approx(2e-6, rel=0.01)


def test_another_mode_a_rocking_and_another_plate_are_called_wrong() -> None:
    rocking = line() + 0.2e-6 * (X / LENGTH - 0.3)
    double = line() + 0.2e-6j * np.cos(7 * np.pi * X / LENGTH)
    stretched = SHAPE.along(1.03 * X)[0] * -2e-6j
    for w in (rocking, double, stretched):
        found = fit_line_scan(LineScan(X, w, 33e3, 10.0), SHAPE)
        assert found.by_points
        assert not found.adequacy.adequate


def test_a_line_says_amplitude_by_the_shape_and_half_wavelength_by_its_own_points() -> None:
    found = fit_line_scan(LineScan(X, line(0.2e-3), 33e3, 10.0), SHAPE)
    assert found.adequacy.adequate
    assert found.offset is not None
    low, high = found.offset.interval
    assert low < 0.2e-3 < high
    assert found.antinode == pytest.approx(LOBE - 0.2e-3, abs=0.05e-3)
    half, per_volt = found.observations
    # What a calibration compares it with is the library's, of the whole face.
    assert half.value == pytest.approx(SHAPE.half_wavelength, rel=2e-3)
    assert half.value == pytest.approx(found.half_wavelength.value * found.face_over_line)
    assert per_volt.value == pytest.approx(0.2e-6, rel=0.01)
    # An even wave needs no shape, and is not compared with one.
    even = 1e-6 * np.cos(np.pi * X / 11e-3) + 1e-9 * line()
    assert fit_line_scan(LineScan(X, even, 33e3), SHAPE, free_ends=False).offset is None


def test_what_else_the_drive_moves_is_a_shape_of_a_grid_and_never_its_name() -> None:
    x, y = (one.ravel() for one in np.meshgrid(U[::8], V[::4], indexing="ij"))
    swing, rest = SHAPE.at(x, y)
    shapes = {"(8,0)": swing, REST: rest / np.max(np.abs(rest))}
    random = np.random.default_rng(2).standard_normal((2, x.size))
    w = 1e-6 * (swing + 1j * rest) + 1e-8 * (random[0] + 1j * random[1])
    fit = fit_grid_scan(GridScan(x, y, w, 33e3, 10.0), shapes)
    assert fit.label == "(8,0)"
    assert fit.adequacy.adequate
    part = fit.parts[REST]
    assert part.value == pytest.approx(1e-6 * np.max(np.abs(rest)), abs=3 * part.standard_error)
    only = fit_grid_scan(GridScan(x, y, w, 33e3, 10.0), {"(8,0)": swing})
    assert not only.adequacy.adequate
    same = fit_grid_scan(GridScan(x, y, w, 33e3, 10.0), {REST: rest, "(8,0)": swing})
    assert same.label == "(8,0)"


@pytest.mark.slow
def test_the_papers_plate_is_described_by_its_own_shape() -> None:
    display = load_display("biet2008-plate")
    assert isinstance(display.actuator, RectangularPlate)
    mode = solid_mode(display.actuator)
    shape = DrivenShape.of(mode)
    there = shape.at(*(np.array([place]) for place in mode.lobe))
    assert there[:, 0] == pytest.approx([1.0, 0.0], abs=1e-6)
    # The mode answers late, all else at once.
    response, at = mode.driven_at()
    x = np.linspace(0, display.actuator.length, 120)
    motion = response.motion(at, x, np.array([mode.lobe[1]]))[:, 0]
    swing, rest = shape.along(x)
    size = mode.amplitude_per_volt
    lobe = response.motion(at, *(np.array([place]) for place in mode.lobe))[0, 0]
    assert motion == pytest.approx(lobe * (swing + 1j * rest), abs=2e-3 * size)
    random = np.random.default_rng(4).standard_normal((2, x.size))
    w = 15 * motion + 0.01 * 15 * size * (random[0] + 1j * random[1])
    found = fit_recording(LineScan(x, w, mode.frequency, 15.0), display)
    assert isinstance(found, LineScanFit)
    assert found.adequacy.adequate
    half, per_volt = found.observations
    assert half.value == pytest.approx(mode.half_wavelength, abs=4 * half.standard_error)
    assert per_volt.value == pytest.approx(size, abs=4 * per_volt.standard_error)
    # A scan at another mode's frequency is not compared with this one.
    other = fit_recording(LineScan(x, w, 0.6 * mode.frequency, 15.0), display)
    assert not other.adequacy.adequate


@pytest.mark.parametrize("lengthwise", [True, False])
def test_a_line_runs_through_the_best_antinode_across_the_nodal_lines(lengthwise: bool) -> None:
    x, y = np.linspace(0.0, 0.06, 13), np.linspace(0.0, 0.04, 9)
    # What a cubic follows exactly, with another value on every line.
    swing, rest = x[:, None] ** 2 + 3 * y, x[:, None] - 2 * y**3
    shape = DrivenShape(x, y, swing, rest, (0.01, 0.03), lengthwise, 8e-3)
    along = np.array([0.004, 0.02, 0.037])
    at_x, at_y = (along, 0.03) if lengthwise else (0.01, along)
    expected = np.stack(np.broadcast_arrays(at_x**2 + 3 * at_y, at_x - 2 * at_y**3))
    np.testing.assert_allclose(shape.along(along), expected, rtol=1e-9)
    np.testing.assert_allclose(shape.at(np.full(3, 0.05), along)[0], 0.0025 + 3 * along)
    assert shape.antinode == (0.01 if lengthwise else 0.03)


@pytest.mark.parametrize(("lines", "lengthwise"), [((8, 0), True), ((0, 9), False), (None, True)])
def test_the_shape_of_a_mode_is_turned_to_its_best_antinode(
    lines: tuple[int, int] | None, lengthwise: bool
) -> None:
    """Whatever the phase of the drive: 1 there, and of the rest nothing."""
    x, y = np.linspace(0.0, 0.06, 7), np.linspace(0.0, 0.04, 5)

    def motion(at: int, over: np.ndarray, across: np.ndarray) -> np.ndarray:
        assert at == 4
        return np.asarray(np.exp(0.7j) * (over[:, None] + 2 * across + 0.1j * over[:, None]))

    mode: Any = SimpleNamespace(
        driven_at=lambda: (SimpleNamespace(motion=motion), 4),
        modes=SimpleNamespace(x=x, y=y, labels=[(3, 3), lines]),
        index=1,
        lobe=(0.02, 0.01),
        half_wavelength=8e-3,
    )
    shape = DrivenShape.of(mode)
    assert shape.lengthwise == lengthwise
    np.testing.assert_allclose(
        shape.at(np.array([0.02]), np.array([0.01])), [[1.0], [0.0]], atol=1e-9
    )
    turned = (x[:, None] + 2 * y + 0.1j * x[:, None]) / (0.04 + 0.002j)
    np.testing.assert_allclose(shape.swing, turned.real)
    np.testing.assert_allclose(shape.rest, turned.imag, atol=1e-12)
    assert (shape.lobe, shape.half_wavelength) == ((0.02, 0.01), 8e-3)
