"""Whose finger a display is described for: fitted to made curves, and what is drawn of it."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core import presets
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.friction.friction_scores import (
    fitted_person,
    with_decay_length,
    with_finger,
)
from squeezefilm.measure.recordings.kinds import FrictionCurve
from squeezefilm.physics.chain.friction import FrictionLaw, friction_law
from squeezefilm.physics.display import load_display
from squeezefilm.physics.uncertainty.parameters import DECAY_LENGTH, uncertain_parameters

PLATE = load_display("biet2008-plate")
AMPLITUDE = np.linspace(0.1e-6, 2.5e-6, 17)
FOLDER = presets.friction_folder()


@pytest.fixture(scope="module")
def law() -> FrictionLaw:
    return friction_law(PLATE, 10e-3, 30e3, normal_force=0.2, speed=0.01)


def curve(law: FrictionLaw, length: float, noise: float = 0.0, seed: int = 1) -> FrictionCurve:
    relative = with_decay_length(law, length).curve(AMPLITUDE)
    wrong = noise * np.random.default_rng(seed).standard_normal(AMPLITUDE.size)
    friction = 0.4 * (relative + wrong)
    return FrictionCurve(AMPLITUDE, friction, 30e3, quantity="friction_force")


def test_a_made_person_is_found_again(law: FrictionLaw) -> None:
    for length in (3e-6, 9e-6, 25e-6):
        found = fitted_person(curve(law, length), law)
        assert found.decay_length == pytest.approx(length, rel=1e-3)
        assert found.friction_at_rest == pytest.approx(0.4, rel=1e-3)
        assert found.left < 1e-3
        assert found.relative_error < 1e-2


@pytest.mark.slow
def test_the_error_of_a_person_is_that_of_repeated_curves(law: FrictionLaw) -> None:
    found = [fitted_person(curve(law, 9e-6, 0.02, seed), law) for seed in range(12)]
    spread = np.std(np.log([one.decay_length for one in found]), ddof=1)
    said = np.sqrt(np.mean([one.relative_error**2 for one in found]))
    # Twelve spreads of a Gaussian are within a factor of two of the true one.
    assert 0.5 < said / spread < 2
    assert np.mean([one.left for one in found]) == pytest.approx(0.02, rel=0.4)


def test_few_points_make_no_person(law: FrictionLaw) -> None:
    made = curve(law, 9e-6)
    short = dataclasses.replace(made, vibration_amplitude=AMPLITUDE[:5], friction=made.friction[:5])
    with pytest.raises(InputError, match="5 points"):
        fitted_person(short, law)


def test_a_curve_that_hardly_falls_makes_no_person(law: FrictionLaw) -> None:
    flat = dataclasses.replace(curve(law, 9e-6), friction=np.full(AMPLITUDE.size, 0.4))
    with pytest.raises(InputError, match="falls too little"):
        fitted_person(flat, law)


def test_new_people_differ_more_than_their_mean_is_unsure() -> None:
    assert with_finger(PLATE, "new") is PLATE
    mean = with_finger("biet2008-plate", "mean")
    assert mean.finger == PLATE.finger

    def spread(display: object) -> float:
        found = uncertain_parameters(display, driven=False)  # type: ignore[arg-type]
        (length,) = (one for one in found if one.path == DECAY_LENGTH)
        low, high = length.distribution.quantile(np.array([0.05, 0.95]))
        return float(np.log(high / low))

    assert spread(PLATE) == pytest.approx(2 * 1.645 * 0.345, rel=0.02)
    assert spread(mean) == pytest.approx(spread(PLATE) / np.sqrt(14), rel=0.02)


@pytest.mark.slow
def test_a_recorded_person_is_at_the_speed_of_the_recording() -> None:
    person = with_finger("biet2008-plate", FOLDER / "wiertlewski2016-person-3.csv")
    assert person.finger.decay_speed == 0.01
    assert person.finger.decay_length_at(0.01) == person.finger.contact_decay_length
    # As decision 0018 has it, on an even wave.
    assert person.finger.contact_decay_length == pytest.approx(4.6e-6, rel=0.03)
    assert person.provenance[DECAY_LENGTH].source.startswith("fitted to wiertlewski2016-person-3")


def test_what_is_no_finger_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="allowed are new, mean, and a file"):
        with_finger(PLATE, "nobody")
    with pytest.raises(InputError, match="no friction curve"):
        with_finger(PLATE, FOLDER / "monnoyer2018-strokes.csv")
    speed = np.where(AMPLITUDE > 1e-6, 10, 20)
    table = np.column_stack([1e6 * AMPLITUDE, np.linspace(0.4, 0.1, AMPLITUDE.size), speed])
    np.savetxt(
        tmp_path / "mixed.csv", table, delimiter=",", header="amplitude (um),friction (N),speed",
        comments="",
    )  # fmt: skip
    (tmp_path / "mixed.toml").write_text(
        'kind = "friction curve"\nfrequency = "30 kHz"\n[columns]\n'
        'vibration_amplitude = { column = 1, unit = "um", given_as = "zero-to-peak" }\n'
        'friction_force = { column = 2, unit = "N" }\nspeed = { column = 3, unit = "mm/s" }\n',
        encoding="utf-8",
    )
    with pytest.raises(InputError, match="one condition"):
        with_finger(PLATE, tmp_path / "mixed.csv")
