"""The analysis of a plate around modes and a response that are made up here."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.plate import command
from squeezefilm.design.plate.command import PlateAnalysis, parse_band, parse_mode, solve_plate
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate import working_mode
from squeezefilm.physics.plate.circuit import EquivalentCircuit
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.layers import NORMAL
from squeezefilm.physics.plate.solid.working import response_frequencies

LENGTH, WIDTH = 83e-3, 49e-3
CIRCUIT = EquivalentCircuit(30e3, 50.0, 5e-9, 150.0, 40e-3, 0.7e-9)


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

    def nodal_positions(self, mode: int) -> Any:
        return np.array([[0.0, 20e-3], [], [0.0, 16e-3]][mode])


class Response:
    """Of 3 + 4i mS at all frequencies."""

    def __init__(self, frequencies: np.ndarray) -> None:
        self.frequencies = frequencies
        self.admittance = np.full(frequencies.size, 3e-3 + 4e-3j)

    def at(self, frequencies: np.ndarray) -> Response:
        """The same at others."""
        assert self.frequencies[0] <= frequencies[0]
        assert frequencies[-1] <= self.frequencies[-1]
        return Response(frequencies)


def solid(plate: RectangularPlate, label: Any) -> Any:
    """The solved mode (4,0), which answers most at 30.0 kHz."""
    modes: Any = Modes(None)
    frequencies = response_frequencies(30e3, 50.0, 201)
    return SimpleNamespace(
        modes=modes, index=0, frequency=30e3, frequency_error=3.0, quality_factor=50.0,
        half_wavelength=20e-3, amplitude_per_volt=40e-9, largest_per_volt=120e-9,
        alone_per_volt=39e-9, modal_mass=None, lobe=(41e-3, 24e-3), model="solid",
        position=modes.x, deflection=along(modes.x), neighbour=None,
        response=Response(frequencies), resonance=100, circuit=CIRCUIT, circuit_said="well",
        radiating=lambda volts, frequency: (volts, frequency),
    )  # fmt: skip


def solved_plate(display: Display, **asked: Any) -> PlateAnalysis:
    """The analysis of a rectangular plate."""
    result = solve_plate(display, **asked)
    assert isinstance(result, PlateAnalysis)
    return result


@pytest.fixture
def display() -> Display:
    return load_display("biet2008-plate")


@pytest.fixture
def parts(monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, Any]]:
    """What an analysis asks of its parts, by their names."""
    asked: dict[str, Any] = {"modes": [], "solid": []}

    def solve(plate: RectangularPlate, *, band: Any, **hurry: Any) -> Modes:
        assert hurry["deadline"] is None
        asked["modes"].append((plate, band))
        return Modes(band)

    def solved(plate: RectangularPlate, label: Any, *, pace: Any) -> Any:
        assert pace.budget is None
        asked["solid"].append((plate, label))
        return solid(plate, label)

    def stand_in(name: str, answer: Any) -> None:
        def asked_for(*given: Any, **named: Any) -> Any:
            asked[name] = (given, named)
            return answer

        monkeypatch.setattr(command, name, asked_for)

    monkeypatch.setattr(command, "solve_modes", solve)
    monkeypatch.setattr(command, "solid_mode", solved)
    stand_in(
        "sound_field",
        SimpleNamespace(distances=(0.3,), sound_pressure_level_dB=(70.0,), guidance=None),
    )
    beam = SimpleNamespace(
        mode=SimpleNamespace(frequency=33e3), amplitude_per_volt=9e-8, model="a beam"
    )
    monkeypatch.setattr(working_mode, "beam_response", lambda plate: beam)
    # What is made up here must not answer for a solved plate, nor the other way round.
    command.solved_plate.cache_clear()
    yield asked
    command.solved_plate.cache_clear()


def test_an_analysis_is_around_the_mode_asked_for(display: Display, parts: dict[str, Any]) -> None:
    told: list[str] = []
    one = solved_plate(display, mode=(4, 0), points=21, progress=told.append)
    plate = display.actuator
    assert parts["solid"] == [(plate, (4, 0))]
    assert parts["modes"] == [(plate, pytest.approx((0.92 * 30e3, 1.08 * 30e3)))]
    # So many frequencies around the mode, and the one at which it answers most among them.
    assert one.response.frequencies.size == 21
    assert one.response.frequencies[one.resonance] == 30e3
    # Free amplitudes are those of the mode as every other verb has it.
    assert (one.amplitude_per_volt, one.largest_per_volt) == (40e-9, 120e-9)
    assert (one.mode.lobe, one.working.alone_per_volt) == ((41e-3, 24e-3), 39e-9)
    assert parts["sound_field"][0] == ((15.0, 30e3),)
    assert told == [
        "mode (4,0) and its response", "all modes in the band", "airborne sound",
    ]  # fmt: skip
    said = one.summary()
    assert (said["current_A"], said["apparent_power_VA"], said["input_power_W"]) == (
        pytest.approx((75e-3, 0.5625, 0.3375))
    )
    assert said["sound_pressure_level_dB"] == {"0.3 m": 70.0}
    assert said["beam"] == {"model": "a beam", "frequency_Hz": 33e3, "amplitude_m_per_V": 9e-8}
    assert said["equivalent_circuit"]["static_capacitance_F"] == 5e-9
    assert said["equivalent_circuit_said"] == "well"
    assert said["amplitude_per_volt_m_per_V"] == 40e-9
    assert said["largest_per_volt_m_per_V"] == 120e-9


def test_a_plate_is_solved_once_for_all_voltages(display: Display, parts: dict[str, Any]) -> None:
    for volts in (5.0, 10.0):
        driven = dataclasses.replace(
            display, drive=dataclasses.replace(display.drive, voltage=volts)
        )
        solved_plate(driven, mode=(4, 0), progress=lambda _: None)
        assert parts["sound_field"][0][0][0] == volts
    assert len(parts["modes"]) == 1
    thicker = dataclasses.replace(display.actuator, thickness=2.1e-3)
    solved_plate(dataclasses.replace(display, actuator=thicker), mode=(4, 0))
    assert len(parts["modes"]) == 2


def test_the_table_has_each_mode_of_the_band(display: Display, parts: dict[str, Any]) -> None:
    one = solved_plate(display, mode=(4, 0), band=(25e3, 35e3))
    assert parts["modes"][0][1] == (25e3, 35e3)
    first, second, third = one.rows
    assert [row.label for row in one.rows] == ["(4,0)", "in plane", "(0,3)"]
    assert [row.frequency for row in one.rows] == [30e3, 31e3, 32e3]
    assert [row.frequency_error for row in one.rows] == [3, 4, 5]
    assert [row.quality_factor for row in one.rows] == [50, 60, 70]
    assert [row.modal_force for row in one.rows] == [-0.2, 0.1, 0.0]
    assert [row.coupling_coefficient for row in one.rows] == [0.15, 0.05, 0.0]
    assert [row.half_wavelength for row in one.rows] == [20e-3, None, 16e-3]
    # Q F/ω² of unit modal mass, at the lobes.
    lobes = 50 * 0.2 / (2 * math.pi * 30e3) ** 2
    assert first.alone_per_volt == pytest.approx(lobes)
    assert second.alone_per_volt == third.alone_per_volt == 0
    # By default about as many frequencies as the response was solved at, its resonance among them.
    assert one.response.frequencies.size in (200, 201)


def test_what_cannot_be_is_refused_before_anything_is_solved(
    display: Display, parts: dict[str, Any]
) -> None:
    plate: Any = display.actuator
    shorted = tuple(dataclasses.replace(p, electrode="shorted") for p in plate.patches)
    still = dataclasses.replace(display, actuator=dataclasses.replace(plate, patches=shorted))
    with pytest.raises(InputError, match="no electrode is driven"):
        solved_plate(still)
    for band in ((35e3, 25e3), (25e3, 25e3)):
        with pytest.raises(InputError, match="is none"):
            solved_plate(display, band=band)
    assert parts["modes"] == []


def test_modes_and_bands_are_read_from_texts() -> None:
    for text in ("8,0", "(8,0)", " ( 8 , 0 ) ", "8, 0"):
        assert parse_mode(text) == (8, 0)
    assert parse_mode("0,12") == (0, 12)
    for text in ("8", "8,0,1", "8,-1", "a,0", "8.0,0", "", "8;0"):
        with pytest.raises(InputError, match="write nodal lines across length, width: 8,0"):
            parse_mode(text)
    with pytest.raises(InputError, match="mode"):
        parse_mode("8,999999")
    assert parse_band("25 kHz:45 kHz") == (25e3, 45e3)
    assert parse_band(" 25 kHz : 0.045 MHz ") == pytest.approx((25e3, 45e3))
    for text in ("25 kHz", "1 kHz:2 kHz:3 kHz"):
        with pytest.raises(InputError, match="write two frequencies"):
            parse_band(text)
    for text in ("45 kHz:25 kHz", "25 kHz:25 kHz"):
        with pytest.raises(InputError, match="down to 25 kHz; write the lower frequency first"):
            parse_band(text)
