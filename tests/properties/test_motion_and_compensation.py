"""What must hold for every motion, every wish and every envelope."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.verification.square_swing import square_swing_compensated

from squeezefilm.core.quantities import FloatArray
from squeezefilm.physics.render.motion import kernel
from squeezefilm.physics.render.motion.estimator import MotionEstimator, MotionModel
from squeezefilm.physics.render.resonator.envelope import (
    DrivenEnvelope,
    compensated_drive,
)

wishes = st.lists(st.floats(0.0, 2e-6), min_size=1, max_size=60).map(np.array)
envelopes = st.builds(
    DrivenEnvelope,
    st.floats(1e-4, 1e-2), st.floats(1e-4, 1e-2), st.just(1e-6), st.booleans(),
)  # fmt: skip
steps = st.floats(1e-5, 1e-2)


@given(wishes, envelopes, steps, st.sampled_from(["none", "inverse", "preview"]))
def test_neither_command_nor_envelope_ever_leaves_the_limits(
    wanted: FloatArray, envelope: DrivenEnvelope, step: float, compensation: str
) -> None:
    drive = compensated_drive(wanted, step, envelope, compensation)  # type: ignore[arg-type]
    assert np.all(drive.command <= 1e-6)
    assert np.all(drive.command >= envelope.lowest_command)
    # The amplitude itself never inverts either: it is braked to rest, no further.
    first = min(float(wanted[0]), envelope.amplitude_limit)
    amplitude = envelope.response(drive.command, step, first)
    assert np.all((amplitude >= -1e-17) & (amplitude <= 1e-6 * (1 + 1e-12)))


@given(wishes, envelopes, steps)
def test_compensation_then_envelope_is_identity_where_nothing_saturates(
    wanted: FloatArray, envelope: DrivenEnvelope, step: float
) -> None:
    drive = compensated_drive(wanted, step, envelope, initial=0.0)
    # After a sample whose command lies inside its limits the amplitude is the one wanted.
    inside = (drive.command < 1e-6) & (drive.command > envelope.lowest_command)
    reached = envelope.response(drive.command, step)[1:][inside[:-1]]
    assert np.allclose(reached, wanted[1:][inside[:-1]], rtol=0, atol=1e-14)


@given(st.floats(0.05, 30.0), st.floats(0.0, 0.9), st.floats(0.01, 1.0), st.booleans())
def test_compensation_never_keeps_less_and_braking_never_less_than_none(
    ratio: float, low: float, share: float, braking: bool
) -> None:
    high = low + share * (1.0 - low)
    kept = [
        square_swing_compensated(
            ratio, 1.0, DrivenEnvelope(1.0, 1.0, 1.0, brakes), low, high, compensation
        )
        for compensation, brakes in (("none", False), ("inverse", False), ("inverse", True))
    ]
    assert kept[0] <= kept[1] + 1e-12
    assert kept[1] <= kept[2] + 1e-12
    assert kept[2] <= 1 + 1e-12


anything = st.floats(allow_nan=True, allow_infinity=True)
times = st.one_of(st.floats(0.0, 2.0), anything)


@given(st.lists(st.tuples(times, anything), max_size=40), times)
def test_no_stream_of_samples_makes_the_estimate_infinite(
    samples: list[tuple[float, float]], asked: float
) -> None:
    estimator = MotionEstimator(MotionModel(), 2e-5)
    state, parameters = estimator.new_state(), estimator.parameters()
    for stamp, position in samples:
        # A sensor's positions are metres: what is finite at all is below a kilometre.
        seen = position if abs(position) < 1e3 or not math.isfinite(position) else 0.0
        kernel.motion_step(state, parameters, stamp, seen)
    x, v, dx, dv, _ = kernel.motion_at(state, parameters, asked)
    assert math.isfinite(x)
    assert math.isfinite(v)
    assert dx >= 0
    assert dv >= 0
    counted = state[kernel.USED : kernel.STALL].sum()
    assert counted >= len(samples)


@given(st.floats(-0.5, 0.5), st.floats(-0.1, 0.1), st.floats(0.0, 0.09))
def test_a_steady_finger_is_predicted_exactly(speed: float, start: float, ahead: float) -> None:
    random = np.random.default_rng(9)
    stamps = np.cumsum(random.uniform(1e-3, 9e-3, 800))
    estimator = MotionEstimator(MotionModel(), 1e-6)
    state, parameters = estimator.new_state(), estimator.parameters()
    for t in stamps:
        kernel.motion_step(state, parameters, t, start + speed * t)
    t = float(stamps[-1]) + ahead
    x, v, *_ = kernel.motion_at(state, parameters, t)
    assert abs(x - (start + speed * t)) < 1e-11
    assert abs(v - speed) < 1e-10
