"""The page and the pictures of a calibration: what they say, and that they say it of any."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.core.calibration_record import ComparedAnswer, UsedRecording
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.numbers import M, N
from squeezefilm.measure.calibration.calibration import (
    CalibratedValue,
    Calibration,
    FrictionInterval,
    Joint,
)
from squeezefilm.measure.calibration.discrepancy import Misfit
from squeezefilm.measure.calibration.folder import FolderCalibration
from squeezefilm.measure.calibration.identified import (
    Combination,
    Identification,
    Known,
    NextMeasurement,
)
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.measure.report.calibration_page import (
    FIGURES,
    deviation,
    value_rows,
    write_calibration,
)
from squeezefilm.physics.display import load_display

pytestmark = pytest.mark.usefixtures("figures_as_described")

FORCE, LENGTH = "finger.normal_force", "finger.contact_length"
NOTHING = np.zeros((4, 0))
AT_1 = "relative friction at 1 µm"
MET = ComparedAnswer(AT_1, "0.6", 0.05, (0.4, 0.9, 1.3), (0.9, 1.0, 1.1), "b.csv", 0.6, 1e-6)
MISSED = ComparedAnswer("mass", "100 g", 0.001, (0.9, 1.0, 1.1), (1.02, 1.03, 1.04), "<b>.csv")


def made(**changed: Any) -> FolderCalibration:
    """A calibration that nobody computed, for its looks."""
    display = load_display("biet2008-stator")
    calibration = Calibration(
        described=display,
        display=display,
        observations=(Observation("mass", 0.1, 1e-4),),
        values=(
            CalibratedValue(LENGTH, M, (8e-3, 12e-3), 1e-2, 1e-3, (8.1e-3, 1.19e-2), 0.97),
            CalibratedValue(FORCE, N, (0.3, 0.7), 0.4, 0.02, (0.38, 0.42), 0.1),
        ),
        identification=Identification(
            (Known(FORCE, 0.1), Known(LENGTH, 0.97)),
            (Combination(0.2, ((FORCE, 0.8), (LENGTH, -0.6))),),
        ),
        laws={"height_law": {"gaussian": 0.25, "exponential": 0.75}},
        misfits=(Misfit(1.0, 3, 0.8, "mass", 0.4), Misfit(40.0, 4, 1e-6, AT_1, 5.0)),
        before=FrictionInterval(0.4, (0.1, 0.8), 1.9e-6),
        after=FrictionInterval(0.5, (0.4, 0.6), 2e-6),
        next_measurements=(
            NextMeasurement("mass on a balance", "±0.1 %", 0.4),
            NextMeasurement("quality factor", "±5 %", 1.0),
        ),
        emulator_errors={"mass": 0.00012},
        solves=40,
        seed=7,
        doubts=("The draws are few.",),
        joint=Joint(
            (),
            NOTHING,
            {},
            np.full(4, 2e-6),
            np.full(4, 2e-6),
            np.full(4, np.nan),
            np.zeros(4),
        ),
        compared=(MET, MISSED),
    )
    laws_free = dataclasses.replace(calibration, **changed)
    recordings = (
        UsedRecording("b.csv", "friction bench", "A. <B>", "2026-11-01", sha256="ab" * 32),
    )
    return FolderCalibration(laws_free, recordings, ("c.csv: its fit is not adequate",))


def test_a_page_says_all_that_came_out(tmp_path: Path) -> None:
    found = made()
    page = sf.write_report(found, tmp_path)
    assert page == tmp_path / "calibration.html"
    text = " ".join(page.read_text(encoding="utf-8").replace("\u00a0", " ").split())
    for said in (
        "The model does NOT explain it", "The draws are few.", "The plate: The model explains",
        "Friction: The model does not explain", FORCE, "Only together are fixed",
        "c.csv: its fit is not adequate", "A. &lt;B&gt;", "ab" * 32, "mass 0.012 %", "Seed 7.",
        "exponential 75 %", "40 plates were solved", 'src="friction.png"',
        "What to measure next", "mass on a balance", "&lt;b&gt;.csv",
        "+3.0 % (+2.0 % to +4.0 %)", 'href="calibrated.toml"',
    ):  # fmt: skip
        assert said in text.replace("+3.00", "+3.0").replace("+2.00", "+2.0").replace(
            "+4.00", "+4.0"
        ), said
    numbers = json.loads((tmp_path / "calibration.json").read_text(encoding="utf-8"))
    assert numbers["recordings"][0]["sha256"] == "ab" * 32
    assert numbers["compared"][1]["said"] == "mass"
    assert numbers["stamp"]["seed"] == 7
    read = load_display(tmp_path / "calibrated.toml")
    assert read.calibration is not None
    assert read.calibration.compared == found.calibration.compared
    assert not read.calibration.fits
    assert {one.suffix for one in tmp_path.iterdir()} == {".html", ".json", ".toml", ".png"}


@pytest.mark.usefixtures("undrawn")
def test_what_is_not_known_is_left_out(tmp_path: Path) -> None:
    bare = made(values=(), compared=(), next_measurements=(), before=None, after=None, misfits=(),
                emulator_errors={}, laws={}, doubts=())  # fmt: skip
    text = write_calibration(bare, tmp_path).read_text(encoding="utf-8")
    assert "No plate was solved" in text
    assert "too many draws have none" in text
    assert "values.png" not in text
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError):
        write_calibration(bare, tmp_path / "file")


def test_a_deviation_is_in_standard_errors_of_both() -> None:
    assert deviation(MET) == pytest.approx(0.0)
    # ±0.01 at 90 % are 0.00608 of a standard deviation.
    assert deviation(MISSED) == pytest.approx(-0.03 / math.hypot(0.001, 0.01 / 1.6449), rel=1e-3)
    assert math.isnan(deviation(dataclasses.replace(MET, after=())))


def test_what_the_data_told_most_of_stands_first() -> None:
    assert [row[0] for row in value_rows(made())] == [FORCE, LENGTH]
    assert value_rows(made())[0][1:] == ("0.3 N to 0.7 N", "0.4 N", "0.38 N to 0.42 N", "10 %")


@pytest.mark.parametrize("figure", [one.key for one in FIGURES])
def test_every_figure_is_plotted_by_its_name(figure: str) -> None:
    assert sf.plot(made(), figure).get_suptitle()
