"""Fit the masking of the observer's channels to published thresholds of friction modulation.

    python tools/threshold_fit.py

prints the two numbers fitted (the share of the mean stretch of sliding skin that masks the slow
channels, and the fast one), measured and computed thresholds, each threshold predicted from the
others, and what the published method makes of a simulated person whose d′ is 1.

Two intervals, three down and one up, the mean of the last six trials, the larger of two directions,
the median of fifteen people; start, steps and the number of trials are not published: assumed.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from scipy.optimize import minimize
from scipy.special import ndtr

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.measure.recordings.kinds import DetectionThresholds
from squeezefilm.measure.recordings.read import read_recording
from squeezefilm.physics.perception.observer import Observer, load_observer
from squeezefilm.study.adaptive.staircase import Staircase, StaircaseRule
from squeezefilm.validation.populations import METHOD_RATIO, detection_medians

PUBLISHED = "bernard2020-detection.toml"
RULE = StaircaseRule(8.0, math.log(2.0), math.log(1.12), down_after=3, axis="log", most_trials=50)


def published() -> DetectionThresholds:
    """The medians that come with the program."""
    found = read_recording(presets.friction_folder() / PUBLISHED)
    assert isinstance(found, DetectionThresholds)
    return found


def method_ratio(
    rule: StaircaseRule = RULE,
    *,
    people: int = 400,
    spread: si.Dimensionless = 0.0,
    lapse_rate: si.Dimensionless = 0.02,
    seed: int = 45,
) -> tuple[float, float]:
    """What the published method gives over the amplitude with d′ = 1: the median over people, and
    the standard deviation of its logarithm. `spread` is that of ln threshold over people."""
    random, found = np.random.default_rng(seed), []
    for threshold in np.exp(spread * random.standard_normal(people)):
        directions = []
        for _ in range(2):
            stairs = Staircase(rule)
            while not stairs.finished:
                shown = stairs.next_stimulus()
                right = ndtr(shown / threshold / math.sqrt(2))
                stairs.update(shown, random.random() < lapse_rate / 2 + (1 - lapse_rate) * right)
            directions.append(np.mean([trial.intensity for trial in stairs.trials[-6:]]))
        found.append(max(directions))
    return float(np.median(found)), float(np.std(np.log(found)))


def with_masking(observer: Observer, slow: float, fast: float) -> Observer:
    """The observer whose fastest channel, and all others, are masked by these shares (1)."""
    *others, last = observer.channels
    channels = [dataclasses.replace(channel, masking=slow) for channel in others]
    channels.append(dataclasses.replace(last, masking=fast))
    return dataclasses.replace(observer, channels=tuple(channels))


def fitted(
    observer: Observer, measured: DetectionThresholds, left_out: int | None = None
) -> Observer:
    """The observer with the two shares that come nearest to the medians in their logarithms."""
    kept = np.arange(measured.period.size) != left_out
    logs = np.log(measured.amplitude[kept])

    def misfit(shares: si.FloatArray) -> float:
        made = detection_medians(with_masking(observer, *np.exp(shares)), measured)
        return float(np.sum((np.log(made[kept]) - logs) ** 2))

    best = minimize(misfit, np.log([0.15, 0.005]), method="Nelder-Mead")
    return with_masking(observer, *(float(f"{x:.3g}") for x in np.exp(best.x)))


def main() -> None:
    """Print all of it."""
    ratio, spread = method_ratio()
    print(
        f"published method over d' = 1: {ratio:.3f} (taken: {METHOD_RATIO}); of one ±{spread:.2f}"
    )
    for words, rule in (
        ("30 trials", dataclasses.replace(RULE, most_trials=30)),
        ("steps of 25 %", dataclasses.replace(RULE, smallest_step=math.log(1.25))),
        ("start at 3", dataclasses.replace(RULE, start=3.0)),
    ):
        print(f"  with {words}: {method_ratio(rule)[0]:.3f}")
    print(f"  with people who differ by 0.4: {method_ratio(spread=0.4)[0]:.3f}")
    measured, observer = published(), load_observer()
    best = fitted(observer, measured)
    slow, fast = best.channels[0].masking, best.channels[-1].masking
    print(f"masking: slow {slow:g}, fast {fast:g}")
    computed = detection_medians(best, measured)
    for k, period in enumerate(measured.period):
        alone, there = detection_medians(fitted(observer, measured, k), measured)[k], computed[k]
        median = measured.amplitude[k]
        print(
            f"{1e3 * period:6g} mm, {measured.speed / period:5.3g} Hz: measured {median:.5f}, "
            f"computed {there:.5f}, ratio {there / median:.2f}, left out {alone / median:.2f}"
        )


if __name__ == "__main__":
    main()
