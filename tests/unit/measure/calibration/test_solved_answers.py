"""Answers of a plate and a disc are those of the mode that was solved; tests of calibrations solve
real plates."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.calibration import solved_answers as room
from squeezefilm.measure.calibration.solved_answers import (
    MODE_FREQUENCY,
    PLATE_ANSWERS,
    Asked,
    solved_answers,
)
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.parts import assembly_mass
from squeezefilm.physics.plate.ring.body import ring_body
from squeezefilm.physics.plate.working_mode import working_mode

PLATE = load_display("biet2008-plate").actuator
DISC = load_display("winfield2007-tpad").actuator
FREQUENCY, QUALITY, STATIC, COUPLING = 30e3, 60.0, 5e-9, 0.3


def admittance(f: Any) -> Any:
    """Of a resonance over a capacitance, by its share of the body's free one."""
    motional = STATIC * COUPLING**2 / (1 - COUPLING**2)
    branch = motional / (1 - (f / FREQUENCY) ** 2 + 1j * f / FREQUENCY / QUALITY)
    return 2j * np.pi * f * (STATIC + branch)


def mode_of(**changes: Any) -> Any:
    """A solved mode."""
    known = np.linspace(0.5 * FREQUENCY, 2 * FREQUENCY, 41)

    def at(f: Any) -> Any:
        return SimpleNamespace(admittance=admittance(f))

    fields: dict[str, Any] = {
        "frequency": FREQUENCY,
        "frequency_error": 30.0,
        "index": 1,
        "quality_factor": QUALITY,
        "amplitude_per_volt": 2e-8,
        "amplitude_error": 1e-10,
        "half_wavelength": 8e-3,
        "modal_mass": 7e-3,
        "circuit": SimpleNamespace(static_capacitance=STATIC),
        "modes": SimpleNamespace(
            open_frequencies=np.array([1.0, FREQUENCY / math.sqrt(1 - COUPLING**2)]),
            couplings=np.array([0.9, COUPLING]),
            coupling_errors=np.array([0.5, 3e-3]),
        ),
        "response": SimpleNamespace(frequencies=known, at=at),
    }
    return SimpleNamespace(**{**fields, **changes})


def answers(
    mode: Any, asked: tuple[Asked, ...], monkeypatch: pytest.MonkeyPatch, folder: Path
) -> dict[Asked, tuple[float, float, float]]:
    monkeypatch.setenv("SQUEEZEFILM_CACHE", str(folder))
    monkeypatch.setattr(room, "solid_mode", lambda _: mode)
    found = solved_answers(PLATE, asked)
    return dict(zip(asked, zip(*map(np.ndarray.tolist, found), strict=True), strict=True))


ALL = tuple(Asked(name) for name in PLATE_ANSWERS)


