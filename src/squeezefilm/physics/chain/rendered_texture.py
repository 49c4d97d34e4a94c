"""Results of `squeezefilm render`: a texture on a display under a finger, link by link.

texture → program → renderer along the motion (as a sensor has it, if there is one) → resonator
with the finger on it → friction by the display's law → tangential force → fidelity. The renderer
asks for the amplitude that a speed needs as the loop estimates it; what is felt is at the true one.
"""

from __future__ import annotations

import dataclasses
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar, cast

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import Result, stamp, to_json, values_of
from squeezefilm.physics.chain.pad_law import FrictionModel
from squeezefilm.physics.chain.pad_place import FacePlace
from squeezefilm.physics.chain.played_texture import (
    FingerMotion,
    PlayedTexture,
    lowered,
    require_on_display,
    require_on_image,
    single_period,
)
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.chain.standing_wave import (
    WAVES,
    UnderPad,
    Wave,
    at_largest_amplitude,
    resonance_with_finger,
)
from squeezefilm.physics.contact.sliding.march import Sliding, slide
from squeezefilm.physics.display import Display, NamedDisplay
from squeezefilm.physics.render.fidelity.rendered_stroke import RenderedStroke, rendered_stroke
from squeezefilm.physics.render.fidelity.report import (
    FidelityReport,
    fidelity_report,
    strongest_lines,
)
from squeezefilm.physics.render.motion.estimator import SensorModel, sensor_named
from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.program.renderer import Counters, render
from squeezefilm.physics.render.resonator.envelope import (
    COMPENSATIONS,
    Compensation,
    DrivenEnvelope,
    envelope_time_constant,
)
from squeezefilm.physics.texture_files.texture_file import NamedTexture, TextureFile
from squeezefilm.physics.texture_files.trajectories import Motion, NamedMotion

CONTROL_RATE: si.Hertz = 19.2e3
"""Rate of the loop (Hz): commands to which a converter of 192 kHz gives ten samples each."""


