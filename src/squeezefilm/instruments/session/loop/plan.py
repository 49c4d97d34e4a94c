"""Plan of a loop: texture, drive, estimator, compensation and rate, and as flat arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.instruments.session.loop.rows import COLUMNS, COMMAND_COLUMNS, SAMPLE_COLUMNS
from squeezefilm.physics.render.motion import kernel as motion_kernel
from squeezefilm.physics.render.motion.estimator import MotionEstimator
from squeezefilm.physics.render.program.inverse import FrictionTable
from squeezefilm.physics.render.program.lowering import Program
from squeezefilm.physics.render.program.renderer import new_state
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope

LoopCompensation = Literal["none", "inverse"]

LEAST_RATE: si.Hertz = 10.0
HIGHEST_RATE: si.Hertz = 50e3

# Places in the settings.
DT, LEAD, OUTPUT_DELAY, INVERSE, LONGEST_GAP, PER_VOLT = range(6)
SETTINGS_SIZE = 6
# Places in the memory that a tick carries to the next.
TOUCHING, SILENCED, COMMAND, REPORTED_LEVEL, REPORTED_AMPLITUDE, STAMP, ROWS_DROPPED = range(7)
MEMORY_SIZE = 7


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class LoopPlan:
    """All that a loop needs; it can be pickled and does not change while the loop runs.

    Args:
        program: the lowered texture.
        rate: of the ticks (Hz), 10 Hz to 50 kHz.
        envelope: the resonator and the limits of its drive; may brake only where the drive can
            invert the carrier's phase (commands are negative then).
        amplitude_per_volt: of the resonator (m/V, both zero-to-peak).
        estimator: of the finger's motion; one runs along x and one along y.
        compensation: "none" or "inverse". (A preview needs the way ahead, which a loop that knows
            only samples has to guess; it is offered offline.)
        relative_friction: the friction to write down for an amplitude under a finger at the
            estimated speed; without it, none.
        output_delay: from when a tick is due to when its command acts at the plate (s), as for a
            device that queues; below 1 s. The loop predicts across it.
        host_timeout: time without a word from the host after which the loop plays nothing (s).
            After lost ticks, up to this long the plate is taken to have followed the last command;
            past it, to have come to rest.

    Raises:
        InputError: a value outside its range, or an unknown compensation.
    """

    program: Program
    rate: Annotated[si.Hertz, si.AtLeast(LEAST_RATE), si.AtMost(HIGHEST_RATE)]
    envelope: DrivenEnvelope
    amplitude_per_volt: Annotated[si.MetrePerVolt, si.Above(0.0)]
    estimator: MotionEstimator
    compensation: LoopCompensation = "none"
    relative_friction: FrictionTable | None = None
    output_delay: Annotated[si.Second, si.AtLeast(0.0), si.Below(1.0)] = 0.0
    host_timeout: Annotated[si.Second, si.Above(0.0), si.AtMost(60.0)] = 50e-3

    @property
    def period(self) -> si.Second:
        """Time from a tick to the next (s)."""
        return 1 / self.rate

    @property
    def voltage_limit(self) -> si.Volt:
        """The most that it commands (V, zero-to-peak): for the envelope's largest amplitude."""
        return self.envelope.amplitude_limit / self.amplitude_per_volt

    @property
    def lead(self) -> si.Second:
        """Time from when a tick is due to the moment that its command is meant for (s).

        The output delay, and half a period (the middle of the step) or, compensated, a whole one
        (its end); see `render.rendered_stroke`.
        """
        return (0.5 if self.compensation == "none" else 1.0) * self.period + self.output_delay


class TickArrays(NamedTuple):
    """A plan as the compiled tick takes it: constants, running states, and room to work in."""

    settings: si.Array
    program: si.Array
    render_state: si.Array
    motion_parameters: si.Array
    motion_x: si.Array
    motion_y: si.Array
    envelope: si.Array
    compensator: si.Array
    friction_amplitude: si.Array
    friction_speed: si.Array
    friction: si.Array
    memory: si.Array
    sample: si.Array
    row: si.Array
    command: si.Array


def tick_arrays(plan: LoopPlan) -> TickArrays:
    """The arrays of a plan before its first tick."""
    settings = np.zeros(SETTINGS_SIZE)
    settings[DT], settings[LEAD] = plan.period, plan.lead
    settings[OUTPUT_DELAY] = plan.output_delay
    settings[INVERSE] = float(plan.compensation == "inverse")
    settings[LONGEST_GAP] = plan.host_timeout
    settings[PER_VOLT] = plan.amplitude_per_volt
    memory = np.zeros(MEMORY_SIZE)
    memory[[REPORTED_LEVEL, REPORTED_AMPLITUDE, STAMP]] = np.nan
    law = plan.relative_friction
    # Copies, as of the program.
    table = (
        (np.zeros(0), np.zeros(1), np.zeros((1, 0)))
        if law is None
        else (np.array(law.amplitude), np.array(law.speed), np.array(law.relative_friction))
    )
    return TickArrays(
        settings=settings,
        # A copy that may be written to, so that the tick is compiled for one type of array only.
        program=np.array(plan.program.array),
        render_state=new_state(plan.program),
        motion_parameters=plan.estimator.parameters(),
        motion_x=np.zeros(motion_kernel.STATE_SIZE),
        motion_y=np.zeros(motion_kernel.STATE_SIZE),
        envelope=plan.envelope.parameters(plan.period),
        compensator=plan.envelope.new_state(),
        friction_amplitude=table[0],
        friction_speed=table[1],
        friction=table[2],
        memory=memory,
        sample=np.zeros((1, len(SAMPLE_COLUMNS))),
        row=np.zeros(len(COLUMNS)),
        command=np.zeros(len(COMMAND_COLUMNS)),
    )