def test_every_answer_of_a_plate_has_its_solvers_error_and_a_readers(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    alone = answers(mode_of(), ALL, monkeypatch, tmp_path / "alone")
    expected = {
        "resonance_frequency": (FREQUENCY, 1e-3),
        "parallel_resonance_frequency": (FREQUENCY / math.sqrt(1 - COUPLING**2), 1e-3),
        "coupling_coefficient": (COUPLING, 1e-2),
        "static_capacitance": (STATIC, 0.0),
        "quality_factor": (QUALITY, 0.0),
        "amplitude_per_volt": (2e-8, 5e-3),
        "half_wavelength": (8e-3, 0.0),
        "mass": (assembly_mass(PLATE), 0.0),
        "modal_mass": (7e-3, 0.0),
    }
    for name, (value, error) in expected.items():
        assert alone[Asked(name)][:2] == pytest.approx((value, error))
    # One circuit alone is read for what it is, but for the bench's noise.
    assert max(reading for *_, reading in alone.values()) < 0.02
    assert alone[Asked("parallel_resonance_frequency")][2] < 1e-3
    assert {name for name in PLATE_ANSWERS if alone[Asked(name)][2] == 0.0} >= {
        "mass",
        "modal_mass",
    }
    # What is kept is what was found: nothing is solved again.
    monkeypatch.setattr(room, "solid_mode", None)
    again = solved_answers(PLATE, ALL)
    np.testing.assert_array_equal(np.transpose(again), list(alone.values()))
    # A bench that reads 60 where 66 is true is a tenth off.
    other = answers(mode_of(quality_factor=66.0), ALL, monkeypatch, tmp_path / "other")
    assert other[Asked("quality_factor")][2] == pytest.approx(1 - 60 / 66, abs=0.02)


def test_a_plate_without_ceramic_has_no_circuit_to_read(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def zero(f: Any) -> Any:
        return SimpleNamespace(admittance=np.zeros(np.shape(f), complex))

    modes = SimpleNamespace(
        open_frequencies=np.array([1.0, FREQUENCY]),
        couplings=np.zeros(2),
        coupling_errors=np.zeros(2),
    )
    response = SimpleNamespace(frequencies=np.linspace(2e4, 4e4, 9), at=zero)
    mode = mode_of(circuit=None, modes=modes, response=response)
    found = answers(mode, ALL, monkeypatch, tmp_path)
    assert math.isnan(found[Asked("static_capacitance")][0])
    assert found[Asked("coupling_coefficient")] == (0.0, 0.0, 0.0)
    assert not any(reading for *_, reading in found.values())


def test_another_mode_is_found_by_its_lines_or_has_no_answer(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    lines = {(7, 0): 1, (9, 0): 0}

    class Modes:
        frequencies, errors = np.array([36e3, 24e3]), np.array([9.0, 12.0])

        def index(self, asked: tuple[int, int]) -> int:
            if asked not in lines:
                raise InputError("no mode has these lines")
            return lines[asked]

    solved: list[tuple[int, int]] = []

    def solve(_: Any, *, mode: tuple[int, int]) -> Modes:
        solved.append(mode)
        return Modes()

    monkeypatch.setattr(room, "solve_modes", solve)
    asked = tuple(Asked(MODE_FREQUENCY, mode) for mode in ((7, 0), (9, 0), (5, 5)))
    for _ in range(2):
        found = answers(mode_of(), asked, monkeypatch, tmp_path)
        assert found[asked[0]] == pytest.approx((24e3, 12 / 24e3, 0.0))
        assert found[asked[1]] == pytest.approx((36e3, 9 / 36e3, 0.0))
        assert math.isnan(found[asked[2]][0])
    assert solved == [(7, 0), (9, 0), (5, 5)]
    with pytest.raises(InputError, match="has no answer 'mode frequency"):
        solved_answers(DISC, asked[:1])
    with pytest.raises(InputError, match="a stator's answers are measured"):
        solved_answers(load_display("biet2008-stator").actuator, ALL)


def test_answers_of_a_disc_are_those_of_its_working_mode(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("SQUEEZEFILM_CACHE", str(tmp_path))
    mode = working_mode(DISC)
    found = solved_answers(DISC, ALL)
    values = dict(zip(PLATE_ANSWERS, found.values.tolist(), strict=True))
    for name in ("resonance_frequency", "quality_factor", "amplitude_per_volt", "half_wavelength"):
        assert values[name] == getattr(mode, name)
    assert values["mass"] == assembly_mass(DISC)
    assert values["modal_mass"] == mode.modal_mass
    square = 1 - (values["resonance_frequency"] / values["parallel_resonance_frequency"]) ** 2
    assert math.sqrt(square) == pytest.approx(values["coupling_coefficient"])
    assert 0.02 < values["coupling_coefficient"] < 0.5
    ring = ring_body(DISC)
    assert values["static_capacitance"] > room.clamped_capacitance(ring.section, ring.drive)
    errors = dict(zip(PLATE_ANSWERS, found.errors.tolist(), strict=True))
    assert errors["resonance_frequency"] == errors["parallel_resonance_frequency"]
    assert not np.any(found.readings)
