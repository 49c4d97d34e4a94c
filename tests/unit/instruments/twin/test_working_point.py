"""A twin's constants from a mode made by hand, with laws and solves replaced by formulas."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.instruments.twin import working_point as module
from squeezefilm.instruments.twin.settings import TwinAmplifier, TwinSettings
from squeezefilm.instruments.twin.working_point import FORCES, POINTS, WorkingPoint, working_point
from squeezefilm.physics.chain.friction import TABLE_SPEEDS
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.working_mode import WorkingMode

SETTINGS = TwinSettings()
MODE = WorkingMode(
    label="by hand", resonance_frequency=40e3, half_wavelength=8e-3, quality_factor=60.0,
    amplitude_per_volt=2e-8, model="by hand", lobe=(0.0, 0.0), modal_mass=3e-3,
)  # fmt: skip
STATOR, PLATE = load_display("biet2008-stator"), load_display("biet2008-plate")


class Laws:
    """Friction that falls with amplitude over force and may rise with speed; it holds up to an
    amplitude."""

    def __init__(self, reach: float = math.inf, timed: bool = True) -> None:
        self.reach, self.asked, self.tried, self.timed = reach, [], 0, timed

    def friction_law(self, display: Any, half: float, frequency: float, **how: Any) -> Any:
        self.asked.append((half, frequency, how))
        force = how.get("normal_force")

        def curve(amplitude: Any) -> Any:
            if force == FORCES[0]:
                self.tried += 1
            if amplitude[-1] > self.reach:
                raise OutOfRangeError("the gap closes")
            return 1 / (1 + 1e6 * amplitude / force)

        def over_speeds(amplitude: Any, speed: Any) -> Any:
            return (
                curve(amplitude) * (1 - np.exp(-speed / 0.1))[:, None]
                if self.timed
                else (np.repeat(curve(amplitude)[None, :], speed.size, axis=0))
            )

        kind = SimpleNamespace(fitted=self.timed)
        return SimpleNamespace(over_speeds=over_speeds, force=force, kind=kind, place="a place")


@pytest.fixture
def laws(monkeypatch: pytest.MonkeyPatch) -> Laws:
    return use(monkeypatch, Laws())


def use(monkeypatch: pytest.MonkeyPatch, laws: Laws) -> Laws:
    monkeypatch.setattr(module, "friction_law", laws.friction_law)
    monkeypatch.setattr(module, "at_best_place", lambda display, mode, law: law)
    monkeypatch.setattr(
        module, "load_ratios", lambda mode, law, amplitude: (1 + 2j) * law.force * (1 + amplitude)
    )
    return laws


def test_the_tables_hold_law_and_load_over_force_and_amplitude(laws: Laws) -> None:
    settings = dataclasses.replace(SETTINGS, highest_amplitude_ratio=1.5)
    found = working_point(STATOR, settings, MODE)
    highest = 2e-8 * STATOR.drive.voltage * 1.5
    assert found.highest_amplitude == pytest.approx(highest)
    amplitudes = highest * (np.arange(POINTS) / (POINTS - 1)) ** 2
    np.testing.assert_allclose(found.amplitudes, amplitudes, rtol=1e-12)
    np.testing.assert_array_equal(found.forces, FORCES)
    friction = 1 / (1 + 1e6 * amplitudes[None, :] / FORCES[:, None])
    np.testing.assert_array_equal(found.speeds, TABLE_SPEEDS)
    rise = 1 - np.exp(-TABLE_SPEEDS / 0.1)
    expected = rise[None, :, None] * friction[:, None, :]
    np.testing.assert_allclose(found.relative_friction, expected, rtol=1e-12)
    load = (1 + 2j) * FORCES[:, None] * (1 + amplitudes[None, :])
    np.testing.assert_allclose(found.load, load, rtol=1e-12)
    assert found.relative_friction.flags["C_CONTIGUOUS"]
    assert found.load.flags["C_CONTIGUOUS"]
    assert found.display is STATOR
    assert found.mode is MODE
    # Where the pad lies as described, it lies under every force.
    assert laws.asked == [(8e-3, 40e3, {})] + [
        (8e-3, 40e3, {"normal_force": float(one), "place": "a place"}) for one in FORCES
    ]


def test_a_law_that_knows_no_speed_has_a_table_of_one(monkeypatch: pytest.MonkeyPatch) -> None:
    use(monkeypatch, Laws(timed=False))
    found = working_point(STATOR, SETTINGS, MODE)
    np.testing.assert_array_equal(found.speeds, [0.0])
    friction = 1 / (1 + 1e6 * found.amplitudes[None, :] / FORCES[:, None])
    np.testing.assert_allclose(found.relative_friction[:, 0], friction, rtol=1e-12)
    assert found.relative_friction.shape == (FORCES.size, 1, POINTS)


def test_tables_end_where_the_gap_closes(monkeypatch: pytest.MonkeyPatch) -> None:
    full = 2e-8 * STATOR.drive.voltage * SETTINGS.highest_amplitude_ratio
    laws = use(monkeypatch, Laws(reach=0.4 * full))
    found = working_point(STATOR, SETTINGS, MODE)
    # 0.7 and 0.49 are too much, 0.343 is not.
    assert found.highest_amplitude == pytest.approx(0.343 * full)
    assert laws.tried == 4
    assert found.amplitudes[-1] == pytest.approx(0.343 * full)
    never = use(monkeypatch, Laws(reach=0.0))
    with pytest.raises(OutOfRangeError, match="no friction law could be tabulated for 'biet2008-"):
        working_point(STATOR, SETTINGS, MODE)
    assert never.tried == 12


def test_the_force_factor_makes_the_amplitude_that_the_mode_has(laws: Laws) -> None:
    found = working_point(STATOR, SETTINGS, MODE)
    omega = 2 * math.pi * 40e3
    # At resonance the amplitude per volt is φ Q/(m ω²).
    assert found.force_factor * 60.0 / (3e-3 * omega**2) == pytest.approx(2e-8)
    assert found.capacitance == pytest.approx(20e-9)
    assert found.evidence == ("capacitance assumed: 20 nF",)


def test_without_a_modal_mass_it_is_that_of_a_coupling_coefficient(laws: Laws) -> None:
    mode = dataclasses.replace(MODE, modal_mass=None)
    amplifier = TwinAmplifier(capacitance=50e-9)
    found = working_point(STATOR, dataclasses.replace(SETTINGS, amplifier=amplifier), mode)
    assert found.capacitance == 50e-9
    # The motional branch at resonance: charge per volt φ a = C_m Q, and k² = C_m/(C + C_m).
    motional = found.force_factor * 2e-8 / 60.0
    assert motional / (50e-9 + motional) == pytest.approx(0.1**2)
    (line,) = found.evidence
    assert line.startswith("modal mass not known: the finger takes nothing")
    assert "coefficient of 0.1" in line


def test_a_plates_capacitance_is_that_of_its_patches(
    laws: Laws, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "patch_capacitance", lambda plate: 33e-9)
    found = working_point(PLATE, SETTINGS, MODE)
    assert (found.capacitance, found.evidence) == (33e-9, ())
    amplifier = TwinAmplifier(capacitance=50e-9)
    told = working_point(PLATE, dataclasses.replace(SETTINGS, amplifier=amplifier), MODE)
    assert told.capacitance == 50e-9


def test_what_speaks_against_the_mode_is_evidence(
    laws: Laws, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []

    def chosen(actuator: Any) -> tuple[WorkingMode, tuple[str, ...]]:
        asked.append(actuator)
        return MODE, ("a beam's",)

    monkeypatch.setattr(module, "chosen_mode", chosen)
    monkeypatch.setattr(module, "require_plausible", lambda display: ("a doubt",))
    monkeypatch.setattr(module, "patch_capacitance", lambda plate: 33e-9)
    found = working_point(PLATE, SETTINGS)
    assert found.mode is MODE
    assert asked == [PLATE.actuator]
    assert found.evidence == ("a doubt", "a beam's")


def without_drive(display: Display) -> Display:
    return dataclasses.replace(display, drive=dataclasses.replace(display.drive, voltage=0.0))


def test_what_does_not_vibrate_is_no_twin(laws: Laws) -> None:
    still = dataclasses.replace(MODE, amplitude_per_volt=0.0)
    for display, mode in ((STATOR, still), (without_drive(STATOR), MODE)):
        with pytest.raises(InputError, match=r"has no amplitude at .* V; a twin"):
            working_point(display, SETTINGS, mode)
    assert laws.asked == []


def test_a_sweep_would_identify_the_plate_with_its_amplifier_and_pickup() -> None:
    """Twice the gain, twice the reading per volt; the mode's own frequency and Q."""
    point: Any = SimpleNamespace(mode=MODE, pickup_calibration=lambda pickup: 5e-6)
    plain = TwinSettings(amplifier=TwinAmplifier(gain=1.0))
    found = WorkingPoint.identified(point, plain)
    assert (found.frequency, found.quality_factor) == (40e3, 60.0)
    assert found.ratio == pytest.approx(2e-8 / 5e-6)
    twice = WorkingPoint.identified(point, TwinSettings(amplifier=TwinAmplifier(gain=2.0)))
    assert twice.ratio == pytest.approx(2 * found.ratio)
