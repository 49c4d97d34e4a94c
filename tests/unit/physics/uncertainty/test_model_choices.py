"""The laws that are drawn: their weights, and the same interface by each of them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from squeezefilm.core.config.provenance import Provenance
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.rough_contact import RoughContact
from squeezefilm.physics.display import load_display
from squeezefilm.physics.uncertainty.model_choices import (
    HEIGHT_LAW,
    MOISTURE,
    SLIP,
    gap_of,
    model_choices,
    same_interface,
)

STATOR = load_display("biet2008-stator")


def test_weights_are_probabilities_each_with_its_reason() -> None:
    choices = {one.path: one for one in model_choices(STATOR)}
    assert set(choices) == {HEIGHT_LAW, MOISTURE, SLIP}
    for one in choices.values():
        assert sum(option.weight for option in one.options) == pytest.approx(1)
        assert all(option.why for option in one.options)
    assert choices[MOISTURE].knowledge == "measurable"
    assert {choices[path].knowledge for path in (HEIGHT_LAW, SLIP)} == {"unknown"}
    assert choices[SLIP].spread == ("fukui-kaneko 50 %", "veijola 25 %", "first 25 %")


def test_a_share_of_the_probability_falls_to_its_option() -> None:
    slip = next(choice for choice in model_choices(STATOR) if choice.path == SLIP)
    drawn = slip.drawn((np.arange(100) + 0.5) / 100)
    assert [drawn.count(name) for name in ("fukui-kaneko", "veijola", "first")] == [50, 25, 25]
    assert slip.drawn(np.array([0.0, 1.0])) == ["fukui-kaneko", "first"]


def test_the_moisture_described_is_the_most_probable() -> None:
    moist = dataclasses.replace(STATOR.finger, moisture="moist")
    choices = model_choices(dataclasses.replace(STATOR, finger=moist))
    found = next(one for one in choices if one.path == MOISTURE)
    assert {one.name: one.weight for one in found.options} == {
        "dry": 0.25, "normal": 0.25, "moist": 0.5,
    }  # fmt: skip


def test_what_was_measured_is_not_drawn() -> None:
    known = {
        "finger.asperities.type": Provenance("our bench", "measured"),
        MOISTURE: Provenance("a guess", "assumed"),
    }
    display = dataclasses.replace(STATOR, provenance=known)
    assert {one.path for one in model_choices(display)} == {MOISTURE, SLIP}


LAWS = {
    "persson": RoughContact(roughness=0.8e-6),
    "exponential": AsperityLaw(decay_length=0.5e-6),
    "gaussian": AsperityLaw(decay_length=0.9e-6, heights="gaussian"),
}


@pytest.mark.parametrize("described", LAWS)
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("pressure", [1e3, 7e3, 3e4])
def test_an_interface_carries_the_same_at_the_same_gap_by_every_law(
    described: str, name: str, pressure: float
) -> None:
    law = LAWS[described]
    other = same_interface(law, name, pressure)
    gap = gap_of(law, pressure)
    assert float(law.pressure(gap)) == pytest.approx(pressure, rel=2e-3)
    assert float(other.pressure(gap)) == pytest.approx(pressure, rel=2e-3)
    if name == described:
        assert other is law


@pytest.mark.parametrize("described", LAWS)
def test_heights_have_one_deviation_by_every_law(described: str) -> None:
    """An exponential law is steep as Persson's is at small pressure; Gaussian asperities deviate
    by h_rms."""
    rough, even, bell = (same_interface(LAWS[described], name, 7e3) for name in LAWS)
    assert isinstance(rough, RoughContact)
    assert isinstance(even, AsperityLaw)
    assert isinstance(bell, AsperityLaw)
    assert rough.decay_length == pytest.approx(even.decay_length)
    assert rough.roughness == pytest.approx(bell.decay_length)
    # Far out the two agree, as Persson 2007 has it.
    far = 4 * rough.roughness
    steep = np.diff(np.log([float(rough.pressure(h)) for h in (far, 1.01 * far)]))[0]
    assert steep == pytest.approx(-0.01 * far / even.decay_length, rel=0.05)


def test_where_a_law_carries_too_little_the_gap_is_closed() -> None:
    assert gap_of(LAWS["exponential"], 1e8) == pytest.approx(1e-3 * 0.5e-6)
    assert gap_of(LAWS["persson"], 1e9) == pytest.approx(0.05 * 0.8e-6, rel=0.01)
