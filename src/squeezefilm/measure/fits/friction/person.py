"""Choice of a display's finger: a new person's, the mean of people, or this person's."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.distributions import LogNormal
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.friction.friction_scores import nearest_scale
from squeezefilm.measure.recordings.kinds import FrictionCurve
from squeezefilm.measure.recordings.read import read_recording
from squeezefilm.physics.chain.friction import FrictionLaw
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.contact.finger.fingertip import FASTEST, MEAN_SPREAD, SLOWEST
from squeezefilm.physics.display import DECAY_LENGTH, Display, NamedDisplay, load_display

_LENGTHS = np.geomspace(0.3e-6, 100e-6, 120)
# Of a curve's points, left out in turn: neighbours err alike.
_BLOCKS = 5


@dataclass(frozen=True)
class PersonFit:
    """The decay length of a person (m) with its relative standard error, the friction at rest in
    the curve's unit, and the root mean square of what is left over the friction at rest."""

    decay_length: si.Metre
    relative_error: si.Dimensionless
    friction_at_rest: float
    left: si.Dimensionless


@si.checked_numbers
def with_decay_length(law: FrictionLaw, length: Annotated[si.Metre, si.Above(0)]) -> FrictionLaw:
    """The law of a finger whose decay length is another (m), whatever the speed."""
    finger = dataclasses.replace(law.finger, contact_decay_length=length, decay_speed_exponent=0.0)
    return dataclasses.replace(law, finger=finger)


@si.checked_numbers
def fitted_person(curve: FrictionCurve, law: FrictionLaw) -> PersonFit:
    """The decay length and friction at rest that are nearest to a curve by least squares, at the
    law's force and speed.

    The error is a jackknife over five stretches of the curve. Range: lengths from 0.3 to 100 µm, an
    even wave or the law's own place. Raises `InputError` for fewer than six points, and for a curve
    that falls as no length in that range has it.
    """
    amplitude, friction = curve.vibration_amplitude, curve.friction
    if friction.size <= _BLOCKS:
        raise InputError(
            f"a person's curve has {friction.size} points, too few for its two numbers; "
            f"measure at {_BLOCKS + 1} amplitudes or more",
            quantity="finger",
        )
    known = np.array(
        [with_decay_length(law, float(length)).curve(amplitude) for length in _LENGTHS]
    )
    length, rest, left = _nearest(law, amplitude, friction, known)
    if not 1.02 * _LENGTHS[0] < length < 0.98 * _LENGTHS[-1]:
        raise InputError(
            "a person's curve falls too "
            + ("fast" if length < 1e-6 else "little")
            + " for any decay length from 0.3 to 100 µm; measure at more, or larger, amplitudes",
            quantity="finger",
        )
    parts = np.array_split(np.argsort(amplitude, kind="stable"), _BLOCKS)
    without = []
    for part in parts:
        kept = np.setdiff1d(np.arange(friction.size), part)
        without.append(_nearest(law, amplitude[kept], friction[kept], known[:, kept])[0])
    spread = np.log(without)
    error = math.sqrt((_BLOCKS - 1) * float(np.mean((spread - spread.mean()) ** 2)))
    return PersonFit(length, error, rest, left)


def _nearest(
    law: FrictionLaw,
    amplitude: si.MetreArray,
    friction: si.FloatArray,
    known: si.FloatArray,
) -> tuple[si.Metre, float, si.Dimensionless]:
    """Decay length, friction at rest and what is left; `known` are the laws of `_LENGTHS`."""

    def curve_of(length: float) -> si.FloatArray:
        return with_decay_length(law, length).curve(amplitude)

    length = nearest_scale(curve_of, _LENGTHS, known, friction)
    shape = curve_of(length)
    rest = float(shape @ friction / (shape @ shape))
    return length, rest, math.sqrt(np.mean((rest * shape - friction) ** 2)) / rest


@reads_text
def with_finger(
    display: NamedDisplay,
    finger: Annotated[str | Path, "new, mean, or a recording"] = "new",
) -> Display:
    """The display under another finger, which whatever draws a finger takes up.

    "new": a person of whom nothing is known, as described, or as people spread. "mean": the mean of
    people, whose length is known to the standard error of 14 people. A recording of this
    person's friction over the amplitude, as `measure` reads it: its decay length at the recording's
    own speed, with the fit's error; the recording's display, or this one, says how it was
    measured. What else differs between fingers (contact length, force, skin) stays as described.
    Raises `InputError` for another word, and for a recording that is no friction curve.
    """
    if finger == "new":
        return display
    own = display.finger
    if finger == "mean":
        spread = LogNormal(own.contact_decay_length, MEAN_SPREAD)
        why = "the mean of people: standard error over 14 of them"
        return _known(display, spread, why, own.decay_speed)
    if isinstance(finger, str) and not Path(finger).suffix:
        raise InputError(
            f"'{finger}' is no finger; allowed are new, mean, and a file with a friction curve",
            quantity="finger",
        )
    curve = read_recording(finger)
    if not isinstance(curve, FrictionCurve):
        raise InputError(
            f"{finger} holds no friction curve; record friction over the amplitude",
            quantity="finger",
        )
    measured = load_display(curve.display) if curve.display else display
    told = {name: getattr(curve, name) for name in ("normal_force", "speed", "frequency")}
    if any(np.size(value) > 1 for value in told.values() if value is not None):
        raise InputError(
            f"{finger} mixes forces, speeds or frequencies; give a recording of one condition",
            quantity="finger",
        )
    told = {name: None if value is None else float(value) for name, value in told.items()}
    law = predict(
        measured, vibration_amplitude=float(np.max(curve.vibration_amplitude)), **told
    ).law
    fit = fitted_person(curve, law)
    at = min(max(law.speed, SLOWEST), FASTEST)
    # A curve without any noise leaves its reading.
    spread = LogNormal(fit.decay_length, max(fit.relative_error, 0.01))
    why = f"fitted to {Path(finger).name}, {100 * fit.left:.1f} % of the friction at rest left"
    return _known(display, spread, why, at)


def _known(display: Display, spread: LogNormal, why: str, speed: si.MetrePerSecond) -> Display:
    """The display under a finger whose length at a speed (m/s) is known as `spread` has it (m)."""
    length = spread.median
    finger = dataclasses.replace(display.finger, contact_decay_length=length, decay_speed=speed)
    provenance = {**display.provenance, DECAY_LENGTH: Provenance(why, "derived", spread)}
    return dataclasses.replace(display, finger=finger, provenance=provenance)
