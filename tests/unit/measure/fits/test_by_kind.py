"""Which fit goes with which kind: every kind has one, and it is asked for by a recording or a
path."""

from __future__ import annotations

import typing
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.measure.recordings.bench_files import IMPEDANCE, impedance_text, written

import squeezefilm as sf
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.measure.fits import by_kind
from squeezefilm.measure.fits.by_kind import FITS, OF_MANY_PEOPLE, fit_recording, response_fit
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.kinds import CeramicBar
from squeezefilm.measure.recordings.read import check_recording
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc


def stand_in(monkeypatch: pytest.MonkeyPatch, **functions: Any) -> None:
    """Fits in the real ones' place."""
    for name, function in functions.items():
        monkeypatch.setattr(by_kind, name, function)


def test_every_kind_of_recording_has_its_fit() -> None:
    compared = typing.get_args(OF_MANY_PEOPLE)
    assert set(typing.get_args(kinds.Recording)) == set(FITS) | set(compared)
    touches = kinds.FingertipImpedances(np.ones(3), np.ones(3) * 1e-4, 30e3, 0.5)
    with pytest.raises(InputError, match="reproduce --data"):
        fit_recording(touches)
    assert sf.fit_recording is fit_recording


def test_a_recording_or_its_path_reaches_the_fit(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    stand_in(monkeypatch, fit_impedance=lambda sweep: sweep.told.name)
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
        shapes_at=lambda modes, x, y, driven: (modes, x, y, driven.lobe),
        fit_grid_scan=lambda scan, shapes: shapes,
    )
    found: Any = fit_recording(SCAN, "biet2008-plate")
    modes, x, _, lobe = found
    assert x is SCAN.x
    assert (8, 0) in modes.labels
    assert np.all(np.abs(modes.frequencies / SCAN.frequency - 1) <= 0.1)
    assert 0 < lobe[0] < 0.083


def test_a_bare_ceramic_is_fitted_by_its_shape(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    stand_in(monkeypatch, fit_impedance=lambda sweep: "a circuit")
    stand_in(monkeypatch, bar_constants=lambda sweep, bar: bar)
    stand_in(monkeypatch, disc_constants=lambda sweep, disc: disc)
    bar = '[bar]\nlength = "12 mm"\nwidth = "3 mm"\nthickness = "1 mm"\ndensity = "7850 kg/m3"\n'
    disc = '[disc]\ndiameter = "35 mm"\nthickness = "2 mm"\ndensity = "7743 kg/m3"\n'
    text = impedance_text()
    assert fit_recording(written(tmp_path, text)) == "a circuit"
    for name, table, body in (
        ("bar", bar, CeramicBar(12e-3, 3e-3, 1e-3, 7850.0)),
        ("disc", disc, CeramicDisc(35e-3, 2e-3, 7743.0)),
    ):
        path = written(tmp_path, text, IMPEDANCE + table, f"{name}.csv")
        found: Any = fit_recording(path)
        assert found == body
        facts = dict(check_recording(path).facts)
        assert facts["body"].startswith(f"a bare ceramic {name}, {1e3 * body.thickness:g}"[:20])
    both = written(tmp_path, text, IMPEDANCE + bar + disc, "both.csv")
    with pytest.raises(ConfigError, match="a bar or a disc; give one"):
        fit_recording(both)


def test_a_line_scan_is_given_the_shape_of_a_plate_and_a_curve_its_display(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stand_in(monkeypatch, fit_line_scan=lambda scan, shape=None: shape)
    stand_in(
        monkeypatch,
        compare_friction_curve=lambda curve, progress, display: display,
    )
    scan = kinds.LineScan(np.linspace(0, 0.08, 30), np.ones(30) + 0j, 33.6e3)
    assert fit_recording(scan) is None
    assert fit_recording(scan, "biet2008-stator") is None
    one = np.ones(1)
    curve = kinds.FrictionCurve(one, one, 33.6e3, 0.5, 0.06)
    found: Any = fit_recording(curve, "biet2008-stator")
    assert found.name == "biet2008-stator"
    assert fit_recording(replace(curve, display="biet2008-plate"), "biet2008-stator") is None


def test_signals_are_fitted_by_the_response_that_they_give(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stand_in(
        monkeypatch,
        fit_frequency_response=lambda one: one.frequency,
    )
    f = np.linspace(1e4, 2e4, 5)
    response = kinds.FrequencyResponse(f, np.ones(5) + 0j)
    found: Any = response_fit(SimpleNamespace(response=response))  # type: ignore[arg-type]
    assert found is f
    assert response_fit(SimpleNamespace()) is None  # type: ignore[arg-type]


def test_a_grid_scan_is_compared_with_the_solved_shapes_about_its_frequency(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def kept(name: str) -> Any:
        def do(*said: Any, **how: Any) -> Any:
            asked.append((name, said, how))
            return name

        return do

    for name in ("solve_modes", "shapes_at", "solid_mode", "fit_grid_scan"):
        monkeypatch.setattr(by_kind, name, kept(name))
    monkeypatch.setattr(by_kind.DrivenShape, "of", kept("driven"))
    scan: Any = SimpleNamespace(frequency=30e3, x="x", y="y")
    plate = sf.load_display("biet2008-plate")
    found: Any = by_kind._grid(scan, plate, None)
    assert found == "fit_grid_scan"
    (_, (solved,), how), _, (_, (of,), _), (_, shapes, _), (_, fitted, _) = asked
    assert solved is plate.actuator
    assert of == "solid_mode"
    low, high = how["band"]
    # As far to either side.
    assert (low + high) / 2 == pytest.approx(30e3)
    assert 20e3 < low < 30e3
    assert shapes == ("solve_modes", "x", "y", "driven")
    assert fitted == (scan, "shapes_at")
    for other in (None, sf.load_display("biet2008-stator")):
        with pytest.raises(InputError, match="compared with a plate's solved shapes; name its"):
            by_kind._grid(scan, other, None)
