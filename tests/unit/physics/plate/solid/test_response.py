"""A plate's response, from admittances and reduced classes made by hand: no plate is solved."""

from __future__ import annotations

import pickle
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.circuit import EquivalentCircuit
from squeezefilm.physics.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.physics.plate.solid import response
from squeezefilm.physics.plate.solid.layers import COARSE
from squeezefilm.physics.plate.solid.response import HarmonicResponse, harmonic_response

GLASS = ElasticMaterial("glass", 72e9, 0.22, 2480)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)


def circuit(frequency: float, quality: float, resistance: float, static: float) -> Any:
    """With a branch that resonates there: L = QR/ω, C = 1/ω²L."""
    omega = 2 * np.pi * frequency
    inductance = quality * resistance / omega
    return EquivalentCircuit(
        frequency, quality, static, resistance, inductance, 1 / (omega**2 * inductance)
    )


def plate(electrode: Any = "driven", **changes: Any) -> RectangularPlate:
    patch = CeramicPatch(2e-3, 0, 20e-3, 14e-3, 0.5e-3, electrode=electrode)
    good: dict[str, Any] = {
        "length": 24e-3, "width": 14e-3, "thickness": 1.2e-3, "nodal_lines": 3,
        "quality_factor": 60, "substrate": GLASS, "ceramic": CERAMIC, "patches": (patch,),
    }  # fmt: skip
    return RectangularPlate(**{**good, **changes})


def answered(
    frequencies: np.ndarray, admittance: np.ndarray, parts: list[Any] | None = None, **more: Any
) -> HarmonicResponse:
    given: dict[str, Any] = {
        "_coordinates": np.zeros((frequencies.size, 0)), "_potentials": [], **more,
    }  # fmt: skip
    return HarmonicResponse(
        plate(), frequencies, admittance, "made by hand", 0.0, "none", parts or [], **given
    )


def test_a_circuits_admittance_at_its_resonance_and_far_away() -> None:
    one = circuit(30e3, 80.0, 50.0, 4e-9)
    static = 2j * np.pi * 30e3 * 4e-9
    assert one.admittance(np.array([30e3]))[0] == pytest.approx(1 / 50 + static)
    # Far below both capacitors stand side by side, far above the static one alone.
    low = one.admittance(np.array([1.0]))[0] / (2j * np.pi)
    assert low.real == pytest.approx(4e-9 + one.motional_capacitance, rel=1e-6)
    high = one.admittance(np.array([3e7]))[0] / (2j * np.pi * 3e7)
    assert high.real == pytest.approx(4e-9 - one.motional_capacitance / 1e6, rel=1e-6)


def test_surface_amplitudes_are_read_off_the_modes(monkeypatch: pytest.MonkeyPatch) -> None:
    def values(parts: Any, x: np.ndarray, y: np.ndarray, top: float) -> np.ndarray:
        assert top == 1.2e-3
        shape = np.ones((x.size, y.size))
        return np.stack([x[:, None] * shape, y * shape])

    monkeypatch.setattr(response, "surface_values", values)
    q = np.array([[1.0, 1j], [3j, 4.0]])
    one = answered(np.array([1e3, 2e3]), np.zeros(2), _coordinates=q)
    a, b = 24e-3, 14e-3
    assert one.maximum == pytest.approx([np.hypot(a, b), np.hypot(3 * a, 4 * b)])
    assert one.resonance == 1
    assert one.amplitude_at(3e-3, 4e-3) == pytest.approx([5e-3, np.hypot(9e-3, 16e-3)])
    moved = one.displacement(np.array([1e-3, 2e-3]), np.array([0.0, 1e-3, 2e-3]))
    assert moved.shape == (2, 2, 3)
    assert moved[1, 1, 2] == pytest.approx(6e-3j + 8e-3)
    line = one.motion(-1, np.array([0.0, a]), np.array([1e-3]))[:, 0]
    assert line == pytest.approx([4e-3, 72e-3j + 4e-3])
    for at in (2, -3):
        with pytest.raises(InputError, match="at ="):
            one.motion(at, np.zeros(1), np.zeros(1))


@pytest.mark.parametrize("frequencies", [[2e3, 1e3], [1e3, 1e3]])
def test_frequencies_that_do_not_ascend_are_refused(frequencies: list[float]) -> None:
    with pytest.raises(InputError, match="must rise") as caught:
        harmonic_response(plate(), np.array(frequencies))
    assert caught.value.quantity == "frequencies"


def test_what_cannot_answer_is_refused_before_anything_is_solved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def solved(*_: object) -> None:
        raise AssertionError("a plate was solved")

    monkeypatch.setattr(response, "reduced_class", solved)
    f = np.array([1e3, 2e3])
    with pytest.raises(InputError, match="frequencies"):
        harmonic_response(plate(), np.array([0.0, 1e3]))
    with pytest.raises(InputError, match="no electrode is driven"):
        harmonic_response(plate("shorted"), f)
    with pytest.raises(InputError, match="steps"):
        harmonic_response(plate(), f, steps=0)


def test_a_band_chooses_how_long_the_krylov_space_is_and_the_progress_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[tuple[tuple[float, float], int]] = []
    told: list[tuple[str, float]] = []

    def reduced(plate: Any, parity: Any, band: Any, steps: int, *_: object) -> Any:
        asked.append((band, steps))
        return SimpleNamespace(basis=np.zeros((7, 0)))

    monkeypatch.setattr(response, "reduced_class", reduced)
    # A ceramic without a charge coefficient leaves no coordinates: that is said.
    for band, steps in (
        ((9e3, 10e3), 18), ((1.0, 10e3), 53), ((1e4, 1e4 + 1), 14), ((5e3, 10e3), 34),
    ):  # fmt: skip
        with pytest.raises(InputError, match="exert no force") as caught:
            harmonic_response(
                plate(), np.array(band), progress=lambda what, done: told.append((what, done))
            )
        assert caught.value.quantity == "charge_coefficient"
        assert asked[-1] == (band, steps)
    assert told[0][0].startswith("response, ")
    assert told[0][1] == 0.0
    with pytest.raises(InputError, match="exert no force"):
        harmonic_response(plate(), np.array([9e3, 10e3]), steps=3)
    assert asked[-1][1] == 3


def test_a_response_is_asked_at_other_frequencies_of_its_band() -> None:
    f = np.linspace(14e3, 16e3, 9)
    whole = harmonic_response(plate(), f, resolution=COARSE)
    some = whole.at(f[2:7])
    assert np.array_equal(some.frequencies, f[2:7])
    assert some.admittance == pytest.approx(whole.admittance[2:7], rel=1e-9)
    assert some.amplitude_at(8e-3, 7e-3) == pytest.approx(
        whole.amplitude_at(8e-3, 7e-3)[2:7], rel=1e-9
    )
    # Pickled, it leaves its state behind and has it again where it is asked.
    again = pickle.loads(pickle.dumps(some))
    assert again.maximum == pytest.approx(some.maximum, rel=1e-9)
    for outside in (13.9e3, 16.1e3):
        with pytest.raises(InputError, match="frequencies"):
            whole.at(np.array([outside]))
