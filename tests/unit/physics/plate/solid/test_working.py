"""The working mode of a plate with its response: one mesh for both, and one answer."""

from __future__ import annotations

import dataclasses
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.kept.store import CACHE_VARIABLE
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.physics.plate.solid.layers import FINE
from squeezefilm.physics.plate.solid.response import harmonic_response
from squeezefilm.physics.plate.solid.solve import ModesRequest, solve_modes, solved_classes
from squeezefilm.physics.plate.solid.working import SolidMode, solid_mode

GLASS = ElasticMaterial("glass", 72e9, 0.22, 2480)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)
PLATE = RectangularPlate(
    24e-3, 14e-3, 1.2e-3, 3, 60, GLASS, CERAMIC,
    (CeramicPatch(2e-3, 0, 20e-3, 14e-3, 0.5e-3),), lines_across="length",
)  # fmt: skip
LABEL = (2, 0)


@pytest.fixture(scope="module")
def mode() -> SolidMode:
    return solid_mode(PLATE, LABEL)


def test_the_response_on_the_modes_mesh_is_that_of_one_of_its_own(mode: SolidMode) -> None:
    alone = harmonic_response(PLATE, mode.response.frequencies)
    assert mode.response.admittance == pytest.approx(alone.admittance, rel=2e-3)
    ours, other = mode.response.amplitude_at(*mode.lobe), alone.amplitude_at(*mode.lobe)
    assert np.max(np.abs(ours - other)) < 2e-3 * other.max()
    # Both stand where the mode was extrapolated to.
    at = int(np.argmax(ours))
    assert mode.response.frequencies[at] == pytest.approx(mode.frequency, rel=2e-3)


def test_the_modes_are_those_of_solve_modes(mode: SolidMode) -> None:
    modes, pieces = solved_classes(
        ModesRequest(PLATE, mode=LABEL, tolerance=3e-3), keep_factors=True
    )
    other = solve_modes(PLATE, mode=LABEL, tolerance=3e-3)
    assert np.array_equal(modes.frequencies, other.frequencies)
    assert np.array_equal(modes.frequencies, mode.modes.frequencies)
    assert [piece.solved.parity for piece in pieces] == list(dict.fromkeys(modes.parities))


def test_within_the_band_nothing_is_solved_again(
    mode: SolidMode, monkeypatch: pytest.MonkeyPatch
) -> None:
    from squeezefilm.physics.plate.solid import working

    solved: list[int] = []

    def counted(plate: RectangularPlate, band: np.ndarray, **how: Any) -> object:
        solved.append(band.size)
        return harmonic_response(plate, band, **how)

    monkeypatch.setattr(working, "harmonic_response", counted)
    f = mode.response.frequencies[[40, 120, 80, 80]]
    line = mode.response.amplitude_at(*mode.lobe)
    assert mode.amplitude_per_volt_at(f) == pytest.approx(line[[40, 120, 80, 80]], rel=1e-9)
    assert solved == []
    beyond = 1.01 * float(mode.response.frequencies[-1])
    assert mode.amplitude_per_volt_at(beyond).shape == (1,)
    assert solved == [2]


def test_a_pickled_response_has_its_state_again(mode: SolidMode) -> None:
    again = pickle.loads(pickle.dumps(mode.response))
    assert np.array_equal(again.admittance, mode.response.admittance)
    assert again.maximum == pytest.approx(mode.response.maximum, rel=1e-12)


@pytest.mark.slow
def test_the_amplitude_s_error_holds_the_finer_mesh(mode: SolidMode) -> None:
    f = mode.response.frequencies
    finer = harmonic_response(PLATE, f, resolution=FINE).amplitude_at(*mode.lobe).max()
    assert 0 < mode.amplitude_error < 0.05 * mode.amplitude_per_volt
    assert abs(mode.amplitude_per_volt - finer) <= mode.amplitude_error


def test_the_circuit_is_what_the_response_shows(mode: SolidMode) -> None:
    circuit = mode.circuit
    assert circuit is not None
    assert mode.circuit_said == ""
    near = np.abs(mode.response.frequencies / mode.frequency - 1) < 0.5 / mode.quality_factor
    shown = mode.response.admittance[near]
    made = circuit.admittance(mode.response.frequencies[near])
    assert np.max(np.abs(made - shown)) < 0.05 * np.max(np.abs(shown))
    assert (circuit.frequency, circuit.quality_factor) == (mode.frequency, mode.quality_factor)
    moving, static = circuit.motional_capacitance, circuit.static_capacitance
    coupling = float(mode.modes.couplings[mode.index])
    assert np.sqrt(moving / (moving + static)) == pytest.approx(coupling, rel=0.05)


def test_amplitudes_are_at_the_antinode_and_largest_on_the_face(mode: SolidMode) -> None:
    response, at = mode.driven_at()
    assert (response, at) == (mode.response, mode.resonance)
    assert mode.response.amplitude_at(*mode.lobe)[at] == mode.amplitude_per_volt
    assert mode.largest_per_volt == pytest.approx(mode.response.maximum[at], rel=1e-12)
    assert mode.alone_per_volt == pytest.approx(mode.amplitude_per_volt, rel=0.05)


def test_another_process_has_the_solved_plate_to_the_bit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mode: SolidMode
) -> None:
    from squeezefilm.physics.plate.solid import working

    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    working._solid_mode.cache_clear()
    first = solid_mode(PLATE, LABEL)
    # As another process finds it: nothing in memory, and no solver to ask.
    working._solid_mode.cache_clear()
    monkeypatch.setattr(working, "_solved_mode", None)
    kept = solid_mode(PLATE, LABEL)
    working._solid_mode.cache_clear()
    assert kept is not first
    x, y = np.linspace(0, PLATE.length, 7), np.linspace(0, PLATE.width, 5)
    for found in (first, kept):
        assert np.array_equal(found.modes.frequencies, mode.modes.frequencies)
        assert np.array_equal(found.response.displacement(x, y), mode.response.displacement(x, y))
        assert found.neighbour == mode.neighbour
        assert np.array_equal(found.response.maximum, mode.response.maximum)
        field = found.modes.field(0, x, y, PLATE.thickness)
        assert np.array_equal(field, mode.modes.field(0, x, y, PLATE.thickness))
    # Another plate is another question.
    monkeypatch.undo()
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    other = dataclasses.replace(PLATE, thickness=1.3e-3)
    assert solid_mode(other, LABEL).frequency != kept.frequency
    working._solid_mode.cache_clear()
