"""The numbers that say why a grating is or is not felt, by hand."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.study.simulated.felt_surfaces import _causes, _ripple_share

PLAIN = np.array([0.5, 0.7, 0.5, 0.7])


def played(wave: str = "felt", added: float = 0.3) -> Any:
    """A rendered stroke: the wave changes the plain friction to and fro, `added` in the mean."""
    ripple = added * np.array([1.0, 1.0, -1.0, -1.0])
    return SimpleNamespace(
        wave=wave,
        time_constant=2e-3,
        prediction=SimpleNamespace(friction=lambda amplitude, speed: speed * amplitude),
        stroke=SimpleNamespace(
            amplitude=PLAIN / 0.1,
            relative_friction_rendered=PLAIN + ripple,
            sensor=SimpleNamespace(latency=3e-3),
        ),
        finger=SimpleNamespace(speed=0.1),
    )


def test_the_wave_s_share_is_of_all_changes_of_friction() -> None:
    assert _ripple_share(played()) == pytest.approx(0.3 / (0.3 + 0.1))
    assert _ripple_share(played("ignored")) == 0.0
    assert math.isnan(_ripple_share(played("compensated")))
    still = played(added=0.0)
    still.stroke.amplitude = np.ones(4)
    still.stroke.relative_friction_rendered = np.full(4, 0.1)
    assert _ripple_share(still) == 0.0


def test_lengths_and_times_are_over_the_period() -> None:
    stimulus: Any = SimpleNamespace(period=2e-3)
    finger: Any = SimpleNamespace(speed=0.08, contact_length=9e-3)
    found: Any = SimpleNamespace(
        mean_displacement=4e-6,
        evidence=SimpleNamespace(at=lambda period: 1000 * period),
        candidates=SimpleNamespace(period=np.array([3e-3, 1e-3]), d_prime=np.array([5.0, 1.0])),
    )
    causes = _causes(stimulus, found, played(), finger, 0.2, 0.5)
    assert causes.texture_frequency == pytest.approx(40.0)
    assert causes.envelope_bandwidth == pytest.approx(1 / (2 * math.pi * 2e-3))
    assert causes.contrast_kept == pytest.approx(0.4)
    assert causes.lag_over_period == pytest.approx((3e-3 + 2e-3) * 0.08 / 2e-3)
    assert causes.contact_over_period == pytest.approx(4.5)
    assert causes.ripple_share == pytest.approx(0.75)
    assert (causes.mean_displacement, causes.d_prime) == (4e-6, 2.0)
    assert (causes.clearest_period, causes.clearest_d_prime) == (3e-3, 5.0)
    blind = played()
    blind.stroke.sensor = None
    found.candidates.d_prime = np.array([-0.5, -2.0])
    nothing = _causes(stimulus, found, blind, finger, 0.2, 1e-7)
    assert nothing.lag_over_period == pytest.approx(2e-3 * 0.08 / 2e-3)
    assert math.isnan(nothing.contrast_kept)
    assert nothing.clearest_d_prime == 0.0
