"""The key numbers of a motor and of an array, on the terminal, of results that are made up."""

from __future__ import annotations

from collections.abc import Iterable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.printed import printed

from squeezefilm.actuators.analysis.drawn import DrawnAnswers
from squeezefilm.actuators.report.motor import motor_rows
from squeezefilm.actuators.report.page import AnalyzedActuator
from squeezefilm.actuators.report.skin_stretch import skin_stretch_rows
from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.distributions import Uniform
from squeezefilm.physics.uncertainty.parameters import Parameter

DRAWN = Parameter("a.value", 2.0, si.Unit("N"), Uniform(1, 3), "given", "a balance")
DESCRIBED = SimpleNamespace(
    title="A title",
    name="mine",
    provenance={"a.value": Provenance("paper"), "a.guess": Provenance("", "assumed")},
)


def intervals(**of: tuple[float, float, float]) -> DrawnAnswers:
    return DrawnAnswers(of, dict.fromkeys(of, (1.0,)), 64, 0, "", 3, (DRAWN,))


def motor(**other: Any) -> Any:
    best = SimpleNamespace(
        efficiency=0.125, speed=0.1, force=0.5, output=0.05, plate_loss=0.2, thrust=0.75
    )
    working = SimpleNamespace(resonance_frequency=40_000.0, quality_factor=250.0)
    averaged = SimpleNamespace(
        modes=[SimpleNamespace(working=working)],
        motor=SimpleNamespace(cradle=SimpleNamespace(preload=20.0)),
        quiescent_force=3.0,
        highest_voltage=120.0,
    )
    values = {
        "motor": averaged, "best": best, "free_amplitude": 2e-6, "voltage": 60.0,
        "rest": SimpleNamespace(amplitude=1.5e-6, contact_share=0.25),
        "best_of_map": (0.3, 10.0, 1e-6), "plane": None, "stall_force": 1.25,
        "no_load_speed": 0.15, "input_power": 0.4, "motion": SimpleNamespace(thrust=0.7),
        "drawn": intervals(stall_force_N=(1.0, 1.2, 1.5), no_load_speed_m_per_s=(0.1, 0.15, 0.2)),
        "described": DESCRIBED, "warnings": ("it stalls",),
    }  # fmt: skip
    return SimpleNamespace(**(values | other))


MOTOR = [
    "Stall force 1.25 N (1 N to 1.5 N) the load that just stops the slider",
    "Speed without a load 150 mm/s (100 mm/s to 200 mm/s)",
    "Best efficiency 12 % at 100 mm/s against 0.5 N: 50 mW out of 400 mW, of which 200 mW are "
    "lost in the plate",
    "Best of the map 30 % under 10 N at 1 µm, of what was looked at",
    "The same in time 0.7 N of thrust, where the mean over a period gives 0.75 N",
    "Held without a voltage 3 N by friction under a preload of 20 N",
    "Amplitude 1.5 µm zero to peak, under the slider: 75 % of that without it",
    "Feet in contact 25 % of each period, at rest",
    "Drive 60 V at 40 kHz, Q 250; the ceramic bears 120 V",
]
SURE = [
    "In brackets, 5 to 95 % of 64 draws (seed 3) of 1 uncertain values together, from ranges of "
    "the file.",
    "1 of 2 values with a source are assumed",
]


def said(cells: Iterable[str]) -> str:
    return " ".join(cells).replace("\N{NO-BREAK SPACE}", " ").strip()


def test_a_motor_says_what_it_does_and_how_sure_that_is() -> None:
    assert [said(row) for row in motor_rows(motor())] == MOTOR
    lines = printed(AnalyzedActuator(motor(), motor_rows, (), {}).show)
    assert lines[0] == "A title [mine]"
    for line in ("Feet in contact 25 %", "it stalls", *SURE):
        assert line in said(lines)


def test_a_motor_in_the_plane_says_both_velocities_after_its_speed() -> None:
    moved = SimpleNamespace(final_velocity=np.array([0.12, -0.03]))
    rows = motor_rows(motor(plane=moved))
    assert [row[0] for row in rows[1:3]] == ["Speed without a load", "Free in the plane"]
    assert said([rows[2][1]]) == "120 mm/s, -30 mm/s"
    assert len(rows) == len(motor_rows(motor())) + 1


def array(**other: Any) -> Any:
    tip = SimpleNamespace(deflection=20e-6, force=0.04, resonance_frequency=800.0, bandwidth=400.0)
    built = SimpleNamespace(
        cradle=SimpleNamespace(count=60), crosstalk=0.125, normal_force=1.5,
        bender=SimpleNamespace(resonance_frequency=350.0),
        budget=SimpleNamespace(mass=9e-3, volume=1.2e-6, area=1.3e-4),
    )  # fmt: skip
    pull = SimpleNamespace(slipping=7)
    values = {
        "array": built, "tip": tip, "power": (0.25, 2.5), "least_force": 3.0, "voltage": 150.0,
        "lines": {"direct": 120, "daisy_chain": 4}, "free_deflection": 50e-6,
        "blocked_force": 0.06, "skin": SimpleNamespace(stiffness=2000.0),
        "seating": SimpleNamespace(touching=48), "together": SimpleNamespace(slipping=12),
        "wave": SimpleNamespace(pull=pull, period=4e-3),
        "drawn": intervals(free_deflection_m=(40e-6, 50e-6, 60e-6), crosstalk=(0.1, 0.125, 0.2)),
        "described": DESCRIBED, "warnings": ("it slips",),
    }  # fmt: skip
    return SimpleNamespace(**(values | other))


ARRAY = [
    "Free deflection 50 µm (40 µm to 60 µm) at 150 V",
    "Blocked force 60 mN",
    "Against the skin 20 µm and 40 mN; the skin's 2 N/mm are assumed",
    "Resonance 350 Hz free; 800 Hz on the skin, within 3 dB up to 400 Hz",
    "Crosstalk 0.125 (0.1 to 0.2) of its displacement, at the neighbour that moves most",
    "Contactors 48 of 60 touch under 1.5 N; all from 3 N on",
    "Slip 12 of 60 where all pull alike; 7 in a wave of 4 mm",
    "Actuators alone 9 g 1.2 cm³, of 60 g and 150 cm³; 1.3 cm² active",
    "Power at 100 Hz 2.5 W that drivers burn at full swing; 250 mW heats the ceramics",
    "Wires 120 or 4 direct or daisy chain; a count, not a circuit",
]


def test_an_array_says_what_it_does_and_how_sure_that_is() -> None:
    for row, words in zip(skin_stretch_rows(array()), ARRAY, strict=True):
        assert said(row).startswith(words)
    lines = printed(AnalyzedActuator(array(), skin_stretch_rows, (), {}).show)
    assert lines[0] == "A title [mine]"
    for line in ("Resonance 350 Hz free;", "it slips", *SURE):
        assert line in said(lines)


@pytest.mark.parametrize(("force", "says"), [(None, "all from never all on"), (2.0, "2 N on")])
def test_an_array_says_from_which_force_on_all_touch(force: float | None, says: str) -> None:
    rows = {row[0]: row for row in skin_stretch_rows(array(least_force=force))}
    assert says in said([rows["Contactors"][2]])
