"""What the terminal says of a friction: every number with its unit, and what is not there."""

from __future__ import annotations

import dataclasses
from collections import Counter
from types import SimpleNamespace
from typing import Any

import numpy as np
from tests.unit.made_results import WARM, WARM_LINES
from tests.unit.printed import printed

from squeezefilm.core.distributions import Uniform
from squeezefilm.core.quantities import Unit
from squeezefilm.design.analysis.curves import ModelCurve
from squeezefilm.design.analysis.published_claims import missed_by
from squeezefilm.design.analysis.verdict import Finding
from squeezefilm.design.friction import Wanted
from squeezefilm.design.report.friction import show_friction
from squeezefilm.physics.chain.touch import Touch
from squeezefilm.physics.uncertainty.draws import Refusals
from squeezefilm.physics.uncertainty.intervals import GroupInfluence, Influence
from squeezefilm.physics.uncertainty.model_choices import LawChoice, LawOption
from squeezefilm.physics.uncertainty.parameters import Parameter
from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

SHARING = SimpleNamespace(
    film_share=np.array([0.5678, 0.1]),
    relative_friction=np.array([0.4322, 0.2]),
    mean_gap=np.array([1.2345e-6, 9e-6]),
)
LOADED = SimpleNamespace(
    resonance_frequency=33581.25,
    free_frequency=33578.0,
    free_quality_factor=60.0,
    quality_factor=45.25,
)


def touched(mode: Any = LOADED, sharing: Any = SHARING) -> Touch:
    """A finger that leaves three quarters of 2 µm."""
    law = sharing and SimpleNamespace(
        sharing=lambda *_: sharing, kind=SimpleNamespace(limit="own", friction="load")
    )
    return Touch(2e-6, 1.5e-6, mode, law, 1.2345 - 0.6789j)


def prediction(**changes: Any) -> SimpleNamespace:
    """A plate at 15 V under a finger, with all that there can be to say."""
    values = {
        "relative_friction": 0.43216, "voltage": 15.0, "vibration_amplitude": 1.5e-6,
        "frequency": 33580.0, "touch": touched(), "normal_force": 0.5,
        "model": "a-model", "law": SimpleNamespace(kind=SimpleNamespace(friction="load")),
        "surface": SimpleNamespace(name="copper", roughness=0.7e-6), "friction_reduction": 0.11357,
        "friction_coefficient": 0.2, "tangential_force": 0.043216, "speed": 0.08,
        "relative_friction_limits": (0.41, 0.49), "heat": WARM,
        "warnings": ("mind this", "and that"), "place_said": "at the antinode",
        "place": (0.03, 0.02),
    }  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


def influence(number: int, origin: str, first: float, total: float, error: float) -> Influence:
    """One of several parameters, between 150 and 350.25 µm."""
    spread = Uniform(150e-6, 350.25e-6)
    parameter = Parameter(f"finger.p{number}", 2e-4, Unit("m"), spread, origin, "")  # type: ignore[arg-type]
    return Influence(parameter, first, 0.0, total, error)


SLIP = LawChoice(
    "gas.slip",
    (LawOption("first", 0.25, "slips"), LawOption("veijola", 0.75, "a fit")),
    "",
)
SURE = UncertainFriction(
    nominal=0.432, median=0.44, interval=(0.283, 0.551), level=0.9, samples=np.zeros(3),
    amplitudes=np.zeros(3), draws=3,
    influences=(
        influence(0, "assumed", 0.25, 0.4, 0.05),
        influence(1, "given", -0.02, 0.1, 0.012),
        *(influence(number, "given", 0.0, 0.0, 0.0) for number in range(2, 8)),
        Influence(SLIP, 0.0, 0.0, 0.4, 0.1),
    ),
    groups=(
        GroupInfluence("measurable", 0.6, 0.7, 0.1, 0.05),
        GroupInfluence("unknown", -0.02, 0.4, 0.2, 0.03),
    ),
    refused=Refusals(640, Counter({"pressed flat": 2}), Counter({"persson": 2}), ""), seed=5,
    model="a-model",
)  # fmt: skip


def analysis(**changes: Any) -> Any:
    """All of a friction's analysis."""
    axis = np.array([0.0, 2e-6])
    values = {
        "display": SimpleNamespace(
            title="A plate", name="plate", gas=SimpleNamespace(ambient_pressure=101325.0)
        ),
        "prediction": prediction(),
        "curves": (
            ModelCurve("levitation-2016", axis, np.array([1.0, 0.2])),
            ModelCurve("paper2008", 0.5 * axis, np.array([1.0, 0.2])),
        ),
        "uncertainty": SURE,
        "ripple": SimpleNamespace(ripple=0.0123, half_wavelength=9.8765e-3),
        "wanted": Wanted(0.7, 1.2345e-6, 12.345),
        "verdict": (Finding("limit", "Whether it is met is open."),),
        "apart": None,
        "active_area": None,
    }
    return SimpleNamespace(**{**values, **changes})


def said(columns: int = 220, **changes: Any) -> list[str]:
    return printed(lambda: show_friction(analysis(**changes)), columns)


