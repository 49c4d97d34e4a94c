"""What a path would have felt like, against geometry: angles, ridges, turned axes, the stroke."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.path_percepts import PathPercept, free_exploration, path_percept
from squeezefilm.physics.perception.percepts import Apparatus, Percept, exploration, percept
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.render.motion.stroke import FingerPath
from squeezefilm.physics.texture_files.texture_file import TextureFile

PLATE, OBSERVER = load_display("biet2008-plate"), load_observer()
FINGER = OBSERVER.median_finger()
GRATING = Stimulus("4 mm", 4e-3, "period")
# The standing wave belongs to the plate and not to the texture: it turns with neither.
NO_WAVE = Apparatus(wave="ignored")


def _stroke(angle: float = 0.0, rate: float = 1000.0) -> FingerPath:
    """The simulated stroke, turned about the origin."""
    motion = exploration(OBSERVER, FINGER)
    t = np.minimum(np.arange(round(motion.duration * rate) + 1) / rate, motion.duration)
    x = motion.position(t)
    return FingerPath(t, x * math.cos(angle), x * math.sin(angle))


@functools.cache
def _felt(
    angle: float, orientation: float = 0.0, wave: bool = False, rate: float = 1000.0
) -> PathPercept:
    stimulus = Stimulus("4 mm", 4e-3, "period", orientation=orientation)
    run = Apparatus() if wave else NO_WAVE
    surface = TextureFile(stimulus.surface(), stimulus.name)
    return path_percept(PLATE, surface, OBSERVER, FINGER, [_stroke(angle, rate)], run)


def _clearest(felt: Percept) -> tuple[float, float]:
    """Period (m) and evidence of the most evident rhythm."""
    return float(felt.candidates.period[0]), float(felt.candidates.d_prime[0])


@pytest.mark.parametrize(("rate", "within"), [(9600.0, 1e-6), (100.0, 2e-3)])
def test_the_simulated_stroke_as_a_path_is_todays_percept(rate: float, within: float) -> None:
    today, _ = percept(PLATE, GRATING, OBSERVER, FINGER)
    found = _felt(0.0, wave=True, rate=rate)
    assert found.across is None
    assert found.along is not None
    here = found.along
    # Where along its peak a wave that is not felt is faintest, a coarse path cannot tell.
    there = today.candidates.d_prime > OBSERVER.detection_criterion
    assert there.any()
    assert here.candidates.period[there] == pytest.approx(today.candidates.period[there])
    assert here.candidates.d_prime[there] == pytest.approx(
        today.candidates.d_prime[there], rel=within
    )
    assert here.mean_displacement == pytest.approx(today.mean_displacement, rel=within)


@pytest.mark.parametrize(
    "degrees", [30, 60, *(pytest.param(one, marks=pytest.mark.slow) for one in (15, 45))]
)
def test_a_slanted_path_feels_the_period_over_the_cosine(degrees: int) -> None:
    found = _felt(math.radians(degrees))
    one = found.along if degrees <= 45 else found.across
    assert one is not None
    period, d_prime = _clearest(one)
    assert period == pytest.approx(4e-3 / math.cos(math.radians(degrees)), rel=5e-3)
    assert d_prime > OBSERVER.detection_criterion


def test_along_the_ridges_nothing_is_felt() -> None:
    found = _felt(math.pi / 2)
    assert found.along is None
    assert found.across is not None
    assert np.all(np.isneginf(found.across.candidates.d_prime))


@pytest.mark.parametrize("degrees", [20, 40])
def test_turning_the_path_and_the_grating_together_changes_little(degrees: int) -> None:
    # What differs is the sensor's noise along the path, and the turns, which are cut off.
    straight, turned = _felt(0.0).along, _felt(math.radians(degrees), math.radians(degrees)).along
    assert straight is not None
    assert turned is not None
    (period, d_prime), (expected, evidence) = _clearest(turned), _clearest(straight)
    assert period == pytest.approx(expected, rel=5e-3)
    assert d_prime == pytest.approx(evidence, rel=0.03)


def test_crossed_gratings_are_felt_each_in_its_own_direction() -> None:
    crossed = Stimulus("checks", 4e-3, "period", crossed_period=8e-3)
    path = free_exploration(OBSERVER, FINGER, (0.083, 0.049))
    surface = TextureFile(crossed.surface(), crossed.name)
    found = path_percept(PLATE, surface, OBSERVER, FINGER, [path], NO_WAVE)
    assert found.along is not None
    assert found.across is not None
    assert _clearest(found.along)[0] == pytest.approx(4e-3, rel=0.02)
    assert _clearest(found.across)[0] == pytest.approx(8e-3, rel=0.02)


def test_lifting_between_strokes_and_short_runs_change_nothing_that_is_felt() -> None:
    whole = _stroke()
    half = whole.time.size // 2
    parts = [
        FingerPath(whole.time[rows], whole.x[rows], whole.y[rows])
        for rows in (slice(0, half + 1), slice(half, None))
    ]
    surface = TextureFile(GRATING.surface(), GRATING.name)
    lifted = path_percept(PLATE, surface, OBSERVER, FINGER, parts, NO_WAVE).along
    together = _felt(0.0).along
    assert lifted is not None
    assert together is not None
    assert _clearest(lifted)[1] == pytest.approx(_clearest(together)[1], rel=0.02)


def test_a_path_without_a_run_is_refused_before_anything_is_told() -> None:
    tiny = FingerPath(np.array([0.0, 0.1]), np.array([0.0, 1e-3]), np.zeros(2))
    surface = TextureFile(GRATING.surface(), GRATING.name)
    with pytest.raises(InputError, match="no straight run of 4 mm"):
        path_percept(PLATE, surface, OBSERVER, FINGER, [tiny], NO_WAVE)
