"""The analysis of a disc or a stator around a body whose modes are made up here."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any
from unittest import mock

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, OutOfTimeError
from squeezefilm.core.progress import Pace
from squeezefilm.design.plate import ring, ring_pair
from squeezefilm.design.plate.ring import RingAnalysis, analyze_ring, mode_row, modes_in_band
from squeezefilm.design.plate.solved import ALONE, ModeRow, Remarks
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.circuit import EquivalentCircuit
from squeezefilm.physics.plate.ring.body import (
    RingBody,
    RingResponse,
    StatorAssumptions,
    ring_body,
    ring_response,
)
from squeezefilm.physics.plate.ring.modes import DEFAULT_DEGREE, AnnularMode
from squeezefilm.physics.plate.ring.section import SectorDrive
from squeezefilm.physics.plate.sound import ring_surface, sound_field

RADIUS = np.linspace(10e-3, 30e-3, 5)
ALL_ROUND = SectorDrive(((0.0, 2 * math.pi, 1),))
TURNS = SectorDrive(tuple((n * math.pi / 2, (n + 1) * math.pi / 2, 1 - 2 * (n % 2))
                          for n in range(4)))  # fmt: skip
CIRCUIT = EquivalentCircuit(40e3, 100.0, 2e-9, 150.0, 60e-3, 0.26e-9)


def mode(frequency: float = 40e3, harmonic: int = 2, **changes: Any) -> AnnularMode:
    """4 mN per volt and radian on 2 g; crossed by a circle at 15 mm."""
    values: dict[str, Any] = {
        "harmonic": harmonic, "label": f"B(1,{harmonic})", "frequency": frequency,
        "frequency_error": 4.0, "quality_factor": 100.0, "modal_mass": 2e-3,
        "modal_force_all_round": 4e-3, "half_wavelength": 31e-3 if harmonic else None,
        "axial_share": 1.0, "node_radius": RADIUS,
        "node_height": np.zeros(5), "displacement": np.zeros((5, 3)), "surface_radius": RADIUS,
        "surface_shape": np.linspace(-1 / 3, 1, 5), "model": "a-model",
    }  # fmt: skip
    return AnnularMode(**{**values, **changes})


def body(working: AnnularMode | None = None, **changes: Any) -> Any:
    own = working or mode()
    parts: dict[str, Any] = {
        "section": SimpleNamespace(surface_radii=(10e-3, 30e-3), shear_times={"brass": 1e-6}),
        "label": (1, own.harmonic),
        "drive": TURNS if own.harmonic else ALL_ROUND, "quality_factor": 100.0, "fit": None,
        "mode": lambda label: {(1, own.harmonic): own, (0, 3): mode(50e3, 3)}[label],
    }  # fmt: skip
    made: Any = SimpleNamespace(**{**parts, **changes})
    made.drives = lambda mode: RingBody.drives(made, mode)
    return made


def swept(motion: np.ndarray, resonance: int = 1) -> RingResponse:
    gain = np.where(np.arange(3) == resonance, 1.0, 0.3)
    return RingResponse(
        np.array([39e3, 40e3, 41e3]), np.linspace(10e-3, 30e-3, motion.size),
        np.outer(gain, motion), np.array([1e-3, 6e-3 + 8e-3j, 2e-3]), (2,), 6,
    )  # fmt: skip


# u_z per volt at 10, 15, 20, 25 and 30 mm, some degrees behind the volt.
MOTION = 1e-8 * np.exp(0.7j) * np.array([-4.0, 0.0, 2.0, 3.0, 6.0])


# What every verb has of the mode: 60 nm per volt at its antinode.
WORKING: Any = SimpleNamespace(
    amplitude_per_volt=6e-8, resonance_frequency=40e3, quality_factor=100.0, modal_mass=None,
    neighbour=None, lobe=(30e-3, 0.0),
)  # fmt: skip


def found(working: AnnularMode | None = None, motion: np.ndarray = MOTION, **changes: Any) -> Any:
    own = working or mode()
    row = ModeRow("B(1,2)", 40e3, 4.0, 100.0, 2e-8, 0.2, 0.1, 31e-3)
    parts: dict[str, Any] = {
        "resonance": 1, "largest_per_volt": 6e-8, "circuit_said": "", "model": "a-model",
        "status": "2 modes", "remarks": Remarks("", "", "", ""),
        "display": load_display("winfield2007-tpad"), "body": body(own), "modes": (own,),
        "rows": (row, dataclasses.replace(row, frequency=42e3, frequency_error=8.4)),
        "annular": own, "mode": WORKING,
        "working": row, "half_wavelength_along": "circumference", "circles": np.array([15e-3]),
        "response": swept(motion), "circuit": CIRCUIT,
        "sound": SimpleNamespace(
            distances=(0.3, 1.0), sound_pressure_level_dB=(70.0, 60.0), guidance=None
        ),
    }  # fmt: skip
    return RingAnalysis(**{**parts, **changes})


def test_only_a_stator_has_a_computed_amplitude_beside_its_own() -> None:
    """At an antinode of the mean circumference, where it was measured."""
    assert found().computed_per_volt is None
    stator = found(display=load_display("biet2008-stator"))
    assert stator.scan_radius == pytest.approx(20e-3)
    assert stator.computed_per_volt == pytest.approx(2e-8)


FIT = SimpleNamespace(
    ring_thickness=3.1e-3, mode=mode(40.5e3), assumptions=StatorAssumptions(),
    frequency_bounds=(39e3, 43e3),
)  # fmt: skip


def test_a_summary_has_every_number_under_its_name() -> None:
    one = found()
    said = one.summary()
    assert said.pop("provenance")["config_sha256"]
    rows = said.pop("modes")
    assert [row["frequency_Hz"] for row in rows] == [40e3, 42e3]
    assert rows == one._table()
    circuit = said.pop("equivalent_circuit")
    assert circuit["quality_factor"] == 100.0
    heat = said.pop("heat")
    assert heat["cold_power_W"] == pytest.approx(1.2)
    assert heat["cold_amplitude_m"] == pytest.approx(20 * 6e-8)
    assert heat["tracked"]["temperature_rise_K"] > heat["fixed"]["temperature_rise_K"] > 0
    # At the display's 20 V: |6 + 8i| mS are 10 mS.
    assert said == {
        "display": "winfield2007-tpad", "mode": "B(1,2)", "frequency_Hz": 40e3,
        "frequency_error_Hz": 4.0, "amplitude_per_volt_m_per_V": pytest.approx(6e-8),
        "largest_per_volt_m_per_V": pytest.approx(6e-8), "alone_per_volt_m_per_V": 2e-8,
        "neighbour": None, "equivalent_circuit_said": "", "half_wavelength_m": 31e-3,
        "half_wavelength_along": "circumference", "nodal_circles_m": [15e-3],
        "quality_factor": 100.0, "coupling_coefficient": 0.2, "voltage_V": 20.0,
        "coupling_coefficient_error": None, "parallel_resonance_frequency_Hz": None,
        "parallel_resonance_frequency_error_Hz": None,
        "current_A": pytest.approx(0.2), "apparent_power_VA": pytest.approx(2.0),
        "input_power_W": pytest.approx(1.2), "computed_per_volt_m_per_V": None, "fit": None,
        "sound_pressure_level_dB": {"0.3 m": 70.0, "1 m": 60.0}, "sound_guidance": None,
        "model": "a-model", "status": one.status, "objections": [],
    }  # fmt: skip


def test_a_fit_is_said_with_its_bounds() -> None:
    fit = found(body=body(fit=FIT)).summary()["fit"]
    assert fit.pop("assumed")["driven_sectors"] == StatorAssumptions.driven_sectors
    assert fit == {
        "ring_thickness_m": 3.1e-3,
        "fitted_to": {"frequency_Hz": 40.5e3, "half_wavelength_m": 31e-3},
        "frequency_with_soft_and_stiff_teeth_Hz": [39e3, 43e3],
    }  # fmt: skip


def test_a_row_is_a_mode_under_its_drive() -> None:
    """Four sectors in turn drive cos 2θ by 4: 16 mN/V on 2 g."""
    row = mode_row(body(), mode(surface_shape=np.array([0.1, -0.5, 0.2, 0.0, 0.3])), 1e-9)
    stiffness = (2 * math.pi * 40e3) ** 2 * 2e-3
    assert (row.label, row.frequency, row.frequency_error) == ("B(1,2)", 40e3, 4.0)
    assert row.quality_factor == 100.0
    # Half as far as the highest antinode of a mode that is scaled to 1.
    assert row.alone_per_volt == pytest.approx(0.5 * 100 * 16e-3 / stiffness)
    assert row.modal_force == pytest.approx(16e-3 / math.sqrt(2e-3))
    assert row.coupling_coefficient == pytest.approx(16e-3 / math.sqrt(16e-3**2 + stiffness * 1e-9))
    assert row.parallel_resonance_frequency == pytest.approx(
        40e3 * math.sqrt(1 + 16e-3**2 / (stiffness * 1e-9))
    )
    assert row.half_wavelength == 31e-3


class Harmonics:
    """The modes of each harmonic, of which the nearest are given as `annular_modes` does."""

    def __init__(self, every: dict[int, list[AnnularMode]], quality: float = 100.0) -> None:
        self.every, self.quality = every, quality
        self.asked: list[tuple[int, float, int]] = []

    def __call__(
        self,
        section: Any,
        harmonic: int,
        *,
        near: float,
        count: int,
        degree: int,
        quality_factor: float,
    ) -> list[AnnularMode]:
        assert degree == DEFAULT_DEGREE
        assert section.surface_radii == (10e-3, 30e-3)
        assert quality_factor == self.quality
        self.asked.append((harmonic, near, count))
        own = self.every.get(harmonic, [mode(99e3, harmonic)] * 9)
        nearest = sorted(own, key=lambda one: abs(one.frequency - near))[:count]
        return sorted(nearest, key=lambda one: one.frequency)


def test_a_band_has_every_elastic_mode_of_every_harmonic(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten of one harmonic take more than the nearest four; those on the edges belong to it."""
    many = [mode(30e3 + 2e3 * n, 0) for n in range(11)]
    rigid = mode(35e3, 1, label="rigid")
    harmonics = Harmonics(
        {
            0: [mode(10e3, 0), *many, mode(60e3, 0)],
            1: [rigid, *(mode(1e3 * f, 1) for f in (29, 41, 55, 70, 80))],
            # All above the band, but not beyond the diameters of the working mode.
            2: [mode(1e3 * f, 2) for f in (51, 60, 70, 80)],
            3: [mode(1e3 * f, 3) for f in (33, 60, 70, 80)],
            4: [mode(1e3 * f, 4) for f in (50.1, 60, 70, 80)],
            5: [mode(40e3, 5)] * 9,
        }
    )
    monkeypatch.setattr(ring, "annular_modes", harmonics)
    told: list[str] = []
    found = modes_in_band(body(), (30e3, 50e3), told.append)
    expected = sorted([(30e3 + 2e3 * n, 0) for n in range(11)] + [(41e3, 1), (33e3, 3)])
    assert [(one.frequency, one.harmonic) for one in found] == expected
    assert told == [f"all modes in the band, {m} nodal diameters" for m in range(5)]
    assert [(m, count) for m, _, count in harmonics.asked] == [
        (0, 4), (0, 8), (0, 16), (1, 4), (2, 4), (3, 4), (4, 4),
    ]  # fmt: skip
    assert {near for _, near, _ in harmonics.asked} == {40e3}


