"""Pages and pictures of recordings and fits: every kind is drawn, and the words are there."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.unit.conftest import HOSTILE
from tests.unit.printed import printed

from squeezefilm.core.errors import InputError
from squeezefilm.core.kit import style
from squeezefilm.measure.fits.estimate import Adequacy, Estimate, Observation
from squeezefilm.measure.fits.friction.friction_curve import CurveComparison
from squeezefilm.measure.fits.friction.friction_scores import ModelScore
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.read import FolderCheck, RecordingCheck, Refused
from squeezefilm.measure.report.figures import recording_figure
from squeezefilm.measure.report.fit_figures import fit_figure, modelled
from squeezefilm.measure.report.page import (
    estimate_rows,
    fit_summary,
    show_check,
    show_fit,
    show_folder,
    write_checks,
    write_fit,
)
from squeezefilm.physics.uncertainty.uncertainty import FrictionBand
from squeezefilm.validation.populations import PopulationComparison
from squeezefilm.validation.published_friction import FolderComparison, TotalScore
from squeezefilm.validation.report.published import (
    coverage_rows,
    show_comparisons,
    write_comparisons,
)

pytestmark = pytest.mark.usefixtures("figures_as_described")

F = np.linspace(29e3, 31e3, 21)
T = np.linspace(0, 1e-2, 7001)
ONES = np.ones(21)
H = (1e-7 / (1 - (F / 30e3) ** 2 + 1j * F / 30e3 / 60)).astype(complex)
TOLD = kinds.Told(name="synthetic", licence="none needed")
RESPONSE = kinds.FrequencyResponse(F, H, 10.0, told=TOLD)
CURVE = kinds.FrictionCurve(
    np.linspace(0, 2e-6, 3),
    np.array([1.0, 0.7, 0.5]),
    30e3,
    0.5,
    0.02,
    np.full(3, 0.05),
    told=TOLD,
    display="a",
)
RECORDINGS: dict[str, kinds.Recording] = {
    "impedance": kinds.ImpedanceSweep(F, 1e-3 * (1 + 1j) * ONES, TOLD),
    "frequency response": RESPONSE,
    "line scan": kinds.LineScan(F * 1e-6, H, 30e3, told=TOLD),
    "grid scan": kinds.GridScan(F * 1e-6, F * 1e-6, H, 30e3, told=TOLD),
    "ring-down": kinds.RingDown(T, np.sin(1e5 * T) * 1e-6, TOLD),
    "voltage sweeps": kinds.VoltageSweeps((RESPONSE, RESPONSE), ("up", "down"), TOLD),
    "raw signals": kinds.RawSignals(T, np.sin(1e5 * T), np.sin(1e5 * T) * 1e-6, TOLD),
    "friction bench": kinds.FrictionBench(T, ONES[0] + T, T, T, T * 1e-4, TOLD),
    "friction curve": CURVE,
    "friction decays": kinds.FrictionDecays(ONES * 1e-6, ONES, 30e3, told=TOLD),
    "fingertip impedances": kinds.FingertipImpedances(ONES, ONES * 1e-4, 30e3, 0.5, TOLD),
    "detection thresholds": kinds.DetectionThresholds(
        ONES * 1e-3, ONES * 0.01, 0.5, 0.05, 15, TOLD
    ),
}


def checked(kind: str, *doubts: str) -> RecordingCheck:
    """A check of a recording of a kind."""
    facts = (("kind", kind), ("points", "21 rows"))
    return RecordingCheck(RECORDINGS[kind], kind, Path("a.csv"), None, 21, facts, doubts)


@dataclass(frozen=True, eq=False)
class MadeFit:
    """A fit as those of `measure.fits` are."""

    frequency: Any
    model: Any
    residual: Any
    resonance: Estimate
    branches: tuple[Estimate, ...]
    adequacy: Adequacy
    observations: tuple[Observation, ...] = (Observation("resonance_frequency", 3e4, 0.5),)


GOOD = Adequacy(True, 0.01, 0.01, "at 30 kHz", "It describes what was recorded.")
FIT = MadeFit(
    F, H * 1.01, -0.01 * H,
    Estimate(29997.13, 0.27, (29996.6, 29997.67), "Hz"),
    (Estimate(0.5, 0.02, (0.46, 0.54), "1"), Estimate(2.0, 0.0, (2.0, 2.0), "kg")),
    GOOD,
)  # fmt: skip


@pytest.mark.parametrize("kind", RECORDINGS)
def test_every_kind_has_its_picture(kind: str) -> None:
    figure = recording_figure(checked(kind, "a doubt"))
    assert "1 doubt" in figure.get_suptitle()
    assert "as recorded" in figure.get_supxlabel()
    assert len(style.png(figure, 40)) > 1000


@pytest.mark.usefixtures("undrawn")
def test_checks_are_written_with_what_could_not_be_read(tmp_path: Path) -> None:
    hostile = replace(checked("ring-down", HOSTILE), file=Path("b <c>.csv"))
    both = FolderCheck((checked("impedance"), hostile), (Refused(Path("bad.csv"), "line 3: no"),))
    path = write_checks(both, tmp_path)
    assert {one.name for one in tmp_path.iterdir()} == {
        "check.html", "check.json", "a.png", "b--c-.png",
    }  # fmt: skip
    text = path.read_text(encoding="utf-8")
    assert "line 3: no" in text
    assert "<script>" not in text
    assert "Nothing doubtful was found." in text
    summary = json.loads((tmp_path / "check.json").read_text(encoding="utf-8"))
    assert summary["recordings"][0]["kind"] == "impedance"
    assert summary["stamp"]["config_sha256"]


@pytest.mark.usefixtures("undrawn")
def test_two_recordings_of_one_name_have_two_pictures(tmp_path: Path) -> None:
    write_checks(FolderCheck((checked("impedance"), checked("line scan")), ()), tmp_path)
    assert {one.name for one in tmp_path.glob("*.png")} == {"a.png", "a-2.png"}


@pytest.mark.usefixtures("undrawn")
def test_nothing_half_written_is_left_where_a_folder_refuses(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("a file", encoding="utf-8")
    with pytest.raises(InputError, match="cannot write"):
        write_checks(FolderCheck((checked("impedance"),), ()), blocked)
    assert blocked.read_text(encoding="utf-8") == "a file"


@pytest.mark.usefixtures("undrawn")
def test_a_fit_shows_two_digits_of_its_error_and_its_interval(tmp_path: Path) -> None:
    assert estimate_rows(FIT) == [
        ("resonance", "29.99713 kHz", "29.9966 kHz to 29.99767 kHz", "0.27 Hz"),
        ("branches 1", "0.5", "0.46 to 0.54", "0.02"),
        ("branches 2", "2 kg", "2 kg to 2 kg", "0 kg"),
    ]
    path = write_fit(checked("frequency response", "a doubt"), FIT, tmp_path)
    text = path.read_text(encoding="utf-8")
    assert "The fit is adequate" in text
    assert "29.99713 kHz" in text.replace("\u00a0", " ")
    assert {"fit.png", "recording.png", "fit.json"} <= {one.name for one in tmp_path.iterdir()}
    summary = fit_summary(checked("frequency response"), FIT, FIT)
    assert summary["estimates"]["resonance"]["value"] == 29997.13
    assert summary["observations"][0]["answer"] == "resonance_frequency"
    assert summary["response"]["adequacy"]["adequate"] is True


def test_what_is_printed_says_it_in_words() -> None:
    assert "Nothing doubtful was found." in printed(lambda: show_check(checked("impedance")))
    both = FolderCheck((checked("impedance", "hum"),), (Refused(Path("b"), "line 3: no"),))
    lines = printed(lambda: show_folder(both))
    assert "doubtful hum" in lines
    assert "refused line 3: no" in lines
    bad = replace(FIT, adequacy=replace(GOOD, adequate=False))
    lines = printed(lambda: show_fit(checked("frequency response", "hum"), bad, FIT))
    assert f"INADEQUATE {GOOD.sentence}" in lines
    assert f"adequate {GOOD.sentence}" in lines
    assert "doubtful hum" in lines


def test_a_fit_is_drawn_over_its_own_abscissa() -> None:
    found = modelled(checked("frequency response"), FIT)
    assert found is not None
    assert np.allclose(found.data, 1e9 * H)
    assert np.allclose(found.x, F / 1e3)
    figure = fit_figure(checked("frequency response"), FIT)
    assert figure is not None
    assert "an adequate fit" in figure.get_suptitle()
    assert modelled(checked("frequency response"), replace(FIT, model=None)) is None
    assert fit_figure(checked("line scan"), replace(FIT, frequency=None)) is None
    several = replace(FIT, frequency=None, model=np.tile(H, 2), residual=np.tile(H, 2))
    found = modelled(checked("voltage sweeps"), several)
    assert found is not None
    assert found.x.size == 42
    assert fit_figure(checked("voltage sweeps"), several) is not None


DRIVEN = replace(RESPONSE, coherence=ONES)


@dataclass(frozen=True, eq=False)
class Other(MadeFit):
    """What single kinds of fits have besides."""

    label: str = "(8,0)"
    response: Any = DRIVEN
    standard_error: Any = 1e-9
    amplitudes: Any = (0.0, 1e-6)
    coefficients: Any = FIT.branches

    @staticmethod
    def admittance(frequency: Any) -> Any:
        """What a circuit has."""
        return np.full(frequency.size, 1e-3 + 1e-3j)


@pytest.mark.parametrize("kind", ["impedance", "grid scan", "raw signals", "friction bench"])
def test_kinds_of_their_own_picture(kind: str) -> None:
    fit = Other(F, H * 1.01, -0.01 * H, FIT.resonance, FIT.branches, GOOD)
    figure = fit_figure(checked(kind), fit)
    assert figure is not None
    assert "synthetic: an adequate fit" in figure.get_suptitle()
    assert len(style.png(figure, 40)) > 1000


def compared() -> CurveComparison:
    """A curve beside two models, with numbers made up for showing."""
    amplitude = CURVE.vibration_amplitude
    band = FrictionBand(amplitude, np.array([1, 0.5, 0.4]), np.array([1, 0.9, 0.8]), 0.9, 64)
    return CurveComparison(
        curve=CURVE,
        display="biet2008-plate",
        models=(
            ModelScore("partial-levitation", 1, np.array([1, 0.71, 0.49]), 0.008, 0.2),
            ModelScore("levitation", 1, np.array([1, 0.4, 0.2]), 0.24, 4.9),
            ModelScore("levitation-2016", 1, np.full(3, np.nan), None, None),
        ),
        at_rest=1.0,
        fitted_at_rest=1.0,
        normal_force=0.5,
        speed=0.02,
        assumed=("speed",),
        band=band,
        adequacy=replace(GOOD, adequate=False, sentence="The default is off."),
        inside_levels=np.array([[False, k > 3, k > 5] for k in range(9)]),
    )


def folder() -> FolderComparison:
    """Two curves and one number of many people, made up for showing."""
    people = PopulationComparison(
        TOLD, "a", "30 kHz", "decay amplitude τ", "m", np.array([1e-6, 2e-6, 3e-6]),
        (("levitation", 1.5e-6), ("levitation-2016", None)),
    )  # fmt: skip
    total = TotalScore("partial-levitation", 1, 2, 0.008, 1.5, None)
    return FolderComparison((compared(), compared()), (total,), (people,))


@pytest.mark.usefixtures("undrawn")
def test_curves_are_shown_beside_all_models(tmp_path: Path) -> None:
    lines = printed(lambda: show_comparisons(folder()))
    assert "partial-levitation 0.008 0.2 3 of 3 1" in lines
    assert "levitation (the default) 0.240 4.9 3 of 3 1" in lines
    assert "levitation-2016 – – 0 of 3 1" in lines
    assert any(line.startswith("2 of 2 points that vibrate lie in the 90 %") for line in lines)
    assert any("20 mm/s (assumed)" in line for line in lines)
    assert "partial-levitation 0.008 1.50 1" in lines
    assert "levitation (the default) 1.5 µm 33 %" in lines
    assert any("1 of 1 fingers or papers lie in the interval" in line for line in lines)
    assert any("friction at rest is fitted to each curve" in line for line in lines)
    text = write_comparisons(folder(), tmp_path).read_text(encoding="utf-8")
    assert "The default is off." in text
    assert "licence: none needed" in text
    names = {one.name for one in tmp_path.iterdir()}
    pictures = {f"curve-{number}.png" for number in (1, 2, 3)}
    assert names == {"curves.json", "measured-curves.html"} | pictures
    summary = json.loads((tmp_path / "curves.json").read_text(encoding="utf-8"))
    assert summary["curves"][0]["interval"]["points_inside"] == 2
    assert summary["curves"][0]["models"][2]["rms_difference"] is None
    found = fit_summary(checked("friction curve"), compared())
    assert found["comparison"]["display"] == "biet2008-plate"
    assert fit_figure(checked("friction curve"), compared()) is not None
    lines = printed(lambda: show_fit(checked("friction curve"), compared()))
    assert "partial-levitation 0.008 0.2 3 of 3 1" in lines


def test_coverage_is_counted_by_unit_at_each_level() -> None:
    found = folder()
    ((unit, (inside, points)),) = found.coverage.items()
    assert unit == CURVE.unit
    # Two curves of one finger, each with two points that vibrate.
    assert points == 4
    assert inside.tolist() == [0, 0, 0, 0, 2, 2, 4, 4, 4]
    assert coverage_rows(found) == [(CURVE.told.name, "4", "50 %", "100 %")]
