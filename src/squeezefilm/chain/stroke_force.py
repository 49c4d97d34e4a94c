"""The tangential force that a stroke over a rendered texture gives: trace and skin joined."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.contact.finger.fingerpad import FingerpadDynamics
from squeezefilm.contact.sliding.dry_friction import DryFriction, Occlusion
from squeezefilm.contact.sliding.march import Sliding, slide
from squeezefilm.contact.sliding.skin_vibration import (
    SkinVibration,
    skin_vibration,
    texture_frequency,
)
from squeezefilm.errors import InputError
from squeezefilm.render.fidelity.trace import FrictionTrace, period_of
from squeezefilm.render.motion.stroke import Stroke

# Of the skin's slower time constant: what is left of a start by then is 1 %.
_SETTLING = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class StrokeForce:
    """A finger's tangential force along a stroke over a rendered texture.

    Attributes:
        trace: texture, stroke and relative friction rendered.
        friction_coefficient: µ of the surface at rest (1), kinetic.
        normal_force: mean over the stroke (N).
        motion: force, skin motion, sticking, energies; its samples are those of the trace.
    """

    trace: FrictionTrace
    friction_coefficient: si.Dimensionless
    normal_force: si.Newton
    motion: Sliding

    @property
    def settled(self) -> si.Second:
        """When the skin has forgotten the start of the stroke (s).

        The pad has been stretched until it slides, and five of its slower time constants have
        passed; the end of the first pass if that comes earlier.
        """
        return min(settled_after(self.motion), self.trace.stroke.pass_duration)

    def vibration(self, harmonics: int = 5) -> SkinVibration:
        """Spectra of the skin in the settled part of the first pass, with the texture's lines.

        Raises:
            InputError: a texture without a spatial period, or a pass with fewer than two periods
                after the start has settled; make it longer.
        """
        texture, stroke = self.trace.texture, self.trace.stroke
        period = period_of(texture)
        if period is None:
            raise InputError(
                f"a {type(texture).__name__} has no spatial period to look for; call "
                "skin_vibration on `motion` with a frequency of your choice"
            )
        return first_pass_vibration(self.motion, stroke, period, harmonics)


def settled_after(motion: Sliding) -> si.Second:
    """When a pad that began relaxed has been stretched until it slides, and five of its slower time
    constants have passed (s)."""
    free = np.flatnonzero(~motion.sticking)
    first = float(motion.time[free[0]]) if free.size else 0.0
    return first + _SETTLING * motion.fingerpad.settling_time_constant


def first_pass_vibration(
    motion: Sliding, stroke: Stroke, spatial_period: si.Metre, harmonics: int
) -> SkinVibration:
    """Spectra of the skin in the settled part of a stroke's first pass, with the lines of a period.

    Raises `InputError` for a pass with fewer than two periods after the start has settled.
    """
    return skin_vibration(
        motion,
        float(texture_frequency(stroke.speed, spatial_period)),
        harmonics,
        start=min(settled_after(motion), stroke.pass_duration),
        end=min(stroke.pass_duration, float(motion.time[-1])),
    )


def stroke_force(
    trace: FrictionTrace,
    friction_coefficient: si.Dimensionless,
    normal_force: si.NewtonLike,
    fingerpad: FingerpadDynamics | None = None,
    law: DryFriction | None = None,
    occlusion: Occlusion | None = None,
) -> StrokeForce:
    """The tangential force under a finger whose bone makes the stroke of a friction trace.

    The display follows the bone (that is what a finger sensor sees), so the friction coefficient
    over time is `friction_coefficient` times the relative friction rendered. The finger starts at
    rest with a relaxed pad.

    Args:
        trace: position and relative friction over time.
        friction_coefficient: kinetic, of the unexcited surface (1); at least 0.
        normal_force: (N), a scalar or one value per sample of the trace; at least 0.
        fingerpad, law, occlusion: see `slide`.

    Raises:
        InputError: a value outside its range, or a normal force of another shape.
        ConvergenceError: see `slide`.
    """
    si.require("friction_coefficient", friction_coefficient, at_least=0.0)
    si.require("normal_force", normal_force, si.Unit("N"), at_least=0.0)
    motion = slide(
        trace.position,
        1 / trace.sample_rate,
        friction_coefficient * trace.relative_friction_rendered,
        normal_force,
        fingerpad,
        law,
        occlusion=occlusion,
    )
    return StrokeForce(trace, friction_coefficient, float(np.mean(normal_force)), motion)