def test_a_band_with_nothing_in_it_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ring, "annular_modes", Harmonics({}))
    with pytest.raises(InputError, match="no mode lies between 30 kHz and 50 kHz; widen"):
        modes_in_band(body(), (30e3, 50e3))


def test_a_band_with_too_many_is_refused_and_an_end_is_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    thousand = [mode(30e3 + n, 0) for n in range(1000)]
    monkeypatch.setattr(ring, "annular_modes", Harmonics({0: thousand}))
    with pytest.raises(InputError, match="narrower band"):
        modes_in_band(body(), (30e3, 50e3))
    # Where every harmonic has a mode in the band, sixty are tried.
    harmonics = Harmonics({m: [mode(40e3, m), mode(60e3, m)] for m in range(200)})
    monkeypatch.setattr(ring, "annular_modes", harmonics)
    assert len(modes_in_band(body(), (30e3, 50e3))) == 60


@pytest.fixture
def parts(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What an analysis asks of its parts, by their names; `body` is what is solved."""
    asked: dict[str, Any] = {"body": body()}

    def stand_in(name: str, answer: Any) -> None:
        def asked_for(*given: Any) -> Any:
            asked[name] = given
            return answer

        monkeypatch.setattr(ring, name, asked_for)

    monkeypatch.setattr(ring, "ring_body", lambda actuator: asked["body"])
    monkeypatch.setattr(
        ring, "modes_in_band",
        lambda *given: asked.update(band=given[1]) or (mode(39e3, 0), mode(40e3), mode(41e3, 5)),
    )  # fmt: skip
    stand_in("ring_response", swept(MOTION))
    stand_in("ring_circuit", CIRCUIT)
    stand_in("static_capacitance", 1e-9)
    stand_in("ring_surface", "a surface")
    stand_in("sound_field", "a sound")
    return asked


def disc() -> Any:
    return load_display("winfield2007-tpad")


def test_an_analysis_is_around_the_working_mode(parts: dict[str, Any]) -> None:
    told: list[str] = []
    display = disc()
    one = analyze_ring(display, points=20, progress=told.append)
    own = parts["body"].mode((1, 2))
    assert one.annular is own
    assert one.mode.disc is own
    assert (one.display, one.body, one.sound) == (display, parts["body"], "a sound")
    assert parts["band"] == pytest.approx((0.92 * 40e3, 1.08 * 40e3))
    solved, around, sweep, harmonics = parts["ring_response"]
    assert (solved, around) == (parts["body"], own)
    # An odd number of frequencies, so that one is the mode's own; ±4/Q, densest in the middle.
    assert sweep.size == 21
    assert sweep[[0, 10, 20]] == pytest.approx([0.96 * 40e3, 40e3, 1.04 * 40e3])
    steps = np.diff(sweep)
    assert steps == pytest.approx(steps[::-1])
    assert np.all(np.diff(steps[10:]) > 0)
    assert steps[0] / steps[9] == pytest.approx(math.cosh(3), rel=0.2)
    # The mode's own harmonic, those beside it, and those of the band's modes.
    assert harmonics == [0, 1, 2, 3, 5]
    assert one.circuit is CIRCUIT
    assert parts["ring_circuit"] == (parts["body"], own, one.response)
    assert parts["static_capacitance"] == (parts["body"], CIRCUIT)
    assert [row.label for row in one.rows] == ["B(1,0)", "B(1,2)", "B(1,5)"]
    assert one.working == mode_row(parts["body"], own, 1e-9)
    assert (one.model, one.remarks.quality) == ("a-model", "of the assembly, as described")
    assert one.status == "3 modes in the band, within 1.0e-04 (estimated)"
    # At whatever frequency the face moves most.
    assert one.resonance == one.response.resonance == 1
    assert one.largest_per_volt == pytest.approx(6e-8)
    assert one.amplitude_per_volt == one.mode.amplitude_per_volt
    assert one.circles == pytest.approx([15e-3])
    assert one.half_wavelength_along == "circumference"
    # What sounds is the velocity at the display's 20 V.
    radius, velocity, harmonic, frequency = parts["ring_surface"]
    assert radius == pytest.approx(one.response.radius[[0, 4]])
    assert velocity == pytest.approx(2j * math.pi * 40e3 * 20 * MOTION[[0, 4]])
    assert (harmonic, frequency) == (2, 40e3)
    assert parts["sound_field"] == ("a surface",)
    assert told == ["section", "mode B(1,2)", "response at 20 frequencies", "airborne sound"]


def test_another_mode_and_band_can_be_asked_for(parts: dict[str, Any]) -> None:
    one = analyze_ring(disc(), mode=(0, 3), band=(20e3, 60e3))
    assert (one.annular.frequency, one.annular.harmonic) == (50e3, 3)
    assert parts["band"] == (20e3, 60e3)
    assert parts["ring_response"][2].size == 201
    # Four sectors in turn do not drive cos 3θ: there is no circuit.
    assert one.circuit is None
    assert one.circuit_said == "none: the channel does not drive this mode"
    assert parts["static_capacitance"] == (parts["body"], None)
    for band in ((50e3, 40e3), (-1.0, 40e3)):
        with pytest.raises(InputError, match="band"):
            analyze_ring(disc(), band=band)


def test_a_sharp_mode_without_diameters_has_no_neighbours(parts: dict[str, Any]) -> None:
    umbrella = mode(harmonic=0, quality_factor=5000.0)
    parts["body"] = body(umbrella)
    analyze_ring(disc())
    _, _, sweep, harmonics = parts["ring_response"]
    assert sweep[[0, -1]] == pytest.approx([0.99 * 40e3, 1.01 * 40e3])
    assert harmonics == [0, 2, 5]


def test_a_stator_is_beside_what_was_measured_of_it(parts: dict[str, Any]) -> None:
    told: list[str] = []
    one = analyze_ring(load_display("biet2008-stator"), progress=told.append)
    assert (one.model, one.remarks.frequency) == ("a-model", "(estimated)")
    # 2 µm at 140 V.
    assert one.amplitude_per_volt == pytest.approx(2e-6 / 140)
    assert told[0] == "fitting the stator's thickness"


def test_a_fitted_body_is_said_to_be_fitted(parts: dict[str, Any]) -> None:
    parts["body"] = body(fit=FIT, quality_factor=None)
    one = analyze_ring(load_display("biet2008-stator"))
    assert one.model == "a-model, fitted stator"
    assert one.remarks.frequency == "(estimated); fitted, not predicted"
    assert one.remarks.quality == "from the losses of its materials"


def frozen(budget: float) -> Pace:
    """A budget by a clock that stands still: what is allowed depends on the expected times only."""
    return Pace(budget, clock=lambda: 0.0)


def test_a_budget_leaves_out_the_band_and_says_so(parts: dict[str, Any]) -> None:
    one = analyze_ring(disc(), pace=frozen(1.1))
    assert "band" not in parts
    assert [row.label for row in one.rows] == ["B(1,2)"]
    assert ALONE in one.objections
    assert ALONE not in analyze_ring(disc(), pace=frozen(60.0)).objections
    assert "band" in parts


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("winfield2007-tpad", "of a disc and its"),
        ("biet2008-stator", "of a stator, whose"),
    ],
)
def test_a_budget_that_allows_no_mode_is_refused_with_what_is_expected(
    parts: dict[str, Any], name: str, says: str
) -> None:
    with pytest.raises(OutOfTimeError, match=says) as caught:
        analyze_ring(load_display(name), pace=frozen(0.5))
    assert "Without a solve: about" in str(caught.value)
    assert "ring_response" not in parts


@pytest.mark.slow
def test_the_sound_of_every_fourth_radius_is_that_of_all() -> None:
    display = disc()
    body = ring_body(display.actuator)
    own = body.mode()
    response = ring_response(body, own, np.array([own.frequency]), [0], 2)
    coarse = ring._sound(display, own, response)
    velocity = 2j * np.pi * own.frequency * display.drive.voltage * response.motion[0]
    fine = sound_field(ring_surface(response.radius, velocity, 0, own.frequency), (0.3,))
    level = coarse.sound_pressure_level_dB[coarse.distances.index(0.3)]
    assert level == pytest.approx(fine.sound_pressure_level_dB[0], abs=0.02)


def test_a_plate_is_no_ring() -> None:
    with pytest.raises(InputError, match="'biet2008-plate' has a rectangular_plate; no disc"):
        analyze_ring(load_display("biet2008-plate"))


MOVING = {
    "node_height": np.array([0.0, 0.0, 1e-3, 1e-3, 1e-3]),
    "displacement": np.array([[0, 9, 1], [0, 9, 1], [0, 0.2, 0.5], [0, 0.3, -1.5], [0, 1, 1]]),
}
"""Of the nodes on top, that at 25 mm moves most: 0.3 along for 1.5 across."""


def test_a_pair_is_what_a_split_makes_of_one_channel() -> None:
    display = load_display("winfield2007-tpad")
    volts = display.drive.voltage
    working = mode(**MOVING)
    driven: Any = SimpleNamespace(section=None, drive=ALL_ROUND)
    with mock.patch.object(ring_pair, "electrode_split", return_value=2e-3) as open_ones:
        found = ring_pair.ring_pair(display, driven, working)
    assert open_ones.call_args.args == (None, working, ALL_ROUND)
    amplitude = volts * working.amplitude_per_volt(ALL_ROUND)
    along = 2 * math.pi * 40e3 * 0.2
    assert (found.label, found.frequency, found.quality_factor) == ("B(1,2)", 40e3, 100.0)
    assert found.amplitude == pytest.approx(amplitude)
    assert found.two_channels == pytest.approx(along * amplitude)
    assert found.electrode_split == pytest.approx(80.0)
    # Half-bandwidths are f/2Q = 200 Hz; both numbers of a split follow from its share of them.
    shares = {0.1: 0.05 / 1.0025, 0.5: 0.25 / 1.0625, 2.0: 0.5}
    assert [one.half_bandwidths for one in found.splits] == pytest.approx(list(shares))
    for one in found.splits:
        s = one.half_bandwidths
        assert one.split == pytest.approx(200 * s)
        assert one.standing_wave_ratio == pytest.approx(2 / s)
        assert one.travelling == pytest.approx(shares[round(s, 9)])
        assert one.crest_speed == pytest.approx(one.travelling * along * amplitude)


def test_a_stator_s_amplitude_is_in_proportion_to_its_reference() -> None:
    display = load_display("biet2008-stator")
    stator: Any = display.actuator
    driven: Any = SimpleNamespace(section=None, drive=ALL_ROUND)
    with mock.patch.object(ring_pair, "electrode_split", return_value=0.0):
        found = ring_pair.ring_pair(display, driven, mode(**MOVING))
    expected = stator.reference_amplitude * display.drive.voltage / stator.reference_voltage
    assert found.amplitude == pytest.approx(expected)
