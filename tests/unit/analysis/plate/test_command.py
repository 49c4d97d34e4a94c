"""The analysis of a plate around modes and a response that are made up here."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.analysis.plate import command
from squeezefilm.analysis.plate.command import (
    analyze_plate,
    centre_profile,
    centre_scan,
    parse_band,
    parse_mode,
    scan_axis,
)
from squeezefilm.display import Display, load_display
from squeezefilm.errors import InputError
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.solid.layers import NORMAL, Resolution

LENGTH, WIDTH = 83e-3, 49e-3


def along(x: np.ndarray) -> np.ndarray:
    """Four nodal lines; the ends move three times as far as what is between the outer nodes."""
    edge = (x < LENGTH / 8) | (x > 7 * LENGTH / 8)
    return np.cos(4 * np.pi * x / LENGTH) * np.where(edge, 3.0, 1.0)


class Modes:
    """Three modes: (4,0), one in the plane, and (0,3) which nothing drives."""

    labels = ((4, 0), None, (0, 3))
    frequencies = np.array([30e3, 31e3, 32e3])
    errors = np.array([3.0, 4.0, 5.0])
    quality_factors = np.array([50.0, 60.0, 70.0])
    drive_forces = np.array([-0.2, 0.1, 0.0])
    couplings = np.array([0.15, 0.05, 0.0])
    coupling_errors = np.array([1e-3, 5e-4, 0.0])
    open_frequencies = np.array([1.0, 2.0, 3.0])
    open_errors = np.array([0.1, 0.2, 0.3])
    x, y = np.linspace(0, LENGTH, 201), np.linspace(0, WIDTH, 101)
    count = 3
    model, status = "solid", "fine"

    def __init__(self, band: Any) -> None:
        self.band = band
        across = np.cos(3 * np.pi * self.y / WIDTH)
        flat = np.ones(101)
        self.shapes = np.stack([
            np.outer(along(self.x), flat), np.zeros((201, 101)), np.outer(np.ones(201), across),
        ])  # fmt: skip

    def index(self, label: Any) -> int:
        return self.labels.index(label)

    resolution, coarseness = NORMAL, ""

    def half_wavelength(self, mode: int) -> float:
        return [20e-3, math.nan, 16e-3][mode]


class Response:
    """40 nm/V in the middle lobes and a quarter of a period behind, at the second frequency."""

    resonance = 1
    maximum = np.array([1e-8, 12e-8, 2e-8])

    def __init__(self, plate: RectangularPlate, frequencies: np.ndarray, circuit: bool) -> None:
        self.plate, self.frequencies, self.circuit = plate, frequencies, circuit

    def line(self, at: int, points: int) -> tuple[np.ndarray, np.ndarray]:
        x = np.linspace(0, LENGTH, points)
        return x, self.displacement(x, np.array([WIDTH / 2]))[at, :, 0]

    def displacement(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        w = -40e-9j * np.outer(along(x), 1 + y / WIDTH - 0.5)
        return np.stack([0 * w, w, 0.1 * w])

    def current(self, volts: float) -> np.ndarray:
        return volts * np.array([1.0, 2.0, 3.0])

    def apparent_power(self, volts: float) -> np.ndarray:
        return volts * np.array([4.0, 5.0, 6.0])

    def input_power(self, volts: float) -> np.ndarray:
        return volts * np.array([7.0, 8.0, 9.0])

    def equivalent_circuit(self) -> Any:
        if not self.circuit:
            raise InputError("no circuit")
        return {"R1": 1.0}


@pytest.fixture
def display() -> Display:
    return load_display("biet2008-plate")


@pytest.fixture
def parts(monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, Any]]:
    """What an analysis asks of its parts, by their names."""
    asked: dict[str, Any] = {"modes": [], "circuit": True}

    def solve(
        plate: RectangularPlate, *, mode: Any = None, band: Any = None, **hurry: Any
    ) -> Modes:
        assert hurry["deadline"] is None
        asked["modes"].append((plate, mode, band))
        return Modes(band)

    def working(
        plate: RectangularPlate, mode: Any, tolerance: float, tell: Any, deadline: Any
    ) -> tuple[Modes, list[str]]:
        return solve(plate, mode=mode, deadline=deadline, tolerance=tolerance), ["pieces"]

    def respond(
        plate: RectangularPlate,
        frequencies: np.ndarray,
        *,
        resolution: Resolution,
        solved: list[str],
        again: Callable[[], Response],
    ) -> Response:
        assert resolution == NORMAL
        assert solved == ["pieces"]
        assert callable(again)
        asked["sweep"] = frequencies
        return Response(plate, frequencies, asked["circuit"])

    def stand_in(name: str, answer: Any) -> None:
        def asked_for(*given: Any, **named: Any) -> Any:
            asked[name] = (given, named)
            return answer

        monkeypatch.setattr(command, name, asked_for)

    monkeypatch.setattr(command, "solve_modes", solve)
    monkeypatch.setattr(command, "solve_for_response", working)
    monkeypatch.setattr(command, "harmonic_response", respond)
    stand_in(
        "plate_sound",
        SimpleNamespace(distances=(0.3,), sound_pressure_level_dB=(70.0,), guidance=None),
    )
    stand_in(
        "beam_response",
        SimpleNamespace(mode=SimpleNamespace(frequency=33e3), amplitude_per_volt=9e-8),
    )
    stand_in("shear_mode", SimpleNamespace(frequency=30.3e3))
    # What is made up here must not answer for a solved plate, nor the other way round.
    command.solved_plate.cache_clear()
    yield asked
    command.solved_plate.cache_clear()


def test_an_analysis_is_around_the_mode_asked_for(display: Display, parts: dict[str, Any]) -> None:
    told: list[str] = []
    one = analyze_plate(display, mode=(4, 0), points=21, progress=told.append)
    plate = display.actuator
    assert parts["modes"] == [
        (plate, (4, 0), None), (plate, None, pytest.approx((0.92 * 30e3, 1.08 * 30e3))),
    ]  # fmt: skip
    # ±4/Q around it, densest in the middle.
    sweep = parts["sweep"]
    assert sweep[[0, 10, 20]] == pytest.approx([0.92 * 30e3, 30e3, 1.08 * 30e3])
    steps = np.diff(sweep)
    assert steps == pytest.approx(steps[::-1])
    assert np.all(np.diff(steps[10:]) > 0)
    assert steps[0] / steps[9] == pytest.approx(math.cosh(3), rel=0.2)
    assert one.amplitude_per_volt == 12e-8
    # Between the outer nodes: the ends move three times as far.
    assert one.centreline_per_volt == pytest.approx(40e-9, rel=1e-3)
    assert (one.beam_frequency, one.beam_amplitude_per_volt) == (33e3, 9e-8)
    assert parts["shear_mode"][0] == (plate, (4, 0), 30e3)
    assert parts["plate_sound"][0] == (one.response, one.response.resonance, 30e3, 15.0)
    assert told == [
        "mode (4,0)", "all modes in the band", "response at 21 frequencies", "airborne sound",
    ]  # fmt: skip
    said = one.summary()
    assert said["shear_plate"]["error_against_solid"] == pytest.approx(0.01)
    assert (said["current_A"], said["apparent_power_VA"], said["input_power_W"]) == (30, 75, 120)
    assert said["sound_pressure_level_dB"] == {"0.3 m": 70.0}
    assert said["beam"]["frequency_Hz"] == 33e3
    assert said["equivalent_circuit"] == {"R1": 1.0}


def test_a_plate_is_solved_once_for_all_voltages(display: Display, parts: dict[str, Any]) -> None:
    for volts in (5.0, 10.0):
        driven = dataclasses.replace(
            display, drive=dataclasses.replace(display.drive, voltage=volts)
        )
        analyze_plate(driven, mode=(4, 0), progress=lambda _: None)
        assert parts["plate_sound"][0][3] == volts
    assert len(parts["modes"]) == 2
    thicker = dataclasses.replace(display.actuator, thickness=2.1e-3)
    analyze_plate(dataclasses.replace(display, actuator=thicker), mode=(4, 0))
    assert len(parts["modes"]) == 4


def test_the_table_has_each_mode_of_the_band(display: Display, parts: dict[str, Any]) -> None:
    one = analyze_plate(display, mode=(4, 0), band=(25e3, 35e3))
    assert parts["modes"][1][2] == (25e3, 35e3)
    first, second, third = one.rows
    assert one.working == first
    assert [row.label for row in one.rows] == ["(4,0)", "in plane", "(0,3)"]
    assert [row.frequency for row in one.rows] == [30e3, 31e3, 32e3]
    assert [row.frequency_error for row in one.rows] == [3, 4, 5]
    assert [row.quality_factor for row in one.rows] == [50, 60, 70]
    assert [row.modal_force for row in one.rows] == [-0.2, 0.1, 0.0]
    assert [row.coupling_coefficient for row in one.rows] == [0.15, 0.05, 0.0]
    assert [row.half_wavelength for row in one.rows] == [20e-3, None, 16e-3]
    # Q F/ω² of unit modal mass, at the ends three times the lobes between.
    assert first.amplitude_per_volt == pytest.approx(50 * 0.2 * 3 / (2 * math.pi * 30e3) ** 2)
    assert second.amplitude_per_volt == third.amplitude_per_volt == 0
    assert parts["sweep"].size == 200


def test_what_has_no_circuit_and_no_shear_mode_goes_without(
    display: Display, parts: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(*_: Any) -> Any:
        raise InputError("no such mode")

    parts["circuit"] = False
    monkeypatch.setattr(command, "shear_mode", none)
    one = analyze_plate(display, mode=(4, 0))
    assert (one.circuit, one.shear_frequency) == (None, None)
    assert one.summary()["shear_plate"] is None


def test_a_sharp_mode_is_swept_over_a_per_cent(
    display: Display, parts: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Modes, "quality_factors", np.full(3, 4000.0))
    analyze_plate(display, mode=(4, 0))
    assert parts["sweep"][[0, -1]] == pytest.approx([0.99 * 30e3, 1.01 * 30e3])


def test_what_cannot_be_is_refused_before_anything_is_solved(
    display: Display, parts: dict[str, Any]
) -> None:
    plate: Any = display.actuator
    shorted = tuple(dataclasses.replace(p, electrode="shorted") for p in plate.patches)
    still = dataclasses.replace(display, actuator=dataclasses.replace(plate, patches=shorted))
    with pytest.raises(InputError, match="no electrode is driven"):
        analyze_plate(still)
    for band in ((35e3, 25e3), (25e3, 25e3)):
        with pytest.raises(InputError, match="is none"):
            analyze_plate(display, band=band)
    with pytest.raises(InputError, match="has a annular_stator and no rectangular plate"):
        analyze_plate(load_display("biet2008-stator"))
    assert parts["modes"] == []


def test_a_scan_runs_along_the_side_that_more_lines_cross() -> None:
    assert [scan_axis(label) for label in ((8, 0), (3, 3), (3, 4), (0, 1))] == [0, 0, 1, 1]
    plate: Any = SimpleNamespace(length=LENGTH, width=WIDTH)
    response: Any = Response(plate, np.zeros(3), True)
    x, w = centre_scan(response, 1, (4, 0), 11)
    assert x == pytest.approx(np.linspace(0, LENGTH, 11))
    assert w == pytest.approx(-40e-9j * along(x))
    y, w = centre_scan(response, 2, (0, 4), 11)
    assert y == pytest.approx(np.linspace(0, WIDTH, 11))
    # In the middle of the length, where the lobe is up.
    assert w == pytest.approx(-4e-9j * (0.5 + y / WIDTH))
    assert centre_scan(response, 1, (4, 0))[0].size == 201


def test_a_profile_is_that_of_the_side_that_is_scanned() -> None:
    modes: Any = Modes(None)
    at = np.linspace(0, LENGTH, 57)
    found = centre_profile(modes.shapes[0], modes, at, (4, 0))
    inside = np.abs(along(at)) < 0.99
    expected = np.cos(4 * np.pi * at / LENGTH) * np.where(
        (at < LENGTH / 8) | (at > 7 * LENGTH / 8), 3, 1
    )
    assert np.abs(found / found[0])[inside] == pytest.approx(
        np.abs(expected / expected[0])[inside], abs=2e-3
    )
    y = np.linspace(0, WIDTH, 31)
    across = centre_profile(modes.shapes[2], modes, y, (0, 3))
    assert np.abs(across / across[0]) == pytest.approx(
        np.abs(np.cos(3 * np.pi * y / WIDTH)), abs=2e-3
    )


def test_modes_and_bands_are_read_from_texts() -> None:
    for text in ("8,0", "(8,0)", " ( 8 , 0 ) ", "8, 0"):
        assert parse_mode(text) == (8, 0)
    assert parse_mode("0,12") == (0, 12)
    for text in ("8", "8,0,1", "8,-1", "a,0", "8.0,0", "", "8;0"):
        with pytest.raises(InputError, match="write nodal lines across length, width: 8,0"):
            parse_mode(text)
    with pytest.raises(InputError, match="--mode"):
        parse_mode("8,999999")
    assert parse_band("25 kHz:45 kHz") == (25e3, 45e3)
    assert parse_band(" 25 kHz : 0.045 MHz ") == pytest.approx((25e3, 45e3))
    for text in ("25 kHz", "1 kHz:2 kHz:3 kHz"):
        with pytest.raises(InputError, match="write two frequencies"):
            parse_band(text)
    for text in ("45 kHz:25 kHz", "25 kHz:25 kHz"):
        with pytest.raises(InputError, match="down to 25 kHz; write the lower frequency first"):
            parse_band(text)