def test_a_friction_is_said_with_why_and_what_to_measure_next() -> None:
    ranks = [f"finger.p{n} 150 µm to 350 µm 0 ± 0 % as described" for n in range(2, 6)]
    assert said() == [
        "A plate [plate]",
        "µ′/µ = 0.43 as described (0.28–0.55, median 0.44): 90 % interval. 100 % of the draws lie "
        "below the value as described.",
        "limit: Whether it is met is open.",
        "Vibration amplitude 1.5 µm antinode, finger on, at 15 V",
        "Drive frequency 33.58 kHz",
        "The finger leaves 75 % of 2 µm; it moves the resonance by +3.2 Hz and Q from 60 to 45.2",
        "Finger's impedance 1.23 − 0.679i N·s/m at an antinode, damping and spring",
        "Surface copper roughness 0.7 µm",
        "Normal force 0.5 N",
        "Finger speed 80 mm/s of sliding",
        "Ambient pressure 101.3 kPa",
        "Film carries 56.8 % of the load",
        "Asperities carry 43.2 % mean gap 1.23 µm",
        "Relative friction µ′/µ 0.43 a-model",
        "Place of the finger x 30 mm, y 20 mm at the antinode",
        "µ′/µ over the active area not known",
        "Friction reduction µ − µ′ 0.114 of µ = 0.2",
        "Tangential force 43.2 mN sliding steadily",
        "A softer, a stiffer pad 0.410, 0.490 each ridge at its own balance, all at one mean gap",
        "Ripple of the wave 1.2 % every 9.88 mm, at constant amplitude",
        "For µ′/µ = 0.7 12.3 V 1.23 µm, as described",
        *WARM_LINES,
        "The same finger by other models",
        "model µ′/µ",
        # Half way down the first curve lies 1 − 0.8 · 0.75; the other ends before.
        "levitation-2016 0.400",
        "paper2008 –",
        "What measurements say and 'a-model' does not",
        "– Published directions were not asked of the model 'a-model'.",
        "Could be measured: 70 ± 10 % of the variance, 60 ± 5 % by itself",
        "drawn from share",
        "finger.p0 150 µm to 350 µm 40 ± 5 % assumed range",
        "finger.p1 150 µm to 350 µm 10 ± 1 % as described",
        *ranks,
        "Nobody knows: 40 ± 20 % of the variance, 0 ± 3 % by itself",
        "drawn from share",
        "gas.slip first 25 %, veijola 75 % 40 ± 10 % assumed weights",
        "Laws and states that are drawn, by weights that are assumed",
        "weight why",
        "gas.slip first 25 % slips",
        "gas.slip veijola 75 % a fit",
        "640 draws; seed 5; 2 of 640 draws (0.3 %) are refused: pressed flat (2); by the law of "
        "heights persson (2)",
        "! mind this",
        "! and that",
    ]


def test_a_finger_that_is_not_there_has_no_impedance_and_a_heavy_one_a_mass() -> None:
    heavy = dataclasses.replace(touched(), impedance=12.0 + 34.56j)
    assert "Finger's impedance 12 + 34.6i N·s/m at an antinode, damping and mass" in said(
        prediction=prediction(touch=heavy)
    )
    gone = dataclasses.replace(touched(), impedance=None)
    assert not [line for line in said(prediction=prediction(touch=gone)) if "impedance" in line]


def test_what_measurements_say_against_the_model_stands_beside_it() -> None:
    lines = said(prediction=prediction(model="partial-levitation"))
    at = lines.index("What measurements say and 'partial-levitation' does not")
    missed = missed_by("partial-levitation")
    assert missed
    for line, one in zip(lines[at + 1 :], missed, strict=False):
        assert line.startswith(f"– {one.says} (")
        assert one.where in line


def test_without_samples_a_friction_is_one_number() -> None:
    lines = said(uncertainty=None, ripple=None, wanted=None)
    assert lines[1] == "µ′/µ = 0.43 as described"
    assert not [line for line in lines if "variance" in line or "seed" in line]
    assert not [line for line in lines if line.startswith(("Ripple", "For µ′"))]


def test_an_amplitude_that_was_given_needs_no_voltage_and_no_plate() -> None:
    lines = said(prediction=prediction(voltage=None))
    assert lines[3] == "Vibration amplitude 1.5 µm antinode, finger on, amplitude given"
    assert not [line for line in lines if line.startswith("Temperature")]
    lines = said(prediction=prediction(touch=touched(mode=None), heat=None))
    assert "Temperature rise not known nor is the power that the plate loses" in lines
    assert lines[3].endswith("at 15 V")
    assert not [line for line in lines if line.startswith("The finger leaves")]


def test_a_model_that_shares_no_load_has_no_shares_and_no_limits() -> None:
    lines = said(
        prediction=prediction(
            touch=touched(sharing=None), relative_friction_limits=None, warnings=()
        )
    )
    assert not [line for line in lines if "carr" in line or "stiffer" in line]
    assert "seed 5" in lines[-1]


def test_labels_and_parameters_are_not_broken_on_a_narrow_terminal() -> None:
    first = dataclasses.replace(SURE.influences[0].parameter, path="finger.asperities.decay_length")
    unsure = dataclasses.replace(
        SURE, influences=(dataclasses.replace(SURE.influences[0], parameter=first),)
    )
    lines = said(56, uncertainty=unsure)
    assert any(line.startswith("Friction reduction µ − µ′ 0.114") for line in lines)
    assert any(line.startswith("finger.asperities.decay_length") for line in lines)
