"""The parts of the synthetic bench: a softening resonance, strokes, files of every kind."""

import tomllib

import numpy as np
import pytest

from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.synthetic.bench import SyntheticBench
from squeezefilm.measure.synthetic.duffing import SofteningResonance
from squeezefilm.measure.synthetic.files import write_synthetic_bench
from squeezefilm.measure.synthetic.strokes import PlannedStrokes, recorded_strokes
from squeezefilm.measure.synthetic.truth import SyntheticOptions, SyntheticTruth
from squeezefilm.physics.display import load_display

F = np.linspace(29e3, 31e3, 60)


def test_without_dependence_on_the_amplitude_the_sweep_is_linear() -> None:
    linear = SofteningResonance(30e3, 60.0, 1e-7, 0.0, 0.0)
    wanted = -1e-6j * 1j / 60 / (1 + 1j / 60 - (F / 30e3) ** 2) / 1j
    assert linear.swept(F, 10.0) == pytest.approx(wanted, rel=1e-6)


def test_every_swept_amplitude_satisfies_the_equation_of_motion() -> None:
    soft = SofteningResonance(30e3, 60.0, 1e-7, -0.02e12, 0.1e6)
    for row in (F, F[::-1]):
        x = soft.swept(row, 10.0)
        force = [abs(soft.stiffness(f, abs(one)) * one) for f, one in zip(row, x, strict=True)]
        assert force == pytest.approx(np.full(F.size, 1e-6 / 60), rel=1e-6)


def test_strokes_have_the_forces_that_were_planned() -> None:
    planned = PlannedStrokes(*(np.array(one) for one in ([0.0, 1e-6], [0.1, 0.1], [0.5, 0.5],
                                                          [0.8, 0.4])))  # fmt: skip
    made = recorded_strokes(planned, np.random.default_rng(1), noise=1e-6)
    sliding = made.normal_force > 0.2
    pull = np.abs(made.tangential_force[sliding])
    assert pull.max() == pytest.approx(0.4, rel=1e-3)
    assert np.all(np.diff(made.time) > 0)
    assert np.ptp(made.position) == pytest.approx(0.05, rel=0.3)


def test_every_kind_is_written_with_its_units_and_conventions(tmp_path) -> None:
    row, wave = np.linspace(1.0, 2.0, 5), np.linspace(1.0, 2.0, 5) * 1e-6 + 1e-7j
    response = kinds.FrequencyResponse(F[:5], wave, 10.0)
    recordings: dict[str, kinds.Recording] = {
        "a": kinds.ImpedanceSweep(F[:5], wave),
        "b": response,
        "c": kinds.LineScan(row, wave, 30e3, 10.0),
        "d": kinds.GridScan(row, row, wave, 30e3),
        "e": kinds.RingDown(row, row),
        "f": kinds.VoltageSweeps((response, response), ("up", "up")),
        "g": kinds.RawSignals(row, row, row),
        "h": kinds.FrictionBench(row, row, row, row, row),
        "i": kinds.FrictionCurve(row, row, 30e3, 0.5, 0.1, row),
    }
    display = load_display("biet2008-stator")
    truth = SyntheticTruth(display, 1, SyntheticOptions())
    write_synthetic_bench(tmp_path, SyntheticBench(recordings, truth))
    said = {}
    for name in recordings:
        said[name] = tomllib.loads((tmp_path / f"{name}.toml").read_text("utf-8"))
        table = np.loadtxt(tmp_path / f"{name}.csv", delimiter=",", skiprows=1)
        assert table.shape[1] == len(said[name]["columns"])
    assert [one["kind"] for one in said.values()] == [
        "impedance", "frequency response", "line scan", "grid scan", "ring-down",
        "voltage sweeps", "raw signals", "friction bench", "friction curve",
    ]  # fmt: skip
    assert said["c"]["voltage"] == {"amplitude": "10 V", "given_as": "zero-to-peak"}
    assert said["c"]["columns"]["displacement"]["given_as"] == "zero-to-peak"
    assert said["i"]["speed"] == "0.1 m/s"


def test_strokes_go_to_and_fro_and_friction_against_them() -> None:
    same = [np.full(4, value) for value in (1e-6, 0.1, 0.5, 0.4)]
    made = recorded_strokes(PlannedStrokes(*same), np.random.default_rng(1), noise=1e-6)
    sliding = np.abs(made.tangential_force) > 0.19
    forth = np.sign(np.gradient(made.position, made.time)[sliding])
    assert made.tangential_force[sliding] == pytest.approx(-0.2 * forth, rel=1e-3)
    turns = np.flatnonzero(np.diff(forth))
    assert [*forth[turns], forth[-1]] == [-1, 1, -1, 1]
