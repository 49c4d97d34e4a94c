"""A simulated participant's parameters: senses, uncertainty, exploration, and how people differ.

Read one with `load_observer`. Every value of a preset says where it is from; most are assumed. What
channels mask is fitted to detection thresholds; nothing is tuned to any table of answers.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import ReadBy
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.finger.fingertip import Moisture

TUNED_AT: si.MetrePerSecond = 0.05
"""Speed of the detection thresholds that channels are fitted to (`tools/threshold_fit.py`)."""
_MOST_FINGERS = 64
_FINGERS_STREAM = 71


@si.checked_numbers
@dataclass(frozen=True)
class SensoryChannel:
    """A kind of mechanoreceptor as a band-pass of skin displacement with a threshold.

    Args:
        name: like "RA".
        low, high: corner frequencies (Hz); `low` 0 passes slow changes too.
        threshold: amplitude (m, zero-to-peak) of a sine inside the band that has d′ = 1.
        spatial: whether a real grating is felt by its pattern in the skin (`spatial_sensitivity`)
            instead of by the vibration it makes.
        masking: noise of skin that slides, as a share of its mean displacement (1).
        speed_exponent: 1 for a channel that goes by the frequency, 0 for one that goes by the
            spatial period, and answers at every speed as at `TUNED_AT`; between for one that is
            partly tuned to either (1).

    Raises:
        InputError: a value outside its range.
    """

    name: str
    low: Annotated[si.Hertz, si.AtLeast(0.0)]
    high: Annotated[si.Hertz, si.Above("low")]
    threshold: Annotated[si.Metre, si.Above(0.0)]
    spatial: bool = False
    masking: Annotated[si.Dimensionless, si.AtLeast(0.0)] = 0.0
    speed_exponent: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)] = 1.0

    def noise(self, mean_displacement: si.MetreLike) -> si.MetreLike:
        """Amplitude (m, zero-to-peak) of a sine inside the band that has d′ = 1 on skin whose mean
        displacement is `mean_displacement` (m): threshold and masking add in squares."""
        return np.hypot(self.threshold, self.masking * np.abs(mean_displacement))

    def gain(self, period: si.MetreLike, speed: si.MetrePerSecondLike) -> si.DimensionlessLike:
        """Share of the amplitude that passes of a displacement of a period (m) along the way of a
        finger at a speed (m/s): second-order slopes on both sides of its band, 1/√2 at the corners.
        The shape is assumed."""
        tuned = TUNED_AT * (np.asarray(speed, dtype=float) / TUNED_AT) ** self.speed_exponent
        f = np.asarray(tuned / period)
        falling = 1.0 / np.sqrt(1.0 + (f / self.high) ** 4)
        if self.low == 0.0:
            return np.asarray(falling)
        rising = (f / self.low) ** 2
        return np.asarray(falling * rising / np.sqrt(1.0 + rising**2))


@si.checked_numbers
@dataclass(frozen=True)
class FingerClass:
    """A finger and how it moves: what differs between people before the senses."""

    contact_length: si.Metre
    ridge_angle: si.Radian
    moisture: Moisture
    normal_force: si.Newton
    speed: si.MetrePerSecond


@si.checked_numbers
@dataclass(frozen=True)
class Observer:
    """Everything a simulated participant is made of.

    A spread is the standard deviation of a logarithm over people.

    Args:
        name, title: what it is called.
        channels: of the skin.
        strength_weber_fraction: difference of two clear strengths, in parts of the weaker, that is
            told in 75 % of two-interval trials (1).
        period_weber_fraction: the same for spatial periods felt clearly (1).
        period_spread: of the period's Weber fraction.
        harmonic_weight: of each further harmonic when a rhythm is told from its lines (1).
        harmonics: heard together, the fundamental included.
        candidates: periods that compete for being the one perceived.
        detection_criterion: evidence (d′) below which nothing is felt, and the person guesses.
        lapse_rate: share of trials answered blindly (1), median over people.
        lapse_spread: of the lapse rate.
        learning_excess: by how much more uncertain a person begins (1).
        learning_trials: over which that falls by a factor e.
        contact_length, contact_spread: of the contact along the finger (m), and over people.
        contact_aspect: width of the contact over its length (1).
        finger_orientation: of the finger, from the direction of the stroke (rad).
        dry_share, moist_share: of people (1); the rest are normal.
        speed, speed_spread: mean speed of a stroke (m/s), and over people.
        normal_force, force_spread: (N), and over people.
        stroke_length, passes: of an exploration (m), each pass of least jerk.
        skin_modulus: plane-strain modulus of the pulp that bulges into grooves (Pa).
        finger_classes: fingers into which people fall; the chain is computed once for each.
        response_time, response_time_spread: of a decision without doubt (s), and over trials.
        doubt_time: more for a decision in full doubt (s).

    Raises:
        InputError: a value outside its range.
    """

    name: str
    title: str
    channels: tuple[SensoryChannel, ...]
    strength_weber_fraction: Annotated[si.Dimensionless, si.Above(0.0)]
    period_weber_fraction: Annotated[si.Dimensionless, si.Above(0.0)]
    period_spread: Annotated[si.Dimensionless, si.AtLeast(0.0)]
    harmonic_weight: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)]
    harmonics: Annotated[int, si.AtLeast(1), si.AtMost(20)]
    candidates: Annotated[int, si.AtLeast(1), si.AtMost(20)]
    detection_criterion: Annotated[si.Dimensionless, si.AtLeast(0.0)]
    lapse_rate: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)]
    lapse_spread: Annotated[si.Dimensionless, si.AtLeast(0.0)]
    learning_excess: Annotated[si.Dimensionless, si.AtLeast(0.0)]
    learning_trials: Annotated[si.Dimensionless, si.Above(0.0)]
    contact_length: Annotated[si.Metre, si.Above(0.0)]
    contact_spread: Annotated[si.Dimensionless, si.AtLeast(0.0)]
    contact_aspect: Annotated[si.Dimensionless, si.Above(0.0)]
    finger_orientation: Annotated[si.Radian, si.AtLeast(-4), si.AtMost(4)]
    dry_share: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)]
    moist_share: si.Dimensionless
    speed: Annotated[si.MetrePerSecond, si.Above(0.0)]
    speed_spread: Annotated[si.Dimensionless, si.AtLeast(0.0)]
    normal_force: Annotated[si.Newton, si.Above(0.0)]
    force_spread: Annotated[si.Dimensionless, si.AtLeast(0.0)]
    stroke_length: Annotated[si.Metre, si.Above(0.0)]
    passes: Annotated[int, si.AtLeast(1), si.AtMost(100)]
    skin_modulus: Annotated[si.Pascal, si.Above(0.0)]
    finger_classes: Annotated[int, si.AtLeast(1), si.AtMost(_MOST_FINGERS)]
    response_time: Annotated[si.Second, si.Above(0.0)]
    response_time_spread: Annotated[si.Dimensionless, si.AtLeast(0.0)]
    doubt_time: Annotated[si.Second, si.AtLeast(0.0)]
    provenance: Mapping[str, Provenance] = field(
        default_factory=dict, metadata={"loader": True}, compare=False, repr=False
    )

    def __post_init__(self) -> None:
        if not self.channels:
            raise InputError("channels is empty; give at least one", quantity="channels")
        si.require("moist_share", self.moist_share, at_least=0.0, at_most=1.0 - self.dry_share)

    @si.checked_numbers
    def median_finger(
        self, normal_force: Annotated[si.Newton, si.Above(0.0), si.AtMost(50.0)] | None = None
    ) -> FingerClass:
        """The finger of a person in the middle of all, pressing with a force (N) of its own if
        given. Raises `InputError` for a force out of range."""
        finger = dataclasses.replace(self, finger_classes=1).fingers()[0]
        if normal_force is None:
            return finger
        return dataclasses.replace(finger, normal_force=normal_force)

    def fingers(self) -> tuple[FingerClass, ...]:
        """The finger classes: a Latin hypercube over what people differ in, always the same.

        A single class is the median finger.
        """
        from scipy.special import ndtri

        count = self.finger_classes
        random = np.random.default_rng([_FINGERS_STREAM, count])
        middle = (np.arange(count) + 0.5) / count
        length, wet, force, speed = (random.permutation(middle) for _ in range(4))
        angle = self.finger_orientation
        along = np.hypot(np.cos(angle), self.contact_aspect * np.sin(angle))
        return tuple(
            FingerClass(
                contact_length=float(
                    self.contact_length * along * np.exp(self.contact_spread * ndtri(length[i]))
                ),
                ridge_angle=angle,
                moisture=self._moisture(float(wet[i])),
                normal_force=float(self.normal_force * np.exp(self.force_spread * ndtri(force[i]))),
                speed=float(self.speed * np.exp(self.speed_spread * ndtri(speed[i]))),
            )
            for i in range(count)
        )

    def _moisture(self, share: si.Dimensionless) -> Moisture:
        if share < self.dry_share:
            return "dry"
        return "moist" if share >= 1.0 - self.moist_share else "normal"


def load_observer(name_or_path: str | Path = "fingertip") -> Observer:
    """The observer of a preset's name or of a TOML file. Raises `ConfigError` if it can't be."""
    from squeezefilm.core import config, presets

    return config.load(Observer, presets.resolve(name_or_path, "observer"))


NamedObserver = Annotated[Observer, ReadBy(load_observer)]
"""An observer, or in its place the name of a preset or the path of a file (see `reads_text`)."""
