"""Friction read as it was published: in newtons, without a spread, with conditions as columns."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.unit.measure.recordings.bench_files import text, written
from tests.unit.measure.recordings.test_read import described

from squeezefilm.core import presets
from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.fits.friction.friction_bench import fit_friction_bench
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


BENCH = """time = { column = 1, unit = "s" }
normal_force = { column = 2, unit = "N" }
tangential_force = { column = 3, unit = "N" }
vibration_amplitude = { column = 4, unit = "um", given_as = "zero-to-peak" }"""


def test_a_bench_without_a_position_sensor_gives_the_strokes_of_one_with_it(
    tmp_path: Path,
) -> None:
    random, time = np.random.default_rng(3), np.arange(24 * 400) / 500
    stroke = np.arange(time.size) // 400
    way = np.where(stroke % 2, 1.0, -1.0)
    amplitude = random.choice([0.0, 0.5, 1.0, 1.5], 24)[stroke]
    normal = random.normal(0.5, 0.02, time.size)
    tangential = way * 0.8 * np.exp(-amplitude / 1.5) * normal
    place = 50.0 * np.cumsum(way) / 500
    columns = (time, normal, tangential, amplitude, place)
    typed = described("friction bench", BENCH, 'speed = "50 mm/s"')
    found = check_recording(written(tmp_path, text("t,n,f,a,x", columns), typed))
    assert any("place was not recorded" in doubt for doubt in found.doubts)
    placed = BENCH + '\nposition = { column = 5, unit = "mm" }'
    with_it = read_recording(
        written(tmp_path, text("t,n,f,a,x", columns), described("friction bench", placed, ""))
    )
    assert isinstance(found.recording, kinds.FrictionBench)
    assert isinstance(with_it, kinds.FrictionBench)
    fits = [fit_friction_bench(recording) for recording in (found.recording, with_it)]
    for without, known in zip(*(fit.coefficients for fit in fits), strict=True):
        assert without.value == pytest.approx(known.value, rel=1e-3)
    assert fits[0].speed == pytest.approx(0.05, rel=1e-6)
    for wrong in (
        described("friction bench", BENCH, ""),
        described("friction bench", placed, 'speed = "50 mm/s"'),
    ):
        with pytest.raises(ConfigError, match="in its place the speed"):
            read_recording(written(tmp_path, text("t,n,f,a,x", columns), wrong))


def test_two_points_are_a_friction_curve(tmp_path: Path) -> None:
    typed = described(
        "friction curve",
        'vibration_amplitude = { column = 1, unit = "um", given_as = "zero-to-peak" }\n'
        'friction_coefficient = { column = 2, unit = "1" }',
        'frequency = "30 kHz"',
    )
    curve = read_recording(written(tmp_path, "a,mu\n0,0.6\n1.5,0.3\n", typed))
    assert isinstance(curve, kinds.FrictionCurve)
    assert curve.friction.tolist() == [0.6, 0.3]
