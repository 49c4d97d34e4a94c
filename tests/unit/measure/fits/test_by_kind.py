"""Which fit goes with which kind: every kind has one, and it is asked for by a recording or a
path."""

from __future__ import annotations

import sys
import typing
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.measure.recordings.bench_files import impedance_text, written

import squeezefilm as sf
from squeezefilm.errors import InputError
from squeezefilm.measure.fits.by_kind import FITS, fit_recording, response_fit
from squeezefilm.measure.recordings import kinds


def stand_in(monkeypatch: pytest.MonkeyPatch, module: str, **functions: Any) -> None:
    """A module of fits in the real one's place."""
    name = f"squeezefilm.measure.fits.{module}"
    made = ModuleType(name)
    vars(made).update(functions)
    monkeypatch.setitem(sys.modules, name, made)


def test_every_kind_of_recording_has_its_fit() -> None:
    assert set(typing.get_args(kinds.Recording)) == set(FITS)
    assert sf.fit_recording is fit_recording


def test_a_recording_or_its_path_reaches_the_fit(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    stand_in(monkeypatch, "circuit.impedance", fit_impedance=lambda sweep: sweep.told.name)
    path = written(tmp_path, impedance_text())
    assert fit_recording(path) == fit_recording(str(path)) == "synthetic resonator"
    assert fit_recording(sf.read_recording(path)) == "synthetic resonator"
    with pytest.raises(InputError, match="dict is no kind of recording"):
        fit_recording({})  # type: ignore[arg-type]


SCAN = kinds.GridScan(
    np.linspace(0.01, 0.07, 16), np.linspace(0.01, 0.03, 16), np.ones(16) + 0j, 33.6e3
)


def test_a_grid_scan_needs_a_plate() -> None:
    with pytest.raises(InputError, match="name its display, a rectangular plate"):
        fit_recording(SCAN)
    with pytest.raises(InputError, match="name its display, a rectangular plate"):
        fit_recording(SCAN, "biet2008-stator")


@pytest.mark.slow
def test_a_grid_scan_meets_the_solved_modes_near_its_frequency(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stand_in(
        monkeypatch,
        "vibration.grid_scan",
        shapes_at=lambda modes, x, y, lobe: (modes, x, y, lobe),
        fit_grid_scan=lambda scan, shapes: shapes,
    )
    found: Any = fit_recording(SCAN, "biet2008-plate")
    modes, x, _, lobe = found
    assert x is SCAN.x
    assert (8, 0) in modes.labels
    assert np.all(np.abs(modes.frequencies / SCAN.frequency - 1) <= 0.1)
    assert 0 < lobe[0] < 0.083


def test_signals_are_fitted_by_the_response_that_they_give(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stand_in(
        monkeypatch,
        "vibration.frequency_response",
        fit_frequency_response=lambda one: one.frequency,
    )
    f = np.linspace(1e4, 2e4, 5)
    response = kinds.FrequencyResponse(f, np.ones(5) + 0j)
    found: Any = response_fit(SimpleNamespace(response=response))  # type: ignore[arg-type]
    assert found is f
    assert response_fit(SimpleNamespace()) is None  # type: ignore[arg-type]
