"""A study's demands of a device: who it is, whether it is in order, to play, and to stop."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.stimuli import Stimulus


@dataclass(frozen=True)
class DeviceIdentity:
    """Identity of the device that presented a trial, so that its rows can be told apart.

    `device_sha256` is the hash of the display's description (`core.results.config_hash`),
    `calibration_sha256` that of the calibration in use; both are empty where there is none.
    """

    name: str
    device_sha256: str = ""
    calibration_sha256: str = ""


@dataclass(frozen=True)
class DeviceVerification:
    """A measurement of the device against what it should be, before or after a session.

    The tolerances are relative. A device that nothing can be measured of has `measurable = False`
    and says why in `remark`: that is recorded, and counts neither as passed nor as failed. Where
    a pickup was never calibrated `expected_amplitude` is NaN, and only the resonance is judged.

    Raises:
        InputError: a measured or expected value that is not above 0, or a tolerance outside 0…1.
    """

    amplitude: si.Metre = math.nan
    expected_amplitude: si.Metre = math.nan
    resonance_frequency: si.Hertz = math.nan
    expected_resonance_frequency: si.Hertz = math.nan
    amplitude_tolerance: si.Dimensionless = 0.1
    resonance_tolerance: si.Dimensionless = 0.01
    measurable: bool = True
    remark: str = ""

    def __post_init__(self) -> None:
        si.require("amplitude_tolerance", self.amplitude_tolerance, above=0.0, below=1.0)
        si.require("resonance_tolerance", self.resonance_tolerance, above=0.0, below=1.0)
        if self.measurable:
            metre, hertz = si.Unit("m"), si.Unit("Hz")
            if not (math.isnan(self.amplitude) and math.isnan(self.expected_amplitude)):
                si.require("expected_amplitude", self.expected_amplitude, metre, above=0.0)
            si.require(
                "expected_resonance_frequency", self.expected_resonance_frequency, hertz, above=0.0
            )

    @property
    def problems(self) -> tuple[str, ...]:
        """Sentences on what is off; none if all is within tolerance. What could not be read (NaN)
        is off."""
        if not self.measurable:
            return ()
        sentences = []
        for name, quantity, tolerance, unit in (
            ("amplitude", "amplitude", self.amplitude_tolerance, si.Unit("m")),
            ("resonance", "resonance_frequency", self.resonance_tolerance, si.Unit("Hz")),
        ):
            measured, expected = getattr(self, quantity), getattr(self, f"expected_{quantity}")
            # Written so that a NaN measured is off; one expected is nothing to compare with.
            if not math.isnan(expected) and not abs(measured - expected) <= tolerance * expected:
                sentences.append(
                    f"{name} is {si.format_quantity(measured, unit)}; it must be within "
                    f"{100 * tolerance:g} % of {si.format_quantity(expected, unit)}"
                )
        return tuple(sentences)

    @property
    def passed(self) -> bool:
        """True where nothing measured is off."""
        return not self.problems


@dataclass(frozen=True)
class TrialMotion:
    """Exploration of one trial by the finger; NaN where the device does not know.

    `trace` is a table's CSV text (`core.formats.traces.csv_text`) of the finger's path, empty if
    there is none; its metadata must not name the participant. `raw_trace` is the random name of a
    file that the device wrote into the study's folder of traces, empty if there is none. `touch` is
    the share of the time in which the finger touched. `began` and `ended` are when the device said
    that it plays, and that its output is at zero (s, `time.monotonic`). `unusable` says why what
    was played cannot be used; empty where it can.
    """

    path_length: si.Metre = math.nan
    mean_speed: si.MetrePerSecond = math.nan
    mean_normal_force: si.Newton = math.nan
    trace: str = ""
    raw_trace: str = ""
    touch: si.Dimensionless = math.nan
    began: si.Second = math.nan
    ended: si.Second = math.nan
    unusable: str = ""


class StudyDevice:
    """The seam between a study and what presents its surfaces: a device, its twin, or, where none
    of this is overridden, nothing: surfaces come by hand, or not at all."""

    def identity(self) -> DeviceIdentity:
        """Identity of the device; without one the name "none" and no hashes."""
        return DeviceIdentity("none")

    def verify_device(self) -> DeviceVerification:
        """Measure amplitude and resonance against what they should be. May take seconds."""
        return DeviceVerification(measurable=False, remark="no device: nothing was verified")

    def present(self, stimulus: Stimulus, seed: int) -> None:
        """Begin to play a surface; returns at once. Raises `SqueezefilmError` if it cannot."""

    def stop(self) -> TrialMotion:
        """Silence the device; returns how the finger explored since `present`, if it knows."""
        return TrialMotion()

    def halt(self) -> None:
        """Silence it now, from any thread; `stop` is still to be called."""

    def close(self) -> None:
        """Let it go."""


class NoDevice(StudyDevice):
    """Nothing that plays, and nothing to verify."""


class ByHand(StudyDevice):
    """Stand-in for a device: the experimenter puts each surface under the finger as told.

    Args:
        tell: where the experimenter reads it, and the participant does not.
    """

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell

    def present(self, stimulus: Stimulus, seed: int) -> None:
        """Say which surface is wanted."""
        what = stimulus.kind
        if not math.isnan(stimulus.period):
            what = f"period {si.format_quantity(stimulus.period, si.Unit('m'), 4)}"
        depth = f"{100 * stimulus.friction_depth:.3g} % change of friction"
        self._tell(f"put '{stimulus.name}' under the finger: {what}, {depth}")

    def stop(self) -> TrialMotion:
        """Say that it is to be taken away; nothing is known of the finger."""
        self._tell("take it away")
        return TrialMotion()
