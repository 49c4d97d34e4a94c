"""What could explain the paper's prototype, on plates whose frequencies are made up here."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator
from typing import Any

import pytest

from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.design.plate.solved import PlatePoint
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.validation import explanations as prototype
from squeezefilm.validation.explanations import (
    MEASUREMENTS,
    NEIGHBOURS,
    Explanation,
    paper_plate,
    paper_points,
    prototype_study,
)

C11 = paper_plate().ceramic.in_plane_stiffness


def frequency(plate: RectangularPlate, label: tuple[int, int]) -> float:
    """Of a bar in bending, with what the ceramic and the glue add put in by hand."""
    own, glue = plate.substrate, plate.glue
    stiffness = 0.6 * own.young_modulus / 123e9 + 0.4 * plate.ceramic.in_plane_stiffness / C11
    bond = 1.0 if glue is None else 1 - 0.1 * glue.thickness / 50e-6 * 1e9 / glue.young_modulus
    base = 34e3 if plate.ceramic.data_set == "from_d31" else 35e3
    shape = plate.thickness / 2e-3 * math.sqrt(stiffness * 8250 / own.density)
    return base * shape * bond * (label[0] / 8) ** 2


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[tuple[Any, Any, bool]]]:
    """Frequencies as above, 10 % below those with open terminals; 80 nm per volt and Q of 50."""
    every: list[tuple[Any, Any, bool]] = []

    def point(plate: RectangularPlate, label: Any = None, *, amplitude: bool = True) -> Any:
        every.append((plate, label, amplitude))
        at = frequency(plate, label or (8, 0))
        driven = 80e-9 if amplitude else None
        return PlatePoint(label or (8, 0), at, 1.0, driven, 50.0, 1.1 * at)

    monkeypatch.setattr(prototype, "working_point", point)
    paper_points.cache_clear()
    yield every
    # What is made up may not stay behind for the tests of the real plate.
    paper_points.cache_clear()


def explanation(**changes: Any) -> Explanation:
    values: dict[str, Any] = {
        "name": "a", "free": "its mass", "value": "1 kg", "frequency": 30.5e3,
        "neighbour_ratios": (0.6, 0.8, 1.25), "open_shift": 0.05, "amplitude": 1e-6,
        "quality_factor": 60.0, "quality_factor_for_measured": 69.0,
    }  # fmt: skip
    return Explanation(**{**values, **changes})


def test_the_papers_numbers_are_the_papers() -> None:
    """Sections 3.1.3 and 3.2.1."""
    assert prototype.MODAL_FREQUENCY == 35.6e3
    assert prototype.HARMONIC_FREQUENCY == 34.77e3
    assert prototype.HARMONIC_AMPLITUDE == 3.2e-6
    assert prototype.MEASURED_FREQUENCY == 30.5e3
    assert prototype.MEASURED_AMPLITUDE == 1.15e-6
    assert prototype.DRIVE_VOLTAGE == 15.0
    assert MEASUREMENTS == (
        "f(6,0) / f(8,0)", "f(7,0) / f(8,0)", "f(9,0) / f(8,0)", "open-circuit shift",
        "amplitude at known Q",
    )  # fmt: skip


def test_a_study_has_every_explanation_and_every_pair(
    asked: list[tuple[Any, Any, bool]],
) -> None:
    told: list[str] = []
    study = prototype_study(told.append)
    assert (study.from_d31.frequency, study.printed_e31.frequency) == (34e3, 35e3)
    names = [one.name for one in study.explanations]
    assert told == [f"30.5 kHz by {name}" for name in names]
    pairs = [(one.first, one.second) for one in study.separations]
    assert pairs == list(itertools.combinations(names, 2))
    wanted = 30.5e3
    for one in study.explanations:
        assert one.frequency == pytest.approx(wanted, rel=3e-4)
        assert one.open_shift == pytest.approx(0.1)
        assert one.neighbour_ratios == pytest.approx([(n / 8) ** 2 for n in (6, 7, 9)])
        # 15 V times 80 nm/V are 1.2 µm; linear in Q, 1.15 µm take 50 × 1.15/1.2.
        assert one.amplitude == pytest.approx(1.2e-6)
        assert one.quality_factor == 50.0
        assert one.quality_factor_for_measured == pytest.approx(50 * 1.15 / 1.2)
        assert one.amplitude_for_q_60 == pytest.approx(1.2e-6 * 60 / 50)
    # Each free parameter solved for by hand.
    share = wanted / 34e3
    stiffness = 0.6 * 115 / 123 + 0.4 * 0.9
    expected = {
        "50 µm of glue": ("its Young's modulus", 0.1e9 / (1 - share), "MPa"),
        "20 µm of glue": ("its Young's modulus", 0.04e9 / (1 - share), "MPa"),
        "E 115 GPa, c11_p −10 %, thinner plate": (
            "plate thickness", 2e-3 * share / math.sqrt(stiffness), "mm",
        ),
        "plate and ceramic softer alike": ("share of E and c11_p", share**2, ""),
        "a heavier plate": ("its density", 8250 / share**2, "kg/m³"),
        "50 µm of glue, printed e31": (
            "its Young's modulus", 0.1e9 / (1 - wanted / 35e3), "MPa",
        ),
    }  # fmt: skip
    units = {"MPa": 1e6, "mm": 1e-3, "kg/m³": 1.0, "": 1.0}
    assert names == list(expected)
    for one in study.explanations:
        free, value, unit = expected[one.name]
        number, _, symbol = one.value.partition(" ")
        assert (one.free, symbol) == (free, unit)
        assert float(number) * units[symbol] == pytest.approx(value, rel=5e-3)
    # Only the solved plate's own amplitude is asked for, once each, and of the paper's two.
    assert sum(amplitude for _, _, amplitude in asked) == len(names) + 2
    assert {label for _, label, _ in asked} == {None, *NEIGHBOURS}


def test_how_a_value_is_said_is_by_its_unit(asked: list[tuple[Any, Any, bool]]) -> None:
    said = {
        one.name: one.value
        for one in (
            prototype._explained(paper_plate(), name, free, unit, (low, high), make)
            for name, free, unit, low, high, make in prototype._CASES
        )
    }
    assert said["plate and ceramic softer alike"].startswith("0.80")
    assert len(said["plate and ceramic softer alike"]) == 5
    density, unit = said["a heavier plate"].split()
    assert (len(density), unit) == (5, "kg/m³")


def test_each_explanation_makes_the_plate_that_it_names() -> None:
    plate = paper_plate()
    made = {name: make(plate, value) for (name, *_, make), value in zip(
        prototype._CASES, (2e9, 0.5e9, 1.7e-3, 0.8, 9e3, 2.5e9), strict=True
    )}  # fmt: skip
    for name, size, modulus, data in (
        ("50 µm of glue", 50e-6, 2e9, "from_d31"), ("20 µm of glue", 20e-6, 0.5e9, "from_d31"),
        ("50 µm of glue, printed e31", 50e-6, 2.5e9, "printed_e31"),
    ):  # fmt: skip
        one = made[name]
        assert one.glue is not None
        assert (one.glue.thickness, one.glue.young_modulus) == (size, modulus)
        assert one.ceramic.data_set == data
        assert one.substrate == plate.substrate
    thinner = made["E 115 GPa, c11_p −10 %, thinner plate"]
    assert (thinner.thickness, thinner.substrate.young_modulus) == (1.7e-3, 115e9)
    assert thinner.ceramic.in_plane_stiffness == pytest.approx(0.9 * C11)
    softer = made["plate and ceramic softer alike"]
    assert softer.substrate.young_modulus == pytest.approx(0.8 * 123e9)
    assert softer.ceramic.in_plane_stiffness == pytest.approx(0.8 * C11)
    heavier = made["a heavier plate"]
    assert heavier == dataclasses.replace(
        plate, substrate=dataclasses.replace(plate.substrate, density=9e3)
    )


def test_a_parameter_that_reaches_the_frequency_nowhere_is_refused(
    asked: list[tuple[Any, Any, bool]],
) -> None:
    *_, make = prototype._CASES[4]
    with pytest.raises(SqueezefilmError, match=r"8e\+03 and 9e\+03 \(kg/m3\) does not bring"):
        prototype._explained(paper_plate(), "mass", "density", "kg/m3", (8e3, 9e3), make)
    assert len(asked) == 2


def test_two_explanations_stand_apart_in_what_could_be_measured() -> None:
    """Ratios to 0.2 %, the open shift to 0.2 points, an amplitude at known Q to a tenth."""
    one = explanation()
    other = explanation(
        name="b", neighbour_ratios=(0.6 / 1.004, 0.8 / 0.99, 1.25), open_shift=0.057,
        # The same Q of 60: e^0.3 times as far.
        amplitude=2e-6 * math.exp(-0.3), quality_factor=120.0,
    )  # fmt: skip
    found = prototype._apart(one, other)
    assert (found.first, found.second, found.measurements) == ("a", "b", MEASUREMENTS)
    assert found.apart == pytest.approx((2.0, 5.0, 0.0, 3.5, 3.0))
    assert prototype._apart(one, one).apart == (0.0,) * 5


@pytest.mark.parametrize("end", [0, 1])
def test_an_end_of_the_range_that_meets_the_frequency_is_the_answer(
    end: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    ends = [8e3, 9e3]

    def point(mass: float, label: Any = None, *, amplitude: bool = True) -> PlatePoint:
        is_there = mass == pytest.approx(ends[end], rel=1e-9)
        wanted = prototype.MEASURED_FREQUENCY * (1.0 if is_there else 1.1)
        return PlatePoint(label or (8, 0), wanted, 1.0, 80e-9, 50.0, wanted)

    monkeypatch.setattr(prototype, "working_point", point)
    plate: Any = None
    made = prototype._explained(plate, "a", "b", "kg", (8e3, 9e3), lambda _, mass: mass)  # type: ignore[arg-type,return-value]
    assert made.frequency == prototype.MEASURED_FREQUENCY
