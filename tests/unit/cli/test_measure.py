"""The verbs of what a bench measured: what they print, write and refuse, and their exit codes."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.e2e.program import run
from tests.unit.measure.recordings.bench_files import (
    IMPEDANCE,
    impedance_text,
    resonator,
    text,
    written,
)

from squeezefilm.cli.measure import check, fit
from squeezefilm.measure.fits.estimate import Adequacy, Estimate
from squeezefilm.measure.fits.friction.friction_scores import SHAPES
from squeezefilm.physics.chain.pad_law import MODEL_KINDS
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.validation.published_friction import FolderComparison

StandsIn = Callable[..., Any]


@dataclass(frozen=True)
class MadeFit:
    """A fit as those of `measure.fits` are."""

    resonance: Estimate
    adequacy: Adequacy
    observations: tuple[Any, ...] = ()


def made(adequate: bool) -> MadeFit:
    """A fit that is adequate or not."""
    words = Adequacy(adequate, 0.01, 0.01, "at 30 kHz", "So it is.")
    return MadeFit(Estimate(30e3, 2.0, (29996.0, 30004.0), "Hz"), words)


def turned() -> str:
    """A file whose phase is off by 180 degrees."""
    f, z = resonator()
    return text("f,Z,theta", (f, np.abs(z), np.degrees(np.angle(z)) + 180))


def test_a_check_says_how_a_file_was_read_and_writes_its_picture(tmp_path: Path) -> None:
    path = written(tmp_path, impedance_text())
    done = run("measure", check.__name__, str(path), "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    assert "from column 1 'f (Hz)' in Hz" in done.stdout
    assert "Nothing doubtful was found." in done.stdout
    assert (tmp_path / "out" / "a.png").is_file()
    assert f"page: {tmp_path / 'out' / 'check.html'}" in done.stdout.replace("\n", "")
    as_json = run("measure", "check", str(path), "--json")
    assert json.loads(as_json.stdout)["recordings"][0]["points"] == 41


def test_a_file_that_cannot_be_read_is_one_message_and_leaves_nothing(tmp_path: Path) -> None:
    path = written(tmp_path, impedance_text().replace("-", "x", 1))
    done = run("measure", "check", str(path), "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: {path}, line 2, column 3: ")
    assert not (tmp_path / "out").exists()
    folder = run("measure", "check", str(tmp_path), "--out", str(tmp_path / "out"))
    assert folder.returncode == 1
    assert "1 could not be read" in folder.stdout
    both = run("measure", "check", str(tmp_path), "--described", str(path))
    assert "--described and --write go with one file" in both.stderr


@pytest.mark.parametrize("adequate", [True, False])
def test_a_fit_says_whether_it_is_adequate_by_its_exit_code(
    adequate: bool, stands_in: StandsIn, tmp_path: Path
) -> None:
    stands_in("measure.fits.by_kind:fit_recording", made(adequate))
    path = written(tmp_path, impedance_text())
    done = run("measure", fit.__name__, str(path), "--out", str(tmp_path / "out"))
    assert done.returncode == (0 if adequate else 1), done.stderr
    assert ("INADEQUATE" in done.stdout) is not adequate
    assert "30 kHz" in done.stdout
    assert (tmp_path / "out" / "fit.html").is_file()
    as_json = run("measure", "fit", str(path), "--json")
    assert json.loads(as_json.stdout)["adequacy"]["adequate"] is adequate


def test_where_a_fit_is_refused_the_doubts_are_said(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from squeezefilm.core.errors import InputError
    from squeezefilm.measure.fits import by_kind

    def refuses(*_: Any, **__: Any) -> None:
        raise InputError("the sweep gives out power")

    monkeypatch.setattr(by_kind, "fit_recording", refuses)
    done = run("measure", "fit", str(written(tmp_path, turned(), IMPEDANCE)))
    assert done.returncode == 2
    doubt, error = done.stderr.strip().split("\n")[-2:]
    assert doubt.startswith("doubtful: the conductance is negative at 100 %")
    assert error == "error: the sweep gives out power"


def test_measured_curves_are_compared_in_place_of_the_claims(
    stands_in: StandsIn, tmp_path: Path
) -> None:
    nothing = FolderComparison((), (), ())
    asked = stands_in("validation.published_friction:compare_folder", nothing, tells=False)
    page = stands_in("validation.report.published:write_comparisons", tmp_path / "page.html")
    done = run("reproduce", "--data", str(tmp_path), "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    assert asked.given[0] == tmp_path
    assert page.given == (nothing, tmp_path / "out")
    as_json = run("reproduce", "--data", str(tmp_path), "--json")
    assert json.loads(as_json.stdout)["curves"] == []
    refused = run("reproduce", "--data", str(tmp_path), "--write-docs")
    assert "a page of --data published, of no other data" in refused.stderr


def test_a_folder_without_curves_is_refused_before_any_work(tmp_path: Path) -> None:
    written(tmp_path, impedance_text())
    done = run("reproduce", "--data", str(tmp_path))
    assert done.returncode == 2
    assert "holds no friction curve, only: impedance" in done.stderr


CURVE = """\
kind = "friction curve"
name = "synthetic, by partial levitation"
display = "biet2008-plate"
frequency = "30 kHz"
normal_force = "0.5 N"
speed = "20 mm/s"
[columns]
vibration_amplitude = { column = 1, unit = "um", given_as = "peak-to-peak" }
relative_friction = { column = 2, unit = "%" }
spread = { column = 3, unit = "%" }
"""


@pytest.mark.slow
def test_a_synthetic_curve_in_a_folder_is_nearest_to_the_model_that_made_it(
    tmp_path: Path,
) -> None:
    law = predict(
        "biet2008-plate", vibration_amplitude=2e-6, frequency=30e3, normal_force=0.5, speed=0.02
    ).law
    amplitude = np.linspace(0, 2e-6, 6)
    friction = law.by("partial-levitation").curve(amplitude)
    data = text("a,m,s", (2e6 * amplitude, 100 * friction, np.full(6, 3.0)))
    written(tmp_path, data, CURVE)
    done = run("reproduce", "--data", str(tmp_path), "--json", "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    (found,) = json.loads(done.stdout)["curves"]
    assert found["models"][0]["model"] == "partial-levitation"
    assert found["models"][0]["rms_difference"] == pytest.approx(0, abs=1e-8)
    assert len(found["models"]) == len(MODEL_KINDS) + len(SHAPES)
    assert found["interval"]["points_asked"] == 5
    page = (tmp_path / "out" / "measured-curves.html").read_text(encoding="utf-8")
    assert "synthetic, by partial levitation" in page
