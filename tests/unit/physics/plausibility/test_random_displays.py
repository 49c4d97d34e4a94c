"""Displays with one or two values wrong by a slip of unit or of digits are refused or warned of
before any solve, and none is called good; those that are built pass."""

import dataclasses
import functools
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.physics.plausibility.described import changed, displays, numbers, plausible_display

from squeezefilm.core.errors import InputError
from squeezefilm.design.analysis.verdict import verdict
from squeezefilm.physics.chain import touch
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plausibility.checks import implausibilities

# What devices that are built differ by, as a factor up or down: what is wrong by less is not
# implausible by itself. All others differ by less than ten.
DIFFER = {
    "quality_factor": 1e3,
    "voltage": 1e3,
    "roughness": 1e4,
    "asperity_roughness": 1e4,
    "skin_roughness": 1e3,
    "modulus": 1e5,
    "normal_force": 1e2,
    "speed": 1e2,
    "reference_voltage": 1e2,
    "reference_amplitude": 1e2,
    "friction_coefficient": 1e2,
    # Bonds and gaskets are of anything from solder to foam, and as thick as they come out.
    ("glue", "thickness"): 1e2,
    ("supports", "young_modulus"): 1e5,
    ("supports", "thickness"): 1e2,
    # Pads of people and of machines.
    "stiffness": 1e3,
    "damping": 1e3,
    "mass": 1e3,
    # A bonded ceramic may be a tenth as thick.
    ("patches", "thickness"): 1e2,
    ("patches", "length"): 1e2,
    ("patches", "width"): 1e2,
    "ceramic_thickness": 1e2,
    "ceramic_outer_diameter": 1e2,
    "plateau_width": 1e2,
    "contact_decay_length": 1e2,
    ("measured", "vibration_amplitude"): 1e2,
    "ridge_amplitude": 1e2,
    "radial_width": 1e2,
    "width": 1e2,
}
# Not looked at: what enters no number of the vibration and the friction (limits of the device,
# small coefficients of warmth), what is a shape and has no usual size, and parts of a skin that
# stands still.
LEFT_OUT = {
    "duty", "duty_window", "slew", "continuous_voltage", "heat", "lowest_frequency",
    "highest_frequency", "emissivity", "temperature_coefficient", "contact_area_exponent",
    "decay_speed_exponent",
    "hurst_exponent", "longest_wavelength", "shortest_wavelength",
    "ambient_temperature", "mass_per_area", "damping_per_area", "ridge_angle",
}  # fmt: skip


def least_factor(path: tuple[str | int, ...]) -> float:
    names = [str(part) for part in path if isinstance(part, str)]
    pairs = [(first, names[-1]) for first in names[:-1]]
    return max((DIFFER[key] for key in [*pairs, names[-1]] if key in DIFFER), default=10.0)


def wrong(rng: np.random.Generator, right: Display) -> tuple[Display | None, str]:
    """A display with one or two values off by 10 to a million, None where it cannot be built."""
    values = [item for item in numbers(right) if item[0][-1] not in LEFT_OUT]
    said, display = [], right
    for _ in range(int(rng.integers(1, 3))):
        path, value = values[int(rng.integers(len(values)))]
        if path[:2] == ("actuator", "supports") and path[-1] in ("length", "width"):
            path, value = ("actuator", "thickness"), right.actuator.thickness  # type: ignore[union-attr]
        decades = rng.uniform(np.log10(least_factor(path)), 6.0001)
        factor = 10 ** float(rng.choice([-1, 1]) * decades)
        said.append(f"{'.'.join(map(str, path))} x {factor:.3g}")
        try:
            display = changed(display, path, value * factor)
        except InputError:
            return None, "; ".join(said)
    return display, "; ".join(said)


def some_prediction() -> Prediction:
    """One that would be called good: of the measured stator, so that nothing is solved."""
    return predict(load_display("biet2008-stator"), model="partial-levitation")


def check(seed: int, count: int, monkeypatch: pytest.MonkeyPatch) -> dict[str, int]:
    def never(*_: object, **__: object) -> None:
        raise AssertionError("a solve was begun")

    rng, good = np.random.default_rng(seed), some_prediction()
    curve: Any = SimpleNamespace(amplitude_for_criterion=None)
    bases = [*displays(), *(plausible_display(rng) for _ in range(5))]
    monkeypatch.setattr(touch, "working_mode", never)
    # Of modes nearby, which are another doubt and solved for, nothing is asked.
    monkeypatch.setattr("squeezefilm.design.analysis.verdict.mode_doubts", lambda *_: ())
    counted, missed = {"not built": 0, "refused": 0, "doubted": 0}, []
    for _ in range(count):
        display, said = wrong(rng, bases[int(rng.integers(len(bases)))])
        if display is None:
            counted["not built"] += 1
            continue
        found = implausibilities(display)
        if any(one.refused for one in found):
            with pytest.raises(InputError):
                predict(display)
            counted["refused"] += 1
        elif found:
            objected = dataclasses.replace(good, objections=tuple(one.sentence for one in found))
            lines = tuple(verdict(display, objected, None, curve, None))
            assert not [line for line in lines if line.kind == "good"], said
            assert lines[0].text == found[0].sentence
            counted["doubted"] += 1
        else:
            missed.append(said)
    assert not missed, f"{len(missed)} passed: " + "\n".join(missed)
    return counted


def test_eighty_implausible_displays(monkeypatch: pytest.MonkeyPatch) -> None:
    counted = check(18, 80, monkeypatch)
    assert min(counted.values()) > 4


@pytest.mark.nightly
def test_many_more_implausible_displays(monkeypatch: pytest.MonkeyPatch) -> None:
    seed = int(np.random.default_rng().integers(1_000_000))
    print(f"seed {seed}")
    check(seed, 1500, monkeypatch)


@functools.cache
def built(seed: int, count: int) -> list[Display]:
    rng = np.random.default_rng(seed)
    return [plausible_display(rng) for _ in range(count)]


def test_presets_pass_without_a_word() -> None:
    for display in displays():
        assert implausibilities(display) == (), display.name


@pytest.mark.nightly
def test_two_hundred_plausible_plates_are_not_refused() -> None:
    doubted = [found for one in built(7, 200) if (found := implausibilities(one))]
    assert not [one for found in doubted for one in found if one.refused]
    texts = {one.text.partition(" is ")[0] for found in doubted for one in found}
    assert len(doubted) <= 10, texts
