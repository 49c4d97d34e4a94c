"""Shifts of a mode on the coarse mesh, by responses of one mode made by hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.design.analysis import sensitivities
from squeezefilm.design.analysis.sensitivities import CoarseShifts

MODE: Any = SimpleNamespace(resonance_frequency=30e3, lobe=(20e-3, 10e-3))


class Response:
    """A mode that moves as a cosine along x, and another far away that moves the other way."""

    def __init__(self, frequencies: np.ndarray, own: float, quality: float, force: float) -> None:
        self.frequencies = frequencies
        self._known = own, quality, force

    def _answer(self) -> np.ndarray:
        own, quality, force = self._known
        return force / (1 + 1j / quality - (self.frequencies / own) ** 2)

    def amplitude_at(self, x: float, y: float) -> np.ndarray:
        assert (x, y) == MODE.lobe
        return np.abs(self._answer())

    def displacement(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        shape = np.cos(np.pi * x / x[-1])[:, None] * np.ones(y.size)
        other = np.sin(np.pi * x / x[-1])[:, None] * np.ones(y.size)
        strong = 50 * np.exp(-(((self.frequencies - 31.5e3) / 100) ** 2))
        return self._answer()[:, None, None] * shape + strong[:, None, None] * other

    def at(self, frequencies: np.ndarray) -> Response:
        return Response(frequencies, *self._known)


@pytest.fixture
def solves(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    asked: list[Any] = []

    def answer(plate: Any, band: np.ndarray, **given: Any) -> Response:
        asked.append((plate, band[0], band[-1], given["resolution"]))
        return Response(band, plate.own, plate.quality, plate.force)

    monkeypatch.setattr(sensitivities, "harmonic_response", answer)
    return asked


def plate(own: float, quality: float = 60.0, force: float = 1.0) -> Any:
    return SimpleNamespace(own=own, quality=quality, force=force, length=80e-3, width=40e-3)


def test_frequency_and_amplitude_shift_as_the_mode_does(solves: list[Any]) -> None:
    shifts = CoarseShifts(plate(30.1e3), MODE)
    found = shifts.to(plate(29.5e3, 50.0, 1.2))
    assert found.frequency == pytest.approx(29.5 / 30.1 - 1, abs=2e-5)
    assert found.amplitude == pytest.approx(1.2 * 50 / 60 - 1, abs=1e-4)
    same = shifts.to(plate(30.1e3))
    assert same == pytest.approx((0.0, 0.0), abs=1e-12)
    # The plate as described is solved once.
    assert [item[0].own for item in solves] == [30.1e3, 29.5e3, 30.1e3]
    assert solves[0][1:3] == pytest.approx((0.94 * 30e3, 1.06 * 30e3))


@pytest.mark.parametrize(
    ("described", "changed", "said"),
    [(30e3, 27e3, "more than 6 %"), (30e3, 33e3, "more than 6 %"), (31e3, 30e3, "not move")],
)
def test_a_mode_that_is_lost_is_refused(
    described: float, changed: float, said: str, solves: list[Any]
) -> None:
    with pytest.raises(OutOfRangeError, match=said):
        CoarseShifts(plate(described), MODE).to(plate(changed))
