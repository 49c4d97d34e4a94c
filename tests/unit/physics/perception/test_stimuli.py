"""Gratings, virtual and real: what they play, and what is none."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.physics.render.texture.shapes import Band

ONE = Stimulus("a", 4e-3, "period", ridge_share=0.25, low=0.6, high=0.9)


@pytest.mark.parametrize(
    ("change", "quantity", "says"),
    [
        ({"low": 0.9}, "low", "low = 0.9 is not below high = 0.9"),
        ({"low": 0.95}, "low", 'take waveform = "constant"'),
        ({"waveform": "sine"}, "ridge_share", "a sine has ridge_share = 0.5, not 0.25"),
        ({"name": ""}, "name", "1 to 60 characters"),
        ({"name": " "}, "name", "1 to 60 characters"),
        ({"name": "a\nb"}, "name", "one line"),
        ({"name": "x" * 61}, "name", "1 to 60"),
        ({"ridge_share": 0.0}, "ridge_share", ""),
        ({"ridge_share": 1.0}, "ridge_share", ""),
        ({"low": -0.1}, "low", ""),
        ({"high": 1.1}, "high", ""),
        ({"orientation": 10.1}, "orientation", ""),
    ],
)
def test_what_is_no_stimulus(change: dict[str, Any], quantity: str, says: str) -> None:
    with pytest.raises(InputError) as refused:
        dataclasses.replace(ONE, **change)
    assert says in str(refused.value)
    assert refused.value.quantity == quantity


def test_the_ends_of_what_is_one() -> None:
    for change in ({"name": "x" * 60}, {"low": 0.0}, {"high": 1.0}, {"orientation": -10.0}):
        dataclasses.replace(ONE, **change)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="name"):
        Grating("", 4e-3, "period")


def test_lengths_follow_from_what_the_length_means() -> None:
    groove = dataclasses.replace(ONE, spatial_period=3e-3, period_means="groove width")
    for one in (ONE, groove):
        assert one.period == pytest.approx(4e-3)
        assert one.groove_width == pytest.approx(3e-3)
    real = Grating("a", 3e-3, "groove width", ridge_share=0.25)
    assert real.groove_width == pytest.approx(3e-3)
    assert ONE.friction_depth == pytest.approx(0.3)
    assert dataclasses.replace(ONE, waveform="constant").friction_depth == 0.0


def test_a_sine_swings_between_its_ends_and_a_square_has_its_share_of_ridge() -> None:
    x = (np.arange(400) + 0.5) * 4e-3 / 400
    square = np.array([float(ONE.surface()(at, 0.0, 0.0, 0.0)) for at in x])
    assert set(np.round(square, 12)) == {0.6, 0.9}
    assert np.mean(square > 0.75) == pytest.approx(0.25, abs=0.005)
    sine = dataclasses.replace(ONE, waveform="sine", ridge_share=0.5).surface()
    values = np.array([float(sine(at, 0.0, 0.0, 0.0)) for at in x])
    assert (values.min(), values.max()) == pytest.approx((0.6, 0.9), abs=1e-4)
    assert values.mean() == pytest.approx(0.75)
    assert float(sine(x[7] + 4e-3, 0.3, 0.0, 1.0)) == pytest.approx(values[7])
    flat = dataclasses.replace(ONE, waveform="constant").surface()
    assert float(flat(1e-3, 0.0, 0.0, 0.0)) == 0.9


def test_a_texture_takes_the_place_of_the_grating(tmp_path: Path) -> None:
    file = tmp_path / "t.toml"
    with pytest.raises(ConfigError):
        dataclasses.replace(ONE, texture=str(file)).surface()
    from squeezefilm.physics.texture_files.texture_file import load_texture

    named = dataclasses.replace(ONE, texture="bump")
    assert named.surface() == load_texture("bump").texture
    # What it stands for stays what was said.
    assert named.period == ONE.period


def test_whatever_is_varied_what_it_matches_is_no_longer_right() -> None:
    named = dataclasses.replace(ONE, matches="4 mm")
    turned = named.varied("b", "orientation", 0.3)
    assert (turned.name, turned.orientation, turned.matches) == ("b", 0.3, "")
    deeper = named.varied("c", "friction_depth", 0.5)
    assert (deeper.low, deeper.high, deeper.matches) == (pytest.approx(0.4), 0.9, "")
    wider = named.varied("d", "ridge_share", 0.5)
    assert (wider.ridge_share, wider.amount("ridge_share")) == (0.5, 0.5)
    assert ONE.amount("orientation") == 0.0
    assert ONE.amount("spatial_period") == 4e-3


def test_crossed_gratings_have_ridges_where_both_have_one() -> None:
    one = Stimulus("checks", 4e-3, "groove width", crossed_period=1e-3, ridge_share=0.5, low=0.6)
    assert (one.period, one.second_period) == pytest.approx((8e-3, 2e-3))
    x, y = np.meshgrid(np.linspace(0, 0.016, 33)[:-1] + 1e-5, np.linspace(0, 4e-3, 17)[:-1] + 1e-5)
    found = one.surface()(x, y, 0.1, 0.0)
    both = ((x / 8e-3) % 1 < 0.5) & ((y / 2e-3) % 1 < 0.5)
    assert np.array_equal(found, np.where(both, 1.0, 0.6))
    assert one.kind == "crossed square gratings"
    turned = dataclasses.replace(one, orientation=np.pi / 2).surface()
    assert np.allclose(turned(-y, x, 0.1, 0.0), found)


def test_a_shape_has_no_period_and_low_and_high_are_its_friction() -> None:
    one = Stimulus("band", pattern=Band(0.01, 0.02), low=0.5, high=0.8)
    assert np.isnan([one.period, one.groove_width, one.amount("spatial_period")]).all()
    assert one.amount("friction_depth") == pytest.approx(0.3)
    assert one.surface()(np.array([0.005, 0.015]), 0.0, 0.1, 0.0).tolist() == [0.5, 0.8]
    deeper = one.varied("deeper", "friction_depth", 0.4)
    assert deeper.low == pytest.approx(0.4)
    assert np.isnan(Stimulus("map", texture="island-map").amount("friction_depth"))


def test_two_names_of_one_surface_have_one_identity() -> None:
    a = Stimulus("a", pattern=Band(0.01, 0.02))
    assert a.surface_sha256 == dataclasses.replace(a, name="b").surface_sha256
    assert a.surface_sha256 != dataclasses.replace(a, low=0.71).surface_sha256


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"spatial_period": 4e-3}, 'add period_means = "period"'),
        ({"crossed_period": 4e-3}, "nothing that it crosses"),
        ({"pattern": Band(0.0, 0.01), "texture": "bump"}, "a pattern and a texture"),
        (
            {"pattern": Band(0.0, 0.01), "spatial_period": 4e-3, "period_means": "period"},
            "a pattern and a spatial_period",
        ),
        ({}, "says no surface"),
    ],
)
def test_a_surface_said_twice_or_not_at_all(given: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        Stimulus("one", **given)
