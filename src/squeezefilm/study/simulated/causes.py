"""Causes of confusion of a stimulus: what the chain makes of it under a finger, in numbers."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.perception.percepts import Percept, along_way
from squeezefilm.physics.perception.senses import line_amplitudes, line_periods
from squeezefilm.physics.perception.stimuli import Stimulus

if TYPE_CHECKING:
    from squeezefilm.physics.chain.rendered_texture import RenderAnalysis
    from squeezefilm.physics.perception.path_percepts import RunPercept


@dataclass(frozen=True, slots=True)
class Causes:
    """Causes against a stimulus being recognised (over several fingers: medians).

    Attributes:
        texture_frequency: at which it passes the finger at mean speed (Hz).
        envelope_bandwidth: at which the display's envelope has lost 3 dB (Hz).
        contrast_kept: line of the friction rendered over that asked for, at the period (1); the
            standing wave's ripple may raise it above 1. NaN without a contrast asked for.
        lag_over_period: way of the finger during the sensor's latency and the envelope's time
            constant, over the period (1).
        contact_over_period: length of the contact over the period (1).
        ripple_share: friction's standard deviation that the standing wave adds over that and the
            rest together (1); 0 where the wave is ignored, NaN where it is compensated.
        mean_displacement: of the skin (m).
        d_prime: evidence for the rhythm of the period (1).
        clearest_period: most evident rhythm (m).
        clearest_d_prime: its evidence (1).
    """

    texture_frequency: si.Hertz
    envelope_bandwidth: si.Hertz
    contrast_kept: si.Dimensionless
    lag_over_period: si.Dimensionless
    contact_over_period: si.Dimensionless
    ripple_share: si.Dimensionless
    mean_displacement: si.Metre
    d_prime: si.Dimensionless
    clearest_period: si.Metre
    clearest_d_prime: si.Dimensionless


def median_causes(of_fingers: tuple[Causes, ...]) -> Causes:
    """The medians over several fingers."""
    return Causes(
        **{
            field.name: float(np.median([getattr(finger, field.name) for finger in of_fingers]))
            for field in dataclasses.fields(Causes)
        }
    )


def causes(
    stimulus: Stimulus,
    found: Percept,
    played: RenderAnalysis,
    observer: Observer,
    finger: FingerClass,
) -> Causes:
    """The numbers of one percept of a virtual grating; `played` is its rendering."""
    loop = played.stroke
    rendered, asked = (
        _line(loop.position, values, observer, stimulus.period)
        for values in (loop.relative_friction_rendered, played.asked)
    )
    return _causes(stimulus, found, played, finger, rendered, asked)


def free_causes(
    stimulus: Stimulus, runs: RunPercept, played: RenderAnalysis, finger: FingerClass
) -> Causes:
    """The same of the runs of a free exploration in one direction; `contrast_kept` is of the whole
    swing of friction, for a shape has no line of its own."""
    return _causes(stimulus, runs.percept, played, finger, runs.felt_swing, runs.asked_swing)


def _causes(
    stimulus: Stimulus,
    found: Percept,
    played: RenderAnalysis,
    finger: FingerClass,
    rendered: si.Dimensionless,
    asked: si.Dimensionless,
) -> Causes:
    period, sensor = stimulus.period, played.stroke.sensor
    latency = 0.0 if sensor is None else sensor.latency
    lag = (latency + played.time_constant) * finger.speed
    return Causes(
        texture_frequency=finger.speed / period,
        envelope_bandwidth=1.0 / (2.0 * math.pi * played.time_constant),
        contrast_kept=rendered / asked if asked > 1e-6 else float("nan"),
        lag_over_period=lag / period,
        contact_over_period=finger.contact_length / period,
        ripple_share=_ripple_share(played),
        mean_displacement=found.mean_displacement,
        d_prime=found.evidence.at(period),
        clearest_period=float(found.candidates.period[0]),
        clearest_d_prime=max(float(found.candidates.d_prime[0]), 0.0),
    )


def _line(way: si.FloatArray, values: si.FloatArray, observer: Observer, period: si.Metre) -> float:
    periods = line_periods()
    # What lies beside the period is all that is asked.
    at = int(np.searchsorted(periods, period))
    near = slice(max(at - 1, 0), at + 1)
    lines = line_amplitudes(along_way(way, values, observer, (1.0, 1.0)), near)
    return float(np.interp(period, periods[near], lines))


def _ripple_share(played: RenderAnalysis) -> si.Dimensionless:
    """Contribution of the wave to the friction that the same amplitudes make over an antinode."""
    # A compensating renderer's inverse is of the driven amplitude, so there is no plain friction.
    if played.wave != "felt":
        return 0.0 if played.wave == "ignored" else float("nan")
    plain = played.prediction.friction(played.stroke.amplitude, played.finger.speed)
    added = float(np.std(played.stroke.relative_friction_rendered - plain))
    rest = float(np.std(plain))
    return added / (added + rest) if added + rest > 1e-9 else 0.0
