"""The tangential force of a finger that slides, sticks and slips on a surface; dry friction.

The bone moves as the hand wants; the skin of the contact (mass m) hangs on it by a spring k and a
damper c, and touches a surface at rest:

    m ẍ = k (x_bone − x) + c (v_bone − ẋ) − F,    |F| ≤ F_static where ẋ = 0,
                                                F = F_kinetic(t, |ẋ|) sign ẋ elsewhere.

The law is set-valued, as it is written: nothing is smoothed. Between samples the bone's motion is a
parabola and the friction limit a line; the skin's motion then has a closed form, which is stepped,
and slips begin and end at instants solved for inside the steps. Exact where that is the input;
second order in `time_step` for smooth inputs. Friction by rows over speed (`SpeedFriction`) is
exact where the rows stay the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.contact.sliding.kernel import (
    MOST_EVENTS,
    Track,
    slide_march,
    strongest_and_fall,
)
from squeezefilm.physics.contact.sliding.pieces import BoneDrive, Rows
from squeezefilm.physics.contact.sliding.skin_path import LumpedSkin


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class DryFriction:
    """Coulomb's law, set-valued at rest, with two options that each default to off.

    At rest the friction force is whatever holds the skin, up to `static_ratio` times the kinetic
    force; while the skin moves µ F_ref (F/F_ref)^load_exponent opposes it. How much static friction
    of skin exceeds kinetic friction was not read in a source. The coefficient of fingers was found
    independent of the load, except that it falls with load after more than 10 s on smooth
    impermeable surfaces (Dzidek et al. 2017, 10.1098/rsif.2016.0935, abstract), so an exponent
    below 1 belongs to those.

    Args:
        static_ratio: static over kinetic friction (1); at least 1.
        load_exponent: of the friction force in the normal force (1); above 0, at most 1.
        reference_force: normal force at which the coefficient is given (N); above 0. Without
            meaning at an exponent of 1.

    Raises:
        InputError: a value outside its range.
    """

    static_ratio: Annotated[si.Dimensionless, si.AtLeast(1.0)] = 1.0
    load_exponent: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)] = 1.0
    reference_force: Annotated[si.Newton, si.Above(0.0)] = 1.0

    @si.checked_numbers
    def kinetic_force(
        self,
        friction_coefficient: Annotated[si.DimensionlessLike, si.AtLeast(0.0)],
        normal_force: Annotated[si.NewtonLike, si.AtLeast(0.0)],
    ) -> si.NewtonLike:
        """Friction force of sliding (N) under a normal force (N); both broadcast.

        Raises:
            InputError: a negative or infinite coefficient or force.
        """
        relative = np.asarray(normal_force, dtype=float) / self.reference_force
        force: si.NewtonLike = (
            friction_coefficient * self.reference_force * relative**self.load_exponent
        )
        return force


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class SpeedFriction:
    """Friction that depends on the skin's own speed over the surface, and on time.

    Rows of friction coefficients over a common grid of speeds, linear between speeds and held
    beyond the last. What a contact under ultrasound gives rises with speed and levels off; rows may
    also fall, or do both.

    Args:
        speed: of the skin over the surface (m/s), shape (k,), k ≥ 2; from exactly 0, rising.
        coefficient: kinetic friction coefficient at those speeds (1), at least 0: shape (n, k), a
            row for each sample, linear between samples; or (k,), the same at all times. The first
            of a row is that towards the speed 0, and what limits sticking: where it is 0, nothing
            holds the skin, which creeps and never sticks.

    Raises:
        InputError: a value outside its range, speeds that do not rise from 0, or another shape.
    """

    speed: Annotated[si.MetrePerSecondArray, si.Rising(2)]
    coefficient: Annotated[si.DimensionlessArray, si.AtLeast(0.0)]

    def __post_init__(self) -> None:
        speed, shape = self.speed, self.coefficient.shape
        if speed[0] != 0:
            raise InputError(
                "speed must begin at 0, where the value that limits sticking stands",
                quantity="speed",
            )
        if len(shape) not in (1, 2) or shape[-1] != speed.size:
            raise InputError(
                f"coefficient of shape {shape} does not fit {speed.size} speeds; give one row of "
                f"{speed.size} values per sample, or one row for all",
                quantity="coefficient",
            )


JouleArray = Annotated[si.FloatArray, si.Unit("J")]

# Of the shortest time of the skin; far below it, a substep holds at most one slip.
_SUBSTEP = 0.25
_MOST_SUBSTEPS = 1000


@dataclass(frozen=True, slots=True, eq=False)
class Sliding:
    """A finger's skin dragged over a surface; arrays of shape (samples,).

    Forces are positive when they drag the surface, or hold back the bone, along +x.

    Attributes:
        fingerpad, law, time_step: the inputs (time step in s).
        model: what was solved.
        time: since the motion began (s).
        bone_position: of the bone along x (m).
        skin_position: of the skin in the contact (m).
        skin_speed: its speed over the surface (m/s); exactly 0 where it sticks.
        friction_force: tangential force of the interface (N).
        bone_force: tangential force at the bone (N), what a force sensor behind the pad shows; the
            mass of the skin stands between the two. Where the bone's speed jumps, the value before.
        friction_limit: kinetic friction force at high speed (N).
        sticking: whether the skin sticks.
        bone_work: work done by the bone since the start (J).
        friction_loss: work lost to friction since the start (J); never falls.
        damping_loss: work lost in the pad since the start (J); never falls.
        stored_energy: kinetic and elastic energy (J).
        stuck_share: share of the time spent sticking (1).
        slips: how many times the skin began to slip.
        friction_law_error: largest departure of the friction used from the law within a piece of a
            step, over the strongest friction of all (1); 0 where friction depends on time alone.
    """

    fingerpad: FingerpadDynamics
    law: DryFriction
    time_step: si.Second
    time: si.SecondArray
    bone_position: si.MetreArray
    skin_position: si.MetreArray
    skin_speed: si.MetrePerSecondArray
    friction_force: si.NewtonArray
    bone_force: si.NewtonArray
    friction_limit: si.NewtonArray
    sticking: NDArray[np.bool_]
    bone_work: JouleArray
    friction_loss: JouleArray
    damping_loss: JouleArray
    stored_energy: JouleArray
    stuck_share: si.Dimensionless
    slips: int
    friction_law_error: si.Dimensionless
    model: str = "one mass on spring and damper, set-valued Coulomb friction, event-driven"

    @property
    def stretch(self) -> si.MetreArray:
        """Skin position relative to the bone (m): negative when dragged back on a way along +x."""
        return self.skin_position - self.bone_position

    @property
    def energy_residual(self) -> si.Joule:
        """Largest failure of the balance work = stored + friction + damping at any time (J).

        Work and losses are integrated on their own, so this judges the march; it does not judge
        whether the law was followed (`friction_law_error`) or the inputs sampled finely enough.
        """
        gained = self.stored_energy - self.stored_energy[0]
        return float(
            np.max(np.abs(self.bone_work - gained - self.friction_loss - self.damping_loss))
        )


@si.checked_numbers
def slide(
    bone_position: si.MetreArray,
    time_step: Annotated[si.Second, si.Above(0.0)],
    friction_coefficient: si.DimensionlessLike | SpeedFriction,
    normal_force: si.NewtonLike,
    fingerpad: FingerpadDynamics | None = None,
    law: DryFriction | None = None,
    *,
    initial_stretch: si.Metre = 0.0,
    initial_speed: si.MetrePerSecond = 0.0,
) -> Sliding:
    """The tangential force and the skin's motion as the bone moves over a surface.

    Args:
        bone_position: at times 0, time_step, … (m), shape (n,), n ≥ 2. Motion at constant speed
            and turns that fall on samples are taken exactly; smooth motion to second order.
        time_step: between samples (s); above 0.
        friction_coefficient: kinetic, over time (1): a scalar or shape (n,), at least 0; linear
            between samples. With a display this is µ times the relative friction rendered. Or a
            `SpeedFriction` where it depends on the skin's speed as well: one row, or one per
            sample.
        normal_force: over time (N): a scalar or shape (n,), at least 0; the friction limit it
            gives is linear between samples.
        fingerpad: stiffness, damping, mass; the published ones where not given.
        law: static friction and dependence on the load; plain Coulomb if not given.
        initial_stretch: skin position relative to the bone at the start (m); 0 is a relaxed pad.
        initial_speed: of the skin over the surface at the start (m/s); 0 is a skin at rest, which
            sticks if friction holds it.

    Raises:
        InputError: a value outside its range, arrays of other shapes, or friction that falls so
            steeply with speed that a step would need more than 1000 parts.
        ConvergenceError: slips began and ended more than 200 times within one step; `partial`
            holds the skin positions up to there.
    """
    pad, law = fingerpad or FingerpadDynamics(), law or DryFriction()
    bone = _checked_bone(bone_position)
    n = bone.size
    load = _over_time("normal_force", normal_force, n)
    given: si.DimensionlessLike = 1.0
    if isinstance(friction_coefficient, SpeedFriction):
        rows = _rows(friction_coefficient, n)
    else:
        given, rows = friction_coefficient, _ALIKE
    force = np.asarray(law.kinetic_force(_over_time("friction_coefficient", given, n), load))
    position, speed, friction, bone_force = (np.zeros(n) for _ in range(4))
    position[0], speed[0] = bone[0] + initial_stretch, initial_speed
    sticking, work, account = np.zeros(n, dtype=bool), np.zeros((3, n)), np.zeros(3)
    track = Track(position, speed, friction, bone_force, sticking, work, account)
    _march(bone, float(time_step), force, rows, pad, law, track)
    return _sliding(pad, law, time_step, bone, force * rows.coefficient[:, -1], track)


# Friction that is the same at all speeds.
_ALIKE = Rows(np.array([0.0, 1.0]), np.ones((1, 2)))


def _checked_bone(bone_position: si.MetreArray) -> si.FloatArray:
    bone = np.ascontiguousarray(bone_position, dtype=float)
    if bone.ndim != 1 or bone.size < 2:
        raise InputError(
            f"bone_position of shape {bone.shape} cannot be used: give one place per sample, at "
            "least two",
            quantity="bone_position",
        )
    return bone


def _rows(friction: SpeedFriction, n: int) -> Rows:
    """Friction by speed as the march takes it, but for its force."""
    coefficient = np.atleast_2d(np.ascontiguousarray(friction.coefficient, dtype=float))
    if len(coefficient) != n and np.ndim(friction.coefficient) == 2:
        raise InputError(
            f"friction_coefficient has {len(coefficient)} rows, which do not fit {n} samples of "
            "bone_position; give one row per sample, or one without a second axis for all",
            quantity="friction_coefficient",
        )
    return Rows(np.ascontiguousarray(friction.speed, dtype=float), coefficient)


def _march(
    bone: si.FloatArray,
    time_step: float,
    force: si.FloatArray,
    rows: Rows,
    pad: FingerpadDynamics,
    law: DryFriction,
    track: Track,
) -> None:
    """March over all samples, from what stands first in the track; raises `ConvergenceError`.

    `force` is the friction force over time (N) for each of a row's units.
    """
    speed_in, speed_out = interval_speeds(bone, time_step)
    force = np.ascontiguousarray(force)
    strongest, steepest = strongest_and_fall(rows, force)
    parts = substeps(time_step, pad, steepest)
    drive = BoneDrive(bone, speed_in, speed_out, force, time_step, parts)
    skin = LumpedSkin(pad.mass, pad.damping, pad.stiffness)
    done = slide_march(drive, skin, rows, law.static_ratio, strongest, track)
    if done < bone.size:
        raise ConvergenceError(
            f"the skin started and stopped more than {MOST_EVENTS} times within the time step "
            f"after t = {si.format_quantity(done * time_step, si.Unit('s'))}; take a shorter "
            "time_step",
            partial=track.position[: done + 1],
            iterations=MOST_EVENTS,
        )


def _sliding(
    pad: FingerpadDynamics,
    law: DryFriction,
    time_step: float,
    bone: si.FloatArray,
    limit: si.FloatArray,
    track: Track,
) -> Sliding:
    """Result of the march, with its energies."""
    n = bone.size
    stretch = track.position - bone
    return Sliding(
        fingerpad=pad,
        law=law,
        time_step=time_step,
        time=np.arange(n, dtype=float) * time_step,
        bone_position=bone,
        skin_position=track.position,
        skin_speed=track.speed,
        friction_force=track.friction,
        bone_force=track.bone_force,
        friction_limit=limit,
        sticking=track.stuck,
        bone_work=track.work[0],
        friction_loss=track.work[1],
        damping_loss=track.work[2],
        stored_energy=0.5 * (pad.mass * track.speed**2 + pad.stiffness * stretch**2),
        stuck_share=float(track.account[0] / (time_step * (n - 1))),
        slips=int(track.account[1]),
        friction_law_error=float(track.account[2]),
    )


@si.checked_numbers
def interval_speeds(
    bone: si.MetreArray, time_step: Annotated[si.Second, si.Above(0.0)]
) -> tuple[si.MetrePerSecondArray, si.MetrePerSecondArray]:
    """Speed of the bone at the start and the end of each interval (m/s), shape (n−1,) each.

    The parabola through both samples whose acceleration is the smaller of those to the left and
    to the right, and 0 where they differ in sign: second order on smooth motion, and a motion in
    straight pieces that meet at samples keeps its corners.
    """
    si.require("bone", bone, si.Unit("m"), axes=1)
    mean = np.diff(bone) / time_step
    change = np.diff(mean)
    if not change.size:
        return mean, mean.copy()
    left, right = np.append(change[:1], change), np.append(change, change[-1:])
    half = 0.5 * np.where(left * right > 0, np.sign(left), 0.0)
    half *= np.minimum(np.abs(left), np.abs(right))
    # Differences of places carry rounding; it must not pass for acceleration.
    noise = 4 * np.finfo(float).eps * float(np.max(np.abs(bone))) / time_step
    half[np.abs(half) <= noise] = 0.0
    return mean - half, mean + half


def _over_time(name: str, values: si.NewtonLike | si.DimensionlessLike, n: int) -> si.FloatArray:
    array = np.asarray(values, dtype=float)
    if array.shape not in ((), (n,)):
        raise InputError(
            f"{name} of shape {array.shape} does not fit {n} samples of bone_position; give a "
            "scalar or one value per sample",
            quantity=name,
        )
    return np.broadcast_to(array, (n,))


@si.checked_numbers
def substeps(time_step: si.Second, pad: FingerpadDynamics, fall: si.NewtonSecondPerMetre) -> int:
    """Parts of a step (s) for friction over speed, however steeply it rises.

    Short for the skin's swing, and where friction falls with speed, by at most `fall` (N·s/m), for
    the growth of a slip. Raises `InputError` for more than 1000 parts.
    """
    fastest = max(math.sqrt(pad.stiffness / pad.mass), fall / pad.mass)
    count = math.ceil(time_step * fastest / _SUBSTEP)
    if count > _MOST_SUBSTEPS:
        raise InputError(
            f"time_step = {si.format_quantity(time_step, si.Unit('s'))} would need {count} parts "
            f"of a step where {_MOST_SUBSTEPS} are allowed: shorten it, or let friction fall less "
            "steeply with speed"
        )
    return max(count, 1)
