"""Percepts of virtual and real gratings, through the whole chain and the same channels.

Virtual: texture → loop (sensor, envelope, compensation) → friction under a finite contact that also
slides over the standing wave → tangential stretch of the skin → channels. Real: ridges and grooves
→ indentation of the skin into the grooves → channels. The friction of real ridges is left out.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.perception.senses import (
    SETTLING,
    SPACING,
    Candidates,
    Evidence,
    candidates,
    channel_gains,
    evidence,
    line_amplitudes,
)
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, SensorModel
from squeezefilm.physics.render.motion.stroke import FingerPath, MinimumJerkStroke
from squeezefilm.physics.texture_files.texture_file import TextureFile

if TYPE_CHECKING:
    from squeezefilm.physics.chain.rendered_texture import RenderAnalysis

_CONTROL_RATE: si.Hertz = 9.6e3
_SEED = 0
_FEWEST_STEPS = 64


@dataclass(frozen=True, slots=True)
class Apparatus:
    """Apparatus by which a display is run while people feel it.

    Args:
        sensor: that follows the finger; the default is what the paper used, a transducer tied to
            it, with assumed numbers.
        compensation: "none", "inverse" or "preview".
        braking: whether the drive may invert the carrier's phase.
        wave: "felt", "ignored" or "compensated": the standing wave's nodes.
    """

    sensor: SensorModel = LVDT_10_KHZ
    compensation: str = "none"
    braking: bool = False
    wave: str = "felt"


@dataclass(frozen=True, slots=True, eq=False)
class Percept:
    """Percept of a surface by one finger: `evidence` by period and the `candidates` in it.

    `mean_displacement` (m) of the skin is what masks.
    """

    evidence: Evidence
    candidates: Candidates
    mean_displacement: si.Metre


def percept(
    display: Display,
    stimulus: Stimulus,
    observer: Observer,
    finger: FingerClass,
    apparatus: Apparatus | None = None,
) -> tuple[Percept, RenderAnalysis]:
    """Percept of a virtual grating on a display by a finger, and how it was rendered.

    The lateral stretch of the skin over the way, from 2 mm after each turn on. Raises as
    `rendered`.
    """
    surface = TextureFile(stimulus.surface(), stimulus.name)
    played = rendered(display, surface, finger, exploration(observer, finger), apparatus)
    force = played.force
    # The skin trails the bone: its stretch is against the motion, there and back.
    passes = along_way(force.bone_position, force.stretch, observer, (-1.0, 1.0))
    speed = np.gradient(force.bone_position, force.time_step)
    speeds = along_way(force.bone_position, speed, observer, (1.0, -1.0))
    mean = abs(float(np.mean(passes)))
    gains = channel_gains(observer, np.maximum(speeds, 0.0))
    heard = evidence(observer, line_amplitudes(passes), gains, mean)
    return Percept(heard, candidates(observer, heard), mean), played


def grating_percept(grating: Grating, observer: Observer, finger: FingerClass) -> Percept:
    """Percept of a real grating by a finger, with the same exploration and channels."""
    stroke = exploration(observer, finger)
    way: si.MetreArray = np.arange(SETTLING, observer.stroke_length, SPACING)
    pressure = finger.normal_force / finger.contact_length**2
    depth = indentation(grating, pressure, observer.skin_modulus)
    # Grooves from 0 to groove_width of each period, edges shared between samples.
    profile = depth * _share_in_groove(way, grating)
    fine = np.linspace(0.0, stroke.pass_duration, 4001)
    place = stroke.position(np.minimum(fine, stroke.pass_duration))
    speed = np.interp(way, place, np.gradient(place, fine))
    heard = evidence(
        observer,
        line_amplitudes(profile[None, :]),
        channel_gains(observer, speed),
        0.5 * depth,
        grating.period,
        grating.groove_width,
    )
    return Percept(heard, candidates(observer, heard), 0.5 * depth)


def indentation(grating: Grating, pressure: si.Pascal, modulus: si.Pascal) -> si.Metre:
    """Depth to which the skin bulges into the grooves (m): p g/E*, at most the ridge's height.

    The opening of a plane crack of width g under a pressure p (Pa) in a half-space of plane-strain
    modulus E* (Pa): a slit between two punches, small depths.
    """
    si.require("pressure", pressure, si.Unit("Pa"), above=0.0)
    si.require("modulus", modulus, si.Unit("Pa"), above=0.0)
    return min(grating.ridge_height, pressure * grating.groove_width / modulus)


def exploration(observer: Observer, finger: FingerClass) -> MinimumJerkStroke:
    """The strokes with which a finger explores any surface."""
    return MinimumJerkStroke(
        observer.stroke_length, observer.stroke_length / finger.speed, observer.passes
    )


def rendered(
    display: Display,
    surface: TextureFile,
    finger: FingerClass,
    motion: MinimumJerkStroke | FingerPath,
    apparatus: Apparatus | None = None,
) -> RenderAnalysis:
    """A surface as a display renders it under a finger in motion. The sensor's noise has a fixed
    seed. Raises as `render_texture` does."""
    # What was felt before is read from disk, and needs neither plates nor loop.
    from squeezefilm.physics.chain.rendered_texture import render_texture

    run = apparatus or Apparatus()
    under = dataclasses.replace(
        display.finger,
        contact_length=finger.contact_length,
        ridge_angle=finger.ridge_angle,
        moisture=finger.moisture,
        normal_force=finger.normal_force,
    )
    return render_texture(
        dataclasses.replace(display, finger=under),
        surface,
        motion,
        normal_force=finger.normal_force,
        sensor=run.sensor,
        compensation=run.compensation,
        braking=run.braking,
        wave=run.wave,
        control_rate=_CONTROL_RATE,
        seed=_SEED,
    )


def _share_in_groove(way: si.MetreArray, grating: Grating) -> si.MetreArray:
    """Share of the sample about each place that lies over a groove (1)."""

    def under(x: si.MetreArray) -> si.MetreArray:
        whole = np.floor(x / grating.period)
        rest = np.minimum(x - whole * grating.period, grating.groove_width)
        covered: si.MetreArray = whole * grating.groove_width + rest
        return covered

    share: si.MetreArray = (under(way + SPACING / 2) - under(way - SPACING / 2)) / SPACING
    return share


def along_way(
    way: si.MetreArray, values: si.FloatArray, observer: Observer, forth: tuple[float, float]
) -> si.FloatArray:
    """Values of each control step on an even way, shape (passes, samples).

    Args:
        way: place of the finger at each step (m), shape (steps,).
        values: at each step, shape (steps,).
        observer: whose exploration it is.
        forth: signs that values take in passes there and in passes back.
    """
    even: si.MetreArray = np.arange(SETTLING, observer.stroke_length, SPACING)
    per_pass = (way.size - 1) / observer.passes
    if per_pass < _FEWEST_STEPS:
        raise InputError(
            f"a pass of {per_pass:.0f} control steps shows no texture; move more slowly"
        )
    passes = []
    for number in range(observer.passes):
        rows = slice(math.ceil(number * per_pass), math.floor((number + 1) * per_pass) + 1)
        back = number % 2
        here = observer.stroke_length - way[rows] if back else way[rows]
        passes.append(interpolated(even, here, forth[back] * values[rows]))
    return np.array(passes)


def interpolated(even: si.MetreArray, way: si.MetreArray, values: si.FloatArray) -> si.FloatArray:
    """Values that were met along a `way` (m), at `even` places of it (m): where the way goes on,
    for a place that is met again says nothing new."""
    rising = np.concatenate([[True], np.diff(np.maximum.accumulate(way)) > 0.0])
    return np.asarray(np.interp(even, way[rising], values[rising]))


_FAINTEST = 0.05
"""Evidence (d′) below which a period is as blurred as at this one."""


@dataclass(frozen=True, slots=True, eq=False)
class Perceived:
    """Perceived rhythms on trials; arrays of one shape.

    Attributes:
        log_period: natural logarithm of the period perceived (of m).
        strength: evidence of the rhythm perceived, noise included (1).
        felt: whether that passes the observer's criterion.
    """

    log_period: si.FloatArray
    strength: si.DimensionlessArray
    felt: NDArray[np.bool_]


def perceived(
    surface: Candidates,
    observer: Observer,
    skill: si.DimensionlessArray,
    spread: si.DimensionlessArray,
    noise: si.FloatArray,
    blur: si.FloatArray,
) -> Perceived:
    """The strongest of a surface's candidate rhythms, and the period that it seems to have.

    The evidence of each candidate gets noise of standard deviation `skill`; the strongest is
    perceived, with σ √(1 + 1/d′²) `skill` in the logarithm of its period.

    Args:
        surface: candidates, shape (…, candidates).
        observer: whose criterion.
        skill: by what noise is more than a practised person's (1), shape (…).
        spread: σ of a clear rhythm's ln period (1), shape (…).
        noise, blur: standard normal numbers, shapes (…, candidates) and (…).
    """
    heard = surface.d_prime + skill[..., None] * noise
    best = np.argmax(heard, axis=-1)[..., None]
    strength, period, d_prime = (
        np.take_along_axis(of_rhythms, best, -1)[..., 0]
        for of_rhythms in (heard, surface.period, surface.d_prime)
    )
    felt = strength > observer.detection_criterion
    clear = np.where(felt, np.maximum(d_prime, _FAINTEST), np.inf)
    wide = spread * skill * np.sqrt(1.0 + 1.0 / clear**2)
    return Perceived(np.log(period) + wide * blur, strength, felt)


def perceived_anew(
    surface: Candidates,
    observer: Observer,
    skill: si.DimensionlessArray,
    spread: si.DimensionlessArray,
    random: np.random.Generator,
    drawn: int,
) -> Perceived:
    """Perceived rhythm, with noise drawn anew; `surface` has shape (people, …, candidates). The
    noise of `drawn` people is drawn, so that nobody depends on how many there are."""
    count, *shape = surface.period.shape
    noise = random.standard_normal((drawn, *shape))[:count]
    blur = random.standard_normal((drawn, *shape[:-1]))[:count]
    return perceived(surface, observer, skill, spread, noise, blur)