@dataclass(frozen=True, eq=False, repr=False)
class RenderAnalysis(Result):
    """A texture rendered on a display under a finger; arrays of shape (steps,).

    Attributes:
        display, texture, motion, prediction: the inputs, and the display at its voltage limit.
        played: the texture as the loop asked it.
        stroke: sensor, commands and envelope; its friction is the one felt, the wave included.
        finger: time and place of the finger.
        wave, factor: what was done about the standing wave, and the amplitude that the pad meets
            at each step over that where the display's law has its pad (1), the best place or an
            antinode of an even wave.
        asked: relative friction the texture asks for, whether it can be reached or not (1).
        counters: what the renderer met along the true motion.
        force: tangential force and skin motion along the way.
        fidelity: None where it cannot be judged, for the reason in `unjudged`.
    """

    display: Display
    texture: TextureFile
    motion: Motion
    prediction: Prediction
    played: PlayedTexture
    stroke: RenderedStroke
    finger: FingerMotion
    wave: Wave
    factor: si.DimensionlessArray
    asked: si.DimensionlessArray
    counters: Counters
    force: Sliding
    fidelity: FidelityReport | None
    unjudged: str | None
    seed: int
    _shown: ClassVar[str] = (
        "display.name texture.title stroke.compensation rms_error time_constant unjudged"
    )

    @property
    def rms_error(self) -> si.Dimensionless:
        """RMS over the stroke of the relative friction rendered minus the one asked for (1)."""
        miss = self.stroke.relative_friction_rendered - self.asked
        return float(np.sqrt(np.mean(miss**2)))

    @property
    def mean_speed(self) -> si.MetrePerSecond:
        """Mean speed of the finger over its way (m/s)."""
        return float(np.mean(np.abs(self.finger.speed)))

    @property
    def least_friction(self) -> si.Dimensionless:
        """The least relative friction that the display reaches at the finger's mean speed (1)."""
        return float(self.played.inverse.least_friction_at(self.mean_speed))

    @property
    def time_constant(self) -> si.Second:
        """Time constant of the resonator's envelope with the finger on it (s)."""
        return self.stroke.envelope.rise_time_constant

    def provenance(self) -> dict[str, Any]:
        """Version, hash of display, texture and motion, seed and time."""
        return stamp((self.display, self.texture, self.motion), self.seed)

    def columns(self) -> dict[str, si.FloatArray]:
        """Every step of the loop, units in the names."""
        stroke, finger, force = self.stroke, self.finger, self.force
        columns: dict[str, si.FloatArray] = {
            "time_s": stroke.time,
            "position_x_m": finger.x,
            "position_y_m": finger.y,
            "speed_m_per_s": finger.speed,
            "relative_friction_asked": self.asked,
            "relative_friction_rendered": stroke.relative_friction_rendered,
            "amplitude_wanted_m": stroke.wanted,
            "amplitude_commanded_m": stroke.command,
            "amplitude_m": stroke.amplitude,
            "wave_factor": self.factor,
            "tangential_force_N": force.friction_force,
            "sticking": force.sticking.astype(float),
        }
        if stroke.estimate is not None:
            columns["estimated_way_m"] = stroke.estimate.position
            columns["estimated_speed_m_per_s"] = stroke.estimate.speed
        return columns

    _table = columns

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values, which fidelity.json holds; keys carry units."""
        p, stroke, force = self.prediction, self.stroke, self.force
        judged = self.fidelity
        return {
            "display": self.display.name,
            "texture": self.texture.title or self.texture.texture.quantity,
            "surface": p.surface.name,
            **values_of(
                self,
                "texture.texture.quantity prediction.voltage prediction.normal_force mean_speed "
                "stroke.control_rate stroke.compensation stroke.envelope.braking wave "
                "force.stuck_share fidelity prediction.warnings",
            ),
            "finger": self.display.whose_finger,
            "place": p.place_summary(),
            "largest_amplitude_m": stroke.envelope.amplitude_limit,
            "least_relative_friction": self.least_friction,
            "friction_inverse_error": self.played.inverse.max_error,
            "resonance_frequency_Hz": resonance_with_finger(p)[1],
            "quality_factor": resonance_with_finger(p)[0],
            "envelope_time_constant_s": self.time_constant,
            "duration_s": float(stroke.time[-1]),
            "way_m": float(np.sum(np.abs(np.diff(self.finger.way)))),
            "sensor": None if stroke.sensor is None else stroke.sensor.name,
            "wave_least_factor": float(np.min(self.factor)),
            "wave_greatest_factor": float(np.max(self.factor)),
            "asked_friction_mean": float(np.mean(self.asked)),
            "asked_friction_rms_swing": float(np.std(self.asked)),
            "rendered_friction_mean": float(np.mean(stroke.relative_friction_rendered)),
            "rendered_friction_rms_swing": float(np.std(stroke.relative_friction_rendered)),
            "friction_rms_error": self.rms_error,
            "contrast_kept": judged and to_json(judged.contrast_kept),
            "spatial_frequency_per_m": judged and to_json(judged.spatial_frequency),
            "lag_m": judged and to_json(judged.lag),
            "lag_s": judged and to_json(judged.lag_time),
            "saturated_share": stroke.saturated_top + stroke.saturated_bottom,
            "unreachable_samples": self.counters.unreachable,
            "unreachable": {
                "stickier_than_at_rest": self.counters.too_sticky,
                "slipperier_than_the_display": self.counters.too_slippery,
                "amplitude_below_0": self.counters.negative,
                "amplitude_above_the_largest": self.counters.saturated,
            },
            "samples": self.counters.ticks,
            "tangential_force_mean_N": float(np.mean(np.abs(force.friction_force))),
            "tangential_force_largest_N": float(np.max(np.abs(force.friction_force))),
            "not_judged_because": self.unjudged,
            "model": {"friction": p.model, "vibration": p.amplitude_model, "loop": stroke.model},
            "provenance": self.provenance(),
        }


@si.checked_numbers
@dataclass(frozen=True)
class RenderRequest:
    """Arguments of `render_texture`."""

    display: NamedDisplay
    texture: NamedTexture
    motion: NamedMotion
    _: KW_ONLY
    voltage: si.Volt | None = None
    normal_force: si.Newton | None = None
    surface: str | None = None
    model: FrictionModel | None = None
    place: FacePlace | None = None
    sensor: str | SensorModel | None = None
    compensation: str = "none"
    braking: bool = False
    wave: str = "ignored"
    control_rate: si.Hertz = CONTROL_RATE
    seed: int = 0
    progress: SayProgress | None = None

    def at_largest_amplitude(self) -> tuple[Prediction, UnderPad]:
        """Prediction of the display at its largest amplitude, and what the pad meets of it; refused
        where it changes no friction."""
        if self.place is not None and self.wave != "ignored":
            raise InputError(
                f"place keeps the finger at one place of the plate, and with wave {self.wave} "
                "it crosses a wave that is even across and has an antinode at the texture's x = 0: "
                "both say where the nodes are. For the friction of the place leave wave out. For "
                "the wave leave place out and begin the stroke at the place's distance from the "
                'antinode: stroke "60 mm/s over 4 cm, from 5 mm"',
                quantity="place",
            )
        return at_largest_amplitude(
            self.display,
            cast(Wave, self.wave),
            voltage=self.voltage,
            normal_force=self.normal_force,
            surface=self.surface,
            model=self.model,
            place=self.place,
        )


@reads_text
@called_with(RenderRequest)
def render_texture(asked: RenderRequest) -> RenderAnalysis:
    """Render a texture on a display under a finger.

    Args:
        display: what renders; its voltage (or `voltage`, V) is the largest the drive gives, and
            what it makes under the finger the largest amplitude.
        texture: what is to be felt; x = 0 is an antinode where the wave counts.
        motion: of the finger, along x or (not on a stator) in the plane.
        normal_force, surface, model: as `predict`; so is `place`, whose friction is then that of
            the whole way, without the wave.
        sensor: what the loop sees the finger with, by name; without one it knows the place.
        compensation: "none", "inverse" or "preview".
        braking: whether the drive may invert the carrier's phase.
        wave: "ignored": the pad meets the amplitude of the antinodes everywhere; "felt": less of
            it near the nodes; "compensated": and the renderer drives harder there.
        control_rate: of the loop (Hz).
        seed: of the sensor's noise.
        progress: is told each step.

    Raises:
        InputError: a name that is not known, a motion that leaves an image or the surface, a
            display that does not vibrate at its voltage, or what the links of the chain refuse.
    """
    tell = asked.progress or (lambda _: None)
    display, motion = asked.display, asked.motion
    texture = TextureFile.of(asked.texture)
    si.require_one_of("compensation", asked.compensation, COMPENSATIONS)
    si.require_one_of("wave", asked.wave, WAVES)
    eyes = sensor_named(asked.sensor) if isinstance(asked.sensor, str) else asked.sensor
    finger = FingerMotion.of(motion, asked.control_rate)
    require_on_display(display.actuator, finger)
    require_on_image(texture.texture, finger)
    tell("the display at its largest amplitude")
    p, under = asked.at_largest_amplitude()
    played = _played(texture, motion, finger, p, under)
    tau = float(envelope_time_constant(*resonance_with_finger(p)))
    tell("the loop along the stroke")
    stroke = rendered_stroke(
        played,
        finger.trajectory,
        DrivenEnvelope(tau, tau, p.vibration_amplitude, asked.braking),
        p.friction,
        compensation=cast(Compensation, asked.compensation),
        sensor=eyes,
        control_rate=asked.control_rate,
        seed=asked.seed,
    )
    tell("tangential force")
    return _analysis(display, texture, motion, p, under, stroke, played)


def _analysis(
    display: Display,
    texture: TextureFile,
    motion: Motion,
    p: Prediction,
    under: UnderPad,
    stroke: RenderedStroke,
    played: PlayedTexture,
) -> RenderAnalysis:
    """The friction under the pad along a stroke, the force that it makes, and how faithful all of
    it is."""
    finger = played.motion
    values = texture.texture(finger.x, finger.y, finger.speed, finger.time)
    amplitude = played.amplitude(values, finger.speed)
    reached, factor = under.reached(amplitude, finger.speed), under.factor(finger)
    by_amplitude = texture.texture.quantity == "amplitude"
    nodes = "" if under.factors is None else f"; standing wave {under.wave}"
    stroke = dataclasses.replace(
        stroke,
        relative_friction_wanted=reached,
        relative_friction_rendered=under.felt(stroke.amplitude * factor, finger.speed),
        model=stroke.model + nodes,
    )
    counters = render(played.program, finger.x, finger.y, finger.speed, finger.time).counters
    force = slide(
        finger.way,
        1 / stroke.control_rate,
        under.of_the_skin(stroke.amplitude * factor, p.friction_coefficient),
        p.normal_force,
        display.finger.fingerpad,
    )
    judged, because = None, None
    try:
        judged = fidelity_report(stroke, strongest_lines(stroke, played.spatial_period))
    except InputError as error:
        because = str(error)
    return RenderAnalysis(
        display=display,
        texture=texture,
        motion=motion,
        prediction=p,
        played=played,
        stroke=stroke,
        finger=finger,
        wave=under.wave,
        factor=factor,
        asked=reached if by_amplitude else played.friction(values),
        counters=counters,
        force=force,
        fidelity=judged,
        unjudged=because,
        seed=stroke.seed,
    )


def _played(
    texture: TextureFile,
    motion: Motion,
    finger: FingerMotion,
    p: Prediction,
    under: UnderPad,
) -> PlayedTexture:
    program = lowered(texture, p, under.inverse, under.compensation)
    steady = motion if isinstance(motion, Stroke) else None
    period = single_period(texture.texture, steady) if finger.path is None else None
    # Contrast at a period's harmonics needs four of them in a pass, the start left out.
    if period is not None and float(np.ptp(finger.x)) < 5 * period:
        period = None
    name = texture.title or f"a texture of {texture.texture.quantity}"
    return PlayedTexture(
        name, program, under.inverse, finger, p.friction_coefficient, under.compensation, period
    )
