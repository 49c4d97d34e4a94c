"""Friction read as it was published: in newtons, without a spread, with conditions as columns."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.unit.measure.recordings.bench_files import text, written
from tests.unit.measure.recordings.test_read import described

from squeezefilm.core import presets
from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.recordings import assembled_friction, kinds
from squeezefilm.measure.recordings.described import DescribedDecays, DescribedTouches
from squeezefilm.measure.recordings.description import KINDS
from squeezefilm.measure.recordings.read import check_folder, check_recording, read_recording
from squeezefilm.physics.display import load_display

FRICTION = ("friction curve", "friction decays", "fingertip impedances")


def test_each_kind_has_its_description_and_its_reader() -> None:
    assert KINDS["friction decays"] is DescribedDecays
    assert KINDS["fingertip impedances"] is DescribedTouches
    for reader in (assembled_friction.curve, assembled_friction.decays, assembled_friction.touches):
        assert reader.__doc__


def test_friction_is_read_as_it_was_published(tmp_path: Path) -> None:
    a = np.linspace(0.1, 2, 9)
    typed = described(
        "friction curve",
        'vibration_amplitude = { column = 1, unit = "um", given_as = "peak-to-peak" }\n'
        'friction_force = { column = 2, unit = "mN" }\nspread = { column = 3, unit = "mN" }\n'
        'normal_force = { column = 4, unit = "N" }',
        'frequency = "30 kHz"\nfinger = "person 1"\nreading_error = "1 %"\nsource = "a paper"',
    )
    columns = (a, 300 - 100 * a, np.full(9, 5.0), np.linspace(0.1, 0.5, 9))
    found = check_recording(written(tmp_path, text("a,f,s,n", columns), typed))
    curve = found.recording
    assert isinstance(curve, kinds.FrictionCurve)
    assert curve.friction == pytest.approx(0.3 - 0.1 * a)
    assert curve.vibration_amplitude == pytest.approx(0.5e-6 * a)
    assert curve.normal_force == pytest.approx(columns[3])
    assert curve.speed is None
    assert curve.deviation == pytest.approx(np.hypot(5e-3, 0.01 * curve.friction.max()))
    assert curve.unit == "a paper: person 1"
    assert any("speed is not told" in doubt for doubt in found.doubts)
    for wrong, why in (
        (typed.replace("frequency =", "# "), "'frequency' is missing"),
        (typed.replace("frequency =", 'normal_force = "1 N"\nfrequency ='), "a column and a value"),
        (typed.replace("friction_force", "phase"), "phase"),
        (typed.replace("spread", "relative_friction"), "has one column of"),
        (typed.replace('friction_force = { column = 2, unit = "mN" }', ""), "named are none"),
    ):
        with pytest.raises(ConfigError, match=why):
            read_recording(written(tmp_path, text("a,f,s,n", columns), wrong))


def test_what_comes_with_the_program_can_be_read() -> None:
    found = check_folder(presets.friction_folder())
    assert found.refused == ()
    assert len(found.checks) == 7
    assert {check.kind for check in found.checks} == {*FRICTION, "detection thresholds"}
    for check in found.checks:
        assert check.recording.told.source
        if isinstance(check.recording, kinds.DetectionThresholds):
            assert check.recording.period == pytest.approx(8e-3 / 2.0 ** np.arange(7))
            assert (check.recording.people, check.recording.speed) == (15, 0.05)
            continue
        assert isinstance(
            check.recording,
            kinds.FrictionCurve | kinds.FrictionDecays | kinds.FingertipImpedances,
        )
        assert load_display(check.recording.display).name
