"""What is drawn of a calibrated display: its plate's amplitude as a whole, its law's own error.

`physics.uncertainty.draws.Mixture` asks here what of a display's `JointSpread` it draws; the rows
of its table are picked where points are made, `physics.uncertainty.uncertainty.sobol_points`.
"""

from __future__ import annotations

from squeezefilm.core import quantities as si
from squeezefilm.core.distributions import Normal
from squeezefilm.core.joint_spread import JointSpread
from squeezefilm.physics.uncertainty.model_choices import Choice
from squeezefilm.physics.uncertainty.parameters import Parameter

AMPLITUDE_SHARE, FRICTION_OFFSET = "joint.amplitude_share", "joint.friction_offset"
"""The amplitude per volt relative to the solved one, and what is added to the law's friction."""


def calibrated_inputs(
    inputs: tuple[Parameter | Choice, ...], joint: JointSpread | None, *, driven: bool
) -> tuple[Parameter | Choice, ...]:
    """The inputs of a display with what its calibration found; as they are without one.

    What the plate's own values make of the amplitude is known as a whole then, and better than they
    are, so that one input stands for all of them.
    """
    if joint is None:
        return inputs
    known = joint.amplitude_share_deviation > 0
    kept = tuple(one for one in inputs if not (known and one.path.startswith("actuator.")))
    spreads = (
        (AMPLITUDE_SHARE, joint.amplitude_share, joint.amplitude_share_deviation, driven),
        (FRICTION_OFFSET, joint.friction_offset, joint.friction_offset_deviation, True),
    )
    return kept + tuple(
        Parameter(path, middle, si.Unit("1"), Normal(middle, deviation), "given", "the calibration")
        for path, middle, deviation, counts in spreads
        if counts and deviation > 0
    )
